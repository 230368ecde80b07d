"""G03, G04 and G05: paths over the precomputed visibility, with random directions for each, in float64.

    L(p, v) = L_direct(p, v) + W f_r(p; d_i, v) (n_p.d_i)+ L(S_i[p], -d_i),   i at random

The units are those of ``light_transport``, where W is 4. The paper's program has no W (erratum E002.1), and
computes its direct light without a view (E002.3). A path ends where nothing is seen, and takes the sky's
light there (G30). It also ends after a number of lookups. Distribution ray tracing (G05) follows several
directions from every place.

G04. A point between texels has its own direct light, with the interpolated normal. Its indirect light is the
nearest texel's (NEAREST), which shows squares. Or it is interpolated between the four texels around
(BILINEAR), as the paper does at the first hit. Further hits are texels.

Unlike in the method of dependent tests, every point chooses its own directions, so neighbours differ by
noise.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 3; pass sequences A-G03 to A-G05 and A-G30.
"""

from concurrent.futures import ThreadPoolExecutor
from enum import StrEnum

import numpy as np

from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.scattering.directions import finite
from fixedpipe.effects.scattering.light_transport import WEIGHT, reflected
from fixedpipe.effects.scattering.visibility import BACK, FREE, check_same_texels, free_view
from fixedpipe.effects.technique import Technique, Variant
from fixedpipe.pipeline.native.threads import default_threads
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("G03", "paths of random directions over the stored visibility", "3"),
    Technique("G04", "indirect light from the nearest texel, or interpolated where the eye sees it", "3"),
    Technique("G05", "distribution ray tracing on the same data: several directions at every place", "3"),
    Variant(("G30",), "where a path meets nothing"),
)

# Texture coordinates beyond this have no digits left to tell texels apart.
_FARTHEST = 2.0**32
# Points that one task traces.
_POINTS_A_TASK = 512


class Reconstruction(StrEnum):
    """Whose indirect light a point between texels has."""

    NEAREST = "nearest"
    BILINEAR = "bilinear"


