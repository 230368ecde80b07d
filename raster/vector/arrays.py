"""Arrays that the vector engine's kernels take together: a thread's, a framebuffer's, a Draw's."""

from typing import NamedTuple

import numpy as np
from numba import typeof, types

from fixedpipe.raster import rows as R
from fixedpipe.raster.vector.combine import SCRATCH_PLANES
from fixedpipe.raster.vector.sample import LOCATED


class Scratch(NamedTuple):
    """Columns that a thread draws in, each ``batch + rows.SLACK`` long (``rows``: which is what)."""

    floats: np.ndarray
    ints: np.ndarray
    packed: np.ndarray
    planes: np.ndarray
    products: np.ndarray
    alive: np.ndarray
    lists: np.ndarray
    located: np.ndarray


def scratch(batch):
    """A thread's Scratch, made once for many frames."""
    columns = -(-batch // R.SLACK) * R.SLACK + R.SLACK
    return Scratch(
        floats=np.zeros((R.VECTOR_FLOAT_COLUMNS, columns), np.float64),
        ints=np.zeros((R.VECTOR_INT_COLUMNS, columns), np.int32),
        packed=np.zeros((R.VECTOR_PACKED_COLUMNS, columns), np.uint32),
        planes=np.zeros((R.VECTOR_PLANES, columns), np.int16),
        products=np.zeros((SCRATCH_PLANES, columns), np.int32),
        alive=np.zeros(columns, np.uint8),
        lists=np.zeros((R.LISTS, columns), np.int32),
        located=np.zeros((4, LOCATED, columns), np.int32),
    )


class Buffers(NamedTuple):
    """A framebuffer: colours packed, depth words, stencil, each [height, width]."""

    color: np.ndarray
    depth: np.ndarray
    stencil: np.ndarray


class Pass(NamedTuple):
    """A Draw's arrays (``rows``: what is in them)."""

    draw: np.ndarray
    draw_float: np.ndarray
    plan: np.ndarray
    factors: np.ndarray
    triangles: np.ndarray
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    inverse_w: np.ndarray
    colors: np.ndarray
    coordinates: np.ndarray
    pairs0: np.ndarray
    pairs1: np.ndarray
    pairs2: np.ndarray
    pairs3: np.ndarray
    levels: np.ndarray
    units: np.ndarray


_u8, _i32, _i64, _u32, _f64 = types.uint8, types.int32, types.int64, types.uint32, types.float64
_FOUR_TEXTURES = (_u32[::1],) * 4
JOB, JOBS = _i64[::1], _i64[:, ::1]
SCRATCH = typeof(scratch(0))
BUFFERS = types.NamedTuple((_u32[:, ::1], _u32[:, ::1], _u8[:, ::1]), Buffers)
PASS = types.NamedTuple(
    (
        _i64[::1], _f64[::1], _i32[:, ::1], _i32[:, ::1], _i32[:, ::1], _i32[::1], _i32[::1], _f64[::1],
        _f64[::1], _u8[:, :, ::1], _f64[:, :, ::1], *_FOUR_TEXTURES, _i32[:, :, ::1], _i64[:, ::1],
    ),
    Pass,
)  # fmt: skip
