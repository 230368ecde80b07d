"""The textures that the scenes read, as both parties load them."""

from functools import cache, partial

import numpy as np

from bench.shadow import shadow_map
from fixedpipe.pipeline.textures.images import texture_2d


@cache
def color_texture(n=512, *, mipmaps=False):
    """RGBA8 waves, a checkerboard of 16 texels and noise of ±16 levels; ``n`` texels along an edge."""
    row, column = np.mgrid[0:n, 0:n]
    rgb = np.stack(
        [
            127 + 100 * np.sin(column / 9) * np.cos(row / 13),
            127 + 100 * np.cos(column / 17 + row / 5),
            (column // 16 + row // 16) % 2 * 160.0 + 40,
        ],
        axis=-1,
    )
    rgb += np.random.default_rng(1).integers(-16, 17, (n, n, 3))
    image = np.full((n, n, 4), 255, np.uint8)
    image[..., :3] = np.clip(rgb, 0, 255)
    return texture_2d(image, mipmaps=mipmaps)


@cache
def normal_texture(n=512):
    """RGBA8 normals of a wavy surface: zero at 128, one at 255; alpha 255; ``n`` texels along an edge."""
    row, column = np.mgrid[0:n, 0:n]
    normal = np.empty((n, n, 3))
    normal[..., 0] = -0.6 * np.cos(column / 11) * np.cos(row / 19)
    normal[..., 1] = -0.6 * np.sin(column / 7 + row / 23)
    normal[..., 2] = 1.0
    normal /= np.sqrt((normal * normal).sum(-1, keepdims=True))
    image = np.full((n, n, 4), 255, np.uint8)
    image[..., :3] = np.rint(128 + 127 * normal)
    return texture_2d(image)


@cache
def light_texture(n=256):
    """RGBA8 light that varies slowly, with all levels; alpha 255; ``n`` texels along an edge."""
    row, column = np.mgrid[0:n, 0:n] * (2 * np.pi / n)
    image = np.full((n, n, 4), 255, np.uint8)
    image[..., 0] = np.rint(170 + 80 * np.sin(3 * column) * np.cos(2 * row))
    image[..., 1] = np.rint(160 + 80 * np.sin(2 * column + 3 * row))
    image[..., 2] = np.rint(140 + 80 * np.cos(5 * row))
    return texture_2d(image, mipmaps=True)


@cache
def torrance_sparrow_table(number):
    """RGBA8 of one of the two tables of Torrance and Sparrow's model (figure F000-2, roughness 0.35)."""
    from fixedpipe.effects.reflectance import torrance_sparrow_passes
    from fixedpipe.pipeline.profiles import GEFORCE_256

    command = torrance_sparrow_passes.load(GEFORCE_256, 0.35, 200.0)[number]
    return texture_2d(np.asarray(command.image.levels[0])[0])


# Texture object -> its images.
TEXTURES = {
    "color": color_texture,
    "color, mipmapped": partial(color_texture, mipmaps=True),
    "light, mipmapped": light_texture,
    "normals": normal_texture,
    "shadow map": shadow_map,
    "F D": partial(torrance_sparrow_table, 0),
    "G / (pi cos beta)": partial(torrance_sparrow_table, 1),
}
