"""Register combiners: NV_register_combiners on 9-bit signed integers, one fragment at a time."""

from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    Mapping,
    MuxSelect,
    ProductRounding,
    Register,
)
from tests.reference import fixed

ONE = 255
HALF = 128
LOWEST = -256


def map_input(x, mapping, expand_half):
    """A register component through an input mapping.

    Source: NV_register_combiners table 4; Measured: the unsigned two; Inferred: the half of 128.
    """
    positive = max(0, x)
    expanded = 2 * positive - (256 if expand_half == 128 else 255)
    return {
        Mapping.UNSIGNED_IDENTITY: positive,
        Mapping.UNSIGNED_INVERT: ONE - min(positive, ONE),
        Mapping.EXPAND_NORMAL: expanded,
        Mapping.EXPAND_NEGATE: min(ONE, -expanded),
        Mapping.HALF_BIAS_NORMAL: positive - HALF,
        Mapping.HALF_BIAS_NEGATE: HALF - positive,
        Mapping.SIGNED_IDENTITY: x,
        Mapping.SIGNED_NEGATE: fixed.clamp(-x, LOWEST, ONE),
    }[mapping]


def used_component(usage, k):
    """Which component of a register a variable takes. Source: NV_register_combiners section 3.8.12.2."""
    return {ComponentUsage.RGB: k, ComponentUsage.ALPHA: 3, ComponentUsage.BLUE: 2}[usage]


def read_component(registers, variable, k, expand_half):
    """Component k (0..2 red, green, blue; 3 alpha) of a combiner variable, mapped.

    Source: NV_register_combiners section 3.8.12.2 (component usage).
    """
    x = registers[variable.register][used_component(variable.usage, k)]
    return map_input(x, variable.mapping, expand_half)


def scaled_quotient(n, scale):
    """An exact sum scaled first and rounded then, for machines that scale before they round.

    Assumed: the order that a machine without ``round_before_scale`` would have.
    """
    if scale == CombinerScale.SCALE_BY_ONE_HALF:
        return (n + 255) // 510
    factor = {CombinerScale.NONE: 1, CombinerScale.SCALE_BY_TWO: 2, CombinerScale.SCALE_BY_FOUR: 4}[scale]
    return fixed.divide_by_255(factor * n)


def scale_rounded(x, scale):
    """Measured: two, four, and one half of values from zero up (110441 pixels); Assumed: of negative ones."""
    return {
        CombinerScale.NONE: x,
        CombinerScale.SCALE_BY_TWO: 2 * x,
        CombinerScale.SCALE_BY_FOUR: 4 * x,
        CombinerScale.SCALE_BY_ONE_HALF: (x + 1) >> 1,
    }[scale]


def combiner_output(products, scale, bias, profile):
    """One output of a portion: the sum of its exact products, rounded, biased, scaled and clamped.

    Source: NV_register_combiners section 3.8.12.2; Measured: bias before scale; Inferred: one joint rounding.
    Products that are rounded one by one leave no exact sum to scale first.
    """
    half = HALF if bias == CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0
    if profile.arithmetic.product_rounding == ProductRounding.PER_PRODUCT:
        total = scale_rounded(sum(fixed.divide_by_255(n) for n in products) - half, scale)
    elif profile.arithmetic.round_before_scale:
        total = scale_rounded(fixed.divide_by_255(sum(products)) - half, scale)
    else:
        total = scaled_quotient(sum(products), scale)
        total -= 2 * half if scale == CombinerScale.SCALE_BY_TWO else half
    return fixed.clamp(total, profile.arithmetic.clamp_low, ONE)


def mux_takes_cd(spare0_alpha, select=MuxSelect.MSB):
    """Measured: SPARE0's alpha, clamped to a byte, has its most significant, or its lowest, bit set."""
    byte = fixed.clamp(spare0_alpha, 0, ONE)
    return byte >= HALF if select == MuxSelect.MSB else byte % 2 == 1


def portion_outputs(registers, portion, components, dot_products, profile, mux_select=MuxSelect.MSB):
    """{component: (AB, CD, sum or mux)} of one portion; all inputs are read before anything is written.

    Source: NV_register_combiners section 3.8.12.2.
    """
    variables = (portion.a, portion.b, portion.c, portion.d)
    ab, cd = {}, {}
    for k in components:
        a, b, c, d = (
            read_component(registers, variable, k, profile.arithmetic.expand_half) for variable in variables
        )
        ab[k], cd[k] = [a * b], [c * d]
    if dot_products[0]:
        ab = {k: [ab[other][0] for other in components] for k in components}
    if dot_products[1]:
        cd = {k: [cd[other][0] for other in components] for k in components}
    outputs = {}
    for k in components:
        together = ab[k] + cd[k]
        if portion.mux_sum:
            together = cd[k] if mux_takes_cd(registers[Register.SPARE0][3], mux_select) else ab[k]
        outputs[k] = tuple(
            combiner_output(products, portion.scale, portion.bias, profile)
            for products in (ab[k], cd[k], together)
        )
    return outputs


