"""Register combiners and texture environments in the column engine (docs/numbers.md, sections 8, 13, 20)."""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.enums import (
    Clamp,
    ComponentUsage,
    Mapping,
    Meaning,
    MuxSelect,
    ProductRounding,
    Register,
)
from fixedpipe.pipeline.programs.combiner_rules import has_color_sum
from fixedpipe.pipeline.textures.words import ycbcr_to_rgb
from fixedpipe.raster.columns import combine as arithmetic
from fixedpipe.raster.columns import future, numbers
from fixedpipe.raster.observer import unobserved


def arithmetic_of(profile, bits, environments=False):
    """The combiners' Arithmetic at ``bits``.

    ``environments``: the program stands for texture environments. Then the clamps of each output and of the
    next mapping limit every result to [0, 1].
    """
    clamps, limit = profile.arithmetic.clamps, 1.0 if environments else profile.arithmetic.combiner_range
    one, far = numbers.one_of(bits), arithmetic.FAR
    high = int(limit * (one + 1)) - 1
    low = -high - (1 if profile.arithmetic.clamp_low == -256 else 0)
    bounded = (Clamp.TEXTURE_ENVIRONMENT if environments else Clamp.GENERAL_COMBINER) in clamps
    mapping = (Clamp.TEXTURE_ENVIRONMENT if environments else Clamp.MAPPING) in clamps
    return arithmetic.Arithmetic(
        one=one,
        half=1 << (bits - 1),
        low=low if bounded else -far,
        high=high if bounded else far,
        expanded=one + 1 if profile.arithmetic.expand_half == 128 else one,
        per_product=profile.arithmetic.product_rounding == ProductRounding.PER_PRODUCT,
        round_first=profile.arithmetic.round_before_scale,
        clamps_mapping=mapping,
        clamps_sum=Clamp.COLOR_SUM in clamps,
        clamps_final=Clamp.FINAL_COMBINER in clamps,
        holds=(low, high),
    )


class Registers(dict):
    """The registers of k fragments: int64 [4, k] each, or float64 where a stage computed with reals.

    A texture's register is sampled on its first read. ``ycbcr``: the units whose texels are Y, Cb and Cr.
    """

    def __init__(self, samplers, fragments, bits, taps=None, ycbcr=()):
        super().__init__()
        self._ycbcr = ycbcr
        self._samplers, self._fragments, self._bits = samplers, fragments, bits
        self._taps = taps or {}  # for each unit that is read before it is filtered, the texel to read

    def look_up(self, lookup):
        """A dependent lookup: a unit's register receives the texel at another register's red,
        green and blue.
        """
        strq = np.ones((len(self._fragments.x), 4))
        strq[:, :3] = self[lookup.register][:3].T / float(numbers.one_of(self._bits))
        texel = self._samplers[lookup.unit].looked_up(strq, self._fragments, self._bits)
        self[Register.TEXTURE0 + lookup.unit] = texel

    def __missing__(self, register):
        count, unit = len(self._fragments.x), register - Register.TEXTURE0
        if not 0 <= unit < 4:
            raise KeyError(register)
        if unit < len(self._samplers) and self._samplers[unit] is not None:
            found = self._samplers[unit].register(self._fragments, self._bits, self._taps.get(unit))
            self[register] = ycbcr_converted(found) if unit in self._ycbcr else found
        else:  # Measured: a disabled unit's register is (0, 0, 0, 1)
            self[register] = filled((0, 0, 0, numbers.one_of(self._bits)), count)
        return self[register]


def ycbcr_converted(register):
    """R, G, B and alpha from a register [4, k] of bytes Y, Cb, Cr and alpha.

    The conversion takes bytes, so it rounds real numbers first. Assumed: it takes a negative number as 0.

    Measured: 1213620 of 1213620 pixels (BumpMap_UYVY_L and three captures like it).
    """
    bytes_ = np.floor(np.maximum(register[:3], 0) + 0.5).astype(np.int64)
    return np.stack([*ycbcr_to_rgb(*bytes_), register[3]])


def filled(values, count):
    """Constant components as columns [c, count]: int64 if they are whole numbers."""
    return np.repeat(np.asarray(values)[:, None], count, axis=1)


