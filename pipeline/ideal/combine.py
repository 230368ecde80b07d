"""General combiners and the final combiner in real numbers."""

import numpy as np

from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    ComponentUsage,
    Mapping,
    Register,
)

_SCALE = {
    CombinerScale.NONE: 1.0,
    CombinerScale.SCALE_BY_TWO: 2.0,
    CombinerScale.SCALE_BY_FOUR: 4.0,
    CombinerScale.SCALE_BY_ONE_HALF: 0.5,
}

# The future board's: a register's range, and an exponent whose power is beyond it.
_FARTHEST, _LARGEST_EXPONENT = 256.0, 21.0


def mapped(mapping, x):
    """An input mapping in real numbers. Source: NV_register_combiners, table 4.

    The mappings called unsigned yield nothing negative; none of the others has an upper clamp.
    """
    if mapping is Mapping.SIGNED_IDENTITY:
        return x
    if mapping is Mapping.SIGNED_NEGATE:
        return -x
    x = np.maximum(0.0, x)
    return {
        Mapping.UNSIGNED_IDENTITY: lambda: x,
        Mapping.UNSIGNED_INVERT: lambda: np.maximum(0.0, 1.0 - x),
        Mapping.EXPAND_NORMAL: lambda: 2.0 * x - 1.0,
        Mapping.EXPAND_NEGATE: lambda: 1.0 - 2.0 * x,
        Mapping.HALF_BIAS_NORMAL: lambda: x - 0.5,
        Mapping.HALF_BIAS_NEGATE: lambda: 0.5 - x,
    }[mapping]()


def _variable(variable, registers, alpha):
    """A combiner variable's value: [k, 3] in an RGB portion, [k, 1] in an alpha portion."""
    register = registers[variable.register]
    if variable.usage is ComponentUsage.RGB:
        value = register[:, :3]
    elif variable.usage is ComponentUsage.ALPHA:
        value = register[:, 3:]
    elif variable.usage is ComponentUsage.BLUE:
        value = register[:, 2:3]
    else:
        raise ValueError(f"The ideal machine has no component usage {variable.usage.name}.")
    # What all fragments or components share is mapped once.
    shared = value.strides[0] == 0
    result = mapped(variable.mapping, value[:1] if shared else value)
    return np.broadcast_to(result, (len(value), 1 if alpha else 3))


def _function(function, ab, cd):
    """What the future board puts in the place of AB + CD; n / 0 is as far as its registers reach.

    Source: docs/numbers.md, section 20.
    """
    if function is CombinerFunction.SQUARE_ROOT:
        return np.sqrt(np.maximum(ab + cd, 0.0))
    if function is CombinerFunction.EXPONENTIAL:
        return np.exp(np.minimum(ab + cd, _LARGEST_EXPONENT))
    if function is CombinerFunction.DIVIDE:
        return np.where(cd == 0.0, np.sign(ab) * _FARTHEST, ab / np.where(cd == 0.0, 1.0, cd))
    raise ValueError(f"The ideal machine has no combiner function {function.name}.")


def _portion(portion, registers, alpha):
    """The three outputs of a portion, as (register, value) pairs; discarded ones left out."""
    if portion.ab_output is portion.cd_output is portion.sum_output is Register.DISCARD:
        return []
    a, b, c, d = (_variable(v, registers, alpha) for v in (portion.a, portion.b, portion.c, portion.d))
    ab, cd = a * b, c * d
    if not alpha and portion.ab_dot_product:
        ab = np.broadcast_to(ab.sum(axis=1, keepdims=True), ab.shape)
    if not alpha and portion.cd_dot_product:
        cd = np.broadcast_to(cd.sum(axis=1, keepdims=True), cd.shape)
    # Source: NV_register_combiners, section 3.8.12.2: CD where SPARE0's alpha is 1/2 or more.
    total = np.where(registers[Register.SPARE0][:, 3:] >= 0.5, cd, ab) if portion.mux_sum else ab + cd
    if portion.function is not CombinerFunction.NONE:
        total = _function(portion.function, ab, cd)
    bias = -0.5 if portion.bias is CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0.0
    outputs = ((portion.ab_output, ab), (portion.cd_output, cd), (portion.sum_output, total))
    scale = _SCALE[portion.scale]
    return [(to, (value + bias) * scale) for to, value in outputs if to is not Register.DISCARD]


def constant_color(color, count):
    """A color for ``count`` fragments, float64 [k, 4]."""
    return np.broadcast_to(np.array(color, np.float64), (count, 4))


def combine(combiners, registers, look_up=None):
    """General combiners and final combiner: float64 [k, 4], clamped to [0, 1] at the very end.

    ``registers``: Register to float64 [k, 4], everything but the constants and ZERO. AB's blue goes to alpha
    where a texture environment's dot product asks for it; users' flags are the NV2A's. Nothing is clamped
    between the stages; the final combiner's A, being the weight of a blend, stays in [0, 1].
    ``look_up(lookup, registers)``: the texel of a stage's CombinerLookup.
    """
    count = len(registers[Register.PRIMARY_COLOR])
    registers = dict(registers)
    registers[Register.ZERO] = constant_color((0.0,) * 4, count)
    program = {
        Register.CONSTANT_COLOR0: constant_color(combiners.constant_color0, count),
        Register.CONSTANT_COLOR1: constant_color(combiners.constant_color1, count),
    }
    for stage in combiners.general:
        registers.update(program)
        if stage.constant_color0 is not None:
            registers[Register.CONSTANT_COLOR0] = constant_color(stage.constant_color0, count)
        if stage.constant_color1 is not None:
            registers[Register.CONSTANT_COLOR1] = constant_color(stage.constant_color1, count)
        rgb, alpha = _portion(stage.rgb, registers, False), _portion(stage.alpha, registers, True)
        copied = stage.rgb.ab_output if stage.rgb.ab_blue_to_alpha else None
        for to, value in rgb:
            own = value[:, 2:] if to is copied else registers[to][:, 3:]
            registers[to] = np.concatenate([value, own], axis=1)
        for to, value in alpha:
            registers[to] = np.concatenate([registers[to][:, :3], value], axis=1)
        if stage.lookup is not None:
            registers[Register.TEXTURE0 + stage.lookup.unit] = look_up(stage.lookup, registers)
    registers.update(program)
    return _final(combiners.final, registers, count)


def _final(final, registers, count):
    nothing = np.zeros((count, 1))
    product = _variable(final.e, registers, False) * _variable(final.f, registers, False)
    total = np.maximum(0.0, registers[Register.SPARE0][:, :3]) + np.maximum(
        0.0, registers[Register.SECONDARY_COLOR][:, :3]
    )
    registers[Register.E_TIMES_F] = np.concatenate([product, nothing], axis=1)
    registers[Register.SPARE0_PLUS_SECONDARY_COLOR] = np.concatenate([total, nothing], axis=1)
    a, b, c, d = (_variable(v, registers, False) for v in (final.a, final.b, final.c, final.d))
    a = np.minimum(a, 1.0)
    rgb = a * b + (1.0 - a) * c + d
    return np.clip(np.concatenate([rgb, _variable(final.g, registers, True)], axis=1), 0.0, 1.0)
