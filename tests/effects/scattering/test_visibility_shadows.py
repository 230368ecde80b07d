"""G12 and G13: along its own directions S_i is what rays say; between them weights; lights of texels' own."""

import numpy as np
import pytest

from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import height_field, visibility, visibility_shadows
from fixedpipe.effects.scattering.visibility import BACK, FREE, Visibility


@pytest.fixture(scope="module")
def domes():
    field = height_field.domes(24, 24, 2)
    return field, visibility.precompute(field, sphere.spiral(100))


@pytest.mark.parametrize("counts", [True, False])
def test_along_a_direction_of_the_set_both_are_the_rays(domes, counts):
    field, seen = domes
    for i in (0, 13, 30, 47):
        rays = visibility.precompute(field, seen.directions[i : i + 1]).seen[0]
        expected = rays == FREE if counts else rays < 0
        np.testing.assert_array_equal(
            visibility_shadows.nearest_free(seen, seen.directions[i], counts), expected
        )
        share = visibility_shadows.free_share(seen, seen.directions[i], None, counts)
        np.testing.assert_allclose(share, expected, atol=1e-9)


def test_the_three_around_a_light_are_one_vector_s():
    directions = sphere.spiral(60)
    triangles = sphere.triangulated(directions)
    vectors = normalize(np.random.default_rng(2).standard_normal((200, 3)))
    numbers, weights = visibility_shadows.surroundings(directions, triangles, vectors)
    for k, vector in enumerate(vectors):
        one, own = sphere.surrounding(directions, triangles, vector)
        np.testing.assert_array_equal(numbers[k], one)
        np.testing.assert_allclose(weights[k], own, atol=1e-12)


def test_the_share_is_the_weights_of_the_free_ones():
    directions = sphere.spiral(40)
    triangles = sphere.triangulated(directions)
    light = normalize(np.array((0.3, 0.2, 0.9)))
    numbers, weights = sphere.surrounding(directions, triangles, light)
    seen = np.full((40, 1, 4), 0, np.int32)
    seen[numbers[0], 0, 1:] = FREE
    seen[numbers[1], 0, 2] = BACK
    seen[numbers, 0, 3] = BACK
    some = Visibility(directions, seen)
    strict = visibility_shadows.free_share(some, light, triangles, turned_away_counts=True)
    np.testing.assert_allclose(strict[0], (0.0, weights[0], weights[0], 0.0), atol=1e-12)
    rest = visibility_shadows.free_share(some, light, triangles)
    np.testing.assert_allclose(
        rest[0], (0.0, weights[0], weights[0] / (weights[0] + weights[2]), 1.0), atol=1e-12
    )


def test_a_light_for_each_texel(domes):
    _, seen = domes
    lights = normalize(np.random.default_rng(5).uniform((-1.0, -1.0, 0.2), (1.0, 1.0, 2.2), (24, 24, 3)))
    lights[:2] = lights[0, 0]
    triangles = sphere.triangulated(seen.directions)
    near = visibility_shadows.nearest_free(seen, lights)
    share = visibility_shadows.free_share(seen, lights, triangles)
    for row, column in ((0, 0), (1, 20), (7, 3), (23, 11)):
        one = visibility_shadows.nearest_free(seen, lights[row, column])
        assert near[row, column] == one[row, column]
        soft = visibility_shadows.free_share(seen, lights[row, column], triangles)
        assert share[row, column] == pytest.approx(soft[row, column], abs=1e-12)


@pytest.mark.parametrize("azimuth", [0.3, 1.9, 4.0])
def test_agreement_with_rays_on_grooves(azimuth):
    """The catalogue's bound for V-grooves."""
    field = height_field.ridges(32, 32, 45.0)
    seen = visibility.precompute(field, sphere.spiral(200))
    light = normalize(np.array((np.cos(azimuth), np.sin(azimuth), 0.8)))
    rays = visibility.precompute(field, light[None]).seen[0]
    faces = rays != BACK
    for told in (
        visibility_shadows.nearest_free(seen, light),
        visibility_shadows.free_share(seen, light) > 0.5,
    ):
        assert (told == (rays == FREE))[faces].mean() >= 0.85


def test_bad_lights_are_said(domes):
    _, seen = domes
    for function in (visibility_shadows.nearest_free, visibility_shadows.free_share):
        with pytest.raises(ValueError, match=r"light has shape \(2,\); give \[3\], or \(24, 24, 3\)"):
            function(seen, (0.0, 1.0))
        with pytest.raises(ValueError, match="zero, NaN or infinite"):
            function(seen, (0.0, 0.0, 0.0))
    half = Visibility(seen.directions[:40], seen.seen[:40])
    with pytest.raises(ValueError, match="do not surround the origin"):
        visibility_shadows.free_share(half, (0.0, 0.0, 1.0))
