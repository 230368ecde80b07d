"""Pixel shaders ps.1.0 to ps.1.3: what they compute on the combiners they become, and their errors."""

from dataclasses import fields, is_dataclass, replace

import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.enums import (
    CombinerScale,
    ComponentUsage,
    DotProductMapping,
    Mapping,
    Meaning,
    Register,
    TextureTarget,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Op
from fixedpipe.pipeline.framebuffers.framebuffer import color_codes
from fixedpipe.pipeline.notations.pixel_shader_format import format_pixel_shader
from fixedpipe.pipeline.notations.pixel_shader_textures import ConstantPlace
from fixedpipe.pipeline.notations.pixel_shader_translation import parse
from fixedpipe.pipeline.notations.pixel_shaders import ARITHMETIC, TEXTURE, PixelShaderTextError
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.notations.register_combiners import parse as parse_combiners
from fixedpipe.pipeline.profiles import GEFORCE_3, NV2A
from fixedpipe.pipeline.state import CombinerInput, TextureShaderStage
from fixedpipe.pipeline.validation.validate import validate_program
from tests.reference import pixel_shader
from tests.support.pixel_shaders import CHIP, TEXELS, check, fragments, on_combiners
from tests.support.program_strategies import pixel_shaders
from tests.support.text_errors import assert_says_where_and_what

HEAD = "ps.1.3\ndef c0, 0.25, 0.5, 0.75, 1\ndef c1, -0.25, -0.5, -1, 0.5\ntex t0\ntex t1\n"

# ------------------------------------------------------------------------------------------ what is computed

_OPERANDS = {1: "t0", 2: "t0, v0", 3: "t0, v0, t1"}


@pytest.mark.parametrize("sat", ["", "_sat"])
@pytest.mark.parametrize("scale", ["", "_x2", "_x4", "_d2"])
@pytest.mark.parametrize("name", [name for name in ARITHMETIC if name not in ("nop", "cnd", "cmp")])
def test_every_instruction_with_every_modifier(name, scale, sat):
    operands = _OPERANDS[ARITHMETIC[name][0]].replace("v0", "v0_bx2")
    check(HEAD + f"{name}{scale}{sat} r1, {operands}\nadd r0, r1, t1_bias\n")


_MAPPED = ("t0", "-t0", "1-t0", "t0_bx2", "-t0_bx2", "t0_bias", "-t0_bias", "1 - t0", "- t0")
_USES = ("mov r0, X", "mad_d2 r0, v0, X, v1", "sub_d2 r0, v0, X", "add_d2 r0, X, v0")


@pytest.mark.parametrize("selector", ["", ".a", ".w", ".rgb", ".xyzw"])
@pytest.mark.parametrize(
    ("mapped", "use"),
    # Minus one, by which a complement is subtracted, is -256/255 where one half is 128: a test of its own.
    [(m, use) for m in _MAPPED for use in _USES if not (m.startswith("1") and use.startswith("sub"))],
)
def test_every_source_modifier_and_selector(mapped, selector, use):
    check(HEAD + use.replace("X", mapped + selector) + "\n", 16)


def test_blue_for_alpha():
    check(HEAD + "mov r0.rgb, t0\n+ mad_x2 r0.a, t0.b, 1-t1.z, v0.b\n")


@pytest.mark.parametrize("constant", ["c0", "-c0", "c0_bx2", "1-c0", "c0.a", "c1", "-c1", "c1.a"])
def test_constants_of_either_sign(constant):
    check(HEAD + f"mad r0, t0, {constant}, c0\n")


@pytest.mark.parametrize("constant", ["c2", "-c2", "c2.a"])
def test_constants_of_both_signs_have_even_steps(constant):
    text = HEAD.replace("tex t0", "def c2, -0.3, 0.6, 1, -0.5\ntex t0")
    alpha = constant if constant.endswith("a") else f"{constant}.b"
    shader = check(text + f"mad r0.rgb, t0, {constant}, v0\n+ add r0.a, {alpha}, t0\n")
    stored = shader.combiners.general[0].constant_color0
    assert color_codes(stored) == [90, 205, 255, 128]


@pytest.mark.parametrize("constant", ["c2", "-c2"])
@pytest.mark.parametrize(
    "use",
    [
        "mov r0, X",
        "mov_x2_sat r0.rgb, X\n+ mov r0.a, t0",
        "mul r0, t0, X",
        "mul_d2 r0, X, 1-t0",
        "mul r0.rgb, X, c0.a\n+ mov r0.a, c1",
        "mov r0.a, c0\n+ mul r0.rgb, v0, X",
        "mul r0.a, X.b, t0\n+ mov r0.rgb, t1",
        "mov_sat r1, t0\nmul r0, -r1, X",
    ],
)
def test_a_color_of_both_signs_is_exact_where_two_constants_are_free(use, constant):
    text = HEAD.replace("tex t0", "def c2, 1, -0.5, -1, -0.5\ntex t0", 1)
    text += use.replace("X", constant) + "\n"
    shader = check(text)
    written = format_pixel_shader(parse_program(text))
    assert parse(written).combiners == shader.combiners
    assert shader.notes == () or not any("even steps" in note for note in shader.notes)
    stage = shader.combiners.general[-1]
    colors = {stage.constant_color0[:3], stage.constant_color1[:3]}
    assert colors == {(1.0, 0.0, 0.0), (0.0, 0.5, 1.0)}


@pytest.mark.parametrize("use", ["add r0, t0, X", "dp3 r0, t0, X", "mad r0, X, v0, t0", "mul r0, X, X"])
def test_a_color_of_both_signs_near_zero_is_exact_in_one_input(use):
    text = HEAD.replace("tex t0", "def c2, 0.498, -0.501, 0.2, -0.5\ntex t0", 1)
    for source in ("c2", "-c2"):
        shader = check(text + use.replace("X", source) + "\n")
        assert not any("even steps" in note for note in shader.notes)
        stored = shader.combiners.general[0].constant_color0
        assert [int(255 * value + 0.5) - 128 for value in stored[:3]] == [127, -128, 51]


def test_a_color_of_both_signs_that_has_even_steps_is_noted_with_how_far_it_is_off():
    lines = "mov r0, c2\nadd r0, r0, c2\nmul r0, r0, c3\n"
    notes = parse(f"ps.1.1\ndef c2, 1, -0.5, 0, 1\ndef c3, 0.5, -1, 0, 1\n{lines}").notes
    assert notes == (
        "line 5: c2's red, 1, is read as 254/255: red, green and blue of both signs have even steps in one "
        "input; mov the constant to a register first, which is exact.",
    )


def test_masks_and_pairs_read_before_they_write():
    check(
        HEAD + "mov r0, t0\nmov r1, v0\nmul r0.rgb, r0.a, r1\n+ add_d2 r0.a, r0.b, r1\nmad r0, r0, t1, r1\n"
    )


def test_a_pair_may_begin_with_alpha():
    check(HEAD + "mov r0, t0\nmul r0.a, r0, v0\n+ add_x2 r0.rgb, r0, -v0\n")


def test_saturated_results_are_read_saturated():
    check(HEAD + "sub_sat r1, t0, v0\nmad r0, -r1, t1, v1\nadd r1, r1_bx2, t0\nmad_sat r0, 1-r1, r0, -r1\n")


def test_the_alpha_of_a_dot_product_is_read_wherever_it_is():
    text = HEAD + "dp3_x2 r0, t0_bx2, v0_bx2\nmul r1, r0.a, t1\nmad r0.rgb, r0, t0, r1\n+ mov_sat r0.a, r0\n"
    check(text, profile=GEFORCE_3)


def test_the_alpha_of_a_dot_product_outlives_its_colors():
    text = HEAD + "dp3 r0, t0_bx2, v0_bx2\nmov r0.rgb, t1\nmul r0, r0, v1\n"
    shader = check(text, profile=GEFORCE_3)
    assert len(shader.combiners.general) == 3


def test_a_dot_product_is_compared_by_its_alpha():
    text = HEAD + "dp3_sat r0, t0_bx2, v0_bx2\ncnd r0, r0.a, t0, t1\n"
    shader = check(text, 200, profile=GEFORCE_3)
    assert len(shader.combiners.general) == 3


def test_where_a_ninth_combiner_would_be_needed_the_chip_copies_blue_to_alpha():
    text = HEAD + "mov r1, t0\n" * 6 + "dp3_sat r0, t0_bx2, v0_bx2\ncnd r0, r0.a, t0, t1\n"
    shader = check(text)
    assert len(shader.combiners.general) == 8
    assert shader.combiners.general[6].rgb.ab_blue_to_alpha
    validate_program(None, shader.combiners, GEFORCE_3)


COMPARED_BETWEEN = "dp3 r0, t0_bx2, v0_bx2\n{}cmp r1{}, v1_bias.a, t0, t1\nmov r0.rgb, t1\n{}mul r0, r0, v1\n"


def test_a_comparison_between_spoils_no_alpha_of_a_dot_product():
    """The comparison writes SPARE0's alpha, so the dot product's must not be brought there before it."""
    shader = check(HEAD + COMPARED_BETWEEN.format("mov r1.rgb, t1\n", ".rgb", "add r0.rgb, r0, r1\n"), 200)
    assert not any(stage.rgb.ab_blue_to_alpha for stage in shader.combiners.general)
    own = COMPARED_BETWEEN.format("mul r1, t0, t1\n" * 3, "", "").replace(
        "t1\nmul r0", "t1\n+mov r1.a, v1\nmul r0"
    )
    with pytest.raises(PixelShaderTextError, match="more than the 8 general combiners"):
        parse(HEAD + own)


def test_a_register_is_compared_whole_only_while_its_components_are_equal():
    whole = "dp3 r1, t0_bx2, v0_bx2\n{}cmp r0, r1, t0, t1\n"
    check(HEAD + whole.format(""))
    with pytest.raises(PixelShaderTextError, match="choose by one alpha"):
        parse(HEAD + whole.format("mov r1.rgb, t1\n"))


def test_cnd_takes_the_first_value_above_one_half():
    text = HEAD + "mov r0, t0\ncnd_d2 r0, r0.a, t1, v0\n"
    check(text)
    shader = parse(text)
    colors = [[255, 0, 0, 0], [0, 0, 255, 0]]
    for alpha, expected in ((127, [0, 0, 128, 0]), (128, [128, 0, 0, 0])):
        assert on_combiners(shader, ([0, 0, 0, alpha], colors[0]), colors[1], [0] * 4) == expected


def test_cmp_of_alpha_takes_the_first_value_from_zero_up():
    text = HEAD + "cmp r0, t0_bx2.a, t1, v0\n"
    check(text, 200)
    shader = parse(text)
    for alpha, expected in ((127, [3, 3, 3, 3]), (128, [7, 7, 7, 7])):
        assert on_combiners(shader, ([0, 0, 0, alpha], [7] * 4), [3] * 4, [0] * 4) == expected


def test_cmp_of_a_dot_product_and_of_alpha_alone():
    check(HEAD + "dp3 r1, t0_bx2, v0_bx2\ncmp r0, r1, t1, v0\n", 200)
    check(HEAD + "mov r1, t0\ncmp r0.a, r1_bx2, t1, v0\nmov r0.rgb, t1\n", 200)
    check(HEAD + "dp3 r0, t0_bx2, v0_bx2\ncmp r1, -r0, t1, v0\nmul r0, r0, r1\n", 200)


def test_colors_and_textures_can_be_written():
    check(HEAD + "mul v0, t0, v1\nmov t1, 1-v0\nadd_d2 r0, v0, t1\n")


@pytest.mark.parametrize("name", ["mov", "add", "mul", "mad", "lrp", "dp3"])
def test_definition_and_machine_differ_by_what_the_rounding_explains(name):
    """Real numbers: an input that is mapped is off by half a step, and the result by another half."""
    exact = pixel_shader.Arithmetic(half=127.5, rounded=False, lowest=-255)
    operands = _OPERANDS[ARITHMETIC[name][0]].replace("v0", "v0_bx2")
    text = HEAD + f"{name} r0, {operands}\n"
    shader, most = parse(text), 3 if name == "dp3" else 1
    for t0, t1, t2, t3, v0, v1 in fragments(60):
        expected = pixel_shader.evaluate(text, (t0, t1, t2, t3), v0, v1, exact)
        found = on_combiners(shader, (t0, t1, t2, t3), v0, v1)
        assert max(abs(e - f) for e, f in zip(expected, found, strict=True)) <= most + 0.5


REFUSALS = (
    "cannot negate",
    "more than the 8 general combiners",
    "cmp needs the alpha",
    "by the components",
    "constants are in",
)


FRAGMENTS = st.lists(st.tuples(TEXELS, TEXELS, TEXELS, TEXELS), min_size=2, max_size=2)


@settings(max_examples=120)
@given(pixel_shaders(), FRAGMENTS)
def test_random_programs_compute_what_their_text_says(text, seen):
    compare(text, seen)


@pytest.mark.slow
@settings(max_examples=2000)
@given(pixel_shaders(most=9), FRAGMENTS)
def test_many_random_programs_compute_what_their_text_says(text, seen):
    compare(text, seen)


def compare(text, seen):
    try:
        shader = parse(text)
    except PixelShaderTextError as error:
        if any(words in str(error) for words in REFUSALS):
            reject()
        raise
    validate_program(shader.texture_shader, shader.combiners, NV2A)
    if _minus_one_of_another_size(shader):
        reject()
    for t0, t1, v0, v1 in seen:
        expected = pixel_shader.evaluate(text, (t0, t1, [0] * 4, [0] * 4), v0, v1, CHIP)
        assert on_combiners(shader, (t0, t1), v0, v1) == expected, format_program(shader.combiners)


def _minus_one_of_another_size(shader):
    """Whether a product is negated by minus one, which is -256/255 where one half is 128."""
    portions = [p for stage in shader.combiners.general for p in (stage.rgb, stage.alpha)]
    inputs = [i for p in portions for i in (p.a, p.b, p.c, p.d)]
    return any(i.register is Register.ZERO and i.mapping is Mapping.EXPAND_NORMAL for i in inputs)


@settings(max_examples=60)
@given(pixel_shaders())
def test_what_a_program_becomes_can_be_written_as_combiners(text):
    try:
        shader = parse(text)
    except PixelShaderTextError:
        reject()
    if any(stage.rgb.ab_blue_to_alpha for stage in shader.combiners.general):
        reject()
    assert parse_combiners(format_program(shader.combiners)) == without_meanings(shader.combiners)


def without_meanings(combiners):
    """Combiners that mean nothing that no machine goes by, as a text of theirs."""
    if isinstance(combiners, CombinerInput):
        return replace(combiners, meaning=Meaning.PLAIN)
    if isinstance(combiners, tuple):
        return tuple(without_meanings(each) for each in combiners)
    if is_dataclass(combiners):
        return type(combiners)(
            **{f.name: without_meanings(getattr(combiners, f.name)) for f in fields(combiners)}
        )
    return combiners


def test_one_minus_a_value_is_subtracted_through_minus_one():
    """Where one half is 127.5, minus one is exact."""
    exact_half = NV2A.changed(expand_half=127.5, clamp_low=-255)
    check(
        HEAD + "sub r1, v0, 1-t0\nmad_sat r0, -r1, t1, v1\n",
        profile=exact_half,
        arithmetic=pixel_shader.Arithmetic(half=127.5, lowest=-255),
    )


# ------------------------------------------------------------------------------------------- translation


def stages(text, **given):
    return parse(text + "mov r0, v0\n", **given).texture_shader


EXPANDED = DotProductMapping.EXPAND_NORMAL


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("tex t0", (TextureShaderStage(Op.TEXTURE_2D),)),
        ("texcoord t0", (TextureShaderStage(Op.PASS_THROUGH),)),
        ("texkill t1", (TextureShaderStage(), TextureShaderStage(Op.CULL_FRAGMENT))),
        ("tex t0\ntexbem t1, t0", (Op.TEXTURE_2D, Op.OFFSET_TEXTURE_2D)),
        ("tex t0\ntexbeml t1, t0", (Op.TEXTURE_2D, Op.OFFSET_TEXTURE_2D_SCALE)),
        ("tex t0\ntexreg2ar t1, t0", (Op.TEXTURE_2D, Op.DEPENDENT_AR_TEXTURE_2D)),
        ("tex t0\ntexreg2gb t2, t0", (Op.TEXTURE_2D, Op.NONE, Op.DEPENDENT_GB_TEXTURE_2D)),
        (
            "tex t0\ntexm3x2pad t1, t0\ntexm3x2tex t2, t0",
            (Op.TEXTURE_2D, Op.DOT_PRODUCT, Op.DOT_PRODUCT_TEXTURE_2D),
        ),
        (
            "tex t0\ntexm3x2pad t1, t0\ntexm3x2depth t2, t0",
            (Op.TEXTURE_2D, Op.DOT_PRODUCT, Op.DOT_PRODUCT_DEPTH_REPLACE),
        ),
        (
            "tex t0\ntexm3x3pad t1, t0\ntexm3x3pad t2, t0\ntexm3x3tex t3, t0",
            (Op.TEXTURE_2D, Op.DOT_PRODUCT, Op.DOT_PRODUCT, Op.DOT_PRODUCT_TEXTURE_CUBE_MAP),
        ),
        (
            "tex t0\ntexm3x3pad t1, t0\ntexm3x3pad t2, t0\ntexm3x3vspec t3, t0",
            (Op.TEXTURE_2D, Op.DOT_PRODUCT, Op.DOT_PRODUCT, Op.DOT_PRODUCT_REFLECT_CUBE_MAP),
        ),
    ],
)
def test_every_texture_instruction_is_an_operation(lines, expected):
    expected = tuple(s if isinstance(s, TextureShaderStage) else TextureShaderStage(s) for s in expected)
    found = stages(f"ps.1.3\n{lines}\n")
    assert found == expected
    validate_program(found, None, GEFORCE_3)


