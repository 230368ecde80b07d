"""Contexts, drawables and threads: what draws where, and how large it is."""

import pytest

from fixedpipe.effects.replays.window_calls import is_window_call
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256
from tests.effects.replays.programs import (
    BLACK,
    BLUE,
    BYTES,
    DISPLAY,
    GREEN,
    RED,
    VISUAL,
    WINDOW,
    Program,
    color_of,
    replayed,
    sentences,
    started,
)


def test_the_inserted_viewport_is_the_size_of_the_window():
    _, (frame,) = replayed(Program().context().current(size=(20, 10)).clear(RED).swap())
    assert (frame.width, frame.height) == (20, 10)
    assert frame.image.shape == (10, 20, 4)


def test_a_viewport_beyond_the_window_makes_it_larger_and_one_within_does_not():
    program = started().clear(RED).swap()
    program.call("glViewport", 2, 1, 3, 2).clear(RED).swap()
    program.call("glViewport", 0, 0, 16, 4).clear(GREEN).swap()
    program.call("glViewport", -8, -4, 64, 64).clear(BLUE).swap()
    _, frames = replayed(program)
    assert [(frame.width, frame.height) for frame in frames] == [(8, 4), (8, 4), (16, 4), (16, 4)]
    assert color_of(frames[2], 15, 3) == BYTES[GREEN]


def test_a_larger_window_keeps_its_lower_left():
    program = started().clear(RED).swap().call("glViewport", 0, 0, 16, 8)
    program.call("glEnable", T.SCISSOR_TEST).call("glScissor", 0, 0, 1, 1).clear(BLUE).swap()
    _, (_, frame) = replayed(program)
    assert color_of(frame, 0, 7) == BYTES[BLUE]
    assert color_of(frame, 7, 4) == BYTES[RED]
    assert color_of(frame, 8, 4) == color_of(frame, 7, 3) == BLACK


def test_a_window_that_changes_its_size_each_frame_is_drawn():
    program = started()
    for number in range(1, 40):
        program.call("glViewport", 0, 0, 8 + number, 4 + number).clear(RED).swap()
    _, frames = replayed(program)
    assert [(f.width, f.height) for f in frames] == [(8 + n, 4 + n) for n in range(1, 40)]
    assert all(color_of(frame, frame.width - 1, 0) == BYTES[RED] for frame in frames)


def test_the_largest_viewport_of_the_machine_is_the_largest_window():
    _, (frame,) = replayed(
        started().call("glViewport", 0, 0, 1 << 20, 3).clear(RED).swap(), wanted=lambda *_: False
    )
    assert (frame.width, frame.height) == (GEFORCE_256.framebuffers.max_viewport, 4)


def test_a_size_that_is_asked_for_is_that_of_every_window():
    program = started().clear(RED).call("glViewport", 0, 0, 100, 100).swap()
    _, (frame,) = replayed(program, size=(5, 6))
    assert (frame.width, frame.height) == (5, 6)


def test_a_pbuffer_has_the_size_of_its_attributes():
    program = Program().context()
    program.call("glXCreatePbuffer", DISPLAY, 1, [0x8041, 12, 0x8040, 6, 0], result=55)
    program.current(window=55, size=None).clear(GREEN).call("glFlush")
    _, frames = replayed(program.rectangle(RED).call("glXDestroyContext", DISPLAY, 99))
    assert [(frame.width, frame.height) for frame in frames] == [(12, 6)]


def test_contexts_share_textures_only_where_they_are_to():
    for share, seen in ((99, BYTES[RED]), (None, BYTES[GREEN])):
        program = started()
        program.call("glBindTexture", T.TEXTURE_2D, 3)
        program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
        program.call(
            "glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 1, 1, 0, T.RGBA, T.UNSIGNED_BYTE, bytes(BYTES[RED])
        )
        program.context(100, share=share).current(100, 0x33)
        program.call("glEnable", T.TEXTURE_2D).call("glBindTexture", T.TEXTURE_2D, 3)
        program.call("glTexEnvi", T.TEXTURE_ENV, T.TEXTURE_ENV_MODE, T.REPLACE)
        _, (frame,) = replayed(program.rectangle(GREEN).swap(0x33))
        assert color_of(frame) == seen


