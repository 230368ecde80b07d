"""Texels in real numbers: lambda, wrap modes, filters, comparisons, and what a register receives."""

from dataclasses import replace

import numpy as np

from fixedpipe.pipeline.enums import TextureTarget, WrapMode
from fixedpipe.pipeline.framebuffers.transfer import looked_up
from fixedpipe.pipeline.ideal.coordinates import TextureCoordinates
from fixedpipe.pipeline.ideal.per_fragment import compare
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.images import BASE_FORMAT, KEPT, depth_texture_mode, register_components
from fixedpipe.raster import codes as C
from fixedpipe.raster.floats import TAU


def level_of_detail(coordinates, width, height, lod_bias, depth=1):
    """Lambda, float64 [k], of section 3.8.5 from the true derivatives at each fragment, plus the bias.

    The machine takes one lambda, of 8 fraction bits, per 2x2 block. Not finite: the largest.
    """
    size = np.array([width, height, depth], np.float64)[: coordinates.dx.shape[1]]
    across, down = coordinates.dx * size, coordinates.dy * size
    squared = np.maximum((across**2).sum(axis=1), (down**2).sum(axis=1))
    lod = np.full(len(squared), -np.inf)
    np.log2(squared, out=lod, where=squared > 0.0)
    return np.where(np.isnan(squared), np.inf, 0.5 * lod) + lod_bias


def _along(texel, size, wrap, linear):
    """Indices along an axis, a list of (index, which read the border or None), and the fraction from first to
    second.
    """
    texel = np.where(np.isfinite(texel), texel, 0.0)
    if wrap is WrapMode.REPEAT:
        texel = np.mod(texel, size)
    elif wrap is WrapMode.MIRRORED_REPEAT:
        texel = np.mod(texel, 2.0 * size)
        texel = np.minimum(texel, 2.0 * size - texel)
    elif wrap is WrapMode.CLAMP:
        texel = np.clip(texel, 0.0, size)
    elif wrap is WrapMode.CLAMP_TO_EDGE:
        texel = np.clip(texel, 0.5, size - 0.5)
    elif wrap is WrapMode.CLAMP_TO_BORDER:
        texel = np.clip(texel, -0.5, size + 0.5)
    else:
        raise ValueError(f"The ideal machine has no wrap mode {wrap.name}.")
    below = np.floor(texel - 0.5) if linear else np.floor(texel)
    first = below.astype(np.int64)
    bordered = wrap is WrapMode.CLAMP_TO_BORDER or (wrap is WrapMode.CLAMP and linear)
    indices = []
    for index in (first, first + 1) if linear else (first,):
        outside = (index < 0) | (index >= size) if bordered else None
        inside = np.mod(index, size) if wrap is WrapMode.REPEAT else np.clip(index, 0, size - 1)
        indices.append((inside, outside))
    return indices, texel - 0.5 - below


def sample_level(level, coordinates, sampler, border, linear, one_dimensional, read=None, tap=None):
    """One level, float64 [faces, h, w, 4], filtered at ``coordinates`` with real fractions: float64 [k, 4].

    ``border`` float64 [4]; ``read``: what becomes of texels [k, 4] before they are filtered. ``tap``: one
    texel of the filter, 0 or 1 of layers, rows and columns, float64 [k, 7] with the fractions between
    columns, rows and layers.
    Source: OpenGL 1.2.1 sections 3.8.4 to 3.8.6; docs/numbers.md, section 6.
    """
    layers, height, width = level.shape[:3]
    volume = coordinates.position.shape[1] == 3
    size = np.array([width, height, layers] if volume else [width, height], np.float64)
    texels = coordinates.position * size
    if not linear:
        slip = coordinates.slip * size + coordinates.bias
        texels = texels + np.where(slip >= 0.0, TAU, -TAU)
    columns, across = _along(texels[:, 0], width, sampler.wrap_s, linear)
    if one_dimensional:
        rows, up = [(np.zeros(len(texels), np.int64), None)], None
    else:
        rows, up = _along(texels[:, 1], height, sampler.wrap_t, linear)

    planes, deep = [(coordinates.face, None)], None
    if volume:
        planes, deep = _along(texels[:, 2], layers, sampler.wrap_r, linear)

    def texel(plane, row, column):
        found = level[plane[0], row[0], column[0]]
        found = found if read is None else read(found)
        for outside in (plane[1], row[1], column[1]):
            if outside is not None:
                found[outside] = border
        return found

    if tap is not None:
        axes = zip((planes, rows, columns), tap, strict=True)
        fractions = [np.zeros(len(texels)) if f is None else f for f in (across, up, deep)]
        wanted = [some[min(side, len(some) - 1)] for some, side in axes]
        return np.concatenate([texel(*wanted), np.stack(fractions, axis=1)], axis=1)

    def filtered_row(plane, row):
        taps = [texel(plane, row, column) for column in columns]
        return taps[0] if len(taps) == 1 else taps[0] + (taps[1] - taps[0]) * across[:, None]

    def filtered_plane(plane):
        lines = [filtered_row(plane, row) for row in rows]
        return lines[0] if len(lines) == 1 else lines[0] + (lines[1] - lines[0]) * up[:, None]

    parts = [filtered_plane(plane) for plane in planes]
    return parts[0] if len(parts) == 1 else parts[0] + (parts[1] - parts[0]) * deep[:, None]


