"""Texture shaders in the column engine: every stage at 8 bits the specification's, the arithmetic at other
widths likewise, whole passes at twelve bits, and what is refused.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    CullMode,
    DotProductMapping,
    Register,
    TexelWord,
    TextureEnvironmentMode,
    TextureFilter,
    VertexStage,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_3, NV2A
from fixedpipe.pipeline.state import (
    DepthTest,
    PassState,
    Sampler,
    SignedComponents,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.textures.words import texture_of_words
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.raster.columns import texture_shader
from tests.raster.test_texture_shader import CHAINS, HEIGHT, WIDTH, frame, shows
from tests.reference import texture_shader as specified
from tests.support.run_reference import run_reference

BITS = (4, 5, 8, 11, 12, 16)
NEAREST = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
TWO, DOT = Operation.TEXTURE_2D, Operation.DOT_PRODUCT
WORDS = {DotProductMapping.UNSIGNED_HILO, DotProductMapping.SIGNED_HILO_HEMISPHERE}


@pytest.mark.parametrize("name", CHAINS)
@pytest.mark.parametrize("filtered", [TextureFilter.NEAREST, TextureFilter.LINEAR])
def test_every_operation_equals_the_portable_engine(name, filtered):
    """And so the specification, by the test of the same frames in tests/raster/test_texture_shader.py."""
    for seed in range(3):
        commands = frame(*CHAINS[name], np.random.default_rng(seed), filtered)
        drawn = [
            execute(commands, NV2A, WIDTH, HEIGHT, depth_bits=24, engine=engine, record=True)
            for engine in ("portable", "columns")
        ]
        for buffer in ("color", "depth", "stencil"):
            native, columns = (getattr(d.framebuffer, buffer) for d in drawn)
            assert np.array_equal(native, columns), (seed, buffer)
        native, columns = ([int(f.passed.sum()) for f in d.records] for d in drawn)
        assert native == columns


@pytest.mark.parametrize("bits", BITS)
def test_the_arithmetic_is_the_specification_s_at_every_width(bits):
    random, one = np.random.default_rng(bits), 2**bits - 1
    values = np.concatenate([random.uniform(-0.2, 1.2, 60), np.arange(20) / one, [np.nan, 0.0, 1.0, np.inf]])
    expected = [specified.real_texel(v, one) for v in values.tolist()]
    assert texture_shader.real_texel(values, bits).tolist() == expected
    texels = np.concatenate([random.integers(0, one + 1, (60, 4)), [[0] * 4, [one] * 4, [one // 2] * 4]])
    for mapping in DotProductMapping:
        if mapping in WORDS and bits != 8:
            continue
        found = np.stack(np.broadcast_arrays(*texture_shader.vector(texels, mapping, bits)), axis=1)
        assert found.tolist() == [list(specified.mapped(t, mapping, one)) for t in texels.tolist()], mapping
    st, matrix = random.uniform(-2, 2, (len(texels), 4)), random.uniform(-1, 1, 4).tolist()
    found = np.stack(texture_shader.offset(st, texels, matrix, bits), axis=1)
    assert found.tolist() == [
        list(specified.offset(c, t, matrix, one)) for c, t in zip(st.tolist(), texels.tolist(), strict=True)
    ]
    stage = TextureShaderStage(offset_texture_scale=1.5, offset_texture_bias=-0.25)
    for other in (8, 12):
        magnitude = random.integers(0, 1 << other, len(texels))
        for largest in (1.0, np.inf):
            found = texture_shader.scaled(texels, bits, magnitude, other, 1.5, -0.25, largest)
            assert found.tolist() == [
                specified.scaled(t, m, stage, one, 2**other - 1, largest)
                for t, m in zip(texels.tolist(), magnitude.tolist(), strict=True)
            ]


# ------------------------------------------------------------------------------------------ other widths


def one_pixel(stages, textures, profile, coordinates, shown, **state):
    """The colour of a pixel, in ones, whose units' coordinates are constant."""
    commands = [
        TexImage(label=name, texture=name, image=image)
        for name, image in textures.items()
        if image is not None
    ]
    units = tuple(
        TextureUnit(None if textures[n] is None else n, NEAREST, coordinates=i)
        for i, n in enumerate(textures)
    )
    corners = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
    sets = tuple(np.tile(np.array(c, np.float64), (3, 1)) for c in coordinates)
    state = PassState(texture_units=units, texture_shader=stages, register_combiners=shows(shown), **state)
    draw = Draw(label="draw", mesh=Mesh(corners, texture_coordinates=sets), state=state)
    result = execute([*commands, draw], profile, 2, 2, record=True)
    return result, result.framebuffer.color[0, 0] / (2**result.framebuffer.color_bits - 1)


