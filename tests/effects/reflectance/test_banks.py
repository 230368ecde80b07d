"""K04, Banks with R* by register combiners, and Eq. 1 with one material vector in a pass: closed forms on the
ideal, the machine's arithmetic, and what boards with fewer units and combiners take.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.reflectance import (
    anisotropic_blinn_phong,
    banks_without_lookup,
    brdfs,
    material_textures,
)
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL, MULTITEXTURE, NV2A
from fixedpipe.pipeline.state import Sampler
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

VIEWER = np.array([0.0, 0.0, 1.0])
SIZE = 16
NEAREST_REPEATED = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST, WrapMode.REPEAT, WrapMode.REPEAT)


def fibres(seed, columns=8, rows=8):
    """Normals within 35 degrees of +z and tangents of any direction, a texel each; k_s of 0.5 to 1."""
    random = np.random.Generator(np.random.PCG64(seed))
    slopes = random.uniform(-0.5, 0.5, (2, rows, columns))
    normals, _, _ = height_fields.frames(*slopes)
    flat = random.standard_normal((rows, columns, 3))
    tangents = normalize(flat - dot(flat, normals)[..., None] * normals)
    k_s = random.uniform(0.5, 1.0, (rows, columns))
    return material_textures.Material(normals, tangents, cross(normals, tangents), 1.0, 1.0, k_s)


def square(profile, material, light, effect, size=SIZE, load=banks_without_lookup.load, **options):
    """A square that fills the panel: each texel takes as many pixels as any other."""
    panel = Panel(0, 0, size, size)
    loading, names = load(material, "fibres", profile)
    passes = effect(
        surfaces.plane(),
        names,
        orthographic_view(panel),
        Light(tuple(light)),
        profile,
        sampler=NEAREST_REPEATED,
        **options,
    )
    return (panel.clear((0.0, 0.0, 0.0)), *loading, *passes)


def expected(material, light, size=SIZE, model=brdfs.banks_approximate):
    """The model at each pixel, bottom row first: float64 [size, size]."""
    texels = model(normalize(light), VIEWER, material.normals, material.tangents, material.k_s)
    repeat = size // texels.shape[0]
    return texels.repeat(repeat, axis=0).repeat(repeat, axis=1)


FORMS = {
    "seven passes": (banks_without_lookup.specular_passes, {"subtract": False}),
    "five passes": (banks_without_lookup.specular_passes, {"subtract": True}),
    "one pass": (banks_without_lookup.specular_pass, {}),
}
LIGHTS = [np.array([0.3, 0.2, 1.0]), np.array([-1.0, 0.4, 0.3]), np.array([0.0, 0.9, -0.2])]


@pytest.mark.parametrize("light", LIGHTS, ids=["high", "low", "from below"])
@pytest.mark.parametrize("form", FORMS)
def test_the_passes_are_banks_with_r_star_on_the_ideal(form, light):
    effect, options = FORMS[form]
    material = fibres(1)
    commands = square(IDEAL, material, light, effect, specular=(1.0, 0.5, 0.25), **options)
    image = execute_ideal(commands, SIZE, SIZE).color[::-1, :, :3]
    true = expected(material, light)[..., None] * np.array([1.0, 0.5, 0.25])
    assert np.abs(image - true).max() < 1e-12
    assert true.max() > 0.15 and np.ptp(true[..., 0]) > 0.15


def test_nothing_saturates_between_the_passes():
    """(1 - a^2)(1 - b^2) + |a b| <= 1 for |a|, |b| <= 1: what the framebuffer holds after the third pass."""
    a, b = np.meshgrid(np.linspace(-1.0, 1.0, 401), np.linspace(-1.0, 1.0, 401))
    held = (1.0 - a * a) * (1.0 - b * b) + np.abs(a * b)
    assert held.max() <= 1.0 + 1e-12


def test_the_first_three_passes_stay_in_the_framebuffers_range():
    """On the ideal, whose framebuffer would hold what bytes cannot."""
    commands = square(IDEAL, fibres(2), LIGHTS[1], banks_without_lookup.specular_passes, subtract=False)
    start = next(i for i, c in enumerate(commands) if c.label == "1 - (v.t)^2")
    for end in (start + 1, start + 2, start + 3):
        color = execute_ideal(commands[:end], SIZE, SIZE).color[..., :3]
        assert color.min() >= 0.0 and color.max() <= 1.0


@pytest.mark.parametrize(
    ("form", "profile"),
    [
        ("seven passes", GEFORCE_256),
        ("five passes", GEFORCE_256),
        ("one pass", GEFORCE_3),
        ("one pass", NV2A),
    ],
)
def test_the_machine_follows_the_model_within_its_bytes(form, profile):
    """Measured: an RMS of 0.0029, three roundings of a product (0.0011 each) and the vectors' bytes."""
    effect, options = FORMS[form]
    errors = []
    for seed, light in enumerate(LIGHTS[:2]):
        commands = square(profile, fibres(seed, 32, 32), light, effect, size=32, **options)
        image = execute(commands, profile, 32, 32).framebuffer.color[::-1, :, 0] / 255.0
        errors.append(image - expected(fibres(seed, 32, 32), light, 32))
    assert 0.002 <= np.sqrt(np.mean(np.square(errors))) <= 0.0038


