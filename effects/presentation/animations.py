"""The default animation of each figure: which parameter moves. It is declared by the figure's id."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from fixedpipe.effects.presentation.variation import Track


@dataclass(frozen=True)
class Animation:
    """A declared animation: what it ``does``, in a few words; a Track for each parameter's name; the first
    and the last ``bits`` of every number; how many frames there are (None: as ``frames_of`` says), and how
    many a second.
    """

    does: str
    tracks: Mapping[str, Track] = field(default_factory=dict)
    bits: tuple[int, int] | None = None
    count: int | None = None
    frames_a_second: int = 15


def round_the_axis(z, radius=1.0, steps=48):
    """A light that goes round the line of sight, once: directions with the same z. The last is a step before
    the first, so that the animation can be repeated.
    """
    angles = [2.0 * math.pi * n / steps for n in range(steps)]
    return Track(tuple((round(radius * math.cos(a), 6), round(radius * math.sin(a), 6), z) for a in angles))


def there_and_back(*values):
    """Through the values and back to the first."""
    return Track((*values, *values[-2::-1]))


# From one side to the other, over the avenue.
_DAY = Track(((-0.95, 0.28, 0.3), (-0.3, 0.9, 0.35), (0.4, 0.85, 0.36), (0.95, 0.28, 0.36)))
_LAMPS = ((-6.2, 7.0, 3.2), (-1.4, 8.8, 5.0), (5.6, 6.8, 4.4))

# From the right to the left of the terrain, behind the viewer at noon: x to the right, y away, z up.
_DAY_OVER_LAND = Track(
    ((0.94, 0.10, 0.16), (0.72, -0.30, 0.52), (0.0, -0.62, 0.78), (-0.74, -0.2, 0.5), (-0.95, 0.14, 0.16))
)

ANIMATIONS = {
    # From the figure's own angle down: higher, each strip would cover the one below.
    "F001-2": Animation("the eye sinks to the page", {"angle": there_and_back(8.0, 4.0)}, count=48),
    "F001-3": Animation("the samples move by a pixel", {"shift": there_and_back(-0.5, 0.5)}, count=48),
    # The last is a step before the first: the waves are back at 1.
    "F001-11": Animation("the waves run", {"time": Track((0.0, 1.0 - 1.0 / 48.0))}, count=48),
    "F002-13": Animation("from morning to evening", {"sun": _DAY_OVER_LAND}, count=60),
    "F003-1": Animation("the spheres turn", {"turn": there_and_back(-50.0, 50.0)}, count=48),
    "F003-10": Animation(
        "each lamp takes the way of the next",
        {"positions": Track((_LAMPS, (*_LAMPS[1:], *_LAMPS[:1]), (*_LAMPS[2:], *_LAMPS[:2]), _LAMPS))},
        count=72,
    ),
    "F003-15": Animation("the light grows", {"width": there_and_back(0.2, 3.0)}, count=24),
    "F003-22": Animation("from morning to evening", {"sun": _DAY}, count=48),
    "F004-2": Animation("from 4 to 16 bits", bits=(4, 16), frames_a_second=2),
    "F004-4": Animation("the light goes round", {"light": round_the_axis(0.75)}, count=48),
    "F004-8": Animation("the light goes round", {"light": round_the_axis(1.0)}, count=48),
    "K12": Animation("the lamp goes round", {"light": round_the_axis(0.5, 0.6)}, count=48),
    "K14": Animation("the light goes round", {"light": round_the_axis(0.6)}, count=48),
    "K18": Animation("the camera looks down", {"pitch": there_and_back(8.0, 32.0)}, count=48),
    "Z14": Animation("from morning to evening", {"sun": _DAY}, count=48),
}
