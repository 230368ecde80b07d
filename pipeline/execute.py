"""Run a frame's commands on a machine: validate, pack, and drive the kernels one command at a time."""

import os
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass, field, replace
from numbers import Integral

import numpy as np

from pipeline import pack, vertex
from pipeline.commands import (
    BindTexImage,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    MakeCurrent,
    ReadPixels,
    TexImage,
)
from pipeline.framebuffer import Framebuffer, bound_texture, copied_texture, replaced_texture
from pipeline.profile import Profile
from pipeline.profiles import GEFORCE_256
from pipeline.state import ColorMask, PassState
from pipeline.texel_words import stored_texture
from pipeline.textures import Texture
from pipeline.trace import Snapshot, snapshot
from pipeline.validate import validate
from raster import rows as R
from raster.bins import BAND_HEIGHT, count_bins, fill_bins
from raster.draw import draw_bands

BATCH = 2048  # fragments shaded together; any size gives the same bits. Measured: docs/decisions, page 0002
_NO_RECORD = np.zeros((0, 4), np.int32)
_NO_TEXELS = np.zeros(1, np.uint32)
# Pixels of the scissor box: below this a second thread costs more than it saves (docs/decisions, page 0002).
_PARALLEL_FROM = 1 << 14


@dataclass(frozen=True, eq=False)
class Fragments:
    """Fragments as columns, all int32 [n]: primitive number, device pixel x and y (y down), and 1 where the
    fragment passed the per-fragment tests (0 where not; coverage alone says 1).

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
    fragments     how many fragments the Draws made
    dropped       how many primitives were dropped because a projected position was not usable
    trace         a Snapshot after every command, when asked for
    records       the Fragments of every Draw, when asked for
    """

    framebuffer: Framebuffer
    surfaces: dict[str, Framebuffer]
    textures: dict[str, Texture]
    pixels: dict[str, np.ndarray]
    fragments: int
    dropped: int
    trace: tuple[Snapshot, ...]
    records: tuple[Fragments, ...]

    def image(self):
        """The framebuffer's colours, uint8 [h, w, 4], top row first."""
        return self.framebuffer.image()


@dataclass(frozen=True, eq=False)
class _Texels:
    """A texture as kernels read it: every level behind the other, packed; and int32 [MAX_LEVELS, 3] where and
    how big.
    """

    packed: np.ndarray
    levels: np.ndarray


_texels_of = weakref.WeakKeyDictionary()


def _texels(texture, signed):
    """``signed``: bits that are inverted in every texel, so that filters see s + 128 for a signed byte s."""
    found = _texels_of.setdefault(texture, {})
    if signed not in found:
        levels, offset = np.ones((R.MAX_LEVELS, 3), np.int32), 0
        for k, level in enumerate(texture.levels):
            levels[k] = offset, level.shape[2], level.shape[1]
            offset += level[..., 0].size
        packed = np.concatenate(
            [np.ascontiguousarray(level).view(np.uint32).ravel() for level in texture.levels]
        )
        found[signed] = _Texels(packed ^ np.uint32(signed), levels)
    return found[signed]


