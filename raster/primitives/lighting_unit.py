"""The NV10's lighting unit: colours of all vertices of a mesh, in chunks (docs/numbers.md, N2.17 to N2.28).

``fixedpipe.pipeline.vertices.lighting_unit`` packs a state's numbers and says where the rules are from. Each
loop is a step of the unit over a chunk's columns.
"""

import math

from numba import int64, types

from fixedpipe.raster.kernel import kernel, separate_loop
from fixedpipe.raster.primitives.chip_columns import (
    blend,
    dot,
    enter,
    enter_given,
    enter_single,
    row3,
    row4,
    to_single,
)
from fixedpipe.raster.primitives.chip_floats import (
    LIGHTING_BITS,
    TRANSFORM_BITS,
    dot3,
    dot4,
    finite_add_product,
    finite_multiply_add,
    lighting_reciprocal,
    product,
    product_and_sum,
    to_lighting,
    total2,
    transform_inverse_root,
    transform_reciprocal,
)
from fixedpipe.raster.primitives.lighting_columns import (
    ARRAY,
    CHUNK,
    clamp,
    copy,
    copy_component,
    copy_vector,
    fill,
    power,
)

# Rows of ``flags`` and ``numbers``: two matrices, the state's own in the first; two sides; then the lights.
FIRST_SIDE, FIRST_LIGHT = 2, 4

# flags of the state
(MATRICES, NORMALIZE, RESCALE, LOCAL_VIEWER, SIDES, FOLDED, SEPARATE, SECONDARY, CLAMPED, FLAGS) = range(10)
AS_COMPUTED, OPAQUE, DISABLED = range(3)  # SECONDARY
# flags of a side: how it starts, then where colours come from: 0 the material, 1 and 2 the vertex's colours
START, FACTOR, ADDEND, SOURCES, DIFFUSE, COEFFICIENTS = 0, 1, 2, 3, 4, 6  # SOURCES: three
CONSTANT, SUM, PRODUCT = range(3)  # START
# flags of a light
POSITIONAL, RANGE, SPOT, HALF = range(4)

# numbers of a matrix: its rows, its inverse's columns, what rescales normals; then the viewer's direction
INVERSE, FACTOR_OF_NORMALS, VIEWER = 16, 25, 26
# numbers of a side
SCALE, CONSTANTS, OWN_ALPHA, SHININESS, RATIONAL = 0, 3, 6, 7, 8
# numbers of a light: the place, or the direction to it; the last are colours of both sides
PLACE, AXIS, ATTENUATION, REACH, CONE, HALF_VECTOR, COLORS = 0, 3, 7, 10, 11, 14, 17
NUMBERS = COLORS + 18

_INFINITY = float("inf")


@kernel
def _reciprocal(out):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = transform_reciprocal(out[i])


@kernel
def _scale(out, factor):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = product(out[i], factor[i], TRANSFORM_BITS)


@kernel
def _scale_constant(out, factor):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = product(out[i], factor, TRANSFORM_BITS)


@kernel
def _differences(out, place, a):
    """A place less a column."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = total2(place, -a[i], TRANSFORM_BITS, 5)


@kernel
def _lengths(length, square, root, a):
    """Of vectors: the length, its square and its reciprocal."""
    separate_loop()
    for i in range(length.shape[0]):
        x, y, z = a[0, i], a[1, i], a[2, i]
        squared = dot3(x, y, z, x, y, z, TRANSFORM_BITS)
        inverse = transform_inverse_root(squared)
        square[i], root[i] = squared, inverse
        length[i] = product(squared, inverse, TRANSFORM_BITS)


@kernel
def _unit_vectors(vector, length, square, root):
    """Vectors, in place, divided by their lengths."""
    _lengths(length, square, root, vector)
    for c in range(3):
        _scale(vector[c, : root.shape[0]], root)


@kernel
def _attenuate(strength, distance, square, constant, linear, quadratic):
    separate_loop()
    for i in range(strength.shape[0]):
        below = dot3(1.0, distance[i], square[i], constant, linear, quadratic, LIGHTING_BITS)
        strength[i] = lighting_reciprocal(below)


@kernel
def _beyond(dark, distance, reach):
    separate_loop()
    for i in range(dark.shape[0]):
        left = total2(-distance[i], reach, LIGHTING_BITS, 0)
        before = dark[i]
        dark[i] = 1.0 if left < 0.0 else before


@kernel
def _cone_place(out, vector, axis):
    """A cone's x."""
    separate_loop()
    for i in range(out.shape[0]):
        x = to_lighting(dot4((vector[0, i], vector[1, i], vector[2, i], 1.0), axis, TRANSFORM_BITS))
        out[i] = 1.0 if x > 1.0 else x


