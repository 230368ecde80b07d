"""Pixel transfer, one pixel group at a time, in plain floats; sums and products are in the order written.

Images are lists of rows, bottom row first, of groups [r, g, b, a], of depths or of indices. A component in
fixed point begins as a Fraction. A stage at its initial value is computed like any other.
Source: OpenGL 1.2.1 sections 3.6.3, 3.6.5 and 4.3.2; SGI_color_table, SGI_color_matrix, EXT_convolution,
EXT_histogram, SGI_texture_color_table.
"""

from fractions import Fraction
from math import floor, inf, nextafter

from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode

MOST = 2**32 - 1  # of a histogram's counter

# Which component of an entry goes with a pixel's R, G, B and A; None: the pixel's component stays.
# Source: tables 3.13 and 3.14.
ENTRY_COMPONENT = {
    BaseFormat.ALPHA: (None, None, None, 3),
    BaseFormat.LUMINANCE: (0, 0, 0, None),
    BaseFormat.LUMINANCE_ALPHA: (0, 0, 0, 3),
    BaseFormat.INTENSITY: (0, 0, 0, 0),
    BaseFormat.RGB: (0, 1, 2, None),
    BaseFormat.RGBA: (0, 1, 2, 3),
}
# Which components of a group a histogram or minmax of a base format looks at.
# Source: section 3.6.5, Histogram and Minmax.
COUNTED = {
    BaseFormat.ALPHA: (3,),
    BaseFormat.LUMINANCE: (0,),
    BaseFormat.LUMINANCE_ALPHA: (0, 3),
    BaseFormat.RGB: (0, 1, 2),
    BaseFormat.RGBA: (0, 1, 2, 3),
}


def clamp(value):
    """To [0, 1]. Source: OpenGL 1.2.1 section 3.6.5, as wherever it clamps."""
    return min(max(value, 0.0), 1.0)


def nearest(value):
    """To the nearest integer, halves up. Source: OpenGL 1.2.1 section 2.13.9; Assumed: the halves."""
    return floor(value + 0.5)


def to_fixed(value, bits):
    """A component in fixed point. Source: OpenGL 1.2.1 section 2.13.9."""
    return nearest(clamp(value) * (2**bits - 1))


def component(value, bits, signed):
    """A component of an integer type. Source: OpenGL 1.2.1 table 2.6."""
    return Fraction(2 * value + 1 if signed else value, 2**bits - 1)


def _widths(packed):
    """Bits of a packed type's components, from the highest down. Source: OpenGL 1.2.1 tables 3.9 to 3.11."""
    return [int(width) for width in packed.split("_") if width.isdigit()]


def unpacked(word, packed):
    """The elements of a word of a packed type. Source: OpenGL 1.2.1 section 3.6.4, tables 3.8 to 3.12."""
    elements, place = [], sum(_widths(packed))
    for width in _widths(packed):
        place -= width
        elements.append(Fraction((word >> place) % 2**width, 2**width - 1))
    return elements[::-1] if packed.endswith("_REV") else elements


def packed_word(elements, packed):
    """The word of elements. Source: OpenGL 1.2.1 table 4.7: each is converted at its own width."""
    word = 0
    in_order = elements[::-1] if packed.endswith("_REV") else elements
    for element, width in zip(in_order, _widths(packed), strict=True):
        word = (word << width) + to_fixed(element, width)
    return word


def to_signed(value, bits):
    """A component of a signed type. Source: OpenGL 1.2.1 table 4.7; Assumed: to nearest, halves up."""
    return nearest(((2**bits - 1) * clamp(value) - 1.0) / 2.0)


def pixel_of(elements, pixel_format):
    """The RGBA group of an image's group of elements, all floats or all Fractions. Source: OpenGL 1.2.1
    section 3.6.4.
    """
    number = type(elements[0])
    if pixel_format in ("LUMINANCE", "LUMINANCE_ALPHA"):
        return [elements[0]] * 3 + (list(elements[1:]) or [number(1)])
    names = {"RED": "R", "GREEN": "G", "BLUE": "B", "ALPHA": "A"}.get(pixel_format, pixel_format)
    return [elements[names.index(c)] if c in names else number(c == "A") for c in "RGBA"]


def scaled(value, scale, bias):
    """Arithmetic on Components. Source: OpenGL 1.2.1 section 3.6.5."""
    return value * scale + bias


def scaled_first(value, scale, bias):
    """The same of what groups begin with: of a word, which is a Fraction, in real numbers, and then the least
    float64 that is not below the result; without scale and bias the nearest. Source: OpenGL 1.2.1 section
    3.6.5. Inferred: that a half goes up, from SGI's Sample Implementation 1.2.1.
    """
    if not isinstance(value, Fraction):
        return scaled(value, scale, bias)
    exact = value * Fraction(scale) + Fraction(bias)
    near = float(exact)
    return nextafter(near, inf) if Fraction(near) < exact and (scale, bias) != (1, 0) else near


