"""What becomes of a call: drawn, without effect, an error, refused; and how often each came."""

from collections.abc import Iterator
from typing import NamedTuple


class GLError(Exception):
    """An error as OpenGL has them: the call is ignored, and GetError tells ``kind`` (a token)."""

    def __init__(self, kind: int, sentence: str = ""):
        super().__init__(sentence)
        self.kind = kind


class Refused(Exception):  # noqa: N818
    """A call that cannot be carried out here; the message says why. What follows goes on."""


class LeftOut(Exception):  # noqa: N818
    """A draw that OpenGL leaves undefined (NaN, a singular matrix that is inverted); it is not drawn."""


class Outcome(NamedTuple):
    """What happened, in words; the number of the first call that it happened to, and how often."""

    what: str
    first_call: int
    count: int


class Tally:
    """Counts outcomes by kind: "drawn", "no effect", "error", "refused", "left out", "lit here", "unknown".

    ``call`` is the number of the call that is being answered. At most ``limit`` sentences of a kind are kept
    apart; the rest are counted together, so that a program cannot fill the memory with them.
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
