"""Display lists: what they keep, when they are called, and what goes wrong."""

from itertools import chain

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.opengl import lists
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.context import Context, Shared
from fixedpipe.pipeline.opengl.lists import MAX_LIST_NESTING
from fixedpipe.pipeline.profiles import GEFORCE_256
from tests.pipeline.opengl.drawn import context, counted, draws, meshes, refusals, textured


def _listed(gl, name, *calls, mode=GL.COMPILE):
    gl.NewList(name, mode)
    for call, *arguments in calls:
        gl.call(f"gl{call}", arguments)
    gl.EndList()


_POINT = (("Begin", GL.POINTS), ("Vertex2f", 0.5, 0.25), ("End",))


def _colors(gl):
    return [columns["colors"] for _, _, columns, _ in draws(gl)]


# -------------------------------------------------------------------------------- as if the calls were made

_NUMBERS = st.floats(-4.0, 4.0, width=32)


def _calls():
    """Calls of which most stand between Begin and End, and some do not."""
    vertex = st.tuples(st.just("Vertex2f"), _NUMBERS, _NUMBERS)
    color = st.tuples(st.just("Color3f"), *[st.floats(0.0, 1.0, width=32)] * 3)
    normal = st.tuples(st.just("Normal3f"), *[_NUMBERS] * 3)
    coordinates = st.tuples(
        st.just("MultiTexCoord2f"), st.sampled_from((GL.TEXTURE0, GL.TEXTURE1)), _NUMBERS, _NUMBERS
    )
    flag = st.tuples(st.just("EdgeFlag"), st.booleans())
    begin = st.tuples(st.just("Begin"), st.sampled_from((GL.POINTS, GL.TRIANGLES, GL.POLYGON, GL.QUAD_STRIP)))
    material = st.tuples(
        st.just("Materialfv"), st.just(GL.FRONT), st.just(GL.EMISSION), st.just([0.5, 0.25, 0.0, 1.0])
    )
    translation = st.tuples(st.just("Translatef"), _NUMBERS, _NUMBERS, _NUMBERS)
    wrong = st.sampled_from((("Begin", 77), ("End",), ("MultiTexCoord2f", 3, 0.0, 0.0), ("ShadeModel", 5)))
    end = st.just(("End",))
    vertices = st.lists(st.one_of(vertex, vertex, vertex, color, normal, coordinates, flag), max_size=9)
    whole = st.tuples(begin, vertices, end).map(lambda parts: [parts[0], *parts[1], parts[2]])
    single = st.one_of(vertex, color, coordinates, begin, end, material, translation, wrong).map(
        lambda call: [call]
    )
    return st.lists(st.one_of(whole, whole, single), max_size=6).map(lambda groups: list(chain(*groups)))


def _state_of(gl):
    return gl.current.values(), gl.values["modelview"], gl.begun is None, gl.error


def _ready():
    gl = context()
    textured(gl, 0, 1)
    gl.PolygonMode(GL.FRONT_AND_BACK, GL.LINE)
    gl.Enable(GL.LIGHTING)
    gl.Enable(GL.LIGHT0)
    gl.Enable(GL.COLOR_MATERIAL)
    return gl


@settings(max_examples=150)
@given(calls=_calls(), within=st.booleans())
def test_a_list_does_what_its_calls_do(calls, within):
    expected, found = _ready(), _ready()
    _listed(found, 5, *calls)
    for gl in (expected, found):
        if within:  # a Begin of the caller
            gl.Begin(GL.LINE_STRIP)
            gl.Vertex2f(9.0, 9.0)
        for call, *arguments in calls if gl is expected else [("CallList", 5)]:
            gl.call(f"gl{call}", arguments)
        gl.End()
    assert draws(found) == draws(expected)
    assert _state_of(found) == _state_of(expected)
    assert sorted(refusals(found)) == sorted(refusals(expected))


