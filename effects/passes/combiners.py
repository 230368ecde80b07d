"""The vocabulary in which techniques write register combiners, so that a program reads as the paper's
equation.

Eq. 1 of Kautz and Seidel, k_s (1 - (h.t/ax)^2 - (h.b/ay)^2)+, is

    h, x, y = expand(PRIMARY), signed(SPARE0), signed(SPARE1)
    program(
        scaled(4, both(dot(expand(TEXTURE0), h, to=SPARE0), dot(expand(TEXTURE1), h, to=SPARE1))),
        total(square(x), square(y), to=SPARE0),
        final(one_minus(SPARE0), product(CONSTANT0, alpha_of(TEXTURE0))),
        constant0=specular,
    )

Inputs are registers, or results of ``expand``, ``signed``, ``negated``, ``one_minus``, ``alpha_of`` and
``blue_of``. A register by itself is read as (.)+, UNSIGNED_IDENTITY; in ``!!RC1.0`` it would keep its sign.
``ZERO`` and ``ONE`` are inputs.

One product is ``product``, ``dot`` or ``square``. Two products are a portion, the RGB or the alpha half of a
general combiner: ``both`` keeps them apart, ``total`` adds them. ``scaled`` and ``less_half`` apply to a
portion. The same functions make either half. In a stage's alpha half, a register means its alpha.
``square_root``, ``exponential`` and ``quotient`` belong to the future board (docs/numbers.md, section 20).

A ``stage`` is a general combiner, ``final`` and ``shown`` are final ones, and a ``program`` is made of both.

The functions raise ValueError for inputs that they cannot take. Validation refuses what a machine lacks.

Source: NV_register_combiners, section 3.8.12.
"""

from dataclasses import replace

from fixedpipe.effects.passes.arguments import checked_rgb, one_of
from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    ComponentUsage,
    Mapping,
    Register,
)
from fixedpipe.pipeline.messages import shown as in_words
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    CombinerLookup,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)

TEXTURE0, TEXTURE1 = Register.TEXTURE0, Register.TEXTURE1
TEXTURE2, TEXTURE3 = Register.TEXTURE2, Register.TEXTURE3
PRIMARY, SECONDARY = Register.PRIMARY_COLOR, Register.SECONDARY_COLOR
SPARE0, SPARE1 = Register.SPARE0, Register.SPARE1
CONSTANT0, CONSTANT1 = Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1
DISCARD = Register.DISCARD

ZERO = CombinerInput()
ONE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
# A portion that writes nothing.
NOTHING = RGBPortion(a=ZERO, sum_output=DISCARD)

_SCALES = {
    0.5: CombinerScale.SCALE_BY_ONE_HALF,
    1: CombinerScale.NONE,
    2: CombinerScale.SCALE_BY_TWO,
    4: CombinerScale.SCALE_BY_FOUR,
}


# ------------------------------------------------------------------------------------------------ inputs


# What is read as an input, by its class.
_INPUTS = {CombinerInput: lambda given: given, Register: CombinerInput}


def _input(value):
    if type(value) not in _INPUTS:
        raise ValueError(
            f"{in_words(value)} is no input; give a register, SPARE0 for instance, or what expand, signed, "
            "negated, one_minus, alpha_of and blue_of make of one."
        )
    return _INPUTS[type(value)](value)


def _output(register):
    """A register as it is. Raises ValueError for what is none."""
    if not isinstance(register, Register):
        raise ValueError(f"{in_words(register)} is no register to write; give SPARE0, DISCARD or another.")
    return register


def _mapped(word, value, mappings):
    """An input through the mapping that ``mappings`` has for its own."""
    value = _input(value)
    if value.mapping not in mappings:
        raise ValueError(
            f"{word} has no mapping for a register read as {value.mapping.name}; give one read as "
            f"{' or '.join(mapping.name for mapping in mappings)}."
        )
    return replace(value, mapping=mappings[value.mapping])


def expand(register):
    """2 r - 1: a register as a vector, EXPAND_NORMAL."""
    return _mapped("expand", register, {Mapping.UNSIGNED_IDENTITY: Mapping.EXPAND_NORMAL})