def mapped(value, table):
    """RGBA to RGBA Lookup, of one component. Source: OpenGL 1.2.1 section 3.6.5."""
    return table[nearest(clamp(value) * (len(table) - 1))]


def index(value, state):
    """Arithmetic on Indices. Source: OpenGL 1.2.1 section 3.6.5."""
    shift = state.index_shift
    return (value << shift if shift > 0 else value >> -shift) + state.index_offset


def color_of_index(value, state):
    """Color Index Lookup, to RGBA. Source: OpenGL 1.2.1 section 3.6.5."""
    maps = (state.maps.i_to_r, state.maps.i_to_g, state.maps.i_to_b, state.maps.i_to_a)
    return [table[index(value, state) & (len(table) - 1)] for table in maps]


def stencil_index(value, state):
    """Arithmetic on Indices and Stencil Index Lookup. Source: OpenGL 1.2.1 section 3.6.5."""
    value = index(value, state)
    if state.map_stencil:
        value = state.maps.s_to_s[value & (len(state.maps.s_to_s) - 1)]
    return value


def table_entry(table, number, component):
    """A component of a colour table's entry as it is stored. Source: OpenGL 1.2.1 section 3.6.3."""
    value = clamp(table.entries[number][component])
    return value if table.bits is None else to_fixed(value, table.bits) / (2**table.bits - 1)


def looked_up(group, table):
    """Color Table Lookup. Source: OpenGL 1.2.1 section 3.6.5."""
    found = []
    for value, component in zip(group, ENTRY_COMPONENT[table.base_format], strict=True):
        if component is not None:
            value = table_entry(table, nearest(clamp(value) * (len(table.entries) - 1)), component)
        found.append(value)
    return found


def texture_color(texel, one, table):
    """A texel in units of ``one``, which entries are rounded to. Source: SGI_texture_color_table."""
    found = []
    for value, component in zip(texel, ENTRY_COMPONENT[table.base_format], strict=True):
        if component is not None:
            inside = min(max(value, 0), one)
            number = (2 * inside * (len(table.entries) - 1) + one) // (2 * one)
            value = nearest(table_entry(table, number, component) * one)
        found.append(value)
    return found


def _source_pixel(image, i, j, kernel):
    """What is read at column i of row j, perhaps outside. Source: OpenGL 1.2.1 section 3.6.5."""
    height, width = len(image), len(image[0])
    if 0 <= i < width and 0 <= j < height:
        return image[j][i]
    if kernel.border_mode == ConvolutionBorderMode.CONSTANT_BORDER:
        return kernel.border_color
    return image[min(max(j, 0), height - 1)][min(max(i, 0), width - 1)]


