"""Run a frame's commands on a machine: validate, prepare, queue, and drive the kernels.

Clears and Draws wait in a queue until something reads what they draw. Then every thread takes bands of rows
and runs all that waits on each (``fixedpipe.raster.vector.frame``); what those kernels do not cover is drawn by others
(``fixedpipe.raster.portable.draw``), Draw after Draw.
"""

import math
import os
import threading
import weakref
from collections import Counter, deque
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from numbers import Integral

import numpy as np

from fixedpipe.pipeline.columns import engine as column_engine
from fixedpipe.pipeline.columns.rectangles import draw_rectangle
from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    HostStep,
    MakeCurrent,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.enums import AccumOperation, Clamp, ColorBuffer, TextureTarget
from fixedpipe.pipeline.framebuffers.accumulation import accumulate, clear_accumulation
from fixedpipe.pipeline.framebuffers.framebuffer import (
    Framebuffer,
    bound_texture,
    copied_texture,
    defined_texture,
    replaced_texture,
)
from fixedpipe.pipeline.framebuffers.multisample import SAMPLE_POSITIONS, Samples
from fixedpipe.pipeline.framebuffers.snapshot import Snapshot, snapshot
from fixedpipe.pipeline.framebuffers.transfer import HistogramTable, MinmaxTable, PixelStatistics
from fixedpipe.pipeline.native import pack
from fixedpipe.pipeline.native.combiner_plan import plan_combiners
from fixedpipe.pipeline.native.threads import Threads
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.profiles.profile import NATIVE_SUBPIXEL_BITS, Profile
from fixedpipe.pipeline.state import ColorMask, PassState
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.textures.words import stored_texture
from fixedpipe.pipeline.validation.frames import frame_of, issued_by
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.vertices import stage
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.primitives.bins import BAND_HEIGHT, CHUNK, count_bins, fill_bins, sort_triangles
from fixedpipe.raster.vector.arrays import Buffers, scratch
from fixedpipe.raster.vector.frame import draw_frame, fill_clear, fill_draw
from fixedpipe.raster.vector.sample import row_pairs

BATCH = 2048  # fragments shaded together; any size gives the same bits. Measured: docs/decisions, page 0002
_NO_RECORD = np.zeros((0, 4), np.int32)
_NO_TEXELS = np.zeros(1, np.uint32)
_NO_FOUR = [_NO_TEXELS] * 4
_NO_LEVELS = np.ones((1, R.MAX_LEVELS, 3), np.int32)
# Pixels of the scissor boxes of all that waits: below this a second thread costs more than it saves
# (docs/decisions, page 0002).
_PARALLEL_FROM = 1 << 14
# Bytes of vertices that wait to be drawn, or are kept for a repetition: enough for any figure's frame.
_MOST_BYTES = 1 << 27
ENGINES = (None, "portable", "columns")
_RECTANGLES = (DrawPixels, CopyPixels, Bitmap)


@dataclass(frozen=True, eq=False)
class Fragments:
    """Fragments as columns, all int32 [n]: primitive number, device pixel x and y (y down), and 1 where the
    fragment passed the per-fragment tests (0 where not; coverage alone says 1). A rectangle of pixels has
    the group's number instead, counted row by row from the lower left.

    Per pixel they are in draw order.
    """

    triangle: np.ndarray
    x: np.ndarray
    y: np.ndarray
    passed: np.ndarray


@dataclass(frozen=True, eq=False)
class Result:
    """What running commands gave.

    framebuffer   the window's framebuffer (the same object in every Result of one Machine)
    surfaces      the pbuffers' framebuffers by name (the same objects likewise)
    textures      texture objects by name, as they are afterwards
    pixels        what each ReadPixels read, by its name
    fragments     how many fragments the Draws and rectangles of pixels made
    dropped       how many primitives were dropped because a projected position was not usable
    undefined     how many groups of pixel textures had no positive q, which then counted as 1
    trace         a Snapshot after every command, those that a HostStep issued among them, when asked for
    records       the Fragments of every Draw and rectangle of pixels, when asked for
    histograms    the machine's histograms by name, as they are afterwards
    minmaxes      its minmaxes likewise
    """

    framebuffer: Framebuffer
    surfaces: dict[str, Framebuffer]
    textures: dict[str, Texture]
    pixels: dict[str, np.ndarray]
    fragments: int
    dropped: int
    undefined: int
    trace: tuple[Snapshot, ...]
    records: tuple[Fragments, ...]
    histograms: dict[str, HistogramTable]
    minmaxes: dict[str, MinmaxTable]

    def image(self):
        """The framebuffer's colours, uint8 [h, w, 4], top row first."""
        return self.framebuffer.image()


