"""Frames of a trace as golden pictures: docs/replay.md's test module, in a project of its own."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.replays.driving import drawn_frames
from fixedpipe.pipeline.golden.store import read_store
from fixedpipe.pipeline.profiles import GEFORCE_256
from tests.effects.replays.programs import BLUE, BYTES, GREEN, RED, color_of, started

PAGE = Path(__file__).parents[3] / "docs" / "replay.md"


def trace(path, color=GREEN):
    """Two frames; ``color``: of the second one's rectangle."""
    program = started().clear(BLUE).rectangle(GREEN, 0.0).swap()
    return program.clear(BLUE).rectangle(color, -0.5).rectangle(RED, 0.5).swap().write(path)


def run(folder, *arguments):
    """(status, what it prints) of a command in a project's folder."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST", "COV_"))}
    done = subprocess.run(
        [sys.executable, "-B", "-m", *arguments],
        cwd=folder,
        env=kept,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout + done.stderr


def test_frames_are_recorded_and_compared(tmp_path):
    (text,) = re.findall(r"^```python tests/test_game.py\n(.*?)^```$", PAGE.read_text(), re.M | re.S)
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_game.py").write_text(text)
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\naddopts = -q -p no:cacheprovider -p no:hypothesispytest\n"
    )
    trace(tmp_path / "game.trace")
    status, said = run(tmp_path, "fixedpipe.effects.cli", "golden", "record")
    assert status == 0, said
    store = read_store(tmp_path / "tests" / "golden" / "test_game.json")
    assert sorted(store) == ["test_every_draw_of_a_frame", "test_frames::frame 0", "test_frames::frame 1"]
    assert run(tmp_path, "pytest")[0] == 0
    trace(tmp_path / "game.trace", BLUE)
    status, said = run(tmp_path, "pytest")
    assert status == 1 and "::test_frames::frame 1" in said and "frame 0:" not in said
    assert "glEnd (call " in said  # the first command that leaves other pixels


def test_drawn_frames(tmp_path):
    path = trace(tmp_path / "game.trace")
    first, second = drawn_frames(path, GEFORCE_256, "0-1")
    assert (first.number, color_of(first), color_of(first, 7)) == (0, BYTES[BLUE], BYTES[GREEN])
    assert (second.number, color_of(second, 3), color_of(second, 7)) == (1, BYTES[GREEN], BYTES[RED])
    (only,) = drawn_frames(path, GEFORCE_256)
    assert only.number == 0


@pytest.mark.parametrize(
    ("frames", "words"), [("0,7", "has no frame 7; its frames are 0 to 1"), ("2-1", "ends before it begins")]
)
def test_frames_that_there_are_not_are_refused(tmp_path, frames, words):
    with pytest.raises(ValueError, match=words):
        list(drawn_frames(trace(tmp_path / "game.trace"), GEFORCE_256, frames))


def test_what_cannot_be_read_is_said(tmp_path):
    path = trace(tmp_path / "game.trace")
    path.write_bytes(path.read_bytes()[:-3])
    with pytest.raises(Refusal, match=r"game\.trace.* at byte"):
        list(drawn_frames(path, GEFORCE_256, "all"))
    with pytest.raises(Refusal, match=r"absent\.trace cannot be read"):
        list(drawn_frames(tmp_path / "absent.trace", GEFORCE_256))
