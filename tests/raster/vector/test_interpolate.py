"""Iterated texture coordinates by vectors equal docs/numbers.md, section 6, in plain float64 and integers."""

from math import ceil, floor
from types import SimpleNamespace

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.fixed import reciprocal_29, seed_29
from fixedpipe.raster.floats import keep_significant_bits
from fixedpipe.raster.kernel import kernel
from fixedpipe.raster.portable.interpolate import depth_words, emit_depth
from fixedpipe.raster.vector.coordinates import (
    Axis,
    iterate_floats,
    iterate_texels,
)
from fixedpipe.raster.vector.interpolate import Depths, Listed, reciprocals_29, run_depth, shared_seed
from fixedpipe.raster.vector.lanes import load_f64x16, store
from tests.reference import interpolate

UNIT, COMPONENT = 1, 0


def specified(q0, q2, v0, v1, v2):
    """N6.2, of one fragment."""
    return interpolate.iterate_coordinate((v0, v1, v2), SimpleNamespace(q0=q0, q2=q2))


def weights(seed, count, spread):
    """Columns Q0 and Q2 like a run's: 24 bits of weights that move, or anything if ``spread`` is None."""
    random = np.random.default_rng(seed)
    if spread is None:
        q0 = random.random(count) * 2.0 ** -random.integers(0, 30, count)
        return keep_significant_bits(q0, 24), keep_significant_bits((1 - q0) * random.random(count), 24)
    along, start = np.arange(count) * spread, random.random()
    q0 = np.clip(start - along, 0.0, 1.0)
    return keep_significant_bits(q0, 24), keep_significant_bits((1.0 - q0) * random.random(), 24)


def columns(q0, q2, vertices, single):
    """The arguments of a run's iteration: one triangle, one segment, whose weights are singles or not."""
    count = len(q0)
    floats = np.zeros((R.VECTOR_FLOAT_COLUMNS, count + R.SLACK))
    singles = np.zeros((R.SINGLE_COLUMNS, count + R.SLACK), np.float32)
    weights = (singles[R.SINGLE_Q0], singles[R.SINGLE_Q2]) if single else (floats[R.Q0], floats[R.Q2])
    weights[0][:count], weights[1][:count] = q0, q2
    weights[0][count:] = np.random.default_rng(count).random(R.SLACK) * 1e6  # the next segment's: any
    lists = np.zeros((R.LISTS, count + R.SLACK), np.int32)
    lists[R.STARTS, 1], lists[R.SINGLE, 0] = count, single
    triangles = np.array([[2, 0, 1, 0]], np.int32)
    coordinates = np.zeros((3, 2, 4))
    coordinates[triangles[0, :3], UNIT, COMPONENT] = vertices
    return (Listed(lists, 1), triangles, coordinates), (floats, singles)


coordinate = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 0.5, 2.0, 511.75, -512.0, 2.0**-29, 2.0**-31, 2.0**-90]),
    st.floats(-512.0, 512.0, width=32),
    st.floats(-4.0, 4.0),
)
runs = st.tuples(
    st.integers(0, 2**32), st.integers(1, 70), st.sampled_from([None, 0.0, 2.0**-10, 0.013, 0.11])
)


@settings(deadline=None, max_examples=300)
@given(runs, st.tuples(coordinate, coordinate, coordinate), st.integers(0, 11), st.booleans(), st.booleans())
@example((0, 64, 0.013), (1.0, 0.0, 0.0), 9, True, False)  # one term, which passes powers of two
@example((0, 64, 0.013), (1.0, 0.0, 0.0), 9, True, True)
@example((0, 64, 0.013), (0.0, 0.0, 1.0), 9, True, False)
@example((0, 64, 0.013), (0.0, 0.0, 1.0), 9, True, True)
@example((3, 64, 0.013), (1.0, 1.5, 1.75), 9, False, False)  # vertex 1's is always the largest
@example((3, 64, 0.013), (1.0, 1.5, 1.75), 9, False, True)
@example((0, 64, 0.0), (2.0**-30, 2.0**-31, 0.0), 11, False, False)  # shifted beyond an int32
def test_texels_are_the_specified_sums_and_their_floor(run, vertices, log2_size, repeat, single):
    seed, count, spread = run
    q0, q2 = weights(seed, count, spread)
    given_arrays, weights_of = columns(q0, q2, vertices, single)
    out = np.full(count + R.SLACK, 77, np.int32)
    axis = Axis(UNIT, COMPONENT, log2_size, int(repeat))
    iterate_texels(*given_arrays, axis, *weights_of, out)
    size = 2**log2_size
    period = 256 * size if repeat else 2**40
    for k in range(count):
        u = specified(q0[k], q2[k], *vertices)
        if abs(u) >= 2.0**-30 or u == 0.0:  # smaller ones wrap with rounding
            assert (int(out[k]) - floor(256 * size * u)) % period == 0, k


