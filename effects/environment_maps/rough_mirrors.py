"""S08, S24, S25, S29: a plane with bumps that mirrors an environment, in floats.

The truth has 256 samples a pixel. Filters by curvature and by roughness approximate it.

A pixel's footprint on the bump map gives the mean offset f, and the covariance K of the offsets around it.
The mirrored ray

    r = d - 2 (d.N) N/(N.N),   N = n + f_1 e_1 + f_2 e_2

then spreads by

    Sigma = 1/4 J_c J_c^T + J_r K J_r^T

J_c is the change of r from pixel to pixel, and J_r its change with f, both in texels of the cube map's face
that r meets. The factor is a quarter because a trilinear probe of level lambda has the deviation 2^lambda /
2: a texel's box has the variance 1/12, and interpolation between texels adds 1/6. In mip-mapping 2^lambda is
a pixel's step, so that is Sigma without roughness. A roughness of deviation sigma needs 2^lambda = 2 sigma.

S24 places probes of the short axis's level along the long axis, as footprint assembly does. Their distances
give them the variance of Sigma. S25 takes one probe of the long axis's level.

Source: Schilling 1997, sections 2 and 8; the method is reconstructed (docs/decisions/0020); pass sequences
A-S08, A-S24, A-S25 and A-S29 of the catalogue.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.samples import rays, sample_places
from fixedpipe.effects.geometry.vectors import cross, dot, unit_vector
from fixedpipe.effects.technique import Technique
from fixedpipe.effects.texture_filtering.footprint_assembly import isotropic
from fixedpipe.effects.texture_filtering.footprint_assembly import probes as footprint_probes
from fixedpipe.pipeline.native.threads import Threads, default_threads
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("S08", "environment and bump mapping antialiased by curvature and by roughness", "2, 9"),
    Technique("S09", "a bump map mip-mapped as if it were colours", "3, 4"),
    Technique("S11", "cone tracing: an environment filtered by the curvature that bumps show", "5"),
    Technique("S24", "an environment map filtered anisotropically, by D", "8"),
    Technique("S25", "the level of an environment map by isotropic roughness", "8"),
    Technique("S29", "massive supersampling, with which all other methods are compared", "9"),
)

# Samples along a pixel's edge: 256 a pixel.
SIDE = 16


class Antialiasing(StrEnum):
    """What is filtered.

    NONE         nothing: level 0 of bumps and environment in the pixel's middle
    MIP          bumps as if they were colours (S09), the environment by curvature
    CONE         bumps of level 0, the environment by the curvature that they show (S11)
    ISOTROPIC    bumps, and the environment's level by curvature and roughness (S25)
    ANISOTROPIC  bumps, and probes along the longer axis of curvature and roughness (S24)
    """

    NONE = "none"
    MIP = "mip"
    CONE = "cone"
    ISOTROPIC = "isotropic"
    ANISOTROPIC = "anisotropic"


@dataclass(frozen=True)
class Mirror:
    """An infinite plane: one of its points, two unit vectors e_1 and e_2 in it at a right angle, and the
    length of the bump map's period in world units. The normal is e_1 x e_2; u runs along e_1, v along e_2.
    """

    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    e_1: tuple[float, float, float] = (1.0, 0.0, 0.0)
    e_2: tuple[float, float, float] = (0.0, 0.0, -1.0)
    period: float = 1.0

    def __post_init__(self):
        first, second = (unit_vector(v, "An edge of the mirror") for v in (self.e_1, self.e_2))
        if abs(float(dot(first, second))) > 1e-9:
            raise ValueError("The mirror's e_1 and e_2 are not perpendicular; give two that are.")
        if not (np.isfinite(self.period) and self.period > 0.0):
            raise ValueError(f"The bump map's period is {self.period}; give a length above zero.")

    @property
    def frame(self):
        """e_1, e_2 and n: float64 [3, 3]."""
        first, second = (unit_vector(v, "An edge of the mirror") for v in (self.e_1, self.e_2))
        return np.stack([first, second, cross(first, second)])


# ------------------------------------------------------------------------------------------------- the truth


@kernel
def _face_of(x, y, z):
    """(face, s, t) of a direction, as cube_maps.places."""
    ax, ay, az = abs(x), abs(y), abs(z)
    if az >= ay and az >= ax:
        return (4, x / az, -y / az) if z >= 0.0 else (5, -x / az, -y / az)
    if ay >= ax:
        return (2, x / ay, z / ay) if y >= 0.0 else (3, x / ay, -z / ay)
    return (0, -z / ax, -y / ax) if x >= 0.0 else (1, z / ax, -y / ax)


@kernel
def _added(cube, x, y, z, out):
    """Add what a cube map holds along a direction, bilinearly, to ``out``."""
    size = cube.shape[1]
    face, s, t = _face_of(x, y, z)
    at_s = min(max(0.5 * (s + 1.0) * size - 0.5, 0.0), size - 1.0)
    at_t = min(max(0.5 * (t + 1.0) * size - 0.5, 0.0), size - 1.0)
    s0, t0 = min(int(at_s), max(size - 2, 0)), min(int(at_t), max(size - 2, 0))
    s1, t1 = min(s0 + 1, size - 1), min(t0 + 1, size - 1)
    u, v = at_s - s0, at_t - t0
    for c in range(3):
        lower = cube[face, t0, s0, c] + u * (cube[face, t0, s1, c] - cube[face, t0, s0, c])
        upper = cube[face, t1, s0, c] + u * (cube[face, t1, s1, c] - cube[face, t1, s0, c])
        out[c] += lower + v * (upper - lower)


@kernel(
    "void(f8[:,::1],f8[::1],f8[:,::1],f8,f8[:,:,::1],f8[:,:,:,::1],f8[:,:,::1],i8,i8,i8,f8[::1],f8[:,:,::1])"
)
def _sampled(ray, eye, frame, period, offsets, cube, jitter, side, first, last, sums, out):
    """Rows ``first`` to ``last`` of the picture: means of ``side`` squared samples."""
    rows, columns = offsets.shape[0], offsets.shape[1]
    e1, e2, n = frame[0], frame[1], frame[2]
    height = (eye[0] * n[0] + eye[1] * n[1]) + eye[2] * n[2]
    eye_u = (eye[0] * e1[0] + eye[1] * e1[1]) + eye[2] * e1[2]
    eye_v = (eye[0] * e2[0] + eye[1] * e2[1]) + eye[2] * e2[2]
    period_mask = jitter.shape[0] - 1
    for y in range(first, last):
        for x in range(out.shape[1]):
            sums[0], sums[1], sums[2] = 0.0, 0.0, 0.0
            for j in range(side):
                for i in range(side):
                    px, py = x * side + i, y * side + j
                    wx = x + (i + jitter[py & period_mask, px & period_mask, 0]) / side
                    wy = y + (j + jitter[py & period_mask, px & period_mask, 1]) / side
                    dx = ray[0, 0] + wx * ray[1, 0] + wy * ray[2, 0]
                    dy = ray[0, 1] + wx * ray[1, 1] + wy * ray[2, 1]
                    dz = ray[0, 2] + wx * ray[1, 2] + wy * ray[2, 2]
                    down = (dx * n[0] + dy * n[1]) + dz * n[2]
                    if down * height >= 0.0:  # away from the plane
                        _added(cube, dx, dy, dz, sums)
                        continue
                    along = -height / down
                    s = (eye_u + along * ((dx * e1[0] + dy * e1[1]) + dz * e1[2])) / period
                    t = (eye_v + along * ((dx * e2[0] + dy * e2[1]) + dz * e2[2])) / period
                    at_s, at_t = (s - np.floor(s)) * columns - 0.5, (t - np.floor(t)) * rows - 0.5
                    low_s, low_t = np.floor(at_s), np.floor(at_t)
                    a, b = at_s - low_s, at_t - low_t
                    s0, t0 = int(low_s) % columns, int(low_t) % rows
                    s1, t1 = (s0 + 1) % columns, (t0 + 1) % rows
                    lower = offsets[t0, s0, 0] + a * (offsets[t0, s1, 0] - offsets[t0, s0, 0])
                    upper = offsets[t1, s0, 0] + a * (offsets[t1, s1, 0] - offsets[t1, s0, 0])
                    f1 = lower + b * (upper - lower)
                    lower = offsets[t0, s0, 1] + a * (offsets[t0, s1, 1] - offsets[t0, s0, 1])
                    upper = offsets[t1, s0, 1] + a * (offsets[t1, s1, 1] - offsets[t1, s0, 1])
                    f2 = lower + b * (upper - lower)
                    nx = n[0] + f1 * e1[0] + f2 * e2[0]
                    ny = n[1] + f1 * e1[1] + f2 * e2[1]
                    nz = n[2] + f1 * e1[2] + f2 * e2[2]
                    k = 2.0 * ((dx * nx + dy * ny) + dz * nz) / ((nx * nx + ny * ny) + nz * nz)
                    _added(cube, dx - k * nx, dy - k * ny, dz - k * nz, sums)
            for c in range(3):
                out[y, x, c] = sums[c] / (side * side)


def _checked_offsets(offsets):
    offsets = np.ascontiguousarray(offsets, np.float64)
    if offsets.ndim != 3 or offsets.shape[2] != 2 or not offsets.size or not np.isfinite(offsets).all():
        raise ValueError(f"The bump map has shape {offsets.shape}; give finite offsets [rows, columns, 2].")
    return offsets


def supersampled(view, mirror, offsets, cube, side=SIDE, threads=None):
    """The reference by ``side`` squared rays a pixel, each in its own cell, with bumps of level 0: float64
    [height, width, 3], bottom row first. Pixels above the horizon show the environment itself.

    view     a perspective View; its panel's size is the picture's
    offsets  float64 [rows, columns, 2]: f, as level 0 of a pyramid
    cube     float64 [6, n, n, 3]: the environment

    Raises ValueError for other shapes, for numbers that are not finite, or fewer than one sample.
    """
    if side < 1:
        raise ValueError(f"{side} samples along a pixel's edge are asked for; give one or more.")
    offsets, cube = _checked_offsets(offsets), np.ascontiguousarray(cube_maps.checked(cube))
    jitter = sample_places(side)
    height, width = view.panel.height, view.panel.width
    out, threads = np.empty((height, width, 3)), threads or default_threads()
    eye = np.array(view.eye) - np.array(mirror.origin, np.float64)

    def share(number):
        first, last = (height * k // threads for k in (number, number + 1))
        _sampled(
            rays(view), eye, mirror.frame, float(mirror.period), offsets, cube, jitter, side, first, last,
            np.empty(3), out,
        )  # fmt: skip
        return 0

    Threads(threads).run(share)
    return out


# ---------------------------------------------------------------------------------------------- the answers


def cube_pyramid(cube):
    """A cube map and its mip-maps by boxes of 2x2, down to one texel: a tuple of float64 [6, n, n, 3].

    Raises ValueError for another shape or an edge that is no power of two.
    """
    cube = cube_maps.checked(cube)
    if cube.shape[1] & (cube.shape[1] - 1):
        raise ValueError(f"The cube map has {cube.shape[1]} texels along an edge; give a power of two.")
    levels = [cube]
    while cube.shape[1] > 1:
        rows = (cube[:, 0::2] + cube[:, 1::2]) * 0.5
        cube = (rows[:, :, 0::2] + rows[:, :, 1::2]) * 0.5
        levels.append(cube)
    return tuple(levels)


def probe(levels, toward, level):
    """A cube map's pyramid along directions [..., 3] at lambda [...], trilinearly: float64 [..., 3]."""
    level = np.clip(np.asarray(level, np.float64), 0.0, len(levels) - 1.0)
    below = np.minimum(np.floor(level).astype(np.int64), max(len(levels) - 2, 0))
    part = (level - below)[..., None]
    out = np.zeros(toward.shape)
    for number in np.unique(below):
        here = below == number
        fine = cube_maps.look_up(levels[number], toward[here])
        coarse = cube_maps.look_up(levels[min(number + 1, len(levels) - 1)], toward[here])
        out[here] = fine + part[here] * (coarse - fine)
    return out


