"""A result shows itself as a picture: its PNG is ``image()`` without alpha, the top row first."""

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from fixedpipe.pipeline import (
    GEFORCE_256,
    INFINITE_REALITY,
    Clear,
    Scissor,
    above,
    beside,
    execute,
    execute_ideal,
)
from fixedpipe.pipeline.framebuffers.pictures import deep_picture, png, to_codes

WIDTH, HEIGHT = 5, 3
TOP, BOTTOM = (200, 100, 50), (10, 20, 30)


def decoded(data):
    """The picture of a PNG file of 16 bits a component, which pillow would cut to bytes: uint16 [h, w, 3], or
    [h, w]. Rows are filtered as Up or not at all.
    """
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    chunks, place = {}, 8
    while place < len(data):
        (length,) = struct.unpack(">I", data[place : place + 4])
        kind, body = data[place + 4 : place + 8], data[place + 8 : place + 8 + length]
        assert data[place + 8 + length :][:4] == struct.pack(">I", zlib.crc32(kind + body))
        chunks[kind], place = chunks.get(kind, b"") + body, place + 12 + length
    width, height, bits, kind, *ways = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    assert (bits, ways) == (16, [0, 0, 0])
    shape = {0: (height, width), 2: (height, width, 3)}[kind]
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, -1)
    above, out = 0, []
    for row in rows:
        above = row[1:] + {0: 0, 2: above}[row[0]]
        out.append(above)
    return np.concatenate(out).view(">u2").reshape(shape).astype(np.uint16)


def colored(label, bytes_, **others):
    return Clear(label=label, color=(*(b / 255 for b in bytes_), 0.0), **others)


# Alpha is zero: a viewer that took it for transparency would show nothing.
FRAME = (colored("below", BOTTOM), colored("above", TOP, scissor=Scissor(0, HEIGHT - 1, WIDTH, 1)))
RESULTS = {
    "machine": lambda: execute(FRAME, GEFORCE_256, WIDTH, HEIGHT),
    "ideal": lambda: execute_ideal(FRAME, WIDTH, HEIGHT),
}


@pytest.mark.parametrize("made", RESULTS.values(), ids=RESULTS)
def test_a_results_png_is_its_picture_top_row_first_and_opaque(made, tmp_path):
    result = made()
    result.save(tmp_path / "picture.PNG")
    for source in (io.BytesIO(result._repr_png_()), tmp_path / "picture.PNG"):
        with Image.open(source) as file:
            assert (file.format, file.mode) == ("PNG", "RGB")
            picture = np.asarray(file)
        np.testing.assert_array_equal(picture, result.image()[..., :3])
        assert (picture[0] == TOP).all()
        assert (picture[1:] == BOTTOM).all()


def test_a_prompt_prints_what_a_result_is_and_not_its_arrays():
    assert repr(RESULTS["machine"]()) == "<a frame on GeForce 256, 5x3 pixels>"
    assert repr(RESULTS["ideal"]()) == "<the ideal, 5x3 pixels>"


def test_pictures_are_shown_beside_and_above_each_other():
    machine, ideal = (made() for made in RESULTS.values())
    lower = execute(FRAME[:1], INFINITE_REALITY, WIDTH, 2)  # of more bits than a byte
    row = beside(machine, ideal, times=2)
    assert row.image().shape == (2 * HEIGHT, 4 * WIDTH, 4)
    assert (row.image()[..., 3] == 255).all() and not machine.image()[..., 3].any()
    np.testing.assert_array_equal(row.image()[::2, : WIDTH * 2 : 2, :3], machine.image()[..., :3])
    np.testing.assert_array_equal(row.image()[1::2, WIDTH * 2 + 1 :: 2, :3], ideal.image()[..., :3])
    column = above(machine, lower)
    np.testing.assert_array_equal(column.image()[:HEIGHT, :, :3], machine.image()[..., :3])
    np.testing.assert_array_equal(column.image()[HEIGHT:, :, :3], lower.image()[..., :3])
    with Image.open(io.BytesIO(above(row, row)._repr_png_())) as file:
        assert file.size == (4 * WIDTH, 4 * HEIGHT)
    assert repr(row) == "<a picture of pictures, 20x6 pixels>"


