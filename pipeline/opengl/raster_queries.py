"""Answers of Get about the raster position (OpenGL 1.2.1 section 2.12, table 6.6): the machine's own values.

The first such call imports the vertex stage, because this loads compiled kernels.
"""

from math import sqrt
from typing import Any

from fixedpipe.pipeline.commands import vertex_of
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.rectangles import raster_position
from fixedpipe.pipeline.state import PassState, TextureUnit, VertexState

_CURRENT_RASTER_SECONDARY_COLOR = 0x845F


def _vertex(gl) -> VertexState:
    raster = gl.values["raster"]
    return VertexState() if raster is None else raster.vertex


def _found(gl):
    """The vertex stage's result, or None if the position is not valid."""
    from fixedpipe.pipeline.vertices.raster_position import raster_vertex

    raster = gl.values["raster"]
    transforms = () if raster is None else raster.units
    units = tuple(
        [
            TextureUnit(texture="", coordinates=unit, gen=gen, matrix=matrix)
            for unit, (gen, matrix) in enumerate(transforms)
        ]
    )
    state = PassState(vertex=_vertex(gl), texture_units=units)
    return raster_vertex(raster_position(gl), state, gl.profile, gl.drawable.width, gl.drawable.height)


def _window(gl):
    """Window x, y and depth, and clip w. For an invalid position, which has none, the initial values."""
    found = _found(gl)
    return (0.0, 0.0, 0.0, 1.0) if found is None else (found.x, found.y, found.z, 1.0 / found.inverse_w)


def _distance(gl):
    from fixedpipe.pipeline.vertices.arithmetic import columns_of
    from fixedpipe.pipeline.vertices.weighting import eye_coordinates, weight_of

    position = raster_position(gl)
    if position.window:
        return 0.0
    mesh = vertex_of(position)
    place = columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0))
    x, y, z, _ = [float(c.item()) for c in eye_coordinates(_vertex(gl), place, weight_of(mesh))]
    return sqrt(x * x + y * y + z * z)


def _color(gl, first):
    """Four components of the colours, from ``first`` on, in [0, 1]."""
    found, position = _found(gl), raster_position(gl)
    given = (*position.color, *position.secondary_color) if found is None else found.colors.tolist()
    return tuple([min(max(component, 0.0), 1.0) for component in given[first : first + 4]])


def _coordinates(gl):
    """The texture coordinates of the active unit."""
    unit, found = gl.values["active_texture"], _found(gl)
    if found is None or unit >= len(found.coordinates):
        return raster_position(gl).texture_coordinates[unit]
    return tuple(found.coordinates[unit].tolist())


RASTER_STATE: dict[int, Any] = {
    tokens.CURRENT_RASTER_POSITION: _window,
    tokens.CURRENT_RASTER_POSITION_VALID: lambda gl: _found(gl) is not None,
    tokens.CURRENT_RASTER_DISTANCE: _distance,
    tokens.CURRENT_RASTER_COLOR: lambda gl: _color(gl, 0),
    _CURRENT_RASTER_SECONDARY_COLOR: lambda gl: _color(gl, 4),
    tokens.CURRENT_RASTER_TEXTURE_COORDS: _coordinates,
    tokens.CURRENT_RASTER_INDEX: lambda gl: 1,
}
