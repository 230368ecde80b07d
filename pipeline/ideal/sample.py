"""Sampling in real numbers: lambda, wrap modes, filters, comparisons, and a unit's register."""

from dataclasses import replace

import numpy as np
from numba import float64, int64, types, uint64, void

from fixedpipe.pipeline.enums import TextureTarget, WrapMode
from fixedpipe.pipeline.framebuffers.transfer import looked_up
from fixedpipe.pipeline.ideal.borders import with_border
from fixedpipe.pipeline.ideal.comparison import holds
from fixedpipe.pipeline.ideal.coordinates import TextureCoordinates
from fixedpipe.pipeline.ideal.signs import NOISE, signed_flags
from fixedpipe.pipeline.ideal.weights import fixed
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.images import (
    BASE_FORMAT,
    COLORLESS_FORMATS,
    REGISTER_COMPONENTS,
    border_components,
    depth_texture_mode,
)
from fixedpipe.pipeline.textures.sampled import face_modes
from fixedpipe.raster import codes as C
from fixedpipe.raster.floats import TAU
from fixedpipe.raster.kernel import kernel, separate_function, separate_loop

_LEVEL = types.Array(float64, 4, "C", readonly=True)

# A *reader* says what a texel becomes before it is filtered. Its first number is the kind. For signed
# components there follow the value of one, the least number that is negative, the number to subtract from it,
# and a flag for each component. For a comparison there follow the function, the value of a failed one, and
# the source of each register component.
_AS_IT_IS, _SIGNED, _COMPARED = range(3)
_KIND, _ONE, _LEAST, _RANGE, _FLAGS, _FUNCTION, _FAILS, _READER = 0, 1, 2, 3, 4, 1, 2, 8
_ZEROS, _ONES, _RESULT = range(3)

# In ``lower``: the mark of a magnified fragment, which reads level 0 with the magnification filter.
_MAGNIFIED = -1
_NO_ROWS = -1  # the wrap mode along t for an image without rows


@kernel
def _along(texel, extent, wrap, linear):
    """(first index, second index, fraction) along an axis; index -1 means the border."""
    size = float64(extent)
    if not np.isfinite(texel):
        texel = 0.0
    if wrap == C.WRAP_REPEAT:
        if not (texel >= 0.0 and texel < size):
            texel = texel % size
    elif wrap == C.WRAP_MIRRORED_REPEAT:
        if not (texel >= 0.0 and texel < 2.0 * size):
            texel = texel % (2.0 * size)
        texel = min(texel, 2.0 * size - texel)
    else:  # CLAMP, CLAMP_TO_EDGE and CLAMP_TO_BORDER
        beside = 0.0
        if wrap == C.WRAP_CLAMP_TO_EDGE:
            beside = 0.5
        elif wrap == C.WRAP_CLAMP_TO_BORDER:
            beside = -0.5
        texel = min(max(texel, beside), size - beside)
    below = np.floor(texel - 0.5) if linear else np.floor(texel)
    first = int64(below)
    second = first + 1
    if wrap == C.WRAP_REPEAT:
        first = first + extent if first < 0 else (first - extent if first >= extent else first)
        second = second - extent if second >= extent else second
    elif wrap == C.WRAP_CLAMP_TO_BORDER or (wrap == C.WRAP_CLAMP and linear):
        first = -1 if first >= extent else first
        second = -1 if second >= extent else second
    else:
        first, second = max(first, 0), min(second, extent - 1)
        first = min(first, extent - 1)
    return first, second, texel - 0.5 - below


@kernel
def _signed(component, reader, place):
    """A component, read as two's complement if its flag is set."""
    if reader[place] == 0.0:
        return component
    number = component * reader[_ONE]
    return (number - reader[_RANGE] if number >= reader[_LEAST] else number) / reader[_ONE]


@kernel
def _component(result, what):
    return result if what == _RESULT else (1.0 if what == _ONES else 0.0)