def face_changes(toward, changes, size):
    """Changes of direction in texels of the face that the direction meets, float64 [..., k, 2]; and the two
    vectors in the face's plane that are a texel's step along s and t, [..., 2, 3].

    toward   float64 [..., 3]
    changes  float64 [..., k, 3]
    size     texels along an edge
    """
    face, s, t = cube_maps.places(toward)
    major = np.abs(toward).max(axis=-1)
    steps = np.stack([cube_maps.vectors(s_t[0], s_t[1]) for s_t in ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0))])
    along_s, along_t, out = steps[0, face] - steps[2, face], steps[1, face] - steps[2, face], steps[2, face]
    of_s, of_t, of_major = (dot(changes, axis[..., None, :]) for axis in (along_s, along_t, out))
    scale = (0.5 * size / major)[..., None]
    texels = [scale * (of_s - s[..., None] * of_major), scale * (of_t - t[..., None] * of_major)]
    texel = (2.0 / size * major)[..., None]
    return np.stack(texels, axis=-1), np.stack([texel * along_s, texel * along_t], axis=-2)


@dataclass(frozen=True, eq=False)
class Beam:
    """The beams that a plane's pixels mirror, float64 [height, width, ...].

    hits        bool: whether the plane is met
    toward      [3]: r
    by_offset   [2, 3]: what r changes by with f_1 and f_2
    by_pixel    [2, 3]: what r changes by to the right and upwards
    covariance  [3]: K, (a, b, c)
    incoming    [3]: d, of unit length
    offsets     [2]: f
    level       of the bump map's footprint, lambda
    """

    hits: np.ndarray
    toward: np.ndarray
    by_offset: np.ndarray
    by_pixel: np.ndarray
    covariance: np.ndarray
    incoming: np.ndarray | None = None
    offsets: np.ndarray | None = None
    level: np.ndarray | None = None


