"""Texture sampling at any width (docs/numbers.md, sections 6 and 7), on columns.

A level is [faces or layers, h, w, c] of whole numbers, bottom row first. Coordinates count texels.
"""

import numpy as np

from fixedpipe.raster import codes as C
from fixedpipe.raster import float_depths
from fixedpipe.raster.columns.interpolate import major_axis, on_face
from fixedpipe.raster.columns.numbers import INTEGERS
from fixedpipe.raster.columns.per_fragment import compare
from fixedpipe.raster.floats import TAU
from fixedpipe.raster.observer import unobserved


def wrapped(texel, mode, size, beside=0):
    """T brought into the texture's range; what is not a number becomes its lower end (section 6). ``beside``:
    how many border texels there are on either side.
    """
    n, reach = float(size), max(beside, 1) - 0.5
    low, high = {
        C.WRAP_REPEAT: (0.0, n),
        C.WRAP_MIRRORED_REPEAT: (0.0, 2.0 * n),
        C.WRAP_CLAMP: (0.0, n),
        C.WRAP_CLAMP_TO_EDGE: (0.5, n - 0.5),
        C.WRAP_CLAMP_TO_BORDER: (-reach, n + reach),
    }[mode]
    if mode in (C.WRAP_REPEAT, C.WRAP_MIRRORED_REPEAT):
        texel = texel - high * np.floor(texel * (1.0 / high))
    return np.where(texel > low, np.where(texel < high, texel, high), low)


def index_of(i, mode, size, linear, beside=0):
    """(texel indices inside 0..size-1, and beyond by ``beside`` border texels; where they read the border
    colour, or None).
    """
    if mode == C.WRAP_REPEAT:
        return i % size, None
    if mode == C.WRAP_MIRRORED_REPEAT:
        i = i % (2 * size)
        return np.minimum(i, 2 * size - 1 - i), None
    if mode == C.WRAP_CLAMP_TO_BORDER or (mode == C.WRAP_CLAMP and linear):
        if beside:
            return np.clip(i, -beside, size - 1 + beside), None
        return np.clip(i, 0, size - 1), (i < 0) | (i >= size)
    if mode in (C.WRAP_CLAMP, C.WRAP_CLAMP_TO_EDGE):
        return np.clip(i, 0, size - 1), None
    raise ValueError(f"{mode!r} is no wrap mode.")


def along(texel, mode, size, linear, fraction_bits, beside=0):
    """Indices along an axis, a list of one or two ``index_of``, and the fraction between them: of so many
    bits, int64; with ``fraction_bits`` None float64.
    """
    texel = wrapped(texel, mode, size, beside)
    if not linear:
        return [index_of(np.floor(texel).astype(np.int64), mode, size, False, beside)], None
    if fraction_bits is None:
        lower = np.floor(texel - 0.5)
        i, fraction = lower.astype(np.int64), (texel - 0.5) - lower
    else:
        position = np.floor((texel - 0.5) * float(1 << fraction_bits)).astype(np.int64)
        i, fraction = position >> fraction_bits, position & ((1 << fraction_bits) - 1)
    return [index_of(k, mode, size, True, beside) for k in (i, i + 1)], fraction


def positions(coordinates, target, computed, size, flat=False):
    """(T_s, T_t, T_r) of s, t, r float64 [k, 3 or 4] and the face or None.

    ``size`` (width, height, layers) of the level; ``computed``: the coordinates are lifted by TAU, where
    directions are that are not. ``flat``: s and t, t downwards, on a cube map's first face.
    """
    if target == C.TARGET_CUBE_MAP:
        face = major_axis(coordinates)
        if flat:
            s, t = coordinates[:, 0], coordinates[:, 1]
            coordinates, face = np.stack([np.ones_like(s), t, -s, s], axis=1), np.zeros_like(face)
        sc, tc, major = on_face(coordinates, face)
        half, none = 0.5 * float(size[0]), ~(major > 0.0)
        divisor, lift = np.where(none, 1.0, major), 0.0 if computed else TAU
        s, t = (np.where(none, 0.0, (c / divisor + 1.0) * half) + lift for c in (sc, tc))
        return (s, t, None), face
    bias = TAU if computed else 0.0
    str_ = [coordinates[:, i] for i in range(3)]
    if target == C.TARGET_RECTANGLE:
        size = (1.0, 1.0, 0.0)
    return tuple(c * float(n) + bias for c, n in zip(str_, size, strict=True)), None


