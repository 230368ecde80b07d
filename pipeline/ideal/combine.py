"""General combiners and the final combiner in real numbers.

Kernels take blocks of fragments, so that registers stay in the cache: a *file* of registers, float64
[registers, 4, block], in which each operation is one loop over a block.
"""

from dataclasses import dataclass

import numpy as np
from numba import float64, int64, types, void

from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    ComponentUsage,
    Mapping,
    Register,
)
from fixedpipe.pipeline.ideal.weights import fixed
from fixedpipe.pipeline.state import CombinerInput, RegisterCombiners
from fixedpipe.raster import codes as C
from fixedpipe.raster.kernel import kernel, separate_loop

_SCALE = {
    CombinerScale.NONE: 1.0,
    CombinerScale.SCALE_BY_TWO: 2.0,
    CombinerScale.SCALE_BY_FOUR: 4.0,
    CombinerScale.SCALE_BY_ONE_HALF: 0.5,
}

# The future board's: a register's range, and an exponent whose power is beyond it.
_FARTHEST, _LARGEST_EXPONENT = 256.0, 21.0

# An input mapping in real numbers is max(most, factor * max(least, x) + offset).
# The mappings called unsigned yield nothing negative; none of the others has an upper clamp.
# Source: NV_register_combiners, table 4.
_ANY = -np.inf
_MAPPINGS = {
    Mapping.SIGNED_IDENTITY: (_ANY, 1.0, 0.0, _ANY),
    Mapping.SIGNED_NEGATE: (_ANY, -1.0, 0.0, _ANY),
    Mapping.UNSIGNED_IDENTITY: (0.0, 1.0, 0.0, _ANY),
    Mapping.UNSIGNED_INVERT: (0.0, -1.0, 1.0, 0.0),
    Mapping.EXPAND_NORMAL: (0.0, 2.0, -1.0, _ANY),
    Mapping.EXPAND_NEGATE: (0.0, -2.0, 1.0, _ANY),
    Mapping.HALF_BIAS_NORMAL: (0.0, 1.0, -0.5, _ANY),
    Mapping.HALF_BIAS_NEGATE: (0.0, -1.0, 0.5, _ANY),
}

_BLOCK = 64
_REGISTERS = C.REGISTER_DISCARD  # those that a file holds come before it

# Rows of whole numbers: of four variables the register and the component, or _OWN for each its own; then of a
# portion what follows. Rows of reals: of four variables a mapping, of a portion its bias and scale.
_OWN = -1
_AB_DOT, _CD_DOT, _MUX, _AB_TO, _CD_TO, _SUM_TO, _BLUE_TO_ALPHA, _PORTION = range(8, 16)
_BIAS, _FACTOR, _REALS = 16, 17, 18
# Of the final combiner's second row: whether E F or SPARE0 + SECONDARY_COLOR is asked.
_ASKS_PSEUDO = 8

# How a register begins: as it may, from columns, or SPARE0 with texture 0's alpha.
_UNREAD, _GIVEN, _FRESH = range(3)

# What a portion computes, each [4, block]: its variables, two products, their sum; the RGB portion's first.
_AB, _CD, _SUM, _COMPUTED = 4, 5, 6, 7

_FILE = float64[:, :, ::1]
_SOURCE = types.Array(float64, 2, "C", readonly=True)
_SOURCES = types.UniTuple(_SOURCE, _REGISTERS)
_PROGRAM = types.Tuple((int64[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1]))  # of a Plan


@kernel
def _mapped(x, least, factor, offset, most):
    x = least if x < least else x
    x = factor * x + offset
    return most if x < most else x


@kernel(void(_FILE, int64[::1], float64[::1], int64, int64, int64, float64[:, ::1]))
def _read(file, row, reals, variable, first, last, out):
    """A combiner variable's value for components ``first`` to ``last``."""
    separate_loop()
    register, component = row[2 * variable], row[2 * variable + 1]
    least, factor = reals[4 * variable], reals[4 * variable + 1]
    offset, most = reals[4 * variable + 2], reals[4 * variable + 3]
    for c in range(first, last):
        values, to = file[register, c if component == _OWN else component], out[c]
        for i in range(len(to)):
            to[i] = _mapped(values[i], least, factor, offset, most)


@kernel(void(float64[:, ::1], float64[:, ::1], int64, int64, float64[:, ::1]))
def _product(a, b, first, last, out):
    separate_loop()
    for c in range(first, last):
        x, y, to = a[c], b[c], out[c]
        for i in range(len(to)):
            to[i] = x[i] * y[i]


@kernel(void(float64[:, ::1]))
def _dot(products):
    """The sum of three products, in each of them."""
    separate_loop()
    red, green, blue = products[0], products[1], products[2]
    for i in range(len(red)):
        total = (red[i] + green[i]) + blue[i]
        red[i], green[i], blue[i] = total, total, total


