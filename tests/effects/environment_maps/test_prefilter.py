"""H25 and H29: filtered environments beside sums over all texels."""

import numpy as np
import pytest

from fixedpipe.effects.environment_maps import environments, prefilter
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.scattering.directions import spiral

TOWARD = spiral(40)


def sums(cube, exponent, toward):
    """The filter by a sum over all texels of the map as it is."""
    size = cube.shape[1]
    directions = cube_maps.directions(size).reshape(-1, 3)
    weights = np.broadcast_to(cube_maps.solid_angles(size), (6, size, size)).reshape(-1, 1)
    lobes = np.maximum(directions @ toward.T, 0.0) ** exponent * weights
    return lobes.T @ cube.reshape(-1, 3) / lobes.sum(axis=0)[:, None]


@pytest.mark.parametrize("exponent", (1.0, 3.5, 40.0, 100.0))
def test_a_filtered_room_is_the_sum_over_all_its_texels(exponent):
    room = environments.room(cube_maps.directions(128))
    found = prefilter.phong(room, exponent, 96)
    texels = cube_maps.directions(96)[::2, 5::30, 7::30].reshape(-1, 3)
    seen = found[::2, 5::30, 7::30].reshape(-1, 3)
    np.testing.assert_allclose(seen, sums(room, exponent, texels), atol=0.5 / 255.0)


def test_a_point_keeps_its_lobe_across_faces_edges():
    point = np.zeros((6, 256, 256, 3))
    point[4, 100:102, -2:] = 900.0
    found = prefilter.phong(point, 100.0)
    for face, row, column in ((4, 100, 255), (4, 90, 240), (0, 100, 0), (0, 110, 8)):
        expected = sums(point, 100.0, cube_maps.directions(256)[face, row, column][None])[0]
        np.testing.assert_allclose(found[face, row, column], expected, atol=0.01 * found.max())


@pytest.mark.parametrize("exponent", (0.01, 1.0, 100.0, 4000.0, prefilter.LARGEST_EXPONENT))
@pytest.mark.parametrize("size", (1, 6))
def test_a_constant_map_stays_constant(exponent, size):
    level = np.broadcast_to((0.1, 0.37, 900.0), (6, size, size, 3))
    found = prefilter.phong(level, exponent, 5)
    np.testing.assert_allclose(found, np.broadcast_to(level[0, 0, 0], found.shape), rtol=1e-12)


def test_a_cosine_of_a_bright_half_is_known_in_closed_form():
    half = np.zeros((6, 64, 64, 3))
    toward = cube_maps.directions(64)
    half[toward[..., 1] > 0.0] = 1.0
    found = cube_maps.look_up(prefilter.cosine(half, 32), TOWARD)
    # Irradiance under a hemisphere that leans: (1 + cos)/2 of it.
    np.testing.assert_allclose(found[:, 0], 0.5 + 0.5 * TOWARD[:, 1], atol=0.01)


def test_any_number_of_threads_gives_the_same_bits():
    room = environments.room(cube_maps.directions(32))
    one = prefilter.phong(room, 20.0, 40, threads=1)
    np.testing.assert_array_equal(prefilter.phong(room, 20.0, 40, threads=3), one)


def test_what_is_no_map_or_exponent_is_refused_with_what_is_allowed():
    good = np.ones((6, 4, 4, 3))
    for exponent in (0, -1, float("nan"), "shiny", 1e9, None):
        with pytest.raises(ValueError, match=r"The exponent is .* give a number"):
            prefilter.phong(good, exponent)
    for bad in (np.ones((5, 4, 4, 3)), np.ones((6, 4, 3, 3)), np.ones((6, 0, 0, 3)), good * np.nan):
        with pytest.raises(ValueError, match="The cube map"):
            prefilter.phong(bad, 10)
    with pytest.raises(ValueError, match="size"):
        prefilter.phong(good, 10, 0)
    with pytest.raises(ValueError, match="threads"):
        prefilter.phong(good, 10, threads=0)
