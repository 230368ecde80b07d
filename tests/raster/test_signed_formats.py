"""Direct3D's signed words: every engine equals the specification, and formats that are no colours."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComponentUsage,
    DotProductMapping,
    Register,
    TexelWord,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import G400, GEFORCE_3, GEFORCE_256, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import (
    CombinerInput,
    FinalCombiner,
    PassState,
    RegisterCombiners,
    Sampler,
    SignedComponents,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.textures.words import texture_of_words
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.support.run_reference import run_reference

SIZE = 16
FILTERS = [TextureFilter.NEAREST, TextureFilter.LINEAR]
SIGNED_WORDS = [
    TexelWord.V8U8,
    TexelWord.L6V5U5,
    TexelWord.X8L8V8U8,
    TexelWord.Q8W8V8U8,
    TexelWord.V16U16,
]
COLORLESS_WORDS = [TexelWord.V8U8, TexelWord.L6V5U5, TexelWord.X8L8V8U8, TexelWord.V16U16, TexelWord.R16B16]
PASSES_ON = TextureEnvironment(TextureEnvironmentMode.NONE)
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
OFFSET = TextureShaderOperation.OFFSET_TEXTURE_2D
SCALE = TextureShaderOperation.OFFSET_TEXTURE_2D_SCALE


def shows(register):
    """Combiners that show a register, its alpha too."""
    zero, color = CombinerInput(), CombinerInput(register)
    alpha = CombinerInput(register, usage=ComponentUsage.ALPHA)
    return RegisterCombiners(final=FinalCombiner(a=zero, b=zero, c=zero, d=color, g=alpha))


def load(name, image):
    return TexImage(label=name, texture=name, image=image)


def words_of(kind, seed=0):
    return texture_of_words(np.random.default_rng(seed).integers(0, 1 << 32, (8, 8)), kind)


def whole(state, *sets):
    mesh = Mesh([[-1, -1], [3, -1], [-1, 3]], texture_coordinates=sets)
    return Draw(label="everywhere", mesh=mesh, state=state)


def sampled(filtered, **fields):
    return replace(Sampler(filtered, filtered), **fields)


def bumped(kind, filtered, operation, seed=0):
    """A ramp whose coordinates a texture of words moves: combiners are disabled."""
    random = np.random.default_rng(seed)
    stages = (
        TextureShaderStage(TextureShaderOperation.TEXTURE_2D),
        TextureShaderStage(
            operation,
            offset_texture_matrix=tuple(random.uniform(-1, 1, 4).tolist()),
            offset_texture_scale=0.7,
            offset_texture_bias=0.2,
        ),
    )
    units = (
        TextureUnit("words", sampled(filtered), environment=PASSES_ON),
        TextureUnit("ramp", sampled(filtered), coordinates=1, environment=REPLACE),
    )
    state = PassState(texture_units=units, texture_shader=stages)
    corners = [[0, 0], [2, 0], [0, 2]]
    ramp = texture_2d(random.integers(0, 256, (8, 8, 4), np.uint8))
    return load("words", words_of(kind, seed)), load("ramp", ramp), whole(state, corners, corners)


def shown(kind, filtered=TextureFilter.NEAREST, shader=False, image=None):
    """A texture of words as a combiner's register has it."""
    stages = (TextureShaderStage(TextureShaderOperation.TEXTURE_2D),) if shader else None
    state = PassState(
        texture_units=(TextureUnit("words", sampled(filtered)),),
        texture_shader=stages,
        register_combiners=shows(Register.TEXTURE0),
    )
    words = words_of(kind) if image is None else image
    return load("words", words), whole(state, [[0, 0], [2, 0], [0, 2]])


def assert_engines_agree(commands, profile):
    commands = (Clear(label="clear", color=(0.2, 0.4, 0.6, 0.8)), *commands)
    expected = np.array(run_reference(commands, profile, SIZE, SIZE, 24).target.color)
    for engine in (None, "portable", "columns"):
        got = execute(commands, profile, SIZE, SIZE, depth_bits=24, threads=1, engine=engine)
        np.testing.assert_array_equal(got.framebuffer.color, expected, err_msg=str(engine))
    return expected


