"""Fog's and points' calls become the parts of a state that they describe."""

import math

import pytest

from fixedpipe.pipeline.enums import FogCoordinateSource, FogGeneration, FogMode, Register
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import tokens as t
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import Fog, PointParameters, PointState
from fixedpipe.pipeline.vertices import fog as machine_s_fog
from tests.pipeline.opengl.drawn import context, counted

COLOR = (0.25, 0.5, 0.75, 1.0)


def test_fog():
    gl = context()
    assert gl.state().fog is None
    gl.Enable(t.FOG)
    assert gl.state().fog == Fog()
    gl.Fogi(t.FOG_MODE, t.LINEAR)
    gl.Fogf(t.FOG_START, 2.0)
    gl.Fogiv(t.FOG_END, [9])
    gl.Fogf(t.FOG_DENSITY, 0.5)
    gl.Fogfv(t.FOG_COLOR, [0.25, 0.5, 1.75, -1.0])
    gl.Fogi(t.FOG_COORDINATE_SOURCE, t.FOG_COORDINATE)
    source = FogCoordinateSource.FOG_COORDINATE
    assert gl.state().fog == Fog(FogMode.LINEAR, 0.5, 2.0, 9.0, (0.25, 0.5, 1.0, 0.0), source)


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (lambda gl: gl.Fogf(t.FOG_DENSITY, -1.0), t.INVALID_VALUE),
        (lambda gl: gl.Fogi(t.FOG_MODE, t.NEAREST), t.INVALID_ENUM),
        (lambda gl: gl.Fogf(t.FOG_COLOR, 1.0), t.INVALID_ENUM),
        (lambda gl: gl.Fogf(t.LINEAR, 1.0), t.INVALID_ENUM),
        (lambda gl: gl.PointSize(0.0), t.INVALID_VALUE),
        (lambda gl: gl.PointSize(math.nan), t.INVALID_VALUE),
        (lambda gl: gl.PointParameterf(t.POINT_SIZE_MIN, -1.0), t.INVALID_VALUE),
        (lambda gl: gl.PointParameterf(t.POINT_DISTANCE_ATTENUATION, 1.0), t.INVALID_ENUM),
    ],
)
def test_errors_leave_the_state(call, kind):
    gl = context()
    before = dict(gl.values._of)
    call(gl)
    assert gl.GetError() == kind
    assert gl.values._of == before


@pytest.mark.parametrize(
    ("distance", "generation"),
    [(t.EYE_RADIAL_NV, FogGeneration.RADIAL), (t.EYE_PLANE, FogGeneration.PLANAR)],
)
@pytest.mark.parametrize("mode", [t.LINEAR, t.EXP, t.EXP2])
def test_a_fog_distance_is_a_register_with_the_line_of_the_same_fog_without(mode, distance, generation):
    gl = context("GEFORCE_3")
    gl.Enable(t.FOG)
    gl.Fogi(t.FOG_MODE, mode)
    gl.Fogf(t.FOG_DENSITY, 0.125)
    gl.Fogf(t.FOG_END, 3.5)
    plain = gl.state().fog
    gl.Fogi(t.FOG_DISTANCE_MODE_NV, distance)
    fog = gl.state().fog
    assert fog.registers.generation is generation
    assert machine_s_fog.line(fog) == machine_s_fog.line(plain)
    gl.Fogi(t.FOG_DISTANCE_MODE_NV, t.EYE_PLANE_ABSOLUTE_NV)
    assert gl.state().fog == plain


def test_a_fog_distance_that_the_machine_lacks_is_counted():
    gl = context("GEFORCE_256")
    gl.Enable(t.FOG)
    gl.Fogi(t.FOG_DISTANCE_MODE_NV, t.EYE_RADIAL_NV)
    assert gl.state().fog == Fog()
    sentence = "FOG_DISTANCE_MODE_NV: GeForce 256's fog has the distance |z| alone"
    assert counted(gl, "no effect") == [(sentence, 1)]


def test_combiners_read_the_colour_of_disabled_fog_with_a_factor_of_one():
    gl = context("GEFORCE_256", 8, 8)
    gl.Fogfv(t.FOG_COLOR, COLOR)
    gl.Enable(t.REGISTER_COMBINERS_NV)
    assert gl.state().fog is None  # the initial final combiner blends it in with a weight of zero
    gl.FinalCombinerInputNV(t.VARIABLE_A_NV, t.ZERO, t.UNSIGNED_IDENTITY_NV, t.RGB)
    gl.FinalCombinerInputNV(t.VARIABLE_C_NV, t.FOG, t.UNSIGNED_IDENTITY_NV, t.RGB)
    assert gl.state().fog == Fog(FogMode.EXP, density=0.0, color=COLOR)
    assert gl.state().register_combiners.final.c.register is Register.FOG
    _square(gl)
    image = Machine(PROFILES["GEFORCE_256"], 8, 8).run(gl.take_commands()).image()
    assert image[4, 4, :3].tolist() == [64, 128, 191]


