"""K08 and K10 by the imaging subset: the machine beside Eq. 1 in float, one halfway vector for each polygon,
and what the bias of the colour matrix is for.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.views import Light, orthographic_view, perspective_view, row_of_panels
from fixedpipe.effects.reflectance import brdfs, imaging_subset, material_textures
from fixedpipe.effects.reflectance.evaluate_then_interpolate import specular
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import WrapMode
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL, INFINITE_REALITY, OCTANE, OPENGL_1_2, OPENGL_1_2_IMAGING
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

SIZE = 32  # texels of the random materials and pixels of their pictures
MACHINES = (OCTANE, OPENGL_1_2_IMAGING, INFINITE_REALITY)


def random_unit(random, *shape):
    return normalize(random.standard_normal((*shape, 3)))


def random_material(seed, alpha, halfway):
    """SIZE x SIZE random frames, in half of which t and b are nearly perpendicular to ``halfway``: elsewhere
    Eq. 1 is mostly zero.
    """
    random = np.random.Generator(np.random.PCG64(seed))
    near = halfway + 1.5 * alpha * random_unit(random, SIZE, SIZE)
    normals = normalize(np.where(random.random((SIZE, SIZE, 1)) < 0.8, near, random_unit(random, SIZE, SIZE)))
    tangents = normalize(cross(random_unit(random, SIZE, SIZE), normals))
    alpha_x, alpha_y = (alpha * (1.0 + 0.5 * random.random((SIZE, SIZE))) for _ in range(2))
    k_s = random.random((SIZE, SIZE))
    return material_textures.Material(normals, tangents, cross(normals, tangents), alpha_x, alpha_y, k_s)


def square(material, light, profile, **options):
    """The highlight on a square, one texel in each pixel: float64 [SIZE, SIZE], bottom row first."""
    (panel,) = row_of_panels(1, SIZE)
    view = orthographic_view(panel)
    prepared = imaging_subset.prepare(surfaces.plane(), material, view, profile, triangles_per_polygon=2)
    return pixels(imaging_subset.specular_passes(prepared, material, light, **options), panel, profile)[
        ..., 0
    ]


def pixels(commands, panel, profile):
    commands = (panel.clear((0.0, 0.0, 0.0)), *commands)
    if profile.arithmetic.exact:
        return execute_ideal(commands, panel.width, panel.height).color[::-1, :, :3]
    framebuffer = execute(commands, profile, panel.width, panel.height).framebuffer
    return framebuffer.color[::-1, :, :3] / (2.0**framebuffer.color_bits - 1.0)


def equation(material, halfway, k_s=None):
    return brdfs.anisotropic_blinn_phong(
        halfway,
        material.tangents,
        material.binormals,
        material.alpha_x,
        material.alpha_y,
        material.k_s if k_s is None else k_s,
    )


def light_of(halfway):
    """The light whose halfway vector with the viewer at +z this is."""
    return Light(tuple(2.0 * halfway[2] * halfway - np.array([0.0, 0.0, 1.0])))


def error_bound(entries=imaging_subset.TABLE_ENTRIES):
    """How far Eq. 1 may be off. An index is off by half an entry, which is 1 / (entries - 1) in d and up to
    twice that in its square; a square is stored and drawn, subtracted and multiplied in bytes, each off by
    half a byte; so is k_s, by which one minus the sum is multiplied.
    """
    index = 2.0 / (entries - 1)
    return 2.0 * (index + 0.5 / 255.0) + 0.5 / 255.0 + 1.0 / 255.0


@pytest.mark.parametrize("profile", MACHINES, ids=lambda profile: profile.name)
@pytest.mark.parametrize("alpha", [0.02, 0.1, 0.5])
def test_the_machine_draws_equation_1_however_small_alpha_is(profile, alpha):
    random = np.random.Generator(np.random.PCG64(7))
    for seed in range(2):
        halfway = normalize(np.array([0.0, 0.0, 1.4]) + random_unit(random))
        material = random_material(seed, alpha, halfway)
        true = equation(material, halfway)
        assert 0.1 < (true > 0.0).mean() < 0.9
        error = square(material, light_of(halfway), profile) - true
        assert np.abs(error).max() < error_bound()
        # Catalogue, P16.
        assert np.sqrt((error[true > 0.0] ** 2).mean()) <= 0.004


def test_the_ideal_draws_equation_1():
    halfway = normalize(np.array([0.2, -0.3, 1.0]))
    material = random_material(3, 0.1, halfway)
    error = square(material, light_of(halfway), IDEAL) - equation(material, halfway)
    # Twice the step of the longest table.
    assert np.abs(error).max() < 4.0 / (IDEAL.pixels.max_color_table_size - 1)


def test_a_table_of_256_entries_costs_more_than_the_bytes_do():
    halfway = normalize(np.array([0.2, -0.3, 1.0]))
    material = random_material(4, 0.1, halfway)
    true = equation(material, halfway)
    errors = [
        np.sqrt(((square(material, light_of(halfway), OCTANE, table_entries=entries) - true) ** 2).mean())
        for entries in (256, 1024)
    ]
    assert errors[0] > 1.3 * errors[1]


def test_without_the_bias_negative_dot_products_are_lost():
    """P15: their squares are zero, so Eq. 1 does not fall where both are negative and is cut in half where
    one is.
    """
    halfway = normalize(np.array([0.2, -0.3, 1.0]))
    material = replace(random_material(5, 0.3, halfway), k_s=np.ones((SIZE, SIZE)))
    for profile, bound in ((IDEAL, 4.0 / (IDEAL.pixels.max_color_table_size - 1)), (OCTANE, error_bound())):
        drawn = square(material, light_of(halfway), profile, biased=False)
        x, y = (
            np.maximum(0.0, dot(halfway, vectors)) / alpha
            for vectors, alpha in (
                (material.tangents, material.alpha_x),
                (material.binormals, material.alpha_y),
            )
        )
        assert np.abs(drawn - np.maximum(0.0, 1.0 - x * x - y * y)).max() < bound
        negative = (dot(halfway, material.tangents) < 0.0) & (dot(halfway, material.binormals) < 0.0)
        assert negative.any()
        np.testing.assert_allclose(drawn[negative], 1.0, atol=1e-12)
    assert equation(material, halfway)[negative].min() == 0.0


def widest_material(seed, halfway):
    """With alpha = 1 the highlight reaches where the gate is not open."""
    one = np.ones((SIZE, SIZE))
    return replace(random_material(seed, 0.4, halfway), alpha_x=one, alpha_y=one)


def test_the_diffuse_pass_adds_the_colour_and_gates_what_was_there():
    halfway = normalize(np.array([0.2, -0.3, 1.0]))
    material, light = widest_material(6, halfway), light_of(halfway)
    (panel,) = row_of_panels(1, SIZE)
    color, ambient = np.array([0.5, 0.3, 0.4]), np.array([0.05, 0.1, 0.02])
    n_l = np.maximum(0.0, dot(material.normals, np.array(light.vector)))[..., None]
    for gated, gate in ((True, np.minimum(1.0, 4.0 * n_l)), (False, 1.0)):
        expected = color * n_l + ambient + gate * equation(material, halfway)[..., None] * [0.4, 0.3, 0.2]
        for profile, bound in ((IDEAL, 1e-4), (OCTANE, 0.02)):
            image = pixels(
                imaging_subset.commands(
                    surfaces.plane(), material, orthographic_view(panel), light, profile, color=color,
                    ambient=ambient, specular=(0.4, 0.3, 0.2), gated=gated, triangles_per_polygon=2,
                ),
                panel,
                profile,
            )  # fmt: skip
            assert np.abs(image - expected).max() < bound


def test_a_colour_map_multiplies_diffuse_and_ambient_light_and_not_the_highlight():
    halfway = normalize(np.array([0.2, -0.3, 1.0]))
    material, light = widest_material(8, halfway), light_of(halfway)
    (panel,) = row_of_panels(1, SIZE)
    colors = np.random.Generator(np.random.PCG64(9)).random((SIZE, SIZE, 3))
    color, ambient, specular_color = np.array([0.5, 0.3, 0.4]), np.array([0.05, 0.1, 0.02]), 0.3
    n_l = np.maximum(0.0, dot(material.normals, np.array(light.vector)))[..., None]
    for gated, gate in ((True, np.minimum(1.0, 4.0 * n_l)), (False, 1.0)):
        highlight = gate * specular_color * equation(material, halfway)[..., None]
        expected = colors * (color * n_l + ambient) + highlight
        for profile, bound in ((IDEAL, 1e-4), (OCTANE, 0.02)):
            image = pixels(
                (
                    material_textures.load_colors(colors, "colours", profile),
                    *imaging_subset.commands(
                        surfaces.plane(), material, orthographic_view(panel), light, profile, color=color,
                        ambient=ambient, color_map="colours", specular=(specular_color,) * 3, gated=gated,
                        triangles_per_polygon=2,
                    ),
                ),
                panel,
                profile,
            )  # fmt: skip
            assert np.abs(image - expected).max() < bound


def test_squares_are_interpolated_and_vectors_are_not():
    """Between two texels whose tangents have h.t of either sign lies no tangent with h.t = 0."""
    halfway, tilt = np.array([0.0, 0.0, 1.0]), np.radians(40.0)
    sign = np.where(np.arange(4) < 2, 1.0, -1.0)[None, :].repeat(4, axis=0)
    tangents = np.stack([np.cos(tilt) + 0.0 * sign, 0.0 * sign, np.sin(tilt) * sign], axis=-1)
    binormals = np.broadcast_to([0.0, 1.0, 0.0], tangents.shape)
    material = material_textures.Material(cross(tangents, binormals), tangents, binormals, 0.9, 0.9, 1.0)
    true = equation(material, halfway)
    assert np.ptp(true) < 1e-12
    image = square(material, light_of(halfway), IDEAL)
    np.testing.assert_allclose(image, true[0, 0], atol=1e-4)
    s, t = np.meshgrid((np.arange(SIZE) + 0.5) / SIZE, (np.arange(SIZE) + 0.5) / SIZE)
    assert np.abs(image - specular(material, halfway, s, t)).max() < 1e-4


def sphere_scene(profile, light, view, slices=10, stacks=6):
    material = material_textures.isotropic(64, 32, 0.9)
    surface = surfaces.sphere(slices, stacks).rotated(rotation("x", 20.0))
    prepared = imaging_subset.prepare(surface, material, view, profile)
    return prepared, imaging_subset.specular_passes(prepared, material, light)


def test_on_a_smooth_material_every_polygon_has_one_colour_and_it_is_eq_1s():
    (panel,) = row_of_panels(1, 96)
    light, view = Light((0.4, 0.3, 0.87)), orthographic_view(panel, half_height=1.1)
    prepared, commands = sphere_scene(OCTANE, light, view)
    image = pixels(commands, panel, OCTANE)[..., 0]
    faces = prepared.faces
    halves = faces.to_local(normalize(normalize(np.array(light.vector)) + np.array([0.0, 0.0, 1.0])))
    # A smooth material's tangents and binormals are the polygon's own axes.
    values = np.maximum(0.0, 1.0 - (halves[:, 0] / 0.9) ** 2 - (halves[:, 1] / 0.9) ** 2)
    at = np.floor((faces.centers[:, :2] / 1.1 + 1.0) * 48.0).astype(int)
    assert np.abs(image[at[:, 1], at[:, 0]] - values).max() < error_bound()
    assert (values > 0.1).sum() > 8
    found = np.unique(image[image > 0.05])
    assert len(found) <= (values > 0.04).sum()


def test_every_engine_draws_textures_that_are_replaced_while_draws_wait_and_so_with_little_memory(
    monkeypatch,
):
    (panel,) = row_of_panels(1, 48)
    light, view = Light((0.4, 0.3, 0.87)), orthographic_view(panel, half_height=1.1)
    _, commands = sphere_scene(OCTANE, light, view)
    commands = (panel.clear((0.0, 0.0, 0.0)), *commands)
    expected = execute(commands, OCTANE, 48, 48).framebuffer.color
    for engine in ("portable", "columns"):
        np.testing.assert_array_equal(
            execute(commands, OCTANE, 48, 48, engine=engine).framebuffer.color, expected
        )
    recorded = execute(commands, OCTANE, 48, 48, record=True)
    np.testing.assert_array_equal(recorded.framebuffer.color, expected)
    monkeypatch.setattr("fixedpipe.pipeline.native.queue._MOST_BYTES", 4096)
    np.testing.assert_array_equal(execute(commands, OCTANE, 48, 48).framebuffer.color, expected)


def test_polygons_have_flat_orthonormal_frames_and_only_those_that_face_the_viewer_are_drawn():
    surface = surfaces.sphere(10, 6).rotated(rotation("x", 20.0))
    faces = imaging_subset.polygons(surface)
    assert len(faces.corners) == len(surface.triangles)
    for a, b, expected in (
        (faces.normals, faces.normals, 1.0),
        (faces.tangents, faces.tangents, 1.0),
        (faces.normals, faces.tangents, 0.0),
        (faces.normals, faces.binormals, 0.0),
    ):
        np.testing.assert_allclose(dot(a, b), expected, atol=1e-12)
    points = surface.positions[faces.corners]
    for k in (1, 2):
        np.testing.assert_allclose(dot(points[:, k] - points[:, 0], faces.normals), 0.0, atol=1e-12)
    assert (dot(faces.tangents, surface.tangents[faces.corners[:, 0]]) > 0.7).mean() > 0.9
    assert (dot(faces.binormals, surface.binormals[faces.corners[:, 0]]) > 0.0).all()
    (panel,) = row_of_panels(1, 16)
    orthographic = imaging_subset.facing(faces, orthographic_view(panel))
    near = imaging_subset.facing(faces, perspective_view(panel, (0.0, 0.0, 2.0)))
    assert near.sum() < orthographic.sum() == len(faces.corners) // 2


def test_mirrored_texture_coordinates_turn_the_binormal_round():
    plane = surfaces.plane()
    mirrored = replace(plane, binormals=-plane.binormals)
    np.testing.assert_array_equal(imaging_subset.polygons(mirrored, 2).binormals, [[0.0, -1.0, 0.0]])


def test_a_window_holds_every_texel_that_a_polygon_reads():
    surface = surfaces.sphere(12, 8)
    faces = imaging_subset.polygons(surface)
    rows, columns = 64, 128
    windows = imaging_subset.windows(surface, faces, rows, columns)
    assert windows.rows.shape[1] == windows.columns.shape[1] == 16
    texels = np.arange(rows * columns, dtype=np.float64).reshape(rows, columns)
    shares = np.random.Generator(np.random.PCG64(1)).dirichlet((0.3, 0.3, 0.3), 40)
    for number, corners in enumerate(faces.corners):
        part = windows.part(texels, number)
        where = shares @ surface.texture_coordinates[corners]
        within = shares @ windows.coordinates[number]
        for (s, t), (u, v) in zip(where, within, strict=True):
            assert read(part, u, v, False) == pytest.approx(read(texels, s, t, True), abs=1e-6)


def read(image, s, t, repeated):
    """A bilinear filter's result."""
    rows, columns = image.shape
    x, y = s * columns - 0.5, t * rows - 0.5
    i, j = int(np.floor(x)), int(np.floor(y))
    total = 0.0
    for dj in (0, 1):
        for di in (0, 1):
            weight = (1.0 - abs(x - i - di)) * (1.0 - abs(y - j - dj))
            if weight < 1e-9:
                continue
            if not repeated:
                assert 0 <= i + di < columns
                assert 0 <= j + dj < rows
            total += weight * image[(j + dj) % rows, (i + di) % columns]
    return total


