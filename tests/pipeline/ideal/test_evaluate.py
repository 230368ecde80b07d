"""The ideal evaluator against closed forms, a scalar check in plain Python, and the machine."""

import math
import random
from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.passes.encoding import vector_colors, vector_texels
from fixedpipe.pipeline.commands import (
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    Mesh,
    ReadPixels,
    Saturate,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    Clamp,
    CombinerBias,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    Face,
    FogCoordinateSource,
    FogMode,
    InternalFormat,
    LogicOperation,
    Mapping,
    PrimitiveType,
    Register,
    ShadeModel,
    StencilOperation,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal import evaluate
from fixedpipe.pipeline.ideal.buffers import IdealBuffers
from fixedpipe.pipeline.ideal.combine import combine, plan_of
from fixedpipe.pipeline.ideal.coordinates import TextureCoordinates, place, project_on_cube
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.ideal.per_fragment import write
from fixedpipe.pipeline.ideal.sample import sample, sample_level
from fixedpipe.pipeline.ideal.weights import fixed, mesh_of, weigh
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL
from fixedpipe.pipeline.state import (
    AlphaPortion,
    AlphaTest,
    Blending,
    ColorMask,
    CombinerInput,
    DepthTest,
    FinalCombiner,
    Fog,
    GeneralCombiner,
    Light,
    Lighting,
    LineState,
    PassState,
    PolygonState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    Scissor,
    StencilTest,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.textures.images import texture_1d, texture_2d, texture_cube_map
from fixedpipe.pipeline.vertices.primitives import WindowPrimitives
from fixedpipe.raster.columns.per_fragment import in_order

# Float64 noise of some dozens of operations on values of order one.
NOISE = 1e-12

LINEAR = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE)
NEAREST = replace(LINEAR, min_filter=TextureFilter.NEAREST, mag_filter=TextureFilter.NEAREST)

TEXTURE0_ALONE = RegisterCombiners(
    final=FinalCombiner(
        a=CombinerInput(),
        c=CombinerInput(),
        d=CombinerInput(Register.TEXTURE0),
        g=CombinerInput(Register.TEXTURE0, usage=ComponentUsage.ALPHA),
    )
)


def quad(z=0.0, **columns):
    """The whole window, two triangles."""
    corners = [[-1, -1, z], [1, -1, z], [1, 1, z], [-1, 1, z]]
    return Mesh(positions=corners, primitive=PrimitiveType.QUADS, **columns)


def plain(color, z=0.0):
    return quad(z, colors=[color] * 4)


UNIT_SQUARE = ([[0, 0], [1, 0], [1, 1], [0, 1]],)


def centres(size):
    return (np.arange(size) + 0.5) / size


# ------------------------------------------------------------------------------------------- combiners


@pytest.mark.parametrize(
    ("mapping", "expected"),
    [
        # For -2, -1/4, 0, 1/4, 1, 3.  Source: NV_register_combiners, table 4.
        (Mapping.UNSIGNED_IDENTITY, [0, 0, 0, 0.25, 1, 3]),
        (Mapping.UNSIGNED_INVERT, [1, 1, 1, 0.75, 0, 0]),
        (Mapping.EXPAND_NORMAL, [-1, -1, -1, -0.5, 1, 5]),
        (Mapping.EXPAND_NEGATE, [1, 1, 1, 0.5, -1, -5]),
        (Mapping.HALF_BIAS_NORMAL, [-0.5, -0.5, -0.5, -0.25, 0.5, 2.5]),
        (Mapping.HALF_BIAS_NEGATE, [0.5, 0.5, 0.5, 0.25, -0.5, -2.5]),
        (Mapping.SIGNED_IDENTITY, [-2, -0.25, 0, 0.25, 1, 3]),
        (Mapping.SIGNED_NEGATE, [2, 0.25, 0, -0.25, -1, -3]),
    ],
)
def test_mappings_are_the_specifications_in_real_numbers(mapping, expected):
    # x / 16 + 1/2 lies in [0, 1], and is exact.
    def constant(value):
        return CombinerInput(value, Mapping.SIGNED_IDENTITY)

    portion = RGBPortion(
        a=CombinerInput(Register.SPARE1, mapping),
        b=constant(Register.CONSTANT_COLOR0),
        c=constant(Register.CONSTANT_COLOR1),
        d=constant(Register.CONSTANT_COLOR1),
    )
    combiners = RegisterCombiners(
        general=(GeneralCombiner(portion, replace(AlphaPortion(), sum_output=Register.DISCARD)),),
        final=FinalCombiner(a=CombinerInput(), c=CombinerInput(), d=CombinerInput(Register.SPARE0)),
        constant_color0=(1 / 16,) * 4,
        constant_color1=(0.5**0.5,) * 4,
    )
    registers = {r: np.zeros((6, 4)) for r in WRITABLE}
    registers[Register.SPARE1][:] = np.array([[-2.0, -0.25, 0, 0.25, 1, 3]]).T
    half = (0.5**0.5) ** 2
    found = (combine(plan_of(combiners), registers)[:, 0] - half) * 16
    np.testing.assert_allclose(found, expected, atol=16 * NOISE)


def scalar_map(mapping, x):
    floor = max(0.0, x)
    return {
        Mapping.UNSIGNED_IDENTITY: floor,
        Mapping.UNSIGNED_INVERT: 1.0 - min(floor, 1.0),
        Mapping.EXPAND_NORMAL: 2.0 * floor - 1.0,
        Mapping.EXPAND_NEGATE: -(2.0 * floor - 1.0),
        Mapping.HALF_BIAS_NORMAL: floor - 0.5,
        Mapping.HALF_BIAS_NEGATE: -(floor - 0.5),
        Mapping.SIGNED_IDENTITY: x,
        Mapping.SIGNED_NEGATE: -x,
    }[mapping]


def scalar_read(variable, registers, channel):
    index = {ComponentUsage.RGB: channel, ComponentUsage.ALPHA: 3, ComponentUsage.BLUE: 2}[variable.usage]
    return scalar_map(variable.mapping, registers[variable.register][index])


def scalar_portion(portion, registers, channels):
    ab = [scalar_read(portion.a, registers, c) * scalar_read(portion.b, registers, c) for c in channels]
    cd = [scalar_read(portion.c, registers, c) * scalar_read(portion.d, registers, c) for c in channels]
    if getattr(portion, "ab_dot_product", False):
        ab = [sum(ab)] * 3
    if getattr(portion, "cd_dot_product", False):
        cd = [sum(cd)] * 3
    if portion.mux_sum:
        total = cd if registers[Register.SPARE0][3] >= 0.5 else ab
    else:
        total = [x + y for x, y in zip(ab, cd, strict=True)]
    half = 0.5 if portion.bias is CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF else 0.0
    scale = (1.0, 2.0, 4.0, 0.5)[portion.scale]
    written = {}
    for register, values in ((portion.ab_output, ab), (portion.cd_output, cd), (portion.sum_output, total)):
        if register is not Register.DISCARD:
            for c, value in zip(channels, values, strict=True):
                written[register, c] = (value - half) * scale
    return written


def scalar_combine(combiners, registers):
    """One fragment through NV_register_combiners, in Python floats."""
    registers = {r: list(v) for r, v in registers.items()}
    registers[Register.ZERO] = [0.0] * 4
    registers[Register.CONSTANT_COLOR0] = list(combiners.constant_color0)
    registers[Register.CONSTANT_COLOR1] = list(combiners.constant_color1)
    for stage in combiners.general:
        written = scalar_portion(stage.rgb, registers, (0, 1, 2)) | scalar_portion(
            stage.alpha, registers, (3,)
        )
        for (register, c), value in written.items():
            registers[register][c] = value
    final = combiners.final
    registers[Register.E_TIMES_F] = [
        scalar_read(final.e, registers, c) * scalar_read(final.f, registers, c) for c in range(3)
    ]
    registers[Register.SPARE0_PLUS_SECONDARY_COLOR] = [
        max(0.0, registers[Register.SPARE0][c]) + max(0.0, registers[Register.SECONDARY_COLOR][c])
        for c in range(3)
    ]
    out = []
    for c in range(3):
        a, b, third, d = (scalar_read(v, registers, c) for v in (final.a, final.b, final.c, final.d))
        weight = min(a, 1.0)
        out.append(min(max(weight * b + (1.0 - weight) * third + d, 0.0), 1.0))
    return [*out, min(max(scalar_read(final.g, registers, 3), 0.0), 1.0)]


READABLE = [r for r in Register if r < Register.E_TIMES_F]
WRITABLE = [r for r in READABLE if r >= Register.PRIMARY_COLOR]


def random_portion(rng, kind):
    usages = (ComponentUsage.RGB if kind is RGBPortion else ComponentUsage.BLUE, ComponentUsage.ALPHA)
    mappings = list(Mapping)
    variables = {
        v: CombinerInput(rng.choice(READABLE), rng.choice(mappings), rng.choice(usages)) for v in "abcd"
    }
    outputs = rng.sample(WRITABLE, 3)
    dots = {}
    if kind is RGBPortion:
        dots = {"ab_dot_product": rng.random() < 0.4, "cd_dot_product": rng.random() < 0.4}
    scale, bias = rng.choice(
        [(s, CombinerBias.NONE) for s in CombinerScale]
        + [
            (s, CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF)
            for s in (CombinerScale.NONE, CombinerScale.SCALE_BY_TWO)
        ]
    )
    return kind(
        **variables,
        ab_output=rng.choice([outputs[0], Register.DISCARD]),
        cd_output=rng.choice([outputs[1], Register.DISCARD]),
        sum_output=outputs[2],
        scale=scale,
        bias=bias,
        mux_sum=rng.random() < 0.3,
        **dots,
    )


def random_final(rng):
    def variable(registers, usages=(ComponentUsage.RGB, ComponentUsage.ALPHA)):
        register = rng.choice(registers)
        usage = rng.choice(usages) if register < Register.E_TIMES_F else ComponentUsage.RGB
        return CombinerInput(register, rng.choice(list(Mapping)[:2]), usage)

    everything = [*READABLE, Register.E_TIMES_F, Register.SPARE0_PLUS_SECONDARY_COLOR]
    return FinalCombiner(
        **{v: variable(everything) for v in "bcd"},
        **{v: variable(READABLE) for v in "aef"},
        g=variable(READABLE, (ComponentUsage.ALPHA, ComponentUsage.BLUE)),
    )


@pytest.mark.parametrize("seed", range(40))
def test_combiners_equal_a_scalar_evaluation(seed):
    rng = random.Random(seed)
    combiners = RegisterCombiners(
        general=tuple(
            GeneralCombiner(random_portion(rng, RGBPortion), random_portion(rng, AlphaPortion))
            for _ in range(rng.randint(1, 3))
        ),
        final=random_final(rng),
        constant_color0=tuple(rng.random() for _ in range(4)),
        constant_color1=tuple(rng.random() for _ in range(4)),
    )
    fragments = 7
    columns = {
        r: np.array([[rng.uniform(-1, 1) for _ in range(4)] for _ in range(fragments)])
        for r in [*WRITABLE, Register.FOG]
    }
    kept = {r: c.copy() for r, c in columns.items()}
    out = combine(plan_of(combiners), columns)
    expected = [scalar_combine(combiners, {r: c[k] for r, c in columns.items()}) for k in range(fragments)]
    np.testing.assert_allclose(out, expected, atol=NOISE, rtol=0)
    for register, column in columns.items():
        np.testing.assert_array_equal(column, kept[register])


def test_mux_takes_cd_from_one_half_on():
    portion = RGBPortion(
        a=CombinerInput(Register.CONSTANT_COLOR0),
        b=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT),
        c=CombinerInput(Register.CONSTANT_COLOR1),
        d=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT),
        mux_sum=True,
    )
    combiners = RegisterCombiners(
        general=(GeneralCombiner(portion),),
        final=FinalCombiner(a=CombinerInput(), c=CombinerInput(), d=CombinerInput(Register.SPARE0)),
        constant_color0=(0.25, 0, 0, 0),
        constant_color1=(0.75, 0, 0, 0),
    )
    registers = {r: np.zeros((3, 4)) for r in [*WRITABLE, Register.FOG]}
    registers[Register.SPARE0][:, 3] = [math.nextafter(0.5, 0), 0.5, 1.0]
    np.testing.assert_array_equal(combine(plan_of(combiners), registers)[:, 0], [0.25, 0.75, 0.75])