def test_arrays_are_shown_beside_each_other():
    codes = np.array([[[1, 2, 3], [4, 5, 6]]], np.uint8)
    reals = np.array([[[-1.0, 0.5, 2.0, 0.0]]], np.float32)
    expected = [[[1, 2, 3, 255], [4, 5, 6, 255], [0, 128, 255, 255]]]
    assert beside(codes, reals).image().tolist() == expected


def test_what_cannot_be_shown_together_is_said():
    machine = RESULTS["machine"]()
    with pytest.raises(ValueError, match="The pictures are 5x3, 10x6; give one or more of one height"):
        beside(machine, beside(machine, times=2))
    with pytest.raises(ValueError, match="The pictures are 5x3, 10x3; give one or more of one width"):
        above(machine, beside(machine, machine))
    with pytest.raises(ValueError, match="The pictures are none"):
        beside()
    for times in (0, 1.5, 2.0, True, 17, "2"):
        with pytest.raises(
            ValueError, match=f"to be {times!r} times as large; give a whole number from 1 to 16"
        ):
            beside(machine, times=times)
    with pytest.raises(ValueError, match=r"A picture is int64 \(1, 1, 3\); give what has a picture"):
        beside(np.zeros((1, 1, 3), np.int64))
    with pytest.raises(ValueError, match=r"A picture is uint8 \(4, 4\)"):
        above(np.zeros((4, 4), np.uint8))
    with pytest.raises(ValueError, match="A picture is str"):
        above("picture.png")
    with pytest.raises(ValueError, match="holds NaN"):
        above(np.full((1, 1, 3), np.nan))


def test_a_picture_of_another_kind_is_refused_before_anything_is_written(tmp_path):
    result = RESULTS["ideal"]()
    with pytest.raises(ValueError, match=r"saved as PNG; name it .*picture\.png, not .*picture\.jpg"):
        result.save(tmp_path / "picture.jpg")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("channels", [(), (3,), (4,)])
def test_sixteen_bits_a_component_come_back_as_they_were(channels):
    picture = np.random.default_rng(7).integers(0, 65536, (9, 6, *channels), np.uint16)
    picture[0, 0], picture[0, 1], picture[1, 0] = 0, 65535, 65535
    kept = picture[..., :3] if channels else picture
    np.testing.assert_array_equal(decoded(png(picture)), kept)
    if channels:  # pillow takes the high bytes, and refuses a file that is no PNG
        with Image.open(io.BytesIO(png(picture))) as file:
            np.testing.assert_array_equal(np.asarray(file), kept >> 8)


def test_a_picture_of_other_numbers_is_refused():
    for picture in (np.zeros((2, 2, 3)), np.zeros((2, 2, 3), np.int32), np.zeros((2, 2, 2), np.uint16)):
        with pytest.raises(ValueError, match=r"give uint8 or uint16 \[h, w, 3 or 4\]"):
            png(picture)


def test_every_code_of_twelve_bits_has_a_place_of_its_own_in_sixteen():
    codes = np.arange(4096)
    deep = deep_picture(codes, 12)
    assert (deep.dtype, deep[0], deep[-1]) == (np.uint16, 0, 65535)
    np.testing.assert_array_equal(deep, np.floor(codes * 65535 / 4095 + 0.5))
    np.testing.assert_array_equal(np.floor(deep * (4095 / 65535) + 0.5), codes)


def test_a_machine_of_twelve_bits_saves_its_codes(tmp_path):
    commands = (Clear(label="clear", color=(0.3, 0.7002, 1.0, 0.5)),)
    result = execute(commands, INFINITE_REALITY, 4, 2)
    codes = [1229, 2867, 4095]  # 1228.5, half up, 2867.3
    assert result.bits == 12 and (result.codes()[..., :3] == codes).all()
    result.save(tmp_path / "picture.png")
    assert (decoded((tmp_path / "picture.png").read_bytes()) == deep_picture(codes, 12)).all()
    assert result.image().dtype == np.uint8
    ideal = execute_ideal(commands, 4, 2)
    np.testing.assert_array_equal(ideal.codes(12), to_codes(ideal.color, 12))
    np.testing.assert_array_equal(ideal.codes(), ideal.image())


def test_reals_become_the_nearest_code_halves_up():
    reals = np.array([-1.0, 0.0, 0.4999, 0.5, 1.5, 254.5, 255.0, 300.0]) / 255.0
    assert to_codes(reals, 8).tolist() == [0, 0, 0, 1, 2, 255, 255, 255]
