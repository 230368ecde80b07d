"""Texture coordinates whose q is 0: every engine, and the ideal, read the end that they point to."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter, WrapMode
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.state import PassState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from tests.support.strategies import SHOW_TEXTURE

TEXELS = [10, 20, 30, 40]


def frame(s, filter_mode):
    """A texture whose rows are TEXELS over the window, at (s, 0.4, 0, 0) everywhere."""
    image = np.repeat(np.tile(np.array(TEXELS, np.uint8), (4, 1))[..., None], 3, 2)
    sampler = Sampler(filter_mode, filter_mode, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE)
    mesh = Mesh(
        [(-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0)],
        PrimitiveType.TRIANGLES,
        texture_coordinates=([(s, 0.4, 0.0, 0.0)] * 3,),
    )
    state = PassState(texture_units=(TextureUnit("row", sampler),), register_combiners=SHOW_TEXTURE)
    return (
        TexImage(label="row", texture="row", image=texture_2d(image)),
        Draw(label="zero q", mesh=mesh, state=state),
    )


# Measured: the texture's end where s and t are positive (Texture_Matrix Arbitrary).
@pytest.mark.parametrize(("s", "texel"), [(0.3, 40), (2.0**-30, 40), (0.0, 10), (-0.3, 10)])
@pytest.mark.parametrize("filter_mode", [TextureFilter.NEAREST, TextureFilter.LINEAR])
@pytest.mark.parametrize("profile", [NV2A, GEFORCE_256])
@pytest.mark.parametrize("engine", [None, "portable", "columns"])
def test_the_texture_s_end_is_read(s, texel, filter_mode, profile, engine):
    drawn = Machine(profile, 20, 3, engine=engine).run(frame(s, filter_mode))
    assert (drawn.framebuffer.color[..., 0] == texel).all()
    ideal = execute_ideal(frame(s, filter_mode), 20, 3).color[..., 0]
    assert (np.floor(255.0 * ideal + 0.5) == texel).all()
