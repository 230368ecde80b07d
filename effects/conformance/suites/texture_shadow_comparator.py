"""Texture_shadow_comparator: a depth texture compared with one depth by every function.

A name has, in order: the chip's projective stage (2: zero is compared, 3: r); R for words written to memory,
F and P for depths drawn by the fixed function and by a vertex program; the depth format; the depths' range;
the compared depth; the function. Source: src/tests/texture_shadow_comparator_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import cache, partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.vertex_programs import toward_zero
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    DepthFormat,
    InternalFormat,
    PrimitiveType,
    Register,
    TexelWord,
    TextureCompareMode,
    TextureTarget,
    WindowOrigin,
)
from fixedpipe.pipeline.state import CombinerInput, DepthTest, GeneralCombiner, RGBPortion, TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Texture_shadow_comparator"

FUNCTIONS = {
    "N": ComparisonFunction.NEVER,
    "GT": ComparisonFunction.GREATER,
    "EQ": ComparisonFunction.EQUAL,
    "GE": ComparisonFunction.GEQUAL,
    "LT": ComparisonFunction.LESS,
    "NE": ComparisonFunction.NOTEQUAL,
    "LE": ComparisonFunction.LEQUAL,
    "A": ComparisonFunction.ALWAYS,
}
STAGES = {"2": TextureCompareMode.COMPARE_ZERO_TO_TEXTURE, "3": TextureCompareMode.COMPARE_R_TO_TEXTURE}
RAW = (  # bits, smallest and largest word, the one that is compared
    (16, 0, 0xFFFF, 0x7FFF),
    (16, 0, 256, 128),
    (16, 256, 512, 384),
    (24, 0, 0xFFFFFF, 0x7FFFFF),
    (24, 0, 256, 128),
    (24, 256, 512, 384),
)
NEAR, FAR = -6.0, 193.0
DRAWN = (  # how, depth format, nearest and farthest eye-space z (less 7), the one that is compared
    *(("FP", "16", NEAR, FAR, 5.94), ("FP", "16", 10.0, 20.0, 15.0)),
    *(("FP", "16f", NEAR, FAR, 4.5669), ("FP", "16f", 10.0, 20.0, 14.04)),
    *(("FP", "24", NEAR, FAR, 10.65), ("F", "24", 10.0, 20.0, 11.47), ("P", "24", 10.0, 20.0, 11.45)),
)
DEPTHS = {  # the buffer, its texture, its largest depth
    "16": (DepthFormat.FIXED_16, InternalFormat.DEPTH_COMPONENT16, 65535.0),
    "16f": (DepthFormat.FLOAT_16, InternalFormat.DEPTH_COMPONENT16_FLOAT, 511.9375),
    "24": (DepthFormat.FIXED_24, InternalFormat.DEPTH_COMPONENT24, 16777215.0),
}
SQUARES = 15  # along each edge of the written texture
BOX_WIDTH, BOX_HEIGHT, BOX_STEP = 21, 64, 63  # seven boxes in the middle, and from one to the next
BOX_LEFT, BOX_TOP = WIDTH // 2 - BOX_STEP * 3 + BOX_WIDTH // 2, HEIGHT // 2 - BOX_WIDTH // 2
MARKERS = (0xFFFFAA00, 0xFFFF7700, 0xFFCC5500, 0xFF00FF00, 0xFF00AACC, 0xFF005577, 0xFF002266)
EPSILON = 0.0125
SHOWS_RESULT = replace(
    scenes.SHOWS_TEXTURE0,
    general=(GeneralCombiner(rgb=RGBPortion(a=CombinerInput(Register.TEXTURE0))),),  # alpha: the primary's
)


@cache
def written_words(bits, low, high, reference):
    """int64 [HEIGHT, WIDTH]: squares of growing depth, the seven boxes; 24-bit depths lie above a byte."""
    value, step = np.float32(low), np.float32(high) / np.float32(SQUARES * SQUARES)
    width, height = WIDTH // SQUARES, HEIGHT // SQUARES
    left, shift = (WIDTH - width * SQUARES) // 2, 0 if bits == 16 else 8
    words = np.full((HEIGHT, WIDTH), reference << shift, np.int64)
    for row in range(SQUARES):
        for column in range(SQUARES):
            at = left + column * width
            # The program writes these without the shift of the others.
            words[row * height :][:height, at : at + width] = int(value) & (2 ** (bits + shift) - 1)
            value = value + step
    for k, depth in enumerate((0, 1, reference - 1, reference, reference + 1, high - 1, high)):
        at = BOX_LEFT + k * BOX_STEP
        words[BOX_TOP : BOX_TOP + BOX_HEIGHT, at : at + BOX_WIDTH] = depth << shift
    return words


def _unit(stage, function):
    sampler = replace(scenes.NEAREST, compare_mode=STAGES[stage], compare_function=FUNCTIONS[function])
    return TextureUnit("depths", sampler)


def _markers(nudge):
    """Triangles, device pixels moved by ``nudge``, that show where the boxes are."""
    positions, colors = [], []
    for k, color in enumerate(MARKERS):
        left, top = BOX_LEFT + k * BOX_STEP + nudge, BOX_TOP + nudge
        positions += [
            (left + BOX_WIDTH / 4, top + BOX_HEIGHT / 2, 0.0),
            (left + BOX_WIDTH / 2, top + BOX_HEIGHT / 4, 0.0),
            (left + BOX_WIDTH * 3 / 4, top + BOX_HEIGHT / 2, 0.0),
        ]
        colors += [scenes.abgr(color)] * 3
    mesh = scenes.window_mesh(positions, PrimitiveType.TRIANGLES, colors=colors)
    return Draw(label="markers", mesh=mesh, state=scenes.DEFAULT)


def _compared(corners, unit, reference):
    """A quad that shows the comparison of the whole texture."""
    coordinates = [(s * WIDTH, t * HEIGHT, reference, 1.0) for s, t in scenes.UNIT_SQUARE]
    mesh = scenes.window_mesh(corners, texture_coordinates=(scenes.single(coordinates),))
    state = replace(
        scenes.DEFAULT,
        register_combiners=SHOWS_RESULT,
        texture_units=(unit,),
    )
    return Draw(label="compared", mesh=mesh, state=state)


def _raw(stage, function, bits, low, high, reference):
    kind = TexelWord.Y16_FIXED if bits == 16 else TexelWord.X8_Y24_FIXED
    words = written_words(bits, low, high, reference)
    image = texture_of_words(words, kind, TextureTarget.TEXTURE_RECTANGLE)
    corners = scenes.rectangle(0, 100, WIDTH, HEIGHT - 100)
    return (
        scenes.clear(0xFE112233),
        TexImage(label="depths", texture="depths", image=image),
        _compared(corners, _unit(stage, function), reference),
        _markers(0.0),
    )


def _projected(z, largest):
    """Depth units of z in the XDK's default view: through one matrix in single precision, toward zero.

    Measured: the fixed function at the near plane draws 24-bit depths above zero (2F24_-6.00-193.00_10.6500);
    the depths to be compared, which captures print, are 0xF35B40 and 0xF2B592 (3F24), 0xED66 (3F16).
    """
    scale = scenes.single(scenes.single(200.0 / 199.0) * largest)
    offset = scenes.single(scenes.single(scale * scenes.XDK_EYE) - scale)
    depth = toward_zero(toward_zero(scale * scenes.single(z)) + offset)
    return float(toward_zero(depth * toward_zero(1.0 / scenes.single(z + scenes.XDK_EYE))))


def _programmed(z, largest):
    """Depth units of z as the vertex program, and its class on the host, compute them.

    Measured: the depth to be compared, which captures print, is 0xF35760 (3P24_10.00-20.00_11.4500).
    """
    return float(vertex_programs.perspective([(0.0, 0.0, z)], depth_maximum=largest)[0, 2])


def _drawn(how, stage, function, depth, low, high, reference):
    buffer, texture, largest = DEPTHS[depth]
    nudge, depth_of = (0.5, _projected) if how == "F" else (0.0, _programmed)
    left, top = WIDTH * 0.00125 + nudge, HEIGHT * 0.0125 + nudge
    right, bottom = WIDTH - WIDTH * 0.00125 + nudge, HEIGHT - HEIGHT * 0.0125 + nudge

    def corners(left, top, right, bottom, above, below):
        depths = [depth_of(z, largest) for z in (above, above, below, below)]
        places = scenes.rectangle(left, top, right, bottom)
        eyes = [z + scenes.XDK_EYE for z in (above, above, below, below)]
        return [(x, y, z, w) for (x, y, _), z, w in zip(places, depths, eyes, strict=True)]

    quads = corners(left, top, right, bottom, low, high)
    steps = (low, low + EPSILON, reference - EPSILON, reference, reference + EPSILON, high - EPSILON, high)
    for k, z in enumerate(steps):
        x, y = BOX_LEFT + k * BOX_STEP + nudge, BOX_TOP + nudge
        quads += corners(x, y, x + BOX_WIDTH, y + BOX_HEIGHT, z, z)
    state = replace(scenes.DEFAULT, depth_test=DepthTest(ComparisonFunction.ALWAYS))
    shown = scenes.rectangle(left, HEIGHT * 0.2 + nudge, right, HEIGHT * 0.8 + nudge)
    return (
        MakeCurrent(label="memory", surface="depths", width=WIDTH, height=HEIGHT, depth_bits=buffer),
        scenes.clear(0xFE332211),
        Draw(label="depths", mesh=scenes.window_mesh(quads), state=state),
        MakeCurrent(label="window"),
        scenes.clear(0xFE443333),
        BindTexImage(
            label="depths",
            texture="depths",
            surface="depths",
            target=TextureTarget.TEXTURE_RECTANGLE,
            internal_format=texture,
            origin=WindowOrigin.UPPER_LEFT,
        ),
        _compared(shown, _unit(stage, function), depth_of(reference, largest)),
        _markers(nudge),
    )


def _cases():
    for stage, function in product(STAGES, FUNCTIONS):
        for bits, low, high, reference in RAW:
            name = f"{stage}R{bits}_{low:X}-{high:X}_{reference:X}_{function}"
            yield name, partial(Case.of, _raw, stage, function, bits, low, high, reference)
        for hows, depth, low, high, reference in DRAWN:
            for how in hows:
                name = f"{stage}{how}{depth}_{low:.2f}-{high:.2f}_{reference:.4f}_{function}"
                yield name, partial(Case.of, _drawn, how, stage, function, depth, low, high, reference)


CASES = dict(_cases())
