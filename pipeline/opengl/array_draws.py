"""Draws from vertex arrays (OpenGL 1.2.1 section 2.8).

In OpenGL the current values of enabled arrays are undefined after a draw; here they do not change.
ArrayElement sets them, as the specification says.
"""

from collections.abc import Hashable, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.array_memory import (
    DTYPES,
    TEXTURE,
    ArrayPointer,
    Indices,
    Kind,
    client_memory,
    memory_key,
    name_of_kind,
)
from fixedpipe.pipeline.opengl.current import (
    columns_read,
    draw_mesh,
    drawn_count,
    filled,
    primitive_of,
    set_coordinates,
    vertex,
)
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.meshes import make_mesh
from fixedpipe.pipeline.opengl.outcomes import GLError, LeftOut, Refused

# A draw of more vertices is refused, because its columns would take gigabytes.
MAX_VERTICES = 1 << 24
_INDEX_TYPES = {tokens.UNSIGNED_BYTE, tokens.UNSIGNED_SHORT, tokens.UNSIGNED_INT}


class Elements(NamedTuple):
    """The elements that a draw takes from arrays: ``count`` from ``first``, or by ``indices``."""

    arrays: dict[Kind, ArrayPointer]
    first: int
    count: int
    indices: Indices | None

    def frozen(self) -> "Elements":
        """The same elements, for a display list."""
        arrays = {kind: array.frozen() for kind, array in self.arrays.items()}
        return self._replace(arrays=arrays, indices=None if self.indices is None else self.indices.frozen())


def _taken(gl, first, count, indices=None):
    """The elements of a draw that is called now. For a display list they are read now (section 5.4)."""
    elements = Elements(gl.arrays.read(), first, count, indices)
    return elements if gl.list is None else elements.frozen()


def _indices(gl, type_, pointer):
    """The Indices for the arguments of DrawElements. Raises GLError."""
    if type_ not in _INDEX_TYPES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(type_)} is no type of indices")
    if pointer is None or isinstance(pointer, int):
        return Indices(type_, None, pointer or 0, gl.buffers[tokens.ELEMENT_ARRAY_BUFFER])
    return Indices(type_, client_memory(pointer, DTYPES[type_], True), 0, None)


def _draw_elements(gl, mode, elements: Elements):
    """Draw elements of arrays as primitives of ``mode``."""
    primitive = primitive_of(mode)
    if elements.count < 0 or elements.first < 0:
        raise GLError(tokens.INVALID_VALUE, f"{elements.count} elements from element {elements.first}")
    count = drawn_count(mode, elements.count)
    if not count or gl.leaves_out_draws():
        return
    if "positions" not in elements.arrays:
        gl.tally.add("no effect", f"{gl.called} without a vertex array")
        return
    columns = list(_columns(gl, elements.arrays))
    indices = elements.indices
    parts: list[Hashable] = [mode, elements.first, count, None if indices is None else indices.key()]
    parts += [column.key() if isinstance(column, ArrayPointer) else column for column in columns]
    size = sum([len(part[-1]) for part in parts[3:] if part and isinstance(part[-1], bytes)])
    key = "arrays", *parts
    mesh = gl.meshes.find(key, lambda: _mesh_of(primitive, elements._replace(count=count), columns), size)
    draw_mesh(gl, mesh)


def _columns(gl, arrays) -> Iterator[ArrayPointer | tuple[Kind, Any]]:
    """The columns that the state reads: an array, or a kind and the current value for all vertices."""
    needs, now = columns_read(gl), gl.current
    yield arrays["positions"]
    yield arrays.get("colors") or ("colors", now.color)
    if "normals" in needs:
        yield arrays.get("normals") or ("normals", now.normal)
    for unit in range(needs[TEXTURE]):
        yield arrays.get((TEXTURE, unit)) or ((TEXTURE, unit), now.texture_coordinates[unit])
    if "secondary_colors" in needs:
        yield arrays.get("secondary_colors") or ("secondary_colors", now.secondary_color)
    if "fog_coordinates" in needs:
        yield arrays.get("fog_coordinates") or ("fog_coordinates", now.fog_coordinate)
    if "weights" in needs:
        yield arrays.get("weights") or ("weights", now.weight)
    if "edge_flags" in needs and ("edge_flags" in arrays or not now.edge_flag):
        yield arrays.get("edge_flags") or ("edge_flags", False)


