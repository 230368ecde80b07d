"""Vertex programs, the units' numbers, window coordinates: docs/numbers.md, section 2."""

import math

import numpy as np

from fixedpipe.effects.arithmetic.rule import Rule, fraction, ordinary, single_of
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.vertices import chip_floats
from fixedpipe.pipeline.vertices.chip_floats import LIGHTING_BITS
from fixedpipe.pipeline.vertices.colors import color_byte
from fixedpipe.pipeline.vertices.projection import composite_coordinates, snap
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

INFINITY, NAN = math.inf, math.nan
LEAST, GREATEST, DENORMAL = 2.0**-126, (2.0 - 2.0**-23) * 2.0**127, 2.0**-130
SPECIAL = (0.0, -0.0, 1.0, -1.0, LEAST, -LEAST, DENORMAL, GREATEST, -GREATEST, INFINITY, -INFINITY)


def number(chance):
    """Single precision of either sign: of any exponent, or near one."""
    if chance.below(2):
        return ordinary(chance, 4)
    return single_of(chance.below(2) << 31 | (1 + chance.below(254)) << 23 | chance.below(1 << 23))


def _quad(chance):
    return [number(chance) for _ in range(4)]


# ---------------------------------------------------------------------------------------- vertex programs

_TERMS = (
    "each product cut to 24 bits; {} summed, terms cut 5 bits below the largest's last, and cut to 24 bits"
)
_CHIP = "Source: envytools, NV_vertex_program1_1; Measured: every pixel of the captures named"
_TABLE = "Source: envytools: tables of 32 straight lines; no capture has it"
_SOURCE = "Source: NV_vertex_program1_1, envytools; no capture has it"
_FLOATS, _CARRIED = "Attrib_float", "Attrib_carryover"
_RCC = tuple(f"W_param/rcc_w_zero_inf__z{z}" for z in ("0.25", "0.50", "-0.50"))
_FOG, _PAIRS = "Fog_exceptional_value", "Vertex_shader_independence_tests"
# By instruction: operands, whether they are scalars, what it is, evidence, captures whose programs have it.
_INSTRUCTIONS = {
    "MUL": (2, False, "a b cut to 24 bits; 0 times anything is 0, NaN has no sign", _CHIP, (_FLOATS, _FOG)),
    "ADD": (2, False, _TERMS.format("a and b are"), _CHIP, (_PAIRS,)),
    "MAD": (3, False, "MUL, then ADD", f"{_CHIP}; Assumed: its product is cut first", (_CARRIED,)),
    "DP3": (2, False, _TERMS.format("three are"), _CHIP, (_PAIRS,)),
    "DP4": (2, False, _TERMS.format("four are"), _CHIP, (_FOG,)),
    "DPH": (2, False, "DP4 with one for a's w", _SOURCE, ()),
    "DST": (2, False, "1, a.y b.y, a.z, b.w", _SOURCE, ()),
    "MIN": (2, False, "the lesser; -0 is less than 0", _SOURCE, ()),
    "MAX": (2, False, "the greater; -0 is less than 0", _SOURCE, ()),
    "SLT": (2, False, "1 where a < b, else 0; -0 is less than 0", _SOURCE, ()),
    "SGE": (2, False, "0 where a < b, else 1; -0 is less than 0", _CHIP, (_CARRIED, _PAIRS)),
    "RCP": (1, True, "a seed of 7 bits and two Newton steps (N2.13); 1/-0 is minus infinity", _CHIP, (_FOG,)),
    "RCC": (1, True, "RCP, its magnitude within 2^-64 and 2^64", _CHIP, _RCC),
    "RSQ": (1, True, "of |a|: a seed of 7 bits and two Newton steps (N2.13)", _CHIP, (_PAIRS,)),
    "EXP": (1, True, "2^floor(a), a - floor(a), 2^a by the table, 1", _TABLE, ()),
    "LOG": (1, True, "of |a|: its exponent, its mantissa, log2 by the table, 1", _TABLE, ()),
    "LIT": (1, False, "1, max(a.x, 0), a.x > 0 ? 2^(a.w log2 a.y) by the tables : 0, 1", _TABLE, ()),
}
_INPUTS = "abc"