@kernel
def _texel(level, at, border, reader, reference):
    """A level's texel after its reader. ``at``: layer, row and column; -1 means the border."""
    layer, row, column = at
    if layer < 0 or row < 0 or column < 0:
        red, green, blue, alpha = border[0], border[1], border[2], border[3]
    else:
        p, r, c = uint64(layer), uint64(row), uint64(column)
        red, green, blue, alpha = level[p, r, c, 0], level[p, r, c, 1], level[p, r, c, 2], level[p, r, c, 3]
    if reader[_KIND] == _AS_IT_IS:
        return red, green, blue, alpha
    f = _FLAGS
    if reader[_KIND] == _SIGNED:
        return (
            _signed(red, reader, f),
            _signed(green, reader, f + 1),
            _signed(blue, reader, f + 2),
            _signed(alpha, reader, f + 3),
        )
    result = 1.0 if holds(int64(reader[_FUNCTION]), reference, red) else reader[_FAILS]
    return (
        _component(result, reader[f]),
        _component(result, reader[f + 1]),
        _component(result, reader[f + 2]),
        _component(result, reader[f + 3]),
    )


@kernel
def _between(a, b, share):
    """Interpolate from one color to another."""
    return (
        a[0] + (b[0] - a[0]) * share,
        a[1] + (b[1] - a[1]) * share,
        a[2] + (b[2] - a[2]) * share,
        a[3] + (b[3] - a[3]) * share,
    )


@kernel
def _weight(chosen, number, last, i):
    """The weight of level ``number`` for fragment i; 0: the fragment does not read it.

    ``chosen``: ``lower`` and ``share``; both are empty if the level is for all fragments.
    """
    lower, share = chosen
    if len(lower) == 0:
        return 1.0
    weight = 0.0
    if lower[i] == number:
        weight = 1.0 - share[i]
    if lower[i] >= 0 and min(lower[i] + 1, last) == number:
        weight += share[i]
    return weight


_SAMPLED = types.Tuple((_LEVEL, float64[:, ::1], int64[::1], float64[::1]))
_CHOSEN = types.Tuple((int64[::1], float64[::1]))
_HOW = types.Tuple((int64[::1], float64[::1], float64[::1]))  # wrap modes, border and reader


@kernel
def _rows(level, position, i, wrap):
    """``_along`` for the rows. An image without rows has one."""
    if wrap == _NO_ROWS:
        return 0, 0, 0.0
    return _along(position[i, 1] * level.shape[1], level.shape[1], wrap, True)


@kernel
def _filtered_plane(level, layer, columns, rows, border, reader, reference):
    """Four texels of a plane, filtered. Each texel may pass a reader or come from the border."""
    separate_function()
    left, right, across = columns
    lower, upper, up = rows
    below = _between(
        _texel(level, (layer, lower, left), border, reader, reference),
        _texel(level, (layer, lower, right), border, reader, reference),
        across,
    )
    if lower == upper and up == 0.0:
        return below
    above = _between(
        _texel(level, (layer, upper, left), border, reader, reference),
        _texel(level, (layer, upper, right), border, reader, reference),
        across,
    )
    return _between(below, above, up)


@kernel
def _plain_plane(level, layer, columns, rows, c):
    """A component of four texels of a plane, filtered. No texel passes a reader or comes from the border."""
    p, left, right = uint64(layer), uint64(columns[0]), uint64(columns[1])
    lower, upper = uint64(rows[0]), uint64(rows[1])
    below = level[p, lower, left, c] + (level[p, lower, right, c] - level[p, lower, left, c]) * columns[2]
    above = level[p, upper, left, c] + (level[p, upper, right, c] - level[p, upper, left, c]) * columns[2]
    return below + (above - below) * rows[2]


