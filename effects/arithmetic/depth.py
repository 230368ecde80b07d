"""Coverage, weights, iterated colours, coordinates and depths: docs/numbers.md, sections 3 to 6."""

import numpy as np

from fixedpipe.effects.arithmetic.rule import Rule, fraction, ordinary, single_of
from fixedpipe.pipeline.enums import DepthFormat
from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.raster.columns import interpolate
from fixedpipe.raster.columns.w_slope import w_slope

SUBPIXEL_BITS = 4
STAGE = "Rasterization"
_INSIDE = ((3, 5, 8), (1, 1, 2), (5, 3, 8), (8, 5, 3), (0, 0, 1), (0, 7, 0), (1 << 20, 1, 1), (7, 0, 7))
_ONES = (1.0, 1.0, 1.0)


def _edges(chance):
    """Edge functions of a pixel inside a triangle."""
    return [chance.below(1 << 20) for _ in range(2)] + [1 + chance.below(1 << 20)]


def _inverse_w(chance):
    return [abs(ordinary(chance, 3)) for _ in range(3)]


def _columns(values):
    return tuple(np.array([v]) for v in values)


# ------------------------------------------------------------------------------------------------ coverage


def _covers(x, y, px, py):
    inside, _ = interpolate.covered_pixels(x, y, _ONES, (px, py, px + 1, py + 1), SUBPIXEL_BITS)
    return len(inside)


def _triangle(chance):
    corners = [[chance.below(16 * 16 + 1) - 64 for _ in range(3)] for _ in "xy"]
    return (*corners, chance.below(12), chance.below(12))


COVERAGE = Rule(
    id="coverage",
    stage=STAGE,
    numbers="N3.1",
    formula="1 where all edge functions at (16 px + 8, 16 py + 8) are positive, or 0 on a top or left edge",
    in_words=True,
    evidence="Measured: 294000 of 294000 pixels (TopLeftRaster)",
    captures=("Vertex_shader_rounding_tests/TopLeftRaster", "3D_primitive"),
    inputs={"x": "int[3]", "y": "int[3]", "px": "int", "py": "int"},
    output="int",
    compute=_covers,
    edges=tuple(
        (x, y, px, py)
        for x, y in (([8, 40, 8], [8, 8, 40]), ([40, 8, 40], [8, 40, 40]), ([8, 8, 40], [40, 8, 8]))
        for px in range(3)
        for py in range(3)
    ),
    draw=_triangle,
)

# ----------------------------------------------------------------------------------------- colours, s and t


def _weights(n, inverse_w):
    return interpolate.iteration_weights(_columns(n), np.array([inverse_w]))


def _reciprocal(total):
    return interpolate.reciprocal_24(np.array([total]))[0]


def _total(chance):
    return float((1 << 23) + chance.below(1 << 23))


def _color(n, inverse_w, c):
    q0, q2 = _weights(n, inverse_w)
    return interpolate.iterate_colors(q0, q2, np.array([c])[:, :, None], 8)[0, 0]


def _coordinate(n, inverse_w, v):
    q0, q2 = _weights(n, inverse_w)
    corners = np.repeat(np.array([v], np.float64)[:, :, None], 4, axis=2)
    return interpolate.iterate_coordinates(q0, q2, corners)[0][0, 0]


def _divided(c, q):
    return interpolate.times_reciprocal_of_q(np.array([[c, 0.0, 0.0, q]]))[0, 0]