def test_a_general_combiner_may_leave_the_machines_range_and_come_back():
    # 4 * 0.5 = 2, then 2 * 0.25 = 0.5: the machine saturates the first stage at 1 and gives 0.25.
    half, quarter = Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1
    one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
    combiners = RegisterCombiners(
        general=(
            GeneralCombiner(RGBPortion(a=CombinerInput(half), b=one, scale=CombinerScale.SCALE_BY_FOUR)),
            GeneralCombiner(RGBPortion(a=CombinerInput(Register.SPARE0), b=CombinerInput(quarter))),
        ),
        final=FinalCombiner(a=CombinerInput(), c=CombinerInput(), d=CombinerInput(Register.SPARE0)),
        constant_color0=(0.5, 0.5, 0.5, 0.5),
        constant_color1=(0.25, 0.25, 0.25, 0.25),
    )
    frame = (Draw(label="scaled", mesh=plain([1, 1, 1]), state=PassState(register_combiners=combiners)),)
    assert execute_ideal(frame, 2, 2).color[0, 0, 0] == 0.5
    assert execute(frame, GEFORCE_256, 2, 2).framebuffer.color[0, 0, 0] == 64


def test_a_weight_of_the_final_combiner_is_at_most_one():
    # A weight of 2 stands for "fully": 2 x 0.25 would be brighter than what is lit.
    combiners = RegisterCombiners(
        final=FinalCombiner(
            a=CombinerInput(Register.SPARE1),
            b=CombinerInput(Register.CONSTANT_COLOR0),
            c=CombinerInput(Register.CONSTANT_COLOR1),
        ),
        constant_color0=(0.25, 0.25, 0.25, 0),
        constant_color1=(0.5, 0.5, 0.5, 0),
    )
    registers = {r: np.zeros((2, 4)) for r in [*WRITABLE, Register.FOG]}
    registers[Register.SPARE1][:, 0] = [2.0, 0.5]
    np.testing.assert_array_equal(combine(plan_of(combiners), registers)[:, 0], [0.25, 0.375])


def test_a_stage_may_have_its_own_constants_and_the_final_combiner_keeps_the_programs():
    add = RGBPortion(
        a=CombinerInput(Register.CONSTANT_COLOR0),
        b=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT),
        c=CombinerInput(Register.CONSTANT_COLOR1),
        d=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT),
    )
    combiners = RegisterCombiners(
        general=(
            GeneralCombiner(replace(add, sum_output=Register.SPARE1), constant_color0=(0.5, 0, 0, 0)),
            GeneralCombiner(add, constant_color1=(0, 0.25, 0, 0)),
        ),
        final=FinalCombiner(
            a=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT),
            b=CombinerInput(Register.SPARE1),
            c=CombinerInput(),
            d=CombinerInput(Register.CONSTANT_COLOR1),
        ),
        constant_color0=(0, 0, 0.125, 0),
        constant_color1=(0, 0, 0.0625, 0),
    )
    registers = {r: np.zeros((1, 4)) for r in [*WRITABLE, Register.FOG]}
    np.testing.assert_array_equal(combine(plan_of(combiners), registers)[0, :3], [0.5, 0, 0.125])
    spare0 = replace(combiners, final=replace(combiners.final, b=CombinerInput(Register.SPARE0)))
    np.testing.assert_array_equal(combine(plan_of(spare0), registers)[0, :3], [0, 0.25, 0.1875])


def test_registers_start_as_the_extension_says():
    # SPARE0's alpha is texture 0's, a disabled unit is opaque black, the fog factor without fog is one.
    texture = texture_2d(np.full((1, 1, 4), 0.375), InternalFormat.RGBA8)
    alpha = replace(AlphaPortion(), sum_output=Register.DISCARD)
    combiners = RegisterCombiners(general=(GeneralCombiner(alpha=alpha),), final=FinalCombiner())
    for units, expected in (((TextureUnit("t", NEAREST),), 0.375), ((), 1.0)):
        state = PassState(texture_units=units, register_combiners=combiners)
        mesh = quad(colors=[[0.2, 0.4, 0.6]] * 4, texture_coordinates=UNIT_SQUARE)
        frame = (TexImage(label="t", texture="t", image=texture), Draw(label="d", mesh=mesh, state=state))
        result = execute_ideal(frame, 1, 1)
        np.testing.assert_allclose(result.color[0, 0], [0.2, 0.4, 0.6, expected], atol=NOISE)


