"""Packing: a validated state becomes the rows that kernels read (``raster/rows.py``), in this package alone.

A disabled stage packs to zero, and state that cannot matter is not read. So two states whose results cannot
differ give equal rows, and kernels compute no unused result.
"""

from typing import NamedTuple

import numpy as np

from fixedpipe.pipeline.framebuffers.depths import depth_units
from fixedpipe.pipeline.native.state_rows import StateRows, rows_of
from fixedpipe.pipeline.state import PassState


class PackedState(NamedTuple):
    """The rows of one pass; ``raster/rows.py`` has their layout."""

    draw: np.ndarray
    draw_float: np.ndarray
    program: np.ndarray
    final: np.ndarray
    constants: np.ndarray
    arithmetic: np.ndarray
    factors: np.ndarray
    units: np.ndarray
    fog_thresholds: np.ndarray
    depths: np.ndarray  # float64 [n]: every vertex's depth in depth units, in single precision
    reads: tuple  # for each unit that reads a texture: its number, the texture's name, the inverted bits
    area: int  # pixels of the scissor box
    wide: bool  # whether a component is wider than a byte; only the portable engine draws such
    rows: StateRows  # that these are of
    derived: dict  # data that others derive from these rows, kept with them


def pack(state: PassState, profile, framebuffer, textures, primitives, sample=None):
    """Rows of a validated pass.

    - ``textures``: {name: Texture}.
    - ``primitives``: they say what varies.
    - ``sample``: see ``pack_coverage``.

    Equal passes share the rows: never write to them.
    """
    rows = rows_of(state, profile, framebuffer, textures, sample)
    p = primitives
    one_color = rows.reads_color and not rows.flat and p.constant_color
    projective = p.projective if rows.divided else ()
    draw, units, derived = rows.variant(p.two_side, len(p.strokes) > 0, one_color, projective)
    depths = depth_units(state, framebuffer, primitives) if rows.needs_depth else primitives.z
    shared = rows.shared
    return PackedState(
        draw, rows.draw_float, *shared, units, rows.fog_thresholds, depths, rows.reads, rows.area, rows.wide,
        rows, derived,
    )  # fmt: skip
