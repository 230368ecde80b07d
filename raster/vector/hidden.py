"""Which fragments fail the depth test before they are shaded."""

from numba import int32, uint32, uint64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.vector.lanes import below, load_each_i32x16, load_i32x16, mask_bits
from fixedpipe.raster.vector.per_fragment import FAR_DEPTH, interval


@kernel
def tests_early(draw):
    """Whether a fragment that fails the depth test now can be left out before it is shaded.

    Leaving it out is safe. No stencil operation depends on its failure. And a fragment that fails against the
    present depth fails later too, because until then only passing fragments of the same Draw change depths.
    With LESS, LEQUAL, GREATER and GEQUAL they move depths away from the failed one. With EQUAL, or where
    depths are not written, depths stay.
    """
    function, still = draw[R.DEPTH_FUNCTION], draw[R.DEPTH_WRITE] == 0
    useful = draw[R.NEEDS_DEPTH] != 0 and draw[R.NEEDS_COLOR] != 0 and function != C.COMPARISON_ALWAYS
    return useful and draw[R.STENCIL_TEST] == 0 and (still or function != C.COMPARISON_NOTEQUAL)


@kernel("boolean(u4[::1],i4[::1],i4[::1],i8,i8,i8)")
def are_hidden(depth_words, pixel, depth, start, count, function):
    """Whether none of ``count`` fragments from ``start`` passes the depth test, each at its ``pixel``."""
    separate_function()
    first, width = interval(function, FAR_DEPTH)
    low, near = int32(first), int32(width)
    whole = start + (count & ~15)
    for i in range(start, whole, 16):
        value, old = load_i32x16(depth, i), load_each_i32x16(depth_words, pixel, i)
        if mask_bits(below(value - old - low, near)) != 0:
            return False
    for i in range(whole, start + count):
        old = depth_words[uint64(pixel[i])]
        if uint32(uint32(depth[i]) - old - uint32(low)) < uint32(near):
            return False
    return True


@kernel("boolean(u4[::1],i8,i4[::1],i8,i8,i8)")
def is_hidden(depth_row, x, depth, start, count, function):
    """``are_hidden`` for a run from ``x`` of a row."""
    separate_function()
    first, width = interval(function, FAR_DEPTH)
    low, near = int32(first), int32(width)
    whole = count & ~15
    for i in range(0, whole, 16):
        value, old = load_i32x16(depth, start + i), load_i32x16(depth_row, x + i)
        if mask_bits(below(value - old - low, near)) != 0:
            return False
    for i in range(whole, count):
        old = depth_row[uint64(x + i)]
        if uint32(uint32(depth[uint64(start + i)]) - old - uint32(low)) < uint32(near):
            return False
    return True