def test_bx2_of_a_texture_instruction_is_the_dot_products_mapping_and_the_eye_a_constant():
    text = "ps.1.1\ndef c2, 0.5, -1, 2, 0\ntex t1\ntexm3x3pad t2, t1_bx2\ntexm3x3pad t3, t1_bx2\n"
    with pytest.raises(PixelShaderTextError, match="line 4, column 1: texm3x3pad t2 without"):
        parse(text + "mov r0, t1\n")
    text = text.replace("t1", "t0").replace("t2", "t1").replace("t3", "t2") + "texm3x3spec t3, t0_bx2, c2\n"
    shader = parse(text + "mul r0, t3, c2\n".replace("c2", "c3"), constants={3: (0.5, 0, 0, 1)})
    dots = {"previous_texture_input": 0, "dot_product_mapping": EXPANDED}
    assert shader.texture_shader == (
        TextureShaderStage(Op.TEXTURE_2D),
        TextureShaderStage(Op.DOT_PRODUCT, **dots),
        TextureShaderStage(Op.DOT_PRODUCT, **dots),
        TextureShaderStage(Op.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP, constant_eye=(0.5, -1.0, 2.0), **dots),
    )
    assert shader.constants == (ConstantPlace(2, 3, None), ConstantPlace(3, 0, Register.CONSTANT_COLOR0))
    assert shader.combiners.general[0].constant_color0 == (0.5, 0.0, 0.0, 1.0)


