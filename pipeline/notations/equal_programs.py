"""When two programs are equal on every machine, though their states are spelled differently.

A pixel shader has one spelling for each thing; other notations have several. These count as equal, and
nothing else does:

- Factors of a product, and the two products of a sum, in either order. Source: NV_register_combiners; sums
  are exact before they are rounded, or each product is rounded alone (numbers.md, N8.3).
- A sum with a product of ZERO, or of a constant of zeros, and the other product alone.
- ZERO, and a constant of zeros; a constant, and another register's or combiner's with the same numbers.
- UNSIGNED_IDENTITY and SIGNED_IDENTITY of values that are never negative: constants, the primary and the
  secondary color and the coordinates of PASS_THROUGH, until a combiner writes them. A texture may have signed
  components, so a texel is not one of these.
- Everything that nothing reads: discarded outputs, a combiner without outputs, constants, products E * F, the
  color sum's clamp, trailing texture units without operation, fields of a stage that its operation ignores.
- Meanings (``CombinerInput.meaning``), which machines ignore.

The matrix, scale and bias of an offset texture are not compared, because a pixel shader's application sets
them.
"""

from fixedpipe.pipeline.enums import (
    ComponentUsage,
    DotProductMapping,
    Mapping,
    MuxSelect,
    Register,
    TextureShaderOperation,
)
from fixedpipe.pipeline.programs.texture_shader_rules import DEPENDENT
from fixedpipe.pipeline.state import CombinerInput, RegisterCombiners, TextureShaderStage

CONSTANTS = (Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1)
_IDENTITIES = (Mapping.UNSIGNED_IDENTITY, Mapping.SIGNED_IDENTITY)
_ZEROS = ((0.0,), (0.0,) * 3)
_COLORS = (Register.PRIMARY_COLOR, Register.SECONDARY_COLOR)


def half_of(usage: ComponentUsage) -> str:
    """The half of a register that an input reads, "rgb" or "a"."""
    return "a" if usage is ComponentUsage.ALPHA else "rgb"


def constant_color(combiners: RegisterCombiners, number: int, register: Register) -> tuple[float, ...]:
    """The value of a constant register in general combiner ``number``: four numbers in [0, 1]."""
    place = CONSTANTS.index(register)
    color = getattr(combiners.general[number], f"constant_color{place}")
    if color is None:
        color = (combiners.constant_color0, combiners.constant_color1)[place]
    return tuple(min(max(component, 0.0), 1.0) for component in color)


def never_negative(stages: tuple[TextureShaderStage, ...] | None) -> set[tuple[Register, str]]:
    """The (register, half) pairs that hold nothing negative before the first general combiner."""
    found = {(register, half) for register in _COLORS for half in ("rgb", "a")}
    for unit, stage in enumerate(stages or ()):
        if stage.operation is TextureShaderOperation.PASS_THROUGH:
            found |= {(Register(Register.TEXTURE0 + unit), half) for half in ("rgb", "a")}
    return found


def is_zero(first: CombinerInput, second: CombinerInput) -> bool:
    """Whether a product has ZERO, mapped to 0, as a factor."""
    return any(given.register is Register.ZERO and given.mapping in _IDENTITIES for given in (first, second))


def outputs(portion) -> tuple[tuple[str, Register], ...]:
    """(name, register) of a portion's outputs that are kept; the names are "ab", "cd" and "sum"."""
    given = (("ab", portion.ab_output), ("cd", portion.cd_output), ("sum", portion.sum_output))
    return tuple((name, register) for name, register in given if register is not Register.DISCARD)


def plain_combiners(combiners: RegisterCombiners, stages=None):
    """The results of register combiners as tuples, which are equal where machines compute the same.

    ``stages`` are those of the texture shader before them, or None.
    """
    positive, general, muxes = never_negative(stages), [], False
    for number, stage in enumerate(combiners.general):
        results, written = [], set()
        for half, portion in (("rgb", stage.rgb), ("a", stage.alpha)):
            plain = _plain_portion(combiners, number, half, portion, positive)
            results.append(plain)
            muxes |= any("mux" in result for result in plain)
            written |= {(register, half) for _, register in outputs(portion)}
            for which in ("ab", "cd"):
                if getattr(portion, f"{which}_blue_to_alpha", False):
                    written.add((getattr(portion, f"{which}_output"), "a"))
        positive -= written
        if any(results):
            general.append((tuple(results), stage.lookup))
    select = combiners.mux_select if muxes else MuxSelect.MSB
    return tuple(general), select, plain_final(combiners)


