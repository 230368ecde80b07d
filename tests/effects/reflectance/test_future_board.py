"""Whole reflectance models in one pass of the future board (K17), and combiners before the filter (K16)."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.figures.figure import Renderer
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import cross, normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.reflectance import brdfs, evaluate_then_interpolate, future_board, material_textures
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_3, IDEAL
from fixedpipe.pipeline.validation.walk import UnsupportedState

SIZE = 32
VIEWER = np.array([0.0, 0.0, 1.0])
LIGHT = normalize(np.array([0.5, 0.3, 0.8]))
HALF = brdfs.half_vector(LIGHT, VIEWER)


def random_material(smallest_alpha, seed=3, edge=SIZE):
    """A material with everything at random per texel; normals lean by as much as 40 degrees and more."""
    random = np.random.default_rng(seed)
    normals = normalize(random.normal(size=(edge, edge, 3)) * (0.4, 0.4, 0.2) + VIEWER)
    tangents = normalize(cross(normalize(random.normal(size=(edge, edge, 3))), normals))
    x, y = random.uniform(smallest_alpha, 1.0, (2, edge, edge))
    k_s = random.uniform(0.2, 1.0, (edge, edge))
    exponent = 2.0 ** random.uniform(0.0, 7.0, (edge, edge))
    return material_textures.Material(normals, tangents, cross(normals, tangents), x, y, k_s, exponent)


def drawn(name, material, profile, light=LIGHT, **options):
    """One model over a square of a texel per pixel: red [SIZE, SIZE], bottom row first."""
    loading, names = future_board.load(material, "random", profile)
    tables = {
        "blinn_phong_by_lookup": future_board.exponent_table,
        "banks_by_lookup": future_board.bracket_table,
    }
    table = (tables[name](profile),) if name in tables else ()
    passes = getattr(future_board, name)(
        surfaces.plane(), names, *(t.texture for t in table),
        orthographic_view(Panel(0, 0, SIZE, SIZE)), Light(tuple(light)), profile,
        first=True, sampler=NEAREST, **options,
    )  # fmt: skip
    assert len(passes) == 1
    commands = (*loading, *table, *passes)
    if profile.arithmetic.exact:
        return execute_ideal(commands, SIZE, SIZE).color[::-1, :, 0]
    return execute(commands, profile, SIZE, SIZE).framebuffer.image()[::-1, :, 0] / 255.0


def model(name, m, light=LIGHT):
    half = brdfs.half_vector(light, VIEWER)
    if name.startswith("blinn"):
        return brdfs.anisotropic_blinn_phong(
            half, m.tangents, m.binormals, m.alpha_x, m.alpha_y, m.k_s, m.exponent
        )
    if name.startswith("banks"):
        return brdfs.banks(light, VIEWER, m.normals, m.tangents, m.k_s)
    return np.minimum(
        brdfs.ward(light, VIEWER, m.normals, m.tangents, m.binormals, m.alpha_x, m.alpha_y, m.k_s), 1.0
    )


# Largest errors of the ideal: the polynomial's, nothing, nothing, and tables of 256 texels: F's slope is
# infinite at e = 0 (erratum E004.16 is the same of R), the bracket's bends where it becomes zero.
# Root mean squares of the machine's error: textures of bytes, times four or eight. Measured, with a third of
# slack.
ACCURACY = {
    "blinn_phong": (0.00124, 0.0117, 0.0143),
    "blinn_phong_by_lookup": (0.06, 0.0143, 0.0156),
    "banks": (1e-12, 0.003, 0.003),
    "banks_by_lookup": (0.005, 0.0032, 0.0032),
    "ward": (1e-12, 0.0023, 0.0055),
}


@pytest.mark.parametrize("smallest_alpha", [0.25, 0.125])
@pytest.mark.parametrize("name", ACCURACY)
def test_a_model_is_one_pass(name, smallest_alpha):
    material = random_material(smallest_alpha)
    expected = model(name, material)
    assert expected.max() > 0.5 and (expected == 0.0).any()
    of_ideal, *of_machine = ACCURACY[name]
    assert np.abs(drawn(name, material, IDEAL) - expected).max() <= of_ideal
    error = drawn(name, material, FUTURE) - expected
    assert np.sqrt((error * error).mean()) <= of_machine[smallest_alpha < 0.25]


def test_ward_s_factor_exceeds_one():
    """Artefact P18: k_s / (4 pi ax ay) is 1.27 and 5.09 where boards of the time end at one."""
    flat = material_textures.isotropic(SIZE, SIZE, 0.125, k_s=0.1)
    expected = brdfs.ward_scale(0.125, 0.125, 0.1)
    assert abs(drawn("ward", flat, IDEAL, VIEWER)[5, 5] - expected) < 1e-9
    dim = replace(flat, k_s=1.0)
    assert (drawn("ward", dim, FUTURE, VIEWER, specular=(0.125,) * 3) - 5.09 / 8.0 < 0.01).all()
    assert (drawn("ward", dim, FUTURE, VIEWER) == 1.0).all()


@pytest.mark.parametrize("light", [(0.9, 0.0, -0.3), (-0.8, 0.5, 0.1)])
def test_ward_is_black_where_light_or_viewer_is_behind_the_texel(light):
    light, material = normalize(np.array(light)), random_material(0.25)
    expected = model("ward", material, light)
    behind = (material.normals @ light <= 0.0) | (material.normals[..., 2] <= 0.0)
    assert behind.any() and (expected[behind] == 0.0).all()
    found = drawn("ward", material, IDEAL, light)
    assert np.abs(found - expected).max() <= 1e-9


def test_the_exponent_is_a_texel_s_own():
    """Twice the exponent is the square of the same lobe, as the table says and as the stages do."""
    material = replace(random_material(0.5), k_s=1.0)
    for name, bound in (("blinn_phong", 0.0025), ("blinn_phong_by_lookup", 0.06)):
        one, two = (drawn(name, replace(material, exponent=e), IDEAL) for e in (4.0, 8.0))
        assert np.abs(two - one * one).max() <= bound
        assert (two < one - 0.1).any()


def test_an_alpha_that_the_textures_cannot_hold_is_refused():
    with pytest.raises(ValueError, match=r"an alpha of 0\.1; give 0\.125 or more"):
        future_board.load(material_textures.isotropic(4, 4, 0.1), "narrow", FUTURE)


@pytest.mark.parametrize("name", ["blinn_phong", "banks", "ward", "banks_by_lookup"])
def test_a_board_of_the_time_refuses_the_pass(name):
    with pytest.raises(UnsupportedState, match=GEFORCE_3.name):
        drawn(name, random_material(0.25), GEFORCE_3)


@pytest.mark.parametrize("name", ["banks", "ward"])
def test_a_whole_model_goes_before_the_filter(name):
    """Every texel's own value, then bilinearly between them: what a software renderer would do (K16)."""
    few = 8
    material = random_material(0.25, edge=few)
    loading, names = future_board.load(material, "random", IDEAL)
    view = orthographic_view(Panel(0, 0, SIZE, SIZE))
    draws = getattr(future_board, name)(surfaces.plane(), names, view, Light(tuple(LIGHT)), IDEAL, first=True)
    values = model(name, material)
    at = height_fields.texel_centers(SIZE, SIZE)
    expected = evaluate_then_interpolate.at_texels(lambda i, j: values[i, j], few, few, *at)
    found, otherwise = (
        execute_ideal((*loading, *passes), SIZE, SIZE).color[::-1, :, 0]
        for passes in (future_board.evaluated_first(draws), draws)
    )
    assert np.abs(found - expected).max() < 1e-9
    assert np.abs(otherwise - expected).max() > 0.1


def test_only_draws_that_filter_are_evaluated_first():
    figure = FIGURES["F004-2"]
    commands = figure.commands(FUTURE, 16, figure.methods[0])
    after = future_board.evaluated_first(commands)
    for was, now in zip(commands, after, strict=True):
        filters = isinstance(was, Draw) and bool(was.state.texture_units)
        assert now is was if not filters else now.state.evaluate_before_filtering
    assert sum(c.state.evaluate_before_filtering for c in after if isinstance(c, Draw)) == 3


def test_evaluation_before_the_filter_draws_the_software_renderer_s_picture():
    figure, size = FIGURES["F004-2"], 64
    renderer = Renderer(FUTURE, figure.method("FUTURE"), execute, execute_ideal)
    ideal, machine = (
        np.clip(of(figure, size, extent=1.0), 0.0, 1.0)
        for of in (renderer.ideal_window, renderer.machine_window)
    )
    assert np.abs(ideal[:, :size] - ideal[:, size:]).max() < 1e-9
    assert np.sqrt(((machine[:, :size] - machine[:, size:]) ** 2).mean()) < 0.006
