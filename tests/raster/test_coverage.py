"""Coverage: triangles that share edges draw every pixel between them exactly once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import Face, PrimitiveType, StencilOperation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.native.coverage import covered_triangles, rasterize
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import PassState, PolygonState, StencilTest
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from tests.reference import coverage

COUNT = PassState(stencil_test=StencilTest(depth_pass=StencilOperation.INCR))


def counts(mesh, width, height):
    """How often each pixel is drawn, uint8 [height, width], top row first."""
    return execute(
        (Draw(label="count", mesh=mesh, state=COUNT),), GEFORCE_256, width, height
    ).framebuffer.stencil


@st.composite
def shuffled_grids(draw, width, height):
    """A jittered grid over more than the screen, cut into triangles of any winding, order and diagonal."""
    columns, rows = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    x, y = np.meshgrid(np.linspace(-0.2, 1.2, columns + 1), np.linspace(-0.2, 1.2, rows + 1))
    # Corners moved by less than a sixth of a cell leave every cell convex: either diagonal cuts it into two
    # triangles that do not overlap. (On screens of few pixels the snapping alone could move them further.)
    jitter = 0.15 * 1.4 * random.uniform(-1.0, 1.0, (2, rows + 1, columns + 1))
    x, y = (x + jitter[0] / columns) * width, (y + jitter[1] / rows) * height
    if draw(st.booleans()):  # onto pixel centers and corners, where ties are decided
        x, y = np.round(x * 2.0) / 2.0, np.round(y * 2.0) / 2.0
    number = np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1)
    triangles = []
    for j in range(rows):
        for i in range(columns):
            a, b, c, d = number[j, i], number[j, i + 1], number[j + 1, i + 1], number[j + 1, i]
            pair = [(a, b, c), (a, c, d)] if random.random() < 0.5 else [(a, b, d), (b, c, d)]
            triangles += [random.permutation(t) for t in pair]
    positions = 2.0 * np.stack([x.ravel() / width, y.ravel() / height], -1) - 1.0
    return Mesh(positions, indices=random.permutation(np.array(triangles)).ravel())


@settings(max_examples=300)
@given(st.data(), st.sampled_from((16, 27, 32, 45)), st.sampled_from((16, 23, 32)))
def test_every_pixel_of_a_triangulated_mesh_is_drawn_exactly_once(data, width, height):
    mesh = data.draw(shuffled_grids(width, height))
    assert (counts(mesh, width, height) == 1).all()


def test_every_pixel_of_a_fan_of_slivers_is_drawn_exactly_once():
    angles = np.linspace(0.0, 2.0 * np.pi, 400)[:-1]
    rim = np.stack([3.0 * np.cos(angles), 3.0 * np.sin(angles)], -1)
    mesh = Mesh(
        np.vstack([[[0.013, -0.027]], rim, rim[:1]]),
        PrimitiveType.TRIANGLE_FAN,
    )
    assert (counts(mesh, 61, 47) == 1).all()


def test_every_pixel_of_a_mesh_far_beyond_the_screen_is_drawn_exactly_once():
    corners = np.array([[-300.0, -200.0], [250.0, -310.0], [280.0, 190.0], [-310.0, 260.0]])
    mesh = Mesh(np.vstack([corners, [[0.1, 0.2]]]), indices=[0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4])
    assert (counts(mesh, 40, 30) == 1).all()


def window_triangles(points, inverse_w=None):
    """WindowPrimitives of one triangle after the other, from int [3 k, 2] in 1/16 pixel."""
    n = len(points)
    index = np.arange(n, dtype=np.int32).reshape(-1, 3)
    return WindowPrimitives(
        x=points[:, 0].astype(np.int32),
        y=points[:, 1].astype(np.int32),
        z=np.zeros(n),
        inverse_w=np.ones(n) if inverse_w is None else inverse_w,
        colors=np.zeros((n, 2, 8), np.uint8),
        coordinates=np.zeros((n, 0, 4)),
        fog=np.zeros(n),
        triangles=np.hstack([index, index[:, 2:]]),
        dropped=0,
        two_side=False,
    )


@pytest.mark.parametrize("place", [0, 1, 2, 3], ids=["first", "second", "third", "provoking"])
@pytest.mark.parametrize("vertex", [-1, 3])
def test_a_triangle_that_names_a_vertex_out_of_range_is_not_drawn(place, vertex):
    primitives = window_triangles(np.array([[0, 0], [0, 128], [128, 0]]))
    assert len(rasterize(primitives, GEFORCE_256, PolygonState(), None, 8, 8).x) > 0
    primitives.triangles[0, place] = vertex
    assert len(rasterize(primitives, GEFORCE_256, PolygonState(), None, 8, 8).x) == 0


@settings(max_examples=300)
@given(st.integers(0, 2**32 - 1), st.sampled_from((8, 40, 200, 2000, 120000)), st.booleans(), st.booleans())
def test_coverage_equals_the_specification_pixel_by_pixel(seed, reach, on_ties, through_infinity):
    random = np.random.default_rng(seed)
    points = random.integers(-reach, reach + 160, (90, 2))
    if on_ties:  # edges through pixel centers, often horizontal or vertical
        points = 8 * random.integers(-2, 24, (90, 2))
        points[1::3, 1] = np.where(random.random(30) < 0.3, points[0::3, 1], points[1::3, 1])
        points[2::3, 0] = np.where(random.random(30) < 0.3, points[0::3, 0], points[2::3, 0])
        points = points.reshape(30, 3, 2)[:, random.permutation(3)].reshape(90, 2)
    behind = random.random((30, 3)) < 0.3 if through_infinity else np.zeros((30, 3), bool)
    polygon = PolygonState(cull_face=Face.BACK if random.random() < 0.5 else None)
    primitives = window_triangles(points, np.where(behind.ravel(), -1.0, 1.0) * random.uniform(0.1, 9.0, 90))
    expected = []
    for t, corners in enumerate(points.reshape(30, 3, 2).tolist()):
        triangle = coverage.make_triangle(*(tuple(corner) for corner in corners), behind[t].tolist())
        if not coverage.is_culled(coverage.is_front_facing(triangle, polygon.front_face), polygon.cull_face):
            expected += [(t, x, y) for x, y in coverage.fragments(triangle, range(11), range(9))]
    of_kernels = rasterize(primitives, GEFORCE_256, polygon, None, 11, 9)
    of_columns = covered_triangles(
        primitives, PassState(polygon=polygon), GEFORCE_256, Framebuffer.new(11, 9)
    )
    for got in (of_kernels, of_columns):
        drawn = zip(got.triangle.tolist(), got.x.tolist(), got.y.tolist(), strict=True)
        assert sorted(drawn) == sorted(expected)
