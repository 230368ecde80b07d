"""Rectangles of pixels and of vertices, raster positions, and what moves them."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Bitmap, CopyPixels, DrawPixels
from fixedpipe.pipeline.enums import PixelCopyType, PixelTexGenMode
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.rectangles import raster_position
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import PixelTexture, RasterPosition
from tests.pipeline.opengl.drawn import context, counted, draws, refusals

_RED, _GREEN = (255, 0, 0, 255), (0, 255, 0, 255)


class Screen:
    """A Context of 8 x 8 pixels and its machine."""

    def __init__(self, profile="GEFORCE_3"):
        self.gl = context(profile, 8, 8)
        self.machine = Machine(PROFILES[profile], 8, 8)

    def picture(self):
        """uint8 [h, w, 4] after the commands so far, bottom row first."""
        return self.machine.run(self.gl.take_commands()).image()[::-1]


def _pixels(gl, color=_RED, width=1, height=1):
    gl.DrawPixels(width, height, GL.RGBA, GL.UNSIGNED_BYTE, bytes(color) * width * height)


def _lit(picture):
    """[(x, y)] of pixels that are not black."""
    return [(int(x), int(y)) for y, x in np.argwhere(picture[..., :3].any(-1))]


# ------------------------------------------------------------------------------------------ raster positions


def test_the_initial_position_is_the_windows_corner():
    """Whatever the matrices are: it is a position in the window, and no object's (0, 0, 0)."""
    screen = Screen()
    screen.gl.MatrixMode(GL.PROJECTION)
    screen.gl.Translatef(0.5, 0.5, 0)
    _pixels(screen.gl)
    assert _lit(screen.picture()) == [(0, 0)]


def test_a_position_is_transformed_when_it_is_set():
    screen = Screen()
    screen.gl.Translatef(0.5, 0, 0)
    screen.gl.RasterPos2f(0, 0)
    screen.gl.LoadIdentity()
    screen.gl.Viewport(0, 0, 1, 1)
    _pixels(screen.gl)
    assert _lit(screen.picture()) == [(6, 4)]


def test_a_position_takes_the_current_values():
    screen = Screen()
    screen.gl.Color3f(1, 0, 0)
    screen.gl.RasterPos2i(0, 0)
    screen.gl.Color3f(0, 1, 0)
    screen.gl.Bitmap(1, 1, 0, 0, 1, 0, b"\x80")
    screen.gl.RasterPos2i(0, 0)
    screen.gl.Bitmap(1, 1, 1, 0, 0, 0, b"\x80")
    picture = screen.picture()
    assert picture[4, 3].tolist() == list(_GREEN)
    assert picture[4, 4].tolist() == list(_RED)


def test_a_position_outside_the_view_draws_nothing_wherever_it_is_moved():
    screen = Screen()
    screen.gl.RasterPos2f(-2, 0)
    screen.gl.Bitmap(0, 0, 0, 0, 8, 0, None)
    _pixels(screen.gl)
    assert _lit(screen.picture()) == []
    screen.gl.RasterPos2f(-1, -1)
    screen.gl.Bitmap(0, 0, 0, 0, -2, 3, None)  # so a position may leave the window
    screen.gl.PixelZoom(3, 1)
    _pixels(screen.gl)
    assert _lit(screen.picture()) == [(0, 3)]


@pytest.mark.parametrize(
    ("call", "arguments", "position", "window"),
    [
        ("RasterPos2s", (1, 2), (1.0, 2.0, 0.0, 1.0), False),
        ("RasterPos4dv", ([1, 2, 3, 4],), (1.0, 2.0, 3.0, 4.0), False),
        ("RasterPos3fv", (np.float32([1, 2, 3, 9]),), (1.0, 2.0, 3.0, 1.0), False),
        ("WindowPos2iARB", (3, 4), (3.0, 4.0, 0.0, 1.0), True),
        ("WindowPos3fvMESA", ([3, 4, 0.5],), (3.0, 4.0, 0.5, 1.0), True),
    ],
)
def test_every_call_sets_a_position(call, arguments, position, window):
    gl = context()
    getattr(gl, call)(*arguments)
    found = raster_position(gl)
    assert (found.position, found.window) == (position, window)
    assert not refusals(gl)


