"""S07: an environment mirrored by upright cylinders, whose curvature is in one direction only.

Round a cylinder the mirrored ray turns fast, so a pixel covers a long arc of the environment. Along its axis
it covers no more than a flat mirror's pixel does. A level of detail is one number: a level that suits one
direction blurs the other, or leaves noise in it. The environment is a panorama, a 2D texture of longitude and
latitude. Boards of the time filter it anisotropically, if they can at all.

Let p be the azimuth of the cylinder's normal and q that of the direction to the eye. The mirrored ray's
azimuth is then 2 p - q, and its elevation is d's. Both are exact at vertices; between them the machine
interpolates.

Source: Schilling 1997, section 2 (the cylinder has no picture there); pass sequence A-S08 of the catalogue.
"""

import math
from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.samples import rays, sample_places
from fixedpipe.effects.geometry.vectors import TRIGONOMETRY_STEP, cosine, sine
from fixedpipe.effects.passes.draws import FIRST_PASS, MODULATE, REPLACE, draw, unit
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.native.threads import Threads, default_threads
from fixedpipe.pipeline.state import Sampler
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (Technique("S07", "an environment map's level of detail by hand, on a cylinder", "2"),)

PANORAMA = "panorama"


@dataclass(frozen=True)
class Pipe:
    """An upright mirror: the x and z of its axis, its radius, and where it ends above and below."""

    x: float
    z: float
    radius: float
    top: float = 1.0
    bottom: float = -1.0


# Four pipes, the eye before them and its field of view, degrees: what the study draws.
PIPES = (Pipe(-0.58, 0.0, 0.20), Pipe(-0.13, 0.0, 0.16), Pipe(0.25, 0.0, 0.12), Pipe(0.56, 0.0, 0.10))
EYE, FIELD = (0.0, 0.0, 2.4), 42.0
# Of an open end: the colours of the rim and of the dark inside, and the rim's width, of the radius.
RIM, INSIDE, RIM_WIDTH = (0.80, 0.78, 0.74), (0.07, 0.07, 0.08), 0.16


def _turns(y, x):
    """The azimuth of (x, y), a number of turns from -1/2 to 1/2, rounded: the same everywhere."""
    return np.floor(np.arctan2(y, x) / (2.0 * np.pi) / TRIGONOMETRY_STEP + 0.5) * TRIGONOMETRY_STEP


@computed_once
def shelves(height):
    """A panorama of shelves full of books all round: float64 [height, 2 height, 3], the mean of sixteen
    samples a texel, bottom row first. A back is 128/45 texels thin, a shelf 64/5 high, whatever the height
    is.
    """
    columns, rows = height * 45.0 / 64.0, height * 5.0 / 64.0
    s, t = np.meshgrid(
        (np.arange(8 * height) + 0.5) / (8 * height), (np.arange(4 * height) + 0.5) / (4 * height)
    )
    book, shelf = np.floor(s * columns), np.floor(t * rows)
    above = t * rows - shelf
    hue = [hashed(book, shelf, seed) / 65536.0 for seed in (1, 2, 3, 4)]
    back = np.stack([0.10 + 0.85 * hue[0], 0.08 + 0.75 * hue[1], 0.06 + 0.70 * hue[2]], axis=-1)
    colors = np.where((above > 0.72 + 0.2 * hue[3])[..., None], 0.05, back)
    colors = np.where((above < 0.28)[..., None], (0.93, 0.88, 0.78), colors)
    for _ in range(2):
        colors = (colors[0::2] + colors[1::2]) * 0.5
        colors = (colors[:, 0::2] + colors[:, 1::2]) * 0.5
    return colors


def load(image, profile):
    """The command that loads a panorama and its mip-maps."""
    texels = image if profile.arithmetic.exact else np.floor(255.0 * image + 0.5).astype(np.uint8)
    return TexImage(label="load the panorama", texture=PANORAMA, image=texture_2d(texels, mipmaps=True))


def sampler(lod=None, **settings):
    """How the panorama is read. ``lod``: the level that is set by hand, or None: the machine's own."""
    fixed = {} if lod is None else {"min_lod": float(lod), "max_lod": float(lod)}
    filters = TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR
    return Sampler(*filters, WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE, **fixed, **settings)


