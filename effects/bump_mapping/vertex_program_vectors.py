"""H44: l and h in tangent space from a vertex program; ``vertex_vectors`` computes them on the host.

The program has registers of four single-precision numbers. Its inputs are the position in v[OPOS], the normal
in v[NRML], the tangent and the binormal's sign in v[TEX1], the light in c[4], and the eye in c[5]. c[4].w and
c[5].w are 1 for a place and 0 for a direction:

    MUL R0, v[NRML].zxyw, v[TEX1].yzxw;                 the binormal, sign times n x t
    MAD R0, v[NRML].yzxw, v[TEX1].zxyw, -R0;
    MUL R0, R0, v[TEX1].w;
    MAD R1, -v[OPOS], c[4].w, c[4];                     l and v, of length one
    DP3 R1.w, R1, R1;  RSQ R1.w, R1.w;  MUL R1.xyz, R1, R1.w;
    MAD R2, -v[OPOS], c[5].w, c[5];
    DP3 R2.w, R2, R2;  RSQ R2.w, R2.w;  MUL R2.xyz, R2, R2.w;
    ADD R2, R1, R2;                                     h
    DP3 R2.w, R2, R2;  RSQ R2.w, R2.w;  MUL R2.xyz, R2, R2.w;
    DP3 R3.x, v[TEX1], R1;  DP3 R3.y, R0, R1;  DP3 R3.z, v[NRML], R1;
    DP3 R4.x, v[TEX1], R2;  DP3 R4.y, R0, R2;  DP3 R4.z, v[NRML], R2;

Then one instruction each writes R3 and R4 to o[TEX1]; for o[COL0], they are multiplied by one half and one
half is added. The fixed function computes the position (the option NV_position_invariant of version 1.1), so
the passes' depths are equal.

Source: Lindholm, Kilgard, Moreton 2001; NV_vertex_program, section 2.14.1; pass sequence A-H44. Assumed: each
instruction's result is the nearest single-precision number, which chips approach (docs/numbers.md, section
2); DP3 adds from the left.
"""

import numpy as np

from fixedpipe.effects.geometry.vectors import cross, dot
from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("H44", "bump mapping's l and h, computed by a vertex program", "3"),)

# Of the program above, with the two that write its results and none for the position.
INSTRUCTIONS = 23


def _single(values):
    return np.asarray(values, np.float64).astype(np.float32)


def _dp3(a, b):
    return (a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1]) + a[:, 2] * b[:, 2]


def _unit(vectors):
    """DP3, RSQ, MUL."""
    squares = _dp3(vectors, vectors).astype(np.float64)
    root = _single(1.0 / np.sqrt(np.where(squares > 0.0, squares, 1.0)))
    return vectors * root[:, None]


def _cross(a, b):
    """MUL and MAD, each rounded."""
    return a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]]


def _towards(positions, place, is_place):
    """MAD: a place less the positions, or a direction as it is."""
    place = np.broadcast_to(_single(place), positions.shape)
    return place - positions if is_place else place


def light_and_half_vectors(surface, view, light):
    """(l, h) at the vertices in their frames, of length one up to rounding: float64 [n, 3] each. Every number
    is a single-precision one.

    surface  a ``Surface``; only the signs of its binormals are used, and the program computes the binormals
    """
    positions, normals, tangents = map(_single, (surface.positions, surface.normals, surface.tangents))
    turned = dot(cross(surface.normals, surface.tangents), surface.binormals) < 0.0
    binormals = _cross(normals, tangents) * _single(np.where(turned, -1.0, 1.0))[:, None]
    to_light = _unit(_towards(positions, light.vector, light.point))
    half = _unit(to_light + _unit(_towards(positions, view.eye, not view.infinite_viewer)))
    axes = tangents, binormals, normals
    return tuple(
        np.stack([_dp3(axis, vectors) for axis in axes], axis=-1).astype(np.float64)
        for vectors in (to_light, half)
    )
