"""The !!RC1.0 notation: round trips, programs with every construct, and errors that say where and what."""

from dataclasses import replace

import pytest
from hypothesis import given, settings

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, ComponentUsage, Mapping, MuxSelect, Register
from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.notations.register_combiners import CombinerTextError, parse
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)
from tests.support.combiner_strategies import register_combiners
from tests.support.text_errors import assert_says_where_and_what

RGB, ALPHA, BLUE = ComponentUsage
R, M = Register, Mapping


def signed(register, usage=RGB):
    return CombinerInput(register, M.SIGNED_IDENTITY, usage)


ZERO, ONE = CombinerInput(), CombinerInput(R.ZERO, M.UNSIGNED_INVERT)
ZERO_ALPHA, ONE_ALPHA = replace(ZERO, usage=ALPHA), replace(ONE, usage=ALPHA)
NO_RGB = RGBPortion(a=ZERO, b=ZERO, sum_output=R.DISCARD)
NO_ALPHA = AlphaPortion(a=ZERO_ALPHA, b=ZERO_ALPHA, sum_output=R.DISCARD)
NOTHING = FinalCombiner(ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO_ALPHA)


def program(*stages, final=NOTHING, **others):
    return RegisterCombiners(
        general=stages, final=final, color_sum_clamp=others.pop("clamp", False), **others
    )


# ------------------------------------------------------------------------------------------- round trip


@settings(max_examples=200)
@given(register_combiners(max_stages=2, units=2))
def test_what_is_formatted_parses_back_to_the_same_combiners(combiners):
    assert parse(format_program(combiners)) == combiners


@settings(max_examples=40)
@given(register_combiners(max_stages=8, units=4, per_stage_constants=True))
def test_eight_stages_four_units_and_stage_constants_round_trip(combiners):
    assert parse(format_program(combiners)) == combiners


@settings(max_examples=40)
@given(register_combiners())
def test_formatting_is_canonical(combiners):
    text = format_program(combiners)
    assert format_program(parse(text)) == text


def test_the_initial_state_round_trips():
    assert parse(format_program(RegisterCombiners())) == RegisterCombiners()


@pytest.mark.parametrize("value", [0.1, 1e-7, 1 / 3, 2.0**-30, 0.0, 1.0, -0.25, 3.0e22])
def test_constants_keep_every_bit_and_no_exponent_is_written(value):
    combiners = RegisterCombiners(constant_color0=(value, 0.5, 0.0, 1.0))
    text = format_program(combiners)
    assert parse(text) == combiners
    assert "e" not in text[text.index("(") : text.index(")")]


def test_a_program_without_general_combiners_prints_as_one():
    text = "!!RC1.0\nout.rgb = col0;\n"
    assert format_program(parse(text)) == text


# ------------------------------------------------------------------------ programs, construct by construct


def test_modulate():
    parsed = parse("!!RC1.0 { rgb { spare0 = tex0 * col0; } alpha { spare0 = tex0 * col0; } } "
                   "out.rgb = spare0; out.a = spare0;")  # fmt: skip
    assert parsed == program(
        GeneralCombiner(
            rgb=RGBPortion(
                signed(R.TEXTURE0), signed(R.PRIMARY_COLOR), ZERO, ZERO, R.SPARE0, sum_output=R.DISCARD
            ),
            alpha=AlphaPortion(
                signed(R.TEXTURE0, ALPHA),
                signed(R.PRIMARY_COLOR, ALPHA),
                ZERO_ALPHA,
                ZERO_ALPHA,
                R.SPARE0,
                sum_output=R.DISCARD,
            ),
        ),
        final=replace(NOTHING, d=CombinerInput(R.SPARE0), g=CombinerInput(R.SPARE0, usage=ALPHA)),
    )


def test_a_dot_product_of_normal_map_and_light_vector_scaled_by_four():
    parsed = parse("""!!RC1.0
        { rgb { spare0 = expand(tex0) . expand(col0); scale_by_four(); } }
        out.rgb = spare0;""")
    expected = RGBPortion(
        CombinerInput(R.TEXTURE0, M.EXPAND_NORMAL),
        CombinerInput(R.PRIMARY_COLOR, M.EXPAND_NORMAL),
        ab_output=R.SPARE0,
        sum_output=R.DISCARD,
        scale=CombinerScale.SCALE_BY_FOUR,
        ab_dot_product=True,
    )
    assert parsed == program(
        GeneralCombiner(expected, NO_ALPHA), final=replace(NOTHING, d=CombinerInput(R.SPARE0))
    )


