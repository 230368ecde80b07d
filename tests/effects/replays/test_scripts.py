"""A frame by itself: its commands and what came before, in memory and as a script."""

import runpy

import numpy as np
import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.replays.driving import frame_of_trace
from fixedpipe.effects.replays.recording import frame_commands
from fixedpipe.effects.replays.scripts import npz_bytes, script_text
from fixedpipe.pipeline.commands import Clear, DrawPixels, HostStep, TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, PROFILES
from tests.effects.replays.programs import BLUE, BYTES, GREEN, RED, color_of, replayed, started


def _program():
    """Three frames: each adds to what the last left in colours, depths, stencil values and textures."""
    program = started()
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MAG_FILTER, T.NEAREST)
    texels = bytes([9, 200, 7, 255, 100, 20, 30, 255])
    program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 2, 1, 0, T.RGBA, T.UNSIGNED_BYTE, texels)
    program.clear(RED).call("glEnable", T.DEPTH_TEST).call("glEnable", T.STENCIL_TEST)
    program.call("glStencilOp", T.KEEP, T.KEEP, T.INCR)
    program.call("glTranslatef", 0.0, 0.0, 0.3).rectangle(GREEN, -1.0, 0.0).swap()
    program.call("glTranslatef", 0.0, 0.0, -0.5).rectangle(BLUE, -0.5, 0.5).swap()
    program.call("glStencilFunc", T.EQUAL, 1, 0xFF).call("glTranslatef", 0.0, 0.0, -0.2)
    program.call("glEnable", T.TEXTURE_2D).call("glBegin", T.QUADS)
    for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        program.call("glTexCoord2f", (x + 1) / 2, 0.0).call("glVertex2f", x, y)
    return program.call("glEnd").swap()


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3, PROFILES["OCTANE"]], ids=lambda p: p.name)
@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_frame_alone_has_the_bits_of_the_frame_in_its_trace(profile, number):
    _, frames = replayed(_program(), profile, recorded=lambda n: n == number)
    frame = frames[number]
    commands = frame_commands(frame.recording, frame.shown)
    alone = execute(commands, profile, frame.width, frame.height)
    np.testing.assert_array_equal(alone.image(), frame.image)
    assert all(f.recording is None for f in frames if f is not frame)


def test_a_frame_begins_with_what_it_reads_and_with_no_more():
    _, frames = replayed(_program(), recorded=lambda n: True)
    kinds = [[type(c) for c in frame_commands(f.recording, f.shown)] for f in frames]
    assert kinds[0][0] is Clear and DrawPixels not in kinds[0] and TexImage not in kinds[0]
    assert kinds[1].count(DrawPixels) == 3 and TexImage not in kinds[1]
    assert kinds[2].count(TexImage) == 1


def test_depths_of_24_bits_survive():
    program = started().clear(RED).call("glDepthMask", True).call("glEnable", T.DEPTH_TEST)
    for n in range(8):
        program.call("glLoadIdentity").call("glTranslatef", 0.0, 0.0, 0.123456789 * n - 0.4)
        program.rectangle(GREEN, -1.0 + n / 4, -0.75 + n / 4)
    _, frames = replayed(program.swap().rectangle(BLUE).swap(), recorded=lambda n: n == 1)
    before = frames[1].recording.framebuffers["back"]
    commands = frame_commands(frames[1].recording, "back")
    drawn = execute(commands[: len(commands) - 1], GEFORCE_256, 8, 4).framebuffer
    np.testing.assert_array_equal(drawn.depth, before.depth)
    assert len(np.unique(before.depth)) >= 5


@pytest.mark.parametrize("number", [0, 2])
def test_a_script_draws_the_same_without_the_trace(tmp_path, number):
    _, frames = replayed(_program(), recorded=lambda n: n == number)
    frame = frames[number]
    commands = frame_commands(frame.recording, frame.shown)
    text, arrays = script_text(
        commands, "GEFORCE_256", frame.width, frame.height, 'a "frame" \\ of """three"""'
    )
    path = tmp_path / "frame.py"
    path.write_text(text)
    (tmp_path / "frame.npz").write_bytes(npz_bytes(arrays))
    made = runpy.run_path(str(path))
    drawn = execute(made["commands"], PROFILES[made["profile"]], made["width"], made["height"])
    np.testing.assert_array_equal(drawn.image(), frame.image)
    assert [c.label for c in made["commands"]] == [c.label for c in commands]


