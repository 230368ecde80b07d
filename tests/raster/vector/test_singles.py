"""Float32 that the processor cuts gives the bits of float64 with masks, wherever its guards let it."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fixedpipe.raster import rows as R
from fixedpipe.raster.fixed import reciprocal_24
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.portable.interpolate import weight_factors
from fixedpipe.raster.vector.interpolate import run_weights, triangle_weights
from fixedpipe.raster.vector.lanes import f32x16, fused, load_f32x16, store
from fixedpipe.raster.vector.rounding import toward_zero
from fixedpipe.raster.vector.singles import (
    BLOCK,
    near_reciprocals,
    reciprocals,
    rest_of,
    single_column_weights,
    single_coordinate,
    single_factors,
    single_weights,
)
from tests.raster.vector.test_rounding import needs_cutting

pytestmark = needs_cutting


@kernel("void(f4[::1],f4[::1])")
def reciprocals_leaf(totals, out):
    separate_loop()
    for i in range(0, totals.shape[0], 16):
        store(out, i, reciprocals(load_f32x16(totals, i)))


@kernel("void(f4[::1],f4[::1])")
def cut_reciprocals(totals, out):
    separate_function()
    toward_zero(reciprocals_leaf, (totals, out))


@kernel("void(f4[::1],f4[::1])")
def shorter_leaf(totals, out):
    """The rest is rounded by one fused operation: the formula that is nearly right."""
    separate_loop()
    for i in range(0, totals.shape[0], 16):
        x, rest = near_reciprocals(load_f32x16(totals, i))
        nearest = (
            fused(rest, f32x16(np.float32(1.0 - 2.0**-24)), f32x16(np.float32(2.0**-25))) + 0.75
        ) - 0.75
        store(out, i, fused(x, nearest, x))


@kernel("void(f4[::1],f4[::1])")
def shorter_reciprocals(totals, out):
    separate_function()
    toward_zero(shorter_leaf, (totals, out))


@kernel("void(f4[::1],f4[::1])")
def expected_reciprocals(totals, out):
    for i in range(totals.shape[0]):
        out[i] = reciprocal_24(np.float64(totals[i]))


MANTISSAS = np.arange(2**23, 2**24).astype(np.float32)
NEARLY = [32623078, 33351050, 33481114]  # where the shorter formula errs


def unequal(made, totals):
    found, expected = np.empty_like(totals), np.empty_like(totals)
    made(totals, found)
    expected_reciprocals(totals, expected)
    return totals[found != expected].tolist()


@pytest.mark.parametrize("scale", [2.0, 4.0, 8.0])
def test_all_reciprocals(scale):
    """Every sum that N4.10 can make: 24 bits, three exponents."""
    assert unequal(cut_reciprocals, MANTISSAS * np.float32(scale)) == []


def test_a_shorter_reciprocal_is_wrong_for_three():
    totals = MANTISSAS * np.float32(2.0)
    assert unequal(shorter_reciprocals, totals) == NEARLY
    alone = np.array((NEARLY * 6)[:16], np.float32)
    assert unequal(cut_reciprocals, alone) == []


@st.composite
def runs(draw):
    """Edge functions of a pixel and their steps, how many pixels are inside, and the vertices' w."""
    area = draw(
        st.one_of(st.integers(1, 2**31 - 1), st.integers(1, 2**50), st.integers(0, 50).map(lambda k: 2**k))
    )
    n0 = draw(st.integers(0, area))
    n1 = draw(st.integers(0, area - n0))
    shift = draw(st.integers(0, 8)) if area < 2**23 else 0
    largest = draw(st.sampled_from([1, 16, 2**10, 2**16, 2**20]))
    right0, right2 = draw(st.integers(-largest, largest)), draw(st.integers(-largest, largest))
    n, right = (n0, n1, area - n0 - n1), (right0, -right0 - right2, right2)
    most = draw(st.integers(1, 2 * BLOCK + 40))
    count = min([most, *(value // -step + 1 for value, step in zip(n, right, strict=True) if step < 0)])
    exponent = st.sampled_from([0.0, 0.1, 1.0, 8.0])
    w = tuple(float(np.float32(2.0 ** (draw(exponent) * draw(st.floats(-1, 1))))) for _ in range(3))
    return tuple(float(x << shift) for x in n), tuple(float(x << shift) for x in right), count, w


POSITION = 3  # no multiple of sixteen


@settings(deadline=None, max_examples=600)
@given(runs())
@example(((2.0**31 - 2.0, 0.0, 1.0), (-1.0, 1.0, 0.0), 90, (1.0, 1.0, 1.0)))
@example(((2.0**30, 2.0**29, 2.0**29 - 1.0), (0.0, 0.0, 0.0), 17, (1.0, 1.0, 1.0)))
@example(((2.0**30, 2.0**29, 2.0**29), (0.0, 0.0, 0.0), 17, (1.0, 1.0, 1.0)))
@example(((2.0**50, 1.0, 2.0**52), (-(2.0**20), 0.0, 2.0**20), 70, (1.0, 2.0, 3.0)))
@example(((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), 1, (2.0**-14, 1.0, 2.0**14)))
def test_weights_are_those_of_float64(run):
    n, right, count, w = run
    factors = weight_factors(*(1.0 / x for x in w))
    usable, scaled = single_factors(factors)
    assert usable
    columns = POSITION + count + R.SLACK
    floats = np.zeros((R.VECTOR_FLOAT_COLUMNS, columns))
    singles = np.zeros((R.SINGLE_COLUMNS, max(columns, BLOCK + R.SLACK)), np.float32)
    run_weights(floats, POSITION, count, n, right, factors)
    single_weights(singles, POSITION, count, n, right, scaled)
    here = slice(POSITION, POSITION + count)
    assert singles[R.SINGLE_Q0, here].tolist() == floats[R.Q0, here].tolist()
    assert singles[R.SINGLE_Q2, here].tolist() == floats[R.Q2, here].tolist()


@settings(deadline=None, max_examples=300)
@given(runs().filter(lambda run: sum(run[0]) < 2.0**24))
def test_weights_of_a_small_triangle_are_those_of_float64(run):
    n, right, count, w = run
    factors, area = weight_factors(*(1.0 / x for x in w)), sum(n)
    columns = POSITION + count + R.SLACK
    floats = np.zeros((R.VECTOR_FLOAT_COLUMNS, columns))
    singles = np.zeros((R.SINGLE_COLUMNS, max(columns, BLOCK + R.SLACK)), np.float32)
    for row, first, step in zip((R.N0, R.N1, R.N2), n, right, strict=True):
        floats[row] = first + step * (np.arange(columns) - POSITION)
    triangle_weights(floats, POSITION, count, factors, area)
    assert single_column_weights(singles, floats, POSITION, count, factors, area)
    here = slice(POSITION, POSITION + count)
    assert singles[R.SINGLE_Q0, here].tolist() == floats[R.Q0, here].tolist()
    assert singles[R.SINGLE_Q2, here].tolist() == floats[R.Q2, here].tolist()


def test_what_is_beyond_float32_stays_with_float64():
    assert single_factors((2.0**-30, 1.0, 2.0**29)) == (True, (2.0**-59, 2.0**-29, 1.0))
    assert not single_factors((2.0**-30, 1.0, 2.0**30))[0]
    assert not single_factors((np.nan, 1.0, 1.0))[0]
    columns = np.zeros((R.VECTOR_FLOAT_COLUMNS, 64))
    singles = np.zeros((R.SINGLE_COLUMNS, BLOCK + R.SLACK), np.float32)
    assert not single_column_weights(singles, columns, 0, 16, (2.0**-30, 1.0, 2.0**30), 4.0)
    assert single_factors((2.0**-250, 2.0**-251, 1.5 * 2.0**-250)) == (True, (1.0, 0.5, 1.5))


def test_coordinates_that_wrap_with_rounding_are_refused():
    singles = np.zeros((R.SINGLE_COLUMNS, 64), np.float32)
    singles[R.SINGLE_Q0, :16], singles[R.SINGLE_Q2, :16] = 0.5, 0.0
    singles[R.SINGLE_Q0, 5] = 0.0
    for terms, may in [
        ((0.0, 1.0, 1.0), True),
        ((0.0, 0.0, 0.0), True),
        ((0.0, 2.0**-29, 1.0), True),
        ((0.0, 2.0**-30, 1.0), False),
        ((2.0**-31, 1.0, 1.0), False),
        ((0.0, 2.0**-31, 1.0), False),
        ((2.0**-31, 0.0, 1.0), False),
        ((2.0**-20, 2.0**-99, 1.0), True),
        ((1.0, 2.0**-127, 1.0), False),
        ((2.0**-30, 0.0, 1.0), True),
        ((1.0, 2.0**96, 1.0), True),
        ((1.0, 2.0**97, 1.0), False),
        ((1.0, 1.0, -(2.0**99)), False),
        ((np.nan, 0.0, 1.0), False),
    ]:
        assert single_coordinate(singles, 0, 0, 16, terms, 8) is may, terms


@kernel("void(f4[::1],f4[::1],f4[::1])")
def rests_leaf(a, b, out):
    separate_loop()
    for i in range(0, a.shape[0], 16):
        store(out, i, rest_of(load_f32x16(a, i), load_f32x16(b, i)))


@kernel("void(f4[::1],f4[::1],f4[::1])")
def cut_rests(a, b, out):
    separate_function()
    toward_zero(rests_leaf, (a, b, out))


def test_all_rests_beside_a_weight():
    """N4.8 with every second weight of 24 bits below one half, and first ones up to one."""
    b = (np.arange(2**23, 2**24) * 2.0**-25).astype(np.float32)
    for first in (0.0, 2.0**-26, 0.25, 0.75, 1.0 - 2.0**-24):
        a, out = np.full_like(b, first), np.empty_like(b)
        cut_rests(a, b, out)
        whole = 2**25 - np.trunc(np.float64(a) * 2**25) - np.trunc(np.float64(b) * 2**25)
        drop = np.where(np.abs(whole) >= 2**24, 2, 1)
        assert (out == np.trunc(whole / drop) * drop * 2.0**-25).all()
