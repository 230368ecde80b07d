"""An environment as directional lights: nothing of its power is lost, and surfaces are lit as by the map."""

import numpy as np
import pytest

from fixedpipe.effects.environment_maps import environments
from fixedpipe.effects.environment_maps.environment_lights import lights_of
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.scattering.directions import spiral

SIZE = 16
ROOM = environments.room(cube_maps.directions(SIZE))


def irradiance(cube, normals):
    """What white surfaces send back, summed over all texels: float64 [n, 3]."""
    toward = cube_maps.directions(cube.shape[1]).reshape(-1, 3)
    weight = np.broadcast_to(cube_maps.solid_angles(cube.shape[1]), cube.shape[:3]).ravel() / np.pi
    return np.maximum(normals @ toward.T, 0.0) @ (weight[:, None] * cube.reshape(-1, 3))


@pytest.mark.parametrize("count", [1, 2, 7, 64])
def test_no_power_is_lost(count):
    found = lights_of(ROOM, count)
    assert len(found.directions) == count
    whole = (cube_maps.solid_angles(SIZE)[None, ..., None] / np.pi * ROOM).sum(axis=(0, 1, 2))
    assert found.irradiance.sum(axis=0) == pytest.approx(whole, rel=1e-12)
    assert np.abs((found.directions**2).sum(axis=1) - 1.0).max() < 1e-12


def test_the_more_lights_the_nearer_a_surface_s_light_is_to_the_map_s():
    normals = spiral(200)
    truth, errors = irradiance(ROOM, normals), []
    for count in (4, 16, 64, 256):
        found = lights_of(ROOM, count)
        lit = np.maximum(normals @ found.directions.T, 0.0) @ found.irradiance
        errors.append(np.abs(lit - truth).max() / truth.mean())
    assert errors == sorted(errors, reverse=True)
    # Measured: 0.86, 0.12, 0.023, 0.0042.
    assert errors[1] < 0.2 and errors[-1] < 0.01


def test_a_single_texel_is_one_light_in_its_direction():
    cube = np.zeros((6, SIZE, SIZE, 3))
    cube[3, 5, 9] = 2.0, 1.0, 0.5
    found = lights_of(cube, 8)
    assert found.directions.shape == (1, 3)
    assert found.directions[0] == pytest.approx(cube_maps.directions(SIZE)[3, 5, 9], abs=1e-15)
    expected = np.array((2.0, 1.0, 0.5)) * cube_maps.solid_angles(SIZE)[5, 9] / np.pi
    assert found.irradiance[0] == pytest.approx(expected, rel=1e-15)


def test_groups_have_about_the_same_power():
    power = lights_of(np.ones((6, 32, 32, 3)), 64).irradiance[:, 0]
    assert power.max() / power.min() < 1.1


def test_texels_that_face_each_other_have_a_light_all_the_same():
    cube = np.zeros((6, 1, 1, 3))
    cube[:2] = 1.0
    found = lights_of(cube, 1)
    assert abs(found.directions[0, 0]) == 1.0


@pytest.mark.parametrize(
    ("cube", "count", "words"),
    [
        (np.zeros((6, 4, 4, 3)), 4, "is black"),
        (np.full((6, 4, 4, 3), -1.0), 4, "below zero"),
        (np.full((6, 4, 4, 3), np.nan), 4, "NaN"),
        (np.zeros((5, 4, 4, 3)), 4, "shape"),
        (ROOM, 0, "0 lights"),
    ],
)
def test_what_is_no_environment_is_refused(cube, count, words):
    with pytest.raises(ValueError, match=words):
        lights_of(cube, count)
