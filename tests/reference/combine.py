"""Register combiners: NV_register_combiners on signed numbers of any width, one fragment at a time.

A Machine says what stands for one: 255 for bytes, with registers of nine bits; 2^n - 1 for n bits; REAL for
real numbers, in which nothing is rounded: the extension's definition.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import inf

from fixedpipe.pipeline.enums import (
    Clamp,
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    Mapping,
    MuxSelect,
    ProductRounding,
    Register,
)
from tests.reference import fixed

FACTORS = {CombinerScale.NONE: 1, CombinerScale.SCALE_BY_TWO: 2, CombinerScale.SCALE_BY_FOUR: 4}
FAR = 2**26  # Assumed: beyond what a register reaches that nothing clamps


@dataclass(frozen=True)
class Machine:
    """What combiners need of a machine: what stands for one, how far a register reaches, the order of
    rounding, and which clamps are on.
    """

    one: int | Fraction = 255
    range: float = 1.0
    expand_half: float = 128
    clamp_low: int = -256
    product_rounding: ProductRounding = ProductRounding.JOINT
    round_before_scale: bool = True
    mapping: bool = True
    general_combiner: bool = True
    color_sum: bool = True
    final_combiner: bool = True
    constant_color: bool = True

    @cached_property
    def half(self):
        """One half. Inferred: 128 of 255."""
        return fixed.half(self.one)

    @cached_property
    def expanded(self):
        """What EXPAND_NORMAL subtracts. Inferred: twice the half of 128; real numbers have one alone."""
        return self.one + 1 if self.expand_half == 128 and self.one > 1 else self.one

    @cached_property
    def limits(self):
        """What registers hold. Source: NV_register_combiners for a range of one; Assumed: wider ones."""
        if self.one == 1:
            return -self.range, self.range
        high = int(self.range * (self.one + 1)) - 1
        return -high - (1 if self.clamp_low == -256 else 0), high

    @cached_property
    def outputs(self):
        """What general combiners clamp to. Source: NV_register_combiners section 3.8.12.2."""
        return self.limits if self.general_combiner else (-FAR, FAR)


BYTES = Machine()
DEFINITION = Machine(fixed.REAL, range=1)
# Source: docs/decisions, page 0001: the clamps that the ideal leaves out.
IDEAL = Machine(fixed.REAL, range=inf, general_combiner=False, color_sum=False, constant_color=False)


def machine_of(profile, bits=8):
    """A profile's Machine at so many bits. Source: the profile."""
    arithmetic = profile.arithmetic
    return Machine(
        2**bits - 1,
        arithmetic.combiner_range,
        arithmetic.expand_half,
        arithmetic.clamp_low,
        arithmetic.product_rounding,
        arithmetic.round_before_scale,
        *(
            clamp in arithmetic.clamps
            for clamp in (Clamp.MAPPING, Clamp.GENERAL_COMBINER, Clamp.COLOR_SUM, Clamp.FINAL_COMBINER)
        ),
    )


def map_input(x, mapping, machine=BYTES):
    """A register component through an input mapping; without the clamp a mapping is its line alone.

    Source: NV_register_combiners table 4; Measured: the unsigned two; Inferred: the half of 128.
    """
    one, positive, unsigned, (low, high) = machine.one, x, x, (-inf, inf)
    if machine.mapping:
        positive, (low, high) = max(0, x), machine.limits
        unsigned = min(positive, one)
    return {
        Mapping.UNSIGNED_IDENTITY: positive,
        Mapping.UNSIGNED_INVERT: one - unsigned,
        Mapping.EXPAND_NORMAL: 2 * positive - machine.expanded,
        Mapping.EXPAND_NEGATE: min(high, machine.expanded - 2 * positive),
        Mapping.HALF_BIAS_NORMAL: positive - machine.half,
        Mapping.HALF_BIAS_NEGATE: machine.half - positive,
        Mapping.SIGNED_IDENTITY: x,
        Mapping.SIGNED_NEGATE: fixed.clamp(-x, low, high),
    }[mapping]


