"""DrawPixels, CopyPixels and Bitmap: fragments, zooms and raster positions equal to the specification, and
what is refused.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Bitmap, CopyPixels, DrawPixels, TexImage, vertex_of
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import (
    BaseFormat,
    BlendFactor,
    ColorBuffer,
    ComparisonFunction,
    FogMode,
    PixelCopyType,
    PixelFragmentSource,
    PixelTexGenAlpha,
    PixelTexGenMode,
    PixelTexGenQ,
    StencilOperation,
    TexGenMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
    VertexStage,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A, OCTANE, OPENGL_1_2
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    ColorTable,
    DepthTest,
    Fog,
    Light,
    Lighting,
    PassState,
    PixelTexture,
    RasterPosition,
    Sampler,
    Scissor,
    StencilTest,
    TexGen,
    TextureEnvironment,
    TextureUnit,
    VertexState,
    Viewport,
    WindowClip,
)
from fixedpipe.pipeline.textures.images import Texture, texture_2d
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.raster.pixels.rectangles import covered
from tests.reference import depth, pixel_rectangles, render

WIDTH, HEIGHT, DEPTH_BITS = 7, 6, 16
IDENTITY_POSITION = RasterPosition(window=True)
rng = np.random.default_rng(5)
BYTES = rng.integers(0, 256, (HEIGHT, WIDTH, 4), np.uint8)
DEPTHS = rng.integers(0, 2**DEPTH_BITS, (HEIGHT, WIDTH)).astype(np.uint32)
STENCIL = rng.integers(0, 256, (HEIGHT, WIDTH), np.uint8)
FLAT = texture_2d(rng.integers(0, 256, (8, 16, 4), np.uint8))
VOLUME = Texture(
    TextureTarget.TEXTURE_3D, FLAT.internal_format, (rng.integers(0, 256, (8, 4, 4, 4), np.uint8),)
)
TEXTURES = {"flat": FLAT, "volume": VOLUME}

unit = st.floats(0, 1)
colors = st.tuples(unit, unit, unit, unit)
# Most examples cover several pixels; test_each_pixel_belongs_to_the_group_that_covers_it has the extremes.
zooms = st.tuples(*[st.sampled_from([1.0, 2.0, 1.5, 3.25, 0.75]) | st.sampled_from([-1.5, 0.5])] * 2)
places = st.sampled_from([0.0, 0.5, 1.0, 2.25, 3.9999]) | st.floats(-2, 5)


extremes = places | st.sampled_from([-1.5, 6.5, -3e30])


def rarely(strategy):
    """None three times of four."""
    return st.integers(0, 3).flatmap(lambda k: strategy if k == 3 else st.none())


masks = rarely(st.builds(ColorMask, *[st.booleans()] * 4)).map(lambda mask: mask or ColorMask())
functions = st.sampled_from(ComparisonFunction)
boxes = st.builds(
    Scissor, x=st.integers(-2, 5), y=st.integers(-2, 5), width=st.integers(0, 8), height=st.integers(0, 8)
)
samplers = st.builds(
    Sampler,
    min_filter=st.sampled_from([TextureFilter.NEAREST, TextureFilter.LINEAR]),
    mag_filter=st.sampled_from([TextureFilter.NEAREST, TextureFilter.LINEAR]),
    wrap_s=st.sampled_from([WrapMode.REPEAT, WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE]),
    wrap_t=st.sampled_from([WrapMode.REPEAT, WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE]),
    wrap_r=st.sampled_from([WrapMode.REPEAT, WrapMode.CLAMP, WrapMode.CLAMP_TO_EDGE]),
    border_color=colors,
)
units = st.builds(
    TextureUnit,
    texture=st.sampled_from(sorted(TEXTURES)),
    sampler=samplers,
    environment=st.builds(
        TextureEnvironment,
        mode=st.sampled_from(
            [TextureEnvironmentMode.MODULATE, TextureEnvironmentMode.REPLACE, TextureEnvironmentMode.DECAL]
        ),
    ),
)
operations = st.sampled_from(
    [StencilOperation.KEEP, StencilOperation.INCR, StencilOperation.INVERT, StencilOperation.REPLACE]
)
states = st.builds(
    PassState,
    texture_units=st.just(()) | units.map(lambda u: (u,)),
    fog=rarely(st.builds(Fog, mode=st.just(FogMode.LINEAR), end=st.floats(1, 4), color=colors)),
    scissor=rarely(boxes),
    alpha_test=rarely(st.builds(AlphaTest, function=functions, reference=unit)),
    depth_test=st.none() | st.builds(DepthTest, function=functions, write=st.booleans()),
    stencil_test=rarely(
        st.builds(
            StencilTest,
            function=functions,
            reference=st.integers(0, 255),
            write_mask=st.integers(0, 255),
            fail=operations,
            depth_fail=operations,
            depth_pass=operations,
        )
    ),
    blending=rarely(
        st.builds(
            Blending,
            source=st.sampled_from([BlendFactor.ONE, BlendFactor.SRC_ALPHA, BlendFactor.DST_COLOR]),
            destination=st.sampled_from([BlendFactor.ZERO, BlendFactor.ONE, BlendFactor.SRC_COLOR]),
        )
    ),
    color_mask=masks,
    vertex=st.sampled_from([VertexState(), VertexState(viewport=Viewport(near=0.75, far=0.25))]),
)
vectors = st.tuples(
    st.floats(-1.1, 1.1), st.floats(-1.1, 1.1), st.floats(0, 1), st.sampled_from([1.0, 2.0, 0.5])
)
near = st.floats(-1.5, 1.5)
sets = st.tuples(st.tuples(near, near, near, st.sampled_from([1.0, 0.5, 0.0, -1.0])))
in_window = st.builds(
    RasterPosition,
    position=st.tuples(places, places, st.sampled_from([0.0, 0.5, 1.5, -0.5]) | unit, st.just(1.0)),
    window=st.just(True),
    move=st.sampled_from([(0.0, 0.0), (0.25, -1.0), (-0.5, 0.75)]),
    color=colors,
    secondary_color=colors,
    texture_coordinates=sets,
)
positions = (
    in_window
    | in_window
    | st.builds(
        RasterPosition,
        position=vectors,
        move=st.sampled_from([(0.0, 0.0), (-1.5, -2.0)]),
        color=colors,
        secondary_color=colors,
        texture_coordinates=sets,
    )
)


def machine_with_contents(profile=OCTANE):
    machine = Machine(profile, WIDTH, HEIGHT, DEPTH_BITS, threads=1)
    framebuffer = machine.framebuffer
    framebuffer.color[:], framebuffer.depth[:], framebuffer.stencil[:] = BYTES, DEPTHS, STENCIL
    machine.textures.update(TEXTURES)
    return machine


def target_with_contents():
    contents = (plane.tolist() for plane in (BYTES, DEPTHS, STENCIL))
    return render.Target(WIDTH, HEIGHT, DEPTH_BITS, *contents)


def check_equal(command, groups, *, words=False, profile=OCTANE):
    """Run a command by the machine and by the specification. ``groups``: after pixel transfer."""
    machine, target = machine_with_contents(profile), target_with_contents()
    result = machine.run((command,))
    state, position = command.state, command.position
    if position.window:
        raster = pixel_rectangles.given_position(position, state, profile)
    else:
        mesh = vertex_of(position)
        raster = pixel_rectangles.raster_position(mesh, position, state, profile, WIDTH, HEIGHT)
    textures = {name: render.plain_texture(texture) for name, texture in TEXTURES.items()}
    undefined = 0
    if raster is not None:
        arguments = target, groups, raster, command
        kind = "bits" if isinstance(command, Bitmap) else words
        if kind == "stencil":
            pixel_rectangles.draw_stencil(*arguments)
        elif kind == "depth":
            pixel_rectangles.draw_depths(*arguments, textures, profile)
        elif kind == "bits":
            pixel_rectangles.draw_bitmap(*arguments, textures, profile)
        else:
            undefined = pixel_rectangles.draw_colors(*arguments, textures, profile)
    framebuffer = result.framebuffer
    assert framebuffer.color.tolist() == target.color
    assert framebuffer.depth.tolist() == target.depth
    assert framebuffer.stencil.tolist() == target.stencil
    assert result.undefined == undefined
    return result


def images(components, dtype=np.uint8):
    """Arrays of up to 4 x 3 groups."""

    def made(size):
        width, height, seed = size
        values = np.random.default_rng(seed).integers(
            0, np.iinfo(dtype).max, (height, width, components), dtype
        )
        return values if components > 1 else values[..., 0]

    return st.tuples(st.integers(1, 4), st.integers(1, 3), st.integers(0, 10**6)).map(made)


parts = st.tuples(st.integers(0, 3), st.integers(0, 3), st.integers(0, 4), st.integers(0, 3)).map(
    lambda b: dict(zip(("x", "y", "width", "height"), b, strict=True))
)


def read(plane, box):
    x, y = box["x"], box["y"]
    return plane[::-1][y : y + box["height"], x : x + box["width"]].tolist()


# ------------------------------------------------------------------------------------------- equality


@settings(max_examples=100)
@given(images(4), states, positions, zooms)
def test_color_groups_are_drawn_as_specified(image, state, position, zoom):
    command = DrawPixels(label="d", image=PixelImage(image), state=state, position=position, zoom=zoom)
    check_equal(command, image.tolist())


@settings(max_examples=80)
@given(parts, states, positions, zooms, st.sampled_from(PixelCopyType))
def test_copied_groups_are_drawn_as_specified(box, state, position, zoom, kind):
    command = CopyPixels(label="c", state=state, position=position, zoom=zoom, type=kind, **box)
    plane = {PixelCopyType.COLOR: BYTES, PixelCopyType.DEPTH: DEPTHS, PixelCopyType.STENCIL: STENCIL}[kind]
    words = {PixelCopyType.COLOR: False, PixelCopyType.DEPTH: "depth", PixelCopyType.STENCIL: "stencil"}[kind]
    check_equal(command, read(plane, box), words=words)


@settings(max_examples=60)
@given(images(1, np.uint16), states, positions, zooms, st.floats(0, 2), st.floats(-0.5, 0.5))
def test_depth_groups_are_drawn_as_specified(image, state, position, zoom, scale, bias):
    transfer = PixelTransfer(depth_scale=scale, depth_bias=bias)
    picture = PixelImage(image, "DEPTH_COMPONENT")
    command = DrawPixels(
        label="d", image=picture, state=state, position=position, zoom=zoom, transfer=transfer
    )
    groups = [
        [depth.depth_to_units(z / 65535 * scale + bias, DEPTH_BITS) for z in row] for row in image.tolist()
    ]
    check_equal(command, groups, words="depth")


@settings(max_examples=40)
@given(images(1), states, positions, zooms, st.integers(-3, 3), st.integers(-300, 300))
def test_stencil_indices_are_written_as_specified(image, state, position, zoom, shift, offset):
    transfer = PixelTransfer(index_shift=shift, index_offset=offset)
    picture = PixelImage(image, "STENCIL_INDEX")
    command = DrawPixels(
        label="d", image=picture, state=state, position=position, zoom=zoom, transfer=transfer
    )
    shifted = [[(i << shift if shift > 0 else i >> -shift) + offset for i in row] for row in image.tolist()]
    check_equal(command, shifted, words="stencil")


@settings(max_examples=60)
@given(images(1), states, positions, st.tuples(places, places))
def test_bitmaps_are_drawn_as_specified(image, state, position, origin):
    bits = image > 100
    check_equal(Bitmap(label="b", bits=bits, state=state, position=position, origin=origin), bits.tolist())


pixel_textures = (
    st.builds(PixelTexture, mode=st.sampled_from(PixelTexGenMode))
    | st.builds(
        PixelTexture,
        mode=st.none(),
        rgb_source=st.sampled_from(PixelFragmentSource),
        alpha_source=st.sampled_from(PixelFragmentSource),
    )
    | st.builds(
        PixelTexture,
        mode=st.sampled_from(PixelTexGenMode),
        alpha_replace=st.just(True),
        alpha=st.sampled_from(PixelTexGenAlpha),
    )
)
opaque = st.sampled_from([None, 255, 0, 1])


@settings(max_examples=120)
@given(images(4), states, units, positions, zooms, pixel_textures, opaque)
def test_groups_become_texture_coordinates_as_specified(image, state, unit, position, zoom, texture, alpha):
    if alpha is not None:
        image[..., 3] = alpha
    state = replace(state, texture_units=(unit,))
    given = DrawPixels(
        label="d", image=PixelImage(image), state=state, position=position, zoom=zoom, pixel_texture=texture
    )
    check_equal(given, image.tolist())


EVERY_COLOR = [
    *(PixelTexture(mode) for mode in PixelTexGenMode),
    *(PixelTexture(None, rgb, alpha) for rgb in PixelFragmentSource for alpha in PixelFragmentSource),
    *(PixelTexture(alpha_replace=True, alpha=alpha) for alpha in PixelTexGenAlpha),
]


@pytest.mark.parametrize("environment", [TextureEnvironmentMode.MODULATE, TextureEnvironmentMode.DECAL])
@pytest.mark.parametrize("texture", EVERY_COLOR)
def test_a_fragment_has_the_groups_color_or_the_raster_positions(texture, environment):
    image = np.random.default_rng(2).integers(1, 256, (3, 4, 4), np.uint8)
    unit = TextureUnit(
        texture="flat",
        sampler=Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR),
        environment=TextureEnvironment(environment),
    )
    for place, volumes in (("flat", None), ("volume", 4)):
        command = DrawPixels(
            label="d",
            image=PixelImage(image),
            state=PassState(texture_units=(replace(unit, texture=place),)),
            position=replace(IDENTITY_POSITION, color=(0.9, 0.2, 0.6, 0.4)),
            zoom=(1.5, 2.0),
            pixel_texture=replace(texture, volumes=volumes),
        )
        check_equal(command, image.tolist())


@settings(max_examples=20)
@given(images(4), units, st.sampled_from(PixelTexGenQ), st.sampled_from([1, 2, 4, 8]), st.booleans())
def test_q_chooses_a_volume_as_specified(image, unit, q_filter, volumes, replaced):
    unit = replace(unit, texture="volume")
    texture = PixelTexture(volumes=volumes, q_filter=q_filter, alpha_replace=replaced)
    state = PassState(texture_units=(unit,))
    check_equal(
        DrawPixels(
            label="d",
            image=PixelImage(image),
            state=state,
            position=IDENTITY_POSITION,
            zoom=(2.0, 2.0),
            pixel_texture=texture,
        ),
        image.tolist(),
    )


parts_of_window = st.builds(
    Scissor, x=st.integers(-1, 3), y=st.integers(-1, 3), width=st.integers(1, 4), height=st.integers(1, 4)
)
clips = st.builds(
    WindowClip,
    rectangles=st.lists(parts_of_window, min_size=1, max_size=2).map(tuple),
    exclusive=st.booleans(),
)


@settings(max_examples=60)
@given(images(4), states, clips, zooms, st.sampled_from(["bits", "stencil", False]))
def test_the_window_clip_leaves_out_pixels_of_every_kind(image, state, clip, zoom, kind):
    state = replace(state, window_clip=clip, texture_units=())
    fields = {"label": "d", "state": state, "position": IDENTITY_POSITION}
    if kind == "bits":
        bits = image[..., 0] > 99
        check_equal(Bitmap(bits=bits, **fields), bits.tolist(), profile=NV2A)
    elif kind:
        picture = PixelImage(image[..., 0], "STENCIL_INDEX")
        command = DrawPixels(image=picture, zoom=zoom, **fields)
        check_equal(command, image[..., 0].tolist(), words=kind, profile=NV2A)
    else:
        command = DrawPixels(image=PixelImage(image), zoom=zoom, **fields)
        check_equal(command, image.tolist(), profile=NV2A)


LIT = VertexState(
    modelview=((0.9, 0.1, 0.0, 0.05), (-0.1, 0.9, 0.0, 0.1), (0.0, 0.0, 1.0, -0.2), (0.0, 0.0, 0.0, 1.0)),
    viewport=Viewport(1, 1, 5, 4, 0.25, 0.75),
    lighting=Lighting(lights=(Light(position=(0.3, 0.4, 1.0, 0.0)),)),
    clip_planes=((1.0, 0.0, 0.0, 0.5),),
)


@settings(max_examples=80)
@given(images(1), vectors, st.tuples(*[st.floats(-1, 1)] * 3), units)
def test_a_raster_position_is_transformed_lit_and_clipped_as_a_vertex(image, position, normal, unit):
    plane = (0.5, -0.25, 0.0, 0.5)
    gen = (TexGen(TexGenMode.OBJECT_LINEAR, plane), TexGen(TexGenMode.EYE_LINEAR, plane), TexGen(), TexGen())
    state = PassState(vertex=LIT, texture_units=(replace(unit, gen=gen),), depth_test=DepthTest())
    where = RasterPosition(position=position, normal=normal, texture_coordinates=((0.1, 0.2, 0.3, 0.5),))
    bits = image > 60
    check_equal(Bitmap(label="b", bits=bits, state=state, position=where), bits.tolist())


@settings(max_examples=200)
@given(extremes, st.floats(-3, 3) | st.sampled_from([0.0, 0.5, -0.5, 1e308, -1e308]), st.integers(0, 6))
def test_each_pixel_belongs_to_the_group_that_covers_it(origin, zoom, count):
    pixels, groups = covered(origin, zoom, count, -2, 9)
    expected = [
        (p, n) for p in range(-2, 9) for n in range(count) if pixel_rectangles.covers(origin, zoom, n, p)
    ]
    assert list(zip(pixels.tolist(), groups.tolist(), strict=True)) == expected


# ------------------------------------------------------------------------------------------- examples


def test_floats_and_other_formats_become_groups():
    luminance = PixelImage(np.array([[0.5, 2.0, -1.0]]), "LUMINANCE")
    commands = (
        DrawPixels(label="l", image=luminance, position=IDENTITY_POSITION),
        DrawPixels(
            label="16 bits, scaled",
            image=PixelImage(np.array([[[65535, 0, 32768]]], np.uint16), "RGB"),
            position=IDENTITY_POSITION.moved(3, 0),
            transfer=PixelTransfer(scale=(0.5, 1.0, 1.0, 0.25), bias=(0.0, 0.25, 0.0, 0.0)),
        ),
    )
    row = execute(commands, OPENGL_1_2, WIDTH, HEIGHT).framebuffer.color[-1].tolist()
    assert row[:3] == [[128, 128, 128, 255], [255, 255, 255, 255], [0, 0, 0, 255]]
    assert row[3] == [128, 64, 128, 64]


def test_a_copy_reads_all_before_it_writes_any():
    """The picture moves by one pixel, over itself, from one buffer into itself and into another."""
    for buffer in (ColorBuffer.BACK, ColorBuffer.AUX0):
        machine = machine_with_contents()
        command = CopyPixels(
            label="c",
            width=WIDTH - 1,
            state=PassState(draw_buffer=buffer),
            position=IDENTITY_POSITION.moved(1, 0),
        )
        color = machine.run((command,)).framebuffer.buffer(buffer).color
        assert (color[:, 1:] == BYTES[:, :-1]).all()
        assert (color[:, 0] == (BYTES[:, 0] if buffer is ColorBuffer.BACK else 0)).all()


def test_copying_a_framebuffer_onto_itself_changes_nothing():
    machine = machine_with_contents()
    depths_alone = PassState(
        depth_test=DepthTest(ComparisonFunction.ALWAYS), color_mask=ColorMask(*[False] * 4)
    )
    commands = [
        CopyPixels(label="c", type=kind, state=state, position=IDENTITY_POSITION)
        for kind, state in (
            (PixelCopyType.COLOR, PassState()),
            (PixelCopyType.DEPTH, depths_alone),
            (PixelCopyType.STENCIL, PassState()),
        )
    ]
    framebuffer = machine.run(commands).framebuffer
    assert (framebuffer.color == BYTES).all()
    assert (framebuffer.depth == DEPTHS).all()
    assert (framebuffer.stencil == STENCIL).all()


def test_an_invalid_raster_position_draws_nothing_and_counts_nothing():
    image = PixelImage(np.ones((2, 2, 4)))
    outside = DrawPixels(label="d", image=image, position=RasterPosition(position=(1.01, 0.0, 0.0, 1.0)))
    inside = replace(outside, position=RasterPosition(position=(1.0, 0.0, 0.0, 1.0), move=(-2.0, 0.0)))
    assert execute((outside,), OPENGL_1_2, 8, 8).fragments == 0
    assert execute((inside,), OPENGL_1_2, 8, 8).fragments == 4


@pytest.mark.filterwarnings("error")
def test_the_largest_numbers_draw_nothing_or_something_but_end():
    far, image = 1e308, PixelImage(BYTES)
    positions = [
        RasterPosition((far, -far, 0.0, 1.0), True, move=(far, -far)),
        RasterPosition((-far, 0.0, far, 1.0), True, texture_coordinates=((far, -far, 1.0, 5e-324),)),
        RasterPosition((far, far, far, far), move=(far, 0.0)),
        RasterPosition((0.0, 0.0, 0.0, 5e-324)),
    ]
    unit = TextureUnit(texture="flat", sampler=Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR))
    state = PassState(texture_units=(unit,), depth_test=DepthTest(ComparisonFunction.ALWAYS))
    for position in positions:
        position = replace(position, texture_coordinates=position.texture_coordinates or ((0.0,) * 4,))
        for zoom in ((far, -far), (-far, 5e-324)):
            draw = DrawPixels(label="d", image=image, position=position, zoom=zoom, state=state)
            bits = Bitmap(
                label="b", bits=BYTES[..., 0] > 9, position=position, origin=(-far, far), state=state
            )
            machine_with_contents().run((draw, bits))


def test_a_depth_in_the_window_is_clamped_to_the_depth_range():
    state = PassState(
        vertex=VertexState(viewport=Viewport(near=0.75, far=0.25)),
        depth_test=DepthTest(ComparisonFunction.ALWAYS),
    )
    for z, expected in ((1.5, 0.25), (0.5, 0.5), (-1.0, 0.75)):
        bits = Bitmap(
            label="b",
            bits=np.ones((1, 1)) > 0,
            state=state,
            position=RasterPosition((0.0, 0.0, z, 1.0), True),
        )
        framebuffer = execute((bits,), OCTANE, 1, 1, depth_bits=24).framebuffer
        assert framebuffer.depth[0, 0] == np.floor(expected * (2**24 - 1))


def test_replaced_alpha_goes_through_the_texture_color_table():
    """SGIX_impact_pixel_texture: the table scales the group's alpha, here to its complement."""
    table = ColorTable(tuple((0.0, 0.0, 0.0, 1 - k / 255) for k in range(256)), BaseFormat.ALPHA)
    unit = TextureUnit(
        texture="flat",
        sampler=Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST),
        environment=TextureEnvironment(TextureEnvironmentMode.REPLACE),
        color_table=table,
    )
    draw = DrawPixels(
        label="d",
        image=PixelImage(BYTES),
        state=PassState(texture_units=(unit,)),
        position=IDENTITY_POSITION,
        pixel_texture=PixelTexture(alpha_replace=True),
    )
    color = machine_with_contents().run((draw,)).framebuffer.color
    assert (color[::-1, :, 3] == 255 - BYTES[..., 3]).all()


