"""Texture_BRDF: two cubes whose eye and light directions, from cube maps of angles, look up a 3D texture.

Source: src/tests/texture_brdf_tests.cpp of nxdk_pgraph_tests. Inferred: no vertex program was loaded (that
class of pbkitplusplus has none of its own), so the fixed-function matrix acts. In this matrix the program
puts the view before the model, so only a corner lies in the window. Measured: 304820 of 304820 pixels.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites.texture_cubemap import CUBES, model_matrix, state_of
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, Register, TexelWord, TextureTarget, WrapMode
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import TextureShaderStage, TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Texture_BRDF"

SIZE = 64
POINTS = np.array(
    [(-1, -1, -1), (-1, -1, 1), (1, -1, 1), (1, -1, -1), (-1, 1, -1), (-1, 1, 1), (1, 1, 1), (1, 1, -1)],
    np.float64,
)
# Right, left, top, bottom, back, front.
FACES = ((3, 7, 6, 2), (1, 5, 4, 0), (4, 5, 6, 7), (1, 0, 3, 2), (2, 6, 5, 1), (0, 4, 7, 3))
LIGHT = (0.1, 0.05)  # x and y of the direction to the light; its z is the corner's


def angle_map(blank):
    """A cube map of R16B16 words: the angle from +z in the upper half, the angle about z in the lower."""
    single = np.float32
    at = (single(0.5) + np.arange(SIZE, dtype=single)) * single(2 / SIZE) - single(1)
    x, y = np.broadcast_arrays(at[None], at[:, None])
    one = np.ones_like(x)
    directions = ((one, -y, -x), (-one, -y, x), (x, one, y), (x, -one, -y), (x, -y, one), (-x, -y, -one))
    words = []
    for vx, vy, vz in directions:
        theta = np.arccos(vz / np.sqrt(vx * vx + vy * vy + vz * vz)).astype(np.float64)
        phi = np.arctan2(vy, vx).astype(np.float64)
        phi = np.where(phi < 0, phi + 2 * np.pi, phi)
        upper = np.floor(theta / np.pi * 65535 + 0.5).astype(np.int64)
        lower = np.floor(phi / (2 * np.pi) * 65536 + 0.5).astype(np.int64) & 65535
        words.append(upper << 16 | lower)
    if blank:
        words[0] = np.zeros_like(words[0])
    return texture_of_words(np.stack(words), TexelWord.R16B16, TextureTarget.TEXTURE_CUBE_MAP)


def ramps():
    """A 3D texture: red rises with s, green with t, blue with r."""
    ramp = np.arange(SIZE) * 255 // (SIZE - 1)
    words = 0xFF000000 | ramp << 16 | ramp[:, None] << 8 | ramp[:, None, None]
    return texture_of_words(words, TexelWord.A8R8G8B8, TextureTarget.TEXTURE_3D)


def mesh():
    """The cube; its corners are the directions to the eye."""
    corners = POINTS[np.array(FACES).ravel()]
    light = np.column_stack([np.tile(LIGHT, (len(corners), 1)), corners[:, 2]])
    coordinates = (corners, scenes.single(light))
    return Mesh(corners, PrimitiveType.QUADS, texture_coordinates=coordinates)


def _case(blank):
    units = (
        TextureUnit("eye", scenes.NEAREST, coordinates=0),
        TextureUnit("light", scenes.NEAREST, coordinates=1),
        TextureUnit("brdf", replace(scenes.NEAREST, wrap_r=WrapMode.REPEAT), coordinates=0),
    )
    stages = (Operation.TEXTURE_CUBE_MAP, Operation.TEXTURE_CUBE_MAP, Operation.BRDF_TEXTURE_3D)
    state = state_of(Register.TEXTURE2, units, tuple(map(TextureShaderStage, stages)))
    maps = [
        TexImage(label=f"{whose} angles", texture=whose, image=angle_map(whose in blank))
        for whose in ("eye", "light")
    ]
    draws = [
        Draw(
            label=f"cube {number}",
            mesh=mesh(),
            state=replace(
                state, vertex=scenes.xdk_vertex(model=scenes.XDK_VIEW, view=model_matrix(*place).T)
            ),
        )
        for number, place in enumerate(CUBES)
    ]
    return Case(
        commands=(
            scenes.clear(0xFE121212),
            *maps,
            TexImage(label="brdf", texture="brdf", image=ramps()),
            *draws,
        )
    )


CASES = {  # with the angles whose map's +x face is zero
    "BRDF_e0_l0": partial(_case, ()),
    "BRDF_e0_l1": partial(_case, ("light",)),
    "BRDF_e1_l0": partial(_case, ("eye",)),
}
