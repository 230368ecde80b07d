"""Texture_Matrix: given texture coordinates through the texture matrix.

Source: src/tests/texture_matrix_tests.cpp of nxdk_pgraph_tests.
"""

from functools import partial

import numpy as np

from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.scenes import rows_of, single
from fixedpipe.effects.conformance.suites import texgen
from fixedpipe.pipeline.enums import TexGenMode
from fixedpipe.pipeline.state import IDENTITY

SUITE = "Texture_Matrix"


def _scaled(factor):
    return np.diag([factor, factor, factor, 1.0])


def _moved(s, t):
    """The programs' translation: in the last row, where column vectors have q."""
    matrix = np.eye(4)
    matrix[3, :2] = s, t
    return matrix


def _turned(axis):
    """A quarter turn; single precision's pi leaves a cosine of -4e-8."""
    matrix, angle = np.eye(4), np.float32(np.pi * 0.5)
    i, j = sorted({0, 1, 2} - {axis})
    cosine, sine = np.cos(angle.astype(np.float64)), np.sin(angle.astype(np.float64))
    sine = -sine if axis == 1 else sine
    matrix[i, i] = matrix[j, j] = cosine
    matrix[i, j], matrix[j, i] = sine, -sine
    return matrix


MATRICES = {  # as the program writes them, row by row
    "Identity": np.array(IDENTITY),
    "Double": _scaled(2.0),
    "Half": _scaled(0.5),
    "ShiftHPlus": _moved(0.5, 0.0),
    "ShiftHMinus": _moved(-0.5, 0.0),
    "ShiftVPlus": _moved(0.0, 0.5),
    "ShiftVMinus": _moved(0.0, -0.5),
    "RotateX": _turned(0),
    "RotateY": _turned(1),
    "RotateZ": _turned(2),
    "Arbitrary": np.array([(0.7089392, 0, 0.515, 0), (0, 1.2603364, 0.49, 0), (0, 0, 0, 0), (0, 0, 1, 0)]),
}
# Of the suite with generated coordinates alone; MatrixOff has a matrix that is not enabled.
LATER_MATRICES = {"MatrixOff": np.array(IDENTITY), "Negate": np.diag([-1.0, -1.0, 1.0, 1.0])}

ON_TEXEL_EDGES = (
    "pixels within 2e-4 texel of an edge: in how many bits the chip divides by a varying q is not known"
)


def explanation(name):
    """Why pixels may differ: with matrices that make q vary over the rectangle, some fall on texel edges."""
    return ON_TEXEL_EDGES if name.startswith("Shift") else ""


def commands(mode, name, passed_through=False):
    """The frame of a texgen mode and a matrix's name; ``passed_through`` as in Texgen's.

    Measured: a row of the matrix, as the program writes it, times (s, t, r, q) is a coordinate (11 captures).
    """
    matrix = (MATRICES | LATER_MATRICES)[name]
    return texgen.commands(1.0, mode, rows_of(single(matrix)), passed_through)


def _case(name):
    return Case(commands=commands(TexGenMode.NONE, name), explanation=explanation(name))


CASES = {name: partial(_case, name) for name in MATRICES}
