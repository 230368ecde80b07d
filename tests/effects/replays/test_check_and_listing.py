"""The trace's own answers, and what a trace asks for."""

import numpy as np

from fixedpipe.effects.replays.check import Check
from fixedpipe.effects.replays.listing import JUDGED_FRAMES, Listing, extension_of
from fixedpipe.effects.replays.replay import Replay
from fixedpipe.effects.replays.summary import is_refused, summary_data, summary_lines
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.opengl.outcomes import Tally
from fixedpipe.pipeline.profiles import GEFORCE_256, PROFILES
from tests.effects.replays.programs import BLUE, GREEN, RED, replayed, started

MACHINES = {key: profile for key, profile in PROFILES.items() if not profile.arithmetic.exact}


def checked(program):
    check = Check()
    replayed(program, check=check)
    return check


def test_answers_that_agree():
    program = started().call("glEnable", T.BLEND)
    program.call("glIsEnabled", T.BLEND, result=1)
    program.call("glGetIntegerv", T.VIEWPORT, [0, 0, 8, 4])
    program.call("glGetFloatv", T.COLOR_CLEAR_VALUE, [0.0, 0.0, 0.0, 0.0])
    check = checked(program)
    assert (check.compared, check.differing) == (3, 0)
    assert str(check) == "3 of 3 recorded answers agree"


def test_answers_that_differ_are_told_with_their_call():
    program = started().call("glIsEnabled", T.BLEND, result=1)
    program.call("glGetIntegerv", T.VIEWPORT, [0, 0, 9, 4])
    check = checked(program)
    assert (check.compared, check.differing) == (2, 2)
    first, second = map(str, check.differences)
    assert first == f"call {len(program.calls) - 2}: glIsEnabled(GL_BLEND) is False, recorded 1"
    assert "glGetIntegerv(GL_VIEWPORT) is [0, 0, 8, 4], recorded [0, 0, 9, 4]" in second


def test_what_depends_on_the_driver_is_not_compared():
    program = started().call("glGetString", T.RENDERER, result="llvmpipe")
    program.call("glGetIntegerv", T.MAX_TEXTURE_SIZE, [16384])
    program.call("glReadPixels", 0, 0, 1, 1, T.RGBA, T.UNSIGNED_BYTE, 1234)
    assert checked(program).compared == 0


def test_of_maps_apitrace_records_one_value():
    program = started().call("glMap2f", T.MAP2_VERTEX_3, 0.0, 1.0, 3, 2, 0.0, 1.0, 6, 2, [0.0] * 12)
    program.call("glGetMapiv", T.MAP2_VERTEX_3, T.ORDER, [2])
    program.call("glGetMapfv", T.MAP2_VERTEX_3, T.DOMAIN, [0.0])
    program.call("glPixelMapfv", T.PIXEL_MAP_G_TO_G, 2, [0.0, 1.0])
    program.call("glGetPixelMapfv", T.PIXEL_MAP_G_TO_G, [0.0])
    assert str(checked(program)) == "3 of 3 recorded answers agree"
    assert checked(program.call("glGetMapiv", T.MAP2_VERTEX_3, T.ORDER, [3])).differing == 1


def test_bits_beyond_the_stencil_buffer_are_not_compared():
    program = started().call("glGetIntegerv", T.STENCIL_VALUE_MASK, [255])
    program.call("glGetIntegerv", T.STENCIL_WRITEMASK, [-1]).call("glStencilMask", 0x1F)
    assert checked(program.call("glGetIntegerv", T.STENCIL_WRITEMASK, [0x1F])).differing == 0
    assert checked(program.call("glGetIntegerv", T.STENCIL_WRITEMASK, [0x0F])).differing == 1


def test_behind_the_last_frame_primitives_only_set_the_state():
    """No mesh is made any more, whatever draws: vertices, lists, arrays. All answers are compared."""
    program = started().call("glNewList", 1, T.COMPILE).rectangle(BLUE).call("glEndList").swap()
    first = len(program.calls)
    program.rectangle(RED).call("glGetFloatv", T.CURRENT_COLOR, list(RED))
    program.call("glCallList", 1).call("glGetFloatv", T.CURRENT_COLOR, list(BLUE))
    program.call("glVertexPointer", 2, T.FLOAT, 0, np.array([-1, -1, 1, -1, 0, 1], "<f4").tobytes())
    program.call("glEnableClientState", T.VERTEX_ARRAY).call("glDrawArrays", T.TRIANGLES, 0, 3)
    program.context(98).current(98).rectangle(RED).call("glGetFloatv", T.CURRENT_COLOR, list(RED))
    program.call("glSelectBuffer", 64, [0] * 64).call("glRenderMode", T.SELECT, result=0)
    program.call("glInitNames").call("glPushName", 1).rectangle(GREEN)
    program.call("glRenderMode", T.RENDER, result=1)
    check = Check()
    replay = Replay(GEFORCE_256, check=check)
    for call in program.calls[:first]:
        replay.take(call)
    replay.stop_drawing()
    made = []
    for call in program.calls[first:]:
        replay.take(call)
        gl = replay.windows.current_or_own(0).gl
        made += gl.commands
    assert not made and str(check) == "5 of 5 recorded answers agree"


