"""The pytest plug-in: the fixture ``golden``, and a run's report on golden pictures.

Tests read stores and write candidates, each in its own file. A process sends its results to the process that
began the run (pytest-xdist's, or itself). Only that process writes the run's results, finds orphans and
records pictures.
"""

import fnmatch
import json
import os
import re
import sys
from contextlib import nullcontext
from functools import partial
from pathlib import Path

import pytest

from fixedpipe.pipeline.native import waiting

_SENT = "fixedpipe_golden"  # the key under which a process of pytest-xdist sends its results
_RUN = "golden-run"
_LATER = "differed at first, and held when its test was tried again"
_ORPHANS = ("fail", "warn", "ignore")


def pytest_addoption(parser):
    """Register the options and settings."""
    group = parser.getgroup("golden", "golden pictures (fixedpipe)")
    group.addoption(
        "--golden-record",
        action="store_true",
        help="Accept pictures that have no golden one yet; one that differs still fails.",
    )
    group.addoption(
        "--golden-tests",
        metavar="FILE",
        help="Write the tests that are there into FILE, with their stores: for `fixedpipe golden import`.",
    )
    group.addoption(
        "--golden-variant",
        metavar="NAME",
        help="The platform or driver that draws here: its golden pictures are kept beside the plain ones.",
    )
    parser.addini(
        "golden_folder", "Folder beside a test module that keeps its golden pictures.", default="golden"
    )
    parser.addini("golden_png", "Whether PNG files of golden pictures are kept.", type="bool", default=True)
    parser.addini(
        "golden_orphans", "What an orphan does to a whole run: fail, warn or ignore.", default="fail"
    )


def pytest_configure(config):
    """Register the marker, check the settings, and register this process's _Run."""
    from fixedpipe.pipeline.golden.store import variant_key

    config.addinivalue_line(
        "markers", "golden_differs: the test's pictures must differ from those that are kept as golden"
    )
    if config.getini("golden_orphans") not in _ORPHANS:
        raise pytest.UsageError(
            f"golden_orphans is {config.getini('golden_orphans')!r}; it is fail, warn or ignore."
        )
    try:
        variant_key("", config.getoption("golden_variant"))
    except ValueError as error:
        raise pytest.UsageError(f"--golden-variant: {error}") from error
    folder = config.getini("golden_folder")
    if not folder or Path(folder).is_absolute() or ".." in Path(folder).parts:
        raise pytest.UsageError(
            f"golden_folder is {folder!r}; name a folder beside the test modules: golden."
        )
    config.pluginmanager.register(_Run(config), _RUN)
    waiting.write = partial(_write_past_capture, config)


def _write_past_capture(config, line):
    """Write a line on stderr, though pytest captures the output of tests.

    The first test that draws waits for the kernels' compilation, and the user must see why.
    """
    capture = config.pluginmanager.get_plugin("capturemanager")
    streams = sys.stdout, sys.stderr  # may be a doctest's streams, which pytest would not restore
    with capture.global_and_fixture_disabled() if capture else nullcontext():
        print(f"\n{line}", file=sys.stderr, flush=True)  # pytest may have begun a line of dots
    sys.stdout, sys.stderr = streams


@pytest.fixture
def golden(request):
    """Compare pictures with golden ones.

    Calls: ``golden(picture, name=…)``, ``golden.frame(commands, profile, width, height)``, ``golden.equal(a,
    b)``, ``golden.differs(a, b)``, ``golden.at_most(a, b, max_diff, pixels)``.

    A test reports all of its failures together, at its end.
    """
    from fixedpipe.pipeline.golden.asking import Golden

    run = request.config.pluginmanager.get_plugin(_RUN)
    must_differ = request.node.get_closest_marker("golden_differs") is not None
    asking = Golden(run.place(request.node), must_differ)
    request.node.stash[_ASKING] = asking
    return asking


_ASKING = pytest.StashKey()
_PACKAGE = str(Path(__file__).parents[2]) + os.sep


class _Recorded(pytest.fail.Exception):
    """The test lacks only golden pictures that the run records."""


def _as_a_sentence(error):
    """Cut this package's part of the traceback, and the cause, from an error that this package raised.

    The message already says what the test did wrong, or which file is damaged. Other errors stay unchanged.
    """
    ours, trace, last = False, error.__traceback__, None
    while trace is not None:
        ours = trace.tb_frame.f_code.co_filename.startswith(_PACKAGE)
        last = last if ours else trace
        trace = trace.tb_next
    if ours and last is not None:
        last.tb_next = None
        error.__suppress_context__, error.__cause__ = True, None