@settings(max_examples=100)
@given(calls=_calls())
def test_compile_and_execute_does_it_at_once_and_again(calls):
    expected, found = _ready(), _ready()
    for _ in range(2):
        for call, *arguments in calls:
            expected.call(f"gl{call}", arguments)
    found.NewList(5, GL.COMPILE_AND_EXECUTE)
    for call, *arguments in calls:
        found.call(f"gl{call}", arguments)
    assume(found.begun is None)  # EndList is an error between Begin and End
    found.EndList()
    found.CallList(5)
    assert draws(found) == draws(expected)
    assert _state_of(found) == _state_of(expected)


def test_current_values_that_a_list_does_not_set_are_the_callers():
    gl = context()
    _listed(
        gl, 1, ("Begin", GL.LINES), ("Vertex2f", 0, 0), ("Color3f", 0, 1, 0), ("Vertex2f", 1, 0), ("End",)
    )
    gl.Color3f(1.0, 0.0, 0.0)
    gl.CallList(1)
    gl.CallList(1)
    red, green = [1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]
    assert _colors(gl) == [[red, green], [green, green]]
    assert gl.current.color == tuple(green)


def test_a_list_called_again_draws_the_same_mesh():
    gl = context()
    _listed(gl, 1, *_POINT)
    for red in (1.0, 0.0, 1.0):
        gl.Color3f(red, 0.0, 0.0)
        gl.CallList(1)
    first, second, third = meshes(gl)
    assert first is third
    assert first is not second


def test_arguments_are_kept_as_they_were():
    gl = context()
    position = [1.0, 2.0]
    gl.NewList(1, GL.COMPILE)
    gl.Begin(GL.POINTS)
    gl.Vertex2fv(position)
    gl.End()
    gl.EndList()
    position[0] = 50.0
    gl.CallList(1)
    ((_, _, columns, _),) = draws(gl)
    assert columns["positions"] == [[1.0, 2.0, 0.0, 1.0]]


def test_a_list_replaces_another_only_when_it_is_ended():
    gl = context()
    _listed(gl, 1, *_POINT)
    gl.NewList(1, GL.COMPILE)
    gl.CallList(1)  # compiled: the list of that name when it is called
    gl.EndList()
    gl.CallList(1)
    assert not gl.take_commands()
    gl.NewList(2, GL.COMPILE_AND_EXECUTE)
    gl.Color3f(0.0, 0.0, 1.0)
    gl.EndList()
    assert gl.current.color == (0.0, 0.0, 1.0, 1.0)


def test_calls_that_no_list_keeps_take_effect_at_once():
    gl = context()
    gl.NewList(1, GL.COMPILE)
    gl.EnableClientState(GL.VERTEX_ARRAY)
    assert gl.GenLists(1) == 1
    assert gl.IsList(1)
    gl.EndList()
    assert gl.shared.lists[1] == ()
    assert gl.IsEnabled(GL.VERTEX_ARRAY)


def test_lists_are_shared_between_contexts():
    shared = Shared()
    one, other = (Context(GEFORCE_256, 8, 8, shared=shared) for _ in range(2))
    _listed(one, 3, *_POINT)
    other.CallList(3)
    assert len(meshes(other)) == 1


# --------------------------------------------------------------------------------------------------- names


def test_names_in_a_row():
    gl = context()
    assert gl.GenLists(3) == 1
    assert gl.GenLists(2) == 4
    assert [gl.IsList(name) for name in (0, 1, 5, 6)] == [False, True, True, False]
    _listed(gl, 10)
    assert gl.GenLists(1) == 11
    gl.DeleteLists(2, 3)
    assert [gl.IsList(name) for name in range(1, 7)] == [True, False, False, False, True, False]
    assert gl.GenLists(0) == 0
    gl.DeleteLists(1, 2**31 - 1)
    assert not any(gl.IsList(name) for name in range(12))
    assert not refusals(gl)


def test_recorded_names_are_taken_where_they_are_unused():
    gl = context()
    assert gl.call("glGenLists", (4,), result=100) == 100
    assert gl.call("glGenLists", (4,), result=102) == 104
    assert gl.call("glGenLists", (1,), result=50) == 50
    _listed(gl, 60)
    assert gl.call("glGenLists", (20,), result=55) == 108


