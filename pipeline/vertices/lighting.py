"""OpenGL 1.2.1 lighting (section 2.13.1) on vertex columns, in the order of docs/numbers.md section 2."""

from dataclasses import dataclass
from decimal import Decimal, localcontext

import numpy as np

from fixedpipe.pipeline.enums import ColorMaterialParameter, Face
from fixedpipe.pipeline.vertices.arithmetic import (
    ONE,
    ZERO,
    Column,
    dot,
    length,
    normalize,
    positive,
    power,
    weighted_sum,
)

_PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")
_TRACKS = {
    ColorMaterialParameter.AMBIENT_AND_DIFFUSE: ("ambient", "diffuse"),
    ColorMaterialParameter.AMBIENT: ("ambient",),
    ColorMaterialParameter.DIFFUSE: ("diffuse",),
    ColorMaterialParameter.SPECULAR: ("specular",),
    ColorMaterialParameter.EMISSION: ("emission",),
}


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


@dataclass(frozen=True)
class _Illumination:
    """One light at every vertex: attenuation times spotlight factor, and the signed dot products."""

    strength: Column
    n_dot_l: Column
    n_dot_h: Column | None


@dataclass(frozen=True)
class _SurfaceMaterial:
    """A face's material as columns. ``specular_tracks``: the specular colour follows the vertex colour."""

    ambient: list
    diffuse: list
    specular: list
    emission: list
    shininess: float
    specular_tracks: bool


def light_vertices(lighting, eye, normal, color):
    """Light every vertex.

    - ``eye``: eye coordinates, 4 columns.
    - ``normal``: in eye coordinates, 3 columns; None without lights.
    - ``color``: the vertex colour, 4 columns.

    Returns two lists, front and back, of 8 columns each: red, green, blue and alpha of the primary colour,
    then of the secondary (its alpha is 0). They are not clamped. Without two-sided lighting both are the same
    list.
    """
    front = _surface_material(lighting, lighting.front, Face.FRONT, color)
    back = _surface_material(lighting, lighting.back, Face.BACK, color)
    materials = (front, back) if lighting.two_side else (front,)
    point = [component / eye[3] for component in eye[:3]]
    to_eye = normalize([-component for component in point]) if lighting.local_viewer else (ZERO, ZERO, ONE)
    illuminations = [
        _illuminate(light, point, normal, to_eye, any(_shines(light, material) for material in materials))
        for light in lighting.lights
    ]
    front_colors = _lit_colors(lighting, front, illuminations, 1)
    return front_colors, _lit_colors(lighting, back, illuminations, -1) if lighting.two_side else front_colors


def _surface_material(lighting, material, side, color):
    """Apply color material (section 2.13.3)."""
    tracking = lighting.color_material
    tracked = ()
    if tracking is not None and tracking.face in (side, Face.FRONT_AND_BACK):
        tracked = _TRACKS[tracking.parameter]
    colors = {
        name: color if name in tracked else [np.float64(value) for value in getattr(material, name)]
        for name in ("ambient", "diffuse", "specular", "emission")
    }
    return _SurfaceMaterial(**colors, shininess=material.shininess, specular_tracks="specular" in tracked)


def _shines(light, material):
    """Whether the light's specular term needs computing; it does not where the state alone makes it zero."""
    products = (m * s for m, s in zip(material.specular[:3], light.specular[:3], strict=True))
    return material.specular_tracks or any(product != 0 for product in products)


def _illuminate(light, point, normal, to_eye, shiny):
    """Direction, attenuation and spotlight of one light: equations 2.2 to 2.6."""
    position = [np.float64(component) for component in light.position]
    strength = ONE
    if position[3] == 0:
        direction = normalize(position[:3])
    else:
        difference = [position[axis] / position[3] - point[axis] for axis in range(3)]
        distance = length(difference)
        direction = normalize(difference, distance)
        constants = (light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation)
        strength = ONE / weighted_sum(constants, (ONE, distance, distance * distance))
    if light.spot_cutoff != 180:
        axis = normalize([np.float64(component) for component in light.spot_direction])
        cosine = -dot(direction, axis)
        # The test uses the signed cosine, so that a 90 degree cutoff is a half-space.
        lit = cosine >= cosine_of_degrees(light.spot_cutoff)
        strength = strength * np.where(lit, power(positive(cosine), light.spot_exponent), ZERO)
    n_dot_h = None
    if shiny:
        half = [a + b for a, b in zip(direction, to_eye, strict=True)]
        n_dot_h = dot(normal, normalize(half))
    return _Illumination(strength, dot(normal, direction), n_dot_h)


def _lit_colors(lighting, material, illuminations, sign):
    """The lighting equation for one face; sign -1 reverses the normal."""
    scene = [np.float64(value) for value in lighting.model_ambient]
    primary = [material.emission[c] + material.ambient[c] * scene[c] for c in range(3)]
    secondary = [ZERO, ZERO, ZERO]
    for light, illumination in zip(lighting.lights, illuminations, strict=True):
        diffuse = positive(sign * illumination.n_dot_l)
        specular = None
        if _shines(light, material):
            highlight = power(positive(sign * illumination.n_dot_h), material.shininess)
            specular = np.where(diffuse > 0, highlight, ZERO)
        for c in range(3):
            ambient_term = material.ambient[c] * np.float64(light.ambient[c])
            term = ambient_term + diffuse * (material.diffuse[c] * np.float64(light.diffuse[c]))
            if specular is not None:
                shine = specular * (material.specular[c] * np.float64(light.specular[c]))
                if lighting.separate_specular_color:
                    secondary[c] = secondary[c] + illumination.strength * shine
                else:
                    term = term + shine
            primary[c] = primary[c] + illumination.strength * term
    return [*primary, material.diffuse[3], *secondary, ZERO]
