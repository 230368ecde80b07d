"""Texture units of the vector engine: how each is sampled, and sampling a batch so."""

from numba import boolean, float64, int32, int64, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS, TEXTURES
from fixedpipe.raster.floats import TAU
from fixedpipe.raster.kernel import float_of, kernel, separate_function
from fixedpipe.raster.vector.arrays import JOB, SCRATCH, pass_of
from fixedpipe.raster.vector.coordinates import (
    Axis,
    cube_faces,
    depth_words,
    fixed_from_floats,
    iterate_floats,
    iterate_singles,
    iterate_texels,
)
from fixedpipe.raster.vector.footprint import sample_footprints
from fixedpipe.raster.vector.interpolate import (
    LARGEST_COORDINATE,
    LARGEST_FLOAT,
    LARGEST_REPEATED,
    Listed,
)
from fixedpipe.raster.vector.level_of_detail import level_of_detail
from fixedpipe.raster.vector.projective import (
    fixed_from_projected,
    fixed_from_singles,
    multiply,
    reciprocals_of_q,
)
from fixedpipe.raster.vector.sample import (
    fetch_compared,
    filter_located,
    filter_mipmapped,
    locate,
    move_to_faces,
)

LARGEST_SHADOW = 4096.0  # texels along an edge: 2**20 of their 256ths, whose floors are told apart
_WHITE = 0xFFFFFFFF  # packed: every component one


@kernel
def is_power(n):
    """Whether a positive integer is a power of two."""
    return (n & (n - 1)) == 0


@kernel
def log2_of(n):
    """The logarithm of a power of two."""
    k = int64(0)
    while (int64(1) << k) < n:
        k += 1
    return k


# Facts of a unit's coordinates, bits of ``coordinate_facts``; those of unit u are shifted by u FACTS. Units
# that have the same s and t follow: bit SAME_AS + k for unit k.
WITHIN_TEXELS, WITHIN_FLOATS, SAME_AS, FACTS = 1, 2, 2, 8


@kernel
def within(coordinates, unit, components, largest):
    """Whether the first coordinates of a unit are numbers up to ``largest``."""
    for v in range(coordinates.shape[0]):
        for c in range(components):
            if not abs(coordinates[v, unit, c]) <= largest:
                return False
    return True


@kernel
def same_coordinates(coordinates, one, other):
    """Whether two units have the same s and t at every vertex."""
    for v in range(coordinates.shape[0]):
        for c in range(2):
            if coordinates[v, one, c] != coordinates[v, other, c]:
                return False
    return True


@kernel(int64(float64[:, :, ::1]))
def coordinate_facts(coordinates):
    """What ``plan_units`` asks of the coordinates float64[n, units, 4]: bits, as above."""
    separate_function()
    facts = int64(0)
    for u in range(coordinates.shape[1]):
        found = int64(0)
        if within(coordinates, u, 2, LARGEST_COORDINATE):
            found |= WITHIN_TEXELS
        if within(coordinates, u, 4, LARGEST_FLOAT):
            found |= WITHIN_FLOATS
        for other in range(u):
            if same_coordinates(coordinates, other, u):
                found |= int64(1) << (SAME_AS + other)
        facts |= found << (FACTS * u)
    return facts


