"""S21 to S23: Blinn and Phong's highlight on a rough surface, in floats.

Before the power, the roughness D, D D^T = K, changes the angle a between normal n and halfway vector h:

    cos^2 a' = cos^2 a / (q + cos^2 a),    cos^2 a = 1 - |d|^2,    d = (h.e_1, h.e_2)

and q is, for each ``Form``:

    printed    |d|^4 / |D d|^2      the paper's form: right only for a diagonal K (erratum E001.6)
    corrected  |d|^4 / |D^T d|^2    |D^T d| is the deviation along d
    inverse    |D^-1 d|^2           the contours are the ellipses of K themselves

All three agree on a diagonal K's axes. With I_1 alone, S22, all are tan a' = tan a / I_1. A deviation is in
units of slope, so a' is below a if the deviation exceeds one (erratum E001.11). For smaller deviations the
power m bounds the sharpness from below. ``inverse`` with m = 4 is Trowbridge and Reitz's distribution of
slopes.

The module uses float64 addition, multiplication, division and square root in one order, so its bits are the
same everywhere.

Source: Schilling 1997, appendix A; errata E001.6, E001.11, E001.12; pass sequences A-S21 to A-S23 of the
catalogue.
"""

from enum import StrEnum

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.bump_mapping.blinn import integer_power
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("S21", "Blinn and Phong's highlight by anisotropic roughness", "A"),
    Technique("S22", "Blinn and Phong's highlight by isotropic roughness", "A"),
    Technique("S23", "a highlight of constant exponent, or by a table of the cosine's square", "A"),
)

# Trowbridge and Reitz's distribution. Source: catalogue, A-S21 (chosen).
EXPONENT = 4


class Form(StrEnum):
    """By what the angle is changed."""

    PRINTED = "printed"
    CORRECTED = "corrected"
    INVERSE = "inverse"


def apart(half, frame, offsets=(0.0, 0.0)):
    """d of halfway vectors: float64 [..., 2], not longer than one.

    half     float64 [..., 3], of any length
    frame    float64 [..., 3, 3]: e_1, e_2, n, of unit length and perpendicular
    offsets  float64 [..., 2]: f, which a bump map adds to n along e_1 and e_2

    Roughness is a distribution of slopes about f, so slopes are subtracted. Without bumps d is the projection
    of h at unit length. For an h behind the surface, d has the length one, the greatest.
    """
    frame, f = np.asarray(frame, np.float64), np.asarray(offsets, np.float64)
    x, y, z = (dot(half, frame[..., k, :]) for k in range(3))
    up = np.where(z > 0.0, z, 1.0)
    slopes = np.stack([x / up - f[..., 0], y / up - f[..., 1]], axis=-1)
    square = slopes[..., 0] * slopes[..., 0] + slopes[..., 1] * slopes[..., 1]
    d = slopes / np.sqrt(1.0 + square)[..., None]
    return np.where((z > 0.0)[..., None], d, np.array([1.0, 0.0]))


def _quadratic(matrix, d):
    """d^T M d of a symmetric M, (a, b, c)."""
    (x, y), (a, b, c) = (np.moveaxis(np.asarray(v, np.float64), -1, 0) for v in (d, matrix))
    return np.maximum((a * (x * x) + 2.0 * b * (x * y)) + c * (y * y), 0.0)


def printed_covariance(covariance):
    """D^T D, (a, b, c), of K = D D^T: d^T (D^T D) d is |D d|^2, which the paper prints. float64 [..., 3]."""
    d_1, d_2, d_3 = (rough.deviations(covariance)[..., k] for k in range(3))
    return np.stack([d_1 * d_1, d_1 * d_2, d_2 * d_2 + d_3 * d_3], axis=-1)


def _over(numerator, denominator):
    """A quotient; nothing over nothing is nothing, something over nothing is infinite."""
    safe = np.where(denominator > 0.0, denominator, 1.0)
    return np.where(denominator > 0.0, numerator / safe, np.where(numerator > 0.0, np.inf, 0.0))


