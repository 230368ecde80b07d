"""What both ways to light vertices do with columns: a mesh's arrays, powers, colours that reach fragments.

A column is a row of a chunk's scratch: float64[CHUNK], whose first numbers, one for each vertex, are used.
"""

import math

from numba import int64, types

from fixedpipe.raster.kernel import bits_of, float_of, kernel, separate_loop

CHUNK = 128  # vertices: their columns stay in the second level cache

ARRAY = types.Array(types.float64, 2, "C", readonly=True)  # a mesh's; without rows where a mesh lacks it


@kernel
def fill(out, value):
    """A column of one value."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = value


@kernel
def copy_component(out, array, k, default):
    """Component k of a mesh's array, or its default where the array lacks it."""
    if k < array.shape[1]:
        for i in range(out.shape[0]):
            out[i] = array[i, k]
    else:
        fill(out, default)


@kernel
def copy_vector(out, n, array, default, last):
    """The components of a mesh's array; those it lacks are ``default``, the last one ``last``."""
    for k in range(out.shape[0]):
        copy_component(out[k, :n], array, k, last if k == out.shape[0] - 1 else default)


@kernel
def _multiply(out, a):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = out[i] * a[i]


@kernel
def _square(out):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = out[i] * out[i]


@kernel
def _root(out):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = math.sqrt(out[i])


@kernel
def copy(out, a):
    """A column's copy."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = a[i]


@kernel
def power(out, base, factor, exponent):
    """Raise base >= 0 to a finite exponent >= 0, the same bits on every processor; 0 to the power 0 is 1.

    out, base, factor  columns: the result, the base, scratch

    The result is a product of one factor for each binary digit 1 of the exponent. The digits of the whole
    part, from the lowest up, take base^1, base^2, base^4, ... from repeated squaring. The digits of the
    fraction, from the highest down, take base^(1/2), base^(1/4), ... from repeated square roots.

    Up to an exponent of 128 the relative error is below 1e-13 where the result is a normal number. Squaring
    doubles an error and a square root halves it, so all errors add up to some 130 roundings of 2^-53, 2e-14.
    """
    fill(out, 1.0)
    whole = int64(exponent)
    fraction = exponent - whole
    copy(factor, base)
    while whole > 0:
        if whole & 1:
            _multiply(out, factor)
        whole >>= 1
        if whole > 0:
            _square(factor)
    if fraction > 0.0:
        copy(factor, base)
    while fraction > 0.0:
        _root(factor)
        fraction *= 2.0
        if fraction >= 1.0:
            _multiply(out, factor)
            fraction -= 1.0


@kernel
def clamp(out):
    """Numbers limited to [0, 1]; NaN becomes 0."""
    separate_loop()
    for i in range(out.shape[0]):
        x = out[i] if out[i] > 0.0 else 0.0
        out[i] = x if x < 1.0 else 1.0


@kernel("void(f8[:,::1],i8,u1[:,:,::1])")
def rounded_colors(columns, mask, out):
    """Bytes of colours in [0, 1] (docs/numbers.md, section 2).

    columns  float64[8 or 16, n]: colour and secondary colour, of the front or of front and back
    mask     of the bits of a float64 that are kept
    out      uint8[n, 2, 8]: front and back
    """
    back = columns.shape[0] - 8
    for k in range(8):
        for i in range(out.shape[0]):
            out[i, 0, k] = int64(math.floor(float_of(bits_of(columns[k, i]) & mask) * 255.0 + 0.5))
        for i in range(out.shape[0]):
            kept = float_of(bits_of(columns[back + k, i]) & mask)
            out[i, 1, k] = int64(math.floor(kept * 255.0 + 0.5)) if back else out[i, 0, k]
