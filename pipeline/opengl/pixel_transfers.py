"""Pixel transfer as state (OpenGL 1.2.1 sections 3.6.3 and 3.6.5): numbers, maps, tables, filters, counters.

The section "pixel_transfer" is the PixelTransfer of commands that move pixels. It omits steps that the
machine does not have.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.commands import ResetHistogram, ResetMinmax
from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry, no_effect, register
from fixedpipe.pipeline.opengl.fragments import member
from fixedpipe.pipeline.opengl.internal_formats import BASE_TOKENS, COMPONENT_COUNTS, chosen_format
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.parameters import numbers_of, register_parameters
from fixedpipe.pipeline.opengl.pixels import ClientImage, captured, given_image
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.pixel_transfer import (
    INITIAL_TRANSFER,
    ConvolutionFilter,
    Histogram,
    Minmax,
    PixelMaps,
    PixelTransfer,
    SeparableFilter,
)
from fixedpipe.pipeline.state import IDENTITY, Color, ColorTable

_MODE = tokens.PIXEL_MODE_BIT
_COMPONENTS = ("RED", "GREEN", "BLUE", "ALPHA")
_ONES: Color = (1.0, 1.0, 1.0, 1.0)
_ZEROS: Color = (0.0, 0.0, 0.0, 0.0)

# ------------------------------------------------------------------------------------------------- numbers

# Parameters of PixelTransfer (tables 3.2, 3.15 of the imaging subset) and their initial values.
_NUMBERS = {
    tokens.MAP_COLOR: False,
    tokens.MAP_STENCIL: False,
    tokens.INDEX_SHIFT: 0,
    tokens.INDEX_OFFSET: 0,
    tokens.DEPTH_SCALE: 1.0,
    tokens.DEPTH_BIAS: 0.0,
}
_OF_COMPONENTS = {
    name: tuple([getattr(tokens, name.format(component)) for component in _COMPONENTS])
    for name in (
        "{}_SCALE",
        "{}_BIAS",
        "POST_CONVOLUTION_{}_SCALE",
        "POST_CONVOLUTION_{}_BIAS",
        "POST_COLOR_MATRIX_{}_SCALE",
        "POST_COLOR_MATRIX_{}_BIAS",
    )
}
for _name, _four in _OF_COMPONENTS.items():
    _NUMBERS |= dict.fromkeys(_four, 1.0 if _name.endswith("SCALE") else 0.0)
for _token, _initial in _NUMBERS.items():
    declare(("pixel transfer", _token), _initial, _MODE)


@entry("PixelTransferf", "PixelTransferi")
def pixel_transfer(gl, name, value):
    """Set a number of pixel transfer."""
    if name not in _NUMBERS:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no parameter of pixel transfer")
    gl.values.set(("pixel transfer", name), type(_NUMBERS[name])(value))


# ---------------------------------------------------------------------------------------------------- maps

_MAPS = {
    tokens.PIXEL_MAP_I_TO_R: "i_to_r",
    tokens.PIXEL_MAP_I_TO_G: "i_to_g",
    tokens.PIXEL_MAP_I_TO_B: "i_to_b",
    tokens.PIXEL_MAP_I_TO_A: "i_to_a",
    tokens.PIXEL_MAP_R_TO_R: "r_to_r",
    tokens.PIXEL_MAP_G_TO_G: "g_to_g",
    tokens.PIXEL_MAP_B_TO_B: "b_to_b",
    tokens.PIXEL_MAP_A_TO_A: "a_to_a",
    tokens.PIXEL_MAP_S_TO_S: "s_to_s",
    tokens.PIXEL_MAP_I_TO_I: "i_to_i",  # for colour-index windows; only GetPixelMap reads it
}
_OF_INDICES = ("s_to_s", "i_to_i")
for _map in _MAPS.values():
    declare(("pixel map", _map), (0,) if _map in _OF_INDICES else (0.0,))


def _pixel_map(largest):
    """The handler of PixelMap for integers, of which ``largest`` means 1.0; None: for floats."""

    def handler(gl, name, size, given):
        if name not in _MAPS:
            raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(name)} is no pixel map")
        of, numbers = _MAPS[name], numbers_of(given)
        takes_index = of[0] in "is"
        if not 1 <= size <= gl.profile.pixels.max_pixel_map_table or (takes_index and size & (size - 1)):
            raise GLError(tokens.INVALID_VALUE, f"a pixel map cannot have {size} entries")
        if len(numbers) < size:
            raise Refused("its numbers are not known, only where they lay")
        if of in _OF_INDICES:
            entries: tuple[Any, ...] = tuple([int(v) for v in numbers[:size]])
        else:
            scaled = [float(v) / (largest or 1.0) for v in numbers[:size]]
            entries = tuple([min(max(v, 0.0), 1.0) for v in scaled])
        gl.values.set(("pixel map", of), entries)

    return handler


for _type, _largest in (("fv", None), ("uiv", 4294967295.0), ("usv", 65535.0)):
    register(
        "PixelMap" + _type,
        _pixel_map(_largest),
        capture=lambda gl, *given: (*given[:2], numbers_of(given[2])),
    )


# -------------------------------------------------------------------------------------------- colour tables


class Table(NamedTuple):
    """A colour table: the requested format, and the table for pixel transfer. ``table`` None: it is empty."""

    internal_format: int
    table: ColorTable | None


_EMPTY = Table(tokens.RGBA, None)
TABLES = (
    tokens.COLOR_TABLE,
    tokens.POST_CONVOLUTION_COLOR_TABLE,
    tokens.POST_COLOR_MATRIX_COLOR_TABLE,
    tokens.TEXTURE_COLOR_TABLE_SGI,
)
_TABLE_PROXIES = {
    tokens.PROXY_COLOR_TABLE: tokens.COLOR_TABLE,
    tokens.PROXY_POST_CONVOLUTION_COLOR_TABLE: tokens.POST_CONVOLUTION_COLOR_TABLE,
    tokens.PROXY_POST_COLOR_MATRIX_COLOR_TABLE: tokens.POST_COLOR_MATRIX_COLOR_TABLE,
    tokens.PROXY_TEXTURE_COLOR_TABLE_SGI: tokens.TEXTURE_COLOR_TABLE_SGI,
}
for _token in TABLES:
    declare(("color table", _token), _EMPTY)
    declare(("color table scale", _token), _ONES, _MODE)
    declare(("color table bias", _token), _ZEROS, _MODE)
    capability(_token, tokens.TEXTURE_BIT if _token == tokens.TEXTURE_COLOR_TABLE_SGI else _MODE)
for _token in _TABLE_PROXIES:
    declare(("color table", _token), _EMPTY)
# The values that a unit's texture color table depends on.
TEXTURE_TABLE = (
    ("enabled", tokens.TEXTURE_COLOR_TABLE_SGI),
    ("color table", tokens.TEXTURE_COLOR_TABLE_SGI),
)
# Assumed: the entries of an unsized table have eight bits; on SGI's boards with twelve-bit textures, twelve.
_TABLE_BITS = 8


def rgba_groups(gl: Any, image: ClientImage | Callable[[], NDArray[np.float64]]) -> NDArray[np.float64]:
    """A ClientImage of colours as RGBA groups [height, width, 4], without pixel transfer.

    Copies from the framebuffer pass a function instead of an image; the function reads the groups.
    """
    if callable(image):
        return image()
    # The import is here because it compiles kernels, which most programs do not need.
    from fixedpipe.pipeline.framebuffers.transfer import transfer_image

    pixels = image.pixel_image()
    if pixels.format in ("DEPTH_COMPONENT", "STENCIL_INDEX"):
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(image.format)} holds no colours")
    return transfer_image(pixels, INITIAL_TRANSFER, gl.profile, None)


def _colors(groups) -> tuple[Color, ...]:
    return tuple(map(tuple, groups.reshape(-1, 4).tolist()))


def _table_base(gl, internal_format) -> tuple[BaseFormat, int | None]:
    """(base format, bits) of a table with an internal format."""
    if internal_format in COMPONENT_COUNTS:
        raise GLError(tokens.INVALID_ENUM, "a colour table's internal format cannot be a number")
    chosen = chosen_format(gl.profile, internal_format)
    if chosen.base is None:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(internal_format)} is no format of colour tables")
    if internal_format in BASE_TOKENS:
        return chosen.base, _TABLE_BITS
    digits = [int(d) for d in "".join(c if c.isdigit() else " " for c in chosen.format.name).split()]
    return chosen.base, max(digits, default=_TABLE_BITS)


@entry("ColorTable", capture=captured(2))
def color_table(gl, target, internal_format, width, image_format, image_type, image):
    """Define a colour table or a palette (sections 3.6.3; EXT_paletted_texture)."""
    if target in _TABLE_PROXIES:
        known = _has_tables(gl, _TABLE_PROXIES[target]) and _table_fits(gl, target, width)
        made = Table(internal_format, ColorTable((_ZEROS,) * width)) if known else _EMPTY
        gl.values.set(("color table", target), made)
        return
    if target not in TABLES:
        _palette(gl, target, internal_format, width, image)
        return
    _require_tables(gl, target)
    base, bits = _table_base(gl, internal_format)
    if width < 0 or width & (width - 1):
        raise GLError(tokens.INVALID_VALUE, f"a colour table cannot have {width} entries")
    if not _table_fits(gl, target, width):
        raise GLError(tokens.TABLE_TOO_LARGE, f"a colour table of {width} entries")
    entries = _table_entries(gl, target, given_image(image), width)
    made = ColorTable(entries, base, bits) if width else None
    gl.values.set(("color table", target), Table(internal_format, made))


@entry("ColorSubTable", capture=captured(2))
def color_sub_table(gl, target, start, count, image_format, image_type, image):
    """Replace entries of a colour table or a palette."""
    if target not in TABLES:
        _sub_palette(gl, target, start, count, image)
        return
    _require_tables(gl, target)
    held: Table = gl.values["color table", target]
    entries = () if held.table is None else held.table.entries
    if start < 0 or count < 0 or start + count > len(entries):
        raise GLError(tokens.INVALID_VALUE, f"entries {start} to {start + count} of {len(entries)}")
    if held.table is None or not count:
        return
    new = _table_entries(gl, target, given_image(image), count)
    changed = ColorTable(
        (*entries[:start], *new, *entries[start + count :]), held.table.base_format, held.table.bits
    )
    gl.values.set(("color table", target), held._replace(table=changed))


def _table_entries(gl, target, image, width):
    """RGBA entries from an image of ``width`` groups, scaled, biased and clamped; zeros without an image."""
    if image is None:
        return (_ZEROS,) * width
    scale, bias = gl.values["color table scale", target], gl.values["color table bias", target]
    return _colors(np.clip(rgba_groups(gl, image) * np.array(scale) + np.array(bias), 0.0, 1.0))


def _has_tables(gl, target):
    if target == tokens.TEXTURE_COLOR_TABLE_SGI:
        return gl.profile.textures.texture_color_table
    return gl.profile.pixels.color_tables


def _require_tables(gl, target):
    if not _has_tables(gl, target):
        raise Refused(f"{gl.profile.name} has no {tokens.name_of(target)}")


def _table_fits(gl, target, width):
    return 0 <= width <= gl.profile.pixels.max_color_table_size and not width & (width - 1)


def _palette(gl, target, internal_format, width, image):
    from fixedpipe.pipeline.opengl.compressed_images import palette_colors, set_palette

    if width < 1 or width & (width - 1):
        raise GLError(tokens.INVALID_VALUE, f"a palette cannot have {width} entries")
    found = given_image(image)
    groups = np.zeros((width, 4)) if found is None else rgba_groups(gl, found).reshape(-1, 4)
    set_palette(gl, target, internal_format, palette_colors(gl, internal_format, groups))


def _sub_palette(gl, target, start, count, image):
    from fixedpipe.pipeline.opengl.compressed_images import replace_palette

    if start < 0 or count < 0:
        raise GLError(tokens.INVALID_VALUE)
    if (found := given_image(image)) is not None:
        replace_palette(gl, target, start, rgba_groups(gl, found).reshape(-1, 4))


def _color_table_parameter(gl, target, name, parameter):
    keys = {tokens.COLOR_TABLE_SCALE: "color table scale", tokens.COLOR_TABLE_BIAS: "color table bias"}
    if target not in TABLES or name not in keys:
        raise GLError(tokens.INVALID_ENUM)
    gl.values.set((keys[name], target), parameter.vector_of(4))


register_parameters("ColorTableParameter", _color_table_parameter)


# --------------------------------------------------------------------------------------------------- filters


class Filter(NamedTuple):
    """A convolution filter as requested: rows, bottom first, or a row and a column. None: it is empty."""

    internal_format: int
    base: BaseFormat
    rows: tuple[tuple[Color, ...], ...]
    column: tuple[Color, ...] | None = None


_FILTERS = (tokens.CONVOLUTION_1D, tokens.CONVOLUTION_2D, tokens.SEPARABLE_2D)
_BORDER_MODES = {
    tokens.REDUCE: ConvolutionBorderMode.REDUCE,
    tokens.CONSTANT_BORDER: ConvolutionBorderMode.CONSTANT_BORDER,
    tokens.REPLICATE_BORDER: ConvolutionBorderMode.REPLICATE_BORDER,
}
for _token in _FILTERS:
    declare(("convolution", _token), None)
    declare(("convolution scale", _token), _ONES, _MODE)
    declare(("convolution bias", _token), _ZEROS, _MODE)
    declare(("convolution border mode", _token), tokens.REDUCE, _MODE)
    declare(("convolution border color", _token), _ZEROS, _MODE)
    capability(_token, _MODE)


def _filter_base(gl, target, internal_format, *edges):
    """The base format of a filter. Raises Refused if the machine has no convolution, and GLError."""
    pixels = gl.profile.pixels
    if not pixels.convolution:
        raise Refused(f"{gl.profile.name} has no convolution")
    base, _ = _table_base(gl, internal_format)
    if any(not 0 < edge <= pixels.max_convolution_size for edge in edges):
        raise GLError(tokens.INVALID_VALUE, f"a filter of {'x'.join(map(str, edges))} pixels")
    return base


def _filter_rows(gl, target, image, width, height=1):
    """Scaled and biased RGBA rows of a filter's image; zeros without an image."""
    if image is None:
        return ((_ZEROS,) * width,) * height
    scale, bias = gl.values["convolution scale", target], gl.values["convolution bias", target]
    groups = rgba_groups(gl, image) * np.array(scale) + np.array(bias)
    return tuple([_colors(row) for row in groups])


