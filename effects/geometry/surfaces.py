"""Surfaces with local frames: plane, disc, sphere, torus, box, turned shapes, and several joined.

A surface has the data from which an effect computes vectors per vertex; ``Surface.mesh`` turns it into the
pipeline's vertex arrays. Texture coordinates grow along the tangent (s) and, on right-handed surfaces, along
the binormal (t).
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.vectors import cosine, cross, in_frame, normalize, of_40_bits, sine
from fixedpipe.pipeline.commands import Mesh


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles with a frame and texture coordinates per vertex.

    positions            float64 [n, 3], world coordinates
    normals, tangents, binormals
                         float64 [n, 3], orthonormal: the material's local frame at the vertex
    texture_coordinates  float64 [n, 2]
    triangles            int64 [k, 3], counter-clockwise seen from outside
    """

    positions: NDArray[np.float64]
    normals: NDArray[np.float64]
    tangents: NDArray[np.float64]
    binormals: NDArray[np.float64]
    texture_coordinates: NDArray[np.float64]
    triangles: NDArray[np.int64]

    def mesh(
        self,
        *coordinates: ArrayLike,
        colors: ArrayLike | None = None,
        secondary_colors: ArrayLike | None = None,
    ) -> Mesh:
        """Vertex arrays with the given texture coordinate sets (default: the surface's own), vertex colours
        and secondary colours.
        """
        return Mesh(
            positions=self.positions,
            indices=self.triangles.ravel(),
            colors=colors,
            secondary_colors=secondary_colors,
            normals=self.normals,
            texture_coordinates=coordinates or (self.texture_coordinates,),
        )

    def to_local(self, vectors: ArrayLike) -> NDArray[np.float64]:
        """World vectors [n, 3] (or one [3]) in the vertices' local frames: float64 [n, 3]."""
        return in_frame(
            np.broadcast_to(vectors, self.positions.shape), self.tangents, self.binormals, self.normals
        )

    def rotated(self, matrix: NDArray[np.float64]) -> "Surface":
        """The surface turned by a 3x3 rotation about the origin."""
        turned = {
            name: rotate(matrix, getattr(self, name))
            for name in ("positions", "normals", "tangents", "binormals")
        }
        return replace(self, **turned)

    def moved(self, x: float, y: float, z: float) -> "Surface":
        """The surface moved by (x, y, z)."""
        return replace(self, positions=self.positions + np.array([float(x), float(y), float(z)]))

    def scaled(self, factor: float) -> "Surface":
        """The surface ``factor`` times as large about the origin, ``factor`` positive."""
        if not 0.0 < factor < math.inf:
            raise ValueError(f"A surface is scaled by {factor!r}; give a positive number.")
        return replace(self, positions=self.positions * float(factor))

    def with_repeats(self, s: float, t: float) -> "Surface":
        """The surface with its texture coordinates multiplied: the material repeats s by t times."""
        return replace(self, texture_coordinates=self.texture_coordinates * np.array([float(s), float(t)]))


def _grid_triangles(columns, rows):
    """Two triangles per cell of a grid of (columns + 1) x (rows + 1) vertices, row by row."""
    i = np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)[None, :]
    a, b, c, d = i, i + 1, i + columns + 2, i + columns + 1
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _check_count(value, least, what):
    if value < least:
        raise ValueError(f"{what} is {value}; give at least {least}.")


def plane(columns: int = 1, rows: int = 1, half_width: float = 1.0, half_height: float = 1.0) -> Surface:
    """A rectangle in z = 0 that faces +z; t = +x, b = +y; texture coordinates 0..1."""
    _check_count(columns, 1, "The plane's number of columns")
    _check_count(rows, 1, "The plane's number of rows")
    grid = np.meshgrid(np.arange(columns + 1) / columns, np.arange(rows + 1) / rows)
    s, t = (coordinate.ravel() for coordinate in grid)
    positions = np.stack([(2.0 * s - 1.0) * half_width, (2.0 * t - 1.0) * half_height, 0.0 * s], axis=-1)
    x, y, z = (np.tile(row, (len(s), 1)) for row in np.eye(3))
    return Surface(positions, z, x, y, np.stack([s, t], axis=-1), _grid_triangles(columns, rows))


