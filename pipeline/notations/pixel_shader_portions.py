"""The arithmetic pixel shader instructions that become given portions of general combiners."""

from dataclasses import replace
from itertools import product as combinations
from typing import NamedTuple

from fixedpipe.pipeline.enums import CombinerBias, CombinerFunction, Mapping, Register
from fixedpipe.pipeline.notations.equal_programs import is_zero, outputs
from fixedpipe.pipeline.notations.pixel_shader_combiners import NEGATED, REGISTERS
from fixedpipe.pipeline.notations.pixel_shader_operands import Operands, Said, UnsayableError
from fixedpipe.pipeline.state import CombinerInput

_CONDITION = (Said("", "r0", "", "a"),)
_DESTINATIONS = frozenset(REGISTERS.values())


class Instruction(NamedTuple):
    """An instruction of one half.

    - ``sources``: the wordings of each source.
    - ``reads``: its inputs, in the order in which the reader of pixel shaders meets them, each with whether
      the instruction clamps it itself, as lrp does with its factor.
    """

    name: str
    sources: tuple[tuple[Said, ...], ...]
    reads: tuple[tuple[CombinerInput, bool], ...]
    scale: object
    destination: Register


def is_one(given: CombinerInput) -> bool:
    """Whether an input is 1."""
    return given.register is Register.ZERO and given.mapping is Mapping.UNSIGNED_INVERT


def _is_minus_one(given):
    return given.register is Register.ZERO and given.mapping is Mapping.EXPAND_NORMAL


def said_times(operands, number, half, a, b):
    """The wordings of a * b where b is 1, or -1 if a's mapping has no negation; empty for any other b."""
    if is_one(b):
        return operands.sources(number, half, a)
    if _is_minus_one(b) and a.mapping not in NEGATED:
        return tuple(s.negated() for s in operands.sources(number, half, a) if s.sign == "")
    return ()


def instructions(operands: Operands, number: int, half: str, portion) -> list[Instruction]:
    """The instructions that a portion may be, the best first.

    ``half`` is "rgb" or "a" of general combiner ``number``. Raises UnsayableError where there is none.
    """
    portion = portion if operands.exact else _simpler(portion)
    _refuse_what_has_no_words(portion)
    ((which, destination),) = outputs(portion)
    found, reason = [], None
    for arranged in [portion] if operands.exact else _arrangements(portion):
        try:
            for name, sources, reads in _shapes(operands, number, half, arranged, which):
                if all(sources):
                    found.append(Instruction(name, tuple(sources), tuple(reads), portion.scale, destination))
        except UnsayableError as error:
            reason = reason or error
    if not found:
        raise reason or UnsayableError(_shape_in_words(portion, which))
    return found


def _simpler(portion):
    """The portion without a product of ZERO beside another; its only product becomes AB."""
    names = [name for name, _ in outputs(portion)]
    nothing = CombinerInput(usage=portion.c.usage)
    if names == ["sum"] and not portion.mux_sum:
        for first, second, which in (("c", "d", "ab"), ("a", "b", "cd")):
            if is_zero(getattr(portion, first), getattr(portion, second)):
                given = {f"{which}_output": portion.sum_output, "sum_output": Register.DISCARD}
                return _simpler(replace(portion, **given))
    if names == ["cd"]:
        dots = {}
        if hasattr(portion, "cd_dot_product"):
            dots = {"ab_dot_product": portion.cd_dot_product, "ab_blue_to_alpha": portion.cd_blue_to_alpha}
            dots |= {"cd_dot_product": False, "cd_blue_to_alpha": False}
        given = {"a": portion.c, "b": portion.d, "ab_output": portion.cd_output}
        return _simpler(replace(portion, **given, **dots, cd_output=Register.DISCARD))
    if names == ["ab"]:
        unused = {"cd_dot_product": False} if hasattr(portion, "cd_dot_product") else {}
        return replace(portion, c=nothing, d=nothing, mux_sum=False, **unused)
    return portion


