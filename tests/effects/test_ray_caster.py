"""Rays: the tree against trying every triangle, shadows against geometry, and nothing between neighbours."""

import numpy as np
import pytest

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.geometry import surfaces, views
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.scenes import objects_and_lamps


def every_triangle(corners, origins, directions):
    """Distance and number of the first triangle that each ray hits, by the same formulas."""
    distance, triangle = np.full(len(origins), np.inf), np.full(len(origins), -1)
    for r, (o, d) in enumerate(zip(origins, directions, strict=True)):
        z = int(np.argmax(np.abs(d)))
        x, y = (z + 1) % 3, (z + 2) % 3
        inverse = 1.0 / d[z]
        p = corners - o
        px, py = p[..., x] - d[x] * inverse * p[..., z], p[..., y] - d[y] * inverse * p[..., z]
        edges = [
            px[:, (k + 2) % 3] * py[:, (k + 1) % 3] - py[:, (k + 2) % 3] * px[:, (k + 1) % 3]
            for k in range(3)
        ]
        u, v, w = edges
        total = (u + v) + w
        inside = ((np.stack(edges) >= 0).all(axis=0) | (np.stack(edges) <= 0).all(axis=0)) & (total != 0)
        with np.errstate(all="ignore"):
            t = ((u * p[:, 0, z] + v * p[:, 1, z]) + w * p[:, 2, z]) * inverse / total
        t = np.where(inside & (t > 0), t, np.inf)
        if np.isfinite(t.min()):
            distance[r], triangle[r] = t.min(), int(np.argmin(t))
    return distance, triangle


@pytest.mark.parametrize("count", [1, 5, 300])
@pytest.mark.parametrize("along_axes", [False, True])
def test_the_tree_finds_what_trying_every_triangle_finds(count, along_axes):
    random = np.random.default_rng(count)
    corners = random.uniform(-1, 1, (count, 1, 3)) + random.uniform(-0.3, 0.3, (count, 3, 3))
    if along_axes:  # coordinates that coincide, directions with zeros
        corners = np.round(corners * 8) / 8
    origins = random.uniform(-1.5, 1.5, (400, 3))
    directions = corners[random.integers(0, count, 400), 0] + random.normal(size=(400, 3)) * 0.1 - origins
    if along_axes:
        origins = corners[random.integers(0, count, 400)].mean(axis=1)
        origins = np.round((origins + random.normal(size=(400, 3)) * [0.1, 1.0, 0.1]) * 8) / 8
        directions = np.eye(3)[random.integers(0, 3, 400)] * random.choice([-1.0, 1.0], (400, 1))
    hits = ray_caster.RayCaster(corners).nearest(origins, directions)
    distance, triangle = every_triangle(corners, origins, directions)
    assert (hits.distance == distance).all()
    assert (hits.triangle == triangle).all()
    seen = triangle >= 0
    assert seen.any()
    where = (hits.barycentrics[seen, :, None] * corners[triangle[seen]]).sum(axis=1)
    np.testing.assert_allclose(where, origins[seen] + distance[seen, None] * directions[seen], atol=1e-9)


def test_a_closed_surface_has_no_cracks():
    """Rays from inside a sphere through its vertices, through points of its edges, and anywhere, all hit."""
    surface = surfaces.sphere(12, 8).rotated(rotation("x", 33.0)).rotated(rotation("z", 12.0))
    corners = surface.positions[surface.triangles]
    along = np.random.default_rng(3).uniform(0, 1, (len(corners), 1))
    targets = np.concatenate(
        [
            surface.positions,
            corners[:, 0] * along + corners[:, 1] * (1 - along),
            normalize(corners.mean(axis=1)),
        ]
    )
    inside = np.array([0.11, -0.23, 0.05])
    hits = ray_caster.RayCaster(corners).nearest(inside, targets - inside)
    assert (hits.triangle >= 0).all()
    assert (np.abs(hits.distance[: -len(corners)] - 1.0) < 1e-9).all()


