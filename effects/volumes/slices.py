"""A volume as a 3D texture of normals and densities, and the slices to draw through it.

Slices are parallel to the image plane, and lie only in bricks where the surface may be visible.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, LATER_PASS, REPLACE
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ComparisonFunction, WrapMode
from fixedpipe.pipeline.state import AlphaTest, PassState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import texture_3d

# Voxels along a brick's edge.  Measured: at 512 pixels with 256 slices bricks of 8, 16 and 32 voxels make 61,
# 69 and 95 million fragments, and those of 16 are drawn fastest.
BRICK = 16
_VOLUME = Sampler(EDGE.min_filter, EDGE.mag_filter, EDGE.wrap_s, EDGE.wrap_t, wrap_r=WrapMode.CLAMP_TO_EDGE)
# A box's corners, whose numbers have bits x, y and z, and its twelve edges.
CORNER_BITS = np.array([[k >> axis & 1 for axis in range(3)] for k in range(8)])
_EDGES = np.array([(a, a | bit) for bit in (1, 2, 4) for a in range(8) if not a & bit])


def stored_normals(density, spacing=(1.0, 1.0, 1.0), zero=127.5):
    """Unit vectors n to where a density falls, stored as ``zero`` + 127.5 n: uint8 [layers, rows, columns,
    3].

    ``density``: uint8 [layers, rows, columns]; it is zero outside. ``spacing``: of the voxels along x
    (columns), y and z. Differences are central. If all three are zero, n is zero, and 128 is stored.
    """
    out = np.full((*density.shape, 3), 128, np.uint8)
    padded = np.pad(density, 1).astype(np.int16)
    inside = slice(1, -1)
    for k, layer in enumerate(out):
        here = padded[k + 1]
        falls = [
            here[inside, :-2] - here[inside, 2:],
            here[:-2, inside] - here[2:, inside],
            (padded[k] - padded[k + 2])[inside, inside],
        ]
        where = np.nonzero((falls[0] != 0) | (falls[1] != 0) | (falls[2] != 0))
        vectors = [fall[where] / width for fall, width in zip(falls, spacing, strict=True)]
        normals = normalize(np.stack(vectors, axis=-1))
        layer[where] = np.minimum(np.floor(zero + 127.5 * normals + 0.5), 255.0)
    return out


@dataclass(frozen=True, eq=False)
class Volume:
    """Densities and the iso-surface that is drawn of them.

    name          the texture object's, too
    density       uint8 [layers, rows, columns], z, y and x from the lowest, so bottom row first
    half_extents  of the box that the voxels fill, centred at the origin, world units
    iso           density of the surface, (0, 1): voxels as dense or denser are solid
    """

    name: str
    density: np.ndarray
    half_extents: tuple[float, float, float]
    iso: float = 0.5
    _stored: dict = field(default_factory=dict, repr=False)

    def __post_init__(self):
        if self.density.ndim != 3 or self.density.dtype != np.uint8 or not self.density.size:
            raise ValueError(
                f"The densities are {self.density.dtype} of shape {self.density.shape}; give bytes "
                "[layers, rows, columns], some of each."
            )
        if not 0.0 < self.iso < 1.0:
            raise ValueError(f"The iso-surface's density is {self.iso}; give one between 0 and 1.")

    def corners(self):
        """The corners of the box round its bricks, float64 [8, 3], the bits of their numbers telling x, y and
        z. Raises ValueError where the iso-surface is nowhere.
        """
        bricks = self.seen_bricks()
        low, high = bricks.min(axis=0), bricks.max(axis=0)
        return self.brick_corners(np.where(CORNER_BITS, high + 1, low))

    def seen_bricks(self):
        """``bricks`` of the densities. Raises ValueError where the iso-surface is nowhere."""
        if not len(self._bricks):
            raise ValueError(
                f"No density of {self.name} reaches {self.iso:g}: it has no surface there; give less."
            )
        return self._bricks

    def brick_corners(self, numbers):
        """Where brick corners [..., 3] of these numbers lie, world coordinates."""
        grid, half = np.array(self.density.shape[::-1]), np.array(self.half_extents)
        return 2.0 * half * (np.minimum(numbers * BRICK, grid) / grid) - half

    @cached_property
    def _bricks(self):
        return bricks(self.density, math.ceil(255.0 * self.iso))

    def texture(self, zero):
        """The 3D texture, RGBA8: normals n as ``zero`` + 127.5 n in RGB, densities in alpha.

        The exact machine gets the same bytes, because a scanner's data has no more.
        """
        if zero not in self._stored:
            counts = reversed(self.density.shape)
            spacing = [h / n for h, n in zip(self.half_extents, counts, strict=True)]
            normals = stored_normals(self.density, spacing, zero)
            self._stored[zero] = texture_3d(np.concatenate([normals, self.density[..., None]], axis=-1))
        return self._stored[zero]


def bricks(density, iso, edge=BRICK):
    """The parts of a volume in which slices must be drawn: int64 [k, 3], x, y and z, counted in bricks.

    A brick has ``edge`` voxels along each axis. It is left out if nothing within a voxel of it is as dense as
    the byte ``iso``, or if everything within ``edge`` voxels of it is. No camera's nearest slice beyond the
    iso-surface lies there, if slices are less than ``edge`` voxels apart. Outside the volume density is zero.
    """
    counts = [-(-n // edge) for n in density.shape]
    padded = np.pad(
        density, [(1, edge * c - n + 1) for c, n in zip(counts, density.shape, strict=True)], mode="edge"
    )
    dense, hollow = np.zeros(counts, bool), np.zeros(counts, bool)
    for at in np.ndindex(*counts):
        part = padded[tuple(slice(edge * k, edge * k + edge + 2) for k in at)]
        dense[at], hollow[at] = part.max() >= iso, part.min() < iso
    around = np.pad(hollow, 1, constant_values=True)
    near = np.zeros_like(hollow)
    for dz, dy, dx in np.ndindex(3, 3, 3):
        near |= around[dz : dz + counts[0], dy : dy + counts[1], dx : dx + counts[2]]
    return np.argwhere(dense & near)[:, ::-1]


def slice_mesh(volume, view, count):
    """A volume cut by ``count`` planes parallel to the image, evenly spaced from the nearest to the farthest
    corner of its ``bricks``, in these alone, the nearest first: triangles with (s, t, r).

    The surface lies in front of the first plane beyond it, by half a step on average; so a polygon is drawn
    that much nearer to the eye than the place where it cuts the volume. Then the surface is as often too near
    as too far.

    Raises ValueError where the iso-surface is nowhere.
    """
    # Brick by brick: the twelve edges of each, by their ends' distances from the eye along the view.
    side, up, back, _ = view.modelview

    def eye_depth(points):
        return -(((points[..., 0] * back[0] + points[..., 1] * back[1]) + points[..., 2] * back[2]) + back[3])

    corners = volume.brick_corners(volume.seen_bricks()[:, None] + CORNER_BITS)
    depths = eye_depth(corners)
    least, step = float(depths.min()), (float(depths.max()) - float(depths.min())) / count
    # Plane k lies k + 1/2 steps behind the nearest corner.
    first = np.ceil((depths.min(axis=1) - least) / step - 0.5).astype(np.int64)
    last = np.floor((depths.max(axis=1) - least) / step - 0.5).astype(np.int64)
    first, last = np.maximum(first, 0), np.minimum(last, count - 1)
    number = np.maximum(last - first + 1, 0)
    brick = np.repeat(np.arange(len(number)), number)
    plane = np.arange(len(brick)) - np.repeat(np.cumsum(number) - number - first, number)
    order = np.argsort(plane, kind="stable")
    brick, distance = brick[order], (least + (plane[order] + 0.5) * step)[:, None]

    ends = [corners[brick][:, _EDGES[:, k]] for k in (0, 1)]
    near, far = (depths[brick][:, _EDGES[:, k]] for k in (0, 1))
    # Half open, so that a plane through a corner still cuts a closed polygon.
    cut = (near >= distance) != (far >= distance)
    along = np.where(cut, (distance - near) / np.where(cut, far - near, 1.0), 0.0)[..., None]
    points = ends[0] + along * (ends[1] - ends[0])
    corner_count = cut.sum(axis=1)
    kept = corner_count >= 3
    cut, points, corner_count = cut[kept], points[kept], corner_count[kept]
    # Round each polygon's middle, by a number that grows with the angle.
    total = np.zeros((len(points), 3))
    for k in range(len(_EDGES)):
        total = total + np.where(cut[:, k, None], points[:, k], 0.0)
    away = points - (total / corner_count[:, None])[:, None]
    x, y = (((away[..., 0] * row[0] + away[..., 1] * row[1]) + away[..., 2] * row[2]) for row in (side, up))
    size = np.abs(x) + np.abs(y)
    turn = x / np.where(size > 0.0, size, 1.0)
    order = np.argsort(np.where(cut, np.where(y < 0.0, turn - 1.0, 1.0 - turn), 9.0), axis=1, kind="stable")
    ordered = np.take_along_axis(points, order[..., None], axis=1)[:, :6]
    # A fan of as many triangles as there are corners after the first two.
    fan = ordered[:, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]]
    half = np.array(volume.half_extents)
    found = fan[np.arange(4) < corner_count[:, None] - 2].reshape(-1, 3)
    return Mesh(
        positions=_half_a_step_nearer(found, view, eye_depth(found)[:, None], 0.5 * step),
        texture_coordinates=((found + half) / (2.0 * half),),
    )


def _half_a_step_nearer(points, view, depths, distance):
    """Points moved along their rays to the eye by a ``distance`` of depth."""
    if view.infinite_viewer:
        return points + distance * np.array(view.modelview[2][:3])
    eye = np.array(view.eye)
    return eye + (points - eye) * ((depths - distance) / depths)


@dataclass(frozen=True, eq=False)
class Slices:
    """A volume's slices in one view, ``count`` of them."""

    volume: Volume
    view: View
    count: int

    @cached_property
    def mesh(self):
        """The polygons that every pass draws."""
        return slice_mesh(self.volume, self.view, self.count)

    @property
    def unit(self):
        """The texture unit that reads the volume."""
        return TextureUnit(self.volume.name, _VOLUME, environment=REPLACE)

    def solid(self, label, combiners=None, **settings):
        """P1: the nearest slice at each pixel whose density is the iso-surface's or more."""
        inside = AlphaTest(ComparisonFunction.GEQUAL, self.volume.iso)
        settings = {"alpha_test": inside, "depth_test": FIRST_PASS, **settings}
        return self.again(label, (self.unit,), combiners, **settings)

    def again(self, label, units, combiners=None, **settings):
        """The slices once more, with DF EQUAL."""
        state = PassState(
            vertex=self.view.vertex,
            texture_units=tuple(units),
            register_combiners=combiners,
            **{"depth_test": LATER_PASS, **settings},
        )
        return Draw(label=label, mesh=self.mesh, state=state)