def filter_level(
    level, places, face, modes, linear, target, border, fraction_bits, read, tap=None, observe=unobserved,
    beside=0, numbers=INTEGERS,
):  # fmt: skip
    """One filtered texel of each fragment, [k, c]: int64, or of REALS float64.

    ``places``: of ``positions``; ``modes``: of s, t and r; ``border`` int64 [c], the border colour as a
    texel; ``beside``: how many border texels the level has on either side; ``read``: None, or what is
    made of texels int64 [k, c] before they are filtered. ``tap``: None, or which of the filter's texels is
    wanted, 0 or 1 of layers, rows and columns: then int64 [k, c + 4], the texel, and the fractions
    between columns, rows and layers, and 0. ``observe`` receives where each axis reads, the fractions, and
    each texel, by (layer, row, column) of the filter. ``fraction_bits``: None, of REALS, for fractions that
    are not rounded.
    """
    layers, height, width = (extent - 2 * beside for extent in level.shape[:3])
    below, before = beside, 0  # border texels of the image below row 0 and before layer 0
    columns, across = along(places[0], modes[0], width, linear, fraction_bits, beside)
    if target == C.TARGET_1D:
        rows, up, below = [(np.zeros(len(places[0]), np.int64), None)], None, 0
    else:
        rows, up = along(places[1], modes[1], height, linear, fraction_bits, beside)
    if target == C.TARGET_3D:
        planes, deep = along(places[2], modes[2], layers, linear, fraction_bits, beside)
        before = beside
    else:
        planes, deep = [(0 if face is None else face, None)], None

    observe(
        "filter", columns=columns, rows=rows, layers=planes, fractions=(across, up, deep), bits=fraction_bits
    )

    def texel(plane, row, column):
        at = plane[0] + before, row[0] + below, column[0] + beside
        stored = level[at].astype(np.float64 if level.dtype == np.float64 else np.int64)
        for outside in (plane[1], row[1], column[1]):
            if outside is not None:
                stored[outside] = border
        found = stored if read is None else read(stored)
        observe("texel", layer=plane[0], row=row[0], column=column[0], stored=stored, texel=found)
        return found

    if tap is not None:
        wanted = [
            some[min(side, len(some) - 1)] for some, side in zip((planes, rows, columns), tap, strict=True)
        ]
        none = np.zeros(len(places[0]), np.int64)
        fractions = [none if some is None else some for some in (across, up, deep)]
        return np.concatenate([texel(*wanted), np.stack([*fractions, none], axis=1)], axis=1)

    def filtered_row(plane, row):
        taps = [texel(plane, row, column) for column in columns]
        return taps[0] if len(taps) == 1 else numbers.lerp(*taps, across[:, None], fraction_bits)

    def filtered_plane(plane):
        lines = [filtered_row(plane, row) for row in rows]
        found = lines[0] if len(lines) == 1 else numbers.lerp(*lines, up[:, None], fraction_bits)
        if plane[1] is not None:  # the border's filter is the border
            found[plane[1]] = border if read is None else read(border[None])[0]
        return found

    parts = [filtered_plane(plane) for plane in planes]
    return parts[0] if len(parts) == 1 else numbers.lerp(*parts, deep[:, None], fraction_bits)


def comparison(reference, function, held, failed):
    """What makes depth texels, bytes [k, 4] with the lowest first, ``held`` or ``failed``, int64 [4].

    ``reference`` int64 [k]: depth words. Measured: 48 captures (Texture_shadow_comparator). Real texels are
    compared themselves, with a reference in their units.
    """

    def compared(texels):
        if texels.dtype == np.float64:
            words = texels[:, 0]
        else:
            words = texels[:, 0] | texels[:, 1] << 8 | texels[:, 2] << 16 | texels[:, 3] << 24
        holds = compare(function, reference, words)
        return np.where(holds[:, None], held, failed)

    return compared


def depth_reference(value, form, largest):
    """Depth units float64 [k] as the words of a depth texture (section 12). ``form``: a FloatDepth; None: it
    is fixed.
    """
    positive = value > 0.0
    limited = np.where(positive, np.minimum(value, 2.0**200), 0.0)
    if form is None:
        return np.minimum(limited, float(largest)).astype(np.int64)
    return np.where(positive, np.clip(float_depths.words(limited, form), 0, largest), 0)


def taps(ratio, pair):
    """(distance, weight) of a pair of an anisotropic filter's texels, [k] each (section 7)."""
    distance = np.where(ratio <= 2.0, (ratio - 1.0) / (2.0 * ratio), (pair + 0.5) / ratio)
    inner = np.floor(256.0 / ratio + 2.0 / 3.0).astype(np.int64)
    last = np.ceil(ratio * 0.5).astype(np.int64) - 1
    weight = np.where(pair < last, inner, np.where(pair == last, 128 - inner * last, 0))
    return distance, np.where(last <= 0, 128 if pair == 0 else 0, weight)
