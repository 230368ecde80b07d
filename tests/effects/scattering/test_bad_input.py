"""What no field, light, ray or picture has is said in a sentence, before a kernel looks it up."""

import math

import numpy as np
import pytest

from fixedpipe.effects.scattering import (
    curved_base,
    ellipses,
    environment_light,
    goniometer,
    harmonics,
    height_field,
    horizon_maps,
    light_field,
    light_transport,
    path_tracer,
    visibility,
    visibility_shadows,
)
from fixedpipe.effects.scattering import directions as sphere

FIELD, LARGER = height_field.bumps(8, 8), height_field.bumps(16, 16)
DIRECTIONS = sphere.spiral(20)
SEEN, OTHER = visibility.precompute(FIELD, DIRECTIONS), visibility.precompute(LARGER, DIRECTIONS)
LIGHT, NO_LIGHT = np.array([0.6, 0.0, 0.8]), (math.nan, 0.0, 1.0)
ONE = np.ones((8, 8, 3))
TILES = environment_light.tiles(FIELD, SEEN, 1)
FRAMES = tuple(np.tile(axis, (2, 1)) for axis in np.eye(3))
SKY = np.ones((4, 3))
BENT = curved_base.bend(FIELD, SEEN, curved_base.Base((0.1, 0.0)))
UP = [(0.0, 0.0, 1.0)]


def indirect(seen=SEEN, s=(0.5,), t=(0.5,), light=LIGHT, **more):
    return path_tracer.indirect(FIELD, seen, s, t, light, **more)


def turning(texels=(0, 1), frames=FRAMES, light=LIGHT, sky=SKY, field=FIELD, seen=SEEN):
    return environment_light.on_turning_base(field, seen, TILES, np.array(texels), frames, light, sky)


@pytest.mark.parametrize(
    "call",
    [
        lambda: light_transport.gathered(FIELD, OTHER, ONE),
        lambda: light_transport.gathered(LARGER, SEEN, np.ones((16, 16, 3))),
        lambda: light_transport.bounces(FIELD, OTHER, LIGHT, 1),
        lambda: light_transport.chain(FIELD, OTHER, [0], LIGHT, LIGHT),
        lambda: visibility.distances(FIELD, OTHER),
        lambda: visibility.distances(LARGER, SEEN),
        lambda: indirect(OTHER),
        lambda: turning(seen=OTHER),
        lambda: goniometer.lights(FIELD, OTHER, UP),
        lambda: curved_base.bend(FIELD, OTHER, curved_base.Base((0.1, 0.0))),
    ],
)
def test_another_field_s_visibility_is_refused(call):
    with pytest.raises(ValueError, match="give what precompute makes of this field"):
        call()


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: light_transport.gathered(FIELD, SEEN, ONE[:2]), r"give \[8, 8, k\]"),
        (lambda: light_transport.gathered(FIELD, SEEN, ONE[..., 0]), r"give \[8, 8, k\]"),
        (lambda: light_transport.gathered(FIELD, SEEN, ONE, SKY), r"sky has shape \(4, 3\); give \(20, 3\)"),
        (lambda: light_transport.gathered(FIELD, SEEN, ONE, np.ones(3)), "sky has shape"),
        (lambda: light_transport.bounces(FIELD, SEEN, NO_LIGHT, 1, lit=1.0), "three finite numbers"),
        (lambda: light_transport.chain(FIELD, SEEN, [20], LIGHT, LIGHT), "direction 20; give numbers from 0"),
        (lambda: light_transport.scattered(FIELD, SEEN, np.zeros((0, 1), int), LIGHT), "There are no paths"),
        (lambda: indirect(sky=SKY), r"sky has shape \(4, 3\); give \(20, 3\)"),
        (lambda: indirect(light=NO_LIGHT, lit=1.0), "light's direction is .*three finite numbers"),
        (lambda: indirect(view=(0.0, 1.0)), "direction to the eye is .*three finite numbers"),
        (lambda: indirect(s=[math.nan]), "finite numbers"),
        (lambda: indirect(s=[1e300]), "finite numbers"),
        (lambda: indirect(s=[0.1, 0.2]), r"shapes \(2,\) and \(1,\)"),
        (lambda: indirect(seed=-1), "whole numbers from 0 on"),
        (lambda: indirect(samples=2.5), "whole numbers from 0 on"),
        (lambda: indirect(seed=2**70), r"below 2\^63"),
        (lambda: indirect(seed=math.nan), "whole numbers from 0 on"),
        (lambda: turning(frames=[math.nan * axis for axis in FRAMES]), "frames hold NaN"),
        (lambda: curved_base.bounces(FIELD, BENT, NO_LIGHT, 1), "give finite unit vectors"),
        (lambda: curved_base.bounces(FIELD, BENT, NO_LIGHT, 1, np.ones((8, 8))), "give finite unit vectors"),
        (lambda: curved_base.free_share(FIELD, BENT, (0.0, 1.0)), r"shape \(2,\)"),
        (lambda: turning((10**9, 0)), "from 0 to 63"),
        (lambda: turning((-(10**9), 0)), "from 0 to 63"),
        (lambda: turning((0, 1, 2)), "The frames have shapes"),
        (lambda: turning(sky=SKY[:1]), "two heights or more"),
        (lambda: turning(light=(0.0, 1.0)), "three finite numbers"),
        (lambda: turning(field=LARGER, seen=OTHER), "tiles are of another field"),
        (lambda: goniometer.means(np.ones((1, 8, 8)), np.ones((1, 4, 4, 3))), "of one field"),
        (lambda: goniometer.lights(FIELD, SEEN, UP, -1), "-1 bounces"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(call, match):
    with pytest.raises(ValueError, match=match):
        call()


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: goniometer.first_texels(FIELD, [(0, 0, 1)], NO_LIGHT), "NaN or infinity"),
        (lambda: goniometer.first_texels(FIELD, [(0, 0, math.inf)], (0, 0.1, -1)), "NaN or infinity"),
        (lambda: goniometer.first_texels(FIELD, [(1e300, 0, 1)], (0, 0.1, -1)), "periods of the field"),
        (lambda: goniometer.first_texels(FIELD, [(0, 0, 1)], (1, 0, -1e-12)), "periods of the field"),
        (lambda: goniometer.first_texels(FIELD, [(0, 0)], (0, 0, -1)), r"shapes \(1, 2\) and \(3,\)"),
        (lambda: goniometer.picture(FIELD, (1, 0, 1e-12), 8), "give steeper ones"),
        (lambda: light_field.seen_from(FIELD, (math.nan, 0.5, 1.0), 4), "NaN or infinity"),
        (lambda: light_field.seen_from(FIELD, (0.5, 0.5, math.inf), 4), "highest point"),
        (lambda: light_field.simulated(FIELD, ONE, 2, 4, spread=math.nan), "give a positive number"),
        (lambda: light_field.simulated(FIELD, ONE, 2, 4, spread=1e12), "periods of the field"),
        (lambda: light_field.simulated(FIELD, ONE[:4], 2, 4), r"light has shape \(4, 8, 3\)"),
        (lambda: light_field.simulated(FIELD, ONE, 2.5, 4), "a whole number"),
        (lambda: light_field.simulated(FIELD, ONE, 2, 4).at(math.nan, 0.5), "give two numbers"),
    ],
)
def test_rays_that_would_not_end_are_refused(call, match):
    with pytest.raises(ValueError, match=match):
        call()


