"""Cameras of a distant light, fitted to the viewer's frustum: uniform ones, and light-space perspective.

Source: document 003, "first pass" (Z30) and "sampling problems" (Z15); Wimmer, Scherzer, Purgathofer 2004 for
the parameter n. Passes A-Z14/Z15/Z16: only the matrices differ from those of other shadow maps.

**The light's axes.** Z points to the light. Y is the part of the viewing direction that is perpendicular to
Z, so the viewer looks up the map. X = Y x Z. A ray of light is a line of constant X and Y, and depth
decreases along Z.

**Light-space perspective.** A second perspective looks along Y. Its centre lies a distance n before the
body's nearest point along Y. It takes (X, Y, Z) to (X / w, -1 / w, -Z / w), w = Y - Y_centre. Lines of
constant X and Y remain lines of constant (X / w, -1 / w). So rays of light stay parallel, and depth keeps its
order along them. Near the viewer w is small, and the scene takes more of the map. A texel's length along Y is
w^2 (f - n) / (n f) over half the map's edge, where f = n + d, and d is the body's length along Y.

**n.** Consider a line perpendicular to the light that starts at the near distance z_n. The viewer's depth
along it is z = z_n + (w - n) sin(gamma), gamma between light and view, and a texel of length w^2 has the
visible size w^2 / z. That is largest at the ends. It is the same at both ends if n / sqrt(z_n) = f /
sqrt(z_f), which with d = (z_f - z_n) / sin(gamma) is

    n = (z_n + sqrt(z_n z_f)) / sin(gamma).

If light and view are parallel, n is infinite, and the camera is uniform.
"""

import math
from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry.convex_bodies import clip_distances, frustum, meeting
from fixedpipe.effects.geometry.matrices import orthographic, product
from fixedpipe.effects.geometry.vectors import cross, dot, in_frame, unit_vector
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.scenes.objects_and_lamps import HALVES
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.state import Matrix

TECHNIQUES = (
    Technique("Z15", "light-space perspective: more texels for what is near", "Sampling problems"),
    Technique("Z30", "the light's frustum fitted to the scene", "First pass"),
)

# Below this sine of the angle between light and view the second perspective is left out.
# Inferred: n is then more than 50 times (z_n + sqrt(z_n z_f)), which is at least as long as what is seen at
# the usual ratios of far to near; the map's scale varies by a few percent, which nobody could see.
LEAST_SINE = 0.02


@dataclass(frozen=True)
class LightCamera:
    """A shadow map's camera, and the light it belongs to, as ``Lamp`` is.

    ``modelview`` and ``projection``: as in VertexState. ``direction``: to the light, world coordinates.
    ``n``: the distance of the second perspective's centre from the nearest point; None: no second
    perspective.
    """

    modelview: Matrix
    projection: Matrix
    direction: tuple[float, float, float]
    n: float | None = None
    infinite = True
    target = (0.0, 0.0, 0.0)

    @property
    def position(self):
        """Where the light is seen from the origin: its direction."""
        return self.direction

    @property
    def homogeneous(self):
        """The light's position (x, y, z, 0)."""
        return (*self.direction, 0.0)

    @property
    def texture_matrix(self):
        """B P V: world coordinates to (s, t, r, q) of the map, rows of a 4x4 matrix."""
        return product(HALVES, self.projection, self.modelview)

    def view(self, panel):
        """The scene as the map sees it, on a panel."""
        return View(panel, self.modelview, self.projection, self.direction, True)


def view_direction(view):
    """The unit vector along which a camera looks, float64 [3]."""
    return -np.array(view.modelview[2][:3])


def sine_between(direction, view):
    """Sine of the angle between the direction to the light and the viewing direction, 0 to 1."""
    across = cross(unit_vector(direction, "The direction to the light"), view_direction(view))
    return math.sqrt(float(dot(across, across)))


def light_axes(direction, view):
    """X, Y and Z of the light's space, float64 [3, 3]: Z to the light, Y as near to the view as can be.

    Where light and view are parallel Y is whichever coordinate axis is farthest from the light.
    """
    z = unit_vector(direction, "The direction to the light")
    along = view_direction(view)
    if sine_between(direction, view) < LEAST_SINE:
        along = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = unit_vector(cross(along, z), "Viewing direction x light")
    return np.stack([x, cross(z, x), z])


def seen_body(scene, view, near=None, far=None):
    """The corners of the part of a scene's box that a camera sees between two distances, float64 [n, 3]; n is
    0 if it sees nothing of the box.
    """
    return meeting(frustum(view, near, far), scene.corners())


def longest_shadow(scene, direction):
    """How far apart two points of the scene's box may be along a ray of light."""
    least, most = scene.bounds()
    z = np.abs(unit_vector(direction, "The direction to the light"))
    return min(float(e / c) for e, c in zip(most - least, z, strict=True) if c > 0.0)


def _checked_body(body):
    body = np.asarray(body, np.float64)
    if body.ndim != 2 or body.shape[1] != 3 or len(body) < 4 or not np.isfinite(body).all():
        raise ValueError(
            f"The body that the map is to cover has shape {body.shape}; give at least four points of three "
            "finite numbers. Where the camera sees nothing, no map is needed."
        )
    return body


def _checked_extent(least, most):
    if not least < most:
        raise ValueError(
            "The body that the map is to cover has no extent across the light; give one with a volume."
        )
    return least, most


def _checked_border(border):
    if not 0.0 <= border < 0.5:
        raise ValueError(f"The map's border is {border} of its edge; give one from 0 up to below 1/2.")
    return 1.0 - 2.0 * border