def mesh(pipe, eye, slices, stacks, shade=0.0):
    """The half of a pipe that is turned to the eye, with the panorama's coordinates at its vertices.

    ``shade``: how much of full brightness it loses where it is seen edge-on; its vertices have the colours.
    """
    toward = np.array(eye, np.float64)
    front = float(_turns(toward[0] - pipe.x, toward[2] - pipe.z))
    turn = front + (np.arange(slices + 1) / slices - 0.5) * 0.5
    height = pipe.bottom + (pipe.top - pipe.bottom) * np.arange(stacks + 1) / stacks
    turn, y = (a.ravel() for a in np.meshgrid(turn, height))
    positions = np.stack(
        [
            pipe.x + pipe.radius * sine(2.0 * np.pi * turn),
            y,
            pipe.z + pipe.radius * cosine(2.0 * np.pi * turn),
        ],
        axis=-1,
    )
    facing = (toward - positions) * ((positions - (pipe.x, 0.0, pipe.z)) * (1.0, 0.0, 1.0) / pipe.radius)
    facing = facing.sum(axis=-1) / np.sqrt(((toward - positions) ** 2).sum(axis=-1))
    light = 1.0 - shade * (1.0 - np.clip(facing, 0.0, 1.0))
    column, row = np.meshgrid(np.arange(slices), np.arange(stacks))
    corner = (row * (slices + 1) + column).ravel()
    quads = np.stack(
        [corner, corner + 1, corner + slices + 2, corner, corner + slices + 2, corner + slices + 1]
    )
    return Mesh(
        positions=positions,
        indices=quads.T.ravel(),
        texture_coordinates=(coordinates(positions - toward, turn),),
        colors=None if shade == 0.0 else np.repeat(light[:, None], 3, axis=1),
    )


def coordinates(ray, turn):
    """(s, t) in the panorama that rays [..., 3] see: float64 [..., 2]. The rays meet a cylinder where its
    normal's azimuth is ``turn`` turns from +z; s continues beyond 0 and 1.
    """
    # Azimuths from +z by way of +x; the panorama's begin at -z and run the other way round. That of the way
    # back to the eye does not jump where an eye in front sees the middle of a pipe.
    mirrored = 2.0 * turn - _turns(-ray[..., 0], -ray[..., 2])
    level = np.sqrt(ray[..., 0] * ray[..., 0] + ray[..., 2] * ray[..., 2])
    return np.stack([0.5 - mirrored, 0.5 + 2.0 * _turns(ray[..., 1], level)], axis=-1)


def pipe_passes(pipes, view, read, slices=96, stacks=16, shade=0.0):
    """A Draw for each pipe, which mirrors the loaded panorama as a sampler (``sampler``) reads it.

    ``shade``: as for ``mesh``.
    """
    units = (unit(PANORAMA, read, environment=REPLACE if shade == 0.0 else MODULATE),)
    meshes = (mesh(pipe, view.eye, slices, stacks, shade) for pipe in pipes)
    return tuple(
        draw(f"pipe {number}", bent, view, None, units, depth_test=FIRST_PASS)
        for number, bent in enumerate(meshes, 1)
    )


def _end(pipe, slices):
    """A pipe's upper end: a ring of the rim's colour round a disc of the inside's."""
    turn = np.arange(slices) / slices
    around = np.stack([sine(2.0 * np.pi * turn), 0.0 * turn, cosine(2.0 * np.pi * turn)], axis=-1)
    middle, inner = np.array((pipe.x, pipe.top, pipe.z)), (1.0 - RIM_WIDTH) * pipe.radius
    rings = (middle + pipe.radius * around, middle + inner * around)
    positions = np.concatenate([*rings, rings[1], middle[None]])
    here, after, n = np.arange(slices), (np.arange(slices) + 1) % slices, slices
    ring = (here, after, n + after, here, n + after, n + here)
    disc = (2 * n + here, 2 * n + after, np.full(n, 3 * n))
    colors = np.repeat((RIM, INSIDE), (2 * n, n + 1), axis=0)
    return Mesh(
        positions=positions,
        indices=np.concatenate([np.stack(ring).T.ravel(), np.stack(disc).T.ravel()]),
        colors=colors,
    )


def end_passes(pipes, view, slices=96):
    """A Draw for each pipe's open upper end, which mirrors nothing."""
    return tuple(
        draw(f"end of pipe {number}", _end(pipe, slices), view, None, depth_test=FIRST_PASS)
        for number, pipe in enumerate(pipes, 1)
    )


# ------------------------------------------------------------------------------------------------- the truth


