"""Arrays that the portable engine's kernels take together: a Draw's, and a batch's columns."""

from typing import NamedTuple

import numpy as np
from numba import types

from fixedpipe.raster.arrays import STATE, TEXTURES, VERTICES, State, Textures, Vertices, named, type_of

_u8, _i16, _i32, _u32, _f64 = types.uint8, types.int16, types.int32, types.uint32, types.float64


class Combiners(NamedTuple):
    """Register combiners (``rows``), and how they compute (``portable.combine``)."""

    program: np.ndarray
    final: np.ndarray
    constants: np.ndarray
    arithmetic: np.ndarray


COMBINERS = type_of(Combiners, _i32[:, :, ::1], _i32[:, ::1], _i16[:, ::1], _i32[::1])


class FogFactors(NamedTuple):
    """float64: each vertex's fog coordinate, and the thresholds or the table that make it a factor."""

    coordinates: np.ndarray
    thresholds: np.ndarray


FOG_FACTORS = type_of(FogFactors, _f64[::1], _f64[::1])


class Pass(NamedTuple):
    """A Draw's arrays. triangles int32[n, 4]: three vertices, and the provoking one; strokes as ``rows``;
    colors int16[n, 2, 8]: the vertices', of the draw's BITS, in the place of ``vertices.colors``.
    """

    state: State
    combiners: Combiners
    triangles: np.ndarray
    strokes: np.ndarray
    vertices: Vertices
    colors: np.ndarray
    fog: FogFactors
    textures: Textures


_OF_PRIMITIVES = _i32[:, ::1], _i32[:, ::1], VERTICES, _i16[:, :, ::1], FOG_FACTORS
PASS = type_of(Pass, STATE, COMBINERS, *_OF_PRIMITIVES, TEXTURES)
as_pass = named(PASS)


class Edges(NamedTuple):
    """Edge functions times 1/w of each fragment, float64[batch]."""

    e0: np.ndarray
    e1: np.ndarray
    e2: np.ndarray


EDGES = type_of(Edges, _f64[::1], _f64[::1], _f64[::1])


class Scratch(NamedTuple):
    """Columns that a batch is drawn in (``rows``: which is what of floats, ints, packed and lists).

    registers  int16[4 * REGISTERS, batch]: planes of the combiners' registers
    products   int32[8, batch], total int32[1, batch]: what combiners compute
    results    int16[12, batch]: planes 0..3 are the fragments' colours
    shaded     uint32[batch]: those, packed
    depth      int32[batch]: depth words; -1: outside its limits
    alive      uint8[batch]: 1: the fragment has passed so far
    spans      int64[MAX_COVER_SAMPLES, 2]: the pixels of a row where a primitive covers each sample
    """

    edges: Edges
    floats: np.ndarray
    ints: np.ndarray
    packed: np.ndarray
    registers: np.ndarray
    products: np.ndarray
    total: np.ndarray
    results: np.ndarray
    shaded: np.ndarray
    depth: np.ndarray
    alive: np.ndarray
    lists: np.ndarray
    spans: np.ndarray


_COLUMNS = (_f64[:, ::1], _i32[:, ::1], _u32[:, ::1], _i16[:, ::1], _i32[:, ::1], _i32[:, ::1], _i16[:, ::1])
SCRATCH = type_of(
    Scratch, EDGES, *_COLUMNS, _u32[::1], _i32[::1], _u8[::1], _i32[:, ::1], types.int64[:, ::1]
)


class Batch(NamedTuple):
    """What a batch holds so far: how many fragments (``position``), segments and runs; ``drawn``: fragments
    of the batches before it.
    """

    position: int
    segments: int
    runs: int
    drawn: int


BATCH = type_of(Batch, *(types.int64,) * 4)
