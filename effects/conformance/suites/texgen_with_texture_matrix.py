"""Texgen_with_texture_matrix: generated texture coordinates through the texture matrix.

Source: src/tests/texgen_matrix_tests.cpp of nxdk_pgraph_tests.
"""

from effects.conformance.case import Case
from effects.conformance.suites import texgen, texture_matrix

SUITE = "Texgen_with_texture_matrix"


def names():
    """Every case of the suite."""
    return [f"{mode}_{matrix}" for mode in texgen.MODES for matrix in texture_matrix.MATRICES]


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in names():
        return None
    mode, matrix = name.split("_")
    commands = texture_matrix.commands(texgen.MODES[mode], matrix)
    return Case(commands=commands, explanation=texture_matrix.explanation(matrix))
