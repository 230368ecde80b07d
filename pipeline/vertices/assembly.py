"""Primitive assembly (section 2.6.1): vertex arrays become triangles, lines or points."""

import numpy as np

from fixedpipe.pipeline.enums import PrimitiveType, ProvokingVertex
from fixedpipe.raster.primitives.meshes import separate_triangles

_FLAGGED = frozenset({PrimitiveType.TRIANGLES, PrimitiveType.QUADS, PrimitiveType.POLYGON})


def triangles_in(primitive, counts):
    """int64 [runs]: how many triangles runs of these lengths make; ``counts`` as in ``split``.

    Raises ValueError for a primitive that has none.
    """
    if primitive == PrimitiveType.TRIANGLES:
        return counts // 3
    if primitive == PrimitiveType.QUADS:
        return 2 * (counts // 4)
    if primitive == PrimitiveType.QUAD_STRIP:
        return np.maximum(counts // 2 - 1, 0) * 2
    if primitive in (PrimitiveType.TRIANGLE_STRIP, PrimitiveType.TRIANGLE_FAN, PrimitiveType.POLYGON):
        return np.maximum(counts - 2, 0)
    raise ValueError(f"{primitive!r} has no triangles.")


def split(primitive, counts, provoking):
    """Split runs of vertices into triangles.

    ``counts`` is int64 [runs]: the number of vertices of each Begin/End pair, one run after the other.
    Vertices that do not complete a primitive are ignored (section 2.6.1).

    Returns two arrays:

    - int64 [k, 4]: three vertices and the provoking vertex of each triangle, numbered through all runs.
    - int64 [k]: the run of each triangle.

    Measured: both diagonals and all provoking vertices, on NV2A captures. OpenGL's table 2.9 names the last
    vertex; for quads and polygons the chip offers no other.
    """
    counts = np.asarray(counts, dtype=np.int64)
    made = triangles_in(primitive, counts)
    run = np.repeat(np.arange(len(counts)), made)
    start = (np.cumsum(counts) - counts)[run]
    i = np.arange(len(run)) - (np.cumsum(made) - made)[run]
    odd = i & 1
    first = provoking == ProvokingVertex.FIRST

    if primitive == PrimitiveType.TRIANGLES:
        base = start + 3 * i
        columns = (base, base + 1, base + 2, base if first else base + 2)
    elif primitive == PrimitiveType.TRIANGLE_STRIP:
        base = start + i
        columns = (base + odd, base + 1 - odd, base + 2, base if first else base + 2)
    elif primitive == PrimitiveType.TRIANGLE_FAN:
        columns = (start, start + i + 1, start + i + 2, start + i + 1 if first else start + i + 2)
    elif primitive == PrimitiveType.POLYGON:
        columns = (start, start + i + 1, start + i + 2, start)
    elif primitive == PrimitiveType.QUADS:
        base = start + 2 * (i - odd)
        columns = (base, base + 1 + odd, base + 2 + odd, base + 3)
    else:  # QUAD_STRIP
        base = start + i
        columns = (base + odd, base + 1 - odd, base + 2, base - odd + 3)
    return np.stack(columns, axis=1), run


def split_lines(primitive, counts, provoking):
    """Rows of LINES, LINE_STRIP, LINE_LOOP or POINTS, and the run of each, in the form of ``split``.

    A line's row is its second vertex, its first twice, and the provoking vertex: its last or its first. A
    point's row is its vertex four times.
    """
    counts = np.asarray(counts, dtype=np.int64)
    lines_in = {
        PrimitiveType.POINTS: counts,
        PrimitiveType.LINES: counts // 2,
        PrimitiveType.LINE_STRIP: np.maximum(counts - 1, 0),
        PrimitiveType.LINE_LOOP: np.where(counts > 1, counts, 0),
    }[primitive]
    run = np.repeat(np.arange(len(counts)), lines_in)
    start = (np.cumsum(counts) - counts)[run]
    i = np.arange(len(run)) - (np.cumsum(lines_in) - lines_in)[run]
    if primitive == PrimitiveType.POINTS:
        first = second = start + i
    elif primitive == PrimitiveType.LINES:
        first, second = start + 2 * i, start + 2 * i + 1
    else:  # LINE_STRIP, LINE_LOOP
        first, second = start + i, start + (i + 1) % counts[run]
    rows = [second, first, first, first if provoking == ProvokingVertex.FIRST else second]
    return np.stack(rows, axis=1), run


def boundary_edges(mesh):
    """uint8 [k]: the edges of each triangle of ``assemble`` that are primitive edges with their flag set.

    Section 2.6.2. Bit 1 is the edge from the second vertex to the third, bit 2 from the third to the first,
    and bit 4 from the first to the second.
    """
    stream = len(mesh.positions) if mesh.indices is None else len(mesh.indices)
    counts = np.array([stream] if mesh.counts is None else mesh.counts)
    triangles, run = split(mesh.primitive, counts, ProvokingVertex.LAST)
    odd = np.arange(len(triangles)) & 1
    edges = np.full(len(triangles), 7)
    if mesh.primitive == PrimitiveType.QUADS:
        edges = np.where(odd, 1 | 2, 1 | 4)
    elif mesh.primitive == PrimitiveType.QUAD_STRIP:
        edges = np.where(odd, 1 | 2, 2 | 4)
    elif mesh.primitive == PrimitiveType.POLYGON:
        begins, ends = np.diff(run, prepend=-1) != 0, np.diff(run, append=-1) != 0
        edges = 1 | np.where(ends, 2, 0) | np.where(begins, 4, 0)
    if mesh.edge_flags is not None and mesh.primitive in _FLAGGED:
        flags = mesh.edge_flags if mesh.indices is None else mesh.edge_flags[mesh.indices]
        edges = edges & (flags[triangles[:, [1, 2, 0]]] @ [1, 2, 4])
    return edges.astype(np.uint8)


def stipple_groups(mesh):
    """int64 [k]: a number for each row of ``assemble``; rows of one number share a line stipple counter.

    These are the lines of a strip or a loop, and the edges of a polygon (sections 3.4.2 and 3.5.4).
    """
    stream = len(mesh.positions) if mesh.indices is None else len(mesh.indices)
    counts = np.array([stream] if mesh.counts is None else mesh.counts)
    splits = split if mesh.primitive.is_polygons else split_lines
    rows, run = splits(mesh.primitive, counts, ProvokingVertex.LAST)
    if mesh.primitive in (PrimitiveType.LINE_STRIP, PrimitiveType.LINE_LOOP, PrimitiveType.POLYGON):
        return run
    both = mesh.primitive in (PrimitiveType.QUADS, PrimitiveType.QUAD_STRIP)
    return np.arange(len(rows)) // (2 if both else 1)


def assemble(mesh, provoking):
    """Triangles of a mesh, or rows of its lines or points: int32 [k, 4].

    A row has three vertex numbers and the provoking vertex's number.
    """
    stream = len(mesh.positions) if mesh.indices is None else len(mesh.indices)
    whole = mesh.counts is None or not any([count % 3 for count in mesh.counts])
    if whole and mesh.primitive == PrimitiveType.TRIANGLES:  # most meshes; as ``split``
        vertices = np.arange(stream) if mesh.indices is None else mesh.indices
        triangles = np.empty((stream // 3, 4), np.int32)
        separate_triangles(vertices, 0 if provoking == ProvokingVertex.FIRST else 2, triangles)
        return triangles
    counts = [stream] if mesh.counts is None else mesh.counts
    splits = split if mesh.primitive.is_polygons else split_lines
    triangles, _ = splits(mesh.primitive, counts, provoking)
    if mesh.indices is not None:
        triangles = mesh.indices[triangles]
    return triangles.astype(np.int32)
