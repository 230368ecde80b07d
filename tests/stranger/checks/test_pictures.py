"""The stranger's tests."""

import os

import pytest

from fixedpipe.pipeline import GEFORCE_256, Clear, Draw, Mesh, PassState, parse_program
from pipeline import gradient


def test_gradient(golden):
    golden(gradient(20, 10))


@pytest.mark.parametrize("size", [4, 8])
def test_sizes(golden, size):
    golden(gradient(size, size), name="square")
    golden(gradient(2 * size, size), name="wide")


def test_combiners(golden):
    program = "half" if os.environ.get("STRANGER_BUG") else "col0"
    squared = parse_program(
        "!!RC1.0 { const0 = (0.5, 0.5, 0.5, 0.5); rgb { spare0 = col0 * "
        + {"half": "const0", "col0": "col0"}[program]
        + "; } } out.rgb = spare0; out.a = unsigned_invert(zero);"
    ).combiners
    triangle = Mesh([[-1, -1], [3, -1], [-1, 3]], colors=[[0.3, 0.6, 0.9]] * 3)
    frame = (
        Clear(label="black", color=(0, 0, 0, 0)),
        Draw(label="the colour, squared", mesh=triangle, state=PassState(register_combiners=squared)),
    )
    golden.frame(frame, GEFORCE_256, 8, 8, engine="columns")


def test_relations(golden):
    first, second = gradient(8, 8), gradient(8, 8)
    second[0, 0, 0] ^= 1
    golden.at_most(first, second, max_diff=1, pixels=(1, 4))
    golden.differs(first, second)
    golden.equal(first, gradient(8, 8))
