"""Texture_border_color: the border colour around textures of nineteen formats, over a checkerboard.

Source: src/tests/texture_border_color_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import WIDTH, Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TexelWord, TextureTarget, WrapMode
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Texture_border_color"

SIZE, BORDER, BYTE = 8, 0x33FF22CC, 0x80  # texels; the colour; every byte of the texture
QUAD, SPACING, LEFT, TOP = 64, 99, 64, 96  # pixels
_BYTES = {TexelWord.A8: 1, TexelWord.R5G6B5: 2, TexelWord.R8B8: 2, TexelWord.G8B8: 2, TexelWord.R6G5B5: 2}
_BYTES[TexelWord.X1R5G5B5] = 2  # the others have four
_LONG = (TexelWord.A8R8G8B8, TexelWord.X8R8G8B8, TexelWord.A8B8G8R8, TexelWord.B8G8R8A8, TexelWord.R8G8B8A8)
_SHORT = TexelWord.A8, TexelWord.R5G6B5
SWIZZLED = (*_SHORT, TexelWord.R8B8, TexelWord.G8B8, TexelWord.R6G5B5, *_LONG)
LINEAR = (*_SHORT, TexelWord.G8B8, TexelWord.X1R5G5B5, *_LONG)


def _case():
    commands = [scenes.clear(0xFF101010), *scenes.background(0xFF000000, 0xFF444444)]
    sampler = replace(
        scenes.NEAREST,
        wrap_s=WrapMode.CLAMP_TO_BORDER,
        wrap_t=WrapMode.CLAMP_TO_BORDER,
        border_color=scenes.argb(BORDER),
    )
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit("texture", sampler),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    left, top = LEFT, TOP
    for target, formats in ((TextureTarget.TEXTURE_2D, SWIZZLED), (TextureTarget.TEXTURE_RECTANGLE, LINEAR)):
        edge = 1.0 if target is TextureTarget.TEXTURE_2D else float(SIZE)
        st = edge * (2.0 * scenes.UNIT_SQUARE - 0.5)
        for word in formats:
            texel = int.from_bytes([BYTE] * _BYTES.get(word, 4))
            image = texture_of_words(np.full((SIZE, SIZE), texel), word, target)
            corners = scenes.unprojected_rectangle(left, top, left + QUAD, top + QUAD)
            commands += [
                TexImage(label=word.name, texture="texture", image=image),
                Draw(
                    label=word.name,
                    mesh=scenes.window_mesh(corners, texture_coordinates=(st,)),
                    state=state,
                ),
            ]
            left += SPACING
            if left > WIDTH - SPACING:
                left, top = LEFT, top + SPACING
    return Case(commands=tuple(commands))


CASES = {"TextureBorderColor": _case}
