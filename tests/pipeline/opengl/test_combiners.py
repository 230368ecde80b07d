"""Calls of NV_register_combiners and NV_texture_shader give what the same program as text gives."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, TextureShaderOperation
from fixedpipe.pipeline.notations import register_combiners as rc
from fixedpipe.pipeline.notations import texture_shaders as ts
from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.opengl import combiners as c
from fixedpipe.pipeline.opengl import tokens as t
from fixedpipe.pipeline.state import DepthClamp, RegisterCombiners, TextureShaderStage
from tests.pipeline.opengl.drawn import context, refusals, textured
from tests.support.combiner_strategies import register_combiners


def token(table, value):
    return next(name for name, each in table.items() if each is value)


def set_combiners(gl, given):
    """Make the calls for register combiners."""
    gl.CombinerParameteriNV(t.NUM_GENERAL_COMBINERS_NV, len(given.general))
    gl.CombinerParameterfvNV(t.COLOR_SUM_CLAMP_NV, [float(given.color_sum_clamp)])
    gl.CombinerParameterfvNV(t.CONSTANT_COLOR0_NV, given.constant_color0)
    gl.CombinerParameterfvNV(t.CONSTANT_COLOR1_NV, given.constant_color1)
    for number, stage in enumerate(given.general):
        for portion, half in ((t.RGB, stage.rgb), (t.ALPHA, stage.alpha)):
            for i, name in enumerate("abcd"):
                arguments = input_arguments(getattr(half, name))
                gl.CombinerInputNV(t.COMBINER0_NV + number, portion, t.VARIABLE_A_NV + i, *arguments)
            gl.CombinerOutputNV(
                t.COMBINER0_NV + number,
                portion,
                *[token(c.REGISTERS, o) for o in (half.ab_output, half.cd_output, half.sum_output)],
                token(c.SCALES, half.scale),
                token(c.BIASES, half.bias),
                getattr(half, "ab_dot_product", False),
                getattr(half, "cd_dot_product", False),
                half.mux_sum,
            )
        for name, color in (
            (t.CONSTANT_COLOR0_NV, stage.constant_color0),
            (t.CONSTANT_COLOR1_NV, stage.constant_color1),
        ):
            if color is not None:
                gl.CombinerStageParameterfvNV(t.COMBINER0_NV + number, name, color)
    for i, name in enumerate("abcdefg"):
        gl.FinalCombinerInputNV(t.VARIABLE_A_NV + i, *input_arguments(getattr(given.final, name)))


def input_arguments(given):
    return (
        token(c.REGISTERS, given.register),
        token(c.MAPPINGS, given.mapping),
        token(c.USAGES, given.usage),
    )


def test_disabled_combiners_are_none_and_enabled_ones_the_initial_ones():
    gl = context()
    assert gl.state().register_combiners is None
    gl.Enable(t.REGISTER_COMBINERS_NV)
    assert gl.state().register_combiners == RegisterCombiners()


@settings(max_examples=60)
@given(register_combiners(max_stages=8, units=4))
def test_calls_give_the_combiners(expected):
    gl = context()
    gl.Enable(t.REGISTER_COMBINERS_NV)
    set_combiners(gl, expected)
    assert refusals(gl) == []
    assert gl.state().register_combiners == expected


BUMPS = """!!RC1.0
const0 = (0.5, 0.25, 0.75, 1.0);
{
  rgb {
    spare0 = expand(tex0) . expand(tex1);
    spare1 = unsigned(col0) * -half_bias(const0);
    scale_by_two();
  }
  alpha {
    discard = tex0.b * unsigned_invert(zero);
    discard = fog.b * zero;
    spare0 = sum();
    bias_by_negative_one_half();
  }
}
{
  rgb {
    col0 = spare0 * spare0.a;
    col1 = -spare1 * tex1;
    spare0 = mux();
  }
}
clamp_color_sum();
final_product = spare0 * col0;
out.rgb = lerp(fog.a, color_sum, fog) + final_product;
out.a = unsigned_invert(spare0.b);
"""


def test_calls_give_the_combiners_of_a_text():
    expected = rc.parse(BUMPS)
    assert rc.parse(format_program(expected)) == expected
    gl = context()
    gl.Enable(t.REGISTER_COMBINERS_NV)
    gl.CombinerParameteriNV(t.NUM_GENERAL_COMBINERS_NV, 2)
    gl.CombinerParameterfvNV(t.CONSTANT_COLOR0_NV, [0.5, 0.25, 0.75, 1.0])
    one, zero = (t.ZERO, t.UNSIGNED_INVERT_NV), (t.ZERO, t.UNSIGNED_IDENTITY_NV)
    first = [
        (t.RGB, "A", t.TEXTURE0, t.EXPAND_NORMAL_NV, t.RGB),
        (t.RGB, "B", t.TEXTURE1, t.EXPAND_NORMAL_NV, t.RGB),
        (t.RGB, "C", t.PRIMARY_COLOR_NV, t.UNSIGNED_IDENTITY_NV, t.RGB),
        (t.RGB, "D", t.CONSTANT_COLOR0_NV, t.HALF_BIAS_NEGATE_NV, t.RGB),
        (t.ALPHA, "A", t.TEXTURE0, t.SIGNED_IDENTITY_NV, t.BLUE),
        (t.ALPHA, "B", *one, t.ALPHA),
        (t.ALPHA, "C", t.FOG, t.SIGNED_IDENTITY_NV, t.BLUE),
        (t.ALPHA, "D", t.ZERO, t.SIGNED_IDENTITY_NV, t.ALPHA),
    ]
    second = [
        (t.RGB, "A", t.SPARE0_NV, t.SIGNED_IDENTITY_NV, t.RGB),
        (t.RGB, "B", t.SPARE0_NV, t.SIGNED_IDENTITY_NV, t.ALPHA),
        (t.RGB, "C", t.SPARE1_NV, t.SIGNED_NEGATE_NV, t.RGB),
        (t.RGB, "D", t.TEXTURE1, t.SIGNED_IDENTITY_NV, t.RGB),
        *[(t.ALPHA, name, *zero, t.ALPHA) for name in "ABCD"],
    ]
    for stage, inputs in ((t.COMBINER0_NV, first), (t.COMBINER1_NV, second)):
        for portion, name, *rest in inputs:
            gl.CombinerInputNV(stage, portion, getattr(t, f"VARIABLE_{name}_NV"), *rest)
    gone, half = t.DISCARD_NV, t.BIAS_BY_NEGATIVE_ONE_HALF_NV
    outputs = (
        (0, t.RGB, t.SPARE0_NV, t.SPARE1_NV, gone, t.SCALE_BY_TWO_NV, t.NONE, 1, 0, 0),
        (0, t.ALPHA, gone, gone, t.SPARE0_NV, t.NONE, half, 0, 0, 0),
        (1, t.RGB, t.PRIMARY_COLOR_NV, t.SECONDARY_COLOR_NV, t.SPARE0_NV, t.NONE, t.NONE, 0, 0, 1),
        (1, t.ALPHA, gone, gone, gone, t.NONE, t.NONE, 0, 0, 0),
    )
    for stage, *rest in outputs:
        gl.CombinerOutputNV(t.COMBINER0_NV + stage, *rest)
    final = (
        (t.FOG, t.UNSIGNED_IDENTITY_NV, t.ALPHA),
        (t.SPARE0_PLUS_SECONDARY_COLOR_NV, t.UNSIGNED_IDENTITY_NV, t.RGB),
        (t.FOG, t.UNSIGNED_IDENTITY_NV, t.RGB),
        (t.E_TIMES_F_NV, t.UNSIGNED_IDENTITY_NV, t.RGB),
        (t.SPARE0_NV, t.UNSIGNED_IDENTITY_NV, t.RGB),
        (t.PRIMARY_COLOR_NV, t.UNSIGNED_IDENTITY_NV, t.RGB),
        (t.SPARE0_NV, t.UNSIGNED_INVERT_NV, t.BLUE),
    )
    for i, arguments in enumerate(final):
        gl.FinalCombinerInputNV(t.VARIABLE_A_NV + i, *arguments)
    assert refusals(gl) == []
    assert gl.state().register_combiners == expected


def test_constants_of_a_stage_hold_where_they_are_enabled():
    gl = context()
    gl.Enable(t.REGISTER_COMBINERS_NV)
    gl.CombinerStageParameterfvNV(t.COMBINER0_NV, t.CONSTANT_COLOR1_NV, [0.5, 2.0, -1.0, 1.0])
    assert gl.state().register_combiners.general[0].constant_color1 is None
    gl.Enable(t.PER_STAGE_CONSTANTS_NV)
    stage = gl.state().register_combiners.general[0]
    assert (stage.constant_color0, stage.constant_color1) == ((0.0,) * 4, (0.5, 1.0, 0.0, 1.0))


STAGE, PLAIN = t.COMBINER0_NV, (t.SIGNED_NEGATE_NV, t.RGB)
OUTPUT, NONE = (t.SPARE0_NV, t.SPARE1_NV, t.DISCARD_NV), (t.NONE, t.NONE)
BIASED = (t.SCALE_BY_FOUR_NV, t.BIAS_BY_NEGATIVE_ONE_HALF_NV)


@pytest.mark.parametrize(
    ("name", "arguments", "kind"),
    [
        ("CombinerParameteriNV", (t.NUM_GENERAL_COMBINERS_NV, 9), t.INVALID_VALUE),
        ("CombinerParameteriNV", (t.FOG, 9), t.INVALID_ENUM),
        ("CombinerInputNV", (STAGE, t.RGB, t.VARIABLE_E_NV, t.ZERO, *PLAIN), t.INVALID_ENUM),
        ("CombinerInputNV", (STAGE, t.ALPHA, t.VARIABLE_A_NV, t.FOG, *PLAIN), t.INVALID_OPERATION),
        (
            "CombinerInputNV",
            (STAGE, t.RGB, t.VARIABLE_A_NV, t.FOG, t.SIGNED_NEGATE_NV, t.ALPHA),
            t.INVALID_OPERATION,
        ),
        ("CombinerOutputNV", (STAGE, t.RGB, *OUTPUT, *BIASED, 0, 0, 0), t.INVALID_OPERATION),
        ("CombinerOutputNV", (STAGE, t.ALPHA, *OUTPUT, *NONE, 1, 0, 0), t.INVALID_OPERATION),
        ("CombinerOutputNV", (STAGE + 8, t.RGB, *OUTPUT, *NONE, 0, 0, 0), t.INVALID_ENUM),
        ("FinalCombinerInputNV", (t.VARIABLE_A_NV, t.ZERO, *PLAIN), t.INVALID_OPERATION),
        ("Hint", (t.FOG, t.NICEST), t.INVALID_ENUM),
    ],
)
def test_errors_leave_the_state(name, arguments, kind):
    gl = context()
    before = dict(gl.values._of)
    gl.call("gl" + name, arguments)
    assert gl.GetError() == kind
    assert gl.values._of == before


def test_queries_of_combiners():
    gl = context()
    program = rc.parse(BUMPS)
    set_combiners(gl, program)
    general, rgb = t.COMBINER0_NV, program.general[0].rgb
    for name, table, value in (
        (t.COMBINER_INPUT_NV, c.REGISTERS, rgb.d.register),
        (t.COMBINER_MAPPING_NV, c.MAPPINGS, rgb.d.mapping),
        (t.COMBINER_COMPONENT_USAGE_NV, c.USAGES, rgb.d.usage),
    ):
        found = gl.GetCombinerInputParameterivNV(general, t.RGB, t.VARIABLE_D_NV, name)
        assert table[found] is value
    assert gl.GetCombinerOutputParameterivNV(general, t.RGB, t.COMBINER_AB_DOT_PRODUCT_NV) == 1
    scale = gl.GetCombinerOutputParameterivNV(general, t.RGB, t.COMBINER_SCALE_NV)
    bias = gl.GetCombinerOutputParameterivNV(general, t.ALPHA, t.COMBINER_BIAS_NV)
    assert c.SCALES[scale] is CombinerScale.SCALE_BY_TWO
    assert c.BIASES[bias] is CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF
    assert gl.GetFinalCombinerInputParameterivNV(t.VARIABLE_D_NV, t.COMBINER_INPUT_NV) == t.E_TIMES_F_NV
    assert gl.GetFloatv(t.CONSTANT_COLOR0_NV) == (0.5, 0.25, 0.75, 1.0)
    assert gl.GetIntegerv(t.NUM_GENERAL_COMBINERS_NV) == 2


# -------------------------------------------------------------------------------------------- texture shaders


def test_texture_shaders_are_those_of_the_same_program_as_text():
    expected = ts.parse(
        "!!TS1.0 texture_2d(); offset_2d_scale(tex0, 0.5, 0.25, -0.5, 1.0, 2.0, 0.125); "
        "cull_fragment(GEQUAL_TO_ZERO, LESS_THAN_ZERO, GEQUAL_TO_ZERO, GEQUAL_TO_ZERO);"
    )
    gl = context()
    gl.Enable(t.TEXTURE_SHADER_NV)
    assert gl.state().texture_shader == ()  # no unit has a texture
    shader = t.TEXTURE_SHADER_NV
    gl.TexEnvi(shader, t.SHADER_OPERATION_NV, t.TEXTURE_2D)
    gl.ActiveTexture(t.TEXTURE1)
    gl.TexEnvi(shader, t.SHADER_OPERATION_NV, t.OFFSET_TEXTURE_2D_SCALE_NV)
    gl.TexEnvi(shader, t.PREVIOUS_TEXTURE_INPUT_NV, t.TEXTURE0)
    gl.TexEnvfv(shader, t.OFFSET_TEXTURE_2D_MATRIX_NV, [0.5, 0.25, -0.5, 1.0])
    gl.TexEnvf(shader, t.OFFSET_TEXTURE_2D_SCALE_NV, 2.0)
    gl.TexEnvf(shader, t.OFFSET_TEXTURE_2D_BIAS_NV, 0.125)
    gl.ActiveTexture(t.TEXTURE2)
    gl.TexEnvi(shader, t.SHADER_OPERATION_NV, t.CULL_FRAGMENT_NV)
    gl.TexEnviv(shader, t.CULL_MODES_NV, [t.GEQUAL, t.LESS, t.GEQUAL, t.GEQUAL])
    assert refusals(gl) == []
    assert tuple([gl.values["texture shader", i] for i in range(4)]) == (*expected, TextureShaderStage())
    assert gl.GetTexEnviv(shader, t.CULL_MODES_NV) == (t.GEQUAL, t.LESS, t.GEQUAL, t.GEQUAL)
    gl.ActiveTexture(t.TEXTURE1)
    assert gl.GetTexEnvfv(shader, t.OFFSET_TEXTURE_MATRIX_NV) == (0.5, 0.25, -0.5, 1.0)
    assert gl.GetTexEnviv(shader, t.SHADER_OPERATION_NV) == t.OFFSET_TEXTURE_2D_SCALE_NV


def test_dot_products_of_texture_shaders():
    gl = context()
    gl.Enable(t.TEXTURE_SHADER_NV)
    gl.ActiveTexture(t.TEXTURE3)
    shader = t.TEXTURE_SHADER_NV
    gl.TexEnvi(shader, t.SHADER_OPERATION_NV, t.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP_NV)
    gl.TexEnvi(shader, t.RGBA_UNSIGNED_DOT_PRODUCT_MAPPING_NV, t.EXPAND_NORMAL_NV)
    gl.TexEnvfv(shader, t.CONST_EYE_NV, [0.25, 0.5, 1.0, 0.0])
    eye = ts.parse(
        "!!TS1.0 texture_2d(); "
        + "".join(
            f"dot_product_reflect_cube_map_const_eye_{i}of3(expand(tex0){', 0.25, 0.5, 1.0' * (i == 1)});"
            for i in (1, 2, 3)
        )
    )[3]
    assert gl.values["texture shader", 3] == replace(eye, previous_texture_input=0)
    gl.TexEnvi(shader, t.SHADER_OPERATION_NV, t.OFFSET_PROJECTIVE_TEXTURE_2D_NV)
    assert "NV_texture_shader3" in refusals(gl)[0][0]


def test_inconsistent_stages_of_texture_shaders_do_nothing():
    """Here the last reads the second, which reads the first, which has no texture."""
    gl = context()
    shader = t.TEXTURE_SHADER_NV
    textured(gl, 1, 2, 3)
    gl.Enable(shader)
    operations = (t.TEXTURE_2D, t.DEPENDENT_AR_TEXTURE_2D_NV, t.DEPENDENT_GB_TEXTURE_2D_NV, t.TEXTURE_2D)
    for unit, operation in enumerate(operations):
        gl.ActiveTexture(t.TEXTURE0 + unit)
        gl.TexEnvi(shader, t.SHADER_OPERATION_NV, operation)
        if unit in (1, 2):
            gl.TexEnvi(shader, t.PREVIOUS_TEXTURE_INPUT_NV, t.TEXTURE0 + unit - 1)
    none = TextureShaderOperation.NONE
    assert [stage.operation for stage in gl.state().texture_shader] == [
        *(none, none, none),
        TextureShaderOperation.TEXTURE_2D,
    ]
    textured(gl, 0)
    assert none not in [stage.operation for stage in gl.state().texture_shader]


# ------------------------------------------------------------------------------------------- depths and hints


def test_depth_clamping_is_to_the_depth_range():
    gl = context("GEFORCE_3")
    assert gl.state().depth_clamp is None
    gl.Enable(t.DEPTH_CLAMP_NV)
    assert gl.state().depth_clamp == DepthClamp()
    gl.DepthRange(0.75, 0.5)
    largest = 2**24 - 1
    found = gl.state().depth_clamp
    assert math.isclose(found.minimum, 0.5 * largest)
    assert math.isclose(found.maximum, 0.75 * largest)


@pytest.mark.parametrize(("profile", "corrects"), [("GEFORCE_3", False), ("GEFORCE_256", True)])
def test_a_machine_that_follows_the_hint_does_not_correct_for_perspective(profile, corrects):
    gl = context(profile)
    gl.Hint(t.PERSPECTIVE_CORRECTION_HINT, t.NICEST)
    assert gl.state().perspective_correction
    gl.Hint(t.PERSPECTIVE_CORRECTION_HINT, t.FASTEST)
    assert gl.state().perspective_correction is corrects
    assert gl.GetIntegerv(t.PERSPECTIVE_CORRECTION_HINT) == t.FASTEST
