"""Cameras of a light fitted to what the viewer sees, slices of the viewer's frustum, and a cube of maps."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance import agreement
from fixedpipe.effects.geometry import convex_bodies
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.scenes import avenue, lit_room
from fixedpipe.effects.shadows import cube_of_maps, frustum_slices, light_space, lit_scene, parted_shadow_maps
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit
from fixedpipe.pipeline.enums import Face
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_3, INFINITE_REALITY
from fixedpipe.pipeline.state import Lighting, Material, PolygonState

PANEL = Panel(0, 0, 96, 96)
SCENE = avenue.avenue(12)
VIEW = avenue.avenue_view(PANEL)
SUN = light_space.whole_scene_camera(SCENE, avenue.SUN, VIEW)
LIGHTS = {
    "from the right": avenue.SUN,
    "from the front, low": (-0.3, 0.4, -0.9),
    "nearly along the view": (0.03, 0.13, 1.0),
    "from above": (0.0, 1.0, 0.0),
}
CAMERAS = {
    "uniform": light_space.uniform_camera,
    "perspective": light_space.perspective_camera,
}


def clip(camera, points):
    """Clip coordinates of points [n, 3]: float64 [n, 4]."""
    matrix = np.array(camera.projection) @ np.array(camera.modelview)
    return np.asarray(points) @ matrix[:, :3].T + matrix[:, 3]


def fitted(kind, light):
    """A light's direction, the body that the viewer sees and the camera that is fitted to it."""
    direction, body = LIGHTS[light], light_space.seen_body(SCENE, VIEW)
    return direction, body, CAMERAS[kind](body, SCENE, direction, VIEW)


def inside_body(body, count=400):
    """Points of a convex body: random means of its corners, and the corners."""
    weights = np.random.default_rng(7).dirichlet(np.full(len(body), 0.3), count)
    return np.concatenate([body, weights @ body])


def box(least, most):
    ends = np.array([least, most], np.float64)
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


# ------------------------------------------------------------------------------------------ convex bodies


def test_boxes_meet_in_the_box_they_share():
    met = convex_bodies.meeting(box((0, 0, 0), (2, 2, 2)), box((1, -1, 0.5), (3, 1, 1.5)))
    corners = np.unique(np.round(met, 12), axis=0)
    assert np.array_equal(corners, np.unique(box((1, 0, 0.5), (2, 1, 1.5)), axis=0))


@pytest.mark.parametrize("inner_first", [True, False])
def test_a_box_in_a_box_is_what_they_share(inner_first):
    inner, outer = box((0.2, 0.2, 0.2), (0.7, 0.8, 0.9)), box((0, 0, 0), (1, 1, 1))
    met = convex_bodies.meeting(*((inner, outer) if inner_first else (outer, inner)))
    assert np.array_equal(np.unique(np.round(met, 12), axis=0), np.unique(inner, axis=0))


def test_bodies_that_do_not_meet_share_nothing():
    assert len(convex_bodies.meeting(box((0, 0, 0), (1, 1, 1)), box((2, 2, 2), (3, 3, 3)))) == 0


def test_planes_point_inward_whatever_the_hand_of_the_body():
    body = box((-1, 0, 2), (1, 3, 5))
    for corners in (body, body * np.array([-1.0, 1.0, 1.0])):
        planes = convex_bodies.planes(corners)
        assert (planes[:, :3] @ corners.mean(axis=0) + planes[:, 3] > 0).all()
        # Each plane holds four corners.
        assert (np.abs(planes[:, :3] @ corners.T + planes[:, 3:]) < 1e-12).sum() == 24


def test_a_frustum_is_the_clip_cube():
    corners = convex_bodies.frustum(VIEW)
    matrix = np.array(VIEW.projection) @ np.array(VIEW.modelview)
    q = corners @ matrix[:, :3].T + matrix[:, 3]
    assert np.abs(q[:, :3] / q[:, 3:] - box((-1, -1, -1), (1, 1, 1))).max() < 1e-9


