"""``fixedpipe replay``: what it writes and says, its exit status; frames of traces in other subcommands."""

import io
import json
import runpy

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.replays.driving import opened
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_256
from tests.effects.replays.programs import BLUE, GREEN, RED, replayed, started


def said(*arguments, stdin=None):
    """(exit status, what it prints)."""
    result = CliRunner().invoke(main, [str(a) for a in arguments], input=stdin)
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exc_info
    return result.exit_code, result.output


def program():
    """Four frames: a clear, and three with a rectangle."""
    made = started().clear(RED).swap()
    for n in range(3):
        made.clear(BLUE).rectangle(GREEN, -1.0 + n / 2).swap()
    return made


@pytest.fixture
def trace(tmp_path, monkeypatch):
    """A trace in the working folder."""
    monkeypatch.chdir(tmp_path)
    return program().write(tmp_path / "three.trace")


def pictures(folder):
    return sorted(path.name for path in folder.glob("*.png"))


def test_the_first_frame_that_draws_is_written_with_its_digest(trace, tmp_path):
    status, text = said("replay", trace)
    assert status == 0, text
    assert pictures(tmp_path / "out") == ["three-GEFORCE_256-1.png"]
    _, frames = replayed(program())
    with Image.open(tmp_path / "out" / "three-GEFORCE_256-1.png") as picture:
        np.testing.assert_array_equal(np.asarray(picture), frames[1].image[..., :3])
    assert f"sha256 {digest(frames[1].image)}" in text
    assert "frame 1: 1 draw in calls" in text and "drawn: 1 (glEnd 1)" in text


def test_frames_are_chosen_by_number(trace, tmp_path):
    status, text = said("replay", trace, "--frames", "0,2-3", "--out", "here", "--profile", "GEFORCE_3")
    assert status == 0, text
    assert pictures(tmp_path / "here") == [f"three-GEFORCE_3-{n}.png" for n in (0, 2, 3)]
    assert "4 frames with 3 draws." in text


def test_all_frames_and_json(trace, tmp_path):
    status, text = said("replay", trace, "--frames", "all", "--json", "r.json", "--check")
    assert status == 0, text
    record = json.loads((tmp_path / "r.json").read_text())
    assert [frame["draws"] for frame in record["frames"]] == [0, 1, 1, 1]
    assert [frame["sha256"] for frame in record["frames"]] == [
        digest(f.image) for f in replayed(program())[1]
    ]
    assert record["profile"] == "GEFORCE_256" and record["damage"] is None
    assert record["summary"]["drawn"] == [{"what": "glEnd", "first_call": 16, "count": 3}]
    none = {"compared": 0, "differing": 0, "differences": [], "counts": 0, "equal_counts": 0}
    assert record["check"] == none


def test_standard_input_is_streamed(trace):
    status, text = said("replay", "-", "--frames", "2", stdin=io.BytesIO(trace.read_bytes()))
    assert status == 0, text
    assert "out/trace-GEFORCE_256-2.png" in text


def test_a_size_for_every_window(trace, tmp_path):
    assert said("replay", trace, "--size", "5x7")[0] == 0
    with Image.open(tmp_path / "out" / "three-GEFORCE_256-1.png") as picture:
        assert picture.size == (5, 7)


