"""What a picture's pixels are, and the wrong pictures that a comparison of them has to see."""

import io
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from fixedpipe.pipeline.framebuffers.pictures import whole_png
from fixedpipe.pipeline.golden.differences import Difference, bounds, difference, kinds_differ
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.golden.pixels import pixels_of, pixels_of_png

PICTURE = np.random.default_rng(7).integers(0, 256, (9, 11, 4), np.uint8)
DEEP = np.random.default_rng(8).integers(0, 65536, (5, 6, 3), np.uint16)


def png_of(image, **settings):
    buffer = io.BytesIO()
    image.save(buffer, "PNG", **settings)
    return buffer.getvalue()


@st.composite
def pictures(draw):
    dtype = draw(st.sampled_from([np.uint8, np.uint16]))
    shape = draw(st.tuples(st.integers(1, 9), st.integers(1, 9), st.integers(1, 4)))
    seed = draw(st.integers(0, 2**32 - 1))
    return np.random.default_rng(seed).integers(0, np.iinfo(dtype).max + 1, shape, dtype)


@given(pictures())
def test_a_png_file_keeps_every_bit(picture):
    found = pixels_of_png(whole_png(picture))
    assert found.dtype == picture.dtype
    np.testing.assert_array_equal(found, picture)


@given(pictures(), st.lists(st.integers(0, 4), min_size=9, max_size=9))
def test_16_bits_are_read_through_every_filter(picture, filters):
    # Filters by their definition, byte by byte.  Source: PNG specification, second edition, section 9.2
    deep = picture.astype(np.uint16)
    height, width, components = deep.shape
    rows = deep.astype(">u2").reshape(height, -1).view(np.uint8).astype(int)
    back, above, raw = 2 * components, [0] * rows.shape[1], b""
    for kind, row in zip(filters, rows.tolist(), strict=False):
        left, corner = [0] * back + row, [0] * back + above
        out = []
        for k, value in enumerate(row):
            a, b, c = left[k], above[k], corner[k]
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            out.append((value - (0, a, b, (a + b) // 2, nearest)[kind]) % 256)
        raw += bytes([kind, *out])
        above = row

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 16, (None, 0, 4, 2, 6)[components], 0, 0, 0)
    data = (
        chunk(b"IHDR", head)
        + chunk(b"tEXt", b"a\0b")
        + chunk(b"IDAT", zlib.compress(raw))
        + chunk(b"IEND", b"")
    )
    np.testing.assert_array_equal(pixels_of_png(b"\x89PNG\r\n\x1a\n" + data), deep)


@pytest.mark.parametrize(
    ("given_as", "shape"),
    [
        (PICTURE, (9, 11, 4)),
        (PICTURE[..., 0], (9, 11, 1)),
        (PICTURE[::-1, ::2], (9, 6, 4)),
        (DEEP.astype(">u2"), (5, 6, 3)),
        (Image.fromarray(PICTURE), (9, 11, 4)),
        (Image.fromarray(PICTURE).convert("LA"), (9, 11, 2)),
        (Image.fromarray(DEEP[..., 0]), (5, 6, 1)),
    ],
)
def test_what_a_picture_may_be(given_as, shape):
    found = pixels_of(given_as)
    assert found.shape == shape
    assert found.flags.c_contiguous
    assert found.dtype.isnative
    np.testing.assert_array_equal(found, np.asarray(given_as).reshape(shape))


def test_a_path_is_read_with_all_its_bits(tmp_path):
    (tmp_path / "deep.png").write_bytes(whole_png(DEEP))
    np.testing.assert_array_equal(pixels_of(tmp_path / "deep.png"), DEEP)
    np.testing.assert_array_equal(pixels_of(str(tmp_path / "deep.png")), DEEP)


def rotated():
    exif = Image.Exif()
    exif[0x0112] = 6
    return Image.open(io.BytesIO(png_of(Image.fromarray(PICTURE), exif=exif.tobytes())))


REFUSED = {
    "real numbers": (np.zeros((2, 2, 3), np.float32), "real numbers (float32), whose last bits"),
    "NaN": (np.array([[np.nan, 1.0]]), "float64, 1 of them NaN"),
    "whole numbers": (np.zeros((2, 2), np.int64), "holds int64; golden pictures hold uint8 or uint16"),
    "truths": (np.zeros((2, 2), bool), "holds bool"),
    "no pixels": (np.zeros((0, 4, 4), np.uint8), "no pixel"),
    "a row": (np.zeros(4, np.uint8), "has the shape (4,)"),
    "five components": (np.zeros((2, 2, 5), np.uint8), "1 to 4 of them"),
    "a palette": (Image.fromarray(PICTURE[..., :3]).quantize(8), "has a palette"),
    "other colours": (Image.fromarray(PICTURE[..., :3]).convert("CMYK"), "mode CMYK"),
    "two levels": (Image.fromarray(PICTURE[..., 0]).convert("1"), "mode 1"),
    "a rotation that the file mentions": (rotated(), "tell viewers to turn or mirror it"),
    "16 bits that are cut": (Image.open(io.BytesIO(whole_png(DEEP))), "Pillow cuts them to 8"),
    "a list": ([[1, 2], [3, 4]], "cannot be a list"),
    "nothing": (None, "cannot be a NoneType"),
    "a path to nothing": ("nowhere.png", "nowhere.png cannot be read: No such file"),
    "another file": (__file__, "is no PNG file"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_picture_is_refused_in_a_sentence(name):
    picture, sentence = REFUSED[name]
    with pytest.raises(ValueError) as refused:
        pixels_of(picture)
    assert sentence in str(refused.value)
    assert str(refused.value).endswith(".")


@pytest.mark.parametrize("picture", [PICTURE, DEEP], ids=["8 bits", "16 bits"])
def test_a_png_file_that_is_cut_anywhere_is_refused(picture):
    whole = whole_png(picture)
    # Up to the pixels' own last bytes: what follows them is a checksum, and the end.
    for length in (*range(8, len(whole) - 24, 7), 20, 24, 26, 30):
        with pytest.raises(ValueError):
            pixels_of_png(whole[:length], "it")


def test_a_png_file_that_says_it_is_vast_is_refused():
    data = bytearray(whole_png(DEEP))
    data[16:24] = struct.pack(">II", 2**31 - 1, 2**31 - 1)
    with pytest.raises(ValueError, match="at most 2 GiB"):
        pixels_of_png(bytes(data))


# Pictures that are wrong, each in one thing, of the right one. Every one must be seen, by digest and by
# pixels.
def one_bit_of_alpha(picture):
    wrong = picture.copy()
    wrong[4, 7, 3] ^= 1
    return wrong


def swapped_rows(picture):
    wrong = picture.copy()
    wrong[[2, 3]] = wrong[[3, 2]]
    return wrong


def one_pixel_moved(picture):
    wrong = picture.copy()
    wrong[5, 5], wrong[5, 6] = picture[5, 6], picture[5, 5]
    return wrong


MUST_FAIL = {
    "one bit of alpha": one_bit_of_alpha,
    "the last bit of the last component": lambda p: (
        np.concatenate([p.ravel()[:-1], [p.ravel()[-1] ^ 1]]).astype(np.uint8).reshape(p.shape)
    ),
    "two rows exchanged": swapped_rows,
    "two pixels exchanged": one_pixel_moved,
    "upside down": lambda p: p[::-1],
    "mirrored": lambda p: p[:, ::-1],
    "turned": lambda p: np.rot90(p),
    "red and blue exchanged": lambda p: p[..., [2, 1, 0, 3]],
    "one column fewer": lambda p: p[:, :-1],
    "one row fewer": lambda p: p[:-1],
    "one row more": lambda p: np.concatenate([p, p[-1:]]),
    "the same bytes as another shape": lambda p: p.reshape(11, 9, 4),
    "without alpha": lambda p: p[..., :3],
    "grey": lambda p: p[..., 0],
    "16 bits of the same values": lambda p: p.astype(np.uint16),
    "16 bits of the same colours": lambda p: p.astype(np.uint16) * 257,
    "alpha multiplied": lambda p: np.concatenate(
        [(p[..., :3].astype(int) * p[..., 3:] // 255).astype(np.uint8), p[..., 3:]], axis=2
    ),
}


@pytest.mark.parametrize("name", MUST_FAIL)
def test_every_wrong_picture_is_seen(name):
    right, wrong = pixels_of(PICTURE), pixels_of(MUST_FAIL[name](PICTURE))
    assert digest(right) != digest(wrong)
    assert kinds_differ(right, wrong) or difference(right, wrong) is not None


def test_16_bits_cut_to_8_are_seen():
    cut = (DEEP >> 8).astype(np.uint8)
    assert digest(pixels_of(DEEP)) != digest(pixels_of(cut))
    assert "uint16" in kinds_differ(pixels_of(DEEP), pixels_of(cut))
    low = DEEP ^ np.uint16(1)
    assert difference(DEEP, low).largest == 1


def test_a_palette_that_shows_the_same_is_seen():
    few = np.tile(np.array([[0, 0, 0], [255, 0, 0]], np.uint8), (4, 4, 1))
    image = Image.open(io.BytesIO(png_of(Image.fromarray(few).quantize(2))))
    with pytest.raises(ValueError, match="palette"):
        pixels_of(image)


def test_a_difference_says_how_many_how_much_and_where():
    wrong = PICTURE.copy()
    wrong[1, 2, 0] ^= 1
    wrong[6, 9, 1] = PICTURE[6, 9, 1] ^ 0x40
    found = difference(PICTURE, wrong)
    assert (found.count, found.largest, found.box, found.pixel) == (2, 64, (2, 1, 10, 7), (9, 6))
    assert (found.first, found.second) == (tuple(PICTURE[6, 9].tolist()), tuple(wrong[6, 9].tolist()))
    assert not found.alpha_alone
    assert "2 pixels differ by at most 64, from (2, 1) to (9, 6); most at (9, 6)" in str(found)
    assert difference(PICTURE, PICTURE.copy()) is None
    assert difference(PICTURE, one_bit_of_alpha(PICTURE)).alpha_alone
    with pytest.raises(ValueError, match="11x9 pixels of colour and alpha, uint8"):
        difference(PICTURE, PICTURE[1:])


def test_the_digest_of_bytes_is_what_it_was():
    # Accepted digests of figures rest on it: SHA-256 of "2x3x4", an end of line, and the bytes.
    import hashlib

    picture = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
    assert digest(picture) == hashlib.sha256(b"2x3x4\n" + bytes(range(24))).hexdigest()
    deep = np.array([[[258]]], np.uint16)
    assert digest(deep) == hashlib.sha256(b"1x1x1 uint16\n\x02\x01").hexdigest()
    with pytest.raises(ValueError, match="int32"):
        digest(picture.astype(np.int32))


def test_bounds_are_inclusive_pairs():
    assert bounds(4, "pixels") == (0, 4)
    assert bounds((1, 4), "pixels") == (1, 4)
    for wrong in (-1, (3, 2), (1, 2, 3), (0.5, 1), (True, 2), (-1, 2)):
        with pytest.raises(ValueError, match="pixels is"):
            bounds(wrong, "pixels")
    assert isinstance(difference(PICTURE, one_bit_of_alpha(PICTURE)), Difference)


@pytest.mark.parametrize("data", [b"", b"a text", b"\x89PNG\r\n\x1a\n", b"\x89PNG\r\n\x1a\n" + bytes(40)])
def test_what_is_no_png_file_is_said_without_pythons_words(data):
    with pytest.raises(ValueError, match=r"a\.png is no whole PNG file") as refused:
        pixels_of_png(data, "a.png")
    assert "object at" not in str(refused.value) and "<" not in str(refused.value)
