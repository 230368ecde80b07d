"""K18, mip-mapped material textures: a reflectance model fitted to the area of each texel in each level.

A mip-map generator would average the vectors of Eq. 1 over a texel's area (``vectors``). That loses how far
the frames in it differ: bumps vanish and leave a highlight as narrow as a single texel's. The reflection has
to be averaged. There are two ways to store that average as one tangent, binormal and k_s:

``lobe_fit``        the paper's: Eq. 1 fitted by least squares to the mean lobe of the texels covered
``covariance_fit``  cheaper: Eq. 1 with the same volume, direction and covariance as those texels' lobes

Both use the form of Eq. 1 for a halfway vector of length one. With Q = k_s (I - T T' - B B'), T = t / alpha_x
and B = b / alpha_y,

    k_s (1 - (h.T)^2 - (h.B)^2)+  =  (h' Q h)+,

so every symmetric Q is a lobe; its largest eigenvalue is k_s, with the eigenvector n. If no texel's lobe is
cut off at zero, the mean lobe is exactly that of the mean Q (``mean_form``). With the clamp, a fit is needed.
It has six numbers, and is linear in them while the set of h with a positive lobe is known.

Eq. 1 depends on T and B only through T T' + B B', which stays the same when both turn in their plane. Filters
blend neighbouring texels' vectors. So T and B are chosen as near as possible to the texels' mean tangent and
binormal, and are not always perpendicular.

Source: Kautz, Seidel 2000, section 7 (named, not done); the catalogue's K18 and, for the covariance, its S16
(Schilling 1997). Eq. 1 as a quadratic form is derived here, and tests hold it.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.passes.encoding import vector_and_factor_texels
from fixedpipe.effects.reflectance.material_textures import (
    LARGEST_EXPONENT,
    SMALLEST_ALPHA,
    STORAGE_SCALE,
    MaterialNames,
)
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import Texture, texture_2d

TECHNIQUES = (
    Technique("K18", "mip-mapped materials: a model fitted to what each texel of a level covers", "7"),
)


@dataclass(frozen=True, eq=False)
class Level:
    """One mipmap level of a material: its stored values, unencoded, bottom row first.

    normals                         float64 [rows, columns, 3]: means, not longer than one
    scaled_tangents, scaled_binormals  float64 [rows, columns, 3]: T and B of Eq. 1
    k_s                             float64 [rows, columns]
    """

    normals: np.ndarray
    scaled_tangents: np.ndarray
    scaled_binormals: np.ndarray
    k_s: np.ndarray


# ------------------------------------------------------------------------------------------------- averages


def halved(values):
    """Means of 2x2 texels of an array [rows, columns, ...] (of 2x1 or 1x2 at an edge of one texel)."""
    if values.shape[0] > 1:
        values = (values[0::2] + values[1::2]) * 0.5
    if values.shape[1] > 1:
        values = (values[:, 0::2] + values[:, 1::2]) * 0.5
    return values


def _sizes(shape):
    """Shapes of the levels after level 0."""
    rows, columns = shape
    if rows & (rows - 1) or columns & (columns - 1):
        raise ValueError(f"The material is {columns}x{rows} texels; mip-maps need powers of two.")
    while rows > 1 or columns > 1:
        rows, columns = max(rows // 2, 1), max(columns // 2, 1)
        yield rows, columns


def vectors(material):
    """The levels of a plain mip-map generator: boxes of the stored vectors and of k_s. A tuple of Level."""
    level = Level(material.normals, material.scaled_tangents, material.scaled_binormals, material.k_s)
    levels = [level]
    for _ in _sizes(material.k_s.shape):
        level = Level(*(halved(value) for value in vars(level).values()))
        levels.append(level)
    return tuple(levels)


# ---------------------------------------------------------------------------------------- quadratic forms

# Where the components of a symmetric 3x3 matrix stand in the six that are kept of it.
_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def features(half):
    """The factors of a quadratic form's six components at h: float64 [..., 6]."""
    return np.stack([half[..., i] * half[..., j] * (1.0 if i == j else 2.0) for i, j in _PAIRS], axis=-1)


def quadratic_form(level):
    """Q = k_s (I - T T' - B B') per texel: float64 [rows, columns, 6], components xx, yy, zz, xy, xz, yz."""
    t, b = level.scaled_tangents, level.scaled_binormals
    return np.stack(
        [level.k_s * (float(i == j) - t[..., i] * t[..., j] - b[..., i] * b[..., j]) for i, j in _PAIRS],
        axis=-1,
    )


