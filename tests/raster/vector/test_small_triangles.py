"""Small triangles that are set up sixteen at a time: what they cover, and every bit of what they draw."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    Face,
    ShadeModel,
    TextureFilter,
    VertexStage,
)
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import (
    DepthTest,
    PassState,
    PolygonState,
    Sampler,
    Scissor,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.raster import rows as R
from fixedpipe.raster.vector.small_triangles import HIGHEST, WIDEST, cover

WIDTH, HEIGHT = 75, 70  # three bands
# 1/16 pixel: how far a triangle's corners lie from its middle.
REACHES = (3, 16, 24, 40, 70, 130, 300, 2000)

corner = st.tuples(st.integers(-70, 200), st.integers(-70, 200))


def covered(corners, box):
    """The pixels of a box (x_first, x_last, top, bottom) inside a triangle, one after another in Python's
    integers, and how wide and high what this box leaves of the triangle's own is.
    """
    x_first, x_last, top, bottom = box
    xs, ys = [x for x, _ in corners], [y for _, y in corners]
    left, right = max((min(xs) + 7) // 16, x_first), min((max(xs) - 8) // 16, x_last)
    first, last = max((min(ys) + 7) // 16, top), min((max(ys) - 8) // 16, bottom)
    (x0, y0), (x1, y1), (x2, y2) = corners
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if area < 0:
        corners = (corners[0], corners[2], corners[1])
    found = set()
    for y in range(first, last + 1):
        for x in range(left, right + 1):
            inside = True
            for (ax, ay), (bx, by) in zip(corners, (*corners[1:], corners[0]), strict=True):
                dx, dy = bx - ax, by - ay
                n = dx * (16 * y + 8 - ay) - dy * (16 * x + 8 - ax)
                inside = inside and (n > 0 or (n == 0 and (dy < 0 or (dy == 0 and dx > 0))))
            if inside:
                found.add((x, y))
    return found, right - left + 1, last - first + 1


@given(
    st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=16),
    st.tuples(st.integers(-3, 5), st.integers(3, 12), st.integers(-3, 5), st.integers(3, 12)),
)
def test_masks_are_the_pixels_of_the_fill_rule(triangles, box):
    lanes = np.random.default_rng(0).integers(-(2**31), 2**31, (R.LANES, 16)).astype(np.int32)
    for lane, corners in enumerate(triangles):
        lanes[R.LANE_X0 : R.LANE_Y2 + 1, lane] = np.ravel(corners)
    taken = cover(lanes, len(triangles), *box)
    assert taken >> len(triangles) == 0
    for lane, corners in enumerate(triangles):
        (x0, y0), (x1, y1), (x2, y2) = corners
        expected, across, rows = covered(corners, box)
        assert (taken >> lane) & 1 == (0 < across <= WIDEST and 0 < rows <= HIGHEST)
        if not (taken >> lane) & 1 or (x1 - x0) * (y2 - y0) == (x2 - x0) * (y1 - y0):
            continue
        mask = int(np.uint32(lanes[R.LANE_UPPER, lane])) | int(np.uint32(lanes[R.LANE_LOWER, lane])) << 32
        left, top = lanes[R.LANE_LEFT, lane], lanes[R.LANE_ROW, lane]
        assert {(left + k % 8, top + k // 8) for k in range(64) if mask >> k & 1} == expected


@pytest.mark.parametrize("far", [1 << 24, 1 << 30, 2**31 - 20])
def test_corners_whose_differences_would_wrap_are_left_alone(far):
    lanes = np.zeros((R.LANES, 16), np.int32)
    for column, corners in enumerate(
        [(0, 0, far, 8, 5, 90), (-far, 0, far, 8, 5, 90), (far, far, 9, 9, 8, 0)]
    ):
        lanes[R.LANE_X0 : R.LANE_Y2 + 1, column] = corners
    assert cover(lanes, 16, 0, 7, 0, 7) & 7 == 0


def triangles(random, count):
    """Corners float64[n, 3, 2] in pixels, of whole 1/16: some beyond the window, some slivers, some with two
    corners in one place, some that share an edge with the one before.
    """
    middle = random.integers(-60, 16 * WIDTH + 60, (count, 1, 2))
    reach = random.choice(REACHES, (count, 1, 1), p=(0.1, 0.2, 0.2, 0.2, 0.15, 0.1, 0.04, 0.01))
    found = middle + (random.uniform(-1, 1, (count, 3, 2)) * reach).astype(np.int64)
    kinds = random.integers(0, 8, count)
    for k in np.flatnonzero(kinds == 0):  # a sliver
        found[k, 2] = (found[k, 0] + found[k, 1]) // 2 + random.integers(-1, 2, 2)
    for k in np.flatnonzero(kinds == 1):
        found[k, 2] = found[k, 0]
    for k in np.flatnonzero((kinds >= 6) & (np.arange(count) > 0)):
        found[k, :2] = found[k - 1, 1:]
    return found / 16.0


def picture(commands, **settings):
    """Colour, depth and the number of fragments."""
    result = Machine(NV2A, WIDTH, HEIGHT, **settings).run(commands)
    return result.framebuffer.color.tobytes(), result.framebuffer.depth.tobytes(), result.fragments


@settings(max_examples=60)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from((None, "nearest", "linear", "mipmapped")),
    st.sampled_from((None, *(f for f in ComparisonFunction if f != ComparisonFunction.NEVER))),
    st.sampled_from(ShadeModel),
    st.sampled_from((None, *Face)),
    st.booleans(),
    st.booleans(),
    st.booleans(),
    st.sampled_from(("own", "one", "two sides")),
)
def test_both_engines_draw_the_same(
    seed, texture, depth, shade_model, cull, offset, perspective, scissor, colors
):
    random = np.random.default_rng(seed)
    count = int(random.integers(1, 120))
    corners = triangles(random, count).reshape(-1, 2)
    z = random.uniform(0.0, 2.0**24, len(corners))
    if random.integers(0, 3) == 0:
        z[:] = z[0]
    w = random.uniform(0.5, 4.0, len(corners)) if perspective else np.ones(len(corners))
    given = random.random((3, len(corners), 4)) if colors != "one" else np.full((3, len(corners), 4), 0.6)
    mesh = Mesh(
        np.column_stack([corners, z, w]),
        colors=given[0],
        secondary_colors=given[1],
        back_colors=given[2] if colors == "two sides" else None,
        texture_coordinates=(random.uniform(-2, 3, (len(corners), 4)) * (1, 1, 0, 0) + (0, 0, 0, 1),),
    )
    filters = {
        "nearest": (TextureFilter.NEAREST, TextureFilter.NEAREST),
        "linear": (TextureFilter.LINEAR, TextureFilter.LINEAR),
        "mipmapped": (TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR),
    }
    state = PassState(
        vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS, two_side=colors == "two sides"),
        polygon=PolygonState(
            cull_face=cull,
            shade_model=shade_model,
            offset_fill=offset,
            offset_factor=1.5,
            offset_units=float(random.integers(-9, 9)),
        ),
        depth_test=None if depth is None else DepthTest(depth),
        texture_units=() if texture is None else (TextureUnit("t", Sampler(*filters[texture])),),
        scissor=Scissor(*(int(v) for v in random.integers(0, 30, 2)), 33, 31) if scissor else None,
    )
    image = texture_2d(random.integers(0, 256, (16, 16, 4), np.uint8), mipmaps=True)
    commands = (
        TexImage(label="t", texture="t", image=image),
        Clear(label="clear", color=(0.2, 0.4, 0.6, 0.8), depth=0.5),
        Draw(label="small", mesh=mesh, state=state),
    )
    portable = picture(commands, engine="portable")
    assert picture(commands) == portable
    assert picture(commands, threads=3, batch=1024) == portable
