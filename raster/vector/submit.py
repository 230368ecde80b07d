"""A Draw by one call: from a mesh's columns to the row of the vector engine's table that draws it.

It joins what ``fixedpipe.raster.primitives`` and ``fixedpipe.raster.vector.frame`` have a kernel each for:
vertices to window coordinates, clipping, depths, triangles sorted into bands, the job. A Draw of a hundred
vertices takes these kernels less time than Python takes to call one of them after the other.
"""

import math

from numba import float64, int32, int64, types, uint8

from fixedpipe.raster.arrays import Bands, Vertices
from fixedpipe.raster.kernel import bits_of, float_of, kernel
from fixedpipe.raster.primitives.bins import sort_triangles
from fixedpipe.raster.primitives.clip import clip_triangles, find_clipped
from fixedpipe.raster.primitives.vertices import (
    CLIPPED,
    FIRST_PROJECTIVE,
    UNUSUAL_W,
    single_depths,
    transform_vertices,
)
from fixedpipe.raster.vector.arrays import JOB, Pass, keep_bands, keep_pass, pass_of
from fixedpipe.raster.vector.frame import fill_vertices
from fixedpipe.raster.vector.unit import coordinate_facts

# What both kernels return where they made no job, in place of the number of entries in ``order``. PORTABLE:
# the portable engine draws it. OTHER_VARIANT - v: the template must be that of variant v. CLIPS - j: j
# triangles are clipped, or with j = 0: a 1/w is unusual, which neither kernel takes.
PORTABLE, OTHER_VARIANT, CLIPS = -1, -2, -64
ONE_COLOR = 1 << 4  # the bit of a variant beside those of the units whose q varies
INTERPOLATED = 12  # of a clipped vertex: clip coordinates and colours; the units' coordinates follow

_INTS, _LONGS, _FLOATS, _PLAN = int32[::1], int64[::1], float64[::1], int32[:, ::1]
_GIVEN = types.Array(float64, 2, "C", readonly=True)
_MESH = types.Tuple((_GIVEN, int32[:, ::1], uint8[:, :, ::1], float64[:, :, ::1]))
_FORMULA = types.Tuple((int32[:, ::1], float64[:, ::1], _INTS, _FLOATS))
_SCRATCH = types.Tuple((float64[:, ::1], _FLOATS, _LONGS, int64[:, ::1], _LONGS))
_MADE = types.Tuple((_INTS, _FLOATS))
_MADE_CLIPPED = types.Tuple((_INTS, _FLOATS, uint8[:, :, ::1], int32[:, ::1], _LONGS))
_MESH_CLIPPED = types.Tuple((*_MESH.types, _GIVEN, _GIVEN))
_FORMULA_CLIPPED = types.Tuple((*_FORMULA.types, _INTS))
_SCRATCH_CLIPPED = types.Tuple(
    (*_SCRATCH.types, _INTS, float64[:, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1])
)


@kernel
def depths_of(z, single_scale, depths):
    """Depths of vertices as a job takes them; ``single_scale`` as ``scale`` in ``submit``."""
    if single_scale:
        single_depths(z, float_of(single_scale), depths)
    else:
        for v in range(z.shape[0]):
            depths[v] = z[v]


@kernel
def fill_job(job, template, plan, triangles, vertices, facts, bands, scratch):
    """A job from its template, its plan, triangles, vertices and Bands; as ``submit`` returns."""
    ends, order = bands.ends, bands.order
    for entry in range(job.shape[0]):
        job[entry] = template[entry]
    p = pass_of(template)
    p = Pass(p.state, plan, triangles, vertices, p.textures)
    if not fill_vertices(job, p, facts):
        return int64(PORTABLE)
    needed = sort_triangles(triangles, vertices.x, vertices.y, p.state.draw, scratch, ends, order)
    keep_pass(job, p)
    keep_bands(job, Bands(order[: min(needed, order.shape[0])], ends))
    return needed


