"""Buffer objects: their contents by every way that a program or a trace writes them."""

import numpy as np
import pytest

from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.buffers import MAX_BUFFER_SIZE, memory_at
from tests.pipeline.opengl.drawn import context, counted, draws, meshes, refusals

_POINTS = np.array([[1, 2], [3, 4]], np.float32)
_OTHERS = np.array([[5, 6], [7, 8]], np.float32)


def _buffered(contents=_POINTS, name=1):
    """A context that draws two points from a buffer."""
    gl = context()
    gl.BindBuffer(GL.ARRAY_BUFFER, name)
    gl.BufferData(GL.ARRAY_BUFFER, contents.nbytes, contents, GL.STATIC_DRAW)
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.VertexPointer(2, GL.FLOAT, 0, None)
    return gl


def _drawn(gl):
    gl.DrawArrays(GL.POINTS, 0, 2)
    ((_, _, columns, _),) = draws(gl)
    return [position[:2] for position in columns["positions"]]


def test_a_part_is_replaced():
    gl = _buffered()
    assert _drawn(gl) == _POINTS.tolist()
    gl.BufferSubData(GL.ARRAY_BUFFER, 4, 8, np.array([9, 10, 11], np.float32))
    assert _drawn(gl) == [[1.0, 9.0], [10.0, 4.0]]
    assert gl.GetBufferSubData(GL.ARRAY_BUFFER, 4, 8) == np.array([9, 10], np.float32).tobytes()
    into = np.zeros(2, np.float32)
    gl.GetBufferSubData(GL.ARRAY_BUFFER, 0, 8, into)
    assert into.tolist() == [1.0, 9.0]


def test_a_mapped_buffer_is_written_by_the_caller():
    gl = _buffered()
    gl.DrawArrays(GL.POINTS, 0, 2)
    memory = gl.MapBuffer(GL.ARRAY_BUFFER, GL.WRITE_ONLY)
    memory.view(np.float32)[:] = _OTHERS.reshape(-1)
    assert gl.UnmapBuffer(GL.ARRAY_BUFFER) is True
    gl.DrawArrays(GL.POINTS, 0, 2)
    assert [mesh.positions.tolist() for mesh in meshes(gl)] == [_POINTS.tolist(), _OTHERS.tolist()]


def test_a_buffer_mapped_for_reading_cannot_be_written():
    memory = _buffered().MapBuffer(GL.ARRAY_BUFFER, GL.READ_ONLY)
    with pytest.raises(ValueError, match="read-only"):
        memory[:] = 0


def test_a_part_is_mapped():
    gl = _buffered()
    memory = gl.MapBufferRange(GL.ARRAY_BUFFER, 8, 8, 2)
    memory.view(np.float32)[:] = 0.5
    gl.FlushMappedBufferRange(GL.ARRAY_BUFFER, 0, 8)
    gl.UnmapBuffer(GL.ARRAY_BUFFER)
    assert _drawn(gl) == [[1.0, 2.0], [0.5, 0.5]]


def test_a_recorded_program_writes_by_memcpy():
    gl = _buffered()
    assert _drawn(gl) == _POINTS.tolist()
    address = 0x7F0000001000
    assert gl.call("glMapBufferARB", (GL.ARRAY_BUFFER, GL.WRITE_ONLY), result=address) == address
    gl.call("memcpy", (address + 8, _OTHERS.tobytes(), 8))
    gl.UnmapBufferARB(GL.ARRAY_BUFFER)
    assert _drawn(gl) == [[1.0, 2.0], [5.0, 6.0]]
    gl.call("memcpy", (address, _OTHERS.tobytes(), 8))
    assert counted(gl, "no effect") == [("memcpy into memory that no buffer has", 1)]
    assert _drawn(gl) == [[1.0, 2.0], [5.0, 6.0]]


def test_memcpy_into_a_mapped_part_and_past_its_end():
    gl = _buffered()
    gl.call("glMapBufferRange", (GL.ARRAY_BUFFER, 4, 12, 2), result=1004)
    gl.call("memcpy", (1012, _OTHERS.tobytes(), 16))
    gl.UnmapBuffer(GL.ARRAY_BUFFER)
    assert _drawn(gl) == [[1.0, 2.0], [3.0, 5.0]]


def test_equal_contents_are_the_same_mesh():
    gl = _buffered()
    for contents in (_POINTS, _POINTS, _OTHERS):
        gl.BufferData(GL.ARRAY_BUFFER, contents.nbytes, contents.tobytes(), GL.DYNAMIC_DRAW)
        gl.DrawArrays(GL.POINTS, 0, 2)
    gl.BufferSubData(GL.ARRAY_BUFFER, 0, 16, _OTHERS.tobytes())
    gl.DrawArrays(GL.POINTS, 0, 2)
    first, second, third, fourth = meshes(gl)
    assert first is second
    assert second is not third
    assert third is fourth


def test_a_pointer_keeps_the_buffer_that_was_bound():
    gl = _buffered()
    gl.BindBuffer(GL.ARRAY_BUFFER, 2)
    gl.BufferData(GL.ARRAY_BUFFER, 16, _OTHERS, GL.STATIC_DRAW)
    assert _drawn(gl) == _POINTS.tolist()
    gl.VertexPointer(2, GL.FLOAT, 0, 0)
    assert _drawn(gl) == _OTHERS.tolist()