def mirrored(incoming, offsets, frame):
    """r and its derivatives by f: float64 [..., 3] and [..., 2, 3].

    incoming  float64 [..., 3]: d, towards the plane
    offsets   float64 [..., 2]
    frame     float64 [3, 3]: e_1, e_2, n
    """
    normal = (offsets[..., :1] * frame[0] + offsets[..., 1:] * frame[1]) + frame[2]
    square, facing = dot(normal, normal), dot(incoming, normal)
    scale = 2.0 * facing / square
    toward = incoming - scale[..., None] * normal
    changes = []
    for axis in frame[:2]:
        turn = 2.0 * dot(incoming, axis) / square - 2.0 * scale * dot(normal, axis) / square
        changes.append(-(turn[..., None] * normal + scale[..., None] * axis))
    return toward, np.stack(changes, axis=-2)


def _level(texels):
    """log2 of an edge in texels, rounded to 1/256: float64 of the same shape, 0 for a texel and less."""
    return np.floor(256.0 * np.log2(np.maximum(texels, 1.0)) + 0.5) / 256.0


def _met(view, mirror, sizes):
    """Where a view's pixels, and one more column and row, meet the plane: hits, s and t, the changes of (s,
    t) to the right and upwards in texels [..., 2], the rays [..., 3] and their changes [..., 2, 3].
    """
    ray, frame = rays(view), mirror.frame
    wx, wy = (np.arange(n + 1) + 0.5 for n in (view.panel.width, view.panel.height))
    to = (ray[0] + wx[None, :, None] * ray[1]) + wy[:, None, None] * ray[2]
    eye = np.array(view.eye) - np.array(mirror.origin, np.float64)
    height, down = float(dot(eye, frame[2])), dot(to, frame[2])
    hits = down * height < 0.0
    down = np.where(hits, down, -1.0)
    along = np.where(hits, -height / down, 0.0)
    point = eye + along[..., None] * to
    s, t = (dot(point, axis) / mirror.period for axis in frame[:2])
    changes, turns = [], []
    length = np.sqrt(dot(to, to))[..., None]
    for step in ray[1:]:
        across = along[..., None] * (step - (dot(step, frame[2]) / down)[..., None] * to)
        texels = [dot(across, frame[k]) / mirror.period * sizes[k] for k in (0, 1)]
        changes.append(np.stack(texels, axis=-1))
        turns.append(step / length - (dot(step, to)[..., None] / (length * length * length)) * to)
    return hits, s, t, changes, to / length, np.stack(turns, axis=-2)


