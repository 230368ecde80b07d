"""A share of many tests that are alike, another one with each change: ``make test-all`` has them all.

Which share it is depends on the date of the change alone, that of the last commit, never on a clock: who
tests a commit again tests the same.
"""

import hashlib
import os
import re
import subprocess
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import settings

_ROOT = Path(__file__).parents[2]
# What the process of all tests hands to those that it starts, so that all of them take the same tests.
DATE, CHANGED = "FIXEDPIPE_SAMPLE_DATE", "FIXEDPIPE_SAMPLE_CHANGED"
# After a change all tests of the packages that it touches are run, and of the others' one in SHARE. Those of
# pipeline/golden/ lie in tests/pipeline/golden/; others, by how their names begin, are of these packages.
SHARE = 6
WIDE = 12  # a change of more folders is tested by shares alone, of one in WIDE_SHARE
WIDE_SHARE = 3
OF = {
    "tests/browser/": ("effects/viewer/", "effects/reports/gallery/", "effects/reports/viewing/"),
    "tests/effects/test_own_maps": ("effects/user_pictures/",),
    "tests/emulators/": ("effects/emulators/",),
    "tests/foreign/": ("pipeline/execution/", "pipeline/opengl/"),
    "tests/pipeline/execution/": ("pipeline/execution/", "pipeline/native/", "pipeline/columns/", "raster/"),
    "tests/pipeline/selftest/": ("pipeline/selftest/", "pipeline/execution/", "raster/"),
    "tests/project/test_bench": ("bench/",),
    "tests/project/test_notebooks": ("docs/examples/",),
    "tests/raster/": ("raster/", "tests/reference/"),
}
# Not what lies in tests/effects itself: figures, which have a share of their own.
_BY_PLACE = re.compile(r"tests/((?:pipeline|effects)/\w+/)|tests/(pipeline/)")
LEAST_EXAMPLES = 30  # of each test that Hypothesis gives its values
_SETTINGS = "_hypothesis_internal_use_settings"  # where Hypothesis keeps those of a test


def _git(*arguments):
    """What git prints; nothing where there is none, or no checkout."""
    with suppress(OSError):
        run = ["git", *arguments]
        return subprocess.run(run, cwd=_ROOT, capture_output=True, text=True, check=False).stdout
    return ""


def say_the_change():
    """Note the last commit's date, and which files it or the user has changed, for processes started here.

    What is noted already stays: so may somebody else's share be tested again.
    """
    os.environ.setdefault(DATE, _git("show", "-s", "--format=%cI", "HEAD").strip())
    os.environ.setdefault(CHANGED, _git("diff", "--name-only", "HEAD~1"))


def _number(text, share):
    return int(hashlib.sha256(text.encode()).hexdigest(), 16) % share


def _touched():
    """The files that the last commit or the user has changed, by place, and whether in many folders."""
    files = set(os.environ.get(CHANGED, "").split())
    return files, len({file.rpartition("/")[0] for file in files}) > WIDE


def changed():
    """The files that have changed, whose own tests are all run; none where they are in too many folders."""
    files, is_wide = _touched()
    return set() if is_wide else files


def share():
    """Of how many tests one is taken after this change."""
    return WIDE_SHARE if _touched()[1] else SHARE


def turn(of):
    """The number, below ``of``, of the sample that is taken after this change."""
    return _number(os.environ.get(DATE, ""), of)


def sampled(keys, *, order=None):
    """A share of ``keys``, as a set: sorted by cost, ``order``, samples take about as long."""
    return set(sorted(keys, key=order)[turn(share()) :: share()])


def sources_of(test):
    """Where a test and what it proves lie, as beginnings of paths; none for one that is always run."""
    for begins, sources in OF.items():
        if test.startswith(begins):
            return (begins, *sources)
    if place := _BY_PLACE.match(test):
        return place[0], place[1] or place[2]
    return ()


def take_turns(items):
    """Mark as slow what waits for its turn, by its name alone: so it is the same for any choice of tests."""
    touched, of = changed(), share()
    now = turn(of)
    for item in items:
        own = sources_of(item.nodeid)
        if own and _number(item.nodeid, of) != now and not any(path.startswith(own) for path in touched):
            item.add_marker(pytest.mark.slow)


def fewer_examples(items, one_in):
    """Let Hypothesis try one in ``one_in`` of a test's examples, and no fewer than LEAST_EXAMPLES.

    They are the first of those that are tried where all are.
    """
    functions = {getattr(item, "obj", None) for item in items} if one_in > 1 else ()
    for test in functions:
        test = getattr(test, "__func__", test)
        said = getattr(test, _SETTINGS, None)
        if said and (count := max(said.max_examples // one_in, LEAST_EXAMPLES)) < said.max_examples:
            setattr(test, _SETTINGS, settings(said, max_examples=count))


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
    return own | sampled(FIGURES, order=lambda figure: (SECONDS.get(figure, 0.0), figure))
