"""S16 to S19: a bump map's pyramid, and the pyramid of the roughness that its levels have lost.

A bump map of offset vectors f (slopes, of either sign) is a mip-map. Each texel also stores a covariance
matrix K = [a b; b c] of the offsets that it covers:

    f_l = mean of four f_(l-1)
    K_l = mean of four K_(l-1) + mean of (f_(l-1) - f_l)(f_(l-1) - f_l)^T

K is the covariance of all offsets of level 0 in the texel (erratum E001.5). The textures store D, upper
triangular, with D D^T = K; its numbers have the size of deviations. Or they store I_1 alone, the root of K's
larger eigenvalue.

The module uses float64 addition, multiplication, division and square root in one order, so its bits are the
same everywhere.

Source: Schilling 1997, section 8; errata E001.5, E001.8, E001.14; pass sequences A-S16 to A-S19 of the
catalogue.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("S16", "roughness: the covariance of the offset vectors that a texel stands for", "8"),
    Technique("S17", "a pyramid of roughness, computed level by level with the bump map's", "8"),
    Technique("S18", "roughness stored as D, a triangular root of the covariance", "8"),
    Technique("S19", "isotropic roughness: the larger deviation alone", "8"),
)


@dataclass(frozen=True, eq=False)
class Level:
    """One level of the two pyramids, bottom row first.

    offsets     float64 [rows, columns, 2]: f along u and v, in units of slope
    covariance  float64 [rows, columns, 3]: a, b and c of K, in units of slope squared
    """

    offsets: np.ndarray
    covariance: np.ndarray

    @property
    def deviations(self):
        """D, float64 [rows, columns, 3], as ``deviations``."""
        return deviations(self.covariance)


def _quarter(values):
    """The four texels under each texel of the next level (two at an edge of one texel), as a list."""
    rows = [values] if values.shape[0] == 1 else [values[0::2], values[1::2]]
    return [part for row in rows for part in ([row] if row.shape[1] == 1 else [row[:, 0::2], row[:, 1::2]])]


def _mean(parts):
    """The mean of two or four arrays: pairs first, as levels of any size come out alike."""
    while len(parts) > 1:
        parts = [(a + b) * 0.5 for a, b in zip(parts[0::2], parts[1::2], strict=True)]
    return parts[0]


def products(vectors):
    """x x^T of vectors [..., 2] as (a, b, c): float64 [..., 3]."""
    u, v = vectors[..., 0], vectors[..., 1]
    return np.stack([u * u, u * v, v * v], axis=-1)


def pyramid(offsets, covariance=None):
    """Both pyramids down to one texel: a tuple of Level, level 0 first.

    offsets     float64 [rows, columns, 2], rows and columns powers of two
    covariance  the roughness beneath level 0: three numbers (a, b, c) or [rows, columns, 3]; None: level 0 is
                smooth

    Raises ValueError for other shapes, numbers that are not finite, or a covariance that is none.
    """
    offsets = np.array(offsets, np.float64)
    if offsets.ndim != 3 or offsets.shape[2] != 2 or 0 in offsets.shape:
        raise ValueError(f"The bump map has shape {offsets.shape}; give offset vectors [rows, columns, 2].")
    rows, columns = offsets.shape[:2]
    if rows & (rows - 1) or columns & (columns - 1):
        raise ValueError(f"The bump map is {columns}x{rows} texels; a pyramid needs powers of two.")
    if not np.isfinite(offsets).all():
        raise ValueError("The bump map holds NaN or infinity; give finite offsets.")
    k = np.zeros((rows, columns, 3)) if covariance is None else np.asarray(covariance, np.float64)
    k = np.array(np.broadcast_to(k, (rows, columns, 3))) if k.shape in ((3,), (rows, columns, 3)) else k
    if k.shape != (rows, columns, 3):
        raise ValueError(f"The roughness has shape {k.shape}; give (a, b, c) or [{rows}, {columns}, 3].")
    checked_covariance(k)
    levels = [Level(offsets, k)]
    while offsets.shape[0] * offsets.shape[1] > 1:
        finer = _quarter(offsets)
        offsets = _mean(finer)
        k = _mean([kept + products(f - offsets) for kept, f in zip(_quarter(k), finer, strict=True)])
        levels.append(Level(offsets, k))
    return tuple(levels)


def from_heights(heights, scale=1.0, periodic=True):
    """The pyramids of a height field over a unit square: a tuple of Level.

    Offsets along (e_1, e_2) are the slopes with their signs turned (erratum E001.9), times ``scale``.
    """
    along_s, along_t = height_fields.slopes(heights, periodic)
    return pyramid(np.stack([-along_s * scale, -along_t * scale], axis=-1))


def checked_covariance(covariance):
    """Covariances [..., 3] as float64.

    Raises ValueError if they are not finite, or are no covariance: a or c below zero, or b^2 above a c by
    more than rounding.
    """
    k = np.asarray(covariance, np.float64)
    if k.shape[-1:] != (3,):
        raise ValueError(f"Covariances have shape {k.shape}; give (a, b, c), [..., 3].")
    if not np.isfinite(k).all():
        raise ValueError("A covariance is NaN or infinite; give finite numbers.")
    a, b, c = k[..., 0], k[..., 1], k[..., 2]
    if (a < 0.0).any() or (c < 0.0).any() or (b * b > a * c * (1.0 + 1e-9) + 1e-30).any():
        raise ValueError("A matrix [a b; b c] is no covariance: give a and c from zero on, b^2 at most a c.")
    return k


def deviations(covariance):
    """D of covariances [..., 3] as (d_1, d_2, d_3), K = D D^T, d_1 and d_3 at least zero: float64 [..., 3].

    Where c is zero, as for corrugated iron along v, d_2 is zero and d_1 is the root of a (erratum E001.8).
    """
    a, b, c = (np.asarray(covariance, np.float64)[..., k] for k in range(3))
    d_3 = np.sqrt(c)
    safe = np.where(c > 0.0, c, 1.0)
    d_2 = np.where(c > 0.0, b / np.sqrt(safe), 0.0)
    d_1 = np.sqrt(np.maximum(a - np.where(c > 0.0, b * b / safe, 0.0), 0.0))
    return np.stack([d_1, d_2, d_3], axis=-1)


def covariance_of(stored):
    """K = D D^T of deviations [..., 3] (d_1, d_2, d_3): float64 [..., 3] (a, b, c)."""
    d_1, d_2, d_3 = (np.asarray(stored, np.float64)[..., k] for k in range(3))
    return np.stack([d_1 * d_1 + d_2 * d_2, d_2 * d_3, d_3 * d_3], axis=-1)


def largest_deviation(covariance):
    """I_1 of covariances [..., 3]: the root of the larger eigenvalue, float64 [...]."""
    a, b, c = (np.asarray(covariance, np.float64)[..., k] for k in range(3))
    half = 0.5 * (a - c)
    return np.sqrt(0.5 * (a + c) + np.sqrt(half * half + b * b))


def principal(covariance):
    """(I_1, I_2, axis) of covariances [..., 3]: deviations along the ellipse's long and short axes, float64
    [...], and the unit vector of the long one, float64 [..., 2]; along u where both are equal.
    """
    a, b, c = (np.asarray(covariance, np.float64)[..., k] for k in range(3))
    half = 0.5 * (a - c)
    root = np.sqrt(half * half + b * b)
    # Of the two columns of K minus its smaller eigenvalue the longer one, which does not cancel.
    x = np.where(half >= 0.0, half + root, b)
    y = np.where(half >= 0.0, b, root - half)
    length = np.sqrt(x * x + y * y)
    safe = np.where(length > 0.0, length, 1.0)
    axis = np.stack([np.where(length > 0.0, x / safe, 1.0), y / safe], axis=-1)
    middle = 0.5 * (a + c)
    return np.sqrt(middle + root), np.sqrt(np.maximum(middle - root, 0.0)), axis


def deviation_bytes(stored, scale):
    """D as three bytes a texel: d_1 and d_3 unsigned, d_2 biased, zero at 128: uint8 [..., 3].

    ``scale``: the deviation that is stored as one, above zero; larger ones are clamped. Raises ValueError for
    another.
    """
    if not (np.isfinite(scale) and scale > 0.0):
        raise ValueError(f"The scale of stored deviations is {scale}; give a number above zero.")
    d = np.asarray(stored, np.float64) / scale
    unsigned, signed = np.floor(255.0 * d + 0.5), np.floor(128.0 + 127.0 * d + 0.5)
    codes = np.stack([unsigned[..., 0], signed[..., 1], unsigned[..., 2]], axis=-1)
    return np.clip(codes, 0, 255).astype(np.uint8)


def deviations_of_bytes(codes, scale):
    """What ``deviation_bytes`` stored: float64 [..., 3] (d_1, d_2, d_3)."""
    codes = np.asarray(codes, np.float64)
    unsigned, signed = codes / 255.0, (codes - 128.0) / 127.0
    return np.stack([unsigned[..., 0], signed[..., 1], unsigned[..., 2]], axis=-1) * scale


def _bilinear(image, s, t):
    """An array [rows, columns, ...] at (s, t) in [0, 1) and beyond, which repeats: float64 [..., ...]."""
    rows, columns = image.shape[:2]
    x, y = s * columns - 0.5, t * rows - 0.5
    left, low = np.floor(x), np.floor(y)
    a, b = (x - left)[..., None], (y - low)[..., None]
    x0, y0 = left.astype(np.int64) % columns, low.astype(np.int64) % rows
    x1, y1 = (x0 + 1) % columns, (y0 + 1) % rows
    lower = image[y0, x0] * (1.0 - a) + image[y0, x1] * a
    upper = image[y1, x0] * (1.0 - a) + image[y1, x1] * a
    return lower * (1.0 - b) + upper * b


def trilinear(images, s, t, level):
    """Arrays [rows, columns, k] of a pyramid, filtered as LINEAR_MIPMAP_LINEAR with REPEAT: float64 [..., k].

    s, t   float64 [...]: texture coordinates, level 0 from 0 to 1
    level  float64 [...]: lambda, clamped to the pyramid
    """
    level = np.clip(np.asarray(level, np.float64), 0.0, len(images) - 1.0)
    s, t, level = np.broadcast_arrays(np.asarray(s, np.float64), np.asarray(t, np.float64), level)
    below = np.minimum(np.floor(level).astype(np.int64), max(len(images) - 2, 0))
    part = level - below
    out = np.zeros((*level.shape, images[0].shape[2]))
    for number in np.unique(below):
        here = below == number
        fine = _bilinear(images[number], s[here], t[here])
        coarse = _bilinear(images[min(number + 1, len(images) - 1)], s[here], t[here])
        f = part[here][:, None]
        out[here] = fine * (1.0 - f) + coarse * f
    return out
