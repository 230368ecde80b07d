"""The fixed-function vertex stage (OpenGL 1.2.1, chapter 2): vertex arrays in, window primitives out.

docs/numbers.md sections 1 and 2 fix every operation and its order; this package computes them on columns.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.enums import VertexStage, WindowOrigin, WrapMode
from fixedpipe.pipeline.state import needs_normals
from fixedpipe.pipeline.vertices.arithmetic import (
    ONE,
    columns_of,
    filled,
    positive,
    stacked_units,
    transform,
)
from fixedpipe.pipeline.vertices.assembly import assemble
from fixedpipe.pipeline.vertices.chip_floats import transform_matrix
from fixedpipe.pipeline.vertices.clip import VIEW_VOLUME_SIDES, clip, clip_lines, clip_planes
from fixedpipe.pipeline.vertices.colors import (
    color_byte,
    eye_normal,
    given_colors,
    kept_color_bits,
    lit_colors,
    stacked_colors,
    unrounded_colors,
    vertex_colors,
)
from fixedpipe.pipeline.vertices.fog import iterated_fog
from fixedpipe.pipeline.vertices.plan import depends_on_places_alone, mesh_columns, plan_of
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from fixedpipe.pipeline.vertices.projection import (
    composite_coordinates,
    program_reciprocal,
    snap,
    viewport_transform,
    window_coordinates,
)
from fixedpipe.pipeline.vertices.strokes import draws_points, point_sizes, stroked
from fixedpipe.pipeline.vertices.texture_coordinates import unit_coordinates
from fixedpipe.pipeline.vertices.view_volume import has_sides, is_filled
from fixedpipe.pipeline.vertices.weighting import eye_coordinates, transform_eye, weight_of
from fixedpipe.raster.primitives.clip import MOST_VERTICES, clip_triangles, find_clipped
from fixedpipe.raster.primitives.vertices import (
    CHUNK,
    CLIPPED,
    FIRST_PROJECTIVE,
    UNUSUAL_W,
    transform_vertices,
)

_COLUMNS = ("x", "y", "z", "inverse_w", "colors", "coordinates", "fog")  # of WindowPrimitives


def process(mesh, state, profile, width, height, sample=(0, 0), *, rounded=True):
    """Transform, light, clip, project and snap a mesh; returns WindowPrimitives.

    - ``mesh``: a Mesh in object coordinates, checked by ``fixedpipe.pipeline.validation``.
    - ``state``: PassState.
    - ``profile``: the machine. The stage reads ``subpixel_bits``, ``guard_band``, ``device_origin``,
      ``color_mantissa_bits``, ``clamps`` (whether VERTEX_COLOR is on) and ``exact`` (an exact profile's
      colours are not rounded).
    - ``width``, ``height``: the framebuffer's size in pixels.
    - ``sample``: (x, y), the place in a pixel that pixels are drawn for, in 1/16 pixel from the middle, y up.
    - ``rounded``: whether colours become bytes; else they stay float64.

    Raises ValueError if normals are needed and float64 cannot hold the modelview matrix's determinant.

    A vertex outside a clipping plane keeps its place in the columns, but no triangle names it. Source: OpenGL
    1.2.1 sections 2.6 to 2.13; EXT_texture_cube_map; NV_texgen_reflection; EXT_fog_coord.
    """
    columns, bits = mesh_columns(mesh), kept_color_bits(state.vertex, profile) if rounded else None
    plan = plan_of(mesh, columns, state, profile, width, height)
    # Huge finite input may overflow to infinity and then to NaN. Such a triangle is dropped and counted
    # below. Colours and integers come from clamped values only. So no warning is needed.
    with np.errstate(all="ignore"):
        if plan is None:
            return process_columns(mesh, state, profile, width, height, sample, rounded=rounded)
        return _seen_from(
            _planned(mesh, columns, plan, state, profile, bits), sample, profile.arithmetic.subpixel_bits
        )


def unrounded(primitives, mesh, state, profile):
    """What ``process`` gives for an exact profile, from its ``primitives`` for a machine that has the same
    places of vertices.

    None where more than colours may differ, or where colours are computed.
    """
    lit, clipped = state.vertex.lighting is not None, len(primitives.x) != len(mesh.positions)
    if lit or clipped or not depends_on_places_alone(mesh, state):
        return None
    colors, _ = given_colors(mesh, mesh_columns(mesh), state.vertex, profile, None)
    return replace(primitives, colors=colors)


def _planned(mesh, columns, plan, state, profile, bits):
    """The primitives from kernels, with lighting, fog and coordinates from normals computed column by column.

    ``bits`` is the result of ``kept_color_bits``, or None.
    """
    count = len(mesh.positions)
    x, y, z, inverse_w = _window_columns(count)
    coordinates = np.empty((count, plan.units, 4))
    eye = np.empty((4 if plan.keeps_eye else 0, count))
    sums = plan.sums, plan.coefficients, plan.results, plan.parameters
    made = x, y, z, inverse_w, coordinates, eye
    found = transform_vertices(plan.given, sums, made, np.empty((plan.rows, CHUNK)))
    clipped = ()
    if found & CLIPPED:
        clipped = np.empty(len(plan.triangles), np.int32)
        clipped = clipped[: find_clipped(plan.triangles, inverse_w, clipped)]
    known = {"orderly": not found & UNUSUAL_W}
    if plan.units:
        known["projective"] = tuple(bool(found >> FIRST_PROJECTIVE + unit & 1) for unit in range(plan.units))
    elif plan.coordinates is not None:
        coordinates, known["projective"] = plan.coordinates
    fog, lit, two_side = columns.no_fog, state.vertex.lighting is not None, state.vertex.two_side
    if plan.keeps_eye:
        position = columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0))
        normal = eye_normal(mesh, state.vertex) if needs_normals(state) else None
        if lit:
            both = lit_colors(mesh, state.vertex, eye, normal, profile)
            two_side = len(both) == 16
            colors = stacked_colors(count, both, bits)
        if state.fog is not None:
            fog = filled(count, iterated_fog(mesh, state, eye, profile))
        if "projective" not in known:
            coordinates = stacked_units(count, unit_coordinates(mesh, state, position, eye, normal, profile))
    if not lit:
        colors, known["constant_color"] = given_colors(mesh, columns, state.vertex, profile, bits)
    primitives = WindowPrimitives(
        x=x,
        y=y,
        z=z,
        inverse_w=inverse_w,
        colors=colors,
        coordinates=coordinates,
        fog=fog,
        triangles=plan.triangles,
        dropped=0,
        two_side=two_side,
    )
    if len(clipped):
        unrounded = both.T if lit else unrounded_colors(mesh, columns, state.vertex, profile)
        primitives, known = _clipped(primitives, known, plan, clipped, unrounded, bits)
    return primitives.knowing(**known)


def _clipped(primitives, known, plan, chosen, colors, color_bits):
    """The primitives after clipping the ``chosen`` triangles, and what is known of them.

    ``colors`` are those before they became bytes of ``color_bits``: an array with one row for all vertices or
    one for each.
    """
    vertices, count = plan.triangles[chosen, :3].ravel(), len(chosen)
    n = len(vertices)
    x, y, z, inverse_w = _window_columns(n)
    clip_coordinates = np.empty((4, n))
    given = np.take(plan.given, vertices, axis=1)
    sums = plan.sums, plan.coefficients, plan.clip, plan.parameters
    made = x, y, z, inverse_w, np.empty((n, 0, 4)), clip_coordinates
    transform_vertices(given, sums, made, np.empty((plan.rows, CHUNK)))
    units, fog = primitives.coordinates.shape[1], 4 + colors.shape[1]
    corners = np.empty((n, fog + 1 + 4 * units))
    corners[:, :4] = clip_coordinates.T
    corners[:, 4:fog] = colors if len(colors) == 1 else colors[vertices]
    corners[:, fog] = primitives.fog[vertices]
    corners[:, fog + 1 :] = primitives.coordinates[vertices].reshape(n, 4 * units)

    most = MOST_VERTICES * count
    window, values = _window_columns(most), np.empty((most, corners.shape[1]))
    triangles = np.empty((len(plan.triangles) + most, 4), np.int32)
    scratch = np.empty((2, MOST_VERTICES, corners.shape[1]))
    rows, made, dropped, bits = clip_triangles(
        plan.triangles,
        chosen,
        corners,
        plan.parameters,
        len(primitives.x),
        scratch,
        (values, *window),
        triangles,
    )
    values = values[:made]
    made_colors = values[:, 4:fog] if color_bits is None else color_byte(values[:, 4:fog], color_bits)
    stacked = np.empty((made, 2, 8), primitives.colors.dtype)
    stacked[:] = made_colors.reshape(made, (fog - 4) // 8, 8)
    coordinates = values[:, fog + 1 :].reshape(made, units, 4)
    added = *(column[:made] for column in window), stacked, coordinates, values[:, fog]
    joined = {
        name: np.concatenate([getattr(primitives, name), new])
        for name, new in zip(_COLUMNS, added, strict=True)
    }
    known = {"orderly": known["orderly"] and not bits & UNUSUAL_W}
    return replace(primitives, triangles=triangles[:rows], dropped=dropped, **joined), known


def _window_columns(count):
    """Empty arrays for x, y, z and 1/w."""
    return np.empty(count, np.int32), np.empty(count, np.int32), np.empty(count), np.empty(count)


def _seen_from(primitives, sample, subpixel_bits):
    """Primitives moved so that ``sample`` lies at the middle of pixels."""
    across, up = ((offset << subpixel_bits) >> 4 for offset in sample)
    if not (across or up):
        return primitives
    return replace(primitives, x=primitives.x - np.int32(across), y=primitives.y + np.int32(up))  # y down


def process_columns(mesh, state, profile, width, height, sample=(0, 0), *, rounded=True):
    """``process`` for any mesh and state, column by column."""
    bits = kept_color_bits(state.vertex, profile) if rounded else None
    triangles = assemble(mesh, state.polygon.provoking_vertex)
    primitives, origin, triangles, sizes = _process(mesh, triangles, state, profile, width, height, bits)
    primitives = _seen_from(primitives, sample, profile.arithmetic.subpixel_bits)
    return stroked(primitives, mesh, state, profile, triangles, origin, sizes)


def eye_and_clip(vertex, position, weight):
    """Eye and clip coordinates of object coordinates, four columns each (sections 2.10.2, 2.11).

    ``weight`` is a column (EXT_vertex_weighting).
    """
    eye = eye_coordinates(vertex, position, weight)
    if vertex.composite is not None:
        if vertex.modelview1 is not None:
            position = transform_eye(vertex, position, weight)
        return eye, transform_matrix(vertex.composite.matrix, position)
    return eye, transform(vertex.projection, eye)


def _vertex_columns(mesh, state, profile, position):
    """The columns that clipping interpolates, and whether back colours differ from front colours.

    The columns are: clip coordinates, eye coordinates where user planes clip, colours, fog, texture
    coordinates and sizes of points.
    """
    vertex = state.vertex
    eye, clip_coordinates = eye_and_clip(vertex, position, weight_of(mesh))
    normal = eye_normal(mesh, vertex) if needs_normals(state) else None
    front, back = vertex_colors(mesh, vertex, eye, normal, profile)
    two_side = back is not front
    columns = [
        *clip_coordinates,
        *(eye if vertex.clip_planes else ()),
        *front,
        *(back if two_side else ()),
        iterated_fog(mesh, state, eye, profile),
        *unit_coordinates(mesh, state, position, eye, normal, profile),
        point_sizes(mesh, state, profile, eye) if draws_points(mesh, state.polygon) else ONE,
    ]
    return columns, two_side


def _offset(composite):
    return [np.float64(np.float32(component)) for component in composite.offset]


def _half_size_and_center(vertex, width, height):
    """Half the viewport's size and its middle, (x, y) each."""
    if vertex.composite is None:
        return viewport_transform(vertex.viewport, width, height)
    return [ONE, ONE], _offset(vertex.composite)[:2]


