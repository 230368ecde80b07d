"""DrawPixels, CopyPixels and Bitmap, one pixel at a time: groups to fragments, stencil indices to the buffer.

Groups are nested lists, bottom row first, after pixel transfer; colours are bytes, 255 = 1.0.
"""

import math
from dataclasses import dataclass
from types import SimpleNamespace

from fixedpipe.pipeline.enums import FogCoordinateSource, TextureTarget
from tests.reference import (
    color_key,
    coverage,
    depth,
    fixed,
    per_fragment,
    pixel_texture,
    render,
    sample,
    shadow,
    signed_formats,
    strokes,
    vertex,
)


@dataclass
class RasterPosition:
    """Window x, y (up) and z, 1/w, the colours' eight bytes, each unit's (s, t, r, q), the fog coordinate."""

    x: float
    y: float
    z: float
    inverse_w: float
    colors: list
    coordinates: list
    fog: float


def raster_position(mesh, position, state, profile, width, height):
    """The current raster position of a one-vertex mesh, or None where it is not valid.

    Source: OpenGL 1.2.1 section 2.12.
    """
    v = vertex.process_vertex(mesh, 0, state, profile)
    x, y, z, w = v.clip
    sides = [x, y] if state.depth_clamp is not None else [x, y, z]
    if not w > 0 or not all(-w <= c <= w for c in sides):
        return None
    if any(vertex.weighted_sum(plane, v.eye) < 0 for plane in state.vertex.clip_planes):
        return None
    window = vertex.viewport_to_window(v, state.vertex.viewport, width, height)
    if not all(math.isfinite(c) for c in window):
        return None
    x, y, z, inverse_w = window
    colors = vertex.color_codes(v.colors[0], vertex.exactly_lit(state, profile), profile)
    dx, dy = position.move
    return RasterPosition(x + dx, y + dy, z, inverse_w, colors, v.coordinates, v.fog)


def given_position(position, state, profile):
    """A raster position in window coordinates. Source: ARB_window_pos."""
    x, y, z, _ = position.position
    viewport = state.vertex.viewport
    z = viewport.near + fixed.clamp(z, 0.0, 1.0) * (viewport.far - viewport.near)
    given = [fixed.clamp(c, 0.0, 1.0) for c in (*position.color, *position.secondary_color)]
    lit = vertex.exactly_lit(state, profile)
    sets, none = position.texture_coordinates, (0.0, 0.0, 0.0, 1.0)
    coordinates = [
        none if unit is None or unit.coordinates >= len(sets) else sets[unit.coordinates]
        for unit in state.texture_units
    ]
    own = state.fog is not None and state.fog.coordinate_source == FogCoordinateSource.FOG_COORDINATE
    colors = vertex.color_codes(given, lit, profile)
    dx, dy = position.move
    return RasterPosition(
        x + dx, y + dy, z, 1.0, colors, coordinates, position.fog_coordinate if own else 0.0
    )


def covers(origin, zoom, number, pixel):
    """Whether group ``number`` of a row or column covers the pixel, whose centre then lies between the
    group's edges, or on the lower. Source: OpenGL 1.2.1 section 3.6.4, Conversion to Fragments.
    """
    edges = sorted((origin + zoom * number, origin + zoom * (number + 1)))
    return edges[0] <= pixel + 0.5 < edges[1]


def covered_pixels(target, state, groups, origin, zoom):
    """(device x, y, group) of each pixel in the scissor box. Source: OpenGL 1.2.1 sections 3.6.4, 4.1.2."""
    columns, rows = coverage.scissor_rows_and_columns(state.scissor, target.width, target.height)
    for py in rows:
        for px in columns:
            if strokes.clipped_away(state.window_clip, px, py, target.height):
                continue
            for m, row in enumerate(groups):
                for n, group in enumerate(row):
                    across = covers(origin[0], zoom[0], n, px)
                    if across and covers(origin[1], zoom[1], m, target.height - 1 - py):
                        yield px, py, group


def raster_depth(raster, state, depth_format):
    """The depth word of fragments that take the raster position's depth, None beyond limits that end them.

    Source: OpenGL 1.2.1 section 3.6.4; docs/numbers.md section 5, of one depth everywhere.
    """
    one_vertex = SimpleNamespace(z=[raster.z], inverse_w=[raster.inverse_w])
    (z, *_) = depth.vertex_depths(one_vertex, [0, 0, 0], state, depth_format, state.vertex.depth_units)
    return depth.word(z, depth_format, state.depth_clamp)


def divided(strq):
    """Source: OpenGL 1.2.1 section 3.6.4; Assumed: a q that is not positive counts as 1."""
    q = strq[3] if strq[3] > 0 else 1.0
    return (*(c / q for c in strq[:3]), 1.0)


def texel(strq, unit, texture, profile):
    """A unit's texel, four bytes: magnified, lambda being no more than zero.

    Source: OpenGL 1.2.1 section 3.8.5; SGIX_pixel_texture (lambda is zero).
    """
    whole = SimpleNamespace(divided=False)
    sampler = unit.sampler
    found = sample.sample_level(
        whole, strq, texture, sampler, profile, sampler.base_level, sampler.mag_filter
    )
    return sample.to_register(found, sampler)


