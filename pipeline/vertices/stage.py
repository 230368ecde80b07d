"""The fixed-function vertex stage (OpenGL 1.2.1, chapter 2): vertex arrays in, window primitives out.

docs/numbers.md sections 1 and 2 fix every operation and its order; this module is that text on columns.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fixedpipe.pipeline.enums import (
    Clamp,
    FogArithmetic,
    FogCoordinateSource,
    FogGeneration,
    LightingArithmetic,
    PolygonMode,
    PrimitiveType,
    SecondaryColor,
    TexGenMode,
    VertexStage,
    WindowOrigin,
    WrapMode,
)
from fixedpipe.pipeline.state import needs_normals, texgen_modes
from fixedpipe.pipeline.vertices import lighting_unit
from fixedpipe.pipeline.vertices.arithmetic import (
    ONE,
    SINGLE_BITS,
    ZERO,
    columns_of,
    dot,
    invert_upper_left,
    keep_significant_bits,
    length,
    normalize,
    positive,
    transform,
    transform_single,
    weighted_sum,
)
from fixedpipe.pipeline.vertices.assembly import assemble, boundary_edges, stipple_groups
from fixedpipe.pipeline.vertices.clip import clip, clip_lines, clip_planes
from fixedpipe.pipeline.vertices.fog import vertex_value
from fixedpipe.pipeline.vertices.lighting import light_vertices
from fixedpipe.pipeline.vertices.plan import mesh_columns, plan_of
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives, is_constant
from fixedpipe.pipeline.vertices.strokes import (
    draws_points,
    outlined,
    point_sizes,
    sprite_units,
    with_squares,
    with_steps,
    with_strokes,
)
from fixedpipe.raster import codes as C
from fixedpipe.raster.primitives.clip import MOST_VERTICES, clip_triangles, find_clipped
from fixedpipe.raster.primitives.vertices import (
    CHUNK,
    CLIPPED,
    FIRST_PROJECTIVE,
    UNUSUAL_W,
    transform_vertices,
)

_REFLECTION_MODES = frozenset({TexGenMode.SPHERE_MAP, TexGenMode.REFLECTION_MAP})
_FLOAT64_MANTISSA_BITS = 53
_COLUMNS = ("x", "y", "z", "inverse_w", "colors", "coordinates", "fog")  # of WindowPrimitives


def process(mesh, state, profile, width, height, sample=(0, 0)):
    """Transform, light, clip, project and snap a mesh.

    Parameters
    ----------
    mesh : fixedpipe.pipeline.commands.Mesh
        Object coordinates; checked by ``fixedpipe.pipeline.validation``.
    state : fixedpipe.pipeline.state.PassState
    profile : fixedpipe.pipeline.profiles.profile.Profile
        Read are ``subpixel_bits``, ``guard_band``, ``device_origin``, ``color_mantissa_bits``, ``exact``: an
        exact profile's colours stay float64, not rounded; ``clamps``: whether VERTEX_COLOR is on.
    width, height : int
        The framebuffer's size in pixels.
    sample : tuple of int
        The place in a pixel that pixels are drawn for, (x, y) in 1/16 pixel from the middle, y up.

    Returns
    -------
    fixedpipe.pipeline.vertices.primitives.WindowPrimitives

    Raises
    ------
    ValueError
        If normals are needed and the modelview matrix has no inverse.

    Notes
    -----
    A vertex outside a clipping plane keeps its place in the columns, where no triangle names it.
    Source: OpenGL 1.2.1 sections 2.6 to 2.13; EXT_texture_cube_map; NV_texgen_reflection; EXT_fog_coord.
    """
    columns = mesh_columns(mesh)
    plan = plan_of(mesh, columns, state, profile, width, height, _viewport)
    # Huge finite input may overflow to infinity and on to NaN. Such a triangle is dropped and counted below,
    # and colours and integers are made from clamped values only, so no warning is due.
    with np.errstate(all="ignore"):
        if plan is None:
            return process_columns(mesh, state, profile, width, height, sample)
        return _seen_from(_planned(mesh, columns, plan, state, profile), sample, profile.subpixel_bits)


def _planned(mesh, columns, plan, state, profile):
    """What kernels compute, with lighting, fog and coordinates generated from normals column by column."""
    count = len(mesh.positions)
    x, y, z, inverse_w = _window_columns(count)
    coordinates = np.empty((count, plan.units, 4))
    eye = np.empty((4 if plan.keeps_eye else 0, count))
    found = transform_vertices(
        plan.given, plan.sums, plan.coefficients, plan.results, plan.parameters, x, y, z, inverse_w,
        coordinates, eye, np.empty((plan.rows, CHUNK)),
    )  # fmt: skip
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
    both = None
    if plan.keeps_eye:
        position = columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0))
        normal = _eye_normal(mesh, state.vertex) if needs_normals(state) else None
        if lit:
            front, back = _vertex_colors(mesh, state.vertex, position, eye, normal, profile)
            two_side = back is not front
            both = [*front, *back] if two_side else front
            colors = _colors(count, both, _color_bits(state.vertex, profile))
        if state.fog is not None:
            fog = _filled(count, _fog(mesh, state, eye, profile))
        if "projective" not in known:
            coordinates = _stacked(count, _texture_coordinates(mesh, state, position, eye, normal))
    if not lit:
        colors, known["constant_color"] = _given_colors(mesh, columns, state.vertex, profile)
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
        if not lit:
            both = _unrounded_colors(mesh, columns, state.vertex, profile)
        bits = _color_bits(state.vertex, profile)
        primitives, known = _clipped(primitives, known, plan, clipped, both, bits)
    return primitives.knowing(**known)


def _clipped(primitives, known, plan, chosen, colors, color_bits):
    """The primitives and what is known of them after clipping the triangles that are ``chosen``.

    colors: before they became bytes of ``color_bits``, columns, or one array for all vertices or of each.
    """
    vertices, count = plan.triangles[chosen, :3].ravel(), len(chosen)
    n = len(vertices)
    x, y, z, inverse_w = _window_columns(n)
    clip_coordinates = np.empty((4, n))
    transform_vertices(
        np.take(plan.given, vertices, axis=1), plan.sums, plan.coefficients, plan.clip, plan.parameters, x, y,
        z, inverse_w, np.empty((n, 0, 4)), clip_coordinates, np.empty((plan.rows, CHUNK)),
    )  # fmt: skip
    units = primitives.coordinates.shape[1]
    fog = 4 + (len(colors) if isinstance(colors, list) else colors.shape[1])
    corners = np.empty((n, fog + 1 + 4 * units))
    corners[:, :4] = clip_coordinates.T
    if isinstance(colors, list):
        for index, column in enumerate(colors):
            corners[:, 4 + index] = column[vertices] if column.ndim else column
    else:
        corners[:, 4:fog] = colors if len(colors) == 1 else colors[vertices]
    corners[:, fog] = primitives.fog[vertices]
    corners[:, fog + 1 :] = primitives.coordinates[vertices].reshape(n, 4 * units)

    most = MOST_VERTICES * count
    window, values = _window_columns(most), np.empty((most, corners.shape[1]))
    triangles = np.empty((len(plan.triangles) + most, 4), np.int32)
    scratch = np.empty((2, MOST_VERTICES, corners.shape[1]))
    rows, made, dropped, bits = clip_triangles(
        plan.triangles, chosen, corners, plan.parameters, len(primitives.x), scratch, values, *window,
        triangles,
    )  # fmt: skip
    values = values[:made]
    made_colors = values[:, 4:fog] if color_bits is None else _color_byte(values[:, 4:fog], color_bits)
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
    """Arrays for x, y, z and 1/w."""
    return np.empty(count, np.int32), np.empty(count, np.int32), np.empty(count), np.empty(count)


def _given_colors(mesh, columns, vertex, profile):
    """Colours of vertices without lighting, as WindowPrimitives has them, and whether all are equal."""
    bits = _color_bits(vertex, profile)
    key = vertex.two_side, vertex.secondary_color, bits, _clamps_colors(profile)
    if key not in columns.colors:
        front, back = _vertex_colors(mesh, vertex, None, None, None, profile)
        both = [*front, *back] if vertex.two_side else front
        colors = _colors(len(mesh.positions), both, bits)
        columns.colors[key] = colors, is_constant(colors)
    return columns.colors[key]


def _unrounded_colors(mesh, columns, vertex, profile):
    """What ``_given_colors`` makes bytes of, as MeshColumns has it."""
    key = vertex.two_side, vertex.secondary_color, _clamps_colors(profile)
    if key not in columns.unrounded:
        front, back = _vertex_colors(mesh, vertex, None, None, None, profile)
        both = [*front, *back] if vertex.two_side else front
        columns.unrounded[key] = np.stack(np.broadcast_arrays(*both, np.zeros(1))[:-1], axis=1)
    return columns.unrounded[key]


def _clamps_colors(profile):
    return Clamp.VERTEX_COLOR in profile.clamps


def _color_bits(vertex, profile):
    """How many bits of a colour's mantissa are kept on its way to a byte; None: it stays float64."""
    if profile.exact:
        return None
    exact = vertex.lighting is not None and profile.lighting == LightingArithmetic.EQUATIONS
    return _FLOAT64_MANTISSA_BITS if exact else profile.color_mantissa_bits