def used_component(usage, k):
    """Which component of a register a variable takes. Source: NV_register_combiners section 3.8.12.2."""
    return {ComponentUsage.RGB: k, ComponentUsage.ALPHA: 3, ComponentUsage.BLUE: 2}[usage]


def read_component(registers, variable, k, machine):
    """Component k (0..2 red, green, blue; 3 alpha) of a combiner variable, mapped.

    Source: NV_register_combiners sections 3.8.12.2 (component usage) and 3.8.12.3 (unsigned mappings).
    """
    x = registers[variable.register][used_component(variable.usage, k)]
    return map_input(x, variable.mapping, machine)


def scaled_quotient(n, scale, one):
    """An exact sum scaled first and rounded then, for machines that scale before they round.

    Assumed: the order that a machine without ``round_before_scale`` would have.
    """
    if scale == CombinerScale.SCALE_BY_ONE_HALF:
        return (n + one) // (2 * one)
    return fixed.divide(FACTORS[scale] * n, one)


def scale_rounded(x, scale, one):
    """Measured: two, four, and one half of values from zero up (110441 pixels); Assumed: of negative ones."""
    if scale == CombinerScale.SCALE_BY_ONE_HALF:
        return x / 2 if one == 1 else (x + 1) >> 1
    return FACTORS[scale] * x


def combiner_output(products, scale, bias, machine=BYTES):
    """One output of a portion: the sum of its exact products, rounded, biased, scaled and clamped.

    Source: NV_register_combiners section 3.8.12.2; Measured: bias before scale; Inferred: one joint rounding.
    Products that are rounded one by one leave no exact sum to scale first.
    """
    one = machine.one
    half = machine.half if bias == CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0
    if machine.product_rounding == ProductRounding.PER_PRODUCT:
        total = scale_rounded(sum(fixed.divide(n, one) for n in products) - half, scale, one)
    elif machine.round_before_scale:
        total = scale_rounded(fixed.divide(sum(products), one) - half, scale, one)
    else:
        total = scaled_quotient(sum(products), scale, one)
        total -= 2 * half if scale == CombinerScale.SCALE_BY_TWO else half
    return fixed.clamp(total, *machine.outputs)


def mux_takes_cd(spare0_alpha, select=MuxSelect.MSB, machine=BYTES):
    """Measured: SPARE0's alpha, clamped to [0, 1], has its most significant, or its lowest, bit set."""
    alpha = fixed.clamp(spare0_alpha, 0, machine.one)
    return alpha >= machine.half if select == MuxSelect.MSB else alpha % 2 == 1


def portion_outputs(registers, portion, components, dot_products, machine, mux_select):
    """{component: (AB, CD, sum or mux)} of one portion; all inputs are read before anything is written.

    Source: NV_register_combiners section 3.8.12.2.
    """
    variables = (portion.a, portion.b, portion.c, portion.d)
    ab, cd = {}, {}
    for k in components:
        a, b, c, d = (read_component(registers, variable, k, machine) for variable in variables)
        ab[k], cd[k] = [a * b], [c * d]
    if dot_products[0]:
        ab = {k: [ab[other][0] for other in components] for k in components}
    if dot_products[1]:
        cd = {k: [cd[other][0] for other in components] for k in components}
    outputs = {}
    for k in components:
        together = ab[k] + cd[k]
        if portion.mux_sum:
            together = cd[k] if mux_takes_cd(registers[Register.SPARE0][3], mux_select, machine) else ab[k]
        outputs[k] = tuple(
            combiner_output(products, portion.scale, portion.bias, machine)
            for products in (ab[k], cd[k], together)
        )
    return outputs


