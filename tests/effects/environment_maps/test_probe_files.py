"""Files of high dynamic range as their headers say: turned, in their windows, by the names of their channels,
in the colours of Rec. 709; and pictures of all directions in every layout.
"""

import logging

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures import probe_files, probes
from tests.effects.cli.test_cli import refusal_of, run
from tests.support.user_files import of_exr, of_luminance_and_chroma, of_radiance, texels

ROWS, COLUMNS = 8, 16
# From XYZ to Rec. 709 with its white of D65, and from white E to D65 by Bradford's transform.
# Source: Lindbloom, "RGB/XYZ Matrices" and "Chromatic Adaptation".
TO_709 = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
]
E_TO_D65 = [
    [0.9531874, -0.0265906, 0.0238731],
    [-0.0382467, 1.0288406, 0.0094060],
    [0.0026068, -0.0030332, 1.0892565],
]


def colors_of(rgbe):
    """What RGBE texels [..., 4] mean: m 2^(e - 136)."""
    exponents = rgbe[..., 3:].astype(int)
    return np.where(exponents, rgbe[..., :3] * 2.0 ** (exponents - 136), 0.0)


def read(folder, data, ending="hdr", layout=None):
    path = folder / f"made.{ending}"
    path.write_bytes(data)
    return probes.probe(str(path), layout)


@pytest.mark.parametrize("y", "+-")
@pytest.mark.parametrize("x", "+-")
@pytest.mark.parametrize("lines", "YX")
def test_all_orientations_of_radiance_give_one_picture(tmp_path, lines, x, y):
    seen = texels(ROWS, COLUMNS)
    stored = seen[:: 1 if y == "-" else -1, :: 1 if x == "+" else -1]
    form = f"{y}Y {{rows}} {x}X {{columns}}"
    if lines == "X":
        stored, form = stored.swapaxes(0, 1), f"{x}X {{rows}} {y}Y {{columns}}"
    found = read(tmp_path, of_radiance(stored, form))
    np.testing.assert_array_equal(found.colors, colors_of(seen))


def test_a_square_probe_is_turned_too(tmp_path):
    seen = texels(8, 8)
    found = read(tmp_path, of_radiance(seen.swapaxes(0, 1), "+X {rows} -Y {columns}"))
    np.testing.assert_array_equal(found.colors, colors_of(seen))


def test_radiance_files_are_read_as_openimageio_reads_them(tmp_path):
    oiio = pytest.importorskip("OpenImageIO")
    found = read(tmp_path, of_radiance(texels()))
    file = oiio.ImageInput.open(str(tmp_path / "made.hdr"))
    np.testing.assert_array_equal(found.colors, file.read_image("float"))
    file.close()


def of_old_runs(picture):
    """Lines of texels, of which equal ones are 1 1 1 n."""
    data = b""
    for line in picture:
        k = 0
        while k < len(line):
            same = 1
            while k + same < len(line) and (line[k + same] == line[k]).all():
                same += 1
            data += line[k].tobytes()
            again = same - 1
            while again:
                data += bytes((1, 1, 1, again & 0xFF))
                again >>= 8
            k += same
    return data


@given(st.data())
def test_texels_come_back_from_lines_of_every_kind(data):
    """Of runs of components, of old runs, and as they are."""
    count = data.draw(st.integers(8, 700))
    few = data.draw(st.lists(st.tuples(*[st.integers(2, 255)] * 4), min_size=1, max_size=4))
    lengths = data.draw(st.lists(st.integers(1, 600), min_size=1, max_size=8))
    line = np.concatenate([[few[k % len(few)]] * n for k, n in enumerate(lengths * count)])[:count].astype(
        np.uint8
    )
    runs = b"\2\2" + count.to_bytes(2, "big")
    for component in line.T:
        k = 0
        while k < count:
            same = 1
            while k + same < count and same < 127 and component[k + same] == component[k]:
                same += 1
            runs += bytes((128 + same, component[k])) if same > 2 else bytes((1, component[k]))
            k += same if same > 2 else 1
    for packed in (runs, of_old_runs(line[None]), line.tobytes()):
        if packed[:2] == b"\2\2" and packed is not runs:
            continue  # Radiance itself would take it for runs of components
        got, at = probe_files._scan_line(memoryview(packed), 0, count)
        np.testing.assert_array_equal(got.T, line)
        assert at == len(packed)


