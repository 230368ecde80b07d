"""Surfaces with local frames: plane, sphere, torus, and triangles from OBJ files.

A surface is what an effect needs to compute vectors per vertex; ``Surface.mesh`` makes the pipeline's vertex
arrays of it. Texture coordinates grow along the tangent (s) and, on right-handed surfaces, along the
binormal (t).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.vectors import cosine, cross, dot, in_frame, normalize, sine
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

    positions: np.ndarray
    normals: np.ndarray
    tangents: np.ndarray
    binormals: np.ndarray
    texture_coordinates: np.ndarray
    triangles: np.ndarray

    def mesh(self, *coordinates, colors=None, secondary_colors=None):
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

    def to_local(self, vectors):
        """World vectors [n, 3] (or one [3]) in the vertices' local frames: float64 [n, 3]."""
        return in_frame(
            np.broadcast_to(vectors, self.positions.shape), self.tangents, self.binormals, self.normals
        )

    def rotated(self, matrix):
        """The surface turned by a 3x3 rotation about the origin."""
        turned = {
            name: rotate(matrix, getattr(self, name))
            for name in ("positions", "normals", "tangents", "binormals")
        }
        return replace(self, **turned)

    def moved(self, x, y, z):
        """The surface moved by (x, y, z)."""
        return replace(self, positions=self.positions + np.array([float(x), float(y), float(z)]))

    def scaled(self, factor):
        """The surface ``factor`` times as large about the origin, ``factor`` positive."""
        if not 0.0 < factor < math.inf:
            raise ValueError(f"A surface is scaled by {factor!r}; give a positive number.")
        return replace(self, positions=self.positions * float(factor))

    def with_repeats(self, s, t):
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


def plane(columns=1, rows=1, half_width=1.0, half_height=1.0):
    """A rectangle in z = 0 that faces +z; t = +x, b = +y; texture coordinates 0..1."""
    _check_count(columns, 1, "The plane's number of columns")
    _check_count(rows, 1, "The plane's number of rows")
    s, t = np.meshgrid(np.arange(columns + 1) / columns, np.arange(rows + 1) / rows)
    s, t = s.ravel(), t.ravel()
    positions = np.stack([(2.0 * s - 1.0) * half_width, (2.0 * t - 1.0) * half_height, 0.0 * s], axis=-1)
    x, y, z = (np.tile(row, (len(s), 1)) for row in np.eye(3))
    return Surface(positions, z, x, y, np.stack([s, t], axis=-1), _grid_triangles(columns, rows))


def sphere_frames(s, t):
    """Normal, tangent and binormal of the unit sphere at texture coordinates (s, t): three float64 [...,
    3].
    """
    longitude, latitude = 2.0 * math.pi * (s - 0.5), math.pi * (t - 0.5)
    sin_lon, cos_lon, sin_lat, cos_lat = sine(longitude), cosine(longitude), sine(latitude), cosine(latitude)
    normals = np.stack([cos_lat * sin_lon, sin_lat, cos_lat * cos_lon], axis=-1)
    tangents = np.stack([cos_lon, 0.0 * s, -sin_lon], axis=-1)
    binormals = np.stack([-sin_lat * sin_lon, cos_lat, -sin_lat * cos_lon], axis=-1)
    return normals, tangents, binormals


def sphere(slices=50, stacks=26):
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


def torus(around=64, across=32, radius=0.7, tube_radius=0.3):
    """A torus about the y axis: 2 around across triangles; s runs round the axis, t round the tube.

    ``radius``: of the circle of tube centres. s = 1/2 faces +z; t = 1/2 is the outer equator.
    """
    _check_count(around, 3, "The torus's number of segments around the axis")
    _check_count(across, 3, "The torus's number of segments across the tube")
    if not 0.0 < tube_radius < radius:
        raise ValueError(
            f"The tube's radius is {tube_radius}; give one between 0 and the torus's radius, {radius}."
        )
    s, t = np.meshgrid(np.arange(around + 1) / around, np.arange(across + 1) / across)
    s, t = s.ravel(), t.ravel()
    longitude, angle = 2.0 * math.pi * (s - 0.5), 2.0 * math.pi * (t - 0.5)
    sin_lon, cos_lon, sin_a, cos_a = sine(longitude), cosine(longitude), sine(angle), cosine(angle)
    normals = np.stack([cos_a * sin_lon, sin_a, cos_a * cos_lon], axis=-1)
    tangents = np.stack([cos_lon, 0.0 * s, -sin_lon], axis=-1)
    binormals = np.stack([-sin_a * sin_lon, cos_a, -sin_a * cos_lon], axis=-1)
    ring = np.stack([sin_lon, 0.0 * s, cos_lon], axis=-1)
    positions = radius * ring + tube_radius * normals
    return Surface(
        positions, normals, tangents, binormals, np.stack([s, t], axis=-1), _grid_triangles(around, across)
    )