def test_two_dot_products_and_their_sum():
    portion = (
        parse("""!!RC1.0
        { rgb { spare0 = expand(tex0) . expand(col0);
                spare1 = -expand(tex1).half_bias(col1);
                tex0 = sum(); } }
        out.rgb = spare0;""")
        .general[0]
        .rgb
    )
    assert (portion.ab_output, portion.cd_output, portion.sum_output) == (R.SPARE0, R.SPARE1, R.TEXTURE0)
    assert portion.ab_dot_product and portion.cd_dot_product and not portion.mux_sum
    assert portion.c == CombinerInput(R.TEXTURE1, M.EXPAND_NEGATE)
    assert portion.d == CombinerInput(R.SECONDARY_COLOR, M.HALF_BIAS_NORMAL)


def test_self_shadowing_selects_by_mux():
    portion = parse("""!!RC1.0
        { rgb { discard = zero; discard = tex0 * col0; spare0 = mux(); }
          alpha { spare0 = expand(tex0.b); } }
        out.rgb = spare0;""").general[0]
    assert portion.rgb.mux_sum
    assert (portion.rgb.a, portion.rgb.b) == (signed(R.ZERO), ONE)
    assert portion.alpha.a == CombinerInput(R.TEXTURE0, M.EXPAND_NORMAL, BLUE)
    assert portion.alpha.b == ONE_ALPHA


MAPPINGS = {
    "col1": M.SIGNED_IDENTITY,
    "-col1": M.SIGNED_NEGATE,
    "unsigned(col1)": M.UNSIGNED_IDENTITY,
    "unsigned_invert(col1)": M.UNSIGNED_INVERT,
    "expand(col1)": M.EXPAND_NORMAL,
    "- expand ( col1 )": M.EXPAND_NEGATE,
    "half_bias(col1)": M.HALF_BIAS_NORMAL,
    "-half_bias(col1)": M.HALF_BIAS_NEGATE,
}


@pytest.mark.parametrize(("text", "mapping"), MAPPINGS.items())
def test_every_mapping_of_a_general_combiner(text, mapping):
    parsed = parse(f"!!RC1.0 {{ rgb {{ spare1 = {text} * spare1; }} }} out.rgb = spare1;")
    assert parsed.general[0].rgb.a == CombinerInput(R.SECONDARY_COLOR, mapping)


REGISTERS = {
    "zero": R.ZERO,
    "const0": R.CONSTANT_COLOR0,
    "const1": R.CONSTANT_COLOR1,
    "fog": R.FOG,
    "col0": R.PRIMARY_COLOR,
    "col1": R.SECONDARY_COLOR,
    "spare0": R.SPARE0,
    "spare1": R.SPARE1,
    "tex0": R.TEXTURE0,
    "tex1": R.TEXTURE1,
    "tex2": R.TEXTURE2,
    "tex3": R.TEXTURE3,
}


@pytest.mark.parametrize(("name", "register"), REGISTERS.items())
def test_every_register_with_every_component(name, register):
    parsed = parse(f"""!!RC1.0
        {{ rgb {{ spare0 = {name} * {name}.rgb; }} alpha {{ spare0 = {name}.b; }} }}
        out.rgb = {name} * {name}.a; out.a = {name};""")
    stage, final = parsed.general[0], parsed.final
    assert (stage.rgb.a, stage.rgb.b) == (signed(register), signed(register))
    assert stage.alpha.a == signed(register, BLUE)
    assert (final.a, final.b) == (CombinerInput(register), CombinerInput(register, usage=ALPHA))
    assert final.g == CombinerInput(register, usage=ALPHA)


SCALES = {
    "": (CombinerScale.NONE, CombinerBias.NONE),
    "scale_by_one_half();": (CombinerScale.SCALE_BY_ONE_HALF, CombinerBias.NONE),
    "scale_by_two();": (CombinerScale.SCALE_BY_TWO, CombinerBias.NONE),
    "scale_by_four();": (CombinerScale.SCALE_BY_FOUR, CombinerBias.NONE),
    "bias_by_negative_one_half();": (CombinerScale.NONE, CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF),
    "bias_by_negative_one_half_scale_by_two();": (
        CombinerScale.SCALE_BY_TWO,
        CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF,
    ),
}


