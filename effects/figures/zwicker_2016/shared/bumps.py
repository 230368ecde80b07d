"""What document 003's figures of bump mapping have in common: tessellation, maps, and what checks measure."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.bump_mapping import normal_maps
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import panel_of
from fixedpipe.effects.passes.combiners import TEXTURE0, final, program
from fixedpipe.effects.passes.encoding import factor_texels, vector_and_factor_texels
from fixedpipe.effects.scenes import brick_wall
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_2d

FLAT = "normal map of nothing"
BRICK_NORMALS, BRICK_COLORS = "normal map of bricks", "colours of bricks"


def slices(size):
    """How many slices a round surface has on a panel of ``size`` pixels: a multiple of 8, and at small sizes
    few enough for the plain-Python specification to draw it.
    """
    return 16 if size < 64 else 48 if size < 200 else 96


def texels(size, most=256):
    """The edge of a map for a panel of ``size`` pixels: a power of two of half the panel's edge to the whole,
    from 32 on, at most ``most``.
    """
    return min(max(1 << (size - 1).bit_length() - 1, 32), most)


def load_normals(normals, name, profile, alpha=1.0):
    """The command that loads normals [rows, columns, 3] as a texture for EXPAND_NORMAL."""
    image = texture_2d(vector_and_factor_texels(normals, alpha, profile))
    return TexImage(label=f"load {name}", texture=name, image=image)


def load_colors(colors, name, profile):
    """The command that loads colours [rows, columns, 3] in [0, 1] as a texture."""
    image = texture_2d(factor_texels(colors, profile), InternalFormat.RGB8)
    return TexImage(label=f"load {name}", texture=name, image=image)


def load_wall(
    profile, edge, across, courses, *, relief, height_field, height_scale, photograph, repeated=True
):
    """The commands that load FLAT, BRICK_NORMALS and BRICK_COLORS, maps of ``edge`` texels.

    ``across``, ``courses``: how many bricks, and ``relief`` how high. A height field and a photograph of the
    user's take the place of the bricks and of their colours, each where it is given.
    """
    if height_field is None:
        normals = map_normals(relief * brick_wall.heights(edge, across, courses))
    else:
        normals = own_normals(height_field, edge, edge, height_scale, repeated=repeated)
    if photograph is None:
        colors = brick_wall.colors(edge, across, courses)
    else:
        colors = photograph.fitted(edge, edge, repeated=repeated)
    return [
        load_normals(np.zeros((1, 1, 3)) + np.array([0.0, 0.0, 1.0]), FLAT, profile),
        load_normals(normals, BRICK_NORMALS, profile),
        load_colors(colors, BRICK_COLORS, profile),
    ]


def texel_combiners():
    """Combiners that show texture 0 as it is."""
    return program(final(TEXTURE0))


def map_normals(heights):
    """Normals in tangent space of heights in units of the map's edge: float64 [rows, columns, 3]."""
    rows, columns = heights.shape
    return normal_maps.normals(heights, 1.0 / columns, 1.0 / rows)


def own_normals(height_field, columns, rows, scale, repeated=True):
    """Normals in tangent space of a user's height field (``own_maps``): float64 [rows, columns, 3]."""
    heights = height_field.fitted(columns, rows, scale, repeated=repeated)
    return normal_maps.normals(heights, 1.0 / columns, 1.0 / rows, repeated)


def recovered_normals(pictures, lights):
    """Unit normals from pictures of (n.l)+ under three lights: float64 [h, w, 3].

    ``pictures``: three float64 [h, w]; ``lights``: float64 [3, 3], unit vectors, each with every normal on
    its lit side. Source: Woodham 1980 (photometric stereo).
    """
    return normalize(np.stack(pictures, axis=-1) @ np.linalg.inv(np.asarray(lights)).T)


def angles(a, b):
    """Degrees between unit vectors [..., 3]."""
    return np.degrees(np.arccos(np.clip(dot(a, b), -1.0, 1.0)))


def silhouette_check(figure, renderer, size, without, with_bumps):
    """That an object covers the same pixels of the first panel with and without bumps.

    ``without``, ``with_bumps``: the figure's parameters that differ. The background alone is blue.
    """
    colors = {"background": (0.0, 0.0, 1.0), "diffuse": (1.0, 1.0, 0.0), "ambient": (0.25, 0.25, 0.0)}
    images = [
        panel_of(renderer.machine_window(figure, size, **colors, **c), 0) for c in (without, with_bumps)
    ]
    covered = [image[..., 2] < 0.5 for image in images]
    reason = "bump mapping turns normals and moves no vertex: the catalogue's"
    return (
        Check("pixels that are the object's with bumps or without, not both",
              float((covered[0] != covered[1]).sum()), at_most=0.0, on=Answer.MACHINE, reason=reason),
        Check("share of the panel that the object covers", float(covered[0].mean()), at_least=0.2,
              on=Answer.MACHINE, reason="there is something to compare"),
        Check("largest difference between the two", float(np.abs(images[0] - images[1]).max()), at_least=0.1,
              on=Answer.MACHINE, reason="one of them has bumps"),
    )  # fmt: skip
