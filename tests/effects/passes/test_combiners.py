"""The words for register combiners: which fields they set, and what programs made of them compute."""

import pytest

from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    DISCARD,
    NOTHING,
    ONE,
    PRIMARY,
    SECONDARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    TEXTURE2,
    TEXTURE3,
    ZERO,
    alpha_of,
    blue_of,
    both,
    constant_product,
    dot,
    expand,
    exponential,
    final,
    gate,
    less_half,
    negated,
    one_minus,
    product,
    program,
    quotient,
    scaled,
    shown,
    signed,
    square,
    square_root,
    stage,
    total,
)
from fixedpipe.effects.passes.texture_shaders import (
    ALPHA_RED_STAGE,
    GREEN_BLUE_STAGE,
    NO_TEXTURE,
    PASS_THROUGH_STAGE,
    TEXTURE_STAGE,
    dot_product_stages,
)
from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerFunction,
    CombinerScale,
    ComponentUsage,
    DotProductMapping,
    Mapping,
    Register,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    CombinerLookup,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
    TextureShaderStage,
)
from tests.reference import combine

A, B, C, D = (CombinerInput(register) for register in (TEXTURE0, TEXTURE1, SPARE0, SPARE1))


def drawn(combiners, **registers):
    """What the specification computes of a program on a GeForce 256, of registers by the words' names; the
    rest are zero. Bytes.
    """
    values = combine.initial_registers((0,) * 4, (0,) * 4, [(0,) * 4] * 2, (0,) * 4)
    values |= {Register[name]: value for name, value in registers.items()}
    return tuple(combine.combine(combiners, values, combine.machine_of(GEFORCE_256)))


# ----------------------------------------------------------------------------------------------- fields


def test_registers_are_called_as_in_the_notation_of_the_time():
    textures = Register.TEXTURE0, Register.TEXTURE1, Register.TEXTURE2, Register.TEXTURE3
    assert textures == (TEXTURE0, TEXTURE1, TEXTURE2, TEXTURE3)
    assert (PRIMARY, SECONDARY) == (Register.PRIMARY_COLOR, Register.SECONDARY_COLOR)
    assert (SPARE0, SPARE1, DISCARD) == (Register.SPARE0, Register.SPARE1, Register.DISCARD)
    assert (CONSTANT0, CONSTANT1) == (Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1)


@pytest.mark.parametrize(
    ("word", "mapping"),
    [
        (expand, Mapping.EXPAND_NORMAL),
        (signed, Mapping.SIGNED_IDENTITY),
        (negated, Mapping.SIGNED_NEGATE),
        (one_minus, Mapping.UNSIGNED_INVERT),
    ],
)
def test_a_word_for_inputs_is_a_mapping_and_keeps_the_component(word, mapping):
    assert word(SPARE0) == CombinerInput(SPARE0, mapping)
    assert word(blue_of(SPARE0)) == CombinerInput(SPARE0, mapping, ComponentUsage.BLUE)
    assert alpha_of(word(SPARE0)) == CombinerInput(SPARE0, mapping, ComponentUsage.ALPHA)


def test_what_has_a_sign_can_be_negated_and_nothing_is_mapped_twice():
    assert negated(expand(SPARE0)) == CombinerInput(SPARE0, Mapping.EXPAND_NEGATE)
    assert negated(signed(SPARE0)) == CombinerInput(SPARE0, Mapping.SIGNED_NEGATE)
    for word, given in ((expand, signed), (one_minus, expand), (negated, one_minus), (signed, negated)):
        with pytest.raises(ValueError, match=f"{word.__name__} has no mapping .* read as"):
            word(given(SPARE0))


def test_words_for_products_set_these_fields_and_no_others():
    only_ab = {"a": A, "b": B, "sum_output": DISCARD}
    assert product(TEXTURE0, B, to=SPARE0) == RGBPortion(**only_ab, ab_output=SPARE0)
    assert dot(A, TEXTURE1, to=SPARE1) == RGBPortion(**only_ab, ab_output=SPARE1, ab_dot_product=True)
    assert square(TEXTURE0, to=SPARE0) == product(A, A, to=SPARE0)
    assert product(A, B) == RGBPortion(**only_ab)


