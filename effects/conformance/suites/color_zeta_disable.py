"""Color_Zeta_Disable: a quad that may write neither color nor depth.

Source: src/tests/color_zeta_disable_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.state import ColorMask

SUITE = "Color_Zeta_Disable"

CHECKERS = 0xFF202020, 0xFF000000, 24  # two colors and a square's edge, texels


def _case():
    corners = scenes.rectangle(WIDTH / 4, HEIGHT / 4, WIDTH * 3 / 4, HEIGHT * 3 / 4, 10)
    state = replace(scenes.DEFAULT, color_mask=ColorMask(False, False, False, False))
    quad = scenes.window_mesh(corners, colors=scenes.single([(0.5, 0.5, 1.0, 0.85)] * 4))
    background = scenes.background(*CHECKERS, corners=scenes.rectangle(0, 0, WIDTH, HEIGHT, 0.1))
    return Case(commands=(scenes.clear(0xFE312F31), *background, Draw(label="quad", mesh=quad, state=state)))


CASES = {"MaskOff_ZB": _case}