# -------------------------------------------------------------------------------------------- textures


def scalar_texel(row_of, index, size, wrap, linear, border):
    """One texel along an axis by section 3.8.4; ``row_of`` maps a valid index to a value."""
    if wrap is WrapMode.REPEAT:
        return row_of(index % size)
    if 0 <= index < size:
        return row_of(index)
    if wrap is WrapMode.CLAMP_TO_BORDER or (wrap is WrapMode.CLAMP and linear):
        return border
    return row_of(min(max(index, 0), size - 1))


def scalar_axis(coordinate, size, wrap):
    t = coordinate * size
    if wrap is WrapMode.REPEAT:
        return t - size * math.floor(t / size)
    if wrap is WrapMode.MIRRORED_REPEAT:
        whole = math.floor(t / size)
        part = t - whole * size
        return part if whole % 2 == 0 else size - part
    low = {WrapMode.CLAMP: 0.0, WrapMode.CLAMP_TO_EDGE: 0.5, WrapMode.CLAMP_TO_BORDER: -0.5}[wrap]
    return min(max(t, low), size - low)


def scalar_sample(image, s, t, sampler, linear):
    """Channel 0 of a level [h, w, 4] at (s, t)."""
    height, width = image.shape[:2]
    x, y = scalar_axis(s, width, sampler.wrap_s), scalar_axis(t, height, sampler.wrap_t)
    border = sampler.border_color[0]

    def at(j, i):
        def row(jj):
            return scalar_texel(lambda ii: float(image[jj, ii, 0]), i, width, sampler.wrap_s, linear, border)

        return scalar_texel(row, j, height, sampler.wrap_t, linear, border)

    if not linear:
        return at(math.floor(y), math.floor(x))
    i, j = math.floor(x - 0.5), math.floor(y - 0.5)
    a, b = x - 0.5 - i, y - 0.5 - j
    below = (1 - a) * at(j, i) + a * at(j, i + 1)
    above = (1 - a) * at(j + 1, i) + a * at(j + 1, i + 1)
    return (1 - b) * below + b * above


def at_positions(position):
    zeros = np.zeros_like(position)
    return TextureCoordinates(position, np.zeros(len(position), np.int64), zeros, zeros[:, :1], zeros, zeros)


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("wrap_s", list(WrapMode))
@pytest.mark.parametrize("wrap_t", [WrapMode.REPEAT, WrapMode.CLAMP, WrapMode.CLAMP_TO_BORDER])
def test_filters_and_wrap_modes_equal_a_scalar_evaluation(linear, wrap_s, wrap_t):
    rng = np.random.default_rng(3)
    image = rng.random((1, 3, 5, 4))
    sampler = Sampler(wrap_s=wrap_s, wrap_t=wrap_t, border_color=(-2.0, 0.0, 0.0, 0.0))
    position = rng.uniform(-2.5, 2.5, (60, 2))
    border = np.array(sampler.border_color)
    out = sample_level(image, at_positions(position), sampler, border, linear)
    expected = [scalar_sample(image[0], s, t, sampler, linear) for s, t in position]
    np.testing.assert_allclose(out[:, 0], expected, atol=NOISE, rtol=0)


def test_a_one_dimensional_texture_reads_its_row_and_not_t():
    row = np.linspace(0, 1, 4)[:, None]
    texture = texture_1d(row, InternalFormat.LUMINANCE8)
    unit = TextureUnit(
        "row", replace(LINEAR, wrap_t=WrapMode.CLAMP_TO_BORDER, border_color=(9.0, 9.0, 9.0, 9.0))
    )
    out = sample(texture, unit, at_positions(np.array([[0.5, 0.0], [0.125, 7.0]])))
    np.testing.assert_allclose(out, [[0.5, 0.5, 0.5, 1.0], [0.0, 0.0, 0.0, 1.0]], atol=NOISE)


@pytest.mark.parametrize("sampler", [LINEAR, NEAREST])
def test_a_textured_quad_shows_the_functions_own_values(sampler):
    # 16 texels on 32 pixels: the linear filter continues the ramp between texel centres, nearest repeats it.
    size = 16
    s, t = np.meshgrid(centres(size), centres(size))
    texture = texture_2d(np.stack([s / 3, t / 7, s * 0 + 1e-4], axis=-1), InternalFormat.RGB8)
    state = PassState(texture_units=(TextureUnit("f", sampler),), register_combiners=TEXTURE0_ALONE)
    frame = (
        TexImage(label="f", texture="f", image=texture),
        Draw(label="f", mesh=quad(texture_coordinates=UNIT_SQUARE), state=state),
    )
    color = execute_ideal(frame, 32, 32).color[::-1]
    between = np.clip(centres(32), 0.5 / size, 1 - 0.5 / size)
    x = between if sampler is LINEAR else np.repeat(centres(size), 2)
    np.testing.assert_allclose(color[..., 0], np.broadcast_to(x / 3, (32, 32)), atol=NOISE)
    np.testing.assert_allclose(color[..., 1], np.broadcast_to(x[:, None] / 7, (32, 32)), atol=NOISE)
    np.testing.assert_allclose(color[..., 2], 1e-4, atol=NOISE)


def test_without_float_sources_the_stored_bytes_are_read():
    texture = texture_2d(np.array([[[200]]], np.uint8), InternalFormat.LUMINANCE4)
    result = execute_ideal((TexImage(label="t", texture="t", image=texture),), 1, 1)
    texel = result.textures["t"].ideal[0][0, 0, 0]
    np.testing.assert_array_equal(texel, [204 / 255, 204 / 255, 204 / 255, 1])


def stepped_texture(levels):
    """Level l holds l / 16 everywhere."""
    texture = texture_2d(np.zeros((2**levels, 2**levels, 1)), InternalFormat.LUMINANCE8, mipmaps=True)
    steps = tuple(np.full(level.shape, k / 16) for k, level in enumerate(texture.ideal))
    return replace(texture, ideal=steps)


@pytest.mark.parametrize(
    ("min_filter", "lod_bias", "level"),
    [
        (TextureFilter.LINEAR_MIPMAP_LINEAR, 0.0, 1.25),
        (TextureFilter.LINEAR_MIPMAP_LINEAR, 0.1, 1.35),
        (TextureFilter.NEAREST_MIPMAP_LINEAR, 0.5, 1.75),
        (TextureFilter.LINEAR_MIPMAP_NEAREST, 0.0, 1.0),
        (TextureFilter.NEAREST_MIPMAP_NEAREST, 0.3, 2.0),
        (TextureFilter.LINEAR_MIPMAP_LINEAR, -1.25 - 1e-6, 0.0),
        (TextureFilter.LINEAR_MIPMAP_LINEAR, 9.0, 5.0),
        (TextureFilter.LINEAR, 1.0, 0.0),
    ],
)
def test_lambda_is_the_logarithm_of_the_texel_step(min_filter, lod_bias, level):
    texture = stepped_texture(5)
    # 8 pixels over 8 * 2**1.25 of 32 texels: a step of 2**1.25 texels, lambda = 1.25 before the bias.
    reach = 8 * 2**1.25 / 32
    mesh = quad(texture_coordinates=(np.array(UNIT_SQUARE[0]) * reach,))
    unit = TextureUnit("t", replace(LINEAR, min_filter=min_filter), lod_bias)
    state = PassState(texture_units=(unit,), register_combiners=TEXTURE0_ALONE)
    frame = (TexImage(label="t", texture="t", image=texture), Draw(label="d", mesh=mesh, state=state))
    np.testing.assert_allclose(execute_ideal(frame, 8, 8).color[..., 0], level / 16, atol=NOISE)


def test_a_texture_is_magnified_up_to_lambda_zero():
    texture = stepped_texture(3)
    checks = np.indices((8, 8)).sum(axis=0) % 2
    texture = replace(texture, ideal=(checks[None, :, :, None] * np.ones(4), *texture.ideal[1:]))
    for reach, minified in ((2**-0.01, False), (2**0.01, True)):
        mesh = quad(texture_coordinates=(np.array(UNIT_SQUARE[0]) * reach,))
        sampler = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.NEAREST)
        state = PassState(texture_units=(TextureUnit("t", sampler),), register_combiners=TEXTURE0_ALONE)
        frame = (TexImage(label="t", texture="t", image=texture), Draw(label="d", mesh=mesh, state=state))
        color = execute_ideal(frame, 8, 8).color[..., 0]
        assert (not np.isin(color, (0.0, 1.0)).any()) == minified


