"""Fog, tests, blending, and what surfaces keep: docs/numbers.md, sections 9 and 10."""

import numpy as np

from fixedpipe.effects.arithmetic.rule import Rule, ordinary
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ColorFormat,
    ComparisonFunction,
    FogMode,
    LogicOperation,
    StencilOperation,
)
from fixedpipe.pipeline.framebuffers.framebuffer import surface_word
from fixedpipe.pipeline.state import Fog, FogRegisters
from fixedpipe.pipeline.vertices.fog import TABLE_SIZE, table, vertex_value
from fixedpipe.raster.columns import per_fragment
from fixedpipe.raster.columns.numbers import with_fog
from fixedpipe.raster.portable.per_fragment import any_equation

UNSIGNED = (0, 1, 2, 126, 127, 128, 129, 254, 255)


def _bytes(count):
    return lambda chance: tuple(chance.byte() for _ in range(count))


# --------------------------------------------------------------------------------------------------- fog

# By id: mode, whether both sides of 3/2 are alike, formula.
_TABLES = {
    "linear": (FogMode.LINEAR, False, "min(255, clamp(n - 4095, 0, 4096) * 255 >> 12)"),
    "exp": (FogMode.EXP, False, "between([255 * 2 ** (-j / 4) for j in range(33)], max(6144 - n, 0))"),
    "exp-abs": (FogMode.EXP, True, "between([255 * 2 ** (-j / 4) for j in range(33)], abs(6144 - n))"),
    "exp2": (FogMode.EXP2, True, "between([255 * 2 ** (-j * j / 128) for j in range(33)], abs(6144 - n))"),
}


def _fog_table(name, mode, folded, formula):
    entries = table(mode, folded)
    return Rule(
        id=f"fog-factor-{name}",
        stage="Fog",
        numbers="N9.5",
        formula=formula,
        evidence="Measured: Fog, Fog_vsh, Fog_param, Fog_exceptional_value: all pixels",
        captures=("Fog", "Fog_vsh", "Fog_param", "Fog_exceptional_value"),
        inputs={"n": "int"},
        output="int",
        compute=lambda n: entries[n],
        edges=tuple(
            (n,) for n in (0, 1, 2048, 4094, 4095, 4096, 4097, 4111, 4112, 6080, 6143, 6144, 6145, 8191, 8192)
        ),
        draw=lambda chance: (chance.below(TABLE_SIZE),),
    )


def _vertex_fog(mode, bias, multiplier, coordinate):
    registers = FogRegisters(bias=bias, multiplier=multiplier)
    with np.errstate(all="ignore"):
        return float(vertex_value(Fog(FogMode[mode], registers=registers), np.float64(coordinate)))


def _fog_line(chance):
    return (
        chance.one_of(("LINEAR", "EXP", "EXP2")),
        ordinary(chance, 3),
        ordinary(chance, 6),
        ordinary(chance),
    )


_INFINITE = float("inf")
FOG = (
    *(_fog_table(name, *rest) for name, rest in _TABLES.items()),
    Rule(
        id="fog-line",
        stage="Fog",
        numbers="N9.3",
        formula=(
            "c * multiplier + bias in the lighting unit's 14 bits; LINEAR: the product cut to 24 bits, the "
            "sum rounded up to 1/2^21"
        ),
        in_words=True,
        evidence="Measured: 9320 of 9320 squares of Fog_param, 44 of 44 captures of Fog_exceptional_value",
        captures=("Fog_param", "Fog_exceptional_value", "Fog_inf_coord"),
        inputs={"mode": "name", "bias": "single", "multiplier": "single", "c": "single"},
        output="double",
        compute=_vertex_fog,
        edges=tuple(
            (mode, bias, multiplier, c)
            for mode in ("LINEAR", "EXP", "EXP2")
            for bias, multiplier in ((1.0, 0.0), (1.5, -0.0625), (2.0, -0.25))
            for c in (0.0, 1.0, -1.0, 100.0, _INFINITE, -_INFINITE, float("nan"))
        ),
        draw=_fog_line,
    ),
    Rule(
        id="fog-blend",
        stage="Fog",
        numbers="N8.9",
        formula="rn(f * color + (255 - f) * fog)",
        evidence="Inferred: as the final combiner; the captures' programs blend fog there",
        captures=(),
        inputs={"f": "int", "color": "int", "fog": "int"},
        output="int",
        compute=lambda f, color, fog: with_fog(*(np.array([x]) for x in (color, fog, f)), 255)[0],
        edges=tuple((f, c, 255 - c) for f in UNSIGNED for c in UNSIGNED),
        draw=_bytes(3),
        open="final-lerp",
    ),
)

