"""Document 002's table 1: seconds to precompute and to draw light that is scattered in height fields.

Ours beside the paper's, whose machine was another: ratios within a column tell more than seconds. And how our
own cost grows with texels, directions and the length of paths.
"""

import platform
import time
from dataclasses import dataclass
from pathlib import Path

DIRECTIONS = 100
TURNS = 5
# Source: Heidrich, Daubert, Kautz, Seidel 2000, table 1: S_i, ellipses, software and hardware, in seconds.
PAPER = {
    "triangles": (27.0, 32.0, 10.0, 0.48),
    "bricks": (1029.0, 194.0, 12.0, 2.10),
    "bumps": (109.0, 65.0, 8.0, 0.48),
}
EDGES = {"triangles": 32, "bricks": 128, "bumps": 32}
# The seconds that are asked for: of S_i, ellipses, a picture in software, one on the GeForce 256.
GOALS = {("triangles", "S_i"): 0.3, ("bricks", "S_i"): 4.0, ("triangles", "ellipses"): 0.5}
GOALS |= {("triangles", "software"): 0.2, ("triangles", "GEFORCE_256"): 0.02}
MACHINES = ("GEFORCE_256", "GEFORCE_3", "OCTANE", "G400")
LIGHT = (0.0, 0.6, 0.8)
GROWTH = {"texels": (16, 32, 64, 128, 256), "directions": (25, 50, 100, 200, 400), "lookups": (1, 2, 3, 4)}


@dataclass(frozen=True)
class Time:
    """``seconds``: the median of TURNS; ``paper``: what the paper's machine took, None where it says nothing;
    ``goal``: None where none is set.
    """

    field: str
    step: str
    seconds: float
    paper: float | None
    goal: float | None


def processor():
    """The processor's name, as its system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    named = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor() or platform.machine()


def seconds_of(step, turns=TURNS):
    """The median of ``turns`` runs of a function after one that is not counted."""
    step()
    took = []
    for _ in range(turns):
        start = time.perf_counter()
        step()
        took.append(time.perf_counter() - start)
    return sorted(took)[len(took) // 2]


def field_of(name, edge):
    """One of the table's height fields, ``edge`` texels wide and high."""
    from fixedpipe.effects.scattering import height_field, made_fields

    makers = {"triangles": height_field.ridges, "bricks": made_fields.bricks, "bumps": height_field.bumps}
    return makers[name](edge, edge)


def picture(field, visibility, machine, lookups=1, paths=DIRECTIONS):
    """(commands, profile, width, height): the field's light with scattering as a machine draws it, its own
    way, summed where it does so best.
    """
    from fixedpipe.effects.geometry.views import Panel
    from fixedpipe.effects.scattering import (
        dependent_tests,
        host_lookup_passes,
        light_transport,
        offset_texture_passes,
        pixel_texture_passes,
        texture_shader_passes,
    )
    from fixedpipe.pipeline.profiles import PROFILES

    ways = {
        "GEFORCE_256": host_lookup_passes.WAY,
        "GEFORCE_3": texture_shader_passes.WAY,
        "OCTANE": pixel_texture_passes.WAY,
        "G400": offset_texture_passes.WAY,
    }
    work, total = Panel(0, 0, field.columns, field.rows), Panel(field.columns, 0, field.columns, field.rows)
    setup = dependent_tests.Setup(field, visibility, PROFILES[machine], work, total, 8)
    numbers = light_transport.sequences(visibility.count, lookups, paths)
    commands = dependent_tests.paths_drawn(ways[machine], setup, numbers, LIGHT)
    return commands, PROFILES[machine], 2 * field.columns, field.rows


def _steps(field, threads):
    """name -> a function: what table 1 times, for one field."""
    from concurrent.futures import ThreadPoolExecutor

    import numpy as np

    from fixedpipe.effects.scattering import directions, ellipses, light_transport, visibility
    from fixedpipe.pipeline.execution.machine import Machine

    found = directions.spiral(DIRECTIONS)
    seen = visibility.precompute(field, found)
    paths = light_transport.sequences(DIRECTIONS, 1, DIRECTIONS)

    def precomputed():
        with ThreadPoolExecutor(threads) as pool:
            visibility.precompute(field, found, pool)

    def drawn(machine):
        commands, profile, width, height = picture(field, seen, machine)
        running = Machine(profile, width, height, threads=threads)
        return lambda: running.run(commands)

    steps = {
        "S_i": precomputed,
        "ellipses": lambda: ellipses.of_visibility(seen),
        "software": lambda: light_transport.scattered(field, seen, paths, np.array(LIGHT)),
    }
    # The G400's offsets are signed bytes, which reach 127 texels.
    able = [machine for machine in MACHINES if machine != "G400" or field.columns <= 127]
    return steps | {machine: drawn(machine) for machine in able}


def measure(threads, fields=EDGES):
    """Yield the Times of table 1, each as it is measured."""
    for name, edge in fields.items():
        for step, run in _steps(field_of(name, edge), threads).items():
            column = ("S_i", "ellipses", "software").index(step) if step not in MACHINES else 3
            yield Time(name, step, seconds_of(run), PAPER[name][column], GOALS.get((name, step)))


def growth():
    """Yield (what grows, the number, step, seconds): of ridges, one number growing, the others 32 texels
    along an edge, 100 directions and one lookup.
    """
    import numpy as np

    from fixedpipe.effects.scattering import directions, ellipses, light_transport, visibility
    from fixedpipe.pipeline.execution.machine import execute

    for what, numbers in GROWTH.items():
        for number in numbers:
            chosen = {"texels": 32, "directions": DIRECTIONS, "lookups": 1} | {what: number}
            field, found = field_of("triangles", chosen["texels"]), directions.spiral(chosen["directions"])
            seen = visibility.precompute(field, found)
            paths = light_transport.sequences(seen.count, chosen["lookups"], seen.count)
            if what != "lookups":
                yield what, number, "S_i", seconds_of(lambda f=field, d=found: visibility.precompute(f, d))
                yield what, number, "ellipses", seconds_of(lambda s=seen: ellipses.of_visibility(s))
            yield (
                what,
                number,
                "software",
                seconds_of(
                    lambda f=field, s=seen, p=paths: light_transport.scattered(f, s, p, np.array(LIGHT))
                ),
            )
            if chosen["texels"] < 256:
                drawn = picture(field, seen, "GEFORCE_3", chosen["lookups"], seen.count)
                yield what, number, "GEFORCE_3", seconds_of(lambda d=drawn: execute(*d))


def plot(found, path):
    """Draw ``growth``'s points, (what, number, step, seconds) each, as a picture of three panels."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    labels = {"texels": "texels along an edge", "directions": "directions", "lookups": "lookups along a path"}
    for axes, what in zip(figure.subplots(1, 3), GROWTH, strict=True):
        for step in dict.fromkeys(s for w, _, s, _ in found if w == what):
            points = [(n, 1e3 * t) for w, n, s, t in found if (w, s) == (what, step)]
            axes.plot(*zip(*points, strict=True), marker="o", label=step)
        axes.set(xlabel=labels[what], ylabel="milliseconds", xscale="log", yscale="log")
        axes.set_xticks(GROWTH[what], [str(n) for n in GROWTH[what]])
        axes.minorticks_off()
        axes.legend(fontsize=8)
    figure.suptitle(f"What scattering costs, by what grows: {processor()}", fontsize=10)
    figure.savefig(path)