@pytest.mark.parametrize("lines", [(), ("FORMAT=32-bit_rle_rgbe", "a comment", "VIEW= -vp 0 0 0")])
def test_old_runs_plain_texels_and_no_format_are_read(tmp_path, lines):
    flat = np.repeat(texels(ROWS, 2), 8, axis=1)
    head = of_radiance(flat[:0], f"-Y {ROWS} +X {COLUMNS}", lines)
    for data in (of_old_runs(flat), flat.tobytes()):
        np.testing.assert_array_equal(read(tmp_path, head + data).colors, colors_of(flat))


def test_xyz_primaries_and_exposure_are_used_and_said(tmp_path, caplog):
    caplog.set_level(logging.INFO, "fixedpipe.reading")
    seen = texels()
    linear = colors_of(seen)
    found = read(tmp_path, of_radiance(seen, lines=("FORMAT=32-bit_rle_xyze",)))
    expected = np.maximum(linear @ np.array(TO_709 @ np.array(E_TO_D65)).T, 0.0)
    np.testing.assert_allclose(found.colors, expected, atol=2e-3)
    assert "colours made Rec. 709's from XYZ" in caplog.text
    white = np.full_like(seen, 128)
    found = read(tmp_path, of_radiance(white, lines=("FORMAT=32-bit_rle_xyze",)))
    np.testing.assert_allclose(found.colors, 0.5, rtol=1e-5)
    found = read(tmp_path, of_radiance(seen, lines=("EXPOSURE=2", "EXPOSURE= 4.0")))
    np.testing.assert_array_equal(found.colors, linear / 8.0)
    assert "divided by its EXPOSURE of 8" in caplog.text
    wide = "PRIMARIES=0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290"  # BT.2020
    found = read(tmp_path, of_radiance(seen, lines=(wide,)))
    # Source: ITU-R BT.2087, the inverse of its matrix.
    to_709 = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]]
    np.testing.assert_allclose(found.colors, np.maximum(linear @ np.array(to_709).T, 0.0), atol=2e-3)
    assert "its PRIMARIES" in caplog.text


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (of_radiance(texels(), lines=("FORMAT=Radiance_spectra",)), "has the format Radiance_spectra"),
        (of_radiance(texels())[:-1], "cut off"),
        (of_radiance(texels()[:0], "8 x 16"), "no line of its size"),
        (of_radiance(texels(), lines=("EXPOSURE=0",)), "damaged"),
    ],
)
def test_what_no_radiance_file_has_is_said(tmp_path, data, words):
    with pytest.raises(Refusal, match=words):
        read(tmp_path, data)


# ------------------------------------------------------------------------------------------------ OpenEXR


def channels(rows=ROWS, columns=COLUMNS, names="RGB"):
    return {n: (k + np.arange(rows * columns).reshape(rows, columns)) / 64.0 for k, n in enumerate(names)}


def stacked(of):
    return np.stack([of[name] for name in "RGB"], axis=-1)


def test_the_display_window_is_what_is_seen(tmp_path):
    pytest.importorskip("OpenImageIO")
    full = {"full_width": 16, "full_height": 8, "full_x": 0, "full_y": 0}
    part = channels(4, 8)
    found = read(tmp_path, of_exr(tmp_path, part, **full, x=6, y=3), "exr")
    expected = np.zeros((8, 16, 3))
    expected[3:7, 6:14] = stacked(part)
    np.testing.assert_array_equal(found.colors, expected)
    assert "data of 8 x 4 in a window of 16 x 8" in str(found)
    more = channels(12, 24)
    found = read(tmp_path, of_exr(tmp_path, more, **full, x=-4, y=-2), "exr")
    np.testing.assert_array_equal(found.colors, stacked(more)[2:10, 4:20])
    found = read(
        tmp_path, of_exr(tmp_path, channels(), **{**full, "full_x": 3, "full_y": 1}, x=3, y=1), "exr"
    )
    np.testing.assert_array_equal(found.colors, stacked(channels()))


