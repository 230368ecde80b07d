"""A machine's shadows against rays: how many pixels agree, and why each of the others differs.

A shadow algorithm is right if its mask equals the rays', except at pixels with a known cause. The causes are:

- an object's outline, where snapped vertices move coverage;
- the edge of a shadow, which a map knows to a texel and a stencil to a pixel;
- blockers that are all nearer to the surface than a map's bias;
- light that grazes the surface.

A difference without such a cause is counted as ``other``, and is a fault.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.ray_caster import RayCaster, Visible
from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Scene

# What a pixel is, in the order in which a differing one is asked.
NOT_COMPARED, AGREES, SILHOUETTE, SHADOW_EDGE, CONTACT, GRAZING, OTHER = range(7)
# Of the pixels' spacing: nearer surfaces of one object are one surface. Assumed: more than any tessellation
# bends within a pixel, below every gap that is seen.
_ONE_SURFACE = 4.0
_NEIGHBOURS = tuple((y, x) for y in (-1, 0, 1) for x in (-1, 0, 1) if (y, x) != (0, 0))


@dataclass(frozen=True, eq=False)
class Truth:
    """What rays say of a scene in a view under a lamp. ``lit``: bool [h, w], bottom row first."""

    caster: RayCaster
    view: View
    lamp: Lamp
    shown: Visible
    lit: NDArray[np.bool_]


def truth_of(scene: Scene, view: View, lamp: Lamp, self_shadows: bool = True) -> Truth:
    """The ``Truth`` of a ``Scene``; ``self_shadows`` as for ``ray_caster.lit``."""
    caster = ray_caster.scene_caster(scene)
    shown = ray_caster.visible(caster, view)
    return Truth(caster, view, lamp, shown, ray_caster.lit(caster, shown, lamp, self_shadows=self_shadows))


def lit_mask(picture: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where a picture [h, w, 3] of ``SceneShading.MASK`` is lit, in its order of rows: its red is above one
    half.
    """
    return picture[..., 0] > 0.5


@dataclass(frozen=True, eq=False)
class Agreement:
    """How a mask compares with the truth.

    compared     how many pixels were compared
    agreeing     the fraction of them that agree
    silhouette   differing pixels beside another object, or beside another part of the same one
    shadow_edge  differing pixels where the truth changes within the allowed pixels or texels
    contact      differing pixels that are lit, and would be lit without blockers nearer than the bias
    grazing      differing pixels that the light nearly grazes
    other        differing pixels of none of these kinds
    kinds        uint8 [h, w], bottom row first: NOT_COMPARED, AGREES, SILHOUETTE ... OTHER
    """

    compared: int
    agreeing: float
    silhouette: int
    shadow_edge: int
    contact: int
    grazing: int
    other: int
    kinds: NDArray[np.uint8]

    def __str__(self) -> str:
        return (
            f"{100.0 * self.agreeing:.2f} % of {self.compared} pixels agree; differing: "
            f"{self.silhouette} silhouette, {self.shadow_edge} shadow edge, {self.contact} contact, "
            f"{self.grazing} grazing, {self.other} other"
        )


