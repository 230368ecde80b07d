"""``fixedpipe roughness``: the pyramids of a user's heights, kept and shown, and heights good and bad."""

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.user_pictures import roughness
from tests.effects.cli.test_cli import refusal_of, run


def hills(edge=32):
    x = (np.arange(edge) + 0.5) / edge
    return np.sin(2.0 * np.pi * 8.0 * x)[None, :] + 0.3 * np.cos(2.0 * np.pi * 3.0 * x)[:, None]


@pytest.fixture
def heights(tmp_path):
    path = tmp_path / "heights.npy"
    np.save(path, hills())
    return path


def test_the_file_has_the_levels_and_the_picture_shows_them(heights, tmp_path):
    out, shown = tmp_path / "out" / "levels.npz", tmp_path / "levels.png"
    result = run("roughness", heights, "--out", out, "--picture", shown, "--height-scale", 0.1)
    assert result.exit_code == 0, result.output
    assert "6 levels" in result.stdout
    with np.load(out) as arrays:
        found = dict(arrays)
    offsets = found["offsets_0"]
    assert offsets.shape == (32, 32, 2)
    for level in range(6):
        edge = 32 >> level
        covered = offsets.reshape(edge, 32 // edge, edge, 32 // edge, 2).swapaxes(1, 2)
        covered = covered.reshape(edge, edge, -1, 2)
        lost = covered - covered.mean(axis=2, keepdims=True)
        np.testing.assert_allclose(found[f"offsets_{level}"], covered.mean(axis=2), atol=1e-12)
        for k, (i, j) in enumerate(((0, 0), (0, 1), (1, 1))):
            expected = (lost[..., i] * lost[..., j]).mean(axis=2)
            np.testing.assert_allclose(found[f"covariance_{level}"][..., k], expected, atol=1e-6)
        again = rough.covariance_of(found[f"deviations_{level}"])
        np.testing.assert_allclose(again, found[f"covariance_{level}"], atol=1e-12)
        stored = rough.deviations_of_bytes(found[f"bytes_{level}"], found["scale"])
        step = np.abs(stored - found[f"deviations_{level}"]).max() / found["scale"]
        assert found[f"bytes_{level}"].dtype == np.uint8 and step <= 1.0 / 128.0
    picture = np.asarray(Image.open(shown))
    # 32 texels are enlarged to 64 pixels, and 6 levels with gaps stand beside each other.
    assert picture.shape == (2 * 64 + 3 * 4, 64 + 32 + 16 + 8 + 4 + 2 + 7 * 4, 3)
    # Nothing is lost at level 0: D is zero there, which is 128 in green.
    assert (picture[4 + 64 + 4 : -4, 4:68] == (0, 128, 0)).all()


def test_a_map_that_does_not_repeat_keeps_its_edges():
    ramp = np.tile(np.arange(64.0), (64, 1))
    once = roughness.pyramids(ramp, scale=1.0, repeated=False)
    # Rows are of one slope: nothing is lost but at the edges, where heights are smoothed.
    assert np.abs(once[3].covariance[:, 1:-1]).max() < 1e-12
    assert roughness.pyramids(ramp, scale=1.0)[3].covariance.max() > 0.1


def test_smooth_slopes_have_no_roughness():
    flat = rough.pyramid(np.zeros((8, 8, 2)))
    assert not roughness.arrays(flat)["deviations_3"].any() and roughness.largest(flat) == 1.0
    assert (roughness.picture(flat)[4 + 64 + 4 : -4, 4:68] == (0, 128, 0)).all()


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--size", 100), "is 100; give a power of two from 2 to 4096"),
        (("--size", 0), "is 0; give a power of two"),
        (("--size", 8192), "is 8192; give a power of two"),
        (("--height-scale", "nan"), "nan; give a number above zero"),
        (("--height-scale", 0), "0.0; give a number above zero"),
        (("--picture", "levels.jpg"), "name it levels.png"),
    ],
)
def test_bad_options_are_sentences_and_nothing_is_written(heights, tmp_path, more, words):
    out = tmp_path / "levels.npz"
    assert words in refusal_of("roughness", heights, "--out", out, *more)
    assert not out.exists()


def test_bad_heights_are_sentences(tmp_path, heights):
    out = tmp_path / "levels.npz"
    assert "There is no file" in refusal_of("roughness", tmp_path / "none.png", "--out", out)
    assert "name them FILE.npz" in refusal_of("roughness", heights, "--out", tmp_path / "levels.png")
    flat = tmp_path / "flat.npy"
    np.save(flat, np.full((8, 8), 3.0))
    assert "at least two different heights" in refusal_of("roughness", flat, "--out", out)
    hole, line = tmp_path / "hole.npy", tmp_path / "line.npy"
    np.save(hole, np.array([[0.0, np.nan], [1.0, 2.0]]))
    np.save(line, np.arange(8.0)[None])
    assert "has 1 value of NaN" in refusal_of("roughness", hole, "--out", out)
    assert "two rows and two columns" in refusal_of("roughness", line, "--out", out)
    assert not out.exists()
