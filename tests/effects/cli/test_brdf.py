"""``fixedpipe brdf``: a height field becomes a BRDF, a picture of it, or one sentence."""

import math

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.scattering import merl
from tests.effects.cli.test_cli import refusal_of, run

SMALL = ("--texels", 8, "--grid", 4, "--directions", 40, "--bounces", 1, "--samples", 60)


@pytest.fixture
def heights(tmp_path):
    """Waves along one axis, as an NPY file."""
    path = tmp_path / "waves.npy"
    np.save(path, np.tile(np.sin(np.arange(32) / 32.0 * 4.0 * math.pi), (32, 1)))
    return path


def test_a_merl_file_is_isotropic_and_has_the_albedo_s_colour(heights, tmp_path):
    out = tmp_path / "waves.binary"
    result = run("brdf", heights, "--out", out, "--albedo", "0.8,0.4,0.2", "--relief", 0.05, *SMALL)
    assert result.exit_code == 0, result.output
    assert "isotropic, the mean over rotations" in result.stdout
    numbers = merl.read(out.read_bytes())
    up = np.array([[0.0, 0.6, 0.8]])
    (found,) = merl.looked_up(numbers, up, up)
    assert 0.5 * 0.8 / math.pi < found[0] < 1.3 * 0.8 / math.pi
    # Light that is scattered again is redder.
    assert found[0] / found[1] >= 2.0 and found[0] / found[2] >= 4.0
    turned = np.array([[0.6, 0.0, 0.8]])
    assert np.abs(merl.looked_up(numbers, turned, turned)[0] - found).max() < 1e-9


def test_an_npz_file_holds_what_its_page_says(heights, tmp_path):
    out = tmp_path / "waves.npz"
    result = run("brdf", heights, "--out", out, *SMALL)
    assert result.exit_code == 0, result.output
    with np.load(out, allow_pickle=False) as arrays:
        assert {name: arrays[name].shape for name in arrays.files} == {
            "samples": (4, 4, 4, 4, 3),
            "z": (4,),
            "angle": (4,),
            "coefficients": (16, 16, 3),
            "description": (),
        }
        # Waves along s: it matters where the light comes from.
        samples = arrays["samples"]
        assert samples.min() >= 0.0 and samples.std() > 0.0
        assert "waves.npy" in str(arrays["description"])


def test_the_ball_is_drawn_by_a_machine_and_by_the_ideal(heights, tmp_path):
    pictures = []
    for profile in ("GEFORCE_256", "IDEAL"):
        picture = tmp_path / f"{profile}.png"
        more = ("--picture", picture, "--size", 48, "--light", "0,0,1", "--profile", profile)
        result = run("brdf", heights, "--out", tmp_path / "a.npz", *SMALL, *more)
        assert result.exit_code == 0, result.output
        assert ("by the ideal, in float64" in result.stdout) is (profile == "IDEAL")
        pictures.append(np.asarray(Image.open(picture)).astype(int))
    assert pictures[0].shape == (48, 48, 3)
    assert 150 < pictures[0][24, 24, 0] < 230 and pictures[0][0, 0, 0] < 30
    assert np.abs(pictures[0] - pictures[1]).max() <= 6


def test_what_was_kept_is_gone_on_with_and_processes_write_the_same_bytes(heights, tmp_path):
    command = ("brdf", heights, *SMALL, "--resume", tmp_path / "kept", "--out")
    assert run(*command, tmp_path / "a.npz").exit_code == 0
    pieces = sorted((tmp_path / "kept").glob("piece-*"))
    assert len(pieces) == 4
    # As if it had been stopped: two pieces are missing.
    for piece in pieces[1:3]:
        piece.unlink()
    result = run(*command, tmp_path / "b.npz", "--jobs", 2)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    sentence = refusal_of(*command, tmp_path / "c.npz", "--albedo", 0.5)
    assert "other parameters (albedo)" in sentence
    assert not (tmp_path / "c.npz").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--out", "a.dat"), "ends in neither .binary (MERL) nor .npz"),
        (("--out", "a.npz", "--albedo", "1.2"), "give a number from 0 to 1"),
        (("--out", "a.npz", "--albedo", "nan"), "give a number from 0 to 1"),
        (("--out", "a.npz", "--albedo", "0.5,0.5"), "give a number from 0 to 1"),
        (("--out", "a.npz", "--texels", 1), "1 is not in the range"),
        (("--out", "a.npz", "--directions", 0), "0 is not in the range"),
        (("--out", "a.npz", "--light", "0,0"), "give three numbers"),
        (("--out", "a.npz", "--profile", "VOODOO"), "There is no profile"),
        (("--out", "a.npz", "--picture", "a.jpg"), "written as PNG"),
        (("--out", "a.png", "--format", "npz", "--picture", "a.png"), "give another name"),
        (("--out", "file/a.npz"), "cannot be written to"),
        (("--out", "a.npz", "--resume", "file/f"), "cannot be written to"),
    ],
)
def test_what_cannot_be_is_one_sentence_and_writes_nothing(heights, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    before = sorted(tmp_path.iterdir())
    assert said in refusal_of("brdf", heights, *arguments)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.zeros((4, 4)), "at least two different heights"),
        (np.array([[0.0, np.nan], [1.0, 0.0]]), "has 1 value of NaN"),
        (np.array([[1.0]]), "different heights"),
        (np.zeros((0, 4)), "empty"),
    ],
    ids=["flat", "NaN", "one texel", "empty"],
)
def test_heights_that_are_none_are_said(tmp_path, values, said):
    np.save(tmp_path / "h.npy", values)
    assert said in refusal_of("brdf", tmp_path / "h.npy", "--out", tmp_path / "a.npz")
    assert "no file" in refusal_of("brdf", tmp_path / "none.npy", "--out", tmp_path / "a.npz")
    assert not (tmp_path / "a.npz").exists()


def test_the_heights_are_not_written_over(heights, tmp_path):
    before = heights.read_bytes()
    sentence = refusal_of("brdf", heights, "--out", heights, "--format", "npz")
    assert "of which the BRDF is made" in sentence
    assert heights.read_bytes() == before