def test_rectangles_are_recorded_traced_and_printed():
    machine = machine_with_contents()
    state = PassState(alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.5), scissor=Scissor(0, 0, 3, 2))
    image = np.zeros((2, 2, 4), np.uint8)
    image[1, 1] = 255
    commands = (
        DrawPixels(
            label="draw", image=PixelImage(image), state=state, position=IDENTITY_POSITION, zoom=(2.0, 1.0)
        ),
        Bitmap(label="bits", bits=np.array([[1, 0], [0, 1]], np.uint8), position=IDENTITY_POSITION),
        CopyPixels(label="copy", type=PixelCopyType.DEPTH, x=1, width=2, position=IDENTITY_POSITION),
    )
    result = machine.run(commands, trace=True, record=True)
    drawn, bits, _ = result.records
    assert drawn.triangle.tolist() == [0, 0, 1, 2, 2, 3]
    assert drawn.x.tolist() == [0, 1, 2] * 2
    assert drawn.y.tolist() == [5] * 3 + [4] * 3
    assert drawn.passed.tolist() == [0] * 5 + [1]
    assert bits.triangle.tolist() == [0, 3]
    assert [s.kind for s in result.trace] == ["DrawPixels", "Bitmap", "CopyPixels"]
    assert result.trace[0].color[4, 2].tolist() == [255] * 4
    assert result.fragments == 6 + 2 + 2 * HEIGHT
    text = describe(commands)
    assert "RGBA image, 2x2 groups, PixelZoom (2, 1)" in text
    assert "raster position (0, 0, 0, 1) in the window" in text
    assert "bitmap, 2x2" in text
    assert "DEPTH of the framebuffer from (1, 0), 2 columns and all rows" in text


