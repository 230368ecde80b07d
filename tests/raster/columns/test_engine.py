"""The column engine: its arithmetic at every width against the specification, whole frames at other widths,
and clamps that are off. That its bits are the other engines' at 8 bits, the fuzz checks.
"""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from fixedpipe.effects.acceptance.precision import PARTS
from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.columns.combiners import arithmetic_of
from fixedpipe.pipeline.commands import Clear, CopyTexImage, Draw, MakeCurrent, Mesh, ReadPixels, TexImage
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    Clamp,
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    DotProductMapping,
    FogMode,
    InternalFormat,
    Mapping,
    MuxSelect,
    PixelTexGenQ,
    PrimitiveType,
    ProductRounding,
    Register,
    StencilOperation,
    TextureEnvironmentMode,
    TextureFilter,
    TextureShaderOperation,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, INFINITE_REALITY, OCTANE
from fixedpipe.pipeline.programs.fog import fog_thresholds
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    CombinerInput,
    DepthTest,
    FinalCombiner,
    Fog,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.pipeline.vertices import stage
from fixedpipe.raster.columns import (
    combine,
    future,
    interpolate,
    numbers,
    per_fragment,
    sample,
    texture_shader,
)
from fixedpipe.raster.pixels import rectangles
from tests.reference import combine as specified
from tests.reference import fixed, render, vertex
from tests.reference import interpolate as specified_interpolate
from tests.reference import per_fragment as specified_per_fragment
from tests.support.random_frames import _Maker, random_frame

BITS = (4, 5, 7, 8, 9, 12, 16)
CORNERS = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])  # a triangle that covers the viewport


def machines():
    """(profile, bits) of arithmetic that differs in everything that combiners ask of a profile."""
    random = np.random.default_rng(3)
    clamps = Clamp.MAPPING, Clamp.GENERAL_COMBINER, Clamp.COLOR_SUM, Clamp.FINAL_COMBINER
    for bits in BITS:
        for _ in range(6):
            profile = GEFORCE_256.changed(
                combiner_range=float(random.choice([1.0, 256.0])) if bits == 16 else 1.0,
                expand_half=random.choice([128, 127.5]),
                clamp_low=int(random.choice([-256, -255])),
                product_rounding=ProductRounding(int(random.integers(2))),
                round_before_scale=bool(random.integers(2)),
            )
            yield profile.without_clamps(*(clamp for clamp in clamps if random.random() < 0.5)), bits


@pytest.mark.parametrize(("profile", "bits"), list(machines()))
def test_combiners_are_the_specification_s(profile, bits):
    random, a = np.random.default_rng(5), arithmetic_of(profile, bits)
    machine = specified.machine_of(profile, bits)
    low, high = machine.limits
    x = np.concatenate([[0, 1, low, high, machine.one, machine.half], random.integers(low, high + 1, 300)])
    for mapping in Mapping:
        expected = [specified.map_input(int(v), mapping, machine) for v in x]
        assert combine.map_input(x, mapping, a).tolist() == expected, mapping
    for scale in CombinerScale:
        for bias in CombinerBias:
            products = [np.append(random.integers(low, high, 40), low) ** 2 for _ in range(3)]
            products = [p * s for p, s in zip(products, (1, -1, 1), strict=True)]
            expected = [
                specified.combiner_output([int(n) for n in each], scale, bias, machine)
                for each in zip(*products, strict=True)
            ]
            assert combine.output(products, scale, bool(bias), a).tolist() == expected, (scale, bias)
    for select in MuxSelect:
        expected = [specified.mux_takes_cd(int(v), select, machine) for v in x]
        assert combine.takes_cd(x, select == MuxSelect.LSB, a).tolist() == expected
    inputs = random.integers(-machine.one, 2 * machine.one, (4, 3, 50))
    color = combine.final_color(*inputs, inputs[0, :1], a)
    assert color[:3].tolist() == [
        [specified.final_blend(*(int(inputs[i, c, k]) for i in range(4)), machine) for k in range(50)]
        for c in range(3)
    ]


_COLUMN, _COLORS = np.zeros(1, np.int64), np.zeros((1, 4), np.int64)