def general_combiner(registers, stage, profile, mux_select=MuxSelect.MSB):
    """The registers after one general combiner.

    Source: NV_register_combiners section 3.8.12.2; Measured: an output's blue in its register's alpha.
    """
    written = {register: list(value) for register, value in registers.items()}
    rgb, alpha = stage.rgb, stage.alpha
    dots = (rgb.ab_dot_product, rgb.cd_dot_product)
    halves = (
        (rgb, portion_outputs(registers, rgb, (0, 1, 2), dots, profile, mux_select)),
        (alpha, portion_outputs(registers, alpha, (3,), (False, False), profile, mux_select)),
    )
    for portion, outputs in halves:
        destinations = (portion.ab_output, portion.cd_output, portion.sum_output)
        for k, values in outputs.items():
            for register, value in zip(destinations, values, strict=True):
                if register != Register.DISCARD:
                    written[register][k] = value
    for register, copied in ((rgb.ab_output, rgb.ab_blue_to_alpha), (rgb.cd_output, rgb.cd_blue_to_alpha)):
        if copied and register != Register.DISCARD:
            written[register][3] = written[register][2]
    return written


def spare0_plus_secondary(registers, color_sum_clamp, inverted=(False, False)):
    """The final combiner's pseudo-register; without the clamp it keeps up to 510.

    ``inverted``: one minus SPARE0, one minus the secondary color.
    Source: NV_register_combiners section 3.8.12.3; Measured: kept above 255 without the clamp, inversion
    before the sum.
    """
    spare0, secondary = registers[Register.SPARE0], registers[Register.SECONDARY_COLOR]
    first, second = (Mapping.UNSIGNED_INVERT if i else Mapping.UNSIGNED_IDENTITY for i in inverted)
    sums = [map_final_input(spare0[k], first) + map_final_input(secondary[k], second) for k in range(3)]
    return [min(ONE, s) if color_sum_clamp else s for s in sums] + [0]


def map_final_input(x, mapping):
    """Unsigned mappings only. Source: NV_register_combiners section 3.8.12.3."""
    return ONE - fixed.clamp(x, 0, ONE) if mapping == Mapping.UNSIGNED_INVERT else max(0, x)


def read_final_component(registers, variable, k):
    """Component k of a final combiner variable, mapped. Source: NV_register_combiners section 3.8.12.3."""
    return map_final_input(registers[variable.register][used_component(variable.usage, k)], variable.mapping)


def final_combiner(registers, final, color_sum_clamp, inverted=(False, False)):
    """The fragment's color, four bytes.

    Measured: its parts (136923 pixels); Inferred: the joint rounding of the blend of B and C.
    """
    file = dict(registers)
    file[Register.SPARE0_PLUS_SECONDARY_COLOR] = spare0_plus_secondary(registers, color_sum_clamp, inverted)
    factors = [[read_final_component(file, v, k) for v in (final.e, final.f)] for k in range(3)]
    file[Register.E_TIMES_F] = [fixed.divide_by_255(e * f) for e, f in factors] + [0]
    color = []
    for k in range(3):
        a, b, c, d = (read_final_component(file, v, k) for v in (final.a, final.b, final.c, final.d))
        a = min(ONE, a)
        color.append(fixed.clamp(fixed.divide_by_255(a * b + (ONE - a) * c) + d, 0, ONE))
    return [*color, read_final_component(file, final.g, 3)]


def initial_registers(primary, secondary, textures, fog):
    """The register file of the first stage, without its constants.

    A secondary color of three components has alpha 0.
    Source: NV_register_combiners table 1; Assumed: zero where it says undefined; Measured: a disabled texture
    unit's register is (0, 0, 0, 255).
    """
    textures = [*textures, *([0, 0, 0, ONE] for _ in range(4 - len(textures)))]
    return {
        Register.ZERO: [0, 0, 0, 0],
        Register.FOG: list(fog),
        Register.PRIMARY_COLOR: list(primary),
        Register.SECONDARY_COLOR: [*secondary, 0][:4],
        Register.SPARE0: [0, 0, 0, textures[0][3]],
        Register.SPARE1: [0, 0, 0, 0],
        Register.TEXTURE0: textures[0],
        Register.TEXTURE1: textures[1],
        Register.TEXTURE2: textures[2],
        Register.TEXTURE3: textures[3],
    }


def combine(combiners, registers, profile):
    """A fragment's color from its registers: the general combiners in order, then the final one.

    Source: NV_register_combiners section 3.8.12; NV_register_combiners2 for a stage's own constants.
    """
    program = (combiners.constant_color0, combiners.constant_color1)
    names = (Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1)
    for stage in combiners.general:
        own = (stage.constant_color0, stage.constant_color1)
        for name, color, common in zip(names, own, program, strict=True):
            registers[name] = fixed.color_to_bytes(common if color is None else color)
        registers = general_combiner(registers, stage, profile, combiners.mux_select)
    for name, color in zip(names, program, strict=True):
        registers[name] = fixed.color_to_bytes(color)
    inverted = (combiners.invert_spare0, combiners.invert_secondary_color)
    return final_combiner(registers, combiners.final, combiners.color_sum_clamp, inverted)