def quotient(d, covariance, form=Form.INVERSE):
    """q: float64 [...], infinite in directions without any slopes.

    d           float64 [..., 2], as for ``apart``
    covariance  float64 [..., 3]: K, (a, b, c)

    Raises ValueError for a matrix that is no covariance, a d longer than one, or another form.
    """
    form, k, d = Form(form), rough.checked_covariance(covariance), np.asarray(d, np.float64)
    square = d[..., 0] * d[..., 0] + d[..., 1] * d[..., 1]
    if not (square <= 1.0 + 1e-9).all():
        raise ValueError("A vector d is longer than one, or NaN; give the projection of a unit vector.")
    if form is not Form.INVERSE:
        along = _quadratic(k if form is Form.CORRECTED else printed_covariance(k), d)
        return _over(square * square, along)
    # D^-1 d by substitution from below: D is triangular.
    d_1, d_2, d_3 = (rough.deviations(k)[..., n] for n in range(3))
    second = _over(np.abs(d[..., 1]), d_3)
    second = np.where(d[..., 1] < 0.0, -second, second)
    finite = np.where(np.isfinite(second), second, 0.0)
    first = _over(np.abs(d[..., 0] - d_2 * finite), d_1)
    return first * first + second * second


def squared_cosine(d, covariance, form=Form.INVERSE):
    """cos^2 a' by anisotropic roughness, S21: float64 [...] from 0 to 1. Arguments as for ``quotient``."""
    q = quotient(d, covariance, form)
    rest = _rest(d)
    return _over(rest, q + rest)


def _rest(d):
    """cos^2 a."""
    d = np.asarray(d, np.float64)
    return np.maximum(1.0 - (d[..., 0] * d[..., 0] + d[..., 1] * d[..., 1]), 0.0)


def squared_cosine_isotropic(d, deviation):
    """cos^2 a' by I_1 alone, S22: float64 [...], tan a' = tan a / I_1.

    deviation  float64 [...]: I_1, from zero on

    Raises ValueError for one below zero or not finite.
    """
    deviation, rest = np.asarray(deviation, np.float64), _rest(d)
    if not (np.isfinite(deviation) & (deviation >= 0.0)).all():
        raise ValueError("A deviation I_1 is below zero or not finite; give numbers from zero on.")
    square = deviation * deviation
    # Where there is neither roughness nor an angle the normal is h.
    return np.where(rest >= 1.0, 1.0, _over(square * rest, (1.0 - rest) + square * rest))


def brightness(squared, exponent=EXPONENT):
    """cos^m a' of its square: float64 [...]. Raises ValueError for a power that is no whole number from 1
    on.
    """
    if exponent % 2:
        return integer_power(np.sqrt(squared), exponent)
    return integer_power(squared, exponent // 2)


def energy(covariance, exponent=EXPONENT):
    """The factor of a highlight of ``Form.INVERSE`` that makes a rougher one as bright in total: float64
    [...].

        (m - 2) / (2 pi s_1 s_2)

    which is 1 / (pi s_1 s_2) for m = 4: over all slopes its integral is one (erratum E001.12). Infinite where
    a deviation is zero. Raises ValueError for m of 2 and less, whose integral has no end.
    """
    if not exponent > 2:
        raise ValueError(f"A highlight of exponent {exponent} has no finite energy; give 3 or more.")
    long, short, _ = rough.principal(rough.checked_covariance(covariance))
    return _over((exponent - 2.0) / (2.0 * np.pi), long * short)


def table(function, count=256):
    """S23: a function of cos^2 a' at ``count`` places from 0 to 1: float64 [count].

    Raises ValueError for fewer than two places, or values that are not finite.
    """
    if count < 2:
        raise ValueError(f"A table of {count} entries holds no function; give 2 or more.")
    out = np.asarray(function(np.arange(count) / (count - 1.0)), np.float64)
    if out.shape != (count,) or not np.isfinite(out).all():
        raise ValueError("The highlight's function gives no finite number for each cosine's square.")
    return out


def looked_up(entries, squared):
    """A table at cos^2 a', linearly: float64 [...]."""
    at = np.clip(np.asarray(squared, np.float64), 0.0, 1.0) * (len(entries) - 1.0)
    low = np.minimum(np.floor(at).astype(np.int64), len(entries) - 2)
    return entries[low] + (at - low) * (entries[low + 1] - entries[low])
