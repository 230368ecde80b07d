"""Eye coordinates by one modelview matrix, or by two and a vertex's weight (docs/numbers.md N2.28).

Source: EXT_vertex_weighting; envytools' model of the NV10 (nvhw/pgraph_celsius_xfrm.c).
"""

from fixedpipe.pipeline.vertices.arithmetic import ONE, columns_of, transform
from fixedpipe.pipeline.vertices.chip_floats import (
    TRANSFORM_BITS,
    product,
    single,
    total,
    transform_matrix,
)


def weight_of(mesh):
    """The column of a mesh's weights, which belong to the first modelview matrix."""
    return columns_of(None if mesh.weights is None else mesh.weights[:, None], (1.0,))[0]


def weighted(vectors, weight):
    """A single vector unchanged, or two vectors of columns blended; a fourth component is the first's."""
    first, *others = vectors
    for second in others:
        rest = ONE - weight
        sums = [a * weight + b * rest for a, b in zip(first[:3], second[:3], strict=True)]
        first = [*sums, *first[3:]]
    return first


def transform_weighted(vectors, weight):
    """``weighted`` in the transform unit's arithmetic."""
    first, *others = vectors
    for second in others:
        weight = single(weight)
        rest = total((ONE, -weight), TRANSFORM_BITS)
        shares = [
            (product(a, weight, TRANSFORM_BITS), product(b, rest, TRANSFORM_BITS))
            for a, b in zip(first[:3], second[:3], strict=True)
        ]
        first = [*(total(share, TRANSFORM_BITS) for share in shares), *first[3:]]
    return first


def eye_coordinates(vertex, position, weight):
    """Eye coordinates, four columns, of object coordinates."""
    return weighted([transform(matrix, position) for matrix in vertex.modelviews], weight)


def transform_eye(vertex, position, weight):
    """``eye_coordinates`` in the transform unit's arithmetic."""
    return transform_weighted([transform_matrix(matrix, position) for matrix in vertex.modelviews], weight)