@pytest.mark.parametrize("filtered", FILTERS)
@pytest.mark.parametrize("operation", [OFFSET, SCALE])
@pytest.mark.parametrize("kind", SIGNED_WORDS, ids=lambda kind: kind.name)
@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3, G400], ids=lambda p: p.name)
def test_offsets_of_signed_words_equal_the_specification(profile, kind, operation, filtered):
    if words_of(kind).internal_format not in profile.textures.internal_formats:
        pytest.skip(f"{profile.name} does not store {kind.name}")
    for seed in range(3):
        assert_engines_agree(bumped(kind, filtered, operation, seed), profile)


@pytest.mark.parametrize("filtered", FILTERS)
@pytest.mark.parametrize("shader", [False, True])
@pytest.mark.parametrize("kind", [*SIGNED_WORDS, TexelWord.R16B16], ids=lambda kind: kind.name)
@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3], ids=lambda p: p.name)
def test_registers_of_signed_words_equal_the_specification(profile, kind, shader, filtered):
    color = assert_engines_agree(shown(kind, filtered, shader), profile)
    assert color[..., :3].any() == (profile is NV2A or kind is TexelWord.Q8W8V8U8)


@pytest.mark.parametrize("kind", [TexelWord.V16U16, TexelWord.R16B16], ids=lambda kind: kind.name)
def test_later_stages_read_what_registers_do_not_show(kind):
    """A dot product of (1, 0, 0) with HILO's hemisphere is U: the register is black all the same."""
    dot = {"dot_product_mapping": DotProductMapping.SIGNED_HILO_HEMISPHERE}
    stages = (
        TextureShaderStage(TextureShaderOperation.TEXTURE_2D),
        TextureShaderStage(TextureShaderOperation.DOT_PRODUCT, **dot),
        TextureShaderStage(TextureShaderOperation.DOT_PRODUCT_TEXTURE_2D, **dot),
    )
    edge = sampled(TextureFilter.NEAREST)
    state = PassState(
        texture_units=(
            TextureUnit("words", edge),
            TextureUnit(None, coordinates=1),
            TextureUnit("ramp", edge, coordinates=2),
        ),
        texture_shader=stages,
    )
    at = [[0.5, 0.5]] * 3, [[1.0, 0.0, 0.0]] * 3, [[0.0, 1.0, 0.0]] * 3
    word = {TexelWord.V16U16: 0x60004000, TexelWord.R16B16: 0x40006000}[kind]
    ramp = np.zeros((8, 8, 4), np.uint8)
    ramp[..., 0], ramp[..., 1], ramp[..., 3] = np.arange(8) * 30, np.arange(8)[:, None] * 30, 255
    for register, expected in ((Register.TEXTURE0, [0, 0, 0]), (Register.TEXTURE2, [120, 180, 0])):
        commands = (
            load("words", texture_of_words(np.array([[word]]), kind)),
            load("ramp", texture_2d(ramp)),
            whole(replace(state, register_combiners=shows(register)), *at),
        )
        assert assert_engines_agree(commands, GEFORCE_3)[3, 3, :3].tolist() == expected


@pytest.mark.parametrize("kind", COLORLESS_WORDS, ids=lambda kind: kind.name)
@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3, G400], ids=lambda p: p.name)
def test_environments_of_formats_that_are_no_colours_pass_the_colour_on(profile, kind):
    if words_of(kind).internal_format not in profile.textures.internal_formats:
        pytest.skip(f"{profile.name} does not store {kind.name}")
    unit = TextureUnit("words", sampled(TextureFilter.NEAREST), environment=REPLACE)
    draw = whole(PassState(texture_units=(unit,)), [[0, 0], [2, 0], [0, 2]])
    color = assert_engines_agree((load("words", words_of(kind)), draw), profile)
    assert (color == 255).all()