class _Run:
    """A process's view of a run: {name: how a picture went}, the existing tests, and those that passed."""

    def __init__(self, config):
        self.config, self.root = config, config.rootpath
        self.pictures, self.tests = {}, set()
        self.passed, self.failed, self.excused = set(), set(), set()  # names of tests
        # Only a run of all tests can find orphans. --lf leaves tests out and does not tell other plug-ins.
        self.whole, self.collected = not config.getoption("lf", False), 0
        self.reports = []  # from other processes
        self.problems, self.orphans, self.notes = [], [], []

    # ---------------------------------------------------------------------------------------------- tests

    def place(self, item):
        """The Place of a test."""
        from fixedpipe.pipeline.golden.asking import Place

        module, _, test = item.nodeid.partition("::")
        if (step := _repetition(item)) is not None:
            test = re.sub(rf"(\[|-){step + 1}-\d+\]$", lambda end: "" if end[1] == "[" else "]", test)
        path = item.path
        store = path.parent / self.config.getini("golden_folder") / f"{path.stem}.json"
        return Place(
            self.root,
            store,
            module,
            test,
            self.config.getini("golden_png"),
            self.config.getoption("golden_record"),
            self.config.getoption("golden_variant"),
            step or 0,
        )

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item):
        """Fail a test whose pictures fail, or add their failures to its report if it fails itself."""
        try:
            result = yield
        except BaseException as error:
            asking = self._asked(item, ended=False)
            if asking is not None and isinstance(error, ValueError):
                _as_a_sentence(error)
            if asking is not None and asking.failures:
                item.add_report_section("call", "golden", "\n".join(asking.failures))
            raise
        asking = self._asked(item, ended=True)
        if asking is not None and asking.failures:
            pytest.fail("\n".join(asking.failures), pytrace=False)
        if asking is not None and asking.recorded:
            raise _Recorded("\n".join(asking.recorded), pytrace=False)
        return result

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_makereport(self, item, call):
        """Let a test pass that lacks only pictures which the run records.

        A test that is expected to fail has failed by now, as without recording. Strict or not, none of its
        pictures becomes golden.
        """
        report = yield
        if call.excinfo is not None and call.excinfo.type is _Recorded and report.failed:
            report.outcome, report.longrepr = "passed", None
            call.excinfo = None  # so that no debugger opens
        return report

    def _asked(self, item, ended):
        from fixedpipe.pipeline.golden.candidates import MISSING

        asking = item.stash.get(_ASKING, None)
        if asking is not None:
            for key, status in asking.asked.items():
                if status == MISSING and ended:  # an error that the test expected
                    continue
                name = asking.told(key)
                store = os.path.relpath(asking.place.store, self.root).replace(os.sep, "/")
                picture = {"status": status, "store": store, "key": key, "test": item.nodeid}
                if key in asking.allowed:
                    picture["told"] = asking.allowed[key]
                self._note(name, picture)
        return asking

    def _note(self, name, picture):
        """Note how a picture went; an earlier result of the same picture may exist.

        If an earlier try of the same test differed, the report says so. Of a test's repetitions, the result
        with the most to report stays.
        """
        from fixedpipe.pipeline.golden.candidates import ALLOWED, CHANGED, PASSED

        earlier = self.pictures.get(name)
        if earlier and picture["status"] in (ALLOWED, PASSED):
            if earlier["test"] != picture["test"] and (earlier["status"] == CHANGED or "told" in earlier):
                return
            if earlier["status"] == CHANGED:
                told = picture.get("told")
                picture["told"] = f"{_LATER}{f'; {told}' if told else ''}"
        self.pictures[name] = picture

    def pytest_runtest_logreport(self, report):
        """Note which tests passed, which failed, and which were skipped or expected to fail."""
        if type(report) is not pytest.TestReport:  # a subtest's report
            return
        if report.when == "call" and report.passed:
            self.passed.add(report.nodeid)
        if report.failed:
            self.failed.add(report.nodeid)
        if report.skipped or hasattr(report, "wasxfail"):
            self.excused.add(report.nodeid)

    def pytest_itemcollected(self, item):
        """Note a test that exists, chosen for this run or not."""
        self.tests.add(item.nodeid)
        self.collected += 1

    def pytest_collection_finish(self, session):
        """Note which tests exist, and write them to --golden-tests' file."""
        self.tests |= {item.nodeid for item in session.items}
        repeated = any(_repetition(item) is not None for item in session.items)  # names with a number
        self.whole = self.whole and self.collected == len(session.items) and not repeated
        if file := self.config.getoption("golden_tests"):
            places = [self.place(item) for item in session.items]
            told = [{"test": p.test, "store": str(p.store), "keep": p.keep} for p in places]
            Path(file).write_text(json.dumps(told), encoding="utf-8")

    def pytest_deselected(self, items):
        """Note tests that exist and do not run; the run is then not whole."""
        self.tests |= {item.nodeid for item in items}
        self.whole = self.whole and not items

    # ------------------------------------------------------------------------------------------ processes

    def _seen(self):
        return {
            "pictures": self.pictures,
            "tests": sorted(self.tests),
            "passed": sorted(self.passed),
            "whole": self.whole,
        }

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node, error):
        """Take the results that a process of pytest-xdist sent; a crashed process sent none."""
        sent = getattr(node, "workeroutput", {}).get(_SENT)
        if sent is None:
            self.whole = False
        else:
            self.reports.append(json.loads(sent))

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session, exitstatus):
        """Send this process's results, or gather all results, find orphans and record pictures."""
        from fixedpipe.pipeline.golden.candidates import ALLOWED, EXCUSED, PASSED

        if self.config.getoption("collectonly"):
            return
        if hasattr(self.config, "workeroutput"):
            self.config.workeroutput[_SENT] = json.dumps(self._seen())
            return
        for sent in self.reports:
            for name, picture in sent["pictures"].items():
                self._note(name, picture)
            self.tests |= set(sent["tests"])
            self.passed |= set(sent["passed"])
            self.whole = self.whole and sent["whole"]
        stopped = exitstatus not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED)
        stopped = stopped or session.shouldfail or session.shouldstop
        self.whole = self.whole and not stopped and not any("::" in arg for arg in self.config.args)
        for picture in self.pictures.values():
            if picture["test"] in self.excused and picture["status"] not in (ALLOWED, PASSED):
                picture["status"] = EXCUSED
        stores = self._stores() if self.whole or self.pictures else {}
        if not (self.pictures or stores):
            return
        self._conclude(stores)
        failed = self.problems or (self.orphans and self.config.getini("golden_orphans") == "fail")
        if failed and session.exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def _conclude(self, stores):
        from fixedpipe.pipeline.golden.candidates import write_run
        from fixedpipe.pipeline.golden.store import StoreError

        try:
            if self.config.getoption("golden_record"):
                self._record()
            for path, module in stores.items() if self.whole else ():
                self._account(path, module)
        except StoreError as error:
            self.problems.append(str(error))
        try:
            write_run(self.root, {**self._earlier(), **self.pictures})
        except StoreError as error:  # The tests' own results stay valid.
            self.notes.append(f"How the pictures went is not kept for a review: {error}")

    def _earlier(self):
        """After a run of some tests alone, the known results of the other tests from earlier runs."""
        from fixedpipe.pipeline.golden.candidates import FOLDER, MISSING, PASSED, RECORDED, read_run

        if not (self.root / FOLDER / "run.json").exists():
            return {}
        earlier = read_run(self.root)["pictures"]
        for picture in earlier.values():
            if picture["test"] in self.failed:  # its new pictures have their own results
                picture["status"] = MISSING
                picture.pop("told", None)
            elif picture["status"] == RECORDED:
                picture["status"] = PASSED
        if not self.whole:
            return earlier
        if self.config.args_source is not self.config.ArgsSource.ARGS:
            return {}
        # Modules that this run did not include, and that still exist.
        ran = {test.partition("::")[0] for test in self.tests}
        modules = {p["test"].partition("::")[0] for p in earlier.values()} - ran - {""}
        there = {module for module in modules if (self.root / module).is_file()}
        return {name: p for name, p in earlier.items() if p["test"].partition("::")[0] in there}

    def _record(self):
        from fixedpipe.pipeline.golden.accepting import accept_where_sound
        from fixedpipe.pipeline.golden.candidates import NEW, RECORDED, read_candidates
        from fixedpipe.pipeline.golden.store import read_store

        candidates = read_candidates(self.root)
        for name, picture in self.pictures.items():
            if picture["status"] != NEW:
                continue
            if name in candidates:
                accept_where_sound(self.root, [candidates[name]])
                picture["status"] = RECORDED
            elif picture["key"] in read_store(self.root / picture["store"]):  # another run recorded it
                picture["status"] = RECORDED

    # --------------------------------------------------------------------------------------------- orphans

    def _stores(self):
        """{file of a store: its test module's name} of the stores that the run concerns."""
        folder, found = self.config.getini("golden_folder"), {}
        modules = {test.partition("::")[0] for test in self.tests}
        for module in modules:
            path = self.root / module
            store = path.parent / folder / f"{path.stem}.json"
            if store.is_file():
                found[store] = module
        if self.whole:
            for store in self._beside_no_module(folder):
                found.setdefault(store, None)
        return found

    def _beside_no_module(self, folder):
        """Stores below the given folders whose test module does not exist."""
        skipped = self.config.getini("norecursedirs")
        for arg in self.config.args:
            start = Path(self.config.invocation_params.dir, arg)
            if not start.is_dir():
                continue
            for at, folders, files in os.walk(start):
                folders[:] = [name for name in folders if not any(fnmatch.fnmatch(name, p) for p in skipped)]
                if Path(at).name != folder:
                    continue
                for name in files:
                    gone = not Path(at).with_name(name.removesuffix(".json") + ".py").exists()
                    if name.endswith(".json") and gone:
                        yield Path(at, name)

    def _account(self, path, module):
        """Note a store's pictures that no test compared: orphans, or missing because their test failed."""
        from fixedpipe.pipeline.golden.candidates import EXCUSED, MISSING, ORPHAN
        from fixedpipe.pipeline.golden.store import StoreError, plain_key, read_store

        try:
            keys = read_store(path)
        except StoreError as error:
            if module:  # Without a module, another program may have written the file.
                self.problems.append(str(error))
            return
        store = os.path.relpath(path, self.root).replace(os.sep, "/")
        # A test compares a picture or one of its variants; the other variants are no orphans.
        asked = {plain_key(p["key"]) for p in self.pictures.values() if p["store"] == store}
        for key in (key for key in keys if plain_key(key) not in asked):
            test = f"{module}::{_test_of(plain_key(key), module, self.tests)}" if module else ""
            orphan = test not in self.tests or test in self.passed
            name = f"{module or store.removesuffix('.json')}::{key}"
            if orphan:
                self.orphans.append(name)
            status = ORPHAN if orphan else EXCUSED if test in self.excused else MISSING
            self.pictures[name] = {"status": status, "store": store, "key": key, "test": test}

    # ---------------------------------------------------------------------------------------------- words

    def pytest_terminal_summary(self, terminalreporter):
        """Print the report on golden pictures, with the user's next step."""
        from fixedpipe.pipeline.golden.candidates import ALLOWED, CHANGED, NEW, RECORDED

        changed, new, recorded = (
            sorted(name for name, p in self.pictures.items() if p["status"] == status)
            for status in (CHANGED, NEW, RECORDED)
        )
        told = {n: f"{n}: {p['told']}" for n, p in sorted(self.pictures.items()) if "told" in p}
        allowed = [told[name] for name in told if self.pictures[name]["status"] == ALLOWED]
        later = [name for name in told if _LATER in told[name]]
        if not (changed or new or recorded or told or self.orphans or self.problems or self.notes):
            return
        write = terminalreporter.write_line
        terminalreporter.section("golden pictures")
        for one, many, found in (
            ("differs", "differ", changed),
            ("has no golden picture yet", "have no golden picture yet", new),
            ("recorded", "recorded", recorded),
            (
                "passed within what its test allows",
                "passed within what their tests allow",
                allowed,
            ),
            (
                "passed when its test was tried again",
                "passed when their tests were tried again",
                later,
            ),
            (
                "is golden, and no test asks for it",
                "are golden, and no test asks for them",
                sorted(self.orphans),
            ),
        ):
            if found:
                write(f"{len(found)} {one if len(found) == 1 else many}:")
                for name in found[:20]:
                    write(f"  {name}")
                if len(found) > 20:
                    write(f"  and {len(found) - 20} more")
        for sentence in (*self.problems, *self.notes):
            write(sentence)
        if changed or new:
            write(
                "Look at them: fixedpipe golden review --html golden.html; then fixedpipe golden accept "
                "NAME …"
            )
        if self.orphans:
            write("fixedpipe golden orphans lists them; --remove takes them away.")


def _repetition(item):
    """The number of a test's repetition by pytest-repeat, from 0 on; None for a test that is not repeated."""
    params = item.callspec.params if hasattr(item, "callspec") else {}
    return params.get("__pytest_repeat_step_number")


def _test_of(key, module, tests):
    """The test of a picture's key: the key itself, or its part before the picture's name."""
    if f"{module}::{key}" in tests:
        return key
    return key.rpartition("::")[0] if f"{module}::{key.rpartition('::')[0]}" in tests else key
