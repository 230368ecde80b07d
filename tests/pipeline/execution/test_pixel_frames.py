"""Frames of Draws, rectangles of pixels, copies and sums, in every buffer: equal to the specification."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import (
    Accum,
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
    BaseFormat,
    BlendFactor,
    ColorBuffer,
    ComparisonFunction,
    PixelCopyType,
    PixelTexGenMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
)
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.profiles import OCTANE
from fixedpipe.pipeline.state import (
    Blending,
    ColorTable,
    DepthTest,
    PassState,
    PixelTexture,
    RasterPosition,
    Sampler,
    StencilTest,
    TextureEnvironment,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import Texture, texture_2d
from tests.support.run_reference import run_reference

WIDTH, HEIGHT, DEPTH_BITS = 8, 8, 24
rng = np.random.default_rng(11)
TABLE = TexImage(label="t", texture="table", image=texture_2d(rng.integers(0, 256, (8, 8, 4), np.uint8)))
LAYERS = rng.integers(0, 256, (4, 2, 2, 4), np.uint8)
VOLUME = TexImage(
    label="v",
    texture="volume",
    image=Texture(TextureTarget.TEXTURE_3D, TABLE.image.internal_format, (LAYERS,)),
)
BEGIN = (
    TABLE,
    VOLUME,
    DrawPixels(
        label="a picture to begin with",
        image=PixelImage(rng.integers(0, 256, (8, 8, 4), np.uint8)),
        position=RasterPosition(window=True),
    ),
)
buffers = st.sampled_from([ColorBuffer.BACK, ColorBuffer.AUX0])
unit = st.floats(0, 1)
blendings = st.none() | st.builds(
    Blending,
    source=st.sampled_from([BlendFactor.ONE, BlendFactor.DST_COLOR, BlendFactor.SRC_ALPHA]),
    destination=st.sampled_from([BlendFactor.ZERO, BlendFactor.ONE, BlendFactor.ONE_MINUS_SRC_ALPHA]),
)


def state_of(texture, blending, buffer, tested):
    """A state whose unit replaces colours by ``texture``'s, or has none."""
    sampler = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR)
    environment = TextureEnvironment(TextureEnvironmentMode.REPLACE)
    units = () if texture is None else (TextureUnit(texture, sampler, environment=environment),)
    return PassState(
        texture_units=units,
        blending=blending,
        draw_buffer=buffer,
        depth_test=DepthTest(ComparisonFunction.LEQUAL) if tested else None,
        stencil_test=StencilTest(ComparisonFunction.NOTEQUAL, 0x55, 0x0F) if tested else None,
    )


plain_states = st.builds(state_of, st.none(), blendings, buffers, st.booleans())
positions = st.builds(
    lambda x, y, z, window: RasterPosition(
        position=(x, y, z, 1.0) if window else (x / 8, y / 8, z, 1.0),
        window=window,
        color=(0.9, 0.5, 0.2, 0.6),
    ),
    st.floats(-2, 8),
    st.floats(-2, 8),
    unit,
    st.booleans(),
)
matrix_rows = st.tuples(*[st.floats(-1, 1)] * 4)
transfers = st.just(PixelTransfer()) | st.builds(
    PixelTransfer,
    scale=st.tuples(*[st.floats(0, 2)] * 4),
    bias=st.tuples(*[st.floats(-0.5, 0.5)] * 4),
    color_matrix=st.tuples(*[matrix_rows] * 4),
    post_color_matrix_bias=st.just((0.0,) * 4) | st.just((0.5, 0.5, 0.5, 1.0)),
    color_table=st.none()
    | st.just(ColorTable(tuple((v, v, v, v) for v in (0.0, 0.9, 0.3, 1.0)), BaseFormat.RGB, 8)),
    depth_scale=st.floats(0.5, 1),
    index_offset=st.integers(-9, 9),
)
zooms = st.tuples(*[st.sampled_from([1.0, 0.5, -1.0, 1.75])] * 2)
box = {name: st.integers(0, 4) for name in ("x", "y", "width", "height")}
copies = st.builds(
    CopyPixels,
    label=st.just("copy"),
    **box,
    type=st.sampled_from(PixelCopyType),
    state=plain_states,
    position=positions,
    zoom=zooms,
    transfer=transfers,
    read_buffer=buffers,
)
lookups = st.builds(
    lambda texture, blending, buffer, mode, **fields: CopyPixels(
        label="look up",
        state=state_of(texture, blending, buffer, False),
        pixel_texture=PixelTexture(mode, volumes=2 if texture == "volume" else None),
        **fields,
    ),
    st.sampled_from(["table", "volume"]),
    blendings,
    buffers,
    st.sampled_from(PixelTexGenMode),
    **box,
    position=positions,
    zoom=zooms,
    transfer=transfers,
    read_buffer=buffers,
)
accums = st.builds(
    Accum,
    label=st.just("accumulate"),
    operation=st.sampled_from(AccumOperation),
    value=st.floats(-1, 2),
    read_buffer=buffers,
    draw_buffer=buffers,
)
triangles = st.builds(
    lambda corners, state: Draw(
        label="draw", mesh=Mesh(np.array(corners), colors=np.array([[1.0, 0.2, 0.4, 0.5]] * 3)), state=state
    ),
    st.lists(st.tuples(*[st.sampled_from([-1.0, -0.5, 0.0, 0.5, 1.0])] * 3), min_size=3, max_size=3),
    plain_states,
)
stores = st.builds(
    CopyTexImage,
    label=st.just("store"),
    texture=st.just("table"),
    x=st.integers(0, 4),
    y=st.integers(0, 4),
    width=st.sampled_from([1, 4]),
    height=st.sampled_from([2, 4]),
    read_buffer=buffers,
)
clears = st.builds(
    Clear,
    label=st.just("clear"),
    color=st.tuples(unit, unit, unit, unit),
    depth=st.none() | unit,
    draw_buffer=buffers,
    accumulation=st.none() | st.just((0.5, -0.5, 0.0, 1.0)),
)


@settings(max_examples=60)
@given(st.lists(copies | lookups | accums | triangles | stores | clears, min_size=2, max_size=6))
def test_frames_of_every_kind_are_the_specifications(commands):
    reads = (
        ReadPixels(label="r", name="back"),
        ReadPixels(label="r", name="aux", read_buffer=ColorBuffer.AUX0),
    )
    frame = (*BEGIN, *commands, *reads)
    machine = Machine(OCTANE, WIDTH, HEIGHT, DEPTH_BITS, threads=1)
    result, expected = machine.run(frame), run_reference(frame, OCTANE, WIDTH, HEIGHT, DEPTH_BITS)
    framebuffer = result.framebuffer
    assert framebuffer.color.tolist() == expected.target.color
    assert framebuffer.depth.tolist() == expected.target.depth
    assert framebuffer.stencil.tolist() == expected.target.stencil
    assert {name: read.tolist() for name, read in result.pixels.items()} == expected.pixels
    assert result.undefined == expected.undefined
    sums = framebuffer.accumulation
    assert (None if sums is None else sums.tolist()) == expected.accumulation
