"""Weights of a fragment inside its triangle, and everything iterated with them (docs/numbers.md, sections 4
to 6).

Loops index with unsigned integers: NumPy's negative indices would cost every access a comparison and keep
LLVM from vectorising. A batch's fragments are columns, which belong to triangles by ``segments``; ``edges``
are their edge functions times 1/w.
"""

from typing import NamedTuple

import numpy as np
from numba import float32, float64, int16, int32, int64, uint64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import SEGMENTS, THREE, type_of
from fixedpipe.raster.fixed import (
    clamp,
    float_depth,
    one_of,
    power_below,
    reciprocal_24,
    reciprocal_29,
    step_24,
    truncate_24,
)
from fixedpipe.raster.floats import LARGEST_SINGLE, LEAST_SINGLE, REST_STEP, REST_STEPS, SMALLEST
from fixedpipe.raster.kernel import bits_of, kernel, separate_loop
from fixedpipe.raster.portable.arrays import EDGES, FOG_FACTORS

MOST_WEIGHT = 2.0**16  # of colours, outside their triangle: sums of products stay below 2**31
TINY = 2.0**-256  # far below any depth: where all terms are 0, their unit is not
LEAST_FACTOR = 2.0**-300  # below any product of two normal singles


@kernel(void(EDGES, int64, int64, THREE, THREE, THREE))
def emit_weights(edges, position, count, n, step, inverse_w):
    """Edge functions of ``count`` pixels to the right of the one that has ``n``, times the vertices' 1/w."""
    separate_loop()
    e0, e1, e2 = edges
    (n0, n1, n2), (step0, step1, step2), (iw0, iw1, iw2) = n, step, inverse_w
    at = uint64(position)
    for i in range(count):
        k = float64(int32(i))
        e0[at + uint64(i)] = (n0 + k * step0) * iw0
        e1[at + uint64(i)] = (n1 + k * step1) * iw1
        e2[at + uint64(i)] = (n2 + k * step2) * iw2


@kernel
def depth_difference(z, base):
    """The difference to 24 significant bits; 0 where it is below a single's smallest normal number.

    Measured: 12 squares of a 24-bit float buffer take one vertex's depth (DepthFmt_z24 FZy captures).
    """
    difference = truncate_24(z - base)
    return difference if abs(difference) >= LEAST_SINGLE else 0.0


@kernel
def depth_sum(base, a, b):
    """A vertex's depth plus what the two others add to it, each with 29 bits from the largest term's highest;
    the sum is cut to 24 bits.
    """
    unit = power_below(max(max(abs(base), TINY), max(abs(a), abs(b)))) * 2.0**-28
    scale = 1.0 / unit
    return truncate_24((base + float64(int32(a * scale)) * unit) + float64(int32(b * scale)) * unit)


@kernel(void(float64[:, ::1], int64, int64, THREE, THREE, THREE, float64))
def emit_depth(floats, position, count, n, step, z, offset):
    """Depths of ``count`` pixels to the right of the one whose edge functions are ``n``, into DEPTH.

    z: the vertices' depths, singles; ``offset`` is added. docs/numbers.md, section 5.
    """
    separate_loop()
    (n0, n1, n2), (step0, step1, step2), (z0, z1, z2) = n, step, z
    at, row = uint64(position), uint64(R.DEPTH)
    if z0 == z1 and z1 == z2:  # differences of zero: whatever the weights, the sum below is the base
        for i in range(count):
            floats[row, at + uint64(i)] = z0 + offset
        return
    d10, d20 = depth_difference(z1, z0), depth_difference(z2, z0)
    d01, d21 = depth_difference(z0, z1), depth_difference(z2, z1)
    d02, d12 = depth_difference(z0, z2), depth_difference(z1, z2)
    for i in range(count):
        k = float64(int32(i))
        e0, e1, e2 = truncate_24(n0 + k * step0), truncate_24(n1 + k * step1), truncate_24(n2 + k * step2)
        reciprocal = reciprocal_29((e0 + e1) + e2)
        q0 = truncate_24(e0 * reciprocal)
        q1 = truncate_24(e1 * reciprocal)
        q2 = truncate_24(e2 * reciprocal)
        p0, p1, p2 = power_below(e0), power_below(e1), power_below(e2)
        first = (p0 > p1) & (p0 >= p2)
        last = (p2 > p1) & (p2 > p0)
        base = z0 if first else (z2 if last else z1)
        a = (q1 if first else q0) * (d10 if first else (d02 if last else d01))
        b = (q1 if last else q2) * (d20 if first else (d12 if last else d21))
        floats[row, at + uint64(i)] = depth_sum(base, a, b) + offset


