"""The ideal evaluator's rectangles of pixels, pixel textures, accumulation and volumes: what the machine
gives, but for its rounding.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import (
    Accum,
    Bitmap,
    Clear,
    CopyPixels,
    CopyTexImage,
    Draw,
    DrawPixels,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    AccumOperation,
    BlendFactor,
    ColorBuffer,
    ComparisonFunction,
    InternalFormat,
    PixelCopyType,
    PixelTexGenAlpha,
    PixelTexGenMode,
    PixelTexGenQ,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.profiles import OCTANE
from fixedpipe.pipeline.state import (
    Blending,
    DepthTest,
    Fog,
    PassState,
    PixelTexture,
    RasterPosition,
    Sampler,
    Scissor,
    StencilTest,
    TextureEnvironment,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import Texture, texture_2d

SIZE = 8
AT = RasterPosition(window=True, color=(0.25, 0.5, 0.75, 0.5), texture_coordinates=((0.3, 0.6, 0.1, 1.0),))
rng = np.random.default_rng(3)
IMAGE = PixelImage(rng.integers(0, 256, (SIZE, SIZE, 4), np.uint8))
OPAQUE = PixelImage(rng.integers(0, 256, (SIZE, SIZE, 3), np.uint8), "RGB")
DEPTHS = PixelImage(rng.random((SIZE, SIZE)), "DEPTH_COMPONENT")
INDICES = PixelImage(rng.integers(0, 256, (4, 4), np.uint8), "STENCIL_INDEX")
STORED = TexImage(label="t", texture="t", image=texture_2d(rng.integers(0, 256, (16, 16, 4), np.uint8)))
LAYERS = rng.integers(0, 256, (8, 4, 4, 4), np.uint8)
VOLUME = TexImage(
    label="v", texture="v", image=Texture(TextureTarget.TEXTURE_3D, InternalFormat.RGBA8, (LAYERS,))
)


def textured(name, texture_filter=TextureFilter.LINEAR):
    """A state that replaces colours by a texture's."""
    wraps = dict.fromkeys(("wrap_s", "wrap_t", "wrap_r"), WrapMode.CLAMP_TO_EDGE)
    unit = TextureUnit(
        texture=name,
        sampler=Sampler(texture_filter, texture_filter, **wraps),
        environment=TextureEnvironment(TextureEnvironmentMode.REPLACE),
    )
    return PassState(texture_units=(unit,))


def lookup(name="t", texture_filter=TextureFilter.LINEAR, image=OPAQUE, **fields):
    return DrawPixels(
        label="look up",
        image=image,
        position=AT,
        state=textured(name, texture_filter),
        pixel_texture=PixelTexture(**fields),
    )


BLENDED = PassState(
    blending=Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA),
    scissor=Scissor(1, 1, 6, 5),
    fog=Fog(color=(1.0, 0.5, 0.0, 0.0), density=0.5),
)
FULL = Mesh(
    np.array([[-1.0, -1], [3, -1], [-1, 3]]),
    texture_coordinates=(np.array([[0.1, 0.2, 0.0], [2.0, 0.1, 0.4], [0.2, 1.9, 2.0]]),),
)
FRAMES = {
    "drawn": (DrawPixels(label="d", image=IMAGE, position=AT.moved(0.5, 1.25), zoom=(0.75, -1.5)),),
    "blended": (
        Clear(label="c", color=(0.5, 0.25, 1.0, 1.0)),
        DrawPixels(label="d", image=IMAGE, position=AT, state=BLENDED),
    ),
    "bitmap": (Bitmap(label="b", bits=IMAGE.values[..., 0] > 99, position=AT, origin=(0.5, 1.0)),),
    "textured bitmap": (
        STORED,
        Bitmap(label="b", bits=IMAGE.values[..., 0] > 99, position=AT, state=textured("t")),
    ),
    "copied": (
        DrawPixels(label="d", image=IMAGE, position=AT, state=PassState(draw_buffer=ColorBuffer.AUX0)),
        CopyPixels(
            label="c",
            x=2,
            width=4,
            height=5,
            position=AT,
            zoom=(2.0, 1.5),
            read_buffer=ColorBuffer.AUX0,
            transfer=PixelTransfer(scale=(0.5, 0.5, 0.5, 1.0), bias=(0.25, 0.0, 0.0, 0.0)),
        ),
        ReadPixels(label="r", name="r", read_buffer=ColorBuffer.AUX0),
    ),
    "depths": (
        DrawPixels(label="d", image=DEPTHS, position=AT, state=PassState(depth_test=DepthTest())),
        CopyPixels(
            label="c",
            type=PixelCopyType.DEPTH,
            width=4,
            position=replace(AT, color=(1.0, 0.0, 0.0, 1.0)).moved(4, 0),
            state=PassState(depth_test=DepthTest(ComparisonFunction.GEQUAL)),
        ),
    ),
    "stencil": (
        DrawPixels(label="d", image=INDICES, position=AT, zoom=(2.0, 2.0)),
        Bitmap(
            label="b",
            bits=np.ones((SIZE, SIZE)) > 0,
            position=AT,
            state=PassState(stencil_test=StencilTest(ComparisonFunction.LESS, 100, write_mask=0x0F)),
        ),
    ),
    "pixel texture": (STORED, lookup()),
    "nearest": (STORED, lookup(texture_filter=TextureFilter.NEAREST)),
    "raster colour": (
        STORED,
        replace(lookup(mode=PixelTexGenMode.RGB), state=PassState(texture_units=textured("t").texture_units)),
    ),
    "volume": (VOLUME, lookup("v")),
    "four dimensions": (
        VOLUME,
        lookup("v", volumes=2, q_filter=PixelTexGenQ.CEILING, alpha_replace=True, image=IMAGE),
        lookup("v", volumes=4, alpha_replace=True, alpha=PixelTexGenAlpha.LS, image=IMAGE),
    ),
    "volume on a triangle": (VOLUME, Draw(label="d", mesh=FULL, state=textured("v"))),
    "accumulated": (
        DrawPixels(label="d", image=IMAGE, position=AT),
        Accum(label="a", operation=AccumOperation.LOAD, value=0.5),
        DrawPixels(label="d", image=OPAQUE, position=AT, state=PassState(draw_buffer=ColorBuffer.AUX1)),
        Accum(label="a", operation=AccumOperation.ACCUM, value=0.25, read_buffer=ColorBuffer.AUX1),
        Accum(label="a", operation=AccumOperation.ADD, value=0.1, scissor=Scissor(0, 0, 4, 4)),
        Accum(label="a", operation=AccumOperation.MULT, value=0.75),
        Accum(label="a", operation=AccumOperation.RETURN, value=1.0),
        CopyTexImage(label="t", texture="copy", read_buffer=ColorBuffer.AUX1),
    ),
}
# How far the machine may be off, in parts of 255: rounding once or twice, filters' fractions of eight bits.
# Where a nearest filter's coordinate is rounded, another texel is read: none is so close here.
STEPS = {
    "pixel texture": 2.0,
    "raster colour": 2.0,
    "volume": 2.5,
    "four dimensions": 2.5,
    "volume on a triangle": 6.0,
    "blended": 2.0,
}


