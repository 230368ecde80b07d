"""What if one thing were otherwise: errors that can be reckoned, and what is left of them."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.columns.replaced_stages import ReplacedStages
from fixedpipe.pipeline.commands import Clear, Draw, HostStep, Mesh, TexImage
from fixedpipe.pipeline.enums import CombinerFunction, CombinerScale, Mapping, Register, TextureFilter
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.inspection.what_if import (
    attribution,
    colors_with_stages,
    frame_error,
    stage_attribution,
    with_bits,
    with_constant,
    with_stages,
    with_texture,
    without_clamp,
)
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_256, NV2A, OCTANE
from fixedpipe.pipeline.state import (
    BlendFactor,
    Blending,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map
from tests.support.random_frames import random_frame

GREY = np.full((1, 1, 3), 0.5)
SQUARE = [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]


def combined(general, *, color=(0.0, 0.0, 0.0), constants=((0.0,) * 4, (0.0,) * 4), **state):
    """A square over the frame whose colour is what a general combiner leaves in SPARE0."""
    final = FinalCombiner(a=CombinerInput(Register.ZERO), d=CombinerInput(Register.SPARE0))
    program = RegisterCombiners(
        general=(GeneralCombiner(rgb=general),),
        final=final,
        constant_color0=constants[0],
        constant_color1=constants[1],
    )
    mesh = Mesh(SQUARE, colors=[color] * 6, texture_coordinates=(np.array(SQUARE) / 2 + 0.5,))
    return Draw(label="square", mesh=mesh, state=PassState(register_combiners=program, **state))


def rows(commands, profile=GEFORCE_256):
    own, found = attribution(lambda machine: commands, profile, 4, 4)
    return own, dict(found)


def test_a_single_rounding_is_the_combiners():
    """0.2 times 0.7, which are 51/255 and 178.5/255: the constant's byte, and the product's rounding."""
    product = RGBPortion(a=CombinerInput(Register.CONSTANT_COLOR0), b=CombinerInput(Register.CONSTANT_COLOR1))
    own, found = rows([combined(product, constants=((0.2,) * 4, (0.6,) * 4))])
    # 51 * 153 / 255 = 30.6, which is 31: of one rounding 0.4 of a 255th.
    assert own.shown == pytest.approx(0.4 / 255, rel=1e-12) and own.channels == (own.shown,) * 3
    assert own.largest == pytest.approx(own.shown)
    # Wider numbers alone change nothing: the framebuffer rounds to the same code. Both wider, and it goes.
    assert found["bits: combiner"].shown == found["bits: framebuffer"].shown == own.shown
    assert found["all bits"].shown < own.shown / 200
    for what, error in found.items():
        if what.startswith("clamp") or ("half" in what and "all" not in what):
            assert error == own


def test_a_single_clamp_is_that_clamps():
    """0.8 twice is 1.6, which blending clamps to 1; the ideal keeps 1.6, and both are seen as 1."""
    plain = RGBPortion(a=CombinerInput(Register.PRIMARY_COLOR))
    blending = Blending(BlendFactor.ONE, BlendFactor.ONE)
    draw = combined(plain, color=(0.8, 0.8, 0.8), blending=blending)
    own, found = rows([draw, draw])
    assert own.shown == 0.0
    assert own.computed == pytest.approx(0.6, rel=1e-12)
    assert found["clamp: BLENDING"].computed < 1e-12
    others = {what: error for what, error in found.items() if what != "clamp: BLENDING"}
    assert all(error.computed == pytest.approx(0.6, rel=1e-3) for error in others.values())


def test_a_single_constant_of_a_mapping_is_that_constants():
    """EXPAND_NORMAL of 200/255 is 144/255 here, and 145/255 where 1/2 is exact."""
    mapped = RGBPortion(a=CombinerInput(Register.PRIMARY_COLOR, mapping=Mapping.EXPAND_NORMAL))
    own, found = rows([combined(mapped, color=(200 / 255,) * 3)])
    assert own.shown == pytest.approx(1 / 255, rel=1e-9)
    assert found["half of EXPAND_NORMAL"].shown < 1e-12
    assert found["bits: texture"] == found["clamp: MAPPING"] == own


def test_a_single_filter_is_its_fractions():
    """A ramp of two texels, magnified from a place that eight bits do not hold."""
    ramp = texture_2d(np.array([[[0.0] * 3, [1.0] * 3]]))
    sampler = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR)
    plain = RGBPortion(a=CombinerInput(Register.TEXTURE0))
    unit = TextureUnit("ramp", sampler=sampler)
    commands = [TexImage(label="ramp", texture="ramp", image=ramp), combined(plain, texture_units=(unit,))]
    own, found = attribution(lambda machine: commands, GEFORCE_256, 7, 7)
    found, least = dict(found), min(error.shown for what, error in found if not what.startswith("all"))
    assert 0.0 < own.shown < 1 / 255
    assert found["all bits"].shown < own.shown / 50
    assert found["bits: filter_fraction"].shown <= own.shown
    assert least == min(found["bits: filter_fraction"].shown, found["bits: combiner"].shown)


def test_attribution_of_a_figure_ranks_what_the_inspector_found():
    """The brushed spheres' error is EXPAND_NORMAL's and the products' (docs/inspecting.md), no clamp's."""
    figure = FIGURES["F004-4"]
    size = figure.dimensions(48)
    own, found = attribution(lambda machine: figure.commands(machine, 48), GEFORCE_256, *size)
    assert [error.shown for _, error in found] == sorted(error.shown for _, error in found)
    single = [what for what, _ in found if not what.startswith("all")]
    assert set(single[:2]) == {"bits: combiner", "half of EXPAND_NORMAL"}
    assert dict(found)["all bits and the half"].shown < own.shown / 100


def test_a_width_that_a_machine_has_changes_nothing():
    figure = FIGURES["F004-4"]
    commands, size = figure.commands(OCTANE, 32), figure.dimensions(32)
    same = with_bits(OCTANE, "combiner", OCTANE.arithmetic.combiner_bits)
    assert frame_error(commands, OCTANE, *size) == frame_error(commands, same, *size)


def test_constants_and_textures_take_the_places_of_others():
    unit = TextureUnit("picture", sampler=Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST))
    plain = RGBPortion(a=CombinerInput(Register.TEXTURE0), b=CombinerInput(Register.CONSTANT_COLOR1))
    image = TexImage(label="picture", texture="picture", image=texture_2d(np.full((2, 2, 3), 255, np.uint8)))
    frame = (image, combined(plain, texture_units=(unit,)))
    changed = with_constant(frame, 1, (1.0, 0.5, 0.0, 1.0))
    changed = with_texture(changed, "picture", np.full((4, 4, 3), 51, np.uint8))
    assert changed[0].image.levels[0].shape[1:3] == (4, 4) and len(changed[0].image.levels) == 1
    assert changed[1].state.register_combiners.constant_color1[1] == 0.5
    assert frame[0] is image and frame[1].state.register_combiners.constant_color1[1] == 0.0
    assert changed[1].state.register_combiners.general == frame[1].state.register_combiners.general


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            lambda: with_bits(GEFORCE_256, "fog", 12),
            "no part 'fog' with a width; there are: combiner, ",
        ),
        (lambda: with_bits(GEFORCE_256, "combiner", 20), "combiner_bits is 20; .* 4 to 16 bits"),
        (
            lambda: without_clamp(GEFORCE_256, "FOG"),
            "no clamp 'FOG' to leave out; it has: VERTEX_COLOR, ",
        ),
        (lambda: with_constant((), 2, (0.0,) * 4), "There is no constant colour 2"),
        (lambda: with_constant((), 0, (0.0,) * 4), "No Draw of this frame has register combiners"),
        (
            lambda: with_texture((), "a", texture_2d(np.zeros((1, 1, 3)))),
            "No TexImage .* 'a'; there are: none",
        ),
        (
            lambda: with_texture(
                [TexImage(label="a", texture="a", image=texture_cube_map(np.zeros((6, 1, 1, 3))))],
                "a",
                GREY,
            ),
            "a is a TEXTURE_CUBE_MAP; only a TEXTURE_2D",
        ),
    ],
)
def test_what_cannot_be_changed_is_said(change, sentence):
    with pytest.raises(ValueError, match=sentence):
        change()


# ------------------------------------------------------------------------------------- one stage otherwise


def of_stages(commands, profile=GEFORCE_256, size=4, **given):
    own, found = stage_attribution(commands, profile, size, size, **given)
    assert [error.shown for _, error in found] == sorted(error.shown for _, error in found)
    return own, dict(found)


def two_stages(first, second, constants):
    """A square whose colour is what a second general combiner makes of the first one's SPARE0."""
    draw = combined(first, constants=constants)
    program = draw.state.register_combiners
    program = replace(program, general=(*program.general, GeneralCombiner(rgb=second)))
    return replace(draw, state=replace(draw.state, register_combiners=program))