def ball_on_floor(height=1.5):
    return objects_and_lamps.Scene(
        (
            objects_and_lamps.Object("floor", objects_and_lamps.floor(4.0, 8), (1.0, 1.0, 1.0), closed=False),
            objects_and_lamps.Object("ball", surfaces.sphere(160, 80).moved(0, height, 0), (1.0, 1.0, 1.0)),
        )
    )


@pytest.mark.parametrize("infinite", [False, True])
def test_the_shadow_of_a_ball_is_a_cone_on_the_floor(infinite):
    scene = ball_on_floor()
    lamp = objects_and_lamps.lamp_around(scene, (3.0, 9.0, 2.0), infinite=infinite)
    panel = views.Panel(0, 0, 96, 96)
    caster = ray_caster.scene_caster(scene)
    shown = ray_caster.visible(caster, views.perspective_view(panel, (0.5, 4.0, 9.0), radius=7.0))
    lit = ray_caster.lit(caster, shown, lamp)
    floor = shown.object == 0
    to_lamp, _ = ray_caster.to_light(shown.points.reshape(-1, 3), lamp)
    to_lamp = normalize(to_lamp).reshape(shown.points.shape)
    to_center = np.array([0.0, 1.5, 0.0]) - shown.points
    across = to_center - dot(to_center, to_lamp)[..., None] * to_lamp
    distance = np.sqrt(dot(across, across))
    # A polyhedron of so many sides lies within a thousandth of the ball.
    assert not lit[floor & (distance < 0.998)].any()
    assert lit[floor & (distance > 1.0)].all()
    assert (floor & (distance < 0.998)).any()
    assert not lit[shown.object < 0].any()
    ball = shown.object == 1
    facing = dot(shown.normals, to_lamp)
    assert (lit == (facing > 0.0))[ball].all()


