"""A trace: what the framebuffer held after each command, as pictures."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The framebuffer, or the current pbuffer, after one command.

    label    the command's label; kind: its type's name
    color    uint8 [h, w, 4], depth uint32 [h, w], stencil uint8 [h, w]; top row first
    depth_bits
    """

    label: str
    kind: str
    color: NDArray[np.uint8]
    depth: NDArray[np.uint32]
    stencil: NDArray[np.uint8]
    depth_bits: int

    def pictures(self) -> dict[str, NDArray[np.uint8]]:
        """{"color": RGB, "alpha": grey, "depth": grey, "stencil": grey}, uint8, for saving.

        Depth shows its full range as 0..255; the stencil's values are shown as they are.
        """
        return {
            "color": self.color[..., :3].copy(),
            "alpha": self.color[..., 3].copy(),
            "depth": (self.depth >> (self.depth_bits - 8)).astype(np.uint8),
            "stencil": self.stencil.copy(),
        }


def snapshot(command: Command, framebuffer: Framebuffer) -> Snapshot:
    """Copy the framebuffer, colours of other widths as bytes."""
    return Snapshot(
        command.label,
        type(command).__name__,
        framebuffer.image(),
        framebuffer.depth.copy(),
        framebuffer.stencil.copy(),
        framebuffer.depth_bits,
    )