def twelve(profile=GEFORCE_3):
    return profile.with_precision(combiner_bits=12, texture_bits=12, framebuffer_bits=12)


def test_a_dependent_read_takes_a_texel_of_twelve_bits_by_its_value_over_one():
    """Green 0.3 is 1228 of 4095, texel 307 of 1024; as a byte it would be 77 of 255, texel 309."""
    address = texture_2d(np.full((1, 1, 4), 0.3))
    ramp = np.zeros((1, 1024, 4))
    ramp[0, :, 0] = np.arange(1024) / 4095.0
    stages = (TextureShaderStage(TWO), TextureShaderStage(Operation.DEPENDENT_GB_TEXTURE_2D))
    textures = {"address": address, "ramp": texture_2d(ramp)}
    for profile, texel, one in ((twelve(), 307, 4095), (GEFORCE_3, 309, 255)):
        _, color = one_pixel(stages, textures, profile, [(0.5, 0.5)] * 2, Register.TEXTURE1)
        assert color[0] == np.floor(texel / 4095 * one + 0.5) / one


def test_a_dot_product_expands_normals_of_twelve_bits():
    """The reflected q's and cube maps are the same code at every width: a plane is enough."""
    normal = texture_2d(np.full((1, 1, 4), 0.75))
    ramp = np.tile(np.arange(256)[:, None] / 255.0, (1, 256))[..., None] * np.ones(4)
    previous = {"dot_product_mapping": DotProductMapping.EXPAND_NORMAL}
    stages = (
        TextureShaderStage(TWO),
        TextureShaderStage(DOT, **previous),
        TextureShaderStage(Operation.DOT_PRODUCT_TEXTURE_2D, **previous),
    )
    textures = {"normal": normal, "nothing": None, "ramp": texture_2d(ramp)}
    sets = [(0.5, 0.5), (0.0, 0.0, 0.0), (0.3, 0.4, 0.3)]
    _, color = one_pixel(stages, textures, twelve(), sets, Register.TEXTURE2)
    row = int((3071 - 2048) / 2047 * 256)  # 0.75 is 3071 of 4095
    assert color[0] == np.floor(row / 255 * 4095 + 0.5) / 4095


def test_pass_through_has_the_texels_width():
    stages = (TextureShaderStage(Operation.PASS_THROUGH),)
    for profile, bits in (
        (twelve(), 12),
        (GEFORCE_3.with_precision(combiner_bits=12, framebuffer_bits=12), 8),
    ):
        _, color = one_pixel(stages, {"": None}, profile, [(0.3, 1.5, -1.0, 0.7)], Register.TEXTURE0)
        one = 2**bits - 1
        expected = [specified.real_texel(v, one) / one for v in (0.3, 1.5, -1.0, 0.7)]
        assert np.array_equal(color[:3], [np.floor(v * 4095 + 0.5) / 4095 for v in expected[:3]])


@pytest.mark.parametrize("mode", CullMode)
def test_fragments_that_a_stage_discards_write_nothing(mode):
    stages = (TextureShaderStage(Operation.CULL_FRAGMENT, cull_modes=(mode,) * 4),)
    test = {"depth_test": DepthTest(ComparisonFunction.ALWAYS)}
    sets = [(1.0, 1.0, 1.0, 1.0)]
    result, _ = one_pixel(stages, {"": None}, twelve(), sets, Register.TEXTURE0, **test)
    farthest = result.framebuffer.depth.max() if mode is CullMode.LESS else 2**24
    (record,) = result.records
    assert record.passed.all() == (mode is CullMode.GEQUAL) and record.passed.any() == record.passed.all()
    assert (result.framebuffer.depth == farthest).all() == (mode is CullMode.LESS)


