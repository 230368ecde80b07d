"""Texture environments: the tables' own values, compiled programs against them, rendered frames, refusals."""

import random
from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import (
    BaseFormat,
    Clamp,
    CombineFunction,
    CombineOperand,
    CombineSource,
    InternalFormat,
    PrimitiveType,
    ProductRounding,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import G400, GEFORCE_3, GEFORCE_256, IDEAL, MULTITEXTURE, NV2A
from fixedpipe.pipeline.programs.combiner_rules import combiner_program
from fixedpipe.pipeline.state import (
    ColorTable,
    Combine,
    Fog,
    PassState,
    Sampler,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
    environment,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.reference import combine, fog, texture_environment
from tests.support.random_environments import BYTES, random_color, random_environment
from tests.support.run_reference import run_reference

MODE, FUNCTION = TextureEnvironmentMode, CombineFunction
SOURCE, OPERAND = CombineSource, CombineOperand
ADD_SIGNED_BY_FOUR = GEFORCE_3.changed(add_signed_scale_by_four=True)
CROSSBAR = MULTITEXTURE.changed(texture_environment_crossbar=True)
# An internal format for each base format.
FORMATS = {
    BaseFormat.ALPHA: InternalFormat.ALPHA8,
    BaseFormat.LUMINANCE: InternalFormat.LUMINANCE8,
    BaseFormat.LUMINANCE_ALPHA: InternalFormat.LUMINANCE8_ALPHA8,
    BaseFormat.INTENSITY: InternalFormat.INTENSITY8,
    BaseFormat.RGB: InternalFormat.RGB8,
    BaseFormat.RGBA: InternalFormat.RGBA8,
}
CONVENTIONAL = (MODE.MODULATE, MODE.REPLACE, MODE.DECAL, MODE.BLEND, MODE.ADD)
NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)


def unit(mode=MODE.MODULATE, name="a", color=(0.0, 0.0, 0.0, 0.0), sampler=NEAREST, **halves):
    return TextureUnit(name, sampler, environment=TextureEnvironment(mode, color, **halves))


def combined(function, sources=None, operands=None, scale=1.0, alpha=None):
    """A unit that combines; alpha REPLACE by the texture where nothing is said."""
    rgb = Combine(function, scale=scale)
    if sources is not None:
        rgb = replace(rgb, sources=sources)
    if operands is not None:
        rgb = replace(rgb, operands=operands)
    alpha = alpha or Combine(FUNCTION.REPLACE, operands=(OPERAND.SRC_ALPHA,) * 3)
    return unit(MODE.COMBINE, rgb=rgb, alpha=alpha)


def images(*internal_formats):
    """Textures "a", "b", ... as far as environments know them."""
    return {"abcd"[i]: SimpleNamespace(internal_format=f) for i, f in enumerate(internal_formats)}


RGBA = images(*[InternalFormat.RGBA8] * 4)


def in_register(texel, base):
    """Four bytes as a texture of the base format hands them to a register."""
    r, g, b, a = texel
    return {
        BaseFormat.ALPHA: [0, 0, 0, a],
        BaseFormat.LUMINANCE: [r, r, r, 255],
        BaseFormat.LUMINANCE_ALPHA: [r, r, r, a],
        BaseFormat.INTENSITY: [r, r, r, r],
        BaseFormat.RGB: [r, g, b, 255],
        BaseFormat.RGBA: [r, g, b, a],
    }[base]


def specified(state, primary, texels, profile=GEFORCE_3, textures=RGBA):
    return list(texture_environment.textured_color(primary, texels, state, textures, profile))


def with_every_clamp(profile):
    """A profile's combiners in bytes; the ideal's profile, too, whose clamps are off."""
    on = dict.fromkeys(("mapping", "general_combiner", "color_sum", "final_combiner"), True)
    return replace(combine.machine_of(profile), **on)


def compiled(state, primary, texels, profile=GEFORCE_3, textures=RGBA):
    """The color that the compiled program gives in the specification of the combiners."""
    program = combiner_program(state, profile, textures)
    if program is None:
        return list(primary)
    registers = combine.initial_registers(primary, [0, 0, 0], texels, [0, 0, 0, 255])
    return combine.combine(program, registers, with_every_clamp(profile))


def assert_compiled(units, colors, profile=GEFORCE_3, textures=RGBA):
    """``colors``: (primary, texel of each unit) pairs."""
    state = PassState(texture_units=units)
    for primary, *texels in colors:
        expected = specified(state, primary, texels, profile, textures)
        assert compiled(state, primary, texels, profile, textures) == expected, (primary, texels)


# ----------------------------------------------------------------------------------------- known values


@pytest.mark.parametrize(
    ("units", "expected"),
    [
        ((unit(),), [78, 49, 20, 161]),
        ((unit(MODE.REPLACE),), [100, 50, 20, 205]),
        ((unit(MODE.DECAL),), [120, 89, 66, 200]),
        ((unit(MODE.BLEND, color=(1.0, 0.0, 0.2, 0.0)),), [222, 201, 239, 161]),
        ((unit(MODE.ADD),), [255, 255, 255, 161]),
        ((combined(FUNCTION.REPLACE),), [100, 50, 20, 205]),
        ((combined(FUNCTION.MODULATE, scale=2.0),), [156, 98, 40, 205]),
        ((combined(FUNCTION.MODULATE, scale=4.0),), [255, 196, 80, 205]),
        ((combined(FUNCTION.ADD_SIGNED),), [172, 172, 147, 205]),
        ((combined(FUNCTION.ADD_SIGNED, scale=2.0),), [255, 255, 255, 205]),
        ((combined(FUNCTION.SUBTRACT),), [0, 0, 0, 205]),
        ((combined(FUNCTION.SUBTRACT, (SOURCE.PREVIOUS, SOURCE.TEXTURE)),), [100, 200, 235, 205]),
        (
            (combined(FUNCTION.SUBTRACT), combined(FUNCTION.SUBTRACT, (SOURCE.TEXTURE, SOURCE.PREVIOUS))),
            [7, 8, 9, 10],
        ),  # what is negative is zero before the next unit reads it
        # (2a - 256) . (2b - 256): (-56, -156, -216) . (144, 244, 254) = -100992
        ((combined(FUNCTION.DOT3_RGB),), [0, 0, 0, 205]),
        ((combined(FUNCTION.DOT3_RGB, (SOURCE.PREVIOUS,) * 2),), [255, 255, 255, 205]),
        ((unit(MODE.NONE),), [200, 250, 255, 200]),
        ((unit(), unit(MODE.REPLACE)), [7, 8, 9, 10]),
    ],
)
def test_known_values(units, expected):
    primary, texels = [200, 250, 255, 200], [[100, 50, 20, 205], [7, 8, 9, 10]][: len(units)]
    state = PassState(texture_units=units)
    assert specified(state, primary, texels) == expected
    assert compiled(state, primary, texels) == expected


def test_the_half_is_128():
    """Two equal alphas compare as 127; a normal of (128, 128, 255) by itself is 253."""
    difference = Combine(
        FUNCTION.ADD_SIGNED, (SOURCE.TEXTURE,) * 2, (OPERAND.SRC_ALPHA, OPERAND.ONE_MINUS_SRC_ALPHA)
    )
    dot = Combine(FUNCTION.DOT3_RGB, (SOURCE.TEXTURE, SOURCE.TEXTURE))
    state = PassState(texture_units=(unit(MODE.COMBINE, rgb=dot, alpha=difference),))
    for alpha in range(256):
        texel = [[128, 128, 255, alpha]]
        assert specified(state, [0] * 4, texel) == compiled(state, [0] * 4, texel) == [253, 253, 253, 127]


def test_a_dot_product_takes_one_minus_a_byte():
    """255 - 0 reads as 254, which EXPAND_NEGATE of 0, 256 (at most 255), would not be."""
    inverted = combined(
        FUNCTION.DOT3_RGB, (SOURCE.TEXTURE, SOURCE.PREVIOUS), (OPERAND.ONE_MINUS_SRC_COLOR, OPERAND.SRC_COLOR)
    )
    state = PassState(texture_units=(inverted,))
    for primary, expected in (([255, 128, 128, 0], 253), ([129, 128, 128, 0], 2)):
        assert specified(state, primary, [[0, 0, 0, 0]])[0] == expected
        assert compiled(state, primary, [[0, 0, 0, 0]])[0] == expected


def test_dot3_rgba_takes_both_scales_and_no_alpha_function():
    alpha = Combine(FUNCTION.SUBTRACT, operands=(OPERAND.SRC_ALPHA,) * 3, scale=4.0)
    state = PassState(texture_units=(combined(FUNCTION.DOT3_RGBA, scale=2.0, alpha=alpha),))
    for primary, texel in (([140, 128, 128, 9], [255, 128, 128, 8]), ([130, 128, 128, 9], [255, 0, 128, 8])):
        dot = (2 * texel[0] - 256) * (2 * primary[0] - 256) + (2 * texel[1] - 256) * (2 * primary[1] - 256)
        byte = max(0, round(dot / 255))
        expected = [min(255, 2 * byte)] * 3 + [min(255, 4 * byte)]
        assert specified(state, primary, [texel]) == compiled(state, primary, [texel]) == expected


def test_add_signed_takes_four_as_two_where_the_machine_does():
    units = (combined(FUNCTION.ADD_SIGNED, scale=4.0),)
    for profile, expected in ((GEFORCE_256, 44), (ADD_SIGNED_BY_FOUR, 88)):
        state = PassState(texture_units=units)
        for color in (specified, compiled):
            assert color(state, [90, 90, 90, 0], [[60, 60, 60, 0]], profile)[:3] == [expected] * 3


def test_depth_textures_are_what_their_mode_says():
    """A texel of (0, 0, 0, 7) by REPLACE; of LUMINANCE an alpha of one where a function reads it."""
    deep, texel = images(InternalFormat.DEPTH_COMPONENT24), [[0, 0, 0, 7]]
    for profile, mode, replaced, copied in (
        (GEFORCE_3, None, [0, 0, 0, 7], [0, 0, 0, 7]),  # INTENSITY is its usual one
        (GEFORCE_3, BaseFormat.LUMINANCE, [0, 0, 0, 4], [0, 0, 0, 255]),
        (GEFORCE_3, BaseFormat.ALPHA, [1, 2, 3, 7], [0, 0, 0, 7]),
        (IDEAL, None, [0, 0, 0, 4], [0, 0, 0, 255]),
    ):
        sampler = Sampler(depth_texture_mode=mode)
        for given, expected in ((unit(MODE.REPLACE), replaced), (combined(FUNCTION.REPLACE), copied)):
            state = PassState(texture_units=(replace(given, sampler=sampler),))
            for color in (specified, compiled):
                assert color(state, [1, 2, 3, 4], texel, profile, deep) == expected


def test_a_hilo_texture_passes_colors_on():
    state = PassState(texture_units=(combined(FUNCTION.REPLACE),))
    for color in (specified, compiled):
        assert color(state, [1, 2, 3, 4], [[0] * 4], NV2A, images(InternalFormat.HILO16)) == [1, 2, 3, 4]


def test_a_color_table_s_components_count():
    """REPLACE shows which components there are; every texture format by every table's."""
    for (base, internal_format), table in product(FORMATS.items(), FORMATS):
        given = replace(unit(MODE.REPLACE), color_table=ColorTable(((0.0,) * 4,) * 2, table))
        state, texel = PassState(texture_units=(given,)), [10, 20, 30, 40]
        expected = specified(state, [1, 2, 3, 4], [texel], textures=images(internal_format))
        assert compiled(state, [1, 2, 3, 4], [texel], textures=images(internal_format)) == expected
        alone = BaseFormat.ALPHA
        alpha = base not in (BaseFormat.LUMINANCE, BaseFormat.RGB)
        alpha |= table not in (BaseFormat.LUMINANCE, BaseFormat.RGB)
        color = [1, 2, 3] if base is table is alone else texel[:3]
        assert expected == [*color, 40 if alpha else 4]


def test_a_disabled_unit_between_others_passes_its_color_on():
    state = PassState(texture_units=(unit(), None, unit(MODE.ADD)))
    for color in (specified, compiled):
        got = color(state, [255, 128, 0, 255], [[100, 100, 100, 100], [0, 0, 0, 255], [1, 2, 3, 255]])
        assert got == [101, 52, 3, 100]


def test_a_disabled_unit_s_texture_is_one_or_disables_who_names_it():
    named = combined(FUNCTION.REPLACE, (SOURCE.TEXTURE1,))
    alpha = Combine(FUNCTION.REPLACE, (SOURCE.TEXTURE1,), (OPERAND.SRC_ALPHA,))
    ignored = combined(FUNCTION.DOT3_RGBA, (SOURCE.PREVIOUS, SOURCE.CONSTANT), scale=2.0, alpha=alpha)
    later = combined(FUNCTION.REPLACE, (SOURCE.TEXTURE1,), (OPERAND.ONE_MINUS_SRC_COLOR,))
    for units, profile, expected in (
        ((named, None), GEFORCE_3, [255, 255, 255, 40]),
        ((named, unit(MODE.NONE)), GEFORCE_3, [5, 6, 7, 40]),  # a unit that passes its color on has a texel
        ((later, unit(MODE.NONE)), GEFORCE_3, [250, 249, 248, 40]),
        ((named, None), CROSSBAR, [1, 2, 3, 4]),
        ((ignored, None), CROSSBAR, [255, 255, 255, 255]),  # DOT3_RGBA has no alpha function
        ((named, unit(MODE.REPLACE)), CROSSBAR, [5, 6, 7, 8]),
    ):
        state = PassState(texture_units=units)
        for color in (specified, compiled):
            assert color(state, [1, 2, 3, 4], [[10, 20, 30, 40], [5, 6, 7, 8]], profile) == expected


def test_stages_of_texture_shaders_choose_the_function():
    operations = (
        (TextureShaderOperation.NONE, [1, 2, 3, 4]),
        (TextureShaderOperation.CULL_FRAGMENT, [1, 2, 3, 4]),
        (TextureShaderOperation.DOT_PRODUCT, [1, 2, 3, 4]),
        (TextureShaderOperation.PASS_THROUGH, [10, 20, 30, 40]),
        (TextureShaderOperation.TEXTURE_2D, [10, 20, 30, 4]),
    )
    for operation, expected in operations:
        stage = TextureShaderStage(operation)
        state = PassState(texture_units=(unit(MODE.REPLACE),), texture_shader=(stage,))
        for color in (specified, compiled):
            assert (
                color(state, [1, 2, 3, 4], [[10, 20, 30, 40]], NV2A, images(InternalFormat.RGB8)) == expected
            )


def test_negative_texels_count_as_zero():
    for given in (unit(), combined(FUNCTION.REPLACE, operands=(OPERAND.ONE_MINUS_SRC_COLOR,))):
        assert_compiled((given,), [([255, 128, 1, 255], [-256, -1, 127, -128])])


# --------------------------------------------------------------------------------- compiled, over grids


DEFINED = [
    (mode, base)
    for mode, base in product(CONVENTIONAL, FORMATS)
    if mode is not MODE.DECAL or base in (BaseFormat.RGB, BaseFormat.RGBA)
]


@pytest.mark.parametrize(("mode", "base"), DEFINED)
def test_every_mode_and_base_format_over_a_grid(mode, base):
    constant = tuple(b / 255.0 for b in (129, 1, 254, 128))
    pairs = [
        ([f, BYTES[i - 1], BYTES[i - 3], f], in_register([t, t, BYTES[i - 2], a], base))
        for (i, f), t, a in product(enumerate(BYTES), BYTES, BYTES)
    ]
    assert_compiled((unit(mode, color=constant),), pairs, textures=images(FORMATS[base]))


@pytest.mark.parametrize("function", [f for f in FUNCTION if f < FUNCTION.DOT3_RGB])
@pytest.mark.parametrize("scale", [1.0, 2.0, 4.0])
def test_every_function_and_scale_over_a_grid(function, scale):
    """Arg0 is the texture, Arg1 the fragment, Arg2 the texture's alpha, as in the initial state."""
    half = Combine(function, operands=(OPERAND.SRC_COLOR, OPERAND.SRC_COLOR, OPERAND.SRC_ALPHA), scale=scale)
    half = replace(half, sources=(SOURCE.TEXTURE, SOURCE.PREVIOUS, SOURCE.TEXTURE))
    given = unit(MODE.COMBINE, rgb=half, alpha=replace(half, operands=(OPERAND.SRC_ALPHA,) * 3))
    pairs = [
        ([f, BYTES[i - 1], BYTES[i - 3], f], [t, t, BYTES[i - 2], a])
        for (i, f), t, a in product(enumerate(BYTES), BYTES, BYTES)
    ]
    assert_compiled((given,), pairs, ADD_SIGNED_BY_FOUR)


@pytest.mark.parametrize("function", [FUNCTION.ADD, FUNCTION.ADD_SIGNED])
@pytest.mark.parametrize("scale", [1.0, 4.0])
def test_every_combine4_function_over_a_grid(function, scale):
    half = Combine(function, (SOURCE.TEXTURE, SOURCE.PREVIOUS) * 2, scale=scale)
    half = replace(
        half, operands=(OPERAND.SRC_COLOR, OPERAND.SRC_COLOR, OPERAND.SRC_ALPHA, OPERAND.SRC_ALPHA)
    )
    alphas = (OPERAND.SRC_ALPHA, OPERAND.ONE_MINUS_SRC_ALPHA) * 2
    given = unit(MODE.COMBINE4, rgb=half, alpha=replace(half, operands=alphas))
    pairs = [
        ([f, BYTES[i - 1], BYTES[i - 3], b], [t, BYTES[i - 2], t, a])
        for (i, f), t, a, b in product(enumerate(BYTES), BYTES, BYTES, (0, 1, 128, 255))
    ]
    assert_compiled((given,), pairs, ADD_SIGNED_BY_FOUR)


def test_every_source_and_operand():
    for source, operand in product(SOURCE, OPERAND):
        rgb = Combine(FUNCTION.REPLACE, (source,), (operand,))
        alpha = replace(rgb, operands=((OPERAND.SRC_ALPHA, OPERAND.ONE_MINUS_SRC_ALPHA)[operand % 2],))
        given = unit(MODE.COMBINE, color=(0.1, 0.2, 0.3, 0.4), rgb=rgb, alpha=alpha)
        units = (unit(MODE.REPLACE), given, None, unit(MODE.NONE))
        colors = [[1, 2, 3, 4], [10, 20, 30, 40], [50, 60, 70, 80], [0, 0, 0, 255], [90, 100, 110, 120]]
        assert_compiled(units, [colors])


def random_pass(chooser):
    """A profile, a state with one to four units and the formats of their textures."""
    machine = chooser.choice((GEFORCE_256, GEFORCE_3, MULTITEXTURE, G400, CROSSBAR, IDEAL))
    profile = machine.changed(
        product_rounding=chooser.choice(list(ProductRounding)),
        round_before_scale=chooser.random() < 0.5,
        expand_half=chooser.choice((128, 127.5)),
        clamp_low=chooser.choice((-256, -255)),
        add_signed_scale_by_four=chooser.random() < 0.5,
    )
    bases = [chooser.choice(list(FORMATS)) for _ in range(4)]
    textures = images(*(FORMATS[base] for base in bases))
    units = []
    for i in range(chooser.randint(1, profile.textures.max_texture_units)):
        environment = random_environment(chooser, profile, FORMATS[bases[i]])
        units.append(TextureUnit("abcd"[i], environment=environment) if chooser.random() < 0.85 else None)
    state = PassState(
        texture_units=tuple(units),
        color_sum=chooser.random() < 0.3,
        fog=Fog(color=random_color(chooser)) if chooser.random() < 0.3 else None,
    )
    return profile, state, textures, bases


def compare_random_passes(count, seed):
    """Random passes on machines with any arithmetic; returns the largest number of stages."""
    chooser, most = random.Random(seed), 0
    for _ in range(count):
        profile, state, textures, bases = random_pass(chooser)
        program = combiner_program(state, profile, textures)
        if program is not None:
            most = max(most, len(program.general))
        for _ in range(4):
            primary, secondary, *texels, far = (
                [round(255 * c) for c in random_color(chooser)] for _ in range(7)
            )
            factor = chooser.choice(BYTES) if state.fog else 255
            texels = [
                in_register(texel, base) if given else [0, 0, 0, 255]
                for given, texel, base in zip(state.texture_units, texels, bases, strict=False)
            ]
            expected = specified(state, primary, texels, profile, textures)
            if state.color_sum:
                expected = fog.add_secondary(expected, secondary)
            if state.fog:
                expected = fog.blend_with_fog(expected, far, factor)
            got = primary
            if program is not None:
                registers = combine.initial_registers(primary, secondary, texels, [*far[:3], factor])
                got = combine.combine(program, registers, with_every_clamp(profile))
            assert list(got) == list(expected), (primary, texels, state, profile.name)
    return most


def test_random_environments_equal_the_tables():
    assert 4 <= compare_random_passes(1500, seed=1) <= 12


@pytest.mark.slow
def test_thousands_of_random_environments_equal_the_tables():
    compare_random_passes(20_000, seed=2)


# ---------------------------------------------------------------------------------------------- rendered


def square(*arrays):
    """A square that covers the window, one texture coordinate unit across; its colors."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return Mesh(
        corners,
        primitive=PrimitiveType.QUADS,
        texture_coordinates=((corners + 1.0) / 2.0,),
        **dict(zip(("colors", "secondary_colors"), arrays, strict=False)),
    )


def frame(state, mesh=None, **textures):
    stored = tuple(TexImage(label=name, texture=name, image=image) for name, image in textures.items())
    return (*stored, Draw(label="pass", mesh=mesh or square(), state=state))


# Every pair of bytes once: four in each pair of texels, in red, green, blue and alpha.
EVERY_FIRST = np.arange(65536).reshape(128, 128, 4).astype(np.uint8)
EVERY_SECOND = (np.arange(65536).reshape(128, 128, 4) >> 8).astype(np.uint8)


def both(function, scale=1.0):
    """COMBINE with the same function in color and alpha, of TEXTURE and PREVIOUS."""
    return {
        "rgb": Combine(function, scale=scale),
        "alpha": Combine(function, operands=(OPERAND.SRC_ALPHA,) * 3, scale=scale),
    }


@pytest.mark.parametrize(
    "second",
    [
        unit(MODE.MODULATE, "b"),
        unit(MODE.COMBINE, "b", **both(FUNCTION.ADD)),
        unit(MODE.COMBINE, "b", **both(FUNCTION.ADD_SIGNED)),
        unit(MODE.COMBINE, "b", **both(FUNCTION.ADD_SIGNED, 4.0)),
        unit(MODE.COMBINE, "b", **both(FUNCTION.SUBTRACT, 2.0)),
    ],
    ids=["MODULATE", "ADD", "ADD_SIGNED", "ADD_SIGNED 4", "SUBTRACT 2"],
)
def test_every_pair_of_bytes_as_it_is_drawn(second):
    state = PassState(texture_units=(unit(MODE.REPLACE), second))
    commands = frame(state, a=texture_2d(EVERY_FIRST), b=texture_2d(EVERY_SECOND))
    machine = [
        execute(commands, ADD_SIGNED_BY_FOUR, 128, 128, engine=engine).framebuffer.color[::-1]
        for engine in (None, "portable")
    ]
    expected = [
        specified(state, [0] * 4, [first, second], ADD_SIGNED_BY_FOUR)
        for first, second in zip(
            EVERY_FIRST.reshape(-1, 4).tolist(), EVERY_SECOND.reshape(-1, 4).tolist(), strict=True
        )
    ]
    for got in machine:
        np.testing.assert_array_equal(got.reshape(-1, 4), expected)


def noise(seed, internal_format, edge=8):
    values = np.random.default_rng(seed).choice([*BYTES, 40, 90, 200], (edge, edge, 4))
    return texture_2d(values.astype(np.uint8), internal_format)


def rendered_frames(count, seed):
    """Random environments of every unit, drawn by both engines and the specification."""
    chooser = random.Random(seed)
    for number in range(count):
        profile = chooser.choice((GEFORCE_256, GEFORCE_3, MULTITEXTURE, G400))
        formats = [
            chooser.choice(sorted(FORMATS.values())) for _ in range(profile.textures.max_texture_units)
        ]
        units = tuple(
            TextureUnit("abcd"[i], NEAREST, environment=random_environment(chooser, profile, f))
            if chooser.random() < 0.9
            else None
            for i, f in enumerate(formats)
        )
        state = PassState(
            texture_units=units,
            color_sum=chooser.random() < 0.3,
            fog=Fog(color=random_color(chooser)) if chooser.random() < 0.3 else None,
        )
        values = np.random.default_rng(number)
        mesh = square(values.random((4, 4)), values.random((4, 3)))
        textures = {"abcd"[i]: noise(number + i, f) for i, f in enumerate(formats)}
        yield profile, frame(state, mesh, **textures)


def test_frames_with_environments_equal_the_specification():
    for profile, commands in rendered_frames(40, seed=5):
        expected = np.array(run_reference(commands, profile, 9, 7, 24).target.color)
        for engine in (None, "portable", "columns"):
            got = execute(commands, profile, 9, 7, engine=engine).framebuffer.color
            np.testing.assert_array_equal(got, expected, err_msg=describe(commands))


def test_environments_after_texture_shaders_equal_the_specification():
    """A stage that only addresses, one that it addresses, one of coordinates, one that culls."""
    operations = (
        TextureShaderOperation.TEXTURE_2D,
        TextureShaderOperation.DEPENDENT_AR_TEXTURE_2D,
        TextureShaderOperation.PASS_THROUGH,
        TextureShaderOperation.CULL_FRAGMENT,
    )
    environments = (MODE.NONE, MODE.DECAL, MODE.ADD, MODE.REPLACE)
    units = tuple(unit(mode, name) for mode, name in zip(environments, "abbb", strict=True))
    state = PassState(texture_units=units, texture_shader=tuple(TextureShaderStage(o) for o in operations))
    mesh = square(np.random.default_rng(3).random((4, 4)))
    mesh = replace(mesh, texture_coordinates=(np.c_[mesh.texture_coordinates[0], np.full(4, 0.3)],))
    commands = frame(state, mesh, a=noise(1, InternalFormat.RGBA8), b=noise(2, InternalFormat.RGB8))
    expected = np.array(run_reference(commands, NV2A, 9, 7, 24).target.color)
    assert len(np.unique(expected.reshape(-1, 4), axis=0)) > 20
    for engine in (None, "portable"):
        np.testing.assert_array_equal(
            execute(commands, NV2A, 9, 7, engine=engine).framebuffer.color, expected
        )


def test_without_its_clamp_a_unit_hands_on_what_exceeds_one():
    units = (unit(MODE.ADD), unit(MODE.MODULATE, "b"))
    textures = {"a": texture_2d(np.full((1, 1, 4), 204, np.uint8)), "b": texture_2d(np.full((1, 1, 4), 0.5))}
    commands = frame(PassState(texture_units=units), square(np.full((4, 4), 0.6)), **textures)
    red = [
        execute(commands, profile, 1, 1).image()[0, 0, 0]
        for profile in (GEFORCE_256, GEFORCE_256.without_clamps(Clamp.TEXTURE_ENVIRONMENT))
    ]
    assert red == [128, round((204 + 153) * 128 / 255)]


def test_a_wider_machine_rounds_less():
    half = texture_2d(np.full((1, 1, 4), 0.5))
    units = tuple(unit(MODE.MODULATE, name) for name in "abc")
    commands = frame(PassState(texture_units=units), square(np.full((4, 4), 0.5)), a=half, b=half, c=half)
    wide = GEFORCE_3.with_precision(combiner_bits=12, texture_bits=12, framebuffer_bits=12)
    narrow = execute(commands, GEFORCE_3, 1, 1).framebuffer.color[0, 0, 0] / 255
    exact = execute(commands, wide, 1, 1).framebuffer.color[0, 0, 0] / 4095
    assert abs(exact - 0.0625) < 1 / 4095 < abs(narrow - 0.0625)


def test_one_state_is_another_program_with_a_texture_of_another_base_format():
    """Rows that were packed for one texture are not used for another."""
    state = PassState(texture_units=(unit(MODE.REPLACE),))
    machine = Machine(GEFORCE_256, 4, 4)
    texels, alphas = np.full((1, 1, 4), 100, np.uint8), []
    for internal_format in (InternalFormat.RGBA8, InternalFormat.RGB8, InternalFormat.RGBA8):
        commands = frame(state, square(np.full((4, 4), 0.2)), a=texture_2d(texels, internal_format))
        alphas.append(machine.run(commands).image()[0, 0, 3])
    assert alphas == [100, 51, 100]


def test_rows_are_packed_once_for_equal_environments():
    state = PassState(texture_units=(unit(), unit(MODE.ADD, "b")))
    again = PassState(texture_units=(unit(), unit(MODE.ADD, "b")))
    assert combiner_program(state, GEFORCE_256, RGBA) is combiner_program(again, GEFORCE_256, RGBA)


# ------------------------------------------------------------------------------------------------- ideal


def ideal_color(units, primary, *texels, **fields):
    """The ideal's color where the textures' texels are reals, beside one pixel's fragment."""
    textures = {
        "abcd"[i]: texture_2d(np.array(texel, np.float64).reshape(1, 1, 4)) for i, texel in enumerate(texels)
    }
    state = PassState(texture_units=units, **fields)
    return execute_ideal(frame(state, square(np.array([primary] * 4)), **textures), 1, 1).color[0, 0]


def test_the_ideal_computes_the_tables_in_real_numbers():
    f, t, c = np.array([0.3, 0.7, 0.9, 0.6]), np.array([0.21, 0.5, 0.83, 0.4]), (0.1, 0.2, 0.3, 0.4)
    for given, expected in (
        (unit(), f * t),
        (unit(MODE.DECAL), [*(f[:3] * (1 - t[3]) + t[:3] * t[3]), f[3]]),
        (unit(MODE.BLEND, color=c), [*(f * (1 - t) + np.array(c) * t)[:3], f[3] * t[3]]),
        (unit(MODE.COMBINE, **both(FUNCTION.ADD_SIGNED)), np.minimum(f + t - 0.5, 1.0)),
        (unit(MODE.COMBINE, **both(FUNCTION.MODULATE, 2.0)), np.minimum(2 * f * t, 1.0)),
        (unit(MODE.COMBINE, **both(FUNCTION.INTERPOLATE), color=c), t * 0.4 + f * 0.6),
    ):
        np.testing.assert_allclose(ideal_color((given,), f, t), expected, atol=1e-12)
    normal = np.array([0.5, 0.5, 0.95, 0.0])
    dot = (2 * normal[:3] - 1) @ (2 * t[:3] - 1)
    got = ideal_color((combined(FUNCTION.DOT3_RGBA),), normal, t)
    np.testing.assert_allclose(got, [dot] * 4, atol=1e-12)


def test_the_ideal_keeps_what_exceeds_one_between_units_and_nothing_negative():
    f, t = [0.9, 0.2, 0.5, 1.0], [0.8, 0.1, 0.6, 1.0]
    half = [0.5, 0.5, 0.5, 1.0]
    np.testing.assert_allclose(
        ideal_color((unit(MODE.ADD), unit(MODE.MODULATE, "b")), f, t, half), [0.85, 0.15, 0.55, 1.0]
    )
    below = combined(FUNCTION.SUBTRACT, (SOURCE.PREVIOUS, SOURCE.TEXTURE))
    np.testing.assert_allclose(
        ideal_color((below, unit(MODE.ADD, "b")), f, t, half), [0.6, 0.6, 0.5, 1.0], atol=1e-12
    )


def test_machine_and_ideal_differ_by_rounding_alone():
    chooser, largest = random.Random(8), 0.0
    conventional = GEFORCE_256.changed(texture_environment_modes=frozenset(CONVENTIONAL[:4]))
    for number in range(12):
        environment = random_environment(chooser, conventional, InternalFormat.RGBA8)
        state = PassState(texture_units=(TextureUnit("a", NEAREST, environment=environment),))
        texels = np.random.default_rng(number).integers(0, 256, (8, 8, 4)).astype(np.uint8)
        commands = frame(state, square(np.full((4, 4), 0.4)), a=texture_2d(texels))
        ideal = execute_ideal(commands, 8, 8).color
        machine = execute(commands, GEFORCE_256, 8, 8).framebuffer.color / 255.0
        largest = max(largest, np.abs(ideal - machine).max())
    assert 0.0 < largest < 2.5 / 255.0


# --------------------------------------------------------------------------------------- words, refusals


def test_environments_print_as_equations():
    signed = Combine(
        FUNCTION.ADD_SIGNED, (SOURCE.TEXTURE, SOURCE.ZERO, SOURCE.PRIMARY_COLOR, SOURCE.CONSTANT)
    )
    operands = (
        OPERAND.SRC_COLOR,
        OPERAND.ONE_MINUS_SRC_COLOR,
        OPERAND.SRC_COLOR,
        OPERAND.ONE_MINUS_SRC_ALPHA,
    )
    four = unit(
        MODE.COMBINE4,
        color=(1.0, 0.5, 0.0, 0.0),
        rgb=replace(signed, operands=operands, scale=2.0),
        alpha=replace(signed, operands=(OPERAND.SRC_ALPHA, OPERAND.ONE_MINUS_SRC_ALPHA) * 2),
    )
    other = combined(
        FUNCTION.SUBTRACT, (SOURCE.PREVIOUS, SOURCE.TEXTURE1), alpha=both(FUNCTION.INTERPOLATE)["alpha"]
    )
    state = PassState(texture_units=(unit(MODE.DECAL), four, other, combined(FUNCTION.DOT3_RGBA, scale=4.0)))
    text = describe(frame(state))
    for line in (
        "TEXTURE_ENV_MODE DECAL",
        "constant = (1, 0.5, 0, 0)",
        "rgb = 2 * (texture + primary * (1 - constant.a) - 1/2)",
        "alpha = texture + primary * (1 - constant) - 1/2",
        "rgb = previous - texture1",
        "alpha = texture * constant + previous * (1 - constant)",
        "rgb = 4 * (4 * (texture - 1/2) . (previous - 1/2))",
        "alpha = 4 * (texture - 1/2) . (previous - 1/2)",
    ):
        assert any(found.strip() == line for found in text.splitlines()), f"{line}\n{text}"


FOUR = (SOURCE.TEXTURE,) * 4
FOUR_OPERANDS = (OPERAND.SRC_COLOR,) * 4
COMBINE4 = {
    "rgb": Combine(FUNCTION.ADD, FOUR, FOUR_OPERANDS),
    "alpha": Combine(FUNCTION.ADD, FOUR, (OPERAND.SRC_ALPHA,) * 4),
}
NO_ENVIRONMENTS = GEFORCE_256.changed(texture_environment_modes=frozenset())
REFUSED = {
    "no environments at all": (
        NO_ENVIRONMENTS,
        unit(),
        ["no texture environments", "Set register_combiners"],
    ),
    "a mode": (
        MULTITEXTURE,
        unit(MODE.COMBINE4, **COMBINE4),
        [f"is COMBINE4; {MULTITEXTURE.name} has MODULATE"],
    ),
    "DECAL of luminance": (GEFORCE_256, unit(MODE.DECAL, "grey"), ["DECAL", "undefined for LUMINANCE"]),
    "a function": (
        MULTITEXTURE,
        combined(FUNCTION.SUBTRACT),
        [f"has SUBTRACT in rgb; a COMBINE environment of {MULTITEXTURE.name} takes REPLACE, MODULATE"],
    ),
    "a dot product in alpha": (
        GEFORCE_256,
        combined(FUNCTION.ADD, alpha=both(FUNCTION.DOT3_RGB)["alpha"]),
        ["DOT3_RGB in alpha", "DOT3_RGBA for all four"],
    ),
    "a product of two with COMBINE4": (
        GEFORCE_256,
        unit(MODE.COMBINE4, **(COMBINE4 | {"rgb": Combine(FUNCTION.MODULATE, FOUR, FOUR_OPERANDS)})),
        ["has MODULATE in rgb; a COMBINE4 environment of GeForce 256 takes ADD, ADD_SIGNED"],
    ),
    "a scale": (GEFORCE_256, combined(FUNCTION.ADD, scale=3.0), ["scales rgb by 3; a scale is 1, 2 or 4"]),
    "too few sources": (
        GEFORCE_256,
        combined(FUNCTION.INTERPOLATE, (SOURCE.TEXTURE, SOURCE.PREVIOUS)),
        ["has 2 sources in rgb; INTERPOLATE takes 3"],
    ),
    "too few operands": (
        GEFORCE_256,
        unit(MODE.COMBINE4, **(COMBINE4 | {"alpha": Combine(FUNCTION.ADD, FOUR, (OPERAND.SRC_ALPHA,) * 3)})),
        ["has 3 operands in alpha; ADD takes 4"],
    ),
    "ZERO without COMBINE4": (
        MULTITEXTURE,
        combined(FUNCTION.ADD, (SOURCE.ZERO, SOURCE.TEXTURE)),
        ["reads ZERO in rgb", "Use CONSTANT"],
    ),
    "another unit's texture": (
        MULTITEXTURE,
        combined(FUNCTION.ADD, (SOURCE.TEXTURE1, SOURCE.TEXTURE)),
        ["reads TEXTURE1 in rgb", "its own texture alone"],
    ),
    "a unit that is not there": (
        GEFORCE_256,
        combined(FUNCTION.ADD, (SOURCE.TEXTURE, SOURCE.TEXTURE2)),
        ["reads TEXTURE2 in rgb", "GeForce 256 has 2 texture units"],
    ),
    "color in alpha": (
        GEFORCE_256,
        combined(FUNCTION.ADD, alpha=Combine(FUNCTION.REPLACE)),
        ["has an operand of color in alpha"],
    ),
    "a third operand": (
        MULTITEXTURE,
        combined(FUNCTION.INTERPOLATE, operands=(OPERAND.SRC_COLOR,) * 3),
        [f"SRC_COLOR as the third operand in rgb; {MULTITEXTURE.name} takes SRC_ALPHA there"],
    ),
}


@pytest.mark.parametrize(("profile", "given", "words"), REFUSED.values(), ids=REFUSED)
def test_what_a_machine_lacks_is_refused(profile, given, words):
    grey = texture_2d(np.zeros((1, 1, 4), np.uint8), InternalFormat.LUMINANCE8)
    textures = {"a": texture_2d(np.zeros((1, 1, 4), np.uint8)), "grey": grey}
    with pytest.raises(UnsupportedState) as refusal:
        validate(frame(PassState(texture_units=(given,)), **textures), profile, 4, 4)
    for word in ("texture unit 0", *words):
        assert word in str(refusal.value)
    allowed = PassState(texture_units=(replace(given, environment=TextureEnvironment()),))
    if profile is not NO_ENVIRONMENTS:
        validate(frame(allowed, **textures), profile, 4, 4)


def test_what_has_no_effect_is_not_refused():
    """DECAL of a luminance texture is undefined, but not where combiners or a shader stage hide it."""
    grey = texture_2d(np.zeros((1, 1, 4), np.uint8), InternalFormat.LUMINANCE8)
    units = (unit(MODE.DECAL, "grey"),)
    for stage in (TextureShaderOperation.PASS_THROUGH, TextureShaderOperation.NONE):
        state = PassState(texture_units=units, texture_shader=(TextureShaderStage(stage),))
        mesh = replace(square(), texture_coordinates=(np.zeros((4, 3)),))
        validate(frame(state, mesh, grey=grey), NV2A, 4, 4)


# ------------------------------------------------------------------------------------- environments in words


def written(half, alpha):
    """The words of a Combine's function and arguments."""
    inverted = (OPERAND.ONE_MINUS_SRC_COLOR, OPERAND.ONE_MINUS_SRC_ALPHA)
    of_alpha = () if alpha else (OPERAND.SRC_ALPHA, OPERAND.ONE_MINUS_SRC_ALPHA)
    return (
        half.function.name,
        *(
            f"{'1 - ' * (operand in inverted)}{source.name}{'.a' * (operand in of_alpha)}"
            for source, operand in zip(half.sources, half.operands, strict=True)
        ),
    )


def test_words_make_the_environments_that_they_name():
    for function, operands in product(FUNCTION, product(OPERAND, repeat=2)):
        rgb = Combine(function, (SOURCE.TEXTURE1, SOURCE.ZERO), operands, 2.0)
        alpha = Combine(
            FUNCTION.ADD, (SOURCE.PREVIOUS, SOURCE.CONSTANT), (OPERAND.ONE_MINUS_SRC_ALPHA,) * 2, 4.0
        )
        wanted = TextureEnvironment(MODE.COMBINE, (0.0, 0.25, 0.5, 1.0), rgb, alpha)
        made = environment(
            written(rgb, False), written(alpha, True), color=wanted.color, rgb_scale=2.0, alpha_scale=4.0
        )
        assert made == wanted


def test_one_is_one_minus_zero_and_four_arguments_are_combine4():
    made = environment(
        ("ADD", "TEXTURE", "1", "PREVIOUS.a", "1 - 1"), ("ADD", "TEXTURE", "1", "PREVIOUS", "ZERO")
    )
    assert made.mode == MODE.COMBINE4
    assert (
        made.rgb.sources == made.alpha.sources == (SOURCE.TEXTURE, SOURCE.ZERO, SOURCE.PREVIOUS, SOURCE.ZERO)
    )
    color, alpha = OPERAND.SRC_COLOR, OPERAND.SRC_ALPHA
    assert made.rgb.operands == (color, OPERAND.ONE_MINUS_SRC_COLOR, alpha, color)
    assert made.alpha.operands == (alpha, OPERAND.ONE_MINUS_SRC_ALPHA, alpha, alpha)


def test_an_alpha_half_that_is_not_given_is_opengls_initial_one():
    initial = TextureEnvironment().alpha
    given = environment(("REPLACE", "TEXTURE")).alpha
    assert (given.function, given.sources) == (initial.function, initial.sources[:2])
    assert given.operands == initial.operands[:2]


@pytest.mark.parametrize(
    ("halves", "words"),
    [
        ([("MULTIPLY", "TEXTURE", "PREVIOUS")], "no function 'MULTIPLY'; it has REPLACE, MODULATE"),
        ([("MODULATE", "TEX", "PREVIOUS")], "MODULATE has an argument 'TEX', which names no source"),
        ([("ADD", "TEXTURE", "1", "PREVIOUS", "1")], "one half of the environment has four arguments"),
        ([()], r"the environment's rgb half is \(\); give the names of its function"),
        (["MODULATE"], "the environment's rgb half is 'MODULATE'; give the names"),
        ([("MODULATE", "TEXTURE", None)], "rgb half is .*None.*; give the names"),
        ([("REPLACE", "TEXTURE"), None], "the environment's alpha half is None; give the names"),
        ([("REPLACE", "TEXTURE"), (1, "TEXTURE")], "alpha half is .*; give the names"),
    ],
)
def test_words_that_are_not_opengls_are_refused(halves, words):
    with pytest.raises(ValueError, match=words):
        environment(*halves)
