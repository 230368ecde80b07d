"""Random frames on every engine, and small ones through the specification: no bit may differ.

``python -m tests.fuzz --seconds 600`` draws frame after frame (``tests.support.random_frames``) and compares
framebuffers, pbuffers, textures, what ReadPixels read, and how many fragments were drawn. A difference ends
it with the seed, the smallest frame found that still differs, in words, and its first pixels;
``python -m tests.fuzz --seed S`` draws that frame again.
"""

import argparse
import inspect
import sys
import threading
import time
from dataclasses import dataclass, field, fields, replace

import numpy as np

from fixedpipe.effects.tasks.executors import opened
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.ordered import in_order
from fixedpipe.effects.tasks.task import Task
from fixedpipe.pipeline.commands import Draw, MakeCurrent, Mesh, TexImage
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.native.queue import BATCH
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import PassState
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.raster.kernel import is_cold
from tests.support.inputs import inputs_here
from tests.support.random_frames import random_frame
from tests.support.run_reference import run_reference

SHRINKING_SECONDS = 60.0
# Frames that one Machine draws one after the other, or several Python threads at once.
SHARED_SIZES = ((12, 40), (100, 70))
SHARED_PROFILE, SHARED_DEPTH_BITS = NV2A, 24


def _engines():
    """Names of the engines that a Machine can be asked for, without the one it chooses itself."""
    parameter = inspect.signature(Machine).parameters.get("engine")
    return () if parameter is None else ("portable", "columns")


ENGINES = _engines()


# ---------------------------------------------------------------------------------------------- outcomes


@dataclass(frozen=True)
class Way:
    """A way to draw a frame. ``pieces``: each command in a run of its own; ``engine`` None: the Machine's
    choice; ``reference``: by the specification, and the others do not matter.
    """

    engine: str | None = None
    threads: int = 1
    batch: int = BATCH
    pieces: bool = False
    record: bool = False
    reference: bool = False

    def __str__(self):
        if self.reference:
            return "the specification"
        engine = "the machine" if self.engine is None else f"the machine, {self.engine} engine"
        more = ", a run for each command" if self.pieces else ", recording" if self.record else ""
        return f"{engine}, threads={self.threads}, batch={self.batch}{more}"


def outcome(frame, way):
    """What drawing gave: name to array, or to a number."""
    if way.reference:
        return _specified(frame)
    engine = {} if way.engine is None else {"engine": way.engine}
    machine = Machine(
        frame.profile, frame.width, frame.height, frame.depth_bits, way.threads, way.batch, **engine
    )
    if way.pieces and not any(type(command) is MakeCurrent for command in frame.commands):
        # A run begins with the window: a MakeCurrent is no run of its own.
        results = [machine.run((command,)) for command in frame.commands]
    else:
        results = [machine.run(frame.commands, record=way.record)]
    made = _buffers("window", results[-1].framebuffer)
    for name, surface in results[-1].surfaces.items():
        made |= _buffers(f"pbuffer {name}", surface)
    for name, texture in results[-1].textures.items():
        for k, level in enumerate(texture.levels):
            made[f"texture {name}, level {k}"] = level
    for result in results:
        made |= {f"pixels {name}": pixels for name, pixels in result.pixels.items()}
    made["fragments"] = np.int64(sum(result.fragments for result in results))
    made["dropped"] = np.int64(sum(result.dropped for result in results))
    return made


def _buffers(name, target):
    planes = ("color", "depth", "stencil")  # whose rows may be another's, and longer
    return {f"{name} {kind}": np.array([r[: target.width] for r in getattr(target, kind)]) for kind in planes}


def _specified(frame):
    expected = run_reference(frame.commands, frame.profile, frame.width, frame.height, frame.depth_bits)
    made = _buffers("window", expected.target)
    for name, surface in expected.surfaces.items():
        made |= _buffers(f"pbuffer {name}", surface)
    changed = {c.texture for c in frame.commands if hasattr(c, "texture") and not isinstance(c, TexImage)}
    for name in changed & set(expected.textures):
        for k, level in enumerate(expected.textures[name].levels):
            made[f"texture {name}, level {k}"] = np.array(level)
    return made | {f"pixels {name}": np.array(pixels) for name, pixels in expected.pixels.items()}


def differing(first, second):
    """Names, of those that both have, under which two outcomes differ."""
    found = []
    for name in first.keys() & second.keys():
        a, b = first[name], second[name]
        if a.size != b.size or not np.array_equal(a, b.reshape(a.shape)):
            found.append(name)
    return sorted(found)


