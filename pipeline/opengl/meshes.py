"""Meshes by content: if vertices are equal to those of a recent draw, they are the same Mesh.

A machine and validation store data about a Mesh by its identity. Most draws of a program have the same
vertices as a draw of the frame before.
"""

from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.opengl.outcomes import LeftOut

# Meshes and their keys of about this many bytes are stored, and at most twice as many.
_KEPT_BYTES = 96 << 20
_ENTRY_BYTES = 1000  # the bytes of Python's objects in an entry

_WORDS = {
    "positions": "position",
    "colors": "colour",
    "secondary_colors": "secondary colour",
    "normals": "normal",
    "texture_coordinates": "texture coordinate",
    "fog_coordinates": "fog coordinate",
    "weights": "weight",
}


class Meshes:
    """The meshes of recent draws, by keys that contain, or identify, all data that they were made from.

    When the newer half is full, it becomes the older half, and the previous older half is dropped.
    """

    def __init__(self, kept_bytes: int = _KEPT_BYTES):
        self._most = kept_bytes
        self._young: dict[Hashable, tuple[Mesh, int]] = {}
        self._old: dict[Hashable, tuple[Mesh, int]] = {}
        self._bytes = 0

    def find(self, key: Hashable, make: Callable[[], Mesh], key_bytes: int = 0) -> Mesh:
        """The Mesh of a key. If it is not stored, ``make`` makes it. ``key_bytes``: the key's size."""
        found = self._young.get(key)
        if found is not None:
            return found[0]
        found = self._old.pop(key, None)
        if found is None:
            mesh = make()
            found = mesh, _ENTRY_BYTES + key_bytes + _size(mesh)
        self._young[key] = found
        self._bytes += found[1]
        if self._bytes > self._most:
            self._old, self._young, self._bytes = self._young, {}, 0
        return found[0]


def _size(mesh):
    arrays = [array for array in vars(mesh).values() if isinstance(array, np.ndarray)]
    return sum([array.nbytes for array in (*arrays, *mesh.texture_coordinates)])


def content_key(primitive, columns: dict[str, Any], indices, counts) -> tuple[Hashable, int]:
    """(a key made from the bytes of arrays, its size in bytes)."""
    parts: list[Hashable] = [primitive, counts]
    size = 0
    several = [("indices", indices)] if indices is not None else []
    for name, column in columns.items():
        several += [(name, array) for array in column] if name == "texture_coordinates" else [(name, column)]
    for name, array in several:
        contents = array.tobytes()
        parts.append((name, array.shape, array.dtype.char, contents))
        size += len(contents)
    return tuple(parts), size


def make_mesh(primitive: PrimitiveType, columns: dict[str, Any], indices: Any = None, counts=None) -> Mesh:
    """The Mesh of these columns. Raises LeftOut if one of its numbers is infinite or NaN."""
    mesh = Mesh(primitive=primitive, indices=indices, counts=counts, **columns)
    for name, word in _WORDS.items():
        column = getattr(mesh, name)
        for array in column if name == "texture_coordinates" else (column,):
            if array is not None and not np.isfinite(array).all():
                raise LeftOut(f"a vertex's {word} is infinite or no number")
    return mesh