def test_a_script_has_equal_states_once_and_no_functions():
    program = started().clear(RED)
    for n in range(10):
        program.rectangle(GREEN, -1.0 + n / 10, 1.0)
    _, (frame,) = replayed(program.swap(), recorded=lambda n: True)
    text, arrays = script_text(frame_commands(frame.recording, "back"), "GEFORCE_256", 8, 4, "title")
    assert text.count("PassState(") == 1 and text.count("Mesh(") == 10
    assert len(arrays) < 30
    step = HostStep(label="a function", reads=(), commands=lambda pixels: ())
    with pytest.raises(ValueError, match="a function"):
        script_text((step,), "GEFORCE_256", 8, 4, "title")


def test_the_buffer_that_is_shown_is_the_scripts():
    program = started().clear(RED).call("glDrawBuffer", T.FRONT).clear(BLUE)
    program.rectangle(GREEN, 0.0).call("glFrameTerminatorGREMEDY")
    _, (frame,) = replayed(program, recorded=lambda n: True)
    commands = frame_commands(frame.recording, frame.shown)
    assert frame.shown == "front" and len(commands) == 2
    np.testing.assert_array_equal(execute(commands, GEFORCE_256, 8, 4).image(), frame.image)


def test_a_frame_of_a_file(tmp_path):
    path = _program().write(tmp_path / "three.trace")
    commands, width, height, number = frame_of_trace(str(path), 2, GEFORCE_256)
    _, frames = replayed(_program())
    assert (width, height, number) == (8, 4, 2)
    np.testing.assert_array_equal(execute(commands, GEFORCE_256, 8, 4).image(), frames[2].image)
    assert frame_of_trace(str(path), None, GEFORCE_256)[3] == 0
    with pytest.raises(Refusal, match="has no frame 3; its frames are 0 to 2"):
        frame_of_trace(str(path), 3, GEFORCE_256)
    empty = started().swap().write(tmp_path / "empty.trace")
    with pytest.raises(Refusal, match="none draws anything"):
        frame_of_trace(str(empty), None, GEFORCE_256)


def test_a_copied_texture_is_in_the_script():
    program = started().clear(RED).call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    program.call("glCopyTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 0, 0, 4, 4, 0).swap()
    program.clear(BLUE).call("glEnable", T.TEXTURE_2D).rectangle((1.0, 1.0, 1.0, 1.0), 0.0).swap()
    _, frames = replayed(program, recorded=lambda n: n == 1)
    commands = frame_commands(frames[1].recording, "back")
    drawn = execute(commands, GEFORCE_256, 8, 4).image()
    np.testing.assert_array_equal(drawn, frames[1].image)
    assert color_of(frames[1], 7) == BYTES[RED]


def test_what_the_host_did_is_in_the_script_as_it_was_done():
    """Texels from the client beside copied ones: the host reads them back, and stores all anew."""
    program = started().clear(RED).call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MAG_FILTER, T.NEAREST)
    program.call("glCopyTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 0, 0, 4, 4, 0)
    texels = bytes(BYTES[GREEN]) * 8
    program.call("glTexSubImage2D", T.TEXTURE_2D, 0, 0, 0, 2, 4, T.RGBA, T.UNSIGNED_BYTE, texels)
    program.clear(BLUE).call("glEnable", T.TEXTURE_2D).call("glColor4f", 1.0, 1.0, 1.0, 1.0)
    program.call("glBegin", T.QUADS)
    for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
        program.call("glTexCoord2f", s, t).call("glVertex2f", 2 * s - 1, 2 * t - 1)
    _, (frame,) = replayed(program.call("glEnd").swap(), recorded=lambda n: True)
    assert (color_of(frame, 0), color_of(frame, 7)) == (BYTES[GREEN], BYTES[RED])
    commands = frame_commands(frame.recording, "back")
    assert not any(isinstance(command, HostStep) for command in commands)
    np.testing.assert_array_equal(execute(commands, GEFORCE_256, 8, 4).image(), frame.image)
    script_text(commands, "GEFORCE_256", 8, 4, "title")
