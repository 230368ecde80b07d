"""Texture shader stages at any width (docs/numbers.md, sections 12 and 13), on columns.

A stage's texel is int64 [k, 4], red first, of numbers 0..2**bits - 1; where components are signed these are
their two's complement. Coordinates are float64 [k] or [k, c].
"""

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster.columns.interpolate import (
    FAR,
    cut_sum,
    log2_q7,
    major_axis,
    on_face,
    probes_along,
    product_sum,
    signed_reciprocal,
)
from fixedpipe.raster.columns.numbers import convert as converted
from fixedpipe.raster.columns.numbers import one_of

WORD_BITS = 8  # of a texel that holds words of 16 bits
WHOLE = 32768  # one, as the hemisphere's root takes it. Measured: 7 captures of Texture_cubemap
DTYPE = np.int64  # of texels
_GUARD_BITS = 4  # Measured: 12 fraction bits for bytes (BumpEnvMapLuminance); Assumed: as many more elsewhere


def convert(texel, width, bits):
    """A texel of ``width`` bits as a register of ``bits`` bits holds it."""
    return converted(texel, one_of(width), one_of(bits))


def unsigned(texel, signed_components, bits):
    """A texel for later stages: two's complement where its components are signed, a flag each."""
    return texel & one_of(bits)


def signed(values, bits):
    """Numbers of ``bits`` bits as two's complement."""
    return np.where(values >= 1 << (bits - 1), values - (1 << bits), values)


def real_texel(values, bits):
    """A texture shader's real numbers, float64, as components of ``bits`` bits; what is no number is 0."""
    limited = np.where(values > 0.0, np.minimum(values, 1.0), 0.0)
    fraction, one = bits + _GUARD_BITS, one_of(bits)
    whole = np.floor(limited * float(1 << fraction)).astype(np.int64) + 1
    return np.minimum(whole * one >> fraction, one)


def kept(strq, modes):
    """Which fragments a CULL_FRAGMENT stage keeps, bool [k]; ``modes``: of s, t, r and q."""
    return ((strq < 0.0) == (np.array(modes) == C.CULL_MODE_LESS)).all(axis=1)


def words(texel):
    """A texel of bytes as two words of 16 bits: alpha and red, green and blue."""
    return texel[:, 3] << 8 | texel[:, 0], texel[:, 1] << 8 | texel[:, 2]


def vector(texel, mapping, bits):
    """(x, y, z) that a dot product reads of a texel, float64 [k] each."""
    if mapping == C.DOT_MAPPING_UNSIGNED_HILO:
        high, low = words(texel)
        return high / 65535.0, low / 65535.0, 1.0
    if mapping == C.DOT_MAPPING_SIGNED_HILO_HEMISPHERE:
        high, low = words(texel)
        x, y = signed(high, 16), signed(low, 16)
        rest = np.maximum(WHOLE * WHOLE - x * x - y * y, 0)
        return x / 32767.0, y / 32767.0, np.floor(np.sqrt(rest.astype(np.float64))) / WHOLE
    rgb = texel[:, :3]
    one, half = float(one_of(bits)), 1 << (bits - 1)
    if mapping == C.DOT_MAPPING_EXPAND_NORMAL:
        found = (rgb - half) / float(half - 1)
    elif mapping == C.DOT_MAPPING_SIGNED_ODD:
        found = (2.0 * signed(rgb, bits) + 1.0) / one
    elif mapping == C.DOT_MAPPING_SIGNED_IDENTITY:
        found = signed(rgb, bits) / float(half - 1)
    elif mapping == C.DOT_MAPPING_UNSIGNED_IDENTITY:
        found = rgb / one
    else:
        raise ValueError(f"{mapping!r} is no mapping of a dot product.")
    return found[:, 0], found[:, 1], found[:, 2]


def dot(a, b):
    """``a0 b0 + a1 b1 + a2 b2`` of three columns each, the second's singles: a ``product_sum``."""
    singles = [np.asarray(v, np.float64).astype(np.float32).astype(np.float64) for v in b]
    return product_sum(*zip(a[:3], singles, strict=True))[0]


def offset(strq, texel, matrix, bits):
    """(s, t) moved by a texel's blue and green, in units of half its range, times the offset matrix;
    terms are added as a coordinate's.
    """
    unit = float(1 << (bits - 1))
    ds, dt = signed(texel[:, 2], bits) / unit, signed(texel[:, 1], bits) / unit
    a1, a2, a3, a4 = (float(a) for a in matrix)
    return cut_sum(strq[:, 0], a1 * ds, a3 * dt)[0], cut_sum(strq[:, 1], a2 * ds, a4 * dt)[0]


