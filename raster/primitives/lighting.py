"""OpenGL 1.2.1 lighting (section 2.13.1) of all vertices of a mesh, in chunks (docs/numbers.md, section 2).

``fixedpipe.pipeline.vertices.lighting`` packs a state's numbers. Each loop is a step over a chunk's columns.
"""

import math

from numba import types

from fixedpipe.raster.kernel import kernel, separate_loop
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

# flags of normals, and numbers of each matrix: its inverse's rows, and what rescales normals
NORMALIZE, RESCALE = range(2)
SCALE = 9
# flags of the state, then a light's, then a side's
LOCAL_VIEWER, SEPARATE, CLAMPED, SIDES, FLAGS = range(5)
POSITIONAL, SPOT = range(2)
FIRST_SIDE, FIRST_LIGHT = 1, 3  # rows: the state has the first
AMBIENT, DIFFUSE, SPECULAR, EMISSION = range(4)  # a side's flags: which colours are the vertex's
# numbers of a light: its place, or the direction to it, then its colours
PLACE, ATTENUATION, AXIS, CUTOFF, EXPONENT, COLORS = 0, 3, 6, 9, 10, 11
# numbers of a side: four colours of four components, the shininess; the scene's colour
SHININESS, SCENE = 16, 17
NUMBERS = 20


@kernel
def _scaled(out, a, factor):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = a[i] * factor


@kernel
def _add_scaled(out, a, factor):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = out[i] + a[i] * factor


@kernel
def _blend(out, b, weight):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = out[i] * weight[i] + b[i] * (1.0 - weight[i])


@kernel
def _lengths(out, a):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = math.sqrt((a[0, i] * a[0, i] + a[1, i] * a[1, i]) + a[2, i] * a[2, i])


@kernel
def _divide(out, length):
    """Divided by lengths; where they are 0, as it was."""
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = out[i] / (1.0 if length[i] == 0.0 else length[i])


@kernel
def _normalize(vector, length):
    _lengths(length, vector)
    for c in range(3):
        _divide(vector[c, : length.shape[0]], length)


@kernel
def _dot(out, a, b):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = (a[0, i] * b[0, i] + a[1, i] * b[1, i]) + a[2, i] * b[2, i]


@kernel
def _points(out, a, w):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = a[i] / w[i]


@kernel
def _negative(out, a):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = -a[i]


@kernel
def _differences(out, place, a):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = place - a[i]


@kernel
def _sums(out, a, b):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = a[i] + b[i]


@kernel
def _attenuate(strength, distance, constant, linear, quadratic):
    """1 / (constant + linear d + quadratic d d), without terms whose factor is 0; no factor is negative."""
    separate_loop()
    for i in range(strength.shape[0]):
        d = distance[i]
        first = d * linear if linear != 0.0 else 0.0
        second = (d * d) * quadratic if quadratic != 0.0 else 0.0
        strength[i] = 1.0 / ((constant + first) + second)


@kernel
def _cone_cosines(cosine, base, direction, axis):
    separate_loop()
    a0, a1, a2 = axis
    for i in range(cosine.shape[0]):
        c = -((direction[0, i] * a0 + direction[1, i] * a1) + direction[2, i] * a2)
        cosine[i] = c
        base[i] = c if c > 0.0 else 0.0


@kernel
def _cone(strength, cosine, factor, cutoff):
    separate_loop()
    for i in range(strength.shape[0]):
        lit = factor[i] if cosine[i] >= cutoff else 0.0
        strength[i] = strength[i] * lit


@kernel
def _positive(out, a, sign):
    separate_loop()
    for i in range(out.shape[0]):
        x = sign * a[i]
        out[i] = x if x > 0.0 else 0.0


@kernel
def _highlight(out, diffuse):
    separate_loop()
    for i in range(out.shape[0]):
        before = out[i]
        out[i] = before if diffuse[i] > 0.0 else 0.0


@kernel
def _add_light(primary, strength, diffuse, of_ambient, of_diffuse, ambient, color):
    """Ambient and diffuse terms; ``of_`` are the material's columns."""
    separate_loop()
    for i in range(primary.shape[0]):
        term = of_ambient[i] * ambient + diffuse[i] * (of_diffuse[i] * color)
        primary[i] = primary[i] + strength[i] * term


@kernel
def _add_shiny_light(primary, strength, diffuse, specular, of_ambient, of_diffuse, of_specular, colors):
    """The same and the specular term."""
    separate_loop()
    ambient, color, shine = colors
    for i in range(primary.shape[0]):
        term = of_ambient[i] * ambient + diffuse[i] * (of_diffuse[i] * color)
        term = term + specular[i] * (of_specular[i] * shine)
        primary[i] = primary[i] + strength[i] * term


