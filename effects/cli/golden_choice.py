"""Which of the waiting pictures ``fixedpipe golden accept`` accepts."""

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
    """The chosen ones of the candidates ({name: Candidate}), in their order.

    names        names, and patterns of names; everything: whether all are chosen
    expression   an expression for pytest's -k; ``run_pytest(*arguments, silent)`` finds the tests it matches
    root         the project's folder

    Only its whole name chooses the picture of a test that was skipped, or that failed as expected. If the
    failure is expected strictly, a golden picture would make this test fail.

    Raises Refusal if nothing is chosen, or if a name or the expression matches no picture.
    """
    ways = bool(names) + everything + (expression is not None)
    if ways != 1:
        raise Refusal("Name pictures, or give --all, or -k EXPRESSION: one of the three.")
    told = {}
    with suppress(StoreError):  # after an interrupted run there is no file to read
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
    # Names of parametrised tests contain [ and ]. In a pattern these are plain characters.
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
    """[(name, store)] of the tests that pytest chooses. The name has no module."""
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
