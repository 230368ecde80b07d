"""Parts of the figures of environment maps: a ball in a ring, directions as colours, and
reflections by rays.
"""

import numpy as np

from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.environment_maps import environments
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.geometry.views import perspective_view

FIELD_OF_VIEW = 42.0


def directions(toward):
    """An environment whose colours are the directions themselves, (d + 1)/2 of length one."""
    return 0.5 * normalize(toward) + 0.5


ENVIRONMENTS = {"room": environments.room, "directions": directions}
ENVIRONMENT = word.of(
    word.Choice({name: name for name in ENVIRONMENTS}),
    "room",
    "What is reflected: a room, or colours that are the directions.",
)


def detail(size):
    """Segments of a round thing on a panel of ``size`` pixels: few for the plain-Python specification."""
    return 16 if size < 64 else 48 if size < 200 else 96


def texels(size, most=512):
    """The edge of an environment map for a panel of ``size`` pixels: a power of two, from 16 on."""
    return min(max(1 << (size - 1).bit_length(), 16), most)


def ball_in_ring(size):
    """A ball of radius 0.5 in a ring that leans."""
    n = detail(size)
    ring = surfaces.torus(n, n // 2, 0.84, 0.15).rotated(rotation("x", 24.0)).rotated(rotation("z", 16.0))
    return surfaces.joined(ring, surfaces.sphere(n, n // 2).scaled(0.5))


def camera(panel, eye):
    """The view of the ball in its ring from an eye."""
    return perspective_view(panel, eye, field_of_view=FIELD_OF_VIEW, radius=1.1)


def normals_by_rays(surface, view):
    """The surface that rays through the pixels' centres meet: unit normals, interpolated in the triangles;
    unit vectors to the eye; whether they meet it. Float64 [size, size, 3] twice, zero where they do not, and
    bool.
    """
    size = view.panel.height
    caster = RayCaster(surface.positions[surface.triangles])
    origins, along = primary_rays(view)
    hits = caster.nearest(origins, along, 1.0)
    seen = hits.triangle >= 0
    corners = surface.triangles[hits.triangle[seen]]
    normals, eye = np.zeros((2, size * size, 3))
    normals[seen] = normalize((surface.normals[corners] * hits.barycentrics[seen][..., None]).sum(axis=1))
    eye[seen] = normalize(-along[seen])
    square = (size, size, 3)
    return normals.reshape(square), eye.reshape(square), seen.reshape(square[:2])


def reflections_by_rays(surface, view, least=0.2):
    """Reflected unit vectors [size, size, 3] at the pixels' centres, and where they are known: bool [size,
    size].

    At these pixels the surface faces the eye by a cosine of ``least`` or more, and the normals of the pixels
    around lean by less than 60 degrees. This leaves out outlines, where a machine may cover a pixel that a
    ray misses.
    """
    normals, eye, seen = normals_by_rays(surface, view)
    known = seen & (dot(normals, eye) > least)
    for step in (-1, 1):
        for axis in (0, 1):
            known &= dot(normals, np.roll(normals, step, axis=axis)) > 0.5
    return reflected(eye, normals), known


def degrees_off(colors, toward):
    """Angles between the directions that colours encode and unit vectors: degrees [...]."""
    found = normalize(2.0 * colors - 1.0)
    return np.degrees(np.arccos(np.clip(dot(found, toward), -1.0, 1.0)))


def backdrop_by_rays(surface, view):
    """Unit vectors along the rays through the pixels' centres [size, size, 3], and which rays meet nothing
    within two pixels: bool [size, size].
    """
    size = view.panel.height
    _, along = primary_rays(view)
    near = normals_by_rays(surface, view)[2]
    for axis in (0, 1):
        near = np.any([np.roll(near, step, axis) for step in range(-2, 3)], axis=0)
    return normalize(along).reshape(size, size, 3), ~near


def some_of(where, count):
    """The numbers of ``count`` pixels, evenly spread, of those ``where`` says: int64 [count]."""
    (places,) = np.nonzero(where.ravel())
    return places[np.linspace(0, len(places) - 1, count).round().astype(int)]


def lobes(toward, texels, light, exponent):
    """What lobes around unit vectors [n, 3] see, by a sum over all texels: float64 [n, 3].

    texels  unit vectors to them, [m, 3]
    light   [m, 4]: their colours times their solid angles, and the solid angles
    """
    weights = np.maximum(toward @ texels.T, 0.0) ** exponent
    return weights @ light[:, :3] / (weights @ light[:, 3:])
