"""What the texels of a height field on a curved base truly see: rays cast anew for every curvature.

The rays meet the bent triangles. They are the reference for ``curved_base``, which reuses the visibility of
the flat base.
"""

import numpy as np

from fixedpipe.effects.acceptance.ray_caster import RayCaster
from fixedpipe.effects.geometry.vectors import dot, from_frame
from fixedpipe.effects.scattering.curved_base import Bent, bent_normals, bent_surface
from fixedpipe.effects.scattering.directions import triangulated
from fixedpipe.effects.scattering.visibility import BACK, FREE

# Rays leave this far above the surface, in edges of the field's square, so that they do not meet their own
# triangles. Assumed: a thousandth of the texels of any field that is asked.
_LIFT = 2.0**-20


class BentCaster:
    """A HeightField on a Base as triangles: the tile whose texels look, and some tiles around it.

    field, base  as for ``curved_base``
    tiles        how many to either side, along s and t
    """

    def __init__(self, field, base, tiles=(1, 1)):
        self.field, self.base = field, base
        columns, rows = (
            (-count * texels, (count + 1) * texels)
            for count, texels in zip(tiles, (field.columns, field.rows), strict=True)
        )
        self.surface = bent_surface(field, base, columns, rows)
        self.caster = RayCaster(self.surface.positions[self.surface.triangles])
        self.normals = bent_normals(field, base)
        i, j = np.meshgrid(np.arange(field.columns), np.arange(field.rows))
        x, y = (i + 0.5) / field.columns - 0.5, (j + 0.5) / field.rows - 0.5
        self.frames = base.frames(x, y)
        positions = base.placed(np.stack([x, y, field.heights], axis=-1))
        self.origins = positions + _LIFT * from_frame(self.normals, *self.frames)

    def seen(self, directions):
        """The texel seen along directions [n, 3] or [n, rows, columns, 3] in the texels' frames, as
        ``Visibility.seen`` has it: int32 [n, rows, columns].
        """
        shape = self.field.heights.shape
        directions = np.asarray(directions, np.float64)
        if directions.ndim == 2:
            directions = np.broadcast_to(directions[:, None, None], (len(directions), *shape, 3))
        out = np.full((len(directions), *shape), BACK, np.int32)
        facing = dot(directions, self.normals) > 0.0
        rays = from_frame(directions, *self.frames)[facing]
        hits = self.caster.nearest(np.broadcast_to(self.origins, directions.shape)[facing], rays)
        corners = self.surface.triangles[hits.triangle]
        at = (self.surface.texture_coordinates[corners] * hits.barycentrics[..., None]).sum(axis=1)
        rows, columns = shape
        column = np.floor(at[:, 0] * columns).astype(np.int64) % columns
        row = np.floor(at[:, 1] * rows).astype(np.int64) % rows
        out[facing] = np.where(hits.triangle < 0, FREE, row * columns + column)
        return out

    def bent(self, directions):
        """The same along even directions [n, 3] as a Bent, which counts each of them alike."""
        shape = len(directions), *self.field.heights.shape
        seen = self.seen(directions)
        return Bent(
            self.base,
            np.broadcast_to(directions[:, None, None], (*shape, 3)),
            np.ones(shape),
            self.normals,
            triangulated(directions),
            directions,
            seen,
            np.where(seen == BACK, 0.0, np.inf),
        )

    def lit(self, light):
        """Which texels a distant light reaches: float64 [rows, columns], 0 or 1. ``light``: unit vector [3]
        or [rows, columns, 3] in the texels' frames.
        """
        light = np.broadcast_to(light, (*self.field.heights.shape, 3))
        return np.where(self.seen(light[None])[0] == FREE, 1.0, 0.0)