def test_words_for_portions_set_these_fields_and_no_others():
    assert both(dot(A, B, to=SPARE0), product(C, D, to=SPARE1)) == RGBPortion(
        A, B, C, D, SPARE0, SPARE1, DISCARD, ab_dot_product=True
    )
    assert both(product(A, B, to=SPARE0), dot(C, D, to=SPARE1)) == RGBPortion(
        A, B, C, D, SPARE0, SPARE1, DISCARD, cd_dot_product=True
    )
    assert total(product(A, B), C, to=SPARE1) == RGBPortion(A, B, C, ONE, sum_output=SPARE1)
    assert total(A, to=SPARE0) == RGBPortion(A)
    assert scaled(4, total(A, to=SPARE0)) == RGBPortion(A, scale=CombinerScale.SCALE_BY_FOUR)
    assert scaled(2, less_half(total(A, to=SPARE0))) == RGBPortion(
        A, scale=CombinerScale.SCALE_BY_TWO, bias=CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF
    )
    assert scaled(1.0, product(A, B)) == product(A, B)
    assert square_root(A, product(C, D), to=SPARE0) == RGBPortion(
        A, ONE, C, D, function=CombinerFunction.SQUARE_ROOT
    )
    assert exponential(A, to=SPARE0) == RGBPortion(A, function=CombinerFunction.EXPONENTIAL)
    assert quotient(dot(A, B), C, to=SPARE0) == RGBPortion(
        A, B, C, ONE, ab_dot_product=True, function=CombinerFunction.DIVIDE
    )


def test_the_same_words_make_an_alpha_half_which_reads_alpha():
    alpha = {register: CombinerInput(register, usage=ComponentUsage.ALPHA) for register in (TEXTURE0, SPARE0)}
    one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, ComponentUsage.ALPHA)
    blue = CombinerInput(SPARE0, usage=ComponentUsage.BLUE)

    def made(portion):
        return stage(alpha=portion).alpha

    assert made(total(TEXTURE0, SPARE0, to=SPARE1)) == AlphaPortion(
        alpha[TEXTURE0], one, alpha[SPARE0], one, sum_output=SPARE1
    )
    four = {"scale": CombinerScale.SCALE_BY_FOUR}
    assert made(gate(SPARE0)) == AlphaPortion(blue, one, ab_output=SPARE0, sum_output=DISCARD, **four)
    assert made(quotient(TEXTURE0, blue_of(SPARE0), to=SPARE0)) == AlphaPortion(
        alpha[TEXTURE0], one, blue, one, function=CombinerFunction.DIVIDE
    )
    assert made(less_half(both(product(A, C, to=SPARE0), square(C, to=SPARE1)))) == AlphaPortion(
        alpha[TEXTURE0],
        alpha[SPARE0],
        alpha[SPARE0],
        alpha[SPARE0],
        SPARE0,
        SPARE1,
        DISCARD,
        bias=CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF,
    )
    nothing = CombinerInput(usage=ComponentUsage.ALPHA)
    assert stage() == GeneralCombiner(
        RGBPortion(ZERO, sum_output=DISCARD), AlphaPortion(nothing, sum_output=DISCARD)
    )


def test_stages_have_constants_and_lookups_of_their_own():
    given = (0.1, 0.2, 0.3, 0.4), (5.0, 6.0, 7.0, 8.0)
    made = stage(NOTHING, NOTHING, *given, lookup=2)
    assert (made.constant_color0, made.constant_color1) == given
    assert made.lookup == CombinerLookup(2, SPARE0)


def test_a_product_in_the_final_combiner_is_e_times_f():
    e_times_f = CombinerInput(Register.E_TIMES_F)
    opaque = alpha_of(ONE)
    assert final(TEXTURE0) == FinalCombiner(A, ONE, ZERO, ZERO, g=opaque)
    assert final(product(C, D), TEXTURE0) == FinalCombiner(e_times_f, A, ZERO, ZERO, C, D, opaque)
    assert final(A, B, plus=square(D)) == FinalCombiner(A, B, ZERO, e_times_f, D, D, opaque)
    assert final(square(C), square(C)) == FinalCombiner(e_times_f, e_times_f, ZERO, ZERO, C, C, opaque)
    assert final(A, alpha=SPARE0).g == alpha_of(SPARE0)
    assert final(A, alpha=blue_of(SPARE0)).g == blue_of(SPARE0)
    assert shown(TEXTURE0, alpha=TEXTURE1) == FinalCombiner(ZERO, ZERO, ZERO, A, g=alpha_of(TEXTURE1))


def test_a_program_s_portions_are_stages_and_its_constants_opaque():
    made = program(
        total(A, to=SPARE0), final(SPARE0, CONSTANT0), constant0=(0.25, 0.5, 1), constant1=(1, 0, 0)
    )
    assert made == RegisterCombiners(
        (stage(total(A, to=SPARE0)),), final(SPARE0, CONSTANT0), (0.25, 0.5, 1.0, 1.0), (1.0, 0.0, 0.0, 1.0)
    )
    assert program(shown(A)) == RegisterCombiners((stage(),), shown(A))
    assert constant_product(A, (0, 0, 1)) == program(final(A, CONSTANT0), constant0=(0, 0, 1))


