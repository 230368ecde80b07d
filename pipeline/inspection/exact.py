"""What exact arithmetic makes of the numbers that the machine read: the column engine's own functions, in
real numbers and without clamps.

With the machine's constants, or with the exact ones: EXPAND_NORMAL takes 1/2 away, not 128/255.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.columns.combiners import final_inputs, portion_products, sum_of_portion
from fixedpipe.pipeline.programs.texture_shader_rules import CONVENTIONAL
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import combine, numbers, per_fragment, real_texture_shader


def _exact(a, constants=True):
    """An Arithmetic of the machine's in real numbers, without clamps; ``constants``: with exact ones."""
    found = replace(combine.unclamped(combine.in_reals(a)), holds=(-np.inf, np.inf))
    return found if constants else replace(found, half=a.half, expanded=a.expanded)


def _output(register, portion, ab, cd, select, spare0, a):
    """What a portion writes to a register, of its products."""
    pairs = {portion.ab_output: ab, portion.cd_output: cd}
    if register in pairs:
        return combine.output(pairs[register], portion.scale, bool(portion.bias), a)
    return sum_of_portion(portion, ab, cd, select, spare0, a)


def unclamped(register, *, portion, ab, cd, select, spare0, arithmetic, **_):
    """What an output would be if nothing clamped it, int64; of what the engine tells of its portion."""
    return _output(register, portion, ab, cd, select, spare0, combine.unclamped(arithmetic))


def portion_output(register, exact, *, portion, read, alpha, select, spare0, arithmetic, **_):
    """An output in real numbers, float64, of what the engine tells of its portion; ``exact``: with one half
    where EXPAND_NORMAL means it.
    """
    wide = _exact(arithmetic, exact)
    _, ab, cd = portion_products(portion, read, alpha, wide)
    return _output(register, portion, ab, cd, select, spare0, wide) / wide.one


def final_color(final, registers, a):
    """The final combiner's colour from registers, float64 [4, k]."""
    wide, count = _exact(a), next(iter(registers.values())).shape[1]
    return combine.final_color(*final_inputs(final, registers, count, wide), wide) / wide.one


def texture(sampler, fragments, ideal, bits):
    """What a unit's register receives, float64 [4] each: of the machine's texels by the machine's fractions,
    not rounded; by exact fractions; of real texels by exact fractions. None where that is not known.

    ``ideal``: the texture's real texels, a level each, or None; ``bits``: of the register.
    """
    found = []
    for fraction_bits, levels in ((sampler.fraction_bits, None), (None, None), (None, ideal)):
        unit = sampler.exactly(fraction_bits, levels)
        if unit is None:
            return None
        found.append(unit.register(fragments, bits)[:, 0] / numbers.one_of(bits))
    return found


def shader_texture(run, i, ideal, bits):
    """What stage i of a texture shader makes of the texels that the machine's stages before it left: as
    ``texture``, and last of real texels at coordinates that are computed exactly. Float64 [4] each; None
    where that is not known.

    ``run``: the machine's StageRun. A footprint of roughness is the machine's.
    """
    stage, unit, found = run.stages[i], run.units[i], []
    for fraction_bits, levels, exactly in (
        (unit.unit.fraction_bits, None, False),
        (None, None, False),
        (None, ideal, False),
        (None, ideal, True),
    ):
        sampler = unit.unit.exactly(fraction_bits, levels)
        if sampler is None:
            return None
        of = run.with_unit(i, sampler)
        if stage.operation in CONVENTIONAL:
            texel = of.texel(i)
        else:
            footprint = () if stage.roughness is None else of.footprint(i)
            texel = of.looked_up(i, (of.in_reals() if exactly else of).made(i), footprint)
        register = sampler.as_register(texel, unit.fragments, bits).T / numbers.one_of(bits)
        if stage.operation in C.OPERATIONS_WITH_SCALE:
            magnitude = of.in_reals().texels[stage.previous_texture_input][:, 0]
            factors = stage.offset_texture_scale, stage.offset_texture_bias, run.largest_scale
            texel = texel / unit.unit.one
            register = real_texture_shader.scaled(texel, unit.bits, magnitude, 0, *factors)
        found.append(register[0])
    return found


def blended(blending, colors, bits):
    """What blending makes of source, destination and constant in units of ``bits``, float64 [k, 4]."""
    factors = blending.source, blending.destination
    found = per_fragment.blend(blending.equation, factors, *colors, bits, numbers.REALS)
    return found / numbers.one_of(bits)
