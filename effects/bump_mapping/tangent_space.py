"""Z03, Z04 and Z27: tangent space from texture coordinates, at triangles and at vertices, and where it fails.

Z03. A triangle with texture coordinates is the affine map x(u, v) = M [u v 1]^T with x(u_i, v_i) = v_i at its
three corners, so

    M = [v_0 v_1 v_2] [u_0 u_1 u_2; v_0 v_1 v_2; 1 1 1]^-1

and t = dx/du and b = dx/dv are M's first two columns; n = t x b.

Z04. At a vertex, t and b are averaged over the triangles that share it. A mesh stores t, the normal and one
sign, and b is computed when needed, as sign * n x t. It points along b if the coordinates turn as the
triangle does, and against it if they are mirrored. (``triangle_meshes.from_triangles``, which makes tangents
for OBJ files, weights the mean by the triangles' areas instead.)

"No normalization necessary" (E003.2). With t and b unnormalized and n = t x b, the normal (-d_u, -d_v, 1) of
a map becomes -d_u t - d_v b + t x b. A surface that is really displaced by d along its normal n^ has the
normal

    (t + d_u n^) x (b + d_v n^) = t x b + d_u n^ x b + d_v t x n^

Both are equal if t and b have the same length and are at right angles. Otherwise the document's form divides
d_u by the length of b instead of t's. ``printed_normals`` and ``displaced_normals`` are the two forms. On a
surface stretched 2 to 1, slopes of .3 and -.2 come out as (-.3, .1) instead of (-.15, .2), 9.9 degrees off;
on one sheared by a half, the error is 9.1 degrees.

Frames of length one, which ``with_tangents`` makes, take slopes in the surface's own units. They are right
where u and v meet at right angles and the map was made for that stretch.

Z27. No tangent space exists where a triangle has no area in texture space. A mirrored triangle has its
binormal reversed. A stretch that differs along u and v makes bumps steeper along one of them. ``examine``
finds all three, with their amount; ``with_tangents`` refuses, drops, keeps or reverses them, as requested.

Source: Zwicker 2016, "Tangent space", "Storing tangent vectors" and "Caveats"; Blinn 1978 (the displaced
surface's normal); pass sequence A-Z03/Z04 of the catalogue; artefact Z27.
"""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("Z03", "a triangle's tangent space from its texture coordinates", "Tangent space"),
    Technique(
        "Z04", "tangents averaged at vertices, binormals computed when needed", "Storing tangent vectors"
    ),
    Technique("Z27", "triangles with no tangent space, mirrored or stretched: reported", "Caveats"),
)

# Twice the signed area of a texture-space triangle over its longest edge's square, below which it counts as
# none.  Assumed: 1e-9; an equilateral one has .87, and float32 coordinates of a mesh carry an error of 1e-7.
NO_AREA = 1e-9
# How many times steeper bumps may be along one direction than along another.  Assumed: 2, where the
# document's form tilts a normal by four times what it should, compared along the two.
LARGEST_STRETCH = 2.0


# ------------------------------------------------------------------------------------ Z03: one triangle


def _homogeneous(coordinates):
    return np.concatenate([coordinates, np.ones((*coordinates.shape[:-1], 1))], axis=-1)


def texture_areas(coordinates):
    """Twice the signed area of triangles in texture space, float64 [k]: the determinant of the constraints.

    ``coordinates``: float64 [k, 3 corners, 2]. Negative where the texture is mirrored.
    """
    d1, d2 = coordinates[:, 1] - coordinates[:, 0], coordinates[:, 2] - coordinates[:, 0]
    return d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1]