def largest_eigenvector(form):
    """The largest eigenvalue and its unit eigenvector of symmetric matrices [..., 6]: float64 [...] and
    [..., 3].

    Six sweeps of Jacobi's rotations, always the same operations (Measured: enough for 1e-12).
    """
    a = {pair: form[..., k].copy() for k, pair in enumerate(_PAIRS)}
    axes = [np.broadcast_to(row, (*form.shape[:-1], 3)).copy() for row in np.eye(3)]

    def at(i, j):
        return (i, j) if i <= j else (j, i)

    for _ in range(6):
        for p, q in ((0, 1), (0, 2), (1, 2)):
            r = 3 - p - q
            off, apart = a[p, q], 0.5 * (a[q, q] - a[p, p])
            root = np.sqrt(apart * apart + off * off)
            below = np.abs(apart) + root
            tangent = np.where(apart < 0.0, -1.0, 1.0) * off / np.where(below > 0.0, below, 1.0)
            c = 1.0 / np.sqrt(1.0 + tangent * tangent)
            s = tangent * c
            a[p, p], a[q, q] = a[p, p] - tangent * off, a[q, q] + tangent * off
            a[p, q] = np.zeros(off.shape)
            rp, rq = a[at(r, p)], a[at(r, q)]
            a[at(r, p)], a[at(r, q)] = c * rp - s * rq, s * rp + c * rq
            axes[p], axes[q] = (
                c[..., None] * axes[p] - s[..., None] * axes[q],
                s[..., None] * axes[p] + c[..., None] * axes[q],
            )
    value, vector = a[0, 0], axes[0]
    for k in (1, 2):
        larger = a[k, k] > value
        value, vector = np.where(larger, a[k, k], value), np.where(larger[..., None], axes[k], vector)
    return value, np.where(vector[..., 2:] < 0.0, -vector, vector)


def _root(xx, yy, xy):
    """The symmetric square root of symmetric 2x2 matrices that are not negative, in the same components."""
    determinant = np.sqrt(np.maximum(xx * yy - xy * xy, 0.0))
    trace = np.sqrt(np.maximum(xx + yy + 2.0 * determinant, 1e-12))
    return (xx + determinant) / trace, (yy + determinant) / trace, xy / trace


def _frame(normals, tangents):
    """An orthonormal frame round ``normals``, its tangents as near as possible to ``tangents``."""
    t = normalize(tangents - dot(tangents, normals)[..., None] * normals)
    return t, cross(normals, t)


def _stored(vector):
    """At most as long as the storage allows."""
    length = np.sqrt(dot(vector, vector)) * SMALLEST_ALPHA
    return vector / np.maximum(length, 1.0)[..., None]


def from_form(form, like):
    """The Level whose Eq. 1 has these quadratic forms, its vectors as near as possible to the Level
    ``like``'s, from which the normals are.
    """
    k_s, n = largest_eigenvector(form)
    t, b = _frame(n, like.scaled_tangents)
    safe = np.where(k_s > 0.0, k_s, 1.0)

    def narrowing(u, v):
        """The product u' (I - Q / k_s) v, which is u' (T T' + B B') v."""
        product = sum(
            form[..., k] * (u[..., i] * v[..., j] + (u[..., j] * v[..., i] if i != j else 0.0))
            for k, (i, j) in enumerate(_PAIRS)
        )
        return dot(u, v) - product / safe

    xx, yy, xy = (x[..., None] for x in _root(narrowing(t, t), narrowing(b, b), narrowing(t, b)))
    return Level(like.normals, _stored(xx * t + xy * b), _stored(xy * t + yy * b), np.clip(k_s, 0.0, 1.0))


def mean_form(material):
    """The levels of mean quadratic forms: exact where no texel's lobe is cut off at zero. A tuple of
    Level.
    """
    plain = vectors(material)
    form, levels = quadratic_form(plain[0]), [plain[0]]
    for level in plain[1:]:
        form = halved(form)
        levels.append(from_form(form, level))
    return tuple(levels)


# ---------------------------------------------------------------------------------------------- covariance


