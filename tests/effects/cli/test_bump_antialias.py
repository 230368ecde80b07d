"""``fixedpipe bump --antialias``: bumps smaller than a pixel against 64 samples a pixel, and who can."""

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.reflectance import material_textures
from fixedpipe.effects.texture_filtering import mipmapped_materials
from fixedpipe.effects.user_pictures import bumped_mesh
from fixedpipe.effects.user_pictures.bumped_mesh import Antialiasing
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, OCTANE
from tests.effects.cli.test_cli import refusal_of, run

SIZE, SAMPLES = 32, 8


def drawn(size, antialias):
    frame = bumped_mesh.commands(
        height_fields.pebbles(128, 128, 24, 5), bumped_mesh.mesh("sphere"), "gold", (-1.0, 1.0, 1.0), IDEAL,
        size, size, map_size=256, antialias=antialias,
    )  # fmt: skip
    return np.clip(execute_ideal(frame, size, size).color[..., :3], 0.0, 1.0)


def test_roughness_is_nearest_to_many_samples_and_mip_maps_lose_the_highlight_s_width():
    truth = drawn(SIZE * SAMPLES, Antialiasing.NONE)
    truth = truth.reshape(SIZE, SAMPLES, SIZE, SAMPLES, 3).mean(axis=(1, 3))
    pictures = {how: drawn(SIZE, how) for how in Antialiasing}
    errors = {how: float(np.sqrt(((p - truth) ** 2).mean())) for how, p in pictures.items()}
    assert errors[Antialiasing.ROUGHNESS] < 0.6 * min(errors[Antialiasing.NONE], errors[Antialiasing.MIP]), (
        errors
    )
    # Smooth, the ball has a highlight of its own; bumps spread the same light.
    brightest = {how: float(np.sort(p.max(axis=-1).ravel())[-8:].mean()) for how, p in pictures.items()}
    assert brightest[Antialiasing.MIP] > 1.15 * brightest[Antialiasing.ROUGHNESS]


def test_a_level_s_lobe_is_the_material_s_widened_by_the_roughness_pyramid():
    # Gentle bumps, whose normals lean by their slopes; corrugated along both axes, not alike.
    slope_s, slope_t = height_fields.slopes(0.02 * height_fields.pebbles(64, 64, 8, 5))
    alpha = 0.3
    material = material_textures.from_slopes(slope_s, 0.5 * slope_t + 0.3 * slope_s, alpha, alpha)
    levels = mipmapped_materials.covariance_fit(material)
    pyramid = rough.pyramid(np.stack([-slope_s, -0.5 * slope_t - 0.3 * slope_s], axis=-1))
    for lobe, level in zip(levels[3:], pyramid[3:], strict=True):
        rows = np.stack([lobe.scaled_tangents, lobe.scaled_binormals], axis=-2)[..., :2]
        width = np.linalg.inv(np.swapaxes(rows, -1, -2) @ rows)
        found = (width - alpha**2 * np.eye(2)) / 6.0
        a, b, c = (level.covariance[..., k] for k in range(3))
        expected = np.stack([np.stack([a, b], -1), np.stack([b, c], -1)], -2)
        # A lobe that leans is narrower in the mean's plane: alpha^2 K of the 6 K are missing.
        assert np.abs(found - (1.0 - alpha**2 / 6.0) * expected).max() < 0.004 * expected.max()


def test_none_is_what_was_drawn_before_and_others_are_mip_mapped():
    def frame(**how):
        picture = height_fields.pebbles(32, 32, 4, 5)
        mesh = bumped_mesh.mesh("plane")
        return bumped_mesh.commands(picture, mesh, "gold", (0.0, 0.0, 1.0), GEFORCE_256, 16, 16, **how)

    def levels(frame):
        return {command.texture: len(command.image.levels) for command in frame if hasattr(command, "image")}

    assert set(levels(frame()).values()) == {1}
    for how in (Antialiasing.MIP, Antialiasing.ROUGHNESS):
        assert set(levels(frame(antialias=how)).values()) == {6}


@pytest.mark.parametrize("how", Antialiasing)
def test_the_option_draws(tmp_path, how):
    photo, out = tmp_path / "photo.npy", tmp_path / "out.png"
    np.save(photo, height_fields.pebbles(16, 16, 4, 5))
    result = run("bump", photo, "--out", out, "--size", 24, "--antialias", how.value)
    assert result.exit_code == 0, result.output
    assert ("antialiased" in result.stdout) == (how is not Antialiasing.NONE)
    assert np.asarray(Image.open(out)).std() > 1.0


def test_what_cannot_is_a_sentence(tmp_path):
    photo, out = tmp_path / "photo.npy", tmp_path / "out.png"
    np.save(photo, height_fields.pebbles(16, 16, 4, 5))
    assert "There are: none, mip, roughness" in refusal_of("bump", photo, "--out", out, "--antialias", "x")
    more = ("--profile", "OCTANE", "--antialias", "mip")
    said = refusal_of("bump", photo, "--out", out, *more)
    assert "Leave the antialiasing none, or give one of GEFORCE_256" in said and not out.exists()
    with pytest.raises(ValueError, match=r"Antialiasing\.ROUGHNESS"):
        bumped_mesh.commands(
            np.eye(4), bumped_mesh.mesh("plane"), "gold", (0.0, 0.0, 1.0), OCTANE, 16, 16, antialias="rough"
        )
