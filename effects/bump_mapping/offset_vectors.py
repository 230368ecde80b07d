"""S12 to S15: bump maps of two numbers a texel, offset vectors that are added to the normal, in three frames.

S12. A map stores f_u and f_v, derivatives that were computed beforehand. A surface may repeat the map more
often without changing it: p_u and p_v are derivatives by the *map's* coordinates, and shrink.

S13. The "natural" frame of a point, of any lengths and angle:

    n = p_u x p_v,  s_u = n^ x p_v,  s_v = p_u x n^,   n' = n + f_u s_u + f_v s_v

n' is Blinn's normal of the surface displaced by f along n^. If the map is scaled, heights stay the same and
slopes grow. Between vertices, vectors are interpolated with their lengths, or directions apart from lengths.
In the first case a vector between two others turns faster near the shorter of them (``straight``, ``apart``;
artefact P28).

S14. s_u and s_v have length one, with n^. Slopes stay the same, so heights scale with the map.

S15. The frame comes from the interpolated normal alone, and a main direction m of the whole object:

    n = n_I / |n_I|,  e_1 = (m x n) / |m x n|,  e_2 = n x e_1,   n' = n + g_1 e_1 + g_2 e_2

e_1 is at right angles to m, and e_2 lies in the plane of n and m (erratum E001.4; the paper's words say the
reverse). All of it times |n_I| has the same direction, and does not need that division (E001.15).

s_u points against the direction in which u grows on the surface, and s_v against v's. In (e_1, e_2), e_1 lies
along u and e_2 along v. So bumps of slopes f_1, f_2 are offsets (-f_1, -f_2) (E001.9); with the other sign
they are dents.

The module uses float64 addition, multiplication, division and square root in one order, so its bits are the
same everywhere.

Source: Schilling 1997, sections 7.1 to 7.3; Blinn 1978; errata E001.4, E001.9, E001.15; pass sequences A-S12
to A-S15 of the catalogue.
"""

import math
from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.bump_mapping.tangent_space import affine_maps, frames, without_area
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import cross, dot, normalize, unit_vector
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("S12", "bump maps of two derivatives a texel, added to the normal as an offset vector", "7"),
    Technique("S13", "the natural frame: heights do not change when the map is scaled", "7.1"),
    Technique("S14", "the natural frame with unit vectors: slopes do not change", "7.2"),
    Technique("S15", "an orthonormal frame from the normal and a main direction", "7.3"),
)


@dataclass(frozen=True, eq=False)
class Frame:
    """A normal and the two vectors along which offsets go, float64 [..., 3] each."""

    normal: np.ndarray
    first: np.ndarray
    second: np.ndarray


# ------------------------------------------------------------------------------------------------ frames


def natural(p_u, p_v, outward=None):
    """S13: n, s_u and s_v of the derivatives p_u and p_v, [..., 3], by the map's coordinates: a Frame.

    ``outward``: [..., 3], to whose side n is to point: on a mesh where the map is mirrored p_u x p_v points
    into it. None: n is p_u x p_v. At a pole, where p_u and p_v span no plane, all three are zero.
    """
    normal = cross(p_u, p_v)
    sign = 1.0
    if outward is not None:
        sign = np.where(dot(normal, outward) < 0.0, -1.0, 1.0)[..., None]
        normal = sign * normal
    direction = normalize(normal)
    return Frame(normal, sign * cross(direction, p_v), sign * cross(p_u, direction))


def normalized(p_u, p_v, outward=None):
    """S14: the same three of length one: a Frame."""
    frame = natural(p_u, p_v, outward)
    return Frame(normalize(frame.normal), normalize(frame.first), normalize(frame.second))


def of_main_direction(normals, main, unit=True):
    """S15: n, e_1 and e_2 of interpolated normals and a main direction: a Frame.

    normals  [..., 3], of any length but zero
    main     m: one vector [3] for an object, or [..., 3]
    unit     whether all three have length one; otherwise they are as long as the normals, which saves a
             division

    Where m lies along n there is no e_1: both e are zero, and n' is n. Raises ValueError for a normal or an m
    that is zero or not finite.
    """
    normals, main = np.asarray(normals, np.float64), np.asarray(main, np.float64)
    for vectors, what in ((normals, "A normal"), (main, "The main direction")):
        if vectors.shape[-1:] != (3,) or not np.isfinite(vectors).all() or not vectors.any(axis=-1).all():
            raise ValueError(f"{what} is zero, not finite or not of three numbers; give a direction.")
    normal = normalize(normals) if unit else normals
    # The direction of m x n is that of m x n_I: the normal's length takes no part (E001.15).
    first = normalize(cross(main, normals))
    second = cross(normal, first)
    return Frame(normal, first if unit else first * np.sqrt(dot(normals, normals))[..., None], second)