@entry("ConvolutionFilter1D", capture=captured(2))
def convolution_filter_1d(gl, target, internal_format, width, image_format, image_type, image):
    """Define a filter of one row (section 3.6.3)."""
    if target != tokens.CONVOLUTION_1D:
        raise GLError(tokens.INVALID_ENUM)
    base = _filter_base(gl, target, internal_format, width)
    rows = _filter_rows(gl, target, given_image(image), width)
    gl.values.set(("convolution", target), Filter(internal_format, base, rows))


@entry("ConvolutionFilter2D", capture=captured(2, 3))
def convolution_filter_2d(gl, target, internal_format, width, height, image_format, image_type, image):
    """Define a filter of several rows (section 3.6.3)."""
    if target != tokens.CONVOLUTION_2D:
        raise GLError(tokens.INVALID_ENUM)
    base = _filter_base(gl, target, internal_format, width, height)
    rows = _filter_rows(gl, target, given_image(image), width, height)
    gl.values.set(("convolution", target), Filter(internal_format, base, rows))


def _capture_separable(gl, target, internal_format, width, height, image_format, image_type, row, column):
    """Both images of a separable filter."""
    read = captured(0)
    images = [
        read(gl, edge, image_format, image_type, given)[-1]
        for edge, given in ((width, row), (height, column))
    ]
    return (target, internal_format, width, height, image_format, image_type, *images)


