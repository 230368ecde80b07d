"""Plan a combiner program: from its packed rows to the operations of ``raster/vector/combine.py``.

The planner follows every value of a register from its computation to its reads. So unread values are not
computed, moves cost nothing, equal values are computed once, and a stage may read and write one register
without copies: each result has its own plane while it is needed.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.vector import combine as V


@dataclass(frozen=True, eq=False)
class CombinerPlan:
    """The arguments that ``fixedpipe.raster.vector.combine.combine`` runs.

    - ``rows``: int32 [operations, OPERATION_SIZE].
    - ``planes``: the planes of colors, fog factor and texels (register * 4 + channel) on which the program's
      result depends; no other plane must be computed.
    - ``constants``: int32 [k, 6], the places in ``rows`` of values that follow from constant colours.
    """

    rows: np.ndarray
    planes: frozenset
    constants: np.ndarray

    def filled(self, constants, draw):
        """The rows with the values of a pass's constant colours, which are its packed rows ``constants``."""
        rows, where = self.rows.copy(), self.constants  # kernels take only writable arrays
        if len(where):
            rows[where[:, 0], where[:, 1]] = self.values(constants[None], draw)[0]
        return rows

    def values(self, constants, draw):
        """The numbers at the places of ``constants`` for several passes, of which these are the packed rows:
        int64 [passes, places].
        """
        fog = np.broadcast_to(draw[R.FOG_RED : R.FOG_BLUE + 1], (len(constants), 3))
        given = np.concatenate((constants.reshape(len(constants), -1), fog), axis=1)
        _, _, at, low, factor, addend = self.constants.T
        return np.minimum(np.maximum(given[:, at], low) * factor + addend, 255)


class _Value(NamedTuple):
    """The contents of a register's channel, and their range.

    ``kind`` is one of: a ``number``; a ``constant``, with its index in the constants; a ``plane``, which an
    earlier stage of the pipeline fills; the ``result`` of an operation.
    """

    kind: str
    at: int
    low: int
    high: int


class _Operand(NamedTuple):
    """A value through a mapping, min(max(x, low) * factor + addend, 255)."""

    value: _Value
    low: int
    factor: int
    addend: int


class _Operation(NamedTuple):
    """An operation before it has a plane.

    A kind of None means products of any shape, through SELECT if ``mux`` is set. ``operands`` begins with
    those of AB; ``ab`` is their number, two or six.
    """

    kind: int | None
    operands: tuple
    bias: int = 0
    scale: int = C.SCALE_NONE
    lowest: int = 0
    highest: int = 255
    rounding: int = C.ROUNDING_BEFORE_SCALE
    ab: int = 2
    mux: int = 0


def _number(value):
    return _Value("number", value, value, value)


_ZERO = _Operand(_number(0), 0, 1, 0)
_ONE = _Operand(_number(255), 0, 1, 0)
_TOP = 255 + 255  # the largest sum of two colors without a clamp


def _limits(operand):
    """The least and the greatest result of a mapped value."""
    value, low, factor, addend = operand
    ends = [min(max(x, low) * factor + addend, max(255, value.high)) for x in (value.low, value.high)]
    return min(ends), max(ends)


def _is(operand, number):
    return _limits(operand) == (number, number)


def _is_itself(operand):
    """Whether a mapping changes none of the values that can occur."""
    return operand.factor == 1 and operand.addend == 0 and operand.value.low >= operand.low


def _work(operand):
    """The work that a mapping needs: codes.MAPS_..."""
    value, low, factor, addend = operand
    if value.low < low or max(x * factor + addend for x in (value.low, value.high)) > 255:
        return C.MAPS_ALL
    return C.MAPS_NOTHING if _is_itself(operand) else C.MAPS_WITHIN


def _inverted(operand):
    """One minus an operand of the final combiner."""
    return operand._replace(factor=-operand.factor, addend=255 - operand.addend)


