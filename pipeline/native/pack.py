"""Packing: validated state becomes the rows that kernels read (``raster/rows.py``). No other package packs
a state.

What is disabled packs to zero and what cannot matter is not asked for, so two states that cannot differ in
their result give equal rows, and kernels do no work whose result nobody reads.
"""

from typing import NamedTuple

import numpy as np

from fixedpipe.pipeline.framebuffers.depths import depth_units
from fixedpipe.pipeline.native.state_rows import rows_of
from fixedpipe.pipeline.state import PassState
from fixedpipe.raster import codes as C


class PackedState(NamedTuple):
    """The rows of one pass: see ``raster/rows.py`` for their layout."""

    draw: np.ndarray
    draw_float: np.ndarray
    program: np.ndarray
    final: np.ndarray
    constants: np.ndarray
    arithmetic: np.ndarray
    factors: np.ndarray
    units: np.ndarray
    fog_thresholds: np.ndarray
    depths: np.ndarray  # float64 [n]: every vertex's depth in depth units, a single
    reads: tuple  # of each unit that reads a texture: its number, the texture's name, the bits inverted
    area: int  # pixels of the scissor box
    wide: bool  # whether some components are wider than bytes, which the portable engine alone draws
    derived: dict  # what others make of these rows, which is kept with them


def pack(state: PassState, profile, framebuffer, textures, primitives, sample=None):
    """Rows of a validated pass. ``textures`` maps names to Texture; ``primitives`` say what varies;
    ``sample``: as ``pack_coverage`` has it.

    Rows are shared by all that pack the same: they are not written to.
    """
    rows = rows_of(state, profile, framebuffer, textures, sample)
    flat = C.COLORS_SMOOTH
    if rows.reads_color and (rows.flat or primitives.constant_color):
        flat = C.COLORS_FLAT if rows.flat else C.COLORS_EQUAL
    varies = (
        primitives.two_side,
        len(primitives.strokes) > 0,
        flat,
        *[primitives.projective[unit] for unit in rows.divided],
    )
    draw, units, derived = rows.varied.get(varies) or rows.vary(varies)
    depths = depth_units(state, framebuffer, primitives) if rows.needs_depth else primitives.z
    shared = rows.shared
    return PackedState(
        draw, rows.draw_float, *shared, units, rows.fog_thresholds, depths, rows.reads, rows.area, rows.wide,
        derived,
    )  # fmt: skip
