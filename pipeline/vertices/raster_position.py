"""The current raster position (OpenGL 1.2.1 section 2.12): a command's RasterPosition in the window."""

from math import isfinite

import numpy as np

from fixedpipe.pipeline.commands import vertex_of
from fixedpipe.pipeline.enums import FogCoordinateSource
from fixedpipe.pipeline.vertices.stage import RasterVertex, process_raster_position


def raster_vertex(position, state, profile, width, height):
    """The RasterVertex where a rectangle of pixels begins, moved; None: it is not valid."""
    if position.window:
        found = _given(position, state, profile)
    else:
        found = process_raster_position(vertex_of(position), state, profile, width, height)
        if found is None:
            return None
    x, y = (at + by for at, by in zip((found.x, found.y), position.move, strict=True))
    return found._replace(x=x, y=y) if isfinite(x) and isfinite(y) else None


def _given(position, state, profile):
    """Window coordinates as they are given. Source: ARB_window_pos: no transformation, lighting or texture
    coordinate generation; depth in the depth range; the eye distance is zero.
    """
    x, y, z, _ = (float(c) for c in position.position)
    viewport = state.vertex.viewport
    near, far = float(viewport.near), float(viewport.far)
    colors = np.array([*position.color, *position.secondary_color], np.float64)
    coordinates = np.zeros((len(state.texture_units), 4))
    coordinates[:, 3] = 1.0
    for row, unit in zip(coordinates, state.texture_units, strict=True):
        if unit is not None and unit.coordinates < len(position.texture_coordinates):
            row[:] = position.texture_coordinates[unit.coordinates]
    fog = 0.0
    if state.fog is not None and state.fog.coordinate_source == FogCoordinateSource.FOG_COORDINATE:
        fog = float(position.fog_coordinate)
    return RasterVertex(
        x,
        y,
        near + min(max(z, 0.0), 1.0) * (far - near),
        1.0,
        colors if profile.exact else np.clip(colors, 0.0, 1.0),
        coordinates,
        fog,
    )