@kernel
def _mixed(number):
    """A well-mixed 64-bit number of another. Source: Steele, Lea, Flood 2014 (SplitMix)."""
    number = number + np.uint64(0x9E3779B97F4A7C15)
    number = (number ^ (number >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    number = (number ^ (number >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return number ^ (number >> np.uint64(31))


@kernel
def _shine(normal, x, y, z, vx, vy, vz, specular, exponent):
    """k_s ((n.h)+)^exponent for a light along (x, y, z) and a view along (vx, vy, vz)."""
    if specular == 0.0:
        return 0.0
    hx, hy, hz = x + vx, y + vy, z + vz
    length = np.sqrt((hx * hx + hy * hy) + hz * hz)
    if length == 0.0:
        return 0.0
    base = max(((normal[0] * hx + normal[1] * hy) + normal[2] * hz) / length, 0.0)
    result, power = 1.0, exponent
    while power:
        if power & 1:
            result = result * base
        base, power = base * base, power >> 1
    return specular * result


@kernel
def _paths(
    texels, weights, normals, albedo, lit, specular, exponent, directions, seen, sky, light, view,
    samples, lookups, branches, seed, first, stack, out,
):  # fmt: skip
    """The indirect light of points that are weighted means of texels."""
    count = np.uint64(len(directions))
    share = WEIGHT / branches
    for point in range(len(texels)):
        out[point, 0], out[point, 1], out[point, 2] = 0.0, 0.0, 0.0
        for sample in range(samples):
            key = _mixed(np.uint64(seed) ^ _mixed(np.uint64((first + point) * samples + sample)))
            for corner in range(texels.shape[1]):
                weight = weights[point, corner] / samples
                if weight == 0.0:
                    continue
                # All corners follow the same directions.
                drawn, size = np.uint64(0), 1
                stack[0, 0], stack[0, 1] = texels[point, corner], 0.0
                for k in range(3):
                    stack[0, 2 + k], stack[0, 5 + k] = view[k], weight
                while size:
                    size -= 1
                    place, depth = int(stack[size, 0]), int(stack[size, 1])
                    vx, vy, vz = stack[size, 2], stack[size, 3], stack[size, 4]
                    red, green, blue = stack[size, 5], stack[size, 6], stack[size, 7]
                    n, rho = normals[place], albedo[place]
                    if depth > 0 and lit[place] > 0.0:
                        facing = (n[0] * light[0] + n[1] * light[1]) + n[2] * light[2]
                        if facing > 0.0:
                            shine = _shine(n, light[0], light[1], light[2], vx, vy, vz, specular, exponent)
                            out[point, 0] += red * lit[place] * (rho[0] * facing + shine)
                            out[point, 1] += green * lit[place] * (rho[1] * facing + shine)
                            out[point, 2] += blue * lit[place] * (rho[2] * facing + shine)
                    if depth == lookups:
                        continue
                    for _ in range(branches):
                        drawn += np.uint64(1)
                        i = int((_mixed(key + drawn) >> np.uint64(32)) * count >> np.uint64(32))
                        met = seen[i, place]
                        if met == BACK:
                            continue
                        x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
                        cosine = (n[0] * x + n[1] * y) + n[2] * z
                        shine = _shine(n, x, y, z, vx, vy, vz, specular, exponent)
                        r = red * share * (rho[0] * cosine + shine)
                        g = green * share * (rho[1] * cosine + shine)
                        b = blue * share * (rho[2] * cosine + shine)
                        if met == FREE:
                            out[point, 0] += r * sky[i, 0]
                            out[point, 1] += g * sky[i, 1]
                            out[point, 2] += b * sky[i, 2]
                        else:
                            stack[size, 0], stack[size, 1] = met, depth + 1.0
                            stack[size, 2], stack[size, 3], stack[size, 4] = -x, -y, -z
                            stack[size, 5], stack[size, 6], stack[size, 7] = r, g, b
                            size += 1


def _around(field, s, t, reconstruction):
    """The texels, int64 [n, k], whose mean a point is, and their weights, float64 [n, k].

    Raises ValueError for points that are no such numbers [n], or so far away that they have no texel.
    """
    s, t = np.asarray(s, np.float64), np.asarray(t, np.float64)
    if s.ndim != 1 or s.shape != t.shape or not (np.maximum(np.abs(s), np.abs(t)) < _FARTHEST).all():
        raise ValueError(
            f"The points have shapes {s.shape} and {t.shape}; give s and t of each, finite numbers [n]."
        )
    x, y = s * field.columns - 0.5, t * field.rows - 0.5
    if Reconstruction(reconstruction) is Reconstruction.NEAREST:
        i, j = np.floor(x + 0.5).astype(np.int64), np.floor(y + 0.5).astype(np.int64)
        texels = (j % field.rows) * field.columns + i % field.columns
        return texels[:, None], np.ones((len(texels), 1))
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    f, g = x - i, y - j
    corners = [((1.0 - f) * (1.0 - g), 0, 0), (f * (1.0 - g), 1, 0), ((1.0 - f) * g, 0, 1), (f * g, 1, 1)]
    texels = [((j + b) % field.rows) * field.columns + (i + a) % field.columns for _, a, b in corners]
    return np.stack(texels, axis=-1), np.stack([weight for weight, _, _ in corners], axis=-1)


def _between(values, texels, weights):
    """Texels' values [rows, columns, k] or [rows, columns] at points: float64 [n, k]."""
    flat = np.asarray(values, np.float64).reshape(values.shape[0] * values.shape[1], -1)
    out = np.zeros((len(texels), flat.shape[1]))
    for k in range(texels.shape[1]):
        out += weights[:, k : k + 1] * flat[texels[:, k]]
    return out


def indirect(
    field, visibility, s, t, light, *, samples=100, lookups=3, branches=1, view=(0.0, 0.0, 1.0), lit=None,
    sky=None, reconstruction=Reconstruction.BILINEAR, seed=0, threads=None,
):  # fmt: skip
    """Light that reaches points through one lookup or more and leaves towards ``view``: float64 [n, 3].

    s, t            texture coordinates of the points, float64 [n]
    light           unit vector [3], or None: only the sky lights
    samples         paths from each point; branches: directions followed from every place of them
    lookups         along a path at most: its reflections but one
    lit             where the light is not shadowed, bool or float [rows, columns]; None: by rays
    sky             None, black, or float64 [directions, 3]: the environment along each
    reconstruction  how a point gets its light from texels; seed: of the random numbers; threads: any number
                    gives the same bits

    Raises ValueError for counts below one, lookups below zero, another field's Visibility, points or
    directions that are not finite, and arrays of other shapes.
    """
    check_same_texels(field, visibility)
    counts = (samples, branches, lookups, seed)
    if not all(-(2**63) < count < 2**63 and int(count) == count for count in counts) or seed < 0:
        raise ValueError(
            f"Paths, directions, lookups and the seed are {samples!r}, {branches!r}, {lookups!r} and "
            f"{seed!r}; give whole numbers from 0 on, below 2^63."
        )
    if min(samples, branches) < 1 or lookups < 0:
        raise ValueError(
            f"{samples} paths of {lookups} lookups with {branches} directions at every place; give one path "
            "and one direction or more, and no negative lookups."
        )
    if lit is None:
        lit = np.zeros(field.heights.shape) if light is None else free_view(field, light)
    sky = np.zeros((visibility.count, 3)) if sky is None else np.ascontiguousarray(sky, np.float64)
    if sky.shape != (visibility.count, 3):
        raise ValueError(
            f"The sky has shape {sky.shape}; give {(visibility.count, 3)}, RGB along each direction."
        )
    texels, weights = _around(field, s, t, reconstruction)
    flat = field.rows * field.columns
    shared = (
        np.ascontiguousarray(field.normals.reshape(flat, 3)),
        np.ascontiguousarray(field.albedo.reshape(flat, 3)),
        np.ascontiguousarray(np.broadcast_to(lit, field.heights.shape), np.float64).reshape(flat),
        field.specular,
        round(field.exponent),
        visibility.directions,
        visibility.seen.reshape(visibility.count, flat),
        sky,
        np.zeros(3) if light is None else finite(light, "The light's direction"),
        finite(view, "The direction to the eye"),
        samples,
        lookups,
        branches,
        seed,
    )
    out = np.empty((len(texels), 3))

    def task(first):
        here = np.s_[first : first + _POINTS_A_TASK]
        # As many as wait at once: the others of a place's directions at every depth.
        stack = np.empty((lookups * (branches - 1) + branches + 1, 8))
        _paths(texels[here], weights[here], *shared, first, stack, out[here])

    with ThreadPoolExecutor(threads or default_threads()) as pool:
        list(pool.map(task, range(0, len(texels), _POINTS_A_TASK)))
    return out


def direct(field, s, t, light, *, view=(0.0, 0.0, 1.0), lit=None, reconstruction=Reconstruction.BILINEAR):
    """Direct light at points, with the normal that is interpolated there: float64 [n, 3].

    Albedo and shadow are interpolated as ``reconstruction`` says. Arguments as for ``indirect``.
    """
    if lit is None:
        lit = free_view(field, light)
    normals = normalize(_between(field.normals, *_around(field, s, t, Reconstruction.BILINEAR)))
    around = _around(field, s, t, reconstruction)
    albedo = _between(field.albedo, *around)
    shown = _between(np.broadcast_to(np.asarray(lit, np.float64), field.heights.shape), *around)
    return reflected(normals, albedo, light, view, field.specular, field.exponent) * shown


def radiance(field, visibility, s, t, light, **settings):
    """``direct`` and ``indirect`` light of points, which take the same ``settings``: float64 [n, 3]."""
    own = {k: settings[k] for k in ("view", "lit", "reconstruction") if k in settings}
    out = indirect(field, visibility, s, t, light, **settings)
    return out if light is None else out + direct(field, s, t, light, **own)
