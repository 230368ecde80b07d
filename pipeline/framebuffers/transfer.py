"""Pixel transfer of images: operations in order, histograms and minmaxes, image data to groups and back.

Kernels take each group by itself (``transfer_steps``); ``fixedpipe.raster.pixels.transfer`` convolves and
counts, and takes depths and indices. Colour groups are float64 [height, width, 4], RGBA, before final
conversion. Depths are float64 and indices int64 [height, width]. The bottom row is first.

Source: OpenGL 1.2.1 sections 3.6.3 to 3.6.5 and 4.3.2.
"""

from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode
from fixedpipe.pipeline.framebuffers.scaled_words import Words, scaled_words
from fixedpipe.pipeline.framebuffers.transfer_steps import (
    CONVOLVED,
    ENTRY_COMPONENTS,
    MAPPED,
    RGBA,
    SCALED,
    UNSCALED,
    texels_through,
    through,
)
from fixedpipe.pipeline.pixel_transfer import (
    INITIAL_TRANSFER,
    Histogram,
    Minmax,
    PixelImage,
    PixelTransfer,
    convolution,
)
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
    behind = UNSCALED
    if isinstance(groups, Words):
        groups, behind = scaled_words(groups, transfer.scale, transfer.bias), SCALED
    return _transferred(groups, behind, transfer, profile, statistics, dimensions)


def transfer_color_indices(indices, transfer, profile, statistics, dimensions=2):
    """Colour indices after pixel transfer, which makes RGBA groups of them; see ``transfer_colors``."""
    indices = arithmetic.indexed(indices, transfer.index_shift, transfer.index_offset)
    maps = transfer.maps
    tables = (maps.i_to_r, maps.i_to_g, maps.i_to_b, maps.i_to_a)
    groups = np.stack([arithmetic.table_at(np.array(table, np.float64), indices) for table in tables], -1)
    return _transferred(groups, MAPPED, transfer, profile, statistics, dimensions)


def _transferred(groups, behind, transfer, profile, statistics, dimensions):
    """The operations from a place on, up to Minmax."""
    if (kernel := convolution(transfer, dimensions)) is not None:
        groups = _convolved(through(groups, transfer, profile, behind, convolves=True), kernel)
        behind = CONVOLVED
    groups = through(groups, transfer, profile, behind)
    if transfer.histogram is not None:
        statistics.count(groups, transfer.histogram)
        if transfer.histogram.sink:
            return None
    if transfer.minmax is not None:
        statistics.compare(groups, transfer.minmax)
        if transfer.minmax.sink:
            return None
    return groups


def looked_up(groups, table, profile):
    """Groups, float64 [..., 4], after Color Table Lookup in a ColorTable; a table of None changes nothing."""
    if table is None:
        return groups
    return through(groups, PixelTransfer(color_table=table), profile, MAPPED)


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


def image_texels(image, layers, transfer, profile, statistics, dimensions, internal_format):
    """(real texels, texels) [layers, h, w, 4] that a PixelImage of colours or colour indices becomes, in the
    bits of an internal format; None where a sink took it.

    ``layers`` is whether the image has an axis for faces or layers.
    """
    values = image.values
    counts = transfer.histogram is not None or transfer.minmax is not None
    of_reals = image.packed is None and values.dtype.kind == "f"
    if of_reals and not counts and convolution(transfer, dimensions) is None:
        shape = values.shape[:3] if layers else (1, *values.shape[:2])
        given = _sources_of(image.format), transfer, profile, UNSCALED, internal_format
        return texels_through(values.astype(np.float64), shape, *given)
    images = []
    for layer in values if layers else values[None]:
        part = PixelImage(layer, image.format, image.packed) if layers else image
        images.append(transfer_image(part, transfer, profile, statistics, dimensions))
    if images[-1] is None:
        return None
    groups = np.stack(images)
    given = (*RGBA, 4), INITIAL_TRANSFER, profile, MAPPED, internal_format
    return texels_through(groups, groups.shape[:3], *given)


@cache
def _sources_of(pixel_format):
    """Where a format's groups have R, G, B and A, missing ones at constants; and the number of elements."""
    elements = IMAGE_FORMATS[pixel_format]
    missing = {"A": len(elements) + 1}
    places = [_element_of(component, elements) for component in "RGBA"]
    found = [missing.get(c, len(elements)) if p is None else p for c, p in zip("RGBA", places, strict=True)]
    return (*found, len(elements))


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