def _mesh_of(primitive, elements: Elements, columns: Iterable[ArrayPointer | tuple[Kind, Any]]) -> Mesh:
    """The Mesh of elements. Raises Refused, and LeftOut if a value is infinite or NaN."""
    first, count, rows, indices = elements.first, elements.count, None, None
    if elements.indices is not None:
        if count > MAX_VERTICES:
            raise Refused(f"it has {count} indices; at most {MAX_VERTICES} are drawn here")
        indices = elements.indices.read(count)
        first, last = int(indices.min()), int(indices.max())
        count = last - first + 1
        indices -= first
        if count > 4 * len(indices):  # few of many vertices are drawn, so only these are read
            rows, indices = np.unique(indices, return_inverse=True)
    vertices = count if rows is None else len(rows)
    if vertices > MAX_VERTICES:
        raise Refused(f"it has {vertices} vertices; at most {MAX_VERTICES} are drawn here")
    made: dict[str, Any] = {TEXTURE: []}
    for column in columns:
        if isinstance(column, ArrayPointer):
            kind, values = column.kind, column.read(first, count, rows)
        else:
            kind, value = column
            values = np.broadcast_to(value, (vertices, *np.shape(value)))
        if isinstance(kind, tuple):
            made[TEXTURE].append(values)
        else:
            made[kind] = values
    return make_mesh(primitive, made, indices)


def _capture_arrays(gl, mode, first, count):
    return mode, _taken(gl, first, count)


@entry("DrawArrays", capture=_capture_arrays)
def draw_arrays(gl, mode, elements):
    """Draw elements in their order."""
    _draw_elements(gl, mode, elements)


def _capture_elements(gl, mode, count, type_, indices):
    return mode, _taken(gl, 0, count, _indices(gl, type_, indices))


@entry("DrawElements", capture=_capture_elements)
def draw_elements(gl, mode, elements):
    """Draw elements by their indices."""
    _draw_elements(gl, mode, elements)


def _capture_range(gl, mode, start, end, count, type_, indices):
    if end < start:
        raise GLError(tokens.INVALID_VALUE, f"the range ends at {end} and starts at {start}")
    return _capture_elements(gl, mode, count, type_, indices)


@entry("DrawRangeElements", capture=_capture_range)
def draw_range_elements(gl, mode, elements):
    """Draw elements by their indices. The program states a range for them, which is not checked."""
    _draw_elements(gl, mode, elements)


def _capture_multi_arrays(gl, mode, firsts, counts, number):
    if number < 0:
        raise GLError(tokens.INVALID_VALUE)
    return mode, tuple([_taken(gl, f, c) for f, c in zip(firsts[:number], counts[:number], strict=True)])


def _capture_multi_elements(gl, mode, counts, type_, pointers, number):
    if number < 0:
        raise GLError(tokens.INVALID_VALUE)
    both = zip(counts[:number], pointers[:number], strict=True)
    return mode, tuple([_taken(gl, 0, count, _indices(gl, type_, pointer)) for count, pointer in both])


def _draw_several(gl, mode, several):
    """Draw several times. If one draw is refused, the others are still drawn.

    A count that is not positive draws nothing, and is no error (EXT_multi_draw_arrays).
    """
    primitive_of(mode)
    for elements in several:
        if elements.count <= 0:
            continue
        try:
            _draw_elements(gl, mode, elements)
        except Refused as refusal:
            gl.tally.add("refused", f"{gl.called}: {refusal}")
        except LeftOut as reason:
            gl.tally.add("left out", f"{gl.called}: {reason}")


@entry("MultiDrawArrays", capture=_capture_multi_arrays)
def multi_draw_arrays(gl, mode, several):
    """Several calls of DrawArrays as one (EXT_multi_draw_arrays)."""
    _draw_several(gl, mode, several)


@entry("MultiDrawElements", capture=_capture_multi_elements)
def multi_draw_elements(gl, mode, several):
    """Several calls of DrawElements as one (EXT_multi_draw_arrays)."""
    _draw_several(gl, mode, several)


# ------------------------------------------------------------------------------------------ single elements


def _capture_element(gl, index):
    """The values of an element in each enabled array, with the position last."""
    if index < 0:
        raise GLError(tokens.INVALID_VALUE)
    arrays = gl.arrays.read()
    position = arrays.pop("positions", None)
    order = [array for kind, array in arrays.items() if name_of_kind(kind) in _SETTERS]
    order += [] if position is None else [position]
    for array in order:
        memory_key(None, array.buffer)  # raises GLError for a mapped buffer
    return (tuple([(array.kind, array.read(index, 1)[0].tolist()) for array in order]),)


_SETTERS = {
    "colors": lambda gl, value: setattr(gl.current, "color", filled(value)),
    "secondary_colors": lambda gl, value: setattr(gl.current, "secondary_color", tuple(value)),
    "normals": lambda gl, value: setattr(gl.current, "normal", tuple(value)),
    "fog_coordinates": lambda gl, value: setattr(gl.current, "fog_coordinate", value),
    "edge_flags": lambda gl, value: setattr(gl.current, "edge_flag", value),
    "weights": lambda gl, value: setattr(gl.current, "weight", value),
    "positions": vertex,
    TEXTURE: None,
}


@entry("ArrayElement", inside=True, capture=_capture_element)
def array_element(gl, values):
    """Set current values from an element of each enabled array, and then add a vertex at its position."""
    for kind, value in values:
        if isinstance(kind, tuple):
            set_coordinates(gl, kind[1], value)
        else:
            _SETTERS[kind](gl, value)
