"""Compare many captures, several at a time, in order. An error in one case does not stop the others."""

import multiprocessing
import warnings
from collections import deque
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass, fields
from functools import partial

import numpy as np

from fixedpipe.effects.conformance.redraw import Comparison, compare, known_suites
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


def compare_all(captures, suites, inputs, threads=None, profile=NV2A, jobs=None):
    """Yield the Comparison of every Capture, in their order.

    ``suites``: by name (``known_suites()``). ``inputs``: an Inputs. ``threads``: cases at a
    time; None: one per processor. ``jobs``: cases at a time, each in a process of its own, which finds the
    suites itself; the captures' ``read`` has to be picklable then. ``profile``: the machine. The bits are the
    same for any number. What ``read`` raises is raised here; what a case raises is its Comparison's note.
    """
    if jobs is None:
        threads = threads or default_threads()
        with ThreadPoolExecutor(threads, "fixedpipe-case") as pool:
            submit = partial(pool.submit, _compare)
            yield from _in_order(
                submit, ((c, suites.get(c.suite), inputs, profile) for c in captures), threads
            )
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, context, _find_suites) as pool:
        submit = partial(pool.submit, _compare_there)
        yield from _in_order(submit, ((c, inputs, profile) for c in captures), jobs)


def _in_order(submit, given, workers):
    pending = deque()
    try:
        for arguments in given:
            pending.append(submit(*arguments))
            if len(pending) > 2 * workers:  # no more: each holds its pictures until it is taken
                yield pending.popleft().result()
        while pending:
            yield pending.popleft().result()
    finally:
        for case in pending:
            case.cancel()


_suites = {}  # of a process that compares cases


def _find_suites():
    warnings.simplefilter("ignore", DisabledTexture)  # captures are what a chip drew of it
    _suites.update(known_suites())


def _compare_there(capture, inputs, profile):
    return _compare(capture, _suites.get(capture.suite), inputs, profile)


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
