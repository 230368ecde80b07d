"""Shadow volumes (Z21 to Z25, H40): polygons bound the region that an object hides from the light.

The stencil buffer counts how often a ray from the eye enters and leaves it.

Z22, on the application's processor: an edge belongs to the silhouette if one of its triangles faces the light
and the other does not. Silhouette edges are extruded away from the light, to infinity (w = 0) or by a length.
The triangles that face the light close the volume in front; the same triangles, projected, close it behind.

Z23, z-pass:
    1  the scene without the light: colours and depths
    2  the volumes' front faces: increment the stencil where the depth test passes
    3  their back faces: decrement it where the depth test passes
    4  the light, where the stencil is zero
It counts what lies between the near plane and the surface, so it fails where the eye is in shadow, or where
the near plane cuts a volume (Z25).

Z24, z-fail: pass 2 increments for back faces, pass 3 decrements for front faces, both where the depth test
*fails*. It counts volumes behind the surface. So the volumes must be closed, and no far plane may cut them:
the far plane moves to infinity.

Z21 is the definition: ``ray_counter``, in software.

Source: document 003, "Shadow volumes"; the infinite projection and the caps: Everitt, Kilgard, "Practical and
Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering", 2002; EXT_stencil_wrap.
"""

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.vectors import cross, dot, unit_vector
from fixedpipe.effects.passes.arguments import checked_rgb, positive
from fixedpipe.effects.passes.draws import MULTIPLY_DESTINATION
from fixedpipe.effects.shadows.lit_scene import NO_COLOR, SceneShading, lit_pass, unlit_pass
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.enums import BlendFactor, ComparisonFunction, Face, StencilOperation
from fixedpipe.pipeline.state import (
    Blending,
    DepthTest,
    PassState,
    PolygonState,
    StencilTest,
    VertexState,
)
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("Z21", "the ray counter: volumes that a ray enters, less those it leaves", "In shadow or not"),
    Technique("Z22", "silhouettes extruded to closed volumes", "Shadow volume construction"),
    Technique("Z23", "z-pass: volumes before what is seen, counted in the stencil", "Z-pass approach"),
    Technique("Z24", "z-fail: volumes behind what is seen, counted in the stencil", "Z-fail approach"),
    Technique("Z25", "where z-pass fails: an eye in shadow, a volume cut by the near plane", "Issues"),
    Technique("H40", "shadow volumes, the analytic alternative to shadow maps", "2"),
)

NOT_SHADOWED = StencilTest(ComparisonFunction.EQUAL, reference=0)
_TESTED = DepthTest(ComparisonFunction.LESS, write=False)
# Of a rectangle at the far plane: the pixels in which something has been drawn.
_BEFORE_ALL = DepthTest(ComparisonFunction.GREATER, write=False)
_TRANSLUCENT = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)
# Relative to the sum of the absolute products in an orient3d determinant, how far float64 may be off.
# Source: Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates":
# (7 + 56 e) e with e = 2**-53; doubled, as the direction of an infinite light takes a position's place.
_UNCERTAIN = 16.0 * 2.0**-53


@dataclass(frozen=True, eq=False)
class ClosedSurface:
    """Triangles that share a vertex wherever positions are equal, so that every edge has two triangles.

    vertices   float64 [n, 3], all different
    triangles  int64 [k, 3], none with a vertex twice, in the surface's order, with its first vertices and
               winding
    edges      int64 [e, 2]: each edge once, in the direction of one of its triangles
    sides      int64 [e, 2]: the triangle that runs along the edge, and the one that runs against it
    """

    vertices: np.ndarray
    triangles: np.ndarray
    edges: np.ndarray
    sides: np.ndarray


