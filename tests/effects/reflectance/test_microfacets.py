"""Distributions of facets, Smith's shadowing, and Torrance-Sparrow's model, beside other ways to them."""

import math

import numpy as np
import pytest
from scipy import integrate

from fixedpipe.effects.reflectance import microfacets
from fixedpipe.effects.reflectance.fresnel import fresnel

ANGLES = np.linspace(0.0, math.pi / 2, 181)


@pytest.mark.parametrize("name", microfacets.DISTRIBUTIONS)
@pytest.mark.parametrize("m", [0.05, 0.2, 0.7, 1.0, 2.0])
def test_a_distribution_is_at_most_one_and_reaches_it(name, m):
    values = microfacets.DISTRIBUTIONS[name](np.cos(np.linspace(0.0, math.pi / 2, 20001)), m)
    assert values.min() >= 0.0
    # 1e-6: the steps miss the top by so much at most.
    assert 1.0 - 1e-6 < values.max() <= 1.0
    assert (microfacets.DISTRIBUTIONS[name](np.array((0.0, -0.3, -1.0)), m) == 0.0).all()


@pytest.mark.parametrize("m", [0.1, 0.35, 0.9])
def test_distributions_by_the_formulas_of_angles(m):
    delta = ANGLES[:-1]
    assert microfacets.gaussian(np.cos(delta), m) == pytest.approx(np.exp(-((delta / m) ** 2)), abs=1e-12)
    slopes = np.exp(-((np.tan(delta) / m) ** 2))
    assert microfacets.gaussian_heights(np.cos(delta), m) == pytest.approx(slopes, abs=1e-12)
    beckmann = slopes / np.cos(delta) ** 4
    peak = max(2.0 * m * m - 1.0, 0.0)
    largest = math.exp(-peak / (m * m)) * (1.0 + peak) ** 2
    assert microfacets.beckmann(np.cos(delta), m) == pytest.approx(beckmann / largest, abs=1e-12)


@pytest.mark.parametrize("sigma", [0.05, 0.2, 0.8])
def test_smith_is_what_is_left_of_a_profile_of_gaussian_slopes(sigma):
    # Lambda by its integral over the slopes that are steeper than the ray (Smith 1967), by quadrature.
    for angle in (0.2, 0.7, 1.2, 1.5):
        mu = 1.0 / math.tan(angle)

        def steeper(slope, mu=mu):
            density = math.exp(-slope * slope / (2.0 * sigma * sigma)) / (math.sqrt(2.0 * math.pi) * sigma)
            return (slope - mu) * density

        hidden, _ = integrate.quad(steeper, mu, mu + 12.0 * sigma, epsabs=1e-12)
        facing = 1.0 - 0.5 * math.erfc(mu / (math.sqrt(2.0) * sigma))
        expected = facing / (1.0 + hidden / mu)
        assert microfacets.smith_one_way(math.cos(angle), sigma) == pytest.approx(expected, abs=1e-9)


def test_smith_is_one_from_the_front_zero_from_the_side_and_falls_between():
    for sigma in (0.05, 0.2, 1.0):
        values = microfacets.smith_one_way(np.cos(ANGLES), sigma)
        assert values[0] == pytest.approx(1.0, abs=1e-12)
        assert microfacets.smith_one_way(0.0, sigma) == 0.0
        assert (np.diff(values) <= 1e-12).all()
    assert microfacets.smith(0.3, 0.6, 0.2) == microfacets.smith(0.6, 0.3, 0.2)


def test_the_table_s_largest_value_is_the_catalogue_s():
    # P1: G / (pi cos beta), light from the front.
    cosines = np.linspace(1e-4, 1.0, 200001)
    for sigma, largest in ((0.05, 7.97), (0.1, 3.99), (0.2, 1.99), (0.4, 0.997)):
        values = microfacets.smith(1.0, cosines, sigma) / (math.pi * cosines)
        assert values.max() == pytest.approx(largest, rel=3e-3)


def test_one_pixel_by_hand():
    light, view = (np.array((math.sin(a), 0.0, math.cos(a))) for a in (math.radians(30), math.radians(-50)))
    # The half vector is at -10 degrees, both are at 40 degrees to it.
    m, index = 0.35, 1.5
    expected = (
        fresnel(math.cos(math.radians(40)), index)
        * math.exp(-((math.tan(math.radians(10)) / m) ** 2))
        * microfacets.smith(math.cos(math.radians(30)), math.cos(math.radians(50)), m / math.sqrt(2.0))
        / (math.pi * math.cos(math.radians(50)))
    )
    found = microfacets.torrance_sparrow(light, view, np.array((0.0, 0.0, 1.0)), m, index)
    assert found == pytest.approx(expected, rel=1e-12)
    behind = microfacets.torrance_sparrow(-light, view, np.array((0.0, 0.0, 1.0)), m, index)
    assert behind == 0.0
