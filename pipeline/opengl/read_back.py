"""Reads from the machine in mid-frame: pixels of its framebuffer, and how many samples passed.

Commands are immutable, and a copied colour table or a blit of another framebuffer needs pixels. So waiting
commands are drawn first, and then the pixels are read, as a driver of the time did. A ``Context`` alone has
no machine behind it, and refuses such calls. A replay has one.
"""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import ReadPixels
from fixedpipe.pipeline.opengl.outcomes import Refused

# The largest depth in a PixelImage, which holds depths as fractions of it.
_WIDEST = np.uint64(2**32 - 1)


class Behind(Protocol):
    """The machine behind a Context."""

    def run_waiting(self) -> None:
        """Run the waiting commands: what they draw into, or read, is about to change."""

    def read(self, command: ReadPixels) -> NDArray[Any]:
        """Run the waiting commands, and then this one. Returns its pixels; zeros if nothing is drawn."""

    def depth_bits(self) -> int:
        """How many bits a depth of ``read`` has."""

    def count_samples(self, begun: bool) -> int | None:
        """Begin to count samples that pass, or end it and return the count; None if nothing is counted."""


def _behind(gl: Any) -> Behind:
    if gl.behind is None:
        raise Refused("it takes pixels of the framebuffer, and no machine draws behind this context")
    return gl.behind


def _read(gl, box, size, kind):
    """(pixels, rows, columns) of the part of a box inside a framebuffer of ``size`` pixels."""
    x, y, width, height = box
    left, below = max(x, 0), max(y, 0)
    right, above = min(x + width, size[0]), min(y + height, size[1])
    if left >= right or below >= above:
        return None, slice(0), slice(0)
    label = f"{gl.called} (call {gl.tally.call})"
    command = ReadPixels(
        label=label,
        name=label,
        format=kind,
        x=left,
        y=below,
        width=right - left,
        height=above - below,
        type="FLOAT" if kind == "RGBA" else "UNSIGNED_BYTE",
    )
    return _behind(gl).read(command), slice(below - y, above - y), slice(left - x, right - x)


def colors_read(gl: Any, box: tuple[int, int, int, int], size: tuple[int, int]) -> NDArray[np.float64]:
    """The present colours of a box of the framebuffer, [height, width, 4] in [0, 1], bottom row first.

    ``box``: x, y, width and height; ``size``: of the framebuffer. Pixels outside, which are undefined in
    OpenGL, are zero. Raises Refused if there is no machine.
    """
    made = np.zeros((box[3], box[2], 4))
    read, rows, columns = _read(gl, box, size, "RGBA")
    if read is not None:
        made[rows, columns] = read
    return made


def depths_read(gl: Any, box: tuple[int, int, int, int], size: tuple[int, int]) -> NDArray[np.uint32]:
    """The depths of a box, [height, width], as fractions of 2^32 - 1. Otherwise as ``colors_read``."""
    made = np.zeros((box[3], box[2]), np.uint32)
    read, rows, columns = _read(gl, box, size, "DEPTH_COMPONENT")
    if read is not None:
        farthest = np.uint64(2 ** _behind(gl).depth_bits() - 1)
        # The machine converts this fraction back to the same depth.
        made[rows, columns] = (read.astype(np.uint64) * _WIDEST + farthest // np.uint64(2)) // farthest
    return made


def stencil_read(gl: Any, box: tuple[int, int, int, int], size: tuple[int, int]) -> NDArray[np.uint8]:
    """The stencil values of a box, [height, width]. Otherwise as ``colors_read``."""
    made = np.zeros((box[3], box[2]), np.uint8)
    read, rows, columns = _read(gl, box, size, "STENCIL_INDEX")
    if read is not None:
        made[rows, columns] = read
    return made
