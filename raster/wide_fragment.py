"""Per-fragment operations at any width (docs/numbers.md, section 10), on int64 columns.

Colours are [k, 4] in units of the buffer's value of one. A function that writes takes fragments of distinct
pixels.
"""

import numpy as np

from raster.wide import quotient

NEVER, LESS, EQUAL, LEQUAL, GREATER, NOTEQUAL, GEQUAL, ALWAYS = range(8)  # ComparisonFunction
KEEP, ZERO, REPLACE, INCR, DECR, INVERT, INCR_WRAP, DECR_WRAP = range(8)  # StencilOperation
FUNC_ADD, FUNC_SUBTRACT, FUNC_REVERSE_SUBTRACT, MIN, MAX, FUNC_ADD_SIGNED, FUNC_REVERSE_SUBTRACT_SIGNED = (
    range(7)
)  # BlendEquation
FAR = 1 << 30  # how far a colour reaches where blending does not clamp


def compare(function, a, b):
    """``a FUNC b``, elementwise: the function's bits are less (1), equal (2) and greater (4)."""
    found = np.zeros(np.broadcast(a, b).shape, bool)
    if function & 1:
        found |= a < b
    if function & 2:
        found |= a == b
    if function & 4:
        found |= a > b
    return found


def stencil_result(operation, stored, reference):
    """A stencil operation on 8-bit values. Source: OpenGL 1.2.1 section 4.1.4 and EXT_stencil_wrap."""
    if operation == KEEP:
        return stored
    if operation in (ZERO, REPLACE):
        return np.full_like(stored, reference if operation == REPLACE else 0)
    if operation == INVERT:
        return 255 - stored
    if operation in (INCR, DECR):
        return np.clip(stored + (1 if operation == INCR else -1), 0, 255)
    return (stored + (1 if operation == INCR_WRAP else -1)) & 255


def blend_factor(factor, source, destination, constant, one):
    """A factor of tables 4.1 and 4.2, broadcastable to [k, 4]. The codes are BlendFactor's."""
    if factor >= 11:
        value = constant[None] if factor < 13 else constant[None, 3:]
        return one - value if factor in (12, 14) else value
    if factor == 10:
        room = np.minimum(source[:, 3:], one - destination[:, 3:])
        return np.concatenate([room, room, room, np.full_like(room, one)], axis=1)
    if factor <= 1:
        return np.full((1, 4), one * factor, np.int64)
    value = (source, destination, source[:, 3:], destination[:, 3:])[factor // 2 - 1]
    return one - value if factor % 2 else value


def blend(equation, factors, source, destination, constant, bits):
    """Two colours [k, 4] blended, not clamped (section 4.1.6); ``factors``: source's, destination's."""
    one = (1 << bits) - 1
    if equation == MIN:
        return np.minimum(source, destination)
    if equation == MAX:
        return np.maximum(source, destination)
    if equation in (FUNC_ADD_SIGNED, FUNC_REVERSE_SUBTRACT_SIGNED):
        signed = np.where(source >= 1 << (bits - 1), source - (1 << bits), source)
        return destination + signed if equation == FUNC_ADD_SIGNED else destination - signed
    s = source * blend_factor(factors[0], source, destination, constant, one)
    d = destination * blend_factor(factors[1], source, destination, constant, one)
    return quotient(s + d if equation == FUNC_ADD else (s - d if equation == FUNC_SUBTRACT else d - s), one)


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
