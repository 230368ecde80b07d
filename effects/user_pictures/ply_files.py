"""PLY files, read whole or refused: their vertices and faces, as corners of triangles."""

import io
import math
import re
import warnings
from pathlib import Path

import numpy as np

from fixedpipe.effects.geometry.triangle_meshes import (
    BAD_FACES,
    LARGEST,
    MOST_VERTICES,
    Corners,
    Cutter,
    note_problem,
)
from fixedpipe.effects.refusal import Refusal

_AGAIN = "Give a whole PLY or OBJ file."
# Names that programs give to texture coordinates at vertices, and to the lists of faces.
_COORDINATES = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
_CORNERS, _FACE_COORDINATES = ("vertex_indices", "vertex_index"), ("texcoord", "texcoords", "uv")
_FACES, _STRIPS = ("face", "faces", "polygon"), ("tristrips", "tristrip")
# Assumed: no mesh of more faces is drawn within a minute, and no header is longer.
MOST_FACES, _LONGEST_HEADER = 500_000, 1 << 16
_SIZES = {
    **{"char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2},
    **{"int": 4, "uint": 4, "int32": 4, "uint32": 4, "float": 4, "float32": 4, "double": 8, "float64": 8},
}


def read_ply(path: Path) -> Corners:
    """The Corners of a PLY file: triangles, polygons and triangle strips, with the normals and texture
    coordinates of its vertices, or texture coordinates of its faces.

    Raises Refusal if it is no complete PLY file, or if the package that reads it is missing.
    """
    try:
        import plyfile
    except ImportError as error:
        raise Refusal(
            f"{path} needs the extra `meshes`: pip install 'fixedpipe[meshes]'. OBJ files need nothing."
        ) from error
    try:
        data = path.read_bytes()
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from error
    end, elements = _header(data, path)
    # Comments may be in any encoding; what is read is ASCII.
    data = re.sub(rb"[\x80-\xff]", b"?", data[:end]) + data[end:]
    _check_counts(data[end:], elements, data[:end], path)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            read = plyfile.PlyData.read(io.BytesIO(data))
        # A reader fed arbitrary bytes raises whatever it stumbles over.
        except Exception as error:
            again = _flowed(data, end, elements) if b"ascii" in data[:end] else None
            if again is None:
                raise Refusal(_damaged(path, error)) from error
            try:
                read = plyfile.PlyData.read(io.BytesIO(again))
            except Exception as second:
                raise Refusal(_damaged(path, second)) from second
        try:
            return _corners({element.name: element.data for element in read.elements}, path)
        except (
            KeyError,
            TypeError,
            OverflowError,
            IndexError,
        ) as error:  # a float for an index, for instance
            raise Refusal(f"{path} has properties of kinds that are not read. {_AGAIN}") from error


def _damaged(path, error):
    where = re.search(r"element '(\w{1,40})': row (\d+)", str(error))
    what = f": {where[1]} {where[2]} is not whole" if where else ""
    return f"{path} has a damaged header, or fewer vertices and faces than it names{what}. {_AGAIN}"


def _header(data, path):
    """(where the header ends, [(name of an element, how many, its properties as words)])."""
    if not data.startswith(b"ply"):
        raise Refusal(f"{path} does not begin with ply and is no PLY file. {_AGAIN}")
    found = re.compile(rb"end_header[ \t]*(?:\r\n|\n|\r)").search(data, 0, _LONGEST_HEADER)
    if found is None:
        raise Refusal(f"{path} has a PLY header without its end, end_header. {_AGAIN}")
    elements: list = []
    for line in re.split("[\r\n]+", data[: found.start()].decode("latin-1")):
        words = line.split()
        if words[:1] == ["element"] and len(words) == 3 and re.fullmatch("[0-9]{1,18}", words[2]):
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"] and elements and len(words) > 2:
            elements[-1][2].append(words[1:])
    named = {name: [words[-1] for words in properties] for name, _, properties in elements}
    if not {"x", "y", "z"} <= set(named.get("vertex", ())):
        raise Refusal(f"{path} has a PLY header without x, y and z of its vertices. {_AGAIN}")
    return found.end(), elements


def _check_counts(body, elements, header, path):
    """Refuse more elements than so many bytes can hold, before room is made for them."""
    text = b"ascii" in header
    least = 0
    for name, count, properties in elements:
        sizes = [
            2 if text else _SIZES.get(words[1] if words[0] == "list" else words[0], 1) for words in properties
        ]
        least += count * sum(sizes)
        if name in (*_FACES, *_STRIPS) and count > MOST_FACES:
            raise Refusal(f"{path} has {count} faces; up to {MOST_FACES} are drawn. Make it coarser.")
        if name == "vertex" and count > MOST_VERTICES:
            raise Refusal(f"{path} has {count} vertices; up to {MOST_VERTICES} are read. Make it coarser.")
        if not properties and count:
            raise Refusal(f"{path} has a header whose element {name[:40]} has no properties. {_AGAIN}")
    # The last number needs nothing behind it.
    if least > len(body) + text:
        raise Refusal(
            f"{path} has a damaged header, or fewer vertices and faces than it names: they need {least} "
            f"bytes at least, and {len(body)} are there. {_AGAIN}"
        )


def _flowed(data, end, elements):
    """An ASCII file with each element on a line, of one whose elements go over lines; None where an element
    does not end with a line, or there are too few numbers.
    """
    lines = iter(line.split() for line in data[end:].splitlines())
    out = []
    for _, count, properties in elements:
        for _ in range(count):
            words: list = []
            try:
                while not _is_whole(words, properties):
                    words += next(lines)
            except (StopIteration, ValueError):
                return None
            out.append(b" ".join(words))
    return data[:end] + b"\n".join(out) + b"\n"


def _is_whole(words, properties):
    at = 0
    for each in properties:
        if at >= len(words):
            return False
        at += 1 + (int(words[at]) if each[0] == "list" else 0)
    if at < len(words):
        raise ValueError
    return at == len(words)


def _corners(elements, path):
    vertex = elements["vertex"]
    names = vertex.dtype.names
    points = _columns(vertex, "xyz")
    polygons, coordinates_of = _polygons(elements, path)
    triangles, faces, problems = _triangles(polygons, points, path)
    if not len(triangles):
        first = problems.get(BAD_FACES)
        raise Refusal(
            first[1] if first else f"{path} has no faces; there is nothing to draw. Give a mesh with faces."
        )
    numbers = np.array([[polygons[f][k] for k in corners] for f, corners in triangles], np.int64)
    shape = (*numbers.shape, 2)
    given = next((pair for pair in _COORDINATES if set(pair) <= set(names)), None)
    if given is not None:
        coordinates = _finite(_columns(vertex, given))[numbers]
    elif coordinates_of is not None:
        coordinates = _of_faces(coordinates_of, polygons, triangles)
    else:
        coordinates = np.full(shape, math.nan)
    normals = np.full((*numbers.shape, 3), math.nan)
    if {"nx", "ny", "nz"} <= set(names):
        vectors = _columns(vertex, ("nx", "ny", "nz"))
        # A normal of no length says nothing.
        vectors[(vectors == 0.0).all(axis=-1)] = math.nan
        normals = _finite(vectors)[numbers]
    return Corners(points[numbers], coordinates, normals, len(points), faces, problems)


def _columns(vertex, names):
    """Properties of vertices as columns. Raises TypeError where one is a list."""
    for name in names:
        if vertex.dtype[name].kind == "O":
            raise TypeError(name)
    return np.stack([np.asarray(vertex[name], np.float64) for name in names], axis=-1)


def _finite(vectors):
    """The vectors, NaN where one has a number that is none."""
    return np.where((np.abs(vectors) <= LARGEST).all(axis=-1, keepdims=True), vectors, math.nan)


def _polygons(elements, path):
    """(the faces, each a list of its vertices; their lists of texture coordinates, or None)."""
    for name in _FACES:
        if name in elements and len(elements[name]):
            face = elements[name]
            lists = [each for each in face.dtype.names if face.dtype[each].kind == "O"]
            corners = next((each for each in _CORNERS if each in lists), None)
            if corners is None:
                raise Refusal(f"{path} has faces without a list vertex_indices. {_AGAIN}")
            pairs = next((each for each in _FACE_COORDINATES if each in lists), None)
            return list(map(_whole, face[corners])), None if pairs is None else face[pairs]
    for name in _STRIPS:
        if name in elements and len(elements[name]):
            strips = elements[name]
            lists = [each for each in strips.dtype.names if strips.dtype[each].kind == "O"]
            corners = next((each for each in _CORNERS if each in lists), None)
            if corners is None:
                raise Refusal(f"{path} has triangle strips without a list vertex_indices. {_AGAIN}")
            return [triangle for strip in strips[corners] for triangle in _of_strip(strip)], None
    return [], None


def _whole(numbers):
    """A list of indices. Raises TypeError where they are of a kind that is none."""
    given = np.asarray(numbers)
    if given.dtype.kind not in "iu":
        raise TypeError(given.dtype)
    return given.tolist()


def _of_strip(strip):
    """The triangles of a strip, which -1 ends: each second one is wound the other way."""
    begin = 0
    numbers = _whole(strip)
    for end in [k for k, number in enumerate(numbers) if number < 0] + [len(numbers)]:
        part = numbers[begin:end]
        for k in range(len(part) - 2):
            a, b, c = part[k : k + 3]
            if len({a, b, c}) == 3:  # a vertex given twice joins strips
                yield [a, b, c] if k % 2 == 0 else [b, a, c]
        begin = end + 1


def _triangles(polygons, points, path):
    """([(face, its three corners)], how many faces are drawn, what was left out)."""
    cutter, found, drawn, problems = Cutter(), [], 0, {}
    finite = (np.abs(points) <= LARGEST).all(axis=1)
    rows = points.tolist()
    for number, polygon in enumerate(polygons):
        wrong = next((v for v in polygon if not 0 <= v < len(rows)), None)
        if wrong is not None:
            there = f"its vertices are 0 to {len(rows) - 1}" if rows else "it has none"
            note_problem(problems, BAD_FACES, f"{path} has a face with vertex {wrong}; {there}.")
        elif len(polygon) < 3:
            note_problem(problems, BAD_FACES, f"{path} has a face of {len(polygon)} corners; three make one.")
        elif not all(finite[v] for v in polygon):
            sentence = (
                f"{path} has a vertex that is no finite number of at most {LARGEST:g}; repair the mesh."
            )
            note_problem(problems, BAD_FACES, sentence)
        else:
            cut = cutter.cut([rows[v] for v in polygon], f"{path}, face {number}")
            found += [(number, corners) for corners in cut]
            drawn += 1
    return found, drawn, problems


def _of_faces(lists, polygons, triangles):
    """Texture coordinates [k, 3, 2] of faces' lists, two for each corner; NaN of a list of another length."""
    out = np.full((len(triangles), 3, 2), math.nan)
    for row, (face, corners) in enumerate(triangles):
        pairs = lists[face]
        if len(pairs) == 2 * len(polygons[face]):
            out[row] = np.asarray(pairs, np.float64).reshape(-1, 2)[list(corners)]
    return _finite(out)