def test_a_million_names_cost_nothing():
    gl = context()
    for _ in range(100):
        gl.GenLists(10_000)
    assert gl.GenLists(2**31 - 1) == 1_000_001
    assert gl.GenLists(2**31 - 1) == 0
    assert len(gl.shared.list_names._ranges) == 1
    assert not gl.shared.lists


# ------------------------------------------------------------------------------------------------- calling

_NAMES = [3, 4, 100]


@pytest.mark.parametrize(
    ("type_", "numbers"),
    [
        (GL.BYTE, np.array([-7, -6, 90], "i1")),
        (GL.UNSIGNED_BYTE, np.array([3, 4, 100], "u1")),
        (GL.SHORT, np.array([-997, -996, -900], "<i2")),
        (GL.UNSIGNED_SHORT, np.array([3, 4, 100], "<u2")),
        (GL.INT, np.array([-99997, -99996, -99900], "<i4")),
        (GL.UNSIGNED_INT, np.array([3, 4, 100], "<u4")),
        (GL.FLOAT, np.array([3.9, 4.0, 100.5], "<f4")),
        (GL._2_BYTES, np.array([3, 4, 100], ">u2")),
        (GL._3_BYTES, np.array([[0, 0, 3], [0, 0, 4], [0, 0, 100]], "u1")),
        (GL._4_BYTES, np.array([3, 4, 100], ">u4")),
    ],
)
@pytest.mark.parametrize("form", ["bytes", "numbers"])
def test_lists_by_every_type(type_, numbers, form):
    gl = context()
    for name in _NAMES:
        _listed(gl, name, ("Color3f", name / 128, 0.0, 0.0), *_POINT)
    first = int(numbers.reshape(-1)[0])
    base = {GL.BYTE: 10, GL.SHORT: 1000, GL.INT: 100_000}.get(type_, 0)
    assert first + base == 3 or type_ >= GL._2_BYTES
    gl.ListBase(base)
    given_as = numbers.tobytes() if form == "bytes" else numbers.tolist()
    if form == "numbers" and type_ >= GL._2_BYTES:
        given_as = list(numbers.tobytes())
    gl.CallLists(3, type_, given_as)
    assert not refusals(gl)
    assert _colors(gl) == [[[name / 128, 0.0, 0.0, 1.0]] for name in _NAMES]


def test_text_by_the_base_of_a_font():
    gl = context()
    for letter in "ab":
        _listed(gl, 1000 + ord(letter), ("Translatef", ord(letter) - 96, 0, 0))
    gl.PushAttrib(GL.LIST_BIT)
    gl.ListBase(1000)
    gl.CallLists(3, GL.UNSIGNED_BYTE, "abb")
    gl.PopAttrib()
    assert gl.values["modelview"][-1][0][3] == 5.0
    assert gl.values["list_base"] == 0


def test_the_base_is_that_of_the_call_and_not_of_the_compilation():
    gl = context()
    _listed(gl, 11, ("Color3f", 1, 0, 0))
    _listed(gl, 21, ("Color3f", 0, 1, 0))
    gl.ListBase(10)
    _listed(gl, 1, ("CallLists", 1, GL.UNSIGNED_BYTE, b"\1"))
    gl.ListBase(20)
    gl.CallList(1)
    assert gl.current.color == (0.0, 1.0, 0.0, 1.0)


def test_a_list_stands_between_begin_and_end():
    gl = context()
    _listed(gl, 1, ("Color3f", 1, 0, 0), ("Vertex2f", 1, 1))
    gl.Begin(GL.LINES)
    gl.Vertex2f(0, 0)
    gl.CallList(1)
    gl.End()
    white, red = [1.0, 1.0, 1.0, 1.0], [1.0, 0.0, 0.0, 1.0]
    assert _colors(gl) == [[white, red]]


def test_lists_are_nested_so_deeply_and_no_deeper():
    gl = context()
    for name in range(1, 100):
        _listed(gl, name, ("Translatef", 1, 0, 0), ("CallList", name + 1))
    gl.CallList(1)
    assert gl.values["modelview"][-1][0][3] == MAX_LIST_NESTING
    assert gl.nesting == 0