def test_what_is_seen_is_in_the_frustum_and_in_the_scene():
    """Of random points of the scene's box exactly those in the frustum are in the body's hull, as far as its
    bounding box tells; and the body's corners are in both.
    """
    body = light_space.seen_body(SCENE, VIEW)
    for corners in (convex_bodies.frustum(VIEW), SCENE.corners()):
        planes = convex_bodies.planes(corners)
        planes /= np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
        assert (body @ planes[:, :3].T + planes[:, 3] > -1e-9).all()
    least, most = SCENE.bounds()
    points = least + np.random.default_rng(3).random((20000, 3)) * (most - least)
    matrix = np.array(VIEW.projection) @ np.array(VIEW.modelview)
    q = points @ matrix[:, :3].T + matrix[:, 3]
    seen = points[(np.abs(q[:, :3]) <= q[:, 3:]).all(axis=1)]
    assert len(seen) > 1000
    assert (seen >= body.min(axis=0) - 1e-9).all()
    assert (seen <= body.max(axis=0) + 1e-9).all()
    # And the body is no larger than need be.
    assert (seen.min(axis=0) - body.min(axis=0) < 1.5).all()
    assert (body.max(axis=0) - seen.max(axis=0) < 1.5).all()


# --------------------------------------------------------------------------------- the light's cameras


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("kind", CAMERAS)
def test_what_is_seen_and_what_shadows_it_is_in_the_map(kind, light):
    """The body fills the map to its edges, and everything of the scene's box above it is in its depths."""
    direction, body, camera = fitted(kind, light)
    points = inside_body(body)
    q = clip(camera, points)
    assert (q[:, 3] > 0.0).all()
    ndc = q[:, :3] / q[:, 3:]
    assert np.abs(ndc).max() <= 1.0 + 1e-9
    assert np.abs(np.stack([ndc[:, :2].min(axis=0), ndc[:, :2].max(axis=0)]) - [[-1], [1]]).max() < 1e-9
    z = np.array(direction) / np.linalg.norm(direction)
    least, most = SCENE.bounds()
    above = (points[:, None, :] + np.linspace(0.0, 120.0, 400)[None, :, None] * z).reshape(-1, 3)
    above = above[((above >= least - 1e-9) & (above <= most + 1e-9)).all(axis=1)]
    q = clip(camera, above)
    assert (np.abs(q[:, :3] / q[:, 3:]) <= 1.0 + 1e-9).all()


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("kind", CAMERAS)
def test_a_ray_of_light_is_one_texel_and_depth_grows_along_it(kind, light):
    direction, body, camera = fitted(kind, light)
    z = np.array(direction) / np.linalg.norm(direction)
    points = inside_body(body, 100)
    ray = points[:, None, :] + np.linspace(0.0, 5.0, 12)[None, :, None] * z
    q = clip(camera, ray.reshape(-1, 3)).reshape(*ray.shape[:2], 4)
    ndc = q[..., :3] / q[..., 3:]
    assert np.ptp(ndc[..., :2], axis=1).max() < 1e-9
    assert (np.diff(ndc[..., 2], axis=1) < 0.0).all()


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("kind", CAMERAS)
def test_faces_that_the_light_sees_stay_front_faces(kind, light):
    """A triangle that turns its counter-clockwise side to the light is counter-clockwise in the map."""
    direction, body, camera = fitted(kind, light)
    x, y, _ = light_space.light_axes(direction, VIEW)
    for corner in inside_body(body, 50):
        q = clip(camera, np.stack([corner, corner + 0.1 * x, corner + 0.1 * y]))
        a, b, c = q[:, :2] / q[:, 3:]
        assert np.linalg.det(np.stack([b - a, c - a])) > 0.0


