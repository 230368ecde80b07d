"""A material that changes between the vertices of a primitive gives what each vertex's own material gives."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import ColorMaterialParameter, Face, PrimitiveType, ProvokingVertex
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import tokens as t
from fixedpipe.pipeline.opengl.material_changes import _polygons
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import Material
from fixedpipe.pipeline.vertices.arithmetic import columns_of, transform
from fixedpipe.pipeline.vertices.colors import eye_normal, lit_colors
from tests.pipeline.opengl.drawn import context, counted

CORNERS = ((-0.9, -0.9), (0.9, -0.8), (-0.8, 0.9), (0.9, 0.9), (0.1, 0.2))
SHADES = [
    (0.2, 0.3, 0.9, 1.0),
    (0.8, 0.1, 0.1, 0.5),
    (0.1, 0.9, 0.3, 1.0),
    (0.6, 0.6, 0.1, 1.0),
    (1.0, 1.0, 1.0, 1.0),
]


def lit_context(profile="GEFORCE_256"):
    gl = context(profile, 32, 32)
    gl.Enable(t.LIGHTING)
    gl.Enable(t.LIGHT0)
    gl.Lightfv(t.LIGHT0, t.POSITION, [1.0, 2.0, 3.0, 1.0])
    gl.Lightfv(t.LIGHT0, t.AMBIENT, [0.3, 0.2, 0.1, 1.0])
    return gl


def draw(gl, mode, change, corners=CORNERS):
    gl.Begin(mode)
    for i, (x, y) in enumerate(corners):
        change(gl, i)
        gl.Normal3f(0.1 * x, 0.1 * y, 1.0)
        gl.Vertex2f(x, y)
    gl.End()
    return [command for command in gl.take_commands() if isinstance(command, Draw)]


def diffuse(gl, i):
    gl.Materialfv(t.FRONT, t.DIFFUSE, SHADES[i])


def diffuse_and_shininess(gl, i):
    diffuse(gl, i)
    gl.Materialfv(t.FRONT, t.SPECULAR, [0.9, 0.5, 0.4, 1.0])
    gl.Materialf(t.FRONT, t.SHININESS, 3.0 * i)


# --------------------------------------------------------------------------------------- the three ways


def test_independent_primitives_are_drawn_a_run_at_a_time():
    gl = lit_context()

    def change(gl, i):
        if i == 3:
            diffuse_and_shininess(gl, 1)

    draws = draw(gl, t.TRIANGLES, change, CORNERS[:3] * 2 + CORNERS[1:4])
    assert [len(d.mesh.positions) for d in draws] == [3, 6]
    assert [d.state.vertex.lighting.front.shininess for d in draws] == [0.0, 3.0]
    assert gl.state().vertex.lighting.front.shininess == 3.0
    assert counted(gl, "lit here") == []


def test_a_colour_that_changes_becomes_the_vertices_colour():
    gl = lit_context()
    (command,) = draw(gl, t.TRIANGLE_STRIP, diffuse)
    tracking = command.state.vertex.lighting.color_material
    assert (tracking.face, tracking.parameter) == (Face.FRONT, ColorMaterialParameter.DIFFUSE)
    assert command.mesh.colors.tolist() == [list(shade) for shade in SHADES]
    assert not gl.IsEnabled(t.COLOR_MATERIAL)
    assert gl.state().vertex.lighting.front.diffuse == SHADES[-1]
    assert gl.GetIntegerv(t.COLOR_MATERIAL_PARAMETER) == t.AMBIENT_AND_DIFFUSE


@pytest.mark.parametrize("mode", [t.TRIANGLE_STRIP, t.TRIANGLES, t.LINE_STRIP])
def test_back_materials_that_nobody_sees_are_no_change(mode):
    """Only lighting of two sides reads the back material."""
    gl = lit_context()
    commands = draw(gl, mode, lambda gl, i: gl.Materialfv(t.BACK, t.DIFFUSE, SHADES[i]))
    assert len(commands) == 1
    assert gl.GetMaterialfv(t.BACK, t.DIFFUSE) == SHADES[-1]
    assert counted(gl, "lit here") == counted(gl, "refused") == []


def test_a_colour_that_follows_the_current_one_is_no_change():
    gl = lit_context()
    gl.ColorMaterial(t.FRONT, t.DIFFUSE)
    gl.Enable(t.COLOR_MATERIAL)
    (command,) = draw(gl, t.TRIANGLE_STRIP, diffuse)
    assert command.state.vertex.lighting.color_material.parameter is ColorMaterialParameter.DIFFUSE
    assert command.mesh.colors.tolist() == [[1.0, 1.0, 1.0, 1.0]] * 5
    assert counted(gl, "lit here") == []


def test_two_materials_in_turn():
    gl = lit_context()
    (command,) = draw(gl, t.TRIANGLE_STRIP, lambda gl, i: diffuse(gl, i % 2))
    assert command.mesh.colors.tolist() == [list(SHADES[i % 2]) for i in range(5)]


def test_both_faces_follow_where_both_change_alike():
    gl = lit_context()
    gl.LightModeli(t.LIGHT_MODEL_TWO_SIDE, 1)

    def change(gl, i):
        gl.Materialfv(t.FRONT_AND_BACK, t.AMBIENT_AND_DIFFUSE, SHADES[i])

    (command,) = draw(gl, t.TRIANGLE_STRIP, change)
    tracking = command.state.vertex.lighting.color_material
    assert tracking.face is Face.FRONT_AND_BACK
    assert tracking.parameter is ColorMaterialParameter.AMBIENT_AND_DIFFUSE


def test_a_back_material_does_not_matter_with_one_side():
    gl = lit_context()

    def change(gl, i):
        gl.Materialf(t.BACK, t.SHININESS, 1.0 * i)
        diffuse(gl, i)

    (command,) = draw(gl, t.TRIANGLE_STRIP, change)
    assert command.state.vertex.lighting.color_material.face is Face.FRONT


def test_other_changes_are_lit_here_and_said_so():
    gl = lit_context()
    (command,) = draw(gl, t.TRIANGLE_STRIP, diffuse_and_shininess)
    assert command.state.vertex.lighting is None
    assert counted(gl, "lit here")[0][1] == 1
    assert gl.IsEnabled(t.LIGHTING)
    assert gl.state().vertex.lighting is not None


@pytest.mark.parametrize(
    "mode", [t.TRIANGLE_STRIP, t.TRIANGLE_FAN, t.QUAD_STRIP, t.POLYGON, t.LINE_STRIP, t.POINTS]
)
@pytest.mark.parametrize("change", [diffuse, diffuse_and_shininess])
def test_a_primitive_has_the_picture_of_its_own_colours(mode, change):
    """Beside the same vertices without lighting, in the colours that each vertex has alone as a point."""
    gl = lit_context("IDEAL")
    single = lit_context("IDEAL")
    positions = CORNERS[:4]
    alone = []
    for i, corner in enumerate(positions):
        change(single, i)
        (point,) = draw(single, t.POINTS, lambda gl, i: None, (corner,))
        vertex, mesh = point.state.vertex, point.mesh
        eye = transform(vertex.modelview, columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0)))
        alone.append(lit_colors(mesh, vertex, eye, eye_normal(mesh, vertex), PROFILES["IDEAL"])[:4, 0])
    found = []
    for command in draw(gl, mode, change, positions):
        vertex, mesh = command.state.vertex, command.mesh
        if vertex.lighting is None:
            found += mesh.colors.tolist()
            continue
        eye = transform(vertex.modelview, columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0)))
        found += lit_colors(mesh, vertex, eye, eye_normal(mesh, vertex), PROFILES["IDEAL"])[:4].T.tolist()
    assert np.abs(np.array(found) - np.array(alone)).max() <= 1e-12


def test_two_sides_are_drawn_by_culling_in_the_polygons_order():
    gl = lit_context()
    gl.LightModeli(t.LIGHT_MODEL_TWO_SIDE, 1)
    draws = draw(gl, t.TRIANGLE_STRIP, diffuse_and_shininess)
    assert len(draws) == 6
    assert [d.state.polygon.cull_face for d in draws] == [Face.BACK, Face.FRONT] * 3
    assert {d.mesh.primitive for d in draws} == {PrimitiveType.TRIANGLES}
    gl.Enable(t.CULL_FACE)
    draws = draw(gl, t.TRIANGLE_STRIP, diffuse_and_shininess)
    assert [d.state.polygon.cull_face for d in draws] == [Face.BACK] * 3
    # Every second triangle is given the other way round, so that all face the front.
    machine = Machine(PROFILES["GEFORCE_256"], 32, 32)
    assert machine.run(tuple(draws)).fragments > 400


@pytest.mark.parametrize("provoking", list(ProvokingVertex))
@pytest.mark.parametrize("mode", [t.TRIANGLE_STRIP, t.TRIANGLE_FAN, t.QUAD_STRIP])
def test_the_parts_of_a_strip_have_its_pictures(mode, provoking):
    """Flat, culled and striped: the parts keep the provoking vertices and the windings."""
    corners = np.array([(0.9 * np.cos(a), 0.9 * np.sin(a)) for a in (0.2, 1.5, 2.9, 4.0, 5.2, 6.0)])
    if mode != t.TRIANGLE_FAN:
        corners = corners[[0, 5, 1, 4, 2, 3]]

    def picture(parts):
        gl = context("GEFORCE_256", 32, 32)
        gl.ShadeModel(t.FLAT)
        gl.Enable(t.CULL_FACE)
        if provoking is ProvokingVertex.FIRST:
            gl.ProvokingVertex(0x8E4D)
        for front in (t.CCW, t.CW):
            gl.FrontFace(front)
            for primitive, places in parts:
                gl.Begin(primitive)
                for i in places:
                    gl.Color3f(0.2 + 0.1 * i, 1.0 - 0.15 * i, 0.5 if front == t.CCW else 0.0)
                    gl.Vertex2f(*corners[i].tolist())
                gl.End()
        return Machine(PROFILES["GEFORCE_256"], 32, 32).run(gl.take_commands()).image()

    whole = picture([(mode, range(6))])
    parts = picture(_polygons(mode, 6, provoking))
    assert len(np.unique(whole.reshape(-1, whole.shape[-1]), axis=0)) > 2
    assert np.array_equal(whole, parts)


def test_a_change_after_the_last_vertex_is_none():
    gl = lit_context()
    gl.Begin(t.TRIANGLES)
    for corner in CORNERS[:3]:
        gl.Vertex2f(*corner)
    diffuse(gl, 1)
    gl.End()
    (command,) = gl.take_commands()
    assert command.state.vertex.lighting.front == Material()
    assert gl.state().vertex.lighting.front.diffuse == SHADES[1]


def test_without_lighting_nothing_is_split():
    gl = context("GEFORCE_256", 32, 32)
    (command,) = draw(gl, t.TRIANGLE_STRIP, diffuse_and_shininess)
    assert command.state.vertex.lighting is None
    assert counted(gl, "lit here") == []
