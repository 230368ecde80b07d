"""How textures and vertex colours store vectors and factors, so that the combiners read them back.

Functions that end in ``_texels`` are for ``texture_2d`` and ``PixelImage``. They give bytes, uint8, on a
machine. If ``profile.arithmetic.exact``, they give float64, 1.0 is one, and nothing is rounded. Functions
that end in ``_colors`` are for vertex colours and constant colours: float64, 1.0 is one, on every profile.
``colors_of`` makes them from texels.

Every scene is also built for an exact profile, IDEAL, whose evaluator has no formats. There a scene must not
round, clamp or bias for a format, because that would hide the difference of machine and ideal. A scene's
computation is the same for both. Only its *storage* depends on ``exact``, mostly through these functions.

A table needs a guard if rounding may move its coordinate out of [0, 1]. For example, n.v of two vectors
stored in bytes may exceed one. With REPEAT the table begins again there: dark specks in a highlight, which
the ideal does not have. CLAMP_TO_EDGE (``draws.EDGE``) guards a table that ends at one. A table that repeats,
for arguments of either sign, extends some texels beyond the range of its argument
(``dot_product_lookups.banks_period``). If the ends must be exact, the first and the last texel hold the
function at 0 and at 1 (``sampled_functions.positions``).

EXPAND_NORMAL maps a stored byte x to 2x - 256 on a machine whose half is 128. There zero is stored as 128,
and the vector component v as ``128 + 127.5 v``. With the half at 127.5 (the extension's real-number reading,
2x - 255) it is ``127.5 + 127.5 v``. Wider combiners of c bits read a texel's byte as a fraction of 2**c - 1
and take 2**(c - 1) as the half. For 16 bits, zero is then 127.502, and vertex colours also have c bits. The
exact machine stores ``v/2 + 1/2`` unrounded.

Source: NV_register_combiners, table 4 (EXPAND_NORMAL); normal maps of the time put zero at 128.
"""

import numpy as np

from fixedpipe.pipeline.textures.pixels import unit_numbers


def _zero(profile):
    """The stored byte, as a real number, that EXPAND_NORMAL reads as zero."""
    if profile.arithmetic.expand_half != 128:
        return 127.5
    return 255.0 * 2 ** (profile.arithmetic.combiner_bits - 1) / (2**profile.arithmetic.combiner_bits - 1)


def vector_texels(vectors, profile):
    """Vector components in [-1, 1] as texels that EXPAND_NORMAL reads back.

    Returns
    -------
    array
        uint8 of the same shape, components outside [-1, 1] clamped; for an exact profile float64, not
        clamped.
    """
    vectors = unit_numbers(vectors, "The array of vectors")
    if profile.arithmetic.exact:
        return vectors * 0.5 + 0.5
    return np.clip(np.floor(_zero(profile) + 127.5 * vectors + 0.5), 0, 255).astype(np.uint8)


def vectors_of_texels(stored, profile):
    """Stored values after EXPAND_NORMAL, as float64 with 1.0 = 255: the inverse of ``vector_texels``."""
    if profile.arithmetic.exact:
        return 2.0 * np.asarray(stored, np.float64) - 1.0
    return (2.0 * np.asarray(stored, np.float64) - 2.0 * _zero(profile)) / 255.0


def factor_texels(values, profile):
    """Factors in [0, 1] (k_s, a colour) as texels: uint8, rounded to nearest; for an exact profile float64,
    unchanged.
    """
    values = unit_numbers(values, "The array of factors")
    if profile.arithmetic.exact:
        return values
    # A number that is not negative is cut as floor cuts it.
    codes = np.clip(values, 0.0, 1.0)
    codes *= 255.0
    codes += 0.5
    return codes.astype(np.uint8)


def colors_of(texels):
    """Texels, uint8 or float64, as the floats, 1.0 is one, that vertex colours and constant colours take."""
    return texels / 255.0 if texels.dtype == np.uint8 else texels


def vector_colors(vectors, profile):
    """Vectors [n, 3] as the primary colour of n vertices, for EXPAND_NORMAL: float64 [n, 3].

    On a machine the floats are the combiners' integers divided by their one; with bytes that is 255. The
    conversion of vertex colours turns them back into the same integers (Measured: a float colour keeps 14
    significant bits, then rounds).
    """
    if profile.arithmetic.exact:
        return vector_texels(vectors, profile)
    one = 2.0**profile.arithmetic.combiner_bits - 1.0
    # For bytes these are vector_texels's numbers, to the bit.
    stored = np.floor(
        one / 255.0 * _zero(profile) + one / 2.0 * unit_numbers(vectors, "The array of vectors") + 0.5
    )
    return np.clip(stored, 0.0, one) / one


def vector_and_factor_texels(vectors, alpha, profile):
    """Texels [h, w, 4], the rows in the vectors' order: vectors for EXPAND_NORMAL in RGB, a factor in [0, 1]
    in alpha.
    """
    rgb = vector_texels(vectors, profile)
    a = np.broadcast_to(factor_texels(alpha, profile), rgb.shape[:-1])
    return np.concatenate([rgb, a[..., None]], axis=-1)


def dot_product_texels(vectors, alpha, profile):
    """Texels [h, w, 4], the rows in the vectors' order: vectors in [-1, 1] for a dot product's EXPAND_NORMAL,
    a factor in alpha.

    Source: docs/numbers.md, section 12: (n - 128)/127. The exact machine stores v/2 + 1/2.
    """
    vectors = unit_numbers(vectors, "The array of vectors")
    alpha = np.broadcast_to(factor_texels(alpha, profile), vectors.shape[:-1])[..., None]
    if profile.arithmetic.exact:
        return np.concatenate([vectors * 0.5 + 0.5, alpha], axis=-1)
    stored = np.clip(np.floor(128.0 + 127.0 * vectors + 0.5), 0, 255).astype(np.uint8)
    return np.concatenate([stored, alpha], axis=-1)
