"""Texture shaders and depth textures: kernels equal the specification; what is inconsistent is refused."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    CullMode,
    DotProductMapping,
    PrimitiveType,
    Register,
    TexelWord,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
    VertexStage,
    WrapMode,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import G400, GEFORCE_3, GEFORCE_256, NV2A, TEXRAM
from fixedpipe.pipeline.state import (
    CombinerInput,
    DepthTest,
    FinalCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    SignedComponents,
    TexGen,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map
from fixedpipe.pipeline.textures.words import texture_of_words
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.support.run_reference import run_reference

WIDTH, HEIGHT = 16, 8
DOT, REFLECT = Operation.DOT_PRODUCT, Operation.DOT_PRODUCT_REFLECT_CUBE_MAP
CONSTANT = Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP
BRDF = Operation.BRDF_TEXTURE_3D
CHAINS = {  # the operations of four stages, and the targets of the textures they read
    "pass through": ((Operation.PASS_THROUGH,), ""),
    "cull": ((Operation.TEXTURE_2D, Operation.CULL_FRAGMENT), "2"),
    "offset": ((Operation.TEXTURE_2D, Operation.OFFSET_TEXTURE_2D), "22"),
    "scale": ((Operation.TEXTURE_2D, Operation.OFFSET_TEXTURE_2D_SCALE), "22"),
    "alpha red": ((Operation.TEXTURE_2D, Operation.DEPENDENT_AR_TEXTURE_2D), "22"),
    "green blue": ((Operation.PASS_THROUGH, Operation.DEPENDENT_GB_TEXTURE_2D), " 2"),
    "plane": ((Operation.TEXTURE_2D, DOT, Operation.DOT_PRODUCT_TEXTURE_2D), "2 2"),
    "depth": ((Operation.TEXTURE_2D, DOT, Operation.DOT_PRODUCT_DEPTH_REPLACE), "2"),
    "cube": ((Operation.TEXTURE_2D, DOT, DOT, Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP), "2  c"),
    "volume": ((Operation.TEXTURE_2D, DOT, DOT, Operation.DOT_PRODUCT_TEXTURE_3D), "2  c"),
    "reflect": ((Operation.TEXTURE_2D, DOT, DOT, REFLECT), "2  c"),
    "flat": ((Operation.TEXTURE_2D, DOT, DOT, REFLECT), "2  2"),
    "diffuse": ((Operation.TEXTURE_2D, DOT, Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP, CONSTANT), "2 cc"),
    "2D as cube map": ((Operation.TEXTURE_CUBE_MAP,), "2"),
    "brdf": ((Operation.TEXTURE_CUBE_MAP, Operation.TEXTURE_CUBE_MAP, BRDF), "cc3"),
    "brdf of 2D": ((Operation.NONE, Operation.TEXTURE_2D, Operation.PASS_THROUGH, BRDF), "22 3"),
}

CLAMPED = NV2A.changed(offset_scale_clamped=True)


def pick(random, members):
    """One member of an enumeration."""
    return list(members)[random.integers(len(members))]


def shows(register):
    """Combiners that show a texture register, alpha included."""
    rgb = RGBPortion(a=CombinerInput(register))
    final = FinalCombiner(
        a=CombinerInput(), b=CombinerInput(), c=CombinerInput(), d=CombinerInput(Register.SPARE0)
    )
    general = replace(RegisterCombiners().general[0], rgb=rgb)
    return RegisterCombiners(general=(general,), final=final)


def frame(operations, targets, random, filtered=TextureFilter.NEAREST):
    """A few random triangles through the stages."""
    unit_count, commands = len(operations), [Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0), depth=1.0)]
    commands.append(
        TexImage(label="2", texture="2", image=texture_2d(random.integers(0, 256, (4, 4, 4), np.uint8)))
    )
    faces = random.integers(0, 256, (6, 4, 4, 4), np.uint8)
    commands.append(TexImage(label="c", texture="c", image=texture_cube_map(faces)))
    if "3" in targets:
        words = random.integers(0, 1 << 32, (8, 4, 4))
        volume = texture_of_words(words, TexelWord.A8R8G8B8, TextureTarget.TEXTURE_3D)
        commands.append(TexImage(label="3", texture="3", image=volume))
    sampler = Sampler(filtered, filtered, *(pick(random, WrapMode) for _ in range(2)))
    sampler = replace(sampler, wrap_r=pick(random, WrapMode))
    stages = tuple(
        TextureShaderStage(
            operation,
            cull_modes=tuple(pick(random, CullMode) for _ in range(4)),
            offset_texture_matrix=tuple(random.uniform(-1, 1, 4).tolist()),
            offset_texture_scale=float(random.uniform(-1, 2)),
            offset_texture_bias=float(random.uniform(-1, 1)),
            dot_product_mapping=pick(random, DotProductMapping),
            constant_eye=tuple(random.uniform(-1, 1, 3).tolist()),
        )
        for operation in operations
    )
    units = tuple(
        TextureUnit(targets[k] if targets[k : k + 1].strip() else None, sampler, coordinates=k)
        for k in range(unit_count)
    )
    vertices = 9
    positions = np.column_stack([random.uniform(0, WIDTH, vertices), random.uniform(0, HEIGHT, vertices)])
    scale = 1000.0 if Operation.DOT_PRODUCT_DEPTH_REPLACE in operations else 1.0
    sets = [random.integers(-4, 5, (vertices, 4)) / 2.0 for _ in range(unit_count)]
    sets[-2 if unit_count > 1 else 0] *= scale
    mesh = Mesh(
        np.column_stack([positions, np.zeros(vertices), random.choice([1.0, 2.0], vertices)]),
        PrimitiveType.TRIANGLES,
        texture_coordinates=tuple(sets),
    )
    for unit in range(unit_count):
        state = PassState(
            vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS),
            register_combiners=shows(Register(Register.TEXTURE0 + unit)),
            texture_units=units,
            texture_shader=stages,
            depth_test=DepthTest(ComparisonFunction.ALWAYS),
        )
        commands.append(Draw(label=f"unit {unit}", mesh=mesh, state=state))
    return tuple(commands)


def assert_equal_to_reference(commands, profile, batch):
    result = execute(commands, profile, WIDTH, HEIGHT, depth_bits=24, threads=1, batch=batch)
    target = run_reference(commands, profile, WIDTH, HEIGHT, 24).target
    assert np.array_equal(result.framebuffer.color, np.array(target.color))
    assert np.array_equal(result.framebuffer.depth, np.array(target.depth))


@pytest.mark.parametrize("name", CHAINS)
@pytest.mark.parametrize("filtered", [TextureFilter.NEAREST, TextureFilter.LINEAR])
def test_every_operation_equals_the_specification(name, filtered):
    for seed in range(4):
        commands = frame(*CHAINS[name], np.random.default_rng(seed), filtered)
        assert_equal_to_reference(commands, NV2A, 16 << seed)
        assert_equal_to_reference(commands, CLAMPED, 16 << seed)


@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3, G400], ids=lambda p: p.name)
def test_a_factor_above_one_is_clamped_where_the_machine_clamps_it(profile):
    """Measured: factors above 1 on the NV2A (BumpEnvMapLuminance); Source: NV_texture_shader revision 30."""
    commands = bumped(SCALED, (NO_EFFECT, REPLACE))
    texels = (255, 0, 0, 255), (100, 60, 20, 77)
    images = [
        replace(c, image=texture_2d(np.array([[t]], np.uint8)))
        for c, t in zip(commands, texels, strict=False)
    ]
    for scale, bias, factor in ((0.5, 1.0, 1.5), (1.0, 0.0, 1.0), (-1.0, 0.5, 0.0), (0.25, 0.25, 0.5)):
        stage = replace(SCALED[1], offset_texture_scale=scale, offset_texture_bias=bias)
        draw = replace(commands[2], state=replace(commands[2].state, texture_shader=(SCALED[0], stage)))
        shown = execute((*images, draw), profile, WIDTH, HEIGHT).framebuffer.color[0, 0]
        factor = min(factor, 1.0) if profile.texture_shaders.offset_scale_clamped else factor
        assert shown.tolist() == [*(int(c * factor) for c in texels[1][:3]), 77], (scale, bias)
    assert [p.texture_shaders.offset_scale_clamped for p in (NV2A, GEFORCE_3, G400)] == [False, True, True]


@pytest.mark.parametrize("engine", [None, "portable", "columns"])
@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3], ids=lambda p: p.name)
def test_a_later_stage_reads_the_texel_before_it_is_scaled(profile, engine):
    """Source: NV_texture_shader section 3.8.13.1.9."""
    stages = (*SCALED, TextureShaderStage(Operation.DEPENDENT_GB_TEXTURE_2D, 1))
    stages = stages[0], replace(stages[1], offset_texture_scale=0.0, offset_texture_bias=0.5), stages[2]
    places = np.indices((256, 256)).astype(np.uint8)
    table = np.stack([places[1], places[0], places[0] * 0, places[0] * 0 + 255], axis=-1)
    *_, draw = bumped(SCALED, (NO_EFFECT, REPLACE))
    images = {"bumps": [[(0, 0, 0, 255)]], "image": [[(0, 200, 80, 255)]], "table": table}
    units = (*draw.state.texture_units, TextureUnit("table", Sampler(*(TextureFilter.NEAREST,) * 2)))
    commands = tuple(
        TexImage(label=name, texture=name, image=texture_2d(np.array(image, np.uint8)))
        for name, image in images.items()
    )
    for unit, texel in ((1, [0, 100, 40, 255]), (2, [200, 80, 0, 255])):
        state = replace(
            draw.state,
            texture_units=units,
            texture_shader=stages,
            register_combiners=shows(Register(Register.TEXTURE0 + unit)),
        )
        frames = (*commands, replace(draw, state=state))
        shown = execute(frames, profile, WIDTH, HEIGHT, engine=engine).framebuffer.color[0, 0]
        assert shown.tolist()[:3] == texel[:3]
        assert run_reference(frames, profile, WIDTH, HEIGHT, 24).target.color[0][0][:3] == texel[:3]


@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3], ids=lambda p: p.name)
@pytest.mark.parametrize("filtered", [TextureFilter.NEAREST, TextureFilter.LINEAR])
def test_stages_after_a_scaled_one_equal_the_specification(profile, filtered):
    operations = (Operation.TEXTURE_2D, Operation.OFFSET_TEXTURE_2D_SCALE, Operation.DEPENDENT_AR_TEXTURE_2D)
    for seed in range(4):
        commands = frame(operations, "222", np.random.default_rng(seed), filtered)
        images = commands[:-3]
        draws = tuple(
            replace(
                d,
                state=replace(
                    d.state, texture_shader=(first, second, replace(third, previous_texture_input=1))
                ),
            )
            for d in commands[-3:]
            for first, second, third in [d.state.texture_shader]
        )
        assert_equal_to_reference((*images, *draws), profile, 16 << seed)


HILO_SIGNS = [SignedComponents(), SignedComponents(green=True, alpha=True), SignedComponents(green=True)]


@pytest.mark.parametrize("kind", [TexelWord.R16B16, TexelWord.Y16], ids=lambda kind: kind.name)
@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3], ids=lambda p: p.name)
@pytest.mark.parametrize("signed", HILO_SIGNS)
@pytest.mark.parametrize(
    "mapping", [DotProductMapping.UNSIGNED_HILO, DotProductMapping.SIGNED_HILO_HEMISPHERE]
)
def test_words_of_sixteen_bits_are_filtered_as_the_specification_filters_them(mapping, signed, profile, kind):
    for seed in range(3):
        random = np.random.default_rng(seed)
        commands = list(frame(*CHAINS["plane"], random, TextureFilter.LINEAR))
        image = texture_of_words(random.integers(0, 1 << 32, (4, 4)), kind)
        draw = commands[-1]
        units, stages = draw.state.texture_units, draw.state.texture_shader
        first = replace(
            units[0], texture="words", sampler=replace(units[0].sampler, signed_components=signed)
        )
        state = replace(
            draw.state,
            texture_units=(first, *units[1:]),
            texture_shader=tuple(replace(stage, dot_product_mapping=mapping) for stage in stages),
        )
        words = TexImage(label="words", texture="words", image=image)
        assert_equal_to_reference((*commands[:-3], words, replace(draw, state=state)), profile, 64)


@pytest.mark.parametrize("filtered", [TextureFilter.NEAREST, TextureFilter.LINEAR])
@pytest.mark.parametrize("mode", list(TextureCompareMode)[1:])
@pytest.mark.parametrize("kind", [TexelWord.Y16_FIXED, TexelWord.Y16_FLOAT, TexelWord.X8_Y24_FIXED])
@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3])
def test_depth_textures_are_compared_alike(filtered, mode, kind, profile):
    if mode not in profile.textures.texture_compare_modes:
        return
    random = np.random.default_rng(kind)
    words = random.integers(0, 1 << 12, (4, 4)) << (8 if kind == TexelWord.X8_Y24_FIXED else 0)
    for function in ComparisonFunction:
        sampler = Sampler(filtered, filtered, compare_mode=mode, compare_function=function)
        scale = 1.0 if profile.textures.depth_units_in_coordinates else 2.0**-16
        sets = np.column_stack([random.uniform(-1, 2, (6, 2)), random.uniform(0, 4096, 6) * scale])
        mesh = Mesh(
            np.column_stack([random.uniform(0, WIDTH, 6), random.uniform(0, HEIGHT, 6), np.zeros(6)]),
            texture_coordinates=(np.column_stack([sets, random.choice([1.0, 2.0], 6)]),),
        )
        state = PassState(
            vertex=VertexState(stage=VertexStage.PROGRAM_RESULTS),
            register_combiners=shows(Register.TEXTURE0),
            texture_units=(TextureUnit("depths", sampler),),
        )
        image = texture_of_words(words, kind)
        commands = (
            TexImage(label="depths", texture="depths", image=image),
            Draw(label="compared", mesh=mesh, state=state),
        )
        assert_equal_to_reference(commands, profile, 64)


def refused(operations, targets, words, profile=NV2A, **changes):
    commands = list(frame(operations, targets, np.random.default_rng(0)))
    stages = tuple(replace(stage, **changes) for stage in commands[-1].state.texture_shader)
    commands[-1] = replace(commands[-1], state=replace(commands[-1].state, texture_shader=stages))
    with pytest.raises(UnsupportedState, match=words):
        images = 4 if "3" in targets else 3
        validate(commands[:images] + commands[-1:], profile, WIDTH, HEIGHT, 24)


def test_what_is_inconsistent_is_refused():
    two, offset = Operation.TEXTURE_2D, Operation.OFFSET_TEXTURE_2D
    refused((two, offset), "22", "has no texture shaders", GEFORCE_256_WITH_UNITS)
    refused((two, offset), "22", "reads stage 1", previous_texture_input=1)
    refused((Operation.CULL_FRAGMENT, offset), " 2", "an earlier stage that results in a color or a texel")
    refused((two, Operation.DOT_PRODUCT_TEXTURE_2D), "22", "the stage 1 before it must be DOT_PRODUCT")
    refused((two, DOT, REFLECT), "2 c", "the stage 2 before it must be DOT_PRODUCT")
    refused((two, DOT, Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP), "2 c", "the stage after it must be")
    refused((Operation.TEXTURE_CUBE_MAP,), "2", "is a TEXTURE_2D", GEFORCE_3)
    refused((two, BRDF), "23", "the two stages before it")
    refused((two, Operation.CULL_FRAGMENT, BRDF), "2 3", "the two stages before it")
    refused((two, two, BRDF), "22c", "give it a TEXTURE_3D")
    refused((two, two, BRDF), "223", "has no BRDF_TEXTURE_3D", GEFORCE_3)
    refused((Operation.TEXTURE_1D,), "2", "is a TEXTURE_2D")
    few = NV2A.changed(texture_shader_operations=frozenset({two}))
    refused((two, offset), "22", "has no OFFSET_TEXTURE_2D .*; it has TEXTURE_2D", few)
    identity = frozenset({DotProductMapping.UNSIGNED_IDENTITY})
    narrow = NV2A.changed(dot_product_mappings=identity)
    expanded = {"dot_product_mapping": DotProductMapping.EXPAND_NORMAL}
    refused((two, DOT), "2", "no dot product mapping EXPAND_NORMAL", narrow, **expanded)


def test_texture_shaders_without_units_are_refused():
    for profile, words in ((GEFORCE_256, "has no texture shaders"), (NV2A, "give each stage a unit")):
        state = PassState(texture_shader=(TextureShaderStage(Operation.TEXTURE_2D),))
        draw = Draw(label="d", mesh=Mesh(np.zeros((3, 3))), state=state)
        with pytest.raises(UnsupportedState, match=words):
            validate((draw,), profile, WIDTH, HEIGHT)


def test_a_unit_whose_stage_reads_no_texture_is_checked_all_the_same():
    commands = frame(*CHAINS["pass through"], np.random.default_rng(0))
    unit, state = TextureUnit("missing"), commands[-1].state
    named = replace(commands[-1], state=replace(state, texture_units=(unit,)))
    with pytest.raises(UnsupportedState, match="no texture 'missing' yet"):
        validate((named,), NV2A, WIDTH, HEIGHT)
    sphere = (TexGen(), TexGen(), TexGen(TexGenMode.SPHERE_MAP), TexGen())
    generated = replace(named, state=replace(state, texture_units=(TextureUnit(None, gen=sphere),)))
    with pytest.raises(UnsupportedState, match="generates r by SPHERE_MAP"):
        validate((generated,), NV2A, WIDTH, HEIGHT)


GEFORCE_256_WITH_UNITS = GEFORCE_256.changed(max_texture_units=4)


# ------------------------------------------------------------------------- boards without register combiners

SIGNED = SignedComponents(True, True, True, True)
BUMPS = (
    TextureShaderStage(Operation.TEXTURE_2D),
    TextureShaderStage(Operation.OFFSET_TEXTURE_2D, offset_texture_matrix=(0.5, 0.25, -0.25, 0.5)),
)
SCALED = (
    BUMPS[0],
    replace(
        BUMPS[1],
        operation=Operation.OFFSET_TEXTURE_2D_SCALE,
        offset_texture_scale=0.75,
        offset_texture_bias=0.25,
    ),
)
NO_EFFECT = TextureEnvironment(TextureEnvironmentMode.NONE)
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)


def bumped(stages, environments, filters=TextureFilter.NEAREST, seed=0):
    """A square with a bump map of a few texels in unit 0, which displaces an image in unit 1."""
    random = np.random.default_rng(seed)
    bumps = texture_2d(random.integers(0, 256, (2, 4, 4), np.uint8))
    image = texture_2d(random.integers(0, 256, (8, 16, 4), np.uint8))
    sampler = Sampler(filters, filters)
    units = tuple(
        TextureUnit(name, replace(sampler, signed_components=signed), environment=environment)
        for name, signed, environment in zip(
            ("bumps", "image"), (SIGNED, SignedComponents()), environments, strict=True
        )
    )
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    mesh = Mesh(
        square,
        PrimitiveType.QUADS,
        colors=random.random((4, 4)),
        texture_coordinates=(square * 0.5 + 0.5,) * 2,
    )
    mesh = replace(mesh, texture_coordinates=(mesh.texture_coordinates[0],))
    state = PassState(texture_units=units, texture_shader=stages)
    return (
        TexImage(label="bumps", texture="bumps", image=bumps),
        TexImage(label="image", texture="image", image=image),
        Draw(label="bumped", mesh=mesh, state=state),
    )


@pytest.mark.parametrize("profile", [G400, TEXRAM], ids=lambda p: p.name)
@pytest.mark.parametrize("filters", [TextureFilter.NEAREST, TextureFilter.LINEAR])
@pytest.mark.parametrize("modulates", [False, True])
def test_offset_bump_maps_through_texture_environments(profile, filters, modulates):
    stages = (
        (BUMPS, SCALED)
        if Operation.OFFSET_TEXTURE_2D_SCALE in profile.texture_shaders.texture_shader_operations
        else (BUMPS,)
    )
    for seed, program in enumerate(stages):
        environments = (NO_EFFECT, TextureEnvironment() if modulates else REPLACE)
        commands = bumped(program, environments, filters, seed)
        got = execute(commands, profile, WIDTH, HEIGHT, depth_bits=24).framebuffer.color
        expected = run_reference(commands, profile, WIDTH, HEIGHT, 24).target.color
        np.testing.assert_array_equal(got, np.array(expected))


def test_a_bump_map_displaces_by_its_signed_texels_through_the_matrix():
    """Du = B/128, dv = G/128 of the bump map; the image's texel at (s + a1 du + a3 dv, t + a2 du + a4 dv)."""
    bumps, image, draw = bumped(BUMPS, (NO_EFFECT, REPLACE))
    got = execute((bumps, image, draw), G400, WIDTH, HEIGHT).framebuffer.color[::-1]
    texels = bumps.image.levels[0][0].astype(np.int8).astype(float) / 128
    a1, a2, a3, a4 = BUMPS[1].offset_texture_matrix
    for y in range(HEIGHT):
        for x in range(WIDTH):
            s, t = (x + 0.5) / WIDTH, (y + 0.5) / HEIGHT
            du, dv = texels[int(t * 2), int(s * 4), [2, 1]]
            s, t = s + a1 * du + a3 * dv, t + a2 * du + a4 * dv
            assert (
                got[y, x].tolist()
                == image.image.levels[0][0, int(t * 8 // 1) % 8, int(np.floor(s * 16)) % 16].tolist()
            )


@pytest.mark.parametrize(
    ("profile", "stages", "words"),
    [
        (TEXRAM, SCALED, "OFFSET_TEXTURE_2D_SCALE"),
        (G400, (BUMPS[0], TextureShaderStage(Operation.DEPENDENT_AR_TEXTURE_2D)), "DEPENDENT_AR_TEXTURE_2D"),
        (G400, (*BUMPS, BUMPS[0]), "stages"),
        (GEFORCE_256, BUMPS, "no texture shaders"),
    ],
)
def test_what_a_board_s_bump_maps_lack_is_refused(profile, stages, words):
    with pytest.raises(UnsupportedState, match=words):
        execute(bumped(stages, (NO_EFFECT, REPLACE)), profile, WIDTH, HEIGHT)
