"""The rows of a combiner program: stages, final combiner and constants."""

from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.pipeline.enums import CombinerBias, Mapping, MuxSelect, Register
from fixedpipe.pipeline.framebuffers.framebuffer import color_codes
from fixedpipe.pipeline.programs.combiner_rules import WITH_FOG, combiner_program, kept_for_stages
from fixedpipe.pipeline.programs.texture_shader_rules import DISCARDING
from fixedpipe.pipeline.state import CombinerInput
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.columns.combine import coefficients
from fixedpipe.raster.columns.numbers import one_of


@cache
def _mappings(bits, expand_half):
    """The mappings as min(max(x, low) * factor + addend, one).

    The addends of the EXPAND pair depend on ``expand_half``.
    """
    one, half = one_of(bits), 1 << (bits - 1)
    expanded = one + 1 if expand_half == 128 else one
    found = {mapping: coefficients(mapping, one, expanded, half) for mapping in Mapping}
    return {m: (-one - 1 if signed else 0, factor, addend) for m, (signed, factor, addend) in found.items()}


_ZERO_MAPPINGS = frozenset({Mapping.UNSIGNED_IDENTITY, Mapping.SIGNED_IDENTITY, Mapping.SIGNED_NEGATE})


def _is_zero(variable):
    return variable.register == Register.ZERO and variable.mapping in _ZERO_MAPPINGS


def _normalized(portion):
    """The portion with its sum written as AB where CD is zero: equal values for half the work."""
    plain = (
        not portion.mux_sum
        and portion.cd_output == Register.DISCARD
        and portion.ab_output == Register.DISCARD
    )
    if plain and (_is_zero(portion.c) or _is_zero(portion.d)):
        return replace(portion, ab_output=portion.sum_output, sum_output=Register.DISCARD)
    return portion


def _blue_to_alpha(portion):
    """For the AB and the CD output, whether its blue is also written to its register's alpha."""
    return [
        portion.ab_blue_to_alpha and portion.ab_output != Register.DISCARD,
        portion.cd_blue_to_alpha and portion.cd_output != Register.DISCARD,
    ]


def _pack_portion(portion, alpha, expand_half, mux_select, bits):
    blue = [0, 0] if alpha else _blue_to_alpha(portion)
    portion, row, mappings, half = _normalized(portion), [], _mappings(bits, expand_half), 1 << (bits - 1)
    for variable in (portion.a, portion.b, portion.c, portion.d):
        row += [variable.register, variable.usage, *mappings[variable.mapping]]
    outputs = [portion.ab_output, portion.cd_output, portion.sum_output]
    row += [-1 if register == Register.DISCARD else int(register) for register in outputs]
    row += [0, 0] if alpha else [portion.ab_dot_product, portion.cd_dot_product]
    bias = -half if portion.bias == CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0
    mux = (1 if mux_select == MuxSelect.LSB else half) if portion.mux_sum else 0
    return [*row, mux, bias, portion.scale, *blue]


def _registers_read(program):
    """Registers that some input of the program names, including the parts of the pseudo-registers."""
    inputs = []
    for stage in program.general:
        for portion in (stage.rgb, stage.alpha):
            if any(r != Register.DISCARD for r in (portion.ab_output, portion.cd_output, portion.sum_output)):
                inputs += [portion.a, portion.b, portion.c, portion.d]
            if portion.mux_sum and portion.sum_output != Register.DISCARD:
                inputs.append(CombinerInput(Register.SPARE0))  # its alpha selects
    final = program.final
    inputs += [final.a, final.b, final.c, final.d, final.g]
    used = {i.register for i in inputs}
    if Register.E_TIMES_F in used:
        used |= {final.e.register, final.f.register}
    if Register.SPARE0_PLUS_SECONDARY_COLOR in used:
        used |= {Register.SPARE0, Register.SECONDARY_COLOR}
    return used


def _discards(state):
    """Whether a texture shader stage may discard fragments, or change their depth."""
    stages = state.texture_shader or ()
    return any(stage.operation in DISCARDING for stage in stages[: len(state.texture_units)])


