"""Computed texture coordinates by vectors: divided by q, of a cube map's face, compared as a depth.

The operations are those of raster/portable/sample.py and raster/portable/shadow.py, in the same order, on
columns of float64, up to the int32 columns that raster/vector/sample.py reads. Columns are whole vectors
longer than ``count`` asks for.
"""

from numba import float64, int32, int64

from fixedpipe.raster import codes as C
from fixedpipe.raster.fixed import float_depth
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.vector.lanes import (
    absolute,
    bits_of_lanes,
    f64x16,
    floored,
    i32x16,
    load_f64x16,
    maximum,
    minimum,
    narrow_i32,
    select,
    store,
    to_int32,
)


@kernel
def _nonzero(q):
    """q, or one where it is zero."""
    return select(q != 0.0, q, f64x16(1.0))


@kernel("void(f8[::1],f8[::1],i8)")
def divide_by_q(column, q, count):
    """A projective coordinate by q, in its column; a q of zero counts as one."""
    separate_function()
    for at in range(0, count, 16):
        store(column, at, load_f64x16(column, at) / _nonzero(load_f64x16(q, at)))


@kernel("void(f8[::1],f8[::1],f8[::1],i4[::1],i8)")
def cube_faces(s, t, r, face, count):
    """A direction's ``face``; sc/|ma| + 1 and tc/|ma| + 1 into s and t, 0
    where there is no direction. As fixedpipe.raster.portable.sample.cube_faces.
    """
    separate_function()
    face_x, face_y = i32x16(int32(C.FACE_POSITIVE_X)), i32x16(int32(C.FACE_POSITIVE_Y))
    face_z = i32x16(int32(C.FACE_POSITIVE_Z))
    for at in range(0, count, 16):
        x, y, z = load_f64x16(s, at), load_f64x16(t, at), load_f64x16(r, at)
        is_x = (absolute(x) >= absolute(y)) & (absolute(x) >= absolute(z))
        is_y = absolute(y) >= absolute(z)
        major = select(is_x, x, select(is_y, y, z))
        back = select(major >= 0.0, i32x16(int32(0)), i32x16(int32(1)))
        sign = select(major >= 0.0, f64x16(1.0), f64x16(-1.0))
        ma = major * sign
        sc = select(is_x, z * (sign * -1.0), select(is_y, x, x * sign))
        tc = select(is_x, y * -1.0, select(is_y, z * sign, y * -1.0))
        first = select(is_x, face_x, select(is_y, face_y, face_z))
        some = ma > 0.0
        store(face, at, first + back)
        store(s, at, select(some, sc / ma + 1.0, f64x16(0.0)))
        store(t, at, select(some, tc / ma + 1.0, f64x16(0.0)))


@kernel("void(f8[::1],i4[::1],f8,f8,f8,i8,i8,i8)")
def fixed_from_floats(column, out, size, bias, scale, wrap, linear, count):
    """F of a level of ``size`` texels, of any size, as ``sample.locate`` takes it.

    The texel coordinate is coordinate * (scale * size) + ``bias`` (``scale`` 1, or 1/2 for a cube face's
    doubled coordinates), or, for ``scale`` 0, coordinate + ``bias``; ``bias`` TAU or 0. ``wrap``: REPEAT,
    CLAMP_TO_EDGE or, where not ``linear``, CLAMP.
    """
    separate_loop()
    factor = scale * size if scale != 0.0 else 1.0
    inverse = 1.0 / size
    last = int32(int32(size) - int32(1))
    period = int32(int32(size) * int32(256))
    low, high = 0.0, size
    if wrap == C.WRAP_CLAMP_TO_EDGE:
        low, high = 0.5, size - 0.5
    for at in range(0, count, 16):
        texel = load_f64x16(column, at) * factor + bias
        if wrap == C.WRAP_REPEAT:
            texel = texel - floored(texel * inverse) * size
        texel = minimum(maximum(texel, low), high)  # low, too, where it is not a number
        if linear:
            fixed = to_int32(floored((texel - 0.5) * 256.0))
            fixed = select(fixed < int32(0), fixed + period, fixed) + int32(128)
        else:
            index = to_int32(texel)
            index = select(index > last, i32x16(int32(0) if wrap == C.WRAP_REPEAT else last), index)
            fixed = index << int32(8)
        store(out, at, fixed)


@kernel("void(f8[::1],i4[::1],f8,i8,i4,i8)")
def depth_words(column, out, scale, number_format, maximum_word, count):
    """The depth words that texels are compared with: a coordinate times ``scale``, in units, as
    fixedpipe.raster.portable.shadow.depth_word makes it.
    """
    separate_loop()
    largest = float64(maximum_word)
    if number_format == C.DEPTH_FIXED:
        for at in range(0, count, 16):
            value = maximum(load_f64x16(column, at) * scale, 0.0)
            store(out, at, to_int32(minimum(value, largest)))
        return
    form = float_depth(number_format)
    shift, zero = form.dropped, form.rebias
    for at in range(0, count, 16):
        value = maximum(load_f64x16(column, at) * scale, 0.0)
        bits = (bits_of_lanes(value) >> shift) - zero
        store(out, at, narrow_i32(minimum(maximum(bits, int64(0)), int64(maximum_word))))
