"""The rows of a pass that depend on no vertex, kept for the next Draw of the same state."""

from copy import copy

import numpy as np

from fixedpipe.pipeline.enums import ColorWeights, ProductRounding, Register, ShadeModel
from fixedpipe.pipeline.framebuffers.bounds import scissor_box
from fixedpipe.pipeline.framebuffers.widths import fragment_bits
from fixedpipe.pipeline.native.combiner_plan import plan_combiners
from fixedpipe.pipeline.native.pack_combiners import has_stage_constants, pack_combiners, pack_constants
from fixedpipe.pipeline.native.pack_fragments import (
    pack_coverage,
    pack_facing,
    pack_fog,
    pack_holes,
    pack_lines,
    pack_tests,
    pack_writing,
)
from fixedpipe.pipeline.native.pack_units import pack_units
from fixedpipe.pipeline.state_kinds import kind_of
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R


def rows_of(state, profile, framebuffer, textures, sample=None):
    """The rows of a pass that depend on no vertex, from a cache.

    The key is the identity, because equal states may differ in bits (0.0 and -0.0). The cache holds state and
    profile, so that no other object gets their identity. States that differ in their vertex state alone share
    the rows. States that also differ in constant colours share all rows except the constants.
    """
    beside = (
        id(profile),
        framebuffer.kind,
        sample,
        *[
            None if unit is None or unit.texture is None else texture_kind(textures[unit.texture])
            for unit in state.texture_units
        ],
    )
    key = (id(state), beside)
    found = _rows.get(key)
    if found is None:
        if len(_rows) >= _MOST_ROWS:
            _rows.clear()
            _first_rows.clear()
        kind = kind_of(state)
        if (first := _first_rows.get((kind, beside))) is None:
            first = _first_rows[kind, beside] = StateRows(state, profile, framebuffer, textures, sample)
        found = _rows[key] = first.with_constants(state.register_combiners), state
    return found[0]


# StateRows by the state, which is held so that no other object gets its id; and by its kind.
_rows, _first_rows, _MOST_ROWS = {}, {}, 1024


def have_same_constants(one, other):
    """Whether two combiner programs of the same stages and flags, or None, have the same constant colours."""
    return one is other or (
        one.constant_color0 is other.constant_color0 and one.constant_color1 is other.constant_color1
    )


def texture_kind(texture):
    """The properties of a texture that rows depend on."""
    formats = texture.target, texture.internal_format, texture.bits, texture.border
    return *formats, len(texture.levels), texture.depth


class StateRows:
    """The rows of a pass that depend on no vertex, and the dependent rows for each variation."""

    def __init__(self, state, profile, framebuffer, textures, sample=None):
        self.program, self.profile = state.register_combiners, profile
        draw = np.zeros(R.DRAW_SIZE, np.int64)
        self.draw_float = np.zeros(R.DRAW_FLOAT_SIZE, np.float64)
        self.bits = fragment_bits(profile, framebuffer)
        draw[R.BITS], draw[R.BUFFER_BITS] = self.bits, framebuffer.color_bits
        draw[R.X0], draw[R.Y0], draw[R.X1], draw[R.Y1] = scissor_box(state, framebuffer)
        self.back_sign = pack_facing(state, draw)
        pack_lines(state.line, profile, draw)
        pack_coverage(state, profile, sample, draw)
        pack_holes(state, framebuffer, draw)
        pack_tests(state, profile, framebuffer, draw, self.draw_float)
        factors = pack_writing(state, framebuffer, draw)
        draw[R.NEEDS_COLOR] = draw[R.COLOR_MASK] != 0 or draw[R.ALPHA_TEST]
        program, final, constants, used = pack_combiners(state, profile, textures, draw)
        self.units, self.divided = pack_units(state, profile, textures, used, draw)
        draw[R.NEEDS_COLOR] |= draw[R.DISCARDS]
        if not draw[R.NEEDS_COLOR]:
            draw[R.BITS] = framebuffer.color_bits
        draw[R.UNITS] = len(state.texture_units)
        draw[R.YCBCR] = state.ycbcr_conversion
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
                -(1 << self.bits) + (0 if profile.arithmetic.clamp_low == -256 else 1),
            ],
            np.int32,
        )
        widths = int(draw[R.BITS]), framebuffer.color_bits, int(self.units[:, R.TEXEL_BITS].max())
        self.wide = max(widths) > R.BITS_OF_BYTES
        self.draw, self.shared = draw, (program, final, constants, arithmetic, factors)
        self.varied = {}

    def with_constants(self, program):
        """The rows for a combiner program of the same stages and flags, with its own constant colours."""
        if have_same_constants(program, self.program):
            return self
        made = copy(self)
        stages, final, _, *others = self.shared
        constants = pack_constants(program, self.bits)
        made.shared = stages, final, np.array(constants, np.int16), *others
        made.draw = self.draw.copy()
        made.draw[R.STAGE_CONSTANTS] = has_stage_constants(constants)
        made.program, made.varied = program, {}
        return made

    def variant(self, two_side, strokes, constant_color, projective):
        """(draw, units, derived data) for primitives that are two-sided or not, hold strokes or not, have one
        colour or several, and with which units' q varies.
        """
        flat = C.COLORS_SMOOTH
        if self.reads_color and (self.flat or constant_color):
            flat = C.COLORS_FLAT if self.flat else C.COLORS_EQUAL
        varies = two_side, strokes, flat, *[projective[unit] for unit in self.divided]
        return self.varied.get(varies) or self._vary(varies)

    def _vary(self, varies):
        two_side, strokes, flat, *projective = varies
        draw, units = self.draw.copy(), self.units.copy()
        draw[R.BACK_SIGN] = self.back_sign if two_side else 0
        draw[R.STROKES], draw[R.FLAT] = strokes, flat
        units[self.divided, R.PROJECTIVE] = projective
        if draw[R.NEEDS_COLOR]:
            iterates = self.reads_color and flat == C.COLORS_SMOOTH
            draw[R.NEEDS_COLOR_WEIGHTS] = self.color_weights if iterates else C.WEIGHTS_NONE
            eight_bits = draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EIGHT_BITS
            by_table = draw[R.FOG_ENABLED] == C.FOG_BY_TABLE
            draw[R.NEEDS_ITERATION_WEIGHTS] = eight_bits or self.textured or by_table
            draw[R.NEEDS_WEIGHTS] = draw[R.FOG_ENABLED] and not by_table
        self.varied[varies] = made = draw, units, {}
        return made

    def plan(self, draw, units, derived):
        """The CombinerPlan of a variant."""
        if (plan := derived.get("plan")) is None:
            program, final, _, arithmetic, _ = self.shared
            plan = derived["plan"] = plan_combiners(draw, program, final, arithmetic, units)
        return plan

    def filled_plan(self, draw, units, derived):
        """The rows of a variant's plan, with the constant colours of these rows."""
        if (rows := derived.get("rows")) is None:
            rows = derived["rows"] = self.plan(draw, units, derived).filled(self.shared[2], draw)
        return rows
