"""Register combiners and the final combiner, in units of 1/255: docs/numbers.md, section 8."""

import numpy as np

from fixedpipe.effects.arithmetic.rule import Rule
from fixedpipe.pipeline.columns.combiners import arithmetic_of
from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, Mapping
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.raster.columns import combine
from fixedpipe.raster.columns.numbers import quotient

STAGE = "Combiners"
LOWEST, ONE = -256, 255  # of a register
UNSIGNED = (0, 1, 2, 126, 127, 128, 129, 254, 255)
SIGNED = (LOWEST, -255, -129, -128, -127, -2, -1, *UNSIGNED)
_MACHINE = arithmetic_of(NV2A, 8)


def register(chance):
    """A register's contents: half of the time a number at which the arithmetic changes."""
    return chance.one_of(SIGNED) if chance.below(2) else LOWEST + chance.below(512)


def _registers(count):
    return lambda chance: tuple(register(chance) for _ in range(count))


def _pairs(values):
    return tuple((a, b) for a in values for b in values)


def _output(*products, scale="NONE", bias="NONE"):
    columns = [np.array([n]) for n in products]
    return combine.output(columns, CombinerScale[scale], bool(CombinerBias[bias]), _MACHINE)[0]


# ------------------------------------------------------------------------------------------ input mappings

_NO_SIGN = "Source: NV_register_combiners, table 4; no capture has it"
_MAPPINGS = {
    Mapping.UNSIGNED_IDENTITY: ("max(0, x)", "Measured: Combiner, every pixel", ("Combiner",), ""),
    Mapping.UNSIGNED_INVERT: ("255 - clamp(x, 0, 255)", "Measured: Combiner, every pixel", ("Combiner",), ""),
    Mapping.EXPAND_NORMAL: ("2 * max(0, x) - 256", "Inferred: the bias's half is 128", (), "expand-half"),
    Mapping.EXPAND_NEGATE: (
        "min(255, 256 - 2 * max(0, x))",
        "Inferred: the bias's half is 128",
        (),
        "expand-half",
    ),
    Mapping.HALF_BIAS_NORMAL: ("max(0, x) - 128", "Inferred: the bias's half is 128", (), "half-bias"),
    Mapping.HALF_BIAS_NEGATE: ("128 - max(0, x)", "Inferred: the bias's half is 128", (), "half-bias"),
    Mapping.SIGNED_IDENTITY: ("x", _NO_SIGN, (), ""),
    Mapping.SIGNED_NEGATE: ("clamp(-x, -256, 255)", _NO_SIGN, (), ""),
}


def _mapping(mapping, formula, evidence, captures, question):
    return Rule(
        id=f"mapping-{mapping.name.lower().replace('_', '-')}",
        stage=STAGE,
        numbers="N8.1",
        formula=formula,
        evidence=evidence,
        captures=captures,
        inputs={"x": "int"},
        output="int",
        compute=lambda x: combine.map_input(np.array([x]), mapping, _MACHINE)[0],
        edges=tuple((x,) for x in range(LOWEST, ONE + 1)),
        open=question,
    )


# ---------------------------------------------------------------------------------------- general combiner


def _sums():
    """Sums of products on both sides of where rn changes, and whole codes."""
    near = (x * ONE + offset for x in SIGNED for offset in (-128, -127, 0, 127, 128))
    return tuple((n,) for n in near)


def _scaled_edges():
    combinations = (
        *((scale.name, "NONE") for scale in CombinerScale),
        ("NONE", "BIAS_BY_NEGATIVE_ONE_HALF"),
        ("SCALE_BY_TWO", "BIAS_BY_NEGATIVE_ONE_HALF"),
    )
    return tuple((x, *which) for which in combinations for x in (-511, *SIGNED, 256, 383, 510))


def _scaled(chance):
    scale, bias = chance.one_of(_scaled_edges())[1:]
    return -600 + chance.below(1201), scale, bias


