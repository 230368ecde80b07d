"""What is asked for beside the scenes' rates: a number each for passes, a figure, start, threads, memory."""

import statistics
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace

from bench import draws, factors, ideals, lit, starting, tex_images, wide
from bench.measure import Ours, Repeated, clock_of, spread_of, take_turns
from bench.scenes import SCENES
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import Scissor

# The figure of Kautz, Seidel 2000 that stands for all, and the edge of its panels in pixels.
_FIGURE, _EDGE = "F004-4", 512
PASSES = 64


@dataclass(frozen=True)
class Measured:
    """A number in its figure's unit, and others in the same unit that explain it, by name.

    ``spread``: how far a median lies above the best turn, as a share; None where nothing was repeated.
    """

    value: float
    details: Mapping[str, float] = field(default_factory=dict)
    spread: float | None = None

    @classmethod
    def median(cls, taken, details=None):
        """Of turns, of which less is better, their median; of details' turns likewise."""
        medians = {name: statistics.median(turns) for name, turns in (details or {}).items()}
        return cls(statistics.median(taken), medians, spread_of(taken))


@dataclass(frozen=True)
class Figure:
    """One number that is asked for.

    name, title   its name on the command line and what it is
    unit          of the value, its details and the goal
    most          whether its goal (bench.goals) is the most that is allowed; else it is the least
    measure       threads -> Measured; raises OSError where this machine cannot tell
    is_long       takes many minutes, so that it is measured only where it is named
    """

    name: str
    title: str
    unit: str
    most: bool
    measure: Callable[[int], Measured]
    is_long: bool = False

    def is_met(self, value, goal):
        """Whether a value reaches a goal."""
        return value <= goal if self.most else value >= goal


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


def made_anew(passes):
    """Draws that are equal to others, of the same meshes, in states of which no part is the same object."""
    return tuple(replace(draw, state=deepcopy(draw.state)) for draw in passes)


def _per_pass(threads):
    """Microseconds of ``run`` for each of 64 passes that draw one pixel, on one thread.

    So all of a pass is in it but its pixels: validation, packing, the vertex stage and sorting into bands of
    the figure's sphere (2,500 triangles), which are compiled in part. One tuple of commands is run again and
    again. Processor time, which is that of the clock where nothing else runs.
    """
    machine, commands = _loaded_figure(_EDGE, 1)
    (seconds,) = take_turns([Repeated(machine, many_passes(commands, 0), clock_of(1))])
    return Measured.median([1e6 / PASSES * each for each in seconds])


def _per_new_state(threads):
    """The same of states that the machine has not seen before, each run once; beside it, of states that are
    equal to those of the first run, and no part of them the same object.
    """
    machine, commands = _loaded_figure(_EDGE, 1)
    machine.run(many_passes(commands, 0))

    def taken(runs):
        return [1e6 / PASSES * Repeated(machine, run, clock_of(1)).turn(1) for run in runs]

    unseen = taken(many_passes(commands, number) for number in range(1, 20))
    equal = taken(made_anew(many_passes(commands, 0)) for _ in range(19))
    return Measured.median(unseen, {"equal, made anew": equal})


def _per_draw(threads):
    """Microseconds of a Draw of 100 vertices and one pixel; of what is new alone, or nothing, beside it."""
    found = draws.measure()
    return Measured.median(found.pop("mesh and state"), found)


def _per_tex_image(threads):
    """Microseconds in which a TexImage through the imaging subset becomes a texture; beside it of a run of
    such commands, which validates them, and of the same run again.
    """
    found = tex_images.measure()
    return Measured.median(found.pop("texture"), found)


def _lit(threads):
    """Microseconds that lighting adds to a Draw of 100 vertices: the most of two machines and one or two
    lights; each beside it.
    """
    found = lit.measure()
    return Measured.median(found[lit.dearest(found)], found)


def _ideals(threads):
    """Processor seconds of four figures' ideals; each, and its machine's picture, beside it."""
    found, details = ideals.measure(), {}
    for name, turns in found.items():
        ideal, machine = zip(*turns, strict=True)
        details |= {f"{name}, ideal": ideal, f"{name}, machine": machine}
    sums = [sum(ideal for ideal, _ in turn) for turn in zip(*found.values(), strict=True)]
    return Measured.median(sums, details)