def read_components(registers, variable, alpha):
    """A variable's register components: [3, k] in an RGB portion, [1, k] in an alpha portion."""
    register = registers[variable.register]
    if variable.usage == ComponentUsage.RGB and not alpha:
        return register[:3]
    return register[2:3] if variable.usage == ComponentUsage.BLUE else register[3:4]


def _mapped(x, variable, a):
    """A variable's components after its mapping. Real numbers are mapped as the program means it."""
    if a.numbers.rounds or variable.meaning is Meaning.PLAIN:
        return arithmetic.map_input(x, variable.mapping, a)
    if variable.meaning is Meaning.SATURATED:
        return arithmetic.map_input(np.minimum(x, a.one), variable.mapping, a)
    stored = replace(a, half=a.one * (128 / 255), expanded=a.one * (256 / 255))  # SIGNED_CONSTANT
    return arithmetic.map_input(x, variable.mapping, stored)


def portion_products(portion, read, alpha, a):
    """A portion's four mapped variables and its products AB and CD.

    Each product is a list of terms: three for a dot product, one otherwise. ``read``: the variables' register
    components.
    """
    variables = portion.a, portion.b, portion.c, portion.d
    mapped = [_mapped(x, v, a) for x, v in zip(read, variables, strict=True)]
    shape = 1 if alpha else 3, mapped[0].shape[1]
    ab, cd = ([np.broadcast_to(mapped[i] * mapped[i + 1], shape)] for i in (0, 2))
    if not alpha:
        ab = arithmetic.sum_of_three(ab) if portion.ab_dot_product else ab
        cd = arithmetic.sum_of_three(cd) if portion.cd_dot_product else cd
    return mapped, ab, cd


def sum_of_portion(portion, ab, cd, select, spare0, a, observe=unobserved):
    """The value of a portion's sum output: the sum of its products, a function of them, or a mux's choice.

    ``spare0``: SPARE0's alpha, by which the mux chooses.
    """
    biased = bool(portion.bias)
    if portion.function:
        sums = [sum(products) for products in (ab, cd)]
        made = future.applied(portion.function, *sums, a.one, a.high, a.numbers)
        return arithmetic.function_output(made, portion.scale, biased, a)
    if portion.mux_sum:
        chosen = arithmetic.takes_cd(spare0, select == MuxSelect.LSB, a)
        observe("mux", takes_cd=chosen, spare0=spare0)
        pair = [arithmetic.output(products, portion.scale, biased, a) for products in (ab, cd)]
        return np.where(chosen, pair[1], pair[0])
    products = [*ab, *cd] if a.numbers.rounds else [sum(ab), sum(cd)]
    return arithmetic.output(products, portion.scale, biased, a)


def _portion(portion, registers, alpha, select, a, observe):
    """(register, value [3 or 1, k]) for each output that the portion keeps."""
    outputs = portion.ab_output, portion.cd_output, portion.sum_output
    if all(output == Register.DISCARD for output in outputs):
        return []
    read = [read_components(registers, v, alpha) for v in (portion.a, portion.b, portion.c, portion.d)]
    mapped, ab, cd = portion_products(portion, read, alpha, a)
    spare0 = registers[Register.SPARE0][3]
    observe(
        "portion", alpha=alpha, portion=portion, read=read, mapped=mapped, ab=ab, cd=cd, select=select,
        spare0=spare0, arithmetic=a,
    )  # fmt: skip
    values = []
    for output, products in zip(outputs[:2], (ab, cd), strict=True):
        if output != Register.DISCARD:
            values.append((output, arithmetic.output(products, portion.scale, bool(portion.bias), a)))
    if outputs[2] != Register.DISCARD:
        values.append((outputs[2], sum_of_portion(portion, ab, cd, select, spare0, a, observe)))
    observe("outputs", alpha=alpha, values=values)
    return values


