"""The differences that a test allows its picture: a tolerance, or ignored places, each with a written reason.

Renderers on real GPUs need it; the exact comparison stays the default.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from operator import index
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.golden.differences import Pixels, difference

_HOW = 'golden(picture, at_most=(max_diff, pixels), ignore=[(x0, y0, x1, y1)], reason="why")'


@dataclass(frozen=True)
class Allowance:
    """The differences that a test allows a picture.

    - ``max_diff``, ``pixels``: the largest difference of a component, and the largest number of pixels that
      differ; 0 and 0 allow none.
    - ``compared``: bool [height, width], the pixels that are compared; the others are ignored.
    - ``reason``: the test author's reason, on one line.
    """

    max_diff: int
    pixels: int
    compared: NDArray[np.bool_]
    reason: str

    def judge(self, expected: Pixels, now: Pixels) -> tuple[bool, str]:
        """(whether pictures of one kind differ by no more than this, a sentence on their differences)."""
        ignored = int((np.any(expected != now, axis=2) & ~self.compared).sum())
        apart = difference(expected, np.where(self.compared[..., None], now, expected))
        told = [str(apart)] if apart else []
        if ignored:
            told.append(f"{ignored} pixel{'s differ' if ignored > 1 else ' differs'} where they are ignored")
        if apart is None or (apart.largest <= self.max_diff and apart.count <= self.pixels):
            return True, "; ".join([*told, f"reason: {self.reason}"])
        if self.pixels:
            told.append(f"{self.pixels} may, by at most {self.max_diff}")
        return False, "; ".join(told)


def allowance_of(
    pixels: Pixels,
    at_most: tuple[int, int] | None,
    ignore: Sequence[Sequence[int]] | NDArray[np.bool_] | None,
    reason: str | None,
) -> Allowance | None:
    """The Allowance of a test's arguments, or None where they allow nothing.

    - ``at_most``: (largest difference of a component, most pixels that differ), both 1 or more.
    - ``ignore``: boxes (x0, y0, x1, y1) in the picture, half open, row 0 at the top; or bool [height, width].
    - ``reason``: must be given with either.

    Raises ValueError for anything else, and where no reason is given.
    """
    if at_most is None and ignore is None:
        if reason is not None:
            raise ValueError(
                f"golden(…, reason={reason!r}) comes without an allowance. Give one too: {_HOW}."
            )
        return None
    if not isinstance(reason, str) or not reason.strip():
        raise ValueError(f"golden(…, reason={reason!r}): an allowance needs a reason: {_HOW}.")
    limits = (0, 0) if at_most is None else tuple(at_most) if isinstance(at_most, tuple | list) else ()
    if at_most is not None and (len(limits) != 2 or not all(type(n) is int and n > 0 for n in limits)):
        raise ValueError(
            f"golden(…, at_most={at_most!r}): give the largest difference of a component and the most pixels "
            "that may differ, two whole numbers from 1 on."
        )
    compared = ~_ignored(ignore, *pixels.shape[:2])
    if not compared.any():
        raise ValueError("golden(…, ignore=…) ignores every pixel; nothing would be compared.")
    return Allowance(*limits, compared, " ".join(reason.split()))


def _ignored(ignore: Any, height: int, width: int) -> NDArray[np.bool_]:
    """bool [height, width]: the pixels that are ignored."""
    found = np.zeros((height, width), bool)
    if ignore is None:
        return found
    if isinstance(ignore, np.ndarray):
        if ignore.dtype != bool or ignore.shape != found.shape:
            raise ValueError(
                f"golden(…, ignore=…) is an array of {ignore.dtype} and of shape {ignore.shape}; give bool "
                f"and {found.shape}: a row for each of the picture's, the top one first."
            )
        return ignore
    try:
        boxes = list(ignore)
    except TypeError:
        raise ValueError(f"golden(…, ignore={ignore!r}): give a list of boxes, or a bool array.") from None
    for box in boxes:
        try:
            x0, y0, x1, y1 = (index(n) for n in box)
        except (TypeError, ValueError) as error:
            raise ValueError(f"golden(…, ignore=[{box!r}]): a box is (x0, y0, x1, y1), in pixels.") from error
        if not (0 <= x0 < x1 <= width and 0 <= y0 < y1 <= height):
            raise ValueError(
                f"golden(…, ignore=[{box!r}]): this box is empty or not in the picture, which has {width}x"
                f"{height} pixels. A box is (x0, y0, x1, y1), half open, and row 0 is the top one."
            )
        found[y0:y1, x0:x1] = True
    return found
