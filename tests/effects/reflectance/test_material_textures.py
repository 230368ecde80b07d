"""Material textures and their authoring functions (K21)."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.passes.encoding import vector_and_factor_texels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, material_textures
from fixedpipe.effects.scenes.marble import MARBLE
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL
from fixedpipe.pipeline.textures.images import texture_2d

# ---------------------------------------------------------------------------------------------- the exponent


def test_the_exponent_is_stored_in_the_binormals_alpha():
    flat = material_textures.isotropic(4, 2, 0.5)
    assert (flat.exponent == 2.0).all()
    assert (flat.binormal_texture(GEFORCE_256).levels[0][0, ..., 3] == 4).all()
    exponent = np.array([[1.0, 2.0, 64.0, 128.0]] * 2)
    varied = replace(flat, exponent=exponent)
    stored = varied.binormal_texture(GEFORCE_256).levels[0][0, ..., 3]
    assert stored[0].tolist() == [2, 4, 128, 255]
    assert (varied.binormal_texture(IDEAL).ideal[0][0, ..., 3] == exponent / 128.0).all()


@pytest.mark.parametrize("exponent", [0.5, 129.0, np.nan])
def test_an_exponent_outside_its_range_is_refused(exponent):
    with pytest.raises(ValueError, match="give values from 1 to 128"):
        replace(material_textures.isotropic(4, 4, 0.5), exponent=exponent)


def test_baking_keeps_the_exponent():
    flat = replace(material_textures.isotropic(2, 2, 0.5), exponent=9.0)
    axes = (np.broadcast_to(row, (2, 2, 3)) for row in np.eye(3)[[2, 0, 1]])
    assert (anisotropic_blinn_phong.bake(flat, *axes).exponent == 9.0).all()


# ------------------------------------------------------------------------------------------------- authoring


def test_gradient_noise_is_periodic_smooth_and_zero_at_its_corners():
    at = np.arange(8) / 8.0
    assert (height_fields.gradient_noise(at, at[::-1], 8, 3) == 0.0).all()
    s, t = np.random.Generator(np.random.PCG64(1)).random((2, 500))
    noise = height_fields.gradient_noise(s, t, 8, 3)
    assert np.allclose(height_fields.gradient_noise(s + 1.0, t - 2.0, 8, 3), noise, atol=1e-12)
    assert 0.5 < np.abs(noise).max() <= 1.5
    # No jump or crease: second differences of a step are of the second order everywhere.
    step = 1e-4
    bend = height_fields.gradient_noise(s + step, t, 8, 3) - 2 * noise
    bend = bend + height_fields.gradient_noise(s - step, t, 8, 3)
    assert np.abs(bend).max() < 20.0 * (8 * step) ** 2


def frames_are_orthonormal(material):
    frame = material.normals, material.tangents, material.binormals
    return all(np.allclose(dot(a, b), float(a is b), atol=1e-5) for a in frame for b in frame)


GOLD = {"bumps": 6, "depth": 2.0, "alpha_x": 0.5, "alpha_y": 0.8, "spread": 10.0, "stroke_depth": 0.2}


def test_gold_has_bumps_under_strokes_along_s():
    gold = material_textures.gold(64, **GOLD, k_s=(0.6, 1.0))
    assert frames_are_orthonormal(gold)
    slope = -gold.normals[..., :2] / gold.normals[..., 2:]
    assert 0.7 < np.abs(slope[..., 0]).max() <= 2.0
    plain = material_textures.gold(64, **{**GOLD, "stroke_depth": 0.0, "spread": 0.0}, k_s=(1.0, 1.0))
    strokes = slope + plain.normals[..., :2] / plain.normals[..., 2:]
    assert np.allclose(strokes[..., 0], 0.0, atol=1e-12)
    assert 0.1 < np.abs(strokes[..., 1]).max() <= 0.2 + 1e-12
    across, along = (np.abs(np.diff(strokes[..., 1], axis=axis)).mean() for axis in (0, 1))
    assert across > 3.0 * along
    level = np.abs(slope).max(axis=-1) < 0.1
    angle = np.degrees(np.arctan2(gold.tangents[..., 1], gold.tangents[..., 0]))[level]
    assert 4.0 < np.abs(angle).max() <= 10.6
    assert (gold.k_s.min() >= 0.6) & (gold.k_s.max() <= 1.0)


def test_marble_has_raised_veins_that_are_darker_and_wider_along_b():
    marble = material_textures.marble(256, **MARBLE)
    material, dark = marble.material, marble.darkness
    assert frames_are_orthonormal(material)
    assert (material.alpha_x == MARBLE["alpha_x"]).all()
    stone, veins = MARBLE["alpha_y"]
    assert np.allclose(material.alpha_y, stone + (veins - stone) * dark)
    assert 0.05 < (dark > 0.5).mean() < 0.35
    luminance = marble.colors.mean(axis=-1)
    assert luminance[dark > 0.9].max() < 0.5 * luminance[dark == 0.0].min()
    # Raised: on the flank that faces +s the stone gets lighter towards +s.
    change = np.roll(dark, -1, 1) - np.roll(dark, 1, 1)
    flank = np.abs(change) > 0.2
    assert (np.sign(material.normals[..., 0]) == -np.sign(change))[flank].mean() > 0.99
    assert (material.normals[dark == 0.0][:, 2] > 0.99).mean() > 0.95


def test_materials_that_are_kept_cannot_be_written_to():
    with pytest.raises(ValueError, match="read-only"):
        material_textures.marble(256, **MARBLE).material.k_s[0, 0] = 0.0


# --------------------------------------------------------------------------- the diffuse pass in colour


def test_a_colour_map_multiplies_both_lights_of_the_diffuse_pass():
    colors = np.array([[(0.9, 0.5, 0.1), (0.2, 0.6, 1.0)], [(0.4, 0.4, 0.4), (1.0, 0.0, 0.7)]])
    direction, panel = normalize(np.array([0.3, 0.4, 1.0])), Panel(0, 0, 2, 2)

    def commands(profile):
        loading, names = material_textures.load(material_textures.isotropic(2, 2, 0.5), "flat", profile)
        return (
            panel.clear((0.0, 0.0, 0.0)),
            loading[0],
            material_textures.load_colors(colors, "colours", profile),
            *diffuse_bump.diffuse_pass(
                surfaces.plane(),
                names.normal,
                orthographic_view(panel),
                Light(tuple(direction)),
                profile,
                color=(0.8, 0.7, 0.5),
                ambient=(0.1, 0.05, 0.2),
                color_map="colours",
            ),
        )

    expected = colors * (direction[2] * np.array([0.8, 0.7, 0.5]) + np.array([0.1, 0.05, 0.2]))
    assert np.allclose(execute_ideal(commands(IDEAL), 2, 2).color[::-1, :, :3], expected, atol=1e-6)
    machine = execute(commands(GEFORCE_256), GEFORCE_256, 2, 2).framebuffer.color[::-1]
    assert np.abs(machine[..., :3] / 255.0 - expected).max() < 3.0 / 255
    # The gate stays in destination alpha: min(1, 4 n.l).
    assert (machine[..., 3] == 255).all()


@pytest.mark.parametrize(("upward", "share"), [(-0.2, 0.0), (0.0, 0.0), (1 / 16, 0.5), (0.25, 1.0)])
def test_a_self_shadow_fades_the_light_where_the_surface_itself_turns_away(upward, share):
    """The bump leans towards the light: without the self-shadow it would be lit in all four."""
    light = np.array([np.sqrt(1.0 - upward * upward), 0.0, upward])
    bump, panel = np.array([0.8, 0.0, 0.6]), Panel(0, 0, 2, 2)
    color, ambient, brick = np.array([0.8, 0.7, 0.5]), np.array([0.1, 0.05, 0.2]), np.array([0.9, 0.5, 0.3])

    def commands(profile):
        normals = texture_2d(vector_and_factor_texels(bump[None, None], 1.0, profile))
        return (
            panel.clear((0.0, 0.0, 0.0)),
            TexImage(label="load a bump", texture="bump", image=normals),
            material_textures.load_colors(brick[None, None], "colours", profile),
            *diffuse_bump.diffuse_pass(
                surfaces.plane(),
                "bump",
                orthographic_view(panel),
                Light(tuple(light.tolist())),
                profile,
                color=tuple(color.tolist()),
                ambient=tuple(ambient.tolist()),
                color_map="colours",
                self_shadow=True,
            ),
        )

    expected = brick * (share * (bump @ light) * color + ambient)
    assert np.allclose(execute_ideal(commands(IDEAL), 2, 2).color[..., :3], expected, atol=1e-6)
    machine = execute(commands(GEFORCE_256), GEFORCE_256, 2, 2).framebuffer.color
    # Eight times half a byte's error of l_z.
    assert np.abs(machine[..., :3] / 255.0 - expected).max() < 8.0 / 255


def test_a_self_shadow_without_a_colour_map_is_refused():
    view = orthographic_view(Panel(0, 0, 2, 2))
    with pytest.raises(ValueError, match="give the colour map's name too"):
        diffuse_bump.diffuse_pass(
            surfaces.plane(),
            "bump",
            view,
            Light((0.0, 0.0, 1.0)),
            IDEAL,
            color=(1.0, 1.0, 1.0),
            self_shadow=True,
        )


def test_an_alpha_that_textures_cannot_hold_is_said():
    said = "The textures of flat hold alphas of 0.25 and more, so 0.2 is drawn as 0.25"
    with pytest.warns(material_textures.StoredAlpha, match=said):
        material_textures.load(material_textures.isotropic(4, 4, 0.2), "flat", GEFORCE_256)
    # Warnings are errors: 0.25 is held as it is.
    material_textures.load(material_textures.isotropic(4, 4, 0.25), "flat", GEFORCE_256)