def _seen_from(primitives, sample, subpixel_bits):
    """Primitives moved so that ``sample`` lies where pixels have their middle."""
    across, up = ((offset << subpixel_bits) >> 4 for offset in sample)
    if not (across or up):
        return primitives
    return replace(primitives, x=primitives.x - np.int32(across), y=primitives.y + np.int32(up))  # y down


def process_columns(mesh, state, profile, width, height, sample=(0, 0)):
    """``process`` for any mesh and state, column by column."""
    triangles = assemble(mesh, state.polygon.provoking_vertex)
    primitives, origin, triangles, sizes = _process(mesh, triangles, state, profile, width, height)
    primitives = _seen_from(primitives, sample, profile.subpixel_bits)
    return _with_strokes(primitives, mesh, state, profile, triangles, origin, sizes)


def _process(mesh, triangles, state, profile, width, height):
    """The primitives of a mesh, without strokes; which of ``triangles``, its rows, each came from; the rows
    as clipping left them; and the sizes of points, a column.
    """
    vertex = state.vertex
    position = columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0))
    programmed = vertex.stage == VertexStage.PROGRAM_RESULTS
    eye = transform(vertex.modelview, position)
    normal = _eye_normal(mesh, vertex) if needs_normals(state) else None
    front, back = _vertex_colors(mesh, vertex, position, eye, normal, profile)
    two_side = back is not front
    composite = vertex.composite
    if composite is None:
        half_size, center = _viewport(vertex.viewport, width, height)
        clip_coordinates = transform(vertex.projection, eye)
    else:
        offset = [np.float64(np.float32(component)) for component in composite.offset]
        half_size, center = [ONE, ONE], offset[:2]
        clip_coordinates = transform_single(composite.matrix, position)

    columns = [
        *clip_coordinates,
        *(eye if vertex.clip_planes else ()),
        *front,
        *(back if two_side else ()),
        _fog(mesh, state, eye, profile),
        *_texture_coordinates(mesh, state, position, eye, normal),
        point_sizes(mesh, state, profile, eye) if draws_points(mesh, state.polygon) else ONE,
    ]
    polygons = mesh.primitive < PrimitiveType.POINTS
    if programmed:
        origin, dropped = np.arange(len(triangles)), 0
    else:
        clamped = state.depth_clamp is not None or composite is not None
        size = width, height
        planes = clip_planes(vertex.clip_planes, half_size, center, size, profile.guard_band, clamped)
        clipped = (clip if polygons else clip_lines)(triangles, columns, len(mesh.positions), planes)
        triangles, columns, origin, dropped = clipped
    count = max((len(column) for column in columns if column.ndim), default=len(mesh.positions))

    first_color = 8 if vertex.clip_planes else 4
    fog = first_color + (16 if two_side else 8)
    if programmed:
        x, y, z, inverse_w = *position[:3], _program_reciprocal(position[3])
    elif composite is not None:
        x, y, z, inverse_w = _composite_coordinates(columns[:4], offset, height)
    else:
        x, y, z, inverse_w = _window_coordinates(columns[:4], vertex.viewport, half_size, center)
    drawable = (inverse_w > 0) & np.isfinite(inverse_w) & np.isfinite(x) & np.isfinite(y) & np.isfinite(z)
    if not np.all(drawable):
        drawable = np.broadcast_to(drawable, count)
        lost = np.unique(origin[~drawable[triangles[:, :3]].all(axis=1)])
        kept = ~np.isin(origin, lost)
        triangles, origin = triangles[kept], origin[kept]
        dropped += len(lost)
    unclamped = vertex.depth_units or state.depth_clamp is not None
    if profile.device_origin == WindowOrigin.UPPER_LEFT:
        y = _snap(height - y, height, profile)
    else:
        y = (height << profile.subpixel_bits) - _snap(y, height, profile)
    if not state.perspective_correction:
        inverse_w = ONE
    primitives = WindowPrimitives(
        x=_filled(count, _snap(x, width, profile), np.int32),
        y=_filled(count, y, np.int32),
        z=_filled(count, z if unclamped else np.fmin(positive(z), ONE)),
        inverse_w=_filled(count, np.where(drawable, inverse_w, ONE)),
        colors=_colors(count, columns[first_color:fog], _color_bits(vertex, profile)),
        coordinates=_stacked(count, columns[fog + 1 : -1]),
        fog=_filled(count, columns[fog]),
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


class RasterVertex(NamedTuple):
    """The current raster position (section 2.12): window coordinates as they come, y up, and what is
    associated with them.

    x, y, z, inverse_w  floats; colors float64 [8], primary and secondary, and coordinates float64
    [units, 4], as in WindowPrimitives before they become whole numbers; fog: the fog coordinate
    """

    x: float
    y: float
    z: float
    inverse_w: float
    colors: np.ndarray
    coordinates: np.ndarray
    fog: float


def process_raster_position(mesh, state, profile, width, height):
    """The RasterVertex of a mesh's one vertex, or None where it is clipped away as a point is.

    Parameters and errors as ``process``'s; the vertex stage is the fixed function, without a composite.
    Source: OpenGL 1.2.1 section 2.12; clipped by the view volume itself, without a guard band.
    """
    vertex = state.vertex
    position = columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0))
    with np.errstate(all="ignore"):
        eye = transform(vertex.modelview, position)
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
        half_size, center = _viewport(vertex.viewport, width, height)
        window = _window_coordinates(clip_coordinates, vertex.viewport, half_size, center)
        window = [float(c) for column in window for c in np.broadcast_to(column, 1)]
        if not np.isfinite(window).all():
            return None
        normal = _eye_normal(mesh, vertex) if needs_normals(state) else None
        colors, _ = _vertex_colors(mesh, vertex, position, eye, normal, profile)
        coordinates = _texture_coordinates(mesh, state, position, eye, normal)
        fog = np.broadcast_to(_fog(mesh, state, eye, profile), 1)[0]
        return RasterVertex(
            *window,
            np.array([np.broadcast_to(c, 1)[0] for c in colors], np.float64),
            _stacked(1, coordinates)[0],
            float(fog),
        )