def test_every_form_gives_the_same_bytes():
    """255 - (255 - a + b), saturated, is a - b, saturated; registers in [0, 1] round as the framebuffer."""
    images = [
        execute(
            square(GEFORCE_3, fibres(3, 32, 32), LIGHTS[0], effect, size=32, **options), GEFORCE_3, 32, 32
        )
        for effect, options in FORMS.values()
    ]
    seven, *others = (image.framebuffer.color[..., :3] for image in images)
    assert all((seven == other).all() for other in others)


def test_on_the_cone_r_star_dips_to_three_quarters():
    """l.t = -v.t with (v.t)^2 = 1/2, where the exact model is one: a tangent half way between x and -z."""
    light, tangent = np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)
    normal = np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0)
    grid = tuple(np.broadcast_to(v, (1, 1, 3)) for v in (normal, tangent, cross(normal, tangent)))
    material = material_textures.Material(*grid, 1.0, 1.0, 1.0)
    n_l = dot(normal, light)
    assert brdfs.banks(light, VIEWER, normal, tangent) / n_l == pytest.approx(1.0)
    image = execute_ideal(
        square(IDEAL, material, light, banks_without_lookup.specular_passes), SIZE, SIZE
    ).color
    assert image[..., :3] / n_l == pytest.approx(np.full((SIZE, SIZE, 3), 0.75))


def test_r_star_is_darker_by_at_most_a_quarter():
    material, light = fibres(4, 64, 64), LIGHTS[0]
    exact = expected(material, light, 64, brdfs.banks)
    assert (exact - expected(material, light, 64)).min() >= -1e-12
    assert (exact - expected(material, light, 64)).max() <= 0.25


def test_a_machine_subtracts_in_the_blender_where_it_can():
    def count(profile):
        passes = square(profile, fibres(5), LIGHTS[0], banks_without_lookup.specular_passes)[3:]
        validate(
            square(profile, fibres(5), LIGHTS[0], banks_without_lookup.specular_passes),
            profile,
            SIZE,
            SIZE,
            24,
        )
        return sum(isinstance(command, Draw) for command in passes)

    plain = GEFORCE_256.changed(blend_equations=MULTITEXTURE.fragments.blend_equations)
    assert (count(GEFORCE_256), count(plain)) == (5, 7)


@pytest.mark.parametrize(
    ("units", "general_combiners", "allowed"), [(2, 5, True), (4, 8, True), (2, 4, False), (1, 5, False)]
)
def test_the_single_pass_asks_for_two_units_and_five_general_combiners(units, general_combiners, allowed):
    profile = GEFORCE_3.changed(max_texture_units=units, max_general_combiners=general_combiners)
    commands = square(profile, fibres(6), LIGHTS[0], banks_without_lookup.specular_pass)
    if allowed:
        validate(commands, profile, SIZE, SIZE, 24)
    else:
        with pytest.raises(UnsupportedState):
            validate(commands, profile, SIZE, SIZE, 24)


# ------------------------------------------------------------- Eq. 1 with one material vector in a pass


def eq_1(profile, material, light, effect, size=SIZE, **options):
    return square(profile, material, light, effect, size, material_textures.load, **options)


def test_eq_1_in_three_passes_is_eq_1_on_the_ideal():
    random = np.random.Generator(np.random.PCG64(7))
    alpha = random.uniform(0.25, 1.0, (2, 8, 8))
    material = replace(fibres(8), alpha_x=alpha[0], alpha_y=alpha[1])
    light = np.array([0.2, -0.1, 1.0])
    image = execute_ideal(
        eq_1(IDEAL, material, light, anisotropic_blinn_phong.specular_passes), SIZE, SIZE
    ).color[::-1, :, 0]
    half = brdfs.half_vector(normalize(light), VIEWER)
    true = brdfs.anisotropic_blinn_phong(
        half, material.tangents, material.binormals, material.alpha_x, material.alpha_y, material.k_s
    )
    true = true.repeat(2, axis=0).repeat(2, axis=1)
    assert np.abs(image - true).max() < 1e-12
    assert true.max() > 0.3 and (true == 0.0).any()


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3, NV2A], ids=["GeForce 256", "GeForce 3", "NV2A"])
def test_eq_1_in_three_passes_is_the_single_pass_within_the_framebuffers_rounding(profile):
    material = replace(fibres(9, 32, 32), alpha_x=np.full((32, 32), 0.5), alpha_y=np.full((32, 32), 0.25))
    light = np.array([0.2, -0.1, 1.0])
    one, several = (
        execute(eq_1(profile, material, light, effect, 32, **options), profile, 32, 32)
        .framebuffer.color[..., 0]
        .astype(int)
        for effect, options in (
            (anisotropic_blinn_phong.specular_pass, {"first": True}),
            (anisotropic_blinn_phong.specular_passes, {}),
        )
    )
    difference = np.abs(one - several)
    assert (one > 0).any() and (one == 0).any()
    assert difference.max() <= 1


@pytest.mark.parametrize(("units", "general_combiners"), [(1, 1), (1, 2), (2, 1)])
def test_eq_1_in_three_passes_asks_for_one_unit_and_one_general_combiner(units, general_combiners):
    profile = GEFORCE_256.changed(max_texture_units=units, max_general_combiners=general_combiners)
    light = LIGHTS[0]
    validate(
        eq_1(profile, fibres(8), light, anisotropic_blinn_phong.specular_passes), profile, SIZE, SIZE, 24
    )
    with pytest.raises(UnsupportedState):
        single = eq_1(profile, fibres(8), light, anisotropic_blinn_phong.specular_pass, first=True)
        validate(single, profile, SIZE, SIZE, 24)
