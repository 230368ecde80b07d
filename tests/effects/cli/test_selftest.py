"""``fixedpipe selftest``: lines, sentences, the JSON file and the exit status."""

import json

import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.pipeline.selftest import run
from fixedpipe.pipeline.selftest.checks import Check

EQUAL = Check("here", "the fastest engines, 1 thread", 40)
DIFFERENT = Check("here", "the portable engine, 2 threads", 40, ("Frame 'fog' differs.",))
LEFT_OUT = Check("compiled for znver4", "", 0, left_out="this processor has no gfni.")


@pytest.fixture
def selftest(monkeypatch):
    """The command, with Checks that are given."""

    def called(checks, *arguments):
        monkeypatch.setattr(run, "run_selftest", lambda *, cpus: iter(checks))
        return CliRunner().invoke(main, ["selftest", *arguments])

    return called


def test_equal_bits_end_with_status_0(selftest):
    result = selftest([EQUAL, LEFT_OUT])
    assert result.exit_code == 0
    assert "equal     here: the fastest engines, 1 thread: 40 frames\n" in result.stdout
    assert "left out  compiled for znver4: this processor has no gfni.\n" in result.stdout
    assert "All 40 drawings have the accepted bits (Python " in result.stdout


def test_other_bits_are_told_and_end_with_status_1(selftest, tmp_path):
    result = selftest([EQUAL, DIFFERENT], "--json", str(tmp_path / "found.json"))
    assert result.exit_code == 1
    assert "Frame 'fog' differs." in result.stderr
    assert "1 of 80 drawings differ from the accepted bits" in result.stdout
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["passed"] is False
    assert found["checks"][1]["failures"] == ["Frame 'fog' differs."]
    assert {"numba", "numpy", "python", "kernels"} <= set(found["versions"])
