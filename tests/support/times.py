"""How long tests take, by package: printed at the end of a run, and written to a file.

``FIXEDPIPE_TEST_HISTORY`` names a file to which each run adds a line, so that a slower package is told.
"""

import json
import os
import platform
import statistics
import subprocess
from collections import Counter
from contextlib import suppress
from pathlib import Path

_SLOWEST = 10
HISTORY = "FIXEDPIPE_TEST_HISTORY"
# Assumed: what a run beside others varies by, and packages that are too short to tell anything.
_SLOWER, _SHORTEST = 1.5, 10.0


class Times:
    """A plug-in of pytest that adds up what tests take, and writes it to ``path`` as JSON.

    {"packages": {"tests/raster": seconds, ...}, "tests": {name of a test: seconds, ...}}

    Seconds are of every process together, from the longest down.
    """

    def __init__(self, path):
        self.path, self.tests = Path(path), Counter()

    def pytest_runtest_logreport(self, report):
        self.tests[report.nodeid] += report.duration

    def packages(self):
        """Seconds by the folder of the tests; of ``pipeline`` and ``effects`` by the folders in them."""
        found = Counter()
        for name, seconds in self.tests.items():
            folders = Path(name.partition("::")[0]).parts[:-1]
            deep = 3 if folders[1:2] in (("pipeline",), ("effects",)) else 2
            found["/".join(folders[:deep])] += seconds
        return found

    def pytest_terminal_summary(self, terminalreporter):
        packages = self.packages().most_common()
        slowest = self.tests.most_common(_SLOWEST)
        terminalreporter.section("times")
        for title, rows in (("by package", packages), ("the slowest tests", slowest)):
            terminalreporter.write_line(f"seconds {title}:")
            for name, seconds in rows:
                terminalreporter.write_line(f"{seconds:9.1f}  {name}")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        rounded = [{name: round(s, 1) for name, s in rows} for rows in (packages, self.tests.most_common())]
        self.path.write_text(
            json.dumps(dict(zip(("packages", "tests"), rounded, strict=True)), indent=1) + "\n"
        )
        if history := os.environ.get(HISTORY):
            for line in remember(Path(history), rounded[0]):
                terminalreporter.write_line(line)


def remember(path, packages):
    """Add a run's seconds by package to a history; returns a sentence for each package that became slower.

    Runs are compared with those before on the same kind of processor. A line is an object: ``commit``,
    ``date`` (of the commit), ``processor``, ``packages``. What is no such line is left alone.
    """
    before, here = [], _processor()
    with suppress(OSError):
        for line in path.read_text().splitlines():
            with suppress(ValueError, TypeError, KeyError):
                if (run := json.loads(line))["processor"] == here:
                    before.append(run["packages"])
    said = []
    for name, seconds in packages.items():
        known = [run[name] for run in before if name in run]
        usual = statistics.median(known) if known else 0.0
        if usual > _SHORTEST and seconds > _SLOWER * usual:
            said.append(f"{name} took {seconds:.0f} s; {usual:.0f} s is usual of {len(known)} runs before.")
    commit, _, date = _git("log", "-1", "--format=%h %cI").partition(" ")
    run = {"commit": commit, "date": date, "processor": here, "packages": packages}
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a") as file:
        file.write(json.dumps(run) + "\n")
    return said


def _git(*arguments):
    found = subprocess.run(["git", *arguments], capture_output=True, text=True, check=False)
    return found.stdout.strip()


def _processor():
    """The kind of processor, and how many there are."""
    with suppress(OSError):
        facts = dict(
            map(str.strip, line.split(":", 1))
            for line in Path("/proc/cpuinfo").read_text().splitlines()
            if ":" in line
        )
        return f"{os.cpu_count()} of {facts.get('model name')}, family {facts.get('cpu family')}"
    return f"{os.cpu_count()} of {platform.processor() or platform.machine()}"
