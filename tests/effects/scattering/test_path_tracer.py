"""Random paths against what all directions together give, furnaces, and points between texels."""

import numpy as np
import pytest

from fixedpipe.effects.geometry.height_fields import texel_centers
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import height_field, light_transport, path_tracer, visibility
from fixedpipe.effects.scattering.path_tracer import Reconstruction

ABOVE = np.array([0.0, 0.0, 1.0])


def at_texels(field):
    s, t = texel_centers(field.columns, field.rows)
    return s.ravel(), t.ravel()


@pytest.mark.parametrize(("lookups", "branches"), [(1, 1), (3, 1), (2, 3)])
def test_random_paths_meet_what_all_directions_gather(lookups, branches):
    field = height_field.domes(16, 16, 2)
    seen = visibility.precompute(field, sphere.spiral(60))
    light = np.array([0.6, 0.0, 0.8])
    gathered = light_transport.bounces(field, seen, light, lookups)
    expected = (gathered[-1] - gathered[0]).mean()
    found = path_tracer.indirect(
        field, seen, *at_texels(field), light, samples=400, lookups=lookups, branches=branches
    )
    noise = np.abs(found.reshape(16, 16, 3) - (gathered[-1] - gathered[0])).mean()
    # Every point has paths of its own, so errors of 256 points average: five standard errors of their mean.
    assert abs(found.mean() - expected) < 5.0 * noise / np.sqrt(256.0)
    assert 0.0 < noise < 0.5 * expected + 0.01


def test_grooves_gain_what_their_form_factor_says():
    field = height_field.ridges(32, 8)
    seen = visibility.precompute(field, sphere.spiral(200))
    found = path_tracer.radiance(field, seen, *at_texels(field), ABOVE, samples=800, lookups=6)
    direct = path_tracer.direct(field, *at_texels(field), ABOVE, reconstruction="nearest")
    # 1 / (1 - rho F), F = 1 - sin 45 degrees; half a percent of it lies beyond six lookups.
    assert found.mean() / direct.mean() == pytest.approx(1.306, rel=0.02)


def test_the_weight_is_needed():
    """Erratum E002.1: without W the indirect light would be a quarter in these units, 1.058 for 1.234."""
    field = height_field.ridges(32, 8)
    seen = visibility.precompute(field, sphere.spiral(200))
    direct = path_tracer.direct(field, *at_texels(field), ABOVE, reconstruction="nearest").mean()
    found = path_tracer.indirect(field, seen, *at_texels(field), ABOVE, samples=400, lookups=1).mean()
    assert 1.0 + found / direct == pytest.approx(1.234, rel=0.02)
    assert 1.0 + found / path_tracer.WEIGHT / direct == pytest.approx(1.058, rel=0.02)


def test_a_furnace_is_white_everywhere():
    """Albedo one and a sky of one: whatever a path meets sends back one, so only the sum of cosines has
    noise.
    """
    field = height_field.domes(16, 16, 2, albedo=1.0)
    seen = visibility.precompute(field, sphere.spiral(400))
    found = path_tracer.indirect(
        field, seen, *at_texels(field), None, samples=4000, lookups=60, sky=np.ones((400, 3))
    )
    # The weight of a path is a product of 4 cos, whose square grows by 8/3 at each lookup: long paths are
    # rare and heavy. Measured, of 4,000 paths a point: 0.03 in the middle, 0.35 at worst.
    assert found.mean() == pytest.approx(1.0, abs=0.01)
    assert np.quantile(np.abs(found - 1.0), 0.9) < 0.1


def test_light_is_carried_both_ways_alike():
    """Texel p lights texel q as q lights p, times albedo: of two patches, each lit alone in turn."""
    field = height_field.ridges(16, 16, count=1, left=(0.8,) * 3, right=(0.5,) * 3)
    seen = visibility.precompute(field, sphere.spiral(400))
    left, right = np.zeros((16, 16), bool), np.zeros((16, 16), bool)
    left[:, 2:6], right[:, 10:14] = True, True
    light = ABOVE

    def carried(source, receiver):
        found = path_tracer.indirect(
            field, seen, *at_texels(field), light, samples=2000, lookups=1, lit=source
        ).reshape(16, 16, 3)
        return found[receiver].mean() / field.albedo[receiver].mean() / field.albedo[source].mean()

    # Both patches have one area and one cosine towards the light; 400 directions and 2,000 paths: 3 %.
    assert carried(left, right) == pytest.approx(carried(right, left), rel=0.05)


