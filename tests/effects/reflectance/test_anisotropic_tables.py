"""H13 and H14, products of two tables: the tables against the models' equations by angles, the passes of one
unit beside those of two, and what is refused.
"""

import math

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view, perspective_view
from fixedpipe.effects.reflectance import anisotropic_tables as tables
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL, MULTITEXTURE

N, T, B = np.eye(3)[2], np.eye(3)[0], np.eye(3)[1]
PANEL = Panel(0, 0, 48, 48)
NEAR = Light((0.7, 0.9, 1.6), point=True)


def upper(seed, count=200):
    """Unit vectors above the horizon."""
    random = np.random.Generator(np.random.PCG64(seed))
    vectors = normalize(random.standard_normal((count, 3)))
    return vectors * np.where(vectors[:, 2:] < 0.0, -1.0, 1.0)


def coordinates(half):
    return half[:, 0] / (1.0 + half[:, 2]), half[:, 1] / (1.0 + half[:, 2])


def test_coordinates_give_the_halfway_vector_back():
    half = upper(1)
    np.testing.assert_allclose(tables.halfway_of(*coordinates(half)), half, atol=1e-12)


def test_ward_s_product_is_ward_s_model():
    light, view = upper(2), upper(3)
    half = normalize(light + view)
    d = tables.ward(*coordinates(half), 0.2, 0.5)
    g = tables.ward_obstruction(light[:, 2], view[:, 2])
    exact = brdfs.ward_exact(light, view, N, T, B, 0.2, 0.5)
    np.testing.assert_allclose(d * g / (4.0 * math.pi * 0.1), exact, rtol=1e-9, atol=1e-15)


def test_ashikhmin_s_distribution_is_a_power_that_turns_with_the_azimuth():
    half = upper(4)
    phi = np.arctan2(half[:, 1], half[:, 0])
    expected = half[:, 2] ** (9.0 * np.cos(phi) ** 2 + 40.0 * np.sin(phi) ** 2)
    np.testing.assert_allclose(tables.ashikhmin(*coordinates(half), 9.0, 40.0), expected, rtol=1e-9)


@pytest.mark.parametrize("distribution", [tables.ward, tables.ashikhmin])
def test_a_distribution_is_one_at_the_normal_and_zero_below_the_horizon(distribution):
    assert distribution(np.array(0.0), np.array(0.0), 0.3, 0.7) == 1.0
    assert distribution(np.array(0.8), np.array(-0.7), 0.3, 0.7) == 0.0


@pytest.mark.parametrize("obstruction", [tables.ward_obstruction, tables.ashikhmin_obstruction])
def test_what_is_behind_the_surface_is_dark(obstruction):
    assert obstruction(-0.1, 0.5) == obstruction(0.5, -0.1) == obstruction(0.0, 0.0) == 0.0
    assert obstruction(0.5, 0.5) == 1.0


def test_fresnel_s_factor_is_the_reflectance_at_normal_incidence():
    found = tables.ashikhmin_fresnel(np.array([1.0, 0.5]), (0.9, 0.04))
    expected = [[0.9, 0.04], [2.0 * (0.9 + 0.1 / 32.0), 2.0 * (0.04 + 0.96 / 32.0)]]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def commands(profile, units, surface, view):
    return (
        PANEL.clear((0.0, 0.0, 0.0)),
        tables.load_distribution("D", tables.ward, (0.25, 0.6), profile),
        tables.load_obstruction("G", tables.ward_obstruction, profile),
        *tables.specular_passes(surface, view, NEAR, "D", "G", (1.0, 0.8, 0.6), units=units),
    )


def test_a_near_light_on_a_fine_plane_is_ward_s_model_at_every_pixel():
    plane = surfaces.plane(24, 24)
    view = perspective_view(PANEL, (0.3, -0.4, 4.0), field_of_view=24.0)
    found = execute_ideal(commands(IDEAL, 2, plane, view), 48, 48).color[::-1, :, :3]
    # The plane's points under the pixels, by the camera's rays to z = 0.
    x = ((np.arange(48) + 0.5) / 24.0 - 1.0) / view.projection[0][0]
    x, y = np.meshgrid(x, x)
    rotation = np.array(view.modelview)[:3, :3]
    rays = np.stack([x, y, np.full_like(x, -1.0)], axis=-1) @ rotation
    eye = np.array(view.eye)
    points = eye + rays * (-eye[2] / rays[..., 2])[..., None]
    inside = np.abs(points[..., :2]).max(axis=-1) < 0.97
    points = points[inside]
    light, toward = NEAR.light_vectors(points), view.view_vectors(points)
    expected = brdfs.ward_exact(light, toward, N, T, B, 0.25, 0.6) * (4.0 * math.pi * 0.15)
    np.testing.assert_allclose(found[inside], expected[:, None] * np.array([1.0, 0.8, 0.6]), atol=0.012)
    assert expected.max() > 0.9


def test_two_passes_of_one_unit_are_one_pass_of_two():
    torus, view = surfaces.torus(40, 20), orthographic_view(PANEL, half_height=1.05)
    one, two = (
        execute(commands(MULTITEXTURE, units, torus, view), MULTITEXTURE, 48, 48).framebuffer.color
        for units in (1, 2)
    )
    assert np.abs(one.astype(int) - two.astype(int)).max() <= 2
    assert one[..., 0].max() > 100
    exact = [execute_ideal(commands(IDEAL, units, torus, view), 48, 48).color for units in (1, 2)]
    np.testing.assert_allclose(exact[0][..., :3], exact[1][..., :3], atol=1e-6)


def test_the_diffuse_pass_is_lambert_s_law_of_a_near_light_in_any_view():
    plane = surfaces.plane(32, 32)
    view = perspective_view(PANEL, (0.0, -2.0, 3.5), field_of_view=20.0)
    frame = commands(IDEAL, 1, plane, view)[:-2]
    black = tables.specular_passes(plane, view, NEAR, "D", "G", (0.0, 0.0, 0.0), units=1)
    lit = tables.diffuse_pass(plane, view, NEAR, (0.5, 0.5, 0.5))
    found = execute_ideal((*frame, *black, lit), 48, 48).color[24, 24, 0]
    toward = NEAR.light_vectors(np.zeros((1, 3)))[0]
    assert found == pytest.approx(0.5 * dot(N, toward), abs=0.01)


def test_numbers_of_units_and_widths_that_there_are_none_of_are_refused():
    plane, view = surfaces.plane(), orthographic_view(PANEL)
    with pytest.raises(ValueError, match="3 texture units; give 1 or 2"):
        tables.specular_passes(plane, view, NEAR, "D", "G", (1.0, 1.0, 1.0), units=3)
    for widths in ((0.0, 0.5), (0.3, math.nan), (0.3, -1.0)):
        with pytest.raises(ValueError, match="two numbers are"):
            tables.load_distribution("D", tables.ward, widths, IDEAL)
