"""3D_primitive: one picture of each primitive, for each way of passing vertices, plain and smooth.

Source: src/tests/three_d_primitive_tests.cpp of nxdk_pgraph_tests. All ways draw the same picture.

The names with -ls and -ps (line and polygon smoothing) draw to a surface with two samples a pixel. Both
samples have the same colour, because SET_SMOOTHING_CONTROL's low bit is clear. Then the surface is blended
over the window, which no command cleared. There are three buffers in turn, so the window holds the picture of
the test three before. Tests run in the order of their names. Measured: the three pictures of Lines-ls,
Lines-inlineelements-ls and Lines-inlinearrays-ls-ps, and all others.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent, Mesh
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    LineRasterization,
    PrimitiveType,
    TextureTarget,
    WindowOrigin,
)
from fixedpipe.pipeline.state import DepthTest, LineState, TextureUnit

SUITE = "3D_primitive"

WAYS = ("", "-inlinebuf", "-inlinearrays", "-inlineelements")
LEFT, RIGHT, TOP, BOTTOM = -2.75, 2.75, 1.75, -1.75
FRONT, BACK = 1.0, 5.0


def _grey(value):
    return (value, value, value)


# x, y, z and colour of every vertex.
LINES = (
    *((LEFT, TOP, FRONT, _grey(0.75)), (RIGHT, TOP, FRONT, _grey(1.0))),
    *((-2.0, 1.0, FRONT, (1.0, 0.0, 0.0)), (2.0, 0.0, BACK, (1.0, 0.0, 0.0))),
    *((1.5, 0.5, BACK, (0.0, 1.0, 0.0)), (-1.5, 0.75, BACK, (0.0, 1.0, 0.0))),
    *((RIGHT, 0.25, FRONT, _grey(1.0)), (1.75, 1.25, FRONT, _grey(0.15))),
    *((LEFT, 1.0, FRONT, (0.25, 0.25, 1.0)), (LEFT, -1.0, FRONT, (0.65, 0.65, 1.0))),
    *((LEFT, BOTTOM, BACK, (0.0, 1.0, 1.0)), (RIGHT, BOTTOM, BACK, (0.5, 0.5, 1.0))),
)
TRIANGLES = (
    *((LEFT, TOP, FRONT, _grey(0.25)), (0.0, TOP, FRONT, _grey(0.55)), (LEFT, 0.0, FRONT, _grey(0.75))),
    *((RIGHT, TOP, FRONT, (0.8, 0.25, 0.1)), (0.1, BOTTOM, BACK, (0.1, 0.85, 0.1))),
    *((0.25, 0.0, FRONT, (0.1, 0.25, 0.9)), (-0.4, BOTTOM, BACK, (0.8, 0.25, 0.9))),
    *((-1.4, -1.4, BACK, (0.1, 0.85, 0.9)), (0.0, 0.0, BACK, (0.85, 0.95, 0.1))),
)
TRIANGLE_STRIP = (
    *((LEFT, 0.0, FRONT, (1.0, 0.0, 0.0)), (-2.25, TOP, FRONT, (0.0, 1.0, 0.0))),
    *((-2.0, BOTTOM, FRONT, (0.0, 0.0, 1.0)), (-1.3, 1.6, 1.15, (0.25, 0.0, 0.8))),
    *((0.0, -1.5, 1.3, (0.75, 0.0, 0.25)), (0.4, 1.0, 1.7, _grey(0.33)), (1.4, -0.6, BACK, _grey(0.7))),
    (RIGHT, TOP, BACK, (0.5, 0.5, 0.6)),
)
TRIANGLE_FAN = (
    *((0.0, -0.75, FRONT, _grey(1.0)), (-2.25, BOTTOM, FRONT, (0.0, 0.0, 1.0))),
    *((-2.0, TOP, FRONT, (0.0, 1.0, 0.0)), (-0.6, 0.65, 1.15, (0.25, 0.0, 0.8))),
    *((0.0, 1.5, 1.3, (0.75, 0.0, 0.25)), (0.4, 1.0, 1.7, _grey(0.33)), (2.4, 0.6, BACK, _grey(0.7))),
    (RIGHT, BOTTOM, BACK, (0.5, 0.5, 0.6)),
)
QUADS = (
    *((LEFT, TOP, FRONT, _grey(1.0)), (-0.6, 1.6, 1.7, (0.5, 0.5, 0.6))),
    *((-1.35, -0.6, 1.7, _grey(0.7)), (-2.4, BOTTOM, 1.7, _grey(0.33))),
    *((0.06, -0.09, FRONT, (1.0, 0.0, 1.0)), (1.9, -0.25, FRONT, (0.1, 0.3, 0.6))),
    *((2.62, -1.03, FRONT, (1.0, 1.0, 0.0)), (1.25, -1.65, FRONT, (0.0, 1.0, 1.0))),
    *((-1.25, 1.3, BACK, _grey(0.25)), (0.3, 1.25, BACK, (0.1, 0.3, 0.1))),
    *((2.62, -0.03, BACK, _grey(0.65)), (-1.0, -1.0, BACK, _grey(0.45))),
)
QUAD_STRIP = (
    *((LEFT, BOTTOM, FRONT, _grey(0.33)), (LEFT, TOP, FRONT, _grey(1.0))),
    *((0.0, -1.35, FRONT, (0.7, 0.1, 0.0)), (0.0, 1.0, FRONT, (0.0, 0.9, 0.2))),
    *((RIGHT, BOTTOM, FRONT, _grey(0.33)), (RIGHT, TOP, FRONT, (0.0, 0.7, 0.9))),
)
POLYGON = (
    (LEFT, BOTTOM, FRONT, _grey(0.33)),
    (-1.4, 1.1, FRONT, (0.7, 0.1, 0.0)),
    (-0.3, TOP, FRONT, (0.1, 0.7, 0.5)),
    (2.0, 0.3, FRONT, (0.0, 0.9, 0.2)),
    (RIGHT, -1.5, FRONT, _grey(0.7)),
)
SHAPES = {
    "Points": (PrimitiveType.POINTS, LINES),
    "Lines": (PrimitiveType.LINES, LINES),
    "LineLoop": (PrimitiveType.LINE_LOOP, LINES),
    "LineStrip": (PrimitiveType.LINE_STRIP, LINES),
    "Triangles": (PrimitiveType.TRIANGLES, TRIANGLES),
    "TriStrip": (PrimitiveType.TRIANGLE_STRIP, TRIANGLE_STRIP),
    "TriFan": (PrimitiveType.TRIANGLE_FAN, TRIANGLE_FAN),
    "Quads": (PrimitiveType.QUADS, QUADS),
    "QuadStrip": (PrimitiveType.QUAD_STRIP, QUAD_STRIP),
    "Polygon": (PrimitiveType.POLYGON, POLYGON),
}


SMOOTHING = ("", "-ls", "-ls-ps", "-ps")
TESTS = sorted(shape + way + smooth for shape in SHAPES for way in WAYS for smooth in SMOOTHING)
BUFFERS = 3  # Source: pbkit, which shows one while another is drawn
SURFACE = "samples"
# What lies under this one is another suite's: the third test before it would be.
UNKNOWN_BELOW = "LineLoop-inlinearrays-ls"


def _is_smooth(name):
    return "-ls" in name or "-ps" in name


def _scene(name):
    """What a test draws, on the window or on its surface."""
    primitive, vertices = SHAPES[name.split("-")[0]]
    lines = "-ls" in name
    mesh = Mesh(
        scenes.single([vertex[:3] for vertex in vertices]),
        primitive,
        colors=scenes.single([vertex[3] for vertex in vertices]),
    )
    rasterization = LineRasterization.RECTANGLE if lines else LineRasterization.STEPS
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.xdk_vertex(depth_maximum=65535.0),
        polygon=replace(scenes.FRONT_FACES, smooth="-ps" in name),
        line=LineState(rasterization=rasterization, smooth=lines),
        depth_test=DepthTest(ComparisonFunction.LESS),
    )
    return scenes.clear(0xFF303030), Draw(label=name, mesh=mesh, state=state)


def _picture(name):
    """Commands that leave a test's picture in its buffer: a smooth one lies over the test's before it
    there.
    """
    if not _is_smooth(name):
        return _scene(name)
    below = TESTS[TESTS.index(name) - BUFFERS]
    texels = np.array([(0, 0), (WIDTH, 0), (WIDTH, HEIGHT), (0, HEIGHT)])
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit(SURFACE, scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    window = scenes.window_mesh(scenes.rectangle(0, 0, WIDTH, HEIGHT), texture_coordinates=(texels,))
    return (
        *_picture(below),
        MakeCurrent(label=SURFACE, surface=SURFACE, width=WIDTH, height=HEIGHT, depth_bits=16),
        *_scene(name),
        BindTexImage(
            label=SURFACE,
            texture=SURFACE,
            surface=SURFACE,
            target=TextureTarget.TEXTURE_RECTANGLE,
            origin=WindowOrigin.UPPER_LEFT,
        ),
        MakeCurrent(label="window"),
        Draw(label="shown", mesh=window, state=state),
    )


def _case(name):
    return Case(commands=_picture(name), depth_bits=16)


# Every case of the suite whose picture is its own suite's alone.
CASES = {test: partial(_case, test) for test in TESTS if test != UNKNOWN_BELOW}