def _filtered(levels, s, t, changes, antialiasing, probes):
    """f and K of footprints on the bump map: float64 [..., 2] and [..., 3]."""
    bumps, roughness = [level.offsets for level in levels], [level.covariance for level in levels]
    if antialiasing in (Antialiasing.NONE, Antialiasing.CONE):
        f = rough.trilinear(bumps, s, t, 0.0)
        return f, np.zeros((*f.shape[:-1], 3))
    footprint = isotropic(*changes) if probes == 1 else footprint_probes(*changes, probes, exact=True)
    rows, columns = levels[0].offsets.shape[:2]
    level, count = _level(footprint.edge), footprint.count[..., None]
    f, k, square = (np.zeros((*s.shape, n)) for n in (2, 3, 3))
    for number in range(int(count.max())):
        x, y = np.moveaxis(footprint.offsets(number), -1, 0)
        at = s + x / columns, t + y / rows, level
        share = np.where(number < count, 1.0 / count, 0.0)
        one = rough.trilinear(bumps, *at)
        f, square = f + share * one, square + share * rough.products(one)
        k = k + share * rough.trilinear(roughness, *at)
    if antialiasing is Antialiasing.MIP:
        return f, np.zeros(k.shape)
    return f, k if probes == 1 else k + (square - rough.products(f))


