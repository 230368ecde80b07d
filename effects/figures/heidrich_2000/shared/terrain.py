"""The terrain of figure F002-13: heights, colours by height and slope, a mesh, a camera, and its ellipses."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective, rotation
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import ellipses, visibility
from fixedpipe.effects.scattering.height_field import HeightField, height_field

# From the lowest to the highest: where each begins, as a share of all heights, and its colour.
_WATER = np.array((0.24, 0.45, 0.55))
_MEADOW, _WOOD = np.array((0.60, 0.68, 0.32)), np.array((0.29, 0.44, 0.24))
_ROCK, _SCREE = np.array((0.64, 0.56, 0.49)), np.array((0.80, 0.72, 0.61))
_SNOW = np.array((0.97, 0.98, 1.0))


def _mountains(texels, seed):
    """Heights from 0 to 1: a lake in a valley before a range, ridges of several sizes; periodic."""
    s, t = height_fields.texel_centers(texels, texels)
    # The crests are where noise changes its sign; finer ones stand on coarse ones alone.
    heights, weight, share = 0.0, 1.0, 0.55
    for octave in range(6):
        noise = height_fields.gradient_noise(s, t, 2 << octave, seed + octave)
        ridge = np.maximum(1.0 - 1.6 * np.abs(noise), 0.0)
        ridge = ridge * ridge * weight
        heights = heights + share * ridge
        weight, share = np.clip(1.7 * ridge, 0.0, 1.0), 0.5 * share
    # A range lies across the far part, and a valley that winds before it.
    winding = 0.10 * np.asarray(sine(2.0 * np.pi * s))
    heights = heights * (0.66 + 0.34 * cosine(2.0 * np.pi * (t - 0.74)))
    heights = heights + 0.15 * cosine(2.0 * np.pi * (t - 0.78 + winding))
    return (heights - heights.min()) / (heights.max() - heights.min())


def _step(values, first, last):
    """0 below ``first``, 1 above ``last``, a cubic between."""
    share = np.clip((values - first) / (last - first), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def _colors(heights, level, normals):
    """Colours of heights from 0 to 1, RGB [rows, columns, 3]: water, meadow, wood, rock and scree, snow."""
    rows, columns = heights.shape
    s, t = height_fields.texel_centers(columns, rows)
    coarse = height_fields.turbulence(s, t, 8, 4, 40)
    fine = height_fields.turbulence(s, t, 32, 3, 60)
    place, level_ground = heights + 0.10 * coarse, normals[..., 2]
    out = _MEADOW + (_WOOD - _MEADOW) * _step(coarse + 0.4 * fine, -0.15, 0.2)[..., None]
    rock = _ROCK + (_SCREE - _ROCK) * _step(fine, -0.3, 0.4)[..., None]
    bare = np.maximum(1.0 - _step(level_ground, 0.62, 0.80), _step(place, 0.42, 0.60))
    out = out + (rock - out) * bare[..., None]
    snow = _step(place, 0.56, 0.68) * _step(level_ground + 0.1 * fine, 0.50, 0.66)
    out = (out + (_SNOW - out) * snow[..., None]) * (1.0 + 0.14 * fine[..., None])
    return np.clip(np.where((heights <= level)[..., None], _WATER, out), 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Terrain:
    """A field, its colours [rows, columns, 3], and the ellipses' forms, which may be filtered."""

    field: HeightField
    colors: np.ndarray
    forms: tuple


@lru_cache(4)
def terrain(texels, relief, lake, seed, directions, smoothing=1, own=None, scale=0.0, *, free_weight=1.0):
    """The Terrain of a seed, or of a user's heights.

    texels      along an edge
    relief      of the highest point over the lowest, in edges of the terrain
    lake        where the water stands, as a share of that
    directions  over the whole sphere; those above the horizon are cast
    smoothing   passes of ``ellipses.smoothed``
    own, scale  heights of a user's own (``own_maps``), and their relief, which have no lake
    free_weight  as how many shadowed directions a free one counts (``ellipses.fit``)
    """
    if own is None:
        shares, level = _mountains(texels, seed), lake
        heights = relief * np.maximum(shares, level)
    else:
        heights = own.fitted(texels, texels, scale, repeated=True)
        shares, level = heights / max(float(heights.max()), 1e-9), -1.0
    field = height_field(heights)
    found = sphere.spiral(directions)
    seen = visibility.precompute(field, found[found[:, 2] > 0.0])
    fitted = ellipses.of_visibility(seen, least_radius=0.5, free_weight=free_weight)
    forms = ellipses.rooted(fitted)
    forms = ellipses.smoothed(forms, smoothing)
    return Terrain(field, _colors(shares, level, field.normals), forms)


def mesh(field, cells):
    """The field as ``cells`` x ``cells`` squares, two world units wide, y up, t away from the viewer. Its
    frames are the ground's without the heights.
    """
    flat = surfaces.plane(cells, cells)
    s, t = flat.texture_coordinates[:, 0], flat.texture_coordinates[:, 1]
    heights, rows, columns = field.heights, field.rows, field.columns
    # The mean of the texels about a vertex: what is finer is the bumps'.
    reach = max(columns // cells, 1)
    total, count = np.zeros(len(s)), 0
    for dj in range(-(reach // 2), (reach + 1) // 2 + (reach == 1)):
        for di in range(-(reach // 2), (reach + 1) // 2 + (reach == 1)):
            column = np.floor(s * columns + 0.5).astype(np.int64) + di
            row = np.floor(t * rows + 0.5).astype(np.int64) + dj
            total, count = total + heights[row % rows, column % columns], count + 1
    up = np.zeros((len(s), 3))
    up[:, 2] = 2.0 * total / count
    return replace(flat, positions=flat.positions + up).rotated(rotation("x", -90.0))


def camera(panel, eye, target, field_of_view):
    """The view of the terrain from ``eye``."""
    projection = perspective(field_of_view, panel.width / panel.height, 0.2, 12.0)
    return View(panel, look_at(eye, target), projection, tuple(map(float, eye)), False)


def light_colors(sun, low, high, ambient_low, ambient_high):
    """The colours of the sun and of the ambient light, RGB each, by the sun's height: ``low`` on the horizon,
    ``high`` from 45 degrees on.
    """
    elevation = float(normalize(np.asarray(sun, np.float64))[2])
    share = float(_step(np.array(elevation), 0.05, 0.7))
    return tuple(
        tuple(a + share * (b - a) for a, b in zip(first, last, strict=True))
        for first, last in ((low, high), (ambient_low, ambient_high))
    )