def compare(
    mask: NDArray[np.bool_],
    truth: Truth,
    *,
    edge_pixels: int = 1,
    map_edge: int | None = None,
    edge_texels: float = 1.5,
    contact: float = 0.0,
    grazing: float = 0.05,
    where: NDArray[np.bool_] | None = None,
) -> Agreement:
    """``Agreement`` of a machine's mask (bool [h, w], bottom row first) with a ``Truth``.

    edge_pixels  largest distance in pixels by which a shadow's edge may be off
    map_edge     edge of the shadow map in texels, or None: there is no map
    edge_texels  the same in texels of the map, as they fall on the surface
    contact      world units along the light: a shadow that only so near a thing throws may be missing
    grazing      cosine between surface and light below which any answer is understood
    where        bool [h, w]: compare these pixels only; None: all where something is seen

    Raises ValueError where the mask has another shape than the truth, and for widths that are none.
    """
    mask = np.asarray(mask, np.bool_)
    if mask.shape != truth.lit.shape:
        raise ValueError(f"The mask is {mask.shape}, the truth {truth.lit.shape}; render both alike.")
    widths = {"edge_pixels": edge_pixels, "edge_texels": edge_texels, "contact": contact, "grazing": grazing}
    for name, width in widths.items():
        if not 0 <= width < np.inf:
            raise ValueError(f"{name} is {width!r}; give zero or more.")
    if map_edge is not None and not map_edge >= 1:
        raise ValueError(f"map_edge is {map_edge!r}; give the map's texels, or None where there is none.")
    compared = truth.shown.something if where is None else truth.shown.something & where
    kinds = np.where(compared, np.where(mask == truth.lit, AGREES, OTHER), NOT_COMPARED).astype(np.uint8)
    facing = cosines(truth)
    texels = edge_texels / map_edge if map_edge else 0.0
    tests = (
        (SILHOUETTE, lambda at: silhouettes(truth)[at]),
        (SHADOW_EDGE, lambda at: _changes_within_pixels(truth, edge_pixels)[at]),
        (
            SHADOW_EDGE,
            lambda at: map_edge is not None and _changes_within_texels(truth, at, texels, mask[at], contact),
        ),
        (CONTACT, lambda at: mask[at] & _free_beyond(truth, truth.shown.points[at], contact)),
        (GRAZING, lambda at: np.abs(facing[at]) < grazing),
    )
    for kind, test in tests:
        left = np.nonzero(kinds == OTHER)
        if len(left[0]):
            kinds[left] = np.where(test(left), kind, OTHER)
    counts = np.bincount(kinds.ravel(), minlength=OTHER + 1)
    total = int(compared.sum())
    return Agreement(
        compared=total,
        agreeing=float(counts[AGREES] / total) if total else 1.0,
        silhouette=int(counts[SILHOUETTE]),
        shadow_edge=int(counts[SHADOW_EDGE]),
        contact=int(counts[CONTACT]),
        grazing=int(counts[GRAZING]),
        other=int(counts[OTHER]),
        kinds=kinds,
    )


def cosines(truth: Truth) -> NDArray[np.float64]:
    """Cosine between the normal on the side that is seen and the light: float64 [h, w]."""
    points = truth.shown.points
    directions, _ = ray_caster.to_light(points.reshape(-1, 3), truth.lamp)
    return dot(truth.shown.normals, normalize(directions).reshape(points.shape))


def _shifted(array, dy, dx, fill):
    """``array[y + dy, x + dx]``, ``fill`` beyond its edges."""
    out = np.full_like(array, fill)
    h, w = array.shape[:2]
    to_y, to_x = (slice(max(0, -d), n - max(0, d)) for d, n in ((dy, h), (dx, w)))
    from_y, from_x = (slice(max(0, d), n - max(0, -d)) for d, n in ((dy, h), (dx, w)))
    out[to_y, to_x] = array[from_y, from_x]
    return out


def silhouettes(truth: Truth) -> NDArray[np.bool_]:
    """Pixels one of whose eight neighbours shows another object, or a part of the same object that does not
    continue its surface: bool [h, w]. The picture's edge is none.
    """
    shown, view = truth.shown, truth.view
    row = np.array(view.projection)[3] @ np.array(view.modelview)
    spacing = 2.0 * (shown.points @ row[:3] + row[3]) / (view.projection[1][1] * view.panel.height)
    out = np.zeros(shown.triangle.shape, np.bool_)
    for dy, dx in _NEIGHBOURS:
        inside = _shifted(np.ones_like(out), dy, dx, False)
        points, normals = (_shifted(a, dy, dx, 0.0) for a in (shown.points, shown.normals))
        between = points - shown.points
        apart = np.minimum(np.abs(dot(between, shown.normals)), np.abs(dot(between, normals)))
        other = _shifted(shown.object, dy, dx, -1) != shown.object
        out |= inside & (other | (shown.something & (apart > _ONE_SURFACE * spacing)))
    return out


def _changes_within_pixels(truth, pixels):
    """Pixels that have both answers within so many pixels of them: bool [h, w]."""
    lit, something = truth.lit, truth.shown.something
    out = np.zeros_like(lit)
    for dy in range(-pixels, pixels + 1):
        for dx in range(-pixels, pixels + 1):
            seen = _shifted(something, dy, dx, False)
            out |= something & seen & (_shifted(lit, dy, dx, False) != lit)
    return out