def _select(coordinates, chosen):
    return TextureCoordinates(
        *(getattr(coordinates, name)[chosen] for name in ("position", "face", "slip", "bias", "dx", "dy"))
    )


def _comparison(sampler, reference):
    """What makes depth texels [k, 4] of a comparison with ``reference`` [k], before any filter: 1 or the
    value of what fails, in the components that DEPTH_TEXTURE_MODE names.

    Source: ARB_shadow (the reference's clamp), SGIX_shadow_ambient, ARB_depth_texture.
    """
    base, reference = depth_texture_mode(sampler, IDEAL), np.clip(reference, 0.0, 1.0)

    def compared(texels):
        holds = compare(sampler.compare_function, reference, texels[:, 0])
        value = np.where(holds, 1.0, float(sampler.compare_fail_value))
        return register_components(value[:, None], base, 1.0)

    return compared


def _footprint(texture, coordinates):
    """(squares, sizes): how long the steps to the right and upwards are, texels squared, float64 [2, k], from
    each fragment's own true derivatives; and texels in a unit of s and of t.
    """
    size = np.array([texture.width, texture.height], np.float64)
    if texture.target is TextureTarget.TEXTURE_RECTANGLE:
        size[:] = 1.0
    squares = ((np.stack([coordinates.dx, coordinates.dy]) * size) ** 2).sum(axis=2)
    return np.where(np.isfinite(squares), squares, 0.0), size


def _sum_along(texture, unit, coordinates, reference, edge, taps):
    """The sum of weighted texels along the longer step of each fragment's footprint.

    edge  float64 [k]: of the square that lambda is asked for, texels
    taps  (distance in steps, weight), float64 [k] each; where the weight is zero none is taken
    """
    squares, size = _footprint(texture, coordinates)
    step = np.where((squares[0] >= squares[1])[:, None], coordinates.dx, coordinates.dy)
    side = np.zeros_like(coordinates.dx)
    side[:, 0] = edge / size[0]
    total = np.zeros((len(edge), 4))
    one = replace(unit, sampler=replace(unit.sampler, max_probes=1, max_anisotropy=1.0))
    for distance, weight in taps:
        used = weight != 0.0
        moved = replace(
            coordinates,
            position=coordinates.position + distance[:, None] * step,
            dx=side,
            dy=np.zeros_like(side),
        )
        part = None if reference is None else reference[used]
        total[used] += sample(texture, one, _select(moved, used), part) * weight[used, None]
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
    """Pairs of texels along each fragment's footprint, as an anisotropic filter takes them, with weights that
    are not rounded (docs/numbers.md, section 7).
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


def _signed_reader(sampler, bits):
    """What makes texels [..., 4] of a sampler's signed components numbers of both signs; None: has none."""
    flags, one = np.array(signed_flags(sampler)), 2.0**bits - 1.0
    if not flags.any():
        return None
    return lambda texels: np.where(flags, signed(texels * one, bits) / one, texels)


