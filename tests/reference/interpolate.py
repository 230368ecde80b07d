"""What a fragment takes from its triangle's vertices: 8-bit weights for colors, float64 for the rest."""

import math
from dataclasses import dataclass

from tests.reference import fixed

MOST_WEIGHT = 2.0**16  # Assumed: a limit that no picture reaches
WEIGHT_BITS = 24  # Measured: significant bits of the weights (Depth_buffer, Line_width)
LARGEST_SINGLE = (2.0 - 2.0**-23) * 2.0**127  # Source: IEEE 754
REST_BITS = 25  # Measured: fraction bits that two weights leave one in (Shade_model, W_param)


@dataclass(frozen=True)
class Weights:
    """One fragment's weights.

    ``b0``, ``b2``: float64 barycentric coordinates; ``q0``, ``q2``: with 24 significant bits.
    """

    b0: float
    b2: float
    q0: float
    q2: float


def perspective_terms(n, inverse_w):
    """Edge values times 1/w, or alone where the three 1/w are equal. Source: OpenGL 1.2.1 equation 3.4."""
    if inverse_w[0] == inverse_w[1] == inverse_w[2]:
        return tuple(float(n_i) * 1.0 for n_i in n)
    return tuple(float(n_i) * w for n_i, w in zip(n, inverse_w, strict=True))


def denominator(e):
    """Source: OpenGL 1.2.1 equation 3.4."""
    return (e[0] + e[1]) + e[2]


def residual_vertex(q):
    """The vertex of the highest class, where class counts the reached ones of 1/4 and 1/2.

    Measured: exact ties of the weights (30105600 pixels in 196 captures).
    """
    classes = [(q_i >= 0.5) + (q_i >= 0.25) for q_i in q]
    highest = tuple(i for i in range(3) if classes[i] == max(classes))
    return {(0, 1): 0, (0, 2): 2, (1, 2): 1, (0, 1, 2): 2}.get(highest, highest[0])


def rest_of(a, b):
    """What two weights leave of one: of both the bits below 2^-25 are lost, and 24 bits of the rest are kept.

    Measured: 66 of 77 Shade_model captures, of which 24 bits leave 60 and 26 or more 61; Swath_width.
    """
    whole = 2**REST_BITS - math.trunc(a * 2**REST_BITS) - math.trunc(b * 2**REST_BITS)
    return fixed.keep_significant_bits(whole / 2**REST_BITS, WEIGHT_BITS)


def single_of(inverse_w):
    """A vertex's |w|, the nearest single. Assumed: the largest one for a larger w."""
    return fixed.to_single(min(abs(1.0 / inverse_w), LARGEST_SINGLE))


def weight_factors(inverse_w):
    """What edge values are multiplied with: for each 1/w the product of the others' w, or 1 where they are
    equal. Measured: W_buffering captures, FloorQuad_V0's texels; Assumed: what keeps it above 0.
    """
    if inverse_w[0] == inverse_w[1] == inverse_w[2]:
        return 1.0, 1.0, 1.0
    w = [single_of(v) for v in inverse_w]
    products = w[1] * w[2], w[0] * w[2], w[0] * w[1]
    sizes = [max(fixed.keep_significant_bits(p, WEIGHT_BITS), 2.0**-300) for p in products]
    return tuple(math.copysign(size, v) for size, v in zip(sizes, inverse_w, strict=True))


def weighed_edges(n, factors):
    """Edge values of 24 bits times factors, to 24 bits. Measured: as ``weight_factors``."""
    edges = [fixed.keep_significant_bits(float(n_i), WEIGHT_BITS) for n_i in n]
    return [fixed.keep_significant_bits(a * f, WEIGHT_BITS) for a, f in zip(edges, factors, strict=True)]


def weight_sum(e):
    """What weights are divided by: each cut one bit below the 24 of the largest, the sum to 24.

    Measured: WBuf24F_TriH; FloorQuad_V0.
    """
    exponent = math.frexp(max(2.0**-256, *(abs(e_i) for e_i in e)))[1] - WEIGHT_BITS - 1
    total = sum(math.trunc(math.ldexp(e_i, -exponent)) for e_i in e)
    return fixed.keep_significant_bits(math.ldexp(float(total), exponent), WEIGHT_BITS)


def reciprocal(total):
    """1/total in integers: twelve bits of the reciprocal of fifteen, and one Newton step.

    Measured: 1541 of 1552 sums that show in a picture; halves toward zero, 2 Fog_gen captures and 4 of
    W_param. Inferred: the rounding of the twelve bits.
    """
    fraction, exponent = math.frexp(total)
    m = int(math.ldexp(fraction, WEIGHT_BITS))  # [2^23, 2^24)
    near = (m + 256) >> 9  # [2^14, 2^15]
    x = (2 * 512 * 2**26 + (512 + 2) * near) // (2 * 512 * near)  # 2^26/near, and 1/2 and 2^-9
    rest = 2**35 - m * x
    rest = (abs(rest) + 2**10 - 1 >> 11) * (1 if rest > 0 else -1)
    best = fixed.keep_significant_bits(float(x * (2**24 + rest)), WEIGHT_BITS)
    return math.ldexp(best, -36 + 1 - exponent)


def iteration_weights(n, inverse_w):
    """The weights of vertices 0 and 2, cut to 24 bits; the residual vertex's is what the others leave of one.

    Measured: as colors' weights 153600 of 153600, 28618 of 28618 and 64522 of 64522 pixels; in perspective
    230809 of 230809 (FloorQuad_V0).
    """
    e = weighed_edges(n, weight_factors(inverse_w))
    inverse = reciprocal(weight_sum(e))
    q = [fixed.keep_significant_bits(e_i * inverse, WEIGHT_BITS) for e_i in e]
    residual = residual_vertex(q)
    if residual == 0:
        q[0] = rest_of(q[1], q[2])
    elif residual == 2:
        q[2] = rest_of(q[0], q[1])
    return q[0], q[2]


