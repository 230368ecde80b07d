"""What Kautz and Seidel ask a future board for (2000, section 5.1): the stages' arithmetic against the
specification, frames against the ideal evaluation, and who refuses them.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import (
    CombinerFunction,
    ComponentUsage,
    Mapping,
    PrimitiveType,
    Register,
    TextureFilter,
    TextureShaderOperation,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_3
from fixedpipe.pipeline.state import (
    CombinerInput,
    CombinerLookup,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.raster.columns import future
from tests.reference import future as specified

ONES = (15, 255, 4095, 65535)
CORNERS = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])  # a triangle that covers the viewport
ONE = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
SHOW_SPARE0 = FinalCombiner(
    a=CombinerInput(),
    c=CombinerInput(Register.SPARE0),
    g=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.ALPHA),
)


@pytest.mark.parametrize("one", ONES)
def test_functions_round_to_nearest(one):
    random, largest = np.random.default_rng(one), 256 * (one + 1)
    n = np.concatenate([np.arange(200), *(random.integers(0, 2**b, 40) for b in range(1, 58))])
    assert future.square_root(n).tolist() == [specified.square_root(int(v)) for v in n]
    assert (future.square_root(-n) == 0).all()
    n = np.concatenate([np.zeros(9, int), *(random.integers(-(2**b), 2**b, 40) for b in range(1, 57))])
    d = random.permutation(n)
    found = future.divide(n, d, one, largest).tolist()
    assert found == [specified.divide(int(a), int(b), one, largest) for a, b in zip(n, d, strict=True)]
    n = np.append(random.integers(-12 * one**2, 6 * one**2, 400), [0, 50 * one**2, -50 * one**2])
    found = future.applied(CombinerFunction.EXPONENTIAL, n, 0 * n, one, largest).tolist()
    assert found == [specified.exponential(int(v), one, largest) for v in n]


def test_vectors_turn_along_arcs():
    random = np.random.default_rng(4)
    corners, w = random.normal(size=(300, 3, 3)), random.dirichlet([1, 1, 1], 300)
    found = future.spherical(w[:, 0], w[:, 2], corners)
    for k in range(300):
        expected = specified.spherical(w[k, 0], w[k, 2], corners[k].tolist())
        np.testing.assert_allclose(found[k], expected, atol=1e-10)


def program(rgb, **stage):
    general = (GeneralCombiner(rgb=rgb, **stage),)
    return PassState(register_combiners=RegisterCombiners(general=general, final=SHOW_SPARE0))


def pair(state, mesh, textures=(), size=12):
    """Colours of a frame on the future board and in the ideal evaluation, in ones."""
    images = [TexImage(label=name, texture=name, image=image) for name, image in textures]
    commands = [*images, Draw(label="draw", mesh=mesh, state=state)]
    result = execute(commands, FUTURE, size, size, record=True)
    ideal = execute_ideal(commands, size, size, guide=result)
    return result.framebuffer.color / 255, ideal.color


PRIMARY, SECONDARY = CombinerInput(Register.PRIMARY_COLOR), CombinerInput(Register.SECONDARY_COLOR)


@pytest.mark.parametrize(
    "rgb",
    [
        RGBPortion(a=PRIMARY, b=PRIMARY, c=SECONDARY, d=SECONDARY, function=CombinerFunction.SQUARE_ROOT),
        RGBPortion(a=PRIMARY, b=ONE, c=SECONDARY, d=ONE, function=CombinerFunction.DIVIDE),
        RGBPortion(
            a=CombinerInput(Register.PRIMARY_COLOR, Mapping.SIGNED_NEGATE),
            b=SECONDARY,
            ab_dot_product=True,
            function=CombinerFunction.EXPONENTIAL,
        ),
    ],
    ids=lambda rgb: rgb.function.name,
)
def test_a_stage_computes_its_function(rgb):
    colors = np.array([[0.1, 0.4, 0.8, 1.0], [0.9, 0.2, 0.1, 1.0], [0.5, 0.7, 0.3, 1.0]])
    mesh = Mesh(CORNERS, colors=colors, secondary_colors=1.0 - 0.9 * colors[:, [1, 2, 0, 3]])
    machine, ideal = pair(program(rgb), mesh)
    # Colours were iterated with 24-bit weights and rounded to 16 bits, the result to 8.
    np.testing.assert_allclose(machine, ideal, atol=0.6 / 255)
    word = {"SQUARE_ROOT": "sqrt(", "DIVIDE": " / ", "EXPONENTIAL": "exp("}[rgb.function.name]
    assert word in describe([Draw(label="d", mesh=mesh, state=program(rgb))])


CLAMPED = (WrapMode.CLAMP_TO_EDGE,) * 2
LINEAR = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR, *CLAMPED)


@pytest.mark.parametrize("before", [False, True])
def test_combiners_come_before_the_filter_where_that_is_asked(before):
    random = np.random.default_rng(1)
    images = [("a", texture_2d(random.integers(0, 256, (4, 4, 3)).astype(np.uint8))) for _ in range(1)]
    images += [("b", texture_2d(random.integers(0, 256, (4, 4, 3)).astype(np.uint8)))]
    rgb = RGBPortion(a=CombinerInput(Register.TEXTURE0), b=CombinerInput(Register.TEXTURE1))
    units = TextureUnit("a", LINEAR), TextureUnit("b", LINEAR)
    state = replace(program(rgb), texture_units=units, evaluate_before_filtering=before)
    mesh = Mesh(CORNERS, texture_coordinates=((CORNERS + 1.0) / 2.0,))
    machine, ideal = pair(state, mesh, images)
    np.testing.assert_allclose(machine, ideal, atol=3.0 / 255)  # texels of 8 bits, filtered with 8 bits
    other = pair(replace(state, evaluate_before_filtering=not before), mesh, images)[0]
    assert np.abs(machine - other).max() > 0.05


def test_the_rings_of_f004_2_go_where_evaluation_comes_first():
    figure, size = FIGURES["F004-2"], 96
    commands, apart = figure.commands(FUTURE, size, figure.methods[0]), []
    for before in (False, True):
        frame = [
            replace(c, state=replace(c.state, evaluate_before_filtering=True))
            if before and isinstance(c, Draw) and any(c.state.texture_units)
            else c
            for c in commands
        ]
        image = execute(frame, FUTURE, *figure.dimensions(size)).framebuffer.image()[..., :3] / 255
        apart.append(np.sqrt(np.mean((image[:, :size] - image[:, size:]) ** 2)))
    assert apart[1] < apart[0] / 4.0


def test_a_filter_of_one_texel_evaluates_the_same_before_and_after():
    image = texture_2d(np.random.default_rng(2).random((8, 8, 3)), mipmaps=True)
    sampler = Sampler(TextureFilter.NEAREST_MIPMAP_NEAREST, TextureFilter.NEAREST, *CLAMPED)
    rgb = RGBPortion(a=CombinerInput(Register.TEXTURE0), b=CombinerInput(Register.TEXTURE0))
    state = replace(program(rgb), texture_units=(TextureUnit("t", sampler),))
    mesh = Mesh(CORNERS, texture_coordinates=(CORNERS * 3.0,))
    commands = [TexImage(label="t", texture="t", image=image)]
    pictures = [
        execute(
            [*commands, Draw(label="d", mesh=mesh, state=replace(state, evaluate_before_filtering=before))],
            FUTURE,
            9,
            9,
        ).framebuffer.color
        for before in (False, True)
    ]
    assert np.array_equal(*pictures)


def test_filters_alone_are_the_same_before_and_after():
    """Without combiners that compute, filtering texels is filtering results: mipmaps and volumes too."""
    image = texture_2d(np.random.default_rng(3).random((8, 8, 4)), mipmaps=True)
    sampler = Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR)
    rgb = RGBPortion(a=CombinerInput(Register.TEXTURE0), b=ONE)
    state = replace(program(rgb), texture_units=(TextureUnit("t", sampler),))
    mesh = Mesh(CORNERS, texture_coordinates=(CORNERS * 2.0,))
    commands = [TexImage(label="t", texture="t", image=image)]
    profile = FUTURE.with_precision(combiner_bits=8)
    pictures = [
        execute(
            [*commands, Draw(label="d", mesh=mesh, state=replace(state, evaluate_before_filtering=before))],
            profile,
            16,
            16,
        ).framebuffer.color
        for before in (False, True)
    ]
    assert np.array_equal(*pictures)


def test_a_lookup_after_a_stage_reads_where_a_register_says():
    image = np.random.default_rng(5).random((8, 8, 3))
    look = CombinerLookup(unit=0, register=Register.SPARE0)
    first = GeneralCombiner(rgb=RGBPortion(a=PRIMARY, b=ONE), lookup=look)
    second = GeneralCombiner(rgb=RGBPortion(a=CombinerInput(Register.TEXTURE0), b=ONE))
    combiners = RegisterCombiners(general=(first, second), final=SHOW_SPARE0)
    unit = TextureUnit("t", Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST, *CLAMPED))
    state = PassState(register_combiners=combiners, texture_units=(unit,))
    mesh = Mesh(
        CORNERS,
        colors=np.tile([3.5 / 8, 6.5 / 8, 0.0, 1.0], (3, 1)),
        texture_coordinates=(np.zeros((3, 2)),),
    )
    machine, ideal = pair(state, mesh, [("t", texture_2d(image))], size=2)
    np.testing.assert_allclose(machine[0, 0, :3], image[6, 3], atol=0.6 / 255)
    np.testing.assert_allclose(ideal[0, 0, :3], image[6, 3])
    assert "tex0 = texture 0 at" in describe([Draw(label="d", mesh=mesh, state=state)])


def bent(delta):
    """A strip of two vectors that are ``delta`` apart, as coordinates of a cube map and as colours."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    angle = corners[:, 0] * delta / 2.0
    vectors = np.stack([np.sin(angle), np.zeros(4), np.cos(angle)], axis=1)
    colors = np.concatenate([(vectors + 1.0) / 2.0, np.ones((4, 1))], axis=1)
    return Mesh(corners, PrimitiveType.QUADS, colors=colors, texture_coordinates=(vectors,)), angle