def test_bound_targets_choose_the_operation():
    text = "ps.1.1\ntex t0\ntexm3x3pad t1, t0\ntexm3x3pad t2, t0\ntexm3x3tex t3, t0\n"
    found = stages(text, targets={0: TextureTarget.TEXTURE_CUBE_MAP, 3: TextureTarget.TEXTURE_3D})
    assert [s.operation for s in found] == [
        Op.TEXTURE_CUBE_MAP,
        Op.DOT_PRODUCT,
        Op.DOT_PRODUCT,
        Op.DOT_PRODUCT_TEXTURE_3D,
    ]
    with pytest.raises(PixelShaderTextError, match="texbem of a TEXTURE_3D; it reads a TEXTURE_2D or"):
        parse("ps.1.1\ntex t0\ntexbem t1, t0\nmov r0, t1", targets={1: TextureTarget.TEXTURE_3D})


def test_without_texture_instructions_units_sample_what_is_bound():
    assert parse("ps.1.0\nmul r0, t0, t3\n").texture_shader is None


def test_the_same_constant_takes_one_place_and_the_stages_have_their_own():
    shader = parse("ps.1.1\ndef c5, 1, 0, 0, 1\ndef c7, 0, 1, 0, 1\nlrp r0, c5, c7, c5\nmul r0, r0, c7\n")
    first, second = shader.combiners.general
    assert (first.constant_color0, first.constant_color1) == ((1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0))
    assert (second.constant_color0, second.constant_color1) == ((0.0, 1.0, 0.0, 1.0), None)
    assert [place.constant for place in shader.constants] == [5, 7, 7]


