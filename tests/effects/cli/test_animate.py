"""``fixedpipe animate``: what it writes, and what it refuses before anything is drawn."""

import sys

import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.presentation.animations import ANIMATIONS


def run(*arguments):
    return CliRunner().invoke(main, ["animate", *map(str, arguments)], env={"COLUMNS": "200"})


def frames_of(path):
    with Image.open(path) as image:
        return image.n_frames, image.size, image.info["loop"]


def test_the_list_has_what_is_declared():
    result = run("--list")
    assert [line.split()[0] for line in result.stdout.splitlines()] == list(ANIMATIONS)


def test_a_declared_animation_needs_no_words(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run("K14", "--size", 16, "--frames", 5)
    assert result.exit_code == 0, result.output
    (path,) = tmp_path.iterdir()
    assert path.name == "K14-GEFORCE_256-animation.png"
    assert frames_of(path) == (5, (16, 16), 0)
    assert "5 frames of 16x16 pixels, 15 a second, APNG, lossless" in result.stdout
    assert "5 of 5: K14: light=" in result.stderr


def test_parameters_and_bits_move_together(tmp_path):
    out = tmp_path / "torus.webp"
    result = run(
        "K14", "--vary", "light=1,0,1:0,1,1:-1,0,1:4", "--vary", "tilt=0:60", "--precision", "4:8",
        "--out", out, "--size", 16, "--no-loop", "--fps", 4, "--set", "depth=0.5",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert frames_of(out) == (4, (16, 16), 1)
    last = result.stderr.splitlines()[-1]
    assert last == "4 of 4: K14: light=(-1, 0, 1) tilt=60 8 bits"


def test_bits_alone_are_slow(tmp_path):
    result = run("K14", "--precision", "6:4", "--out", tmp_path / "bits.png", "--size", 16)
    assert "3 frames of 16x16 pixels, 2 a second" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "Name a figure"),
        (("--list", "K14"), "leave ID|FILE.py out"),
        (("torus",), "There is no figure 'torus'"),
        (("K13",), "K13 has no animation of its own"),
        (("K14", "--vary", "light"), "give NAME=FROM:TO"),
        (("K14", "--vary", "tilt=1"), "give NAME=FROM:TO"),
        (("K14", "--vary", "titl=1:2"), "Did you mean tilt"),
        (("K14", "--vary", "tilt=1:a"), "tilt is 'a'"),
        (("K14", "--vary", "tilt=1:2:x"), "has 'x' steps"),
        (("K14", "--vary", "tilt=1:2:0"), "has '0' steps; give a whole number from 1"),
        (("K14", "--vary", "tilt=1:2:3:4"), "give FROM:TO or FROM:TO:STEPS"),
        (("K14", "--vary", "tilt=1:2:1"), "An animation has 2 to 1000 frames"),
        (("K14", "--vary", "tilt=1:2:3", "--vary", "depth=0.1:1:4"), "3 and 4 steps"),
        (("K14", "--vary", "tilt=1:2:3", "--frames", "5"), "--frames would be ignored"),
        (("K14", "--vary", "tilt=1:2", "--vary", "tilt=2:3"), "names tilt twice"),
        (("K14", "--vary", "tilt=1:2", "--set", "tilt=3"), "tilt moves"),
        (("K14", "--vary", "height_field=a:b"), "has no values between"),
        (("K14", "--precision", "4"), "give two widths"),
        (("K14", "--precision", "2:8"), "The bits are 2 to 8"),
        (("K14", "--precision", "4:8", "--profile", "IDEAL"), "is no machine"),
        (("K14", "--profile", "OCTANE"), "K14 cannot be drawn on OCTANE"),
        (("K14", "--size", "4096"), "draws up to 2048x2048"),
        (("K14", "--fps", "100"), "give 1 to 60"),
        (("K14", "--out", "torus.gif"), "must end with one of .png, .apng, .webp, .mp4"),
    ],
)
def test_what_cannot_move_is_refused_and_nothing_is_written(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == 2 and result.stdout == "", result.output
    assert words in result.stderr.strip().splitlines()[-1]
    assert not list(tmp_path.iterdir())


def test_without_ffmpeg_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    result = run("K14", "--out", "torus.mp4")
    assert result.exit_code == 2 and "pip install 'fixedpipe[video]'" in result.stderr
    assert not list(tmp_path.iterdir())