@pytest.mark.parametrize(
    ("code", "calculate"),
    [
        (len(BlendEquation), lambda code: per_fragment.blend(code, (0, 0), _COLORS, _COLORS, _COLORS[0], 8)),
        (len(BlendFactor), lambda code: per_fragment.blend_factor(code, _COLORS, _COLORS, _COLORS[0], 255)),
        (len(StencilOperation), lambda code: per_fragment.stencil_result(code, _COLUMN, 0)),
        (len(Mapping), lambda code: combine.map_input(_COLUMN, code, arithmetic_of(GEFORCE_256, 8))),
        (CombinerFunction.NONE, lambda code: future.applied(code, _COLUMN, _COLUMN, 255, 255)),
        (5, lambda code: texture_shader.vector(_COLORS, code, 8)),
        (len(WrapMode), lambda code: sample.index_of(_COLUMN, code, 1, False)),
        (len(FogMode), lambda code: fog_thresholds(Fog(code))),
        (len(PixelTexGenQ), lambda code: rectangles.chosen_volumes(_COLUMN, 255, 1, code)),
    ],
)
def test_a_code_that_has_no_arithmetic_is_refused(code, calculate):
    with pytest.raises(ValueError, match=r" is no | chooses no "):
        calculate(code)


@pytest.mark.parametrize("bits", BITS)
def test_blending_filters_and_colours_are_the_specification_s(bits):
    random, one = np.random.default_rng(bits), 2**bits - 1
    s, d = random.integers(0, one + 1, (2, 60, 4))
    constant = random.integers(0, one + 1, 4)
    for equation in BlendEquation:
        factors = [BlendFactor(int(f)) for f in random.integers(0, len(BlendFactor), 2)]
        result = per_fragment.blend(equation, factors, s, d, constant, bits)
        for i, k in np.ndindex(60, 4):
            of = [
                specified_per_fragment.blend_factor(
                    f, k, s[i].tolist(), d[i].tolist(), constant.tolist(), one
                )
                for f in factors
            ]
            pair = int(s[i, k]), int(d[i, k])
            expected = specified_per_fragment.blend_component(equation, *pair, *of, one, clamped=False)
            assert result[i, k] == expected
    for factor in BlendFactor:
        factors = per_fragment.blend_factor(factor, s, d, constant, one)
        found = np.broadcast_to(factors, s.shape)
        given = s[0].tolist(), d[0].tolist(), constant.tolist()
        expected = [specified_per_fragment.blend_factor(factor, k, *given, one) for k in range(4)]
        assert found[0].tolist() == expected
    fraction = random.integers(0, 2**bits, 60)
    found = numbers.lerp(s[:, 0], d[:, 0], fraction, bits)
    assert found.tolist() == [
        fixed.lerp(int(p), int(q), int(f), bits) for p, q, f in zip(s[:, 0], d[:, 0], fraction, strict=True)
    ]
    for other in BITS:
        found = numbers.convert(s[:, 0], one, 2**other - 1).tolist()
        assert found == [fixed.converted(int(v), one, 2**other - 1) for v in s[:, 0]]
    q0, q2 = random.random((2, 60)) / 2
    corners = random.integers(0, one + 1, (60, 3, 1))
    found = interpolate.iterate_colors(q0, q2, corners, bits)[:, 0].tolist()
    weights = [SimpleNamespace(q0=a, q2=b) for a, b in zip(q0.tolist(), q2.tolist(), strict=True)]
    assert found == [
        specified_interpolate.iterate_color_channel(
            specified_interpolate.color_weights(w, bits), corners[k, :, 0].tolist(), bits
        )
        for k, w in enumerate(weights)
    ]


@pytest.mark.parametrize(("mode", "rising"), [(0, False), (0, True), (1, False), (2, False)])
def test_fog_counts_the_thresholds_that_are_kept(mode, rising):
    start, end = (2.0, 1.0) if rising else (1.0, 2.0)
    thresholds = fog_thresholds(Fog(mode, density=0.7, start=start, end=end), 15)
    coordinates = np.concatenate([thresholds, np.nextafter(thresholds, -9), np.linspace(0, 5, 40), [np.nan]])
    kept = [sum((c >= t) if rising else (c <= t) for t in thresholds) for c in coordinates]
    assert numbers.fog_factor(coordinates, thresholds, rising).tolist() == kept


# ------------------------------------------------------------------------------------------- whole frames


