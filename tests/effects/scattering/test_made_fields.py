"""Bricks, planks, gravel and scales: periodic, in range, and the same for every size's hash."""

import numpy as np
import pytest

from fixedpipe.effects.scattering import made_fields


@pytest.mark.parametrize(
    "make", [made_fields.bricks, made_fields.planks, made_fields.gravel, made_fields.scales]
)
def test_a_field_repeats_without_a_seam(make):
    field = make(64, 64)
    assert field.heights.min() >= -0.01 and 0.005 < np.ptp(field.heights) < 0.2
    assert field.albedo.min() >= 0.0 and field.albedo.max() <= 1.0
    for axis in (0, 1):
        steps = np.abs(np.diff(field.heights, axis=axis))
        seam = np.abs(field.heights.take(0, axis) - field.heights.take(-1, axis))
        assert seam.max() <= steps.max() + 1e-12


def test_bricks_have_joints_and_colours_of_their_own():
    field = made_fields.bricks(128, 128)
    # The middle of a joint between two courses, and of a brick.
    joint, middle = field.heights[0].mean(), field.heights[10].mean()
    assert joint < 0.3 * middle
    clay = field.albedo[10]
    assert (clay[..., 0] > 1.3 * clay[..., 2]).mean() > 0.8
    assert np.ptp(clay[..., 0]) > 0.1


def test_scales_of_an_odd_number_are_refused():
    with pytest.raises(ValueError, match="even number"):
        made_fields.scales(count=7)
