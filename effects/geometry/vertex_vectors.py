"""Per-vertex work that the papers do in software.

It has vectors in the vertices' local frames, reflected and refracted vectors, and dot products as texture
coordinates.

The results go into a mesh as vertex colours or texture coordinates; the machine iterates them. The arithmetic
is that of ``fixedpipe.effects.geometry.vectors``, so the bits are the same everywhere.

Source: Heidrich 2001, sections 1.1 (coordinates computed in software, Eq. 2 and 3), 1.3 and 1.6; Kautz,
Seidel 2000, sections 4.1 and 5.1; Kilgard 2000 (H05, H13, H30, K10, K11 of the catalogue).
"""

import math

import numpy as np

from fixedpipe.effects.geometry.vectors import dot, normalize


def light_vectors(surface, light):
    """Unit light vectors at the vertices, in the local frames: float64 [n, 3]."""
    return surface.to_local(light.light_vectors(surface.positions))


def view_vectors(surface, view):
    """Unit vectors from the vertices to the eye, in the local frames: float64 [n, 3]."""
    return surface.to_local(view.view_vectors(surface.positions))


def half_vectors(surface, view, light):
    """Unit halfway vectors at the vertices, in the local frames: float64 [n, 3]."""
    between = light.light_vectors(surface.positions) + view.view_vectors(surface.positions)
    return surface.to_local(normalize(between))


def reflected(vectors, normals):
    """Vectors mirrored in their normals, ``2 (n.v) n - v``.

    vectors   [..., 3], away from the surface: towards the eye or the light; any length
    normals   [..., 3], of length one

    A reflection towards the eye's mirror image points away from the surface too. Returns float64 [..., 3], as
    long as ``vectors``.
    """
    vectors, normals = np.asarray(vectors, np.float64), np.asarray(normals, np.float64)
    return (2.0 * dot(normals, vectors))[..., None] * normals - vectors


def refracted(vectors, normals, ratio):
    """Where a ray goes on that meets a surface between two media: (directions, totally).

    vectors   [..., 3] of length one, against the ray: from the surface towards the eye
    normals   [..., 3] of length one, out of the surface
    ratio     refractive index outside by the index inside, positive: 1 / 1.5 for glass in air

    Source: Snell's law, ``t = -r v + (r c - sqrt(1 - r^2 (1 - c^2))) n`` with c = n.v (A-H30 of the
    catalogue). A vector on the other side of the surface, c < 0, is a ray that leaves it: the normal turns
    round and the ratio is inverted. Where the root has no value everything is reflected.

    ``directions``: float64 [..., 3] of length one; where ``totally``, bool [...], is set they are the
    reflected vectors. Raises ValueError for a ratio that is not positive and finite.
    """
    if not (math.isfinite(ratio) and ratio > 0):
        raise ValueError(f"The ratio of refractive indices is {ratio}; give a positive number, 1 for none.")
    vectors, normals = np.broadcast_arrays(np.asarray(vectors, np.float64), np.asarray(normals, np.float64))
    cosine = dot(normals, vectors)
    leaves = cosine < 0.0
    facing = np.where(leaves[..., None], -normals, normals)
    cosine = np.abs(cosine)
    ratios = np.where(leaves, 1.0 / ratio, float(ratio))
    under = 1.0 - ratios * ratios * (1.0 - cosine * cosine)
    totally = under < 0.0
    along = ratios * cosine - np.sqrt(np.where(totally, 0.0, under))
    through = along[..., None] * facing - ratios[..., None] * vectors
    return np.where(totally[..., None], reflected(vectors, facing), through), totally


def reflection_vectors(surface, view):
    """The eye's reflection at the vertices, in world coordinates: float64 [n, 3], coordinates of a cube map.

    In eye coordinates TexGenMode.REFLECTION_MAP generates the same.
    """
    return reflected(view.view_vectors(surface.positions), surface.normals)


def refraction_vectors(surface, view, ratio):
    """The refracted rays from the eye at the vertices, in world coordinates: (directions, totally), float64
    [n, 3] and bool [n], coordinates of a cube map; see ``refracted``.
    """
    return refracted(view.view_vectors(surface.positions), surface.normals, ratio)


def dot_products(*pairs, biased=False):
    """Texture coordinates [n, k] that are dot products: s of the first pair of vectors [n, 3], t of the next.

    One vector [3] goes with all of an array's. ``biased``: (1 + a.b) / 2, for products that have a sign and
    tables that cover [-1, 1] (E000.3 of the catalogue). Otherwise a negative product reads the first texel of
    a texture that clamps to its edge.
    """
    if not 1 <= len(pairs) <= 4:
        raise ValueError(f"{len(pairs)} pairs of vectors make no texture coordinates; give 1 to 4 of them.")
    products = np.stack(np.broadcast_arrays(*(dot(a, b) for a, b in pairs)), axis=-1)
    return (1.0 + products) * 0.5 if biased else products
