"""Bump mapping as document 003 teaches it: normals, their bytes, lighting spaces, reflections."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.acceptance.ray_caster import primary_rays
from fixedpipe.effects.bump_mapping import diffuse_bump, lighting_spaces, normal_maps, normalization_cube_map
from fixedpipe.effects.environment_maps import bumped_reflections, environments
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.cube_maps import directions
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Light, orthographic_view, perspective_view, row_of_panels
from fixedpipe.effects.passes.encoding import dot_product_texels, vector_texels
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import G400, GEFORCE_3, GEFORCE_256, IDEAL, OCTANE
from fixedpipe.pipeline.textures.images import texture_2d


def bumps(edge=64):
    s, t = height_fields.texel_centers(edge, edge)
    return 0.04 * height_fields.turbulence(s, t, 4, 2, 7)


def test_the_printed_cross_product_has_the_height_first():
    heights = bumps()
    d_u, d_v = normal_maps.differences(heights, 1.0 / 64, 1.0 / 64)
    printed = normal_maps.height_first_normals(heights, 1.0 / 64, 1.0 / 64)
    expected = normalize(np.stack([np.ones_like(d_u), -d_u, -d_v], axis=-1))
    np.testing.assert_allclose(printed, expected, atol=1e-15)
    # Taken as they are for (t, b, n), flat texels lie in the surface: 90 degrees wrong.
    flat = normal_maps.height_first_normals(np.ones((4, 4)))
    np.testing.assert_array_equal(flat[0, 0], (1.0, 0.0, 0.0))
    np.testing.assert_array_equal(normal_maps.tangent_space_order(flat)[0, 0], (0.0, 0.0, 1.0))


def test_normals_are_those_of_the_height_fields_frames():
    heights = bumps()
    frame = height_fields.frames(*height_fields.slopes(heights))
    np.testing.assert_allclose(normal_maps.normals(heights, 1.0 / 64, 1.0 / 64), frame[0], atol=1e-15)
    # Steps of one texel, and heights in texels, are the document's usual choice.
    np.testing.assert_allclose(normal_maps.normals(heights * 64), frame[0], atol=1e-14)


def test_each_difference_is_divided_by_its_own_step():
    u, v = np.meshgrid(np.arange(8.0), np.arange(4.0))
    d_u, d_v = normal_maps.differences(3.0 * u + 5.0 * v, 0.5, 0.25, periodic=False)
    np.testing.assert_allclose(d_u[1:-1, 1:-1], 6.0)
    np.testing.assert_allclose(d_v[1:-1, 1:-1], 20.0)


def test_without_period_the_edge_goes_on_level():
    ramp = np.tile(np.arange(8.0), (8, 1))
    d_u, d_v = normal_maps.differences(ramp, periodic=False)
    assert d_u[0].tolist() == [0.5, 1, 1, 1, 1, 1, 1, 0.5]
    assert not d_v.any()
    assert normal_maps.differences(ramp)[0][0, 0] == -3.0


def test_bytes_round_half_up_and_read_back_within_a_byte():
    assert normal_maps.encode([-1.0, 0.0, 1.0]).tolist() == [0, 128, 255]
    values = np.linspace(-1.0, 1.0, 4001)
    assert np.abs(normal_maps.decode(normal_maps.encode(values)) - values).max() <= 1.0 / 255.0 + 1e-12
    flat = normalize(normal_maps.decode(normal_maps.encode([0.0, 0.0, 1.0])))
    assert abs(math.degrees(math.acos(flat[2])) - 0.318) < 0.001


def test_camera_frames_turn_normals_by_cofactors():
    """A modelview matrix that stretches keeps normals at right angles to tangents (E003.3)."""
    surface = surfaces.sphere(12, 6)
    view = orthographic_view(row_of_panels(1, 32)[0])
    stretched = ((2.0, 0.3, 0.0, 5.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.5, -3.0), (0.0, 0.0, 0.0, 1.0))
    t, b, n = lighting_spaces.camera_frames(surface, replace(view, modelview=stretched))
    assert np.abs(dot(t, n)).max() < 1e-5
    assert np.abs(dot(b, n)).max() < 1e-5
    # A translation turns nothing.
    moved = ((1.0, 0.0, 0.0, 5.0), (0.0, 1.0, 0.0, 6.0), (0.0, 0.0, 1.0, 7.0), (0.0, 0.0, 0.0, 1.0))
    t, b, n = lighting_spaces.camera_frames(surface, replace(view, modelview=moved))
    np.testing.assert_array_equal(n, surface.normals)


def test_rows_times_a_maps_normal_are_the_normal_in_camera_space():
    surface = surfaces.sphere(12, 6)
    view = perspective_view(row_of_panels(1, 32)[0], (1.0, 2.0, 3.0))
    bump = normalize(np.array([0.2, -0.3, 1.0]))
    x, y, z = (dot(row, bump) for row in lighting_spaces.rows(surface, view))
    world = bump[0] * surface.tangents + bump[1] * surface.binormals + bump[2] * surface.normals
    turn = np.array(view.modelview)[:3, :3]
    np.testing.assert_allclose(np.stack([x, y, z], axis=-1), world @ turn.T, atol=1e-12)


def test_with_the_objects_axes_local_vectors_are_the_objects():
    turn = rotation("y", 40.0)
    surface = lighting_spaces.with_object_axes(surfaces.sphere(8, 4).rotated(turn), turn.T)
    light = np.array([0.3, 0.5, 0.8])
    np.testing.assert_allclose(surface.to_local(light)[0], turn.T @ light, atol=1e-12)


def test_a_colour_matrix_needs_one_light_vector():
    surface, (panel,) = surfaces.sphere(8, 4), row_of_panels(1, 32)
    normals = lighting_spaces.object_space_normals(np.array([[[0.0, 0.0, 1.0]]]), np.eye(3)[:, None, None])
    settings = {"color": (1.0, 1.0, 1.0)}
    near, far = Light((0.0, 0.0, 3.0), point=True), Light((0.0, 0.0, 1.0))
    view = orthographic_view(panel)
    with pytest.raises(ValueError, match="The light vector differs from vertex to vertex"):
        lighting_spaces.color_matrix_passes(surface, normals, view, near, OCTANE, **settings)
    with pytest.raises(ValueError, match="The halfway vector differs"):
        viewer = perspective_view(panel, (0.0, 0.0, 3.0))
        lighting_spaces.color_matrix_passes(surface, normals, viewer, far, OCTANE, **settings)
    assert len(lighting_spaces.color_matrix_passes(surface, normals, view, far, OCTANE, **settings)) == 4


@pytest.mark.parametrize(
    "light", [(0.4, 0.2, 1.0), (0.59, -0.1, -0.8), (0.42, 0.0, -0.9)], ids=["high", "grazing", "behind"]
)
@pytest.mark.parametrize("space", ["camera", "object", "colour matrix", "tangent"])
def test_every_space_gives_the_document_s_lighting(space, light):
    """Ambient + colour (n.l)+ + min(1, 4 (n.l)+) k (n.h)^8 on a plane with one normal, its colour red.

    The normal leans so far that the highlight is strong where the light grazes, and the gate matters.
    """
    n, (panel,) = normalize(np.array([0.8, -0.3, 0.5])), row_of_panels(1, 8)
    view, surface, normals = orthographic_view(panel), surfaces.plane(), np.tile(n, (4, 4, 1))
    settings = {"color": (0.5, 0.0, 0.0), "ambient": (0.1, 0.1, 0.0), "specular": 0.6}
    where = surface, "map", view, Light(light)
    machine = {"camera": GEFORCE_3, "colour matrix": OCTANE}.get(space, GEFORCE_256)
    encoded = (
        dot_product_texels(normals, 1.0, machine) if space == "camera" else vector_texels(normals, machine)
    )
    load = (
        normalization_cube_map.load(256, machine),
        TexImage(label="map", texture="map", image=texture_2d(encoded)),
    )
    if space == "colour matrix":
        load = ()
        passes = lighting_spaces.color_matrix_passes(surface, normals, *where[2:], machine, **settings)
    else:
        draws = {
            "camera": lighting_spaces.camera_space_pass,
            "object": lighting_spaces.object_space_passes,
            "tangent": lighting_spaces.tangent_space_passes,
        }
        passes = draws[space](*where, machine, **settings)
    commands = (*load, panel.clear((0.0, 0.0, 0.0)), *passes)
    shown = execute(commands, machine, 8, 8).framebuffer.color[4, 4, :3] / 255.0
    toward = normalize(np.array(light))
    cosine, half = max(0.0, float(dot(n, toward))), normalize(toward + np.array([0.0, 0.0, 1.0]))
    highlight = min(1.0, 4.0 * cosine) * 0.6 * max(0.0, float(dot(n, half))) ** 8
    expected = np.array([0.5 * cosine + 0.1 + highlight, 0.1 + highlight, highlight])
    # Bytes of n, h and the length of h, to the eighth power; a cube map's texels are a quarter of a degree.
    np.testing.assert_allclose(shown, expected, atol=0.02)


def test_the_room_is_the_same_from_every_distance_and_has_six_sides():
    toward = directions(8)
    np.testing.assert_array_equal(environments.room(toward), environments.room(toward * 4.0))
    colors = environments.room(np.array([[1, 0.9, 0], [0, 1, 0], [0, -1, 0.1]], np.float64))
    assert len(np.unique(np.round(colors, 3), axis=0)) == 3
    assert colors[1].min() > 0.85  # the lamp
    left, right = environments.room(np.array([[-1.0, 0.0, 0.9], [1.0, 0.0, 0.9]]))
    assert left[0] > 2.0 * left[2]  # the warm wall
    assert right[0] < right[2] + 0.1
    assert environments.room(np.zeros((0, 3))).shape == (0, 3)


def test_the_environments_maps_agree_on_what_is_seen():
    """The sphere map's middle reflects what lies behind the viewer, its rim what lies before him."""

    def toward(d):
        return 0.5 * normalize(d) + 0.5

    view = perspective_view(row_of_panels(1, 32)[0], (3.0, 1.0, 2.0))
    texels = environments.sphere_map(64, view, IDEAL, toward).ideal[0][0, ..., :3]
    behind = normalize(np.array([3.0, 1.0, 2.0]))
    np.testing.assert_allclose(texels[31:33, 31:33].mean(axis=(0, 1)), 0.5 * behind + 0.5, atol=1e-3)
    np.testing.assert_allclose(texels[0, 0], -0.5 * behind + 0.5, atol=1e-3)
    cube = environments.cube_map(16, GEFORCE_3, toward).levels[0][..., :3]
    seen = normalize(cube / 127.5 - 1.0)
    assert np.degrees(np.arccos(np.clip(dot(seen, directions(16)), -1.0, 1.0))).max() < 1.0


