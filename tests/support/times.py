"""How long tests take, by package: printed at the end of a run, and written to a file."""

import json
from collections import Counter
from pathlib import Path

_SLOWEST = 10


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
