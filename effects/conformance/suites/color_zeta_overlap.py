"""Color_zeta_overlap: a square drawn while colours and depths go to the same memory.

Source: src/tests/color_zeta_overlap_tests.cpp of nxdk_pgraph_tests. Here is the buffer of each case that the
square does not reach: the window after its last clear, the depth buffer beside the window. What colours and
depths make of one memory, the program calls mixed at random; the captures show blocks of either.
"""

from functools import partial

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case, Shows

SUITE = "Color_zeta_overlap"


def _case(shows):
    return Case(commands=(scenes.clear(0xFE242424, depth=0.0),), shows=shows)


CASES = {"ColorIntoZeta": partial(_case, Shows.COLOR), "ZetaIntoColor_ZB": partial(_case, Shows.ZETA)}
