"""GetTexImage: every format and type beside the specification, what a frame made, what machines refuse."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from fixedpipe.pipeline.commands import (
    BindTexImage,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    DrawPixels,
    GetTexImage,
    HostStep,
    MakeCurrent,
    TexImage,
)
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import BaseFormat, InternalFormat, TextureTarget
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.pixel_transfer import (
    INITIAL_TRANSFER,
    ConvolutionFilter,
    Histogram,
    Minmax,
    PixelImage,
    PixelTransfer,
    SeparableFilter,
)
from fixedpipe.pipeline.profiles import (
    GEFORCE_3,
    INFINITE_REALITY,
    NV2A,
    OCTANE,
    OPENGL_1_2,
    OPENGL_1_2_IMAGING,
)
from fixedpipe.pipeline.state import ColorTable, RasterPosition
from fixedpipe.pipeline.textures.images import (
    COMPONENT_BITS,
    TWELVE_BIT_FORMATS,
    texture_2d,
    texture_cube_map,
)
from fixedpipe.pipeline.textures.pixel_formats import PACKED_TYPES, READ_FORMATS, READ_TYPES, packed_formats
from fixedpipe.pipeline.textures.words import compressed_texture
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.reference import pixel_transfer as reference
from tests.support.run_reference import run_reference

SIZE = 8
TARGETS = [target for target in TextureTarget if target is not TextureTarget.TEXTURE_RECTANGLE]
# As OpenGL 1.1's machines do, with every target and operation.
TRANSFERS = OPENGL_1_2_IMAGING.changed(
    transfers_texture_queries=True,
    texture_targets=frozenset(TARGETS),
    max_cube_map_texture_size=64,
)
# Every byte, each beside others; 256 texels.
BYTES = np.stack([(np.arange(256, dtype=np.uint8).reshape(16, 16) * k) for k in (1, 3, 5, 255)], -1)
NOISE = np.random.default_rng(4).integers(0, 256, (4, 8, 8, 4), np.uint8)
GRAY = ((0.25,) * 4, (0.5,) * 4, (0.125,) * 4)
SCALED = PixelTransfer(
    scale=(0.75, 1.0, 1.5, -1.0),
    bias=(0.125, 0.0, -0.25, 1.0),
    color_table=ColorTable(tuple((1 - k / 31,) * 4 for k in range(32)), BaseFormat.LUMINANCE, 8),
    color_matrix=((0.0, 1.0, 0.0, 0.0), (0.5, 0.0, 0.5, 0.0), (1.0, 0.0, 0.0, -0.125), (0.0, 0.0, 0.0, 1.0)),
)
FILTERED = {
    "none": SCALED,
    "1D": PixelTransfer(convolution_1d=ConvolutionFilter((GRAY,))),
    "2D": replace(SCALED, convolution_2d=ConvolutionFilter((GRAY, GRAY))),
    "separable": PixelTransfer(separable_2d=SeparableFilter(GRAY, GRAY)),
}


def query(name="q", texture="t", **rest):
    return GetTexImage(label="query", name=name, texture=texture, **rest)


def load(pixels, texture="t", **rest):
    return TexImage(label="load", texture=texture, pixels=PixelImage(pixels), **rest)


def every_query(**rest):
    """One of each format and type that go together."""
    return [
        query(f"{form} {kind}", format=form, type=kind, **rest)
        for form in READ_FORMATS
        for kind in READ_TYPES
        if kind not in PACKED_TYPES or form in packed_formats(kind)
    ]


def assert_as_specified(commands, profile=TRANSFERS, depth_bits=24):
    found = execute(commands, profile, SIZE, SIZE, threads=1, depth_bits=depth_bits).pixels
    expected = run_reference(commands, profile, SIZE, SIZE, depth_bits).pixels
    assert found.keys() == expected.keys() and found
    for name, pixels in expected.items():
        assert found[name].reshape(np.shape(pixels)).tolist() == pixels, name


@pytest.mark.parametrize("internal_format", COMPONENT_BITS, ids=lambda f: f.name)
def test_every_byte_format_and_type_of_every_internal_format(internal_format):
    few = [load(BYTES[::5, ::5], "few", internal_format=internal_format), *every_query(texture="few")]
    whole = [load(BYTES, internal_format=internal_format), query("all", type="UNSIGNED_SHORT")]
    assert_as_specified(whole + few, OPENGL_1_2)


@pytest.mark.parametrize("transfer", FILTERED)
@pytest.mark.parametrize("target", TARGETS, ids=lambda t: t.name)
def test_pixels_go_through_transfer_as_the_target_asks(target, transfer):
    """Filters of one dimension for 1D textures alone, of two for 2D ones and faces, none for layers."""
    shape = {
        TextureTarget.TEXTURE_1D: NOISE[0, :1],
        TextureTarget.TEXTURE_2D: NOISE[0],
        TextureTarget.TEXTURE_3D: NOISE[:2],
        TextureTarget.TEXTURE_CUBE_MAP: np.concatenate([NOISE, NOISE[:2] ^ 255]),
    }[target]
    if target in (TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D):
        commands = [load(shape, target=target)]
    elif target is TextureTarget.TEXTURE_3D:
        image = replace(
            texture_cube_map(np.stack([NOISE[0]] * 6)), target=target, levels=(shape,), ideal=None
        )
        commands = [TexImage(label="load", texture="t", image=image)]
    else:
        commands = [TexImage(label="load", texture="t", image=texture_cube_map(shape))]
    face = 5 if target is TextureTarget.TEXTURE_CUBE_MAP else 0
    reads = [query(f, format=f, type="SHORT", transfer=FILTERED[transfer], face=face) for f in READ_FORMATS]
    assert_as_specified([*commands, *reads])


def test_every_level_is_read_in_its_size():
    commands = [TexImage(label="load", texture="t", image=texture_2d(NOISE[0], mipmaps=True))]
    commands += [query(str(level), level=level) for level in range(4)]
    assert_as_specified(commands)
    found = execute(commands, GEFORCE_3, SIZE, SIZE).pixels
    assert [found[str(level)].shape for level in range(4)] == [(8, 8, 4), (4, 4, 4), (2, 2, 4), (1, 1, 4)]


@pytest.mark.parametrize("internal_format", sorted(TWELVE_BIT_FORMATS), ids=lambda f: f.name)
def test_twelve_bits_are_read_whole(internal_format):
    """Of a machine whose texels have twelve bits: the fraction of the bits that the format keeps."""
    values = np.random.default_rng(7).integers(0, 4096, (4, 4, 4)) / 4095.0
    bits = (12, 4) if internal_format is InternalFormat.LUMINANCE12_ALPHA4 else (12,) * 4
    load_reals = load(values, internal_format=internal_format)
    found = execute((load_reals, query(type="UNSIGNED_SHORT")), OCTANE, SIZE, SIZE).pixels["q"]
    name = internal_format.name
    red, green, blue, alpha = (
        [[Fraction(reference.to_fixed(v, n), 2**n - 1) for v in row] for row in values[..., k].tolist()]
        for k, n in enumerate((bits[0], 12, 12, bits[-1] if "LUMINANCE" in name else 12))
    )
    zero, one = ([[Fraction(n)] * 4] * 4 for n in (0, 1))
    if "RGB" not in name:
        green = blue = zero
    if name.startswith("ALPHA"):
        red = zero
    if "A" not in name.removeprefix("LUMINANCE").removeprefix("RGB"):
        alpha = one
    channels = zip(red, green, blue, alpha, strict=True)
    groups = [list(zip(*rows, strict=True)) for rows in channels]
    expected = [[reference.component_read(g, "RGBA", "UNSIGNED_SHORT") for g in row] for row in groups]
    assert found.tolist() == expected


DEPTHS = np.random.default_rng(6).integers(0, 2**32, (8, 8), np.uint32)


@pytest.mark.parametrize("transfer", [INITIAL_TRANSFER, PixelTransfer(depth_scale=1.5, depth_bias=-0.25)])
@pytest.mark.parametrize("bits", [16, 24])
def test_depth_textures_are_read_in_their_own_units(bits, transfer):
    profile = INFINITE_REALITY.changed(depth_bits=(24,), internal_formats=frozenset(InternalFormat))
    internal_format = InternalFormat[f"DEPTH_COMPONENT{bits}"]
    loaded = TexImage(
        label="load",
        texture="t",
        pixels=PixelImage(DEPTHS, "DEPTH_COMPONENT"),
        internal_format=internal_format,
    )
    commands = (loaded, query(format="DEPTH_COMPONENT", transfer=transfer))
    assert_as_specified(commands, profile)
    read = execute(commands, profile, SIZE, SIZE).pixels["q"]
    assert read.dtype == np.uint32
    ideal = execute_ideal(commands, SIZE, SIZE).pixels["q"]
    assert np.abs(ideal - read / (2.0**bits - 1)).max() <= 1 / 2**bits  # each rounds by half a unit, and once


def test_what_the_frame_made_is_read_as_it_is_there_and_then():
    draw = DrawPixels(label="d", image=PixelImage(NOISE[0]), position=RasterPosition(window=True))
    part = CopyTexSubImage(label="part", texture="c", x=3, y=2, width=3, height=2, x_offset=1, y_offset=1)
    commands = [
        draw,
        CopyTexImage(label="copy", texture="c", width=8, height=8, internal_format=InternalFormat.RGB5_A1),
        query("copied", "c"),
        part,
        query("patched", "c"),
        MakeCurrent(label="p", surface="p", width=8, height=8),
        Clear(label="clear", color=(0.25, 0.5, 0.75, 0.125)),
        BindTexImage(label="bind", texture="b", surface="p"),
        query("bound", "b", format="BGRA"),
        load(NOISE[1], "b"),
        query("loaded", "b"),
        query("copied still", "c"),
    ]
    assert_as_specified(commands, NV2A)
    pixels = execute(commands, NV2A, SIZE, SIZE).pixels
    assert (pixels["bound"] == (191, 128, 64, 32)).all()
    assert (pixels["loaded"] == NOISE[1]).all()
    assert (pixels["copied"] != pixels["patched"]).any()
    assert (pixels["copied still"] == pixels["patched"]).all()


def test_a_machine_s_textures_are_read_in_a_later_run():
    machine = Machine(GEFORCE_3, SIZE, SIZE)
    machine.run((load(NOISE[0]),))
    assert (machine.run((query(),)).pixels["q"] == NOISE[0]).all()


@pytest.mark.parametrize("sink", [False, True])
def test_histograms_and_minmaxes_count_every_layer(sink):
    image = replace(
        texture_cube_map(np.stack([NOISE[0]] * 6)),
        target=TextureTarget.TEXTURE_3D,
        levels=(NOISE,),
        ideal=None,
    )
    transfer = PixelTransfer(histogram=Histogram("h", 256, sink=sink), minmax=Minmax("m"))
    commands = (TexImage(label="load", texture="t", image=image), query(transfer=transfer))
    for result in (execute(commands, TRANSFERS, SIZE, SIZE), execute_ideal(commands, SIZE, SIZE)):
        counted = [np.bincount(NOISE[..., k].ravel(), minlength=256) for k in range(4)]
        assert (result.histograms["h"].counts == np.stack(counted, -1)).all()
        assert ("q" in result.pixels, "m" in result.minmaxes) == (not sink, not sink)


def test_the_ideal_reads_real_numbers():
    values = np.random.default_rng(9).uniform(0.0, 1.0, (4, 4, 4))
    for internal_format, kept in (
        (InternalFormat.INTENSITY4, lambda r, g, b, a: (r, 0.0, 0.0, 1.0)),
        (InternalFormat.LUMINANCE6_ALPHA2, lambda r, g, b, a: (r, 0.0, 0.0, a)),
        (InternalFormat.ALPHA8, lambda r, g, b, a: (0.0, 0.0, 0.0, a)),
        (InternalFormat.RGB4, lambda r, g, b, a: (r, g, b, 1.0)),
    ):
        commands = (load(values, internal_format=internal_format), query())
        found = execute_ideal(commands, SIZE, SIZE).pixels["q"]
        assert found.tolist() == [[list(kept(*texel)) for texel in row] for row in values.tolist()]
    doubled = execute_ideal((load(values), query(transfer=PixelTransfer(scale=(2.0,) * 4))), SIZE, SIZE)
    assert (doubled.pixels["q"] == 2.0 * values).all()


def test_a_host_takes_what_was_read():
    def again(read):
        return (load(255 - read["q"], "inverse"), query("r", "inverse"))

    step = HostStep(label="host", reads=("q",), commands=again)
    pixels = execute((load(NOISE[0]), query(), step), GEFORCE_3, SIZE, SIZE).pixels
    assert (pixels["r"] == 255 - NOISE[0]).all()


BLOCKS = compressed_texture(bytes(8), InternalFormat.COMPRESSED_RGBA_S3TC_DXT1, 4, 4)
MOVED = PixelTransfer(bias=(0.5,) * 4)
REFUSED = {
    "no such texture": (query(texture="u"), OPENGL_1_2, "no texture 'u' yet"),
    "no such level": (query(level=1), OPENGL_1_2, "level 1 of 't' does not exist; it has 1"),
    "no such face": (query(face=1), OPENGL_1_2, "face 1 of 't' does not exist; a TEXTURE_2D has face 0 only"),
    "stencil": (query(format="STENCIL_INDEX"), OPENGL_1_2, "GetTexImage knows no format 'STENCIL_INDEX'"),
    "a depth of colours": (query(format="DEPTH_COMPONENT"), OPENGL_1_2, "is RGBA8 .* a format of colours"),
    "a type": (query(type="DOUBLE"), OPENGL_1_2, "GetTexImage knows no type 'DOUBLE'"),
    "a packed type": (query(type="UNSIGNED_SHORT_5_6_5"), OPENGL_1_2, "holds groups of RGB, and the format"),
    "a transfer": (
        query(transfer=MOVED),
        OPENGL_1_2_IMAGING,
        "OpenGL 1.2 with the imaging subset returns .* without one",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_read_is_refused(case):
    command, profile, words = REFUSED[case]
    with pytest.raises(UnsupportedState, match=words):
        execute((load(NOISE[0]), command), profile, SIZE, SIZE)


def test_names_are_taken_once_and_words_without_a_format_are_refused():
    with pytest.raises(UnsupportedState, match="ReadPixels or GetTexImage already has the name 'q'"):
        execute((load(NOISE[0]), query(), query()), OPENGL_1_2, SIZE, SIZE)
    blocks = TexImage(label="load", texture="t", image=BLOCKS)
    with pytest.raises(UnsupportedState, match="COMPRESSED_RGBA_S3TC_DXT1, and GetTexImage has no format"):
        execute((blocks, query()), GEFORCE_3, SIZE, SIZE)


def test_scaled_depths_that_are_floats_are_refused():
    shadow = TexImage(
        label="load",
        texture="t",
        image=replace(
            texture_2d(NOISE[0]), internal_format=InternalFormat.DEPTH_COMPONENT16_FLOAT, ideal=None
        ),
    )
    read = query(format="DEPTH_COMPONENT")
    profile = NV2A.changed(transfers_texture_queries=True)
    found = execute((shadow, read), profile, SIZE, SIZE).pixels["q"]
    assert (found == NOISE[0].view("<u4")[..., 0]).all()
    scaled = replace(read, transfer=PixelTransfer(depth_scale=0.5))
    with pytest.raises(UnsupportedState, match="scales depths of DEPTH_COMPONENT16_FLOAT"):
        execute((shadow, scaled), profile, SIZE, SIZE)


def test_the_description_says_what_is_read():
    text = describe((query(level=1, face=2, format="BGRA", type="SHORT", transfer=MOVED),))
    assert '"q": BGRA as SHORT of texture "t", level 1, face 2' in text
    assert "pixel transfer" in text