def affine_maps(points, coordinates):
    """M of each triangle: float64 [k, 3, 3], so that M [u v 1]^T is a point of the triangle's plane.

    points       float64 [k, 3 corners, 3]
    coordinates  float64 [k, 3 corners, 2]

    The inverse is the adjugate over the determinant, about the first corner, which keeps digits where
    coordinates are large. Raises ValueError, naming the triangles, where one has no area in texture space.
    """
    points, coordinates = np.asarray(points, np.float64), np.asarray(coordinates, np.float64)
    empty = np.flatnonzero(without_area(coordinates))
    if len(empty):
        raise ValueError(
            f"{_count(empty)} no area in texture space ({_listed(empty)}), so there is no x(u, v) for "
            "them; give other texture coordinates, or leave them out (with_tangents, ZeroArea.DROP)."
        )
    corner, area = coordinates[:, 0], texture_areas(coordinates)[:, None]
    d1, d2 = coordinates[:, 1] - corner, coordinates[:, 2] - corner
    e1, e2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    t = (e1 * d2[:, 1:] - e2 * d1[:, 1:]) / area
    b = (e2 * d1[:, :1] - e1 * d2[:, :1]) / area
    origin = points[:, 0] - (corner[:, :1] * t + corner[:, 1:] * b)
    return np.stack([t, b, origin], axis=-1)


def mapped(maps, coordinates):
    """x(u, v) of triangles' maps [k, 3, 3] at coordinates [k, m, 2]: float64 [k, m, 3]."""
    place = _homogeneous(np.asarray(coordinates, np.float64))
    return np.stack([dot(place, maps[:, None, axis]) for axis in range(3)], axis=-1)


def frames(maps):
    """(t, b, n) of affine maps: M's first two columns and t x b, each float64 [k, 3], not normalized."""
    t, b = maps[..., 0], maps[..., 1]
    return t, b, cross(t, b)


# ------------------------------------------------------------------------------------ E003.2: two normals


def printed_normals(t, b, d_u, d_v):
    """The document's normal in object space, [t b t x b] (-d_u, -d_v, 1), of length one: float64 [..., 3].

    ``t``, ``b``: [..., 3], of any length and at any angle; ``d_u``, ``d_v``: the displacement's derivatives,
    in the unit of t and b.
    """
    d_u, d_v = np.asarray(d_u, np.float64)[..., None], np.asarray(d_v, np.float64)[..., None]
    return normalize((cross(t, b) - d_u * t) - d_v * b)


def displaced_normals(t, b, d_u, d_v):
    """The normal of the surface displaced along its normal, Blinn's: arguments as for ``printed_normals``."""
    d_u, d_v = np.asarray(d_u, np.float64)[..., None], np.asarray(d_v, np.float64)[..., None]
    area = cross(t, b)
    normal = normalize(area)
    return normalize((area + d_u * cross(normal, b)) + d_v * cross(t, normal))


# ----------------------------------------------------------------------------------- Z27: where it fails


def without_area(coordinates):
    """Which triangles have no area in texture space, bool [k]; ``coordinates``: float64 [k, 3, 2]."""
    edges = coordinates - np.roll(coordinates, 1, axis=1)
    longest = (edges[..., 0] * edges[..., 0] + edges[..., 1] * edges[..., 1]).max(axis=1)
    return ~(np.abs(texture_areas(coordinates)) > NO_AREA * longest)


def stretches(t, b):
    """The longest step over the shortest one that a unit step in texture space makes, float64 [k].

    It is one if u and v are neither stretched nor sheared, and infinite if all steps in one direction have
    length zero. It is the ratio of the singular values of [t b].
    """
    tt, bb, tb = dot(t, t), dot(b, b), dot(t, b)
    half, apart = (tt + bb) / 2.0, (tt - bb) / 2.0
    root = np.sqrt(apart * apart + tb * tb)
    least = half - root
    some = least > 1e-15 * half
    return np.where(some, np.sqrt((half + root) / np.where(some, least, 1.0)), np.inf)


def _count(indices):
    return "1 triangle has" if len(indices) == 1 else f"{len(indices)} triangles have"


def _listed(indices, most=5):
    numbers = ", ".join(map(str, indices[:most].tolist()))
    return f"number{'s' * (len(indices) > 1)} {numbers}" + ", ..." * (len(indices) > most)


