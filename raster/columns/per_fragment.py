"""Per-fragment operations at any width (docs/numbers.md, section 10), on int64 columns.

Colours are [k, 4] in units of the buffer's value of one. A function that writes takes fragments of distinct
pixels.
"""

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster.columns.numbers import INTEGERS

FAR = 1 << 30  # how far a colour reaches where blending does not clamp


def compare(function, a, b):
    """``a FUNC b``, elementwise: the function has a bit each for less, equal and greater."""
    found = np.zeros(np.broadcast(a, b).shape, bool)
    if function & C.COMPARISON_LESS:
        found |= a < b
    if function & C.COMPARISON_EQUAL:
        found |= a == b
    if function & C.COMPARISON_GREATER:
        found |= a > b
    return found


def stencil_result(operation, stored, reference):
    """A stencil operation on 8-bit values. Source: OpenGL 1.2.1 section 4.1.4 and EXT_stencil_wrap."""
    if operation == C.STENCIL_KEEP:
        return stored
    if operation in (C.STENCIL_ZERO, C.STENCIL_REPLACE):
        return np.full_like(stored, reference if operation == C.STENCIL_REPLACE else 0)
    if operation == C.STENCIL_INVERT:
        return 255 - stored
    if operation in (C.STENCIL_INCR, C.STENCIL_DECR):
        return np.clip(stored + (1 if operation == C.STENCIL_INCR else -1), 0, 255)
    if operation in (C.STENCIL_INCR_WRAP, C.STENCIL_DECR_WRAP):
        return (stored + (1 if operation == C.STENCIL_INCR_WRAP else -1)) & 255
    raise ValueError(f"{operation!r} is no stencil operation.")


# The factors that are one minus another.
_ONE_MINUS = {
    C.FACTOR_ONE: C.FACTOR_ZERO,
    C.FACTOR_ONE_MINUS_SRC_COLOR: C.FACTOR_SRC_COLOR,
    C.FACTOR_ONE_MINUS_DST_COLOR: C.FACTOR_DST_COLOR,
    C.FACTOR_ONE_MINUS_SRC_ALPHA: C.FACTOR_SRC_ALPHA,
    C.FACTOR_ONE_MINUS_DST_ALPHA: C.FACTOR_DST_ALPHA,
    C.FACTOR_ONE_MINUS_CONSTANT_COLOR: C.FACTOR_CONSTANT_COLOR,
    C.FACTOR_ONE_MINUS_CONSTANT_ALPHA: C.FACTOR_CONSTANT_ALPHA,
}


def blend_factor(factor, source, destination, constant, one):
    """A factor of tables 4.1 and 4.2, broadcastable to [k, 4]."""
    if factor in _ONE_MINUS:
        return one - blend_factor(_ONE_MINUS[factor], source, destination, constant, one)
    if factor == C.FACTOR_ZERO:
        return np.zeros((1, 4), np.int64)
    if factor == C.FACTOR_SRC_COLOR:
        return source
    if factor == C.FACTOR_DST_COLOR:
        return destination
    if factor == C.FACTOR_SRC_ALPHA:
        return source[:, 3:]
    if factor == C.FACTOR_DST_ALPHA:
        return destination[:, 3:]
    if factor == C.FACTOR_CONSTANT_COLOR:
        return constant[None]
    if factor == C.FACTOR_CONSTANT_ALPHA:
        return constant[None, 3:]
    if factor == C.FACTOR_SRC_ALPHA_SATURATE:
        room = np.minimum(source[:, 3:], one - destination[:, 3:])
        return np.concatenate([room, room, room, np.full_like(room, one)], axis=1)
    raise ValueError(f"{factor!r} is no blend factor.")


def blend(equation, factors, source, destination, constant, bits, numbers=INTEGERS):
    """Two colours [k, 4] blended, not clamped (section 4.1.6); ``factors``: source's, destination's. Reals
    whose one is 1.0 have ``bits`` = 1.
    """
    one = (1 << bits) - 1
    if equation == C.EQUATION_MIN:
        return np.minimum(source, destination)
    if equation == C.EQUATION_MAX:
        return np.maximum(source, destination)
    if equation in (C.EQUATION_FUNC_ADD_SIGNED, C.EQUATION_FUNC_REVERSE_SUBTRACT_SIGNED):
        signed = np.where(source >= 1 << (bits - 1), source - (1 << bits), source)
        return destination + signed if equation == C.EQUATION_FUNC_ADD_SIGNED else destination - signed
    s = source * blend_factor(factors[0], source, destination, constant, one)
    d = destination * blend_factor(factors[1], source, destination, constant, one)
    if equation == C.EQUATION_FUNC_ADD:
        return numbers.quotient(s + d, one)
    if equation == C.EQUATION_FUNC_SUBTRACT:
        return numbers.quotient(s - d, one)
    if equation == C.EQUATION_FUNC_REVERSE_SUBTRACT:
        return numbers.quotient(d - s, one)
    raise ValueError(f"{equation!r} is no blend equation.")


def logic(operation, s, d, one):
    """Table 4.3 on the values' bits."""
    result = np.zeros_like(d)
    for bit, minterm in enumerate((s & d, s & ~d, ~s & d, ~s & ~d)):
        if operation >> bit & 1:
            result |= minterm
    return result & one


def in_order(pixel):
    """Index arrays of fragments that can be written at once: at most one fragment of a pixel in each.

    The first holds every pixel's first fragment, the second every pixel's second, and so on.
    """
    by_pixel = np.argsort(pixel, kind="stable")
    position = np.arange(len(pixel))
    first = np.ones(len(pixel), bool)
    first[1:] = pixel[by_pixel][1:] != pixel[by_pixel][:-1]
    occurrence = np.empty(len(pixel), np.int64)
    occurrence[by_pixel] = position - np.maximum.accumulate(np.where(first, position, 0))
    by_occurrence = np.argsort(occurrence, kind="stable")
    ends = np.cumsum(np.bincount(occurrence)) if len(pixel) else []
    return np.split(by_occurrence, ends[:-1]) if len(pixel) else []