def test_twelve_bit_groups_are_twelve_bit_coordinates():
    """4095 values of red look up 4096 texels: each finds its own, but for the last, which wraps."""
    ramp = np.arange(4096)
    texels = np.stack([ramp >> 4, ramp & 15, 0 * ramp, 0 * ramp + 255], -1).astype(np.uint8)
    unit = TextureUnit(
        texture="ramp",
        sampler=Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST, wrap_s=WrapMode.CLAMP_TO_EDGE),
        environment=TextureEnvironment(TextureEnvironmentMode.REPLACE),
    )
    profile = OCTANE.changed(max_texture_size=4096)
    groups = np.zeros((1, 4096, 4), np.uint16)
    groups[0, :, 0], groups[0, :, 3] = np.floor(ramp * 65535 / 4095 + 0.5), 65535
    draw = DrawPixels(
        label="d",
        image=PixelImage(groups),
        state=PassState(texture_units=(unit,)),
        position=IDENTITY_POSITION,
        pixel_texture=PixelTexture(),
    )
    store = TexImage(label="t", texture="ramp", image=texture_2d(texels[None]))
    profile = profile.changed(max_viewport=4096)
    result = execute((store, draw), profile, 4096, 1, color_bits=12)
    found = result.framebuffer.color[0].astype(np.int64)
    assert (found[:, 0] == np.floor((ramp >> 4) * 4095 / 255 + 0.5)).all()
    assert (found[:, 1] == np.floor((ramp & 15) * 4095 / 255 + 0.5)).all()