# Where a map's neighbouring texels are tried: sixteen directions, at the whole and at half the distance.
_RING = np.array([(r * np.cos(a), r * np.sin(a)) for r in (1.0, 0.5) for a in np.arange(16) * (np.pi / 8.0)])


def _changes_within_texels(truth, at, distance, mask, contact):
    """Whether the light's rays beside a point's own explain the mask's answer: bool [n].

    They do if one of them, at ``distance`` (in widths of the map), meets the plane of the point's triangle
    where the answer is the mask's.

    at       indices of the pixels that differ
    mask     [n], the mask's answers there
    contact  as for ``compare``
    """
    shown, matrix = truth.shown, np.array(truth.lamp.texture_matrix)
    points, normals, triangles = shown.points[at], shown.normals[at], shown.triangle[at]
    any_axis = np.where(np.abs(normals[:, :1]) < 0.7, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    tangents = normalize(cross(normals, any_axis))
    binormals = cross(normals, tangents)
    s, t, _, q = (points @ row[:3] + row[3] for row in matrix)
    out = np.zeros(len(points), np.bool_)
    for ds, dt in distance * _RING:
        # The point moved in its plane by a, b has the map coordinates s / q + ds and t / q + dt.
        rows = [matrix[k] - (c / q + d)[:, None] * matrix[3] for k, c, d in ((0, s, ds), (1, t, dt))]
        (m00, m01, c0), (m10, m11, c1) = (
            (dot(r[:, :3], tangents), dot(r[:, :3], binormals), dot(r[:, :3], points) + r[:, 3]) for r in rows
        )
        determinant = m00 * m11 - m01 * m10
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (m01 * c1 - m11 * c0) / determinant, (m10 * c0 - m00 * c1) / determinant
        moved = points + a[:, None] * tangents + b[:, None] * binormals
        there = np.isfinite(moved).all(axis=1)
        out[~there] = True  # the plane holds the light's ray: a texel is as long as the plane
        answers = ray_caster.lit_points(
            truth.caster, moved[there], normals[there], truth.lamp, triangles=triangles[there]
        )
        answers |= mask[there] & _free_beyond(truth, moved[there], contact)
        out[there] |= answers == mask[there]
    return out


def _free_beyond(truth, points, distance):
    """Whether nothing is between points [n, 3] and the light but what is within ``distance``, their own
    surface included: bool [n]. Nothing is within zero.
    """
    if distance <= 0.0:
        return np.zeros(len(points), np.bool_)
    moved = points + distance * normalize(ray_caster.to_light(points, truth.lamp)[0])
    directions, longest = ray_caster.to_light(moved, truth.lamp)
    return ~truth.caster.occluded(moved, directions, longest=longest)


# Of each Answer its Agreements, one for each panel.
Found: TypeAlias = Mapping[Answer, Sequence[Agreement]]


def _checks(found: Found, least: float, most: int, agreeing: str, explained: str) -> Iterator[Check]:
    for on, panels in found.items():
        yield Check(
            "least agreement with rays",
            min(p.agreeing for p in panels),
            at_least=least,
            on=on,
            reason=agreeing,
        )
        yield Check(
            "pixels that nothing explains",
            sum(p.other for p in panels),
            at_most=most,
            on=on,
            reason=explained,
        )


def volume_checks(found: Found, least: float = 0.999) -> Iterator[Check]:
    """Checks of masks of shadow volumes. ``found``: the Agreements of each Answer, one a panel;
    ``least``: the fraction of pixels that agree.
    """
    return _checks(
        found,
        least,
        0,
        "shadow volumes are exact; pixels on outlines and edges are left, where vertices are snapped",
        "shadow volumes have no texels and no bias",
    )


def map_checks(found: Found, least: float = 0.98, most: int = 3) -> Iterator[Check]:
    """``Check`` objects for shadow maps: at most ``most`` pixels in all panels may be unexplained."""
    return _checks(
        found,
        least,
        most,
        "shadow edges are a texel's width off (catalogue: 98 % for 256 texels, 99.5 % for 1024)",
        "a slope of a whole triangle is no bias at the corner of the next; measured at the first correct "
        "picture",
    )