# ------------------------------------------------------------------------------------------------- tests

TESTS = (
    Rule(
        id="alpha-test",
        stage="Fragments",
        numbers="N10.1",
        formula="int(compare(alpha, function, reference))",
        evidence="Measured: LESS, GREATER, NOTEQUAL, GEQUAL: every pixel; Source: OpenGL 1.2.1: the others",
        captures=tuple(
            f"Alpha_func/AlphaFunc{name}_Enabled"
            for name in ("LessThan", "GreaterThan", "NotEqual", "GreaterThanOrEqual")
        ),
        inputs={"alpha": "int", "function": "name", "reference": "int"},
        output="int",
        compute=lambda alpha, function, reference: per_fragment.compare(
            ComparisonFunction[function], np.array([alpha]), reference
        )[0],
        edges=tuple(
            (alpha, function.name, reference)
            for function in ComparisonFunction
            for alpha, reference in ((0, 0), (127, 128), (128, 128), (129, 128), (255, 255), (255, 0))
        ),
        draw=lambda chance: (chance.byte(), chance.one_of(ComparisonFunction).name, chance.byte()),
    ),
    Rule(
        id="stencil-operation",
        stage="Fragments",
        numbers="N10.2",
        formula="INCR and DECR stay at 255 and 0; those with WRAP are modulo 256; INVERT is 255 - stored",
        in_words=True,
        evidence="Measured: 8 of 8 captures of Stencil_func",
        captures=("Stencil_func", "Stencil"),
        inputs={"operation": "name", "stored": "int", "reference": "int"},
        output="int",
        compute=lambda operation, stored, reference: per_fragment.stencil_result(
            StencilOperation[operation], np.array([stored]), reference
        )[0],
        edges=tuple(
            (operation.name, stored, 129)
            for operation in StencilOperation
            for stored in (0, 1, 128, 254, 255)
        ),
        draw=lambda chance: (chance.one_of(StencilOperation).name, chance.byte(), chance.byte()),
    ),
)

# ---------------------------------------------------------------------------------------------- blending

_FACTORS = {
    BlendFactor.ZERO: "[0] * 4",
    BlendFactor.ONE: "[255] * 4",
    BlendFactor.SRC_COLOR: "s",
    BlendFactor.ONE_MINUS_SRC_COLOR: "[255 - x for x in s]",
    BlendFactor.DST_COLOR: "d",
    BlendFactor.ONE_MINUS_DST_COLOR: "[255 - x for x in d]",
    BlendFactor.SRC_ALPHA: "[s[3]] * 4",
    BlendFactor.ONE_MINUS_SRC_ALPHA: "[255 - s[3]] * 4",
    BlendFactor.DST_ALPHA: "[d[3]] * 4",
    BlendFactor.ONE_MINUS_DST_ALPHA: "[255 - d[3]] * 4",
    BlendFactor.SRC_ALPHA_SATURATE: "[min(s[3], 255 - d[3])] * 3 + [255]",
    BlendFactor.CONSTANT_COLOR: "constant",
    BlendFactor.ONE_MINUS_CONSTANT_COLOR: "[255 - x for x in constant]",
    BlendFactor.CONSTANT_ALPHA: "[constant[3]] * 4",
    BlendFactor.ONE_MINUS_CONSTANT_ALPHA: "[255 - constant[3]] * 4",
}
_PROVEN = "Measured: 176504832 of 176504832 pixels"


