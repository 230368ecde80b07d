"""Triangle meshes from a file or a list: OBJ, creases, normals at vertices."""

import math
import re
from dataclasses import dataclass, field
from functools import reduce
from operator import add

import numpy as np

from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cross, dot, normalize

# Assumed: no mesh is larger; the fourth power of a length, by which areas are compared, stays in float64.
LARGEST = 1e30


# Assumed: no concave face has more corners.
_MOST_CORNERS = 200
# Candidates that are looked at while the concave faces of a file are cut up. Measured: 57,800 in faces of 198
# corners take 3.4 s on a core of Zen 4; those of smaller faces take less.
_MOST_CANDIDATES = 100_000


class Cutter:
    """Cuts a file's polygons into triangles, within a time that is bounded for all of them."""

    def __init__(self):
        self.left = _MOST_CANDIDATES

    def cut(self, points, where):
        """Triangles, as numbers of three corners, of a polygon [n][3]: a fan round the first corner, and ears
        cut off where that would turn triangles over. Raises ValueError where a polygon crosses itself, or the
        file's concave faces take too long.
        """
        fan = [(0, k, k + 1) for k in range(1, len(points) - 1)]
        if len(fan) == 1:
            return fan
        normals = [_normal(*(points[corner] for corner in corners)) for corners in fan]
        axis = tuple(reduce(add, (n[k] for n in normals)) for k in range(3))
        if all(_along(n, axis) >= 0.0 for n in normals):
            return fan
        if len(points) > _MOST_CORNERS:
            raise ValueError(f"{where}: a concave face has {len(points)} corners; cut it into triangles.")
        return self._ears(points, axis, where)

    def _ears(self, points, axis, where):
        columns = np.array(points, np.float64).T

        def turn(k):
            corners = left[k - 1], left[k], left[(k + 1) % len(left)]
            return _along(_normal(*(points[corner] for corner in corners)), axis)

        left, out = list(range(len(points))), []
        turns = [turn(k) for k in left]
        while len(left) > 2:
            remaining = columns[:, left]
            ear = None
            for k, sharp in enumerate(turns):
                if sharp > 0.0 and self._is_ear(remaining, axis, (k - 1, k, (k + 1) % len(left)), where):
                    ear = k
                    break
            # What is left of corners in one line has no ears, and no area.
            if ear is None and 0.0 in turns:
                ear = turns.index(0.0)
            if ear is None:
                raise ValueError(f"{where}: a face crosses itself; cut it into triangles.")
            out.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
            del left[ear], turns[ear]
            for k in {(ear - 1) % len(left), ear % len(left)}:
                turns[k] = turn(k)
        return out

    def _is_ear(self, remaining, axis, corners, where):
        """Whether no other point of those that remain, [3, n], is in the triangle of three of them."""
        self.left -= 1
        if self.left < 0:
            raise ValueError(
                f"{where}: the file's concave faces take too long to cut up; cut them into triangles."
            )
        own = remaining[:, corners]
        first, second = own[:, :, None], own[:, (1, 2, 0), None]
        inside = (_along(_normal(first, second, remaining), axis) >= 0.0).all(axis=0)
        found = remaining[:, inside]
        return bool((found[:, :, None] == own[:, None, :]).all(axis=0).any(axis=1).all())


