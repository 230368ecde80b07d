"""Occlusion queries: their state and errors; what they count is the recorded driver's."""

import pytest

from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.opengl.queries import answer
from tests.pipeline.opengl.drawn import context, counted

SAMPLES = 0x8914


def test_a_query_is_begun_and_ended():
    gl = context()
    gl.GenQueriesARB(2, [7, 8])
    assert not gl.IsQueryARB(7)
    gl.BeginQueryARB(SAMPLES, 7)
    assert gl.IsQuery(7) and gl.GetQueryivARB(SAMPLES, T.CURRENT_QUERY) == 7
    assert answer(gl, "glGetQueryiv", [SAMPLES, T.CURRENT_QUERY, None]) == (7,)
    assert answer(gl, "glGetQueryiv", [SAMPLES, T.QUERY_COUNTER_BITS, None]) is None
    gl.EndQueryARB(SAMPLES)
    assert gl.GetQueryivARB(SAMPLES, T.CURRENT_QUERY) == 0
    gl.DeleteQueriesARB(1, [7])
    assert not gl.IsQueryARB(7) and not counted(gl, "error")


def test_nvidias_and_hps():
    gl = context()
    gl.BeginOcclusionQueryNV(3)
    gl.EndOcclusionQueryNV()
    gl.Enable(0x8165)
    assert gl.IsOcclusionQueryNV(3) and gl.IsEnabled(0x8165)
    assert not counted(gl, "error") and not counted(gl, "unknown")


@pytest.mark.parametrize(
    ("calls", "error"),
    [
        ([("EndQuery", SAMPLES)], "GL_INVALID_OPERATION"),
        ([("BeginQuery", SAMPLES, 0)], "GL_INVALID_OPERATION"),
        ([("BeginQuery", SAMPLES, 1), ("BeginOcclusionQueryNV", 2)], "GL_INVALID_OPERATION"),
        ([("BeginQuery", T.TEXTURE_2D, 1)], "GL_INVALID_ENUM"),
        ([("GenQueries", -1, [])], "GL_INVALID_VALUE"),
    ],
)
def test_errors(calls, error):
    gl = context()
    for name, *arguments in calls:
        getattr(gl, name)(*arguments)
    ((sentence, count),) = counted(gl, "error")
    assert error in sentence and count == 1
