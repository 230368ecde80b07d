"""``fixedpipe scatter``: heights good and bad, what each machine can draw, and that light is added."""

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.scattering import light_transport
from fixedpipe.effects.user_pictures import inputs, maps, picture_files, scattering
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL, PROFILES
from tests.effects.cli.test_cli import refusal_of, run

SMALL = ("--size", 32, "--texels", 16, "--directions", 24, "--paths", 24)
WAYS = {
    "OCTANE": "pixel textures",
    "GEFORCE_256": "lookups by the host",
    "GEFORCE_3": "texture shaders",
    "NV2A": "texture shaders",
    "G400": "offset textures",
    "IDEAL": "by the ideal",
}


def hills():
    x = np.arange(24) / 24.0
    return np.abs(np.sin(2.0 * np.pi * x))[:, None] * np.abs(np.sin(2.0 * np.pi * x))


@pytest.fixture
def heights(tmp_path):
    path = tmp_path / "heights.npy"
    np.save(path, hills())
    return path


def halves(path):
    picture = np.asarray(Image.open(path), np.float64)
    return picture[:, :32, :3], picture[:, 32:, :3]


@pytest.mark.parametrize("machine", WAYS)
def test_every_machine_that_can_draws_the_field_without_and_with_scattering(heights, tmp_path, machine):
    out = tmp_path / "out.png"
    result = run("scatter", heights, "--out", out, *SMALL, "--profile", machine, "--height-scale", 0.3)
    assert result.exit_code == 0, result.output
    assert WAYS[machine] in result.stdout and "16x16 texels" in result.stdout
    without, scattered = halves(out)
    assert without.shape == scattered.shape == (32, 32, 3)
    # Light is added and none is taken, but for the roundings of some bytes.
    assert (scattered - without).min() >= -2.0
    assert scattered.mean() > 1.02 * without.mean()


def test_what_the_ideal_draws_is_the_float_method_on_the_same_paths():
    found = scattering.way_of(IDEAL)
    field = scattering.field_of(maps.height_field(hills()), found, 16, 0.3, 0.7)
    seen = scattering.spread(field, 24)
    light = np.array((0.6, 0.0, 0.8))
    frame = scattering.commands(field, seen, light, IDEAL, 32, found=found, paths=24, bounces=2)
    # Before direct light is drawn again the sum stands in the lower left corner.
    until = max(k for k, c in enumerate(frame) if c.label == "direct light alone")
    window = execute_ideal(frame[:until], 64, 32).color[::-1][:16, :16, :3]
    paths = light_transport.sequences(24, 2, 24)
    expected = light_transport.scattered(field, seen, paths, light)
    assert np.abs(window - expected).max() < 1e-6


@pytest.mark.parametrize("machine", WAYS)
@pytest.mark.parametrize("where", ["framebuffer", "accumulation-buffer", "host"])
def test_every_machine_sums_paths_wherever_it_is_asked_to(heights, tmp_path, machine, where):
    out, again = tmp_path / "out.png", tmp_path / "again.png"
    small = ("--size", 64, "--texels", 16, "--paths", 8, "--bounces", 2, "--height-scale", 0.3)
    for path in (out, again):
        more = ("--out", path, *small, "--profile", machine, "--accumulation", where)
        result = run("scatter", heights, *more)
        assert result.exit_code == 0, result.output
    assert out.read_bytes() == again.read_bytes()
    picture = np.asarray(Image.open(out), np.float64)[..., :3]
    assert picture[:, 64:].mean() > picture[:, :64].mean()


def test_a_seed_gives_other_paths(heights, tmp_path):
    pictures = []
    for n, more in enumerate(((), ("--seed", 5))):
        path = tmp_path / f"{n}.png"
        small = ("--out", path, *SMALL, "--height-scale", 0.3, "--bounces", 2)
        result = run("scatter", heights, *small, *more)
        assert result.exit_code == 0, result.output
        pictures.append(path.read_bytes())
    assert pictures[0] != pictures[1]


def test_any_number_of_threads_gives_the_same_bits():
    found = scattering.way_of(PROFILES["GEFORCE_3"])
    field = scattering.field_of(maps.height_field(hills()), found, 16, 0.3, 0.7)
    seen = scattering.spread(field, 12)
    frame = scattering.commands(field, seen, (0.6, 0.0, 0.8), PROFILES["GEFORCE_3"], 16, found=found, paths=6)
    one, two = (execute(frame, PROFILES["GEFORCE_3"], 32, 16, threads=n).image() for n in (1, 2))
    assert (one == two).all()


def test_a_photograph_colours_the_field_and_nothing_is_scattered_by_black(heights, tmp_path):
    red = tmp_path / "red.png"
    Image.fromarray(np.tile(np.uint8([[[200, 20, 20]]]), (8, 8, 1))).save(red)
    out = tmp_path / "out.png"
    assert run("scatter", heights, "--out", out, *SMALL, "--colors", red).exit_code == 0
    without, scattered = halves(out)
    inside = (slice(10, 22), slice(10, 22))
    assert scattered[inside][..., 0].mean() > 3.0 * scattered[inside][..., 1].mean()
    assert run("scatter", heights, "--out", out, *SMALL, "--albedo", 0.0).exit_code == 0
    without, scattered = halves(out)
    assert (without == scattered).all()