def _normal(a, b, c):
    """Of three points, or of arrays of them: the edges' cross product."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = a, b, c
    (ux, uy, uz), (vx, vy, vz) = (bx - ax, by - ay, bz - az), (cx - ax, cy - ay, cz - az)
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


def _along(normal, axis):
    return normal[0] * axis[0] + normal[1] * axis[1] + normal[2] * axis[2]


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


@dataclass
class Corners:
    """The triangles of a file, corner by corner, before they are a surface.

    points       float [k, 3, 3]
    coordinates  float [k, 3, 2]; NaN where the file gives none
    normals      float [k, 3, 3]; likewise
    vertices, faces  how many the file has
    problems     {what was left out, in the singular and the plural: [how many, the first in a sentence]}
    """

    points: np.ndarray
    coordinates: np.ndarray
    normals: np.ndarray
    vertices: int
    faces: int
    problems: dict = field(default_factory=dict)

    def surface(self, name: str, smooth: bool = False):
        """A Surface, with the file's normals and, where corners have none, creases (``smooth``: where no
        corner has one, normals averaged at each position); with the file's texture coordinates, or
        ``from_triangles``'s where a corner has none. Raises ValueError.
        """
        given = self._has(self.normals)
        normals = None if smooth and not given.any() else self.normals
        if normals is not None and not given.all():
            normals = np.where(given[..., None], normals, _crease_normals(self.points))
        coordinates = self.coordinates if self.has_coordinates else None
        return from_triangles(self.points, coordinates, normals, name)

    @property
    def has_coordinates(self) -> bool:
        """Whether the file gives texture coordinates to every corner."""
        return bool(self._has(self.coordinates).all())

    def text(self, smooth: bool = False) -> str:
        """How the file was understood, on one line."""
        made = "normals averaged at vertices" if smooth else "creases"
        normals = self._told(self.normals, "normals", made, f"{made} elsewhere")
        coordinates = self._told(
            self.coordinates,
            "texture coordinates",
            "spherical texture coordinates",
            "so spherical ones are taken",
        )
        triangles = "" if self.faces == len(self.points) else f" in {_count(len(self.points), 'triangle')}"
        left_out = "; left out: " * bool(self.problems) + ", ".join(map(self._problem, self.problems))
        return (
            f"{_count(self.vertices, 'vertex')}, {_count(self.faces, 'face')}{triangles}; {normals}; "
            f"{coordinates}{left_out}"
        )

    def _has(self, values):
        return np.isfinite(values).all(axis=-1)

    def _told(self, values, called, none, some):
        given = int(self._has(values).sum())
        if not given:
            return none
        if given == 3 * len(self.points):
            return f"the file's {called}"
        return f"{called} of {given} of {3 * len(self.points)} corners in the file, {some}"

    def _problem(self, what):
        count, first = self.problems[what]
        return f"{count} {what[count > 1]} ({first.removesuffix('.')})"


def _count(number, what):
    plural = "vertices" if what == "vertex" else f"{what}s"
    return f"{number} {what if number == 1 else plural}"


def note_problem(problems, what, sentence, count=1):
    """Count omitted data in ``Corners.problems``."""
    problems.setdefault(what, [0, sentence])[0] += count


# Of these a backslash at a line's end goes on; comments and names may end in one.
_READ = ("v", "vt", "vn", "f")
# What C libraries of the time print for numbers that are none.
_NO_NUMBER = re.compile(r"[+-]?(?:[0-9.]+#|)(?:ind|inf|q?nan|s?nan)(?:\(\w*\))?[0-9]*", re.IGNORECASE)
# Indices that are none: 0, and before the first.
_ZERO, _BEFORE = -2, -3
# Assumed: no mesh that is drawn within a minute has more.
MOST_VERTICES = 1_500_000
_NO_NUMBERS = ("vector without numbers", "vectors without numbers")
# What is left out: one of them, several.
BAD_FACES = ("face that cannot be drawn", "faces that cannot be drawn")
_BAD_INDICES = ("index of what is not there", "indices of what is not there")


class _ObjFile:
    """The statements of a Wavefront OBJ file."""

    def __init__(self, name):
        self.name, self.problems, self.corner_count = name, {}, 0
        self.vertices, self.coordinates, self.normals = [], [], []
        self.polygons: list = []  # (line, [[vertex, texture coordinate, normal], ...]), -1 for none

    def read(self, text):
        lines = _numbered(text)
        for number, line in lines:
            fields = _fields(line)
            if not fields:
                continue
            where = f"{self.name}, line {number}"
            if fields[0] in _READ and fields[-1].endswith("\\"):
                fields = self.over_lines(fields, lines)
            if fields[0] == "v":
                vertex = self.floats(fields[1:], 3, 3, where, "a vertex")
                if not all(abs(v) <= LARGEST for v in vertex):
                    raise ValueError(
                        f"{where}: a vertex must be finite numbers of at most {LARGEST:g}, found "
                        f"{' '.join(fields[1:])[:60]!r}."
                    )
                self.vertices.append(vertex)
            elif fields[0] == "vt":
                pair = self.floats(fields[1:], 1, 2, where, "a texture coordinate")
                self.coordinates.append([*pair, 0.0][:2])
                self.check(self.coordinates[-1], where, "a texture coordinate")
            elif fields[0] == "vn":
                self.normals.append(self.floats(fields[1:], 3, 3, where, "a normal"))
                self.check(self.normals[-1], where, "a normal")
            elif fields[0] == "f":
                try:
                    self.polygons.append((where, [self.corner(f) for f in fields[1:]]))
                    self.corner_count += len(fields) - 1
                except ValueError as error:
                    note_problem(self.problems, BAD_FACES, f"{where}: {error}")
            if (
                max(self.corner_count, *map(len, (self.vertices, self.coordinates, self.normals)))
                > MOST_VERTICES
            ):
                raise ValueError(
                    f"{where}: more than {MOST_VERTICES} vertices or corners; make the mesh coarser."
                )

    def check(self, values, where, what):
        """Count a vector that says nothing, as a problem unless it is zero, and have NaN for it."""
        if not all(abs(v) <= LARGEST for v in values):
            note_problem(self.problems, _NO_NUMBERS, f"{where}: {what} is no finite numbers.")
            values[:] = [math.nan] * len(values)
        elif what == "a normal" and not any(values):
            values[:] = [math.nan] * len(values)

    def over_lines(self, fields, lines):
        """The fields of a statement that goes on, until a line that does not end in a backslash."""
        found = list(fields)
        while found[-1].endswith("\\"):
            found[-1] = found[-1][:-1]
            following = next(lines, None)
            if following is None:
                break
            # An empty line ends it, as does the last.
            found += _fields(following[1]) or [""]
        return [each for each in found if each]

    def floats(self, fields, least, most, where, what):
        if not least <= len(fields):
            raise ValueError(f"{where}: {what} needs at least {least} numbers, found {len(fields)}.")
        try:
            return [_float(f) for f in fields[:most]]
        except ValueError:
            raise ValueError(f"{where}: {what} must be numbers, found {' '.join(fields)[:60]!r}.") from None

    def corner(self, text):
        """One "v/vt/vn" of a face as zero-based indices; -1 for what is missing."""
        parts = text.split("/")
        if len(parts) > 3 or not parts[0]:
            raise ValueError(f"a face corner is {text[:60]!r}; write it v, v/vt, v//vn or v/vt/vn.")
        corner = []
        for part, there in zip(
            (*parts, "", "")[:3], (self.vertices, self.coordinates, self.normals), strict=True
        ):
            try:
                index = int(part[:20]) if part else None
            except ValueError:
                raise ValueError(
                    f"a face corner is {text[:60]!r}; its indices must be whole numbers."
                ) from None
            if index is None:
                corner.append(-1)
            elif index == 0:
                corner.append(_ZERO)
            else:
                # The last so far is -1. What a later line gives is there too.
                corner.append(index - 1 if index > 0 else _existing(len(there) + index))
        return corner

    def corners(self):
        """The Corners of all faces that can be drawn."""
        cutter, triangles, drawn = Cutter(), [], 0
        counts = len(self.vertices), len(self.coordinates), len(self.normals)
        for where, polygon in self.polygons:
            wrong = next((v for v, _, _ in polygon if not 0 <= v < counts[0]), None)
            if wrong is not None or len(polygon) < 3:
                self.refuse(where, polygon, wrong, counts[0])
                continue
            for corner in polygon:
                for k, what in ((1, "texture coordinate"), (2, "normal")):
                    if not -1 <= corner[k] < counts[k]:
                        index = _written(corner[k])
                        sentence = f"{where}: {what} index {index} does not exist; there are {counts[k]}."
                        note_problem(self.problems, _BAD_INDICES, sentence)
                        corner[k] = -1
            cut = cutter.cut([self.vertices[corner[0]] for corner in polygon], where)
            triangles += [[polygon[k] for k in triangle] for triangle in cut]
            drawn += 1
        if not triangles:
            first = self.problems.get(BAD_FACES)
            raise ValueError(
                first[1]
                if first
                else f"{self.name} has no faces (lines that begin with f); there is nothing to draw."
            )
        index = np.array(triangles, np.int64)
        return Corners(
            np.array(self.vertices)[index[..., 0]],
            _picked(self.coordinates, index[..., 1], 2),
            _picked(self.normals, index[..., 2], 3),
            counts[0],
            drawn,
            self.problems,
        )

    def refuse(self, where, polygon, wrong, count):
        reason = (
            f"a face has {len(polygon)} corner{'s' * (len(polygon) != 1)}; it needs at least three"
            if wrong is None
            else f"vertex index {_written(wrong)} does not exist; there are {count}"
        )
        note_problem(self.problems, BAD_FACES, f"{where}: {reason}.")


def _float(text):
    try:
        return float(text)
    except ValueError:
        if _NO_NUMBER.fullmatch(text):
            return math.nan
        raise


def _numbered(text):
    """(number, line) of a text's lines, which end at newlines and nowhere else."""
    at, number = 0, 1
    while at <= len(text):
        end = text.find("\n", at)
        end = len(text) if end < 0 else end
        yield number, text[at:end]
        at, number = end + 1, number + 1


