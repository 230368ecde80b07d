"""Frames of a trace next to Mesa's pictures of them, which glretrace draws.

glretrace is not always reliable: for some programs it draws nothing, or another picture each time. So it
draws twice, and a picture counts only if both are the same and it is not empty.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.replays import glretrace

# The differences, of 255, within which pixels are counted.
NEAR, FAR = 1, 8
# A picture of differences shows them so many times as large. Assumed: then a difference of 1 can be seen.
_AMPLIFIED = 16


@dataclass(frozen=True)
class Agreement:
    """How close two pictures are: shares of pixels, from 0 to 1. The largest difference of a pixel's channels
    counts, in units of 1/255.

    - ``equal``: the share without a difference; ``near``: within 1; ``far``: within 8.
    - ``largest``: the largest difference of all pixels.
    """

    equal: float
    near: float
    far: float
    largest: int

    @classmethod
    def of(cls, ours: NDArray[np.uint8], theirs: NDArray[np.uint8]) -> "Agreement":
        """The Agreement of two pictures of the same shape, uint8 [h, w, 3]."""
        apart = _apart(ours, theirs).max(axis=-1)
        shares = [float((apart <= limit).mean()) for limit in (0, NEAR, FAR)]
        return cls(*shares, largest=int(apart.max()))

    def __str__(self):
        shares = f"{_percent(self.equal)} equal, {_percent(self.near)} within {NEAR}, "
        return f"{shares}{_percent(self.far)} within {FAR}, largest difference {self.largest}"


def _percent(share):
    """A share in per cent, rounded down, so that only all pixels give 100 %."""
    return f"{int(share * 1e4) / 100:g} %"


def _apart(ours, theirs):
    return np.abs(ours.astype(np.int16) - theirs.astype(np.int16))


def difference_picture(ours: NDArray[np.uint8], theirs: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The differences of two pictures by channel, 16 times as large: uint8 [h, w, 3]."""
    return np.minimum(_apart(ours, theirs) * _AMPLIFIED, 255).astype(np.uint8)


@dataclass(frozen=True, eq=False)
class Beside:
    """Mesa's picture of a frame, and how far it can be trusted.

    - ``picture``: uint8 [h, w, 3], top row first; None: glretrace has none.
    - ``doubt``: why the picture says nothing about the machine; "": it can be compared.
    """

    picture: NDArray[np.uint8] | None
    doubt: str = ""

    def agreement(self, ours: NDArray[np.uint8]) -> Agreement | None:
        """The Agreement with our picture of the frame, uint8 [h, w, 3]; None if nothing can be compared."""
        if self.picture is None or self.picture.shape != ours.shape:
            return None
        return Agreement.of(ours, self.picture)

    def said(self, ours: NDArray[np.uint8]) -> str:
        """The end of a sentence that compares Mesa's picture with ours."""
        if self.picture is None:
            return self.doubt
        found = self.agreement(ours)
        if found is None:
            height, width = self.picture.shape[:2]
            return f"its picture has {width}x{height} pixels"
        return f"{found} ({self.doubt})" if self.doubt else str(found)

    def data(self, ours: NDArray[np.uint8]) -> dict[str, Any]:
        """The comparison as values for JSON."""
        found = self.agreement(ours)
        return {"doubt": self.doubt} | ({} if found is None else vars(found))


def mesas_pictures(path: str, calls: Sequence[int]) -> list[Beside]:
    """Mesa's pictures of a trace after these calls, which end frames. Raises GlretraceError."""
    with glretrace.display() as shown:
        first, second = (glretrace.pictures(shown, path, calls) for _ in range(2))
    return [_judged(first.get(call), second.get(call)) for call in calls]


def _judged(picture, again):
    if picture is None or again is None:
        return Beside(None, "glretrace wrote no picture of this frame")
    if picture.shape != again.shape or (picture != again).any():
        return Beside(picture, "not to be trusted: glretrace drew two different pictures")
    if (picture == picture[0, 0]).all():
        return Beside(picture, "not to be trusted: glretrace drew one colour everywhere")
    return Beside(picture)
