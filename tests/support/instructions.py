"""Each construct of the combiner notations: a smallest program, and what it computes, as a formula.

docs/program-instructions.md prints the formulas (``python -m tests.instructions``), and
tests/pipeline/notations/test_instructions.py evaluates the same texts beside the machines. A formula is of
the numbers of ``Numbers``; a and b are the texels of units 0 and 1, c the primary color, d the secondary one,
x is a - b.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fixedpipe.pipeline.profiles import PROFILES

# The machines with register combiners, by name.
COMBINERS = {name: p for name, p in PROFILES.items() if p.combiners.max_general_combiners}

# Functions of formulas: the argument, and what they are on machines and in the ideal.
DEFINITIONS = {
    "rn": ("n", "(2*n + one)//(2*one)", "n/one"),
    "clip": ("x", "maximum(low, minimum(x, high))", "x"),
    "halved": ("x", "(x + 1)//2", "x/2"),
    "positive": ("x", "maximum(0, x)", "maximum(0, x)"),
    "saturated": ("x", "maximum(0, minimum(x, one))", "maximum(0, minimum(x, one))"),
    "summed": ("x", "minimum(x, one)", "x"),
    "constant": ("v", "floor(one*v + 1/2)", "one*v"),
    "signed": ("v", "2*((one*(255*v + 256) + 255)//510) - expand", "one*v"),
    "written": ("x", "(2*255*saturated(x) + one)//(2*one)", "saturated(x)"),
}


@dataclass(frozen=True)
class Row:
    """``text``: of the program's body, whose result is r0 or SPARE0; ``formula``: what it computes.

    ``shown``: the formula is of the color that the final combiner gives, and not of a register. ``alpha``:
    what its alpha is, where the formula is of red, green and blue alone.
    """

    construct: str
    text: str
    formula: str
    shown: bool = False
    alpha: str | None = None


@dataclass(frozen=True)
class Numbers:
    """A machine's numbers, in units of its last place: ``one``, a half, what EXPAND_NORMAL subtracts from
    twice a register, and the least and the greatest that a register holds; the ideal has neither these two
    nor any rounding.
    """

    one: int
    half: float
    expand: int
    low: int | None
    high: int | None

    @property
    def exact(self) -> bool:
        return self.high is None

    def words(self) -> dict[str, Any]:
        """What the words of a formula stand for."""

        def function(name):
            argument, *texts = DEFINITIONS[name]
            return lambda *given: evaluated(
                texts[self.exact], self, **{argument: np.array(given) if len(given) > 1 else given[0]}
            )

        def signed(*v):
            color, alpha = function("signed")(*v)[:3], function("constant")(abs(v[3]))
            return np.append(color, np.sign(v[3]) * alpha)

        return {
            **{name: function(name) for name in DEFINITIONS},
            "signed": signed,
            "one": self.one,
            "half": self.half,
            "expand": self.expand,
            "low": self.low,
            "high": self.high,
            "minimum": np.minimum,
            "maximum": np.maximum,
            "floor": lambda x: np.floor(x).astype(np.int64),
            "where": np.where,
            "alpha": lambda x: np.broadcast_to(x[..., 3:], x.shape),
            "blue": lambda x: np.broadcast_to(x[..., 2:3], x.shape),
            "dot": lambda x, y: np.broadcast_to((x * y)[..., :3].sum(-1, keepdims=True), x.shape),
        }


def numbers_of(profile) -> Numbers:
    """The Numbers of a machine by its profile. Source: docs/numbers.md, sections 8 and 13."""
    arithmetic = profile.arithmetic
    one = (1 << arithmetic.combiner_bits) - 1
    if arithmetic.exact:
        return Numbers(one, one / 2, one, None, None)
    high = int(arithmetic.combiner_range * (one + 1)) - 1
    low = -high - (arithmetic.clamp_low == -256)
    return Numbers(one, (one + 1) // 2, one + (arithmetic.expand_half == 128), low, high)


def evaluated(formula: str, numbers: Numbers, **operands: Any) -> Any:
    """A formula's value. ``operands``: arrays [..., 4] of whole numbers in the machine's units."""
    return eval(formula, {"__builtins__": {}}, numbers.words() | operands)


# ------------------------------------------------------------------------------------------ ps.1.x

_HEAD = "tex t0\ntex t1\n"


def pixel_shader(row: Row) -> str:
    """The program of a row of ps.1.x: of the first version that has its instructions."""
    version = "1.2" if any(word in row.text for word in ("cmp", "dp4")) else "1.1"
    definitions = "".join(f"{line}\n" for line in row.text.splitlines() if line.startswith("def"))
    body = "".join(f"{line}\n" for line in row.text.splitlines() if not line.startswith("def"))
    if "r1" in body:
        body = f"sub r1, t0, t1\n{body}"
    return f"ps.{version}\n{definitions}{_HEAD}{body}"


INSTRUCTIONS = (
    Row("nop", "nop\nmov r0, t0", "a"),
    Row("mov", "mov r0, t0", "a"),
    Row("add", "add r0, t0, t1", "clip(a + b)"),
    Row("sub", "sub r0, t0, t1", "clip(a - b)"),
    Row("mul", "mul r0, t0, t1", "rn(a*b)"),
    Row("mad", "mad r0, t0, t1, v0", "clip(rn(a*b + one*c))"),
    Row("lrp", "lrp r0, t0, t1, v0", "rn(a*b + (one - a)*c)"),
    Row("dp3", "dp3 r0, t0, t1", "clip(rn(dot(a, b)))"),
    Row("cnd", "mov r0, t0\ncnd r0, r0.a, t1, v0", "where(alpha(a) >= half, b, c)"),
    Row("cmp", "cmp r0, r1.a, t0, v0", "where(alpha(x) >= 0, a, c)"),
    Row("dp4", "dp4 r0, t0, t1", "clip(clip(rn(dot(a, b))) + rn(alpha(a)*alpha(b)))"),
)
_SIGNED = "t0_bx2, t1_bx2"
_PRODUCT = "rn((2*a - expand)*(2*b - expand))"
MODIFIERS = (
    Row("no modifier", f"mul r0, {_SIGNED}", f"clip({_PRODUCT})"),
    Row("_x2", f"mul_x2 r0, {_SIGNED}", f"clip(2*{_PRODUCT})"),
    Row("_x4", f"mul_x4 r0, {_SIGNED}", f"clip(4*{_PRODUCT})"),
    Row("_d2", f"mul_d2 r0, {_SIGNED}", f"clip(halved({_PRODUCT}))"),
    Row("_sat", f"mul_sat r0, {_SIGNED}", f"saturated(clip({_PRODUCT}))"),
    Row("_x4_sat", f"mul_x4_sat r0, {_SIGNED}", f"saturated(clip(4*{_PRODUCT}))"),
)
# Of r1, which is x, a register of either sign.
SOURCES = (
    Row("r1", "mov r0, r1", "x"),
    Row("-r1", "mov r0, -r1", "clip(-x)"),
    Row("1-r1", "mov r0, 1-r1", "one - saturated(x)"),
    Row("r1_bx2", "mov r0, r1_bx2", "2*positive(x) - expand"),
    Row("-r1_bx2", "mov r0, -r1_bx2", "clip(expand - 2*positive(x))"),
    Row("r1_bias", "mov r0, r1_bias", "positive(x) - half"),
    Row("-r1_bias", "mov r0, -r1_bias", "half - positive(x)"),
    Row("r1.a", "mov r0, r1.a", "alpha(x)"),
)
CONSTANTS = (
    Row("0 to 1", "def c0, 0.3, 0.6, 0.9, 0.5\nmul r0, t0, c0", "rn(a*constant(0.3, 0.6, 0.9, 0.5))"),
    Row(
        "all negative",
        "def c0, -0.3, -0.6, -0.9, -0.5\nmul r0, t0, c0",
        "rn(a*-constant(0.3, 0.6, 0.9, 0.5))",
    ),
    Row(
        "of both signs, in mov and mul",
        "def c0, -0.3, 0.6, -0.9, -0.5\nmul r0, t0, c0",
        "rn(a*(constant(0, 0.6, 0, 0) - constant(0.3, 0, 0.9, 0.5)))",
    ),
    Row(
        "of both signs, -128/255 to 127/255",
        "def c0, -0.2, 0.4, -0.4, -0.5\nadd r0, t0, c0",
        "clip(a + constant(0, 0.4, 0, 0) - constant(0.2, 0, 0.4, 0.5))",
    ),
    Row(
        "of both signs, elsewhere",
        "def c0, -0.3, 0.6, -0.9, -0.5\nadd r0, t0, c0",
        "clip(a + signed(-0.3, 0.6, -0.9, -0.5))",
    ),
)

# ------------------------------------------------------------------------------------------ !!RC1.0


def register_combiners(row: Row) -> str:
    """The program of a row of !!RC1.0. A text without braces is of both portions of one general combiner; a
    dot product is of the color alone, and alpha is texture 0's.
    """
    if row.shown:
        return f"!!RC1.0\n{row.text}\n"
    first = ""
    if "spare1" in row.text:
        portion = "{ discard = tex0; discard = -tex1; spare1 = sum(); }"
        first = f"{{ rgb {portion} alpha {portion} }}\n"
    alpha = "spare0 = tex0;" if " . " in row.text else row.text
    general = f"{{\n  rgb {{ {row.text} }}\n  alpha {{ {alpha} }}\n}}\n"
    return f"!!RC1.0\n{first}{general}out.rgb = spare0;\nout.a = spare0;\n"


PRODUCTS = (
    Row("A alone", "spare0 = tex0;", "a"),
    Row("A * B", "spare0 = tex0 * tex1;", "rn(a*b)"),
    Row("A . B", "spare0 = tex0 . tex1;", "clip(rn(dot(a, b)))", alpha="a"),
    Row(
        "sum()",
        "discard = tex0 * tex1; discard = tex0 * col0; spare0 = sum();",
        "clip(rn(a*b + a*c))",
    ),
    Row(
        "sum() of dot products",
        "discard = tex0 . tex1; discard = tex0 . -col0; spare0 = sum();",
        "clip(rn(dot(a, b) - dot(a, c)))",
        alpha="a",
    ),
    Row(
        "mux()",
        "discard = tex1; discard = col0; spare0 = mux();",
        "where(alpha(a) >= half, c, b)",
    ),
)
MAPPINGS = (
    Row("x", "spare0 = spare1;", "x"),
    Row("-x", "spare0 = -spare1;", "clip(-x)"),
    Row("unsigned(x)", "spare0 = unsigned(spare1);", "positive(x)"),
    Row("unsigned_invert(x)", "spare0 = unsigned_invert(spare1);", "one - saturated(x)"),
    Row("expand(x)", "spare0 = expand(spare1);", "2*positive(x) - expand"),
    Row("-expand(x)", "spare0 = -expand(spare1);", "clip(expand - 2*positive(x))"),
    Row("half_bias(x)", "spare0 = half_bias(spare1);", "positive(x) - half"),
    Row("-half_bias(x)", "spare0 = -half_bias(spare1);", "half - positive(x)"),
    Row("one", "spare0 = one;", "one"),
    Row("-one", "spare0 = -one;", "-expand"),
    Row("zero", "spare0 = zero;", "0"),
)
_RC_SIGNED = "spare0 = expand(tex0) * expand(tex1);"
SCALES = (
    Row("no scale", _RC_SIGNED, f"clip({_PRODUCT})"),
    Row("scale_by_two()", f"{_RC_SIGNED} scale_by_two();", f"clip(2*{_PRODUCT})"),
    Row("scale_by_four()", f"{_RC_SIGNED} scale_by_four();", f"clip(4*{_PRODUCT})"),
    Row("scale_by_one_half()", f"{_RC_SIGNED} scale_by_one_half();", f"clip(halved({_PRODUCT}))"),
    Row(
        "bias_by_negative_one_half()",
        f"{_RC_SIGNED} bias_by_negative_one_half();",
        f"clip({_PRODUCT} - half)",
    ),
    Row(
        "bias_by_negative_one_half_scale_by_two()",
        f"{_RC_SIGNED} bias_by_negative_one_half_scale_by_two();",
        f"clip(2*({_PRODUCT} - half))",
    ),
)
_OUT_A = "\nout.a = tex0;"
_NEGATIVE = "{ rgb { discard = tex0; discard = -tex1; spare0 = sum(); } alpha { spare0 = tex0; } }\n"
FINAL = (
    Row("out.rgb = D", f"out.rgb = tex0;{_OUT_A}", "a", True, alpha="a"),
    Row("out.rgb = A * B", f"out.rgb = tex0 * tex1;{_OUT_A}", "rn(a*b)", True, alpha="a"),
    Row("out.rgb = A + D", f"out.rgb = tex0 + tex1;{_OUT_A}", "a + b", True, alpha="a"),
    Row(
        "out.rgb = A * B + D",
        f"out.rgb = tex0 * tex1 + col0;{_OUT_A}",
        "rn(a*b) + c",
        True,
        alpha="a",
    ),
    Row(
        "out.rgb = lerp(A, B, C)",
        f"out.rgb = lerp(tex0, tex1, col0);{_OUT_A}",
        "rn(a*b + (one - a)*c)",
        True,
        alpha="a",
    ),
    Row(
        "out.rgb = lerp(A, B, C) + D",
        f"out.rgb = lerp(tex0, tex1, col0) + col1;{_OUT_A}",
        "rn(a*b + (one - a)*c) + d",
        True,
        alpha="a",
    ),
    Row(
        "final_product = E * F",
        f"final_product = tex0 * tex1;\nout.rgb = final_product * col0;{_OUT_A}",
        "rn(rn(a*b)*c)",
        True,
        alpha="a",
    ),
    Row(
        "color_sum",
        f"{{ rgb {{ spare0 = tex0; }} }}\nout.rgb = tex1 * color_sum;{_OUT_A}",
        "rn(b*(a + d))",
        True,
        alpha="a",
    ),
    Row(
        "clamp_color_sum()",
        f"{{ rgb {{ spare0 = tex0; }} }}\nclamp_color_sum();\nout.rgb = tex1 * color_sum;{_OUT_A}",
        "rn(b*summed(a + d))",
        True,
        alpha="a",
    ),
    Row(
        "a register below 0",
        f"{_NEGATIVE}out.rgb = spare0;{_OUT_A}",
        "positive(a - b)",
        True,
        alpha="a",
    ),
    Row(
        "unsigned_invert(x)",
        f"{_NEGATIVE}out.rgb = unsigned_invert(spare0);{_OUT_A}",
        "one - saturated(a - b)",
        True,
        alpha="a",
    ),
    Row(
        "the least that a register holds",
        "{ rgb { discard = -one; discard = -one; spare0 = sum(); } }\n"
        "{ rgb { discard = spare0 * -one; discard = -one; spare0 = sum(); } }\n"
        f"out.rgb = spare0;{_OUT_A}",
        "clip(rn(clip(-2*expand)*-expand - one*expand))",
        True,
        alpha="a",
    ),
    Row("out.a = G.b", "out.rgb = tex0;\nout.a = tex1.b;", "a", True, alpha="blue(b)"),
)


@dataclass(frozen=True)
class Group:
    """Rows of one table, and how a row becomes a program."""

    title: str
    note: str
    program: Callable[[Row], str]
    rows: tuple[Row, ...]


_ARITHMETIC = (
    "Each instruction becomes one general combiner, and so does a pair with `+`; cmp and dp4 become two. "
    "A GeForce 256 refuses texture instructions, which the programs of these tables need, and more than two "
    "constants in all. It runs programs of one or two instructions of colors. Its combiners compute the same "
    "formulas."
)
_MODIFIED = (
    "The sum is rounded first, then scaled, then clamped. A combiner has no field for `_sat`. Instead, the "
    "next combiner that reads the register maps it by UNSIGNED_IDENTITY "
    "([why](decisions/0010-pixel-shaders.md))."
)
_READ = "The source is r1, of `sub r1, t0, t1` before it: x = a - b, from -255 to 255 where one is 255."
_CONSTANT = "`c0` and `-c0`, `c0.a` and what is mapped are read the same way; alpha has a sign of its own."
_SUMS = "The rows are color portions. An alpha portion has the same, but no dot products."
_MAPPED = (
    "x is spare1 = tex0 - tex1, from -255 to 255 where one is 255. one is ZERO through UNSIGNED_INVERT, "
    "-one is ZERO through EXPAND_NORMAL."
)
_SCALED = (
    "All three outputs of a portion are scaled alike; here it is AB. The bias is subtracted before the scale."
)
_FINAL = (
    "What is written to the frame: the sum is clamped to 0 to one once, at its end. A register alone is "
    "UNSIGNED_IDENTITY here, and out.a is tex0 where the row says nothing else."
)

GROUPS = {
    "instructions": Group("Arithmetic instructions of ps.1.x", _ARITHMETIC, pixel_shader, INSTRUCTIONS),
    "modifiers": Group("Instruction modifiers of ps.1.x", _MODIFIED, pixel_shader, MODIFIERS),
    "sources": Group("Sources of ps.1.x", _READ, pixel_shader, SOURCES),
    "constants": Group("Constants of ps.1.x", _CONSTANT, pixel_shader, CONSTANTS),
    "products": Group("Products, sums and muxes of !!RC1.0", _SUMS, register_combiners, PRODUCTS),
    "mappings": Group("Mappings of !!RC1.0", _MAPPED, register_combiners, MAPPINGS),
    "scales": Group("Scales and biases of !!RC1.0", _SCALED, register_combiners, SCALES),
    "final": Group("The final combiner of !!RC1.0", _FINAL, register_combiners, FINAL),
}
