"""Points, lines, outlined polygons and stipple in the ideal: the machine's pixels, with real values."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    LineRasterization,
    PolygonMode,
    PrimitiveType,
    ShadeModel,
    TextureEnvironmentMode,
    TextureFilter,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import (
    DepthTest,
    LineState,
    PassState,
    PointParameters,
    PointState,
    PolygonState,
    Sampler,
    TextureEnvironment,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d

SIZE = 32
MACHINES = (OPENGL_1_2, GEFORCE_256, NV2A)
CLEAR = Clear(label="black", color=(0, 0, 0, 0), depth=1.0)
OUTLINED = PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)
DOTTED = PolygonState(front_mode=PolygonMode.POINT, back_mode=PolygonMode.POINT)
THIN = LineState(rasterization=LineRasterization.STEPS)
WIDE = replace(THIN, width=5.0)
TESTED = DepthTest(ComparisonFunction.LEQUAL)

# What is drawn, and in which state: (primitive, settings of PassState).
STROKES = {
    "thin lines": (PrimitiveType.LINES, {"line": THIN}),
    "wide lines": (
        PrimitiveType.LINES,
        {"line": WIDE},
    ),
    "a strip": (PrimitiveType.LINE_STRIP, {"line": THIN}),
    "stippled lines": (
        PrimitiveType.LINE_LOOP,
        {"line": LineState(stipple=(2, 0x5A5A), rasterization=LineRasterization.STEPS)},
    ),
    "points": (PrimitiveType.POINTS, {"point": PointState(size=5.0)}),
    "outlines": (
        PrimitiveType.TRIANGLES,
        {"polygon": OUTLINED, "line": THIN},
    ),
    "corners": (PrimitiveType.TRIANGLES, {"polygon": DOTTED, "point": PointState(size=3.0)}),
    "flat lines": (
        PrimitiveType.LINE_STRIP,
        {
            "polygon": PolygonState(shade_model=ShadeModel.FLAT),
            "line": THIN,
        },
    ),
    "stippled polygons": (
        PrimitiveType.TRIANGLES,
        {"polygon": PolygonState(stipple=bytes((0x33, 0xCC, 0x55, 0xAA)) * 32)},
    ),
}


def mesh_of(seed, primitive, count=6):
    """A mesh of some vertices in and about the view volume, with w and colours of their own."""
    random = np.random.default_rng(seed)
    w = random.uniform(0.5, 2.0, (count, 1))
    places = random.uniform(-1.2, 1.2, (count, 3)) * (1.0, 1.0, 0.8)
    return Mesh(np.hstack([places * w, w]), primitive, colors=random.uniform(0.0, 1.0, (count, 4)))


@pytest.mark.parametrize("profile", MACHINES, ids=lambda profile: profile.name)
@pytest.mark.parametrize("strokes", STROKES)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_guided_ideal_has_the_machine_s_pixels_and_is_near_it(profile, strokes, seed):
    primitive, state = STROKES[strokes]
    frame = (
        CLEAR,
        Draw(label="it", mesh=mesh_of(seed, primitive), state=PassState(depth_test=TESTED, **state)),
    )
    machine = execute(frame, profile, SIZE, SIZE, record=True)
    ideal = execute_ideal(frame, SIZE, SIZE, guide=machine)
    # Vertices' colours to bytes, weights of eight bits, and a diamond line's colours beyond its ends are
    # clamped on the machine.
    difference = 255.0 * np.clip(ideal.color, 0.0, 1.0) - machine.framebuffer.color
    assert np.abs(difference).max() < 2.5


def free_and_machine(mesh, state, **offset):
    """Depths in units of 24 bits, the ideal's and the machine's, of the pixels that both draw; all are."""
    polygon = replace(state.get("polygon", PolygonState()), **offset)
    passed = PassState(depth_test=TESTED, **{**state, "polygon": polygon})
    frame = (CLEAR, Draw(label="it", mesh=mesh, state=passed))
    machine, ideal = execute(frame, OPENGL_1_2, SIZE, SIZE), execute_ideal(frame, SIZE, SIZE)
    drawn = machine.framebuffer.color.any(axis=-1)
    np.testing.assert_array_equal(ideal.color.any(axis=-1), drawn)
    return (ideal.depth * (2.0**24 - 1.0))[drawn], machine.framebuffer.depth[drawn]


OFFSET = {"offset_fill": True, "offset_line": True, "offset_point": True, "offset_units": -4.0}


@pytest.mark.parametrize("strokes", STROKES)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_free_ideal_s_pixels_and_depths_are_opengl_s(strokes, seed):
    primitive, state = STROKES[strokes]
    ideal, machine = free_and_machine(mesh_of(seed, primitive, 3), state, **OFFSET)
    # The machine cuts to whole units, and three terms of a sum below 2^24 to 24 bits: a unit at most each.
    assert (np.abs(ideal - machine) <= 4.0).all()


@pytest.mark.parametrize("strokes", ["outlines", "corners", "stippled polygons"])
def test_a_polygon_s_slope_moves_its_outline(strokes):
    mesh = Mesh([[-0.9, -0.9, 0.5], [0.9, -0.8, 0.1], [0.0, 0.9, -0.3]], colors=[[1.0, 1.0, 1.0]] * 3)
    plain, _ = free_and_machine(mesh, STROKES[strokes][1])
    ideal, machine = free_and_machine(mesh, STROKES[strokes][1], offset_factor=-3.0, **OFFSET)
    slope = 0.5 * (2.0**24 - 1.0) * abs(-0.8 / 1.7 - 0.4 / 1.8 * 0.05) / (SIZE / 2)
    assert np.abs(plain - ideal).min() > slope  # three times it and four units
    assert (np.abs(ideal - machine) <= 5.0).all()  # and the offset to whole units


@settings(max_examples=30, deadline=None)
@given(st.tuples(*[st.integers(0, 16 * SIZE)] * 4))
def test_a_line_s_colour_is_its_pixel_s_projection_onto_it(ends):
    """Equation 3.1 of OpenGL 1.2.1, in fractions."""
    (x0, y0, x1, y1) = (Fraction(c, 16) for c in ends)
    corners = [[float(2 * x / SIZE - 1), float(2 * y / SIZE - 1)] for x, y in ((x0, y0), (x1, y1))]
    mesh = Mesh(corners, PrimitiveType.LINES, colors=[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    ideal = execute_ideal((CLEAR, Draw(label="it", mesh=mesh, state=PassState(line=THIN))), SIZE, SIZE)
    for row, column in zip(*np.nonzero(ideal.color[..., 3]), strict=True):
        px, py = Fraction(2 * int(column) + 1, 2), SIZE - Fraction(2 * int(row) + 1, 2)
        dx, dy = x1 - x0, y1 - y0
        share = ((px - x0) * dx + (py - y0) * dy) / (dx * dx + dy * dy)
        assert ideal.color[row, column, 0] == pytest.approx(float(min(max(share, 0), 1)), abs=1e-12)


# Sizes that shrink with distance, and some beyond what a machine draws.
SHRINKING = {
    "shrinking": PointParameters((1.0, 2.0, 4.0), 0.0, 12.0, 1.0),
    "biased": PointParameters((0.0, 0.0, 1.0), -0.25, 20.0, 2.5),
    "as large as can be": PointParameters((0.01, 0.0, 0.0), 0.0, 200.0, 70.0),
}


@pytest.mark.parametrize("parameters", SHRINKING)
@pytest.mark.parametrize("profile", [GEFORCE_3, NV2A], ids=lambda p: p.name)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_points_of_the_guided_ideal_are_as_large_as_the_machine_s(profile, parameters, seed):
    point = PointState(parameters=SHRINKING[parameters])
    state = PassState(depth_test=TESTED, point=point)
    frame = (CLEAR, Draw(label="it", mesh=mesh_of(seed, PrimitiveType.POINTS), state=state))
    machine = execute(frame, profile, SIZE, SIZE, record=True)
    ideal = execute_ideal(frame, SIZE, SIZE, guide=machine)
    difference = 255.0 * np.clip(ideal.color, 0.0, 1.0) - machine.framebuffer.color
    assert np.abs(difference).max() < 2.5  # vertices' colours to bytes, weights of eight bits
    assert machine.fragments == len(machine.records[0].x)


@pytest.mark.parametrize("parameters", SHRINKING)
def test_points_of_the_free_ideal_have_the_sizes_that_point_parameters_give(parameters):
    """Sizes say which pixels are drawn: they are those of the machines, in whole pixels as OpenGL's are."""
    given, drawn = SHRINKING[parameters], []
    for z in (-0.9, -0.2, 0.3, 0.8):
        mesh = Mesh([[0.0, 0.0, z]], PrimitiveType.POINTS, colors=[[1.0, 1.0, 1.0]])
        draw = Draw(label="it", mesh=mesh, state=PassState(point=PointState(parameters=given)))
        size = 128
        covered = execute_ideal((CLEAR, draw), size, size).color[..., 3].sum()
        a, b, c = given.attenuation
        # The table's root is low by up to a 64th, and its seven bits are cut.
        root = 1.0 / math.sqrt(a + b * abs(z) + c * z * z)
        sizes = [
            min(max(root * share + given.bias, 0.0), 1.0) * given.range + given.minimum
            for share in (1.0 - 1 / 32, 1.0)
        ]
        low, high = (max(math.floor(min(size, 64.0) + 0.5), 1) for size in sizes)
        assert low**2 <= covered <= high**2
        drawn.append(covered)
    assert len(set(drawn)) > 1 or parameters == "as large as can be"


