"""Pixel transfer where commands apply it: what is read, defined, copied; techniques; what machines refuse."""

from dataclasses import replace
from fractions import Fraction
from math import floor, inf, nextafter

import numpy as np
import pytest

from fixedpipe.pipeline.commands import (
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    MakeCurrent,
    Mesh,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    TexImage,
)
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import (
    BaseFormat,
    ColorFormat,
    ComparisonFunction,
    ConvolutionBorderMode,
    DepthFormat,
    InternalFormat,
    PrimitiveType,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.framebuffers.transfer import packed_bytes, packed_colors
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.pixel_transfer import (
    INITIAL_TRANSFER,
    ConvolutionFilter,
    Histogram,
    Minmax,
    PixelImage,
    PixelMaps,
    PixelTransfer,
    SeparableFilter,
)
from fixedpipe.pipeline.profiles import (
    GEFORCE_256,
    INFINITE_REALITY,
    NV2A,
    OCTANE,
    OPENGL_1_2,
    OPENGL_1_2_IMAGING,
)
from fixedpipe.pipeline.state import (
    ColorTable,
    DepthTest,
    PassState,
    RasterPosition,
    Sampler,
    TextureEnvironment,
    TextureUnit,
)
from fixedpipe.pipeline.textures.pixel_formats import (
    COMPONENT_TYPES,
    PACKED_TYPES,
    READ_FORMATS,
    packed_formats,
)
from fixedpipe.pipeline.validation.transfer import pixel_image_problem
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.reference import pixel_transfer as reference
from tests.reference import render, texel_formats
from tests.reference import transfer as transfers
from tests.support.run_reference import run_reference

SIZE = 8
IMAGE = PixelImage(np.zeros((4, 4, 4), np.uint8))


def gray(value):
    return (value,) * 4


def box_filter(wide, high, **kwargs):
    weight = gray(1.0 / (wide * high))
    return ConvolutionFilter(((weight,) * wide,) * high, **kwargs)


def reading(transfer=INITIAL_TRANSFER, name="r", **rest):
    return ReadPixels(label="read", name=name, transfer=transfer, **rest)


def loading(pixels=IMAGE, **rest):
    return TexImage(label="load", texture="t", pixels=pixels, **rest)


SWAPPED = PixelTransfer(
    scale=(0.75, 1.0, 1.5, 1.0),
    bias=(0.125, 0.0, -0.25, 0.0),
    color_table=ColorTable(tuple(gray(1 - k / 31) for k in range(32)), BaseFormat.LUMINANCE, 8),
    color_matrix=((0.0, 1.0, 0.0, 0.0), (0.5, 0.0, 0.5, 0.0), (1.0, 0.0, 0.0, -0.125), (0.0, 0.0, 0.0, 1.0)),
    post_color_matrix_bias=(0.0625, 0.0, 0.0, 0.0),
)
BLURRED = replace(SWAPPED, convolution_2d=box_filter(3, 2))


def machine(profile=OPENGL_1_2_IMAGING, **kwargs):
    """A machine whose framebuffer holds noise."""
    made = Machine(profile, SIZE, SIZE, threads=1, **kwargs)
    random = np.random.default_rng(11)
    made.framebuffer.color[...] = random.integers(0, 256, made.framebuffer.color.shape)
    made.framebuffer.depth[...] = random.integers(0, 2**made.framebuffer.depth_bits, (SIZE, SIZE))
    made.framebuffer.stencil[...] = random.integers(0, 256, (SIZE, SIZE))
    return made


def expected_groups(colors, transfer, dimensions=2, clamps=False, one=255):
    """What the specification makes of words [h, w, 4] in units of ``one``, bottom row first."""
    image = [[[Fraction(int(c), one) for c in pixel] for pixel in row] for row in colors.tolist()]
    return reference.transfer(image, transfer, dimensions, clamps, None, None)


def stored(groups, internal_format):
    """Register bytes of groups, a component at a time."""
    base, *bits = texel_formats.FORMATS[internal_format.name]

    def texel(group):
        kept = texel_formats.kept_components(group, base)
        widened = [
            texel_formats.replicate(reference.to_fixed(c, b), b) for c, b in zip(kept, bits, strict=True)
        ]
        return texel_formats.register_components(widened, base)

    return [[texel(group) for group in row] for row in groups]


# --------------------------------------------------------------------------------------------- reading


@pytest.mark.parametrize("pixel_format", READ_FORMATS)
def test_bytes_are_read_as_pixel_transfer_would_give_them(pixel_format):
    """The way without floats equals the specification's: every byte, and sums of three on both sides of 1."""
    red, green = np.meshgrid(np.arange(256), np.arange(256))
    for blue in (0, 1, 100, 255):
        colors = np.stack([red, green, np.full_like(red, blue), red ^ green], -1).astype(np.uint8)
        direct = packed_bytes(colors, pixel_format)
        assert (packed_colors(colors / 255.0, pixel_format, "UNSIGNED_BYTE") == direct).all()


@pytest.mark.parametrize("pixel_type", COMPONENT_TYPES)
@pytest.mark.parametrize("pixel_format", READ_FORMATS)
@pytest.mark.parametrize("transfer", [INITIAL_TRANSFER, SWAPPED, BLURRED], ids=["initial", "matrix", "blur"])
def test_read_pixels_equals_the_specification(transfer, pixel_format, pixel_type):
    made = machine()
    read = ReadPixels(
        label="read",
        name="r",
        format=pixel_format,
        x=1,
        y=2,
        width=6,
        height=5,
        type=pixel_type,
        transfer=transfer,
    )
    found = made.run((read,)).pixels["r"]
    groups = expected_groups(made.framebuffer.color[::-1][2:7, 1:7], transfer)
    expected = [
        [reference.component_read(group, pixel_format, pixel_type) for group in row] for row in groups
    ]
    assert found.reshape(*np.shape(expected)).tolist() == expected
    assert found.dtype == COMPONENT_TYPES[pixel_type]


def words_of(kind, shape):
    """Noise of a NumPy type."""
    limits = np.iinfo(kind)
    return np.random.default_rng(3).integers(limits.min, limits.max, shape, kind, endpoint=True)


TYPED = {
    "BYTE": PixelImage(words_of("int8", (4, 4, 4))),
    "SHORT": PixelImage(words_of("int16", (4, 4, 3)), "BGR"),
    "INT": PixelImage(words_of("int32", (4, 4)), "LUMINANCE"),
    **{
        f"{name} {pixel_format}": PixelImage(words_of(kind.word, (4, 4)), pixel_format, name)
        for name, kind in PACKED_TYPES.items()
        for pixel_format in packed_formats(name)
    },
}


@pytest.mark.parametrize("name", TYPED)
def test_signed_and_packed_images_are_drawn_and_stored_as_the_specification_says(name):
    transfer = PixelTransfer(scale=(0.75, 1.0, 1.5, 1.0), bias=(0.25, 0.0, -0.25, 0.0))
    commands = [loading(TYPED[name])]
    for across, state in enumerate((INITIAL_TRANSFER, transfer)):
        where = RasterPosition(position=(4.0 * across, 0.0, 0.0, 1.0), window=True)
        commands.append(DrawPixels(label="draw", image=TYPED[name], position=where, transfer=state))
    for kind in PACKED_TYPES:
        commands.append(reading(name=kind, format=packed_formats(kind)[0], type=kind))
    made = execute(commands, OPENGL_1_2_IMAGING, SIZE, SIZE, threads=1)
    expected = run_reference(commands, OPENGL_1_2_IMAGING, SIZE, SIZE, 24)
    assert made.framebuffer.color.tolist() == expected.target.color
    assert [level.tolist() for level in made.textures["t"].levels] == expected.textures["t"].levels
    for kind in PACKED_TYPES:
        assert made.pixels[kind].tolist() == expected.pixels[kind]
    ideal = execute_ideal(commands, SIZE, SIZE).image().astype(int)
    assert np.abs(ideal - made.image()).max() <= 1


def test_layers_depths_and_indices_may_be_signed_or_packed():
    faces = PixelImage(words_of("uint16", (6, 4, 4)), "RGB", "UNSIGNED_SHORT_5_6_5")
    cube = loading(faces, target=TextureTarget.TEXTURE_CUBE_MAP)
    levels = execute((cube,), NV2A, SIZE, SIZE).textures["t"].levels
    first = [[reference.unpacked(word, faces.packed) for word in row] for row in faces.values[5].tolist()]
    red = [[reference.to_fixed(red, 8) for red, _, _ in row] for row in first]
    assert levels[0][5, ..., 0].tolist() == red
    where = RasterPosition(window=True)
    depths, stencil = words_of("int16", (4, 4)), words_of("int8", (4, 4))
    always = PassState(depth_test=DepthTest(ComparisonFunction.ALWAYS))
    commands = (
        DrawPixels(label="depths", image=PixelImage(depths, "DEPTH_COMPONENT"), position=where, state=always),
        DrawPixels(label="stencil", image=PixelImage(stencil, "STENCIL_INDEX"), position=where),
    )
    made = execute(commands, OPENGL_1_2, 4, 4).framebuffer
    meant = [[reference.component(d, 16, True) for d in row] for row in depths.tolist()]
    most = 2**made.depth_bits - 1
    assert made.depth[::-1].tolist() == [
        [reference.nearest(reference.clamp(float(d)) * most) for d in row] for row in meant
    ]
    assert (made.stencil[::-1] == stencil.view(np.uint8)).all()


@pytest.mark.parametrize("transfer", [INITIAL_TRANSFER, SWAPPED, BLURRED], ids=["initial", "matrix", "blur"])
def test_twelve_bits_are_read_and_copied_whole(transfer):
    made = machine(OCTANE, color_bits=12)
    made.framebuffer.color[...] = np.random.default_rng(5).integers(0, 4096, (SIZE, SIZE, 4))
    result = made.run(
        (
            ReadPixels(label="words", name="w", type="UNSIGNED_SHORT", transfer=transfer),
            ReadPixels(label="bytes", name="b", transfer=transfer),
            CopyTexImage(
                label="copy",
                texture="t",
                width=4 + 2 * (transfer is BLURRED),
                height=4 + (transfer is BLURRED),
                internal_format=InternalFormat.RGBA12,
                transfer=transfer,
            ),
        )
    )
    groups = expected_groups(made.framebuffer.color[::-1], transfer, clamps=True, one=4095)
    for name, bits in (("w", 16), ("b", 8)):
        expected = [[[reference.to_fixed(c, bits) for c in group] for group in row] for row in groups]
        assert result.pixels[name].tolist() == expected
    copied = [[[reference.to_fixed(c, 12) for c in group] for group in row[:4]] for row in groups[:4]]
    assert result.textures["t"].bits == 12
    assert result.textures["t"].levels[0][0].tolist() == copied


def test_the_bytes_of_a_narrow_pbuffer_go_through_pixel_transfer():
    made = Machine(NV2A, SIZE, SIZE, threads=1)
    current = MakeCurrent(label="pbuffer", surface="p", width=4, height=4, color_format=ColorFormat.R5G6B5)
    color = Clear(label="colour", color=(0.3, 0.6, 0.9, 0.2))
    transfer = PixelTransfer(scale=gray(0.5), bias=gray(0.25))
    read = ReadPixels(label="read", name="r", transfer=transfer)
    result = made.run((current, color, read))
    expected = expected_groups(result.surfaces["p"].color[::-1], transfer)
    assert result.pixels["r"].tolist() == [
        [[reference.to_fixed(c, 8) for c in group] for group in row] for row in expected
    ]


def test_depths_and_stencil_values_are_read_through_their_own_operations():
    made = machine(INFINITE_REALITY, samples=1)
    transfer = PixelTransfer(
        depth_scale=1.5,
        depth_bias=-0.25,
        index_shift=-2,
        index_offset=3,
        map_stencil=True,
        maps=PixelMaps(s_to_s=tuple(300 - k for k in range(16))),
        scale=gray(0.0),  # takes no part
    )
    pixels = made.run(
        (
            ReadPixels(label="depths", name="d", format="DEPTH_COMPONENT", transfer=transfer),
            ReadPixels(label="stencil", name="s", format="STENCIL_INDEX", transfer=transfer),
        )
    ).pixels
    most = 2**23 - 1
    depths = made.framebuffer.depth[::-1].tolist()
    assert pixels["d"].tolist() == [
        [reference.to_fixed(reference.transfer_depth(float(d) / most, transfer), 23) for d in row]
        for row in depths
    ]
    stencil = made.framebuffer.stencil[::-1].tolist()
    assert pixels["s"].tolist() == [
        [reference.stencil_index(s, transfer) & 255 for s in row] for row in stencil
    ]


# ------------------------------------------------------------------------------------- texture images


@pytest.mark.parametrize(
    "internal_format", [InternalFormat.RGBA8, InternalFormat.R5_G6_B5, InternalFormat.ALPHA4]
)
@pytest.mark.parametrize(("transfer", "width", "height"), [(SWAPPED, 8, 4), (BLURRED, 10, 5)])
def test_tex_image_of_pixels_equals_the_specification(transfer, width, height, internal_format):
    pixels = np.random.default_rng(4).integers(0, 256, (height, width, 4), np.uint8)
    command = TexImage(
        label="load",
        texture="t",
        pixels=PixelImage(pixels),
        internal_format=internal_format,
        transfer=transfer,
    )
    texture = machine().run((command,)).textures["t"]
    assert texture.levels[0].shape == (1, 4, 8, 4)  # what convolution leaves is a power of two
    assert texture.levels[0][0].tolist() == stored(expected_groups(pixels, transfer), internal_format)


def test_a_tex_image_of_pixels_has_every_level_and_face_and_layer():
    faces = np.random.default_rng(4).random((6, 4, 4, 3))
    commands = (
        TexImage(
            label="cube map",
            texture="c",
            target=TextureTarget.TEXTURE_CUBE_MAP,
            pixels=PixelImage(faces, "RGB"),
            internal_format=InternalFormat.RGB8,
            transfer=PixelTransfer(scale=gray(0.5)),
            generate_mipmap=True,
        ),
    )
    cube = machine(NV2A).run(commands).textures["c"]
    assert [level.shape for level in cube.levels] == [(6, 4, 4, 4), (6, 2, 2, 4), (6, 1, 1, 4)]
    assert (cube.levels[0][..., :3] == np.floor(faces * 0.5 * 255 + 0.5)).all()
    volume = TexImage(
        label="volume",
        texture="v",
        target=TextureTarget.TEXTURE_3D,
        pixels=PixelImage(faces[:2, ..., 0], "ALPHA"),
        internal_format=InternalFormat.ALPHA8,
        transfer=PixelTransfer(convolution_2d=box_filter(3, 3)),  # is not applied to volumes
    )
    volume = replace(volume, generate_mipmap=True)
    part = CopyTexSubImage(label="the last level", texture="v", width=1, height=1, level=2)
    levels = machine().run((volume, part)).textures["v"].levels
    assert [level.shape for level in levels] == [(2, 4, 4, 4), (1, 2, 2, 4), (1, 1, 1, 4)]
    found = levels[0]
    assert (found[..., 3] == np.floor(faces[:2, ..., 0] * 255 + 0.5)).all()


def test_colour_indices_become_colours_on_their_way_to_a_texture():
    maps = PixelMaps(i_to_r=(0.0, 1.0, 0.5, 0.25), i_to_g=(0.0, 1.0), i_to_b=(0.5,), i_to_a=(1.0,))
    transfer = PixelTransfer(index_shift=-4, maps=maps, scale=gray(0.0))  # the scale is for components
    indices = (np.arange(16, dtype=np.uint8) * 16).reshape(4, 4)
    command = TexImage(
        label="load", texture="t", pixels=PixelImage(indices, "COLOR_INDEX"), transfer=transfer
    )
    found = execute((command,), OPENGL_1_2, SIZE, SIZE).textures["t"].levels[0][0]
    assert found[..., 0].ravel().tolist() == [0, 255, 128, 64] * 4
    assert found[..., 1].ravel().tolist() == [0, 255] * 8
    assert (found[..., 2:] == [128, 255]).all()


def test_copies_into_textures_equal_the_specification():
    made = machine()
    line = ConvolutionFilter(
        ((gray(0.25), gray(0.5), gray(0.25)),), border_mode=ConvolutionBorderMode.REPLICATE_BORDER
    )
    transfer = replace(BLURRED, convolution_1d=line)
    commands = (
        CopyTexImage(label="2D", texture="a", x=0, y=1, width=6, height=5, transfer=transfer),
        CopyTexImage(
            label="1D", texture="b", target=TextureTarget.TEXTURE_1D, y=3, height=1, transfer=transfer
        ),
        CopyTexSubImage(
            label="part", texture="a", x=2, y=2, width=4, height=3, x_offset=1, y_offset=2, transfer=transfer
        ),
    )
    colors = made.framebuffer.color[::-1].copy()
    textures = made.run(commands).textures
    whole = stored(expected_groups(colors[1:6, 0:6], transfer), InternalFormat.RGBA8)
    part = stored(expected_groups(colors[2:5, 2:6], transfer), InternalFormat.RGBA8)
    assert np.shape(whole) == (4, 4, 4)
    assert np.shape(part) == (2, 2, 4)
    found = np.array(whole)
    found[2:4, 1:3] = part
    assert (textures["a"].levels[0][0] == found).all()
    row = stored(expected_groups(colors[3:4], transfer, dimensions=1), InternalFormat.RGBA8)
    assert textures["b"].levels[0][0].tolist() == row


def test_a_depth_buffer_is_copied_into_a_depth_texture():
    made = machine(INFINITE_REALITY, samples=1)
    commands = (
        CopyTexImage(label="whole", texture="s", internal_format=InternalFormat.DEPTH_COMPONENT16),
        CopyTexSubImage(
            label="nearer", texture="s", width=2, height=1, transfer=PixelTransfer(depth_scale=0.5)
        ),
    )
    texture = made.run(commands).textures["s"]
    words = texture.levels[0][0].copy().view("<u4")[..., 0]
    depths = made.framebuffer.depth[::-1] / (2**23 - 1)
    expected = np.floor(depths * 65535 + 0.5)
    expected[0, :2] = np.floor(depths[0, :2] * 0.5 * 65535 + 0.5)
    assert (words == expected).all()


@pytest.mark.parametrize("depth_format", [InternalFormat.DEPTH_COMPONENT16, InternalFormat.DEPTH_COMPONENT24])
@pytest.mark.parametrize("depth_bits", [16, 24])
def test_depth_textures_are_the_specification_s(depth_format, depth_bits):
    """Defined by the host, by a copy of the depth buffer, and by a copy into a part of one."""
    random = np.random.default_rng(7)
    corners = np.concatenate([random.uniform(-1.5, 1.5, (9, 2)), random.uniform(-1.0, 1.0, (9, 1))], axis=1)
    room = PixelImage(random.random((SIZE, SIZE)), "DEPTH_COMPONENT")
    half = PixelTransfer(depth_scale=0.5, depth_bias=0.1)
    part = {"x_offset": 3, "y_offset": 1, "x": 1, "y": 2, "width": 4, "height": 5}
    commands = (
        Clear(label="clear", depth=0.9),
        Draw(label="draw", mesh=Mesh(positions=corners), state=PassState(depth_test=DepthTest())),
        TexImage(label="define", texture="a", pixels=room, internal_format=depth_format, transfer=half),
        CopyTexSubImage(label="copy into it", texture="a", **part),
        CopyTexImage(label="copy", texture="b", internal_format=depth_format, transfer=half),
    )
    made = execute(commands, NV2A, SIZE, SIZE, depth_bits=depth_bits)
    expected = run_reference(commands, NV2A, SIZE, SIZE, depth_bits)
    for name in "ab":
        found = made.textures[name].levels[0][0]
        assert found.tolist() == expected.textures[name].levels[0][0]
        assert len(np.unique(found.reshape(-1, 4), axis=0)) > 10


# ---------------------------------------------------------------------------- histograms, minmaxes, sinks


def test_histograms_and_minmaxes_persist_from_run_to_run():
    made = machine()
    transfer = PixelTransfer(
        histogram=Histogram("levels", 256), minmax=Minmax("range", BaseFormat.LUMINANCE_ALPHA)
    )
    read = ReadPixels(label="count", name="r", transfer=transfer)
    first = made.run((read,))
    colors = made.framebuffer.color.reshape(-1, 4)
    counts = np.stack([np.bincount(colors[:, k], minlength=256) for k in range(4)], -1)
    assert (first.histograms["levels"].counts == counts).all()
    extremes = first.minmaxes["range"].extremes
    assert extremes.tolist() == [
        [colors[:, k].min() / 255 for k in (0, 3)],
        [colors[:, k].max() / 255 for k in (0, 3)],
    ]
    second = made.run((read,))
    assert (second.histograms["levels"].counts == 2 * counts).all()
    assert (first.histograms["levels"].counts == counts).all()  # a Result is not changed afterwards
    third = made.run(
        (ResetHistogram(label="empty", name="levels"), ResetMinmax(label="forget", name="range"))
    )
    assert not third.histograms["levels"].counts.any()
    assert third.minmaxes["range"].extremes.tolist() == [[np.inf] * 2, [-np.inf] * 2]


SINKS = [{"histogram": Histogram("h", sink=True)}, {"minmax": Minmax("m", sink=True)}]


@pytest.mark.parametrize("sink", SINKS)
def test_a_sink_leaves_nothing_to_read_and_no_texel_behind(sink):
    transfer = PixelTransfer(**sink)
    result = machine().run(
        (
            loading(PixelImage(np.zeros((4, 4, 4), np.uint8))),
            loading(PixelImage(np.full((4, 4, 4), 255, np.uint8)), transfer=transfer),
            CopyTexSubImage(label="sunk too", texture="t", width=4, height=4, transfer=transfer),
            reading(transfer),
        )
    )
    assert not result.textures["t"].levels[0].any()
    assert not result.pixels


def noise(*shape):
    return PixelImage(np.random.default_rng(8).integers(0, 256, shape, np.uint8))


# What defines a texture without a sink, and what then defines it again with one: the faces or layers, height
# and width of each level that this leaves.
VOLUME, CUBE = {"target": TextureTarget.TEXTURE_3D}, {"target": TextureTarget.TEXTURE_CUBE_MAP}
RGB8 = {"internal_format": InternalFormat.RGB8}
REDUCED = PixelTransfer(convolution_2d=box_filter(5, 1))
SUNK = {
    "another size and format": ((noise(4, 4, 4), {}), (noise(8, 8, 4), RGB8), [(1, 8, 8)]),
    "another format": ((noise(4, 4, 4), {}), (noise(4, 4, 4), RGB8), [(1, 4, 4)]),
    "the same": ((noise(4, 4, 4), RGB8), (noise(4, 4, 4), RGB8), [(1, 4, 4)]),
    "more levels": (
        (noise(4, 4, 4), {}),
        (noise(4, 4, 4), {"generate_mipmap": True}),
        [(1, 4, 4), (1, 2, 2), (1, 1, 1)],
    ),
    "fewer levels": ((noise(4, 4, 4), {"generate_mipmap": True}), (noise(4, 4, 4), {}), [(1, 4, 4)]),
    "nothing before": (None, (noise(4, 2, 4), {}), [(1, 4, 2)]),
    "what convolution leaves": ((noise(4, 4, 4), {}), (noise(4, 8, 4), {"transfer": REDUCED}), [(1, 4, 4)]),
    "another target": (
        (noise(1, 4, 4), {}),
        (noise(1, 4, 4), {"target": TextureTarget.TEXTURE_1D}),
        [(1, 1, 4)],
    ),
    "a volume": ((noise(2, 4, 4, 4), VOLUME), (noise(4, 4, 4, 4), VOLUME), [(4, 4, 4)]),
    "a copy": ((noise(4, 4, 4), {}), (None, {"width": 2, "height": 4, **RGB8}), [(1, 4, 2)]),
    "a copy of the same": ((noise(4, 4, 4), RGB8), (None, {"width": 4, "height": 4, **RGB8}), [(1, 4, 4)]),
}


@pytest.mark.parametrize("sink", SINKS)
@pytest.mark.parametrize("case", SUNK)
def test_a_sink_leaves_a_texture_of_the_size_and_format_that_was_asked_for(case, sink):
    first, (pixels, asked), sizes = SUNK[case]
    commands = () if first is None else (loading(first[0], **first[1]),)
    before = execute(commands, OPENGL_1_2_IMAGING, SIZE, SIZE).textures.get("t")
    asked = {**asked, "transfer": replace(asked.get("transfer", INITIAL_TRANSFER), **sink)}
    copy = pixels is None
    sunk = CopyTexImage(label="copy", texture="t", **asked) if copy else loading(pixels, **asked)
    before = before and render.plain_texture(before)
    expected = transfers.sunk_levels(before, sunk.target, sunk.internal_format, sizes)
    found = execute((*commands, sunk), OPENGL_1_2_IMAGING, SIZE, SIZE).textures["t"]
    ideal = execute_ideal((*commands, sunk), SIZE, SIZE).textures["t"]
    for texture in (found, ideal):
        assert (texture.target, texture.internal_format) == (sunk.target, sunk.internal_format)
        assert [level.tolist() for level in texture.levels] == expected
    assert [(level * 255).round().tolist() for level in ideal.ideal] == expected


def test_a_texture_that_a_sink_left_can_be_copied_into():
    transfer = PixelTransfer(**SINKS[0])
    made = machine()
    sunk = CopyTexImage(label="sunk", texture="u", transfer=transfer)
    part = CopyTexSubImage(label="part", texture="u", width=2, height=1)
    texels = made.run((sunk, part)).textures["u"].levels[0][0]
    assert (texels[0, :2] == made.framebuffer.color[-1, :2]).all()
    assert not texels[1:].any()
    assert not texels[0, 2:].any()


# ------------------------------------------------------------------------------- halves of bytes, exactly

BYTES = np.repeat(np.arange(256, dtype=np.uint8).reshape(16, 16)[..., None], 4, -1)
FRACTIONS = [
    (399 / 256, -0.28125),
    (0.5, 0.0),
    (0.75, 0.25),
    (1.5, 0.0),
    (-1.0, 1.0),
    (0.25, 0.25),
    (3.0, -1.0),
    (float(np.float32(0.3)), float(np.float32(0.1))),
]


def exactly(word, scale, bias, size):
    """Which of ``size`` entries a byte finds, in real numbers, halves up."""
    value = min(max(Fraction(word, 255) * Fraction(scale) + Fraction(bias), 0), 1)
    return floor(value * (size - 1) + Fraction(1, 2))


def entries_found(transfer, run):
    """What the numbered entries of a map or table make of all bytes, [256]: their numbers over 255."""
    texture = run((loading(PixelImage(BYTES), transfer=transfer),)).textures["t"]
    return (texture.ideal[0][0, ..., 0].ravel() * 255).round().astype(int).tolist()


def by_machine(commands):
    return execute(commands, OPENGL_1_2_IMAGING, SIZE, SIZE, threads=1)


def by_ideal(commands):
    return execute_ideal(commands, SIZE, SIZE)


@pytest.mark.parametrize("run", [by_machine, by_ideal])
@pytest.mark.parametrize(("scale", "bias"), FRACTIONS)
def test_every_byte_finds_the_entry_that_it_finds_in_real_numbers(scale, bias, run):
    transfer = PixelTransfer(scale=gray(scale), bias=gray(bias))
    for size in (2, 3, 16, 86, 103, 151, 154, 171, 239, 256):
        numbered = tuple(k / 255 for k in range(size))
        maps = PixelMaps(r_to_r=numbered, g_to_g=numbered, b_to_b=numbered, a_to_a=numbered)
        expected = [exactly(word, scale, bias, size) for word in range(256)]
        assert entries_found(replace(transfer, map_color=True, maps=maps), run) == expected
    for size in (2, 16, 256):
        table = ColorTable(tuple(gray(k / 255) for k in range(size)))
        expected = [exactly(word, scale, bias, size) for word in range(256)]
        for name in ("color_table", "post_convolution_color_table", "post_color_matrix_color_table"):
            assert entries_found(replace(transfer, **{name: table}), run) == expected


@pytest.mark.parametrize(("scale", "bias"), FRACTIONS)
def test_every_byte_becomes_the_byte_that_it_becomes_in_real_numbers(scale, bias):
    """Drawn, read, copied, and counted: the final conversion, and a histogram's."""
    histogram = Histogram("h", 256)
    transfer = PixelTransfer(scale=gray(scale), bias=gray(bias))
    where = RasterPosition(window=True)
    commands = (
        DrawPixels(label="bytes", image=PixelImage(BYTES), position=where),
        ReadPixels(label="read", name="r", transfer=replace(transfer, histogram=histogram)),
        CopyTexImage(label="copy", texture="t", transfer=transfer),
        CopyPixels(label="move", position=where, transfer=transfer),
    )
    result = execute(commands, OPENGL_1_2_IMAGING, 16, 16, threads=1)
    expected = np.array([exactly(word, scale, bias, 256) for word in range(256)])
    for found in (result.pixels["r"], result.textures["t"].levels[0][0], result.image()[::-1]):
        assert (found[..., 0].ravel() == expected).all()
    counts = np.bincount(expected, minlength=256)
    assert (result.histograms["h"].counts == counts[:, None]).all()


def test_a_half_of_a_byte_goes_up():
    """136/255 times 399/256, less 0.28125, is 82.5 of 150."""
    numbered = tuple(k / 255 for k in range(151))
    maps = PixelMaps(r_to_r=numbered, g_to_g=numbered, b_to_b=numbered, a_to_a=numbered)
    transfer = PixelTransfer(scale=gray(399 / 256), bias=gray(-0.28125), map_color=True, maps=maps)
    assert entries_found(transfer, by_machine)[136] == 83


# --------------------------------------------------------------------- convolution that leaves nothing


@pytest.mark.parametrize(("wide", "high"), [(SIZE + 1, 1), (1, SIZE + 1), (11, 11)])
@pytest.mark.parametrize("color_bits", [8, 12])
def test_what_convolution_leaves_nothing_of_is_null_and_no_error(wide, high, color_bits):
    """It is not drawn, copied or read, and nobody counts it (OpenGL 1.2.1, p. 105)."""
    transfer = PixelTransfer(
        convolution_2d=box_filter(wide, high), histogram=Histogram("h", 4), minmax=Minmax("m")
    )
    where = RasterPosition(window=True)
    before = (Clear(label="clear", color=(0.2, 0.4, 0.6, 0.8)), loading(noise(4, 4, 4)))
    null = (
        DrawPixels(label="draw", image=IMAGE, position=where, transfer=transfer),
        CopyPixels(label="move", position=where, transfer=transfer),
        CopyTexSubImage(label="part", texture="t", width=4, height=4, transfer=transfer),
        reading(transfer),
    )
    left = expected_groups(np.zeros((SIZE, SIZE, 4)), replace(transfer, histogram=None, minmax=None))
    assert not any(left)
    profile = OCTANE if color_bits == 12 else OPENGL_1_2_IMAGING
    for run in (
        lambda commands: execute(commands, profile, SIZE, SIZE, color_bits=color_bits, threads=1),
        lambda commands: execute_ideal(commands, SIZE, SIZE),
    ):
        as_before, after = run(before), run((*before, *null))
        assert (after.image() == as_before.image()).all()
        assert (after.textures["t"].levels[0] == as_before.textures["t"].levels[0]).all()
        assert after.pixels["r"].shape == (max(SIZE - high + 1, 0), max(SIZE - wide + 1, 0), 4)
        assert not after.pixels["r"].size
        assert not after.histograms["h"].counts.any()
        assert after.minmaxes["m"].extremes.tolist() == [[np.inf] * 4, [-np.inf] * 4]


# ------------------------------------------------------------------------------------------- techniques


def sphere_normals(size):
    """Unit normals of a sphere that fills a picture, float64 [size, size, 3]."""
    x, y = np.meshgrid(*[(np.arange(size) + 0.5) / size * 2 - 1] * 2)
    inside = x * x + y * y <= 0.98
    z = np.sqrt(np.where(inside, 1 - x * x - y * y, 0.0))
    normals = np.stack([np.where(inside, x, 0), np.where(inside, y, 0), np.where(inside, z, 1)], -1)
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def dot_product_with(vector, **rest):
    """Colours that hold (n + 1)/2, alpha 1, become n . vector in every component (A-K08)."""
    x, y, z = vector
    row = (2.0 * x, 2.0 * y, 2.0 * z, -(x + y + z))
    return PixelTransfer(color_matrix=(row, row, row, row), **rest)


NORMALS = sphere_normals(32)
NORMAL_MAP = np.concatenate([np.floor((NORMALS + 1) / 2 * 255 + 0.5), np.full((32, 32, 1), 255)], -1).astype(
    np.uint8
)
LIGHT = (0.6, 0.48, 0.64)
ENCODED = {"post_color_matrix_scale": gray(0.5), "post_color_matrix_bias": gray(0.5)}


def loaded(transfer, profile=OCTANE, pixels=NORMAL_MAP):
    """Red of the texture that the normal map becomes, [32, 32] bytes."""
    command = TexImage(label="load", texture="t", pixels=PixelImage(pixels), transfer=transfer)
    return execute((command,), profile, SIZE, SIZE).textures["t"].levels[0][0, ..., 0]


@pytest.mark.parametrize("profile", [OCTANE, OPENGL_1_2_IMAGING], ids=lambda p: p.name)
def test_the_colour_matrix_gives_normal_dot_light(profile):
    """Kautz, Seidel 2000, sections 4.2 and 5: a normal map through the colour matrix, to rounding."""
    cosine = NORMALS @ np.array(LIGHT)
    error = 3 / 255  # of three components of the map, half a step each, times 2 times |light| <= 1.72 / 2
    assert np.abs(loaded(dot_product_with(LIGHT), profile) / 255 - np.maximum(cosine, 0)).max() < error
    assert np.abs(loaded(dot_product_with(LIGHT, **ENCODED), profile) / 255 * 2 - 1 - cosine).max() < error


def test_without_the_encoding_negative_dot_products_are_lost():
    """P15: d^2 by a table after the matrix. With (d + 1)/2 both signs of d are there, without it one."""
    size = 256
    squares = tuple(gray((2 * k / (size - 1) - 1) ** 2) for k in range(size))
    encoded = dot_product_with((1.0, 0.0, 0.0), **ENCODED, post_color_matrix_color_table=ColorTable(squares))
    plain = tuple(gray((k / (size - 1)) ** 2) for k in range(size))
    omitted = dot_product_with((1.0, 0.0, 0.0), post_color_matrix_color_table=ColorTable(plain))
    with_encoding, without = loaded(encoded) / 255.0, loaded(omitted) / 255.0
    meant = NORMALS[..., 0] ** 2
    assert np.abs(with_encoding - meant).max() < 0.02
    right, left = without[:, 16:], without[:, :16]
    assert np.abs(right - meant[:, 16:]).max() < 0.02
    assert not left.any()  # half of the highlight
    assert with_encoding[:, :16].max() > 0.9


def test_the_octane_keeps_no_signed_result_of_the_colour_matrix():
    """Kautz, Seidel 2000, section 5. What follows the clamp is all that sees it: a minmax."""
    least = {}
    for profile in (OCTANE, OPENGL_1_2_IMAGING):
        transfer = dot_product_with(LIGHT, minmax=Minmax("m"))
        command = TexImage(label="load", texture="t", pixels=PixelImage(NORMAL_MAP), transfer=transfer)
        least[profile.name] = execute((command,), profile, SIZE, SIZE).minmaxes["m"].extremes[0, 0]
    assert least[OCTANE.name] == 0
    assert least[OPENGL_1_2_IMAGING.name] < -0.5


@pytest.mark.parametrize(
    "matrix",
    [
        {},
        {"color_matrix": (gray(0.25),) * 4},
        {"post_color_matrix_scale": (1.0, 1.0, 1.0, 2.0)},
        {"post_color_matrix_bias": (0.0, 0.25, 0.0, 0.0)},
    ],
    ids=["none", "matrix", "scale", "bias"],
)
def test_the_octane_clamps_where_a_state_asks_for_a_matrix_alone(matrix):
    """0.75 with a bias of 0.5 after convolution is 1.25 to a minmax, where no matrix follows."""
    transfer = PixelTransfer(
        convolution_2d=box_filter(1, 1), post_convolution_bias=gray(0.5), minmax=Minmax("m"), **matrix
    )
    command = loading(PixelImage(np.full((4, 4, 4), 0.75)), transfer=transfer)
    found = execute((command,), OCTANE, SIZE, SIZE).minmaxes["m"].extremes
    extremes = reference.new_extremes(transfer.minmax)
    reference.transfer([[gray(0.75)]], transfer, 2, True, None, extremes)
    assert found.tolist() == extremes
    assert found.max() == (1.0 if matrix else 1.25)


@pytest.mark.parametrize("base_format", BaseFormat)
def test_a_texture_color_table_acts_between_the_filter_and_the_environment(base_format):
    """Every byte through a table of 64 entries, drawn by the machine, and by the ideal."""
    texels = np.stack([np.arange(256), np.arange(255, -1, -1), np.arange(256) // 2, np.arange(256)], -1)
    image = texels.reshape(16, 16, 4).astype(np.uint8)
    entries = tuple((k / 63, (63 - k) / 70, abs(k - 31) / 40, 1 - k / 100) for k in range(64))
    table = ColorTable(entries, base_format, 8)
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    mesh = Mesh(corners, PrimitiveType.QUADS, texture_coordinates=((corners + 1) / 2,))
    unit = TextureUnit(
        "t",
        Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST),
        environment=TextureEnvironment(TextureEnvironmentMode.REPLACE),
        color_table=table,
    )
    commands = (
        TexImage(label="load", texture="t", pixels=PixelImage(image)),
        Draw(label="draw", mesh=mesh, state=PassState(texture_units=(unit,))),
    )
    found = execute(commands, OCTANE, 16, 16, threads=1).framebuffer.color[::-1]
    expected = [[reference.texture_color(texel, 255, table) for texel in row] for row in image.tolist()]
    assert found.tolist() == expected
    assert np.abs(execute_ideal(commands, 16, 16).color[::-1] * 255 - found).max() <= 0.5 + 1e-9


# ------------------------------------------------------------------------------------------------ ideal


@pytest.mark.parametrize("transfer", [SWAPPED, BLURRED], ids=["matrix", "blur"])
def test_the_ideal_differs_by_rounding_alone(transfer):
    transfer = replace(transfer, color_table=None, minmax=Minmax("m"))
    image = PixelImage(np.random.default_rng(2).random((5, 10, 4)))
    commands = (
        Clear(label="color", color=(0.2, 0.4, 0.6, 1.0)),
        ReadPixels(label="read", name="r", transfer=transfer, type="FLOAT"),
        TexImage(label="load", texture="t", pixels=image, transfer=replace(BLURRED, color_table=None)),
        CopyTexImage(label="copy", texture="c", transfer=INITIAL_TRANSFER),
        CopyTexSubImage(label="part", texture="c", width=5, height=4, x_offset=2, transfer=transfer),
    )
    ideal, real = execute_ideal(commands, SIZE, SIZE), execute(commands, OPENGL_1_2_IMAGING, SIZE, SIZE)
    half = 0.5 / 255 + 1e-12
    assert (
        np.abs(np.clip(ideal.pixels["r"], 0, 1) - real.pixels["r"]).max() <= 2 * half
    )  # the matrix doubles it
    for name in ("t", "c"):
        meant = np.clip(ideal.textures[name].ideal[0], 0, 1)
        error = np.abs(meant - real.textures[name].levels[0] / 255)
        assert error.max() <= (half if name == "t" else 3 * half)
    assert np.abs(ideal.minmaxes["m"].extremes - real.minmaxes["m"].extremes).max() <= 2 * half


def test_the_ideal_copies_depths_and_reads_stencil_values():
    transfer = PixelTransfer(depth_scale=0.5, index_offset=2)
    commands = (
        Clear(label="clear", depth=0.7, stencil=9),
        CopyTexImage(
            label="copy", texture="d", internal_format=InternalFormat.DEPTH_COMPONENT24, transfer=transfer
        ),
        CopyTexSubImage(label="part", texture="d", width=1, height=1),
        ReadPixels(label="d", name="d", format="DEPTH_COMPONENT", transfer=transfer),
        ReadPixels(label="s", name="s", format="STENCIL_INDEX", transfer=transfer),
    )
    ideal = execute_ideal(commands, SIZE, SIZE)
    assert ideal.textures["d"].ideal[0][0, 1, 1].tolist() == [0.35] * 4
    assert ideal.textures["d"].ideal[0][0, 0, 0].tolist() == [0.7] * 4
    assert (ideal.pixels["d"] == 0.35).all()
    assert (ideal.pixels["s"] == 11).all()


def test_the_ideal_has_sinks_and_resets_too():
    transfer = PixelTransfer(histogram=Histogram("h", 4, sink=True), minmax=Minmax("m"))
    read = ReadPixels(label="read", name="r", transfer=transfer)
    copy = CopyTexImage(label="copy", texture="t", transfer=transfer)
    ideal = execute_ideal((read, copy), SIZE, SIZE)
    assert ideal.histograms["h"].counts.tolist() == [[2 * SIZE * SIZE] * 4] + [[0] * 4] * 3
    assert not ideal.pixels
    assert not ideal.textures["t"].ideal[0].any()
    again = execute_ideal((read, ResetHistogram(label="empty", name="h")), SIZE, SIZE)
    assert not again.histograms["h"].counts.any()


# ---------------------------------------------------------------------------------------------- refusals

TABLE = ColorTable((gray(0.0), gray(1.0)))


REFUSED = {
    "no color matrix": (
        OPENGL_1_2,
        reading(PixelTransfer(color_matrix=(gray(0.0),) * 4)),
        ["sets color_matrix", "OpenGL 1.2 has no colour matrix", "imaging subset"],
    ),
    "no post color matrix": (
        OPENGL_1_2,
        reading(PixelTransfer(post_color_matrix_bias=gray(0.5))),
        ["sets post_color_matrix_bias", "no colour matrix"],
    ),
    "no color tables": (
        OPENGL_1_2,
        reading(PixelTransfer(color_table=TABLE)),
        ["no colour tables", "map_color"],
    ),
    "no convolution": (
        GEFORCE_256,
        reading(PixelTransfer(convolution_2d=box_filter(3, 3))),
        ["GeForce 256 has no convolution"],
    ),
    "no histogram": (OPENGL_1_2, reading(PixelTransfer(histogram=Histogram("h"))), ["no histogram"]),
    "no minmax": (
        OPENGL_1_2,
        loading(transfer=PixelTransfer(minmax=Minmax("m"))),
        ["sets minmax", "no minmax"],
    ),
    "not a number": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(scale=(1.0, float("nan"), 1.0, 1.0))),
        ["transfer.scale[1] is nan", "finite"],
    ),
    "too large": (OPENGL_1_2, reading(PixelTransfer(bias=gray(1e30))), ["bias is", "2**32"]),
    "too large a depth scale": (
        OPENGL_1_2,
        reading(PixelTransfer(depth_scale=1e30)),
        ["depth_scale", "2**32"],
    ),
    "too large a matrix": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(color_matrix=(gray(1e20),) * 4)),
        ["color_matrix", "2**32"],
    ),
    "shift": (OPENGL_1_2, reading(PixelTransfer(index_shift=32)), ["index_shift is 32", "-31 to 31"]),
    "empty map": (
        OPENGL_1_2,
        reading(PixelTransfer(maps=PixelMaps(r_to_r=()))),
        ["r_to_r has 0", "1 to 256"],
    ),
    "long map": (
        OPENGL_1_2,
        reading(PixelTransfer(maps=PixelMaps(a_to_a=(0.0,) * 257))),
        ["a_to_a has 257", "1 to 256"],
    ),
    "index map": (
        OPENGL_1_2,
        reading(PixelTransfer(maps=PixelMaps(s_to_s=(0, 1, 2)))),
        ["s_to_s has 3", "power of two"],
    ),
    "large map": (OPENGL_1_2, reading(PixelTransfer(maps=PixelMaps(i_to_g=(1e20,)))), ["i_to_g", "2**32"]),
    "table size": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(post_convolution_color_table=ColorTable((gray(0.0),) * 3))),
        ["post_convolution_color_table has 3", "power of two"],
    ),
    "table too long": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(post_color_matrix_color_table=ColorTable((gray(0.0),) * 8192))),
        ["has 8192", "up to 4096"],
    ),
    "table bits": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(color_table=replace(TABLE, bits=17))),
        ["keeps 17 bits", "1 to 16"],
    ),
    "empty filter": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(convolution_2d=ConvolutionFilter(()))),
        ["convolution_2d has 0x0", "at least 1x1"],
    ),
    "ragged filter": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(convolution_2d=ConvolutionFilter(((gray(0.0),) * 2, (gray(0.0),))))),
        ["different lengths", "2 pixels"],
    ),
    "high line": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(convolution_1d=box_filter(2, 2))),
        ["convolution_1d has 2 rows", "one"],
    ),
    "filter too large": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(separable_2d=SeparableFilter((gray(0.0),) * 12, (gray(0.0),)))),
        ["separable_2d has 12x1", "11x11"],
    ),
    "large weight": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(convolution_2d=ConvolutionFilter(((gray(1e20),),)))),
        ["convolution_2d holds", "2**32"],
    ),
    "nothing left of an image": (
        OPENGL_1_2_IMAGING,
        loading(transfer=PixelTransfer(convolution_2d=box_filter(5, 1))),
        ["5x1 filter with REDUCE", "4x4", "a null texture", "Leave the unit None", "REPLICATE_BORDER"],
    ),
    "nothing left of a line": (
        OPENGL_1_2_IMAGING,
        CopyTexImage(
            label="copy",
            texture="t",
            target=TextureTarget.TEXTURE_1D,
            height=1,
            transfer=PixelTransfer(convolution_1d=box_filter(9, 1)),
        ),
        ["9x1 filter with REDUCE", "8x1", "a null texture"],
    ),
    "nothing to copy": (
        OPENGL_1_2_IMAGING,
        CopyTexImage(label="copy", texture="t", width=0, transfer=REDUCED),
        ["0x8 texels", "at least 1x1"],
    ),
    "histogram format": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(histogram=Histogram("h", base_format=BaseFormat.INTENSITY))),
        ["histogram's base format is INTENSITY", "LUMINANCE"],
    ),
    "minmax format": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(minmax=Minmax("m", BaseFormat.INTENSITY))),
        ["minmax's base format is INTENSITY"],
    ),
    "histogram width": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(histogram=Histogram("h", 100))),
        ["has 100 entries", "power of two"],
    ),
    "histogram too wide": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(histogram=Histogram("h", 8192))),
        ["has 8192", "4096"],
    ),
    "histogram without a name": (
        OPENGL_1_2_IMAGING,
        reading(PixelTransfer(histogram=Histogram(" "))),
        ["transfer.histogram.name is empty"],
    ),
    "unknown histogram": (
        OPENGL_1_2_IMAGING,
        ResetHistogram(label="reset", name="h"),
        ["no histogram 'h' yet", "none"],
    ),
    "unknown minmax": (OPENGL_1_2_IMAGING, ResetMinmax(label="reset", name="m"), ["no minmax 'm' yet"]),
    "read type": (OPENGL_1_2, reading(type="DOUBLE"), ["no type 'DOUBLE'", "UNSIGNED_SHORT"]),
    "read packed": (
        OPENGL_1_2,
        reading(type="UNSIGNED_SHORT_5_6_5"),
        ["UNSIGNED_SHORT_5_6_5 holds groups of RGB", "format is RGBA"],
    ),
    "packed type": (
        OPENGL_1_2,
        loading(PixelImage(IMAGE.values, packed="BYTE")),
        ["packed type is 'BYTE'", "UNSIGNED_BYTE_3_3_2", "None"],
    ),
    "packed format": (
        OPENGL_1_2,
        loading(PixelImage(IMAGE.values[..., 0], "RGB", "UNSIGNED_INT_8_8_8_8")),
        ["RGBA or BGRA", "format is RGB"],
    ),
    "packed words": (
        OPENGL_1_2,
        loading(PixelImage(IMAGE.values[..., 0], packed="UNSIGNED_INT_8_8_8_8")),
        ["words are uint8", ".astype(np.uint32)"],
    ),
    "packed shape": (
        OPENGL_1_2,
        loading(PixelImage(IMAGE.values, "RGB", "UNSIGNED_BYTE_3_3_2")),
        ["UNSIGNED_BYTE_3_3_2 image has shape (4, 4, 4)", "[height, width]"],
    ),
    "depth type": (OPENGL_1_2, reading(format="DEPTH_COMPONENT", type="FLOAT"), ["own units", "leave type"]),
    "float depths": (
        NV2A,
        reading(PixelTransfer(depth_scale=2.0), format="DEPTH_COMPONENT"),
        ["scales depths", "FLOAT_24", "fixed"],
    ),
    "copied float depths": (
        NV2A,
        CopyTexImage(label="copy", texture="t", internal_format=InternalFormat.DEPTH_COMPONENT24),
        ["copies depths", "FLOAT_24"],
    ),
    "neither": (OPENGL_1_2, loading(None), ["neither an image nor pixels"]),
    "image format": (
        OPENGL_1_2,
        loading(PixelImage(IMAGE.values, "HILO")),
        ["format is 'HILO'", "LUMINANCE"],
    ),
    "stencil image": (
        OPENGL_1_2,
        loading(PixelImage(IMAGE.values[..., 0], "STENCIL_INDEX")),
        ["format is 'STENCIL_INDEX'"],
    ),
    "image shape": (
        OPENGL_1_2,
        loading(PixelImage(IMAGE.values, "RGB")),
        ["(4, 4, 4)", "[height, width, 3]"],
    ),
    "flat image": (OPENGL_1_2, loading(PixelImage(IMAGE.values[0, 0], "RED")), ["(4,)", "[height, width]"]),
    "empty image": (
        OPENGL_1_2,
        loading(PixelImage(np.zeros((0, 4, 4)))),
        ["(0, 4, 4)", "at least one pixel"],
    ),
    "image of NaN": (OPENGL_1_2, loading(PixelImage(np.full((4, 4, 4), np.nan))), ["NaN", "finite"]),
    "wide image": (OPENGL_1_2, loading(PixelImage(np.zeros((4, 4, 4), np.int64))), ["int64", "uint8"]),
    "image of words": (OPENGL_1_2, loading(PixelImage([["a", "b"]], "RED")), ["<U1", "uint8"]),
    "signed indices": (
        OPENGL_1_2,
        loading(PixelImage(np.zeros((4, 4), np.int64), "COLOR_INDEX")),
        ["indices are int64", "uint32"],
    ),
    "no cube map": (
        NV2A,
        loading(PixelImage(np.zeros((5, 4, 4, 4))), target=TextureTarget.TEXTURE_CUBE_MAP),
        ["5 layers", "6 faces"],
    ),
    "high 1D texture": (OPENGL_1_2, loading(target=TextureTarget.TEXTURE_1D), ["one row of texels", "has 4"]),
    "oblong cube map": (
        NV2A,
        loading(PixelImage(np.zeros((6, 2, 4, 4))), target=TextureTarget.TEXTURE_CUBE_MAP),
        ["4x2", "square"],
    ),
    "mipmapped depths": (
        NV2A,
        loading(
            PixelImage(np.zeros((4, 4)), "DEPTH_COMPONENT"),
            internal_format=InternalFormat.DEPTH_COMPONENT24,
            generate_mipmap=True,
        ),
        ["DEPTH_COMPONENT24", "not generated"],
    ),
    "what convolution leaves is no power of two": (
        OPENGL_1_2_IMAGING,
        loading(transfer=PixelTransfer(convolution_2d=box_filter(2, 1))),
        ["3x4", "powers of two"],
    ),
    "words are not made from pixels": (
        NV2A,
        loading(internal_format=InternalFormat.COLOR_INDEX8),
        ["COLOR_INDEX8", "not made from pixels"],
    ),
    "colours are no depths": (
        NV2A,
        loading(internal_format=InternalFormat.DEPTH_COMPONENT24),
        ["'RGBA'", "DEPTH_COMPONENT"],
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_misuse_is_refused_in_a_sentence(case):
    profile, command, words = REFUSED[case]
    bits = {"depth_bits": DepthFormat.FLOAT_24} if "float depths" in case else {}
    with pytest.raises(UnsupportedState) as error:
        execute((command,), profile, SIZE, SIZE, **bits)
    message = str(error.value)
    assert message.startswith('Command 0, "')
    assert message.endswith(".")
    for word in words:
        assert word in message, message


def test_a_pixel_transfer_that_one_machine_takes_is_refused_by_the_next():
    """Each machine checks it once, and one that refused it refuses it again."""
    transfer = PixelTransfer(post_color_matrix_scale=gray(0.5))
    command = TexImage(label="load", texture="t", pixels=PixelImage(np.ones((1, 1, 4))), transfer=transfer)
    for _ in range(2):
        validate((command,), OCTANE, 8, 8)
        with pytest.raises(UnsupportedState, match="sets post_color_matrix_scale; GeForce 256 has no colour"):
            validate((command,), GEFORCE_256, 8, 8)
    beyond = replace(transfer, post_color_matrix_bias=(0.0, 0.0, -(2.0**32), nextafter(2.0**32, inf)))
    for _ in range(2):
        with pytest.raises(UnsupportedState, match=r"post_color_matrix_bias is .*magnitudes up to"):
            validate((replace(command, transfer=beyond),), OCTANE, 8, 8)


@pytest.mark.parametrize("dtype", ["float16", "float32", "float64"])
def test_an_image_is_refused_for_one_number_that_is_too_large(dtype):
    """Few large numbers, many that are smaller, and none."""
    kind = np.finfo(dtype)
    most = min(2.0**32, float(kind.max))
    values = np.zeros((32, 32, 4), dtype)
    for taken in (0.0, 1.0, 2.0**15, -most, most):
        for where in ((3, 4, 1), ...):
            values[:] = 0
            values[where] = taken
            assert pixel_image_problem(PixelImage(values)) is None
    beyond = [] if kind.max <= most else [np.nextafter(kind.dtype.type(most), kind.max), kind.max]
    for refused in (np.nan, np.inf, -np.inf, *beyond):
        values[:] = 0
        values[3, 4, 1] = refused
        assert "give finite, smaller values" in pixel_image_problem(PixelImage(values))


def test_both_an_image_and_pixels_are_refused():
    texture = machine().run((loading(),)).textures["t"]
    with pytest.raises(UnsupportedState, match="an image and pixels"):
        machine().run((loading(image=texture),))


# ------------------------------------------------------------------------------------------- description


def test_a_pixel_transfer_is_described_by_what_differs():
    transfer = PixelTransfer(
        scale=gray(2.0),
        map_color=True,
        maps=PixelMaps(g_to_g=(1.0, 0.0)),
        color_table=ColorTable(tuple(gray(k / 7) for k in range(8)), BaseFormat.LUMINANCE, 4),
        convolution_2d=ConvolutionFilter(
            ((gray(1.0), gray(2.0)),), BaseFormat.RGB, ConvolutionBorderMode.CONSTANT_BORDER, gray(0.5)
        ),
        separable_2d=SeparableFilter((gray(1.0),), (gray(3.0),)),
        color_matrix=(gray(0.25),) * 4,
        histogram=Histogram("levels", sink=True),
    )
    text = describe(
        (reading(transfer, type="FLOAT"), loading(), ResetHistogram(label="empty", name="levels"))
    )
    for words in (
        "RGBA as FLOAT of the whole framebuffer",
        "pixel transfer: scale (2, 2, 2, 2), MAP_COLOR enabled, COLOR matrix [0.25",
        "PIXEL_MAP: G_TO_G (1, 0)",
        "COLOR_TABLE enabled: 8 LUMINANCE entries of 4 bits, (0, 0, 0, 0) to (1, 1, 1, 1)",
        "CONVOLUTION_2D enabled: RGB, CONSTANT_BORDER (0.5, 0.5, 0.5, 0.5)",
        "row 0 [1 1 1 1 | 2 2 2 2]",
        "SEPARABLE_2D enabled: RGBA, REDUCE",
        "column [3 3 3 3]",
        'HISTOGRAM enabled: name "levels", width 256, base format RGBA, sink enabled',
        'texture "t": TEXTURE_2D, RGBA8, from 4x4 pixels, RGBA uint8',
        'histogram "levels" becomes empty',
    ):
        assert words in text


def test_half_floats_are_taken_and_infinite_ones_refused():
    def frame(value):
        image = PixelImage(np.full((2, 2, 4), value, np.float16))
        return (DrawPixels(label="d", image=image, position=RasterPosition(window=True)),)

    with np.errstate(all="raise"):
        assert execute(frame(65504.0), OPENGL_1_2, 2, 2).image().min() == 255
        with pytest.raises(UnsupportedState, match="holds NaN, infinity"):
            execute(frame(np.inf), OPENGL_1_2, 2, 2)
