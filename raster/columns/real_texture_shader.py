"""Texture shader stages in real numbers: ``texture_shader``'s functions without its roundings.

A stage's texel is float64 [k, 4], 1.0 = one. Where an operation reads its two's complement, or words of 16
bits, the number is the texel times 2**bits - 1: of a texture of floats it need not be whole. EXPAND_NORMAL
is 2 x - 1, as NV_texture_shader writes it.
"""

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster.columns.numbers import NOISE

DTYPE = np.float64  # of texels


def one_of(bits):
    """The value of one of a texel of any width."""
    return 1.0


def convert(texel, width, bits):
    """A texel as a register of ``bits`` bits holds it."""
    return texel


def unsigned(texel, signed_components, bits):
    """A texel for later stages: two's complement where its components are signed, a flag each."""
    if not any(signed_components):
        return texel
    complement = texel + 2.0**bits / (2.0**bits - 1.0)
    return np.where(np.array(signed_components) & (texel < 0.0), complement, texel)


def signed(numbers, bits):
    """Numbers of ``bits`` bits, float64, as two's complement."""
    return np.where(numbers >= 2.0 ** (bits - 1) - NOISE, numbers - 2.0**bits, numbers)


def _numbers(components, bits):
    """Components as numbers of 0 to 2**bits - 1."""
    return components * (2.0**bits - 1.0)


def real_texel(values, bits):
    """A texture shader's real numbers as components; what is no number is 0.

    The clamp is the operation's. Source: NV_texture_shader, section 3.8.13.1.6.
    """
    return np.where(values > 0.0, np.minimum(values, 1.0), 0.0)


def words(texel):
    """A texel of bytes as two words of 16 bits: alpha and red, green and blue."""
    red, green, blue, alpha = _numbers(texel, 8).T
    return 256.0 * alpha + red, 256.0 * green + blue


def vector(texel, mapping, bits):
    """(x, y, z) that a dot product reads of a texel, float64 [k] each."""
    if mapping == C.DOT_MAPPING_UNSIGNED_HILO:
        high, low = words(texel)
        return high / 65535.0, low / 65535.0, 1.0
    if mapping == C.DOT_MAPPING_SIGNED_HILO_HEMISPHERE:
        high, low = words(texel)
        x, y = signed(high, 16) / 32767.0, signed(low, 16) / 32767.0
        return x, y, np.sqrt(np.maximum(0.0, (1.0 - x * x) - y * y))
    rgb, one = texel[:, :3].T, 2.0**bits - 1.0
    if mapping == C.DOT_MAPPING_SIGNED_ODD:
        return tuple((2.0 * signed(rgb * one, bits) + 1.0) / one)
    if mapping == C.DOT_MAPPING_SIGNED_IDENTITY:
        return tuple(signed(rgb * one, bits) / (2.0 ** (bits - 1) - 1.0))
    if mapping == C.DOT_MAPPING_EXPAND_NORMAL:
        return tuple(2.0 * rgb - 1.0)
    if mapping == C.DOT_MAPPING_UNSIGNED_IDENTITY:
        return tuple(rgb)
    raise ValueError(f"{mapping!r} is no mapping of a dot product.")


def dot(a, b):
    """``a0 b0 + a1 b1 + a2 b2`` of three columns each."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def offset(strq, texel, matrix, bits):
    """(s, t) moved by a texel's blue and green, in units of half its range, times the offset matrix.

    Measured: BumpEnvMap captures (docs/numbers.md, section 12).
    """
    ds, dt = (signed(_numbers(texel[:, k], bits), bits) / 2.0 ** (bits - 1) for k in (2, 1))
    a1, a2, a3, a4 = matrix
    return strq[:, 0] + a1 * ds + a3 * dt, strq[:, 1] + a2 * ds + a4 * dt


def scaled(texel, bits, magnitude, magnitude_bits, scale, bias, largest):
    """A texel whose colours are multiplied by another's red, scaled and biased, within 0 and ``largest``;
    alpha stays.  Source: NV_texture_shader, section 3.8.13.1.9.
    """
    factor = np.clip(magnitude * scale + bias, 0.0, largest)
    return np.concatenate([np.clip(texel[:, :3] * factor[:, None], 0.0, 1.0), texel[:, 3:]], axis=1)


def replaced_depth(numerator, denominator, scale, largest):
    """(The quotient times ``scale``, float64 [k], and whether it is within 0 and ``largest``).

    Source: NV_texture_shader, section 3.8.13.1.21.
    """
    depth = numerator / denominator * scale
    inside = (depth >= 0.0) & (depth <= largest)  # false where it is not a number
    return np.where(inside, depth, 0.0), inside


def deviations(texel, bits, scale):
    """(d_1, d_2, d_3) of a texel of roughness, float64 [k] each, twice what they are: a footprint's side."""
    scale, half = 2.0 * scale, 2.0 ** (bits - 1)
    d1, d3 = (texel[:, k] * scale for k in (0, 2))
    return d1, (_numbers(texel[:, 1], bits) - half) / (half - 1.0) * scale, d3


def rough_footprint(sides, jacobian, deviations, sizes, most, exact):
    """The axes, longer first, of what pixel and roughness cover of a lookup, in texture coordinates: one
    array, float64 [2, k, 2] (docs/numbers.md, section 12). As ``texture_shader.rough_footprint`` takes them.
    """
    (su, sv, tu, tv), (d1, d2, d3), size = jacobian, deviations, np.array(sizes[:2])
    rough = np.stack([d1 * su, d1 * tu], axis=-1), np.stack([d2 * su + d3 * sv, d2 * tu + d3 * tv], axis=-1)
    sides = np.stack([sides[:, :2], sides[:, 2:], rough[0] * size, rough[1] * size])
    sides = np.where(np.isfinite(sides), sides, 0.0)
    a, b, c = ((sides[..., j] * sides[..., k]).sum(axis=0) for j, k in ((0, 0), (0, 1), (1, 1)))
    half, middle = 0.5 * (a - c), 0.5 * (a + c)
    root = np.hypot(half, b)
    axis = np.where(
        half[:, None] >= 0.0,
        np.stack([half + root, b], axis=1),
        np.stack([b, root - half], axis=1),
    )
    length = np.hypot(axis[:, 0], axis[:, 1])[:, None]
    axis = np.where(length > 0.0, axis / np.where(length > 0.0, length, 1.0), np.array([1.0, 0.0]))
    across = np.stack([-axis[:, 1], axis[:, 0]], axis=1)
    longer, shorter = np.sqrt(middle + root), np.sqrt(np.maximum(middle - root, 0.0))
    return (np.stack([axis * longer[:, None], across * shorter[:, None]]) / size,)
