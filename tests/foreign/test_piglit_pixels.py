"""Levels of textures, depth textures and rectangles of pixels. Source: piglit, tests/texturing, levelclamp.c,
lodclamp-between.c, lodclamp-between-max.c and depth-tex-modes-common.c; tests/general, copy-pixels.c and
teximage-scale-bias.c; tests/spec/gl-1.0, drawpixels-depth-test.c and drawpixels-stencil-test.c;
tests/spec/gl-1.1, xor-copypixels.c.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline import (
    PROFILES,
    CopyPixels,
    DepthTest,
    DrawPixels,
    Mesh,
    PassState,
    PixelImage,
    PixelTransfer,
    ReadPixels,
    StencilTest,
    TexImage,
    TextureEnvironment,
    TextureUnit,
    VertexState,
    environment,
    execute,
)
from fixedpipe.pipeline.enums import (
    BaseFormat,
    ComparisonFunction,
    InternalFormat,
    LogicOperation,
    PixelCopyType,
    PrimitiveType,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.state import RasterPosition
from fixedpipe.pipeline.textures.images import Texture
from tests.foreign.comparison import MACHINES, Case, assert_drawn, assert_held, on_machines, pixels
from tests.foreign.opengl import NEAREST, UNIT_SQUARE, clear, draw, ortho, rectangle, rgb, upwards

REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
CLAMPED = replace(NEAREST, wrap_s=WrapMode.CLAMP_TO_EDGE, wrap_t=WrapMode.CLAMP_TO_EDGE)

# levelclamp.c and the two of lod: levels of 32 to 1 texels, each of one colour.
RED, GREEN, BLUE = (1, 0, 0), (0, 1, 0), (0, 0, 1)
YELLOW, MAGENTA, CYAN = (1, 1, 0), (1, 0, 1), (0, 1, 1)
BY_LEVEL = RED, GREEN, BLUE, YELLOW, MAGENTA, CYAN
BETWEEN = RED, GREEN, BLUE, MAGENTA, CYAN, YELLOW


def levels(colors):
    images = [
        np.full((1, 32 >> number, 32 >> number, 4), (*np.multiply(color, 255), 255), np.uint8)
        for number, color in enumerate(colors)
    ]
    texture = Texture(TextureTarget.TEXTURE_2D, InternalFormat.RGB8, tuple(images))
    return TexImage(label="six levels", texture="levels", image=texture)


def textured(sampler, place, size, window):
    unit = TextureUnit("levels", sampler, environment=REPLACE)
    square = rectangle(*place, size, size, texture_coordinates=(UNIT_SQUARE,))
    return draw(
        square, vertex=VertexState(projection=ortho(0, window[0], 0, window[1])), texture_units=(unit,)
    )


def level_clamp(last):
    """Squares of 32 to 1 pixels, one above the other, of which none takes a level beyond the last."""
    sampler = replace(CLAMPED, min_filter=TextureFilter.NEAREST_MIPMAP_NEAREST, max_level=last)
    frame, wanted, y = [clear(0.5, 0.5, 0.5, 1), levels(BY_LEVEL)], [], 10
    for number in range(6):
        side = 32 >> number
        frame.append(textured(sampler, (10, y), side, (64, 128)))
        color = rgb(BY_LEVEL[min(number, last)])
        inside = {side // 4, side * 3 // 4}
        wanted += [(10 + across, y + up, color, 3) for across in inside for up in inside]
        y += side + 5
    return Case(f"no level beyond {last}", tuple(frame), pixels(upwards(wanted, 128)), (64, 128))


def between(number, least):
    """A square whose lambda is at least, or at most, half way between two levels."""
    limit = {"min_lod" if least else "max_lod": number + 0.5}
    sampler = replace(CLAMPED, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR, **limit)
    place, side = ((0, 0), 32) if least else ((10, 10), 1)
    x, y = (16, 16) if least else (10, 10)
    color = rgb(np.add(BETWEEN[number], BETWEEN[number + 1]) / 2)
    frame = clear(0.5, 0.5, 0.5, 1), levels(BETWEEN), textured(sampler, place, side, (32, 32))
    name = f"lambda of at {'least' if least else 'most'} {number}.5"
    return Case(name, frame, pixels(upwards([(x, y, color, 3)], 32)), (32, 32))


# depth-tex-modes-common.c: depths of 0 and 1, read without a comparison, times magenta.
DEPTHS = np.zeros((1, 2, 2, 4), np.uint8)
DEPTHS[0, [0, 1], [1, 0], :3] = 255
DEPTH_LOAD = TexImage(
    label="depths",
    texture="depths",
    image=Texture(TextureTarget.TEXTURE_2D, InternalFormat.DEPTH_COMPONENT24, (DEPTHS,)),
)


def depth_mode(mode, by_alpha):
    source = "TEXTURE.a" if by_alpha else "TEXTURE"
    env = environment(
        ("MODULATE", source, "CONSTANT"), ("MODULATE", "TEXTURE", "CONSTANT"), color=(1.0, 0.0, 1.0, 1.0)
    )
    unit = TextureUnit("depths", replace(NEAREST, depth_texture_mode=mode), environment=env)
    wanted = []
    for x, y in ((0, 0), (1, 0), (0, 1), (1, 1)):
        depth = float(x != y)
        color, alpha = {
            BaseFormat.ALPHA: (0.0, depth),
            BaseFormat.LUMINANCE: (depth, 1.0),
            BaseFormat.INTENSITY: (depth, depth),
        }[mode]
        seen = alpha if by_alpha else color
        wanted.append((10 + 20 * x, 10 + 20 * y, rgb((seen, 0, seen)), 3))
    square = rectangle(-1, -1, 2, 2, texture_coordinates=(UNIT_SQUARE,))
    frame = clear(0.2, 0.2, 0.2, 1), DEPTH_LOAD, draw(square, texture_units=(unit,))
    name = f"depths as {mode.name}, read by {'alpha' if by_alpha else 'colour'}"
    return Case(name, frame, pixels(upwards(wanted, 40)), (40, 40))


# copy-pixels.c: an image of red, green, blue and white quarters, drawn and copied.
SIDE, WINDOW = 60, 160
VERTEX = VertexState(projection=ortho(0, WINDOW, 0, WINDOW))
QUARTERS = np.zeros((SIDE, SIDE, 4))
QUARTERS[..., 3] = 1
QUARTERS[:30, :30, 0] = QUARTERS[:30, 30:, 1] = QUARTERS[30:, :30, 2] = 1
QUARTERS[30:, 30:, :3] = 1
COPIES = ((60, 0), (76, 76), (0, 44))


def at(x, y, z=0.0):
    return RasterPosition(position=(float(x), float(y), z, 1.0))


def copied(image, x, y, kind, **state):
    """An image drawn at the corner and copied to a place."""
    state = PassState(vertex=VERTEX, **state)
    return (
        DrawPixels(label="image", image=image, state=state, position=at(0, 0)),
        CopyPixels(label="copy", width=SIDE, height=SIDE, type=kind, state=state, position=at(x, y)),
    )


def copied_colors(x, y):
    wanted = [
        (x + across, y + up, (0xFF0000, 0x00FF00, 0x0000FF, 0xFFFFFF)[(across >= 30) + 2 * (up >= 30)], 3)
        for across in (1, 29, 30, 58)
        for up in (1, 29, 30, 58)
    ]
    frame = clear(0.25, 0.25, 0.25, 1), *copied(PixelImage(QUARTERS), x, y, PixelCopyType.COLOR)
    return Case(f"colours copied to {x}, {y}", frame, pixels(upwards(wanted, WINDOW)), (WINDOW, WINDOW))


# teximage-scale-bias.c
COLOR, SCALE, BIAS = (0.5, 0.25, 0.1, 0.5), (2.0, 3.0, 1.0, 1.0), (-0.25, 0.0, 0.4, 0.0)
SCALED = np.multiply(COLOR, SCALE) + BIAS
SCALE_BIAS = Case(
    "scale and bias on the way to a texture",
    (
        clear(0, 0, 0, 1),
        TexImage(
            label="a colour",
            texture="color",
            pixels=PixelImage(np.broadcast_to(COLOR, (64, 64, 4)).copy()),
            transfer=PixelTransfer(scale=SCALE, bias=BIAS),
        ),
        draw(rectangle(-1, -1, 2, 2), texture_units=(TextureUnit("color", NEAREST),)),
    ),
    pixels([(8, 8, round(SCALED[3] * 255) << 24 | rgb(SCALED), 3)], alpha=True),
    (16, 16),
)


# drawpixels-depth-test.c: single pixels, beside a depth of a half.
def one_pixel(x, z, color, function):
    state = PassState(
        vertex=VertexState(projection=ortho(0, 16, 0, 16, 2, -2)), depth_test=DepthTest(function)
    )
    return DrawPixels(
        label="pixel", image=PixelImage(np.array([[color]], float)), state=state, position=at(x, 0, z)
    )


ALWAYS, LESS = ComparisonFunction.ALWAYS, ComparisonFunction.LESS
DEPTH_TESTED = Case(
    "pixels are depth tested",
    (
        clear(1, 1, 1, 1, depth=1.0),
        one_pixel(0, 0.5, (1, 1, 1, 0), ALWAYS),
        one_pixel(2, 0.5, (1, 1, 1, 0), ALWAYS),
        one_pixel(0, 0.0, (1, 0, 0, 0), LESS),
        one_pixel(2, 1.0, (0, 0, 1, 0), LESS),
    ),
    pixels(upwards([(0, 0, 0xFF0000, 3), (2, 0, 0xFFFFFF, 3)], 16)),
    (16, 16),
)

# drawpixels-stencil-test.c: the lower half of a square passes.
STENCILS = np.zeros((20, 20), np.uint8)
STENCILS[:10] = 1
STENCIL_TESTED = Case(
    "drawn stencils are tested",
    (
        clear(0, 0, 0, 0, depth=1.0, stencil=0),
        DrawPixels(
            label="stencils",
            image=PixelImage(STENCILS, format="STENCIL_INDEX"),
            state=PassState(vertex=VERTEX),
            position=at(50, 50),
        ),
        draw(
            rectangle(50, 50, 20, 20, color=(1, 0, 0, 1)),
            vertex=VERTEX,
            stencil_test=StencilTest(function=LESS, reference=0),
        ),
    ),
    pixels(
        upwards(
            [(x, y, 0xFF0000 if y < 60 else 0, 3) for x in (51, 60, 69) for y in (50, 55, 59, 60, 65, 69)],
            WINDOW,
        )
    ),
    (WINDOW, WINDOW),
)

# xor-copypixels.c: what is copied onto its own copy by XOR is black.
RIGHT = RasterPosition(position=(32.0, 0.0, 0.0, 1.0), window=True)
HALF = Mesh(
    [[-1, -1], [0, -1], [0, 1], [-1, 1]], PrimitiveType.TRIANGLE_FAN, colors=[RED, GREEN, BLUE, YELLOW]
)
DIAMOND = Mesh(
    [[-0.5 + 0.5 * x, y] for x, y in ((0, -0.9), (0.9, 0), (0, 0.9), (-0.9, 0), (0, -0.9))],
    PrimitiveType.LINE_STRIP,
)
XOR = PassState(logic_op=LogicOperation.XOR)
BY_XOR = Case(
    "a copy by XOR on a copy is black",
    (
        clear(0, 0, 0, 0),
        draw(HALF),
        draw(DIAMOND),
        CopyPixels(label="copy", width=32, height=64, position=RIGHT),
        CopyPixels(label="copy by XOR", width=32, height=64, position=RIGHT, state=XOR),
    ),
    lambda image: [] if image[:, :32, :3].any(-1).all() and not image[:, 32:, :3].any() else ["it is not"],
    (64, 64),
)

CASES = (
    *map(level_clamp, range(6)),
    *[between(number, least) for number in range(5) for least in (True, False)],
    *[
        depth_mode(mode, by_alpha)
        for mode in (BaseFormat.ALPHA, BaseFormat.LUMINANCE, BaseFormat.INTENSITY)
        for by_alpha in (False, True)
    ],
    *[copied_colors(*place) for place in COPIES],
    SCALE_BIAS,
    DEPTH_TESTED,
    STENCIL_TESTED,
    BY_XOR,
)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES, {}))
def test_pixels_are_what_piglit_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=42)


MACHINES_ALONE = [machine for machine in MACHINES if machine != "IDEAL"]


def read_back(frame, machine, form, depth_bits=None):
    frame = (*frame, ReadPixels(label="read", name="read", format=form))
    return execute(frame, PROFILES[machine], WINDOW, WINDOW, depth_bits=depth_bits).pixels["read"]


@pytest.mark.parametrize("machine", MACHINES_ALONE)
@pytest.mark.parametrize(("x", "y"), COPIES)
def test_depths_and_stencils_are_copied(machine, x, y):
    there = np.s_[y : y + SIDE, x : x + SIDE]
    depths = PixelImage(np.full((SIDE, SIDE), 0.75), format="DEPTH_COMPONENT")
    written = copied(depths, x, y, PixelCopyType.DEPTH, depth_test=DepthTest(ALWAYS))
    bits = 23 if machine == "INFINITE_REALITY" else 24
    frame = clear(0, 0, 0, 0, depth=0.0), *written
    read = read_back(frame, machine, "DEPTH_COMPONENT", bits) / (2**bits - 1)
    np.testing.assert_allclose(read[there], 0.75, atol=1e-4)
    stencils = PixelImage(np.full((SIDE, SIDE), 2, np.uint8), format="STENCIL_INDEX")
    frame = clear(0, 0, 0, 0, stencil=0), *copied(stencils, x, y, PixelCopyType.STENCIL)
    assert (read_back(frame, machine, "STENCIL_INDEX")[there] == 2).all()
