"""Compare many captures, several at a time, in order. An error in one case does not stop the others."""

import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from functools import cache

import numpy as np

from fixedpipe.effects.conformance.redraw import Comparison, compare, known_suites
from fixedpipe.effects.tasks.executors import of_user
from fixedpipe.effects.tasks.ordered import in_order
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.validation.walk import DisabledTexture


@dataclass(frozen=True, eq=False)
class Capture:
    """A capture by its names; ``read()`` gives its pixels, uint8 [HEIGHT, WIDTH, 4]."""

    suite: str
    name: str
    read: Callable[[], np.ndarray]


def _compare(capture, suite, inputs, profile):
    theirs = capture.read()
    try:
        return compare(capture.suite, suite, capture.name, theirs, inputs, 1, profile)
    # A case is a program of its own: whatever stops it, the other cases' results are worth having.
    except Exception as error:
        note = f"{type(error).__name__}: {' '.join(str(error).split())}"
        return Comparison(suite=capture.suite, name=capture.name, theirs=theirs, failed=True, note=note)


def compare_all(captures, suites, inputs, threads=None, profile=NV2A, executor=None):
    """Yield the Comparison of every Capture, in their order.

    suites    by name (``known_suites()``)
    inputs    an Inputs
    threads   cases at a time; None: one per processor
    profile   the machine
    executor  a ``concurrent.futures.Executor`` in place of threads; its workers find the suites themselves,
              and the captures' ``read`` has to be picklable

    The bits are the same for any number and any executor. What ``read`` raises is raised here; what a case
    raises is its Comparison's note. Raises Refusal as ``tasks.ordered.in_order``.
    """
    if executor is None:
        with ThreadPoolExecutor(threads or default_threads(), "fixedpipe-case") as pool:
            cases = ((c, suites.get(c.suite), inputs, profile) for c in captures)
            yield from in_order(of_user(pool), _compare, cases)
        return
    cases = ((c, inputs, profile) for c in captures)
    yield from in_order(of_user(executor), _compare_there, cases, _said)


def _said(capture, *_):
    return f"{capture.suite}/{capture.name}"


@cache
def _suites():
    """Of a process that compares cases."""
    warnings.simplefilter("ignore", DisabledTexture)  # captures are what a chip drew of it
    return known_suites()


def _compare_there(capture, inputs, profile):
    return _compare(capture, _suites().get(capture.suite), inputs, profile)


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