def test_the_lambda_of_a_one_dimensional_texture_comes_from_s_alone():
    texture = texture_1d(np.zeros((8, 1)), InternalFormat.LUMINANCE8, mipmaps=True)
    texture = replace(texture, ideal=tuple(np.full(a.shape, k / 16) for k, a in enumerate(texture.ideal)))
    mesh = quad(texture_coordinates=(np.array([[0, 0], [2, 0], [2, 500], [0, 500]]),))
    unit = TextureUnit("t", Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR))
    state = PassState(texture_units=(unit,), register_combiners=TEXTURE0_ALONE)
    frame = (TexImage(label="t", texture="t", image=texture), Draw(label="d", mesh=mesh, state=state))
    np.testing.assert_allclose(execute_ideal(frame, 8, 8).color[..., 0], 1 / 16, atol=NOISE)


def projective_triangle():
    """A triangle in perspective with a projective texture (q not 1)."""
    return WindowPrimitives(
        x=np.array([3, 700, 210], np.int32),
        y=np.array([655, 500, -40], np.int32),
        z=np.array([0.2, 0.5, 0.9]),
        inverse_w=np.array([1.0, 0.25, 0.6]),
        colors=np.zeros((3, 2, 8)),
        coordinates=np.array([[[0.0, 0.1, 0.3, 1.0]], [[1.5, 0.2, -0.4, 1.2]], [[0.4, 2.0, 0.8, 0.7]]]),
        fog=np.zeros(3),
        triangles=np.array([[0, 1, 2, 2]], np.int32),
        dropped=0,
        two_side=False,
    )


def scalar_strq(p, x, y):
    """s, t, r, q of unit 0 at a window position in pixels (y down), by solving for barycentrics."""
    (x0, x1, x2), (y0, y1, y2) = p.x / 16, p.y / 16
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    b1 = ((x - x0) * (y2 - y0) - (x2 - x0) * (y - y0)) / area
    b2 = ((x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)) / area
    share = [(1 - b1 - b2) * p.inverse_w[0], b1 * p.inverse_w[1], b2 * p.inverse_w[2]]
    return sum(w * p.coordinates[k, 0] for k, w in enumerate(share)) / sum(share)


def scalar_project(p, x, y):
    s, t, _, q = scalar_strq(p, x, y)
    return np.array([s / q, t / q])


def scalar_cube(direction):
    """Face, and the position on it, by EXT_texture_cube_map's table."""
    x, y, z = (float(c) for c in direction)
    magnitude = max(abs(x), abs(y), abs(z))
    if abs(x) == magnitude:
        face, sc, tc = (0, -z, -y) if x >= 0 else (1, z, -y)
    elif abs(y) == magnitude:
        face, sc, tc = (2, x, z) if y >= 0 else (3, x, -z)
    else:
        face, sc, tc = (4, x, -y) if z >= 0 else (5, -x, -y)
    return face, np.array([(sc / magnitude + 1) / 2, (tc / magnitude + 1) / 2])


@pytest.mark.parametrize("target", [TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_CUBE_MAP])
@pytest.mark.parametrize(("x", "y"), [(10, 30), (25, 20), (14, 8)])
def test_coordinates_and_their_derivatives_equal_a_scalar_evaluation(target, x, y):
    p = projective_triangle()
    weights = weigh(mesh_of(p, LineState(), IDEAL), 0, *np.array([[0], [x], [y]], np.int32))
    got = place(target, weights, fixed(p.coordinates).reshape(3, 4))

    def at(dx, dy):
        where = x + 0.5 + dx, y + 0.5 + dy
        if target is TextureTarget.TEXTURE_2D:
            return scalar_project(p, *where)
        return scalar_cube(scalar_strq(p, *where)[:3])[1]

    np.testing.assert_allclose(got.position[0], at(0, 0), atol=NOISE)
    # Central differences: truncation h**2 and cancellation 1e-16 / h are both below 1e-9 at h = 1e-4.
    h = 1e-4
    np.testing.assert_allclose(got.dx[0], (at(h, 0) - at(-h, 0)) / (2 * h), atol=1e-8)
    np.testing.assert_allclose(got.dy[0], (at(0, h) - at(0, -h)) / (2 * h), atol=1e-8)


def test_a_direction_selects_the_face_and_place_of_the_cube_map_table():
    rng = np.random.default_rng(5)
    directions = np.concatenate([rng.normal(size=(60, 3)), np.eye(3), -np.eye(3), [[1, 1, 1], [-1, 1, 0.5]]])
    got = project_on_cube(directions, 0 * directions, 0 * directions)
    for k, direction in enumerate(directions):
        face, position = scalar_cube(direction)
        assert got.face[k] == face
        np.testing.assert_allclose(got.position[k], position, atol=NOISE)
    nothing = project_on_cube(np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, 3)))
    assert nothing.face[0] == 0 and (nothing.position == 0.0).all()  # the first texel of +x


