"""Comparison functions on real numbers: the alpha, stencil and depth tests ask them, and depth textures."""

from fixedpipe.raster import codes as C
from fixedpipe.raster.kernel import kernel


@kernel
def holds(function, a, b):
    """``a FUNC b`` (OpenGL 1.2.1 section 4.1).

    ``function``: a bit each for less, equal and greater. Where a or b is no number, only NOTEQUAL and ALWAYS
    hold.
    """
    if a < b:
        return (function & C.COMPARISON_LESS) != 0
    if a > b:
        return (function & C.COMPARISON_GREATER) != 0
    if a == b:
        return (function & C.COMPARISON_EQUAL) != 0
    return function == C.COMPARISON_NOTEQUAL or function == C.COMPARISON_ALWAYS
