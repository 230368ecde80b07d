"""Each operation of !!TS1.0: a smallest program, and what its last stage computes, as a formula.

s, t, r, q are the stage's own coordinates, R, G, B, A the texel that it reads of an earlier stage as bytes,
dots the dot products of the group's stages, qs their q; a1 to a4, scale, bias and eye stand in the program.
"""

from dataclasses import dataclass
from math import floor, frexp, trunc
from struct import pack, unpack
from typing import Any

from tests.reference.interpolate import signed_reciprocal


@dataclass(frozen=True)
class Operation:
    """``text``: instructions, the last of which is told. ``made``: the coordinates of its lookup, "" where it
    makes none; ``given``: what it gives besides or in place of a texel: "texel", "kept" or "depth", and how.
    """

    words: str
    text: str
    made: str = ""
    given: tuple[str, str] = ("", "")


MATRIX, SCALE, BIAS, EYE = (0.5, -0.25, 0.75, 0.125), 0.5, 0.25, (0.25, -0.5, 1.0)
_OFFSET = "sum(s, a1*signed(B)/128, a3*signed(G)/128), sum(t, a2*signed(B)/128, a4*signed(G)/128)"
_SCALED = "texel", "[byte(C/255*(R/255*scale + bias)) for C in looked_up]"
_REFLECTED = "[n*(2*dot(dots, {0})) - e*dot(dots, dots) for n, e in zip(dots, {0})]"
_MATRIX = ", ".join(map(str, MATRIX))
_EYE = ", ".join(map(str, EYE))
_TWO, _THREE = "dots[0], dots[1]", "dots[0], dots[1], dots[2]"


def _group(name: str, length: int, first: str = "") -> str:
    """The instructions of a group after a texture. ``first``: more arguments of the first."""
    parts = [f"{name}_{k + 1}of{length}(expand(tex0){first if k == 0 else ''});" for k in range(length)]
    return "\n".join(["texture_2d();", *parts])


OPERATIONS = (
    Operation("nop()", "nop();", given=("texel", "0, 0, 0, 255")),
    Operation("texture_1d()", "texture_1d();"),
    Operation("texture_2d()", "texture_2d();"),
    Operation("texture_rectangle()", "texture_rectangle();"),
    Operation("texture_3d()", "texture_3d();"),
    Operation("texture_cube_map()", "texture_cube_map();"),
    Operation("pass_through()", "pass_through();", given=("texel", "byte(s), byte(t), byte(r), byte(q)")),
    Operation(
        "cull_fragment, GEQUAL, GEQUAL, LESS, LESS",
        "cull_fragment(GEQUAL_TO_ZERO, GEQUAL_TO_ZERO, LESS_THAN_ZERO, LESS_THAN_ZERO);",
        given=("kept", "s >= 0 and t >= 0 and r < 0 and q < 0"),
    ),
    Operation("offset_2d(texN, a1, a2, a3, a4)", f"texture_2d();\noffset_2d(tex0, {_MATRIX});", _OFFSET),
    Operation(
        "offset_2d_scale(..., scale, bias)",
        f"texture_2d();\noffset_2d_scale(tex0, {_MATRIX}, {SCALE}, {BIAS});",
        _OFFSET,
        _SCALED,
    ),
    Operation(
        "offset_rectangle(texN, a1, a2, a3, a4)",
        f"texture_2d();\noffset_rectangle(tex0, {_MATRIX});",
        _OFFSET,
    ),
    Operation(
        "offset_rectangle_scale(..., scale, bias)",
        f"texture_2d();\noffset_rectangle_scale(tex0, {_MATRIX}, {SCALE}, {BIAS});",
        _OFFSET,
        _SCALED,
    ),
    Operation("dependent_ar(texN)", "texture_2d();\ndependent_ar(tex0);", "A/255, R/255"),
    Operation("dependent_gb(texN)", "texture_2d();\ndependent_gb(tex0);", "G/255, B/255"),
    Operation("dot_product_2d, 2 stages", _group("dot_product_2d", 2), _TWO),
    Operation("dot_product_rectangle, 2 stages", _group("dot_product_rectangle", 2), _TWO),
    Operation(
        "dot_product_depth_replace, 2 stages",
        _group("dot_product_depth_replace", 2),
        given=("depth", "quotient(dots[0], dots[1])*units"),
    ),
    Operation("dot_product_3d, 3 stages", _group("dot_product_3d", 3), _THREE),
    Operation("dot_product_cube_map, 3 stages", _group("dot_product_cube_map", 3), _THREE),
    Operation(
        "dot_product_reflect_cube_map_eye_from_qs, 3 stages",
        _group("dot_product_reflect_cube_map_eye_from_qs", 3),
        _REFLECTED.format("qs"),
    ),
    Operation(
        "dot_product_reflect_cube_map_const_eye, 3 stages",
        _group("dot_product_reflect_cube_map_const_eye", 3, f", {_EYE}"),
        _REFLECTED.format("eye"),
    ),
    Operation(
        "dot_product_cube_map_and_reflect_cube_map_eye_from_qs, 3 stages, its second",
        _group("dot_product_cube_map_and_reflect_cube_map_eye_from_qs", 3),
        _REFLECTED.format("qs"),
    ),
    Operation(
        "dot_product_cube_map_and_reflect_cube_map_const_eye, 3 stages, its second",
        _group("dot_product_cube_map_and_reflect_cube_map_const_eye", 3, f", {_EYE}"),
        _REFLECTED.format("eye"),
    ),
)
# What the words of the formulas stand for, on machines and in the ideal.
DOT = "dot((s, t, r), (x, y, z))"
MAPPED = {"texN": ("V/255", "V/255"), "expand(texN)": ("(V - 128)/127", "(2*V - 255)/255")}
BYTE = ("min((floor(4096*saturated(v)) + 1)*255 >> 12, 255)", "255*saturated(v)")


