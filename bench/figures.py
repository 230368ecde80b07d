"""What is asked for beside the scenes' rates: a number each for passes, a figure, start, threads, memory."""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from bench import factors
from bench.measure import Ours, Repeated, take_turns
from bench.scenes import SCENES
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import Scissor

_ROOT = Path(__file__).resolve().parents[1]
# The figure of Kautz, Seidel 2000 that stands for all, and the edge of its panels in pixels.
_FIGURE, _EDGE = "F004-4", 512
PASSES = 64


@dataclass(frozen=True)
class Measured:
    """A number in its figure's unit, and others in the same unit that explain it, by name."""

    value: float
    details: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Figure:
    """One number that is asked for.

    name, title   its name on the command line and what it is
    unit          of the value, its details and the goal
    goal          the number asked for
    most          whether the goal is the most that is allowed; else it is the least
    measure       threads -> Measured; raises OSError where this machine cannot tell
    """

    name: str
    title: str
    unit: str
    goal: float
    most: bool
    measure: Callable[[int], Measured]

    def is_met(self, value):
        """Whether a value reaches the goal."""
        return value <= self.goal if self.most else value >= self.goal


def _loaded_figure(width, threads):
    """A machine of ``width`` x 512 pixels that holds the figure's textures, and the other commands."""
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.pipeline.execution.machine import Machine

    commands = FIGURES[_FIGURE].commands(GEFORCE_256, _EDGE)
    machine = Machine(GEFORCE_256, width, _EDGE, threads=threads)
    machine.run(command for command in commands if isinstance(command, TexImage))
    return machine, tuple(command for command in commands if not isinstance(command, TexImage))


