"""The NV2A's register words: every program of the captures and random ones, dumps, errors."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.conformance.case import Inputs, MissingInput
from fixedpipe.effects.conformance.redraw import known_suites
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    DotProductMapping,
    Mapping,
    MuxSelect,
    Register,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Op
from fixedpipe.pipeline.notations.nv2a_registers import RegisterTextError, format_registers, parse
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.register_combiners import parse as parse_combiners
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import CombinerInput, FinalCombiner, RegisterCombiners, TextureShaderStage
from tests.reference import combine
from tests.support.combiner_strategies import register_combiners
from tests.support.text_errors import assert_says_where_and_what

TEXELS = st.tuples(*[st.integers(0, 255)] * 4)
NO_FOG = [3, 5, 7, 255]
CHIP = combine.machine_of(NV2A)


def check(combiners, seen, stages=None):
    """What is written reads back to what computes the same, and writes the same words."""
    words = format_registers(combiners, stages)
    read_stages, read, sources, notes = parse(words)
    assert format_registers(read, read_stages) == words
    assert all("matrix, scale and offset" in note for note in notes)
    assert len(sources.general) == len(combiners.general)
    for t0, t1, v0, v1 in seen:
        registers = [combine.initial_registers(v0, v1, (t0, t1, v1, v0), NO_FOG) for _ in range(2)]
        expected = combine.combine(combiners, registers[0], CHIP)
        assert combine.combine(read, registers[1], CHIP) == expected


@settings(max_examples=100)
@given(
    register_combiners(4, 4, per_stage_constants=True, flags=True),
    st.lists(st.tuples(TEXELS, TEXELS, TEXELS, TEXELS), min_size=2, max_size=2),
)
def test_random_combiners_read_back(combiners, seen):
    check(combiners, seen)


SEEN = [((200, 10, 128, 90), (0, 255, 127, 1), (30, 60, 250, 128), (9, 8, 7, 6))]


def programs_of(suites):
    """The distinct (combiners, texture shader) of the captures' frames of some suites."""
    found, inputs = {}, Inputs(Path("none"))
    for suite in suites:
        for name in suite.names():
            try:
                case = suite.case(name, inputs)
            except MissingInput:
                continue
            for command in case.commands if case is not None else ():
                state = command.state if isinstance(command, Draw) else None
                if state is not None and state.register_combiners is not None:
                    found[state.register_combiners, state.texture_shader] = name
    return found


def check_programs(suites):
    programs = programs_of(suites)
    for (combiners, stages), name in programs.items():
        written = any(stage.operation is not Op.NONE for stage in stages or ())
        try:
            check(combiners, SEEN, stages if written else None)
        except AssertionError as error:
            raise AssertionError(name) from error
        if written:
            read = parse(format_registers(combiners, stages))[0]
            assert [s.operation for s in read] == [_plain(s.operation) for s in stages][: len(read)], name
    return len(programs)


def _plain(operation):
    """An operation by the mode's word, which leaves 1D and rectangles to the texture."""
    return {
        Op.TEXTURE_1D: Op.TEXTURE_2D,
        Op.TEXTURE_RECTANGLE: Op.TEXTURE_2D,
        Op.OFFSET_TEXTURE_RECTANGLE: Op.OFFSET_TEXTURE_2D,
        Op.OFFSET_TEXTURE_RECTANGLE_SCALE: Op.OFFSET_TEXTURE_2D_SCALE,
        Op.DOT_PRODUCT_TEXTURE_RECTANGLE: Op.DOT_PRODUCT_TEXTURE_2D,
    }.get(operation, operation)


def test_the_programs_of_the_combiner_captures_read_back():
    suites = known_suites()
    assert check_programs([suites["Combiner"], suites["Fog"]]) > 40


@pytest.mark.slow
def test_every_capture_s_program_reads_back():
    assert check_programs(known_suites().values()) > 100


# ------------------------------------------------------------------------------------------------------ dumps