def test_a_reflections_q_is_the_vector_to_the_eye():
    surface = surfaces.sphere(8, 4)
    view = perspective_view(row_of_panels(1, 32)[0], (1.0, 2.0, 3.0))
    sets = bumped_reflections.rows_and_eye(surface, view)
    q = np.stack([row[:, 3] for row in sets], axis=-1)
    np.testing.assert_array_equal(q, np.array([1.0, 2.0, 3.0]) - surface.positions)
    np.testing.assert_array_equal(sets[1][:, 2], surface.normals[:, 1])


def test_an_infinite_viewers_eye_is_where_he_is():
    surface = surfaces.sphere(8, 4)
    sets = bumped_reflections.rows_and_eye(surface, orthographic_view(row_of_panels(1, 32)[0]))
    np.testing.assert_array_equal(np.stack([row[0, 3] for row in sets]), (0.0, 0.0, 1.0))


def test_the_environment_behind_is_what_the_viewer_would_see():
    """By the cube map and by a picture, in a view from above: each pixel is the colour of its direction."""

    def toward(d):
        return 0.5 * normalize(d) + 0.5

    view = perspective_view(row_of_panels(1, 16)[0], (3.0, 2.0, 1.0))
    _, rays = primary_rays(view)
    expected = toward(rays).reshape(16, 16, 3)
    cube = bumped_reflections.load_environment(64, GEFORCE_3, toward), *bumped_reflections.backdrop(view)
    for machine, commands in (
        (GEFORCE_3, cube),
        (G400, bumped_reflections.picture_backdrop(view, 64, G400, toward)),
    ):
        shown = execute(commands, machine, 16, 16).framebuffer.color[::-1, :, :3] / 255.0
        np.testing.assert_allclose(shown, expected, atol=0.03)


