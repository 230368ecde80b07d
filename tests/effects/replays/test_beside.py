"""Frames beside Mesa's pictures: shares, doubts, the calls that are compared; ``replay --beside mesa``."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.replays import beside, glretrace
from fixedpipe.effects.replays.beside import Agreement, difference_picture, mesas_pictures
from fixedpipe.effects.replays.recorder import Recorder
from fixedpipe.effects.replays.replay import Replay
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.traces.calls import Trace
from tests.effects.replays.programs import BLUE, BYTES, GREEN, RED, color_of, replayed, started


def pictures(*differences):
    """Two pictures of a row of pixels, whose channels differ as given."""
    ours = np.full((1, len(differences), 3), 100, np.uint8)
    return ours, (ours + np.array(differences)[None]).astype(np.uint8)


def test_a_pixel_counts_by_its_largest_difference():
    ours, theirs = pictures((0, 0, 0), (0, -1, 1), (0, 0, 8), (9, 0, 0))
    assert Agreement.of(ours, theirs) == Agreement(0.25, 0.5, 0.75, 9)
    assert difference_picture(ours, theirs)[0].tolist() == [[0, 0, 0], [0, 16, 16], [0, 0, 128], [144, 0, 0]]


def test_shares_are_rounded_down():
    ours = np.zeros((100, 1000, 3), np.uint8)
    theirs = ours.copy()
    theirs[0, 0] = 255
    assert str(Agreement.of(ours, theirs)).startswith("99.99 % equal, ")
    assert str(Agreement.of(ours, ours)) == (
        "100 % equal, 100 % within 1, 100 % within 8, largest difference 0"
    )


def of_two_runs(monkeypatch, first, second):
    """Mesa's picture of call 7, where glretrace drew these two."""
    runs = iter([first, second])
    monkeypatch.setattr(glretrace, "missing", lambda: None)
    monkeypatch.setattr(glretrace, "display", lambda: _Display())
    monkeypatch.setattr(glretrace, "pictures", lambda shown, path, calls: next(runs))
    (found,) = mesas_pictures("x.trace", [7])
    return found


class _Display:
    def __enter__(self):
        return ":7"

    def __exit__(self, *_):
        pass


def test_a_picture_is_doubted_unless_two_runs_agree_and_it_is_not_empty(monkeypatch):
    ours, theirs = pictures((0, 0, 0), (0, 0, 3))
    assert of_two_runs(monkeypatch, {7: theirs}, {7: theirs}).doubt == ""
    assert "two different pictures" in of_two_runs(monkeypatch, {7: theirs}, {7: ours}).doubt
    assert "two different pictures" in of_two_runs(monkeypatch, {7: theirs}, {7: theirs[:, :1]}).doubt
    assert "one colour everywhere" in of_two_runs(monkeypatch, {7: ours}, {7: ours}).doubt
    nothing = of_two_runs(monkeypatch, {}, {7: ours})
    assert nothing.picture is None and nothing.said(ours) == "glretrace wrote no picture of this frame"


def test_pictures_of_other_sizes_are_not_compared(monkeypatch):
    ours, theirs = pictures((0, 0, 0), (0, 0, 3))
    mesa = of_two_runs(monkeypatch, {7: theirs}, {7: theirs})
    assert mesa.agreement(ours) == Agreement(0.5, 0.5, 1.0, 3)
    assert mesa.agreement(ours[:, :1]) is None
    assert mesa.said(ours[:, :1]) == "its picture has 2x1 pixels"
    assert mesa.data(ours[:, :1]) == {"doubt": ""}


def test_the_call_that_a_frame_is_compared_at():
    program = started().rectangle(GREEN).swap()
    swapped = len(program.calls) - 1
    program.rectangle(RED)
    drawn = len(program.calls) - 1
    program.call("glGetError").call("glXDestroyContext", 1, 99)
    _, frames = replayed(program)
    assert [(frame.seen_call, frame.last_call) for frame in frames] == [
        (swapped, swapped),
        (drawn, len(program.calls) - 1),
    ]
    flushed = started(double=False).rectangle(GREEN).call("glFlush")
    (frame,) = replayed(flushed)[1]
    assert frame.seen_call == frame.last_call == len(flushed.calls) - 1


# ------------------------------------------------------------------------------------------- the command


