"""Validation of meshes: what no machine could draw."""

from weakref import WeakSet

import numpy as np

from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.messages import shown
from fixedpipe.pipeline.validation.types import check_int, enum_check
from fixedpipe.pipeline.vertices.mesh_numbers import are_finite, are_vertices

_usable = WeakSet()  # meshes without a problem
_infinite_fog = WeakSet()
_check_primitive = enum_check(PrimitiveType)

_MESH_ARRAYS = (
    ("positions", (2, 4)),
    ("colors", (3, 4)),
    ("secondary_colors", (3, 4)),
    ("back_colors", (3, 4)),
    ("back_secondary_colors", (3, 4)),
    ("normals", (3, 3)),
)


def _array_problem(name, array, vertices, low, high):
    """A sentence that says what is wrong with a vertex array [vertices, low..high], or None."""
    components = str(low) if low == high else f"{low} to {high}"
    if array.ndim != 2 or not low <= array.shape[1] <= high:
        return f"{name} has shape {array.shape}; give [vertices, {components}]."
    if len(array) != vertices:
        return f"{name} has {len(array)} vertices but positions has {vertices}; give one row for each vertex."
    return finite_problem(name, array)


def finite_problem(name, array):
    """A sentence that names the first number of a vertex array that is not finite, or None."""
    if are_finite(array):
        return None
    bad = np.argwhere(~np.isfinite(array))[0]
    value = array[tuple(bad)]
    return (
        f"{name} of vertex {bad[0]} holds {value}; the machine has no meaning for it. Give finite numbers, "
        "and drop vertices that have none."
    )


def is_usable(mesh):
    """Whether a Mesh has no problem; each is looked at once."""
    if mesh in _usable:
        return True
    usable = mesh_problem(mesh) is None
    if usable:
        _usable.add(mesh)
    return usable


def has_infinite_fog(mesh):
    """Whether a usable Mesh has fog coordinates that are not finite; a vertex program can write them."""
    return mesh.fog_coordinates is not None and mesh in _infinite_fog


def mesh_problem(mesh):
    """A sentence that says why no state could draw a Mesh, or None."""
    if wrong := _check_primitive(mesh.primitive):
        return f"the mesh's primitive {wrong.predicate}."
    vertices = len(mesh.positions) if mesh.positions.ndim else 0
    for name in ("fog_coordinates", "point_sizes", "edge_flags", "weights"):
        array = getattr(mesh, name)
        if array is not None and array.ndim != 1:
            return f"the mesh's {name} has shape {array.shape}; give [vertices]."
        if array is None:
            continue
        finite = np.isfinite(array)
        if name == "fog_coordinates" and not finite.all():
            _infinite_fog.add(mesh)
            array = np.where(finite, array, 0.0)
        if problem := _array_problem(f"the mesh's {name}", array[:, None], vertices, 1, 1):
            return problem
    for name, (low, high) in _MESH_ARRAYS:
        array = getattr(mesh, name)
        if array is not None and (
            problem := _array_problem(f"the mesh's {name}", array, vertices, low, high)
        ):
            return problem
    for i, array in enumerate(mesh.texture_coordinates):
        if problem := _array_problem(f"the mesh's texture coordinate set {i}", array, vertices, 1, 4):
            return problem
    drawn = vertices
    if mesh.indices is not None:
        if mesh.indices.ndim != 1:
            return f"the mesh's indices has shape {mesh.indices.shape}; give one list of vertex numbers."
        drawn = len(mesh.indices)
        if not are_vertices(mesh.indices, vertices):
            at = int(np.argmax((mesh.indices < 0) | (mesh.indices >= vertices)))
            return (
                f"index {at} of the mesh is vertex {mesh.indices[at]}, but it has {vertices} vertices; give "
                f"numbers from 0 to {vertices - 1}."
            )
    return _counts_problem(mesh.counts, drawn)


def _counts_problem(counts, drawn):
    if counts is None:
        return None
    try:
        given = [int(c) for c in counts if not check_int(c)]
        wrong = len(given) != len(counts)
    except TypeError:
        wrong = True
    if wrong or any(c < 0 for c in given):
        return f"the mesh's counts is {shown(counts)}; give a tuple of integers, none negative."
    if sum(given) != drawn:
        return (
            f"the mesh's counts add up to {sum(given)} but it draws {drawn} vertices; give counts that take "
            "every vertex exactly once."
        )
    return None
