"""Iterated texture coordinates by vectors equal docs/numbers.md, section 6, in plain float64 and integers."""

from math import floor, frexp, trunc

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fixedpipe.raster import rows as R
from fixedpipe.raster.floats import SMALLEST, keep_significant_bits
from fixedpipe.raster.vector.coordinates import iterate_texels
from fixedpipe.raster.vector.interpolate import iterate_floats

UNIT, COMPONENT = 1, 0


def specified(q0, q2, v0, v1, v2):
    """[N6.2]: the terms' sum, and how many of its units make one."""
    terms = (v1, q0 * (v0 - v1), q2 * (v2 - v1))
    unit = 2.0 ** (frexp(max(SMALLEST, *map(abs, terms)))[1] - 24)
    return sum(trunc(term / unit) for term in terms) * unit


def weights(seed, count, spread):
    """Columns Q0 and Q2 like a run's: 24 bits of weights that move, or anything if ``spread`` is None."""
    random = np.random.default_rng(seed)
    if spread is None:
        q0 = random.random(count) * 2.0 ** -random.integers(0, 30, count)
        return keep_significant_bits(q0, 24), keep_significant_bits((1 - q0) * random.random(count), 24)
    along, start = np.arange(count) * spread, random.random()
    q0 = np.clip(start - along, 0.0, 1.0)
    return keep_significant_bits(q0, 24), keep_significant_bits((1.0 - q0) * random.random(), 24)


def columns(q0, q2, vertices):
    """The arguments of a run's iteration: one triangle, one segment."""
    count = len(q0)
    floats = np.zeros((R.VECTOR_FLOAT_COLUMNS, count + R.SLACK))
    floats[R.Q0, :count], floats[R.Q2, :count] = q0, q2
    floats[R.Q0, count:] = np.random.default_rng(count).random(R.SLACK) * 1e6  # the next segment's: any
    lists = np.zeros((R.LISTS, count + R.SLACK), np.int32)
    lists[R.STARTS, 1] = count
    triangles = np.array([[2, 0, 1, 0]], np.int32)
    coordinates = np.zeros((3, 2, 4))
    coordinates[triangles[0, :3], UNIT, COMPONENT] = vertices
    return lists, triangles, coordinates, floats


coordinate = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 0.5, 2.0, 511.75, -512.0, 2.0**-29, 2.0**-31, 2.0**-90]),
    st.floats(-512.0, 512.0, width=32),
    st.floats(-4.0, 4.0),
)
runs = st.tuples(
    st.integers(0, 2**32), st.integers(1, 70), st.sampled_from([None, 0.0, 2.0**-10, 0.013, 0.11])
)


@settings(deadline=None, max_examples=300)
@given(runs, st.tuples(coordinate, coordinate, coordinate), st.integers(0, 11), st.booleans())
@example((0, 64, 0.013), (1.0, 0.0, 0.0), 9, True)  # one term, which passes powers of two
@example((0, 64, 0.013), (0.0, 0.0, 1.0), 9, True)
@example((3, 64, 0.013), (1.0, 1.5, 1.75), 9, False)  # vertex 1's is always the largest
@example((0, 64, 0.0), (2.0**-30, 2.0**-31, 0.0), 11, False)  # shifted beyond an int32
def test_texels_are_the_specified_sums_and_their_floor(run, vertices, log2_size, repeat):
    seed, count, spread = run
    q0, q2 = weights(seed, count, spread)
    lists, triangles, coordinates, floats = columns(q0, q2, vertices)
    out = np.full(count + R.SLACK, 77, np.int32)
    iterate_texels(lists, 1, triangles, coordinates, UNIT, COMPONENT, log2_size, repeat, floats, out)
    size = 2**log2_size
    period = 256 * size if repeat else 2**40
    for k in range(count):
        u = specified(q0[k], q2[k], *vertices)
        if abs(u) >= 2.0**-30 or u == 0.0:  # smaller ones wrap with rounding
            assert (int(out[k]) - floor(256 * size * u)) % period == 0, k


@settings(deadline=None, max_examples=200)
@given(runs, st.tuples(coordinate, coordinate, coordinate))
def test_coordinates_are_the_specified_sums(run, vertices):
    seed, count, spread = run
    q0, q2 = weights(seed, count, spread)
    lists, triangles, coordinates, floats = columns(q0, q2, vertices)
    out = np.zeros(count + R.SLACK)
    iterate_floats(lists, 1, triangles, coordinates, UNIT, COMPONENT, floats, out)
    assert out[:count].tolist() == [specified(a, b, *vertices) for a, b in zip(q0, q2, strict=True)]