@kernel(void(_SAMPLED, _CHOSEN, int64, int64, _HOW, float64[:, ::1]))
def _linear(sampled, chosen, number, last, how, out):
    """Add level ``number``, filtered from four texels, to the fragments that read it.

    No texel passes a reader or comes from the border.
    """
    separate_loop()
    level, position, face, _ = sampled
    wraps, _, _ = how
    for i in range(len(position)):
        weight = _weight(chosen, number, last, i)
        if weight > 0.0:
            columns = _along(position[i, 0] * level.shape[2], level.shape[2], wraps[0], True)
            rows = _rows(level, position, i, wraps[1])
            for c in range(4):
                out[i, c] += weight * _plain_plane(level, face[i], columns, rows, c)


@kernel(void(_SAMPLED, _CHOSEN, int64, int64, _HOW, float64[:, ::1]))
def _linear_in_volume(sampled, chosen, number, last, how, out):
    """As ``_linear``, for a volume: from eight texels."""
    separate_loop()
    level, position, _, _ = sampled
    wraps, _, _ = how
    for i in range(len(position)):
        weight = _weight(chosen, number, last, i)
        if weight > 0.0:
            columns = _along(position[i, 0] * level.shape[2], level.shape[2], wraps[0], True)
            rows = _rows(level, position, i, wraps[1])
            near, far, deep = _along(position[i, 2] * level.shape[0], level.shape[0], wraps[2], True)
            for c in range(4):
                first = _plain_plane(level, near, columns, rows, c)
                second = _plain_plane(level, far, columns, rows, c)
                out[i, c] += weight * (first + (second - first) * deep)


@kernel(void(_SAMPLED, _CHOSEN, int64, int64, _HOW, float64[:, ::1]))
def _linear_read(sampled, chosen, number, last, how, out):
    """As ``_linear`` and ``_linear_in_volume``, for texels that pass a reader or may come from the border."""
    separate_loop()
    level, position, face, reference = sampled
    wraps, border, reader = how
    for i in range(len(position)):
        weight = _weight(chosen, number, last, i)
        if weight > 0.0:
            columns = _along(position[i, 0] * level.shape[2], level.shape[2], wraps[0], True)
            rows = _rows(level, position, i, wraps[1])
            near, far, deep = face[i], face[i], 0.0
            if position.shape[1] == 3:
                near, far, deep = _along(position[i, 2] * level.shape[0], level.shape[0], wraps[2], True)
            compared = reference[i] if len(reference) else 0.0
            color = _filtered_plane(level, near, columns, rows, border, reader, compared)
            if near != far:
                other = _filtered_plane(level, far, columns, rows, border, reader, compared)
                color = _between(color, other, deep)
            for c in range(4):
                out[i, c] += weight * color[c]


@kernel
def _nearest_along(position, slip, bias, extent, wrap):
    """The index of the texel that the machines take, also at an exact boundary; -1: the border."""
    lifted = slip * extent + bias
    texel = position * extent + (TAU if lifted >= 0.0 else -TAU)
    return _along(texel, extent, wrap, False)[0]


@kernel(void(_SAMPLED, _CHOSEN, int64, int64, _HOW, float64[:, ::1], float64[:, ::1], float64[:, ::1]))
def _nearest(sampled, chosen, number, last, how, slip, bias, out):
    """Add the nearest texels of level ``number`` to the fragments that read it."""
    separate_loop()
    level, position, face, reference = sampled
    wraps, border, reader = how
    plain = reader[_KIND] == _AS_IT_IS
    for i in range(len(position)):
        weight = _weight(chosen, number, last, i)
        if weight > 0.0:
            column = _nearest_along(position[i, 0], slip[i, 0], bias[i, 0], level.shape[2], wraps[0])
            row, layer = 0, face[i]
            if wraps[1] != _NO_ROWS:
                row = _nearest_along(position[i, 1], slip[i, 1], bias[i, 0], level.shape[1], wraps[1])
            if position.shape[1] == 3:
                layer = _nearest_along(position[i, 2], slip[i, 2], bias[i, 0], level.shape[0], wraps[2])
            if plain and min(min(layer, row), column) >= 0:
                for c in range(4):
                    out[i, c] += weight * level[uint64(layer), uint64(row), uint64(column), c]
            else:
                compared = reference[i] if len(reference) else 0.0
                color = _texel(level, (layer, row, column), border, reader, compared)
                for c in range(4):
                    out[i, c] += weight * color[c]