def deviations(texel, bits, scale):
    """(d_1, d_2, d_3) of a texel of roughness, float64 [k] each, twice what they are: a footprint's side."""
    one, half, scale = float(one_of(bits)), 1 << (bits - 1), 2.0 * float(scale)
    return (
        texel[:, 0] / one * scale,
        (texel[:, 1] - half) / float(half - 1) * scale,
        texel[:, 2] / one * scale,
    )


def rough_footprint(sides, jacobian, deviations, sizes, most, exact):
    """(along s, along t, probes) [k, 3] and lambda with 8 fraction bits, int64 [k], of lookups filtered by
    roughness (section 12).

    sides       float64 [k, 4]: the pixel's steps (s, t) to the right and downwards, texels
    jacobian    of s by the bumps' two components, then of t; float64 [k] or numbers
    deviations  of the bumps, as sides of a footprint
    most        of probes; 1: one, at the longer axis's level
    exact       as many as cover it; else a power of two
    """
    (xs, xt, ys, yt), (su, sv, tu, tv), (d1, d2, d3) = sides.T, jacobian, deviations
    width, height = sizes[:2]
    us, ut = (su * d1) * width, (tu * d1) * height
    vs, vt = (su * d2 + sv * d3) * width, (tu * d2 + tv * d3) * height
    a = ((xs * xs + ys * ys) + us * us) + vs * vs
    b = ((xs * xt + ys * yt) + us * ut) + vs * vt
    c = ((xt * xt + yt * yt) + ut * ut) + vt * vt
    half, middle = 0.5 * (a - c), 0.5 * (a + c)
    root = np.sqrt(half * half + b * b)
    good = middle + root < np.inf  # false where it is not a number
    half, middle, root, b = (np.where(good, v, 0.0) for v in (half, middle, root, b))
    longer, shorter = middle + root, np.maximum(middle - root, 0.0)
    x, y = np.where(half >= 0.0, half + root, b), np.where(half >= 0.0, b, root - half)
    length = np.sqrt(x * x + y * y)
    some = length > 0.0
    safe, side = np.where(some, length, 1.0), np.sqrt(longer)
    along_s = np.where(some, x / safe, 1.0) * side / width
    along_t = np.where(some, y / safe, 0.0) * side / height
    probes, square = np.ones(len(longer)), longer
    if most > 1:
        probes, square = probes_along(longer, shorter, float(most), exact)
    positive = square > 0.0
    lod = np.where(positive, log2_q7(np.where(positive, square, 1.0)), -FAR)
    return np.stack([along_s, along_t, probes], axis=1), np.where(good, lod, FAR)


def scaled(texel, bits, magnitude, magnitude_bits, scale, bias, largest=np.inf):
    """A texel whose colours are multiplied by another's red, scaled and biased, ``largest`` at most; alpha
    stays.
    """
    factor = (magnitude / float(one_of(magnitude_bits))) * float(scale) + float(bias)
    factor = np.minimum(factor, largest)
    colors = real_texel(texel[:, :3] * factor[:, None] / float(one_of(bits)), bits)
    return np.concatenate([colors, texel[:, 3:]], axis=1)


def reflected(normal, eye, dot=dot):
    """``2 n (n e) - e (n n)`` of three columns each: the reflection vector times the square of the normal's
    length.
    """
    twice, square = 2.0 * dot(normal, eye), dot(normal, normal)
    return tuple(n * twice - e * square for n, e in zip(normal, eye, strict=True))


def replaced_depth(numerator, denominator, scale, largest):
    """(floor of the quotient times ``scale``, int64 [k], and whether it is a word of the depth buffer)."""
    z = numerator * signed_reciprocal(denominator) * float(scale)
    inside = (z >= 0.0) & (z <= float(largest))  # false where it is not a number
    return np.floor(np.where(inside, z, 0.0)).astype(np.int64), inside


def face_planes(strq):
    """(s, t, r) of a cube map's access to a two-dimensional texture: on any face, t upwards."""
    sc, tc, major = on_face(strq, major_axis(strq))
    some = major > 0.0
    s, t = (np.where(some, c / major, 0.0) for c in (sc, -tc))
    return np.stack([s, t, np.zeros_like(s)], axis=1)
