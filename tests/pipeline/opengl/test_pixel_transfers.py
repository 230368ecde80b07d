"""Pixel transfer as state: numbers, maps, tables, filters and counters become a PixelTransfer."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import DrawPixels, ReadPixels, ResetHistogram, ResetMinmax
from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.pixel_transfers import transfer_of
from fixedpipe.pipeline.opengl.texturing import bound_object
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER, ConvolutionFilter, Histogram, Minmax
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import ColorTable
from tests.pipeline.opengl.drawn import context, counted, refusals

_IMAGING = "OPENGL_1_2_IMAGING"
_RED = ((1.0, 0.0, 0.0, 1.0),)


def test_the_initial_transfer_is_the_one_that_changes_nothing():
    assert transfer_of(context()) is INITIAL_TRANSFER
    assert transfer_of(context(_IMAGING)) is INITIAL_TRANSFER


@pytest.mark.parametrize(
    ("name", "field", "place"),
    [
        ("RED_SCALE", "scale", 0),
        ("ALPHA_SCALE", "scale", 3),
        ("GREEN_BIAS", "bias", 1),
        ("POST_CONVOLUTION_BLUE_SCALE", "post_convolution_scale", 2),
        ("POST_CONVOLUTION_RED_BIAS", "post_convolution_bias", 0),
        ("POST_COLOR_MATRIX_ALPHA_SCALE", "post_color_matrix_scale", 3),
        ("POST_COLOR_MATRIX_GREEN_BIAS", "post_color_matrix_bias", 1),
        ("DEPTH_SCALE", "depth_scale", None),
        ("DEPTH_BIAS", "depth_bias", None),
        ("INDEX_SHIFT", "index_shift", None),
        ("INDEX_OFFSET", "index_offset", None),
        ("MAP_COLOR", "map_color", None),
        ("MAP_STENCIL", "map_stencil", None),
    ],
)
def test_every_number_has_its_field(name, field, place):
    gl = context(_IMAGING)
    gl.PixelTransferf(getattr(GL, name), 3.0)
    found, initial = transfer_of(gl), INITIAL_TRANSFER
    changed = {f for f in type(found).__dataclass_fields__ if getattr(found, f) != getattr(initial, f)}
    assert changed == {field}
    value = getattr(found, field) if place is None else getattr(found, field)[place]
    assert value == type(value)(3)
    assert not refusals(gl)


def test_what_a_machine_lacks_is_left_out_and_refused_by_name():
    gl = context("GEFORCE_256")
    gl.PixelTransferf(GL.POST_CONVOLUTION_RED_SCALE, 2.0)
    gl.Enable(GL.CONVOLUTION_2D)
    gl.Enable(GL.HISTOGRAM)
    gl.ConvolutionFilter2D(GL.CONVOLUTION_2D, GL.RGBA, 1, 1, GL.RGBA, GL.FLOAT, np.ones(4, np.float32))
    gl.Histogram(GL.HISTOGRAM, 16, GL.RGB, False)
    gl.ColorTable(GL.COLOR_TABLE, GL.RGBA, 2, GL.RGBA, GL.UNSIGNED_BYTE, bytes(8))
    assert transfer_of(gl) is INITIAL_TRANSFER
    assert [what.split("GeForce 256 has no ")[1] for what, _ in counted(gl, "refused")] == [
        "convolution",
        "histogram and no minmax",
        "GL_COLOR_TABLE",
    ]


def test_pixel_maps_of_three_types():
    gl = context()
    gl.PixelMapfv(GL.PIXEL_MAP_R_TO_R, 3, [0.25, 2.0, -1.0])
    gl.PixelMapusv(GL.PIXEL_MAP_I_TO_G, 2, [13107, 0])
    gl.PixelMapuiv(GL.PIXEL_MAP_A_TO_A, 1, np.array([2**32 - 1], np.uint32))
    gl.PixelMapuiv(GL.PIXEL_MAP_S_TO_S, 4, [3, 2, 1, 0])
    maps = transfer_of(gl).maps
    assert maps.r_to_r == (0.25, 1.0, 0.0)
    assert maps.i_to_g == (0.2, 0.0)
    assert maps.a_to_a == (1.0,)
    assert maps.s_to_s == (3, 2, 1, 0)
    assert not refusals(gl)


@pytest.mark.parametrize(
    ("name", "size", "numbers"),
    [
        (GL.PIXEL_MAP_I_TO_R, 3, [0.0] * 3),
        (GL.PIXEL_MAP_S_TO_S, 3, [0.0] * 3),
        (GL.PIXEL_MAP_R_TO_R, 0, []),
        (GL.PIXEL_MAP_R_TO_R, 257, [0.0] * 257),
        (GL.RED_SCALE, 1, [0.0]),
    ],
)
def test_pixel_maps_that_opengl_refuses(name, size, numbers):
    gl = context()
    gl.PixelMapfv(name, size, numbers)
    assert gl.tally.count("error") == 1
    assert transfer_of(gl) is INITIAL_TRANSFER


def test_indices_become_colours_by_the_maps():
    """Also of a texture, which has no colour-index format of its own."""
    gl = context()
    for name, entries in (("R", [0, 1]), ("G", [1, 0]), ("B", [0, 0.2]), ("A", [1, 1])):
        gl.PixelMapfv(getattr(GL, "PIXEL_MAP_I_TO_" + name), 2, entries)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 2, 1, 0, GL.COLOR_INDEX, GL.BITMAP, b"\x40")
    texels = bound_object(gl, GL.TEXTURE_2D).images[0, 0].texels.texels
    assert texels[0, 0].tolist() == [[0, 255, 0, 255], [255, 0, 51, 255]]


def test_pixel_transfer_changes_textures():
    gl = context()
    gl.PixelTransferf(GL.RED_SCALE, 0.5)
    gl.PixelTransferf(GL.GREEN_BIAS, 0.2)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGB, 1, 1, 0, GL.RGB, GL.UNSIGNED_BYTE, bytes((200, 100, 50)))
    texels = bound_object(gl, GL.TEXTURE_2D).images[0, 0].texels
    assert texels.texels.ravel().tolist() == [100, 151, 50, 255]


# ------------------------------------------------------------------------------------------- colour tables


def test_a_colour_table_is_scaled_clamped_and_of_its_format():
    gl = context(_IMAGING)
    gl.ColorTableParameterfv(GL.COLOR_TABLE, GL.COLOR_TABLE_SCALE, [2, 1, 1, 1])
    gl.ColorTableParameterfv(GL.COLOR_TABLE, GL.COLOR_TABLE_BIAS, [0, 0.5, 0, 0])
    entries = np.float32([[0.75, 0.25, 0.5], [0.25, 0.75, 0.5]])
    gl.ColorTable(GL.COLOR_TABLE, GL.RGB5, 2, GL.RGB, GL.FLOAT, entries)
    assert transfer_of(gl) is INITIAL_TRANSFER  # it is not enabled
    gl.Enable(GL.COLOR_TABLE)
    expected = ColorTable(((1.0, 0.75, 0.5, 1.0), (0.5, 1.0, 0.5, 1.0)), BaseFormat.RGB, 5)
    assert transfer_of(gl).color_table == expected
    gl.ColorSubTable(GL.COLOR_TABLE, 1, 1, GL.RGB, GL.FLOAT, np.float32([[0, 0, 0]]))
    assert transfer_of(gl).color_table.entries[1] == (0.0, 0.5, 0.0, 1.0)
    for token, field in (
        (GL.POST_CONVOLUTION_COLOR_TABLE, "post_convolution_color_table"),
        (GL.POST_COLOR_MATRIX_COLOR_TABLE, "post_color_matrix_color_table"),
    ):
        gl.ColorTable(token, GL.LUMINANCE, 1, GL.LUMINANCE, GL.UNSIGNED_BYTE, b"\xff")
        gl.Enable(token)
        assert getattr(transfer_of(gl), field).base_format is BaseFormat.LUMINANCE
    assert not refusals(gl)


@pytest.mark.parametrize(
    ("target", "internal", "width", "kind"),
    [
        (GL.COLOR_TABLE, GL.RGBA, 3, GL.INVALID_VALUE),
        (GL.COLOR_TABLE, GL.RGBA, 8192, GL.TABLE_TOO_LARGE),
        (GL.COLOR_TABLE, 4, 2, GL.INVALID_ENUM),
        (GL.TEXTURE_ENV, GL.RGBA, 2, GL.INVALID_ENUM),
    ],
)
def test_colour_tables_that_opengl_refuses(target, internal, width, kind):
    gl = context(_IMAGING)
    gl.ColorTable(target, internal, width, GL.RGBA, GL.UNSIGNED_BYTE, bytes(4 * width))
    assert gl.error == kind


def test_a_colour_tables_proxy_says_whether_it_would_fit():
    gl = context(_IMAGING)
    for width, held in ((4096, True), (8192, False), (64, True)):
        gl.ColorTable(GL.PROXY_COLOR_TABLE, GL.RGBA, width, GL.RGBA, GL.UNSIGNED_BYTE, None)
        table = gl.values["color table", GL.PROXY_COLOR_TABLE].table
        assert (table is not None) == held
    assert not refusals(gl)


def test_a_texture_color_table_belongs_to_the_units():
    gl = context("OCTANE")
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_MIN_FILTER, GL.NEAREST)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 1, 1, 0, GL.RGBA, GL.UNSIGNED_BYTE, bytes(4))
    gl.Enable(GL.TEXTURE_2D)
    gl.ColorTableSGI(GL.TEXTURE_COLOR_TABLE_SGI, GL.RGBA, 1, GL.RGBA, GL.FLOAT, np.float32(_RED))
    assert gl.state().texture_units[0].color_table is None
    gl.Enable(GL.TEXTURE_COLOR_TABLE_SGI)
    assert gl.state().texture_units[0].color_table.entries == _RED
    assert not refusals(gl)


# ---------------------------------------------------------------------------------- filters and their effect


def test_filters():
    gl = context(_IMAGING)
    gl.ConvolutionParameterfv(GL.CONVOLUTION_2D, GL.CONVOLUTION_FILTER_SCALE, [2, 2, 2, 2])
    gl.ConvolutionParameteri(GL.CONVOLUTION_2D, GL.CONVOLUTION_BORDER_MODE, GL.REPLICATE_BORDER)
    gl.ConvolutionParameterfv(GL.CONVOLUTION_2D, GL.CONVOLUTION_BORDER_COLOR, [0.5, -2, 0, 1])
    weights = np.arange(6, dtype=np.float32).reshape(2, 3) - 2
    gl.ConvolutionFilter2D(GL.CONVOLUTION_2D, GL.LUMINANCE, 3, 2, GL.LUMINANCE, GL.FLOAT, weights)
    assert transfer_of(gl) is INITIAL_TRANSFER  # it is not enabled
    gl.Enable(GL.CONVOLUTION_2D)
    found = transfer_of(gl).convolution_2d
    assert isinstance(found, ConvolutionFilter)
    assert found.base_format is BaseFormat.LUMINANCE
    assert [[color[0] for color in row] for row in found.rows] == (2 * weights).tolist()
    assert found.border_mode is ConvolutionBorderMode.REPLICATE_BORDER
    assert found.border_color == (0.5, -2.0, 0.0, 1.0)
    row, column = np.float32([1, 2, 3]), np.float32([4, 5])
    gl.SeparableFilter2D(GL.SEPARABLE_2D, GL.INTENSITY, 3, 2, GL.RED, GL.FLOAT, row, column)
    gl.Enable(GL.SEPARABLE_2D)
    separable = transfer_of(gl).separable_2d
    assert [color[0] for color in separable.row] == [1, 2, 3]
    assert [color[0] for color in separable.column] == [4, 5]
    gl.ConvolutionFilter1D(
        GL.CONVOLUTION_1D, GL.RGBA, 2, GL.RGBA, GL.UNSIGNED_BYTE, bytes((255, 0, 0, 0) * 2)
    )
    gl.Enable(GL.CONVOLUTION_1D)
    assert transfer_of(gl).convolution_1d.rows == (((1.0, 0.0, 0.0, 0.0),) * 2,)
    assert not refusals(gl)


@pytest.mark.parametrize(("width", "height"), [(0, 1), (12, 1), (1, 12), (-1, 1)])
def test_filters_that_opengl_refuses(width, height):
    gl = context(_IMAGING)
    gl.ConvolutionFilter2D(GL.CONVOLUTION_2D, GL.RGBA, width, height, GL.RGBA, GL.FLOAT, None)
    assert gl.error == GL.INVALID_VALUE


def test_a_filter_reduces_the_texture_that_passes_through():
    gl = context(_IMAGING)
    ones = np.full((1, 2), 0.5, np.float32)
    gl.ConvolutionFilter2D(GL.CONVOLUTION_2D, GL.INTENSITY, 2, 1, GL.LUMINANCE, GL.FLOAT, ones)
    gl.Enable(GL.CONVOLUTION_2D)
    image = np.arange(10, dtype=np.uint8).reshape(2, 5) * 20
    gl.PixelStorei(GL.UNPACK_ALIGNMENT, 1)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.LUMINANCE, 5, 2, 0, GL.LUMINANCE, GL.UNSIGNED_BYTE, image)
    texels = bound_object(gl, GL.TEXTURE_2D).images[0, 0].texels.texels
    np.testing.assert_array_equal(texels[0, ..., 0], image[:, :-1] + 10)
    assert not refusals(gl)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.LUMINANCE, 4, 2, 0, GL.LUMINANCE, GL.UNSIGNED_BYTE, image)
    assert gl.error == GL.INVALID_VALUE  # three texels are left of a row


def test_tables_of_the_framebuffers_pixels_need_a_machine():
    gl = context(_IMAGING)
    gl.CopyColorTable(GL.COLOR_TABLE, GL.RGBA, 0, 0, 4)
    gl.CopyConvolutionFilter1D(GL.CONVOLUTION_1D, GL.RGBA, 0, 0, 4)
    refused = [sentence for sentence, _ in counted(gl, "refused")]
    assert len(refused) == 2 and all("no machine draws behind this context" in each for each in refused)


# ------------------------------------------------------------------------------------ histograms and minmaxes


def _draw_pixels(gl, values):
    image = np.array(values, np.uint8)
    gl.DrawPixels(len(image), 1, GL.LUMINANCE, GL.UNSIGNED_BYTE, image)


def test_pixels_are_counted_by_the_machine_until_the_program_resets_it():
    gl, machine = context(_IMAGING, 8, 8), Machine(PROFILES[_IMAGING], 8, 8)
    gl.ResetHistogram(GL.HISTOGRAM)  # nothing has counted yet
    assert not gl.commands
    gl.Histogram(GL.HISTOGRAM, 4, GL.LUMINANCE, False)
    gl.Minmax(GL.MINMAX, GL.LUMINANCE, False)
    gl.Enable(GL.HISTOGRAM)
    gl.Enable(GL.MINMAX)
    assert transfer_of(gl).histogram == Histogram("histogram", 4, BaseFormat.LUMINANCE)
    assert transfer_of(gl).minmax == Minmax("minmax", BaseFormat.LUMINANCE)
    _draw_pixels(gl, [0, 0, 255, 100])
    machine.run(gl.take_commands())
    assert machine.statistics.histograms["histogram"].counts[:, 0].tolist() == [2, 1, 0, 1]
    assert machine.statistics.minmaxes["minmax"].extremes[:, 0].tolist() == [0.0, 1.0]
    gl.call("glGetHistogram", [GL.HISTOGRAM, True, GL.RGB, GL.UNSIGNED_INT, 0])
    gl.ResetMinmax(GL.MINMAX)
    assert [type(command) for command in gl.commands] == [ResetHistogram, ResetMinmax]
    _draw_pixels(gl, [128])
    machine.run(gl.take_commands())
    assert machine.statistics.histograms["histogram"].counts[:, 0].tolist() == [0, 0, 1, 0]
    gl.Histogram(GL.HISTOGRAM, 4, GL.LUMINANCE, False)  # a new one begins at zero
    assert [type(command) for command in gl.commands] == [ResetHistogram]
    assert not refusals(gl)


def test_reading_pixels_matters_where_they_are_counted():
    gl = context(_IMAGING, 8, 8)
    arguments = (-2, 0, 16, 4, GL.RGBA, GL.UNSIGNED_BYTE, 0)
    gl.ReadPixels(*arguments)
    assert not gl.commands
    gl.Histogram(GL.HISTOGRAM, 4, GL.LUMINANCE, True)
    gl.Enable(GL.HISTOGRAM)
    gl.ReadPixels(*arguments)
    (command,) = gl.commands
    assert isinstance(command, ReadPixels)
    assert (command.x, command.y, command.width, command.height) == (0, 0, 8, 4)
    Machine(PROFILES[_IMAGING], 8, 8).run(gl.take_commands())


@pytest.mark.parametrize("sink", [False, True])
def test_a_texture_is_counted_and_stored_unless_a_sink_takes_it(sink):
    gl, machine = context(_IMAGING, 8, 8), Machine(PROFILES[_IMAGING], 8, 8)
    gl.Histogram(GL.HISTOGRAM, 4, GL.LUMINANCE, sink)
    gl.Enable(GL.HISTOGRAM)
    image = bytes((0, 255))
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.LUMINANCE, 2, 1, 0, GL.LUMINANCE, GL.UNSIGNED_BYTE, image)
    machine.run(gl.take_commands())
    assert machine.statistics.histograms["histogram"].counts[:, 0].tolist() == [1, 0, 0, 1]
    texels = bound_object(gl, GL.TEXTURE_2D).images[0, 0].texels.texels
    assert texels[0, 0, :, 0].tolist() == ([0, 0] if sink else [0, 255])


@pytest.mark.parametrize(
    ("call", "arguments", "kind"),
    [
        ("Histogram", (GL.HISTOGRAM, 3, GL.RGBA, False), GL.INVALID_VALUE),
        ("Histogram", (GL.HISTOGRAM, 8192, GL.RGBA, False), GL.TABLE_TOO_LARGE),
        ("Histogram", (GL.HISTOGRAM, 4, GL.INTENSITY, False), GL.INVALID_ENUM),
        ("Histogram", (GL.MINMAX, 4, GL.RGBA, False), GL.INVALID_ENUM),
        ("Minmax", (GL.MINMAX, 4, False), GL.INVALID_ENUM),
        ("ResetMinmax", (GL.HISTOGRAM,), GL.INVALID_ENUM),
    ],
)
def test_counters_that_opengl_refuses(call, arguments, kind):
    gl = context(_IMAGING)
    getattr(gl, call)(*arguments)
    assert gl.error == kind
    gl.Histogram(GL.PROXY_HISTOGRAM, 8192, GL.RGBA, False)
    assert gl.values["proxy_histogram"] is None


def test_the_colour_matrix_is_the_top_of_its_stack():
    gl = context(_IMAGING)
    gl.MatrixMode(GL.COLOR)
    gl.PushMatrix()
    gl.Scalef(0.5, 1, 1)
    assert transfer_of(gl).color_matrix[0] == (0.5, 0.0, 0.0, 0.0)
    _draw_pixels(gl, [255])
    (command,) = gl.commands
    assert isinstance(command, DrawPixels)
    assert command.transfer is transfer_of(gl)
