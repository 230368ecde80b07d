"""Where a frame ends and what it shows; what is drawn, waits, or is left out."""

import numpy as np
import pytest

from fixedpipe.effects.replays.asked import FramesAsked
from fixedpipe.effects.replays.recording import frame_commands
from fixedpipe.effects.replays.replay import THE_END
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256
from tests.effects.replays.programs import (
    BLACK,
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


def test_a_swap_ends_a_frame_and_shows_the_back_buffer():
    program = started().clear(RED).swap().clear(GREEN).rectangle(BLUE, 0.0).swap().swap()
    replay, frames = replayed(program)
    assert [frame.number for frame in frames] == [0, 1, 2]
    assert [frame.draws for frame in frames] == [0, 1, 0]
    assert [color_of(frame) for frame in frames] == [BYTES[RED], BYTES[GREEN], BYTES[GREEN]]
    assert frames[1].first_call == frames[0].last_call + 1
    assert program.calls[frames[1].last_call].name == frames[1].ended == "glXSwapBuffers"
    assert (replay.frames, replay.draws, replay.calls) == (3, 1, len(program.calls))


def test_flush_ends_a_frame_of_a_single_buffered_window_after_a_draw_alone():
    program = (
        started(double=False).clear(RED).call("glFlush").rectangle(GREEN).call("glFinish").call("glFlush")
    )
    _, frames = replayed(program)
    assert [(frame.ended, frame.draws) for frame in frames] == [("glFinish", 1)]
    assert color_of(frames[0]) == BYTES[GREEN]


def test_flush_ends_no_frame_of_a_double_buffered_window():
    program = started().rectangle(GREEN).call("glFlush").call("glDrawBuffer", T.FRONT).rectangle(RED)
    _, frames = replayed(program.call("glFlush").call("glDrawBuffer", T.BACK).swap())
    assert [frame.ended for frame in frames] == ["glXSwapBuffers"]
    assert color_of(frames[0]) == BYTES[GREEN]


def test_a_window_of_which_nothing_is_known_ends_frames_where_its_front_is_drawn_into():
    program = Program().call("glXChooseFBConfig", DISPLAY, 0, [8, 1, 0], result=[4])
    program.call("glXCreateNewContext", DISPLAY, 4, 0x8014, None, 1, result=99).current()
    program.rectangle(RED).call("glFlush").call("glDrawBuffer", T.FRONT).rectangle(GREEN).call("glFlush")
    _, frames = replayed(program)
    assert [(frame.ended, color_of(frame)) for frame in frames] == [("glFlush", BYTES[GREEN])]


def test_a_frame_terminator_ends_a_frame_with_what_was_drawn_last():
    program = started().clear(RED).call("glFrameTerminatorGREMEDY").clear(GREEN).swap()
    _, frames = replayed(program)
    assert [(f.ended, color_of(f)) for f in frames] == [
        ("glFrameTerminatorGREMEDY", BYTES[RED]),
        ("glXSwapBuffers", BYTES[GREEN]),
    ]


def test_the_ends_of_context_and_trace_end_a_frame_where_something_was_drawn():
    gone = ("glXDestroyContext", DISPLAY, 99)
    _, frames = replayed(started().rectangle(RED).call(*gone))
    assert [(frame.ended, color_of(frame)) for frame in frames] == [(gone[0], BYTES[RED])]
    _, frames = replayed(started().rectangle(RED).swap().call(*gone))
    assert len(frames) == 1
    _, frames = replayed(started().swap().rectangle(BLUE))
    assert [(frame.ended, color_of(frame)) for frame in frames[1:]] == [(THE_END, BYTES[BLUE])]
    assert replayed(started().clear(RED))[1] == []
    assert replayed(Program())[1] == []


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3])
def test_front_and_back_are_two_buffers_with_the_same_depths(profile):
    program = started().clear(RED).swap().clear(GREEN)
    program.call("glDrawBuffer", T.FRONT).rectangle(BLUE, 0.0).call("glFrameTerminatorGREMEDY")
    program.call("glDrawBuffer", T.BACK).swap()
    _, frames = replayed(program, profile)
    assert [(color_of(f, 0), color_of(f, 7)) for f in frames] == [
        (BYTES[RED], BYTES[RED]),
        (BYTES[RED], BYTES[BLUE]),
        (BYTES[GREEN], BYTES[GREEN]),
    ]
    program = (
        started().clear(RED).call("glEnable", T.DEPTH_TEST).call("glDrawBuffer", T.FRONT).rectangle(BLUE)
    )
    program.call("glDrawBuffer", T.BACK).rectangle(GREEN)  # as deep, so that LESS fails
    assert color_of(replayed(program.swap(), profile)[1][0]) == BYTES[RED]