class _Planner:
    """Operations in the order of their emission, each once."""

    def __init__(self, per_product, before, lowest):
        self.operations = []
        self.known = {}
        after = C.ROUNDING_BEFORE_SCALE if before else C.ROUNDING_AFTER_SCALE
        self.rounding = C.ROUNDING_DONE if per_product else after
        self.lowest = lowest

    def emit(self, operation):
        """The value of an operation, which is emitted if it is new."""
        if operation not in self.known:
            self.operations.append(operation)
            low = operation.lowest if operation.kind in (None, C.PLAN_ADD_SIGNED, C.PLAN_DOT_PRODUCT) else 0
            if operation.kind == C.PLAN_ADD_BYTES and operation.bias:
                low = operation.lowest
            self.known[operation] = _Value("result", len(self.operations) - 1, low, operation.highest)
        return self.known[operation]

    def sum_of(self, pairs, bias=0, scale=C.SCALE_NONE, lowest=0, rounding=C.ROUNDING_BEFORE_SCALE):
        """The value of one product, or of the sum of two, of single channels."""
        pairs = [pair for pair in pairs if not any(_is(operand, 0) for operand in pair)]
        if not pairs:
            value = (bias + 1) >> 1 if scale == C.SCALE_BY_ONE_HALF else bias << scale
            return _number(min(max(value, lowest), 255))
        single = len(pairs) == 1
        unscaled = scale == C.SCALE_NONE
        if (unscaled and rounding == C.ROUNDING_AFTER_SCALE) or (single and rounding == C.ROUNDING_DONE):
            rounding = C.ROUNDING_BEFORE_SCALE
        if single and bias == 0 and unscaled:
            for operand, other in (pairs[0], pairs[0][::-1]):
                if _is(other, 255) and _is_itself(operand) and operand.value.low >= lowest:
                    return operand.value
        operands = tuple(operand for pair in pairs for operand in pair)
        operation = _Operation(None, operands, bias, scale, lowest, rounding=rounding)
        if rounding == C.ROUNDING_BEFORE_SCALE:
            unsigned = all(_limits(operand)[0] >= 0 for operand in operands)
            if single and unsigned and bias == 0 and unscaled:
                return self.emit(operation._replace(kind=C.PLAN_MODULATE, lowest=0))
            # A sum of bytes is clamped at one before later steps; a bias or one half would see the
            # difference.
            in_bytes = unsigned and (single or (bias == 0 and scale != C.SCALE_BY_ONE_HALF))
            operation = operation._replace(
                kind=C.PLAN_ADD_BYTES if in_bytes else C.PLAN_ADD_SIGNED,
                operands=operands + (_ZERO, _ZERO) * single,
            )
        return self.emit(operation)

    def product(self, operands, ending):
        """AB or CD of a portion: a product, or the dot product of six operands."""
        if len(operands) == 2:
            return self.sum_of([operands], **ending)
        rounding = ending["rounding"]
        if ending["scale"] == C.SCALE_NONE and rounding == C.ROUNDING_AFTER_SCALE:
            rounding = C.ROUNDING_BEFORE_SCALE
        kind = C.PLAN_DOT_PRODUCT if rounding == C.ROUNDING_BEFORE_SCALE else None
        return self.emit(_Operation(kind, operands, **{**ending, "rounding": rounding}, ab=6))

    def total(self, ab, cd, mux, alpha, ending):
        """The sum of a portion, or its selection by SPARE0's ``alpha``."""
        if mux and alpha.kind == "number":
            return self.product(cd if max(alpha.at, 0) & mux else ab, ending)
        if mux:
            if alpha.kind == "constant":  # a constant has no plane yet
                alpha = self.emit(_Operation(C.PLAN_MODULATE, (_Operand(alpha, 0, 1, 0), _ONE)))
            operands = (*ab, *cd, _Operand(alpha, 0, 1, 0))
            return self.emit(_Operation(None, operands, **ending, ab=len(ab), mux=mux))
        if len(ab) == len(cd) == 2:
            return self.sum_of([ab, cd], **ending)
        for one, other in ((ab, cd), (cd, ab)):
            if all(_is(x, 0) or _is(y, 0) for x, y in zip(other[::2], other[1::2], strict=True)):
                return self.product(one, ending)
        return self.emit(_Operation(None, (*ab, *cd), **ending, ab=len(ab)))

    def portion(self, registers, row, channels):
        """The AB, CD and sum outputs of a portion: for each of its channels, a value or None."""
        ending = {
            "bias": row[R.BIAS],
            "scale": row[R.SCALE],
            "lowest": self.lowest,
            "rounding": self.rounding,
        }
        alpha = registers[C.REGISTER_SPARE0 * 4 + 3]

        def product(first, second, k, dot):
            return tuple(
                _read(registers, row[at * R.INPUT_SIZE :], channel)
                for channel in (range(3) if dot else (k,))
                for at in (first, second)
            )

        outputs = []
        for k in channels:
            ab, cd = product(0, 1, k, row[R.AB_DOT]), product(2, 3, k, row[R.CD_DOT])
            outputs.append(
                (
                    self.product(ab, ending) if row[R.AB_OUTPUT] >= 0 else None,
                    self.product(cd, ending) if row[R.CD_OUTPUT] >= 0 else None,
                    self.total(ab, cd, row[R.MUX], alpha, ending) if row[R.SUM_OUTPUT] >= 0 else None,
                )
            )
        return outputs

    def stage(self, registers, rgb, alpha):
        """Plan a general combiner; it updates ``registers``, a value for each plane."""
        colors, alphas = self.portion(registers, rgb, range(3)), self.portion(registers, alpha, (3,))
        for output in range(3):
            at = rgb[R.AB_OUTPUT + output] * 4
            if at >= 0:
                registers[at : at + 3] = [values[output] for values in colors]
                if output < 2 and rgb[R.AB_BLUE + output]:
                    registers[at + 3] = colors[2][output]
            at = alpha[R.AB_OUTPUT + output] * 4
            if at >= 0:
                registers[at + 3] = alphas[0][output]

    def wide(self, pairs):
        """A sum of two products up to _TOP, with operands up to _TOP."""
        operands = tuple(operand for pair in pairs for operand in pair)
        return self.emit(_Operation(C.PLAN_ADD_SIGNED, operands, highest=_TOP))

    def final(self, registers, final, color_sum):
        """The final combiner's red, green, blue and alpha, as operands."""

        def read(variable, k):
            register, usage, invert = final[variable]
            operand = _read(registers, (register, usage, 0, 1, 0), k)
            if invert and operand.value.high > 255:  # One minus a value above one is zero.
                operand = _Operand(
                    self.emit(_Operation(C.PLAN_ADD_SIGNED, (operand, _ONE, _ZERO, _ZERO))), 0, 1, 0
                )
            return _inverted(operand) if invert else operand

        def color(register, k, invert):
            operand = _read(registers, (register, C.USAGE_RGB, 0, 1, 0), k)
            return _inverted(operand) if invert else operand

        used = {row[0] for row in (*final[:4], final[6])}
        sums, products = [], []
        for k in range(3):
            if C.REGISTER_SPARE0_PLUS_SECONDARY_COLOR in used:
                pairs = [
                    (color(C.REGISTER_SPARE0, k, color_sum & C.COLOR_SUM_INVERT_SPARE0), _ONE),
                    (color(C.REGISTER_SECONDARY_COLOR, k, color_sum & C.COLOR_SUM_INVERT_SECONDARY), _ONE),
                ]
                sums.append(self.sum_of(pairs) if color_sum & C.COLOR_SUM_CLAMP else self.wide(pairs))
            if C.REGISTER_E_TIMES_F in used:
                products.append(self.sum_of([(read(4, k), read(5, k))]))
        registers[C.REGISTER_E_TIMES_F * 4 : C.REGISTER_E_TIMES_F * 4 + len(products)] = products
        registers[
            C.REGISTER_SPARE0_PLUS_SECONDARY_COLOR * 4 : C.REGISTER_SPARE0_PLUS_SECONDARY_COLOR * 4
            + len(sums)
        ] = sums
        return [*(self.final_channel(*(read(v, k) for v in range(4))) for k in range(3)), read(6, 3)]

    def final_channel(self, a, b, c, d):
        """A B + (1 - A) C + D."""
        top = max(operand.value.high for operand in (b, c, d))
        if _is(a, 0) or _is(a, 255) or (_is(b, 0) and _is(c, 0)):
            mixed = c if _is(a, 0) else b
        elif top <= 255:
            return _Operand(self.emit(_Operation(C.PLAN_LERP, (a, b, c, d))), 0, 1, 0)
        else:
            mixed = _Operand(self.wide([(a, b), (_inverted(a), c)]), 0, 1, 0)
        if _is(d, 0) or _is(mixed, 0):
            return mixed if _is(d, 0) else d
        pairs = [(mixed, _ONE), (d, _ONE)]
        return _Operand(self.sum_of(pairs) if top <= 255 else self.wide(pairs), 0, 1, 0)


