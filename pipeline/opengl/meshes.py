"""Meshes by content: equal vertices as those of a late draw are the same Mesh.

What a machine and validation know of a Mesh they find again by its identity. Most draws of a program have the
vertices of a draw of the frame before.
"""

from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.opengl.outcomes import LeftOut

# The least bytes of meshes and their keys that are kept; at most twice as many are.
_KEPT_BYTES = 96 << 20
_ENTRY_BYTES = 1000  # of Python's objects in an entry

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
    """The meshes of late draws, by keys that hold or stand for all that they were made from.

    When the younger half has its bytes, it becomes the older half, and the older one is forgotten.
    """

    def __init__(self, kept_bytes: int = _KEPT_BYTES):
        self._most = kept_bytes
        self._young: dict[Hashable, tuple[Mesh, int]] = {}
        self._old: dict[Hashable, tuple[Mesh, int]] = {}
        self._bytes = 0

    def find(self, key: Hashable, make: Callable[[], Mesh], key_bytes: int = 0) -> Mesh:
        """The Mesh of a key; ``make`` makes it where it is not known. ``key_bytes``: the key's size."""
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
    """A key of arrays by their bytes, and its size."""
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
    """The Mesh of these columns. Raises LeftOut where one of its numbers is infinite or NaN."""
    mesh = Mesh(primitive=primitive, indices=indices, counts=counts, **columns)
    for name, word in _WORDS.items():
        column = getattr(mesh, name)
        for array in column if name == "texture_coordinates" else (column,):
            if array is not None and not np.isfinite(array).all():
                raise LeftOut(f"a vertex's {word} is infinite or no number")
    return mesh
