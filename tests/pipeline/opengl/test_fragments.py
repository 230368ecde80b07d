"""Calls of rasterization and of per-fragment operations that later versions and extensions brought."""

import pytest

from fixedpipe.pipeline.commands import Accum
from fixedpipe.pipeline.enums import BlendEquation, ComparisonFunction, StencilOperation
from fixedpipe.pipeline.opengl import tokens as t
from tests.pipeline.opengl.drawn import context, counted, refusals


def test_the_bias_of_ext_polygon_offset_is_a_depth():
    gl = context()
    gl.Enable(t.POLYGON_OFFSET_EXT)
    gl.PolygonOffsetEXT(2.0, 0.5)
    polygon = gl.state().polygon
    assert (polygon.offset_factor, polygon.offset_units) == (2.0, 0.5 * (2**24 - 1))
    gl.PolygonOffset(2.0, 0.5)
    assert gl.state().polygon.offset_units == 0.5


def test_states_that_both_faces_share():
    gl = context()
    gl.Enable(t.STENCIL_TEST)
    gl.Enable(t.BLEND)
    gl.StencilFuncSeparate(t.FRONT_AND_BACK, t.EQUAL, 3, 0xFF)
    gl.StencilOpSeparate(t.FRONT_AND_BACK, t.KEEP, t.INCR, t.ZERO)
    gl.StencilMaskSeparate(t.FRONT_AND_BACK, 0x0F)
    gl.BlendEquationSeparate(t.FUNC_SUBTRACT, t.FUNC_SUBTRACT)
    test = gl.state().stencil_test
    assert (test.function, test.reference, test.write_mask) == (ComparisonFunction.EQUAL, 3, 0x0F)
    assert (test.depth_fail, test.depth_pass) == (StencilOperation.INCR, StencilOperation.ZERO)
    assert gl.state().blending.equation is BlendEquation.FUNC_SUBTRACT
    assert not refusals(gl)


@pytest.mark.parametrize(
    ("call", "arguments"),
    [
        ("StencilFuncSeparate", (t.FRONT, t.EQUAL, 3, 0xFF)),
        ("StencilOpSeparate", (t.BACK, t.KEEP, t.INCR, t.ZERO)),
        ("StencilMaskSeparate", (t.BACK, 0x0F)),
        ("BlendEquationSeparate", (t.FUNC_ADD, t.FUNC_SUBTRACT)),
        ("DrawBuffers", (2, [t.BACK_LEFT, t.FRONT_LEFT])),
    ],
)
def test_what_no_machine_has_is_refused_and_leaves_the_state(call, arguments):
    gl = context()
    before = gl.state()
    getattr(gl, call)(*arguments)
    assert [count for _, count in counted(gl, "refused")] == [1]
    assert gl.state() is before


def test_one_of_several_draw_buffers_is_the_draw_buffer():
    gl = context()
    gl.DrawBuffersARB(1, [t.FRONT_LEFT])
    assert gl.GetIntegerv(t.DRAW_BUFFER) == t.FRONT_LEFT
    gl.DrawBuffers(0, [])
    assert gl.GetIntegerv(t.DRAW_BUFFER) == t.NONE
    gl.DrawBuffers(-1, [])
    assert gl.GetError() == t.INVALID_VALUE


def test_selection_changes_no_accumulation_buffer():
    gl = context()
    gl.SelectBuffer(16)
    gl.RenderMode(t.SELECT)
    gl.Accum(t.LOAD, 1.0)
    gl.RenderMode(t.RENDER)
    assert gl.take_commands() == ()
    gl.Accum(t.LOAD, 1.0)
    assert [type(command) for command in gl.take_commands()] == [Accum]


def test_calls_for_the_driver_alone_have_no_effect():
    gl = context()
    for call, arguments in (
        ("GenFencesNV", (1, [1])),
        ("SetFenceNV", (1, 0x84F2)),
        ("FinishFenceNV", (1,)),
        ("AddSwapHintRectWIN", (0, 0, 8, 8)),
        ("SampleMaskSGIS", (0.5, False)),
        ("FlushRasterSGIX", ()),
    ):
        getattr(gl, call)(*arguments)
    assert gl.TestFenceNV(1) is True
    assert not refusals(gl)
    assert len(counted(gl, "no effect")) == 7


@pytest.mark.parametrize("token", [t.SAMPLE_ALPHA_TO_COVERAGE, t.SAMPLE_ALPHA_TO_ONE, t.SAMPLE_COVERAGE])
def test_states_of_samples_are_kept(token):
    gl = context()
    gl.PushAttrib(t.MULTISAMPLE_BIT)
    gl.Enable(token)
    assert gl.IsEnabled(token)
    gl.PopAttrib()
    assert not gl.IsEnabled(token) and not refusals(gl)
