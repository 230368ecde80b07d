"""One table for Phong's, Blinn's and the cosine lobe's model (H11): what it holds, where it is read."""

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view, perspective_view
from fixedpipe.effects.reflectance import brdfs, phong_tables
from fixedpipe.effects.reflectance.phong_tables import Cosine
from fixedpipe.pipeline.profiles import OPENGL_1_2

COLORS = {"ambient": (0.1, 0.1, 0.1), "diffuse": (0.5, 0.4, 0.3), "specular": (0.3, 0.4, 0.5)}
SPHERE = surfaces.sphere(12, 7)
VIEW = orthographic_view(Panel(0, 0, 16, 16))
LAMP = Light((-0.4, 0.5, 0.8))


@pytest.mark.parametrize("exponent", [1, 2, 7, 30, 128])
def test_a_power_is_the_product(exponent):
    base = np.linspace(0.0, 1.0, 33)
    assert phong_tables.power(base, exponent) == pytest.approx(base**exponent, rel=1e-12, abs=1e-300)


@pytest.mark.parametrize("cosine", Cosine)
def test_a_table_holds_the_model_at_its_texels(cosine):
    texels = 16
    image = phong_tables.load("t", OPENGL_1_2, 5, cosine, texels=texels, **COLORS).image
    values = np.asarray(image.levels[0])[0][..., :3]
    for row in range(texels):
        for column in range(texels):
            lit, t = column / (texels - 1), row / (texels - 1)
            last = t**5 * (lit if cosine is Cosine.LOBE else float(lit > 0.0))
            for k in range(3):
                expected = COLORS["ambient"][k] + COLORS["diffuse"][k] * lit + COLORS["specular"][k] * last
                assert values[row, column, k] == int(255.0 * min(expected, 1.0) + 0.5)


def test_zero_and_one_are_the_middles_of_the_first_and_the_last_texel():
    assert phong_tables.placed(np.array((0.0, 1.0)), 256) * 256 == pytest.approx([0.5, 255.5])


@pytest.mark.parametrize(
    ("cosine", "model"), [(Cosine.HALF, brdfs.blinn_phong), (Cosine.REFLECTED, brdfs.phong)]
)
def test_coordinates_at_vertices_are_the_model_s_cosines(cosine, model):
    found = phong_tables.coordinates(SPHERE, VIEW, LAMP, cosine)
    lit, other = ((found * 256 - 0.5) / 255).T
    light, viewer = LAMP.light_vectors(SPHERE.positions), VIEW.view_vectors(SPHERE.positions)
    assert lit == pytest.approx(dot(SPHERE.normals, light), abs=1e-12)
    if cosine is Cosine.HALF:
        expected = model(SPHERE.normals, brdfs.half_vector(light, viewer), 1.0)
    else:
        expected = model(light, viewer, SPHERE.normals, 1.0)
    # 1e-5: normals of 20 bits are not quite of length one.
    assert np.maximum(other, 0.0) == pytest.approx(expected, abs=1e-5)


def test_a_lobe_with_phong_s_coefficients_is_phong_s():
    phong = phong_tables.coordinates(SPHERE, VIEW, LAMP, Cosine.REFLECTED)
    lobe = phong_tables.coordinates(SPHERE, VIEW, LAMP, Cosine.LOBE, (-1.0, 1.0))
    # 1e-5: frames of 20 bits are not quite orthonormal.
    assert lobe == pytest.approx(phong, abs=1e-5)


def test_the_texture_matrix_makes_what_the_host_makes():
    state = phong_tables.matrix_pass(SPHERE, VIEW, LAMP, "t").state
    matrix = np.array(state.texture_units[0].matrix)
    made = np.concatenate([SPHERE.normals, np.ones((len(SPHERE.normals), 1))], axis=1) @ matrix.T
    host = phong_tables.coordinates(SPHERE, VIEW, LAMP, Cosine.HALF)
    assert made[:, :2] == pytest.approx(host, abs=1e-12)
    assert (made[:, 3] == 1.0).all()


def test_what_cannot_be_drawn_is_said():
    near = perspective_view(VIEW.panel, (0.0, 0.0, 5.0))
    with pytest.raises(ValueError, match="The viewer is near"):
        phong_tables.matrix_pass(SPHERE, near, LAMP, "t")
    with pytest.raises(ValueError, match="The light is near"):
        phong_tables.matrix_pass(SPHERE, VIEW, Light((0.0, 0.0, 3.0), point=True), "t")
    with pytest.raises(ValueError, match="needs its coefficients"):
        phong_tables.coordinates(SPHERE, VIEW, LAMP, Cosine.LOBE)
    with pytest.raises(ValueError, match="shininess reaches from 0 to 128"):
        phong_tables.lighting_pass(SPHERE, VIEW, LAMP, 200, **COLORS)
    for exponent in (0, 1.5, -3):
        with pytest.raises(ValueError, match="whole number from 1"):
            phong_tables.load("t", OPENGL_1_2, exponent, Cosine.HALF, **COLORS)
