"""Texture sampling: coordinates, level of detail, wrap modes and filters, one fragment at a time.

A texture has ``target``, ``internal_format`` and ``levels`` [level][face][row][column][component] of bytes,
bottom row first; and ``border``, how many texels of a level on either side are its border. One of other than
bytes has ``bits``, and one that is filtered by other fractions than of 8 bits, ``fraction_bits``. A
coordinate T counts texels.
"""

from dataclasses import dataclass
from decimal import Decimal, localcontext
from functools import cache, partial
from math import ceil, copysign, floor, frexp, isfinite, sqrt, trunc

from fixedpipe.pipeline.enums import (
    InternalFormat,
    MagnificationThreshold,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from tests.reference import coverage, fixed, interpolate, texel_formats

TAU = 2.0**-24  # Inferred: texels; below what silicon resolves, above the noise of float64
SMALLEST_LAMBDA, LARGEST_LAMBDA = -(2**20), 2**20  # Assumed: beyond every clamp

# For each face: sc, tc and the positive major axis as (axis, sign).  Source: EXT_texture_cube_map's table.
FACES = (
    ((2, -1), (1, -1), (0, 1)),
    ((2, 1), (1, -1), (0, -1)),
    ((0, 1), (2, 1), (1, 1)),
    ((0, 1), (2, -1), (1, -1)),
    ((0, 1), (1, -1), (2, 1)),
    ((0, -1), (1, -1), (2, -1)),
)

NEAREST_IN_LEVEL = (
    TextureFilter.NEAREST,
    TextureFilter.NEAREST_MIPMAP_NEAREST,
    TextureFilter.NEAREST_MIPMAP_LINEAR,
)


@dataclass(frozen=True)
class TexturedTriangle:
    """What sampling needs of a triangle: its edges, 1/w and (s, t, r, q) of its three vertices; whether they
    are divided by q, which all of the mesh's vertices decide.
    """

    edges: coverage.Triangle
    inverse_w: tuple
    coordinates: tuple
    divided: bool


# ------------------------------------------------------------------------------------------------ coordinates


def iterate_coordinates(coordinates, weights):
    """(s, t, r, q) of a fragment. Measured: CylinderWrapping, Anisotropy-1."""
    return tuple(
        interpolate.iterate_coordinate([vertex[k] for vertex in coordinates], weights) for k in range(4)
    )


def exact_coordinates(coordinates, b0, b2):
    """(s, t, r, q) of a point of a footprint. Source: OpenGL 1.2.1 equation 3.4."""
    return tuple(interpolate.iterate([vertex[k] for vertex in coordinates], b0, b2) for k in range(4))


def has_unit_q(coordinates):
    """Whether q is one at every vertex of a mesh. Source: OpenGL 1.2.1 section 3.8 (nothing is divided)."""
    return all(vertex[3] == 1.0 for vertex in coordinates)


def divisor(q):
    """What coordinates are divided by. Measured: Texture_Matrix Arbitrary; Inferred: the power, from RCC."""
    return 2.0**-64 if q == 0.0 else q


def divide_by_q(strq, divided):
    """(s, t, r) as lambda takes them, ``divided`` by q or not. Source: OpenGL 1.2.1 section 3.8."""
    *str_, q = strq
    if not divided:
        return tuple(str_)
    return tuple(coordinate / divisor(q) for coordinate in str_)


def projected(strq, divided):
    """(s, t, r, q) of a texture's access, ``divided`` by q or not: by a reciprocal, and cut to 24 bits.

    Measured: docs/numbers.md, N6.1.
    """
    if not divided:
        return strq
    *str_, q = strq
    fraction, exponent = frexp(divisor(q))
    inverse = 1.0 / fraction  # of what is not finite: 0, and no number
    if isfinite(q):
        inverse = copysign(interpolate.reciprocal(abs(fraction)), fraction)
    products = (fixed.keep_significant_bits(c * inverse, interpolate.WEIGHT_BITS) for c in str_)
    half = -exponent // 2  # in two steps, as a power of two may itself be too large
    return (*(p * 2.0**half * 2.0 ** (-exponent - half) for p in products), 1.0)


def cube_map_face(strq):
    """The face of the largest magnitude. Source: EXT_texture_cube_map; Assumed: x before y before z when
    equal, -z where one is not a number.
    """
    x, y, z = (abs(component) for component in strq[:3])
    axis = 0 if x >= y and x >= z else 1 if y >= z else 2
    return 2 * axis + (0 if strq[axis] >= 0.0 else 1)


def face_components(strq, face):
    """(sc, tc, major axis towards the face). Source: EXT_texture_cube_map's table."""
    return tuple(float(sign) * strq[axis] for axis, sign in FACES[face])


def face_coordinates(strq, face, size):
    """(T_s, T_t) on a face. Measured: nearest filters, 56909 of 56909 pixels."""
    sc, tc, major = face_components(strq, face)
    if not major > 0.0:
        return 0.0, 0.0  # Measured: 70 of 70 pixels (DotReflectSpec_1_-1to1); Assumed: where it is no number
    return (sc / major + 1.0) * (0.5 * float(size)), (tc / major + 1.0) * (0.5 * float(size))


# -------------------------------------------------------------------------------------------- level of detail


@cache
def octave_fractions():
    """2^(k/128), k = 0..127, each the nearest float64. Source: docs/numbers.md section 7."""
    with localcontext() as context:
        context.prec = 40
        return tuple(float((Decimal(k) * Decimal(2).ln() / 128).exp()) for k in range(128))


def lambda_of(rho2):
    """Lambda with 8 fraction bits, floor(128 log2(rho2)), from the squared scale factor.

    Source: OpenGL 1.2.1 section 3.8.5; Measured: 8 fraction bits, cut (LODBias).
    """
    if rho2 == 0.0:
        return SMALLEST_LAMBDA
    mantissa, exponent = frexp(rho2)
    return 128 * (exponent - 1) + sum(2.0 * mantissa >= step for step in octave_fractions()) - 1


def footprint_point(triangle, px, py, texture, face, base=0):
    """(T_s, T_t) of the base level at a pixel that the triangle need not cover, or None where there are none.

    Source: docs/numbers.md section 7.
    """
    e = interpolate.perspective_terms(coverage.edge_values(triangle.edges, px, py), triangle.inverse_w)
    d = interpolate.denominator(e)
    if d <= 0.0:
        return None
    inverse = 1.0 / d
    strq = exact_coordinates(triangle.coordinates, e[0] * inverse, e[2] * inverse)
    if texture.target == TextureTarget.TEXTURE_CUBE_MAP:
        if face is None:
            face = cube_map_face(strq)
        if not face_components(strq, face)[2] > 0.0:
            return None
        return (*face_coordinates(strq, face, level_size(texture, base)[1]), face)
    sizes = texel_scales(texture, base)
    str_ = divide_by_q(strq, triangle.divided)
    # A coordinate that the target has not takes no part, infinite or not.
    return (*(c * scale if scale else 0.0 for c, scale in zip(str_, sizes, strict=True)), face)


def squared_scale_factor(triangle, px, py, texture, base=0):
    """Rho squared of the 2x2 block that holds the pixel, or None where a point of it has no coordinates.

    Measured: one value per block; footprints along an axis; Source: OpenGL 1.2.1 equation 3.15.
    """
    x, y = px & ~1, py & ~1
    origin = footprint_point(triangle, x, y, texture, None, base)
    if origin is None:
        return None
    right = footprint_point(triangle, x + 1, y, texture, origin[-1], base)
    below = footprint_point(triangle, x, y + 1, texture, origin[-1], base)
    if right is None or below is None:
        return None
    lengths = []
    for point in (right, below):
        steps = [a - b for a, b in zip(point[:-1], origin[:-1], strict=True)]
        lengths.append(sum(step * step for step in steps))
    return max(lengths) if all(isfinite(length) for length in lengths) else None


def level_of_detail(triangle, px, py, texture, bias, base=0):
    """Lambda of a fragment in 1/256 level, bias added, not clamped.

    Measured: LODBias; Assumed: the bias is truncated.
    """
    rho2 = squared_scale_factor(triangle, px, py, texture, base)
    return (LARGEST_LAMBDA if rho2 is None else lambda_of(rho2)) + trunc(256.0 * bias)


def magnification_threshold(sampler, profile):
    """The largest lambda that magnifies. Source: OpenGL 1.2.1 section 3.8.6; Measured: 0 on the chip."""
    if (
        profile.arithmetic.magnification_threshold == MagnificationThreshold.OPENGL_C
        and sampler.mag_filter == TextureFilter.LINEAR
        and sampler.min_filter in (TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.NEAREST_MIPMAP_LINEAR)
    ):
        return 128
    return 0


# --------------------------------------------------------------------------------------------- wrap and fetch


def borders(texture):
    """The border's width along s, t and r, 0 where a texture names none.

    Source: OpenGL 1.2.1 section 3.8.1 (the height of a 1D image is 1, the depth of a 2D one).
    """
    width = getattr(texture, "border", 0)
    rows = 0 if texture.target == TextureTarget.TEXTURE_1D else width
    return width, rows, width if texture.target == TextureTarget.TEXTURE_3D else 0


def wrap_coordinate(t, mode, size, border=0):
    """T brought into the texture's range. Source: OpenGL 1.2.1 section 3.8.4 and the wrap extensions;
    Inferred: that CLAMP_TO_BORDER ends in the middle of the last of several border texels.
    """
    n = float(size)
    if mode == WrapMode.REPEAT:
        t = t - n * fixed.floor_float(t * (1.0 / n))
    elif mode == WrapMode.MIRRORED_REPEAT:
        t = t - 2.0 * n * fixed.floor_float(t * (1.0 / (2.0 * n)))
    low, high = {
        WrapMode.REPEAT: (0.0, n),
        WrapMode.MIRRORED_REPEAT: (0.0, 2.0 * n),
        WrapMode.CLAMP: (0.0, n),
        WrapMode.CLAMP_TO_EDGE: (0.5, n - 0.5),
        WrapMode.CLAMP_TO_BORDER: (-0.5, n + 0.5) if border < 2 else (0.5 - border, n - 0.5 + border),
    }[mode]
    return fixed.clamp(t, low, high) if t == t else low  # not a number: the range's lower end


def wrap_index(i, mode, size, *, linear, border=0):
    """A texel index inside 0..size-1, or of a border texel outside, or None for the border colour.

    Measured: nearest, 78720 of 78720; Source: OpenGL 1.2.1 section 3.8.5 for the border.
    """
    if 0 <= i < size:
        return i
    if mode == WrapMode.REPEAT:
        return i % size
    if mode == WrapMode.MIRRORED_REPEAT:  # Measured: nearest, 48768 of 48768 pixels (CylinderWrapping)
        i %= 2 * size
        return min(i, 2 * size - 1 - i)
    if mode == WrapMode.CLAMP_TO_BORDER or (mode == WrapMode.CLAMP and linear):
        return i if -border <= i < size + border else None
    return fixed.clamp(i, 0, size - 1)


def level_size(texture, level):
    """(height, width) without the border. Source: OpenGL 1.2.1 section 3.8.5 (mipmap sizes)."""
    rows, (beside, below, _) = texture.levels[level][0], borders(texture)
    return len(rows) - 2 * below, len(rows[0]) - 2 * beside


def layers_of(texture, level):
    """Layers of a 3D texture's level, without the border. Source: OpenGL 1.2.1 section 3.8.1."""
    return len(texture.levels[level]) - 2 * borders(texture)[2]


def texel_scales(texture, level):
    """What s, t and r are multiplied by to count texels; 0 for what the target has not.

    Source: OpenGL 1.2.1 section 3.8.5; NV_texture_rectangle (coordinates that count texels already).
    """
    height, width = level_size(texture, level)
    return {
        TextureTarget.TEXTURE_1D: (float(width), 0.0, 0.0),
        TextureTarget.TEXTURE_3D: (float(width), float(height), float(layers_of(texture, level))),
        TextureTarget.TEXTURE_RECTANGLE: (1.0, 1.0, 0.0),
    }.get(texture.target, (float(width), float(height), 0.0))


def signed_flags(sampler):
    """Which of red, green, blue and alpha are two's complement. Source: NV_texture_shader."""
    signed = sampler.signed_components
    return signed.red, signed.green, signed.blue, signed.alpha


def as_signed(texel, sampler):
    """A texel whose signed components are numbers from -128 to 127. Source: NV_texture_shader."""
    flags = signed_flags(sampler)
    return [b - 256 if flag and b > 127 else b for b, flag in zip(texel, flags, strict=True)]


def to_register(texel, sampler):
    """Signed components are doubled. Measured: 732800 of 732800 pixels (Texture_signed_component_tests)."""
    return [2 * c if flag else c for c, flag in zip(texel, signed_flags(sampler), strict=True)]


def fetch(texture, level, face, i, j, border, sampler):
    """One texel, or the border colour where an index is None. Source: OpenGL 1.2.1 section 3.8.5, figure 3.10
    (where border texels lie).
    """
    if face is None or i is None or j is None:
        return border
    beside, below, before = borders(texture)
    return as_signed(texture.levels[level][face + before][j + below][i + beside], sampler)


def sample_nearest(texture, level, face, t, modes, border, sampler):
    """Source: OpenGL 1.2.1 section 3.8.5; Measured: floor."""
    height, width = level_size(texture, level)
    beside, below, _ = borders(texture)
    i = wrap_index(floor(t[0]), modes[0], width, linear=False, border=beside)
    j = wrap_index(floor(t[1]), modes[1], height, linear=False, border=below)
    return list(fetch(texture, level, face, i, j, border, sampler))


def fraction_bits(texture):
    """Bits of a linear filter's fractions. Measured: 8 (349524 of 349524 pixels); Assumed: other widths."""
    return getattr(texture, "fraction_bits", 8)


def linear_position(t, bits=8):
    """(lower index, fraction of so many bits). Measured: 349524 of 349524 pixels."""
    position = floor((t - 0.5) * 2.0**bits)
    return position >> bits, position & ((1 << bits) - 1)


# Source: NV_texture_shader (HILO); Measured: BumpMap_Y16, 303512 of 303512 pixels.
OF_WORDS = (InternalFormat.HILO16, InternalFormat.SIGNED_HILO16, InternalFormat.LUMINANCE16)


def lerp_words(p, q, fraction, bits):
    """A texel between two, as two words of 16 bits with the signs of their high bytes, which alpha and green
    are. Measured: Bump_map's R16B16 captures (docs/numbers.md section 12).
    """
    (r0, g0, b0, a0), (r1, g1, b1, a1) = p, q
    high = fixed.lerp(256 * a0 + r0 % 256, 256 * a1 + r1 % 256, fraction, bits)
    low = fixed.lerp(256 * g0 + b0 % 256, 256 * g1 + b1 % 256, fraction, bits)
    return [high % 256, low >> 8, low % 256, high >> 8]


def lerp_components(p, q, fraction, bits=8):
    """A texel between two, each component by itself. Source: docs/numbers.md section 7."""
    return [fixed.lerp(a, b, fraction, bits) for a, b in zip(p, q, strict=True)]


def sample_linear(texture, level, face, t, modes, border, sampler):
    """Rows first, each to bytes, then between the rows. Measured: 349524 of 349524 pixels."""
    lerp = lerp_words if texture.internal_format in OF_WORDS else lerp_components
    bits = fraction_bits(texture)
    (height, width), (beside, below, _) = level_size(texture, level), borders(texture)
    i, a = linear_position(t[0], bits)
    columns = [wrap_index(k, modes[0], width, linear=True, border=beside) for k in (i, i + 1)]
    if texture.target == TextureTarget.TEXTURE_1D:
        j, b, lines = 0, 0, [0, 0]
    else:
        j, b = linear_position(t[1], bits)
        lines = [wrap_index(k, modes[1], height, linear=True, border=below) for k in (j, j + 1)]
    rows = []
    for line in lines:
        p, q = (fetch(texture, level, face, column, line, border, sampler) for column in columns)
        rows.append(lerp(p, q, a, bits))
    return lerp(rows[0], rows[1], b, bits)


def face_modes(texture, sampler):
    """The wrap modes on a cube map's face. Measured: CLAMP_TO_EDGE, and with a border CLAMP_TO_BORDER, which
    reads it (Cube_BorderTex_SZ_2x2, _16x16, _32x32). Inferred: CLAMP likewise.
    """
    read = WrapMode.CLAMP, WrapMode.CLAMP_TO_BORDER
    bordered = borders(texture)[0] > 0
    return [
        mode if bordered and mode in read else WrapMode.CLAMP_TO_EDGE
        for mode in (sampler.wrap_s, sampler.wrap_t)
    ]


def sample_level(triangle, strq, texture, sampler, profile, level, filter_mode, *, flat=False, offset=False):
    """One level, filtered to bytes. Source: OpenGL 1.2.1 sections 3.8.4 to 3.8.6.

    ``triangle`` None: a texture shader made the coordinates; ``offset``: by moving iterated ones. ``flat``: s
    and t, t downwards, on a cube map's first face.
    """
    nearest = filter_mode in NEAREST_IN_LEVEL
    height, width = level_size(texture, level)
    if texture.target == TextureTarget.TEXTURE_CUBE_MAP:
        face = 0 if flat else cube_map_face(strq)
        lift = 0.0 if triangle is None else TAU  # Measured: DotSTR3D_-1to1, DotReflectConst_1_-1to1
        t = [v + lift for v in face_coordinates((1.0, strq[1], -strq[0]) if flat else strq, face, width)]
        modes = face_modes(texture, sampler)
    else:
        face, modes = 0, (sampler.wrap_s, sampler.wrap_t)
        bias = TAU if triangle is None and not offset else 0.0
        scales = texel_scales(texture, level)
        *t, third = (c * scale + bias for c, scale in zip(strq[:3], scales, strict=True))
    if texture.target == TextureTarget.TEXTURE_1D:
        t[1], modes = 0.0, (modes[0], WrapMode.REPEAT)
    beside, below, before = borders(texture)
    t = [
        wrap_coordinate(v, *given)
        for v, *given in zip(t, modes, (width, height), (beside, below), strict=True)
    ]
    one = (1 << getattr(texture, "bits", 8)) - 1
    as_given = profile.textures.border_color_as_given
    border = texel_formats.border_texel(sampler.border_color, texture.internal_format, one, as_given=as_given)
    border = as_signed(border, sampler)
    read = sample_nearest if nearest else sample_linear
    if texture.target != TextureTarget.TEXTURE_3D:
        return read(texture, level, face, t, modes, border, sampler)
    layers = layers_of(texture, level)
    third = wrap_coordinate(third, sampler.wrap_r, layers, before)
    bits = fraction_bits(texture)
    k, fraction = (floor(third), 0) if nearest else linear_position(third, bits)
    found = [
        read(
            texture,
            level,
            wrap_index(n, sampler.wrap_r, layers, linear=not nearest, border=before),
            t,
            modes,
            border,
            sampler,
        )
        for n in ((k,) if nearest else (k, k + 1))
    ]
    return lerp_components(found[0], found[-1], fraction, bits)


def block_steps(triangle, px, py, texture, base):
    """The steps from the 2x2 block's origin to its neighbours to the right and below in texture coordinates,
    and their squared lengths in texels; None where they are not finite numbers.

    Measured: Texture_anisotropy.
    """
    x, y = px & ~1, py & ~1
    width, height = texel_scales(texture, base)[:2]
    points = []
    for at in ((x, y), (x + 1, y), (x, y + 1)):
        e = interpolate.perspective_terms(coverage.edge_values(triangle.edges, *at), triangle.inverse_w)
        d = interpolate.denominator(e)
        if d <= 0.0:
            return None
        strq = exact_coordinates(triangle.coordinates, e[0] * (1.0 / d), e[2] * (1.0 / d))
        points.append(divide_by_q(strq, triangle.divided)[:2])
    steps = [(s - points[0][0], t - points[0][1]) for s, t in points[1:]]
    squares = [(s * width) * (s * width) + (t * height) * (t * height) for s, t in steps]
    return (steps, squares) if all(isfinite(square) for square in squares) else None


def block_footprint(triangle, px, py, texture, sampler):
    """The longer step from the 2x2 block's origin to its neighbours in texture coordinates, how many times
    longer it is than the other or than one texel, and lambda of that part of it.

    Measured: Texture_anisotropy; Source: EXT_texture_filter_anisotropic (what the ratio is).
    """
    found = block_steps(triangle, px, py, texture, sampler.base_level)
    if found is None:
        return 0.0, 0.0, 1.0, LARGEST_LAMBDA
    steps, squares = found
    ratio = min(max(sqrt(max(squares)) / max(sqrt(min(squares)), 1.0), 1.0), sampler.max_anisotropy)
    rho2 = max(squares) / (ratio * ratio)
    step = steps[0] if squares[0] >= squares[1] else steps[1]
    return *step, ratio, lambda_of(rho2)


def taps(ratio):
    """(position along the footprint, weight in 1/256) of the filtered texels that an anisotropic filter sums.

    Measured: Anisotropy-2 and -4, 19400 of 19413 pixels up to a ratio of two, 24029 of 24116 beyond;
    Inferred: the two thirds (.53 to .80 fit upright footprints).
    """
    if ratio <= 2.0:
        distance = (ratio - 1.0) / (2.0 * ratio)
        return [(distance, 128), (-distance, 128)]
    pairs = ceil(ratio / 2.0)
    inner = floor(256.0 / ratio + 2.0 / 3.0)
    result = []
    for pair in range(pairs):
        weight = inner if pair < pairs - 1 else 128 - inner * (pairs - 1)
        distance = (pair + 0.5) / ratio
        result += [(distance, weight), (-distance, weight)]
    return result


def sample_along(triangle, strq, px, py, texture, sampler, bias, profile):
    """An anisotropically filtered texel. Source: docs/numbers.md section 7; Measured: as ``taps``."""
    s, t, *_ = projected(strq, triangle.divided)
    along_s, along_t, ratio, lod = block_footprint(triangle, px, py, texture, sampler)
    lod = limited(lod + trunc(256.0 * bias), sampler)
    total = [128] * 4
    for distance, weight in taps(ratio):
        moved = (s + distance * along_s, t + distance * along_t, 0.0, 1.0)
        level = partial(sample_level, triangle, moved, texture, sampler, profile)
        texel = filter_levels(level, lod, texture, sampler, profile)
        total = [a + weight * c for a, c in zip(total, texel, strict=True)]
    return [a >> 8 for a in total]


def block_probes(triangle, px, py, texture, sampler):
    """The longer step from the 2x2 block's origin to its neighbours in texture coordinates, how many probes
    lie along it, and lambda of a probe.

    Source: Schilling, Knittel, Strasser 1996 (footprint assembly); Assumed: the nearest power of two of the
    ratio of the steps, in octaves, and the shorter step counted as one texel where it is less.
    """
    found = block_steps(triangle, px, py, texture, sampler.base_level)
    if found is None:
        return 0.0, 0.0, 1, LARGEST_LAMBDA
    steps, squares = found
    probes, rho2 = probes_of(max(squares), min(squares), sampler.max_probes, sampler.exact_probes)
    return *(steps[0] if squares[0] >= squares[1] else steps[1]), probes, lambda_of(rho2)


def probes_of(longer, shorter, most, exact):
    """How many probes lie along a footprint with these sides, squares in texels, and rho squared of each.
    ``exact``: as many as cover it, not a power of two.

    Source, Assumed: as ``block_probes``.
    """
    wanted = 1
    if exact:
        while longer > wanted * wanted * max(shorter, 1.0) and wanted <= most:
            wanted += 1
    else:
        while longer >= 2.0 * wanted * wanted * max(shorter, 1.0) and wanted <= most:
            wanted *= 2
    probes = min(wanted, most)
    return probes, longer / float(probes * probes) if wanted > most else max(shorter, min(longer, 1.0))


def sample_footprint(triangle, strq, px, py, texture, sampler, bias, profile):
    """A footprint's texel: the mean of its probes, cut. Source: docs/numbers.md section 7."""
    s, t, *_ = projected(strq, triangle.divided)
    along_s, along_t, probes, lod = block_probes(triangle, px, py, texture, sampler)
    lod = limited(lod + trunc(256.0 * bias), sampler)
    total = [0] * 4
    for k in range(probes):
        distance = (2 * k + 1 - probes) / (2 * probes)
        moved = (s + distance * along_s, t + distance * along_t, 0.0, 1.0)
        level = partial(sample_level, triangle, moved, texture, sampler, profile)
        texel = filter_levels(level, lod, texture, sampler, profile)
        total = [a + c for a, c in zip(total, texel, strict=True)]
    return [a // probes for a in total]


def sample_texture(triangle, px, py, weights, texture, sampler, bias, profile):
    """What a texture unit's register receives for one fragment, four numbers.

    Source: OpenGL 1.2.1 sections 3.8.5, 3.8.6; EXT_texture_filter_anisotropic.
    """
    strq = iterate_coordinates(triangle.coordinates, weights)
    if sampler.max_anisotropy > 1:
        return to_register(sample_along(triangle, strq, px, py, texture, sampler, bias, profile), sampler)
    if sampler.max_probes > 1:
        return to_register(sample_footprint(triangle, strq, px, py, texture, sampler, bias, profile), sampler)
    if texture.target != TextureTarget.TEXTURE_CUBE_MAP:
        strq = projected(strq, triangle.divided)
    level = partial(sample_level, triangle, strq, texture, sampler, profile)
    return to_register(sample_levels(level, triangle, px, py, texture, sampler, bias, profile), sampler)


def limited(lod, sampler):
    """Lambda between the sampler's limits. Source: SGIS_texture_lod; Assumed: the upper if crossed."""
    return min(max(lod, trunc(256.0 * sampler.min_lod)), trunc(256.0 * sampler.max_lod))


def sample_levels(level, triangle, px, py, texture, sampler, bias, profile):
    """The level that lambda asks for, or two of them blended; ``level(number, filter)`` filters one.

    Source: OpenGL 1.2.1 section 3.8.5.
    """
    unused = sampler.min_filter == sampler.mag_filter
    base = sampler.base_level
    lod = 0 if unused else limited(level_of_detail(triangle, px, py, texture, bias, base), sampler)
    return filter_levels(level, lod, texture, sampler, profile)


def filter_levels(level, lod, texture, sampler, profile):
    """As ``sample_levels``, with lambda ``lod`` given.

    Source: OpenGL 1.2.1 sections 3.8.5 (equations 3.21 to 3.23), 3.8.6; Measured: the choice at lambda <= 0,
    trilinear (LODBias).
    """
    minification, base = sampler.min_filter, sampler.base_level
    if minification == sampler.mag_filter:
        return level(base, minification)
    if lod <= magnification_threshold(sampler, profile):
        return level(base, sampler.mag_filter)
    if minification in (TextureFilter.NEAREST, TextureFilter.LINEAR):
        return level(base, minification)
    last = min(len(texture.levels) - 1, sampler.max_level)
    lod = fixed.clamp(256 * base + lod, 256 * base, 256 * last)
    if minification in (TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.LINEAR_MIPMAP_NEAREST):
        return level((lod + 127) >> 8, minification)
    lower, upper = level(lod >> 8, minification), level(min((lod >> 8) + 1, last), minification)
    return lerp_components(lower, upper, lod & 255)