@kernel
def unit_path(row, levels, facts):
    """How a unit is sampled whose coordinates have these facts."""
    if not row[R.ENABLED]:
        return int64(C.PATH_DISABLED)
    target = row[R.TARGET]
    if target == C.TARGET_3D or row[R.HILO] or row[R.COLORLESS] or row[R.OPERATION]:
        return int64(C.PATH_PORTABLE)
    footprint = row[R.ANISOTROPY] != 0 or row[R.PROBES] != 0
    if footprint and (target != C.TARGET_2D or row[R.SIGNED]):
        return int64(C.PATH_PORTABLE)
    if row[R.COMPARE] and (row[R.COMPARE_HELD] != _WHITE or row[R.COMPARE_FAILED] != 0):
        return int64(C.PATH_PORTABLE)
    nearest = not row[R.MAG_LINEAR] and not row[R.MIN_LINEAR]
    for axis in range(2):
        wrap = row[R.WRAP_S] if axis == 0 else row[R.WRAP_T]
        usual = wrap == C.WRAP_REPEAT or wrap == C.WRAP_CLAMP_TO_EDGE
        usual = usual or (wrap == C.WRAP_CLAMP and nearest and not footprint)
        if target != C.TARGET_CUBE_MAP and not usual:
            return int64(C.PATH_PORTABLE)
    one_level = row[R.MIPMAP] == C.MIPMAP_NONE and row[R.MAG_LINEAR] == row[R.MIN_LINEAR]
    width, height = int64(levels[0, 1]), int64(levels[0, 2])
    largest = int64(1) << LARGEST_REPEATED
    plain = target == C.TARGET_1D or target == C.TARGET_2D
    plain = plain and not row[R.PROJECTIVE] and not row[R.COMPARE]
    plain = plain and is_power(width) and is_power(height) and width <= largest and height <= largest
    if plain and facts & WITHIN_TEXELS:
        if footprint:
            return int64(C.PATH_FOOTPRINT)
        return int64(C.PATH_ITERATED) if one_level else int64(C.PATH_MIPMAPPED)
    if one_level and not footprint and facts & WITHIN_FLOATS:
        return int64(C.PATH_COMPUTED)
    return int64(C.PATH_PORTABLE)


@kernel
def components_of(row, path):
    """Which coordinates a unit iterates: bits 1, 2, 4, 8 for s, t, r, q."""
    if path != C.PATH_COMPUTED:
        return int64(3)
    compares_r = row[R.COMPARE] == C.COMPARE_MODE_R_TO_TEXTURE
    third = int64(4) if row[R.TARGET] == C.TARGET_CUBE_MAP or compares_r else int64(0)
    return int64(3) | third | (int64(8) if row[R.PROJECTIVE] else int64(0))


@kernel(boolean(JOB, int64[::1], TEXTURES, int64))
def plan_units(job, draw, textures, facts):
    """Fill in how a Draw's units are sampled; False where one of them is the portable engine's.

    ``facts`` of the units' coordinates are the result of ``coordinate_facts``.
    """
    separate_function()
    units, levels = textures.units, textures.levels
    for u in range(4):
        job[R.JOB_UNIT_PATH + u] = job[R.JOB_COMPONENTS + u] = job[R.JOB_COORDINATES_OF + u] = 0
        job[R.JOB_LOG2_S + u] = job[R.JOB_LOG2_T + u] = 0
    if not draw[R.NEEDS_COLOR]:
        return True
    for u in range(draw[R.UNITS]):
        known = facts >> (FACTS * u)
        path = unit_path(units[u], levels[u], known)
        job[R.JOB_UNIT_PATH + u] = path
        if path == C.PATH_PORTABLE:
            return False
        if path == C.PATH_DISABLED:
            continue
        job[R.JOB_COMPONENTS + u] = components_of(units[u], path)
        if path == C.PATH_COMPUTED or path == C.PATH_FOOTPRINT:
            continue
        job[R.JOB_LOG2_S + u] = log2_of(int64(levels[u, 0, 1]))
        job[R.JOB_LOG2_T + u] = log2_of(int64(levels[u, 0, 2]))
        job[R.JOB_COORDINATES_OF + u] = u
        for other in range(u):
            same = job[R.JOB_UNIT_PATH + other] == path
            same = same and job[R.JOB_LOG2_S + other] == job[R.JOB_LOG2_S + u]
            same = same and job[R.JOB_LOG2_T + other] == job[R.JOB_LOG2_T + u]
            for field in (R.WRAP_S, R.WRAP_T, R.MAG_LINEAR, R.TARGET):
                same = same and units[other, field] == units[u, field]
            if same and known & (int64(1) << (SAME_AS + other)):
                job[R.JOB_COORDINATES_OF + u], job[R.JOB_COMPONENTS + u] = other, 0
                break
    return True