def test_spelling():
    plain = parse("ps.1.1\ndef c0, 0.5, 1, 0, 0\ntex t0\nmad_x2_sat r0, 1-t0, c0, v0\n")
    for text in (
        "\n  Ps.1.1;\ndef c0, .5f, 1., 0e0, +0.0 // half\nTEX T0;\nMAD_X2_SAT R0.rgba, 1 - T0, C0, V0; done",
        "ps_1_1 def c0,0.5,1,0,0 tex t0 mad_sat_x2 r0.xyzw,1-t0.rgba,c0,v0.xyzw /* the\nend */",
    ):
        assert parse(text) == plain
    assert parse("ps.1.1\ntex t0\nnop\nmov r0, t0").combiners.general[0].rgb.scale is CombinerScale.NONE


def test_the_result_is_r0_with_fog():
    final = parse("ps.1.1\ntex t0\ndp3 r0, t0, t0").combiners.final
    assert (final.a.register, final.b.register, final.c.register) == (
        Register.FOG,
        Register.SPARE0,
        Register.FOG,
    )
    assert (final.g.register, final.g.usage) == (Register.SPARE0, ComponentUsage.BLUE)


@pytest.mark.parametrize(
    ("lines", "notes"),
    [
        ("mov r0, v0", []),
        ("mov r0, r1", ["line 2: r1's color", "line 2: r1's alpha"]),
        ("mov r0.rgb, v0\nmov r1, r0", ["line 3: r0's alpha", "line 3: r0's alpha"]),
        ("tex t0\ntexm3x2pad t1, t0\ntexm3x2depth t2, t0", ["line 4: r0's color", "line 4: r0's alpha"]),
    ],
)
def test_registers_begin_as_the_combiners_begin(lines, notes):
    """As nvparse took it; Direct3D refuses to read what nothing has written."""
    shader = parse(f"ps.1.3\n{lines}")
    validate_program(shader.texture_shader, shader.combiners, GEFORCE_3)
    assert len(shader.notes) == len(set(notes))
    assert all(any(note.startswith(start) for note in shader.notes) for start in notes)
    if "mov r1, r0" in lines:
        (note,) = shader.notes
        assert note.endswith("begins as texture 0's alpha.")
        assert on_combiners(shader, ([9, 8, 7, 6], [0] * 4), [1, 2, 3, 4], [0] * 4) == [1, 2, 3, 6]


