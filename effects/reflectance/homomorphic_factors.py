"""H18: a reflectance as a product of functions of light, halfway vector and view, f_r = p(l) q(h) p(v).

The logarithm turns the product into a sum, log f_r = p'(l) + q'(h) + p'(v), which is linear in the texels of
p' and q'. Least squares solve it. A second, weak demand keeps the differences between neighbouring texels
small, so texels without data are smooth. So all factors are positive, whatever the table is, and p serves
twice. The fit is to the ratio with the table, so dark places are as accurate as highlights.

Light and view lie at the texels of one map; their halfway vector lies between four texels of the other. Light
and view may change places, so each pair counts once, with the geometric mean of both orders. A pair's weight
is its solid angles and its cosines. Conjugate gradients solve the equations, each component by itself.

Source: McCool, Ang, Ahmad 2001 (the logarithm, p used twice, smoothness); Heidrich 2001, section 1.1.2.
Chosen: the weights, the least value, conjugate gradients.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.vectors import normalize, of_40_bits
from fixedpipe.effects.reflectance import hemisphere_maps
from fixedpipe.effects.technique import Technique
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (Technique("H18", "homomorphic factors: p(l) q(h) p(v), fitted to logarithms", "1.1.2"),)

# What is darker than this share of the mean counts as that: the logarithm has no zero.
LEAST_SHARE = 2.0**-8
# Assumed: what a step between neighbouring texels costs, over what the mean texel's data do.
SMOOTHNESS = 2e-3
# The residual over the right side that is small enough, and the most steps.
TOLERANCE, MOST_STEPS = 1e-4, 300
# Logarithms differ in their last bit between processors; rounded to a multiple of this they do not.
_LOGARITHM_STEP = 2.0**-20


@dataclass(frozen=True, eq=False)
class HomomorphicFactors:
    """The product: ``direction`` is p and ``half`` is q, float64 [n, n, 3], maps of ``hemisphere_maps``,
    positive, their largest texel one per component; ``scale`` float64 [3]: f_r = scale p(l) q(h) p(v).
    """

    direction: NDArray[np.float64]
    half: NDArray[np.float64]
    scale: NDArray[np.float64]

    @property
    def size(self) -> int:
        """Texels along an edge of the maps."""
        return len(self.half)

    def at(self, lights, views):
        """f_r of directions [n, 3] each, above the horizon: float64 [n, 3]."""
        half = normalize(np.asarray(lights, np.float64) + views)
        p, q = self.direction, self.half
        found = hemisphere_maps.look_up(p, lights) * hemisphere_maps.look_up(p, views)
        return self.scale * (found * hemisphere_maps.look_up(q, half))


@kernel("void(int32[:, ::1], float64[:, ::1], float64[::1], int64, float64[:, ::1], float64[:, ::1])")
def _normal_times(texels, shares, weights, size, unknowns, out):
    """Adds to ``out`` what the pairs' equations, transposed and weighted, make of the ``unknowns``.

    texels   of each pair: the light's and the view's, and the lower left of the halfway vector's four
    shares   of each pair: the four texels', the lower row first
    unknowns, out  [2 size^2, 3]: p', then q'
    """
    texel_count = size * size
    for pair in range(len(texels)):
        light, view = texels[pair, 0], texels[pair, 1]
        corner = texel_count + texels[pair, 2]
        a, b, c, d = shares[pair, 0], shares[pair, 1], shares[pair, 2], shares[pair, 3]
        above = corner + size
        for k in range(3):
            value = (unknowns[light, k] + unknowns[view, k]) + (
                (a * unknowns[corner, k] + b * unknowns[corner + 1, k])
                + (c * unknowns[above, k] + d * unknowns[above + 1, k])
            )
            value = value * weights[pair]
            out[light, k] += value
            out[view, k] += value
            out[corner, k] += a * value
            out[corner + 1, k] += b * value
            out[above, k] += c * value
            out[above + 1, k] += d * value


@kernel("void(int32[:, ::1], float64[:, ::1], float64[:, ::1], int64, float64[:, ::1])")
def _gathered(texels, shares, values, size, out):
    """Adds each pair's ``values`` [n, 3] to its texels' ``out`` [2 size^2, 3]: the equations transposed."""
    texel_count = size * size
    for pair in range(len(texels)):
        light, view = texels[pair, 0], texels[pair, 1]
        corner = texel_count + texels[pair, 2]
        for k in range(3):
            value = values[pair, k]
            out[light, k] += value
            out[view, k] += value
            out[corner, k] += shares[pair, 0] * value
            out[corner + 1, k] += shares[pair, 1] * value
            out[corner + size, k] += shares[pair, 2] * value
            out[corner + size + 1, k] += shares[pair, 3] * value


def _smoothed(maps, cost):
    """What the demand for smoothness makes of maps [2, n, n, 3]: the differences, transposed."""
    out = np.zeros_like(maps)
    for axis in (1, 2):
        step = np.diff(maps, axis=axis)
        low = tuple(slice(0, -1) if k == axis else slice(None) for k in range(4))
        high = tuple(slice(1, None) if k == axis else slice(None) for k in range(4))
        out[high] += step
        out[low] -= step
    return cost * out


def _dots(a, b):
    """The sum of products per component, exactly rounded: float64 [3]."""
    return np.array([math.fsum((a[:, k] * b[:, k]).tolist()) for k in range(3)])


def _solved(times, right):
    """Conjugate gradients from zero for ``times(x) = right`` [n, 3], each component for itself."""
    x, rest = np.zeros_like(right), right.copy()
    along, size = rest.copy(), _dots(right, right)
    enough = size * (TOLERANCE * TOLERANCE)
    for _ in range(MOST_STEPS):
        if (size <= enough).all():
            break
        turned = times(along)
        under = _dots(along, turned)
        step = size / np.where(under > 0.0, under, np.inf)
        x, rest = x + step * along, rest - step * turned
        before, size = size, _dots(rest, rest)
        along = rest + size / np.where(before > 0.0, before, np.inf) * along
    return x


def _pairs(size):
    """Lights and views: the flat indices of their texels, each pair once; of all texels the directions."""
    held = hemisphere_maps.inside(size)
    first, second = np.triu_indices(len(held))
    return held, first, second, normalize(hemisphere_maps.directions(size).reshape(-1, 3)[held])


def _cut(brdf, lights, views):
    """``hemisphere_maps.sampled`` cut for cut, so that arrays stay small."""
    out = np.empty(lights.shape)
    for start in range(0, len(lights), 1 << 16):
        some = slice(start, start + (1 << 16))
        out[some] = hemisphere_maps.sampled(brdf, lights[some], views[some])
    return out


def _logarithms(first, second, weights):
    """The mean logarithm of both orders, of samples [n, 3] that are not below the least: float64 [n, 3]."""
    total = max(math.fsum(weights.tolist()), 1e-300)
    mean = np.array([math.fsum((weights * first[:, k]).tolist()) for k in range(3)]) / total
    if not mean.any():
        raise ValueError("The BRDF is zero everywhere; there is nothing to factor.")
    # A component that is zero everywhere is as dark beside the others.
    least = LEAST_SHARE * np.where(mean > 0.0, mean, LEAST_SHARE * mean.max())
    both = np.log(np.maximum(first, least)) + np.log(np.maximum(second, least))
    return np.floor(0.5 * both / _LOGARITHM_STEP + 0.5) * _LOGARITHM_STEP


def factored(brdf, size=32, smoothness=SMOOTHNESS):
    """The HomomorphicFactors of a BRDF, an object with ``at(lights, views)``, maps ``size`` texels an edge.

    smoothness  cost of a step of one in the logarithm from texel to texel, over the cost of the mean texel's
                data; positive

    Raises ValueError for a size that is not from 4 to 64, a smoothness that is not positive, a BRDF that is
    zero everywhere, and as ``hemisphere_maps.sampled``.
    """
    size = hemisphere_maps.size_of_factors(size)
    if not 0.0 < smoothness < math.inf:
        raise ValueError(f"The smoothness is {smoothness!r}; give a positive number, 0.002 for instance.")
    held, first, second, texels = _pairs(size)
    lights, views = texels[first], texels[second]
    angles = hemisphere_maps.solid_angles(size) * texels[:, 2]
    weights = angles[first] * angles[second] * np.where(first == second, 0.5, 1.0)
    values = _logarithms(_cut(brdf, lights, views), _cut(brdf, views, lights), weights)

    place = hemisphere_maps.coordinates(normalize(lights + views))
    at = np.clip(place[:, :2] / place[:, 3:] * size - 0.5, 0.0, size - 1.0)
    low = np.minimum(np.floor(at).astype(np.int64), size - 2)
    u, v = (at - low).T
    shares = np.stack([(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v], axis=-1)
    where = np.stack([held[first], held[second], low[:, 1] * size + low[:, 0]], axis=-1).astype(np.int32)
    shares, weights = np.ascontiguousarray(shares), np.ascontiguousarray(weights)
    # The data's demands on the mean texel are one, so that smoothness has the same meaning for every size.
    weights = weights * (size * size / math.fsum(weights.tolist()))

    def times(unknowns):
        out = _smoothed(unknowns.reshape(2, size, size, 3), smoothness).reshape(-1, 3)
        _normal_times(where, shares, weights, size, np.ascontiguousarray(unknowns), out)
        return out

    right = np.zeros((2 * size * size, 3))
    _gathered(where, shares, np.ascontiguousarray(weights[:, None] * values), size, right)
    p, q = _solved(times, right).reshape(2, size, size, 3)
    highest_p, highest_q = p.max(axis=(0, 1)), q.max(axis=(0, 1))
    powers = p - highest_p, q - highest_q, 2.0 * highest_p + highest_q
    return HomomorphicFactors(*(of_40_bits(np.exp(power)) for power in powers))