def test_light_does_not_grow():
    field = height_field.domes(16, 16, 2, albedo=0.9)
    seen = visibility.precompute(field, sphere.spiral(100))
    means = [
        path_tracer.indirect(field, seen, *at_texels(field), ABOVE, samples=300, lookups=n).mean()
        for n in range(6)
    ]
    assert means[0] == 0.0
    steps = np.diff(means)
    assert (steps > 0.0).all() and (steps[1:] < steps[:-1]).all()


def test_points_between_texels_have_their_squares_or_their_mean():
    field = height_field.domes(8, 8, 1)
    seen = visibility.precompute(field, sphere.spiral(60))
    settings = {"samples": 50, "lookups": 2, "seed": 5}
    # Four points of one texel's square, and its centre: all are one point of the random numbers each.
    s, t = (np.full(1, 2.5 / 8), np.full(1, 3.5 / 8))
    at_centre = path_tracer.indirect(field, seen, s, t, ABOVE, reconstruction="nearest", **settings)
    for ds, dt in ((0.4, 0.4), (-0.4, 0.3), (0.2, -0.4)):
        near = path_tracer.indirect(
            field, seen, s + ds / 8, t + dt / 8, ABOVE, reconstruction="nearest", **settings
        )
        assert (near == at_centre).all()
    smooth = path_tracer.indirect(field, seen, s, t, ABOVE, **settings)
    assert np.abs(smooth - at_centre).max() < 1e-12
    corners = [
        path_tracer.indirect(field, seen, s + a / 8, t + b / 8, ABOVE, reconstruction="nearest", **settings)
        for a, b in ((0, 0), (1, 0), (0, 1), (1, 1))
    ]
    middle = path_tracer.indirect(field, seen, s + 0.5 / 8, t + 0.5 / 8, ABOVE, **settings)
    assert np.abs(middle - np.mean(corners, axis=0)).max() < 1e-12


def test_any_number_of_threads_gives_the_same():
    field = height_field.domes(32, 32, 2)
    seen = visibility.precompute(field, sphere.spiral(40))
    settings = {"samples": 5, "lookups": 2}
    one, three = (
        path_tracer.indirect(field, seen, *at_texels(field), ABOVE, threads=n, **settings) for n in (1, 3)
    )
    assert (one == three).all()
    assert (one != path_tracer.indirect(field, seen, *at_texels(field), ABOVE, seed=1, **settings)).any()


def test_highlights_are_those_of_dependent_tests():
    field = height_field.height_field(height_field.domes(12, 12, 1).heights, 0.5, specular=0.4, exponent=8)
    light = np.array([0.48, 0.36, 0.8])
    s, t = at_texels(field)
    found = path_tracer.direct(field, s, t, light, lit=1.0, reconstruction=Reconstruction.NEAREST)
    assert np.abs(found.reshape(12, 12, 3) - light_transport.bump(field, light, ABOVE)).max() < 1e-12
    seen = visibility.precompute(field, sphere.spiral(80))
    expected = light_transport.scattered(field, seen, light_transport.sequences(80, 1, 80), light)
    total = path_tracer.radiance(field, seen, s, t, light, samples=2000, lookups=1)
    # Measured: 0.4 %.
    assert total.mean() == pytest.approx(expected.mean(), rel=0.02)


def test_no_paths_are_refused():
    field = height_field.domes(4, 4, 1)
    seen = visibility.precompute(field, sphere.spiral(10))
    for wrong in ({"samples": 0}, {"branches": 0}, {"lookups": -1}):
        with pytest.raises(ValueError, match="give one path"):
            path_tracer.indirect(field, seen, np.zeros(1), np.zeros(1), ABOVE, **wrong)
    assert Reconstruction("nearest") is Reconstruction.NEAREST
    with pytest.raises(ValueError, match="cubic"):
        path_tracer.indirect(field, seen, np.zeros(1), np.zeros(1), ABOVE, reconstruction="cubic")
