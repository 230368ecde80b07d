"""Scenes, their lamps, and the shapes that they are made of."""

import math

import numpy as np
import pytest

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import eye_plane, look_at, product, rigid_inverse, transform
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene, lamp_around
from fixedpipe.effects.scenes.still_life import LAMP_POSITIONS, still_life, still_life_view
from fixedpipe.effects.shadows.lit_scene import (
    AMBIENT,
    LAMP_COLOR,
    SHININESS,
    SceneShading,
    depth_pass,
    lit_pass,
    map_edge,
    unlit_pass,
)
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.validation.validate import validate

PANEL = Panel(0, 0, 32, 32)


@pytest.mark.parametrize("infinite", [False, True])
@pytest.mark.parametrize("position", [*LAMP_POSITIONS, (0.0, 9.0, 0.0)])
def test_a_lamp_around_a_scene_has_all_of_it_in_its_map(position, infinite):
    scene = still_life(12)
    lamp = lamp_around(scene, position, infinite=infinite)
    depths = []
    for point in np.concatenate([o.surface.positions for o in scene.throwing]).tolist():
        s, t, r, q = transform(lamp.texture_matrix, (*point, 1.0))
        assert q > 0.0
        assert all(0.0 <= c <= q for c in (s, t, r))
        linear = sum(p * c for p, c in zip(lamp.depth_plane, (*point, 1.0), strict=True))
        assert 0.0 < linear < 1.0
        depths.append((r / q, linear))
    # Nearer in the map is nearer in the world.
    window, linear = np.array(sorted(depths)).T
    assert (np.diff(linear) >= -1e-12).all()
    if not infinite:
        assert np.abs(window - linear).max() > 0.05


def test_the_ground_is_in_no_map_and_the_floor_goes_on_in_it_without_a_gap():
    scene = still_life(12)
    by_name = {thing.name: thing for thing in scene.objects}
    assert set(scene.objects) - set(scene.throwing) == {by_name["ground"]}
    drawn = [draw.mesh for draw in depth_pass(scene, still_life_view(PANEL))]
    assert [thing.mesh for thing in scene.throwing] == drawn
    floor, ground = (by_name[name].surface for name in ("floor", "ground"))
    half = scene.bounds()[1][0]
    assert half == floor.positions.max() < ground.positions.max()
    on_rim = np.abs(floor.positions[:, [0, 2]]).max(axis=1) == half
    inner = np.abs(ground.positions[:, [0, 2]]).max(axis=1) == half
    assert {tuple(p) for p in floor.positions[on_rim]} == {tuple(p) for p in ground.positions[inner]}
    # All that the camera sees is the scene: it has no background.
    assert ray_caster.visible(ray_caster.scene_caster(scene), still_life_view(PANEL)).something.all()


def test_every_side_of_the_still_lifes_box_is_lit_clearly_or_turned_away_clearly():
    """A side that light grazes looks unlit and counts as lit."""
    (box,) = (thing.surface for thing in still_life(12).objects if thing.name == "box")
    for position in LAMP_POSITIONS:
        cosines = dot(box.normals, normalize(np.array(position) - box.positions))
        assert np.abs(cosines).min() > 0.1


def test_a_lamp_in_the_midst_of_a_scene_is_refused():
    with pytest.raises(ValueError, match="not in front of the whole scene"):
        lamp_around(still_life(12), (0.0, 1.0, 0.5))


def test_a_plane_in_eye_coordinates_has_the_worlds_values():
    view = look_at((3.0, 2.0, 5.0), (0.0, 1.0, 0.0))
    plane, point = (0.3, -0.2, 0.5, 1.5), (0.7, -0.4, 2.0, 1.0)
    world = sum(a * b for a, b in zip(plane, point, strict=True))
    eye = sum(a * b for a, b in zip(eye_plane(plane, view), transform(view, point), strict=True))
    assert eye == pytest.approx(world, abs=1e-12)
    assert np.allclose(product(view, rigid_inverse(view)), np.eye(4), atol=1e-12)


SHAPES = {
    "box": surfaces.box(1.0, 2.0, 3.0),
    **{thing.name: thing.surface for thing in still_life(12).objects if thing.closed},
}


@pytest.mark.parametrize("name", SHAPES)
def test_closed_objects_use_every_edge_once_in_each_direction(name):
    surface = SHAPES[name]
    _, place = np.unique(surface.positions + 0.0, axis=0, return_inverse=True)
    triangles = place.ravel()[surface.triangles]
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert {tuple(e) for e in edges.tolist()} == {tuple(e[::-1]) for e in edges.tolist()}


