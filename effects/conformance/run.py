"""Compare many captures, several at a time, in order. An error in one case does not stop the others."""

from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from fixedpipe.effects.conformance.redraw import Comparison, compare
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.pipeline.profiles import NV2A

# Cases for each thread that are drawn, or wait for those before them: each holds its pictures.
_CASES_OF_A_THREAD = 3


@dataclass(frozen=True, eq=False)
class Capture:
    """A capture by its names; ``read()`` gives the pixels of its file ``path``, uint8 [HEIGHT, WIDTH, 4]."""

    suite: str
    name: str
    read: Callable[[], np.ndarray]
    path: Path


def compared(suite, name, theirs, known, inputs, profile):
    """The Comparison of a capture ``theirs``; arguments as of ``redraw.compare``. An exception of the case
    becomes its note.
    """
    try:
        return compare(suite, known, name, theirs, inputs, 1, profile)
    # A case is a program of its own: whatever stops it, the other cases' results are worth having.
    except Exception as error:
        note = f"{type(error).__name__}: {' '.join(str(error).split())}"
        return Comparison(suite=suite, name=name, theirs=theirs, failed=True, note=note)


def compare_all(captures, suites, inputs, threads=None, profile=NV2A):
    """Yield the Comparison of every Capture, in their order.

    suites   by name (``known_suites()``)
    inputs   an Inputs
    threads  cases at a time; None: one per processor
    profile  the machine

    The bits are the same for any number. Exceptions of ``read`` are raised here; a case's exception becomes
    its Comparison's note.
    """
    threads = threads or default_threads()

    def case(capture):
        known = suites.get(capture.suite)
        return compared(capture.suite, capture.name, capture.read(), known, inputs, profile)

    pending: deque = deque()
    with ThreadPoolExecutor(threads, "fixedpipe-case") as pool:
        try:
            for capture in captures:
                pending.append(pool.submit(case, capture))
                if len(pending) >= _CASES_OF_A_THREAD * threads:
                    yield pending.popleft().result()
            while pending:
                yield pending.popleft().result()
        finally:
            for future in pending:
                future.cancel()


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
