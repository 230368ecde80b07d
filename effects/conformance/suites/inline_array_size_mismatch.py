"""Inline_array_size_mismatch: a triangle, followed by the first numbers of a second one, which draw nothing.

Source: src/tests/inline_array_size_mismatch.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType

SUITE = "Inline_array_size_mismatch"

MIDDLE, REACH, TOP, BOTTOM = WIDTH / 4, 0.2 * HEIGHT, HEIGHT / 4, HEIGHT * 3 / 4  # pixels
COLORS = ((1.0, 0.0, 0.0, 1.0), (1.0, 1.0, 0.0, 1.0), (1.0, 0.0, 1.0, 1.0))


def _case():
    corners = [(MIDDLE - REACH, BOTTOM), (MIDDLE, TOP), (MIDDLE + REACH, BOTTOM)]
    mesh = scenes.window_mesh(corners, PrimitiveType.TRIANGLES, colors=np.array(COLORS))
    state = replace(scenes.DEFAULT, register_combiners=scenes.SHOWS_PRIMARY_OPAQUE)
    return Case(commands=(scenes.clear(0xFE312F31), Draw(label="triangle", mesh=mesh, state=state)))


CASES = {"ExtraElements": _case}
