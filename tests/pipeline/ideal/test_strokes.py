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
    BlendFactor,
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
from fixedpipe.pipeline.inspection.ideal import record_ideal
from fixedpipe.pipeline.inspection.inspect import history
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import (
    Blending,
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


# What is smooth, and how: lines that are rectangles, triangles, and both in one.
SMOOTH = {
    "lines": (PrimitiveType.LINES, {"line": LineState(2.0, LineRasterization.RECTANGLE, smooth=True)}),
    "wide lines": (
        PrimitiveType.LINE_LOOP,
        {"line": LineState(7.0, LineRasterization.RECTANGLE, smooth=True)},
    ),
    "triangles": (PrimitiveType.TRIANGLES, {"polygon": PolygonState(smooth=True)}),
    "outlines": (
        PrimitiveType.TRIANGLES,
        {"polygon": OUTLINED, "line": LineState(3.0, LineRasterization.RECTANGLE, smooth=True)},
    ),
}
COVERING = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)


@pytest.mark.parametrize("smooth", SMOOTH)
@pytest.mark.parametrize("profile", [GEFORCE_3, NV2A], ids=lambda p: p.name)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_guided_ideal_has_the_machine_s_share_of_each_pixel(profile, smooth, seed):
    """In one colour: where samples draw beyond an edge, the machine clamps what it iterates."""
    primitive, state = SMOOTH[smooth]
    mesh = mesh_of(seed, primitive)
    mesh = Mesh(mesh.positions, primitive, colors=mesh.colors[:1].repeat(len(mesh.positions), axis=0))
    draw = Draw(label="it", mesh=mesh, state=PassState(blending=COVERING, **state))
    machine = execute((CLEAR, draw), profile, SIZE, SIZE, record=True)
    ideal = execute_ideal((CLEAR, draw), SIZE, SIZE, guide=machine)
    difference = 255.0 * np.clip(ideal.color, 0.0, 1.0) - machine.framebuffer.color
    # A colour to a byte; of every fragment on a pixel a share that is cut, and blending's rounding.
    most = np.unique(np.stack([machine.records[0].x, machine.records[0].y]), axis=1, return_counts=True)[1]
    assert np.abs(difference).max() < 0.5 + 1.5 * most.max(initial=0) + 0.5


@pytest.mark.parametrize("smooth", SMOOTH)
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_free_ideal_covers_what_the_nv2a_s_samples_cover(smooth, seed):
    """White, alpha alone: each fragment adds its share, in eighths; nothing is rounded."""
    primitive, state = SMOOTH[smooth]
    random = np.random.default_rng(seed)
    mesh = Mesh(random.uniform(-0.9, 0.9, (6, 2)), primitive, colors=[[1.0] * 4] * 6)
    added = Blending(BlendFactor.ONE, BlendFactor.ONE)
    draw = Draw(label="it", mesh=mesh, state=PassState(blending=added, **state))
    machine = execute((CLEAR, draw), NV2A, SIZE, SIZE, record=True)
    (record,), shares = machine.records, np.zeros((SIZE, SIZE))
    np.add.at(shares, (record.y, record.x), record.covered / 8.0)
    ideal = execute_ideal((CLEAR, draw), SIZE, SIZE)
    np.testing.assert_array_equal(ideal.color[..., 3], shares)
    assert (shares % 1.0 != 0.0).any()


@pytest.mark.parametrize("smooth", SMOOTH)
def test_a_pixel_s_ideal_history_ends_at_the_ideal_s_colour(smooth):
    primitive, state = SMOOTH[smooth]
    draw = Draw(label="it", mesh=mesh_of(5, primitive), state=PassState(blending=COVERING, **state))
    frame = record((CLEAR, draw), NV2A, SIZE, SIZE)
    beside = record_ideal((CLEAR, draw), frame)
    guide = execute((CLEAR, draw), NV2A, SIZE, SIZE, record=True)
    ideal, edges = execute_ideal((CLEAR, draw), SIZE, SIZE, guide=guide).color, 0
    for y, x in zip(*np.nonzero(guide.framebuffer.color[..., 3]), strict=True):
        found = history(frame, (int(x), int(y)), None, beside)
        assert found.ideal == pytest.approx(tuple(ideal[y, x]), abs=1e-12)
        edges += 0.0 < found.ideal[3] < 1.0
    assert edges


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