@settings(deadline=None, max_examples=200)
@given(runs, st.tuples(coordinate, coordinate, coordinate), st.booleans())
def test_coordinates_are_the_specified_sums(run, vertices, single):
    seed, count, spread = run
    q0, q2 = weights(seed, count, spread)
    given_arrays, weights_of = columns(q0, q2, vertices, single)
    out = np.zeros(count + R.SLACK)
    iterate_floats(*given_arrays, UNIT, COMPONENT, *weights_of, out)
    assert out[:count].tolist() == [specified(a, b, *vertices) for a, b in zip(q0, q2, strict=True)]


depth = st.one_of(
    st.sampled_from([0.0, 1.0, 0.5, 2.0**24 - 1, 12345678.0]), st.floats(0.0, 2.0**24 - 1, width=32)
)
# Edge functions of a pixel, and how they change to the right; from 24 bits on they are cut.
edge = st.integers(1, 2**38)
step = st.integers(-(2**20), 2**20)


@settings(deadline=None, max_examples=400)
@given(st.tuples(edge, edge, edge), st.tuples(step, step), st.tuples(depth, depth, depth))
@example((2**30 - 3, 1, 2), (16, -16), (1.0, 0.5, 12345678.0))  # the area is a power of two
@example((2**29 + 63, 2**29 - 2**20, 2**20), (0, 0), (0.0, 2.0**23, 0.0))  # the sum of cut ones is one
@example((2**37 + 12345, 2**36 + 999, 2**37 + 1), (2**15 + 1, 7), (1.0, 0.5, 12345678.0))
def test_depths_of_a_run_are_those_of_the_portable_engine(first, right, depths):
    right = (*right, -sum(right))
    count = 48
    while count > 1 and any(n + (count - 1) * d < 0 for n, d in zip(first, right, strict=True)):
        count //= 2  # inside the triangle
    n, right = tuple(map(float, first)), tuple(map(float, right))
    words = np.zeros(count + R.SLACK, np.int32)
    run_depth(words, 0, count, n, right, Depths(depths, 0.0, 0.0, 2.0**24 - 1))
    floats, expected = np.zeros((R.DEPTH + 1, count + R.SLACK)), np.zeros(count + R.SLACK, np.int32)
    emit_depth(floats, 0, count, n, right, depths, 0.0)
    draw, draw_float = np.zeros(R.DRAW_SIZE, np.int64), np.zeros(R.DRAW_FLOAT_SIZE)
    draw[R.DEPTH_FORMAT], draw[R.DEPTH_MAX] = C.DEPTH_FIXED, 2**24 - 1
    draw_float[R.DEPTH_HIGH] = 2.0**24 - 1
    depth_words(floats, count, draw, draw_float, expected)
    assert words[:count].tolist() == expected[:count].tolist()


@kernel("void(f8[::1],f8[::1])")
def reciprocals(totals, out):
    for at in range(0, totals.shape[0], 16):
        store(out, at, reciprocals_29(load_f64x16(totals, at)))


@kernel("boolean(f8,f8[::1])")
def seeds(area, found):
    found[0], shared = shared_seed(area)
    return shared


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**32), st.integers(1, 45))
def test_reciprocals_of_lanes_are_those_of_scalars(seed, bits):
    totals = np.floor(np.random.default_rng(seed).uniform(2.0 ** (bits - 1), 2.0**bits, 64))
    out = np.zeros(64)
    reciprocals(totals, out)
    assert out.tolist() == [reciprocal_29(total) for total in totals]


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**32), st.integers(24, 45), st.booleans())
def test_a_shared_seed_is_that_of_every_sum_of_cut_edge_functions(seed, bits, near):
    random = np.random.default_rng(seed)
    area = float(random.integers(2 ** (bits - 1), 2**bits))
    if near:  # the area lies just above where the seed changes, and some of its sums below
        area = ceil(1.0 / (seed_29(area) + 2.0 ** (-14 - bits))) + 1.0
    found = np.zeros(1)
    shared = seeds(area, found)
    others = {seed_29(area - floor(area * 2.0**-23 * share)) for share in random.random(64)}
    assert found[0] == seed_29(area)
    assert not shared or others == {found[0]}
