"""General combiners under construction from pixel shaders: their constants, operands and signs.

A constant's component is an exact number c in [-1, 1]: k/255, or the decimal in its text. A combiner holds
byte(s), where s is c's magnitude or, for colors of both signs, c + 128/255 or c/2 + 128/255. Byte(s) is
``floor(255 s + 1/2)``, at most 255, computed in exact numbers, with halves up. So -1, for which c/2 gives a
half between two bytes, is byte 1 and is read as -254/255, just as 1 is read as 254/255.

Source: docs/numbers.md, N8.10. Assumed: Direct3D's drivers rounded halves up too; a GeForce 3's picture of
``add r0, v0, c0`` with c0 of both signs and 1 in it would settle it.
"""

from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import inf, nextafter
from typing import NamedTuple

from fixedpipe.pipeline.enums import CombinerScale, ComponentUsage, Mapping, Register
from fixedpipe.pipeline.notations.register_combiner_words import UNUSED_ALPHA, UNUSED_RGB, constant_byte
from fixedpipe.pipeline.state import AlphaPortion, CombinerInput, GeneralCombiner, RGBPortion

RGB, ALPHA, BLUE = ComponentUsage.RGB, ComponentUsage.ALPHA, ComponentUsage.BLUE

REGISTERS = {
    ("r", 0): Register.SPARE0,
    ("r", 1): Register.SPARE1,
    ("v", 0): Register.PRIMARY_COLOR,
    ("v", 1): Register.SECONDARY_COLOR,
    ("t", 0): Register.TEXTURE0,
    ("t", 1): Register.TEXTURE1,
    ("t", 2): Register.TEXTURE2,
    ("t", 3): Register.TEXTURE3,
}
R0 = ("r", 0)
CONSTANTS = (Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1)
SCALES = {
    "": CombinerScale.NONE,
    "x2": CombinerScale.SCALE_BY_TWO,
    "x4": CombinerScale.SCALE_BY_FOUR,
    "d2": CombinerScale.SCALE_BY_ONE_HALF,
}
MAPPINGS = {
    ("", ""): Mapping.SIGNED_IDENTITY,
    ("-", ""): Mapping.SIGNED_NEGATE,
    ("", "bx2"): Mapping.EXPAND_NORMAL,
    ("-", "bx2"): Mapping.EXPAND_NEGATE,
    ("", "bias"): Mapping.HALF_BIAS_NORMAL,
    ("-", "bias"): Mapping.HALF_BIAS_NEGATE,
    ("1-", ""): Mapping.UNSIGNED_INVERT,
}
SIGNED = (Mapping.SIGNED_IDENTITY, Mapping.SIGNED_NEGATE)
# Mappings that turn one into 1 or -1.
ONE_OR_MINUS_ONE = (*SIGNED, Mapping.EXPAND_NORMAL, Mapping.EXPAND_NEGATE)
NEGATED = {
    Mapping.SIGNED_IDENTITY: Mapping.SIGNED_NEGATE,
    Mapping.EXPAND_NORMAL: Mapping.EXPAND_NEGATE,
    Mapping.HALF_BIAS_NORMAL: Mapping.HALF_BIAS_NEGATE,
}
NEGATED |= {negated: mapping for mapping, negated in NEGATED.items()}
# The mappings that replace SIGNED_IDENTITY and SIGNED_NEGATE for a constant of both signs, by the factor of
# the reading: the first for a constant near zero, the second, in even steps, for others.
READINGS = {
    1: {
        Mapping.SIGNED_IDENTITY: Mapping.HALF_BIAS_NORMAL,
        Mapping.SIGNED_NEGATE: Mapping.HALF_BIAS_NEGATE,
    },
    2: {Mapping.SIGNED_IDENTITY: Mapping.EXPAND_NORMAL, Mapping.SIGNED_NEGATE: Mapping.EXPAND_NEGATE},
}
_HALF = Fraction(128, 255)  # the amount that these mappings subtract