def default_threads():
    """One thread per processor this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(eq=False)
class Machine:
    """A machine with its framebuffer, pbuffers and texture objects, which persist from run to run.

    Several Python threads may share one: a run waits until the one before it has ended.

    Parameters
    ----------
    profile : Profile
        Not an exact one: ``pipeline.ideal`` evaluates those.
    width, height : int
        Framebuffer size in pixels.
    depth_bits : int or DepthFormat
        One of ``profile.depth_bits``: a fixed format's width, or a format.
    threads : int or None
        Threads that share a Draw's bands of rows; None: one per processor. The bits are the same for any
        number.
    batch : int
        Fragments shaded together, 16 to 4096. The bits are the same for any number.
    """

    profile: Profile
    width: int
    height: int
    depth_bits: int = 24
    threads: int | None = None
    batch: int = BATCH
    textures: dict[str, Texture] = field(default_factory=dict)
    surfaces: dict[str, Framebuffer] = field(default_factory=dict)

    def __post_init__(self):
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
        validate((), self.profile, self.width, self.height, self.depth_bits)
        self.framebuffer = Framebuffer.new(self.width, self.height, self.depth_bits)
        bands = -(-self.height // BAND_HEIGHT)
        self._threads = min(self.threads or default_threads(), bands)
        self._pool = self._process = None
        self._current = self.framebuffer
        self._running = threading.Lock()

    def run(self, commands, *, trace=False, record=False):
        """Validate and run ``commands``; returns a Result.

        ``trace``: keep the framebuffer after every command. ``record``: keep every Draw's fragments.
        Raises ``pipeline.validate.UnsupportedState`` or ValueError, before anything is drawn.
        """
        commands = tuple(commands)
        with self._running:
            return self._run(commands, trace, record)

    def _run(self, commands, trace, record):
        validate(
            commands, self.profile, self.width, self.height, self.depth_bits, self.textures, self.surfaces
        )
        self._current = self.framebuffer
        pixels, snapshots, records = {}, [], []
        fragments = dropped = 0
        for command in commands:
            match command:
                case Clear():
                    self._current.clear(command)
                case Draw():
                    drawn, lost, recorded = self._draw(command, record)
                    fragments, dropped = fragments + drawn, dropped + lost
                    if record:
                        records.append(recorded)
                case TexImage():
                    self.textures[command.texture] = stored_texture(command.image, self.profile)
                case CopyTexImage():
                    self.textures[command.texture] = copied_texture(self._current, command)
                case CopyTexSubImage():
                    texture = self.textures[command.texture]
                    self.textures[command.texture] = replaced_texture(self._current, command, texture)
                case ReadPixels():
                    pixels[command.name] = self._current.read(command)
                case MakeCurrent():
                    self._current = self._surface(command)
                case BindTexImage():
                    self.textures[command.texture] = bound_texture(self.surfaces[command.surface], command)
            if trace:
                snapshots.append(snapshot(command, self._current))
        return Result(
            self.framebuffer,
            dict(self.surfaces),
            dict(self.textures),
            pixels,
            fragments,
            dropped,
            tuple(snapshots),
            tuple(records),
        )

    def _surface(self, command):
        """The framebuffer that a MakeCurrent names, made when it is named first."""
        if command.surface is None:
            return self.framebuffer
        if command.surface not in self.surfaces:
            self.surfaces[command.surface] = Framebuffer.new(
                command.width, command.height, command.depth_bits, command.color_format
            )
        return self.surfaces[command.surface]

    def _draw(self, command, record):
        state, target = command.state, self._current
        primitives = vertex.process(command.mesh, state, self.profile, target.width, target.height)
        packed = pack.pack(state, self.profile, target, self.textures, primitives)
        return _rasterize(
            target,
            primitives,
            packed,
            state,
            self.textures,
            self.batch,
            self._threads,
            self._workers,
            record,
        )

    def _workers(self):
        """The pool of threads beside the caller's, made when first needed: a forked process has none."""
        if self._pool is None or self._process != os.getpid():
            self._pool, self._process = ThreadPoolExecutor(self._threads - 1, "fixedpipe"), os.getpid()
        return self._pool