def covariance_fit(material):
    """The levels of lobes with the volume, the direction and the covariance of the texels' lobes. A tuple of
    Level.

    Over the directions round n a lobe is a paraboloid of height k_s over an ellipse with the axes alpha_x and
    alpha_y: its volume is k_s alpha_x alpha_y (times pi/2), its variance along t alpha_x^2 / 6. Variances add
    to those of the normals, as S16's covariances do.
    """
    plain = vectors(material)
    ax, ay = (np.maximum(alpha, SMALLEST_ALPHA) for alpha in (material.alpha_x, material.alpha_y))
    t, b, n = material.tangents, material.binormals, material.normals
    # What is averaged is weighted with the volumes: volume, mean direction, and second moments.
    volume = material.k_s * ax * ay
    mean = volume[..., None] * n
    moments = volume[..., None] * np.stack(
        [
            n[..., i] * n[..., j]
            + (ax * ax * (t[..., i] * t[..., j]) + ay * ay * (b[..., i] * b[..., j])) / 6.0
            for i, j in _PAIRS
        ],
        axis=-1,
    )
    levels = [plain[0]]
    for level in plain[1:]:
        volume, mean, moments = halved(volume), halved(mean), halved(moments)
        weight = np.where(volume > 0.0, volume, 1.0)
        normal = normalize(np.where((volume > 0.0)[..., None], mean, level.normals))
        tangent, binormal = _frame(normal, level.scaled_tangents)

        def variance(u, v, weight=weight, moments=moments):
            return (
                6.0
                * sum(
                    moments[..., k] * (u[..., i] * v[..., j] + (u[..., j] * v[..., i] if i != j else 0.0))
                    for k, (i, j) in enumerate(_PAIRS)
                )
                / weight
            )

        xx, yy, xy = variance(tangent, tangent), variance(binormal, binormal), variance(tangent, binormal)
        determinant = np.maximum(xx * yy - xy * xy, SMALLEST_ALPHA**4)
        # The inverse of the matrix of squared alphas, whose root are the scaled vectors.
        xx, yy, xy = (x[..., None] for x in _root(yy / determinant, xx / determinant, -xy / determinant))
        levels.append(
            Level(
                level.normals,
                _stored(xx * tangent + xy * binormal),
                _stored(xy * tangent + yy * binormal),
                np.clip(volume / np.sqrt(determinant), 0.0, 1.0),
            )
        )
    return tuple(levels)


# -------------------------------------------------------------------------------------------- least squares

# Halfway vectors at which lobes are compared: a square lattice on the disc that the hemisphere is seen as.
# Assumed: 16 x 16; measured in the tests against lattices four times as fine.
LATTICE = 16
_RADIUS = 0.98
# Gauss-Newton steps, and the damping relative to the matrix's trace; more of the one and less of the other
# changes the error of the fit by less than a hundredth of it (measured in the tests).
STEPS = 4
_DAMPING = 1e-4


@lru_cache(maxsize=2)
def half_vectors(edge=LATTICE):
    """Unit vectors of the hemisphere whose (x, y) lie on a lattice of ``edge`` x ``edge``: float64 [n, 3]."""
    at = ((np.arange(edge) + 0.5) / edge * 2.0 - 1.0) * _RADIUS
    x, y = np.meshgrid(at, at)
    z2 = 1.0 - (x * x + y * y)
    inside = z2 > 1.0 - _RADIUS * _RADIUS
    return np.stack([x[inside], y[inside], np.sqrt(z2[inside])], axis=-1)


def total(values):
    """Sums over the last axis by halves, in the same order everywhere."""
    while values.shape[-1] > 1:
        if values.shape[-1] % 2:
            values = np.concatenate([values, np.zeros((*values.shape[:-1], 1))], axis=-1)
        values = values[..., 0::2] + values[..., 1::2]
    return values[..., 0]


def lobes(form, half):
    """(h' Q h)+ of every texel for every h: float64 [rows, columns, n] of [rows, columns, 6] and [n, 3]."""
    phi = features(half)
    return np.maximum(0.0, sum(form[..., k, None] * phi[:, k] for k in range(6)))


def _solve(matrix, right):
    """Solutions of symmetric positive definite systems, ``matrix[i][j]`` and ``right[i]`` arrays, by
    Cholesky.
    """
    count = len(right)
    lower = [[None] * count for _ in range(count)]
    for i in range(count):
        for j in range(i + 1):
            rest = matrix[i][j] - sum(lower[i][k] * lower[j][k] for k in range(j))
            lower[i][j] = np.sqrt(np.maximum(rest, 1e-12)) if i == j else rest / lower[j][j]
    x = list(right)
    for i in range(count):
        x[i] = (x[i] - sum(lower[i][k] * x[k] for k in range(i))) / lower[i][i]
    for i in reversed(range(count)):
        x[i] = (x[i] - sum(lower[k][i] * x[k] for k in range(i + 1, count))) / lower[i][i]
    return x