class _Texels:
    """A texture as kernels read it. ``levels`` int32 [1, MAX_LEVELS, 3]: where each level begins in
    ``packed``, its width and height.
    """

    def __init__(self, texture, signed):
        self.levels, offset = np.ones((1, R.MAX_LEVELS, 3), np.int32), 0
        for k, level in enumerate(texture.levels):
            self.levels[0, k] = offset, level.shape[2], level.shape[1]
            offset += level[..., 0].size
        self._images, self._signed = texture.levels, signed
        self._volume = texture.target == TextureTarget.TEXTURE_3D

    @cached_property
    def packed(self):
        """Every level behind the other, a word for each texel: the texture's own memory where it is that."""
        images = [np.ascontiguousarray(image).view(np.uint32).ravel() for image in self._images]
        if len(images) == 1 and not self._signed:
            return np.asarray(_Unlocked(images[0]))
        return np.concatenate(images) ^ np.uint32(self._signed)

    @cached_property
    def pairs(self):
        """The same as row pairs (``fixedpipe.raster.vector.sample``) and their levels; of a volume none."""
        if self._volume:
            return _NO_TEXELS, _NO_LEVELS
        pairs, levels = row_pairs(self.packed, self.levels[0], len(self._images), len(self._images[0]))
        if len(self._images) > 1 or self._signed:
            self.__dict__.pop("packed", None)  # mostly nobody asks for both
        return pairs, levels[None]


class _Unlocked:
    """An array's memory for kernels, which take writable arrays alone, though they write to no texel."""

    def __init__(self, array):
        self._array = array
        place, _ = array.__array_interface__["data"]
        self.__array_interface__ = {**array.__array_interface__, "data": (place, False)}


_texels_of = weakref.WeakKeyDictionary()


def _texels(texture, signed):
    """``signed``: bits that are inverted in every texel, so that filters see s + 128 for a signed byte s."""
    found = _texels_of.get(texture)
    if found is None:
        found = _texels_of.setdefault(texture, {})
    if signed not in found:
        found[signed] = _Texels(texture, signed)
    return found[signed]


