"""Arrays that kernels take together, in both compiled engines: a state's rows, vertices, textures, bands, a
framebuffer, and what a batch's fragments belong to. Behind each stands its type, for kernels' signatures.

What only one engine takes is in its own ``arrays``.
"""

from typing import NamedTuple

import numpy as np
from numba import types
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic


def type_of(kind, *members):
    """Numba's type of a named tuple (or, of ``tuple``, a plain one) whose members have these types."""
    return types.BaseTuple.from_types(members, None if kind is tuple else kind)


def plain(kind):
    """The type of plain tuples that hold what named ones of a type hold.

    Kernels that Python calls for each Draw take these: naming four tuples costs a call 2 microseconds
    (Measured: AMD EPYC), which is half of what a small Draw's row takes.
    """
    if isinstance(kind, types.BaseTuple):
        return types.BaseTuple.from_types([plain(member) for member in kind])
    return kind


def named(kind):
    """The function, for kernels, that makes a named tuple of this type of plain ones."""

    @intrinsic
    def name(typing_context, arrays):
        def codegen(context, builder, signature, args):
            return impl_ret_borrowed(context, builder, kind, args[0])  # they are the same in memory

        return kind(plain(kind)), codegen

    return name


_u8, _i32, _i64, _u32, _f64 = types.uint8, types.int32, types.int64, types.uint32, types.float64
THREE = types.UniTuple(_f64, 3)  # a number of each vertex


class State(NamedTuple):
    """What a state packs to (``rows``), but for combiners and textures."""

    draw: np.ndarray
    draw_float: np.ndarray
    factors: np.ndarray


STATE = type_of(State, _i64[::1], _f64[::1], _i32[:, ::1])


class Vertices(NamedTuple):
    """Window vertices, a row each.

    x, y         int32[n], 1/16 pixel
    z            float64[n], depths
    inverse_w    float64[n]
    colors       uint8[n, 2, 8]: front and back; primary and secondary RGBA
    coordinates  float64[n, units, 4]: s, t, r, q
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    inverse_w: np.ndarray
    colors: np.ndarray
    coordinates: np.ndarray


VERTICES = type_of(Vertices, _i32[::1], _i32[::1], _f64[::1], _f64[::1], _u8[:, :, ::1], _f64[:, :, ::1])


class Textures(NamedTuple):
    """What texture units read: four arrays of packed texels uint32[n], each unit's levels and its row
    (``rows``).
    """

    texels: tuple
    levels: np.ndarray
    units: np.ndarray


TEXTURES = type_of(Textures, types.UniTuple(_u32[::1], 4), _i32[:, :, ::1], _i64[:, ::1])


class Bands(NamedTuple):
    """Primitives sorted into bands of rows (``primitives.bins``): band b's are
    ``order[ends[b - 1] : ends[b]]``.
    """

    order: np.ndarray
    ends: np.ndarray


BANDS = type_of(Bands, _i32[::1], _i32[::1])
as_bands = named(BANDS)


class Buffers(NamedTuple):
    """A framebuffer: colours packed, depth words, stencil, each [height, width]."""

    color: np.ndarray
    depth: np.ndarray
    stencil: np.ndarray


BUFFERS = type_of(Buffers, _u32[:, ::1], _u32[:, ::1], _u8[:, ::1])
as_buffers = named(BUFFERS)


class Segments(NamedTuple):
    """Consecutive fragments of one triangle: int32 where each segment begins, and behind the last where it
    ends; its triangle; 1: the back colour.
    """

    starts: np.ndarray
    owners: np.ndarray
    backs: np.ndarray
    count: int


SEGMENTS = type_of(Segments, _i32[::1], _i32[::1], _i32[::1], _i64)


class Runs(NamedTuple):
    """Consecutive pixels of a row: int32 the fragment that each run begins with, and behind the last where
    it ends; its pixel.
    """

    starts: np.ndarray
    x: np.ndarray
    y: np.ndarray
    count: int


RUNS = type_of(Runs, _i32[::1], _i32[::1], _i32[::1], _i64)


class Run(NamedTuple):
    """One run: ``count`` pixels from (x, y) to the right, which fragments from ``start`` on are for."""

    x: int
    y: int
    count: int
    start: int


RUN = type_of(Run, _i64, _i64, _i64, _i64)
