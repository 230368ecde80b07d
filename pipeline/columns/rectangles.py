"""DrawPixels, CopyPixels and Bitmap (OpenGL 1.2.1 sections 3.6.4, 3.7, 4.3.1 and 4.3.3).

Pixel groups become fragments; the column engine shades, tests and writes them. The arithmetic is in
``fixedpipe.raster.pixels.rectangles``; docs/numbers.md has the rules.
"""

from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from fixedpipe.pipeline.columns.engine import shade_and_write
from fixedpipe.pipeline.columns.fragments import FragmentColumns, fragment_depths
from fixedpipe.pipeline.commands import Bitmap, CopyPixels, kind_of
from fixedpipe.pipeline.enums import PixelCopyType, PixelTexGenAlpha
from fixedpipe.pipeline.framebuffers.depths import depth_units
from fixedpipe.pipeline.framebuffers.rectangles import (
    covered_pixels,
    divided,
    set_bits,
    takes_raster_color,
    volume_levels,
    without_footprints,
)
from fixedpipe.pipeline.framebuffers.scaled_words import Words
from fixedpipe.pipeline.framebuffers.transfer import (
    image_groups,
    transfer_colors,
    transfer_depths,
    transfer_image,
    transfer_stencil,
)
from fixedpipe.pipeline.framebuffers.widths import fragment_bits
from fixedpipe.pipeline.pixel_transfer import changes_nothing
from fixedpipe.pipeline.textures.depths_as_colors import depths_as_colors
from fixedpipe.pipeline.vertices.colors import fragment_colors
from fixedpipe.pipeline.vertices.raster_position import raster_vertex
from fixedpipe.raster.columns import numbers
from fixedpipe.raster.observer import unobserved
from fixedpipe.raster.pixels import rectangles as arithmetic


class Drawn(NamedTuple):
    """The fragments of a rectangle.

    group      the group of each fragment, counted from the lower left, row by row
    x, y       device pixels
    passed     whether each fragment passed every test
    undefined  how many groups had an undefined q
    """

    group: np.ndarray
    x: np.ndarray
    y: np.ndarray
    passed: np.ndarray
    undefined: int = 0


def draw_rectangle(command, profile, framebuffer, surfaces, textures, statistics, observe=unobserved):
    """Draw a DrawPixels, CopyPixels or Bitmap: a Drawn for each of ``surfaces``.

    framebuffer  the framebuffer that CopyPixels reads
    surfaces     the framebuffers to write, of the same size and formats: ``framebuffer`` itself, or its
                 pixels' samples
    statistics   the machine's PixelStatistics
    observe      the observer

    Returns an empty list if the raster position is not valid or a sink took the image.
    """
    state, textures = depths_as_colors(without_footprints(command.state), textures, profile)
    where = raster_vertex(command.position, state, profile, framebuffer.width, framebuffer.height)
    if where is None:  # the command is ignored
        return []
    undefined, draws = 0, None
    if isinstance(command, Bitmap):
        at = set_bits(command, where, framebuffer)
        fragments = _fragments(at, where, state, profile, framebuffer)
    elif (kind := kind_of(command)) == PixelCopyType.STENCIL:
        indices = _stencil_indices(command, framebuffer)
        at = covered_pixels(command, where, indices.shape, framebuffer)
        return [_write_stencil(at, at.of(indices), state.stencil_test, surface) for surface in surfaces]
    elif kind == PixelCopyType.DEPTH:
        depths = _depth_words(command, framebuffer)
        at = covered_pixels(command, where, depths.shape, framebuffer)
        fragments = _fragments(at, where, state, profile, framebuffer, depth=at.of(depths))
    else:
        groups = _color_groups(command, profile, framebuffer, statistics)
        if groups is None:
            return []
        at = covered_pixels(command, where, groups.shape, framebuffer)
        groups = at.of(groups).astype(np.int64)
        fragments, undefined = _of_colors(command, groups, at, where, state, profile, framebuffer)
        if command.pixel_texture is not None and command.pixel_texture.volumes is not None:
            one = numbers.one_of(framebuffer.color_bits)
            draws = _by_volume(command.pixel_texture, groups, one, fragments, state, textures)
    drawn = []
    for surface in surfaces:
        target, passed = surface.buffer(state.draw_buffer), np.zeros(len(at.x), np.bool_)
        for chosen, part, held in draws or ((slice(None), fragments, textures),):
            passed[chosen] = shade_and_write(part, state, profile, target, held, observe)
        drawn.append(Drawn(at.numbers, at.x, at.y, passed, undefined))
    return drawn


# ---------------------------------------------------------------------------------------------- groups


def _color_groups(command, profile, framebuffer, statistics):
    """Colour groups after pixel transfer and final conversion: whole numbers [h, w, 4] in the framebuffer's
    units. None: a sink took them.
    """
    bits, transfer = framebuffer.color_bits, command.transfer
    one = numbers.one_of(bits)
    plain = changes_nothing(transfer)
    if isinstance(command, CopyPixels):
        colors = framebuffer.part(framebuffer.buffer(command.read_buffer).color, command)
        if plain:
            return np.clip(colors, 0, one) if colors.dtype != np.uint8 else colors.copy()
        groups = transfer_colors(Words(colors, (one,) * 4), transfer, profile, statistics)
    else:
        image = command.image
        if plain and image.format == "RGBA" and image.values.dtype == np.uint8 and bits == 8:
            return image.values
        groups = transfer_image(image, transfer, profile, statistics)
    return None if groups is None else numbers.fixed(groups, one)