@kernel(int64(JOB, JOB, _PLAN, _MESH, _FORMULA, _MADE, types.UniTuple(int64, 5), _SCRATCH))
def submit(job, template, plan, mesh, formula, made, numbers, scratch):
    """Fill ``job`` for one Draw; returns how many entries its ``order`` needs, or why there is no job.

    template  a job of the same state but for constant colours, filled by ``frame.fill_draw``
    plan      the combiners' plan with the state's constant colours, as in a Pass
    mesh      (given, triangles, colors, coordinates): float64[k, n], the mesh's columns, as
              ``transform_vertices`` takes them; int32[t, 4]; uint8[n, 2, 8]; float64[n, units, 4]: the units'
              coordinates, or [n, 0, 4] where the formula computes them
    formula   (sums, coefficients, results, parameters), as ``transform_vertices`` takes them
    made      (ints, floats), which must outlive the job: int32[2 n + bands + order]: x, y, the bands' ends,
              and their triangles in order; float64[2 n + 4 n units]: 1/w, depths, computed coordinates
    numbers   bands; units whose coordinates the formula computes; the variant that the template is for: bits
              of the units whose q varies, and ONE_COLOR; the facts of given coordinates
              (``coordinate_facts``); the scale of depths in single precision, as its float64's bits, or 0
              where no depth is needed
    scratch   (columns, z, points, corners, left): float64[rows, CHUNK] and float64[n] for the vertices; then
              those of ``sort_triangles``

    Where ``order`` is too short, the job is void.
    """
    (given, triangles, colors, coordinates), (ints, floats) = mesh, made
    bands, units, variant, facts, scale = numbers
    columns, z, points, corners, left = scratch
    n = given.shape[1]
    x, y, ends, order = ints[:n], ints[n : 2 * n], ints[2 * n : 2 * n + bands], ints[2 * n + bands :]
    inverse_w, depths = floats[:n], floats[n : 2 * n]
    computed = floats[2 * n : 2 * n + 4 * n * units].reshape((n, units, 4))
    window = x, y, z[:n], inverse_w, computed, columns[:0]
    found = transform_vertices(given, formula, window, columns)
    if found & (CLIPPED | UNUSUAL_W):
        return CLIPS - (_count_clipped(triangles, inverse_w) if not found & UNUSUAL_W else int64(0))
    if units:
        varying = (found >> FIRST_PROJECTIVE) | (variant & ONE_COLOR)
        if varying != variant:
            return OTHER_VARIANT - varying
        coordinates, facts = computed, coordinate_facts(computed)
    depths_of(z[:n], scale, depths)
    vertices = Vertices(x, y, depths, inverse_w, colors, coordinates)
    return fill_job(
        job, template, plan, triangles, vertices, facts, Bands(order, ends), (points, corners, left)
    )


@kernel
def _count_clipped(triangles, inverse_w):
    count = int64(0)
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        count += int64((inverse_w[a] == 0.0) | (inverse_w[b] == 0.0) | (inverse_w[c] == 0.0))
    return count


@kernel
def _clamped_color(arrays, v, k):
    """Component k of a vertex's colours, clamped to [0, 1], as ``meshes.color_bytes`` has it."""
    colors, secondary = arrays
    value = 1.0 if k < 4 else 0.0
    if k < colors.shape[1]:
        value = colors[v, k]
    if 0 <= k - 4 < secondary.shape[1]:
        value = secondary[v, k - 4]
    return min(value if value > 0.0 else 0.0, 1.0)


@kernel
def variant_of(colors, coordinates):
    """The variant of vertices' colours and coordinates, as in ``submit``."""
    one_color, bits = True, int64(0)
    for v in range(colors.shape[0]):
        for k in range(8):
            one_color &= colors[v, 0, k] == colors[0, 0, k]
        for u in range(coordinates.shape[1]):
            bits |= int64(0) if coordinates[v, u, 3] == 1.0 else int64(1) << u
    return bits | (int64(ONE_COLOR) if one_color else int64(0))