def test_axes_are_right_handed_and_the_viewer_looks_up_the_map():
    for direction in (*LIGHTS.values(), tuple(light_space.view_direction(VIEW))):
        axes = light_space.light_axes(direction, VIEW)
        assert np.abs(axes @ axes.T - np.eye(3)).max() < 1e-12
        assert abs(np.linalg.det(axes) - 1.0) < 1e-12
        if light_space.sine_between(direction, VIEW) > light_space.LEAST_SINE:
            along = axes @ light_space.view_direction(VIEW)
            assert abs(along[0]) < 1e-12
            assert along[1] > 0.0


def test_parallel_light_and_view_leave_the_uniform_camera():
    """At the limit, and n grows towards it until the two cameras are nearly the same."""
    body = light_space.seen_body(SCENE, VIEW)
    along = light_space.view_direction(VIEW)
    for direction in (tuple(along), tuple(-along)):
        camera = light_space.perspective_camera(body, SCENE, direction, VIEW)
        assert camera.n is None
        assert camera == light_space.uniform_camera(body, SCENE, direction, VIEW)
    side = light_space.light_axes(avenue.SUN, VIEW)[0]
    sine = 1.01 * light_space.LEAST_SINE
    direction = tuple(np.sqrt(1.0 - sine * sine) * -along + sine * side)
    warped = light_space.perspective_camera(body, SCENE, direction, VIEW)
    plain = light_space.uniform_camera(body, SCENE, direction, VIEW)
    assert warped.n > 400.0
    a, b = (clip(camera, body) for camera in (warped, plain))
    assert np.abs(a[:, :2] / a[:, 3:] - b[:, :2] / b[:, 3:]).max() < 0.1


@pytest.mark.parametrize("light", ["from the right", "from the front, low"])
def test_the_line_of_sight_is_one_column_of_the_warped_map(light):
    """The second perspective's centre is before the eye: left and right of it are treated alike."""
    body = light_space.seen_body(SCENE, VIEW)
    camera = light_space.perspective_camera(body, SCENE, LIGHTS[light], VIEW)
    line = np.array(VIEW.eye) + np.linspace(5.0, 60.0, 9)[:, None] * light_space.view_direction(VIEW)
    q = clip(camera, line)
    assert np.ptp(q[:, 0] / q[:, 3]) < 1e-9


def test_best_n_sees_texels_as_large_at_both_ends():
    """The derivation: along a line perpendicular to the light, of which the viewer's depth grows by
    sin(gamma), w^2 / z is the same at both ends, and smaller between them.
    """
    for sine in (1.0, 0.6, 0.2):
        body = convex_bodies.frustum(VIEW, 4.0, 60.0)
        n = light_space.best_n(body, VIEW, sine)
        z = np.linspace(4.0, 60.0, 50)
        w = n + (z - 4.0) / sine
        size = w * w / z
        assert abs(size[0] / size[-1] - 1.0) < 1e-12
        assert size.max() <= size[0] * (1.0 + 1e-12)
        assert size.min() < 0.8 * size[0]


@pytest.mark.parametrize("kind", CAMERAS)
def test_a_border_is_left_free(kind):
    body = light_space.seen_body(SCENE, VIEW)
    q = clip(CAMERAS[kind](body, SCENE, avenue.SUN, VIEW, border=1.0 / 64.0), body)
    assert abs(np.abs(q[:, :2] / q[:, 3:]).max() - (1.0 - 2.0 / 64.0)) < 1e-9


def test_the_whole_scene_is_in_the_basic_map():
    q = clip(light_space.whole_scene_camera(SCENE, avenue.SUN, VIEW), SCENE.corners())
    ndc = q[:, :3] / q[:, 3:]
    assert np.abs(ndc).max() < 1.0 + 1e-9
    assert np.abs(ndc[:, :2]).max() > 1.0 - 1e-9