def disc(slices: int = 64, hole: float = 0.0) -> Surface:
    """A flat disc of radius one in z = 0 that faces +z, with a round ``hole`` of that radius in the middle.

    The tangents lie along circles, counter-clockwise; the binormals point to the middle. s runs round, 1/2 at
    -x. t is one at the rim and falls linearly to zero at the hole. Without a hole every slice has its own
    vertex in the middle, with the frame of the slice's middle.

    Raises ValueError if the hole's radius is not from 0 to less than 1.
    """
    _check_count(slices, 3, "The disc's number of slices")
    if not 0.0 <= hole < 1.0:
        raise ValueError(f"The hole's radius is {hole!r}; give one from 0 to less than the disc's, 1.")
    edge, middle = np.arange(slices + 1) / slices, (np.arange(slices) + 0.5) / slices
    inner = edge if hole > 0.0 else middle
    s = np.concatenate([edge, inner])
    radius = np.concatenate([np.ones(slices + 1), np.full(len(inner), float(hole))])
    t = (1.0 - radius) / (1.0 - hole)
    # The last vertex of a circle stands where its first does.
    angle = 2.0 * math.pi * (np.where(s == 1.0, 0.0, s) - 0.5)
    x, y, zero = cosine(angle), sine(angle), 0.0 * s
    outward = np.stack([x, y, zero], axis=-1)
    normals = np.stack([zero, zero, zero + 1.0], axis=-1)
    tangents = np.stack([-y, x, zero], axis=-1)
    if hole > 0.0:
        # Columns run from the rim inward, so that triangles are counter-clockwise seen from +z.
        triangles = _grid_triangles(slices, 1)
    else:
        i = np.arange(slices)
        triangles = np.stack([i, i + 1, slices + 1 + i], axis=-1)
    return Surface(
        radius[:, None] * outward, normals, tangents, -outward, np.stack([s, t], axis=-1), triangles
    )


