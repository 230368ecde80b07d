"""Colour pixel groups through pixel transfer, and from there into texels, a run of groups at a time.

``fixedpipe.pipeline.framebuffers.transfer`` lists the steps that a PixelTransfer asks for. A step computes a
component of the whole run, in float64, each sum in the specification's order. Nothing is clamped but where
OpenGL clamps. docs/numbers.md section 15 has the rule.

- ``elements``: float64 [n, c], what an image has of each group.
- ``steps``: int64 [k, 9], a row each: what it does, and its numbers. The first says where R, G, B and A are:
  an element, or after the last a constant, 0.0 and then 1.0.
- ``numbers``: float64, the factors and terms of the steps.
- ``entries``: float64, a column of a table after the other.

Source: OpenGL 1.2.1 sections 2.13.9, 3.6.4 and 3.6.5; SGI_color_table, SGI_color_matrix.
"""

import numpy as np

from fixedpipe.raster.kernel import kernel, separate_loop

RUN = 256  # groups: what they need stays in the first level cache

# What a step does, with the numbers that follow:
(
    SOURCES,  # an element, or c for 0.0 and c + 1 for 1.0, of each component
    ARITHMETIC,  # the place of four factors in ``numbers``, before the four terms
    LOOKUP,  # the place of each component's column in ``entries``, then the columns' sizes; 0 changes nothing
    MATRIX,  # the place of its sixteen numbers, by rows
    CLAMPING,
) = range(5)
STEP = 9  # numbers of a step
# Rows of the scratch that kernels take, float64 [PLANES, RUN], beside int32 [4, RUN]: the components, then
# the constants.
ZEROS, ONES, PLANES = 4, 5, 6

_THROUGH = "float64[:,::1],int64[:,::1],float64[::1],float64[::1],float64[:,::1],int32[:,::1]"


@kernel("void(float64[::1],float64)")
def _fill(plane, value):
    for i in range(len(plane)):
        plane[i] = value


@kernel("void(float64[:,::1],int64,float64[::1])")
def _take(elements, element, plane):
    separate_loop()
    for i in range(len(plane)):
        plane[i] = elements[i, element]


@kernel("void(float64[::1],float64,float64)")
def _scale(plane, factor, term):
    for i in range(len(plane)):
        plane[i] = plane[i] * factor + term


@kernel("void(float64[::1],float64,int32[::1])")
def _nearest(plane, most, codes):
    """Components in [0, 1], clamped, as whole numbers of [0, most]: to nearest, halves up. NaN becomes 0."""
    separate_loop()
    for i in range(len(plane)):
        value = plane[i] if plane[i] > 0.0 else 0.0
        codes[i] = np.int32((value if value < 1.0 else 1.0) * most + 0.5)


@kernel("void(float64[::1],int32[::1],float64[::1])")
def _look_up(column, codes, plane):
    separate_loop()
    for i in range(len(plane)):
        plane[i] = column[np.uint32(codes[i])]


@kernel("void(float64[::1])")
def _clamp(plane):
    """To [0, 1], as NumPy does: -0.0 stays, and NaN."""
    for i in range(len(plane)):
        value = 0.0 if plane[i] < 0.0 else plane[i]
        plane[i] = 1.0 if value > 1.0 else value


@kernel("void(float64[:,::1],int64,float64[::1])")
def _transform(planes, count, m):
    r, g, b, a = planes[0], planes[1], planes[2], planes[3]
    for i in range(count):
        x, y, z, w = r[i], g[i], b[i], a[i]
        r[i] = m[0] * x + m[1] * y + m[2] * z + m[3] * w
        g[i] = m[4] * x + m[5] * y + m[6] * z + m[7] * w
        b[i] = m[8] * x + m[9] * y + m[10] * z + m[11] * w
        a[i] = m[12] * x + m[13] * y + m[14] * z + m[15] * w


