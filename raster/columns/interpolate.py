"""What fragments take from their primitive's vertices, in float64 and int64 columns (docs/numbers.md, 3-7).

``n`` are three edge functions, int64 [k] each; corners of k fragments are [k, 3, ...], vertex 0 first.
"""

from decimal import Decimal, localcontext

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster import float_depths
from fixedpipe.raster.floats import (
    EXPONENT,
    LARGEST_SINGLE,
    LEAST_Q,
    LEAST_SINGLE,
    REST_STEP,
    REST_STEPS,
    SINGLE_BITS,
    SMALLEST,
)
from fixedpipe.raster.floats import keep_significant_bits as cut

WEIGHT_BITS = SINGLE_BITS  # Measured: significant bits of the weights (Depth_buffer, Line_width captures)
FAR = 1 << 20  # a lambda beyond every level


def edge_functions(x, y, px, py, subpixel_bits):
    """(n0, n1, n2), the signed area: x, y int64 [k, 3] in subpixels, px, py int64 [k] pixels (section 3)."""
    step, half = 1 << subpixel_bits, 1 << subpixel_bits >> 1
    x10, x20, y10, y20 = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0], y[:, 1] - y[:, 0], y[:, 2] - y[:, 0]
    dx, dy = step * px + half - x[:, 0], step * py + half - y[:, 0]
    area = x10 * y20 - x20 * y10
    sign = np.where(area < 0, -1, 1)
    n1, n2 = sign * (dx * y20 - x20 * dy), sign * (x10 * dy - dx * y10)
    return (np.abs(area) - n1 - n2, n1, n2), area