@pytest.mark.parametrize(("text", "expected"), SCALES.items())
def test_every_scale_and_bias(text, expected):
    portion = parse(f"!!RC1.0 {{ alpha {{ spare0 = col0; {text} }} }} out.a = spare0;").general[0].alpha
    assert (portion.scale, portion.bias) == expected


ONES = {
    "one": M.UNSIGNED_INVERT,
    "-one": M.EXPAND_NORMAL,
    "unsigned(one)": M.UNSIGNED_INVERT,
    "unsigned_invert(one)": M.UNSIGNED_IDENTITY,
    "expand(one)": M.UNSIGNED_INVERT,
    "-expand(one)": M.EXPAND_NORMAL,
    "half_bias(one)": M.HALF_BIAS_NEGATE,
    "-half_bias(one)": M.HALF_BIAS_NORMAL,
}


@pytest.mark.parametrize(("text", "mapping"), ONES.items())
def test_one_is_zero_through_another_mapping(text, mapping):
    parsed = parse(f"!!RC1.0 {{ rgb {{ spare0 = col0 * {text}; }} }} out.rgb = spare0;")
    assert parsed.general[0].rgb.b == CombinerInput(R.ZERO, mapping)


def test_constants_for_the_program_and_for_one_stage():
    parsed = parse("""!!RC1.0
        const1 = (-1, +.5, 2., 0.25);
        { const0 = (1, 0, 0, 1); rgb { spare0 = const0 * const1; } }
        { const1 = (0, 0, 1, 0); const0 = (0, 1, 0, 0); alpha { spare0 = const1; } }
        out.rgb = const0;""")
    assert parsed.constant_color0 == (0.0, 0.0, 0.0, 0.0)
    assert parsed.constant_color1 == (-1.0, 0.5, 2.0, 0.25)
    assert [(s.constant_color0, s.constant_color1) for s in parsed.general] == [
        ((1.0, 0.0, 0.0, 1.0), None),
        ((0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0)),
    ]


def test_portions_may_come_in_either_order():
    rgb, alpha = "rgb { spare0 = col0; }", "alpha { spare1 = tex0; }"
    texts = [f"!!RC1.0 {{ {x} {y} }} out.rgb = spare0;" for x, y in ((rgb, alpha), (alpha, rgb))]
    assert parse(texts[0]) == parse(texts[1])


def test_what_a_general_combiner_leaves_out_reads_zero_and_is_discarded():
    parsed = parse("!!RC1.0 { alpha { spare0 = col0; } } { rgb { col0 = tex0; } } out.rgb = col0;")
    assert parsed.general[0].rgb == NO_RGB
    assert parsed.general[1].alpha == NO_ALPHA
    assert (parsed.general[1].rgb.c, parsed.general[1].rgb.d) == (ZERO, ZERO)
    assert parsed.general[1].rgb.sum_output is R.DISCARD


def test_a_program_without_general_combiners_has_one_that_does_nothing():
    assert parse("!!RC1.0 out.a = fog.a;").general == (GeneralCombiner(NO_RGB, NO_ALPHA),)


A, B, C, D = (CombinerInput(r) for r in (R.TEXTURE0, R.PRIMARY_COLOR, R.SPARE0, R.SPARE1))
COLOR_SUM, PRODUCT = CombinerInput(R.SPARE0_PLUS_SECONDARY_COLOR), CombinerInput(R.E_TIMES_F)
OUT_RGB = {
    "spare1": (ZERO, ZERO, ZERO, D),
    "tex0 * col0": (A, B, ZERO, ZERO),
    "tex0 * col0 + spare1": (A, B, ZERO, D),
    "tex0 + spare1": (A, ONE, ZERO, D),
    "lerp(tex0, col0, spare0)": (A, B, C, ZERO),
    "lerp(tex0, col0, spare0) + spare1": (A, B, C, D),
    "spare1 + lerp(tex0, col0, spare0)": (A, B, C, D),
    "unsigned(tex0) * unsigned_invert(col0)": (A, replace(B, mapping=M.UNSIGNED_INVERT), ZERO, ZERO),
    "color_sum": (ZERO, ZERO, ZERO, COLOR_SUM),
    "color_sum * col0": (B, COLOR_SUM, ZERO, ZERO),
    "color_sum + spare1": (ONE, COLOR_SUM, ZERO, D),
    "lerp(color_sum, col0, zero)": (B, COLOR_SUM, ZERO, ZERO),
    "lerp(fog.a, unsigned_invert(color_sum), fog)": (
        CombinerInput(R.FOG, usage=ALPHA),
        replace(COLOR_SUM, mapping=M.UNSIGNED_INVERT),
        CombinerInput(R.FOG),
        ZERO,
    ),
    "one * tex0": (ONE, A, ZERO, ZERO),
}


