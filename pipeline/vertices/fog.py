"""Fog as the NV2A computes it: a line for each vertex, and a table for each pixel.

docs/numbers.md section 9 fixes every operation. What machines with ROUNDED fog arithmetic do instead is in
``fixedpipe.pipeline.programs.fog``.
"""

from decimal import Decimal, localcontext
from functools import lru_cache

import numpy as np

from fixedpipe.pipeline.enums import FogArithmetic, FogCoordinateSource, FogGeneration, FogMode, VertexStage
from fixedpipe.pipeline.vertices.arithmetic import (
    ZERO,
    columns_of,
    length,
    weighted_sum,
)
from fixedpipe.pipeline.vertices.chip_floats import LIGHTING_BITS
from fixedpipe.raster.floats import SINGLE_BITS, keep_significant_bits

LN_256 = 5.545177444479562  # Source: the natural logarithm, rounded to float64
TABLE_SIZE = 8193  # entries of ``table``
_NODES, _STEPS = 32, 64  # Measured: straight lines between 32 nodes of 64 steps of 1/4096 (Fog captures)
_LARGEST = np.float64(2.0**127)  # what an infinite vertex value becomes. Assumed: any large number


def line(fog):
    """(bias, multiplier) of a Fog: its registers', or what a driver makes of OpenGL's parameters.

    Rounded to the bits that ``vertex_value`` keeps. Measured: the multiplier's 14 bits (to nearest, or 15
    truncated; 13, 14 truncated or 16 contradict a vertex of the Fog captures).
    """
    if fog.registers is not None:
        bias, multiplier = fog.registers.bias, fog.registers.multiplier
    elif fog.mode == FogMode.LINEAR:
        multiplier = -1.0 / (fog.end - fog.start)
        bias = 1.0 - fog.end * multiplier
    else:
        range_of_table = LN_256 if fog.mode == FogMode.EXP else float(np.sqrt(LN_256))
        bias, multiplier = 1.5, -fog.density / (2.0 * range_of_table)
    return tuple(_rounded(value, _bits(fog.mode)) for value in (bias, multiplier))


def _bits(mode):
    return SINGLE_BITS if mode == FogMode.LINEAR else LIGHTING_BITS


def _rounded(value, bits):
    """The nearest float64 of so many significant bits, ties to even."""
    mantissa, exponent = np.frexp(np.float64(value))
    return np.ldexp(np.rint(np.ldexp(mantissa, bits)), exponent - bits)


def vertex_value(fog, coordinate):
    """What is iterated: coordinate * multiplier + bias, float64 columns in and out.

    The coordinate, the product and the sum are truncated: to single precision for LINEAR fog, to 14
    significant bits for the others. Measured: 18 vertices of EXP and EXP2 fog, most to within 0.02 of 1/8192
    (Fog, Fog_vsh captures).
    """
    bits, (bias, multiplier) = _bits(fog.mode), line(fog)
    product = keep_significant_bits(keep_significant_bits(coordinate, bits) * multiplier, bits)
    return np.fmax(np.fmin(keep_significant_bits(product + bias, bits), _LARGEST), -_LARGEST)


@lru_cache(maxsize=8)
def table(mode):
    """float64 [TABLE_SIZE]: the factor's byte, by n = floor(4096 v) of an iterated value v, 0 <= n <= 8192.

    Measured: LINEAR 374 of 374 squares (FogGen_VS-linear-fog_x), EXP and EXP2 91557 of 91557 pixels (Fog,
    Fog_vsh captures).
    """
    n = np.arange(TABLE_SIZE)
    if mode == FogMode.LINEAR:
        factor = np.clip(n - 4095, 0, 4096)
        out = np.minimum(factor * 255 >> 12, 255)
    else:
        x = np.clip(6144 - n, 0, _NODES * _STEPS - 1)
        nodes = np.array(_nodes(mode))
        node, step = x // _STEPS, x % _STEPS
        out = (nodes[node] * (_STEPS - step) + nodes[node + 1] * step + _STEPS // 2) // _STEPS
        out[n <= 6144 - _NODES * _STEPS] = 0
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
    """What is iterated for fog: the coordinate, or what the machine computes from it."""
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
    generation = registers.generation
    if state.vertex.stage == VertexStage.PROGRAM_RESULTS or generation == FogGeneration.FOG_COORDINATE:
        coordinate = own
    elif generation == FogGeneration.SECONDARY_ALPHA:
        coordinate = columns_of(mesh.secondary_colors, (0.0, 0.0, 0.0, 0.0))[3]
    elif generation == FogGeneration.RADIAL:
        coordinate = length(eye[:3])
    elif generation in (FogGeneration.PLANAR, FogGeneration.ABSOLUTE_PLANAR):
        coordinate = weighted_sum(registers.plane, eye)
    else:
        raise ValueError(f"{generation!r} is no way to make fog coordinates.")
    absolute = registers.absolute or generation == FogGeneration.ABSOLUTE_PLANAR
    return np.abs(coordinate) if absolute else coordinate
