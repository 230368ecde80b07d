"""G17, the earlier method: horizon maps.

Every texel stores the height of its horizon at eight azimuths. A light that stands higher arrives; the height
is interpolated between two azimuths.

The horizon is exact on the field's triangles (``height_field``). Along an azimuth the field is linear between
the lines where triangles meet. So the tangent of the elevation has its maximum on one of these lines. The
search follows them until nothing farther could stand higher. A horizon that is level or lower counts as
level.

A byte stores the sine of the elevation, which is z of a light direction of length one. Eight bytes a texel
are two RGBA textures, or eight of one component. A machine reads the two next to the light's azimuth:

    horizon = (1 - w) H_k + w H_k+1,   lit where l_z - horizon > 0

The first combiner interpolates, the second subtracts, and the alpha test marks as for ellipses.

Source: Max 1988; Heidrich, Daubert, Kautz, Seidel 2000, section 2; Heidrich 2001, section 3.1; pass sequences
A-G17 and A-H46. Assumed: sines; the angle is interpolated evenly in azimuth.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    ONE,
    PRIMARY,
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    blue_of,
    final,
    negated,
    product,
    program,
    signed,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import MARK, REPEATED, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering.directions import finite
from fixedpipe.effects.scattering.ellipse_passes import NO_COLOR, POSITIVE_ALPHA
from fixedpipe.effects.scattering.visibility import MOST_TILES, crossed
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("G17", "horizon maps: the height of the horizon in eight azimuths", "2"),
    Technique("H46", "horizon maps: the height of the horizon in some azimuths", "3.1"),
)

# Source: Max 1988, as section 2 has it.
AZIMUTHS = 8


@kernel("void(float64[:, ::1], float64, float64[:, ::1], float64[:, :, ::1])")
def _tangents(heights, highest, azimuths, out):
    """The greatest (field - z0) / t, at least zero, along azimuths (x, y) of length one, t in edges."""
    rows, columns = heights.shape
    most = MOST_TILES * 3 * (rows + columns)
    infinity = np.inf
    for k in range(len(azimuths)):
        dx, dy = azimuths[k, 0] * columns, azimuths[k, 1] * rows
        # The line crosses the columns' lines, the rows' and the diagonals' at whole multiples of these.
        step_x = 1.0 / abs(dx) if dx != 0.0 else infinity
        step_y = 1.0 / abs(dy) if dy != 0.0 else infinity
        step_d = 1.0 / abs(dx - dy) if dx != dy else infinity
        # Along an axis or a diagonal of the square the field repeats: what is farther stands lower.
        period = infinity
        if dx == 0.0 or dy == 0.0:
            period = 1.0
        elif abs(azimuths[k, 0]) == abs(azimuths[k, 1]):
            period = 1.0 / abs(azimuths[k, 0])
        for row in range(rows):
            for column in range(columns):
                z0 = heights[row, column]
                next_x, next_y, next_d = 1, 1, 1
                best = 0.0
                while next_x + next_y + next_d < most:
                    t_x, t_y, t_d = next_x * step_x, next_y * step_y, next_d * step_d
                    t = min(t_x, min(t_y, t_d))
                    # Nothing from here on stands higher.
                    if highest - z0 <= best * t or t > period:
                        break
                    lines, numbers = (t_x, t_y, t_d), (next_x, next_y, next_d)
                    _, _, field = crossed(heights, column, row, dx, dy, t, lines, numbers)
                    best = max(best, (field - z0) / t)
                    if t == t_x:
                        next_x += 1
                    if t == t_y:
                        next_y += 1
                    if t == t_d:
                        next_d += 1
                out[k, row, column] = best


def azimuths(count=AZIMUTHS):
    """Directions (x, y) of length one, evenly round from +x: float64 [count, 2]."""
    angle = 2.0 * math.pi * np.arange(count) / count
    return normalize(np.stack([cosine(angle), sine(angle), 0.0 * angle], axis=-1))[:, :2]


@dataclass(frozen=True, eq=False)
class HorizonMap:
    """The height of every texel's horizon.

    tangents  float64 [azimuths, rows, columns]: of the elevation, at least 0, at azimuths evenly round from
              +x
    """

    tangents: NDArray[np.float64]

    @property
    def sines(self) -> NDArray[np.float64]:
        """The z of a direction of length one that points at the horizon: float64 [azimuths, rows,
        columns].
        """
        return self.tangents / np.sqrt(1.0 + self.tangents * self.tangents)

    @property
    def stored_bytes(self) -> int:
        """A byte for each azimuth and texel."""
        return self.tangents.size


def horizon_map(field, count=AZIMUTHS):
    """The HorizonMap of a HeightField. Raises ValueError for fewer than three azimuths."""
    if not count >= 3 or int(count) != count:
        raise ValueError(
            f"A horizon map of {count} azimuths has none between; give three or more, a whole number."
        )
    out = np.empty((count, *field.heights.shape))
    _tangents(field.heights, float(field.heights.max()), np.ascontiguousarray(azimuths(count)), out)
    return HorizonMap(out)


def neighbours(light, count=AZIMUTHS):
    """The two azimuths next to a light's, and how far it is from the first to the second, 0 to 1: (int, int,
    float). A light straight above has any. Raises ValueError for a light that is no direction.
    """
    light = finite(light, "The light's direction")
    x, y = float(light[0]), float(light[1])
    place = math.atan2(y, x) / (2.0 * math.pi) * count
    # Arc tangents differ in their last bit between processors.
    place = math.floor(place * 2.0**20 + 0.5) / 2.0**20 % count
    first = int(place) % count
    return first, (first + 1) % count, place - int(place)


def lit(sines, light):
    """Where the light stands above the horizon, bool [rows, columns].

    ``sines``: the HorizonMap's, or read back from bytes; ``light``: a unit vector [3].
    """
    first, second, share = neighbours(light, len(sines))
    return light[2] - (sines[first] * (1.0 - share) + sines[second] * share) > 0.0


# ------------------------------------------------------------------------------------ on register combiners


def load(horizons, profile, name="horizon"):
    """The commands that load a texture of sines for each azimuth."""
    return tuple(
        TexImage(
            label=f"load the {name} at azimuth {k}",
            texture=f"{name}: {k}",
            image=texture_2d(factor_texels(sines, profile)[..., None], InternalFormat.LUMINANCE8),
        )
        for k, sines in enumerate(horizons.sines)
    )


def marking_pass(surface, horizons, view, light, *, name="horizon", sampler=REPEATED, **settings):
    """The draw that marks where a light, a unit vector [3] in the surface's frame, stands above the horizon.

    surface   its frames are one for all of it: the light's azimuth chooses two textures for the draw
    settings  more of PassState
    """
    first, second, share = neighbours(light, len(horizons.tangents))
    height = float(light[2])
    combiners = program(
        stage(total(product(TEXTURE0, CONSTANT0), product(TEXTURE1, CONSTANT1), to=SPARE0)),
        stage(
            alpha=total(
                product(blue_of(PRIMARY), ONE), product(blue_of(negated(signed(SPARE0))), ONE), to=SPARE0
            )
        ),
        final(SPARE0, alpha=SPARE0),
        constant0=(1.0 - share,) * 3,
        constant1=(share,) * 3,
    )
    mesh = surface.mesh(colors=np.full((len(surface.positions), 3), height))
    units = tuple(unit(f"{name}: {k}", sampler) for k in (first, second))
    settings = {"color_mask": NO_COLOR, "stencil_test": MARK, "alpha_test": POSITIVE_ALPHA} | settings
    return draw("mark where l stands above the horizon", mesh, view, combiners, units, **settings)
