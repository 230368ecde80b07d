"""What the kernels of pixel transfer are given: the steps that a PixelTransfer asks for, and its tables.

Steps depend on tables and switches alone, which many PixelTransfers share, and are kept. Scales, biases and
the colour matrix are numbers beside them, of each PixelTransfer anew.

Source: OpenGL 1.2.1 sections 3.6.3 to 3.6.5.
"""

import threading
from functools import cache
from struct import Struct
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.enums import BaseFormat
from fixedpipe.pipeline.pixel_transfer import has_color_matrix
from fixedpipe.pipeline.state import ColorTable
from fixedpipe.pipeline.textures.images import BASE_FORMAT, KEPT, REGISTER_COMPONENTS, own_widths
from fixedpipe.raster import pixel_groups as kernels
from fixedpipe.raster.pixels.transfer import stored_entries

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

# What groups have behind them: nothing; Arithmetic on Components; the maps too; a convolution.
UNSCALED, SCALED, MAPPED, CONVOLVED = range(4)
RGBA = (0, 1, 2, 3)  # where an image of RGBA has the components

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
        found = _stored_tables[key] = table, stored_entries(table.entries, key[1])
    return found[1]


class _Steps(NamedTuple):
    """``steps`` and ``entries`` as kernels take them; ``held``: the tables whose identity names them."""

    steps: NDArray[np.int64]
    entries: NDArray[np.float64]
    held: tuple[Any, ...]


# By what they depend on. It is emptied when it has this many, or so many entries in all.
_kept_steps: dict[tuple[Any, ...], _Steps] = {}
_MOST_STEPS, _MOST_ENTRIES = 64, 1 << 22

# The numbers of a PixelTransfer, by place: scale and bias at the beginning, those after convolution, the
# colour matrix, and scale and bias after it.
_pack_numbers = Struct("40d").pack_into
_CONVOLUTION_PLACE, _MATRIX_PLACE, _POST_MATRIX_PLACE, _NUMBERS_SIZE = 8, 16, 32, 320


def _numbers(transfer):
    """The numbers that steps find at their places, float64 [40]."""
    packed = bytearray(_NUMBERS_SIZE)
    first, second, third, fourth = transfer.color_matrix
    _pack_numbers(
        packed, 0, *transfer.scale, *transfer.bias,
        *transfer.post_convolution_scale, *transfer.post_convolution_bias, *first, *second, *third, *fourth,
        *transfer.post_color_matrix_scale, *transfer.post_color_matrix_bias,
    )  # fmt: skip
    return np.frombuffer(packed)


def _steps(transfer, profile, behind, sources, convolves):
    """The _Steps from a place on, up to Minmax; with ``convolves`` to the convolution.

    ``sources``: where an image's groups have R, G, B and A (``kernels.SOURCES``).
    """
    maps = transfer.maps if transfer.map_color and behind < MAPPED else None
    matrix = None if convolves or not has_color_matrix(transfer) else profile.arithmetic.clamps_color_matrix
    first = transfer.color_table if behind < CONVOLVED else None
    second = None if convolves else transfer.post_convolution_color_table
    third = None if convolves else transfer.post_color_matrix_color_table
    held = maps, first, second, third
    key = (behind, sources, matrix, profile.arithmetic.exact, *map(id, held))
    found = _kept_steps.get(key)
    if found is None:
        found = _made(profile, behind, sources, matrix, held)
        kept = sum(len(steps.entries) for steps in list(_kept_steps.values()))
        if len(_kept_steps) >= _MOST_STEPS or kept + len(found.entries) > _MOST_ENTRIES:
            _kept_steps.clear()
        _kept_steps[key] = found
    return found


