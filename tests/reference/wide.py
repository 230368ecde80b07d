"""The rules of combine, fog, per_fragment and sample at any width, one number at a time: docs/numbers.md,
section 13. ``one`` is 2^n - 1; at 255 each is the rule of the module it is named after.
"""

from dataclasses import dataclass
from fractions import Fraction
from math import floor

from fixedpipe.pipeline.enums import (
    BlendEquation,
    CombinerBias,
    CombinerScale,
    Mapping,
    MuxSelect,
    ProductRounding,
)
from tests.reference import fixed, per_fragment

FAR_REGISTER = 2**26  # Assumed: beyond what any pass reaches whose clamp is off
FAR_COLOR = 2**30  # Assumed: likewise


@dataclass(frozen=True)
class Machine:
    """What combiners need of a machine: a value of one, a range, an order of rounding, and which clamps are
    on.
    """

    one: int
    range: float = 1.0
    expand_half: float = 128
    clamp_low: int = -256
    product_rounding: ProductRounding = ProductRounding.JOINT
    round_before_scale: bool = True
    mapping: bool = True
    general_combiner: bool = True
    final_combiner: bool = True

    @property
    def half(self):
        """One half. Inferred: 128 of 255."""
        return (self.one + 1) // 2

    @property
    def limits(self):
        """What registers hold. Source: NV_register_combiners for a range of one; Assumed: wider ones."""
        high = int(self.range * (self.one + 1)) - 1
        return -high - (1 if self.clamp_low == -256 else 0), high


def nearest(n, one):
    """N/one to the nearest integer, halves up. Source: as fixed.divide_by_255."""
    return floor(Fraction(n, one) + Fraction(1, 2))


def converted(value, one, other):
    """A number of one width in another. Source: OpenGL 1.2.1 section 2.13.9 (to nearest)."""
    return value if one == other else floor(Fraction(value * other, one) + Fraction(1, 2))


def filtered(p, q, fraction, bits):
    """Two texels blended by a fraction of ``bits`` bits. Source: as fixed.lerp_q8."""
    return floor(Fraction(p * (2**bits - fraction) + q * fraction, 2**bits) + Fraction(1, 2))


def color(weights, corners, bits):
    """A colour's component from three vertices by weights that sum to 2^bits. Inferred: as with 8 bits."""
    total = sum(w * c for w, c in zip(weights, corners, strict=True))
    return floor(Fraction(total, 2**bits) + Fraction(1, 2))


def map_input(x, mapping, machine):
    """Source: NV_register_combiners table 4; without the clamp a mapping is its line alone."""
    one, (low, high) = machine.one, machine.limits
    expand = one + 1 if machine.expand_half == 128 else one
    if not machine.mapping:
        return {
            Mapping.UNSIGNED_IDENTITY: x,
            Mapping.UNSIGNED_INVERT: one - x,
            Mapping.EXPAND_NORMAL: 2 * x - expand,
            Mapping.EXPAND_NEGATE: expand - 2 * x,
            Mapping.HALF_BIAS_NORMAL: x - machine.half,
            Mapping.HALF_BIAS_NEGATE: machine.half - x,
            Mapping.SIGNED_IDENTITY: x,
            Mapping.SIGNED_NEGATE: -x,
        }[mapping]
    positive = max(0, x)
    return {
        Mapping.UNSIGNED_IDENTITY: positive,
        Mapping.UNSIGNED_INVERT: one - min(positive, one),
        Mapping.EXPAND_NORMAL: 2 * positive - expand,
        Mapping.EXPAND_NEGATE: min(high, expand - 2 * positive),
        Mapping.HALF_BIAS_NORMAL: positive - machine.half,
        Mapping.HALF_BIAS_NEGATE: machine.half - positive,
        Mapping.SIGNED_IDENTITY: x,
        Mapping.SIGNED_NEGATE: fixed.clamp(-x, low, high),
    }[mapping]


