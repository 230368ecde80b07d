"""What exact arithmetic makes of the numbers that the machine read: the column engine's own functions, on
numbers with so many more bits that rounding does not show, and without clamps.

With the machine's constants, or with the exact ones: EXPAND_NORMAL takes 1/2 away, not 128/255.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.columns.combiners import read_components
from fixedpipe.pipeline.enums import Mapping
from fixedpipe.raster.columns import combine, numbers, per_fragment

_FAR = 1 << 40  # beyond what any output of wide numbers reaches
_FRACTION_BITS = 20
WIDE_BITS = 24  # whose one is a multiple of those of 4, 6, 8 and 12 bits


def _widened(a, exact):
    """An Arithmetic of the machine's, with more bits and no clamps, and by how much wider it is."""
    shift = WIDE_BITS - a.one.bit_length()
    one = a.one << shift
    return shift, replace(
        a,
        one=one,
        half=one >> 1 if exact else a.half << shift,
        expanded=one if exact else a.expanded << shift,
        low=-_FAR,
        high=_FAR,
        holds=(-_FAR, _FAR),
        per_product=False,
        round_first=False,
        clamps_final=False,
        clamps_sum=False,
    )


def unclamped(register, portion, ab, cd, a):
    """What an output would be if nothing clamped it, int64; None where a mux or a function makes it.

    ``ab``, ``cd``: the portion's products, as the engine tells them.
    """
    pairs = {portion.ab_output: ab, portion.cd_output: cd}
    if register not in pairs and (portion.function or portion.mux_sum):
        return None
    free = replace(a, low=-combine.FAR, high=combine.FAR)
    return combine.output(pairs.get(register, [*ab, *cd]), portion.scale, bool(portion.bias), free)


def portion_output(register, portion, read, alpha, a, exact):
    """An output of a portion from its four variables' register components, float64; None where a mux or a
    function makes it.
    """
    pairs = {portion.ab_output: 0, portion.cd_output: 1}
    if register not in pairs and (portion.function or portion.mux_sum):
        return None
    shift, wide = _widened(a, exact)
    variables = portion.a, portion.b, portion.c, portion.d
    mapped = [combine.map_input(x << shift, v.mapping, wide) for x, v in zip(read, variables, strict=True)]
    shape = 1 if alpha else 3, mapped[0].shape[1]
    ab, cd = ([np.broadcast_to(mapped[i] * mapped[i + 1], shape)] for i in (0, 2))
    if not alpha:
        ab = combine.sum_of_three(ab) if portion.ab_dot_product else ab
        cd = combine.sum_of_three(cd) if portion.cd_dot_product else cd
    products = (ab, cd)[pairs[register]] if register in pairs else [*ab, *cd]
    return combine.output(products, portion.scale, bool(portion.bias), wide) / wide.one


def final_color(final, registers, a):
    """The final combiner's colour from registers, float64 [4, k]."""
    shift, wide = _widened(a, True)

    def value(variable, alpha=False):
        read = read_components(registers, variable, alpha)
        return combine.map_final(read << shift, variable.mapping == Mapping.UNSIGNED_INVERT, wide)

    count = next(iter(registers.values())).shape[1]
    inputs = [np.broadcast_to(value(v), (3, count)) for v in (final.a, final.b, final.c, final.d)]
    return combine.final_color(*inputs, value(final.g, alpha=True), wide) / wide.one


def texture(sampler, fragments, ideal):
    """What a unit filters, float64 [4] each: of the machine's texels by the machine's fractions, not rounded;
    by exact fractions; of real texels by exact fractions. None where that is not known.

    ``ideal``: the texture's real texels, a level each, or None.
    """
    found = []
    for fraction_bits, levels in (
        (sampler.fraction_bits, None),
        (_FRACTION_BITS, None),
        (_FRACTION_BITS, ideal),
    ):
        unit = sampler.exactly(fraction_bits, levels)
        if unit is None:
            return None
        texel = unit.filtered(fragments)[:, :4]
        found.append(texel[0] / unit.one)
    return found


def blended(blending, colors, bits):
    """What blending makes of source, destination and constant in units of ``bits``, float64 [k, 4]."""
    one, factors = numbers.one_of(WIDE_BITS), (blending.source, blending.destination)
    wide = [color * (one // numbers.one_of(bits)) for color in colors]
    return per_fragment.blend(blending.equation, factors, *wide, WIDE_BITS) / one
