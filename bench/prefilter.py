"""Seconds to filter a cube map by Phong's lobe and by the cosine, on the host."""

from dataclasses import dataclass

from bench.scattering import seconds_of

# Texels along a face's edge, exponent, and the seconds that are asked for.
MAPS = (
    (128, 1.0, None),
    (128, 100.0, None),
    (512, 1.0, None),
    (512, 10.0, None),
    (512, 100.0, 2.0),
    (512, 1000.0, None),
)
TURNS = 3


@dataclass(frozen=True)
class Time:
    """``seconds``: the median of TURNS; ``goal``: None where none is set."""

    size: int
    exponent: float
    seconds: float
    goal: float | None


def measure(threads):
    """A Time for each of MAPS, of a room."""
    from fixedpipe.effects.environment_maps import environments, prefilter
    from fixedpipe.effects.geometry.cube_maps import directions

    for size, exponent, goal in MAPS:
        room = environments.room(directions(size))
        seconds = seconds_of(lambda cube=room, e=exponent: prefilter.phong(cube, e, threads=threads), TURNS)
        yield Time(size, exponent, seconds, goal)
