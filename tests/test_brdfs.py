"""The reflectance models against their closed forms."""

import numpy as np
import pytest

from effects import brdfs
from effects.vectors import cross, dot, from_frame, in_frame, normalize, unit_vector


def random_frames(count, seed=1):
    random = np.random.Generator(np.random.PCG64(seed))
    normals = normalize(random.standard_normal((count, 3)))
    tangents = normalize(cross(normals, random.standard_normal((count, 3))))
    return normals, tangents, cross(normals, tangents)


def random_directions(count, seed=2):
    return normalize(np.random.Generator(np.random.PCG64(seed)).standard_normal((count, 3)))


@pytest.mark.parametrize("exponent", [1.0, 2.0, 7.0])
def test_the_anisotropic_model_with_alpha_one_is_blinn_phong_without_its_sign(exponent):
    normals, tangents, binormals = random_frames(500)
    half = random_directions(500)
    anisotropic = brdfs.anisotropic_blinn_phong(half, tangents, binormals, 1.0, 1.0, exponent=exponent)
    assert np.allclose(anisotropic, np.abs(dot(half, normals)) ** exponent, atol=1e-12)
    in_front = dot(half, normals) > 0
    blinn = brdfs.blinn_phong(normals, half, exponent)
    assert np.allclose(anisotropic[in_front], blinn[in_front], atol=1e-12)
    assert (blinn[~in_front] == 0).all()


def test_eq_1_is_the_model_at_exponent_two():
    _, tangents, binormals = random_frames(200)
    half = random_directions(200)
    e = brdfs.lobe(half, tangents, binormals, 0.5, 0.8)
    model = brdfs.anisotropic_blinn_phong(half, tangents, binormals, 0.5, 0.8, specular=0.6, exponent=2.0)
    assert np.array_equal(model, 0.6 * e)
    assert np.allclose(model, 0.6 * np.sqrt(e) ** 2.0, atol=1e-15)


@pytest.mark.parametrize("alpha", [0.25, 0.4, 1.0])
def test_the_lobe_falls_to_one_half_at_its_half_width(alpha):
    tangent, binormal, normal = np.eye(3)
    sine = brdfs.half_width(alpha)
    half = sine * tangent + np.sqrt(1 - sine**2) * normal
    assert brdfs.lobe(half, tangent, binormal, alpha, 0.9) == pytest.approx(0.5, abs=1e-14)
    assert brdfs.lobe(half, binormal, tangent, 0.9, alpha) == pytest.approx(0.5, abs=1e-14)


def test_the_lobe_is_even_and_lies_between_zero_and_one():
    _, tangents, binormals = random_frames(300)
    half = random_directions(300)
    e = brdfs.lobe(half, tangents, binormals, 0.3, 0.7)
    assert np.array_equal(e, brdfs.lobe(-half, tangents, binormals, 0.3, 0.7))
    assert e.min() == 0.0
    assert e.max() <= 1.0


def test_the_halfway_vector_makes_equal_angles_with_light_and_view():
    light, view = random_directions(100, 3), random_directions(100, 4)
    half = brdfs.half_vector(light, view)
    assert np.allclose(dot(half, light), dot(half, view), atol=1e-12)
    assert np.allclose(dot(half, half), 1.0, atol=1e-12)


def test_lambert_is_the_cosine_and_zero_behind():
    assert brdfs.lambert(np.array([0.0, 0.0, 1.0]), np.array([0.6, 0.0, 0.8])) == 0.8
    assert brdfs.lambert(np.array([0.0, 0.0, 1.0]), np.array([0.6, 0.0, -0.8])) == 0.0


def test_coordinates_in_a_frame_lead_back_to_the_vector():
    normals, tangents, binormals = random_frames(100)
    vectors = random_directions(100, 9)
    local = in_frame(vectors, tangents, binormals, normals)
    assert np.allclose(from_frame(local, tangents, binormals, normals), vectors, atol=1e-12)


def test_a_zero_vector_stays_zero_when_normalized():
    assert np.array_equal(normalize(np.zeros((2, 3))), np.zeros((2, 3)))


@pytest.mark.parametrize("vector", [(0, 0, 0), (1, 2), (1, np.nan, 0), (np.inf, 0, 0)])
def test_a_direction_that_is_none_is_refused_in_a_sentence(vector):
    with pytest.raises(ValueError, match=r"The light is .*; give three finite numbers, not all zero\."):
        unit_vector(vector, "The light")
