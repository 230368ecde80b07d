"""Bump_map: a bump texture in every format offsets a checkerboard; 16-bit ones address it by dot products.

Source: src/tests/bump_map_tests.cpp of nxdk_pgraph_tests.
"""

from functools import partial

import numpy as np

from fixedpipe.effects.conformance import bump_quads, scenes
from fixedpipe.pipeline.enums import DotProductMapping, Register, TexelWord
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import SignedComponents, TextureShaderStage
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Bump_map"

FORMATS = bump_quads.formats(without=("R16B16",))
COLORS = (0x007F4500, 0x00804500, 0x007F4500, 0x00804500)
CROSSED = (0x00457F00, 0x00457F00, 0x00458000, 0x00458000)
MATRIX, TURNED = (0.3, 0.0, 0.5, 0.0), (0.0, -0.1, 0.0, 0.3)  # columns
# HI and LO, 16 bits each: a byte of the program's colours becomes a word as of its format's other textures.
WORDS = (0x02020101, 0x02020303, 0xFFFF0101, 0xFFFF0303)
CROSSED_WORDS = (0x02020303, 0x0202FFFF, 0x00000303, 0x0000FFFF)
CHECKERS = (0xFF0000FE, 0x7F202122)


def _hilo(crossed):
    at = (np.arange(bump_quads.SIZE) >= 2).astype(int)
    words = np.array(CROSSED_WORDS if crossed else WORDS)[at[:, None] * 2 + at[None]]
    dot = {"dot_product_mapping": DotProductMapping.UNSIGNED_HILO}
    stages = (
        TextureShaderStage(Operation.TEXTURE_2D),
        TextureShaderStage(Operation.DOT_PRODUCT, **dot),
        TextureShaderStage(Operation.DOT_PRODUCT_TEXTURE_2D, **dot),
    )
    rows = [np.zeros((4, 3)), np.zeros((4, 3))]
    rows[0][:, 0], rows[1][:, 1] = 10.0, 15.0
    rows[0][:, 2], rows[1][:, 2] = scenes.UNIT_SQUARE.T
    return bump_quads.case_of(
        texture_of_words(words, TexelWord.R16B16),
        False,
        stages,
        Register.TEXTURE2,
        lambda column, row: SignedComponents(green=column, alpha=row),
        CHECKERS,
        rows,
    )


def _case(form, crossed=False, turned=False):
    return bump_quads.offset_case(
        CROSSED if crossed else COLORS,
        FORMATS[form],
        Operation.OFFSET_TEXTURE_2D,
        TURNED if turned else MATRIX,
        lambda column, row: SignedComponents(green=row, blue=column),
        CHECKERS,
    )


CASES = {
    **{f"BumpMap_{form}": partial(_case, form) for form in FORMATS},
    **{f"BumpMap_{e}": partial(_case, "G8B8", *s) for e, s in bump_quads.variants("G8B8").items()},
    "BumpMap_R16B16": partial(_hilo, False),
    "BumpMap_R16B16_B": partial(_hilo, True),
}
