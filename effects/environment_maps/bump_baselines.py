"""S10 and S20: the method before roughness pyramids, and a ray tracer's picture of one.

S10 is Becker and Max's method (1993), as the paper describes it. Near by, it uses the bumps of level 0. Far
away it uses a BRDF, here the normal distribution of all the map's offsets, which filters the environment.
Between two levels of the footprint it blends both. One blend serves one width of bumps. A map with bumps of
many widths is split into bands, each with its own blend; with octaves as bands this is the roughness pyramid.
Their redistribution of bumps by visibility is left out. It belongs to displaced geometry, and bump maps have
none.

S20 is the mean of what normals n' + D xi see, with xi normally distributed. The xi are the same for every
pixel: rings of equal shares, turned against each other.

Source: Schilling 1997, sections 5 and 8; pass sequence A-S20 of the catalogue. Inferred: the blend's levels.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.environment_maps import rough_mirrors
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.geometry.vectors import TRIGONOMETRY_STEP, cosine, sine
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("S10", "a change from bump map to BRDF, with a blend between", "5"),
    Technique("S20", "the ellipse of roughness in a ray tracer: several normals a pixel", "8"),
)

# Turns from one xi to the next: the golden section of one.
_GOLDEN = 0.38196601125010515


def normal_points(count):
    """Points xi of a normal distribution in the plane, deviation one: float64 [count, 2].

    The k-th lies on the circle that holds (k + 1/2)/count of it. Raises ValueError for fewer than one.
    """
    if count < 1:
        raise ValueError(f"{count} normals a pixel are asked for; give one or more.")
    number = np.arange(count)
    radius = np.sqrt(-2.0 * np.log(1.0 - (number + 0.5) / count))
    radius = np.floor(radius / TRIGONOMETRY_STEP + 0.5) * TRIGONOMETRY_STEP
    angle = 2.0 * np.pi * (number * _GOLDEN % 1.0)
    return np.stack([radius * cosine(angle), radius * sine(angle)], axis=-1)


@computed_once
def traced(view, mirror, levels, cube_levels, count=64, probes=1):
    """S20: a plane that mirrors an environment with ``count`` normals a pixel: float64 [height, width, 3].

    Each normal reads the environment at the level for the pixel's curvature. Other arguments:
    ``rough_mirrors.picture``.
    """
    beam = rough_mirrors.beams(view, mirror, levels, Antialiasing.ANISOTROPIC, probes)
    smooth = replace(beam, covariance=np.zeros_like(beam.covariance))
    sigma, _ = rough_mirrors.spread(smooth, cube_levels[0].shape[1])
    level = rough_mirrors.environment_probes(sigma, 1)[3]
    d_1, d_2, d_3 = np.moveaxis(rough.deviations(beam.covariance), -1, 0)
    out = np.zeros(beam.toward.shape)
    for x, y in normal_points(count):
        f = beam.offsets + np.stack([d_1 * x + d_2 * y, d_3 * y], axis=-1)
        toward = rough_mirrors.mirrored(beam.incoming, f, mirror.frame)[0]
        toward = np.where(beam.hits[..., None], toward, beam.incoming)
        out += rough_mirrors.probe(cube_levels, toward, level)
    return out / count


@computed_once
def switched(view, mirror, levels, cube_levels, first=1.0, last=4.0):
    """S10: bumps of level 0 where a pixel's footprint on the map is at level ``first`` or below, a BRDF of
    the whole map from ``last`` on, a blend between: float64 [height, width, 3].

    Raises ValueError if ``last`` is not above ``first``.
    """
    if not last > first:
        raise ValueError(f"Bumps end at level {first:g} and the BRDF begins at {last:g}; give a higher one.")
    bumps = rough_mirrors.picture(view, mirror, levels, cube_levels, Antialiasing.NONE)
    whole = levels[-1]
    flat = rough.pyramid(whole.offsets, whole.covariance)
    lobe = rough_mirrors.picture(view, mirror, flat, cube_levels, Antialiasing.ANISOTROPIC)
    level = rough_mirrors.beams(view, mirror, levels, Antialiasing.NONE).level
    part = np.clip((level - first) / (last - first), 0.0, 1.0)[..., None]
    return bumps + part * (lobe - bumps)
