"""S16 to S19: the recursion is the covariance of all texels, and D its root, in bytes too."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.geometry.height_fields import hashed

NUMBERS = st.floats(-4.0, 4.0, allow_subnormal=False).map(lambda x: round(x, 6))


def noise(size, seed=1):
    """Offsets of white noise, float64 [size, size, 2]."""
    x, y = np.meshgrid(np.arange(size), np.arange(size))
    return np.stack([hashed(x, y, seed + k) for k in (0, 1)], axis=-1) / 32768.0 - 1.0


@given(arrays(np.float64, (8, 4, 2), elements=NUMBERS))
def test_the_recursion_is_the_covariance_of_all_texels_covered(offsets):
    for number, level in enumerate(rough.pyramid(offsets)):
        rows, columns = level.offsets.shape[:2]
        blocks = offsets.reshape(rows, 8 // rows, columns, 4 // columns, 2).transpose(0, 2, 1, 3, 4)
        blocks = blocks.reshape(rows, columns, -1, 2)
        mean = blocks.mean(axis=2)
        apart = blocks - mean[:, :, None]
        expected = np.stack(
            [(apart[..., i] * apart[..., j]).mean(axis=2) for i, j in ((0, 0), (0, 1), (1, 1))], axis=-1
        )
        assert np.abs(level.offsets - mean).max() <= 1e-12, number
        assert np.abs(level.covariance - expected).max() <= 1e-12, number


def test_what_is_rough_beneath_level_zero_stays():
    plain, based = rough.pyramid(noise(16)), rough.pyramid(noise(16), (0.3, -0.1, 0.2))
    for one, other in zip(plain, based, strict=True):
        assert np.abs(other.covariance - one.covariance - (0.3, -0.1, 0.2)).max() <= 1e-12


def test_variance_and_roughness_together_are_the_same_at_every_level():
    levels = rough.pyramid(noise(64))
    whole = levels[-1].covariance[0, 0]
    for level in levels:
        spread = rough.products(level.offsets - levels[-1].offsets[0, 0])
        assert np.abs((level.covariance + spread).mean(axis=(0, 1)) - whole).max() <= 1e-12


@given(arrays(np.float64, (3,), elements=NUMBERS))
def test_d_is_a_root_of_k_and_k_of_d_again(d):
    d = np.array([abs(d[0]), d[1] if d[2] else 0.0, abs(d[2])])
    k = rough.covariance_of(d)
    again = rough.deviations(rough.checked_covariance(k))
    assert np.abs(rough.covariance_of(again) - k).max() <= 1e-12 * max(1.0, np.abs(k).max())
    assert again[0] >= 0.0 and again[2] >= 0.0


def test_corrugated_iron_is_rough_along_u_alone():
    ripples = np.zeros((4, 4, 2))
    ripples[:, 0::2, 0], ripples[:, 1::2, 0] = 0.5, -0.5
    level = rough.pyramid(ripples)[-1]
    assert level.deviations.tolist() == [[[0.5, 0.0, 0.0]]]
    assert rough.largest_deviation(level.covariance).tolist() == [[0.5]]
    i_1, i_2, axis = rough.principal(level.covariance)
    assert (i_1.item(), i_2.item(), axis.ravel().tolist()) == (0.5, 0.0, [1.0, 0.0])


@given(arrays(np.float64, (3,), elements=NUMBERS))
def test_the_long_axis_has_the_larger_deviation(d):
    k = rough.covariance_of(d)
    i_1, i_2, (x, y) = rough.principal(k)
    along = (k[0] * x * x + 2.0 * k[1] * x * y) + k[2] * y * y
    size = max(1.0, k[0] + k[2])
    assert abs(along - i_1 * i_1) <= 1e-9 * size
    assert abs(i_1 * i_1 + i_2 * i_2 - (k[0] + k[2])) <= 1e-9 * size
    assert rough.largest_deviation(k) == i_1
    assert abs(x * x + y * y - 1.0) <= 1e-12


def test_bytes_of_d_are_within_half_a_step():
    d = np.concatenate([np.abs(noise(32)), noise(32, 7)], axis=-1)[..., [0, 2, 1]] * 0.7
    codes = rough.deviation_bytes(d, 0.7)
    assert codes.dtype == np.uint8
    apart = np.abs(rough.deviations_of_bytes(codes, 0.7) - d)
    assert apart[..., 0::2].max() <= 0.7 * 0.5001 / 255.0
    assert apart[..., 1].max() <= 0.7 * 0.5001 / 127.0
    assert rough.deviation_bytes([0.0, 0.0, 0.0], 1.0).tolist() == [0, 128, 0]
    assert rough.deviation_bytes([9.0, -9.0, 9.0], 1.0).tolist() == [255, 0, 255]


def test_a_trilinear_probe_is_the_texel_in_its_middle_and_the_mean_between_levels():
    levels = rough.pyramid(noise(8))
    images = [level.offsets for level in levels]
    at = (np.arange(8) + 0.5) / 8
    s, t = np.meshgrid(at, at)
    assert np.array_equal(rough.trilinear(images, s, t, 0.0), images[0])
    assert np.array_equal(rough.trilinear(images, s + 3.0, t - 2.0, -5.0), images[0])
    assert np.abs(rough.trilinear(images, 0.3, 0.4, 99.0) - images[-1][0, 0]).max() == 0.0
    middle = rough.trilinear(images, 0.125, 0.125, 0.5)
    expected = 0.5 * (images[1][0, 0] + images[0][:2, :2].mean(axis=(0, 1)))
    assert np.abs(middle - expected).max() <= 1e-15


def test_heights_lean_the_normal_away_from_the_slope():
    heights = np.sin(2.0 * np.pi * np.arange(16) / 16)[None, :] * np.ones((16, 1)) * 0.01
    level = rough.from_heights(heights, scale=2.0)[0]
    assert level.offsets[0, 0, 0] < 0.0 < level.offsets[0, 8, 0]
    assert np.abs(level.offsets[..., 1]).max() == 0.0


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: rough.pyramid(np.zeros((4, 4, 3))), "offset vectors"),
        (lambda: rough.pyramid(np.zeros((0, 4, 2))), "offset vectors"),
        (lambda: rough.pyramid(np.zeros((3, 4, 2))), "powers of two"),
        (lambda: rough.pyramid(np.full((4, 4, 2), np.nan)), "NaN"),
        (lambda: rough.pyramid(np.zeros((4, 4, 2)), np.zeros((2, 3))), "roughness has shape"),
        (lambda: rough.pyramid(np.zeros((4, 4, 2)), (1.0, 2.0, 1.0)), "no covariance"),
        (lambda: rough.checked_covariance([np.inf, 0.0, 1.0]), "infinite"),
        (lambda: rough.deviation_bytes([1.0, 0.0, 1.0], 0.0), "above zero"),
        (lambda: rough.deviation_bytes([1.0, 0.0, 1.0], np.nan), "above zero"),
    ],
)
def test_what_is_no_bump_map_is_refused(call, says):
    with pytest.raises(ValueError, match=says):
        call()