def test_a_metals_tint_multiplies_what_it_reflects():
    (panel,) = row_of_panels(1, 8)
    view, tint = perspective_view(panel, (0.0, 0.0, 4.0)), (0.9, 0.6, 0.2)
    load, names = bumped_reflections.load(np.array([[[0.0, 0.0, 1.0]]]), 1.0, "flat", GEFORCE_3)
    commands = (
        *load,
        bumped_reflections.load_environment(8, GEFORCE_3, lambda d: 0.0 * d + 0.8),
        panel.clear((0.0, 0.0, 0.0)),
        *bumped_reflections.reflection_pass(surfaces.plane(), names, view, tint=tint),
    )
    shown = execute(commands, GEFORCE_3, 8, 8).framebuffer.color[4, 4, :3] / 255.0
    np.testing.assert_allclose(shown, 0.8 * np.array(tint), atol=0.006)


def test_offsets_are_signed_bytes_in_green_and_blue():
    normals = np.array([[[0.5, -0.25, 0.8], [-1.0, 1.0, 0.0]]])
    texels = bumped_reflections.offset_texels(normals, G400)
    assert texels[0].tolist() == [[0, 224, 64, 0], [0, 127, 128, 0]]


def test_an_offset_matrix_is_how_the_sphere_maps_coordinates_move():
    """In the middle of a sphere that the viewer faces: half of the eye's t and b, if he is far away."""
    surface = surfaces.sphere(96, 48)
    view = perspective_view(row_of_panels(1, 32)[0], (0.0, 0.0, 100.0))
    parts = bumped_reflections.parts(surface, 8, 8)
    assert sum(len(part.triangles) for part in parts) == len(surface.triangles)
    facing = max(parts, key=lambda part: part.normals[np.unique(part.triangles), 2].mean())
    part = replace(facing, triangles=facing.triangles[:1])
    matrix = bumped_reflections.offset_matrix(part, view)
    middle = [axis[np.unique(part.triangles)].mean(axis=0) for axis in (part.tangents, part.binormals)]
    np.testing.assert_allclose(matrix, 0.5 * np.concatenate([axis[:2] for axis in middle]), atol=0.01)