def signed(register):
    """r with its sign, SIGNED_IDENTITY."""
    return _mapped("signed", register, {Mapping.UNSIGNED_IDENTITY: Mapping.SIGNED_IDENTITY})


def negated(register):
    """-r, SIGNED_NEGATE; of ``expand(r)`` 1 - 2 r, EXPAND_NEGATE."""
    signs = {
        Mapping.UNSIGNED_IDENTITY: Mapping.SIGNED_NEGATE,
        Mapping.SIGNED_IDENTITY: Mapping.SIGNED_NEGATE,
        Mapping.EXPAND_NORMAL: Mapping.EXPAND_NEGATE,
    }
    return _mapped("negated", register, signs)


def one_minus(register):
    """1 - r of r in [0, 1], UNSIGNED_INVERT."""
    return _mapped("one_minus", register, {Mapping.UNSIGNED_IDENTITY: Mapping.UNSIGNED_INVERT})


def alpha_of(register):
    """A register's alpha, replicated to RGB."""
    return replace(_input(register), usage=ComponentUsage.ALPHA)


def blue_of(register):
    """A register's blue as an alpha: so an alpha portion reads a dot product."""
    return replace(_input(register), usage=ComponentUsage.BLUE)


# ---------------------------------------------------------------------------------------------- products


def product(a, b, to=DISCARD):
    """a b, to a register; without one for ``total`` and its like."""
    return RGBPortion(a=_input(a), b=_input(b), ab_output=_output(to), sum_output=DISCARD)


def square(a, to=DISCARD):
    """a a, to a register."""
    return product(a, a, to)


def dot(a, b, to=DISCARD):
    """a.b in red, green and blue, to a register. Not in an alpha half."""
    return replace(product(a, b, to), ab_dot_product=True)


def _portion(value):
    """A portion as it is. Raises ValueError for what is none."""
    if not isinstance(value, RGBPortion):
        raise ValueError(
            f"{in_words(value)} is no portion; give what product, dot, square, both, total or gate makes."
        )
    return value


def _one_product(value):
    """A product as it is. Raises ValueError for what is none, or more than one."""
    value = _portion(value)
    plain = replace(product(value.a, value.b, value.ab_output), ab_dot_product=value.ab_dot_product)
    if value != plain:
        raise ValueError(
            f"{in_words(value)} is more than one product; scale, add and halve the portion, not its products."
        )
    return value


def gate(register):
    """min(1, 4 b) of a register's blue, to its alpha: the alpha half that limits later passes to where (n.l)+
    is not zero.
    """
    return scaled(4, product(blue_of(register), ONE, to=register))


# ---------------------------------------------------------------------------------------------- portions


def both(first, second):
    """Two products, each to its own register."""
    first, second = _one_product(first), _one_product(second)
    return replace(
        first, c=second.a, d=second.b, cd_dot_product=second.ab_dot_product, cd_output=second.ab_output
    )


def total(*terms, to):
    """The sum of one or two terms, products or inputs, to a register."""
    if not 1 <= len(terms) <= 2:
        raise ValueError(f"A portion adds two products at most, not {len(terms)} terms; use more stages.")
    products = [term if isinstance(term, RGBPortion) else product(term, ONE) for term in terms]
    return replace(both(*products) if len(products) == 2 else products[0], sum_output=_output(to))


def square_root(*terms, to):
    """The square root of the terms' sum, on the future board."""
    return replace(total(*terms, to=to), function=CombinerFunction.SQUARE_ROOT)


def exponential(*terms, to):
    """The exponential function of the terms' sum, on the future board."""
    return replace(total(*terms, to=to), function=CombinerFunction.EXPONENTIAL)


def quotient(dividend, divisor, to):
    """One term over another, on the future board."""
    return replace(total(dividend, divisor, to=to), function=CombinerFunction.DIVIDE)


def _unscaled(portion):
    """A portion as it is. Raises ValueError for one that is scaled: its scale is the last of what is done."""
    if _portion(portion).scale is not CombinerScale.NONE:
        raise ValueError(
            f"The portion has {portion.scale.name} already; scale once, with the whole factor, and take the "
            "half off before."
        )
    return portion


