"""Measures of pictures, for the figures' acceptance checks.

A check's bound is the catalogue's (docs/papers/catalogue), if the catalogue computed or proposed one. Other
bounds were measured at the first correct picture and frozen with about a third of slack. Checks of the
mathematics apply to the ideal; the machine has bounds of its own.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.effects.acceptance.check import Answer, Check

# Why the bounds of a highlight of exponent 8 are what they are.
POWER_8 = (
    "8-bit normals and vectors leave n.h within about one byte, which the eighth power multiplies by eight "
    "near one; measured at the first correct picture, with at most a third of slack"
)


def pixel_grid(size: int, extent: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Coordinates in [-1, 1] of pixel centres on a square that fills ``extent`` of a panel, bottom row
    first.
    """
    edge = ((np.arange(size) + 0.5) / size * 2.0 - 1.0) / extent
    return np.meshgrid(edge, edge)


def root_mean_square(a: NDArray[np.float64]) -> float:
    """Root of the mean of an array's squares."""
    return float(np.sqrt((a * a).mean()))


def arithmetic_check(figure: Any, renderer: Any, bound: float, reason: str, **changes: Any) -> Check:
    """A Figure's picture by a Renderer's machine against the free ideal's: RMS over the framebuffer at
    half the figure's size. ``changes``: other values of its parameters.
    """
    machine = renderer.machine_window(figure, figure.size // 2, **changes)
    ideal = np.clip(renderer.ideal_window(figure, figure.size // 2, **changes), 0.0, 1.0)
    return Check(
        "RMS of machine - ideal",
        root_mean_square(machine - ideal),
        at_most=bound,
        on=Answer.MACHINE,
        reason=reason,
    )


def principal_axis(image: NDArray[np.float64]) -> tuple[float, float]:
    """Orientation in degrees and elongation of a bright region by its second moments.

    ``image``: float64 [h, w] intensities. Elongation is the ratio of the standard deviations along and
    across.
    """
    y, x = np.mgrid[0 : image.shape[0], 0 : image.shape[1]]
    total = image.sum()
    dx, dy = x - (image * x).sum() / total, y - (image * y).sum() / total
    xx, xy, yy = ((image * a).sum() / total for a in (dx * dx, dx * dy, dy * dy))
    angle = 0.5 * math.degrees(math.atan2(2.0 * xy, xx - yy))
    root = math.sqrt((xx - yy) ** 2 + 4.0 * xy * xy)
    return angle, math.sqrt((xx + yy + root) / max(xx + yy - root, 1e-12))


def half_maximum_aspect(image: NDArray[np.float64], frame: Sequence[ArrayLike], radius: float) -> float:
    """Width ratio of a highlight on a sphere at half its peak, along b over along t, in the tangent plane of
    the peak.

    ``image``: float64 [size, size], bottom row first. ``frame``: unit vectors (tangent, binormal, normal) at
    the peak, in world coordinates. Widths are read off the great circles through the peak, with linear
    interpolation.
    """
    size, widths = image.shape[0], []
    peak_normal, peak = frame[2], None
    for axis in frame[:2]:
        reach = []
        for sign in (1.0, -1.0):
            angle = np.radians(np.arange(0.0, 89.0, 0.1))
            points = np.cos(angle)[:, None] * peak_normal + sign * np.sin(angle)[:, None] * axis
            points = points[points[:, 2] > 0.0]
            x, y = ((points[:, k] * radius + 1.0) * (0.5 * size) - 0.5 for k in (0, 1))
            i, j = np.floor(x).astype(int), np.floor(y).astype(int)
            a, b = x - i, y - j
            profile = (image[j, i] * (1 - a) + image[j, i + 1] * a) * (1 - b) + (
                image[j + 1, i] * (1 - a) + image[j + 1, i + 1] * a
            ) * b
            peak = profile[0] if peak is None else peak
            below = int(np.argmax(profile < 0.5 * peak))
            if below == 0:
                return math.nan
            f = (profile[below - 1] - 0.5 * peak) / (profile[below - 1] - profile[below])
            reach.append(math.sin(angle[below - 1] + f * (angle[below] - angle[below - 1])))
        widths.append(sum(reach))
    return widths[1] / widths[0]
