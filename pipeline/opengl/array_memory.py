"""The memory of vertex arrays and indices, and how their elements are read (OpenGL 1.2.1 section 2.8)."""

from collections.abc import Hashable
from functools import singledispatch
from typing import Any, NamedTuple

import numpy as np

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.buffers import Buffer, as_memory
from fixedpipe.pipeline.opengl.current import filled
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused

# The name of a column among a Mesh's arguments. For texture coordinates: (name, number of the set).
Kind = str | tuple[str, int]

TEXTURE = "texture_coordinates"

DTYPES = {
    tokens.BYTE: np.dtype("<i1"),
    tokens.UNSIGNED_BYTE: np.dtype("<u1"),
    tokens.SHORT: np.dtype("<i2"),
    tokens.UNSIGNED_SHORT: np.dtype("<u2"),
    tokens.INT: np.dtype("<i4"),
    tokens.UNSIGNED_INT: np.dtype("<u4"),
    tokens.FLOAT: np.dtype("<f4"),
    tokens.DOUBLE: np.dtype("<f8"),
}
# Columns whose integers are fractions (table 2.6), and columns with one number for each vertex.
FRACTIONS = frozenset({"normals", "colors", "secondary_colors"})
_SINGLE = frozenset({"fog_coordinates", "edge_flags", "weights"})
_WORDS = {
    "positions": "vertex",
    "normals": "normal",
    "colors": "colour",
    "secondary_colors": "secondary colour",
    "fog_coordinates": "fog coordinate",
    "edge_flags": "edge flag",
    "weights": "weight",
    TEXTURE: "texture coordinate",
}


def name_of_kind(kind: Kind) -> str:
    """The name of the Mesh's argument for a kind."""
    return kind if isinstance(kind, str) else kind[0]


class ArrayPointer(NamedTuple):
    """The place and layout of an array.

    - ``size``, ``type``, ``stride``, ``pointer``: the arguments of the call.
    - ``memory``: client memory, as bytes or uint8 [n]; None if a buffer holds the array, or nothing does.
    - ``offset``: the offset of element 0 in bytes, from the beginning of ``memory`` or of ``buffer``.
    """

    kind: Kind
    size: int
    type: int
    stride: int
    pointer: Any
    memory: Any
    offset: int
    buffer: Buffer | None

    def key(self) -> tuple[Hashable, ...]:
        """The part of a Mesh's key that identifies the array's contents. Raises GLError."""
        return *self[:4], self.offset, memory_key(self.memory, self.buffer)

    def frozen(self) -> "ArrayPointer":
        """The same array with a copy of its contents, which no call can change."""
        return self._replace(memory=_frozen(self.memory, self.buffer), buffer=None)

    def read(self, first: int, count: int, rows: np.ndarray | None = None) -> np.ndarray:
        """Elements as a Mesh's column, float64 or bool: ``count`` from ``first`` on, or ``rows`` of them.

        Raises Refused if the memory is too short.
        """
        name, dtype = name_of_kind(self.kind), DTYPES[self.type]
        size = 4 if self.size == tokens.BGRA else self.size
        step = self.stride or size * dtype.itemsize
        memory = _readable(self.memory, self.buffer)
        if memory is None:
            raise Refused(f"its {_WORDS[name]} array has no data")
        start = self.offset + first * step
        end = start + (count - 1) * step + size * dtype.itemsize
        if start < 0 or end > len(memory):
            raise Refused(f"its {_WORDS[name]} array has {len(memory)} bytes, where {end} are read")
        elements = np.ndarray((count, size), dtype, memory, start, (step, dtype.itemsize))
        if rows is not None:
            elements = elements[rows]
        if name == "edge_flags":
            return elements[:, 0] != 0
        values = elements.astype(np.float64)
        if name in FRACTIONS and dtype.kind != "f":
            scale = float(2 ** (8 * dtype.itemsize) - 1)
            values = values / scale if dtype.kind == "u" else (2.0 * values + 1.0) / scale
        if self.size == tokens.BGRA:
            values = values[:, [2, 1, 0, 3]]
        if name == "secondary_colors":
            values = np.column_stack([values[:, :3], np.full(len(values), filled(())[3])])
        return values[:, 0] if name in _SINGLE else values


def memory_key(memory: Any, buffer: Buffer | None) -> Hashable:
    """A value that identifies contents in a key of a Mesh. Raises GLError for a mapped buffer."""
    if buffer is None:
        return memory if isinstance(memory, bytes) or memory is None else memory.tobytes()
    if buffer.mapped:
        raise GLError(tokens.INVALID_OPERATION, "a mapped buffer is read")
    return buffer.version


def _readable(memory, buffer):
    return memory if buffer is None else buffer.data


def _frozen(memory, buffer):
    if buffer is not None:
        return buffer.contents()
    return memory if isinstance(memory, bytes) or memory is None else memory.tobytes()


@singledispatch
def client_memory(given: Any, dtype: np.dtype, packed: bool) -> bytes | np.ndarray | None:
    """Client memory as bytes or uint8 [n], or None. ``packed``: whether elements follow without gaps."""
    return as_memory(given)


@client_memory.register(bytes)
def _constant_memory(given, dtype, packed):
    return given


@client_memory.register(list)
@client_memory.register(tuple)
def _listed_memory(given, dtype, packed):
    return np.array(given, dtype).tobytes()


@client_memory.register(np.ndarray)
def _array_memory(given, dtype, packed):
    numbers = given.dtype.kind in "iuf" and given.itemsize > 1  # other arrays are taken as bytes
    if packed and numbers and given.dtype != dtype:
        raise Refused(f"the array holds {given.dtype}, where {dtype} are read")
    return as_memory(given)


class Indices(NamedTuple):
    """The place of the indices of a draw. The fields have the same meaning as in ArrayPointer."""

    type: int
    memory: Any
    offset: int
    buffer: Buffer | None

    def key(self) -> tuple[Hashable, ...]:
        """The part of a Mesh's key that identifies the indices. Raises GLError."""
        return self.type, self.offset, memory_key(self.memory, self.buffer)

    def frozen(self) -> "Indices":
        """The same indices as a copy, which no call can change."""
        return self._replace(memory=_frozen(self.memory, self.buffer), buffer=None)

    def read(self, count: int) -> np.ndarray:
        """The first ``count`` indices, int64. Raises Refused if the memory is too short."""
        dtype, memory = DTYPES[self.type], _readable(self.memory, self.buffer)
        if memory is None:
            raise Refused("its indices have no data")
        end = self.offset + count * dtype.itemsize
        if self.offset < 0 or end > len(memory):
            raise Refused(f"its indices have {len(memory)} bytes, where {end} are read")
        return np.ndarray((count,), dtype, memory, self.offset).astype(np.int64)