def _rigid(axes):
    return (*((*map(float, axis), 0.0) for axis in axes), (0.0, 0.0, 0.0, 1.0))


def uniform_camera(body, scene, direction, view, border=0.0):
    """The orthographic camera that covers ``body`` and everything of the scene between it and the light
    (Z30).

    Parameters
    ----------
    body
        float64 [n, 3], the corners of a convex body: ``scene.corners()``, or ``seen_body``.
    direction
        to the light, world coordinates, of any length.
    view
        the viewer's camera, which turns the map.
    border
        how much of the map's edge stays free on each side, for filters: one texel of 512 is 1 / 512.
    """
    body, scale = _checked_body(body), _checked_border(border)
    axes = light_axes(direction, view)
    x, y, z = in_frame(body, *axes).T
    top = float(z.max()) + longest_shadow(scene, direction)
    bounds = []
    for values in (x, y):
        least, most = _checked_extent(float(values.min()), float(values.max()))
        middle, half = 0.5 * (least + most), 0.5 * (most - least) / scale
        bounds += [middle - half, middle + half]
    projection = orthographic(*bounds, -top, -float(z.min()))
    return LightCamera(_rigid(axes), projection, tuple(float(v) for v in axes[2]))


def best_n(body, view, sine):
    """The distance n at which a texel has the same visible size at the nearest and the farthest point of the
    body.

    ``sine``: of the angle between light and view, above 0.
    """
    depth = -(in_frame(body, *np.array(view.modelview)[:3, :3])[:, 2] + view.modelview[2][3])
    nearest, farthest = max(float(depth.min()), clip_distances(view)[0]), float(depth.max())
    return (nearest + math.sqrt(nearest * farthest)) / sine


def perspective_camera(body, scene, direction, view, border=0.0, n=None):
    """The light-space perspective camera that covers what ``uniform_camera`` would; its parameters are
    these.

    ``n``: in world units; None: ``best_n``. Where light and view are parallel (``LEAST_SINE``) it is
    ``uniform_camera``.
    """
    sine = sine_between(direction, view)
    if sine < LEAST_SINE:
        return uniform_camera(body, scene, direction, view, border)
    body, scale = _checked_body(body), _checked_border(border)
    n = best_n(body, view, sine) if n is None else float(n)
    if not 0.0 < n < math.inf:
        raise ValueError(f"The second perspective's n is {n}; give a positive number.")
    axes = light_axes(direction, view)
    # What is between the body and the light has the body's X and Y.
    above = body + longest_shadow(scene, direction) * axes[2]
    x, y, z = in_frame(np.concatenate([body, above]), *axes).T
    eye = -sum(view.modelview[i][3] * np.array(view.modelview[i][:3]) for i in range(3))
    center = float(dot(eye, axes[0])), float(y.min()) - n, 0.5 * float(z.min() + z.max())
    w = y - center[1]
    _, far = _checked_extent(n, float(w.max()))
    row_w = np.array([0.0, 1.0, 0.0, -center[1]])
    rows = []
    for axis, values, sign in ((0, x, scale), (2, z, -1.0)):
        ratios = (values - center[axis]) / w
        least, most = _checked_extent(float(ratios.min()), float(ratios.max()))
        row = np.zeros(4)
        row[axis], row[3] = 1.0, -center[axis]
        rows.append(sign * (2.0 * row - (least + most) * row_w) / (most - least))
    a, b = (far + n) / (far - n), -2.0 * n * far / (far - n)
    row_y = scale * (a * row_w + np.array([0.0, 0.0, 0.0, b]))
    projection = tuple(tuple(float(v) for v in row) for row in (rows[0], row_y, rows[1], row_w))
    return LightCamera(_rigid(axes), projection, tuple(float(v) for v in axes[2]), n)


def whole_scene_camera(scene, direction, view, border=0.0):
    """The uniform camera that covers the whole scene: the basic shadow map (Z30)."""
    return uniform_camera(scene.corners(), scene, direction, view, border)


def texel_footprints(texture_matrix, edge, view, points, normals):
    """How large a map's texel is on the screen: the side, in pixels, of a square of its area; float64 [n].

    Parameters
    ----------
    texture_matrix, edge
        of the map: world coordinates to (s, t, r, q), and its edge in texels.
    view
        the viewer's camera.
    points, normals
        float64 [n, 3]: places of surfaces in front of both, and their normals of any length.

    Where the light grazes a surface, a texel is infinitely long; it counts as the largest float64.
    """
    screen = product(view.projection, view.modelview)
    texels = _areas(texture_matrix, float(edge), float(edge), points, normals)
    pixels = _areas(screen, 0.5 * view.panel.width, 0.5 * view.panel.height, points, normals)
    with np.errstate(divide="ignore"):
        return np.nan_to_num(np.sqrt(pixels / texels))


def _areas(matrix, across, up, points, normals):
    """How much area of a picture ``across`` by ``up`` units a unit of area of surfaces takes, times the
    normals' lengths: float64 [n].
    """
    rows = np.array(matrix)
    x, y, _, w = (points @ row[:3] + row[3] for row in rows)
    # The gradients of x / w and y / w; their cross product's part along the normal is the area.
    along, upward = (
        (row[:3] - (value / w)[:, None] * rows[3, :3]) / w[:, None]
        for row, value in ((rows[0], x), (rows[1], y))
    )
    return across * up * np.abs(dot(cross(along, upward), normals))