def _instruction(name, count, scalar, formula, evidence, captures):
    read = ", ".join(f"v[{i}]" + (".x" if scalar else "") for i in range(count))
    program = vertex_program(f"{name} o[COL0], {read};")

    def compute(*operands):
        given = {i: np.array([v] if scalar else v) for i, v in enumerate(operands)}
        with np.errstate(all="ignore"):
            return program.run(given)["COL0"][0]

    orders = name in ("MIN", "MAX", "SLT", "SGE")
    special = SPECIAL if orders or name == "LIT" else (*SPECIAL, NAN)
    if scalar:
        edges = tuple(
            (x,) for x in (*special, 2.0, 3.0, -3.0, 0.75, 1.0 + 2.0**-23, 2.0 - 2.0**-23, 127.5, -126.5)
        )
        draw = lambda chance: (number(chance),)  # noqa: E731
    elif name == "LIT":
        edges = tuple(
            ([x, y, 0.0, power],)
            for x in (-1.0, -0.0, 0.0, 0.5)
            for y in (-1.0, 0.0, 0.5, 1.0, INFINITY)
            for power in (-200.0, -1.0, 0.0, 1.0, 2.5, 128.0)
        )
        draw = lambda chance: ([ordinary(chance, 2), ordinary(chance, 3), 0.0, ordinary(chance, 7)],)  # noqa: E731
    else:
        edges = tuple(
            tuple([special[(i * (k + 1) + 3 * k + n) % len(special)] for n in range(4)] for k in range(count))
            for i in range(2 * len(special))
        )
        draw = lambda chance: tuple(_quad(chance) for _ in range(count))  # noqa: E731
    return Rule(
        id=f"vertex-{name.lower()}",
        stage="Vertex programs",
        numbers="N2.24" if evidence is _TABLE else "N2.23",
        formula=formula,
        in_words=True,
        evidence=evidence,
        captures=captures,
        inputs={_INPUTS[k]: "single" if scalar else "single[4]" for k in range(count)},
        output="single[4]",
        compute=compute,
        edges=edges,
        draw=draw,
    )


_ADDRESSES = 96  # A0.x from -96 to 95 reads a constant here
_ARL = vertex_program(f"ARL A0.x, v[0].x; MOV o[COL0], c[A0.x + {_ADDRESSES}];")
_NUMBERED = {number: (float(number - _ADDRESSES),) * 4 for number in range(2 * _ADDRESSES)}


def _address(a):
    return int(_ARL.run({0: np.array([a])}, _NUMBERED)["COL0"][0, 0])


ADDRESS = Rule(
    id="vertex-arl",
    stage="Vertex programs",
    numbers="N2.23",
    formula="floor(a)",
    evidence="Assumed: the floor; no capture has it",
    captures=(),
    inputs={"a": "single"},
    output="int",
    compute=_address,
    edges=tuple(
        (a,)
        for a in (-96.0, -1.5, -1.0, -(2.0**-20), -0.0, 0.0, 2.0**-20, 0.5, 1.0 - 2.0**-24, 1.0, 2.5, 95.5)
    ),
    draw=lambda chance: (ordinary(chance, 6),),
)

# ------------------------------------------------------------------------------------- numbers of the units


def _quiet(function):
    def compute(*arguments):
        with np.errstate(all="ignore"):
            return float(function(*(np.float64(a) for a in arguments)))

    return compute


def _short(chance):
    return float(chip_floats.to_lighting(number(chance)))


_LIT = "Source: envytools' model of the NV10; Measured: Lighting_normals, Material_alpha: all pixels"
_LIT_SUMS = "Measured: 52 of 54 captures exact; with products cut before their sums 28"
_LIT_COLORS = "Measured: 52 of 54 captures exact; with its product cut to 14 bits 49"
_QUOTIENTS = ("Lighting_control", "Lighting_spotlight", "Specular", "Specular_back")
_LIGHTING = ("Lighting_normals", "Lighting_range", "Material_alpha", "Material_color_source")
_SHORT = (0.0, -0.0, 1.0, -1.0, 1.5, 1.9998779296875, 2.0, -0.75, 2.0**-100, -(2.0**100), INFINITY, -INFINITY)
_FINITE = tuple(x for x in _SHORT if math.isfinite(x))
_SUMS = (
    *tuple(
        (a, b, c)
        for a in (0.99993896484375, -2.5, 0.0)
        for b in (-2.5, 0.99993896484375)
        for c in (3.0, 0.0, 2.5)
    ),
    (INFINITY, 1.0, 0.0),
    (-INFINITY, 1.0, 0.0),
    (1.5, 0.0, -INFINITY),
)


def _three_short(chance):
    return tuple(float(chip_floats.to_lighting(ordinary(chance, 10))) for _ in "abc")