def test_a_point_sprite_s_coordinates_cross_its_square():
    texels = np.zeros((4, 4, 4), np.uint8)
    texels[..., 0], texels[..., 1], texels[..., 3] = np.arange(4) * 80, np.arange(4)[:, None] * 80, 255
    replaced = TextureEnvironment(TextureEnvironmentMode.REPLACE)
    unit = TextureUnit(
        "dots",
        Sampler(min_filter=TextureFilter.NEAREST, mag_filter=TextureFilter.NEAREST),
        coord_replace=True,
        environment=replaced,
    )
    state = PassState(texture_units=(None, None, None, unit), point=PointState(size=16.0, sprite=True))
    mesh = Mesh([[0.0, 0.0]], PrimitiveType.POINTS, texture_coordinates=([[0.0, 0.0]],))
    load = TexImage(label="load", texture="dots", image=texture_2d(texels))
    frame = (load, CLEAR, Draw(label="a point", mesh=mesh, state=state))
    machine = execute(frame, NV2A, SIZE, SIZE, record=True)
    ideal = execute_ideal(frame, SIZE, SIZE, guide=machine)
    assert (machine.framebuffer.color[..., 3] > 0).sum() == 256
    assert np.abs(255.0 * ideal.color - machine.framebuffer.color).max() < 1.5
