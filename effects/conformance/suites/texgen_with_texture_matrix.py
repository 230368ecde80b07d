"""Texgen_with_texture_matrix: generated texture coordinates through the texture matrix.

They read a texture, or become colours.

Source: src/tests/texgen_matrix_tests.cpp of nxdk_pgraph_tests.
"""

from functools import partial
from itertools import product

from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import texgen, texture_matrix

SUITE = "Texgen_with_texture_matrix"
OPEN = "single ties of texels"


def _case(mode, matrix, passed_through=False):
    commands = texture_matrix.commands(texgen.MODES[mode], matrix, passed_through)
    return Case(commands=commands, explanation="" if passed_through else texture_matrix.explanation(matrix))


_LATER = [mode for mode in texgen.MODES if mode != "NormalMap"]  # of the cases that came later
CASES = {
    **{
        f"{m}_{matrix}": partial(_case, m, matrix)
        for m, matrix in product(texgen.MODES, texture_matrix.MATRICES)
    },
    **{
        f"{m}_{matrix}": partial(_case, m, matrix)
        for m, matrix in product(_LATER, texture_matrix.LATER_MATRICES)
    },
    **{
        f"PassThrough_{mode}_{matrix}": partial(_case, mode, matrix, True)
        for mode, matrix in product(_LATER, texture_matrix.MATRICES | texture_matrix.LATER_MATRICES)
    },
}
