"""What the suites' vertex programs compute, as a mesh's positions for VertexStage.PROGRAM_RESULTS.

Measured: the chip's vertex arithmetic rounds toward zero (Shade_model Prog captures: with it all pixels, with
exact arithmetic up to 20 differ: a vertex in the middle of the screen lands just beside it).
"""

import numpy as np

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.conformance.processor_matrices import inverse, times
from fixedpipe.effects.conformance.processor_matrices import product as product_of
from fixedpipe.effects.conformance.scenes import single
from fixedpipe.pipeline.vertices.chip_floats import (
    TRANSFORM_BITS,
    product,
    total,
    transform_dot,
    transform_inverse_root,
)

EYE_DISTANCE, NEAR, FAR = 7.0, 1.0, 200.0


def toward_zero(values):
    """Round float64 to single precision, toward zero."""
    values = np.asarray(values, np.float64)
    nearest = values.astype(np.float32)
    lower = np.nextafter(nearest, np.float32(0))
    return np.where(np.abs(nearest) > np.abs(values), lower, nearest).astype(np.float64)


def perspective(points, depth_maximum=16777215.0, eye=EYE_DISTANCE, far=FAR, offset=0.0):
    """Window positions [n, 4] (device x and y, depth units, w) of ``points`` [n, 3] in the default view.

    The default view: 45 degrees, 4:3, the eye at z = -7; ``eye`` and ``far`` say otherwise. Source:
    PerspectiveVertexShader: the view matrix, then projection and viewport as one matrix, then a division by
    w. ``offset``: the chip's viewport offset, pixels, which it adds to what a program computes too. Measured:
    609515 of 609518 pixels with the XDK's 17/32, 567298 without (Depth_Clamp VSH1 captures).
    """
    x, y, z = single(points).T
    y_scale = single(1.0 / np.tan(single(np.pi / 8)))
    x_scale = single(y_scale / single(WIDTH / HEIGHT))
    depth_scale = single(single(far / (far - NEAR)) * depth_maximum)
    w = toward_zero(z + eye)
    reciprocal = toward_zero(1.0 / w)
    window = (
        toward_zero(toward_zero(x * single(x_scale * WIDTH / 2)) + toward_zero(w * (WIDTH / 2))),
        toward_zero(toward_zero(y * -single(y_scale * HEIGHT / 2)) + toward_zero(w * (HEIGHT / 2))),
        toward_zero(toward_zero(w * depth_scale) - toward_zero(NEAR * depth_scale)),
    )
    x, y, z = (toward_zero(v * reciprocal) for v in window)
    return np.stack([toward_zero(x + offset), toward_zero(y + offset), z, w], axis=1)


# ------------------------------------------------------------------------------------------- projection


def _unprojection(z_maximum=16777215.0):
    """The inverse of the default view's matrix for row vectors, in single precision and by cofactors.

    The viewport's depth range is -1 to 1 there. Source: CalculateViewportMatrix of ProjectionVertexShader.
    """
    f = np.float32
    y_scale = f(1) / f(np.tan(f(np.pi / 8)))
    depth = f(FAR) / (f(FAR) - f(NEAR))
    projection, viewport, view = np.zeros((4, 4), f), np.eye(4, dtype=f), np.eye(4, dtype=f)
    projection[0, 0], projection[1, 1] = y_scale / f(WIDTH / HEIGHT), y_scale
    projection[2, 2:] = depth, 1
    projection[3, 2] = -depth * f(NEAR)
    viewport[0, 0], viewport[1, 1], viewport[2, 2] = WIDTH / 2, -HEIGHT / 2, f(z_maximum) / f(2)
    viewport[3, :3] = WIDTH / 2, HEIGHT / 2, f(z_maximum) / f(2)
    view[3, 2] = EYE_DISTANCE
    return inverse(product_of(view, product_of(projection, viewport)))


def unproject(x, y, z):
    """World position [3] of a device pixel at the depth ``z``, in depth units."""
    world = times((x, y, z, 1), _unprojection())
    return (world[:3] / world[3]).astype(np.float64)


# ------------------------------------------------------------------------------------------ instructions

# Slopes of 32 pieces of 2^x and of log2(x); the pieces' starts follow. Source: envytools (nvhw/xf.c).
EXPONENTIAL_SLOPES = (
    359, 366, 375, 383, 391, 400, 409, 417, 427, 436, 445, 455, 466, 475, 486, 497,
    507, 518, 530, 542, 553, 565, 578, 591, 603, 617, 629, 645, 657, 673, 689, 699,
)  # fmt: skip
LOGARITHM_SLOPES = (
    11702, 11271, 10966, 10650, 10361, 10106, 9800, 9574, 9337, 9112, 8898, 8693, 8499, 8310, 8133, 7962,
    7796, 7641, 7488, 7343, 7202, 7070, 6939, 6814, 6692, 6578, 6464, 6356, 6251, 6147, 6058, 5930,
)  # fmt: skip


def dp3(a, b):
    """DP3 of two vectors of three columns."""
    return transform_dot(a, b)


def mul(a, b):
    """MUL of two columns."""
    return product(a, b, TRANSFORM_BITS)


def add(a, b):
    """ADD of two columns."""
    return total((a, b), TRANSFORM_BITS)


def normalized(v):
    """DP3, RSQ and MUL: a vector of three columns made a unit vector."""
    root = transform_inverse_root(dp3(v, v))
    return [mul(c, root) for c in v]


def lit_power(base, exponent):
    """LIT's z for base columns > 0 and an exponent from 0 to 127: 2^(exponent log2(base)), by two tables."""
    mantissa, power = np.frexp(np.where(base > 0, base, 1.0))
    fraction = np.ldexp(mantissa, 24).astype(np.int64) - (1 << 23)
    piece, rest = fraction >> 18, fraction >> 10 & 255
    starts = np.concatenate([[0], np.cumsum(LOGARITHM_SLOPES)])
    logarithm = starts[piece] * 256 + np.array(LOGARITHM_SLOPES)[piece] * rest + ((power - 1) << 26)
    scaled = logarithm * int(exponent * 8192) >> 26
    piece, rest = scaled >> 8 & 31, scaled & 255
    starts = np.concatenate([[0], np.cumsum(EXPONENTIAL_SLOPES)])
    fraction = starts[piece] * 256 + np.array(EXPONENTIAL_SLOPES)[piece] * rest
    return np.where(base > 0, np.ldexp((fraction << 1) + (1 << 23), (scaled >> 13) - 23), 0.0)