@pytest.mark.parametrize("kind", SIGNED_WORDS, ids=lambda kind: kind.name)
def test_the_ideal_reads_signs_and_no_colours(kind):
    """Halfway between -64 and 64, or -16384 and 16384, lies 0: bytes without signs would give half of one."""
    low, high = {
        TexelWord.V8U8: (0xC0C0, 0x4040),
        TexelWord.L6V5U5: (0xFE10, 0xFDEF),  # widened, -124 and 123
        TexelWord.X8L8V8U8: (0xFFC0C0, 0xFF4040),
        TexelWord.Q8W8V8U8: (0xC0C0C0C0, 0x40404040),
        TexelWord.V16U16: (0xC000C000, 0x40004000),
    }[kind]
    pair = texture_of_words(np.array([[low, high]]), kind)
    ramp = np.zeros((1, 256, 3))
    ramp[..., 0] = np.arange(256) / 255.0
    offset = kind is not TexelWord.V16U16
    dot = {"dot_product_mapping": DotProductMapping.SIGNED_HILO_HEMISPHERE}
    last = (
        (TextureShaderStage(OFFSET, offset_texture_matrix=(1.0, 0.0, 0.0, 0.0)),)
        if offset
        else (
            TextureShaderStage(TextureShaderOperation.DOT_PRODUCT, **dot),
            TextureShaderStage(TextureShaderOperation.DOT_PRODUCT_TEXTURE_2D, **dot),
        )
    )
    linear = sampled(TextureFilter.LINEAR)
    state = PassState(
        texture_units=(
            TextureUnit("words", linear),
            *(() if offset else (TextureUnit(None, coordinates=1),)),
            TextureUnit("ramp", linear, coordinates=len(last)),
        ),
        texture_shader=(TextureShaderStage(TextureShaderOperation.TEXTURE_2D), *last),
        register_combiners=shows(Register(Register.TEXTURE0 + len(last))),
    )
    middle, half = [[0.5, 0.5]] * 3, [[0.0, 0.0, 0.5]] * 3
    sets = (middle, middle) if offset else (middle, [[1.0, 0.0, 0.5]] * 3, half)
    commands = (load("words", pair), load("ramp", texture_2d(ramp)), whole(state, *sets))
    wanted = execute_ideal(commands, 2, 2).color[0, 0, 0]
    # Half the ramp is 127.5 of 255; five bits' middle lies half a 128th lower, a slope of 256/255 there.
    place = 0.5 + (-0.5 / 128 if kind is TexelWord.L6V5U5 else 0.0)
    if not offset:
        place = 0.5  # z is the root of 1 at U = V = 0, and r a half
    assert abs(wanted - (256 * place - 0.5) / 255) < 1e-9

    seen = execute_ideal((load("words", pair), shown(kind, image=pair)[1]), 2, 2).color[..., :3]
    assert seen.any() == (kind is TexelWord.Q8W8V8U8)


@pytest.mark.parametrize("kind", SIGNED_WORDS, ids=lambda kind: kind.name)
def test_a_scaled_lookup_of_signed_words_is_refused(kind):
    commands = list(bumped(TexelWord.V8U8, TextureFilter.NEAREST, SCALE))
    commands[1] = load("ramp", words_of(kind))
    with pytest.raises(UnsupportedState, match=r"scales unsigned colours alone.*a texture of colours"):
        validate(commands, GEFORCE_3, SIZE, SIZE)


@pytest.mark.parametrize(
    ("profile", "kind"),
    [
        *((OPENGL_1_2, kind) for kind in SIGNED_WORDS),
        *((GEFORCE_256, kind) for kind in SIGNED_WORDS),
        (G400, TexelWord.Q8W8V8U8),
        (G400, TexelWord.V16U16),
    ],
    ids=lambda value: value.name,
)
def test_machines_without_a_format_say_which_it_is(profile, kind):
    words = words_of(kind)
    with pytest.raises(UnsupportedState, match=f"does not store {words.internal_format.name}"):
        validate((load("words", words),), profile, SIZE, SIZE)


def test_a_sampler_s_own_signs_are_added_to_the_format_s():
    """X8L8V8U8's magnitude has no sign, until the sampler gives it one: 200 is -56 then, and black."""
    words = texture_of_words(np.array([[0xC84020]]), TexelWord.X8L8V8U8)
    load_it, draw = shown(TexelWord.X8L8V8U8, image=words)
    assert assert_engines_agree((load_it, draw), NV2A)[3, 3, :3].tolist() == [200, 128, 64]
    unit = draw.state.texture_units[0]
    red = replace(unit, sampler=replace(unit.sampler, signed_components=SignedComponents(red=True)))
    draw = replace(draw, state=replace(draw.state, texture_units=(red,)))
    assert assert_engines_agree((load_it, draw), NV2A)[3, 3, :3].tolist() == [0, 128, 64]