def test_a_cube_map_of_directions_returns_the_direction():
    # On every face the texels hold the unnormalised direction through their centre, which is linear on the
    # face: a linear filter returns it exactly, up to half a texel from the face's edge.
    size = 4
    c = 2 * centres(size) - 1
    s, t = np.meshgrid(c, c)
    one = np.ones_like(s)
    faces = np.array(
        [
            np.stack(f, axis=-1)
            for f in ((one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t), (s, -t, one), (-s, -t, -one))
        ]
    )
    texture = texture_cube_map(faces * 0.5 + 0.5, InternalFormat.RGB8)
    rng = np.random.default_rng(7)
    directions = rng.uniform(-0.7, 0.7, (48, 3))
    directions[np.arange(48), np.arange(48) % 3] = np.where(np.arange(48) // 3 % 2, 1.0, -1.0)
    still = np.zeros_like(directions)
    where = project_on_cube(directions, still, still)
    got = sample(texture, TextureUnit("c", LINEAR), where)
    np.testing.assert_allclose(2 * got[:, :3] - 1, directions, atol=NOISE)


@pytest.mark.parametrize("q", [1, 2, 3, -2])  # undivided coordinates, and divided ones
@pytest.mark.parametrize("pixels", [8, 12])  # triangles whose areas are powers of two, and others
def test_exact_texel_boundaries_fall_where_the_machines_fall(pixels, q):
    # Two texels on a pixel: every sample lies exactly between two texels, in both triangles of the quad.
    rng = np.random.default_rng(1)
    texture = texture_2d(rng.integers(0, 256, (16, 16, 3)).astype(np.uint8), InternalFormat.RGB8)
    repeat = replace(NEAREST, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.REPEAT)
    state = PassState(texture_units=(TextureUnit("t", repeat),), register_combiners=TEXTURE0_ALONE)
    for mirrored in (UNIT_SQUARE[0], [[1, 0], [0, 0], [0, 1], [1, 1]], [[0, 1], [1, 1], [1, 0], [0, 0]]):
        coordinates = np.full((4, 4), float(q))
        coordinates[:, :2] = np.multiply(mirrored, q * pixels / 8)
        frame = (
            TexImage(label="t", texture="t", image=texture),
            Draw(label="d", mesh=quad(texture_coordinates=(coordinates,)), state=state),
        )
        machine = execute(frame, GEFORCE_256, pixels, pixels)
        ideal_image = execute_ideal(frame, pixels, pixels).image()
        np.testing.assert_array_equal(ideal_image, machine.framebuffer.image())


# -------------------------------------------------------------------------------- interpolation, depth


def test_colours_are_interpolated_without_rounding():
    colors = [[0, 0.1, 0.2, 1], [1, 0.1, 0.2, 0.5], [1, 0.9, 0.2, 0.25], [0, 0.9, 0.2, 0.75]]
    mesh = quad(colors=colors)
    color = execute_ideal((Draw(label="d", mesh=mesh, state=PassState()),), 8, 8).color[::-1]
    across, up = np.meshgrid(centres(8), centres(8))
    np.testing.assert_allclose(color[..., 0], across, atol=NOISE)
    np.testing.assert_allclose(color[..., 1], 0.1 + 0.8 * up, atol=NOISE)


def test_vertex_colours_may_exceed_one_until_the_end():
    # Two lights of 0.75 make 1.5; half of it is 0.75, where a machine's clamped colour gives 0.5.
    light = Light(diffuse=(0.75, 0.75, 0.75, 1.0))
    vertex = VertexState(lighting=replace(Lighting(), lights=(light, light), model_ambient=(0, 0, 0, 1)))
    material = replace(vertex.lighting.front, ambient=(0, 0, 0, 1), diffuse=(1, 1, 1, 1))
    vertex = replace(vertex, lighting=replace(vertex.lighting, front=material, back=material))
    combiners = RegisterCombiners(
        general=(GeneralCombiner(RGBPortion(b=CombinerInput(Register.CONSTANT_COLOR0))),),
        final=FinalCombiner(a=CombinerInput(), c=CombinerInput(), d=CombinerInput(Register.SPARE0)),
        constant_color0=(0.5, 0.5, 0.5, 0.5),
    )
    frame = (Draw(label="lit", mesh=quad(), state=PassState(vertex=vertex, register_combiners=combiners)),)
    assert execute_ideal(frame, 2, 2).color[0, 0, 0] == 0.75
    assert execute(frame, GEFORCE_256, 2, 2).framebuffer.color[0, 0, 0] == 128


def test_flat_shading_takes_the_provoking_vertex():
    mesh = Mesh(positions=[[-1, -1], [3, -1], [-1, 3]], colors=[[1, 0, 0], [0, 1, 0], [0, 0.3, 0.7]])
    state = PassState(polygon=PolygonState(shade_model=ShadeModel.FLAT))
    color = execute_ideal((Draw(label="flat", mesh=mesh, state=state),), 3, 3).color
    np.testing.assert_array_equal(color, np.broadcast_to([0, 0.3, 0.7, 1], (3, 3, 4)))


def test_culling_and_the_back_colour_follow_the_winding():
    front, back = Lighting().front, replace(Lighting().back, emission=(0.0, 0.625, 0.0, 1.0))
    front = replace(front, emission=(0.375, 0.0, 0.0, 1.0))
    vertex = VertexState(lighting=Lighting(front=front, back=back, model_ambient=(0, 0, 0, 1), two_side=True))
    clockwise = Mesh(positions=[[-1, -1], [-1, 3], [3, -1]])
    counter = Mesh(positions=[[-1, -1], [3, -1], [-1, 3]])
    for mesh, expected in ((counter, [0.375, 0, 0]), (clockwise, [0, 0.625, 0])):
        drawn = Draw(label="d", mesh=mesh, state=PassState(vertex=vertex))
        np.testing.assert_allclose(execute_ideal((drawn,), 2, 2).color[0, 0, :3], expected, atol=NOISE)
        culled = PassState(vertex=vertex, polygon=PolygonState(cull_face=Face.BACK))
        drawn = Draw(label="d", mesh=mesh, state=culled)
        assert execute_ideal((drawn,), 2, 2).color[0, 0, 3] == (1.0 if mesh is counter else 0.0)


def test_depth_is_the_plane_itself():
    mesh = Mesh(positions=[[-1, -1, -1], [1, -1, 1], [1, 1, 1], [-1, 1, -1]], primitive=PrimitiveType.QUADS)
    state = PassState(depth_test=DepthTest(ComparisonFunction.ALWAYS))
    frame = (
        Draw(label="plane", mesh=mesh, state=state),
        ReadPixels(label="z", name="z", format="DEPTH_COMPONENT"),
    )
    result = execute_ideal(frame, 8, 4)
    np.testing.assert_allclose(result.depth, np.broadcast_to(centres(8), (4, 8)), atol=NOISE)
    np.testing.assert_array_equal(result.pixels["z"], result.depth[::-1])


@pytest.mark.parametrize("depth_bits", [16, 24])
def test_polygon_offset_is_exact(depth_bits):
    # dz/dx = 1/8 per pixel, dz/dy = 0.
    mesh = Mesh(positions=[[-1, -1, -1], [1, -1, 1], [1, 1, 1], [-1, 1, -1]], primitive=PrimitiveType.QUADS)
    polygon = PolygonState(offset_fill=True, offset_factor=-0.25, offset_units=2.5)
    state = PassState(polygon=polygon, depth_test=DepthTest(ComparisonFunction.ALWAYS))
    depth = execute_ideal((Draw(label="d", mesh=mesh, state=state),), 8, 4, depth_bits=depth_bits).depth
    expected = np.maximum(centres(8) - 0.25 / 8 + 2.5 / (2**depth_bits - 1), 0.0)
    np.testing.assert_allclose(depth, np.broadcast_to(expected, (4, 8)), atol=NOISE)


# ------------------------------------------------------------------------------------------------- fog


@pytest.mark.parametrize(
    ("fog", "factor"),
    [
        (Fog(mode=FogMode.EXP, density=0.4), lambda c: math.exp(-0.4 * c)),
        (Fog(mode=FogMode.EXP2, density=0.4), lambda c: math.exp(-((0.4 * c) ** 2))),
        (Fog(mode=FogMode.LINEAR, start=1.0, end=3.0), lambda c: min(max((3.0 - c) / 2.0, 0.0), 1.0)),
        (Fog(mode=FogMode.LINEAR, start=3.0, end=1.0), lambda c: min(max((c - 1.0) / 2.0, 0.0), 1.0)),
        (Fog(mode=FogMode.LINEAR, start=2.2, end=2.2), lambda c: float(c <= 2.2)),
    ],
)
@pytest.mark.parametrize("combined", [False, True])
def test_fog_is_the_exact_function(fog, factor, combined):
    fog = replace(fog, color=(0.2, 0.4, 0.6, 0.0), coordinate_source=FogCoordinateSource.FOG_COORDINATE)
    mesh = quad(colors=[[1, 0.5, 0, 0.3]] * 4, fog_coordinates=[0, 4, 4, 0])
    state = PassState(fog=fog, register_combiners=RegisterCombiners() if combined else None)
    color = execute_ideal((Draw(label="fog", mesh=mesh, state=state),), 16, 1).color[0]
    f = np.array([factor(4 * c) for c in centres(16)])[:, None]
    np.testing.assert_allclose(color[:, :3], f * [1, 0.5, 0] + (1 - f) * [0.2, 0.4, 0.6], atol=NOISE)
    np.testing.assert_allclose(color[:, 3], 0.3, atol=NOISE)


@pytest.mark.parametrize("mode", list(FogMode))
def test_fog_differs_from_the_machines_by_its_quantisation(mode):
    # Machine: the factor is the nearest byte, and so is the result of the blend; the colours are bytes.
    bound = 0.5 + 0.5
    fog = Fog(mode, density=0.7, start=0.5, end=3.5, color=(51 / 255, 102 / 255, 1.0, 0.0))
    fog = replace(fog, coordinate_source=FogCoordinateSource.FOG_COORDINATE)
    mesh = quad(colors=[[1.0, 0.0, 0.0, 1.0]] * 4, fog_coordinates=[0, 4, 4, 0])
    frame = (Draw(label="fog", mesh=mesh, state=PassState(fog=fog)),)
    machine = execute(frame, GEFORCE_256, 64, 1, record=True)
    guided = execute_ideal(frame, 64, 1, guide=machine)
    difference = np.abs(255 * guided.color - machine.framebuffer.color)
    assert 0.1 < difference.max() <= bound


def test_the_color_sum_is_clamped_after_fog_only():
    mesh = quad(colors=[[0.75] * 4] * 4, secondary_colors=[[0.75, 0.5, 0.0]] * 4, fog_coordinates=[1.0] * 4)
    fog = Fog(mode=FogMode.LINEAR, end=2.0, coordinate_source=FogCoordinateSource.FOG_COORDINATE)
    frame = (Draw(label="d", mesh=mesh, state=PassState(color_sum=True, fog=fog)),)
    np.testing.assert_array_equal(execute_ideal(frame, 1, 1).color[0, 0], [0.75, 0.625, 0.375, 0.75])


# ----------------------------------------------------------------------------- per-fragment operations


def scalar_factor(factor, s, d, constant, channel):
    source, target, fixed = {
        "SRC": (s[channel], s[3], None),
        "DST": (d[channel], d[3], None),
        "CONSTANT": (constant[channel], constant[3], None),
    }.get(factor.name.removeprefix("ONE_MINUS_").split("_")[0], (None, None, True))
    if factor is BlendFactor.SRC_ALPHA_SATURATE:
        return 1.0 if channel == 3 else min(s[3], 1.0 - d[3])
    if fixed:
        return float(factor is BlendFactor.ONE)
    value = target if "ALPHA" in factor.name else source
    return 1.0 - value if factor.name.startswith("ONE_MINUS_") else value


@pytest.mark.parametrize("equation", sorted(IDEAL.fragments.blend_equations))
@pytest.mark.parametrize("source", list(BlendFactor))
def test_blending_equals_a_scalar_evaluation_and_does_not_clamp(equation, source):
    rng = np.random.default_rng(11)
    s, d = rng.random((5, 4)), rng.uniform(-0.5, 1.5, (5, 4))
    constant = (0.2, 0.4, 0.6, 0.8)
    for destination in BlendFactor:
        buffers = IdealBuffers(5, 1)
        buffers.color[0] = d
        state = PassState(blending=Blending(source, destination, equation, constant))
        write(state, buffers, np.arange(5), s, None)
        got = buffers.color[0]
        for k in range(5):
            for c in range(4):
                x = s[k, c] * scalar_factor(source, s[k], d[k], constant, c)
                y = d[k, c] * scalar_factor(destination, s[k], d[k], constant, c)
                expected = {
                    BlendEquation.FUNC_ADD: x + y,
                    BlendEquation.FUNC_SUBTRACT: x - y,
                    BlendEquation.FUNC_REVERSE_SUBTRACT: y - x,
                    BlendEquation.MIN: min(s[k, c], d[k, c]),
                    BlendEquation.MAX: max(s[k, c], d[k, c]),
                }[equation]
                assert got[k, c] == pytest.approx(expected, abs=NOISE)


def test_sums_beyond_one_survive_until_the_picture():
    add = PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE))
    halve = PassState(blending=Blending(BlendFactor.ZERO, BlendFactor.CONSTANT_COLOR, color=(0.5,) * 4))
    lights = tuple(Draw(label=f"light {i}", mesh=plain([0.6, 0.2, 0, 0.6]), state=add) for i in range(2))
    result = execute_ideal((*lights, Draw(label="halve", mesh=quad(), state=halve)), 1, 1)
    np.testing.assert_allclose(result.color[0, 0], [0.6, 0.2, 0.0, 0.6], atol=NOISE)
    bright = execute_ideal(lights, 1, 1)
    assert bright.color[0, 0, 0] == pytest.approx(1.2, abs=NOISE)
    np.testing.assert_array_equal(bright.image()[0, 0], [255, 102, 0, 255])


