"""The table of how long tests take."""

import json
from types import SimpleNamespace

from tests.support.times import Times


def test_times_are_added_up_by_package_and_written(tmp_path):
    times = Times(tmp_path / "out" / "times.json")
    for name, seconds in (
        ("tests/raster/vector/test_a.py::test_x[1]", 1.0),
        ("tests/raster/vector/test_a.py::test_x[1]", 0.5),
        ("tests/raster/test_b.py::test_y", 2.0),
        ("tests/pipeline/ideal/test_c.py::test_z", 4.0),
        ("tests/pipeline/test_d.py::test_z", 0.25),
    ):
        times.pytest_runtest_logreport(SimpleNamespace(nodeid=name, duration=seconds))
    lines = []
    times.pytest_terminal_summary(SimpleNamespace(section=lines.append, write_line=lines.append))
    written = json.loads((tmp_path / "out" / "times.json").read_text())
    assert written["packages"] == {"tests/pipeline/ideal": 4.0, "tests/raster": 3.5, "tests/pipeline": 0.2}
    assert list(written["tests"]) == [
        "tests/pipeline/ideal/test_c.py::test_z",
        "tests/raster/test_b.py::test_y",
        "tests/raster/vector/test_a.py::test_x[1]",
        "tests/pipeline/test_d.py::test_z",
    ]
    assert lines[:3] == ["times", "seconds by package:", "      4.0  tests/pipeline/ideal"]
