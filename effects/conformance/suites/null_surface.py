"""Null_surface: a quad, after draws whose surfaces lie elsewhere in memory.

Source: src/tests/null_surface_tests.cpp of nxdk_pgraph_tests. First the program draws the same quad to the
window's memory as 512 by 512 pixels, and to a texture's memory. Then it clears and draws the picture, so
neither leaves a trace.
"""

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case

SUITE = "Null_surface"

NEAR, FAR = 0.15, 0.85  # the quad's edges, of the window's


def _case():
    corners = scenes.rectangle(NEAR * WIDTH, NEAR * HEIGHT, FAR * WIDTH, FAR * HEIGHT, 0.1)
    quad = scenes.quad("quad", corners, (0.1, 0.6, 0.1, 1.0))
    return Case(commands=(scenes.clear(0xFE134415), quad))


CASES = {"XemuBug893": _case}