def ways_of(frame):
    """The ways in which a frame is drawn beside the plain one: the seed's choice of many."""
    choice = np.random.default_rng(frame.seed)
    ways = [Way(engine) for engine in ENGINES]
    threads, batch = int(choice.choice([1, 2, 3])), int(choice.choice([16, 17, 64, 256, 1000, 4096]))
    ways.append(Way(choice.choice(ENGINES) if ENGINES and choice.random() < 0.5 else None, threads, batch))
    if choice.random() < 0.3:
        ways.append(Way(pieces=True))
    if choice.random() < 0.1:
        ways.append(Way(record=True))
    return ways


# -------------------------------------------------------------------------------------------- mismatches


@dataclass
class Mismatch(Exception):  # noqa: N818 (it names what was found)
    """Two ways to draw a frame gave different bits."""

    frame: object
    ways: tuple
    names: list
    advice: str = ""
    first: dict = field(default_factory=dict)
    second: dict = field(default_factory=dict)

    def __str__(self):
        frame = self.frame
        lines = [
            f"Seed {frame.seed}: {self.ways[0]}  differs from  {self.ways[1]}",
            f"in {', '.join(self.names)}.",
            self.advice or f"Again: {_again(frame)}",
            f"{frame.profile.name}, {frame.width}x{frame.height}, depth format {frame.depth_bits}",
            "",
            describe(frame.commands),
        ]
        for name in self.names:
            lines.append(_first_differences(name, self.first[name], self.second[name]))
        for command in frame.commands:
            if isinstance(command, Draw) and len(command.mesh.positions) <= 12:
                lines.append(f"{command.label}: {_arrays(command.mesh)}")
                lines.append(f"{command.label}: {_changes(command.state)}")
        return "\n".join(lines)


def _again(frame):
    return f"python -m tests.fuzz --seed {frame.seed}{' --wide' if frame.wide else ''}"


def _first_differences(name, first, second, most=5):
    second = second.reshape(first.shape)
    if first.ndim < 2:
        return f"{name}: {first} and {second}"
    apart = first != second
    if apart.ndim == 3:  # rows, columns, components
        apart = apart.any(-1)
    places = np.argwhere(apart)
    shown = [f"   {tuple(map(int, p))}: {first[tuple(p)]} and {second[tuple(p)]}" for p in places[:most]]
    return "\n".join([f"{name}: {len(places)} differ, (row, column) first:", *shown])


def _arrays(mesh):
    with np.printoptions(floatmode="unique", threshold=200, linewidth=110):
        return "\n   ".join(
            f"{f.name}={getattr(mesh, f.name)!r}" for f in fields(Mesh) if getattr(mesh, f.name) is not None
        )


def _changes(state):
    default = PassState()
    changed = [f.name for f in fields(state) if getattr(state, f.name) != getattr(default, f.name)]
    return "\n   ".join(f"{name}={getattr(state, name)!r}" for name in changed)


def compare(frame, ways):
    """Draw a frame in every way; raises Mismatch, the frame as it is, at the first that differs."""
    plain = outcome(frame, ways[0])
    for way in ways[1:]:
        other = outcome(frame, way)
        if names := differing(plain, other):
            raise Mismatch(frame, (ways[0], way), names, first=plain, second=other)


def check(frame):
    """Draw a frame in several ways; raises Mismatch with the smallest frame found. Returns how many were
    the specification's.
    """
    specified = frame.small and not frame.wide
    ways = [Way(), *ways_of(frame), *([Way(reference=True)] if specified else [])]
    try:
        compare(frame, ways)
    except Mismatch as mismatch:
        raise shrunk(mismatch) from None
    except Exception as error:
        error.add_note(f"while drawing seed {frame.seed}; again: {_again(frame)}")
        raise
    return int(specified)


# ------------------------------------------------------------------------------------------------ shrinking


def shrunk(mismatch):
    """The mismatch of the smallest frame found in SHRINKING_SECONDS: without commands, states and triangles
    that it does not need.
    """
    deadline, best, progress = time.monotonic() + SHRINKING_SECONDS, mismatch, True
    while progress:
        progress = False
        for commands in _smaller(best.frame.commands):
            if time.monotonic() > deadline:
                return best
            try:
                compare(replace(best.frame, commands=commands), best.ways)
            except Mismatch as smaller:
                best, progress = smaller, True
                break
            except (UnsupportedState, KeyError):  # the frame needs what was left out
                continue
    return best