def default_threads():
    """One thread per processor this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(eq=False)
class Machine:
    """A machine with its framebuffer, pbuffers, texture objects, histograms and minmaxes, which persist from
    run to run.

    Several Python threads may share one: a run waits until the one before it has ended.

    Parameters
    ----------
    profile : Profile
        Not an exact one: ``fixedpipe.pipeline.ideal.evaluate`` evaluates those.
    width, height : int
        Framebuffer size in pixels.
    depth_bits : int, DepthFormat or None
        One of ``profile.depth_bits``: a fixed format's width, or a format. None: the widest fixed one.
    threads : int or None
        Threads that share a Draw's bands of rows; None: one per processor. The bits are the same for any
        number.
    batch : int
        Fragments shaded together, 16 to 4096. The bits are the same for any number.
    engine : str or None
        None: each Draw by the fastest kernels that cover it. "portable": every Draw by those that cover all.
        "columns": every Draw by the column engine that it covers. The bits are the same.
    samples : int or None
        How many samples a pixel of the window has, one of ``profile.samples``; None: the profile's first.
        pbuffers have one.
    color_bits : int or None
        One of ``profile.color_bits``, the width of the window's colour components. None: the usual one.
    """

    profile: Profile
    width: int
    height: int
    depth_bits: int | None = None
    threads: int | None = None
    batch: int = BATCH
    textures: dict[str, Texture] = field(default_factory=dict)
    surfaces: dict[str, Framebuffer] = field(default_factory=dict)
    engine: str | None = None
    statistics: PixelStatistics = field(default_factory=PixelStatistics)
    samples: int | None = None
    color_bits: int | None = None

    def __post_init__(self):
        if not isinstance(self.profile, Profile):
            raise ValueError(
                f"The machine's profile is {self.profile!r}; give a Profile, such as "
                'fixedpipe.pipeline.profiles.PROFILES["GEFORCE_256"].'
            )
        if self.profile.exact:
            raise ValueError(
                f"The {self.profile.name} profile has no hardware; evaluate it with execute_ideal."
            )
        if self.threads is not None and not (isinstance(self.threads, Integral) and self.threads >= 1):
            raise ValueError(
                f"{self.threads} threads cannot draw; give 1 or more, or None for one per processor."
            )
        if not (isinstance(self.batch, Integral) and 16 <= self.batch <= 4096):
            raise ValueError(f"A batch of {self.batch} fragments is out of range; give 16 to 4096.")
        if self.engine not in ENGINES:
            raise ValueError(
                f'There is no engine {self.engine!r}; give "portable" or "columns", or None for the fastest '
                "that covers a Draw."
            )
        if self.color_bits is None:
            self.color_bits = self.profile.color_bits[0]
        if self.depth_bits is None:
            self.depth_bits = self.profile.widest_depth
        if self.samples is None:
            self.samples = self.profile.samples[0]
        window = {"samples": self.samples, "color_bits": self.color_bits}
        validate((), self.profile, self.width, self.height, self.depth_bits, **window)
        self.framebuffer = Framebuffer.new(
            self.width,
            self.height,
            self.depth_bits,
            color_bits=self.color_bits,
            clamped=Clamp.BLENDING in self.profile.clamps,
        )
        bands = -(-self.height // BAND_HEIGHT)
        self._queue = _Queue(min(self.threads or default_threads(), bands), self.batch)
        self._current = self.framebuffer
        self._samples = Samples(self.framebuffer, self.samples) if self.samples > 1 else None
        self._running, self._runner = threading.Lock(), None
        self._unrounded = None

    def run(self, commands, *, trace=False, record=False):
        """Validate and run ``commands``; returns a Result.

        ``trace``: keep the framebuffer after every command. ``record``: keep every Draw's fragments.
        Raises ``UnsupportedState`` or ValueError, before anything is drawn; for what a
        HostStep issues, before any of that is.
        """
        commands = frame_of(commands)
        if record and self._samples:
            raise ValueError(
                f"Fragments are recorded of one sample, and this machine has {self.samples} in each pixel; "
                "give samples=1."
            )
        if self._runner == threading.get_ident():
            raise ValueError(
                "This machine waits for a HostStep; let the step's function return commands, not run them."
            )
        with self._running:
            self._runner = threading.get_ident()
            try:
                return self._run(commands, trace, record)
            finally:
                self._runner = None

    def _run(self, commands, trace, record):
        validate(
            commands,
            self.profile,
            self.width,
            self.height,
            self.depth_bits,
            self.textures,
            self.surfaces,
            self.statistics,
        )
        self._current = self.framebuffer
        # The engine that records draws alone, Clears as well: the other is then neither compiled nor read.
        engine = "portable" if record else self.engine
        queue, repeated = self._queue, _Repeated(commands, self.samples)
        pixels, snapshots, records = {}, [], []
        queue.fragments = dropped = undefined = 0
        waiting = deque(commands)
        try:
            while waiting:
                command = waiting.popleft()
                kind = type(command)
                if kind is Draw:
                    for surface, position in self._targets(command.state.draw_buffer):
                        target = surface.buffer(command.state.draw_buffer)
                        # What was prepared is the native engines'.
                        draw = repeated.get(command, surface, self.textures)
                        if draw is None and self._draws_columns(command.state, target):
                            queue.flush()
                            drawn, lost = self._drawn_by_columns(command, target, position)
                            queue.fragments += len(drawn.x)
                            if record:
                                records.append(drawn)
                            continue
                        if draw is None:
                            draw = self._prepared(command, position)
                            repeated.keep(command, surface, draw)
                        lost = draw.dropped
                        if record:
                            queue.flush()
                            records.append(_recorded(draw, target, self.batch))
                            queue.fragments += len(records[-1].x)
                        else:
                            queue.draw(draw, target, engine)
                    dropped += lost
                elif kind is Clear:
                    for surface, _ in self._targets(command.draw_buffer):
                        target = surface.buffer(command.draw_buffer)
                        queue.clear(command, target, engine if target.is_bytes else "portable")
                    if command.accumulation is not None:
                        clear_accumulation(self._current, command, self.profile)
                elif kind in _RECTANGLES:
                    self._flush()
                    surfaces = [surface for surface, _ in self._targets(command.state.draw_buffer)]
                    kept = self.textures, self.statistics
                    parts = draw_rectangle(command, self.profile, self._current, surfaces, *kept)
                    queue.fragments += sum(len(drawn.x) for drawn in parts)
                    undefined += parts[0].undefined if parts else 0
                    if record:
                        columns = [drawn[:4] for drawn in parts] or [np.zeros((4, 0), np.int32)]
                        records += [Fragments(*(c.astype(np.int32) for c in four)) for four in columns]
                elif kind is Saturate:
                    for surface, _ in self._targets(command.draw_buffer):
                        if not (target := surface.buffer(command.draw_buffer)).is_bytes:
                            self._flush()
                            target.saturate(command)
                elif kind is HostStep:
                    self._flush()
                    waiting = self._after_host(command, pixels, waiting)
                else:
                    if kind is TexImage:  # reads no framebuffer; what waits holds the textures that it reads
                        queue.outlive(self.textures.get(command.texture))
                    else:
                        self._flush()
                    self._transfer(command, pixels)
                if trace:
                    self._flush()
                    written = getattr(command, "state", command)
                    shown = self._current.buffer(getattr(written, "draw_buffer", ColorBuffer.BACK))
                    snapshots.append(snapshot(command, shown))
        finally:  # what was reached before an error is drawn
            self._flush()
        return Result(
            self.framebuffer,
            dict(self.surfaces),
            dict(self.textures),
            pixels,
            queue.fragments,
            dropped,
            undefined,
            tuple(snapshots),
            tuple(records),
            dict(self.statistics.histograms),
            dict(self.statistics.minmaxes),
        )

    def _after_host(self, step, pixels, waiting):
        """What the host issued and then what waits, all of it validated now."""
        issued = issued_by(step, pixels)
        validate(
            (*issued, *waiting),
            self.profile,
            self.width,
            self.height,
            self.depth_bits,
            self.textures,
            self.surfaces,
            self.statistics,
            read=pixels,
            host_step=step.label,
        )
        return deque((*issued, *waiting))

    def _targets(self, draw_buffer):
        """The framebuffers that a command writes to, each with its place in a pixel."""
        if self._samples is None or self._current is not self.framebuffer:
            return ((self._current, SAMPLE_POSITIONS[1][0]),)
        self._samples.write(draw_buffer)
        return self._samples.targets

    def _flush(self):
        """Everything is drawn, and the window's colours are its samples' means."""
        self._queue.flush()
        if self._samples is not None:
            self._samples.resolve()

    def _transfer(self, command, pixels):
        """What is neither Clear nor Draw; nothing waits in the queue."""
        kept = self.profile, self.statistics
        match command:
            case TexImage(pixels=None):
                self.textures[command.texture] = stored_texture(command.image, self.profile)
            case TexImage():
                self._define(command, defined_texture(command, *kept))
            case CopyTexImage():
                self._define(
                    command, copied_texture(self._current.buffer(command.read_buffer), command, *kept)
                )
            case CopyTexSubImage():
                texture, source = self.textures[command.texture], self._current.buffer(command.read_buffer)
                self._define(command, replaced_texture(source, command, texture, *kept))
            case ReadPixels():
                read = self._current.buffer(command.read_buffer).read(command, *kept)
                if read is not None:
                    pixels[command.name] = read
            case ResetHistogram():
                self.statistics.reset_histogram(command.name)
            case ResetMinmax():
                self.statistics.reset_minmax(command.name)
            case Accum(operation=AccumOperation.RETURN) if self._samples is not None:
                self._samples.share_accumulation()
                for surface, _ in self._targets(command.draw_buffer):
                    accumulate(surface, command, self.profile)
            case Accum():
                accumulate(self._current, command, self.profile)
            case MakeCurrent():
                self._current = self._surface(command)
            case BindTexImage():
                self.textures[command.texture] = bound_texture(self.surfaces[command.surface], command)

    def _define(self, command, texture):
        """Store a texture, unless a histogram's or minmax's sink took its image."""
        if texture is not None:
            self.textures[command.texture] = texture

    def _surface(self, command):
        """The framebuffer that a MakeCurrent names, made when it is named first."""
        if command.surface is None:
            return self.framebuffer
        if command.surface not in self.surfaces:
            self.surfaces[command.surface] = Framebuffer.new(
                command.width, command.height, command.depth_bits, command.color_format
            )
        return self.surfaces[command.surface]

    def _draws_columns(self, state, target):
        """Whether a Draw is the column engine's."""
        return self.engine == "columns" or column_engine.needs_columns(
            state, self.profile, target, self.textures
        )

    def _drawn_by_columns(self, command, target, position):
        """Draw by the column engine: its Fragments, and how many primitives were dropped."""
        state, profile = command.state, self.profile
        if self._unrounded is None:  # vertices' colours are rounded where the fragment's width is known
            self._unrounded = replace(profile, exact=True)
        size = target.width, target.height
        primitives = stage.process(command.mesh, state, self._unrounded, *size, position)
        if profile.subpixel_bits == NATIVE_SUBPIXEL_BITS:
            covered, lost = covered_pixels(primitives, state, profile, target.width, target.height)
        else:
            covered, lost = (
                column_engine.covered_triangles(primitives, state, profile, target),
                primitives.dropped,
            )
        passed = column_engine.column_draw(primitives, covered, state, profile, target, self.textures)
        columns = (
            np.asarray(column, np.int32) for column in (covered.triangle, covered.x, covered.y, passed)
        )
        return Fragments(*columns), lost

    def _prepared(self, command, position):
        state, target = command.state, self._current
        primitives = stage.process(command.mesh, state, self.profile, target.width, target.height, position)
        packed = pack.pack(state, self.profile, target, self.textures, primitives)
        return _prepare(target, primitives, packed, self.textures)


