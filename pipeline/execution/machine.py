"""The machine: it validates a frame and runs its commands one after the other.

Clears and Draws wait in a queue (``fixedpipe.pipeline.native.queue``) until a command reads what they draw.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import partial
from numbers import Integral
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.columns.engine import column_draw, needs_columns
from fixedpipe.pipeline.columns.rectangles import draw_rectangle
from fixedpipe.pipeline.columns.replaced_stages import ReplacedStages
from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    Clear,
    Command,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    GetTexImage,
    HostStep,
    MakeCurrent,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.enums import AccumOperation, Clamp, ColorBuffer
from fixedpipe.pipeline.framebuffers.accumulation import accumulate, clear_accumulation
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.framebuffers.multisample import Samples, sampled
from fixedpipe.pipeline.framebuffers.result import Fragments, Result
from fixedpipe.pipeline.framebuffers.snapshot import Snapshot, snapshot
from fixedpipe.pipeline.framebuffers.texture_copies import (
    bound_texture,
    copied_texture,
    defined_texture,
    replaced_texture,
)
from fixedpipe.pipeline.framebuffers.texture_queries import texture_pixels
from fixedpipe.pipeline.framebuffers.transfer import PixelStatistics
from fixedpipe.pipeline.framebuffers.widths import fragment_bits
from fixedpipe.pipeline.interned_states import interned
from fixedpipe.pipeline.multi_draw import MultiDraw, RowDraws
from fixedpipe.pipeline.native.background_compiling import chosen_engine, covers_by_kernels
from fixedpipe.pipeline.native.coverage import covered_pixels, covered_triangles
from fixedpipe.pipeline.native.prepared_draw import Prepared
from fixedpipe.pipeline.native.queue import BATCH, KeptDraws, Queue
from fixedpipe.pipeline.native.state_records import StateRecords
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.pipeline.profiles.profile import NATIVE_BITS, NATIVE_SUBPIXEL_BITS, Profile
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.textures.words import stored_texture
from fixedpipe.pipeline.validation.frames import commands_of, frame_of
from fixedpipe.pipeline.validation.validate import ValidFrame, begun, validate
from fixedpipe.pipeline.vertices import stage
from fixedpipe.raster.observer import unobserved
from fixedpipe.raster.primitives.bins import BAND_HEIGHT

Engine = Literal["portable", "columns"]
ENGINES = (None, *get_args(Engine))
# Bytes of primitives that the records of a run keep, for the ideal that follows: enough for any figure's.
_MOST_HELD = 1 << 27
# Rows of a MultiDraw that one call takes: its arrays are made before it begins.
_MOST_ROWS = 1024
# Takes (the command that has run, a function that makes its Snapshot until the next command runs).
Watch: TypeAlias = Callable[[Command, Callable[[], Snapshot]], None]


@dataclass(eq=False)
class _Frame:
    """A running frame: its waiting commands, and the results of the others (``Result``).

    - ``valid``: the waiting commands.
    - ``kept``: Draws that the frame repeats.
    - ``engine``: the engine that draws, of ``ENGINES``.
    - ``record``: whether every Draw's fragments are kept.
    - ``held``: bytes of the primitives that the records keep.
    """

    valid: ValidFrame
    kept: KeptDraws
    engine: Engine | None
    record: bool
    pixels: dict[str, NDArray[Any]] = field(default_factory=dict)
    snapshots: list[Snapshot] = field(default_factory=list)
    records: list[Any] = field(default_factory=list)  # Fragments; None: the Draw still waits
    held: int = 0
    dropped: int = 0
    undefined: int = 0

    def next_record(self, command, primitives, size):
        """Where the Fragments of a Draw go, a function: to the next place of ``records``.

        ``size``: bytes of its primitives, or None.
        """
        place, self.held = len(self.records), self.held + size
        whole = self.held <= _MOST_HELD
        self.records.append(None)

        def keep(drawn):
            if primitives is not None:
                drawn = replace(drawn, command=command, primitives=primitives)
            self.records[place] = drawn if whole else drawn.without_primitives()

        return keep


@dataclass(eq=False)
class Machine:
    """A machine whose framebuffer, pbuffers, textures, histograms and minmaxes persist from run to run.

    Several Python threads may share a machine: a run waits until the earlier one has ended.

    - ``profile``: Profile, not an exact one: ``fixedpipe.pipeline.ideal.evaluate`` evaluates those.
    - ``width``, ``height``: int, the framebuffer's size in pixels.
    - ``depth_bits``: int, DepthFormat or None. One of ``profile.framebuffers.depth_bits``: a fixed format's
      width, or a format. None: the widest fixed format.
    - ``threads``: int or None. Threads that share a Draw's bands of rows; None: one per processor. The bits
      are the same for any number.
    - ``batch``: int, fragments shaded together, 16 to 4096. The bits are the same for any number.
    - ``textures``, ``surfaces``: texture objects and pbuffers by name, which the machine holds at first.
    - ``engine``: Engine or None. None: the fastest kernels that cover a Draw draw it. "portable": the kernels
      that cover all draw every Draw. "columns": the column engine draws every Draw that it covers. The bits
      are the same.
    - ``statistics``: PixelStatistics, the histograms and minmaxes that it holds at first.
    - ``samples``: int or None. Samples of a pixel of the window, one of ``profile.framebuffers.samples``;
      None: the profile's first. Each pbuffer has its own number.
    - ``color_bits``: int or None. One of ``profile.framebuffers.color_bits``, the width of the window's
      colour components. None: the usual one.
    - ``observer``: callable, called with each command and with the column engine's work for it
      (``fixedpipe.raster.observer``): with ``engine="columns"``, with every fragment.
    - ``replaced_stages``: callable or None, with ``engine="columns"`` alone. It gives for a Draw the
      ReplacedStages: which stages compute in real numbers, or without a clamp. None: no stage does.

    Raises ValueError for a value that the machine does not take, and UnsupportedState for a window that the
    profile does not have.
    """

    profile: Profile
    width: int
    height: int
    depth_bits: int | None = None
    threads: int | None = None
    batch: int = BATCH
    textures: dict[str, Texture] = field(default_factory=dict)
    surfaces: dict[str, Framebuffer] = field(default_factory=dict)
    engine: Engine | None = None
    statistics: PixelStatistics = field(default_factory=PixelStatistics)
    samples: int | None = None
    color_bits: int | None = None
    observer: Callable[..., None] = unobserved
    replaced_stages: Callable[[Draw], ReplacedStages | None] | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.profile, Profile):
            raise ValueError(
                f"The machine's profile is {self.profile!r}; give a Profile, such as "
                'fixedpipe.pipeline.profiles.PROFILES["GEFORCE_256"].'
            )
        if self.profile.arithmetic.exact:
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
        if self.replaced_stages is not None and self.engine != "columns":
            raise ValueError('Only the column engine can change stages; give engine="columns".')
        if self.color_bits is None:
            self.color_bits = self.profile.framebuffers.color_bits[0]
        if self.depth_bits is None:
            self.depth_bits = self.profile.widest_depth
        if self.samples is None:
            self.samples = self.profile.framebuffers.samples[0]
        window = {"samples": self.samples, "color_bits": self.color_bits}
        validate((), self.profile, self.width, self.height, self.depth_bits, **window)
        self.framebuffer: Framebuffer = Framebuffer.new(
            self.width,
            self.height,
            self.depth_bits,
            color_bits=self.color_bits,
            clamped=Clamp.BLENDING in self.profile.arithmetic.clamps,
        )
        bands = -(-self.height // BAND_HEIGHT)
        self._queue: Queue = Queue(min(self.threads or default_threads(), bands), self.batch)
        self._records: StateRecords = StateRecords(self.profile, needs_columns)
        self._current: Framebuffer = self.framebuffer
        self._samples: Samples | None = Samples(self.framebuffer, self.samples) if self.samples > 1 else None
        self._surface_samples: dict[str, Samples] = {}  # of the pbuffers with several samples
        self._drawn_samples: Samples | None = self._samples  # of the current draw target
        self._running: threading.Lock = threading.Lock()
        self._runner: int | None = None

    def run(
        self, commands: Iterable[Command | MultiDraw], *, trace: bool | Watch = False, record: bool = False
    ) -> Result:
        """Validate and run ``commands``. Returns a Result.

        - ``trace``: True stores a copy of the framebuffer after every command. A Watch is called after each
          command instead.
        - ``record``: whether to store every Draw's fragments.

        Raises ``UnsupportedState`` or ValueError before anything is drawn; for the commands that a HostStep
        issues, before any of these is drawn.
        """
        # A MultiDraw is drawn as a whole only if nothing needs the result of a single Draw.
        together = not (trace or record or self._samples or self.engine) and self.observer is unobserved
        commands = commands_of(commands) if together else frame_of(commands)
        if record and self._samples:
            raise ValueError(
                f"A machine with {self.samples} samples in each pixel records no fragments; give samples=1."
            )
        if self._runner == threading.get_ident():
            raise ValueError(
                "A HostStep's function runs commands on its own machine, which waits for the function; let "
                "it return the commands."
            )
        with self._running:
            self._runner = threading.get_ident()
            try:
                return self._run(commands, trace, record)
            finally:
                self._runner = None

    def _run(self, commands, trace, record):
        held = self.width, self.height, self.depth_bits, self.textures, self.surfaces, self.statistics
        valid = ValidFrame(commands, lambda read: begun(self.profile, *held, read, samples=self.samples or 1))
        self._current, self._drawn_samples = self.framebuffer, self._samples
        frame = _Frame(valid, KeptDraws(commands, self.samples), chosen_engine(self.engine), record)
        self._queue.fragments = 0
        try:
            while valid.waiting:
                command = valid.waiting.popleft()
                kind = type(command)
                if kind not in _QUEUED:
                    self._flush()
                self.observer("command", command=command)
                _ALL_METHODS[kind](self, command, frame)
                if callable(trace):
                    trace(command, partial(self._snapshot, command))
                elif trace:
                    frame.snapshots.append(self._snapshot(command))
        finally:  # Draw what ran before an error.
            self._flush()
            self._share_depths()
        return Result(
            self.profile,
            self.framebuffer,
            dict(self.surfaces),
            dict(self.textures),
            frame.pixels,
            self._queue.fragments,
            frame.dropped,
            frame.undefined,
            tuple(frame.snapshots),
            tuple(frame.records),
            dict(self.statistics.histograms),
            dict(self.statistics.minmaxes),
        )

    def drawn(self) -> Framebuffer:
        """The framebuffer that commands draw to now, with everything drawn: the window, or a pbuffer."""
        self._flush()
        return self._current

    def _snapshot(self, command):
        """The Snapshot of the framebuffer that a command has just drawn to."""
        self._flush()
        written = getattr(command, "state", command)
        shown = self._current.buffer(getattr(written, "draw_buffer", ColorBuffer.BACK))
        return snapshot(command, shown)

    def _targets(self, draw_buffer):
        """The framebuffers that a command writes to, each with its place in a pixel.

        The place is None where the framebuffer has one sample.
        """
        if self._drawn_samples is None:
            return ((self._current, None),)
        self._drawn_samples.write(draw_buffer)
        return self._drawn_samples.targets

    def _flush(self):
        """Draw everything that waits, and set colours to the samples' means."""
        self._queue.flush()
        if self._drawn_samples is not None:
            self._drawn_samples.resolve()

    # Every command's method takes the command and its _Frame.

    def _draw(self, command, frame):
        mesh, size = command.mesh, (self._current.width, self._current.height)
        record = self._records.of(mesh, interned(command.state), self._current, self.textures)
        state, textures = record.state, record.textures
        by_columns = self._draws_columns(record, frame.engine)
        submits = self._drawn_samples is None and frame.engine is None and not frame.record
        for number, (surface, place) in enumerate(self._targets(state.draw_buffer)):
            position, sample = sampled(place, self.profile)
            target = surface.buffer(state.draw_buffer)
            if by_columns:
                self._queue.flush()
                given = command, state, textures, target, position, sample
                drawn, primitives, lost = self._drawn_by_columns(*given)
                self._queue.fragments += len(drawn.x)
                if frame.record and number == 0:
                    frame.next_record(command, primitives, primitives.size)(drawn)
                continue
            draw = frame.kept.get(command, surface, textures)
            if draw is None:
                draw = record.submitted(mesh) if submits else None
                if draw is None:
                    # Vertices' colours are rounded at the fragments' width.
                    rounded = fragment_bits(self.profile, target) == NATIVE_BITS
                    primitives = stage.process(mesh, state, self.profile, *size, position, rounded=rounded)
                    draw = Prepared.of(primitives, state, self.profile, self._current, textures, sample)
                frame.kept.keep(command, surface, draw)
            lost = draw.dropped
            recorded = frame.record and number == 0  # a pbuffer's first sample
            keep = frame.next_record(command, draw.primitives, draw.size) if recorded else None
            self._queue.draw(draw, target, frame.engine, keep)
        frame.dropped += lost  # every sample drops the same number

    def _multi_draw(self, command, frame):
        """Draw the rows of a MultiDraw together, and those one by one that kernels do not take together."""
        numbers, one, row, most = command.state_numbers, RowDraws(command), 0, _MOST_ROWS
        while row < len(numbers):
            others = np.flatnonzero(numbers[row : row + most] != numbers[row])
            rows = range(row, row + int(others[0]) if len(others) else min(row + most, len(numbers)))
            done = self._rows_drawn(command, rows, frame.engine)
            if not done:
                self._draw(one[row], frame)
            # Arrays are made for all of the rows that are tried.
            row, most = row + max(done, 1), min(2 * most, _MOST_ROWS) if done else max(most // 4, 1)

    def _rows_drawn(self, command, rows, engine):
        """Draw rows of a MultiDraw in one state, as far as kernels take them together; returns how many."""
        if engine is not None or self._drawn_samples is not None:
            return 0
        state = interned(command.states[command.state_numbers[rows.start]])
        record = self._records.of(command.mesh, state, self._current, self.textures)
        if self._draws_columns(record, engine):
            return 0
        target = self._current.buffer(record.state.draw_buffer)
        jobs = self._queue.room(len(rows), target)
        done, filled, draw = record.submitted_runs(command, slice(rows.start, rows.stop), jobs)
        if filled:
            self._queue.filled(filled, draw, target)
        return done

    def _draws_columns(self, record, engine):
        """Whether the column engine draws a Draw in the state of a StateRecord."""
        if "columns" in (self.engine, engine):
            return True
        return record.by_columns or not (record.native or covers_by_kernels())

    def _drawn_by_columns(self, command, state, textures, target, position, sample):
        """Draw with the column engine; returns its Fragments, its primitives and how many were dropped."""
        profile, size = self.profile, (target.width, target.height)
        # Vertices' colours are rounded at the fragments' width.
        primitives = stage.process(command.mesh, state, profile, *size, position, rounded=False)
        if profile.arithmetic.subpixel_bits == NATIVE_SUBPIXEL_BITS:
            covered, lost = covered_pixels(primitives, state, profile, *size, sample)
        else:
            covered = covered_triangles(primitives, state, profile, target)
            lost = primitives.dropped
        replaced = None if self.replaced_stages is None else self.replaced_stages(command)
        given = primitives, covered, state, profile, target, textures
        passed = column_draw(*given, self.observer, replaced)
        columns = (covered.triangle, covered.x, covered.y, passed)
        triangle, x, y, passed = (np.asarray(column, np.int32) for column in columns)
        return Fragments(triangle, x, y, passed), primitives, lost

    def _clear(self, command, frame):
        for surface, _ in self._targets(command.draw_buffer):
            target = surface.buffer(command.draw_buffer)
            by_kernels = target.is_bytes and frame.engine is None
            self._queue.clear(command, target, frame.engine if by_kernels else "portable")
        if command.accumulation is not None:
            clear_accumulation(self._current, command, self.profile)

    def _rectangle(self, command, frame):
        surfaces = [surface for surface, _ in self._targets(command.state.draw_buffer)]
        held = self.textures, self.statistics, self.observer
        parts = draw_rectangle(command, self.profile, self._current, surfaces, *held)
        self._queue.fragments += sum(len(drawn.x) for drawn in parts)
        frame.undefined += parts[0].undefined if parts else 0
        if frame.record:
            columns = [drawn[:4] for drawn in parts] or [np.zeros((4, 0), np.int32)]
            frame.records += [Fragments(*(c.astype(np.int32) for c in four)) for four in columns]

    def _saturate(self, command, frame):
        for surface, _ in self._targets(command.draw_buffer):
            if not (target := surface.buffer(command.draw_buffer)).is_bytes:
                self._flush()
                target.saturate(command)

    def _host_step(self, command, frame):
        frame.valid.issue(command, frame.pixels)

    def _tex_image(self, command, frame):
        # It reads no framebuffer, and waiting work holds the textures that it reads.
        self._queue.outlive(self.textures.get(command.texture))
        if command.pixels is None:
            self.textures[command.texture] = stored_texture(command.image, self.profile)
        else:
            given = self.profile, self.statistics, self.textures.get(command.texture)
            self.textures[command.texture] = defined_texture(command, *given)

    def _copy_tex_image(self, command, frame):
        source = self._current.buffer(command.read_buffer)
        given = self.profile, self.statistics, self.textures.get(command.texture)
        self.textures[command.texture] = copied_texture(source, command, *given)

    def _copy_tex_sub_image(self, command, frame):
        texture, source = self.textures[command.texture], self._current.buffer(command.read_buffer)
        given = texture, self.profile, self.statistics
        self.textures[command.texture] = replaced_texture(source, command, *given)

    def _bind_tex_image(self, command, frame):
        self._share_depths()
        samples = self._surface_samples.get(command.surface)
        self.textures[command.texture] = bound_texture(self.surfaces[command.surface], command, samples)

    def _read_pixels(self, command, frame):
        read = self._current.buffer(command.read_buffer).read(command, self.profile, self.statistics)
        if read is not None:
            frame.pixels[command.name] = read

    def _get_tex_image(self, command, frame):
        read = texture_pixels(self.textures[command.texture], command, self.profile, self.statistics)
        if read is not None:
            frame.pixels[command.name] = read

    def _reset_histogram(self, command, frame):
        self.statistics.reset_histogram(command.name)

    def _reset_minmax(self, command, frame):
        self.statistics.reset_minmax(command.name)

    def _accum(self, command, frame):
        if command.operation != AccumOperation.RETURN or self._drawn_samples is None:
            accumulate(self._current, command, self.profile)
            return
        self._drawn_samples.share_accumulation()
        for surface, _ in self._targets(command.draw_buffer):
            accumulate(surface, command, self.profile)

    def _make_current(self, command, frame):
        """Make a framebuffer current; a pbuffer is created at its first use."""
        self._share_depths()
        if command.surface is None:
            self._current, self._drawn_samples = self.framebuffer, self._samples
            return
        name, samples = command.surface, command.samples
        if name not in self.surfaces:
            size = command.width, command.height, command.depth_bits
            shared = {"shares_depth": command.shares_depth, "depth_of": command.depth_of}
            self.surfaces[name] = Framebuffer.new(*size, command.color_format, samples=samples, **shared)
            if samples > 1:
                self._surface_samples[name] = Samples(self.surfaces[name], samples)
            if command.shares_depth:
                self._take_depths(name, command.depth_of)
        self._current, self._drawn_samples = self.surfaces[name], self._surface_samples.get(name)

    def _share_depths(self):
        """Copy the current framebuffer's depths to the framebuffers that share them."""
        current = next((name for name, made in self.surfaces.items() if made is self._current), None)
        owner = self._current.depth_of if self._current.shares_depth else current
        if self._current.shares_depth:
            self._take_depths(owner, current)
        for name, made in self.surfaces.items():
            if made.shares_depth and made.depth_of == owner and name != current:
                self._take_depths(name, owner)

    def _take_depths(self, name, source):
        """Copy a framebuffer's depths and stencil values from another's, by sample; None is the window."""
        taken, given = (
            [made for made, _ in samples.targets] if samples else [self.surfaces.get(one, self.framebuffer)]
            for one in (name, source)
            for samples in [self._samples if one is None else self._surface_samples.get(one)]
        )
        for to, of in zip(taken, given, strict=True):
            to.take_depths(of)


METHODS = {
    Clear: Machine._clear,
    Draw: Machine._draw,
    TexImage: Machine._tex_image,
    CopyTexImage: Machine._copy_tex_image,
    CopyTexSubImage: Machine._copy_tex_sub_image,
    ReadPixels: Machine._read_pixels,
    GetTexImage: Machine._get_tex_image,
    HostStep: Machine._host_step,
    Saturate: Machine._saturate,
    Accum: Machine._accum,
    DrawPixels: Machine._rectangle,
    CopyPixels: Machine._rectangle,
    Bitmap: Machine._rectangle,
    MakeCurrent: Machine._make_current,
    BindTexImage: Machine._bind_tex_image,
    ResetHistogram: Machine._reset_histogram,
    ResetMinmax: Machine._reset_minmax,
}
_ALL_METHODS = {**METHODS, MultiDraw: Machine._multi_draw}  # a MultiDraw stands for commands, and is none
# Commands that wait in the queue, or read no framebuffer. Before any other command everything is drawn.
_QUEUED = frozenset({Draw, MultiDraw, Clear, Saturate, TexImage, GetTexImage})


def execute(
    commands: Iterable[Command | MultiDraw],
    profile: Profile,
    width: int,
    height: int,
    *,
    depth_bits: int | None = None,
    threads: int | None = None,
    batch: int | None = BATCH,
    trace: bool | Watch = False,
    record: bool = False,
    engine: Engine | None = None,
    samples: int | None = None,
    color_bits: int | None = None,
) -> Result:
    """Run ``commands`` on a new machine. Returns a Result. ``Machine`` describes the parameters.

    Raises ``UnsupportedState`` for a command that the profile cannot execute, and ValueError for one without
    a meaning on any machine. Both are raised before anything is drawn.
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
