"""Triangle meshes from a file or a list: OBJ, creases, normals at vertices."""

import math

import numpy as np

from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cross, dot, normalize

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


# Cosine of the bend from which an edge is sharp. Assumed: 40 degrees, as of ``surfaces.lathe``.
_SMOOTH = 0.766
_MOST_NEIGHBOURS = 256


def triangle_mesh(vertices, faces, name):
    """A surface from float [n, 3] and int [k, 3].

    Raises ValueError, with ``name``, where there are no faces, one names a vertex that is not there, a
    coordinate is no finite number, or none has an area.
    """
    vertices, faces = np.asarray(vertices, np.float64), np.asarray(faces, np.int64)
    if vertices.ndim != 2 or vertices.shape[1:] != (3,) or faces.ndim != 2 or faces.shape[1:] != (3,):
        raise ValueError(f"{name} has no triangles; there is nothing to draw.")
    if not len(faces):
        raise ValueError(f"{name} has no faces; there is nothing to draw.")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise ValueError(
            f"{name} has a face with vertex {int(faces.max() if faces.min() >= 0 else faces.min())}; its "
            f"vertices are 0 to {len(vertices) - 1}."
        )
    points = vertices[faces]
    if not (np.abs(points) <= LARGEST).all():
        raise ValueError(
            f"{name} has a vertex that is no finite number of at most {LARGEST:g}; repair the mesh."
        )
    return from_triangles(points, name=name)


def with_creases(surface):
    """The surface with normals of its own: faces' normals, weighted by area, averaged where corners share a
    position and the faces bend by less than 40 degrees.
    """
    points = surface.positions[surface.triangles]
    face = cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    unit = normalize(face)
    _, place, counts = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(place.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    normals = np.zeros((len(order), 3))
    # The n-th neighbour of every corner at once. Assumed: where more faces meet they are all smooth.
    for n in range(min(int(counts.max()), _MOST_NEIGHBOURS)):
        own = place.ravel()
        there = counts[own] > n
        other = order[(first[own] + n)[there]] // 3
        mine = np.arange(len(own))[there] // 3
        smooth = dot(unit[mine], unit[other]) >= _SMOOTH
        normals[there] += np.where(smooth[:, None], face[other], 0.0)
    return from_triangles(points, normals=normals.reshape(points.shape))
