"""Pbuffers: MakeCurrent, BindTexImage, and what each colour format keeps."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import BindTexImage, Clear, Draw, MakeCurrent, Mesh, ReadPixels
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ColorFormat,
    ComparisonFunction,
    DepthFormat,
    InternalFormat,
    LogicOperation,
    PrimitiveType,
    TextureTarget,
    WindowOrigin,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.state import Blending, ColorMask, PassState, Scissor, StencilTest, WindowClip
from fixedpipe.pipeline.textures.pixel_formats import READABLE_AS
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.support.run_reference import run_reference

WIDTH, HEIGHT = 12, 8
SQUARE = Mesh([[-1, -1], [1, -1], [1, 1], [-1, 1]], PrimitiveType.QUADS)
GRADIENT = Mesh(
    [[-1, -1], [1, -1], [1, 1], [-1, 1]],
    PrimitiveType.QUADS,
    colors=[[0, 0, 0, 0], [1, 0, 0, 0.4], [1, 1, 0.5, 1], [0, 1, 0.9, 0.7]],
)


def pbuffer(name="p", width=4, height=8, **fields):
    return MakeCurrent(label="pbuffer", surface=name, width=width, height=height, **fields)


WINDOW = MakeCurrent(label="window")


def bind(name="p", **fields):
    return BindTexImage(label="bind", texture="t", surface=name, **fields)


def assert_equal_to_reference(commands, depth_bits=24):
    result = execute(commands, NV2A, WIDTH, HEIGHT, depth_bits=depth_bits, threads=1)
    expected = run_reference(commands, NV2A, WIDTH, HEIGHT, depth_bits)
    pairs = [(result.framebuffer, expected.target)]
    assert result.surfaces.keys() == expected.surfaces.keys()
    pairs += [(result.surfaces[name], expected.surfaces[name]) for name in expected.surfaces]
    for machine, target in pairs:
        for name in ("color", "depth", "stencil"):
            np.testing.assert_array_equal(getattr(machine, name), np.array(getattr(target, name)))
    for name, texture in expected.textures.items():
        np.testing.assert_array_equal(result.textures[name].levels[0], np.array(texture.levels[0]))
    return result


def test_a_pbuffer_is_drawn_to_and_read_and_the_window_stays():
    commands = (
        Clear(label="window", color=(0.1, 0.2, 0.3, 0.4)),
        pbuffer(depth_bits=16),
        Clear(label="pbuffer", color=(1.0, 0.0, 0.0, 1.0), depth=0.5),
        Draw(label="gradient", mesh=GRADIENT, state=PassState()),
        ReadPixels(label="read", name="pbuffer"),
        WINDOW,
        ReadPixels(label="read", name="window"),
    )
    result = assert_equal_to_reference(commands)
    assert (result.framebuffer.color == (26, 51, 77, 102)).all()
    assert result.pixels["window"].shape == (8, 12, 4)
    np.testing.assert_array_equal(result.pixels["pbuffer"], result.surfaces["p"].color[::-1])
    assert (result.surfaces["p"].depth == 32768).all()


@pytest.mark.parametrize("origin", WindowOrigin)
def test_the_origin_says_which_row_has_t_zero(origin):
    commands = (pbuffer(), Draw(label="gradient", mesh=GRADIENT, state=PassState()), bind(origin=origin))
    result = assert_equal_to_reference(commands)
    rows = result.textures["t"].levels[0][0]
    top_first = result.surfaces["p"].color
    np.testing.assert_array_equal(rows, top_first if origin == WindowOrigin.UPPER_LEFT else top_first[::-1])
    assert (rows[0] != rows[-1]).any()


def test_a_texture_format_without_alpha_reads_full_alpha():
    commands = (
        pbuffer(),
        Draw(label="gradient", mesh=GRADIENT, state=PassState()),
        bind(internal_format=InternalFormat.RGB8),
    )
    texels = assert_equal_to_reference(commands).textures["t"].levels[0]
    assert (texels[..., 3] == 255).all()


def test_pbuffers_keep_their_contents_from_run_to_run_and_every_run_begins_with_the_window():
    machine = Machine(NV2A, WIDTH, HEIGHT)
    machine.run((pbuffer(), Clear(label="c", color=(1.0, 1.0, 1.0, 1.0))))
    result = machine.run((Clear(label="c", color=(0.2, 0.2, 0.2, 0.2)), bind()))
    assert (result.textures["t"].levels[0] == 255).all()
    assert (result.framebuffer.color == 51).all()


def test_a_trace_shows_the_surface_that_is_current():
    trace = execute((pbuffer(), WINDOW), NV2A, WIDTH, HEIGHT, trace=True).trace
    assert [snapshot.color.shape for snapshot in trace] == [(8, 4, 4), (8, 12, 4)]


def test_the_commands_in_words():
    words = describe((pbuffer(depth_bits=16), bind(origin=WindowOrigin.UPPER_LEFT), WINDOW))
    assert 'pbuffer "p": 4x8, A8R8G8B8, depth 16 bits' in words
    assert 'texture "t": TEXTURE_2D, RGBA8, from pbuffer "p", top row first' in words
    assert "the window" in words


@pytest.mark.parametrize(
    ("commands", "sentences"),
    [
        ((pbuffer(width=None),), ["'p' has no width or no height", "give both"]),
        ((pbuffer(width=0),), ["the pbuffer is 0x8", "at least 1x1"]),
        ((pbuffer(depth_bits=13),), ["the pbuffer has 13 bits of depth", "NV2A has 16 or 24"]),
        ((pbuffer(), pbuffer(width=8)), ["is 4x8 A8R8G8B8", "asks for 8x8", "another name"]),
        ((MakeCurrent(label="w", width=4),), ["the window has its size", "pbuffers only"]),
        ((bind(),), ["no pbuffer 'p' yet", "put a MakeCurrent before"]),
        (
            (pbuffer(), bind(internal_format=InternalFormat.RGB5)),
            ["RGB5 does not read the words of A8R8G8B8", "RGB8, RGBA8"],
        ),
        ((pbuffer(), bind(target=TextureTarget.TEXTURE_1D)), ["becomes a 2D texture", "TEXTURE_2D"]),
        ((pbuffer(width=5), bind()), ["5x8", "powers of two"]),
        ((pbuffer(), ReadPixels(label="r", name="r", width=5)), ["outside the framebuffer, which is 4x8"]),
    ],
)
def test_what_a_machine_refuses(commands, sentences):
    with pytest.raises(UnsupportedState) as refusal:
        validate(commands, NV2A, WIDTH, HEIGHT)
    for sentence in sentences:
        assert sentence in str(refusal.value)


@pytest.mark.parametrize("profile", [GEFORCE_256, IDEAL])
def test_machines_without_pbuffers_refuse_them(profile):
    with pytest.raises(UnsupportedState, match="has no pbuffers; draw to the window and use CopyTexImage"):
        validate((pbuffer(),), profile, WIDTH, HEIGHT)


def test_a_format_that_a_machine_lacks_is_refused():
    profile = NV2A.changed(surface_formats=frozenset({ColorFormat.A8R8G8B8}))
    with pytest.raises(UnsupportedState, match="has no surface format R5G6B5; it has A8R8G8B8"):
        validate((pbuffer(color_format=ColorFormat.R5G6B5),), profile, WIDTH, HEIGHT)


@pytest.mark.parametrize("color_format", ColorFormat)
def test_a_surface_keeps_its_formats_bits(color_format):
    color = (0.1, 0.3, 0.7, 0.5)  # bytes 26, 77, 179, 128
    result = assert_equal_to_reference((pbuffer(color_format=color_format), Clear(label="c", color=color)))
    stored = {
        ColorFormat.A8R8G8B8: [26, 77, 179, 128],
        ColorFormat.X8R8G8B8_Z8R8G8B8: [26, 77, 179, 0],
        ColorFormat.X8R8G8B8_O8R8G8B8: [26, 77, 179, 255],
        ColorFormat.X1A7R8G8B8_Z1A7R8G8B8: [26, 77, 179, 64],
        ColorFormat.X1A7R8G8B8_O1A7R8G8B8: [26, 77, 179, 192],
        ColorFormat.R5G6B5: [24, 76, 176, 0],
        ColorFormat.X1R5G5B5_Z1R5G5B5: [24, 72, 176, 0],
        ColorFormat.X1R5G5B5_O1R5G5B5: [24, 72, 176, 128],
    }[color_format]
    assert (result.surfaces["p"].color == stored).all()
    # White times the destination's alpha: 255 without alpha, 129 from seven bits of 128.
    factor = {128: 128, 64: 129, 192: 129}.get(stored[3] if "A" in color_format.name else 0, 255)
    white = PassState(blending=Blending(BlendFactor.DST_ALPHA, BlendFactor.ZERO))
    square = Draw(label="white", mesh=SQUARE, state=white)
    commands = (pbuffer(color_format=color_format), Clear(label="c", color=color), square)
    red = assert_equal_to_reference(commands).surfaces["p"].color[..., 0]
    assert (red == factor & (0xF8 if "5" in color_format.name else 0xFF)).all()


@pytest.mark.parametrize("color_format", ColorFormat)
@pytest.mark.parametrize(
    "state",
    [
        PassState(),
        PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE)),
        PassState(blending=Blending(BlendFactor.SRC_ALPHA, BlendFactor.DST_ALPHA)),
        PassState(blending=Blending(equation=BlendEquation.FUNC_REVERSE_SUBTRACT_SIGNED)),
        PassState(logic_op=LogicOperation.NAND),
        PassState(color_mask=ColorMask(red=False, alpha=False)),
    ],
)
def test_every_way_to_write_a_surface_equals_the_specification(color_format, state):
    draws = [Draw(label="gradient", mesh=GRADIENT, state=state) for _ in range(2)]
    background = Clear(label="c", color=(0.1, 0.3, 0.7, 0.5))
    formats = READABLE_AS[color_format]
    for internal_format in formats:
        assert_equal_to_reference(
            (pbuffer(color_format=color_format), background, *draws, bind(internal_format=internal_format))
        )


@pytest.mark.parametrize("depth_bits", NV2A.framebuffers.depth_bits)
@pytest.mark.parametrize("color_format", ColorFormat)
def test_a_texture_reads_the_words_of_a_surface_of_its_width_alone(color_format, depth_bits):
    """Source: WGL_ARB_render_texture, WGL_NV_render_depth_texture."""
    bits = color_format.name.partition("_")[0]
    reads = {"R5G6B5": {"R5_G6_B5"}, "X1R5G5B5": {"RGB5", "RGB5_A1"}}.get(bits, {"RGBA8", "RGB8"})
    floats = "_FLOAT" if depth_bits < 0 else ""
    reads = reads | {f"DEPTH_COMPONENT{abs(depth_bits)}{floats}"}
    for internal_format in NV2A.textures.internal_formats:
        frame = (
            pbuffer(color_format=color_format, depth_bits=depth_bits),
            bind(internal_format=internal_format),
        )
        if internal_format.name in reads:
            validate(frame, NV2A, WIDTH, HEIGHT)
        else:
            with pytest.raises(UnsupportedState, match="does not read the words of"):
                validate(frame, NV2A, WIDTH, HEIGHT)


def test_a_pbuffer_of_float_depths_keeps_them_from_run_to_run():
    machine = Machine(NV2A, WIDTH, HEIGHT, threads=1)
    current = pbuffer(depth_bits=DepthFormat.FLOAT_24)
    machine.run((current, Clear(label="clear", depth=0.5)))
    again = machine.run((current, bind(internal_format=InternalFormat.DEPTH_COMPONENT24_FLOAT)))
    assert again.textures["t"].internal_format == InternalFormat.DEPTH_COMPONENT24_FLOAT
    assert again.surfaces["p"].depth_format == DepthFormat.FLOAT_24


def test_small_numpy_integers_count_as_the_integers_they_are():
    box = Scissor(*np.array([1, 2, 200, 200], np.uint8))
    state = PassState(
        scissor=box,
        window_clip=WindowClip((box,)),
        stencil_test=StencilTest(ComparisonFunction.ALWAYS, mask=np.int8(1), write_mask=np.int8(1)),
    )
    drawn = execute((Draw(label="d", mesh=SQUARE, state=state),), NV2A, WIDTH, HEIGHT, threads=1)
    assert drawn.fragments == (WIDTH - 1) * (HEIGHT - 2)
