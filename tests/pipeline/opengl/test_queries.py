"""Queries answer what calls before them set, in the type that is asked for; traces' own answers agree."""

import math

import numpy as np
import pytest

from fixedpipe.pipeline.opengl import tokens as t
from fixedpipe.pipeline.opengl.extensions import extensions
from fixedpipe.pipeline.opengl.queries import agrees, answer, is_computed
from fixedpipe.pipeline.opengl.state_variables import LIMITS, STATE
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.traces.calls import Trace
from tests.pipeline.opengl.drawn import context, refusals


@pytest.mark.parametrize("profile", ["GEFORCE_256", "GEFORCE_3", "OPENGL_1_2", "IDEAL"])
def test_every_state_variable_has_an_answer_in_every_type(profile):
    gl = context(profile)
    for name in (*STATE, *LIMITS):
        for kind in ("Booleanv", "Integerv", "Floatv", "Doublev"):
            found = gl.call(f"glGet{kind}", (name,))
            assert found is not None, t.name_of(name)
    assert refusals(gl) == []


def test_initial_values():
    """Some of tables 6.5 to 6.28."""
    gl = context(width=40, height=30)
    identity = tuple(np.eye(4).reshape(-1))
    expected = {
        t.CURRENT_COLOR: (1.0, 1.0, 1.0, 1.0),
        t.CURRENT_NORMAL: (0.0, 0.0, 1.0),
        t.MODELVIEW_MATRIX: identity,
        t.VIEWPORT: (0, 0, 40, 30),
        t.SCISSOR_BOX: (0, 0, 40, 30),
        t.DEPTH_RANGE: (0, 1),
        t.MODELVIEW_STACK_DEPTH: 1,
        t.FOG_MODE: t.EXP,
        t.POLYGON_MODE: (t.FILL, t.FILL),
        t.LINE_STIPPLE_PATTERN: 0xFFFF,
        t.STENCIL_WRITEMASK: 2**32 - 1,
        t.UNPACK_ALIGNMENT: 4,
        t.RED_SCALE: 1,
        t.PIXEL_MAP_R_TO_R_SIZE: 1,
        t.MAP2_GRID_SEGMENTS: (1, 1),
        t.MAP2_GRID_DOMAIN: (0, 1, 0, 1),
        t.RENDER_MODE: t.RENDER,
        t.DITHER: True,
        t.TEXTURE_BINDING_2D: 0,
        t.MAX_LIGHTS: 8,
    }
    for name, value in expected.items():
        assert gl.GetDoublev(name) == value, t.name_of(name)


def test_a_matrix_is_given_by_columns_and_transposed_by_rows():
    gl = context()
    gl.Translatef(1.0, 2.0, 3.0)
    gl.PushMatrix()
    assert gl.GetFloatv(t.MODELVIEW_MATRIX)[12:] == (1.0, 2.0, 3.0, 1.0)
    assert gl.GetFloatv(t.TRANSPOSE_MODELVIEW_MATRIX)[3::4] == (1.0, 2.0, 3.0, 1.0)
    assert gl.GetIntegerv(t.MODELVIEW_STACK_DEPTH) == 2


@pytest.mark.parametrize(
    ("value", "integer"), [(0.0, 0), (1.0, 2**31 - 1), (-1.0, -(2**31)), (0.5, 2**30 - 1), (7.0, 2**31 - 1)]
)
def test_colours_as_integers_are_fractions_of_the_largest(value, integer):
    """Table 4.7: c = ((2^32 - 1) f - 1) / 2."""
    gl = context()
    gl.Color4f(value, value, value, value)
    assert abs(gl.GetIntegerv(t.CURRENT_COLOR)[0] - integer) <= 1
    assert gl.GetBooleanv(t.CURRENT_COLOR)[0] is (value != 0)


