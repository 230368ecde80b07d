"""Pictures as the gallery keeps them: scripts that give every byte back, and digests for names."""

import io

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.reports.pictures import (
    LOSSLESS,
    NARROW,
    OF_GRID,
    PREVIEW,
    WIDE,
    Pictures,
    canonical,
    digest_of,
    lossless,
    preview,
    reduced,
    script,
)
from tests.effects.reports import kept
from tests.effects.reports.kept import CHARACTERS, CONTROLS, called

NAME = "0123456789abcdef"


def noise(*shape):
    return np.random.default_rng(5).integers(0, 256, shape, np.uint8)


def test_the_characters_of_a_browser_are_256():
    assert len(CHARACTERS) == 256 and len(set(CHARACTERS.values())) == 256
    assert all(CHARACTERS[chr(byte)] == byte for byte in CONTROLS)
    assert CHARACTERS["\N{EURO SIGN}"] == 0x80


@pytest.mark.parametrize(
    "data",
    [
        bytes(range(256)),
        bytes(range(255, -1, -1)) * 3,
        b'\\"\r\n',
        b'\r\n"\\\\"\n\r\\n\\r\\\\n',  # what escapes would make of escapes
        bytes(CONTROLS) + b"\x00\x0b\x0c\x1a\x85\xa0\xff\xfe\xef\xbb\xbf",
        b"</script><!--*/'`${}\xe2\x80\xa8",
        b"",
    ],
)
def test_a_script_gives_back_every_byte(data):
    assert called(script(NAME, 3, 5, data)) == (NAME, 3, 5, data, None)


@pytest.mark.parametrize("shape", [(17, 31, 3), (1, 1, 3), (9, 40, 4)])
def test_a_picture_comes_back_from_its_script_as_it_was(shape):
    pixels = canonical(noise(*shape))
    name = digest_of(pixels)
    _, width, height, data, _ = called(script(name, shape[1], shape[0], lossless(pixels)))
    with Image.open(io.BytesIO(data)) as picture:
        assert picture.size == (width, height)
        np.testing.assert_array_equal(np.asarray(picture.convert("RGBA")), pixels)


def test_where_alpha_is_nothing_there_is_no_colour():
    image = noise(6, 6, 4)
    image[:3, :, 3], image[3:, :, 3] = 0, 255
    pixels = canonical(image)
    assert not pixels[:3].any()
    np.testing.assert_array_equal(pixels[3:], image[3:])


def test_a_digest_is_of_the_shape_too():
    square, row = np.zeros((2, 2, 4), np.uint8), np.zeros((1, 4, 4), np.uint8)
    assert digest_of(square) != digest_of(row)
    assert digest_of(square) == digest_of(square.copy())


def test_a_preview_is_at_most_so_wide_and_keeps_the_proportions():
    pixels = canonical(noise(512, 1536, 3))
    for width, size in ((960, (960, 320)), (480, (480, 160)), (4000, (1536, 512))):
        with Image.open(io.BytesIO(preview(pixels, width))) as picture:
            assert picture.size == size
    grey = np.array([[[0, 0, 0, 255], [200, 100, 50, 255]]], np.uint8)
    np.testing.assert_array_equal(reduced(grey, 1), [[[100, 50, 25, 255]]])


def test_of_equal_pictures_there_is_one_with_all_files_that_were_asked_for():
    pictures, one, other = Pictures(), noise(10, 1000, 3), noise(5, 4, 3)
    first = pictures.add(one, LOSSLESS)
    assert pictures.add(one.copy(), LOSSLESS, WIDE) == pictures.add(one, NARROW, OF_GRID) == first
    second = pictures.add(other, NARROW)
    files = {name: data() for name, data in pictures.files()}
    widths = {f"{first}.webp": PREVIEW, f"{first}-480.webp": 480, f"{second}.webp": 4}
    assert files.keys() == {f"{first}.js", *widths}
    assert called(files[f"{first}.js"])[:3] == (first, 1000, 10)
    for name, width in widths.items():
        with Image.open(io.BytesIO(files[name])) as picture:
            assert picture.width == width


def test_a_picture_is_told_from_another_where_that_is_shorter(tmp_path):
    pictures, one = Pictures(), noise(40, 60, 3)
    near = one + np.random.default_rng(6).integers(0, 2, one.shape, np.uint8)  # 255 wraps to 0
    first = pictures.add(one, LOSSLESS)
    second = pictures.add(near, LOSSLESS, bases=[first])
    third = pictures.add(near - 1, LOSSLESS, bases=[second])
    other = pictures.add(np.full_like(one, 7), LOSSLESS, bases=[first])
    small = pictures.add(one[:5], LOSSLESS, bases=[first])
    clear = pictures.add(np.zeros((40, 60, 4), np.uint8), LOSSLESS, bases=[first])
    (tmp_path / "pictures").mkdir()
    for name, data in pictures.files():
        (tmp_path / "pictures" / name).write_bytes(data())
    scripts = {d: called((tmp_path / "pictures" / f"{d}.js").read_bytes()) for d in pictures.pixels}
    assert {d: script[4] for d, script in scripts.items()} == {
        first: None, second: first, third: second, other: None, small: None, clear: None
    }  # fmt: skip
    assert len(scripts[second][3]) < 0.5 * len(scripts[first][3])
    for digest, expected in pictures.pixels.items():
        np.testing.assert_array_equal(kept.pixels(tmp_path, digest), expected)
    # Whatever was added before stays as it was.
    assert pictures.add(near, LOSSLESS) == second and pictures.bases[second] == first