def _smaller(commands):
    """Tuples of commands with a little less in them, those that drop most first."""
    for k in reversed(range(len(commands))):
        yield commands[:k] + commands[k + 1 :]
    for k, command in enumerate(commands):
        if isinstance(command, Draw):
            for draw in _smaller_draws(command):
                yield (*commands[:k], draw, *commands[k + 1 :])


def _smaller_draws(draw):
    state, mesh = draw.state, draw.mesh
    default = PassState()
    for f in fields(PassState):
        if getattr(state, f.name) != getattr(default, f.name):
            yield replace(draw, state=replace(state, **{f.name: getattr(default, f.name)}))
    for part in ("polygon", "vertex"):
        given = getattr(state, part)
        for f in fields(given):
            plain = getattr(getattr(default, part), f.name)
            if getattr(given, f.name) != plain:
                yield replace(draw, state=replace(state, **{part: replace(given, **{f.name: plain})}))
    for i, unit in enumerate(state.texture_units):
        if unit is not None:
            units = (*state.texture_units[:i], None, *state.texture_units[i + 1 :])
            yield replace(draw, state=replace(state, texture_units=units))
    if state.register_combiners is not None and len(state.register_combiners.general) > 1:
        general = state.register_combiners.general
        for i in range(len(general)):
            fewer = replace(state.register_combiners, general=general[:i] + general[i + 1 :])
            yield replace(draw, state=replace(state, register_combiners=fewer))
    for name in ("colors", "secondary_colors", "normals", "fog_coordinates", "back_colors", "edge_flags"):
        if getattr(mesh, name) is not None:
            yield replace(draw, mesh=replace(mesh, **{name: None}))
    yield from (replace(draw, mesh=smaller) for smaller in _smaller_meshes(mesh))


def _smaller_meshes(mesh):
    """Fewer triangles: halves, quarters, ... of a list of indices left out."""
    drawn = np.arange(len(mesh.positions)) if mesh.indices is None else mesh.indices
    each = {PrimitiveType.TRIANGLES: 3, PrimitiveType.QUADS: 4, PrimitiveType.LINES: 2}.get(mesh.primitive, 1)
    piece = len(drawn) // each
    while piece := piece // 2:
        for first in range(0, len(drawn), piece * each):
            left = np.concatenate([drawn[:first], drawn[first + piece * each :]])
            yield replace(mesh, indices=left, counts=None)


# ------------------------------------------------------------------------------------------------ the fuzz


@dataclass
class Tally:
    """What a fuzz did."""

    frames: int = 0
    specified: int = 0
    seconds: float = 0.0

    def __str__(self):
        rate = self.frames / max(self.seconds, 1e-9)
        engines = f"with {1 + len(ENGINES)} engines" if ENGINES else "with the one engine"
        return (
            f"{self.frames} frames in {self.seconds:.1f} s ({rate:.0f} a second) {engines}, "
            f"{self.specified} of them by the specification too: no difference"
        )


def warm_up():
    """Have the kernels compiled, where they never were: minutes that no fuzz should count as its own."""
    if is_cold():
        for seed in range(100):
            frame = random_frame(seed)
            for way in (Way(), *(Way(engine) for engine in ENGINES)):
                outcome(frame, way)


def fuzz(seconds=None, frames=None, first_seed=0, wide=False):
    """Check frame after frame, for so many seconds or frames; returns a Tally, or raises Mismatch. ``wide``:
    of machines of 8 to 12 bits, which the specification does not draw.
    """
    tally, begin = Tally(), time.monotonic()
    while (seconds is None or time.monotonic() - begin < seconds) and (
        frames is None or tally.frames < frames
    ):
        tally.specified += check(random_frame(first_seed + tally.frames, wide=wide))
        tally.frames += 1
    tally.seconds = time.monotonic() - begin
    return tally


# Frames that a worker checks in one call.
FRAMES_OF_A_CALL = 50


def fuzz_by(workers, manifest=None, seconds=None, frames=None, first_seed=0, wide=False):
    """``fuzz`` by the Workers of an executor (``fixedpipe.effects.tasks``), some frames each, a few more than
    were asked for. Frames that the Manifest has are counted and not drawn again. Returns a Tally; raises
    Mismatch's words as AssertionError.
    """
    tally, begin, inputs = Tally(), time.monotonic(), inputs_here()

    def tasks():
        seed = first_seed
        while (seconds is None or time.monotonic() - begin < seconds) and (
            frames is None or seed < first_seed + frames
        ):
            parameters = {"first_seed": seed, "wide": wide}
            yield Task(fuzzed_there, parameters, f"the frames of seeds from {seed}", inputs)
            seed += FRAMES_OF_A_CALL

    for done in in_order(tasks(), workers, manifest):
        if done.value["mismatch"]:
            raise AssertionError(done.value["mismatch"])
        tally.frames += done.value["frames"]
        tally.specified += done.value["specified"]
    tally.seconds = time.monotonic() - begin
    return tally