def covered_pixels(x, y, w, box, subpixel_bits):
    """The pixels (px, py) that a triangle draws inside ``box`` (x0, y0, x1, y1): section 3, at any width.

    x, y: three whole numbers each, in subpixels; w: of the vertices' w, or 1/w, the signs alone are read.
    """
    step, half = 1 << subpixel_bits, 1 << subpixel_bits >> 1
    left, right = max(box[0], (min(x) - half) // step), min(box[2], (max(x) + half) // step + 1)
    top, bottom = max(box[1], (min(y) - half) // step), min(box[3], (max(y) + half) // step + 1)
    if min(w) < 0.0:  # it goes through infinity
        left, top, right, bottom = box
    empty = np.zeros(0, np.int64)
    if left >= right or top >= bottom:
        return empty, empty
    py, px = (g.ravel() for g in np.mgrid[top:bottom, left:right])
    n, area = edge_functions(np.array([x]), np.array([y]), px, py, subpixel_bits)
    if area[0] == 0:
        return empty, empty
    order = ((1, 2), (2, 0), (0, 1)) if area[0] > 0 else ((2, 1), (0, 2), (1, 0))
    inside = np.ones(len(px), bool)
    for n_i, (a, b), w_i in zip(n, order, w, strict=True):
        if w_i < 0.0:
            n_i, a, b = -n_i, b, a
        owned = y[b] < y[a] or (y[b] == y[a] and x[b] > x[a])
        inside &= (n_i >= 0) if owned else (n_i > 0)
    return px[inside], py[inside]


def along_lines(x, y, px, py, steps, subpixel_bits):
    """(n0, 0, n2) of lines whose rows are (b, a, a) (section 11). ``steps``: one pixel for each step."""
    step, half = 1 << subpixel_bits, 1 << subpixel_bits >> 1
    sx, sy = step * px + half, step * py + half
    dx, dy = x[:, 0] - x[:, 1], y[:, 0] - y[:, 1]
    if not steps:
        n0 = (sx - x[:, 1]) * dx + (sy - y[:, 1]) * dy
        length = dx * dx + dy * dy
    else:
        across = np.abs(dx) >= np.abs(dy)
        forward = np.where(np.where(across, dx, dy) > 0, 1, -1)
        n0 = forward * np.where(across, sx - x[:, 1], sy - y[:, 1]) + half
        length = np.maximum(np.abs(dx), np.abs(dy))
    return n0, np.zeros_like(n0), length - n0


def _as_diamonds(x, y, beside):
    """A line's direction, whether it is x-major, and its start moved by ``beside`` subpixels: half of what is
    beside one pixel's width, down or left. Source: OpenGL 1.2.1 section 3.4.2.
    """
    dx, dy = x[:, 0] - x[:, 1], y[:, 0] - y[:, 1]
    across = np.abs(dx) >= np.abs(dy)
    return (
        dx,
        dy,
        across,
        np.where(across, x[:, 1], x[:, 1] - beside),
        np.where(across, y[:, 1] + beside, y[:, 1]),
    )


def along_diamonds(x, y, px, py, width, subpixel_bits):
    """(n0, 0, n2) of lines of ``width`` pixels on machines with diamonds (section 11, equation 3.1)."""
    step, half = 1 << subpixel_bits, 1 << subpixel_bits >> 1
    dx, dy, _, x1, y1 = _as_diamonds(x, y, half * (width - 1))
    n0 = (step * px + half - x1) * dx + (step * py + half - y1) * dy
    return n0, np.zeros_like(n0), dx * dx + dy * dy - n0


def repeated_pixels(x, y, px, py, width, subpixel_bits):
    """The pixel (px, py) whose values a wide line's pixel repeats: the lowest of its column, or the leftmost
    of its row (section 11).
    """
    step, half = 1 << subpixel_bits, 1 << subpixel_bits >> 1
    dx, dy, across, x1, y1 = _as_diamonds(x, y, half * (width - 1))
    rise = np.where(dx > 0, dy, -dy)
    low = (y1 * np.abs(dx) + (px * step + half - x1) * rise - (rise < 0)) // (
        step * np.maximum(np.abs(dx), 1)
    )
    lean = np.where(dy > 0, dx, -dx)
    left = (x1 * np.abs(dy) + (py * step + half - y1) * lean - 1) // (step * np.maximum(np.abs(dy), 1))
    return np.where(across, px, left), np.where(across, low, py)


def perspective_terms(n, inverse_w):
    """e0, e1, e2: edge functions times 1/w, or alone where the three are equal. ``inverse_w`` [k, 3]."""
    equal = (inverse_w[:, 0] == inverse_w[:, 1]) & (inverse_w[:, 1] == inverse_w[:, 2])
    return tuple(n_i.astype(np.float64) * np.where(equal, 1.0, inverse_w[:, i]) for i, n_i in enumerate(n))


def full_weights(e):
    """b0 and b2 in full precision, and where their sum is positive."""
    total = (e[0] + e[1]) + e[2]
    inverse = 1.0 / total
    return e[0] * inverse, e[2] * inverse, total > 0.0


def rest_of(a, b):
    """What two weights leave of one: of both the bits from 2**-26 on are lost; the rest keeps 24."""
    rest = (1.0 - np.trunc(a * REST_STEPS) * REST_STEP) - np.trunc(b * REST_STEPS) * REST_STEP
    return cut(rest, WEIGHT_BITS)


def weight_factors(inverse_w):
    """What edge functions are multiplied with, float64 [k, 3]: for each vertex's 1/w the product of the
    others' w, singles, with the sign of w; 1 where the three are equal. Assumed: at least 2^-300.
    """
    with np.errstate(over="ignore"):
        singles = np.abs(1.0 / inverse_w).astype(np.float32).astype(np.float64)
    w = np.minimum(singles, LARGEST_SINGLE)
    others = np.stack([w[:, 1] * w[:, 2], w[:, 0] * w[:, 2], w[:, 0] * w[:, 1]], axis=1)
    factors = np.copysign(np.maximum(cut(others, WEIGHT_BITS), 2.0**-300), inverse_w)
    equal = (inverse_w[:, 0] == inverse_w[:, 1]) & (inverse_w[:, 1] == inverse_w[:, 2])
    return np.where(equal[:, None], 1.0, factors)


def weighed_edges(n, inverse_w):
    """Edge functions by their factors, three float64 [k] of 24 bits, and their sum: each of them cut one bit
    below the 24 of the largest, and the sum to 24.
    """
    factors = weight_factors(inverse_w)
    e = [
        cut(cut(n_i.astype(np.float64), WEIGHT_BITS) * factors[:, i], WEIGHT_BITS) for i, n_i in enumerate(n)
    ]
    largest = np.maximum(np.maximum(np.abs(e[0]), np.abs(e[1])), np.maximum(np.abs(e[2]), 2.0**-256))
    shift = WEIGHT_BITS + 1 - np.frexp(largest)[1]
    total = sum(np.trunc(np.ldexp(e_i, shift)) for e_i in e)
    return e, cut(np.ldexp(total, -shift), WEIGHT_BITS)


def reciprocal_24(total):
    """1/total of positive totals in 24 significant bits: twelve bits of the reciprocal of the first fifteen,
    rounded at a half less 2^-9, then a Newton step whose remainder is rounded to 2^-24, halves toward zero
    (docs/numbers.md, N4.10).
    """
    half, exponent = np.frexp(total)
    near = np.floor(half * 2.0**15 + 0.5) / 2.0**15
    x = np.floor(2048.0 / near + (0.5 + 2.0**-9)) / 4096.0  # in [1/2, 1]
    rest = (1.0 - 2.0 * half * x) * 2.0**24
    rest = np.copysign(np.ceil(np.abs(rest) - 0.5), rest) / 2.0**24
    return np.ldexp(cut(x + x * rest, WEIGHT_BITS), 1 - exponent)


def signed_reciprocal(value):
    """``reciprocal_24`` of numbers of any sign: of 0 infinity, of infinity 0, and NaN stays."""
    size = np.abs(value)
    ordinary = (size > 0.0) & (size < np.inf)
    special = np.where(size == 0.0, np.inf, np.where(size == np.inf, 0.0, size))
    result = np.where(ordinary, reciprocal_24(np.where(ordinary, size, 1.0)), special)
    return np.where(value >= 0.0, result, 0.0 - result)


def iteration_weights(n, inverse_w):
    """q0 and q2 with 24 significant bits; the vertex of the highest class takes what the others leave."""
    e, total = weighed_edges(n, inverse_w)
    # Beyond a line's end the sum may be negative.
    reciprocal = signed_reciprocal(np.where(total == 0.0, 1.0, total))
    return _largest_rests([cut(e_i * reciprocal, WEIGHT_BITS) for e_i in e])


def _largest_rests(q):
    """q0 and q2, of which the vertex of the highest class takes what the others leave."""
    q0, q1, q2 = q
    c0, c1, c2 = ((q >= 0.5).astype(np.int64) + (q >= 0.25) for q in (q0, q1, q2))
    first = (c0 >= c1) & (c0 > c2)
    last = (c2 >= c0) & ((c2 > c1) | ((c2 == c1) & (c0 == c1)))
    return np.where(first, rest_of(q1, q2), q0), np.where(last, rest_of(q0, q1), q2)


MOST_WEIGHT = 2.0**16  # of colours, outside their triangle. Assumed; no picture reaches it


def _weight(q):
    """Weights cut toward zero, int64. Measured: outside triangles (3D_primitive Triangles-ps capture)."""
    return np.trunc(np.clip(q, -MOST_WEIGHT, MOST_WEIGHT)).astype(np.int64)


def iterate_colors(q0, q2, corners, bits):
    """Colours [k, c] of corners int64 [k, 3, c] by weights of ``bits`` bits: section 4, with 8 bits there;
    within the corners' least and greatest, which only a pixel outside its triangle would leave.

    Inferred: wider colours have weights as wide.
    """
    w0, w2 = (_weight((1 << bits) * q)[:, None] for q in (q0, q2))
    w1 = (1 << bits) - w0 - w2
    total = w0 * corners[:, 0] + w1 * corners[:, 1] + w2 * corners[:, 2]
    return np.clip((total + (1 << bits >> 1)) >> bits, corners.min(1), corners.max(1))


def iterate_exact_colors(e, corners, low, high):
    """Colours [k, c] of corners int64 [k, 3, c] rounded to nearest, within low..high (section 4, EXACT)."""
    e0, e1, e2 = (e_i[:, None] for e_i in e)
    c = corners.astype(np.float64)
    total, whole = (e0 * c[:, 0] + e1 * c[:, 1]) + e2 * c[:, 2], (e0 + e1) + e2
    value = np.floor((2.0 * total + whole) / (2.0 * whole))
    return np.clip(np.where(np.isnan(value), 0.0, value), low, high).astype(np.int64)


def iterate(b0, b2, corners):
    """Any other value: ``(v1 + b0 (v0 - v1)) + b2 (v2 - v1)`` of corners float64 [k, 3, ...]."""
    shape = (-1,) + (1,) * (corners.ndim - 2)
    v1 = corners[:, 1]
    return (v1 + b0.reshape(shape) * (corners[:, 0] - v1)) + b2.reshape(shape) * (corners[:, 2] - v1)


def iterate_coordinates(q0, q2, corners):
    """Texture coordinates of corners float64 [k, 3, 4]: the ``product_sum`` of v1, q0 (v0 - v1) and
    q2 (v2 - v1); and the unit that these are cut to, float64 [k, 4].

    Measured: 48768 of 48768 and 41199 of 41199 pixels (CylinderWrapping, Anisotropy-1).
    """
    v1 = corners[:, 1]
    d0, d2 = (coordinate_difference(corners[:, i], v1) for i in (0, 2))
    return product_sum((v1, 1.0), (q0[:, None], d0), (q2[:, None], d2))


def _bound(*values):
    """The exponent of the highest bit, which a zero has nowhere."""
    exponents = [np.where(v == 0.0, -(1 << 20), np.frexp(v)[1] - 1) for v in values]
    return sum(exponents)


def product_sum(*pairs):
    """The sum of three products to 24 bits, and the unit that they are cut to, toward zero: 2^-23 of the
    largest product of two factors' highest bits.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        terms = [a * b for a, b in pairs]
    finite = np.isfinite(terms[0]) & np.isfinite(terms[1]) & np.isfinite(terms[2])
    bounds = [np.where(finite, _bound(a, b), 0) for a, b in pairs]
    exponent = np.maximum(np.maximum(np.maximum(*bounds[:2]), bounds[2]), np.frexp(SMALLEST)[1] - 1)
    shift = WEIGHT_BITS - 1 - exponent
    total = sum(np.trunc(np.ldexp(np.where(finite, term, 0.0), shift)) for term in terms)
    with np.errstate(over="ignore"):
        result = cut(np.ldexp(total, -shift), WEIGHT_BITS)
    return np.where(finite, result, np.nan), np.ldexp(1.0, -shift)


def coordinate_difference(a, b):
    """a - b of vertices' coordinates to 24 bits: both are cut one bit below the 24 of the larger."""
    finite = np.isfinite(a) & np.isfinite(b)
    largest = np.maximum(np.maximum(np.abs(a), np.abs(b)), SMALLEST)
    shift = WEIGHT_BITS + 1 - np.frexp(np.where(finite, largest, 1.0))[1]
    parts = [np.trunc(np.ldexp(np.where(finite, v, 0.0), shift)) for v in (a, b)]
    with np.errstate(over="ignore", invalid="ignore"):
        return np.where(finite, cut(np.ldexp(parts[0] - parts[1], -shift), WEIGHT_BITS), a - b)


def cut_sum(*terms):
    """The sum of three terms, each cut to the 24 bits of the largest, and the unit that they are cut to."""
    finite = np.isfinite(terms[0]) & np.isfinite(terms[1]) & np.isfinite(terms[2])
    largest = np.maximum(np.maximum(np.abs(terms[0]), np.abs(terms[1])), np.abs(terms[2]))
    exponent = np.frexp(np.maximum(np.where(finite, largest, 1.0), SMALLEST))[1]
    total = sum(np.trunc(np.ldexp(np.where(finite, term, 0.0), WEIGHT_BITS - exponent)) for term in terms)
    unit = np.ldexp(1.0, exponent - WEIGHT_BITS)
    return np.where(finite, total * unit, np.nan), unit


# ------------------------------------------------------------------------------------------------- depth


def _reciprocal_29(total):
    """1/total, cut to 29 significant bits before and after: fourteen bits to nearest, halves up, then a
    Newton step whose remainder is rounded to 2^-30, halves toward zero (docs/numbers.md, N5.2).
    """
    total = cut(total, 29)
    half, exponent = np.frexp(1.0 / total)
    seed = np.ldexp(np.floor(half * 2.0**14 + 0.5), exponent - 14)
    rest = (1.0 - total * seed) * 2.0**30
    rest = np.copysign(np.ceil(np.abs(rest) - 0.5), rest) / 2.0**30
    return cut(seed + seed * rest, 29)


def depth_difference(a, b):
    """a - b of depths to 24 significant bits; 0 below a single's smallest normal number."""
    difference = cut(a - b, WEIGHT_BITS)
    return np.where(np.abs(difference) < LEAST_SINGLE, 0.0, difference)


def _depth_sum(middle, products):
    """A vertex's depth and two products, cut 29 bits below the largest's highest, to 24 bits."""
    largest = np.maximum(np.abs(middle), np.maximum(np.abs(products[0]), np.abs(products[1])))
    some = largest > 0.0
    exponent = np.frexp(np.where(some, largest, 1.0))[1] - 29
    first, second = (np.ldexp(np.trunc(np.ldexp(p, -exponent)), exponent) for p in products)
    return cut(np.where(some, (middle + first) + second, 0.0), WEIGHT_BITS)


def iterate_w(q0, q2, w):
    """Depths of fragments in W buffering, float64 [k]; ``w`` float64 [k, 3], singles (section 5)."""
    products = q0 * depth_difference(w[:, 0], w[:, 1]), q2 * depth_difference(w[:, 2], w[:, 1])
    return _depth_sum(w[:, 1], products)


def iterate_depth(n, depths):
    """Depths of fragments before offset and limits, float64 [k]; ``depths`` [k, 3], singles (section 5)."""
    e = [cut(n_i.astype(np.float64), WEIGHT_BITS) for n_i in n]
    reciprocal = _reciprocal_29((e[0] + e[1]) + e[2])
    q = np.stack([cut(e_i * reciprocal, WEIGHT_BITS) for e_i in e], axis=1)
    exponents = [np.ascontiguousarray(e_i).view(np.int64) & EXPONENT for e_i in e]
    base = np.where(exponents[0] > exponents[1], 0, 1)
    base = np.where(exponents[2] > np.maximum(exponents[0], exponents[1]), 2, base)
    rows = np.arange(len(base))
    middle = depths[rows, base]
    products = []
    for other in (np.where(base == 0, 1, 0), np.where(base == 2, 1, 2)):
        products.append(q[rows, other] * depth_difference(depths[rows, other], middle))
    return _depth_sum(middle, products)


def depth_words(depth, low, high, farthest, form):
    """(int64 [k] words of a depth buffer, bool [k]: inside the limits).

    ``form``: a FloatDepth; None: the format is fixed.
    """
    inside = ~((depth < low) | (depth > high))
    depth = np.minimum(np.maximum(np.minimum(np.maximum(depth, low), high), 0.0), farthest)
    if form is None:
        return np.floor(depth).astype(np.int64), inside
    words = float_depths.words(depth, form)
    return np.where(words >= 1 << form.fraction_bits, np.minimum(words, form.largest), 0), inside


def depth_slope(x, y, area, values, factor, subpixel_bits):
    """The polygon offset's ``factor * max(|dv/dx|, |dv/dy|)``, float64 [k]; 0 where the area is.

    x, y int64 [k, 3] subpixels; values float64 [k, 3]: depths.
    """
    d1, d2 = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    x1, x2, y1, y2 = ((c[:, i] - c[:, 0]).astype(np.float64) for c in (x, y) for i in (1, 2))
    scale, none = float(1 << subpixel_bits), area == 0
    divisor = np.where(none, 1, area).astype(np.float64)
    along_x, along_y = (d1 * y2 - d2 * y1) * scale / divisor, (d2 * x1 - d1 * x2) * scale / divisor
    return np.where(none, 0.0, factor * np.maximum(np.abs(along_x), np.abs(along_y)))


# --------------------------------------------------------------------------------------- level of detail


def _octave():
    """2**(k / 128), k = 0..127, each the nearest float64."""
    with localcontext() as context:
        context.prec = 40
        return np.array([float((Decimal(k) * Decimal(2).ln() / 128).exp()) for k in range(128)])


_OCTAVE = _octave()


def log2_q7(values):
    """``floor(128 log2 x)`` of positive finite float64, int64."""
    mantissa, exponent = np.frexp(values)
    return 128 * (exponent.astype(np.int64) - 1) + np.searchsorted(_OCTAVE, 2.0 * mantissa, side="right") - 1


def major_axis(strq):
    """The face of each direction [k, 4]: the largest magnitude, x before y before z."""
    s, t, r = (np.abs(strq[:, i]) for i in range(3))
    axis = np.where((s >= t) & (s >= r), 0, np.where(t >= r, 1, 2))
    return 2 * axis + ~(strq[np.arange(len(axis)), axis] >= 0.0)


# sc, tc and ma of the faces in the order of their codes: component and sign. Source: EXT_texture_cube_map.
_SC, _SC_SIGN = np.array([2, 2, 0, 0, 0, 0]), np.array([-1.0, 1.0, 1.0, 1.0, 1.0, -1.0])
_TC, _TC_SIGN = np.array([1, 1, 2, 2, 1, 1]), np.array([-1.0, -1.0, 1.0, -1.0, -1.0, -1.0])
_MA, _MA_SIGN = np.array([0, 0, 1, 1, 2, 2]), np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])


