"""Vertex_shader_rounding_tests: where the edges of primitives fall, near and on the grid to which they snap.

Source: src/tests/vertex_shader_rounding_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.suites import viewport
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent, Mesh, TexImage
from fixedpipe.pipeline.enums import ComponentUsage, PrimitiveType, Register, TextureTarget, WindowOrigin
from fixedpipe.pipeline.state import CombinerInput, Composite, TextureUnit, VertexState
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Vertex_shader_rounding_tests"

BIASES = (0.0, 0.001, 0.4999, 0.5, 0.5624, 0.5625, 0.5626, 0.999, 1.0)  # pixels

MAGENTA, GREEN, FIXED_GREEN, GREY = 0xFFFF00FF, 0xFF009900, 0xFF00BB00, 0xFFE0E0E0  # 0xAABBGGRR
TARGET_COLOR = 0xFF887733  # 0xAABBGGRR, of RenderTarget's quad

LEFT, TOP, SQUARE = WIDTH / 2 - 200, HEIGHT / 2 - 100, 100.0  # the rows of squares, device pixels
SHOWN = ((248, 168, 128, 128), (392, 168, 128, 32), (248, 312, 32, 128), (392, 312, 16, 64))  # x, y, size
LARGE = 1024  # edge of the surface that is larger than the screen, pixels
PASSES, HALF = 4, 127 / 255  # of Compositing, and the factor of alpha in each. Source: 0.5, cut to a byte

# What the combiners put out where TopLeftRaster draws: 0xAARRGGBB.
RASTER_COLOR, RASTER_BACKGROUND = 0xFF337788, 0xFF202224


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


def _squares():
    """Upper left corners of two rows of four squares."""
    return [(LEFT + SQUARE * i, TOP + SQUARE * j) for j in range(2) for i in range(4)]


def _adjacent(bias):
    """A grey rectangle, and over it two rows of four green squares that share their edges, all moved."""
    squares = [
        _quad("square", np.add(scenes.rectangle(x, y, x + SQUARE, y + SQUARE), (bias, bias, 0.0)), GREEN)
        for x, y in _squares()
    ]
    corners = scenes.rectangle(LEFT, TOP, LEFT + 4 * SQUARE, TOP + 2 * SQUARE)
    return (scenes.clear(0xFE404040), _quad("background", corners, GREY), *squares)


def _projected(bias):
    """The same through a perspective vertex program and, every other square, through the fixed functions."""
    draws = viewport.draws((GREY, GREEN, FIXED_GREEN), scenes.XDK_OFFSET, bias)
    return (scenes.clear(0xFE404040), *draws)


# ---------------------------------------------------------------------------------- surfaces and textures


def _surface_quad(label, box, word, height):
    left, top, right, bottom = box
    return scenes.quad(label, scenes.rectangle(left, top, right, bottom), scenes.abgr(word), height=height)


def _bound(surface):
    """The surface as a texture of that name, whose coordinates are texels, the first row on top."""
    return BindTexImage(
        label=surface,
        texture=surface,
        surface=surface,
        target=TextureTarget.TEXTURE_RECTANGLE,
        origin=WindowOrigin.UPPER_LEFT,
    )


def _textured(label, texture, mesh, vertex=scenes.PROGRAM_RESULTS, **state):
    state = {"register_combiners": scenes.SHOWS_TEXTURE0} | state
    units = (TextureUnit(texture, scenes.NEAREST),)
    return Draw(
        label=label, mesh=mesh, state=replace(scenes.DEFAULT, vertex=vertex, texture_units=units, **state)
    )


def _texels(left, top, right, bottom):
    return np.array([(left, top), (right, top), (right, bottom), (left, bottom)], np.float64)


def _facing(z, texels):
    """A square of edge 3.5 that faces the eye at the depth ``z``."""
    corners = scenes.single(
        [(x, y, z) for x, y in ((-1.75, 1.75), (1.75, 1.75), (1.75, -1.75), (-1.75, -1.75))]
    )
    return Mesh(corners, PrimitiveType.QUADS, texture_coordinates=(texels,))


def _shown(surface, left, top, width, height):
    """The window with the surface's upper left part on it."""
    corners = scenes.rectangle(left, top, left + width, top + height)
    mesh = scenes.window_mesh(corners, texture_coordinates=(_texels(0, 0, width, height),))
    return _bound(surface), MakeCurrent(label="window"), _textured(surface, surface, mesh)


def _subscreen(bias):
    """Magenta surfaces smaller than the screen, and on each a moved green rectangle of its size."""
    yield scenes.clear(0xFE414041)
    for left, top, width, height in SHOWN:
        name = f"{width}x{height}"
        yield MakeCurrent(label=name, surface=name, width=width, height=height)
        yield _surface_quad("magenta", (0, 0, width, height), MAGENTA, height)
        yield _surface_quad("green", (bias, bias, width + bias, height + bias), GREEN, height)
        yield from _shown(name, left, top, width, height)


