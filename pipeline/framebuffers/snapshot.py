"""A trace: pictures of the framebuffer's contents after each command."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The framebuffer, or the current pbuffer, after one command.

    - ``label``: the command's label.
    - ``kind``: the name of the command's type.
    - ``color``: uint8 [h, w, 4].
    - ``depth``: uint32 [h, w], words of ``depth_bits`` bits.
    - ``stencil``: uint8 [h, w].

    The top row is first.
    """

    label: str
    kind: str
    color: NDArray[np.uint8]
    depth: NDArray[np.uint32]
    stencil: NDArray[np.uint8]
    depth_bits: int

    def pictures(self) -> dict[str, NDArray[np.uint8]]:
        """{"color": RGB, "alpha": grey, "depth": grey, "stencil": grey}, uint8, for saving.

        Depth shows its full range as 0..255. The stencil's values are unchanged.
        """
        return {
            "color": self.color[..., :3].copy(),
            "alpha": self.color[..., 3].copy(),
            "depth": (self.depth >> (self.depth_bits - 8)).astype(np.uint8),
            "stencil": self.stencil.copy(),
        }


def snapshot(command: Command, framebuffer: Framebuffer) -> Snapshot:
    """A copy of the framebuffer; colours of other widths become bytes."""
    return Snapshot(
        command.label,
        type(command).__name__,
        framebuffer.image(),
        framebuffer.depth.copy(),
        framebuffer.stencil.copy(),
        framebuffer.depth_bits,
    )