def scaled(factor, portion):
    """All that a portion writes times 1/2, 1, 2 or 4."""
    scale = _SCALES[one_of(tuple(_SCALES), factor, "The scale of a portion")]
    return replace(_unscaled(portion), scale=scale)


def less_half(portion):
    """Subtract 1/2 from all outputs of a portion, once. The portion must not be scaled yet, because bias
    comes first.
    """
    if _unscaled(portion).bias is not CombinerBias.NONE:
        raise ValueError(
            "The portion is less a half already; a combiner has one bias. Give a stage the other."
        )
    return replace(portion, bias=CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF)


# ---------------------------------------------------------------------------------------------- programs


def opaque(color):
    """RGB in [0, 1] as a combiner constant with alpha one."""
    return (*checked_rgb(color), 1.0)


def _of_alpha(value):
    """An input of an alpha half: alpha where nothing else is asked for."""
    value = _input(value)
    return alpha_of(value) if value.usage is ComponentUsage.RGB else value


def _alpha_half(portion):
    portion = _portion(portion)
    if portion.ab_dot_product or portion.cd_dot_product:
        raise ValueError("An alpha half has no dot product; take blue_of one that the RGB half made.")
    return AlphaPortion(
        *map(_of_alpha, (portion.a, portion.b, portion.c, portion.d)),
        ab_output=portion.ab_output,
        cd_output=portion.cd_output,
        sum_output=portion.sum_output,
        scale=portion.scale,
        bias=portion.bias,
        function=portion.function,
    )


def stage(rgb=NOTHING, alpha=NOTHING, constant0=None, constant1=None, lookup=None):
    """A general combiner of two portions.

    Parameters
    ----------
    rgb, alpha
        What the words for portions make.
    constant0, constant1
        Its own constants, RGBA; None: the program's.
    lookup : int or None
        On the future board: the texture unit that is then looked up at SPARE0's red, green and blue.
    """
    lookup = None if lookup is None else CombinerLookup(lookup)
    return GeneralCombiner(_portion(rgb), _alpha_half(alpha), constant0, constant1, lookup)


def final(a, b=ONE, *, plus=ZERO, alpha=ONE):
    """The final combiner with a b + ``plus`` in [0, 1] as its colour, and ``alpha``.

    One of the three may be a ``product`` or a ``square``, E times F; the same product may be used several
    times. Raises ValueError for two different products.
    """
    products = dict.fromkeys(value for value in (a, b, plus) if isinstance(value, RGBPortion))
    if len(products) > 1 or any(value != product(value.a, value.b) for value in products):
        raise ValueError(
            "A final combiner has one plain product beside A B, E times F; compute in a general combiner "
            f"what is more of {' and '.join(map(in_words, products))}."
        )
    a, b, plus = (Register.E_TIMES_F if isinstance(value, RGBPortion) else value for value in (a, b, plus))
    e, f = next(((value.a, value.b) for value in products), (ZERO, ZERO))
    return FinalCombiner(_input(a), _input(b), ZERO, _input(plus), e, f, _of_alpha(alpha))


def shown(rgb, alpha=ONE):
    """The final combiner that gives one input, by its D: no product takes part."""
    return final(ZERO, ZERO, plus=rgb, alpha=alpha)


def program(*combiners, constant0=None, constant1=None):
    """Register combiners: general ones in their order, then the final one.

    ``combiners``: a single portion is a stage whose alpha half writes nothing; an empty program gets a stage
    that does nothing. ``constant0``, ``constant1``: RGB in [0, 1], with an alpha of one; None: zero.
    """
    if not combiners or not isinstance(combiners[-1], FinalCombiner):
        last = in_words(combiners[-1]) if combiners else "nothing"
        raise ValueError(f"A program ends with its final combiner, not with {last}; add final or shown.")
    *general, last = combiners
    general = tuple(given if isinstance(given, GeneralCombiner) else stage(given) for given in general)
    constants = ((0.0, 0.0, 0.0, 0.0) if c is None else opaque(c) for c in (constant0, constant1))
    return RegisterCombiners(general or (stage(),), last, *constants)


def constant_product(factor, constant):
    """Combiners that give ``factor`` times RGB ``constant`` in [0, 1]."""
    return program(final(factor, CONSTANT0), constant0=constant)
