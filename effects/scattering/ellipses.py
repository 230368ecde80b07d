"""G14 and G20: for every texel an ellipse in the tangent plane that holds the unblocked directions.

Slightly curved surfaces take five ellipses (G20).

A direction is seen from above as the point (x, y) of the unit disc. U are the free directions of the upper
hemisphere. The ellipse's centre is the mean of U, and its axis is the larger eigenvector of the covariance.
The radii begin at twice the roots of the eigenvalues, as for an evenly filled ellipse. Then a search improves
one radius after the other. With one radius fixed, each direction is inside from a known value of the other
on, so walking through these values in order finds the best. The best radius has the most free directions
inside, less the shadowed ones inside. Among equally good radii it takes the middle of the widest range. The
count never falls, so the search ends.

A free direction may count as several shadowed ones (``free_weight``). Where the weight is w, moving the edge
inwards pays only where at least w shadowed directions leave for each free one. So of the directions that a
radius excludes, at most 1 / (1 + w) are free: half with the plain count, a quarter with 3
(docs/decisions/0036).

The caller decides how to count a direction from which the texel faces away (BACK). Either it is shadowed
(A-G01), or it does not count, because its cosine is zero in any case (``counted``; erratum E002.9).

If no direction is free, the ellipse is far away.

The six numbers of a texel are two linear forms of (l_x, l_y, 1), E1 and E2; l is inside if E1^2 + E2^2 <= 1.
Any rotation of the pair is the same test. ``packed`` gives the paper's pair, along the axes. There a and -a
are one axis, so neighbours may have opposite signs, and a filter between them gives a form near zero that
lets all light in. ``rooted`` gives the pair with a symmetric, positive matrix: the root of the quadratic
form. It is unique and changes smoothly where the ellipse does, so it may be filtered and differenced.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 4, Eqs. 2-4, and section 5. Assumed: the search; the
paper says a local one. Inferred: the symmetric pair (erratum E002.15).
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.scattering.visibility import BACK, FREE
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("G14", "for every texel an ellipse around its free directions", "4"),
    Technique("G20", "five ellipses, whose numbers are linear in the surface's curvature", "5"),
    Technique("H47", "for every texel an ellipse around its free directions", "3.1"),
)

# The numbers of E1 and E2 are stored as quarters (A-G15), so that radii go down to this. Where no ellipse is
# that small, halves of them are twice as exact.
LEAST_RADIUS = 0.25
# Inferred: with this radius and its centre in the unit disc an ellipse holds the disc, or its edge crosses it
# all but straight; a larger one would only leave fewer of the steps that eight bits have.
LARGEST_RADIUS = 2.0
# The ellipse of a texel that nothing reaches. E1 is (0.5, 0, 2), at least 1.5 on the unit disc, and its
# numbers may be stored as halves. Assumed: a tiny one has larger numbers and is no farther outside.
_NOWHERE, _NOWHERE_RADIUS = -4.0, 2.0
# Assumed: of some hundred directions a ridge hides a few; with a larger weight it would have no shadow as
# soon as one free direction lies among them.
LARGEST_FREE_WEIGHT = 16.0
# How often both radii are searched. Measured: of random ridges' directions the first search has 98 % of what
# ten have, four have 99.9 %.
_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class Ellipses:
    """An ellipse for every texel.

    center  float64 [rows, columns, 2], in the plane of the base, where directions are (x, y)
    axis    float64 [rows, columns, 2], of length one: the first radius lies along it
    radii   float64 [rows, columns, 2], along the axis and across, LEAST_RADIUS to LARGEST_RADIUS

    Source: section 4; five of the six numbers are independent (E002.6).
    """

    center: NDArray[np.float64]
    axis: NDArray[np.float64]
    radii: NDArray[np.float64]

    @property
    def stored_bytes(self) -> int:
        """Two RGB textures (section 6: 6144 bytes for 32 x 32)."""
        return 6 * self.radii[..., 0].size

    def test(self, x, y):
        """1 - (l'_x / r_1)^2 - (l'_y / r_2)^2 of Eq. 4, float64 [rows, columns]: lit where it is not
        negative.

        x, y  the light's, one or [rows, columns]
        """
        e1, e2 = packed(self)
        return tested(e1, e2, x, y)


def tested(e1, e2, x, y):
    """Eq. 4 of two linear forms [..., 3]: 1 - (E1.(x, y, 1))^2 - (E2.(x, y, 1))^2, float64 [...]."""
    first = (e1[..., 0] * x + e1[..., 1] * y) + e1[..., 2]
    second = (e2[..., 0] * x + e2[..., 1] * y) + e2[..., 2]
    return (1.0 - first * first) - second * second


@kernel("float64(float64[:, ::1], int64, int64, float64, float64)")
def _best_radius(found, count, which, other, smallest):
    """The radius along axis ``which`` that is best with the ``other`` one across.

    found  float64 [5, n]: squares of both coordinates in the ellipse's frame, the weight of a free direction
           and -1 of a shadowed one, and room for two sorted lists
    """
    least, largest = smallest * smallest, LARGEST_RADIUS * LARGEST_RADIUS
    across = 1.0 / (other * other)
    inside, listed = 0.0, 0
    for i in range(count):
        left = 1.0 - found[1 - which, i] * across
        # A direction is inside where the radius's square is this or more.
        if left > 0.0:
            needed = found[which, i] / left
            if needed <= least:
                inside += found[2, i]
            elif needed < largest:
                k = listed
                while k > 0 and found[3, k - 1] > needed:
                    found[3, k], found[4, k] = found[3, k - 1], found[4, k - 1]
                    k -= 1
                found[3, k], found[4, k] = needed, found[2, i]
                listed += 1
    best, best_width, radius, begin = -1.0e9, 0.0, smallest, smallest
    for k in range(listed + 1):
        end = np.sqrt(found[3, k]) if k < listed else LARGEST_RADIUS
        if end > begin and (inside > best or (inside == best and end - begin > best_width)):
            best, best_width, radius = inside, end - begin, 0.5 * (begin + end)
        if k < listed:
            inside, begin = inside + found[4, k], end
    return radius


@kernel(
    "void(int8[:, :, ::1], float64[:, :, :, ::1], UniTuple(float64, 2), int64, int64, float64[:, ::1], "
    "float64[:, :, ::1])"
)
def _fit(counts, xy, settings, first, last, found, out):
    """Ellipses of rows ``first`` to ``last``: centre, axis, radii into ``out`` [rows, columns, 6].

    counts    [n, rows, columns]: 1 free, -1 shadowed, 0 neither
    xy        [n, rows or 1, columns or 1, 2]
    settings  the smallest radius, and what a free direction weighs
    """
    smallest, weight = settings
    n, _, columns = counts.shape
    for row in range(first, last):
        for column in range(columns):
            r, c = row % xy.shape[1], column % xy.shape[2]
            free, x, y = 0, 0.0, 0.0
            for i in range(n):
                if counts[i, row, column] == 1:
                    free, x, y = free + 1, x + xy[i, r, c, 0], y + xy[i, r, c, 1]
            if free == 0:
                out[row, column, 0], out[row, column, 1] = _NOWHERE, 0.0
                out[row, column, 2], out[row, column, 3] = 1.0, 0.0
                out[row, column, 4] = out[row, column, 5] = _NOWHERE_RADIUS
                continue
            x, y = x / free, y / free
            xx, xy_, yy = 0.0, 0.0, 0.0
            for i in range(n):
                if counts[i, row, column] == 1:
                    u, v = xy[i, r, c, 0] - x, xy[i, r, c, 1] - y
                    xx, xy_, yy = xx + u * u, xy_ + u * v, yy + v * v
            xx, xy_, yy = xx / free, xy_ / free, yy / free
            half, mean = 0.5 * (xx - yy), 0.5 * (xx + yy)
            root = np.sqrt(half * half + xy_ * xy_)
            # The larger eigenvector, (xy, l - xx) or (l - yy, xy): the one that cancels nothing.
            if half >= 0.0:
                a, b = root + half, xy_
            else:
                a, b = xy_, root - half
            length = np.sqrt(a * a + b * b)
            if length == 0.0:
                a, b = 1.0, 0.0
            else:
                a, b = a / length, b / length
            # Of a and -a the one to the right, or upwards.
            if a < 0.0 or (a == 0.0 and b < 0.0):
                a, b = -a, -b
            count = 0
            for i in range(n):
                if counts[i, row, column] != 0:
                    u, v = xy[i, r, c, 0] - x, xy[i, r, c, 1] - y
                    along, across = a * u + b * v, a * v - b * u
                    found[0, count], found[1, count] = along * along, across * across
                    found[2, count] = weight if counts[i, row, column] == 1 else -1.0
                    count += 1
            r1 = 2.0 * np.sqrt(mean + root)
            r2 = 2.0 * np.sqrt(max(mean - root, 0.0))
            r1 = min(max(r1, smallest), LARGEST_RADIUS)
            r2 = min(max(r2, smallest), LARGEST_RADIUS)
            for _ in range(_ROUNDS):
                before1, before2 = r1, r2
                r1 = _best_radius(found, count, 0, r2, smallest)
                r2 = _best_radius(found, count, 1, r1, smallest)
                if r1 == before1 and r2 == before2:
                    break
            out[row, column, 0], out[row, column, 1] = x, y
            out[row, column, 2], out[row, column, 3] = a, b
            out[row, column, 4], out[row, column, 5] = r1, r2


def fit(free, xy, counted=None, least_radius=LEAST_RADIUS, free_weight=1.0):
    """The Ellipses of directions that are seen from above as points ``xy``.

    free     bool [n, rows, columns]: whether the direction is free
    xy       float64 [n, 2], or [n, rows, columns, 2] where they are another at every texel
    counted  bool [n, rows, columns]: which take part; None: all
    least_radius  of both axes, 1/4 to 1
    free_weight   as how many shadowed directions a free one counts, 1 to 16: one is the paper's

    Raises ValueError for arrays that do not fit each other, coordinates that are not finite, and numbers out
    of range; also for fewer than three directions, because directions below the horizon say nothing about
    light from above.
    """
    free = np.ascontiguousarray(free, bool)
    points = np.asarray(xy, np.float64)
    if free.ndim != 3 or 0 in free.shape[1:]:
        raise ValueError(f"What is free has shape {free.shape}; give [n, rows, columns].")
    if points.ndim == 2:
        points = points[:, None, None]
    if points.shape not in ((len(free), 1, 1, 2), (*free.shape, 2)):
        raise ValueError(
            f"The directions have shape {np.shape(xy)}; give [{len(free)}, 2] or {(*free.shape, 2)}, as many "
            "as there are of what is free."
        )
    if len(free) < 3:
        raise ValueError(
            f"{len(free)} of the directions lie above the horizon, and an ellipse is fitted to three or "
            "more: give directions over the whole sphere, some hundred of them."
        )
    if not LEAST_RADIUS <= least_radius <= 1.0:
        raise ValueError(f"The least radius is {least_radius!r}; give a number from {LEAST_RADIUS} to 1.")
    if not 1.0 <= free_weight <= LARGEST_FREE_WEIGHT:
        raise ValueError(
            f"A free direction counts as {free_weight!r} shadowed ones; give a number from 1 to "
            f"{LARGEST_FREE_WEIGHT:g}."
        )
    if not (np.abs(points) <= LARGEST_RADIUS).all():
        raise ValueError(
            "The directions hold NaN or infinity, or numbers far beyond the unit disc; give x and y of unit "
            "vectors."
        )
    counts = np.where(free, np.int8(1), np.int8(-1))
    if counted is not None:
        counts[~np.broadcast_to(np.asarray(counted, bool), free.shape)] = 0
    points = np.ascontiguousarray(points)
    rows = free.shape[1]
    out = np.empty((*free.shape[1:], 6))
    step = max(1, rows // (4 * default_threads()))
    settings = float(least_radius), float(free_weight)

    def some(first):
        room = np.empty((5, len(free)))
        _fit(counts, points, settings, first, min(first + step, rows), room, out)

    with ThreadPoolExecutor(default_threads()) as threads:
        list(threads.map(some, range(0, rows, step)))
    return Ellipses(*(np.ascontiguousarray(out[..., k : k + 2]) for k in (0, 2, 4)))


def of_visibility(visibility, turned_away_counts=False, least_radius=LEAST_RADIUS, free_weight=1.0):
    """The Ellipses of a Visibility, by its directions above the horizon.

    turned_away_counts  whether a direction from which a texel faces away counts as shadowed; otherwise it
                        does not count, because its light is zero
    least_radius        as for ``fit``
    free_weight         as for ``fit``

    Raises ValueError where fewer than three directions lie above the horizon, and for numbers beyond their
    ranges.
    """
    upper = visibility.directions[:, 2] > 0.0
    seen = visibility.seen[upper]
    counted = None if turned_away_counts else seen != BACK
    return fit(seen == FREE, visibility.directions[upper, :2], counted, least_radius, free_weight)


def aligned(ellipses, reference):
    """The same ellipses, their axes named so that each lies nearest to the reference's (E002.7): a may become
    -a, and the two axes change places.
    """
    a, b = ellipses.axis[..., 0], ellipses.axis[..., 1]
    x, y = reference.axis[..., 0], reference.axis[..., 1]
    along, across = a * x + b * y, a * y - b * x
    swapped = np.abs(across) > np.abs(along)
    # Across is (-b, a).
    axis = np.where(swapped[..., None], np.stack([-b, a], axis=-1), ellipses.axis)
    negative = np.where(swapped, across, along) < 0.0
    axis = np.where(negative[..., None], -axis, axis)
    radii = np.where(swapped[..., None], ellipses.radii[..., ::-1], ellipses.radii)
    return replace(ellipses, axis=axis, radii=radii)


def packed(ellipses):
    """E1 = (a_x, a_y, -a.c) / r_1 and E2 = (-a_y, a_x, -a_perp.c) / r_2: two float64 [rows, columns, 3]."""
    a, b = ellipses.axis[..., 0], ellipses.axis[..., 1]
    x, y = ellipses.center[..., 0], ellipses.center[..., 1]
    first = np.stack([a, b, -(a * x + b * y)], axis=-1) / ellipses.radii[..., :1]
    second = np.stack([-b, a, -(a * y - b * x)], axis=-1) / ellipses.radii[..., 1:]
    return first, second


def rooted(ellipses):
    """The pair of linear forms whose first two columns are symmetric and positive, the root of the quadratic
    form: two float64 [rows, columns, 3]. The same test as ``packed``, without a choice of signs.
    """
    a, b = ellipses.axis[..., 0], ellipses.axis[..., 1]
    p, q = 1.0 / ellipses.radii[..., 0], 1.0 / ellipses.radii[..., 1]
    xx, xy, yy = a * a * p + b * b * q, a * b * (p - q), b * b * p + a * a * q
    x, y = ellipses.center[..., 0], ellipses.center[..., 1]
    first = np.stack([xx, xy, -(xx * x + xy * y)], axis=-1)
    second = np.stack([xy, yy, -(xy * x + yy * y)], axis=-1)
    return first, second


def smoothed(forms, passes=1):
    """A pair of forms, from ``rooted``, after ``passes`` binomial filters (1 2 1)/4: two float64 [rows,
    columns, 3].

    The filters run along both axes of the periodic field. A fit's numbers change in steps, from one direction
    to the next. Neighbours' steps are at other places, so their mean is nearer to the true number. Measured:
    with a hundred directions, one pass raises the agreement with rays from .940 to .947 on a terrain and from
    .939 to .951 on a bed of stones. The shadows' edges are less ragged. Four passes bring no more.
    """
    return tuple(
        np.stack([height_fields.smooth(form[..., k], passes) for k in range(3)], axis=-1) for form in forms
    )


def curved(flat, along_u, along_v, step, kappa_u, kappa_v, pack=packed):
    """E1 and E2 at curvatures: theta_0 + kappa_u / 2d (theta_u+ - theta_u-) + kappa_v / 2d (theta_v+ -
    theta_v-), two float64 [rows, columns, 3].

    flat              Ellipses without curvature
    along_u, along_v  two Ellipses each, for curvatures of +d and -d along that axis
    step              d, positive
    kappa_u, kappa_v  numbers, or [rows, columns]
    pack              ``packed``, with axes ``aligned`` to the flat ellipses' here, or ``rooted``

    Raises ValueError for a step that is not positive. Source: section 5; pass sequence A-G20.
    """
    if not 0.0 < step < np.inf:
        raise ValueError(f"The step of curvature is {step!r}; give a positive number.")
    parts = [*pack(flat)]
    for kappa, pair in ((kappa_u, along_u), (kappa_v, along_v)):
        factor = np.asarray(kappa, np.float64) / (2.0 * step)
        more, less = (pack(aligned(ellipses, flat)) for ellipses in pair)
        for k in range(2):
            parts[k] = parts[k] + factor[..., None] * (more[k] - less[k])
    return tuple(parts)
