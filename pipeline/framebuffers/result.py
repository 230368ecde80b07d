"""The Result of a frame: framebuffers, textures, pixels, and on request a trace and fragments."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.framebuffers.pictures import Pictured, deep_picture
from fixedpipe.pipeline.framebuffers.snapshot import Snapshot
from fixedpipe.pipeline.framebuffers.transfer import HistogramTable, MinmaxTable
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import Texture

if TYPE_CHECKING:  # The vertex stage knows no framebuffer, and this module calls no vertex stage.
    from fixedpipe.pipeline.vertices.primitives import WindowPrimitives


@dataclass(frozen=True, eq=False)
class Fragments:
    """Fragments as columns, all int32 [n], in draw order for each pixel.

    - ``triangle``: the primitive's number. For a rectangle of pixels: the group's number, counted row by row
      from the lower left.
    - ``x``, ``y``: the device pixel, y down.
    - ``passed``: 1 where the fragment passed the per-fragment tests, else 0; coverage alone says 1.
    - ``covered``: the number of the machine's samples that a smooth primitive covers; None or 0: it is not
      smooth.
    - ``command``, ``primitives``: the Draw, and the primitives that the machine drew. None: a rectangle of
      pixels, nothing is left to draw, or they were too many to be kept.
    """

    triangle: NDArray[np.int32]
    x: NDArray[np.int32]
    y: NDArray[np.int32]
    passed: NDArray[np.int32]
    covered: NDArray[np.int32] | None = None
    command: Draw | None = None
    primitives: "WindowPrimitives | None" = None

    @cached_property
    def places(self) -> tuple[bytes, bytes] | None:
        """The digests of the Draw's primitives, ``WindowPrimitives.places``.

        None: a rectangle of pixels, or nothing is left to draw.
        """
        return None if self.primitives is None else self.primitives.places()

    def without_primitives(self) -> "Fragments":
        """The same Fragments, which keep no more than ``places`` of the primitives."""
        made = replace(self, command=None, primitives=None)
        made.__dict__["places"] = self.places
        return made


@dataclass(frozen=True, eq=False, repr=False)
class Result(Pictured):
    """The results of running commands. A notebook shows its picture, and ``save`` writes it.

    - ``profile``: the machine that drew.
    - ``framebuffer``: the window's, top row first (the same object in every Result of one Machine).
    - ``surfaces``: the pbuffers' framebuffers by name (the same objects likewise).
    - ``textures``: texture objects by name, in their final state, bottom row first.
    - ``pixels``: the pixels that each ReadPixels and GetTexImage read, by its name, bottom row first.
    - ``fragments``: the number of fragments of the Draws and rectangles of pixels.
    - ``dropped``: the number of primitives dropped because a projected position was not usable.
    - ``undefined``: the number of pixel texture groups without a positive q, which then counted as 1.
    - ``trace``: a Snapshot after every command, also after those that a HostStep issued, when requested.
    - ``records``: the Fragments of every Draw and rectangle of pixels, when requested.
    - ``histograms``: the machine's histograms by name, in their final state.
    - ``minmaxes``: the machine's minmaxes likewise.
    """

    profile: Profile
    framebuffer: Framebuffer
    surfaces: dict[str, Framebuffer]
    textures: dict[str, Texture]
    pixels: dict[str, NDArray[Any]]
    fragments: int
    dropped: int
    undefined: int
    trace: tuple[Snapshot, ...]
    records: tuple[Fragments, ...]
    histograms: dict[str, HistogramTable]
    minmaxes: dict[str, MinmaxTable]

    def __repr__(self) -> str:
        """A short description, without its arrays."""
        height, width = self.framebuffer.color.shape[:2]
        return f"<a frame on {self.profile.name}, {width}x{height} pixels>"

    @property
    def bits(self) -> int:
        """The number of bits of a colour component: 8, or InfiniteReality's 12."""
        return self.framebuffer.color_bits

    def image(self) -> NDArray[np.uint8]:
        """The framebuffer's colours as bytes, uint8 [h, w, 4], top row first.

        Components of other widths are rounded to the nearest byte; ``codes`` has their own values.
        """
        return self.framebuffer.image()

    def codes(self) -> NDArray[np.int32]:
        """The framebuffer's colours at their own width, int32 [h, w, 4], top row first, in 0 .. 2**bits - 1.

        They are clamped even if the machine does not clamp.
        """
        return np.clip(self.framebuffer.color, 0, 2**self.bits - 1).astype(np.int32)

    def deep_image(self) -> NDArray[np.uint8 | np.uint16]:
        """``image()``, or, with more than 8 bits a component, uint16 rounded to nearest, 65535 = full."""
        return self.image() if self.bits <= 8 else deep_picture(self.codes(), self.bits)
