"""Comparisons, footprint assembly and volumes: every engine equals the specification; rules by themselves."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Clear, CopyTexImage, Draw, Mesh, ReadPixels, TexImage
from fixedpipe.pipeline.enums import (
    BaseFormat,
    ComparisonFunction,
    InternalFormat,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.profiles import (
    GEFORCE_3,
    GEFORCE_256,
    INFINITE_REALITY,
    NV2A,
    OPENGL_1_2,
    SCHILLING,
    TEXRAM,
)
from fixedpipe.pipeline.state import (
    DepthTest,
    PassState,
    Sampler,
    SignedComponents,
    TextureEnvironment,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import Texture, depth_texels, texture_2d, texture_3d
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.raster.portable.check import MOST_PROBES
from fixedpipe.raster.portable.footprint import share_of_a_probe
from tests.reference import texel_formats
from tests.support.run_reference import run_reference
from tests.support.strategies import SHOW_TEXTURE, seeds, textured_frame

WIDTH, HEIGHT = 16, 8
MODES = (BaseFormat.LUMINANCE, BaseFormat.INTENSITY, BaseFormat.ALPHA)
# A machine that no one built: everything that a sampler may ask for.
MACHINE = GEFORCE_3.changed(
    max_probes=16,
    exact_probes=True,
    shadow_ambient=True,
    depth_texture_modes=MODES,
    device_origin=OPENGL_1_2.arithmetic.device_origin,
)
NEAREST, LINEAR = TextureFilter.NEAREST, TextureFilter.LINEAR
COMPARES = TextureCompareMode.COMPARE_R_TO_TEXTURE
SHADOW = Sampler(NEAREST, NEAREST, compare_mode=COMPARES)
_DEPTH_16 = InternalFormat.DEPTH_COMPONENT16


def frozen(levels):
    for level in levels:
        level.setflags(write=False)
    return tuple(levels)


def depth_image(random, width, height):
    """A depth texture with all levels, its depths anything."""
    levels, internal_format = [], InternalFormat(int(random.choice([24, 25])))
    most = 0xFFFF if internal_format is InternalFormat.DEPTH_COMPONENT16 else 0xFFFFFF
    while not levels or max(levels[-1].shape[1:3]) > 1:
        shape = max(1, height >> len(levels)), max(1, width >> len(levels))
        levels.append(depth_texels(random.choice([0, most // 2, most, random.integers(most)], shape))[None])
    return Texture(TextureTarget.TEXTURE_2D, internal_format, frozen(levels))


def frame_of(seed, kind):
    """A textured frame whose unit compares a depth texture, or reads its depths, a volume, or footprints."""
    random = np.random.default_rng(seed)
    image, draw = textured_frame(seed, WIDTH, HEIGHT)
    (unit,), mesh = draw.state.texture_units, draw.mesh
    width, height = (1 << random.integers(0, 5, 2)).tolist()
    sampler = replace(unit.sampler, max_anisotropy=1.0, min_filter=TextureFilter(int(random.integers(6))))
    if kind == "compare":
        texture = depth_image(random, width, height)
        sampler = replace(
            sampler,
            compare_mode=COMPARES,
            compare_function=ComparisonFunction(int(random.integers(8))),
            compare_fail_value=float(random.choice([0.0, random.random()])),
            depth_texture_mode=random.choice([None, *MODES]),
            wrap_s=WrapMode.REPEAT,
            wrap_t=WrapMode.CLAMP_TO_EDGE,
        )
    elif kind == "depths":
        texture = depth_image(random, width, height)
        border = tuple(random.random(4).tolist())
        sampler = replace(sampler, depth_texture_mode=random.choice([None, *MODES]), border_color=border)
    elif kind == "volume":
        shape = (int(random.choice([1, 2, 4, 8])), height, width, 4)
        texture = texture_3d(random.integers(0, 256, shape, np.uint8), mipmaps=True)
        sampler = replace(sampler, wrap_r=WrapMode(int(random.integers(5))))
    else:
        texture = texture_2d(random.integers(0, 256, (height, width, 4), np.uint8), mipmaps=True)
    if kind == "footprint" or (random.random() < 0.3 and kind in ("compare", "depths")):
        sampler = replace(sampler, max_probes=int(random.choice([2, 4, 8, 16])))
        if random.random() < 0.5:
            sampler = replace(sampler, max_probes=int(random.integers(2, 17)), exact_probes=True)
    if kind == "footprint" and random.random() < 0.3:
        sampler = replace(sampler, signed_components=SignedComponents(True, False, False, True))
    coordinates = np.ones((len(mesh.positions), 4))
    given_coordinates = mesh.texture_coordinates[0]
    coordinates[:, : given_coordinates.shape[1]] = given_coordinates
    if kind == "footprint":  # long footprints, in any direction
        coordinates[:, :2] *= random.choice([0.1, 1.0, 8.0], 2)
    coordinates[:, 2] = random.uniform(-0.5, 1.5, len(coordinates))
    mesh = replace(mesh, texture_coordinates=(coordinates,))
    unit = replace(unit, sampler=sampler)
    state = replace(draw.state, texture_units=(unit,))
    if kind == "depths" and random.random() < 0.7:  # register combiners look at no mode
        state = replace(state, register_combiners=None)
    return (replace(image, image=texture), replace(draw, mesh=mesh, state=state))


def assert_every_engine_equals_the_specification(commands, profile, batch):
    expected = run_reference(commands, profile, WIDTH, HEIGHT, 24)
    for engine in (None, "portable", "columns"):
        got = execute(commands, profile, WIDTH, HEIGHT, depth_bits=24, threads=1, batch=batch, engine=engine)
        np.testing.assert_array_equal(
            got.framebuffer.color, np.array(expected.target.color), err_msg=str(engine)
        )


batches = st.sampled_from((16, 17, 256))


@pytest.mark.parametrize("kind", ["compare", "depths", "volume", "footprint"])
@settings(max_examples=60)
@given(seeds, batches)
def test_every_engine_equals_the_specification(kind, seed, batch):
    assert_every_engine_equals_the_specification(frame_of(seed, kind), MACHINE, batch)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["compare", "depths", "volume", "footprint"])
@settings(max_examples=3000)
@given(seeds, batches)
def test_thousands_of_frames_equal_the_specification(kind, seed, batch):
    assert_every_engine_equals_the_specification(frame_of(seed, kind), MACHINE, batch)


# ------------------------------------------------------------------------------------- footprint assembly


def window(coordinates, units, **state):
    """A Draw over the whole window, whose corners (lower left, lower right, upper right, upper left) have
    these coordinates.
    """
    corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
    mesh = Mesh(
        np.array(corners), indices=[0, 1, 2, 0, 2, 3], texture_coordinates=(np.array(coordinates, float),)
    )
    return Draw(label="window", mesh=mesh, state=PassState(texture_units=units, **state))


SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
PYRAMID = Sampler(TextureFilter.NEAREST_MIPMAP_NEAREST, NEAREST)


@pytest.mark.parametrize("turned", [False, True])
def test_as_many_probes_as_texels_lie_along_a_pixel_are_averaged(turned):
    texels = np.random.default_rng(2).integers(0, 256, (8, 64, 4), np.uint8)
    expected = texels.reshape(8, 8, 8, 4).sum(2) >> 3
    image = texels.swapaxes(0, 1).copy() if turned else texels
    commands = [
        TexImage(label="t", texture="t", image=texture_2d(image, mipmaps=True)),
        window(SQUARE, (TextureUnit("t", replace(PYRAMID, max_probes=8)),), register_combiners=SHOW_TEXTURE),
    ]
    machine = MACHINE.changed(max_probes=8)
    got = execute(commands, machine, 8, 8, depth_bits=24).framebuffer.color[::-1]
    np.testing.assert_array_equal(got.swapaxes(0, 1) if turned else got, expected)


def test_a_share_of_a_sum_of_probes_is_the_quotient_for_every_sum():
    for probes in range(1, MOST_PROBES + 1):
        share = int(share_of_a_probe.py_func(float(probes)))
        assert share < 2**17
        for total in range(255 * probes + 1):
            assert total * share >> 16 == total // probes
            assert total * share < 2**31


@pytest.mark.parametrize(
    ("texels_across", "most", "probes", "level", "exact"),
    [
        (4, 8, 4, 0, False),
        (8, 2, 2, 2, False),
        (16, 4, 4, 2, False),
        (8, 11, 8, 0, True),
        (16, 2, 2, 3, True),
    ],
)
def test_probes_are_limited_and_then_read_coarser_levels(texels_across, most, probes, level, exact):
    levels = [np.zeros((1, max(1, 8 >> k), max(1, 8 * texels_across >> k), 4), np.uint8) for k in range(8)]
    levels = [image for k, image in enumerate(levels) if k == 0 or max(levels[k - 1].shape[1:3]) > 1]
    random = np.random.default_rng(3)
    levels[level] = random.integers(0, 256, levels[level].shape, np.uint8)
    image = Texture(TextureTarget.TEXTURE_2D, InternalFormat.RGBA8, frozen(levels))
    unit = TextureUnit("t", replace(PYRAMID, max_probes=most, exact_probes=exact))
    commands = [
        TexImage(label="t", texture="t", image=image),
        window(SQUARE, (unit,), register_combiners=SHOW_TEXTURE),
    ]
    got = execute(commands, MACHINE.changed(max_probes=most), 8, 8, depth_bits=24).framebuffer.color[::-1]
    wide = levels[level][0].shape[1]
    at = np.arange(8)[:, None] + (2 * np.arange(probes) + 1) / (2 * probes)  # the probes, in pixels
    rows = np.arange(8) >> level
    expected = levels[level][0][rows][:, np.floor(at * wide / 8).astype(int)].astype(int).sum(2) // probes
    np.testing.assert_array_equal(got, expected)


# ------------------------------------------------------------------------------------------------ shadows


@pytest.mark.parametrize(
    ("mode", "held", "failed"),
    [
        (BaseFormat.LUMINANCE, (255, 255, 255, 255), (77, 77, 77, 255)),
        (BaseFormat.INTENSITY, (255, 255, 255, 255), (77, 77, 77, 77)),
        (BaseFormat.ALPHA, (0, 0, 0, 255), (0, 0, 0, 77)),
        (None, (255, 255, 255, 255), (77, 77, 77, 255)),
    ],
)
def test_what_a_comparison_gives(mode, held, failed):
    image = Texture(
        TextureTarget.TEXTURE_2D,
        InternalFormat.DEPTH_COMPONENT16,
        (depth_texels(np.array([[0x8000]]))[None],),
    )
    sampler = Sampler(
        NEAREST, NEAREST, compare_mode=COMPARES, compare_function=ComparisonFunction.LEQUAL,
        compare_fail_value=0.3, depth_texture_mode=mode,
    )  # fmt: skip
    coordinates = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 0.0]]
    commands = [
        TexImage(label="t", texture="t", image=image),
        window(coordinates, (TextureUnit("t", sampler),), register_combiners=SHOW_TEXTURE),
    ]
    machine = MACHINE.changed(depth_texture_modes=(BaseFormat.LUMINANCE, *MODES[1:]))
    row = execute(commands, machine, 8, 2, depth_bits=24).framebuffer.color[0].tolist()
    assert row == [list(held)] * 4 + [list(failed)] * 4


def test_a_shadow_map_of_23_bits_is_copied_and_compared():
    """InfiniteReality: what hides the light is drawn, its depths become a texture, and shade the window."""
    hides = Mesh(
        [[-1.0, -1.0, -0.5], [0.0, -1.0, -0.5], [0.0, 1.0, -0.5], [-1.0, 1.0, -0.5]],
        indices=[0, 1, 2, 0, 2, 3],
    )
    copy = CopyTexImage(
        label="shadow map", texture="map", target=TextureTarget.TEXTURE_2D,
        internal_format=InternalFormat.DEPTH_COMPONENT24, x=0, y=0, width=16, height=8,
    )  # fmt: skip
    sampler = Sampler(
        NEAREST, NEAREST, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE, compare_mode=COMPARES,
        compare_function=ComparisonFunction.LEQUAL, compare_fail_value=0.25,
    )  # fmt: skip
    state = PassState(depth_test=DepthTest(ComparisonFunction.LESS))
    receiver = window([[*st, 0.5] for st in SQUARE], (TextureUnit("map", sampler),))
    commands = [
        Clear(label="clear", color=(0.0,) * 4, depth=1.0),
        Draw(label="what hides", mesh=hides, state=state),
        ReadPixels(label="depths", name="depths", format="DEPTH_COMPONENT"),
        copy,
        receiver,
    ]
    for bits, one in ((8, 255), (12, 4095)):
        got = execute(commands, INFINITE_REALITY, 16, 8, color_bits=bits)
        depths = got.pixels["depths"]
        assert sorted(set(depths.ravel().tolist())) == [(1 << 21) - 1, (1 << 23) - 1]
        words = got.textures["map"].levels[0].view(np.uint32)[0, ..., 0]
        expected = np.floor(depths / (2**23 - 1) * (2**24 - 1) + 0.5)
        np.testing.assert_array_equal(words, expected)
        red = got.framebuffer.color[..., 0]
        assert (red[:, :8] == round(64 * one / 255)).all()
        assert (red[:, 8:] == one).all()


# ---------------------------------------------------------------------------- depths without a comparison

EVERY_WORD = np.arange(1 << 16).reshape(256, 256)


def depth_texture_of(words, internal_format):
    return Texture(TextureTarget.TEXTURE_2D, internal_format, (depth_texels(words)[None],))


def pictures_of_depths(internal_format, words, mode, profile, **window_of):
    """The window, [y, x] from below, that shows a depth texture of its size, by every engine."""
    sampler = Sampler(NEAREST, NEAREST, depth_texture_mode=mode)
    unit = TextureUnit("t", sampler, environment=TextureEnvironment(TextureEnvironmentMode.REPLACE))
    commands = [
        TexImage(label="t", texture="t", image=depth_texture_of(words, internal_format)),
        window(SQUARE, (unit,)),
    ]
    for engine in (None, "portable", "columns"):
        shown = execute(commands, profile, *words.shape[::-1], engine=engine, **window_of)
        yield shown.framebuffer.color[::-1].astype(int)


@pytest.mark.parametrize(
    ("mode", "filled"),
    [
        (BaseFormat.LUMINANCE, (True, True, True, None)),
        (BaseFormat.INTENSITY, (True, True, True, True)),
        (BaseFormat.ALPHA, (None, None, None, True)),
    ],
)
@pytest.mark.parametrize("bits", [8, 12])
def test_depths_are_read_as_the_highest_bits_of_every_word(mode, filled, bits):
    """A component that the mode fills is the word's highest bits; others are the primary color's, white."""
    machine = INFINITE_REALITY.changed(depth_texture_modes=MODES, texture_bits=bits)
    one = (1 << bits) - 1
    for internal_format, low in (
        (InternalFormat.DEPTH_COMPONENT16, 0),
        (InternalFormat.DEPTH_COMPONENT24, 0x00),
        (InternalFormat.DEPTH_COMPONENT24, 0xFF),
    ):
        deeper = 8 if internal_format is InternalFormat.DEPTH_COMPONENT24 else 0
        expected = EVERY_WORD >> (16 - bits)
        words = EVERY_WORD << deeper | low
        for shown in pictures_of_depths(internal_format, words, mode, machine, color_bits=bits):
            for channel, fills in enumerate(filled):
                np.testing.assert_array_equal(shown[..., channel], expected if fills else one)


@pytest.mark.parametrize("mode", [None, *MODES])
def test_register_combiners_read_depths_as_alpha_whatever_the_mode(mode):
    sampler = Sampler(NEAREST, NEAREST, depth_texture_mode=mode)
    commands = [
        TexImage(label="t", texture="t", image=depth_texture_of(np.full((1, 1), 0xABCD), _DEPTH_16)),
        window(SQUARE, (TextureUnit("t", sampler),), register_combiners=SHOW_TEXTURE),
    ]
    assert execute(commands, GEFORCE_3, 1, 1).framebuffer.color[0, 0].tolist() == [0, 0, 0, 0xAB]
    alpha = execute_ideal(commands, 1, 1).color[0, 0]
    np.testing.assert_allclose(alpha, [0, 0, 0, 0xABCD / 0xFFFF], atol=1e-12)  # float64


def test_a_kept_draw_whose_depth_texture_becomes_one_of_colors_is_drawn_anew():
    deep = TexImage(label="t", texture="t", image=depth_texture_of(np.zeros((1, 1), int), _DEPTH_16))
    red = TexImage(label="t", texture="t", image=texture_2d(np.array([[[1.0, 0.0, 0.0]]])))
    unit = TextureUnit("t", Sampler(NEAREST, NEAREST))
    draw, clear = window(SQUARE, (unit,)), Clear(label="clear", color=(0.5,) * 4)
    for first, second, color in ((deep, red, [255, 0, 0]), (red, deep, [0, 0, 0])):
        shown = execute((first, draw, second, clear, draw), GEFORCE_3, 1, 1).framebuffer.color
        assert shown[0, 0, :3].tolist() == color


def test_two_units_read_one_depth_texture_by_a_comparison_and_without():
    """The shadow, times the depth: one texture, two samplers."""
    word = np.full((1, 1), 0xC000)
    units = (
        TextureUnit("t", replace(SHADOW, compare_function=ComparisonFunction.LEQUAL)),
        TextureUnit("t", Sampler(NEAREST, NEAREST, depth_texture_mode=BaseFormat.LUMINANCE)),
    )
    mesh = window([[0.0, 0.0, 0.5]] * 4, units).mesh
    mesh = replace(mesh, texture_coordinates=mesh.texture_coordinates * 2)
    commands = [
        TexImage(label="t", texture="t", image=depth_texture_of(word, _DEPTH_16)),
        Draw(label="window", mesh=mesh, state=PassState(texture_units=units)),
    ]
    assert execute(commands, GEFORCE_3, 1, 1).framebuffer.color[0, 0].tolist() == [0xC0, 0xC0, 0xC0, 255]


def test_the_ideal_reads_whole_depths():
    depths = np.array([[0.25, 0.75], [1.0, 0.1]])
    commands = [
        TexImage(
            label="t", texture="t", internal_format=_DEPTH_16, pixels=PixelImage(depths, "DEPTH_COMPONENT")
        ),
        window(SQUARE, (TextureUnit("t", Sampler(LINEAR, LINEAR, WrapMode.CLAMP_TO_EDGE)),)),
    ]
    color = execute_ideal(commands, 1, 1).color[0, 0]
    np.testing.assert_allclose(color[:3], depths.mean(), atol=1e-12)  # float64, and LUMINANCE


# ----------------------------------------------------------------------------------------------- the ideal


def test_the_ideal_averages_probes_without_rounding():
    texels = np.random.default_rng(2).random((8, 64, 4))
    commands = [
        TexImage(label="t", texture="t", image=texture_2d(texels, mipmaps=True)),
        window(SQUARE, (TextureUnit("t", replace(PYRAMID, max_probes=8)),), register_combiners=SHOW_TEXTURE),
    ]
    color = execute_ideal(commands, 8, 8).color[::-1]
    np.testing.assert_allclose(color, texels.reshape(8, 8, 8, 4).mean(2), atol=1e-12)


@pytest.mark.parametrize(
    "most",
    [
        {"max_probes": 8},
        {"max_probes": 7, "exact_probes": True},
        {"max_anisotropy": 8.0},
        {"max_anisotropy": 1.5},
    ],
    ids=str,
)
def test_the_ideal_s_footprints_are_the_machine_s_but_for_rounding(most):
    random = np.random.default_rng(6)
    steps = np.linspace(0.0, 1.0, 32)
    image = texture_2d(
        np.stack([np.sin(steps[:, None] * 9 + steps * k) / 2 + 0.5 for k in (3, 5, 7, 9)], axis=-1)
    )
    image = texture_2d(image.ideal[0][0], mipmaps=True)
    unit = TextureUnit("t", Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, LINEAR, **most))
    for _ in range(4):
        coordinates = (
            (np.array(SQUARE) - 0.5) * (random.uniform(1, 8), 0.4) @ np.array([[0.8, 0.6], [-0.6, 0.8]])
        )
        commands = [
            TexImage(label="t", texture="t", image=image),
            window(coordinates, (unit,), register_combiners=SHOW_TEXTURE),
        ]
        machine = execute(commands, MACHINE.changed(**most), 16, 16).framebuffer.color / 255.0
        assert np.abs(machine - execute_ideal(commands, 16, 16).color).max() < 3.5 / 255


def test_the_ideal_compares_before_it_filters():
    depths = np.array([[0.25, 0.75, 0.25, 0.75]])
    image = Texture(
        TextureTarget.TEXTURE_2D,
        InternalFormat.DEPTH_COMPONENT24,
        (depth_texels(np.floor(depths * 0xFFFFFF).astype(np.int64))[None],),
    )
    sampler = Sampler(
        LINEAR, LINEAR, compare_mode=COMPARES, compare_function=ComparisonFunction.LEQUAL,
        compare_fail_value=0.3,
    )  # fmt: skip
    draw = window(
        [[*st, 1.0, 2.0] for st in SQUARE], (TextureUnit("t", sampler),), register_combiners=SHOW_TEXTURE
    )
    double = replace(draw.mesh, texture_coordinates=(draw.mesh.texture_coordinates[0] * (2, 2, 1, 1),))
    commands = [TexImage(label="t", texture="t", image=image), replace(draw, mesh=double)]
    color = execute_ideal(commands, 8, 2).color
    held = np.array([0.25, 0.25, 0.75, 0.75, 0.25, 0.25, 0.75, 0.75])
    np.testing.assert_allclose(color[0, :, 0], 0.3 + 0.7 * held, atol=1e-9)
    assert (color[..., 3] == 1.0).all()
    machine = execute(commands, MACHINE.changed(depth_texture_modes=MODES), 8, 2).framebuffer.color
    assert np.abs(machine / 255.0 - color).max() <= 2 / 255


# ---------------------------------------------------------------------------------------------- 3D textures


@pytest.mark.parametrize("shape", [(1, 4, 8), (8, 2, 2), (4, 4, 4), (2, 1, 16)])
def test_volumes_are_halved_in_all_directions(shape):
    texels = np.random.default_rng(4).integers(0, 256, (*shape, 4), np.uint8)
    levels = texture_3d(texels, mipmaps=True).levels
    expected = [texels.tolist()]
    while max(len(expected[-1]), len(expected[-1][0]), len(expected[-1][0][0])) > 1:
        expected.append(texel_formats.next_volume(expected[-1]))
    assert [level.tolist() for level in levels] == expected


def test_volumes_of_odd_edges_have_no_mipmaps():
    with pytest.raises(ValueError, match="4x2x3 level need even edges"):
        texture_3d(np.zeros((3, 2, 4, 4)), mipmaps=True)
    with pytest.raises(ValueError, match="layers, height, width"):
        texture_3d(np.zeros((2, 4, 4)))


@pytest.mark.parametrize(
    "filters", [(NEAREST, NEAREST), (LINEAR, LINEAR), (TextureFilter.LINEAR_MIPMAP_LINEAR, LINEAR)]
)
def test_volumes_on_a_plain_board_equal_the_specification(filters):
    random = np.random.default_rng(5)
    image = texture_3d(random.integers(0, 256, (4, 8, 8, 4), np.uint8), mipmaps=True)
    commands = [TexImage(label="t", texture="t", image=image)]
    for q in (1.0, 0.5):
        coordinates = np.column_stack([random.uniform(-1, 4, (4, 3)), [1.0, q, q, 1.0]])
        unit = TextureUnit("t", Sampler(*filters, wrap_r=WrapMode.CLAMP_TO_EDGE))
        commands.append(window(coordinates, (unit,)))
        assert_every_engine_equals_the_specification(commands, OPENGL_1_2, 64)


# ------------------------------------------------------------------------------------------------- refusals


def refusal(sampler, profile, image):
    commands = [
        TexImage(label="t", texture="t", image=image),
        window([[*st, 0.5] for st in SQUARE], (TextureUnit("t", sampler),)),
    ]
    with pytest.raises(UnsupportedState) as refused:
        execute(commands, profile, 8, 8)
    return str(refused.value)


COLORS = texture_2d(np.zeros((4, 4, 4)), mipmaps=True)
DEPTHS = Texture(
    TextureTarget.TEXTURE_2D,
    InternalFormat.DEPTH_COMPONENT24,
    (depth_texels(np.zeros((4, 4), np.int64))[None],),
)


@pytest.mark.parametrize(
    ("sampler", "profile", "image", "words"),
    [
        (replace(PYRAMID, max_probes=2), GEFORCE_256, COLORS, "takes up to 1"),
        (replace(PYRAMID, max_probes=3), TEXRAM, COLORS, "give a power of two, or 1"),
        (replace(PYRAMID, max_probes=3), SCHILLING, COLORS, "give a power of two, or set exact_probes"),
        (replace(PYRAMID, max_probes=9, exact_probes=True), SCHILLING, COLORS, "takes up to 8"),
        (replace(PYRAMID, max_probes=4, exact_probes=True), TEXRAM, COLORS, "has powers of two"),
        (replace(PYRAMID, max_probes=4, exact_probes=True), NV2A, COLORS, "has no probes"),
        (replace(PYRAMID, max_probes=16), TEXRAM, COLORS, "takes up to 8"),
        (
            replace(PYRAMID, max_probes=2, max_anisotropy=2.0),
            GEFORCE_256.changed(max_probes=8),
            COLORS,
            "one of them",
        ),
        (replace(SHADOW, compare_function=ComparisonFunction.LESS), INFINITE_REALITY, DEPTHS, "GEQUAL"),
        (replace(SHADOW, compare_fail_value=0.5), GEFORCE_3, DEPTHS, "no shadow ambient"),
        (replace(SHADOW, compare_fail_value=1.5), INFINITE_REALITY, DEPTHS, "give 0 to 1"),
        (replace(PYRAMID, compare_fail_value=0.5), INFINITE_REALITY, COLORS, "in comparisons alone"),
        (replace(SHADOW, depth_texture_mode=BaseFormat.ALPHA), INFINITE_REALITY, DEPTHS, "has LUMINANCE"),
        (replace(PYRAMID, depth_texture_mode=BaseFormat.ALPHA), GEFORCE_3, COLORS, "holds no depths"),
        (SHADOW, GEFORCE_3, COLORS, "only depth textures are compared. Give NONE"),
        (Sampler(NEAREST, NEAREST), NV2A, DEPTHS, "reads such textures by comparing alone"),
        (
            Sampler(NEAREST, NEAREST, depth_texture_mode=BaseFormat.ALPHA),
            INFINITE_REALITY,
            DEPTHS,
            "has LUMINANCE. Give None",
        ),
        (
            Sampler(NEAREST, NEAREST),
            GEFORCE_3,
            replace(DEPTHS, internal_format=InternalFormat.DEPTH_COMPONENT16_FLOAT),
            "by comparing alone",
        ),
    ],
)
def test_what_a_machine_has_not_is_refused(sampler, profile, image, words):
    assert words in refusal(sampler, profile, image)