@pytest.mark.parametrize("size", [0, -1, 2.5, math.nan])
def test_pictures_without_pixels_are_refused(size):
    for call in (goniometer.picture, light_field.seen_from):
        with pytest.raises(ValueError, match="give a whole number from 1 on"):
            call(FIELD, (0.1, 0.1, 1.0), size)
    with pytest.raises(ValueError, match="give a whole number from 1 on"):
        goniometer.shares_in_pictures(FIELD, UP, size)


@pytest.mark.parametrize("length", [1e-200, 1e300])
def test_directions_that_have_no_length_are_refused(length):
    direction = (length, 0.0, length)
    for call in (
        lambda: visibility.precompute(FIELD, [direction]),
        lambda: visibility.free_view(FIELD, direction),
        lambda: visibility_shadows.nearest_free(SEEN, direction),
    ):
        with pytest.raises(ValueError, match="too long or too short"):
            call()


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: harmonics.fitted([NO_LIGHT], UP, np.ones((1, 3))), "NaN"),
        (lambda: harmonics.fitted(*np.zeros((3, 0, 3))), "at least one"),
        (lambda: harmonics.random_pairs(0), "from 1 on"),
        (lambda: goniometer.grid(2.5), "a whole number"),
        (lambda: goniometer.grid(math.nan), "a whole number"),
        (lambda: horizon_maps.horizon_map(FIELD, 3.5), "a whole number"),
        (lambda: horizon_maps.neighbours(NO_LIGHT), "three finite numbers"),
        (lambda: ellipses.fit(np.ones((5, 2, 2), bool), np.full((5, 2), 1e200)), "beyond the unit disc"),
        (lambda: curved_base.Base((1e300, 0.0)), "of at most 1e"),
        (lambda: curved_base.Base(stretch=(1e-300, 1.0)), "of at most 1e"),
        (lambda: sphere.spiral(math.inf), "whole number from 1 on"),
        (lambda: sphere.spiral(math.nan), "whole number from 1 on"),
    ],
)
def test_numbers_without_a_meaning_are_refused(call, match):
    with pytest.raises(ValueError, match=match):
        call()
