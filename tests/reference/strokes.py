"""Lines and points: which pixels they draw and their edge values, in exact integers, 1/16 pixel, y down."""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from fixedpipe.pipeline.enums import LineRasterization
from tests.reference import coverage

TRIANGLE, LINE, POINT = range(3)  # Assumed: nothing, WindowPrimitives' codes


def draws_its_edge(normal):
    """Whether a line draws samples on an edge with that outward normal: to the right and straight up.

    Measured: Line_width captures.
    """
    return normal[0] > 0 or (normal[0] == 0 and normal[1] < 0)


@dataclass(frozen=True)
class Segment:
    """From a to b."""

    a: tuple
    b: tuple

    @property
    def direction(self):
        """B - a. Source: OpenGL 1.2.1 section 3.4."""
        return self.b[0] - self.a[0], self.b[1] - self.a[1]

    @property
    def axis(self):
        """0 where the line is at least as wide as high, else 1. Source: OpenGL 1.2.1 section 3.4.1."""
        dx, dy = self.direction
        return 0 if abs(dx) >= abs(dy) else 1


@dataclass(frozen=True)
class Line(Segment):
    """A line from a to b, a width in 1/8 pixel and a LineRasterization."""

    width: int
    rasterization: LineRasterization

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
            first, last = self.step_of(self.a), self.step_of(self.b)
            here = (px, py)[self.axis]
            if not (first <= here < last or last < here <= first):
                return False
        else:
            half = self.width * (2 * longer + shorter)
            along, _, rest = self.values(px, py)
            edges = [(along, (-dx, -dy)), (rest, (dx, dy))]
        edges += [(half - across, (-dy, dx)), (half + across, (dy, -dx))]
        return all(n > 0 or (n == 0 and draws_its_edge(normal)) for n, normal in edges)

    def reaches(self, px, py):
        """Whether a pixel is as near to the ends' as half the width of a rectangle, rounded up to pixels.

        Measured: Line_width, 35 captures of 35.
        """
        if self.rasterization == LineRasterization.STEPS:
            return True
        half = -(-self.width // 16)
        ends = [[end[k] // coverage.SUBPIXELS for end in (self.a, self.b)] for k in (0, 1)]
        return all(min(e) - half <= p <= max(e) + half for e, p in zip(ends, (px, py), strict=True))

    def step_of(self, end):
        """The pixel along the longer axis that an end lies in; on a boundary between rows the upper one.

        Measured: 20 of 20 ends (Smoothing_control).
        """
        return (end[self.axis] - self.axis) // coverage.SUBPIXELS

    def pixel_of(self, px, py):
        """The pixel at whose sample the values are taken: itself. Measured: Line_width captures."""
        return px, py

    def steps(self):
        """How many steps the line has. Measured: 3D_primitive captures."""
        return abs(self.step_of(self.b) - self.step_of(self.a))

    def position(self, px, py):
        """How many steps come before this one. Source: OpenGL 1.2.1 section 3.4.2; Inferred: the NV2A's."""
        return abs((px, py)[self.axis] - self.step_of(self.a))


TINY = 2.0**-50  # of a pixel's sixteenth; Assumed: nothing, its square and it are far below any difference


@dataclass(frozen=True)
class DiamondLine(Segment):
    """A line from a to b by the rule of diamonds, a width in whole pixels."""

    width: int

    @property
    def ends(self):
        """The ends of what is rasterized in a wide line's place. Source: OpenGL 1.2.1 section 3.4.2."""
        beside = coverage.SUBPIXELS * (self.width - 1) // 2
        by = (0, beside) if self.axis == 0 else (-beside, 0)
        return tuple((x + by[0], y + by[1]) for x, y in (self.a, self.b))

    def reaches(self, px, py):
        """Whether the line may draw a pixel. Source: OpenGL 1.2.1 section 3.4.2, which has no such limit."""
        del px, py
        return True

    def exits(self, px, py):
        """Whether the line of width 1 produces the pixel: it meets its diamond and does not end in it.

        Both ends are moved by (-e, -e^2) of window coordinates. Source: OpenGL 1.2.1 section 3.4.1.
        """
        center = coverage.sample_point(px, py)
        e = Fraction(TINY)
        (ax, ay), (bx, by) = (
            (x - center[0] - e, y - center[1] + e * e)  # y down
            for x, y in self.ends
        )
        half = coverage.SUBPIXELS // 2
        if min(ax, bx) >= half or max(ax, bx) <= -half or min(ay, by) >= half or max(ay, by) <= -half:
            return False
        enters, leaves = Fraction(0), Fraction(1)
        for sx, sy in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            at_a, at_b = (half - sx * x - sy * y for x, y in ((ax, ay), (bx, by)))  # inside: > 0
            if at_a <= 0 and at_b <= 0:
                return False
            if at_a < 0 < at_b:
                enters = max(enters, at_a / (at_a - at_b))
            elif at_b < 0 < at_a:
                leaves = min(leaves, at_a / (at_a - at_b))
        return enters < leaves and not abs(bx) + abs(by) < half

    def produced(self, step):
        """The pixel of width 1 at a step of the longer axis, or None. Source: OpenGL 1.2.1 section 3.4.1."""
        return produced(self, step)

    def pixel_of(self, px, py):
        """The pixel of width 1 that this one repeats, or None: the lowest (leftmost) of its column (row).

        Source: OpenGL 1.2.1 section 3.4.2.
        """
        found = self.produced((px, py)[self.axis])
        if found is None:
            return None
        before = found[1] - py if self.axis == 0 else px - found[0]
        return found if 0 <= before < self.width else None

    def covers(self, px, py):
        """Whether the line draws the pixel. Source: OpenGL 1.2.1 section 3.4.2."""
        return self.pixel_of(px, py) is not None

    def values(self, px, py):
        """(n0, n1, n2) for the vertices (b, a, a) of a pixel. Source: OpenGL 1.2.1 equation 3.1."""
        p, (a, _), (dx, dy) = coverage.sample_point(px, py), self.ends, self.direction
        n0 = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy
        return n0, 0, dx * dx + dy * dy - n0

    def steps(self):
        """How many pixels the line of width 1 has. Source: OpenGL 1.2.1 section 3.4.1."""
        first, last = sorted(end[self.axis] // coverage.SUBPIXELS for end in (self.a, self.b))
        return sum(self.produced(step) is not None for step in range(first - 1, last + 2))

    def position(self, px, py):
        """How many pixels of width 1 come before this one's. Source: OpenGL 1.2.1 section 3.4.2."""
        at = (px, py)[self.axis]
        begin, forward = self.a[self.axis] // coverage.SUBPIXELS, self.direction[self.axis] > 0
        before = range(begin - 1, at) if forward else range(at + 1, begin + 2)
        return sum(self.produced(step) is not None for step in before)


@lru_cache(maxsize=1 << 12)
def produced(line, step):
    """``DiamondLine.produced``: one of three around the line. Source: OpenGL 1.2.1 section 3.4.1."""
    (ax, ay), _ = line.ends
    dx, dy = line.direction
    center = coverage.SUBPIXELS * step + coverage.SUBPIXELS // 2
    if dx == dy == 0:
        return None
    if line.axis == 0:
        near = (ay + Fraction(center - ax) * dy / dx) // coverage.SUBPIXELS
        candidates = [(step, near + k) for k in (-1, 0, 1)]
    else:
        near = (ax + Fraction(center - ay) * dx / dy) // coverage.SUBPIXELS
        candidates = [(near + k, step) for k in (-1, 0, 1)]
    found = [pixel for pixel in candidates if line.exits(*pixel)]
    return found[0] if found else None


def stippled_line(stipple, line, counter, px, py):
    """Whether line stipple leaves a line's pixel out; ``counter``: at the line's first pixel.

    Source: OpenGL 1.2.1 section 3.4.2.
    """
    if stipple is None:
        return False
    factor, pattern = stipple
    return not pattern >> (counter + line.position(px, py)) // factor % 16 & 1


def point_center(x, y, size):
    """Where a point of a whole size is drawn, 1/16 pixel, y down. Source: OpenGL 1.2.1 section 3.3."""
    pixel = coverage.SUBPIXELS
    if size % 2:
        return x // pixel * pixel + pixel // 2, -(-y // pixel * pixel + pixel // 2)
    return (x + pixel // 2) // pixel * pixel, -((pixel // 2 - y) // pixel * pixel)


def point_covers(row, px, py):
    """Whether a point draws the pixel; ``row``: eight half sides to the right of its middle, the middle, and
    as far below.

    Measured: Point_size, 208 of 208 points.
    """
    (far, _), (middle_x, middle_y), _ = row
    half = (far - middle_x) // 8
    left, right, top, bottom = middle_x - half, middle_x + half, middle_y - half, middle_y + half
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
