"""Fragments' colours in the column engine: texture units, combiners, color sum and fog."""

import numpy as np

from fixedpipe.pipeline.columns.combiners import (
    Registers,
    arithmetic_of,
    combine,
    filled,
    without_combiners,
    ycbcr_converted,
)
from fixedpipe.pipeline.columns.textures import LAMBDA_BITS
from fixedpipe.pipeline.enums import FogArithmetic, FogMode, Register, TextureTarget
from fixedpipe.pipeline.programs.combiner_rules import has_color_sum
from fixedpipe.pipeline.programs.fog import fog_thresholds
from fixedpipe.pipeline.programs.future import units_along
from fixedpipe.pipeline.programs.texture_environment import environment_program
from fixedpipe.pipeline.programs.texture_shader_rules import reads_texture
from fixedpipe.pipeline.vertices.fog import folds, table
from fixedpipe.raster.columns import numbers
from fixedpipe.raster.observer import unobserved


def columns_of(colors):
    """Colours [k, 4] as a register [4, k]; int64 and real numbers stay what they are."""
    return colors.T if colors.dtype == np.float64 else colors.T.astype(np.int64)


def _fog_register(fog, coordinates, profile, count, one):
    """The FOG register, int64 [4, count]."""
    if fog is None:
        return filled((0, 0, 0, one), count)
    color = numbers.fixed(fog.color, one)[:3]
    if profile.arithmetic.fog_arithmetic == FogArithmetic.TABLE:
        at = np.clip(np.floor(coordinates * 4096.0), 0.0, 8192.0)
        factor = table(fog.mode, folds(fog))[np.where(np.isnan(at), 0.0, at).astype(np.int64)].astype(
            np.int64
        )
        factor = numbers.convert(factor, 255, one)
    else:
        rising = fog.mode == FogMode.LINEAR and fog.start > fog.end
        factor = numbers.fog_factor(coordinates, fog_thresholds(fog, one), rising)
    return np.concatenate([filled(color, count), factor[None]])


def shade(fragments, state, profile, bits, textures, samplers, made, *, observe=unobserved, replaced=None):
    """Shade fragments: texture units, combiners, color sum, fog. Colours [k, 4] in units of ``bits``.

    made      the registers of texture units that a texture shader made, by the unit's number
    observe   the observer
    replaced  a ReplacedStages

    The colours are int64, or float64 where a stage computes in reals.
    """
    if state.evaluate_before_filtering:
        return _shade_before_filtering(fragments, state, profile, bits, textures, samplers, made, observe)
    return _shade(fragments, state, profile, bits, textures, samplers, made, None, observe, replaced)


def _shade_before_filtering(fragments, state, profile, bits, textures, samplers, made, observe):
    """The colours at each texel that unit 0's filter reads, then filtered (section 20)."""
    along, first = units_along(state, textures), samplers[0]
    columns = (0, 1) if first.linear else (0,)
    rows = (0,) if first.texture.target == TextureTarget.TEXTURE_1D else columns
    layers = columns if first.texture.target == TextureTarget.TEXTURE_3D else (0,)

    def mixed(parts, fraction, width):
        return parts[0] if len(parts) == 1 else numbers.lerp(*parts, fraction[:, None], width)

    def color(*tap):
        taps = dict.fromkeys(along, tap)
        return _shade(fragments, state, profile, bits, textures, samplers, made, taps, observe)

    levels, width = [], profile.arithmetic.filter_fraction_bits
    for level in (0, 1) if first.between_levels else (0,):
        across, up, deep, between = first.fractions(fragments, level).T
        planes = [
            mixed([mixed([color(level, k, j, i) for i in columns], across, width) for j in rows], up, width)
            for k in layers
        ]
        levels.append(mixed(planes, deep, width))
    return mixed(levels, between, LAMBDA_BITS)


def _shade(fragments, state, profile, bits, textures, samplers, made, taps, observe, replaced=None):
    count, one = len(fragments.x), numbers.one_of(bits)
    ycbcr = ()
    if state.ycbcr_conversion:
        ycbcr = tuple(i for i in range(len(state.texture_units)) if reads_texture(state, i))
        made = {unit: ycbcr_converted(r) if unit in ycbcr else r for unit, r in made.items()}
    registers = Registers(samplers, fragments, bits, taps, ycbcr)
    registers.update({Register.TEXTURE0 + unit: register for unit, register in made.items()})
    registers[Register.PRIMARY_COLOR] = columns_of(fragments.primary)
    registers[Register.SECONDARY_COLOR] = columns_of(fragments.secondary)
    registers[Register.FOG] = _fog_register(state.fog, fragments.fog, profile, count, one)
    program, environments = state.register_combiners, state.register_combiners is None
    if environments:
        program = environment_program(state, textures, profile, has_color_sum(state))
    a = arithmetic_of(profile, bits, environments)
    observe("program", program=program, environments=environments)
    if program is None:
        own = a if replaced is None else replaced.arithmetic(a, "final combiner")
        return without_combiners(state, registers, count, own, observe).T
    registers[Register.SPARE1] = filled((0, 0, 0, 0), count)
    nothing = np.zeros((3, count), np.int64)
    registers[Register.SPARE0] = np.concatenate([nothing, registers[Register.TEXTURE0][3:]])
    return combine(program, registers, count, a, observe, replaced).T