def random_pass(random, profile):
    """Commands of a few triangles in a random state that is specified at every width, and their texture."""
    maker = _Maker(int(random.integers(1 << 30)))
    maker.profile, maker.small, maker.plain = profile, True, False
    texture = texture_2d(random.random((4, 8, 4)))
    modes = [WrapMode(int(m)) for m in random.choice([WrapMode.REPEAT, WrapMode.CLAMP_TO_EDGE], 2)]
    texture_filter = TextureFilter(int(random.integers(2)))
    units = (TextureUnit("t", Sampler(texture_filter, texture_filter, *modes)),) * 2
    state = PassState(
        texture_units=units,
        register_combiners=maker.register_combiners(2),
        blending=maker.blending() if random.random() < 0.7 else None,
        depth_test=DepthTest(ComparisonFunction(int(random.integers(1, 8)))),
        alpha_test=AlphaTest(ComparisonFunction.GEQUAL, 0.2) if random.random() < 0.3 else None,
    )
    w = random.uniform(0.5, 2.0, (9, 1))
    positions = np.concatenate(
        [random.uniform(-1.2, 1.2, (9, 2)), random.uniform(-1, 1, (9, 1)), np.ones((9, 1))], 1
    )
    mesh = Mesh(
        positions * w,
        colors=random.random((9, 4)),
        secondary_colors=random.random((9, 4)),
        texture_coordinates=(random.uniform(-1, 2, (9, 2)),),
    )
    return [TexImage(label="t", texture="t", image=texture), Draw(label="draw", mesh=mesh, state=state)]


@pytest.mark.parametrize("seed", range(30))
def test_passes_at_other_widths_are_the_specification_s(seed):
    random = np.random.default_rng(seed)
    widths = {name: int(random.choice(BITS)) for name in PARTS}
    off = [clamp for clamp in Clamp if random.random() < 0.3 and clamp is not Clamp.VERTEX_COLOR]
    profile = GEFORCE_256.with_precision(**widths).without_clamps(*off)
    commands = random_pass(random, profile)
    machine = Machine(profile, 14, 10, 24)
    framebuffer = machine.run(commands).framebuffer
    primitives = stage.process(commands[1].mesh, commands[1].state, profile, 14, 10, rounded=False)
    bits, stored = widths["combiner_bits"], machine.textures["t"]
    codes = [[vertex.color_codes(c, False, profile, bits) for c in v] for v in primitives.colors.tolist()]
    target = render.Target(14, 10, 24)
    target.one = 2 ** widths["framebuffer_bits"] - 1
    target.clamped = Clamp.BLENDING in profile.arithmetic.clamps
    given = replace(primitives, colors=codes)
    render.draw(target, given, commands[1].state, {"t": stored}, profile, bits=bits)
    np.testing.assert_array_equal(framebuffer.depth, target.depth)
    np.testing.assert_array_equal(framebuffer.color, target.color)
    exact = np.array(commands[0].image.ideal[0]) * (2**stored.bits - 1)
    assert stored.bits == widths["texture_bits"]
    assert np.abs(stored.levels[0] - exact).max() <= 0.5 + 1e-9


def picture(figure, profile, size=24, **options):
    width, height = figure.dimensions(size)
    commands = figure.commands(profile, size)
    return commands, execute(commands, profile, width, height, record=True, **options)


def error(figure, profile):
    """RMS difference of a figure's pictures on a machine and on the ideal one, 1.0 = full."""
    commands, result = picture(figure, profile)
    ideal = execute_ideal(commands, *figure.dimensions(24), guide=result)
    one = 2**result.framebuffer.color_bits - 1
    return np.sqrt(np.mean((result.framebuffer.color / one - ideal.color) ** 2))


def at(bits, profile=GEFORCE_256):
    return profile.with_precision(
        combiner_bits=bits, texture_bits=bits, framebuffer_bits=bits, filter_fraction_bits=bits
    )


@pytest.mark.parametrize("profile", [GEFORCE_256, GEFORCE_3], ids=lambda p: p.name)
def test_eight_bits_asked_for_are_the_native_picture(profile):
    figure = FIGURES["F004-4"]
    asked = profile.with_precision(
        combiner_bits=8, texture_bits=8, framebuffer_bits=8, filter_fraction_bits=8, subpixel_bits=4
    )
    _, native = picture(figure, profile)
    _, columns = picture(figure, asked, engine="columns")
    for name in ("color", "depth", "stencil"):
        assert np.array_equal(getattr(native.framebuffer, name), getattr(columns.framebuffer, name))