def bumped(frame, offsets):
    """n' of offsets [..., 2] in a Frame, not normalized: float64 [..., 3]."""
    offsets = np.asarray(offsets, np.float64)
    return (frame.normal + offsets[..., :1] * frame.first) + offsets[..., 1:] * frame.second


def derivatives_of_mesh(surface):
    """p_u and p_v at the vertices of any mesh: the means of its triangles', weighted alike, in each vertex's
    tangent plane, two float64 [n, 3].

    Triangles whose texture coordinates have no area are left out; a vertex that has only such triangles gets
    the surface's tangent and binormal.
    """
    corners = surface.triangles
    points, coordinates = surface.positions[corners], surface.texture_coordinates[corners]
    kept = ~without_area(coordinates)
    out = []
    for vectors, instead in zip(
        frames(affine_maps(points[kept], coordinates[kept]))[:2],
        (surface.tangents, surface.binormals),
        strict=True,
    ):
        mean, count = np.zeros(surface.positions.shape), np.zeros(len(surface.positions))
        np.add.at(mean, corners[kept].ravel(), np.repeat(vectors, 3, axis=0))
        np.add.at(count, corners[kept].ravel(), 1.0)
        mean = mean / np.maximum(count, 1.0)[:, None]
        flat = mean - dot(mean, surface.normals)[:, None] * surface.normals
        out.append(np.where(dot(flat, flat)[:, None] > 0.0, flat, instead))
    return tuple(out)


# ------------------------------------------------------------------------------------------- interpolation


def straight(vectors, weights):
    """Vectors [..., k, 3] of k vertices, weighted with their lengths by [..., k]: float64 [..., 3]."""
    vectors, weights = np.asarray(vectors, np.float64), np.asarray(weights, np.float64)
    out = weights[..., 0, None] * vectors[..., 0, :]
    for k in range(1, vectors.shape[-2]):
        out = out + weights[..., k, None] * vectors[..., k, :]
    return out


def apart(vectors, weights, depths=None):
    """The same with lengths apart from directions: float64 [..., 3].

    depths  float64 [..., k]: w of each vertex, if the weights are those on the screen. Then only lengths are
            divided for the perspective. Directions need no division: sums of unit vectors over w have the
            right direction whatever their length.
    """
    vectors, weights = np.asarray(vectors, np.float64), np.asarray(weights, np.float64)
    if depths is not None:
        weights = weights / np.asarray(depths, np.float64)
    lengths = np.sqrt(dot(vectors, vectors))
    total, length = weights[..., 0], weights[..., 0] * lengths[..., 0]
    for k in range(1, vectors.shape[-2]):
        total, length = total + weights[..., k], length + weights[..., k] * lengths[..., k]
    return normalize(straight(normalize(vectors), weights)) * (length / total)[..., None]


def middle_error(first, second, angle):
    """The error in radians of the direction half way between two vectors, interpolated with their lengths.

    The vectors are ``first`` and ``second`` long and ``angle`` radians apart, less than pi.
    """
    if not (first > 0.0 and second > 0.0 and 0.0 <= angle < math.pi):
        raise ValueError(
            f"Vectors {first!r} and {second!r} long, {angle!r} apart, have no direction between them; give "
            "positive lengths, and an angle from 0 to less than pi."
        )
    return math.atan((first - second) / (first + second) * math.tan(angle / 2.0))


# ---------------------------------------------------------------------------------------------------- maps


def of_heights(heights, periodic=True):
    """S12: (f_u, f_v) of a height field over a unit square of the map, in edges of it: float64 [rows,
    columns, 2], bottom row first.
    """
    return np.stack(height_fields.slopes(heights, periodic), axis=-1)


def along_frame(derivatives):
    """(g_1, g_2) of slopes (f_1, f_2), [..., 2]: offsets in e_1 along u and e_2 along v (E001.9)."""
    return -np.asarray(derivatives, np.float64)


def largest(offsets):
    """The scale that bytes need: the largest of all numbers, or one where all are zero."""
    return float(np.abs(offsets).max()) or 1.0


def checked_scale(scale):
    """A scale as a float. Raises ValueError if it is not finite and above zero."""
    if not (math.isfinite(scale) and scale > 0.0):
        raise ValueError(f"The offset that is one is {scale!r}; give a finite number above zero.")
    return float(scale)


def signed_bytes(offsets, scale):
    """Offsets [..., 2] as two signed bytes a texel, int8. ``scale`` is stored as 127; larger offsets are
    clamped.
    """
    codes = np.floor(127.0 * (np.asarray(offsets, np.float64) / checked_scale(scale)) + 0.5)
    return np.clip(codes, -127, 127).astype(np.int8)


def of_bytes(codes, scale):
    """What ``signed_bytes`` stored: float64 [..., 2], off by scale/254 at most."""
    return np.asarray(codes, np.float64) / 127.0 * checked_scale(scale)


def main_direction(vector):
    """A main direction of length one, [3]. Raises ValueError for what is none."""
    return unit_vector(vector, "The main direction")
