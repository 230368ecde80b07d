"""Primitives in selection and feedback (OpenGL 1.2.1 sections 5.2 and 5.3).

Vertices are transformed, lit and clipped in float64 by OpenGL's equations, for any machine. Feedback returns
polygons as the triangles into which a machine splits them, which section 5.3 allows.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import Face, FrontFace, PolygonMode, PrimitiveType, ShadeModel
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.matrices import top
from fixedpipe.pipeline.opengl.texturing import GENERATIONS, generation
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.state import PassState, RasterPosition, TextureUnit, needs_normals
from fixedpipe.pipeline.vertices.arithmetic import columns_of
from fixedpipe.pipeline.vertices.assembly import assemble, boundary_edges, stipple_groups
from fixedpipe.pipeline.vertices.clip import VIEW_VOLUME_SIDES, clip, clip_lines, clip_planes
from fixedpipe.pipeline.vertices.colors import eye_normal, vertex_colors
from fixedpipe.pipeline.vertices.projection import viewport_transform, window_coordinates
from fixedpipe.pipeline.vertices.raster_position import raster_vertex
from fixedpipe.pipeline.vertices.stage import eye_and_clip
from fixedpipe.pipeline.vertices.texture_coordinates import unit_coordinates
from fixedpipe.pipeline.vertices.weighting import weight_of

# The edges of a triangle, by the numbers of ``boundary_edges``, in the order in which they are drawn.
_EDGES = ((1, 2), (2, 0), (0, 1))
_FIRST_COLOR = 8  # its place among the clipped columns; clip and eye coordinates come first


def take_mesh(gl, mesh: Mesh) -> None:
    """Do what a draw of ``mesh`` does in selection or feedback."""
    state, size = gl.state(), (gl.drawable.width, gl.drawable.height)
    feeds_back = gl.values["render_mode"] == tokens.FEEDBACK
    with np.errstate(all="ignore"):
        columns = _vertex_columns(gl, mesh, state, feeds_back)
        rows, columns, origin = _clipped(mesh, state, size, columns)
        half_size, center = viewport_transform(state.vertex.viewport, *size)
        x, y, z, _ = window_coordinates(columns[:4], state.vertex.viewport, half_size, center)
    front = None
    if mesh.primitive.is_polygons:
        front = _faces_front(rows, origin, x, y, state.polygon.front_face)
        if state.polygon.cull_face is not None:
            faces = {Face.FRONT: front, Face.BACK: ~front}
            kept = ~faces.get(state.polygon.cull_face, np.ones_like(front))
            rows, origin, front = rows[kept], origin[kept], front[kept]
    if not len(rows):
        return
    if feeds_back:
        window = np.stack([x, y, z, columns[3]], axis=1)
        _feed_back(gl, mesh, state, rows, origin, front, window, columns[_FIRST_COLOR:])
    else:
        depths = z[rows[:, :3]]
        gl.selection.hit((float(depths.min()), float(depths.max())))


def _vertex_columns(gl, mesh, state: PassState, feeds_back):
    """Columns [n] of vertices: clip and eye coordinates. For feedback also front and back colours (4 each),
    and texture coordinates.
    """
    position = columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0))
    eye, clip_coordinates = eye_and_clip(state.vertex, position, weight_of(mesh))
    columns = [*clip_coordinates, *eye]
    if feeds_back:
        state = replace(state, texture_units=(_first_unit(gl),))
        normal = eye_normal(mesh, state.vertex) if needs_normals(state) else None
        eye = [np.broadcast_to(column, len(mesh.positions)) for column in eye]
        front, back = vertex_colors(mesh, state.vertex, eye, normal, IDEAL)
        columns += [*front[:4], *back[:4], *unit_coordinates(mesh, state, position, eye, normal, IDEAL)]
    return [np.array(np.broadcast_to(column, len(mesh.positions))) for column in columns]


def _first_unit(gl):
    """Unit 0 with its texture coordinates. It makes them even if it is not enabled (section F.2.14)."""
    generates = [gl.values["enabled", token, 0] for token in GENERATIONS]
    held = gl.values["texture generation", 0]
    return TextureUnit(
        texture=None,
        coordinates=0,
        gen=tuple([generation(each, on) for each, on in zip(held, generates, strict=True)]),
        matrix=top(gl, ("texture matrix", 0)),
    )


def _clipped(mesh, state, size, columns):
    """(rows of ``assemble`` after clipping, columns with new vertices, the original row of each row)."""
    half_size, center = viewport_transform(state.vertex.viewport, *size)
    planes = clip_planes(
        state.vertex.clip_planes, half_size, center, size, 0.0, state.depth_clamp is not None
    )
    planes[-4:] = VIEW_VOLUME_SIDES
    rows = assemble(mesh, state.polygon.provoking_vertex)
    way = clip if mesh.primitive.is_polygons else clip_lines
    rows, columns, origin, _ = way(rows, columns, len(mesh.positions), planes)
    return rows, columns, origin


def _faces_front(rows, origin, x, y, front_face):
    """Whether the original triangle of each row faces the front. One without area counts as
    counter-clockwise.
    """
    (x0, x1, x2), (y0, y1, y2) = x[rows[:, :3]].T, y[rows[:, :3]].T
    areas = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    of_whole = np.bincount(origin, areas)[origin] if len(rows) else areas
    return (of_whole >= 0) == (front_face == FrontFace.CCW)


def _feed_back(gl, mesh, state, rows, origin, front, window, columns):
    """Write the primitives of these rows into the feedback array."""
    front_colors, back_colors = (np.clip(np.stack(columns[k : k + 4], axis=1), 0.0, 1.0) for k in (0, 4))
    coordinates = np.stack(columns[8:12], axis=1)
    flat = state.polygon.shade_model == ShadeModel.FLAT
    groups = stipple_groups(mesh)
    begins = (np.diff(groups, prepend=-1) != 0)[origin]
    boundary = None if front is None else _boundary(mesh, rows, origin)
    for at, row in enumerate(rows.tolist()):
        colors = front_colors if front is None or front[at] else back_colors

        def vertex(number, colors=colors, row=row):
            color = colors[row[3] if flat else number]
            values = *window[number].tolist(), *color.tolist(), *coordinates[number].tolist()
            return gl.selection.chosen(values)

        if front is None:
            if mesh.primitive == PrimitiveType.POINTS:
                gl.selection.write([float(tokens.POINT_TOKEN), *vertex(row[0])])
            else:
                gl.selection.write([_line_token(begins[at]), *vertex(row[1]), *vertex(row[0])])
            continue
        mode = state.polygon.front_mode if front[at] else state.polygon.back_mode
        if mode == PolygonMode.FILL:
            corners = [value for number in row[:3] for value in vertex(number)]
            gl.selection.write([float(tokens.POLYGON_TOKEN), 3.0, *corners])
            continue
        begin = begins[at]
        for bit, (first, second) in enumerate(_EDGES):
            if not boundary[at] >> bit & 1:
                continue
            if mode == PolygonMode.POINT:
                gl.selection.write([float(tokens.POINT_TOKEN), *vertex(row[first])])
            else:
                gl.selection.write([_line_token(begin), *vertex(row[first]), *vertex(row[second])])
            begin = False


def _line_token(begins):
    return float(tokens.LINE_RESET_TOKEN if begins else tokens.LINE_TOKEN)


def _boundary(mesh, rows, origin):
    """The edges of each row that bound a polygon, in the form of ``boundary_edges``.

    The boundary of a clipped triangle includes the edges that clipping made (section 2.11).
    """
    boundary = boundary_edges(mesh)[origin]
    clipped = np.isin(origin, origin[(rows[:, :3] >= len(mesh.positions)).any(axis=1)])
    begins, ends = np.diff(origin, prepend=-1) != 0, np.diff(origin, append=-1) != 0
    return np.where(clipped, 1 | np.where(ends, 2, 0) | np.where(begins, 4, 0), boundary)


def raster_position_depth(gl, position: RasterPosition, state: PassState) -> float | None:
    """The window depth of a raster position, or None if it is not valid."""
    found = raster_vertex(position, state, IDEAL, gl.drawable.width, gl.drawable.height)
    return None if found is None else found.z


def raster_position_values(gl, position: RasterPosition, state: PassState) -> list[float] | None:
    """The values of a raster position, as for a vertex in feedback; None if it is not valid."""
    state = replace(state, texture_units=(_first_unit(gl),))
    found = raster_vertex(position, state, IDEAL, gl.drawable.width, gl.drawable.height)
    if found is None:
        return None
    color = np.clip(found.colors[:4], 0.0, 1.0).tolist()
    return [found.x, found.y, found.z, 1.0 / found.inverse_w, *color, *found.coordinates[0].tolist()]
