"""The !!TS1.0 notation: round trips, every instruction, and errors that say where and what."""

from dataclasses import replace

import pytest
from hypothesis import given, settings

from fixedpipe.pipeline.enums import CullMode, DotProductMapping
from fixedpipe.pipeline.enums import TextureShaderOperation as Op
from fixedpipe.pipeline.notations.texture_shaders import (
    INSTRUCTION_NAMES,
    TextureShaderTextError,
    format_stages,
    parse,
)
from fixedpipe.pipeline.profiles import GEFORCE_3, NV2A
from fixedpipe.pipeline.state import TextureShaderStage
from fixedpipe.pipeline.validation.validate import validate_program
from tests.support.program_strategies import texture_shaders
from tests.support.text_errors import assert_says_where_and_what

Stage = TextureShaderStage
EXPAND = DotProductMapping.EXPAND_NORMAL


@settings(max_examples=150)
@given(texture_shaders())
def test_what_is_formatted_parses_back_to_the_same_stages(text):
    stages = parse(text)
    formatted = format_stages(stages)
    assert parse(formatted) == stages
    assert format_stages(parse(formatted)) == formatted
    validate_program(stages, None, NV2A)
    assert len(stages) == text.count(";")


SIMPLE = {
    "nop": Op.NONE,
    "texture_1d": Op.TEXTURE_1D,
    "texture_2d": Op.TEXTURE_2D,
    "texture_rectangle": Op.TEXTURE_RECTANGLE,
    "texture_3d": Op.TEXTURE_3D,
    "texture_cube_map": Op.TEXTURE_CUBE_MAP,
    "pass_through": Op.PASS_THROUGH,
}


@pytest.mark.parametrize(("name", "operation"), SIMPLE.items())
def test_operations_without_arguments(name, operation):
    assert parse(f"!!TS1.0\n{name}();") == (Stage(operation),)


def test_offsets_dependent_accesses_and_culling():
    text = """!!TS1.0
        texture_2d(); // the first
        offset_2d_scale(tex0, 1, -.5, +0.25, 2., 0.5, 0.125);
        dependent_gb(tex1); # unit 2
        cull_fragment(GEQUAL_TO_ZERO, LESS_THAN_ZERO, /* r */ LESS_THAN_ZERO, GEQUAL_TO_ZERO);"""
    g, less = CullMode.GEQUAL, CullMode.LESS
    assert parse(text) == (
        Stage(Op.TEXTURE_2D),
        Stage(
            Op.OFFSET_TEXTURE_2D_SCALE,
            offset_texture_matrix=(1.0, -0.5, 0.25, 2.0),
            offset_texture_scale=0.5,
            offset_texture_bias=0.125,
        ),
        Stage(Op.DEPENDENT_GB_TEXTURE_2D, previous_texture_input=1),
        Stage(Op.CULL_FRAGMENT, cull_modes=(g, less, less, g)),
    )


GROUPS = {
    "2d": (2, Op.DOT_PRODUCT_TEXTURE_2D),
    "rectangle": (2, Op.DOT_PRODUCT_TEXTURE_RECTANGLE),
    "depth_replace": (2, Op.DOT_PRODUCT_DEPTH_REPLACE),
    "3d": (3, Op.DOT_PRODUCT_TEXTURE_3D),
    "cube_map": (3, Op.DOT_PRODUCT_TEXTURE_CUBE_MAP),
    "reflect_cube_map_eye_from_qs": (3, Op.DOT_PRODUCT_REFLECT_CUBE_MAP),
}


@pytest.mark.parametrize(("name", "length", "last"), [(n, *of) for n, of in GROUPS.items()])
def test_dot_products_over_several_units(name, length, last):
    lines = [f"dot_product_{name}_{k}of{length}(expand(tex0));" for k in range(1, length + 1)]
    stages = parse("!!TS1.0\ntexture_2d();\n" + "\n".join(lines))
    dot = Stage(Op.DOT_PRODUCT, dot_product_mapping=EXPAND)
    assert stages == (Stage(Op.TEXTURE_2D), *[dot] * (length - 1), replace(dot, operation=last))
    validate_program(stages, None, GEFORCE_3)


def test_the_eye_of_the_first_of_three_is_the_reflections():
    group = "dot_product_cube_map_and_reflect_cube_map_const_eye"
    names = [f"{group}_{k}of3" for k in (1, 2, 3)]
    text = f"!!TS1.0 texture_2d(); {names[0]}(tex0, 0, 0.5, -1); {names[1]}(tex0); {names[2]}(expand(tex0));"
    stages = parse(text)
    assert [s.operation for s in stages[1:]] == [
        Op.DOT_PRODUCT,
        Op.DOT_PRODUCT_DIFFUSE_CUBE_MAP,
        Op.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
    ]
    assert [s.constant_eye for s in stages[1:]] == [(0.0, 0.0, -1.0), (0.0, 0.0, -1.0), (0.0, 0.5, -1.0)]
    assert [s.dot_product_mapping is EXPAND for s in stages[1:]] == [False, False, True]


