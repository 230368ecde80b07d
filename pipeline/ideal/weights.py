"""Barycentric weights of fragments, and values iterated by them: in real numbers, and as the machines cut
them where only their bits decide between two texels.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fixedpipe.pipeline.enums import FrontFace
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.raster.columns.interpolate import edge_functions, iterate_coordinates, iteration_weights

_PIXEL = float(1 << IDEAL.arithmetic.subpixel_bits)  # in subpixels


@dataclass(frozen=True, eq=False)
class Weights:
    """Barycentric weights of fragments, from the exact edge functions of the snapped vertices.

    vertices       int64 [k, 3]
    front          bool [k], front-facing
    perspective    float64 [k, 3], (n_i / w_i) / sum: for every iterated value but window depth

    Properties that few states read are computed on first use.
    """

    vertices: np.ndarray
    front: np.ndarray
    perspective: np.ndarray
    _edges: np.ndarray  # n_i, float64 [k, 3]
    _area: np.ndarray  # twice the triangle's, signed, int64 [k]
    _sides: tuple  # x and y of vertex 1, then of vertex 2, from vertex 0: int64 [k] each
    _inverse_w: np.ndarray
    _z: np.ndarray

    @cached_property
    def affine(self):
        """n_i / A, float64 [k, 3]: for window depth."""
        return self._edges / np.abs(self._area)[:, None]

    @cached_property
    def dx(self):
        """The derivative of ``perspective`` per pixel to the right, float64 [k, 3]."""
        _, y10, _, y20 = self._sides
        return self._derivative(y10 - y20, y20, -y10)

    @cached_property
    def dy(self):
        """The derivative of ``perspective`` per pixel down, float64 [k, 3]."""
        x10, _, x20, _ = self._sides
        return self._derivative(x20 - x10, -x20, x10)

    def _derivative(self, *steps):
        # Steps of n over one pixel.
        step = _PIXEL * np.stack(steps, axis=1) * np.where(self._area < 0, -1, 1)[:, None]
        total = (self._edges * self._inverse_w).sum(axis=1, keepdims=True)
        de = step * self._inverse_w
        return (de - self.perspective * de.sum(axis=1, keepdims=True)) / total

    @cached_property
    def machine(self):
        """The machines' weights q0 and q2, float64 [k, 2], which decide at exact texel boundaries."""
        return np.stack(iteration_weights((self._edges * self._inverse_w).T), axis=1)

    @cached_property
    def depth_slope(self):
        """max(abs(dz/dx), abs(dz/dy)) of window depth per pixel, float64 [k]."""
        x10, y10, x20, y20 = self._sides
        z10, z20 = self._z[:, 1] - self._z[:, 0], self._z[:, 2] - self._z[:, 0]
        slope_x = (z10 * y20 - z20 * y10) * _PIXEL / self._area
        slope_y = (z20 * x10 - z10 * x20) * _PIXEL / self._area
        return np.maximum(np.abs(slope_x), np.abs(slope_y))


def weigh(primitives, front_face, triangle, x, y):
    """The Weights of the fragments (triangle, x, y), int [k] each, of ``primitives``.

    Source: docs/numbers.md, sections 3 to 5; derivatives by the quotient rule.
    """
    vertices = primitives.triangles[triangle, :3].astype(np.int64)
    corner_x, corner_y = primitives.x[vertices].astype(np.int64), primitives.y[vertices].astype(np.int64)
    x10, x20 = corner_x[:, 1] - corner_x[:, 0], corner_x[:, 2] - corner_x[:, 0]
    y10, y20 = corner_y[:, 1] - corner_y[:, 0], corner_y[:, 2] - corner_y[:, 0]
    edges, area = edge_functions(
        corner_x, corner_y, x.astype(np.int64), y.astype(np.int64), IDEAL.arithmetic.subpixel_bits
    )
    n = np.stack(edges, axis=1).astype(np.float64)

    inverse_w = primitives.inverse_w[vertices]
    equal = (inverse_w[:, 0] == inverse_w[:, 1]) & (inverse_w[:, 1] == inverse_w[:, 2])
    inverse_w = np.where(equal[:, None], 1.0, inverse_w)
    e = n * inverse_w
    front = (area < 0) == (front_face is FrontFace.CCW)
    perspective = e / e.sum(axis=1, keepdims=True)
    sides = x10, y10, x20, y20
    return Weights(vertices, front, perspective, n, area, sides, inverse_w, primitives.z[vertices])


def iterate(weights, values):
    """Values [k, 3, ...] at a triangle's vertices, weighted by ``weights`` [k, 3] that sum to one."""
    shape = (-1,) + (1,) * (values.ndim - 2)
    w0, w2 = weights[:, 0].reshape(shape), weights[:, 2].reshape(shape)
    total, other = values[:, 0] - values[:, 1], values[:, 2] - values[:, 1]
    total *= w0
    total += values[:, 1]
    other *= w2
    total += other
    return total


def iterate_as_machines(weights, corners):
    """s, t, r, q by docs/numbers.md, section 6, and the unit to which their terms are cut: float64 [k, 4]."""
    return iterate_coordinates(*weights.machine.T, corners)


def change_of(step, values):
    """A derivative of an iterated value: ``step`` [k, 3] sums to zero."""
    return step[:, :1] * (values[:, 0] - values[:, 1]) + step[:, 2:] * (values[:, 2] - values[:, 1])
