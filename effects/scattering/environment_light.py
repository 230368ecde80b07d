"""G30 and G34: the light that a height field in a scene reflects from a sun and a sky.

If a texel sees nothing along d_i, the environment's light comes from there; the base's frame turns the
direction into the world. On a flat part of a scene, one frame serves all texels (``sun_and_sky``). On a
curved surface, such as a sphere, every place has its own frame. There, scattered light comes from tiles. The
field's indirect light is linear in the light. So it is computed once for each direction of the upper
hemisphere, and interpolated between the three around l (``on_turning_base``).

Radiances are in units of the light that a white surface facing the sun sends back; the sun's colour is one.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 6 and figures 10 and 12; pass sequences A-G30 and
A-G34.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.vectors import cross, dot, from_frame, in_frame
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import light_transport
from fixedpipe.effects.scattering.visibility import FREE, MOST_TILES, check_same_texels, free_view
from fixedpipe.effects.scattering.visibility import _seen as texel_seen
from fixedpipe.effects.technique import Technique
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("G30", "light from an environment along all directions without a hit", "6"),
    Technique("G34", "a scene in software: direct light, its shadows, scattered light and the sky's", "6"),
)


def sun_and_sky(field, visibility, frame, light, sun, sky, bounces):
    """The light of a sun and of a sky that a HeightField on a flat base sends back: two float64 [rows,
    columns, 3].

    frame    the base's (tangent, binormal, normal) in the world, unit vectors
    light    towards the sun, a unit vector of the world; sun: its RGB
    sky      a function of directions [n, 3] of the world: the environment's radiance, float64 [n, 3]
    bounces  how often light is scattered on within the field, from 0

    Raises ValueError for a light that is no direction, and as ``light_transport.gathered``.
    """
    return sun_alone(field, visibility, frame, light, sun, bounces), sky_alone(
        field, visibility, frame, sky, bounces
    )


def sun_alone(field, visibility, frame, light, sun, bounces):
    """What ``sun_and_sky`` says of the sun. Arguments and errors are the same."""
    sphere.finite(light, "The sun's direction")
    local = in_frame(np.asarray(light, np.float64), *_axes(frame))
    lit = np.zeros((*field.heights.shape, 3))
    if local[2] > 0.0:
        facing = np.maximum(dot(field.normals, local), 0.0) * free_view(field, local)
        lit = field.albedo * facing[..., None] * np.array(sun)
    return _scattered_on(field, visibility, lit, bounces)


def sky_alone(field, visibility, frame, sky, bounces):
    """What ``sun_and_sky`` says of the sky. Arguments and errors are the same."""
    around = sky(from_frame(visibility.directions, *_axes(frame)))
    none = np.zeros((*field.heights.shape, 3))
    above = field.albedo * light_transport.gathered(field, visibility, none, around)
    return _scattered_on(field, visibility, above, bounces)


def _axes(frame):
    return [np.asarray(axis, np.float64) for axis in frame]


def _scattered_on(field, visibility, arriving, bounces):
    """Light that texels send back, with what they scatter at each other."""
    found = arriving
    for _ in range(bounces):
        arriving = field.albedo * light_transport.gathered(field, visibility, arriving)
        found = found + arriving
    return found


@dataclass(frozen=True, eq=False)
class Tiles:
    """The light that the field's texels send back for each direction, computed once.

    indirect  float64 [directions, rows * columns, 3]: the scattered light of a light of one; 0 from below
    again     float64 [rows * columns, 3]: how much even light from all around gains by further scattering
    """

    indirect: NDArray[np.float64]
    again: NDArray[np.float64]


def tiles(field, visibility, bounces):
    """The Tiles of a HeightField with so many bounces."""
    shape = (visibility.count, field.rows * field.columns, 3)
    indirect = np.zeros(shape)
    for i, direction in enumerate(visibility.directions):
        if direction[2] > 0.0 and bounces:
            lit = visibility.seen[i] == FREE
            found = light_transport.bounces(field, visibility, direction, bounces, lit=lit)
            indirect[i] = (found[-1] - found[0]).reshape(shape[1:])
    even = np.ones((visibility.count, 3))
    first = field.albedo * light_transport.gathered(
        field, visibility, np.zeros((*field.heights.shape, 3)), even
    )
    total, arriving = first, first
    for _ in range(bounces):
        arriving = field.albedo * light_transport.gathered(field, visibility, arriving)
        total = total + arriving
    # A texel that no sky reaches has what is scattered to it: little, which is left out.
    again = np.where(first > 0.0, total / np.where(first > 0.0, first, 1.0), 1.0)
    return Tiles(indirect, np.ascontiguousarray(again.reshape(shape[1:])))


@kernel
def _lights(
    texels, tangents, binormals, normals, light, heights, highest, bumps, albedo, directions, seen, corners,
    inverses, indirect, sky, direct, scattered, above,
):  # fmt: skip
    """The three lights of places that each have a texel and a frame of their own."""
    rows, columns = heights.shape
    most = MOST_TILES * 3 * (rows + columns)
    for place in range(len(texels)):
        texel = texels[place]
        t, b, n, bump = tangents[place], binormals[place], normals[place], bumps[texel]
        x = (light[0] * t[0] + light[1] * t[1]) + light[2] * t[2]
        y = (light[0] * b[0] + light[1] * b[1]) + light[2] * b[2]
        z = (light[0] * n[0] + light[1] * n[1]) + light[2] * n[2]
        for k in range(3):
            direct[place, k], scattered[place, k], above[place, k] = 0.0, 0.0, 0.0
        if z > 0.0:
            # The triangle of directions in which the light lies: the one whose least part is greatest.
            best, chosen = -np.inf, 0
            for triangle in range(len(corners)):
                least = np.inf
                for k in range(3):
                    row = inverses[triangle, k]
                    least = min(least, (row[0] * x + row[1] * y) + row[2] * z)
                if least > best:
                    best, chosen = least, triangle
            total = 0.0
            for k in range(3):
                row = inverses[chosen, k]
                weight = max((row[0] * x + row[1] * y) + row[2] * z, 0.0)
                i = corners[chosen, k]
                total += weight
                for c in range(3):
                    scattered[place, c] += weight * indirect[i, texel, c]
            facing = (bump[0] * x + bump[1] * y) + bump[2] * z
            if facing > 0.0:
                row, column = texel // columns, texel % columns
                if texel_seen(heights, column, row, x * columns, y * rows, z, highest, most) != FREE:
                    facing = 0.0
            for c in range(3):
                scattered[place, c] /= total
                direct[place, c] = albedo[texel, c] * max(facing, 0.0)
        for i in range(len(directions)):
            if seen[i, texel] != FREE:
                continue
            d = directions[i]
            cosine = (bump[0] * d[0] + bump[1] * d[1]) + bump[2] * d[2]
            # Up in the world, and between which two entries of the sky's table.
            up = (d[0] * t[1] + d[1] * b[1]) + d[2] * n[1]
            at = min(max((up * 0.5 + 0.5) * (len(sky) - 1), 0.0), len(sky) - 1.000001)
            low = int(at)
            for c in range(3):
                above[place, c] += cosine * (sky[low, c] + (at - low) * (sky[low + 1, c] - sky[low, c]))


def _outside(texels, count):
    return int(texels.min()) < 0 or int(texels.max()) >= count


def on_turning_base(field, visibility, made, texels, frames, light, sky):
    """What places on a surface send back: of direct light with its shadow, of light scattered in the field,
    and of the sky. Three float64 [n, 3].

    made    the field's Tiles
    texels  int64 [n], row * columns + column of each place's texel
    frames  (tangents, binormals, normals), float64 [n, 3] each: of the base at each place, in the world
    light   towards the light, a unit vector of the world
    sky     float64 [k, 3]: the environment's radiance at heights -1 (straight down) to 1, evenly spaced

    Shadows are by a ray for each place. Scattered light is interpolated between three directions. Scattering
    adds to the sky's light the same share as to even light.

    Raises ValueError for another field's Visibility or Tiles, places beyond the field, and arrays of other
    shapes.
    """
    check_same_texels(field, visibility)
    flat = field.rows * field.columns
    light = sphere.finite(light, "The light's direction")
    texels, sky = np.asarray(texels), np.asarray(sky, np.float64)
    if texels.ndim != 1 or texels.dtype.kind not in "iu" or (len(texels) and _outside(texels, flat)):
        raise ValueError(f"The places' texels are not whole numbers [n] from 0 to {flat - 1}; give such.")
    if len(frames) != 3 or any(np.shape(axis) != (len(texels), 3) for axis in frames):
        shapes = [np.shape(axis) for axis in frames]
        raise ValueError(f"The frames have shapes {shapes}; give three of {(len(texels), 3)}.")
    if not all(np.isfinite(axis).all() for axis in frames):
        raise ValueError("The frames hold NaN or infinity; give unit vectors.")
    if sky.ndim != 2 or sky.shape[1] != 3 or len(sky) < 2 or not np.isfinite(sky).all():
        raise ValueError(f"The sky has shape {sky.shape}; give finite numbers [k, 3] at two heights or more.")
    if made.indirect.shape != (visibility.count, flat, 3):
        raise ValueError(
            "The tiles are of another field or other directions; give what tiles makes of these."
        )
    triangles = sphere.triangulated(visibility.directions)
    a, b, c = (visibility.directions[triangles[:, k]] for k in range(3))
    volume = dot(a, cross(b, c))[:, None]
    inverses = np.stack([cross(b, c) / volume, cross(c, a) / volume, cross(a, b) / volume], axis=1)
    out = [np.empty((len(texels), 3)) for _ in range(3)]
    _lights(
        np.ascontiguousarray(texels, np.int64), *(np.ascontiguousarray(axis, np.float64) for axis in frames),
        light, field.heights, float(field.heights.max()),
        np.ascontiguousarray(field.normals.reshape(flat, 3)),
        np.ascontiguousarray(field.albedo.reshape(flat, 3)), visibility.directions,
        visibility.seen.reshape(visibility.count, flat), triangles, np.ascontiguousarray(inverses),
        made.indirect, np.ascontiguousarray(sky), *out,
    )  # fmt: skip
    direct, scattered, above = out
    albedo = field.albedo.reshape(flat, 3)[texels]
    weight = light_transport.WEIGHT / visibility.count
    return direct, scattered, albedo * above * weight * made.again[texels]
