"""Vertex array objects: each has its own arrays and indices, and draws as the same arrays without it."""

import numpy as np
import pytest

from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.queries import answer
from tests.pipeline.opengl.drawn import context, counted, draws, refusals

BINDING = 0x85B5
_CORNERS = np.array([[-1, -1], [1, -1], [-1, 1]], np.float32)
_COLORS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)


def _buffer(gl, name, numbers, target=GL.ARRAY_BUFFER):
    gl.BindBuffer(target, name)
    gl.BufferData(target, numbers.nbytes, numbers.tobytes(), GL.STATIC_DRAW)


def _triangle(gl, first, scale=1.0):
    """Arrays of positions, colours and indices in the buffers ``first`` to ``first`` + 2."""
    _buffer(gl, first, _CORNERS * np.float32(scale))
    gl.VertexPointer(2, GL.FLOAT, 0, None)
    gl.EnableClientState(GL.VERTEX_ARRAY)
    _buffer(gl, first + 1, _COLORS)
    gl.ColorPointer(3, GL.FLOAT, 0, None)
    gl.EnableClientState(GL.COLOR_ARRAY)
    gl.BindBuffer(GL.ARRAY_BUFFER, 0)
    _buffer(gl, first + 2, np.array([2, 1, 0], np.uint16), GL.ELEMENT_ARRAY_BUFFER)


def _draw(gl):
    gl.DrawElements(GL.TRIANGLES, 3, GL.UNSIGNED_SHORT, None)
    return draws(gl)


def test_each_object_draws_its_own_arrays_and_indices():
    gl, plain = context(), context()
    gl.GenVertexArrays(2, [4, 9])
    for name, scale in ((4, 1.0), (9, 0.5)):
        gl.BindVertexArray(name)
        _triangle(gl, 10 * name, scale)
    expected = []
    for scale in (1.0, 0.5):
        _triangle(plain, 1, scale)
        expected.append(_draw(plain))
    for name, drawn in ((4, expected[0]), (9, expected[1]), (4, expected[0])):
        gl.BindVertexArray(name)
        assert _draw(gl) == drawn
    assert not refusals(gl) and expected[0] != expected[1]


def test_what_an_object_has_leaves_the_state_without_objects_as_it_is():
    gl = context()
    _triangle(gl, 1)
    expected = _draw(gl)
    (name,) = gl.GenVertexArrays(1)
    gl.BindVertexArray(name)
    assert not gl.IsEnabled(GL.VERTEX_ARRAY) and not gl.GetIntegerv(GL.ELEMENT_ARRAY_BUFFER_BINDING)
    assert gl.GetIntegerv(BINDING) == name and answer(gl, "glGetIntegerv", [BINDING, None]) == (name,)
    gl.VertexPointer(4, GL.SHORT, 8, None)
    gl.BindVertexArray(0)
    assert gl.GetIntegerv(GL.ELEMENT_ARRAY_BUFFER_BINDING) == 3 and gl.GetIntegerv(BINDING) == 0
    assert _draw(gl) == expected and not refusals(gl)


def test_the_array_buffer_and_the_active_unit_are_no_objects():
    gl = context()
    _buffer(gl, 5, _CORNERS)
    gl.ClientActiveTexture(GL.TEXTURE1)
    gl.BindVertexArrayAPPLE(3)
    assert gl.GetIntegerv(GL.ARRAY_BUFFER_BINDING) == 5
    assert gl.GetIntegerv(GL.CLIENT_ACTIVE_TEXTURE) == GL.TEXTURE1


def test_a_name_is_an_object_once_it_was_bound():
    gl = context()
    gl.GenVertexArrays(1, [7])
    assert not gl.IsVertexArray(7) and not gl.IsVertexArray(0)
    gl.BindVertexArray(7)
    assert gl.IsVertexArray(7)
    assert gl.GenVertexArrays(2) == [8, 9]
    gl.DeleteVertexArrays(2, [7, 0])
    assert not gl.IsVertexArray(7) and gl.GetIntegerv(BINDING) == 0
    gl.BindVertexArray(7)
    ((sentence, _),) = counted(gl, "error")
    assert "GL_INVALID_OPERATION, GenVertexArrays gave no name 7" in sentence


def test_apples_take_any_name_and_client_memory():
    gl, plain = context(), context()
    gl.BindVertexArrayAPPLE(12)
    for each in (gl, plain):
        each.VertexPointer(2, GL.FLOAT, 0, _CORNERS)
        each.EnableClientState(GL.VERTEX_ARRAY)
        each.DrawArrays(GL.TRIANGLES, 0, 3)
    assert draws(gl) == draws(plain) and gl.IsVertexArrayAPPLE(12) and not refusals(gl)
    gl.DeleteVertexArraysAPPLE(1, [12])
    assert not gl.IsEnabled(GL.VERTEX_ARRAY)


@pytest.mark.parametrize("pointer", [_CORNERS, 64])
def test_arrays_of_an_object_lie_in_buffers(pointer):
    gl = context()
    gl.GenVertexArrays(1, [1])
    gl.BindVertexArray(1)
    gl.VertexPointer(2, GL.FLOAT, 0, None)
    assert not refusals(gl)
    gl.VertexPointer(2, GL.FLOAT, 0, pointer)
    ((sentence, _),) = counted(gl, "error")
    assert "GL_INVALID_OPERATION" in sentence and "lie in buffers" in sentence


def test_the_clients_stack_gives_back_the_object_and_what_it_had():
    gl = context()
    gl.GenVertexArrays(2, [1, 2])
    gl.BindVertexArray(1)
    _triangle(gl, 1)
    expected = _draw(gl)
    gl.PushClientAttrib(GL.CLIENT_VERTEX_ARRAY_BIT)
    gl.DisableClientState(GL.COLOR_ARRAY)
    gl.BindVertexArray(2)
    gl.PopClientAttrib()
    assert gl.GetIntegerv(BINDING) == 1 and _draw(gl) == expected
    gl.PushClientAttrib(GL.CLIENT_VERTEX_ARRAY_BIT)
    gl.DeleteVertexArrays(1, [1])
    gl.PopClientAttrib()
    assert gl.GetIntegerv(BINDING) == 0 and not gl.IsVertexArray(1) and not refusals(gl)


@pytest.mark.parametrize("call", ["GenVertexArrays", "DeleteVertexArrays"])
def test_no_less_than_none(call):
    gl = context()
    getattr(gl, call)(-1, [])
    assert "GL_INVALID_VALUE" in counted(gl, "error")[0][0]


def test_a_damaged_trace_asks_for_few_names():
    gl = context()
    gl.GenVertexArrays(1 << 30, None)
    assert "GL_OUT_OF_MEMORY" in counted(gl, "error")[0][0]