_WEIGHED = tuple((list(n), list(w)) for n in _INSIDE for w in (_ONES, (1.0, 0.5, 0.25)))
ITERATED = (
    Rule(
        id="weight-reciprocal",
        stage=STAGE,
        numbers="N4.10",
        formula="1/s, s of 24 bits: x = 1/(s rounded to 15 bits), rounded to 12 at a half less 2^-9, "
        "t = 1 - s x rounded to 2^-24, halves toward zero, T24(x + x t)",
        in_words=True,
        evidence="Measured: 1541 of 1552 sums, the others have other open bits; Inferred: x",
        captures=("W_buffering/WBuf24D_FloorQuad_V0_ZB0_ZS0", "Fog_gen/FogGen_FF-exp-planar"),
        inputs={"s": "single"},
        output="double",
        compute=_reciprocal,
        edges=(
            (1.0,),
            (8388609.0,),
            (16777215.0,),
            (13675739.0,),
            (13182276.0,),
            (13336576.0,),
            (13009920.0,),
        ),
        draw=lambda chance: (_total(chance),),
    ),
    Rule(
        id="iteration-weights",
        stage=STAGE,
        numbers="N4.4",
        formula=(
            "q = T24(e r): e = T24(T24(n) f), f = T24(product of the other two w), or 1 where the three are "
            "equal (N4.9); r = weight-reciprocal of the sum of e, each cut a bit below the largest's 24 "
            "(N4.10); the largest q is T24(1 - c(a) - c(b)) of the others, c cutting to 2^-25 (N4.8); of "
            "vertices 0 and 2"
        ),
        in_words=True,
        evidence="Measured: 64522 of 64522 pixels; in perspective 230809 of 230809 texels in each of 16",
        captures=("Alpha_func", "Depth_buffer", "Line_width", "W_buffering/WBuf24D_FloorQuad_V0_ZB0_ZS0"),
        inputs={"n": "int[3]", "inverse_w": "single[3]"},
        output="double[2]",
        compute=lambda n, inverse_w: [q[0] for q in _weights(n, inverse_w)],
        edges=_WEIGHED,
        draw=lambda chance: (_edges(chance), _inverse_w(chance) if chance.below(2) else list(_ONES)),
    ),
    Rule(
        id="iterated-color",
        stage=STAGE,
        numbers="N4.4",
        formula="(w0 c0 + w1 c1 + w2 c2 + 128) >> 8, w0 and w2 floor(256 q) of the weights, w1 the rest",
        in_words=True,
        evidence="Measured: 64522 of 64522 pixels; in perspective at most 3 pixels of 307,200 are open",
        captures=("Alpha_func", "Depth_buffer", "Line_width", "Shade_model"),
        inputs={"n": "int[3]", "inverse_w": "single[3]", "c": "int[3]"},
        output="int",
        compute=_color,
        edges=tuple((n, w, [0, 255, 128]) for n, w in _WEIGHED),
        draw=lambda chance: (
            _edges(chance),
            _inverse_w(chance) if chance.below(2) else list(_ONES),
            [chance.byte() for _ in range(3)],
        ),
    ),
    Rule(
        id="iterated-coordinate",
        stage=STAGE,
        numbers="N6.2",
        formula="v1 + q0 (v0 - v1) + q2 (v2 - v1), each term cut to the last of 24 bits of the largest",
        in_words=True,
        evidence="Measured: CylinderWrapping 48768 of 48768 pixels; Anisotropy-1, 41199 of 41199",
        captures=("TextureWrapMode/CylinderWrapping", "Texture_anisotropy/Anisotropy-1", "Volume_texture"),
        inputs={"n": "int[3]", "inverse_w": "single[3]", "v": "single[3]"},
        output="double",
        compute=_coordinate,
        edges=tuple((n, w, v) for n, w in _WEIGHED for v in ([0.0, 1.0, 0.0], [-0.5, 1.5, 0.25])),
        draw=lambda chance: (
            _edges(chance),
            _inverse_w(chance) if chance.below(2) else list(_ONES),
            [ordinary(chance, 2) for _ in range(3)],
        ),
    ),
    Rule(
        id="divided-coordinate",
        stage=STAGE,
        numbers="N6.1",
        formula="T24(c r), r the weight-reciprocal of q with its sign; a q of 0 counts as 2^-64",
        in_words=True,
        evidence="Measured: 3 captures are exact by it, and none of 1,671 others changes; Inferred: 2^-64",
        captures=("Texgen_with_texture_matrix", "Texture_Matrix"),
        inputs={"c": "single", "q": "single"},
        output="double",
        compute=_divided,
        edges=(
            *((c, q) for c in (1.0, -1.0, 0.0) for q in (1.0, 3.0, -3.0, 0.0, -0.0)),
            (16777215.0, 13675739.0),
            (2.0**-100, 2.0**100),
        ),
        draw=lambda chance: (ordinary(chance, 4), ordinary(chance, 4)),
    ),
)