@pytest.mark.parametrize("name", SHAPES)
def test_normals_of_closed_objects_point_outwards(name):
    surface = SHAPES[name]
    a, b, c = (surface.positions[surface.triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    volume = float((dot(a, np.cross(b, c)) / 6.0).sum())
    assert volume > 0.0
    for k in range(3):
        assert (dot(face, surface.normals[surface.triangles[:, k]]) > 0.0).all()
    assert np.allclose(dot(surface.normals, surface.normals), 1.0)


def test_a_turned_cylinder_keeps_its_edges_sharp():
    cylinder = surfaces.lathe(((0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)), 64)
    upright = np.abs(cylinder.normals[:, 1])
    assert set(np.round(upright, 6)) == {0.0, 1.0}
    assert len(cylinder.triangles) == 2 * 64 * 2


@pytest.mark.parametrize(
    ("profile", "what"),
    [
        (((0.0, 0.0), (0.0, 1.0)), "three or more"),
        (((0.0, 0.0), (1.0, math.nan), (0.0, 1.0)), "finite"),
        (((0.1, 0.0), (1.0, 0.5), (0.0, 1.0)), "begins and ends on the axis"),
        (((0.0, 0.0), (0.0, 0.5), (0.0, 1.0)), "off it between"),
        (((0.0, 0.0), (1.0, 0.5), (1.0, 0.5), (0.0, 1.0)), "the same"),
    ],
)
def test_a_profile_that_cannot_be_turned_is_refused(profile, what):
    with pytest.raises(ValueError, match=what):
        surfaces.lathe(profile)


def test_a_box_without_volume_is_refused():
    with pytest.raises(ValueError, match="no volume"):
        surfaces.box(1.0, 0.0, 1.0)


def test_an_objects_colour_and_a_lamps_planes_are_checked():
    with pytest.raises(ValueError, match="The colour of thing"):
        Object("thing", surfaces.plane(), (2.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="the second is the farther"):
        Lamp((0.0, 1.0, 0.0), (0.0, 0.0, 0.0), 2.0, 1.0)


def test_the_shared_passes_are_valid_on_a_plain_board():
    scene = still_life(12)
    view, lamp = still_life_view(PANEL), lamp_around(scene, LAMP_POSITIONS[0])
    commands = (
        *depth_pass(scene, lamp.view(PANEL), factor=1.1, units=4.0),
        *unlit_pass(scene, view),
        *lit_pass(scene, view, lamp),
        *unlit_pass(scene, view, SceneShading.MASK),
        *lit_pass(scene, view, lamp, SceneShading.MASK),
    )
    validate(commands, PROFILES["OPENGL_1_2"], 32, 32)
    for word in ("bright", "mask"):
        with pytest.raises(
            ValueError, match=f"The shading is '{word}'; give one of SceneShading.LIT, SceneSh"
        ):
            unlit_pass(scene, view, word)


def test_a_scene_names_each_triangles_object_and_its_box():
    scene = Scene(still_life(12).objects[:2])
    count = len(scene.objects[0].surface.triangles)
    assert scene.object_of_triangle()[count - 1] == 0
    assert scene.object_of_triangle()[count] == 1
    assert len(scene.triangles()) == len(scene.object_of_triangle())
    assert scene.corners().min(axis=0).tolist() == scene.bounds()[0].tolist()


@pytest.mark.parametrize(("size", "ratio", "edge"), [(512, 1, 512), (512, 2, 1024), (100, 1, 64), (4, 1, 8)])
def test_maps_scale_with_the_panel_in_powers_of_two(size, ratio, edge):
    assert map_edge(size, ratio) == edge


@pytest.mark.parametrize("infinite", [False, True])
def test_the_two_passes_are_the_lighting_equation_in_world_coordinates(infinite):
    """Ambient, diffuse and a highlight towards the eye, where the lamp is in the world."""
    panel, color, strength = Panel(0, 0, 96, 96), (0.6, 0.4, 0.2), 0.5
    scene = Scene((Object("ball", surfaces.sphere(160, 80), color, strength),))
    eye, place = (2.0, 1.5, 3.0), (4.0, 2.0, 1.0)
    view = perspective_view(panel, eye, field_of_view=40.0)
    lamp = Lamp(place, (0.0, 0.0, 0.0), 1.0, 9.0, infinite=infinite, half_width=2.0)
    commands = (panel.clear((0.0, 0.0, 0.0)), *unlit_pass(scene, view), *lit_pass(scene, view, lamp))
    picture = execute_ideal(commands, 96, 96).color[::-1, :, :3]
    shown = ray_caster.visible(ray_caster.scene_caster(scene), view)
    normals = normalize(shown.points)
    light = np.broadcast_to(normalize(np.array(place)), normals.shape)
    light = light if infinite else normalize(np.array(place) - shown.points)
    halfway = normalize(light + normalize(np.array(eye) - shown.points))
    cosine, highlight = (np.maximum(dot(normals, v), 0.0)[..., None] for v in (light, halfway))
    lit = np.array(color) * cosine + strength * highlight**SHININESS * (cosine > 0.0)
    wanted = np.array(color) * np.array(AMBIENT[:3]) + np.array(LAMP_COLOR[:3]) * lit
    inner = shown.something & (dot(shown.normals, normalize(np.array(eye) - shown.points)) > 0.3)
    assert inner.mean() > 0.3
    assert wanted[inner].max() < 1.0
    # Per vertex, 160 round the ball: the highlight's top is interpolated.
    assert np.abs(picture - wanted)[inner].max() < 0.01
