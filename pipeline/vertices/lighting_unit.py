"""The NV10's lighting unit, which the NV20 family keeps (docs/numbers.md, section 2).

It computes OpenGL's lighting in floats of 14 significant bits, with rational functions in place of powers.

Source: envytools' model of the unit (nvhw/pgraph_celsius_xfrm.c: pgraph_celsius_lt_full). Measured: the
spotlight, which that model lacks, and the NV2A's own features (Lighting_*, Specular captures).
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.enums import ColorMaterialParameter, ColorSource, Face, SecondaryColor
from fixedpipe.pipeline.state import ColorSources
from fixedpipe.pipeline.vertices.arithmetic import (
    ONE,
    ZERO,
    Column,
    invert_upper_left,
    normalize,
    positive,
    power,
)
from fixedpipe.pipeline.vertices.chip_floats import (
    LIGHTING_BITS,
    TRANSFORM_BITS,
    add_product,
    lighting_reciprocal,
    multiply_add,
    product,
    single,
    to_lighting,
    total,
    transform_dot,
    transform_inverse_root,
    transform_reciprocal,
)
from fixedpipe.pipeline.vertices.spot_registers import spot_of
from fixedpipe.pipeline.vertices.weighting import transform_eye, transform_weighted

_TRACKED = {
    ColorMaterialParameter.AMBIENT_AND_DIFFUSE: ("ambient", "diffuse"),
    ColorMaterialParameter.AMBIENT: ("ambient",),
    ColorMaterialParameter.DIFFUSE: ("diffuse",),
    ColorMaterialParameter.SPECULAR: ("specular",),
    ColorMaterialParameter.EMISSION: ("emission",),
}
_COLORS = ("ambient", "diffuse", "specular")


# ---------------------------------------------------------------------- arithmetic of 14 significant bits


def _times(a, b):
    return product(a, b, LIGHTING_BITS)


def _plus(*terms):
    return total(terms, LIGHTING_BITS)


def _plus_scalar(a, b):
    """A sum in the unit's scalar half, which keeps no guard bits."""
    return total((a, b), LIGHTING_BITS, 0)


def _multiply_add(a, b, c):
    return multiply_add(a, b, c, LIGHTING_BITS)


def _add_product(a, b, c):
    return add_product(a, b, c, LIGHTING_BITS)


def _dot(a, b):
    return _plus(*(_times(x, y) for x, y in zip(a, b, strict=True)))


def _register(values):
    """Numbers in the precision of the unit's registers."""
    return [to_lighting(single(np.float64(value))) for value in values]


# ----------------------------------------------------------------------------------------------- geometry


@dataclass(frozen=True)
class _Geometry:
    """What the lighting unit gets from the transform unit.

    - ``normal``, ``viewer``: the normal and the unit vector to the viewer, 3 columns each, in 14 bits.
    - ``point``: the vertex's eye coordinates, in 24 bits.
    """

    normal: list
    viewer: list
    point: list


def unit_vector(v):
    """The unit vector of a vector of 24-bit columns, its length, and the square of its length."""
    square = transform_dot(v, v)
    root = transform_inverse_root(square)
    return [product(c, root, TRANSFORM_BITS) for c in v], product(square, root, TRANSFORM_BITS), square


def _difference(a, b):
    return [total((x, -y), TRANSFORM_BITS) for x, y in zip(a, b, strict=True)]


def _normal_by(matrix, vertex, given):
    """A normal transformed by the inverse of a modelview matrix, and rescaled if the state asks for it."""
    inverse = invert_upper_left(matrix)
    columns = [[single(inverse[row][j]) for row in range(3)] for j in range(3)]
    normal = [transform_dot(given, column) for column in columns]
    if vertex.rescale_normal:
        third = [single(value) for value in inverse[2]]
        square = transform_dot(third, third)
        normal = [product(c, transform_inverse_root(square), TRANSFORM_BITS) for c in normal]
    return normal


def _geometry(lighting, vertex, position, normal, weight):
    normal = [single(c) for c in normal]
    eye = transform_eye(vertex, position, weight)
    normals = [_normal_by(matrix, vertex, normal) for matrix in vertex.modelviews]
    normal = transform_weighted(normals, weight)
    if vertex.normalize:
        normal, _, _ = unit_vector(normal)
    reciprocal = transform_reciprocal(eye[3])
    point = [product(c, reciprocal, TRANSFORM_BITS) for c in eye[:3]]
    viewer = _register(lighting.viewer_direction)
    if lighting.local_viewer:
        viewer = [to_lighting(c) for c in unit_vector(_difference((ZERO, ZERO, ZERO), point))[0]]
    return _Geometry([to_lighting(c) for c in normal], viewer, point)