def test_a_sphere_map_refuses_an_infinite_viewer():
    surface = surfaces.sphere(8, 4)
    names = bumped_reflections.Names("offsets", "dirt")
    with pytest.raises(ValueError, match="A sphere map needs the eye's position"):
        bumped_reflections.offset_passes(surface, names, orthographic_view(row_of_panels(1, 32)[0]))


def test_a_highlights_strength_is_the_eighth_power_of_the_halfway_vectors_length():
    assert diffuse_bump.eighth_root(1.0) == 1.0
    assert diffuse_bump.eighth_root(0.0) == 0.0
    assert abs(diffuse_bump.eighth_root(0.4) ** 8 - 0.4) < 1e-15
    with pytest.raises(ValueError, match=r"The highlight's strength is 1.5; give a number from 0 to 1"):
        diffuse_bump.eighth_root(1.5)
    # A plane that mirrors the light to the viewer has nothing but its highlight.
    (panel,) = row_of_panels(1, 8)
    flat = texture_2d(normal_maps.encode([[[0.0, 0.0, 1.0]]]))
    commands = (
        TexImage(label="flat", texture="flat", image=flat),
        panel.clear((0.0, 0.0, 0.0)),
        *diffuse_bump.commands(
            surfaces.plane(), "flat", orthographic_view(panel), Light((0.0, 0.0, 1.0)), GEFORCE_256,
            color=(0.0, 0.0, 0.0), specular=0.4,
        ),
    )  # fmt: skip
    shown = execute(commands, GEFORCE_256, 8, 8).framebuffer.color[4, 4, :3] / 255.0
    # Two bytes of about 254/255 and a length of .892 as a byte, to the eighth power.
    np.testing.assert_allclose(shown, 0.4, atol=0.02)