def beams(view, mirror, levels, antialiasing=Antialiasing.ANISOTROPIC, probes=1):
    """The Beam of each pixel of a perspective view.

    levels  both pyramids, as roughness_pyramids makes them
    probes  most probes of the bump map, along the longer edge of a pixel's footprint. K also gets the
            difference of f from probe to probe, as it gets what is lost between two levels
    """
    antialiasing, frame = Antialiasing(antialiasing), mirror.frame
    rows, columns = levels[0].offsets.shape[:2]
    hits, s, t, changes, incoming, turns = _met(view, mirror, (columns, rows))
    f, k = _filtered(levels, s, t, changes, antialiasing, probes)
    toward, by_offset = mirrored(incoming, f, frame)
    by_pixel = []
    for axis, turn in enumerate(np.moveaxis(turns, -2, 0)):
        turned = mirrored(incoming + turn, f, frame)[0] - toward
        # Next to the horizon a neighbour may miss the plane: its f tells nothing.
        after = [slice(None)] * 2
        after[1 - axis] = slice(1, None)
        before = [slice(None)] * 2
        before[1 - axis] = slice(None, -1)
        df = np.zeros(f.shape)
        both = (hits[tuple(after)] & hits[tuple(before)])[..., None]
        df[tuple(before)] = np.where(both, f[tuple(after)] - f[tuple(before)], 0.0)
        by_pixel.append(turned + df[..., :1] * by_offset[..., 0, :] + df[..., 1:] * by_offset[..., 1, :])
    inside = np.s_[:-1, :-1]
    return Beam(
        hits[inside],
        np.where(hits[..., None], toward, incoming)[inside],
        by_offset[inside],
        np.stack(by_pixel, axis=-2)[inside],
        k[inside],
        incoming[inside],
        f[inside],
        _level(isotropic(*changes).edge)[inside],
    )


