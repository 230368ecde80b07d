"""Whether a Draw's rows and combiner plan keep the vector engine's kernels inside their arrays, whoever wrote
them. ``fixedpipe.raster.portable.check`` looks at what both engines read.
"""

from numba import boolean

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel
from fixedpipe.raster.portable.check import usable_units
from fixedpipe.raster.vector.arrays import PASS
from fixedpipe.raster.vector.combine import (
    OPERANDS,
    OPERATION,
    OPERATION_SIZE,
    PLANES,
    SCRATCH_PLANES,
    SECOND,
    TARGET,
)


@kernel
def usable_plan(plan):
    """Whether a combiner plan's operations are some and read and write planes that there are."""
    if plan.shape[1] != OPERATION_SIZE:
        return False
    for k in range(plan.shape[0]):
        row = plan[k]
        if row[OPERATION] < 0 or row[OPERATION] > C.PLAN_FINISH:
            return False
        # The last five work on scratch planes, FINISH to a register's.
        rare = C.PLAN_MULTIPLY <= row[OPERATION] < C.PLAN_FINISH
        if row[TARGET] < 0 or row[TARGET] >= (SCRATCH_PLANES - 2 if rare else PLANES):
            return False
        if row[SECOND] < 0 or row[SECOND] >= SCRATCH_PLANES:
            return False
        for operand in range(6):
            if row[OPERANDS + R.INPUT_SIZE * operand] < 0 or row[OPERANDS + R.INPUT_SIZE * operand] >= PLANES:
                return False
    return True


@kernel(boolean(PASS))
def usable_job(p):
    """As ``fixedpipe.raster.portable.check.usable``, for the vector engine, but for box and texels, which
    rows.JOB_USABLE and ``frame.draw_frame`` are about.
    """
    (draw, draw_float, factors), vertices = p.state, p.vertices
    count, colors, coordinates = vertices.x.shape[0], vertices.colors, vertices.coordinates
    if draw.shape[0] < R.DRAW_SIZE or draw_float.shape[0] < R.DRAW_FLOAT_SIZE or p.triangles.shape[1] != 4:
        return False
    if factors.shape[0] < 2 or factors.shape[1] != 4 * R.FACTOR_SIZE or vertices.inverse_w.shape[0] < count:
        return False
    if colors.shape[0] < count or colors.shape[1] != 2 or colors.shape[2] != 8:
        return False
    if coordinates.shape[0] < count or coordinates.shape[2] != 4 or coordinates.shape[1] < draw[R.UNITS]:
        return False
    return usable_plan(p.plan) and usable_units(draw, p.textures)