def _made(profile, behind, sources, matrix, held):
    """_Steps from a place on. ``matrix``: None for no colour matrix, else whether it clamps."""
    maps, first, second, third = held
    rows, columns = [[kernels.SOURCES, *sources]], [np.zeros(0)]

    def look_up(tables):
        """A step that looks up each component in a column; a column that is the same object is kept once."""
        places, sizes, begun = [], [], {}
        for column in tables:
            if column is not None and id(column) not in begun:
                begun[id(column)] = sum(map(len, columns))
                columns.append(column)
            places.append(0 if column is None else begun[id(column)])
            sizes.append(0 if column is None else len(column))
        rows.append([kernels.LOOKUP, *places, *sizes])

    def look_up_table(table):
        if table is not None:
            of = [np.ascontiguousarray(column) for column in table_entries(table, profile).T]
            look_up([None if c is None else of[c] for c in ENTRY_COMPONENTS[table.base_format]])

    if behind == UNSCALED:
        rows.append([kernels.ARITHMETIC, 0])
    if maps is not None:
        look_up([np.array(m, np.float64) for m in (maps.r_to_r, maps.g_to_g, maps.b_to_b, maps.a_to_a)])
    look_up_table(first)
    if behind == CONVOLVED:
        rows.append([kernels.ARITHMETIC, _CONVOLUTION_PLACE])
    look_up_table(second)
    if matrix is not None:
        rows += [[kernels.MATRIX, _MATRIX_PLACE], [kernels.ARITHMETIC, _POST_MATRIX_PLACE]]
        rows += [[kernels.CLAMPING]] * matrix
    look_up_table(third)
    steps = np.array([row + [0] * (kernels.STEP - len(row)) for row in rows])
    return _Steps(steps, np.concatenate(columns), held)


_IN_ORDER = np.arange(4)
_of_thread = threading.local()


def _scratch():
    """The scratch of kernels that this thread calls."""
    try:
        return _of_thread.scratch
    except AttributeError:
        planes, codes = np.empty((kernels.PLANES, kernels.RUN)), np.empty((4, kernels.RUN), np.int32)
        _of_thread.scratch = planes, codes
        return _of_thread.scratch


def through(groups, transfer, profile, behind, convolves=False):
    """A copy of groups, float64 [..., 4], after the operations from a place on, up to Minmax; with
    ``convolves`` to the convolution.
    """
    groups = np.array(groups, np.float64, order="C")
    flat = groups.reshape(-1, 4)
    steps, entries, _ = _steps(transfer, profile, behind, RGBA, convolves)
    kernels.transfer(flat, steps, _numbers(transfer), entries, *_scratch(), _IN_ORDER, flat)
    return groups


# By the bits of a texel's component: the kernel, and the type of its results.
_STORES = {8: (kernels.texels_in_bytes, np.uint8), 12: (kernels.texels_in_words, np.uint16)}


@cache
def _stored_as(internal_format):
    """How a format's texels are stored: the plane of each register component, the bits that the format keeps
    of it, and the bits of a texel's component.
    """
    width, own = own_widths(internal_format)
    base, constants = BASE_FORMAT[internal_format], {"0": kernels.ZEROS, "1": kernels.ONES}
    places, bits = [], []
    for what in REGISTER_COMPONENTS[base]:
        place, kept_bits = (
            (KEPT[base][what], own[what]) if isinstance(what, int) else (constants[what], width)
        )
        places.append(place)
        bits.append(kept_bits)
    return np.array(places), np.array(bits), width


def texels_through(elements, shape, sources, transfer, profile, behind, internal_format):
    """(real texels, texels) of an image after the operations from a place on, up to Minmax: [*shape, 4], as
    ``Texture`` has them in ``ideal`` and in levels of the format's own bits.

    - ``elements``: float64, C-contiguous, of groups in order.
    - ``sources``: where they have R, G, B and A, and how many they are in a group.
    """
    places, bits, width = _stored_as(internal_format)
    store, kind = _STORES[width]
    real, texels = np.empty((*shape, 4)), np.empty((*shape, 4), kind)
    steps, entries, _ = _steps(transfer, profile, behind, sources[:4], False)
    stored_as, made = (places, bits, width), (real.reshape(-1, 4), texels.reshape(-1, 4))
    groups = elements.reshape(-1, sources[4])
    store(groups, steps, _numbers(transfer), entries, *_scratch(), stored_as, made)
    real.setflags(write=False)
    texels.setflags(write=False)
    return real, texels
