"""The current raster position (OpenGL 1.2.1 section 2.12): a command's RasterPosition in the window."""

from math import isfinite
from typing import NamedTuple

import numpy as np

from fixedpipe.pipeline.commands import vertex_of
from fixedpipe.pipeline.enums import FogCoordinateSource
from fixedpipe.pipeline.state import needs_normals
from fixedpipe.pipeline.vertices.arithmetic import columns_of, stacked_units, transform, weighted_sum
from fixedpipe.pipeline.vertices.colors import eye_normal, vertex_colors
from fixedpipe.pipeline.vertices.fog import iterated_fog
from fixedpipe.pipeline.vertices.projection import viewport_transform, window_coordinates
from fixedpipe.pipeline.vertices.texture_coordinates import unit_coordinates
from fixedpipe.pipeline.vertices.weighting import eye_coordinates, weight_of


class RasterVertex(NamedTuple):
    """The current raster position (section 2.12) and its associated data.

    - ``x``, ``y``, ``z``, ``inverse_w``: floats, window coordinates, not rounded, y up.
    - ``colors``: float64 [8], primary and secondary, as in WindowPrimitives before they are rounded.
    - ``coordinates``: float64 [units, 4].
    - ``fog``: the fog coordinate.
    """

    x: float
    y: float
    z: float
    inverse_w: float
    colors: np.ndarray
    coordinates: np.ndarray
    fog: float


def raster_vertex(position, state, profile, width, height):
    """The RasterVertex at which a rectangle of pixels begins, after ``move``; None if it is not valid."""
    if position.window:
        found = _given(position, state, profile)
    else:
        found = process_raster_position(vertex_of(position), state, profile, width, height)
        if found is None:
            return None
    x, y = (at + by for at, by in zip((found.x, found.y), position.move, strict=True))
    return found._replace(x=x, y=y) if isfinite(x) and isfinite(y) else None


def _given(position, state, profile):
    """The RasterVertex of a position in window coordinates.

    Source: ARB_window_pos: no transformation, lighting or texture coordinate generation; the depth lies in
    the depth range; the eye distance is zero.
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
        colors if profile.arithmetic.exact else np.clip(colors, 0.0, 1.0),
        coordinates,
        fog,
    )


def process_raster_position(mesh, state, profile, width, height):
    """The RasterVertex of a mesh's single vertex, or None where clipping discards it.

    Parameters and errors are those of ``process``. The vertex stage is the fixed function, without a
    composite. Source: OpenGL 1.2.1 section 2.12; the view volume itself clips, without a guard band.
    """
    vertex = state.vertex
    position = columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0))
    with np.errstate(all="ignore"):
        eye = eye_coordinates(vertex, position, weight_of(mesh))
        clip_coordinates = transform(vertex.projection, eye)
        w = clip_coordinates[3]
        bounded = clip_coordinates[: 2 if state.depth_clamp is not None else 3]
        inside = w > 0
        for c in bounded:
            inside = inside & (-w <= c) & (c <= w)
        for plane in vertex.clip_planes:
            inside = inside & (weighted_sum(plane, eye) >= 0)
        if not np.all(inside):
            return None
        half_size, center = viewport_transform(vertex.viewport, width, height)
        window = window_coordinates(clip_coordinates, vertex.viewport, half_size, center)
        window = [float(c) for column in window for c in np.broadcast_to(column, 1)]
        if not np.isfinite(window).all():
            return None
        normal = eye_normal(mesh, vertex) if needs_normals(state) else None
        colors, _ = vertex_colors(mesh, vertex, eye, normal, profile)
        coordinates = unit_coordinates(mesh, state, position, eye, normal, profile)
        fog = np.broadcast_to(iterated_fog(mesh, state, eye, profile), 1)[0]
        return RasterVertex(
            *window,
            np.array([np.broadcast_to(c, 1)[0] for c in colors], np.float64),
            stacked_units(1, coordinates)[0],
            float(fog),
        )
