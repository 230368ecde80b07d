"""Textures with a border: engines and the specification, the ideal by plain sums, and known texels."""

from dataclasses import replace
from math import floor

import numpy as np
import pytest

from fixedpipe.pipeline.commands import CopyTexSubImage, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    InternalFormat,
    PrimitiveType,
    TextureCompareMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.state import PassState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import Texture, texture_1d, texture_2d
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests import fuzz
from tests.support.random_frames import Frame
from tests.support.strategies import SHOW_TEXTURE

NEAREST, LINEAR = TextureFilter.NEAREST, TextureFilter.LINEAR
# What each base format keeps of the border colour (0.2, 0.4, 0.6, 0.8), as bytes.
BASES = {
    InternalFormat.RGBA8: [51, 102, 153, 204],
    InternalFormat.RGB8: [51, 102, 153, 255],
    InternalFormat.ALPHA8: [0, 0, 0, 204],
    InternalFormat.LUMINANCE8: [51, 51, 51, 255],
    InternalFormat.LUMINANCE8_ALPHA8: [51, 51, 51, 204],
    InternalFormat.INTENSITY8: [51, 51, 51, 51],
}
OF_ANY_BORDER = NV2A.changed(texture_borders=frozenset({0, 1, 4}))


def shown(image, sampler, low, high):
    """A frame whose s and t go from ``low`` to ``high`` across the window."""
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
    mesh = Mesh(
        2.0 * corners - 1.0,
        PrimitiveType.TRIANGLE_STRIP,
        texture_coordinates=(low + corners * (high - low),),
    )
    unit = TextureUnit("bordered", sampler)
    return (
        TexImage(label="bordered", texture="bordered", image=image),
        Draw(
            label="bordered",
            mesh=mesh,
            state=PassState(texture_units=(unit,), register_combiners=SHOW_TEXTURE),
        ),
    )


def row(wrap, filter_mode, low, high, pixels):
    """Red of ``pixels`` pixels of a row of texels 10, 20, 30, 40 between border texels 100 and 200."""
    image = texture_1d(np.repeat(np.array([100, 10, 20, 30, 40, 200], np.uint8)[:, None], 4, 1), border=1)
    sampler = Sampler(filter_mode, filter_mode, wrap, border_color=(1.0, 1.0, 1.0, 1.0))
    drawn = execute(shown(image, sampler, low, high), GEFORCE_256, pixels, 1).framebuffer.color
    return drawn[0, :, 0].tolist()


@pytest.mark.parametrize("engine", [None, "portable", "columns"])
@pytest.mark.parametrize(
    ("profile", "internal_format", "expected"),
    [
        # The NV2A has the colour as it is, whatever the format (Measured: TextureBorderColor).
        *[(NV2A, internal_format, [51, 102, 153, 204]) for internal_format in BASES],
        *[(GEFORCE_256, *of_base) for of_base in BASES.items()],
    ],
)
def test_the_border_colour_is_as_given_or_what_the_base_format_keeps(
    profile, internal_format, expected, engine
):
    image = texture_2d(np.zeros((4, 4, 4), np.uint8), internal_format=internal_format)
    color = (0.2, 0.4, 0.6, 0.8)
    sampler = Sampler(NEAREST, NEAREST, *[WrapMode.CLAMP_TO_BORDER] * 2, border_color=color)
    drawn = Machine(profile, 4, 4, engine=engine).run(shown(image, sampler, -2.0, -1.0))
    assert (drawn.framebuffer.color == expected).all()
    ideal = execute_ideal(shown(image, sampler, -2.0, -1.0), 4, 4).color
    assert (np.floor(255.0 * ideal + 0.5) == BASES[internal_format]).all()


@pytest.mark.parametrize(
    ("wrap", "filter_mode", "expected"),
    [
        # Middles of texels, one beyond the border on either side.
        (WrapMode.CLAMP_TO_BORDER, NEAREST, [100, 100, 10, 20, 30, 40, 200, 200]),
        (WrapMode.CLAMP_TO_BORDER, LINEAR, [100, 100, 10, 20, 30, 40, 200, 200]),
        (WrapMode.CLAMP, NEAREST, [10, 10, 10, 20, 30, 40, 40, 40]),
        # Clamped to the edge of the image, halfway to the border texel.
        (WrapMode.CLAMP, LINEAR, [55, 55, 10, 20, 30, 40, 120, 120]),
        (WrapMode.CLAMP_TO_EDGE, LINEAR, [10, 10, 10, 20, 30, 40, 40, 40]),
        (WrapMode.REPEAT, LINEAR, [30, 40, 10, 20, 30, 40, 10, 20]),
        (WrapMode.MIRRORED_REPEAT, LINEAR, [20, 10, 10, 20, 30, 40, 40, 30]),
    ],
)
def test_wrap_modes_read_the_border_or_not(wrap, filter_mode, expected):
    assert row(wrap, filter_mode, -0.5, 1.5, 8) == expected


