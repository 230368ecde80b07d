"""Random local frames under random halfway vectors, drawn so that every pixel is one evaluation of Eq. 1."""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry.vectors import cross, normalize
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.passes.encoding import vector_and_factor_texels, vector_colors
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, brdfs, material_textures
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import CombinerScale, PrimitiveType
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.state import PassState, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

# Texels along an edge of the random material, and how many halfway vectors it is seen under: a square of
# quads, each the whole material texel for pixel.
EDGE, ACROSS = 32, 16
SIZE = EDGE * ACROSS


def random_directions(count, seed):
    """Random unit vectors, float64 [count, 3], all directions alike."""
    random = np.random.Generator(np.random.PCG64(seed))
    return normalize(random.standard_normal((count, 3)))


def random_frames(count, seed):
    """Normals, tangents and binormals of random local frames, float64 [count, 3] each, all turns alike."""
    tangents, others = random_directions(2 * count, seed).reshape(2, count, 3)
    normals = normalize(cross(tangents, others))
    return normals, tangents, cross(normals, tangents)


def cells(vectors, profile):
    """A mesh of ACROSS x ACROSS quads that fill the view, one for each vector [ACROSS * ACROSS, 3].

    The vector is the quad's primary colour, for EXPAND_NORMAL; texture coordinates cover the texture once.
    """
    cell = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    places = [np.array([k % ACROSS, k // ACROSS]) for k in range(ACROSS * ACROSS)]
    corners = np.concatenate([(cell + place) * (2.0 / ACROSS) - 1.0 for place in places])
    colors = np.repeat(vector_colors(vectors, profile), 4, axis=0)
    coordinates = np.tile(cell, (len(places), 1))
    return Mesh(corners, PrimitiveType.QUADS, colors=colors, texture_coordinates=(coordinates,))


def eq_1(alpha_x, alpha_y, profile, *, storing=None, scaled=True):
    """Eq. 1 of random frames under random halfway vectors, in all pairs: the results of the machine and of
    float64.

    ``storing``: the profile by whose convention the vectors are stored; None: the machine's own. ``scaled``:
    the vectors are stored times 0.25 and the dot products multiplied by four, as the paper does; otherwise
    neither, which only alphas of one allow. Returns two float64 [ACROSS * ACROSS, EDGE, EDGE].
    """
    storing = storing or profile
    frames = (a.reshape(EDGE, EDGE, 3) for a in random_frames(EDGE * EDGE, 11))
    material = material_textures.Material(*frames, alpha_x, alpha_y, 1.0)
    half = random_directions(ACROSS * ACROSS, 12)
    combiners = anisotropic_blinn_phong.combiners()
    scale = material_textures.STORAGE_SCALE if scaled else 1.0
    if not scaled:
        first = combiners.general[0]
        unscaled = replace(first, rgb=replace(first.rgb, scale=CombinerScale.NONE))
        combiners = replace(combiners, general=(unscaled, *combiners.general[1:]))
    stored = {"t": material.scaled_tangents, "b": material.scaled_binormals}
    loading = (
        TexImage(
            label=f"load {name}",
            texture=name,
            image=texture_2d(vector_and_factor_texels(scale * v, 1.0, storing)),
        )
        for name, v in stored.items()
    )
    state = PassState(
        texture_units=tuple(TextureUnit(name, NEAREST) for name in stored), register_combiners=combiners
    )
    commands = (*loading, Draw(label="Eq. 1", mesh=cells(half, storing), state=state))
    image = execute(commands, profile, SIZE, SIZE).framebuffer.color[::-1, :, 0] / 255.0
    blocks = image.reshape(ACROSS, EDGE, ACROSS, EDGE).transpose(0, 2, 1, 3).reshape(-1, EDGE, EDGE)
    true = brdfs.anisotropic_blinn_phong(
        half[:, None, None, :], material.tangents, material.binormals, alpha_x, alpha_y
    )
    return blocks, true
