"""Functions of direction as cube maps of floats: texels' places, their solid angles, and lookups by
direction.

Faces are in the order +x, -x, +y, -y, +z, -z, each with its row of the smallest t first. The module uses
float64 addition, multiplication, division and square root, so texels have the same bits on every processor.

Source: EXT_texture_cube_map, table 3.8 (faces and their axes).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.raster.kernel import kernel

# A face's axes: of a vector (x, y, z) the components that are s, t and the major axis, and their signs.
# Source: EXT_texture_cube_map, table 3.8.
_COMPONENTS = np.array([(2, 1, 0), (2, 1, 0), (0, 2, 1), (0, 2, 1), (0, 1, 2), (0, 1, 2)])
_SIGNS = np.array([(-1, -1, 1), (1, -1, -1), (1, 1, 1), (1, -1, -1), (1, -1, 1), (-1, -1, -1)], np.float64)
# Cells along a face's edge that solid angles are integrated over, at the least, by Gauss's rule of two
# points.  Measured: the sum over the sphere is 4 pi to 2e-9 whatever the size is.
_CELLS = 64


def checked(cube, what="The cube map"):
    """A cube map as float64 [6, n, n, 3].

    Raises ValueError, naming ``what``, for another shape, no texels, NaN and infinity.
    """
    cube = np.asarray(cube, np.float64)
    if cube.ndim != 4 or cube.shape[0] != 6 or cube.shape[1] != cube.shape[2] or cube.shape[3] != 3:
        raise ValueError(f"{what} has shape {cube.shape}; give six square faces of RGB, [6, n, n, 3].")
    if not cube.size:
        raise ValueError(f"{what} has no texels; give faces of one texel or more.")
    if not np.isfinite(cube).all():
        raise ValueError(f"{what} holds NaN or infinity; give finite numbers.")
    return cube


def size_of(size, what="The cube map's size"):
    """A number of texels along an edge as an int. Raises ValueError, naming ``what``, below one."""
    if isinstance(size, bool) or int(size) != size or size < 1:
        raise ValueError(f"{what} is {size!r}; give a whole number of texels from 1 on.")
    return int(size)


def vectors(s, t):
    """Vectors to places on the six faces, from -1 to 1 on each (and beyond, in the face's plane): float64
    [6, *shape, 3], not of unit length, of s and t of one shape.
    """
    s, t = np.broadcast_arrays(np.asarray(s, np.float64), np.asarray(t, np.float64))
    place = s, t, np.ones_like(s)
    out = np.empty((6, *s.shape, 3))
    for face, (components, signs) in enumerate(zip(_COMPONENTS, _SIGNS, strict=True)):
        for k in range(3):
            out[face, ..., components[k]] = signs[k] * place[k]
    return out


def directions(size):
    """Unit vectors towards texel centres, ``size`` along an edge: float64 [6, size, size, 3]."""
    edge = 2.0 * (np.arange(size_of(size)) + 0.5) / size - 1.0
    return normalize(vectors(*np.meshgrid(edge, edge)))


def solid_angles(size):
    """Solid angles of the texels of one face, in steradians: float64 [size, size]; all faces have the same.

    The integral of (1 + s^2 + t^2)^(-3/2) over each texel.
    """
    cells = -(-_CELLS // size_of(size))
    middle = 2.0 * (np.arange(size * cells) + 0.5) / (size * cells) - 1.0
    half = 1.0 / (size * cells)
    out = 0.0
    for ds in (-half, half):
        for dt in (-half, half):
            s, t = np.meshgrid(middle + ds / np.sqrt(3.0), middle + dt / np.sqrt(3.0))
            square = (1.0 + s * s) + t * t
            out = out + half * half / (square * np.sqrt(square))
    columns = sum(out[:, k::cells] for k in range(cells))
    return sum(columns[k::cells] for k in range(cells))


def places(toward):
    """Where directions meet the cube: faces, int64 [...], and s and t from -1 to 1, float64 [...] each.

    ``toward``: float64 [..., 3], not zero, of any length. Among equal components z comes before y before x.
    """
    toward = np.asarray(toward, np.float64)
    reach = np.abs(toward[..., ::-1])
    axis = 2 - np.argmax(reach, axis=-1)
    major = np.take_along_axis(toward, axis[..., None], axis=-1)
    face = 2 * axis + (major[..., 0] < 0.0)
    s, t = (
        _SIGNS[face, k] * np.take_along_axis(toward, _COMPONENTS[face, k][..., None], axis=-1)[..., 0]
        for k in (0, 1)
    )
    size = np.abs(major[..., 0])
    return face, s / size, t / size


@kernel("void(float64[:, :, :, ::1], float64[:, ::1], float64[:, ::1])")
def _look_up(cube, toward, out):
    """``look_up`` of directions [n, 3], as ``places`` finds them."""
    size = cube.shape[1]
    for n in range(len(toward)):
        x, y, z = toward[n]
        if abs(z) >= abs(y) and abs(z) >= abs(x):
            face, major = (5 if z < 0.0 else 4), z
            s, t = -x if z < 0.0 else x, -y
        elif abs(y) >= abs(x):
            face, major = (3 if y < 0.0 else 2), y
            s, t = x, -z if y < 0.0 else z
        else:
            face, major = (1 if x < 0.0 else 0), x
            s, t = z if x < 0.0 else -z, -y
        s0, s1, u = _between(s / abs(major), size)
        t0, t1, v = _between(t / abs(major), size)
        for k in range(cube.shape[3]):
            lower = cube[face, t0, s0, k] + u * (cube[face, t0, s1, k] - cube[face, t0, s0, k])
            upper = cube[face, t1, s0, k] + u * (cube[face, t1, s1, k] - cube[face, t1, s0, k])
            out[n, k] = lower + v * (upper - lower)


@kernel("Tuple((int64, int64, float64))(float64, int64)")
def _between(place, size):
    """Between which two texels of ``size`` a place from -1 to 1 lies, and how far."""
    at = min(max(0.5 * (place + 1.0) * size - 0.5, 0.0), size - 1.0)
    low = min(int(at), max(size - 2, 0))
    return low, min(low + 1, size - 1), at - low


def look_up(cube, toward):
    """The values of a cube map [6, n, n, c] along directions [..., 3], not zero: float64 [..., c].

    Bilinear between texel centres; a face is clamped at its edge, as with CLAMP_TO_EDGE. Raises ValueError
    for a direction that is zero, NaN or infinite.
    """
    # Copies where an array is kept from being written to, which a kernel does not take.
    cube, toward = (np.require(a, np.float64, ("C", "W")) for a in (cube, toward))
    flat = toward.reshape(-1, 3)
    if not (np.isfinite(flat).all() and flat.any(axis=-1).all()):
        raise ValueError("A direction is zero, NaN or infinite; give vectors that point somewhere.")
    out = np.empty((len(flat), cube.shape[3]))
    _look_up(cube, flat, out)
    return out.reshape(*toward.shape[:-1], cube.shape[3])


@dataclass(frozen=True, eq=False)
class Seen:
    """A cube map [6, n, n, c] as an environment: a function of directions. Two of the same array are equal,
    so that results made from them can be cached.
    """

    cube: NDArray[np.float64]

    def __call__(self, toward):
        """What the cube map holds along directions, as ``look_up``."""
        return look_up(self.cube, toward)

    def __eq__(self, other):
        return isinstance(other, Seen) and other.cube is self.cube

    def __hash__(self):
        return id(self.cube)
