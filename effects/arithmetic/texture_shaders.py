"""Texture shaders' coordinates and results: docs/numbers.md, section 12."""

import numpy as np

from fixedpipe.effects.arithmetic.rule import Rule, ordinary
from fixedpipe.pipeline.enums import CullMode, DotProductMapping
from fixedpipe.raster.columns import texture_shader

STAGE = "Texture shaders"

# By mapping: what is made of the texel, an expression or a sentence; captures.
_ALL = "[{} for v in texel[:3]]"
_MAPPINGS = {
    DotProductMapping.UNSIGNED_IDENTITY: (
        _ALL.format("v / 255"),
        ("Pixel_shader/DotST", "Texture_cubemap/DotReflectSpec_0_0to1"),
    ),
    DotProductMapping.EXPAND_NORMAL: (
        _ALL.format("(v - 128) / 127"),
        ("Texture_2D_as_cubemap/DotSTR3D_Bad2D", "Texture_cubemap/DotReflectConst_0_-1to1D3D"),
    ),
    DotProductMapping.SIGNED_ODD: (
        _ALL.format("(2 * signed(v) + 1) / 255"),
        ("Texture_cubemap/DotReflectSpec_0_-1to1GL",),
    ),
    DotProductMapping.SIGNED_IDENTITY: (
        _ALL.format("signed(v) / 127"),
        ("Texture_cubemap/DotReflectConst_0_-1to1",),
    ),
    DotProductMapping.UNSIGNED_HILO: (
        "[(256 * texel[3] + texel[0]) / 65535, (256 * texel[1] + texel[2]) / 65535, 1.0]",
        ("Texture_cubemap/DotSTRCube_HiLo_1",),
    ),
    DotProductMapping.SIGNED_HILO_HEMISPHERE: (
        "hemisphere(256 * texel[3] + texel[0], 256 * texel[1] + texel[2])",
        ("Texture_cubemap/DotSTR3D_HiLoHemi",),
    ),
}


def _mapping(mapping, formula, captures):
    hemisphere = mapping == DotProductMapping.SIGNED_HILO_HEMISPHERE
    open_bits = " but for 1 to 11 pixels of 4 captures" if hemisphere else ""
    return Rule(
        id=f"dot-mapping-{mapping.name.lower().replace('_', '-')}",
        stage=STAGE,
        numbers="N12.7",
        formula=formula,
        evidence=f"Measured: 56909 pixels{open_bits}; the numbers are float64, the last bits are open",
        captures=captures,
        inputs={"texel": "int[4]"},
        output="double[3]",
        compute=lambda texel: [
            float(np.ravel(part)[0]) for part in texture_shader.vector(np.array([texel]), mapping, 8)
        ],
        edges=tuple(([x, y, 255 - x, y],) for x in (0, 1, 127, 128, 129, 255) for y in (0, 127, 128, 255)),
        draw=lambda chance: (chance.color(),),
    )


def _offset(st, texel, matrix):
    moved = texture_shader.offset(np.array([[*st, 0.0, 1.0]]), np.array([texel]), matrix, 8)
    return [column[0] for column in moved]


def _luminance(texel, magnitude, scale, bias):
    return texture_shader.scaled(np.array([texel]), 8, np.array([magnitude]), 8, scale, bias)[0]


def _reflected(normal, eye):
    columns = [[np.array([c]) for c in vector] for vector in (normal, eye)]
    return [column[0] for column in texture_shader.reflected(*columns)]


def _replaced(numerator, denominator):
    with np.errstate(all="ignore"):
        word, inside = texture_shader.replaced_depth(
            np.array([numerator]), np.array([denominator]), 1.0, 0xFFFFFF
        )
    return word[0] if inside[0] else -1


def _vector(count):
    return lambda chance: [ordinary(chance, 3) for _ in range(count)]