def test_stages_of_texture_shaders_are_the_operations_of_their_names():
    assert NO_TEXTURE is None
    assert TextureShaderStage(Operation.TEXTURE_2D) == TEXTURE_STAGE
    assert TextureShaderStage(Operation.PASS_THROUGH) == PASS_THROUGH_STAGE
    assert TextureShaderStage(Operation.DEPENDENT_AR_TEXTURE_2D) == ALPHA_RED_STAGE
    assert TextureShaderStage(Operation.DEPENDENT_GB_TEXTURE_2D) == GREEN_BLUE_STAGE


def test_dot_product_stages_end_with_the_lookup():
    first, second = dot_product_stages(0, 1)
    expands = {"dot_product_mapping": DotProductMapping.EXPAND_NORMAL}
    assert first == TextureShaderStage(Operation.DOT_PRODUCT, 0, **expands)
    assert second == TextureShaderStage(Operation.DOT_PRODUCT_TEXTURE_2D, 1, **expands)
    cube = Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP
    assert [s.operation for s in dot_product_stages(0, 0, 0, lookup=cube)] == [
        Operation.DOT_PRODUCT,
        Operation.DOT_PRODUCT,
        cube,
    ]
    unsigned = DotProductMapping.UNSIGNED_IDENTITY
    assert {s.dot_product_mapping for s in dot_product_stages(0, 0, mapping=unsigned)} == {unsigned}


# ---------------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: total(A, B, C, to=SPARE0), "two products at most, not 3"),
        (lambda: total(to=SPARE0), "not 0 terms"),
        (lambda: total(scaled(2, square(A)), B, to=SPARE0), "more than one product"),
        (lambda: both(total(A, to=SPARE0), square(B)), "more than one product"),
        (lambda: scaled(3, square(A)), "scale of a portion is 3"),
        (lambda: scaled(2, scaled(2, square(A))), "has SCALE_BY_TWO already; scale once"),
        (lambda: less_half(scaled(2, square(A))), "take the half off before"),
        (lambda: less_half(less_half(square(A))), "less a half already"),
        (lambda: stage(alpha=dot(A, B, to=SPARE0)), "no dot product; take blue_of"),
        (lambda: stage(alpha=both(square(A), dot(A, B, to=SPARE0))), "no dot product; take blue_of"),
        (lambda: final(square(A), square(B)), "one plain product beside A B"),
        (lambda: final(dot(A, B)), "one plain product beside A B"),
        (lambda: final(square(A, to=SPARE0)), "one plain product beside A B"),
        (lambda: program(square(A, to=SPARE0)), "ends with its final combiner"),
        (lambda: square(dot(A, B)), "is no input"),
        (lambda: final(A, alpha=square(A)), "is no input"),
        (lambda: program(), "final combiner, not with nothing; add final or shown"),
        (lambda: program(TEXTURE0), "not with <Register.TEXTURE0"),
        (lambda: program(shown(A), constant0=(1.0, 1.0, 1.0, 1.0)), "red, green and blue from 0 to 1"),
    ],
)
def test_what_no_combiner_does_is_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize("given", [3, 0.5, "spare0", None, (1.0, 0.0, 0.0), shown(A)], ids=repr)
@pytest.mark.parametrize(
    "word",
    [
        expand,
        negated,
        alpha_of,
        blue_of,
        square,
        shown,
        lambda given: product(A, given),
        lambda given: dot(given, A),
        lambda given: final(A, alpha=given),
    ],
)
def test_what_is_no_input_is_refused(word, given):
    with pytest.raises(ValueError, match=r"is no input; give a register, SPARE0 for instance"):
        word(given)


@pytest.mark.parametrize("given", [3, "scaled", TEXTURE0, A, shown(A)], ids=repr)
@pytest.mark.parametrize(
    "word",
    [
        less_half,
        stage,
        lambda given: scaled(2, given),
        lambda given: both(given, square(A)),
        lambda given: both(square(A), given),
        lambda given: stage(alpha=given),
        lambda given: program(given, shown(A)),
    ],
)
def test_what_is_no_portion_is_refused(word, given):
    with pytest.raises(ValueError, match=r"is no portion; give what product, dot, square, both"):
        word(given)


