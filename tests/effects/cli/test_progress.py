"""What a person is told while a command works: nothing of short work, and of long work how far it is."""

import re
from threading import Event

import pytest
from click.testing import CliRunner

from fixedpipe.effects.acceptance import precision
from fixedpipe.effects.cli import main, progress
from fixedpipe.effects.figures import Figure
from fixedpipe.effects.user_pictures import drawing, mesh_shadows

HANGS = 300.0


@pytest.fixture
def said(monkeypatch):
    """Lines on the error stream, and an Event that is set at the first; work is long from its beginning."""
    lines, first = [], Event()

    def echo(line="", err=False, **_):
        if err and re.match(r"\d+ of \d+: ", line):
            lines.append(line)
            first.set()

    monkeypatch.setattr(progress, "_SHORT", 0.0)
    monkeypatch.setattr(progress.click, "echo", echo)
    return lines, first


def test_of_long_work_it_is_said_how_far_it_is(said):
    lines, first = said
    with progress.progress_of_long(20) as step:
        step("a")
        assert first.wait(HANGS)
        for text in "bcdefgh":
            step(text)
    assert lines == ["1 of 20: a", "3 of 20: c", "5 of 20: e", "7 of 20: g"]


def test_what_is_being_done_is_said_when_it_has_become_long(said, monkeypatch):
    """The work was short for two steps."""
    lines, _ = said
    timers = []

    class Timer:
        def __init__(self, _, show):
            timers.append(show)

        def start(self):
            pass

        cancel = join = start

    monkeypatch.setattr(progress, "Timer", Timer)
    with progress.progress_of_long(20) as step:
        step("a")
        step("b")
        assert lines == []
        timers[0]()
        step("c")
    assert lines == ["2 of 20: b", "3 of 20: c"]


def test_of_short_work_nothing_is_said(said, monkeypatch):
    lines, _ = said
    monkeypatch.setattr(progress, "_SHORT", HANGS)
    with progress.progress_of_long(2) as step:
        step("a")
        step("b")
    assert lines == []


# Commands, what each says first, and a function that it calls then.
LONG = {
    "precision": (("K12", "--size", "8", "--bits", "8"), "1 of 10: 8 bits", precision, "frame_error"),
    "print": (("K12", "--size", "8", "--out", "sheet.svg"), "1 of 3: K12 on GeForce 256", Figure, "render"),
    "shadows": (
        ("mesh.obj", "--algorithm", "depth-map", "--profile", "GEFORCE_3", "--size", "16", "--out", "a.png"),
        "1 of 1: the shadow, and rays to compare it with",
        mesh_shadows,
        "drawn",
    ),
    "material": (
        ("lambert", "--size", "8", "--out", "a.png"),
        "1 of 9: load u1 of reflectance",
        drawing,
        "drawn",
    ),
}


@pytest.mark.parametrize("command", LONG)
def test_a_long_command_says_what_it_does(said, tmp_path, monkeypatch, command):
    if command == "print":
        pytest.importorskip("matplotlib")
    (arguments, line, where, name), (lines, first) = LONG[command], said
    function = getattr(where, name)

    def slow(*given, **named):
        assert first.wait(HANGS)
        return function(*given, **named)

    monkeypatch.chdir(tmp_path)
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    monkeypatch.setattr(where, name, slow)
    done = CliRunner().invoke(main, [command, *arguments])
    assert done.exit_code == 0, (done.output, done.exception)
    assert line in lines
