"""A Draw by one call: from a mesh's columns to the row of the vector engine's table that draws it.

It joins what ``fixedpipe.raster.primitives`` and ``fixedpipe.raster.vector.frame`` have a kernel each for:
vertices to window coordinates, depths, triangles sorted into bands, the job. A Draw of a hundred vertices
takes these kernels less time than Python takes to call one of them after the other.
"""

from numba import float64, int32, int64, types

from fixedpipe.raster.arrays import Bands, Vertices
from fixedpipe.raster.kernel import float_of, kernel
from fixedpipe.raster.primitives.bins import sort_triangles
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

# What submit returns where it made no job, in place of the number of entries in ``order``.
CLIPS, PORTABLE, OTHER_PROJECTIVE = -1, -2, -3

_INTS, _LONGS, _FLOATS = int32[::1], int64[::1], float64[::1]
_MESH = types.Tuple(
    (
        types.Array(float64, 2, "C", readonly=True),
        int32[:, ::1],
        types.uint8[:, :, ::1],
        float64[:, :, ::1],
    )
)
_FORMULA = types.Tuple((int32[:, ::1], float64[:, ::1], _INTS, _FLOATS))
_MADE = types.Tuple((_INTS, _FLOATS))
_SCRATCH = types.Tuple((float64[:, ::1], _FLOATS, _LONGS, int64[:, ::1], _LONGS))


@kernel(
    int64(
        JOB,
        JOB,
        int32[:, ::1],
        _MESH,
        _FORMULA,
        types.Tuple((_INTS, _FLOATS)),
        types.UniTuple(int64, 5),
        _SCRATCH,
    )
)
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
    numbers   bands; units whose coordinates the formula computes; bits of those whose q varies, which the
              template is for; the facts of given coordinates (``coordinate_facts``); the scale of depths in
              single precision, as its float64's bits, or 0 where no depth is needed
    scratch   (columns, z, points, corners, left): float64[rows, CHUNK] and float64[n] for the vertices; then
              those of ``sort_triangles``

    CLIPS: a vertex lies outside a clipping plane, or its 1/w is unusual. PORTABLE: the portable engine draws
    it. OTHER_PROJECTIVE - bits: the template must be for units whose q varies as these bits say. Where
    ``order`` is too short, the job is void.
    """
    (given, triangles, colors, coordinates), (ints, floats) = mesh, made
    bands, units, projective, facts, scale = numbers
    columns, z, points, corners, left = scratch
    n = given.shape[1]
    x, y, ends, order = ints[:n], ints[n : 2 * n], ints[2 * n : 2 * n + bands], ints[2 * n + bands :]
    inverse_w, depths = floats[:n], floats[n : 2 * n]
    computed = floats[2 * n : 2 * n + 4 * n * units].reshape((n, units, 4))
    window = x, y, z[:n], inverse_w, computed, columns[:0]
    found = transform_vertices(given, formula, window, columns)
    if found & (CLIPPED | UNUSUAL_W):
        return int64(CLIPS)
    if units:
        if found >> FIRST_PROJECTIVE != projective:
            return OTHER_PROJECTIVE - (found >> FIRST_PROJECTIVE)
        coordinates, facts = computed, coordinate_facts(computed)
    if scale != 0:
        single_depths(z[:n], float_of(scale), depths)
    else:
        for v in range(n):
            depths[v] = z[v]
    for entry in range(job.shape[0]):
        job[entry] = template[entry]
    p = pass_of(template)
    p = Pass(p.state, plan, triangles, Vertices(x, y, depths, inverse_w, colors, coordinates), p.textures)
    if not fill_vertices(job, p, facts):
        return int64(PORTABLE)
    needed = sort_triangles(triangles, x, y, p.state.draw, (points, corners, left), ends, order)
    keep_pass(job, p)
    keep_bands(job, Bands(order[: min(needed, order.shape[0])], ends))
    return needed
