"""H17: a reflectance of four parameters as a sum of products of two functions of a direction.

    f_r(l, v) = sum over k of u_k(a) v_k(b)

(a, b) are the halfway and the difference vector, or light and view. The table of all texels of a against all
texels of b is a matrix. The terms are those of its singular value decomposition, found one after the other.
Each is fitted to the remainder of its predecessors: u for given v and v for given u, in turn. A pair of
texels has as weight its solid angles, times the squares of the light's and the view's cosines. Pairs with
light or view below the horizon have no weight, so they need no value. If every weight is a product of two,
the result is the decomposition itself, to the fit's tolerance.

If a table is nowhere negative, neither is its first term; later ones have signs. ``NORMS`` is the cheap way:
one term, u the norm of each row, v the mean of the rows over their norms.

Source: Kautz, McCool 1999 (both decompositions, the parameters); Heidrich 2001, section 1.1.2. Chosen: the
weights, and alternating fits in place of a singular value decomposition.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.reflectance import hemisphere_maps
from fixedpipe.effects.reflectance.hemisphere_maps import Halves
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("H17", "separable factors: a tabulated BRDF as products of two maps of directions", "1.1.2"),
    Technique("H19", "separable factors of a BRDF that a goniometer simulates", "1.1.2"),
)

# Fits of u and v in turn that a term has at the most, and the change of u, over its norm, that ends them.
MOST_TURNS, TOLERANCE = 16, 1e-3
MOST_TERMS = 8
# Halfway and difference vectors make lights and views so near to the horizon that a cosine is no number to
# divide by: those below this do not count.
LEAST_COSINE = 1e-3


class Fit(Enum):
    """How a term is found."""

    SINGULAR_VALUES = "singular values"
    NORMS = "norms"


@dataclass(frozen=True, eq=False)
class Table:
    """A reflectance at all pairs of texels, and how much each pair counts.

    halves   what rows and columns are
    size     texels along an edge of the maps
    samples  float64 [m, m, 3]: f_r; rows and columns are the texels of ``hemisphere_maps.inside``
    weights  float64 [m, m], zero where light or view is below the horizon
    """

    halves: Halves
    size: int
    samples: NDArray[np.float64]
    weights: NDArray[np.float64]

    def error(self, values):
        """The RMS of ``values`` [m, m, 3] less the samples over the samples' RMS, by the weights."""
        away, whole = values - self.samples, self.samples
        squares = [(self.weights * (each * each).sum(axis=-1)).sum() for each in (away, whole)]
        return float(np.sqrt(squares[0] / squares[1])) if squares[1] > 0.0 else 0.0


@dataclass(frozen=True, eq=False)
class SeparableFactors:
    """The sum of products: ``first`` and ``second``, float64 [terms, n, n, 3], maps of ``hemisphere_maps``.

    The second of each term reaches one at the most, per component; the first of the first term and the second
    are nowhere negative.
    """

    halves: Halves
    first: NDArray[np.float64]
    second: NDArray[np.float64]

    @property
    def terms(self) -> int:
        """How many products are added."""
        return len(self.first)

    @property
    def size(self) -> int:
        """Texels along an edge of the maps."""
        return self.first.shape[1]

    def at(self, lights, views):
        """f_r of directions [n, 3] each, above the horizon: float64 [n, 3], at least zero."""
        a, b = hemisphere_maps.halves_of(self.halves, lights, views)
        total = np.zeros(np.shape(lights))
        for first, second in zip(self.first, self.second, strict=True):
            total = total + hemisphere_maps.look_up(first, a) * hemisphere_maps.look_up(second, b)
        return np.maximum(total, 0.0)

    def values(self):
        """The products' values at the Table's samples: float64 [m, m, 3]."""
        held = hemisphere_maps.inside(self.size)
        total = 0.0
        for first, second in zip(self.first, self.second, strict=True):
            u, v = (image.reshape(-1, 3)[held] for image in (first, second))
            total = total + u[:, None] * v[None]
        return total


def texels(size):
    """Unit vectors of a table's rows and columns: float64 [m, 3]."""
    return normalize(hemisphere_maps.directions(size).reshape(-1, 3)[hemisphere_maps.inside(size)])


def table(brdf, size=32, halves=Halves.HALFWAY_AND_DIFFERENCE):
    """The Table of a BRDF, an object with ``at(lights, views)``, of maps ``size`` texels along an edge.

    Raises ValueError for a size that is not from 4 to 64, and as ``hemisphere_maps.sampled``.
    """
    halves = member_of(Halves, halves, "What the factors are functions of")
    size = hemisphere_maps.size_of_factors(size)
    angles, places = hemisphere_maps.solid_angles(size), texels(size)
    count = len(places)
    first, second = np.repeat(places, count, axis=0), np.tile(places, (count, 1))
    if halves is Halves.HALFWAY_AND_DIFFERENCE:
        first, second = hemisphere_maps.light_and_view(first, second)
    # Cut for cut: the arrays of all pairs at once would be hundreds of megabytes for larger maps.
    counts = (first[:, 2] > LEAST_COSINE) & (second[:, 2] > LEAST_COSINE)
    samples = np.zeros((count * count, 3))
    pairs = np.flatnonzero(counts)
    for start in range(0, len(pairs), 1 << 16):
        some = pairs[start : start + (1 << 16)]
        samples[some] = hemisphere_maps.sampled(brdf, normalize(first[some]), normalize(second[some]))
    cosines = np.where(counts, first[:, 2] * second[:, 2], 0.0).reshape(count, count)
    return Table(
        halves, size, samples.reshape(count, count, 3), cosines * cosines * angles[:, None] * angles[None]
    )


