"""Fresnel's reflectance beside Fresnel's two formulas, Snell's law and the catalogue's numbers."""

import cmath
import math

import numpy as np
import pytest

from fixedpipe.effects.reflectance.fresnel import fresnel


def by_amplitudes(angle, index):
    """The mean of both polarizations' squared amplitudes, by angles and Snell's law in complex numbers."""
    refracted = cmath.asin(math.sin(angle) / index)
    cosine, inside = math.cos(angle), cmath.cos(refracted)
    across = (cosine - index * inside) / (cosine + index * inside)
    along = (index * cosine - inside) / (index * cosine + inside)
    return (abs(across) ** 2 + abs(along) ** 2) / 2.0


@pytest.mark.parametrize("index", [0.5, 0.9, 1.0001, 1.5, 5.0, 200.0])
def test_it_is_the_mean_of_both_polarizations(index):
    for angle in np.linspace(0.0, 1.57, 200):
        # 1e-9: both lose digits where the index is near one.
        assert fresnel(math.cos(angle), index) == pytest.approx(by_amplitudes(angle, index), abs=1e-9)


@pytest.mark.parametrize(
    ("index", "degrees", "value", "within"),
    [
        (1.5, 0.0, 0.0400, 5e-5),
        (5.0, 0.0, 0.4444, 5e-5),
        (200.0, 0.0, 0.9802, 5e-5),
        (1.5, 82.8, 0.5, 1e-3),
        (5.0, 73.0, 0.4132, 5e-5),
        (200.0, 60.0, 0.9754, 5e-5),
        (200.0, 85.0, 0.8965, 5e-5),
        (200.0, 89.0, 0.65, 0.005),
    ],
)
def test_the_catalogue_numbers(index, degrees, value, within):
    assert fresnel(math.cos(math.radians(degrees)), index) == pytest.approx(value, abs=within)


def test_at_grazing_angles_everything_is_reflected_and_at_equal_indices_nothing():
    assert fresnel(0.0, 1.5) == 1.0
    assert (fresnel(np.linspace(0.1, 1.0, 10), 1.0) == 0.0).all()
    # Beyond the critical angle of glass, 41.8 degrees from inside.
    assert fresnel(math.cos(math.radians(45.0)), 1.0 / 1.5) == 1.0


@pytest.mark.parametrize("index", [0.0, -1.0, math.nan, math.inf])
def test_an_index_that_is_none_is_refused(index):
    with pytest.raises(ValueError, match="index of refraction"):
        fresnel(0.5, index)
