"""The vertices of a fragment's primitive: the mesh's values, and the vertex stage's results."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import VertexStage
from fixedpipe.pipeline.inspection.history import Quantity, Stage
from fixedpipe.pipeline.state import PassState
from fixedpipe.pipeline.vertices.arithmetic import columns_of
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from fixedpipe.pipeline.vertices.stage import eye_and_clip
from fixedpipe.pipeline.vertices.weighting import weight_of


def vertices_stage(mesh: Mesh, state: PassState, primitives: WindowPrimitives, triangle: int) -> Stage:
    """The corners of a row of ``primitives.triangles``; each corner of a line or point appears once."""
    corners = dict.fromkeys(primitives.triangles[triangle, :3].tolist())
    read: list[Quantity] = []
    made: list[Quantity] = []
    for vertex in corners:
        if vertex < len(mesh.positions):
            read += _given(mesh, state, vertex)
            made += _transformed(mesh, state, vertex)
        made += _window(primitives, vertex)
    clipped = [str(vertex) for vertex in corners if vertex >= len(mesh.positions)]
    says = f"made by clipping, as their numbers say: {', '.join(clipped)}" if clipped else ""
    return Stage("vertices", "vertices", says, tuple(read), tuple(made))


def _real(name: str, values: Any) -> Quantity:
    return Quantity(name, tuple(float(value) for value in np.ravel(values)))


def _given(mesh: Mesh, state: PassState, vertex: int) -> Iterator[Quantity]:
    """A vertex's values in the mesh."""
    programmed = state.vertex.stage == VertexStage.PROGRAM_RESULTS
    yield _real(
        f"vertex {vertex}: {'position' if programmed else 'object coordinates'}", mesh.positions[vertex]
    )
    for name, array in (
        ("normal", mesh.normals),
        ("color", mesh.colors),
        ("secondary color", mesh.secondary_colors),
    ):
        if array is not None:
            yield _real(f"vertex {vertex}: {name}", array[vertex])
    if state.vertex.modelview1 is not None and mesh.weights is not None:
        yield _real(f"vertex {vertex}: weight", mesh.weights[vertex])
    for number, array in enumerate(mesh.texture_coordinates):
        yield _real(f"vertex {vertex}: coordinate set {number}", array[vertex])


def _transformed(mesh: Mesh, state: PassState, vertex: int) -> Iterator[Quantity]:
    """Eye and clip coordinates, from the functions that every vertex goes through."""
    if state.vertex.stage == VertexStage.PROGRAM_RESULTS:
        return
    position = columns_of(mesh.positions[vertex : vertex + 1], (0.0, 0.0, 0.0, 1.0))
    weight = np.broadcast_to(weight_of(mesh), len(mesh.positions))[vertex : vertex + 1]
    with np.errstate(all="ignore"):
        both = eye_and_clip(state.vertex, position, weight)
    for name, columns in zip(("eye", "clip"), both, strict=True):
        yield _real(f"vertex {vertex}: {name} coordinates", [np.ravel(column)[0] for column in columns])


def _window(primitives: WindowPrimitives, vertex: int) -> Iterator[Quantity]:
    """A vertex's iterated values. x and y appear with the fragment's place."""
    yield _real(f"vertex {vertex}: window z", primitives.z[vertex])
    front, back = primitives.colors[vertex]
    yield _real(f"vertex {vertex}: lit color", front[:4])
    yield _real(f"vertex {vertex}: lit secondary color", front[4:])
    if primitives.two_side:
        yield _real(f"vertex {vertex}: lit back color", back[:4])
    for unit in range(primitives.coordinates.shape[1]):
        yield _real(f"vertex {vertex}: texture coordinates {unit}", primitives.coordinates[vertex, unit])
