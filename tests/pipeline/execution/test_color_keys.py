"""Color keys: engines, the ideal and the specification, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Bitmap, Clear, Draw, DrawPixels, Mesh, RasterPosition, TexImage
from fixedpipe.pipeline.enums import (
    ColorKeyOperation,
    ComparisonFunction,
    InternalFormat,
    PrimitiveType,
    TexelWord,
    TextureFilter,
    TextureShaderOperation,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.inspection.inspect import inspect
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import (
    ColorKey,
    ColorTable,
    DepthTest,
    PassState,
    Sampler,
    SignedComponents,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.textures.words import texture_of_words
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests import fuzz
from tests.support.random_frames import Frame
from tests.support.strategies import SHOW_TEXTURE

NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
ALPHA, RGBA, KILL = ColorKeyOperation
GREEN = (0.0, 1.0, 0.0, 1.0)
CORNERS = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
WAYS = fuzz.Way(), fuzz.Way("portable"), fuzz.Way("columns"), fuzz.Way(record=True), fuzz.Way(reference=True)


def shown(image, *units, **state):
    """A frame of textures and a rectangle that shows texture 0's texels, one in a pixel."""
    mesh = Mesh(2.0 * CORNERS - 1.0, PrimitiveType.TRIANGLE_STRIP, texture_coordinates=(CORNERS,))
    drawn = PassState(**({"texture_units": units, "register_combiners": SHOW_TEXTURE} | state))
    return (
        Clear(label="clear", color=(1.0, 0.0, 0.0, 0.25), depth=1.0),
        TexImage(label="keyed", texture="keyed", image=image),
        Draw(label="keyed", mesh=mesh, state=drawn),
    )


def unit(key=GREEN, operation=KILL, sampler=NEAREST, **fields):
    return TextureUnit("keyed", sampler, color_key=ColorKey(key, operation), **fields)


# The key, its color with another alpha, a color one step beside it, another.
ROW = np.array([[(0, 255, 0, 255), (0, 255, 0, 254), (0, 254, 0, 255), (9, 8, 7, 6)]], np.uint8)


@pytest.mark.parametrize(
    ("operation", "first"),
    [(ALPHA, (0, 255, 0, 0)), (RGBA, (0, 0, 0, 0)), (KILL, (255, 0, 0, 64))],
)
def test_what_becomes_of_a_texel_that_equals_the_key(operation, first):
    drawn = execute(shown(texture_2d(ROW), unit(operation=operation)), NV2A, 4, 1).framebuffer.color
    assert drawn[0].tolist() == [list(first), *ROW[0, 1:].tolist()]


@pytest.mark.parametrize(
    ("internal_format", "key", "killed"),
    [
        (InternalFormat.RGB8, (0.0, 1.0, 0.0, 0.3), [True, True, False, False]),  # without alpha
        (InternalFormat.RGBA4, GREEN, [True, True, True, False]),  # 254 and 255 are both 15
        (InternalFormat.RGB5_A1, (0.01, 1.0, 0.0, 0.9), [True, True, True, False]),
        (InternalFormat.LUMINANCE8, (0.0, 1.0, 1.0, 1.0), [True, True, True, False]),  # red is luminance
        (InternalFormat.ALPHA8, (1.0, 1.0, 1.0, 6.0 / 255.0), [False, False, False, True]),
    ],
)
def test_a_key_is_stored_as_a_texel_is(internal_format, key, killed):
    drawn = execute(shown(texture_2d(ROW, internal_format), unit(key)), NV2A, 4, 1).framebuffer.color
    assert [pixel == [255, 0, 0, 64] for pixel in drawn[0].tolist()] == killed


def test_words_without_alpha_equal_a_key_whatever_their_unused_bits():
    image = texture_of_words(np.array([[0x0000FF00, 0xCC00FF00, 0xCC00FE00, 0]]), TexelWord.X8R8G8B8)
    drawn = execute(shown(image, unit((0.0, 1.0, 0.0, 0.8))), NV2A, 4, 1).framebuffer.color
    assert [pixel == [255, 0, 0, 64] for pixel in drawn[0].tolist()] == [True, True, False, False]


def test_an_ended_fragment_writes_no_depth():
    commands = shown(texture_2d(ROW), unit(), depth_test=DepthTest(ComparisonFunction.LESS))
    drawn = execute(commands, NV2A, 4, 1)
    assert (drawn.framebuffer.depth[0] == 2**24 - 1).tolist() == [True, False, False, False]


