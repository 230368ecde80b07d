"""DrawPixels, CopyPixels and Bitmap on the ideal machine: the machines' pixels with real values.

Only stencil values and numbers of volumes are rounded.
"""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from fixedpipe.pipeline.commands import Bitmap, CopyPixels, kind_of
from fixedpipe.pipeline.enums import PixelCopyType, PixelTexGenAlpha, PixelTexGenQ, TextureCompareMode
from fixedpipe.pipeline.framebuffers.rectangles import (
    covered_pixels,
    divided,
    set_bits,
    takes_raster_color,
    volume_levels,
    without_footprints,
)
from fixedpipe.pipeline.framebuffers.transfer import (
    image_groups,
    transfer_colors,
    transfer_depths,
    transfer_image,
    transfer_stencil,
)
from fixedpipe.pipeline.ideal.coordinates import reference_of, still_place
from fixedpipe.pipeline.ideal.per_fragment import write, write_tested
from fixedpipe.pipeline.ideal.sample import sample
from fixedpipe.pipeline.ideal.shade import plan_for, shade_colors, without_keys
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.depths_as_colors import depths_as_colors
from fixedpipe.pipeline.textures.images import with_signs
from fixedpipe.pipeline.vertices.raster_position import raster_vertex
from fixedpipe.raster.observer import unobserved


@dataclass(frozen=True, eq=False)
class Rectangle:
    """Fragments of a rectangle of pixels; no two share a pixel.

    pixel               int64 [k], flat index into a buffer, top row first
    primary, secondary  float64 [k, 4]
    distances           float64 [k], fog coordinates
    depth               float64 [k], in [0, 1]
    coordinates         float64 [k, units, 4]: s, t, r, 1
    stencil             uint8 [k], values for the stencil buffer: the other fields then have no meaning. Or
                        None
    texel_alpha         float64 [k], the alpha that replaces unit 0's; or None
    volume              (int64 [k], how many), the volume of a four-dimensional texture that each fragment
                        reads; or None
    """

    pixel: np.ndarray
    primary: np.ndarray
    secondary: np.ndarray
    distances: np.ndarray
    depth: np.ndarray
    coordinates: np.ndarray
    stencil: np.ndarray | None = None
    texel_alpha: np.ndarray | None = None
    volume: tuple[np.ndarray, int] | None = None

    def part(self, chosen):
        """The fragments that ``chosen`` selects."""
        columns = {
            name: getattr(self, name)[chosen]
            for name in ("pixel", "primary", "secondary", "distances", "depth", "coordinates")
        }
        return replace(
            self,
            **columns,
            texel_alpha=None if self.texel_alpha is None else self.texel_alpha[chosen],
            volume=None if self.volume is None else (self.volume[0][chosen], self.volume[1]),
        )

    def images(self, texture):
        """(which fragments, the texture that they read): one for each volume, or one for the
        whole texture.
        """
        if self.volume is None:
            return [(slice(None), texture)]
        volume, count = self.volume
        return [
            (volume == number, replace(texture, **_volume(texture, count, number)))
            for number in np.unique(volume).tolist()
        ]


def _volume(texture, count, number):
    return {name: volume_levels(getattr(texture, name), count, number) for name in ("levels", "ideal")}


def rectangle(command, buffers, statistics):
    """The Rectangle of a command; None: its raster position is not valid, or a sink took the image.

    ``buffers``: the current IdealBuffers, in a window of the same size.
    """
    state, (height, width) = command.state, buffers.depth.shape
    window = SimpleNamespace(width=width, height=height)
    where = raster_vertex(command.position, state, IDEAL, width, height)
    if where is None:
        return None
    if isinstance(command, Bitmap):
        return _fragments(set_bits(command, where, window), where, width)
    kind = kind_of(command)
    groups = _groups(command, kind, buffers, statistics)
    if groups is None:
        return None
    at = covered_pixels(command, where, groups.shape, window)
    values, found = at.of(groups), _fragments(at, where, width)
    if kind == PixelCopyType.STENCIL:
        return replace(found, stencil=values)
    if kind == PixelCopyType.DEPTH:
        return replace(found, depth=values)
    if command.pixel_texture is None:
        return replace(found, primary=values)
    return _textured(command.pixel_texture, values, found)


