"""Arrays as the bytes of a task's files: they hold the type, shape and numbers, and no code."""

import io
import zlib

import numpy as np
from numpy.typing import NDArray


def packed(array: NDArray) -> bytes:
    """An array of numbers, of any shape, as NPY, compressed by zlib."""
    stream = io.BytesIO()
    np.save(stream, np.ascontiguousarray(array), allow_pickle=False)
    return zlib.compress(stream.getvalue(), 1)


def unpacked(data: bytes) -> NDArray:
    """The array that ``packed`` made into ``data``. Raises ValueError or zlib.error for other bytes."""
    return np.load(io.BytesIO(zlib.decompress(data)), allow_pickle=False)
