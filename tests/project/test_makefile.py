"""What ``make`` does: its set-up says what pip says only where that fails, and figures are checked."""

import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOISE = "WARNING: what pip says"


pytestmark = pytest.mark.skipif(shutil.which("make") is None, reason="this system has no make")


@pytest.mark.parametrize("status", [0, 1])
def test_pip_is_heard_only_where_the_set_up_fails(tmp_path, status):
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, tmp_path)
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text(f"#!/bin/sh\necho '{NOISE}'\necho '{NOISE}' >&2\nexit {status}\n")
    python.chmod(0o755)
    done = subprocess.run(
        ["make", "setup", f"PYTHON={sys.executable}"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode == 0) == (status == 0), done.stderr
    assert (tmp_path / ".venv" / ".ready").exists() == (status == 0)
    assert NOISE not in done.stdout
    assert done.stderr.count(NOISE) == 2 * status


@pytest.mark.parametrize(
    ("asked", "called"),
    [
        ([], "fixedpipe figures --check --out out"),
        (["CHECKS=no"], "fixedpipe figures --out out"),
        (["CHECKS=no", "MACHINES=paper NV2A"], "fixedpipe figures --profile paper --profile NV2A --out out"),
    ],
)
def test_figures_are_drawn_with_their_checks_unless_told_otherwise(asked, called):
    done = subprocess.run(
        ["make", "-n", "figures", *asked], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert called in " ".join(done.stdout.split())


@pytest.mark.parametrize("goal", ["test", "test-all"])
def test_the_tests_run_a_second_time_where_the_first_has_left_its_times(tmp_path, goal):
    (tmp_path / f"{goal}-times.json").write_text("{}")
    command = subprocess.run(
        ["make", "--dry-run", "--silent", goal, "READY=", f"OUT={tmp_path}", "WORKERS=--help"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    _, _, words = command.splitlines()[-1].partition(" -m pytest ")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *shlex.split(words)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "--times=FILE" in done.stdout or "--times FILE" in done.stdout
