"""Rectangles of pixels: which pixels a zoomed group covers, and texture coordinates made of groups.

Source: OpenGL 1.2.1 section 3.6.4; SGIX_pixel_texture; SGIX_impact_pixel_texture. docs/numbers.md has the
rules. NumPy only, int64 columns.
"""

import numpy as np

from fixedpipe.raster import codes as C


def covered(origin, zoom, count, low, high):
    """Pixels along an axis and the group that each belongs to, int64 [k], of ``count`` groups from window
    coordinate ``origin`` on, ``zoom`` pixels each; only pixels from ``low`` on and before ``high``.

    Pixel p has its centre at p + 1/2; group n has those from the lower of its edges ``origin + zoom n`` and
    ``origin + zoom (n + 1)`` on, before the upper.
    """
    with np.errstate(over="ignore"):
        edges = origin + zoom * np.arange(count + 1, dtype=np.float64)
    first = np.clip(np.ceil(edges - 0.5), low, max(low, high)).astype(np.int64)
    groups, counts = np.arange(count), np.diff(first)
    if zoom < 0:
        first, groups, counts = first[::-1], groups[::-1], -counts[::-1]
    return np.arange(first[0], first[-1]), np.repeat(groups, counts)


def quotients(groups, one):
    """(s, t, r, q) float64 [k, 4] of groups int64 [k, 4], and how many had no positive q.

    s, t and r are R/A, G/A and B/A, and q is 1; where A is 0 or less, A counts as ``one``.
    """
    alpha = groups[:, 3]
    undefined = int((alpha <= 0).sum())
    coordinates = np.ones((len(groups), 4))
    divisor = np.where(alpha <= 0, one, alpha)[:, None] if undefined else alpha[:, None]
    np.divide(groups[:, :3], divisor, out=coordinates[:, :3])
    return coordinates, undefined


def fractions(groups, one):
    """(s, t, r, 1) float64 [k, 4]: R, G, B over ``one``, where q chooses a volume."""
    coordinates = np.ones((len(groups), 4))
    np.divide(groups[:, :3], one, out=coordinates[:, :3])
    return coordinates


def chosen_volumes(alpha, one, volumes, q_filter):
    """The volume, int64 [k], that q = A / ``one`` chooses of a four-dimensional texture: with Q = q times
    their number ``floor(Q)``, or ``floor(Q - 1/2)``, ``ceil(Q - 1/2)``, clamped.
    """
    doubled = 2 * alpha * volumes - one  # 2 one (Q - 1/2)
    if q_filter == C.TEX_GEN_Q_ROUND:
        found = alpha * volumes // one
    elif q_filter == C.TEX_GEN_Q_FLOOR:
        found = doubled // (2 * one)
    elif q_filter == C.TEX_GEN_Q_CEILING:
        found = -(-doubled // (2 * one))
    else:
        raise ValueError(f"{q_filter!r} chooses no volume.")
    return np.clip(found, 0, volumes - 1)


def alpha_bytes(alpha, one, least):
    """Eight of a group's twelve bits of alpha, the least significant or the most: int64 [k]."""
    twelve = (2 * 4095 * alpha + one) // (2 * one)
    return twelve & 255 if least else twelve >> 4