def convolved(image, kernel):
    """Convolution by a ConvolutionFilter or SeparableFilter; [] or rows [] where REDUCE leaves nothing, which
    is no error.

    Source: OpenGL 1.2.1 section 3.6.5; EXT_convolution.
    """
    separable = hasattr(kernel, "row")
    wide = len(kernel.row) if separable else len(kernel.rows[0])
    high = len(kernel.column) if separable else len(kernel.rows)
    reduce = kernel.border_mode == ConvolutionBorderMode.REDUCE
    width = (len(image[0]) if image else 0) - (wide - 1) * reduce
    height = len(image) - (high - 1) * reduce
    left, below = (0, 0) if reduce else (wide // 2, high // 2)
    result = []
    for j in range(height):
        row = []
        for i in range(width):
            group = list(image[j][i])
            for k, component in enumerate(ENTRY_COMPONENT[kernel.base_format]):
                if component is None:
                    continue
                total = 0.0
                for n in range(wide):
                    for m in range(high):
                        value = _source_pixel(image, i - left + n, j - below + m, kernel)[k]
                        if separable:
                            term = value * kernel.row[n][component] * kernel.column[m][component]
                        else:
                            term = value * kernel.rows[m][n][component]
                        total = total + term
                group[k] = total
            row.append(group)
        result.append(row)
    return result


INITIAL_MATRIX = tuple(tuple(float(i == j) for j in range(4)) for i in range(4))


def has_color_matrix(state):
    """Whether a state asks for the colour matrix's stage. Inferred: signed results are lost "of" the matrix;
    Assumed: with scale and bias after it, which are of the same stage of OpenGL 1.2.1 section 3.6.5. A minmax
    on the machine after a post-convolution bias, with no matrix, would settle it.
    """
    return (
        state.color_matrix != INITIAL_MATRIX
        or state.post_color_matrix_scale != (1.0, 1.0, 1.0, 1.0)
        or state.post_color_matrix_bias != (0.0, 0.0, 0.0, 0.0)
    )


def transformed(group, state, clamps):
    """Color Matrix Transformation. Source: OpenGL 1.2.1 section 3.6.5; SGI_color_matrix. ``clamps``: the
    machine clamps after scale and bias, where a state asks for either. Source: Kautz, Seidel 2000, section 5.
    """
    clamps = clamps and has_color_matrix(state)
    r, g, b, a = group
    result = []
    for k, (x, y, z, w) in enumerate(state.color_matrix):
        value = x * r + y * g + z * b + w * a
        value = scaled(value, state.post_color_matrix_scale[k], state.post_color_matrix_bias[k])
        result.append(clamp(value) if clamps else value)
    return result


def new_counts(histogram):
    """An empty histogram: rows of counters. Source: OpenGL 1.2.1 section 3.6.3."""
    return [[0] * len(COUNTED[histogram.base_format]) for _ in range(histogram.width)]


def new_extremes(minmax):
    """A minmax that has seen nothing. Source: OpenGL 1.2.1 section 3.6.3."""
    components = len(COUNTED[minmax.base_format])
    return [[inf] * components, [-inf] * components]


def count(group, histogram, counts):
    """Histogram: count one group, in place. Source: OpenGL 1.2.1 section 3.6.5; Assumed: MOST stays."""
    for k, component in enumerate(COUNTED[histogram.base_format]):
        number = nearest(clamp(group[component]) * (histogram.width - 1))
        counts[number][k] = min(counts[number][k] + 1, MOST)


def compare(group, minmax, extremes):
    """Minmax: look at one group, in place. Source: OpenGL 1.2.1 section 3.6.5."""
    for k, component in enumerate(COUNTED[minmax.base_format]):
        if group[component] < extremes[0][k]:
            extremes[0][k] = group[component]
        if group[component] > extremes[1][k]:
            extremes[1][k] = group[component]


def before_color_table(group, state):
    """Arithmetic and RGBA to RGBA Lookup. Source: OpenGL 1.2.1 section 3.6.5."""
    maps = (state.maps.r_to_r, state.maps.g_to_g, state.maps.b_to_b, state.maps.a_to_a)
    group = [scaled_first(*values) for values in zip(group, state.scale, state.bias, strict=True)]
    if state.map_color:
        group = [mapped(value, table) for value, table in zip(group, maps, strict=True)]
    return group


def after_convolution(group, state, clamps_color_matrix):
    """The second and third color table and what is between them. Source: OpenGL 1.2.1 section 3.6.5."""
    if state.post_convolution_color_table is not None:
        group = looked_up(group, state.post_convolution_color_table)
    group = transformed(group, state, clamps_color_matrix)
    if state.post_color_matrix_color_table is not None:
        group = looked_up(group, state.post_color_matrix_color_table)
    return group


def transfer(image, state, dimensions, clamps_color_matrix, counts, extremes, indices=False):
    """An image of groups (``indices``: of colour indices) through all operations: rows, or None where a sink
    took it. ``counts``, ``extremes``: of the state's histogram and minmax, changed in place.
    Source: OpenGL 1.2.1 section 3.6.5.
    """
    if indices:
        image = [[color_of_index(value, state) for value in row] for row in image]
    else:
        image = [[before_color_table(group, state) for group in row] for row in image]
    if state.color_table is not None:
        image = [[looked_up(group, state.color_table) for group in row] for row in image]
    kernel = {1: state.convolution_1d, 2: state.convolution_2d or state.separable_2d}.get(dimensions)
    if kernel is not None:
        scale, bias = state.post_convolution_scale, state.post_convolution_bias
        image = [
            [[scaled(*values) for values in zip(group, scale, bias, strict=True)] for group in row]
            for row in convolved(image, kernel)
        ]
    image = [[after_convolution(group, state, clamps_color_matrix) for group in row] for row in image]
    if state.histogram is not None:
        for row in image:
            for group in row:
                count(group, state.histogram, counts)
        if state.histogram.sink:
            return None
    if state.minmax is not None:
        for row in image:
            for group in row:
                compare(group, state.minmax, extremes)
        if state.minmax.sink:
            return None
    return image


def transfer_depth(value, state):
    """A depth in [0, 1] through arithmetic, clamped. Source: OpenGL 1.2.1 sections 3.6.5, 3.6.4."""
    return clamp(scaled(value, state.depth_scale, state.depth_bias))


def component_read(group, pixel_format, pixel_type):
    """What ReadPixels and GetTexImage return: a list of integers or floats, or a packed type's word. Source:
    OpenGL 1.2.1 section 4.3.2.
    """
    r, g, b, a = group
    luminance = r + g + b
    elements = {
        "RGBA": [r, g, b, a],
        "RGB": [r, g, b],
        "BGRA": [b, g, r, a],
        "BGR": [b, g, r],
        "RED": [r],
        "GREEN": [g],
        "BLUE": [b],
        "ALPHA": [a],
        "LUMINANCE": [luminance],
        "LUMINANCE_ALPHA": [luminance, a],
    }[pixel_format]
    if pixel_type == "FLOAT":
        return [clamp(value) for value in elements]
    if _widths(pixel_type):
        return packed_word(elements, pixel_type)
    bits = {"BYTE": 8, "SHORT": 16, "INT": 32}[pixel_type.removeprefix("UNSIGNED_")]
    convert = to_fixed if pixel_type.startswith("UNSIGNED") else to_signed
    return [convert(value, bits) for value in elements]
