"""Figures that move: values between values, and files whose frames are what ``Figure.render`` draws."""

import io
import subprocess

import imageio.v3 as iio
import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.acceptance.precision import at_width
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.figures.parameters import DIRECTION_KIND, Flag, Maybe, Number, Several, Whole
from fixedpipe.effects.presentation.animations import ANIMATIONS
from fixedpipe.effects.presentation.movies import KINDS, write_animation
from fixedpipe.effects.presentation.variation import Track, along, frames_of, movable, pictures_of
from fixedpipe.effects.refusal import Refusal
from fixedpipe.pipeline.profiles import GEFORCE_256

SIZE = 16
TORUS = FIGURES["K14"]
METHOD = TORUS.method("GEFORCE_256")
LOSSLESS = (".png", ".webp")


def frames_in(path):
    """A file's frames, uint8 [n, h, w, 3], as imageio reads them."""
    return np.stack([frame[..., :3] for frame in iio.imiter(path, plugin="pillow")])


@pytest.fixture
def noise():
    """Seven frames that do not compress, of odd edges, two of which are equal."""
    frames = np.random.default_rng(5).integers(0, 256, (7, 13, 15, 3), dtype=np.uint8)
    frames[4] = frames[3]
    frames[6, :, :, 1:] = 0
    return frames


@pytest.mark.parametrize("ending", LOSSLESS)
def test_the_frames_come_back_bit_by_bit_and_equal_ones_stay(tmp_path, noise, ending):
    path = tmp_path / f"noise{ending}"
    write_animation(path, iter(noise), len(noise), 15)
    np.testing.assert_array_equal(frames_in(path), noise)
    with Image.open(path) as image:
        assert image.n_frames == 7


@pytest.mark.parametrize("ending", LOSSLESS)
@pytest.mark.parametrize("loop", [True, False])
def test_a_file_says_how_long_a_frame_lasts_and_whether_it_begins_again(tmp_path, noise, ending, loop):
    path = tmp_path / f"noise{ending}"
    write_animation(path, iter(noise), len(noise), 15, loop)
    lasts = []
    with Image.open(path) as image:
        assert image.info["loop"] == (0 if loop else 1)
        for n in range(image.n_frames):
            image.seek(n)
            image.load()
            lasts.append(image.info["duration"])
    assert sum(lasts) == pytest.approx(7000 / 15, abs=0.5)
    assert max(abs(each - 1000 / 15) for each in lasts) < 1.0


@pytest.mark.parametrize("ending", LOSSLESS)
def test_no_frame_is_asked_for_before_the_one_before_it_is_written(tmp_path, ending):
    noise = np.random.default_rng(6).integers(0, 256, (5, 128, 128, 3), dtype=np.uint8)
    sizes = []

    def frames():
        for frame in noise:
            sizes.append(path.stat().st_size if path.exists() else 0)
            yield frame

    path = tmp_path / f"noise{ending}"
    write_animation(path, frames(), len(noise), 15)
    # What the system holds back of a file is less than a frame.
    assert sizes == sorted(sizes) and len(set(sizes)) == 5
    assert sizes[-1] > 3 * (path.stat().st_size - sizes[-1])


@pytest.mark.parametrize("ending", LOSSLESS)
def test_a_frame_is_what_the_figure_draws_with_that_value(tmp_path, ending):
    tracks = {"light": Track(((1.0, 0.0, 0.5), (0.0, 2.0, 1.0))), "tilt": Track((10.0, 70.0))}
    frames = frames_of(TORUS, METHOD, tracks, count=4)
    path = tmp_path / f"torus{ending}"
    changes = {"diffuse": (0.2, 0.3, 0.4)}
    write_animation(path, pictures_of(TORUS, GEFORCE_256, frames, SIZE, changes=changes), 4, 10)
    for n, shown in enumerate(frames_in(path)):
        values = frames[n].changes
        drawn = TORUS.render("GEFORCE_256", SIZE, **values, **changes)
        np.testing.assert_array_equal(shown, drawn.image()[..., :3])
    assert [frame.changes["tilt"] for frame in frames] == [10.0, 30.0, 50.0, 70.0]
    assert len({shown.tobytes() for shown in frames_in(path)}) == 4


def test_bits_are_widths_of_every_number():
    frames = frames_of(TORUS, METHOD, {}, bits=(4, 16))
    assert [frame.bits for frame in frames] == list(range(4, 17))
    assert frames[0].said == "4 bits"
    some = (frames[0], frames[4])
    pictures = list(pictures_of(TORUS, GEFORCE_256, some, SIZE))
    for frame, picture in zip(some, pictures, strict=True):
        drawn = TORUS.render(at_width(GEFORCE_256, frame.bits), SIZE)
        np.testing.assert_array_equal(picture, drawn.image()[..., :3])
    assert not np.array_equal(*pictures)
    together = frames_of(TORUS, METHOD, {"tilt": Track((0.0, 60.0))}, bits=(16, 4), count=5)
    assert [frame.bits for frame in together] == [16, 13, 10, 7, 4]


def test_numbers_change_evenly_and_whole_ones_in_steps():
    assert along(Number(), (1.0, 2.0, 0.0), 5) == (1.0, 1.5, 2.0, 1.0, 0.0)
    assert along(Whole(1, 64), (3, 6), 4) == (3, 4, 5, 6)
    assert along(Whole(1, 512, power=True), (4, 64), 5) == (4, 8, 16, 32, 64)
    assert along(Whole(2, 64, even=True), (2, 8), 4) == (2, 4, 6, 8)
    assert along(Maybe(Number(), "none"), (0.0, 1.0), 2) == (0.0, 1.0)
    pairs = Several(Several((Number(), Number())), least=1, most=3)
    assert along(pairs, (((0.0, 1.0),), ((2.0, 3.0),)), 3)[1] == ((1.0, 2.0),)