def test_the_error_of_a_bump_mapping_pass_halves_with_every_bit():
    figure = FIGURES["F004-4"]
    unclamped = [at(bits).without_clamps(Clamp.BLENDING) for bits in (4, 6, 8)]
    errors = [error(figure, profile) for profile in unclamped]
    for coarse, fine in pairwise(errors):
        assert 2.8 < coarse / fine < 5.6  # two bits


def test_a_clamp_that_is_off_changes_only_where_it_acted():
    figure = FIGURES["F004-3"]
    _, clamped = picture(figure, GEFORCE_256)
    _, free = picture(figure, GEFORCE_256.without_clamps(Clamp.BLENDING))
    acted = free.framebuffer.color > 255
    assert acted.any()
    assert np.array_equal(clamped.framebuffer.color[~acted], free.framebuffer.color[~acted])
    assert (clamped.framebuffer.color[acted] == 255).all()


def test_other_subpixel_bits_move_edges_alone():
    mesh = Mesh(np.array([[-0.83, -0.71], [0.77, -0.4], [-0.21, 0.9]]), colors=np.ones((3, 4)))
    draw = Draw(label="triangle", mesh=mesh, state=PassState())
    native = execute([draw], GEFORCE_256, 40, 30).framebuffer.color
    for bits in (4, 5, 8, 16):
        profile = GEFORCE_256.with_precision(subpixel_bits=bits)
        color = execute([draw], profile, 40, 30, engine="columns").framebuffer.color
        differ = (color != native).any(-1)
        assert differ.sum() <= (0 if bits == 4 else 12)
        assert (color.reshape(-1, 4).max(-1) == 255).sum() > 200


def test_a_coarse_grid_is_covered_as_a_fine_one_that_it_lies_on():
    mesh = Mesh(np.array([[-0.5, -0.75], [0.75, -0.25], [-0.25, 0.5]]), colors=np.ones((3, 4)))
    draw = Draw(label="triangle", mesh=mesh, state=PassState())  # corners on whole pixels
    pictures = [
        execute([draw], GEFORCE_256.with_precision(subpixel_bits=bits), 16, 16, engine="columns")
        for bits in (4, 5, 11, 16)
    ]
    assert all(np.array_equal(p.framebuffer.color, pictures[0].framebuffer.color) for p in pictures)


def random_machine(seed):
    """A random frame, and its machine with random widths and without random clamps."""
    chooser, frame = np.random.default_rng(seed), random_frame(seed)
    widths = {name: int(chooser.choice(BITS)) for name in PARTS if chooser.random() < 0.7}
    off = [clamp for clamp in Clamp if chooser.random() < 0.2]
    stages = [s for c in frame.commands if isinstance(c, Draw) for s in c.state.texture_shader or ()]
    if any(s.dot_product_mapping >= DotProductMapping.UNSIGNED_HILO for s in stages):
        widths.pop("texture_bits", None)  # words of 16 bits are those of bytes
    return frame, frame.profile.with_precision(**widths).without_clamps(*off)


def drawn_in(frame, profile, runs, **options):
    """A framebuffer that several runs of one machine have drawn to."""
    machine = Machine(profile, frame.width, frame.height, frame.depth_bits)
    for commands in runs:
        machine.run(commands, **options)
    return machine.framebuffer


def assert_the_same_however_it_is_run(seed):
    frame, profile = random_machine(seed)
    whole = drawn_in(frame, profile, [frame.commands])
    others = [drawn_in(frame, profile, [frame.commands], record=True)]
    if not any(isinstance(command, MakeCurrent) for command in frame.commands):
        others.append(drawn_in(frame, profile, [(command,) for command in frame.commands]))
    for other in others:
        for name in ("color", "depth", "stencil"):
            assert np.array_equal(getattr(whole, name), getattr(other, name)), (seed, name)
    if Clamp.BLENDING in profile.arithmetic.clamps:
        assert whole.color.min() >= 0 and whole.color.max() < 1 << whole.color_bits


def test_frames_at_random_widths_are_the_same_however_they_are_run():
    for seed in range(60_000, 60_025):
        assert_the_same_however_it_is_run(seed)


@pytest.mark.slow
def test_hundreds_of_frames_at_random_widths_are_the_same_however_they_are_run():
    for seed in range(61_000, 61_400):
        assert_the_same_however_it_is_run(seed)


# ----------------------------------------------------------------------------------- clamps, one by one