@entry("SeparableFilter2D", capture=_capture_separable)
def separable_filter_2d(gl, target, internal_format, width, height, image_format, image_type, row, column):
    """Define a filter that is a row times a column (section 3.6.3)."""
    if target != tokens.SEPARABLE_2D:
        raise GLError(tokens.INVALID_ENUM)
    base = _filter_base(gl, target, internal_format, width, height)
    rows = _filter_rows(gl, target, given_image(row), width)
    (weights,) = _filter_rows(gl, target, given_image(column), height)
    gl.values.set(("convolution", target), Filter(internal_format, base, rows, weights))


def _convolution_parameter(gl, target, name, parameter):
    if target not in _FILTERS:
        raise GLError(tokens.INVALID_ENUM)
    if name == tokens.CONVOLUTION_BORDER_MODE:
        member(_BORDER_MODES, parameter.token())
        gl.values.set(("convolution border mode", target), parameter.token())
        return
    keys = {
        tokens.CONVOLUTION_FILTER_SCALE: "convolution scale",
        tokens.CONVOLUTION_FILTER_BIAS: "convolution bias",
        tokens.CONVOLUTION_BORDER_COLOR: "convolution border color",
    }
    if name not in keys:
        raise GLError(tokens.INVALID_ENUM)
    colors = name == tokens.CONVOLUTION_BORDER_COLOR
    gl.values.set((keys[name], target), parameter.color() if colors else parameter.vector_of(4))


