"""Two renderers beside a chip: how many pixels of the captures each draws, in the same regions."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.conformance.redraw import Comparison
from fixedpipe.effects.refusal import Refusal


@dataclass(frozen=True)
class Score:
    """How well a renderer's pictures agree with captures.

    cases, exact               pictures that were compared, and those in which every compared pixel is equal
    pixels, equal, within_one  compared pixels, equal ones, and those in which no component differs by more
                               than one
    largest                    the largest difference of a component
    missing                    captures for which the renderer has no picture, or one of another size
    """

    cases: int = 0
    exact: int = 0
    pixels: int = 0
    equal: int = 0
    within_one: int = 0
    largest: int = 0
    missing: int = 0

    @classmethod
    def of(cls, drawn: NDArray[np.uint8], captured: NDArray[np.uint8], mask: NDArray[np.bool_]) -> "Score":
        """Of one picture, uint8 [h, w, 4], where ``mask`` says."""
        apart = np.abs(drawn.astype(np.int16) - captured).max(axis=2)[mask]
        equal, pixels = int((apart == 0).sum()), int(mask.sum())
        within = int((apart <= 1).sum())
        return cls(1, int(equal == pixels), pixels, equal, within, int(apart.max(initial=0)), 0)

    def __add__(self, other: "Score") -> "Score":
        added = {f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)}
        return Score(**(added | {"largest": max(self.largest, other.largest)}))


@dataclass(frozen=True)
class Row:
    """A case, or a suite, by two renderers: ours, and the other."""

    ours: Score = Score()
    other: Score = Score()

    def __add__(self, more: "Row") -> "Row":
        return Row(self.ours + more.ours, self.other + more.other)


def row_of(comparison: Comparison, other: NDArray[np.uint8] | None) -> Row:
    """The Row of a covered Comparison and the other renderer's picture. Where it has none, None, the capture
    counts as missing, and for neither renderer.
    """
    c = comparison
    if other is None:
        return Row(other=Score(missing=1))
    return Row(Score.of(c.ours, c.theirs, c.compared), Score.of(other, c.theirs, c.compared))


def reader(folder: Path) -> Callable[[str, str], NDArray[np.uint8] | None]:
    """A function that reads the other renderer's picture FOLDER/SUITE/CASE.png, uint8 [h, w, 4]; None if
    there is none of a capture's size. Raises Refusal for a file that is no picture.
    """
    from PIL import Image

    def read(suite, case):
        path = folder / suite / f"{case}.png"
        if not path.is_file():
            return None
        try:
            with Image.open(path) as image:
                if image.size != (WIDTH, HEIGHT):
                    return None
                return np.array(image.convert("RGBA"))
        # A decoder fed arbitrary bytes raises whatever it stumbles over.
        except Exception as error:
            raise Refusal(f"{path} cannot be read: it is no whole picture. Write it anew.") from error

    return read
