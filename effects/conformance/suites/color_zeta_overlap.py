"""Color_zeta_overlap: a square drawn while colours and depths go to the same memory.

Source: src/tests/color_zeta_overlap_tests.cpp of nxdk_pgraph_tests. Each case here shows the buffer outside
the square: the window after its last clear, and the depth buffer beyond the window. The program calls the
contents of the shared memory mixed at random. The captures show blocks of colours and of depths there.
"""

from functools import partial

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case, Shows

SUITE = "Color_zeta_overlap"


def _case(shows):
    return Case(commands=(scenes.clear(0xFE242424, depth=0.0),), shows=shows)


CASES = {"ColorIntoZeta": partial(_case, Shows.COLOR), "ZetaIntoColor_ZB": partial(_case, Shows.ZETA)}
