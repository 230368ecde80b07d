"""Heights from files of every kind: all their bits, turned as they say, without what was not measured, and in
one line what they were taken for.
"""

import io
import logging
import struct

import numpy as np
import pytest
from PIL import Image, ImageOps

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures import maps, picture_files
from fixedpipe.effects.user_pictures.inputs import read_picture
from fixedpipe.effects.user_pictures.reading import filling, without_missing
from tests.effects.cli.test_cli import refusal_of, run
from tests.support.user_files import of_png, tiff

ROWS, COLUMNS = 12, 16
HEIGHTS = (20000 + 20 * np.arange(ROWS * COLUMNS)).reshape(ROWS, COLUMNS).astype(np.uint16)
SEEN = {
    1: lambda a: a,
    2: np.fliplr,
    3: lambda a: np.rot90(a, 2),
    4: np.flipud,
    5: lambda a: np.swapaxes(a, 0, 1),
    6: lambda a: np.rot90(a, -1),
    7: lambda a: np.fliplr(np.rot90(a)),
    8: np.rot90,
}


def components(count):
    return np.stack([HEIGHTS + k for k in range(count)], axis=-1)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_png_files_of_16_bits_keep_them_all(tmp_path, count):
    pytest.importorskip("OpenImageIO")
    path = tmp_path / "deep.png"
    path.write_bytes(of_png(components(count)))
    expected = components(count) if count > 1 else HEIGHTS
    got = read_picture(str(path))
    assert got.dtype == np.uint16
    np.testing.assert_array_equal(got, expected)
    levels = len(np.unique(maps.height_field(str(path)).heights.round(9)))
    assert levels == HEIGHTS.size


TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "f4", "f8")


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("kind", TYPES)
def test_tiff_files_of_all_types_are_read_as_they_are(tmp_path, kind, order, big):
    for library in ("OpenImageIO", "tifffile"):
        pytest.importorskip(library)
    info = np.finfo(kind) if kind[0] == "f" else np.iinfo(kind)
    values = np.linspace(0.0, 100.0, ROWS * COLUMNS).reshape(ROWS, COLUMNS).astype(kind)
    values[0, :2] = info.min, info.max
    path = tmp_path / "a.tif"
    for compression in (1, 8):
        path.write_bytes(tiff(values, order=order, big=big, compression=compression))
        got = read_picture(str(path))
        assert got.dtype == values.dtype
        np.testing.assert_array_equal(got, values)


@pytest.mark.parametrize("kind", TYPES)
def test_tiles_of_all_types_are_read_as_they_are(tmp_path, kind):
    tifffile = pytest.importorskip("tifffile")
    pytest.importorskip("OpenImageIO")
    values = (np.arange(40 * 33 * 3).reshape(40, 33, 3) % 97 + 1).astype(kind)
    path = tmp_path / "tiles.tif"
    for picture, meant in ((values, "rgb"), (values[..., 0], "minisblack")):
        for packed in (None, "zlib"):
            tifffile.imwrite(path, picture, tile=(16, 16), compression=packed, photometric=meant)
            got = read_picture(str(path))
            assert got.dtype == picture.dtype
            np.testing.assert_array_equal(got, picture)


@pytest.mark.parametrize("count", [2, 3, 4])
@pytest.mark.parametrize("kind", ["u1", "u2", "i2", "u4", "f4"])
def test_tiff_files_of_several_components_keep_their_bits(tmp_path, kind, count):
    pytest.importorskip("OpenImageIO")
    path = tmp_path / "a.tif"
    values = (components(count) % 256 if kind == "u1" else components(count)).astype(kind)
    path.write_bytes(tiff(values))
    np.testing.assert_array_equal(read_picture(str(path)), values)