register_parameters("ConvolutionParameter", _convolution_parameter)


# ------------------------------------------------------------------------------------- histogram and minmax

HISTOGRAM, MINMAX = "histogram", "minmax"  # their names in commands
capability(tokens.HISTOGRAM, _MODE)
capability(tokens.MINMAX, _MODE)
declare("histogram", None)
declare("proxy_histogram", None)
declare("minmax", None)
# Whether a command has counted already. From then on the machine's counters exist.
declare("histogram_begun", False)
declare("minmax_begun", False)


def _counted_base(gl, internal_format):
    if not gl.profile.pixels.histogram:
        raise Refused(f"{gl.profile.name} has no histogram and no minmax")
    base, _ = _table_base(gl, internal_format)
    if base is BaseFormat.INTENSITY:
        raise GLError(tokens.INVALID_ENUM, "a histogram or minmax has no format GL_INTENSITY")
    return base


@entry("Histogram")
def histogram(gl, target, width, internal_format, sink):
    """Define the histogram. Its counts begin at zero (EXT_histogram)."""
    if target not in (tokens.HISTOGRAM, tokens.PROXY_HISTOGRAM):
        raise GLError(tokens.INVALID_ENUM)
    base = _counted_base(gl, internal_format)
    if width < 0 or width & (width - 1):
        raise GLError(tokens.INVALID_VALUE, f"a histogram cannot have {width} entries")
    fits = width <= gl.profile.pixels.max_color_table_size
    made = Histogram(HISTOGRAM, width, base, bool(sink)) if fits and width else None
    if target == tokens.PROXY_HISTOGRAM:
        gl.values.set("proxy_histogram", made)
        return
    if not fits:
        raise GLError(tokens.TABLE_TOO_LARGE, f"a histogram of {width} entries")
    gl.values.set("histogram", made)
    reset_histogram(gl, target)