def _saturated(v):
    return min(max(v, 0.0), 1.0)


def _sum_of_cut(*terms: float) -> float:
    """Of terms that are each cut to the last of 24 bits of the largest."""
    unit = 2.0 ** (frexp(max(map(abs, terms)))[1] - 24)
    return sum(trunc(term / unit) for term in terms) * unit


def _dot_of_cut(p: Any, q: Any) -> float:
    """Of products with the nearest singles, each cut 23 bits below the largest product of their factors'
    highest bits, to 24 bits.
    """
    pairs = [(a, unpack("f", pack("f", b))[0]) for a, b in zip(p, q, strict=True)]
    bounds = [frexp(a)[1] + frexp(b)[1] - 2 for a, b in pairs if a and b]
    unit = 2.0 ** (max([-100, *bounds]) - 23)
    total = sum(trunc(a * b / unit) for a, b in pairs)
    dropped = max(abs(total).bit_length() - 24, 0)
    return (abs(total) >> dropped << dropped) * (unit if total > 0 else -unit)


def words(exact: bool) -> dict[str, Any]:
    """What the words of a formula stand for."""
    known: dict[str, Any] = {
        "floor": floor,
        "saturated": _saturated,
        "signed": lambda v: v - 256 if v > 127 else v,
        "dot": (lambda p, q: (p[0] * q[0] + p[1] * q[1]) + p[2] * q[2]) if exact else _dot_of_cut,
        "quotient": lambda a, b: a / b if exact else a * signed_reciprocal(b),
        "zip": zip,
        "sum": (lambda *terms: sum(terms)) if exact else _sum_of_cut,
        "min": min,
        "scale": SCALE,
        "bias": BIAS,
        "eye": EYE,
        **dict(zip(("a1", "a2", "a3", "a4"), MATRIX, strict=True)),
    }
    return known | {"byte": lambda v: evaluated(BYTE[exact], exact, v=v)}


def evaluated(formula: str, exact: bool, **operands: Any) -> Any:
    """A formula's value; ``exact``: of the ideal."""
    return eval(formula, {"__builtins__": {}} | words(exact) | operands)


def dot_products(stages, coordinates, texel, exact):
    """The dot product of every stage, by DOT and MAPPED; None of what is none."""
    found = []
    for stage, (s, t, r, _) in zip(stages, coordinates, strict=False):
        word = "expand(texN)" if stage.dot_product_mapping.name == "EXPAND_NORMAL" else "texN"
        x, y, z = (evaluated(MAPPED[word][exact], exact, V=value) for value in texel[:3])
        dot = "DOT_PRODUCT" in stage.operation.name
        found.append(evaluated(DOT, exact, s=s, t=t, r=r, x=x, y=y, z=z) if dot else None)
    return found
