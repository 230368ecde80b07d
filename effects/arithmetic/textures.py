"""Texels, wrap modes, filters and cube map faces: docs/numbers.md, sections 6 and 7."""

import math

import numpy as np

from fixedpipe.effects.arithmetic.rule import Rule, ordinary
from fixedpipe.pipeline.columns.textures import UnitSampler
from fixedpipe.pipeline.enums import InternalFormat, TexelWord, TextureFilter, WrapMode
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import Sampler, SignedComponents, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.textures.words import (
    compressed_texture,
    stored_texture,
    texels_of_words,
    ycbcr_to_rgb,
)
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import sample
from fixedpipe.raster.columns.interpolate import log2_q7, major_axis
from fixedpipe.raster.columns.numbers import lerp

UNSIGNED = (0, 1, 2, 126, 127, 128, 129, 254, 255)

# ------------------------------------------------------------------------------------------------- texels

# By kind: the register's red, green, blue and alpha of the word w; captures, SUITE/CASE.
_WORDS = {
    TexelWord.R5G6B5: (
        "[widen(w >> 11 & 31, 5), widen(w >> 5 & 63, 6), widen(w & 31, 5), 255]",
        ("Texture_format/TexFmt_R5G6B5", "Bump_map/BumpMap_R5G6B5"),
    ),
    TexelWord.A1R5G5B5: (
        "[widen(w >> 10 & 31, 5), widen(w >> 5 & 31, 5), widen(w & 31, 5), 255 * (w >> 15 & 1)]",
        ("Volume_texture/A1R5G5B5", "Bump_map/BumpMap_A1R5G5B5"),
    ),
    TexelWord.X1R5G5B5: (
        "[widen(w >> 10 & 31, 5), widen(w >> 5 & 31, 5), widen(w & 31, 5), 255]",
        ("Texture_format/TexFmt_X1R5G5B5", "Volume_texture/X1R5G5B5"),
    ),
    TexelWord.A4R4G4B4: (
        "[17 * (w >> 8 & 15), 17 * (w >> 4 & 15), 17 * (w & 15), 17 * (w >> 12 & 15)]",
        ("Texture_format/TexFmt_A4R4G4B4", "Bump_map/BumpMap_A4R4G4B4"),
    ),
    TexelWord.R6G5B5: (
        "[widen(w >> 10 & 63, 6), widen(w >> 5 & 31, 5), widen(w & 31, 5), 255]",
        ("Texture_format/TexFmt_R6G5B5", "Volume_texture/R6G5B5"),
    ),
    TexelWord.G8B8: (
        "[w & 255, w >> 8 & 255, w & 255, w >> 8 & 255]",
        ("Texture_format/TexFmt_G8B8", "Bump_map/BumpMap_G8B8"),
    ),
    TexelWord.R8B8: (
        "[w >> 8 & 255, w & 255, w & 255, w >> 8 & 255]",
        ("Texture_format/TexFmt_R8B8", "Volume_texture/R8B8"),
    ),
    TexelWord.A8Y8: (
        "[w & 255, w & 255, w & 255, w >> 8 & 255]",
        ("Texture_format/TexFmt_A8Y8", "Volume_texture/A8Y8"),
    ),
    TexelWord.AY8: ("[w & 255] * 4", ("Volume_texture/AY8", "Bump_map/BumpMap_AY8")),
    TexelWord.A8: ("[255, 255, 255, w & 255]", ("Texture_format/TexFmt_A8", "Bump_map/BumpMap_A8")),
    TexelWord.Y16: (
        "[255, w >> 8 & 255, w & 255, 255]",
        ("Texture_format/TexFmt_Y16", "Volume_texture/Y16"),
    ),
}