def closed_surface(surface, name="The surface"):
    """The edges of a surface whose vertices repeat along seams and creases: a ClosedSurface.

    Triangles two of whose corners have one position (at the pole of a sphere) enclose nothing and are left
    out. Raises ValueError, with how many and the first one's place, for edges that do not have exactly two
    triangles, one along each direction: a shadow volume needs a closed surface.
    """
    vertices, number = np.unique(surface.positions + 0.0, axis=0, return_inverse=True)
    triangles = number.reshape(-1)[surface.triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    # Directed edges, a number each: an edge and its opposite must occur once.
    start, end = triangles.reshape(-1), triangles[:, [1, 2, 0]].reshape(-1)
    there, back = start * len(vertices) + end, end * len(vertices) + start
    order = np.argsort(there, kind="stable")
    keys, counts = np.unique(there, return_counts=True)
    place = np.minimum(np.searchsorted(keys, back), max(len(keys) - 1, 0))
    against = np.where(keys[place] == back, counts[place], 0) if len(keys) else np.zeros(0, np.int64)
    along = counts[np.searchsorted(keys, there)]
    _refuse(vertices, start, end, (along == 1) & (against == 0), f"{name} is not closed: it has", "open")
    wrong = (along != 1) | (against != 1)
    _refuse(vertices, start, end, wrong, f"{name} does not bound a volume: it has", "non-manifold")
    opposite = order[np.searchsorted(there[order], back)]
    chosen = np.flatnonzero(start < end)
    return ClosedSurface(
        vertices,
        triangles,
        np.stack([start[chosen], end[chosen]], axis=-1),
        np.stack([chosen // 3, opposite[chosen] // 3], axis=-1),
    )


def _refuse(vertices, start, end, wrong, what, kind):
    """Raises ValueError where there are ``wrong`` directed edges; an edge counts once."""
    if not wrong.any():
        return
    edges = np.unique(np.sort(np.stack([start[wrong], end[wrong]], axis=-1), axis=1), axis=0)
    first = " to ".join(str(tuple(vertices[v].tolist())) for v in edges[0])
    has = {
        "open": "with one triangle instead of two",
        "non-manifold": "that two triangles run along in one direction",
    }[kind]
    raise ValueError(
        f"{what} {len(edges)} {kind} edges, {has}, the first from {first}. Give a surface in which each edge "
        "has two triangles with opposite directions; vertices are joined where positions are equal."
    )


def facing(vertices, triangles, light):
    """Which triangles face the light: bool [k]. Exact: the sign of the determinant of the float64 positions.

    ``light``: (x, y, z, 1), a position, or (x, y, z, 0), the direction to a light at infinity. A triangle
    whose plane holds the light, or that has no area, does not face it.
    """
    corners = vertices[triangles]
    if len(light) != 4 or light[3] not in (0, 1) or not all(map(math.isfinite, light)) or not any(light):
        raise ValueError(f"The light is at {light}; give (x, y, z, 1), or a direction (x, y, z, 0).")
    place, w = np.array(light[:3], np.float64), light[3]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    u, v, d = b - a, c - a, (place - a if w else np.broadcast_to(place, a.shape))
    value = dot(cross(u, v), d)
    size = np.zeros(len(a))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        size += (np.abs(u[:, i] * v[:, j]) + np.abs(u[:, j] * v[:, i])) * np.abs(d[:, k])
    out = value > 0.0
    for n in np.flatnonzero(~(np.abs(value) > _UNCERTAIN * size)).tolist():
        out[n] = _exact(corners[n], light) > 0
    return out


def _exact(corners, light):
    """The determinant of ``facing`` in fractions."""
    a, b, c = ([Fraction(v) for v in corner] for corner in corners.tolist())
    place = [Fraction(float(v)) for v in light[:3]]
    u, v = [q - p for p, q in zip(a, b, strict=True)], [q - p for p, q in zip(a, c, strict=True)]
    d = [q - p for p, q in zip(a, place, strict=True)] if light[3] else place
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return sum(p * q for p, q in zip(normal, d, strict=True))


@dataclass(frozen=True, eq=False)
class ShadowVolume:
    """Z22: the closed polygons that bound what an object hides from the light.

    positions   float64 [n, 4]: the object's vertices (w = 1), then the same thrown away from the light (w = 0
                at infinity)
    sides, front_cap, back_cap  int64 [k, 3]: triangles, counter-clockwise seen from outside the volume
    silhouette  int64 [e, 2]: silhouette edges, as the triangles that face the light run along them
    """

    positions: np.ndarray
    sides: np.ndarray
    front_cap: np.ndarray
    back_cap: np.ndarray
    silhouette: np.ndarray

    def triangles(self, caps=True):
        """Int64 [k, 3]: the sides, and the caps if requested."""
        return np.concatenate([self.sides, self.front_cap, self.back_cap]) if caps else self.sides


# A light moves more often than what it lights.
_closed = lru_cache(maxsize=64)(closed_surface)


def shadow_volume(surface, light, length=None, name="The surface"):
    """The volume that a closed surface hides from a light (Z22): a ShadowVolume.

    ``light``: as ``facing`` takes it. ``length``: how far vertices are extruded, in world units; None: to
    infinity. There a point light's vertices are directions (p - l, 0), and all of an infinite light's are one
    direction. Silhouette edges form closed loops whatever the light: they bound a set of triangles of a
    closed surface. Raises ValueError for a surface that is not closed, or with the light on a vertex.
    """
    closed = surface if isinstance(surface, ClosedSurface) else _closed(surface, name)
    vertices, n = closed.vertices, len(closed.vertices)
    lit = facing(vertices, closed.triangles, light)
    along, against = lit[closed.sides].T
    silhouette = np.concatenate([closed.edges[along & ~against], closed.edges[against & ~along][:, ::-1]])
    front = closed.triangles[lit]
    a, b = silhouette.T
    if length is None and not light[3]:
        x, y, z = (-float(v) for v in light[:3])
        positions = np.concatenate([_homogeneous(vertices, 1.0), [[x, y, z, 0.0]]])
        far = np.full(len(a), n)
        return ShadowVolume(
            positions, np.stack([b, a, far], axis=-1), front, np.zeros((0, 3), np.int64), silhouette
        )
    if light[3]:
        away = vertices - np.array(light[:3], np.float64)
        if not away.any(axis=1).all():
            raise ValueError(f"The light is at a vertex of {name}, {tuple(light[:3])}; move it.")
    else:
        away = np.broadcast_to(-unit_vector(light[:3], "The light's direction"), vertices.shape)
    if length is None:
        thrown = _homogeneous(away, 0.0)
    else:
        away = away / np.sqrt(dot(away, away))[:, None]
        thrown = _homogeneous(vertices + positive(length, "The volume's length") * away, 1.0)
    sides = np.concatenate([np.stack([b, a, a + n], axis=-1), np.stack([b, a + n, b + n], axis=-1)])
    return ShadowVolume(
        np.concatenate([_homogeneous(vertices, 1.0), thrown]), sides, front, front[:, ::-1] + n, silhouette
    )


def silhouette_loops(volume):
    """The silhouette as closed polylines: int64 [k] each, vertices in order, the first again at the end."""
    following = {}
    for a, b in volume.silhouette.tolist():
        following.setdefault(a, []).append(b)
    loops = []
    for start in list(following):
        while following[start]:
            loop = [start]
            while following[loop[-1]]:
                loop.append(following[loop[-1]].pop())
            loops.append(np.array(loop))
    return loops


def _homogeneous(points, w):
    return np.concatenate([points, np.full((len(points), 1), w)], axis=1)


def shadow_volumes(scene, light, length=None):
    """The volumes of a scene's closed objects, in their order; others only receive shadows.

    Raises ValueError where no object is closed.
    """
    closed = [thing for thing in scene.objects if thing.closed]
    if not closed:
        names = ", ".join(thing.name for thing in scene.objects)
        raise ValueError(
            f"No object of the scene is closed: {names}. A shadow volume is made of a closed one; give one, "
            "or draw the light without shadows."
        )
    return tuple(
        shadow_volume(thing.surface, light, length, f"The surface of {thing.name}") for thing in closed
    )


def volume_mesh(volumes, caps=True, color=None):
    """All volumes as the vertex arrays of one Draw. ``color``: RGBA, or None: white.

    Raises ValueError where there is no volume.
    """
    if not volumes:
        raise ValueError("There is no shadow volume to draw; give one or more (shadow_volumes makes them).")
    first, triangles = 0, []
    for volume in volumes:
        triangles.append(volume.triangles(caps) + first)
        first += len(volume.positions)
    return Mesh(
        positions=np.concatenate([volume.positions for volume in volumes]),
        indices=np.concatenate(triangles).reshape(-1),
        colors=None if color is None else np.tile(np.array(color, np.float64), (first, 1)),
    )


def infinite_projection(projection):
    """A perspective projection with its far plane moved to infinity: vertices with w = 0 get depth 1 and are
    not clipped.

    Source: Everitt, Kilgard 2002: the limit of glFrustum's matrix. Raises ValueError for a projection that
    is no perspective.
    """
    scale, offset = projection[2][2], projection[2][3]
    if tuple(projection[3]) != (0.0, 0.0, -1.0, 0.0):
        raise ValueError(
            "The far plane of an orthographic camera cannot be moved to infinity; give the volumes a length, "
            "and a far plane beyond their ends."
        )
    near = offset / (scale - 1.0)
    return (*projection[:2], (0.0, 0.0, -1.0, -2.0 * near), projection[3])


def infinite_view(view):
    """The same camera without a far plane."""
    return replace(view, projection=infinite_projection(view.projection))


# How the stencil counts up and down: held at 0 and 255, or going round (EXT_stencil_wrap).
CLAMPED = StencilOperation.INCR, StencilOperation.DECR
WRAPPING = StencilOperation.INCR_WRAP, StencilOperation.DECR_WRAP


def counting_operations(profile):
    """How a machine counts best: WRAPPING where it can, else CLAMPED."""
    return WRAPPING if set(WRAPPING) <= profile.fragments.stencil_operations else CLAMPED


def _count(label, mesh, view, face, **operation):
    """Draws the volumes' faces that are not culled into the stencil buffer alone."""
    state = PassState(
        vertex=view.vertex,
        polygon=PolygonState(cull_face=face),
        stencil_test=StencilTest(ComparisonFunction.ALWAYS, **operation),
        depth_test=_TESTED,
        color_mask=NO_COLOR,
    )
    return Draw(label=label, mesh=mesh, state=state)


def z_pass_counts(volumes, view, operations=CLAMPED):
    """Passes 2 and 3 of z-pass: front faces before the visible surface, less the back faces.

    ``operations``: CLAMPED or WRAPPING. The order matters if counts are clamped: leaving a volume before
    entering it is not counted (E003.7).
    """
    up, down = operations
    mesh = volume_mesh(volumes)
    return (
        _count("count volumes entered: front faces", mesh, view, Face.BACK, depth_pass=up),
        _count("count volumes left: back faces", mesh, view, Face.FRONT, depth_pass=down),
    )


def z_fail_counts(volumes, view, operations=CLAMPED):
    """Passes 2 and 3 of z-fail: back faces behind the visible surface, less the front faces (E003.8).

    Caps and sides that end at infinity must not be clipped: ``view`` is an ``infinite_view``, or the volumes
    have a length that ends before its far plane.
    """
    up, down = operations
    mesh = volume_mesh(volumes)
    return (
        _count("count volumes left behind it: back faces", mesh, view, Face.FRONT, depth_fail=up),
        _count("count volumes entered behind it: front faces", mesh, view, Face.BACK, depth_fail=down),
    )


def show_volumes(label, volumes, view, color, alpha):
    """The volumes' sides, translucent, over the picture so far: RGB in [0, 1] and how much each side covers.

    One colour for all, so that the order of the sides does not matter.
    """
    if not 0.0 <= alpha <= 1.0:
        raise ValueError(f"A side covers {alpha!r} of what is behind it; give a part from 0 to 1.")
    state = PassState(vertex=view.vertex, depth_test=_TESTED, blending=_TRANSLUCENT)
    mesh = volume_mesh(volumes, caps=False, color=(*checked_rgb(color), alpha))
    return Draw(label=label, mesh=mesh, state=state)


def show_counts(panel, colors):
    """The stencil buffer's counts, made visible: the scene's colours times ``colors[n]`` where the count is
    n.

    ``colors``: RGB in [0, 1] of the counts 0, 1 ...; the last one's for all greater counts too.
    """
    out = []
    for n, color in enumerate(colors):
        last = n == len(colors) - 1
        test = StencilTest(ComparisonFunction.LEQUAL if last else ComparisonFunction.EQUAL, reference=n)
        surface = plane().moved(0.0, 0.0, 1.0)
        state = PassState(
            vertex=VertexState(viewport=panel.viewport),
            stencil_test=test,
            depth_test=_BEFORE_ALL,
            blending=MULTIPLY_DESTINATION,
        )
        mesh = surface.mesh(colors=np.tile(np.array((*checked_rgb(color), 1.0)), (len(surface.positions), 1)))
        out.append(
            Draw(label=f"times a colour where the count is {n}{' or more' * last}", mesh=mesh, state=state)
        )
    return tuple(out)


def _passes(counts, scene, view, lamp, shading, start=0, **settings):
    words = str(start) if start else "zero"
    return (
        *unlit_pass(scene, view, shading),
        Clear(label=f"stencil to {words}", stencil=start, scissor=view.panel.scissor),
        *counts,
        *lit_pass(
            scene,
            view,
            lamp,
            shading,
            label=f"light where the count is {words}",
            stencil_test=replace(NOT_SHADOWED, reference=start),
            **settings,
        ),
    )


def z_pass(scene, view, lamp, profile, shading=SceneShading.LIT, *, length=None, operations=None, **settings):
    """A-Z23: shadow volumes of a scene by z-pass. The panel's colours and depths have been cleared.

    ``length``: of the volumes, None: infinite. ``operations``: CLAMPED, WRAPPING or None, the machine's best.
    ``settings``: further fields of the last pass's PassState, and ``start``, the stencil's start value. With
    CLAMPED a start at 128 lets counts go below it, as WRAPPING lets them go below zero.
    """
    volumes = shadow_volumes(scene, lamp.homogeneous, length)
    counts = z_pass_counts(volumes, view, operations or counting_operations(profile))
    return _passes(counts, scene, view, lamp, shading, **settings)


def z_fail(scene, view, lamp, profile, shading=SceneShading.LIT, *, length=None, operations=None, **settings):
    """A-Z24: shadow volumes of a scene by z-fail; arguments as for ``z_pass``.

    If the volumes are infinite (``length`` None), all passes are drawn without a far plane; otherwise with
    the view's own.
    """
    volumes = shadow_volumes(scene, lamp.homogeneous, length)
    seen = view if length is not None else infinite_view(view)
    counts = z_fail_counts(volumes, seen, operations or counting_operations(profile))
    return _passes(counts, scene, seen, lamp, shading, **settings)


def _planes(a, b, c):
    """4-vectors P with P.x = det(x, a, b, c) for rows of homogeneous points [n, 4]."""
    out = np.empty((len(a), 4))
    for k in range(4):
        i, j, m = (r for r in range(4) if r != k)
        minor = (
            a[:, i] * (b[:, j] * c[:, m] - b[:, m] * c[:, j])
            - a[:, j] * (b[:, i] * c[:, m] - b[:, m] * c[:, i])
            + a[:, m] * (b[:, i] * c[:, j] - b[:, j] * c[:, i])
        )
        out[:, k] = minor if k % 2 == 0 else -minor
    return out


@kernel
def _count_crossings(planes, edges, begin, end, out):
    """Polygons entered less polygons left between ``begin`` and ``end`` [n, 4]: into ``out``, int64 [n].

    planes [k, 4]: of the triangles; edges [k, 3, 4]: through the eye and each edge of a triangle
    """
    for n in range(len(end)):
        x, y, z = end[n, 0], end[n, 1], end[n, 2]
        total = 0
        for k in range(len(planes)):
            p = planes[k]
            there = p[0] * x + p[1] * y + p[2] * z + p[3]
            here = p[0] * begin[n, 0] + p[1] * begin[n, 1] + p[2] * begin[n, 2] + p[3]
            # det(x, a, b, c) is positive in front of a triangle, where it runs counter-clockwise.
            if (here > 0.0) == (there > 0.0):
                continue
            positive, negative = 0, 0
            for i in range(3):
                e = edges[k, i]
                side = e[0] * x + e[1] * y + e[2] * z + e[3]
                positive += side > 0.0
                negative += side < 0.0
            if positive == 3 or negative == 3:
                total += 1 if here > 0.0 else -1
        out[n] = total


def ray_counter(volumes, eye, points, start=0.0):
    """Z21: how many volumes a ray from the eye to each point enters, less those that it leaves: int64 [n].

    ``eye``: three coordinates; ``points``: float64 [n, 3]. ``start``: the part of the way from the eye, from
    0 to 1, that is not counted because it lies before a near plane: a number or float64 [n]. A triangle is
    crossed, with vertices at infinity too, where the ray passes its three edges on one side.

    A point on a volume's front cap counts as outside: it is moved towards the eye by a margin for rounding.
    No volumes are entered where there are none.
    """
    if not volumes:
        return np.zeros(len(points), np.int64)
    eye = np.array([*eye, 1.0])
    end = _homogeneous(np.asarray(points, np.float64), 1.0)
    share = np.broadcast_to(np.asarray(start, np.float64), len(end))[:, None]
    begin = eye + share * (end - eye)
    corners = np.concatenate([volume.positions[volume.triangles()] for volume in volumes])
    a, b, c = (np.ascontiguousarray(corners[:, k]) for k in range(3))
    e = np.broadcast_to(eye, a.shape)
    edges = np.stack([_planes(e, p, q) for p, q in ((a, b), (b, c), (c, a))], axis=1)
    out = np.empty(len(end), np.int64)
    _count_crossings(_planes(a, b, c), edges, begin, end, out)
    return out