@kernel
def _cone(strength, dark, x, below, a):
    separate_loop()
    for i in range(strength.shape[0]):
        above = total2(x[i], a, LIGHTING_BITS, 0)
        factor = product(strength[i], above, LIGHTING_BITS)
        strength[i] = product(factor, lighting_reciprocal(below[i]), LIGHTING_BITS)
        before = dark[i]
        dark[i] = 1.0 if (above <= 0.0) | (x[i] < 0.0) else before


@kernel
def _darken(strength, dark):
    separate_loop()
    for i in range(strength.shape[0]):
        strength[i] = 0.0 if dark[i] != 0.0 else strength[i]


@kernel
def _multiply_add(out, a, b, c):
    """a b + c. Numbers that are not finite are rare, and a loop of their own."""
    if _finite_multiply_add(out, a, b, c) == 0:
        for i in range(out.shape[0]):
            if not abs(a[i] * b[i] + c[i]) < _INFINITY:
                out[i] = product_and_sum(a[i], b[i], c[i])


@kernel
def _finite_multiply_add(out, a, b, c):
    separate_loop()
    finite = int64(1)
    for i in range(out.shape[0]):
        out[i] = finite_multiply_add(a[i], b[i], c[i])
        finite &= int64(1) if abs(a[i] * b[i] + c[i]) < _INFINITY else int64(0)
    return finite


@kernel
def _add_product(sums, a, b):
    """A sum and a b, in place; as ``_multiply_add``."""
    if _finite_add_product(sums, a, b) == 0:
        for i in range(sums.shape[0]):
            if not abs(a[i] * b[i] + sums[i]) < _INFINITY:
                sums[i] = product_and_sum(a[i], b[i], sums[i])


@kernel
def _finite_add_product(sums, a, b):
    separate_loop()
    finite = int64(1)
    for i in range(sums.shape[0]):
        before = sums[i]
        usual = abs(a[i] * b[i] + before) < _INFINITY
        found = finite_add_product(a[i], b[i], before)
        sums[i] = found if usual else before
        finite &= int64(1) if usual else int64(0)
    return finite


@kernel
def _add_color(sums, a, k):
    """``_add_product`` of a column and a register."""
    if _finite_add_color(sums, a, k) == 0:
        for i in range(sums.shape[0]):
            if not abs(a[i] * k + sums[i]) < _INFINITY:
                sums[i] = product_and_sum(a[i], k, sums[i])


@kernel
def _finite_add_color(sums, a, k):
    separate_loop()
    finite = int64(1)
    for i in range(sums.shape[0]):
        before = sums[i]
        usual = abs(a[i] * k + before) < _INFINITY
        found = finite_add_product(a[i], k, before)
        sums[i] = found if usual else before
        finite &= int64(1) if usual else int64(0)
    return finite


@kernel
def _times(out, a, k):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = product(a[i], k, LIGHTING_BITS)


@kernel
def _squares(out, a):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = product(a[i], a[i], LIGHTING_BITS)


@kernel
def _add_constant(out, k, guard):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = total2(out[i], k, LIGHTING_BITS, guard)


@kernel
def _sums(out, a, b):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = total2(a[i], b[i], LIGHTING_BITS, 5)


@kernel
def _diffuse(out, unlit, strength, facing, dark):
    separate_loop()
    for i in range(out.shape[0]):
        is_dark = (dark[i] != 0.0) | (facing[i] < 0.0)
        unlit[i] = 1.0 if is_dark else 0.0
        out[i] = product(strength[i], 0.0 if is_dark else facing[i], LIGHTING_BITS)


@kernel
def _where_negative(unlit, x):
    separate_loop()
    for i in range(unlit.shape[0]):
        before = unlit[i]
        unlit[i] = 1.0 if x[i] < 0.0 else before


@kernel
def _cosines(out, x, square):
    """The cosine to half vectors whose length's square is given; negative ones are 0."""
    separate_loop()
    for i in range(out.shape[0]):
        above = x[i] if x[i] > 0.0 else 0.0
        out[i] = above / math.sqrt(1.0 if square[i] == 0.0 else square[i])


@kernel
def _positive(out, x):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = x[i] if x[i] > 0.0 else 0.0


@kernel
def _highlight(out, strength, above, unlit):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = product(strength[i], 0.0 if unlit[i] != 0.0 else above[i], LIGHTING_BITS)


@kernel
def _divide(out, below, unlit):
    separate_loop()
    for i in range(out.shape[0]):
        reciprocal = lighting_reciprocal(below[i])
        out[i] = product(out[i], 1.0 if unlit[i] != 0.0 else reciprocal, LIGHTING_BITS)


