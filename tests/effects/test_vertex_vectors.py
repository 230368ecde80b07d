"""Per-vertex work in software: reflection, refraction, vectors in local frames, dot products."""

import math

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import TRIGONOMETRY_STEP, cross, dot, from_frame, normalize
from fixedpipe.effects.geometry.vertex_vectors import (
    dot_products,
    half_vectors,
    light_vectors,
    reflected,
    reflection_vectors,
    refracted,
    refraction_vectors,
    view_vectors,
)
from fixedpipe.effects.geometry.views import Light, Panel, perspective_view
from fixedpipe.pipeline.enums import TexGenMode
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.state import PassState, TexGen, TextureUnit
from fixedpipe.pipeline.vertices import stage

GLASS = 1.0 / 1.5


def directions(count, seed):
    return normalize(np.random.Generator(np.random.PCG64(seed)).standard_normal((count, 3)))


NORMALS = directions(500, 1)
VECTORS = directions(500, 2)
FACING = VECTORS * np.sign(dot(NORMALS, VECTORS))[:, None]


def sine_to(vectors, normals):
    """Sine of the angle between unit vectors."""
    across = cross(vectors, normals)
    return np.sqrt(dot(across, across))


def test_a_reflection_has_the_angle_and_the_plane_of_what_is_reflected():
    out = reflected(VECTORS, NORMALS)
    assert np.allclose(dot(out, NORMALS), dot(VECTORS, NORMALS), atol=1e-14)
    assert np.allclose(dot(out, out), 1.0, atol=1e-14)
    assert np.allclose(dot(cross(VECTORS, NORMALS), out), 0.0, atol=1e-14)
    assert np.allclose(reflected(out, NORMALS), VECTORS, atol=1e-14)


def test_a_reflection_keeps_lengths():
    assert np.allclose(reflected(3.0 * VECTORS, NORMALS), 3.0 * reflected(VECTORS, NORMALS), atol=1e-14)


@pytest.mark.parametrize("ratio", [GLASS, 1.0 / 2.4, 0.999])
def test_refraction_follows_snells_law(ratio):
    out, totally = refracted(FACING, NORMALS, ratio)
    assert not totally.any()
    assert np.allclose(sine_to(out, NORMALS), ratio * sine_to(FACING, NORMALS), atol=1e-14)
    assert np.allclose(dot(out, out), 1.0, atol=1e-14)
    assert (dot(out, NORMALS) < 0).all()  # on the other side
    assert np.allclose(dot(cross(FACING, NORMALS), out), 0.0, atol=1e-14)  # in the same plane


def test_without_a_change_of_medium_a_ray_goes_straight_on():
    out, totally = refracted(VECTORS, NORMALS, 1.0)
    assert not totally.any()
    assert np.allclose(out, -VECTORS, atol=1e-14)


def test_a_refracted_ray_finds_its_way_back():
    inward, _ = refracted(FACING, NORMALS, GLASS)
    outward, totally = refracted(inward, NORMALS, GLASS)  # inward lies behind the surface: it leaves
    assert not totally.any()
    assert np.allclose(outward, FACING, atol=1e-12)


def test_beyond_the_critical_angle_everything_is_reflected():
    # Source: Snell's law: from glass, the sine of the critical angle is 1 / 1.5.
    normal = np.array([0.0, 0.0, 1.0])
    critical = math.asin(GLASS)
    for angle, total in ((critical - 1e-6, False), (critical + 1e-6, True), (1.5, True), (0.0, False)):
        inside = np.array([math.sin(angle), 0.0, -math.cos(angle)])
        out, totally = refracted(inside, normal, GLASS)
        assert totally == total
        assert (out[2] < 0) == total
        if total:
            assert np.allclose(out, reflected(inside, normal))


