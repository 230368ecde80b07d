"""The Blinn-Phong model with N per texel through the host's lookup, against the model in float64."""

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view, perspective_view
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.reflectance import blinn_phong_by_host, brdfs, material_textures
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL
from tests.effects.reflectance.test_pixel_textures import LIGHT, SIZE, VIEW, material

PANEL = Panel(0, 0, SIZE, SIZE)


def commands(profile, surface, m, view, light, **more):
    loading, names = material_textures.load(m, "material", profile)
    effect = blinn_phong_by_host.blinn_phong(surface, names, view, light, profile, sampler=NEAREST, **more)
    return (PANEL.clear((0.0, 0.0, 0.0)), *loading, *effect)


# The material's alphas go down to 0.2: what is drawn is compared with what textures hold.
@pytest.mark.filterwarnings("ignore:The textures of material hold alphas:UserWarning")
def test_the_host_s_blinn_phong_is_the_float_model_on_a_flat_surface():
    m = material()
    half = brdfs.half_vector(LIGHT, VIEW)
    alphas = np.maximum(m.alpha_x, 0.25), m.alpha_y  # what the stored vectors allow
    lobe = half, m.tangents, m.binormals, *alphas
    expected = brdfs.anisotropic_blinn_phong(*lobe, m.k_s, m.exponent)
    scene = surfaces.plane(), m, orthographic_view(PANEL), Light(tuple(LIGHT))
    ideal = execute_ideal(commands(IDEAL, *scene), SIZE, SIZE).color[::-1, :, 0]
    assert np.abs(ideal - expected).max() <= 0.04  # the table's, as on the Octane
    picture = execute(commands(GEFORCE_256, *scene), GEFORCE_256, SIZE, SIZE).framebuffer.color
    error = picture[::-1, :, 0] / 255.0 - expected
    # Vectors of bytes leave e of Eq. 1 an RMS of 0.0061 at alpha 1/2 (the catalogue's P9), which N up to 32
    # multiplies. Measured: 0.013.
    assert np.sqrt((error * error).mean()) <= 0.018


def test_the_host_s_lookup_takes_curved_surfaces_and_near_lights():
    m = material_textures.isotropic(4, 4, 0.5)
    surface, light = surfaces.sphere(24, 14), Light((1.0, 1.0, 3.0), point=True)
    view = perspective_view(PANEL, (0.0, 0.0, 5.0))
    picture = execute_ideal(commands(IDEAL, surface, m, view, light), SIZE, SIZE).color[..., 0]
    # N = 2: Eq. 1; the highlight's middle is where n is the halfway vector of a point near it.
    row, column = np.unravel_index(np.argmax(picture), picture.shape)
    assert picture.max() > 0.98
    toward = normalize(np.array([0.35, 0.35, 0.87]))
    where = np.array([column + 0.5, SIZE - row - 0.5]) / SIZE * 2.0 - 1.0
    assert np.abs(where / np.abs(where).max() - toward[:2] / toward[:2].max()).max() < 0.35


def test_coordinates_are_the_codes_of_n_and_e():
    pixels = np.zeros((1, 4, 4), np.uint8)
    pixels[0, :, 0] = (0, 10, 20, 255)
    pixels[0, :, 3] = (0, 2, 4, 255)  # 128 A / 255: less than 1, 1.004, 2.008, 128
    found = blinn_phong_by_host.coordinates(pixels)
    assert found[0, :, 0].tolist() == [0, 0, 37, 255]
    assert found[0, :, 1].tolist() == [0, 10, 20, 255]
    assert (found[..., 3] == 255).all()
    exact = blinn_phong_by_host.coordinates(pixels / 255.0)
    assert np.abs(exact - found / 255.0).max() < 0.003


# The material's alphas go down to 0.2: what is drawn is compared with what textures hold.
@pytest.mark.filterwarnings("ignore:The textures of material hold alphas:UserWarning")
def test_without_the_exponent_the_host_looks_up_the_root():
    m = material()
    half = brdfs.half_vector(LIGHT, VIEW)
    lobe = half, m.tangents, m.binormals, np.maximum(m.alpha_x, 0.25), m.alpha_y
    scene = surfaces.plane(), m, orthographic_view(PANEL), Light(tuple(LIGHT))
    ideal = execute_ideal(commands(IDEAL, *scene, with_exponent=False), SIZE, SIZE).color[::-1, :, 0]
    # Within half of one of 2048 texels of e = 0 the root is that of zero.
    assert np.abs(ideal - brdfs.anisotropic_blinn_phong(*lobe, m.k_s, 1.0)).max() <= np.sqrt(0.5 / 2048)
