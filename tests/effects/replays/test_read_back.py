"""Calls that take pixels of the framebuffer in mid-frame: tables, filters, copies between framebuffers."""

import numpy as np
import pytest

from fixedpipe.effects.replays.recording import frame_commands
from fixedpipe.effects.replays.targets import Judged
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import PROFILES
from tests.effects.replays.programs import BLUE, BYTES, GREEN, RED, color_of, replayed, started

IMAGING = PROFILES["OPENGL_1_2_IMAGING"]
_ROW = np.array([[9, 80, 7, 255], [100, 101, 102, 3], [255, 0, 1, 2], [44, 55, 66, 77]], np.uint8)
_IMAGE = np.arange(4 * 8 * 4, dtype=np.uint8).reshape(4, 8, 4)
_TABLES = (T.COLOR_TABLE, T.POST_CONVOLUTION_COLOR_TABLE, T.POST_COLOR_MATRIX_COLOR_TABLE)


def draw(program, image):
    """Draw RGBA bytes from the lower left pixel on."""
    height, width = image.shape[:2]
    program.call("glWindowPos2i", 0, 0)
    return program.call("glDrawPixels", width, height, T.RGBA, T.UNSIGNED_BYTE, image.tobytes())


def refused(replay):
    kinds = ("refused", "error", "unknown", "left out")
    return [outcome.what for kind in kinds for outcome in replay.tally.of(kind)]


def pictures(*programs, profile=IMAGING):
    """The last frame's picture of each program, of which no call goes wrong."""
    found = []
    for program in programs:
        replay, frames = replayed(program, profile)
        assert not refused(replay)
        found.append(frames[-1].image)
    return found


def drawn_with(target, *definition):
    """A program that draws a row, defines a table or filter of it, and draws an image through that."""
    program = draw(started(), _ROW[None])
    program.call(*definition)
    return draw(program.call("glEnable", target), _IMAGE).swap()


# ---------------------------------------------------------------------------------------- tables and filters


@pytest.mark.parametrize("target", _TABLES)
def test_a_table_of_the_framebuffer_is_that_of_its_pixels(target):
    copied = drawn_with(target, "glCopyColorTable", target, T.RGBA, 0, 0, 4)
    given = drawn_with(target, "glColorTable", target, T.RGBA, 4, T.RGBA, T.UNSIGNED_BYTE, _ROW.tobytes())
    first, second = pictures(copied, given)
    assert (first == second).all() and (first != pictures(draw(started(), _IMAGE).swap())[0]).any()


def test_entries_are_replaced_by_pixels():
    table = T.COLOR_TABLE
    whole = ("glColorTable", table, T.RGBA, 4, T.RGBA, T.UNSIGNED_BYTE, bytes(16))
    copied = draw(started(), _ROW[None]).call(*whole).call("glCopyColorSubTable", table, 1, 2, 0, 2)
    entries = ("glColorSubTable", table, 1, 2, T.RGBA, T.UNSIGNED_BYTE, _ROW[2:].tobytes())
    given = draw(started(), _ROW[None]).call(*whole).call(*entries)
    for program in (copied, given):
        draw(program.call("glEnable", table), _IMAGE).swap()
    first, second = pictures(copied, given)
    assert (first == second).all()


def test_filters_are_copied():
    one, two = T.CONVOLUTION_1D, T.CONVOLUTION_2D
    copied = drawn_with(one, "glCopyConvolutionFilter1D", one, T.RGBA, 1, 0, 3)
    image = _ROW[1:].tobytes()
    given = drawn_with(one, "glConvolutionFilter1D", one, T.RGBA, 3, T.RGBA, T.UNSIGNED_BYTE, image)
    first, second = pictures(copied, given)
    assert (first == second).all()
    copied = drawn_with(two, "glCopyConvolutionFilter2D", two, T.RGBA, 0, 0, 3, 2)
    image = np.concatenate([_ROW[:3], np.zeros((3, 4), np.uint8)]).tobytes()
    given = drawn_with(two, "glConvolutionFilter2D", two, T.RGBA, 3, 2, T.RGBA, T.UNSIGNED_BYTE, image)
    first, second = pictures(copied, given)
    assert (first == second).all()


def test_what_waits_is_drawn_before_it_is_read_and_once():
    program = started().clear(RED).rectangle(GREEN, 0.0)
    program.call("glCopyColorTable", T.COLOR_TABLE, T.RGBA, 3, 0, 2).call("glEnable", T.COLOR_TABLE)
    grey = np.array([[[0] * 4, [255] * 4]], np.uint8)
    replay, (frame,) = replayed(draw(program, grey).swap(), IMAGING)
    assert [color_of(frame, x, 3) for x in (0, 1)] == [BYTES[RED], BYTES[GREEN]]
    assert frame.draws == 2 and not refused(replay)


def test_the_buffer_that_is_read_is_read():
    program = started().clear(BLUE).swap().clear(RED).call("glReadBuffer", T.FRONT)
    program.call("glCopyColorTable", T.COLOR_TABLE, T.RGBA, 0, 0, 1).call("glEnable", T.COLOR_TABLE)
    _, frames = replayed(draw(program, np.zeros((1, 1, 4), np.uint8)).swap(), IMAGING)
    assert color_of(frames[-1], 0, 3) == BYTES[BLUE] and color_of(frames[-1], 1, 3) == BYTES[RED]


def test_pixels_outside_the_window_are_zero():
    program = draw(started(), _ROW[None]).call("glCopyColorTable", T.COLOR_TABLE, T.RGBA, -2, 0, 4)
    program.call("glEnable", T.COLOR_TABLE)
    grey = np.array([[[0] * 4, [255] * 4]], np.uint8)
    _, (frame,) = replayed(draw(program, grey).swap(), IMAGING)
    assert color_of(frame, 0, 3) == [0] * 4 and color_of(frame, 1, 3) == _ROW[1].tolist()


def test_no_table_is_a_palette_and_none_is_too_wide():
    program = started().call("glCopyColorTable", T.TEXTURE_2D, T.RGBA, 0, 0, 4)
    program.call("glCopyColorTable", T.COLOR_TABLE, T.RGBA, 0, 0, 1 << 30)
    program.call("glCopyConvolutionFilter2D", T.CONVOLUTION_2D, T.RGBA, 0, 0, 1 << 30, 1 << 30)
    replay, _ = replayed(program, IMAGING)
    kinds = [outcome.what.split(": ")[1].split(",")[0] for outcome in replay.tally.of("error")]
    assert kinds == ["GL_INVALID_ENUM", "GL_TABLE_TOO_LARGE", "GL_INVALID_VALUE"]


def test_a_list_of_machines_validates_what_is_copied():
    program = drawn_with(T.COLOR_TABLE, "glCopyColorTable", T.COLOR_TABLE, T.RGBA, 0, 0, 4)
    replay, _ = replayed(program, IMAGING, target=Judged)
    assert not refused(replay)


def test_a_frame_that_read_its_pixels_is_a_frame_of_its_own():
    program = drawn_with(T.COLOR_TABLE, "glCopyColorTable", T.COLOR_TABLE, T.RGBA, 0, 0, 4)
    _, (frame,) = replayed(program, IMAGING, recorded=lambda number: True)
    commands = frame_commands(frame.recording, frame.shown)
    assert (execute(commands, IMAGING, 8, 4).image() == frame.image).all()