def test_a_unit_that_is_sampled_ends_fragments_though_nothing_reads_it():
    plain = TextureUnit("keyed", NEAREST)
    drawn = execute(shown(texture_2d(ROW), plain, unit()), NV2A, 4, 1).framebuffer.color
    assert drawn[0].tolist() == [[255, 0, 0, 64], *ROW[0, 1:].tolist()]
    stages = TextureShaderStage(TextureShaderOperation.TEXTURE_2D), TextureShaderStage()
    drawn = execute(
        shown(texture_2d(ROW), plain, unit(), texture_shader=stages), NV2A, 4, 1
    ).framebuffer.color
    assert drawn[0].tolist() == ROW[0].tolist()  # stage 1 samples nothing


@pytest.mark.parametrize("wrap", [WrapMode.CLAMP_TO_BORDER, WrapMode.REPEAT])
def test_the_border_color_is_no_key(wrap):
    sampler = replace(NEAREST, wrap_s=wrap, wrap_t=WrapMode.CLAMP_TO_EDGE, border_color=GREEN)
    shift = ((1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    drawn = execute(shown(texture_2d(ROW), unit(sampler=sampler, matrix=shift)), NV2A, 4, 1).framebuffer.color
    killed = [pixel == [255, 0, 0, 64] for pixel in drawn[0].tolist()]
    assert killed == [wrap is WrapMode.REPEAT, False, False, False]


def random_frame(seed):
    """Textures of few colours in two units with keys, under any nearest filter, in perspective."""
    rng = np.random.default_rng(seed)
    palette = rng.integers(0, 256, (3, 4), np.uint8)
    formats = [f for f in NV2A.textures.internal_formats if f.name in ("RGBA8", "RGB8", "RGBA4", "R5_G6_B5")]
    image = texture_2d(palette[rng.integers(0, 3, (8, 8))], formats[rng.integers(len(formats))], mipmaps=True)
    units = []
    for _ in range(2):
        sampler = Sampler(
            [TextureFilter.NEAREST, TextureFilter.NEAREST_MIPMAP_NEAREST][rng.integers(2)],
            TextureFilter.NEAREST,
            *[list(WrapMode)[rng.integers(len(WrapMode))] for _ in range(2)],
            base_level=int(rng.integers(0, 3)),
            border_color=tuple((palette[rng.integers(3)] / 255.0).tolist()),
        )
        key = ColorKey(
            tuple((palette[rng.integers(3)] / 255.0).tolist()), list(ColorKeyOperation)[rng.integers(3)]
        )
        units.append(TextureUnit("keyed", sampler, color_key=key if rng.random() < 0.8 else None))
    coordinates = rng.uniform(-1.5, 2.5, (2, 6, 4))
    coordinates[..., 3] = 1.0 if seed % 3 else coordinates[..., 3]
    w = np.exp(rng.uniform(-1.0, 1.0, (6, 1)))
    positions = np.concatenate([rng.uniform(-1.2, 1.2, (6, 2)) * w, rng.uniform(-w, w), w], -1)
    mesh = Mesh(positions, PrimitiveType.TRIANGLE_STRIP, texture_coordinates=tuple(coordinates))
    units[1] = replace(units[1], coordinates=1)
    state = PassState(texture_units=tuple(units), depth_test=DepthTest(ComparisonFunction.LEQUAL))
    if seed % 2:
        stage = TextureShaderStage(TextureShaderOperation.TEXTURE_2D)
        shader = (stage, stage if seed % 4 == 1 else TextureShaderStage())
        state = replace(state, texture_shader=shader, register_combiners=SHOW_TEXTURE)
    return (
        TexImage(label="keyed", texture="keyed", image=image),
        Draw(label="keyed", mesh=mesh, state=state),
    )


@pytest.mark.parametrize("seed", range(40))
def test_engines_equal_the_specification(seed):
    fuzz.compare(Frame(seed, NV2A, 12, 10, 24, random_frame(seed), small=True), WAYS)


@pytest.mark.parametrize("operation", ColorKeyOperation)
def test_rectangles_of_pixels_are_keyed_alike(operation):
    at = RasterPosition((-1.0, -1.0, 0.0, 1.0), texture_coordinates=((0.125, 0.5, 0.0, 1.0),))
    colors = PixelImage(np.full((2, 2, 4), 200, np.uint8), "RGBA")
    store = TexImage(label="keyed", texture="keyed", image=texture_2d(ROW))
    state = PassState(texture_units=(unit(operation=operation),))
    for command in (
        Bitmap(label="bits", bits=np.ones((2, 2), bool), position=at, state=state),
        DrawPixels(label="pixels", image=colors, position=at, state=state),
    ):
        commands = Clear(label="clear", color=(1.0, 0.0, 0.0, 0.25)), store, command
        fuzz.compare(Frame(0, NV2A, 4, 4, 24, commands, small=True), (fuzz.Way(), fuzz.Way(reference=True)))
        ideal, drawn = execute_ideal(commands, 4, 4).color, execute(commands, NV2A, 4, 4).framebuffer.color
        assert np.abs(ideal * 255.0 - drawn).max() < 1.0
        assert (drawn[3, 0].tolist() == [255, 0, 0, 64]) is (operation is KILL)


@pytest.mark.parametrize("operation", ColorKeyOperation)
@pytest.mark.parametrize("floats", [False, True])
def test_the_ideal_takes_what_the_stored_texel_equals(operation, floats):
    """Nearest texels, whole: but for floats that bytes round, the ideal's picture is the machine's."""
    image = texture_2d((ROW + 0.25) / 255.0 if floats else ROW)
    commands = shown(image, unit(operation=operation), depth_test=DepthTest(ComparisonFunction.LESS))
    machine, ideal = execute(commands, NV2A, 4, 1, record=True), execute_ideal(commands, 4, 1)
    # A quarter of a step, clamped at one; a byte of the cleared alpha.
    assert np.abs(np.clip(ideal.color, 0.0, 1.0) * 255.0 - machine.framebuffer.color).max() <= 0.26
    assert (ideal.depth[0] == 1.0).tolist() == [operation is KILL, False, False, False]
    guided = execute_ideal(commands, 4, 1, guide=machine)
    assert np.abs(np.clip(guided.color, 0.0, 1.0) * 255.0 - machine.framebuffer.color).max() <= 0.26


def test_the_inspector_says_which_key_ended_a_fragment():
    commands = shown(texture_2d(ROW), unit())
    fates = [inspect(commands, NV2A, 4, 1, (x, 0)).touched[-1].fragments[0].fate for x in range(2)]
    assert fates == ["ended: color key of texture unit 0", "written"]


LINEAR = replace(NEAREST, mag_filter=TextureFilter.LINEAR)
REFUSED = {
    "a machine without keys": (
        OPENGL_1_2,
        {},
        {"register_combiners": None},
        "does KILL; OpenGL 1.2 has no color keys",
    ),
    "an operation": (GEFORCE_256, {"operation": ALPHA}, {}, "does ALPHA; GeForce 256 has KILL"),
    "a filter": (NV2A, {"sampler": LINEAR}, {}, "known of the nearest texel alone. Give NEAREST"),
    "a color": (NV2A, {"key": (0.0, 2.0, 0.0, 1.0)}, {}, "give four components from 0 to 1"),
    "signed components": (
        NV2A,
        {"sampler": replace(NEAREST, signed_components=SignedComponents(red=True))},
        {},
        "beside signed components or a color table",
    ),
    "a color table": (
        IDEAL,
        {"color_table": ColorTable(((0.0,) * 4, (1.0,) * 4))},
        {"register_combiners": None},
        "beside signed components or a color table",
    ),
    "a word format": (NV2A, {}, {}, "beside a texture of HILO16"),
    "made coordinates": (
        NV2A,
        {},
        {
            "texture_shader": (
                TextureShaderStage(TextureShaderOperation.TEXTURE_2D),
                TextureShaderStage(TextureShaderOperation.DEPENDENT_AR_TEXTURE_2D),
            )
        },
        "its texture shader stage makes its coordinates",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_no_key_is_known_of_is_refused(name):
    profile, fields, state, words = REFUSED[name]
    image = texture_2d(ROW)
    if name == "a word format":
        image = replace(image, internal_format=InternalFormat.HILO16)
    units = (unit(**fields),)
    if name == "made coordinates":
        units = TextureUnit("keyed", NEAREST), unit()
    with pytest.raises(UnsupportedState, match=words):
        validate(shown(image, *units, **state), profile, 4, 1)
