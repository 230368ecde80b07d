"""Occlusion queries: how many samples pass on the machine, beside what the trace recorded."""

import numpy as np
import pytest

from fixedpipe.effects.replays.check import Check
from fixedpipe.effects.replays.targets import Judged
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_256, PROFILES
from tests.effects.replays.programs import GREEN, RED, replayed, started
from tests.effects.replays.test_blits import framebuffer

SAMPLES, TEST, TEST_RESULT = 0x8914, 0x8165, 0x8166


def asked(program, count, name=1):
    """A program that ends a query and asks for its result, which was ``count`` when it was recorded."""
    program.call("glEndQueryARB", SAMPLES)
    return program.call("glGetQueryObjectuivARB", name, T.QUERY_RESULT, [count])


def begun(program, name=1):
    return program.call("glBeginQueryARB", SAMPLES, name)


def checked(program, profile=GEFORCE_256, **settings):
    check = Check()
    replay, frames = replayed(program.swap(), profile, check=check, **settings)
    assert not [outcome for kind in ("refused", "error", "unknown") for outcome in replay.tally.of(kind)]
    return check, frames


@pytest.mark.parametrize("samples", [16, 15])
def test_a_count_is_compared_with_the_recorded_one(samples):
    check, _ = checked(asked(begun(started().clear(RED)).rectangle(GREEN, 0.0), samples))
    assert (check.counts, check.equal_counts, check.differing) == (1, int(samples == 16), 0)
    said = str(check)
    assert said.startswith(f"0 of 0 recorded answers agree; {check.equal_counts} of 1 counts of samples")
    assert said.endswith("recorded ones" if samples == 16 else "and the others differ by 6.25 % at most")


def counted(program, profile=GEFORCE_256):
    """The number of samples of a program's query."""
    program.call("glEndQueryARB", SAMPLES)
    replay, _ = replayed(program.swap(), profile, check=Check())
    return replay.windows.current(0).gl.samples_passed[1]


def _passes(test, *settings):
    return begun(started().clear(RED).call("glEnable", test).call(*settings))


@pytest.mark.parametrize(
    ("program", "samples"),
    [
        (begun(started().clear(RED)), 0),
        (begun(started().clear(RED)).rectangle(GREEN).rectangle(GREEN, 0.5), 40),
        (_passes(T.ALPHA_TEST, "glAlphaFunc", T.LESS, 0.5).rectangle((0.0, 0.0, 0.0, 0.25)), 32),
        (_passes(T.ALPHA_TEST, "glAlphaFunc", T.LESS, 0.5).rectangle(GREEN), 0),
        (_passes(T.DEPTH_TEST, "glDepthFunc", T.LESS).rectangle(RED, 0.0).rectangle(GREEN), 32),
        (_passes(T.SCISSOR_TEST, "glScissor", 1, 1, 3, 2).rectangle(GREEN), 6),
        (_passes(T.STENCIL_TEST, "glStencilFunc", T.NEVER, 0, 255).rectangle(GREEN), 0),
        (begun(started()).rectangle(GREEN).clear(RED).call("glDrawBuffer", T.FRONT_AND_BACK), 32),
        (begun(started().call("glDrawBuffer", T.FRONT_AND_BACK)).rectangle(GREEN), 32),
        (begun(started().call("glColorMask", 0, 0, 0, 0)).rectangle(GREEN), 32),
    ],
)
def test_what_passes_all_tests_is_counted(program, samples):
    assert counted(program) == samples


def test_rectangles_of_colours_are_counted_and_those_of_stencil_values_are_not():
    def drawn(kind, given):
        program = begun(started().clear(RED))
        return program.call("glDrawPixels", 3, 2, kind, T.UNSIGNED_BYTE, given.tobytes())

    program = drawn(T.RGBA, np.zeros((2, 3, 4), np.uint8))
    assert counted(program) == 6
    given = np.zeros((2, 4), np.uint8)  # rows of four bytes
    assert counted(drawn(T.STENCIL_INDEX, given)) == 0


@pytest.mark.parametrize("machine", ["GEFORCE_3", "OPENGL_1_2"])
def test_an_objects_samples_are_counted_and_those_of_before_are_not(machine):
    program = framebuffer(started().clear(RED).rectangle(GREEN)).rectangle(GREEN)
    begun(program).rectangle(RED, 0.5).call("glBindFramebufferEXT", T.FRAMEBUFFER_EXT, 0)
    assert counted(program.rectangle(RED, 0.0), PROFILES[machine]) == 24


def test_counting_changes_no_bit():
    def program():
        lines = begun(started().clear(RED)).call("glEnable", T.LINE_SMOOTH).call("glEnable", T.BLEND)
        lines.call("glBlendFunc", T.SRC_ALPHA, T.ONE).rectangle((0.3, 0.2, 0.1, 0.7), -0.3)
        return (
            lines.call("glBegin", T.LINES).call("glVertex2f", -1, -1).call("glVertex2f", 1, 0.7).call("glEnd")
        )

    _, (counting,) = checked(asked(program(), 0))
    _, (plain,) = replayed(asked(program(), 0).swap())
    assert (counting.image == plain.image).all()


def test_frames_that_are_not_asked_for_are_counted_all_the_same():
    program = asked(begun(started().clear(RED)).rectangle(GREEN), 32).swap().clear(RED)
    check, _ = checked(program, wanted=lambda number, draws: number == 1, needed=lambda number: number == 1)
    assert check.equal_counts == check.counts == 1


def test_nvidias_queries():
    program = started().clear(RED).call("glBeginOcclusionQueryNV", 3).rectangle(GREEN, 0.0)
    program.call("glEndOcclusionQueryNV").call("glGetOcclusionQueryivNV", 3, 0x8867, [0])
    check, _ = checked(program.call("glGetOcclusionQueryuivNV", 3, 0x8866, [16]))
    assert (check.counts, check.equal_counts, check.compared) == (1, 1, 0)


def test_hps_test_says_whether_any_sample_passed():
    program = started().clear(RED).call("glEnable", TEST).rectangle(GREEN)
    program.call("glGetIntegerv", TEST_RESULT, [1]).call("glGetIntegerv", TEST_RESULT, [0])
    program.rectangle(GREEN).call("glDisable", TEST).rectangle(GREEN)
    check, _ = checked(program)
    assert (check.compared, check.differing) == (2, 0)


def test_what_is_only_judged_counts_nothing():
    program = asked(begun(started().clear(RED)).rectangle(GREEN), 7)
    check, _ = checked(program, target=Judged)
    assert check.counts == 0