def general_combiner(registers, stage, machine=BYTES, mux_select=MuxSelect.MSB):
    """The registers after one general combiner.

    Source: NV_register_combiners section 3.8.12.2; Measured: an output's blue in its register's alpha.
    """
    written = {register: list(value) for register, value in registers.items()}
    rgb, alpha = stage.rgb, stage.alpha
    dots = (rgb.ab_dot_product, rgb.cd_dot_product)
    halves = (
        (rgb, portion_outputs(registers, rgb, (0, 1, 2), dots, machine, mux_select)),
        (alpha, portion_outputs(registers, alpha, (3,), (False, False), machine, mux_select)),
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


def spare0_plus_secondary(registers, color_sum_clamp, inverted, machine):
    """The final combiner's pseudo-register; without the clamp it keeps up to two.

    ``inverted``: one minus SPARE0, one minus the secondary color.
    Source: NV_register_combiners section 3.8.12.3; Measured: kept above 255 without the clamp, inversion
    before the sum.
    """
    spare0, secondary = registers[Register.SPARE0], registers[Register.SECONDARY_COLOR]
    first, second = (Mapping.UNSIGNED_INVERT if i else Mapping.UNSIGNED_IDENTITY for i in inverted)
    sums = [map_input(spare0[k], first, machine) + map_input(secondary[k], second, machine) for k in range(3)]
    return [min(machine.one, s) if color_sum_clamp and machine.color_sum else s for s in sums] + [0]


def final_component(x, machine):
    """A component of the fragment's color. Source: NV_register_combiners section 3.8.12.3 (clamped)."""
    return fixed.clamp(x, 0, machine.one) if machine.final_combiner else x


def final_blend(a, b, c, d, machine=BYTES):
    """Red, green or blue of the final combiner's mapped inputs: ``A B + (1 - A) C + D``.

    Measured: its parts (136923 pixels); Inferred: the joint rounding of the blend of B and C.
    """
    one, a = machine.one, min(machine.one, a)
    return final_component(fixed.divide(a * b + (one - a) * c, one) + d, machine)


def final_combiner(registers, final, color_sum_clamp, inverted=(False, False), machine=BYTES):
    """The fragment's color, four numbers. Source: NV_register_combiners section 3.8.12.3."""
    file = dict(registers)
    file[Register.SPARE0_PLUS_SECONDARY_COLOR] = spare0_plus_secondary(
        registers, color_sum_clamp, inverted, machine
    )
    factors = [[read_component(file, v, k, machine) for v in (final.e, final.f)] for k in range(3)]
    file[Register.E_TIMES_F] = [fixed.divide(e * f, machine.one) for e, f in factors] + [0]
    blended = final.a, final.b, final.c, final.d
    rgb = [final_blend(*(read_component(file, v, k, machine) for v in blended), machine) for k in range(3)]
    return [*rgb, final_component(read_component(file, final.g, 3, machine), machine)]


def initial_registers(primary, secondary, textures, fog, one=255):
    """The register file of the first stage, without its constants.

    A secondary color of three components has alpha 0.
    Source: NV_register_combiners table 1; Assumed: zero where it says undefined; Measured: a disabled texture
    unit's register is (0, 0, 0, 1).
    """
    textures = [*textures, *([0, 0, 0, one] for _ in range(4 - len(textures)))]
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


def constant_color(color, machine):
    """A constant's four numbers. Source: CombinerParameterfvNV (clamped)."""
    return fixed.color_codes(color, machine.one) if machine.constant_color else list(map(Fraction, color))


def combine(combiners, registers, machine=BYTES):
    """A fragment's color from its registers: the general combiners in order, then the final one.

    Source: NV_register_combiners section 3.8.12; NV_register_combiners2 for a stage's own constants.
    """
    program = (combiners.constant_color0, combiners.constant_color1)
    names = (Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1)
    for stage in combiners.general:
        own = (stage.constant_color0, stage.constant_color1)
        for name, color, common in zip(names, own, program, strict=True):
            registers[name] = constant_color(common if color is None else color, machine)
        registers = general_combiner(registers, stage, machine, combiners.mux_select)
    for name, color in zip(names, program, strict=True):
        registers[name] = constant_color(color, machine)
    inverted = (combiners.invert_spare0, combiners.invert_secondary_color)
    return final_combiner(registers, combiners.final, combiners.color_sum_clamp, inverted, machine)