def test_lists_and_render_modes_are_compared():
    program = started().call("glGenLists", 3, result=5).call("glGenLists", 1, result=8)
    program.call("glSelectBuffer", 64, [0] * 64).call("glRenderMode", T.SELECT, result=0)
    program.call("glInitNames").call("glPushName", 1).rectangle(RED)
    program.call("glRenderMode", T.RENDER, result=1)
    assert str(checked(program)) == "4 of 4 recorded answers agree"
    wrong = started().call("glRenderMode", T.RENDER, result=3)
    assert checked(wrong).differing == 1


def listed(program, machines=MACHINES):
    listing = Listing(machines)
    for call in program.calls:
        listing.take(call)
    listing.finish()
    return listing


def test_a_listing_counts_functions_frames_and_draws():
    listing = listed(started().clear(RED).rectangle(GREEN).swap().swap())
    assert (listing.replay.frames, listing.replay.draws, listing.judged) == (2, 1, 1)
    assert listing.functions["glVertex2f"] == 4
    assert listing.sizes == {(8, 4): 2}
    assert all(verdict.count == 0 for verdict in listing.verdicts.values())
    assert listing.recommended() == "GEFORCE_256"
    assert set(listing.data()["machines"]) == set(MACHINES)


def test_a_listing_says_which_machines_refuse_what():
    program = started().clear(RED)
    for unit in (0, 1, 2):
        program.call("glActiveTextureARB", T.TEXTURE0 + unit)
        program.call("glTexParameteri", T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
        texel = bytes([1, 2, 3, 4])
        program.call("glTexImage2D", T.TEXTURE_2D, 0, T.RGBA, 1, 1, 0, T.RGBA, T.UNSIGNED_BYTE, texel)
        program.call("glEnable", T.TEXTURE_2D)
    listing = listed(program.rectangle(GREEN).swap())
    refusing = {key for key, verdict in listing.verdicts.items() if verdict.count}
    assert {"OPENGL_1_2", "GEFORCE_256"} <= refusing and "GEFORCE_3" not in refusing
    assert listing.recommended() == "GEFORCE_3"
    (outcome,) = listing.verdicts["GEFORCE_256"].refusals
    assert outcome.first_call == len(program.calls) - 2
    assert listing.extensions == ["ARB_multitexture"]


def test_machines_are_judged_by_the_first_frames_and_the_rest_is_counted():
    program = started()
    for _ in range(JUDGED_FRAMES + 3):
        program.clear(RED).rectangle(GREEN).swap()
    program.call("glUseProgram", 1)
    listing = listed(program, {"GEFORCE_256": MACHINES["GEFORCE_256"]})
    assert (listing.judged, listing.replay.frames) == (JUDGED_FRAMES, JUDGED_FRAMES + 3)
    assert listing.verdicts["GEFORCE_256"].draws == JUDGED_FRAMES
    assert listing.verdicts["GEFORCE_256"].count == 0


def test_an_empty_trace_is_listed():
    listing = listed(started())
    assert (listing.replay.frames, listing.judged) == (0, 0)


def test_extensions_of_functions():
    assert extension_of("glLockArraysEXT") == "EXT_compiled_vertex_array"
    assert extension_of("glCombinerStageParameterfvNV") == "NV_register_combiners2"
    assert extension_of("glCombinerInputNV") == "NV_register_combiners"
    assert extension_of("glVertex3f") is None


def test_a_summary_in_words_and_as_data():
    tally = Tally()
    for call, kind, what in (
        (4, "drawn", "glEnd"),
        (5, "drawn", "glEnd"),
        (6, "error", "glEnable: GL_INVALID_ENUM"),
        (7, "refused", "glEnd: no such thing"),
        (9, "refused", "glEnd: no such thing"),
        (10, "unknown", "glUseProgram"),
    ):
        tally.call = call
        tally.add(kind, what)
    assert list(summary_lines(tally)) == [
        "drawn: 2 (glEnd 2)",
        "ignored, as OpenGL ignores them: 1",
        "  call 6: glEnable: GL_INVALID_ENUM",
        "refused: 2",
        "  call 7, 2 times in all: glEnd: no such thing",
        "of functions that are unknown here: 1 (glUseProgram 1)",
    ]
    assert summary_data(tally)["refused"] == [{"what": "glEnd: no such thing", "first_call": 7, "count": 2}]
    assert is_refused(tally) and not is_refused(Tally())


def test_what_a_machine_draws_without_is_told_and_counts_against_it():
    program = started().clear(RED).call("glEnable", T.LINE_SMOOTH).call("glBegin", T.LINES)
    program.call("glVertex2f", -1.0, 0.0).call("glVertex2f", 1.0, 0.5).call("glEnd").swap()
    listing = listed(program)
    assert [outcome.what for outcome in listing.verdicts["GEFORCE_256"].without] == [
        "LINE_SMOOTH: GeForce 256 has no smooth lines"
    ]
    assert not listing.verdicts["GEFORCE_3"].without and listing.recommended() == "GEFORCE_3"
    replay, _ = replayed(program)
    (line,) = [line for line in summary_lines(replay.tally) if "LINE_SMOOTH" in line]
    assert line.startswith(f"  call {len(program.calls) - 2}: LINE_SMOOTH")
