"""Primitive assembly (section 2.6.1): vertex arrays become triangles, each with its provoking vertex."""

import numpy as np

from pipeline.enums import PrimitiveType, ProvokingVertex


def split(primitive, counts, provoking):
    """Split runs of vertices into triangles.

    counts is int64 [runs], the vertices of each Begin/End pair, one run after the other. Vertices that do not
    complete a primitive are ignored (section 2.6.1). Returns int64 [k, 4], three vertices and the provoking
    vertex of each triangle, counted through all runs, and int64 [k], the run of each triangle.

    Measured: both diagonals and all provoking vertices, on NV2A captures. OpenGL's table 2.9 names the last
    vertex; for quads and polygons the chip has no other.
    """
    counts = np.asarray(counts, dtype=np.int64)
    if primitive == PrimitiveType.TRIANGLES:
        triangles_in = counts // 3
    elif primitive == PrimitiveType.QUADS:
        triangles_in = 2 * (counts // 4)
    elif primitive == PrimitiveType.QUAD_STRIP:
        triangles_in = np.maximum(counts // 2 - 1, 0) * 2
    else:
        triangles_in = np.maximum(counts - 2, 0)

    run = np.repeat(np.arange(len(counts)), triangles_in)
    start = (np.cumsum(counts) - counts)[run]
    i = np.arange(len(run)) - (np.cumsum(triangles_in) - triangles_in)[run]
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
    else:
        base = start + i
        columns = (base + odd, base + 1 - odd, base + 2, base - odd + 3)
    return np.stack(columns, axis=1), run


def assemble(mesh, provoking):
    """Triangles of a mesh as int32 [k, 4]: three vertex numbers and the provoking vertex's."""
    stream = len(mesh.positions) if mesh.indices is None else len(mesh.indices)
    counts = [stream] if mesh.counts is None else mesh.counts
    triangles, _ = split(mesh.primitive, counts, provoking)
    if mesh.indices is not None:
        triangles = mesh.indices[triangles]
    return triangles.astype(np.int32)
