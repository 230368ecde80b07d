"""``python -m bench replay``: what it measures of a trace, and what it says where it cannot."""

import json

import pytest

from bench import replays
from fixedpipe.effects.replays import glretrace
from fixedpipe.pipeline.opengl import tokens as T
from tests.effects.replays.programs import BLUE, GREEN, started


@pytest.fixture
def trace(tmp_path, monkeypatch):
    """A trace of three frames; its last calls end none. Rounds are as short as can be."""
    monkeypatch.setattr(replays, "ROUNDS", 1)
    monkeypatch.setattr(replays, "_ROUND_SECONDS", 0.0)
    program = started()
    for n in range(3):
        program.clear(BLUE).rectangle(GREEN, -1.0 + n / 2).swap()
    return str(program.clear(BLUE).write(tmp_path / "three.trace"))


def test_the_last_whole_frame_is_measured(trace):
    row = replays.measure(trace, "GEFORCE_256", 1, beside=False)
    assert (row.frame, row.width, row.height, row.draws, row.refused) == (2, 8, 4, 1, 0)
    assert row.calls == len(
        ["glClearColor", "glClear", "glColor4f", "glBegin", *["glVertex2f"] * 4, "glEnd", "swap"]
    )
    assert row.ours == row.reading + row.front_end + row.machine_time and row.peer is None


def test_refused_calls_are_counted(tmp_path, monkeypatch):
    monkeypatch.setattr(replays, "ROUNDS", 1)
    monkeypatch.setattr(replays, "_ROUND_SECONDS", 0.0)
    program = started().rectangle(GREEN).call("glActiveTexture", T.TEXTURE2).call("glEnable", T.TEXTURE_2D)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    texels = T.RGBA, 1, 1, 0, T.RGBA, T.UNSIGNED_BYTE, b"abcd"
    program.call("glTexImage2D", T.TEXTURE_2D, 0, *texels).rectangle(BLUE).swap()  # with a third unit
    row = replays.measure(str(program.write(tmp_path / "units.trace")), "GEFORCE_256", 1, beside=False)
    assert (row.draws, row.refused) == (1, 1)


def test_the_table_and_the_object(trace, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(glretrace, "missing", lambda: "glretrace is not installed.")
    file = tmp_path / "rows.json"
    assert replays.main([trace, "--json", str(file)]) == 0
    out, err = capsys.readouterr()
    assert "| three.trace | GEFORCE_256 | 8x4 | 10 | 1 |" in out
    assert err == "Without glretrace: glretrace is not installed.\n"
    (row,) = json.loads(file.read_text())["rows"]
    assert row["peer"] is None and set(row["reading"]) == {"processor", "wall"}


def test_a_file_without_frames_and_a_missing_one_are_said(tmp_path, capsys):
    path = started().clear(BLUE).write(tmp_path / "none.trace")
    assert replays.main([str(path), str(tmp_path / "absent.trace"), "--alone"]) == 1
    err = capsys.readouterr().err
    assert "has no frame that a call ends" in err and "absent.trace cannot be read" in err


def test_glretraces_time_is_of_the_repeated_frames_alone(trace, monkeypatch):
    if (lacking := glretrace.missing()) is not None:
        pytest.skip(lacking)
    asked = []
    # Loading takes 700 ms, a frame 2 of the processor and 3 of the wall's clock.
    times = lambda loops: replays.Times(700.0 + 2.0 * loops, 700.0 + 3.0 * loops)  # noqa: E731
    monkeypatch.setattr(
        replays, "_looped", lambda shown, path, loops, threads: asked.append(loops) or times(loops)
    )
    found = replays.measure(trace, "GEFORCE_256", 1, beside=True).peer
    assert (found.processor, found.wall) == pytest.approx((2.0, 3.0))
    assert set(asked) == {replays.FEW, replays.MORE}