def fuzzed_there(first_seed, wide):
    """In a worker: how many frames, and how many by the specification; the Mismatch in words, or ""."""
    try:
        tally = fuzz(frames=FRAMES_OF_A_CALL, first_seed=first_seed, wide=wide)
    except Mismatch as mismatch:
        return {"frames": 0, "specified": 0, "mismatch": str(mismatch)}
    return {"frames": tally.frames, "specified": tally.specified, "mismatch": ""}


def shared_frame(seed, size):
    """A frame that gives the same on a Machine that has drawn others."""
    return random_frame(
        seed,
        size=size,
        profile=SHARED_PROFILE,
        depth_bits=SHARED_DEPTH_BITS,
        begins_cleared=True,
    )


def check_shared(machine, seed):
    """Draw a seed's frame on a Machine that others use at the same time, and compare what it read back.

    Returns how many were the specification's.
    """
    frame = shared_frame(seed, (machine.width, machine.height))
    pixels = machine.run(frame.commands).pixels
    got = {f"pixels {name}": array for name, array in pixels.items()}
    ways = [*(Way(engine) for engine in ENGINES or (None,)), *([Way(reference=True)] if frame.small else [])]
    for way in ways:
        expected = outcome(frame, way)
        if names := differing(got, expected):
            advice = "Only a Machine that drew other frames before, or meanwhile, gives this."
            ways = (f"a shared machine of {machine.threads} threads", way)
            raise Mismatch(frame, ways, names, advice, got, expected)
    return int(frame.small)


def fuzz_threads(python_threads, seconds=None, frames=None, first_seed=0):
    """Several Python threads at once, each with Machines of its own, and all with two that they share, for so
    many seconds or frames, a few more where threads were at them.

    Returns a Tally, or raises the first Mismatch, or whatever else a thread raised.
    """
    machines = [Machine(SHARED_PROFILE, *size, SHARED_DEPTH_BITS, threads=2) for size in SHARED_SIZES]
    tally, failures, lock = Tally(), [], threading.Lock()
    begin = time.monotonic()

    def goes_on():
        in_time = seconds is None or time.monotonic() - begin < seconds
        return in_time and (frames is None or tally.frames < frames) and not failures

    def work(number):
        seed = first_seed + number
        try:
            while goes_on():
                specified = check(random_frame(seed))
                for machine in machines:
                    specified += check_shared(machine, seed)
                seed += python_threads
                with lock:
                    tally.frames += 1 + len(machines)
                    tally.specified += specified
        except BaseException as error:  # raised again where the threads were started
            failures.append(error)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(python_threads)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if failures:
        raise failures[0]
    tally.seconds = time.monotonic() - begin
    return tally


def main(arguments=None):
    """Parse the command line and fuzz; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__.split("\n\n")[0])
    parser.add_argument("--seconds", type=float, help="how long (default: 60, or until --frames)")
    parser.add_argument("--frames", type=int, help="how many frames")
    parser.add_argument("--first-seed", type=int, default=0, help="the first frame's seed (default: 0)")
    parser.add_argument("--seed", type=int, help="check this seed's frame alone, and show it")
    parser.add_argument(
        "--python-threads", type=int, default=1, help="threads that draw at once (default: 1)"
    )
    parser.add_argument("--executor", help="where: processes:N, dask:..., mpi (docs/scale.md)")
    parser.add_argument("--manifest", help="a file: frames that were checked are not checked again")
    parser.add_argument("--wide", action="store_true", help="machines of 8 to 12 bits")
    given = parser.parse_args(arguments)
    seconds = 60.0 if given.seconds is None and given.frames is None else given.seconds
    warm_up()
    try:
        if given.seed is not None:
            frame = random_frame(given.seed, wide=given.wide)
            print(describe(frame.commands))
            check(frame)
            print("no difference")
        elif given.executor or given.manifest:
            how = seconds, given.frames, given.first_seed, given.wide
            with Manifest(given.manifest, "a fuzz") as manifest, opened(given.executor) as workers:
                print(fuzz_by(workers, manifest, *how))
        elif given.python_threads > 1:
            print(fuzz_threads(given.python_threads, seconds, given.frames, given.first_seed))
        else:
            print(fuzz(seconds, given.frames, given.first_seed, given.wide))
    except (Mismatch, AssertionError) as mismatch:
        print(mismatch)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
