"""Lights, materials and clip planes become the vertex stage that their calls describe."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.enums import ColorMaterialParameter, Face, SecondaryColor
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import tokens as t
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import ColorMaterial, Light, Lighting, Material, VertexState, Viewport
from tests.pipeline.opengl.drawn import context, counted

RED, GREEN = (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0)
BLACK, WHITE = (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)


def lighting(gl):
    return gl.state().vertex.lighting


def draw_triangle(gl):
    gl.Begin(t.TRIANGLES)
    for x, y in ((-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)):
        gl.Vertex2f(x, y)
    gl.End()


def test_the_initial_state_is_the_initial_vertex_state():
    gl = context(width=64, height=48)
    assert gl.state().vertex == VertexState(viewport=Viewport(0, 0, 64, 48))
    gl.Enable(t.LIGHTING)
    assert lighting(gl) == Lighting()
    gl.Enable(t.LIGHT0)
    gl.Enable(t.LIGHT2)
    assert lighting(gl).lights == (Light(), Light(diffuse=BLACK, specular=BLACK))


def test_every_parameter_of_a_light():
    gl = context("GEFORCE_256")
    gl.Translatef(1.0, 2.0, 3.0)
    gl.Scalef(2.0, 2.0, 2.0)
    light = t.LIGHT0 + 3
    gl.Lightfv(light, t.AMBIENT, [0.1, 0.2, 0.3, 0.4])
    gl.Lightfv(light, t.DIFFUSE, np.array([0.5, 0.6, 0.7, 0.8]))
    gl.Lightiv(light, t.SPECULAR, [2**31 - 1, 0, -(2**31), 2**31 - 1])
    gl.Lightfv(light, t.POSITION, [1.0, 1.0, 1.0, 1.0])
    gl.Lightiv(light, t.SPOT_DIRECTION, [0, 0, -1])
    gl.Lightf(light, t.SPOT_EXPONENT, 2.5)
    gl.Lighti(light, t.SPOT_CUTOFF, 30)
    gl.Lightfv(light, t.CONSTANT_ATTENUATION, [2.0])
    gl.Lightf(light, t.LINEAR_ATTENUATION, 0.25)
    gl.Lightf(light, t.QUADRATIC_ATTENUATION, 0.125)
    gl.Enable(t.LIGHTING)
    gl.Enable(light)
    (found,) = lighting(gl).lights
    assert found.specular == pytest.approx((1.0, 1 / (2**32 - 1), -1.0, 1.0), abs=1e-15)
    assert replace(found, specular=WHITE) == Light(
        ambient=(0.1, 0.2, 0.3, 0.4),
        diffuse=(0.5, 0.6, 0.7, 0.8),
        position=(3.0, 4.0, 5.0, 1.0),
        spot_direction=(0.0, 0.0, -2.0),
        spot_exponent=2.5,
        spot_cutoff=30.0,
        constant_attenuation=2.0,
        linear_attenuation=0.25,
        quadratic_attenuation=0.125,
    )


def test_a_position_is_transformed_when_it_is_given():
    gl = context()
    gl.Translatef(0.0, 0.0, -5.0)
    gl.Lightfv(t.LIGHT0, t.POSITION, [1.0, 0.0, 0.0, 0.0])
    gl.Lightfv(t.LIGHT1, t.POSITION, [1.0, 0.0, 0.0, 2.0])
    gl.LoadIdentity()
    assert gl.values["light", 0].position == (1.0, 0.0, 0.0, 0.0)
    assert gl.values["light", 1].position == (1.0, 0.0, -10.0, 2.0)


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (lambda gl: gl.Lightf(t.LIGHT0, t.SPOT_EXPONENT, 129.0), t.INVALID_VALUE),
        (lambda gl: gl.Lightf(t.LIGHT0, t.SPOT_CUTOFF, 91.0), t.INVALID_VALUE),
        (lambda gl: gl.Lightf(t.LIGHT0, t.LINEAR_ATTENUATION, -1.0), t.INVALID_VALUE),
        (lambda gl: gl.Lightf(t.LIGHT0, t.AMBIENT, 1.0), t.INVALID_ENUM),
        (lambda gl: gl.Lightf(t.LIGHT0 + 8, t.SPOT_CUTOFF, 1.0), t.INVALID_ENUM),
        (lambda gl: gl.Materialf(t.FRONT, t.SHININESS, -1.0), t.INVALID_VALUE),
        (lambda gl: gl.Materialf(t.FRONT, t.DIFFUSE, 1.0), t.INVALID_ENUM),
        (lambda gl: gl.Materialfv(t.LEFT, t.DIFFUSE, [1.0] * 4), t.INVALID_ENUM),
        (lambda gl: gl.ColorMaterial(t.FRONT, t.SHININESS), t.INVALID_ENUM),
        (lambda gl: gl.LightModeli(t.LIGHT_MODEL_COLOR_CONTROL, 7), t.INVALID_ENUM),
        (lambda gl: gl.LightModelf(t.LIGHT_MODEL_AMBIENT, 1.0), t.INVALID_ENUM),
        (lambda gl: gl.ClipPlane(t.CLIP_PLANE0 + 8, [0.0] * 4), t.INVALID_ENUM),
    ],
)
def test_errors_leave_the_state(call, kind):
    gl = context()
    before = dict(gl.values._of)
    call(gl)
    assert gl.GetError() == kind
    assert gl.values._of == before


def test_materials_of_each_face():
    gl = context()
    gl.Enable(t.LIGHTING)
    gl.Materialfv(t.FRONT_AND_BACK, t.AMBIENT_AND_DIFFUSE, RED)
    gl.Materialfv(t.BACK, t.SPECULAR, list(GREEN))
    gl.Materialfv(t.FRONT, t.EMISSION, [0.1, 0.2, 0.3, 0.4])
    gl.Materiali(t.FRONT, t.SHININESS, 7)
    assert lighting(gl).front == Material(RED, RED, BLACK, (0.1, 0.2, 0.3, 0.4), 7.0)
    assert lighting(gl).back == Material(RED, RED, GREEN)


def test_the_lighting_model():
    gl = context()
    gl.Enable(t.LIGHTING)
    gl.LightModelfv(t.LIGHT_MODEL_AMBIENT, [0.1, 0.2, 0.3, 0.4])
    gl.LightModeli(t.LIGHT_MODEL_LOCAL_VIEWER, 1)
    gl.LightModelf(t.LIGHT_MODEL_TWO_SIDE, 1.0)
    gl.LightModeli(t.LIGHT_MODEL_COLOR_CONTROL, t.SEPARATE_SPECULAR_COLOR)
    gl.Enable(t.NORMALIZE)
    gl.Enable(t.RESCALE_NORMAL)
    assert lighting(gl) == Lighting(
        model_ambient=(0.1, 0.2, 0.3, 0.4), local_viewer=True, two_side=True, separate_specular_color=True
    )
    assert (gl.state().vertex.normalize, gl.state().vertex.rescale_normal) == (True, True)
    gl.Disable(t.LIGHTING)
    assert lighting(gl) is None


# -------------------------------------------------------------------------------------------- color material


def test_color_material_is_a_part_of_the_state():
    gl = context()
    gl.Enable(t.LIGHTING)
    gl.ColorMaterial(t.BACK, t.SPECULAR)
    gl.Enable(t.COLOR_MATERIAL)
    assert lighting(gl).color_material == ColorMaterial(Face.BACK, ColorMaterialParameter.SPECULAR)


def test_a_colour_that_follows_the_current_one_stays_when_that_ends():
    gl = context()
    gl.Enable(t.LIGHTING)
    gl.ColorMaterial(t.FRONT, t.DIFFUSE)
    gl.Enable(t.COLOR_MATERIAL)
    gl.Color4f(*RED)
    assert gl.GetMaterialfv(t.FRONT, t.DIFFUSE) == RED
    gl.Disable(t.COLOR_MATERIAL)
    gl.Color4f(*GREEN)
    assert lighting(gl).front.diffuse == RED
    assert lighting(gl).back.diffuse == Material().diffuse


def test_another_colour_follows_from_the_call_on():
    gl = context()
    gl.ColorMaterial(t.FRONT, t.DIFFUSE)
    gl.Enable(t.COLOR_MATERIAL)
    gl.Color4f(*RED)
    gl.ColorMaterial(t.FRONT, t.SPECULAR)
    gl.Color4f(*GREEN)
    assert gl.GetMaterialfv(t.FRONT, t.DIFFUSE) == RED
    assert gl.GetMaterialfv(t.FRONT, t.SPECULAR) == GREEN


def test_material_does_not_change_a_colour_that_follows():
    gl = context()
    gl.ColorMaterial(t.FRONT, t.DIFFUSE)
    gl.Enable(t.COLOR_MATERIAL)
    gl.Color4f(*RED)
    gl.Materialfv(t.FRONT_AND_BACK, t.AMBIENT_AND_DIFFUSE, GREEN)
    gl.Disable(t.COLOR_MATERIAL)
    assert (gl.GetMaterialfv(t.FRONT, t.DIFFUSE), gl.GetMaterialfv(t.FRONT, t.AMBIENT)) == (RED, GREEN)
    assert gl.GetMaterialfv(t.BACK, t.DIFFUSE) == GREEN


def test_colours_that_are_not_read_make_no_other_state():
    gl = context()
    gl.Enable(t.LIGHTING)
    gl.Enable(t.COLOR_MATERIAL)
    gl.Color4f(*RED)
    first = gl.state()
    gl.Disable(t.COLOR_MATERIAL)
    assert gl.state() != first
    gl.Color4f(*GREEN)
    gl.Enable(t.COLOR_MATERIAL)
    assert gl.state() is first


# ---------------------------------------------------------------------------------- planes, weights, NaN


def test_a_clip_plane_is_transformed_by_the_inverse_of_then():
    gl = context()
    gl.Translatef(0.0, 0.0, -5.0)
    gl.ClipPlane(t.CLIP_PLANE0 + 1, [0.0, 0.0, 1.0, 2.0])
    gl.LoadIdentity()
    gl.Enable(t.CLIP_PLANE0 + 1)
    assert gl.state().vertex.clip_planes == ((0.0, 0.0, 1.0, 7.0),)
    assert gl.GetClipPlane(t.CLIP_PLANE0 + 1) == (0.0, 0.0, 1.0, 7.0)
    gl.Scalef(0.0, 1.0, 1.0)
    gl.ClipPlane(t.CLIP_PLANE0 + 1, [1.0, 0.0, 0.0, 0.0])
    assert counted(gl, "left out") == [("glClipPlane: the modelview matrix has no inverse", 1)]


def test_vertex_weighting_has_a_second_matrix():
    gl = context()
    gl.MatrixMode(t.MODELVIEW1_EXT)
    gl.Translatef(1.0, 0.0, 0.0)
    assert gl.state().vertex.modelview1 is None
    gl.Enable(t.VERTEX_WEIGHTING_EXT)
    assert gl.state().vertex.modelview1[0] == (1.0, 0.0, 0.0, 1.0)


def test_a_draw_with_a_light_that_is_no_number_is_left_out_and_others_are_not():
    gl = context()
    gl.Enable(t.LIGHT0)
    gl.Lightfv(t.LIGHT0, t.POSITION, [math.nan, 0.0, 0.0, 1.0])
    draw_triangle(gl)
    gl.Enable(t.LIGHTING)
    draw_triangle(gl)
    gl.Lightfv(t.LIGHT0, t.POSITION, [0.0, 0.0, 1.0, 0.0])
    draw_triangle(gl)
    assert counted(gl, "left out") == [
        ("glEnd: a light has a number that is infinite or no number", 1),
    ]
    assert counted(gl, "drawn") == [("glEnd", 2)]
    assert len(gl.take_commands()) == 2


def test_the_same_state_is_the_same_object_whatever_lies_below_it_on_the_stack():
    gl = context()
    first = gl.state()
    gl.PushMatrix()
    gl.Rotatef(30.0, 1.0, 0.0, 0.0)
    gl.PushMatrix()
    gl.LoadIdentity()
    assert gl.state() is first


# -------------------------------------------------------------------------------------------- what is drawn


@pytest.mark.parametrize("profile", ["GEFORCE_256", "GEFORCE_3", "OPENGL_1_2"])
def test_a_light_lights(profile):
    gl = context(profile, 16, 16)
    gl.Enable(t.LIGHTING)
    gl.Enable(t.LIGHT0)
    gl.Materialfv(t.FRONT, t.AMBIENT, BLACK)
    gl.LightModelfv(t.LIGHT_MODEL_AMBIENT, BLACK)
    gl.Materialfv(t.FRONT, t.DIFFUSE, [1.0, 0.5, 0.0, 1.0])
    draw_triangle(gl)
    image = Machine(PROFILES[profile], 16, 16).run(gl.take_commands()).image()
    # The unit's reciprocals are a little low.
    assert np.abs(image[12, 8, :3].astype(int) - (255, 128, 0)).max() <= 1


def test_color_sum_is_the_vertices_and_not_lighting_s():
    gl = context()
    gl.Enable(t.COLOR_SUM)
    assert gl.state().color_sum
    gl.Enable(t.LIGHTING)
    assert not gl.state().color_sum


def test_combiners_read_no_secondary_colour_of_the_vertices_when_lighting_has_one_colour():
    gl = context("GEFORCE_3")
    gl.Enable(t.REGISTER_COMBINERS_NV)
    assert gl.state().vertex.secondary_color is SecondaryColor.FROM_VERTEX
    gl.Enable(t.LIGHTING)
    assert gl.state().vertex.secondary_color is SecondaryColor.DISABLED
    gl.LightModeli(t.LIGHT_MODEL_COLOR_CONTROL, t.SEPARATE_SPECULAR_COLOR)
    assert gl.state().vertex.secondary_color is SecondaryColor.FROM_VERTEX


def test_a_directional_spotlight_on_a_lighting_unit_has_its_factor_in_its_colours():
    gl = context("GEFORCE_3", 16, 16)
    gl.Enable(t.LIGHTING)
    gl.Enable(t.LIGHT0)
    gl.Lightfv(t.LIGHT0, t.POSITION, [0.0, 0.0, 1.0, 0.0])
    gl.Lightfv(t.LIGHT0, t.SPOT_DIRECTION, [0.0, math.sin(0.5), -math.cos(0.5)])
    gl.Lightf(t.LIGHT0, t.SPOT_CUTOFF, 60.0)
    gl.Lightf(t.LIGHT0, t.SPOT_EXPONENT, 2.0)
    (light,) = lighting(gl).lights
    factor = math.cos(0.5) ** 2
    assert light.diffuse == pytest.approx((factor, factor, factor, 1.0), abs=2.0**-33)
    assert (light.diffuse[0] * 2.0**32).is_integer()  # on every machine
    assert light.spot_cutoff == 180.0
    gl.Lightf(t.LIGHT0, t.SPOT_CUTOFF, 20.0)
    assert lighting(gl).lights[0].diffuse == (0.0, 0.0, 0.0, 1.0)
    draw_triangle(gl)
    Machine(PROFILES["GEFORCE_3"], 16, 16).run(gl.take_commands())
