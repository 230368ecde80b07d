"""Factors of a BRDF reproduce what they were made of: maps of a hemisphere, separable and homomorphic."""

import numpy as np
import pytest

from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.reflectance import hemisphere_maps, homomorphic_factors, separable_factors
from fixedpipe.effects.reflectance.brdfs import BRDFS
from fixedpipe.effects.reflectance.hemisphere_maps import AnalyticBRDF, Halves
from fixedpipe.effects.reflectance.separable_factors import Fit


class Made:
    """A BRDF from a function."""

    def __init__(self, function):
        self.at = function


def hemisphere(count, seed):
    """Directions above the horizon by twelve degrees and more."""
    found = normalize(np.random.default_rng(seed).normal(size=(6 * count, 3)))
    return found[found[:, 2] > 0.2][:count]


LIGHTS, VIEWS = hemisphere(500, 1), hemisphere(500, 2)


def relative(found, true):
    return np.sqrt(((found - true) ** 2).mean() / (true**2).mean())


# ------------------------------------------------------------------------------------------------ maps


def test_a_map_holds_a_function_of_directions():
    texels = hemisphere_maps.directions(64)
    image = filled_by(texels, 64)
    assert np.abs(hemisphere_maps.look_up(image, LIGHTS)[:, 0] - LIGHTS[:, 0] ** 2).max() < 2e-3
    cube = hemisphere_maps.cube(image, 64)
    assert cube.shape == (6, 64, 64, 3)
    # Straight up, and below the horizon as on it.
    assert np.abs(cube[4, 31:33, 31:33, 2] - 1.0).max() < 2e-3
    assert np.abs(cube[5, 31, 0] - hemisphere_maps.look_up(image, np.array([1.0, 0.0, 0.0]))).max() < 0.1


def filled_by(texels, size):
    values = texels.reshape(-1, 3)[hemisphere_maps.inside(size)]
    return hemisphere_maps.filled(values * values, size)


def test_coordinates_are_divided_by_their_last():
    place = hemisphere_maps.coordinates(LIGHTS)
    s, t = (place[:, :2] / place[:, 3:]).T * 2.0 - 1.0
    assert np.abs(s - LIGHTS[:, 0] / (1.0 + LIGHTS[:, 2])).max() < 1e-12
    assert np.abs(t - LIGHTS[:, 1] / (1.0 + LIGHTS[:, 2])).max() < 1e-12
    assert (hemisphere_maps.coordinates(np.array([[0.0, 0.0, -1.0]]))[:, 3] >= 0.0).all()


def test_solid_angles_sum_to_the_hemisphere():
    assert hemisphere_maps.solid_angles(64).sum() == pytest.approx(2.0 * np.pi, rel=5e-3)


def test_half_and_difference_go_back_to_light_and_view():
    half, difference = hemisphere_maps.halfway_and_difference(LIGHTS, VIEWS)
    lights, views = hemisphere_maps.light_and_view(half, difference)
    assert np.abs(lights - LIGHTS).max() < 1e-12
    assert np.abs(views - VIEWS).max() < 1e-12
    assert np.abs(difference[:, 2] - dot(half, LIGHTS)).max() < 1e-12


# ------------------------------------------------------------------------------------------- separable


def product(lights, views):
    """A product of a function of light and one of view, each a colour."""
    first = 0.5 + lights[:, :1] * np.array([0.4, -0.2, 0.1])
    return first * (0.6 + views[:, 1:2] * np.array([0.1, 0.3, -0.4]))


def test_one_term_is_exact_for_a_product():
    table = separable_factors.table(Made(product), 16, Halves.LIGHT_AND_VIEW)
    for way in Fit:
        factors = separable_factors.factored(table, 1, way)
        assert table.error(factors.values()) < 1e-9 or way is Fit.NORMS
        assert relative(factors.at(LIGHTS, VIEWS), product(LIGHTS, VIEWS)) < 0.01
        assert (factors.first >= 0.0).all() and (factors.second >= 0.0).all()


def three_products(lights, views):
    return product(lights, views) + (0.3 * lights[:, 1:2] + 0.1 * lights[:, :1]) * views[:, :1] + 0.2


def test_terms_are_those_of_the_singular_value_decomposition():
    table = separable_factors.table(
        Made(
            lambda light, view: (
                product(light, view) + (0.3 * light[:, 1:2] + 0.1 * light[:, :1]) * view[:, :1] + 0.2
            )
        ),
        8,
        Halves.LIGHT_AND_VIEW,
    )
    # Weights that are a product of two become part of the matrix.
    one = np.sqrt(np.diagonal(table.weights))
    for terms in (1, 2, 3):
        got = separable_factors.factored(table, terms).values()
        for k in range(3):
            scaled = one[:, None] * table.samples[..., k] * one[None]
            u, s, v = np.linalg.svd(scaled)
            best = (u[:, :terms] * s[:terms]) @ v[:terms]
            away = one[:, None] * got[..., k] * one[None] - scaled
            assert np.linalg.norm(away) <= np.linalg.norm(best - scaled) * 1.02 + 1e-9


