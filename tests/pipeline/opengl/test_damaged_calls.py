"""Calls with anything for arguments, as a damaged trace has them: counted, and what follows goes on."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.opengl import (
    array_draws,
    arrays,
    buffers,
    evaluators,
    lists,
    selection,
    vertex_array_objects,
)
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.entry_points import ENTRY_POINTS
from tests.pipeline.opengl.drawn import context, meshes

_MODULES = {
    module.__name__
    for module in (array_draws, arrays, buffers, evaluators, lists, selection, vertex_array_objects)
}
_NAMES = sorted(name for name, point in ENTRY_POINTS.items() if point.handler.__module__ in _MODULES)
_NAMES += ["glBegin", "glEnd", "glVertex3f", "glEnable", "glPushClientAttrib", "glPopClientAttrib"]

_TOKENS = st.sampled_from(
    [value for name, value in vars(GL).items() if isinstance(value, int) and not name.startswith("__")]
)
_ARGUMENTS = st.one_of(
    st.integers(-2, 5),
    _TOKENS,
    st.sampled_from(
        [GL.FLOAT, GL.UNSIGNED_INT, GL.ARRAY_BUFFER, GL.STATIC_DRAW, GL.MAP1_VERTEX_3, GL.MAP2_VERTEX_4]
    ),
    st.sampled_from([-(2**31), 2**31 - 1, 2**32, 2**63, 1 << 20]),
    st.floats(),
    st.none(),
    st.booleans(),
    st.binary(max_size=80),
    st.lists(st.one_of(st.integers(-3, 300), st.floats(), st.none(), st.binary(max_size=9)), max_size=9),
    st.text(max_size=3),
    st.sampled_from([np.zeros((2, 3)), np.zeros(0, np.uint8), np.array([[1, 2]], object)]),
)


def _right(gl):
    """Calls with arguments that fit."""
    gl.VertexPointer(2, GL.FLOAT, 0, [0.0] * 8)
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.BindBuffer(GL.ARRAY_BUFFER, 1)
    gl.BufferData(GL.ARRAY_BUFFER, 64, None, GL.STATIC_DRAW)
    gl.SelectBuffer(10)
    gl.FeedbackBuffer(10, GL._3D_COLOR_TEXTURE)
    gl.Enable(GL.MAP2_VERTEX_3)


@settings(max_examples=300)
@given(calls=st.lists(st.tuples(st.sampled_from(_NAMES), st.lists(_ARGUMENTS, max_size=10)), max_size=12))
def test_no_call_stops_what_follows(calls):
    gl = context()
    _right(gl)
    for name, arguments in calls:
        gl.call(name, arguments, 4096)
    gl.EndList()
    gl.End()
    gl.BindVertexArray(0)
    for target in (GL.ARRAY_BUFFER, GL.ELEMENT_ARRAY_BUFFER):
        gl.BindBuffer(target, 0)
    gl.RenderMode(GL.RENDER)
    for array in set(gl.arrays.enabled):
        gl.arrays.enabled.discard(array)
    gl.take_commands()
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.VertexPointer(2, GL.FLOAT, 0, [1.0, 2.0])
    gl.Disable(GL.COLOR_ARRAY)
    gl.DrawArrays(GL.POINTS, 0, 1)
    assert len(meshes(gl)) == 1
