"""Colours by vectors: the values of ``fixedpipe.raster.portable.interpolate.iterate_color``."""

from typing import NamedTuple

import numpy as np
from numba import float32, float64, int16, int32, int64, uint8, uint32, void

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import type_of
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop
from fixedpipe.raster.vector.interpolate import LISTED
from fixedpipe.raster.vector.lanes import (
    i16x16,
    load_f32x16,
    load_f64x16,
    load_i16x16,
    load_i32x16,
    narrow_i16,
    shift_right,
    store,
    to_int32,
    widen_unsigned_i32,
)


class Colors(NamedTuple):
    """What colours are iterated from.

    triangles  int32[n, 4]
    vertices   uint8[n, 2, 8]
    flat       whether a triangle takes its provoking vertex's colour
    """

    triangles: np.ndarray
    vertices: np.ndarray
    flat: int


class ColorWeights(NamedTuple):
    """What colours are iterated with: columns Q0 and Q2 of ``floats``. Segments that do not mix triangles may
    have them in ``singles`` (SINGLE_Q0 and SINGLE_Q2); else, where ``whole``, as W0 and W2 of ``ints``.
    """

    floats: np.ndarray
    singles: np.ndarray
    ints: np.ndarray
    whole: int


COLORS = type_of(Colors, int32[:, ::1], uint8[:, :, ::1], int64)
COLOR_WEIGHTS = type_of(ColorWeights, float64[:, ::1], float32[:, ::1], int32[:, ::1], int64)


@kernel
def color_weights(weights, single, i):
    """W0 and W2 of sixteen fragments of one triangle."""
    floats, singles, ints, whole = weights
    if single:
        w0 = narrow_i16(to_int32(load_f32x16(singles[R.SINGLE_Q0], i) * 256.0))
        return w0, narrow_i16(to_int32(load_f32x16(singles[R.SINGLE_Q2], i) * 256.0))
    if whole:
        return narrow_i16(load_i32x16(ints[R.W0], i)), narrow_i16(load_i32x16(ints[R.W2], i))
    w0 = narrow_i16(to_int32(load_f64x16(floats[R.Q0], i) * 256.0))
    return w0, narrow_i16(to_int32(load_f64x16(floats[R.Q2], i) * 256.0))


@kernel
def channel(w0, w2, base, d0, d2):
    """256 c + 128 of one colour channel, modulo 2**16: below it, as 255 * 256 + 128 is."""
    return (w0 * d0 + w2 * d2) + base


@kernel
def color_terms(colors, i0, i1, i2, side, c):
    """One channel's base, and the differences of vertices 0 and 2 from vertex 1."""
    c0, c1, c2 = int32(colors[i0, side, c]), int32(colors[i1, side, c]), int32(colors[i2, side, c])
    return int16(c1 * int32(256) + int32(128)), int16(c0 - c1), int16(c2 - c1)


@kernel(void(LISTED, COLORS, int64, COLOR_WEIGHTS, int16[:, ::1], int16[:, ::1], int64))
def iterate_colors(segments, of, first, weights, terms, out, plane):
    """Four colour channels from ``first`` on into four planes of ``out``: ``interpolate.iterate_color``.

    ``terms``: the planes from which mixed segments take base, and differences of vertices 0 and 2, of each
    channel.
    """
    separate_loop()
    triangles, colors, flat = of
    starts, owners, backs = segments.lists[R.STARTS], segments.lists[R.OWNERS], segments.lists[R.BACKS]
    q0, q2 = weights.floats[R.Q0], weights.floats[R.Q2]
    for s in range(segments.count):
        t, begin, end = owners[s], int64(starts[s]), int64(starts[s + 1])
        if t < 0:
            for c in range(4):
                base, d0, d2 = terms[3 * c], terms[3 * c + 1], terms[3 * c + 2]
                into = out[plane + c]
                for i in range(begin, end, 16):
                    total = load_i16x16(base, i)
                    if not flat:
                        w0 = narrow_i16(to_int32(load_f64x16(q0, i) * 256.0))
                        w2 = narrow_i16(to_int32(load_f64x16(q2, i) * 256.0))
                        total = channel(w0, w2, total, load_i16x16(d0, i), load_i16x16(d2, i))
                    store(into, i, shift_right(total, 8))
            continue
        side, single = backs[s], segments.lists[R.SINGLE, s] != 0
        if flat:
            for c in range(4):
                value = i16x16(int16(colors[triangles[t, 3], side, first + c]))
                into = out[plane + c]
                for i in range(begin, end, 16):
                    store(into, i, value)
            continue
        i0, i1, i2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        b0, x0, y0 = color_terms(colors, i0, i1, i2, side, first)
        b1, x1, y1 = color_terms(colors, i0, i1, i2, side, first + 1)
        b2, x2, y2 = color_terms(colors, i0, i1, i2, side, first + 2)
        b3, x3, y3 = color_terms(colors, i0, i1, i2, side, first + 3)
        into0, into1, into2, into3 = out[plane], out[plane + 1], out[plane + 2], out[plane + 3]
        for i in range(begin, end, 16):
            w0, w2 = color_weights(weights, single, i)
            store(into0, i, shift_right(channel(w0, w2, b0, x0, y0), 8))
            store(into1, i, shift_right(channel(w0, w2, b1, x1, y1), 8))
            store(into2, i, shift_right(channel(w0, w2, b2, x2, y2), 8))
            store(into3, i, shift_right(channel(w0, w2, b3, x3, y3), 8))


