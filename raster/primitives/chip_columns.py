"""Columns of numbers through the units' arithmetic (``chip_floats``): a loop each.

A column is a row of a chunk's scratch, as in ``lighting_columns``.
"""

from fixedpipe.raster.kernel import kernel, separate_loop
from fixedpipe.raster.primitives.chip_floats import (
    LIGHTING_BITS,
    TRANSFORM_BITS,
    dot3,
    dot4,
    product,
    single,
    to_lighting,
    total2,
)


@kernel
def to_single(out):
    """In single precision."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = single(out[i])


@kernel
def enter(out, a):
    """A column in the lighting unit's precision."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = to_lighting(a[i])


@kernel
def enter_single(out):
    """The same of itself, in single precision before."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = to_lighting(single(out[i]))


@kernel
def enter_given(out, a):
    """The same of another, in single precision before."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = to_lighting(single(a[i]))


@kernel
def row4(out, a, b, c, d, row):
    """The sum of four columns by the entries of a row."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = dot4((a[i], b[i], c[i], d[i]), row, TRANSFORM_BITS)


@kernel
def row3(out, a, b, c, row):
    """The sum of three columns by the entries of a row."""
    separate_loop()
    r0, r1, r2 = row
    for i in range(out.shape[0]):
        out[i] = dot3(a[i], b[i], c[i], r0, r1, r2, TRANSFORM_BITS)


@kernel
def dot(out, a, b):
    """The dot products of two vectors of columns."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = dot3(a[0, i], a[1, i], a[2, i], b[0, i], b[1, i], b[2, i], LIGHTING_BITS)


@kernel
def blend(out, b, weight):
    """The weighted sum of two matrices' results, into the first's."""
    separate_loop()
    for i in range(out.shape[0]):
        w = single(weight[i])
        rest = total2(1.0, -w, TRANSFORM_BITS, 5)
        shares = product(out[i], w, TRANSFORM_BITS), product(b[i], rest, TRANSFORM_BITS)
        out[i] = total2(shares[0], shares[1], TRANSFORM_BITS, 5)
