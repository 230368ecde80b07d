"""Functions that no hardware of the time computes, sampled into textures for dependent lookups.

A table of n texels over [0, 1] holds its function at the texels' centres, (i + 1/2)/n, except at its ends.
With CLAMP_TO_EDGE, a coordinate within half a texel of 0 or 1 reads the first or last texel alone. So these
hold the function at 0 and at 1. Otherwise R(s) = sqrt(1 - s) with 256 texels would end at 0.044 (erratum
E004.16).

Source: Kautz, Seidel 2000, section 3 (complex functions, sampled and put into texture maps).
"""

import numpy as np

from fixedpipe.effects.passes.arguments import one_of
from fixedpipe.effects.reflectance import brdfs
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_1d, texture_2d

LUMINANCE = {8: InternalFormat.LUMINANCE8, 12: InternalFormat.LUMINANCE12}
LARGEST_LOGARITHM = 7.0  # N from 1 to 128 = 2^7 is stored as log2(N) / 7 (pass sequence A-K05)

# Ward's m is stored over 8: beyond, E(m, d) < 2^-8 for d <= 1 is dark in eight bits. Source: A-K09.
LARGEST_M = 8.0
# S(p) (n.l)+ = sqrt(n.l / n.v) exceeds one where a bump faces the light more than the eye; up to 2, where n.l
# is 4 n.v, it is kept.
LARGEST_S_NL = 2.0


def positions(count):
    """Where a table's texels sample: centres, and the two ends of [0, 1]. float64 [count]."""
    centers = (np.arange(count) + 0.5) / count
    centers[0], centers[-1] = 0.0, 1.0
    return centers


def sampled(function, columns, rows=None, *, profile, bits=8):
    """A function's table: a one-dimensional texture, or with ``rows`` a two-dimensional one, s along columns.

    ``function``: of float64 s, or s and t, in [0, 1]. Values are rounded to ``bits`` at once, 8 or 12, so
    that the bits do not depend on a library's exponentials; an exact profile gets them unrounded.
    """
    internal_format = LUMINANCE[one_of(tuple(LUMINANCE), bits, "The texture's bits")]
    s = positions(columns)
    values = function(s) if rows is None else function(s[None, :], positions(rows)[:, None])
    values = np.clip(values, 0.0, 1.0)
    if not profile.arithmetic.exact:
        one = 2.0**bits - 1.0
        values = np.floor(values * one + 0.5) / one
    make = texture_1d if rows is None else texture_2d
    return make(values[..., None], internal_format)


def power(n, e):
    """F(N, e) = (sqrt e)^N with N given as log2(N) / 7."""
    return brdfs.blinn_phong_f(2.0 ** (LARGEST_LOGARITHM * n), e)


def stored_exponent(exponent):
    """N in [1, 128] as log2(N) / 7, rounded to 24 bits."""
    step = 2.0**-24
    return np.floor(np.log2(exponent) / LARGEST_LOGARITHM / step + 0.5) * step