@kernel
def w_of(inverse_w):
    """A vertex's |w|: the single nearest to it."""
    return min(float64(float32(abs(1.0 / inverse_w))), LARGEST_SINGLE)


@kernel
def with_sign(size, sign):
    """``size``, not negative, with the sign of the other."""
    return size if sign >= 0.0 else 0.0 - size


@kernel
def weight_factors(iw0, iw1, iw2):
    """What edge functions are multiplied with for weights: not a vertex's 1/w, but the product of the two
    others' w, in 24 bits, with the sign of its w; 1 where the three are equal.

    Measured: rows of WBuf24F_FloorQuad and RoofQuad, 980 pixels that change where such a product's exponent
    does. Assumed: what keeps it above 0.
    """
    if iw0 == iw1 and iw1 == iw2:
        return 1.0, 1.0, 1.0
    w0, w1, w2 = w_of(iw0), w_of(iw1), w_of(iw2)
    return (
        with_sign(max(truncate_24(w1 * w2), LEAST_FACTOR), iw0),
        with_sign(max(truncate_24(w0 * w2), LEAST_FACTOR), iw1),
        with_sign(max(truncate_24(w0 * w1), LEAST_FACTOR), iw2),
    )


@kernel
def weight_sum(e0, e1, e2):
    """The sum of weights before they are divided: each is cut one bit below the 24 of the largest, and what
    they add up to is cut to 24.

    Measured: WBuf24F_TriH, 48 depths; with one bit less or two bits more, some are wrong.
    """
    power = power_below(max(max(abs(e0), TINY), max(abs(e1), abs(e2))))
    unit, units = power * 2.0**-24, 2.0**24 / power
    return truncate_24(((np.trunc(e0 * units) + np.trunc(e1 * units)) + np.trunc(e2 * units)) * unit)


@kernel
def rest_of(a, b):
    """What two weights leave of one. The adder keeps two bits below the last of one's 24: both weights lose
    their bits from 2**-26 on, and the result is cut to 24 bits.

    Measured: 66 of 77 captures of Shade_model are exact, with 24 bits 60, with 26 or more 61; of W_param's
    prog_w_zero_inf__bitri_w-2.00 3 pixels are wrong, with 24 bits 154, with 26 131; of Swath_width's
    SwathWidth00 9, without the last cut 69.
    """
    return truncate_24((1.0 - np.trunc(a * REST_STEPS) * REST_STEP) - np.trunc(b * REST_STEPS) * REST_STEP)


@kernel
def weight_class(q):
    """(q >= 1/2) + (q >= 1/4), as a float: comparisons stay in the lanes of q."""
    return 2.0 if q >= 0.5 else (1.0 if q >= 0.25 else 0.0)


@kernel
def iteration_weights(n0, n1, n2, factors):
    """Weights of vertices 0 and 2 with 24 significant bits from edge functions, float64, and their
    ``weight_factors``; the vertex with the largest one takes what the two others leave.

    Measured: as colours' weights 153600 of 153600, 28618 of 28618 and 64522 of 64522 pixels (Depth_buffer
    M00ffff, Line_width Fill, Alpha_func captures); in perspective 17 pictures of W_buffering's FloorQuad_V0,
    230809 texels.
    """
    e0 = truncate_24(truncate_24(n0) * factors[0])
    e1 = truncate_24(truncate_24(n1) * factors[1])
    e2 = truncate_24(truncate_24(n2) * factors[2])
    reciprocal = reciprocal_24(weight_sum(e0, e1, e2))
    q0 = truncate_24(e0 * reciprocal)
    q1 = truncate_24(e1 * reciprocal)
    q2 = truncate_24(e2 * reciprocal)
    c0, c1, c2 = weight_class(q0), weight_class(q1), weight_class(q2)
    first = (c0 >= c1) & (c0 > c2)
    last = (c2 >= c0) & ((c2 > c1) | ((c2 == c1) & (c0 == c1)))
    return rest_of(q1, q2) if first else q0, rest_of(q0, q1) if last else q2


@kernel(void(float64[:, ::1], int64, int64, THREE, THREE, THREE))
def emit_iteration_weights(floats, position, count, n, step, factors):
    """``iteration_weights`` of ``count`` pixels to the right of the one whose edge functions are ``n``, into
    Q0 and Q2.
    """
    separate_loop()
    (n0, n1, n2), (step0, step1, step2) = n, step
    at = uint64(position)
    for i in range(count):
        k = float64(int32(i))
        q0, q2 = iteration_weights(n0 + k * step0, n1 + k * step1, n2 + k * step2, factors)
        floats[R.Q0, at + uint64(i)] = q0
        floats[R.Q2, at + uint64(i)] = q2


