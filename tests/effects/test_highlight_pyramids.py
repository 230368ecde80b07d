"""Mip-maps of D^-1, and the plane whose highlights they keep."""

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.geometry.views import Panel, perspective_view
from fixedpipe.effects.reflectance import rough_highlights as shine
from fixedpipe.effects.texture_filtering import highlight_pyramids, sampled_highlights
from fixedpipe.effects.texture_filtering.highlight_pyramids import Roughness
from fixedpipe.effects.texture_filtering.sampled_highlights import Ground

GROUND = Ground(1.0, 40.0, 0.4, sampled_highlights.lamp(13.0), 0.1)
VIEW = perspective_view(Panel(0, 0, 17, 17), (0.0, 1.0, 0.0), (0.0, 0.7, -1.0), 40.0, radius=80.0)


def test_rows_times_h_are_the_inverse_of_the_deviation():
    rng = np.random.default_rng(2)
    root = rng.uniform(-1.0, 1.0, (50, 2, 2))
    matrix = root @ root.swapaxes(1, 2)
    k = np.stack([matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 1, 1]], axis=-1)
    f, half = rng.uniform(-0.5, 0.5, (50, 2)), rng.uniform(0.1, 1.0, (50, 3))
    slopes = np.concatenate([half[:, :2] / half[:, 2:], np.ones((50, 1))], axis=-1)
    x, y = ((row * slopes).sum(axis=-1) for row in highlight_pyramids.inverse_rows(f, k))
    squared = shine.squared_cosine(shine.apart(half, np.eye(3), f), k)
    np.testing.assert_allclose(1.0 / (1.0 + x * x + y * y), squared, rtol=1e-6)


def test_kinds_of_roughness():
    offsets = sampled_highlights.ripples(32, 8, 0.1, 0.3)
    levels = sampled_highlights.pyramid(offsets, GROUND)
    none, isotropic, anisotropic = (
        highlight_pyramids.covariances(levels, kind, spread=1.0)[-1][0, 0] for kind in Roughness
    )
    np.testing.assert_allclose(none, [0.01, 0.0, 0.01])
    np.testing.assert_allclose(anisotropic[[0, 2]], [0.02, 0.1], rtol=1e-6)
    np.testing.assert_allclose(isotropic, rough.largest_deviation(anisotropic) ** 2 * np.array([1, 0, 1]))


def test_one_sample_of_a_flat_plane_is_the_formula():
    found = sampled_highlights.supersampled(VIEW, GROUND, np.zeros((2, 2, 2)), side=1)
    met = found[..., 1] == 1.0
    assert 0 < met.sum() < met.size
    assert (found[..., 0][~met] == 0.0).all()
    slopes = GROUND.half_slopes(np.array([[0.0, 0.0, -4.0]]))
    half = np.concatenate([slopes, np.ones((1, 1))], axis=-1)
    expected = shine.brightness(shine.squared_cosine(shine.apart(half, np.eye(3)), [0.01, 0.0, 0.01]))
    # The pixel that sees the point: the middle column, as far down as 1 in 4 and the camera's lean.
    forward, up = np.array([-0.3, -1.0]) / np.sqrt(1.09), np.array([1.0, -0.3]) / np.sqrt(1.09)
    ray = np.array([-1.0, -4.0])
    row = 8.5 * (1.0 + (ray @ up) / (ray @ forward) / np.tan(np.radians(20.0)))
    assert np.interp(row - 0.5, np.arange(17), found[:, 8, 0]) == pytest.approx(float(expected[0]), abs=0.05)


def test_samples_converge_and_bad_maps_are_refused():
    offsets = sampled_highlights.ripples(32, 8, 0.1, 0.2)
    fine, finer = (sampled_highlights.supersampled(VIEW, GROUND, offsets, side=n) for n in (16, 32))
    assert np.abs(fine[..., 0] - finer[..., 0]).mean() < 0.01
    with pytest.raises(ValueError, match="finite offsets"):
        sampled_highlights.supersampled(VIEW, GROUND, np.zeros((2, 2)))
    with pytest.raises(ValueError, match="finite offsets"):
        sampled_highlights.supersampled(VIEW, GROUND, np.full((2, 2, 2), np.nan))