# ------------------------------------------------------------------------------------------------- lights


@dataclass(frozen=True)
class _Strengths:
    """The factors of one light's ambient, diffuse and specular colour at a vertex."""

    ambient: Column
    diffuse: Column
    specular: Column


def _strengths(light, material, lighting, geometry, normal):
    strength, dark = ONE, np.False_
    if light.position[3] == 0:
        vector = [np.float64(c) for c in light.position[:3]]
        direction = _register(normalize(vector) if light.half_vector is None else vector)
    else:
        position = [single(np.float64(c) / np.float64(light.position[3])) for c in light.position[:3]]
        vector, distance, square = unit_vector(_difference(position, geometry.point))
        direction = [to_lighting(c) for c in vector]
        distance, square = to_lighting(distance), to_lighting(square)
        factors = (light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation)
        strength = lighting_reciprocal(_dot((ONE, distance, square), _register(factors)))
        if light.range is not None:
            dark = _plus_scalar(-distance, *_register((light.range,))) < 0
        spot = spot_of(light)
        if spot is not None:
            strength, outside = _spot(spot, vector, strength)
            dark = dark | outside
        strength = np.where(dark, ZERO, strength)
    facing = _dot(normal, direction)
    dark = dark | (facing < 0)
    diffuse = _times(strength, np.where(dark, ZERO, facing))
    above, reciprocal, unlit = _highlight(light, material, lighting, geometry, normal, direction)
    unlit = dark | unlit
    specular = _times(strength, np.where(unlit, ZERO, above))
    if reciprocal is not None:
        specular = _times(specular, np.where(unlit, ONE, reciprocal))
    return _Strengths(strength, diffuse, specular)


def _spot(spot, vector, strength):
    """Attenuation times the cone's factor, and where no light falls: no positive factor, or a negative x.

    Measured: the factor's reciprocal comes last (Lighting_spotlight captures). Inferred: a negative x gives
    no light, because a driver's cone would not end there otherwise (docs/numbers.md N2.26).
    """
    x = transform_dot((*vector, ONE), [single(np.float64(c)) for c in spot.axis])
    x = np.minimum(to_lighting(x), ONE)
    a, b, c = _register(spot.coefficients)
    above = _plus_scalar(x, a)
    below = _multiply_add(b, x, c)
    return _times(_times(strength, above), lighting_reciprocal(below)), (above <= 0) | (x < 0)


def _highlight(light, material, lighting, geometry, normal, direction):
    """The specular factor's numerator, its denominator's reciprocal or None, and where it is zero."""
    coefficients = material.specular_coefficients
    if light.position[3] == 0 and not lighting.local_viewer:
        half = light.half_vector
        if half is None:
            towards = normalize([np.float64(c) for c in light.position[:3]])
            viewer = [np.float64(c) for c in lighting.viewer_direction]
            half = normalize([c + e for c, e in zip(towards, viewer, strict=True)])
        x = _dot(normal, _register(half))
        if coefficients is None:
            return to_lighting(single(power(positive(x), material.shininess))), None, x < 0
        a, b, c = _register(coefficients[:3])
        above = _plus_scalar(x, a)
        return above, lighting_reciprocal(_multiply_add(x, b, c)), above < 0
    half = [_plus(e, d) for e, d in zip(geometry.viewer, direction, strict=True)]
    square, x = _dot(half, half), _dot(normal, half)
    xx = _times(x, x)
    if coefficients is None:
        cosine = positive(x) / np.sqrt(np.where(square == 0, ONE, square))
        return to_lighting(single(power(cosine, material.shininess))), None, x < 0
    a, b, c = _register(coefficients[3:])
    above = _multiply_add(square, a, xx)
    below = _multiply_add(square, c, _times(xx, b))
    return above, lighting_reciprocal(below), (x < 0) | (above < 0)


# ------------------------------------------------------------------------------------------------ colours


def sources_of(lighting, side):
    """The sources of a face's material colours: the unit's own setting, or color material's."""
    given = lighting.front_sources if side == Face.FRONT else lighting.back_sources
    if given is not None:
        return given
    tracking = lighting.color_material
    if tracking is None or tracking.face not in (side, Face.FRONT_AND_BACK):
        return ColorSources()
    return ColorSources(**dict.fromkeys(_TRACKED[tracking.parameter], ColorSource.PRIMARY))