def test_other_numbers_as_integers_are_rounded():
    gl = context()
    gl.LineWidth(2.5)
    gl.Fogf(t.FOG_END, -1.75)
    gl.DepthRange(0.25, 1.0)
    assert gl.GetIntegerv(t.LINE_WIDTH) == 3
    assert gl.GetIntegerv(t.FOG_END) == -2
    assert gl.GetIntegerv(t.DEPTH_RANGE)[1] == 2**31 - 1
    assert gl.GetFloatv(t.CULL_FACE) == 0.0
    assert gl.GetIntegerv(t.CULL_FACE_MODE) == t.BACK
    assert gl.GetBooleanv(t.LINE_WIDTH) is True


def test_lights_and_materials():
    gl = context()
    gl.Translatef(0.0, 0.0, -2.0)
    gl.Lightfv(t.LIGHT1, t.POSITION, [1.0, 2.0, 3.0, 1.0])
    assert gl.GetLightfv(t.LIGHT1, t.POSITION) == (1.0, 2.0, 1.0, 1.0)
    assert gl.GetLightiv(t.LIGHT1, t.POSITION) == (1, 2, 1, 1)
    assert gl.GetLightiv(t.LIGHT0, t.DIFFUSE) == (2**31 - 1,) * 4
    assert gl.GetLightfv(t.LIGHT0, t.SPOT_CUTOFF) == 180.0
    gl.Materialf(t.BACK, t.SHININESS, 12.0)
    assert gl.GetMaterialfv(t.BACK, t.SHININESS) == 12.0
    assert gl.GetMaterialfv(t.FRONT, t.AMBIENT) == (0.2, 0.2, 0.2, 1.0)
    assert gl.GetMaterialfv(t.FRONT_AND_BACK, t.AMBIENT) is None
    assert gl.GetError() == t.INVALID_ENUM


def test_the_active_unit_s_variables():
    gl = context()
    gl.ActiveTexture(t.TEXTURE1)
    gl.Enable(t.TEXTURE_2D)
    gl.BindTexture(t.TEXTURE_2D, 5)
    gl.MultiTexCoord2f(t.TEXTURE1, 0.5, 0.25)
    gl.MatrixMode(t.TEXTURE)
    gl.Scalef(2.0, 1.0, 1.0)
    gl.TexGeni(t.S, t.TEXTURE_GEN_MODE, t.SPHERE_MAP)
    gl.TexEnvfv(t.TEXTURE_ENV, t.TEXTURE_ENV_COLOR, [0.0, 0.5, 1.0, 1.0])
    assert gl.GetBooleanv(t.TEXTURE_2D) is True
    assert gl.GetIntegerv(t.TEXTURE_BINDING_2D) == 5
    assert gl.GetFloatv(t.CURRENT_TEXTURE_COORDS) == (0.5, 0.25, 0.0, 1.0)
    assert gl.GetFloatv(t.TEXTURE_MATRIX)[0] == 2.0
    assert gl.GetTexGeniv(t.S, t.TEXTURE_GEN_MODE) == t.SPHERE_MAP
    assert gl.GetTexGendv(t.T, t.OBJECT_PLANE) == (0.0, 1.0, 0.0, 0.0)
    assert gl.GetTexEnvfv(t.TEXTURE_ENV, t.TEXTURE_ENV_COLOR) == (0.0, 0.5, 1.0, 1.0)
    assert gl.GetTexEnviv(t.TEXTURE_ENV, t.TEXTURE_ENV_COLOR)[0] == 0
    gl.ActiveTexture(t.TEXTURE0)
    assert gl.GetBooleanv(t.TEXTURE_2D) is False
    assert gl.GetIntegerv(t.TEXTURE_BINDING_2D) == 0
    assert gl.GetFloatv(t.TEXTURE_MATRIX)[0] == 1.0


