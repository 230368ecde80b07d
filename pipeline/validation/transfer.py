"""Validation of PixelTransfers, ColorTables and PixelImages.

The type checks run first: fields have the types of ``fixedpipe.pipeline.pixel_transfer``, and are finite.

Source: the errors of OpenGL 1.2.1 sections 3.6.3 and 3.6.4, SGI_color_table, EXT_convolution, EXT_histogram.
"""

from itertools import chain

import numpy as np

from fixedpipe.pipeline.enums import BaseFormat
from fixedpipe.pipeline.messages import quoted
from fixedpipe.pipeline.pixel_transfer import INITIAL_TRANSFER, filter_size, transferred_size
from fixedpipe.pipeline.textures.pixel_formats import (
    DEPTH_FORMAT,
    IMAGE_FORMATS,
    INDEX_FORMATS,
    PACKED_TYPES,
    packed_formats,
)

# Source: OpenGL 1.2.1 section 2.1.1: every machine's floating-point numbers reach this magnitude. Below it
# the arithmetic of pixel transfer stays far inside float64's range.
_MOST = 2.0**32
# A sum of squares up to here has no square of a larger number than 2**32, however it is rounded.
_SMALL_SQUARES = 2.0**60
_MOST_SHIFT = 31  # an index has 32 bits
_TABLES = ("color_table", "post_convolution_color_table", "post_color_matrix_color_table")
_FILTERS = ("convolution_1d", "convolution_2d", "separable_2d")
_POST_MATRIX = ("post_color_matrix_scale", "post_color_matrix_bias")
_POST_CONVOLUTION = ("post_convolution_scale", "post_convolution_bias")


def _is_power_of_two(number):
    return number > 0 and number & (number - 1) == 0


def transferred(walk, command, width, height, dimensions=2, deep=False):
    """Width and height of the pixels after the command's pixel transfer.

    They are 0 where a convolution leaves nothing, which is no error (section 3.6.5, REDUCE).
    """
    transfer = command.transfer
    if id(transfer) not in walk.taken.transfers:
        if problem := _transfer_problem(transfer, walk.profile):
            walk.refuse(problem)
        walk.taken.transfers.add(transfer)
    for table, known in ((transfer.histogram, walk.histograms), (transfer.minmax, walk.minmaxes)):
        if table is not None:
            known.add(table.name)
    return (width, height) if deep else transferred_size(width, height, transfer, dimensions)


def reset_histogram(walk, command):
    """Refuse a ResetHistogram of a histogram that no earlier command counted in."""
    _known_table(walk, "histogram", command.name, walk.histograms)


def reset_minmax(walk, command):
    """Refuse a ResetMinmax of a minmax that no earlier command used."""
    _known_table(walk, "minmax", command.name, walk.minmaxes)


def _known_table(walk, what, name, known):
    if name not in known:
        made = quoted(sorted(known))
        walk.refuse(
            f"there is no {what} {name!r} yet (counted so far: {made}); name it in a pixel transfer before."
        )


def _transfer_problem(transfer, profile):
    """A sentence that says why a machine cannot perform a PixelTransfer on any image, or None.

    A program may give each of thousands of images its own, so a microsecond counts.
    """
    if transfer is INITIAL_TRANSFER:
        return None
    if problem := (
        _subset_problem(transfer, profile)
        or _numbers_problem(transfer)
        or _maps_problem(transfer.maps, profile)
    ):
        return problem
    for names, of_part in _PARTS:
        for name in names:
            part = getattr(transfer, name)
            if part is not None and (problem := of_part(name, part, profile)):
                return problem
    return None


