"""Copies of colour tables and convolution filters from the framebuffer (OpenGL 1.2.1 section 3.6.3).

Each function calls the one for an image in client memory, with the present groups of the framebuffer. Pixel
transfer does not apply, as in those calls.
"""

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.images import framebuffer_size
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.pixel_transfers import (
    TABLES,
    color_sub_table,
    color_table,
    convolution_filter_1d,
    convolution_filter_2d,
)
from fixedpipe.pipeline.opengl.read_back import colors_read


def _groups(gl, x, y, width, height=1):
    """A function that reads the groups of a rectangle. It is called after sizes and formats are checked."""
    return lambda: colors_read(gl, (x, y, width, height), framebuffer_size(gl))


def _require_table(target):
    if target not in TABLES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is no colour table")


@entry("CopyColorTable")
def copy_color_table(gl, target, internal_format, x, y, width):
    """Define a colour table from a row of the framebuffer."""
    _require_table(target)
    color_table(gl, target, internal_format, width, tokens.RGBA, tokens.FLOAT, _groups(gl, x, y, width))


@entry("CopyColorSubTable")
def copy_color_sub_table(gl, target, start, x, y, width):
    """Replace entries of a colour table by a row of the framebuffer."""
    _require_table(target)
    color_sub_table(gl, target, start, width, tokens.RGBA, tokens.FLOAT, _groups(gl, x, y, width))


@entry("CopyConvolutionFilter1D")
def copy_convolution_filter_1d(gl, target, internal_format, x, y, width):
    """Define a filter of one row from a row of the framebuffer."""
    groups = _groups(gl, x, y, width)
    convolution_filter_1d(gl, target, internal_format, width, tokens.RGBA, tokens.FLOAT, groups)


@entry("CopyConvolutionFilter2D")
def copy_convolution_filter_2d(gl, target, internal_format, x, y, width, height):
    """Define a filter of several rows from a rectangle of the framebuffer."""
    groups = _groups(gl, x, y, width, height)
    convolution_filter_2d(gl, target, internal_format, width, height, tokens.RGBA, tokens.FLOAT, groups)