def _texel(kind, formula, captures):
    own_rule = (TexelWord.G8B8, TexelWord.R8B8, TexelWord.AY8, TexelWord.A8, TexelWord.Y16)
    return Rule(
        id=f"texel-{kind.name.lower()}",
        stage="Texels",
        numbers="N7.2" if kind in own_rule else "N7.1",
        formula=formula,
        evidence="Measured: every pixel of the captures named",
        captures=captures,
        inputs={"w": "int"},
        output="int[4]",
        compute=lambda w: texels_of_words(np.array([w]), kind)[0],
        edges=tuple((w,) for w in (0, 65535, *(1 << bit for bit in range(16)))),
        draw=lambda chance: (chance.below(1 << 16),),
    )


def _dxt(name, captures, evidence, size):
    internal_format = InternalFormat[f"COMPRESSED_RGBA_S3TC_{name}"]

    def compute(block):
        texture = stored_texture(compressed_texture(block, internal_format, 4, 4), NV2A)
        return texture.levels[0][0].tobytes()

    alphas = bytes.fromhex("ff00053977aaccee")[: size - 8]
    colors = (
        "00f8e007e4e4e4e4",
        "e00700f8e4e4e4e4",
        "ffff0000aaaaaaaa",
        "0000000000000000",
        "ffffffffffffffff",
    )
    reverse = bytes.fromhex("00ff053977aaccee")[: size - 8]
    edges = [(head + bytes.fromhex(tail),) for head in {alphas: 0, reverse: 0} for tail in colors]
    return Rule(
        id=name.lower(),
        stage="Texels",
        numbers="N7.4",
        formula="16 texels, the row at t = 0 first, four bytes each; thirds are (2 a + b + 1) // 3"
        + {
            "DXT1": "; then dithered to 5, 6 and 5 bits at (0, 0)",
            "DXT5": "; sevenths of alphas ((7 - k) a + k b + 3) // 7, fifths likewise with 2",
        }.get(name, ""),
        in_words=True,
        evidence=evidence,
        captures=captures,
        inputs={"block": "bytes"},
        output="bytes",
        compute=compute,
        edges=tuple(edges),
        draw=lambda chance: (bytes(chance.below(256) for _ in range(size)),),
    )


def _signed_register(byte):
    sampler = Sampler(
        TextureFilter.NEAREST, TextureFilter.NEAREST, signed_components=SignedComponents(red=True)
    )
    image = texture_2d(np.array([[[byte, 0, 0, 0]]], np.uint8))
    unit = UnitSampler(1, TextureUnit("texel", sampler), image, NV2A)
    return unit.looked_up(np.array([[0.5, 0.5, 0.0, 1.0]]), None, 8)[0, 0]


TEXELS = (
    *(_texel(kind, *rest) for kind, rest in _WORDS.items()),
    Rule(
        id="signed-texel",
        stage="Texels",
        numbers="N6.6",
        formula="2 * signed(byte)",
        evidence="Measured: 732800 of 732800 pixels",
        captures=("Texture_signed_component_tests",),
        inputs={"byte": "int"},
        output="int",
        compute=_signed_register,
        edges=tuple((byte,) for byte in range(256)),
    ),
    Rule(
        id="ycbcr",
        stage="Texels",
        numbers="N7.3",
        formula=(
            "[clamp(v, 0, 255) for v in ((298 * y - 4864 >> 8) + 2 * (409 * (cr - 128) + 128 >> 9), "
            "(298 * y - 4864 >> 8) + 1 - 2 * (100 * (cb - 128) >> 9) - 2 * (208 * (cr - 128) >> 9), "
            "(298 * y - 4864 >> 8) + (516 * (cb - 128) >> 8))]"
        ),
        evidence="Measured: 123904 of 123904 pixels (UYVY_L)",
        captures=("Texture_format/TexFmt_UYVY_L", "Texture_format/TexFmt_YUY2_L"),
        inputs={"y": "int", "cb": "int", "cr": "int"},
        output="int[3]",
        compute=lambda y, cb, cr: ycbcr_to_rgb(y, cb, cr),
        edges=tuple(
            (y, cb, cr) for y in (0, 16, 17, 128, 235, 255) for cb in (0, 128, 255) for cr in (0, 128, 255)
        ),
        draw=lambda chance: tuple(chance.below(256) for _ in "ybr"),
    ),
    _dxt(
        "DXT1",
        ("Texture_DXT/DXT1_plasma_dxt1", "Texture_DXT/MIPDXT1_plasma_dxt1"),
        "Measured: 2048 of 2048 texels; Assumed: a half as (a + b + 1) // 2, colours from 1 to 7 or 3",
        8,
    ),
    _dxt(
        "DXT3",
        ("Texture_DXT/DXT3_plasma_dxt3",),
        "Measured: thirds round to nearest (DXT3_plasma)",
        16,
    ),
    _dxt(
        "DXT5",
        ("Texture_DXT/DXT5_plasma_alpha_dxt5", "Texture_DXT/DXT5_plasma_dxt5"),
        "Measured: every pixel of the captures named, of which one has alphas",
        16,
    ),
)