@kernel(void(_SAMPLED, _HOW, types.UniTuple(int64, 3), float64[:, ::1]))
def _tap(sampled, how, tap, out):
    """One texel of a linear filter, and the fractions between columns, rows and layers: [k, 7]."""
    separate_loop()
    level, position, face, reference = sampled
    wraps, border, reader = how
    for i in range(len(position)):
        left, right, across = _along(position[i, 0] * level.shape[2], level.shape[2], wraps[0], True)
        lower, upper, up = _rows(level, position, i, wraps[1])
        near, far, deep = face[i], face[i], 0.0
        if position.shape[1] == 3:
            near, far, deep = _along(position[i, 2] * level.shape[0], level.shape[0], wraps[2], True)
        at = far if tap[0] else near, upper if tap[1] else lower, right if tap[2] else left
        compared = reference[i] if len(reference) else 0.0
        red, green, blue, alpha = _texel(level, at, border, reader, compared)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = red, green, blue, alpha
        out[i, 4], out[i, 5], out[i, 6] = across, up, deep


@kernel(void(float64[:, ::1], float64[:, ::1], types.UniTuple(float64, 3), float64[::1]))
def _squares(dx, dy, size, out):
    """The square of the longer step, to the right or down, in texels squared."""
    separate_loop()
    for i in range(len(out)):
        a, b, c, d = dx[i, 0] * size[0], dx[i, 1] * size[1], dy[i, 0] * size[0], dy[i, 1] * size[1]
        right, down = a * a + b * b, c * c + d * d
        if dx.shape[1] == 3:
            a, b = dx[i, 2] * size[2], dy[i, 2] * size[2]
            right, down = right + a * a, down + b * b
        out[i] = right if right >= down or np.isnan(right) else down


@kernel(int64(float64[::1], float64[::1], types.UniTuple(float64, 3), int64, int64, int64[::1], float64[::1]))
def _choose(squared, logarithm, limits, last, mipmap, lower, share):
    """Choose each fragment's levels: the lower one, and the share of the next.

    Returns a bit for each level that some fragment needs; the lowest bit is for magnified fragments.

    limits  (lambda's bias, its least value, its greatest value)
    """
    separate_loop()
    bias, least, most = limits
    used = 0
    for i in range(len(squared)):
        lod = np.inf if np.isnan(squared[i]) else 0.5 * logarithm[i]
        lod = min(max(lod + bias, least), most)
        lower[i], share[i] = _MAGNIFIED, 0.0
        if lod > 0.0:
            lod = min(lod, float64(last))
            level = 0.0
            if mipmap == C.MIPMAP_LINEAR:
                level = np.floor(lod)
                share[i] = lod - level
            elif mipmap != C.MIPMAP_NONE:
                # Source: OpenGL 1.2.1 section 3.8.5, equation 3.19.
                level = np.ceil(lod + 0.5) - 1.0
            lower[i] = min(int64(level), last)
            if share[i] > 0.0:
                used |= 1 << (min(lower[i] + 1, last) + 1)
        used |= 1 << (lower[i] + 1)
    return used