@pytest.mark.parametrize(("text", "expected"), OUT_RGB.items())
def test_every_form_of_out_rgb(text, expected):
    final = parse(f"!!RC1.0 out.rgb = {text};").final
    assert (final.a, final.b, final.c, final.d) == expected
    assert final.g == ZERO_ALPHA


def test_final_product_and_clamp_come_in_either_order_before_the_outputs():
    product, clamp = "final_product = spare0 * unsigned(spare1.a);", "clamp_color_sum();"
    outputs = "out.a = spare1.b; out.rgb = unsigned_invert(final_product) + color_sum;"
    parsed = parse(f"!!RC1.0 {product} {clamp} {outputs}")
    assert parsed == parse(f"!!RC1.0 {clamp} {product} {outputs}")
    assert parsed.color_sum_clamp
    assert parsed.final == FinalCombiner(
        replace(PRODUCT, mapping=M.UNSIGNED_INVERT),
        ONE,
        ZERO,
        COLOR_SUM,
        CombinerInput(R.SPARE0),
        CombinerInput(R.SPARE1, usage=ALPHA),
        CombinerInput(R.SPARE1, usage=BLUE),
    )


def test_the_color_sum_is_not_clamped_unless_the_program_says_so():
    assert not parse("!!RC1.0 out.rgb = color_sum;").color_sum_clamp


def test_comments_and_white_space_of_every_kind():
    commented = """
        # before the header
        !!RC1.0 // header
        /* a comment
           over lines; with * and / and // in it **/
        {rgb{spare0=tex0*col0;# modulate
        }}out.rgb=\tspare0 ;\r\n// the end"""
    assert parse(commented) == parse("!!RC1.0 { rgb { spare0 = tex0 * col0; } } out.rgb = spare0;")


def test_the_canonical_text_of_a_bump_mapping_program():
    text = """!!RC1.0
const0 = (0.25, 0.5, 1, 0);
{
  const1 = (1, 1, 1, 1);
  rgb {
    spare0 = expand(tex0) . expand(col0);
    discard = -tex1.a * half_bias(const0);
    spare1 = sum();
    bias_by_negative_one_half_scale_by_two();
  }
  alpha {
    spare0 = unsigned_invert(tex0.b);
  }
}
{
  alpha {
    discard = spare0 * spare0;
    discard = const1;
    spare0 = mux();
  }
}
final_product = spare0 * unsigned_invert(fog.a);
clamp_color_sum();
out.rgb = lerp(spare0.a, final_product, tex1) + color_sum;
out.a = spare0.b;
"""
    assert format_program(parse(text)) == text


# --------------------------------------------------------------------------------------------- errors

