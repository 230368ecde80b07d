"""H15 and H16, Banks's model by the texture matrix on surfaces and on lines: against the directions on a cone
that a thread reflects, one after the other; lights that add; what is refused.
"""

import math

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view, perspective_view
from fixedpipe.effects.reflectance import banks_texture_matrix as banks
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL, OPENGL_1_2

PANEL = Panel(0, 0, 32, 32)
VIEW = orthographic_view(PANEL)
WHITE = (1.0, 1.0, 1.0)
MODEL = {"diffuse": 0.3, "specular": 0.7, "exponent": 12.0}


def by_turning(light, view, tangent, diffuse, specular, exponent, count=3600):
    """The thread's light by trying ``count`` normals round it: the nearest to the light gives the diffuse
    part, the one that mirrors the light nearest to the viewer the highlight.
    """
    first = normalize(cross(tangent, np.array([0.31, 0.52, 0.79])))
    angle = 2.0 * math.pi * np.arange(count)[:, None] / count
    normals = np.cos(angle) * first + np.sin(angle) * cross(tangent, first)
    nearest = dot(normals, light).max()
    mirrored = dot(reflected(light, normals), view).max()
    return diffuse * nearest + specular * max(0.0, mirrored) ** exponent


@pytest.mark.parametrize("seed", range(20))
def test_the_table_holds_what_the_thread_s_normals_reflect(seed):
    random = np.random.Generator(np.random.PCG64(seed))
    light, view, tangent = normalize(random.standard_normal((3, 3)))
    found = banks.thread(dot(light, tangent), dot(view, tangent), **MODEL)
    assert found == pytest.approx(by_turning(light, view, tangent, **MODEL), abs=1e-4)


def square(profile, tangent, lights):
    plane = surfaces.plane()
    tangents = np.tile(tangent, (len(plane.positions), 1))
    return (
        PANEL.clear((0.0, 0.0, 0.0)),
        banks.load_threads("threads", profile, **MODEL),
        *banks.banks_passes(plane, tangents, VIEW, lights, "threads", color=(1.0, 0.5, 0.25)),
    )


ONE = (Light((0.6, 0.2, 0.7)), WHITE)
OTHER = (Light((-0.4, -0.3, 0.5)), (0.5, 0.5, 0.5))


@pytest.mark.parametrize("tangent", [(0.0, 0.0, 1.0), (0.8, -0.6, 0.0), (-0.6, 0.0, -0.8)])
def test_a_square_has_eq_4_and_another_light_adds_its_own(tangent):
    expected = []
    for light, intensity in (ONE, OTHER):
        toward = light.light_vectors(np.zeros((1, 3)))[0]
        value = by_turning(toward, np.array([0.0, 0.0, 1.0]), np.array(tangent), **MODEL)
        expected.append(intensity[0] * toward[2] * value * np.array([1.0, 0.5, 0.25]))
    for lights, sum_ in (((ONE,), expected[0]), ((ONE, OTHER), expected[0] + expected[1])):
        found = execute_ideal(square(IDEAL, tangent, lights), 32, 32).color[16, 16, :3]
        np.testing.assert_allclose(found, np.minimum(1.0, sum_), atol=2e-3)
        machine = execute(square(OPENGL_1_2, tangent, lights), OPENGL_1_2, 32, 32).framebuffer
        np.testing.assert_allclose(machine.color[16, 16, :3] / 255.0, found, atol=2.5 / 255.0)


def test_a_pass_is_one_light_and_one_texture():
    passes = square(IDEAL, (1.0, 0.0, 0.0), (ONE, OTHER))[2:]
    assert len(passes) == 2
    assert all(len(command.state.texture_units) == 1 for command in passes)


def test_near_lights_and_near_viewers_are_refused_for_one_matrix_serves_a_mesh():
    plane = surfaces.plane()
    with pytest.raises(ValueError, match=r"light is near.*directional"):
        banks.banks_passes(plane, plane.tangents, VIEW, ((Light((0, 0, 1), point=True), WHITE),), "threads")
    near = perspective_view(PANEL, (0.0, 0.0, 4.0))
    with pytest.raises(ValueError, match=r"viewer is near.*far away"):
        banks.isotropic_passes(plane, near, (ONE,), "rough")
    with pytest.raises(ValueError, match="no light"):
        banks.banks_passes(plane, plane.tangents, VIEW, (), "threads")


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("diffuse", -0.1, "k_d is -0.1"),
        ("specular", math.nan, "k_s is nan"),
        ("exponent", 0.0, "exponent is 0"),
        ("exponent", math.inf, "exponent is inf"),
    ],
)
def test_numbers_that_are_no_model_are_refused(name, value, words):
    with pytest.raises(ValueError, match=words):
        banks.load_threads("threads", IDEAL, **{**MODEL, name: value})


@pytest.mark.parametrize("hole", [0.0, 0.3])
def test_a_disc_is_flat_round_and_faces_the_viewer(hole):
    disc = surfaces.disc(48, hole)
    a, b, c = (disc.positions[disc.triangles[:, k]] for k in range(3))
    twice = cross(b - a, c - a)
    assert (twice[:, 2] > 0.0).all()
    area = math.pi * (1.0 - hole * hole)
    assert twice[:, 2].sum() / 2.0 == pytest.approx(area, rel=0.01)
    np.testing.assert_allclose(cross(disc.tangents, disc.binormals), disc.normals, atol=1e-5)
    away = disc.positions[np.abs(disc.positions).sum(axis=1) > 0.0]
    np.testing.assert_allclose(
        dot(away, disc.tangents[np.abs(disc.positions).sum(axis=1) > 0.0]), 0.0, atol=1e-6
    )


@pytest.mark.parametrize("hole", [-0.1, 1.0, math.nan])
def test_a_disc_without_a_surface_is_refused(hole):
    with pytest.raises(ValueError, match="hole's radius"):
        surfaces.disc(16, hole)