def sample_level(level, coordinates, sampler, border, linear, read=None, reference=None, tap=None):
    """Filter one level, float64 [faces, h, w, 4], at ``coordinates`` with real fractions: float64 [k, 4].

    border     float64 [4], the border color
    read       a reader: what texels become before they are filtered
    reference  float64 [k], the reference of a depth comparison
    tap        take one texel of the filter: 0 or 1 for layers, rows and columns. The result is float64 [k,
               7], with the fractions between columns, rows and layers

    Source: OpenGL 1.2.1 sections 3.8.4 to 3.8.6; docs/numbers.md, section 6.
    """
    sampling = _Sampling(coordinates, sampler, border, read, reference)
    if tap is not None:
        return sampling.tap(level, tap)
    out = np.zeros((len(coordinates.face), 4))
    sampling.add(level, linear, out)
    return out


_EVERY = np.empty(0, np.int64), np.empty(0)  # ``chosen`` of a level that all fragments read


class _Sampling:
    """The state that is the same for all levels of a texture. ``beside``: border texels along s, t and r."""

    def __init__(
        self, coordinates, sampler, border, read=None, reference=None, one_dimensional=False, beside=(0, 0, 0)
    ):
        self.coordinates, self.beside, self.sampler = coordinates, beside, sampler
        self.reference = np.empty(0) if reference is None else np.clip(reference, 0.0, 1.0)
        wraps = sampler.wrap_s, _NO_ROWS if one_dimensional else sampler.wrap_t, sampler.wrap_r
        reader = np.zeros(_READER) if read is None else read
        self.plain = read is None and not {WrapMode.CLAMP, WrapMode.CLAMP_TO_BORDER}.intersection(wraps)
        self.how = np.array(wraps, np.int64), np.array(border, np.float64), reader

        if any(beside):  # the levels from ``with_border`` need no border
            edges = np.where(self.how[0] == _NO_ROWS, _NO_ROWS, WrapMode.CLAMP_TO_EDGE)
            self.plain, self.how = read is None, (edges, *self.how[1:])

    def _sampled(self, level, linear):
        where = self.coordinates
        position, face = np.ascontiguousarray(where.position), where.face
        if any(self.beside):
            level, position = with_border(level, where, self.sampler, self.beside, linear)
        return fixed(level), position, face, self.reference

    def tap(self, level, tap):
        """One texel of a linear filter, and fractions: float64 [k, 7]."""
        out = np.empty((len(self.coordinates.face), 7))
        _tap(self._sampled(level, True), self.how, tap, out)
        return out

    def add(self, level, linear, out, chosen=_EVERY, number=0, last=0):
        """Add a level's filtered texels to ``out``, for the chosen fragments."""
        sampled, where = self._sampled(level, linear), self.coordinates
        if not linear:
            slip, bias = np.ascontiguousarray(where.slip), np.ascontiguousarray(where.bias)
            _nearest(sampled, chosen, number, last, self.how, slip, bias, out)
        elif not self.plain:
            _linear_read(sampled, chosen, number, last, self.how, out)
        elif where.position.shape[1] == 3:
            _linear_in_volume(sampled, chosen, number, last, self.how, out)
        else:
            _linear(sampled, chosen, number, last, self.how, out)


def _select(coordinates, chosen):
    return TextureCoordinates(
        *(getattr(coordinates, name)[chosen] for name in ("position", "face", "slip", "bias", "dx", "dy"))
    )


def _comparison(sampler):
    """The reader of a depth comparison: 1, or the sampler's value of a failed comparison.

    DEPTH_TEXTURE_MODE selects the components that receive it. Source: ARB_shadow (the reference's clamp),
    SGIX_shadow_ambient, ARB_depth_texture.
    """
    base, reader = depth_texture_mode(sampler, IDEAL), np.zeros(_READER)
    reader[_KIND], reader[_FUNCTION] = _COMPARED, sampler.compare_function
    reader[_FAILS] = float(sampler.compare_fail_value)
    for k, what in enumerate(REGISTER_COMPONENTS[base]):
        reader[_FLAGS + k] = _RESULT if isinstance(what, int) else (_ONES if what == "1" else _ZEROS)
    return reader