@pytest.mark.parametrize(
    ("names", "of"),
    [
        (("R", "G", "B", "A", "Z"), "RGB"),
        (("Z", "B", "A", "R", "G", *(f"u{k}" for k in range(20))), "RGB"),
        (("depth.Z", "beauty.R", "beauty.G", "beauty.B"), ("beauty.R", "beauty.G", "beauty.B")),
        (("light.R", "light.G", "light.B", "R", "G", "B"), "RGB"),
        (("Y",), "YYY"),
        (("Z", "Y", "A"), "YYY"),
    ],
)
def test_channels_are_found_by_their_names(tmp_path, names, of):
    pytest.importorskip("OpenImageIO")
    made = channels(names=names)
    if "Z" in made:
        made["Z"] = np.full_like(made["Z"], np.inf)
    found = read(tmp_path, of_exr(tmp_path, made), "exr")
    np.testing.assert_array_equal(found.colors, np.stack([made[name] for name in of], axis=-1))


def test_the_first_part_that_has_colours_is_read(tmp_path):
    openexr = pytest.importorskip("OpenEXR")
    made = {name: values.astype(np.float32) for name, values in channels().items()}
    depth = {"Z": np.full((8, 16), 50.0, np.float32), "Y": np.full((8, 16), 5.0, np.float32)}
    path = tmp_path / "parts.exr"
    parts = [
        openexr.Part({}, depth, "depth"),
        openexr.Part({}, made, "beauty"),
        openexr.Part({}, depth, "more"),
    ]
    openexr.File(parts).write(str(path))
    found = probes.probe(str(path))
    np.testing.assert_array_equal(found.colors, stacked(channels()))
    assert "of its part 2, beauty" in str(found)
    openexr.File([openexr.Part({}, {"Z": depth["Z"]}, "depth")]).write(str(path))
    with pytest.raises(Refusal, match="has the channels 'Z'; give a file with R, G and B"):
        probes.probe(str(path))


def test_chromaticities_are_used_and_said(tmp_path):
    pytest.importorskip("OpenImageIO")
    made = channels()
    data = of_exr(tmp_path, made, chromaticities=(1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3))
    found = read(tmp_path, data, "exr")
    expected = np.maximum(stacked(made) @ np.array(TO_709).T, 0.0)
    np.testing.assert_allclose(found.colors, expected, atol=2e-3)
    assert "colours made Rec. 709's from its chromaticities" in str(found)