@dataclass(frozen=True, eq=False)
class Report:
    """What is wrong with a mesh's texture coordinates, by triangle (Z27).

    areas      float64 [k]: twice the signed area in texture space
    stretch    float64 [k]: ``stretches``; infinite where there is no area
    zero_area, mirrored, stretched int64: numbers of the triangles with no area, with a negative one, and with
    a stretch above ``largest_stretch``, ascending; a triangle without area is in none of the other lists
    """

    areas: np.ndarray
    stretch: np.ndarray
    zero_area: np.ndarray
    mirrored: np.ndarray
    stretched: np.ndarray
    largest_stretch: float

    @property
    def clean(self):
        """Whether nothing was found."""
        return not (len(self.zero_area) or len(self.mirrored) or len(self.stretched))

    def text(self):
        """What was found, in a sentence for each."""
        out = []
        if len(self.zero_area):
            out.append(
                f"{_count(self.zero_area)} no area in texture space and no tangent space "
                f"({_listed(self.zero_area)})."
            )
        if len(self.mirrored):
            out.append(
                f"{_count(self.mirrored)} mirrored texture coordinates ({_listed(self.mirrored)}): "
                "the binormal turns round."
            )
        if len(self.stretched):
            worst = self.stretched[np.argmax(self.stretch[self.stretched])]
            out.append(
                f"{_count(self.stretched)} texture coordinates stretched more than {self.largest_stretch:g} "
                f"times in one direction ({_listed(self.stretched)}), at most "
                f"{self.stretch[worst]:.3g} times, number {worst}: bumps are too steep or too flat there."
            )
        return " ".join(out) or "Every triangle has a tangent space without mirroring or stretch."


def examine(points, coordinates, largest_stretch=LARGEST_STRETCH):
    """The Report on triangles: ``points`` float64 [k, 3, 3], ``coordinates`` float64 [k, 3, 2]."""
    points, coordinates = np.asarray(points, np.float64), np.asarray(coordinates, np.float64)
    areas, empty = texture_areas(coordinates), without_area(coordinates)
    stretch = np.full(len(points), np.inf)
    if not empty.all():
        t, b, _ = frames(affine_maps(points[~empty], coordinates[~empty]))
        stretch[~empty] = stretches(t, b)
    return Report(
        np.where(empty, 0.0, areas),
        stretch,
        np.flatnonzero(empty),
        np.flatnonzero(~empty & (areas < 0.0)),
        np.flatnonzero(~empty & (stretch > largest_stretch)),
        float(largest_stretch),
    )


def examine_surface(surface, largest_stretch=LARGEST_STRETCH):
    """The Report on a ``Surface``'s triangles."""
    return examine(*_corners(surface), largest_stretch)


# ----------------------------------------------------------------------------------- Z04: at the vertices


def _corners(surface):
    return surface.positions[surface.triangles], surface.texture_coordinates[surface.triangles]


def binormals(normals, tangents, signs):
    """The binormals on the fly: ``signs`` * n x t, float64 [n, 3]."""
    return signs[:, None] * cross(normals, tangents)


def _averaged(surface, which, vectors):
    """The mean of triangles' vectors [k, 3] at each vertex: float64 [n, 3], zero where no triangle is."""
    total, count = np.zeros(surface.positions.shape), np.zeros(len(surface.positions))
    corners = surface.triangles[which].ravel()
    np.add.at(total, corners, np.repeat(vectors, 3, axis=0))
    np.add.at(count, corners, 1.0)
    return total / np.maximum(count, 1.0)[:, None]


def vertex_tangents(surface):
    """What Z04 stores beside the normal: (t float64 [n, 3], sign float64 [n]).

    t is the mean of the triangles' tangents at each vertex, made perpendicular to the normal and of length
    one. The sign is 1, or -1 if the mean binormal lies on the other side of n x t. Triangles without an area
    in texture space are left out; a vertex with only such triangles keeps the surface's own tangent.
    """
    points, coordinates = _corners(surface)
    kept = ~without_area(coordinates)
    t, b, _ = frames(affine_maps(points[kept], coordinates[kept]))
    t, b = _averaged(surface, kept, t), _averaged(surface, kept, b)
    tangents = normalize(t - dot(t, surface.normals)[:, None] * surface.normals)
    there = dot(tangents, tangents) > 0.5
    tangents = np.where(there[:, None], tangents, surface.tangents)
    across = np.where(there[:, None], b, surface.binormals)
    return tangents, np.where(dot(cross(surface.normals, tangents), across) < 0.0, -1.0, 1.0)


