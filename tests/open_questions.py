"""docs/open-questions.md, made of the rules, their vectors and the accepted counts of the captures; and
nv2a_answers.glsl, made of the C beside it: ``python -m tests.open_questions``.
"""

import re
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fixedpipe.effects.arithmetic.rule import encoded, single_of
from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.emulators.names import function_of
from fixedpipe.effects.emulators.sources import FOLDER
from fixedpipe.pipeline.enums import PrimitiveType, ProvokingVertex
from fixedpipe.pipeline.vertices import chip_floats
from fixedpipe.pipeline.vertices.assembly import split
from fixedpipe.pipeline.vertices.chip_floats import LIGHTING_BITS, multiply_add
from tests.documents import WIDTH, table
from tests.emulators.glsl import Translation

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "open-questions.md"
ANSWERS_C = ROOT / "docs" / "examples" / "nv2a_answers.h"
ANSWERS_GLSL = ANSWERS_C.with_suffix(".glsl")
ACCEPTED = ROOT / "tests" / "conformance" / "accepted.txt"
XEMU = "https://github.com/xemu-project/xemu"
SHOWN = 2  # vectors of a function


# ------------------------------------------------------------------------------- functions made of the rules


def _product(a, b):
    return chip_floats.product(a, b, LIGHTING_BITS)


def _sum(a, b):
    return chip_floats.total([a, b], LIGHTING_BITS, 0)


def _quotient(strength, above, below, dark):
    with np.errstate(invalid="ignore"):  # 0 times infinity, which is 0 there
        made = _product(_product(strength, above), chip_floats.lighting_reciprocal(below))
    return np.where(dark, 0.0, made)


def reaches(reach, distance):
    """Whether a light of a range reaches a distance (N2.16)."""
    return (~(_sum(reach, -distance) < 0)).astype(int)


def cone(strength, x, a, b, c):
    """A spotlight's strength (N2.16)."""
    above = _sum(x, a)
    return _quotient(strength, above, multiply_add(b, x, c, LIGHTING_BITS), (x < 0) | (above <= 0))


def highlight_of_half(strength, x, a, b, c):
    """The highlight by a given half vector (N2.17)."""
    above = _sum(x, a)
    return _quotient(strength, above, multiply_add(x, b, c, LIGHTING_BITS), above < 0)


def highlight(strength, x, square, a, b, c):
    """The highlight by the unit's own half vector (N2.17)."""
    xx = _product(x, x)
    above = multiply_add(square, a, xx, LIGHTING_BITS)
    below = multiply_add(square, c, _product(xx, b), LIGHTING_BITS)
    return _quotient(strength, above, below, (x < 0) | (above < 0))


def point_covers(dx, dy, size):
    """Whether a point covers a sample (N11.10)."""
    closed = np.where(size & (size - 1) == 0, size - 1, size)
    return ((-size <= dx) & (dx <= closed) & (-size <= dy) & (dy <= closed)).astype(int)


# OpenGL's numbers of the primitives.
_NAMES = {
    4: "TRIANGLES",
    5: "TRIANGLE_STRIP",
    6: "TRIANGLE_FAN",
    7: "QUADS",
    8: "QUAD_STRIP",
    9: "POLYGON",
}


def flat_vertex(kind, k, first):
    """The vertex that gives a flat primitive its colour, of the machine's own assembly."""
    primitive = PrimitiveType[_NAMES[kind]]
    quads = primitive in (PrimitiveType.QUADS, PrimitiveType.QUAD_STRIP)
    rows, _ = split(primitive, [4 * k + 8], ProvokingVertex.FIRST if first else ProvokingVertex.LAST)
    return int(rows[2 * k if quads else k][3])


