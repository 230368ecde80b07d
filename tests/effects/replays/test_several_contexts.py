"""What contexts leave to each other, and what a damaged or a long trace may not fill the memory with."""

import numpy as np
import pytest

from fixedpipe.effects.replays import postponed, windows
from fixedpipe.effects.replays import replay as replay_module
from fixedpipe.effects.replays.asked import FramesAsked
from fixedpipe.effects.replays.replay import Replay
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, OPENGL_1_2
from tests.effects.replays.programs import (
    BLUE,
    BYTES,
    DISPLAY,
    GREEN,
    RED,
    Program,
    color_of,
    replayed,
    sentences,
    started,
)

_FRAMEBUFFER, _COLOR = T.FRAMEBUFFER_EXT, T.COLOR_ATTACHMENT0_EXT


def _with_texture(program):
    program.call("glBindTexture", T.TEXTURE_2D, 1)
    return program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 4, 4, 0, T.RGBA, T.UNSIGNED_BYTE, None)


def _into_an_object(program):
    _with_texture(program).call("glBindFramebufferEXT", _FRAMEBUFFER, 5)
    program.call("glFramebufferTexture2DEXT", _FRAMEBUFFER, _COLOR, T.TEXTURE_2D, 1, 0)
    return program.clear(BLUE)


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3], ids=lambda profile: profile.name)
def test_a_framebuffer_object_is_bound_in_its_own_context_alone(profile):
    program = _into_an_object(started())
    program.context(100, share=99).current(100, size=None).clear(GREEN).swap()
    program.current(99, size=None).clear(RED).call("glBindFramebufferEXT", _FRAMEBUFFER, 0)
    _, frames = replayed(program.swap(), profile)
    assert [color_of(frame) for frame in frames] == [BYTES[GREEN]] * 2


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3], ids=lambda profile: profile.name)
def test_a_context_that_left_its_framebuffer_object_in_another_window_draws_into_this_one(profile):
    program = _into_an_object(started()).current(99, 0x33).call("glBindFramebufferEXT", _FRAMEBUFFER, 0)
    _, (frame,) = replayed(program.current(99, size=None).clear(RED).swap(), profile)
    assert color_of(frame) == BYTES[RED]


def test_a_framebuffer_object_that_another_context_deletes():
    program = _into_an_object(started())
    program.context(100, share=99).current(100, 0x33).call("glDeleteFramebuffersEXT", 1, [5])
    program.current(99, size=None).call("glBindFramebufferEXT", _FRAMEBUFFER, 0).clear(RED).swap()
    replay, frames = replayed(program)
    assert color_of(frames[-1]) == BYTES[RED] and not sentences(replay, "refused")


def test_a_clear_of_what_an_object_lacks_clears_the_rest():
    program = _into_an_object(started()).clear(GREEN, T.COLOR_BUFFER_BIT | T.ACCUM_BUFFER_BIT)
    program.call("glBindFramebufferEXT", _FRAMEBUFFER, 0).clear(RED).call("glEnable", T.TEXTURE_2D)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    replay, (frame,) = replayed(program.rectangle((1.0, 1.0, 1.0, 1.0)).swap(), OPENGL_1_2)
    assert color_of(frame) == BYTES[GREEN] and not sentences(replay, "refused")


def test_the_end_of_another_context_of_a_window_ends_no_frame():
    program = started().rectangle(RED, 0.0)
    program.thread = 1
    program.context(100, share=99).current(100, size=None).call("glXDestroyContext", DISPLAY, 100)
    program.thread = 0
    _, frames = replayed(program.rectangle(GREEN, -1.0, 0.0).swap())
    assert [(frame.ended, frame.draws) for frame in frames] == [("glXSwapBuffers", 2)]


@pytest.mark.parametrize("flags", [0, 1 << 30])
def test_the_number_of_a_pixel_format_decides_and_not_the_descriptor_beside_it(flags):
    descriptor = [{"dwFlags": flags, "iPixelType": 0}]
    program = Program().call("wglChoosePixelFormatARB", 5, [0x2011, 1, 0], None, 1, [3], [1], result=1)
    program.call("SetPixelFormat", 5, 3, descriptor, result=1).call("wglCreateContext", 5, result=99)
    program.call("wglMakeCurrent", 5, 99, result=1).call("glViewport", 0, 0, 6, 3, flags=1)
    for color in (RED, GREEN):
        program.rectangle(color).call("SwapBuffers", 5)
    _, frames = replayed(program)
    assert [color_of(frame) for frame in frames] == [BYTES[RED], BYTES[GREEN]]


def test_a_described_pixel_format_is_known():
    program = Program()
    program.call("DescribePixelFormat", 5, 3, 40, [{"dwFlags": 4, "iPixelType": 0}], result=9)
    program.call("SetPixelFormat", 5, 3, [{"dwFlags": 1, "iPixelType": 0}], result=1)
    program.call("wglCreateContext", 5, result=99).call("wglMakeCurrent", 5, 99, result=1)
    _, frames = replayed(program.rectangle(RED).call("glFlush"))
    assert [frame.ended for frame in frames] == ["glFlush"]


def test_lists_are_shared_only_by_a_call_that_succeeded():
    program = Program().call("wglCreateContext", 5, result=99).call("wglCreateContext", 5, result=100)
    program.call("wglShareLists", 99, 100, result=0)
    program.call("wglMakeCurrent", 5, 99, result=1).call("glNewList", 1, T.COMPILE).clear(RED)
    program.call("glEndList").call("wglMakeCurrent", 5, 100, result=1).call("glCallList", 1)
    _, (frame,) = replayed(program.rectangle(GREEN, 0.0).call("SwapBuffers", 5))
    assert color_of(frame) != BYTES[RED]