# What nxdk's samples set for a texture times the diffuse color, in several spellings.
WORDS = """NV097_SET_COMBINER_CONTROL = 0x00000101
NV097_SET_COMBINER_COLOR_ICW[0] = 0x08040000
NV097_SET_COMBINER_COLOR_OCW[0] = 0x000000c0
NV097_SET_COMBINER_ALPHA_ICW[0] = 0x18140000
NV097_SET_COMBINER_ALPHA_OCW[0] = 0x000000c0
NV097_SET_COMBINER_SPECULAR_FOG_CW0 = 0x0000000c
NV097_SET_COMBINER_SPECULAR_FOG_CW1 = 0x00001c80
"""
SPELLINGS = {
    "addresses": "0x1e60 0x101\n0xac0: 0x08040000\n0x1E40 = 0xC0\n0x0260 0x18140000\n0x0AA0 192\n"
    "0x288 0xC\n0x28c 0x1c80\n",
    "a trace": "nv2a: NV097_SET_TRANSFORM_PROGRAM (0xB00) 0x1234\n"
    "nv2a: NV097_SET_COMBINER_CONTROL (0x1E60) -> 0x101\n"
    "nv2a: NV097_SET_COMBINER_COLOR_ICW<0> (0x0AC0) -> 0x8040000\n"
    "nv2a: SET_COMBINER_COLOR_OCW(0) (0x1E40) -> 0xC0\n"
    "nv2a: SET_COMBINER_ALPHA_ICW[ 0 ] -> 0x18140000\nnv2a: SET_COMBINER_ALPHA_OCW -> 0xC0\n"
    "nv2a: SET_COMBINER_SPECULAR_FOG_CW0 -> 0xC, CW1 aside\nnv2a: SET_COMBINER_SPECULAR_FOG_CW1 -> 0x1c80\n"
    "nv2a: NV097_SET_BEGIN_END (0x17FC) 4\n",
    "Direct3D's names": "PSCombinerCount = 0x101\nPSRGBInputs[0] = 0x8040000\nPSRGBOutputs[0] = 0xC0\n"
    "PSAlphaInputs[0] = 0x18140000\nPSAlphaOutputs[0] = 0xC0\nPSFinalCombinerInputsABCD = 0xC\n"
    "PSFinalCombinerInputsEFG = 0x1C80\nPSFinalCombinerConstant1 = 0\n",
}


@pytest.mark.parametrize("text", SPELLINGS.values(), ids=SPELLINGS)
def test_dumps_are_read_as_they_are_written(text):
    program = parse_program(text)
    assert program.notations == ("NV2A registers",)
    assert program.combiners == parse_program(WORDS).combiners
    texts = "!!RC1.0\n{ rgb { spare0 = unsigned(tex0) * unsigned(col0); } alpha { spare0 = unsigned(tex0) * "
    texts += "unsigned(col0); } }\nclamp_color_sum(); out.rgb = spare0; out.a = spare0;\n"
    expected = parse_combiners(texts)
    for t0, t1, v0, v1 in SEEN:
        registers = [combine.initial_registers(v0, v1, (t0, t1), NO_FOG) for _ in range(2)]
        assert combine.combine(program.combiners, registers[0], CHIP) == combine.combine(
            expected, registers[1], CHIP
        )


def one_combiner(**words):
    """The first general combiner, and all of them, of a dump of these words."""
    given = {"SET_COMBINER_CONTROL": 0x101, "SET_COMBINER_SPECULAR_FOG_CW0": 0xC, **words}
    combiners = parse_program("".join(f"{name} = {word:#x}\n" for name, word in given.items())).combiners
    return combiners.general[0], combiners


# Bits of output words, as public headers of the chip's class give them, and what they stand for.
OUTPUT_BITS = {
    0x00082000: {"ab_dot_product": True, "ab_blue_to_alpha": True},  # DOTPRODUCT3 of the Xbox's runtime
    0x00041000: {"cd_dot_product": True, "cd_blue_to_alpha": True},
    0x00004000: {"mux_sum": True},
    0x00008000: {"bias": CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF},
    0x00010000: {"scale": CombinerScale.SCALE_BY_TWO},
    0x00018000: {"scale": CombinerScale.SCALE_BY_TWO, "bias": CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF},
    0x00020000: {"scale": CombinerScale.SCALE_BY_FOUR},
    0x00030000: {"scale": CombinerScale.SCALE_BY_ONE_HALF},
    0x0000000C: {"cd_output": Register.SPARE0},
    0x000000D0: {"ab_output": Register.SPARE1},
    0x00000900: {"sum_output": Register.TEXTURE1},
}


