"""Arrays that the vector engine's kernels take together: a thread's, and a Draw's."""

from typing import NamedTuple

import numpy as np
from numba import typeof, types

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import (
    BANDS,
    STATE,
    TEXTURES,
    VERTICES,
    State,
    Textures,
    Vertices,
    named,
    type_of,
)
from fixedpipe.raster.vector.addresses import kept_arrays, places
from fixedpipe.raster.vector.combine import SCRATCH_PLANES
from fixedpipe.raster.vector.sample import LOCATED


class Scratch(NamedTuple):
    """Columns that a thread draws in, each ``batch + rows.SLACK`` long (``rows``: which is what), and what
    sixteen triangles have before their fragments are there (``small_triangles``).
    """

    floats: np.ndarray
    ints: np.ndarray
    packed: np.ndarray
    planes: np.ndarray
    products: np.ndarray
    alive: np.ndarray
    lists: np.ndarray
    located: np.ndarray
    lanes: np.ndarray
    lane_floats: np.ndarray
    singles: np.ndarray


_LINE = 64  # bytes: a line of the cache, and the longest vector


def _columns(count, length, dtype):
    """``count`` columns of zeros, each a whole number of lines where ``length`` is one of rows.SLACK.

    A vector that crosses a line costs two loads. Measured: 4 to 11 per cent of scenes b to h with vectors of
    64 bytes, 1 to 6 with those of 32 (AMD EPYC, Zen 4).
    """
    size = count * length * np.dtype(dtype).itemsize
    room = np.zeros(size + _LINE, np.uint8)
    start = -room.ctypes.data % _LINE
    return room[start : start + size].view(dtype).reshape(count, length)


def scratch(batch):
    """A thread's Scratch, made once for many frames."""
    columns = -(-batch // R.SLACK) * R.SLACK + R.SLACK
    return Scratch(
        floats=_columns(R.VECTOR_FLOAT_COLUMNS, columns, np.float64),
        ints=_columns(R.VECTOR_INT_COLUMNS, columns, np.int32),
        packed=_columns(R.VECTOR_PACKED_COLUMNS, columns, np.uint32),
        planes=_columns(R.VECTOR_PLANES, columns, np.int16),
        products=_columns(SCRATCH_PLANES, columns, np.int32),
        alive=_columns(1, columns, np.uint8)[0],
        lists=_columns(R.LISTS, columns, np.int32),
        located=_columns(4 * LOCATED, columns, np.int32).reshape(4, LOCATED, columns),
        lanes=_columns(R.LANES, 16, np.int32),
        lane_floats=_columns(R.VECTOR_FLOAT_COLUMNS - R.WEIGHT_FACTOR0, 16, np.float64),
        singles=_columns(R.SINGLE_COLUMNS, columns, np.float32),
    )


class Pass(NamedTuple):
    """A Draw's arrays. plan int32[operations, OPERATION_SIZE]: the combiners' (``combine``); triangles
    int32[n, 4]: three vertices, and the provoking one; textures: as row pairs (``sample``).
    """

    state: State
    plan: np.ndarray
    triangles: np.ndarray
    vertices: Vertices
    textures: Textures


class Record(NamedTuple):
    """Where a recorded Draw's fragments go: those of band b to ``rows`` from ``firsts[b]`` on.

    firsts  int64[bands]
    counts  int64[bands]: how many fragments a band has
    rows    int32[n, 4]: triangle, x, y, and 1 where the fragment passed the per-fragment tests, else 0
    """

    firsts: np.ndarray
    counts: np.ndarray
    rows: np.ndarray


JOB, JOBS = types.int64[::1], types.int64[:, ::1]
SCRATCH = typeof(scratch(0))
PASS = type_of(Pass, STATE, types.int32[:, ::1], types.int32[:, ::1], VERTICES, TEXTURES)
RECORD = type_of(Record, types.int64[::1], types.int64[::1], types.int32[:, ::1])
# Where a job has its Draw's bands, pass and record, and how long its row is. Kernels take a pass from its
# job: handed on from one to the next its arrays cost more (Measured: 5 per cent of one bilinear texture, AMD
# EPYC).
_PASS = R.JOB_ARRAYS + places(BANDS)
_RECORD = _PASS + places(PASS)
JOB_SIZE = _RECORD + places(RECORD)
keep_bands, bands_of = kept_arrays(BANDS, R.JOB_ARRAYS)
keep_pass, pass_of = kept_arrays(PASS, _PASS)
keep_record, record_of = kept_arrays(RECORD, _RECORD)
as_pass = named(PASS)
