"""The virtual goniometer: energy, reciprocity, a flat field's answer, and pictures against texture space."""

import math

import numpy as np
import pytest

from fixedpipe.effects.scattering import goniometer
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.height_field import bumps, domes, height_field, ridges
from fixedpipe.effects.scattering.visibility import FREE, precompute

DIRECTIONS = spiral(200)


def measured(field, count=8, bounces=3, **more):
    views, solid_angles = goniometer.grid(count)
    seen = precompute(field, DIRECTIONS)
    return goniometer.brdf(field, seen, views, views, bounces, **more), views, solid_angles


def test_a_flat_field_has_albedo_over_pi():
    field = height_field(np.zeros((4, 6)), (0.8, 0.5, 0.1))
    found, views, solid_angles = measured(field, 4)
    assert np.abs(found - np.array([0.8, 0.5, 0.1]) / math.pi).max() < 1e-12
    assert np.abs(goniometer.albedos(found, views, solid_angles)[:, 0] - 0.8).max() < 1e-5


def test_flat_triangles_in_pictures_too():
    field = height_field(np.zeros((4, 6)), 0.5)
    views, _ = goniometer.grid(3)
    shares = goniometer.shares_in_pictures(field, views)
    assert np.abs(shares.reshape(9, -1).sum(axis=1) - 1.0).max() < 1e-12
    assert np.abs(shares - 1.0 / 24.0).max() < 0.02


@pytest.mark.parametrize("field", [bumps(32, 32), domes(32, 32, 2)], ids=["bumps", "domes"])
def test_what_is_sent_back_is_less_than_what_comes(field):
    found, views, solid_angles = measured(field)
    sent = goniometer.albedos(found, views, solid_angles)
    # The albedo is 0.8. Measured: 0.797 and 0.805; what is gathered along 200 directions is the noise.
    assert sent.max() < 0.808
    assert sent.min() > 0.6


def test_more_reflections_send_back_more_and_black_sends_nothing():
    field = ridges(32, 2, 50.0, 1)
    once, *_ = measured(field, 4, 0)
    often, *_ = measured(field, 4, 3)
    assert (often >= once).all() and often.mean() > 1.1 * once.mean()
    assert not measured(field.with_albedo(0.0), 4)[0].any()


@pytest.mark.parametrize(
    ("field", "mean"),
    [(bumps(32, 32), 0.0005), (domes(32, 32, 2), 0.01), (ridges(64, 2, 45.0, 1), 0.01)],
    ids=["bumps", "domes", "ridges"],
)
def test_light_and_view_may_change_places(field, mean):
    found, views, _ = measured(field)
    steep = views[:, 2] > 0.3
    found = found[steep][:, steep]
    turned = found.transpose(1, 0, 2)
    # Measured: 0.0002, 0.005, 0.002 of the mean; direct light has none, as the next test has it.
    assert (np.abs(found - turned) / (0.5 * (found + turned))).mean() < mean


def test_direct_light_is_the_same_in_either_order_and_keeps_its_energy():
    field = domes(32, 32, 2)
    found, views, _ = measured(field, bounces=0)
    lit = goniometer.lights(field, precompute(field, DIRECTIONS), views, 0).any(axis=(1, 2, 3))
    assert lit.all()
    assert np.abs(found - found.transpose(1, 0, 2)).max() < 1e-12
    irradiance = goniometer.irradiance(field, views)
    # Measured: 0.039; texels' normals are not their triangles', and shadows end at texels.
    assert np.abs(irradiance / views[:, 2] - 1.0)[views[:, 2] > 0.3].max() < 0.06


@pytest.mark.parametrize(
    ("field", "mean"),
    [(bumps(32, 32), 0.005), (domes(32, 32, 2), 0.02), (ridges(64, 2, 45.0, 1), 0.02)],
    ids=["bumps", "domes", "ridges"],
)
def test_pictures_and_texture_space_agree(field, mean):
    found, views, _ = measured(field)
    in_pictures, *_ = measured(field, shares=goniometer.shares_in_pictures(field, views))
    steep = views[:, 2] > 0.3
    # Measured: 0.002, 0.011, 0.010 of the mean.
    assert np.abs(in_pictures / found - 1.0)[steep][:, steep].mean() < mean


def test_without_masking_texture_space_is_another_thing():
    field = domes(32, 32, 2)
    found, views, _ = measured(field)
    in_pictures, *_ = measured(field, shares=goniometer.shares_in_pictures(field, views))
    everything = goniometer.shares_in_texture_space(field, views, np.ones((len(views), 32, 32)))
    unmasked, *_ = measured(field, shares=everything)
    low = views[:, 2] < 0.4
    masked_error, error = (np.abs(each / in_pictures - 1.0)[:, low].mean() for each in (found, unmasked))
    # Measured: 0.023 and 0.185.
    assert error > 2.0 * masked_error, (error, masked_error)


def test_a_picture_shows_one_flank_where_the_other_is_masked():
    field = ridges(64, 2, 60.0, 1)
    seen = goniometer.picture(field, (0.9, 0.0, math.sqrt(0.19)), 64)
    # The flank that faces +s is the right half.
    assert (seen % 64 >= 31).all()
    assert set(np.unique(goniometer.picture(field, (0.0, 0.0, 1.0), 64) % 64)) == set(range(64))