def _plain_portion(combiners, number, half, portion, positive):
    def read(given):
        mapping = given.mapping
        if given.register is Register.ZERO or given.register in CONSTANTS:
            color = (0.0,) * 4
            if given.register in CONSTANTS:
                color = constant_color(combiners, number, given.register)
            components = {ComponentUsage.ALPHA: color[3:], ComponentUsage.BLUE: color[2:3]}
            values = components.get(given.usage, color[:3] if half == "rgb" else color[2:3])
            what, sure = values * 3 if half == "rgb" and len(values) == 1 else values, True
        else:
            what, sure = (given.register, given.usage), (given.register, half_of(given.usage)) in positive
        return what, Mapping.SIGNED_IDENTITY if sure and mapping is Mapping.UNSIGNED_IDENTITY else mapping

    products = {}
    for which, factors in (("ab", (portion.a, portion.b)), ("cd", (portion.c, portion.d))):
        plain, dot = sorted(map(read, factors), key=repr), getattr(portion, f"{which}_dot_product", False)
        if not any(what in _ZEROS and mapping is Mapping.SIGNED_IDENTITY for what, mapping in plain):
            products[which] = (dot, *plain)
    results = []
    for which, register in outputs(portion):
        if which == "sum" and portion.mux_sum:
            value = ("mux", products.get("ab"), products.get("cd"))
        elif which == "sum":
            value = tuple(sorted(products.values(), key=repr))
        else:
            value = (products[which],) if which in products else ()
        blue = getattr(portion, f"{which}_blue_to_alpha", False)
        given = portion.scale, portion.bias, portion.function
        results.append((register, *value, *given, *(("blue to alpha",) if blue else ())))
    return tuple(sorted(results, key=repr))


def plain_final(combiners: RegisterCombiners):
    """The final combiner's result as a tuple, without the fields that it does not read."""
    final = combiners.final
    read = [final.a, final.b, final.c, final.d]
    given = [(i.register, i.mapping, None if i.register is Register.ZERO else i.usage) for i in read]
    registers = [i.register for i in read]
    product = (final.e, final.f) if Register.E_TIMES_F in registers else None
    own = None
    if Register.SPARE0_PLUS_SECONDARY_COLOR in registers:
        own = combiners.color_sum_clamp, combiners.invert_spare0, combiners.invert_secondary_color
    everything = (*read, *(product or ()), final.g)
    places = {CONSTANTS.index(i.register) for i in everything if i.register in CONSTANTS}
    constants = [(combiners.constant_color0, combiners.constant_color1)[place] for place in sorted(places)]
    return tuple(given), product, own, tuple(constants), (final.g.register, final.g.mapping, final.g.usage)


def plain_stages(stages: tuple[TextureShaderStage, ...] | None):
    """The effects of texture shader stages, from the fields that their operations read; () without any."""
    plain = []
    for stage in stages or ():
        operation = stage.operation
        dotted = operation.name.startswith("DOT_PRODUCT")
        earlier = dotted or operation in DEPENDENT
        plain.append(
            (
                operation,
                stage.previous_texture_input if earlier else None,
                stage.dot_product_mapping if dotted else DotProductMapping.UNSIGNED_IDENTITY,
                stage.cull_modes if operation is TextureShaderOperation.CULL_FRAGMENT else None,
                stage.constant_eye
                if operation is TextureShaderOperation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP
                else None,
                (stage.roughness, stage.roughness_scale) if stage.roughness is not None else None,
            )
        )
    while plain and plain[-1][0] is TextureShaderOperation.NONE:
        plain.pop()
    return tuple(plain)
