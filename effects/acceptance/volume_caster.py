"""Rays cast at a volume in float64: the reference for slices through it.

Densities are trilinear between voxel centres, as in the texture's filter, and constant beyond the outermost.
A ray ends where it first reaches the iso-surface's density. Steps of a quarter of a voxel and bisection find
that point. This is ground truth: no figure's bits depend on it.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.acceptance.ray_caster import primary_rays
from fixedpipe.effects.geometry.vectors import dot, normalize, unit_vector
from fixedpipe.raster.kernel import kernel

# Voxels from sample to sample, and by how many halvings a crossing is found between two.
_STEP, _HALVINGS = 0.25, 20


@kernel
def _density_at(density, x, y, z):
    """The density between voxel centres (whole numbers), in bytes."""
    layers, rows, columns = density.shape
    x, y, z = min(max(x, 0.0), columns - 1.0), min(max(y, 0.0), rows - 1.0), min(max(z, 0.0), layers - 1.0)
    i, j, k = min(int(x), columns - 2), min(int(y), rows - 2), min(int(z), layers - 2)
    a, b, c = x - i, y - j, z - k
    total = 0.0
    for dk in range(2):
        for dj in range(2):
            low, high = float(density[k + dk, j + dj, i]), float(density[k + dk, j + dj, i + 1])
            weight = (c if dk else 1.0 - c) * (b if dj else 1.0 - b)
            total += weight * (low + a * (high - low))
    return total


@kernel
def _march(density, origins, directions, shortest, longest, threshold, out):
    """Where rays [k, 3] in voxels, of unit directions, first meet ``threshold``; -1 where they do not."""
    layers, rows, columns = density.shape
    for ray in range(len(origins)):
        ox, oy, oz = origins[ray, 0], origins[ray, 1], origins[ray, 2]
        dx, dy, dz = directions[ray, 0], directions[ray, 1], directions[ray, 2]
        begin, end = shortest, longest
        for axis in range(3):
            o, d = origins[ray, axis], directions[ray, axis]
            size = columns if axis == 0 else rows if axis == 1 else layers
            if d == 0.0:
                if o < -0.5 or o > size - 0.5:
                    end = -1.0
                continue
            one, other = (-0.5 - o) / d, (size - 0.5 - o) / d
            begin, end = max(begin, min(one, other)), min(end, max(one, other))
        out[ray] = -1.0
        t, before = begin, begin
        while t <= end:
            if _density_at(density, ox + t * dx, oy + t * dy, oz + t * dz) >= threshold:
                outside, inside = before, t
                for _ in range(_HALVINGS if t > begin else 0):
                    middle = 0.5 * (outside + inside)
                    value = _density_at(density, ox + middle * dx, oy + middle * dy, oz + middle * dz)
                    if value >= threshold:
                        inside = middle
                    else:
                        outside = middle
                out[ray] = inside
                break
            before = t
            t += _STEP


@dataclass(frozen=True, eq=False)
class Surface:
    """What a view shows of an iso-surface, arrays [height, width] with the bottom row first.

    seen     bool, whether there is a surface at the pixel
    points   float64 [..., 3], world coordinates
    normals  float64 [..., 3], unit vectors, of the trilinear density's gradient
    """

    seen: np.ndarray
    points: np.ndarray
    normals: np.ndarray


def _cast(volume, origins, directions, shortest=0.0):
    """Distances along rays in voxels, float64 [k], -1 where nothing is met; and the directions in voxels."""
    size = np.array(volume.density.shape[::-1], np.float64)
    scale = size / (2.0 * np.array(volume.half_extents))
    at = (origins + np.array(volume.half_extents)) * scale - 0.5
    along = normalize(directions * scale)
    out = np.empty(len(at))
    longest = 4.0 * float(size.sum()) + float(np.abs(at).max())
    _march(volume.density, np.ascontiguousarray(at), along, shortest, longest, 255.0 * volume.iso, out)
    return out, at, along, scale


def _gradients(volume, at, scale):
    """Unit normals at places in voxels, by differences from half a voxel before to half a voxel behind."""
    size = np.array(volume.density.shape[::-1])
    columns = []
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = 0.5
        values = [_sampled(volume.density, np.clip(at + s * step, 0.0, size - 1.0)) for s in (-1.0, 1.0)]
        columns.append((values[0] - values[1]) * scale[axis])
    return normalize(np.stack(columns, axis=-1))


def _sampled(density, at):
    low = np.minimum(at.astype(int), np.array(density.shape[::-1]) - 2)
    part = at - low
    total = np.zeros(len(at))
    for dz, dy, dx in np.ndindex(2, 2, 2):
        weight = np.ones(len(at))
        for axis, d in enumerate((dx, dy, dz)):
            weight = weight * (part[:, axis] if d else 1.0 - part[:, axis])
        total += weight * density[low[:, 2] + dz, low[:, 1] + dy, low[:, 0] + dx]
    return total


def visible(volume, view):
    """The iso-surface of a ``volume_rendering.Volume`` through the pixels' centres of a view: Surface."""
    origins, directions = primary_rays(view)
    distance, at, along, scale = _cast(volume, origins, directions)
    seen = distance >= 0.0
    hit = at + np.where(seen, distance, 0.0)[:, None] * along
    shape = view.panel.height, view.panel.width
    normals = np.where(seen[:, None], _gradients(volume, np.where(seen[:, None], hit, 0.0), scale), 0.0)
    points = (hit + 0.5) / scale - np.array(volume.half_extents)
    return Surface(seen.reshape(shape), points.reshape(*shape, 3), normals.reshape(*shape, 3))


def occluded(volume, points, direction, away=1.0):
    """Whether rays from world points [n, 3] in a direction meet the iso-surface, or begin behind it:
    bool [n].

    ``away``: how far along the ray they begin, in voxels, so that a surface does not hide itself.
    """
    toward = unit_vector(direction, "The rays' direction")
    distance, *_ = _cast(volume, points, np.broadcast_to(toward, points.shape), away)
    return distance >= 0.0


def lit(volume, surface, direction, least=0.0, away=1.0):
    """Where the iso-surface receives light from a direction: bool [height, width], bottom row first.

    A point is dark if it faces away, or if n.l is not above ``least``. ``away``: as for ``occluded``.
    """
    toward = unit_vector(direction, "The direction to the lamp")
    out = surface.seen & (dot(surface.normals, toward) > least)
    out[out] = ~occluded(volume, surface.points[out], direction, away)
    return out
