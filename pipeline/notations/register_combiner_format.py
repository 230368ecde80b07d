"""Writes register combiners as ``!!RC1.0`` programs, which ``register_combiners`` reads back."""

from decimal import Decimal
from math import isfinite

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, ComponentUsage, Mapping, Register
from fixedpipe.pipeline.notations.register_combiner_words import (
    BLACK,
    MAX_GENERAL_COMBINERS,
    ONE_INPUTS,
    REGISTER_NAMES,
    SCALE_WORDS,
    UNUSED_ALPHA,
    UNUSED_RGB,
    UNUSED_STAGE,
    ZERO_INPUTS,
    format_input,
)
from fixedpipe.pipeline.programs.combiner_rules import combiner_problems
from fixedpipe.pipeline.state import RegisterCombiners


def _format_color(name, color):
    if not all(isfinite(component) for component in color):
        raise ValueError(f"{name} is {color}; a program holds finite numbers. Give four of them.")
    # Decimal writes the shortest digits that read back as the same float, and never an exponent.
    return f"{name} = ({', '.join(format(Decimal(repr(float(c))), 'f').removesuffix('.0') for c in color)});"


def _format_portion(name, portion, unused):
    if portion == unused:
        return []
    usage = unused.a.usage
    lines = []

    def product(output, first, second, dot):
        left = format_input(first, usage, Mapping.SIGNED_IDENTITY)
        right = format_input(second, usage, Mapping.SIGNED_IDENTITY)
        value = left if second == ONE_INPUTS[usage] and not dot else f"{left} {'.' if dot else '*'} {right}"
        lines.append(f"{REGISTER_NAMES[output]} = {value};")

    ab_dot, cd_dot = (portion.ab_dot_product, portion.cd_dot_product) if name == "rgb" else (False, False)
    product(portion.ab_output, portion.a, portion.b, ab_dot)
    summed = portion.sum_output is not Register.DISCARD or portion.mux_sum
    if (
        summed
        or cd_dot
        or (portion.c, portion.d, portion.cd_output) != (unused.c, unused.d, Register.DISCARD)
    ):
        product(portion.cd_output, portion.c, portion.d, cd_dot)
    if summed:
        lines.append(f"{REGISTER_NAMES[portion.sum_output]} = {'mux' if portion.mux_sum else 'sum'}();")
    if (portion.scale, portion.bias) != (CombinerScale.NONE, CombinerBias.NONE):
        lines.append(f"{SCALE_WORDS[portion.scale, portion.bias]}();")
    return [f"  {name} {{", *(f"    {line}" for line in lines), "  }"]


def _format_stage(stage):
    lines = ["{"]
    for name, color in (("const0", stage.constant_color0), ("const1", stage.constant_color1)):
        if color is not None:
            lines.append("  " + _format_color(name, color))
    # Every general combiner has a portion; an unused one shows its zeros.
    portions = _format_portion("rgb", stage.rgb, UNUSED_RGB) + _format_portion(
        "alpha", stage.alpha, UNUSED_ALPHA
    )
    return [*lines, *(portions or ["  rgb {", "    discard = unsigned(zero) * unsigned(zero);", "  }"]), "}"]


def _format_out_rgb(final):
    zero, one = ZERO_INPUTS[ComponentUsage.RGB], ONE_INPUTS[ComponentUsage.RGB]
    a, b, c, d = (
        format_input(i, ComponentUsage.RGB, Mapping.UNSIGNED_IDENTITY)
        for i in (final.a, final.b, final.c, final.d)
    )
    if final.a == final.b == final.c == zero:
        return d
    plus_d = "" if final.d == zero else f" + {d}"
    if final.c != zero:
        return f"lerp({a}, {b}, {c}){plus_d}"
    if plus_d and final.b == one:
        return f"{a}{plus_d}"
    return f"{a} * {b}{plus_d}"


def _format_final(final, clamp):
    zero, lines = ZERO_INPUTS[ComponentUsage.RGB], []
    rgb = (final.a, final.b, final.c, final.d)
    product_is_read = any(given.register is Register.E_TIMES_F for given in rgb)
    if product_is_read or (final.e, final.f) != (zero, zero):
        e, f = (format_input(i, ComponentUsage.RGB, Mapping.UNSIGNED_IDENTITY) for i in (final.e, final.f))
        lines.append(f"final_product = {e} * {f};")
    if clamp:
        lines.append("clamp_color_sum();")
    black = rgb == (zero, zero, zero, zero)
    transparent = final.g == ZERO_INPUTS[ComponentUsage.ALPHA]
    if not black or transparent:
        lines.append(f"out.rgb = {_format_out_rgb(final)};")
    if not transparent:
        lines.append(f"out.a = {format_input(final.g, ComponentUsage.ALPHA, Mapping.UNSIGNED_IDENTITY)};")
    return lines


def _without_a_word(combiners):
    """The first field that a machine adds to NV_register_combiners and the combiners use, or None."""
    initial = RegisterCombiners()
    for name in ("mux_select", "invert_spare0", "invert_secondary_color"):
        if getattr(combiners, name) != getattr(initial, name):
            return name
    for stage in combiners.general:
        if stage.lookup is not None:
            return "lookup"
        for portion, plain in ((stage.rgb, UNUSED_RGB), (stage.alpha, UNUSED_ALPHA)):
            for name in ("ab_blue_to_alpha", "cd_blue_to_alpha", "function"):
                if getattr(portion, name, None) != getattr(plain, name, None):
                    return name
    return None


def format_program(combiners: RegisterCombiners) -> str:
    """The canonical ``!!RC1.0`` program of register combiners; ``parse`` reads it back as equal ones.

    Raises ValueError with a sentence for ``combiners`` that no program can express: no general combiner or
    more than eight, a constant that is not finite, or combinations that NV_register_combiners forbids.
    """
    if not 1 <= len(combiners.general) <= MAX_GENERAL_COMBINERS:
        raise ValueError(
            f"A program has 1 to {MAX_GENERAL_COMBINERS} general combiners; these register combiners have "
            f"{len(combiners.general)}. Split them into passes."
        )
    for _, sentence in combiner_problems(combiners):
        raise ValueError(sentence)
    if without_a_word := _without_a_word(combiners):
        raise ValueError(f"The notation has no word for {without_a_word}; keep these combiners as state.")
    lines = ["!!RC1.0"]
    for name, color in (("const0", combiners.constant_color0), ("const1", combiners.constant_color1)):
        if color != BLACK:
            lines.append(_format_color(name, color))
    if combiners.general != (UNUSED_STAGE,):
        for stage in combiners.general:
            lines += _format_stage(stage)
    lines += _format_final(combiners.final, combiners.color_sum_clamp)
    return "\n".join(lines) + "\n"
