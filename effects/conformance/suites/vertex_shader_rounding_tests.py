"""Vertex_shader_rounding_tests: where the edges of primitives fall, near and on the grid to which they snap.

Source: src/tests/vertex_shader_rounding_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from effects.conformance import scenes
from effects.conformance.case import HEIGHT, WIDTH, Case
from pipeline.commands import Draw, Mesh
from pipeline.enums import PrimitiveType
from pipeline.state import Composite, VertexState

SUITE = "Vertex_shader_rounding_tests"

BIASES = (0.0, 0.001, 0.4999, 0.5, 0.5624, 0.5625, 0.5626, 0.999, 1.0)  # pixels
GEOMETRY = {f"Geometry_{bias:.4f}": bias for bias in BIASES}
ADJACENT = {f"AdjacentGeometry_{bias:.4f}": bias for bias in BIASES}

MAGENTA, GREEN, GREY = 0xFFFF00FF, 0xFF009900, 0xFFE0E0E0  # 0xAABBGGRR

# What the combiners put out where TopLeftRaster draws: 0xAARRGGBB.
RASTER_COLOR, RASTER_BACKGROUND = 0xFF337788, 0xFF202224


def names():
    """Every case of the suite that needs no surface but the window."""
    return [*GEOMETRY, *ADJACENT, "TopLeftRaster", "TopLeftRaster_Fixed"]


def _quad(label, corners, word):
    mesh = scenes.window_mesh(corners, colors=np.tile(scenes.abgr(word), (4, 1)))
    return Draw(label=label, mesh=mesh, state=scenes.DEFAULT)


def _geometry(bias):
    """A magenta square, and over it a green one whose upper left corner is moved by ``bias`` pixels."""
    left, top, right, bottom = 200.0, 120.0, 440.0, 360.0
    return (
        scenes.clear(0xFE404040),
        _quad("square", scenes.rectangle(left, top, right, bottom), MAGENTA),
        _quad("moved square", scenes.rectangle(left + bias, top + bias, right, bottom), GREEN),
    )


def _adjacent(bias):
    """A grey rectangle, and over it two rows of four green squares that share their edges, all moved."""
    left, top, size = WIDTH / 2 - 200, HEIGHT / 2 - 100, 100.0
    squares = [
        _quad(
            "square",
            np.add(scenes.rectangle(x, y, x + size, y + size), (bias, bias, 0.0)),
            GREEN,
        )
        for y in (top, top + size)
        for x in left + size * np.arange(4)
    ]
    background = _quad("background", scenes.rectangle(left, top, left + 4 * size, top + 2 * size), GREY)
    return (scenes.clear(0xFE404040), background, *squares)


def _below(x):
    """The single precision number just below a positive one."""
    return float(np.nextafter(np.float32(x), np.float32(0)))


def _raster_columns():
    """Upright slivers from the left, 4 pixels apart: polygons of device pixels."""
    top, upper, lower, bottom = 45.0, 135.0, 315.0, 450.0
    x = 4.0
    for i in range(20):
        yield (_below(x + 0.5), top), (x + 1.9, top), (x + 1.9, lower), (x + 0.5 + i / 16, lower)
        x += 4
    for i in range(16):
        left = _below(x + 0.5 - i / 16)
        yield (left, top), (x + 0.5625 + i / 16, bottom), (left, bottom)
        x += 4
    for left, right in ((0.9, 1.1), (0.0, 0.5), (0.4, 0.6)):
        yield (x + left, top), (x + right, top), (x + right, bottom), (x + left, bottom)
        x += 4
    for left, right in (
        ((x + 0.5, _below(x + 0.5625), x + 0.5625), (x + 2.4,) * 3),
        ((x + 4.5,) * 3, (x + 5.0, _below(x + 5.5625), x + 5.5625)),
    ):
        for k, (y0, y1) in enumerate(((top, upper), (upper, lower), (lower, bottom))):
            yield (left[k], y0), (right[k], y0), (right[k], y1), (left[k], y1)
    x += 24
    for left, y in ((_below(x + 0.5), 100.0), (x + 0.4375, 200.0), (x + 0.5, 300.0)):
        yield (left, y), (left, y - 50), (x + 0.5625, y - 50), (x + 0.5625, y)


def _raster_rows():
    """The same lying down, on the right, and what crosses the window's upper and left edges."""
    x0, x1, x2, x3 = 320.0, 420.0, 520.0, 620.0
    y = 45.0
    for i in range(20):
        yield (x0, y + 1.9), (x0, _below(y + 0.5)), (x2, y + 0.5 + i / 16), (x2, y + 1.9)
        y += 4
    for i in range(16):
        top = _below(y + 0.5 - i / 16)
        yield (x0, top), (x3, top), (x3, y + 0.5625 + i / 16)
        y += 4
    for top, bottom in ((0.9, 1.1), (0.0, 0.5), (0.4, 0.6)):
        yield (x3, y + top), (x3, y + bottom), (x0, y + bottom), (x0, y + top)
        y += 4
    for top, bottom in (
        ((y + 0.5, _below(y + 0.5625), y + 0.5625), (y + 2.4,) * 3),
        ((y + 4.5,) * 3, (y + 5.0, _below(y + 5.5625), y + 5.5625)),
    ):
        for k, (left, right) in enumerate(((x0, x1), (x1, x2), (x2, x3))):
            yield (right, top[k]), (right, bottom[k]), (left, bottom[k]), (left, top[k])
    y += 24
    for left, top in ((320.0, _below(y + 0.5)), (440.0, y + 0.4375), (560.0, y + 0.5)):
        yield (left, top), (left + 60, top), (left + 60, y + 0.5625), (left, y + 0.5625)
    for top, bottom in ((455.5, 456.6), (460.4, 461.5)):
        yield (10.0, top), (630.0, top), (630.0, bottom), (10.0, bottom)
    for left, low in ((-0.0625, 100.0), (-0.0624, 200.0), (0.0, 300.0)):
        yield (left, low), (left, low - 50), (1.0, low - 50), (1.0, low)
    for top, left in ((-0.0625, 320.0), (-0.0624, 440.0), (0.0, 560.0)):
        yield (left, top), (left + 60, top), (left + 60, 1.0), (left, 1.0)


def _raster(fixed_function):
    state = (
        replace(scenes.DEFAULT, vertex=VertexState(composite=Composite()))
        if fixed_function
        else scenes.DEFAULT
    )
    for number, corners in enumerate((*_raster_columns(), *_raster_rows())):
        primitive = PrimitiveType.QUADS if len(corners) == 4 else PrimitiveType.TRIANGLES
        colors = np.tile(scenes.argb(RASTER_COLOR), (len(corners), 1))
        if fixed_function:
            mesh = Mesh(scenes.single(corners), primitive, colors=colors)
        else:
            mesh = scenes.window_mesh(corners, primitive, colors=colors)
        yield Draw(label=f"sliver {number}", mesh=mesh, state=state)


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name in GEOMETRY:
        return Case(commands=_geometry(GEOMETRY[name]))
    if name in ADJACENT:
        return Case(commands=_adjacent(ADJACENT[name]))
    if name in ("TopLeftRaster", "TopLeftRaster_Fixed"):
        return Case(commands=(scenes.clear(RASTER_BACKGROUND), *_raster(name.endswith("_Fixed"))))
    return None
