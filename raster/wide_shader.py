"""Texture shader stages' arithmetic on columns (docs/numbers.md, section 12): float64, and texels as bytes.

A vector is three columns [k]; texels are int64 [k, 4], 0 to 255.
"""

import numpy as np

# DotProductMapping
UNSIGNED_IDENTITY, EXPAND_NORMAL, SIGNED_ODD, SIGNED_IDENTITY, UNSIGNED_HILO = range(5)
SIGNED_HILO_HEMISPHERE = 7


def twos_complement(values, bits=8):
    """Numbers from -2**(bits - 1) on."""
    return np.where(values >= 1 << (bits - 1), values - (1 << bits), values)


def real_byte(values):
    """Real numbers as bytes. Measured: 98304 of 98304 pixels (BumpEnvMapLuminance)."""
    limited = np.clip(np.where(np.isnan(values), 0.0, values), 0.0, 1.0)
    return np.minimum(((np.floor(limited * 4096.0).astype(np.int64) + 1) * 255) >> 12, 255)


def words(texel):
    """The two words of 16 bits of a texel: alpha and red, green and blue."""
    return texel[:, 3] * 256 + texel[:, 0], texel[:, 1] * 256 + texel[:, 2]


def mapped(texel, mapping):
    """A texel as the vector of a dot product. Measured: 56909 pixels for each mapping (DotSTRCube)."""
    if mapping in (UNSIGNED_HILO, SIGNED_HILO_HEMISPHERE):
        high, low = words(texel)
        if mapping == UNSIGNED_HILO:
            return high / 65535.0, low / 65535.0, np.ones(len(texel))
        x, y = (twos_complement(word, 16) / 32767.0 for word in (high, low))
        rest = (1.0 - x * x) - y * y
        return x, y, np.sqrt(np.maximum(rest, 0.0))
    red, green, blue = (texel[:, i] for i in range(3))
    if mapping == EXPAND_NORMAL:
        return tuple((v - 128.0) / 127.0 for v in (red, green, blue))
    if mapping == SIGNED_ODD:
        return tuple((2.0 * twos_complement(v) + 1.0) / 255.0 for v in (red, green, blue))
    if mapping == SIGNED_IDENTITY:
        return tuple(twos_complement(v) / 127.0 for v in (red, green, blue))
    return tuple(v / 255.0 for v in (red, green, blue))


def dot(a, b):
    """``(a0 b0 + a1 b1) + a2 b2``."""
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def reflected(normal, eye):
    """``2 n (n e) - e (n n)``. Source: NV_texture_shader section 3.8.13.1.18, times n n."""
    twice, square = 2.0 * dot(normal, eye), dot(normal, normal)
    return tuple(n * twice - e * square for n, e in zip(normal, eye, strict=True))


def offset(s, t, texel, matrix):
    """S and t moved by a texel's blue and green. Measured: BumpEnvMap, Bump_map captures."""
    ds, dt = twos_complement(texel[:, 2]) / 128.0, twos_complement(texel[:, 1]) / 128.0
    a1, a2, a3, a4 = (float(a) for a in matrix)
    return (s + a1 * ds) + a3 * dt, (t + a2 * ds) + a4 * dt


def scaled(texel, magnitude, scale, bias):
    """Red, green and blue times a magnitude byte, scaled and biased. Measured: BumpEnvMapLuminance."""
    factor = magnitude / 255.0 * float(scale) + float(bias)
    return np.concatenate([real_byte(texel[:, :3] * factor[:, None] / 255.0), texel[:, 3:]], axis=1)


def replaced_depth(numerator, denominator, units, largest):
    """(words of a depth that a texture shader made, whether it lies inside the buffer's range)."""
    z = np.where(denominator != 0.0, numerator / np.where(denominator == 0.0, 1.0, denominator), np.nan)
    z = z * units
    inside = (z >= 0.0) & (z <= largest)
    return np.floor(np.where(inside, z, 0.0)).astype(np.int64), inside
