"""All engines and the specification draw the same where a fast path ends: what the fuzz once found."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ColorWeights,
    ComparisonFunction,
    Face,
    LineRasterization,
    PolygonMode,
    PrimitiveType,
    TextureFilter,
    TextureShaderOperation,
    VertexStage,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import (
    DepthClamp,
    DepthTest,
    LineState,
    PassState,
    PolygonState,
    Sampler,
    TextureShaderStage,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d
from tests import fuzz
from tests.support.random_frames import Frame
from tests.support.strategies import SHOW_TEXTURE

PROGRAMMED = VertexState(stage=VertexStage.PROGRAM_RESULTS)
DEPTH = DepthTest(ComparisonFunction.LESS)


def assert_all_equal(commands, width, height, depth_bits=24, profile=NV2A):
    frame = Frame(0, profile, width, height, depth_bits, tuple(commands), small=True)
    ways = (
        fuzz.Way(),
        fuzz.Way("portable"),
        fuzz.Way("columns"),
        fuzz.Way(threads=2, batch=100),
        fuzz.Way(reference=True),
    )
    fuzz.compare(frame, ways)


@pytest.mark.parametrize("reach", [20, 130, 300, 3000, 8000])
def test_a_large_triangle_of_which_little_is_on_the_screen(reach):
    random = np.random.default_rng(reach)
    for _ in range(4):
        corners = random.uniform(-reach, reach, (30, 2))
        positions = np.column_stack([corners, random.uniform(0.0, 2.0**24, 30), np.ones(30)])
        mesh = Mesh(positions, colors=random.random((30, 4)))
        state = PassState(vertex=PROGRAMMED, depth_test=DEPTH)
        assert_all_equal([Draw(label="far", mesh=mesh, state=state)], 6, 5)


@pytest.mark.parametrize("mode", [PolygonMode.FILL, PolygonMode.LINE])
@pytest.mark.parametrize("perspective", [True, False])
def test_triangles_through_infinity(perspective, mode):
    """Vertices of a negative w: what is drawn, which side is culled, colours, coordinates and depths."""
    random = np.random.default_rng(7)
    for face in (None, Face.FRONT, Face.BACK):
        w = np.exp(random.uniform(-2.0, 2.0, 60)) * np.where(random.random(60) < 0.4, -1.0, 1.0)
        corners = np.column_stack([random.uniform(-6.0, 14.0, (60, 2)), random.uniform(0.0, 2.0**24, 60), w])
        mesh = Mesh(corners, colors=random.random((60, 4)), texture_coordinates=(random.random((60, 2)),))
        state = PassState(
            vertex=PROGRAMMED,
            depth_test=DEPTH,
            polygon=PolygonState(cull_face=face, front_mode=mode, back_mode=mode),
            texture_units=(TextureUnit("noise", Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)),),
            perspective_correction=perspective,
        )
        image = texture_2d(random.integers(0, 256, (8, 8, 4)).astype(np.uint8))
        load = TexImage(label="noise", texture="noise", image=image)
        assert_all_equal([load, Draw(label="through infinity", mesh=mesh, state=state)], 9, 7)


@pytest.mark.parametrize("limits", [(2.0**25, None), (0.25, 300.0), (1.0, 2.0**23), (0.0, 2.0**25)])
@pytest.mark.parametrize("cull", [False, True])
def test_depths_are_limited(limits, cull):
    random = np.random.default_rng(1)
    positions = np.column_stack([random.uniform(-4, 20, (12, 2)), random.uniform(0, 1000, 12), np.ones(12)])
    state = PassState(vertex=PROGRAMMED, depth_test=DEPTH, depth_clamp=DepthClamp(*limits, cull))
    mesh = Mesh(positions, colors=random.random((12, 4)))
    assert_all_equal([Draw(label="limited", mesh=mesh, state=state)], 16, 12)


@pytest.mark.parametrize("width", [1.0, 4.0, 9.0])
def test_lines_by_diamonds_are_clamped_in_color_beyond_their_ends(width):
    random = np.random.default_rng(3)
    starts = random.uniform(1.0, 15.0, (40, 2))
    ends = starts + random.uniform(-0.8, 0.8, (40, 2))  # shorter than what lies beyond them
    corners = np.stack([starts, ends], axis=1).reshape(80, 2)
    positions = np.column_stack([corners, random.uniform(0.0, 2.0**20, 80), np.ones(80)])
    colors = random.integers(0, 2, (80, 4)).astype(np.float64)
    mesh = Mesh(positions, primitive=PrimitiveType.LINES, colors=colors)
    line = LineState(width=width, rasterization=LineRasterization.STEPS)
    profile = NV2A.changed(diamond_exit_lines=True, color_weights=ColorWeights.EXACT)
    draw = Draw(label="lines", mesh=mesh, state=PassState(vertex=PROGRAMMED, line=line))
    assert_all_equal([draw], 16, 16, profile=profile)


def test_one_vertex_s_q_divides_every_triangle_s_coordinates():
    sampler = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST, *(WrapMode.CLAMP_TO_BORDER,) * 2)
    state = PassState(
        vertex=PROGRAMMED, texture_units=(TextureUnit("t", sampler),), register_combiners=SHOW_TEXTURE
    )
    corners = np.array([[0, 0, 0, 1], [20, 0, 0, 1], [0, 20, 0, 1]] * 2, np.float64)
    coordinates = np.tile(
        [-1e-19, 0.25, 0.0, 1.0], (6, 1)
    )  # beside a texel's edge, where a quotient is lifted
    coordinates[5, 3] = 2.0
    mesh = Mesh(corners, indices=[0, 1, 2], texture_coordinates=(coordinates,))
    image = texture_2d(np.full((4, 4, 4), 77, np.uint8))
    assert_all_equal(
        [TexImage(label="t", texture="t", image=image), Draw(label="draw", mesh=mesh, state=state)], 8, 6
    )


def test_a_stage_that_culls_runs_where_no_environment_has_an_effect():
    stages = (TextureShaderStage(TextureShaderOperation.CULL_FRAGMENT),)  # kept where nothing is below zero
    state = PassState(vertex=PROGRAMMED, texture_units=(TextureUnit(None),), texture_shader=stages)
    corners = np.array([[0, 0, 0, 1], [20, 0, 0, 1], [0, 20, 0, 1]], np.float64)
    coordinates = np.array([[-1.0, 1.0], [2.0, 1.0], [-1.0, 1.0]])
    mesh = Mesh(corners, texture_coordinates=(coordinates,))
    draw = Draw(label="draw", mesh=mesh, state=state)
    assert_all_equal([draw], 8, 6)
    drawn = execute([draw], NV2A, 8, 6).framebuffer.color[..., 0] == 255
    assert not drawn.all() and drawn[:, -1].all()
