"""Depth words in float32 and int32 that the processor cuts are those of float64, wherever they are made."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from fixedpipe.raster import rows as R
from fixedpipe.raster.fixed import reciprocal_29
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.vector.interpolate import Depths, run_depth, triangle_depth
from fixedpipe.raster.vector.lanes import load_i32x16, store
from fixedpipe.raster.vector.rounding import toward_zero
from fixedpipe.raster.vector.single_depths import (
    EXACT,
    HIGH,
    keep_depths,
    lower_bits,
    single_run_depth,
    single_triangle_depth,
)
from tests.raster.vector.test_rounding import needs_cutting
from tests.raster.vector.test_singles import POSITION, runs

pytestmark = needs_cutting

MOST = 2.0**24 - 1


def single(value):
    return float(np.float32(value))


@st.composite
def depths(draw):
    """Three vertices' depths of a 24- or 16-bit buffer: near each other, far apart, on powers of two, at the
    near plane or a little beside it; and an offset.
    """
    one = draw(st.sampled_from([MOST, 65535.0]))
    part = st.one_of(
        st.floats(0, 1),
        st.floats(0.9, 1),
        st.integers(0, 30).map(lambda k: 2.0**-k),
        st.sampled_from([0.0, 1.0, 1e-16, -1e-16, 3e-14, -3e-14, 1e-7, 2.0**-53, 2.0**-50]),
        st.integers(-3, 3).map(lambda k: 0.7 + k * 2.0**-23),
    )
    sign = draw(st.sampled_from([1, 1, 1, 1, -1]))
    z = tuple(single(sign * draw(part) * one) for _ in range(3))
    return Depths(z, float(draw(st.sampled_from([0, 0, 3, -7, 10000]))), 0.0, one)


def bits_below(numbers):
    """The lowest bit of any of some integers."""
    bits = 0
    for number in numbers:
        bits |= int(number)
    return bits & -bits


def kept(area, exact, of):
    """The int columns where an area's numbers are kept, or None."""
    ints = np.zeros((R.VECTOR_INT_COLUMNS, 700), np.int32)
    return ints if keep_depths(ints, int(area), exact, of) else None


@settings(deadline=None, max_examples=1500)
@given(runs(), depths())
@example(((3.0, 5.0, 8.0), (0.0, 0.0, 0.0), 1, None), Depths((1.0, 2.0, 3.0), 0.0, 0.0, MOST))
@example(
    ((2.0**30 - 7.0, 2.0**20 + 1.0, 6.0), (-9.0, 4.0, 5.0), 90, None),
    Depths((0.0, single(0.9 * MOST), single(-1e-9)), 0.0, 0.0, MOST),
)
@example(  # a near plane's depth, which float64 rounds away beside the others
    ((2.0**30 + 5.0, 2.0**20 + 1.0, 6.0), (-900000.0, 4.0, 899996.0), 90, None),
    Depths((single(1.5e-8), single(0.9 * MOST), single(0.97 * MOST)), 0.0, 0.0, MOST),
)
@example(  # what clipping leaves at the near plane, its 24 bits all ones
    ((2.0**30 - 2.0**10, 600.0, 424.0), (-400000.0, 200001.0, 199999.0), 90, None),
    Depths((MOST * 2.0**-53, 2.0**20, 2.0**21 - 1.0), 0.0, 0.0, MOST),
)
@example(  # a sum that float64 rounds up to a whole number of units
    ((105280007.0, 31146643125.0, 2867499513.0), (0.0, -2.0, 2.0), 200, None),
    Depths((single(324.08273), MOST * 2.0**-52, single(23.797335)), 0.0, 0.0, MOST),
)
@example(  # below zero beside a whole sum
    ((2.0**20, 2.0**19, 2.0**19), (0.0, 0.0, 0.0), 1, None),
    Depths((single(-0.3), 2.0**20, 2.0**20), 0.0, 0.0, MOST),
)
@example(  # differences of more than twice P(z): the largest term is another vertex's
    ((27630.0, 2262797.0, 1557293.0), (796.0, -803.0, 7.0), 60, None),
    Depths((7085855.5, 1318118.5, 8768735.0), 0.0, 0.0, MOST),
)
def test_words_of_a_run_are_those_of_float64(run, of):
    n, right, count, _w = run
    area = sum(n)
    ints = kept(area, bool(area < 2.0**24 * bits_below((*n, *right))), of)
    assume(ints is not None)
    expected = np.zeros(ints.shape[1], np.int32)
    run_depth(expected, POSITION, count, n, right, of)
    single_run_depth(ints, POSITION, count, n, right)
    here = slice(POSITION, POSITION + count)
    assert ints[R.DEPTH_WORD, here].tolist() == expected[here].tolist()