def test_a_refusal_is_told_with_its_call_and_ends_with_status_1(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = started().clear(RED)
    for plane in range(7):
        made.call("glEnable", T.CLIP_PLANE0 + plane)
    made.rectangle(GREEN).rectangle(GREEN).swap().write("planes.trace")
    status, text = said("replay", "planes.trace", "--frames", "0")
    assert status == 1, text
    assert "refused: 2\n" in text
    assert f"  call {len(made.calls) - 9}, 2 times in all: glEnd: GeForce 256 has 6 clip planes" in text


def test_an_unknown_function_ends_with_status_1(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    started().call("glUseProgramOfTomorrow", 1).rectangle(GREEN).swap().write("later.trace")
    status, text = said("replay", "later.trace")
    assert (status, "unknown here: 1 (glUseProgramOfTomorrow 1)" in text) == (1, True), text


def test_an_answer_that_differs_ends_with_status_1(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = started().rectangle(GREEN).swap().rectangle(GREEN).swap()
    made.call("glIsEnabled", T.BLEND, result=1)
    made.write("answers.trace")
    status, text = said("replay", "answers.trace", "--check")
    assert status == 1, text
    assert "0 of 1 recorded answers agree.\n" in text and "recorded 1" in text
    assert "drawn: 1 (glEnd 1)" in text  # of the frame that was asked for
    assert said("replay", "answers.trace")[0] == 0


def test_a_damaged_trace_keeps_what_was_drawn(trace, tmp_path):
    whole = trace.read_bytes()
    (tmp_path / "cut.trace").write_bytes(whole[: len(whole) - 20])
    status, text = said("replay", "cut.trace", "--frames", "all")
    assert status == 2, text
    assert pictures(tmp_path / "out")[:1] == ["cut-GEFORCE_256-0.png"]
    assert "fixedpipe: The trace" in text and "at byte" in text
    assert said("replay", "cut.trace", "--frames", "0")[0] == 0


def test_a_damaged_trace_that_draws_nothing_before_is_none(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    started().write("whole.trace")
    assert said("replay", "whole.trace")[0] == 0  # it draws nothing, and is whole
    whole = (tmp_path / "whole.trace").read_bytes()
    (tmp_path / "cut.trace").write_bytes(whole[: len(whole) - 4])
    status, text = said("replay", "cut.trace")
    assert status == 2 and "has no frame: nothing is drawn" in text, text


@pytest.mark.parametrize("command", [("inspect", "--pixel", "1,1"), ("passes",), ("precision",), ("print",)])
def test_a_frame_without_a_number_is_refused(trace, command):
    name, *options = command
    status, text = said(name, f"{trace}#last", *options)
    assert (status, "write the number of a frame, from 0, after #" in text) == (2, True), text


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "is empty"),
        (b"at", "The trace"),
        (b"\x1f\x8bnonsense", "damaged"),
        (b"P6 not a trace", "no trace"),
    ],
)
def test_what_is_no_trace_ends_with_status_2(tmp_path, monkeypatch, content, sentence):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "none.trace").write_bytes(content)
    for more in ((), ("--list",)):
        status, text = said("replay", "none.trace", *more)
        assert (status, sentence in text) == (2, True), text


def test_a_frame_that_is_not_there_ends_with_status_2(trace):
    status, text = said("replay", trace, "--frames", "1,9")
    assert (status, "has no frame 9; its frames are 0 to 3." in text) == (2, True), text
    assert "frame 1: 1 draw " in text


def test_a_trace_that_draws_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    started().clear(RED).swap().write("nothing.trace")
    status, text = said("replay", "nothing.trace")
    assert (status, "has 1 frame, and none draws anything." in text) == (0, True), text
    started().write("less.trace")
    status, text = said("replay", "less.trace")
    assert (status, "has no frame: nothing is drawn." in text) == (0, True), text


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("three.trace", "--frames", "x"), "--frames is 'x'"),
        (("three.trace", "--size", "5"), "--size is '5'"),
        (("three.trace", "--size", "0x4"), "--size is '0x4'"),
        (("three.trace", "--size", "9999x4"), "draws up to 2048x2048 pixels"),
        (("three.trace", "--profile", "IDEAL"), "IDEAL is no machine"),
        (("three.trace", "--profile", "GEFORCE256"), "Did you mean GEFORCE_256?"),
        (("three.trace", "--frames", "all", "--save-script", "a.py"), "--save-script writes one frame"),
        (("three.trace", "--save-script", "a.txt"), "must end with .py"),
        (("three.trace", "--frames", "all", "--video", "a.png"), "how many frames it has"),
        (("three.trace", "--fps", "5"), "--fps would be ignored"),
        (("three.trace", "--list", "--frames", "1"), "--frames would be ignored"),
        (("missing.trace",), "missing.trace cannot be read"),
        (("two\0parts",), "no name of a file"),
    ],
)
def test_what_cannot_be_done_is_refused(trace, arguments, sentence):
    status, text = said("replay", *arguments)
    assert (status, sentence in text) == (2, True), text


def test_a_script_is_inspected_and_draws_the_same(trace, tmp_path):
    status, text = said("replay", trace, "--frames", "2", "--save-script", "frame.py")
    assert status == 0, text
    made = runpy.run_path(str(tmp_path / "frame.py"))
    drawn = execute(made["commands"], GEFORCE_256, made["width"], made["height"])
    assert f"sha256 {digest(drawn.image())}" in text
    status, text = said("inspect", "frame.py", "--pixel", "6,1", "--brief")
    assert (status, "glEnd (call" in text) == (0, True), text