def test_directions_go_along_the_arc():
    way = along(DIRECTION_KIND, ((2.0, 0.0, 0.0), (0.0, 4.0, 0.0)), 5)
    lengths = np.linalg.norm(way, axis=1)
    np.testing.assert_allclose(lengths, [2.0, 2.5, 3.0, 3.5, 4.0])
    angles = [np.degrees(np.arctan2(y, x)) for x, y, _ in way]
    np.testing.assert_allclose(angles, [0.0, 22.5, 45.0, 67.5, 90.0])
    with pytest.raises(Refusal, match="no one arc"):
        along(DIRECTION_KIND, ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)), 3)
    same = along(DIRECTION_KIND, ((1.0, 0.0, 0.0), (2.0, 0.0, 0.0)), 3)
    np.testing.assert_allclose(same, [(1, 0, 0), (1.5, 0, 0), (2, 0, 0)])


def test_only_what_numbers_make_up_moves():
    assert movable(Several(Several((Number(), Whole())), least=1, most=2)) and movable(Maybe(Whole(), ""))
    assert not movable(Flag()) and not movable(Several((Number(), Flag())))


@pytest.mark.parametrize(
    ("figure", "tracks", "more", "sentence"),
    [
        ("K14", {"lihgt": Track((1.0, 2.0))}, {}, "Did you mean light"),
        ("K14", {"height_field": Track((1.0, 2.0))}, {}, "has no values between"),
        ("K14", {"tilt": Track((1.0, 2000.0))}, {}, "tilt is 2000"),
        ("K14", {"tilt": Track((1.0,))}, {}, "give two values or more"),
        ("K14", {"tilt": Track((1.0, 2.0))}, {"count": 1}, "An animation has 2 to 1000 frames"),
        ("K14", {"tilt": Track((1.0, 2.0))}, {"count": 1001}, "An animation has 2 to 1000 frames"),
        ("K14", {}, {}, "Nothing of K14 is to move"),
        ("K14", {}, {"bits": (4, 17)}, "The bits are 4 to 17"),
        ("K14", {}, {"bits": (8, 8)}, "An animation has 2 to 1000 frames"),
        ("K04", {"model": Track(("exact", "exact"))}, {}, "has no values between"),
        ("K05", {"exponents": Track(((2, 4), (2, 4, 8)))}, {}, "of as many numbers"),
    ],
)
def test_what_cannot_move_is_refused(figure, tracks, more, sentence):
    figure = FIGURES[figure]
    with pytest.raises(ValueError, match=sentence):
        frames_of(figure, figure.methods[0], tracks, **more)


@pytest.mark.parametrize("identifier", ANIMATIONS)
def test_a_declared_animation_moves(identifier):
    figure, declared = FIGURES[identifier], ANIMATIONS[identifier]
    frames = frames_of(figure, figure.methods[0], declared.tracks, declared.bits, declared.count)
    assert len(frames) == (declared.count or 13)
    assert frames[0].said != frames[1].said
    if "light" in declared.tracks:  # it can be repeated: the last is a step before the first
        first, last, step = (np.array(frames[n].changes["light"]) for n in (0, -1, 1))
        np.testing.assert_allclose(np.linalg.norm(first - last), np.linalg.norm(first - step), rtol=1e-4)


@pytest.mark.parametrize("identifier", ["K14", "F003-22"])
def test_its_pictures_differ(identifier):
    figure, declared = FIGURES[identifier], ANIMATIONS[identifier]
    frames = frames_of(figure, figure.methods[0], declared.tracks, declared.bits, declared.count)
    machine = figure.machines[0]
    first, second = (
        figure.render(machine, SIZE, **frame.changes).image()
        for frame in (frames[0], frames[len(frames) // 3])
    )
    assert not np.array_equal(first, second)


def test_another_ending_and_a_rate_that_no_player_shows_are_refused(tmp_path, noise):
    with pytest.raises(Refusal, match=r"must end with one of \.png, \.apng, \.webp, \.mp4"):
        write_animation(tmp_path / "noise.gif", iter(noise), 7, 15)
    for rate in (0, 61):
        with pytest.raises(Refusal, match="give 1 to 60"):
            write_animation(tmp_path / "noise.png", iter(noise), 7, rate)
    assert "lossy" in KINDS[".mp4"][1] and not list(tmp_path.iterdir())


def test_an_mp4_has_as_many_frames_and_is_near(tmp_path, noise):
    ffmpeg = pytest.importorskip("imageio_ffmpeg").get_ffmpeg_exe()
    ramp = np.arange(32, dtype=np.uint8)[:, None, None] * 4
    frames = [np.broadcast_to(ramp + n, (32, 48, 3)) for n in range(0, 60, 10)]
    write_animation(tmp_path / "ramp.mp4", iter(frames), 6, 10)
    command = [ffmpeg, "-v", "error", "-i", tmp_path / "ramp.mp4", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    shown = np.frombuffer(raw, np.uint8).reshape(6, 32, 48, 3)
    assert np.abs(shown.astype(int) - frames).mean() < 4
    with pytest.raises(Refusal, match="give an even --size"):
        write_animation(tmp_path / "noise.mp4", iter(noise), 7, 10)


def test_the_apng_is_a_png_for_those_who_know_no_animation(tmp_path, noise):
    write_animation(tmp_path / "noise.png", iter(noise), len(noise), 15)
    data = (tmp_path / "noise.png").read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    with Image.open(io.BytesIO(data)) as image:
        np.testing.assert_array_equal(np.asarray(image.convert("RGB")), noise[0])
