"""Compare many captures, several at a time, in order; what goes wrong in one case stays that case's."""

from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields

import numpy as np

from fixedpipe.effects.conformance.redraw import Comparison, compare
from fixedpipe.pipeline.native.threads import default_threads


@dataclass(frozen=True, eq=False)
class Capture:
    """A capture by its names; ``read()`` gives its pixels, uint8 [HEIGHT, WIDTH, 4]."""

    suite: str
    name: str
    read: Callable[[], np.ndarray]


def _compare(capture, module, inputs):
    theirs = capture.read()
    try:
        return compare(capture.suite, module, capture.name, theirs, inputs, threads=1)
    # A case is a program of its own: whatever stops it, the other cases' results are worth having.
    except Exception as error:
        note = f"{type(error).__name__}: {' '.join(str(error).split())}"
        return Comparison(suite=capture.suite, name=capture.name, theirs=theirs, failed=True, note=note)


def compare_all(captures, modules, inputs, threads=None):
    """Yield the Comparison of every Capture, in their order.

    ``modules``: of the suites, by name (``known_suites()``). ``inputs``: an Inputs. ``threads``: cases at a
    time; None: one per processor. The bits are the same for any number. What ``read`` raises is raised here;
    what a case raises is its Comparison's note.
    """
    pending = deque()
    threads = threads or default_threads()
    with ThreadPoolExecutor(threads, "fixedpipe-case") as pool:
        try:
            for capture in captures:
                pending.append(pool.submit(_compare, capture, modules.get(capture.suite), inputs))
                if len(pending) > 2 * threads:  # no more: each holds its pictures until it is taken
                    yield pending.popleft().result()
            while pending:
                yield pending.popleft().result()
        finally:
            for case in pending:
                case.cancel()


@dataclass(frozen=True)
class Totals:
    """How many cases and pixels agree. ``cases`` counts the covered ones."""

    exact: int = 0
    cases: int = 0
    pixels_equal: int = 0
    pixels_compared: int = 0
    not_covered: int = 0

    @classmethod
    def of(cls, comparison):
        """The totals of one Comparison."""
        c = comparison
        return cls(int(c.exact), int(c.covered), c.pixels_equal, c.pixels_compared, int(not c.covered))

    def __add__(self, other):
        return Totals(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))

    def __str__(self):
        return (
            f"exact: {self.exact} of {self.cases} cases; pixels: {self.pixels_equal} of "
            f"{self.pixels_compared}; not covered: {self.not_covered}"
        )
