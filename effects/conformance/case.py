"""A case: what a capture's program drew, and the pixels that the chip alone decides."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from inspect import signature
from pathlib import Path

import numpy as np

from fixedpipe.pipeline.commands import Command

WIDTH, HEIGHT = 640, 480  # pixels of every capture
MOST_EXCLUDED = 0.001  # of a case's region

Box = tuple[int, int, int, int]  # device pixels, half open: left, top, right, bottom; row 0 is the top one


class Shows(IntEnum):
    """Which buffer a capture holds: the colours, or the depth words as colours. The processor read these
    words or, with 16 bits as R5G6B5, a texture that the program then drew.
    """

    COLOR = 0
    ZETA = 1
    ZETA_TEXTURE = 2


SHOWS = {"": Shows.COLOR, "_ZB": Shows.ZETA}  # by what ends a case's name, in suites that capture both


@dataclass(frozen=True, eq=False, kw_only=True)
class Exclusion:
    """Pixels that are not compared: bool [HEIGHT, WIDTH], found from the geometry alone, and why."""

    pixels: np.ndarray
    reason: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Case:
    """What a program drew, and where to compare. Raises ValueError for a region that cannot be compared.

    commands     the frame, on a 640x480 window
    region       boxes that are compared, without the text that the processor drew over the picture
    exclusions   pixels inside them whose rule is not decidable; at most MOST_EXCLUDED of the region
    shows        which buffer the capture holds
    depth_bits   of the window's depth buffer, or its DepthFormat
    explanation  one line on why pixels differ, where some are known to; empty: all agree
    """

    commands: tuple[Command, ...]
    region: tuple[Box, ...] = ((0, 0, WIDTH, HEIGHT),)
    exclusions: tuple[Exclusion, ...] = ()
    shows: Shows = Shows.COLOR
    depth_bits: int = 24
    explanation: str = ""

    def __post_init__(self):
        for left, top, right, bottom in self.region:
            if not (0 <= left < right <= WIDTH and 0 <= top < bottom <= HEIGHT):
                raise ValueError(
                    f"The box {left}, {top}, {right}, {bottom} is no part of a {WIDTH}x{HEIGHT} picture."
                )
        if "\n" in self.explanation:
            raise ValueError("An explanation is one line.")
        region, compared = int(self._inside().sum()), int(self.compared().sum())
        if region - compared > MOST_EXCLUDED * region:
            raise ValueError(
                f"{region - compared} of the region's {region} pixels are excluded; at most "
                f"{MOST_EXCLUDED:.1%} may be."
            )

    @classmethod
    def of(cls, commands, *given):
        """The case whose frame is ``commands(*given)``, compared everywhere."""
        return cls(commands=tuple(commands(*given)))

    def _inside(self):
        pixels = np.zeros((HEIGHT, WIDTH), bool)
        for left, top, right, bottom in self.region:
            pixels[top:bottom, left:right] = True
        return pixels

    def compared(self):
        """Bool [HEIGHT, WIDTH]: the pixels inside the region and outside all exclusions; text is still among
        them.
        """
        pixels = self._inside()
        for exclusion in self.exclusions:
            pixels &= ~exclusion.pixels
        return pixels


class MissingInput(ValueError):  # noqa: N818 (it names what is missing)
    """A case needs a texture or mesh file that is not there; the message says where it comes from."""


# Other names under which a file of the resources may lie.
_ALSO_CALLED = {"water_bump_map.png": "water.png", "bump_map_test_image.png": "bumpimg.png"}


@dataclass(frozen=True)
class Inputs:
    """The folder of textures and meshes that some cases read (resources of nxdk_pgraph_tests), or None."""

    folder: Path | None

    def path(self, name):
        """The file of that name in the folder or below it. Raises MissingInput."""
        if self.folder is not None:
            for wanted in dict.fromkeys((name, _ALSO_CALLED.get(name, name))):
                for path in (self.folder / wanted, *sorted(self.folder.glob(f"*/{wanted}"))):
                    if path.is_file():
                        return path
        raise MissingInput(f"needs the file {name} of nxdk_pgraph_tests' resources; see --inputs")

    def picture(self, name):
        """The pixels of a PNG file, uint8 [rows, columns, 4], top row first. Raises MissingInput."""
        from PIL import Image

        with Image.open(self.path(name)) as image:
            return np.array(image.convert("RGBA"))


@dataclass(frozen=True, kw_only=True)
class Suite:
    """A suite's cases, each built when it is needed.

    name   the captures' folder
    cases  by name, in order: the function that builds the Case, from nothing or from ``inputs``
    open   one line on why pixels differ, for cases that say nothing themselves; empty: nothing is open
    """

    name: str
    cases: Mapping[str, Callable[..., Case]]
    open: str = ""

    def names(self):
        """The names of the cases, in order."""
        return list(self.cases)

    def case(self, name, inputs):
        """The Case of that name, None where the suite has none. Raises MissingInput."""
        build = self.cases.get(name)
        if build is None:
            return None
        return build(inputs=inputs) if "inputs" in signature(build).parameters else build()