def scale_rounded(x, scale):
    """Source: as combine.scale_rounded."""
    return {
        CombinerScale.NONE: x,
        CombinerScale.SCALE_BY_TWO: 2 * x,
        CombinerScale.SCALE_BY_FOUR: 4 * x,
        CombinerScale.SCALE_BY_ONE_HALF: floor(Fraction(x + 1, 2)),
    }[scale]


def finished(total, scale, bias, machine):
    """Bias, scale and clamp of a rounded value. Source: as combine.combiner_output."""
    half = machine.half if bias == CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0
    low, high = machine.limits if machine.general_combiner else (-FAR_REGISTER, FAR_REGISTER)
    return fixed.clamp(scale_rounded(total - half, scale), low, high)


def combiner_output(products, scale, bias, machine):
    """Source: as combine.combiner_output."""
    one = machine.one
    if machine.product_rounding == ProductRounding.PER_PRODUCT:
        return finished(sum(nearest(n, one) for n in products), scale, bias, machine)
    if machine.round_before_scale:
        return finished(nearest(sum(products), one), scale, bias, machine)
    factor = {
        CombinerScale.NONE: Fraction(1),
        CombinerScale.SCALE_BY_TWO: Fraction(2),
        CombinerScale.SCALE_BY_FOUR: Fraction(4),
        CombinerScale.SCALE_BY_ONE_HALF: Fraction(1, 2),
    }[scale]
    total = floor(factor * sum(products) / one + Fraction(1, 2))
    half = machine.half if bias == CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0
    total -= 2 * half if scale == CombinerScale.SCALE_BY_TWO else half
    low, high = machine.limits if machine.general_combiner else (-FAR_REGISTER, FAR_REGISTER)
    return fixed.clamp(total, low, high)


def mux_takes_cd(spare0_alpha, select, machine):
    """Source: as combine.mux_takes_cd."""
    alpha = fixed.clamp(spare0_alpha, 0, machine.one)
    return alpha >= machine.half if select == MuxSelect.MSB else alpha % 2 == 1


def final_component(a, b, c, d, machine):
    """Red, green or blue of the final combiner's mapped inputs. Source: as combine.final_combiner."""
    a = min(machine.one, a)
    value = nearest(a * b + (machine.one - a) * c, machine.one) + d
    return fixed.clamp(value, 0, machine.one) if machine.final_combiner else value


def blend_component(equation, s, d, source_factor, destination_factor, bits, *, clamps=True):
    """Source: as per_fragment.blend_component; a signed source has its sign in the highest bit."""
    one = 2**bits - 1
    signed = s - 2**bits if s >= 2 ** (bits - 1) else s
    value = {
        BlendEquation.MIN: lambda: min(s, d),
        BlendEquation.MAX: lambda: max(s, d),
        BlendEquation.FUNC_ADD_SIGNED: lambda: d + signed,
        BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED: lambda: d - signed,
        BlendEquation.FUNC_ADD: lambda: nearest(s * source_factor + d * destination_factor, one),
        BlendEquation.FUNC_SUBTRACT: lambda: nearest(s * source_factor - d * destination_factor, one),
        BlendEquation.FUNC_REVERSE_SUBTRACT: lambda: nearest(d * destination_factor - s * source_factor, one),
    }[equation]()
    return fixed.clamp(value, *((0, one) if clamps else (-FAR_COLOR, FAR_COLOR)))


def blend_factor(factor, k, source, destination, constant, one):
    """Source: as per_fragment.blend_factor, whose one is 255 alone."""
    if one == per_fragment.ONE:
        return per_fragment.blend_factor(factor, k, source, destination, constant)
    name = factor.name
    if name in ("ZERO", "ONE"):
        return one if name == "ONE" else 0
    if name == "SRC_ALPHA_SATURATE":
        return one if k == 3 else min(source[3], one - destination[3])
    of = {"SRC": source, "DST": destination, "CONSTANT": constant}
    who, what = name.removeprefix("ONE_MINUS_").split("_")
    value = of[who][3 if what == "ALPHA" else k]
    return one - value if name.startswith("ONE_MINUS_") else value