@dataclass
class Stage:
    """A general combiner under construction.

    - ``token``, ``says``: the first instruction, and the line and names of the instructions.
    - ``colors``: the colors of constants, by number or Part.
    - ``divides``: whether it reads only one color of constants, which may then use both registers.
    - ``places``: for each of the two constant registers, {half that is read, "rgb" or "a": the number of the
      program's constant, or a Part of one}.
    """

    token: object
    says: str
    colors: dict
    divides: bool = False
    rgb: RGBPortion | None = None
    alpha: AlphaPortion | None = None
    places: tuple[dict, dict] = field(default_factory=lambda: ({}, {}))

    def build(self):
        """The GeneralCombiner."""
        return GeneralCombiner(
            rgb=self.rgb or UNUSED_RGB,
            alpha=self.alpha or UNUSED_ALPHA,
            **constant_colors(self.places, self.colors),
        )

    def place(self, number, half):
        """The constant register, 0 or 1, that holds a half of constant ``number``; None: both are taken."""
        return _place(self.places, number, half)


def constant_colors(places, colors):
    """{field: color} of the state with the constant registers; ``places`` and ``colors`` are as in Stage."""
    found = {}
    for number, halves in enumerate(places):
        if halves:
            rgb = colors[halves.get("rgb", halves.get("a"))]
            alpha = colors[halves.get("a", halves.get("rgb"))]
            found[f"constant_color{number}"] = (*rgb[:3], alpha[3])
    return found


def _place(places, number, half):
    for fits in (
        lambda halves: halves.get(half) == number,
        lambda halves: number in halves.values() and half not in halves,
        lambda halves: not halves,
        lambda halves: half not in halves,
    ):
        for place, halves in enumerate(places):
            if fits(halves):
                halves[half] = number
                return place
    return None


def share_constants(stages):
    """Move the constants of all Stages to the program's own two registers; returns the new ``places``.

    The constants take a register's halves in the order of their numbers. Raises the notation's error where
    stages read more than two colors of constants, or more than two alphas.
    """
    places = {}, {}
    for half, name in (("rgb", "color"), ("a", "alpha")):
        reads = [(halves[half], stage) for stage in stages for halves in stage.places if half in halves]
        found = {key: stage for key, stage in reversed(reads)}
        keys = list(dict.fromkeys(key for key, _ in reads))
        if len(keys) > len(places):
            read = ", ".join(map(_in_words, keys))
            third = keys[len(places)]
            raise found[third].token.error(
                f"the {name} of {_in_words(third)} is the third of {len(keys)} constants that the program "
                f"reads ({read}), and the machine's general combiners share two. Read fewer, or choose a "
                "machine with per-stage constants."
            )
        for key in sorted(keys, key=_in_order):
            _place(places, key, half)
    for stage in stages:
        moved = {
            (register, half): CONSTANTS[_place(places, key, half)]
            for register, halves in zip(CONSTANTS, stage.places, strict=True)
            for half, key in halves.items()
        }
        stage.rgb, stage.alpha = (_moved(portion, moved) for portion in (stage.rgb, stage.alpha))
        stage.places = {}, {}
    return places


def _in_order(key):
    return (key.number, 1 + key.negative) if isinstance(key, Part) else (key, 0)


def _in_words(key):
    if isinstance(key, Part):
        return f"c{key.number} where it is {'negative' if key.negative else 'positive'}"
    return f"c{key}"


def _moved(portion, registers):
    """A portion with its constants in other registers, {(register, half): register}."""
    if portion is None:
        return None
    given = {name: getattr(portion, name) for name in "abcd"}
    return replace(
        portion,
        **{
            name: replace(i, register=registers[i.register, "a" if i.usage is ALPHA else "rgb"])
            for name, i in given.items()
            if i.register in CONSTANTS
        },
    )


class Part(NamedTuple):
    """The positive components of constant ``number``, or the magnitudes of the negative ones."""

    number: int
    negative: bool

    def stored(self, color):
        """The color that a combiner's constant holds for it."""
        sign = -1 if self.negative else 1
        color = exact(color)
        return tuple(map(held, (*(max(0, sign * value) for value in color[:3]), abs(color[3]))))


class Operand(NamedTuple):
    """An input, and whether its sign must still change because its mapping has no negation."""

    input: CombinerInput
    negated: bool = False


@dataclass
class Dot:
    """An alpha that is still in blue.

    - ``stage``: the general combiner of the dot product.
    - ``free_from``: the first general combiner that may write the register's own alpha.
    """

    stage: int
    free_from: int


def one_operand(half):
    """One, as an operand of a half, "rgb" or "a"."""
    return Operand(CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, RGB if half == "rgb" else ALPHA))


