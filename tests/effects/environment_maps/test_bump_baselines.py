"""S10 and S20: normals of an ellipse, and the change from bumps to a BRDF at its two ends."""

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.environment_maps import bump_baselines, rough_mirrors
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.views import Panel, perspective_view

MIRROR = rough_mirrors.Mirror(period=2.0)


def noise(*shape, seed=1):
    """Numbers from -1 to 1."""
    count = np.arange(int(np.prod(shape)))
    return (hashed(count, count // 7, seed) / 32768.0 - 1.0).reshape(shape)


@pytest.fixture(scope="module")
def scene():
    view = perspective_view(Panel(0, 0, 20, 16), (0.1, 1.0, 0.0), (0.0, 0.7, -1.0), 50.0)
    cubes = rough_mirrors.cube_pyramid(0.5 + 0.5 * noise(6, 16, 16, 3, seed=4))
    return view, MIRROR, rough.pyramid(0.1 * noise(16, 16, 2)), cubes


@pytest.mark.parametrize("count", [16, 64, 256])
def test_the_points_are_normally_distributed(count):
    points = bump_baselines.normal_points(count)
    assert np.abs(points.mean(axis=0)).max() <= 2.0 / count
    covariance = rough.products(points).mean(axis=0)
    # The last ring ends where 1 - 1/(2 count) of the distribution lies within, and has one point.
    assert np.abs(covariance - [1.0, 0.0, 1.0]).max() <= 5.0 / count
    inside = (points * points).sum(axis=-1) <= 1.0
    assert abs(inside.mean() - (1.0 - np.exp(-0.5))) <= 1.0 / count


def test_without_roughness_every_normal_sees_the_same(scene):
    view, mirror, levels, cubes = scene
    flat = tuple(rough.Level(level.offsets, np.zeros_like(level.covariance)) for level in levels)
    traced = bump_baselines.traced(view, mirror, flat, cubes, 5)
    one = rough_mirrors.picture(view, mirror, flat, cubes, Antialiasing.ISOTROPIC)
    assert np.abs(traced - one).max() <= 1e-9


def test_an_environment_of_one_colour_stays_it(scene):
    view, mirror, levels, _ = scene
    plain = rough_mirrors.cube_pyramid(np.broadcast_to([0.25, 0.5, 0.75], (6, 4, 4, 3)))
    for found in (
        bump_baselines.traced(view, mirror, levels, plain, 3),
        bump_baselines.switched(view, mirror, levels, plain),
    ):
        assert np.abs(found - [0.25, 0.5, 0.75]).max() <= 1e-12


def test_the_change_begins_with_bumps_and_ends_with_the_brdf(scene):
    view, mirror, levels, cubes = scene
    bumps = rough_mirrors.picture(view, mirror, levels, cubes, Antialiasing.NONE)
    assert np.array_equal(bump_baselines.switched(view, mirror, levels, cubes, 50.0, 60.0), bumps)
    lobe = bump_baselines.switched(view, mirror, levels, cubes, -2.0, -1.0)
    whole = rough.pyramid(levels[-1].offsets, levels[-1].covariance)
    expected = rough_mirrors.picture(view, mirror, whole, cubes)
    assert np.abs(lobe - expected).max() <= 1e-12
    between = bump_baselines.switched(view, mirror, levels, cubes, 0.0, 4.0)
    assert (between >= np.minimum(bumps, lobe) - 1e-12).all()
    assert (between <= np.maximum(bumps, lobe) + 1e-12).all()


def test_what_makes_no_sense_is_refused(scene):
    with pytest.raises(ValueError, match="one or more"):
        bump_baselines.traced(*scene, count=0)
    with pytest.raises(ValueError, match="higher one"):
        bump_baselines.switched(*scene, first=2.0, last=2.0)
