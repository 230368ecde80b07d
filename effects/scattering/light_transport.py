"""G06 and G11: scattered light by the method of dependent tests, in float64.

It is the truth for machines' passes, on the same paths.

Every texel takes the same directions, so each step is one operation over the whole texture. A step is bump
mapping, with a light along l or along d_i, and a lookup of the light that the texel seen along d_i sends
back:

    L := bump(l -> -d_K)
    for k = K to 1:   L := bump(l -> v_k) + W bump(d_k -> v_k) L[S_k],   v_1 = v, v_k = -d_(k-1)

Radiances are in units of the light that a white surface facing the lamp sends back, so a diffuse texel's is
albedo (n.l)+. In these units W is 4. One direction of the sphere has the density 4 pi (erratum E002.1: the
paper's program has none); a diffuse BRDF, albedo / pi, divides by pi.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 3.1 and 3.2; pass sequences A-G06 and A-G11.
"""

import numpy as np

from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.scattering.directions import finite
from fixedpipe.effects.scattering.visibility import BACK, FREE, check_same_texels, free_view
from fixedpipe.effects.technique import Technique
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("G06", "the method of dependent tests: the same directions at every texel", "3.1, 3.2"),
    Technique("G11", "several reflections in a chain, direct light added at each", "3.2"),
    Technique("H54", "longer paths of scattered light, with direct light added at each point", "3.2"),
    Technique("H55", "the sum of 40 to 100 paths", "3.2"),
)

# 4 pi, the sphere, over pi, the BRDF of a white diffuse surface.
WEIGHT = 4.0


def bump(field, light, view):
    """The light that every texel of a HeightField sends towards ``view``, for a light of one from ``light``
    without shadows: albedo (n.l)+, and k_s ((n.h)+)^exponent where (n.l) is positive. Float64 [rows, columns,
    3].

    light, view  unit vectors [3] in the base's frame; the highlight's exponent is rounded to a whole number
    """
    return reflected(field.normals, field.albedo, light, view, field.specular, field.exponent)


def reflected(normals, albedo, light, view, specular, exponent):
    """Reflected light for any normals and albedos [..., 3]: float64 [..., 3]."""
    facing = dot(normals, light)
    out = albedo * np.maximum(facing, 0.0)[..., None]
    if specular:
        half = normalize(np.asarray(light, np.float64) + view)
        shine = _power(np.maximum(dot(normals, half), 0.0), exponent)
        out = out + (specular * np.where(facing > 0.0, shine, 0.0))[..., None]
    return out


def _power(base, exponent):
    """Whole powers by squaring, so that the bits are the same everywhere."""
    power, result = round(exponent), np.ones(base.shape)
    while power:
        if power & 1:
            result = result * base
        base, power = base * base, power >> 1
    return result