def test_overlapping_triangles_of_one_draw_are_blended_in_order():
    rng = np.random.default_rng(2)
    positions = rng.uniform(-1.2, 1.2, (30, 2))
    colors = rng.random((30, 4))
    state = PassState(blending=Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA))
    mesh = Mesh(positions=positions, colors=colors)
    together = execute_ideal((Draw(label="all", mesh=mesh, state=state),), 12, 9)
    one_by_one = tuple(
        Draw(label=f"{i}", mesh=Mesh(positions=positions[i : i + 3], colors=colors[i : i + 3]), state=state)
        for i in range(0, 30, 3)
    )
    np.testing.assert_array_equal(together.color, execute_ideal(one_by_one, 12, 9).color)
    reverse = execute_ideal(one_by_one[::-1], 12, 9)
    assert np.abs(together.color - reverse.color).max() > 0.1


def test_fragments_are_grouped_by_occurrence():
    groups = in_order(np.array([5, 2, 5, 5, 2, 9]))
    assert [g.tolist() for g in groups] == [[0, 1, 5], [2, 4], [3]]
    assert in_order(np.array([], np.int64)) == []


def test_the_free_mode_tests_alpha_on_the_reals():
    # alpha runs from 0 to 1 over 1000 pixels: 0.6 passes where the byte 153 would take in half a byte more.
    mesh = quad(colors=[[1, 1, 1, 0], [1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 0]])
    state = PassState(alpha_test=AlphaTest(ComparisonFunction.GEQUAL, 0.6))
    color = execute_ideal((Draw(label="ramp", mesh=mesh, state=state),), 1000, 1).color[0]
    np.testing.assert_array_equal(color[:, 0], centres(1000) >= 0.6)


@pytest.mark.parametrize("function", list(ComparisonFunction))
def test_depth_functions_compare_the_fragment_with_the_buffer(function):
    python = {
        "NEVER": lambda a, b: False,
        "LESS": lambda a, b: a < b,
        "EQUAL": lambda a, b: a == b,
        "LEQUAL": lambda a, b: a <= b,
        "GREATER": lambda a, b: a > b,
        "NOTEQUAL": lambda a, b: a != b,
        "GEQUAL": lambda a, b: a >= b,
        "ALWAYS": lambda a, b: True,
    }[function.name]
    for z, stored in ((0.25, 0.5), (0.5, 0.5), (0.5 + 2**-40, 0.5)):
        state = PassState(depth_test=DepthTest(function))
        draw = Draw(label="d", mesh=plain([1, 1, 1], 2 * z - 1), state=state)
        frame = (Clear(label="c", depth=stored), draw)
        result = execute_ideal(frame, 1, 1)
        assert result.color[0, 0, 0] == float(python(z, stored))
        assert result.depth[0, 0] == (z if python(z, stored) else stored)


@pytest.mark.parametrize("operation", list(StencilOperation))
@pytest.mark.parametrize("which", ["fail", "depth_fail", "depth_pass"])
def test_stencil_operations_are_the_integers_own(operation, which):
    for stored in (0, 5, 0xF0, 255):
        function = ComparisonFunction.NEVER if which == "fail" else ComparisonFunction.ALWAYS
        test = StencilTest(function, reference=0x3C, write_mask=0xFE, **{which: operation})
        depth = DepthTest(ComparisonFunction.NEVER if which == "depth_fail" else ComparisonFunction.ALWAYS)
        frame = (
            Clear(label="c", stencil=stored),
            Draw(label="d", mesh=quad(), state=PassState(stencil_test=test, depth_test=depth)),
        )
        new = {
            "KEEP": stored,
            "ZERO": 0,
            "REPLACE": 0x3C,
            "INCR": min(stored + 1, 255),
            "DECR": max(stored - 1, 0),
            "INVERT": stored ^ 255,
            "INCR_WRAP": (stored + 1) % 256,
            "DECR_WRAP": (stored - 1) % 256,
        }[operation.name]
        assert execute_ideal(frame, 1, 1).stencil[0, 0] == (stored & 1) | (new & 0xFE)


def test_the_stencil_function_compares_the_masked_reference_with_the_buffer():
    for stored, drawn in ((0x12, 1.0), (0x32, 1.0), (0x13, 0.0)):
        test = StencilTest(ComparisonFunction.EQUAL, reference=0x52, mask=0x0F)
        draw = Draw(label="d", mesh=plain([1, 1, 1]), state=PassState(stencil_test=test))
        assert execute_ideal((Clear(label="c", stencil=stored), draw), 1, 1).color[0, 0, 0] == drawn


@pytest.mark.parametrize("operation", list(LogicOperation))
def test_logic_operations_work_on_the_nearest_bytes(operation):
    s, d = 0b11001010, 0b10100110
    table = [bool(operation >> k & 1) for k in range(4)]
    expected = sum(
        1 << bit for bit in range(8) if table[(0 if s >> bit & 1 else 2) + (0 if d >> bit & 1 else 1)]
    )
    frame = (
        Clear(label="c", color=((d + 0.4) / 255, 0, 0, 1)),
        Draw(label="d", mesh=plain([(s - 0.4) / 255, 0, 0]), state=PassState(logic_op=operation)),
    )
    assert execute_ideal(frame, 1, 1).color[0, 0, 0] == expected / 255


def test_masks_and_scissors_limit_what_is_written():
    frame = (
        Clear(label="all", color=(0.1, 0.2, 0.3, 0.4), stencil=0xFF, depth=0.5),
        Clear(
            label="corner",
            color=(0.9, 0.9, 0.9, 0.9),
            stencil=0,
            scissor=Scissor(-3, 1, 4, 9),
            color_mask=ColorMask(red=False),
            stencil_write_mask=0x0F,
        ),
        Draw(
            label="dot",
            mesh=plain([0.7, 0.7, 0.7]),
            state=PassState(scissor=Scissor(2, 0, 1, 1), color_mask=ColorMask(blue=False, alpha=False)),
        ),
    )
    result = execute_ideal(frame, 3, 2)
    np.testing.assert_allclose(result.color[0, 0], [0.1, 0.9, 0.9, 0.9])
    np.testing.assert_allclose(result.color[1, 0], [0.1, 0.2, 0.3, 0.4])
    np.testing.assert_allclose(result.color[1, 2], [0.7, 0.7, 0.3, 0.4])
    np.testing.assert_array_equal(result.stencil, [[0xF0, 0xFF, 0xFF], [0xFF, 0xFF, 0xFF]])
    assert (result.depth == 0.5).all()