def said(*arguments):
    result = CliRunner().invoke(main, ["replay", *map(str, arguments)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exc_info
    return result.exit_code, " ".join(result.output.split())


@pytest.mark.parametrize("cut", [None, 40])
def test_pictures_from_before_glretrace_failed_are_kept(cut, monkeypatch):
    """Mesa may fail in a later frame; of the frame in which it fails, the file may be cut off."""

    def run(shown, arguments):
        folder = Path(arguments[arguments.index("-s") + 1])
        for call in (7, 9):
            Image.new("RGB", (2, 2), (call, 0, 0)).save(folder / f"{call}.png")
        (folder / "9.png").write_bytes((folder / "9.png").read_bytes()[:cut])
        raise glretrace.GlretraceError("glretrace ended with status -6.")

    monkeypatch.setattr(glretrace, "run", run)
    found = glretrace.pictures(":1", "a.trace", [7, 9])
    assert sorted(found) == ([7] if cut else [7, 9]) and found[7][0, 0].tolist() == [7, 0, 0]


def test_a_failure_without_a_picture_is_told(monkeypatch):
    def run(shown, arguments):
        raise glretrace.GlretraceError("glretrace ended with status -6.")

    monkeypatch.setattr(glretrace, "run", run)
    with pytest.raises(glretrace.GlretraceError, match="status -6"):
        glretrace.pictures(":1", "a.trace", [7])


def test_without_glretrace_a_sentence_says_how_to_get_it(tmp_path, monkeypatch):
    path = started().rectangle(GREEN).swap().write(tmp_path / "a.trace")
    monkeypatch.setattr(glretrace.shutil, "which", lambda name: None)
    status, text = said(path, "--beside", "mesa", "--out", tmp_path / "out")
    assert status == 2 and "apt install apitrace xvfb" in text
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-"], "give a file"),
        (["a.trace", "--size", "4x4"], "leave --size out"),
        (["a.trace", "--list"], "--list draws"),
    ],
)
def test_what_beside_cannot_do_is_refused(arguments, words, monkeypatch):
    monkeypatch.setattr(glretrace, "missing", lambda: None)
    status, text = said(*arguments, "--beside", "mesa")
    assert status == 2 and words in text


def test_pictures_and_differences_are_written(tmp_path, monkeypatch):
    path = started().clear(BLUE).rectangle(GREEN, 0.0).swap().write(tmp_path / "a.trace")
    ours = replayed(started().clear(BLUE).rectangle(GREEN, 0.0).swap())[1][0].image[..., :3]
    mesa = ours.copy()
    mesa[0, 0, 0] += 4
    asked = []
    monkeypatch.setattr(glretrace, "missing", lambda: None)
    monkeypatch.setattr(
        beside, "mesas_pictures", lambda path, calls: asked.append(calls) or [beside.Beside(mesa)]
    )
    status, text = said(path, "--beside", "mesa", "--out", tmp_path, "--json", tmp_path / "r.json")
    assert status == 0 and "beside Mesa: 96.87 % equal, 96.87 % within 1, 100 % within 8" in text
    with Image.open(tmp_path / "a-mesa-0.png") as picture:
        np.testing.assert_array_equal(np.asarray(picture), mesa)
    with Image.open(tmp_path / "a-GEFORCE_256-0-difference.png") as picture:
        assert np.argwhere(np.asarray(picture)).tolist() == [[0, 0, 0]]
    (frame,) = json.loads((tmp_path / "r.json").read_text())["frames"]
    assert frame["mesa"] == {"doubt": "", "equal": 31 / 32, "near": 31 / 32, "far": 1.0, "largest": 4}
    assert asked == [[frame["seen_call"]]]


def test_what_glretrace_draws_of_a_trace_of_our_own(tmp_path):
    """A real run. The program is one that every driver draws with the same bits: whole pixels, one colour."""
    if (lacking := glretrace.missing()) is not None:
        pytest.skip(lacking)
    path = str(tmp_path / "own.trace")
    with Recorder(path, 64, 48) as gl:
        for _ in range(2):  # of the first frame, glretrace's window has no size yet
            gl.ClearColor(*BLUE)
            gl.Clear(T.COLOR_BUFFER_BIT)
            gl.Color4f(*GREEN)
            gl.Rectf(0.0, -1.0, 1.0, 1.0)
            gl.swap()
    replay = Replay(GEFORCE_256)
    with Trace(path) as trace:
        _, ours = [frame for call in trace for frame in replay.take(call)]
    assert (color_of(ours), color_of(ours, 63)) == (BYTES[BLUE], BYTES[GREEN])
    (mesa,) = mesas_pictures(path, [ours.seen_call])
    assert (
        mesa.said(ours.image[..., :3]) == "100 % equal, 100 % within 1, 100 % within 8, largest difference 0"
    )