def test_a_box_on_the_floor_throws_the_shadow_of_its_edges():
    scene = objects_and_lamps.Scene(
        (
            objects_and_lamps.Object("floor", objects_and_lamps.floor(3.0, 3), (1.0, 1.0, 1.0), closed=False),
            objects_and_lamps.Object("box", surfaces.box(1.0, 1.0, 1.0).moved(0, 0.5, 0), (1.0, 1.0, 1.0)),
        )
    )
    lamp = objects_and_lamps.Lamp((1.0, 1.0, 0.0), (0.0, 0.0, 0.0), -9.0, 9.0, infinite=True)
    caster = ray_caster.scene_caster(scene)
    above = views.View(
        views.Panel(0, 0, 60, 60),
        objects_and_lamps.Lamp((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), 1.0, 9.0, infinite=True).modelview,
        objects_and_lamps.Lamp(
            (0.0, 5.0, 0.0), (0.0, 0.0, 0.0), 1.0, 9.0, infinite=True, half_width=3.0
        ).projection,
        (0.0, 5.0, 0.0),
        True,
    )
    shown = ray_caster.visible(caster, above)
    x, z = shown.points[..., 0], shown.points[..., 2]
    box = (np.abs(x) < 0.5) & (np.abs(z) < 0.5)
    assert (shown.object == np.where(box, 1, 0)).all()
    np.testing.assert_allclose(shown.points[..., 1], np.where(box, 1.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(shown.depth, np.where(box, 3.0 / 8.0, 0.5), atol=1e-12)
    shadow = (x > -1.5) & (x < -0.5) & (np.abs(z) < 0.5)
    assert (ray_caster.lit(caster, shown, lamp) == ~shadow).all()
    # The floor and the box are two objects: leaving self-shadows out changes nothing here.
    assert (ray_caster.lit(caster, shown, lamp, self_shadows=False) == ~shadow).all()


def test_self_shadows_can_be_left_out():
    surface = surfaces.torus(32, 16).rotated(rotation("x", 90.0))
    scene = objects_and_lamps.Scene((objects_and_lamps.Object("ring", surface, (1.0, 1.0, 1.0)),))
    lamp = objects_and_lamps.Lamp((0.0, 5.0, 1.0), (0.0, 0.0, 0.0), 1.0, 9.0)
    caster = ray_caster.scene_caster(scene)
    shown = ray_caster.visible(caster, views.perspective_view(views.Panel(0, 0, 64, 64), (0.0, 0.0, 6.0)))
    with_shadows, without = (ray_caster.lit(caster, shown, lamp, self_shadows=s) for s in (True, False))
    assert (with_shadows <= without).all()
    assert (without & ~with_shadows).sum() > 20


def test_an_area_light_is_seen_in_parts():
    scene = ball_on_floor()
    lamps = [
        objects_and_lamps.Lamp((x, 9.0, 0.0), (0.0, 0.0, 0.0), 1.0, 20.0) for x in (-2.0, -1.0, 1.0, 2.0)
    ]
    caster = ray_caster.scene_caster(scene)
    shown = ray_caster.visible(
        caster, views.perspective_view(views.Panel(0, 0, 64, 64), (0.0, 6.0, 9.0), radius=7.0)
    )
    parts = ray_caster.seen_fraction(caster, shown, lamps)
    masks = [ray_caster.lit(caster, shown, lamp) for lamp in lamps]
    assert (parts == np.mean(masks, axis=0)).all()
    # Left to right on the floor in front of the ball: lit by all, by some, by none, by some, by all.
    row = parts[shown.object == 0][np.abs(shown.points[shown.object == 0][:, 2] - 0.9) < 0.1]
    assert set(row.tolist()) == {0.0, 0.25, 0.5, 0.75, 1.0}


def test_touching_and_coplanar_triangles_do_not_shadow_each_other():
    corners = (
        np.array([[[0, 0, 0], [0, 0, 1], [1, 0, 0]], [[1, 0, 0], [0, 0, 1], [1, 0, 1]]], np.float64) / 3.0
    )
    weights = np.random.default_rng(1).dirichlet((0.3, 0.3, 0.3), 500)
    points = weights @ corners[0]
    points[:100] = np.round(points[:100], 3)
    up = normalize(cross(corners[0, 1] - corners[0, 0], corners[0, 2] - corners[0, 0]))
    caster = ray_caster.RayCaster(corners)
    directions = up + np.random.default_rng(2).uniform(-5, 5, (500, 3)) * [1.0, 0.0, 1.0]
    assert not caster.occluded(points, directions, triangles=np.zeros(500, np.int64)).any()


def test_triangles_that_are_none_are_refused():
    for triangles in (np.zeros((0, 3, 3)), np.zeros((2, 3)), np.full((1, 3, 3), np.nan)):
        with pytest.raises(ValueError, match="triangle"):
            ray_caster.RayCaster(triangles)


def test_many_triangles_at_one_place_are_still_a_tree():
    corners = np.tile(np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], np.float64), (300, 1, 1))
    hits = ray_caster.RayCaster(corners).nearest(np.array([[0.2, 0.2, 1.0]]), np.array([[0.0, 0.0, -1.0]]))
    assert (hits.triangle[0], hits.distance[0]) == (0, 1.0)


def test_what_is_behind_a_lamp_throws_no_shadow():
    """A lamp between a floor and a plate: the plate hides the floor from a light far away alone."""
    scene = objects_and_lamps.Scene(
        (
            objects_and_lamps.Object("floor", objects_and_lamps.floor(1.0, 1), (1.0, 1.0, 1.0), closed=False),
            objects_and_lamps.Object(
                "plate", surfaces.box(4.0, 0.1, 4.0).moved(0.0, 3.0, 0.0), (1.0, 1.0, 1.0)
            ),
        )
    )
    caster = ray_caster.scene_caster(scene)
    points, up = np.array([[0.3, 0.0, -0.4]]), np.array([[0.0, 1.0, 0.0]])
    for infinite in (False, True):
        lamp = objects_and_lamps.Lamp((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), 0.1, 3.0, infinite=infinite)
        assert ray_caster.lit_points(caster, points, up, lamp).tolist() == [not infinite]
