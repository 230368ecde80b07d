"""Rectangles of pixels for machines and the ideal: covered pixels, and data of their fragments.

The data come from the raster position, the pixel texture and its volumes.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.pipeline.enums import PixelFragmentSource, PixelTexGenMode
from fixedpipe.pipeline.framebuffers.bounds import scissor_box
from fixedpipe.raster.pixels import rectangles as arithmetic


def takes_raster_color(texture):
    """(RGB, alpha): whether each of a pixel texture's fragments comes from the raster position."""
    if texture.mode is not None:
        mode = PixelTexGenMode
        return texture.mode in (mode.RGB, mode.RGBA), texture.mode in (mode.ALPHA, mode.RGBA)
    current = PixelFragmentSource.CURRENT_RASTER_COLOR
    return texture.rgb_source == current, texture.alpha_source == current


@dataclass(frozen=True, eq=False)
class Pixels:
    """Device pixels and the numbers of their groups.

    - ``x``, ``y``: int64 [k] each, row by row from the lowest.
    - ``numbers``: int64 [k], the number of each pixel's group; groups are counted in the same order.
    """

    x: np.ndarray
    y: np.ndarray
    numbers: np.ndarray

    def of(self, groups):
        """The values of the groups [h, w, ...] at each pixel, [k, ...]."""
        values = groups.reshape(-1, *groups.shape[2:])
        each_its_own = len(values) == len(self.numbers) and (np.diff(self.numbers, prepend=-1) == 1).all()
        return values if each_its_own else values[self.numbers]

    def only(self, chosen):
        """The pixels that ``chosen`` selects."""
        return Pixels(self.x[chosen], self.y[chosen], self.numbers[chosen])


def covered_pixels(command, where, shape, framebuffer):
    """The Pixels that a command's groups [h, w] cover."""
    zx, zy = command.zoom
    return _pixels((where.x, float(zx)), (where.y, float(zy)), shape, command.state, framebuffer)


def set_bits(command, where, framebuffer):
    """The Pixels whose bit is set in a Bitmap. Source: section 3.7; PixelZoom does not apply."""
    (ox, oy), bits = command.origin, np.asarray(command.bits, np.bool_)
    across, up = (np.floor(where.x - ox), 1.0), (np.floor(where.y - oy), 1.0)
    at = _pixels(across, up, bits.shape, command.state, framebuffer)
    return at.only(at.of(bits))


def _pixels(across, up, shape, state, framebuffer):
    """The Pixels of [h, w] groups inside scissor box and window clip.

    ``across`` and ``up`` are (where groups begin, how wide they are) in x and in y.
    """
    (height, width), total = shape[:2], framebuffer.height
    x0, y0, x1, y1 = scissor_box(state, framebuffer)
    x, n = arithmetic.covered(*across, width, x0, x1)
    y, m = arithmetic.covered(*up, height, total - y1, total - y0)
    size = len(y), len(x)
    down = np.broadcast_to((total - 1 - y)[:, None], size).ravel()
    at = Pixels(np.broadcast_to(x, size).ravel(), down, (m[:, None] * width + n).ravel())
    return at if state.window_clip is None else at.only(_kept(state.window_clip, x, y).ravel())


def _kept(clip, x, y):
    """The pixels of columns x and rows y, y up, that a WindowClip keeps: bool [rows, columns]."""
    inside = np.zeros((len(y), len(x)), np.bool_)
    for box in clip.rectangles:
        columns, rows = (x >= box.x) & (x < box.x + box.width), (y >= box.y) & (y < box.y + box.height)
        inside |= rows[:, None] & columns
    return inside != clip.exclusive


def divided(coordinates):
    """(s/q, t/q, r/q, 1) of the raster position's. Assumed: q counts as 1 where it is 0 or less."""
    q = coordinates[:, 3:]
    with np.errstate(all="ignore"):  # a small q may overflow, which reads a texture's edge
        divided = coordinates / np.where(q > 0, q, 1.0)
    divided[:, 3] = 1.0
    return divided


def without_footprints(state):
    """The state for fragments whose coordinates are the same at every pixel: one texel for each fragment."""
    units = tuple(
        unit
        if unit is None or unit.sampler.max_anisotropy <= 1 >= unit.sampler.max_probes
        else replace(unit, sampler=replace(unit.sampler, max_anisotropy=1.0, max_probes=1))
        for unit in state.texture_units
    )
    return state if units == state.texture_units else replace(state, texture_units=units)


def volume_levels(levels, volumes, number):
    """Level 0 of volume ``number`` of a texture's consecutive volumes; lambda is zero."""
    layers = len(levels[0]) // volumes
    return (levels[0][number * layers : (number + 1) * layers],)
