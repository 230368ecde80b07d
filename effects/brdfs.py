"""Reflectance models in float64, as the paper prints them: what the passes are compared with.

Vectors are arrays [..., 3] of length one; h is the halfway vector. Every function broadcasts its arguments.

Source: Kautz, Seidel 2000, sections 3.2 and 4, Eq. 1; Blinn 1977; erratum E004.1 (the printed identity loses
the sign of h.n).
"""

import numpy as np

from effects.vectors import dot, normalize


def half_vector(light, view):
    """The halfway vector: l + v, normalized."""
    return normalize(np.asarray(light, np.float64) + view)


def lambert(normal, light):
    """Diffuse reflection (n.l)+ of a white surface under a light of intensity one."""
    return np.maximum(0.0, dot(normal, light))


def blinn_phong(normal, half, exponent, specular=1.0):
    """Blinn's model k_s (h.n)^N with the sign kept: zero where h.n < 0."""
    return specular * np.maximum(0.0, dot(normal, half)) ** exponent


def lobe(half, tangent, binormal, alpha_x, alpha_y):
    """The expression under the square root: (1 - (h.t/ax)^2 - (h.b/ay)^2)+."""
    x, y = dot(half, tangent) / alpha_x, dot(half, binormal) / alpha_y
    return np.maximum(0.0, 1.0 - x * x - y * y)


def anisotropic_blinn_phong(half, tangent, binormal, alpha_x, alpha_y, specular=1.0, exponent=2.0):
    """The anisotropic Blinn-Phong model k_s (sqrt(e))^N with e of ``lobe``.

    The exponent 2 is Eq. 1 exactly: the paper's "square root replaced by the identity" (erratum E004.4).
    """
    e = lobe(half, tangent, binormal, alpha_x, alpha_y)
    return specular * (e if exponent == 2.0 else np.sqrt(e) ** exponent)


def half_width(alpha):
    """Sine of the angle from the centre at which ``lobe`` falls to one half along one axis: alpha
    sqrt(1/2).
    """
    return alpha * np.sqrt(0.5)
