"""Vertex arrays: the same draws as calls between Begin and End give, whatever way the vertices come."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.array_draws import MAX_VERTICES
from tests.pipeline.opengl.drawn import context, counted, draws, meshes, refusals, textured

# Of a suffix: the type's token, its dtype and the numbers that are tried.
_WHOLE = {
    "b": (GL.BYTE, "i1", -128, 127),
    "ub": (GL.UNSIGNED_BYTE, "u1", 0, 255),
    "s": (GL.SHORT, "i2", -32768, 32767),
    "us": (GL.UNSIGNED_SHORT, "u2", 0, 65535),
    "i": (GL.INT, "i4", -(2**31), 2**31 - 1),
    "ui": (GL.UNSIGNED_INT, "u4", 0, 2**32 - 1),
}
_REAL = {"f": (GL.FLOAT, "f4", 32), "d": (GL.DOUBLE, "f8", 64)}
_ALL = (*_WHOLE, *_REAL)
_SIGNED = ("s", "i", "f", "d")
# Of an attribute: the entry point's stem, sizes, suffixes and the array's token.
_ATTRIBUTES = {
    "positions": ("Vertex", (2, 3, 4), _SIGNED, GL.VERTEX_ARRAY),
    "colors": ("Color", (3, 4), _ALL, GL.COLOR_ARRAY),
    "normals": ("Normal", (3,), ("b", *_SIGNED), GL.NORMAL_ARRAY),
    "secondary_colors": ("SecondaryColor", (3,), _ALL, GL.SECONDARY_COLOR_ARRAY),
    "fog_coordinates": ("FogCoord", (1,), ("f", "d"), GL.FOG_COORD_ARRAY),
    "edge_flags": ("EdgeFlag", (1,), ("ub",), GL.EDGE_FLAG_ARRAY),
    "texture 0": ("TexCoord", (1, 2, 3, 4), _SIGNED, GL.TEXTURE_COORD_ARRAY),
    "texture 1": ("MultiTexCoord", (1, 2, 3, 4), _SIGNED, GL.TEXTURE_COORD_ARRAY),
}
_POINTERS = {
    "positions": "glVertexPointer",
    "colors": "glColorPointer",
    "normals": "glNormalPointer",
    "secondary_colors": "glSecondaryColorPointerEXT",
    "fog_coordinates": "glFogCoordPointerEXT",
    "edge_flags": "glEdgeFlagPointer",
    "texture": "glTexCoordPointer",
}
_MODES = tuple(range(GL.POINTS, GL.POLYGON + 1))


def _type_of(suffix):
    return (_WHOLE | _REAL)[suffix][:2]


@st.composite
def _arrays(draw):
    """(mode, {attribute: (suffix, array [n, size])})."""
    count = draw(st.integers(0, 7))
    chosen = draw(st.sets(st.sampled_from(list(_ATTRIBUTES)))) | {"positions"}
    made = {}
    for name in sorted(chosen):
        _, sizes, suffixes, _ = _ATTRIBUTES[name]
        size, suffix = draw(st.sampled_from(sizes)), draw(st.sampled_from(suffixes))
        if suffix in _WHOLE:
            numbers = st.integers(*_WHOLE[suffix][2:])
        else:
            numbers = st.floats(-1e6, 1e6, width=_REAL[suffix][2])
        if name == "edge_flags":
            numbers = st.integers(0, 1)
        values = draw(st.lists(numbers, min_size=count * size, max_size=count * size))
        made[name] = suffix, np.array(values, _type_of(suffix)[1]).reshape(count, size)
    return draw(st.sampled_from(_MODES)), made


def _ready():
    """A context whose state reads every attribute."""
    gl = context()
    textured(gl, 0, 1)
    for capability in (GL.LIGHTING, GL.LIGHT0, GL.COLOR_MATERIAL, GL.COLOR_SUM, GL.FOG):
        gl.Enable(capability)
    gl.Fogi(GL.FOG_COORD_SRC, GL.FOG_COORD)
    gl.PolygonMode(GL.FRONT_AND_BACK, GL.LINE)
    gl.Color4f(0.25, 0.5, 0.75, 0.125)
    gl.EdgeFlag(False)
    gl.Normal3f(0.0, 1.0, 0.0)
    gl.SecondaryColor3f(0.5, 0.25, 0.125)
    gl.FogCoordf(3.0)
    gl.TexCoord2f(0.5, 1.5)
    gl.MultiTexCoord3f(GL.TEXTURE1, 1.0, 2.0, 3.0)
    assert not refusals(gl)
    return gl


def _set_attribute(gl, name, suffix, values):
    stem, _, _, _ = _ATTRIBUTES[name]
    values = values.tolist()
    if name == "edge_flags":
        gl.EdgeFlag(values[0])
    elif name == "fog_coordinates":
        gl.call(f"glFogCoord{suffix}", (values[0],))
    else:
        before = (GL.TEXTURE1,) if stem == "MultiTexCoord" else ()
        gl.call(f"gl{stem}{len(values)}{suffix}", (*before, *values))


def _immediate(gl, mode, arrays):
    gl.Begin(mode)
    for i in range(len(arrays["positions"][1])):
        for name in sorted(arrays, key=lambda name: name == "positions"):
            suffix, array = arrays[name]
            _set_attribute(gl, name, suffix, array[i])
    gl.End()


def _set_pointers(gl, arrays, memory_of=lambda name, array: array.tobytes(), stride=0):
    for name, (suffix, array) in arrays.items():
        type_, size, memory = _type_of(suffix)[0], array.shape[1], memory_of(name, array)
        if name.startswith("texture"):
            gl.ClientActiveTexture(GL.TEXTURE0 + int(name[-1]))
        gl.EnableClientState(_ATTRIBUTES[name][3])
        stem = name.split()[0]
        sized = (size,) if stem in ("positions", "colors", "secondary_colors", "texture") else ()
        typed = () if stem == "edge_flags" else (type_,)
        gl.call(_POINTERS[stem], (*sized, *typed, stride, memory))


def _draw_arrays(gl, mode, arrays):
    _set_pointers(gl, arrays)
    gl.DrawArrays(mode, 0, len(arrays["positions"][1]))


def _draw_arrays_later(gl, mode, arrays):
    """From element 2 of arrays that the caller may write into."""
    padded = {
        name: (s, np.concatenate([a[:0], np.ones((2, a.shape[1]), a.dtype), a]))
        for name, (s, a) in arrays.items()
    }
    _set_pointers(gl, padded, lambda name, array: array)
    gl.DrawArrays(mode, 2, len(arrays["positions"][1]))


def _draw_strided(gl, mode, arrays):
    """With other bytes between the elements."""

    def spread(name, array):
        wide = np.full((len(array), 40), 0xA5, np.uint8)
        wide[:, : array.shape[1] * array.itemsize] = array.view(np.uint8)
        return wide.tobytes()

    _set_pointers(gl, arrays, spread, 40)
    gl.DrawArrays(mode, 0, len(arrays["positions"][1]))


def _draw_elements(gl, mode, arrays, type_=GL.UNSIGNED_SHORT, dtype="u2"):
    """By indices into arrays in another order, with elements between them that nothing draws."""
    count = len(arrays["positions"][1])
    places = (np.arange(count)[::-1] * 3 + 1).astype(dtype)
    scattered = {}
    for name, (suffix, array) in arrays.items():
        wide = np.zeros((3 * count + 2, array.shape[1]), array.dtype)
        wide[places] = array
        scattered[name] = suffix, wide
    _set_pointers(gl, scattered)
    gl.DrawElements(mode, count, type_, places.tobytes())


def _draw_far_elements(gl, mode, arrays):
    """By few indices into many elements."""
    count = len(arrays["positions"][1])
    places = np.arange(count, dtype="u4") * 1000
    scattered = {}
    for name, (suffix, array) in arrays.items():
        wide = np.zeros((1000 * count + 1, array.shape[1]), array.dtype)
        wide[places] = array
        scattered[name] = suffix, wide
    _set_pointers(gl, scattered)
    gl.DrawRangeElements(mode, 0, 1000 * count, count, GL.UNSIGNED_INT, places.tolist())


def _draw_buffers(gl, mode, arrays):
    """From buffer objects, behind an offset."""
    count = len(arrays["positions"][1])
    whole, offsets = b"\x77" * 8, {}
    for name, (_, array) in arrays.items():
        offsets[name] = len(whole)
        whole += array.tobytes()
    vertex_buffer, index_buffer = gl.GenBuffersARB(2)
    gl.BindBufferARB(GL.ARRAY_BUFFER, vertex_buffer)
    gl.BufferDataARB(GL.ARRAY_BUFFER, len(whole), whole, GL.STATIC_DRAW)
    gl.BindBufferARB(GL.ELEMENT_ARRAY_BUFFER, index_buffer)
    indices = b"\x55\x55" + np.arange(count, dtype="u1").tobytes()
    gl.BufferDataARB(GL.ELEMENT_ARRAY_BUFFER, len(indices), indices, GL.STREAM_DRAW)
    _set_pointers(gl, arrays, lambda name, array: offsets[name])
    gl.BindBufferARB(GL.ARRAY_BUFFER, 0)
    gl.DrawElements(mode, count, GL.UNSIGNED_BYTE, 2)


def _draw_single_elements(gl, mode, arrays):
    _set_pointers(gl, arrays)
    gl.Begin(mode)
    for i in range(len(arrays["positions"][1])):
        gl.ArrayElement(i)
    gl.End()


def _draw_several_times(gl, mode, arrays):
    """Once with nothing, once with everything."""
    _set_pointers(gl, arrays)
    count = len(arrays["positions"][1])
    gl.MultiDrawArraysEXT(mode, [0, 0], [0, count], 2)


def _draw_several_elements(gl, mode, arrays):
    _set_pointers(gl, arrays)
    count = len(arrays["positions"][1])
    gl.MultiDrawElementsEXT(mode, [count], GL.UNSIGNED_INT, [np.arange(count, dtype="u4").tobytes()], 1)


def _in_list(draw):
    def compiled(gl, mode, arrays):
        gl.NewList(7, GL.COMPILE)
        draw(gl, mode, arrays)
        gl.EndList()
        for name, (_, _, _, token) in _ATTRIBUTES.items():  # what a list reads, it has read
            gl.ClientActiveTexture(GL.TEXTURE0 + int(name[-1]) if name[-1].isdigit() else GL.TEXTURE0)
            gl.DisableClientState(token)
        for name in gl.shared.buffers:
            gl.shared.buffers[name].data[:] = 0
            gl.shared.buffers[name].changed()
        assert not draws(gl)
        gl.CallList(7)

    return compiled


_WAYS = {
    "arrays": _draw_arrays,
    "arrays from element 2": _draw_arrays_later,
    "strided arrays": _draw_strided,
    "elements": _draw_elements,
    "far elements": _draw_far_elements,
    "buffers": _draw_buffers,
    "single elements": _draw_single_elements,
    "several draws": _draw_several_times,
    "several draws of elements": _draw_several_elements,
    "a list": _in_list(_immediate),
    "a list of arrays": _in_list(_draw_arrays_later),
    "a list of buffers": _in_list(_draw_buffers),
    "a list of single elements": _in_list(_draw_single_elements),
}


@pytest.mark.parametrize("way", _WAYS)
@settings(max_examples=30)
@given(program=_arrays())
def test_every_way_draws_what_begin_and_end_draw(way, program):
    mode, arrays = program
    expected, found = _ready(), _ready()
    _immediate(expected, mode, arrays)
    _WAYS[way](found, mode, arrays)
    assert not refusals(found)
    assert draws(found) == draws(expected)


# ----------------------------------------------------------------------------------------- interleaved arrays

_FORMATS = {
    "V2F": "v2",
    "V3F": "v3",
    "C4UB_V2F": "b4 v2",
    "C4UB_V3F": "b4 v3",
    "C3F_V3F": "c3 v3",
    "N3F_V3F": "n3 v3",
    "C4F_N3F_V3F": "c4 n3 v3",
    "T2F_V3F": "t2 v3",
    "T4F_V4F": "t4 v4",
    "T2F_C4UB_V3F": "t2 b4 v3",
    "T2F_C3F_V3F": "t2 c3 v3",
    "T2F_N3F_V3F": "t2 n3 v3",
    "T2F_C4F_N3F_V3F": "t2 c4 n3 v3",
    "T4F_C4F_N3F_V4F": "t4 c4 n3 v4",
}
_NAMES = {"v": "positions", "c": "colors", "b": "colors", "n": "normals", "t": "texture 0"}


@pytest.mark.parametrize("stride", [0, 80])
@pytest.mark.parametrize("layout", _FORMATS)
@pytest.mark.parametrize("buffered", [False, True])
def test_interleaved_arrays(layout, stride, buffered):
    random = np.random.default_rng(3)
    arrays, parts = {}, []
    for part in _FORMATS[layout].split():
        size = int(part[1])
        if part[0] == "b":
            array = random.integers(0, 256, (4, size), np.uint8)
        else:
            array = random.random((4, size), np.float32)
        arrays[_NAMES[part[0]]] = "ub" if part[0] == "b" else "f", array
        parts.append(array.view(np.uint8))
    rows = np.concatenate(parts, axis=1)
    if stride:
        rows = np.concatenate([rows, np.zeros((4, stride - rows.shape[1]), np.uint8)], axis=1)
    expected, found = _ready(), _ready()
    _immediate(expected, GL.QUADS, arrays)
    found.EnableClientState(GL.EDGE_FLAG_ARRAY)
    found.EnableClientState(GL.FOG_COORD_ARRAY)
    memory = rows.tobytes()
    if buffered:
        found.BindBuffer(GL.ARRAY_BUFFER, 1)
        found.BufferData(GL.ARRAY_BUFFER, len(memory) + 4, b"abcd" + memory, GL.STATIC_DRAW)
        memory = 4
    found.InterleavedArrays(getattr(GL, layout), stride, memory)
    found.DrawArrays(GL.QUADS, 0, 4)
    assert not refusals(found)
    assert draws(found) == draws(expected)
    assert found.IsEnabled(GL.NORMAL_ARRAY) == ("normals" in arrays)
    assert not found.IsEnabled(GL.EDGE_FLAG_ARRAY)


def test_interleaved_arrays_leave_other_coordinate_sets():
    gl = _ready()
    gl.ClientActiveTexture(GL.TEXTURE1)
    gl.EnableClientState(GL.TEXTURE_COORD_ARRAY)
    gl.TexCoordPointer(1, GL.FLOAT, 0, [7.0])
    gl.ClientActiveTexture(GL.TEXTURE0)
    gl.InterleavedArrays(GL.V2F, 0, [1.0, 2.0])
    gl.DrawArrays(GL.POINTS, 0, 1)
    ((_, _, columns, _),) = draws(gl)
    assert columns["texture 1"] == [[7.0, 0.0, 0.0, 1.0]]
    assert columns["texture 0"] == [[0.5, 1.5, 0.0, 1.0]]


# -------------------------------------------------------------------------------------------------- details


def _points(gl, numbers, dtype=np.float32):
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.VertexPointer(2, GL.FLOAT, 0, np.array(numbers, dtype).tobytes())


def test_bgra_colors():
    gl = context()
    _points(gl, [[0, 0], [1, 0]])
    gl.EnableClientState(GL.COLOR_ARRAY)
    gl.ColorPointer(GL.BGRA, GL.UNSIGNED_BYTE, 0, bytes((0, 51, 102, 255, 255, 0, 0, 51)))
    gl.DrawArrays(GL.POINTS, 0, 2)
    ((_, _, columns, _),) = draws(gl)
    assert columns["colors"] == [[0.4, 0.2, 0.0, 1.0], [0.0, 0.0, 1.0, 0.2]]


def test_the_extensions_own_calls():
    gl = context()
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.EnableClientState(GL.COLOR_ARRAY)
    gl.VertexPointerEXT(2, GL.FLOAT, 0, 2, np.array([1, 2, 3, 4], np.float32).tobytes())
    gl.ColorPointerEXT(3, GL.UNSIGNED_BYTE, 0, 0, bytes((255, 0, 0, 0, 0, 255)))
    gl.EdgeFlagPointerEXT(0, 1, b"\1")
    gl.DrawArraysEXT(GL.LINES, 0, 2)
    ((_, _, columns, _),) = draws(gl)
    assert [position[:2] for position in columns["positions"]] == [[1.0, 2.0], [3.0, 4.0]]
    assert columns["colors"] == [[1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]]
    gl.VertexPointerEXT(2, GL.FLOAT, 0, -1, b"")
    assert counted(gl, "error") == [("glVertexPointerEXT: GL_INVALID_VALUE", 1)]


def test_color_indices_have_no_effect():
    gl = context()
    _points(gl, [[0, 0]])
    gl.EnableClientState(GL.INDEX_ARRAY)
    gl.IndexPointer(GL.SHORT, 0, b"\0\0")
    gl.Indexi(3)
    gl.DrawArrays(GL.POINTS, 0, 1)
    assert gl.IsEnabled(GL.INDEX_ARRAY)
    assert len(meshes(gl)) == 1
    assert not refusals(gl)


def test_weights():
    gl = context("GEFORCE_256")
    gl.Enable(GL.VERTEX_WEIGHTING_EXT)
    _points(gl, [[0, 0], [1, 0]])
    gl.VertexWeightfEXT(0.75)
    gl.DrawArrays(GL.POINTS, 0, 2)
    gl.EnableClientState(GL.VERTEX_WEIGHT_ARRAY_EXT)
    gl.VertexWeightPointerEXT(1, GL.FLOAT, 0, [0.25, 0.5])
    gl.DrawArrays(GL.POINTS, 0, 2)
    assert [columns["weights"] for _, _, columns, _ in draws(gl)] == [[0.75, 0.75], [0.25, 0.5]]


def test_current_values_stay_after_a_draw_and_change_by_single_elements():
    gl = context()
    _points(gl, [[0, 0]])
    gl.EnableClientState(GL.COLOR_ARRAY)
    gl.ColorPointer(3, GL.FLOAT, 0, [0.5, 0.25, 0.125])
    gl.Color3f(1.0, 0.0, 0.0)
    gl.DrawArrays(GL.POINTS, 0, 1)
    assert gl.current.color == (1.0, 0.0, 0.0, 1.0)
    gl.DisableClientState(GL.VERTEX_ARRAY)
    gl.ArrayElement(0)
    assert gl.current.color == (0.5, 0.25, 0.125, 1.0)


def test_columns_that_nothing_reads_are_not_gathered():
    gl = context()
    _points(gl, [[0, 0]])
    for array in (GL.NORMAL_ARRAY, GL.TEXTURE_COORD_ARRAY, GL.SECONDARY_COLOR_ARRAY, GL.FOG_COORD_ARRAY):
        gl.EnableClientState(array)  # none of them has data
    gl.DrawArrays(GL.POINTS, 0, 1)
    assert not refusals(gl)
    (mesh,) = meshes(gl)
    assert mesh.normals is None
    assert mesh.texture_coordinates == ()


def test_without_a_vertex_array_nothing_is_drawn():
    gl = context()
    gl.DrawArrays(GL.TRIANGLES, 0, 2**31 - 1)
    assert not gl.take_commands()
    assert counted(gl, "no effect") == [("glDrawArrays without a vertex array", 1)]


def test_incomplete_primitives_are_cut():
    gl = context()
    _points(gl, np.zeros((8, 2)))
    for mode, count in (
        (GL.TRIANGLES, 8),
        (GL.QUADS, 7),
        (GL.LINES, 3),
        (GL.TRIANGLE_STRIP, 2),
        (GL.QUAD_STRIP, 5),
    ):
        gl.DrawArrays(mode, 0, count)
    kinds = [(mesh.primitive, len(mesh.positions)) for mesh in meshes(gl)]
    assert kinds == [
        (PrimitiveType.TRIANGLES, 6),
        (PrimitiveType.QUADS, 4),
        (PrimitiveType.LINES, 2),
        (PrimitiveType.QUAD_STRIP, 4),
    ]


def test_locks():
    gl = context()
    gl.UnlockArraysEXT()
    gl.LockArraysEXT(0, 0)
    assert counted(gl, "error")[0][0].startswith("glUnlockArraysEXT: GL_INVALID_OPERATION")
    gl.LockArraysEXT(0, 4)
    assert gl.arrays.locked == (0, 4)
    gl.LockArraysEXT(0, 4)
    gl.UnlockArraysEXT()
    assert gl.arrays.locked is None
    assert len(refusals(gl)) == 3


def test_enable_takes_arrays_too():
    gl = context()
    gl.Enable(GL.VERTEX_ARRAY)
    gl.EnableClientState(GL.VERTEX_ARRAY_RANGE_NV)
    gl.VertexArrayRangeNV(100, 0)
    assert gl.IsEnabled(GL.VERTEX_ARRAY)
    assert gl.IsEnabled(GL.VERTEX_ARRAY_RANGE_NV)
    gl.Disable(GL.VERTEX_ARRAY)
    assert not gl.IsEnabled(GL.VERTEX_ARRAY)
    assert not refusals(gl)


def test_client_state_is_pushed_and_popped():
    gl = context()
    _points(gl, [[1, 2]])
    gl.PushClientAttrib(GL.CLIENT_VERTEX_ARRAY_BIT)
    gl.VertexPointer(3, GL.FLOAT, 0, [4.0, 5.0, 6.0])
    gl.DisableClientState(GL.VERTEX_ARRAY)
    gl.ClientActiveTexture(GL.TEXTURE1)
    gl.PopClientAttrib()
    gl.DrawArrays(GL.POINTS, 0, 1)
    ((_, _, columns, _),) = draws(gl)
    assert columns["positions"] == [[1.0, 2.0, 0.0, 1.0]]
    assert gl.arrays.unit == 0


# ------------------------------------------------------------------------------------------ what goes wrong


@pytest.mark.parametrize(
    ("call", "arguments", "kind"),
    [
        ("VertexPointer", (5, GL.FLOAT, 0, b""), "INVALID_VALUE"),
        ("VertexPointer", (3, GL.UNSIGNED_BYTE, 0, b""), "INVALID_ENUM"),
        ("VertexPointer", (3, GL.FLOAT, -4, b""), "INVALID_VALUE"),
        ("ColorPointer", (GL.BGRA, GL.FLOAT, 0, b""), "INVALID_VALUE"),
        ("NormalPointer", (GL.UNSIGNED_SHORT, 0, b""), "INVALID_ENUM"),
        ("InterleavedArrays", (GL.FLOAT, 0, b""), "INVALID_ENUM"),
        ("InterleavedArrays", (GL.V2F, -1, b""), "INVALID_VALUE"),
        ("EnableClientState", (GL.LIGHTING,), "INVALID_ENUM"),
        ("ClientActiveTexture", (GL.TEXTURE0 + 40,), "INVALID_ENUM"),
        ("DrawArrays", (77, 0, 1), "INVALID_ENUM"),
        ("DrawArrays", (GL.POINTS, 0, -1), "INVALID_VALUE"),
        ("DrawArrays", (GL.POINTS, -1, 1), "INVALID_VALUE"),
        ("DrawElements", (GL.POINTS, 1, GL.FLOAT, b"\0\0\0\0"), "INVALID_ENUM"),
        ("DrawElements", (GL.POINTS, -2, GL.UNSIGNED_BYTE, b"\0"), "INVALID_VALUE"),
        ("DrawRangeElements", (GL.POINTS, 3, 2, 1, GL.UNSIGNED_BYTE, b"\0"), "INVALID_VALUE"),
        ("MultiDrawArrays", (GL.POINTS, [0], [1], -1), "INVALID_VALUE"),
        ("ArrayElement", (-1,), "INVALID_VALUE"),
    ],
)
def test_errors(call, arguments, kind):
    gl = context()
    _points(gl, [[0, 0]])
    gl.call(f"gl{call}", arguments)
    ((sentence, count),) = refusals(gl)
    assert sentence.startswith(f"gl{call}: GL_{kind}")
    assert count == 1
    assert gl.error == getattr(GL, kind)
    assert not gl.take_commands()


@pytest.mark.parametrize(
    ("call", "arguments", "sentence"),
    [
        ("DrawArrays", (GL.POINTS, 0, 2), "its vertex array has 8 bytes, where 16 are read"),
        ("DrawArrays", (GL.POINTS, 0, 2**31 - 1), "it has 2147483647 vertices; at most"),
        ("DrawArrays", (GL.POINTS, 0, 2**20), "its vertex array has 8 bytes, where 8388608 are read"),
        ("DrawArrays", (GL.POINTS, 2**31 - 1, 1), "its vertex array has 8 bytes, where 17179869184 are read"),
        (
            "DrawElements",
            (GL.POINTS, 3, GL.UNSIGNED_INT, b"\0" * 11),
            "its indices have 11 bytes, where 12 are read",
        ),
        ("DrawElements", (GL.POINTS, 1, GL.UNSIGNED_INT, b"\xff" * 4), "its vertex array has 8 bytes, where"),
        ("DrawElements", (GL.POINTS, 2**31 - 1, GL.UNSIGNED_INT, b"\0" * 4), "it has 2147483647 indices"),
        ("DrawElements", (GL.POINTS, 1, GL.UNSIGNED_INT, 4711), "its indices have no data"),
        (
            "DrawElements",
            (GL.POINTS, 1, GL.UNSIGNED_INT, np.zeros(4, "i8")),
            "the array holds int64, where uint32",
        ),
        ("ArrayElement", (1,), "its vertex array has 8 bytes, where 16 are read"),
        ("DrawArrays", (GL.POINTS,), "its arguments cannot be read"),
        ("MultiDrawArrays", (GL.POINTS, [0, 0], [1], 2), "its arguments cannot be read"),
        ("MultiDrawElements", (GL.POINTS, [1], GL.UNSIGNED_INT, None, 1), "its arguments cannot be read"),
    ],
)
def test_what_cannot_be_read_is_refused(call, arguments, sentence):
    gl = context()
    _points(gl, [[0, 0]])
    gl.call(f"gl{call}", arguments)
    ((said, _),) = counted(gl, "refused")
    assert said.startswith(f"gl{call}: {sentence}")
    assert not gl.take_commands()


def test_many_vertices_of_one_byte_each_are_refused():
    gl = context()
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.BindBuffer(GL.ARRAY_BUFFER, 1)
    gl.BufferData(GL.ARRAY_BUFFER, MAX_VERTICES + 100, None, GL.STATIC_DRAW)
    gl.VertexPointer(2, GL.FLOAT, 1, 0)
    gl.DrawArrays(GL.POINTS, 0, MAX_VERTICES + 1)
    ((said, _),) = counted(gl, "refused")
    assert f"at most {MAX_VERTICES} are drawn here" in said


def test_an_address_without_data_is_refused():
    gl = context()
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.VertexPointer(3, GL.FLOAT, 0, 94815574985328)
    gl.DrawArrays(GL.POINTS, 0, 1)
    assert counted(gl, "refused") == [("glDrawArrays: its vertex array has no data", 1)]


def test_an_array_of_another_type_is_refused():
    gl = context()
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.VertexPointer(3, GL.FLOAT, 0, np.zeros((3, 3)))
    assert counted(gl, "refused") == [("glVertexPointer: the array holds float64, where float32 are read", 1)]


def test_several_draws_go_on_after_one_that_is_refused():
    gl = context()
    _points(gl, [[0, 0], [1, 1]])
    gl.MultiDrawArrays(GL.POINTS, [0, 5, 1], [1, 1, 1], 3)
    assert len(meshes(gl)) == 2
    assert len(counted(gl, "refused")) == 1


@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_what_is_no_number_is_left_out(number):
    gl = context()
    _points(gl, [[0, 0], [number, 0]])
    gl.DrawArrays(GL.POINTS, 0, 1)
    gl.DrawArrays(GL.POINTS, 0, 2)
    gl.Color3f(number, 0.0, 0.0)
    gl.DrawArrays(GL.POINTS, 0, 1)
    assert len(meshes(gl)) == 1
    assert counted(gl, "left out") == [
        ("glDrawArrays: a vertex's position is infinite or no number", 1),
        ("glDrawArrays: a vertex's colour is infinite or no number", 1),
    ]


def test_calls_inside_begin_and_end_are_errors_before_anything_is_read():
    gl = context()
    _points(gl, [[0, 0]])
    gl.Begin(GL.POINTS)
    gl.DrawArrays(GL.POINTS, 0, 50)
    gl.End()
    assert counted(gl, "error") == [
        ("glDrawArrays: GL_INVALID_OPERATION, glDrawArrays is called between Begin and End", 1)
    ]


# -------------------------------------------------------------------------------------- meshes by content


def test_equal_bytes_are_the_same_mesh():
    gl = context()
    for numbers in ([[0, 0]], [[0, 1]], [[0, 0]]):
        _points(gl, numbers)
        gl.DrawArrays(GL.POINTS, 0, 1)
    first, second, third = meshes(gl)
    assert first is third
    assert first is not second


def test_other_current_values_are_another_mesh():
    gl = context()
    _points(gl, [[0, 0]])
    for red in (0.0, 1.0, 0.0):
        gl.Color3f(red, 0.0, 0.0)
        gl.DrawArrays(GL.POINTS, 0, 1)
    first, second, third = meshes(gl)
    assert first is third
    assert first is not second


def test_a_writable_array_is_read_at_each_draw():
    gl = context()
    memory = np.zeros((2, 2), np.float32)
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.VertexPointer(2, GL.FLOAT, 0, memory)
    for number in (0.0, 5.0, 0.0):
        memory[:] = number
        gl.DrawArrays(GL.LINES, 0, 2)
    first, second, third = meshes(gl)
    assert first is third
    assert second.positions.tolist() == [[5.0, 5.0], [5.0, 5.0]]


def test_calls_between_begin_and_end_are_the_same_mesh():
    gl = context()
    for x in (0.0, 1.0, 0.0):
        gl.Begin(GL.LINES)
        gl.Vertex2f(0.0, 0.0)
        gl.Vertex2f(x, 1.0)
        gl.End()
    first, second, third = meshes(gl)
    assert first is third
    assert first is not second


def test_multi_draws_pass_over_counts_that_are_not_positive():
    gl = context()
    gl.EnableClientState(GL.VERTEX_ARRAY)
    gl.VertexPointer(2, GL.FLOAT, 0, np.array([[0.0, 0.0], [0.5, 0.5]], np.float32))
    gl.MultiDrawArrays(GL.POINTS, [0, 0, 1], [1, -1, 1], 3)
    assert len(meshes(gl)) == 2
    gl.MultiDrawArrays(GL.POINTS, [0, 0], [0, 0], 2)
    assert not refusals(gl)
    gl.MultiDrawArrays(99, [0], [0], 1)
    assert gl.error == GL.INVALID_ENUM
