"""Recording: which fragments a Draw has, and which of them passed the per-fragment tests.

A recorded job leaves no fragment out before it is shaded, gives each its own columns, and makes every row of
a triangle a run. So a run names the triangle and the pixel of all its fragments.
"""

from numba import boolean, int32, int64, types, uint8, void

from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import RUNS, plain
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from fixedpipe.raster.vector.arrays import JOB, JOBS, RECORD, Record, keep_record, record_of


@kernel(boolean(JOBS, int64, plain(RECORD)))
def record_job(jobs, k, record):
    """Record row k of ``jobs``, a Draw's, in a Record's arrays, which must outlive it; ``counts`` becomes 0.

    False, and nothing is recorded, where the arrays do not have a Record's shapes.
    """
    firsts, counts, rows = record
    if counts.shape[0] != firsts.shape[0] or rows.shape[1] != 4:
        return False
    for band in range(counts.shape[0]):
        counts[band] = 0
    job = jobs[k]
    job[R.JOB_RECORDED] = job[R.JOB_ROW_RUNS] = 1
    keep_record(job, Record(firsts, counts, rows))
    return True


@kernel(void(JOB, int64, RUNS, int32[::1], uint8[::1]))
def record_batch(job, drawn, runs, owners, alive):
    """Record a batch's fragments, of one band, in which ``drawn`` ones were before them.

    owners  int32[runs.count]: each run's triangle
    alive   uint8[.]: which fragments passed
    """
    separate_function()
    firsts, counts, rows = record_of(job)
    band = int64(runs.y[0]) // BAND_HEIGHT
    if band >= firsts.shape[0]:
        return
    first = firsts[band] + drawn
    for run in range(runs.count):
        for i in range(runs.starts[run], runs.starts[run + 1]):
            if first + i < rows.shape[0]:
                rows[first + i, 0] = owners[run]
                rows[first + i, 1] = runs.x[run] + int32(i - runs.starts[run])
                rows[first + i, 2] = runs.y[run]
                rows[first + i, 3] = int32(alive[i])
    counts[band] = drawn + runs.starts[runs.count]


@kernel(void(types.int64[::1], types.int64[::1], types.int32[:, ::1], types.int32[:, ::1]))
def in_columns(firsts, counts, rows, columns):
    """A Record's fragments, band after band, in ``columns`` int32[c, sum of counts], c of ``rows``."""
    separate_function()
    at = int64(0)
    for band in range(counts.shape[0]):
        first = firsts[band]
        for i in range(min(counts[band], rows.shape[0] - first)):
            for c in range(columns.shape[0]):
                columns[c, at + i] = rows[first + i, c]
        at += counts[band]
