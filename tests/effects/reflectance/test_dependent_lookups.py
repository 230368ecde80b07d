"""Dependent lookups of texture shaders (K01, K03, K05, K06, K09) beside the float models."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import product, rotation
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view, perspective_view
from fixedpipe.effects.passes import encoding
from fixedpipe.effects.reflectance import (
    anisotropic_blinn_phong,
    brdfs,
    dependent_lookups,
    dot_product_lookups,
    lookup_framework,
    material_textures,
    sampled_functions,
)
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_3, GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

SIZE = 64
PANEL = Panel(0, 0, SIZE, SIZE)
VIEW = orthographic_view(PANEL)
LIGHT = Light((0.3, 0.4, 0.8))
SURFACE = surfaces.plane()
TO_LIGHT, TO_VIEWER = normalize(np.array(LIGHT.vector)), np.array([0.0, 0.0, 1.0])
HALF = brdfs.half_vector(TO_LIGHT, TO_VIEWER)
MACHINES = (GEFORCE_3, NV2A)

# RMS of a uniform error of one step.
STEP = 12.0**-0.5


def pebbles(alpha_x=0.25, alpha_y=0.6, exponent=2.0):
    """Bumps with brushed tangents, a texel under the centre of each pixel."""
    slopes = height_fields.slopes(height_fields.smooth(height_fields.pebbles(SIZE, SIZE, 4, seed=5), 2) * 0.3)
    material = material_textures.brushed_bumps(
        *slopes, alpha_x=alpha_x, alpha_y=alpha_y, spread=30.0, stroke_depth=0.1, k_s=(0.6, 1.0)
    )
    return replace(material, exponent=exponent)


def picture(commands, profile, view=VIEW, width=SIZE, height=SIZE):
    """Red of the panel, float64, bottom row first; black behind."""
    commands = (view.panel.clear((0.0, 0.0, 0.0)), *commands)
    if profile.arithmetic.exact:
        color = execute_ideal(commands, width, height, threads=1).color
    else:
        color = execute(commands, profile, width, height, threads=1).framebuffer.color / 255.0
    return color[::-1, :, 0]


def rms(a, b):
    return float(np.sqrt(((a - b) ** 2).mean()))


def of_dot_products(material, profile, *, exponent=2.0, view=VIEW, surface=SURFACE, **more):
    loading, names = dot_product_lookups.load_blinn_phong(material, "m", profile, exponent=exponent)
    passes = dot_product_lookups.blinn_phong_pass(
        surface, names, view, LIGHT, profile, first=True, gated=False, **more
    )
    return (*loading, *passes)


def of_banks(material, profile, *, exponent=1.0):
    loading, names = dot_product_lookups.load_banks(material, "m", profile, exponent=exponent)
    return (*loading, *dot_product_lookups.banks_pass(SURFACE, names, VIEW, LIGHT, profile, first=True))


def of_exponents(material, profile, *, view=VIEW, surface=SURFACE, gated=False):
    loading, names = dependent_lookups.load(material, "m", profile)
    return (
        *loading,
        dependent_lookups.load_power(profile),
        dependent_lookups.load_screen(view.panel),
        *dependent_lookups.blinn_phong_passes(surface, names, view, LIGHT, profile, gated=gated),
    )


def of_ward(material, profile, *, largest_s=4.0, specular=(1.0, 1.0, 1.0)):
    loading, names = dependent_lookups.load(material, "m", profile)
    return (
        *loading,
        *dependent_lookups.load_ward_functions(profile, largest_s),
        dependent_lookups.load_screen(PANEL),
        *dependent_lookups.ward_passes(
            SURFACE, names, VIEW, LIGHT, profile, largest_s=largest_s, specular=specular
        ),
    )


def of_figure_1(textures, profile, stage=lookup_framework.RESULT):
    return (
        *lookup_framework.load_tables(profile),
        *lookup_framework.load_textures(textures, profile),
        dependent_lookups.load_screen(PANEL),
        *dependent_lookups.figure_1_passes(SURFACE, VIEW, LIGHT, profile, stage=stage),
    )


def blinn_phong(m, exponent):
    return brdfs.anisotropic_blinn_phong(HALF, m.tangents, m.binormals, m.alpha_x, m.alpha_y, m.k_s, exponent)


# ----------------------------------------------------------------------- one pass: dot products are places


def test_vectors_for_dot_products_are_stored_as_these_read_them():
    """(n - 128)/127: every multiple of 1/127 is a code, and no other scale has all of them."""
    codes = np.arange(-127, 128)
    vectors = np.repeat((codes / 127.0)[None, :, None], 3, axis=-1)
    stored = encoding.dot_product_texels(vectors, 1.0, NV2A)
    np.testing.assert_array_equal(stored[0, :, :3], np.repeat(128 + codes[:, None], 3, axis=-1))


@pytest.mark.parametrize("alpha", [0.2, 0.25, 0.5])
@pytest.mark.parametrize("exponent", [2.0, 16.0])
def test_blinn_phong_by_two_dot_products_is_the_model(alpha, exponent):
    material = pebbles(alpha)
    expected = blinn_phong(material, exponent)
    ideal = picture(of_dot_products(material, IDEAL, exponent=exponent), IDEAL)
    # The table's filter on a curve of second derivative N, texels (1/alpha + 1)/512 apart: an eighth of their
    # square times it; at e = 0, where N = 2 has a kink, a quarter of a texel times the slope.
    texel = (1.0 / alpha + 1.0) / 512.0
    assert np.abs(ideal - expected).max() <= exponent * texel**2 / 4.0 + (
        texel / 2.0 if exponent == 2.0 else 0.0
    )
    # Texels are 1/127 apart and hold alpha / alpha_x; the model's slope in h.t/ax is at most one in the mean.
    # Bytes of the table, of k_s, and of their product add to it.
    bound = STEP / 127.0 / alpha + 3.0 * STEP / 255.0
    for machine in MACHINES:
        got = picture(of_dot_products(material, machine, exponent=exponent), machine)
        assert rms(got, expected) <= bound, machine.name


def test_k05_at_n_2_is_k07():
    """Erratum E004.4: in the models to the last bit; on the ideal but for the table's filter."""
    material = pebbles()
    e = brdfs.lobe(HALF, material.tangents, material.binormals, material.alpha_x, material.alpha_y)
    np.testing.assert_array_equal(blinn_phong(material, 2.0), material.k_s * e)
    loading, names = material_textures.load(material, "m", IDEAL)
    combiners = anisotropic_blinn_phong.specular_pass(SURFACE, names, VIEW, LIGHT, IDEAL, first=True)
    k07 = picture((*loading, *combiners), IDEAL)
    assert rms(picture(of_dot_products(material, IDEAL), IDEAL), k07) < 0.0002
    assert rms(picture(of_exponents(material, IDEAL), IDEAL), k07) < 0.0015