@entry("Minmax")
def minmax(gl, target, internal_format, sink):
    """Define the minmax. It is empty at first (EXT_histogram)."""
    if target != tokens.MINMAX:
        raise GLError(tokens.INVALID_ENUM)
    gl.values.set("minmax", Minmax(MINMAX, _counted_base(gl, internal_format), bool(sink)))
    reset_minmax(gl, target)


@entry("ResetHistogram")
def reset_histogram(gl, target):
    """Set every count to zero."""
    if target != tokens.HISTOGRAM:
        raise GLError(tokens.INVALID_ENUM)
    if gl.values["histogram_begun"]:
        gl.commands.append(ResetHistogram(label=f"{gl.called} (call {gl.tally.call})", name=HISTOGRAM))


@entry("ResetMinmax")
def reset_minmax(gl, target):
    """Make the minmax empty."""
    if target != tokens.MINMAX:
        raise GLError(tokens.INVALID_ENUM)
    if gl.values["minmax_begun"]:
        gl.commands.append(ResetMinmax(label=f"{gl.called} (call {gl.tally.call})", name=MINMAX))


@entry("GetHistogram", compiled=False)
def get_histogram(gl, target, reset, *rest):
    """Only the machine knows the counts, so none are returned. With ``reset`` they become zero."""
    if reset:
        reset_histogram(gl, target)
    gl.tally.add("no effect", gl.called)


@entry("GetMinmax", compiled=False)
def get_minmax(gl, target, reset, *rest):
    """Only the machine knows the minmax, so none is returned. With ``reset`` it becomes empty."""
    if reset:
        reset_minmax(gl, target)
    gl.tally.add("no effect", gl.called)


no_effect("GetConvolutionFilter", "GetSeparableFilter", "GetColorTable", compiled=False)


def counts(transfer: PixelTransfer) -> bool:
    """Whether a histogram or a minmax counts the pixels of this transfer."""
    return transfer.histogram is not None or transfer.minmax is not None


def transfer_of(gl: Any) -> PixelTransfer:
    """The PixelTransfer for a command that moves pixels now."""
    transfer: PixelTransfer = gl.values.section("pixel_transfer")
    if counts(transfer):
        gl.values.set("histogram_begun", gl.values["histogram_begun"] or transfer.histogram is not None)
        gl.values.set("minmax_begun", gl.values["minmax_begun"] or transfer.minmax is not None)
    return transfer


