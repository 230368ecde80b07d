"""Many Draws by one call: runs of one mesh in states that differ in matrices and constant colours alone."""

from numba import float64, int32, int64, types, uint8

from fixedpipe.raster.arrays import Bands, Vertices
from fixedpipe.raster.kernel import kernel
from fixedpipe.raster.primitives.vertices import CLIPPED, UNUSUAL_W, transform_vertices
from fixedpipe.raster.vector.arrays import JOB, JOBS
from fixedpipe.raster.vector.submit import (
    CLIPS,
    OTHER_VARIANT,
    PORTABLE,
    depths_of,
    fill_job,
    variant_of,
)
from fixedpipe.raster.vector.unit import coordinate_facts

# What ends a call before its last row, beside those of ``submit``: the arrays are too short for the next row.
NO_ROOM = -65

_GIVEN = types.Array(float64, 2, "C", readonly=True)
_MESH = types.Tuple((_GIVEN, int32[:, ::1], uint8[:, :, ::1], float64[:, :, ::1], int64[:, ::1]))
_FORMULA = types.Tuple((int32[:, ::1], float64[:, :, ::1], int32[::1], float64[::1]))
_PLANS = types.Tuple((int32[:, ::1], int64[:, ::1], int32[:, ::1], int32[:, :, ::1]))
_MADE = types.Tuple((int32[::1], float64[::1]))
_SCRATCH = types.Tuple((float64[:, ::1], float64[::1], int64[::1], int64[:, ::1], int64[::1], float64[::1]))


@kernel
def _fill_plan(filled, plan, where, values):
    for operation in range(plan.shape[0]):
        for entry in range(plan.shape[1]):
            filled[operation, entry] = plan[operation, entry]
    for k in range(where.shape[0]):
        filled[where[k, 0], where[k, 1]] = values[k]


@kernel(
    types.UniTuple(int64, 3)(JOBS, JOB, _PLANS, _MESH, _FORMULA, _MADE, types.UniTuple(int64, 3), _SCRATCH)
)
def submit_runs(jobs, template, plans, mesh, formula, made, numbers, scratch):
    """Fill ``jobs`` for the Draws of ``rows``, in order, until one needs more than this kernel does.

    template  as in ``submit``
    plans     (plan, where, values, made): the combiners' plan; int64[c, 2]: the places of constant colours in
              it; int32[rows, c]: their values for each row; int32[rows, operations, OPERATION_SIZE]: the
              rows' plans, which must outlive the jobs
    mesh      (given, triangles, colors, coordinates, rows): float64[n, k], the components of positions;
              int32[t, 4], counted from the first vertex of their run; uint8[n, 2, 8]; float64[n, units, 4];
              int64[rows, 4]: first vertex, vertices, first triangle, triangles
    formula   as in ``submit``, but coefficients float64[rows, m, 4]
    made      (ints, floats), which must outlive the jobs: for each row 2 n integers for x and y, the bands'
              ends and their triangles in order; and 2 n floats for 1/w and depths
    numbers   bands; the variant that the template is for; the scale of depths, as in ``submit``
    scratch   as in ``submit``, then float64[k * the largest n]

    Returns (how many rows are done, how many of these have a job, why the next one was not done: 0 where all
    were, NO_ROOM, or what ``submit`` returns).
    """
    (given, triangles, colors, coordinates, rows), (ints, floats) = mesh, made
    sums, coefficients, results, parameters = formula
    plan, where, values, own_plans = plans
    bands, variant, scale = numbers
    columns, z, points, corners, left, transposed = scratch
    components = given.shape[1]
    jobs_made, used_ints, used_floats = int64(0), int64(0), int64(0)
    for i in range(rows.shape[0]):
        first, n, begin, count = rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3]
        of_colors, of_coordinates = colors[first : first + n], coordinates[first : first + n]
        of_triangles = triangles[begin : begin + count]
        varying = variant_of(of_colors, of_coordinates)
        if varying != variant:
            return int64(i), jobs_made, OTHER_VARIANT - varying
        needed = 2 * n + bands + 2 * count + 4 * bands
        if used_ints + needed > ints.shape[0] or used_floats + 2 * n > floats.shape[0]:
            return int64(i), jobs_made, int64(NO_ROOM)
        of_ints, of_floats = ints[used_ints:], floats[used_floats:]
        x, y, ends, order = (
            of_ints[:n],
            of_ints[n : 2 * n],
            of_ints[2 * n : 2 * n + bands],
            of_ints[2 * n + bands : needed],
        )
        inverse_w, depths = of_floats[:n], of_floats[n : 2 * n]
        of_given = transposed[: components * n].reshape((components, n))
        for v in range(n):
            for k in range(components):
                of_given[k, v] = given[first + v, k]
        window = x, y, z[:n], inverse_w, floats[:0].reshape((n, 0, 4)), columns[:0]
        found = transform_vertices(of_given, (sums, coefficients[i], results, parameters), window, columns)
        if found & (CLIPPED | UNUSUAL_W):
            return int64(i), jobs_made, int64(CLIPS)
        depths_of(z[:n], scale, depths)
        vertices = Vertices(x, y, depths, inverse_w, of_colors, of_coordinates)
        facts, into = coordinate_facts(of_coordinates), Bands(order, ends)
        of_plan = plan
        if where.shape[0]:
            of_plan = own_plans[i]
            _fill_plan(of_plan, plan, where, values[i])
        job, of_sort = jobs[jobs_made], (points, corners, left)
        entries = fill_job(job, template, of_plan, of_triangles, vertices, facts, into, of_sort)
        if entries == PORTABLE:
            return int64(i), jobs_made, int64(PORTABLE)
        if entries > order.shape[0]:
            return int64(i), jobs_made, int64(NO_ROOM)
        if entries > 0:
            jobs_made += 1
            used_ints += needed
            used_floats += 2 * n
    return int64(rows.shape[0]), jobs_made, int64(0)