@pytest.mark.parametrize("word", OUTPUT_BITS)
def test_a_bit_of_an_output_word_is_what_public_headers_say(word):
    stage, _ = one_combiner(SET_COMBINER_COLOR_OCW=word)
    plain, _ = one_combiner(SET_COMBINER_COLOR_OCW=0)
    assert stage.rgb == replace(plain.rgb, **OUTPUT_BITS[word])


MAPPINGS = "UNSIGNED_IDENTITY UNSIGNED_INVERT EXPAND_NORMAL EXPAND_NEGATE HALF_BIAS_NORMAL HALF_BIAS_NEGATE"


def test_an_input_s_byte_is_mapping_alpha_and_register():
    for number, name in enumerate(f"{MAPPINGS} SIGNED_IDENTITY SIGNED_NEGATE".split()):
        stage, _ = one_combiner(SET_COMBINER_COLOR_ICW=(number << 5 | 0x18) << 8)
        assert stage.rgb.c == CombinerInput(Register.TEXTURE0, Mapping[name], ComponentUsage.ALPHA)
        stage, _ = one_combiner(SET_COMBINER_ALPHA_ICW=(number << 5 | 0x05) << 24)
        assert stage.alpha.a == CombinerInput(Register.SECONDARY_COLOR, Mapping[name], ComponentUsage.BLUE)


def test_flags_of_the_control_and_of_the_final_word():
    flags = ("color_sum_clamp", "invert_secondary_color", "invert_spare0")
    for word, set_ in ((0x80, flags[0]), (0x40, flags[1]), (0x20, flags[2]), (0, None)):
        _, combiners = one_combiner(SET_COMBINER_SPECULAR_FOG_CW1=word)
        assert [getattr(combiners, flag) for flag in flags] == [flag == set_ for flag in flags]
    assert one_combiner()[1].mux_select is MuxSelect.MSB
    assert one_combiner(SET_COMBINER_CONTROL=1)[1].mux_select is MuxSelect.LSB
    _, combiners = one_combiner(
        SET_COMBINER_SPECULAR_FOG_CW0=0x130C0300, SET_COMBINER_SPECULAR_FOG_CW1=0x1C80
    )
    assert combiners == replace(RegisterCombiners(), general=combiners.general, final=combiners.final)
    assert combiners.final == FinalCombiner(b=CombinerInput(Register.SPARE0))


def test_several_values_go_to_the_methods_after_the_first():
    two = "SET_COMBINER_CONTROL 0x102\nSET_COMBINER_COLOR_ICW: 0x08040000, 0x0c040000\n"
    two += "SET_COMBINER_COLOR_OCW: 0xc0 0xd0\nSET_COMBINER_FACTOR1[0] 0xff804020\n"
    combiners = parse_program(two).combiners
    first, second = combiners.general
    assert (first.rgb.a.register, second.rgb.a.register) == (Register.TEXTURE0, Register.SPARE0)
    assert second.rgb.ab_output is Register.SPARE1
    # One constant for all combiners, and another for the final one.
    assert first.constant_color1 == second.constant_color1 == (128 / 255, 64 / 255, 32 / 255, 1.0)
    assert combiners.constant_color1 == (0.0, 0.0, 0.0, 0.0)


def test_a_comment_is_no_value_and_another_method_s_value_no_address():
    text = (
        "SET_COMBINER_CONTROL = 0x101 ; line 5\nSET_COMBINER_COLOR_ICW[0] = 0x08040000 (stage 1 has none)\n"
    )
    dump = text + "NV097_SET_VIEWPORT_OFFSET = 0x1e40 0xc0\n0x1000 0x1e40 0xc0\n"
    assert parse_program(dump) == parse_program(text)
    assert parse_program(text).combiners.general[0].rgb.a.register is Register.TEXTURE0