def _square(gl):
    gl.Begin(t.QUADS)
    for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        gl.Vertex2f(x, y)
    gl.End()


# ------------------------------------------------------------------------------------------------ points


@pytest.mark.parametrize(
    ("asked", "drawn"), [(0.2, 1.0), (1.4, 1.0), (1.5, 2.0), (7.0, 7.0), (500.0, 63.875)]
)
def test_the_size_of_a_point_is_rounded_and_clamped(asked, drawn):
    gl = context("GEFORCE_3")
    gl.PointSize(asked)
    assert gl.state().point == PointState(drawn)
    assert gl.GetFloatv(t.POINT_SIZE) == asked


def test_smooth_points_are_drawn_without_and_counted_once():
    gl = context("GEFORCE_3", 8, 8)
    gl.Enable(t.POINT_SMOOTH)
    for _ in range(3):
        gl.Begin(t.POINTS)
        gl.Vertex2f(0.0, 0.0)
        gl.End()
    assert counted(gl, "no effect") == [("POINT_SMOOTH: GeForce 3 has no smooth points; they are squares", 1)]
    assert Machine(PROFILES["GEFORCE_3"], 8, 8).run(gl.take_commands()).fragments == 3


def size_at(parameters, distance):
    """A point's size by PointParameters' own formula."""
    a, b, c = parameters.attenuation
    root = 1.0 / math.sqrt(a + b * distance + c * distance**2)
    return min(max(root + parameters.bias, 0.0), 1.0) * parameters.range + parameters.minimum


@pytest.mark.parametrize("distance", [0.5, 1.0, 3.0, 20.0, 400.0])
def test_point_parameters_give_the_extension_s_sizes(distance):
    gl = context("GEFORCE_3")
    gl.PointSize(20.0)
    gl.PointParameterfEXT(t.POINT_SIZE_MIN, 2.0)
    gl.PointParameterfEXT(t.POINT_SIZE_MAX, 30.0)
    gl.PointParameterfvEXT(t.DISTANCE_ATTENUATION_EXT, [0.5, 0.25, 0.125])
    parameters = gl.state().point.parameters
    derived = 20.0 * math.sqrt(1.0 / (0.5 + 0.25 * distance + 0.125 * distance**2))
    assert size_at(parameters, distance) == pytest.approx(min(max(derived, 2.0), 30.0), abs=1e-12)


def test_point_parameters_of_points_of_one_size():
    gl = context("GEFORCE_3")
    gl.PointSize(20.0)
    gl.PointParameterf(t.POINT_SIZE_MAX, 8.0)
    assert gl.state().point == PointState(8.0)
    gl.PointParameterfv(t.POINT_DISTANCE_ATTENUATION, [0.0, 1.0, 0.0])
    gl.PointParameterf(t.POINT_SIZE_MIN, 8.0)
    assert gl.state().point == PointState(8.0)


def test_the_greatest_size_is_the_machine_s_at_most():
    gl = context("GEFORCE_3")
    gl.PointParameterf(t.POINT_SIZE_MAX, 1000.0)
    gl.PointParameterfv(t.POINT_DISTANCE_ATTENUATION, [0.0, 1.0, 0.0])
    assert gl.state().point.parameters == PointParameters((0.0, 63.875**2, 0.0), -0.0, 63.875, 0.0)


def test_what_a_machine_lacks_of_points_is_drawn_without():
    gl = context("GEFORCE_256", 8, 8)
    gl.PointSize(2.0)
    gl.PointParameterfv(t.POINT_DISTANCE_ATTENUATION, [0.0, 1.0, 0.0])
    gl.Enable(t.POINT_SPRITE_ARB)
    gl.Begin(t.POINTS)
    gl.Vertex2f(0.0, 0.0)
    gl.End()
    assert gl.state().point == PointState(2.0)
    assert sorted(counted(gl, "no effect")) == [
        ("POINT_DISTANCE_ATTENUATION: GeForce 256's points have one size at any distance", 1),
        ("POINT_SPRITE: GeForce 256 has no point sprites; they are squares", 1),
    ]
    assert Machine(PROFILES["GEFORCE_256"], 8, 8).run(gl.take_commands()).fragments == 4