@pytest.mark.parametrize("name", FRAMES)
def test_the_machine_is_the_ideal_but_for_rounding(name):
    frame = FRAMES[name]
    profile = OCTANE.changed(auxiliary_buffers=2)
    machine = execute(frame, profile, SIZE, SIZE, record=True)
    ideal = execute_ideal(frame, SIZE, SIZE)
    guided = execute_ideal(frame, SIZE, SIZE, guide=machine)
    most = STEPS.get(name, 1.2) / 255
    color = machine.framebuffer.color / 255
    assert np.abs(color - ideal.color).max() <= most
    assert np.abs(color - guided.color).max() <= most
    assert color.any()
    full = 2.0**machine.framebuffer.depth_bits - 1
    assert np.abs(machine.framebuffer.depth / full - ideal.depth).max() < 1e-6
    assert (machine.framebuffer.stencil == ideal.stencil).all()
    for key, read in machine.pixels.items():
        assert np.abs(read / 255 - ideal.pixels[key]).max() <= most
    if "copy" in ideal.textures:
        assert (
            np.abs(machine.textures["copy"].levels[0] / 255 - ideal.textures["copy"].ideal[0]).max() <= most
        )


@pytest.mark.parametrize("texture_filter", [TextureFilter.NEAREST, TextureFilter.LINEAR])
def test_a_rectangle_of_one_pixel_reads_what_its_pixel_in_a_larger_one_reads(texture_filter):
    large = lookup(texture_filter=texture_filter)
    one = replace(large, image=PixelImage(OPAQUE.values[:1, :1], "RGB"))
    for change in ({}, {"pixel_texture": None}):  # coordinates of the colours, and of the raster position
        of_one, of_all = (
            execute_ideal((STORED, replace(drawn, **change)), SIZE, SIZE).color for drawn in (one, large)
        )
        found = of_one.any(axis=-1)
        assert found.sum() == 1
        assert (of_one[found] == of_all[found]).all()


def test_sums_beyond_one_are_kept():
    frame = (
        Clear(label="c", color=(0.75, 0.5, 0.25, 1.0), accumulation=(0.5, 0.0, 0.0, 0.0)),
        Accum(label="a", operation=AccumOperation.ACCUM, value=3.0),
        Accum(label="r", operation=AccumOperation.RETURN),
    )
    assert execute_ideal(frame, 2, 2).color[0, 0].tolist() == [2.75, 1.5, 0.75, 3.0]


def test_nothing_is_drawn_from_an_invalid_position_guided_or_not():
    outside = RasterPosition(position=(2.0, 0.0, 0.0, 1.0))
    frame = (
        DrawPixels(label="d", image=IMAGE, position=outside),
        Bitmap(label="b", bits=[[True]], position=AT),
    )
    machine = execute(frame, OCTANE, SIZE, SIZE, record=True)
    for guide in (None, machine):
        color = execute_ideal(frame, SIZE, SIZE, guide=guide).color
        assert color.any(axis=-1).sum() == 1
