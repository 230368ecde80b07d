"""The choice of ``fixedpipe golden accept`` among the pictures that wait."""

import fnmatch
import json
import re
import tempfile
from contextlib import suppress
from pathlib import Path

from fixedpipe.effects.refusal import Refusal, nearest
from fixedpipe.pipeline.golden.candidates import EXCUSED, read_run
from fixedpipe.pipeline.golden.store import StoreError, plain_key

_SHOWN = 20  # names that a refusal lists


def chosen_candidates(candidates, names, everything, expression, root, run_pytest):
    """The candidates ({name: Candidate}) that are meant, in the order of their names.

    names        names and patterns of them; everything: all
    expression   what pytest's -k takes; ``run_pytest(*arguments, silent)`` asks pytest which tests those are
    root         the project's folder

    A picture of a test that was skipped, or failed as it was expected to, is taken by its whole name alone:
    where a failure is expected strictly, a golden picture would make the test fail.

    Raises Refusal where nothing is chosen, or a name or the expression chooses none.
    """
    ways = bool(names) + everything + (expression is not None)
    if ways != 1:
        raise Refusal("Name pictures, or give --all, or -k EXPRESSION: one of the three.")
    told = {}
    with suppress(StoreError):  # a run that was interrupted tells nothing
        told = read_run(root)["pictures"]
    usual = {n: c for n, c in candidates.items() if told.get(n, {}).get("status") != EXCUSED}
    if everything:
        found = set(usual)
        if not found:
            raise Refusal(
                f"All pictures that wait are of tests that are expected to fail. {_waiting(candidates)}"
            )
    elif names:
        found = {name for given in names for name in _named(given, candidates, usual)}
    else:
        tests = _tests(expression, root, run_pytest)
        found = {n for n, c in usual.items() if any(_is_of(c, root, *test) for test in tests)}
        if not found:
            raise Refusal(f"-k {expression!r} chooses no test whose picture waits. {_waiting(candidates)}")
    return [candidate for name, candidate in candidates.items() if name in found]


def _named(given, candidates, usual):
    if given in candidates:
        return [given]
    # In a name of a parametrised test [ and ] are themselves.
    matches = re.compile(fnmatch.translate(re.sub(r"\[", "[[]", given))).match
    fitting = [name for name, c in usual.items() if matches(name) or matches(c.key)]
    found = fitting if set(given) & set("*?") else []
    if not found:
        meant = f" Did you mean {fitting[0]}?" if fitting else nearest(given, candidates)
        raise Refusal(f"No picture {given!r} waits to be accepted.{meant} {_waiting(candidates)}")
    return found


def _waiting(candidates):
    more = len(candidates) - _SHOWN
    lines = ["These wait:", *list(candidates)[:_SHOWN], *([f"and {more} more"] if more > 0 else ())]
    return "\n  ".join(lines)


def _tests(expression, root, run_pytest):
    """[(a test's name behind its module's, its store)] of those that pytest chooses."""
    with tempfile.TemporaryDirectory() as folder:
        listed = Path(folder) / "tests.json"
        run_pytest(
            "--collect-only",
            "-qqq",
            f"--rootdir={root}",
            "-k",
            expression,
            f"--golden-tests={listed}",
            silent=True,
        )
        return [
            (test["test"], Path(test["store"])) for test in json.loads(listed.read_text(encoding="utf-8"))
        ]


def _is_of(candidate, root, test, store):
    same = (root / candidate.store).resolve() == store.resolve()
    return same and (plain_key(candidate.key) == test or candidate.key.startswith(f"{test}::"))
