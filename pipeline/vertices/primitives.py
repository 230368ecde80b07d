"""The vertex stage's results: triangles, lines and points in window coordinates."""

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
    # Usually one of the first vertices already differs.
    return all((some == words[:1]).all() for some in (words[:_FEW], words[_FEW:]))


@dataclass(frozen=True, eq=False)
class WindowPrimitives:
    """Primitives after transformation, lighting, clipping, projection, viewport and snapping.

    - ``x``, ``y``: int32 [n], device window coordinates, 1/16 pixel, y down from the framebuffer's top row.
    - ``z``: float64 [n], window depth, in [0, 1] unless a later stage clamps it. A vertex program's is in
      depth-buffer units.
    - ``inverse_w``: float64 [n], 1 / clip w. A vertex program's may be negative; all others are positive.
    - ``colors``: uint8 [n, 2, 8], front and back colour: red, green, blue, alpha of the primary colour, then
      of the secondary. If the profile is exact they are float64 and not clamped.
    - ``coordinates``: float64 [n, units, 4], s, t, r, q of each texture unit, after generation and matrix.
    - ``fog``: float64 [n], fog coordinate.
    - ``triangles``: int32 [k, 4], three vertices in the order of docs/numbers.md and the provoking vertex.
    - ``dropped``: the number of primitives dropped because a position was not finite after projection, or w
      was 0.
    - ``two_side``: whether back-facing triangles take the back colour.
    - ``strokes``: int32 [k, 8], or [0, 8] where all rows are triangles. For each row of ``triangles``: its
      kind (codes.PRIMITIVE_...); whether it takes the back colour; the three vertices of the polygon that it
      came from, or -1; of a line, the first pixel along its longer axis, the pixel after the last, and the
      line stipple's counter at the first.

    A line's row in ``triangles`` is its second vertex, then its first, twice. A point's row is three corners
    of its square: lower left, lower right, upper right.

    Several primitives may share an array, also with the kept data of a mesh: only read them.
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

    # These properties are computed at first use, unless ``knowing`` has set them.

    @cached_property
    def constant_color(self):
        """Whether all vertices have the same colours."""
        return is_constant(self.colors)

    @cached_property
    def projective(self):
        """For each texture unit, whether some vertex's q is not 1."""
        return tuple((self.coordinates[:, :, 3] != 1.0).any(axis=0).tolist())

    @property
    def orderly(self):
        """Whether a kernel can draw the primitives without writing outside its arrays.

        Every row names existing vertices, every 1/w is positive and in the usual range, and no two positions
        lie 2**31 or more apart. The result is not cached, because it guards against writes outside arrays.
        """
        if "known_orderly" in self.__dict__:
            return self.known_orderly
        named, w = self.triangles, self.inverse_w
        in_range = named.size == 0 or (named.min() >= 0 and named.max() < len(self.x))
        near = all(((column > -_FARTHEST) & (column < _FARTHEST)).all() for column in (self.x, self.y))
        return bool(in_range and near and ((w >= W_SMALLEST) & (w <= W_LARGEST)).all())

    @property
    def size(self):
        """Bytes of all columns."""
        columns = self.x, self.y, self.z, self.inverse_w, self.colors, self.coordinates, self.fog
        return sum([column.nbytes for column in (*columns, self.triangles, self.strokes)])

    def places(self):
        """Two digests of the places of all primitives' corners.

        The first covers depths, 1/w and the kinds of strokes. The second covers x and y, which also depend on
        the subpixel grid. Equal digests mean equal primitives in the same order.
        """
        corners = self.triangles[:, :3].ravel()
        kinds = self.strokes[:, KIND].copy()
        shapes = _digest(self.z[corners], self.inverse_w[corners], kinds)
        return shapes, _digest(self.x[corners], self.y[corners])

    def knowing(self, *, orderly, **known):
        """The same primitives, with ``orderly`` and these of ``constant_color`` and ``projective`` known."""
        self.__dict__.update(known, known_orderly=orderly)
        return self