def test_a_polygon_that_repeats_its_material_loads_all_of_it():
    plane = surfaces.plane().with_repeats(3, 0.25)
    windows = imaging_subset.windows(plane, imaging_subset.polygons(plane, 2), 64, 32)
    assert (windows.sampler.wrap_s, windows.sampler.wrap_t) == (WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE)
    assert windows.columns.shape[1] == 32
    assert windows.rows.shape[1] == 32


def test_loads_are_small_and_two_or_three_for_each_polygon():
    (panel,) = row_of_panels(1, 32)
    prepared, commands = sphere_scene(OCTANE, Light((0.0, 0.0, 1.0)), orthographic_view(panel))
    polygons = len(prepared.faces.corners)
    loads = [c for c in commands if isinstance(c, TexImage) and c.pixels is not None]
    assert len(loads) == 2 * polygons
    assert {c.pixels.values.shape for c in loads} == {(8, 16, 3)}
    assert all(c.pixels.values.dtype == np.float32 and c.pixels.values.min() >= 0 for c in loads)
    assert len([c for c in commands if isinstance(c, Draw)]) == 2 * polygons + 3
    # The paper's order: a load, then a draw, the first square before the second.
    assert [c.label.split(":")[-1].strip() for c in commands[:4]] == [
        "(h.t/ax)^2", "draw the polygon with (h.t/ax)^2", "(h.b/ay)^2", "draw the polygon with (h.b/ay)^2",
    ]  # fmt: skip


def test_polygons_that_do_not_divide_evenly_or_all_face_away_are_refused():
    with pytest.raises(
        ValueError, match=r"Polygons of 3 triangles cannot be made of the surface's 2; give a"
    ):
        imaging_subset.polygons(surfaces.plane(), 3)
    (panel,) = row_of_panels(1, 16)
    away = surfaces.plane().rotated(rotation("y", 180.0))
    with pytest.raises(ValueError, match=r"No polygon of 'tin' faces the viewer; turn the surface round"):
        imaging_subset.prepare(
            away, material_textures.isotropic(4, 4, 0.5), orthographic_view(panel), OCTANE, name="tin"
        )


def test_a_machine_without_a_colour_matrix_refuses_the_load():
    material = material_textures.isotropic(4, 4, 0.5)
    (panel,) = row_of_panels(1, 16)
    prepared = imaging_subset.prepare(
        surfaces.plane(), material, orthographic_view(panel), OPENGL_1_2, triangles_per_polygon=2
    )
    with pytest.raises(UnsupportedState, match=r"sets color_matrix; OpenGL 1.2 has no colour matrix"):
        validate(
            imaging_subset.specular_passes(prepared, material, Light((0.0, 0.0, 1.0))), OPENGL_1_2, 16, 16
        )
