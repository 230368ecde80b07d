"""What only the machine knows, in the middle of a frame: pixels of its framebuffer, and how many passed.

Commands are immutable, and a colour table or a blit of another framebuffer is made of pixels. So what waits
is drawn first, and the pixels are read, as a driver of the time did. A ``Context`` by itself has no machine
behind it, and refuses such calls; a replay has one.
"""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import ReadPixels
from fixedpipe.pipeline.enums import ColorBuffer
from fixedpipe.pipeline.opengl.outcomes import Refused

# Bits of a depth that a fixed format's units become: PixelImage takes them as fractions of the largest.
_WIDEST = np.uint64(2**32 - 1)


class Behind(Protocol):
    """The machine behind a Context."""

    def read(self, command: ReadPixels) -> NDArray[Any]:
        """Run the commands that wait, and then this one; returns its pixels, zeros where nothing is drawn."""

    def depth_bits(self) -> int:
        """The width of a depth that ``read`` gives."""

    def count_samples(self, begun: bool) -> int | None:
        """Begin to count the samples that pass, or end it and return the count; None: nothing counts."""


def _behind(gl: Any) -> Behind:
    if gl.behind is None:
        raise Refused("it takes pixels of the framebuffer, and no machine draws behind this context")
    return gl.behind


def _read(gl, box, size, kind, buffer=ColorBuffer.BACK):
    """(pixels of the part of a box that lies in a framebuffer of ``size``, its rows, its columns)."""
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
        read_buffer=buffer,
    )
    return _behind(gl).read(command), slice(below - y, above - y), slice(left - x, right - x)


def colors_read(
    gl: Any, box: tuple[int, int, int, int], size: tuple[int, int], buffer: ColorBuffer
) -> NDArray[np.float64]:
    """The colours of a box of the framebuffer, which has ``size`` pixels, as they are now.

    ``box``: x, y, width and height. [height, width, 4] in [0, 1], bottom row first. Pixels outside, which
    OpenGL leaves undefined, are zero. Raises Refused where there is no machine.
    """
    made = np.zeros((box[3], box[2], 4))
    read, rows, columns = _read(gl, box, size, "RGBA", buffer)
    if read is not None:
        made[rows, columns] = read
    return made


def depths_read(gl: Any, box: tuple[int, int, int, int], size: tuple[int, int]) -> NDArray[np.uint32]:
    """The depths of a box, as ``colors_read``: [height, width], fractions of 2^32 - 1."""
    made = np.zeros((box[3], box[2]), np.uint32)
    read, rows, columns = _read(gl, box, size, "DEPTH_COMPONENT")
    if read is not None:
        farthest = np.uint64(2 ** _behind(gl).depth_bits() - 1)
        # The machine gets the same depth from this fraction.
        made[rows, columns] = (read.astype(np.uint64) * _WIDEST + farthest // np.uint64(2)) // farthest
    return made


def stencil_read(gl: Any, box: tuple[int, int, int, int], size: tuple[int, int]) -> NDArray[np.uint8]:
    """The stencil values of a box, as ``colors_read``: [height, width]."""
    made = np.zeros((box[3], box[2]), np.uint8)
    read, rows, columns = _read(gl, box, size, "STENCIL_INDEX")
    if read is not None:
        made[rows, columns] = read
    return made