def _clipped_columns(mesh, triangles, columns, state, profile, width, height):
    """Clipped rows, the columns with new vertices, the row that each came from, and the number dropped.

    A vertex program's results are not clipped.
    """
    vertex = state.vertex
    polygons = mesh.primitive.is_polygons
    if vertex.stage == VertexStage.PROGRAM_RESULTS:
        origin, dropped = np.arange(len(triangles)), 0
    else:
        half_size, center = _half_size_and_center(vertex, width, height)
        clamped = state.depth_clamp is not None or vertex.composite is not None
        size, guard_band = (width, height), profile.arithmetic.guard_band
        planes = clip_planes(vertex.clip_planes, half_size, center, size, guard_band, clamped)
        if has_sides(vertex) and not is_filled(mesh, state.polygon):
            planes[-4:] = VIEW_VOLUME_SIDES
        clipped = (clip if polygons else clip_lines)(triangles, columns, len(mesh.positions), planes)
        triangles, columns, origin, dropped = clipped
    return triangles, columns, origin, dropped


def _window(vertex, position, clip_coordinates, width, height):
    """Window x and y (up), z and 1/w, from a vertex program's results or from clip coordinates."""
    if vertex.stage == VertexStage.PROGRAM_RESULTS:
        return *position[:3], program_reciprocal(position[3])
    if vertex.composite is not None:
        return composite_coordinates(clip_coordinates, _offset(vertex.composite), height)
    half_size, center = _half_size_and_center(vertex, width, height)
    return window_coordinates(clip_coordinates, vertex.viewport, half_size, center)


