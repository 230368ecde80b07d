"""Calls that read pixels in mid-frame, with anything for arguments: counted, and the frame goes on."""

from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.replays.check import Check
from fixedpipe.pipeline.opengl import framebuffer_blits, imaging_copies, occlusion_queries
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.opengl.entry_points import ENTRY_POINTS
from fixedpipe.pipeline.profiles import PROFILES
from tests.effects.replays.programs import BYTES, GREEN, RED, replayed, started

_MODULES = {module.__name__ for module in (framebuffer_blits, imaging_copies, occlusion_queries)}
_NAMES = sorted(name for name, point in ENTRY_POINTS.items() if point.handler.__module__ in _MODULES)
_NAMES += ["glBindFramebuffer", "glEnable", "glGetIntegerv"]
_USUAL = (
    *(T.COLOR_TABLE, T.CONVOLUTION_1D, T.CONVOLUTION_2D, T.RGBA, T.LUMINANCE, T.COLOR_BUFFER_BIT),
    *(T.DEPTH_BUFFER_BIT, T.NEAREST, T.LINEAR, T.FRAMEBUFFER_EXT, 0x8CA8, 0x8CA9, 0x8165, 0x8166, 0x8914),
)
_ARGUMENTS = st.one_of(
    st.integers(-3, 9),
    st.sampled_from(_USUAL),
    st.sampled_from([-(2**31), 2**31 - 1, 2**63, 1 << 20]),
    st.floats(),
    st.none(),
    st.binary(max_size=8),
    st.lists(st.integers(-3, 300), max_size=4),
)


@settings(max_examples=150)
@given(calls=st.lists(st.tuples(st.sampled_from(_NAMES), st.lists(_ARGUMENTS, max_size=10)), max_size=10))
def test_no_call_stops_the_frame(calls):
    program = started().clear(RED)
    for name, arguments in calls:
        program.call(name, *arguments)
    program.call("glDisable", T.SCISSOR_TEST).call("glBindFramebuffer", T.FRAMEBUFFER_EXT, 0)
    replay, frames = replayed(program.clear(GREEN).swap(), PROFILES["OPENGL_1_2_IMAGING"], check=Check())
    assert (frames[-1].image == BYTES[GREEN]).all() and replay.calls == len(program.calls)
