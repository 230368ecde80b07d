"""S26: outlines lie where half of a highlight is left, and are as wide as the geometry says."""

import numpy as np
import pytest

from fixedpipe.effects.reflectance.highlight_outlines import (
    Model,
    cosine_of,
    half_cosine,
    half_widths,
    outline,
)


@pytest.mark.parametrize("model", Model)
@pytest.mark.parametrize("elevation", [10.0, 45.0])
def test_half_of_the_highlight_is_left_on_the_outline(model, elevation):
    points = outline(model, 60, elevation)
    assert np.array_equal(points[0], points[-1])
    place = np.stack([points[:, 0], np.zeros(len(points)), points[:, 1]], axis=-1)
    height = np.tan(np.radians(elevation))
    left = cosine_of(model, (0.0, height, -1.0) - place, (0.0, height, 1.0) - place) ** 60
    # The sine and cosine behind the outline have 20 bits.
    assert np.abs(left - 0.5).max() <= 1e-4
    mirrored = points * [1.0, -1.0]
    assert np.abs(np.sort(points[:-1, 1]) - np.sort(mirrored[:-1, 1])).max() <= 1e-9


@pytest.mark.parametrize("theta", [0.0, 30.0, 60.0, 80.0])
def test_half_widths_by_the_angles_themselves(theta):
    tilt = np.degrees(np.arccos(0.5 ** (1.0 / 100.0)))
    within, across = half_widths(Model.BLINN_PHONG, 100, theta)
    # In the plane of incidence h leans by half of what v turns by.
    assert abs(within - 2.0 * tilt) <= 1e-9
    # Across it l + v = (s (cos - 1), c (1 + cos), sin) of the turn, whose length is root(2 + 2 l.v).
    turn, c = np.cos(np.radians(across)), np.cos(np.radians(theta))
    leaning = c * (1.0 + turn) / np.sqrt(2.0 + 2.0 * turn * np.cos(np.radians(2.0 * theta)))
    assert abs(np.degrees(np.arccos(leaning)) - tilt) <= 1e-9
    alone = np.degrees(np.arccos(0.5 ** (1.0 / 25.0)))
    assert np.abs(np.array(half_widths(Model.PHONG, 25, theta)) - alone).max() <= 1e-9


def test_half_a_power():
    for exponent in (1, 2, 25, 1000):
        assert abs(half_cosine(exponent) ** exponent - 0.5) <= 1e-12
    with pytest.raises(ValueError, match="whole number"):
        half_cosine(0)


@pytest.mark.parametrize("elevation", [0.0, 90.0, float("nan")])
def test_a_lamp_that_is_not_above_the_plane_is_refused(elevation):
    with pytest.raises(ValueError, match="degrees high"):
        outline(Model.PHONG, 25, elevation)
