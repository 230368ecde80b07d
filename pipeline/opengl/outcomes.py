"""The outcome of a call (drawn, without effect, an error, refused), and how often each one occurred."""

from collections.abc import Iterator
from typing import NamedTuple


class GLError(Exception):
    """An error of OpenGL. The call is ignored, and GetError returns ``kind`` (a token)."""

    def __init__(self, kind: int, sentence: str = ""):
        super().__init__(sentence)
        self.kind = kind


class Refused(Exception):  # noqa: N818
    """A call that cannot be carried out here. The message says why. Later calls are carried out."""


class LeftOut(Exception):  # noqa: N818
    """A draw that is undefined in OpenGL (NaN, the inverse of a singular matrix). It is not drawn."""


class Outcome(NamedTuple):
    """What happened, in words; the number of the first call with this outcome; and how often it occurred."""

    what: str
    first_call: int
    count: int


class Tally:
    """Counts outcomes by kind: "drawn", "no effect", "error", "refused", "left out", "lit here", "unknown".

    ``call`` is the number of the present call. At most ``limit`` sentences of a kind are counted separately.
    The others are counted together, so that a program cannot fill the memory with them.
    """

    def __init__(self, limit: int = 1000):
        self.call = 0
        self._limit = limit
        self._kinds: dict[str, dict[str, list[int]]] = {}

    def add(self, kind: str, what: str, count: int = 1) -> None:
        """Count an outcome of the present call."""
        outcomes = self._kinds.setdefault(kind, {})
        if what not in outcomes and len(outcomes) >= self._limit:
            what = "others"
        found = outcomes.get(what)
        if found is None:
            outcomes[what] = [self.call, count]
        else:
            found[1] += count

    def of(self, kind: str) -> Iterator[Outcome]:
        """The outcomes of a kind, in the order of their first calls."""
        for what, (first, count) in self._kinds.get(kind, {}).items():
            yield Outcome(what, first, count)

    def count(self, kind: str) -> int:
        """How many outcomes of a kind there were."""
        return sum(outcome.count for outcome in self.of(kind))