_MATRIX = _vector(4)
RULES = (
    *(_mapping(mapping, *rest) for mapping, rest in _MAPPINGS.items()),
    Rule(
        id="shader-result-byte",
        stage=STAGE,
        numbers="N12.2",
        formula="min(255, (floor(4096 * clamp(v, 0.0, 1.0)) + 1) * 255 >> 12)",
        evidence="Measured: 65536 of 65536 and 98304 of 98304 pixels",
        captures=("Pixel_shader/Passthru", "Bump_env_lum"),
        inputs={"v": "single"},
        output="int",
        compute=lambda v: texture_shader.real_texel(np.array([v]), 8)[0],
        edges=tuple(
            (v,) for v in (-1.0, -0.0, 0.0, 2.0**-13, 2.0**-12, 0.5, 1.0 - 2.0**-12, 1.0 - 2.0**-24, 1.0, 2.0)
        ),
        draw=lambda chance: (chance.below((1 << 24) + 1) / (1 << 24),),
    ),
    Rule(
        id="offset-texture",
        stage=STAGE,
        numbers="N12.4",
        formula=(
            "s + a1 ds + a3 dt and t + a2 ds + a4 dt of the signed blue and green texel over 128 and matrix "
            "(a1, a2, a3, a4), each term cut to the last of 24 bits of the largest"
        ),
        in_words=True,
        evidence="Measured: BumpMap_G8B8_B_R90, of which 780 pixels tell; BumpEnvMap, Bump_map, Bump_env_lum",
        captures=("Pixel_shader/BumpEnvMap", "Bump_map", "Bump_env_lum"),
        inputs={"st": "single[2]", "texel": "int[4]", "matrix": "single[4]"},
        output="double[2]",
        compute=_offset,
        edges=tuple(
            ([0.5, 0.25], [0, green, blue, 0], matrix)
            for green, blue in ((0, 0), (128, 127), (255, 1))
            for matrix in ([1.0, 0.0, 0.0, 1.0], [0.0, 0.5, -0.5, 0.0])
        ),
        draw=lambda chance: (_vector(2)(chance), chance.color(), _MATRIX(chance)),
    ),
    Rule(
        id="offset-luminance",
        stage=STAGE,
        numbers="N12.4",
        formula="each colour c: the byte of c (magnitude / 255 * scale + bias) / 255; alpha stays",
        in_words=True,
        evidence="Measured: BumpEnvMapLuminance, Bump_env_lum",
        captures=("Bump_env_lum",),
        inputs={"texel": "int[4]", "magnitude": "int", "scale": "single", "bias": "single"},
        output="int[4]",
        compute=_luminance,
        edges=tuple(
            ([0, 1, 128, 255], m, s, b)
            for m in (0, 1, 128, 255)
            for s, b in ((1.0, 0.0), (0.5, 0.5), (2.0, -1.0))
        ),
        draw=lambda chance: (chance.color(), chance.byte(), ordinary(chance, 2), ordinary(chance, 2)),
    ),
    Rule(
        id="reflection",
        stage=STAGE,
        numbers="N12.8",
        formula="n 2 (n e) - e (n n) of three components each, its dot products as N12.7 has them",
        in_words=True,
        evidence="Measured: up to 56909 of 56909 pixels; the products and difference are float64, their last "
        "bits are open",
        captures=("Texture_cubemap/DotReflectConst_1_-1to1", "Texture_cubemap/DotReflectSpec_1_-1to1GL"),
        inputs={"normal": "single[3]", "eye": "single[3]"},
        output="double[3]",
        compute=_reflected,
        edges=(
            ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
            ([0.0] * 3, [1.0, 2.0, 3.0]),
            ([0.5, 0.0, -0.75], [1.0, 0.0, 0.0]),
        ),
        draw=lambda chance: (_vector(3)(chance), _vector(3)(chance)),
    ),
    Rule(
        id="depth-replace",
        stage=STAGE,
        numbers="N12.9",
        formula="floor(a r), r the weight-reciprocal of b with its sign; -1 where that is outside 0 to "
        "16777215, or b is 0: the fragment ends",
        in_words=True,
        evidence="Measured: 65536 of 65536 quotients (DotZW)",
        captures=("Pixel_shader/DotZW",),
        inputs={"a": "single", "b": "single"},
        output="int",
        compute=_replaced,
        edges=(
            (0.0, 1.0),
            (1.0, 0.0),
            (0.0, 0.0),
            (-1.0, 1.0),
            (16777215.0, 1.0),
            (16777216.0, 1.0),
            (1.0, 3.0),
            (7.0, 2.0),
        ),
        draw=lambda chance: (abs(ordinary(chance, 12)), abs(ordinary(chance, 12))),
    ),
    Rule(
        id="cull-fragment",
        stage=STAGE,
        numbers="N12.3",
        formula="int(all((v < 0) == (mode == 'LESS') for v, mode in zip(strq, modes)))",
        evidence="Measured: 296284 of 296284 (ClipPlane)",
        captures=("Pixel_shader/ClipPlane",),
        inputs={"strq": "single[4]", "modes": "name[4]"},
        output="int",
        compute=lambda strq, modes: texture_shader.kept(np.array([strq]), [CullMode[mode] for mode in modes])[
            0
        ],
        edges=tuple(
            ([v, 1.0, 1.0, 1.0], [mode, *["GEQUAL"] * 3])
            for v in (-1.0, -0.0, 0.0, 1.0)
            for mode in ("LESS", "GEQUAL")
        ),
        draw=lambda chance: (_vector(4)(chance), [chance.one_of(CullMode).name for _ in range(4)]),
    ),
)
