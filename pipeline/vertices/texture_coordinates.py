"""Texture coordinates of vertices: generated (section 2.10.4) and transformed."""

import numpy as np

from fixedpipe.pipeline.enums import LightingArithmetic, TexGenMode
from fixedpipe.pipeline.state import texgen_modes
from fixedpipe.pipeline.vertices.arithmetic import (
    ONE,
    ZERO,
    columns_of,
    dot,
    length,
    normalize,
    transform,
    weighted_sum,
)
from fixedpipe.pipeline.vertices.chip_floats import (
    TRANSFORM_BITS,
    product,
    single,
    total,
    transform_dot,
    transform_inverse_root,
)
from fixedpipe.pipeline.vertices.lighting_unit import unit_vector

_REFLECTION_MODES = frozenset({TexGenMode.SPHERE_MAP, TexGenMode.REFLECTION_MAP})


def unit_coordinates(mesh, state, position, eye, normal, profile):
    """s, t, r, q of unit 0, then of unit 1, ...; a disabled unit has (0, 0, 0, 1)."""
    modes = texgen_modes(state)
    reflection = sphere = None
    if not _REFLECTION_MODES.isdisjoint(modes):
        in_unit = profile.arithmetic.lighting == LightingArithmetic.LIGHTING_UNIT
        reflection = _transform_unit_reflection(eye, normal) if in_unit else _reflection(eye, normal)
        sphere = _transform_unit_sphere_map(reflection) if in_unit else _sphere_map(reflection)
    result = []
    for unit in state.texture_units:
        if unit is None:
            result += [ZERO, ZERO, ZERO, ONE]
            continue
        given = unit.coordinates < len(mesh.texture_coordinates)
        array = mesh.texture_coordinates[unit.coordinates] if given else None
        coordinates = columns_of(array, (0.0, 0.0, 0.0, 1.0))
        for axis, gen in enumerate(unit.gen):
            if gen.mode == TexGenMode.OBJECT_LINEAR:
                coordinates[axis] = weighted_sum(gen.plane, position)
            elif gen.mode == TexGenMode.EYE_LINEAR:
                coordinates[axis] = weighted_sum(gen.plane, eye)
            elif gen.mode == TexGenMode.SPHERE_MAP:
                coordinates[axis] = sphere[axis]
            elif gen.mode == TexGenMode.NORMAL_MAP:
                coordinates[axis] = normal[axis]
            elif gen.mode == TexGenMode.REFLECTION_MAP:
                coordinates[axis] = reflection[axis]
        result += transform(unit.matrix, coordinates)
    return result


def _reflection(eye, normal):
    """The reflection vector of section 2.10.4."""
    u = normalize(eye[:3])
    twice = dot(normal, u) * np.float64(2.0)
    return [u[axis] - normal[axis] * twice for axis in range(3)]


def _sphere_map(reflection):
    """s and t of a sphere map; both are 1/2 where m is 0, in the one direction that the map lacks."""
    m = length([reflection[0], reflection[1], reflection[2] + ONE]) * np.float64(2.0)
    divisor = np.where(m == 0, ONE, m)
    return [reflection[axis] / divisor + np.float64(0.5) for axis in range(2)]


def _transform_unit_reflection(eye, normal):
    """The reflection vector in 24 significant bits.

    Measured: Texgen_with_texture_matrix ReflectionMap_RotateX, where exact roots lose a pixel.
    """
    u, _, _ = unit_vector([single(component) for component in eye[:3]])
    normal = [single(component) for component in normal]
    twice = transform_dot(normal, u) * np.float64(2.0)
    return [
        total((u[axis], -product(normal[axis], twice, TRANSFORM_BITS)), TRANSFORM_BITS) for axis in range(3)
    ]


def _transform_unit_sphere_map(reflection):
    """s and t of a sphere map in 24 significant bits.

    Measured: Texgen_with_texture_matrix SphereMap_Double.
    """
    half = [reflection[0], reflection[1], total((reflection[2], ONE), TRANSFORM_BITS)]
    root = transform_inverse_root(transform_dot(half, half)) * np.float64(0.5)
    return [
        total((product(reflection[axis], root, TRANSFORM_BITS), np.float64(0.5)), TRANSFORM_BITS)
        for axis in range(2)
    ]