@kernel
def _negate(out, a):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = -a[i]


@kernel
def _finish(out, a):
    """A column whose NaN are 1."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = a[i] if a[i] == a[i] else 1.0


# Rows of the scratch: vectors of 3 columns, then single columns.
(_NORMAL, _VIEWER, _POINT, _VECTOR, _DIRECTION, _HALF, _FRONT, _BACK, _SUMS, _SHINE) = range(0, 30, 3)
_OTHER, _FIRST_COLUMN = 30, 34  # four columns, for a second matrix
(
    _WEIGHT, _DISTANCE, _SQUARE, _ROOT, _STRENGTH, _DARK, _FACING, _DIFFUSE, _UNLIT, _SPECULAR, _X, _ABOVE,
    _BELOW, _FACTORS, _XX, _HALF_SQUARE, _K,
) = range(_FIRST_COLUMN, _FIRST_COLUMN + 17)  # fmt: skip
_GIVEN = _FIRST_COLUMN + 17  # the vertex's colours, as they are: 8 columns
_ENTERED = _GIVEN + 8  # the first three of each in the unit's precision: 3 columns, then 3
_POSITION = _ENTERED + 6  # 4 columns
_RESULTS = _POSITION + 4  # of both sides: 6 columns each
ROWS = _RESULTS + 12


@kernel
def _eye(columns, n, mesh_normals, flags, numbers, needs_points):
    """The geometry of a chunk: normals, points and vectors to the viewer."""
    given, position = columns[_FRONT : _FRONT + 3], columns[_POSITION : _POSITION + 4]
    normal, other, weight = columns[_NORMAL : _NORMAL + 3], columns[_OTHER : _OTHER + 4], columns[_WEIGHT, :n]
    point, viewer = columns[_POINT : _POINT + 3], columns[_VIEWER : _VIEWER + 3]
    root, distance, square = columns[_ROOT, :n], columns[_DISTANCE, :n], columns[_SQUARE, :n]
    copy_vector(given, n, mesh_normals, 0.0, 1.0)
    for c in range(3):
        to_single(given[c, :n])
    for m in range(flags[0, MATRICES]):
        row = numbers[m]
        for c in range(3):
            to = normal[c, :n] if m == 0 else other[c, :n]
            at = INVERSE + 3 * c
            row3(to, given[0, :n], given[1, :n], given[2, :n], (row[at], row[at + 1], row[at + 2]))
            if flags[0, RESCALE]:
                _scale_constant(to, row[FACTOR_OF_NORMALS])
            if m:
                blend(normal[c, :n], other[c, :n], weight)
    if flags[0, NORMALIZE]:
        _unit_vectors(normal, distance, square, root)
    if needs_points:
        for c in range(4):
            to_single(position[c, :n])
        for m in range(flags[0, MATRICES]):
            row = numbers[m]
            for c in range(4):
                to = other[c, :n] if m else (root if c == 3 else point[c, :n])
                of_row = row[4 * c], row[4 * c + 1], row[4 * c + 2], row[4 * c + 3]
                row4(to, position[0, :n], position[1, :n], position[2, :n], position[3, :n], of_row)
                if m > 0 and c < 3:
                    blend(point[c, :n], other[c, :n], weight)
        _reciprocal(root)
        for c in range(3):
            _scale(point[c, :n], root)
    if flags[0, LOCAL_VIEWER]:
        for c in range(3):
            _differences(other[c, :n], 0.0, point[c, :n])
        _unit_vectors(other[:3], distance, square, root)
    for c in range(3):
        if flags[0, LOCAL_VIEWER]:
            enter(viewer[c, :n], other[c, :n])
        else:
            fill(viewer[c, :n], numbers[0, VIEWER + c])
        enter(columns[_FRONT + c, :n], normal[c, :n])
        _negate(columns[_BACK + c, :n], columns[_FRONT + c, :n])


@kernel
def _reach(columns, n, flags, numbers, local_viewer):
    """Direction, strength and darkness of one light, and its half vectors."""
    direction, vector = columns[_DIRECTION : _DIRECTION + 3], columns[_VECTOR : _VECTOR + 3]
    half, viewer = columns[_HALF : _HALF + 3], columns[_VIEWER : _VIEWER + 3]
    strength, dark, x = columns[_STRENGTH, :n], columns[_DARK, :n], columns[_X, :n]
    distance, square, root = columns[_DISTANCE, :n], columns[_SQUARE, :n], columns[_ROOT, :n]
    fill(dark, 0.0)
    if flags[POSITIONAL]:
        for c in range(3):
            _differences(vector[c, :n], numbers[PLACE + c], columns[_POINT + c, :n])
        _unit_vectors(vector, distance, square, root)
        for c in range(3):
            enter(direction[c, :n], vector[c, :n])
        enter_single(distance)
        enter_single(square)
        k = numbers[ATTENUATION : ATTENUATION + 3]
        _attenuate(strength, distance, square, k[0], k[1], k[2])
        if flags[RANGE]:
            _beyond(dark, distance, numbers[REACH])
        if flags[SPOT]:
            axis, cone = numbers[AXIS : AXIS + 4], numbers[CONE : CONE + 3]
            _cone_place(x, vector, (axis[0], axis[1], axis[2], axis[3]))
            fill(columns[_K, :n], cone[1])
            fill(columns[_FACTORS, :n], cone[2])
            _multiply_add(columns[_BELOW, :n], columns[_K, :n], x, columns[_FACTORS, :n])
            _cone(strength, dark, x, columns[_BELOW, :n], cone[0])
        _darken(strength, dark)
    else:
        fill(strength, 1.0)
        for c in range(3):
            fill(direction[c, :n], numbers[PLACE + c])
    if flags[POSITIONAL] or local_viewer:
        for c in range(3):
            _sums(half[c, :n], viewer[c, :n], direction[c, :n])
        dot(columns[_HALF_SQUARE, :n], half, half)
    else:
        for c in range(3):
            fill(half[c, :n], numbers[HALF_VECTOR + c])


@kernel
def _factors(columns, n, normal, side, rational, to_half):
    """The factors of one light's diffuse and specular colours on one side.

    ``to_half``: the half vector is the light's own, of any length.
    """
    unlit, strength, specular = columns[_UNLIT, :n], columns[_STRENGTH, :n], columns[_SPECULAR, :n]
    x, above, below = columns[_X, :n], columns[_ABOVE, :n], columns[_BELOW, :n]
    cosine, square, k = columns[_FACTORS, :n], columns[_HALF_SQUARE, :n], columns[_K, :n]
    dot(columns[_FACING, :n], normal, columns[_DIRECTION : _DIRECTION + 3])
    _diffuse(columns[_DIFFUSE, :n], unlit, strength, columns[_FACING, :n], columns[_DARK, :n])
    dot(x, normal, columns[_HALF : _HALF + 3])
    coefficients = side[RATIONAL : RATIONAL + 3] if to_half else side[RATIONAL + 3 : RATIONAL + 6]
    if not rational:
        if to_half:
            _positive(cosine, x)
        else:
            _cosines(cosine, x, square)
        power(above, cosine, k, side[SHININESS])
        enter_single(above)
        _where_negative(unlit, x)
        _highlight(specular, strength, above, unlit)
        return
    a, b, c = coefficients
    if to_half:
        copy(above, x)
        _add_constant(above, a, 0)
        fill(k, b)
        fill(cosine, c)
        _multiply_add(below, x, k, cosine)
    else:
        xx, times = columns[_XX, :n], columns[_FACING, :n]
        _squares(xx, x)
        fill(k, a)
        _multiply_add(above, square, k, xx)
        fill(k, c)
        _times(times, xx, b)
        _multiply_add(below, square, k, times)
        _where_negative(unlit, x)
    _where_negative(unlit, above)
    _highlight(specular, strength, above, unlit)
    _divide(specular, below, unlit)


@kernel
def _begin(columns, n, sums, flags, numbers):
    """A side's primary colour before any light."""
    for c in range(3):
        scale, constant = numbers[SCALE + c], numbers[CONSTANTS + c]
        if flags[START] == CONSTANT:
            fill(sums[c, :n], constant)
            continue
        if flags[ADDEND]:
            copy(sums[c, :n], columns[_ENTERED + 3 * (flags[ADDEND] - 1) + c, :n])
        else:
            fill(sums[c, :n], constant)
        if flags[START] == SUM:
            _add_constant(sums[c, :n], scale, 5)
        else:
            _add_color(sums[c, :n], columns[_ENTERED + 3 * (flags[FACTOR] - 1) + c, :n], scale)