@kernel
def is_usual_shadow(row, levels):
    """Whether a unit is the usual shadow map: its quotients need not be known to their last bit."""
    edge, largest = int64(C.WRAP_CLAMP_TO_EDGE), max(float64(levels[0, 1]), float64(levels[0, 2]))
    compares = row[R.COMPARE] == C.COMPARE_MODE_R_TO_TEXTURE and row[R.DEPTH_TEXEL_FORMAT] == C.DEPTH_FIXED
    plain = row[R.TARGET] == C.TARGET_2D and row[R.PROJECTIVE] != 0 and row[R.MAG_LINEAR] != 0
    to_edges = row[R.WRAP_S] == edge and row[R.WRAP_T] == edge
    return compares and plain and to_edges and largest <= LARGEST_SHADOW


@kernel(void(JOB, int64, int64, int64, SCRATCH))
def sample_shadow(job, u, count, segments, scratch):
    """A unit that ``is_usual_shadow``."""
    separate_function()
    p = pass_of(job)
    triangles, coordinates = p.triangles, p.vertices.coordinates
    row, levels, floats, ints = p.textures.units[u], p.textures.levels[u], scratch.floats, scratch.ints
    singles, located, listed = scratch.singles, scratch.located[u], Listed(scratch.lists, segments)
    made = ints[R.FIXED0 + 2 * u], ints[R.FIXED0 + 2 * u + 1], ints[R.REFERENCE]
    sizes = float64(levels[0, 1]), float64(levels[0, 2]), float_of(row[R.COORDINATE_DEPTH])
    largest, is_made = float64(row[R.DEPTH_TEXEL_MAX]), False
    if iterate_singles(listed, triangles, coordinates, u, singles):
        is_made = fixed_from_singles(singles, made, sizes, largest, count)
    if not is_made:
        s, t, r, q = floats[R.S], floats[R.T], floats[R.COORDINATE0], floats[R.EXTRA]
        iterate_floats(listed, triangles, coordinates, u, 0, floats, singles, s)
        iterate_floats(listed, triangles, coordinates, u, 1, floats, singles, t)
        iterate_floats(listed, triangles, coordinates, u, 2, floats, singles, r)
        iterate_floats(listed, triangles, coordinates, u, 3, floats, singles, q)
        fixed_from_projected((s, t, r, q), singles, made, sizes, largest, count)
    locate(levels, row, made[0], made[1], count, located)
    plane, function = (C.REGISTER_TEXTURE0 + u) * 4, row[R.COMPARE_FUNCTION]
    fetch_compared(p.textures.texels[u], located, made[2], function, count, scratch.planes, plane)


