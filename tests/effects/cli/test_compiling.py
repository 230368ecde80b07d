"""What is said while kernels are compiled: how many of how many, on a terminal as a bar."""

import io
import subprocess
import sys

import numba
import pytest
from click.testing import CliRunner
from rich.console import Console

from fixedpipe.effects.cli import compiling, main, progress
from fixedpipe.pipeline.native import background_compiling
from fixedpipe.pipeline.native.compiling import needed_by, watch_compiling


@numba.njit
def innermost(x):
    return x + 1


@numba.njit
def inner(x):
    return innermost(x) * 2


@numba.njit
def outer(x):
    return inner(x) + innermost(x)


def test_each_kernel_is_said_as_its_compiling_begins_of_how_many_are_needed():
    assert needed_by(outer) == {outer, inner, innermost}
    said, ended = [], []
    stop = watch_compiling(lambda *what: said.append(what), lambda: ended.append(len(said)))
    try:
        assert outer(1) == 6
        assert outer(2) == 9
    finally:
        stop()
    names = [name for name, _, _ in said]
    assert names[0] == "outer" and set(names) == {"outer", "inner", "innermost"}
    assert [done for _, done, _ in said] == sorted(done for _, done, _ in said)
    assert all(needed == 3 and done < needed for _, done, needed in said)
    assert ended == [3]
    assert needed_by(outer) == set()
    inner(1.5)
    assert len(said) == 3  # nobody watches any more


@pytest.fixture
def console(monkeypatch):
    made = Console(file=io.StringIO(), force_terminal=True, width=100)
    monkeypatch.setattr(compiling, "error_console", lambda: made)
    monkeypatch.setattr(progress, "error_console", lambda: made)
    return made


def test_a_terminal_has_a_bar(console):
    shown = compiling._Shown(said=True)
    shown.begin("draw_batch", 3, 40)
    shown.bar.refresh()
    shown.end()
    assert shown.bar is None
    text = console.file.getvalue()
    assert "compiling draw_batch" in text and "3/40" in text


def test_a_bar_within_a_bar_is_no_error(console):
    with progress.progress(5) as step:
        step("a figure")
        shown = compiling._Shown(said=True)
        shown.begin("draw_batch", 3, 40)
        shown.end()
        step("the next")


def test_elsewhere_there_is_a_line_every_five_seconds(capsys, monkeypatch):
    seconds = iter(range(100, 200))
    monkeypatch.setattr(compiling.time, "monotonic", lambda: float(next(seconds)))
    shown = compiling._Shown(said=False)
    for done in range(30):
        shown.begin("draw_batch", done, 40)
    shown.end()
    said = capsys.readouterr().err.splitlines()
    assert said[0] == "Compiling kernels that nothing needed before."
    assert said[1] == "compiling kernel 1 of 40: draw_batch"
    assert [line.split()[2] for line in said[1:]] == ["1", "6", "11", "16", "21", "26"]


@pytest.mark.parametrize(
    "command",
    [
        ("parameters", "F004-4"),
        ("figures", "K12"),
        ("inspect", "K12", "--pixel", "1,1"),
        ("bump", "sample:gravel", "--out", "a.png"),
        ("golden", "orphans"),
        ("cache",),
        ("warmup",),
    ],
    ids=" ".join,
)
def test_ctrl_c_ends_every_command_with_a_line(monkeypatch, command):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(main.get_command(None, command[0]), "invoke", interrupt)
    done = CliRunner().invoke(main, command)
    assert (done.exit_code, done.stdout, done.stderr) == (130, "", "fixedpipe: interrupted.\n")


def test_ctrl_c_reaches_no_process_that_begins_where_interrupts_are_kept():
    """From its first instruction on: it has imported nothing yet."""
    code = "import signal; print(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))"

    def blocked():
        return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout

    with background_compiling.interrupts_kept():
        assert blocked() == "True\n"
    assert blocked() == "False\n"


@pytest.mark.parametrize("interrupted", [False, True])
def test_a_command_that_has_done_its_work_waits_for_kernels_of_the_next(monkeypatch, interrupted):
    class Compiling:
        def wait(self, say):
            say("draw_bands", 3, 40)
            if interrupted:
                raise KeyboardInterrupt

    monkeypatch.setattr(compiling, "_SECONDS", 0.0)
    monkeypatch.setattr(background_compiling, "compile_beside", {"portable": Compiling()}.get)
    compiling.announce_compiling.cache_clear()
    monkeypatch.setattr(compiling, "announce_compiling", compiling.announce_compiling.__wrapped__)
    done = CliRunner().invoke(main, ["precision", "F004-4", "--size", "8", "--bits", "8"])
    assert done.exit_code == 0, done.output
    before, after = done.stderr.split(compiling._LEFT)
    assert compiling._BESIDE in before
    assert after.strip() == "compiling kernel 4 of 40: draw_bands"