def sphere_frames(
    s: NDArray[np.float64], t: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Normal, tangent and binormal of the unit sphere at texture coordinates (s, t): three float64 [...,
    3].
    """
    longitude, latitude = 2.0 * math.pi * (s - 0.5), math.pi * (t - 0.5)
    sin_lon, cos_lon, sin_lat, cos_lat = sine(longitude), cosine(longitude), sine(latitude), cosine(latitude)
    normals = np.stack([cos_lat * sin_lon, sin_lat, cos_lat * cos_lon], axis=-1)
    tangents = np.stack([cos_lon, 0.0 * s, -sin_lon], axis=-1)
    binormals = np.stack([-sin_lat * sin_lon, cos_lat, -sin_lat * cos_lon], axis=-1)
    return normals, tangents, binormals


def sphere(slices: int = 50, stacks: int = 26) -> Surface:
    """The unit sphere with its poles on the y axis: 2 slices (stacks - 1) triangles, none degenerate.

    s runs eastward and is 1/2 where the sphere faces +z; t runs from the south to the north pole. The
    tangents lie along the parallels, the binormals along the meridians. At a pole every slice has a vertex
    of its own.
    50 slices and 26 stacks make the 2500 triangles of the paper's figure 4.
    """
    _check_count(slices, 3, "The sphere's number of slices")
    _check_count(stacks, 2, "The sphere's number of stacks")
    middle, edge = (np.arange(slices) + 0.5) / slices, np.arange(slices + 1) / slices
    s = np.concatenate([middle, np.tile(edge, stacks - 1), middle])
    parallels = np.repeat(np.arange(1, stacks) / stacks, slices + 1)
    t = np.concatenate([np.zeros(slices), parallels, np.ones(slices)])
    normals, tangents, binormals = sphere_frames(s, t)
    i = np.arange(slices)
    lowest, highest = slices + i, slices + (stacks - 2) * (slices + 1) + i
    triangles = [np.stack([i, lowest + 1, lowest], axis=-1)]
    if stacks > 2:
        triangles.append(_grid_triangles(slices, stacks - 2) + slices)
    north_pole = slices + (stacks - 1) * (slices + 1) + i
    triangles.append(np.stack([highest, highest + 1, north_pole], axis=-1))
    return Surface(
        normals, normals, tangents, binormals, np.stack([s, t], axis=-1), np.concatenate(triangles)
    )


# Of a part of the tube that faces a point, or is turned away, the least half: the cosine of 26 degrees. Where
# a tube has less, or no silhouette at all, its segments are no narrower.
_NARROWEST = 0.9


def _from_silhouette(shares, outwards, up, tube_radius):
    """Angles round the tube, of vertices at ``shares`` of it, 0 to 1, so that 0 and 1/2 are the silhouette
    from a point: outwards from the tube's centre, and up, both in the tube's own plane.

    A normal at the angle a from the way to the point is at right angles to what is seen there where cos a is
    the tube's radius over the point's distance.
    """
    towards = of_40_bits(np.arctan2(np.broadcast_to(up, outwards.shape), outwards))
    distance = np.sqrt(outwards * outwards + up * up)
    half = of_40_bits(np.arccos(np.minimum(tube_radius / np.maximum(distance, tube_radius), _NARROWEST)))
    facing = towards + half * (4.0 * shares - 1.0)
    turned_away = towards + half + (math.pi - half) * (4.0 * shares - 2.0)
    return np.where(shares <= 0.5, facing, turned_away)


def torus(
    around: int = 64,
    across: int = 32,
    radius: float = 0.7,
    tube_radius: float = 0.3,
    seen_from: tuple[float, float, float] | None = None,
) -> Surface:
    """A torus about the y axis: 2 around across triangles; s runs round the axis, t round the tube.

    radius     of the circle of tube centres; s = 1/2 faces +z, and t = 1/2 is the outer equator
    seen_from  a point, for instance a light. The silhouette that it sees lies along edges of the mesh, so
               that it has no zigzag. Half of the ``across`` segments, an even number, face the point. If the
               point is so low that its rays run along the silhouette somewhere, a zigzag stays there. t goes
               from any number to one more. None: segments of one size, and t from 0 to 1.

    Raises ValueError for counts or radii that give no torus.
    """
    _check_count(around, 3, "The torus's number of segments around the axis")
    _check_count(across, 3, "The torus's number of segments across the tube")
    if not 0.0 < tube_radius < radius:
        raise ValueError(
            f"The tube's radius is {tube_radius}; give one between 0 and the torus's radius, {radius}."
        )
    grid = np.meshgrid(np.arange(around + 1) / around, np.arange(across + 1) / across)
    s, t = (coordinate.ravel() for coordinate in grid)
    longitude, angle = 2.0 * math.pi * (s - 0.5), 2.0 * math.pi * (t - 0.5)
    sin_lon, cos_lon = sine(longitude), cosine(longitude)
    if seen_from is not None:
        if across % 2:
            raise ValueError(f"The torus has {across} segments across the tube; give an even number.")
        outwards = seen_from[0] * sin_lon + seen_from[2] * cos_lon - radius
        # The last row of vertices is the first, a turn farther on.
        angle = _from_silhouette(t % 1.0, outwards, seen_from[1], tube_radius)
        t = angle / (2.0 * math.pi) + 0.5 + np.floor(t)
    sin_a, cos_a = sine(angle), cosine(angle)
    normals = np.stack([cos_a * sin_lon, sin_a, cos_a * cos_lon], axis=-1)
    tangents = np.stack([cos_lon, 0.0 * s, -sin_lon], axis=-1)
    binormals = np.stack([-sin_a * sin_lon, cos_a, -sin_a * cos_lon], axis=-1)
    ring = np.stack([sin_lon, 0.0 * s, cos_lon], axis=-1)
    positions = radius * ring + tube_radius * normals
    return Surface(
        positions, normals, tangents, binormals, np.stack([s, t], axis=-1), _grid_triangles(around, across)
    )


def box(width: float = 1.0, height: float = 1.0, depth: float = 1.0) -> Surface:
    """A closed box about the origin, its faces flat: 12 triangles; texture coordinates 0..1 on each face.

    Raises ValueError if an edge is not positive.
    """
    half = np.array([width, height, depth], np.float64) / 2.0
    if not ((half > 0.0) & np.isfinite(half)).all():
        raise ValueError(f"A box of {width} x {height} x {depth} has no volume; give positive edges.")
    square = plane()
    faces = []
    for k in range(3):
        for sign in (1.0, -1.0):
            normal, tangent, binormal = np.zeros(3), np.zeros(3), np.zeros(3)
            normal[k], tangent[(k + 1) % 3], binormal[(k + 2) % 3] = sign, sign, 1.0
            place = square.positions[:, :1] * tangent + square.positions[:, 1:2] * binormal + normal
            faces.append((place * half, *(np.tile(axis, (4, 1)) for axis in (normal, tangent, binormal))))
    positions, normals, tangents, binormals = (np.concatenate(parts) for parts in zip(*faces, strict=True))
    triangles = np.concatenate([square.triangles + 4 * i for i in range(6)])
    return Surface(
        positions, normals, tangents, binormals, np.tile(square.texture_coordinates, (6, 1)), triangles
    )


# Assumed: edges of a turned shape that bend by more than this many degrees are meant to be sharp.
_CREASE = 40.0


def lathe(profile: ArrayLike, segments: int = 32) -> Surface:
    """A closed surface turned about the y axis from a profile of (radius, height), from the lowest point on
    the axis to the highest: radius 0 at both ends, positive between.

    Edges that bend by more than 40 degrees stay sharp. s runs round the axis and is 1/2 where the surface
    faces +z, t runs along the profile. 2 segments (points - 2) triangles. Raises ValueError for any other
    profile.
    """
    _check_count(segments, 3, "The number of segments of a turned surface")
    points = np.asarray(profile, np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3 or not np.isfinite(points).all():
        raise ValueError("A profile is three or more points (radius, height), all finite.")
    if points[0, 0] != 0.0 or points[-1, 0] != 0.0 or not (points[1:-1, 0] > 0.0).all():
        raise ValueError("A profile begins and ends on the axis, radius 0, and is off it between.")
    along = points[1:] - points[:-1]
    length = np.sqrt(along[:, 0] * along[:, 0] + along[:, 1] * along[:, 1])
    if not (length > 0.0).all():
        raise ValueError("Two points of a profile that follow each other are the same; leave one out.")
    # Outward from each piece of the profile, as (away from the axis, up).
    outward = np.stack([along[:, 1], -along[:, 0]], axis=-1) / length[:, None]
    bend = outward[1:, 0] * outward[:-1, 0] + outward[1:, 1] * outward[:-1, 1]
    smooth = bend >= float(cosine(math.radians(_CREASE)))
    first, last = outward.copy(), outward.copy()
    first[1:][smooth] = last[:-1][smooth] = (outward[1:] + outward[:-1])[smooth]

    # Corner k of the round has the same position in every piece and on both sides of the seam.
    turn = np.arange(segments + 1)
    longitude = 2.0 * math.pi * (turn % segments / segments - 0.5)
    ring = np.stack([sine(longitude), 0.0 * longitude, cosine(longitude)], axis=-1)
    tangent = np.stack([cosine(longitude), 0.0 * longitude, -sine(longitude)], axis=-1)
    up = np.array([0.0, 1.0, 0.0])
    distance = np.concatenate([[0.0], np.cumsum(length)]) / length.sum()
    rows = []
    for i in range(len(along)):
        for k, normal in ((i, first[i]), (i + 1, last[i])):
            normals = normalize(normal[0] * ring + normal[1] * up)
            coordinates = np.stack([turn / segments, np.full(segments + 1, distance[k])], axis=-1)
            rows.append((points[k, 0] * ring + points[k, 1] * up, normals, tangent, coordinates))
    positions, normals, tangents, coordinates = (np.concatenate(part) for part in zip(*rows, strict=True))
    pieces = []
    for i in range(len(along)):
        quads = _grid_triangles(segments, 1).reshape(-1, 2, 3) + 2 * i * (segments + 1)
        # A quad at the axis is one triangle: the other has no area.
        pieces += (
            [quads[:, 1]] if i == 0 else [quads[:, 0]] if i == len(along) - 1 else [quads.reshape(-1, 3)]
        )
    return Surface(
        positions, normals, tangents, cross(normals, tangents), coordinates, np.concatenate(pieces)
    )


def joined(*surfaces: Surface) -> Surface:
    """Several surfaces as one, their triangles in the order given. Raises ValueError where there is none."""
    _check_count(len(surfaces), 1, "The number of surfaces to join")
    starts = np.cumsum([0, *(len(surface.positions) for surface in surfaces[:-1])])
    arrays = {
        name: np.concatenate([getattr(surface, name) for surface in surfaces])
        for name in ("positions", "normals", "tangents", "binormals", "texture_coordinates")
    }
    triangles = [surface.triangles + start for surface, start in zip(surfaces, starts, strict=True)]
    return Surface(**arrays, triangles=np.concatenate(triangles))
