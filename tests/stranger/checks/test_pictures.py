"""The stranger's tests."""

import pytest

from pipeline import gradient


def test_gradient(golden):
    golden(gradient(20, 10))


@pytest.mark.parametrize("size", [4, 8])
def test_sizes(golden, size):
    golden(gradient(size, size), name="square")
    golden(gradient(2 * size, size), name="wide")


def test_relations(golden):
    first, second = gradient(8, 8), gradient(8, 8)
    second[0, 0, 0] ^= 1
    golden.at_most(first, second, max_diff=1, pixels=(1, 4))
    golden.differs(first, second)
    golden.equal(first, gradient(8, 8))
