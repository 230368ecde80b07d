"""NumPy's own files: the header of an NPY file comes first, and decides how much is read."""

import math
from typing import NamedTuple

import numpy as np

from fixedpipe.effects.refusal import Refusal

_FORMAT = np.lib.format


class Header(NamedTuple):
    """An array's shape, the order of its axes, and its type."""

    shape: tuple[int, ...]
    fortran_order: bool
    dtype: np.dtype

    @property
    def bytes(self):
        """How many follow the header."""
        return math.prod(self.shape) * self.dtype.itemsize


def header(file):
    """The Header of an NPY file, which is left where its values begin. Raises ValueError and the exceptions
    of NumPy's reader.
    """
    major, _ = _FORMAT.read_magic(file)
    # Version 3 differs from 2 in how names of fields are encoded alone; arrays of numbers have none.
    read = _FORMAT.read_array_header_1_0 if major == 1 else _FORMAT.read_array_header_2_0
    found = Header(*read(file))
    if min(found.shape, default=0) < 0 or major > 3:
        raise ValueError("no shape")
    return found


def values(file, found, name):
    """The array that follows a Header, and no byte beyond it. Raises Refusal if it is cut off, and the
    exceptions of the decoder.
    """
    data = np.empty(found.bytes, np.uint8)
    read = _fill(file, memoryview(data))
    if read < found.bytes:
        raise cut_off(name, found, read)
    array = data.view(found.dtype) if found.bytes else np.empty(0, found.dtype)
    return array.reshape(found.shape, order="F" if found.fortran_order else "C")


def cut_off(name, found, there):
    """A Refusal of an array with too few bytes: only ``there`` of them."""
    return Refusal(
        f"{name} is cut off: an array of shape {found.shape} and type {found.dtype} has {found.bytes} bytes, "
        f"and {there} are there. Write it with numpy.save, as an array of numbers."
    )


def _fill(file, into):
    """Read until a buffer is full or the file ends; how many bytes that were."""
    at = 0
    while at < len(into) and (count := file.readinto(into[at : at + (1 << 24)])):
        at += count
    return at
