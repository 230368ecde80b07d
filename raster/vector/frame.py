"""The vector engine: every queued Clear and Draw of a frame, band by band of rows.

A frame's commands wait in a table of jobs, each a row of numbers and addresses (``rows.JOB_KIND`` and what
follows). Each thread takes the next band that nobody has and runs all jobs on its rows, in order, so a band
stays in the processor's nearest memory from the first Clear to the last Draw, and no pixel is ever two
threads'. A Draw that ``fill_draw`` refuses goes to the portable engine (``fixedpipe.raster.portable.draw``),
which gives the same bits.
"""

from numba import boolean, int64, types, uint8, uint32, void

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.arrays import BANDS, BUFFERS, as_bands, plain
from fixedpipe.raster.kernel import kernel, next_of, separate_function, separate_loop
from fixedpipe.raster.portable.check import usable_levels
from fixedpipe.raster.primitives.bins import BAND_HEIGHT
from fixedpipe.raster.vector.arrays import (
    JOBS,
    PASS,
    SCRATCH,
    as_pass,
    bands_of,
    keep_bands,
    keep_pass,
)
from fixedpipe.raster.vector.band import draw_band
from fixedpipe.raster.vector.check import usable_job
from fixedpipe.raster.vector.unit import coordinate_facts, plan_units


@kernel(void(JOBS, int64, types.UniTuple(int64, 4), int64, types.UniTuple(int64, 5)))
def fill_clear(jobs, k, box, buffers, words):
    """Row k of ``jobs``: clear a box of device pixels.

    box      x0, y0, x1, y1: [x0, x1) x [y0, y1)
    buffers  bits, codes.BUFFER_...
    words    a packed colour and its mask, a depth word, a stencil byte and its mask, as stored
    """
    job = jobs[k]
    job[R.JOB_KIND] = C.JOB_CLEAR
    job[R.JOB_X0], job[R.JOB_Y0], job[R.JOB_X1], job[R.JOB_Y1] = box
    job[R.JOB_BUFFERS] = buffers
    color, color_mask, depth, stencil, stencil_mask = words
    job[R.JOB_COLOR], job[R.JOB_COLOR_MASK] = color, color_mask
    job[R.JOB_DEPTH], job[R.JOB_STENCIL], job[R.JOB_STENCIL_MASK] = depth, stencil, stencil_mask


@kernel
def fill_vertices(job, p, facts):
    """The entries of a job that depend on the vertices of its Pass; False where the portable engine draws it.

    ``facts`` of the units' coordinates are the result of ``coordinate_facts``.
    """
    draw, textures, inverse_w = p.state.draw, p.textures, p.vertices.inverse_w
    if not plan_units(job, draw, textures, facts):
        return False
    job[R.JOB_ROW_RUNS] = job[R.JOB_RECORDED] = 0
    for u in range(4):
        path = job[R.JOB_UNIT_PATH + u]
        if path == C.PATH_MIPMAPPED or path == C.PATH_FOOTPRINT:
            job[R.JOB_ROW_RUNS] = 1
    perspective = False
    for v in range(inverse_w.shape[0]):
        if inverse_w[v] < 0.0:  # its triangles go through infinity
            return False
        perspective = perspective or inverse_w[v] != inverse_w[0]
    job[R.JOB_PERSPECTIVE] = perspective
    textured = False
    for u in range(draw[R.UNITS]):
        textured = textured or job[R.JOB_COMPONENTS + u] != 0
    job[R.JOB_OF_COLORS] = draw[R.NEEDS_ITERATION_WEIGHTS] != 0 and not (textured or perspective)
    job[R.JOB_USABLE] = 1
    for u in range(draw[R.UNITS]):
        size, reads = textures.texels[u].shape[0], job[R.JOB_UNIT_PATH + u] != C.PATH_DISABLED
        if reads and not usable_levels(textures.units[u], textures.levels[u], size, True):
            job[R.JOB_USABLE] = 0
    return True