_ONE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)


def drawn(state, profile, color=(0.25, 0.5, 0.75, 1.0), first=None, **mesh):
    """The colour of one pixel that a triangle covers, in ones."""
    array = np.tile(np.array(color, np.float64), (3, 1))
    arrays = {name: np.tile(np.array(v, np.float64), (3, 1)) for name, v in mesh.items()}
    draw = Draw(label="draw", mesh=Mesh(CORNERS, colors=array, **arrays), state=state)
    clear = Clear(label="clear", color=first or (0.0, 0.0, 0.0, 0.0))
    framebuffer = execute([clear, draw], profile, 2, 2).framebuffer
    return framebuffer.color[0, 0] / (2**framebuffer.color_bits - 1)


def close(found, expected):
    return np.allclose(found, expected, atol=2 / 255)


def combiners(rgb, final=None):
    final = final or FinalCombiner(
        a=CombinerInput(),
        c=CombinerInput(Register.SPARE0),
        g=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.ALPHA),
    )
    return PassState(register_combiners=RegisterCombiners(general=(GeneralCombiner(rgb=rgb),), final=final))


def without(*clamps):
    return GEFORCE_256.without_clamps(*clamps)


def test_vertex_colours_without_their_clamp():
    state = PassState()
    everything = without(Clamp.VERTEX_COLOR, Clamp.FINAL_COMBINER, Clamp.BLENDING)
    assert close(drawn(state, everything, color=(1.5, -0.25, 0.5, 1.0)), (1.5, -0.25, 0.5, 1.0))
    assert close(drawn(state, without(Clamp.VERTEX_COLOR), (1.5, -0.25, 0.5, 1.0)), (1.0, 0.0, 0.5, 1.0))


def test_mappings_without_their_clamp():
    negative = RGBPortion(  # -c, then read by UNSIGNED_IDENTITY
        a=CombinerInput(Register.PRIMARY_COLOR, Mapping.SIGNED_NEGATE), b=_ONE, sum_output=Register.SPARE0
    )
    state = combiners(negative)
    assert close(drawn(state, GEFORCE_256), (0.0, 0.0, 0.0, 1.0))
    free = without(Clamp.MAPPING, Clamp.FINAL_COMBINER, Clamp.BLENDING)
    assert close(drawn(state, free), (-0.25, -0.5, -0.75, 1.0))


def test_general_combiners_without_their_clamp():
    four = RGBPortion(a=CombinerInput(Register.PRIMARY_COLOR), b=_ONE, scale=CombinerScale.SCALE_BY_FOUR)
    free = without(Clamp.GENERAL_COMBINER, Clamp.FINAL_COMBINER, Clamp.BLENDING)
    assert close(drawn(combiners(four), free), (1.0, 2.0, 3.0, 1.0))
    assert close(drawn(combiners(four), GEFORCE_256), (1.0, 1.0, 1.0, 1.0))


def test_the_color_sum_without_its_clamp():
    state = PassState(color_sum=True)
    given = {"secondary_colors": (0.25, 0.75, 1.0, 0.0)}
    free = without(Clamp.COLOR_SUM, Clamp.FINAL_COMBINER, Clamp.BLENDING)
    assert close(drawn(state, free, **given), (0.5, 1.25, 1.75, 1.0))
    assert close(drawn(state, GEFORCE_256, **given), (0.5, 1.0, 1.0, 1.0))


def test_texture_environments_without_their_clamp():
    state = PassState(
        texture_units=(
            TextureUnit(
                "t",
                Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST),
                environment=TextureEnvironment(TextureEnvironmentMode.ADD),
            ),
        )
    )
    image = TexImage(label="t", texture="t", image=texture_2d(np.full((1, 1, 3), 0.75)))
    colors = np.tile([0.25, 0.5, 0.75, 1.0], (3, 1))
    mesh = Mesh(CORNERS, colors=colors, texture_coordinates=(CORNERS,))
    draw = Draw(label="d", mesh=mesh, state=state)
    pictures = [
        execute([image, draw], profile, 2, 2).framebuffer.color[0, 0] / 255
        for profile in (
            GEFORCE_256,
            without(Clamp.TEXTURE_ENVIRONMENT, Clamp.FINAL_COMBINER, Clamp.COLOR_SUM, Clamp.BLENDING),
        )
    ]
    assert close(pictures[0][:3], (1.0, 1.0, 1.0))
    assert close(pictures[1][:3], (1.0, 1.25, 1.5))