def table_of(samples, size, halves=Halves.LIGHT_AND_VIEW):
    """The Table of samples [m, m, 3] for all texels of ``hemisphere_maps.inside``, all above the horizon.

    Raises ValueError for another shape, for NaN and infinity and for halves under which some are below it.
    """
    if halves is not Halves.LIGHT_AND_VIEW:
        raise ValueError("A table of all pairs is of light and view; of halfway vectors give a BRDF.")
    samples, count = np.asarray(samples, np.float64), len(hemisphere_maps.inside(size))
    if samples.shape != (count, count, 3) or not np.isfinite(samples).all():
        raise ValueError(
            f"The samples have shape {samples.shape}; give finite numbers, {(count, count, 3)}, for maps of "
            f"{size} x {size} texels."
        )
    angles = hemisphere_maps.solid_angles(size)
    z = texels(size)[:, 2]
    one = angles * (z * z)
    return Table(halves, size, np.maximum(samples, 0.0), one[:, None] * one[None])


# ----------------------------------------------------------------------------------------------- fitting


def _weighted(counted, weights, given):
    """The factor [n, 3] that fits best to what is left for a ``given`` [m, 3]: the sum over the other's
    texels of weight, rest and ``given``, over that of weight and its square.

    counted  float64 [m, n, 3]: weight times rest; the sum is taken in the order of m
    weights  float64 [m, n]
    """
    products = np.zeros(counted.shape[1:])
    squares = np.zeros(counted.shape[1:])
    for row, weight, value in zip(counted, weights, given, strict=True):
        products += row * value
        squares += weight[:, None] * (value * value)
    return products / np.where(squares > 0.0, squares, 1.0)


def _first_guess(counted):
    """A row of what is left that is large: float64 [n, 3], for each component the row with the largest sum of
    magnitudes.
    """
    sizes = np.zeros((len(counted), 3))
    for column in range(counted.shape[1]):
        sizes += np.abs(counted[:, column])
    return np.stack([counted[int(np.argmax(sizes[:, k])), :, k] for k in range(3)], axis=-1)


def _term(rest, weights):
    """The product that fits best to ``rest`` [m, n, 3]: float64 [m, 3] and [n, 3]."""
    counted = weights[..., None] * rest
    turned, turned_weights = (np.ascontiguousarray(np.swapaxes(array, 0, 1)) for array in (counted, weights))
    v = _first_guess(counted)
    u = np.zeros((len(rest), 3))
    for _ in range(MOST_TURNS):
        before, u = u, _weighted(turned, turned_weights, v)
        v = _weighted(counted, weights, u)
        largest = np.abs(v).max(axis=0)
        v = v / np.where(largest > 0.0, largest, 1.0)
        if np.abs(u - before).max() <= TOLERANCE * np.abs(u).max():
            break
    return _weighted(turned, turned_weights, v), v


def _by_norms(rest, weights):
    """Rows' norms and the mean of the rows over them: float64 [m, 3] and [n, 3]."""
    ones = np.ones((rest.shape[1], 3))
    turned, turned_weights = (
        np.ascontiguousarray(np.swapaxes(array, 0, 1))
        for array in (weights[..., None] * (rest * rest), weights)
    )
    u = np.sqrt(_weighted(turned, turned_weights, ones))
    over = rest / np.where(u > 0.0, u, 1.0)[:, None]
    v = _weighted(weights[..., None] * over, weights, np.ones((len(rest), 3)))
    largest = np.abs(v).max(axis=0)
    largest = np.where(largest > 0.0, largest, 1.0)
    return u * largest, v / largest


def factored(samples, terms=1, way=Fit.SINGULAR_VALUES):
    """The SeparableFactors of a Table.

    terms  products that are added; ``Fit.NORMS`` has one

    Raises ValueError for a number of terms that is not from 1 to 8, and for more than one by norms.
    """
    way = member_of(Fit, way, "The way in which factors are found")
    most = MOST_TERMS if way is Fit.SINGULAR_VALUES else 1
    if isinstance(terms, bool) or int(terms) != terms or not 1 <= terms <= most:
        raise ValueError(f"{terms!r} terms by {way.value}; give a whole number from 1 to {most}.")
    rest, found = samples.samples, []
    for _ in range(int(terms)):
        fit = _term if way is Fit.SINGULAR_VALUES else _by_norms
        u, v = fit(rest, samples.weights)
        found.append((u, v))
        rest = rest - u[:, None] * v[None]
    # Texels that no pair tells of: at the horizon, of halfway and difference vectors.
    known = [(samples.weights > 0.0).any(axis=axis) for axis in (1, 0)]
    first, second = (
        np.stack([hemisphere_maps.filled(pair[k], samples.size, known[k]) for pair in found]) for k in (0, 1)
    )
    return SeparableFactors(samples.halves, first, second)
