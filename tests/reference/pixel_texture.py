"""Pixel textures: what of a fragment a colour group gives where PIXEL_TEX_GEN or PIXEL_TEXTURE is enabled.

A group is (R, G, B, A), whole numbers, ``one`` = 1.0.
"""

import math
from fractions import Fraction

from fixedpipe.pipeline.enums import PixelFragmentSource, PixelTexGenAlpha, PixelTexGenMode, PixelTexGenQ
from tests.reference import fixed


def coordinates(group, one):
    """(s, t, r, q) with s, t and r divided by q, each quotient rounded once, and whether q was undefined.

    Source: SGIX_pixel_texture; Assumed: a q that is not positive counts as 1.
    """
    undefined = group[3] <= 0
    q = one if undefined else group[3]
    return (*(float(Fraction(component, q)) for component in group[:3]), 1.0), undefined


def coordinates_of_volume(group, one):
    """(s, t, r, q) of a four-dimensional texture. Source: SGIX_impact_pixel_texture (q chooses)."""
    return (*(float(Fraction(component, one)) for component in group[:3]), 1.0)


def volume(group, one, volumes, q_filter):
    """Which of the volumes q chooses.

    Source: SGIX_impact_pixel_texture; Assumed: the two are those of a linear filter, clamped to the texture.
    """
    q = Fraction(group[3] * volumes, one)
    index = {
        PixelTexGenQ.ROUND: math.floor(q),
        PixelTexGenQ.FLOOR: math.floor(q - Fraction(1, 2)),
        PixelTexGenQ.CEILING: math.ceil(q - Fraction(1, 2)),
    }[q_filter]
    return fixed.clamp(index, 0, volumes - 1)


def texel_alpha(group, one, which):
    """The byte that replaces a texel's alpha: the upper or lower eight of the group's twelve bits.

    Source: SGIX_impact_pixel_texture; Assumed: narrower groups are widened to twelve bits, to nearest.
    """
    twelve = math.floor(Fraction(4095 * group[3], one) + Fraction(1, 2))
    return twelve % 256 if which == PixelTexGenAlpha.LS else twelve // 16


def color(group, current, texture):
    """The fragment's colour: the group's, or components of the current raster colour.

    Source: SGIX_pixel_texture's table; SGIS_pixel_texture's tables.
    """
    if texture.mode is None:
        raster = PixelFragmentSource.CURRENT_RASTER_COLOR
        rgb, alpha = texture.rgb_source == raster, texture.alpha_source == raster
    else:
        rgb = texture.mode in (PixelTexGenMode.RGB, PixelTexGenMode.RGBA)
        alpha = texture.mode in (PixelTexGenMode.ALPHA, PixelTexGenMode.RGBA)
    return [*(current if rgb else group)[:3], (current if alpha else group)[3]]