def test_k06_is_the_root_alone():
    """(sqrt e)^1 has an infinite slope where e = 0: there the filter, and a byte's error, show."""
    material = pebbles()
    expected = blinn_phong(material, 1.0)
    assert rms(picture(of_dot_products(material, IDEAL, exponent=1.0), IDEAL), expected) < 0.002
    for machine in MACHINES:
        got = picture(of_dot_products(material, machine, exponent=1.0), machine)
        assert rms(got, expected) < 0.013
    assert blinn_phong(material, 1.0).mean() > 1.2 * blinn_phong(material, 2.0).mean()


def test_what_lies_far_beyond_the_lobe_is_dark():
    """h.t/ax = 4 reads the table four fifths from its middle: a period of 4 would make it a highlight."""
    flat = material_textures.isotropic(8, 8, 0.25)
    for degrees in (10.0, 30.0, 45.0, 60.0, 80.0):
        angle = np.radians(degrees)
        light = Light((float(np.sin(2 * angle)), 0.0, float(np.cos(2 * angle)) + 1e-9))
        for profile in (GEFORCE_3, IDEAL):
            loading, names = dot_product_lookups.load_blinn_phong(flat, "m", profile)
            passes = dot_product_lookups.blinn_phong_pass(
                SURFACE, names, VIEW, light, profile, first=True, gated=False
            )
            got = picture((*loading, *passes), profile)
            half = normalize(np.array(light.vector) + TO_VIEWER)
            expected = max(0.0, 1.0 - (half[0] / 0.25) ** 2)
            np.testing.assert_allclose(got, expected, atol=1e-4 if profile.arithmetic.exact else 0.02)


