"""Lines and points: which pixels they draw and their edge values, in exact integers, 1/16 pixel, y down."""

from dataclasses import dataclass

from pipeline.enums import LineRasterization
from tests.reference import coverage

TRIANGLE, LINE, POINT = range(3)  # Assumed: nothing, WindowPrimitives' codes


def draws_its_edge(normal):
    """Whether a line draws samples on an edge with that outward normal: to the right and straight up.

    Measured: Line_width captures.
    """
    return normal[0] > 0 or (normal[0] == 0 and normal[1] < 0)


@dataclass(frozen=True)
class Line:
    """A line from a to b, a width in 1/8 pixel and a LineRasterization."""

    a: tuple
    b: tuple
    width: int
    rasterization: LineRasterization

    @property
    def direction(self):
        """B - a. Source: OpenGL 1.2.1 section 3.4."""
        return self.b[0] - self.a[0], self.b[1] - self.a[1]

    @property
    def axis(self):
        """0 where the line is at least as wide as high, else 1. Source: OpenGL 1.2.1 section 3.4.1."""
        dx, dy = self.direction
        return 0 if abs(dx) >= abs(dy) else 1

    @property
    def length(self):
        """What the edge values add up to. Measured: Line_width, 3D_primitive captures."""
        if self.rasterization == LineRasterization.STEPS:
            return abs(self.direction[self.axis])
        return sum(d * d for d in self.direction)

    def values(self, px, py):
        """(n0, n1, n2) for the vertices (b, a, a). Measured: Line_width, 3D_primitive captures."""
        p = coverage.sample_point(px, py)
        if self.rasterization == LineRasterization.STEPS:
            forward = 1 if self.direction[self.axis] > 0 else -1
            n0 = forward * (p[self.axis] - self.a[self.axis]) + coverage.SUBPIXELS // 2
        else:
            n0 = sum((p[k] - self.a[k]) * self.direction[k] for k in (0, 1))
        return n0, 0, self.length - n0

    def covers(self, px, py):
        """Whether the line draws the pixel. Measured: Line_width, 3D_primitive captures, every pixel."""
        p, (dx, dy) = coverage.sample_point(px, py), self.direction
        across = 2 * ((p[1] - self.a[1]) * dx - (p[0] - self.a[0]) * dy)
        longer, shorter = max(abs(dx), abs(dy)), min(abs(dx), abs(dy))
        edges = []
        if self.rasterization == LineRasterization.STEPS:
            half = self.width * 2 * longer
            first, last = (end[self.axis] // coverage.SUBPIXELS for end in (self.a, self.b))
            here = (px, py)[self.axis]
            if not (first <= here < last or last < here <= first):
                return False
        else:
            half = self.width * (2 * longer + shorter)
            along, _, rest = self.values(px, py)
            edges = [(along, (-dx, -dy)), (rest, (dx, dy))]
        edges += [(half - across, (-dy, dx)), (half + across, (dy, -dx))]
        return all(n > 0 or (n == 0 and draws_its_edge(normal)) for n, normal in edges)


def point_covers(corners, px, py):
    """Whether a point draws the pixel; ``corners``: lower left, lower right, upper right.

    Measured: Point_size, 208 of 208 points.
    """
    (left, bottom), (right, _), (_, top) = corners
    x, y = coverage.sample_point(px, py)

    def inside(low, here, high):
        """Whether a sample lies between two sides. Measured: 208 of 208 points (Point_size)."""
        side = high - low
        return low <= here < high or (here == high and side & (side - 1) != 0)

    return left < right and inside(left, x, right) and inside(top, y, bottom)


def stippled_away(stipple, px, py, height):
    """Whether polygon stipple leaves a polygon's pixel out. Source: OpenGL 1.2.1 section 3.5.2."""
    if stipple is None:
        return False
    row, column = (height - 1 - py) % 32, px % 32
    return not stipple[4 * row + column // 8] >> (7 - column % 8) & 1


def clipped_away(clip, px, py, height):
    """Whether the window clip leaves a pixel out. Measured: Window_clip captures."""
    if clip is None:
        return False
    y = height - 1 - py
    inside = any(
        box.x <= px < box.x + box.width and box.y <= y < box.y + box.height for box in clip.rectangles
    )
    return inside == clip.exclusive
