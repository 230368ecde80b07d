"""G25: a BRDF as a dense grid of samples, with interpolation between them.

For the light and for the view, the grid has ``count`` steps of z and ``count`` of the angle around it; a
sample lies in the middle of each. That makes count^4 samples, 16^4 in the paper. Lights and views are
computed separately (``goniometer``), so the cost is count^2 of each and a sum for each pair. Measured: 16^4
samples of 32 x 32 texels, three reflections, in about a second on one core of an AMD EPYC. The paper draws
each sample and takes 7 to 8 hours.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 6; pass sequence A-G23, 65,536 times.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.scattering import goniometer, long_work
from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("G25", "a dense BRDF: a grid of 16^4 samples", "6"),)

# Angles around z differ in their last bit between processors; rounded to a multiple of this they do not.
_ANGLE_STEP = 2.0**-20


@dataclass(frozen=True, eq=False)
class DenseBRDF:
    """Samples of f_r(l, v): float64 [count, count, count, count, 3], RGB per steradian, over z of l, the
    angle of l, z of v, the angle of v.
    """

    samples: NDArray[np.float64]

    @property
    def count(self) -> int:
        """Steps along each of the four axes."""
        return len(self.samples)

    def isotropic(self) -> "DenseBRDF":
        """The mean over rotations about z, with light and view in either order: the BRDF of a surface whose
        fields are turned at random. Samples depend on the difference of the two angles alone.
        """
        n = self.count
        out = np.zeros_like(self.samples)
        for turn in range(n):
            out += np.roll(self.samples, (turn, turn), (1, 3))
        out = out / n
        return DenseBRDF(0.5 * (out + out.transpose(2, 3, 0, 1, 4)))

    @cached_property
    def _with_zenith(self):
        return _with_zenith(self.samples)

    def at(self, towards, views):
        """f_r of directions [n, 3] each, above the horizon, linear between samples: float64 [n, 3]. Nearer to
        the horizon than any sample, the nearest z counts; at the zenith, the mean of those around it.
        """
        n = self.count
        samples = self._with_zenith
        places = [*_place(towards, n), *_place(views, n)]
        out = np.zeros((len(places[0][0]), 3))
        for corner in range(16):
            bits = [corner >> k & 1 for k in range(4)]
            weight = 1.0
            for bit, (_, _, share) in zip(bits, places, strict=True):
                weight = weight * (share if bit else 1.0 - share)
            at = tuple(place[bit] for bit, place in zip(bits, places, strict=True))
            out += weight[:, None] * samples[at]
        return out


def _with_zenith(samples):
    """Samples with one more z of light and of view, the zenith's: the mean of the last over the angle."""
    n = len(samples)
    out = np.empty((n + 1, n, n + 1, n, 3))
    out[:n, :, :n] = samples
    out[n, :, :n] = _mean(samples[n - 1])
    out[:, :, n] = _mean(np.moveaxis(out[:, :, n - 1], 2, 0))[:, :, None]
    return out


def _mean(over):
    """The mean over the first axis, summed one after the other."""
    total = np.zeros_like(over[0])
    for each in over:
        total += each
    return total / len(over)


def _place(directions, count):
    """Of directions [n, 3] along z and along the angle: the sample below, the one above, and the share of
    that.
    """
    directions = np.asarray(directions, np.float64)
    z = np.maximum(directions[:, 2] * count - 0.5, 0.0)
    low = np.minimum(np.floor(z).astype(np.int64), count - 1)
    # From the last sample it is half a step to the zenith.
    beyond = np.where(low < count - 1, z - low, np.minimum(2.0 * (z - low), 1.0))
    turn = np.arctan2(directions[:, 1], directions[:, 0]) / (2.0 * math.pi)
    turn = np.floor(turn / _ANGLE_STEP + 0.5) * _ANGLE_STEP
    angle = (turn - np.floor(turn)) * count - 0.5
    below = np.floor(angle).astype(np.int64)
    return (
        (low, low + 1, beyond),
        (below % count, (below + 1) % count, angle - below),
    )


def _piece(task):
    field, visibility, towards, views, bounces = task
    return goniometer.brdf(field, visibility, towards, views, bounces)


def simulated(field, visibility, count=16, bounces=2, *, folder=None, executor=None, progress=None):
    """The DenseBRDF of a HeightField by a virtual goniometer, in texture space with masking by rays.

    folder, executor, progress  as for ``long_work.run``; a piece is one z of the light

    Raises ValueError for a count below one, and Refusal as ``long_work.run``.
    """
    directions, _ = goniometer.grid(count)
    tasks = [
        (field, visibility, directions[k * count : (k + 1) * count], directions, bounces)
        for k in range(count)
    ]
    parameters = {
        "what": "dense BRDF",
        "heights": long_work.array_digest(field.heights),
        "normals": long_work.array_digest(field.normals),
        "albedo": long_work.array_digest(field.albedo),
        "highlight": [field.specular, field.exponent],
        "directions": long_work.array_digest(visibility.directions),
        "count": count,
        "bounces": bounces,
    }
    found = long_work.run(
        tasks, _piece, folder=folder, parameters=parameters, executor=executor, progress=progress
    )
    return DenseBRDF(np.concatenate(found).reshape(count, count, count, count, 3))