@kernel(void(float64[:, ::1], float64[:, ::1], int64, int64, int64, float64[::1], float64[:, ::1]))
def _sum(ab, cd, first, last, mux, chooses, out):
    """AB + CD; or CD where SPARE0's alpha is 1/2 or more, and AB elsewhere.

    Source: NV_register_combiners, section 3.8.12.2.
    """
    separate_loop()
    for c in range(first, last):
        x, y, to = ab[c], cd[c], out[c]
        if mux:
            for i in range(len(to)):
                to[i] = y[i] if chooses[i] >= 0.5 else x[i]
        else:
            for i in range(len(to)):
                to[i] = x[i] + y[i]


@kernel(void(_FILE, int64[:, ::1], float64[:, ::1], _FILE))
def _compute(file, rows, reals, computed):
    """What the two portions of a stage compute before bias and scale."""
    for portion in range(2):
        row, at = rows[portion], portion * _COMPUTED
        first, last = (3, 4) if portion else (0, 3)
        sums = row[_SUM_TO] != C.REGISTER_DISCARD
        ab, cd = computed[at + _AB], computed[at + _CD]
        if sums or row[_AB_TO] != C.REGISTER_DISCARD:
            for v in range(2):
                _read(file, row, reals[portion], v, first, last, computed[at + v])
            _product(computed[at], computed[at + 1], first, last, ab)
            if row[_AB_DOT]:
                _dot(ab)
        if sums or row[_CD_TO] != C.REGISTER_DISCARD:
            for v in range(2, 4):
                _read(file, row, reals[portion], v, first, last, computed[at + v])
            _product(computed[at + 2], computed[at + 3], first, last, cd)
            if row[_CD_DOT]:
                _dot(cd)
        if sums:
            chooses = file[C.REGISTER_SPARE0, 3]
            _sum(ab, cd, first, last, row[_MUX], chooses, computed[at + _SUM])


@kernel(void(float64[::1], float64, float64, float64[::1]))
def _scaled(values, bias, factor, out):
    separate_loop()
    for i in range(len(out)):
        out[i] = (values[i] + bias) * factor


@kernel(void(_FILE, int64[:, ::1], float64[:, ::1], _FILE))
def _store(file, rows, reals, computed):
    """The outputs of a stage's portions into registers: the RGB portion's first."""
    for portion in range(2):
        row, at = rows[portion], portion * _COMPUTED
        bias, factor = reals[portion, _BIAS], reals[portion, _FACTOR]
        for k in range(3):
            to = row[_AB_TO + k]
            if to != C.REGISTER_DISCARD:
                value = computed[at + _AB + k]
                for c in range(3 * portion, 3 + portion):
                    _scaled(value[c], bias, factor, file[to, c])
                if k == 0 and row[_BLUE_TO_ALPHA]:
                    _scaled(value[2], bias, factor, file[to, 3])


@kernel(void(_FILE, _FILE))
def _pseudo_registers(file, computed):
    """E F from its factors, and what SPARE0 and SECONDARY_COLOR add up to."""
    separate_loop()
    for c in range(3):
        e, f, product = computed[4, c], computed[5, c], file[C.REGISTER_E_TIMES_F, c]
        spare, second = file[C.REGISTER_SPARE0, c], file[C.REGISTER_SECONDARY_COLOR, c]
        total = file[C.REGISTER_SPARE0_PLUS_SECONDARY_COLOR, c]
        for i in range(len(e)):
            product[i] = e[i] * f[i]
            total[i] = (0.0 if spare[i] < 0.0 else spare[i]) + (0.0 if second[i] < 0.0 else second[i])


@kernel(void(_FILE, int64, int64, float64[:, ::1]))
def _blend(computed, start, count, out):
    """A B + (1 - A) C + D, and G, clamped to [0, 1], to rows of ``out`` from ``start`` on."""
    separate_loop()
    for i in range(count):
        for c in range(4):
            if c < 3:
                a = computed[0, c, i]
                a = 1.0 if a > 1.0 else a
                value = (a * computed[1, c, i] + (1.0 - a) * computed[2, c, i]) + computed[3, c, i]
            else:
                value = computed[6, 3, i]
            out[start + i, c] = 0.0 if value < 0.0 else (1.0 if value > 1.0 else value)


@kernel(void(_FILE, int64[:, ::1], float64[:, ::1], _FILE, int64, int64, float64[:, ::1]))
def _finish(file, rows, reals, computed, start, count, out):
    """The final combiner. ``rows``: A to D, then E, F and G."""
    if rows[1, _ASKS_PSEUDO]:
        for v in range(2):
            _read(file, rows[1], reals[1], v, 0, 3, computed[4 + v])
        _pseudo_registers(file, computed)
    for v in range(4):
        _read(file, rows[0], reals[0], v, 0, 3, computed[v])
    _read(file, rows[1], reals[1], 2, 3, 4, computed[6])
    _blend(computed, start, count, out)


