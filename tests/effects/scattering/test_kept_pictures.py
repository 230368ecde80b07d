"""BTFs, BRDFs that vary over the surface, light fields, and the choice between levels of detail."""

import io
import math
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np
import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.scattering import btf, goniometer, levels, light_field
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.height_field import bumps, height_field, ridges
from fixedpipe.effects.scattering.visibility import precompute

DIRECTIONS = spiral(100)
LIGHT = np.array([[0.48, 0.36, 0.8]])


@pytest.fixture(scope="module")
def field():
    # A field of its own in every quarter: steep ridges to the left, flat to the right.
    heights = np.concatenate([ridges(16, 32, 50.0, 2).heights, np.zeros((32, 16))], axis=1)
    return height_field(heights, 0.7)


@pytest.fixture(scope="module")
def kept(field):
    views, _ = goniometer.grid(3)
    return btf.simulated(field, precompute(field, DIRECTIONS), views, views, size=64)


def test_the_mean_of_the_pictures_is_the_brdf(field, kept):
    views, _ = goniometer.grid(3)
    shares = goniometer.shares_in_pictures(field, views, 64)
    expected = goniometer.brdf(field, precompute(field, DIRECTIONS), views, views, shares=shares)
    assert kept.pictures.shape == (9, 9, 64, 64, 3) and kept.pictures.dtype == np.float16
    # Half a unit in the last of float16's eleven bits.
    assert np.abs(kept.brdf() / expected - 1.0).max() < 2.0**-11


def test_windows_have_brdfs_of_their_own_whose_mean_is_the_whole_s(kept):
    windows = kept.windows(4)
    assert np.abs(windows.mean(axis=(2, 3)) - kept.brdf()).max() < 1e-12
    # The flat half under steep light: the albedo over pi, and some light from the ridges beside it.
    assert 0.99 < windows[6, 6, :, 2:].mean() * math.pi / 0.7 < 1.2
    ridged, flat = (windows[:, :, :, half].mean(axis=(2, 3, 4)) for half in (slice(2), slice(2, 4)))
    assert np.abs(ridged / flat - 1.0).max() > 0.3
    with pytest.raises(ValueError, match="give a divisor"):
        kept.windows(5)


def test_bytes_are_near_and_pieces_the_same_by_any_executor(field, tmp_path):
    seen = precompute(field, DIRECTIONS)
    views, _ = goniometer.grid(2)
    whole = btf.simulated(field, seen, views, views)
    with ThreadPoolExecutor(2) as threads:
        parts = btf.simulated(field, seen, views, views, folder=tmp_path, executor=threads)
    assert whole.npz() == parts.npz() == btf.simulated(field, seen, views, views, folder=tmp_path).npz()
    with pytest.raises(Refusal, match=r"other parameters \(kind\)"):
        btf.simulated(field, seen, views, views, folder=tmp_path, kind="uint8")
    stored = btf.simulated(field, seen, views, views, kind="uint8")
    assert stored.pictures.dtype == np.uint8
    assert np.abs(stored.radiance(0, 1) - whole.radiance(0, 1)).max() < 0.51 * btf.FULL / 255.0 + 1e-3


def test_what_no_btf_is_made_of_is_refused(field):
    seen = precompute(field, DIRECTIONS)
    up = np.array([[0.0, 0.0, 1.0]])
    with pytest.raises(ValueError, match="give 'float16' or 'uint8'"):
        btf.simulated(field, seen, up, up, kind="float64")
    glossy = height_field(field.heights, 0.5, specular=0.2)
    with pytest.raises(ValueError, match="give a diffuse one"):
        btf.simulated(glossy, seen, up, up)
    with pytest.raises(ValueError, match="not above the horizon"):
        btf.simulated(field, seen, -up, up)