# --------------------------------------------------------------------------------------------------- depth


def _depth(n, z):
    return interpolate.iterate_depth(_columns(n), np.array([z]))[0]


def _depth_of_w(n, w):
    corners = np.array([w])
    return interpolate.iterate_w(*interpolate.iteration_weights(_columns(n), 1.0 / corners), corners)[0]


def _slope(x, y, v, factor):
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    corners = np.array([x]), np.array([y])
    return interpolate.depth_slope(*corners, np.array([area]), np.array([v]), factor, SUBPIXEL_BITS)[0]


def _slope_of_w(x, y, w, box):
    return w_slope(np.array(x), np.array(y), np.array(w), 1.0 / np.array(w), box, SUBPIXEL_BITS)


def _corners(chance):
    return [[chance.below(10240) for _ in range(3)] for _ in "xy"]


def _single_of(value):
    return float(np.float32(value))


def _depths(chance):
    return [_single_of(chance.below(1 << 24)) for _ in range(3)]


_SLIVER = [325.0, 325.0, 58.0]  # w of W_buffering's TriH
_SUM = (
    "base + q d + q d; base has the largest exponent of e; q = T24(e r), r = 1/D: x = 1/D in 14 bits, "
    "t = 1 - D x to 2^-30, r = x + x t in 29 bits; terms are cut to the last of the largest's 29 bits"
)
DEPTHS = (
    Rule(
        id="depth",
        stage="Depth",
        numbers="N5.3",
        formula=_SUM,
        in_words=True,
        evidence="Measured: every pixel of the 14 depth buffers and 14 pictures of Depth_buffer",
        captures=("Depth_buffer",),
        inputs={"n": "int[3]", "z": "single[3]"},
        output="double",
        compute=_depth,
        edges=tuple(
            (list(n), z) for n in _INSIDE for z in ([0.0, 65535.0, 16777215.0], [0.0] * 3, [1.5, 1.25, 0.0])
        ),
        draw=lambda chance: (_edges(chance), _depths(chance)),
    ),
    Rule(
        id="depth-of-w",
        stage="Depth",
        numbers="N5.8",
        formula="w1 + q0 (w0 - w1) + q2 (w2 - w1), cut as depths are; the q are iteration-weights",
        in_words=True,
        evidence="Measured: every depth of 36 of 37 buffers without a slope",
        captures=("W_buffering/WBuf24D_LargeZ_V1_ZB0_ZS0_ZB", "W_buffering/WBuf24F_TriH_V1_ZB1_ZS0_ZB"),
        inputs={"n": "int[3]", "w": "single[3]"},
        output="double",
        compute=_depth_of_w,
        edges=tuple((list(n), [1.0, 2.0, 4.0]) for n in _INSIDE),
        draw=lambda chance: (_edges(chance), _inverse_w(chance)),
    ),
    Rule(
        id="polygon-offset-slope",
        stage="Depth",
        numbers="N5.4",
        formula="factor * max(abs(dvdx(x, y, v)), abs(dvdy(x, y, v))) if area(x, y) else 0.0",
        evidence="Measured: for axis-aligned slopes in fixed formats; Inferred: otherwise",
        captures=("W_buffering/ZBuf24D_FloorQuad_V1_ZB0_ZS1", "W_buffering/ZBuf24D_WallQuad_V1_ZB0_ZS1_ZB"),
        inputs={"x": "int[3]", "y": "int[3]", "v": "single[3]", "factor": "single"},
        output="double",
        compute=_slope,
        edges=(
            ([0, 1600, 0], [0, 0, 1600], [0.0, 100.0, 0.0], 1.0),
            ([0, 1600, 0], [0, 0, 1600], [0.0, 0.0, -100.0], 2.0),
            ([0, 1600, 3200], [0, 0, 0], [0.0, 1.0, 5.0], 1.0),
            ([8, 24, 8], [8, 8, 24], [16777215.0, 0.0, 8388608.0], -0.5),
        ),
        draw=lambda chance: (*_corners(chance), _depths(chance), ordinary(chance, 2)),
    ),
    Rule(
        id="slope-of-w",
        stage="Depth",
        numbers="N5.9",
        formula="W buffering's slope, from the 2x2 block where the triangle begins in a box (left, top, "
        "right, bottom): max of |dq0 (w0 - w1) + dq2 (w2 - w1)| along x and y, cut to 24 bits; q as in "
        "iteration-weights, but no q is the rest; along x dq0 is the lower row's and dq2 the upper row's, "
        "along y dq0 is the left column's and dq2 the right column's",
        in_words=True,
        evidence="Measured: every depth of 31 of 32 buffers with a slope's factor; Inferred: which block",
        captures=(
            "W_buffering/WBuf24D_FloorQuad_V1_ZB0_ZS1_ZB",
            "W_buffering/WBuf24D_ClipF-150-032_V1_ZB0_ZS1_ZB",
        ),
        inputs={"x": "int[3]", "y": "int[3]", "w": "single[3]", "box": "int[4]"},
        output="double",
        compute=_slope_of_w,
        edges=(
            *(
                (
                    [8 + 16 * k, 168 + 16 * k, 8 + 16 * k],
                    [8, 8, 648],
                    [325.0, 325.0, 58.0],
                    [left, top, 40, 40],
                )
                for k in range(4)
                for left, top in ((0, 0), (3, 6))
            ),
            ([-99, 501, 7], [-40, -40, 600], [3.0, 3.0, 1.0], [0, 0, 40, 40]),
        ),
        draw=lambda chance: (
            *([chance.below(961) - 160 for _ in range(3)] for _ in "xy"),
            _inverse_w(chance),
            [chance.below(8), chance.below(8), 9 + chance.below(31), 9 + chance.below(31)],
        ),
    ),
)