def test_footprints_are_those_of_finite_differences():
    """A texel's side on the screen, from the matrices, against points moved by a texel."""
    camera = light_space.perspective_camera(light_space.seen_body(SCENE, VIEW), SCENE, avenue.SUN, VIEW)
    points = np.array([[0.5, 0.0, -3.0], [-2.0, 0.0, -30.0]])
    normals = np.tile([0.0, 1.0, 0.0], (2, 1))
    got = light_space.texel_footprints(camera.texture_matrix, 512, VIEW, points, normals)
    step = 1e-4

    def texels(p):
        q = clip(camera, p)
        return 256.0 * q[:, :2] / q[:, 3:]

    def pixels(p):
        matrix = np.array(VIEW.projection) @ np.array(VIEW.modelview)
        q = p @ matrix[:, :3].T + matrix[:, 3]
        return 48.0 * q[:, :2] / q[:, 3:]

    for i in range(2):
        p = points[i] + step * np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1.0]])
        t, x = texels(p), pixels(p)
        jacobian = np.stack([x[1] - x[0], x[2] - x[0]], 1) @ np.linalg.inv(
            np.stack([t[1] - t[0], t[2] - t[0]], 1)
        )
        assert abs(got[i] / np.sqrt(abs(np.linalg.det(jacobian))) - 1.0) < 1e-3


# ---------------------------------------------------------------------------------------------- slices


def test_slices_mix_logarithmic_and_even_ones():
    assert frustum_slices.split_distances(1.0, 81.0, 4, 0.0) == (1.0, 21.0, 41.0, 61.0, 81.0)
    assert frustum_slices.split_distances(1.0, 81.0, 4, 1.0) == (1.0, 3.0, 9.0, 27.0, 81.0)
    assert frustum_slices.split_distances(1.0, 81.0, 4) == (1.0, 12.0, 25.0, 44.0, 81.0)
    assert frustum_slices.split_distances(2.0, 5.0, 1) == (2.0, 5.0)


def test_a_depth_belongs_to_the_slice_whose_planes_it_is_between():
    distances = frustum_slices.split_distances(1.0, 81.0, 4)
    depths = np.array([0.5, 1.0, 11.999, 12.001, 24.0, 30.0, 44.5, 80.0, 100.0])
    eye = np.stack([0 * depths, 0 * depths, -depths, np.ones_like(depths)], axis=1)
    for k in range(4):
        planes = frustum_slices.slice_planes(distances, k)
        inside = np.all([eye @ np.array(plane) >= 0.0 for plane in planes], axis=0)
        assert np.array_equal(inside, frustum_slices.slice_of(distances, depths) == k)


def _times_drawn(scene, view, parts, profile):
    """How often each pixel of a scene's picture is drawn, each part between its clip planes and in two
    passes.

    Faces turned away are left out: at a silhouette they may have the front face's depth, with slices and
    without.
    """
    front = PolygonState(cull_face=Face.BACK)
    step = 1.0 / 15.0
    glow = Lighting(
        model_ambient=(0.0, 0.0, 0.0, 1.0),
        front=Material((0, 0, 0, 1.0), (0, 0, 0, 1.0), (0, 0, 0, 1.0), (step, step, step, 1.0)),
    )
    commands = [view.panel.clear((0.0, 0.0, 0.0))]
    for planes in parts:
        commands += lit_scene.unlit_pass(scene, view, SceneShading.MASK, clip_planes=planes, polygon=front)
        lit = lit_scene.lit_pass(scene, view, SUN, SceneShading.MASK, clip_planes=planes, polygon=front)
        commands += (
            replace(draw, state=replace(draw.state, vertex=replace(draw.state.vertex, lighting=glow)))
            for draw in lit
        )
    result = execute(tuple(commands), profile, view.panel.width, view.panel.height).framebuffer
    one = (2**result.color_bits - 1) / 15.0
    return np.rint(result.color[..., 0] / one).astype(int)


def _away_from_outlines(scene, view, lamp):
    """Pixels that show a surface and no object's outline, top row first."""
    truth = agreement.truth_of(scene, view, lamp)
    return (truth.shown.something & ~agreement.silhouettes(truth))[::-1]