@kernel(void(float64[:, ::1], int64, int64, THREE, float64))
def emit_w(floats, position, count, w, offset):
    """Depths of W buffering into DEPTH, from Q0 and Q2: vertex 1's ``w``, a single, and what the two others
    add; ``offset`` is added.

    Measured: base and sum WBuf24D_LargeZ, 307200 of 307200; every depth without a slope of 36 of 37 captures.
    """
    separate_loop()
    (w0, w1, w2), at, row = w, uint64(position), uint64(R.DEPTH)
    d01, d21 = depth_difference(w0, w1), depth_difference(w2, w1)
    for i in range(count):
        k = at + uint64(i)
        floats[row, k] = depth_sum(w1, floats[R.Q0, k] * d01, floats[R.Q2, k] * d21) + offset


@kernel("void(f8[:,::1],i8,i8[::1],f8[::1],i4[::1])")
def depth_words(floats, count, draw, draw_float, depth):
    """Depths of a batch as the depth buffer's words: limited, then floor, or the upper bits of a float.

    A fragment outside limits that cull gets the word -1. Measured: DepthFmt captures, all four formats.
    """
    separate_loop()
    row = uint64(R.DEPTH)
    low, high, cull = draw_float[R.DEPTH_LOW], draw_float[R.DEPTH_HIGH], draw[R.DEPTH_CULL] != 0
    number_format, largest = draw[R.DEPTH_FORMAT], int32(draw[R.DEPTH_MAX])
    if number_format == C.DEPTH_FIXED:
        top = float64(largest)
        for i in range(count):
            z = floats[row, uint64(i)]
            word = int32(min(max(min(max(z, low), high), 0.0), top))  # not negative: truncation is floor
            depth[uint64(i)] = int32(-1) if cull & ((z < low) | (z > high)) else word
        return
    form = float_depth(number_format)
    shift, zero, smallest = form.dropped, form.rebias, int32(1 << form.fraction_bits)
    for i in range(count):
        z = floats[row, uint64(i)]
        bits = bits_of(min(max(min(max(z, low), high), 0.0), 2.0**128))
        word = int32(max((bits >> shift) - zero, int64(0)))
        word = min(word, largest) if word >= smallest else int32(0)
        depth[uint64(i)] = int32(-1) if cull & ((z < low) | (z > high)) else word


@kernel(void(EDGES, int64, float64[:, ::1]))
def full_weights(edges, count, floats):
    """Perspective-correct weights of vertices 0 and 2, into B0 and B2."""
    separate_loop()
    e0, e1, e2 = edges
    for i in range(count):
        inverse = 1.0 / ((e0[i] + e1[i]) + e2[i])
        floats[R.B0, i] = e0[i] * inverse
        floats[R.B2, i] = e2[i] * inverse


@kernel
def cut_sum(v1, p0, p2):
    """The sum of three terms, each cut to 24 bits from the highest bit of the largest."""
    largest = max(max(abs(v1), max(abs(p0), abs(p2))), SMALLEST)
    step, steps = step_24(largest)
    return ((np.trunc(v1 * steps) + np.trunc(p0 * steps)) + np.trunc(p2 * steps)) * step


@kernel
def product_step(a0, b0, a1, b1, a2, b2):
    """The unit that three products are cut to, 2**-23 of the largest product of two factors' highest bits,
    and how many of it make one. A number alone is one times itself.

    Measured: ClipPlane; with the highest bits of the products themselves, its last 3 pixels are wrong.
    """
    power = max(power_below(a0) * power_below(b0), power_below(a1) * power_below(b1))
    return step_24(max(max(power, power_below(a2) * power_below(b2)), SMALLEST))


@kernel
def product_sum(a0, b0, a1, b1, a2, b2):
    """The sum of three products to 24 bits: each is cut, toward zero, to ``product_step``'s unit.

    Measured: DotZW, 65536 of 65536.
    """
    step, steps = product_step(a0, b0, a1, b1, a2, b2)
    total = (np.trunc(a0 * b0 * steps) + np.trunc(a1 * b1 * steps)) + np.trunc(a2 * b2 * steps)
    return truncate_24(total * step)


