"""Arithmetic on arrays of vectors, in an order of operations that gives the same bits on every processor.

Everything here is elementwise float64 addition, subtraction, multiplication, division and square root, which
IEEE 754 fixes to the last bit. Matrix products and norms of NumPy are avoided: they may fuse or reorder.
Vectors are the last axis, length 3.
"""

import math
from functools import reduce
from operator import add

import numpy as np

# Sines and cosines differ in their last bit between processors and libraries; rounded to a multiple of this
# they do not.  Assumed: 2**-20, far below the 2**-4 pixel that a vertex is snapped to and the 2**-8 of a
# texel.
TRIGONOMETRY_STEP = 2.0**-20


def _rounded(values):
    return np.floor(np.asarray(values) / TRIGONOMETRY_STEP + 0.5) * TRIGONOMETRY_STEP


def cosine(radians):
    """Cosine of an angle or an array of angles, rounded to a multiple of ``TRIGONOMETRY_STEP``."""
    return _rounded(np.cos(radians))


def sine(radians):
    """Sine of an angle or an array of angles, rounded to a multiple of ``TRIGONOMETRY_STEP``."""
    return _rounded(np.sin(radians))


def of_40_bits(values):
    """Values rounded to 40 significant bits: exponentials, tangents and the like have other last bits on
    other computers.
    """
    fraction, exponent = np.frexp(values)
    return np.ldexp(np.rint(fraction * 2.0**40) / 2.0**40, exponent)


def dot(a, b):
    """Dot product over the last axis: ``(ax bx + ay by) + az bz``."""
    a, b = np.asarray(a, np.float64), np.asarray(b, np.float64)
    return (a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]) + a[..., 2] * b[..., 2]


def cross(a, b):
    """Cross product over the last axis."""
    a, b = np.broadcast_arrays(np.asarray(a, np.float64), np.asarray(b, np.float64))
    out = np.empty(a.shape)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[..., k] = a[..., i] * b[..., j] - a[..., j] * b[..., i]
    return out


def normalize(vectors):
    """Vectors of length one; a zero vector stays zero."""
    vectors = np.asarray(vectors, np.float64)
    length = np.sqrt(dot(vectors, vectors))
    return vectors / np.where(length > 0.0, length, 1.0)[..., None]


def in_frame(vectors, tangents, binormals, normals):
    """Coordinates of ``vectors`` in orthonormal frames: (v.t, v.b, v.n)."""
    return np.stack([dot(vectors, tangents), dot(vectors, binormals), dot(vectors, normals)], axis=-1)


def from_frame(coordinates, tangents, binormals, normals):
    """The vectors that have these coordinates in the frames: the inverse of ``in_frame``."""
    c = np.asarray(coordinates, np.float64)
    return (c[..., :1] * tangents + c[..., 1:2] * binormals) + c[..., 2:] * normals


def unit_vector(vector, what):
    """One vector of length one from three numbers.

    Raises ValueError, naming ``what``, when it has not three finite components or is zero.
    """
    out = np.asarray(vector, np.float64)
    if out.shape != (3,) or not np.isfinite(out).all() or not out.any():
        raise ValueError(
            f"{what} is {tuple(np.ravel(out).tolist())}; give three finite numbers, not all zero."
        )
    largest = float(np.abs(out).max())
    return out / largest / math.sqrt(reduce(add, (float(c / largest) ** 2 for c in out)))
