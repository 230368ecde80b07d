"""Parts of the figures of Fresnel's mirrors: each machine's reflection and refraction, and a ball by rays."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.environment_maps import (
    environments,
    fresnel_passes,
    reflections,
    refracted_light,
)
from fixedpipe.effects.geometry import cube_maps, surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import cosine, dot, normalize, sine
from fixedpipe.effects.passes.draws import EDGE, REPLACE, unit
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType

# The radius of a ball by itself.
BALL = 0.66
# Half of what a view shows of a map that is laid out flat, three squares high, and a little around it.
MAP_HALF_HEIGHT = 1.6
# An unfolded cube map: column and row of each face's square; the face's middle, right and up in the world.
CROSS = (
    (0, 1, (-1, 0, 0), (0, 0, -1), (0, 1, 0)),
    (1, 1, (0, 0, -1), (1, 0, 0), (0, 1, 0)),
    (2, 1, (1, 0, 0), (0, 0, 1), (0, 1, 0)),
    (3, 1, (0, 0, 1), (-1, 0, 0), (0, 1, 0)),
    (1, 2, (0, 1, 0), (1, 0, 0), (0, 0, 1)),
    (1, 0, (0, -1, 0), (1, 0, 0), (0, 0, -1)),
)


def ball_in_ring(detail):
    """A ball in a ring that leans towards the eye."""
    ring = surfaces.torus(detail, detail // 2, 0.86, 0.14)
    ring = ring.rotated(rotation("x", 26.0)).rotated(rotation("z", 14.0))
    return surfaces.joined(ring, surfaces.sphere(detail, detail // 2).scaled(0.55))


def ball(detail):
    """A ball by itself."""
    return surfaces.sphere(detail, detail // 2).scaled(BALL)


OBJECTS = {"ball in a ring": ball_in_ring, "ball": ball}


@dataclass(frozen=True)
class Refraction:
    """How a machine reflects and refracts.

    loading   (profile, view, maps) -> commands: cube maps of floats, by name, as textures for a view
    mirror    (texture, view) -> the texture unit that reads reflections
    through   (texture, view, edge) -> the texture unit that reads a mesh's refracted directions; ``edge``:
              the cube map's
    passes    a mirror times F: of ``fresnel_passes``
    shown     (texture) -> a mesh and the texture unit that lay a map out flat, within MAP_HALF_HEIGHT
    """

    loading: Callable
    mirror: Callable
    through: Callable
    passes: Callable
    shown: Callable


def _before(texture):
    """The disc of a map."""
    return f"{texture}, before the eye"


def _load_cubes(profile, view, maps):
    return tuple(reflections.load_cube(name, cube, profile) for name, cube in maps.items())


def _load_spheres(profile, view, maps):
    out = []
    for name, cube in maps.items():
        seen, edge = cube_maps.Seen(cube), cube.shape[1]
        image = environments.sphere_map(2 * edge, view, profile, seen)
        out.append(TexImage(label=f"load {name}", texture=name, image=image))
        out.append(refracted_light.load_disc(_before(name), seen, view, 2 * edge, profile))
    return tuple(out)


def _through_cube(texture, view, edge):
    return refracted_light.cube_unit(texture)


def _through_disc(texture, view, edge):
    return refracted_light.disc_unit(_before(texture), view, 2 * edge)


def _by_sphere(texture, view):
    return fresnel_passes.sphere_unit(texture)


def _cross(texture):
    """A cube map's six faces, unfolded."""
    places, toward = [], []
    for column, row, middle, right, up in CROSS:
        for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            places.append((column - 1.5 + 0.5 * x, row - 1.0 + 0.5 * y, 0.0))
            toward.append(np.array(middle) + x * np.array(right) + y * np.array(up))
    mesh = Mesh(np.array(places), PrimitiveType.QUADS, texture_coordinates=(np.array(toward, np.float64),))
    return mesh, unit(texture, EDGE, environment=REPLACE)


def _circle(texture):
    """A sphere map's circle."""
    angles = 2.0 * math.pi * np.arange(96) / 96
    rim = np.stack([cosine(angles), sine(angles)], axis=-1)
    mesh = Mesh(1.5 * rim, PrimitiveType.POLYGON, texture_coordinates=(0.5 + 0.5 * rim,))
    return mesh, unit(texture, EDGE, environment=REPLACE)


CUBE_MAPS = Refraction(
    _load_cubes, fresnel_passes.cube_unit, _through_cube, fresnel_passes.mirror_passes, _cross
)
CUBE_MAPS_FOLDED = Refraction(
    _load_cubes, fresnel_passes.cube_unit, _through_cube, fresnel_passes.folded_mirror_pass, _cross
)
SPHERE_MAPS = Refraction(_load_spheres, _by_sphere, _through_disc, fresnel_passes.mirror_passes, _circle)
SPHERE_MAPS_FOLDED = Refraction(
    _load_spheres, _by_sphere, _through_disc, fresnel_passes.folded_mirror_pass, _circle
)


def texels(edge, most=256):
    """The edge of an environment map's faces for a picture of ``edge`` pixels: a power of two, from 16 on."""
    return min(max(1 << (edge - 1).bit_length(), 16), most)


def by_polarizations(cosine, index):
    """Fresnel's reflectance as the mean of both polarizations', by Snell's law: another form."""
    inside = np.sqrt(1.0 - (1.0 - cosine * cosine) / (index * index))
    across = (cosine - index * inside) / (cosine + index * inside)
    along = (index * cosine - inside) / (index * cosine + inside)
    return 0.5 * (across * across + along * along)


def surface_by_rays(surface, view):
    """A surface at the pixels' centres, with normals interpolated in its triangles: unit normals and vectors
    to the eye, float64 [height, width, 3], zero beside the surface; and which pixels show it, bool [height,
    width].
    """
    origins, along = primary_rays(view)
    hits = RayCaster(surface.positions[surface.triangles]).nearest(origins, along, 1.0)
    seen = hits.triangle >= 0
    corners, weights = surface.triangles[hits.triangle[seen]], hits.barycentrics[seen]
    normals, eye = np.zeros((2, *along.shape))
    normals[seen] = normalize((surface.normals[corners] * weights[..., None]).sum(axis=1))
    eye[seen] = normalize(-along[seen])
    shape = (view.panel.height, view.panel.width)
    return normals.reshape(*shape, 3), eye.reshape(*shape, 3), seen.reshape(shape)


def ball_by_rays(view):
    """The ball at the pixels' centres: normals and vectors to the eye, float64 [height, width, 3], and where
    it is: bool [height, width].
    """
    _, along = primary_rays(view)
    eye = np.broadcast_to(np.array(view.eye) / BALL, along.shape)
    along = normalize(along)
    middle = dot(along, eye)
    under = middle * middle - (dot(eye, eye) - 1.0)
    place = eye + (-middle - np.sqrt(np.maximum(under, 0.0)))[:, None] * along
    shape = (view.panel.height, view.panel.width)
    return normalize(place).reshape(*shape, 3), -along.reshape(*shape, 3), (under > 0.0).reshape(shape)