# ----------------------------------------------------------------------------------- copies, reading


def test_the_framebuffer_is_copied_into_textures_as_it_is():
    colors = [[0, 0, 0.125, 1], [1, 0, 0.125, 1], [1, 1, 0.125, 1], [0, 1, 0.125, 1]]
    frame = (
        Draw(label="ramp", mesh=quad(colors=colors), state=PassState()),
        CopyTexImage(label="copy", texture="t", internal_format=InternalFormat.LUMINANCE8_ALPHA8),
        CopyTexImage(label="copy", texture="u", x=2, y=1, width=4, height=2),
        Clear(label="bright", color=(1.5, 0.5, 0.25, -0.5)),
        CopyTexSubImage(label="patch", texture="u", x_offset=1, y_offset=0, width=2, height=1),
        ReadPixels(label="read", name="p", format="LUMINANCE_ALPHA", width=1, height=1),
        ReadPixels(label="read", name="q", format="GREEN", width=1, height=1),
        ReadPixels(label="read", name="rest", format="ALPHA", x=6, y=3),
    )
    result = execute_ideal(frame, 8, 4)
    copied = result.textures["t"].ideal[0][0]
    np.testing.assert_allclose(copied[..., 1], np.broadcast_to(centres(8), (4, 8)), atol=NOISE)
    patched = result.textures["u"].ideal[0][0]
    np.testing.assert_allclose(patched[1, :, 0], centres(8)[2:6], atol=NOISE)
    np.testing.assert_allclose(patched[1, :, 1], 2.5 / 4, atol=NOISE)
    np.testing.assert_array_equal(patched[0, 1:3], [[1.5, 0.5, 0.25, -0.5]] * 2)
    np.testing.assert_array_equal(result.textures["u"].levels[0][0, 0, 1], [255, 128, 64, 0])
    np.testing.assert_array_equal(result.pixels["p"], [[[2.25, -0.5]]])
    np.testing.assert_array_equal(result.pixels["q"], [[0.5]])
    np.testing.assert_array_equal(result.pixels["rest"], [[-0.5, -0.5]])


@pytest.mark.parametrize(("width", "height"), [(0, 0), (2, 0), (0, 1)])
def test_a_rectangle_of_no_pixels_replaces_none(width, height):
    given = TexImage(label="given", texture="u", image=texture_2d(np.full((2, 4, 4), 0.25)))
    patch = CopyTexSubImage(label="none", texture="u", x_offset=1, y_offset=0, width=width, height=height)
    result = execute_ideal((given, patch), 8, 4)
    assert (result.textures["u"].ideal[0] == 0.25).all() and (result.textures["u"].levels[0] == 64).all()


# --------------------------------------------------------------------------- beside the machine, guided


def shaded_frame(rng):
    """Interpolated colours in perspective: nothing but section 4 of docs/numbers.md."""
    positions = np.concatenate([rng.uniform(-1.5, 1.5, (12, 3)), rng.uniform(0.8, 3, (12, 1))], axis=1)
    positions[:, 2] *= 0.5
    mesh = Mesh(positions=positions, colors=rng.random((12, 4)))
    return (Draw(label="shaded", mesh=mesh, state=PassState()),)


@pytest.mark.parametrize("seed", range(4))
def test_interpolated_colours_differ_from_the_machines_by_its_quantisation(seed):
    # Machine: vertex colours to bytes (14 significant bits, 2**-13 of at most 1, then 1/2 byte), weights w0
    # and w2 floored to 1/256 with w1 taking the rest, so at most 2/256 of the largest colour difference (255
    # bytes) goes to the wrong vertex, and the result rounded (1/2 byte).
    bound = 0.5 + 255 * 2**-13 + 2 * 255 / 256 + 0.5
    frame = shaded_frame(np.random.default_rng(seed))
    machine = execute(frame, GEFORCE_256, 24, 20, record=True)
    guided = execute_ideal(frame, 24, 20, guide=machine)
    difference = np.abs(255 * guided.color - machine.framebuffer.color)
    assert difference.max() <= bound
    assert difference.max() > 0.5
    np.testing.assert_array_equal(guided.color, execute_ideal(frame, 24, 20).color)


def largest_difference(texture, sampler, coordinates, size):
    """Of a textured window's colours on the machine from the ideal's of the same fragments, in bytes."""
    state = PassState(texture_units=(TextureUnit("t", sampler),), register_combiners=TEXTURE0_ALONE)
    frame = (
        TexImage(label="t", texture="t", image=texture),
        Draw(label="d", mesh=quad(texture_coordinates=(coordinates,)), state=state),
    )
    machine = execute(frame, GEFORCE_256, size, size, record=True)
    guided = execute_ideal(frame, size, size, guide=machine)
    return np.abs(255 * guided.color - machine.framebuffer.color).max()


@pytest.mark.parametrize("wrap", list(WrapMode))
def test_filtered_textures_differ_from_the_machines_by_its_quantisation(wrap):
    # Machine: each fraction is floored to 1/256, which moves at most 255/256 byte from one texel to the
    # other, once across and once up; each of the two passes rounds by 1/2 byte.
    bound = 2 * (255 / 256 + 0.5)
    rng = np.random.default_rng(4)
    texture = texture_2d(rng.integers(0, 256, (8, 16, 4)).astype(np.uint8), InternalFormat.RGBA8)
    sampler = replace(LINEAR, wrap_s=wrap, wrap_t=wrap, border_color=(1.0, 0.0, 0.0, 1.0))
    coordinates = np.array([[-0.7, -0.6], [1.9, -0.2], [1.6, 1.3], [-0.3, 1.8]])
    assert largest_difference(texture, sampler, coordinates, 30) <= bound


def test_mipmaps_differ_from_the_machines_by_its_quantisation():
    # Machine: within a level as above; lambda floored to 1/256, which moves at most 255/256 byte from one
    # level to the other, and the result rounded by 1/2 byte. The mapping is affine: lambda is one number.
    bound = 2 * (255 / 256 + 0.5) + 255 / 256 + 0.5
    rng = np.random.default_rng(9)
    texture = texture_2d(
        rng.integers(0, 256, (32, 32, 4)).astype(np.uint8), InternalFormat.RGBA8, mipmaps=True
    )
    coordinates = np.array([[0.1, 0.0], [1.3, 0.9], [0.6, 2.2], [-0.6, 1.3]])
    sampler = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR)
    assert largest_difference(texture, sampler, coordinates, 20) <= bound


def bump_frame(normals, light, profile):
    """Diffuse bump mapping: max(0, n.l) with both vectors encoded for EXPAND_NORMAL."""
    size = len(normals)
    texture = texture_2d(vector_texels(normals, profile), InternalFormat.RGB8)
    combiners = RegisterCombiners(
        general=(
            GeneralCombiner(
                RGBPortion(
                    a=CombinerInput(Register.TEXTURE0, Mapping.EXPAND_NORMAL),
                    b=CombinerInput(Register.PRIMARY_COLOR, Mapping.EXPAND_NORMAL),
                    ab_dot_product=True,
                    ab_output=Register.SPARE0,
                    sum_output=Register.DISCARD,
                )
            ),
        ),
        final=FinalCombiner(a=CombinerInput(), c=CombinerInput(), d=CombinerInput(Register.SPARE0)),
    )
    mesh = quad(
        colors=vector_colors(np.tile(light, (4, 1)), profile),
        texture_coordinates=UNIT_SQUARE,
    )
    state = PassState(texture_units=(TextureUnit("normals", NEAREST),), register_combiners=combiners)
    return (
        TexImage(label=f"{size} normals", texture="normals", image=texture),
        Draw(label="diffuse", mesh=mesh, state=state),
    )


