"""Document 001's lake: waves that tile and come back, the moon, the water's mesh against the plane."""

import numpy as np
import pytest

from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.schilling_1997.shared import lake as the
from fixedpipe.effects.geometry import cube_maps

LAKE = the.Lake(slope=0.05, period=0.5, moon=5.0, brightness=2.5)


def test_waves_are_back_at_time_one_and_not_before():
    first, half, last = (the.waves(32, time) for time in (0.0, 0.5, 1.0))
    np.testing.assert_array_equal(first, last)
    assert np.abs(half - first).max() > 0.1


def test_waves_have_the_slopes_that_are_asked_for():
    top = the.pyramids(LAKE, 64)[-1]
    assert 0.5 * float(top.covariance[0, 0, 0] + top.covariance[0, 0, 2]) == pytest.approx(0.05**2)
    assert np.abs(top.offsets).max() <= 1e-12


def test_the_moon_is_two_degrees_wide_and_as_bright_as_asked():
    cube = the.environment(LAKE, 256)[0]
    moon = np.maximum(cube[..., 0] - 0.2, 0.0) / (LAKE.brightness - 0.2)
    weight = cube_maps.solid_angles(256) * moon
    assert float(weight.sum()) == pytest.approx(np.pi * np.radians(1.0) ** 2, rel=0.1)
    assert cube.max() == LAKE.brightness
    toward = (cube_maps.directions(256) * weight[..., None]).reshape(-1, 3).sum(axis=0)
    assert np.degrees(np.arctan2(toward[1], -toward[2])) == pytest.approx(5.0, abs=0.05)


def test_calm_water_shows_the_moon_where_it_is_looked_for():
    calm = the.Lake(slope=0.0, period=0.5, moon=5.0, brightness=2.5)
    view = the.SUBJECT.at_origin(96)
    picture = the.answer(calm, view, Antialiasing.NONE)
    row, column = the.mirrored_moon(view, 5.0)
    y, x = np.nonzero(picture[the.rows_of_water(view)].min(axis=-1) > 0.5)
    assert abs(y.mean() - row) <= 1.0
    assert abs(x.mean() + 0.5 - column) <= 1.0


def test_the_column_and_fine_changes_of_known_pictures():
    view = the.SUBJECT.at_origin(64)
    picture = np.zeros((64, view.panel.width, 3))
    assert the.fine_energy(picture, view) == 0.0
    picture[5:25, 30:34] = 1.0
    assert the.column(picture, view) == (20, 4)
    slow = np.broadcast_to(np.cos(2.0 * np.pi * np.arange(85) / 85.0)[:, None], picture.shape)
    fast = np.broadcast_to(np.cos(2.0 * np.pi * 30.0 * np.arange(85) / 85.0)[:, None], picture.shape)
    assert the.fine_energy(fast, view) > 1e6 * the.fine_energy(slow, view)


def test_the_water_covers_the_picture_below_the_horizon():
    view = the.SUBJECT.at_origin(64)
    surface = the.water(view, 0.5)
    x, z = surface.positions[:, 0], -surface.positions[:, 2]
    half = np.tan(np.radians(0.5 * the.FIELD_OF_VIEW)) * view.panel.width / view.panel.height
    # Rays of the picture's side edges are as far aside as they are ahead along the view, at the most.
    assert (np.abs(x) >= half * z * np.sqrt(1.0 + the.DROP**2)).all()
    assert z.min() < 1.0 / np.tan(np.radians(0.5 * the.FIELD_OF_VIEW) + the.DROP)
    np.testing.assert_allclose(surface.texture_coordinates, np.stack([x, z], axis=-1) / 0.5)