def test_textures_levels_and_maps():
    gl = context()
    gl.TexImage2D(t.TEXTURE_2D, 0, t.RGB5, 4, 2, 0, t.RGB, t.UNSIGNED_BYTE, bytes(24))
    level = (t.TEXTURE_2D, 0)
    assert gl.GetTexLevelParameteriv(*level, t.TEXTURE_WIDTH) == 4
    assert gl.GetTexLevelParameterfv(*level, t.TEXTURE_HEIGHT) == 2.0
    assert gl.GetTexLevelParameteriv(*level, t.TEXTURE_INTERNAL_FORMAT) == t.RGB5
    assert gl.GetTexLevelParameteriv(*level, t.TEXTURE_GREEN_SIZE) == 5
    gl.TexParameterfv(t.TEXTURE_2D, t.TEXTURE_BORDER_COLOR, [1.0, 0.0, 0.0, 0.0])
    assert gl.GetTexParameteriv(t.TEXTURE_2D, t.TEXTURE_BORDER_COLOR) == (2**31 - 1, 0, 0, 0)
    gl.PixelMapfv(t.PIXEL_MAP_R_TO_R, 2, [0.0, 1.0])
    assert gl.GetPixelMapfv(t.PIXEL_MAP_R_TO_R) == (0.0, 1.0)
    assert gl.GetPixelMapusv(t.PIXEL_MAP_R_TO_R) == (0, 65535)
    gl.Map1f(t.MAP1_VERTEX_3, 0.0, 2.0, 3, 2, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert gl.GetMapfv(t.MAP1_VERTEX_3, t.COEFF) == (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    assert gl.GetMapiv(t.MAP1_VERTEX_3, t.ORDER) == 2
    assert gl.GetMapdv(t.MAP1_VERTEX_3, t.DOMAIN) == (0.0, 2.0)
    assert gl.GetMapiv(t.MAP2_VERTEX_4, t.ORDER) == (1, 1)
    assert gl.GetConvolutionParameteriv(t.CONVOLUTION_2D, t.CONVOLUTION_BORDER_MODE) == t.REDUCE
    assert gl.GetColorTableParameteriv(t.COLOR_TABLE, t.COLOR_TABLE_WIDTH) == 0
    assert gl.GetHistogramParameteriv(t.HISTOGRAM, t.HISTOGRAM_WIDTH) == 0
    assert refusals(gl) == []


def test_a_stipple_is_read_by_pixel_store_and_given_back():
    gl = context()
    rows = np.random.default_rng(7).integers(0, 256, (32, 4), np.uint8)
    gl.PolygonStipple(rows.tobytes())
    gl.Enable(t.POLYGON_STIPPLE)
    assert gl.state().polygon.stipple == rows.tobytes() == gl.GetPolygonStipple()
    gl.PixelStorei(t.UNPACK_LSB_FIRST, 1)
    gl.PixelStorei(t.UNPACK_ROW_LENGTH, 64)
    gl.PixelStorei(t.UNPACK_SKIP_ROWS, 1)
    wide = np.zeros((33, 8), np.uint8)
    wide[1:, :4] = np.packbits(np.unpackbits(rows, axis=1), axis=1, bitorder="little")
    gl.PolygonStipple(wide.reshape(-1).tolist())
    assert gl.GetPolygonStipple() == rows.tobytes()


def test_arrays():
    gl = context()
    gl.BindBuffer(t.ARRAY_BUFFER, 4)
    gl.BufferData(t.ARRAY_BUFFER, 64, bytes(64), t.STATIC_DRAW)
    gl.VertexPointer(3, t.FLOAT, 24, 8)
    gl.BindBuffer(t.ARRAY_BUFFER, 0)
    gl.ClientActiveTexture(t.TEXTURE1)
    data = bytes(16)
    gl.TexCoordPointer(2, t.SHORT, 0, data)
    names = (t.VERTEX_ARRAY_SIZE, t.VERTEX_ARRAY_TYPE, t.VERTEX_ARRAY_STRIDE, t.VERTEX_ARRAY_BUFFER_BINDING)
    assert [gl.GetIntegerv(name) for name in names] == [3, t.FLOAT, 24, 4]
    assert gl.GetIntegerv(t.TEXTURE_COORD_ARRAY_SIZE) == 2
    assert gl.GetPointerv(t.VERTEX_ARRAY_POINTER) == 8
    assert gl.GetPointerv(t.TEXTURE_COORD_ARRAY_POINTER) is data
    assert gl.GetIntegerv(t.COLOR_ARRAY_BUFFER_BINDING) == 0
    assert gl.GetPointerv(t.FEEDBACK_BUFFER_POINTER) is None
    gl.EnableClientState(t.TEXTURE_COORD_ARRAY)
    assert gl.GetBooleanv(t.TEXTURE_COORD_ARRAY)
    gl.ClientActiveTexture(t.TEXTURE0)
    assert not gl.GetBooleanv(t.TEXTURE_COORD_ARRAY)


def test_errors_are_told_once():
    gl = context()
    gl.GetIntegerv(0x7FFF)
    gl.LineWidth(-1.0)
    assert (gl.GetError(), gl.GetError()) == (t.INVALID_ENUM, t.NO_ERROR)


def test_strings_name_the_machine_and_its_extensions():
    gl = context("GEFORCE_3")
    assert gl.GetString(t.RENDERER) == "GeForce 3"
    listed = gl.GetString(t.EXTENSIONS).split()
    assert {"GL_NV_texture_shader", "GL_NV_register_combiners2", "GL_EXT_point_parameters"} <= set(listed)
    assert gl.GetStringi(t.EXTENSIONS, 0) == listed[0] == "GL_ARB_depth_texture"
    assert "GL_NV_texture_shader" not in extensions(PROFILES["GEFORCE_256"])
    assert "GL_NV_register_combiners" in extensions(PROFILES["GEFORCE_256"])
    assert not [name for name in extensions(PROFILES["OPENGL_1_2"]) if "_NV_" in name]
    assert "GL_ARB_imaging" in extensions(PROFILES["OPENGL_1_2_IMAGING"])


def test_the_raster_position():
    gl = context(width=40, height=30)
    assert gl.GetFloatv(t.CURRENT_RASTER_POSITION) == (0.0, 0.0, 0.0, 1.0)
    assert gl.GetBooleanv(t.CURRENT_RASTER_POSITION_VALID)
    gl.Ortho(0.0, 40.0, 0.0, 30.0, -1.0, 1.0)
    gl.DepthRange(0.5, 1.0)
    gl.Color3f(0.25, 0.5, 2.0)
    gl.RasterPos3f(10.0, 20.0, 0.5)
    assert gl.GetFloatv(t.CURRENT_RASTER_POSITION) == pytest.approx((10.0, 20.0, 0.625, 1.0))
    assert gl.GetBooleanv(t.CURRENT_RASTER_POSITION_VALID)
    assert gl.GetFloatv(t.CURRENT_RASTER_COLOR) == (0.25, 0.5, 1.0, 1.0)
    gl.LoadIdentity()  # it was transformed already
    gl.Bitmap(0, 0, 0.0, 0.0, 2.0, -3.0, None)
    assert gl.GetFloatv(t.CURRENT_RASTER_POSITION)[:2] == pytest.approx((12.0, 17.0))
    for x in (1.5, -1.5):
        gl.RasterPos2f(x, 0.0)
        assert not gl.GetBooleanv(t.CURRENT_RASTER_POSITION_VALID)
    gl.WindowPos3f(3.0, 4.0, 0.5)
    assert gl.GetFloatv(t.CURRENT_RASTER_POSITION) == (3.0, 4.0, 0.75, 1.0)
    gl.Enable(t.LIGHTING)
    gl.Enable(t.LIGHT0)
    gl.Materialfv(t.FRONT, t.DIFFUSE, [0.5, 0.5, 0.5, 0.25])
    gl.RasterPos2f(0.5, 0.0)
    # Ambient 0.2 * 0.2 of the scene; the light shines along the normal.
    assert gl.GetFloatv(t.CURRENT_RASTER_COLOR) == pytest.approx((0.54, 0.54, 0.54, 0.25), abs=2.0**-14)
    assert gl.GetFloatv(t.CURRENT_RASTER_DISTANCE) == pytest.approx(0.5)


# ------------------------------------------------------------------------------------------------- --check


def test_an_answer_changes_nothing_and_leaves_limits_out():
    gl = context()
    gl.LineWidth(3.0)
    gl.LineWidth(-1.0)
    assert answer(gl, "glGetFloatv", [t.LINE_WIDTH, [1.0]]) == (3.0,)
    assert answer(gl, "glGetFloatv", [t.MODELVIEW_MATRIX, [0.0] * 16])[:2] == (1.0, 0.0)
    assert answer(gl, "glIsEnabled", [t.DITHER]) == (True,)
    for name, arguments in (
        ("glGetIntegerv", [t.MAX_TEXTURE_SIZE, [1]]),
        ("glGetIntegerv", [0x7FFF, [1]]),
        ("glGetError", []),
        ("glGetString", [t.VERSION]),
        ("glEnable", [t.FOG]),
        ("glNothing", []),
        ("glGetTexLevelParameteriv", [t.TEXTURE_2D, 0, t.TEXTURE_RED_SIZE, [8]]),
    ):
        assert answer(gl, name, arguments) is None
    gl.Begin(t.POINTS)
    assert answer(gl, "glGetFloatv", [t.LINE_WIDTH, [1.0]]) is None
    gl.End()
    assert gl.GetError() == t.INVALID_VALUE


def test_answers_agree_by_what_they_are():
    assert agrees((1.0, 2.0), [1.0, 2.00001], computed=True)
    assert not agrees((1.0, 2.0), [1.0, 2.001], computed=True)
    assert not agrees((1.0, 2.0), [1.0, 2.00001])  # a number that the program gave
    assert agrees((0.1, 0.7), [float(np.float32(0.1)), float(np.float32(0.7))])
    assert not agrees((1.0, 2.0), [1.0])
    assert agrees((3,), [3, 0, 0, 0])
    assert agrees((0xFFFFFFFF,), [-1])
    assert agrees((True,), 1)
    assert not agrees((False,), 1)
    assert not agrees((math.nan,), [1.0])
    # Whole numbers are equal, however large they are, also where they are asked for as floats.
    assert not agrees((9000000.0,), [9000001.0])
    assert not agrees((0x8452,), [0x8451]) and not agrees((429496729,), [429496735])


def test_a_fraction_as_an_integer_agrees_within_single_precision():
    gl = context()
    gl.ClearColor(0.2, 0.2, 0.2, 0.0)
    found = answer(gl, "glGetIntegerv", [t.COLOR_CLEAR_VALUE, None])
    assert agrees(found, [429496735, 429496729, 429496729, 0])  # 0.2 in single and in double precision
    assert not agrees(found, [429496929, 429496729, 429496729, 0])


@pytest.mark.parametrize(
    ("name", "arguments", "computed"),
    [
        ("glGetFloatv", [t.MODELVIEW_MATRIX], True),
        ("glGetLightfv", [t.LIGHT0, t.POSITION], True),
        ("glGetClipPlane", [t.CLIP_PLANE0], True),
        ("glGetFloatv", [t.FOG_DENSITY], False),
        ("glGetLightfv", [t.LIGHT0, t.DIFFUSE], False),
    ],
)
def test_what_opengl_computes(name, arguments, computed):
    assert is_computed(name, arguments) == computed


@pytest.mark.needs_shared
def test_the_answers_that_traces_recorded(shared):
    """Every answer of the visible traces that depends on state alone, but for READ_BUFFER."""
    compared = 0
    for path in sorted((shared / "replay" / "traces").rglob("*.trace")):
        if path.stat().st_size > 1 << 17:
            continue
        gl = context("GEFORCE_3", 640, 480)
        with Trace(path) as trace:
            for call in trace:
                gl.tally.call = call.number
                found = answer(gl, call.name, call.arguments)
                gl.call(call.name, call.arguments, call.result)
                gl.commands.clear()
                if found is not None and call.arguments[0] != t.READ_BUFFER:
                    recorded = call.arguments[-1] if call.name.startswith("glGet") else call.result
                    assert agrees(found, recorded, is_computed(call.name, call.arguments)), (
                        path.name,
                        call,
                        found,
                    )
                    compared += 1
    assert compared >= 100