ERRORS = [
    # text, line, column, words that the sentence must have
    ("", 1, 1, ["text ends", "!!RC1.0"]),
    ("out.rgb = col0;", 1, 1, ["found 'out.rgb'", "!!RC1.0"]),
    ("!!TS1.0\ntexture_2d();", 1, 1, ["found '!!TS1.0'", "!!RC1.0"]),
    ("!!RC1.0", 1, 8, ["without out.rgb or out.a"]),
    (
        "!!RC1.0\n\n\n\n\n{ rgb {\n  spare0 = tex0 ** col0;\n} }\nout.rgb = spare0;",
        7,
        18,
        ["found '*'", "registers are"],
    ),
    ("!!RC1.0\nout.rgb = col0", 2, 15, ["text ends", "';'"]),
    ("!!RC1.0\nout.rgb = tex4;", 2, 11, ["found 'tex4'", "tex3", "one"]),
    ("!!RC1.0\nout.rgb = tex0.alpha;", 2, 15, ["found '.'", ".rgb, .a or .b"]),
    ("!!RC1.0\n{ rgb { spare0 = tex0.green; } }", 2, 23, ["found 'green'", ".rgb, .a or .b"]),
    ("!!RC1.0\nout.rgb = ?;", 2, 11, ["character '?'", "remove it"]),
    ("!!RC1.0 /* no end", 1, 9, ["never ends", "*/"]),
    ("!!RC1.0\nconst0 = (1e-3, 0, 0, 0);", 2, 11, ["a letter right after the number", "exponent"]),
    ("!!RC1.0\nconst0 = (1, 0, 0);", 2, 18, ["found ')'", "','", "four components"]),
    ("!!RC1.0\nconst0 = (red, 0, 0, 0);", 2, 11, ["found 'red'", "number"]),
    ("!!RC1.0\nconst0 = (0,0,0,0);\nconst0 = (1,1,1,1);", 3, 1, ["const0 is set twice"]),
    ("!!RC1.0\n{ rgb { spare0 = col0; } }\nconst0 = (0,0,0,0);", 3, 1, ["const0", "right after the header"]),
    ("!!RC1.0\n{ }", 2, 1, ["general combiner 0", "no portion"]),
    ("!!RC1.0\n{ spare0 = col0; }", 2, 3, ["found 'spare0'", "general combiner 0", "rgb"]),
    ("!!RC1.0\n{ rgb { } }", 2, 9, ["found '}'", "first product"]),
    ("!!RC1.0\n{ rgb { spare0 = col0; }\n  rgb { spare1 = col0; } }", 3, 3, ["second rgb portion"]),
    ("!!RC1.0\n{ rgb { spare0 = col0; spare1 = sum(); } }", 2, 33, ["sum()", "after 1 of the two"]),
    ("!!RC1.0\n{ rgb { spare0 = mux(); } }", 2, 18, ["mux()", "after 0 of the two"]),
    (
        "!!RC1.0\n{ rgb { spare0 = col0;\n spare1 = col1;\n tex0 = tex1; } }",
        4,
        2,
        ["third product", "next general combiner"],
    ),
    (
        "!!RC1.0\n{ rgb { spare0 = col0; scale_by_two(); scale_by_two(); } }",
        2,
        40,
        ["found 'scale_by_two'", "one scale or bias"],
    ),
    ("!!RC1.0\n{ rgb { scale_by_two(); } }", 2, 9, ["first product"]),
    ("!!RC1.0\n{ rgb { spare0 = tex0 + tex1; } }", 2, 23, ["found '+'", "sum()"]),
    ("!!RC1.0\n{ rgb { spare0 = 2 * tex1; } }", 2, 18, ["found '2'", "register"]),
    ("!!RC1.0\n{ rgb { spare0 = -unsigned(tex1); } }", 2, 18, ["minus before unsigned()"]),
    ("!!RC1.0\n{ rgb { spare0 = expand(expand(tex1)); } }", 2, 25, ["found 'expand'", "that expand maps"]),
    ("!!RC1.0\n{ alpha { spare0 = tex0 . tex1; } }", 2, 25, ["dot product in an alpha portion"]),
    ("!!RC1.0\n{ rgb { spare0.a = tex0; } }", 2, 9, ["spare0.a", "writes .rgb only"]),
    ("!!RC1.0\n{ alpha { spare0.b = tex0; } }", 2, 11, ["spare0.b", "writes .a only"]),
    ("!!RC1.0\n{ rgb { one = tex0; } }", 2, 9, ["one is read only"]),
    ("!!RC1.0\n{ rgb { spare0 = discard.a; } }", 2, 18, ["discard.a", "none to choose from"]),
    ("!!RC1.0\nout.rgb = -tex0;", 2, 11, ["found '-'", "final combiner", "unsigned_invert()"]),
    ("!!RC1.0\nout.rgb = expand(tex0);", 2, 11, ["found 'expand'", "general combiner"]),
    ("!!RC1.0\nout.rgb = lerp(tex0, tex1);", 2, 26, ["found ')'", "','", "three arguments"]),
    ("!!RC1.0\nout.rgb = final_product;", 2, 11, ["final_product is read but not set"]),
    ("!!RC1.0\nout.a = col0;\nfinal_product = col0 * col1;", 3, 1, ["final_product after an output"]),
    ("!!RC1.0\nout.a = col0;\nout.a = col1;", 3, 1, ["out.a is set twice"]),
    ("!!RC1.0\nout.a = col0;\n{ rgb { spare0 = col0; } }", 3, 1, ["general combiner after the final"]),
    ("!!RC1.0\nspare0 = col0;", 2, 1, ["found 'spare0'", "general combiner"]),
    ("!!RC1.0\n" + "{ rgb { spare0 = col0; } }\n" * 9 + "out.rgb = col0;", 10, 1, ["after 8", "passes"]),
    # What the extension itself forbids, at the word that asks for it.
    ("!!RC1.0\n{ rgb { spare0 = col0 * tex0.b; } }\nout.a = zero;", 2, 25, ["variable B", "BLUE"]),
    ("!!RC1.0\n{ alpha { spare0 = tex0.rgb; } }\nout.a = zero;", 2, 20, ["variable A", "ALPHA or BLUE"]),
    ("!!RC1.0\n{ alpha { spare0 = fog; } }\nout.a = zero;", 2, 20, ["ALPHA of fog", "final combiner"]),
    ("!!RC1.0\n{ rgb { spare0 = col0 * color_sum; } }\nout.a = zero;", 2, 25, ["only in the final combiner"]),
    ("!!RC1.0\n{ rgb { spare0 = discard; } }\nout.a = zero;", 2, 18, ["reads discard"]),
    ("!!RC1.0\n{ rgb { const0 = col0; } }\nout.a = zero;", 2, 9, ["writes const0", "read only"]),
    ("!!RC1.0\n{ rgb { fog = col0; } }\nout.a = zero;", 2, 9, ["writes fog", "read only"]),
    ("!!RC1.0\n{ rgb { final_product = col0; } }\nout.a = zero;", 2, 9, ["writes final_product"]),
    (
        "!!RC1.0\n{ rgb { spare0 = col0;\n        spare0 = col1; } }\nout.a = zero;",
        3,
        9,
        ["AB output and the CD output both write spare0"],
    ),
    (
        "!!RC1.0\n{ rgb { discard = col0; spare1 = col1;\n        spare1 = sum(); } }\nout.a = zero;",
        3,
        9,
        ["CD output and the sum output both write spare1"],
    ),
    ("!!RC1.0\nout.rgb = lerp(color_sum, col0, col1);", 2, 16, ["variable A", "B, C and D"]),
    ("!!RC1.0\nout.rgb = col0.b;", 2, 11, ["variable D", "BLUE"]),
    ("!!RC1.0\nout.a = col0.rgb;", 2, 9, ["variable G", "ALPHA or BLUE"]),
    ("!!RC1.0\nout.a = color_sum;", 2, 9, ["variable G", "B, C or D"]),
    (
        "!!RC1.0\nfinal_product = color_sum * col0;\nout.rgb = final_product;",
        2,
        17,
        ["variable E", "B, C or D"],
    ),
    ("!!RC1.0\nout.rgb = color_sum * col0.b;", 2, 23, ["variable A", "BLUE"]),
]