@pytest.mark.parametrize("delta", [0.5, 1.0, 1.5])
def test_spherical_interpolation_turns_steadily_and_linear_lags_by_an_eighth_of_the_square(delta):
    mesh, _ = bent(delta)
    size = 64
    state = PassState(spherical_primary_color=True)
    machine, ideal = pair(state, mesh, size=size)
    np.testing.assert_allclose(machine, ideal, atol=0.6 / 255)
    steady = ((np.arange(size) + 0.5) / size - 0.5) * delta
    vector = 2.0 * ideal[size // 2, :, :3] - 1.0
    np.testing.assert_allclose(np.arctan2(vector[:, 0], vector[:, 2]), steady, atol=1e-9)
    _, straight = pair(replace(state, spherical_primary_color=False), mesh, size=size)
    vector = 2.0 * straight[size // 2, :, :3] - 1.0
    error = np.abs(np.arctan2(vector[:, 0], vector[:, 2]) - steady).max()
    # Catalogue P20 of the papers: a highlight is displaced by at most half of delta squared / 8.
    assert 0.0 < error <= 0.5 * delta**2 / 8.0


def test_spherical_coordinates_read_a_cube_map_where_the_arc_is():
    mesh, _ = bent(1.4)
    faces = np.random.default_rng(6).random((6, 16, 16, 3))
    unit = TextureUnit("t", LINEAR, spherical_coordinates=True)
    rgb = RGBPortion(a=CombinerInput(Register.TEXTURE0), b=ONE)
    state = replace(program(rgb), texture_units=(unit,))
    machine, ideal = pair(state, mesh, [("t", texture_cube_map(faces))], size=32)
    np.testing.assert_allclose(machine, ideal, atol=6.0 / 255)
    straight = replace(state, texture_units=(replace(unit, spherical_coordinates=False),))
    assert np.abs(pair(straight, mesh, [("t", texture_cube_map(faces))], size=32)[1] - ideal).max() > 0.05


SQUARE_ROOT = RGBPortion(a=PRIMARY, b=ONE, function=CombinerFunction.SQUARE_ROOT)


@pytest.mark.parametrize(
    ("state", "said"),
    [
        (program(SQUARE_ROOT), "no SQUARE_ROOT in general combiners"),
        (program(RGBPortion(), lookup=CombinerLookup(0)), "no texture lookup after a general combiner"),
        (PassState(evaluate_before_filtering=True), "evaluates combiners after its textures are filtered"),
        (PassState(spherical_secondary_color=True), "does not interpolate along arcs"),
    ],
)
def test_a_board_of_the_time_refuses(state, said):
    draw = Draw(label="d", mesh=Mesh(CORNERS), state=state)
    with pytest.raises(UnsupportedState, match=said):
        execute([draw], GEFORCE_3, 4, 4)


@pytest.mark.parametrize(
    ("state", "said"),
    [
        (program(replace(SQUARE_ROOT, mux_sum=True)), "leave mux_sum False"),
        (program(RGBPortion(), lookup=CombinerLookup(1)), "reads texture unit 1; enable"),
        (PassState(evaluate_before_filtering=True), "goes by texture unit 0, which is disabled"),
        (
            PassState(
                evaluate_before_filtering=True,
                texture_units=(TextureUnit("t"),),
                texture_shader=(TextureShaderStage(TextureShaderOperation.TEXTURE_2D),),
            ),
            "leave texture_shader None",
        ),
    ],
)
def test_what_no_board_could_mean_is_refused(state, said):
    image = TexImage(label="t", texture="t", image=texture_2d(np.zeros((1, 1, 3), np.uint8)))
    draw = Draw(label="d", mesh=Mesh(CORNERS, texture_coordinates=(CORNERS,)), state=state)
    with pytest.raises(UnsupportedState, match=said):
        execute([image, draw], FUTURE, 4, 4)
