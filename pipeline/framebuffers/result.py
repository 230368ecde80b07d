"""The Result of a frame: framebuffers, textures, pixels, and on request a trace and fragments."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.framebuffers.pictures import Pictured, deep_picture
from fixedpipe.pipeline.framebuffers.snapshot import Snapshot
from fixedpipe.pipeline.framebuffers.transfer import HistogramTable, MinmaxTable
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import Texture


@dataclass(frozen=True, eq=False)
class Fragments:
    """Fragments as columns, all int32 [n]: primitive number, device pixel x and y (y down), and 1 where the
    fragment passed the per-fragment tests (0 where not; coverage alone says 1). A rectangle of pixels has
    the group's number instead, counted row by row from the lower left.

    ``covered``: how many of the machine's samples a primitive covers where it is smooth; None, or 0: it is
    not. Per pixel they are in draw order. ``places``: where the Draw's primitives are, as
    ``WindowPrimitives.places`` digests it; None: a rectangle of pixels, or nothing is left to draw.
    """

    triangle: NDArray[np.int32]
    x: NDArray[np.int32]
    y: NDArray[np.int32]
    passed: NDArray[np.int32]
    covered: NDArray[np.int32] | None = None
    places: tuple[bytes, bytes] | None = None


@dataclass(frozen=True, eq=False)
class Result(Pictured):
    """What running commands gave. A notebook shows its picture, ``save`` writes it.

    profile       the machine that drew
    framebuffer   the window's framebuffer, top row first (the same object in every Result of one Machine)
    surfaces      the pbuffers' framebuffers by name (the same objects likewise)
    textures      texture objects by name, as they are afterwards, bottom row first
    pixels        what each ReadPixels and GetTexImage read, by its name, bottom row first
    fragments     how many fragments the Draws and rectangles of pixels made
    dropped       how many primitives were dropped because a projected position was not usable
    undefined     how many groups of pixel textures had no positive q, which then counted as 1
    trace         a Snapshot after every command, those that a HostStep issued among them, when asked for
    records       the Fragments of every Draw and rectangle of pixels, when asked for
    histograms    the machine's histograms by name, as they are afterwards
    minmaxes      its minmaxes likewise
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

    @property
    def bits(self) -> int:
        """How many bits a component of a colour has: 8, InfiniteReality's 12."""
        return self.framebuffer.color_bits

    def image(self) -> NDArray[np.uint8]:
        """The framebuffer's colours as bytes, uint8 [h, w, 4], top row first: of components of other widths
        the nearest byte (``codes`` has them as they are).
        """
        return self.framebuffer.image()

    def codes(self) -> NDArray[np.int32]:
        """The framebuffer's colours as they are, int32 [h, w, 4], top row first; 0 .. 2**bits - 1, even where
        the machine does not clamp.
        """
        return np.clip(self.framebuffer.color, 0, 2**self.bits - 1).astype(np.int32)

    def deep_image(self) -> NDArray[np.uint8 | np.uint16]:
        """``image()``, or of more than 8 bits a component uint16, 65535 = full, to nearest."""
        return self.image() if self.bits <= 8 else deep_picture(self.codes(), self.bits)