@kernel(void(_SOURCE, int64, int64, _FILE, int64))
def _load(source, start, count, file, register):
    """A register of a block from the fragments' columns, or one value for all of them."""
    separate_loop()
    step = 1 if len(source) > 1 else 0
    for i in range(count):
        for c in range(4):
            file[register, c, i] = source[step * (start + i), c]


@kernel(void(_FILE, float64[:, ::1]))
def _fill_constants(file, colors):
    """The two constant colours, unless the file has them from the stage before."""
    for k in range(2):
        for c in range(4):
            row = file[C.REGISTER_CONSTANT_COLOR0 + k, c]
            if row[0] != colors[k, c]:
                for i in range(len(row)):
                    row[i] = colors[k, c]


@kernel(void(_SOURCES, int64[::1], _PROGRAM, _FILE, _FILE, float64[:, ::1]))
def _combine(sources, loaded, program, file, computed, out):
    """A program without lookups and functions. ``loaded``: how each register begins."""
    rows, reals, constants = program
    stages, block = len(rows) - 1, file.shape[2]
    for start in range(0, len(out), block):
        count = min(block, len(out) - start)
        for register in range(_REGISTERS):
            if loaded[register] == _GIVEN:
                _load(sources[register], start, count, file, register)
        if loaded[C.REGISTER_SPARE0] == _FRESH:
            _scaled(file[C.REGISTER_TEXTURE0, 3], 0.0, 1.0, file[C.REGISTER_SPARE0, 3])
        for stage in range(stages):
            _fill_constants(file, constants[stage])
            _compute(file, rows[stage], reals[stage], computed)
            _store(file, rows[stage], reals[stage], computed)
        _fill_constants(file, constants[stages])
        _finish(file, rows[stages], reals[stages], computed, start, count, out)


@dataclass(frozen=True, eq=False)
class Plan:
    """RegisterCombiners as kernels take them (``plan_of``).

    rows, reals  int64 and float64 [stages + 1, 2, ...]: what is read and computed, the final combiner's last
    constants    float64 [stages + 1, 2, 4]: the constant colours of each
    read         the registers that something reads
    """

    combiners: RegisterCombiners
    rows: np.ndarray
    reals: np.ndarray
    constants: np.ndarray
    read: frozenset[Register]


_COMPONENTS = {ComponentUsage.RGB: _OWN, ComponentUsage.ALPHA: 3, ComponentUsage.BLUE: 2}


def plan_of(combiners):
    """The Plan of RegisterCombiners."""
    stages, final = combiners.general, combiners.final
    rows = np.full((len(stages) + 1, 2, _PORTION), C.REGISTER_DISCARD, np.int64)
    reals, read = np.zeros((len(rows), 2, _REALS)), set()
    for k, stage in enumerate(stages):
        for portion, row, numbers in zip((stage.rgb, stage.alpha), rows[k], reals[k], strict=True):
            _plan_portion(portion, row, numbers, read)
        if stage.lookup is not None:
            read.add(stage.lookup.register)
    _plan_variables((final.a, final.b, final.c, final.d), rows[-1, 0], reals[-1, 0], read)
    asked = {variable.register for variable in (final.a, final.b, final.c, final.d)}
    product = Register.E_TIMES_F in asked
    total = Register.SPARE0_PLUS_SECONDARY_COLOR in asked
    factors = (final.e, final.f) if product else (CombinerInput(), CombinerInput())
    _plan_variables((*factors, final.g), rows[-1, 1], reals[-1, 1], read)
    rows[-1, 1, _ASKS_PSEUDO] = product or total
    if total:
        read |= {Register.SPARE0, Register.SECONDARY_COLOR}
    constants = np.array([_constants(combiners, stage) for stage in (*stages, None)], np.float64)
    return Plan(combiners, rows, reals, constants, frozenset(read))


def _plan_variables(variables, row, numbers, read):
    for k, variable in enumerate(variables):
        if variable.usage not in _COMPONENTS:
            raise ValueError(f"The ideal machine has no component usage {variable.usage.name}.")
        row[2 * k : 2 * k + 2] = variable.register, _COMPONENTS[variable.usage]
        numbers[4 * k : 4 * k + 4] = _MAPPINGS[variable.mapping]
        read.add(variable.register)