def texture_of(texture, pixel, group, base):
    """The texture that a group reads: one of its base level's volumes where q chooses one.

    Source: SGIX_impact_pixel_texture; Assumed: volumes lie behind one another.
    """
    if pixel is None or pixel.volumes is None:
        return texture
    number = pixel_texture.volume(group, 255, pixel.volumes, pixel.q_filter)
    layers = len(texture.levels[base]) // pixel.volumes
    level = texture.levels[base][number * layers : (number + 1) * layers]
    return SimpleNamespace(
        target=TextureTarget.TEXTURE_3D,
        internal_format=texture.internal_format,
        levels=[None] * base + [level],
    )


def read(unit, state, textures, profile, pixel, group):
    """(unit, texture) as a group reads them. Source: SGIX_impact_pixel_texture; ARB_shadow (NONE)."""
    texture, unit = shadow.as_colors(textures[unit.texture], unit, state.register_combiners, profile)
    return unit, texture_of(texture, pixel, group, unit.sampler.base_level)


def fragment(raster, state, profile, textures, group=None, pixel=None):
    """(colour after texturing and fog, whether q was undefined) of a fragment; ``group``: its colour. The
    first is None where a color key ends the fragment.

    Source: OpenGL 1.2.1 section 3.6.4, Conversion to Fragments; SGIX_pixel_texture.
    """
    state = signed_formats.with_signs(state, textures)
    primary, undefined = (raster.colors[:4] if group is None else group), False
    coordinates = [divided(strq) for strq in raster.coordinates]
    if pixel is not None:
        made, undefined = pixel_texture.coordinates(group, 255)
        if pixel.volumes is not None:
            made, undefined = pixel_texture.coordinates_of_volume(group, 255), False
        coordinates = [made] * len(coordinates)
        primary = pixel_texture.color(group, raster.colors[:4], pixel)
    found = [
        (None, None) if unit is None else read(unit, state, textures, profile, pixel, group)
        for unit in state.texture_units
    ]
    for i in color_key.killing(state):
        unit, texture = found[i]
        flags, unit = color_key.ends(texture, unit)
        if texel(coordinates[i], unit, flags, profile)[0] == 0:
            return None, undefined
    texels = [
        [0, 0, 0, 255]
        if unit is None
        else texel(coordinates[i], unit, color_key.left(texture, unit), profile)
        for i, (unit, texture) in enumerate(found)
    ]
    if pixel is not None and pixel.alpha_replace:
        texels[0] = [*texels[0][:3], pixel_texture.texel_alpha(group, 255, pixel.alpha)]
    return render.shade(
        list(primary), raster.colors[4:], raster.fog, texels, state, textures, profile
    ), undefined


def written(target, px, py, color, word, state):
    """Write a fragment that no color key ended. Source: as per_fragment.write_fragment."""
    if color is not None:
        per_fragment.write_fragment(target, px, py, color, word, state)


def draw_colors(target, groups, raster, command, textures, profile):
    """Colour groups; returns how many q were undefined. Source: OpenGL 1.2.1 section 3.6.4."""
    state, pixel, count = command.state, command.pixel_texture, 0
    word = raster_depth(raster, state, target.depth_bits)
    for px, py, group in covered_pixels(target, state, groups, (raster.x, raster.y), command.zoom):
        color, undefined = fragment(raster, state, profile, textures, group, pixel)
        count += undefined
        written(target, px, py, color, word, state)
    return count


def draw_depths(target, words, raster, command, textures, profile):
    """Depth groups, words of the depth buffer. Source: OpenGL 1.2.1 section 3.6.4."""
    state = command.state
    for px, py, word in covered_pixels(target, state, words, (raster.x, raster.y), command.zoom):
        color, _ = fragment(raster, state, profile, textures)
        written(target, px, py, color, word, state)


def draw_stencil(target, indices, raster, command):
    """Stencil indices: scissor and write mask alone. Source: OpenGL 1.2.1 section 4.3.1."""
    test = command.state.stencil_test
    mask = 255 if test is None else test.write_mask
    at = (raster.x, raster.y)
    for px, py, index in covered_pixels(target, command.state, indices, at, command.zoom):
        target.stencil[py][px] = per_fragment.write_stencil(target.stencil[py][px], index % 256, mask)


def draw_bitmap(target, bits, raster, command, textures, profile):
    """Source: OpenGL 1.2.1 section 3.7."""
    state, (ox, oy) = command.state, command.origin
    word = raster_depth(raster, state, target.depth_bits)
    corner = math.floor(raster.x - ox), math.floor(raster.y - oy)
    for px, py, bit in covered_pixels(target, state, bits, corner, (1, 1)):
        if bit:
            color, _ = fragment(raster, state, profile, textures)
            written(target, px, py, color, word, state)