@dataclass(frozen=True)
class Made:
    """A function of nv2a_answers.h: what it takes, what it gives, how the machine computes it, and inputs."""

    inputs: tuple[str, ...]
    kind: str  # of every input, "single" or "int"
    output: str
    compute: Callable[..., Any]
    given: tuple[tuple[Any, ...], ...]

    def shown(self):
        """Its first vectors as text."""
        lines = []
        for row in self.given[:SHOWN]:
            columns = [np.asarray(v) for v in row] if self.kind == "single" else row
            found = self.compute(*columns)
            given = ", ".join(f"{n} {encoded(self.kind, v)}" for n, v in zip(self.inputs, row, strict=True))
            result = float(found) if self.output == "single" else int(found)
            lines.append(f"`{given}: {encoded(self.output, result)}`")
        return lines


def _bits(*words):
    return tuple(single_of(word) for word in words)


MADE = {
    "nv2a_light_reaches": Made(
        ("range", "distance"),
        "single",
        "int",
        reaches,
        (_bits(0x40A00000, 0x40A00000), _bits(0x40A00000, 0x40A00400)),
    ),
    "nv2a_light_cone": Made(
        ("strength", "x", "a", "b", "c"),
        "single",
        "single",
        cone,
        (
            _bits(0x3F7FF800, 0x3F7F0000, 0xBF6E9C00, 0xC0463C00, 0x404A9400),
            _bits(0x3F7FF800, 0x3F000000, 0xBF6E9C00, 0xC0463C00, 0x404A9400),
        ),
    ),
    "nv2a_light_highlight_of_half": Made(
        ("strength", "x", "a", "b", "c"),
        "single",
        "single",
        highlight_of_half,
        (
            _bits(0x3F800000, 0x3F7C0000, 0xBF373000, 0xBFEE0800, 0x4010F800),
            _bits(0x3F800000, 0x3F200000, 0xBF373000, 0xBFEE0800, 0x4010F800),
        ),
    ),
    "nv2a_light_highlight": Made(
        ("strength", "x", "square", "a", "b", "c"),
        "single",
        "single",
        highlight,
        (
            _bits(0x3F800000, 0x3FFC0000, 0x40780000, 0xBF373000, 0xBFEE0800, 0x4010F800),
            _bits(0x3F800000, 0xBF000000, 0x40780000, 0xBF373000, 0xBFEE0800, 0x4010F800),
        ),
    ),
    "nv2a_point_covers": Made(("dx", "dy", "size"), "int", "int", point_covers, ((8, -8, 8), (12, 12, 12))),
    "nv2a_flat_vertex": Made(("kind", "k", "first"), "int", "int", flat_vertex, ((5, 3, 0), (7, 1, 1))),
}


# -------------------------------------------------------------------------------------------------- the rows


@dataclass(frozen=True)
class Row:
    """A question.

    asked      (words, address) of where it is asked in public; empty: a search found none
    confirmed  what a search of public issues said of it
    answer     sentences
    formula    lines of it
    numbers    rules of docs/numbers.md
    rules      rules with vectors; made: functions of nv2a_answers.h
    captures   SUITE or SUITE/CASE of the accepted counts
    """

    title: str
    asked: tuple[str, str] | None
    confirmed: str
    answer: str
    formula: tuple[str, ...]
    numbers: tuple[str, ...]
    rules: tuple[str, ...]
    made: tuple[str, ...]
    captures: tuple[str, ...]


def _issue(number):
    return f"xemu #{number}", f"{XEMU}/issues/{number}"