@pytest.mark.parametrize("exponent", [1.0, 4.0])
def test_banks_by_two_dot_products_is_the_model(exponent):
    material = pebbles()
    expected = brdfs.banks(TO_LIGHT, TO_VIEWER, material.normals, material.tangents, material.k_s, exponent)
    assert rms(picture(of_banks(material, IDEAL, exponent=exponent), IDEAL), expected) < 0.0001
    # Steps of the tangent (1/127, slope at most the exponent's fourth root in the mean), of n, the table,
    # k_s, and two products.
    bound = STEP * (exponent**0.25 / 127.0 + 5.0 / 255.0)
    for machine in MACHINES:
        assert rms(picture(of_banks(material, machine, exponent=exponent), machine), expected) <= bound


def test_banks_keeps_the_sign_of_its_product():
    """Both sides of the cone l.t = -v.t: with v.t and l.t of one sign the bracket falls, else it does not."""
    material = material_textures.isotropic(8, 8, 1.0)
    view = orthographic_view(PANEL)
    tilted = replace(view, eye=(0.6, 0.0, 0.8))
    for x, expected in ((-0.6, 1.0), (0.6, 0.8**2 - 0.6**2)):
        light = Light((x, 0.0, 0.8))
        for profile in (NV2A, IDEAL):
            loading, names = dot_product_lookups.load_banks(material, "m", profile)
            passes = dot_product_lookups.banks_pass(SURFACE, names, tilted, light, profile, first=True)
            got = picture((*loading, *passes), profile)
            np.testing.assert_allclose(got, 0.8 * expected, atol=1e-4 if profile.arithmetic.exact else 0.012)


# ----------------------------------------------------------------- parameters on the screen, then lookups


@pytest.mark.parametrize("alpha", [0.25, 0.125])
def test_an_exponent_per_texel_sharpens_the_highlight_there(alpha):
    exponents = np.broadcast_to(np.linspace(1.0, 128.0, SIZE)[None, :], (SIZE, SIZE))
    material = pebbles(alpha, exponent=exponents)
    expected = blinn_phong(material, exponents)
    ideal = picture(of_exponents(material, IDEAL), IDEAL)
    # The table's filter: between rows of e 1/1024 apart, 128/2 steep.
    assert rms(ideal, expected) < 0.001
    for machine in MACHINES:
        got = picture(of_exponents(material, machine), machine)
        # Eq. 1's error in nine bits (artefact P9: 0.018) where N is two; steeper where N is larger, and the
        # highlight smaller as much.
        assert rms(got, expected) < 0.018, machine.name
    flat = blinn_phong(material, 2.0)
    assert rms(flat, expected) > 0.1, "the exponent matters"


@pytest.mark.parametrize(("alpha", "bound"), [(0.25, 0.009), (0.2, 0.013)])
@pytest.mark.parametrize("largest_s", [2.0, 4.0, 8.0])
def test_ward_by_two_lookups_is_the_model(alpha, bound, largest_s):
    """Nine-bit dot products of a quarter (an eighth, below 1/4) of t/ax, m in steps of 8/255, d, p, S and E
    in bytes: measured at the first correct picture, with half of slack.
    """
    material = pebbles(alpha)
    m = material
    expected = brdfs.ward(
        TO_LIGHT, TO_VIEWER, m.normals, m.tangents, m.binormals, m.alpha_x, m.alpha_y, m.k_s
    )
    assert rms(picture(of_ward(material, IDEAL, largest_s=largest_s), IDEAL), expected) < 0.001
    for machine in MACHINES:
        got = picture(of_ward(material, machine, largest_s=largest_s), machine)
        assert rms(got, expected) <= bound, machine.name


def test_ward_s_colour_and_large_factors_are_restored():
    """k_s / (4 pi ax ay) = 1.24: what is stored over it comes back by a combiner's scale."""
    material = material_textures.isotropic(8, 8, 0.2)
    light = Light((0.9, 0.0, 0.4))
    for profile in (GEFORCE_3, IDEAL):
        loading, names = dependent_lookups.load(material, "m", profile)
        passes = dependent_lookups.ward_passes(SURFACE, names, VIEW, light, profile, specular=(0.9, 0.5, 0.0))
        commands = (
            *loading,
            *dependent_lookups.load_ward_functions(profile),
            dependent_lookups.load_screen(PANEL),
            *passes,
        )
        to_light = normalize(np.array(light.vector))
        n, t, b = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
        expected = 0.9 * brdfs.ward(to_light, TO_VIEWER, n, t, b, 0.2, 0.2)
        np.testing.assert_allclose(
            picture(commands, profile), expected, atol=0.004 if profile.arithmetic.exact else 0.02
        )