def test_what_a_dump_leaves_out_is_said():
    program = parse_program("SET_COMBINER_COLOR_ICW[1] = 0x08040000\nSET_COMBINER_COLOR_OCW[1] = 0xc0\n")
    assert len(program.combiners.general) == 2
    assert program.notes == (
        "SET_COMBINER_CONTROL is not given: 2 general combiners are taken, with constants of each.",
        "the final combiner's words are not given: it is taken to give SPARE0.",
    )
    assert program.sources.general == ("", "lines 1, 2")


def test_a_final_combiner_whose_words_are_0_is_said():
    text = "SET_COMBINER_CONTROL = 0x11101\nSET_COMBINER_SPECULAR_FOG_CW0 = 0\n"
    (note,) = parse_program(text).notes
    assert note.startswith("both words of the final combiner are 0: it draws black, alpha 0.")
    assert parse_program(f"{text}SET_COMBINER_SPECULAR_FOG_CW1 = 0x1c80\n").notes == ()


def test_texture_shaders_have_words():
    stages = (
        TextureShaderStage(Op.TEXTURE_2D),
        TextureShaderStage(Op.DOT_PRODUCT, dot_product_mapping=DotProductMapping.SIGNED_HILO_HEMISPHERE),
        TextureShaderStage(Op.DOT_PRODUCT, 0, dot_product_mapping=DotProductMapping.SIGNED_ODD),
        TextureShaderStage(Op.DOT_PRODUCT_REFLECT_CUBE_MAP, 0, dot_product_mapping=DotProductMapping(1)),
    )
    words = format_registers(None, stages)
    assert "SET_SHADER_STAGE_PROGRAM = 0x00064621" in words and "SET_DOT_RGBMAPPING = 0x00000127" in words
    assert parse(words)[0] == stages
    dependent = (TextureShaderStage(Op.TEXTURE_2D),) * 2 + (
        TextureShaderStage(Op.DEPENDENT_GB_TEXTURE_2D, 1),
    )
    assert parse(format_registers(None, dependent))[0] == dependent


@pytest.mark.parametrize(
    ("text", "line", "column", "words"),
    [
        ("SET_COMBINER_CONTROL = 0x109\n", 1, 1, ["asks for 9 general combiners", "1 to 8"]),
        ("SET_COMBINER_CONTROL = 0x100\n", 1, 1, ["asks for 0 general combiners"]),
        ("\nSET_COMBINER_CONTROL = \n", 2, 22, ["has no value"]),
        ("SET_COMBINER_CONTROL = 0x123456789\n", 1, 24, ["no word of 32 bits"]),
        (f"SET_COMBINER_CONTROL = {'9' * 5000}\n", 1, 24, ["no word of 32 bits"]),
        ("SET_COMBINER_COLOR_ICW[8] = 0\n", 1, 26, ["words 0 to 7; word 8"]),
        ("SET_COMBINER_COLOR_ICW[999] = 0\n", 1, 28, ["words 0 to 7; word 999"]),
        ("SET_COMBINER_COLOR_ICW[0] = 0x07000000\n", 1, 1, ["names register 7"]),
        ("SET_COMBINER_COLOR_OCW[0] = 0x00038000\n", 1, 1, ["the operation 7"]),
        ("SET_COMBINER_COLOR_OCW[0] = 0x00000ccc\n", 1, 1, ["both write SPARE0"]),
        ("SET_SHADER_STAGE_PROGRAM = 0x1f\n", 1, 1, ["texture unit 0 has mode 31"]),
        ("SET_SHADER_STAGE_PROGRAM = 0x220\nSET_DOT_RGBMAPPING = 5\n", 2, 1, ["texture unit 1 maps by 5"]),
    ],
)
def test_an_error_says_where_and_what(text, line, column, words):
    assert_says_where_and_what(RegisterTextError, parse_program, text, line, column, words)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ((RegisterCombiners(general=()),), "1 to 8 general combiners; there are 0"),
        ((None, (TextureShaderStage(Op.NONE), TextureShaderStage(Op.DOT_PRODUCT, 1))), "reads unit 1"),
        ((None, (TextureShaderStage(Op.TEXTURE_2D, roughness=0),)), "none that the NV2A"),
    ],
)
def test_what_has_no_words_is_refused(given, words):
    with pytest.raises(ValueError, match=words):
        format_registers(*given)
