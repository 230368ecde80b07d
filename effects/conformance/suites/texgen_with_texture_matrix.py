"""Texgen_with_texture_matrix: generated texture coordinates through the texture matrix, which a texture is
read with, or which are passed through as colours.

Source: src/tests/texgen_matrix_tests.cpp of nxdk_pgraph_tests.
"""

from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import texgen, texture_matrix

SUITE = "Texgen_with_texture_matrix"
OPEN = "single ties of texels"


PASS_THROUGH = "PassThrough_"


def names():
    """Every case of the suite; those that came later are without the normal map."""
    first = [f"{mode}_{matrix}" for mode in texgen.MODES for matrix in texture_matrix.MATRICES]
    modes = [mode for mode in texgen.MODES if mode != "NormalMap"]
    later = [f"{mode}_{matrix}" for mode in modes for matrix in texture_matrix.LATER_MATRICES]
    matrices = texture_matrix.MATRICES | texture_matrix.LATER_MATRICES
    return [*first, *later, *(f"{PASS_THROUGH}{mode}_{matrix}" for mode in modes for matrix in matrices)]


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in names():
        return None
    mode, matrix = name.removeprefix(PASS_THROUGH).split("_")
    passed_through = name.startswith(PASS_THROUGH)
    commands = texture_matrix.commands(texgen.MODES[mode], matrix, passed_through)
    return Case(commands=commands, explanation="" if passed_through else texture_matrix.explanation(matrix))
