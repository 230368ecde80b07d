"""Patches and passes of S13 to S15: derivatives, corners, what textures hold, one fragment's arithmetic."""

import math

import numpy as np
import pytest

from fixedpipe.effects.bump_mapping import normalization_cube_map, offset_vectors
from fixedpipe.effects.bump_mapping import offset_vector_passes as passes
from fixedpipe.effects.bump_mapping.offset_vector_passes import Lighting
from fixedpipe.effects.bump_mapping.offset_vectors import Frame
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.scenes import bumped_patches
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_3, IDEAL, TEXRAM

LIT = Lighting((-0.3, 0.5, 0.8), (0.6, 0.7, 0.5), (0.1, 0.05, 0.1), 0.3, 8)
PATCHES = {
    "horn": bumped_patches.horn(200, 200),
    "ring": bumped_patches.ring(200, 200),
    "globe": bumped_patches.globe(200, 200),
    "sheet": bumped_patches.sheared_sheet(200, 200, shear=0.0),
}


@pytest.mark.parametrize("name", PATCHES)
def test_derivatives_are_those_of_the_points(name):
    patch = PATCHES[name]
    grid = patch.surface.positions.reshape(201, 201, 3)
    p_u, p_v = (v.reshape(201, 201, 3)[1:-1, 1:-1] for v in (patch.p_u, patch.p_v))
    assert np.abs((grid[1:-1, 2:] - grid[1:-1, :-2]) * 100.0 - p_u).max() < 0.01
    assert np.abs((grid[2:, 1:-1] - grid[:-2, 1:-1]) * 100.0 - p_v).max() < 0.01
    normals = normalize(np.cross(p_u, p_v))
    at = patch.surface.normals.reshape(201, 201, 3)[1:-1, 1:-1]
    np.testing.assert_allclose(normals, at, atol=1e-5)
    assert (dot(at, normals) > 0.0).all()


def test_a_sheared_sheets_v_runs_aslant():
    patch = bumped_patches.sheared_sheet(20, 20, shear=0.5, bulge=0.0)
    np.testing.assert_allclose(patch.p_v, patch.p_v[0] + 0.0 * patch.p_v)
    np.testing.assert_allclose(patch.p_v[0], (1.0, 2.0, 0.0))
    st = patch.surface.texture_coordinates
    # The point at (u, v) lies where both steps lead.
    found = (st[:, :1] - 0.5) * patch.p_u + (st[:, 1:] - 0.5) * patch.p_v
    np.testing.assert_allclose(found, patch.surface.positions, atol=1e-12)


def test_repeats_shorten_steps_and_rotation_turns_them():
    patch = PATCHES["ring"]
    often = patch.with_repeats(4, 2)
    np.testing.assert_array_equal(often.p_u * 4.0, patch.p_u)
    np.testing.assert_array_equal(often.p_v * 2.0, patch.p_v)
    np.testing.assert_array_equal(
        often.surface.texture_coordinates, patch.surface.texture_coordinates * [4.0, 2.0]
    )
    turned = patch.rotated(rotation("x", 90.0))
    np.testing.assert_allclose(turned.p_u[:, 2], patch.p_u[:, 1], atol=1e-5)
    np.testing.assert_allclose(dot(turned.p_u, turned.surface.normals), 0.0, atol=1e-5)


@pytest.mark.parametrize("given", [{"taper": 0.0}, {"taper": 1.5}, {"width": 1.0}])
def test_no_horn(given):
    with pytest.raises(ValueError, match="give numbers from 0 to 1"):
        bumped_patches.horn(4, 4, **given)


def test_corners_weigh_linear_functions_right():
    columns, rows, divided = 3, 2, 4
    corners = bumped_patches.corners_of_grid(columns, rows, divided)
    fine, coarse = (surfaces.plane(columns * n, rows * n).positions for n in (divided, 1))
    assert (corners.weights >= 0.0).all()
    np.testing.assert_array_equal(corners.weights.sum(axis=1), 1.0)
    np.testing.assert_allclose(
        offset_vectors.straight(coarse[corners.numbers], corners.weights), fine, atol=1e-15
    )
    with pytest.raises(ValueError, match="0 parts of a cell's edge"):
        bumped_patches.corners_of_grid(3, 2, 0)