@pytest.mark.parametrize("stage", lookup_framework.STAGES)
def test_figure_1_runs_as_the_paper_draws_it(stage):
    textures = lookup_framework.woven_domes(SIZE)
    parameters = textures.parameters(TO_LIGHT, TO_VIEWER)
    minus_s, t, u, eighth = parameters
    expected = dict(
        zip(
            lookup_framework.STAGES,
            (
                *parameters,
                lookup_framework.exponential(minus_s, t),
                lookup_framework.root_of_power(u, eighth),
                textures.evaluated(TO_LIGHT, TO_VIEWER),
            ),
            strict=True,
        )
    )[stage]
    assert rms(picture(of_figure_1(textures, IDEAL, stage), IDEAL), expected) < 0.0005
    for machine in MACHINES:
        # The catalogue's bound.
        assert rms(picture(of_figure_1(textures, machine, stage), machine), expected) <= 1.0 / 128.0


def test_each_pixel_reads_its_own_parameters():
    """A turned surface in perspective, in a panel of no power of two beside the framebuffer's edge: what the
    screen's texture says is what one pass over the surface says.
    """
    panel, width, height = Panel(21, 9, 40, 52), 70, 64
    view = perspective_view(panel, (0.5, -1.0, 4.0))
    surface = surfaces.plane(3, 3).rotated(rotation("y", 30.0))
    material = pebbles()

    def drawn(make, profile):
        return picture(make(material, profile, view=view, surface=surface), profile, view, width, height)

    by_screen, at_once = drawn(of_exponents, IDEAL), drawn(of_dot_products, IDEAL)
    assert (at_once > 0.1).sum() > 200
    # Vectors iterate as colours here and as coordinates there, both in perspective; filters of two tables.
    assert np.abs(by_screen - at_once).max() < 0.02
    machine = drawn(of_exponents, NV2A)
    assert rms(machine, by_screen) < 0.018
    assert machine[:9].max() == machine[:, :21].max() == 0.0


def test_the_gate_darkens_what_faces_away_from_the_light():
    material = material_textures.isotropic(8, 8, 1.0)
    for z in (0.5, 0.1, -0.1):
        light = Light((1.0, 0.0, z))
        to_light = normalize(np.array(light.vector))
        half = normalize(to_light + TO_VIEWER)
        for profile in (GEFORCE_3, IDEAL):
            loading, names = dependent_lookups.load(material, "m", profile)
            passes = dependent_lookups.blinn_phong_passes(SURFACE, names, VIEW, light, profile, gated=True)
            shared = dependent_lookups.load_power(profile), dependent_lookups.load_screen(PANEL)
            got = picture((*loading, *shared, *passes), profile)
            expected = min(1.0, max(0.0, 4.0 * to_light[2])) * (1.0 - half[0] ** 2)
            np.testing.assert_allclose(got, expected, atol=0.001 if profile.arithmetic.exact else 0.03)


# --------------------------------------------------------------------------------- sequences, tables, limits


def test_specular_passes_are_added_to_a_diffuse_pass():
    """Blinn-Phong's through the gate that it left, Banks's as it is; the light is low, so the gate works."""
    material, light = pebbles(1.0, 1.0), Light((0.9, 0.1, 0.15))
    ((normal_map, *_), names) = material_textures.load(material, "m", IDEAL)
    diffuse = diffuse_bump.diffuse_pass(SURFACE, names.normal, VIEW, light, IDEAL, color=(0.2, 0.3, 0.4))
    alone = picture((normal_map, *diffuse), IDEAL)
    n_l = brdfs.lambert(material.normals, normalize(np.array(light.vector)))
    gate = np.clip(4.0 * n_l, 0.0, 1.0)
    assert 100 < (gate < 1.0).sum() < gate.size - 100
    for load, draw, factor in (
        (dot_product_lookups.load_blinn_phong, dot_product_lookups.blinn_phong_pass, gate),
        (dot_product_lookups.load_banks, dot_product_lookups.banks_pass, 1.0),
    ):
        loading, names = load(material, "of dot products", IDEAL)
        given = SURFACE, names, VIEW, light, IDEAL
        specular = picture((*loading, *draw(*given, first=True)), IDEAL)
        assert (specular * (gate < 0.9) > 0.05).sum() > 100
        both = picture((normal_map, *diffuse, *loading, *draw(*given)), IDEAL)
        np.testing.assert_allclose(both, alone + factor * specular, atol=1e-12)