ROWS = (
    Row(
        "Depth replace of DOT_ZW",
        _issue(2466),
        "An open issue. It says that xemu computes the dot products and never changes the fragment's depth.",
        "The first dot product is multiplied by the reciprocal R of the second. The floor of this is the "
        "fragment's depth. R is not exact: it is the reciprocal that the rasterizer uses for weights "
        "(N4.10). A depth outside the buffer's range discards the fragment.",
        ("depth = floor(z R(w))", "z = dot of stage i - 1, w = dot of stage i"),
        ("N12.9", "N4.10"),
        ("depth-replace", "weight-reciprocal"),
        (),
        ("Pixel_shader/DotZW",),
    ),
    Row(
        "DOT_REFLECT_SPECULAR_CONST",
        _issue(2469),
        "An open issue. It says that the mode is a stub.",
        "The three dot products are a normal, N. The mode reflects the constant eye vector E at N. Then it "
        "reads a cube map in the direction R that results. DOT_REFLECT_SPECULAR does the same, with the q "
        "coordinates of the three stages as E. The chip normalizes nothing.",
        ("N = (dot of stage i - 2, dot of i - 1, dot of i)", "R = 2 N (N E) - E (N N)"),
        ("N12.8", "N12.7"),
        ("reflection", "cube-face", "cube-texel"),
        (),
        ("Texture_cubemap/DotReflectSpecConst_HiLo_1", "Texture_2D_as_cubemap/DotReflectSpecConst_Bad2D"),
    ),
    Row(
        "DOT_STR_3D",
        _issue(2470),
        "An open issue. It says that the output differs much from hardware.",
        "The three dot products are s, t and r of a 3D texture. If the bound texture is a cube map, as in "
        "the test, the chip always reads face +x. The second formula says where, from 0 to 1 over the face.",
        (
            "(s, t, r) = (dot of stage i - 2, dot of i - 1, dot of i)",
            "cube map: face +x, ((s + 1) / 2, (1 - t) / 2)",
        ),
        ("N12.8", "N12.11"),
        ("dot-mapping-expand-normal", "dot-mapping-unsigned-hilo", "nearest-texel"),
        (),
        (
            "Texture_cubemap/DotSTR3D_-1to1",
            "Texture_cubemap/DotSTR3D_0to1",
            "Texture_cubemap/DotSTR3D_HiLo_1",
        ),
    ),
    Row(
        "Luminance of bumps (BUMPENVMAP_LUM)",
        _issue(2467),
        "An open issue. It says that xemu's result is brighter, and suspects the offset.",
        "R is the bump map's red byte, unsigned. The factor m is not clamped at 1. Each byte C of the "
        "looked-up texel's red, green and blue becomes C'. Its alpha does not change.",
        ("m = R / 255 scale + offset", "n = floor(4096 C / 255 m)", "C' = min(255, (n + 1) 255 >> 12)"),
        ("N12.4", "N12.2"),
        ("offset-luminance", "offset-texture"),
        (),
        ("Pixel_shader/BumpEnvMapLuminance", "Bump_env_lum"),
    ),
    Row(
        "The spotlight's (x + a)/(b x + c)",
        ("xqemu #277", "https://github.com/xqemu/xqemu/issues/277"),
        "xqemu's issue says that it does not handle falloff and exponent. A search found no issue of "
        "xemu's own; its source (vsh-ff.c) marks the place with FIXME.",
        "The cone's axis is the four numbers of SET_LIGHT_SPOT_DIRECTION. Its dot product with (l, 1), "
        "where l is the unit vector to the light, is x, at most 1. The three numbers of "
        "SET_LIGHT_SPOT_FALLOFF are a, b and c. The light's strength S after attenuation becomes S'. It is "
        "0 where x or x + a is below zero. An axis with a NaN or an infinity gives x = 1.",
        ("S' = (S (x + a)) (1 / (b x + c))",),
        ("N2.16", "N2.25", "N2.13"),
        ("lighting-multiply-add", "lighting-reciprocal"),
        ("nv2a_light_cone",),
        (
            "Lighting_spotlight/FoFixed_-0.932112_-3.097628_3.165516",
            "Lighting_spotlight/FoFixed_0.000000_-0.494592_1.494592",
            "Lighting_spotlight/PTFixed_25.000000_0.000000",
            "Lighting_spotlight/PTFixed_0.000000_0.000000",
            "Lighting_range/Spot",
        ),
    ),
    Row(
        "Specular's function",
        ("xemu pull request #2079", f"{XEMU}/pull/2079"),
        "A merged pull request. Its author says that the power which it reconstructs from the registers is "
        "not perfect.",
        "The chip computes no power. The highlight is a quotient of two linear functions, and "
        "SET_SPECULAR_PARAMS has their six coefficients. A directional light without a local viewer takes "
        "the first three as a, b, c. Its x is the normal N times the half vector H of "
        "SET_LIGHT_INFINITE_HALF_VECTOR. Every other light takes the last three. Its h is the sum of the "
        "unit vectors to the viewer (V) and to the light (L). S is the light's strength.",
        (
            "directional: (S (x + a)) (1 / (x b + c)), x = N H, 0 where x + a < 0",
            "otherwise: (S (q a + x x)) (1 / (q c + b (x x))), x = N h, q = h h, h = V + L, 0 where x < 0 or "
            "q a + x x < 0",
        ),
        ("N2.17", "N2.25"),
        ("lighting-multiply-add", "lighting-product", "lighting-reciprocal"),
        ("nv2a_light_highlight_of_half", "nv2a_light_highlight"),
        (
            "Specular/SpecParams_FF_Pow16_0",
            "Specular/SpecParams_FF_NinjaGaidenBlack",
            "Specular/SpecParams_FF_MechAssault",
            "Specular/ControlFlags_FF",
        ),
    ),
    Row(
        "A light's range is inclusive",
        None,
        "A search found no public issue; the suite that shows it came with pull request #202 of "
        "nxdk_pgraph_tests.",
        "A light reaches a vertex whose distance d equals its range. The lighting unit subtracts d from "
        "the range, both with 14 significant bits. Where the difference is below zero, the light adds "
        "nothing to the vertex.",
        ("lit where range - d >= 0",),
        ("N2.16", "N2.12"),
        ("enter-lighting",),
        ("nv2a_light_reaches",),
        ("Lighting_range/Point", "Lighting_range/Spot"),
    ),
    Row(
        "Two-sided light",
        _issue(708),
        "An open issue. A comment says that the setting acts only on faces of the other winding, and that "
        "the back's alpha must be set.",
        "If SET_TWO_SIDED_LIGHT_EN is set, the lighting unit lights every vertex twice. The front colour "
        "comes from the normal and the front's registers. The back colour comes from the negative normal "
        "and the back's registers: material, scene ambient, specular coefficients, and each light's back "
        "colours. The sign of the triangle's area A, not the normal, decides which colour its three "
        "vertices take. Each negative w reverses this. A vertex program's front and back colours are "
        "chosen in the same way. If lighting is enabled, both are lit, with normals that earlier vertices "
        "left (Specular_back/ControlFlags_VS).",
        (
            "A = (x1 - x0) (y2 - y0) - (x2 - x0) (y1 - y0)",
            "A < 0: front, if counter-clockwise is the front; y goes down",
        ),
        ("N3.2", "N2.10"),
        ("snapped-coordinate",),
        (),
        (
            "Lighting_Two_Sided/TwoSidedLighting",
            "Specular_back/SpecParams_FF_Pow24_0",
            "Specular_back/SpecParams_FF_InvMechAssault",
        ),
    ),
    Row(
        "Point parameters and sizes",
        _issue(1914),
        "An open issue. Pull request #2527 closed issue #1913, on SET_POINT_SIZE; its author notes minor "
        "differences in rounding.",
        "SET_POINT_PARAMS holds a, b, c, the bias, the range and the minimum. The vertex's distance from "
        "the eye is d. The function root(u) is 1/sqrt(u) from the lighting unit's table, with no Newton "
        "step: seven bits. S is the size in eighths of a pixel. A point covers the samples of a square, "
        "its left and upper sides included. Its right and lower sides are included too, unless 2 S is a "
        "power of two. Size 0 draws one pixel. A vertex program gives the size directly.",
        (
            "u = a + b d + c d d",
            "size = clamp(root(u) + bias, 0, 1) range + minimum",
            "S = floor(8 size)",
        ),
        ("N11.12", "N11.11", "N11.10"),
        ("lighting-inverse-square-root",),
        ("nv2a_point_covers",),
        ("Point_params", "Point_size", "Point_sprite"),
    ),
    Row(
        "Flat shading (SET_FLAT_SHADE_OP)",
        _issue(704),
        "An open issue. A comment says that the setting only affects flat shaded quads without texture; "
        "the captures show that it affects triangles, strips and fans.",
        "With SET_FLAT_SHADE_OP 0 a triangle has the colours of its last vertex, with 1 those of its "
        "first. The first vertex of a fan's triangle is the one after the centre. The setting does not act "
        "on quads, quad strips and polygons: a quad takes its last vertex, a polygon its first. Texture "
        "coordinates are never flat.",
        (
            "triangle k of a strip: first k, last k + 2",
            "triangle k of a fan: first k + 1, last k + 2",
            "polygon: 0",
            "quad k: 4 k + 3",
        ),
        ("N11.2",),
        ("iterated-color",),
        ("nv2a_flat_vertex",),
        ("Shade_model",),
    ),
    Row(
        "The signed filter",
        _issue(587),
        "An open issue with a list of games. It is about the flags of SET_TEXTURE_FILTER for signed "
        "components.",
        "A signed component is a byte in two's complement. It is filtered as a signed number, by the same "
        "sums with arithmetic shifts. Then the filtered f is doubled, so 127 is 254 in the combiners' "
        "registers of nine bits. The chip filters the texels of a bump map in the same way.",
        ("f = (p (256 - k) + q k + 128) >> 8, p and q from -128 to 127, k from 0 to 255", "register = 2 f"),
        ("N6.6", "N6.9"),
        ("signed-texel", "filter-step", "bilinear"),
        (),
        ("Texture_signed_component_tests", "Bump_map"),
    ),
    Row(
        "Nearest texels at half pixels",
        _issue(2213),
        "An open issue. It shows text windows with crooked borders: small quads with nearest texels, whose "
        "left edges lie at half pixels.",
        "The chip cuts a window coordinate to sixteenths of a pixel, toward zero. The sample of pixel p "
        "lies at its middle. A sample on a left or upper edge is inside. At a vertex the texture "
        "coordinate is the vertex's own: its three terms are cut to 24 bits, so exact boundaries of texels "
        "stay exact. A nearest filter reads the floor of the coordinate T, which counts texels.",
        ("x = trunc(16 x)", "sample at (16 p + 8)", "texel = floor(T)"),
        ("N2.5", "N3.1", "N6.2", "N6.8"),
        ("snapped-coordinate", "coverage", "iterated-coordinate", "nearest-texel"),
        (),
        (
            "Vertex_shader_rounding_tests",
            "TextureWrapMode/CylinderWrapping",
            "Texture_perspective",
        ),
    ),
)