def test_every_instruction_has_a_canonical_text():
    text = """!!TS1.0
texture_cube_map();
offset_rectangle(tex0, 1, 0, 0, 1);
dot_product_depth_replace_1of2(tex0);
dot_product_depth_replace_2of2(expand(tex1));
"""
    assert format_stages(parse(text)) == text
    assert len(INSTRUCTION_NAMES) == 38


@pytest.mark.parametrize(
    ("stages", "words"),
    [
        ((), "1 to 4 instructions; there are 0"),
        ((Stage(),) * 5, "there are 5"),
        ((Stage(Op.DEPENDENT_AR_TEXTURE_2D),), "reads stage 0"),
        (
            (Stage(Op.TEXTURE_2D), Stage(Op.DOT_PRODUCT)),
            "no operation that begins with texture shader",
        ),
        (
            (
                Stage(Op.TEXTURE_2D),
                Stage(Op.OFFSET_TEXTURE_2D, offset_texture_matrix=(float("nan"), 0, 0, 0)),
            ),
            "nan",
        ),
        (
            (
                Stage(Op.TEXTURE_2D),
                Stage(Op.DOT_PRODUCT, dot_product_mapping=DotProductMapping.SIGNED_ODD),
                Stage(Op.DOT_PRODUCT_TEXTURE_2D),
            ),
            "SIGNED_ODD",
        ),
    ],
)
def test_what_no_program_can_say_is_not_formatted(stages, words):
    with pytest.raises(ValueError, match=words):
        format_stages(stages)


ERRORS = [
    ("", 1, 1, ["text ends", "!!TS1.0"]),
    ("!!RC1.0\nnop();", 1, 1, ["found '!!RC1.0'", "!!TS1.0"]),
    ("!!TS1.0", 1, 8, ["without an instruction", "texture_2d()"]),
    ("!!TS1.0\ntexture_2d()", 2, 13, ["text ends", "';'"]),
    ("!!TS1.0\ntexture_2d;", 2, 11, ["found ';'", "'('"]),
    ("!!TS1.0\ntexture_2d(tex0);", 2, 12, ["found 'tex0'", "')'"]),
    ("!!TS1.0\ntexture_cube();", 2, 1, ["found 'texture_cube'", "texture_cube_map()"]),
    ("!!TS1.0\nblend();", 2, 1, ["found 'blend'", "cull_fragment()"]),
    ("!!TS1.0\n" + "nop();\n" * 5, 6, 1, ["5th instruction", "4 texture units"]),
    ("!!TS1.0\ntexture_2d();\ndependent_ar(tex1);", 3, 14, ["tex1", "below tex1"]),
    ("!!TS1.0\ndependent_ar(tex0);", 2, 14, ["unit 0", "begin with a texture"]),
    ("!!TS1.0\ntexture_2d();\ndependent_ar(tex3);", 3, 14, ["found 'tex3'", "tex0, tex1 or tex2"]),
    ("!!TS1.0\ntexture_2d();\ndependent_ar(expand(tex0));", 3, 14, ["found 'expand'"]),
    ("!!TS1.0\nnop();\ndependent_ar(tex0);", 3, 1, ["stage 0 (NONE)"]),
    ("!!TS1.0\ncull_fragment(GEQUAL_TO_ZERO);", 2, 29, ["found ')'", "','"]),
    ("!!TS1.0\ncull_fragment(LEQUAL, 1, 1, 1);", 2, 15, ["found 'LEQUAL'", "LESS_THAN_ZERO"]),
    ("!!TS1.0\ntexture_2d();\noffset_2d(tex0, 1, 0, 0, x);", 3, 26, ["found 'x'", "number"]),
    ("!!TS1.0\ntexture_2d();\noffset_2d(tex0, 1e3, 0, 0, 1);", 3, 17, ["character '1'"]),
    ("!!TS1.0\ntexture_2d();\ndot_product_2d_1of2(tex0);", 3, 1, ["without dot_product_2d_2of2()"]),
    ("!!TS1.0\ntexture_2d();\ndot_product_2d_2of2(tex0);", 3, 1, ["without dot_product_2d_1of2()"]),
    (
        "!!TS1.0\ntexture_2d();\ndot_product_2d_1of2(tex0);\ndot_product_rectangle_2of2(tex0);",
        4,
        1,
        ["dot_product_rectangle_2of2() where dot_product_2d_2of2()"],
    ),
    ("!!TS1.0\ntexture_2d();\ndot_product_2d_1of2(tex0);\nnop();", 4, 1, ["nop() where"]),
    ("!!TS1.0 /* no end", 1, 9, ["never ends"]),
]


@pytest.mark.parametrize(("text", "line", "column", "words"), ERRORS, ids=[repr(e[0][-40:]) for e in ERRORS])
def test_an_error_says_where_and_what(text, line, column, words):
    assert_says_where_and_what(TextureShaderTextError, parse, text, line, column, words)
