"""The suite's own promise: where captures must be used, a test that skips them fails the run."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

CONFTEST = Path(__file__).parents[1] / "conftest.py"
CASE = """
import pytest

@pytest.mark.needs_shared
def test_capture():
    pytest.skip("the capture is missing")

def test_other():
    pass
"""


@pytest.mark.parametrize(
    ("required", "status", "workers"), [("1", 1, ""), ("0", 0, ""), ("1", 1, "--numprocesses=2")]
)
def test_a_skipped_capture_fails_only_a_run_that_requires_captures(tmp_path, required, status, workers):
    (tmp_path / "conftest.py").write_text(CONFTEST.read_text())
    (tmp_path / "test_case.py").write_text(CASE)
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers = needs_shared: captures\n")
    environment = {name: value for name, value in os.environ.items() if name != "PYTEST_ADDOPTS"}
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(tmp_path), *workers.split()],
        env=environment | {"FIXEDPIPE_REQUIRE_SHARED": required, "PYTHONPATH": str(CONFTEST.parents[1])},
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert run.returncode == status, run.stdout
    assert ("test_capture was skipped" in run.stdout) == (required == "1")
    assert "1 passed, 1 skipped" in run.stdout