def _wrap_modes(sampler):
    return sampler.wrap_s, sampler.wrap_t, sampler.wrap_r


def _cylinder_wrapped(primitives, state):
    """The same triangles, none sharing a vertex, with the coordinates that ``cylinder_wrap`` names brought
    within one half of the first vertex's, by whole numbers, where they repeat.

    Measured: s under REPEAT is, t under MIRRORED_REPEAT is not (CylinderWrapping capture).
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


def _with_strokes(primitives, mesh, state, profile, clipped, origin, sizes):
    """The same primitives with their lines and points made.

    clipped int32 [k, 4]: the rows as clipping left them; origin int64 [k]: what it made them of; sizes: of
    points, a column.
    """
    if mesh.primitive == PrimitiveType.POINTS:
        primitives = with_strokes(primitives, C.PRIMITIVE_POINT)
    elif mesh.primitive > PrimitiveType.POINTS:
        groups = stipple_groups(mesh)[origin]
        return with_steps(with_strokes(primitives, C.PRIMITIVE_LINE), groups, state.line, profile)
    elif (state.polygon.front_mode, state.polygon.back_mode) == (PolygonMode.FILL, PolygonMode.FILL):
        return primitives
    else:
        boundary = _boundary(mesh, clipped, origin)
        rows, strokes, owners = outlined(
            primitives.triangles, boundary, primitives.x, primitives.y, state.polygon
        )
        primitives = replace(primitives, triangles=rows, strokes=strokes)
        groups = stipple_groups(mesh)[origin[owners]]
        primitives = with_steps(primitives, groups, state.line, profile)
    if not (primitives.strokes[:, 0] == C.PRIMITIVE_POINT).any():
        return primitives
    return with_squares(primitives, sizes, sprite_units(state), profile)


def _boundary(mesh, triangles, origin):
    """Which edges of each triangle bound a polygon; what clipping left of one is outlined whole."""
    boundary = boundary_edges(mesh)[origin]
    clipped = np.isin(origin, origin[(triangles[:, :3] >= len(mesh.positions)).any(axis=1)])
    begins, ends = np.diff(origin, prepend=-1) != 0, np.diff(origin, append=-1) != 0
    return np.where(clipped, 1 | np.where(ends, 2, 0) | np.where(begins, 4, 0), boundary)


def _program_reciprocal(w):
    """1/w of what a vertex program wrote. Of w from 0 to infinity it is clamped as RCC clamps: an infinite w
    weighs next to nothing, a w of 0 more than all else. Source: NV_vertex_program1_1; Measured: Front_face.
    """
    reciprocal = ONE / w
    clamped = np.fmin(np.fmax(reciprocal, np.float64(2.0**-64)), np.float64(2.0**64))
    return np.where(w >= 0, clamped, reciprocal)


def _eye_normal(mesh, vertex):
    """Section 2.10.3."""
    inverse = invert_upper_left(vertex.modelview)
    normal = columns_of(mesh.normals, (0.0, 0.0, 1.0))
    normal = [weighted_sum([inverse[row][j] for row in range(3)], normal) for j in range(3)]
    if vertex.rescale_normal:
        factor = ONE / length(inverse[2])
        normal = [component * factor for component in normal]
    if vertex.normalize:
        normal = normalize(normal)
    return normal


def _vertex_colors(mesh, vertex, position, eye, normal, profile):
    """Front and back colours, 8 columns each; one list if they are the same.

    They are clamped to [0, 1] (section 2.13.6) where the machine does that.
    """
    color = columns_of(mesh.colors, (1.0, 1.0, 1.0, 1.0))
    secondary = columns_of(mesh.secondary_colors, (0.0, 0.0, 0.0, 0.0))
    if vertex.lighting is None:
        front = back = color + secondary
        if vertex.two_side:
            black = (0.0, 0.0, 0.0, 1.0)
            back = columns_of(mesh.back_colors, black) + columns_of(mesh.back_secondary_colors, black)
    elif profile.lighting == LightingArithmetic.LIGHTING_UNIT:
        inverse = invert_upper_left(vertex.modelview) if vertex.lighting.lights else None
        given = columns_of(mesh.normals, (0.0, 0.0, 1.0))
        front, back = lighting_unit.light_vertices(vertex, inverse, position, given, color, secondary)
    else:
        front, back = light_vertices(vertex.lighting, eye, normal, color)
    if vertex.secondary_color != SecondaryColor.FROM_VERTEX:
        both = back is front
        front = lighting_unit.secondary_output(front, vertex.secondary_color)
        back = front if both else lighting_unit.secondary_output(back, vertex.secondary_color)
    if not _clamps_colors(profile):
        return front, back
    clamped = [np.fmin(positive(column), ONE) for column in front]
    return clamped, clamped if back is front else [np.fmin(positive(column), ONE) for column in back]


def _texture_coordinates(mesh, state, position, eye, normal):
    """s, t, r, q of unit 0, then of unit 1, ...; a disabled unit has (0, 0, 0, 1)."""
    modes = texgen_modes(state)
    reflection = _reflection(eye, normal) if not _REFLECTION_MODES.isdisjoint(modes) else None
    sphere = _sphere_map(reflection) if TexGenMode.SPHERE_MAP in modes else None
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
    """S and t of a sphere map; both are 1/2 where m is 0, in the direction that the map does not hold."""
    m = length([reflection[0], reflection[1], reflection[2] + ONE]) * np.float64(2.0)
    divisor = np.where(m == 0, ONE, m)
    return [reflection[axis] / divisor + np.float64(0.5) for axis in range(2)]


def _fog(mesh, state, eye, profile):
    """What is iterated for fog: the coordinate, or what the machine computes from it."""
    if state.fog is None:
        return ZERO
    coordinate = _fog_coordinate(mesh, state, eye)
    return (
        vertex_value(state.fog, coordinate) if profile.fog_arithmetic == FogArithmetic.TABLE else coordinate
    )


def _fog_coordinate(mesh, state, eye):
    fog, registers = state.fog, state.fog.registers
    own = ZERO if mesh.fog_coordinates is None else mesh.fog_coordinates
    if registers is None:
        return np.abs(eye[2]) if fog.coordinate_source == FogCoordinateSource.FRAGMENT_DEPTH else own
    generation = registers.generation
    if state.vertex.stage == VertexStage.PROGRAM_RESULTS or generation == FogGeneration.FOG_COORDINATE:
        coordinate = own
    elif generation == FogGeneration.SECONDARY_ALPHA:
        coordinate = columns_of(mesh.secondary_colors, (0.0, 0.0, 0.0, 0.0))[3]
    elif generation == FogGeneration.RADIAL:
        coordinate = length(eye[:3])
    else:
        coordinate = weighted_sum(registers.plane, eye)
    absolute = registers.absolute or generation == FogGeneration.ABSOLUTE_PLANAR
    return np.abs(coordinate) if absolute else coordinate


def _viewport(viewport, width, height):
    """Half the viewport's size and its middle, (x, y), in window coordinates with y up."""
    size = (
        width if viewport.width is None else viewport.width,
        height if viewport.height is None else viewport.height,
    )
    half_size = [np.float64(extent * 0.5) for extent in size]
    return half_size, [np.float64(viewport.x) + half_size[0], np.float64(viewport.y) + half_size[1]]


