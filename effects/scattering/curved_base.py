"""G18, G19 and G21: a height field on a bent or stretched base. Texels see the same points, in new
directions.

The base has the principal curvatures kappa_u and kappa_v, along s and t, in 1 / edge of the field's square.
They are positive where the base is convex and valleys widen. A point (x, y, h), relative to a texel p and h
above the base, moves to

    X = sin(kappa_u x) (1 / kappa_u + h),   Z = cos(kappa_u x) (1 / kappa_u + h) - 1 / kappa_u
    Y = sin(kappa_v y) (1 / kappa_v + Z),   z = cos(kappa_v y) (1 / kappa_v + Z) - 1 / kappa_v

in the frame of the base at p. The base is a cylinder if one curvature is zero, a sphere if both are equal,
and a torus otherwise. Sines and cosines are series. The bent position is the flat one plus a difference. So
the flat base is exact to the last bit, and a small curvature loses no digits.

A direction d_i turns to the new place of the point that it saw. Directions that see nothing stay (erratum
E002.12: they end at infinity). A direction's weight is the growth of its part of the sphere, w_i = A_i /
A_i(0) (E002.13). Normals transform by the map's Jacobian, in the frame at their own texel: n_x / (s_x (1 +
kappa_u h)), n_y / (s_y (1 + kappa_v h)), n_z. A stretch of the base by (s_x, s_y) comes first. It is linear,
so straight lines stay straight and it moves all directions, even those that see nothing.

The choice of A_i decides how much of a bend shows. The paper's triangles round the moved directions
(``fan_weights``) halve the gap between a direction that moves and one that stays, although all of the gap is
sky. They find a third of the change of a groove's indirect light. Measured:
tests/effects/scattering/test_curved_base.py. Where directions move past others that stay, the triangles fold
over. So the borders of A_i move too (``border_weights``). The gap between two directions moves with the
nearer of the points that they see, because its edge hides the other.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 5; pass sequences A-G18, A-G19 and A-G21.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.vectors import cross, dot, from_frame, normalize
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering.light_transport import WEIGHT, looked_up
from fixedpipe.effects.scattering.visibility import BACK, FREE, distances
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("G18", "a curved base: visibility is kept, directions and normals are computed anew", "5"),
    Technique("G19", "weights for moved directions: how much of the sphere each stands for", "5"),
    Technique("G21", "a base that is stretched, one axis more than the other", "5"),
)

# Assumed: more than any surface has; far beyond it positions have no digits left.
_LARGEST = 1e6
# The series' terms: at pi, the farthest angle that is asked, the first that is left out is below 2^-60.
_TERMS = 17


def _bending(angle):
    """(sin a) / a - 1 and (1 - cos a) / a^2, by their series; ``angle`` within +-pi."""
    square = angle * angle
    sine, cosine = np.zeros_like(square), np.zeros_like(square)
    for k in range(_TERMS, 0, -1):
        sine = -square / (2 * k * (2 * k + 1)) * (1.0 + sine)
    for k in range(_TERMS, 0, -1):
        cosine = -square / ((2 * k + 1) * (2 * k + 2)) * (1.0 + cosine)
    return sine, 0.5 + 0.5 * cosine


def _angle(curvature, length):
    """The angle at the centre of curvature. Assumed: what is farther than half way round stands there."""
    return np.clip(curvature * length, -math.pi, math.pi)


@dataclass(frozen=True)
class Base:
    """How the surface below a height field is bent and stretched.

    curvature  kappa_u and kappa_v, in 1 / edge of the field's square; positive: convex
    stretch    s_x and s_y, factors; heights are not stretched

    Raises ValueError for numbers that are infinite, NaN or too large for any scene, and for a stretch that is
    not positive.
    """

    curvature: tuple[float, float] = (0.0, 0.0)
    stretch: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        for name, values in (("curvature", self.curvature), ("stretch", self.stretch)):
            if len(values) != 2 or not all(math.isfinite(v) for v in values):
                raise ValueError(f"The base's {name} is {values!r}; give two finite numbers.")
        if min(self.stretch) <= 0.0:
            raise ValueError(f"The base's stretch is {self.stretch!r}; give two positive numbers.")
        largest = max(*map(abs, self.curvature), *self.stretch, *(1.0 / s for s in self.stretch))
        if largest > _LARGEST:
            raise ValueError(
                f"The base has the curvature {self.curvature!r} and the stretch {self.stretch!r}; give "
                f"numbers of at most {_LARGEST:g}, and a stretch of no less than one over that."
            )

    def added(self, x, y, h):
        """The bent point minus (x, y, h), positions in the stretched base: float64 [..., 3]."""
        u, v = self.curvature
        s_u, c_u = _bending(_angle(u, x))
        s_v, c_v = _bending(_angle(v, y))
        along = x * (s_u + (1.0 + s_u) * (u * h))
        fallen = -u * x * x * c_u * (1.0 + u * h)
        z = h + fallen
        across = y * (s_v + (1.0 + s_v) * (v * z))
        return np.stack([along, across, fallen - v * y * y * c_v * (1.0 + v * z)], axis=-1)

    def placed(self, points):
        """Points [..., 3] of the flat field, relative to a point of the base, in the base's frame there:
        float64 [..., 3].
        """
        points = np.asarray(points, np.float64) * (*self.stretch, 1.0)
        return points + self.added(points[..., 0], points[..., 1], points[..., 2])

    def frames(self, x, y):
        """The base's tangents, binormals and normals at (x, y) [...] of the flat field, in the frame at
        (0, 0): three float64 [..., 3].
        """
        turns = []
        for curvature, length in zip(self.curvature, (self.stretch[0] * x, self.stretch[1] * y), strict=True):
            angle = _angle(curvature, np.asarray(length, np.float64))
            s, c = _bending(angle)
            turns += [angle * (1.0 + s), 1.0 - angle * angle * c]
        sin_a, cos_a, sin_b, cos_b = np.broadcast_arrays(*turns)
        return (
            np.stack([cos_a, -sin_a * sin_b, -sin_a * cos_b], axis=-1),
            np.stack([0.0 * sin_b, cos_b, -sin_b], axis=-1),
            np.stack([sin_a, cos_a * sin_b, cos_a * cos_b], axis=-1),
        )

    def local(self, vector, x, y):
        """One vector [3] of the frame at (0, 0), a distant light's direction for instance, in the frames at
        (x, y) [...]: float64 [..., 3].
        """
        return np.stack([dot(axis, vector) for axis in self.frames(x, y)], axis=-1)


@dataclass(frozen=True, eq=False)
class Bent:
    """The points that a field's texels see on a curved base.

    base        the Base
    directions  float64 [n, rows, columns, 3]: d_i(p), unit vectors in the frame of the base at p
    weights     float64 [n, rows, columns]: w_i(p), by how much each direction counts
    normals     float64 [rows, columns, 3], in the frame of the base at p
    triangles   int64 [k, 3]: between which three directions others lie, as on the flat base
    flat        float64 [n, 3], the directions on the flat base
    seen        int32 [n, rows, columns], as for Visibility
    far         float64 [n, rows, columns]: distance of the seen point on the flat base; infinity: nothing is
                seen; 0: the texel's own surface hides it
    """

    base: Base
    directions: NDArray[np.float64]
    weights: NDArray[np.float64]
    normals: NDArray[np.float64]
    triangles: NDArray[np.int64]
    flat: NDArray[np.float64]
    seen: NDArray[np.int32]
    far: NDArray[np.float64]


def bent_normals(field, base):
    """Normals of a HeightField on a Base, in the frame at their own texel: float64 [rows, columns, 3].

    Raises ValueError where the heights reach the base's centre of curvature.
    """
    for curvature in base.curvature:
        if float((1.0 + curvature * field.heights).min()) <= 0.0:
            raise ValueError(
                f"The base's curvature is {curvature:g}, and the field's heights reach its centre; give a "
                "curvature nearer to 0, or lower bumps."
            )
    if base == Base():
        return field.normals
    scales = [s * (1.0 + k * field.heights) for s, k in zip(base.stretch, base.curvature, strict=True)]
    n = field.normals
    return normalize(np.stack([n[..., 0] / scales[0], n[..., 1] / scales[1], n[..., 2]], axis=-1))


def moved(base, directions, far, heights):
    """Where directions turn to: float64 [m, ..., 3], unit vectors in the frames of the base at the texels.

    directions  float64 [m, 3], unit vectors
    far         float64 [m, ...]: how far away the point is that is seen; infinity: none
    heights     float64 [...], of the texels
    """
    d = directions.reshape(len(directions), *(1,) * heights.ndim, 3)
    stretched = d * (*base.stretch, 1.0)
    hit = np.isfinite(far) & (far > 0.0)
    t = np.where(hit, far, 0.0)
    added = base.added(t * stretched[..., 0], t * stretched[..., 1], heights + t * d[..., 2])
    out = stretched + added / np.where(hit, far, 1.0)[..., None]
    # A direction that has not moved keeps its bits.
    return np.where((out == d).all(axis=-1)[..., None], d, normalize(out))


def border_weights(base, directions, triangles, far, heights):
    """w_i of texels [k] whose borders move with the nearer point: float64 [n, k], of arrays [n, 3], [m, 3],
    [n, k] and [k].

    ``far`` is 0 where the texel's own surface hides what there is. What has folded over counts nothing.
    """
    a, b, c = (directions[triangles[:, k]] for k in range(3))
    away = [far[triangles[:, k]] for k in range(3)]
    nearest = np.minimum(np.minimum(away[0], away[1]), away[2])
    center = moved(base, normalize(cross(b - a, c - a)), nearest, heights)
    middles = [
        moved(base, normalize(one + other), np.minimum(away[k], away[(k + 1) % 3]), heights)
        for k, (one, other) in enumerate(((a, b), (b, c), (c, a)))
    ]
    corners = moved(base, directions, far, heights)
    areas = np.zeros(far.shape)
    for k in range(3):
        corner = corners[triangles[:, k]]
        part = sphere.solid_angles(corner, middles[k], center)
        np.add.at(areas, triangles[:, k], part + sphere.solid_angles(corner, center, middles[k - 1]))
    return np.maximum(areas, 0.0) / sphere.fan_areas(directions, triangles)[:, None]


def fan_weights(base, directions, triangles, far, heights):
    """w_i as in the paper, from the triangles round the moved directions; arrays as for ``border_weights``.

    If directions pass each other, the weights are useless: negative, or too large by the sphere's area.
    """
    corners = np.moveaxis(moved(base, directions, far, heights), 0, -2)
    return (sphere.fan_areas(corners, triangles) / sphere.fan_areas(directions, triangles)).T


def bend(field, visibility, base, weights=border_weights):
    """Directions, weights and normals of a HeightField with its Visibility on a Base: Bent.

    weights  ``border_weights`` or ``fan_weights``

    Raises ValueError if the heights reach the centre of curvature, and for directions that do not surround
    the origin (``directions.triangulated``).
    """
    normals = bent_normals(field, base)
    triangles = sphere.triangulated(visibility.directions)
    far = distances(field, visibility)
    directions = moved(base, visibility.directions, far, field.heights)
    hidden = np.where(visibility.seen == BACK, 0.0, far)
    counts = np.empty(visibility.seen.shape)
    # A row at a time, for the borders' arrays are large.
    for row in range(visibility.rows):
        counts[:, row] = weights(base, visibility.directions, triangles, hidden[:, row], field.heights[row])
    return Bent(base, directions, counts, normals, triangles, visibility.directions, visibility.seen, hidden)


def _directions_of(light):
    """Lights as float64 [..., 3]. Raises ValueError for another shape, NaN or infinity."""
    found = np.asarray(light, np.float64)
    if found.ndim < 1 or found.shape[-1] != 3 or not np.isfinite(found).all():
        raise ValueError(f"The light has shape {found.shape}; give finite unit vectors [..., 3].")
    return found


def free_share(field, bent, light):
    """How much of a distant light reaches each texel, by the three directions round it (G13): 0 to 1.

    The result is float64 [rows, columns].

    light  unit vector [3] or [rows, columns, 3] in the frames at the texels. For n lights [n, 1 or rows, 1 or
           columns, 3]; the result is then [n, rows, columns]

    A triangle moves as a whole, with the nearest of the points that its corners see. If several triangles
    hold the light, the one with the nearest point counts, because it hides the others' points. Raises
    ValueError for lights that are no finite [..., 3].
    """
    light = _directions_of(light)
    shape = np.broadcast_shapes(light.shape[:-1], bent.normals.shape[:2])
    inside, distance = np.full(shape, -np.inf), np.full(shape, np.inf)
    share = np.zeros(shape)
    free = bent.seen == FREE
    for triangle in bent.triangles:
        nearest = bent.far[triangle].min(axis=0)
        far = np.broadcast_to(nearest, (3, *nearest.shape))
        a, b, c = moved(bent.base, bent.flat[triangle], far, field.heights)
        volume = dot(a, cross(b, c))
        scale = np.where(volume > 0.0, volume, 1.0)
        parts = [dot(side, light) for side in (cross(b, c), cross(c, a), cross(a, b))]
        least = np.minimum(np.minimum(parts[0], parts[1]), parts[2])
        # The light is inside where no part is negative; near an edge all neighbours may miss it by rounding.
        least = np.where(volume > 0.0, np.minimum(least / scale, 0.0), -np.inf)
        positive = [np.maximum(part, 0.0) for part in parts]
        total = (positive[0] + positive[1]) + positive[2]
        better = (least > inside) | ((least == inside) & (nearest < distance))
        better &= total > 0.0
        if not better.any():
            continue
        seen = [part * free[k] for part, k in zip(positive, triangle, strict=True)]
        inside = np.where(better, least, inside)
        distance = np.where(better, nearest, distance)
        share = np.where(better, ((seen[0] + seen[1]) + seen[2]) / np.where(total > 0.0, total, 1.0), share)
    return share


def direct(field, bent, light, lit=None):
    """What texels send of a light of one along ``light``: albedo (n.l)+, float64 [rows, columns, 3].

    light  unit vector [3] or [rows, columns, 3] in the frames at the texels
    lit    float64 [rows, columns]: how much of it arrives; None: ``free_share``

    Raises ValueError for a light that is no finite [..., 3].
    """
    light = _directions_of(light)
    lit = free_share(field, bent, light) if lit is None else lit
    return field.albedo * (np.maximum(dot(bent.normals, light), 0.0) * lit)[..., None]


def gathered(field, bent, arriving):
    """One reflection of the light [rows, columns, 3] that texels send to each other: float64 [rows, columns,
    3]. Diffuse.
    """
    total = np.zeros(arriving.shape)
    for directions, weights, seen in zip(bent.directions, bent.weights, bent.seen, strict=True):
        cosine = np.maximum(dot(bent.normals, directions), 0.0) * weights
        total += cosine[..., None] * looked_up(arriving, seen)
    return field.albedo * (total * (WEIGHT / len(bent.seen)))


def bounces(field, bent, light, count, lit=None):
    """Direct light and ``count`` further reflections, as ``light_transport.bounces``: a list of float64
    [rows, columns, 3], the k-th with k of them. ``light`` and ``lit`` as for ``direct``.
    """
    arriving = direct(field, bent, light, lit)
    out = [arriving]
    for _ in range(count):
        arriving = gathered(field, bent, arriving)
        out.append(out[-1] + arriving)
    return out


def bent_surface(field, base, columns, rows, center=(0.5, 0.5)):
    """A piece of a HeightField on a Base as a mesh: vertices at texel centres, texture coordinates that
    repeat.

    columns, rows  first and last texel, (first, last), whole numbers of any sign
    center         the point of the field where the base's frame is the world's, in edges of the square
    """
    i, j = (np.arange(first, last + 1) for first, last in (columns, rows))
    j, i = np.meshgrid(j, i, indexing="ij")
    s, t = (i + 0.5) / field.columns, (j + 0.5) / field.rows
    x, y = s - center[0], t - center[1]
    at = j % field.rows, i % field.columns
    positions = base.placed(np.stack([x, y, field.heights[at]], axis=-1))
    normals = from_frame(bent_normals(field, base)[at], *base.frames(x, y))
    tangents = normalize(cross(base.frames(x, y)[1], normals))
    grid = plane(i.shape[1] - 1, i.shape[0] - 1)
    return replace(
        grid,
        positions=positions.reshape(-1, 3),
        normals=normals.reshape(-1, 3),
        tangents=tangents.reshape(-1, 3),
        binormals=cross(normals, tangents).reshape(-1, 3),
        texture_coordinates=np.stack([s, t], axis=-1).reshape(-1, 2),
    )
