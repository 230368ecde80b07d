"""A sun that moves lights a field as it would if all were computed anew, to the bit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.geometry.vectors import in_frame, normalize
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import (
    environment_light,
    height_field,
    light_transport,
    turning_sun,
    visibility,
)

WORLD = (np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0]))
SUN = (1.25, 1.17, 1.0)


def rough(rows, columns, depth, seed):
    random = np.random.default_rng(seed)
    albedo = random.random((rows, columns, 3))
    return height_field.height_field(depth * random.random((rows, columns)), albedo)


@given(
    st.sampled_from([(8, 8), (4, 32), (33, 7), (150, 3)]),
    st.sampled_from([0.0, 0.01, 0.2, 50.0]),
    st.tuples(*[st.sampled_from([-1.0, -0.37, -1e-3, 0.0, 1e-9, 0.25, 1.0])] * 2),
    st.sampled_from([1e-4, 0.02, 0.3, 1.0, 8.0]),
    st.integers(0, 3),
    st.integers(0, 5),
)
@settings(max_examples=60)
def test_the_sun_is_what_all_directions_and_whole_rays_give(shape, depth, along, up, bounces, seed):
    field = rough(*shape, depth, seed)
    seen = visibility.precompute(field, sphere.spiral(30))
    light = normalize(np.array([along[0], up, along[1]]))
    expected = environment_light.sun_alone(field, seen, WORLD, light, SUN, bounces)
    known = turning_sun.prepared(field, seen)
    found = turning_sun.sunlit(known, in_frame(light, *WORLD), SUN, bounces)
    assert np.array_equal(found, expected)


def test_shadows_and_scattered_light_are_among_what_is_compared():
    field = rough(16, 16, 0.2, 1)
    seen = visibility.precompute(field, sphere.spiral(30))
    light = normalize(np.array([0.5, -0.7, 0.4]))
    found = [turning_sun.sunlit(turning_sun.prepared(field, seen), light, SUN, n) for n in (0, 1, 2)]
    free = visibility.free_view(field, light)
    assert 0.2 < free.mean() < 0.8
    assert (found[0][~free] == 0.0).all() and (found[1][~free] > 0.0).any()
    assert (found[2] >= found[1]).all() and found[2].sum() > found[1].sum()


def test_a_sun_below_the_horizon_lights_nothing():
    field = rough(8, 8, 0.2, 1)
    known = turning_sun.prepared(field, visibility.precompute(field, sphere.spiral(30)))
    assert not turning_sun.sunlit(known, (0.6, 0.0, -0.8), SUN, 3).any()


def test_what_is_no_direction_or_of_another_field_is_refused():
    field = rough(8, 8, 0.2, 1)
    seen = visibility.precompute(field, sphere.spiral(30))
    with pytest.raises(ValueError, match="The sun's direction"):
        turning_sun.sunlit(turning_sun.prepared(field, seen), (0.0, np.nan, 1.0), SUN, 1)
    with pytest.raises(ValueError, match="give what precompute makes of this field"):
        turning_sun.prepared(rough(8, 9, 0.2, 1), seen)


def test_a_texels_list_has_what_it_sees_in_the_directions_order():
    field = rough(6, 5, 0.5, 2)
    seen = visibility.precompute(field, sphere.spiral(30))
    known = turning_sun.prepared(field, seen)
    for texel in range(30):
        row, column = divmod(texel, 5)
        every = [i for i in range(30) if seen.seen[i, row, column] >= 0]
        listed = known.seen[known.first[texel] : known.first[texel + 1]]
        assert listed.tolist() == [seen.seen[i, row, column] for i in every]
    assert known.weight == light_transport.WEIGHT / 30