@kernel(boolean(JOBS, int64, plain(PASS), plain(BANDS)))
def fill_draw(jobs, k, arrays, bands):
    """Row k of ``jobs`` from a Draw's arrays, which must outlive it: those of a Pass and of Bands, in plain
    tuples. False where the vector engine does not cover the Draw, or where its arrays would lead a kernel
    outside of them (``fixedpipe.raster.vector.check``).
    """
    p = as_pass(arrays)
    if not usable_job(p):
        return False
    draw = p.state.draw
    unusual = (
        draw[R.STROKES] | draw[R.STIPPLE] | draw[R.WINDOW_CLIP] | draw[R.W_BUFFERING] | draw[R.DEPTH_FORMAT]
    ) | (draw[R.DEPTH_CULL] | draw[R.FOG_ENABLED] | draw[R.TEXTURE_SHADER] | draw[R.DISCARDS] | draw[R.YCBCR])
    if unusual or draw[R.NEEDS_WEIGHTS] or draw[R.NEEDS_COLOR_WEIGHTS] == C.WEIGHTS_EXACT:
        return False
    job = jobs[k]
    job[R.JOB_KIND] = C.JOB_DRAW
    for edge in range(4):
        job[R.JOB_X0 + edge] = draw[R.X0 + edge]
    job[R.JOB_ONE_COLOR] = draw[R.FLAT] == C.COLORS_EQUAL and draw[R.BACK_SIGN] == 0
    if not fill_vertices(job, p, coordinate_facts(p.vertices.coordinates)):
        return False
    keep_bands(job, as_bands(bands))
    keep_pass(job, p)
    return True


@kernel
def fits(job, height, width):
    """Whether a job's pixels are the framebuffer's, and its textures there."""
    inside = 0 <= job[R.JOB_X0] <= width and 0 <= job[R.JOB_X1] <= width
    inside = inside and 0 <= job[R.JOB_Y0] <= height and 0 <= job[R.JOB_Y1] <= height
    return inside and (job[R.JOB_KIND] == C.JOB_CLEAR or job[R.JOB_USABLE] != 0)


@kernel("void(u4[::1],u4,u4)")
def clear_words(words, value, mask):
    """Words to a value, through a mask."""
    separate_loop()
    if mask == uint32(0xFFFFFFFF):
        for i in range(words.shape[0]):
            words[i] = value
    else:
        for i in range(words.shape[0]):
            words[i] = uint32(uint32(words[i] & uint32(~mask)) | uint32(value & mask))


@kernel("void(u1[::1],u1,u1)")
def clear_bytes(bytes_, value, mask):
    """Bytes to a value, through a mask."""
    separate_loop()
    for i in range(bytes_.shape[0]):
        bytes_[i] = uint8(uint8(bytes_[i] & uint8(~mask)) | uint8(value & mask))


@kernel("void(i8[::1],i8,u4[:,::1],u4[:,::1],u1[:,::1])")
def clear_band(job, band, color, depth_buffer, stencil):
    """A Clear's part of one band."""
    separate_function()
    x0, x1, buffers = job[R.JOB_X0], job[R.JOB_X1], job[R.JOB_BUFFERS]
    top, bottom = max(band * BAND_HEIGHT, job[R.JOB_Y0]), min((band + 1) * BAND_HEIGHT, job[R.JOB_Y1])
    for y in range(top, bottom):
        if buffers & C.BUFFER_COLOR:
            clear_words(color[y, x0:x1], uint32(job[R.JOB_COLOR]), uint32(job[R.JOB_COLOR_MASK]))
        if buffers & C.BUFFER_DEPTH:
            clear_words(depth_buffer[y, x0:x1], uint32(job[R.JOB_DEPTH]), uint32(0xFFFFFFFF))
        if buffers & C.BUFFER_STENCIL:
            clear_bytes(stencil[y, x0:x1], uint8(job[R.JOB_STENCIL]), uint8(job[R.JOB_STENCIL_MASK]))


@kernel(int64(JOBS, int64, int64[::1], int64, BUFFERS, SCRATCH))
def draw_frame(jobs, count, counter, batch, buffers, scratch):
    """Run the first ``count`` jobs on every band that ``counter`` int64[1] still gives.

    Threads that share a frame call this with one counter, which began at 0, and each its own Scratch of at
    least ``batch`` columns. Returns how many fragments this call drew. A job that is larger than the
    framebuffer, or whose textures are not there, is left out.
    """
    fragments = int64(0)
    height, width = buffers.color.shape
    bands = (int64(height) + BAND_HEIGHT - 1) // BAND_HEIGHT
    band = next_of(counter)
    while band < bands:
        for k in range(count):
            job = jobs[k]
            if not fits(job, height, width):
                continue
            if job[R.JOB_KIND] == C.JOB_CLEAR:
                clear_band(job, band, buffers.color, buffers.depth, buffers.stencil)
                continue
            order, ends = bands_of(job)
            if ends.shape[0] < bands:
                continue
            begin, end = int64(ends[band - 1]) if band > 0 else int64(0), int64(ends[band])
            if begin < end:
                fragments += draw_band(job, order[begin:end], band, batch, buffers, scratch)
        band = next_of(counter)
    return fragments