def _superscreen(bias):
    """The same on one surface larger than the screen.

    The program writes as many magenta pixels as the rectangle has, in the order of memory: some rows. The
    others hold what was drawn before. Inferred: green, of the case with the next smaller bias, which is drawn
    just before and covers the column that this one lets through.
    """
    yield scenes.clear(0xFE414041)
    name = "large surface"
    for number, (left, top, width, height) in enumerate(SHOWN):
        yield MakeCurrent(label=name, surface=name, width=LARGE, height=LARGE)
        if number == 0:
            yield _surface_quad("case before", (0, 0, width, height), GREEN, LARGE)
        yield _surface_quad("magenta", (0, 0, LARGE, width * height // LARGE), MAGENTA, LARGE)
        yield _surface_quad("green", (bias, bias, width + bias, height + bias), GREEN, LARGE)
        yield from _shown(name, left, top, width, height)


def _compositing(z):
    """A checkerboard on a surface, whose left half is blended with itself, alpha halved, four times."""
    image = np.zeros((HEIGHT, WIDTH, 4), np.uint8)
    left, top = (WIDTH - 256) // 2, (HEIGHT - 256) // 2
    image[top : top + 256, left : left + 256] = scenes.checkerboard(0xFF00FFFF, 0xFF000000, 8)
    image = replace(texture_2d(image), target=TextureTarget.TEXTURE_RECTANGLE)
    name, whole = "composited", _texels(0, 0, WIDTH, HEIGHT)
    mesh = scenes.window_mesh(scenes.rectangle(0, 0, WIDTH, HEIGHT), texture_coordinates=(whole,))
    half = scenes.window_mesh(
        scenes.rectangle(0, 0, WIDTH // 2, HEIGHT), texture_coordinates=(_texels(0, 0, WIDTH // 2, HEIGHT),)
    )
    (combiner,) = scenes.SHOWS_TEXTURE0.general
    factor = CombinerInput(Register.CONSTANT_COLOR1, usage=ComponentUsage.ALPHA)
    combiner = replace(
        combiner, alpha=replace(combiner.alpha, b=factor), constant_color1=(0.0, 0.0, 0.0, HALF)
    )
    halved = replace(scenes.SHOWS_TEXTURE0, general=(combiner,))
    yield scenes.clear(0xFE202020)
    yield TexImage(label="checkerboard", texture="checkerboard", image=image)
    yield MakeCurrent(label=name, surface=name, width=WIDTH, height=HEIGHT)
    yield _textured("checkerboard", "checkerboard", mesh, blending=None)
    for _ in range(PASSES):
        yield _bound(name)
        yield _textured("pass", name, half, register_combiners=halved)
    yield _bound(name)
    yield MakeCurrent(label="window")
    yield _textured("shown", name, _facing(z, whole), scenes.xdk_vertex())


def _render_target():
    """A surface, filled by a vertex program that adds the XDK's viewport offset, on a square."""
    name, edge, offset = "render target", 128, scenes.XDK_OFFSET
    yield scenes.clear(0xFE202020)
    yield MakeCurrent(label=name, surface=name, width=edge, height=edge)
    yield _surface_quad("magenta", (0, 0, edge, edge), MAGENTA, edge)
    yield _surface_quad("fills", (offset, offset, WIDTH + offset, HEIGHT + offset), TARGET_COLOR, edge)
    yield _bound(name)
    yield MakeCurrent(label="window")
    mesh = _facing(0.1, _texels(0, 0, WIDTH, HEIGHT))  # more than the texture, whose last texels go on
    yield _textured("shown", name, mesh, scenes.xdk_vertex())


# ------------------------------------------------------------------------------------------- TopLeftRaster


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
    yield scenes.clear(RASTER_BACKGROUND)
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


CASES = {
    **{
        f"{kind}_{bias:.4f}": partial(Case.of, commands, bias)
        for kind, commands in (
            ("Geometry", _geometry),
            ("AdjacentGeometry", _adjacent),
            ("ProjAdjacentGeometry", _projected),
            ("GeometrySubscreen", _subscreen),
            ("GeometrySuperscreen", _superscreen),
        )
        for bias in BIASES
    },
    **{f"Compositing_{z}": partial(Case.of, _compositing, float(z)) for z in (-4, -2, 2)},
    "RenderTarget": partial(Case.of, _render_target),
    "TopLeftRaster": partial(Case.of, _raster, False),
    "TopLeftRaster_Fixed": partial(Case.of, _raster, True),
}
