"""Three balls over a floor and the shadow map of their light: what scenes f2 and f3 show.

The map is computed from the spheres, not drawn, so that every party reads the same texels. It holds the
depth half way between a ball's lit and its unlit side (A. Woo, The Shadow Depth Map Revisited, Graphics
Gems III, 1992) and no floor: nothing that is drawn lies near a depth that it is compared with, but along the
rim of a ball.
"""

from functools import cache

import numpy as np

from bench.meshes import grid_triangles, look_at, perspective
from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import InternalFormat, TexGenMode, TextureTarget
from fixedpipe.pipeline.state import TexGen
from fixedpipe.pipeline.textures.images import Texture, depth_texels

# Centre, radius and colour.
_BALLS = (
    ((-0.7, 0.3, 0.75), 0.5, (0.8, 0.3, 0.3, 1.0)),
    ((0.65, -0.2, 0.5), 0.35, (0.3, 0.7, 0.4, 1.0)),
    ((0.2, 0.9, 0.9), 0.45, (0.3, 0.4, 0.9, 1.0)),
)
_LIGHT = perspective(50, 3.0, 14.0), look_at((3.0, -2.0, 6.0), (0.0, 0.0, 0.0))
VIEW = {"projection": perspective(45, 1.0, 20.0), "modelview": look_at((1.0, -3.2, 3.4), (0.0, 0.0, 0.3))}


def coordinate_generation():
    """TexGen of s, t, r and q: the light's clip coordinates, moved from [-1, 1] to [0, 1]."""
    bias = np.array([(0.5, 0, 0, 0.5), (0, 0.5, 0, 0.5), (0, 0, 0.5, 0.5), (0, 0, 0, 1)])
    planes = bias @ np.array(_LIGHT[0]) @ np.array(_LIGHT[1])
    return tuple(TexGen(TexGenMode.OBJECT_LINEAR, tuple(map(float, plane))) for plane in planes)


@cache
def shadow_map(n=512):
    """DEPTH_COMPONENT24 [n, n]: for every texel the nearest ball's depth from the light, or the farthest."""
    projection, view = (np.array(matrix) for matrix in _LIGHT)
    edge = (np.arange(n) + 0.5) / n * 2 - 1
    x, y = np.meshgrid(edge / projection[0, 0], edge / projection[1, 1])
    ray = np.stack([x, y, np.full_like(x, -1.0)], axis=-1)
    depth = np.ones((n, n))
    for center, radius, _ in _BALLS:
        to_center = view[:3, :3] @ np.array(center) + view[:3, 3]
        # How far along each ray, whose third component is -1, the centre's nearest point lies: its -z.
        distance = (ray @ to_center) / (ray * ray).sum(-1)
        hit = ((distance[..., None] * ray - to_center) ** 2).sum(-1) < radius * radius
        window = ((projection[2, 3] - projection[2, 2] * distance) / distance + 1) / 2
        depth = np.where(hit, np.minimum(depth, window), depth)
    words = np.floor(depth * (2**24 - 1) + 0.5).astype(np.uint32)
    return Texture(TextureTarget.TEXTURE_2D, InternalFormat.DEPTH_COMPONENT24, (depth_texels(words)[None],))


def _ball(center, radius, around=60, along=30):
    longitude, latitude = np.meshgrid(
        np.linspace(0, 2 * np.pi, around + 1), np.linspace(-np.pi / 2, np.pi / 2, along + 1), indexing="ij"
    )
    across = np.cos(latitude)
    normals = np.stack([np.cos(longitude) * across, np.sin(longitude) * across, np.sin(latitude)], axis=-1)
    triangles = grid_triangles(around, along).reshape(around, along, 2, 3)
    # At a pole one triangle of a cell has no area: at the lower pole the first, at the upper the second.
    kept = np.ones((around, along, 2), bool)
    kept[:, 0, 0] = kept[:, -1, 1] = False
    return (normals * radius + center).reshape(-1, 3), triangles[kept]


@cache
def floor():
    """The floor alone, which fills the view."""
    return _mesh(())


@cache
def balls_on_floor():
    """The floor, then the balls: 10,442 indexed triangles."""
    return _mesh(_BALLS)


def _mesh(balls):
    positions = [np.array([(-9, -9, 0), (9, -9, 0), (-9, 9, 0), (9, 9, 0)], np.float64)]
    triangles = [np.array([(0, 1, 2), (2, 1, 3)])]
    colors = [np.tile((0.9, 0.8, 0.6, 1.0), (4, 1))]
    for center, radius, color in balls:
        vertices, corners = _ball(center, radius)
        triangles.append(corners + sum(map(len, positions)))
        positions.append(vertices)
        colors.append(np.tile(color, (len(vertices), 1)))
    return Mesh(
        np.concatenate(positions), indices=np.concatenate(triangles).ravel(), colors=np.concatenate(colors)
    )