def test_both_buffers_are_drawn_into_with_the_depths_of_before():
    program = started().call("glDrawBuffer", T.FRONT_AND_BACK).clear(RED).call("glEnable", T.DEPTH_TEST)
    program.call("glFrameTerminatorGREMEDY").rectangle(GREEN).call("glFrameTerminatorGREMEDY").call(
        "glDrawBuffer", T.FRONT
    )
    program.rectangle(BLUE).call("glFrameTerminatorGREMEDY").swap()
    _, frames = replayed(program)
    assert [color_of(frame) for frame in frames] == [BYTES[RED]] + [BYTES[GREEN]] * 3


@pytest.mark.parametrize("restored", [False, True], ids=["DrawBuffer", "PopAttrib"])
def test_a_list_may_change_the_buffer_between_its_draws(restored):
    program = started().call("glNewList", 1, T.COMPILE).rectangle(RED)
    program.call("glPushAttrib", T.COLOR_BUFFER_BIT).call("glDrawBuffer", T.FRONT).rectangle(GREEN)
    program.call("glPopAttrib") if restored else program.call("glDrawBuffer", T.BACK)
    program.rectangle(BLUE).call("glEndList").call("glCallList", 1)
    program.call("glDrawBuffer", T.FRONT).call("glEnable", T.SCISSOR_TEST).call("glScissor", 0, 0, 1, 1)
    program.rectangle(RED).call("glFrameTerminatorGREMEDY").swap()
    _, (front, back) = replayed(program)
    assert (color_of(front, 7), color_of(back, 7)) == (BYTES[GREEN], BYTES[BLUE])


