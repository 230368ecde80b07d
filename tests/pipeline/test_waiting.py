"""What a person is told while kernels are compiled, in Python and under pytest."""

import os
import subprocess
import sys

import pytest

from fixedpipe.pipeline.native import waiting


@pytest.fixture
def lines(monkeypatch):
    """Lines, what they wrote, and a clock that a test sets."""
    written, clock = [], [100.0]
    monkeypatch.setattr(waiting, "write", written.append)
    return waiting.Lines(lambda: clock[0]), written, clock


def test_nothing_is_said_of_a_wait_of_less_than_two_seconds(lines):
    lines, written, clock = lines
    for k in range(10):
        clock[0] += 0.19
        lines.say("a", k, 10)
        lines.end()
    assert written == []


def test_a_long_wait_is_explained_once_and_then_told_every_ten_seconds(lines):
    lines, written, clock = lines
    for k in range(50):
        lines.say("a_kernel", k, 50)
        lines.end()
        clock[0] += 0.5
    assert "fixedpipe warmup" in written[0]
    assert written[1:] == [f"compiling kernel {k} of 50: a_kernel" for k in (5, 25, 45)]


def test_two_short_waits_are_no_long_one(lines):
    lines, written, clock = lines
    for _ in range(5):
        lines.say("a", 0, 1)
        lines.end()
        clock[0] += 60
    assert written == []


SLOW = """
import time
from fixedpipe.pipeline.native import compiling, waiting
from fixedpipe.raster.kernel import kernel

waiting._FIRST = 0.0

@kernel("f8(f8)")
def added(x):
    return x + 1.0

def test_it():
    assert added(1.0) == 2.0

if __name__ == "__main__":
    test_it()
"""


@pytest.mark.parametrize("command", [(), ("-m", "pytest", "-q", "-p", "no:cacheprovider")])
def test_a_script_and_a_test_say_that_they_compile(tmp_path, command):
    (tmp_path / "test_slow.py").write_text(SLOW)
    done = subprocess.run(
        [sys.executable, *command, "test_slow.py"],
        cwd=tmp_path,
        env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "compiling kernel 1 of 1: added" in done.stderr
    assert "added" not in done.stdout


def test_a_doctest_that_compiles_keeps_its_stdout(tmp_path):
    (tmp_path / "test_slow.py").write_text(SLOW.replace("1.0) == 2.0", "1.0) == 2.0\n    return 2"))
    (tmp_path / "test_doc.txt").write_text(">>> import test_slow\n>>> test_slow.test_it()\n2\n")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_doc.txt"],
        cwd=tmp_path,
        env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
    assert "compiling kernel 1 of 1: added" in done.stderr


def test_a_process_that_another_one_began_says_nothing(tmp_path):
    (tmp_path / "slow.py").write_text(SLOW)
    code = (
        "import multiprocessing as m\nfrom slow import test_it\n"
        "if __name__ == '__main__':\n    p = m.get_context('spawn').Process(target=test_it)\n"
        "    p.start(); p.join(); assert p.exitcode == 0\n"
    )
    (tmp_path / "main.py").write_text(code)
    done = subprocess.run(
        [sys.executable, "main.py"],
        cwd=tmp_path,
        env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
