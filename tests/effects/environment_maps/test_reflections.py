"""H20, H21, H32: passes that look environment maps up, and filters of the imaging subset."""

import numpy as np
import pytest

from fixedpipe.effects.environment_maps import convolved_maps, environments, prefilter, reflections
from fixedpipe.effects.geometry import parabolic_maps, surfaces
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256, OCTANE

DISCS = "first", "second"


def view_from(eye, size=64):
    return perspective_view(Panel(0, 0, size, size), eye, field_of_view=42.0, radius=1.1)


@pytest.mark.parametrize("eye", ((0.4, 0.3, 2.8), (-1.0, 0.5, -2.6)))
def test_two_units_and_two_passes_draw_the_same(eye):
    view, ball = view_from(eye), surfaces.sphere(48, 24)
    load = reflections.load_discs(DISCS, environments.discs(64), GEFORCE_256)
    one, two = (
        execute((view.panel.clear((0.0, 0.0, 0.0)), *load, *drawn), GEFORCE_256, 64, 64).image().astype(int)
        for drawn in (
            (reflections.parabolic_pass(ball, view, DISCS, 64),),
            reflections.parabolic_passes(ball, view, DISCS, 64),
        )
    )
    covered = one[..., :3].any(axis=-1)
    assert covered.mean() > 0.3
    # Between the discs one mixes and the other chooses.
    assert (np.abs(one - two).max(axis=-1)[covered] > 12).mean() < 0.03


def test_kernels_sum_to_one_and_are_lobes():
    row = np.array(convolved_maps.separable_filter(100.0, 64).row)[:, 0]
    square = np.array(convolved_maps.general_filter(100.0, 64).rows)[..., 0]
    assert row.sum() == pytest.approx(1.0)
    assert square.sum() == pytest.approx(1.0)
    assert np.abs(np.outer(row, row) - square).max() < 1e-3
    assert (np.diff(row[:6]) > 0.0).all()
    assert (row == row[::-1]).all()
    # Its width is the lobe's where the kernel is made for the texels.
    angle = np.arccos(0.5**0.01)
    texels = angle / (4.0 / 3.0) * 32.0 * parabolic_maps.margin(64, convolved_maps.MARGIN)
    beside = np.interp(texels, np.arange(6), row[5:] / row[5])
    assert beside == pytest.approx(0.5, abs=0.03)


def test_a_copy_through_a_kernel_is_the_kernel_summed_by_hand():
    discs = environments.discs(32, margin=convolved_maps.MARGIN)
    kernel = convolved_maps.general_filter(60.0, 32)
    commands = (
        *convolved_maps.load(DISCS, discs, OCTANE),
        *convolved_maps.filtered_copies(DISCS, ("a", "b"), 32, kernel),
    )
    texture = execute(commands, OCTANE, 32, 32).textures["b"]
    found = texture.levels[0].reshape(32, 32, 4).astype(float)
    stored = np.floor(255.0 * discs[1] + 0.5)
    expected = np.zeros((20, 20, 3))
    for y in range(11):
        for x in range(11):
            expected += kernel.rows[y][x][0] * stored[1 + y : 21 + y, 1 + x : 21 + x]
    assert np.abs(found[6:26, 6:26, :3] - expected).max() <= 1.0
    # Alpha says where the disc is, and is not filtered.
    inside = parabolic_maps.inside(32, parabolic_maps.margin(32, convolved_maps.MARGIN))
    np.testing.assert_array_equal(found[..., 3], 255.0 * inside)


def test_an_exposure_leaves_the_brightest_two_hundredth_above_one():
    cube = np.ones((6, 16, 16, 3))
    cube[0, 0, :4] = 50.0
    assert prefilter.exposure(2.0 * cube) == 0.5
    assert prefilter.exposure(0.0 * cube) == 1.0