def _drawn_once(scene, view, parts, lamp, profile):
    """Asserts that all is drawn once, as without parts. A triangle's edge that is cut in two has a vertex
    snapped to a fraction of a pixel between its ends, and may then cover another pixel of the outline.
    """
    whole, drawn = (_times_drawn(scene, view, p, profile) for p in ([()], parts))
    inner = _away_from_outlines(scene, view, lamp)
    assert inner.mean() > 0.3
    assert (whole[inner] == 1).all()
    assert (drawn[inner] == 1).all()
    assert drawn.max() == 1
    assert (drawn != whole).sum() <= 3
    # A part left out leaves a gap, and one drawn twice is seen.
    assert (_times_drawn(scene, view, parts[1:], profile)[inner] == 0).any()
    assert _times_drawn(scene, view, [*parts, parts[-1]], profile).max() == 2


@pytest.mark.parametrize("profile", [GEFORCE_3, INFINITE_REALITY], ids=["GEFORCE_3", "INFINITE_REALITY"])
def test_slices_neither_leave_gaps_nor_draw_twice(profile):
    distances = frustum_slices.view_slices(VIEW, 3)
    parts = [frustum_slices.slice_planes(distances, k) for k in range(3)]
    _drawn_once(SCENE, VIEW, parts, SUN, profile)


# ------------------------------------------------------------------------------------------ cube of maps


def test_a_right_angle_is_exact_and_a_border_is_left_free():
    lamp = cube_of_maps.face_lamp((1.0, 2.0, 3.0), "-y", 0.1, 10.0)
    assert lamp.field_of_view == 90.0
    for border in (0.0, 2.0 / 64.0):
        for face in cube_of_maps.FACES:
            lamp = cube_of_maps.face_lamp((1.0, 2.0, 3.0), face, 0.1, 10.0, border)
            axis, sign = "xyz".index(face[1]), 1.0 if face[0] == "+" else -1.0
            corner = np.array([1.0, 2.0, 3.0]) + sign * np.eye(3)[axis] + np.eye(3)[axis - 1]
            q = clip(lamp, corner[None])[0]
            assert q[3] > 0.0
            assert abs(np.abs(q[:2] / q[3]).max() - (1.0 - 2.0 * border)) < 2e-5


def test_planes_select_the_face_of_the_largest_component():
    view = lit_room.lit_room_view(PANEL)
    points = np.array(lit_room.LAMP) + np.random.default_rng(5).normal(size=(500, 3))
    eye = points @ np.array(view.modelview)[:3, :3].T + np.array(view.modelview)[:3, 3]
    eye = np.concatenate([eye, np.ones((500, 1))], axis=1)
    wanted = cube_of_maps.face_of(points - np.array(lit_room.LAMP))
    for k, face in enumerate(cube_of_maps.FACES):
        planes = cube_of_maps.face_planes(lit_room.LAMP, face, view.modelview)
        inside = np.all([eye @ np.array(plane) >= 0.0 for plane in planes], axis=0)
        assert np.array_equal(inside, wanted == k)
        lamp = cube_of_maps.face_lamp(lit_room.LAMP, face, 1e-3, 100.0)
        q = clip(lamp, points[inside])
        assert (np.abs(q[:, :2]) <= q[:, 3:] + 1e-9).all()


def test_faces_neither_leave_gaps_nor_draw_twice():
    scene, view = lit_room.lit_room(12), lit_room.lit_room_view(PANEL)
    parts = [cube_of_maps.face_planes(lit_room.LAMP, face, view.modelview) for face in cube_of_maps.FACES]
    lamp = cube_of_maps.face_lamp(lit_room.LAMP, "-y", 0.1, 10.0)
    _drawn_once(scene, view, parts, lamp, GEFORCE_3)


def test_the_cube_reaches_every_corner_of_the_scene():
    scene = lit_room.lit_room(12)
    for lamp in cube_of_maps.cube_lamps(scene, lit_room.LAMP):
        assert lamp.far > np.abs(scene.corners() - np.array(lit_room.LAMP)).max()


# ---------------------------------------------------------------------------------- parts with their maps