# -------------------------------------------------------------------------------------------- refusals


IMAGE = PixelImage(np.zeros((2, 3, 4)))
DRAW = DrawPixels(label="d", image=IMAGE, position=IDENTITY_POSITION)
TEXTURED = PassState(texture_units=(TextureUnit(texture="flat", sampler=Sampler(TextureFilter.LINEAR)),))
STORE = TexImage(label="t", texture="flat", image=FLAT)
LOOKUP = replace(DRAW, state=TEXTURED, pixel_texture=PixelTexture())
NAN = float("nan")
REFUSED = [
    (OPENGL_1_2, LOOKUP, "OpenGL 1.2 has no SGIX_pixel_texture"),
    (OPENGL_1_2, replace(LOOKUP, pixel_texture=PixelTexture(mode=None)), "no SGIS_pixel_texture"),
    (
        OCTANE.changed(impact_pixel_texture=False),
        replace(LOOKUP, pixel_texture=PixelTexture(alpha_replace=True)),
        "no SGIX_impact_pixel_texture",
    ),
    (OCTANE, replace(LOOKUP, state=PassState()), "no texture unit is enabled"),
    (OCTANE, replace(LOOKUP, image=PixelImage(np.zeros((2, 2)), "DEPTH_COMPONENT")), "not DEPTH"),
    (
        OCTANE,
        replace(LOOKUP, pixel_texture=PixelTexture(rgb_source=PixelFragmentSource.CURRENT_RASTER_COLOR)),
        "SGIS_pixel_texture's; give mode None",
    ),
    (OCTANE, replace(LOOKUP, pixel_texture=PixelTexture(q_filter=PixelTexGenQ.FLOOR)), "give volumes"),
    (OCTANE, replace(LOOKUP, pixel_texture=PixelTexture(alpha=PixelTexGenAlpha.LS)), "alpha_replace alone"),
    (OCTANE, replace(LOOKUP, pixel_texture=PixelTexture(volumes=0)), "give 1 or more"),
    (OCTANE, replace(LOOKUP, pixel_texture=PixelTexture(volumes=2)), "TEXTURE_2D of 1 layer"),
    (OCTANE, replace(DRAW, zoom=(1.0, NAN)), "zoom\\[1\\] is nan; give a finite number"),
    (OCTANE, replace(DRAW, position=RasterPosition(position=(0.0, NAN, 0.0, 1.0))), "give a finite number"),
    (OCTANE, replace(DRAW, image=PixelImage(np.full((2, 2, 4), NAN))), "NaN"),
    (OCTANE, replace(DRAW, image=PixelImage(np.zeros((2, 2)))), "shape"),
    (OCTANE, replace(DRAW, image=PixelImage(np.zeros((0, 2, 4)))), "at least one pixel"),
    (
        OCTANE.changed(stencil_bits=0),
        replace(DRAW, image=PixelImage(np.zeros((2, 2), np.uint8), "STENCIL_INDEX")),
        "writes the stencil buffer",
    ),
    (OCTANE, CopyPixels(label="c", width=-1), "give sizes that are not negative"),
    (OCTANE, CopyPixels(label="c", x=5, width=4), "reaches outside the framebuffer"),
    (OCTANE, CopyPixels(label="c", read_buffer=ColorBuffer.AUX3), "so no AUX3"),
    (OCTANE, replace(DRAW, state=PassState(draw_buffer=ColorBuffer.AUX3)), "so no AUX3"),
    (OCTANE, Bitmap(label="b", bits=np.zeros((2, 2, 2))), "give \\[height, width\\]"),
    (OCTANE, Bitmap(label="b", bits=np.zeros((0, 2))), "give at least one pixel"),
    (OCTANE, Bitmap(label="b", bits=np.full((1, 2), 2, np.uint8)), "zeros and ones"),
    (OCTANE, Bitmap(label="b", bits=np.full((1, 2), 0.5)), "give booleans"),
    (OCTANE, Bitmap(label="b", bits=[[True]], origin=(NAN, 0.0)), "give a finite number"),
    (
        NV2A,
        replace(DRAW, state=PassState(vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS))),
        "fixed-function vertex stage",
    ),
    (NV2A, replace(DRAW, state=PassState(w_buffering=True)), "has none; give object coordinates"),
    (GEFORCE_256, replace(DRAW, state=replace(TEXTURED, texture_units=TEXTURED.texture_units * 3)), "3"),
]


@pytest.mark.parametrize(("profile", "command", "words"), REFUSED)
def test_what_a_rectangle_cannot_be_is_refused(profile, command, words):
    with pytest.raises(UnsupportedState, match=words):
        validate((STORE, command), profile, 8, 8)


def test_what_stands_beside_the_refused_is_taken():
    volume = replace(TEXTURED.texture_units[0], texture="volume")
    four = replace(
        LOOKUP,
        state=PassState(texture_units=(volume,)),
        pixel_texture=PixelTexture(volumes=2, q_filter=PixelTexGenQ.CEILING, alpha_replace=True),
    )
    stored = TexImage(label="v", texture="volume", image=VOLUME)
    commands = (
        STORE,
        stored,
        LOOKUP,
        four,
        DRAW,
        Bitmap(label="b", bits=[[1]]),
        CopyPixels(label="c", width=0),
    )
    validate(commands, OCTANE, 8, 8)
    execute(commands, OCTANE, 8, 8)