@kernel
def _add_shine(secondary, strength, specular, of_specular, shine):
    separate_loop()
    for i in range(secondary.shape[0]):
        secondary[i] = secondary[i] + strength[i] * (specular[i] * (of_specular[i] * shine))


@kernel
def _scene(out, emission, ambient, scene):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = emission[i] + ambient[i] * scene


@kernel
def _weighted(out, given, k0, k1, k2):
    """The sum of three columns times factors, in order, without those of factor 0."""
    n = out.shape[0]
    begun = False
    for c in range(3):
        factor = k0 if c == 0 else (k1 if c == 1 else k2)
        if factor != 0.0:
            if begun:
                _add_scaled(out, given[c, :n], factor)
            else:
                _scaled(out, given[c, :n], factor)
            begun = True
    if not begun:
        fill(out, 0.0)


_FLOATS, _COLUMNS = types.float64[::1], types.float64[:, ::1]
NORMAL_ROWS = 8  # of scratch


@kernel(types.void(ARRAY, ARRAY, types.int64[::1], _COLUMNS, _COLUMNS, _COLUMNS))
def eye_normals(normals, weights, flags, matrices, columns, out):
    """Normals in eye coordinates (section 2.10.3).

    normals, weights  of a mesh
    flags             int64[2]
    matrices          float64[1 or 2, SCALE + 1]: rows of the inverse, and what rescales normals
    columns           float64[NORMAL_ROWS, CHUNK]: scratch
    out               float64[3, n]
    """
    given, other, weight, length = columns[:3], columns[3:6], columns[6], columns[7]
    for first in range(0, out.shape[1], CHUNK):
        last = min(first + CHUNK, out.shape[1])
        n = last - first
        copy_vector(given, n, normals[first:last], 0.0, 1.0)
        copy_component(weight[:n], weights[first:last], 0, 1.0)
        for m in range(matrices.shape[0]):
            row = matrices[m]
            for c in range(3):
                to = other[c, :n] if m else out[c, first:last]
                _weighted(to, given, row[c], row[3 + c], row[6 + c])
                if flags[RESCALE]:
                    _rescale(to, row[SCALE])
                if m:
                    _blend(out[c, first:last], other[c, :n], weight[:n])
        if flags[NORMALIZE]:
            for c in range(3):
                copy(other[c, :n], out[c, first:last])
            _normalize(other, length[:n])
            for c in range(3):
                copy(out[c, first:last], other[c, :n])


@kernel
def _rescale(out, factor):
    separate_loop()
    for i in range(out.shape[0]):
        out[i] = out[i] * factor


# Rows of the scratch: vectors of 3 columns, then columns, then a side's material and results.
(_NORMAL, _POINT, _TO_EYE, _DIRECTION, _HALF) = range(0, 15, 3)
(_LENGTH, _STRENGTH, _COSINE, _BASE, _FACTOR, _N_DOT_L, _N_DOT_H, _DIFFUSE, _SPECULAR, _K) = range(15, 25)
_COLOR, _MATERIAL, _RESULTS = 25, 29, 45
ROWS = _RESULTS + 6


@kernel
def _illuminate(columns, n, flags, numbers, shiny):
    """Direction, attenuation and spotlight of one light: equations 2.2 to 2.6."""
    direction, half, normal = columns[_DIRECTION:_HALF], columns[_HALF:_LENGTH], columns[_NORMAL:_POINT]
    strength, length = columns[_STRENGTH, :n], columns[_LENGTH, :n]
    if flags[POSITIONAL]:
        for c in range(3):
            _differences(direction[c, :n], numbers[PLACE + c], columns[_POINT + c, :n])
        _normalize(direction, length)
        a = numbers[ATTENUATION : ATTENUATION + 3]
        _attenuate(strength, length, a[0], a[1], a[2])
    else:
        fill(strength, 1.0)
        for c in range(3):
            fill(direction[c, :n], numbers[PLACE + c])
    if flags[SPOT]:
        cosine, factor, axis = columns[_COSINE, :n], columns[_FACTOR, :n], numbers[AXIS : AXIS + 3]
        _cone_cosines(cosine, columns[_BASE, :n], direction, (axis[0], axis[1], axis[2]))
        power(factor, columns[_BASE, :n], columns[_K, :n], numbers[EXPONENT])
        _cone(strength, cosine, factor, numbers[CUTOFF])
    _dot(columns[_N_DOT_L, :n], normal, direction)
    if shiny:
        for c in range(3):
            _sums(half[c, :n], direction[c, :n], columns[_TO_EYE + c, :n])
        _normalize(half, length)
        _dot(columns[_N_DOT_H, :n], normal, half)


@kernel
def _shines(side_flags, side, light):
    """Whether a light's specular term needs computing; it does not where the state alone makes it zero."""
    shines = side_flags[SPECULAR] != 0
    for c in range(3):
        shines |= side[4 * SPECULAR + c] * light[COLORS + 6 + c] != 0.0
    return shines