def test_a_repeated_texture_is_filtered_without_its_border():
    assert row(WrapMode.REPEAT, LINEAR, -0.125, 0.125, 1) == [25]  # between 40 and 10


TARGETS = {
    TextureTarget.TEXTURE_1D: (1, 1, 8),
    TextureTarget.TEXTURE_2D: (1, 4, 8),
    TextureTarget.TEXTURE_3D: (4, 4, 8),
    TextureTarget.TEXTURE_CUBE_MAP: (6, 8, 8),
}


def random_texture(rng, target, border, internal_format=InternalFormat.RGBA8):
    """All levels of a texture of random bytes, each with its border."""
    empty = Texture(target, internal_format, (), border=border)
    beside, levels, size = empty.borders[::-1], [], TARGETS[target]
    while True:
        shape = [n + 2 * b for n, b in zip(size, beside, strict=True)]
        levels.append(rng.integers(0, 256, (*shape, 4), np.uint8))
        halved = size if target is TextureTarget.TEXTURE_3D else size[1:]
        if max(halved) == 1:
            return replace(empty, levels=tuple(levels))
        size = tuple(max(1, n >> 1) for n in size)
        if target is TextureTarget.TEXTURE_CUBE_MAP:
            size = (6, *size[1:])


def random_frame(seed):
    rng = np.random.default_rng(seed)
    target = list(TARGETS)[seed % 4]
    border = int(rng.choice([1, 4]))
    deep = seed % 5 == 0 and target in (TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D)
    filters = list(TextureFilter)
    sampler = Sampler(
        filters[rng.integers(len(filters))],
        filters[rng.integers(2)],
        *[list(WrapMode)[rng.integers(len(WrapMode))] for _ in range(2)],
        wrap_r=list(WrapMode)[rng.integers(len(WrapMode))],
        border_color=tuple(rng.random(4).tolist()),
        base_level=int(rng.integers(0, 3)),
    )
    if deep:
        sampler = replace(
            sampler,
            compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE,
            compare_function=ComparisonFunction.LESS,
        )
    coordinates = rng.uniform(-1.5, 2.5, (6, 4))
    if deep:
        coordinates[:, 2] *= 2.0**24
    if seed % 3:
        coordinates[:, 3] = 1.0
    if seed % 7 == 0:
        coordinates = np.round(coordinates * 4.0) / 4.0
    w = np.exp(rng.uniform(-1.0, 1.0, (6, 1)))
    positions = np.concatenate([rng.uniform(-1.2, 1.2, (6, 2)) * w, np.zeros((6, 1)), w], -1)
    mesh = Mesh(positions, PrimitiveType.TRIANGLE_STRIP, texture_coordinates=(coordinates,))
    image = random_texture(
        rng, target, border, InternalFormat.DEPTH_COMPONENT24 if deep else InternalFormat.RGBA8
    )
    if deep:  # depths of 24 bits
        image = replace(
            image, levels=tuple(level & np.array([255, 255, 255, 0], np.uint8) for level in image.levels)
        )
    state = PassState(texture_units=(TextureUnit("bordered", sampler),), register_combiners=SHOW_TEXTURE)
    return (
        TexImage(label="bordered", texture="bordered", image=image),
        Draw(label="bordered", mesh=mesh, state=state),
    )


@pytest.mark.parametrize("seed", range(48))
def test_the_engine_equals_the_specification(seed):
    frame = Frame(seed, OF_ANY_BORDER, 12, 10, 24, random_frame(seed), small=True)
    fuzz.compare(frame, (fuzz.Way(), fuzz.Way("columns"), fuzz.Way(record=True), fuzz.Way(reference=True)))