def _bins(primitives, draw, height):
    """(triangle numbers of every band behind one another, where each band's end, dropped triangles)."""
    bands = -(-height // BAND_HEIGHT)
    p, count = primitives, len(primitives.triangles)
    if p.orderly and not len(p.strokes):
        order, needed = np.empty(0, np.int32), 2 * count + 4 * bands
        while needed > len(order):
            order, ends = np.empty(needed, np.int32), np.empty(bands, np.int32)
            scratch = np.empty(len(p.x), np.int64), np.empty((4, CHUNK), np.int64), np.empty(count, np.int64)
            needed = sort_triangles(p.triangles, p.x, p.y, draw, *scratch, ends, order)
        return order[:needed], ends, 0
    counts, spans = np.empty(bands, np.int32), np.empty((count, 2), np.int32)
    dropped = count_bins(p.triangles, p.strokes, p.x, p.y, p.inverse_w, draw, counts, spans)
    ends = np.zeros(bands, np.int32)
    ends[1:] = np.cumsum(counts)[:-1]
    order = np.empty(int(counts.sum()), np.int32)
    fill_bins(spans, ends, order)
    return order, ends, int(dropped)


@dataclass(eq=False, slots=True)
class _Prepared:
    """A Draw up to its fragments.

    bound    (name, Texture) of each texture that it reads
    area     pixels of the scissor box; 0: nothing is left to draw, and what follows is not there
    size     bytes of vertices
    texels   of four units: their _Texels, or None; ``levels`` int32 [units, MAX_LEVELS, 3]
    order    primitives sorted into bands; ``ends``: where each band's end (``fixedpipe.raster.primitives.bins``)
    job      a row of the vector engine's table; False: it is the portable engine's; None: not asked yet
    beside   arrays that only this row names
    """

    dropped: int
    bound: tuple
    area: int = 0
    size: int = 0
    primitives: WindowPrimitives | None = None
    packed: pack.PackedState | None = None
    texels: list | None = None
    levels: np.ndarray | None = None
    order: np.ndarray | None = None
    ends: np.ndarray | None = None
    job: object = None
    beside: object = None

    def bands(self, first, step, batch, buffers, record):
        """Draw bands ``first``, ``first + step``, ... by the portable engine: how many fragments."""
        from fixedpipe.raster.portable.draw import (
            draw_bands,  # which a frame may do without, and its compilation
        )

        p, packed = self.primitives, self.packed
        texels = [_NO_TEXELS if texels is None else texels.packed for texels in self.texels]
        count = draw_bands(
            packed.draw, packed.draw_float, packed.program, packed.final, packed.constants, packed.arithmetic,
            packed.factors, p.triangles, p.strokes, p.x, p.y, packed.depths, p.inverse_w, p.colors,
            p.coordinates, p.fog, packed.fog_thresholds, *texels, self.levels, packed.units,
            self.order, self.ends, first, step, batch, *buffers, record,
        )  # fmt: skip
        if count < 0:
            raise ValueError(
                "A pass's rows would lead outside an array; take them from fixedpipe.pipeline.native.pack.pack."
            )
        return count

    def fill_job(self):
        """Make ``job``."""
        job = np.zeros((1, R.JOB_SIZE), np.int64)
        if not self._fill(job, _NO_FOUR, self.levels):
            self.job = False
            return
        self.job = job[0]
        # How a unit is sampled is known now, and so which textures are needed as row pairs.
        paths = job[0, R.JOB_UNIT_PATH : R.JOB_UNIT_PATH + 4].tolist()
        if paths != [C.PATH_DISABLED] * 4:
            pairs, levels = [_NO_TEXELS] * 4, [_NO_LEVELS] * len(self.levels)
            for i, (path, read) in enumerate(zip(paths, self.texels, strict=True)):
                if path != C.PATH_DISABLED:
                    pairs[i], levels[i] = read.pairs
            self.beside = pairs, _stacked(levels)
            self._fill(job, *self.beside)

    def _fill(self, job, pairs, levels):
        p, packed = self.primitives, self.packed
        if (plan := packed.derived.get("plan")) is None:
            plan = packed.derived["plan"] = plan_combiners(
                packed.draw, packed.program, packed.final, packed.constants, packed.arithmetic, packed.units
            ).rows
        return fill_draw(
            job, 0, packed.draw, packed.draw_float, plan, packed.factors, p.triangles, p.x, p.y,
            packed.depths, p.inverse_w, p.colors, p.coordinates, *pairs, levels, packed.units, self.order,
            self.ends,
        )  # fmt: skip


def _prepare(framebuffer, primitives, packed, textures):
    """Sort primitives into bands and bring together what kernels take."""
    p = primitives
    empty = len(p.triangles) == 0 or packed.area == 0
    order, ends, dropped = (None, None, 0) if empty else _bins(p, packed.draw, framebuffer.height)
    bound = tuple([(name, textures[name]) for _, name, _ in packed.reads])
    if empty or len(order) == 0:
        return _Prepared(dropped + p.dropped, bound)
    texels, levels = [None] * 4, [_NO_LEVELS] * len(packed.units)
    for i, name, signed in packed.reads:
        texels[i] = _texels(textures[name], signed)
        levels[i] = texels[i].levels
    size = p.colors.nbytes + p.coordinates.nbytes + 40 * len(p.x) + 16 * len(p.triangles) + 4 * len(order)
    return _Prepared(
        dropped + p.dropped, bound, packed.area, size, p, packed, texels, _stacked(levels), order, ends
    )


def _stacked(levels):
    """Levels int32 [1, MAX_LEVELS, 3] of each unit as one array."""
    return levels[0] if len(levels) == 1 else np.concatenate(levels)


class _Repeated:
    """Draws that the same run draws again: they are prepared once for as long as their textures stay."""

    def __init__(self, commands, samples):
        self._left = Counter([id(command) for command in commands if type(command) is Draw] * samples)
        self._kept, self._size = {}, 0

    def get(self, command, surface, textures):
        """The prepared Draw, or None."""
        found = self._kept.get((id(command), id(surface)))
        if found is None or not all([textures[name] is texture for name, texture in found.bound]):
            return None
        self._left[id(command)] -= 1
        if not self._left[id(command)]:
            del self._kept[id(command), id(surface)]
            self._size -= found.size
        return found

    def keep(self, command, surface, draw):
        """Keep a prepared Draw where it comes again."""
        self._left[id(command)] -= 1
        key = id(command), id(surface)
        if (stale := self._kept.pop(key, None)) is not None:
            self._size -= stale.size
        if self._left[id(command)] > 0 and self._size + draw.size <= _MOST_BYTES:
            self._kept[key] = draw
            self._size += draw.size


class _Queue:
    """Clears and Draws that wait to be drawn into one framebuffer, all by one engine."""

    def __init__(self, threads, batch):
        self.fragments = 0
        self._threads, self._batch = Threads(threads), batch
        self._jobs, self._counter = np.zeros((64, R.JOB_SIZE), np.int64), np.zeros(1, np.int64)
        self._scratch = {}
        self._empty()

    def _empty(self):
        self._target, self._count, self._draws, self._area, self._size = None, 0, [], 0, 0

    def draw(self, draw, target, engine):
        """A prepared Draw."""
        if draw.area == 0:
            return
        self._into(target)
        if engine == "portable":
            draw.job = False
        elif draw.job is None:
            draw.fill_job()
        if draw.job is False:
            if self._count:
                self.flush()
        else:
            if self._draws and not self._count:
                self.flush()
            self._job(target)[:] = draw.job
        self._target = target
        self._draws.append(draw)
        self._area += draw.area
        self._size += draw.size
        if self._size > _MOST_BYTES:
            self.flush()

    def clear(self, command, target, engine):
        """A Clear."""
        self._into(target)
        if engine == "portable" or (self._draws and not self._count):
            self.flush()
            target.clear(command)
            return
        box, buffers, *words = target.clear_words(command)
        fill_clear(self._job(target)[None], 0, *box, buffers, *words)
        self._area += (box[2] - box[0]) * (box[3] - box[1])

    def outlive(self, texture):
        """``texture`` is about to be replaced, and lives on in what waits: drawn when that is too much."""
        if texture is None or not self._draws:
            return
        self._size += sum(level.nbytes for level in texture.levels)
        if self._size > _MOST_BYTES:
            self.flush()

    def _into(self, target):
        """What waits is drawn where it goes to another of the window's colour buffers."""
        if self._target is not None and self._target is not target:
            self.flush()

    def _job(self, target):
        """The table's next row."""
        if self._count == len(self._jobs):
            self._jobs = np.concatenate([self._jobs, np.zeros_like(self._jobs)])
        self._target = target
        self._count += 1
        return self._jobs[self._count - 1]

    def flush(self):
        """Draw what waits. Each thread draws its own bands of rows, of all that waits."""
        if not (self._count or self._draws):
            return
        target, count, draws, area = self._target, self._count, self._draws, self._area
        self._empty()
        threads = self._threads.count if area >= _PARALLEL_FROM else 1
        buffers = _buffers(target)
        if count:
            self._counter[0] = 0

            def share(number, _kept=draws):  # the arrays that the table names live as long as this
                scratch = self._scratch_of(number)
                return draw_frame(self._jobs, count, self._counter, self._batch, buffers, scratch)

        else:

            def share(number):
                return sum([d.bands(number, threads, self._batch, buffers, _NO_RECORD) for d in draws])

        self.fragments += share(0) if threads == 1 else self._threads.run(share)

    def _scratch_of(self, number):
        if number not in self._scratch:
            self._scratch[number] = scratch(self._batch)
        return self._scratch[number]


def _buffers(framebuffer):
    """A framebuffer's arrays as kernels take them."""
    return Buffers(framebuffer.color.view(np.uint32)[..., 0], framebuffer.depth, framebuffer.stencil)


def _recorded(draw, framebuffer, batch):
    """Draw a prepared Draw, by the portable engine, and return its Fragments."""
    if draw.area == 0:
        return _fragments(_NO_RECORD)
    recording, buffers = np.empty((1 << 16, 4), np.int32), _buffers(framebuffer)
    fits = _most_fragments(draw.primitives) <= len(recording)
    saved = () if fits else [buffer.copy() for buffer in buffers]
    count = draw.bands(0, 1, batch, buffers, recording)
    if not fits and count > len(recording):  # it did not fit: once more, from the same framebuffer
        for buffer, before in zip(buffers, saved, strict=True):
            buffer[:] = before
        recording = np.empty((count, 4), np.int32)
        draw.bands(0, 1, batch, buffers, recording)
    return _fragments(recording[:count])


def _most_fragments(primitives):
    """A bound of how many fragments primitives make: what their bounding boxes hold, a pixel wider."""
    p = primitives
    if len(p.strokes) or not p.orderly:
        return math.inf
    vertices = p.triangles[:, :3]
    wide, high = (np.ptp(column[vertices].astype(np.float64), axis=1) / 16.0 + 2.0 for column in (p.x, p.y))
    return float((wide * high).sum())


def _fragments(rows):
    return Fragments(*(np.ascontiguousarray(rows[:, k]) for k in range(4)))


def execute(
    commands,
    profile,
    width,
    height,
    *,
    depth_bits=None,
    threads=None,
    batch=BATCH,
    trace=False,
    record=False,
    engine=None,
    samples=None,
    color_bits=None,
):
    """Run ``commands`` on a new machine. Returns a Result; see ``Machine`` for the parameters.

    Raises ``UnsupportedState`` for what the profile cannot hold and ValueError for what no
    machine could mean, each before anything is drawn.
    """
    batch = BATCH if batch is None else batch
    machine = Machine(
        profile,
        width,
        height,
        depth_bits,
        threads,
        batch,
        engine=engine,
        samples=samples,
        color_bits=color_bits,
    )
    return machine.run(commands, trace=trace, record=record)


def covered_pixels(primitives, state, profile, width, height):
    """What a state's primitives cover, whatever it writes there: (Fragments, primitives dropped).

    ``primitives``: with colours of any kind, which coverage does not read.
    """
    uncolored = replace(primitives, colors=np.zeros((len(primitives.x), 2, 8), np.uint8))
    polygon = replace(state.polygon, offset_fill=False, offset_line=False, offset_point=False)
    plain = PassState(
        polygon=polygon,
        line=state.line,
        point=state.point,
        scissor=state.scissor,
        window_clip=state.window_clip,
        color_mask=ColorMask(False, False, False, False),
    )
    framebuffer = _unwritten(width, height)
    packed = pack.pack(plain, profile, framebuffer, {}, uncolored)
    prepared = _prepare(framebuffer, uncolored, packed, {})
    return _recorded(prepared, framebuffer, BATCH), prepared.dropped


def rasterize(primitives, polygon, scissor, width, height):
    """Coverage alone: the Fragments of window primitives, culled and scissored, per pixel in draw order.

    ``primitives``: as ``fixedpipe.pipeline.vertices.stage.process`` makes them, contiguous columns of one length; they are not
    checked again. ``polygon``: a PolygonState; ``scissor``: a Scissor or None; ``width``, ``height`` of the
    framebuffer, pixels.
    """
    state, framebuffer = _coverage_state(polygon, scissor), _unwritten(width, height)
    packed = pack.pack(state, GEFORCE_256, framebuffer, {}, primitives)
    return _recorded(_prepare(framebuffer, primitives, packed, {}), framebuffer, BATCH)


@lru_cache(maxsize=64)
def _coverage_state(polygon, scissor):
    """A state that draws nothing, made once: rows are packed once for it as well."""
    nothing = ColorMask(False, False, False, False)
    return PassState(polygon=replace(polygon, offset_fill=False), scissor=scissor, color_mask=nothing)


@lru_cache(maxsize=2)
def _unwritten(width, height):
    """A framebuffer for states that write nothing."""
    return Framebuffer.new(width, height)
