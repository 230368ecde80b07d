"""How two pictures differ: in size, type or components, or in how many pixels, where, and by how much."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.uint8 | np.uint16]
_COMPONENTS = {1: "grey", 2: "grey and alpha", 3: "colour", 4: "colour and alpha"}


@dataclass(frozen=True)
class Difference:
    """The difference of two pictures of one size, type and number of components, whose pixels are codes.

    - ``count``: the number of pixels that differ in any component.
    - ``largest``: the largest difference of a component, in codes.
    - ``box``: (x0, y0, x1, y1) around these pixels, half open, row 0 at the top.
    - ``pixel``: (x, y) of the first pixel, row by row, with the largest difference.
    - ``first``, ``second``: that pixel in both pictures.
    - ``alpha_alone``: whether only alpha differs.
    """

    count: int
    largest: int
    box: tuple[int, int, int, int]
    pixel: tuple[int, int]
    first: tuple[int, ...]
    second: tuple[int, ...]
    alpha_alone: bool

    def __str__(self) -> str:
        return self.told("now")

    def told(self, second: str) -> str:
        """The difference in words; ``second`` introduces the second picture's pixel."""
        x0, y0, x1, y1 = self.box
        of = ", in alpha alone" if self.alpha_alone else ""
        pixels = "1 pixel differs" if self.count == 1 else f"{self.count} pixels differ"
        where = f"from ({x0}, {y0}) to ({x1 - 1}, {y1 - 1}); most at" if self.count > 1 else "at"
        both = f"{self.first}, {second} {self.second}"
        return f"{pixels} by at most {self.largest}{of}, {where} {self.pixel}: {both}"


def said(pixels: Pixels) -> str:
    """A picture's size, components and type in words."""
    height, width, components = pixels.shape
    return f"{width}x{height} pixels of {_COMPONENTS[components]}, {pixels.dtype}"


def kinds_differ(first: Pixels, second: Pixels) -> str:
    """A sentence on why two pictures cannot be compared pixel by pixel; empty where they can."""
    if (first.shape, first.dtype) == (second.shape, second.dtype):
        return ""
    return f"one picture is {said(first)}, the other {said(second)}"


def difference(first: Pixels, second: Pixels) -> Difference | None:
    """The Difference of two pictures in the form of ``pixels_of``, or None where all pixels are equal.

    Raises ValueError where their sizes, types or numbers of components differ.
    """
    if sentence := kinds_differ(first, second):
        raise ValueError(f"Pictures of different kinds have no pixels to compare: {sentence}.")
    apart = np.abs(first.astype(np.int32) - second)
    largest = apart.max(axis=2)
    rows, columns = np.nonzero(largest)
    if not len(rows):
        return None
    y, x = (int(n) for n in np.unravel_index(int(largest.argmax()), largest.shape))
    box = int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1
    has_alpha = first.shape[2] in (2, 4)
    return Difference(
        len(rows),
        int(largest.max()),
        box,
        (x, y),
        tuple(first[y, x].tolist()),
        tuple(second[y, x].tolist()),
        bool(has_alpha and not apart[..., :-1].any()),
    )


def bounds(given: int | Sequence[int], name: str) -> tuple[int, int]:
    """(least, most) of a pair, or of a number, which is the most; both inclusive.

    The web platform's fuzzy reftests have such bounds. Raises ValueError for anything else.
    """
    pair = (0, given) if isinstance(given, int) else tuple(given)
    fits = len(pair) == 2 and all(isinstance(n, int) and not isinstance(n, bool) for n in pair)
    if not fits or not 0 <= pair[0] <= pair[1]:
        raise ValueError(
            f"{name} is {given!r}; give a whole number from 0 on, or a pair (least, most) of them."
        )
    return pair