def _fields(line):
    """The words of a line before its comment: what begins with #, but in a number that is none."""
    found = []
    for each in line.split():
        word, mark, _ = each.partition("#")
        if mark and not (word and _NO_NUMBER.fullmatch(each)):
            return [*found, word] if word else found
        found.append(each)
    return found


def _existing(index):
    return index if index >= 0 else _BEFORE


def _written(index):
    """An index as the file has it, as far as that is known."""
    return str(index + 1) if index >= 0 else "0" if index == _ZERO else "before the first"


def _picked(values, index, width):
    """Values at indices, [..., width]; NaN where the index is -1."""
    table = np.array([*values, [math.nan] * width], np.float64)
    return table[np.where(index < 0, len(values), index)]


def obj_corners(text: str, name: str) -> Corners:
    """The Corners of the text of a Wavefront OBJ file: v, vt, vn and f with plane polygons of any size,
    concave ones too.

    Other statements (groups, materials, smoothing) are ignored. Faces with missing vertices or fewer than
    three, and indices of other missing data, are left out and counted. Raises ValueError with ``name`` and
    the line for anything that should be a number and is not, and if no face is left.
    """
    file = _ObjFile(name)
    file.read(text)
    return file.corners()


def read_obj(text, name="The OBJ file"):
    """A surface from the text of a Wavefront OBJ file, as ``obj_corners`` reads it.

    Missing texture coordinates and normals are made as ``from_triangles`` says. Raises ValueError.
    """
    return obj_corners(text, name).surface(name, smooth=True)