def test_a_replaced_depth_is_the_quotient_at_every_width():
    stages = tuple(
        TextureShaderStage(o) for o in (Operation.PASS_THROUGH, DOT, Operation.DOT_PRODUCT_DEPTH_REPLACE)
    )
    sets = [(1.0, 1.0, 1.0, 1.0), (1.0, 0.0, 0.0), (4.0, 0.0, 0.0)]
    test = {"depth_test": DepthTest(ComparisonFunction.ALWAYS)}
    textures = dict.fromkeys("abc")
    for profile in (GEFORCE_3, twelve(), FUTURE):
        depth = one_pixel(stages, textures, profile, sets, Register.TEXTURE0, **test)[0].framebuffer.depth
        assert (depth == (2**24 - 1) // 4).all()
    for divisor in (0.75, 0.0, -4.0):  # beyond the buffer, no number, below it: discarded
        beyond = [*sets[:2], (divisor, 0.0, 0.0)]
        for profile in (GEFORCE_3, twelve()):
            result, _ = one_pixel(stages, textures, profile, beyond, Register.TEXTURE0, **test)
            assert not result.records[0].passed.any()
            assert (result.framebuffer.depth == 2**24 - 1).all()


def test_the_future_board_has_the_geforce_3_s_stages():
    assert (
        FUTURE.texture_shaders.texture_shader_operations
        == GEFORCE_3.texture_shaders.texture_shader_operations
    )
    for name in ("offset", "reflect", "diffuse"):
        commands = frame(*CHAINS[name], np.random.default_rng(1))
        target = execute(commands, FUTURE, WIDTH, HEIGHT, depth_bits=24).framebuffer
        native = execute(commands, GEFORCE_3, WIDTH, HEIGHT, depth_bits=24).framebuffer
        assert np.array_equal(target.color, native.color) and native.color.any()


# ----------------------------------------------------------------------------------------------- refusals


def test_words_of_sixteen_bits_are_those_of_bytes():
    for mapping in WORDS:
        stages = (
            TextureShaderStage(TWO),
            TextureShaderStage(DOT, dot_product_mapping=mapping),
            TextureShaderStage(Operation.DOT_PRODUCT_TEXTURE_2D),
        )
        plane = texture_2d(np.full((1, 1, 4), 0.5))
        sets = [(0.5, 0.5), (0.5, 0.5, 0.5), (0.0, 0.5, 0.0)]
        hilo = texture_of_words(np.array([[0x40008000]]), TexelWord.R16B16)
        textures = {"words": hilo, "nothing": None, "plane": plane}
        one_pixel(stages, textures, twelve(), sets, Register.TEXTURE2)
        with pytest.raises(UnsupportedState, match=r"whose components have 12 bits.*HILO16"):
            one_pixel(stages, {**textures, "words": plane}, twelve(), sets, Register.TEXTURE2)


def test_combiners_before_the_filter_refuse_stages():
    stages = (TextureShaderStage(TWO),)
    textures = {"a": texture_2d(np.full((1, 1, 4), 0.5))}
    with pytest.raises(UnsupportedState, match="leave texture_shader None"):
        one_pixel(stages, textures, FUTURE, [(0.5, 0.5)], Register.TEXTURE0, evaluate_before_filtering=True)


def test_accesses_that_no_specification_knows_are_refused():
    reflect, diffuse = Operation.DOT_PRODUCT_REFLECT_CUBE_MAP, Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP

    def of_last_unit(sampler, operations, targets, words):
        commands = list(frame(operations, targets, np.random.default_rng(0)))
        units = commands[-1].state.texture_units
        units = (*units[:-1], replace(units[-1], sampler=replace(units[-1].sampler, **sampler)))
        commands[-1] = replace(commands[-1], state=replace(commands[-1].state, texture_units=units))
        with pytest.raises(UnsupportedState, match=words):
            execute(commands[:3] + commands[-1:], NV2A, WIDTH, HEIGHT)

    pair = (TWO, Operation.OFFSET_TEXTURE_2D), "22"
    of_last_unit({"max_anisotropy": 2.0}, *pair, "set max_anisotropy to 1")
    unequal = {"min_filter": TextureFilter.LINEAR}
    of_last_unit(unequal, *pair, "no level of detail")
    of_last_unit(unequal, (Operation.TEXTURE_CUBE_MAP,), "2", "no level of detail")
    signs = {"signed_components": SignedComponents(True)}
    of_last_unit(signs, (TWO, Operation.OFFSET_TEXTURE_2D_SCALE), "22", "unsigned components alone")
    commands = frame((TWO, DOT, diffuse, reflect), "2 cc", np.random.default_rng(0))
    stages = commands[-1].state.texture_shader
    stages = (*stages[:3], replace(stages[3], previous_texture_input=2))
    changed = replace(commands[-1], state=replace(commands[-1].state, texture_shader=stages))
    with pytest.raises(UnsupportedState, match="give stage 3 an earlier previous_texture_input"):
        execute((*commands[:3], changed), NV2A, WIDTH, HEIGHT)


def test_offset_coordinates_are_not_lifted_where_q_is_not_one():
    """T is 2**-24 below a texel's edge: the bias of computed coordinates would take it over."""
    random = np.random.default_rng(0)
    image = texture_2d(random.integers(0, 256, (4, 4, 4), np.uint8))
    stages = (TextureShaderStage(TWO), TextureShaderStage(Operation.OFFSET_TEXTURE_2D))
    flat = texture_2d(np.zeros((1, 1, 4), np.uint8))
    mesh = Mesh(
        np.array([[0.0, 0.0, 0.0, 1.0], [32.0, 0.0, 0.0, 1.0], [0.0, 32.0, 0.0, 1.0]]),
        texture_coordinates=(np.tile([0.25 - 2.0**-26, 0.5, 0.0, 2.0], (3, 1)),),
    )
    state = PassState(
        vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS),
        texture_units=(TextureUnit("flat", NEAREST), TextureUnit("image", NEAREST)),
        texture_shader=stages,
        register_combiners=shows(Register.TEXTURE1),
    )
    commands = (
        Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0)),
        TexImage(label="flat", texture="flat", image=flat),
        TexImage(label="image", texture="image", image=image),
        Draw(label="draw", mesh=mesh, state=state),
    )
    expected = np.array(run_reference(commands, NV2A, 4, 4, 24).target.color)
    assert expected[0, 0, :3].tolist() == image.levels[0][0, 2, 0, :3].tolist()
    for engine in ("portable", "columns"):
        assert np.array_equal(execute(commands, NV2A, 4, 4, engine=engine).framebuffer.color, expected)


@pytest.mark.parametrize("environment", [TextureEnvironmentMode.NONE, TextureEnvironmentMode.MODULATE])
def test_stages_discard_fragments_of_which_no_environment_reads_a_texel(environment):
    stages = (TextureShaderStage(Operation.CULL_FRAGMENT),)
    unit = TextureUnit(None, NEAREST, environment=TextureEnvironment(environment))
    corners = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
    mesh = Mesh(corners, colors=np.ones((3, 4)), texture_coordinates=(corners,))
    state = PassState(texture_units=(unit,), texture_shader=stages)
    commands = (Clear(label="clear", color=(0.0,) * 4), Draw(label="draw", mesh=mesh, state=state))
    expected = np.array(run_reference(commands, NV2A, 4, 4, 24).target.color)
    assert expected.any(-1).sum() == 4  # s and t are not below 0 in a quarter of the window
    for engine in (None, "portable", "columns"):
        assert np.array_equal(execute(commands, NV2A, 4, 4, engine=engine).framebuffer.color, expected)