def test_without_texels_the_field_has_as_many_as_its_heights_and_the_machine():
    own = maps.height_field(np.arange(30.0 * 20).reshape(30, 20) % 7)
    sizes = [scattering.field_of(own, found, None, 0.1, 0.5).columns for found in scattering.DRAWN]
    assert sizes == [32] * 4
    large = maps.height_field(np.arange(300.0 * 200).reshape(300, 200) % 7)
    sizes = [scattering.field_of(large, found, None, 0.1, 0.5).columns for found in scattering.DRAWN]
    assert sizes == [128, 128, 128, 64]


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.full((8, 8), 3.0), "at least two different heights"),
        (np.ones((1, 1)), "at least two different heights"),
        (np.array([[0.0, 1.0]]), "two rows and two columns"),
        (np.array([[0.0, np.nan], [1.0, 2.0]]), "has 1 value of NaN"),
    ],
)
def test_heights_that_are_none_are_refused(tmp_path, values, said):
    path, out = tmp_path / "bad.npy", tmp_path / "out.png"
    np.save(path, values)
    assert said in refusal_of("scatter", path, "--out", out, *SMALL)
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--directions", 0), "--directions is 0"),
        (("--paths", 0), "--paths is 0"),
        (("--bounces", 5), "--bounces is 5"),
        (("--light", "1,0,-0.5"), "not above the horizon"),
        (("--light", "1,0"), "three numbers"),
        (("--light", "0,0,0"), "not all zero"),
        (("--bounces", -1), "--bounces is -1"),
        (("--seed", -1), "--seed is -1"),
        (("--accumulation", "hots"), "Did you mean host?"),
        (("--albedo", 1.2), "The albedo is 1.2"),
        (("--albedo", "nan"), "The albedo is nan"),
        (("--albedo", 0.5, "--colors", "sample:gravel"), "leave one of them out"),
        (("--height-scale", 0.0), "the field is flat"),
        (("--height-scale", "nan"), "the field is flat"),
        (("--texels", 12), "power of two"),
        (("--texels", 256), "allow up to 128"),
        (("--texels", 64), "give --size 64 or more"),
        (("--exposure", 0.0), "The exposure is 0"),
        (("--profile", "OPENGL_1_2"), "Give one of GEFORCE_256"),
        (("--profile", "OCTAN"), "Did you mean OCTANE"),
        (("--profile", "G400", "--texels", 128, "--size", 256), "allow up to 64"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_a_sentence(heights, tmp_path, options, said):
    out = tmp_path / "out.png"
    assert said in refusal_of("scatter", heights, "--out", out, *SMALL, *options)
    assert not out.exists()


def test_a_panel_that_is_too_small_is_refused_before_rays_are_cast(heights, tmp_path, monkeypatch):
    monkeypatch.setattr(scattering, "precompute", None)
    asked = ("--out", tmp_path / "out.png", *SMALL, "--texels", 64)
    monkeypatch.setattr(scattering, "_can_draw", lambda found, profile: True)
    assert "give --size 64 or more" in refusal_of("scatter", heights, *asked)


def test_files_that_cannot_be_read_are_refused(heights, tmp_path):
    out, empty = tmp_path / "out.png", tmp_path / "empty.png"
    empty.touch()
    assert "is empty" in refusal_of("scatter", empty, "--out", out, *SMALL)
    assert "no file" in refusal_of("scatter", tmp_path / "none.png", "--out", out, *SMALL)
    assert "no file" in refusal_of(
        "scatter", heights, "--out", out, *SMALL, "--colors", tmp_path / "none.png"
    )
    assert "There is no sample" in refusal_of("scatter", "sample:nothing", "--out", out, *SMALL)
    assert not out.exists()


# --------------------------------------------------------------------------------------- elevation models


def test_elevation_models_of_kinds_that_pillow_does_not_read_are_read(tmp_path, monkeypatch):
    tifffile = pytest.importorskip("tifffile")
    heights = 400.0 + 90.0 * hills()
    for name, options in (
        ("doubles.tif", {}),
        ("tiles.tif", {"tile": (16, 16), "compression": "zlib"}),
        ("big.tif", {"bigtiff": True}),
    ):
        tifffile.imwrite(tmp_path / name, heights, **options)
        assert (inputs.read_picture(str(tmp_path / name)) == heights).all()
    monkeypatch.setattr(picture_files, "PIXELS", 100)
    out = tmp_path / "out.png"
    said = refusal_of("scatter", tmp_path / "tiles.tif", "--out", out, *SMALL)
    assert "24 x 24 pixels" in said and "more memory with --limit 1" in said
    monkeypatch.undo()
    assert run("scatter", tmp_path / "tiles.tif", "--out", out, *SMALL).exit_code == 0


def test_heights_that_were_not_measured_are_refused(tmp_path):
    tifffile = pytest.importorskip("tifffile")
    path, out = tmp_path / "gaps.tif", tmp_path / "out.png"
    heights = (400.0 + 90.0 * hills()).astype(np.float32)
    tag = (42113, "s", 0, "-9999", True)
    tifffile.imwrite(path, heights, extratags=[tag])
    assert inputs.read_picture(str(path)).shape == heights.shape
    heights[3, 4:6] = -9999.0
    tifffile.imwrite(path, heights, extratags=[tag])
    assert "has 2 values of -9999" in refusal_of("scatter", path, "--out", out, *SMALL)
    assert not out.exists()