def test_a_texture_copied_in_one_window_is_drawn_in_another():
    program = started().call("glBindTexture", T.TEXTURE_2D, 3).clear(RED)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    program.call("glCopyTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 0, 0, 4, 4, 0)
    program.context(100, share=99).current(100, 0x33)
    program.call("glEnable", T.TEXTURE_2D).call("glBindTexture", T.TEXTURE_2D, 3)
    program.call("glTexEnvi", T.TEXTURE_ENV, T.TEXTURE_ENV_MODE, T.REPLACE)
    replay, (frame,) = replayed(program.rectangle(GREEN).swap(0x33))
    assert color_of(frame) == BYTES[RED]
    assert not sentences(replay, "refused")


def test_threads_have_contexts_of_their_own():
    program = Program()
    for thread, (context, window) in enumerate(((99, WINDOW), (100, 0x33))):
        program.thread = thread
        program.context(context).current(context, window)
    for thread in (0, 1, 0, 1):
        program.thread = thread
        program.call("glClearColor", *(RED if thread == 0 else BLUE))
        program.call("glClear", T.COLOR_BUFFER_BIT)
    program.thread = 0
    _, frames = replayed(program.swap().swap(0x33))
    assert [color_of(frame) for frame in frames] == [BYTES[RED], BYTES[BLUE]]
    assert [frame.window for frame in frames] == [0, 1]


def test_one_window_may_be_drawn_into_by_two_contexts():
    program = started().clear(RED).context(100, share=99).current(100, size=None)
    program.call("glEnable", T.SCISSOR_TEST).call("glScissor", 0, 0, 4, 4).clear(BLUE)
    _, (frame,) = replayed(program.swap())
    assert (color_of(frame, 0), color_of(frame, 7)) == (BYTES[BLUE], BYTES[RED])


@pytest.mark.parametrize("was_current", [True, False])
@pytest.mark.parametrize(
    ("mask", "seen"),
    [(T.ALL_ATTRIB_BITS, BYTES[BLUE]), (T.COLOR_BUFFER_BIT, BYTES[BLUE]), (T.FOG_BIT, BLACK)],
)
def test_groups_of_state_are_copied_to_a_context_that_is_not_current(was_current, mask, seen):
    program = started().context(100)
    if was_current:
        program.current(100, 0x33).current(99, size=None)
    program.call("glClearColor", *BLUE).call("glXCopyContext", DISPLAY, 99, 100, mask)
    program.call("glClearColor", *GREEN).current(100, 0x33).call("glClear", T.COLOR_BUFFER_BIT)
    replay, (frame,) = replayed(program.swap(0x33))
    assert color_of(frame) == seen
    assert not sentences(replay, "error")


@pytest.mark.parametrize(
    ("name", "worked", "failed"), [("wglCopyContext", 1, 0), ("CGLCopyContext", 0, 10004)]
)
def test_a_copy_that_failed_changes_nothing(name, worked, failed):
    for result, seen in ((worked, BYTES[BLUE]), (failed, BLACK)):
        program = started().context(100).call("glClearColor", *BLUE)
        program.call(name, 99, 100, T.ALL_ATTRIB_BITS, result=result)
        program.current(100, 0x33).call("glClear", T.COLOR_BUFFER_BIT)
        _, (frame,) = replayed(program.swap(0x33))
        assert color_of(frame) == seen


def test_a_context_that_is_current_or_unknown_is_not_copied_to():
    program = started().call("glClearColor", *BLUE).context(100)
    program.call("glXCopyContext", DISPLAY, 100, 99, T.ALL_ATTRIB_BITS)
    program.call("glXCopyContext", DISPLAY, 99, 7, T.ALL_ATTRIB_BITS)
    replay, (frame,) = replayed(program.call("glClear", T.COLOR_BUFFER_BIT).swap())
    assert color_of(frame) == BYTES[BLUE]
    assert list(sentences(replay, "error")) == [
        "glXCopyContext: the context that would be changed is current",
        "glXCopyContext: no such context",
    ]


def test_calls_without_a_context_do_nothing():
    program = started().clear(RED).call("glXMakeCurrent", DISPLAY, 0, None, result=1).clear(GREEN)
    replay, (frame,) = replayed(program.swap())
    assert color_of(frame) == BYTES[RED]
    assert "glClear, with no context current" in sentences(replay, "no effect")


def test_a_trace_without_a_window_system_has_a_window_of_its_own():
    program = Program().call("glViewport", 0, 0, 9, 5).clear(RED).rectangle(GREEN, 0.0).call("glFinish")
    _, (frame,) = replayed(program)
    assert (frame.width, frame.height, frame.ended) == (9, 5, "glFinish")
    assert color_of(frame, 8) == BYTES[GREEN]


def test_a_context_that_was_made_before_recording_began_is_one():
    _, (frame,) = replayed(Program().current().clear(RED).swap())
    assert color_of(frame) == BYTES[RED]


def test_colour_indices_are_refused_by_name():
    program = Program()
    chosen = [{"visualid": VISUAL}]
    program.call("glXChooseVisual", DISPLAY, 0, [5, 0], result=chosen)
    program.call("glXCreateContext", DISPLAY, chosen, None, 1, result=99)
    replay, _ = replayed(program.current().clear(RED).swap())
    assert any("colour indices" in sentence for sentence in sentences(replay, "refused"))


@pytest.mark.parametrize(
    ("setup", "swap"),
    [
        (
            (
                ("wglChoosePixelFormat", (5, [{"dwFlags": 1 | 4, "iPixelType": 0}]), 6),
                ("wglSetPixelFormat", (5, 6, [{"dwFlags": 1 | 4, "iPixelType": 0}]), 1),
                ("wglCreateContext", (5,), 99),
                ("wglMakeCurrent", (5, 99), 1),
            ),
            ("wglSwapBuffers", (5,)),
        ),
        (
            (
                ("eglCreateContext", (1, 2, None, [0x3038]), 99),
                ("eglCreateWindowSurface", (1, 2, 3, [0x3038]), 5),
                ("eglMakeCurrent", (1, 5, 5, 99), 1),
            ),
            ("eglSwapBuffers", (1, 5)),
        ),
        (
            (
                ("CGLChoosePixelFormat", ([5, 8, 24, 0], [4], [1]), 0),
                ("CGLCreateContext", (4, None, [99]), 0),
                ("CGLSetCurrentContext", (99,), 0),
            ),
            ("CGLFlushDrawable", (99,)),
        ),
    ],
    ids=["wgl", "egl", "cgl"],
)
def test_other_window_systems(setup, swap):
    program = Program()
    for name, arguments, result in setup:
        program.call(name, *arguments, result=result)
    program.call("glViewport", 0, 0, 6, 3, flags=1)
    program.rectangle(RED).call("glFlush").call(swap[0], *swap[1])
    replay, (frame,) = replayed(program)
    assert (frame.width, frame.height, frame.ended, color_of(frame)) == (6, 3, swap[0], BYTES[RED])
    assert not sentences(replay, "refused")


def test_a_device_that_was_never_current_swaps_the_current_window():
    program = Program().call("wglCreateContext", 5, result=99).call("wglMakeCurrent", 5, 99, result=1)
    _, (frame,) = replayed(program.clear(RED).call("SwapBuffers", 6))
    assert (frame.ended, color_of(frame)) == ("SwapBuffers", BYTES[RED])


def test_the_pbuffers_of_egl_are_single_buffered():
    program = Program().call("eglCreateContext", 1, 2, None, [0x3038], result=99)
    program.call("eglCreatePbufferSurface", 1, 2, [0x3057, 6, 0x3056, 3, 0x3038], result=5)
    program.call("eglMakeCurrent", 1, 5, 5, 99, result=1).rectangle(GREEN).call("glFlush")
    _, (frame,) = replayed(program)
    assert (frame.width, frame.height, frame.ended, color_of(frame)) == (6, 3, "glFlush", BYTES[GREEN])


def test_wgl_share_lists_and_devices_of_pbuffers():
    program = Program()
    program.call("wglCreateContext", 5, result=99).call("wglCreateContext", 5, result=100)
    program.call("wglShareLists", 99, 100, result=1)
    program.call("wglCreatePbufferARB", 5, 6, 4, 2, [0], result=70).call("wglGetPbufferDCARB", 70, result=71)
    program.call("wglMakeCurrent", 5, 99, result=1).call("glNewList", 1, T.COMPILE)
    program.call("glClearColor", *RED).call("glClear", T.COLOR_BUFFER_BIT).call("glEndList")
    program.call("wglMakeCurrent", 71, 100, result=1).call("glCallList", 1).rectangle(RED, 2.0, 3.0)
    _, frames = replayed(program.call("wglDeleteContext", 100, result=1))
    assert [(f.width, f.height, color_of(f)) for f in frames] == [(4, 2, BYTES[RED])]


def test_what_a_damaged_trace_holds_is_counted():
    program = started()
    program.call("glXCreateContext").call("glXChooseVisual", 1).call("glXSwapBuffers").call(
        "eglMakeCurrent", None
    )
    program.call("glXCreatePbuffer", 1, 2, [0x8041, "wide"], result=7)
    program.call("glViewport", 0, 0, "a", None).call("glViewport", float("nan"), 1, 2, 3)
    replay, frames = replayed(program.clear(RED).swap())
    assert len(frames) == 1 and color_of(frames[0]) == BYTES[RED]
    assert len(sentences(replay, "refused")) >= 4


def test_which_calls_are_the_window_systems():
    assert all(
        map(
            is_window_call,
            ("glXSwapBuffers", "wglMakeCurrent", "SwapBuffers", "eglInitialize", "CGLFlushDrawable"),
        )
    )
    assert not any(map(is_window_call, ("glFlush", "glXyz"[:2] + "Vertex3f", "memcpy")))


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3])
def test_a_single_buffered_visual_draws_to_the_front(profile):
    program = started(double=False).clear(RED).rectangle(GREEN, 0.0).call("glFlush")
    _, (frame,) = replayed(program, profile)
    assert (color_of(frame, 0), color_of(frame, 7)) == (BYTES[RED], BYTES[GREEN])


def test_of_many_windows_the_first_are_forgotten(monkeypatch):
    from fixedpipe.effects.replays import replay, targets

    for module in (replay, targets):
        monkeypatch.setattr(module, "MOST_PIXELS", 100)
    program = Program().context()
    for window in range(1, 11):
        program.call("glXMakeCurrent", DISPLAY, window, 99, result=1).call("glViewport", 0, 0, 8, 4, flags=1)
        program.clear(RED).rectangle(GREEN, 0.0).swap(window)
    replay, frames = replayed(program)
    assert len(frames) == 10 and all(color_of(frame, 7) == BYTES[GREEN] for frame in frames)
    assert len(replay._targets) == 3
