"""A share of many tests that are alike, another one with each change: ``make test-all`` has them all.

Which share it is depends on the date of the change alone, that of the last commit, never on a clock: who
tests a commit again tests the same.
"""

import hashlib
import os
import subprocess
from contextlib import suppress
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[2]
# What the process of all tests hands to those that it starts, so that all of them take the same tests.
DATE, CHANGED = "FIXEDPIPE_SAMPLE_DATE", "FIXEDPIPE_SAMPLE_CHANGED"
FIGURES_SHARE = 6  # of the figures, one in so many


def _git(*arguments):
    """What git prints; nothing where there is none, or no checkout."""
    with suppress(OSError):
        run = ["git", *arguments]
        return subprocess.run(run, cwd=_ROOT, capture_output=True, text=True, check=False).stdout
    return ""


def say_the_change():
    """Note the last commit's date, and which files it or the user has changed, for processes started here."""
    os.environ[DATE] = _git("show", "-s", "--format=%cI", "HEAD").strip()
    os.environ[CHANGED] = _git("diff", "--name-only", "HEAD~1")


def turn(share):
    """The number, below ``share``, of the sample that is taken after this change."""
    return int(hashlib.sha256(os.environ.get(DATE, "").encode()).hexdigest(), 16) % share


def sampled(keys, share, *, order=None):
    """One in ``share`` of ``keys``, as a set: sorted by cost, ``order``, samples take about as long."""
    return set(sorted(keys, key=order)[turn(share) :: share])


def changed():
    """The files that the last commit or the user has changed, by their places in the checkout."""
    return set(os.environ.get(CHANGED, "").split())


def slow_unless(is_tested):
    """The marks of a case that is among the sample, or else belongs to ``make test-all``."""
    return [] if is_tested else [pytest.mark.slow]


def sampled_figures():
    """The ids of the figures whose turn it is, and of those whose own module has changed."""
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.figures.costs import SECONDS

    touched = changed()
    own = {
        figure
        for figure in FIGURES
        if f"{FIGURES.module_of(figure).removeprefix('fixedpipe.').replace('.', '/')}.py" in touched
    }
    return own | sampled(FIGURES, FIGURES_SHARE, order=lambda figure: (SECONDS.get(figure, 0.0), figure))
