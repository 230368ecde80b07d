"""Pixel transfer of images: operations in order, histograms and minmaxes, image data to groups and back.

This module selects the operations that a PixelTransfer asks for; ``fixedpipe.raster.pixels.transfer`` has
their arithmetic. Colour groups are float64 [height, width, 4], RGBA, before final conversion. Depths are
float64 and indices int64 [height, width]. The bottom row is first.

Source: OpenGL 1.2.1 sections 3.6.3 to 3.6.5 and 4.3.2.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode
from fixedpipe.pipeline.framebuffers.scaled_words import Words, scaled_words
from fixedpipe.pipeline.pixel_transfer import Histogram, Minmax, convolution, has_color_matrix
from fixedpipe.pipeline.state import ColorTable
from fixedpipe.pipeline.textures.images import KEPT
from fixedpipe.pipeline.textures.pixel_formats import (
    COLOR_INDEX_FORMAT,
    COMPONENT_TYPES,
    DEPTH_FORMAT,
    IMAGE_FORMATS,
    INDEX_FORMATS,
    PACKED_TYPES,
)
from fixedpipe.raster.pixels import transfer as arithmetic

# The component of a table's or filter's entry for a pixel's R, G, B and A; None keeps the pixel's component.
# Source: OpenGL 1.2.1 tables 3.13 and 3.14; SGI_texture_color_table.
ENTRY_COMPONENTS = {
    BaseFormat.ALPHA: (None, None, None, 3),
    BaseFormat.LUMINANCE: (0, 0, 0, None),
    BaseFormat.LUMINANCE_ALPHA: (0, 0, 0, 3),
    BaseFormat.INTENSITY: (0, 0, 0, 0),
    BaseFormat.RGB: (0, 1, 2, None),
    BaseFormat.RGBA: (0, 1, 2, 3),
}


# ------------------------------------------------------------------------------- histograms and minmaxes


@dataclass(frozen=True, eq=False)
class HistogramTable:
    """The counts of a histogram: ``counts`` is uint32 [width, components of ``base_format``]."""

    base_format: BaseFormat
    counts: NDArray[np.uint32]


@dataclass(frozen=True, eq=False)
class MinmaxTable:
    """The extremes that a minmax found: ``extremes`` is float64 [2, components of ``base_format``].

    The least values come first, then the greatest. Before any pixel they are plus and minus infinity.
    """

    base_format: BaseFormat
    extremes: NDArray[np.float64]


@dataclass(eq=False)
class PixelStatistics:
    """The histograms and minmaxes that a machine keeps, by name. Their arrays are never written to."""

    histograms: dict[str, HistogramTable] = field(default_factory=dict)
    minmaxes: dict[str, MinmaxTable] = field(default_factory=dict)

    def reset_histogram(self, name: str) -> None:
        """Set every count to zero. Raises KeyError for an unknown name."""
        kept = self.histograms[name]
        self.histograms[name] = replace(kept, counts=np.zeros_like(kept.counts))

    def reset_minmax(self, name: str) -> None:
        """Set the extremes to their initial infinities. Raises KeyError for an unknown name."""
        kept = self.minmaxes[name]
        self.minmaxes[name] = replace(kept, extremes=_nothing_seen(kept.base_format))

    def count(self, groups: NDArray[np.float64], histogram: Histogram) -> None:
        """Count groups into the histogram that a state names; a histogram of another shape starts anew."""
        shape = histogram.width, len(KEPT[histogram.base_format])
        kept = self.histograms.get(histogram.name)
        if kept is None or kept.base_format is not histogram.base_format or kept.counts.shape != shape:
            kept = HistogramTable(histogram.base_format, np.zeros(shape, np.uint32))
        counts = arithmetic.counted(groups, kept.counts, KEPT[histogram.base_format])
        self.histograms[histogram.name] = replace(kept, counts=counts)

    def compare(self, groups: NDArray[np.float64], minmax: Minmax) -> None:
        """Update the minmax that a state names with the groups; a minmax of another format starts anew."""
        kept = self.minmaxes.get(minmax.name)
        if kept is None or kept.base_format is not minmax.base_format:
            kept = MinmaxTable(minmax.base_format, _nothing_seen(minmax.base_format))
        extremes = arithmetic.compared(groups, kept.extremes, KEPT[minmax.base_format])
        self.minmaxes[minmax.name] = replace(kept, extremes=extremes)


def _nothing_seen(base_format):
    components = len(KEPT[base_format])
    return np.array([[np.inf] * components, [-np.inf] * components])


# ------------------------------------------------------------------------------------ the operations


def transfer_colors(groups, transfer, profile, statistics, dimensions=2):
    """RGBA groups, float64 or Words, after pixel transfer, or None where a sink took them.

    - ``dimensions``: 1 for a one-dimensional texture, 3 for a volume's layer, 2 otherwise.
    - ``statistics``: the machine's PixelStatistics, whose tables change.
    """
    scale = scaled_words if isinstance(groups, Words) else arithmetic.scaled
    groups = scale(groups, transfer.scale, transfer.bias)
    if transfer.map_color:
        maps = transfer.maps
        groups = arithmetic.mapped(
            groups, [np.array(m, np.float64) for m in (maps.r_to_r, maps.g_to_g, maps.b_to_b, maps.a_to_a)]
        )
    return _from_color_table(groups, transfer, profile, statistics, dimensions)


def transfer_color_indices(indices, transfer, profile, statistics, dimensions=2):
    """Colour indices after pixel transfer, which makes RGBA groups of them; see ``transfer_colors``."""
    indices = arithmetic.indexed(indices, transfer.index_shift, transfer.index_offset)
    maps = transfer.maps
    tables = (maps.i_to_r, maps.i_to_g, maps.i_to_b, maps.i_to_a)
    groups = np.stack([arithmetic.table_at(np.array(table, np.float64), indices) for table in tables], -1)
    return _from_color_table(groups, transfer, profile, statistics, dimensions)


def _from_color_table(groups, transfer, profile, statistics, dimensions):
    """Color Table Lookup and the later operations, up to Minmax."""
    groups = looked_up(groups, transfer.color_table, profile)
    if (kernel := convolution(transfer, dimensions)) is not None:
        groups = _convolved(groups, kernel)
        groups = arithmetic.scaled(groups, transfer.post_convolution_scale, transfer.post_convolution_bias)
    groups = looked_up(groups, transfer.post_convolution_color_table, profile)
    if has_color_matrix(transfer):
        groups = _transformed(groups, transfer.color_matrix)
        groups = arithmetic.scaled(groups, transfer.post_color_matrix_scale, transfer.post_color_matrix_bias)
        if profile.arithmetic.clamps_color_matrix:
            groups = np.clip(groups, 0.0, 1.0)
    groups = looked_up(groups, transfer.post_color_matrix_color_table, profile)
    if transfer.histogram is not None:
        statistics.count(groups, transfer.histogram)
        if transfer.histogram.sink:
            return None
    if transfer.minmax is not None:
        statistics.compare(groups, transfer.minmax)
        if transfer.minmax.sink:
            return None
    return groups


def _transformed(groups, matrix):
    """Color Matrix Transformation.

    Rows that are one object, for a dot product in all components, are computed once.
    """
    if all(row is matrix[0] for row in matrix):
        return np.repeat(arithmetic.transformed(groups, matrix[:1]), 4, -1)
    return arithmetic.transformed(groups, matrix)


# Stored entries, by the table's identity and bits, because a frame may send thousands of small images through
# one table. The dictionary holds each table. It is emptied when it has this many.
_stored_tables: dict[tuple[int, int | None], tuple[ColorTable, NDArray[np.float64]]] = {}
_MOST_TABLES = 64


def table_entries(table, profile):
    """A ColorTable's entries as a machine stores them, float64 [n, 4], exact on an exact machine.

    Never write to the array.
    """
    key = id(table), None if profile.arithmetic.exact else table.bits
    found = _stored_tables.get(key)
    if found is None:
        if len(_stored_tables) >= _MOST_TABLES:
            _stored_tables.clear()
        found = _stored_tables[key] = table, arithmetic.stored_entries(table.entries, key[1])
    return found[1]


def looked_up(groups, table, profile):
    """Groups, float64 [..., 4], after Color Table Lookup in a ColorTable; a table of None changes nothing."""
    if table is None:
        return groups
    return arithmetic.looked_up(groups, table_entries(table, profile), ENTRY_COMPONENTS[table.base_format])


def _convolved(groups, kernel):
    if not groups.size and kernel.border_mode is not ConvolutionBorderMode.REDUCE:
        return groups  # There is no pixel for a border to repeat.
    components = ENTRY_COMPONENTS[kernel.base_format]
    row = column = weights = None
    if hasattr(kernel, "row"):
        row, column = np.array(kernel.row, np.float64), np.array(kernel.column, np.float64)
    else:
        weights = np.array(kernel.rows, np.float64)
    border = int(kernel.border_mode), kernel.border_color
    return arithmetic.convolved(groups, row, column, weights, components, *border)


def transfer_depths(depths, transfer):
    """Depths in [0, 1] after Arithmetic on Components, clamped to [0, 1] as final conversion does."""
    return np.clip(arithmetic.scaled(depths, transfer.depth_scale, transfer.depth_bias), 0.0, 1.0)


def transfer_stencil(indices, transfer):
    """Stencil indices, int64, after arithmetic and Stencil Index Lookup; not masked."""
    indices = arithmetic.indexed(indices, transfer.index_shift, transfer.index_offset)
    if transfer.map_stencil:
        indices = arithmetic.table_at(np.array(transfer.maps.s_to_s, np.int64), indices)
    return indices


# ---------------------------------------------------------------------------------- image data and groups


def image_groups(image):
    """The groups of a PixelImage before pixel transfer, as its format says.

    They are colours [..., h, w, 4], float64 or Words, depths float64 [..., h, w], or indices int64 [..., h,
    w].
    """
    values = image.values
    if image.format in INDEX_FORMATS:
        return _one_element(values).astype(np.int64)
    values, ones = _components(image)
    if image.format == DEPTH_FORMAT:
        return _one_element(values) if ones is None else _one_element(values) / float(ones[0])
    elements = IMAGE_FORMATS[image.format]
    if len(elements) == 1:
        values = _one_element(values)[..., None]
    groups = np.zeros((*values.shape[:-1], 4), values.dtype)
    groups[..., 3] = 1
    sources = [_element_of(component, elements) for component in "RGBA"]
    for component, element in enumerate(sources):
        if element is not None:
            groups[..., component] = values[..., element]
    if ones is None:
        return groups
    return Words(groups, tuple(1 if element is None else ones[element] for element in sources))


def _components(image):
    """The elements of an image's groups: (float64, None), or (int64, the number that is 1.0 in each element).

    Source: OpenGL 1.2.1 table 2.6.
    """
    values = image.values
    if image.packed is not None:
        fields = PACKED_TYPES[image.packed].fields
        parts = [values.astype(np.int64) >> lowest & (1 << bits) - 1 for lowest, bits in fields]
        return np.stack(parts, -1), [(1 << bits) - 1 for _, bits in fields]
    if values.dtype.kind == "f":
        return values.astype(np.float64), None
    ones = [(1 << 8 * values.dtype.itemsize) - 1] * len(IMAGE_FORMATS.get(image.format, "1"))
    values = values.astype(np.int64)
    return (2 * values + 1 if image.values.dtype.kind == "i" else values), ones


def _element_of(component, elements):
    """The place of R, G, B or A among a format's elements; None where the format lacks it."""
    if component in elements:
        return elements.index(component)
    return elements.index("L") if "L" in elements and component != "A" else None