SPARE0, ONE = CombinerInput(Register.SPARE0), CombinerInput(Register.ZERO, mapping=Mapping.UNSIGNED_INVERT)
TWICE = RGBPortion(a=SPARE0, b=ONE, c=SPARE0, d=ONE)


def test_a_rounding_goes_where_its_stage_is_exact():
    """51 times 153 is 30.6/255; rounded to 31 and doubled 62, doubled before it is rounded 61 of 61.2."""
    product = RGBPortion(a=CombinerInput(Register.CONSTANT_COLOR0), b=CombinerInput(Register.CONSTANT_COLOR1))
    draw = two_stages(product, TWICE, ((0.2,) * 4, (0.6,) * 4))
    own, found = of_stages([draw])
    assert own == frame_error([draw], GEFORCE_256, 4, 4)
    assert own.shown == pytest.approx(0.8 / 255, rel=1e-9)
    assert found["general combiner 0"].shown == pytest.approx(0.2 / 255, rel=1e-9)
    rest = {
        what: error
        for what, error in found.items()
        if what not in ("general combiner 0", "all of these stages")
    }
    assert all(error == own for error in rest.values()) and "clamp of general combiner 1" in rest
    assert (
        with_stages([draw], GEFORCE_256, 4, 4, exact=("general combiner 0",)) == found["general combiner 0"]
    )
    drawn, meant = colors_with_stages([draw], GEFORCE_256, 4, 4, exact=("general combiner 0",))
    np.testing.assert_array_equal(drawn, np.full((4, 4, 3), 61 / 255))
    np.testing.assert_allclose(meant, 0.24, rtol=1e-12)
    # Of a command that another one covers, nothing.
    again = replace(draw, label="again")
    assert of_stages([draw, again], number=0)[1]["general combiner 0"] == own
    assert of_stages([draw, again], number=1)[1]["general combiner 0"].shown < own.shown / 3
    assert of_stages([draw, draw], number=0)[1]["general combiner 0"] == own
    # Commands that a HostStep issues have numbers as well.
    step = HostStep(label="step", reads=(), commands=lambda pixels: (draw,))
    assert of_stages(iter([step]), number=1)[1]["general combiner 0"].shown < own.shown / 3