@kernel(void(LISTED, COLORS, COLOR_WEIGHTS, int16[:, ::1], uint32[::1]))
def iterate_packed(segments, of, weights, terms, out):
    """The primary colour as packed bytes: ``iterate_colors`` where nothing else is done with it."""
    separate_loop()
    triangles, colors, flat = of
    starts, owners, backs = segments.lists[R.STARTS], segments.lists[R.OWNERS], segments.lists[R.BACKS]
    q0, q2 = weights.floats[R.Q0], weights.floats[R.Q2]
    high = int16(-256)
    for s in range(segments.count):
        t, begin, end = owners[s], int64(starts[s]), int64(starts[s + 1])
        if t < 0:
            for i in range(begin, end, 16):
                r, g = load_i16x16(terms[0], i), load_i16x16(terms[3], i)
                b, a = load_i16x16(terms[6], i), load_i16x16(terms[9], i)
                if not flat:
                    w0 = narrow_i16(to_int32(load_f64x16(q0, i) * 256.0))
                    w2 = narrow_i16(to_int32(load_f64x16(q2, i) * 256.0))
                    r = channel(w0, w2, r, load_i16x16(terms[1], i), load_i16x16(terms[2], i))
                    g = channel(w0, w2, g, load_i16x16(terms[4], i), load_i16x16(terms[5], i))
                    b = channel(w0, w2, b, load_i16x16(terms[7], i), load_i16x16(terms[8], i))
                    a = channel(w0, w2, a, load_i16x16(terms[10], i), load_i16x16(terms[11], i))
                low, upper = shift_right(r, 8) | (g & high), shift_right(b, 8) | (a & high)
                store(out, i, widen_unsigned_i32(low) | (widen_unsigned_i32(upper) << 16))
            continue
        side, single = backs[s], segments.lists[R.SINGLE, s] != 0
        i0, i1, i2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        if flat:
            i0 = i1 = i2 = triangles[t, 3]
        b0, x0, y0 = color_terms(colors, i0, i1, i2, side, 0)
        b1, x1, y1 = color_terms(colors, i0, i1, i2, side, 1)
        b2, x2, y2 = color_terms(colors, i0, i1, i2, side, 2)
        b3, x3, y3 = color_terms(colors, i0, i1, i2, side, 3)
        if flat:
            r, g, b, a = i16x16(b0), i16x16(b1), i16x16(b2), i16x16(b3)
            low, upper = shift_right(r, 8) | (g & high), shift_right(b, 8) | (a & high)
            value = widen_unsigned_i32(low) | (widen_unsigned_i32(upper) << 16)
            for i in range(begin, end, 16):
                store(out, i, value)
            continue
        for i in range(begin, end, 16):
            w0, w2 = color_weights(weights, single, i)
            r, g = channel(w0, w2, b0, x0, y0), channel(w0, w2, b1, x1, y1)
            b, a = channel(w0, w2, b2, x2, y2), channel(w0, w2, b3, x3, y3)
            low, upper = shift_right(r, 8) | (g & high), shift_right(b, 8) | (a & high)
            store(out, i, widen_unsigned_i32(low) | (widen_unsigned_i32(upper) << 16))


@kernel(void(int16[:, ::1], int64, int64, COLORS, int64, int32, int32))
def spread_colors(terms, position, count, of, channels, t, side):
    """Small triangle t's numbers for the mixed segments of ``iterate_colors``: of four channels, or of eight
    with the secondary colour's from plane 12 on.
    """
    separate_function()
    triangles, colors, flat = of
    i0, i1, i2 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    if flat:
        i0 = i1 = i2 = triangles[t, 3]
    for c in range(channels):
        base, d0, d2 = color_terms(colors, i0, i1, i2, side, c)
        for i in range(position, position + count, 16):
            store(terms[3 * c], i, i16x16(base))
            if not flat:
                store(terms[3 * c + 1], i, i16x16(d0))
                store(terms[3 * c + 2], i, i16x16(d2))