@pytest.mark.parametrize("given", [3, None, "spare0", A, square(A)], ids=repr)
@pytest.mark.parametrize("word", [product, dot, lambda a, b, to: total(a, b, to=to), quotient])
def test_what_is_no_register_is_not_written(word, given):
    with pytest.raises(ValueError, match=r"is no register to write; give SPARE0, DISCARD or another"):
        word(A, B, given)


def test_no_stage_multiplies_nothing():
    with pytest.raises(ValueError, match=r"There is no stage; give the unit whose texel each multiplies"):
        dot_product_stages()


# ---------------------------------------------------------------------------------------------- meaning


def test_words_and_the_notation_of_the_time_say_the_same():
    said = program(
        stage(scaled(4, both(dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0), square(A, to=SPARE1)))),
        stage(total(product(signed(SPARE0), CONSTANT0), negated(SPARE1), to=SPARE0), alpha=gate(SPARE0)),
        final(one_minus(SPARE0), product(CONSTANT1, TEXTURE1), plus=SPARE1, alpha=SPARE0),
        constant0=(0.5, 0.5, 0.5),
        constant1=(1.0, 0.5, 0.0),
    )
    written = parse_program(
        """!!RC1.0
        const0 = (0.5, 0.5, 0.5, 1);
        const1 = (1, 0.5, 0, 1);
        {
          rgb {
            spare0 = expand(tex0) . expand(col0);
            spare1 = unsigned(tex0) * unsigned(tex0);
            scale_by_four();
          }
        }
        {
          rgb {
            discard = spare0 * const0;
            discard = -spare1 * one;
            spare0 = sum();
          }
          alpha {
            spare0 = unsigned(spare0.b) * one;
            scale_by_four();
          }
        }
        final_product = const1 * tex1;
        clamp_color_sum();
        out.rgb = unsigned_invert(spare0) * final_product + spare1;
        out.a = spare0.a;
        """
    ).combiners
    for texels in ((200, 30, 90, 7), (128, 128, 255, 255), (0, 250, 130, 60)):
        registers = {"TEXTURE0": texels, "TEXTURE1": texels[::-1], "PRIMARY_COLOR": (128, 190, 240, 20)}
        assert drawn(said, **registers) == drawn(written, **registers)


def test_a_dot_product_of_expanded_vectors_and_its_gate():
    lit = program(
        dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0),
        stage(alpha=gate(SPARE0)),
        final(SPARE0, alpha=SPARE0),
    )
    straight, slanted, away = (128, 128, 255, 0), (128, 255, 144, 0), (128, 128, 1, 0)
    # EXPAND_NORMAL reads a byte of 255 as 254 of 255, and 144 as 32.
    assert drawn(lit, TEXTURE0=straight, PRIMARY_COLOR=straight) == (253, 253, 253, 255)
    assert drawn(lit, TEXTURE0=slanted, PRIMARY_COLOR=straight) == (32, 32, 32, 128)
    assert drawn(lit, TEXTURE0=away, PRIMARY_COLOR=straight) == (0, 0, 0, 0)


def test_sums_scales_halves_and_signs():
    a, b = (100, 40, 0, 10), (50, 90, 200, 30)

    def shows(*portions):
        return drawn(program(*portions, shown(SPARE0)), TEXTURE0=a, TEXTURE1=b)[:3]

    assert shows(total(A, B, to=SPARE0)) == (150, 130, 200)
    assert shows(scaled(0.5, total(A, B, to=SPARE0))) == (75, 65, 100)
    assert shows(total(A, negated(TEXTURE1), to=SPARE0)) == (50, 0, 0)
    assert shows(total(negated(TEXTURE0), B, to=SPARE0)) == (0, 50, 200)
    assert shows(total(negated(TEXTURE0), to=SPARE0), product(negated(SPARE0), ONE, to=SPARE0)) == a[:3]
    assert shows(scaled(2, less_half(total(B, to=SPARE0)))) == (0, 0, 144)
    assert shows(total(one_minus(TEXTURE0), to=SPARE0)) == (155, 215, 255)
    assert shows(total(alpha_of(TEXTURE1), to=SPARE0)) == (30, 30, 30)


def test_the_final_combiner_adds_a_product_to_a_product():
    halves = program(final(TEXTURE0, CONSTANT0, plus=product(TEXTURE1, CONSTANT1)), constant0=(0.5,) * 3,
                     constant1=(1.0, 0.0, 0.5))  # fmt: skip
    halves_drawn = drawn(halves, TEXTURE0=(200, 100, 0, 0), TEXTURE1=(60, 60, 60, 0))
    assert halves_drawn == (160, 50, 30, 255)
