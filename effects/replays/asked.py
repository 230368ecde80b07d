"""The frames of a trace that a user requests: their pictures, and where reading the trace can end."""

from collections.abc import Iterable
from dataclasses import dataclass

_ENDLESS = 1 << 62
_MOST_COUNTED = 1 << 20  # the most frames of one range


@dataclass(frozen=True)
class FramesAsked:
    """Frames by their numbers, from 0.

    - ``ranges``: (first, last) of each range; None: the first frame that draws something.
    - ``text``: the request as it was written.
    """

    ranges: tuple[tuple[int, int], ...] | None
    text: str

    @classmethod
    def of(cls, text: str | None) -> "FramesAsked":
        """The frames of ``3,10-20`` or ``all``; None: the first that draws. Raises ValueError."""
        if text is None:
            return cls(None, "the first frame that draws")
        if text.strip() == "all":
            return cls(((0, _ENDLESS),), "all")
        ranges = []
        for part in text.split(","):
            first, dash, last = (number.strip() for number in part.partition("-"))
            if not first.isdecimal() or (dash and not last.isdecimal()):
                raise ValueError(f"--frames is {text!r}; give numbers from 0, as 3,10-20, or all.")
            ranges.append((int(first), int(last) if dash else int(first)))
            if ranges[-1][0] > ranges[-1][1]:
                raise ValueError(f"--frames has {part.strip()}, which ends before it begins.")
            if ranges[-1][1] - ranges[-1][0] > _MOST_COUNTED:
                raise ValueError(f"--frames has {part.strip()}, which are too many; give all.")
        return cls(tuple(ranges), text)

    @property
    def count(self) -> int | None:
        """How many frames are requested; None: all of them."""
        if self.ranges is None:
            return 1
        if self.last is None:
            return None
        return len({number for first, last in self.ranges for number in range(first, last + 1)})

    @property
    def last(self) -> int | None:
        """The number of the last requested frame; None: all are requested, or it is unknown."""
        if self.ranges is None:
            return None
        last = max(last for _, last in self.ranges)
        return None if last == _ENDLESS else last

    def may_want(self, number: int) -> bool:
        """Whether the frame of that number may be requested."""
        return self.ranges is None or any(first <= number <= last for first, last in self.ranges)

    def wants(self, number: int, draws: int) -> bool:
        """Whether the frame of that number, with so many draws, is requested."""
        return draws > 0 if self.ranges is None else self.may_want(number)

    def is_over(self, number: int, draws: int) -> bool:
        """Whether no later frame is requested."""
        if self.ranges is None:
            return draws > 0
        return self.last is not None and number >= self.last

    def missing(self, found: Iterable[int]) -> list[int]:
        """The requested numbers, one by one or in ranges, of frames that do not exist."""
        if self.ranges is None or self.last is None:
            return []
        there = set(found)
        return sorted(
            number for first, last in self.ranges for number in range(first, last + 1) if number not in there
        )