def test_pixels_are_copied_from_the_buffer_that_is_read():
    program = started().clear(RED).swap().clear(GREEN).call("glReadBuffer", T.FRONT)
    program.call("glWindowPos2i", 0, 0).call("glCopyPixels", 0, 0, 2, 4, T.COLOR).swap()
    _, (_, frame) = replayed(program)
    assert (color_of(frame, 0), color_of(frame, 2)) == (BYTES[RED], BYTES[GREEN])
    program = started().clear(RED).swap().clear(GREEN).call("glReadBuffer", T.FRONT)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    program.call("glCopyTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 0, 0, 4, 4, 0).call("glEnable", T.TEXTURE_2D)
    _, (_, frame) = replayed(program.rectangle((1.0, 1.0, 1.0, 1.0)).swap())
    assert color_of(frame) == BYTES[RED]


def test_what_the_machine_refuses_is_counted_with_its_call_and_the_frame_goes_on(monkeypatch):
    runs = []
    run = Machine.run
    monkeypatch.setattr(Machine, "run", lambda self, c, **k: (runs.append(tuple(c)), run(self, c, **k))[1])
    planes = range(T.CLIP_PLANE0, T.CLIP_PLANE0 + GEFORCE_256.vertices.max_clip_planes + 1)
    program = started().clear(RED).rectangle(GREEN, -1.0, -0.5)
    for plane in planes:
        program.call("glEnable", plane)
    program.rectangle(BLUE).rectangle(BLUE)
    refused = len(program.calls) - 8
    for plane in planes:
        program.call("glDisable", plane)
    program.rectangle(BLUE, 0.5, 1.0).swap().clear(GREEN).rectangle(RED).swap()
    replay, (frame, after) = replayed(program)
    assert (color_of(frame, 0), color_of(frame, 3), color_of(frame, 7)) == (
        BYTES[GREEN],
        BYTES[RED],
        BYTES[BLUE],
    )
    assert (frame.draws, frame.refused, after.refused) == (4, 2, 0)
    (outcome,) = replay.tally.of("refused")
    assert (outcome.first_call, outcome.count) == (refused, 2)
    assert outcome.what.startswith("glEnd: GeForce 256 has 6 clip planes; this pass enables 7.")
    assert sentences(replay, "drawn") == {"glEnd": 3}
    # The whole frame is refused first; one in which nothing is refused is validated once.
    assert [len(commands) for commands in runs] == [5, 3, 2]


def test_the_programs_markers_stand_in_labels():
    program = started().call("glPushDebugGroup", 0, 1, -1, "the walls").rectangle(RED)
    program.call("glInsertEventMarkerEXT", 0, "a lamp").rectangle(GREEN).call("glPopDebugGroup").rectangle(
        BLUE
    )
    _, (frame,) = replayed(program.swap(), recorded=lambda number: True)
    labels = [command.label for _, command in frame.recording.commands]
    ends = [n for n, call in enumerate(program.calls) if call.name == "glEnd"]
    assert labels == [
        f"the walls: glEnd (call {ends[0]})",
        f"the walls: a lamp: glEnd (call {ends[1]})",
        f"glEnd (call {ends[2]})",
    ]


def test_a_program_without_frames_keeps_few_commands():
    program = started()
    for _ in range(5000):
        program.clear(RED, T.COLOR_BUFFER_BIT)
    replay, frames = replayed(program)
    assert frames == [] and replay.calls == len(program.calls)
    assert not replay.windows.current(0).gl.commands


def _frames_of_a_game(count):
    """Frames that clear, store a texture, and draw with it; the seventh reads what the sixth drew."""
    program = started()
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    for number in range(count):
        if number == 7:
            program.call("glCopyTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 0, 0, 4, 4, 0)
        elif number % 3 == 0:
            texel = bytes([20 * number, 255 - 20 * number, 7, 255])
            program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 1, 1, 0, T.RGBA, T.UNSIGNED_BYTE, texel)
        if number != 5:
            program.clear((0.1 * number, 0.0, 0.2, 1.0))
        program.call("glEnable", T.TEXTURE_2D).rectangle((1.0, 1.0, 1.0, 1.0), -1.0 + 0.2 * number, 0.9)
        program.swap()
    return program


@pytest.mark.parametrize("number", range(10))
def test_a_frame_is_the_same_whether_those_before_it_were_asked_for_or_not(number):
    program = _frames_of_a_game(10)
    _, frames = replayed(program)
    asked = FramesAsked.of(str(number))
    replay, alone = replayed(program, wanted=asked.wants, needed=asked.may_want)
    assert [frame.number for frame in alone if frame.image is not None] == [number]
    np.testing.assert_array_equal(alone[number].image, frames[number].image)
    assert replay.draws == 10


def test_frames_that_nobody_asks_for_are_not_drawn(monkeypatch):
    drawn = []
    run = Machine.run
    monkeypatch.setattr(Machine, "run", lambda self, c, **k: (drawn.extend(c), run(self, c, **k))[1])
    asked = FramesAsked.of("30")
    program = started()
    for _ in range(31):
        program.clear(RED).rectangle(GREEN, 0.0).swap()
    _, frames = replayed(program, wanted=asked.wants, needed=asked.may_want)
    assert color_of(frames[30], 7) == BYTES[GREEN] and frames[0].image is None
    assert len(drawn) == 4  # the frame itself, and the one that the front buffer shows


def test_depths_that_a_clear_of_colours_leaves_are_kept():
    asked = FramesAsked.of("2")
    program = started().clear(RED).call("glEnable", T.DEPTH_TEST).rectangle(GREEN, 0.0).swap()
    program.clear(RED, T.COLOR_BUFFER_BIT).swap()
    program.clear(RED, T.COLOR_BUFFER_BIT).rectangle(BLUE).swap()  # as deep, so that LESS fails
    _, frames = replayed(program, wanted=asked.wants, needed=asked.may_want)
    assert (color_of(frames[2], 0), color_of(frames[2], 7)) == (BYTES[BLUE], BYTES[RED])


def test_the_front_buffer_shows_the_frame_before_though_it_was_not_asked_for():
    asked = FramesAsked.of("3")
    program = started()
    for color in (RED, GREEN, BLUE):
        program.clear(color).swap()
    program.clear(RED).call("glReadBuffer", T.FRONT).call("glWindowPos2i", 0, 0)
    program.call("glCopyPixels", 0, 0, 2, 4, T.COLOR).swap()
    _, frames = replayed(program, wanted=asked.wants, needed=asked.may_want)
    assert (color_of(frames[3], 0), color_of(frames[3], 2)) == (BYTES[BLUE], BYTES[RED])


def test_which_frames_are_asked_for():
    asked = FramesAsked.of("3,10-12")
    assert [n for n in range(20) if asked.wants(n, 0)] == [3, 10, 11, 12]
    assert (asked.count, asked.last) == (4, 12)
    assert not asked.is_over(11, 5) and asked.is_over(12, 0)
    assert asked.missing([3, 10]) == [11, 12]
    everything = FramesAsked.of("all")
    assert everything.wants(10**9, 0) and not everything.is_over(10**9, 1)
    assert (everything.count, everything.last, everything.missing([])) == (None, None, [])
    first = FramesAsked.of(None)
    assert (first.wants(0, 0), first.wants(7, 1), first.is_over(7, 1)) == (False, True, True)


@pytest.mark.parametrize("text", ["", "x", "3-", "5-2", "-1", "1,,2", "0-999999999", "1.5"])
def test_what_is_no_list_of_frames_is_refused(text):
    with pytest.raises(ValueError, match="--frames"):
        FramesAsked.of(text)


def test_an_empty_framebuffer_is_black():
    _, (frame,) = replayed(started().swap())
    assert color_of(frame) == BLACK
    assert sentences(replayed(started())[0], "refused") == {}


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3], ids=lambda p: p.name)
def test_framebuffer_objects_are_drawn_with_pbuffers_and_without(profile):
    """The GeForce 256 has no pbuffers: a window of its own, and CopyTexImage."""
    program = started().clear(BLUE)
    program.call("glBindTexture", T.TEXTURE_2D, 1)
    program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 4, 4, 0, T.RGBA, T.UNSIGNED_BYTE, None)
    program.call("glBindFramebufferEXT", T.FRAMEBUFFER_EXT, 5)
    attach = T.FRAMEBUFFER_EXT, T.COLOR_ATTACHMENT0_EXT, T.TEXTURE_2D, 1, 0
    program.call("glFramebufferTexture2DEXT", *attach).call("glViewport", 0, 0, 4, 4)
    program.clear(RED).rectangle(GREEN, 0.0).call("glBindFramebufferEXT", T.FRAMEBUFFER_EXT, 0)
    program.call("glViewport", 0, 0, 8, 4).call("glEnable", T.TEXTURE_2D)
    program.call("glColor4f", 1.0, 1.0, 1.0, 1.0).call("glBegin", T.QUADS)
    for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
        program.call("glTexCoord2f", s, t).call("glVertex2f", s, 2 * t - 1)
    program.call("glEnd").swap()
    replay, (frame,) = replayed(program, profile, recorded=lambda n: True)
    assert (color_of(frame, 0), color_of(frame, 4), color_of(frame, 7)) == (
        BYTES[BLUE],
        BYTES[RED],
        BYTES[GREEN],
    )
    assert (frame.draws, frame.width) == (2, 8)
    assert not sentences(replay, "refused")
    alone = execute(frame_commands(frame.recording, frame.shown), profile, frame.width, frame.height)
    np.testing.assert_array_equal(alone.image(), frame.image)


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3], ids=lambda p: p.name)
def test_what_is_drawn_into_a_framebuffer_object_alone_is_shown_in_the_end(profile):
    program = started().call("glBindTexture", T.TEXTURE_2D, 1)
    program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 6, 3, 0, T.RGBA, T.UNSIGNED_BYTE, None)
    program.call("glBindFramebuffer", T.FRAMEBUFFER_EXT, 5)
    attach = T.FRAMEBUFFER_EXT, T.COLOR_ATTACHMENT0_EXT, T.TEXTURE_2D, 1, 0
    program.call("glFramebufferTexture2D", *attach).clear(RED).rectangle(GREEN, 0.0)
    program.call("glXDestroyContext", DISPLAY, 99)
    _, (frame,) = replayed(program, profile, recorded=lambda n: True)
    assert (frame.width, frame.height, frame.draws) == (6, 3, 1)
    assert color_of(frame, 0) == BYTES[RED]
    alone = execute(frame_commands(frame.recording, frame.shown), profile, frame.width, frame.height)
    np.testing.assert_array_equal(alone.image(), frame.image)


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3], ids=lambda p: p.name)
def test_framebuffer_objects_that_are_too_large_or_too_many(profile, monkeypatch):
    from fixedpipe.effects.replays import targets

    monkeypatch.setattr(targets, "MOST_PIXELS", 100)
    program = started().clear(RED)
    for number in range(1, 9):
        edge = 1 << 20 if number == 4 else 4
        program.call("glBindTexture", T.TEXTURE_2D, number)
        program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, edge, edge, 0, T.RGBA, T.UNSIGNED_BYTE, None)
        program.call("glBindFramebuffer", T.FRAMEBUFFER_EXT, number)
        attach = T.FRAMEBUFFER_EXT, T.COLOR_ATTACHMENT0_EXT, T.TEXTURE_2D, number, 0
        program.call("glFramebufferTexture2D", *attach).rectangle(GREEN)
    program.call("glBindFramebuffer", T.FRAMEBUFFER_EXT, 0).rectangle(BLUE, 0.0).swap()
    _, (frame,) = replayed(program, profile)
    assert (color_of(frame, 0), color_of(frame, 7)) == (BYTES[RED], BYTES[BLUE])
