"""Fog as the NV2A computes it: a line for each vertex, and a table for each pixel.

docs/numbers.md section 9 fixes every operation. ``fixedpipe.pipeline.programs.fog`` has the rule of machines
with ROUNDED fog arithmetic.
"""

from decimal import Decimal, localcontext
from functools import lru_cache

import numpy as np

from fixedpipe.pipeline.enums import FogArithmetic, FogCoordinateSource, FogGeneration, FogMode, VertexStage
from fixedpipe.pipeline.vertices.arithmetic import ZERO, columns_of, weighted_sum
from fixedpipe.pipeline.vertices.chip_floats import (
    LIGHTING_BITS,
    TRANSFORM_BITS,
    product,
    single,
    to_lighting,
    total,
    transform_dot,
    transform_inverse_root,
)

LN_256 = 5.545177444479562  # Source: the natural logarithm, rounded to float64
TABLE_SIZE = 8193  # entries of ``table``
_NODES, _STEPS = 32, 64  # Measured: straight lines between 32 nodes of 64 steps of 1/4096 (Fog captures)
_LINEAR_STEPS = np.float64(2**21)  # in one unit of a LINEAR value
_NO_LENGTH = 2.0**-24  # replaces end - start = 0. Assumed: as steep as single precision can tell
_LARGEST = np.float64(2.0**127)  # replaces an infinite vertex value. Assumed: any large number


def line(fog):
    """(bias, multiplier) of a Fog: its registers', or what a driver makes of OpenGL's parameters.

    Both are in single precision. Those of the exponential modes are rounded as they enter the lighting unit.
    """
    if fog.registers is not None:
        bias, multiplier = fog.registers.bias, fog.registers.multiplier
    elif fog.mode == FogMode.LINEAR:
        multiplier = -1.0 / (fog.end - fog.start or _NO_LENGTH)
        bias = 1.0 - fog.end * multiplier
    else:
        range_of_table = LN_256 if fog.mode == FogMode.EXP else float(np.sqrt(LN_256))
        bias, multiplier = 1.5, -fog.density / (2.0 * range_of_table)
    entered = single if fog.mode == FogMode.LINEAR else to_lighting
    return entered(bias), entered(multiplier)


def vertex_value(fog, coordinate):
    """The value that is iterated: coordinate * multiplier + bias, float64 columns in and out.

    The coordinate enters the lighting unit. LINEAR fog's product keeps 24 bits, and its sum is rounded up to
    21 fraction bits. The other modes' product and sum keep the lighting unit's bits. Infinity and NaN become
    the largest number. Infinite products are positive, and 0 times infinity is 0, except in LINEAR fog.

    Measured: 9320 of 9320 squares of Fog_param; the rounding up: the pixels of Fog, Fog_vsh and Fog_gen that
    lie within 1e-3 of a step.
    """
    bias, multiplier = line(fog)
    entered = to_lighting(coordinate)
    if fog.mode == FogMode.LINEAR:
        scaled = np.where(np.isfinite(entered), product(entered, multiplier, TRANSFORM_BITS), np.inf)
        value = (np.ceil((scaled + bias) * _LINEAR_STEPS) + ZERO) / _LINEAR_STEPS  # its zero is positive
    else:
        value = total((product(entered, multiplier, LIGHTING_BITS), bias), LIGHTING_BITS)
    return np.where(np.isnan(value), _LARGEST, np.fmax(np.fmin(value, _LARGEST), -_LARGEST))


def folds(fog):
    """Whether EXP or EXP2 fog treats a value above 3/2 as the value equally far below it.

    EXP2 does, because its square has no sign. EXP of a magnitude does, because the chip takes the magnitude
    here, and not of the coordinate. Measured: Fog_param.
    """
    absolute = fog.registers is not None and fog.registers.absolute
    return fog.mode == FogMode.EXP2 or (fog.mode == FogMode.EXP and absolute)


@lru_cache(maxsize=8)
def table(mode, folded):
    """float64 [TABLE_SIZE]: the factor's byte for n = floor(4096 v), 0 <= n <= 8192, of an iterated value v.

    ``folded`` is the result of ``folds``. Measured: LINEAR 374 of 374 squares (FogGen_VS-linear-fog_x), EXP
    and EXP2 91557 of 91557 pixels (Fog, Fog_vsh captures).
    """
    n = np.arange(TABLE_SIZE)
    if mode == FogMode.LINEAR:
        factor = np.clip(n - 4095, 0, 4096)
        out = np.minimum(factor * 255 >> 12, 255)
    else:
        steps = np.abs(6144 - n) if folded else 6144 - n
        x = np.clip(steps, 0, _NODES * _STEPS - 1)
        nodes = np.array(_nodes(mode))
        node, step = x // _STEPS, x % _STEPS
        out = (nodes[node] * (_STEPS - step) + nodes[node + 1] * step + _STEPS // 2) // _STEPS
        out[steps >= _NODES * _STEPS] = 0
    out = out.astype(np.float64)
    out.setflags(write=False)
    return out


def _nodes(mode):
    """255 * 2^(-16 x), or 255 * 2^(-32 x^2), at x = j/64, j = 0 to 32, rounded to nearest."""
    with localcontext() as context:
        context.prec = 40
        power = [Decimal(j) / 4 if mode == FogMode.EXP else Decimal(j * j) / 128 for j in range(_NODES + 1)]
        return [int(255 * Decimal(2) ** -p + Decimal("0.5")) for p in power]


def iterated_fog(mesh, state, eye, profile):
    """The column that is iterated for fog: the coordinate, or the value that the machine computes from it."""
    if state.fog is None:
        return ZERO
    coordinate = _fog_coordinate(mesh, state, eye)
    return (
        vertex_value(state.fog, coordinate)
        if profile.arithmetic.fog_arithmetic == FogArithmetic.TABLE
        else coordinate
    )


def _fog_coordinate(mesh, state, eye):
    fog, registers = state.fog, state.fog.registers
    own = ZERO if mesh.fog_coordinates is None else mesh.fog_coordinates
    if registers is None:
        return np.abs(eye[2]) if fog.coordinate_source == FogCoordinateSource.FRAGMENT_DEPTH else own
    programmed = state.vertex.stage == VertexStage.PROGRAM_RESULTS
    generation = FogGeneration.FOG_COORDINATE if programmed else registers.generation
    if generation == FogGeneration.FOG_COORDINATE:
        coordinate = own
    elif generation == FogGeneration.SECONDARY_ALPHA:
        coordinate = columns_of(mesh.secondary_colors, (0.0, 0.0, 0.0, 0.0))[3]
    elif generation == FogGeneration.RADIAL:
        position = [single(component) for component in eye[:3]]
        squared = transform_dot(position, position)
        coordinate = product(squared, transform_inverse_root(squared), TRANSFORM_BITS)
    elif generation in (FogGeneration.PLANAR, FogGeneration.ABSOLUTE_PLANAR):
        coordinate = weighted_sum(registers.plane, eye)
    else:
        raise ValueError(f"{generation!r} is no way to make fog coordinates.")
    absolute = registers.absolute and not folds(fog)
    return np.abs(coordinate) if absolute or generation == FogGeneration.ABSOLUTE_PLANAR else coordinate