def _plan_portion(portion, row, numbers, read):
    if portion.ab_output is portion.cd_output is portion.sum_output is Register.DISCARD:
        return
    _plan_variables((portion.a, portion.b, portion.c, portion.d), row, numbers, read)
    row[_AB_DOT] = getattr(portion, "ab_dot_product", False)
    row[_CD_DOT] = getattr(portion, "cd_dot_product", False)
    row[_MUX] = portion.mux_sum
    row[[_AB_TO, _CD_TO, _SUM_TO]] = portion.ab_output, portion.cd_output, portion.sum_output
    row[_BLUE_TO_ALPHA] = getattr(portion, "ab_blue_to_alpha", False)
    numbers[_BIAS] = -0.5 if portion.bias is CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0.0
    numbers[_FACTOR] = _SCALE[portion.scale]
    if portion.mux_sum:
        read.add(Register.SPARE0)


def _constants(combiners, stage):
    own = (None, None) if stage is None else (stage.constant_color0, stage.constant_color1)
    programs = combiners.constant_color0, combiners.constant_color1
    return [everywhere if color is None else color for color, everywhere in zip(own, programs, strict=True)]


def _function(function, ab, cd):
    """What the future board puts in the place of AB + CD; n / 0 is as far as its registers reach.

    Source: docs/numbers.md, section 20.
    """
    if function is CombinerFunction.SQUARE_ROOT:
        return np.sqrt(np.maximum(ab + cd, 0.0))
    if function is CombinerFunction.EXPONENTIAL:
        return np.exp(np.minimum(ab + cd, _LARGEST_EXPONENT))
    if function is CombinerFunction.DIVIDE:
        return np.where(cd == 0.0, np.sign(ab) * _FARTHEST, ab / np.where(cd == 0.0, 1.0, cd))
    raise ValueError(f"The ideal machine has no combiner function {function.name}.")


def constant_color(color):
    """A color for all fragments, float64 [1, 4]."""
    return np.array([color], np.float64)


def combine(plan, registers, look_up=None):
    """General combiners and final combiner: float64 [k, 4], clamped to [0, 1] at the very end.

    ``registers``: Register to float64 [k, 4], or [1, 4] for all fragments: those of ``plan.read`` that no
    stage makes. SPARE0 not among them begins with texture 0's alpha. AB's blue goes to alpha where a texture
    environment's dot product asks for it; users' flags are the NV2A's. Nothing is clamped between the stages;
    the final combiner's A, being the weight of a blend, stays in [0, 1].
    ``look_up(lookup, rgb)``: the texel of a stage's CombinerLookup at its register's colours, float64 [k, 3].
    """
    count = len(registers[Register.PRIMARY_COLOR])
    sources, loaded = [fixed(np.zeros((1, 4)))] * _REGISTERS, np.full(_REGISTERS, _UNREAD)
    for register, color in registers.items():
        if register in plan.read or register is Register.TEXTURE0:
            sources[register], loaded[register] = fixed(color), _GIVEN
    if Register.SPARE0 in plan.read and Register.SPARE0 not in registers:
        loaded[Register.SPARE0] = _FRESH
    stages, out = plan.combiners.general, np.empty((count, 4))
    whole = any(stage.lookup is not None or _functions(stage) for stage in stages)
    block = max(count, 1) if whole else _BLOCK
    file, computed = np.zeros((_REGISTERS, 4, block)), np.empty((2 * _COMPUTED, 4, block))
    if not whole:
        program = plan.rows, plan.reals, plan.constants
        _combine(tuple(sources), loaded, program, file, computed, out)
        return out
    for register in np.flatnonzero(loaded == _GIVEN).tolist():
        _load(sources[register], 0, count, file, register)
    if loaded[Register.SPARE0] == _FRESH:
        file[Register.SPARE0, 3] = file[Register.TEXTURE0, 3]
    for k, stage in enumerate(stages):
        _fill_constants(file, plan.constants[k])
        _compute(file, plan.rows[k], plan.reals[k], computed)
        for portion, function in enumerate(_functions(stage)):
            ab, cd, total = computed[portion * _COMPUTED :][_AB:_COMPUTED]
            if function is not CombinerFunction.NONE:
                channels = slice(3, 4) if portion else slice(3)
                total[channels] = _function(function, ab[channels], cd[channels])
        _store(file, plan.rows[k], plan.reals[k], computed)
        if stage.lookup is not None:
            found = look_up(stage.lookup, np.ascontiguousarray(file[stage.lookup.register, :3].T))
            file[Register.TEXTURE0 + stage.lookup.unit] = found.T
    _fill_constants(file, plan.constants[-1])
    _finish(file, plan.rows[-1], plan.reals[-1], computed, 0, count, out)
    return out


def _functions(stage):
    """The functions of a stage's portions; none where both add."""
    both = stage.rgb.function, stage.alpha.function
    return () if both == (CombinerFunction.NONE,) * 2 else both