def test_luminance_and_chroma_are_made_colours(tmp_path, capfd):
    pytest.importorskip("OpenEXR")
    # Of Rec. 709; chroma is linear along both axes, so that what is between is known.
    weights = np.array([0.2126, 0.7152, 0.0722])
    row, column = np.meshgrid(np.arange(8.0), np.arange(16.0), indexing="ij")
    luminance = 0.5 + 0.01 * row
    red, blue = 0.2 + 0.01 * row - 0.005 * column, -0.1 + 0.005 * column
    data = of_luminance_and_chroma(luminance, red[::2, ::2], blue[::2, ::2])
    found = read(tmp_path, data, "exr").colors[:7, :15]
    expected = np.stack([luminance * (1 + red), luminance, luminance * (1 + blue)], axis=-1)
    expected[..., 1] = (luminance - expected[..., [0, 2]] @ weights[[0, 2]]) / weights[1]
    np.testing.assert_allclose(found, expected[:7, :15], atol=2e-3)
    for length in (len(data) - 1, len(data) // 2):
        with pytest.raises(Refusal, match="cannot be read to its end"):
            read(tmp_path, data[:length], "exr")
    assert capfd.readouterr() == ("", "")


# ------------------------------------------------------------------------------------------------ layouts


def faces(size=8):
    """Colours that are directions, of a cube's texels: float64 [6, n, n, 3]."""
    return 0.5 * cube_maps.directions(size) + 0.5


def at_vertical_cross(size=8):
    """A cross of 3:4 whose pixels are the directions that they look at, by planes as seen from inside."""
    out = np.zeros((4 * size, 3 * size, 3))
    across = 2.0 * (np.arange(size) + 0.5) / size - 1.0
    s, t = np.meshgrid(across, -across)  # to the right and up
    one = np.ones_like(s)
    for row, column, direction in (
        (1, 1, (s, t, -one)),
        (1, 0, (-one, t, -s)),
        (1, 2, (one, t, s)),
        (0, 1, (s, one, t)),
        (2, 1, (s, -one, -t)),
        (3, 1, (s, -t, one)),
    ):
        there = np.stack(direction, axis=-1)
        there = there / np.linalg.norm(there, axis=-1, keepdims=True)
        out[row * size : (row + 1) * size, column * size : (column + 1) * size] = 0.5 * there + 0.5
    return out


def layouts():
    """{name: (picture whose colours are directions, layout)}."""
    cube = faces()
    cross = np.zeros((24, 32, 3))
    for face, (row, column) in enumerate(((1, 2), (1, 0), (0, 1), (2, 1), (1, 3), (1, 1))):
        turned = cube[face, ::-1] if face in (2, 3) else cube[face, :, ::-1]
        cross[row * 8 : (row + 1) * 8, column * 8 : (column + 1) * 8] = turned
    return {
        "cross": (cross, "cross"),
        "vertical cross": (at_vertical_cross(), "cross"),
        "strip": (np.concatenate(cube, axis=1), "strip"),
        "vertical strip": (np.concatenate(cube), "strip"),
    }


@pytest.mark.parametrize("name", ["cross", "vertical cross", "strip", "vertical strip"])
def test_faces_of_a_cube_are_read_in_every_layout(tmp_path, name):
    picture, layout = layouts()[name]
    path = tmp_path / "faces.npy"
    np.save(path, picture)
    found = probes.probe(str(path), layout)
    np.testing.assert_allclose(probes.maps(found, "cube", 8), faces(), atol=1e-12)
    with pytest.raises(Refusal, match=rf"as a cube's faces in a {layout} have|--as {layout}"):
        probes.probe(str(path))


def test_the_cross_that_the_command_draws_is_read_by_it(tmp_path):
    source, cross, again = tmp_path / "faces.npy", tmp_path / "cross.png", tmp_path / "again.npz"
    np.save(source, np.concatenate(faces(), axis=1))
    said = run("environment", source, "--as", "strip", "--to", "cube", "--size", 8, "--out", cross)
    assert said.exit_code == 0 and "cube of 6 faces of 8x8 pixels" in said.stdout
    assert (
        run("environment", cross, "--as", "cross", "--to", "cube", "--size", 8, "--out", again).exit_code == 0
    )
    with np.load(again) as arrays:
        np.testing.assert_allclose(arrays["faces"], faces(), atol=0.5 / 255)


def test_a_mirroring_ball_shows_what_it_reflects(tmp_path):
    size = 64
    across = 2.0 * (np.arange(size) + 0.5) / size - 1.0
    x, y = np.meshgrid(across, -across)
    z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    normal = np.stack([x, y, z], axis=-1)
    seen = 2.0 * z[..., None] * normal - np.array([0.0, 0.0, 1.0])  # the eye is at +z, far away
    np.save(tmp_path / "ball.npy", np.clip(0.5 * seen + 0.5, 0.0, 1.0))
    found = probes.probe(str(tmp_path / "ball.npy"), "mirror")
    toward = cube_maps.directions(8)
    away = toward[..., 2] > -0.9  # where the rim's pixels are coarse
    error = np.abs(2.0 * found.radiance(toward) - 1.0 - toward).max(axis=-1)
    assert error[away].max() < 0.1


def test_what_is_said_to_be_a_panorama_is_one(tmp_path):
    np.save(tmp_path / "wide.npy", np.ones((8, 15, 3)))
    assert probes.probe(str(tmp_path / "wide.npy"), "latlong").panorama
    out = tmp_path / "out.npz"
    for shape, layout, words in (
        ((8, 15, 3), None, "15x8 pixels; give a panorama twice as wide as high"),
        ((6, 8, 3), None, "4:3 as a cube's faces in a cross; say so with --as cross"),
        ((8, 6, 3), None, "3:4 as a cube's faces in a cross"),
        ((4, 24, 3), None, "6:1 as a cube's faces in a strip; say so with --as strip"),
        ((24, 4, 3), None, "1:6 as a cube's faces in a strip"),
        ((6, 9, 3), "cross", "give a cross of 4:3 or 3:4"),
        ((6, 9, 3), "ball", "give a square light probe"),
        ((8, 8, 3), "strip", "give a strip of 6:1 or 1:6"),
        ((8, 8, 3), "bal", "Did you mean ball?"),
    ):
        np.save(tmp_path / "a.npy", np.ones(shape))
        more = () if layout is None else ("--as", layout)
        assert words in refusal_of("environment", tmp_path / "a.npy", "--to", "cube", "--out", out, *more)
