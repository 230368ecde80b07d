"""Z14, Z16: the viewer's frustum split into slices, with a shadow map for each.

Source: document 003, "sampling problems"; A-Z14/Z15/Z16 of the catalogue. Between near n and far f, slice i
of m ends at lambda n (f/n)^(i/m) + (1 - lambda) (n + (f - n) i/m). The first term keeps a texel's size on the
screen constant, the second the lengths of the slices. Assumed: lambda = 1/2 (the catalogue's; the document
gives none).

Two clip planes bound a slice in both of its passes, without the light and with it, so both have the same
vertices and depths. A triangle that two slices share is cut at the same points, and each pixel belongs to one
of its parts.
"""

import math
from itertools import pairwise

import numpy as np

from fixedpipe.effects.geometry.convex_bodies import clip_distances
from fixedpipe.effects.passes.arguments import positive
from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("Z14", "the viewer's frustum in slices, a shadow map for each", "Sampling problems"),)

LAMBDA = 0.5
# Distances are rounded to a multiple of this, as a power may differ in its last bit between libraries; where
# the near plane is nearer than one, to as small a part of the power of two below its distance.
_STEP = 2.0**-16


def split_distances(near, far, count, mixture=LAMBDA):
    """Where the slices of a frustum begin and end: count + 1 distances from the eye, near and far included.

    ``mixture``: 1: logarithmic, 0: all of one length.
    """
    near, far = positive(near, "The near plane"), positive(far, "The far plane")
    if not near < far:
        raise ValueError(f"The planes are at {near} and {far}; the second is the farther.")
    if not 1 <= count < math.inf or count != int(count):
        raise ValueError(f"The number of slices is {count!r}; give a whole number from 1.")
    if not 0.0 <= mixture <= 1.0:
        raise ValueError(f"The mixture is {mixture!r}; give 0 (slices of one length) to 1 (logarithmic).")
    inner, step = [], _STEP * min(1.0, 2.0 ** (math.frexp(near)[1] - 1))
    for i in range(1, int(count)):
        part = i / count
        value = mixture * near * math.pow(far / near, part) + (1.0 - mixture) * (near + (far - near) * part)
        inner.append(math.floor(value / step + 0.5) * step)
    distances = (near, *inner, far)
    if not all(a < b for a, b in pairwise(distances)):
        raise ValueError(f"{count} slices from {near} to {far} are too thin to tell apart; give fewer.")
    return distances


def slice_planes(distances, number):
    """The clip planes of slice ``number`` (from 0), eye coordinates: those between it and its neighbours.

    The first slice has none before it and the last none behind it: the camera's own planes clip there.
    """
    if not 0 <= number < len(distances) - 1:
        raise ValueError(f"Slice {number} does not exist; there are {len(distances) - 1}, from 0.")
    near = () if number == 0 else ((0.0, 0.0, -1.0, -distances[number]),)
    far = () if number == len(distances) - 2 else ((0.0, 0.0, 1.0, distances[number + 1]),)
    return (*near, *far)


def view_slices(view, count, mixture=LAMBDA):
    """``split_distances`` of a perspective camera's planes."""
    return split_distances(*clip_distances(view), count, mixture)


def slice_of(distances, depth):
    """The number of the slice that holds each depth, int64 as ``depth``: before the first is the first."""
    return np.clip(np.searchsorted(np.array(distances[1:-1]), depth, side="right"), 0, len(distances) - 2)