def test_a_ray_meets_the_triangle_that_it_meets_in_exact_arithmetic():
    # A pyramid of one texel's centre among zeros: rays straight down, and one that comes in from the side.
    heights = np.zeros((4, 4))
    heights[2, 1] = 1.0
    field = height_field(heights)
    place = np.array([[(1 + 0.5) / 4, (2 + 0.5) / 4, 2.0], [0.9, 0.1, 2.0], [(3.2 + 0.5) / 4, 2.5 / 4, 1.5]])
    along = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, -1.0], [-0.5, 0.0, -1.0]])
    assert goniometer.first_texels(field, place, along).tolist() == [2 * 4 + 1, 0 * 4 + 3, 2 * 4 + 1]
    assert goniometer.first_texels(field, place, -along).tolist() == [goniometer.NOTHING] * 3


def test_any_mask_is_taken_and_another_shape_refused():
    field = bumps(8, 8)
    views, _ = goniometer.grid(2)
    shares = goniometer.shares_in_texture_space(field, views, np.ones((4, 8, 8)))
    assert np.abs(shares.reshape(4, -1).sum(axis=1) - 1.0).max() < 1e-12
    with pytest.raises(ValueError, match="one for each view"):
        goniometer.shares_in_texture_space(field, views, np.ones((3, 8, 8)))
    with pytest.raises(ValueError, match="Nothing of the field is seen"):
        goniometer.shares_in_texture_space(field, views, np.zeros((4, 8, 8)))


def test_near_the_horizon_something_is_seen():
    field = bumps(16, 16)
    grazing = np.array([[1.0, 0.3, 1e-4]])
    shares = goniometer.shares_in_texture_space(field, grazing)
    assert shares.sum() == pytest.approx(1.0)
    # The highest texels.
    seen = field.heights[shares[0] > 0.0]
    assert seen.min() > 0.8 * field.heights.max()


def test_highlights_are_added_where_the_light_is_mirrored():
    field = height_field(np.zeros((2, 2)), 0.2, specular=0.5, exponent=32.0)
    tilted = np.array([[0.6, 0.0, 0.8]])
    mirrored = np.array([[-0.6, 0.0, 0.8], [0.6, 0.0, 0.8]])
    found = goniometer.brdf(field, precompute(field, DIRECTIONS), tilted, mirrored)
    assert found[0, 0, 0] == pytest.approx((0.2 * 0.8 + 0.5) / (math.pi * 0.8))
    assert found[0, 1, 0] == pytest.approx(0.2 / math.pi, abs=1e-3)


@pytest.mark.parametrize("direction", [(0.0, 0.0, -1.0), (1.0, 0.0, 0.0)])
def test_a_direction_below_the_horizon_is_refused(direction):
    field = bumps(8, 8)
    with pytest.raises(ValueError, match="not above the horizon"):
        goniometer.brdf(field, precompute(field, DIRECTIONS), [direction], [(0.0, 0.0, 1.0)])


def test_a_grid_covers_the_hemisphere():
    directions, solid_angles = goniometer.grid(5)
    assert solid_angles.sum() == pytest.approx(2.0 * math.pi)
    assert (directions[:, 2] > 0.0).all() and len(directions) == 25
    with pytest.raises(ValueError, match="1 or more"):
        goniometer.grid(0)


def test_a_highlight_in_the_shadow_is_none():
    field = ridges(32, 2, 60.0, 1)
    field = height_field(field.heights, 0.0, normals=field.normals, specular=0.5, exponent=2.0)
    light, view = np.array([[0.8, 0.0, 0.6]]), np.array([[0.0, 0.0, 1.0]])
    shares = goniometer.shares_in_texture_space(field, view)
    half = (light[0] + view[0]) / math.sqrt(3.2)
    shine = 0.5 * np.maximum(field.normals @ half, 0.0) ** 2 * (field.normals @ light[0] > 0.0) * shares[0]
    free = precompute(field, light).seen[0] == FREE
    assert shine[free].sum() < 0.9 * shine.sum()
    found = goniometer.highlights(field, light, view, shares)
    assert found[0, 0] == pytest.approx([shine[free].sum()] * 3)


def test_where_no_texel_s_centre_is_lit_the_irradiance_is_the_cosine():
    lights = np.array([[0.6, 0.0, 0.8], [0.0, 0.0, 1.0]])
    found = goniometer.irradiance(bumps(8, 8), lights, np.zeros((2, 8, 8)))
    assert found.tolist() == lights[:, 2].tolist()


@pytest.mark.parametrize("along_t", [False, True])
@pytest.mark.parametrize(("start", "way", "texel"), [(0.75, 1.0, 6), (0.25, -1.0, 25)])
def test_a_ray_that_begins_above_a_flank_meets_the_next_one(along_t, start, way, texel):
    """Downhill along a flank of 45 degrees from 0.01 above it, falling by a tenth: 0.26 - x / 10 = x - 0.25,
    so 0.464 periods on, beyond the valley at the field's edge.
    """
    heights = ridges(32, 32, 45.0, 1).heights
    field = height_field(np.ascontiguousarray(heights.T) if along_t else heights)
    origin, along = [start, 0.3, 0.26], [way, 0.0, -0.1]
    if along_t:
        origin[:2], along[:2] = origin[1::-1], along[1::-1]
    expected = texel * 32 + 9 if along_t else 9 * 32 + texel
    assert goniometer.first_texels(field, [origin], along).tolist() == [expected]
