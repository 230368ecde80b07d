"""Lines and points: which pixels they draw, and how far along a line they lie (docs/numbers.md, section 11);
and the boxes around all primitives.

Integers only, in 1/16 pixel. A line's row of ``triangles`` is its second vertex, then its first, twice: with
n0 how far along a pixel lies, n1 = 0 and n2 the rest, everything is iterated as in a triangle. A point's row
is a place POINT_REACH half sides to the right of its middle, the middle, and a place as far below: iterated
like a triangle's, the middle's weight is the largest all over the square, so no other takes the rest.
"""

from numba import int64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import kernel, separate_function
from fixedpipe.raster.primitives.triangle import Edges

POINT_REACH = 8  # half sides of its square that the outer two of a point's row lie away


@kernel
def moved(draw, dx, dy, x, y):
    """Where a wide line's lowest pixels come from: half of what is beside one pixel's width down, or left.

    Source: OpenGL 1.2.1 section 3.4.2.
    """
    beside = draw[R.LINE_WIDTH] - R.PIXEL_WIDE
    return (x, y + beside) if abs(dx) >= abs(dy) else (x - beside, y)


@kernel
def lowest_pixel(draw, x0, y0, x1, y1, step):
    """The row (or column) of the lowest (or leftmost) pixel that a line draws in column (or row) ``step``.

    Source: OpenGL 1.2.1 sections 3.4.1 and 3.4.2. Away from its ends a line crosses one of the diamonds in a
    column. A line that passes exactly between two is moved to the left, and up by still less.
    """
    dx, dy = x0 - x1, y0 - y1
    x, y = moved(draw, dx, dy, x1, y1)
    if abs(dx) >= abs(dy):
        rise, tie = (dy if dx > 0 else -dy), int64(0)
        if rise < 0:
            tie = int64(1)
        return (y * abs(dx) + (step * 16 + 8 - x) * rise - tie) // (16 * max(abs(dx), 1))
    rise = dx if dy > 0 else -dx
    return (x * abs(dy) + (step * 16 + 8 - y) * rise - 1) // (16 * abs(dy))


