"""Texture_render_target: Texture_format's gradient in every format, drawn to a surface, and that on a square.

Source: src/tests/texture_render_target_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, texture_memory
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import texture_format
from fixedpipe.effects.passes.combiners import ONE, SPARE0, TEXTURE0, stage, total
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TexelWord, WindowOrigin
from fixedpipe.pipeline.state import TextureUnit

SUITE = "Texture_render_target"

SIZE, EDGE, DEPTH = texture_format.SIZE, 1.75, 0.1
TARGET = "target"
OPAQUE = replace(
    scenes.SHOWS_TEXTURE0, general=(stage(total(TEXTURE0, to=SPARE0), alpha=total(ONE, to=SPARE0)),)
)


def _texture_of(name):
    """As Texture_format's, but that this program writes R6G5B5 itself (Measured: 304450 pixels of 304450)."""
    entry = texture_format.FORMATS.get(name)
    if entry is None or entry.word is not TexelWord.R6G5B5:
        return texture_format.texture_of(name)
    return texture_memory.highest_bits(texture_memory.gradient(SIZE, SIZE), entry), 1


def _case(name):
    texture, scale = _texture_of(name)
    st = np.array(scenes.TWO_TRIANGLES, np.float64)
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit("texture", scenes.NEAREST),),
        register_combiners=OPAQUE,
    )
    on_target = scenes.window_mesh(
        np.column_stack([SIZE * st, np.full(6, DEPTH)]),
        PrimitiveType.TRIANGLES,
        height=SIZE,
        texture_coordinates=(st * scale,),
    )
    on_window = scenes.textured_triangles(
        [(EDGE * (2 * s - 1), EDGE * (1 - 2 * t), DEPTH) for s, t in st], st
    )
    shown = replace(state, vertex=scenes.xdk_vertex(), texture_units=(TextureUnit(TARGET, scenes.NEAREST),))
    return Case(
        commands=(
            TexImage(label=name, texture="texture", image=texture),
            MakeCurrent(label=TARGET, surface=TARGET, width=SIZE, height=SIZE),
            Draw(label=TARGET, mesh=on_target, state=state),
            BindTexImage(label=TARGET, texture=TARGET, surface=TARGET, origin=WindowOrigin.UPPER_LEFT),
            MakeCurrent(label="window"),
            scenes.clear(0xFE212021),
            Draw(label="square", mesh=on_window, state=shown),
        )
    )


CASES = {
    name: partial(_case, name)
    for name in (*texture_format.FORMATS, texture_format.COMPRESSED, *texture_format.PALETTED)
}
