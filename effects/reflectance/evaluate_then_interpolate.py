"""K16, the order that the paper asks for: evaluate Eq. 1 at the texels, then interpolate the results.

All of it is in float64.

Four texels are fetched with NEAREST, the model is evaluated at each, and the four results are blended
bilinearly. So the halfway vector never meets an interpolated vector that no surface has.
``interpolate_then_evaluate`` is the order of the hardware, also in float64. So the two orders can be compared
without 8-bit arithmetic.

Source: Kautz, Seidel 2000, section 5.1 (K16 of the catalogue; artefact P11).
"""

import numpy as np

from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("K16", "the paper's order: evaluate at the texels, then interpolate", "5.1"),)


def _corners(s, t, columns, rows):
    """The four texels round (s, t) of a repeated texture: (row, column, weight) each."""
    x, y = s * columns - 0.5, t * rows - 0.5
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    a, b = x - i, y - j
    for di, dj, weight in (
        (0, 0, (1.0 - a) * (1.0 - b)),
        (1, 0, a * (1.0 - b)),
        (0, 1, (1.0 - a) * b),
        (1, 1, a * b),
    ):
        yield (j + dj) % rows, (i + di) % columns, weight


def at_texels(evaluate, rows, columns, s, t):
    """``evaluate(row, column)`` at the four texels round (s, t), interpolated: this order for any model.

    ``evaluate`` takes indices [...] of the shape of s and t and returns an array whose first axes they are.
    """
    out = 0.0
    for row, column, weight in _corners(s, t, columns, rows):
        value = evaluate(row, column)
        out = out + weight.reshape(weight.shape + (1,) * (value.ndim - weight.ndim)) * value
    return out


def _squares(half, tangents, binormals):
    x, y = dot(tangents, half), dot(binormals, half)
    return np.maximum(0.0, (1.0 - x * x) - y * y)


def specular(material, half, s, t):
    """Eq. 1 evaluated at the texels and interpolated: float64 of the shape of s and t.

    ``half``: [3] or [..., 3], halfway vectors in the material's frame.
    """
    rows, columns = material.k_s.shape
    tangents, binormals, out = material.scaled_tangents, material.scaled_binormals, 0.0
    for row, column, weight in _corners(s, t, columns, rows):
        value = _squares(half, tangents[row, column], binormals[row, column])
        out = out + weight * (material.k_s[row, column] * value)
    return out


def diffuse(material, light, s, t):
    """(n.l)+ evaluated at the texels and interpolated. ``light``: [3] or [..., 3], unit vectors."""
    rows, columns = material.k_s.shape
    out = 0.0
    for row, column, weight in _corners(s, t, columns, rows):
        out = out + weight * np.maximum(0.0, dot(material.normals[row, column], light))
    return out


def interpolate_then_evaluate(material, half, s, t):
    """Eq. 1 in the hardware's order, without its arithmetic: vectors and k_s are interpolated, then used."""
    rows, columns = material.k_s.shape
    tangents, binormals, scaled_t, scaled_b, k_s = (
        material.scaled_tangents,
        material.scaled_binormals,
        0.0,
        0.0,
        0.0,
    )
    for row, column, weight in _corners(s, t, columns, rows):
        scaled_t = scaled_t + weight[..., None] * tangents[row, column]
        scaled_b = scaled_b + weight[..., None] * binormals[row, column]
        k_s = k_s + weight * material.k_s[row, column]
    return k_s * _squares(half, scaled_t, scaled_b)