@kernel
def stippled_away(draw, stroke, step):
    """Whether line stipple leaves out what a line draws at a step of its longer axis.

    Source: OpenGL 1.2.1 section 3.4.2.
    """
    if not draw[R.LINE_FACTOR]:
        return False
    counter = stroke[R.COUNTER] + abs(step - stroke[R.FIRST_STEP])
    return ((draw[R.LINE_PATTERN] >> ((counter // draw[R.LINE_FACTOR]) & 15)) & 1) == 0


@kernel
def line_run(draw, stroke, corners, row, first, end):
    """The first run of pixels of a row, within [first, end), that stipple leaves and that take their values
    together: (from, to, x, y, 1 where all take those of one sample). (x, y) is the pixel whose sample gives
    the first its values.
    """
    separate_function()
    x0, y0, x1, y1, _x2, _y2 = corners
    dx, dy = x0 - x1, y0 - y1
    replicates = draw[R.LINE_STEPS] == C.LINE_IN_DIAMONDS and draw[R.LINE_WIDTH] > R.PIXEL_WIDE
    if abs(dx) < abs(dy):
        if stippled_away(draw, stroke, row):
            return end, end, end, row, int64(0)
        if replicates:
            return first, end, lowest_pixel(draw, x0, y0, x1, y1, row), row, int64(1)
        return first, end, first, row, int64(0)
    start = first
    while start < end and stippled_away(draw, stroke, start):
        start += 1
    below = lowest_pixel(draw, x0, y0, x1, y1, start) if replicates else row
    stop = start
    while stop < end and not stippled_away(draw, stroke, stop):
        if replicates and lowest_pixel(draw, x0, y0, x1, y1, stop) != below:
            break
        stop += 1
    return start, stop, start, below, int64(0)


@kernel
def along_line(draw, x0, y0, x1, y1, sx, sy):
    """(n0, n2) of a sample of the line from vertex 1 to vertex 0; their sum is the line's length, but for the
    NV2A's steps squared.

    Measured: Line_width and Edge_flag captures (rectangles), 3D_primitive Lines (steps): every pixel. Source:
    OpenGL 1.2.1 equation 3.1 (diamonds).
    """
    dx, dy = x0 - x1, y0 - y1
    if draw[R.LINE_STEPS] != C.LINE_IN_STEPS:
        if draw[R.LINE_STEPS] == C.LINE_IN_DIAMONDS:
            x1, y1 = moved(draw, dx, dy, x1, y1)
        n0 = (sx - x1) * dx + (sy - y1) * dy
        return n0, dx * dx + dy * dy - n0
    # The pixel's far edge, along the longer axis.
    if abs(dx) >= abs(dy):
        n0 = (sx + 8 - x1) if dx > 0 else (x1 - (sx - 8))
    else:
        n0 = (sy + 8 - y1) if dy > 0 else (y1 - (sy - 8))
    return n0, max(abs(dx), abs(dy)) - n0


@kernel
def edges_of_line(draw, corners, x, y, sign):
    """``primitives.triangle.Edges`` of a line at pixel (x, y): how far along it lies, 0, and the rest."""
    x0, y0, x1, y1, _x2, _y2 = corners
    sx, sy = x * 16 + 8, y * 16 + 8
    n0, n2 = along_line(draw, x0, y0, x1, y1, sx, sy)
    ahead, _ = along_line(draw, x0, y0, x1, y1, sx + 16, sy)
    below, _ = along_line(draw, x0, y0, x1, y1, sx, sy + 16)
    right, down, zero = ahead - n0, below - n0, int64(0)
    return Edges((n0, zero, n2), (right, zero, -right), (down, zero, -down), n0 + n2, sign)


@kernel
def owned(nx, ny):
    """0 where a line draws the samples on an edge whose outward normal is (nx, ny), -1 where it does not: to
    the right and to the top it does.

    Measured: Line_width captures, 2123 pixels on edges.
    """
    return int64(0) if nx > 0 or (nx == 0 and ny < 0) else int64(-1)


@kernel
def line_bounds(draw, stroke, corners, sx, sy):
    """Four values that are all >= 0 where the line draws the sample: behind its start, before its end, and to
    its two sides.
    """
    x0, y0, x1, y1, _x2, _y2 = corners
    dx, dy = x0 - x1, y0 - y1
    longer, shorter = max(abs(dx), abs(dy)), min(abs(dx), abs(dy))
    width = draw[R.LINE_WIDTH]
    across = 2 * ((sy - y1) * dx - (sx - x1) * dy)
    if draw[R.LINE_STEPS] != C.LINE_AS_RECTANGLE:
        start, end = int64(stroke[R.FIRST_STEP]) * 16, int64(stroke[R.END_STEP]) * 16
        position, forward = sy - 8, dy > 0
        if abs(dx) >= abs(dy):
            position, forward = sx - 8, dx > 0
        behind = position - start if forward else start - position
        before = end - position - 1 if forward else position - end - 1
        if draw[R.LINE_STEPS] == C.LINE_IN_DIAMONDS:
            low, high = diamond_sides(draw, x0, y0, x1, y1, sx, sy)
            return behind, before, low, high
        half = width * 2 * longer
    else:
        behind = (sx - x1) * dx + (sy - y1) * dy
        before = dx * dx + dy * dy - behind + owned(dx, dy)
        behind += owned(-dx, -dy)
        half = width * (2 * longer + shorter)
    return behind, before, half - across + owned(-dy, dx), half + across + owned(dy, -dx)


@kernel
def diamond_sides(draw, x0, y0, x1, y1, sx, sy):
    """Two values that are both >= 0 where an endless line draws the sample. Source: ``lowest_pixel``."""
    dx, dy = x0 - x1, y0 - y1
    x1, y1 = moved(draw, dx, dy, x1, y1)
    across = (sy - y1) * dx - (sx - x1) * dy
    wide = 2 * draw[R.LINE_WIDTH] - 8
    if abs(dx) >= abs(dy):  # by how much the line passes below the sample, times |dx|
        below = -across if dx > 0 else across
        falls = dy <= 0 if dx < 0 else dy >= 0
        tie = int64(0) if falls else int64(1)
        return below + 8 * abs(dx) - tie, wide * abs(dx) - below - (1 - tie)
    right = across if dy > 0 else -across
    return right + wide * abs(dy) - 1, 8 * abs(dy) - right


@kernel
def power_of_two(n):
    """Whether a positive integer is 2**k."""
    return (n & (n - 1)) == 0


@kernel
def point_square(corners):
    """(left, top, right, bottom) of a point's square."""
    x0, _y0, x1, y1, _x2, _y2 = corners
    half = (x0 - x1) // POINT_REACH
    return x1 - half, y1 - half, x1 + half, y1 + half


@kernel
def sample_reach(draw):
    """How far, in 1/16 pixel, the samples that cover a pixel may lie from its middle."""
    return int64(8) if draw[R.COVER_SAMPLES] else int64(0)


@kernel
def triangle_box(draw, corners):
    """(left, top, right, bottom) around the middles of all pixels that a triangle may draw."""
    x0, y0, x1, y1, x2, y2 = corners
    reach = sample_reach(draw)
    left, top = min(x0, min(x1, x2)) - reach, min(y0, min(y1, y2)) - reach
    return left, top, max(x0, max(x1, x2)) + reach, max(y0, max(y1, y2)) + reach


@kernel
def stroke_box(draw, corners, kind):
    """(left, top, right, bottom) around the middles of all pixels that a line or a point may draw.

    A rectangle ends at the pixels as far from its ends' as half its width, in whole pixels rounded up.
    Measured: Line_width, 35 of 35 captures, in which corners beyond are missing. 16 times half a line's width
    is at most 1.12 times its width in eighths; a step's pixel may begin before the line does, and a diamond
    line's is up to its width and half a pixel away.
    """
    x0, y0, x1, y1, _x2, _y2 = corners
    if kind == C.PRIMITIVE_LINE and draw[R.LINE_STEPS] == C.LINE_AS_RECTANGLE:
        half = (draw[R.LINE_WIDTH] + 15) & -16
        left, top, right, bottom = min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)
        return (left & -16) - half, (top & -16) - half, (right | 15) + half, (bottom | 15) + half
    reach = sample_reach(draw) + 1
    if kind == C.PRIMITIVE_POINT:
        left, top, right, bottom = point_square(corners)
        return left - reach, top - reach, right + reach, bottom + reach
    reach += 2 * draw[R.LINE_WIDTH] + 16
    return min(x0, x1) - reach, min(y0, y1) - reach, max(x0, x1) + reach, max(y0, y1) + reach


@kernel
def point_bounds(corners, sx, sy):
    """Four values that are all >= 0 where the point draws the sample.

    On the left and the top edge it does; on the others too, unless the side is a power of two: how far across
    the point a sample lies comes from a reciprocal that is exact only there.
    Measured: Point_size PointSmoothOff_01_FF, 208 of 208 points.
    """
    left, top, right, bottom = point_square(corners)
    tie = int64(-1) if power_of_two(right - left) else int64(0)
    return sx - left, right - sx + tie, sy - top, bottom - sy + tie


@kernel
def stroke_bounds(draw, stroke, corners, sx, sy):
    """``line_bounds`` or ``point_bounds``."""
    if stroke[R.KIND] == C.PRIMITIVE_LINE:
        return line_bounds(draw, stroke, corners, sx, sy)
    return point_bounds(corners, sx, sy)


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
            shown = inside == (draw[R.WINDOW_CLIP] == C.WINDOW_CLIP_INSIDE)
        if shown and draw[R.STIPPLE] and kind == C.PRIMITIVE_TRIANGLE:
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