def test_a_clamp_goes_where_its_stage_has_none():
    """0.8 and 0.8 are 1.6, clamped to 1; the half of it is 0.5 and not 0.8."""
    both = RGBPortion(
        a=CombinerInput(Register.CONSTANT_COLOR0), b=ONE, c=CombinerInput(Register.CONSTANT_COLOR0), d=ONE
    )
    half = RGBPortion(a=SPARE0, b=ONE, scale=CombinerScale.SCALE_BY_ONE_HALF)
    draw = two_stages(both, half, ((0.8,) * 4, (0.0,) * 4))
    own, found = of_stages([draw])
    assert own.shown == pytest.approx(76 / 255, rel=1e-9)
    least = min(found, key=lambda what: found[what].shown)
    assert least == "clamp of general combiner 0" and found[least].shown == pytest.approx(0.0, abs=1e-12)
    assert found["general combiner 0"].shown > 75 / 255
    assert with_stages([draw], GEFORCE_256, 4, 4, unclamped=("general combiner 0",)) == found[least]


def test_a_clamp_at_the_lower_end_goes_as_well():
    """Minus 204 and minus 204, clamped to minus 256: times 128/255, beside 255, that is 126.498, to nearest
    126; minus 408 halved beside 255 is 51.
    """
    minus = CombinerInput(Register.CONSTANT_COLOR0, mapping=Mapping.SIGNED_NEGATE)
    second = RGBPortion(a=SIGNED_SPARE0, b=CombinerInput(Register.CONSTANT_COLOR1), c=ONE, d=ONE)
    draw = two_stages(RGBPortion(a=minus, b=ONE, c=minus, d=ONE), second, ((0.8,) * 4, (0.5,) * 4))
    own, found = of_stages([draw])
    assert own.shown == pytest.approx(75 / 255, rel=1e-9)
    assert found["clamp of general combiner 0"].shown < 1 / 255


SIGNED_SPARE0 = CombinerInput(Register.SPARE0, mapping=Mapping.SIGNED_IDENTITY)