@kept_for_stages
def _stage_rows(program, *how):
    """Rows of general and final combiners, the registers read, and whether a texture register is written.

    Equal programs share the rows. ``how`` is expand_half, mux_select and the registers' bits.
    """
    stages = [
        [_pack_portion(stage.rgb, False, *how), _pack_portion(stage.alpha, True, *how)]
        for stage in program.general
    ]
    final = program.final
    inputs = (final.a, final.b, final.c, final.d, final.e, final.f, final.g)
    written = {
        register
        for stage in program.general
        for portion in (stage.rgb, stage.alpha)
        for register in (portion.ab_output, portion.cd_output, portion.sum_output)
    }
    return (
        np.array(stages, np.int32).reshape(len(stages), 2, R.PORTION_SIZE),
        np.array([[i.register, i.usage, i.mapping == Mapping.UNSIGNED_INVERT] for i in inputs], np.int32),
        frozenset(_registers_read(program)),
        any(Register.TEXTURE0 <= register <= Register.TEXTURE3 for register in written),
    )


def pack_constants(program, bits):
    """Both constant colours of every general combiner, then the final's: rows of ``bits``-bit numbers."""
    one = one_of(bits)
    own = [color_codes(program.constant_color0, one), color_codes(program.constant_color1, one)]
    constants = [
        [
            *(own[0] if stage.constant_color0 is None else color_codes(stage.constant_color0, one)),
            *(own[1] if stage.constant_color1 is None else color_codes(stage.constant_color1, one)),
        ]
        for stage in program.general
    ]
    return [*constants, [*own[0], *own[1]]]


def pack_constants_of(program, bits, *colors):
    """``pack_constants`` of a program for several values of its two constant colours, float64 [n, 4] or None
    for the program's own: int16 [n, general combiners + 1, 8].
    """
    count = max([len(color) for color in colors if color is not None])
    rows = np.repeat(np.array([pack_constants(program, bits)], np.int16), count, axis=0)
    for number, color in enumerate(colors):
        if color is None:
            continue
        stages = [getattr(stage, f"constant_color{number}") is None for stage in program.general]
        codes = one_of(bits) * np.clip(color, 0.0, 1.0) + 0.5  # cut below, as ``to_code``
        rows[:, [*stages, True], 4 * number : 4 * number + 4] = codes.astype(np.int16)[:, None]
    return rows


def has_stage_constants(constants):
    """Whether general combiners have constant colours of their own."""
    return any(row != constants[0] for row in constants)


def pack_combiners(state, profile, textures, draw):
    """Write the combiners' entries; returns rows of stages and final combiner, constants, registers read."""
    program = combiner_program(state, profile, textures)
    if program is None and _discards(state):
        program = WITH_FOG  # also the primary colour, but texture shader stages run first
    if program is None:
        draw[R.DIRECT] = 1
        zero = np.zeros
        return (
            zero((0, 2, R.PORTION_SIZE), np.int32),
            zero((7, R.FINAL_SIZE), np.int32),
            zero((1, 8), np.int16),
            set(),
        )
    half, bits = profile.arithmetic.expand_half, int(draw[R.BITS])
    stages, final, used, writes_texture = _stage_rows(program, half, program.mux_select, bits)
    constants = pack_constants(program, bits)
    draw[R.STAGES] = len(stages)
    for on, bit in (
        (program.color_sum_clamp, C.COLOR_SUM_CLAMP),
        (program.invert_spare0, C.COLOR_SUM_INVERT_SPARE0),
        (program.invert_secondary_color, C.COLOR_SUM_INVERT_SECONDARY),
    ):
        draw[R.COLOR_SUM] |= bit if on else 0
    draw[R.USES_E_TIMES_F] = Register.E_TIMES_F in used
    draw[R.USES_SPARE0_PLUS_SECONDARY] = Register.SPARE0_PLUS_SECONDARY_COLOR in used
    draw[R.WRITES_TEXTURE] = writes_texture
    draw[R.STAGE_CONSTANTS] = has_stage_constants(constants)
    return stages, final, np.array(constants, np.int16), used