def _read(registers, row, channel):
    """The operand that an input reads for a channel; ``row`` is register, usage, mapping."""
    register, usage, low, factor, addend = row[:5]
    component = {C.USAGE_RGB: channel, C.USAGE_ALPHA: 3, C.USAGE_BLUE: 2}[usage]
    return _Operand(registers[register * 4 + component], low, factor, addend)


def _first_registers(stages, fog, units):
    """The contents of every plane before the first stage.

    ``units`` has the least value of each unit's texel; None: the unit is disabled.
    """
    registers = [_number(0)] * (R.REGISTERS * 4)
    for k in range(3):
        registers[C.REGISTER_FOG * 4 + k] = _Value("constant", 8 * (stages + 1) + k, 0, 255)
    registers[C.REGISTER_FOG * 4 + 3] = (
        _Value("plane", C.REGISTER_FOG * 4 + 3, 0, 255) if fog else _number(255)
    )
    for at in (
        *range(C.REGISTER_PRIMARY_COLOR * 4, C.REGISTER_PRIMARY_COLOR * 4 + 4),
        *range(C.REGISTER_SECONDARY_COLOR * 4, C.REGISTER_SECONDARY_COLOR * 4 + 4),
    ):
        registers[at] = _Value("plane", at, 0, 255)
    for unit in range(4):
        at = (C.REGISTER_TEXTURE0 + unit) * 4
        least = units[unit] if unit < len(units) else None
        for k in range(4):
            if least is not None:
                registers[at + k] = _Value("plane", at + k, least, 255)
            else:  # Measured: the values of a disabled unit (combiner captures).
                registers[at + k] = _number(255 if k == 3 else 0)
    registers[C.REGISTER_SPARE0 * 4 + 3] = registers[C.REGISTER_TEXTURE0 * 4 + 3]
    return registers


