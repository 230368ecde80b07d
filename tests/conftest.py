"""Settings of the whole suite: reproducible Hypothesis runs, and tests that need the folder of captures."""

import gc
import os
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from fixedpipe.pipeline.native import background_compiling
from tests.support.sample import fewer_examples, say_the_change, take_turns

# Another project's tests, which tests/project/test_golden_outside.py runs where they belong.
collect_ignore = ["stranger"]

SHARED = Path(__file__).resolve().parents[2] / "shared"
CAPTURES = Path(os.environ.get("FIXEDPIPE_CAPTURES") or SHARED / "silicon" / "golden" / "results")

# How long an example takes decides nothing: machines are slow, and busy. Derandomised: the same examples on
# every machine where the same modules are loaded, whose constants are among the values that are tried.
# `pytest --hypothesis-profile=random` searches at random.
# Hypothesis's own defaults differ where the variable CI is set, so each setting that matters is said.
settings.register_profile(
    "random",
    derandomize=False,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    print_blob=True,
)
settings.register_profile("fixedpipe", settings.get_profile("random"), derandomize=True)
settings.load_profile("fixedpipe")


@pytest.fixture(autouse=True)
def engines_as_asked(monkeypatch):
    """What a command sets for its process, where kernels have to be compiled, ends with the test."""
    monkeypatch.setattr(background_compiling, "_never_waits", False)


@pytest.fixture(scope="session")
def shared():
    """The folder `shared` beside the checkout; a test that asks for it is marked `needs_shared`."""
    return SHARED


@pytest.fixture(scope="session")
def captures():
    """The folder of captures, SUITE/CASE.png; a test that asks for it is marked `needs_shared`."""
    return CAPTURES


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection():
    """Collect without looking for garbage: what is imported stays, and so do twenty-five thousand tests.

    Measured: 35 s of processor with, 20 without. Later looks leave out what is there now.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(tryfirst=True)  # before `-m "not slow"` leaves items out
def pytest_collection_modifyitems(config, items):
    """Skip what needs captures, or `shared`, where there are none; try as many examples as asked."""
    take_turns(items)
    fewer_examples(items, config.getoption("--examples"))
    for item in items:
        if item.get_closest_marker("needs_shared"):
            if "captures" in item.fixturenames:
                there, reason = CAPTURES.is_dir(), "no captures: set FIXEDPIPE_CAPTURES to their folder"
            else:
                there, reason = SHARED.is_dir(), "no folder `shared` beside the checkout"
            if not there:
                item.add_marker(pytest.mark.skip(reason=reason))


class SkipsOfShared:
    """Counts skipped tests marked `needs_shared` and fails the run that must not have any."""

    def __init__(self):
        self.skipped = []

    def pytest_runtest_logreport(self, report):
        if report.skipped and "needs_shared" in report.keywords:
            self.skipped.append(report.nodeid)

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session):
        if self.skipped and session.exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter):
        for nodeid in self.skipped:
            terminalreporter.write_line(
                f"FAILED: {nodeid} was skipped; FIXEDPIPE_REQUIRE_SHARED=1 forbids it."
            )


def pytest_addoption(parser):
    """``--times FILE``: say how long tests take, by package. ``--examples N``: one in N of Hypothesis's."""
    parser.addoption("--times", metavar="FILE", help="Print how long tests take, and write it to FILE.")
    parser.addoption(
        "--examples", metavar="N", type=int, default=1, help="Try one in N of Hypothesis's examples."
    )


def pytest_configure(config):
    """Arm the check where a run must use the folder `shared`; keep times where they are asked for.

    The process of all tests says which change it tests, for those that it starts.
    """
    if not hasattr(config, "workerinput"):
        say_the_change()
    path = config.getoption("--times")
    if path and not hasattr(config, "workerinput"):  # a process of several hands its reports to the first
        from tests.support.times import Times

        config.pluginmanager.register(Times(path), "times")
    if os.environ.get("FIXEDPIPE_REQUIRE_SHARED") == "1":
        config.pluginmanager.register(SkipsOfShared(), "skips-of-shared")


@pytest.fixture(autouse=True)
def nothing_is_read_that_another_run_computed(monkeypatch):
    """Tests compute what they prove: no command in this process reads the user's results."""
    if folder := sys.modules.get("fixedpipe.raster.kernel_folder"):
        monkeypatch.setattr(folder, "results_folder", lambda: None)
