"""Kernels of a mesh's arrays, against the column arithmetic that lit and clipped vertices take."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from fixedpipe.pipeline.vertices.arithmetic import ONE, columns_of, positive
from fixedpipe.pipeline.vertices.colors import stacked_colors
from fixedpipe.raster.floats import kept
from fixedpipe.raster.primitives.meshes import (
    all_below,
    all_finite,
    color_bytes,
    separate_triangles,
    unit_coordinates,
)

values = st.one_of(
    st.floats(-0.5, 1.5), st.integers(-1, 256).map(lambda k: (k + 0.5) / 255), st.floats(-1e300, 1e300)
)


def given_array(vertices, low, high):
    return st.integers(low, high).flatmap(
        lambda components: arrays.arrays(np.float64, (vertices, components), elements=values)
    )


def two_arrays(low, high):
    return st.integers(1, 40).flatmap(
        lambda n: st.tuples(given_array(n, low, high), given_array(n, low, high), st.booleans())
    )


@given(two_arrays(0, 4), st.sampled_from([8, 16, 17, 24, 53]))
def test_bytes_of_colors(both, bits):
    colors, secondary, alike = both
    if alike:
        colors[:], secondary[:] = colors[:1], secondary[:1]
    out = np.empty((len(colors), 2, 8), np.uint8)
    same = color_bytes(colors, secondary, kept(bits), out)
    columns = columns_of(colors, (1.0,) * 4) + columns_of(secondary, (0.0,) * 4)
    expected = stacked_colors(len(colors), [np.fmin(positive(column), ONE) for column in columns], bits)
    np.testing.assert_array_equal(out, expected)
    assert same == (expected == expected[0]).all()


@given(two_arrays(0, 4))
def test_coordinates_of_units(both):
    *sets, _ = both
    out = np.empty((len(sets[0]), 2, 4))
    projective = unit_coordinates((*sets, *[np.empty((0, 0))] * 2), out)
    for unit, given_set in enumerate(sets):
        columns = [np.broadcast_to(c, len(out)) for c in columns_of(given_set, (0.0, 0.0, 0.0, 1.0))]
        np.testing.assert_array_equal(out[:, unit], np.stack(columns, axis=1))
        assert bool(projective >> unit & 1) == (columns[3] != 1.0).any()


@given(given_array(7, 1, 4), st.integers(0, 27), st.sampled_from([np.nan, np.inf, -np.inf, 1e308]))
def test_numbers_that_are_not_finite(numbers, place, number):
    assert all_finite(numbers)
    numbers.reshape(-1)[place % numbers.size] = number
    assert all_finite(numbers) == np.isfinite(number)


@given(arrays.arrays(np.int64, st.integers(0, 9), elements=st.integers(-2, 6)), st.integers(0, 5))
def test_indices_that_are_no_vertices(indices, count):
    assert all_below(indices, count) == all(0 <= index < count for index in indices.tolist())


@given(st.integers(0, 10), st.sampled_from([0, 2]))
def test_rows_of_separate_triangles(length, provoking):
    stream = np.random.default_rng(length).integers(0, 50, length)
    out = np.empty((length // 3, 4), np.int32)
    separate_triangles(stream, provoking, out)
    expected = [[*row, row[provoking]] for row in stream[: length - length % 3].reshape(-1, 3).tolist()]
    assert out.tolist() == expected
