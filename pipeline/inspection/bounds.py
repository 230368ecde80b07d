"""The ranges of a combiner program's registers, and whether a clamp can ever bite: without drawing.

It is interval arithmetic with the column engine's own functions. Each is monotonic in each input, so the ends
of the input ranges give the ends of the result. The method ignores correlation between values, with one
exception: a value times itself is a square. So a bound may be wider than what fragments reach, and is never
narrower.
"""

from collections.abc import Mapping as MappingType
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from fixedpipe.pipeline.columns.combiners import arithmetic_of, read_components
from fixedpipe.pipeline.enums import Mapping, MuxSelect, Register
from fixedpipe.pipeline.notations.register_combiner_words import REGISTER_NAMES
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import RegisterCombiners
from fixedpipe.raster.columns import combine as arithmetic
from fixedpipe.raster.columns import numbers

_CONSTANTS = Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1
_READ = (
    *(Register.PRIMARY_COLOR, Register.SECONDARY_COLOR, Register.FOG),
    *(Register.TEXTURE0, Register.TEXTURE1, Register.TEXTURE2, Register.TEXTURE3),
)


@dataclass(frozen=True)
class Bound:
    """The range of a register's component after a stage, 1.0 = full intensity.

    stage            "general combiner 0", "final combiner"
    register         "spare0.r"; for the final combiner "color.r"
    least, greatest  the range of its values
    below, above     the range without the clamp: if it is wider, the clamp may bite
    """

    stage: str
    register: str
    least: float
    greatest: float
    below: float
    above: float

    @property
    def clamps(self) -> bool:
        """Whether a clamp may bite."""
        return self.below < self.least or self.above > self.greatest


def combiner_bounds(
    program: RegisterCombiners,
    profile: Profile,
    ranges: MappingType[Register, tuple[float, float]] | None = None,
) -> tuple[Bound, ...]:
    """The Bounds of each general combiner's outputs, stage by stage, and of the final combiner's colour.

    program  as a machine of ``profile`` takes it
    ranges   {register: (least, greatest)} of registers that fragments bring, 1.0 = full intensity; the
             default is 0 to 1

    Raises ValueError for an empty range, and for combiner functions and lookups, which only the future board
    has.
    """
    a = arithmetic_of(profile, profile.arithmetic.combiner_bits)
    registers = _brought(ranges or {}, a)
    found: list[Bound] = []
    constants = program.constant_color0, program.constant_color1
    for number, stage in enumerate(program.general):
        if stage.lookup is not None or stage.rgb.function or stage.alpha.function:
            raise ValueError(
                f"Bounds exist for sums of products alone, and general combiner {number} has a function or a "
                "lookup of the future board."
            )
        own = stage.constant_color0, stage.constant_color1
        for register, color, common in zip(_CONSTANTS, own, constants, strict=True):
            registers[register] = _constant(common if color is None else color, a)
        rgb = _portion(stage.rgb, registers, False, program.mux_select, a)
        alpha = _portion(stage.alpha, registers, True, program.mux_select, a)
        for values, which in ((rgb, slice(0, 3)), (alpha, slice(3, 4))):
            for to, (kept, whole) in values.items():
                registers[to] = registers[to].copy()
                registers[to][which] = kept
                found += _bounds(f"general combiner {number}", to, which, kept, whole, a)
        for to, blue in (
            (stage.rgb.ab_output, stage.rgb.ab_blue_to_alpha),
            (stage.rgb.cd_output, stage.rgb.cd_blue_to_alpha),
        ):
            if blue and to != Register.DISCARD:
                registers[to] = registers[to][[0, 1, 2, 2]]
    for register, common in zip(_CONSTANTS, constants, strict=True):
        registers[register] = _constant(common, a)
    return (*found, *_final(program, registers, a))


def _constant(color, a):
    return np.repeat(numbers.fixed(color, a.one)[:, None], 2, axis=1).astype(np.int64)


def _brought(ranges, a):
    """Registers before the first combiner: (least, greatest) of each component, int64 [4, 2]."""
    registers = {
        Register.ZERO: np.zeros((4, 2), np.int64),
        Register.SPARE0: np.zeros((4, 2), np.int64),
        Register.SPARE1: np.zeros((4, 2), np.int64),
    }
    for register in _READ:
        least, greatest = ranges.get(register, (0.0, 1.0))
        if not -1.0 <= least <= greatest <= 1.0:
            raise ValueError(
                f"The range of {register.name} is {least} to {greatest}; give two numbers from -1 to 1, the "
                "lesser first."
            )
        codes = [int(np.floor(least * a.one)), int(np.ceil(greatest * a.one))]
        registers[register] = np.tile(np.array(codes, np.int64), (4, 1))
    if other := set(ranges) - set(_READ):
        raise ValueError(
            f"{next(iter(other)).name} gets no value before the combiners; give ranges of "
            f"{', '.join(register.name for register in _READ)}."
        )
    registers[Register.SPARE0][3] = registers[Register.TEXTURE0][3]
    return registers


def _steadily(function, x):
    """The range of a monotonic function over the ranges [..., 2]."""
    return np.sort(function(x), axis=-1)