# Cosine of the bend from which an edge is sharp. Assumed: 40 degrees, as of ``surfaces.lathe``.
_SMOOTH = 0.766
_MOST_NEIGHBOURS = 256


def with_creases(surface):
    """The surface with normals of its own: faces' normals, weighted by area, averaged where corners share a
    position and the faces bend by less than 40 degrees.
    """
    points = surface.positions[surface.triangles]
    coordinates = surface.texture_coordinates[surface.triangles]
    return from_triangles(points, coordinates, _crease_normals(points))


def _crease_normals(points):
    face = cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    unit = normalize(face)
    _, place, counts = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(place.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    normals = np.zeros((len(order), 3))
    own = place.ravel()
    # Assumed: where more faces meet they are all smooth.
    many = counts[own] > _MOST_NEIGHBOURS
    if many.any():
        normals[many] = _accumulate(len(counts), own, face)[own[many]]
    # The n-th neighbour of every other corner at once.
    for n in range(min(int(counts.max()), _MOST_NEIGHBOURS)):
        there = (counts[own] > n) & ~many
        other = order[(first[own] + n)[there]] // 3
        mine = np.arange(len(own))[there] // 3
        smooth = dot(unit[mine], unit[other]) >= _SMOOTH
        normals[there] += np.where(smooth[:, None], face[other], 0.0)
    return normals.reshape(points.shape)