def _depth_words(command, framebuffer):
    """Depth groups after pixel transfer and final conversion: words of the depth buffer, int64 [h, w].

    In every depth format, a depth of 1 is the largest word, as for Clear.
    """
    full = float(2**framebuffer.depth_bits - 1)
    if isinstance(command, CopyPixels):
        depths = framebuffer.part(framebuffer.depth, command)
        if (command.transfer.depth_scale, command.transfer.depth_bias) == (1.0, 0.0):
            return depths.astype(np.int64)
        depths = depths / full
    else:
        depths = image_groups(command.image)
    return np.floor(transfer_depths(depths, command.transfer) * full + 0.5).astype(np.int64)


def _stencil_indices(command, framebuffer):
    """Stencil indices after pixel transfer, masked to a byte, int64 [h, w]."""
    if isinstance(command, CopyPixels):
        indices = framebuffer.part(framebuffer.stencil, command).astype(np.int64)
    else:
        indices = image_groups(command.image)
    return transfer_stencil(indices, command.transfer) & 0xFF


def _write_stencil(at, indices, test, surface):
    """Stencil indices go through the scissor and the write mask alone. Source: section 4.3.1."""
    mask = 0xFF if test is None else int(test.write_mask)
    stored = surface.stencil[at.y, at.x]
    surface.stencil[at.y, at.x] = (stored & (mask ^ 0xFF)) | (indices & mask)
    return Drawn(at.numbers, at.x, at.y, np.ones(len(at.x), np.bool_))


# ------------------------------------------------------------------------------------------- fragments


def _fragments(at, where, state, profile, framebuffer, primary=None, depth=None, coordinates=None):
    """FragmentColumns at pixels ``at`` (x, y). An argument that is None takes the raster position's value."""
    count, bits = len(at.x), fragment_bits(profile, framebuffer)
    colors = fragment_colors(np.tile(where.colors, (1, 2, 1)), state, profile, bits)[0, 0]
    if primary is None:
        primary = np.broadcast_to(colors[:4], (count, 4))
    if depth is None:
        depth = np.broadcast_to(_raster_depth(where, state, framebuffer), count)
    if coordinates is None:
        coordinates = np.broadcast_to(divided(where.coordinates), (count, *where.coordinates.shape))
    return FragmentColumns(
        at.x,
        at.y,
        depth,
        primary,
        np.broadcast_to(colors[4:], (count, 4)),
        np.broadcast_to(np.float64(where.fog), count),
        coordinates,
        divided=(False,) * coordinates.shape[1],
    )


def _raster_depth(where, state, framebuffer):
    """The depth word of fragments at the raster position, as a triangle of constant depth has it.

    It is -1 where a depth limit discards the fragments.
    """
    vertex = SimpleNamespace(z=np.array([where.z]), inverse_w=np.array([where.inverse_w]))
    return fragment_depths(depth_units(state, framebuffer, vertex), state, framebuffer)[0]


def _of_colors(command, groups, at, where, state, profile, framebuffer):
    """FragmentColumns that take the groups, [k, 4], as colours or texture coordinates; and how many q were
    undefined.
    """
    texture, one = command.pixel_texture, numbers.one_of(framebuffer.color_bits)
    primary = numbers.convert(groups, one, numbers.one_of(fragment_bits(profile, framebuffer)))
    if texture is None:
        return _fragments(at, where, state, profile, framebuffer, primary), 0
    undefined = 0
    if texture.volumes is None:
        coordinates, undefined = arithmetic.quotients(groups, one)
    else:
        coordinates = arithmetic.fractions(groups, one)
    coordinates = np.broadcast_to(coordinates[:, None], (len(groups), len(state.texture_units), 4))
    fragments = _fragments(at, where, state, profile, framebuffer, primary, None, coordinates)
    primary = _pixel_texture_color(texture, primary, where, state, profile, framebuffer)
    return replace(fragments, primary=primary, texel_alpha=_texel_alpha(texture, groups, one)), undefined


def _by_volume(texture, groups, one, fragments, state, textures):
    """For each volume that q chooses: (which fragments, their FragmentColumns, the textures with this
    volume).

    No two fragments of a rectangle share a pixel, so their order changes no pixel.
    """
    volume = arithmetic.chosen_volumes(groups[:, 3], one, texture.volumes, int(texture.q_filter))
    result = []
    for number in np.unique(volume).tolist():
        chosen = volume == number
        held = with_volume(textures, state, texture.volumes, number)
        result.append((chosen, fragments.part(chosen), held))
    return result


def _pixel_texture_color(texture, primary, where, state, profile, framebuffer):
    """Fragment colours of a pixel texture. Source: the tables of SGIX_pixel_texture and
    SGIS_pixel_texture.
    """
    rgb, alpha = takes_raster_color(texture)
    if not (rgb or alpha):
        return primary
    bits = fragment_bits(profile, framebuffer)
    current = fragment_colors(np.tile(where.colors, (1, 2, 1)), state, profile, bits)[0, 0, :4]
    if rgb and alpha:
        return np.broadcast_to(current, primary.shape)
    return np.where(np.array([rgb, rgb, rgb, alpha]), current, primary)


def _texel_alpha(texture, groups, one):
    if not texture.alpha_replace:
        return None
    return arithmetic.alpha_bytes(groups[:, 3], one, texture.alpha == PixelTexGenAlpha.LS)


def with_volume(textures, state, volumes, number):
    """The textures, where those of the state's units hold volume ``number`` of their ``volumes``."""
    held = dict(textures)
    for unit in state.texture_units:
        if unit is not None and unit.texture is not None:
            texture = textures[unit.texture]
            held[unit.texture] = replace(
                texture,
                levels=volume_levels(texture.levels, volumes, number),
                ideal=None if texture.ideal is None else volume_levels(texture.ideal, volumes, number),
            )
    return held