# By format: formula, whether that is a sentence, depths at which a word changes.
_FLOAT = "(E + bias << f) + floor((m - 1) 2^f) of m 2^E, 1 <= m < 2; bias 7 and f 12, or 127 and 16; 0 below"
_FORMATS = {
    DepthFormat.FIXED_16: ("floor(clamp(depth, 0, 65535))", False, (65534.99, 65535.0, 65536.0)),
    DepthFormat.FIXED_24: ("floor(clamp(depth, 0, 16777215))", False, (16777214.5, 16777215.0, 16777216.0)),
    DepthFormat.FLOAT_16: (_FLOAT, True, (2.0**-6, 2.0**-7, 511.0, 511.96875, 512.0)),
    DepthFormat.FLOAT_24: (_FLOAT, True, (2.0**-126, 2.0**-127, 1e38, 2.0**127, 2.0**128)),
}


def _word(depth_format, formula, in_words, near):
    words = DEPTH_WORDS[depth_format]

    def depth_word(depth):
        found, _ = interpolate.depth_words(np.array([depth]), 0.0, words.farthest, words.farthest, words.form)
        return found[0]

    def drawn(chance):
        if in_words:  # every octave of the format and some beside it
            octaves = 24 if depth_format == DepthFormat.FLOAT_16 else 250
            exponent = 127 - octaves // 2 + chance.below(octaves)
            return (single_of(exponent << 23 | chance.below(1 << 23)),)
        return (words.largest * fraction(chance),)

    return Rule(
        id=f"depth-word-{depth_format.name.lower().replace('_', '-')}",
        stage="Depth",
        numbers="N5.6",
        formula=formula,
        in_words=in_words,
        evidence="Measured: every pixel of the 14 depth buffers and 14 pictures of Depth_buffer",
        captures=("Depth_buffer", "Depth_Clamp"),
        inputs={"depth": "double"},
        output="int",
        compute=depth_word,
        edges=tuple((depth,) for depth in (-1.0, 0.0, 0.5, 0.9999999, 1.0, 1.0000001, 2.0, 255.5, *near)),
        draw=drawn,
    )


RULES = (COVERAGE, *ITERATED, *DEPTHS, *(_word(kind, *rest) for kind, rest in _FORMATS.items()))