def test_a_window_position_has_the_window_as_it_is():
    screen = Screen()
    screen.gl.Viewport(4, 4, 2, 2)
    screen.gl.WindowPos2i(1, 6)
    _pixels(screen.gl)
    assert _lit(screen.picture()) == [(1, 6)]


def test_a_position_that_is_no_number_leaves_the_earlier_one():
    gl = context()
    gl.RasterPos2f(0.5, 0.5)
    gl.RasterPos2f(float("nan"), 0)
    assert raster_position(gl).position[:2] == (0.5, 0.5)
    assert gl.tally.count("left out") == 1


def test_textured_rectangles_have_the_coordinates_of_their_position():
    screen = Screen()
    gl = screen.gl
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_MIN_FILTER, GL.NEAREST)
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_MAG_FILTER, GL.NEAREST)
    texels = np.zeros((2, 2, 4), np.uint8)
    texels[...] = _RED
    texels[0, 0] = _GREEN
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 2, 2, 0, GL.RGBA, GL.UNSIGNED_BYTE, texels)
    gl.TexEnvi(GL.TEXTURE_ENV, GL.TEXTURE_ENV_MODE, GL.REPLACE)
    gl.Enable(GL.TEXTURE_2D)
    gl.MatrixMode(GL.TEXTURE)
    gl.Scalef(0.25, 0.25, 1)
    gl.TexCoord2f(1.5, 1.5)
    gl.WindowPos2i(0, 0)
    gl.MatrixMode(GL.MODELVIEW)
    gl.RasterPos2f(0, 0)  # by the texture matrix
    gl.MatrixMode(GL.TEXTURE)
    gl.LoadIdentity()
    _pixels(gl, (255, 255, 255, 255))
    assert screen.picture()[4, 4].tolist() == list(_GREEN)
    assert not refusals(gl)


# -------------------------------------------------------------------------------------------------- pixels


def test_an_image_is_drawn_and_zoomed():
    screen = Screen()
    image = np.random.default_rng(0).integers(0, 256, (2, 3, 4), np.uint8)
    screen.gl.WindowPos2i(1, 1)
    screen.gl.PixelZoom(2.0, 3.0)
    screen.gl.DrawPixels(3, 2, GL.RGBA, GL.UNSIGNED_BYTE, image)
    expected = np.zeros((8, 8, 4), np.uint8)
    expected[1:7, 1:7] = image.repeat(3, 0).repeat(2, 1)
    np.testing.assert_array_equal(screen.picture()[..., :3], expected[..., :3])
    assert not refusals(screen.gl)


def test_stencil_values_and_depths_are_drawn():
    screen = Screen()
    gl = screen.gl
    gl.Clear(GL.STENCIL_BUFFER_BIT | GL.DEPTH_BUFFER_BIT)
    gl.PixelStorei(GL.UNPACK_ALIGNMENT, 1)
    gl.DrawPixels(4, 1, GL.STENCIL_INDEX, GL.UNSIGNED_BYTE, bytes((0, 1, 2, 1)))
    gl.Enable(GL.STENCIL_TEST)
    gl.StencilFunc(GL.EQUAL, 1, 255)
    gl.Color3f(1, 0, 0)
    gl.Rectf(-1, -1, 1, 1)
    assert _lit(screen.picture()) == [(1, 0), (3, 0)]
    gl.Disable(GL.STENCIL_TEST)
    gl.Enable(GL.DEPTH_TEST)
    gl.ColorMask(False, False, False, False)
    gl.DrawPixels(2, 1, GL.DEPTH_COMPONENT, GL.FLOAT, np.float32([0.25, 0.75]))
    gl.ColorMask(True, True, True, True)
    gl.Color3f(0, 1, 0)
    gl.Rectf(-1, -1, 1, 1)
    picture = screen.picture()
    assert picture[0, :2].tolist() == [[0, 0, 0, 0], list(_GREEN)]
    assert not refusals(gl)