@settings(deadline=None, max_examples=500)
@given(runs().filter(lambda run: sum(run[0]) < 2.0**24), depths())
def test_words_of_a_small_triangle_are_those_of_float64(run, of):
    n, right, count, _w = run
    ints = kept(sum(n), True, of)
    assume(ints is not None)
    columns = ints.shape[1]
    floats, expected = np.zeros((R.VECTOR_FLOAT_COLUMNS, columns)), np.zeros(columns, np.int32)
    for row, first, step in zip((R.N0, R.N1, R.N2), n, right, strict=True):
        floats[row] = first + step * (np.arange(columns) - POSITION)
    triangle_depth(floats, expected, POSITION, count, of, sum(n))
    single_triangle_depth(floats, ints, POSITION, count)
    here = slice(POSITION, POSITION + count)
    assert ints[R.DEPTH_WORD, here].tolist() == expected[here].tolist()


@kernel("void(i4[::1],i4[::1],f4[::1])")
def lower_leaf(numbers, totals, out):
    separate_loop()
    for i in range(0, totals.shape[0], 16):
        store(out, i, lower_bits(numbers, load_i32x16(totals, i)))


@kernel("void(i4[::1],i4[::1],f4[::1])")
def lower_parts(numbers, totals, out):
    separate_function()
    toward_zero(lower_leaf, (numbers, totals, out))


def sums_below(area):
    """All sums that an area's edge functions may have, in vectors of sixteen: they lose less than 2**-23."""
    lost = (area >> 23) + 1
    return area - np.resize(np.arange(lost), -(-lost // 16) * 16)


@pytest.mark.parametrize("bits", range(25, 32))
def test_all_reciprocals_of_an_area(bits):
    """Each sum below an area, for a thousand areas of so many bits: the first, the last, and others."""
    random = np.random.default_rng(bits)
    inside = random.integers(1 << (bits - 1), 1 << bits, 1000).tolist()
    plain, made = Depths((1.0, 2.0, 3.0), 0.0, 0.0, MOST), 0
    for area in [1 << (bits - 1), (1 << bits) - 1, *inside]:
        ints = kept(area, False, plain)
        if ints is None:  # another seed or exponent serves some of its sums
            continue
        numbers, totals = ints[R.DEPTH_NUMBERS], sums_below(area)
        found = np.empty(len(totals), np.float32)
        lower_parts(numbers, (totals >> max(bits - 29, 0)).astype(np.int32), found)
        unit = 2.0 ** (bits - 1 + 29)  # the reciprocal's last bit
        high = float(numbers[HIGH : HIGH + 1].view(np.float32)[0])
        expected = [reciprocal_29(float(total)) * unit for total in totals.tolist()]
        assert (high + found.astype(np.float64)).tolist() == expected, area
        assert found.min() >= 0 and not numbers[EXACT]
        made += 1
    assert made > 900


def test_some_triangles_are_left_to_float64():
    usual = Depths((100.0, 200.0, 300.0), 0.0, 0.0, MOST)
    assert kept(2**30, True, usual) is not None
    assert kept(2**40, True, usual) is None
    assert kept(2**30, True, usual._replace(vertices=(7.0, 7.0, 7.0))) is None
    assert kept(2**30, True, usual._replace(offset=0.5)) is None
    assert kept(2**30, True, usual._replace(offset=1e9)) is None
    assert kept(2**30, True, usual._replace(vertices=(2.0**-40, 1.0, 2.0))) is None
    # float64 loses a part of such a depth, and float32 does not
    assert kept(1024, True, usual._replace(vertices=(-(2.0**-34), 2.0**21, 2.0**21))) is None
    assert kept(2**30, True, usual._replace(vertices=(single(1.5e-8), 2.0**21, 2.0**21))) is not None
    assert kept(2**30, True, usual._replace(vertices=(MOST * 2.0**-53, 2.0**21, 2.0**21))) is not None
    assert kept(2**30, True, usual._replace(low=np.nan)) is None
    assert kept(2**30, True, usual._replace(high=np.nan)) is None
    assert kept(2**30, True, usual._replace(vertices=(2.0**26, 1.0, 2.0))) is None
    below = usual._replace(vertices=(-0.25, 1.0, 2.0))
    assert kept(2**30, True, below._replace(offset=3.0)) is None
    assert kept(2**30, True, below._replace(offset=-3.0)) is not None
    assert kept(2**30 + 1, False, usual) is None  # sums below 2**30 have another exponent
