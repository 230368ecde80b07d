"""The host's pixel texture on a board without one gives the Octane's picture, to the bit."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from effects.software_pixel_texture import drawn, look_up, read_back, textured_quad
from pipeline.commands import CopyPixels, TexImage
from pipeline.enums import (
    BlendFactor,
    InternalFormat,
    TextureEnvironmentMode,
    TextureFilter,
    WrapMode,
)
from pipeline.execute import Machine
from pipeline.profiles import GEFORCE_256, OCTANE
from pipeline.state import (
    Blending,
    PassState,
    PixelTexture,
    RasterPosition,
    Sampler,
    TextureEnvironment,
    TextureUnit,
)
from pipeline.textures import texture_1d, texture_2d, texture_cube_map

WIDTH, HEIGHT = 24, 16
filters = st.sampled_from([TextureFilter.NEAREST, TextureFilter.LINEAR])
wraps = st.sampled_from([WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE])
formats = st.sampled_from([InternalFormat.RGBA8, InternalFormat.INTENSITY8, InternalFormat.RGB5_A1])
sizes = st.sampled_from([1, 2, 8, 32])
MULTIPLIED = PassState(blending=Blending(BlendFactor.DST_COLOR, BlendFactor.ZERO))


def octane_state(texture_filter, wrap, state):
    """The state in which the Octane looks up the texture "table"."""
    sampler = Sampler(texture_filter, texture_filter, wrap_s=wrap, wrap_t=wrap)
    replaced = TextureEnvironment(TextureEnvironmentMode.REPLACE)
    return replace(state, texture_units=(TextureUnit("table", sampler, environment=replaced),))


@settings(max_examples=30)
@given(
    st.integers(0, 10**6),
    filters,
    wraps,
    formats,
    sizes,
    sizes,
    st.booleans(),
    st.sampled_from([None, 255, 0]),
)
def test_the_hosts_lookup_is_the_octanes(
    seed, texture_filter, wrap, internal_format, width, height, line, alpha
):
    rng = np.random.default_rng(seed)
    content = rng.integers(0, 256, (HEIGHT, WIDTH, 4), np.uint8)
    if alpha is not None:
        content[..., 3] = alpha
    texels = rng.integers(0, 256, (height, width, 4), np.uint8)
    texture = texture_1d(texels[0], internal_format) if line else texture_2d(texels, internal_format)

    octane = Machine(OCTANE, WIDTH, HEIGHT)
    octane.framebuffer.color[:] = content
    state = octane_state(texture_filter, wrap, MULTIPLIED)
    copy = CopyPixels(
        label="look up",
        position=RasterPosition(window=True),
        state=state,
        pixel_texture=PixelTexture(),
    )
    result = octane.run((TexImage(label="store", texture="table", image=texture), copy))
    assert result.undefined == (content[..., 3] == 0).sum()

    board = Machine(GEFORCE_256, WIDTH, HEIGHT)
    board.framebuffer.color[:] = content
    pixels = board.run((read_back("coordinates"),)).pixels["coordinates"]
    found = look_up(pixels, texture, texture_filter, wrap)
    picture = board.run((drawn("looked up", found, state=MULTIPLIED),)).image()
    assert (picture == result.image()).all()

    board.framebuffer.color[:] = content
    quad = board.run(textured_quad("looked up", found, "found", state=MULTIPLIED)).image()
    assert (quad == picture).all()


PIXELS = np.zeros((2, 2, 4), np.uint8)
TABLE = texture_2d(np.zeros((2, 2, 4), np.uint8))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((PIXELS / 255, TABLE), "as ReadPixels returns RGBA"),
        ((PIXELS[..., :3], TABLE), "as ReadPixels returns RGBA"),
        ((PIXELS, texture_cube_map(np.zeros((6, 2, 2, 4), np.uint8))), "TEXTURE_CUBE_MAP of 8 bits"),
        ((PIXELS, TABLE, TextureFilter.LINEAR_MIPMAP_LINEAR), "not with LINEAR_MIPMAP_LINEAR"),
        ((PIXELS, TABLE, TextureFilter.LINEAR, WrapMode.CLAMP), "and CLAMP; give"),
    ],
)
def test_what_the_host_does_not_look_up_is_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        look_up(*arguments)