def _wide(threads):
    """Millions of fragments a second of five scenes at twelve bits, by kernels: the least; each beside it and
    each by the column engine, which has one thread.
    """
    found = wide.measure(threads)
    rates = {name: statistics.median(kernels) for name, (kernels, _) in found.items()}
    columns = {f"{name}, columns": statistics.median(taken) for name, (_, taken) in found.items()}
    return Measured(min(rates.values()), rates | columns)


def _frames(threads):
    """Frames a second of both panels' passes with all textures in place."""
    machine, commands = _loaded_figure(2 * _EDGE, threads)
    (seconds,) = take_turns([Repeated(machine, commands)])
    return Measured(1 / statistics.median(seconds), spread=spread_of(seconds))


def _cold_start(threads):
    """Seconds of ``fixedpipe figures F004-4`` until its files are there, where no kernel was compiled."""
    return Measured(starting.cold(_FIGURE))


def _cached_start(threads):
    """Seconds of the same command with its kernels in the cache; ``best`` of the times beside the median."""
    seconds = starting.cached(_FIGURE)
    return Measured.median(seconds, {"best": [min(seconds)]})


def _first_picture(threads):
    """Seconds of ``fixedpipe figures --check``, no kernel compiled, until the first figure's files."""
    return Measured(starting.first())


def _help(threads):
    """Seconds of ``fixedpipe --help``; those of the processor, and of an interpreter alone, beside it."""
    found = starting.asking_for_help()
    return Measured.median(found.pop("wall"), found)


def _every_figure(threads):
    """Seconds of ``fixedpipe figures --check`` with its kernels in the cache; of a second run beside it."""
    once, again = starting.every_figure()
    return Measured(once, {"again": again})


def _every_figure_cold(threads):
    """Seconds of ``fixedpipe figures --check``, where no kernel was compiled."""
    return Measured(starting.every_figure_cold())


def _scaling(threads):
    """How many times the rate of scene c on one thread that on two is, in turn."""
    parties = [Ours(1), Ours(2)]
    for party in parties:
        party.prepare(SCENES["c"], SCENES["c"].size)
    one, two = take_turns(parties)
    ratio = statistics.median(one) / statistics.median(two)
    return Measured(ratio, spread=max(spread_of(one), spread_of(two)))


def _peak_memory(threads):
    """Megabytes of a process that draws one frame, kernels compiled before (``bench.largest_frame``)."""
    starting.run_module("bench.largest_frame", str(threads))
    return Measured(float(starting.run_module("bench.largest_frame", str(threads))[1]) / 1e6)


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
    turns = dict(zip(reads, take_turns(parties), strict=True))
    seconds = {name: statistics.median(taken) for name, taken in turns.items()}
    alone = seconds.pop("mip-mapping")
    found = {name: int(name.split()[0]) * alone / each for name, each in seconds.items()}
    return Measured(found.pop("8 probes"), found, max(map(spread_of, turns.values())))


FIGURES = {
    figure.name: figure
    for figure in (
        Figure("passes", "64 passes over a 512² figure: a pass, but its pixels", "µs", True, _per_pass),
        Figure("states", "the same in states not seen before", "µs", True, _per_new_state),
        Figure("draws", "a Draw of a new mesh (100 vertices) in a new state", "µs", True, _per_draw),
        Figure("teximage", "a TexImage of 16² by the imaging subset", "µs", True, _per_tex_image),
        Figure("lit", "what lighting adds to a Draw of 100 vertices", "µs", True, _lit),
        Figure("frames", "F004-4 at 512², textures in place", "frames/s", False, _frames),
        Figure("wide", "frames of twelve bits, by kernels", "Mfragments/s", False, _wide),
        Figure("first", "fixedpipe figures, empty kernel cache: a picture", "s", True, _first_picture),
        Figure("cold", "fixedpipe figures F004-4, empty kernel cache", "s", True, _cold_start),
        Figure("cached", "fixedpipe figures F004-4 to file", "s", True, _cached_start),
        Figure("help", "fixedpipe --help", "s", True, _help),
        Figure("ideal", "four figures' ideals, on one thread", "s", True, _ideals),
        Figure("scaling", "scene c, one thread to two", "times", False, _scaling),
        Figure("memory", "peak of a 2048² frame, two 2048² textures", "MB", True, _peak_memory),
        Figure("factors", "three separable factors of a BRDF of 32⁴ samples", "s", True, _factors),
        Figure("probes", "a probe's rate over a trilinear texel's", "times", False, _probes),
        Figure("all", "every figure, kernels in the cache", "s", True, _every_figure, is_long=True),
        Figure("fresh", "every figure, empty kernel cache", "s", True, _every_figure_cold, is_long=True),
    )
}
