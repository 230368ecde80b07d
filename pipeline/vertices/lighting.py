"""OpenGL 1.2.1 lighting (section 2.13.1): a state's numbers, and the kernels that light vertices by them."""

from decimal import Decimal, localcontext
from itertools import chain

import numpy as np

from fixedpipe.pipeline.enums import ColorMaterialParameter, Face
from fixedpipe.pipeline.vertices.arithmetic import ONE, invert_upper_left, length, normalize
from fixedpipe.raster.primitives import lighting as G
from fixedpipe.raster.primitives.lighting_columns import CHUNK

_PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")
_TRACKS = {
    ColorMaterialParameter.AMBIENT_AND_DIFFUSE: ("ambient", "diffuse"),
    ColorMaterialParameter.AMBIENT: ("ambient",),
    ColorMaterialParameter.DIFFUSE: ("diffuse",),
    ColorMaterialParameter.SPECULAR: ("specular",),
    ColorMaterialParameter.EMISSION: ("emission",),
}
_COLORS = ("ambient", "diffuse", "specular", "emission")


def cosine_of_degrees(angle):
    """Cosine of an angle of 0 to 90 degrees as the nearest float64, the same on every machine.

    Taylor's series with 60 decimal digits, rounded to 40 places (so that the cosine of 90 degrees is 0).
    """
    with localcontext() as context:
        context.prec = 60
        x = Decimal(angle) * _PI / 180
        term = total = Decimal(1)
        n = 0
        while abs(term) > Decimal("1e-50"):
            n += 2
            term = -term * x * x / (n * (n - 1))
            total += term
        return float(round(total, 40))


def eye_normals(vertex, count, normals, weights):
    """Normals in eye coordinates (section 2.10.3), float64 [3, n]; with two modelview matrices,
    EXT_vertex_weighting's.

    - ``vertex``: VertexState.
    - ``count``: the number of vertices.
    - ``normals``, ``weights``: of a mesh, as kernels take arrays (``arrays_of``).

    Raises ValueError if float64 cannot hold a modelview matrix's determinant.
    """
    matrices, flags = _kept(_normal_numbers, vertex)
    out = np.empty((3, count))
    G.eye_normals(normals, weights, flags, matrices, np.empty((G.NORMAL_ROWS, CHUNK)), out)
    return out


def _normal_numbers(vertex):
    """``matrices`` and ``flags`` of ``fixedpipe.raster.primitives.lighting.eye_normals``."""
    matrices = []
    for matrix in vertex.modelviews:
        inverse = invert_upper_left(matrix)
        matrices.append([*inverse[0], *inverse[1], *inverse[2], ONE / length(inverse[2])])
    return np.array(matrices), np.array([vertex.normalize, vertex.rescale_normal], np.int64)


def light_vertices(vertex, eye, normal, colors, *, clamped):
    """Colours of all vertices, float64 [8 or 16, n]: colour and secondary colour, of the front or both sides.

    - ``vertex``: VertexState.
    - ``eye``: eye coordinates, float64 [4, n].
    - ``normal``: in eye coordinates, float64 [3, n]; of any size without lights.
    - ``colors``: of a mesh, as kernels take arrays.
    - ``clamped``: colours are limited to [0, 1], and NaN becomes 0.

    There are 16 rows with two-sided lighting. The secondary colour's alpha is 0.
    """
    flags, numbers = _kept(_pack, vertex, clamped)
    out = np.empty((8 * int(flags[0, G.SIDES]), eye.shape[1]))
    G.light_vertices((eye, normal, colors), flags, numbers, np.empty((G.ROWS, CHUNK)), out)
    return out


_states = {}  # by a function, the identity of a VertexState and what else is given: the result, and the state
_STATES_KEPT = 1024


def _kept(function, vertex, *more):
    """What a function makes of a VertexState, from a cache."""
    key = function, id(vertex), *more
    found = _states.get(key)
    if found is None:
        with np.errstate(all="ignore"):
            made = function(vertex, *more)
        if len(_states) >= _STATES_KEPT:
            _states.clear()
        found = _states[key] = made, vertex
    return found[0]


def _pack(vertex, clamped):
    """``flags`` and ``numbers`` of ``fixedpipe.raster.primitives.lighting.light_vertices``."""
    lighting = vertex.lighting
    rows = G.FIRST_LIGHT + len(lighting.lights)
    flags, numbers = np.zeros((rows, G.FLAGS), np.int64), np.zeros((rows, G.NUMBERS))
    flags[0] = lighting.local_viewer, lighting.separate_specular_color, clamped, 1 + lighting.two_side
    for at, side in enumerate((Face.FRONT, Face.BACK), G.FIRST_SIDE):
        material = lighting.front if side == Face.FRONT else lighting.back
        tracking = lighting.color_material
        if tracking is not None and tracking.face in (side, Face.FRONT_AND_BACK):
            flags[at] = [name in _TRACKS[tracking.parameter] for name in _COLORS]
        colors = chain.from_iterable(getattr(material, name) for name in _COLORS)
        numbers[at] = *colors, material.shininess, *lighting.model_ambient[:3]
    for at, light in enumerate(lighting.lights, G.FIRST_LIGHT):
        flags[at, : G.SPOT + 1] = light.position[3] != 0, light.spot_cutoff != 180
        numbers[at] = _light_numbers(light)
    return flags, numbers


def _light_numbers(light):
    position = [np.float64(component) for component in light.position]
    if position[3] == 0:
        place = normalize(position[:3])
    else:
        place = [position[axis] / position[3] for axis in range(3)]
    axis, cutoff = (0.0, 0.0, 0.0), 0.0
    if light.spot_cutoff != 180:
        axis = normalize([np.float64(component) for component in light.spot_direction])
        # The test uses the signed cosine, so that a 90 degree cutoff is a half-space.
        cutoff = cosine_of_degrees(light.spot_cutoff)
    attenuation = light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation
    colors = *light.ambient[:3], *light.diffuse[:3], *light.specular[:3]
    return *place, *attenuation, *axis, cutoff, light.spot_exponent, *colors