def texel_along(texel, size, border, wrap, linear):
    """(indices, fraction) along an axis, by section 3.8.5 in float64."""
    if wrap is WrapMode.REPEAT:
        texel %= size
    elif wrap is WrapMode.MIRRORED_REPEAT:
        texel %= 2.0 * size
        texel = min(texel, 2.0 * size - texel)
    else:
        beside = {WrapMode.CLAMP: 0.0, WrapMode.CLAMP_TO_EDGE: -0.5, WrapMode.CLAMP_TO_BORDER: border - 0.5}[
            wrap
        ]
        texel = min(max(texel, -beside), size + beside)
    if not linear:
        i = floor(texel)
        return [i if wrap is WrapMode.CLAMP_TO_BORDER else min(i, size - 1)], 0.0
    i = floor(texel - 0.5)
    pair = [i, i + 1]
    if wrap is WrapMode.REPEAT:
        pair = [k % size for k in pair]
    elif wrap in (WrapMode.MIRRORED_REPEAT, WrapMode.CLAMP_TO_EDGE):
        pair = [min(max(k, 0), size - 1) for k in pair]
    return [min(max(k, -border), size - 1 + border) for k in pair], texel - 0.5 - i


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("border", [1, 4])
@pytest.mark.parametrize("wrap_s", WrapMode)
@pytest.mark.parametrize("wrap_t", WrapMode)
def test_the_ideal_equals_plain_sums(linear, border, wrap_s, wrap_t):
    rng = np.random.default_rng(border)
    width, height, pixels = 8, 4, 24
    texels = rng.random((height + 2 * border, width + 2 * border, 4))
    kind = LINEAR if linear else NEAREST
    sampler = Sampler(kind, kind, wrap_s, wrap_t, border_color=(5.0, 5.0, 5.0, 5.0))
    # No pixel's middle lies on a boundary between texels.
    commands = shown(texture_2d(texels, border=border), sampler, -1.53, 2.51)
    ideal = execute_ideal(commands, pixels, pixels).color[::-1]
    for y in range(pixels):
        for x in range(pixels):
            s, t = (-1.53 + (n + 0.5) / pixels * 4.04 for n in (x, y))
            columns, across = texel_along(s * width, width, border, wrap_s, linear)
            rows, up = texel_along(t * height, height, border, wrap_t, linear)
            lines = [
                texels[j + border, columns[0] + border] * (1.0 - across)
                + texels[j + border, columns[-1] + border] * across
                for j in rows
            ]
            expected = lines[0] * (1.0 - up) + lines[-1] * up
            # float64 and the order of sums: coordinates of 2.5 over some dozen operations.
            np.testing.assert_allclose(ideal[y, x], expected, atol=1e-12)


@pytest.mark.parametrize("seed", [seed for seed in range(48) if seed % 3 and seed % 5])
def test_the_ideal_of_a_frame_is_near_its_machine(seed):
    """Linear filters, q of 1. A fraction of 8 bits, cut, moves each of three axes by at most 1/256 of a step
    from 0 to 1, and each of three lerps rounds to bytes.
    """
    store, draw = random_frame(seed)
    (unit,) = draw.state.texture_units
    sampler = replace(unit.sampler, min_filter=LINEAR, mag_filter=LINEAR)
    state = replace(draw.state, texture_units=(replace(unit, sampler=sampler),))
    commands = store, replace(draw, state=state)
    machine = execute(commands, OF_ANY_BORDER, 12, 10, record=True)
    ideal = execute_ideal(commands, 12, 10, guide=machine)
    difference = abs(machine.framebuffer.color / 255.0 - ideal.color)
    assert difference.max() < 3.0 / 256.0 + 1.5 / 255.0


@pytest.mark.parametrize(
    ("image", "words"),
    [
        (texture_2d(np.zeros((6, 6, 4), np.uint8), border=2), "a border of 2; GeForce 256 takes 0 or 1"),
        (texture_2d(np.zeros((2, 6, 4), np.uint8), border=1), "needs at least 1x1 and its border of 1"),
        (
            replace(
                texture_2d(np.zeros((4, 4, 4), np.uint8), border=1),
                levels=(np.zeros((1, 4, 4, 4), np.uint8),) * 2,
            ),
            "level 1 of a 2x2 texture with a border of 1 is 4x4; it takes 3x3",
        ),
        (replace(texture_2d(np.zeros((4, 4, 4), np.uint8)), border=-1), "border is -1"),
        (texture_2d(np.zeros((4, 5, 4), np.uint8), border=1), "the texture is 3x2"),
    ],
)
def test_borders_that_do_not_fit_are_refused(image, words):
    with pytest.raises(UnsupportedState, match=words):
        validate(shown(image, Sampler(NEAREST, NEAREST), 0.0, 1.0), GEFORCE_256, 4, 4)


def test_copies_into_a_border_are_refused():
    store, _ = shown(texture_2d(np.zeros((4, 4, 4), np.uint8), border=1), Sampler(), 0.0, 1.0)
    copy = CopyTexSubImage(label="copy", texture="bordered", width=1, height=1)
    with pytest.raises(UnsupportedState, match="has a border of 1, and copies into such textures"):
        validate((store, copy), GEFORCE_256, 4, 4)


def test_mipmaps_of_a_border_are_refused():
    with pytest.raises(ValueError, match="border of 1 are not generated"):
        texture_2d(np.zeros((4, 4, 4), np.uint8), border=1, mipmaps=True)