def test_a_filter_and_a_half_are_their_stages():
    ramp = texture_2d(np.array([[[0.0] * 3, [1.0] * 3]]))
    sampler = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR)
    doubled = RGBPortion(a=CombinerInput(Register.TEXTURE0), b=ONE, c=CombinerInput(Register.TEXTURE0), d=ONE)
    unit = TextureUnit("ramp", sampler=sampler)
    commands = [TexImage(label="ramp", texture="ramp", image=ramp), combined(doubled, texture_units=(unit,))]
    own, found = of_stages(commands, size=7)
    assert found["texture unit 0"].shown < 0.7 * own.shown
    mapped = RGBPortion(a=CombinerInput(Register.PRIMARY_COLOR, mapping=Mapping.EXPAND_NORMAL))
    own, found = of_stages([combined(mapped, color=(200 / 255,) * 3)])
    assert own.shown == pytest.approx(1 / 255, rel=1e-9) and found["general combiner 0"].shown < 1e-12


def test_an_exact_filter_is_rounded_before_a_conversion():
    ycbcr = texture_2d(np.full((2, 2, 3), (150, 90, 200), np.uint8))
    unit = TextureUnit("ycbcr", sampler=Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR))
    shown = RGBPortion(a=CombinerInput(Register.TEXTURE0), b=ONE)
    square = combined(shown, texture_units=(unit,), ycbcr_conversion=True)
    commands = [TexImage(label="ycbcr", texture="ycbcr", image=ycbcr), square]
    exact = ReplacedStages(exact=frozenset({"texture unit 0"}))
    own, same = (
        Machine(NV2A, 3, 3, engine="columns", replaced_stages=replaced).run(commands).framebuffer.color
        for replaced in (None, lambda draw: exact)
    )
    assert (own == same).all()
    assert own[1, 1, :3].tolist() == [255, 114, 78]  # N7.3, by hand


def test_a_machine_of_sixteen_bits_has_exact_stages_too():
    """0.09 is 5898 of 65535, whose root is 19660, and twice that 39320; twice the root of 0.09 is 39321."""
    constant = CombinerInput(Register.CONSTANT_COLOR0)
    root = RGBPortion(a=constant, b=ONE, function=CombinerFunction.SQUARE_ROOT)
    draw, wide = (
        two_stages(root, TWICE, ((0.09,) * 4, (0.0,) * 4)),
        FUTURE.with_precision(framebuffer_bits=16),
    )
    own, _ = of_stages([draw], wide)
    assert own.shown == pytest.approx(1 / 65535, rel=1e-9)
    both = with_stages([draw], wide, 4, 4, exact=("constant colors", "general combiner 0"))
    assert both.shown == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("wide", [False, True])
def test_where_no_stage_is_named_the_bits_are_the_machines(wide):
    for seed in range(30):
        frame = random_frame(seed, wide=wide)
        given = frame.profile, frame.width, frame.height, frame.depth_bits
        own, same = (
            Machine(*given, engine="columns", replaced_stages=replaced).run(frame.commands).framebuffer
            for replaced in (None, lambda draw: ReplacedStages())
        )
        assert (own.color == same.color).all() and (own.depth == same.depth).all()


def test_what_cannot_be_computed_otherwise_is_said():
    draw = combined(RGBPortion(a=CombinerInput(Register.PRIMARY_COLOR)))
    with pytest.raises(ValueError, match="has a stage 'general combiner 3'"):
        with_stages([draw], GEFORCE_256, 4, 4, exact=("general combiner 3",))
    with pytest.raises(ValueError, match="There is no command 4; the commands' numbers are 0 to 0"):
        stage_attribution([draw], GEFORCE_256, 4, 4, number=4)
    with pytest.raises(ValueError, match="Command 0 is no Draw that makes fragments"):
        stage_attribution([Clear(label="c"), draw], GEFORCE_256, 4, 4, number=0)
    with pytest.raises(ValueError, match="primary color has no clamp of its own"):
        with_stages([draw], GEFORCE_256, 4, 4, unclamped=("primary color",))
    stored = TexImage(label="t", texture="t", image=texture_2d(np.full((2, 2, 3), 0.5)))
    unit = TextureUnit("t", sampler=Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR))
    textured = combined(RGBPortion(a=CombinerInput(Register.TEXTURE0)), texture_units=(unit,))
    for asked in ("evaluate_before_filtering", "spherical_primary_color"):
        state = replace(textured.state, **{asked: True})
        with pytest.raises(ValueError, match="No stage can be changed in a pass that"):
            stage_attribution([stored, replace(textured, state=state)], FUTURE, 4, 4)
    with pytest.raises(ValueError, match="Only the column engine"):
        Machine(GEFORCE_256, 4, 4, replaced_stages=lambda draw: None)
