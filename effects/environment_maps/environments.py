"""A room with windows as an environment: a cube map, a sphere map or a picture of the part that mirrors show.

The room is a box, with the eye of an environment map at its centre. A direction sees the wall that it meets.
Everything is a function of directions, in elementwise arithmetic, so texels have the same bits everywhere.

Source: EXT_texture_cube_map, table 3.8 (faces, through ``geometry.cube_maps``); OpenGL 1.2.1,
section 2.10.4 (SPHERE_MAP).
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry import parabolic_maps
from fixedpipe.effects.geometry.cube_maps import directions
from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map

# Half of the room's width, height and depth: x to the right, y up, z towards the viewer.
_HALF = np.array([2.0, 1.3, 2.4])

_WALL, _WARM_WALL, _SKIRTING = (
    np.array(c) for c in ((0.55, 0.57, 0.62), (0.62, 0.36, 0.22), (0.16, 0.12, 0.10))
)
_CEILING, _LAMP, _FRAME = (np.array(c) for c in ((0.66, 0.65, 0.62), (1.0, 0.97, 0.88), (0.22, 0.15, 0.10)))
_DARK_TILE, _LIGHT_TILE = np.array((0.14, 0.10, 0.09)), np.array((0.58, 0.47, 0.36))
_GILT, _HILL, _EVENING = (np.array(c) for c in ((0.70, 0.52, 0.16), (0.12, 0.25, 0.34), (0.86, 0.62, 0.38)))
_ZENITH, _HORIZON, _MEADOW = (
    np.array(c) for c in ((0.25, 0.48, 0.92), (0.92, 0.96, 1.0), (0.30, 0.46, 0.20))
)


def _mixed(first, second, amount):
    amount = np.clip(amount, 0.0, 1.0)[..., None]
    return first * (1.0 - amount) + second * amount


def _within(x, low, high):
    return (x >= low) & (x <= high)


def _window(x, y, color, left, right, bottom, top, panes):
    """A window with ``panes`` by 2 panes in front of a sky and a meadow, where (x, y) of a wall lie in it."""
    height = (y - bottom) / (top - bottom)
    outside = np.where((height < 0.28)[..., None], _MEADOW, _mixed(_HORIZON, _ZENITH, (height - 0.28) * 1.3))
    across = (x - left) / (right - left) * panes
    upright = np.abs(across - np.floor(across + 0.5)) * (right - left) / panes
    bar = np.minimum(upright, np.abs(height - 0.62) * (top - bottom))
    glass = bar > 0.035
    inside = _within(x, left, right) & _within(y, bottom, top)
    framed = _within(x, left - 0.09, right + 0.09) & _within(y, bottom - 0.09, top + 0.09)
    color = np.where((framed & ~inside)[..., None], _FRAME, color)
    return np.where(inside[..., None], np.where(glass[..., None], outside, _FRAME), color)


def _plain(y):
    return np.where((y < -_HALF[1] + 0.14)[..., None], _SKIRTING, _WALL)


def _left(x, y, z):
    """A warm wall with one window."""
    low = (y < -_HALF[1] + 0.14)[..., None]
    return _window(z, y, np.where(low, _SKIRTING, _WARM_WALL), -0.9, 0.9, -0.45, 0.95, 3)


def _right(x, y, z):
    """Two windows."""
    first = _window(z, y, _plain(y), -1.9, -0.3, -0.45, 0.95, 2)
    return _window(z, y, first, 0.3, 1.9, -0.45, 0.95, 2)


def _floor(x, y, z):
    dark = (np.floor(x / 0.5) + np.floor(z / 0.5)) % 2.0 < 0.5
    return np.where(dark[..., None], _DARK_TILE, _LIGHT_TILE)


def _ceiling(x, y, z):
    lamp = _within(x, -0.75, 0.75) & _within(z, -0.75, 0.75)
    return np.where(lamp[..., None], _LAMP, _CEILING)


def _ahead(x, y, z):
    """A door and a picture."""
    door = _within(x, -1.45, -0.65) & (y < 0.65)
    out = np.where(door[..., None], _FRAME, _plain(y))
    frame = _within(x, 0.0, 1.5) & _within(y, -0.25, 0.75)
    painted = _within(x, 0.08, 1.42) & _within(y, -0.17, 0.67)
    hill = y < (x - 0.75) * (x - 0.75) * 0.5 + 0.05
    out = np.where(frame[..., None], _GILT, out)
    return np.where(painted[..., None], np.where(hill[..., None], _HILL, _EVENING), out)


def _behind(x, y, z):
    """A great window."""
    return _window(x, y, _plain(y), -1.5, 1.5, -0.75, 1.0, 4)


# By axis, and whether the direction along it is positive.
_SIDES = (_left, _right, _floor, _ceiling, _ahead, _behind)


def room(toward):
    """The colour that a ray from the room's centre sees: RGB float64 [..., 3] in [0, 1].

    ``toward``: float64 [..., 3], not zero, of any length; -z is the wall that a viewer on the z axis faces.
    """
    toward = np.asarray(toward, np.float64)
    flat = toward.reshape(-1, 3)
    reach = np.abs(flat) / _HALF
    axis = np.argmax(reach, axis=-1)
    row = np.arange(len(flat))
    place = flat / reach[row, axis][:, None]
    side = 2 * axis + (flat[row, axis] > 0.0)
    colors = np.empty(flat.shape)
    for number, paint in enumerate(_SIDES):
        seen = side == number
        colors[seen] = paint(*place[seen].T)
    # Corners are darker, by how near the second wall is; what shines is not.
    second = np.sort(reach, axis=-1)[:, 1] / reach[row, axis]
    shade = 1.0 - 0.45 * (second * second) * (second * second)
    shines = dot(colors, np.array((0.3, 0.6, 0.1))) > 0.8
    return np.clip(colors * np.where(shines, 1.0, shade)[:, None], 0.0, 1.0).reshape(toward.shape)


def _texels(colors, profile):
    return colors if profile.arithmetic.exact else np.floor(255.0 * colors + 0.5).astype(np.uint8)


def _averaged(function, toward, texel):
    """The mean of four samples in a texel: ``texel``: two steps [..., 3] to its neighbours."""
    out = 0.0
    for ds in (-0.25, 0.25):
        for dt in (-0.25, 0.25):
            out = out + function(toward + ds * texel[0] + dt * texel[1])
    return out / 4.0


@lru_cache(maxsize=4)
def faces(size, environment=room):
    """A cube map of floats, the mean of four rays in each texel: float64 [6, size, size, 3], cached and
    read-only; ``size`` from 2 on.
    """
    toward = directions(size)
    toward = toward / np.abs(toward).max(axis=-1, keepdims=True)
    out = _averaged(environment, toward, (np.gradient(toward, axis=2), np.gradient(toward, axis=1)))
    out.flags.writeable = False
    return out


def cube_map(size, profile, environment=room):
    """The environment as a cube map texture, ``size`` texels along an edge, a mean of four rays in each.

    ``environment``: directions [..., 3] to RGB in [0, 1].
    """
    return texture_cube_map(_texels(faces(size, environment), profile), InternalFormat.RGB8)


def discs(size, environment=room, margin=2):
    """The environment as a parabolic map's two discs, a mean of four rays in each texel: float64 [2, size,
    size, 3]. ``margin``: texels between a disc and each edge of its map.
    """
    colors = environment(parabolic_maps.directions(2 * size, parabolic_maps.margin(size, margin)))
    halved = (colors[:, 0::2] + colors[:, 1::2]) / 2.0
    return (halved[:, :, 0::2] + halved[:, :, 1::2]) / 2.0


def sphere_map(size, view, profile, environment=room):
    """The environment as SPHERE_MAP coordinates read it in a view, ``size`` texels along an edge.

    Texel (s, t) is the colour along the reflection of +z in the normal (2s - 1, 2t - 1, .), in eye
    coordinates, a mean of four rays. Texels outside the circle continue its edge.
    """
    turn = np.array(view.modelview)[:3, :3].T
    return texture_2d(_texels(_sphere(size, tuple(map(tuple, turn.tolist())), environment), profile))


@lru_cache(maxsize=8)
def _sphere(size, to_world, environment):
    """A sphere map's colours, float64 [size, size, 3], kept, not to be written to. ``to_world``: rows of the
    rotation from the eye.
    """
    edge = 2.0 * (np.arange(2 * size) + 0.5) / (2 * size) - 1.0
    x, y = np.meshgrid(edge, edge)
    square = x * x + y * y
    shrink = 1.0 / np.sqrt(np.maximum(square, 1.0))
    x, y = x * shrink, y * shrink
    z = np.sqrt(np.maximum(0.0, 1.0 - (x * x + y * y)))
    in_eye = np.stack([2.0 * z * x, 2.0 * z * y, 2.0 * z * z - 1.0], axis=-1)
    colors = environment(rotate(np.array(to_world), in_eye))
    halved = (colors[0::2] + colors[1::2]) / 2.0
    out = (halved[:, 0::2] + halved[:, 1::2]) / 2.0
    out.flags.writeable = False
    return out


def picture(width, height, corners, profile, environment=room):
    """The environment behind a rectangle as a texture: what boards without cube maps draw as a background.

    ``corners``: float64 [3, 3], directions at the lower left, the lower right and the upper left; directions
    between them are linear, as on a flat picture.
    """
    rows = tuple(map(tuple, np.asarray(corners, np.float64).tolist()))
    return texture_2d(_texels(_seen_behind(width, height, rows, environment), profile))


@lru_cache(maxsize=8)
def _seen_behind(width, height, corners, environment):
    """``picture``'s colours, float64 [height, width, 3], kept, not to be written to."""
    corner, right, up = np.array(corners)
    s, t = ((np.arange(n) + 0.5) / n for n in (width, height))
    toward = (corner + s[None, :, None] * (right - corner)) + t[:, None, None] * (up - corner)
    steps = (right - corner) / width, (up - corner) / height
    out = _averaged(environment, toward, steps)
    out.flags.writeable = False
    return out


# Where the sun is, behind the great window, and its radius as a sine; its radiance, and by what windows and
# lamp are brighter.  Assumed: enough for the sun to outshine the lamp in a lobe of exponent 100.
_SUN, _SUN_RADIUS = np.array([0.42, 0.5, 2.4]), 0.02
_SUNLIGHT, _SHINE = np.array((1600.0, 1400.0, 1050.0)), 1.6


def sunlit_room(toward):
    """The room as radiance of high dynamic range, with a sun 2.3 degrees wide in its great window.

    RGB float64 [..., 3] from zero to 1600; windows and lamp are 1.6 times as bright as ``room``'s.
    """
    colors, along = room(toward), normalize(toward)
    shines = colors[..., 2] > 0.8
    lit = colors * np.where(shines, _SHINE, 1.0)[..., None]
    off = along - normalize(_SUN)
    sun = (dot(off, off) < _SUN_RADIUS * _SUN_RADIUS) & shines
    return np.where(sun[..., None], _SUNLIGHT, lit)
