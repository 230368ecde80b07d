"""No test asks a clock: what a slow or busy machine does later, a test waits for, and says so in an event.

Forbidden in tests: clocks and sleep, a deadline for Hypothesis, and a limit of time other than HANGS, after
which what should end is taken to hang.
"""

import ast

import pytest
from hypothesis import HealthCheck, settings

from tests.project.test_layers import ROOT

TESTS = sorted((ROOT / "tests").rglob("*.py"))
# Commands that say how long they took or on which day, or are told how long to try; no verdict is theirs.
# What waits for another thread, until that is taken to hang, has one home.
WITH_CLOCKS = {
    *("tests/accept.py", "tests/accept_conformance.py", "tests/fuzz.py", "tests/support/waiting.py"),
}
HANGS, LEAST_SECONDS = "HANGS", 300.0


def is_number(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)


def clocks_of(tree):
    """What of a module depends on time: (line, why) of each."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            modules = [getattr(node, "module", None), *(alias.name for alias in node.names)]
            if {"time", "timeit", "datetime"} & {*modules}:
                yield node.lineno, "imports a clock"
        is_limit = isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == HANGS
        if is_limit and not (is_number(node.value) and node.value.value >= LEAST_SECONDS):
            yield node.lineno, f"takes for hanging what a busy machine does in {LEAST_SECONDS:.0f} s"
        if not isinstance(node, ast.Call):
            continue
        for keyword in node.keywords:
            limit = ast.unparse(keyword.value)
            if keyword.arg == "deadline" and limit != "None":
                yield node.lineno, f"has the deadline {limit}"
            if keyword.arg == "timeout" and limit not in (HANGS, "None"):
                yield node.lineno, f"waits {limit} seconds; wait {HANGS}"
        if isinstance(node.func, ast.Attribute) and node.func.attr in ("wait", "join", "select"):
            for limit in filter(is_number, node.args):
                yield node.lineno, f"waits {limit.value} seconds; wait {HANGS}"


@pytest.mark.parametrize("path", TESTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_test_depends_on_time(path):
    if path.relative_to(ROOT).as_posix() not in WITH_CLOCKS:
        assert list(clocks_of(ast.parse(path.read_text()))) == []


def test_the_rule_sees_clocks():
    found = clocks_of(
        ast.parse(
            "import time\n"
            "from time import sleep\n"
            "HANGS = 5.0\n"
            "settings(deadline=200)\n"
            "subprocess.run([], timeout=60)\n"
            "event.wait(1)\n"
            "thread.join(0.5)\n"
            "settings(deadline=None)\n"
            "event.wait(HANGS), waits.acquire(timeout=HANGS), ' '.join(words), thread.join(HANGS)\n"
        )
    )
    assert sorted({line for line, _ in found}) == [1, 2, 3, 4, 5, 6, 7]


@pytest.mark.parametrize("name", ["fixedpipe", "random"])
def test_hypothesis_asks_no_clock(name):
    profile = settings.get_profile(name)
    assert profile.deadline is None
    assert HealthCheck.too_slow in profile.suppress_health_check
    assert profile.derandomize == (name == "fixedpipe")


def test_this_run_asks_no_clock():
    assert settings.default.deadline is None