def test_a_guided_bump_map_is_the_dot_product_and_the_machine_is_near_it():
    # Machine: a decoded component is at most 1/255 from its vector's, so with two unit vectors, whose
    # components add up to at most sqrt(3), the dot product is at most (2 sqrt(3) + 3/255)/255 off; it is
    # rounded by 1/2 byte.
    bound = 2 * math.sqrt(3) + 3 / 255 + 0.5
    rng = np.random.default_rng(12)
    normals = rng.normal(size=(16, 16, 3)) + np.array([0, 0, 1])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    light = np.array([0.48, -0.6, 0.64])
    machine = execute(bump_frame(normals, light, GEFORCE_256), GEFORCE_256, 16, 16, record=True)
    guided = execute_ideal(bump_frame(normals, light, IDEAL), 16, 16, guide=machine)
    exact = np.maximum(0.0, normals @ light)[::-1]
    np.testing.assert_allclose(guided.color[..., 0], exact, atol=NOISE)
    difference = np.abs(255 * exact - machine.framebuffer.color[..., 0])
    assert difference.max() <= bound
    assert difference.max() > 0.5


def frame_of_close_decisions():
    """Nearly coplanar, nearly equal in alpha: the machine and the reals decide differently."""
    ramp = [[0.2, 0.9, 0.5, 0.3], [0.9, 0.4, 0.5, 0.7], [0.9, 0.4, 0.5, 0.7], [0.2, 0.9, 0.5, 0.3]]
    state = PassState(
        alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.5),
        depth_test=DepthTest(ComparisonFunction.LEQUAL),
        stencil_test=StencilTest(depth_pass=StencilOperation.INCR, depth_fail=StencilOperation.INVERT),
        blending=Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE),
    )
    return (
        Clear(label="clear", color=(0.1, 0.1, 0.1, 0.1), depth=0.5, stencil=0),
        Draw(label="behind", mesh=quad(1e-9, colors=ramp), state=state),
        Draw(label="before", mesh=quad(-0.1, colors=ramp), state=state),
        ReadPixels(label="depth", name="depth", format="DEPTH_COMPONENT"),
        ReadPixels(label="stencil", name="stencil", format="STENCIL_INDEX"),
    )


def test_the_guided_mode_writes_the_machines_fragments_and_no_others():
    frame = frame_of_close_decisions()
    machine = execute(frame, GEFORCE_256, 200, 2, record=True)
    guided, free = execute_ideal(frame, 200, 2, guide=machine), execute_ideal(frame, 200, 2)
    touched = machine.framebuffer.color[..., 2] != 26
    np.testing.assert_array_equal(guided.color[..., 2] != 0.1, touched)
    # The first quad lies 5e-10 behind 1/2, which 24 bits cannot tell: it is drawn on the machine alone.
    assert (guided.color[..., 2] > free.color[..., 2] + 0.1).any()
    np.testing.assert_array_equal(guided.stencil, machine.framebuffer.stencil)
    np.testing.assert_array_equal(guided.depth, machine.framebuffer.depth / (2**24 - 1))
    np.testing.assert_array_equal(guided.pixels["depth"], guided.depth[::-1])
    np.testing.assert_array_equal(guided.pixels["stencil"], guided.stencil[::-1])
    assert (free.stencil != guided.stencil).any()


def test_the_guided_mode_makes_no_test_of_its_own():
    # The reals lie behind by a tenth of a depth unit, or have an alpha one part in a million too small; 24
    # bits and a byte cannot tell, and the machine draws.
    z, stored = 8388607.1 / (2**24 - 1), 8388607.2 / (2**24 - 1)
    mesh = quad(2 * z - 1, colors=[[0.5, 0.5, 0.5, 0.6 - 1e-6]] * 4)
    for tests in (
        {"depth_test": DepthTest(ComparisonFunction.GEQUAL)},
        {"alpha_test": AlphaTest(ComparisonFunction.GEQUAL, 0.6)},
    ):
        frame = (
            Clear(label="c", depth=stored),
            Draw(label="d", mesh=mesh, state=PassState(**tests)),
        )
        machine = execute(frame, GEFORCE_256, 2, 2, record=True)
        assert (machine.framebuffer.color[..., 0] == 128).all()
        assert (execute_ideal(frame, 2, 2, guide=machine).color[..., 0] == 0.5).all()
        assert (execute_ideal(frame, 2, 2).color[..., 0] == 0.0).all()


def test_guided_and_free_agree_where_every_test_agrees():
    rng = np.random.default_rng(8)
    heights = np.repeat(np.linspace(-0.9, 0.9, 5), 3)
    positions = np.column_stack([rng.uniform(-1, 1, (15, 2)), heights])
    mesh = Mesh(positions=positions, colors=rng.random((15, 4)))
    state = PassState(depth_test=DepthTest(), blending=Blending(BlendFactor.ONE, BlendFactor.SRC_ALPHA))
    frame = (Clear(label="c", depth=1.0), Draw(label="d", mesh=mesh, state=state))
    machine = execute(frame, GEFORCE_256, 16, 16, record=True)
    guided, free = execute_ideal(frame, 16, 16, guide=machine), execute_ideal(frame, 16, 16)
    np.testing.assert_array_equal(guided.color, free.color)
    # Machine: the floor of the depth in 24 bits.
    assert np.abs(guided.depth - free.depth).max() <= 1 / (2**24 - 1)


def test_chunks_change_nothing(monkeypatch):
    frame = shaded_frame(np.random.default_rng(6))
    whole = execute_ideal(frame, 24, 20).color
    monkeypatch.setattr(evaluate, "_CHUNK", 7)
    np.testing.assert_array_equal(execute_ideal(frame, 24, 20).color, whole)


def test_a_viewport_moves_the_picture():
    vertex = VertexState(viewport=Viewport(1, 2, 2, 1))
    color = execute_ideal((Draw(label="d", mesh=quad(), state=PassState(vertex=vertex)),), 4, 4).color
    expected = np.zeros((4, 4))
    expected[1, 1:3] = 1.0
    np.testing.assert_array_equal(color[..., 3], expected)


# ---------------------------------------------------------------------------------------------- errors


def test_saturate_clamps_the_ideals_colours_in_its_scissor_box_and_changes_no_machine():
    light = Draw(
        label="half a colour",
        mesh=Mesh([[-1, -1], [3, -1], [-1, 3]], colors=[[0.75, 0.5, 0.25]] * 3),
        state=PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE)),
    )
    left = Saturate(label="at most one", scissor=Scissor(0, 0, 1, 1))
    frame = (Clear(label="black", color=(0.0, 0.0, 0.0, 0.0)), light, light, left)
    color = execute_ideal(frame, 2, 1).color[0, :, :3]
    assert color.tolist() == [[1.0, 1.0, 0.5], [1.5, 1.0, 0.5]]
    machine = execute(frame, GEFORCE_256, 2, 1, record=True)
    assert (machine.framebuffer.color == execute(frame[:-1], GEFORCE_256, 2, 1).framebuffer.color).all()
    assert execute_ideal(frame, 2, 1, guide=machine).color[0, 0, 0] == 1.0
    unclamped = GEFORCE_256.without_clamps(Clamp.BLENDING)
    wide = execute(frame, unclamped, 2, 1).framebuffer.color[0, :, 0]
    assert wide[0] == 255 < wide[1]


def test_a_guide_without_fragments_is_refused():
    frame = (Draw(label="d", mesh=quad(), state=PassState()),)
    with pytest.raises(ValueError, match=r"guide is of type tuple; give the Result"):
        execute_ideal(frame, 2, 2, guide=execute(frame, GEFORCE_256, 2, 2, record=True).records)
    with pytest.raises(ValueError, match=r"record=True"):
        execute_ideal(frame, 2, 2, guide=execute(frame, GEFORCE_256, 2, 2))


def test_a_guide_of_other_passes_or_another_size_is_refused():
    frame = (Draw(label="d", mesh=quad(), state=PassState()),)
    guide = execute(frame, GEFORCE_256, 2, 2, record=True)
    with pytest.raises(ValueError, match=r"drew 1 times and these commands draw 2 times"):
        execute_ideal(frame * 2, 2, 2, guide=guide)
    with pytest.raises(ValueError, match=r"2x2 pixels and this one 4x2"):
        execute_ideal(frame, 4, 2, guide=guide)
    half = (Draw(label="half", mesh=Mesh(positions=[[-1, -1], [1, -1], [1, 1]]), state=PassState()),)
    with pytest.raises(ValueError, match=r"half: the guide drew primitive 1, but this mesh gives 1 of them"):
        execute_ideal(half, 2, 2, guide=guide)


def test_what_no_machine_could_mean_is_refused():
    state = PassState(texture_units=(TextureUnit("missing"),), register_combiners=TEXTURE0_ALONE)
    with pytest.raises(ValueError, match="missing"):
        execute_ideal((Draw(label="d", mesh=quad(texture_coordinates=UNIT_SQUARE), state=state),), 2, 2)