def on_face(strq, face):
    """(sc, tc, ma) of directions [k, 3 or 4] on faces [k]; ma <= 0 where the face is not the major one."""
    rows = np.arange(len(face))
    return tuple(
        sign[face] * strq[rows, component[face]]
        for component, sign in ((_SC, _SC_SIGN), (_TC, _TC_SIGN), (_MA, _MA_SIGN))
    )


def _divisors(strq):
    """q, and LEAST_Q where it is 0, [k, 1]."""
    return np.where(strq[:, 3:] == 0.0, LEAST_Q, strq[:, 3:])


def divide_by_q(strq):
    """s, t, r over q, each quotient rounded once: what lambda and real numbers take."""
    return strq[:, :3] / _divisors(strq)


def times_reciprocal_of_q(strq):
    """s, t, r over q as the chip makes them for a texture's access: N4.10's reciprocal and products of 24
    bits (docs/numbers.md, N6.1).
    """
    fraction, exponent = np.frexp(_divisors(strq))
    return np.ldexp(cut(strq[:, :3] * signed_reciprocal(fraction), SINGLE_BITS), -exponent)


def block_steps(edges, inverse_w, corners, divided, target, sizes, px, py):
    """Steps of (s, t, r), in texels of level 0, from each fragment's 2x2 block to its right and its lower
    neighbour, float64 [k, 3] each, the same in coordinates, and where there are none.

    ``edges(px, py)`` gives (n0, n1, n2); ``sizes``: what s, t and r are multiplied by.
    """
    bx, by = px & ~1, py & ~1
    points, good, face = [], np.ones(len(px), bool), None
    for dx, dy in ((0, 0), (1, 0), (0, 1)):
        b0, b2, positive = full_weights(perspective_terms(edges(bx + dx, by + dy), inverse_w))
        good &= positive
        strq = iterate(b0, b2, corners)
        if target == C.TARGET_CUBE_MAP:
            face = major_axis(strq) if face is None else face
            sc, tc, major = on_face(strq, face)
            good &= major > 0.0
            half = 0.5 * sizes[0]
            points.append(np.stack([(sc / major + 1.0) * half, (tc / major + 1.0) * half, 0.0 * sc], axis=1))
        else:
            points.append(divide_by_q(strq) if divided else strq[:, :3])
    plain = [p - points[0] for p in points[1:]]
    if target == C.TARGET_CUBE_MAP:
        return plain, plain, ~good
    scaled = [p * np.array(sizes) for p in points]
    return [p - scaled[0] for p in scaled[1:]], plain, ~good