def _snap(device, extent, profile):
    """Truncate toward zero to the subpixel grid, after clamping (and a NaN) to the guard band."""
    low, high = np.float64(-profile.guard_band), np.float64(extent + profile.guard_band)
    steps = np.float64(1 << profile.subpixel_bits)
    return np.trunc(np.fmin(np.fmax(device, low), high) * steps)


def _window_coordinates(clip_coordinates, viewport, half_size, center):
    """Section 2.10.1: window x, y (up), z as they come, and 1 / w."""
    x, y, z, w = clip_coordinates
    near, far = np.float64(viewport.near), np.float64(viewport.far)
    return (
        (x / w) * half_size[0] + center[0],
        (y / w) * half_size[1] + center[1],
        (z / w) * ((far - near) * np.float64(0.5)) + (far + near) * np.float64(0.5),
        ONE / w,
    )


def _composite_coordinates(clip_coordinates, offset, height):
    """Window x, y (up), depth units and 1 / w; reciprocal, product and sum in single precision, truncated."""
    *coordinates, w = clip_coordinates
    reciprocal = keep_significant_bits(ONE / w, SINGLE_BITS)
    quotients = [keep_significant_bits(column * reciprocal, SINGLE_BITS) for column in coordinates]
    x, y, z = (keep_significant_bits(q + o, SINGLE_BITS) for q, o in zip(quotients, offset, strict=True))
    return x, height - y, z, ONE / w


def _colors(count, columns, significant_bits):
    """Front and back colours [count, 2, 8] of 8 columns (both sides the same) or 16.

    significant_bits: how many bits of a colour's mantissa are kept, the rest truncated, on its way from
    [0, 1] to a byte (section 2.13.9); None: the colours stay float64.
    """
    result = np.zeros((count, 2, 8), dtype=np.float64 if significant_bits is None else np.uint8)
    for index, column in enumerate(columns):
        if significant_bits is not None:
            column = _color_byte(column, significant_bits)
        result[:, index // 8, index % 8] = column
    if len(columns) == 8:
        result[:, 1] = result[:, 0]
    return result


def _color_byte(column, significant_bits):
    kept = keep_significant_bits(column, significant_bits)
    return np.floor(kept * np.float64(255.0) + np.float64(0.5))


def _filled(count, column, dtype=np.float64):
    """One C-contiguous array of count elements."""
    result = np.empty(count, dtype=dtype)
    result[:] = column
    return result


def _stacked(count, columns):
    """float64 [count, units, 4] of four columns for each unit."""
    result = np.empty((count, len(columns) // 4, 4))
    for index, column in enumerate(columns):
        result[:, index // 4, index % 4] = column
    return result