class ZeroArea(StrEnum):
    """How to handle triangles without an area in texture space."""

    REFUSE = "refuse"  # ValueError
    DROP = "drop"  # a hole
    KEEP = "keep"  # with what their vertices have of other triangles


class Mirrored(StrEnum):
    """How to handle triangles with mirrored texture coordinates."""

    SIGN = "sign"  # they stay, and the sign of the binormal says so
    DROP = "drop"
    MIRROR = "mirror"  # mirrored back, each about the middle of its u, so that its bumps run the other way
    REFUSE = "refuse"  # ValueError


def with_tangents(surface, zero_area=ZeroArea.REFUSE, mirrored=Mirrored.SIGN):
    """A surface with the tangents and binormals that its texture coordinates give (Z03, Z04, Z27).

    Parameters
    ----------
    surface
        A ``surfaces.Surface``; positions, normals, texture coordinates and triangles are taken.
    zero_area
        How to handle triangles without an area in texture space.
    mirrored
        How to handle mirrored triangles. Vertices that a mirrored and another triangle share become two.

    Raises ValueError for anything else, and if it refuses, with the Report's sentence.
    """
    member_of(ZeroArea, zero_area, "What becomes of triangles without area")
    member_of(Mirrored, mirrored, "What becomes of mirrored triangles")
    report = examine_surface(surface)
    refused = [
        *(report.zero_area if zero_area is ZeroArea.REFUSE else ()),
        *(report.mirrored if mirrored is Mirrored.REFUSE else ()),
    ]
    if refused:
        raise ValueError(
            f"{report.text()} Give other texture coordinates, or ZeroArea.DROP and Mirrored.SIGN."
        )
    keep, turned = np.ones(len(surface.triangles), bool), np.zeros(len(surface.triangles), bool)
    turned[report.mirrored] = True
    keep[report.zero_area] = zero_area is not ZeroArea.DROP
    keep[report.mirrored] &= mirrored is not Mirrored.DROP
    if not keep.any():
        raise ValueError(f"{report.text()} Nothing is left to draw; give other texture coordinates.")
    surface, turned = replace(surface, triangles=surface.triangles[keep]), turned[keep]
    if turned.any():
        surface = _split(surface, turned)
        if mirrored is Mirrored.MIRROR:
            surface = _mirrored_back(surface, turned)
    tangents, signs = vertex_tangents(surface)
    return replace(surface, tangents=tangents, binormals=binormals(surface.normals, tangents, signs))


def _taken(surface, vertices, triangles):
    """The surface of some of its vertices, in their order, with other triangles."""
    arrays = ("positions", "normals", "tangents", "binormals", "texture_coordinates")
    return replace(
        surface, triangles=triangles, **{name: getattr(surface, name)[vertices] for name in arrays}
    )


def _split(surface, turned):
    """The surface with no vertex of both kinds of triangles."""
    corners = np.stack([surface.triangles, np.repeat(turned[:, None], 3, axis=1)], axis=-1).reshape(-1, 2)
    vertices, at = np.unique(corners, axis=0, return_inverse=True)
    return _taken(surface, vertices[:, 0], at.reshape(-1, 3))


def _mirrored_back(surface, turned):
    """The surface with each mirrored triangle's u turned round about its middle."""
    corners, first = surface.triangles[turned], len(surface.positions)
    u = surface.texture_coordinates[corners, 0]
    about = u.min(axis=1, keepdims=True) + u.max(axis=1, keepdims=True)
    triangles = surface.triangles.copy()
    triangles[turned] = first + np.arange(corners.size).reshape(-1, 3)
    out = _taken(surface, np.concatenate([np.arange(first), corners.ravel()]), triangles)
    out.texture_coordinates[first:, 0] = (about - u).ravel()
    used, at = np.unique(triangles, return_inverse=True)
    return _taken(out, used, at.reshape(-1, 3))