# -------------------------------------------------------------------------------------------------- the whole

_NUMBER_KEYS = tuple([("pixel transfer", token) for token in _NUMBERS])
_MAP_KEYS = tuple([("pixel map", name) for name in _MAPS.values() if name != "i_to_i"])
_TABLE_TOKENS = TABLES[:3]
_FILTER_PARTS = ("convolution", "convolution border mode", "convolution border color")


@section("pixel_maps", *_MAP_KEYS)
def _pixel_maps(gl, *maps):
    return PixelMaps(**dict(zip([name for _, name in _MAP_KEYS], maps, strict=True)))


@section("pixel_numbers", *_NUMBER_KEYS)
def _pixel_numbers(gl, *numbers):
    """The numbers as pairs (field of a PixelTransfer, value)."""
    of = dict(zip(_NUMBERS, numbers, strict=True))

    def four(name):
        return tuple([of[token] for token in _OF_COMPONENTS[name]])

    plain = {
        "scale": four("{}_SCALE"),
        "bias": four("{}_BIAS"),
        "depth_scale": of[tokens.DEPTH_SCALE],
        "depth_bias": of[tokens.DEPTH_BIAS],
        "index_shift": of[tokens.INDEX_SHIFT],
        "index_offset": of[tokens.INDEX_OFFSET],
        "map_color": of[tokens.MAP_COLOR],
        "map_stencil": of[tokens.MAP_STENCIL],
    }
    if gl.profile.pixels.convolution:
        plain["post_convolution_scale"] = four("POST_CONVOLUTION_{}_SCALE")
        plain["post_convolution_bias"] = four("POST_CONVOLUTION_{}_BIAS")
    if gl.profile.pixels.color_matrix:
        plain["post_color_matrix_scale"] = four("POST_COLOR_MATRIX_{}_SCALE")
        plain["post_color_matrix_bias"] = four("POST_COLOR_MATRIX_{}_BIAS")
    return tuple(plain.items())


@section(
    "pixel_tables",
    *[("enabled", token) for token in _TABLE_TOKENS],
    *[("color table", token) for token in _TABLE_TOKENS],
)
def _pixel_tables(gl, *parts):
    """The three colour tables; None for a table that is disabled or empty."""
    if not gl.profile.pixels.color_tables:
        return (None, None, None)
    return tuple(
        [held.table if enabled else None for enabled, held in zip(parts[:3], parts[3:], strict=True)]
    )


@section(
    "pixel_filters",
    *[("enabled", token) for token in _FILTERS],
    *[(part, token) for token in _FILTERS for part in _FILTER_PARTS],
)
def _pixel_filters(gl, *parts):
    """The three filters; None for a filter that is disabled or empty."""
    made: list[ConvolutionFilter | SeparableFilter | None] = []
    for k in range(3):
        held, mode, color = parts[3 + 3 * k : 6 + 3 * k]
        if not parts[k] or held is None or not gl.profile.pixels.convolution:
            made.append(None)
        elif held.column is None:
            made.append(ConvolutionFilter(held.rows, held.base, _BORDER_MODES[mode], color))
        else:
            made.append(SeparableFilter(held.rows[0], held.column, held.base, _BORDER_MODES[mode], color))
    return tuple(made)


@section(
    "pixel_transfer",
    "pixel_numbers",
    "pixel_maps",
    "pixel_tables",
    "pixel_filters",
    "color matrix",
    ("enabled", tokens.HISTOGRAM),
    ("enabled", tokens.MINMAX),
    "histogram",
    "minmax",
)
def _pixel_transfer(gl, numbers, maps, tables, filters, matrices, counted, compared, counter, extremes):
    made = PixelTransfer(
        maps=maps,
        color_table=tables[0],
        post_convolution_color_table=tables[1],
        post_color_matrix_color_table=tables[2],
        convolution_1d=filters[0],
        convolution_2d=filters[1],
        separable_2d=filters[2],
        color_matrix=matrices[-1] if gl.profile.pixels.color_matrix else IDENTITY,
        histogram=counter if counted else None,
        minmax=extremes if compared else None,
        **dict(numbers),
    )
    return INITIAL_TRANSFER if made == INITIAL_TRANSFER else made
