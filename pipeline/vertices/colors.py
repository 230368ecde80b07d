"""Normals and colours of vertices: lit or given, clamped, and converted to the bytes that are iterated."""

import numpy as np

from fixedpipe.pipeline.enums import Clamp, LightingArithmetic, SecondaryColor
from fixedpipe.pipeline.profiles.profile import NATIVE_BITS
from fixedpipe.pipeline.vertices import lighting_unit
from fixedpipe.pipeline.vertices.arithmetic import ONE, columns_of, filled_rows, positive
from fixedpipe.pipeline.vertices.lighting import eye_normals, light_vertices
from fixedpipe.pipeline.vertices.primitives import is_constant
from fixedpipe.raster.floats import SIGNIFICANT_BITS, keep_significant_bits, kept
from fixedpipe.raster.primitives.lighting_columns import rounded_colors
from fixedpipe.raster.primitives.meshes import color_bytes

COLOR_REACH = 1 << 10  # without a clamp, colours are limited to this magnitude; 1.0 is full intensity
_NONE = np.zeros((0, 0))  # stands for an array that a mesh lacks


def eye_normal(mesh, vertex):
    """Normals in eye coordinates (section 2.10.3), float64 [3, n]; with two modelview matrices,
    EXT_vertex_weighting's.
    """
    _, normals, _, _, weights = lighting_unit.arrays_of(mesh)
    return eye_normals(vertex, len(mesh.positions), normals, weights)


def lit_colors(mesh, vertex, eye, normal, profile):
    """Front and back colours of lit vertices, float64 [16, n], or [8, n] if they are the same.

    They are clamped to [0, 1] (section 2.13.6) on a machine that does so.
    """
    clamped = _clamps_colors(profile)
    if profile.arithmetic.lighting == LightingArithmetic.LIGHTING_UNIT:
        return lighting_unit.light_vertices(vertex, mesh, clamped=clamped)
    _, _, colors, _, _ = lighting_unit.arrays_of(mesh)
    eye = filled_rows(len(mesh.positions), eye)
    return light_vertices(vertex, eye, _NONE if normal is None else normal, colors, clamped=clamped)


def vertex_colors(mesh, vertex, eye, normal, profile):
    """Front and back colours, 8 columns each; one list for both if they are the same.

    They are clamped to [0, 1] (section 2.13.6) on a machine that does so.
    """
    if vertex.lighting is not None:
        lit = [*lit_colors(mesh, vertex, eye, normal, profile)]
        front, back = lit[:8], lit[8:]
        return front, back or front
    color = columns_of(mesh.colors, (1.0, 1.0, 1.0, 1.0))
    secondary = columns_of(mesh.secondary_colors, (0.0, 0.0, 0.0, 0.0))
    front = back = color + secondary
    if vertex.two_side:
        black = (0.0, 0.0, 0.0, 1.0)
        back = columns_of(mesh.back_colors, black) + columns_of(mesh.back_secondary_colors, black)
    if vertex.secondary_color != SecondaryColor.FROM_VERTEX:
        both = back is front
        front = lighting_unit.secondary_output(front, vertex.secondary_color)
        back = front if both else lighting_unit.secondary_output(back, vertex.secondary_color)
    if not _clamps_colors(profile):
        return front, back
    clamped = [np.fmin(positive(column), ONE) for column in front]
    return clamped, clamped if back is front else [np.fmin(positive(column), ONE) for column in back]


def _clamps_colors(profile):
    return Clamp.VERTEX_COLOR in profile.arithmetic.clamps


def given_colors(mesh, columns, vertex, profile, bits):
    """Colours of vertices without lighting, in WindowPrimitives' form, and whether all are equal.

    ``bits`` is the result of ``kept_color_bits``, or None.
    """
    key = vertex.two_side, vertex.secondary_color, bits, _clamps_colors(profile)
    if key not in columns.colors and key == (False, SecondaryColor.FROM_VERTEX, bits, True) and bits:
        given = [
            _NONE if a is None else np.ascontiguousarray(a) for a in (mesh.colors, mesh.secondary_colors)
        ]
        colors = np.empty((len(mesh.positions), 2, 8), np.uint8)
        columns.colors[key] = colors, color_bytes(*given, kept(bits), colors)
    elif key not in columns.colors:
        front, back = vertex_colors(mesh, vertex, None, None, profile)
        both = [*front, *back] if vertex.two_side else front
        colors = stacked_colors(len(mesh.positions), both, bits)
        columns.colors[key] = colors, is_constant(colors)
    return columns.colors[key]


def unrounded_colors(mesh, columns, vertex, profile):
    """The colours of ``given_colors`` before they become bytes, in MeshColumns' form."""
    key = vertex.two_side, vertex.secondary_color, _clamps_colors(profile)
    if key not in columns.unrounded:
        front, back = vertex_colors(mesh, vertex, None, None, profile)
        both = [*front, *back] if vertex.two_side else front
        columns.unrounded[key] = np.stack(np.broadcast_arrays(*both, np.zeros(1))[:-1], axis=1)
    return columns.unrounded[key]


def kept_color_bits(vertex, profile):
    """The number of mantissa bits that a colour keeps before it becomes a byte; None: it stays float64."""
    if profile.arithmetic.exact:
        return None
    exact = vertex.lighting is not None and profile.arithmetic.lighting == LightingArithmetic.EQUATIONS
    return SIGNIFICANT_BITS if exact else profile.arithmetic.color_mantissa_bits


def fragment_colors(colors, state, profile, bits):
    """Vertex colours, float64 [n, 2, 8], cut to the machine's mantissa and rounded to units of ``bits`` bits.

    Inferred: a mantissa grows with the width it is rounded to.
    """
    lighting = state.vertex.lighting
    exact = lighting is not None and profile.arithmetic.lighting == LightingArithmetic.EQUATIONS
    wider = max(bits - NATIVE_BITS, 0)
    kept_bits = SIGNIFICANT_BITS if exact else profile.arithmetic.color_mantissa_bits + wider
    limited = np.clip(np.nan_to_num(colors), -COLOR_REACH, COLOR_REACH)
    cut = keep_significant_bits(limited, min(kept_bits, SIGNIFICANT_BITS))
    return np.floor(cut * np.float64(2**bits - 1) + np.float64(0.5)).astype(np.int64)


def stacked_colors(count, columns, significant_bits):
    """Front and back colours [count, 2, 8] from 8 columns (both sides the same) or 16.

    ``significant_bits`` is the number of mantissa bits that a colour in [0, 1] keeps before it becomes a byte
    (section 2.13.9). None: the colours stay float64.
    """
    rows = filled_rows(count, columns)
    if significant_bits is None:
        result = np.empty((count, 2, 8))
        result[:, 0], result[:, 1] = rows[:8].T, rows[-8:].T
    else:
        result = np.empty((count, 2, 8), np.uint8)
        rounded_colors(rows, kept(significant_bits), result)
    return result


def color_byte(column, significant_bits):
    """Bytes of a column in [0, 1] that is first cut to this many significant bits (section 2.13.9)."""
    cut = keep_significant_bits(column, significant_bits)
    return np.floor(cut * np.float64(255.0) + np.float64(0.5))