UNITS = (
    Rule(
        id="reciprocal",
        stage="Vertices",
        numbers="N2.13",
        formula="s of 7 bits; t = (2^31 - s m) s >> 24; ((2^37 - t m) t >> 25) / 2^24; powers of two exact",
        in_words=True,
        evidence="Measured: 307176 of 307200 depths (a truncated quotient: 259087)",
        captures=("Depth_buffer_fixed_function", "Fog_exceptional_value"),
        inputs={"x": "single"},
        output="single",
        compute=_quiet(chip_floats.transform_reciprocal),
        edges=tuple(
            (x,)
            for x in (
                0.0,
                1.0,
                -1.0,
                2.0,
                3.0,
                0.75,
                -1.5,
                1.0 + 2.0**-23,
                2.0 - 2.0**-23,
                LEAST,
                GREATEST,
                INFINITY,
            )
        ),
        draw=lambda chance: (number(chance),),
    ),
    Rule(
        id="inverse-square-root",
        stage="Vertices",
        numbers="N2.13",
        formula="of |x|: s of 7 bits; t = (3 2^37 - s s x) s >> 32; ((3 2^49 - t t x) t >> 39) / 2^24",
        in_words=True,
        evidence=_LIT,
        captures=_LIGHTING,
        inputs={"x": "single"},
        output="single",
        compute=_quiet(chip_floats.transform_inverse_root),
        edges=tuple(
            (x,)
            for x in (
                0.0,
                1.0,
                -1.0,
                2.0,
                3.0,
                4.0,
                0.25,
                2.0 - 2.0**-23,
                4.0 - 2.0**-22,
                LEAST,
                GREATEST,
                INFINITY,
            )
        ),
        draw=lambda chance: (number(chance),),
    ),
    Rule(
        id="enter-lighting",
        stage="Vertices",
        numbers="N2.14",
        formula="2^9 is added to the bits, unless bits 10 to 17 are all ones; the low ten are dropped",
        in_words=True,
        evidence=_LIT,
        captures=_LIGHTING,
        inputs={"x": "single"},
        output="single",
        compute=_quiet(chip_floats.to_lighting),
        edges=tuple(
            (single_of(bits),)
            for bits in (
                0,
                0x3F800000,
                0x3F8001FF,
                0x3F800200,
                0x3F83FE00,
                0x3F83FC00,
                0x3F83FFFF,
                0xBF800200,
                0x3FFFFFFF,
            )
        ),
        draw=lambda chance: (number(chance),),
    ),
    Rule(
        id="lighting-product",
        stage="Vertices",
        numbers="N2.12",
        formula="a b cut to 14 bits; 0 times infinity is 0, an infinite product is positive",
        in_words=True,
        evidence=_LIT,
        captures=_LIGHTING,
        inputs={"a": "single", "b": "single"},
        output="single",
        compute=_quiet(lambda a, b: chip_floats.product(a, b, LIGHTING_BITS)),
        edges=tuple((a, b) for a in _SHORT for b in (0.0, 1.0, -1.5, 1.9998779296875, INFINITY)),
        draw=lambda chance: (_short(chance), _short(chance)),
    ),
    Rule(
        id="lighting-sum",
        stage="Vertices",
        numbers="N2.12",
        formula="terms cut 5 bits below the largest's last of 14, the sum cut to 14; infinities are positive",
        in_words=True,
        evidence=_LIT,
        captures=_LIGHTING,
        inputs={"a": "single", "b": "single", "c": "single"},
        output="single",
        compute=_quiet(lambda a, b, c: chip_floats.total((a, b, c), LIGHTING_BITS)),
        edges=(
            *tuple((a, b, -a) for a in _FINITE for b in (0.0, 1.0, 2.0 ** (-18), -1.9998779296875)),
            (INFINITY, 1.0, 0.0),
            (-INFINITY, 1.0, 0.0),
        ),
        draw=_three_short,
    ),
    Rule(
        id="lighting-multiply-add",
        stage="Vertices",
        numbers="N2.25",
        formula="for the least i, j, m with |a| < 2^i, |b| < 2^j, |c| < 2^m: a loses the last m + 1 - i - j "
        "of its 14 bits, or c its last i + j - m - 1; then a b + c, exact and cut to 14",
        in_words=True,
        evidence=_LIT_SUMS,
        captures=_QUOTIENTS,
        inputs={"a": "single", "b": "single", "c": "single"},
        output="single",
        compute=_quiet(lambda a, b, c: chip_floats.multiply_add(a, b, c, LIGHTING_BITS)),
        edges=_SUMS,
        draw=_three_short,
    ),
    Rule(
        id="lighting-add-product",
        stage="Vertices",
        numbers="N2.25",
        formula="a b + c: the exact product and c cut to 15 bits of the larger, their sum to 14",
        in_words=True,
        evidence=_LIT_COLORS,
        captures=_QUOTIENTS,
        inputs={"a": "single", "b": "single", "c": "single"},
        output="single",
        compute=_quiet(lambda a, b, c: chip_floats.add_product(a, b, c, LIGHTING_BITS)),
        edges=_SUMS,
        draw=_three_short,
    ),
    Rule(
        id="lighting-reciprocal",
        stage="Vertices",
        numbers="N2.13",
        formula="s of 7 bits; ((2^21 - s m) s >> 14) / 2^13, so 1/1 is 8191/8192",
        in_words=True,
        evidence=_LIT,
        captures=_LIGHTING,
        inputs={"x": "single"},
        output="single",
        compute=_quiet(chip_floats.lighting_reciprocal),
        edges=tuple((x,) for x in _SHORT if x or math.copysign(1.0, x) > 0),
        draw=lambda chance: (_short(chance),),
    ),
    Rule(
        id="lighting-inverse-square-root",
        stage="Vertices",
        numbers="N11.12",
        formula="s / 2^7, s of 7 bits from the table, with no Newton step",
        in_words=True,
        evidence="Measured: points' sizes, 3051882 of 3051882 pixels (Point_params)",
        captures=("Point_params/Detailed_FF", "Point_params/PointParamsOn_SmoothOn_128_FF"),
        inputs={"x": "single"},
        output="single",
        compute=_quiet(chip_floats.lighting_inverse_root),
        edges=tuple((x,) for x in _SHORT if x or math.copysign(1.0, x) > 0),
        draw=lambda chance: (_short(chance),),
    ),
)