def fitted_form(form, target, half, steps=STEPS):
    """Quadratic forms whose lobes are nearest to ``target``, [rows, columns, n], by least squares from a
    first guess [rows, columns, 6].

    Gauss-Newton: where the lobe of the step before is positive it is linear in Q; elsewhere it stays zero. A
    step that makes a texel's error larger is not taken for that texel, and its next one is damped more.
    """
    phi = features(half)
    products = {(i, j): phi[:, i] * phi[:, j] for i in range(6) for j in range(i + 1)}
    damping = np.full(form.shape[:-1], _DAMPING)

    def error(form):
        difference = lobes(form, half) - target
        return total(difference * difference)

    best = error(form)
    for _ in range(steps):
        current = lobes(form, half)
        active = np.where(current > 0.0, 1.0, 0.0)
        residual = active * (target - current)
        lower = {key: total(active * product) for key, product in products.items()}
        trace = sum(lower[i, i] for i in range(6))
        matrix = [[lower[max(i, j), min(i, j)] for j in range(6)] for i in range(6)]
        for i in range(6):
            matrix[i][i] = matrix[i][i] + damping * trace + 1e-9
        step = _solve(matrix, [total(residual * phi[:, i]) for i in range(6)])
        tried = form + np.stack(step, axis=-1)
        reached = error(tried)
        better = reached < best
        form, best = np.where(better[..., None], tried, form), np.where(better, reached, best)
        damping = np.where(better, damping * 0.25, damping * 16.0)
    return form


def mean_lobes(material, half):
    """The mean lobe of the texels under each texel of each level: a tuple of float64 [rows, columns, n]."""
    out = [lobes(quadratic_form(vectors(material)[0]), half)]
    for _ in _sizes(material.k_s.shape):
        out.append(halved(out[-1]))
    return tuple(out)


def lobe_fit(material, steps=STEPS):
    """The levels of Eq. 1 fitted to the mean lobes, beginning with ``covariance_fit``'s. A tuple of Level."""
    half = half_vectors()
    levels = list(covariance_fit(material))
    for k, target in enumerate(mean_lobes(material, half)):
        if k:
            form = fitted_form(quadratic_form(levels[k]), target, half, steps)
            levels[k] = from_form(form, levels[k])
    return tuple(levels)


# --------------------------------------------------------------------------------------------------- textures


def texture_of_levels(images):
    """One texture of the levels' images, level 0 first."""
    levels = [texture_2d(image) for image in images]
    first = levels[0]
    ideal = None if first.ideal is None else tuple(level.ideal[0] for level in levels)
    return Texture(
        first.target, first.internal_format, tuple(level.levels[0] for level in levels), ideal, first.bits
    )


def load(levels, name, profile, exponent=2.0):
    """Commands that load material textures with all ``levels``, and their names: ``material_textures.load``
    for more than one. ``exponent``: N, the same at every level, as it is not fitted.
    """
    if not 1.0 <= exponent <= LARGEST_EXPONENT:
        raise ValueError(f"The exponent is {exponent!r}; give a number from 1 to {LARGEST_EXPONENT:g}.")
    names = MaterialNames(f"{name} n", f"{name} t/ax", f"{name} b/ay")
    pictures = (
        (names.normal, "normal map", [(v.normals, v.k_s) for v in levels]),
        (
            names.tangent,
            "tangent / (4 alpha_x), k_s",
            [(STORAGE_SCALE * v.scaled_tangents, v.k_s) for v in levels],
        ),
        (
            names.binormal,
            "binormal / (4 alpha_y)",
            [(STORAGE_SCALE * v.scaled_binormals, exponent / LARGEST_EXPONENT) for v in levels],
        ),
    )
    commands = tuple(
        TexImage(
            label=f"load {what} of {name}, {len(levels)} levels",
            texture=texture,
            image=texture_of_levels([vector_and_factor_texels(rgb, alpha, profile) for rgb, alpha in images]),
        )
        for texture, what, images in pictures
    )
    return commands, names
