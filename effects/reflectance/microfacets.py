"""Torrance-Sparrow's model of surfaces made of facets, in float64.

The module has distributions of facets, shadowing and masking, and the whole model.

    f_r = F(cos theta) G(cos alpha, cos beta) D(cos delta) / (pi cos alpha cos beta)

Angles are those of the catalogue: alpha (n, l), beta (n, v), theta (l, h), delta (n, h). D is at most one, so
a table can hold F D. With pi below, D is not a density (erratum E000.1).

Distributions take the cosine of delta and a roughness m; a smaller m is narrower. At the angle m, or at the
slope m, they fall to 1/e.

These functions use exponentials, arc cosines and error functions, whose last bit differs between computers.
So a figure that stores their results in a texture rounds them to the texture's format at once.

Source: Heidrich 2001, section 1.1, Eq. 1; Torrance, Sparrow 1967; Smith 1967, whose form the
catalogue has as remembered.
"""

import math

import numpy as np

from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.reflectance.fresnel import fresnel
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique(
        "H07", "distributions of facets: a Gaussian of the angle, one of the heights, Beckmann's", "1.1"
    ),
    Technique("H08", "Smith's shadowing and masking", "1.1"),
)

# NumPy has no error function, and this needs no library for one.
_erfc = np.frompyfunc(math.erfc, 1, 1)


def _tangent_squared(cosine):
    """tan^2 of an angle by its cosine; infinity where that is zero or below."""
    c = np.asarray(cosine, np.float64)
    square = np.where(c > 0.0, c * c, 1.0)
    return np.where(c > 0.0, (1.0 - np.minimum(square, 1.0)) / square, np.inf)


def gaussian(cosine, roughness):
    """D = exp(-(delta/m)^2), delta in radians; zero where the cosine is not positive. Float64, 0 to 1."""
    c = np.asarray(cosine, np.float64)
    angle = np.arccos(np.clip(c, 0.0, 1.0)) / roughness
    return np.where(c > 0.0, np.exp(-angle * angle), 0.0)


def gaussian_heights(cosine, roughness):
    """D = exp(-tan^2(delta) / m^2), the distribution of slopes on a surface of Gaussian heights; zero where
    the cosine is not positive. Float64, 0 to 1. Their standard deviation along an axis is m / sqrt(2).
    """
    return np.exp(-_tangent_squared(cosine) / np.square(roughness))


def beckmann(cosine, roughness):
    """Beckmann's D = exp(-tan^2(delta) / m^2) / cos^4(delta), divided by its largest value.

    That is one at delta = 0 up to m = 1/sqrt(2), and at tan^2(delta) = 2 m^2 - 1 beyond. Zero where the
    cosine is not positive. Float64, 0 to 1.
    """
    slope, m2 = _tangent_squared(cosine), np.square(np.asarray(roughness, np.float64))
    peak = np.maximum(2.0 * m2 - 1.0, 0.0)
    # 1/cos^2 is 1 + tan^2; in logarithms nothing is infinity times zero.
    finite = np.where(np.isinf(slope), 0.0, slope)
    exponent = (peak - finite) / m2 + 2.0 * (np.log1p(finite) - np.log1p(peak))
    return np.where(np.isinf(slope), 0.0, np.exp(np.minimum(exponent, 0.0)))


DISTRIBUTIONS = {"gaussian": gaussian, "gaussian heights": gaussian_heights, "beckmann": beckmann}


def smith_one_way(cosine, sigma):
    """Smith's S(angle) = (1 - erfc(mu / (sqrt 2 sigma)) / 2) / (1 + L) for one direction, mu its cotangent.

    L = (sqrt(2/pi) (sigma/mu) exp(-mu^2 / (2 sigma^2)) - erfc(mu / (sqrt 2 sigma))) / 2. ``sigma``: standard
    deviation of slopes, above 0. One at normal incidence, zero where the cosine is not positive.
    """
    slope = np.sqrt(_tangent_squared(cosine))
    lit = np.isfinite(slope)
    # mu / sigma, as large as leaves nothing of both functions where the direction is the normal.
    ratio = 1.0 / np.maximum(np.where(lit, slope, 1.0) * sigma, 1e-3)
    rest = np.asarray(_erfc(ratio / np.sqrt(2.0)), np.float64)
    hidden = 0.5 * (np.sqrt(2.0 / np.pi) * np.exp(-0.5 * ratio * ratio) / ratio - rest)
    return np.where(lit, (1.0 - 0.5 * rest) / (1.0 + hidden), 0.0)


def smith(light_cosine, view_cosine, sigma):
    """Smith's G of both directions, independent of each other: the product of ``smith_one_way``, 0 to 1."""
    return smith_one_way(light_cosine, sigma) * smith_one_way(view_cosine, sigma)


def torrance_sparrow_with(distribution, light, view, normal, roughness, index, specular=1.0):
    """The radiance f_r (n.l)+ of Torrance-Sparrow's model, k_s F G D / (pi n.v): float64 [...].

    distribution  one of DISTRIBUTIONS: a function of cosine and roughness, at most one
    roughness     m of the distribution; Smith's sigma is m / sqrt(2)
    index         of refraction, of ``fresnel``

    Zero where the light or the viewer is behind the surface.
    """
    lit, seen = dot(normal, light), dot(normal, view)
    in_front = (lit > 0.0) & (seen > 0.0)
    half = normalize(np.where(in_front[..., None], np.asarray(light, np.float64) + view, normal))
    factor = fresnel(dot(light, half), index) * distribution(dot(normal, half), roughness)
    obstruction = smith(lit, seen, np.asarray(roughness) / np.sqrt(2.0))
    return np.where(in_front, specular * factor * obstruction / (np.pi * np.where(in_front, seen, 1.0)), 0.0)


def torrance_sparrow(light, view, normal, roughness, index, specular=1.0):
    """``torrance_sparrow_with`` Gaussian heights, whose slopes Smith's G is made for."""
    return torrance_sparrow_with(gaussian_heights, light, view, normal, roughness, index, specular)
