"""General combiners and the final combiner in real numbers.

Kernels work on blocks of fragments: windows of a *file* of registers, float64 [registers, 4, k]. A block
stays in the cache, and each operation is one loop over it.
"""

from dataclasses import dataclass

import numpy as np
from numba import float64, int64, types, uint64, void

from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    ComponentUsage,
    Mapping,
    Meaning,
    Register,
)
from fixedpipe.pipeline.state import CombinerInput, RegisterCombiners
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns.combine import coefficients
from fixedpipe.raster.columns.future import real_function
from fixedpipe.raster.kernel import kernel, separate_loop
from fixedpipe.raster.observer import unobserved

_SCALE = {
    CombinerScale.NONE: 1.0,
    CombinerScale.SCALE_BY_TWO: 2.0,
    CombinerScale.SCALE_BY_FOUR: 4.0,
    CombinerScale.SCALE_BY_ONE_HALF: 0.5,
}

# For ``coefficients``: the value of one, the number that EXPAND_NORMAL subtracts, and one half. The second
# triple is for a signed constant, as the notations store it.
_CONSTANTS, _SIGNED_CONSTANTS = (1.0, 1.0, 0.5), (1.0, 256 / 255, 128 / 255)

_BLOCK = 64
_REGISTERS = C.REGISTER_DISCARD  # the registers of a file come before it

# A portion's row of whole numbers begins with two numbers for each of its four variables. The first is the
# register, or _SAME for a colour that all fragments share. The second is the component, or _OWN if each
# component reads itself. The fields below follow. A portion's row of reals holds, in order: four mappings,
# four shared colours, the portion's bias and scale, and for each variable the greatest number before its
# mapping.
_SAME = _OWN = -1
_AB_DOT, _CD_DOT, _MUX, _AB_TO, _CD_TO, _SUM_TO, _BLUE_TO_ALPHA, _PORTION = range(8, 16)
_COLORS, _BIAS, _FACTOR, _GREATEST, _REALS = 16, 32, 33, 34, 38
# In the final combiner's second row: whether it reads E F or SPARE0 + SECONDARY_COLOR.
_ASKS_PSEUDO = 8

# Each portion computes its variables, two products and their sum, [4, block] each; the RGB portion comes
# first.
_AB, _CD, _SUM, _COMPUTED = 4, 5, 6, 7

_FILE = float64[:, :, ::1]
_WINDOW = types.UniTuple(int64, 2)  # of a file: the first fragment, and how many


@kernel
def _mapped(x, least, greatest, factor, offset, most):
    x = least if x < least else x
    x = greatest if x > greatest else x
    x = factor * x + offset
    return most if x < most else x


@kernel(void(_FILE, _WINDOW, int64[::1], float64[::1], int64, int64, int64, float64[:, ::1]))
def _read(file, window, row, reals, variable, first, last, out):
    """Read and map components ``first`` to ``last`` of a combiner variable."""
    separate_loop()
    start, count = uint64(window[0]), window[1]
    register, component = row[2 * variable], row[2 * variable + 1]
    least, factor = reals[4 * variable], reals[4 * variable + 1]
    offset, most = reals[4 * variable + 2], reals[4 * variable + 3]
    greatest = reals[_GREATEST + variable]
    for c in range(first, last):
        k = c if component == _OWN else component
        if register == _SAME:
            value = _mapped(reals[_COLORS + 4 * variable + k], least, greatest, factor, offset, most)
            for i in range(count):
                out[c, i] = value
        else:
            for i in range(count):
                x = file[register, k, start + uint64(i)]
                out[c, i] = _mapped(x, least, greatest, factor, offset, most)