def _process(mesh, triangles, state, profile, width, height, bits):
    """The primitives of a mesh, without strokes, and what their strokes need.

    Also returns the row of ``triangles`` that each came from, the rows after clipping, and the sizes of
    points, a column. ``bits`` is the result of ``kept_color_bits``, or None.
    """
    vertex, position = state.vertex, columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0))
    columns, two_side = _vertex_columns(mesh, state, profile, position)
    clipped = _clipped_columns(mesh, triangles, columns, state, profile, width, height)
    triangles, columns, origin, dropped = clipped
    count = max((len(column) for column in columns if column.ndim), default=len(mesh.positions))
    first_color = 8 if vertex.clip_planes else 4
    fog = first_color + (16 if two_side else 8)
    x, y, z, inverse_w = _window(vertex, position, columns[:4], width, height)
    programmed = vertex.stage == VertexStage.PROGRAM_RESULTS  # It clips nothing, so w has either sign.
    drawable = (inverse_w != 0 if programmed else inverse_w > 0) & np.isfinite(inverse_w)
    drawable &= np.isfinite(x) & np.isfinite(y) & np.isfinite(z)
    if not np.all(drawable):
        drawable = np.broadcast_to(drawable, count)
        lost = np.unique(origin[~drawable[triangles[:, :3]].all(axis=1)])
        kept = ~np.isin(origin, lost)
        triangles, origin = triangles[kept], origin[kept]
        dropped += len(lost)
    unclamped = vertex.depth_units or state.depth_clamp is not None
    if profile.arithmetic.device_origin == WindowOrigin.UPPER_LEFT:
        y = snap(height - y, height, profile)
    else:
        y = (height << profile.arithmetic.subpixel_bits) - snap(y, height, profile)
    if not state.perspective_correction:
        inverse_w = np.copysign(ONE, inverse_w)
    primitives = WindowPrimitives(
        x=filled(count, snap(x, width, profile), np.int32),
        y=filled(count, y, np.int32),
        z=filled(count, z if unclamped else np.fmin(positive(z), ONE)),
        inverse_w=filled(count, np.where(drawable, inverse_w, ONE)),
        colors=stacked_colors(count, columns[first_color:fog], bits),
        coordinates=stacked_units(count, columns[fog + 1 : -1]),
        fog=filled(count, columns[fog]),
        triangles=triangles,
        dropped=dropped,
        two_side=two_side,
    )
    wraps = any(unit is not None and any(unit.cylinder_wrap) for unit in state.texture_units)
    sizes = columns[-1]
    if wraps:
        primitives = _cylinder_wrapped(primitives, state)
        sizes = np.broadcast_to(sizes, count)[triangles.reshape(-1)]
    return primitives, origin, triangles, sizes


def _wrap_modes(sampler):
    return sampler.wrap_s, sampler.wrap_t, sampler.wrap_r


def _cylinder_wrapped(primitives, state):
    """The same triangles without shared vertices, with the coordinates that ``cylinder_wrap`` names wrapped.

    Where they repeat, whole numbers bring them within one half of the first vertex's coordinate. Measured: s
    under REPEAT is, t under MIRRORED_REPEAT is not (CylinderWrapping capture).
    """
    corners = primitives.triangles.reshape(-1)
    separate = {name: getattr(primitives, name)[corners] for name in _COLUMNS}
    coordinates = separate["coordinates"].reshape(-1, 4, *separate["coordinates"].shape[1:])
    for number, unit in enumerate(state.texture_units):
        for axis, mode in enumerate(() if unit is None else _wrap_modes(unit.sampler)):
            if not unit.cylinder_wrap[axis] or mode != WrapMode.REPEAT:
                continue
            value = coordinates[:, :, number, axis]
            value -= np.ceil((value - value[:, :1]) - np.float64(0.5))
    triangles = np.arange(len(corners), dtype=np.int32).reshape(-1, 4)
    return replace(primitives, triangles=triangles, **separate)
