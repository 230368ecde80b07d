"""G26: a BRDF from some hundred random samples, projected into products of spherical harmonics.

f(l, v) is approximated by the sum of c_jk Y_j(l) Y_k(v) over the real spherical harmonics of four bands, 16
by 16 coefficients. Harmonics are a basis of the sphere, and overcomplete on a hemisphere. So least squares
over the samples find c, and keep small what the samples do not determine (Tikhonov): they also minimize the
sum of the squares of c, times a small weight. Higher bands have a larger weight, because noise appears in
them.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 6; pass sequence A-G26. Assumed: least squares and its
weights; the paper only names the basis, as an example.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.scattering import goniometer
from fixedpipe.effects.scattering.directions import checked
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("G26", "a BRDF by some hundred random samples, in products of spherical harmonics", "6"),
)

BANDS = 4
COEFFICIENTS = BANDS * BANDS
# Least squares' weight of the coefficients' squares, of the samples' number. Measured: 512 samples of bumps,
# domes and ridges are 5, 7 and 14 % off a dense grid (RMS of light that is sent back, of its mean); with 1e-5
# 7, 11 and 19 %; with 1e-7 a tenth less, the most of what is left being what four bands cannot follow.
TIKHONOV = 1e-6
# Coefficients differ in their last bits between libraries; rounded to a multiple of this they do not.
_STEP = 2.0**-20


def basis(directions):
    """The 16 real spherical harmonics of four bands, orthonormal over the sphere: float64 [..., 16] of unit
    vectors [..., 3].
    """
    d = np.asarray(directions, np.float64)
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    # Source: the usual polynomials, as Sloan 2008, appendix A2: a rational over pi under the root.
    terms = (
        (1, 4, np.ones_like(x)),
        (3, 4, y),
        (3, 4, z),
        (3, 4, x),
        (15, 4, x * y),
        (15, 4, y * z),
        (5, 16, 3.0 * (z * z) - 1.0),
        (15, 4, x * z),
        (15, 16, x * x - y * y),
        (35, 32, y * (3.0 * (x * x) - y * y)),
        (105, 4, x * y * z),
        (21, 32, y * (5.0 * (z * z) - 1.0)),
        (7, 16, z * (5.0 * (z * z) - 3.0)),
        (21, 32, x * (5.0 * (z * z) - 1.0)),
        (105, 16, z * (x * x - y * y)),
        (35, 32, x * (x * x - 3.0 * (y * y))),
    )
    return np.stack([math.sqrt(p / (q * math.pi)) * term for p, q, term in terms], axis=-1)


def random_pairs(count, seed=0):
    """``count`` pairs of directions spread at random over the upper hemisphere, by an integer hash: two
    float64 [count, 3]. Raises ValueError for fewer than one.
    """
    if not count >= 1 or int(count) != count:
        raise ValueError(f"There are {count!r} pairs of directions; give a whole number from 1 on.")
    number = np.arange(count)
    out = []
    for k in range(2):
        z, turn = (hashed(number, np.full(count, 2 * k + j), seed) / 65536.0 + 2.0**-17 for j in range(2))
        around, angle = np.sqrt(1.0 - z * z), 2.0 * math.pi * turn
        out.append(normalize(np.stack([around * cosine(angle), around * sine(angle), z], axis=-1)))
    return tuple(out)


@dataclass(frozen=True, eq=False)
class HarmonicBRDF:
    """Coefficients c_jk of f_r(l, v), float64 [16, 16, 3]: j of the light, k of the view, RGB."""

    coefficients: NDArray[np.float64]

    def at(self, towards, views):
        """f_r of directions [n, 3] each: float64 [n, 3]. It may fall below zero where f_r is near it."""
        y_l, y_v = basis(towards), basis(views)
        out = np.zeros((len(y_l), 3))
        for j in range(COEFFICIENTS):
            for k in range(COEFFICIENTS):
                out += (y_l[:, j] * y_v[:, k])[:, None] * self.coefficients[j, k]
        return out


def fitted(towards, views, samples, tikhonov=TIKHONOV):
    """The HarmonicBRDF nearest to samples [n, 3] at pairs of directions [n, 3] each.

    tikhonov  how much the squares of the coefficients count, times (1 + j's band + k's band) squared

    Raises ValueError for no samples, for samples that are not finite or not one for each pair, for invalid
    directions, and for a weight that is not positive. Without a weight, hemispheres do not determine the
    coefficients.
    """
    checked(towards)
    checked(views)
    samples = np.asarray(samples, np.float64)
    if samples.shape != (len(towards), 3) or len(towards) != len(views) or not np.isfinite(samples).all():
        raise ValueError(
            f"There are {len(towards)} lights, {len(views)} views and samples of shape {samples.shape}; give "
            "finite ones [n, 3], one for each pair."
        )
    if not 0.0 < tikhonov < math.inf:
        raise ValueError(f"The weight of the coefficients is {tikhonov!r}; give a positive number.")
    y_l, y_v = basis(towards), basis(views)
    # Light and view in either order, as f_r is the same.
    rows = np.concatenate([_products(y_l, y_v), _products(y_v, y_l)])
    # What counts is light that is sent back: near the horizon f_r is a quotient of two small numbers.
    sent = np.asarray(towards)[:, 2] * np.asarray(views)[:, 2]
    weights = np.concatenate([sent, sent])[:, None]
    rows, samples = rows * weights, np.concatenate([samples, samples]) * weights
    band = np.array([0] + [1] * 3 + [2] * 5 + [3] * 7)
    # What is constant over both spheres is not held back.
    weight = (band[:, None] + band[None, :]).ravel().astype(np.float64) ** 2
    normal = rows.T @ rows + np.diag(tikhonov * len(samples) * weight + 1e-9)
    found = np.linalg.solve(normal, rows.T @ samples)
    found = np.floor(found / _STEP + 0.5) * _STEP
    return HarmonicBRDF(found.reshape(COEFFICIENTS, COEFFICIENTS, 3))


def _products(first, second):
    return (first[:, :, None] * second[:, None, :]).reshape(len(first), -1)


def sampled(field, visibility, count=512, bounces=2, seed=0):
    """Random pairs of directions and f_r of a HeightField there: three float64 [count, 3]."""
    towards, views = random_pairs(count, seed)
    shares = goniometer.shares_in_texture_space(field, views)
    radiance = goniometer.pair_means(shares, goniometer.lights(field, visibility, towards, bounces))
    if field.specular:
        for k in range(count):
            one = slice(k, k + 1)
            radiance[k] += goniometer.highlights(field, towards[one], views[one], shares[one])[0, 0]
    return towards, views, radiance / (math.pi * goniometer.irradiance(field, towards))[:, None]