@kernel
def coordinate_difference(a, b):
    """a - b of vertices' coordinates to 24 bits: both are cut one bit below the 24 of the larger.

    Measured: DotZW, 48 of 65536 quotients, between corners of 0.1 and 1.
    """
    largest = max(max(abs(a), abs(b)), SMALLEST)
    if not largest < np.inf:
        return a - b
    step, steps = step_24(largest)
    return truncate_24((np.trunc(a * (2.0 * steps)) - np.trunc(b * (2.0 * steps))) * (0.5 * step))


@kernel("void(f8[:,::1],i8,i4[:,::1],i4)")
def color_weights(floats, count, ints, bits):
    """Weights W0 and W2 of vertices 0 and 2 of so many bits, from Q0 and Q2, cut toward zero.

    Measured: 738 of 738 pixels whose middle lies outside their triangle (3D_primitive Triangles-ps capture);
    floor loses 67 of them. Assumed: limits, which no picture reaches.
    """
    separate_loop()
    whole = float64(int32(int32(1) << bits))
    for i in range(count):
        ints[R.W0, i] = int32(min(max(floats[R.Q0, i] * whole, -MOST_WEIGHT), MOST_WEIGHT))
        ints[R.W2, i] = int32(min(max(floats[R.Q2, i] * whole, -MOST_WEIGHT), MOST_WEIGHT))


class Channel(NamedTuple):
    """A colour channel of a Draw.

    triangles  int32[n, 4]
    colors     int16[n, 2, 8]: the vertices'
    number     0 to 7
    flat       whether a triangle takes its provoking vertex's colour
    bits       of a component
    """

    triangles: np.ndarray
    colors: np.ndarray
    number: int
    flat: int
    bits: int


CHANNEL = type_of(Channel, int32[:, ::1], int16[:, :, ::1], int64, int64, int32)


@kernel(void(SEGMENTS, CHANNEL, int32[:, ::1], int16[:, ::1], int64))
def iterate_color(segments, channel, ints, out, plane):
    """One colour channel of ``bits`` bits into a plane of ``out``, or the provoking vertex's. Of eight:
    ``(w0 c0 + w1 c1 + w2 c2 + 128) >> 8``, within the vertices' least and greatest.

    Measured: over a million pixels (3D_primitive, Texture_perspective captures); the limits, 25 of 25 pixels
    whose middle lies outside their triangle, where without them one more colour is reached
    (Smoothing_control).
    """
    separate_loop()
    triangles, colors, k, flat, bits = channel
    p, starts, owners, backs = uint64(plane), segments.starts, segments.owners, segments.backs
    for s in range(segments.count):
        t = owners[s]
        side = backs[s]
        at, count = uint64(starts[s]), starts[s + 1] - starts[s]
        c0 = int32(colors[triangles[t, 0], side, k])
        c1 = int32(colors[triangles[t, 1], side, k])
        c2 = int32(colors[triangles[t, 2], side, k])
        if flat:
            c0 = c1 = c2 = int32(colors[triangles[t, 3], side, k])
        if c0 == c1 and c1 == c2:  # the weights sum to 1: the sum below is then exactly c0
            for i in range(count):
                out[p, at + uint64(i)] = int16(c0)
        else:
            low, high = min(c0, min(c1, c2)), max(c0, max(c1, c2))  # reached outside the triangle alone
            d0 = int32(c0 - c1)
            d2 = int32(c2 - c1)
            base = int32(int32(c1 << bits) + int32(int32(1) << int32(bits - 1)))
            for i in range(count):
                here = at + uint64(i)
                total = int32(base + int32(int32(ints[R.W0, here] * d0) + int32(ints[R.W2, here] * d2)))
                out[p, here] = int16(clamp(int32(total >> bits), low, high))


@kernel(void(SEGMENTS, CHANNEL, EDGES, int16[:, ::1], int64))
def iterate_exact_color(segments, channel, edges, out, plane):
    """One colour channel into a plane of ``out``, rounded to nearest:
    ``floor((2 ((e0 c0 + e1 c1) + e2 c2) + D) / (2 D))`` with ``D = (e0 + e1) + e2``.

    Where a triangle's 1/w are equal, e0, e1, e2 are integers below 2**40, all but the division is exact, and
    its quotient lies further from the next integer than float64 rounds it.
    """
    separate_loop()
    (triangles, colors, k, flat, bits), (e0, e1, e2) = channel, edges
    p, one = uint64(plane), float64(one_of(bits))
    starts, owners, backs = segments.starts, segments.owners, segments.backs
    for s in range(segments.count):
        t = owners[s]
        side = backs[s]
        at, count = uint64(starts[s]), starts[s + 1] - starts[s]
        c0 = float64(colors[triangles[t, 0], side, k])
        c1 = float64(colors[triangles[t, 1], side, k])
        c2 = float64(colors[triangles[t, 2], side, k])
        if flat:
            c0 = c1 = c2 = float64(colors[triangles[t, 3], side, k])
        for i in range(count):
            here = at + uint64(i)
            total = (e0[here] * c0 + e1[here] * c1) + e2[here] * c2
            whole = (e0[here] + e1[here]) + e2[here]
            value = np.floor((2.0 * total + whole) / (2.0 * whole))
            value = value if value > 0.0 else 0.0  # lines reach beyond their ends; no number becomes 0
            out[p, here] = int16(value if value < one else one)