@kernel(void(JOB, int64, int64, int64, SCRATCH))
def sample_computed(job, u, count, segments, scratch):
    """A unit whose coordinates are computed from the iterated ones."""
    separate_function()
    p = pass_of(job)
    triangles, coordinates = p.triangles, p.vertices.coordinates
    row, levels, floats, ints = p.textures.units[u], p.textures.levels[u], scratch.floats, scratch.ints
    if is_usual_shadow(row, levels):
        sample_shadow(job, u, count, segments, scratch)
        return
    singles, width, height = scratch.singles, float64(levels[0, 1]), float64(levels[0, 2])
    located, f_s, f_t = scratch.located[u], ints[R.FIXED0 + 2 * u], ints[R.FIXED0 + 2 * u + 1]
    s, t, extra, r = floats[R.S], floats[R.T], floats[R.EXTRA], floats[R.COORDINATE0]
    cube, projective = row[R.TARGET] == C.TARGET_CUBE_MAP, row[R.PROJECTIVE] != 0
    compared, listed = row[R.COMPARE] != C.COMPARE_MODE_NONE, Listed(scratch.lists, segments)
    edge = int64(C.WRAP_CLAMP_TO_EDGE)
    iterate_floats(listed, triangles, coordinates, u, 0, floats, singles, s)
    iterate_floats(listed, triangles, coordinates, u, 1, floats, singles, t)
    if cube:
        iterate_floats(listed, triangles, coordinates, u, 2, floats, singles, extra)
        cube_faces(s, t, extra, ints[R.FACE], count)
    elif projective:
        iterate_floats(listed, triangles, coordinates, u, 3, floats, singles, extra)
    if projective and not cube:
        reciprocals_of_q(extra, count)
        multiply(s, extra, count)
        multiply(t, extra, count)
    if compared:
        if row[R.COMPARE] == C.COMPARE_MODE_R_TO_TEXTURE:
            iterate_floats(listed, triangles, coordinates, u, 2, floats, singles, r)
            if projective:
                multiply(r, extra, count)
        else:
            r[:count] = 0.0
        scale, depth_format = float_of(row[R.COORDINATE_DEPTH]), row[R.DEPTH_TEXEL_FORMAT]
        depth_words(r, ints[R.REFERENCE], scale, depth_format, int32(row[R.DEPTH_TEXEL_MAX]), count)
    bias = TAU if cube else 0.0
    scale = 0.5 if cube else (0.0 if row[R.TARGET] == C.TARGET_RECTANGLE else 1.0)
    wrap_s, wrap_t = (edge, edge) if cube else (row[R.WRAP_S], row[R.WRAP_T])
    linear = row[R.MAG_LINEAR]
    fixed_from_floats(s, f_s, width, bias, scale, wrap_s, linear, count)
    fixed_from_floats(t, f_t, height, bias, scale, wrap_t, linear, count)
    locate(levels, row, f_s, f_t, count, located)
    if cube:
        move_to_faces(levels, ints[R.FACE], count, located)
    pairs = p.textures.texels[u]
    plane = (C.REGISTER_TEXTURE0 + u) * 4
    if compared:
        function = row[R.COMPARE_FUNCTION]
        fetch_compared(pairs, located, ints[R.REFERENCE], function, count, scratch.planes, plane)
    else:
        filter_located(pairs, row, located, count, scratch.planes, plane)


@kernel(void(JOB, int64, int64, int64, RUNS, SCRATCH))
def sample(job, u, count, segments, runs, scratch):
    """Texture unit ``u`` of a batch into its register's planes."""
    separate_function()
    p = pass_of(job)
    path, row = job[R.JOB_UNIT_PATH + u], p.textures.units[u]
    triangles, coordinates = p.triangles, p.vertices.coordinates
    floats, ints, planes, plane = scratch.floats, scratch.ints, scratch.planes, (C.REGISTER_TEXTURE0 + u) * 4
    if path == C.PATH_DISABLED:
        return
    if path == C.PATH_COMPUTED:
        sample_computed(job, u, count, segments, scratch)
        return
    if path == C.PATH_FOOTPRINT:
        sample_footprints(job, u, count, segments, runs, scratch)
        return
    source, levels = job[R.JOB_COORDINATES_OF + u], p.textures.levels[u]
    f_s, f_t = ints[R.FIXED0 + 2 * source], ints[R.FIXED0 + 2 * source + 1]
    if source == u:
        listed = Listed(scratch.lists, segments)
        along_s = Axis(u, int64(0), job[R.JOB_LOG2_S + u], int64(row[R.WRAP_S] == C.WRAP_REPEAT))
        along_t = Axis(u, int64(1), job[R.JOB_LOG2_T + u], int64(row[R.WRAP_T] == C.WRAP_REPEAT))
        iterate_texels(listed, triangles, coordinates, along_s, floats, scratch.singles, f_s)
        iterate_texels(listed, triangles, coordinates, along_t, floats, scratch.singles, f_t)
        if path == C.PATH_ITERATED:
            locate(levels, row, f_s, f_t, count, scratch.located[u])
    pairs = p.textures.texels[u]
    if path == C.PATH_ITERATED:
        filter_located(pairs, row, scratch.located[source], count, planes, plane)
        return
    room = ints[R.FACE], ints[R.LEVEL]
    level_of_detail(runs, triangles, p.vertices, u, row, levels, ints, room)
    fixed = f_s, f_t, ints[R.LOD]
    filter_mipmapped(pairs, levels, row, fixed, count, scratch.located[u], planes, plane)
