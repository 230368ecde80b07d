"""The NV10's lighting unit, which the NV20 family keeps (docs/numbers.md, section 2).

It computes OpenGL's lighting in floats of 14 significant bits, with rational functions in place of powers.

Source: envytools' model of the unit (nvhw/pgraph_celsius_xfrm.c: pgraph_celsius_lt_full). Measured: the
spotlight, which that model lacks, and the NV2A's own features (Lighting_*, Specular captures).
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.enums import ColorMaterialParameter, ColorSource, Face, SecondaryColor
from fixedpipe.pipeline.state import ColorSources
from fixedpipe.pipeline.vertices.arithmetic import ONE, ZERO, invert_upper_left, normalize
from fixedpipe.pipeline.vertices.chip_floats import (
    TRANSFORM_BITS,
    product,
    single,
    to_lighting,
    transform_dot,
    transform_inverse_root,
)
from fixedpipe.pipeline.vertices.spot_registers import spot_of
from fixedpipe.raster.primitives import lighting_unit as U
from fixedpipe.raster.primitives.lighting_columns import CHUNK

_TRACKED = {
    ColorMaterialParameter.AMBIENT_AND_DIFFUSE: ("ambient", "diffuse"),
    ColorMaterialParameter.AMBIENT: ("ambient",),
    ColorMaterialParameter.DIFFUSE: ("diffuse",),
    ColorMaterialParameter.SPECULAR: ("specular",),
    ColorMaterialParameter.EMISSION: ("emission",),
}
_COLORS = ("ambient", "diffuse", "specular")


def unit_vector(v):
    """The unit vector of a vector of 24-bit columns, its length, and the square of its length."""
    square = transform_dot(v, v)
    root = transform_inverse_root(square)
    return [product(c, root, TRANSFORM_BITS) for c in v], product(square, root, TRANSFORM_BITS), square


# ---------------------------------------------------------------------------------------- a state's numbers


def _light_color(light, name, side, material):
    """A light's colour, multiplied by the material's colour unless ``material`` is None."""
    back = getattr(light, f"back_{name}") if side == Face.BACK else None
    given = (getattr(light, name) if back is None else back)[:3]
    if material is None:
        return given
    return [float(a) * float(b) for a, b in zip(given, getattr(material, name)[:3], strict=True)]


def _start(lighting, material, side, sources):
    """(START, FACTOR, ADDEND), SCALE and CONSTANTS of the primary colour before any light.

    It is emission plus ambient times the scene's. The unit has two registers for this, and multiplies the
    second by a vertex colour. Where its own setting takes emission from the vertices, it multiplies that too
    (Measured: Material_color_source, 15 of 15 captures). Color material's driver has 1 in that register.
    """
    scene = lighting.model_ambient
    if side == Face.BACK and lighting.back_model_ambient is not None:
        scene = lighting.back_model_ambient
    if sources.ambient != ColorSource.MATERIAL:
        return (U.PRODUCT, sources.ambient, sources.emission), scene[:3], material.emission[:3]
    lit = [float(material.ambient[c]) * float(scene[c]) for c in range(3)]
    if sources.emission == ColorSource.MATERIAL:
        return (U.CONSTANT, 0, 0), (0.0,) * 3, [float(material.emission[c]) + lit[c] for c in range(3)]
    if (lighting.front_sources if side == Face.FRONT else lighting.back_sources) is not None:
        return (U.PRODUCT, sources.emission, 0), material.emission[:3], lit
    return (U.SUM, 0, sources.emission), lit, (0.0,) * 3


def sources_of(lighting, side):
    """The sources of a face's material colours: the unit's own setting, or color material's."""
    given = lighting.front_sources if side == Face.FRONT else lighting.back_sources
    if given is not None:
        return given
    tracking = lighting.color_material
    if tracking is None or tracking.face not in (side, Face.FRONT_AND_BACK):
        return ColorSources()
    return ColorSources(**dict.fromkeys(_TRACKED[tracking.parameter], ColorSource.PRIMARY))


@dataclass(frozen=True, eq=False, slots=True)
class _Packed:
    """A state's numbers as ``fixedpipe.raster.primitives.lighting_unit.light_vertices`` takes them.

    ``sides``: 2 with two-sided lighting, else 1.
    """

    flags: np.ndarray
    numbers: np.ndarray
    sides: int


def _pack(vertex, clamped):
    """The _Packed of a VertexState; ``clamped``: colours are limited to [0, 1]."""
    lighting = vertex.lighting
    sides = (Face.FRONT, Face.BACK) if lighting.two_side else (Face.FRONT,)
    rows = U.FIRST_LIGHT + len(lighting.lights)
    flags, numbers = np.zeros((rows, U.FLAGS), np.int64), np.zeros((rows, U.NUMBERS))
    flags[0] = (
        len(vertex.modelviews), vertex.normalize, vertex.rescale_normal, lighting.local_viewer, len(sides),
        not lighting.separate_specular_color or vertex.secondary_color == SecondaryColor.DISABLED,
        lighting.separate_specular_color, vertex.secondary_color, clamped,
    )  # fmt: skip
    numbers[0, U.VIEWER : U.VIEWER + 3] = lighting.viewer_direction
    for at, side in enumerate(sides, U.FIRST_SIDE):
        _pack_side(lighting, side, flags[at], numbers[at])
    for at, light in enumerate(lighting.lights, U.FIRST_LIGHT):
        _pack_light(lighting, light, sides, flags[at], numbers[at])
    given = single(numbers)
    numbers = to_lighting(given)
    for at, light in enumerate(lighting.lights, U.FIRST_LIGHT):
        if light.position[3] != 0:
            numbers[at, : U.ATTENUATION] = given[at, : U.ATTENUATION]  # the place and the axis: 24 bits
    for at, side in enumerate(sides, U.FIRST_SIDE):
        numbers[at, U.SHININESS] = (lighting.front if side == Face.FRONT else lighting.back).shininess
    if lighting.lights:
        for at, matrix in enumerate(vertex.modelviews):
            numbers[at, : U.VIEWER] = _matrix_numbers(matrix)
    return _Packed(flags, numbers, len(sides))