def exact(color):
    """A color's components in [-1, 1] as exact numbers: k/255, or a decimal."""
    found = []
    for value in color:
        value = float(max(-1.0, min(1.0, value)))
        byte = Fraction(round(255 * value), 255)
        found.append(byte if float(byte) == value else Fraction(repr(value)))
    return found


def byte_of(number):
    """The byte for an exact number, clamped to [0, 1]; halves go up."""
    return max(0, min(255, (510 * number + 1) // 2))


def held(number):
    """The float64 nearest to an exact number that a machine of bytes rounds to ``byte_of`` the number."""
    value, byte = float(number), byte_of(number)
    while constant_byte(value) != byte:
        value = nextafter(value, inf if constant_byte(value) < byte else -inf)
    return value


def of_both_signs(values):
    """Whether some components are negative and some positive."""
    return min(values) < 0 < max(values)


def reading(color):
    """The factor by which one input reads a color whose red, green and blue differ in sign.

    It is a key of READINGS. Factor 1 reaches from -128/255 to 127/255.
    """
    color = exact(color[:3])
    return 1 if 255 * min(color) >= -128 and 255 * max(color) <= 127 else 2


def stored(color):
    """The color in [0, 1] that a combiner's constant holds for a color in [-1, 1].

    It has magnitudes, for readers that negate. Where red, green and blue differ in sign, it has the numbers
    that their ``reading`` maps to them.
    """
    factor, numbers = reading(color), exact(color)
    magnitudes = [abs(number) for number in numbers]
    if of_both_signs(numbers[:3]):
        magnitudes[:3] = (number / factor + _HALF for number in numbers[:3])
    return tuple(map(held, magnitudes))


def worst_step(color):
    """(component, value in 1/255) of the worst input of a color of both signs; None where no input is off.

    An input is off if its error is larger than a byte's must be.
    """
    factor, worst = reading(color), None
    for k, number in enumerate(exact(color[:3])):
        found = factor * (byte_of(number / factor + _HALF) - 128)
        off = abs(found - 255 * number)
        if off > Fraction(1, 2) and (worst is None or off > worst[0]):
            worst = off, k, found
    return worst and worst[1:]


def copy_of_blue(register):
    """The alpha portion that copies a register's blue to its alpha. ``register``: letter and number."""
    given = REGISTERS[register]
    return AlphaPortion(
        a=CombinerInput(given, Mapping.SIGNED_IDENTITY, BLUE),
        ab_output=given,
        b=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, ALPHA),
        sum_output=Register.DISCARD,
    )


def compared(a, b):
    """The alpha portion for cmp's comparison of a product: SPARE0's alpha becomes half of it and one."""
    one = one_operand("a").input
    return AlphaPortion(
        a=a, b=b, c=one, d=one, sum_output=Register.SPARE0, scale=CombinerScale.SCALE_BY_ONE_HALF
    )


def sum_of_products(register, scale):
    """The portions, rgb and alpha, of dp4's second general combiner.

    They add the dot product in ``register``'s color and the product in its alpha.
    """
    portions = []
    for kind, usage, dot in ((RGBPortion, RGB, RGB), (AlphaPortion, ALPHA, BLUE)):
        one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, usage)
        a, c = (CombinerInput(register, Mapping.SIGNED_IDENTITY, u) for u in (dot, ALPHA))
        portions.append(kind(a=a, b=one, c=c, d=one, sum_output=register, scale=scale))
    return tuple(portions)


def product(instruction, first, second):
    """The two inputs of a product, with the pending sign of either applied."""
    a, b = first.input, second.input
    if first.negated == second.negated:
        return a, b
    if a.mapping in NEGATED:
        return replace(a, mapping=NEGATED[a.mapping]), b
    if b.mapping in NEGATED:
        return a, replace(b, mapping=NEGATED[b.mapping])
    if (b.register, b.mapping) == (Register.ZERO, Mapping.UNSIGNED_INVERT):
        # Minus one; where EXPAND_NORMAL takes 128 as one half, it is -256/255.
        return a, replace(b, mapping=Mapping.EXPAND_NORMAL)
    raise instruction.token.error(
        f"{instruction.name} of factors that the hardware cannot negate (1-, or what _sat wrote); negate "
        "one of them with mov first."
    )