# ------------------------------------------------------------------------------------------------- filters


def _border(found):
    index, outside = found
    return -1 if outside is not None and outside[0] else index[0]


def _nearest(t, size, wrap):
    (found,), _ = sample.along(np.array([t]), WrapMode[wrap], size, False, 8)
    return _border(found)


def _linear(t, size, wrap):
    pair, weight = sample.along(np.array([t]), WrapMode[wrap], size, True, 8)
    return [*map(_border, pair), weight[0]]


def _places():
    at = (
        -9.5,
        -4.25,
        -1.0,
        -0.5,
        -1 / 512,
        0.0,
        1 / 512,
        0.5,
        0.5 - 1 / 1024,
        1.0,
        3.5,
        3.75,
        4.0,
        4.5,
        7.999,
        12.0,
    )
    return tuple((t, 4, wrap.name) for wrap in WrapMode for t in at)


def _place(chance):
    size = 1 << chance.below(9)
    return (chance.below(5 * size * 4096) - 2 * size * 4096) / 4096.0, size, chance.one_of(WrapMode).name


def _bilinear(p00, p10, p01, p11, a, b):
    level = np.array([[[p00], [p10]], [[p01], [p11]]])[None]
    places = (*tuple(np.array([0.5 + x / 256.0]) for x in (a, b)), None)
    modes = (C.WRAP_CLAMP_TO_EDGE,) * 3
    return sample.filter_level(level, places, None, modes, True, C.TARGET_2D, np.array([0]), 8, None)[0, 0]