def _signed_reader(sampler, bits):
    """The reader of a sampler's signed components; None: the sampler has none."""
    flags = signed_flags(sampler)
    if not any(flags):
        return None
    reader = np.zeros(_READER)
    reader[_KIND], reader[_ONE] = _SIGNED, 2.0**bits - 1.0
    reader[_LEAST], reader[_RANGE] = 2.0 ** (bits - 1) - NOISE, 2.0**bits
    reader[_FLAGS:] = flags
    return reader


def _footprint(texture, coordinates):
    """(squares, sizes) of each fragment's footprint, from its own true derivatives.

    ``squares``: the squared lengths of the steps to the right and upwards, texels squared, float64 [2, k].
    ``sizes``: texels in a unit of s and of t.
    """
    size = np.array([texture.width, texture.height], np.float64)
    if texture.target is TextureTarget.TEXTURE_RECTANGLE:
        size[:] = 1.0
    squares = ((np.stack([coordinates.dx, coordinates.dy]) * size) ** 2).sum(axis=2)
    return np.where(np.isfinite(squares), squares, 0.0), size


def _sum_along(texture, unit, coordinates, reference, edge, taps):
    """The sum of weighted texels along the longer step of each fragment's footprint.

    edge  float64 [k], texels: the edge of the square that decides lambda
    taps  (distance in steps, weight), float64 [k] each; a tap of weight 0 is not taken
    """
    squares, size = _footprint(texture, coordinates)
    step = np.where((squares[0] >= squares[1])[:, None], coordinates.dx, coordinates.dy)
    side = np.zeros_like(coordinates.dx)
    side[:, 0] = edge / size[0]
    total = np.zeros((len(edge), 4))
    one = replace(unit, sampler=replace(unit.sampler, max_probes=1, max_anisotropy=1.0))
    coordinates = replace(coordinates, dx=side, dy=np.zeros_like(side))
    for distance, weight in taps:
        used = weight != 0.0
        used = slice(None) if used.all() else np.flatnonzero(used)
        moved = _select(coordinates, used)
        moved = replace(moved, position=moved.position + distance[used, None] * step[used])
        part = None if reference is None else reference[used]
        total[used] += sample(texture, one, moved, part) * weight[used, None]
    return total


def _assembled(texture, unit, coordinates, reference):
    """The mean of the probes along each fragment's footprint (docs/numbers.md, section 7)."""
    squares, _ = _footprint(texture, coordinates)
    longer, shorter = squares.max(axis=0), squares.min(axis=0)
    most, narrow = unit.sampler.max_probes, np.maximum(shorter, 1.0)
    if unit.sampler.exact_probes:
        probes = np.minimum(np.maximum(np.ceil(np.sqrt(longer / narrow)), 1.0), most)
        cut = longer > probes**2 * narrow
    else:
        probes = np.ones(len(longer))
        for _ in range(most.bit_length() - 1):
            probes = np.where(longer >= 2.0 * probes**2 * narrow, 2.0 * probes, probes)
        cut = longer >= 2.0 * probes**2 * narrow
    rho2 = np.where(cut, longer / probes**2, np.maximum(shorter, np.minimum(longer, 1.0)))
    taps = (
        (((2 * probe + 1) - probes) / (2.0 * probes), np.where(probe < probes, 1.0 / probes, 0.0))
        for probe in range(int(probes.max(initial=1.0)))
    )
    return _sum_along(texture, unit, coordinates, reference, np.sqrt(rho2), taps)


