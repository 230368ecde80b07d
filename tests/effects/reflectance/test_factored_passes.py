"""Products of factor textures draw pi f_r (n.l)+, whatever means a machine has, and leave what is behind."""

import numpy as np
import pytest

from fixedpipe.effects.geometry.surfaces import plane, sphere
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Light, orthographic_view, row_of_panels
from fixedpipe.effects.reflectance import factored_passes, homomorphic_factors, separable_factors
from fixedpipe.effects.reflectance.brdfs import BRDFS
from fixedpipe.effects.reflectance.factored_passes import Means, Storage
from fixedpipe.effects.reflectance.hemisphere_maps import AnalyticBRDF, Halves
from fixedpipe.effects.reflectance.separable_factors import SeparableFactors
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL, PROFILES

SIZE = 48
BEHIND = (0.25, 0.5, 0.125)
LIGHT = Light((0.3, 0.4, 1.0))
MACHINES = tuple(key for key, profile in PROFILES.items() if not profile.arithmetic.exact)


class Made:
    """A BRDF from a function."""

    def __init__(self, function):
        self.at = function


def colored(lights, views):
    """A sum of two products, of which the second has a sign; red falls with l.x, blue rises with v.x."""
    tilted = lights[:, :1] * views[:, :1] * np.array([0.5, 0.0, -0.5])
    return (0.5 + 0.3 * tilted + 0.1 * views[:, 1:2]) * np.array([0.6, 0.5, 0.4]) / np.pi


@pytest.fixture(scope="module")
def two_terms():
    return separable_factors.factored(separable_factors.table(Made(colored), 16, Halves.LIGHT_AND_VIEW), 3)


@pytest.fixture(scope="module")
def homomorphic():
    return homomorphic_factors.factored(Made(lambda light, view: colored(light, view) + 0.05), 16)


def picture(factors, profile, light=LIGHT, surface=None, board=None, intensity=1.0):
    """RGB [SIZE, SIZE, 3], the bottom row first, of factors on a ball."""
    (panel,) = row_of_panels(1, SIZE)
    view = orthographic_view(panel, 1.2)
    loading, loaded = factored_passes.load(factors, "f", profile, intensity=intensity, board=board)
    frame = (
        panel.clear(BEHIND),
        *loading,
        *factored_passes.passes(surface or sphere(24, 13), loaded, view, light),
    )
    if profile.arithmetic.exact:
        return np.clip(execute_ideal(frame, SIZE, SIZE).color[::-1, :, :3], 0.0, 1.0)
    buffer = execute(frame, profile, SIZE, SIZE).framebuffer
    return buffer.color[::-1, :, :3] / (2.0**buffer.color_bits - 1.0)


def expected(brdf, light=(0.3, 0.4, 1.0), intensity=1.0):
    """The same of the ball's own normals, and the pixels that are well inside."""
    edge = ((np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0) * 1.2
    x, y = np.meshgrid(edge, edge)
    inside = x * x + y * y < 0.75
    normal = np.stack([x, y, np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))], axis=-1)[inside]
    tangent = normalize(np.stack([normal[:, 2], 0 * normal[:, 0], -normal[:, 0]], axis=-1))
    binormal = np.cross(normal, tangent)
    toward = normalize(np.array(light))
    frame = np.stack([tangent, binormal, normal], axis=1)
    lights, views = frame @ toward, frame @ np.array([0.0, 0.0, 1.0])
    lit = lights[:, 2] > 1e-3
    out = np.zeros((len(lights), 3))
    out[lit] = np.pi * intensity * brdf.at(lights[lit], views[lit]) * lights[lit, 2:]
    return inside, np.clip(out, 0.0, 1.0)


def away(image, brdf, **settings):
    inside, true = expected(brdf, **settings)
    return np.sqrt(((image[inside] - true) ** 2).mean())


@pytest.mark.parametrize("machine", MACHINES)
def test_every_machine_draws_separable_factors(machine, two_terms):
    image = picture(two_terms, PROFILES[machine])
    assert away(image, Made(colored)) < 0.015
    # The corner is what was there before.
    assert np.abs(image[0, 0] - BEHIND).max() < 0.005


