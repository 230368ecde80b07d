"""The rows of a pass that depend on no vertex, kept for the next Draw of the same state."""

import numpy as np

from fixedpipe.pipeline.enums import ColorWeights, ProductRounding, Register, ShadeModel
from fixedpipe.pipeline.framebuffers.boxes import scissor_box
from fixedpipe.pipeline.native.pack_combiners import pack_combiners
from fixedpipe.pipeline.native.pack_fragments import (
    pack_facing,
    pack_fog,
    pack_holes,
    pack_lines,
    pack_tests,
    pack_writing,
)
from fixedpipe.pipeline.native.pack_units import pack_units
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R


def rows_of(state, profile, framebuffer, textures):
    """The rows of a pass as far as no vertex matters, kept for the next time.

    Found by identity, for equal states may differ in bits (0.0 and -0.0); what is kept holds state and
    profile, so that no other object has theirs.
    """
    height, width, _ = framebuffer.color.shape
    key = (
        id(state),
        id(profile),
        width,
        height,
        framebuffer.depth_format,
        framebuffer.color_format,
        *[_texture_kind(textures, unit) for unit in state.texture_units],
    )
    rows = _rows.get(key)
    if rows is None:
        if len(_rows) >= _MOST_ROWS:
            _rows.clear()
        rows = _rows[key] = StateRows(state, profile, framebuffer, textures)
    return rows


_rows, _MOST_ROWS = {}, 1024


def _texture_kind(textures, unit):
    """What rows know of a unit's texture."""
    if unit is None or unit.texture is None:
        return None
    texture = textures[unit.texture]
    return texture.target, texture.internal_format, len(texture.levels), texture.depth


class StateRows:
    """The rows of a pass as far as no vertex matters, and those that do for each way in which they vary."""

    def __init__(self, state, profile, framebuffer, textures):
        self.held = state, profile
        draw = np.zeros(R.DRAW_SIZE, np.int64)
        self.draw_float = np.zeros(R.DRAW_FLOAT_SIZE, np.float64)
        draw[R.X0], draw[R.Y0], draw[R.X1], draw[R.Y1] = scissor_box(state, framebuffer)
        self.back_sign = pack_facing(state, draw)
        pack_lines(state.line, profile, draw)
        pack_holes(state, framebuffer, draw)
        pack_tests(state, framebuffer, draw, self.draw_float)
        factors = pack_writing(state, framebuffer, draw)
        draw[R.NEEDS_COLOR] = draw[R.COLOR_MASK] != 0 or draw[R.ALPHA_TEST]
        program, final, constants, used = pack_combiners(state, profile, textures, draw)
        self.units, self.divided = pack_units(state, profile, textures, used, draw)
        draw[R.NEEDS_COLOR] |= draw[R.DISCARDS]
        draw[R.UNITS] = len(state.texture_units)
        self.fog_thresholds = pack_fog(state, profile, used, draw)
        draw[R.NEEDS_PRIMARY] = Register.PRIMARY_COLOR in used
        draw[R.NEEDS_SECONDARY] = Register.SECONDARY_COLOR in used
        self.flat = state.polygon.shade_model == ShadeModel.FLAT
        self.reads_color = bool(
            draw[R.NEEDS_COLOR] and (draw[R.DIRECT] or draw[R.NEEDS_PRIMARY] or draw[R.NEEDS_SECONDARY])
        )
        eight_bits = profile.arithmetic.color_weights == ColorWeights.EIGHT_BITS
        self.color_weights = C.WEIGHTS_EIGHT_BITS if eight_bits else C.WEIGHTS_EXACT
        self.textured = bool((self.units[:, R.ENABLED] != 0).any())
        self.needs_depth = bool(draw[R.NEEDS_DEPTH])
        self.area = int((draw[R.X1] - draw[R.X0]) * (draw[R.Y1] - draw[R.Y0]))
        self.reads = tuple(
            (i, unit.texture, int(self.units[i, R.SIGNED]))
            for i, unit in enumerate(state.texture_units)
            if unit is not None and unit.texture is not None and self.units[i, R.ENABLED]
        )
        arithmetic = np.array(
            [
                profile.arithmetic.product_rounding == ProductRounding.PER_PRODUCT,
                profile.arithmetic.round_before_scale,
                profile.arithmetic.clamp_low,
            ],
            np.int32,
        )
        self.draw, self.shared = draw, (program, final, constants, arithmetic, factors)
        self.varied = {}

    def vary(self, varies):
        """(draw, units, what is derived) for primitives that are two-sided, hold strokes, have one colour and
        vary in q, or not.
        """
        two_side, strokes, flat, *projective = varies
        draw, units = self.draw.copy(), self.units.copy()
        draw[R.BACK_SIGN] = self.back_sign if two_side else 0
        draw[R.STROKES], draw[R.FLAT] = strokes, flat
        units[self.divided, R.PROJECTIVE] = projective
        if draw[R.NEEDS_COLOR]:
            iterates = self.reads_color and flat == C.COLORS_SMOOTH
            draw[R.NEEDS_COLOR_WEIGHTS] = self.color_weights if iterates else C.WEIGHTS_NONE
            eight_bits = draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EIGHT_BITS
            draw[R.NEEDS_ITERATION_WEIGHTS] = eight_bits or self.textured
            draw[R.NEEDS_WEIGHTS] = draw[R.FOG_ENABLED]
        self.varied[varies] = made = draw, units, {}
        return made
