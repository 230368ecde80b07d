"""Lines and points: which pixels they draw, and how far along a line they lie (docs/numbers.md, section 11).

Integers only, in 1/16 pixel. A line's row of ``triangles`` is its second vertex, then its first, twice: with
n0 how far along a pixel lies, n1 = 0 and n2 the rest, everything is iterated as in a triangle. A point's row
is the lower left, lower right and upper right corner of its square, whose edge functions serve the same way.
"""

from numba import int64

from raster import rows as R
from raster.kernel import kernel


@kernel
def along_line(draw, x0, y0, x1, y1, sx, sy):
    """(n0, n2) of a sample of the line from vertex 1 to vertex 0; their sum is the line's length, squared
    where it is a rectangle.

    Measured: Line_width and Edge_flag captures (rectangles), 3D_primitive Lines (steps): every pixel.
    """
    dx, dy = x0 - x1, y0 - y1
    if not draw[R.LINE_STEPS]:
        n0 = (sx - x1) * dx + (sy - y1) * dy
        return n0, dx * dx + dy * dy - n0
    # The pixel's far edge, along the longer axis.
    if abs(dx) >= abs(dy):
        n0 = (sx + 8 - x1) if dx > 0 else (x1 - (sx - 8))
    else:
        n0 = (sy + 8 - y1) if dy > 0 else (y1 - (sy - 8))
    return n0, max(abs(dx), abs(dy)) - n0


@kernel
def owned(nx, ny):
    """0 where a line draws the samples on an edge whose outward normal is (nx, ny), -1 where it does not: to
    the right and to the top it does.

    Measured: Line_width captures, 2123 pixels on edges.
    """
    return int64(0) if nx > 0 or (nx == 0 and ny < 0) else int64(-1)


@kernel
def line_bounds(draw, x0, y0, x1, y1, sx, sy):
    """Four values that are all >= 0 where the line draws the sample: behind its start, before its end, and to
    its two sides.
    """
    dx, dy = x0 - x1, y0 - y1
    longer, shorter = max(abs(dx), abs(dy)), min(abs(dx), abs(dy))
    width = draw[R.LINE_WIDTH]
    across = 2 * ((sy - y1) * dx - (sx - x1) * dy)
    if draw[R.LINE_STEPS]:
        start, end, position = (y1 >> 4) * 16, (y0 >> 4) * 16, sy - 8
        forward = dy > 0
        if abs(dx) >= abs(dy):
            start, end, position = (x1 >> 4) * 16, (x0 >> 4) * 16, sx - 8
            forward = dx > 0
        behind = position - start if forward else start - position
        before = end - position - 1 if forward else position - end - 1
        half = width * 2 * longer
    else:
        behind = (sx - x1) * dx + (sy - y1) * dy
        before = dx * dx + dy * dy - behind + owned(dx, dy)
        behind += owned(-dx, -dy)
        half = width * (2 * longer + shorter)
    return behind, before, half - across + owned(-dy, dx), half + across + owned(dy, -dx)


@kernel
def power_of_two(n):
    """Whether a positive integer is 2**k."""
    return (n & (n - 1)) == 0


@kernel
def point_bounds(x0, y0, x1, y1, x2, y2, sx, sy):
    """Four values that are all >= 0 where the point draws the sample.

    On the left and the top edge it does; on the others too, unless the side is a power of two: how far across
    the point a sample lies comes from a reciprocal that is exact only there.
    Measured: Point_size PointSmoothOff_01_FF, 208 of 208 points.
    """
    right = int64(-1) if power_of_two(x1 - x0) else int64(0)
    bottom = int64(-1) if power_of_two(y1 - y2) else int64(0)
    return sx - x0, x1 - sx + right, sy - y2, y1 - sy + bottom


@kernel
def stroke_bounds(draw, kind, x0, y0, x1, y1, x2, y2, sx, sy):
    """``line_bounds`` or ``point_bounds``."""
    if kind == R.LINE:
        return line_bounds(draw, x0, y0, x1, y1, sx, sy)
    return point_bounds(x0, y0, x1, y1, x2, y2, sx, sy)


@kernel
def stroke_margin(draw, kind):
    """How far, in 1/16 pixel, a stroke's samples may lie outside the box of its row's vertices: 16 times the
    half width is at most 1.12 times the width in eighths; a step's pixel may begin before the line does.
    """
    return 2 * draw[R.LINE_WIDTH] + 16 if kind == R.LINE else int64(1)


@kernel
def open_run(draw, kind, row, first, end):
    """The first run [from, to) of pixels of a row, within [first, end), that stipple and window clip leave.

    Source: OpenGL 1.2.1 section 3.5.2; Measured: Stipple_tests and Window_clip captures.
    """
    start = first
    while start < end:
        stop = end
        shown = True
        if draw[R.WINDOW_CLIP]:
            inside = False
            for k in range(draw[R.CLIP_RECTANGLES]):
                at = R.CLIP_RECTANGLE + 4 * k
                if draw[at + 1] <= row and row < draw[at + 3]:
                    inside |= draw[at] <= start and start < draw[at + 2]
                    for edge in (draw[at], draw[at + 2]):
                        if start < edge:
                            stop = min(stop, edge)
            shown = inside == (draw[R.WINDOW_CLIP] == 1)
        if shown and draw[R.STIPPLE] and kind == R.TRIANGLE:
            word = draw[R.STIPPLE_WORD + (row & 31)]
            shown = ((word >> (31 - (start & 31))) & 1) != 0
            ahead = start + 1
            while ahead < stop and (((word >> (31 - (ahead & 31))) & 1) != 0) == shown:
                ahead += 1
            stop = ahead
        if shown:
            return start, stop
        start = stop
    return end, end