@kernel
def _light_side(columns, n, results, material, sign, side, light, highlight):
    """One light on one side; ``highlight``: whether it has one, and whether that is separate."""
    shines, separate = highlight
    strength, diffuse, specular = columns[_STRENGTH, :n], columns[_DIFFUSE, :n], columns[_SPECULAR, :n]
    _positive(diffuse, columns[_N_DOT_L, :n], sign)
    if shines:
        _positive(columns[_BASE, :n], columns[_N_DOT_H, :n], sign)
        power(specular, columns[_BASE, :n], columns[_K, :n], side[SHININESS])
        _highlight(specular, diffuse)
    for c in range(3):
        of_ambient, of_diffuse = material[4 * AMBIENT + c, :n], material[4 * DIFFUSE + c, :n]
        of_specular, primary = material[4 * SPECULAR + c, :n], results[c, :n]
        ambient, color, shine = light[COLORS + c], light[COLORS + 3 + c], light[COLORS + 6 + c]
        if shines and not separate:
            colors = ambient, color, shine
            _add_shiny_light(
                primary, strength, diffuse, specular, of_ambient, of_diffuse, of_specular, colors
            )
        else:
            _add_light(primary, strength, diffuse, of_ambient, of_diffuse, ambient, color)
        if shines and separate:
            _add_shine(results[3 + c, :n], strength, specular, of_specular, shine)


@kernel
def _material(columns, n, flags, numbers):
    """A side's colours as columns: color material (section 2.13.3)."""
    for name in range(4):
        for c in range(4):
            to = columns[_MATERIAL + 4 * name + c, :n]
            if flags[name]:
                copy(to, columns[_COLOR + c, :n])
            else:
                fill(to, numbers[4 * name + c])


_GIVEN = types.Tuple((_COLUMNS, _COLUMNS, ARRAY))


@kernel(types.void(_GIVEN, types.int64[:, ::1], _COLUMNS, _COLUMNS, _COLUMNS))
def light_vertices(given, flags, numbers, columns, out):
    """Colours of all vertices.

    given           (eye, normals, colours): float64[4, n]; float64[3, n], in eye coordinates; a mesh's
    flags, numbers  int64[k, 4] and float64[k, NUMBERS]: rows for the state, two sides and the lights
    columns         float64[ROWS, CHUNK]: scratch
    out             float64[8 or 16, n]: colour and secondary colour, of the front or of front and back
    """
    eye, normals, colors = given
    state, lights = flags[0], flags.shape[0] - FIRST_LIGHT
    separate = state[SEPARATE] != 0
    point, to_eye, material = (
        columns[_POINT:_TO_EYE],
        columns[_TO_EYE:_DIRECTION],
        columns[_MATERIAL:_RESULTS],
    )
    results = columns[_RESULTS:ROWS]
    for first in range(0, out.shape[1], CHUNK):
        last = min(first + CHUNK, out.shape[1])
        n = last - first
        copy_vector(columns[_COLOR : _COLOR + 4], n, colors[first:last], 1.0, 1.0)
        if lights:
            for c in range(3):
                copy(columns[_NORMAL + c, :n], normals[c, first:last])
                _points(point[c, :n], eye[c, first:last], eye[3, first:last])
                if state[LOCAL_VIEWER]:
                    _negative(to_eye[c, :n], point[c, :n])
                else:
                    fill(to_eye[c, :n], 1.0 if c == 2 else 0.0)
            if state[LOCAL_VIEWER]:
                _normalize(to_eye, columns[_LENGTH, :n])
        for side in range(state[SIDES]):
            of_side, own = flags[FIRST_SIDE + side], numbers[FIRST_SIDE + side]
            _material(columns, n, of_side, own)
            for c in range(3):
                emission, ambient = material[4 * EMISSION + c, :n], material[4 * AMBIENT + c, :n]
                _scene(results[c, :n], emission, ambient, own[SCENE + c])
                fill(results[3 + c, :n], 0.0)
            for number in range(lights):
                light, values = flags[FIRST_LIGHT + number], numbers[FIRST_LIGHT + number]
                shines = _shines(of_side, own, values)
                _illuminate(columns, n, light, values, shines)
                sign = -1.0 if side else 1.0
                _light_side(columns, n, results, material, sign, own, values, (shines, separate))
            _write(columns, n, out[8 * side : 8 * side + 8], first, results, material, state[CLAMPED])


@kernel
def _write(columns, n, out, first, results, material, clamped):
    """A side's eight columns."""
    for k in range(8):
        to = out[k, first : first + n]
        if k == 7:
            fill(to, 0.0)
        elif k == 3:
            copy(to, material[4 * DIFFUSE + 3, :n])
        else:
            copy(to, results[k if k < 3 else k - 1, :n])
        if clamped:
            clamp(to)
