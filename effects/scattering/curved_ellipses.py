"""G20: five ellipses for every texel: one without curvature, and two for a little of either sign along each
axis.

Ellipses in between are interpolated, because the packed numbers are linear in the curvature.

An ellipse on a bent base is fitted to directions that have moved (``curved_base``). A direction that sees
nothing moves too, if it is next to one that sees a point, because that point borders it. So the fit follows
the rim. Where light is gathered, such directions stay (erratum E002.12); here that would lose most of the
change.

Differences are taken of the symmetric pair of forms (``ellipses.rooted``). It has no signs and no order of
axes that could change between two fits (erratum E002.7).

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 5; pass sequence A-G20.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.scattering import curved_base, ellipses
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering.curved_base import Base
from fixedpipe.effects.scattering.ellipses import Ellipses
from fixedpipe.effects.scattering.visibility import BACK, FREE, distances
from fixedpipe.effects.technique import Variant

TECHNIQUES = (Variant(("G20",), "from what is seen on the flat base, moved by the curvature"),)

# The curvatures for which ellipses are fitted, in 1 / period. Measured: a groove, 100 directions; a fit's
# radii go from one direction to the next, and at a tenth of one over the period that is as much as the bend.
STEP = 0.4


@dataclass(frozen=True, eq=False)
class FiveEllipses:
    """Ellipses of a height field for every small curvature.

    flat              without curvature
    along_u, along_v  for curvatures of +step and -step along either axis
    step              in 1 / edge of the field's square
    """

    flat: Ellipses
    along_u: tuple[Ellipses, Ellipses]
    along_v: tuple[Ellipses, Ellipses]
    step: float

    @property
    def stored_bytes(self) -> int:
        """Of all five."""
        return 5 * self.flat.stored_bytes

    def packed(self, kappa_u, kappa_v):
        """E1 and E2 at curvatures, numbers or [rows, columns]: two float64 [rows, columns, 3]."""
        return ellipses.curved(
            self.flat, self.along_u, self.along_v, self.step, kappa_u, kappa_v, ellipses.rooted
        )


def _with_neighbours(far, triangles):
    """Distances [n, rows, columns] where a direction that sees nothing has its nearest neighbour's."""
    beside = np.full(far.shape, np.inf)
    for triangle in triangles:
        beside[triangle] = np.minimum(beside[triangle], far[triangle].min(axis=0))
    return np.where(np.isinf(far), beside, far)


def ellipses_on(field, visibility, base):
    """The Ellipses of a HeightField with its Visibility on a Base.

    Raises ValueError where the heights reach the centre of curvature, and for directions that do not surround
    the origin.
    """
    triangles = sphere.triangulated(visibility.directions)
    curved_base.bent_normals(field, base)
    far = distances(field, visibility)
    moved = curved_base.moved(base, visibility.directions, _with_neighbours(far, triangles), field.heights)
    counted = (moved[..., 2] > 0.0) & (visibility.seen != BACK)
    return ellipses.fit(visibility.seen == FREE, moved[..., :2], counted)


def five_ellipses(field, visibility, step=STEP):
    """The FiveEllipses of a HeightField with its Visibility. Raises ValueError as ``ellipses_on``, and for a
    step that is not positive.
    """
    if not 0.0 < step < np.inf:
        raise ValueError(f"The step of curvature is {step!r}; give a positive number.")
    flat, more_u, less_u, more_v, less_v = (
        ellipses_on(field, visibility, Base(curvature))
        for curvature in ((0.0, 0.0), (step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step))
    )
    return FiveEllipses(flat, (more_u, less_u), (more_v, less_v), step)
