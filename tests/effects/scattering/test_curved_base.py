"""A height field on a bent or stretched base: against the flat one, closed forms, and rays among bent
triangles.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance.bent_caster import BentCaster
from fixedpipe.effects.geometry.vectors import cross, dot
from fixedpipe.effects.scattering import curved_base, height_field, light_transport, visibility
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering.curved_base import Base
from fixedpipe.effects.scattering.visibility import BACK, FREE

LIGHT = height_field.check_light((0.5, 0.2, 0.8))


def groove(texels=32, rows=2):
    """One ridge a period with flanks of 45 degrees, white, its heights from their middle."""
    field = height_field.ridges(texels, rows, 45.0, 1, (1.0, 1.0, 1.0))
    return replace(field, heights=field.heights - 0.25)


def form_factor(base):
    """What a flank of the groove gets of the other's light, by crossed strings between the mapped peaks and
    valley: the flanks meet there and are equally long.
    """
    peak, valley = base.placed([(0.5, 0.0, 0.25), (0.0, 0.0, -0.25)])
    x, _, z = (peak - valley).tolist()
    return 1.0 - x / math.hypot(x, z)


def exchange(field, bent):
    """The mean of what the flank that faces -s gets where all send one."""
    out = curved_base.gathered(field, bent, np.ones((*field.heights.shape, 3)))[..., 0]
    return float(out[field.normals[..., 0] < 0.0].mean())


def test_no_curvature_is_the_flat_base_to_the_bit():
    field = height_field.domes(12, 16, 2)
    seen = visibility.precompute(field, sphere.spiral(60))
    for weights in (curved_base.border_weights, curved_base.fan_weights):
        bent = curved_base.bend(field, seen, Base(), weights)
        assert (bent.directions == seen.directions[:, None, None]).all()
        assert (bent.weights == 1.0).all()
        assert (bent.normals == field.normals).all()
    lit = visibility.free_view(field, LIGHT)
    flat = light_transport.bounces(field, seen, LIGHT, 3, lit=lit)
    for expected, found in zip(flat, curved_base.bounces(field, bent, LIGHT, 3, lit), strict=True):
        assert (expected == found).all()


def test_bent_points_lie_on_circles_round_the_center_of_curvature():
    points = np.array([(x, y, h) for x in (-1.0, 0.1, 2.0) for y in (0.0, 0.7) for h in (-0.2, 0.0, 0.3)])
    for k in (-0.9, -1e-3, 0.4, 1.0):
        x, _, h = points.T
        found = Base((k, 0.0)).placed(points)
        radius, angle = 1.0 / k + h, k * x
        assert np.allclose(found[:, 0], radius * np.sin(angle), atol=1e-12 / abs(k))
        assert np.allclose(found[:, 2], radius * np.cos(angle) - 1.0 / k, atol=1e-12 / abs(k))
        assert (found[:, 1] == points[:, 1]).all()
        # A sphere where both are equal.
        from_center = Base((k, k)).placed(points) + np.array([0.0, 0.0, 1.0 / k])
        assert np.allclose(np.sqrt(dot(from_center, from_center)), np.abs(radius), atol=1e-12 / abs(k))


def test_a_small_curvature_loses_no_digits():
    x, h = 0.7, 0.2
    for k in (1e-4, 1e-8, 1e-12, 1e-300):
        along, _, fallen = Base((k, 0.0)).added(np.array(x), np.array(0.0), np.array(h)).tolist()
        assert along == pytest.approx(k * h * x, rel=2 * k + 1e-12)
        assert fallen == pytest.approx(-0.5 * k * x * x, rel=2 * k + 1e-12)


def test_frames_are_the_maps_own():
    base, at = Base((0.6, -0.3), (1.5, 0.8)), np.array([0.3, -0.4])
    t, b, n = base.frames(*at)
    assert np.allclose(cross(t, b), n, atol=1e-14)
    step = 1e-6
    for axis, move in ((t, (step, 0.0, 0.0)), (n, (0.0, 0.0, step))):
        here = np.array([*at, 0.0])
        slope = base.placed(here + move) - base.placed(here - np.array(move))
        assert np.allclose(slope / np.sqrt(dot(slope, slope)), axis, atol=1e-6)
    # A light above the middle leans away where a convex base has turned from it.
    assert Base((0.5, 0.0)).local((0.0, 0.0, 1.0), 0.2, 0.0)[0] == pytest.approx(-math.sin(0.1), abs=1e-12)


def test_directions_turn_by_half_of_curvature_times_distance_at_either_end():
    """The chord leaves p lower by half the angle between the normals at p and q, and arrives lower by as
    much.
    """
    for k in (0.02, 0.1, -0.1):
        base = Base((k, 0.0))
        for x in (0.2, 0.5, 1.0):
            (turned,) = curved_base.moved(base, np.array([(1.0, 0.0, 0.0)]), np.array([x]), np.array(0.0))
            at_p = math.asin(-turned[2])
            at_q = math.asin(-float(dot(-turned, base.frames(x, 0.0)[2])))
            assert at_p == pytest.approx(0.5 * k * x, rel=0.01)
            assert at_p + at_q == pytest.approx(k * x, rel=0.01)


@pytest.mark.parametrize("weights", [curved_base.border_weights, curved_base.fan_weights])
def test_weighted_areas_are_the_sphere(weights):
    field = groove(16)
    seen = visibility.precompute(field, sphere.spiral(100))
    for curvature in (-0.2, 0.2, 0.5):
        bent = curved_base.bend(field, seen, Base((curvature, 0.3 * curvature)), weights)
        areas = sphere.fan_areas(seen.directions, bent.triangles)
        total = (bent.weights * areas[:, None, None]).sum(axis=0)
        assert np.abs(total - 4.0 * math.pi).max() < 1e-3
        assert bent.weights.min() > 0.0


def test_a_grooves_exchange_is_the_closed_forms():
    field = groove(64)
    seen = visibility.precompute(field, sphere.spiral(400))
    found = {
        k: exchange(field, curved_base.bend(field, seen, Base((k, 0.0))))
        for k in (-0.5, -0.25, -0.1, 0.0, 0.1, 0.25, 0.5)
    }
    assert sorted(found.values(), reverse=True) == list(found.values())
    assert found[0.0] == pytest.approx(1.0 - math.sin(math.radians(45.0)), rel=0.02)
    by_rays = {
        k: exchange(field, BentCaster(field, Base((k, 0.0)), (1, 6)).bent(seen.directions)) for k in found
    }
    for k, value in found.items():
        assert value == pytest.approx(by_rays[k], rel=0.08)
    # Rays beside crossed strings: texels are even in s, not along the bent flank, which matters little here.
    for k in (-0.1, 0.0, 0.1):
        assert by_rays[k] == pytest.approx(form_factor(Base((k, 0.0))), rel=0.03)


def test_borders_that_move_find_most_of_the_change_and_fans_half():
    field = groove()
    seen = visibility.precompute(field, sphere.spiral(200))

    def change(weights):
        ends = [curved_base.bend(field, seen, Base((k, 0.0)), weights) for k in (-0.1, 0.1)]
        return exchange(field, ends[0]) - exchange(field, ends[1])

    casters = [BentCaster(field, Base((k, 0.0)), (1, 6)) for k in (-0.1, 0.1)]
    truth = np.subtract(*(exchange(field, c.bent(sphere.spiral(800))) for c in casters))
    # Measured: 0.75 and 0.36.
    assert 0.65 < change(curved_base.border_weights) / truth < 1.0
    assert 0.25 < change(curved_base.fan_weights) / truth < 0.5


def test_a_stretched_groove_is_one_with_other_flanks():
    field = groove()
    seen = visibility.precompute(field, sphere.spiral(400))
    for s in (0.6, 1.0, 1.5, 2.0):
        bent = curved_base.bend(field, seen, Base(stretch=(s, 1.0)))
        assert exchange(field, bent) == pytest.approx(1.0 - s / math.hypot(s, 1.0), rel=0.03)
        assert np.allclose(np.abs(bent.normals[0, 3]), (1 / math.hypot(1, s), 0.0, s / math.hypot(1, s)))


def test_both_axes_are_alike():
    field = height_field.bumps(12, 12)
    turned = replace(
        field,
        heights=np.ascontiguousarray(field.heights.T),
        normals=np.ascontiguousarray(np.swapaxes(field.normals, 0, 1)[..., [1, 0, 2]]),
    )
    directions = sphere.spiral(80)
    bent = curved_base.bend(field, visibility.precompute(field, directions), Base((0.3, 0.0), (1.2, 1.0)))
    seen = visibility.precompute(turned, directions[:, [1, 0, 2]])
    other = curved_base.bend(turned, seen, Base((0.0, 0.3), (1.0, 1.2)))
    assert np.abs(bent.directions - np.swapaxes(other.directions, 1, 2)[..., [1, 0, 2]]).max() < 1e-12
    assert np.abs(bent.weights - np.swapaxes(other.weights, 1, 2)).max() < 1e-6


def test_what_is_seen_stays_where_curvature_is_small():
    """Measured with 32 texels, 100 directions: at curvatures of +-0.1 97.6 % of what was seen or free is so
    on the bent base, at +-0.5 79 %.
    """
    field = groove()
    seen = visibility.precompute(field, sphere.spiral(100))
    for k, least in ((0.0, 0.999), (0.1, 0.97), (-0.1, 0.97), (0.5, 0.9), (-0.5, 0.75)):
        base = Base((k, 0.0))
        truly = BentCaster(field, base, (2, 6)).seen(curved_base.bend(field, seen, base).directions)
        apart = np.abs(truly % 32 - seen.seen % 32)
        near = (truly >= 0) & (np.minimum(apart, 32 - apart) <= 1)
        assert near[seen.seen >= 0].mean() >= least
        assert (truly == FREE)[seen.seen == FREE].mean() >= least


def test_light_arrives_where_rays_say():
    field = height_field.domes(24, 24, 2)
    seen = visibility.precompute(field, sphere.spiral(200))
    for base in (Base(), Base((0.2, 0.1)), Base((-0.2, -0.2)), Base(stretch=(1.5, 0.8))):
        bent = curved_base.bend(field, seen, base)
        share = curved_base.free_share(field, bent, LIGHT)
        assert ((share >= 0.0) & (share <= 1.0)).all()
        truth = BentCaster(field, base, (2, 2)).lit(LIGHT)
        facing = dot(bent.normals, LIGHT) > 0.0
        assert ((share > 0.5) == (truth > 0.5))[facing].mean() > 0.93
        assert share.mean() == pytest.approx(truth.mean(), abs=0.04)


def test_rays_among_flat_triangles_see_what_is_stored():
    field = height_field.bumps(12, 16)
    seen = visibility.precompute(field, sphere.spiral(40))
    found = BentCaster(field, Base(), (6, 6)).seen(seen.directions)
    assert ((found == BACK) == (seen.seen == BACK)).all()
    # The rest leaves below a triangle that is steeper than the texel's normal says, or ends between texels.
    assert (found == seen.seen).mean() > 0.96


def test_bases_that_are_none_are_refused():
    with pytest.raises(ValueError, match=r"curvature is .*; give two finite numbers"):
        Base((math.nan, 0.0))
    with pytest.raises(ValueError, match=r"stretch is .*; give two finite numbers"):
        Base(stretch=(1.0,))
    with pytest.raises(ValueError, match=r"stretch is .*; give two positive numbers"):
        Base(stretch=(1.0, 0.0))
    field = groove(8)
    seen = visibility.precompute(field, sphere.spiral(20))
    with pytest.raises(ValueError, match="curvature is -6, and the field's heights reach its centre"):
        curved_base.bend(field, seen, Base((0.0, -6.0)))
    upper = visibility.precompute(field, sphere.spiral(40)[:15])
    with pytest.raises(ValueError, match="do not surround the origin"):
        curved_base.bend(field, upper, Base((0.1, 0.0)))


def test_normals_are_those_of_the_bent_surface():
    """Beside the cross product of two steps along the bent surface, in the frame at the texel."""
    slopes = np.array([[0.5, -0.3], [-0.8, 0.6]])
    flat = np.concatenate([-slopes, np.ones((2, 1))], axis=1)
    flat /= np.sqrt(dot(flat, flat))[:, None]
    heights = np.array([[0.3, -0.2], [0.1, 0.4]])
    field = height_field.height_field(heights, normals=np.stack([flat, flat]))
    base, step = Base((0.9, -0.6), (1.3, 0.7)), 1e-6
    found = curved_base.bent_normals(field, base)
    for row in range(2):
        for column in range(2):
            h, (a, b) = heights[row, column], slopes[column]
            u, v = (
                np.subtract(base.placed((x, y, h + up)), base.placed((-x, -y, h - up)))
                for x, y, up in ((step, 0.0, step * a), (0.0, step, step * b))
            )
            expected = cross(u, v) / np.sqrt(dot(cross(u, v), cross(u, v)))
            assert found[row, column] == pytest.approx(expected, abs=1e-6)


def test_of_triangles_that_lie_over_each_other_the_one_with_the_nearest_point_counts():
    field = height_field.height_field(np.zeros((2, 2)))
    corners = np.array([(1.0, 0.0, 1.0), (-1.0, 1.0, 1.0), (-1.0, -1.0, 1.0)])
    corners /= np.sqrt(dot(corners, corners))[:, None]
    flat, shape = np.concatenate([corners, corners]), (6, 2, 2)
    near = np.zeros(shape, np.int32)
    near[3:] = FREE
    far = np.where(near == FREE, np.inf, 0.1)
    for triangles in ([[0, 1, 2], [3, 4, 5]], [[3, 4, 5], [0, 1, 2]]):
        bent = curved_base.Bent(
            Base(), np.tile(flat[:, None, None], (1, 2, 2, 1)), np.ones(shape), field.normals,
            np.array(triangles), flat, near, far,
        )  # fmt: skip
        assert (curved_base.free_share(field, bent, np.array([0.0, 0.0, 1.0])) == 0.0).all()


def test_how_far_away_things_are_says_what_hides_them():
    field = groove(16)
    seen = visibility.precompute(field, sphere.spiral(60))
    far = curved_base.bend(field, seen, Base((0.1, 0.0))).far
    assert (far[seen.seen == BACK] == 0.0).all() and np.isposinf(far[seen.seen == FREE]).all()
    assert ((far > 0.0) & np.isfinite(far))[seen.seen >= 0].all()


def test_what_has_folded_over_counts_nothing():
    """A direction whose point is near turns past its neighbours, which see nothing and stay."""
    directions = sphere.spiral(100)
    triangles = sphere.triangulated(directions)
    far = np.full((100, 1), np.inf)
    number = int(sphere.nearest(directions, (1.0, 0.0, 0.3)))
    far[number] = 1.0
    base, heights = Base((2.5, 0.0)), np.zeros(1)
    turned = curved_base.moved(base, directions, far, heights)[number, 0]
    assert int(sphere.nearest(directions, turned)) != number
    weights = curved_base.border_weights(base, directions, triangles, far, heights)
    assert (weights >= 0.0).all() and (weights == 0.0).any()


def test_a_mesh_s_frames_are_the_base_s():
    bumpy = height_field.bumps(8, 8, height=0.1)
    surface = curved_base.bent_surface(bumpy, Base((0.4, -0.2)), (0, 8), (0, 8))
    frames = surface.tangents, surface.binormals, surface.normals
    for k, axis in enumerate(frames):
        assert np.allclose(dot(axis, axis), 1.0, atol=1e-9)
        assert np.abs(dot(axis, frames[(k + 1) % 3])).max() < 1e-9
        # Bumps of a tenth and so little curvature turn no axis far from the world's.
        assert axis[:, k].min() > 0.5
    assert np.allclose(cross(surface.tangents, surface.binormals), surface.normals, atol=1e-9)