def _groups(command, kind, buffers, statistics):
    """Groups after pixel transfer: colours float64 [h, w, 4], depths float64 [h, w], or stencil
    uint8 [h, w].
    """
    copied = isinstance(command, CopyPixels)
    if copied:
        source = buffers.buffer(command.read_buffer)
        plane = {
            PixelCopyType.COLOR: source.color,
            PixelCopyType.DEPTH: source.depth,
            PixelCopyType.STENCIL: source.stencil,
        }[kind]
        groups = source.rows(plane, *source.box_of(command)).copy()
    if kind == PixelCopyType.COLOR:
        if copied:
            return transfer_colors(groups, command.transfer, IDEAL, statistics)
        return transfer_image(command.image, command.transfer, IDEAL, statistics)
    if not copied:
        groups = image_groups(command.image)
    if kind == PixelCopyType.DEPTH:
        return transfer_depths(groups, command.transfer)
    return (transfer_stencil(groups.astype(np.int64), command.transfer) & 0xFF).astype(np.uint8)


def _fragments(at, where, width):
    """A Rectangle in which every fragment has the raster position's values."""
    count, units = len(at.x), len(where.coordinates)
    return Rectangle(
        at.y * width + at.x,
        np.broadcast_to(where.colors[:4], (count, 4)),
        np.broadcast_to(where.colors[4:], (count, 4)),
        np.full(count, where.fog),
        np.full(count, min(max(where.z, 0.0), 1.0)),
        np.broadcast_to(divided(where.coordinates), (count, units, 4)),
    )


def _textured(texture, groups, found):
    """The Rectangle ``found`` with colour groups as texture coordinates."""
    rgb, alpha = takes_raster_color(texture)
    primary = np.where(np.array([rgb, rgb, rgb, alpha]), found.primary, groups)
    q = groups[:, 3]
    strq, volume = groups.copy(), None
    if texture.volumes is None:
        strq[:, :3] /= np.where(q > 0, q, 1.0)[:, None]
    else:
        volume = _chosen(q * texture.volumes, texture), texture.volumes
    strq[:, 3] = 1.0
    texel_alpha = None
    if texture.alpha_replace:
        least = texture.alpha == PixelTexGenAlpha.LS
        texel_alpha = np.floor(q * 4095 + 0.5) % 256 / 255 if least else q
    coordinates = np.broadcast_to(strq[:, None], found.coordinates.shape)
    return replace(found, primary=primary, coordinates=coordinates, texel_alpha=texel_alpha, volume=volume)


def _chosen(q, texture):
    """The volume that q times the number of volumes selects, int64 [k]."""
    index = {
        PixelTexGenQ.ROUND: np.floor(q),
        PixelTexGenQ.FLOOR: np.floor(q - 0.5),
        PixelTexGenQ.CEILING: np.ceil(q - 0.5),
    }[texture.q_filter]
    return np.clip(index, 0, texture.volumes - 1).astype(np.int64)


def draw_rectangle(command, buffers, textures, plans, statistics, record):
    """Draw a DrawPixels, CopyPixels or Bitmap: the machine's pixels, real colours. ``record``: a guide's."""
    found = rectangle(command, buffers, statistics)
    if found is None:
        return
    state, textures = depths_as_colors(without_footprints(command.state), textures, IDEAL)
    if found.stencil is not None:
        if record is None:
            stored, test = buffers.stencil.reshape(-1), state.stencil_test
            mask = np.uint8(0xFF if test is None else test.write_mask)
            stored[found.pixel] = (stored[found.pixel] & ~mask) | (found.stencil & mask)
        return
    if record is not None:
        found = found.part(np.asarray(record.passed, bool))
    elif (alive := without_keys(state, textures, texel_of(found))) is not None:
        found = found.part(alive)
    if not len(found.pixel):
        return
    color = shade_rectangle(found, state, textures, plans)
    written = buffers.buffer(state.draw_buffer)
    if record is None:
        write_tested(state, written, found.pixel, color, found.depth)
    else:
        write(state, written, found.pixel, color, found.depth)


def texel_of(found):
    """A function that samples the units of a Rectangle's fragments: ``texel`` of ``shade_colors``."""

    def texel(i, unit, texture):
        parts = np.empty((len(found.pixel), 4))
        for chosen, image in found.images(texture):
            strq = found.coordinates[chosen, i]
            compares = unit.sampler.compare_mode is not TextureCompareMode.NONE
            reference = reference_of(strq) if compares else None
            parts[chosen] = sample(image, unit, still_place(strq, image.target), reference)
        if i == 0 and found.texel_alpha is not None:
            parts[:, 3] = found.texel_alpha
        return parts

    return texel


def shade_rectangle(found, state, textures, plans, observe=unobserved):
    """The colours of a Rectangle's fragments, float64 [k, 4]. ``observe``: the observer."""
    state = with_signs(state, textures)
    given = found.primary, found.secondary, found.distances, texel_of(found)
    return shade_colors(state, textures, plan_for(state, textures, plans), *given, observe)