def test_names():
    gl = context()
    first, second = gl.GenBuffers(2)
    assert first != second
    assert not gl.IsBuffer(first)
    gl.BindBuffer(GL.ELEMENT_ARRAY_BUFFER, first)
    assert gl.IsBuffer(first)
    assert gl.call("glGenBuffersARB", (2, [40, 41])) == [40, 41]
    assert gl.GenBuffers(1) == [42]
    gl.DeleteBuffers(2, [first, 4711])
    assert not gl.IsBuffer(first)
    assert gl.buffers[GL.ELEMENT_ARRAY_BUFFER] is None
    assert gl.buffers.name(GL.ELEMENT_ARRAY_BUFFER) == 0
    assert not refusals(gl)


def test_memory_at_a_pointer():
    gl = _buffered()
    assert memory_at(gl, GL.ARRAY_BUFFER, 8).view(np.float32).tolist() == [3.0, 4.0]
    assert memory_at(gl, GL.ARRAY_BUFFER, 17) is None
    assert memory_at(gl, GL.PIXEL_UNPACK_BUFFER_ARB, 8) is None
    assert memory_at(gl, GL.ARRAY_BUFFER, b"ab").tolist() == [97, 98]
    assert memory_at(gl, GL.PIXEL_UNPACK_BUFFER_ARB, [1, 2], "<u2").tolist() == [1, 0, 2, 0]


@pytest.mark.parametrize(
    ("call", "arguments", "kind"),
    [
        ("BindBuffer", (GL.FLOAT, 1), "INVALID_ENUM"),
        ("GenBuffers", (-1,), "INVALID_VALUE"),
        ("GenBuffers", (2**31 - 1,), "OUT_OF_MEMORY"),
        ("DeleteBuffers", (-1, []), "INVALID_VALUE"),
        ("BufferData", (GL.ELEMENT_ARRAY_BUFFER, 4, None, GL.STATIC_DRAW), "INVALID_OPERATION"),
        ("BufferData", (GL.ARRAY_BUFFER, 4, None, GL.FLOAT), "INVALID_ENUM"),
        ("BufferData", (GL.ARRAY_BUFFER, -4, None, GL.STATIC_DRAW), "INVALID_VALUE"),
        ("BufferData", (GL.ARRAY_BUFFER, MAX_BUFFER_SIZE + 1, None, GL.STATIC_DRAW), "OUT_OF_MEMORY"),
        ("BufferSubData", (GL.ARRAY_BUFFER, 12, 8, b"12345678"), "INVALID_VALUE"),
        ("BufferSubData", (GL.ARRAY_BUFFER, -1, 8, b"12345678"), "INVALID_VALUE"),
        ("GetBufferSubData", (GL.ARRAY_BUFFER, 0, 17), "INVALID_VALUE"),
        ("MapBuffer", (GL.ARRAY_BUFFER, GL.FLOAT), "INVALID_ENUM"),
        ("MapBuffer", (GL.PIXEL_PACK_BUFFER_ARB, GL.READ_ONLY), "INVALID_OPERATION"),
        ("UnmapBuffer", (GL.ARRAY_BUFFER,), "INVALID_OPERATION"),
        ("FlushMappedBufferRange", (GL.ARRAY_BUFFER, 0, 4), "INVALID_OPERATION"),
    ],
)
def test_errors(call, arguments, kind):
    gl = _buffered()
    gl.call(f"gl{call}", arguments)
    ((sentence, _),) = refusals(gl)
    assert sentence.startswith(f"gl{call}: GL_{kind}")
    assert _drawn(gl) == _POINTS.tolist()


@pytest.mark.parametrize(
    ("call", "arguments"),
    [
        ("MapBuffer", (GL.ARRAY_BUFFER, GL.READ_ONLY)),
        ("BufferSubData", (GL.ARRAY_BUFFER, 0, 4, b"1234")),
        ("GetBufferSubData", (GL.ARRAY_BUFFER, 0, 4)),
        ("DrawArrays", (GL.POINTS, 0, 2)),
        ("ArrayElement", (0,)),
    ],
)
def test_a_mapped_buffer_is_not_used(call, arguments):
    gl = _buffered()
    gl.MapBuffer(GL.ARRAY_BUFFER, GL.READ_ONLY)
    gl.call(f"gl{call}", arguments)
    ((sentence, _),) = counted(gl, "error")
    assert sentence.startswith(f"gl{call}: GL_INVALID_OPERATION")
    gl.BufferData(GL.ARRAY_BUFFER, 16, _OTHERS, GL.STATIC_DRAW)  # ends the mapping
    assert _drawn(gl) == _OTHERS.tolist()


def test_data_that_were_not_recorded():
    gl = _buffered()
    gl.BufferSubData(GL.ARRAY_BUFFER, 0, 8, 94815574985328)
    assert counted(gl, "refused") == [("glBufferSubData: the data were not recorded", 1)]


def test_bindings_are_pushed_and_popped():
    gl = _buffered()
    gl.PushClientAttrib(GL.CLIENT_VERTEX_ARRAY_BIT)
    gl.BindBuffer(GL.ARRAY_BUFFER, 0)
    gl.PopClientAttrib()
    assert gl.buffers.name(GL.ARRAY_BUFFER) == 1
    assert gl.buffers[GL.ARRAY_BUFFER] is gl.shared.buffers[1]
