"""How two pictures differ: in what they are, or in how many pixels, where, and by how much."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.uint8 | np.uint16]
_COMPONENTS = {1: "grey", 2: "grey and alpha", 3: "colour", 4: "colour and alpha"}


@dataclass(frozen=True)
class Difference:
    """How pictures of one size, type and number of components differ, whose pixels are codes.

    count            how many pixels do, in any component
    largest          the largest difference of a component, codes
    box              (x0, y0, x1, y1) that holds them, half open, row 0 is the top one
    pixel            (x, y), the first, row by row, of those that differ by the largest
    first, second    that pixel in both pictures
    alpha_alone      whether no other component than alpha differs
    """

    count: int
    largest: int
    box: tuple[int, int, int, int]
    pixel: tuple[int, int]
    first: tuple[int, ...]
    second: tuple[int, ...]
    alpha_alone: bool

    def __str__(self) -> str:
        x0, y0, x1, y1 = self.box
        of = ", in alpha alone" if self.alpha_alone else ""
        pixels = "1 pixel differs" if self.count == 1 else f"{self.count} pixels differ"
        where = f"from ({x0}, {y0}) to ({x1 - 1}, {y1 - 1}); most at" if self.count > 1 else "at"
        return (
            f"{pixels} by at most {self.largest}{of}, {where} {self.pixel}: {self.first}, now {self.second}"
        )


def said(pixels: Pixels) -> str:
    """What a picture is, without its pixels."""
    height, width, components = pixels.shape
    return f"{width}x{height} pixels of {_COMPONENTS[components]}, {pixels.dtype}"


def kinds_differ(first: Pixels, second: Pixels) -> str:
    """A sentence on why two pictures cannot be compared pixel by pixel; empty where they can."""
    if (first.shape, first.dtype) == (second.shape, second.dtype):
        return ""
    return f"one picture is {said(first)}, the other {said(second)}"


def difference(first: Pixels, second: Pixels) -> Difference | None:
    """The Difference of two pictures as ``pixels_of`` gives them, or None where all pixels are equal.

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
    """Least and most of a number or of a pair (least, most), both inclusive, as fuzzy reftests of the web
    platform have them; a number alone is the most. Raises ValueError for anything else.
    """
    pair = (0, given) if isinstance(given, int) else tuple(given)
    fits = len(pair) == 2 and all(isinstance(n, int) and not isinstance(n, bool) for n in pair)
    if not fits or not 0 <= pair[0] <= pair[1]:
        raise ValueError(
            f"{name} is {given!r}; give a whole number from 0 on, or a pair (least, most) of them."
        )
    return pair
