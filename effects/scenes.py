"""The figures' scenes: each a function of machine, panel size and numbers that returns one tuple of commands.

A scene draws a row of square panels. Nothing is drawn here; every number that matters is a parameter, so that
checks can turn a part of the picture off.
"""

import math

import numpy as np

from effects import (
    anisotropic_blinn_phong,
    diffuse_bump,
    evaluate_then_interpolate,
    gloss_map,
    height_fields,
    material_textures,
    meshes,
    normalization_cube_map,
)
from effects.encode import encode_factor
from effects.matrices import rotate, rotation
from effects.passes import show
from effects.vectors import normalize
from effects.views import Light, orthographic_view, perspective_view, row_of_panels


def pixel_grid(size, extent):
    """Coordinates in [-1, 1] of pixel centres on a square that fills ``extent`` of a panel, bottom row
    first.
    """
    edge = ((np.arange(size) + 0.5) / size * 2.0 - 1.0) / extent
    return np.meshgrid(edge, edge)


# The halfway vector of the catalogue's ring measurements: tilted 24 degrees towards +x.
RING_HALF = normalize(np.array([0.45, 0.0, 1.0]))


def _dome_material(map_size, alpha_x, alpha_y):
    s, t = height_fields.texel_centers(map_size, map_size)
    return material_textures.from_slopes(*height_fields.dome_slopes(s, t), alpha_x, alpha_y)


def domes_scene(
    profile, size, *, map_size, alpha_x, alpha_y, domes, extent, diffuse, ambient, specular, background
):
    """F004-2: left the float reference (K16) shown as a picture, right the register combiners (K10, K07)."""
    left, right = row_of_panels(2, size)
    material = _dome_material(map_size, alpha_x, alpha_y)
    toward_light = normalize(2.0 * RING_HALF[2] * RING_HALF - np.array([0.0, 0.0, 1.0]))
    light = Light(tuple(toward_light))

    x, y = pixel_grid(size, extent)
    s, t = (x + 1.0) * (0.5 * domes), (y + 1.0) * (0.5 * domes)
    lit = evaluate_then_interpolate.diffuse(material, toward_light, s, t)[..., None] * np.array(diffuse)
    highlight = evaluate_then_interpolate.specular(material, RING_HALF, s, t)[..., None] * np.array(specular)
    covered = (np.maximum(np.abs(x), np.abs(y)) < 1.0)[..., None]
    picture = encode_factor(
        np.clip(np.where(covered, (lit + np.array(ambient)) + highlight, np.array(background)), 0.0, 1.0),
        profile,
    )

    surface = meshes.plane(1, 1, extent, extent).with_repeats(domes, domes)
    view = orthographic_view(right)
    loading, names = material_textures.load(material, "domes", profile)
    return (
        left.clear(background),
        right.clear(background),
        *show(picture, left, "software renderer's image", meshes.plane()),
        *loading,
        *diffuse_bump.diffuse_pass(
            surface, names.normal, view, light, profile, color=diffuse, ambient=ambient
        ),
        *anisotropic_blinn_phong.specular_pass(
            surface, names, view, light, profile, specular=specular, gated=False
        ),
    )


def scratched_square(seed, count):
    """F004-3's material: 256 x 256 texels, alpha 0.5, scratches of alpha_x = 0.25 and alpha_y = 1."""
    return material_textures.scratched(
        256,
        count,
        alpha_x=0.25,
        alpha_y=1.0,
        alpha=0.5,
        k_s=0.22,
        k_s_scratch=(0.55, 0.95),
        slope=0.15,
        seed=seed,
    )


def scratches_scene(profile, size, *, seed, count, elevation, extent, diffuse, ambient, specular, background):
    """F004-3: one square, three lights: from +x, from +y, from the top."""
    panels = row_of_panels(3, size)
    loading, names = material_textures.load(scratched_square(seed, count).material, "scratches", profile)
    low = rotate(rotation("y", 90.0 - elevation), np.array([0.0, 0.0, 1.0]))
    lights = {
        "+x": Light((float(low[0]), 0.0, float(low[2]))),
        "+y": Light((0.0, float(low[0]), float(low[2]))),
        "top": Light((0.0, 0.0, 1.0)),
    }
    surface, out = meshes.plane(), list(loading)
    for panel, light in zip(panels, lights.values(), strict=True):
        view = perspective_view(
            panel, (0.0, 0.0, 5.0), field_of_view=2.0 * math.degrees(math.atan(0.2 / extent))
        )
        out += (
            panel.clear(background),
            *diffuse_bump.diffuse_pass(
                surface, names.normal, view, light, profile, color=diffuse, ambient=ambient
            ),
            *anisotropic_blinn_phong.specular_pass(surface, names, view, light, profile, specular=specular),
        )
    return tuple(out)


def brushed_spheres_scene(
    profile, size, *, slices, stacks, map_columns, map_rows, spread, depth, k_s, alpha_x, alpha_y, tilt,
    light, radius, diffuse, ambient, specular, background,
):  # fmt: skip
    """F004-4: a sphere brushed along its meridians (left) and one along its parallels (right)."""
    surface = meshes.sphere(slices, stacks).rotated(rotation("x", tilt))
    toward, out = Light(light), []
    for panel, along, name in zip(
        row_of_panels(2, size), ("t", "s"), ("longitudinal", "latitudinal"), strict=True
    ):
        material = material_textures.brushed(
            map_columns,
            map_rows,
            along,
            alpha_x=alpha_x,
            alpha_y=alpha_y,
            spread=spread,
            depth=depth,
            k_s=k_s,
        )
        view = orthographic_view(panel, half_height=1.0 / radius)
        loading, names = material_textures.load(material, f"{name} brushing", profile)
        out += (
            panel.clear(background),
            *loading,
            *diffuse_bump.diffuse_pass(
                surface, names.normal, view, toward, profile, color=diffuse, ambient=ambient
            ),
            *anisotropic_blinn_phong.specular_pass(surface, names, view, toward, profile, specular=specular),
        )
    return tuple(out)


