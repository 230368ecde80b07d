"""Pixel transfer (OpenGL 1.2.1 section 3.6.3) as a value.

Pixel transfer changes pixel groups on their way between an image, the framebuffer and a texture. There is no
current state: each command that moves pixels carries a whole ``PixelTransfer``. Every default is the initial
value. The operations apply in section 3.6.5's order, which is the order of the fields.
``fixedpipe.raster.pixels.transfer`` has the arithmetic, and docs/numbers.md the rule.

Give tables and filters in their specified form. Clamping to [0, 1] (tables) and rounding to the internal
format's bits take place here. The caller applies COLOR_TABLE_SCALE, COLOR_TABLE_BIAS,
CONVOLUTION_FILTER_SCALE and CONVOLUTION_FILTER_BIAS.

Source: OpenGL 1.2.1 sections 3.6.3 and 3.6.5; SGI_color_table, SGI_color_matrix, EXT_convolution,
EXT_histogram.
"""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode
from fixedpipe.pipeline.state import IDENTITY, Color, ColorTable, Matrix, refuse_whole_numbers

_ONES: Color = (1.0, 1.0, 1.0, 1.0)
_ZEROS: Color = (0.0, 0.0, 0.0, 0.0)


# What the groups of an image in client memory are.
ImageFormat = Literal[
    "RGBA",
    "RGB",
    "BGRA",
    "BGR",
    "RED",
    "GREEN",
    "BLUE",
    "ALPHA",
    "LUMINANCE",
    "LUMINANCE_ALPHA",
    "DEPTH_COMPONENT",
    "STENCIL_INDEX",
    "COLOR_INDEX",
]


# Types of words that hold a whole group.
PackedName = Literal[
    "UNSIGNED_BYTE_3_3_2",
    "UNSIGNED_BYTE_2_3_3_REV",
    "UNSIGNED_SHORT_5_6_5",
    "UNSIGNED_SHORT_5_6_5_REV",
    "UNSIGNED_SHORT_4_4_4_4",
    "UNSIGNED_SHORT_4_4_4_4_REV",
    "UNSIGNED_SHORT_5_5_5_1",
    "UNSIGNED_SHORT_1_5_5_5_REV",
    "UNSIGNED_INT_8_8_8_8",
    "UNSIGNED_INT_8_8_8_8_REV",
    "UNSIGNED_INT_10_10_10_2",
    "UNSIGNED_INT_2_10_10_10_REV",
]


def read_only_copy(values: ArrayLike, what: str) -> NDArray[Any]:
    """A read-only copy as an array. Raises ValueError for rows of different lengths; ``what`` begins the
    message.
    """
    try:
        array = np.array(values, order="C")
    except ValueError as error:
        raise ValueError(f"{what} have rows of different lengths; give as many in each.") from error
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False, init=False)
class PixelImage:
    """An image in client memory, bottom row first, for DrawPixels and TexImage (section 3.6.4).

    values  [height, width, components], or [height, width] for a format with one component. A leading axis
            holds a cube map's six faces or a volume's layers. uint8, uint16 and uint32 are fixed-point
            fractions of their type's largest value. int8, int16 and int32 lie between -1 and 1 (table 2.6).
            Floats are taken unchanged. Indices are integers.
    format  one of ``ImageFormat``, a string
    packed  one of ``PackedName``: the values are words of this type, [height, width], and each holds a whole
            group of RGB, RGBA or BGRA (table 3.8). None: the values are components

    The array is copied and made read-only. Raises ValueError for rows of different lengths.
    """

    values: NDArray[Any]
    format: ImageFormat
    packed: PackedName | None

    def __init__(self, values: ArrayLike, format: ImageFormat = "RGBA", packed: PackedName | None = None):
        object.__setattr__(self, "values", read_only_copy(values, "The image's values"))
        object.__setattr__(self, "format", format)
        object.__setattr__(self, "packed", packed)


@dataclass(frozen=True, slots=True)
class PixelMaps:
    """The pixel maps (table 3.3). A map from an index has 2**n entries.

    I_TO_I is missing, since colour buffers hold RGBA, and a colour index becomes RGBA on its way. Raises
    ValueError for colours that are whole numbers other than 0 and 1, as ColorTable does.
    """

    i_to_r: tuple[float, ...] = (0.0,)
    i_to_g: tuple[float, ...] = (0.0,)
    i_to_b: tuple[float, ...] = (0.0,)
    i_to_a: tuple[float, ...] = (0.0,)
    r_to_r: tuple[float, ...] = (0.0,)
    g_to_g: tuple[float, ...] = (0.0,)
    b_to_b: tuple[float, ...] = (0.0,)
    a_to_a: tuple[float, ...] = (0.0,)
    s_to_s: tuple[int, ...] = (0,)

    def __post_init__(self) -> None:
        for name in ("i_to_r", "i_to_g", "i_to_b", "i_to_a", "r_to_r", "g_to_g", "b_to_b", "a_to_a"):
            refuse_whole_numbers(f"The pixel map {name}'s entries", getattr(self, name))