def test_pass_sequences_are_valid_on_every_board_with_texture_shaders():
    material, textures = pebbles(), lookup_framework.woven_domes(SIZE)
    for make in (of_dot_products, of_banks, of_exponents, of_ward):
        for profile in (*MACHINES, FUTURE, IDEAL):
            validate(make(material, profile), profile, SIZE, SIZE)
        with pytest.raises(UnsupportedState, match="GeForce 256"):
            validate(make(material, GEFORCE_256), GEFORCE_256, SIZE, SIZE)
    validate(of_figure_1(textures, NV2A), NV2A, SIZE, SIZE)
    draws = [c for c in of_banks(material, NV2A) if isinstance(c, Draw)]
    assert [len(draws), draws[0].state.texture_shader[2].operation] == [1, Operation.DOT_PRODUCT_TEXTURE_2D]
    lookups = [c for c in of_ward(material, NV2A) if isinstance(c, Draw)][-1].state.texture_shader
    assert [stage.operation for stage in lookups[1:3]] == [
        Operation.DEPENDENT_AR_TEXTURE_2D,
        Operation.DEPENDENT_GB_TEXTURE_2D,
    ]


@pytest.mark.parametrize(
    "tables",
    [
        lambda p: [dot_product_lookups.banks_table(p, n) for n in (1.0, 4.0)],
        lambda p: [dot_product_lookups.blinn_phong_table(n, a, p) for n in (1.0, 16.0) for a in (0.2, 0.25)],
        lambda p: [dependent_lookups.load_power(p).image],
        # E alone: S takes a root and a quotient, which IEEE 754 fixes to the last bit.
        lambda p: [dependent_lookups.load_ward_functions(p)[0].image],
    ],
)
def test_no_library_s_last_bit_decides_a_byte_of_a_table(tables):
    """Roots, powers and exponentials differ between computers by some 1e-16: none may lie so near to where
    bytes part.
    """
    for exact, stored in zip(tables(IDEAL), tables(GEFORCE_3), strict=True):
        values = exact.ideal[0][..., 0] * 255.0
        apart = np.abs(values - np.floor(values) - 0.5)
        assert apart.min() > 1e-9
        np.testing.assert_array_equal(stored.levels[0][..., 0], np.floor(values + 0.5))


def test_what_cannot_be_stored_is_refused():
    with pytest.raises(ValueError, match=r"The smallest alpha is 0\.1; .*dot_product_lookups"):
        dependent_lookups.load(pebbles(0.1), "m", NV2A)
    with pytest.raises(ValueError, match=r"The largest S is 3\.0; give one of 2\.0"):
        dependent_lookups.load_ward_functions(NV2A, 3.0)
    narrow = pebbles(0.125, 0.125)
    with pytest.raises(ValueError, match=r"k_s / \(4 pi ax ay\) is .*Give larger alphas"):
        of_ward(narrow, NV2A)
    validate(of_ward(narrow, NV2A, specular=(0.3, 0.3, 0.3)), NV2A, SIZE, SIZE)


def test_the_tables_ends_hold_the_function_there():
    table = dependent_lookups.load_power(IDEAL).image.ideal[0][0]
    assert table[0, 1:, 0].max() == 0.0  # e = 0; N = 0, which no material has, is left out
    assert table[-1, :, 0].min() == 1.0  # e = 1
    n = sampled_functions.positions(dependent_lookups.TABLE_TEXELS)
    e = sampled_functions.positions(dependent_lookups.BASE_TEXELS)
    np.testing.assert_allclose(table[700, 60, 0], np.sqrt(e[700]) ** (128.0 * n[60]), rtol=1e-12)


def test_matrices_multiply_from_the_left():
    random = np.random.default_rng(1)
    a, b, c = (tuple(map(tuple, m)) for m in random.normal(size=(3, 4, 4)))
    np.testing.assert_allclose(product(a, b, c), np.array(a) @ np.array(b) @ np.array(c), atol=1e-12)
    assert product(a) == a


def test_textures_are_loaded_with_their_own_names():
    loading = (*of_dot_products(pebbles(), NV2A), *of_exponents(pebbles(), NV2A), *of_banks(pebbles(), NV2A))
    names = [c.texture for c in loading if isinstance(c, TexImage)]
    assert len(names) == len(set(names))