def test_blending_without_its_clamp():
    state = PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE))
    found = drawn(state, without(Clamp.BLENDING), first=(0.5, 0.75, 1.0, 1.0))
    assert close(found, (0.75, 1.25, 1.75, 2.0))
    minus = PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE, BlendEquation.FUNC_SUBTRACT))
    found = drawn(minus, without(Clamp.BLENDING), first=(0.5, 0.75, 1.0, 1.0))
    assert close(found, (-0.25, -0.25, -0.25, 0.0))


# ---------------------------------------------------------------------------------------- twelve bits


@pytest.mark.parametrize(("profile", "bits"), [(OCTANE, 12), (INFINITE_REALITY, None)])
def test_twelve_bit_texels_reach_a_twelve_bit_buffer_and_come_back(profile, bits):
    values = np.random.default_rng(2).random((8, 8, 4))
    texture = texture_2d(values, InternalFormat.RGBA12)
    exact = np.floor(values * 4095 + 0.5)
    unit = TextureUnit(
        "t",
        Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST),
        environment=TextureEnvironment(TextureEnvironmentMode.REPLACE),
    )
    mesh = Mesh(
        np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]),
        PrimitiveType.QUADS,
        texture_coordinates=(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),),
    )
    draw = Draw(label="show", mesh=mesh, state=PassState(texture_units=(unit,)))
    copy = CopyTexImage(label="copy", texture="c", internal_format=InternalFormat.RGBA12)
    again = replace(draw, state=replace(draw.state, texture_units=(replace(unit, texture="c"),)))
    clear = Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0))
    read = ReadPixels(label="read", name="bytes")
    frame = [TexImage(label="t", texture="t", image=texture), draw, copy, clear, again, read]
    result = execute(frame, profile, 8, 8, color_bits=bits)
    assert result.framebuffer.color_bits == 12 and result.textures["c"].bits == 12
    assert np.array_equal(result.framebuffer.color[::-1], exact)
    assert np.array_equal(result.pixels["bytes"], np.floor(exact / 4095 * 255 + 0.5))


def test_a_clear_has_the_buffer_s_width():
    machine = Machine(OCTANE, 4, 3, color_bits=12)
    machine.run([Clear(label="clear", color=(0.1, 0.5, 2.0, -1.0))])
    assert machine.framebuffer.color[0, 0].tolist() == [410, 2048, 4095, 0]
    assert machine.framebuffer.image()[0, 0].tolist() == [26, 128, 255, 0]
    (shown,) = machine.run([Clear(label="clear", color=(0.1, 0.5, 2.0, -1.0))], trace=True).trace
    assert shown.pictures()["color"][0, 0].tolist() == [26, 128, 255]


def test_a_width_that_the_machine_has_not_is_refused():
    with pytest.raises(ValueError, match="have 12 bits a component; GeForce 256 has 8"):
        Machine(GEFORCE_256, 4, 4, color_bits=12)


def test_texture_shaders_run_at_other_widths():
    """PASS_THROUGH gives bytes, which twelve bits hold exactly and a buffer of twelve shows."""
    stages = (TextureShaderStage(TextureShaderOperation.PASS_THROUGH),)
    rgb = RGBPortion(a=CombinerInput(Register.TEXTURE0), b=_ONE)
    state = replace(combiners(rgb), texture_units=(TextureUnit(None),), texture_shader=stages)
    coordinates = np.tile([0.25, 0.5, 0.75, 1.0], (3, 1))
    draw = Draw(label="d", mesh=Mesh(CORNERS, texture_coordinates=(coordinates,)), state=state)
    native = execute([draw], GEFORCE_3, 2, 2).framebuffer.color
    wide_profile = GEFORCE_3.with_precision(combiner_bits=12, framebuffer_bits=12)
    color = execute([draw], wide_profile, 2, 2).framebuffer.color
    assert np.array_equal(color, np.floor(native * (4095 / 255) + 0.5))


def test_lines_at_other_subpixel_bits_are_refused():
    draw = Draw(label="d", mesh=Mesh(CORNERS, PrimitiveType.LINES, indices=[0, 1]), state=PassState())
    with pytest.raises(UnsupportedState, match="subpixel bits"):
        execute([draw], GEFORCE_256.with_precision(subpixel_bits=8), 4, 4)