def _matrix_numbers(matrix):
    """A matrix, its inverse's columns, and the factor that rescales its normals."""
    inverse = single(np.array(invert_upper_left(matrix)))
    root = transform_inverse_root(transform_dot(inverse[2], inverse[2]))
    return [*single(np.array(matrix)).reshape(-1), *inverse.T.reshape(-1), float(root)]


def _pack_side(lighting, side, flags, numbers):
    material = lighting.front if side == Face.FRONT else lighting.back
    sources = sources_of(lighting, side)
    start, scale, constants = _start(lighting, material, side, sources)
    rational = material.specular_coefficients
    flags[: U.COEFFICIENTS + 1] = (
        *start, sources.ambient, sources.diffuse, sources.specular, rational is not None,
    )  # fmt: skip
    numbers[: U.RATIONAL + 6] = (*scale, *constants, material.diffuse[3], 0.0, *(rational or (0.0,) * 6))


def _pack_light(lighting, light, sides, flags, numbers):
    flags[U.POSITIONAL] = light.position[3] != 0
    if light.position[3] == 0:
        vector = [np.float64(c) for c in light.position[:3]]
        half = light.half_vector
        if half is None:
            vector = normalize(vector)
            viewer = [np.float64(c) for c in lighting.viewer_direction]
            half = normalize([c + e for c, e in zip(vector, viewer, strict=True)])
        numbers[U.PLACE : U.PLACE + 3] = vector
        numbers[U.HALF_VECTOR : U.HALF_VECTOR + 3] = half
    else:
        w = np.float64(light.position[3])
        numbers[U.PLACE : U.PLACE + 3] = [np.float64(c) / w for c in light.position[:3]]
        numbers[U.ATTENUATION : U.ATTENUATION + 3] = (
            light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation,
        )  # fmt: skip
        if light.range is not None:
            flags[U.RANGE], numbers[U.REACH] = 1, light.range
        spot = spot_of(light)
        if spot is not None:
            flags[U.SPOT] = 1
            numbers[U.AXIS : U.AXIS + 4], numbers[U.CONE : U.CONE + 3] = spot.axis, spot.coefficients
    for at, side in enumerate(sides):
        material, sources = (
            lighting.front if side == Face.FRONT else lighting.back,
            sources_of(lighting, side),
        )
        for k, name in enumerate(_COLORS):
            own = material if getattr(sources, name) == ColorSource.MATERIAL else None
            first = U.COLORS + 9 * at + 3 * k
            numbers[first : first + 3] = _light_color(light, name, side, own)


# ------------------------------------------------------------------------------------------------ vertices

_packed = {}  # by the identity of a VertexState, and whether colours are clamped: the _Packed, and the state
_PACKED_KEPT = 1024


def light_vertices(vertex, mesh, *, clamped):
    """Colours of all vertices, float64 [8 or 16, n]: colour and secondary colour, of the front or both sides.

    - ``vertex``: VertexState.
    - ``mesh``: Mesh. Its positions, normals, colours, secondary colours and weights are read.
    - ``clamped``: colours are limited to [0, 1]. NaN (infinity minus infinity) is 1 before.

    There are 16 rows with two-sided lighting. The secondary colour is the one that the state selects.

    Raises ValueError where there are lights and float64 cannot hold a modelview matrix's determinant.
    """
    key = id(vertex), clamped
    found = _packed.get(key)
    if found is None:
        with np.errstate(all="ignore"):
            packed = _pack(vertex, clamped)
        if len(_packed) >= _PACKED_KEPT:
            _packed.clear()
        found = _packed[key] = packed, vertex
    packed = found[0]
    out = np.empty((8 * packed.sides, len(mesh.positions)))
    columns = np.empty((U.ROWS, CHUNK))
    U.light_vertices(arrays_of(mesh), packed.flags, packed.numbers, columns, out)
    return out


_NONE = np.zeros((0, 0))  # stands for an array that a mesh lacks


def arrays_of(mesh):
    """A mesh's positions, normals, colours, secondary colours and weights, as kernels take arrays."""
    weights = None if mesh.weights is None else mesh.weights[:, None]
    arrays = mesh.positions, mesh.normals, mesh.colors, mesh.secondary_colors, weights
    return tuple([_NONE if array is None else np.ascontiguousarray(array) for array in arrays])


def secondary_output(colors, output):
    """The eight colour columns with the secondary colour that ``output`` selects."""
    if output == SecondaryColor.FROM_VERTEX:
        return colors
    if output == SecondaryColor.OPAQUE:
        return [*colors[:7], ONE]
    if output == SecondaryColor.DISABLED:
        return [*colors[:4], ZERO, ZERO, ZERO, ONE]
    raise ValueError(f"{output!r} is no secondary colour.")
