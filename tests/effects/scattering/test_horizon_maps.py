"""Horizon maps: against rays, against a slow search, analytic grooves, and the machine's marks."""

import math

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import unit_vector
from fixedpipe.effects.geometry.views import orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, LATER_PASS, MARKED, NEAREST, draw
from fixedpipe.effects.scattering import ellipse_passes, height_field, horizon_maps, visibility
from fixedpipe.effects.scattering.visibility import BACK, FREE
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL

SIZE = 32


def random_field(seed, rows=9, columns=12):
    return height_field.height_field(np.random.default_rng(seed).uniform(0.0, 0.2, (rows, columns)))


def surface_height(heights, x, y):
    """The triangulated field at texel coordinates."""
    rows, columns = heights.shape
    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    a, b = heights[j % rows, i % columns], heights[j % rows, (i + 1) % columns]
    c, d = heights[(j + 1) % rows, (i + 1) % columns], heights[(j + 1) % rows, i % columns]
    return a + u * (b - a) + v * (c - b) if u >= v else a + v * (d - a) + u * (c - d)


def test_no_point_of_the_field_stands_above_the_horizon_and_one_touches_it():
    field = random_field(4)
    rows, columns = field.heights.shape
    found = horizon_maps.horizon_map(field)
    for k, (ax, ay) in enumerate(horizon_maps.azimuths()):
        for row, column in ((0, 0), (3, 5), (8, 11)):
            z0, best = field.heights[row, column], 0.0
            for step in range(1, 6000):
                t = step / 2000.0
                height = surface_height(field.heights, column + t * ax * columns, row + t * ay * rows)
                best = max(best, (height - z0) / t)
            exact = found.tangents[k, row, column]
            assert exact >= best - 1e-9
            assert exact - best < 0.03 * max(best, 0.1)


@pytest.mark.parametrize("seed", [1, 2])
def test_along_its_azimuths_it_is_what_rays_say(seed):
    field = random_field(seed, 16, 16)
    found = horizon_maps.horizon_map(field)
    for k, (x, y) in enumerate(horizon_maps.azimuths()):
        for tangent in (0.15, 0.4, 0.9):
            length = math.sqrt(1.0 + tangent * tangent)
            seen = visibility.precompute(field, [(x / length, y / length, tangent / length)]).seen[0]
            clear = np.abs(found.tangents[k] - tangent) > 1e-9
            faces = (seen != BACK) & clear
            assert faces.any()
            np.testing.assert_array_equal((found.tangents[k] < tangent)[faces], (seen == FREE)[faces])


def test_a_groove_s_horizon_is_its_ridge():
    """From a texel of a groove of 45 degrees its ridges stand as high as they are above it over how far."""
    field = height_field.ridges(32, 4, 45.0, count=1)
    found = horizon_maps.horizon_map(field)
    # Columns 15 and 16 are the ridge; column 4 sees it, and over the valley the one of the tile before.
    rise = field.heights[0, 15] - field.heights[0, 4]
    np.testing.assert_allclose(found.tangents[0, :, 4], rise / (11 / 32))
    np.testing.assert_allclose(found.tangents[4, :, 4], rise / (20 / 32))
    # Along the groove nothing stands above it.
    np.testing.assert_array_equal(found.tangents[2], 0.0)
    assert found.stored_bytes == 8 * 32 * 4


def test_a_flat_field_has_a_level_horizon():
    flat = height_field.height_field(np.full((4, 4), 0.5))
    assert not horizon_maps.horizon_map(flat).tangents.any()
    assert horizon_maps.lit(horizon_maps.horizon_map(flat).sines, (0.0, 0.6, 0.8)).all()


def test_two_azimuths_are_interpolated():
    assert horizon_maps.neighbours((1.0, 0.0, 0.0))[::2] == (0, 0.0)
    first, second, share = horizon_maps.neighbours((1.0, -1.0, 0.5))
    assert (first, second) == (7, 0)
    assert share == 0.0
    angle = math.radians(345.0)
    first, second, share = horizon_maps.neighbours((math.cos(angle), math.sin(angle), 0.2))
    assert (first, second) == (7, 0)
    assert share == pytest.approx(2.0 / 3.0, abs=1e-5)
    with pytest.raises(ValueError, match="horizon map of 2 azimuths"):
        horizon_maps.horizon_map(random_field(1), 2)


def test_shadows_are_the_rays_nearly_everywhere():
    """The catalogue's bound for V-grooves, 0.9, over lights that are no azimuths of the map."""
    field = height_field.ridges(32, 32, 45.0)
    sines = horizon_maps.horizon_map(field).sines
    for azimuth in (10.0, 100.0, 205.0, 300.0):
        a, e = math.radians(azimuth), math.radians(35.0)
        light = (math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e))
        seen = visibility.precompute(field, [light]).seen[0]
        right = horizon_maps.lit(sines, light) == (seen == FREE)
        assert right[seen != BACK].mean() >= 0.9


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3, IDEAL])
@pytest.mark.parametrize("light", [(0.7, 0.2, 0.5), (-0.2, -0.6, 0.3)])
def test_marks_are_the_float_test_s_away_from_the_horizon(profile, light):
    field = height_field.domes(SIZE, SIZE, 2)
    horizons, light = horizon_maps.horizon_map(field), unit_vector(light, "l")
    first, second, share = horizon_maps.neighbours(light)
    over = light[2] - ((1.0 - share) * horizons.sines[first] + share * horizons.sines[second])
    (panel,) = row_of_panels(1, SIZE)
    view, surface = orthographic_view(panel), surfaces.plane()
    black, white = (surface.mesh(colors=np.full((4, 3), c)) for c in (0.0, 1.0))
    commands = (
        panel.clear((0.0, 0.0, 0.0)),
        *horizon_maps.load(horizons, profile),
        draw("black", black, view, None, depth_test=FIRST_PASS),
        ellipse_passes.clear_marks(view),
        horizon_maps.marking_pass(surface, horizons, view, light, sampler=NEAREST),
        draw("show the marks", white, view, None, depth_test=LATER_PASS, stencil_test=MARKED),
    )
    if profile is IDEAL:
        picture = execute_ideal(commands, SIZE, SIZE).color[::-1, :, 0]
    else:
        picture = execute(commands, profile, SIZE, SIZE).framebuffer.color[::-1, :, 0] / 255.0
    # Of bytes: half a step of each sine, of the weights, and of l.
    clear = np.abs(over) > (1e-9 if profile is IDEAL else 0.012)
    assert clear.mean() > 0.9
    np.testing.assert_array_equal((picture > 0.5)[clear], (over > 0.0)[clear])
    np.testing.assert_array_equal(horizon_maps.lit(horizons.sines, light), over > 0.0)
