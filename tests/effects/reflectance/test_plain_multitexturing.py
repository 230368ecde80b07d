"""K22: what unsigned texture environments give of Eq. 1, and what signed products take."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance import rings
from fixedpipe.effects.acceptance.measures import pixel_grid
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.figures.kautz_seidel_2000 import k22_plain_multitexturing
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.reflectance import (
    brdfs,
    evaluate_then_interpolate,
    material_textures,
    plain_multitexturing,
)
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import TextureFilter
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import G400, IDEAL, MULTITEXTURE, OPENGL_1_2
from fixedpipe.pipeline.state import Sampler
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

SIZE = 8
NEAREST_REPEATED = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
LIGHT = np.array([0.5, -0.3, 1.0])


def strokes(seed, slope):
    """Random strokes on a surface with slopes up to ``slope``: alpha of 0.5 to 1, k_s of 0.5 to 1."""
    random = np.random.Generator(np.random.PCG64(seed))
    normals, _, _ = height_fields.frames(*random.uniform(-slope, slope, (2, SIZE, SIZE)))
    flat = random.standard_normal((SIZE, SIZE, 3)) * np.array([1.0, 1.0, slope])
    tangents = normalize(flat - dot(flat, normals)[..., None] * normals)
    alpha_x, alpha_y, k_s = random.uniform(0.5, 1.0, (3, SIZE, SIZE))
    return material_textures.Material(normals, tangents, cross(normals, tangents), alpha_x, alpha_y, k_s)


def square(profile, material, passes, light=LIGHT):
    """A square with a texel for each pixel."""
    panel = Panel(0, 0, SIZE, SIZE)
    loading, names = plain_multitexturing.load(material, "strokes", profile)
    return (
        panel.clear((0.0, 0.0, 0.0)),
        *loading,
        *passes(
            surfaces.plane(), names, orthographic_view(panel), Light(tuple(light)), profile,
            specular=(1.0, 0.5, 0.25), sampler=NEAREST_REPEATED,
        ),
    )  # fmt: skip


def eq_1(material, light=LIGHT):
    half = brdfs.half_vector(normalize(light), np.array([0.0, 0.0, 1.0]))
    value = brdfs.anisotropic_blinn_phong(
        half, material.tangents, material.binormals, material.alpha_x, material.alpha_y, material.k_s
    )
    return value[..., None] * np.array([1.0, 0.5, 0.25])


@pytest.mark.parametrize("slope", [0.0, 0.4], ids=["flat", "bumps"])
def test_the_signed_passes_are_eq_1_on_the_ideal(slope):
    material = strokes(1, slope)
    commands = square(IDEAL, material, plain_multitexturing.signed_passes)
    image = execute_ideal(commands, SIZE, SIZE).color[::-1, :, :3]
    assert np.abs(image - eq_1(material)).max() < 1e-12
    assert eq_1(material).max() > 0.5


@pytest.mark.parametrize("light", [LIGHT, (0.9, 0.4, 0.2), (-0.5, -0.8, -0.3)])
def test_a_diffuse_term_of_unsigned_halves_is_that_of_bumps(light):
    """Also from below, where no normal is lit."""
    material, panel, light = strokes(3, 0.8), Panel(0, 0, SIZE, SIZE), np.array(light)
    color, ambient = (0.9, 0.5, 0.3), (0.05, 0.1, 0.0)
    expected = brdfs.lambert(material.normals, normalize(light))[..., None] * np.array(color) + np.array(
        ambient
    )

    def commands(profile):
        normals, halves = plain_multitexturing.load_normals(material.normals, "strokes", profile)
        return (
            *square(profile, material, plain_multitexturing.signed_passes, light),
            *normals,
            *plain_multitexturing.bumped_diffuse_passes(
                surfaces.plane(), halves, orthographic_view(panel), Light(tuple(light)), profile,
                color=color, ambient=ambient, sampler=NEAREST_REPEATED,
            ),
        )  # fmt: skip

    image = execute_ideal(commands(IDEAL), SIZE, SIZE).color[::-1, :, :3]
    assert np.abs(image - expected).max() < 1e-12
    drawn = execute(commands(OPENGL_1_2), OPENGL_1_2, SIZE, SIZE).image()[::-1, :, :3] / 255.0
    assert np.abs(drawn - expected).max() < 8.0 / 255.0  # ten products of bytes


def test_the_unsigned_passes_are_eq_1_without_the_products_of_two_axes_on_the_ideal():
    material = strokes(2, 0.4)
    commands = square(IDEAL, material, plain_multitexturing.unsigned_passes)
    image = execute_ideal(commands, SIZE, SIZE).color[::-1, :, 0]
    half = brdfs.half_vector(normalize(LIGHT), np.array([0.0, 0.0, 1.0]))
    squares = sum(
        half[i] ** 2
        * (
            (material.tangents[..., i] / material.alpha_x) ** 2
            + (material.binormals[..., i] / material.alpha_y) ** 2
        )
        for i in range(3)
    )
    assert np.abs(image - material.k_s * np.maximum(0.0, 1.0 - squares)).max() < 1e-12
    assert np.abs(image - eq_1(material)[..., 0]).max() > 0.1


def test_along_an_axis_nothing_is_lost():
    """A halfway vector in the plane of x and z: the products that are left out are zero on flat strokes."""
    material, light = strokes(3, 0.0), np.array([0.8, 0.0, 1.0])
    commands = square(IDEAL, material, plain_multitexturing.unsigned_passes, light)
    image = execute_ideal(commands, SIZE, SIZE).color[::-1, :, :3]
    assert np.abs(image - eq_1(material, light)).max() < 1e-12


def test_the_board_follows_within_its_bytes():
    """Measured: an RMS of 0.008, a step of four bytes' uniform error and the vertex colours' bytes."""
    material = strokes(4, 0.0)
    commands = square(MULTITEXTURE, material, plain_multitexturing.signed_passes)
    image = execute(commands, MULTITEXTURE, SIZE, SIZE).framebuffer.color[::-1, :, 0] / 255.0
    rms = np.sqrt(np.mean((image - eq_1(material)[..., 0]) ** 2))
    assert 0.002 <= rms <= 0.012


@pytest.mark.parametrize(("slope", "unsigned", "signed"), [(0.0, 3, 11), (0.4, 4, 20)], ids=["flat", "bumps"])
def test_a_sign_takes_this_many_draws(slope, unsigned, signed):
    for passes, count in (
        (plain_multitexturing.unsigned_passes, unsigned),
        (plain_multitexturing.signed_passes, signed),
    ):
        for profile in (MULTITEXTURE, G400):
            commands = square(profile, strokes(5, slope), passes)
            validate(commands, profile, SIZE, SIZE, 24)
            assert sum(isinstance(c, Draw) for c in commands) == count


def test_the_unsigned_passes_are_closer_than_halves_of_the_vectors():
    """The other attempt that needs no sign, t and b with their positive components alone, in float."""
    parameters = FIGURES["K22"].values
    material = k22_plain_multitexturing.parquet(4, parameters["angles"], 0.5, 1.0, (1.0, 1.0), 1.0)
    x, y = pixel_grid(k22_plain_multitexturing.MAP_SIZE, 1.0)
    half, _ = k22_plain_multitexturing.halfway(0.92 * x, 0.92 * y, parameters["light"])

    def lobe(products):
        return np.maximum(0.0, 1.0 - sum(products))

    vectors = material.scaled_tangents, material.scaled_binormals
    true = lobe(dot(v, half) ** 2 for v in vectors)
    squares = lobe((v[..., i] * half[..., i]) ** 2 for v in vectors for i in range(3))
    halves = lobe(dot(np.maximum(0.0, v), np.maximum(0.0, half)) ** 2 for v in vectors)
    rms = [float(np.sqrt(np.mean((attempt - true) ** 2))) for attempt in (squares, halves)]
    assert rms[0] == pytest.approx(0.13, abs=0.02)
    assert rms[1] > 1.5 * rms[0]


def domes(map_size, alpha):
    s, t = height_fields.texel_centers(map_size, map_size)
    return material_textures.from_slopes(*height_fields.dome_slopes(s, t), alpha, alpha)


@pytest.mark.parametrize(("map_size", "vectors"), [(32, 0.257), (64, 0.115), (128, 0.058)])
def test_products_may_be_interpolated_first_where_vectors_make_rings(map_size, vectors):
    """Figure 2's ring energy in float: t and b interpolated, and M interpolated."""
    material = domes(map_size, 0.25)
    x, y = pixel_grid(512, 1.0)
    s, t = 0.5 * (x + 1.0), 0.5 * (y + 1.0)

    def products(row, column):
        t, b = material.scaled_tangents[row, column], material.scaled_binormals[row, column]
        return dot(t, rings.RING_HALF) ** 2 + dot(b, rings.RING_HALF) ** 2

    by_products = np.maximum(
        0.0, 1.0 - evaluate_then_interpolate.at_texels(products, map_size, map_size, s, t)
    )
    by_vectors = evaluate_then_interpolate.interpolate_then_evaluate(material, rings.RING_HALF, s, t)
    energy = [rings.ring_energy(image, map_size, 0.25, 0.25)[0] for image in (by_products, by_vectors)]
    assert energy[0] < 3e-4
    assert energy[1] == pytest.approx(vectors, rel=0.02)


