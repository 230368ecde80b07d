"""Arithmetic on vertex columns: a float64 array per component, or one np.float64 for equal vertices.

Only +, -, *, / and the square root occur, in the order that docs/numbers.md section 2 gives. IEEE 754 fixes
their results on every machine. NumPy's matrix products fuse and reorder, so they never occur. Python floats
stay out of the columns, because they raise where IEEE 754 gives infinity.
"""

import numpy as np

Column = np.ndarray | np.float64

ZERO = np.float64(0.0)
ONE = np.float64(1.0)


def columns_of(array, defaults):
    """Split float64 [n, c] into len(defaults) columns; a component that the array lacks takes its default."""
    columns = [np.float64(default) for default in defaults]
    for component in range(0 if array is None else array.shape[1]):
        columns[component] = np.ascontiguousarray(array[:, component])
    return columns


def weighted_sum(coefficients, columns):
    """Sum coefficient * column in order, without the terms of coefficient 0; no terms give 0."""
    total = None
    for coefficient, column in zip(coefficients, columns, strict=True):
        if coefficient == 0:
            continue
        term = column if coefficient == 1 else column * np.float64(coefficient)
        total = term if total is None else total + term
    return ZERO if total is None else total


def transform(matrix, columns):
    """Matrix times column vector: one weighted sum for each row."""
    return [weighted_sum(row, columns) for row in matrix]


def dot(a, b):
    """(a0 b0 + a1 b1) + a2 b2."""
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def length(v):
    """sqrt((x x + y y) + z z)."""
    return np.sqrt(dot(v, v))


def normalize(v, length_of_v=None):
    """Divide v by its length; a vector of length 0 stays as it is."""
    size = length(v) if length_of_v is None else length_of_v
    divisor = np.where(size == 0, ONE, size)
    return [component / divisor for component in v]


def positive(column):
    """The larger of the column and 0; a NaN becomes 0."""
    return np.fmax(column, ZERO)


def invert_upper_left(matrix):
    """Inverse of the upper left 3x3 of a 4x4 matrix, by cofactors (docs/numbers.md), as 3 rows of np.float64.

    Where the determinant is zero there is no inverse. The function then returns the transpose, so that
    normals are transformed by the matrix itself. Raises ValueError if float64 cannot hold the determinant.
    """
    m = [[np.float64(matrix[row][column]) for column in range(3)] for row in range(3)]
    with np.errstate(all="ignore"):
        cofactor = [
            [
                m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3]
                - m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3]
                for j in range(3)
            ]
            for i in range(3)
        ]
        determinant = (m[0][0] * cofactor[0][0] + m[0][1] * cofactor[0][1]) + m[0][2] * cofactor[0][2]
        if not np.isfinite(determinant):
            raise ValueError(
                f"the modelview matrix's upper left 3x3 has the determinant {determinant}, by which normals "
                f"for lighting or for the texgen modes SPHERE_MAP, NORMAL_MAP and REFLECTION_MAP cannot be "
                f"divided: scale the matrix down, or disable them"
            )
        if determinant == 0:
            return [[m[i][j] for i in range(3)] for j in range(3)]
        return [[cofactor[i][j] / determinant for i in range(3)] for j in range(3)]


def filled(count, column, dtype=np.float64):
    """A C-contiguous array of ``count`` elements that holds the column."""
    result = np.empty(count, dtype=dtype)
    result[:] = column
    return result


def filled_rows(count, columns):
    """float64 [k, count] from k columns."""
    if isinstance(columns, np.ndarray):
        return columns
    result = np.empty((len(columns), count))
    for index, column in enumerate(columns):
        result[index] = column
    return result


def stacked_units(count, columns):
    """float64 [count, units, 4] from four columns for each unit."""
    result = np.empty((count, len(columns) // 4, 4))
    for index, column in enumerate(columns):
        result[:, index // 4, index % 4] = column
    return result