def test_each_part_has_a_map_of_what_is_between_its_planes():
    """Slices cover the view, each part's camera what its planes leave of it, and names are unlike."""
    for fit in MapFit:
        count = 4 if "slices" in fit.value else 1
        parts = parted_shadow_maps.parts_of_view(fit, SCENE, avenue.SUN, VIEW, 64, 4)
        assert len({part.name for part in parts}) == len(parts) == count
        points = inside_body(light_space.seen_body(SCENE, VIEW))
        eye = points @ np.array(VIEW.modelview)[:3, :3].T + np.array(VIEW.modelview)[:3, 3]
        times = np.zeros(len(points), int)
        for part in parts:
            planes = [np.array(plane) for plane in part.planes]
            inside = np.all([eye @ plane[:3] + plane[3] >= 0.0 for plane in planes] or [times >= 0], axis=0)
            q = clip(part.camera, points[inside])
            assert (np.abs(q[:, :3] / q[:, 3:]) <= 1.0 + 1e-9).all()
            times += inside
        assert (times == 1).all()


def test_a_slice_that_sees_nothing_has_no_map():
    """A scene that ends long before the camera's far plane."""
    near_things = replace(SCENE, objects=(SCENE.objects[-1],))
    parts = parted_shadow_maps.parts_of_view(MapFit.SLICES, near_things, avenue.SUN, VIEW, 64)
    assert [part.name for part in parts] == ["slices, 1"]


# ------------------------------------------------------------------------------------------- bad input


def test_bad_input_is_refused_in_a_sentence():
    body = light_space.seen_body(SCENE, VIEW)
    with pytest.raises(ValueError, match="give at least four points"):
        light_space.uniform_camera(body[:0], SCENE, avenue.SUN, VIEW)
    with pytest.raises(ValueError, match=r"border is 0\.5"):
        light_space.perspective_camera(body, SCENE, avenue.SUN, VIEW, border=0.5)
    with pytest.raises(ValueError, match=r"n is -1\.0; give a positive number"):
        light_space.perspective_camera(body, SCENE, avenue.SUN, VIEW, n=-1.0)
    with pytest.raises(ValueError, match="direction to the light is"):
        light_space.uniform_camera(body, SCENE, (0.0, 0.0, 0.0), VIEW)
    with pytest.raises(ValueError, match="not perspective"):
        convex_bodies.frustum(orthographic_view(PANEL))
    with pytest.raises(ValueError, match="has no volume"):
        convex_bodies.frustum(VIEW, 5.0, 4.0)
    with pytest.raises(ValueError, match="first body is flat"):
        convex_bodies.meeting(box((0, 0, 0), (1, 1, 0)), box((0, 0, 0), (1, 1, 1)))
    with pytest.raises(ValueError, match="number of slices is 0"):
        frustum_slices.split_distances(1.0, 2.0, 0)
    with pytest.raises(ValueError, match="the second is the farther"):
        frustum_slices.split_distances(2.0, 1.0, 3)
    with pytest.raises(ValueError, match=r"mixture is 1\.5"):
        frustum_slices.split_distances(1.0, 2.0, 3, 1.5)
    with pytest.raises(ValueError, match="Slice 3 does not exist"):
        frustum_slices.slice_planes((1.0, 2.0, 3.0, 4.0), 3)
    with pytest.raises(ValueError, match="no face 'up'"):
        cube_of_maps.face_lamp((0.0, 0.0, 0.0), "up", 0.1, 1.0)
    with pytest.raises(ValueError, match=r"The way to fit shadow maps is 'best'; give one of MapFit.BASIC"):
        parted_shadow_maps.parts_of_view("best", SCENE, avenue.SUN, VIEW, 64)
    with pytest.raises(ValueError, match="The tint is"):
        parted_shadow_maps.tinted(SCENE, (1.2, 1.0, 1.0))
    with pytest.raises(ValueError, match=r"border is 0\.7"):
        cube_of_maps.face_lamp((0.0, 0.0, 0.0), "+x", 0.1, 1.0, 0.7)