def test_the_signed_passes_interpolate_products():
    """At pixels between texels of the domes, on the ideal."""
    material, size = domes(16, 0.5), 48
    panel = Panel(0, 0, size, size)
    light = Light(tuple(LIGHT))
    loading, names = plain_multitexturing.load(material, "domes", IDEAL)
    passes = plain_multitexturing.signed_passes(
        surfaces.plane(), names, orthographic_view(panel), light, IDEAL
    )
    image = execute_ideal((panel.clear((0.0, 0.0, 0.0)), *loading, *passes), size, size).color[::-1, :, 0]
    half = brdfs.half_vector(normalize(LIGHT), np.array([0.0, 0.0, 1.0]))

    def products(row, column):
        t, b = material.scaled_tangents[row, column], material.scaled_binormals[row, column]
        return dot(t, half) ** 2 + dot(b, half) ** 2

    x, y = pixel_grid(size, 1.0)
    s, t = 0.5 * (x + 1.0), 0.5 * (y + 1.0)
    expected = np.maximum(0.0, 1.0 - evaluate_then_interpolate.at_texels(products, 16, 16, s, t))
    assert np.abs(image - expected).max() < 1e-9
    assert 0.0 < np.mean(expected == 0.0) < 0.9


def test_a_narrow_lobe_does_not_fit_the_store():
    with pytest.raises(ValueError, match=r"give at least 0\.5"):
        plain_multitexturing.load(replace(strokes(6, 0.0), alpha_x=0.4), "strokes", MULTITEXTURE)


def test_a_board_without_environments_that_scale_refuses():
    with pytest.raises(UnsupportedState):
        commands = square(OPENGL_1_2, strokes(7, 0.0), plain_multitexturing.unsigned_passes)
        validate(commands, OPENGL_1_2, SIZE, SIZE, 24)
