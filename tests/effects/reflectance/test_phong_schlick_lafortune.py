"""K24: how the other models are taken apart, and what their passes refuse."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.figures.kautz_seidel_2000.k24_other_models import domed_material
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Light, orthographic_view, perspective_view, row_of_panels
from fixedpipe.effects.reflectance import brdfs, phong_schlick_lafortune, phong_schlick_lafortune_copies
from fixedpipe.effects.reflectance.brdfs import BRDFS, Frame
from fixedpipe.effects.reflectance.dependent_lookups import load_screen
from fixedpipe.effects.reflectance.sampled_functions import stored_exponent
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, IDEAL, OCTANE

(PANEL,) = row_of_panels(1, 32)
VIEW = orthographic_view(PANEL)
LIGHT = Light((0.5, 0.4, 1.0))
BLACK = {"background": (0.0, 0.0, 0.0), "color": (0.0, 0.0, 0.0), "ambient": (0.0, 0.0, 0.0)}
SCHLICK = {"roughness": 0.1, "isotropy": 0.4, "reflectance": 0.8}
COEFFICIENTS = (-0.9, -0.4, 0.95)


def material(size=32):
    return domed_material(size, 1, 0.9, (12.0,), (30.0,), 1.0)


def directions(count, seed):
    out = normalize(np.random.Generator(np.random.PCG64(seed)).standard_normal((count, 3)))
    out[:, 2] = np.abs(out[:, 2])
    return out


def test_two_dot_products_of_the_matrix_s_halves_are_lafortune_s_lobe():
    m = material()
    light, view = directions(1, 1), directions(1, 2)
    diagonal, rest = phong_schlick_lafortune.lobe_matrix(m, COEFFICIENTS)
    straight, mixed = phong_schlick_lafortune.lobe_vectors(light, view)
    c = dot(diagonal, straight[0]) + dot(rest, mixed[0])
    frame = Frame(m.normals, m.tangents, m.binormals)
    lobe = BRDFS["lafortune"].reflectance(light[0], view[0], frame, coefficients=COEFFICIENTS, exponent=1.0)
    seen = (dot(m.normals, light[0]) > 0.0) & (dot(m.normals, view[0]) > 0.0)
    assert seen.mean() > 0.5
    np.testing.assert_allclose(np.maximum(c, 0.0)[seen], lobe[seen], atol=1e-12)


def test_the_two_tables_of_phong_are_the_model_where_it_is_not_dark():
    normals, light, view = directions(500, 3), normalize(np.array([0.3, 0.4, 1.0])), np.array([0.0, 0.0, 1.0])
    exponent = np.linspace(6.0, 40.0, 500)
    nl, nv = dot(normals, light), dot(normals, view)
    c = np.maximum(0.0, phong_schlick_lafortune.phong_c(dot(light, view))(np.maximum(nl, 0.0), nv))
    got = phong_schlick_lafortune.phong_f(stored_exponent(exponent), c)
    true = brdfs.phong(light, view, normals, exponent)
    np.testing.assert_allclose(got[c > 0.0], true[c > 0.0], atol=1e-5)
    assert true[c == 0.0].max() <= 0.5**6
    assert (c > 0.0).sum() > 50


def test_the_factors_of_schlick_are_the_model():
    light, view = directions(500, 4), directions(500, 5)
    half = brdfs.half_vector(light, view)
    largest = phong_schlick_lafortune.schlick_largest(0.2, 0.4)
    got = phong_schlick_lafortune.schlick_t(0.2, 0.4)(half[:, 0], half[:, 1]) * phong_schlick_lafortune.GAIN
    got = got * phong_schlick_lafortune.schlick_o(0.2, largest)(light[:, 2], view[:, 2])
    got = got * brdfs.schlick_fresnel(dot(half, view), 0.3)
    frame = Frame(*np.eye(3)[[2, 0, 1]])
    true = BRDFS["schlick"].radiance(light, view, frame, roughness=0.2, isotropy=0.4, specular=0.3)
    np.testing.assert_allclose(got, true, rtol=1e-9)


def test_a_schlick_highlight_too_bright_to_store_is_refused():
    with pytest.raises(ValueError, match=r"is 1\.99 times brighter than 4 factors of one; give a larger"):
        phong_schlick_lafortune.schlick_largest(0.01, 1.0)


def test_phong_s_table_is_for_one_angle_between_light_and_viewer():
    view = perspective_view(PANEL, (0.0, 0.0, 4.0))
    _, names = phong_schlick_lafortune.load(material(), "m", IDEAL, COEFFICIENTS)
    with pytest.raises(ValueError, match=r"l.v changes from 0.\d+ to 0.\d+ over the surface"):
        phong_schlick_lafortune.phong_passes(surfaces.plane(), names, view, LIGHT, IDEAL, **BLACK)


def test_copies_are_for_a_flat_surface():
    given = surfaces.sphere(8, 6), material(), VIEW, LIGHT, OCTANE
    with pytest.raises(ValueError, match="The light vector changes by"):
        phong_schlick_lafortune_copies.phong_copies(*given, **BLACK)


def passes(name, surface, m, profile, view=VIEW, light=LIGHT):
    """One model's passes by texture shaders, loading included."""
    loading, names = phong_schlick_lafortune.load(m, "m", profile, COEFFICIENTS)
    make = getattr(phong_schlick_lafortune, f"{name}_passes")
    own = {"phong": {}, "schlick": SCHLICK, "lafortune": {"exponent": 9.0}}[name]
    return *loading, load_screen(view.panel), *make(surface, names, view, light, profile, **own, **BLACK)