def _in_pairs(texture, unit, coordinates, reference):
    """Pairs of texels along each fragment's footprint, for an anisotropic filter (docs/numbers.md, section
    7).

    The weights are not rounded.
    """
    squares, _ = _footprint(texture, coordinates)
    longer, shorter = np.sqrt(squares.max(axis=0)), np.sqrt(squares.min(axis=0))
    ratio = np.clip(longer / np.maximum(shorter, 1.0), 1.0, unit.sampler.max_anisotropy)
    pairs = np.maximum(np.ceil(0.5 * ratio), 1.0)

    def taps():
        for pair in range(int(pairs.max(initial=1.0))):
            distance = np.where(ratio <= 2.0, (ratio - 1.0) / (2.0 * ratio), (pair + 0.5) / ratio)
            weight = np.where(pair == pairs - 1.0, 0.5 - pair / ratio, 1.0 / ratio)
            weight = np.where(pair < pairs, weight, 0.0)
            yield distance, weight
            yield -distance, weight

    return _sum_along(texture, unit, coordinates, reference, longer / ratio, taps())


def as_register(texel, unit, internal_format):
    """A unit's register from its texel [k, 4]: signed components are doubled, and a format that is no colour
    gives 0.

    Measured: 732800 of 732800 pixels (Texture_signed_component_tests captures).
    """
    if internal_format in COLORLESS_FORMATS and not IDEAL.textures.hilo_as_color:
        return np.zeros_like(texel)
    texel = looked_up(texel, unit.color_table, IDEAL)
    flags = signed_flags(unit.sampler)
    return texel * np.where(flags, 2.0, 1.0) if any(flags) else texel


def sample(texture, unit, coordinates, reference=None, tap=None):
    """A unit's texel, float64 [k, 4], from ``texture.ideal`` with a real lambda.

    reference  float64 [k], the reference of a depth comparison
    tap        as in ``sample_level``, for a sampler with equal filters
    """
    sampler = unit.sampler
    if sampler.max_probes > 1:
        return _assembled(texture, unit, coordinates, reference)
    if sampler.max_anisotropy > 1:
        return _in_pairs(texture, unit, coordinates, reference)
    if texture.target is TextureTarget.TEXTURE_CUBE_MAP:
        along_s, along_t, _ = face_modes(sampler, texture)
        sampler = replace(sampler, wrap_s=along_s, wrap_t=along_t)
    one_dimensional = texture.target is TextureTarget.TEXTURE_1D
    border, levels = np.array(sampler.border_color), texture.ideal
    read = _signed_reader(sampler, texture.bits)
    if reference is None:
        base, as_given = BASE_FORMAT[texture.internal_format], IDEAL.textures.border_color_as_given
        border = border_components(border, base, 1.0, as_given=as_given)
    else:
        border, read = np.clip(border, 0.0, 1.0), _comparison(sampler)
    given = coordinates, sampler, border, read, reference, one_dimensional
    sampling = _Sampling(*given, texture.borders)
    if tap is not None:
        return sampling.tap(levels[0], tap)

    out = np.zeros((len(coordinates.face), 4))
    if sampler.min_filter is sampler.mag_filter:
        sampling.add(levels[0], sampler.mag_filter.is_linear, out)
        return out
    levels = levels[: sampler.max_level - sampler.base_level + 1]
    last, mipmap = len(levels) - 1, sampler.min_filter.mipmap
    size = float(texture.width), 0.0 if one_dimensional else float(texture.height), float(texture.depth)
    squared, logarithm, share = np.empty((3, len(out)))
    _squares(*map(np.ascontiguousarray, (coordinates.dx, coordinates.dy)), size, squared)
    logarithm[:] = -np.inf
    np.log2(squared, out=logarithm, where=squared > 0.0)
    limits = float(unit.lod_bias), float(sampler.min_lod), float(sampler.max_lod)
    lower = np.empty(len(out), np.int64)
    needed = _choose(squared, logarithm, limits, last, mipmap, lower, share)
    if needed & 1:
        sampling.add(levels[0], sampler.mag_filter.is_linear, out, (lower, share), _MAGNIFIED, last)
    for number in range(last + 1):
        if needed >> number + 1 & 1:
            sampling.add(levels[number], sampler.min_filter.is_linear, out, (lower, share), number, last)
    return out