def test_other_subcommands_take_a_frame_of_a_trace(trace):
    status, text = said("inspect", "three.trace#2", "--pixel", "6,1")
    assert (status, "three.trace, frame 2, on GeForce 256" in text, "glEnd (call" in text) == (
        0,
        True,
        True,
    ), text
    status, text = said("compare", "three.trace#2", "three.trace#2", "--machines", "GEFORCE_256", "NV2A")
    assert (status, "Every command leaves equal colours, depths and stencil values." in text) == (0, True), (
        text
    )
    status, text = said("passes", "three.trace")
    assert (status, 'Draw "glEnd (call' in text) == (0, True), text
    status, text = said("precision", "three.trace#1", "--bits", "8")
    assert (status, "8x4 pixels" in text) == (0, True), text
    status, text = said("inspect", "three.trace#9", "--pixel", "1,1")
    assert (status, "has no frame 9" in text) == (2, True), text
    status, text = said("inspect", "three.trace#1", "--pixel", "1,1", "--size", "7")
    assert (status, "--size and --set are a figure's" in text) == (2, True), text


def test_the_list_names_a_machine(trace, tmp_path):
    status, text = said("replay", trace, "--list", "--json", "list.json")
    assert status == 0, text
    assert "three.trace: a trace of version 6, " in text and "4 frames, 3 draws\n" in text
    assert "sizes: 8x4 (4 frames)\n" in text and "glVertex2f 12" in text
    assert "GEFORCE_256          nothing\n" in text and text.endswith("recommended: GEFORCE_256\n")
    record = json.loads((tmp_path / "list.json").read_text())
    assert (record["frames"], record["recommended"]) == (4, "GEFORCE_256")
    status, text = said("replay", trace, "--list", "--profile", "OCTANE")
    assert (status, "OCTANE               nothing" in text, "GEFORCE" in text) == (0, True, False), text
    assert not (tmp_path / "out").exists()


def test_an_animation(trace, tmp_path):
    status, text = said("replay", trace, "--frames", "0-3", "--video", "a.webp", "--fps", "5")
    assert status == 0, text
    with Image.open(tmp_path / "a.webp") as animation:
        assert (animation.n_frames, animation.size) == (4, (8, 4))


@pytest.mark.parametrize("ending", ["png", "webp"])
def test_no_animation_is_written_of_frames_that_the_trace_lacks(trace, tmp_path, ending):
    status, text = said("replay", trace, "--frames", "500", "--video", f"a.{ending}")
    assert (status, "has no frame 500" in text) == (2, True), text
    assert not (tmp_path / f"a.{ending}").exists()


def test_an_animation_says_how_many_frames_it_has(trace, tmp_path):
    status, text = said("replay", trace, "--frames", "0-9", "--video", "a.png")
    assert status == 2, text
    with Image.open(tmp_path / "a.png") as animation:
        assert animation.n_frames == 4
        animation.seek(3)


def test_what_the_caller_fails_at_is_not_the_trace_s_fault(trace):
    with pytest.raises(OSError, match="the caller's"), opened(str(trace)):
        raise OSError("the caller's")


def test_sizes_of_too_many_digits_are_refused(trace):
    status, text = said("replay", trace, "--size", f"{'9' * 5000}x4")
    assert status != 0 and "Traceback" not in text


def test_a_traced_program_sees_a_machine():
    status, text = said("profiles", "GEFORCE_256", "--gltrace-conf")
    assert status == 0, text
    assert 'GL_RENDERER = "GeForce 256/AGP/SSE"\n' in text and "GL_MAX_TEXTURE_SIZE = 2048\n" in text
    assert "GL_NV_register_combiners" in text and text.count('"') == 8
    assert max(map(len, text.splitlines())) < 120
    combined = {
        year: "GL_ARB_texture_env_combine"
        in said("profiles", "GEFORCE_256", "--gltrace-conf", "--year", year)[1]
        for year in (1999, 2000, 2001, 2002)
    }
    assert combined == {1999: False, 2000: False, 2001: True, 2002: True}
    for arguments in (("--gltrace-conf",), ("GEFORCE_256", "--year", "1999"), ("IDEAL", "--gltrace-conf")):
        assert said("profiles", *arguments)[0] == 2


@pytest.mark.needs_shared
@pytest.mark.parametrize(
    ("name", "profile", "draws"),
    [
        ("rc", "GEFORCE_256", 1),
        ("redbook/fog", "GEFORCE_3", 5),
        ("convolution_imaging", "OPENGL_1_2_IMAGING", 1),
    ],
)
def test_recorded_programs_are_drawn_whole(shared, tmp_path, monkeypatch, name, profile, draws):
    monkeypatch.chdir(tmp_path)
    path = shared / "replay" / "traces" / f"{name}.trace"
    status, text = said("replay", path, "--profile", profile, "--check")
    assert status == 0, text
    assert f"frame 0: {draws} draw" in text
