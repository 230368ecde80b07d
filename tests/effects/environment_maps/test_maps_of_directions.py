"""Cube maps and parabolic maps of floats: texels, solid angles, lookups."""

import math

import numpy as np
import pytest

from fixedpipe.effects.geometry import cube_maps, parabolic_maps
from fixedpipe.effects.scattering.directions import spiral


@pytest.mark.parametrize("size", (1, 3, 64))
def test_the_solid_angles_of_a_cube_map_are_those_of_the_arc_tangents(size):
    edge = np.linspace(-1.0, 1.0, size + 1)
    s, t = np.meshgrid(edge, edge)
    corner = np.arctan2(s * t, np.sqrt(s * s + t * t + 1.0))
    exact = corner[1:, 1:] - corner[1:, :-1] - corner[:-1, 1:] + corner[:-1, :-1]
    np.testing.assert_allclose(cube_maps.solid_angles(size), exact, rtol=1e-7)


def test_a_direction_is_found_where_its_texel_lies():
    toward = cube_maps.directions(9)
    face, s, t = cube_maps.places(7.0 * toward)
    assert (face == np.arange(6)[:, None, None]).all()
    edge = 2.0 * (np.arange(9) + 0.5) / 9 - 1.0
    np.testing.assert_allclose(s, np.broadcast_to(edge, s.shape), atol=1e-15)
    np.testing.assert_allclose(t, np.broadcast_to(edge[:, None], s.shape), atol=1e-15)
    np.testing.assert_allclose(cube_maps.look_up(toward, toward), toward, atol=1e-15)


@pytest.mark.parametrize("size", (1, 2, 7))
def test_a_lookup_is_the_line_between_the_texels_that_places_names(size):
    cube = np.sin(np.arange(6.0 * size * size * 2)).reshape(6, size, size, 2)
    # Halves of whole numbers: components that are equal, zero and negative zero among them.
    toward = np.stack(np.meshgrid(*[[-1.0, -0.5, -0.0, 0.0, 0.3, 1.0]] * 3), axis=-1).reshape(-1, 3)
    toward = toward[toward.any(axis=-1)]
    expected = []
    for face, *place in zip(*cube_maps.places(toward), strict=True):
        at = [min(max(0.5 * (p + 1.0) * size - 0.5, 0.0), size - 1.0) for p in place]
        low = [min(int(a), max(size - 2, 0)) for a in at]
        (u, v), (s, t) = ([a - b for a, b in zip(at, low, strict=True)], low)
        rows = cube[face, [t, min(t + 1, size - 1)]]
        lower, upper = rows[:, s] + u * (rows[:, min(s + 1, size - 1)] - rows[:, s])
        expected.append(lower + v * (upper - lower))
    found = cube_maps.look_up(cube, toward)
    assert found.tobytes() == np.array(expected).tobytes()


@pytest.mark.parametrize("bad", (0.0, math.nan, math.inf))
def test_a_direction_that_points_nowhere_is_refused(bad):
    with pytest.raises(ValueError, match="zero, NaN or infinite"):
        cube_maps.look_up(np.zeros((6, 2, 2, 3)), [(1.0, 0.0, 0.0), (0.0, bad, 0.0)])


def test_an_environment_is_equal_to_another_of_the_same_cube_map():
    cube = np.ones((6, 2, 2, 3))
    assert cube_maps.Seen(cube) == cube_maps.Seen(cube) != cube_maps.Seen(cube.copy())
    assert hash(cube_maps.Seen(cube)) == hash(cube_maps.Seen(cube))


def test_maps_of_directions_give_directions_back():
    toward = spiral(2000)
    # Beyond the outermost centres a face holds still: half of a texel of 2/64.
    assert np.abs(cube_maps.look_up(cube_maps.directions(64), toward) - toward).max() <= 1.0 / 64
    # So does a disc, where its edge touches the map's.
    assert np.abs(parabolic_maps.look_up(parabolic_maps.directions(64), toward) - toward).max() <= 1.0 / 64


def test_parabolic_texels_and_coordinates_are_inverse():
    toward = parabolic_maps.directions(33)
    inside = parabolic_maps.inside(33)
    disc, st = parabolic_maps.coordinates(3.0 * toward)
    centres = (np.arange(33) + 0.5) / 33
    s, t = np.meshgrid(centres, centres)
    # The middle of the edge, z = 0, is the first disc's.
    within = inside & (np.abs(toward[0, ..., 2]) > 1e-9)
    for k in (0, 1):
        assert (disc[k][within] == k).all()
        np.testing.assert_allclose(st[k][within], np.stack([s, t], axis=-1)[within], atol=1e-15)
    np.testing.assert_allclose(toward[0, 16, 16], (0.0, 0.0, -1.0))
    area = 2.0 * parabolic_maps.solid_angles(256)[parabolic_maps.inside(256)].sum()
    assert area == pytest.approx(4.0 * math.pi, rel=1e-3)


@pytest.mark.parametrize("reach", (1.0, 0.8))
def test_the_texture_matrix_makes_the_coordinates(reach):
    toward = spiral(200)
    disc, st = parabolic_maps.coordinates(toward, reach)
    for k in (0, 1):
        found = (
            np.concatenate([toward, np.ones((200, 1))], axis=1) @ np.array(parabolic_maps.matrix(k, reach)).T
        )
        np.testing.assert_allclose((found[:, :2] / found[:, 3:])[disc == k], st[disc == k], atol=1e-14)
        # Directions of the other hemisphere lie beyond the disc.
        beyond = found[disc != k, :2] / found[disc != k, 3:] - 0.5
        assert np.hypot(*beyond.T).min() >= 0.5 * reach


def test_what_a_map_with_a_margin_holds_is_found_again():
    reach = parabolic_maps.margin(64, 6)
    assert reach == 1.0 - 12.0 / 64.0
    toward = spiral(2000)
    discs = parabolic_maps.directions(64, reach)
    # A chord of two texels, whose angle is at most 4/(64 reach).
    assert np.abs(parabolic_maps.look_up(discs, toward, reach) - toward).max() <= 0.0015


@pytest.mark.parametrize("size", (0, -1, 2.5, True))
def test_sizes_are_whole_numbers_from_one_on(size):
    with pytest.raises(ValueError, match="whole number of texels"):
        cube_maps.directions(size)
    with pytest.raises(ValueError, match="parabolic map's size"):
        parabolic_maps.directions(size)