def spread(beam, size):
    """Sigma, (a, b, c), in texels squared of the face that r meets, and a texel's steps along the face's s
    and t: float64 [..., 3] and [..., 2, 3]. ``size``: texels along the cube map's edge.
    """
    d_1, d_2, d_3 = (x[..., None] for x in np.moveaxis(rough.deviations(beam.covariance), -1, 0))
    along_1, along_2 = beam.by_offset[..., 0, :], beam.by_offset[..., 1, :]
    columns = [0.5 * beam.by_pixel[..., 0, :], 0.5 * beam.by_pixel[..., 1, :]]
    columns += [d_1 * along_1, d_2 * along_1 + d_3 * along_2]
    texels, steps = face_changes(beam.toward, np.stack(columns, axis=-2), size)
    sigma = rough.products(texels)
    return ((sigma[..., 0, :] + sigma[..., 1, :]) + sigma[..., 2, :]) + sigma[..., 3, :], steps


def environment_probes(sigma, most):
    """(axis, length, count, level) of probes that together have the covariance Sigma.

    axis    [..., 2], the unit vector of the long axis
    length  texels from end to end of N probes' places, as A-S02 spaces them
    count   N, int64
    level   each probe's lambda
    """
    long, short, axis = rough.principal(sigma)
    short = np.maximum(short, 0.5)
    # Of light spread evenly over a length L the deviation is L / sqrt(12); a probe's edge is two of its own.
    wanted = np.where(long <= short, 1.0, np.ceil(np.sqrt(3.0) * long / short))
    count = np.minimum(wanted, most).astype(np.int64)
    # One probe alone must be as wide as the long axis; of more that are too few each is a share of it.
    share = long if most == 1 else np.sqrt(3.0) * long / most
    each = np.where(wanted > most, np.minimum(share, long), short)
    spaces = np.where(count > 1, 1.0 - 1.0 / (count * count), 1.0)
    length = np.sqrt(12.0 * np.maximum(long * long - each * each, 0.0) / spaces)
    return axis, np.where(count > 1, length, 0.0), count, _level(2.0 * each)


def shown(beam, cube_levels, antialiasing=Antialiasing.ANISOTROPIC, most=16):
    """The environment's colour in each pixel's Beam: float64 [height, width, 3], bottom row first.

    cube_levels  as ``cube_pyramid``
    most         probes of the environment at most
    """
    antialiasing = Antialiasing(antialiasing)
    if antialiasing is Antialiasing.NONE:
        return cube_maps.look_up(cube_levels[0], beam.toward)
    sigma, steps = spread(beam, cube_levels[0].shape[1])
    anisotropic = antialiasing is Antialiasing.ANISOTROPIC
    axis, length, count, level = environment_probes(sigma, most if anisotropic else 1)
    line = length[..., None] * (axis[..., :1] * steps[..., 0, :] + axis[..., 1:] * steps[..., 1, :])
    out = np.zeros(beam.toward.shape)
    for k in range(int(count.max())):
        here = k < count
        place = (2.0 * k + 1.0 - count[here]) / (2.0 * count[here])
        colors = probe(cube_levels, beam.toward[here] + place[..., None] * line[here], level[here])
        out[here] += colors / count[here][..., None]
    return out


def picture(view, mirror, levels, cube_levels, antialiasing=Antialiasing.ANISOTROPIC, *, probes=1, most=16):
    """A plane that mirrors an environment, and the environment above it, as floats: float64 [height, width,
    3], bottom row first. Arguments as for ``beams`` and ``shown``.
    """
    beam = beams(view, mirror, levels, antialiasing, probes)
    return shown(beam, cube_levels, antialiasing, most)