def test_a_light_field_has_the_pictures_of_its_eyes_and_what_lies_between():
    field = bumps(32, 32)
    sent = goniometer.lights(field, precompute(field, DIRECTIONS), LIGHT, 2)[0]
    steps = []
    found = light_field.simulated(field, sent, 9, 32, progress=steps.append)
    assert found.pictures.shape == (9, 9, 32, 32, 3) and steps == list(range(1, 10))
    s, t, z = found.eye(2, 7)
    exact = sent.reshape(-1, 3)[light_field.seen_from(field, (s, t, z), 32)]
    assert np.array_equal(found.pictures[2, 7], exact)
    assert np.abs(found.at(s, t) - exact).max() < 1e-12
    # Between eyes: near what is seen from there, nearer than the nearest of the pictures.
    s += 1.0 / 8.0
    truth = sent.reshape(-1, 3)[light_field.seen_from(field, (s, t, z), 32)]
    error = np.abs(found.at(s, t) - truth).mean()
    assert error < 0.02 < np.abs(truth - found.pictures[2, 0]).mean()
    assert np.array_equal(found.at(9.0, -9.0), found.pictures[0, 8])


def test_an_eye_far_above_sees_as_an_orthographic_picture_does():
    field = ridges(32, 32, 30.0, 2)
    above = light_field.seen_from(field, (0.5 + 3e5, 0.5, 4e5), 32)
    assert (above == goniometer.picture(field, (0.6, 0.0, 0.8), 32)).mean() > 0.99


def test_eyes_that_are_none_are_refused():
    field = bumps(16, 16)
    sent = np.ones((16, 16, 3))
    with pytest.raises(ValueError, match="give 2 or more"):
        light_field.simulated(field, sent, 1)
    with pytest.raises(ValueError, match="highest point"):
        light_field.simulated(field, sent, 4, distance=0.01)
    with pytest.raises(ValueError, match="highest point"):
        light_field.seen_from(field, (0.5, 0.5, math.nan), 8)


@pytest.mark.parametrize(
    ("texels", "expected"),
    [(0.01, (1, 0, 0)), (0.25, (0.5, 0.5, 0)), (1.0, (0, 1, 0)), (4.0, (0, 0.5, 0.5)), (50.0, (0, 0, 1))],
)
def test_levels_go_over_into_each_other(texels, expected):
    assert levels.shares(texels) == pytest.approx(expected)


def test_levels_are_faded_without_a_jump():
    steps = [levels.shares(0.01 * 1.01**k) for k in range(800)]
    assert all(sum(step) == pytest.approx(1.0) and min(step) >= 0.0 for step in steps)
    assert (
        max(abs(a - b) for first, second in pairwise(steps) for a, b in zip(first, second, strict=True))
        < 0.02
    )
    with pytest.raises(ValueError, match="above 0"):
        levels.shares(0.0)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("bounces", {"bounces": 1}),
        ("size", {"size": 16}),
        ("gathered along", {"count": 60}),
        ("lights", {"lights": 3}),
        ("views", {"views": 3}),
        ("heights, normals", {"height": 0.2}),
        ("albedo", {"albedo": 0.3}),
    ],
)
def test_all_that_pictures_depend_on_stands_in_the_manifest(tmp_path, name, change):
    def made(bounces=0, size=8, count=40, lights=2, views=2, height=0.1, albedo=0.8):
        field = bumps(8, 8, albedo, height)
        (towards, _), (seen, _) = goniometer.grid(lights), goniometer.grid(views)
        # As many pieces, whatever the lights are.
        return btf.simulated(
            field, precompute(field, spiral(count)), towards[:4], seen, size=size, bounces=bounces,
            folder=tmp_path,
        )  # fmt: skip

    made()
    with pytest.raises(Refusal, match=rf"other parameters \({name}\)"):
        made(**change)


def test_a_file_of_pictures_holds_them_and_what_255_is(field):
    views, _ = goniometer.grid(1)
    stored = btf.simulated(field, precompute(field, DIRECTIONS), views, views, kind="uint8")
    read = np.load(io.BytesIO(stored.npz()))
    assert sorted(read) == ["full", "irradiance", "pictures", "towards", "views"]
    for name in ("pictures", "towards", "views", "irradiance"):
        np.testing.assert_array_equal(read[name], getattr(stored, name))
    np.testing.assert_array_equal(stored.radiance(0, 0), read["pictures"][0, 0] * (read["full"] / 255.0))


@pytest.mark.parametrize(
    ("texels", "expected"),
    [(0.125, (1, 0, 0)), (0.375, (0, 1, 0)), (2.0, (0, 1, 0)), (6.0, (0, 0, 1)), (0.1875, (0.75, 0.25, 0))],
)
def test_levels_are_mixed_within_half_of_a_limit(texels, expected):
    assert levels.shares(texels) == pytest.approx(expected)
