"""Volume_texture: seven quads through the four layers of a 3D texture, in every swizzled format and DXT1.

The program converts layers with SDL alone. So for depth formats and DXT1 the chip reads bytes of R8G8B8A8
layers. Depths are compared, and the program's default function is NEVER. Source:
src/tests/volume_texture_tests.cpp of nxdk_pgraph_tests, src/texture_stage.cpp of pbkitplusplus.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, texture_memory
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites.texture_format import palette
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    InternalFormat,
    TexelWord,
    TextureCompareMode,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.words import compressed_volume, paletted_texture

SUITE = "Volume_texture"

SIZE, LAYERS, QUADS = 256, 4, 7
LEFT, RIGHT, TOP, BOTTOM, SPACING = -2.75, 2.75, 1.75, -1.75, 0.1
WIDTH, HEIGHT = (RIGHT - LEFT) / 3 - 2 * SPACING, (TOP - BOTTOM) / 3 - 2 * SPACING
PLACES = ((0, 0), (1, 0), (2, 0), (1, 1), (0, 2), (1, 2), (2, 2))  # column and row of each quad
KEPT = ((1, 1, 1, 1), (0, 0, 1, 1), (1, 0, 0, 1), (0, 1, 0, 1))  # the components that each layer shows
PALETTED, COMPRESSED = "SZ_Index8", "DXT1"
DEPTHS = {entry.name: entry for entry in texture_memory.DEPTHS}
FORMATS = {entry.name: entry for entry in texture_memory.FORMATS if not entry.linear} | DEPTHS


def texture(name):
    """The 3D texture: a gradient in other components on every layer, or runs of a palette's quarters."""
    if name == PALETTED:
        rows = np.arange(SIZE) % 64 + np.arange(LAYERS)[:, None] * 64
        indices = np.repeat(rows[..., None], SIZE, 2)
        return paletted_texture(indices, palette(256), TextureTarget.TEXTURE_3D)
    gradient = texture_memory.gradient(SIZE, SIZE)
    layers = np.stack([gradient * np.array(kept, np.uint8) for kept in KEPT])
    if name == COMPRESSED:
        words = texture_memory.packed_words(layers, TexelWord.R8G8B8A8).astype("<u4")
        dxt1 = InternalFormat.COMPRESSED_RGBA_S3TC_DXT1
        return compressed_volume(words.tobytes(), dxt1, SIZE, SIZE, LAYERS)
    return texture_memory.volume_of(layers, FORMATS[name])


def mesh():
    """Two triangles for each quad; r rises from quad to quad, and is one on the last."""
    positions, coordinates, r = [], [], np.float32(0)
    for number, (column, row) in enumerate(PLACES):
        left, top = LEFT + column * (WIDTH + SPACING), TOP - row * (HEIGHT + SPACING)
        layer = 1.0 if number == QUADS - 1 else float(r)
        for s, t in scenes.TWO_TRIANGLES:
            positions.append((left + s * WIDTH, top - t * HEIGHT, 0.0))
            coordinates.append((s, t, layer))
        r += np.float32(1 / QUADS)
    return scenes.textured_triangles(positions, coordinates)


def _case(name):
    sampler = replace(scenes.NEAREST, wrap_r=WrapMode.CLAMP_TO_EDGE)
    if name in DEPTHS:
        sampler = replace(
            sampler,
            compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE,
            compare_function=ComparisonFunction.NEVER,
        )
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.xdk_vertex(),
        texture_units=(TextureUnit("volume", sampler),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    return Case(
        commands=(
            scenes.clear(0xFE202020),
            TexImage(label=name, texture="volume", image=texture(name)),
            Draw(label="quads", mesh=mesh(), state=state),
        )
    )


CASES = {name: partial(_case, name) for name in (*FORMATS, COMPRESSED, PALETTED)}
