"""Which programs are equal on every machine, and which are not."""

from dataclasses import replace

import pytest

from fixedpipe.pipeline.enums import TextureShaderOperation as Op
from fixedpipe.pipeline.notations.equal_programs import plain_combiners, plain_stages
from fixedpipe.pipeline.notations.register_combiners import parse
from fixedpipe.pipeline.state import TextureShaderStage

RC = "!!RC1.0\nconst0 = (0.5, 0.25, 0, 1);\n{ rgb { %s } }\nout.rgb = spare0;\n"
TWO = "discard = tex0; discard = tex1;"


def plain(lines, stages=None):
    return plain_combiners(parse(RC % lines), stages)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("spare0 = tex0 * col0;", "spare0 = col0 * tex0;"),
        ("spare0 = tex0 . expand(col0);", "spare0 = expand(col0) . tex0;"),
        (
            "discard = tex0; discard = tex1 * col0; spare0 = sum();",
            "discard = col0 * tex1; discard = tex0; spare0 = sum();",
        ),
        ("spare0 = tex0 * col0;", "discard = zero; discard = tex0 * col0; spare0 = sum();"),
        ("spare0 = tex0 * col0;", "discard = zero; spare0 = tex0 * col0;"),
        ("spare0 = unsigned(col0);", "spare0 = col0;"),
        ("spare0 = unsigned(const0);", "spare0 = const0;"),
        (
            "spare0 = const0; } } { rgb { spare0 = const0;",
            "spare0 = const0; } } { const1 = (0.5, 0.25, 0, 0.125); rgb { spare0 = const1;",
        ),
        ("spare0 = tex0; } } { rgb { discard = col0;", "spare0 = tex0;"),
        (
            "spare0 = tex0; scale_by_two(); } alpha { discard = tex0; scale_by_two();",
            "spare0 = tex0; scale_by_two();",
        ),
    ],
)
def test_two_spellings_of_one_program(one, other):
    assert parse(RC % one) != parse(RC % other)
    assert plain(one) == plain(other)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("spare0 = unsigned(tex0);", "spare0 = tex0;"),  # a texture may have signed components
        ("spare0 = unsigned(spare1);", "spare0 = spare1;"),
        ("col0 = tex0; } } { rgb { spare0 = unsigned(col0);", "col0 = tex0; } } { rgb { spare0 = col0;"),
        ("spare0 = tex0 * col0;", "spare0 = tex0 . col0;"),
        ("spare0 = tex0 * -one;", "spare0 = -tex0;"),  # -256/255 where one half is 128
        (f"{TWO} spare0 = mux();", "discard = tex1; discard = tex0; spare0 = mux();"),
        (f"{TWO} spare0 = mux();", f"{TWO} spare0 = sum();"),
        ("spare0 = const0;", "spare0 = const1;"),
        ("spare0 = const0;", "spare0 = const0.a;"),
        ("spare0 = tex0;", "spare0 = tex0; scale_by_two();"),
        ("spare0 = tex0;", "spare1 = tex0;"),
        ("spare0 = tex0; spare1 = col0;", "spare0 = tex0;"),
    ],
)
def test_what_computes_something_else(one, other):
    assert plain(one) != plain(other)


def test_coordinates_that_pass_through_are_never_negative():
    stages = (TextureShaderStage(Op.PASS_THROUGH),)
    assert plain("spare0 = unsigned(tex0);", stages) == plain("spare0 = tex0;", stages)
    written = "tex0 = -tex0; } } { rgb { spare0 = %s;"
    assert plain(written % "unsigned(tex0)", stages) != plain(written % "tex0", stages)


def test_the_final_combiner_s_clamp_counts_where_the_color_sum_is_read():
    def final(text):
        return plain_combiners(parse(f"!!RC1.0\n{text}"))

    assert final("out.rgb = spare0;") == final("clamp_color_sum(); out.rgb = spare0;")
    assert final("out.rgb = color_sum;") != final("clamp_color_sum(); out.rgb = color_sum;")
    assert final("out.rgb = spare0;") == final("final_product = tex0 * tex1; out.rgb = spare0;")
    assert final("final_product = tex0 * tex0; out.rgb = final_product;") != final(
        "final_product = tex0 * tex1; out.rgb = final_product;"
    )


def test_stages_are_equal_by_what_their_operations_read():
    tex, none = TextureShaderStage(Op.TEXTURE_2D), TextureShaderStage()
    bump = TextureShaderStage(Op.OFFSET_TEXTURE_2D)
    assert plain_stages((replace(tex, constant_eye=(1.0, 0.0, 0.0)), none)) == plain_stages((tex,))
    assert plain_stages((tex, replace(bump, offset_texture_matrix=(2.0, 0.0, 0.0, 2.0)))) == plain_stages(
        (tex, bump)
    )
    assert plain_stages((tex, tex, bump)) != plain_stages((tex, tex, replace(bump, previous_texture_input=1)))
    assert plain_stages((tex, replace(tex, roughness=0))) != plain_stages((tex, tex))
    assert plain_stages(None) == plain_stages((none,)) == ()