def test_pixels_are_copied_from_what_lies_in_the_window():
    screen = Screen()
    gl = screen.gl
    image = np.random.default_rng(1).integers(0, 256, (8, 8, 4), np.uint8)
    gl.DrawPixels(8, 8, GL.RGBA, GL.UNSIGNED_BYTE, image)
    gl.WindowPos2i(3, 2)
    gl.CopyPixels(-1, -2, 3, 4, GL.COLOR)
    expected = image.copy()
    expected[4:6, 4:6] = image[:2, :2]
    np.testing.assert_array_equal(screen.picture(), expected)
    assert not refusals(gl)


@pytest.mark.parametrize(
    ("kind", "copied"),
    [
        (GL.COLOR, PixelCopyType.COLOR),
        (GL.DEPTH, PixelCopyType.DEPTH),
        (GL.STENCIL, PixelCopyType.STENCIL),
    ],
)
def test_copies_of_every_buffer(kind, copied):
    gl = context()
    gl.PixelZoom(2, -1)
    gl.CopyPixels(1, 2, 3, 4, kind)
    (command,) = gl.take_commands()
    assert isinstance(command, CopyPixels)
    assert (command.type, command.zoom) == (copied, (2.0, -1.0))
    assert (command.x, command.y, command.width, command.height) == (1, 2, 3, 4)


@pytest.mark.parametrize(
    ("call", "arguments", "kind"),
    [
        ("DrawPixels", (-1, 1, GL.RGBA, GL.UNSIGNED_BYTE, b""), GL.INVALID_VALUE),
        ("DrawPixels", (1, 1, GL.RGBA, GL.BITMAP, b"1"), GL.INVALID_ENUM),
        ("DrawPixels", (1, 1, GL.HILO_NV, GL.UNSIGNED_BYTE, b"12"), GL.INVALID_ENUM),
        ("CopyPixels", (0, 0, 1, -1, GL.COLOR), GL.INVALID_VALUE),
        ("CopyPixels", (0, 0, 1, 1, GL.RGBA), GL.INVALID_ENUM),
        ("Bitmap", (1, -1, 0, 0, 0, 0, b"1"), GL.INVALID_VALUE),
        ("ReadPixels", (0, 0, -1, 1, GL.RGBA, GL.UNSIGNED_BYTE), GL.INVALID_VALUE),
        ("ReadPixels", (0, 0, 1, 1, GL.RGBA, 77), GL.INVALID_ENUM),
    ],
)
def test_rectangles_that_opengl_refuses(call, arguments, kind):
    gl = context()
    getattr(gl, call)(*arguments)
    assert gl.error == kind
    assert not gl.commands


def test_nothing_is_drawn_of_no_pixels():
    gl = context()
    gl.DrawPixels(0, 4, GL.RGBA, GL.UNSIGNED_BYTE, None)
    gl.Bitmap(8, 1, 0, 0, 0, 0, b"\0")
    gl.DrawPixels(1, 1, GL.RGBA, GL.UNSIGNED_BYTE, None)
    assert not gl.commands
    assert counted(gl, "left out") == [("glDrawPixels: its image lies at a null pointer", 1)]


def test_depths_are_written_without_a_colour_buffer():
    """By rectangles and by polygons (section 4.2.1); the colours stay."""
    screen = Screen()
    gl = screen.gl
    gl.Enable(GL.DEPTH_TEST)
    gl.DepthFunc(GL.ALWAYS)
    gl.DrawBuffer(GL.NONE)
    gl.DrawPixels(1, 1, GL.DEPTH_COMPONENT, GL.FLOAT, np.zeros(1, np.float32).tobytes())
    gl.Begin(GL.POINTS)
    gl.Vertex3f(0.125, 0.125, -1.0)
    gl.End()
    gl.DrawBuffer(GL.BACK)
    assert not screen.picture()[..., :3].any()
    gl.DepthFunc(GL.LESS)
    gl.Color3f(1, 0, 0)
    gl.Rectf(-1, -1, 1, 1)
    picture = screen.picture()
    assert sorted(set(_lit(np.full((8, 8, 1), 255, np.uint8))) - set(_lit(picture))) == [(0, 0), (4, 4)]