def test_a_context_that_was_first_in_a_pbuffer_draws_into_a_window_s_back_buffer():
    program = Program().call("eglCreateContext", 1, 2, None, [0x3038], result=99)
    program.call("eglCreatePbufferSurface", 1, 2, [0x3057, 6, 0x3056, 3, 0x3038], result=5)
    program.call("eglCreateWindowSurface", 1, 2, 3, [0x3038], result=6)
    program.call("eglMakeCurrent", 1, 5, 5, 99, result=1).call("eglMakeCurrent", 1, 6, 6, 99, result=1)
    program.call("glViewport", 0, 0, 6, 3, flags=1)
    for color in (RED, GREEN):
        program.rectangle(color).call("eglSwapBuffers", 1, 6)
    _, frames = replayed(program)
    assert [color_of(frame) for frame in frames] == [BYTES[RED], BYTES[GREEN]]


def test_the_buffer_that_drawbuffers_chooses_is_drawn_into():
    program = started().clear(RED).call("glDrawBuffersARB", 1, [T.FRONT_LEFT]).rectangle(GREEN)
    _, (frame,) = replayed(program.call("glDrawBuffersARB", 1, [T.BACK_LEFT]).swap())
    assert color_of(frame) == BYTES[RED]


@pytest.mark.parametrize("profile", [GEFORCE_256, OPENGL_1_2], ids=lambda profile: profile.name)
def test_an_auxiliary_buffer_is_read_where_the_machine_has_one(profile):
    program = started().clear(RED).call("glDrawBuffer", T.AUX0).clear(GREEN).call("glReadBuffer", T.AUX0)
    program.call("glDrawBuffer", T.BACK)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    program.call("glCopyTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 0, 0, 4, 4, 0).call("glEnable", T.TEXTURE_2D)
    program.clear(BLUE).rectangle((1.0, 1.0, 1.0, 1.0))
    replay, (frame,) = replayed(program.swap(), profile)
    assert color_of(frame) == BYTES[GREEN] and not sentences(replay, "refused")
    assert bool(sentences(replay, "error")) == (profile is GEFORCE_256)


def test_pixels_are_copied_into_both_buffers_as_commands_before_them_left_the_one_that_is_read():
    program = started().clear(RED).call("glDrawBuffer", T.FRONT_AND_BACK).rectangle(GREEN, 0.0)
    program.call("glWindowPos2i", 0, 0).call("glReadBuffer", T.BACK)
    _, (frame,) = replayed(program.call("glCopyPixels", 4, 0, 4, 4, T.COLOR).swap())
    assert color_of(frame, 0) == BYTES[GREEN]


def test_depths_that_a_clear_of_a_part_leaves_are_kept():
    program = started()
    program.call("glEnable", T.DEPTH_TEST).call("glEnable", T.SCISSOR_TEST).call("glClearDepth", 0.0)
    program.call("glClear", T.DEPTH_BUFFER_BIT).swap().call("glDisable", T.SCISSOR_TEST)
    program.clear(RED, T.COLOR_BUFFER_BIT).swap().rectangle(GREEN).swap()
    _, whole = replayed(program)
    asked = FramesAsked.of("2")
    _, frames = replayed(program, wanted=asked.wants, needed=asked.may_want)
    np.testing.assert_array_equal(frames[2].image, whole[2].image)


# ---------------------------------------------------------------------------------------------------- limits


def test_images_that_wait_are_counted_by_their_bytes(monkeypatch):
    monkeypatch.setattr(postponed, "_MOST_BYTES", 1 << 12)
    program = started().call("glRasterPos2f", -1.0, -1.0)
    for _ in range(40):
        program.call("glDrawPixels", 8, 4, T.RGBA, T.UNSIGNED_BYTE, bytes(128)).swap()
    asked = FramesAsked.of("39")
    found, kept = postponed.Postponed.take, []
    monkeypatch.setattr(
        postponed.Postponed, "take", lambda self, c: (kept.append(self._bytes), found(self, c))[1]
    )
    replayed(program, wanted=asked.wants, needed=asked.may_want)
    assert 1 << 12 < max(kept) < 1 << 14


def test_textures_of_draws_that_wait_are_counted_by_their_bytes(monkeypatch):
    monkeypatch.setattr(replay_module, "_MOST_BYTES", 1 << 12)
    program = started().call("glEnable", T.TEXTURE_2D)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    for _ in range(64):
        program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 8, 8, 0, T.RGBA, T.UNSIGNED_BYTE, bytes(256))
        program.rectangle(RED)
    replay, waiting = Replay(GEFORCE_256), []
    for call in program.calls:
        replay.take(call)
        context = replay.windows.current(0)
        waiting.append(0 if context is None or context.gl is None else len(context.gl.commands))
    assert 16 < max(waiting) < 48  # of 128: a texture and a rectangle each


def test_contexts_are_limited(monkeypatch):
    monkeypatch.setattr(windows, "_MOST_CONTEXTS", 8)
    program = started()
    for context in range(100, 130):
        program.current(context, size=None)
    replay, _ = replayed(program.current(99).rectangle(RED).swap())
    assert sum(sentences(replay, "refused").values()) == 23
    assert len(replay.windows._contexts) == 8


def test_infinite_sizes_are_counted():
    program = started().call("glXCreateGLXPbufferSGIX", DISPLAY, 4, float("inf"), 4.0, [0], result=70)
    replay, _ = replayed(program.clear(RED).swap())
    assert any("OverflowError" in sentence for sentence in sentences(replay, "refused"))