def _bins(primitives, draw, height):
    """(triangle numbers of every band behind one another, where each band's end, dropped triangles)."""
    bands = -(-height // BAND_HEIGHT)
    counts, spans = np.empty(bands, np.int32), np.empty((len(primitives.triangles), 2), np.int32)
    p = primitives
    dropped = count_bins(p.triangles, p.strokes, p.x, p.y, p.inverse_w, draw, counts, spans)
    ends = np.zeros(bands, np.int32)
    ends[1:] = np.cumsum(counts)[:-1]
    order = np.empty(int(counts.sum()), np.int32)
    fill_bins(spans, ends, order)
    return order, ends, int(dropped)


def _rasterize(framebuffer, primitives, packed, state, textures, batch, threads, workers, record):
    """Run the kernels over a Draw's triangles; returns (fragments, dropped, Fragments or None).

    ``workers`` gives the pool of the threads beside this one; it is not asked where one thread is enough.
    """
    draw, p = packed.draw, primitives
    empty = len(p.triangles) == 0 or draw[R.X0] >= draw[R.X1] or draw[R.Y0] >= draw[R.Y1]
    order, ends, dropped = (None, None, 0) if empty else _bins(p, draw, framebuffer.height)
    if empty or len(order) == 0:
        return 0, dropped + p.dropped, _fragments(_NO_RECORD) if record else None
    texels, levels = [_NO_TEXELS] * 4, np.ones((len(packed.units), R.MAX_LEVELS, 3), np.int32)
    for i, unit in enumerate(state.texture_units):
        if unit is not None and packed.units[i, R.ENABLED] and unit.texture is not None:
            found = _texels(textures[unit.texture], int(packed.units[i, R.SIGNED]))
            texels[i], levels[i] = found.packed, found.levels
    color = framebuffer.color.view(np.uint32)[..., 0]

    def bands(first, step, recording):
        return draw_bands(
            draw, packed.draw_float, packed.program, packed.final, packed.constants, packed.arithmetic,
            packed.factors, p.triangles, p.strokes, p.x, p.y, packed.depths, p.inverse_w, p.colors,
            p.coordinates, p.fog, packed.fog_thresholds, *texels, levels, packed.units, order, ends,
            first, step, batch, color, framebuffer.depth, framebuffer.stencil, recording,
        )  # fmt: skip

    if record:
        recording = np.empty((1 << 16, 4), np.int32)
        saved = framebuffer.color.copy(), framebuffer.depth.copy(), framebuffer.stencil.copy()
        count = bands(0, 1, recording)
        if count > len(recording):  # it did not fit: once more, from the same framebuffer
            framebuffer.color[:], framebuffer.depth[:], framebuffer.stencil[:] = saved
            recording = np.empty((count, 4), np.int32)
            bands(0, 1, recording)
        return count, dropped + p.dropped, _fragments(recording[:count])
    area = (draw[R.X1] - draw[R.X0]) * (draw[R.Y1] - draw[R.Y0])
    threads = threads if area >= _PARALLEL_FROM else 1
    others = [workers().submit(bands, k, threads, _NO_RECORD) for k in range(1, threads)]
    try:
        count = bands(0, threads, _NO_RECORD)
    finally:
        wait(others)  # however this ends, nothing draws on behind the caller's back
    return count + sum(other.result() for other in others), dropped + p.dropped, None


def _fragments(rows):
    return Fragments(*(np.ascontiguousarray(rows[:, k]) for k in range(4)))


def execute(
    commands, profile, width, height, *, depth_bits=24, threads=None, batch=BATCH, trace=False, record=False
):
    """Run ``commands`` on a new machine. Returns a Result; see ``Machine`` for the parameters.

    Raises ``pipeline.validate.UnsupportedState`` for what the profile cannot hold and ValueError for what no
    machine could mean, each before anything is drawn.
    """
    machine = Machine(profile, width, height, depth_bits, threads, BATCH if batch is None else batch)
    return machine.run(commands, trace=trace, record=record)


def rasterize(primitives, polygon, scissor, width, height):
    """Coverage alone: the Fragments of window primitives, culled and scissored, per pixel in draw order.

    ``primitives``: as ``pipeline.vertex.process`` makes them, contiguous columns of one length; they are not
    checked again. ``polygon``: a PolygonState; ``scissor``: a Scissor or None; ``width``, ``height`` of the
    framebuffer, pixels.
    """
    nothing = ColorMask(False, False, False, False)
    state = PassState(polygon=replace(polygon, offset_fill=False), scissor=scissor, color_mask=nothing)
    framebuffer = Framebuffer.new(width, height)
    packed = pack.pack(state, GEFORCE_256, framebuffer, {}, primitives)
    return _rasterize(framebuffer, primitives, packed, state, {}, BATCH, 1, None, True)[2]