def _refuse_what_has_no_words(portion):
    kept = outputs(portion)
    if len(kept) > 1:
        words = " and ".join(f"{name.upper() if name != 'sum' else name} to {r.name}" for name, r in kept)
        raise UnsayableError(f"it writes {len(kept)} registers ({words}), where an instruction writes one")
    if kept[0][1] not in _DESTINATIONS:
        raise UnsayableError(f"it writes {kept[0][1].name}")
    if kept[0][0] == "cd":
        raise UnsayableError("its result is the product CD")
    if portion.bias is not CombinerBias.NONE:
        raise UnsayableError(f"it has {portion.bias.name}")
    if portion.function is not CombinerFunction.NONE:
        raise UnsayableError(f"it computes {portion.function.name}")
    dots = getattr(portion, "ab_dot_product", False), getattr(portion, "cd_dot_product", False)
    if any(dots) and kept[0][0] == "sum":
        raise UnsayableError("it has a sum or mux of a dot product, which dp3 writes alone")
    if dots[1] or getattr(portion, "cd_blue_to_alpha", False):
        raise UnsayableError("CD is a dot product or goes to alpha")


def _arrangements(portion):
    """The portion with factors, and products of a sum, exchanged."""
    for products, ab, cd in combinations((False, True), repeat=3):
        if products and (portion.mux_sum or portion.sum_output is Register.DISCARD):
            continue
        first, second = (portion.a, portion.b), (portion.c, portion.d)
        if products:
            first, second = second, first
        (a, b), (c, d) = first[:: -1 if ab else 1], second[:: -1 if cd else 1]
        yield replace(portion, a=a, b=b, c=c, d=d)


def _shapes(operands, number, half, portion, which):
    """(name, sources, reads) of the instructions that have a portion's shape."""
    a, b, c, d = portion.a, portion.b, portion.c, portion.d

    def said(given):
        return operands.sources(number, half, given)

    def times(first, second):
        return said_times(operands, number, half, first, second)

    if which == "ab":
        if getattr(portion, "ab_dot_product", False):
            yield "dp3", (said(a), said(b)), ((a, False), (b, False))
            return
        yield "mov", (times(a, b),), ((a, False),)
        yield "mul", (said(a), said(b)), ((a, False), (b, False))
        return
    if portion.mux_sum:
        yield "cnd", (_CONDITION, times(c, d), times(a, b)), ((c, False), (a, False))
        return
    if b == d and operands.are_parts(number, a, c):
        yield "mov", (times(a, b),), ((a, False), (c, False))
    if (b == d and operands.are_parts(number, a, c)) or (a == c and operands.are_parts(number, b, d)):
        yield "mul", (said(a), said(b)), ((a, False), (b, False), (c, False), (d, False))
        return
    if _complementary(a, c):
        factor = tuple(s for s in said(a) if not s.modifier and s.sign != "-")
        yield "lrp", (factor, said(b), said(d)), ((a, True), (c, True), (b, False), (d, False))
    if is_one(d):
        negative = tuple(s.negated() for s in said(c) if s.sign == "-")
        yield "sub", (times(a, b), negative), ((a, False), (c, False))
    if _is_minus_one(d) and c.mapping not in NEGATED:
        yield "sub", (times(a, b), tuple(s for s in said(c) if s.sign != "-")), ((a, False), (c, False))
    yield "add", (times(a, b), times(c, d)), ((a, False), (c, False))
    yield "mad", (said(a), said(b), times(c, d)), ((a, False), (b, False), (c, False))


def _complementary(a, c):
    """Whether the first factors of two products are x, clamped to [0, 1], and 1 - x."""
    mappings = {a.mapping, c.mapping}
    return (a.register, a.usage, a.meaning) == (c.register, c.usage, c.meaning) and mappings == {
        Mapping.UNSIGNED_IDENTITY,
        Mapping.UNSIGNED_INVERT,
    }


def _shape_in_words(portion, which):
    if which == "sum" and portion.mux_sum:
        return "it has a mux of products, where cnd chooses between two registers"
    if which == "sum":
        return "it has a sum of two products of two factors, where mad has one, and lrp x and 1 - x"
    return "it has a factor that no register or constant stands for"
