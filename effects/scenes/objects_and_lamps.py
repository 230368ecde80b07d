"""Scenes with a lamp for the shadow algorithms of documents 000 and 003: several objects on a floor.

World coordinates: y up, the floor at y = 0. Everything a camera sees is in world coordinates; there is no
modelling matrix.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import (
    look_at,
    orthographic,
    perspective,
    product,
    rotation,
    transform,
)
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.passes.arguments import checked_rgb, positive

# Maps clip coordinates [-1, 1] to texture coordinates and depths [0, 1] (document 003's matrix of halves).
HALVES = ((0.5, 0.0, 0.0, 0.5), (0.0, 0.5, 0.0, 0.5), (0.0, 0.0, 0.5, 0.5), (0.0, 0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class Object:
    """A surface in world coordinates and its material.

    ``color``: diffuse and ambient RGB; ``specular``: how strong its white highlight is, [0, 1]. ``closed``:
    whether the surface bounds a volume, so that it may be extruded to a shadow volume. ``two_sided``: whether
    its back faces are lit too, by their normals turned round (LIGHT_MODEL_TWO_SIDE). ``throws``: whether it
    throws shadows. An object that throws none, such as the distant ground, is in no shadow map, and no lamp
    encloses it.
    """

    name: str
    surface: Surface
    color: tuple[float, float, float]
    specular: float = 0.0
    closed: bool = True
    two_sided: bool = False
    throws: bool = True

    def __post_init__(self):
        checked_rgb(self.color, f"The colour of {self.name}")
        if not 0.0 <= self.specular <= 1.0:
            raise ValueError(
                f"The highlight of {self.name} is {self.specular!r}; give a strength from 0 to 1."
            )

    @cached_property
    def mesh(self):
        """The vertex arrays that every pass draws."""
        return self.surface.mesh()

    @property
    def triangles(self):
        """Float64 [n, 3 corners, 3]."""
        return self.surface.positions[self.surface.triangles]


@dataclass(frozen=True, eq=False)
class Scene:
    """The lit objects, and those of them that throw shadows."""

    objects: tuple[Object, ...]

    @property
    def throwing(self):
        """The objects that throw shadows, in their order."""
        return tuple(thing for thing in self.objects if thing.throws)

    def _some(self):
        if not self.objects:
            raise ValueError("The scene has no object; give it one or more.")
        return self.objects

    def triangles(self):
        """Float64 [n, 3 corners, 3] of all objects, in their order."""
        return np.concatenate([o.triangles for o in self._some()])

    def object_of_triangle(self):
        """Int64 [n]: the number of each triangle's object."""
        return np.repeat(np.arange(len(self.objects)), [len(o.surface.triangles) for o in self.objects])

    def bounds(self):
        """The least and the greatest coordinates of the objects that throw shadows, two float64 [3]."""
        positions = np.concatenate([o.surface.positions for o in Scene(self.throwing)._some()])
        return positions.min(axis=0), positions.max(axis=0)

    def corners(self):
        """The eight corners of the bounding box of the objects that throw shadows, float64 [8, 3]."""
        ends = np.stack(self.bounds())
        return np.array(
            [[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
        )


@dataclass(frozen=True)
class Lamp:
    """A light with a camera of its own: ``position`` looks at ``target``.

    ``field_of_view`` is that of its square frustum in degrees. An ``infinite`` light has parallel rays from
    the direction of ``position`` - ``target``. It has ``half_width`` instead, of its square box in world
    units. ``near``, ``far``: distances of the planes along the view.
    """

    position: tuple[float, float, float]
    target: tuple[float, float, float]
    near: float
    far: float
    field_of_view: float = 60.0
    infinite: bool = False
    half_width: float = 1.0

    def __post_init__(self):
        if self.infinite:
            positive(self.half_width, "Half the width of the lamp's box")
        else:
            positive(self.near, "The lamp's near plane")
            if not 0.0 < self.field_of_view < 180.0:
                raise ValueError(
                    f"The lamp's field of view is {self.field_of_view!r} degrees; give one between 0 and 180."
                )
        if not -math.inf < self.near < self.far < math.inf:
            raise ValueError(
                f"The lamp's planes are at {self.near} and {self.far}; the second is the farther."
            )

    @property
    def direction(self):
        """From the target to the lamp, not normalized."""
        return tuple(p - t for p, t in zip(self.position, self.target, strict=True))

    @property
    def homogeneous(self):
        """The light's position (x, y, z, 1), or, infinite, (x, y, z, 0)."""
        return (*self.direction, 0.0) if self.infinite else (*map(float, self.position), 1.0)

    @property
    def modelview(self):
        """V_l: from the world to the lamp's eye coordinates."""
        x, y, z = self.direction
        # Any direction that is not along the view serves as up: y, unless that is within half a degree.
        up = (0.0, 1.0, 0.0) if x * x + z * z > 1e-4 * y * y else (0.0, 0.0, -1.0)
        return look_at(self.position, self.target, up)

    @property
    def projection(self):
        """P_l: from the lamp's eye coordinates to its clip coordinates."""
        if self.infinite:
            w = self.half_width
            return orthographic(-w, w, -w, w, self.near, self.far)
        return perspective(self.field_of_view, 1.0, self.near, self.far)

    @property
    def texture_matrix(self):
        """B P_l V_l: world coordinates to (s, t, r, q) of the shadow map, rows of a 4x4 matrix."""
        return product(HALVES, self.projection, self.modelview)

    @property
    def depth_plane(self):
        """The plane (a, b, c, d) of world coordinates whose value is the light's linear depth: 0 at the near
        plane, 1 at the far one.
        """
        row, extent = self.modelview[2], self.far - self.near
        return (*(-v / extent for v in row[:3]), (-row[3] - self.near) / extent)

    def view(self, panel):
        """The scene seen from the lamp, on a panel."""
        eye = self.direction if self.infinite else self.position
        return View(panel, self.modelview, self.projection, tuple(map(float, eye)), self.infinite)


def lamp_around(scene, position, target=None, infinite=False, margin=1.02):
    """A lamp at ``position`` whose frustum encloses the scene's bounding box (document 003, first pass).

    ``target``: None, the box's centre. ``margin``: how much wider than the box, > 1. Raises ValueError if the
    lamp is too near to the box: a frustum encloses only objects in front of the lamp.
    """
    if not 1.0 < margin < math.inf:
        raise ValueError(f"The lamp's margin is {margin!r}; give how much wider than the box, above 1.")
    corners = scene.corners()
    target = tuple(map(float, corners.mean(axis=0) if target is None else target))
    position = tuple(map(float, position))
    modelview = Lamp(position, target, 1.0, 2.0, infinite=infinite).modelview
    eye = np.array([transform(modelview, (*corner, 1.0))[:3] for corner in corners.tolist()])
    depth = -eye[:, 2]
    extent = float(depth.max() - depth.min())
    if extent == 0.0:
        raise ValueError(
            f"The scene is flat, and the lamp at {position} looks straight at it; move it aside."
        )
    slack = (margin - 1.0) * extent
    near, far = float(depth.min()) - slack, float(depth.max()) + slack
    if infinite:
        return Lamp(
            position, target, near, far, infinite=True, half_width=margin * float(np.abs(eye[:, :2]).max())
        )
    if near <= 0.0:
        raise ValueError(
            f"The lamp at {position} is not in front of the whole scene; move it away, or give it a cube of "
            "six maps."
        )
    tangent = margin * float((np.abs(eye[:, :2]) / depth[:, None]).max())
    # Rounded up to a hundredth of a degree, so that it has the same bits everywhere.
    angle = math.ceil(math.degrees(2.0 * math.atan(tangent)) * 100.0) / 100.0
    return Lamp(position, target, near, far, field_of_view=angle)


def detail_of(size):
    """How many segments a round object has on a panel of ``size`` pixels; a multiple of 4."""
    return 12 if size < 64 else 24 if size < 200 else 40


FLOOR_HALF_WIDTH = 2.6


def floor(half_width, cells):
    """A square in y = 0 that faces up, ``cells`` by ``cells`` squares: lights per vertex need vertices."""
    half_width = positive(half_width, "Half the floor's width")
    return surfaces.plane(cells, cells, half_width, half_width).rotated(rotation("x", -90.0))