FILTERS = (
    Rule(
        id="nearest-texel",
        stage="Textures",
        numbers="N6.8",
        formula="floor(t) of the wrapped coordinate; -1 is the border",
        in_words=True,
        evidence="Measured: 78720 of 78720, nearest; Source: OpenGL 1.2.1 and extensions: borders",
        captures=("TextureWrapMode/CylinderWrapping",),
        inputs={"t": "double", "size": "int", "wrap": "name"},
        output="int",
        compute=_nearest,
        edges=_places(),
        draw=_place,
    ),
    Rule(
        id="linear-texels",
        stage="Textures",
        numbers="N6.8",
        formula="F = floor((t - 0.5) 256) of the wrapped t: F >> 8, (F >> 8) + 1, F & 255; -1 is the border",
        in_words=True,
        evidence="Measured: 349524 of 349524; Inferred: MIRRORED_REPEAT; Source: OpenGL 1.2.1: borders",
        captures=("Texture_DXT/MIPDXT3_plasma_dxt3", "Bump_map"),
        inputs={"t": "double", "size": "int", "wrap": "name"},
        output="int[3]",
        compute=_linear,
        edges=_places(),
        draw=_place,
    ),
    Rule(
        id="filter-step",
        stage="Textures",
        numbers="N6.9",
        formula="p * (256 - f) + q * f + 128 >> 8",
        evidence="Measured: 349524 of 349524",
        captures=("Texture_DXT/MIPDXT3_plasma_dxt3", "Texture_LOD_Bias/LODBias", "Bump_map"),
        inputs={"p": "int", "q": "int", "f": "int"},
        output="int",
        compute=lambda p, q, f: lerp(p, q, f, 8),
        edges=tuple(
            (p, q, f) for p in (-128, -1, *UNSIGNED) for q in (-128, 0, 127, 255) for f in (0, 1, 128, 255)
        ),
        draw=lambda chance: (chance.byte(), chance.byte(), chance.below(256)),
    ),
    Rule(
        id="bilinear",
        stage="Textures",
        numbers="N6.9",
        formula="step(step(p00, p10, a), step(p01, p11, a), b)",
        evidence="Measured: 349524 of 349524",
        captures=("Texture_DXT/MIPDXT3_plasma_dxt3", "Bump_map"),
        inputs={name: "int" for name in ("p00", "p10", "p01", "p11", "a", "b")},
        output="int",
        compute=_bilinear,
        edges=tuple(
            (*p, a, b)
            for p in ((0, 255, 255, 0), (1, 0, 0, 0), (255, 254, 254, 255))
            for a in (0, 1, 127, 128, 255)
            for b in (0, 1, 127, 128, 255)
        ),
        draw=lambda chance: (*(chance.byte() for _ in range(4)), chance.below(256), chance.below(256)),
    ),
    Rule(
        id="lambda",
        stage="Textures",
        numbers="N7.7",
        formula="floor(128 log2(rho2)), exactly, also beside a power of 2^(1/128)",
        in_words=True,
        evidence="Measured: 8 fraction bits, for axis-aligned footprints",
        captures=("Texture_LOD_Bias/LODBias",),
        inputs={"rho2": "double"},
        output="int",
        compute=lambda rho2: log2_q7(np.array([rho2]))[0],
        edges=tuple(
            (rho2,)
            for k in (-3, -1, 0, 1, 2, 16)
            for rho2 in (math.nextafter(2.0**k, 0.0), 2.0**k, 1.5 * 2**k)
        ),
        draw=lambda chance: (ordinary(chance) ** 2,),
    ),
)

# --------------------------------------------------------------------------------------------------- cubes

_SIZE = 64
_DIRECTIONS = (
    *((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    *((0.0, 0.0, -1.0), (1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (0.5, -1.0, 1.0), (0.5, 1.0, -1.0)),
    *((-1.0, -1.0, -1.0), (0.0, 0.0, 0.0), (1.0, 0.25, -0.5)),
)


def _direction(s, t, r):
    return np.array([[s, t, r, 1.0]])


def _on_face(s, t, r):
    places, _ = sample.positions(_direction(s, t, r), C.TARGET_CUBE_MAP, False, (_SIZE, _SIZE, 6))
    return [places[0][0], places[1][0]]


def _ordinary(chance):
    return tuple(ordinary(chance, 3) for _ in "str")


_CUBE = "Measured: for nearest, 56909 of 56909 pixels; Assumed: ties"
CUBES = (
    Rule(
        id="cube-face",
        stage="Textures",
        numbers="N6.10",
        formula="the axis of the largest magnitude, x before y before z; +x, -x, +y, -y, +z, -z are 0 to 5",
        in_words=True,
        evidence=_CUBE,
        captures=("Texture_cubemap/Cubemap",),
        inputs={"s": "single", "t": "single", "r": "single"},
        output="int",
        compute=lambda s, t, r: major_axis(_direction(s, t, r))[0],
        edges=_DIRECTIONS,
        draw=_ordinary,
    ),
    Rule(
        id="cube-texel",
        stage="Textures",
        numbers="N6.10",
        formula="(sc / |ma| + 1) 32 + 2^-24 and (tc / |ma| + 1) 32 + 2^-24 on a face of 64 texels an edge",
        in_words=True,
        evidence=_CUBE,
        captures=("Texture_cubemap/Cubemap",),
        inputs={"s": "single", "t": "single", "r": "single"},
        output="double[2]",
        compute=_on_face,
        edges=_DIRECTIONS,
        draw=_ordinary,
    ),
)

RULES = (*TEXELS, *FILTERS, *CUBES)