@kernel
def _add_light(columns, n, primary, shine, flags, colors):
    """One light's three colours on one side."""
    for name in range(3):
        factors = columns[_STRENGTH, :n] if name == 0 else columns[_DIFFUSE if name == 1 else _SPECULAR, :n]
        sums, source = shine if name == 2 else primary, flags[SOURCES + name]
        for c in range(3):
            k = colors[3 * name + c]
            if source:
                _times(columns[_FACTORS, :n], factors, k)
                _add_product(sums[c, :n], columns[_FACTORS, :n], columns[_ENTERED + 3 * (source - 1) + c, :n])
            else:
                _add_color(sums[c, :n], factors, k)


@kernel
def _write(columns, n, out, first, colors, state, flags, alpha):
    """A side's eight columns, finished, from its (primary, specular) colours."""
    primary, shine = colors
    for k in range(8):
        to, given = out[k, first : first + n], columns[_GIVEN + k, :n]
        if k >= 4 and state[SECONDARY] != AS_COMPUTED and (k == 7 or state[SECONDARY] == DISABLED):
            fill(to, 1.0 if k == 7 else 0.0)
        elif k < 3:
            _finish(to, primary[k, :n])
        elif 4 <= k < 7 and state[SEPARATE]:
            _finish(to, shine[k - 4, :n])
        elif k == 3 and flags[DIFFUSE] != 1:
            if flags[DIFFUSE]:
                _finish(to, columns[_GIVEN + 7, :n])
            else:
                fill(to, alpha if alpha == alpha else 1.0)
        else:
            _finish(to, given)
        if state[CLAMPED]:
            clamp(to)