def as_register(texel, unit):
    """What a unit's register receives of its texel [k, 4]: of signed components twice the byte.

    Measured: 732800 of 732800 pixels (Texture_signed_component_tests captures).
    """
    texel = looked_up(texel, unit.color_table, IDEAL)
    flags = signed_flags(unit.sampler)
    return texel * np.where(flags, 2.0, 1.0) if any(flags) else texel


def sample(texture, unit, coordinates, reference=None, tap=None):
    """A unit's texel, float64 [k, 4], from ``texture.ideal`` with a real lambda.

    ``reference`` float64 [k]: what depth texels are compared with; ``tap``: as ``sample_level``'s, of a
    sampler whose filters are equal.
    """
    sampler = unit.sampler
    if sampler.max_probes > 1:
        return _assembled(texture, unit, coordinates, reference)
    if sampler.max_anisotropy > 1:
        return _in_pairs(texture, unit, coordinates, reference)
    if texture.target is TextureTarget.TEXTURE_CUBE_MAP:
        sampler = replace(sampler, wrap_s=WrapMode.CLAMP_TO_EDGE, wrap_t=WrapMode.CLAMP_TO_EDGE)
    one_dimensional = texture.target is TextureTarget.TEXTURE_1D
    # The border colour passes through the base format like a texel.  Source: OpenGL 1.2.1, section 3.8.4.
    border, levels, read_signed = np.zeros(4), texture.ideal, _signed_reader(sampler, texture.bits)
    if reference is None:
        base = BASE_FORMAT[texture.internal_format]
        border = register_components(np.array(sampler.border_color, np.float64)[list(KEPT[base])], base, 1.0)
        border = border if read_signed is None else read_signed(border)

    def at_level(level, chosen, linear):
        where = _select(coordinates, chosen)
        read = read_signed if reference is None else _comparison(sampler, reference[chosen])
        return sample_level(levels[level], where, sampler, border, linear, one_dimensional, read, tap)

    levels = levels[: sampler.max_level + 1]

    out = np.zeros((len(coordinates.face), 4))
    if sampler.min_filter is sampler.mag_filter:
        minified = np.zeros(len(out), bool)
    else:
        if one_dimensional:
            s_alone = np.array([1.0, 0.0])
            coordinates = replace(coordinates, dx=coordinates.dx * s_alone, dy=coordinates.dy * s_alone)
        lod = level_of_detail(coordinates, texture.width, texture.height, unit.lod_bias, texture.depth)
        lod = np.clip(lod, sampler.min_lod, sampler.max_lod)
        minified = lod > 0.0
    if not minified.any():
        return at_level(0, slice(None), sampler.mag_filter.is_linear)
    magnified = ~minified
    out[magnified] = at_level(0, magnified, sampler.mag_filter.is_linear)
    linear, mipmap = sampler.min_filter.is_linear, sampler.min_filter.mipmap
    if mipmap == C.MIPMAP_NONE:
        out[minified] = at_level(0, minified, linear)
        return out
    between = mipmap == C.MIPMAP_LINEAR
    last = len(levels) - 1
    lod = np.clip(np.where(minified, lod, 0.0), 0.0, last)
    if between:
        lower = np.floor(lod)
        share = lod - lower
    else:
        # Source: OpenGL 1.2.1 section 3.8.5, equation 3.19.
        lower, share = np.ceil(lod + 0.5) - 1.0, np.zeros(len(lod))
    lower = np.minimum(lower.astype(np.int64), last)
    upper = np.minimum(lower + 1, last)
    for level in range(last + 1):
        weight = np.where(lower == level, 1.0 - share, 0.0) + np.where(upper == level, share, 0.0)
        chosen = minified & (weight > 0.0)
        if chosen.any():
            out[chosen] += weight[chosen, None] * at_level(level, chosen, linear)
    return out


# Numbers: what float64 may lose of a whole number n by n / 255 * 255.
_NOISE = 1e-9


def signed_flags(sampler):
    """Which components, RGBA, a sampler takes as two's complement."""
    flags = sampler.signed_components
    return flags.red, flags.green, flags.blue, flags.alpha


def signed(numbers, bits):
    """Numbers of ``bits`` bits, float64, as two's complement."""
    return np.where(numbers >= 2.0 ** (bits - 1) - _NOISE, numbers - 2.0**bits, numbers)