@pytest.mark.parametrize("machine", MACHINES)
def test_every_machine_draws_homomorphic_factors(machine, homomorphic):
    image = picture(homomorphic, PROFILES[machine])
    assert away(image, homomorphic) < 0.015
    assert np.abs(image[0, 0] - BEHIND).max() < 0.005


@pytest.mark.parametrize("means", Means)
@pytest.mark.parametrize("storage", Storage)
@pytest.mark.parametrize("units", (1, 2, 4))
@pytest.mark.parametrize("subtracts", (False, True))
def test_all_means_have_one_ideal(means, storage, units, subtracts, two_terms):
    if means is Means.COMBINERS and units == 1:
        pytest.skip("combiners have two units")
    if means is Means.BLENDING and units == 1:
        pytest.skip("one unit has no place for a second product")
    board = factored_passes.Board(means, storage, units, subtracts)
    image = picture(two_terms, IDEAL, board=board)
    assert away(image, Made(colored)) < 0.008


def test_signs_count(two_terms):
    """Without the terms that have signs the picture is clearly another."""
    one = SeparableFactors(two_terms.halves, two_terms.first[:1], two_terms.second[:1])
    for machine in ("GEFORCE_256", "GEFORCE_3", "MULTITEXTURE", "OPENGL_1_2"):
        less = away(picture(one, PROFILES[machine]), Made(colored))
        assert less > 2.5 * away(picture(two_terms, PROFILES[machine]), Made(colored))


@pytest.mark.parametrize("machine", ("GEFORCE_256", "MULTITEXTURE", "OPENGL_1_2"))
@pytest.mark.parametrize("intensity", (1.7, 3.5))
def test_a_bright_light_is_made_by_doubling(machine, intensity):
    white = Made(lambda light, view: 0.0 * light + np.array([0.9, 0.5, 0.2]) / np.pi)
    for factors in (
        separable_factors.factored(separable_factors.table(white, 8)),
        homomorphic_factors.factored(white, 8),
    ):
        image = picture(factors, PROFILES[machine], intensity=intensity)
        assert away(image, white, intensity=intensity) < 0.02


def test_a_highlight_is_where_the_model_has_it():
    brdf = AnalyticBRDF(BRDFS["ward_bounded"], {"alpha_x": 0.3, "alpha_y": 0.3, "specular": 0.4})
    factors = separable_factors.factored(separable_factors.table(brdf, 32))
    assert away(picture(factors, PROFILES["GEFORCE_3"]), brdf) < 0.04


def test_what_faces_away_from_the_light_is_dark(two_terms):
    image = picture(two_terms, PROFILES["GEFORCE_256"], Light((1.0, 0.0, -0.2)))
    assert image[SIZE // 2, SIZE // 4].max() == 0.0
    assert image[SIZE // 2, SIZE - SIZE // 6].max() > 0.05


def test_a_lamp_near_by_lights_a_plane_round_about_its_foot(homomorphic):
    flat = plane(16, 16)
    image = picture(homomorphic, PROFILES["GEFORCE_256"], Light((0.5, 0.0, 0.4), point=True), flat)
    row = image[SIZE // 2, 6:-6].sum(axis=-1)
    assert 0.55 < np.argmax(row) / len(row) < 0.85


@pytest.mark.parametrize("intensity", (0.0, -1.0, np.nan, np.inf))
def test_a_light_is_bright(intensity, homomorphic):
    with pytest.raises(ValueError, match="intensity"):
        factored_passes.load(homomorphic, "f", IDEAL, intensity=intensity)


def test_a_machine_without_cube_maps_refuses_them():
    with pytest.raises(ValueError, match="no cube maps"):
        factored_passes.board_of(PROFILES["OCTANE"], Storage.CUBE)
    assert factored_passes.board_of(PROFILES["GEFORCE_256"], Storage.PARABOLIC).storage is Storage.PARABOLIC