@kernel(
    int64(
        JOB,
        JOB,
        _PLAN,
        _MESH_CLIPPED,
        _FORMULA_CLIPPED,
        _MADE_CLIPPED,
        types.UniTuple(int64, 5),
        _SCRATCH_CLIPPED,
    )
)
def submit_clipped(job, template, plan, mesh, formula, made, numbers, scratch):
    """As ``submit``, for a mesh of which j triangles are clipped; N is n + MOST_VERTICES j.

    mesh     as in ``submit``, then the mesh's colours and secondary colours, float64[n, 0..4] each
    formula  as in ``submit``, then int32[8]: twice the rows of clip x, y, z, w, the first four of its results
    made     (ints, floats, colors, triangles, counts), which must outlive the job: int32[2 N + bands +
             order]; float64[2 N + 4 N units]; uint8[N, 2, 8]; int32[t + MOST_VERTICES j, 4]; int64[1]:
             receives how many triangles were dropped, because a position is not usable
    numbers  bands; units whose coordinates the formula computes; the variant; the bits of a float64 that are
             kept of a colour; the scale of depths, as in ``submit``
    scratch  as in ``submit``, for N vertices and t + MOST_VERTICES j triangles; then for ``clip_triangles``,
             a = INTERPOLATED + 4 units: int32[j]; float64[3 j, a], [2, MOST_VERTICES, a], [MOST_VERTICES j,
             a]; clip coordinates float64[4, n]
    """
    given, triangles, mesh_colors, mesh_coordinates, primary, secondary = mesh
    ints, floats, colors, clipped, counts = made
    bands, units, variant, kept, scale = numbers
    columns, z, points, corners_of_chunk, left = scratch[:5]
    chosen, corners, polygons, values, clip_coordinates = scratch[5:]
    sums, coefficients, results, parameters, clip = formula
    n, most, all_units = given.shape[1], colors.shape[0], max(units, mesh_coordinates.shape[1])
    x, y, ends, order = (
        ints[:most],
        ints[most : 2 * most],
        ints[2 * most : 2 * most + bands],
        ints[2 * most + bands :],
    )
    inverse_w, depths, rest = floats[:most], floats[most : 2 * most], floats[2 * most :]
    coordinates = rest[: 4 * most * all_units].reshape((most, all_units, 4))
    window = x[:n], y[:n], z[:n], inverse_w[:n]
    computed, nothing = rest[: 4 * n * units].reshape((n, units, 4)), rest[:0].reshape((n, 0, 4))
    of_results = sums, coefficients, results, parameters
    found = transform_vertices(given, of_results, (*window, computed, columns[:0]), columns)
    of_clip = sums, coefficients, clip, parameters
    transform_vertices(given, of_clip, (*window, nothing, clip_coordinates), columns)
    find_clipped(triangles, inverse_w[:n], chosen)
    for v in range(n):
        for k in range(8):
            colors[v, 0, k] = colors[v, 1, k] = mesh_colors[v, 0, k]
        for u in range(mesh_coordinates.shape[1]):
            for k in range(4):
                coordinates[v, u, k] = mesh_coordinates[v, u, k]
    for j in range(chosen.shape[0]):
        for i in range(3):
            v, corner = triangles[chosen[j], i], corners[3 * j + i]
            for k in range(4):
                corner[k] = clip_coordinates[k, v]
            for k in range(8):
                corner[4 + k] = _clamped_color((primary, secondary), v, k)
            for u in range(all_units):
                for k in range(4):
                    corner[INTERPOLATED + 4 * u + k] = coordinates[v, u, k]
    new = values, x[n:], y[n:], z[n:], inverse_w[n:]
    count, added, counts[0], bits = clip_triangles(
        triangles, chosen, corners, parameters, n, polygons, new, clipped
    )
    if (found | bits) & UNUSUAL_W:
        return int64(CLIPS)
    for i in range(added):
        for k in range(8):
            cut = float_of(bits_of(values[i, 4 + k]) & kept)
            colors[n + i, 0, k] = colors[n + i, 1, k] = uint8(int64(math.floor(cut * 255.0 + 0.5)))
        for u in range(all_units):
            for k in range(4):
                coordinates[n + i, u, k] = values[i, INTERPOLATED + 4 * u + k]
    total = n + added
    varying = variant_of(colors[:total], coordinates[:total])
    if varying != variant:
        return OTHER_VARIANT - varying
    if count == 0:
        return int64(0)
    depths_of(z[:total], scale, depths[:total])
    vertices = Vertices(
        x[:total], y[:total], depths[:total], inverse_w[:total], colors[:total], coordinates[:total]
    )
    facts, into = coordinate_facts(coordinates[:total]), Bands(order, ends)
    return fill_job(
        job, template, plan, clipped[:count], vertices, facts, into, (points, corners_of_chunk, left)
    )
