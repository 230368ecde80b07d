"""An environment as a few directional lights: its texels in groups of about equal power, a light for each.

The method is a median cut. In each step, the group with the most power is cut across its longest extent, so
that half of its power lies on each side. It ends with as many groups as lights. A group's light comes from
the mean of its directions, weighted by power, with all of the group's irradiance. So a surface that faces the
light receives what the texels would give it, up to their spread.

The module uses sorting, additions in a fixed order, products and quotients alone, so its bits are the same on
every computer.

Source: Ward Larson, Shakespeare 1998 and Debevec 2005 for lights in place of an environment; Heckbert 1982
for the median cut. Assumed: the cut divides a set of directions in space, not a picture, because a set has no
poles.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.vectors import normalize

# Of a colour's power: the luminance of the time's monitors. Source: ITU-R BT.709.
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Lights:
    """Directional lights.

    directions  float64 [n, 3], of length one, towards the lights
    irradiance  float64 [n, 3]: RGB on a surface that faces each, over pi: a white Lambert surface that faces
                it sends this back
    """

    directions: np.ndarray
    irradiance: np.ndarray


def _total(values):
    """The sum along the first axis, one after the other."""
    return np.cumsum(values, axis=0)[-1]


def lights_of(cube, count):
    """The Lights of a cube map, float64 [6, n, n, 3] of radiance from 0 on.

    ``count``: how many, from 1; fewer come out where fewer texels shine. The sum of their irradiance equals
    the map's power, up to rounding. Raises ValueError for a cube map that is none, radiance below zero, a map
    that is black, and a count that is none.
    """
    cube = cube_maps.checked(cube, "The environment")
    if count < 1:
        raise ValueError(f"{count} lights are asked for; give 1 or more.")
    if (cube < 0.0).any():
        raise ValueError("The environment has radiance below zero; give numbers from 0 on.")
    angle = np.broadcast_to(cube_maps.solid_angles(cube.shape[1]), cube.shape[:3]).ravel()
    colors = cube.reshape(-1, 3) * angle[:, None] / np.pi
    toward = cube_maps.directions(cube.shape[1]).reshape(-1, 3)
    power = (colors[:, 0] * _LUMINANCE[0] + colors[:, 1] * _LUMINANCE[1]) + colors[:, 2] * _LUMINANCE[2]
    shining = np.flatnonzero(power > 0.0)
    if not len(shining):
        raise ValueError("The environment is black; give one that shines somewhere.")
    groups = [shining]
    while len(groups) < count:
        # Of the groups that can be parted, the strongest; the first of equal ones.
        strength = [float(_total(power[g])) if len(g) > 1 else -1.0 for g in groups]
        strongest = int(np.argmax(strength))
        if strength[strongest] < 0.0:
            break
        group = groups.pop(strongest)
        extent = toward[group].max(axis=0) - toward[group].min(axis=0)
        order = group[np.argsort(toward[group, int(np.argmax(extent))], kind="stable")]
        sums = np.cumsum(power[order])
        half = int(np.searchsorted(sums, 0.5 * sums[-1]))
        cut = min(max(half, 1), len(order) - 1)
        groups += [order[:cut], order[cut:]]
    directions, irradiance = [], []
    for group in groups:
        mean = _total(toward[group] * power[group, None])
        # Directions that cancel each other have no mean; the strongest texel's is taken.
        far = (
            float(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2])
            <= 1e-12 * float(_total(power[group])) ** 2
        )
        directions.append(toward[group[int(np.argmax(power[group]))]] if far else mean)
        irradiance.append(_total(colors[group]))
    return Lights(normalize(np.array(directions)), np.array(irradiance))