@pytest.mark.parametrize(("text", "line", "column", "words"), ERRORS, ids=[repr(e[0][-40:]) for e in ERRORS])
def test_an_error_says_where_and_what(text, line, column, words):
    assert_says_where_and_what(CombinerTextError, parse, text, line, column, words)


def test_every_cut_of_a_program_is_an_error_or_a_program():
    whole = format_program(RegisterCombiners(constant_color0=(0.5, 0.25, 0.0, 1.0)))
    for end in range(len(whole)):
        try:
            parse(whole[:end])
        except CombinerTextError as error:
            assert error.line >= 1 and error.column >= 1
        else:
            assert "out.rgb = " in whole[:end]


@pytest.mark.parametrize(
    ("combiners", "words"),
    [
        (RegisterCombiners(general=()), "1 to 8 general combiners"),
        (RegisterCombiners(general=(GeneralCombiner(),) * 9), "have 9"),
        (RegisterCombiners(constant_color1=(0.0, float("nan"), 0.0, 0.0)), "const1 is (0.0, nan"),
        (
            RegisterCombiners(general=(GeneralCombiner(rgb=RGBPortion(ab_output=R.FOG)),)),
            "writes FOG, which is read only",
        ),
        (RegisterCombiners(mux_select=MuxSelect.LSB), "no word for mux_select"),
        (RegisterCombiners(invert_spare0=True), "no word for invert_spare0"),
        (
            RegisterCombiners(general=(GeneralCombiner(rgb=RGBPortion(cd_blue_to_alpha=True)),)),
            "no word for cd_blue_to_alpha",
        ),
    ],
)
def test_what_no_program_can_say_is_not_formatted(combiners, words):
    with pytest.raises(ValueError, match=words.replace("(", r"\(")):
        format_program(combiners)