def combine(program, registers, count, a, observe=unobserved, replaced=None):
    """Run a combiner program (section 8): the fragments' colours, [4, count].

    The colours are int64, or float64 where a stage computed with reals. ``observe``: the observer;
    ``replaced``: a ReplacedStages.
    """

    def arithmetic_at(stage):
        return a if replaced is None else replaced.arithmetic(a, stage)

    def constant(color):
        of = arithmetic_at("constant colors")
        return filled(of.numbers.fixed(color, of.one), count)

    program_constants = {
        register: constant(color)
        for register, color in zip(
            _CONSTANTS, (program.constant_color0, program.constant_color1), strict=True
        )
    }
    registers[Register.ZERO] = filled((0, 0, 0, 0), count)
    for number, stage in enumerate(program.general):
        registers.update(program_constants)
        for register, color in zip(_CONSTANTS, (stage.constant_color0, stage.constant_color1), strict=True):
            if color is not None:
                registers[register] = constant(color)
        observe("general combiner", number=number, stage=stage, registers=registers)
        own = arithmetic_at(f"general combiner {number}")
        rgb = _portion(stage.rgb, registers, False, program.mux_select, own, observe)
        alpha = _portion(stage.alpha, registers, True, program.mux_select, own, observe)
        for to, value in rgb:
            registers[to] = np.concatenate([value, registers[to][3:]])
        for to, value in alpha:
            registers[to] = np.concatenate([registers[to][:3], value])
        for to, blue in (
            (stage.rgb.ab_output, stage.rgb.ab_blue_to_alpha),
            (stage.rgb.cd_output, stage.rgb.cd_blue_to_alpha),
        ):
            if blue and to != Register.DISCARD:
                registers[to] = registers[to][[0, 1, 2, 2]]
        if stage.lookup is not None:
            registers.look_up(stage.lookup)
        observe("combined", number=number, registers=registers)
    registers.update(program_constants)
    return _final(program, registers, count, arithmetic_at("final combiner"), observe)


_CONSTANTS = (Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1)


def final_inputs(final, registers, count, a):
    """The final combiner's mapped inputs: A to D, [3, count] each, and G, [1, count]."""
    colors = [_final_input(v, registers, a) for v in (final.a, final.b, final.c, final.d)]
    return *(np.broadcast_to(c, (3, count)) for c in colors), _final_input(final.g, registers, a, alpha=True)


def _final_input(variable, registers, a, alpha=False):
    read = read_components(registers, variable, alpha)
    return arithmetic.map_final(read, variable.mapping == Mapping.UNSIGNED_INVERT, a)


def _final(program, registers, count, a, observe):
    final, nothing = program.final, np.zeros((1, count), np.int64)
    used = {v.register for v in (final.a, final.b, final.c, final.d, final.g)}
    if Register.E_TIMES_F in used:
        e, f = (_final_input(v, registers, a) for v in (final.e, final.f))
        product = arithmetic.product(e * f, a)
        observe(
            "E times F",
            read=[read_components(registers, v, False) for v in (final.e, final.f)],
            product=product,
        )
        registers[Register.E_TIMES_F] = np.concatenate([np.broadcast_to(product, (3, count)), nothing])
    if Register.SPARE0_PLUS_SECONDARY_COLOR in used:
        terms = ((Register.SPARE0, program.invert_spare0),)
        terms += ((Register.SECONDARY_COLOR, program.invert_secondary_color),)
        total = sum(arithmetic.map_final(registers[r][:3], invert, a) for r, invert in terms)
        whole = total
        if program.color_sum_clamp and a.clamps_sum:
            total = np.minimum(total, a.one)
        observe("color sum", whole=whole, total=total)
        registers[Register.SPARE0_PLUS_SECONDARY_COLOR] = np.concatenate([total, nothing])
    mapped = final_inputs(final, registers, count, a)
    color = arithmetic.final_color(*mapped, a)
    observe("final combiner", final=final, registers=registers, mapped=mapped, color=color, arithmetic=a)
    return color


def without_combiners(state, registers, count, a, observe=unobserved):
    """The primary colour after color sum and fog (sections 3.9, 3.10): int64 [4, count]."""
    primary = registers[Register.PRIMARY_COLOR]
    rgb = primary[:3]
    if has_color_sum(state):
        whole = rgb + registers[Register.SECONDARY_COLOR][:3]
        rgb = np.minimum(whole, a.one) if a.clamps_sum else whole
        observe("color sum", whole=whole, total=rgb)
    if state.fog is not None:
        fog = registers[Register.FOG]
        before, rgb = rgb, numbers.with_fog(rgb, fog[:3], fog[3], a.one, a.numbers)
        observe("fog", before=before, fog=fog, color=rgb)
    color = np.concatenate([rgb, primary[3:]])
    return np.clip(color, 0, a.one) if a.clamps_final else color