def _pebbled(size, cells, depth, seed=5):
    """Slopes of a bed of ``cells`` x ``cells`` pebbles; half balls with ``depth`` 1, flatter with less."""
    heights = height_fields.pebbles(size, size, cells, seed)
    return height_fields.slopes(height_fields.smooth(heights, 2) * depth)


def _checkered_gloss(size, cells, dull, polished):
    cell = np.arange(size) * cells // size
    return np.where((cell[:, None] + cell[None, :]) % 2 == 0, polished, dull)


def dot_product_scene(profile, size, *, cells, depth, tilt, light, diffuse, ambient, background):
    """K14: a pebbled torus under a white light."""
    (panel,) = row_of_panels(1, size)
    surface = meshes.torus(96, 48).with_repeats(5, 2).rotated(rotation("x", tilt))
    material = material_textures.from_slopes(*_pebbled(256, cells, depth), 1.0, 1.0)
    view = orthographic_view(panel, half_height=1.1)
    loading, names = material_textures.load(material, "pebbles", profile)
    return (
        panel.clear(background),
        loading[0],  # the normal map; the other two material textures are not read
        *diffuse_bump.commands(
            surface, names.normal, view, Light(light), profile, color=diffuse, ambient=ambient
        ),
    )


def gloss_scene(profile, size, *, cells, depth, dull, polished, light, diffuse, ambient, background):
    """K02: a bumpy sphere with the same exponent everywhere; left k_s = 1, right k_s from a checkered gloss
    map.
    """
    surface, out = meshes.sphere().with_repeats(4, 2), []
    slope_s, slope_t = _pebbled(256, cells, depth)
    gloss = {"constant": 1.0, "checkered": _checkered_gloss(256, 4, dull, polished)}
    for panel, (name, k_s) in zip(row_of_panels(2, size), gloss.items(), strict=True):
        material = material_textures.from_slopes(slope_s, slope_t, 1.0, 1.0, k_s)
        view = orthographic_view(panel, half_height=1.1)
        loading, names = material_textures.load(material, f"{name} gloss", profile)
        passes = gloss_map.commands(
            surface, names.normal, view, Light(light), profile, color=diffuse, ambient=ambient
        )
        out += (panel.clear(background), loading[0], *passes)
    return tuple(out)


def frames_scene(
    profile, size, *, spread, alpha_x, alpha_y, slices, stacks, light, diffuse, ambient, specular, background
):
    """K11: a brushed sphere with material textures in the local frame (left) and baked in the global frame
    (right).
    """
    columns, rows = 512, 256
    material = material_textures.brushed(
        columns, rows, "s", alpha_x=alpha_x, alpha_y=alpha_y, spread=spread, depth=0.0
    )
    normals, tangents, binormals = meshes.sphere_frames(*height_fields.texel_centers(columns, rows))
    baked = anisotropic_blinn_phong.bake(material, normals, tangents, binormals)
    surface, toward, out = meshes.sphere(slices, stacks), Light(light), []
    local, local_names = material_textures.load(material, "local frame", profile)
    in_world, world_names = material_textures.load(baked, "global frame", profile)
    for panel, names, is_global in zip(
        row_of_panels(2, size), (local_names, world_names), (False, True), strict=True
    ):
        view = orthographic_view(panel, half_height=1.1)
        out += (
            panel.clear(background),
            *(in_world if is_global else local),
            *diffuse_bump.diffuse_pass(
                surface, local_names.normal, view, toward, profile, color=diffuse, ambient=ambient
            ),
            *anisotropic_blinn_phong.specular_pass(
                surface, names, view, toward, profile, specular=specular, global_frame=is_global
            ),
        )
    return tuple(out)


def normalization_scene(
    profile, size, *, cube_map_size, light, cells, depth, alpha_x, alpha_y,
    diffuse, ambient, specular, background,
):  # fmt: skip
    """K12: a single square under a close light; left vectors as vertex colours, right from the cube map."""
    left, right = row_of_panels(2, size)
    surface = meshes.plane()
    material = material_textures.from_slopes(*_pebbled(256, cells, depth), alpha_x, alpha_y, 0.8)
    near = Light(light, point=True)
    loading, names = material_textures.load(material, "pebbles", profile)
    views = [orthographic_view(panel, half_height=1.06) for panel in (left, right)]
    # The vector to a point light, and twice the halfway vector's direction, at full length.
    to_light = surface.to_local(np.array(light) - surface.positions)
    toward_viewer = surface.to_local(views[1].view_vectors(surface.positions))
    halfway = normalize(to_light) + toward_viewer
    return (
        left.clear(background),
        right.clear(background),
        *loading,
        *diffuse_bump.diffuse_pass(
            surface, names.normal, views[0], near, profile, color=diffuse, ambient=ambient
        ),
        *anisotropic_blinn_phong.specular_pass(surface, names, views[0], near, profile, specular=specular),
        normalization_cube_map.load(cube_map_size, profile),
        *normalization_cube_map.commands(
            surface, to_light, halfway, names, views[1], color=diffuse, specular=specular, ambient=ambient
        ),
    )