def accepted():
    """{SUITE/CASE: (equal, compared)} of the captures that are redrawn."""
    found = re.findall(r"^(.+): (\d+) / (\d+)$", ACCEPTED.read_text(), re.MULTILINE)
    return {name: (int(equal), int(compared)) for name, equal, compared in found}


def cases_of(capture, counts):
    """The accepted cases that a row's capture names: one, or a suite's."""
    return [name for name in counts if name == capture or name.startswith(f"{capture}/")]


def _shown_counts(capture, counts):
    cases = cases_of(capture, counts)
    exact = sum(counts[name][0] == counts[name][1] for name in cases)
    equal, compared = (sum(counts[name][k] for name in cases) for k in (0, 1))
    return f"{exact} of {len(cases)}", f"{equal} of {compared}"


def _case_text(case):
    given = ", ".join(f"{n} {v}" for n, v in case.items() if n != "expected")
    return f"`{given}: {case['expected']}`".replace("'", "")


def _vectors(rule):
    cases = list(rule.cases(SHOWN, 0))
    chosen = [cases[len(rule.edges) // 2], cases[-1]] if len(cases) > 1 else cases
    return "<br>".join(_case_text(case) for case in chosen[:SHOWN])


def _functions(row):
    rules = [
        [
            f"`{function_of(id_)}`",
            f"[{RULES[id_].numbers}](numbers.md#{RULES[id_].numbers})",
            _vectors(RULES[id_]),
        ]
        for id_ in row.rules
    ]
    made = [[f"`{name}`", "nv2a_answers", "<br>".join(MADE[name].shown())] for name in row.made]
    return rules + made


_HEAD = """\
# Open questions of emulators, answered

After this page you can answer twelve questions that authors of Xbox emulators have asked in public. Each
answer has its formula, the captures of a real NV2A that show it, test vectors, and the functions in C99 and
GLSL that compute it.

    fixedpipe golden export DIR --rules        # the vectors of the rules, one file each
    fixedpipe golden export DIR --code c99     # the functions; --code glsl for shaders

Each answer has two tables. The first counts the captures that fixedpipe redraws exactly, and their equal
pixels. The second names the functions that compute the answer, with a few *test vectors*: inputs with the
right result. Singles and doubles are written as their bits. In formulas two names side by side are a
product, and `floor` and `>>` are as in C.

Functions have the same names in C and in GLSL. The second command above writes most of them. A function with
`nv2a_answers` in the column "rule" is in [nv2a_answers.h](examples/nv2a_answers.h) and
[nv2a_answers.glsl](examples/nv2a_answers.glsl) instead, and calls the others.

[arithmetic-for-emulators.md](arithmetic-for-emulators.md) has every rule, and [numbers.md](numbers.md) every
order of operations. [silicon.md](silicon.md) says what the captures are. A test compares this page with the
rules, and with the accepted counts of the captures. The public issues were read on 2026-11-28; they may have
changed.
"""


def _filled(text):
    """A paragraph in the page's width; commands and headings as they are."""
    if text.startswith((" ", "#")):
        return text
    return textwrap.fill(" ".join(text.split()), WIDTH, break_long_words=False, break_on_hyphens=False)


def page():
    """The page's text."""
    counts = accepted()
    rows = []
    for number, row in enumerate(ROWS, 1):
        asked = "none found" if row.asked is None else f"[{row.asked[0]}]({row.asked[1]})"
        anchor = re.sub(r"[^\w -]", "", f"{number}. {row.title}".lower()).replace(" ", "-")
        cases = [name for capture in row.captures for name in cases_of(capture, counts)]
        exact = sum(counts[name][0] == counts[name][1] for name in cases)
        rows.append([f"[{row.title}](#{anchor})", asked, f"{exact} of {len(cases)}"])
    paragraphs = [_filled(part) for part in _HEAD.split("\n\n")]
    parts = [*paragraphs, table(["question", "asked in public", "exact captures"], rows)]
    for number, row in enumerate(ROWS, 1):
        parts.append(f"## {number}. {row.title}")
        asked = "" if row.asked is None else f"[{row.asked[0]}]({row.asked[1]}): "
        parts.append(_filled(f"{asked}{row.confirmed}"))
        parts.append(_filled(row.answer))
        parts.append("\n".join(f"    {line}" for line in row.formula))
        parts.append("Rules: " + ", ".join(f"[{n}](numbers.md#{n})" for n in row.numbers) + ".")
        captures = [
            [f"{capture}".replace("_", "\\_"), *_shown_counts(capture, counts)] for capture in row.captures
        ]
        parts.append(table(["captures", "exact", "equal pixels"], captures))
        parts.append(
            table(
                ["function in C and GLSL", "rule", "vectors: inputs, and what is expected"], _functions(row)
            )
        )
    return "\n\n".join(part.strip("\n") for part in parts) + "\n"


def answers_glsl():
    """The GLSL of nv2a_answers.h, by the translation that makes the exported functions."""
    translation = Translation()
    for stage in ("numbers", "vertex_programs", "lighting_unit"):  # what the answers call
        translation.of((FOLDER / f"nv2a_{stage}.h").read_text())
    return translation.of(ANSWERS_C.read_text())


if __name__ == "__main__":
    PAGE.write_text(page())
    ANSWERS_GLSL.write_text(answers_glsl())