def _light_color(light, name, side, material):
    """The register of a light's colour, multiplied by the material's colour unless ``material`` is None."""
    back = getattr(light, f"back_{name}") if side == Face.BACK else None
    given = [np.float64(value) for value in (getattr(light, name) if back is None else back)[:3]]
    if material is not None:
        own = [np.float64(value) for value in getattr(material, name)[:3]]
        given = [a * b for a, b in zip(given, own, strict=True)]
    return _register(given)


def _start(lighting, material, side, sources, vertex_colors):
    """The primary colour before any light: emission plus ambient times the scene's.

    The unit has two registers for this, and multiplies the second by a vertex colour. Where its own setting
    takes emission from the vertices, it multiplies that too (Measured: Material_color_source, 15 of 15
    captures). Color material's driver has 1 in that register.
    """
    scene = lighting.model_ambient
    if side == Face.BACK and lighting.back_model_ambient is not None:
        scene = lighting.back_model_ambient
    emission, ambient = vertex_colors[sources.emission], vertex_colors[sources.ambient]
    if ambient is None:
        lit = [np.float64(material.ambient[c]) * np.float64(scene[c]) for c in range(3)]
        if emission is None:
            return _register(np.float64(material.emission[c]) + lit[c] for c in range(3))
        if (lighting.front_sources if side == Face.FRONT else lighting.back_sources) is not None:
            factors = _register(material.emission[:3])
            return [_add_product(e, f, r) for e, f, r in zip(emission, factors, _register(lit), strict=True)]
        return [_plus(r, e) for r, e in zip(_register(lit), emission, strict=True)]
    emission = _register(material.emission[:3]) if emission is None else emission
    return [_add_product(a, s, e) for e, a, s in zip(emission, ambient, _register(scene[:3]), strict=True)]


def _face(lighting, side, geometry, color, secondary, folded):
    material = lighting.front if side == Face.FRONT else lighting.back
    sources = sources_of(lighting, side)
    given = ([to_lighting(single(c)) for c in columns[:3]] for columns in (color, secondary))
    vertex_colors = (None, *given)  # by ColorSource
    sign = ONE if side == Face.FRONT else -ONE
    primary = _start(lighting, material, side, sources, vertex_colors)
    shine = [ZERO, ZERO, ZERO]
    for light in lighting.lights:
        normal = [sign * c for c in geometry.normal]
        strengths = _strengths(light, material, lighting, geometry, normal)
        for name in _COLORS:
            follows = vertex_colors[getattr(sources, name)]
            register = _light_color(light, name, side, material if follows is None else None)
            for c in range(3):
                factors = getattr(strengths, name), register[c]
                if follows is not None:
                    factors = _times(*factors), follows[c]
                sums = shine if name == "specular" and not folded else primary
                sums[c] = _add_product(*factors, sums[c])
    alphas = (to_lighting(single(np.float64(material.diffuse[3]))), color[3], secondary[3])
    return [*primary, alphas[sources.diffuse]], shine


def light_vertices(vertex, position, normal, color, secondary, weight=ONE):
    """Light every vertex.

    - ``vertex``: VertexState.
    - ``position``, ``normal``: object coordinates, 4 and 3 columns.
    - ``color``, ``secondary``: of the vertex, 4 columns each.
    - ``weight``: a column (EXT_vertex_weighting).

    Returns two lists, front and back, of 8 columns each: primary and secondary colour. They are not clamped;
    NaN (infinity minus infinity) becomes 1. Without two-sided lighting both are the same list.

    Raises ValueError where there are lights and float64 cannot hold a modelview matrix's determinant.
    """
    lighting = vertex.lighting
    geometry = _geometry(lighting, vertex, position, normal, weight) if lighting.lights else None
    folded = not lighting.separate_specular_color or vertex.secondary_color == SecondaryColor.DISABLED
    results = []
    for side in (Face.FRONT, Face.BACK) if lighting.two_side else (Face.FRONT,):
        primary, shine = _face(lighting, side, geometry, color, secondary, folded)
        given = shine if lighting.separate_specular_color else secondary[:3]
        colors = [*primary, *given, secondary[3]]
        results.append([np.where(np.isnan(column), ONE, column) for column in colors])
    return results[0], results[-1]


def secondary_output(colors, output):
    """The eight colour columns with the secondary colour that ``output`` selects."""
    if output == SecondaryColor.FROM_VERTEX:
        return colors
    if output == SecondaryColor.OPAQUE:
        return [*colors[:7], ONE]
    if output == SecondaryColor.DISABLED:
        return [*colors[:4], ZERO, ZERO, ZERO, ONE]
    raise ValueError(f"{output!r} is no secondary colour.")
