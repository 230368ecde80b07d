"""The host's pixel texture on a board without one gives the Octane's picture, to the bit."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.passes.software_pixel_texture import look_up, pixel_texture
from fixedpipe.pipeline.commands import CopyPixels, DrawPixels, TexImage
from fixedpipe.pipeline.enums import (
    BlendFactor,
    InternalFormat,
    TextureEnvironmentMode,
    TextureFilter,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.profiles import GEFORCE_256, OCTANE
from fixedpipe.pipeline.state import (
    Blending,
    PassState,
    PixelTexture,
    RasterPosition,
    Sampler,
    TextureEnvironment,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_1d, texture_2d, texture_cube_map

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
    sampled = {"texture_filter": texture_filter, "wrap": wrap, "state": MULTIPLIED}
    for by_quad in (False, True):
        board.framebuffer.color[:] = content
        commands = pixel_texture("look up", texture, by_quad=by_quad, **sampled)
        assert (board.run(commands).image() == result.image()).all()


@settings(max_examples=10)
@given(st.integers(0, 10**6), filters, wraps, st.booleans())
def test_of_floats_the_hosts_lookup_is_the_ideal_machine_s(seed, texture_filter, wrap, line):
    rng = np.random.default_rng(seed)
    content, texels = rng.random((HEIGHT, WIDTH, 4)), rng.random((8, 16, 4))
    content[0, 0, 3] = 0.0
    texture = texture_1d(texels[0]) if line else texture_2d(texels)
    background = DrawPixels(label="content", image=PixelImage(content), position=RasterPosition(window=True))
    copy = CopyPixels(
        label="look up",
        position=RasterPosition(window=True),
        state=octane_state(texture_filter, wrap, MULTIPLIED),
        pixel_texture=PixelTexture(),
    )
    store = TexImage(label="store", texture="table", image=texture)
    expected = execute_ideal((background, store, copy), WIDTH, HEIGHT)
    for by_quad in (False, True):
        sampled = {"texture_filter": texture_filter, "wrap": wrap, "state": MULTIPLIED, "by_quad": by_quad}
        commands = (background, *pixel_texture("look up", texture, **sampled))
        assert execute_ideal(commands, WIDTH, HEIGHT).color == pytest.approx(expected.color, abs=1e-12)


def test_a_rectangle_is_looked_up_where_it_was_read():
    rng = np.random.default_rng(1)
    content = rng.integers(0, 256, (HEIGHT, WIDTH, 4), np.uint8)
    texture = texture_2d(rng.integers(0, 256, (4, 4, 4), np.uint8))
    board = Machine(GEFORCE_256, WIDTH, HEIGHT)
    board.framebuffer.color[:] = content

    def swapped(pixels):
        return pixels[..., [1, 0, 2, 3]]

    board.run(pixel_texture("look up", texture, x=3, y=2, width=5, height=4, coordinates=swapped))
    bottom_first, before = board.framebuffer.color[::-1], content[::-1]
    inside = np.zeros((HEIGHT, WIDTH), bool)
    inside[2:6, 3:8] = True
    assert (bottom_first[~inside] == before[~inside]).all()
    expected = look_up(swapped(before[2:6, 3:8]), texture)
    assert (bottom_first[2:6, 3:8] == expected).all()


PIXELS = np.zeros((2, 2, 4), np.uint8)
TABLE = texture_2d(np.zeros((2, 2, 4), np.uint8))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((PIXELS.astype(np.float32), TABLE), "as ReadPixels returns RGBA"),
        ((PIXELS[..., :3], TABLE), "as ReadPixels returns RGBA"),
        ((PIXELS, texture_cube_map(np.zeros((6, 2, 2, 4), np.uint8))), "TEXTURE_CUBE_MAP of 8 bits"),
        ((PIXELS, TABLE, TextureFilter.LINEAR_MIPMAP_LINEAR), "not with LINEAR_MIPMAP_LINEAR"),
        ((PIXELS, TABLE, TextureFilter.LINEAR, WrapMode.CLAMP), "and CLAMP; give"),
    ],
)
def test_what_the_host_does_not_look_up_is_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        look_up(*arguments)