def test_a_meshs_derivatives_are_the_patchs():
    patch = PATCHES["ring"]
    p_u, p_v = offset_vectors.derivatives_of_mesh(patch.surface)
    grid = np.arange(201 * 201).reshape(201, 201)[1:-1, 1:-1].ravel()
    assert np.abs(p_u - patch.p_u)[grid].max() < 0.03
    assert np.abs(p_v - patch.p_v)[grid].max() < 0.03


def test_a_mesh_without_areas_has_its_surfaces_frame():
    surface = surfaces.plane().with_repeats(1.0, 0.0)
    p_u, p_v = offset_vectors.derivatives_of_mesh(surface)
    np.testing.assert_array_equal(p_u, surface.tangents)
    np.testing.assert_array_equal(p_v, surface.binormals)


def test_texels_of_signed_bytes():
    offsets = np.array([[[0.5, -0.5], [2.0, 0.0]]])
    np.testing.assert_array_equal(
        passes.signed_texels(offsets, 1.0, GEFORCE_3), [[[64, 193, 127], [127, 0, 127]]]
    )
    exact = passes.signed_texels(offsets, 1.0, IDEAL) * 255.0
    np.testing.assert_allclose(exact, [[[63.5, 192.5, 127.0], [127.0, 0.0, 127.0]]])
    with pytest.raises(ValueError, match="above zero"):
        passes.signed_texels(offsets, 0.0, GEFORCE_3)


@pytest.mark.parametrize("unit_length", [True, False])
def test_places_on_the_disc_and_back(unit_length):
    z = np.linspace(0.05, 1.0, 7)
    r = np.sqrt(1.0 - z * z)
    normals = np.stack([r * math.cos(1.0), r * math.sin(1.0), z], axis=-1)
    place = passes.on_disc(normals, unit_length)
    np.testing.assert_allclose(passes.normals_on_disc(place, unit_length), normals, atol=1e-12)
    # Beyond the rim lie the rim's.
    beyond = passes.normals_on_disc([[0.99, 0.5]], unit_length)
    np.testing.assert_allclose(beyond, [[1.0, 0.0, 0.0]], atol=1e-12)


def test_parts_are_all_of_the_surface():
    surface = surfaces.plane(8, 8)
    found = passes.parts(surface, 4, 2)
    assert len(found) == 8
    assert sum(len(part.triangles) for part in found) == len(surface.triangles)


# One fragment: a triangle-sized plane whose normal leans and whose offset is one texel.
NORMAL = normalize(np.array([0.3, 0.2, 0.9]))
P_U, P_V = np.array([0.5, 0.0, -0.17]), np.array([0.3, 1.1, -0.34])
OFFSET = np.array([0.6, -0.35])


def constant(vector):
    return np.tile(np.asarray(vector, np.float64), (4, 1))


def drawn(commands, profile, load_light):
    """What a pass leaves in the middle of a panel, RGB, by the machine or, unrounded, the ideal."""
    view = orthographic_view(Panel(0, 0, 8, 8))
    every = (view.panel.clear((0.0, 0.0, 0.0)), *load_light(profile), *commands(view, profile))
    if profile.arithmetic.exact:
        return execute_ideal(every, 8, 8).color[4, 4, :3]
    return execute(every, profile, 8, 8).framebuffer.color[4, 4, :3] / 255.0


def cube(profile):
    return passes.load_light(128, profile, LIT), normalization_cube_map.load(128, profile)


def bump_map(profile, load, scale=0.7):
    return load(np.tile(OFFSET, (4, 4, 1)), scale, "bumps", profile), "bumps", scale


@pytest.mark.parametrize(("profile", "near"), [(IDEAL, 0.004), (GEFORCE_3, 0.012), (FUTURE, 0.012)])
def test_dot_products_light_a_fragment_by_the_bumped_normal(profile, near):
    frame = offset_vectors.natural(constant(P_U), constant(P_V))
    expected = LIT.radiance(normalize(offset_vectors.bumped(frame, OFFSET)))[0]

    def commands(view, profile):
        loaded, name, scale = bump_map(profile, passes.load_signed)
        return loaded, *passes.dot_product_pass(surfaces.plane(), frame, name, scale, view)

    np.testing.assert_allclose(drawn(commands, profile, cube), expected, atol=near)