def many_passes(commands, number):
    """``PASSES`` passes in as many states over the mesh of the second Draw, the figure's specular pass.

    Each has a constant colour of its own, none of them that of another ``number`` (0 .. 2**20), and a scissor
    box of one pixel in the middle of the first panel.
    """
    specular = [command for command in commands if isinstance(command, Draw)][1]
    box = Scissor(_EDGE // 2, _EDGE // 2, 1, 1)
    passes = []
    for k in range(PASSES):
        color = (k / PASSES, number / 2**20, 0.5, 1.0)
        combiners = replace(specular.state.register_combiners, constant_color0=color)
        state = replace(specular.state, register_combiners=combiners, scissor=box)
        passes.append(replace(specular, state=state))
    return tuple(passes)


def _per_pass(threads):
    """Microseconds of ``run`` for each of 64 passes that draw one pixel, on one thread.

    So all of a pass is in it but its pixels: validation, packing, the vertex stage and sorting into bands of
    the figure's sphere (2,500 triangles), which are compiled in part. The value is of one tuple of commands
    run again and again; ``new states`` of tuples of states that the machine has not seen before.
    """
    machine, commands = _loaded_figure(_EDGE, 1)
    (seconds,) = take_turns([Repeated(machine, many_passes(commands, 0))])
    fresh = [Repeated(machine, many_passes(commands, number)).turn(1) for number in range(1, 20)]
    microseconds = 1e6 / PASSES
    return Measured(
        microseconds * statistics.median(seconds), {"new states": microseconds * statistics.median(fresh)}
    )


def _frames(threads):
    """Frames a second of both panels' passes with all textures in place."""
    machine, commands = _loaded_figure(2 * _EDGE, threads)
    (seconds,) = take_turns([Repeated(machine, commands)])
    return Measured(1 / statistics.median(seconds))


def _environment(**more):
    paths = [str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    return os.environ | {"PYTHONPATH": os.pathsep.join(paths)} | more


def _run_module(*arguments, **environment):
    """(seconds, standard output) of ``python -m`` with arguments; OSError if it ends with an error."""
    start = time.perf_counter()
    ended = subprocess.run(
        [sys.executable, "-m", *arguments], env=_environment(**environment), capture_output=True, text=True
    )
    seconds = time.perf_counter() - start
    if ended.returncode:
        raise OSError(f"python -m {' '.join(arguments)} ended with {ended.returncode}: {ended.stderr}")
    return seconds, ended.stdout


def _draw_to_file(folder, **environment):
    return _run_module(
        "fixedpipe.effects.cli",
        "figures",
        _FIGURE,
        "--profile",
        "GEFORCE_256",
        "--out",
        folder,
        **environment,
    )[0]


def _cold_start(threads):
    """Seconds of ``fixedpipe figures F004-4`` until its files are there, where no kernel was compiled."""
    with tempfile.TemporaryDirectory() as folder:
        cache = os.path.join(folder, "cache")
        return Measured(_draw_to_file(os.path.join(folder, "out"), NUMBA_CACHE_DIR=cache))


def _cached_start(threads, times=5):
    """Seconds of the same command with its kernels in the cache; ``best`` of the times beside the median."""
    with tempfile.TemporaryDirectory() as folder:
        _draw_to_file(folder)
        seconds = [_draw_to_file(folder) for _ in range(times)]
    return Measured(statistics.median(seconds), {"best": min(seconds)})


def _scaling(threads):
    """How many times the rate of scene c on one thread that on two is, in turn."""
    parties = [Ours(1), Ours(2)]
    for party in parties:
        party.prepare(SCENES["c"], SCENES["c"].size)
    one, two = take_turns(parties)
    return Measured(statistics.median(one) / statistics.median(two))


def _peak_memory(threads):
    """Megabytes of a process that draws one frame, kernels compiled before (``bench.largest_frame``)."""
    _run_module("bench.largest_frame", str(threads))
    return Measured(float(_run_module("bench.largest_frame", str(threads))[1]) / 1e6)


def _factors(threads):
    """Seconds to factor a BRDF of 32^4 samples, by three separable terms; the other ways beside them."""
    (_, most), *others = factors.measure().items()
    return Measured(most, dict(others))


def _probes(threads):
    """How fast a probe is beside a trilinear texel: eight probes' rate times eight over mip-mapping's.

    F001-2's page at 8 degrees, where every fragment takes all eight, twenty layers of 512 x 512 pixels. Two
    and four probes beside it, and the chips' anisotropic filter.
    """
    from fixedpipe.effects.geometry.views import Panel
    from fixedpipe.effects.texture_filtering import stretched_writing as written
    from fixedpipe.pipeline.execution.machine import Machine
    from fixedpipe.pipeline.profiles import NV2A, TEXRAM

    view, page = written.flat_view(Panel(0, 0, _EDGE, _EDGE), 8.0), written.writing(_EDGE)
    reads = {"mip-mapping": (TEXRAM, {})}
    reads |= {f"{n} probes": (TEXRAM, {"max_probes": n}) for n in (2, 4, 8)}
    reads |= {f"{n} : 1": (NV2A, {"max_anisotropy": float(n)}) for n in (2, 4, 8)}
    parties = []
    for profile, settings in reads.values():
        machine = Machine(profile, _EDGE, _EDGE, threads=threads)
        machine.run((written.load(page, profile),))
        layer = written.page_pass("page", view, written.sampler(**settings))
        parties.append(Repeated(machine, (layer,) * 20))
    seconds = dict(zip(reads, map(statistics.median, take_turns(parties)), strict=True))
    alone = seconds.pop("mip-mapping")
    found = {name: int(name.split()[0]) * alone / each for name, each in seconds.items()}
    return Measured(found.pop("8 probes"), found)


FIGURES = {
    figure.name: figure
    for figure in (
        Figure("passes", "64 passes over a 512² figure: a pass, but its pixels", "µs", 60, True, _per_pass),
        Figure("frames", "F004-4 at 512², textures in place", "frames/s", 300, False, _frames),
        Figure("cold", "fixedpipe figures F004-4, empty kernel cache", "s", 25, True, _cold_start),
        Figure("cached", "fixedpipe figures F004-4 to file", "s", 1.2, True, _cached_start),
        Figure("scaling", "scene c, one thread to two", "times", 1.8, False, _scaling),
        Figure("memory", "peak of a 2048² frame, two 2048² textures", "MB", 400, True, _peak_memory),
        Figure("factors", "three separable factors of a BRDF of 32⁴ samples", "s", 5, True, _factors),
        Figure("probes", "a probe's rate over a trilinear texel's", "times", 0.5, False, _probes),
    )
}