_MESH = types.UniTuple(ARRAY, 5)


@kernel(
    types.void(
        _MESH, types.int64[:, ::1], types.float64[:, ::1], types.float64[:, ::1], types.float64[:, ::1]
    )
)
def light_vertices(mesh, flags, numbers, columns, out):
    """Colours of all vertices.

    mesh            (positions, normals, colours, secondary colours, weights)
    flags, numbers  int64[k, FLAGS] and float64[k, NUMBERS]: rows for matrices, sides and lights
    columns         float64[ROWS, CHUNK]: scratch
    out             float64[8 or 16, n]: colour and secondary colour, of the front or of front and back
    """
    positions, normals, colors, secondary, weights = mesh
    state, lights, vertices = flags[0], flags.shape[0] - FIRST_LIGHT, positions.shape[0]
    needs_points = state[LOCAL_VIEWER] != 0
    for number in range(lights):
        needs_points |= flags[FIRST_LIGHT + number, POSITIONAL] != 0
    for first in range(0, vertices, CHUNK):
        last = min(first + CHUNK, vertices)
        n = last - first
        given = columns[_GIVEN : _GIVEN + 8]
        copy_vector(given[:4], n, colors[first:last], 1.0, 1.0)
        copy_vector(given[4:], n, secondary[first:last], 0.0, 0.0)
        for k in range(3):
            enter_given(columns[_ENTERED + k, :n], given[k, :n])
            enter_given(columns[_ENTERED + 3 + k, :n], given[4 + k, :n])
        if lights:
            copy_vector(columns[_POSITION : _POSITION + 4], n, positions[first:last], 0.0, 1.0)
            copy_component(columns[_WEIGHT, :n], weights[first:last], 0, 1.0)
            _eye(columns, n, normals[first:last], flags, numbers, needs_points)
        for side in range(state[SIDES]):
            at = _RESULTS + 6 * side
            _begin(columns, n, columns[at : at + 3], flags[FIRST_SIDE + side], numbers[FIRST_SIDE + side])
            for c in range(3):
                fill(columns[at + 3 + c, :n], 0.0)
        for number in range(lights):
            light, values = flags[FIRST_LIGHT + number], numbers[FIRST_LIGHT + number]
            _reach(columns, n, light, values, state[LOCAL_VIEWER] != 0)
            for side in range(state[SIDES]):
                normal = columns[_BACK : _BACK + 3] if side else columns[_FRONT : _FRONT + 3]
                of_side, at = flags[FIRST_SIDE + side], _RESULTS + 6 * side
                to_half = light[POSITIONAL] == 0 and state[LOCAL_VIEWER] == 0
                rational = of_side[COEFFICIENTS] != 0
                _factors(columns, n, normal, numbers[FIRST_SIDE + side], rational, to_half)
                primary, shine = columns[at : at + 3], columns[at + 3 : at + 6]
                colors_of = values[COLORS + 9 * side : COLORS + 9 * side + 9]
                _add_light(columns, n, primary, primary if state[FOLDED] else shine, of_side, colors_of)
        for side in range(state[SIDES]):
            at, of_side = _RESULTS + 6 * side, flags[FIRST_SIDE + side]
            primary, shine = columns[at : at + 3], columns[at + 3 : at + 6]
            alpha = numbers[FIRST_SIDE + side, OWN_ALPHA]
            _write(columns, n, out[8 * side : 8 * side + 8], first, (primary, shine), state, of_side, alpha)
