"""Directions over the sphere: even, whole, and surrounded by three."""

import numpy as np
import pytest

from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.scattering import directions as sphere


@pytest.mark.parametrize("count", [40, 100, 101, 400])
def test_areas_are_even_and_sum_to_the_sphere(count):
    found = sphere.spiral(count)
    areas = sphere.fan_areas(found, sphere.triangulated(found))
    assert abs(areas.sum() - 4.0 * np.pi) < 1e-6
    share = areas / (4.0 * np.pi / count)
    assert share.min() > 0.9 and share.max() < 1.1
    assert (np.abs(dot(found, found) - 1.0) < 1e-12).all()


def test_areas_of_a_cube_are_a_sixth_or_an_eighth():
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / np.sqrt(3.0)
    # A cube's hull has a diagonal on each face, which the nearer parts do not see.
    areas = sphere.fan_areas(corners, sphere.triangulated(corners))
    assert (np.abs(areas - np.pi / 2.0) < 1e-6).all()
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    assert (np.abs(sphere.fan_areas(axes, sphere.triangulated(axes)) - 4.0 * np.pi / 6.0) < 1e-6).all()


def test_three_directions_surround_any_vector():
    found = sphere.spiral(100)
    triangles = sphere.triangulated(found)
    rng = np.random.default_rng(1)
    for vector in normalize(rng.normal(size=(200, 3))):
        three, weights = sphere.surrounding(found, triangles, vector)
        assert abs(weights.sum() - 1.0) < 1e-12 and (weights >= 0.0).all()
        between = (weights[:, None] * found[three]).sum(axis=0)
        assert dot(normalize(between), vector) > 1.0 - 1e-9
        assert sphere.nearest(found, vector) in three or dot(found[three], vector).max() > 0.97
    three, weights = sphere.surrounding(found, triangles, found[7])
    assert three[int(weights.argmax())] == 7 and weights.max() > 1.0 - 1e-9


def test_nonsense_is_refused():
    for count in (0, -1, 2.5, True):
        with pytest.raises(ValueError, match="whole number from 1"):
            sphere.spiral(count)
    with pytest.raises(ValueError, match="at least one"):
        sphere.checked(np.zeros((0, 3)))
    with pytest.raises(ValueError, match="NaN, infinity or a zero vector"):
        sphere.checked([(0.0, 0.0, 0.0)])
    upper = sphere.spiral(60)[:25]
    for few in (upper, sphere.spiral(3), np.eye(3)):
        with pytest.raises(ValueError, match="do not surround"):
            sphere.triangulated(few)