def _one_element(values):
    """Values of a one-element format, without the axis for elements."""
    return values[..., 0] if values.ndim > 2 and values.shape[-1] == 1 else values


def transfer_image(image, transfer, profile, statistics, dimensions=2):
    """A PixelImage of colours or colour indices, [h, w(, c)], bottom row first, after pixel transfer.

    See ``transfer_colors``.
    """
    convert = transfer_color_indices if image.format == COLOR_INDEX_FORMAT else transfer_colors
    return convert(image_groups(image), transfer, profile, statistics, dimensions)


def elements_of(groups, pixel_format):
    """The elements of a format, [h, w(, c)], from RGBA groups, in order; L is R + G + B (section 4.3.2)."""
    if pixel_format in ("RGBA", "RGB"):  # already in this order
        return groups[..., : len(pixel_format)].copy()
    columns = [
        groups[..., 0] + groups[..., 1] + groups[..., 2] if e == "L" else groups[..., "RGBA".index(e)]
        for e in IMAGE_FORMATS[pixel_format]
    ]
    return np.stack(columns, -1) if len(columns) > 1 else columns[0].copy()


def packed_colors(groups, pixel_format, pixel_type):
    """Groups in the form that ReadPixels returns: Conversion to L and final conversion (section 4.3.2).

    ``pixel_format`` is one of READ_FORMATS, ``pixel_type`` one of READ_TYPES. Returns [h, w(, c)] of the
    type's NumPy type, or a packed type's words [h, w].
    """
    values = elements_of(groups, pixel_format)
    if pixel_type in PACKED_TYPES:
        word, fields = PACKED_TYPES[pixel_type]
        parts = [arithmetic.fixed(values[..., k], bits) << lowest for k, (lowest, bits) in enumerate(fields)]
        return np.bitwise_or.reduce(parts).astype(word)
    kind = np.dtype(COMPONENT_TYPES[pixel_type])
    if kind.kind == "f":
        return np.clip(values, 0.0, 1.0)
    if kind.kind == "u":
        return arithmetic.fixed(values, 8 * kind.itemsize).astype(kind)
    most = 2.0 ** (8 * kind.itemsize) - 1.0
    return arithmetic.nearest((most * np.clip(values, 0.0, 1.0) - 1.0) / 2.0).astype(kind)  # table 4.7


def packed_bytes(rgba, pixel_format):
    """``packed_colors`` for bytes as bytes: L is clamped."""
    if "L" not in IMAGE_FORMATS[pixel_format]:
        return elements_of(rgba, pixel_format)
    return np.minimum(elements_of(rgba.astype(np.uint16), pixel_format), 255).astype(np.uint8)
