"""PushAttrib and PopAttrib: what is pushed comes back, and nothing else does."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.opengl import texturing
from fixedpipe.pipeline.opengl import tokens as t
from fixedpipe.pipeline.opengl.attributes import STACK_DEPTH
from fixedpipe.pipeline.opengl.lighting import settle_materials
from fixedpipe.pipeline.opengl.values import VALUES
from tests.pipeline.opengl.drawn import context

STACKS = ("attribute stack", "client attribute stack")


def whole_state(gl):
    """All that Push and Pop could change. Colours that follow the current one have its value."""
    settle_materials(gl)
    values = {key: value for key, value in gl.values._of.items() if key not in STACKS}
    bound = [texturing.bound_object(gl, t.TEXTURE_2D, unit) for unit in (0, 1)]
    parameters = [found.parameters for found in bound]
    return values, gl.current.values(), parameters, gl.arrays.values()[1:]


def call(name, *arguments):
    """A strategy of a call: each argument is a strategy, or one value."""
    drawn = [each if isinstance(each, st.SearchStrategy) else st.just(each) for each in arguments]
    return st.tuples(st.just(name), st.tuples(*drawn))


def one_of(*values):
    return st.sampled_from(values)


CAPABILITIES = one_of(
    *(t.LIGHTING, t.COLOR_MATERIAL, t.FOG, t.BLEND, t.TEXTURE_2D, t.TEXTURE_GEN_S, t.LIGHT0, t.CLIP_PLANE0),
    *(t.NORMALIZE, t.DITHER, t.MAP1_VERTEX_3, t.POINT_SMOOTH, t.REGISTER_COMBINERS_NV, t.CONVOLUTION_2D),
)
_unit = st.floats(0.0, 1.0, width=32)
_color = st.lists(_unit, min_size=4, max_size=4)
_calls = st.one_of(
    call("Enable", CAPABILITIES),
    call("Disable", CAPABILITIES),
    call("Color4fv", _color),
    call("Materialfv", one_of(t.FRONT, t.FRONT_AND_BACK), one_of(t.AMBIENT, t.DIFFUSE, t.SPECULAR), _color),
    call("ColorMaterial", one_of(t.FRONT, t.BACK), one_of(t.DIFFUSE, t.SPECULAR)),
    call("Lightfv", t.LIGHT0, t.POSITION, _color),
    call("Fogf", t.FOG_DENSITY, _unit),
    call("ActiveTexture", one_of(t.TEXTURE0, t.TEXTURE1)),
    call("BindTexture", t.TEXTURE_2D, st.integers(0, 2)),
    call("TexParameteri", t.TEXTURE_2D, t.TEXTURE_WRAP_S, one_of(t.CLAMP, t.REPEAT)),
    call("TexEnvi", t.TEXTURE_ENV, t.TEXTURE_ENV_MODE, one_of(t.DECAL, t.REPLACE)),
    call("PixelTransferf", t.RED_SCALE, _unit),
    call("PointSize", st.floats(0.5, 9.0)),
    call("Hint", t.FOG_HINT, one_of(t.NICEST, t.FASTEST)),
    call("ListBase", st.integers(0, 9)),
    call("Viewport", 0, 0, st.integers(0, 64), st.integers(0, 64)),
    call("CombinerParameteriNV", t.NUM_GENERAL_COMBINERS_NV, st.integers(1, 8)),
)


def make(gl, calls):
    for name, arguments in calls:
        gl.call("gl" + name, arguments)


@settings(max_examples=150)
@given(st.lists(_calls, max_size=8), st.lists(_calls, max_size=12))
def test_push_and_pop_of_all_groups_change_nothing(before, between):
    gl, plain = context(), context()
    for each in (gl, plain):
        for name in (1, 2):
            each.BindTexture(t.TEXTURE_2D, name)
        make(each, before)
    gl.PushAttrib(t.ALL_ATTRIB_BITS)
    make(gl, between)
    gl.PopAttrib()
    assert whole_state(gl) == whole_state(plain)
    assert gl.state() == plain.state()
    assert gl.tally.count("error") == gl.tally.count("refused") == 0


@settings(max_examples=50)
@given(
    st.lists(_calls, max_size=8), st.sampled_from([t.LIGHTING_BIT, t.FOG_BIT, t.TEXTURE_BIT, t.ENABLE_BIT])
)
def test_other_groups_keep_what_was_changed(between, group):
    gl, plain = context(), context()
    gl.PushAttrib(group)
    for each in (gl, plain):
        make(each, between)
    gl.PopAttrib()
    found, expected = whole_state(gl)[0], whole_state(plain)[0]
    for key, value in expected.items():
        if not VALUES[key].groups & group:
            assert found[key] == value


def test_a_group_has_what_the_tables_say():
    gl = context()
    gl.PushAttrib(t.ENABLE_BIT)
    gl.Enable(t.LIGHTING)
    gl.Fogf(t.FOG_DENSITY, 0.5)
    gl.Enable(t.TEXTURE_2D)
    gl.PopAttrib()
    assert (gl.IsEnabled(t.LIGHTING), gl.IsEnabled(t.TEXTURE_2D)) == (False, False)
    assert gl.GetFloatv(t.FOG_DENSITY) == 0.5
    gl.PushAttrib(t.CURRENT_BIT | t.TRANSFORM_BIT)
    gl.Color3f(1.0, 0.0, 0.0)
    gl.MatrixMode(t.TEXTURE)
    gl.PopAttrib()
    assert gl.GetFloatv(t.CURRENT_COLOR) == (1.0, 1.0, 1.0, 1.0)
    assert gl.GetIntegerv(t.MATRIX_MODE) == t.MODELVIEW


def test_texture_parameters_come_back_to_their_object():
    gl = context()
    gl.BindTexture(t.TEXTURE_2D, 1)
    gl.PushAttrib(t.TEXTURE_BIT)
    gl.TexParameteri(t.TEXTURE_2D, t.TEXTURE_WRAP_S, t.CLAMP)
    gl.BindTexture(t.TEXTURE_2D, 2)
    gl.TexParameteri(t.TEXTURE_2D, t.TEXTURE_WRAP_S, t.CLAMP)
    gl.PopAttrib()
    assert gl.GetIntegerv(t.TEXTURE_BINDING_2D) == 1
    assert gl.GetTexParameteriv(t.TEXTURE_2D, t.TEXTURE_WRAP_S) == t.REPEAT
    gl.BindTexture(t.TEXTURE_2D, 2)
    assert gl.GetTexParameteriv(t.TEXTURE_2D, t.TEXTURE_WRAP_S) == t.CLAMP


@pytest.mark.parametrize(
    ("push", "pop"), [("PushAttrib", "PopAttrib"), ("PushClientAttrib", "PopClientAttrib")]
)
def test_stacks_overflow_and_underflow(push, pop):
    gl = context()
    gl.call("gl" + pop)
    assert gl.GetError() == t.STACK_UNDERFLOW
    for _ in range(STACK_DEPTH):
        gl.call("gl" + push, (0xFFFFFFFF,))
    assert gl.GetError() == t.NO_ERROR
    gl.call("gl" + push, (0xFFFFFFFF,))
    assert gl.GetError() == t.STACK_OVERFLOW
    depth = t.ATTRIB_STACK_DEPTH if push == "PushAttrib" else t.CLIENT_ATTRIB_STACK_DEPTH
    assert gl.GetIntegerv(depth) == STACK_DEPTH


def test_client_groups_are_pixel_store_and_arrays():
    gl = context()
    gl.PushClientAttrib(t.CLIENT_PIXEL_STORE_BIT)
    gl.PixelStorei(t.UNPACK_ALIGNMENT, 1)
    gl.EnableClientState(t.VERTEX_ARRAY)
    gl.PopClientAttrib()
    assert gl.GetIntegerv(t.UNPACK_ALIGNMENT) == 4
    assert gl.IsEnabled(t.VERTEX_ARRAY)
    gl.PushClientAttrib(t.CLIENT_VERTEX_ARRAY_BIT)
    gl.BindBuffer(t.ARRAY_BUFFER, 3)
    gl.ClientActiveTexture(t.TEXTURE1)
    gl.DisableClientState(t.VERTEX_ARRAY)
    gl.PixelStorei(t.PACK_ALIGNMENT, 2)
    gl.PopClientAttrib()
    assert gl.IsEnabled(t.VERTEX_ARRAY)
    assert gl.GetIntegerv(t.CLIENT_ACTIVE_TEXTURE) == t.TEXTURE0
    assert (gl.GetIntegerv(t.ARRAY_BUFFER_BINDING), gl.GetIntegerv(t.PACK_ALIGNMENT)) == (0, 2)


def test_a_colour_that_follows_the_current_one_stays_when_pop_ends_that():
    gl = context()
    gl.ColorMaterial(t.FRONT, t.DIFFUSE)
    gl.PushAttrib(t.ENABLE_BIT)
    gl.Enable(t.COLOR_MATERIAL)
    gl.Color3f(1.0, 0.0, 0.0)
    gl.PopAttrib()
    gl.Color3f(0.0, 1.0, 0.0)
    assert gl.GetMaterialfv(t.FRONT, t.DIFFUSE) == (1.0, 0.0, 0.0, 1.0)


def test_a_colour_follows_again_after_pop():
    gl = context()
    gl.ColorMaterial(t.FRONT, t.DIFFUSE)
    gl.Enable(t.COLOR_MATERIAL)
    gl.Color3f(1.0, 0.0, 0.0)
    gl.PushAttrib(t.LIGHTING_BIT)
    gl.Disable(t.COLOR_MATERIAL)
    gl.Color3f(0.0, 1.0, 0.0)
    assert gl.GetMaterialfv(t.FRONT, t.DIFFUSE) == (1.0, 0.0, 0.0, 1.0)
    gl.PopAttrib()
    assert gl.GetMaterialfv(t.FRONT, t.DIFFUSE) == (0.0, 1.0, 0.0, 1.0)
