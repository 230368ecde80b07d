"""Torrance-Sparrow's two tables (H02 to H06, H10): what they hold, and what scales them."""

import math

import numpy as np
import pytest

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view, perspective_view
from fixedpipe.effects.passes.draws import FIRST_PASS, draw
from fixedpipe.effects.reflectance import torrance_sparrow_passes as tables
from fixedpipe.effects.reflectance.anisotropic_tables import diffuse_pass
from fixedpipe.effects.reflectance.brdfs import BRDFS, Frame
from fixedpipe.effects.reflectance.torrance_sparrow_passes import Coordinates, Remedy
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_3, OPENGL_1_2

SPHERE = surfaces.sphere(24, 13)
VIEW = orthographic_view(Panel(0, 0, 8, 8))
LAMP = Light((-0.4, 0.5, 0.8))
UP = np.array((0.0, 0.0, 1.0))


def test_the_tables_product_is_the_model():
    rng = np.random.default_rng(1)
    vectors = rng.normal(size=(2, 300, 3))
    vectors[..., 2] = np.abs(vectors[..., 2]) + 0.05
    light, view = vectors / np.sqrt((vectors**2).sum(axis=-1, keepdims=True))
    half = (light + view) / np.sqrt(((light + view) ** 2).sum(axis=-1, keepdims=True))
    frame = Frame(np.broadcast_to(UP, light.shape), np.array((1.0, 0.0, 0.0)), np.array((0.0, 1.0, 0.0)))
    first = tables.facets((light * half).sum(axis=-1), half[:, 2], 0.3, 5.0)
    second = tables.obstruction(light[:, 2], view[:, 2], 0.3 / math.sqrt(2.0))
    expected = BRDFS["torrance_sparrow"].radiance(light, view, frame, roughness=0.3, index=5.0)
    assert first * second == pytest.approx(expected, rel=1e-12)


def test_schlick_s_tables_product_is_his_model():
    light, view = np.array((0.3, 0.1, 0.8)), np.array((-0.4, 0.2, 0.7))
    light, view = (v / np.sqrt((v**2).sum()) for v in (light, view))
    half = (light + view) / np.sqrt(((light + view) ** 2).sum())
    first = tables.schlick_facets((light * half).sum(), half[2], 0.4, 1.5)
    second = tables.schlick_obstruction(light[2], view[2], 0.4)
    frame = Frame(UP, np.array((1.0, 0.0, 0.0)), np.array((0.0, 1.0, 0.0)))
    row = {"roughness": 0.16, "isotropy": 1.0, "specular": 0.04}
    # Z's largest value is 1/r, and his 4 pi is pi here.
    assert first * second == pytest.approx(
        4.0 * 0.16 * BRDFS["schlick"].radiance(light, view, frame, **row), rel=1e-12
    )


def test_a_third_unit_adds_diffuse_light_in_the_same_pass():
    view = orthographic_view(Panel(0, 0, 48, 48))
    loading = (*tables.load(GEFORCE_3, 0.3, 20.0), tables.load_diffuse(GEFORCE_3, (0.4, 0.3, 0.1)))
    color, sphere = (1.0, 0.8, 0.6), surfaces.sphere(96, 49)
    one = tables.passes(sphere, view, LAMP, color, units=3)
    two = (*tables.passes(sphere, view, LAMP, color), diffuse_pass(sphere, view, LAMP, (0.4, 0.3, 0.1)))
    clear = view.panel.clear((0.0, 0.0, 0.0))
    pictures = [
        execute((clear, *loading, *frame), GEFORCE_3, 48, 48).framebuffer.color[..., :3].astype(int)
        for frame in (one, two)
    ]
    assert len(one) == 1 and pictures[0].max() > 120
    apart = np.abs(pictures[0] - pictures[1]).max(axis=-1)
    # At the outline two triangles may have one depth, and the later pass is added twice.
    assert (apart > 1).sum() <= 2


def test_the_first_row_and_column_of_the_second_table_are_black():
    _, second = tables.load(OPENGL_1_2, 0.2, 1.5)
    values = np.asarray(second.image.levels[0])[0, ..., 0]
    assert not values[0].any() and not values[:, 0].any()
    # And the clamp takes what is above one: where the view grazes (P1).
    assert (values[1:8, 200:] == 255).all()


def test_texture_matrices_make_what_the_vertices_have():
    coordinates = tables.vertex_coordinates(SPHERE, VIEW, LAMP)
    normals = np.concatenate([SPHERE.normals, np.ones((len(SPHERE.normals), 1))], axis=1)
    for found, matrix in zip(coordinates, tables.matrices(VIEW, LAMP), strict=True):
        assert (normals @ np.array(matrix).T)[:, :2] == pytest.approx(found, abs=1e-12)


@pytest.mark.parametrize("remedy", [Remedy.DOUBLING, Remedy.ACCUMULATION])
def test_a_remedy_multiplies_by_c(remedy):
    square = surfaces.plane()
    color = square.mesh(colors=np.full((4, 3), 30.0 / 255.0))
    first = draw("colour", color, VIEW, None, depth_test=FIRST_PASS)
    frame = VIEW.panel.clear((0, 0, 0)), first, *tables.multiplied(square, VIEW, 4.0, remedy)
    result = execute(frame, OPENGL_1_2, 8, 8)
    assert (result.framebuffer.color[..., :3] == 120).all()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: tables.load(OPENGL_1_2, 0.0, 1.5), "roughness m is 0.0"),
        (lambda: tables.load(OPENGL_1_2, math.nan, 1.5), "roughness m is nan"),
        (lambda: tables.load(OPENGL_1_2, 0.2, 0.0), "index of refraction"),
        (lambda: tables.load(OPENGL_1_2, 0.2, 1.5, divisor=0.5), "divisor c is 0.5"),
        (lambda: tables.load(OPENGL_1_2, 0.2, 1.5, distribution="flat"), "distribution of facets"),
        (lambda: tables.passes(SPHERE, VIEW, LAMP, (1, 1, 1), units=4), "number of texture units"),
        (lambda: tables.multiplied(SPHERE, VIEW, 3.0, Remedy.DOUBLING), "powers of two"),
        (lambda: tables.multiplied(SPHERE, VIEW, 2.0, Remedy.COMBINER), "is no command"),
        (
            lambda: tables.passes(
                SPHERE,
                perspective_view(VIEW.panel, (0, 0, 5)),
                LAMP,
                (1, 1, 1),
                coordinates=Coordinates.TEXTURE_MATRIX,
            ),
            "The viewer is near",
        ),
    ],
)
def test_what_cannot_be_drawn_is_said(call, words):
    with pytest.raises(ValueError, match=words):
        call()