def box(width=1.0, height=1.0, depth=1.0):
    """A closed box about the origin, its faces flat: 12 triangles; texture coordinates 0..1 on each face.

    Raises ValueError where an edge is not positive.
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


def lathe(profile, segments=32):
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


def joined(*surfaces):
    """Several surfaces as one, their triangles in the order given. Raises ValueError where there is none."""
    _check_count(len(surfaces), 1, "The number of surfaces to join")
    starts = np.cumsum([0, *(len(surface.positions) for surface in surfaces[:-1])])
    arrays = (
        np.concatenate([getattr(surface, name) for surface in surfaces])
        for name in ("positions", "normals", "tangents", "binormals", "texture_coordinates")
    )
    triangles = [surface.triangles + start for surface, start in zip(surfaces, starts, strict=True)]
    return Surface(*arrays, np.concatenate(triangles))


# Assumed: no mesh is larger; the fourth power of a length, by which areas are compared, stays in float64.
LARGEST = 1e30


def _obj_floats(fields, least, most, where, what):
    if not least <= len(fields):
        raise ValueError(f"{where}: {what} needs at least {least} numbers, found {len(fields)}.")
    try:
        values = [float(f) for f in fields[:most]]
    except ValueError:
        raise ValueError(f"{where}: {what} must be numbers, found {' '.join(fields)!r}.") from None
    if not all(abs(v) <= LARGEST for v in values):
        raise ValueError(
            f"{where}: {what} must be finite numbers of at most {LARGEST:g}, found {' '.join(fields)!r}."
        )
    return values


def _obj_corner(text, counts, where):
    """One "v/vt/vn" of a face as zero-based indices; -1 for what is missing."""
    parts = text.split("/")
    if len(parts) > 3 or not parts[0]:
        raise ValueError(f"{where}: a face corner is {text!r}; write it v, v/vt, v//vn or v/vt/vn.")
    corner = []
    for part, count, what in zip(
        (*parts, "", "")[:3], counts, ("vertex", "texture coordinate", "normal"), strict=True
    ):
        if not part:
            corner.append(-1)
            continue
        try:
            index = int(part)
        except ValueError:
            raise ValueError(
                f"{where}: a face corner is {text!r}; its indices must be whole numbers."
            ) from None
        zero_based = index - 1 if index > 0 else count + index
        if index == 0 or not 0 <= zero_based < count:
            raise ValueError(f"{where}: {what} index {index} does not exist; there are {count} so far.")
        corner.append(zero_based)
    return tuple(corner)


# Assumed: no concave face has more corners; cutting it up takes the cube of them.
_MOST_CORNERS = 200


def _cut_up(points, where):
    """Triangles, as numbers of three corners, of a polygon [n][3]: a fan round the first corner, and ears cut
    off where that would turn triangles over. Raises ValueError where a polygon crosses itself.
    """
    fan = [(0, k, k + 1) for k in range(1, len(points) - 1)]
    if len(fan) == 1:
        return fan

    def normal(a, b, c):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points[a], points[b], points[c]
        (ux, uy, uz), (vx, vy, vz) = (bx - ax, by - ay, bz - az), (cx - ax, cy - ay, cz - az)
        return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx

    normals = [normal(*corners) for corners in fan]
    nx, ny, nz = (sum(n[axis] for n in normals) for axis in range(3))

    def turn(a, b, c):
        x, y, z = normal(a, b, c)
        return x * nx + y * ny + z * nz

    if all(x * nx + y * ny + z * nz >= 0.0 for x, y, z in normals):
        return fan
    if len(points) > _MOST_CORNERS:
        raise ValueError(f"{where}: a concave face has {len(points)} corners; cut it into triangles.")

    def is_ear(a, b, c, left):
        places = points[a], points[b], points[c]
        return turn(a, b, c) > 0.0 and not any(
            turn(a, b, p) >= 0.0 and turn(b, c, p) >= 0.0 and turn(c, a, p) >= 0.0
            for p in left
            if points[p] not in places
        )

    left, out = list(range(len(points))), []
    while len(left) > 2:
        found = [(left[i - 1], b, left[(i + 1) % len(left)]) for i, b in enumerate(left)]
        ear = next((corners for corners in found if is_ear(*corners, left)), None)
        # What is left of corners in one line has no ears, and no area.
        ear = ear or next((corners for corners in found if turn(*corners) == 0.0), None)
        if ear is None:
            raise ValueError(f"{where}: a face crosses itself; cut it into triangles.")
        out.append(ear)
        left.remove(ear[1])
    return out


def _spherical_coordinates(points):
    """Texture coordinates [k, 3, 2] of triangles [k, 3, 3] by projection from their bounding box's centre on
    a sphere.
    """
    flat = points.reshape(-1, 3)
    direction = normalize(points - (flat.min(axis=0) + flat.max(axis=0)) / 2)
    step = 2.0**20
    s = np.floor((np.arctan2(direction[..., 0], direction[..., 2]) / (2 * math.pi) + 0.5) * step + 0.5) / step
    t = np.floor((np.arcsin(np.clip(direction[..., 1], -1, 1)) / math.pi + 0.5) * step + 0.5) / step
    # A triangle across the seam keeps its corners together: those left of it move one period to the right.
    s = np.where(s.max(axis=1, keepdims=True) - s > 0.5, s + 1.0, s)
    return np.stack([s, t], axis=-1)


def _any_perpendicular(normals):
    """A unit vector perpendicular to each normal."""
    smallest = np.argmin(np.abs(normals), axis=-1)
    return normalize(cross(normals, np.eye(3)[smallest]))


def _accumulate(count, indices, vectors):
    out = np.zeros((count, 3))
    np.add.at(out, indices.ravel(), np.repeat(vectors, 3, axis=0))
    return out


def from_triangles(points, coordinates=None, normals=None, name="The mesh"):
    """A surface from separate triangles, with normals and tangents where they are missing.

    Parameters
    ----------
    points
        float [k, 3 corners, 3]. Triangles without area are left out.
    coordinates
        float [k, 3, 2] texture coordinates, or None: projected on a sphere round the bounding box's centre.
    normals
        float [k, 3, 3], or None: the faces' normals, weighted by area, averaged where corners share a
        position.
    name
        For the message.

    Tangents follow the direction in which s grows, averaged where corners share position, texture
    coordinates and normal, and are made perpendicular to the normal; mirrored texture coordinates turn the
    binormal round.
    Raises ValueError when no triangle has an area.
    """
    points = np.asarray(points, np.float64)
    edges = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    face = cross(*edges)
    kept = dot(face, face) > 0.0
    if not kept.any():
        raise ValueError(f"{name} has no triangle with an area; give at least one.")
    points, face = points[kept], face[kept]
    edges = edges[0][kept], edges[1][kept]
    coordinates = (
        _spherical_coordinates(points) if coordinates is None else np.asarray(coordinates, np.float64)[kept]
    )
    if normals is None:
        places, at = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True)
        normals = _accumulate(len(places), at, face)[at.ravel()].reshape(points.shape)
    else:
        normals = np.asarray(normals, np.float64)[kept]
    length = dot(normals, normals)
    normals = normalize(np.where((length > 0.0)[..., None], normals, face[:, None, :]))

    corners = np.concatenate([points, coordinates, normals], axis=-1).reshape(-1, 8)
    vertices, at = np.unique(corners, axis=0, return_inverse=True)
    triangles = at.reshape(-1, 3)
    positions, texture_coordinates, normals = vertices[:, :3], vertices[:, 3:5], vertices[:, 5:]
    d1, d2 = (coordinates[:, k] - coordinates[:, 0] for k in (1, 2))
    orientation = np.sign(d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1])[:, None]
    along_s = orientation * (edges[0] * d2[:, 1:] - edges[1] * d1[:, 1:])
    along_t = orientation * (edges[1] * d1[:, :1] - edges[0] * d2[:, :1])
    tangents = _accumulate(len(vertices), triangles, along_s)
    upward = _accumulate(len(vertices), triangles, along_t)
    tangents = normalize(tangents - dot(tangents, normals)[:, None] * normals)
    tangents = np.where(dot(tangents, tangents)[:, None] > 0.5, tangents, _any_perpendicular(normals))
    binormals = cross(normals, tangents)
    binormals = np.where(dot(binormals, upward)[:, None] < 0.0, -binormals, binormals)
    return Surface(positions, normals, tangents, binormals, texture_coordinates, triangles)


def read_obj(text, name="The OBJ file"):
    """A surface from the text of a Wavefront OBJ file: v, vt, vn and f with plane polygons of any size,
    concave ones too.

    Other statements (groups, materials, smoothing) are ignored. Missing texture coordinates and normals are
    made as ``from_triangles`` says. Raises ValueError with ``name`` and the line for anything unreadable.
    """
    vertices, coordinates, normals, corners = [], [], [], []
    for number, line in enumerate(text.splitlines(), start=1):
        fields = line.split("#", 1)[0].split()
        where = f"{name}, line {number}"
        if not fields:
            continue
        if fields[0] == "v":
            vertices.append(_obj_floats(fields[1:], 3, 3, where, "a vertex"))
        elif fields[0] == "vt":
            coordinates.append([*_obj_floats(fields[1:], 1, 2, where, "a texture coordinate"), 0.0][:2])
        elif fields[0] == "vn":
            normals.append(_obj_floats(fields[1:], 3, 3, where, "a normal"))
        elif fields[0] == "f":
            counts = len(vertices), len(coordinates), len(normals)
            face = [_obj_corner(f, counts, where) for f in fields[1:]]
            if len(face) < 3:
                raise ValueError(f"{where}: a face has {len(face)} corners; it needs at least three.")
            cut = _cut_up([vertices[corner[0]] for corner in face], where)
            corners += [tuple(face[k] for k in triangle) for triangle in cut]
    if not corners:
        raise ValueError(f"{name} has no faces (lines that begin with f); there is nothing to draw.")
    index = np.array(corners, np.int64)
    points = np.array(vertices)[index[..., 0]]
    with_coordinates = (index[..., 1] >= 0).all() and coordinates
    with_normals = (index[..., 2] >= 0).all() and normals
    return from_triangles(
        points,
        np.array(coordinates)[index[..., 1]] if with_coordinates else None,
        np.array(normals)[index[..., 2]] if with_normals else None,
        name,
    )
