"""The sky's light and a turning base's against the sums that they are made of."""

import numpy as np
import pytest

from fixedpipe.effects.geometry.vectors import dot, from_frame, in_frame, normalize
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import environment_light, height_field, light_transport, visibility
from fixedpipe.effects.scattering.visibility import FREE

WORLD = (np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0]))


def white(directions):
    return np.ones(directions.shape)


def above(directions):
    """A sky that is one above the horizon and black below."""
    return np.repeat((directions[:, 1:2] > 0.0).astype(np.float64), 3, axis=1)


def test_a_flat_base_has_the_sun_that_dependent_tests_have():
    field = height_field.domes(16, 16, 2)
    seen = visibility.precompute(field, sphere.spiral(60))
    light = normalize(np.array([0.4, 0.8, 0.3]))
    sun, sky = environment_light.sun_and_sky(field, seen, WORLD, light, (1.0, 1.0, 1.0), above, 2)
    local = in_frame(light, *WORLD)
    assert np.abs(sun - light_transport.bounces(field, seen, local, 2)[2]).max() < 1e-12
    assert (sky > 0.0).any() and sky.max() < 1.0
    turned = (-WORLD[0], WORLD[1], -WORLD[2])
    dark, _ = environment_light.sun_and_sky(field, seen, turned, light, (1.0, 1.0, 1.0), above, 2)
    assert (dark == 0.0).all()


def test_a_white_field_under_a_white_sky_is_white_after_many_reflections():
    field = height_field.domes(16, 16, 2, albedo=1.0)
    seen = visibility.precompute(field, sphere.spiral(400))
    _, sky = environment_light.sun_and_sky(field, seen, WORLD, (0.0, 1.0, 0.0), (0.0,) * 3, white, 60)
    # The cosines of 400 directions sum to one within 2 %, which every reflection multiplies.
    assert np.abs(sky - 1.0).max() < 0.06


@pytest.mark.parametrize("frame", [WORLD, (WORLD[0], np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))])
def test_places_of_one_frame_are_what_a_flat_base_has(frame):
    """On a direction that is known, light and shadow are exact; the sky's table is asked at its own
    heights.
    """
    field = height_field.domes(16, 16, 2, albedo=(0.8, 0.5, 0.3))
    found = sphere.spiral(60)
    seen = visibility.precompute(field, found)
    made = environment_light.tiles(field, seen, 2)
    number = 11
    assert found[number, 2] > 0.3
    light = from_frame(found[number], *frame)
    texels = np.arange(256)
    frames = tuple(np.tile(axis, (256, 1)) for axis in frame)
    table = np.ones((2, 3)) * np.array([[0.0], [1.0]])
    sun, scattered, sky = environment_light.on_turning_base(field, seen, made, texels, frames, light, table)
    expected = light_transport.bounces(field, seen, found[number], 2)
    facing = np.maximum(dot(field.normals, found[number]), 0.0) * (seen.seen[number] == FREE)
    assert np.abs(sun.reshape(16, 16, 3) - field.albedo * facing[..., None]).max() < 1e-9
    assert np.abs(scattered.reshape(16, 16, 3) - (expected[2] - expected[0])).max() < 1e-9
    # A sky that grows with height from 0 to 1: the mean over free directions, and what even light gains.
    heights = 0.5 + 0.5 * from_frame(found, *frame)[:, 1:2] * np.ones(3)
    black = np.zeros((16, 16, 3))
    first = field.albedo * light_transport.gathered(field, seen, black, heights)
    assert np.abs(sky.reshape(16, 16, 3) - first * made.again.reshape(16, 16, 3)).max() < 1e-4
    assert (made.again >= 1.0).all() and made.again.max() > 1.05


def test_light_from_below_lights_nothing():
    field = height_field.domes(8, 8, 1)
    seen = visibility.precompute(field, sphere.spiral(40))
    made = environment_light.tiles(field, seen, 1)
    frames = tuple(np.tile(axis, (64, 1)) for axis in WORLD)
    sun, scattered, sky = environment_light.on_turning_base(
        field, seen, made, np.arange(64), frames, (0.0, -1.0, 0.0), np.zeros((2, 3))
    )
    assert not sun.any() and not scattered.any() and not sky.any()