# ------------------------------------------------------------------------------------- window coordinates


def _window(x, w, offset):
    column = np.array([x])
    coordinates = composite_coordinates((column, column, column, np.array([w])), (offset,) * 3, 0.0)
    return coordinates[0][0]


WINDOW = (
    Rule(
        id="window-coordinate",
        stage="Vertices",
        numbers="N2.6",
        formula="T24(T24(x * reciprocal(w)) + offset)",
        evidence="Measured: TopLeftRaster_Fixed; Viewport, 2138672 of 2138672 pixels",
        captures=(
            "Vertex_shader_rounding_tests/TopLeftRaster_Fixed",
            "Viewport",
            "Depth_buffer_fixed_function",
        ),
        inputs={"x": "single", "w": "single", "offset": "single"},
        output="single",
        compute=_window,
        edges=tuple(
            (x, w, o)
            for x in (0.0, 1.0, -320.0, 641.03125)
            for w in (1.0, 3.0, 0.75)
            for o in (0.0, 0.53125, -0.4375)
        ),
        draw=lambda chance: (ordinary(chance, 10), abs(ordinary(chance, 4)), ordinary(chance, 4)),
    ),
    Rule(
        id="snapped-coordinate",
        stage="Vertices",
        numbers="N2.5",
        formula="trunc(16 * clamp(x, -1048576, extent + 1048576))",
        evidence="Measured: 294000 of 294000 pixels (TopLeftRaster); the guard band's edge is Assumed",
        captures=(
            "Vertex_shader_rounding_tests/TopLeftRaster",
            "Viewport",
            "W_buffering/WBuf24D_FloorQuad_V0_ZB0_ZS0",
        ),
        inputs={"x": "single", "extent": "int"},
        output="int",
        compute=lambda x, extent: snap(np.float64(x), extent, NV2A),
        edges=tuple(
            (x, 640)
            for x in (
                0.0,
                0.0625,
                0.0625 - 2.0**-20,
                -0.0625,
                -0.03125,
                -0.09375,
                0.5625,
                639.9375,
                2.0**100,
                -(2.0**100),
            )
        ),
        draw=lambda chance: (ordinary(chance, 11), 640),
    ),
    Rule(
        id="color-to-byte",
        stage="Vertices",
        numbers="N2.7",
        formula="floor(255 * T14(v) + 1 / 2)",
        evidence="Measured: 1984 of 1984 values",
        captures=("Depth_buffer", "Lighting_normals", "Material_color_source"),
        inputs={"v": "single"},
        output="int",
        compute=lambda v: color_byte(np.float64(v), NV2A.arithmetic.color_mantissa_bits),
        edges=tuple((v,) for v in (0.0, 1.0, 0.5, 0.25, 1.0 - 2.0**-24, 1.0 - 2.0**-14, 2.0**-126))
        + tuple((float(np.float32((k + 0.5) / 255)),) for k in (0, 1, 63, 127, 128, 253, 254)),
        draw=lambda chance: (fraction(chance),),
        open="color-bits",
    ),
)

RULES = (*(_instruction(name, *rest) for name, rest in _INSTRUCTIONS.items()), ADDRESS, *UNITS, *WINDOW)