@pytest.mark.parametrize("orientation", SEEN)
def test_one_rule_turns_pictures_of_every_kind(tmp_path, orientation):
    pytest.importorskip("OpenImageIO")
    grey = (HEIGHTS // 256).astype(np.uint8)
    grey[0, 0], grey[0, 1] = 255, 0
    exif = Image.Exif()
    exif[274] = orientation
    tag = [(274, 3, 1, struct.pack("<H", orientation))]
    for name, values in (("a.tif", grey), ("deep.tif", HEIGHTS), ("colors.tif", components(3))):
        (tmp_path / name).write_bytes(tiff(values, tags=tag))
        np.testing.assert_array_equal(read_picture(str(tmp_path / name)), SEEN[orientation](values))
    for name in ("a.png", "a.jpg"):
        Image.fromarray(grey).save(tmp_path / name, exif=exif)
        with Image.open(tmp_path / name) as image:
            seen = np.asarray(ImageOps.exif_transpose(image))
            np.testing.assert_array_equal(read_picture(str(tmp_path / name)), seen)
            given = maps.height_field(image)
        np.testing.assert_array_equal(given.heights, maps.height_field(seen).heights)
        np.testing.assert_array_equal(seen, SEEN[orientation](seen_plain(tmp_path / name)))


def seen_plain(path):
    with Image.open(path) as image:
        return np.asarray(image)


def test_pillows_image_of_16_bits_is_not_cut_to_8(tmp_path):
    (tmp_path / "deep.png").write_bytes(of_png(components(3)))
    with Image.open(tmp_path / "deep.png") as image, pytest.raises(ValueError, match="give the file's name"):
        maps.height_field(image)


@pytest.mark.parametrize(
    ("kind", "text", "value", "missing"),
    [
        ("f4", "-3.40282e+38", np.finfo("f4").min, True),
        ("f4", "-3.4028234663852886e+38", np.finfo("f4").min, True),
        ("f4", "-1.7976931348623157e+308", np.finfo("f4").min, True),
        ("f4", "-9999", -9999.0, True),
        ("f4", "-9999.1", np.float32(-9999.1), True),
        ("f4", "-9999", -9998.0, False),
        ("f8", "-9999", -9999.0, True),
        ("f8", "-9999", -9999.001, False),
        ("i2", "-32768", -32768, True),
        ("i2", "-32768.0", -32768, True),
        ("u1", "256", 0, False),
        ("u2", "0", 0, True),
        ("f4", "none", -9999.0, False),
    ],
)
def test_what_was_not_measured_is_refused_without_an_extra(tmp_path, monkeypatch, kind, text, value, missing):
    monkeypatch.setitem(__import__("sys").modules, "tifffile", None)
    pytest.importorskip("OpenImageIO")
    values = (HEIGHTS // 100).astype(kind)
    values[3, 4:6] = value
    tag = (42113, 2, len(text) + 1, text.encode() + b"\0")
    path = tmp_path / "gaps.tif"
    path.write_bytes(tiff(values, tags=[tag]))
    if missing:
        with pytest.raises(Refusal, match=r"has 2 values of .*, which stand for what was not measured"):
            read_picture(str(path))
    else:
        np.testing.assert_array_equal(read_picture(str(path)), values)


def asc(values, head="ncols {c}\nnrows {r}\nxllcorner 1\nyllcorner 2\ncellsize 30\nNODATA_value -9999\n"):
    rows, columns = values.shape
    lines = "\n".join(" ".join(map(str, row)) for row in values.tolist())
    return (head.format(r=rows, c=columns) + lines + "\n").encode()


def test_grids_of_heights_are_read(tmp_path):
    signed = HEIGHTS.astype(np.int64) - 22000
    (tmp_path / "a.asc").write_bytes(asc(signed))
    np.testing.assert_array_equal(read_picture(str(tmp_path / "a.asc")), signed)
    (tmp_path / "b.grd").write_bytes(
        asc(signed / 8, "NROWS {r}\r\nNCOLS {c}\r\nXLLCENTER 0\r\nDX 1\r\nDY 1\r\n")
    )
    np.testing.assert_array_equal(read_picture(str(tmp_path / "b.grd")), signed / 8)
    for maximum, kind in ((255, "u1"), (65535, ">u2"), (30000, ">u2")):
        values = HEIGHTS if kind == ">u2" else HEIGHTS % 256
        data = f"P5\n# by hand\n{COLUMNS} {ROWS}\n{maximum}\n".encode() + values.astype(kind).tobytes()
        (tmp_path / "a.pgm").write_bytes(data)
        got = read_picture(str(tmp_path / "a.pgm"))
        assert got.dtype == np.dtype(kind).newbyteorder("=")
        np.testing.assert_array_equal(got, values)
    text = " ".join(map(str, HEIGHTS.ravel()))
    (tmp_path / "text.pgm").write_text(f"P2 {COLUMNS} {ROWS} 65535\n{text}\n")
    np.testing.assert_array_equal(read_picture(str(tmp_path / "text.pgm")), HEIGHTS)
    metres = (np.arange(1201 * 1201).reshape(1201, 1201) % 3000 - 400).astype(">i2")
    metres.tofile(tmp_path / "N46E007.hgt")
    np.testing.assert_array_equal(read_picture(str(tmp_path / "N46E007.hgt")), metres)


def test_grids_that_are_none_or_have_gaps_are_refused(tmp_path):
    signed = HEIGHTS.astype(np.int64) - 22000
    signed[2, 3] = -9999
    voids = np.full((1201, 1201), 100, ">i2")
    voids[7, 7:10] = -32768
    for name, data, words in (
        ("gap.asc", asc(signed), "has 1 value of -9999"),
        ("usual.asc", asc(signed, "ncols {c}\nnrows {r}\n"), "has 1 value of -9999"),
        ("few.asc", asc(HEIGHTS)[:-9], "the 192 values that it names"),
        ("many.asc", asc(HEIGHTS) + b"1 2\n", "has more than the 192 values that it names"),
        ("words.asc", asc(HEIGHTS) + b"end\n", "values that are no numbers"),
        ("none.asc", b"ncols 0\nnrows 2\n", "has no header of an ASCII grid"),
        ("a.hgt", b"12345678", "has 8 bytes, and .hgt files have 1201 x 1201"),
        ("gap.hgt", voids.tobytes(), "has 3 values of -32768"),
        ("few.pgm", b"P5 4 4 255\n1234", "has 4 of the 16 values"),
        ("over.pgm", b"P5 2 2 9\n1234", "has values above 9"),
        ("none.pgm", b"P5 4 -4 255\n1234", "damaged PGM header"),
    ):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(Refusal, match=words.replace(".", r"\.")):
            read_picture(str(tmp_path / name))


@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_all_versions_of_npy_are_read(tmp_path, version):
    path = tmp_path / "a.npy"
    for array in (HEIGHTS, np.asfortranarray(HEIGHTS.astype(">f4"))):
        data = io.BytesIO()
        np.lib.format.write_array(data, array, version)
        path.write_bytes(data.getvalue())
        np.testing.assert_array_equal(read_picture(str(path)), array)


@pytest.fixture
def heights(tmp_path):
    path = tmp_path / "hills.tif"
    path.write_bytes(tiff(HEIGHTS, tags=[(274, 3, 1, struct.pack("<H", 6))]))
    return path


@pytest.mark.parametrize(
    "arguments",
    [
        ("bump", "{}", "--out", "out.png", "--size", 8),
        ("roughness", "{}", "--out", "out.npz", "--size", 8),
        ("scatter", "{}", "--out", "out.png", "--size", 8, "--texels", 4, "--paths", 2, "--directions", 4),
        ("brdf", "{}", "--out", "out.npz", "--texels", 2, "--directions", 2, "--grid", 2, "--samples", 1),
        ("figures", "F003-1", "--set", "height_field={}", "--out", "out"),
    ],
)
def test_commands_say_in_a_line_what_they_took_heights_for(heights, tmp_path, monkeypatch, arguments):
    pytest.importorskip("OpenImageIO")
    monkeypatch.chdir(tmp_path)
    result = run(*(str(a).format(heights) for a in arguments))
    line = f"{heights}: 12 x 16, uint16, 20000 to 23820, turned as its orientation 6 says"
    assert result.stderr.splitlines().count(line) == 1, result.output


def test_alpha_is_no_height_in_what_is_said(tmp_path, caplog):
    pytest.importorskip("OpenImageIO")
    caplog.set_level(logging.INFO, "fixedpipe.reading")
    (tmp_path / "deep.png").write_bytes(of_png(np.stack([HEIGHTS, np.full_like(HEIGHTS, 65535)], axis=-1)))
    read_picture(str(tmp_path / "deep.png"))
    assert caplog.messages == [f"{tmp_path / 'deep.png'}: 16 x 12 of 2 components, uint16, 20000 to 23820"]


def test_without_the_library_of_deep_pictures_its_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "OpenImageIO", None)
    (tmp_path / "deep.png").write_bytes(of_png(components(3)))
    said = refusal_of("roughness", tmp_path / "deep.png", "--out", tmp_path / "out.npz")
    assert "pip install 'fixedpipe[probes]'" in said
    # Heights of 16 bits and floats need nothing.
    (tmp_path / "grey.png").write_bytes(of_png(components(1)))
    np.testing.assert_array_equal(read_picture(str(tmp_path / "grey.png")), HEIGHTS)
    for kind in ("u2", "i4", "f4"):
        (tmp_path / "a.tif").write_bytes(tiff(HEIGHTS.astype(kind)))
        np.testing.assert_array_equal(read_picture(str(tmp_path / "a.tif")), HEIGHTS)


def test_orientations_come_from_one_table():
    for number, seen in SEEN.items():
        np.testing.assert_array_equal(picture_files.turned(HEIGHTS, number), seen(HEIGHTS))


# ----------------------------------------------------------------------------------- heights that are missing


def holed(dtype, nothing):
    """A plane with a hole of 3 x 5 and one pixel, and the same whole."""
    rows, columns = np.mgrid[:13, :18]
    whole = (100 + 10 * rows + 4 * columns).astype(dtype)
    missing = np.zeros(whole.shape, bool)
    missing[4:7, 6:11] = missing[0, 17] = True
    return np.where(missing, nothing, whole).astype(dtype), whole, missing


@pytest.mark.parametrize("dtype", ["f4", "f8"])
def test_missing_heights_are_refused_and_with_fill_take_what_is_around_them(tmp_path, dtype):
    values, whole, missing = holed(dtype, np.nan)
    path = tmp_path / "holed.npy"
    np.save(path, values)
    with pytest.raises(Refusal, match=r"has 16 values of NaN, .* fill them before\. bump,"):
        read_picture(str(path))
    with filling():
        filled = read_picture(str(path))
    assert filled.dtype == whole.dtype
    np.testing.assert_array_equal(filled[~missing], whole[~missing])
    # What fills the hole is between means of squares of 4 pixels, of which the next reaches 6 pixels away.
    assert np.abs(filled - whole)[missing].max() <= 6 * (10 + 4)
    with pytest.raises(Refusal):  # no longer
        read_picture(str(path))


def test_a_number_that_stands_for_what_is_missing_is_filled_too(tmp_path):
    values, whole, missing = holed("i4", -9999)
    path = tmp_path / "holed.asc"
    lines = [
        "ncols 18",
        "nrows 13",
        "nodata_value -9999",
        *(" ".join(map(str, row)) for row in values.tolist()),
    ]
    path.write_text("\n".join(lines) + "\n")
    with filling():
        filled = read_picture(str(path))
    np.testing.assert_array_equal(filled[~missing], whole[~missing])
    assert ((filled > whole.min()) & (filled < whole.max()))[missing].all()


def test_one_missing_height_is_the_mean_of_those_around_by_hand():
    """Of a square of two by two, the three others; and a file of nothing has nothing to fill with."""
    values = np.array([[3.0, 6.0], [np.nan, 9.0]])
    with filling():
        filled, notes = without_missing("a", values, np.isnan(values), "NaN")
        assert filled.tolist() == [[3.0, 6.0], [6.0, 9.0]]
        assert notes == ("1 of 4 values filled by the mean of those around",)
        whole = np.array([[3, 4], [0, 9]], np.uint8)
        assert without_missing("a", whole, whole == 0, "0")[0].tolist() == [[3, 4], [5, 9]]
        with pytest.raises(Refusal, match="has no value but NaN, so there is none to fill with"):
            without_missing("a", np.full((3, 4), np.nan), np.ones((3, 4), bool), "NaN")


def test_bump_fills_and_says_so_and_what_map_the_heights_became(tmp_path):
    path, out = tmp_path / "holed.npy", tmp_path / "out.png"
    np.save(path, holed("f8", np.nan)[0])
    drawing = ("bump", path, "--mesh", "plane", "--size", 16, "--out", out)
    assert "with --fill" in refusal_of(*drawing) and not out.exists()
    done = run(*drawing, "--fill")
    assert "16 of 234 values filled by the mean of those around" in done.stderr
    assert "holed.npy: 18 x 13 heights, fitted to a map of 32 x 16 texels" in done.stdout
    assert "fitted to a map of 8 x 8 texels" in run(*drawing, "--fill", "--map-size", 8).stdout


def test_the_view_turns_the_camera_of_bump_and_material(tmp_path):
    path, out = tmp_path / "heights.npy", tmp_path / "out.png"
    np.save(path, holed("f8", 0.0)[1])
    for command in (("bump", path), ("material", "ward")):
        drawing = (*command, "--mesh", "teapot", "--size", 48, "--out", out)
        pictures = []
        for view in ((), ("--view", "0,1,3.6"), ("--view", "0,2,7.2"), ("--view", "1,1,-2")):
            run(*drawing, *view)
            pictures.append(out.read_bytes())
        assert pictures[0] == pictures[1] == pictures[2] != pictures[3]
        assert "The eye looks along y" in refusal_of(*drawing, "--view", "0,5,0")
