"""Exact arithmetic on the machine's inputs: the column engine's own functions, in real numbers without
clamps.

The constants are the machine's or the exact ones. For example, EXPAND_NORMAL exactly subtracts 1/2; the
machine subtracts 128/255.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.columns.combiners import final_inputs, portion_products, sum_of_portion
from fixedpipe.pipeline.programs.texture_shader_rules import CONVENTIONAL
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import combine, numbers, per_fragment, real_texture_shader


def _exact(a, constants=True):
    """The machine's Arithmetic in real numbers, without clamps. ``constants``: with exact constants."""
    found = replace(combine.unclamped(combine.in_reals(a)), holds=(-np.inf, np.inf))
    return found if constants else replace(found, half=a.half, expanded=a.expanded)


def _output(register, portion, ab, cd, select, spare0, a):
    """What a portion writes to a register, from its products."""
    pairs = {portion.ab_output: ab, portion.cd_output: cd}
    if register in pairs:
        return combine.output(pairs[register], portion.scale, bool(portion.bias), a)
    return sum_of_portion(portion, ab, cd, select, spare0, a)


def unclamped(register, *, portion, ab, cd, select, spare0, arithmetic, **_):
    """An output without its clamp, int64, from what the observer received of its portion."""
    return _output(register, portion, ab, cd, select, spare0, combine.unclamped(arithmetic))


def portion_output(register, exact, *, portion, read, alpha, select, spare0, arithmetic, **_):
    """An output in real numbers, float64, from what the observer received of its portion.

    ``exact``: with exact constants, such as EXPAND_NORMAL's 1/2.
    """
    wide = _exact(arithmetic, exact)
    _, ab, cd = portion_products(portion, read, alpha, wide)
    return _output(register, portion, ab, cd, select, spare0, wide) / wide.one


def final_color(final, registers, a):
    """The final combiner's colour from registers, in real numbers: float64 [4, k]."""
    wide, count = _exact(a), next(iter(registers.values())).shape[1]
    return combine.final_color(*final_inputs(final, registers, count, wide), wide) / wide.one


def texture(sampler, fragments, ideal, bits):
    """A unit's register, computed three ways, float64 [4] each. None: one of them is not known.

    The ways are: the machine's texels with the machine's fractions, not rounded; the machine's texels with
    exact fractions; real texels with exact fractions.

    ``ideal``: the texture's real texels, one array a level, or None. ``bits``: the register's width.
    """
    found = []
    for fraction_bits, levels in ((sampler.fraction_bits, None), (None, None), (None, ideal)):
        unit = sampler.exactly(fraction_bits, levels)
        if unit is None:
            return None
        found.append(unit.register(fragments, bits)[:, 0] / numbers.one_of(bits))
    return found


def shader_texture(run, i, ideal, bits):
    """The result of stage i of a texture shader, computed four ways, float64 [4] each. None: one is not
    known.

    Every way reads the texels that the machine's earlier stages left. The first three are those of
    ``texture``. The fourth takes real texels at exactly computed coordinates.

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
    """The result of blending source, destination and constant, given in units of ``bits``: float64 [k, 4]."""
    factors = blending.source, blending.destination
    found = per_fragment.blend(blending.equation, factors, *colors, bits, numbers.REALS)
    return found / numbers.one_of(bits)