def _factor(factor, formula):
    def compute(s, d, constant):
        source, destination, color = np.array([s]), np.array([d]), np.array(constant)
        found = per_fragment.blend_factor(factor, source, destination, color, 255)
        return np.broadcast_to(found, (1, 4))[0]

    return Rule(
        id=f"blend-factor-{factor.name.lower().replace('_', '-')}",
        stage="Blending",
        numbers="N10.3",
        formula=formula,
        evidence=_PROVEN,
        captures=("Blend_tests",),
        inputs={"s": "int[4]", "d": "int[4]", "constant": "int[4]"},
        output="int[4]",
        compute=compute,
        edges=(
            ([0, 1, 127, 128], [255, 254, 128, 127], [2, 126, 129, 253]),
            ([255] * 4, [0] * 4, [128] * 4),
            ([0] * 4, [255] * 4, [0] * 4),
        ),
        draw=lambda chance: (chance.color(), chance.color(), chance.color()),
    )


_EQUATIONS = {
    BlendEquation.FUNC_ADD: "clamp(rn(s * fs + d * fd), 0, 255)",
    BlendEquation.FUNC_SUBTRACT: "clamp(rn(s * fs - d * fd), 0, 255)",
    BlendEquation.FUNC_REVERSE_SUBTRACT: "clamp(rn(d * fd - s * fs), 0, 255)",
    BlendEquation.MIN: "min(s, d)",
    BlendEquation.MAX: "max(s, d)",
    BlendEquation.FUNC_ADD_SIGNED: "clamp(d + signed(s), 0, 255)",
    BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED: "clamp(d - signed(s), 0, 255)",
}


def _equation(equation, formula):
    return Rule(
        id=f"blend-{equation.name.lower().replace('_', '-')}",
        stage="Blending",
        numbers="N10.3",
        formula=formula,
        evidence=_PROVEN,
        captures=("Blend_tests", "Blend_surface") if equation == BlendEquation.FUNC_ADD else ("Blend_tests",),
        inputs={"s": "int", "fs": "int", "d": "int", "fd": "int"},
        output="int",
        compute=lambda s, fs, d, fd: any_equation(equation, *(np.int32(x) for x in (s, fs, d, fd, 8))),
        edges=tuple(
            (s, fs, d, 255 - fs) for s in UNSIGNED for fs in (0, 1, 127, 128, 255) for d in (0, 128, 255)
        ),
        draw=_bytes(4),
    )


def _surface(color_format):
    name = color_format.name
    return Rule(
        id=f"surface-{name.lower().replace('_', '-')}",
        stage="Blending",
        numbers="N10.5",
        formula="four bytes, red lowest: each component's upper bits, filled up with zeros; padding by name",
        in_words=True,
        evidence="Measured: 16 Blend_surface pictures of 16384 pixels",
        captures=("Blend_surface", "Surface_format"),
        inputs={"color": "int[4]"},
        output="int",
        compute=lambda color: surface_word(color, color_format),
        edges=tuple(([x] * 4,) for x in (0, 1, 3, 4, 7, 8, 127, 128, 247, 248, 251, 252, 254, 255)),
        draw=lambda chance: (chance.color(),),
    )


LOGIC = Rule(
    id="logic-operation",
    stage="Blending",
    numbers="N10.4",
    formula="bit by bit, table 4.3 of OpenGL 1.2.1",
    in_words=True,
    evidence="Source: OpenGL 1.2.1 table 4.3; no capture has it",
    captures=(),
    inputs={"operation": "name", "s": "int", "d": "int"},
    output="int",
    compute=lambda operation, s, d: per_fragment.logic(
        LogicOperation[operation], np.array([s]), np.array([d]), 255
    )[0],
    edges=tuple((operation.name, 0b1100, 0b1010) for operation in LogicOperation),
    draw=lambda chance: (chance.one_of(LogicOperation).name, chance.byte(), chance.byte()),
)

RULES = (
    *FOG,
    *TESTS,
    *(_factor(*each) for each in _FACTORS.items()),
    *(_equation(*each) for each in _EQUATIONS.items()),
    *(_surface(color_format) for color_format in ColorFormat),
    LOGIC,
)
