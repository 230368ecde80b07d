"""Where a picture's pixels lie on the surfaces that they show, and a texture's values there, in float64.

Nothing here is shared with what draws: places on a sphere or a square follow from its own equations, places
on triangles from rays, and the filters are its own.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays


@dataclass(frozen=True, eq=False)
class Seen:
    """What those pixels of a panel show that are compared.

    where   bool [size, size], bottom row first
    s, t    float64 [n], texture coordinates; one is the material's width
    frames  float64 [n, 3, 3]: tangent, binormal and normal of the surface without its bumps
    """

    where: np.ndarray
    s: np.ndarray
    t: np.ndarray
    frames: np.ndarray


def _turn(axis, degrees):
    """A rotation about "x" or "z"."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    if axis == "x":
        return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def unit(vectors):
    """Vectors [..., 3] of length one."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _grid(size, extent):
    edge = (2.0 * (np.arange(size) + 0.5) / size - 1.0) / extent
    return np.meshgrid(edge, edge)


def square(size, extent):
    """The square that fills ``extent`` of a panel: Seen."""
    x, y = _grid(size, extent)
    where = np.maximum(np.abs(x), np.abs(y)) < 1.0
    frames = np.broadcast_to(np.eye(3), (int(where.sum()), 3, 3))
    return Seen(where, 0.5 * (x[where] + 1.0), 0.5 * (y[where] + 1.0), frames)


def _on_the_sphere(longitude, latitude):
    """Tangent, binormal and normal where angles, in radians, say: [..., 3, 3]."""
    so, co, sa, ca = np.sin(longitude), np.cos(longitude), np.sin(latitude), np.cos(latitude)
    rows = ((co, 0.0 * so, -so), (-sa * so, ca, -sa * co), (ca * so, sa, ca * co))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _facets(s, t, slices, stacks):
    """The frames of the flat triangles of a sphere of slices and stacks at its own coordinates: [n, 3, 3]."""
    i, j = np.floor(s * slices), np.minimum(np.floor(t * stacks), stacks - 1.0)
    below = s * slices - i > t * stacks - j
    low, high = j == 0.0, j == stacks - 1.0
    # Corners of the two triangles of a cell, from its lower left corner; a pole's lies half a slice on.
    lower = np.where(low[:, None], [0.5, 1.0, 0.0], [0.0, 1.0, 1.0]), [0.0, 1.0, 1.0]
    upper = np.where(high[:, None], [0.0, 1.0, 0.5], [0.0, 1.0, 0.0]), [0.0, 1.0, 1.0]
    lower_t = np.where(low[:, None], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0])
    upper_t = np.where(high[:, None], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0])
    first = ((below & ~high) | low)[:, None]
    corners_s = (i[:, None] + np.where(first, lower[0], upper[0])) / slices
    corners_t = (j[:, None] + np.where(first, lower_t, upper_t)) / stacks
    corners = _on_the_sphere(2.0 * np.pi * (corners_s - 0.5), np.pi * (corners_t - 0.5))
    points = corners[:, :, 2]
    normals = unit(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]))
    mean = corners[:, :, 0].mean(axis=1)
    tangents = unit(mean - (mean * normals).sum(axis=-1, keepdims=True) * normals)
    return np.stack([tangents, np.cross(normals, tangents), normals], axis=1)


def sphere(size, radius, turns, within, repeats=(1, 1), facets=None):
    """The sphere of ``radius`` half panels that is seen along -z: Seen.

    turns    (axis, degrees) of the rotations of its frame, the first one first
    within   largest angle, in degrees, between the normal and the viewer for a pixel to be compared
    repeats  how often the material comes round, and from pole to pole
    facets   (slices, stacks) where each triangle is flat
    """
    x, y = _grid(size, radius)
    square = x * x + y * y
    where = square <= np.sin(np.radians(within)) ** 2
    points = np.stack([x[where], y[where], np.sqrt(1.0 - square[where])], axis=-1)
    turn = np.eye(3)
    for axis, degrees in turns:
        turn = _turn(axis, degrees) @ turn
    own = points @ turn
    longitude, latitude = np.arctan2(own[:, 0], own[:, 2]), np.arcsin(np.clip(own[:, 1], -1.0, 1.0))
    s, t = longitude / (2.0 * np.pi) + 0.5, latitude / np.pi + 0.5
    frames = _on_the_sphere(longitude, latitude) if facets is None else _facets(s, t, *facets)
    return Seen(where, s * repeats[0], t * repeats[1], frames @ turn.T)


def surface(shape, view):
    """A ``surfaces.Surface`` by a ray through each pixel of a view: Seen."""
    hits = RayCaster(shape.positions[shape.triangles]).nearest(*primary_rays(view), 1.0)
    found = hits.triangle >= 0
    corners, share = shape.triangles[hits.triangle[found]], hits.barycentrics[found][..., None]
    s, t = (shape.texture_coordinates[corners] * share).sum(axis=1).T
    frames = np.stack(
        [
            unit((vectors[corners] * share).sum(axis=1))
            for vectors in (shape.tangents, shape.binormals, shape.normals)
        ],
        axis=1,
    )
    return Seen(found.reshape(view.panel.height, view.panel.width), s, t, frames)


def filtered(of_texels, rows, columns, seen):
    """Linear interpolation of the values that ``of_texels`` gives for rows and columns of texels, which
    repeat.
    """
    x, y = seen.s * columns - 0.5, seen.t * rows - 0.5
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    a, b = x - i, y - j
    total = 0.0
    for dj, v in ((0, 1.0 - b), (1, b)):
        for di, u in ((0, 1.0 - a), (1, a)):
            found = of_texels((j + dj) % rows, (i + di) % columns)
            total = total + (u * v).reshape(-1, *[1] * (found.ndim - 1)) * found
    return total


def looked_up(field, seen):
    """A field [rows, columns, ...] at the pixels, interpolated: float64 [n, ...]."""
    return filtered(lambda j, i: field[j, i], *field.shape[:2], seen)


def nearest(field, seen):
    """The nearest texel of a field [rows, columns, ...], which repeats, at the pixels: [n, ...]."""
    rows, columns = field.shape[:2]
    i, j = (np.floor(c * edge).astype(np.int64) for c, edge in ((seen.s, columns), (seen.t, rows)))
    return field[j % rows, i % columns]


def named_texels(seen):
    """What S_i shows as a picture: s in red and t in green of the middle of the texel that each texel sees,
    black where it sees none: float64 [rows, columns, 3]. ``seen``: int [rows, columns], below zero: none.
    """
    rows, columns = seen.shape
    out = np.zeros((rows, columns, 3))
    out[..., 0], out[..., 1] = (seen % columns + 0.5) / columns, (seen // columns + 0.5) / rows
    return np.where((seen >= 0)[..., None], out, 0.0)


def still(picture, size):
    """A picture [rows, columns, 3] that fills a panel, by its nearest pixels: [size, size, 3]."""
    rows, columns = (np.floor((np.arange(size) + 0.5) / size * n).astype(np.int64) for n in picture.shape[:2])
    return picture[rows[:, None], columns]


def alike(shown, true, within):
    """The share of pixels [..., 3] whose colours are the true ones, clipped to [0, 1], ``within`` so much."""
    return float((np.abs(np.clip(shown, 0.0, 1.0) - np.clip(true, 0.0, 1.0)).max(axis=-1) <= within).mean())


# From where a picture is wrong.  Inferred: a byte's rounding, which an eighth power multiplies by eight.
WITHIN = 8.0 / 255.0


def _panel(figure, picture, number):
    """A panel of a figure's picture [height, columns * width, ...], whatever its aspect."""
    width = figure.panel_width(len(picture))
    return picture[:, number * width : (number + 1) * width]


def shares_alike(figure, renderer, true):
    """(on, share) of either Answer: the share of a displayed panel's pixels that have the true colours within
    8/255, the least of the panels.

    ``true``: by a panel's number which of its pixels are compared, bool [height, width], bottom row first,
    and their colours, [n, 3].
    """
    for on in (Answer.MACHINE, Answer.IDEAL):
        window = renderer.window(on, figure, figure.size)
        yield (
            on,
            min(
                alike(_panel(figure, window, k)[where], colors, WITHIN) for k, (where, colors) in true.items()
            ),
        )


def of_reference(figure, method):
    """What ``shares_alike`` takes: the pixels that a Method's reference shows in the panels
    ``figure.compared``.
    """
    picture, true = figure.reference_picture(method=method)[::-1], {}
    for number in figure.compared:
        panel = _panel(figure, picture, number - 1)
        where = panel[..., 3] > 0.0
        true[number - 1] = where, panel[where, :3]
    return true