@kernel(f"void({_THROUGH},int64)")
def _through(elements, steps, numbers, entries, planes, codes, count):
    """The first ``count`` groups through all steps, into the first four planes."""
    given = elements.shape[1]
    for k in range(4):
        plane, element = planes[k, :count], steps[0, 1 + k]
        if element < given:
            _take(elements, element, plane)
        else:
            _fill(plane, float(element - given))
    for s in range(1, len(steps)):
        step = steps[s]
        if step[0] == MATRIX:
            _transform(planes, count, numbers[step[1] : step[1] + 16])
            continue
        for k in range(4):
            plane = planes[k, :count]
            if step[0] == ARITHMETIC:
                _scale(plane, numbers[step[1] + k], numbers[step[1] + 4 + k])
            elif step[0] == CLAMPING:
                _clamp(plane)
            elif step[5 + k] > 0:
                column = entries[step[1 + k] : step[1 + k] + step[5 + k]]
                _nearest(plane, len(column) - 1.0, codes[k, :count])
                _look_up(column, codes[k, :count], plane)


@kernel("void(float64[:,::1],int64[::1],int64,float64[:,::1])")
def _interleave(planes, places, count, groups):
    r, g, b, a = planes[places[0]], planes[places[1]], planes[places[2]], planes[places[3]]
    for i in range(count):
        groups[i, 0], groups[i, 1], groups[i, 2], groups[i, 3] = r[i], g[i], b[i], a[i]


@kernel("void(int32[::1],int64,int64)")
def _widen(codes, bits, to):
    """Whole numbers of ``bits`` bits as ones of ``to`` bits: their bits again and again."""
    for i in range(len(codes)):
        word, shift = 0, to - bits
        while shift > -bits:
            word |= codes[i] << shift if shift >= 0 else codes[i] >> -shift
            shift -= bits
        codes[i] = word


@kernel(f"void({_THROUGH},int64[::1],float64[:,::1])")
def transfer(elements, steps, numbers, entries, planes, codes, places, groups):
    """Groups through all steps: ``groups`` float64 [n, 4]. ``places``: 0 to 3."""
    for first in range(0, len(elements), RUN):
        count = min(RUN, len(elements) - first)
        _through(elements[first:], steps, numbers, entries, planes, codes, count)
        _interleave(planes, places, count, groups[first:])


def _texels(elements, steps, numbers, entries, planes, codes, stored_as, made):
    """Groups through all steps, and as texels.

    - ``stored_as``: (places, bits, to): int64 [4], the plane of each component of a texture register;
      int64 [4], what the internal format keeps of each; the bits of a texel's component: 2**to - 1 is one.
    - ``made``: (registers, texels), which receive them: float64 [n, 4] and [n, 4].
    """
    (places, bits, to), (registers, texels) = stored_as, made
    _fill(planes[ZEROS], 0.0)
    _fill(planes[ONES], 1.0)
    for first in range(0, len(elements), RUN):
        count = min(RUN, len(elements) - first)
        _through(elements[first:], steps, numbers, entries, planes, codes, count)
        _interleave(planes, places, count, registers[first:])
        for k in range(4):
            code = codes[k, :count]
            _nearest(planes[places[k], :count], (1 << bits[k]) - 1.0, code)
            if bits[k] != to:
                _widen(code, bits[k], to)
        r, g, b, a, stored = codes[0], codes[1], codes[2], codes[3], texels[first:]
        for i in range(count):
            stored[i, 0], stored[i, 1], stored[i, 2], stored[i, 3] = r[i], g[i], b[i], a[i]


_STORED = f"void({_THROUGH},Tuple((int64[::1],int64[::1],int64)),Tuple((float64[:,::1],%s[:,::1])))"
# For components of 8 bits, and for wider ones.
texels_in_bytes = kernel(_STORED % "uint8")(_texels)
texels_in_words = kernel(_STORED % "uint16")(_texels)
