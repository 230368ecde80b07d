"""Vertex weighting (EXT_vertex_weighting) as whole machines draw it."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline import PROFILES, execute, execute_ideal
from fixedpipe.pipeline.commands import Bitmap, Clear, Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import (
    IDENTITY,
    Composite,
    Light,
    Lighting,
    Material,
    PassState,
    RasterPosition,
    VertexState,
)

SIZE = 32
MACHINES = ["GEFORCE_256", "GEFORCE_3", "NV2A"]
LEFT = ((1.0, 0.0, 0.0, -0.25), *IDENTITY[1:])
UP = ((1.0, 0.0, 0.0, 0.25), (0.0, 1.0, 0.0, 0.5), *IDENTITY[2:])
MIRRORED = (*IDENTITY[:2], (0.0, 0.0, -1.0, 0.0), IDENTITY[3])
# A bar whose weights, as its corners, are powers of two: no arithmetic of the machines rounds anything here.
BAR = np.array([[x / 4, y / 4, 0.0] for x in range(-2, 2) for y in (-1, 1)])
WEIGHTS = np.repeat([1.0, 0.75, 0.5, 0.0], 2)
COLORS = np.column_stack([np.linspace(0.25, 1.0, 8), np.linspace(1.0, 0.0, 8), np.ones(8)])


def picture(machine, *commands):
    """What is drawn, uint8 [h, w, 4]."""
    frame = (Clear(label="clear", color=(0.0, 0.0, 0.0, 1.0)), *commands)
    if machine == "IDEAL":
        return np.round(execute_ideal(frame, SIZE, SIZE).color * 255).astype(np.uint8)
    return execute(frame, PROFILES[machine], SIZE, SIZE).image()


def bar(positions, vertex, **arrays):
    mesh = Mesh(positions, PrimitiveType.QUAD_STRIP, colors=COLORS, **arrays)
    return Draw(label="bar", mesh=mesh, state=PassState(vertex=vertex))


def on_the_host(matrices):
    """The bar's positions, weighted by NumPy."""
    given = np.column_stack([BAR, np.ones(8)])
    first, second = (given @ np.array(matrix).T for matrix in matrices)
    return WEIGHTS[:, None] * first + (1 - WEIGHTS[:, None]) * second


@pytest.mark.parametrize("machine", [*MACHINES, "IDEAL"])
def test_weighted_vertices_are_drawn_as_vertices_that_the_host_weighted(machine):
    vertex = VertexState(modelview=LEFT, modelview1=UP)
    drawn = picture(machine, bar(BAR, vertex, weights=WEIGHTS))
    assert np.array_equal(drawn, picture(machine, bar(on_the_host((LEFT, UP)), VertexState())))
    assert not np.array_equal(
        drawn, picture(machine, bar(BAR, vertex))
    )  # without weights: by the first alone
    assert np.array_equal(picture(machine, bar(BAR, vertex)), picture(machine, bar(BAR, VertexState(LEFT))))


def test_a_composite_matrix_is_of_weighted_eye_coordinates():
    """Pixels, y down, of eye coordinates; the matrix without weighting would be of object coordinates."""
    half = SIZE / 2
    to_pixels = ((half, 0.0, 0.0, half), (0.0, -half, 0.0, half), (0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0))
    composite = Composite(to_pixels, (0.0, 0.0, 0.0))
    weighted = VertexState(modelview=LEFT, modelview1=UP, composite=composite)
    drawn = picture("NV2A", bar(BAR, weighted, weights=WEIGHTS))
    alone = VertexState(composite=composite)
    assert np.array_equal(drawn, picture("NV2A", bar(on_the_host((LEFT, UP)), alone)))
    assert not np.array_equal(drawn, picture("NV2A", bar(BAR, replace(alone, modelview=LEFT))))


@pytest.mark.parametrize("machine", [*MACHINES, "IDEAL"])
@pytest.mark.parametrize(("weight", "light"), [(1.0, 1.0), (0.75, 0.5), (0.5, 0.0), (0.25, 0.0)])
def test_normals_are_weighted_by_both_inverses(machine, weight, light):
    """A normal (0, 0, 1) and its mirror image: t - (1 - t) towards the light, where it is positive. One unit
    of 255 is for bytes of the lighting unit, which keeps 14 bits.
    """
    black, white = (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)
    material = Material(ambient=black, diffuse=white, emission=(0.0, 1.0, 0.0, 1.0))
    lighting = Lighting((Light(),), material, model_ambient=black)
    vertex = VertexState(modelview1=MIRRORED, lighting=lighting)
    corners = [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]]
    mesh = Mesh(corners, PrimitiveType.QUADS, normals=[[0, 0, 1]] * 4, weights=[weight] * 4)
    drawn = picture(machine, Draw(label="square", mesh=mesh, state=PassState(vertex=vertex)))
    red, green, _, _ = drawn[SIZE // 2, SIZE // 2].tolist()
    assert green == 255  # the square is there
    assert abs(red - 255 * light) <= 1


@pytest.mark.parametrize("machine", [*MACHINES, "IDEAL"])
def test_a_raster_position_has_a_weight(machine):
    """A pixel of a bitmap at the origin moves as a vertex does: by 1/4 left, 1/4 right and half as far up."""
    state = PassState(vertex=VertexState(modelview=LEFT, modelview1=UP))
    places = []
    for weight in (1.0, 0.5, 0.0):
        at = RasterPosition(weight=weight)
        drawn = picture(machine, Bitmap(label="dot", bits=np.ones((1, 1), bool), state=state, position=at))
        (place,) = np.argwhere(drawn[..., 0] == 255).tolist()
        places.append(place)
    assert places == [[15, 12], [11, 16], [7, 20]]  # rows from the top