# ------------------------------------------------------------------------------------------------- bitmaps


def test_bitmaps_write_text():
    """The position moves from letter to letter, also by bitmaps without pixels and inside lists."""
    screen = Screen()
    gl = screen.gl
    letter = bytes((0b11100000, 0b10100000))
    gl.PixelStorei(GL.UNPACK_ALIGNMENT, 1)
    gl.NewList(1, GL.COMPILE)
    gl.Bitmap(3, 2, 1, 0, 4, 0, letter)
    gl.EndList()
    gl.WindowPos2i(1, 2)
    gl.CallList(1)
    gl.CallList(1)
    assert _lit(screen.picture()) == [
        (x, y) for y in (2, 3) for x in (0, 1, 2, 4, 5, 6) if y == 2 or x not in (1, 5)
    ]
    assert raster_position(gl).move == (8.0, 0.0)
    assert not refusals(gl)


def test_a_bitmap_is_read_bottom_row_first_by_the_pixel_store():
    gl = context()
    gl.PixelStorei(GL.UNPACK_LSB_FIRST, 1)
    gl.PixelStorei(GL.UNPACK_ALIGNMENT, 1)
    gl.Bitmap(3, 2, 0.5, 0, 0, 0, bytes((0b001, 0b110)))
    (command,) = gl.take_commands()
    assert isinstance(command, Bitmap)
    assert command.bits.tolist() == [[True, False, False], [False, True, True]]
    assert command.origin == (0.5, 0.0)
    assert command.position == RasterPosition(window=True, texture_coordinates=((0.0, 0.0, 0.0, 1.0),) * 8)


def test_a_bitmap_that_cannot_be_read_moves_the_position():
    gl = context()
    gl.Bitmap(8, 8, 0, 0, 5, 0, b"1")
    assert gl.tally.count("refused") == 1
    assert raster_position(gl).move == (5.0, 0.0)


# ------------------------------------------------------------------------------------------ pixel textures


def test_groups_become_texture_coordinates_where_a_unit_is_enabled():
    gl = context("OCTANE")
    gl.Enable(GL.PIXEL_TEX_GEN_SGIX)
    gl.PixelTexGenSGIX(GL.RGB)
    _pixels(gl)
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_MIN_FILTER, GL.NEAREST)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 1, 1, 0, GL.RGBA, GL.UNSIGNED_BYTE, bytes(4))
    gl.Enable(GL.TEXTURE_2D)
    _pixels(gl)
    found = [c.pixel_texture for c in gl.take_commands() if isinstance(c, DrawPixels)]
    assert found == [None, PixelTexture(PixelTexGenMode.RGB)]
    without = context("GEFORCE_3")
    without.PixelTexGenSGIX(GL.RGB)
    assert without.tally.count("refused") == 1


# ------------------------------------------------------------------------------------ rectangles of vertices


@pytest.mark.parametrize("vector", [False, True])
def test_a_rectangle_is_a_polygon_of_four_vertices(vector):
    gl, written = context(), context()
    if vector:
        gl.Rectdv([-0.5, -1.0], [0.5, 1.0])
    else:
        gl.Rectd(-0.5, -1.0, 0.5, 1.0)
    written.Begin(GL.POLYGON)
    for corner in ((-0.5, -1), (0.5, -1), (0.5, 1), (-0.5, 1)):
        written.Vertex2f(*corner)
    written.End()
    assert draws(gl) == draws(written)
    gl.Begin(GL.POINTS)
    gl.Recti(0, 0, 1, 1)
    gl.End()
    assert gl.error == GL.INVALID_OPERATION