@pytest.mark.parametrize(("profile", "near"), [(IDEAL, 0.004), (FUTURE, 0.012)])
@pytest.mark.parametrize("lengths", [True, False])
@pytest.mark.parametrize("scale", [0.7, 3.0])
def test_combiners_give_directions_their_length_back(profile, near, lengths, scale):
    frame = offset_vectors.natural(constant(P_U), constant(P_V))
    unit = offset_vectors.normalized(constant(P_U), constant(P_V))
    area = np.sqrt(dot(frame.normal, frame.normal))
    sizes = np.stack([np.sqrt(dot(v, v)) / area for v in (frame.first, frame.second)], axis=-1)
    expected = LIT.radiance(normalize(offset_vectors.bumped(frame if lengths else unit, OFFSET)))[0]
    # Directions come shorter than one, as between vertices, and each otherwise.
    short = Frame(0.7 * unit.normal, 0.9 * unit.first, 0.6 * unit.second)

    def commands(view, profile):
        loaded, name, _ = bump_map(profile, passes.load_biased, scale)
        return loaded, *passes.natural_pass(
            surfaces.plane(), short, sizes if lengths else None, name, scale, view, profile
        )

    np.testing.assert_allclose(drawn(commands, profile, cube), expected, atol=2.0 * near)


@pytest.mark.parametrize(("profile", "near"), [(IDEAL, 0.004), (FUTURE, 0.012)])
@pytest.mark.parametrize("main", [(0.0, 1.0, 0.0), (0.6, -0.2, 0.5), (-3.0, 0.0, 1.0)])
@pytest.mark.parametrize("length", [1.0, 0.6])
def test_combiners_make_the_frame_of_a_main_direction(profile, near, main, length):
    frame = offset_vectors.of_main_direction(NORMAL, main)
    expected = LIT.radiance(normalize(offset_vectors.bumped(frame, OFFSET)))
    normals = length * constant(NORMAL)

    def commands(view, profile):
        loaded, name, scale = bump_map(profile, passes.load_biased)
        return loaded, *passes.main_direction_pass(
            surfaces.plane(), normals, main, name, scale, view, profile
        )

    np.testing.assert_allclose(drawn(commands, profile, cube), expected, atol=near)


@pytest.mark.parametrize(("profile", "near"), [(IDEAL, 1e-6), (GEFORCE_3, 0.02)])
@pytest.mark.parametrize("scale", [0.7, 1.6, 3.5])
def test_nothing_is_normalized(profile, near, scale):
    frame = offset_vectors.of_main_direction(0.8 * constant(NORMAL), (0.0, 1.0, 0.0), unit=False)
    light = normalize(np.array(LIT.light))
    lit = max(float(dot(offset_vectors.bumped(frame, OFFSET)[0], light)), 0.0)
    expected = np.minimum(np.array(LIT.color) * min(lit, 1.0) + np.array(LIT.ambient), 1.0)

    def commands(view, profile):
        loaded, name, _ = bump_map(profile, passes.load_with_one, scale)
        return loaded, *passes.plain_pass(surfaces.plane(), frame, name, scale, view, profile, lighting=LIT)

    np.testing.assert_allclose(drawn(commands, profile, cube), expected, atol=near * max(scale, 1.0))


@pytest.mark.parametrize("profile", [IDEAL, TEXRAM])
@pytest.mark.parametrize("unit_length", [True, False])
def test_light_is_displaced_by_offsets(profile, unit_length):
    frame = offset_vectors.of_main_direction(constant(NORMAL), (0.0, 1.0, 0.0))
    bumped = offset_vectors.bumped(frame, 0.3 * OFFSET)[0]
    place = passes.on_disc(bumped, unit_length)
    expected = LIT.radiance(passes.normals_on_disc(place, unit_length))

    def light(profile):
        return (passes.load_light_in_plane(256, profile, LIT, unit_length),)

    def commands(view, profile):
        loaded, name, scale = bump_map(profile, lambda o, *rest: passes.load_offsets(0.3 * o, *rest))
        return loaded, *passes.offset_passes(
            surfaces.plane(), frame, name, scale, view, across=1, along=1, unit_length=unit_length
        )

    np.testing.assert_allclose(drawn(commands, profile, light), expected, atol=0.03)