@kernel(void(_FILE, int64, int64, int64, int64, int64))
def _multiply(computed, at, first, last, dots, count):
    """Store the product of a variable and the next, or their dot product."""
    separate_loop()
    a, b, to = uint64(at), uint64(at + 1), uint64(at - at % _COMPUTED + _AB + (at % _COMPUTED) // 2)
    for c in range(first, last):
        for i in range(count):
            computed[to, c, i] = computed[a, c, i] * computed[b, c, i]
    if dots:
        for i in range(count):
            total = (computed[to, 0, i] + computed[to, 1, i]) + computed[to, 2, i]
            for c in range(3):
                computed[to, c, i] = total


@kernel(void(_FILE, _WINDOW, int64, int64, int64, int64, _FILE))
def _add(file, window, at, first, last, mux, computed):
    """Store AB + CD. For a mux, store CD where SPARE0's alpha is 1/2 or more, and AB elsewhere.

    Source: NV_register_combiners, section 3.8.12.2.
    """
    separate_loop()
    start, count = uint64(window[0]), window[1]
    ab, cd, to = uint64(at + _AB), uint64(at + _CD), uint64(at + _SUM)
    for c in range(first, last):
        if mux:
            for i in range(count):
                chooses = file[C.REGISTER_SPARE0, 3, start + uint64(i)] >= 0.5
                computed[to, c, i] = computed[cd, c, i] if chooses else computed[ab, c, i]
        else:
            for i in range(count):
                computed[to, c, i] = computed[ab, c, i] + computed[cd, c, i]


@kernel(void(_FILE, _WINDOW, int64[:, ::1], float64[:, ::1], _FILE))
def _store(file, window, rows, reals, computed):
    """Store the outputs of a stage's portions in registers, the RGB portion's first."""
    separate_loop()
    start, count = uint64(window[0]), window[1]
    for portion in range(2):
        bias, factor = reals[portion, _BIAS], reals[portion, _FACTOR]
        for k in range(3):
            to, at = rows[portion, _AB_TO + k], uint64(portion * _COMPUTED + _AB + k)
            if to != C.REGISTER_DISCARD:
                last = 4 if portion or (rows[portion, _BLUE_TO_ALPHA] >> k) & 1 else 3
                for c in range(3 * portion, last):
                    source = uint64(c if portion else min(c, 2))
                    for i in range(count):
                        file[to, c, start + uint64(i)] = (computed[at, source, i] + bias) * factor


@kernel(void(_FILE, int64[:, ::1], float64[:, ::1], int64, int64, _FILE))
def _stage(file, rows, reals, computes, stores, computed):
    """Run the two portions of a stage, block by block.

    ``computes``: compute products and sums, before bias and scale. ``stores``: store the outputs in
    registers.
    """
    block = computed.shape[2]
    for start in range(0, file.shape[2], block):
        window = start, min(block, file.shape[2] - start)
        for portion in range(2 * computes):
            row, numbers, at = rows[portion], reals[portion], portion * _COMPUTED
            first, last = (3, 4) if portion else (0, 3)
            sums = row[_SUM_TO] != C.REGISTER_DISCARD
            for pair in range(2):
                if sums or row[_AB_TO + pair] != C.REGISTER_DISCARD:
                    for v in range(2 * pair, 2 * pair + 2):
                        _read(file, window, row, numbers, v, first, last, computed[at + v])
                    _multiply(computed, at + 2 * pair, first, last, row[_AB_DOT + pair], window[1])
            if sums:
                _add(file, window, at, first, last, row[_MUX], computed)
        if stores:
            _store(file, window, rows, reals, computed)


@kernel(void(_FILE, _WINDOW, _FILE))
def _pseudo_registers(file, window, computed):
    """Store E F, the product of its factors, and SPARE0 + SECONDARY_COLOR."""
    separate_loop()
    start, count = uint64(window[0]), window[1]
    for c in range(3):
        for i in range(count):
            k = start + uint64(i)
            file[C.REGISTER_E_TIMES_F, c, k] = computed[4, c, i] * computed[5, c, i]
        for i in range(count):
            k = start + uint64(i)
            spare, second = file[C.REGISTER_SPARE0, c, k], file[C.REGISTER_SECONDARY_COLOR, c, k]
            total = (0.0 if spare < 0.0 else spare) + (0.0 if second < 0.0 else second)
            file[C.REGISTER_SPARE0_PLUS_SECONDARY_COLOR, c, k] = total


@kernel(void(_FILE, _WINDOW, float64[:, ::1]))
def _blend(computed, window, out):
    """Store A B + (1 - A) C + D, and G, clamped to [0, 1], in a window of ``out``."""
    separate_loop()
    start, count = uint64(window[0]), window[1]
    for i in range(count):
        for c in range(3):
            a = computed[0, c, i]
            a = 1.0 if a > 1.0 else a
            value = (a * computed[1, c, i] + (1.0 - a) * computed[2, c, i]) + computed[3, c, i]
            out[start + uint64(i), c] = 0.0 if value < 0.0 else (1.0 if value > 1.0 else value)
        value = computed[6, 3, i]
        out[start + uint64(i), 3] = 0.0 if value < 0.0 else (1.0 if value > 1.0 else value)


@kernel(void(_FILE, int64[:, ::1], float64[:, ::1], _FILE, float64[:, ::1]))
def _finish(file, rows, reals, computed, out):
    """Run the final combiner, block by block. ``rows``: one for A to D, one for E, F and G."""
    block = computed.shape[2]
    for start in range(0, file.shape[2], block):
        window = start, min(block, file.shape[2] - start)
        for k in range(7):
            v = (k + 4) % 7  # E, F and G first: A to D may read their results
            if v == 0 and rows[1, _ASKS_PSEUDO]:
                _pseudo_registers(file, window, computed)
            row, first, last = v // 4, 3 if v == 6 else 0, 4 if v == 6 else 3
            _read(file, window, rows[row], reals[row], v % 4, first, last, computed[v])
        _blend(computed, window, out)


@kernel(void(float64[:, ::1], _FILE, int64))
def _load(source, file, register):
    """Load a register from the fragments' columns, or from one colour for all fragments."""
    separate_loop()
    step = 1 if len(source) > 1 else 0
    for i in range(file.shape[2]):
        for c in range(4):
            file[register, c, i] = source[step * i, c]


@dataclass(frozen=True, eq=False)
class Plan:
    """RegisterCombiners in the form that kernels take (``plan_of``).

    rows, reals  int64 and float64 [stages + 1, 2, ...]: what each portion reads and computes; the final
                 combiner is the last
    read         the registers that a variable reads, without those of one colour
    """

    combiners: RegisterCombiners
    rows: np.ndarray
    reals: np.ndarray
    read: frozenset[Register]


_COMPONENTS = {ComponentUsage.RGB: _OWN, ComponentUsage.ALPHA: 3, ComponentUsage.BLUE: 2}


def plan_of(combiners):
    """The Plan of a RegisterCombiners."""
    stages, final = combiners.general, combiners.final
    rows = np.full((len(stages) + 1, 2, _PORTION), C.REGISTER_DISCARD, np.int64)
    reals, read = np.zeros((len(rows), 2, _REALS)), set()
    for k, stage in enumerate(stages):
        colors = _colors(combiners, stage.constant_color0, stage.constant_color1)
        for portion, row, numbers in zip((stage.rgb, stage.alpha), rows[k], reals[k], strict=True):
            _plan_portion(portion, colors, row, numbers, read)
        if stage.lookup is not None:
            read.add(stage.lookup.register)
    colors, blended = _colors(combiners), (final.a, final.b, final.c, final.d)
    _plan_variables(blended, colors, rows[-1, 0], reals[-1, 0], read)
    asked = {variable.register for variable in blended}
    product = Register.E_TIMES_F in asked
    total = Register.SPARE0_PLUS_SECONDARY_COLOR in asked
    factors = (final.e, final.f) if product else (CombinerInput(), CombinerInput())
    _plan_variables((*factors, final.g), colors, rows[-1, 1], reals[-1, 1], read)
    rows[-1, 1, _ASKS_PSEUDO] = product or total
    if product or total:
        read |= {Register.SPARE0, Register.SECONDARY_COLOR}
    return Plan(combiners, rows, reals, frozenset(read))


def _colors(combiners, color0=None, color1=None):
    """The registers that have one colour for all fragments: zero, and the stage's or the
    program's constants.
    """
    return {
        Register.ZERO: (0.0,) * 4,
        Register.CONSTANT_COLOR0: combiners.constant_color0 if color0 is None else color0,
        Register.CONSTANT_COLOR1: combiners.constant_color1 if color1 is None else color1,
    }


def _plan_variables(variables, colors, row, numbers, read):
    for k, variable in enumerate(variables):
        if variable.usage not in _COMPONENTS:
            raise ValueError(f"The ideal machine has no component usage {variable.usage.name}.")
        same = variable.register in colors
        row[2 * k : 2 * k + 2] = _SAME if same else variable.register, _COMPONENTS[variable.usage]
        constants = _SIGNED_CONSTANTS if variable.meaning is Meaning.SIGNED_CONSTANT else _CONSTANTS
        numbers[4 * k : 4 * k + 4] = _mapping(variable.mapping, constants)
        numbers[_GREATEST + k] = 1.0 if variable.meaning is Meaning.SATURATED else np.inf
        if same:
            numbers[_COLORS + 4 * k : _COLORS + 4 * k + 4] = colors[variable.register]
        else:
            read.add(variable.register)


def _plan_portion(portion, colors, row, numbers, read):
    if portion.ab_output is portion.cd_output is portion.sum_output is Register.DISCARD:
        return
    _plan_variables((portion.a, portion.b, portion.c, portion.d), colors, row, numbers, read)
    row[_AB_DOT] = getattr(portion, "ab_dot_product", False)
    row[_CD_DOT] = getattr(portion, "cd_dot_product", False)
    row[_MUX] = portion.mux_sum
    row[[_AB_TO, _CD_TO, _SUM_TO]] = portion.ab_output, portion.cd_output, portion.sum_output
    of_ab, of_cd = (getattr(portion, f"{half}_blue_to_alpha", False) for half in ("ab", "cd"))
    row[_BLUE_TO_ALPHA] = of_ab + 2 * of_cd
    numbers[_BIAS] = -0.5 if portion.bias is CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0.0
    numbers[_FACTOR] = _SCALE[portion.scale]
    if portion.mux_sum:
        read.add(Register.SPARE0)


def _mapping(mapping, constants):
    """(least, factor, offset, most): a mapping in real numbers is max(most, factor * max(least, x) + offset).

    A program's saturation limits x to 1 first. The unsigned mappings yield no negative number; the others
    have no upper clamp. Source: NV_register_combiners, table 4.
    """
    signed, factor, offset = coefficients(mapping, *constants)
    most = 0.0 if mapping is Mapping.UNSIGNED_INVERT else -np.inf
    return -np.inf if signed else 0.0, factor, offset, most


def constant_color(color):
    """One color for all fragments, float64 [1, 4]."""
    return np.array([color], np.float64)


def combine(plan, registers, look_up=None, observe=unobserved):
    """Run general combiners and final combiner: float64 [k, 4], clamped to [0, 1] at the very end.

    registers  Register to float64 [k, 4], or [1, 4] for all fragments: those of ``plan.read`` that no stage
               writes. SPARE0's alpha is texture 0's if SPARE0 is missing
    look_up    ``look_up(lookup, rgb)`` gives the texel of a stage's CombinerLookup at its register's colours,
               float64 [k, 3]
    observe    the observer: it receives each stage's file and its portions' results, for a few fragments

    No value is clamped between the stages. The final combiner's A is a blend's weight, and stays in [0, 1]. A
    texture environment's dot product copies AB's blue to alpha; on the NV2A a program may ask for it too.
    """
    count, stages = len(registers[Register.PRIMARY_COLOR]), plan.combiners.general
    whole = any(_functions(stage) for stage in stages)
    file = np.empty((_REGISTERS, 4, count))
    computed = np.zeros((2 * _COMPUTED, 4, max(count, 1) if whole else _BLOCK))
    for register in plan.read:
        if register in registers:
            _load(np.ascontiguousarray(registers[register]), file, int(register))
        else:
            file[register] = 0.0
    if Register.SPARE0 in plan.read and Register.SPARE0 not in registers:
        file[Register.SPARE0, 3] = registers[Register.TEXTURE0][:, 3]
    out = np.empty((count, 4))
    for stage, rows, reals in zip(stages, plan.rows, plan.reals, strict=False):
        functions = _functions(stage)
        _stage(file, rows, reals, 1, not functions, computed)
        for portion, function in enumerate(functions):
            ab, cd, total = computed[portion * _COMPUTED :][_AB:_COMPUTED]
            if function is not CombinerFunction.NONE:
                channels = slice(3, 4) if portion else slice(3)
                total[channels] = real_function(function, ab[channels], cd[channels])
        if functions:
            _stage(file, rows, reals, 0, 1, computed)
        if stage.lookup is not None:
            found = look_up(stage.lookup, np.ascontiguousarray(file[stage.lookup.register, :3].T))
            file[Register.TEXTURE0 + stage.lookup.unit] = found.T
        observe("combined", file=file, computed=computed)
    _finish(file, plan.rows[-1], plan.reals[-1], computed, out)
    observe("final combiner", file=file, computed=computed, color=out)
    return out


def _functions(stage):
    """The functions of a stage's portions; empty if both portions add."""
    both = stage.rgb.function, stage.alpha.function
    return () if both == (CombinerFunction.NONE,) * 2 else both