@dataclass(frozen=True, slots=True)
class ConvolutionFilter:
    """A one-dimensional filter, with one row, or a two-dimensional filter (EXT_convolution).

    ``rows``: bottom row first, all of the same length; not clamped. ``base_format``: which of a pixel's
    components are convolved, and with what (table 3.14). ``border_color``: used by CONSTANT_BORDER.
    """

    rows: tuple[tuple[Color, ...], ...]
    base_format: BaseFormat = BaseFormat.RGBA
    border_mode: ConvolutionBorderMode = ConvolutionBorderMode.REDUCE
    border_color: Color = _ZEROS


@dataclass(frozen=True, slots=True)
class SeparableFilter:
    """A two-dimensional filter: the product of ``row`` (left to right) and ``column`` (bottom to top).

    The other fields are those of ConvolutionFilter.
    """

    row: tuple[Color, ...]
    column: tuple[Color, ...]
    base_format: BaseFormat = BaseFormat.RGBA
    border_mode: ConvolutionBorderMode = ConvolutionBorderMode.REDUCE
    border_color: Color = _ZEROS


@dataclass(frozen=True, slots=True)
class Histogram:
    """Counts pixel groups in the machine's histogram ``name``, which has ``width`` (2**n) entries.

    The first Histogram with a name creates it; another width or base format creates it anew. ResetHistogram
    sets the counts to zero. ``base_format`` must not be INTENSITY. With ``sink`` the image goes no further.
    """

    name: str
    width: int = 256
    base_format: BaseFormat = BaseFormat.RGBA
    sink: bool = False


@dataclass(frozen=True, slots=True)
class Minmax:
    """Keeps the least and greatest components of all pixel groups as the machine's minmax ``name``.

    The first Minmax with a name creates it; another base format creates it anew. ResetMinmax empties it. With
    ``sink`` the image goes no further.
    """

    name: str
    base_format: BaseFormat = BaseFormat.RGBA
    sink: bool = False


@dataclass(frozen=True, slots=True)
class PixelTransfer:
    """The pixel transfer operations, in their order. A table or filter of None is disabled.

    - ``scale``, ``bias``: for RGBA. ``depth_scale``, ``depth_bias``: for depths. ``index_shift``,
      ``index_offset``: for stencil and colour indices.
    - ``map_color``, ``map_stencil``: whether ``maps`` apply. Maps from colour indices to RGBA always do.
    - ``convolution_1d``: for one-dimensional textures.
    - ``convolution_2d`` and, where it is disabled, ``separable_2d``: for DrawPixels, CopyPixels, ReadPixels,
      two-dimensional textures and cube map faces, also where GetTexImage reads these. The scale and bias
      after convolution apply where one took place.
    - ``color_matrix``: rows, applied to the column (R, G, B, A).
    """

    scale: Color = _ONES
    bias: Color = _ZEROS
    depth_scale: float = 1.0
    depth_bias: float = 0.0
    index_shift: int = 0
    index_offset: int = 0
    map_color: bool = False
    map_stencil: bool = False
    maps: PixelMaps = PixelMaps()
    color_table: ColorTable | None = None
    convolution_1d: ConvolutionFilter | None = None
    convolution_2d: ConvolutionFilter | None = None
    separable_2d: SeparableFilter | None = None
    post_convolution_scale: Color = _ONES
    post_convolution_bias: Color = _ZEROS
    post_convolution_color_table: ColorTable | None = None
    color_matrix: Matrix = IDENTITY
    post_color_matrix_scale: Color = _ONES
    post_color_matrix_bias: Color = _ZEROS
    post_color_matrix_color_table: ColorTable | None = None
    histogram: Histogram | None = None
    minmax: Minmax | None = None


INITIAL_TRANSFER = PixelTransfer()  # changes no pixel


def convolution(transfer, dimensions):
    """The filter that applies to an image of ``dimensions`` dimensions, or None."""
    if dimensions == 1:
        return transfer.convolution_1d
    if dimensions == 2:
        return transfer.convolution_2d or transfer.separable_2d
    return None


def filter_size(kernel):
    """Width and height of a ConvolutionFilter or SeparableFilter, in pixels."""
    if hasattr(kernel, "row"):
        return len(kernel.row), len(kernel.column)
    return len(kernel.rows[0]) if kernel.rows else 0, len(kernel.rows)


def transferred_size(width, height, transfer, dimensions=2):
    """Width and height of an image after pixel transfer. A REDUCE convolution makes it smaller."""
    kernel = convolution(transfer, dimensions)
    if kernel is None or kernel.border_mode is not ConvolutionBorderMode.REDUCE:
        return width, height
    wide, high = filter_size(kernel)
    return max(width - wide + 1, 0), max(height - high + 1, 0)


def has_color_matrix(transfer):
    """Whether the colour matrix, or the scale or bias after it, differs from the initial one."""
    scale, bias = transfer.post_color_matrix_scale, transfer.post_color_matrix_bias
    return transfer.color_matrix != IDENTITY or scale != _ONES or bias != _ZEROS


def has_sink(transfer):
    """Whether a histogram or minmax is the image's end."""
    return any(table is not None and table.sink for table in (transfer.histogram, transfer.minmax))


def changes_nothing(transfer):
    """Whether the state is the initial one: it changes no pixel and counts none."""
    return transfer is INITIAL_TRANSFER or transfer == INITIAL_TRANSFER
