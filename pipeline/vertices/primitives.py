"""What the vertex stage hands to rasterization: triangles, lines and points in window coordinates."""

from dataclasses import dataclass, field
from functools import cached_property
from hashlib import blake2b

import numpy as np

from fixedpipe.raster.primitives.vertices import W_LARGEST, W_SMALLEST
from fixedpipe.raster.rows import KIND, STROKE_SIZE

_FARTHEST = 2**30
_FEW = 64  # vertices


def no_strokes():
    """The ``strokes`` of primitives that are all triangles."""
    return np.zeros((0, STROKE_SIZE), np.int32)


def _digest(*columns):
    found = blake2b(digest_size=8)
    for column in columns:
        found.update(column)
    return found.digest()


def is_constant(colors):
    """Whether all vertices have the same ``colors``."""
    words = colors.view(np.uint64)
    # Mostly one of the first already varies.
    return all((some == words[:1]).all() for some in (words[:_FEW], words[_FEW:]))


@dataclass(frozen=True, eq=False)
class WindowPrimitives:
    """Primitives after transformation, lighting, clipping, projection, viewport and snapping.

    x, y           int32 [n], device window coordinates, 1/16 pixel, y down from the framebuffer's top row
    z              float64 [n], window depth, in [0, 1] where nothing clamps it later; a vertex program's, in
                   depth-buffer units
    inverse_w      float64 [n], 1 / clip w; a vertex program's may be negative, all others are positive
    colors         uint8 [n, 2, 8]: front and back colour; red, green, blue, alpha of the primary colour, then
                   of the secondary; float64, not clamped, if the profile is exact
    coordinates    float64 [n, units, 4]: s, t, r, q of each texture unit, after generation and matrix
    fog            float64 [n]: fog coordinate
    triangles      int32 [k, 4]: three vertices in the order of docs/numbers.md and the provoking vertex
    dropped        primitives dropped because a position was not finite after projection, or w was 0
    two_side       whether back-facing triangles take the back colour
    strokes        int32 [k, 8], or [0, 8] where all are triangles: what each row of ``triangles`` is
                   (codes.PRIMITIVE_...), whether it takes the back colour, and the three
                   vertices of the polygon that it came from, -1 if none; of a line the first pixel along its
                   longer axis, the one behind the last, and the line stipple's counter at the first. A line's
                   row is its second vertex, then its first, twice. A point's row is three corners of its
                   square: lower left, lower right, upper right.

    Arrays may belong to several primitives, and to what is kept of a mesh: read them only.
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    inverse_w: np.ndarray
    colors: np.ndarray
    coordinates: np.ndarray
    fog: np.ndarray
    triangles: np.ndarray
    dropped: int
    two_side: bool
    strokes: np.ndarray = field(default_factory=no_strokes)

    # What follows from the columns is computed when it is asked for, unless ``knowing`` has said it.

    @cached_property
    def constant_color(self):
        """Whether all vertices have the same colours."""
        return is_constant(self.colors)

    @cached_property
    def projective(self):
        """For each texture unit whether some vertex's q is not 1."""
        return tuple((self.coordinates[:, :, 3] != 1.0).any(axis=0).tolist())

    @property
    def orderly(self):
        """Whether every row names vertices that exist, every 1/w is positive and ordinary, and no two
        positions lie 2**31 or more apart. Not remembered: what could be written outside its arrays asks.
        """
        if "known_orderly" in self.__dict__:
            return self.known_orderly
        named, w = self.triangles, self.inverse_w
        in_range = named.size == 0 or (named.min() >= 0 and named.max() < len(self.x))
        near = all(((column > -_FARTHEST) & (column < _FARTHEST)).all() for column in (self.x, self.y))
        return bool(in_range and near and ((w >= W_SMALLEST) & (w <= W_LARGEST)).all())

    def places(self):
        """Digests of where the corners of all primitives are: of depths, 1/w and what strokes are; and of x
        and y, which depend on the subpixel grid as well. Equal digests are equal primitives in one order.
        """
        corners = self.triangles[:, :3].ravel()
        kinds = self.strokes[:, KIND].copy()
        shapes = _digest(self.z[corners], self.inverse_w[corners], kinds)
        return shapes, _digest(self.x[corners], self.y[corners])

    def knowing(self, *, orderly, **known):
        """The same primitives, with ``orderly`` and these of ``constant_color`` and ``projective`` known."""
        self.__dict__.update(known, known_orderly=orderly)
        return self