def _subset_problem(transfer, profile):
    """A sentence that names a used part of the imaging subset that the machine lacks, or None."""
    initial, pixels = INITIAL_TRANSFER, profile.pixels
    if pixels.color_matrix and pixels.color_tables and pixels.convolution and pixels.histogram:
        return None

    def asked(*names):
        return [name for name in names if getattr(transfer, name) != getattr(initial, name)]

    for has, names, instead in (
        (
            pixels.color_matrix,
            asked("color_matrix", *_POST_MATRIX),
            "no colour matrix; combine components in a pass",
        ),
        (
            pixels.color_tables,
            asked(*_TABLES),
            "no colour tables in pixel transfer; use pixel maps (map_color)",
        ),
        (
            pixels.convolution,
            asked(*_FILTERS, *_POST_CONVOLUTION),
            "no convolution; add shifted copies by blending",
        ),
        (
            pixels.histogram,
            asked("histogram", "minmax"),
            "no histogram and no minmax; count what ReadPixels returns",
        ),
    ):
        if names and not has:
            return (
                f"the pixel transfer sets {names[0]}; {profile.name} has {instead}, or choose a profile with "
                "the imaging subset."
            )
    return None


def _numbers_problem(transfer):
    """A sentence that names a number beyond 2**32, or a shift of more bits than an index has, or None."""
    numbers = (
        *transfer.scale, *transfer.bias, *transfer.post_convolution_scale, *transfer.post_convolution_bias,
        *transfer.post_color_matrix_scale, *transfer.post_color_matrix_bias, *chain(*transfer.color_matrix),
        transfer.depth_scale, transfer.depth_bias,
    )  # fmt: skip
    if max(numbers) <= _MOST and min(numbers) >= -_MOST and abs(transfer.index_shift) <= _MOST_SHIFT:
        return None
    for name in ("scale", "bias", *_POST_CONVOLUTION, *_POST_MATRIX, "color_matrix"):
        value = getattr(transfer, name)
        numbers = chain(*value) if name == "color_matrix" else value
        if any(abs(number) > _MOST for number in numbers):
            return f"the pixel transfer's {name} is {value}; give magnitudes up to 2**32."
    for name in ("depth_scale", "depth_bias"):
        if abs(getattr(transfer, name)) > _MOST:
            return f"the pixel transfer's {name} is {getattr(transfer, name)}; give magnitudes up to 2**32."
    if abs(transfer.index_shift) > _MOST_SHIFT:
        return f"the pixel transfer's index_shift is {transfer.index_shift}; give -31 to 31."
    return None


def _maps_problem(maps, profile):
    if maps is INITIAL_TRANSFER.maps:
        return None
    for name in maps.__dataclass_fields__:
        table, most = getattr(maps, name), profile.pixels.max_pixel_map_table
        if not 1 <= len(table) <= most:
            return f"pixel map {name} has {len(table)} entries; {profile.name} takes 1 to {most}."
        if name[0] in "is" and not _is_power_of_two(len(table)):
            return (
                f"pixel map {name} has {len(table)} entries; a map that takes an index has a power of two of "
                "them. Repeat its last entry."
            )
        if any(abs(value) > _MOST for value in table):
            return f"pixel map {name} holds a magnitude above 2**32; give smaller ones."
    return None


def color_table_problem(what, table, profile):
    """A sentence that says what is wrong with a ColorTable, named ``what``, or None.

    A table of None is disabled.
    """
    if table is None:
        return None
    size, most = len(table.entries), profile.pixels.max_color_table_size
    if not _is_power_of_two(size):
        return f"{what} has {size} entries; a colour table has a power of two of them. Pad it, or give None."
    if size > most:
        return f"{what} has {size} entries; {profile.name} holds tables of up to {most}. Give fewer."
    if table.bits is not None and not 1 <= table.bits <= 16:
        return f"{what} keeps {table.bits} bits; give 1 to 16, or None for the entries as they are."
    return None


def _filter_problem(name, kernel, profile):
    rows = (kernel.row, kernel.column) if name == "separable_2d" else kernel.rows
    wide, high = filter_size(kernel)
    if not wide or not high:
        return f"{name} has {wide}x{high} pixels; give a filter of at least 1x1, or None."
    if name == "convolution_1d" and high != 1:
        return f"convolution_1d has {high} rows; a one-dimensional filter has one. Use convolution_2d."
    if name != "separable_2d" and any(len(row) != wide for row in rows):
        return f"the rows of {name} have different lengths; give each {wide} pixels."
    most = profile.pixels.max_convolution_size
    if max(wide, high) > most:
        return (
            f"{name} has {wide}x{high} pixels; {profile.name} convolves with up to {most}x{most}. Split the "
            "filter, or shrink it."
        )
    if any(abs(weight) > _MOST for weight in chain(kernel.border_color, *chain(*rows))):
        return f"{name} holds a magnitude above 2**32; give smaller ones."
    return None


