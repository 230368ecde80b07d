"""2D_Lines: single lines of the chip's two-dimensional engine, which excludes a line's last pixel.

Source: src/tests/two_d_line_tests.cpp of nxdk_pgraph_tests. The pipeline has no such engine. Its lines in
STEPS between pixel centres replace it, because they also begin with their first pixel and end before their
last. Measured: 200 and 1 pixels of the two captures; Assumed for lines that are neither level nor upright.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType, TexelWord
from fixedpipe.pipeline.state import LineState
from fixedpipe.pipeline.textures.words import texels_of_words

SUITE = "2D_Lines"

WORDS = {"24": TexelWord.X8R8G8B8, "16": TexelWord.R5G6B5, "15": TexelWord.X1R5G5B5}
LINES = (  # how the colour's word is read, the word, both ends
    ("24", 0xFFFFFFFF, (100, 100), (100, 400)),
    ("24", 0xFFFFFF, (222, 222), (222, 222)),
    ("24", 0x000000, (400, 200), (400, 400)),
    ("24", 0xFF0000, (400, 200), (400, 400)),
    ("24", 0x00FF00, (400, 200), (400, 400)),
    ("16", 0x0007E0, (400, 200), (400, 400)),
    ("15", 0x0003E0, (400, 200), (400, 400)),
    ("24", 0x00FF00, (444, 222), (444, 444)),
    ("24", 0xFFFFFF, (0, 0), (639, 479)),
    ("24", 0xFFFFFF, (639, 479), (0, 0)),
    ("24", 0xFFFFFF, (400, 0), (400, 479)),
    ("24", 0xFFFFFF, (400, 300), (401, 300)),
    ("24", 0xFFFFFF, (400, 300), (400, 301)),
)


def _name(word, color, start, end):
    return f"2DLine-{word}-C{color:08X}-{start[0]}_{start[1]}-{end[0]}_{end[1]}"


def _case(word, color, *ends):
    rgba = texels_of_words(color, WORDS[word]) / 255.0
    mesh = scenes.window_mesh(
        [(x + 0.5, y + 0.5) for x, y in ends], PrimitiveType.LINES, colors=scenes.single([rgba] * 2)
    )
    draw = Draw(label="line", mesh=mesh, state=replace(scenes.DEFAULT, blending=None, line=LineState()))
    return Case(commands=(scenes.clear(0xFF440011), draw))


CASES = {_name(*line): partial(_case, *line) for line in LINES}