# ------------------------------------------------------------------------------------------------ errors

ROWS = "tex t0\ntexm3x3pad t1, t0\ntexm3x3pad t2, t0\n"
ERRORS = [
    # text, line, column, words that the sentence must have
    ("", 1, 1, ["text ends", "ps.1.1"]),
    ("mov r0, t0", 1, 1, ["found 'mov'", "begin the program with ps.1.1"]),
    ("ps.1.4\nphase", 1, 1, ["ps.1.4", "ps.1.0, ps.1.1, ps.1.2 and ps.1.3"]),
    ("vs.1.1\nmov r0, v0", 1, 1, ["vs.1.1", "ps.1.3"]),
    ("xps.1.1\nmov r0, v0", 1, 1, ["xps.1.1"]),
    ("ps.1.1\ntexld r0, t0", 2, 1, ["texld belongs to ps.1.4"]),
    ("ps.1.1\nrcp r0, t0", 2, 1, ["found 'rcp'", "texm3x3vspec", "lrp"]),
    ("ps.1.1\nmov r0 t0", 2, 8, ["found 't0'", "','"]),
    ("ps.1.1\nmov r2, v0", 2, 5, ["found 'r2'", "destination of mov"]),
    ("ps.1.1\nmov c0, v0", 2, 5, ["found 'c0'", "destination of mov"]),
    ("ps.1.1\nmov r0.rg, v0", 2, 5, ["found 'r0.rg'", ".rgb or .a"]),
    ("ps.1.1\nmov r0, v2", 2, 9, ["found 'v2'", "v0 and v1"]),
    ("ps.1.1\nmov r0, 2-v0", 2, 9, ["found '2'", "one minus"]),
    ("ps.1.1\nmov r0, v0.g", 2, 9, ["found 'v0.g'", ".a or .b"]),
    ("ps.1.1\nmov r0, v0_x2", 2, 9, ["found 'v0_x2'", "_bias or _bx2"]),
    ("ps.1.1\nmov r0, 1-v0_bx2", 2, 11, ["complements and maps"]),
    ("ps.1.1\nmov_x8 r0, v0", 2, 1, ["found 'mov_x8'", "_x2, _x4 and _d2"]),
    ("ps.1.1\nmov_x2_x4 r0, v0", 2, 1, ["one of _x2"]),
    ("ps.1.1\ncmp r0, v0, v0, v1", 2, 1, ["cmp in ps.1.1", "ps.1.2"]),
    ("ps.1.2\ntexm3x2depth t1, t0", 2, 1, ["texm3x2depth in ps.1.2", "ps.1.3"]),
    ("ps.1.1\n#define X 1\nmov r0, X", 2, 1, ["preprocessor"]),
    ("ps.1.1\nmov r0, v0 ?", 2, 12, ["character '?'"]),
    ("ps.1.1\ndef c8, 0, 0, 0, 0", 2, 5, ["found 'c8'", "c0 to c7"]),
    ("ps.1.1\ndef c0, 0, 0, 0", 2, 16, ["text ends", "','"]),
    ("ps.1.1\ndef c0, x, 0, 0, 0", 2, 9, ["found 'x'", "number"]),
    ("ps.1.1\nmov r0, v0\ndef c0, 0, 0, 0, 0", 3, 1, ["def after an instruction"]),
    ("ps.1.1\nmov r0, v0\ntex t0", 3, 1, ["texture instructions come first"]),
    ("ps.1.1\n+ tex t0", 2, 1, ["only arithmetic instructions"]),
    ("ps.1.1\n+ mov r0, v0", 2, 3, ["nothing before it"]),
    ("ps.1.1\nmov r0.rgb, v0\n+mov r0.a, v0\n+mov r1.a, v0", 4, 2, ["a third"]),
    ("ps.1.1\nmov r0, v0\n+mov r1.a, v0", 3, 2, ["writes the alpha", ".rgb"]),
    ("ps.1.1\ntex r0", 2, 5, ["found 'r0'", "t0, t1, t2 or t3"]),
    ("ps.1.1\ntex_x2 t0", 2, 1, ["texture instructions have none"]),
    ("ps.1.1\ntex t0\ntex t0\nmov r0, t0", 3, 1, ["t0 a second time"]),
    ("ps.1.1\ntex t0\ntexbem t1, r0\nmov r0, t1", 3, 12, ["r0 as the source of texbem"]),
    ("ps.1.1\ntex t0\ntexbem t1, t0_bx2\nmov r0, t1", 3, 12, ["takes a register as it is"]),
    ("ps.1.1\ntexreg2ar t0, t1\nmov r0, t0", 2, 1, ["DEPENDENT_AR_TEXTURE_2D", "earlier stage"]),
    ("ps.1.1\ntex t0\ntexm3x2tex t1, t0\nmov r0, t1", 3, 1, ["without texm3x2pad"]),
    ("ps.1.1\ntex t0\ntexm3x3pad t1, t0\ntex t2\nmov r0, t2", 3, 1, ["texm3x3pad of t2"]),
    (f"ps.1.1\n{ROWS}texm3x3spec t3, t0, t0\nmov r0, t3", 5, 21, ["the eye of"]),
    ("ps.1.2\ntex t0\ntexdp3 t1, t0\nmov r0, t1", 3, 1, ["texdp3 is", "dp3"]),
    ("ps.1.2\ntex t0\ntexreg2rgb t1, t0\nmov r0, t1", 3, 1, ["texreg2rgb is", "GeForce 4 Ti"]),
    ("ps.1.1\ntex t0\nmov r0, t1", 3, 9, ["t1 is read", "tex t1"]),
    ("ps.1.1\ntexkill t0\nmov r0, t0", 3, 9, ["texkill gives no color"]),
    ("ps.1.1\nmov r0, v0.b", 2, 9, ["only alpha takes .b"]),
    ("ps.1.1\nmov r0, v0\ndp3 r0.a, v0, v1", 3, 1, ["dp3 of alpha alone"]),
    ("ps.1.1\nmov r0, v0\ncnd r0, r1.a, v0, v1", 3, 9, ["which is r0.a"]),
    ("ps.1.1\nlrp r0, v0_bx2, v0, v1", 2, 9, ["lrp by v0_bx2", "mov first"]),
    ("ps.1.2\ncmp r0, v0, v0, v1", 2, 9, ["by the components of v0", "Compare .a"]),
    ("ps.1.2\nmov r0, v0\ncmp r0.rgb, v0.a, r0.a, v1", 3, 1, ["still reads r0.a", "r1.a"]),
    ("ps.1.2\nmov r0, v0\ndp4 r0.rgb, v0, v1", 3, 1, ["dp4 writes a part"]),
    ("ps.1.2\ndp4 r0, v0, v1\n+mov r0.a, v0", 3, 2, ["dp4 with a '+'"]),
    ("ps.1.1\ndef c0, -1, 1, 0, 0\nmov r0, c0_bx2", 3, 9, ["c0 is (-1.0, 1.0", "with a modifier"]),
    ("ps.1.1\ndef c0, -1, -1, 0, 0\nmov r0, 1-c0", 3, 11, ["with a modifier"]),
    ("ps.1.1\nmad r0, c0, c1, c2", 2, 17, ["color of c2 is the third"]),
    ("ps.1.1\nmov_sat r0, v0\nmul r1, -r0, 1-v0\nmov r0, r1", 3, 1, ["cannot negate"]),
    ("ps.1.1\n" + "mov r0, v0\n" * 9, 10, 1, ["more than the 8 general combiners", "passes"]),
]


@pytest.mark.parametrize(("text", "line", "column", "words"), ERRORS, ids=[repr(e[0][-40:]) for e in ERRORS])
def test_an_error_says_where_and_what(text, line, column, words):
    assert_says_where_and_what(PixelShaderTextError, parse, text, line, column, words)


def test_every_instruction_of_the_tables_is_read():
    for name, (count, since) in {**ARITHMETIC, **TEXTURE}.items():
        sources = ", ".join(["t0"] * count)
        text = (
            f"ps.{since}\ntex t0\n{name}{' t1' if name in TEXTURE else ' r1'}{', ' if count else ''}{sources}"
        )
        try:
            parse(f"{text.replace('nop r1', 'nop')}\nmov r0, t0\n")
        except PixelShaderTextError as error:
            assert "found" not in str(error), error
