"""Kernels of a mesh's arrays, against the column arithmetic that lit and clipped vertices take."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from fixedpipe.pipeline.vertices.arithmetic import ONE, columns_of, positive
from fixedpipe.pipeline.vertices.colors import stacked_colors
from fixedpipe.raster.floats import kept
from fixedpipe.raster.primitives.meshes import color_bytes, unit_coordinates

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
    for unit, given_set in enumerate(sets):
        projective = unit_coordinates(given_set, unit, out)
        columns = [np.broadcast_to(c, len(out)) for c in columns_of(given_set, (0.0, 0.0, 0.0, 1.0))]
        np.testing.assert_array_equal(out[:, unit], np.stack(columns, axis=1))
        assert projective == (columns[3] != 1.0).any()