@pytest.mark.parametrize("reflectance", [0.0, 0.4])
def test_the_last_copy_of_schlick_multiplies_by_fresnel_s_factor(reflectance):
    """Seen and lit from opposite sides, where the factor is not the reflectance alone."""
    tilted = surfaces.plane().rotated(rotation("y", 60.0))
    given = tilted, material(), VIEW, Light((1.0, 0.0, -0.45)), OCTANE
    commands = phong_schlick_lafortune_copies.schlick_copies(
        *given, **{**SCHLICK, "reflectance": reflectance}, **BLACK
    )
    (last,) = [c for c in commands if c.label == "times four, times S(h.v)"]
    light, view = normalize(np.array([1.0, 0.0, -0.45])), np.array([0.0, 0.0, 1.0])
    u = dot(brdfs.half_vector(light, view), view)
    factor = reflectance + (1.0 - reflectance) * (1.0 - u) ** 5
    assert factor > reflectance + 0.01
    np.testing.assert_allclose(last.transfer.color_matrix[0], (0.0, 0.0, 4.0 * factor, 0.0), rtol=1e-5)


@pytest.mark.parametrize("name", ["phong", "schlick", "lafortune"])
def test_a_light_behind_the_surface_makes_no_highlight(name):
    """Opposite the eye, where l.v = -1: (n.l)+ = 0 alone does not make Phong's 2 (n.l)(n.v) - l.v dark."""
    behind, m = Light((0.1, 0.0, -1.0)), material()
    commands = passes(name, surfaces.plane(), m, GEFORCE_3, light=behind)
    assert not execute(commands, GEFORCE_3, 32, 32).framebuffer.color[..., :3].any()
    if name == "phong":
        copies = phong_schlick_lafortune_copies.phong_copies(
            surfaces.plane(), m, VIEW, behind, OCTANE, **BLACK
        )
        assert not execute(copies, OCTANE, 32, 32).framebuffer.color[..., :3].any()


@pytest.mark.parametrize("name", ["phong", "schlick", "lafortune"])
def test_a_curved_surface_has_the_model_of_its_own_frames(name):
    """A smooth sphere: what varies is the surface's own frame, vertex by vertex."""
    flat = domed_material(8, 1, 0.9, (12.0,), (0.0,), 1.0)
    up = np.zeros((8, 8, 3)) + np.array([0.0, 0.0, 1.0])
    flat = replace(
        flat, normals=up, tangents=up[..., [2, 0, 1]], binormals=up[..., [0, 2, 1]], k_s=np.ones((8, 8))
    )
    commands = passes(name, surfaces.sphere(96, 48), flat, IDEAL)
    image = execute_ideal(commands, 32, 32).color[::-1, :, 0]
    x, y = np.meshgrid(*2 * ((np.arange(32) + 0.5) / 16.0 - 1.0,))
    inside = x * x + y * y < 0.9
    normals = np.stack([x, y, np.sqrt(np.where(inside, 1.0 - x * x - y * y, 1.0))], axis=-1)
    tangents = normalize(np.stack([normals[..., 2], 0.0 * x, -x], axis=-1))
    frame = Frame(normals, tangents, np.cross(normals, tangents))
    own = {
        "phong": {"exponent": 12.0},
        "schlick": {"roughness": 0.1, "isotropy": 0.4, "specular": 0.8},
        "lafortune": {"coefficients": COEFFICIENTS, "exponent": 9.0},
    }[name]
    true = BRDFS[name].radiance(normalize(np.array(LIGHT.vector)), np.array([0.0, 0.0, 1.0]), frame, **own)
    error = np.abs(np.clip(image, 0.0, 1.0) - np.clip(true, 0.0, 1.0))[inside]
    assert np.clip(true, 0.0, 1.0)[inside].max() > 0.4
    assert np.sqrt((error**2).mean()) <= 1.0 / 64.0


@pytest.mark.parametrize("size", [32, 24])
def test_a_copy_of_a_panel_need_not_be_as_wide_as_a_power_of_two(size):
    panels = row_of_panels(2, size)
    view = orthographic_view(panels[1])
    commands = passes("phong", surfaces.plane(1, 1, 0.9, 0.9), material(), GEFORCE_3, view)
    image = execute(commands, GEFORCE_3, 2 * size, size).framebuffer.color[..., :3]
    assert (image[:, :size] == 0).all()
    y, x = np.unravel_index(image[::-1, size:, 0].argmax(), (size, size))
    # The highlight lies where the dome's normal halves the angle to the light, up and to the right.
    assert size // 2 < x < 0.8 * size
    assert size // 2 < y < 0.8 * size
    assert image.max() > 200