GENERAL = (
    Rule(
        id="rn",
        stage=STAGE,
        numbers="N8.1",
        formula="floor(n / 255 + 1 / 2)",
        evidence="Measured: 110441 of 110441 pixels; of negative n nothing tells it from a cut magnitude",
        captures=("Combiner/CombinerOps", "Combiner/SpecialInputs", "Blend_tests"),
        inputs={"n": "int"},
        output="int",
        compute=lambda n: quotient(np.array([n]), ONE)[0],
        edges=_sums(),
        draw=lambda chance: (chance.below(4 * 65536) - 2 * 65536,),
        open="negative-products",
    ),
    Rule(
        id="product",
        stage=STAGE,
        numbers="N8.3",
        formula="clamp(rn(a * b), -256, 255)",
        evidence="Measured: 110441 of 110441 pixels, of a and b from 0 up",
        captures=("Combiner",),
        inputs={"a": "int", "b": "int"},
        output="int",
        compute=lambda a, b: _output(a * b),
        edges=_pairs(SIGNED),
        draw=_registers(2),
    ),
    Rule(
        id="sum-of-products",
        stage=STAGE,
        numbers="N8.3",
        formula="clamp(rn(a * b + c * d), -256, 255)",
        evidence="Inferred: from the blender, which rounds once, after the sum",
        captures=(),
        inputs={"a": "int", "b": "int", "c": "int", "d": "int"},
        output="int",
        compute=lambda a, b, c, d: _output(a * b, c * d),
        edges=tuple((a, b, a, d) for a in (1, 127, 255) for b in SIGNED for d in (1, 126, 129, 255)),
        draw=_registers(4),
        open="product-rounding",
    ),
    Rule(
        id="dot-product",
        stage=STAGE,
        numbers="N8.2",
        formula="clamp(rn(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]), -256, 255)",
        evidence="Inferred: rounded once, as a sum of two products; no capture has a dot product",
        captures=(),
        inputs={"a": "int[3]", "b": "int[3]"},
        output="int",
        compute=lambda a, b: _output(*(x * y for x, y in zip(a, b, strict=True))),
        edges=tuple(((x, x, x), (y, y, y)) for x, y in _pairs((LOWEST, -128, -1, 0, 1, 85, 128, 255))),
        draw=lambda chance: tuple([register(chance) for _ in range(3)] for _ in "ab"),
        open="product-rounding",
    ),
    Rule(
        id="scale-and-bias",
        stage=STAGE,
        numbers="N8.4",
        formula="clamp(scaled(x - (128 if bias == 'BIAS_BY_NEGATIVE_ONE_HALF' else 0), scale), -256, 255)",
        evidence="Measured: the bias before the scale, one half as (x + 1) >> 1, of x from 0 up",
        captures=("Combiner/CombinerOps",),
        inputs={"x": "int", "scale": "name", "bias": "name"},
        output="int",
        compute=lambda x, scale, bias: _output(x * ONE, scale=scale, bias=bias),
        edges=_scaled_edges(),
        draw=_scaled,
        open="round-before-scale",
    ),
    Rule(
        id="general-clamp",
        stage=STAGE,
        numbers="N8.4",
        formula="clamp(x, -256, 255)",
        evidence="Measured: 255; Assumed: -256, which no capture shows",
        captures=("Combiner/CombinerOps",),
        inputs={"x": "int"},
        output="int",
        compute=lambda x: _output(x * ONE),
        edges=tuple((x,) for x in (-1024, -513, -512, -258, -257, *SIGNED, 256, 257, 510, 511, 1020)),
        draw=lambda chance: (chance.below(2049) - 1024,),
        open="clamp-low",
    ),
    Rule(
        id="mux-takes-cd",
        stage=STAGE,
        numbers="N8.2",
        formula="int(clamp(alpha, 0, 255) >= 128 if select == 'MSB' else clamp(alpha, 0, 255) % 2 == 1)",
        evidence="Measured: Combiner/Mux, every pixel",
        captures=("Combiner/Mux",),
        inputs={"alpha": "int", "select": "name"},
        output="int",
        compute=lambda alpha, select: combine.takes_cd(np.array([alpha]), select == "LSB", _MACHINE)[0],
        edges=tuple((alpha, select) for select in ("MSB", "LSB") for alpha in range(LOWEST, ONE + 1)),
    ),
)

# ------------------------------------------------------------------------------------------ final combiner


def _final(a, b, c, d):
    a, b, c, d, g = (np.array([[x]]) for x in (a, b, c, d, 0))
    return combine.final_color(a, b, c, d, g, _MACHINE)[0, 0]


def _bytes(count):
    return lambda chance: tuple(chance.byte() for _ in range(count))


FINAL = (
    Rule(
        id="final-mapping",
        stage=STAGE,
        numbers="N8.7",
        formula="255 - clamp(x, 0, 255) if mapping == 'UNSIGNED_INVERT' else max(0, x)",
        evidence="Measured: Combiner/SpecialInputs, Combiner/Flags, every pixel",
        captures=("Combiner/SpecialInputs", "Combiner/Flags"),
        inputs={"x": "int", "mapping": "name"},
        output="int",
        compute=lambda x, mapping: combine.map_final(np.array([x]), mapping == "UNSIGNED_INVERT", _MACHINE)[
            0
        ],
        edges=tuple(
            (x, mapping)
            for mapping in ("UNSIGNED_IDENTITY", "UNSIGNED_INVERT")
            for x in (*range(LOWEST, ONE + 1), 256, 509, 510)
        ),
    ),
    Rule(
        id="final-product",
        stage=STAGE,
        numbers="N8.7",
        formula="rn(e * f)",
        evidence="Measured: Combiner/SpecialInputs, every pixel",
        captures=("Combiner/SpecialInputs",),
        inputs={"e": "int", "f": "int"},
        output="int",
        compute=lambda e, f: combine.product(np.array([e * f]), _MACHINE)[0],
        edges=_pairs(UNSIGNED),
        draw=_bytes(2),
    ),
    Rule(
        id="final-lerp",
        stage=STAGE,
        numbers="N8.7",
        formula="clamp(rn(min(a, 255) * b + (255 - min(a, 255)) * c) + d, 0, 255)",
        evidence="Measured: fog 458082 of 458082 pixels; Inferred: once, after the sum, as the blender",
        captures=("Fog", "Fog_vsh", "Fog_param", "Combiner/Flags"),
        inputs={"a": "int", "b": "int", "c": "int", "d": "int"},
        output="int",
        compute=_final,
        edges=(
            *tuple(
                (a, b, c, d)
                for a in (*UNSIGNED, 510)
                for b, c in ((0, 255), (255, 0), (1, 128))
                for d in (0, 200)
            ),
            (128, 510, 0, 0),
            (128, 510, 510, 0),
            (0, 0, 510, 255),
            (255, 0, 0, 510),
        ),
        draw=_bytes(4),
        open="final-lerp",
    ),
)

RULES = (*(_mapping(mapping, *rest) for mapping, rest in _MAPPINGS.items()), *GENERAL, *FINAL)