def weights(n, inverse_w):
    """All weights of a pixel from its edge values. Source: docs/numbers.md section 4."""
    e = perspective_terms(n, inverse_w)
    d = denominator(e)
    inverse = 1.0 / d
    q0, q2 = iteration_weights(n, inverse_w)
    return Weights(e[0] * inverse, e[2] * inverse, q0, q2)


def color_weights(weights, bits=8):
    """Three integers that sum to 2^bits. Measured: as ``iterate_color_channel``; Assumed: at other widths."""
    one = 1 << bits
    w0, w2 = (math.trunc(min(max(one * q, -MOST_WEIGHT), MOST_WEIGHT)) for q in (weights.q0, weights.q2))
    return w0, one - w0 - w2, w2


def iterate_coordinate(v, weights):
    """A texture coordinate from three vertices: the sum of v1 and two products.

    Measured: 48768 of 48768 and 41199 of 41199 pixels (CylinderWrapping, Anisotropy-1).
    """
    d0, d2 = coordinate_difference(v[0], v[1]), coordinate_difference(v[2], v[1])
    return product_sum((v[1], 1.0), (weights.q0, d0), (weights.q2, d2))


def highest(value):
    """The exponent of the highest bit. Source: docs/numbers.md N5.1 (P)."""
    return math.frexp(value)[1] - 1 if value else -10000


def product_sum(*pairs):
    """Three products, cut 23 bits below the largest product of factors' highest bits, added and cut to 24.

    Measured: DotZW 65536 of 65536, ClipPlane; Assumed: terms below 2^-100 of each other and of one are
    nothing, and sums of infinite ones.
    """
    terms = [a * b for a, b in pairs]
    if not all(math.isfinite(term) for term in terms):
        return (terms[0] + terms[1]) + terms[2]  # infinite, or no number
    unit = max(-100, *(highest(a) + highest(b) for a, b in pairs)) - 23
    return kept_sum(sum(math.trunc(math.ldexp(term, -unit)) for term in terms), unit)


def kept_sum(total, unit):
    """24 bits of 2^unit times a whole number. Source: docs/numbers.md N5.1; Assumed: infinite beyond."""
    try:
        return fixed.keep_significant_bits(math.ldexp(float(total), unit), WEIGHT_BITS)
    except OverflowError:
        return math.copysign(math.inf, total)


def coordinate_difference(a, b):
    """Of two vertices: both cut one bit below the larger's 24, and 24 bits of what is left. Measured: DotZW;
    Assumed: as ``product_sum``.
    """
    if not (math.isfinite(a) and math.isfinite(b)):
        return a - b
    unit = max(-100, highest(a), highest(b)) - 24
    return kept_sum(math.trunc(math.ldexp(a, -unit)) - math.trunc(math.ldexp(b, -unit)), unit)


def signed_reciprocal(value):
    """Of a dot product. Measured: DotZW; Assumed: of 0 and of what is infinite or no number."""
    size = abs(value)
    if not 0.0 < size < math.inf:
        return {0.0: math.inf, math.inf: math.copysign(0.0, value)}.get(size, size)
    return math.copysign(reciprocal(size), value)


def cut_sum(*terms):
    """Three terms, each cut to the 24 bits of the largest, and added. Measured: BumpEnvMap."""
    if not all(math.isfinite(term) for term in terms):
        return (terms[0] + terms[1]) + terms[2]  # infinite, or no number
    exponent = math.frexp(max(2.0**-100, *(abs(term) for term in terms)))[1]
    total = sum(math.trunc(math.ldexp(term, WEIGHT_BITS - exponent)) for term in terms)
    return math.ldexp(float(total), exponent - WEIGHT_BITS)


def iterate_color_channel(w, c, bits=8):
    """A color from three vertices' by ``color_weights`` of so many bits, within their least and greatest.

    Measured: 153600 of 153600 pixels; outside a triangle 1082 of 1082 (3D_primitive, Smoothing_control
    captures); Inferred: wider colors have weights as wide.
    """
    total = w[0] * c[0] + w[1] * c[1] + w[2] * c[2]
    return min(max((total + (1 << bits >> 1)) >> bits, min(c)), max(c))


def exact_color_channel(n, inverse_w, c, one=255):
    """A color from three vertices', rounded to nearest; clamped, as a line's edge values may be negative.

    Source: OpenGL 1.2.1 equations 3.4, 3.5; Assumed: the rounding, and the order in perspective.
    """
    if inverse_w[0] == inverse_w[1] == inverse_w[2]:
        area = sum(n)
        nearest = (2 * sum(n_i * c_i for n_i, c_i in zip(n, c, strict=True)) + area) // (2 * area)
        return min(max(nearest, 0), one)
    e = perspective_terms(n, inverse_w)
    total, d = (e[0] * c[0] + e[1] * c[1]) + e[2] * c[2], denominator(e)
    if d == 0:
        return one if total > 0 else 0
    return math.floor(min(max((2.0 * total + d) / (2.0 * d), 0.0), float(one)))


def iterate(v, b0, b2):
    """Any other value from three vertices. Source: OpenGL 1.2.1 equation 3.4, in docs/numbers.md's order."""
    return (v[1] + b0 * (v[0] - v[1])) + b2 * (v[2] - v[1])
