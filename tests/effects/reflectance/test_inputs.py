"""What the techniques of document 004 are given wrongly is refused in a sentence, not drawn."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import emboss
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.reflectance import (
    banks_without_lookup,
    blinn_phong_by_host,
    dependent_lookups,
    dot_product_lookups,
    future_board,
    imaging_subset,
    lookup_framework,
    material_textures,
    phong_schlick_lafortune,
    phong_schlick_lafortune_copies,
    pixel_textures,
    plain_multitexturing,
)
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_3, GEFORCE_256, MULTITEXTURE, OCTANE, OPENGL_1_2

NAN = float("nan")
MATERIAL = material_textures.brushed(
    8, 8, material_textures.Brushing.ALONG_S, alpha_x=0.5, alpha_y=0.9, spread=10.0
)
SURFACE, VIEW, LIGHT = surfaces.plane(), orthographic_view(Panel(0, 0, 8, 8)), Light((0.3, 0.4, 1.0))
GREY = {"color": (0.5, 0.5, 0.5)}
BLACK = {"background": (0, 0, 0), "color": (0, 0, 0), "ambient": (0, 0, 0)}
SCHLICK = {"roughness": 0.1, "isotropy": 0.5, "reflectance": 0.5, **BLACK}
LOBE = {"coefficients": (-0.9, -0.9, 0.9), "exponent": 8.0, **BLACK}


def of_names(load, passes, profile, **usual):
    """Passes that take the names of what ``load`` loads."""

    def make(**given):
        _, names = load(MATERIAL, "m", profile)
        return passes(SURFACE, names, VIEW, LIGHT, profile, **{**usual, **given})

    return make


def of_material(passes, profile, **usual):
    return lambda **given: passes(SURFACE, MATERIAL, VIEW, LIGHT, profile, **{**usual, **given})


def of_heights(passes, profile):
    _, height_map = emboss.load(np.eye(8), "h", profile)
    return lambda **given: passes(SURFACE, height_map, VIEW, LIGHT, profile, **{**GREY, **given})


def load_others(material, name, profile):
    return phong_schlick_lafortune.load(material, name, profile, LOBE["coefficients"])


EFFECTS = {
    "imaging subset": of_material(imaging_subset.commands, OCTANE, **GREY),
    "pixel textures, Banks": of_material(pixel_textures.banks, OCTANE),
    "pixel textures, Blinn-Phong": of_material(pixel_textures.blinn_phong, OCTANE),
    "pixel textures, Ward": of_material(pixel_textures.ward, OCTANE),
    "pixel textures, diffuse": of_material(pixel_textures.diffuse, OCTANE, **GREY),
    "Phong": of_names(load_others, phong_schlick_lafortune.phong_passes, GEFORCE_3, **BLACK),
    "Phong by copies": of_material(phong_schlick_lafortune_copies.phong_copies, OCTANE, **BLACK),
    "Schlick": of_names(load_others, phong_schlick_lafortune.schlick_passes, GEFORCE_3, **SCHLICK),
    "Schlick by copies": of_material(phong_schlick_lafortune_copies.schlick_copies, OCTANE, **SCHLICK),
    "Lafortune": of_names(
        load_others, phong_schlick_lafortune.lafortune_passes, GEFORCE_3, exponent=8.0, **BLACK
    ),
    "Lafortune by copies": of_material(phong_schlick_lafortune_copies.lafortune_copies, OCTANE, **LOBE),
    "dot products, Banks": of_names(
        dot_product_lookups.load_banks, dot_product_lookups.banks_pass, GEFORCE_3
    ),
    "lookups, Ward": of_names(dependent_lookups.load, dependent_lookups.ward_passes, GEFORCE_3),
    "future board, Ward": of_names(future_board.load, future_board.ward, FUTURE),
    "R*": of_names(banks_without_lookup.load, banks_without_lookup.specular_passes, GEFORCE_256),
    "plain multitexturing": of_names(
        plain_multitexturing.load, plain_multitexturing.unsigned_passes, MULTITEXTURE
    ),
    "by the host": of_names(material_textures.load, blinn_phong_by_host.blinn_phong, GEFORCE_256),
    "emboss, one unit": of_heights(emboss.one_unit_passes, OPENGL_1_2),
    "emboss, two units": of_heights(emboss.two_unit_passes, MULTITEXTURE),
    "emboss, combiners": of_heights(emboss.combiner_passes, GEFORCE_256),
}
HIGHLIGHTS = [name for name in EFFECTS if "diffuse" not in name and "emboss" not in name]
LIT = [name for name in EFFECTS if "diffuse" in name or "emboss" in name or "copies" in name]


@pytest.mark.parametrize("name", EFFECTS)
def test_what_is_right_is_drawn(name):
    assert EFFECTS[name]()


@pytest.mark.parametrize(
    "color", [(NAN, 0.0, 0.0), (2.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (1.0, 1.0), 1.0, "red"]
)
@pytest.mark.parametrize(
    ("name", "parameter"),
    [*((name, "specular") for name in HIGHLIGHTS), *((n, p) for n in LIT for p in ("color", "ambient"))],
)
def test_colours_are_three_numbers_from_0_to_1(name, parameter, color):
    with pytest.raises(ValueError, match="give red, green and blue from 0 to 1"):
        EFFECTS[name](**{parameter: color})


@pytest.mark.parametrize("strength", [NAN, -0.5, 2.0, (1.0, 1.0, 1.0), "white"])
@pytest.mark.parametrize("name", [name for name in EFFECTS if "emboss" in name])
def test_the_strength_of_an_embossed_highlight_is_one_number(name, strength):
    with pytest.raises(ValueError, match="The highlight's strength is"):
        EFFECTS[name](specular=strength)


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        *((n, {"bits": 7}, "bits is 7; give one of 8, 12") for n in EFFECTS if "pixel textures" in n),
        (
            "pixel textures, Banks",
            {"exponent": 0.0},
            r"The bracket's exponent is 0\.0; give a positive number",
        ),
        ("pixel textures, Banks", {"exponent": NAN}, "The bracket's exponent is nan"),
        ("pixel textures, Blinn-Phong", {"up_to": "sum"}, "drawn is 'sum'; give one of UpTo"),
        ("by the host", {"up_to": "lookup"}, "How far it is drawn is 'lookup'; give one of UpTo"),
        ("pixel textures, Ward", {"largest_s": 0.0}, r"The largest S is 0\.0; give a positive number"),
        ("pixel textures, Ward", {"largest_m": NAN}, "The largest m is nan"),
        ("lookups, Ward", {"largest_s": 3.0}, r"The largest S is 3\.0; give one of 2\.0, 4\.0, 8\.0"),
        *((n, {"roughness": 0.0}, "Schlick's roughness is") for n in ("Schlick", "Schlick by copies")),
        *((n, {"isotropy": -1.0}, "Schlick's isotropy is") for n in ("Schlick", "Schlick by copies")),
        *((n, {"reflectance": NAN}, "Schlick's reflectance is") for n in ("Schlick", "Schlick by copies")),
        *((n, {"exponent": NAN}, "Lafortune's exponent is") for n in ("Lafortune", "Lafortune by copies")),
        ("Lafortune by copies", {"coefficients": (1.0, 1.0)}, "coefficients are .*; give three numbers"),
        ("Lafortune by copies", {"coefficients": (NAN, 1.0, 1.0)}, "coefficients are"),
    ],
)
def test_a_number_out_of_its_range_is_refused(name, given, words):
    with pytest.raises(ValueError, match=words):
        EFFECTS[name](**given)


def test_figure_1_has_its_stages():
    textures, given = lookup_framework.woven_domes(8), (VIEW, LIGHT)
    for make in (
        lambda: lookup_framework.by_pixel_textures(SURFACE, textures, *given, OCTANE, stage="w"),
        lambda: lookup_framework.by_host(SURFACE, *given, GEFORCE_256, stage="w"),
        lambda: dependent_lookups.figure_1_passes(SURFACE, *given, GEFORCE_3, stage="w"),
    ):
        with pytest.raises(ValueError, match="The stage is 'w'; give one of 's', 't', 'u', 'v'"):
            make()


@pytest.mark.parametrize("heights", [np.zeros((0, 0)), np.ones(4), np.ones((4, 4, 3))])
def test_heights_to_emboss_are_rows_and_columns(heights):
    with pytest.raises(ValueError, match="The height field has shape"):
        emboss.load(heights, "h", GEFORCE_256)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"tangents": np.zeros((4, 8, 3))}, r"The tangents have shape \(4, 8, 3\)"),
        ({"normals": np.zeros((8, 8))}, r"The normals have shape \(8, 8\)"),
        ({"binormals": np.full((8, 8, 3), NAN)}, "The array of binormals holds NaN or infinity"),
        ({"k_s": 1.5}, r"k_s ranges over 1\.5\.\.1\.5; give values from 0 to 1"),
        ({"k_s": NAN}, "k_s ranges over nan"),
        ({"alpha_x": 0.0}, "alpha_x ranges over 0"),
        ({"exponent": NAN}, "The exponent ranges over nan"),
    ],
)
def test_a_material_is_finite_and_in_range(given, words):
    with pytest.raises(ValueError, match=words):
        replace(MATERIAL, **given)