def test_into_a_thinner_medium_there_is_a_critical_angle_too():
    out, totally = refracted(FACING, NORMALS, 1.5)
    assert np.array_equal(totally, 1.5 * sine_to(FACING, NORMALS) > 1.0)
    assert 0 < totally.sum() < len(totally)
    assert np.isfinite(out).all()
    assert np.allclose(out[totally], reflected(FACING, NORMALS)[totally], atol=1e-14)


@pytest.mark.parametrize("ratio", [0.0, -1.0, math.nan, math.inf])
def test_a_ratio_that_no_media_have_is_refused(ratio):
    with pytest.raises(ValueError, match="give a positive number"):
        refracted(FACING, NORMALS, ratio)


ROUNDED = 4.0 * TRIGONOMETRY_STEP  # a sphere's frames are of rounded sines and cosines
SPHERE = surfaces.sphere(12, 8)
VIEW = perspective_view(Panel(0, 0, 64, 64), (0.5, 1.0, 4.0))
LIGHT = Light((1.0, 2.0, 3.0), point=True)


def in_world(local):
    return from_frame(local, SPHERE.tangents, SPHERE.binormals, SPHERE.normals)


def test_vectors_in_the_local_frames_are_those_of_the_world():
    to_light, to_eye = LIGHT.light_vectors(SPHERE.positions), VIEW.view_vectors(SPHERE.positions)
    assert np.allclose(in_world(light_vectors(SPHERE, LIGHT)), to_light, atol=ROUNDED)
    assert np.allclose(in_world(view_vectors(SPHERE, VIEW)), to_eye, atol=ROUNDED)
    halfway = in_world(half_vectors(SPHERE, VIEW, LIGHT))
    assert np.allclose(halfway, normalize(to_light + to_eye), atol=ROUNDED)


def test_the_eyes_reflection_is_what_reflection_map_generates():
    # NV_texgen_reflection works in eye coordinates, which the view turns the world's into.
    gen = (TexGen(TexGenMode.REFLECTION_MAP),) * 3 + (TexGen(),)
    state = PassState(vertex=VIEW.vertex, texture_units=(TextureUnit(texture="cube", gen=gen),))
    generated = stage.process(SPHERE.mesh(), state, IDEAL, 64, 64).coordinates[:, 0, :3]
    turn = np.array(VIEW.modelview)[:3, :3]
    expected = np.stack([dot(reflection_vectors(SPHERE, VIEW), row) for row in turn], axis=-1)
    assert np.allclose(generated[: len(expected)], expected, atol=ROUNDED)


def test_refraction_vectors_point_into_the_sphere_where_the_eye_sees_it():
    out, totally = refraction_vectors(SPHERE, VIEW, GLASS)
    seen = dot(VIEW.view_vectors(SPHERE.positions), SPHERE.normals) > 0
    assert (dot(out, SPHERE.normals)[seen] < 0).all()
    assert not totally[seen].any()
    assert totally[~seen].any()  # near the silhouette the far side reflects inwards


def test_dot_products_are_texture_coordinates():
    # Heidrich 2001, Eq. 2 and 3: one vector for all vertices, or one each.
    light = np.array([0.0, 0.0, 1.0])
    coordinates = dot_products((light, NORMALS), (VECTORS, NORMALS))
    assert coordinates.shape == (500, 2)
    assert np.array_equal(coordinates[:, 0], NORMALS[:, 2])
    assert np.array_equal(coordinates[:, 1], dot(VECTORS, NORMALS))
    biased = dot_products((light, NORMALS), (VECTORS, NORMALS), biased=True)
    assert np.array_equal(biased, (1.0 + coordinates) / 2.0)
    assert biased.min() >= 0 and biased.max() <= 1
    assert dot_products((light, light), (light, NORMALS)).shape == (500, 2)


@pytest.mark.parametrize("count", [0, 5])
def test_as_many_dot_products_as_coordinates_are_asked_for(count):
    with pytest.raises(ValueError, match=f"^{count} pairs of vectors make no texture coordinates"):
        dot_products(*[(NORMALS, VECTORS)] * count)