@kernel("void(f8[:,::1],f8[::1],f8[:,::1],f8[:,::1],f8,f8[:,:,::1],f8[:,:,::1],i8,i8,i8,f8[:,:,::1])")
def _sampled(ray, eye, pipes, end, shade, image, jitter, side, first, last, out):
    """Rows ``first`` to ``last``: the mean colour of the samples that meet a pipe, and how many do."""
    rows, columns = image.shape[0], image.shape[1]
    mask = jitter.shape[0] - 1
    for y in range(first, last):
        for x in range(out.shape[1]):
            for j in range(side):
                for i in range(side):
                    px, py = x * side + i, y * side + j
                    wx = x + (i + jitter[py & mask, px & mask, 0]) / side
                    wy = y + (j + jitter[py & mask, px & mask, 1]) / side
                    dx = ray[0, 0] + wx * ray[1, 0] + wy * ray[2, 0]
                    dy = ray[0, 1] + wx * ray[1, 1] + wy * ray[2, 1]
                    dz = ray[0, 2] + wx * ray[1, 2] + wy * ray[2, 2]
                    nearest, nx, nz, kind = math.inf, 0.0, 0.0, -1
                    for p in range(len(pipes)):
                        ox, oz, radius = eye[0] - pipes[p, 0], eye[2] - pipes[p, 1], pipes[p, 2]
                        a, b = dx * dx + dz * dz, ox * dx + oz * dz
                        square = b * b - a * (ox * ox + oz * oz - radius * radius)
                        if square < 0.0:
                            continue
                        along = (-b - math.sqrt(square)) / a
                        if 0.0 < along < nearest and pipes[p, 4] <= eye[1] + along * dy <= pipes[p, 3]:
                            nearest, kind = along, -1
                            nx, nz = (ox + along * dx) / radius, (oz + along * dz) / radius
                    for p in range(len(pipes)):
                        if dy >= 0.0:
                            continue
                        along = (pipes[p, 3] - eye[1]) / dy
                        ox, oz = eye[0] + along * dx - pipes[p, 0], eye[2] + along * dz - pipes[p, 1]
                        off = math.sqrt(ox * ox + oz * oz) / pipes[p, 2]
                        if 0.0 < along < nearest and off <= 1.0:
                            nearest, kind = along, int(off < end[2, 0])
                    if nearest == math.inf:
                        continue
                    if kind >= 0:
                        for c in range(3):
                            out[y, x, c] += end[kind, c]
                        out[y, x, 3] += 1.0
                        out[y, x, 4] += 1.0
                        continue
                    turn = 2.0 * (dx * nx + dz * nz)
                    facing = -0.5 * turn / math.sqrt(dx * dx + dy * dy + dz * dz)
                    light = 1.0 - shade * (1.0 - facing)
                    rx, rz = dx - turn * nx, dz - turn * nz
                    # Longitude from -z by way of +x, as the panorama has it.
                    at_s = math.atan2(rx, -rz) / (2.0 * math.pi)
                    at_t = math.atan2(dy, math.sqrt(rx * rx + rz * rz)) / math.pi + 0.5
                    at_s = (at_s - math.floor(at_s)) * columns - 0.5
                    at_t = min(max(at_t * rows - 0.5, 0.0), rows - 1.0)
                    low_s, low_t = math.floor(at_s), min(math.floor(at_t), rows - 2.0)
                    u, v = at_s - low_s, at_t - low_t
                    s0, t0 = int(low_s) % columns, int(low_t)
                    s1, t1 = (s0 + 1) % columns, t0 + 1
                    for c in range(3):
                        lower = image[t0, s0, c] + u * (image[t0, s1, c] - image[t0, s0, c])
                        upper = image[t1, s0, c] + u * (image[t1, s1, c] - image[t1, s0, c])
                        out[y, x, c] += light * (lower + v * (upper - lower))
                    out[y, x, 3] += 1.0
            count = out[y, x, 3]
            for c in range(3):
                out[y, x, c] = out[y, x, c] / max(count, 1.0)
            out[y, x, 3] = count / (side * side)
            out[y, x, 4] = out[y, x, 4] / (side * side)


@computed_once
def supersampled(view, pipes, image, side=16, threads=None, *, shade=0.0):
    """The reference by ``side`` squared rays a pixel: float64 [height, width, 5], bottom row first. It has
    the mean colour of the rays that meet a pipe, their share of the pixel, and the share of those that meet
    an upper end.

    view   a perspective View
    pipes  Pipes, solid
    image  float64 [rows, columns, 3]: a panorama, two rows or more
    shade  as for ``mesh``
    """
    height, width = view.panel.height, view.panel.width
    out, threads = np.zeros((height, width, 5)), threads or default_threads()
    solid = np.array([(p.x, p.z, p.radius, p.top, p.bottom) for p in pipes], np.float64).reshape(-1, 5)
    end = np.array((RIM, INSIDE, (1.0 - RIM_WIDTH,) * 3), np.float64)
    picture = np.ascontiguousarray(image, np.float64)
    arguments = rays(view), np.array(view.eye, np.float64), solid, end, float(shade), picture

    def share(number):
        first, last = (height * k // threads for k in (number, number + 1))
        _sampled(*arguments, sample_places(side), side, first, last, out)
        return 0

    Threads(threads).run(share)
    return out


def changes(image, full):
    """Mean changes of a picture [height, width, 3] from pixel to pixel, along the axis and round it, where
    both are ``full`` [height, width]: float64 [2].
    """
    up = np.abs(image[1:] - image[:-1])[full[1:] & full[:-1]]
    right = np.abs(image[:, 1:] - image[:, :-1])[full[:, 1:] & full[:, :-1]]
    return np.array([up.mean(), right.mean()])
