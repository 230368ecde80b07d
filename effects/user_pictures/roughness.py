"""A user's heights as two pyramids, of bumps and of roughness: arrays to keep, and a picture of the levels.

Source: Schilling 1997, section 8 (S16 to S19 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.user_pictures import maps

# Texels along an edge. Assumed: what is mapped today; without a size, bump mapping's own limit.
_LARGEST, _USUAL = 4096, 512
# Between two levels of a picture, and around them: pixels.
_GAP = 4


def size_for(field):
    """The least power of two that has every height of a HeightField, at most 512."""
    return min(1 << (max(field.heights.shape) - 1).bit_length(), _USUAL)


def pyramids(value, size=None, scale=0.05, *, repeated=True):
    """The pyramids of a height field: a tuple of Level, level 0 first, bottom row first.

    value     what ``maps.height_field`` takes
    size      texels along both edges, a power of two from 2 to 4096; None: ``size_for``
    scale     from the lowest to the highest point, in edges of the field
    repeated  whether the map repeats: its edges are then faded into each other

    Raises ValueError for other sizes, and for a scale that is no positive number.
    """
    field = maps.height_field(value)
    size = size_for(field) if size is None else size
    if isinstance(size, bool) or not isinstance(size, int | np.integer) or not 2 <= size <= _LARGEST:
        raise ValueError(f"The pyramid's size is {size}; give a power of two from 2 to {_LARGEST}.")
    if size & (size - 1):
        raise ValueError(f"The pyramid's size is {size}; give a power of two from 2 to {_LARGEST}.")
    if not (np.isfinite(scale) and scale > 0.0):
        raise ValueError(f"The height scale is {scale}; give a number above zero, in edges of the field.")
    return rough.from_heights(field.fitted(size, size, scale, repeated=repeated), periodic=repeated)


def largest(levels):
    """The largest number of D, which bytes store as one; 1 if all are zero."""
    return max(float(np.abs(level.deviations).max()) for level in levels) or 1.0


def arrays(levels):
    """The contents of an NPZ file: for level l ``offsets_l`` [rows, columns, 2], ``covariance_l`` (a, b, c),
    ``deviations_l`` (d_1, d_2, d_3), ``isotropic_l`` (I_1), float64, and ``bytes_l``, uint8, of D over
    ``scale``. Rows are bottom row first, as textures have them.
    """
    scale = largest(levels)
    out = {"scale": np.float64(scale)}
    for number, level in enumerate(levels):
        d = level.deviations
        out[f"offsets_{number}"] = level.offsets
        out[f"covariance_{number}"] = level.covariance
        out[f"deviations_{number}"] = d
        out[f"isotropic_{number}"] = rough.largest_deviation(level.covariance)
        out[f"bytes_{number}"] = rough.deviation_bytes(d, scale)
    return out


def _placed(picture, image, left, top):
    rows, columns = image.shape[:2]
    picture[top : top + rows, left : left + columns] = image[::-1]


def picture(levels):
    """Both pyramids, level beside level: uint8 [rows, columns, 3], top row first; bumps above, D below.

    Bumps are normals in red, green and blue, 128 zero; D is d_1 red, d_2 green, 128 zero, d_3 blue, where
    twice the whole map's larger deviation is full. Larger ones are clamped, since few texels of a photograph
    have far more. A level has one pixel for each texel; if level 0 has fewer than 64, all levels are
    enlarged.
    """
    scale = 2.0 * float(rough.largest_deviation(levels[-1].covariance).max()) or 1.0
    times = max(1, 64 // levels[0].offsets.shape[0])
    edges = [times * level.offsets.shape[0] for level in levels]
    width = sum(edges) + _GAP * (len(edges) + 1)
    out = np.full((2 * edges[0] + 3 * _GAP, width, 3), 255, np.uint8)
    left = _GAP
    for level, edge in zip(levels, edges, strict=True):
        # Offsets are slopes with their signs turned, frames take slopes.
        normals, _, _ = height_fields.frames(-level.offsets[..., 0], -level.offsets[..., 1])
        bumps = np.clip(np.floor(128.0 + 127.0 * normals + 0.5), 0, 255).astype(np.uint8)
        codes = rough.deviation_bytes(level.deviations, scale)
        for row, image in enumerate((bumps, codes)):
            large = np.repeat(np.repeat(image, times, axis=0), times, axis=1)
            _placed(out, large, left, _GAP + row * (edges[0] + _GAP) + edges[0] - edge)
        left += edge + _GAP
    return out


def levels_in_words(levels):
    """A line for each level: texels, deviations of the remaining and of the lost bumps along u and v, largest
    I_1.
    """
    lines = ["level  texels  bumps left  lost along u  along v  largest I_1"]
    for number, level in enumerate(levels):
        f = level.offsets - level.offsets.mean(axis=(0, 1))
        left = float(np.sqrt((f * f).sum(axis=-1).mean()))
        u, v = (float(np.sqrt(level.covariance[..., k].mean())) for k in (0, 2))
        isotropic = float(rough.largest_deviation(level.covariance).max())
        lines.append(
            f"{number:5d}  {level.offsets.shape[0]:6d}  {left:10.4f}  {u:12.4f}  {v:7.4f}  {isotropic:11.4f}"
        )
    return "\n".join(lines)