def test_a_list_that_calls_itself_twice_ends(monkeypatch):
    monkeypatch.setattr(lists, "MAX_LISTED_CALLS", 10_000)
    gl = context()
    gl.NewList(1, GL.COMPILE)
    gl.CallList(1)
    gl.CallList(1)
    gl.EndList()
    gl.CallList(1)
    assert counted(gl, "refused") == [("glCallList: its lists make more than 10000 calls", 1)]
    assert gl.nesting == 0
    _listed(gl, 2, *_POINT)
    gl.CallList(2)
    assert len(meshes(gl)) == 1


def test_errors_in_a_list_are_those_of_its_calls():
    gl = context()
    _listed(gl, 1, ("ShadeModel", 77), ("Color3f", 1, 0, 0), ("Viewport", 0, 0, -1, 2))
    assert not refusals(gl)
    gl.CallList(1)
    assert [sentence for sentence, _ in counted(gl, "error")] == [
        "glShadeModel: GL_INVALID_ENUM, 0x4d is not among its values",
        "glViewport: GL_INVALID_VALUE",
    ]
    assert gl.error == GL.INVALID_ENUM
    assert gl.current.color == (1.0, 0.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("call", "arguments", "kind"),
    [
        ("NewList", (0, GL.COMPILE), "INVALID_VALUE"),
        ("NewList", (1, GL.FLOAT), "INVALID_ENUM"),
        ("EndList", (), "INVALID_OPERATION"),
        ("CallList", (0,), "INVALID_VALUE"),
        ("CallLists", (-1, GL.BYTE, b""), "INVALID_VALUE"),
        ("CallLists", (1, GL.DOUBLE, b"12345678"), "INVALID_ENUM"),
        ("GenLists", (-1,), "INVALID_VALUE"),
        ("DeleteLists", (1, -1), "INVALID_VALUE"),
    ],
)
def test_errors(call, arguments, kind):
    gl = context()
    gl.call(f"gl{call}", arguments)
    ((sentence, _),) = refusals(gl)
    assert sentence.startswith(f"gl{call}: GL_{kind}")


def test_a_list_in_a_list_is_an_error():
    gl = context()
    gl.NewList(1, GL.COMPILE)
    gl.NewList(2, GL.COMPILE)
    gl.EndList()
    gl.EndList()
    assert [sentence for sentence, _ in counted(gl, "error")] == [
        "glNewList: GL_INVALID_OPERATION, list 1 is not ended",
        "glEndList: GL_INVALID_OPERATION, no list is begun",
    ]
    assert gl.IsList(1)
    assert not gl.IsList(2)


def test_numbers_of_lists_that_cannot_be_read():
    gl = context()
    gl.CallLists(3, GL.UNSIGNED_SHORT, b"12345")
    gl.CallLists(2**31 - 1, GL.UNSIGNED_INT, b"1234")
    gl.CallLists(1, GL.UNSIGNED_BYTE, None)
    assert [sentence for sentence, _ in counted(gl, "refused")] == [
        "glCallLists: 5 bytes of lists' numbers, where 6 are read",
        "glCallLists: 4 bytes of lists' numbers, where 8589934588 are read",
        "glCallLists: 0 bytes of lists' numbers, where 1 are read",
    ]


def test_a_primitive_that_is_left_out_sets_the_current_values_of_its_calls():
    colors = []
    for listed in (False, True):
        gl = context()
        gl.LoadMatrixf([float("nan")] * 16)
        if listed:
            gl.NewList(1, GL.COMPILE)
        gl.Begin(GL.POINTS)
        gl.Color3f(1, 0, 0)
        gl.Vertex2f(0, 0)
        gl.End()
        if listed:
            gl.EndList()
            gl.CallList(1)
        assert not gl.take_commands() and refusals(gl)
        colors.append(tuple(gl.current.color))
    assert colors == [(1, 0, 0, 1)] * 2


def test_no_lists_are_called_by_no_numbers():
    gl = context()
    gl.CallLists(0, GL.UNSIGNED_BYTE, None)
    assert not refusals(gl)