def test_each_term_makes_the_error_smaller():
    brdf = AnalyticBRDF(BRDFS["lafortune"])
    table = separable_factors.table(brdf, 16)
    errors = [table.error(separable_factors.factored(table, terms).values()) for terms in (1, 2, 3)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[0] < table.error(separable_factors.factored(table, 1, Fit.NORMS).values())


def test_a_highlight_is_a_function_of_the_halfway_vector():
    """Blinn's highlight over the cosine is nearly a product by halves, and nothing like one by l and v."""
    brdf = AnalyticBRDF(BRDFS["schlick"])
    by_halves, by_directions = (separable_factors.table(brdf, 16, halves) for halves in Halves)
    errors = [table.error(separable_factors.factored(table).values()) for table in (by_halves, by_directions)]
    assert errors[0] < 0.1 < 0.5 < errors[1]


def test_a_white_surface_is_constant_factors():
    table = separable_factors.table(AnalyticBRDF(BRDFS["lambert"]), 8)
    factors = separable_factors.factored(table)
    assert np.abs(factors.second - 1.0).max() < 1e-4
    assert np.abs(factors.first - 1.0 / np.pi).max() < 1e-4


def test_a_black_surface_is_black():
    table = separable_factors.table(Made(lambda light, view: 0.0 * light), 8)
    factors = separable_factors.factored(table, 2)
    assert not factors.at(LIGHTS, VIEWS).any()
    assert table.error(factors.values()) == 0.0


# ----------------------------------------------------------------------------------------- homomorphic


def powers(lights, views):
    """p(l) q(h) p(v) of smooth functions, whatever the maps are."""
    half = normalize(lights + views)
    p = [np.exp(0.5 * w[:, :1] * np.array([1.0, 0.2, -0.4])) for w in (lights, views)]
    return p[0] * p[1] * np.exp(np.array([1.0, 2.0, 0.5]) * (half[:, 2:] - 1.0))


def test_homomorphic_factors_find_a_product_of_three():
    factors = homomorphic_factors.factored(Made(powers), 32)
    assert relative(factors.at(LIGHTS, VIEWS), powers(LIGHTS, VIEWS)) < 0.02
    for image in (factors.direction, factors.half):
        assert (image > 0.0).all()
        assert np.abs(image.max(axis=(0, 1)) - 1.0).max() < 1e-12


def test_light_and_view_may_change_places():
    factors = homomorphic_factors.factored(Made(powers), 16)
    assert np.abs(factors.at(LIGHTS, VIEWS) / factors.at(VIEWS, LIGHTS) - 1.0).max() < 1e-12


def test_a_colour_that_is_nowhere_is_dark_and_does_not_spoil_the_others():
    red = homomorphic_factors.factored(
        Made(lambda light, view: powers(light, view) * np.array([1.0, 0.0, 0.0])), 8
    )
    found = red.at(LIGHTS, VIEWS)
    assert relative(found[:, 0], powers(LIGHTS, VIEWS)[:, 0]) < 0.1
    assert found[:, 1:].max() < 1e-4


# --------------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize("size", (0, 3, 4.5, 65, True))
def test_maps_have_texels(size):
    for make in (separable_factors.table, homomorphic_factors.factored):
        with pytest.raises(ValueError, match="4 or more"):
            make(Made(product), size)


@pytest.mark.parametrize("terms", (0, 9, 1.5, True))
def test_terms_are_whole_numbers(terms):
    table = separable_factors.table(Made(product), 4)
    with pytest.raises(ValueError, match="terms"):
        separable_factors.factored(table, terms)


def test_norms_have_one_term():
    table = separable_factors.table(Made(product), 4)
    with pytest.raises(ValueError, match="from 1 to 1"):
        separable_factors.factored(table, 2, Fit.NORMS)


@pytest.mark.parametrize("smoothness", (0.0, -1.0, np.nan, np.inf))
def test_smoothness_is_positive(smoothness):
    with pytest.raises(ValueError, match="smoothness"):
        homomorphic_factors.factored(Made(product), 4, smoothness)


def test_nothing_cannot_be_factored():
    with pytest.raises(ValueError, match="zero everywhere"):
        homomorphic_factors.factored(Made(lambda light, view: 0.0 * light), 4)


@pytest.mark.parametrize("bad", (np.nan, np.inf))
def test_a_brdf_is_finite(bad):
    for make in (separable_factors.table, homomorphic_factors.factored):
        with pytest.raises(ValueError, match="finite"):
            make(Made(lambda light, view: light * bad), 4)


def test_a_brdf_gives_colours():
    with pytest.raises(ValueError, match="shape"):
        separable_factors.table(Made(lambda light, view: light[:, 0]), 4)


def test_samples_have_the_tables_shape():
    with pytest.raises(ValueError, match="shape"):
        separable_factors.table_of(np.zeros((3, 3, 3)), 8)
    with pytest.raises(ValueError, match="light and view"):
        separable_factors.table_of(np.zeros((3, 3, 3)), 8, Halves.HALFWAY_AND_DIFFERENCE)
