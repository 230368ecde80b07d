"""A lighting unit's registers for an OpenGL spotlight: the rule of docs/numbers.md N2.26.

The unit has no cutoff and no exponent. A driver computes its axis and three coefficients from them.

Source: nouveau, Mesa's driver of the NV10 and NV20 (src/mesa/drivers/dri/nouveau/nv10_state_tnl.c), whose
curves and constants are its author's; for exponent 0, Direct3D on the Xbox
(src/tests/lighting_spotlight_tests.cpp of nxdk_pgraph_tests).
"""

from math import sqrt

from fixedpipe.pipeline.state import Light, Spot
from fixedpipe.pipeline.vertices.arithmetic import normalize
from fixedpipe.pipeline.vertices.lighting import cosine_of_degrees

_SPREAD, _LAST_EXPONENT = 0.02, 1024.0  # of the curves: the spacing of their values, and their end
# Two curves over the exponent e, each by 15 values at equal steps of 1 - 1/(1 + _SPREAD e).
_B = (
    *(-3.80e-05, -1.77, -2.41, -2.71, -2.88, -2.98, -3.06, -3.11),
    *(-3.17, -3.23, -3.28, -3.37, -3.47, -3.83, -5.11),
)
_C = (-0.01, 1.77, 2.39, 2.70, 2.87, 2.98, 3.06, 3.10, 3.16, 3.23, 3.27, 3.37, 3.47, 3.83, 5.11)


def spot_of(light: Light) -> Spot | None:
    """The registers of a positional light on a lighting unit, or None for a light without a spot.

    They are the light's own ``spot``, or the ones that a driver computes, in float64, from its spot
    direction, cutoff (degrees, 0 to 90) and exponent (0 to 128).
    """
    if light.spot is not None or light.spot_cutoff == 180:
        return light.spot
    direction = [float(c) for c in normalize([*light.spot_direction])]
    exponent, cosine = light.spot_exponent, cosine_of_degrees(light.spot_cutoff)
    slope = 1 / (1 + 0.273 * exponent)
    b, c = _on_curve(_B, exponent), _on_curve(_C, exponent)
    if cosine == 1:  # a cone of width 0: lit where the cosine is 1
        return Spot((*(-d for d in direction), -1.0), (slope, b, c + slope))
    scale = max(0.9 + 0.278 * exponent, 1 / (1 - cosine))
    axis = (*(-scale * d for d in direction), 1 - scale)
    if exponent == 0:
        return Spot(axis, (0.0, 1.0, 0.0))  # x/x
    a = max(0.0, -1 - 5.36e-3 / sqrt(exponent) + slope * scale)
    return Spot(axis, (a, b, c + slope * scale))


def _on_curve(values, exponent):
    """The value of a curve at an exponent, by linear interpolation."""
    last = len(values) - 1
    place = last * (1 - 1 / (1 + _SPREAD * exponent)) / (1 - 1 / (1 + _SPREAD * _LAST_EXPONENT))
    before = int(place)
    return values[before] + (values[before + 1] - values[before]) * (place - before)