def _product(x, y, same):
    """The range of the products of two ranges [c, 2]. ``same``: a value times itself."""
    if same:
        squares = x * x
        least = np.where((x[:, 0] <= 0) & (x[:, 1] >= 0), 0, squares.min(axis=-1))
        return np.stack([least, squares.max(axis=-1)], axis=-1)
    corners = np.stack([x[:, i] * y[:, j] for i, j in product((0, 1), repeat=2)])
    return np.stack([corners.min(axis=0), corners.max(axis=0)], axis=-1)


def _portion(portion, registers, alpha, select, a):
    """Register to (its range, its range without the clamp), int64 [3 or 1, 2] each."""
    outputs = portion.ab_output, portion.cd_output, portion.sum_output
    if all(output == Register.DISCARD for output in outputs):
        return {}
    variables = portion.a, portion.b, portion.c, portion.d
    mapped = [
        _steadily(lambda x, v=v: arithmetic.map_input(x, v.mapping, a), read_components(registers, v, alpha))
        for v in variables
    ]
    shape = 1 if alpha else 3, 2
    products = []
    for first, dots in ((0, not alpha and portion.ab_dot_product), (2, not alpha and portion.cd_dot_product)):
        x, y = (np.broadcast_to(mapped[k], shape) for k in (first, first + 1))
        one = [_product(x, y, variables[first] == variables[first + 1])]
        products.append(arithmetic.sum_of_three(one) if dots else one)
    free = replace(a, low=-arithmetic.FAR, high=arithmetic.FAR)

    def ranges(terms):
        return tuple(arithmetic.output(terms, portion.scale, bool(portion.bias), each) for each in (a, free))

    made = {}
    for output, terms in zip(outputs[:2], products, strict=True):
        if output != Register.DISCARD:
            made[output] = ranges(terms)
    if outputs[2] != Register.DISCARD:
        if portion.mux_sum:
            made[outputs[2]] = _muxed([ranges(terms) for terms in products], registers, select, a)
        else:
            made[outputs[2]] = ranges([term for terms in products for term in terms])
    return made


def _muxed(pair, registers, select, a):
    """The ranges of a mux: one product's if all of SPARE0's range selects it, else both together."""
    alpha = registers[Register.SPARE0][3]
    takes = arithmetic.takes_cd(alpha, select == MuxSelect.LSB, a)
    settled = alpha[0] == alpha[1] if select == MuxSelect.LSB else takes[0] == takes[1]
    if settled:
        return pair[int(takes[0])]
    (ab, ab_whole), (cd, cd_whole) = pair
    return tuple(
        np.stack([np.minimum(x[:, 0], y[:, 0]), np.maximum(x[:, 1], y[:, 1])], axis=-1)
        for x, y in ((ab, cd), (ab_whole, cd_whole))
    )


def _bounds(stage, register, which, kept, whole, a):
    names = [f"{REGISTER_NAMES[register]}.{component}" for component in "rgba"[which]]
    return _of_names(stage, names, kept, whole, a)


def _of_names(stage, names, kept, whole, a):
    return [
        Bound(stage, name, *(float(code) / a.one for code in (*held, *free)))
        for name, held, free in zip(names, kept.tolist(), whole.tolist(), strict=True)
    ]


def _final(program, registers, a):
    """The Bounds of the final combiner's colour."""
    final = program.final

    def value(variable, alpha=False):
        read = read_components(registers, variable, alpha)
        invert = variable.mapping == Mapping.UNSIGNED_INVERT
        return _steadily(lambda x: arithmetic.map_final(x, invert, a), read)

    nothing = np.zeros((1, 2), np.int64)
    if Register.E_TIMES_F in {v.register for v in (final.a, final.b, final.c, final.d)}:
        e, f = (np.broadcast_to(value(v), (3, 2)) for v in (final.e, final.f))
        made = numbers.quotient(_product(e, f, final.e == final.f), a.one)
        registers[Register.E_TIMES_F] = np.concatenate([made, nothing])
    terms = (
        (Register.SPARE0, program.invert_spare0),
        (Register.SECONDARY_COLOR, program.invert_secondary_color),
    )
    total = sum(
        _steadily(lambda x, invert=invert: arithmetic.map_final(x, invert, a), registers[register][:3])
        for register, invert in terms
    )
    if program.color_sum_clamp and a.clamps_sum:
        total = np.minimum(total, a.one)
    registers[Register.SPARE0_PLUS_SECONDARY_COLOR] = np.concatenate([total, nothing])
    weight, b, c, d = (np.broadcast_to(value(v), (3, 2)) for v in (final.a, final.b, final.c, final.d))
    alpha = value(final.g, alpha=True)

    def color(a):
        # Linear in the weight, and increasing in all other inputs.
        ends = [arithmetic.final_color(np.repeat(w[:, None], 2, axis=1), b, c, d, alpha, a) for w in weight.T]
        return np.stack([np.minimum(*ends)[:, 0], np.maximum(*ends)[:, 1]], axis=-1)

    names = [f"color.{component}" for component in "rgba"]
    return _of_names("final combiner", names, color(a), color(replace(a, clamps_final=False)), a)