def sequences(count, length, paths, seed=0):
    """Numbers of directions, int64 [paths, length]: a path's d_1 to d_length. In every block of ``count``
    paths each direction stands once at every place, in an order that an integer hash makes.

    count   directions
    length  lookups along a path: one less than its reflections
    """
    if count < 1 or length < 0 or paths < 1:
        raise ValueError(
            f"{paths} paths of {length} lookups among {count} directions; give one or more of each."
        )
    out = np.empty((paths, length), np.int64)
    number = np.arange(count)
    for first in range(0, paths, count):
        block = out[first : first + count]
        for place in range(length):
            mixed = hashed(number, np.full(count, first // count), seed + 31 * place)
            if (place, first) == (0, 0):
                # Fewer paths than directions: as many of them, evenly from the zenith to the nadir.
                block[:, place] = ((2 * number[: len(block)] + 1) * count) // (2 * len(block))
            else:
                block[:, place] = np.argsort(mixed, kind="stable")[: len(block)]
    return out


def looked_up(light, seen, nothing=0.0):
    """L[S_i]: the light [rows, columns, 3] of the texels that are ``seen`` [rows, columns]; ``nothing``, RGB
    or a number, where a texel sees none; 0 where the normal faces away.
    """
    found = light.reshape(-1, 3)[np.maximum(seen, 0)]
    found[seen < 0] = 0.0
    found[seen == FREE] = nothing
    return found


def chain(field, visibility, path, light, view, *, lit=1.0, sky=None):
    """The light of one path over the whole field, float64 [rows, columns, 3]: direct light, and the light
    along the path's directions with the weight W.

    path   numbers of directions d_1 to d_K; none: direct light alone
    light  unit vector [3], or None where the sky alone lights
    lit    bool or float [rows, columns]: where the light is not shadowed; 1: everywhere
    sky    None, or a function of a direction [3]: the environment's radiance, RGB, in the same units

    Raises ValueError for another field's Visibility, and for numbers that no direction has.
    """
    check_same_texels(field, visibility)
    directions = visibility.directions
    wrong = [i for i in path if not 0 <= i < len(directions)]
    if wrong:
        raise ValueError(
            f"The path goes along direction {wrong[0]!r}; give numbers from 0 to {len(directions) - 1}."
        )

    def direct(towards):
        if light is None:
            return np.zeros((*field.heights.shape, 3))
        return bump(field, light, towards) * np.broadcast_to(lit, field.heights.shape)[..., None]

    views = [np.asarray(view, np.float64), *(-directions[i] for i in path)]
    out = direct(views[-1])
    for k in range(len(path) - 1, -1, -1):
        i = path[k]
        nothing = 0.0 if sky is None else sky(directions[i])
        arriving = looked_up(out, visibility.seen[i], nothing)
        out = direct(views[k]) + WEIGHT * bump(field, directions[i], views[k]) * arriving
    return out


def scattered(field, visibility, paths, light, view=(0.0, 0.0, 1.0), *, lit=None, sky=None):
    """The mean of all paths' chains: the light of a HeightField with scattering, float64 [rows, columns, 3].

    paths  int [paths, K], as ``sequences`` makes them
    lit    where the light is not shadowed; None: by rays

    Other arguments and exceptions as for ``chain``; also ValueError if there are no paths.
    """
    if not len(paths):
        raise ValueError("There are no paths, so they have no mean; give one or more.")
    if lit is None:
        lit = 1.0 if light is None else free_view(field, light)
    total = np.zeros((*field.heights.shape, 3))
    for path in np.asarray(paths).tolist():
        total += chain(field, visibility, path, light, view, lit=lit, sky=sky)
    return total / len(paths)


@kernel(
    "void(float64[:, :, ::1], float64[:, ::1], int32[:, :, ::1], float64[:, ::1], float64[:, ::1], "
    "float64[:, :, ::1])"
)
def _gather(normals, directions, seen, light, sky, out):
    """To every texel what comes along all directions: the cosine times the light of the texel that is seen,
    or times the sky's where none is in the way.
    """
    rows, columns, components = out.shape
    for row in range(rows):
        # Direction by direction along a row, as ``seen`` lies in memory; each texel adds them in their order.
        for i in range(len(directions)):
            x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
            for column in range(columns):
                texel = seen[i, row, column]
                if texel == BACK:
                    continue
                n = normals[row, column]
                cosine = (n[0] * x + n[1] * y) + n[2] * z
                for k in range(components):
                    out[row, column, k] += cosine * (light[texel, k] if texel >= 0 else sky[i, k])


def gathered(field, visibility, light, sky=None):
    """The mean light that arrives at every texel from all N directions, each with its cosine and the weight
    4 / N: float64 [rows, columns, k], which times the albedo is what a diffuse texel sends back.

    light  float64 [rows, columns, k]: what every texel sends
    sky    None, black, or float64 [n, k]: the environment along each direction

    Raises ValueError for another field's Visibility, and for other shapes.
    """
    check_same_texels(field, visibility)
    light = np.asarray(light, np.float64)
    if light.ndim != 3 or light.shape[:2] != field.heights.shape:
        raise ValueError(
            f"The light has shape {light.shape}; give [{field.rows}, {field.columns}, k], what texels send."
        )
    components = light.shape[2]
    if sky is not None and np.shape(sky) != (visibility.count, components):
        expected = visibility.count, components
        raise ValueError(
            f"The sky has shape {np.shape(sky)}; give {expected}, what comes along each direction."
        )
    sky = np.zeros((visibility.count, components)) if sky is None else np.ascontiguousarray(sky, np.float64)
    out = np.zeros((*field.heights.shape, components))
    flat = np.ascontiguousarray(light.reshape(-1, components))
    _gather(field.normals, visibility.directions, visibility.seen, flat, sky, out)
    return out * (WEIGHT / visibility.count)


def bounces(field, visibility, light, count, *, lit=None):
    """Direct light and ``count`` further reflections, each gathered from all N directions (W = 4 / N).

    Returns a list of float64 [rows, columns, 3]; the k-th has k reflections. Only diffuse light counts:
    albedo times cosine. Raises ValueError for a light that is no direction, and as ``gathered``.
    """
    light = finite(light, "The light's direction")
    if lit is None:
        lit = free_view(field, light)
    arriving = field.albedo * (np.maximum(dot(field.normals, light), 0.0) * lit)[..., None]
    out = [arriving]
    for _ in range(count):
        arriving = field.albedo * gathered(field, visibility, arriving)
        out.append(out[-1] + arriving)
    return out
