"""Which pixels a triangle draws: edge functions in exact integers, culling, facing."""

from dataclasses import dataclass

from fixedpipe.pipeline.enums import Face, FrontFace, PolygonMode

SUBPIXELS = 16  # Measured: 4 fraction bits of window coordinates (TopLeftRaster)


@dataclass(frozen=True)
class Triangle:
    """A triangle in device coordinates, 1/16 pixel, y down.

    ``vertices``: three (X, Y). ``area``: the signed doubled area. ``edges``: the vertex pair that each edge
    function n0, n1, n2 belongs to, in the direction that has the interior on its positive side, were every w
    positive. ``behind``: which vertices have a negative w.
    """

    vertices: tuple
    area: int
    edges: tuple
    behind: tuple = (False, False, False)


def edge_function(a, b, p):
    """Twice the signed area of (a, b, p), in 1/256 square pixel. Source: OpenGL 1.2.1 section 3.5.1."""
    return (b[0] - a[0]) * (p[1] - a[1]) - (p[0] - a[0]) * (b[1] - a[1])


def make_triangle(v0, v1, v2, behind=(False, False, False)):
    """Edges turned so that the inside is positive whatever the winding. Source: docs/numbers.md section 3."""
    area = edge_function(v0, v1, v2)
    edges = ((v1, v2), (v2, v0), (v0, v1))
    if area < 0:
        edges = tuple((b, a) for a, b in edges)
    return Triangle((v0, v1, v2), area, edges, behind)


def sample_point(px, py):
    """Where a pixel is sampled: its center. Source: OpenGL 1.2.1 section 3.5.1."""
    return SUBPIXELS * px + SUBPIXELS // 2, SUBPIXELS * py + SUBPIXELS // 2


def edge_values(triangle, px, py):
    """(n0, n1, n2) of a pixel, inside or not; their sum is the area without its sign. A line has its own.

    Source: OpenGL 1.2.1 section 3.5.1, the numerators of the barycentric coordinates.
    """
    if not isinstance(triangle, Triangle):
        return triangle.values(px, py)
    p = sample_point(px, py)
    return tuple(edge_function(a, b, p) for a, b in triangle.edges)


def owns_its_points(a, b):
    """Whether pixels exactly on the edge a to b are inside: left edges go up, top edges go right.

    Measured: TopLeftRaster, 294000 of 294000 pixels.
    """
    left = b[1] < a[1]
    top = b[1] == a[1] and b[0] > a[0]
    return left or top


def covers(triangle, px, py):
    """Whether the triangle draws the pixel. Measured: TopLeftRaster, 294000 of 294000 pixels; through
    infinity, 29 captures of W_param.
    """
    if triangle.area == 0:
        return False
    p = sample_point(px, py)
    edges = [
        (b, a) if beyond else (a, b) for (a, b), beyond in zip(triangle.edges, triangle.behind, strict=True)
    ]
    return all(
        n > 0 or (n == 0 and owns_its_points(a, b)) for a, b in edges for n in (edge_function(a, b, p),)
    )


def covered_samples(places, moved):
    """How many of a pixel's places, in 1/16 pixel from its middle with y up, a shape covers; ``moved(x,
    y)``: whether the shape moved by so much, y down, draws the pixel.

    Measured: 2142 of 2142 pixels (3D_primitive Triangles-ps).
    """
    return sum(moved(-right, up) for right, up in places)


def is_front_facing(triangle, front_face):
    """With y down a negative area is counter-clockwise seen with y up; each negative w turns the triangle.

    Source: OpenGL 1.2.1 section 3.5.1; Measured: outlines of W_param w_neg_strip.
    """
    counter_clockwise = (triangle.area < 0) != (sum(triangle.behind) % 2 == 1)
    return counter_clockwise == (front_face == FrontFace.CCW)


def is_culled(front_facing, cull_face):
    """Source: OpenGL 1.2.1 section 3.5.1."""
    if cull_face is None:
        return False
    if cull_face == Face.FRONT_AND_BACK:
        return True
    return front_facing == (cull_face == Face.FRONT)


def scissor_rows_and_columns(scissor, width, height):
    """(columns, rows) that may be drawn, rows counted from the top; the screen itself is a scissor.

    Source: OpenGL 1.2.1 section 4.1.2.
    """
    if scissor is None:
        return range(width), range(height)
    left, right = max(0, scissor.x), min(width, scissor.x + scissor.width)
    bottom, top = max(0, scissor.y), min(height, scissor.y + scissor.height)
    return range(left, max(left, right)), range(height - top, max(height - top, height - bottom))


def polygon_rows_and_columns(state, width, height):
    """(columns, rows) that a filled polygon may draw: those of the scissor box in the viewport, outside of
    which the view volume has no polygon.

    Source: OpenGL 1.2.1 sections 2.11, 4.1.2; Measured: tex_diff_pers captures (of a composite matrix, which
    has no viewport, nothing is clipped at the sides).
    """
    columns, rows = scissor_rows_and_columns(state.scissor, width, height)
    if {state.polygon.front_mode, state.polygon.back_mode} != {PolygonMode.FILL}:  # these were cut before
        return columns, rows
    view = state.vertex.viewport
    left, bottom = view.x, view.y
    right = left + (width if view.width is None else view.width)
    top = bottom + (height if view.height is None else view.height)
    first, last = max(columns.start, left), min(columns.stop, right)
    highest, lowest = max(rows.start, height - top), min(rows.stop, height - bottom)
    return range(first, max(first, last)), range(highest, max(highest, lowest))


def spanned(triangle, columns, rows):
    """(columns, rows) that hold some of the triangle: none of its pixels lies elsewhere.

    Source: OpenGL 1.2.1 section 3.5.1 (a fragment's center lies inside the polygon).
    """
    if any(triangle.behind):
        return columns, rows
    return tuple(
        range(max(along.start, min(ends) // SUBPIXELS), min(along.stop, max(ends) // SUBPIXELS + 1))
        for along, ends in zip((columns, rows), zip(*triangle.vertices, strict=True), strict=True)
    )


def fragments(triangle, columns, rows):
    """The pixels that the triangle draws, row by row from the top. Source: OpenGL 1.2.1 section 3.5.1."""
    columns, rows = spanned(triangle, columns, rows)
    for py in rows:
        for px in columns:
            if covers(triangle, px, py):
                yield px, py