def _expanded(operation, target):
    """The rows of an operation that has a plane: (kind, target, second, operands) of each."""
    if operation.kind is not None:
        return [(operation.kind, target, 0, operation.operands)]
    rows, ab = [], operation.operands[: operation.ab]
    cd = operation.operands[operation.ab :]
    if operation.mux:
        alpha, cd = cd[-1:], cd[:-1]
    for first, side in ((0, ab), (4, cd)):
        for k in range(len(side) // 2):
            rows.append((C.PLAN_MULTIPLY, first + k, 0, side[2 * k : 2 * k + 2]))
        if len(side) == 6:
            rows.append((C.PLAN_SUM_OF_THREE, first, 0, ()))
    source = V.TOTAL if cd else 0
    if operation.mux:
        rows.append((C.PLAN_SELECT, 0, 4, alpha))
    elif cd:
        rows.append((C.PLAN_SUM_OF_TWO, 0, 4, ()))
    return [*rows, (C.PLAN_FINISH, target, source, ())]


# Planes that hold no color, fog factor or texel; SELECT uses SPARE0's alpha. They suffice, because a program
# keeps at most the 32 channels of the writable registers and one stage's twelve results.
_FREE = (
    *range(C.REGISTER_FOG * 4),
    *range(C.REGISTER_SPARE0 * 4, C.REGISTER_SPARE0 * 4 + 3),
    *range(C.REGISTER_SPARE1 * 4, C.REGISTER_SPARE1 * 4 + 4),
    *range(C.REGISTER_E_TIMES_F * 4, V.PLANES),
)


def _rows(operations):
    """(rows of a plan, planes read, constants to insert: (row, column, constant, low, factor, addend))."""
    last = {}  # for each result, the operation that reads it last
    for at in range(len(operations) - 1, -1, -1):
        if at in last or at == len(operations) - 1:
            for operand in operations[at].operands:
                if operand.value.kind == "result":
                    last.setdefault(operand.value.at, at)
    rows, constants, planes, free, held = [], [], set(), list(_FREE[::-1]), {}
    for at, operation in enumerate(operations):
        if at not in last and at != len(operations) - 1:
            continue
        where = [held.get(operand.value.at) for operand in operation.operands]
        sources = dict(zip(operation.operands, where, strict=True))
        for result in {o.value.at for o in operation.operands if o.value.kind == "result"}:
            if last[result] == at:  # may be overwritten in place
                free.append(held.pop(result))
        target = 0
        if at in last:
            target = held[at] = free.pop()
        for kind, output, second, operands in _expanded(operation, target):
            row = [0] * V.OPERATION_SIZE
            row[: V.OPERANDS] = (
                kind,
                output,
                second,
                operation.rounding,
                operation.bias,
                operation.scale,
                operation.lowest,
                operation.highest,
                operation.mux,
            )
            for k, operand in enumerate(operands):
                value, low, factor, addend = operand
                column = V.OPERANDS + k * R.INPUT_SIZE
                if value.kind == "number":
                    number = min(max(value.at, low) * factor + addend, 255)
                    entries = (0, C.MAPS_WITHIN, 0, 0, number)
                elif value.kind == "constant":
                    constants.append((len(rows), column + 4, value.at, low, factor, addend))
                    entries = (0, C.MAPS_WITHIN, 0, 0, 0)
                else:
                    if value.kind == "plane":
                        planes.add(value.at)
                    entries = (
                        value.at if value.kind == "plane" else sources[operand],
                        _work(operand),
                        low,
                        factor,
                        addend,
                    )
                row[column : column + R.INPUT_SIZE] = entries
            rows.append(row)
    return np.array(rows, np.int32), frozenset(planes), np.array(constants, np.int32).reshape(-1, 6)


@lru_cache(maxsize=256)
def _plan(program, final, direct, color_sum, fog, arithmetic, units):
    if direct:
        planner, registers = _Planner(*arithmetic), _first_registers(0, False, units)
        outputs = [_Operand(registers[C.REGISTER_PRIMARY_COLOR * 4 + k], 0, 1, 0) for k in range(4)]
    else:
        program = np.frombuffer(program, np.int32).reshape(-1, 2, R.PORTION_SIZE).tolist()
        final = np.frombuffer(final, np.int32).reshape(7, R.FINAL_SIZE).tolist()
        stages, planner = len(program), _Planner(*arithmetic)
        registers = _first_registers(stages, fog, units)
        for stage in range(stages + 1):
            for k in range(8):
                registers[C.REGISTER_CONSTANT_COLOR0 * 4 + k] = _Value("constant", 8 * stage + k, 0, 255)
            if stage < stages:
                planner.stage(registers, *program[stage])
        outputs = planner.final(registers, final, color_sum)
    planner.emit(_Operation(C.PLAN_PACK, tuple(outputs)))
    rows, planes, constants = _rows(planner.operations)
    rows.setflags(write=False)
    return CombinerPlan(rows, planes, constants)


def plan_combiners(draw, program, final, arithmetic, units):
    """The CombinerPlan of a pass, from its packed rows (``fixedpipe.pipeline.native.pack.PackedState``).

    Programs that differ in their constants alone share it; ``filled`` gives the rows of each.
    """
    least = tuple(
        (-256 if row[R.SIGNED] or draw[R.TEXTURE_SHADER] else 0) if row[R.ENABLED] else None for row in units
    )
    return _plan(
        program.tobytes(),
        final.tobytes(),
        bool(draw[R.DIRECT]),
        int(draw[R.COLOR_SUM]),
        bool(draw[R.FOG_ENABLED]),
        tuple(arithmetic.tolist()),
        least,
    )