def level_of_detail(steps, missing, target):
    """Lambda with 8 fraction bits, int64 [k], without bias (section 7)."""
    squares = []
    for step in steps:
        square = step[:, 0] * step[:, 0] + (0.0 if target == C.TARGET_1D else step[:, 1] * step[:, 1])
        squares.append(square + step[:, 2] * step[:, 2] if target == C.TARGET_3D else square)
    finite = (squares[0] < np.inf) & (squares[1] < np.inf) & ~missing
    rho2 = np.maximum(squares[0], squares[1])
    some = finite & (rho2 > 0.0)
    return np.where(some, log2_q7(np.where(some, rho2, 1.0)), np.where(finite, -FAR, FAR))


def anisotropy(plain, sizes, missing, maximum):
    """(along s, along t, ratio) [k, 3] of the longer side of each block's footprint and lambda of a part of
    it, int64 [k] (section 7).
    """
    scaled = [p[:, :2] * np.array(sizes[:2]) for p in plain]
    dx2, dy2 = (s[:, 0] * s[:, 0] + s[:, 1] * s[:, 1] for s in scaled)
    bad = missing | ~((dx2 < np.inf) & (dy2 < np.inf))
    longer, shorter = np.maximum(dx2, dy2), np.minimum(dx2, dy2)
    ratio = np.sqrt(longer) / np.maximum(np.sqrt(shorter), 1.0)
    ratio = np.minimum(np.maximum(ratio, 1.0), maximum)
    along = np.where((dx2 >= dy2)[:, None], plain[0][:, :2], plain[1][:, :2])
    rho2 = longer / (ratio * ratio)
    some = ~bad & (rho2 > 0.0)
    lod = np.where(some, log2_q7(np.where(some, rho2, 1.0)), np.where(bad, FAR, -FAR))
    out = np.concatenate([along, ratio[:, None]], axis=1)
    return np.where(bad[:, None], np.array([0.0, 0.0, 1.0]), out), lod


