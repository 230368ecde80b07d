"""Panoramas and light probes of a user's own become maps of directions, or are refused with a sentence."""

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.geometry import cube_maps, parabolic_maps
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures import probes
from tests.effects.cli.test_cli import refusal_of, run

ROWS = 64


def directions(columns):
    """What each pixel of a panorama, or of a light probe as wide as high, looks at: [64, columns, 3]."""
    across = (np.arange(columns) + 0.5) / columns
    down = (np.arange(ROWS) + 0.5) / ROWS
    s, t = np.meshgrid(across, down)
    if columns == 2 * ROWS:
        lon, lat = 2.0 * np.pi * (s - 0.5), np.pi * (0.5 - t)
        return np.stack([np.cos(lat) * np.sin(lon), np.sin(lat), -np.cos(lat) * np.cos(lon)], axis=-1)
    x, y = 2.0 * s - 1.0, 1.0 - 2.0 * t
    radius = np.hypot(x, y)
    sine = np.sin(np.pi * radius) / radius
    return np.stack([x * sine, y * sine, -np.cos(np.pi * radius)], axis=-1)


@pytest.mark.parametrize(("columns", "error"), ((2 * ROWS, 0.04), (ROWS, 0.08)))
def test_a_picture_of_directions_gives_maps_of_directions(tmp_path, columns, error):
    file = tmp_path / "directions.npy"
    np.save(file, 0.5 * directions(columns) + 0.5)
    found = probes.probe(str(file))
    assert found.panorama == (columns != ROWS)
    for kind, expected in (
        ("cube", cube_maps.directions(16)),
        ("parabolic", parabolic_maps.directions(16)),
    ):
        shown = 2.0 * probes.maps(found, kind, 16) - 1.0
        # A light probe has its last ring of pixels at +z, where the whole circle is one direction.
        away = expected[..., 2] < 0.98
        assert np.abs(shown - expected)[away].max() <= error, kind


def test_a_texel_is_the_mean_of_what_it_covers():
    colors = np.zeros((512, 1024, 3))
    colors[256, 512] = 1.0e6
    small, large = (probes.maps(probes.Probe(colors, "a spark"), "cube", n) for n in (8, 256))
    power = [
        float((6 * [cube_maps.solid_angles(n)] * cube[..., 0]).sum())
        for n, cube in ((8, small), (256, large))
    ]
    pixel = (np.pi / 512) ** 2 * 1.0e6
    assert power == pytest.approx([pixel, pixel], rel=0.05)


@pytest.mark.parametrize("ending", ("hdr", "exr"))
def test_files_of_high_dynamic_range_keep_their_range(tmp_path, ending):
    openimageio = pytest.importorskip("OpenImageIO")
    colors = np.full((8, 16, 3), 0.5, np.float32)
    colors[2, 4] = (512.0, 256.0, 128.0)
    path = tmp_path / f"probe.{ending}"
    out = openimageio.ImageOutput.create(str(path))
    out.open(str(path), openimageio.ImageSpec(16, 8, 3, "float"))
    out.write_image(colors)
    out.close()
    np.testing.assert_allclose(probes.probe(str(path)).colors, colors, rtol=0.01)
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(Refusal, match="cannot be read to its end"):
        probes.probe(str(path))


def test_without_the_library_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "OpenImageIO", None)
    path = tmp_path / "probe.exr"
    path.write_bytes(b"\x76\x2f\x31\x01 and more")
    with pytest.raises(Refusal, match=r"pip install 'fixedpipe\[probes\]'"):
        probes.probe(str(path))


def test_a_cross_shows_the_front_in_its_middle_and_neighbours_beside_it():
    faces = 0.5 * cube_maps.directions(8) + 0.5
    cross = probes.picture(faces, 1.0)
    assert cross.shape == (24, 32, 3)
    inside = cross.reshape(3, 8, 4, 8, 3)[1].transpose(1, 0, 2, 3).reshape(4, 8, 8, 3)
    front = inside[1].astype(float) / 127.5 - 1.0
    assert front[..., 2].max() < 0.0
    assert (np.diff(front[..., 0], axis=1) > 0.0).all()
    assert (np.diff(front[..., 1], axis=0) < 0.0).all()
    # Across every edge of the cross directions go on in small steps.
    for a, b in (
        (cross[8:16, 7], cross[8:16, 8]),
        (cross[7, 8:16], cross[8, 8:16]),
        (cross[15, 8:16], cross[16, 8:16]),
    ):
        assert np.abs(a.astype(int) - b).max() < 30
    assert probes.picture(0.5 * parabolic_maps.directions(8) + 0.5, 1.0).shape == (8, 16, 3)


@pytest.mark.parametrize(
    ("values", "said"),
    (
        (np.ones((8, 12, 3)), "twice as wide as high"),
        (np.ones((8, 16, 5)), "one to four components"),
        (np.full((8, 16, 3), np.nan), "NaN or infinity"),
        (np.ones((1, 2, 3)), "twice as wide as high"),
    ),
)
def test_what_is_no_environment_is_refused(tmp_path, values, said):
    file = tmp_path / "bad.npy"
    np.save(file, values)
    with pytest.raises(Refusal, match=said):
        probes.probe(str(file))


@pytest.fixture
def panorama(tmp_path):
    """A panorama of bytes."""
    file = tmp_path / "room.png"
    Image.fromarray(np.full((16, 32, 3), (200, 100, 50), np.uint8)).save(file)
    return file


@pytest.mark.parametrize(
    ("kind", "more", "name", "shape"),
    (
        ("cube", (), "faces", (6, 8, 8, 3)),
        ("parabolic", (), "discs", (2, 8, 8, 3)),
        ("prefilter", ("--exponent", "20"), "faces", (6, 8, 8, 3)),
    ),
)
def test_the_command_writes_floats_and_pictures(panorama, tmp_path, kind, more, name, shape):
    floats, shown = tmp_path / "maps.npz", tmp_path / "maps.png"
    for out in (floats, shown):
        result = run("environment", panorama, "--to", kind, "--size", 8, "--out", out, *more)
        assert result.exit_code == 0, result.output
        assert "panorama of 32x16 pixels" in result.stdout
    with np.load(floats) as arrays:
        assert arrays[name].shape == shape
        # A constant environment stays constant.
        np.testing.assert_allclose(
            arrays[name], np.broadcast_to(np.array((200, 100, 50)) / 255.0, shape), rtol=1e-5
        )
    picture = np.asarray(Image.open(shown))
    assert (picture.reshape(-1, 3).max(axis=0) == (200, 100, 50)).all()


@pytest.mark.parametrize(
    ("arguments", "said"),
    (
        (("--to", "cub"), "Did you mean cube?"),
        (("--to", "cube", "--exponent", "3"), "--exponent would be ignored"),
        (("--to", "prefilter", "--exponent", "0"), "The exponent is 0.0; give a number"),
        (("--to", "cube", "--exposure", "-1"), "The exposure is -1; give a positive number"),
        (("--to", "cube", "--out", "x.jpg"), "PNG or NPZ"),
    ),
)
def test_the_command_refuses_with_a_sentence(panorama, tmp_path, arguments, said):
    out = () if "--out" in arguments else ("--out", tmp_path / "maps.png")
    assert said in refusal_of("environment", panorama, *arguments, *out)
    assert not (tmp_path / "maps.png").exists()