@kernel(void(SEGMENTS, int32[:, ::1], float64[:, :, ::1], int64, int64, float64[:, ::1], int64))
def iterate_coordinate(segments, triangles, coordinates, unit, component, floats, column):
    """One texture coordinate into a column: the ``product_sum`` of ``v1``, ``q0 (v0 - v1)`` and
    ``q2 (v2 - v1)``.

    Measured: 48768 of 48768 pixels (CylinderWrapping, most of them on texel boundaries or within 6e-6
    texels), 41199 of 41199 (Anisotropy-1), 343329 of 343329 (three tex_tex captures); 23 and 25 bits miss
    some.
    """
    separate_loop()
    p, starts, owners = uint64(column), segments.starts, segments.owners
    for s in range(segments.count):
        t = owners[s]
        v1 = coordinates[triangles[t, 1], unit, component]
        d0 = coordinate_difference(coordinates[triangles[t, 0], unit, component], v1)
        d2 = coordinate_difference(coordinates[triangles[t, 2], unit, component], v1)
        at = uint64(starts[s])
        for i in range(starts[s + 1] - starts[s]):
            k = at + uint64(i)
            floats[p, k] = product_sum(v1, 1.0, floats[R.Q0, k], d0, floats[R.Q2, k], d2)


@kernel(void(SEGMENTS, int32[:, ::1], FOG_FACTORS, float64[:, ::1], int64, int16[:, ::1], int64, int32))
def iterate_fog(segments, triangles, fog, floats, rising, out, plane, bits):
    """The fog factor, of ``bits`` bits, into a plane of ``out``: how many of the thresholds, as many as its
    value of one (falling with k, or rising), the coordinate keeps.
    """
    separate_loop()
    one = int64(one_of(bits))
    starts, owners, of_vertex, thresholds = segments.starts, segments.owners, fog.coordinates, fog.thresholds
    for s in range(segments.count):
        t = owners[s]
        v1 = of_vertex[triangles[t, 1]]
        d0 = of_vertex[triangles[t, 0]] - v1
        d2 = of_vertex[triangles[t, 2]] - v1
        for i in range(starts[s], starts[s + 1]):
            c = (v1 + floats[R.B0, i] * d0) + floats[R.B2, i] * d2
            low, high = 0, one  # thresholds[k - 1] is T_k; the first `low` hold, those from `high` on do not
            while low < high:
                middle = (low + high + 1) >> 1
                holds = c >= thresholds[middle - 1] if rising else c <= thresholds[middle - 1]
                if holds:
                    low = middle
                else:
                    high = middle - 1
            out[plane, i] = int16(low)


@kernel(void(SEGMENTS, int32[:, ::1], FOG_FACTORS, float64[:, ::1], int16[:, ::1], int64))
def iterate_fog_table(segments, triangles, fog, floats, out, plane):
    """The fog factor into a plane of ``out``: the entry of a table of 8193 at floor(4096 v), v iterated as
    texture coordinates are.

    Measured: all pixels of Fog and Fog_vsh, 5797440 of 5797465 of Fog_gen. With weights of full precision
    over 200 are wrong in a picture of Fog_gen.
    """
    starts, owners, of_vertex, table = segments.starts, segments.owners, fog.coordinates, fog.thresholds
    for s in range(segments.count):
        t = owners[s]
        v1 = of_vertex[triangles[t, 1]]
        d0 = coordinate_difference(of_vertex[triangles[t, 0]], v1)
        d2 = coordinate_difference(of_vertex[triangles[t, 2]], v1)
        for i in range(starts[s], starts[s + 1]):
            value = product_sum(v1, 1.0, floats[R.Q0, i], d0, floats[R.Q2, i], d2)
            step = np.floor(value * 4096.0)
            step = step if step > 0.0 else 0.0  # what is no number too
            out[plane, i] = int16(table[int32(step if step < 8192.0 else 8192.0)])