def probes_along(longer, shorter, most, exact):
    """(how many probes, rho squared of each) of footprints with these squared sides in texels (section 7).
    ``exact``: as many as cover it; else a power of two.
    """
    narrow, number = np.maximum(shorter, 1.0), np.ones(len(longer))
    while True:
        more = longer > number * number * narrow if exact else longer >= 2.0 * number * number * narrow
        grows = more & (number < most)
        if not grows.any():
            break
        number = np.where(grows, number + 1.0 if exact else 2.0 * number, number)
    return number, np.where(more, longer / (number * number), np.maximum(shorter, np.minimum(longer, 1.0)))


def probes(plain, sizes, missing, most, exact):
    """(along s, along t, probes) [k, 3] of each block's footprint and lambda of a probe, int64 [k], for
    footprint assembly (section 7); ``most``, ``exact``: as of ``probes_along``.
    """
    scaled = [p[:, :2] * np.array(sizes[:2]) for p in plain]
    dx2, dy2 = (s[:, 0] * s[:, 0] + s[:, 1] * s[:, 1] for s in scaled)
    bad = missing | ~((dx2 < np.inf) & (dy2 < np.inf))
    dx2, dy2 = (np.where(bad, 0.0, square) for square in (dx2, dy2))
    number, rho2 = probes_along(np.maximum(dx2, dy2), np.minimum(dx2, dy2), most, exact)
    along = np.where((dx2 >= dy2)[:, None], plain[0][:, :2], plain[1][:, :2])
    some = ~bad & (rho2 > 0.0)
    lod = np.where(some, log2_q7(np.where(some, rho2, 1.0)), np.where(bad, FAR, -FAR))
    out = np.concatenate([along, number[:, None]], axis=1)
    return np.where(bad[:, None], np.array([0.0, 0.0, 1.0]), out), lod