def _counting_problem(name, table, profile):
    if table.base_format is BaseFormat.INTENSITY:
        return f"the {name}'s base format is INTENSITY, which it cannot have; give LUMINANCE."
    if name == "histogram" and not _is_power_of_two(table.width):
        return f"the histogram has {table.width} entries; give a power of two."
    if name == "histogram" and table.width > profile.pixels.max_color_table_size:
        return (
            f"the histogram has {table.width} entries; {profile.name} holds up to "
            f"{profile.pixels.max_color_table_size}. Give fewer."
        )
    return None


# The parts of a PixelTransfer that are disabled as None, and what finds a problem of one.
_PARTS = (
    (_TABLES, color_table_problem),
    (_FILTERS, _filter_problem),
    (("histogram", "minmax"), _counting_problem),
)


def pixel_image_problem(image, formats=(*IMAGE_FORMATS, DEPTH_FORMAT, *INDEX_FORMATS), axes=2):
    """A sentence that says what is wrong with a PixelImage, or None.

    - ``formats``: the formats that it may have.
    - ``axes``: the image's axes besides its components: 2, or 3 with faces or layers.
    """
    if image.format not in formats:
        return f"the image's format is {image.format!r}; give one of {', '.join(formats)}."
    if image.packed is not None and (problem := _packed_problem(image)):
        return problem
    values = image.values
    elements = 1 if image.packed else len(IMAGE_FORMATS.get(image.format, "1"))
    size = "[height, width]" if axes == 2 else "[layers, height, width]"
    shape = values.shape
    whole = len(shape) == axes
    if not (whole if image.packed else shape[axes:] == (elements,) or (elements == 1 and whole)):
        what = image.packed or image.format
        components = f"{size[:-1]}, {elements}]"
        return f"the {what} image has shape {shape}; give {components if elements > 1 else size}."
    if 0 in shape:
        return f"the image has shape {shape}; give at least one pixel."
    integers = values.dtype.kind in "iu" and values.dtype.itemsize <= 4
    if image.format in INDEX_FORMATS:
        if integers:
            return None
        return (
            f"the image's indices are {values.dtype}; give integers of 8, 16 or 32 bits: .astype(np.uint32)."
        )
    if integers:
        return None
    if values.dtype.kind != "f":
        return (
            f"the image's values are {values.dtype}; give integers of 8, 16 or 32 bits, which are fractions, "
            "or floats: .astype(np.uint8) if they are bytes."
        )
    # Then none of them is too large; not of NaN. Half floats have no such squares.
    if values.dtype.itemsize > 2 and np.vdot(values, values) <= _SMALL_SQUARES:
        return None
    most = values.dtype.type(min(_MOST, float(np.finfo(values.dtype).max)))  # half floats end below 2**32
    if not (np.abs(values) <= most).all():  # also true of NaN
        return "the image holds NaN, infinity or a magnitude above 2**32; give finite, smaller values."
    return None


def _packed_problem(image):
    """A sentence that says what is wrong with an image of packed words, or None.

    Source: OpenGL 1.2.1 table 3.8.
    """
    if image.packed not in PACKED_TYPES:
        return (
            f"the image's packed type is {image.packed!r}; give one of {', '.join(PACKED_TYPES)}, or None "
            "for components."
        )
    formats, word = packed_formats(image.packed), PACKED_TYPES[image.packed].word
    if image.format not in formats:
        return (
            f"{image.packed} holds groups of {' or '.join(formats)}, and the image's format is "
            f"{image.format}; give that format, or components."
        )
    if image.values.dtype != word:
        return f"the {image.packed} words are {image.values.dtype}; give {word}: .astype(np.{word})."
    return None
