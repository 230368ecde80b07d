"""Comparison functions on real numbers, for the alpha, stencil and depth tests and for depth textures."""

from fixedpipe.raster import codes as C
from fixedpipe.raster.kernel import kernel


@kernel
def holds(function, a, b):
    """``a FUNC b`` (OpenGL 1.2.1 section 4.1).

    ``function`` has one bit each for less, equal and greater. If a or b is NaN, only NOTEQUAL and ALWAYS
    hold.
    """
    if a < b:
        return (function & C.COMPARISON_LESS) != 0
    if a > b:
        return (function & C.COMPARISON_GREATER) != 0
    if a == b:
        return (function & C.COMPARISON_EQUAL) != 0
    return function == C.COMPARISON_NOTEQUAL or function == C.COMPARISON_ALWAYS
