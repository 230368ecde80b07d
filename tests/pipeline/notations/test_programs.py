"""Whole programs: which notation a text is in, texts of two notations, hostile texts, the command line."""

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.cli import main
from fixedpipe.pipeline.description.describe import describe_program
from fixedpipe.pipeline.enums import TextureShaderOperation as Op
from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.notations.pixel_shader_translation import parse as parse_shader
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.notations.register_combiners import parse as parse_combiners
from fixedpipe.pipeline.notations.texture_shaders import parse as parse_stages
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from tests.support.combiner_strategies import register_combiners
from tests.support.program_strategies import mutated, pixel_shaders, texture_shaders

RC = "!!RC1.0\nout.rgb = tex0;\nout.a = tex0;\n"
TS = "!!TS1.0\ntexture_cube_map();\nnop();\npass_through();\n"
PS = "ps.1.1\ntex t0\ntexbem t1, t0\nmul r0, t1, c3\n"


def test_the_header_says_which_notation():
    assert parse_program(RC).notations == ("!!RC1.0",)
    assert parse_program(RC).combiners == parse_combiners(RC)
    assert parse_program(RC).texture_shader is None
    assert parse_program(TS).notations == ("!!TS1.0",)
    assert parse_program(TS).combiners is None
    assert parse_program(PS).notations == ("ps.1.1",)
    assert parse_program(PS).combiners == parse_shader(PS).combiners


def test_the_targets_that_stages_read_are_recorded():
    assert parse_program(TS).targets == (TextureTarget.TEXTURE_CUBE_MAP, None, None)
    assert parse_program(PS).targets == (TextureTarget.TEXTURE_2D,) * 2
    assert parse_program(PS, {0: TextureTarget.TEXTURE_3D}).texture_shader[0].operation is Op.TEXTURE_3D


@pytest.mark.parametrize(
    "text", [TS + RC, RC + TS, "// by a compiler\n" + TS + "// End of program\n\n " + RC]
)
def test_texture_shaders_and_combiners_in_one_text(text):
    program = parse_program(text)
    assert set(program.notations) == {"!!TS1.0", "!!RC1.0"}
    assert program.texture_shader == parse_stages(TS)
    assert program.combiners == parse_combiners(RC)


@pytest.mark.parametrize("before", ["", "\n\n", "  ", "// a comment\n", "; a comment\n", "# a\n/* b\n */ "])
@pytest.mark.parametrize("text", [RC, TS, PS])
def test_what_may_precede_a_header(before, text):
    assert parse_program(before + text) == parse_program(text)


@pytest.mark.parametrize(
    ("text", "line", "column", "words"),
    [
        ("", 1, 1, "text ends where the header"),
        ("\n\n  out.rgb = col0;", 3, 3, "found 'out.rgb = col0;'"),
        ("!!ARBfp1.0\nEND", 1, 1, "!!RC1.0, !!TS1.0, ps.1.1 or xps.1.1"),
        (RC + RC, 4, 1, "a second !!RC1.0"),
        (TS + "!!RC1.0\nout.rgb = tex9;", 6, 11, "found 'tex9'"),
        ("// one\n// two\nps.1.1\nmov r0, x", 4, 9, "found 'x'"),
        ("\n  /* */ ps.1.1 mov r0, x", 2, 24, "found 'x'"),
    ],
)
def test_errors_count_lines_from_the_beginning_of_the_text(text, line, column, words):
    with pytest.raises(ProgramTextError, match=words) as caught:
        parse_program(text)
    assert (caught.value.line, caught.value.column) == (line, column)


ANY_TEXT = st.one_of(
    pixel_shaders(),
    texture_shaders(),
    register_combiners(max_stages=2, units=4, per_stage_constants=True).map(format_program),
    st.just(TS + RC),
)


@settings(max_examples=150)
@given(mutated(ANY_TEXT))
def test_a_spoiled_program_is_a_program_or_an_error_of_the_notation(text):
    check_spoiled(text)


@pytest.mark.slow
@settings(max_examples=3000)
@given(mutated(ANY_TEXT))
def test_many_spoiled_programs_are_programs_or_errors_of_the_notation(text):
    check_spoiled(text)


def check_spoiled(text):
    try:
        program = parse_program(text)
    except ProgramTextError as error:
        assert 1 <= error.line <= text.count("\n") + 1 and error.column >= 1
        assert str(error).endswith(".")
    else:
        assert describe_program(program.texture_shader, program.combiners)


# --------------------------------------------------------------------------------------- command line


def run(*arguments, given=None):
    return CliRunner().invoke(main, ["combiners", *map(str, arguments)], input=given)


def test_a_pixel_shader_is_printed_as_equations(tmp_path):
    path = tmp_path / "bump.psh"
    path.write_text(
        "ps.1.1\r\ntex t0\r\ntexbem t1, t0 ; \xe9\r\nmad_x2 r0, t1, 1-v0, c3\r\n", encoding="latin-1"
    )
    result = run(path, "--profile", "GEFORCE_3")
    assert result.exit_code == 0, result.output
    assert result.stdout == (
        "ps.1.1, on GeForce 3: 1 of 8 general combiners, at most 1 of 2 constants in one, 2 of 4 texture "
        "units\n\n"
        "TEXTURE_SHADER enabled\n"
        "  stage 0 (line 2: tex): tex0 = TEXTURE_2D(s0/q0, t0/q0)\n"
        "  stage 1 (line 3: texbem): tex1 = TEXTURE_2D((s1, t1) + [1 0 | 0 1] (tex0's ds, dt))\n"
        "REGISTER_COMBINERS enabled\n"
        "  GC0: const0 = c3, set by the application (0, 0, 0, 0), bytes 0 0 0 0\n"
        "  GC0.rgb (line 4: mad): spare0 = 2 * (tex1 * (1 - col0) + const0), clamped to [-1, 1]\n"
        "  GC0.alpha (line 4: mad): spare0.a = 2 * (tex1.a * (1 - col0.a) + const0.a), clamped to [-1, 1]\n"
        "  final.rgb (r0, with fog): out.rgb = fog.a * spare0 + (1 - fog.a) * fog\n"
        "  final.alpha (r0, with fog): out.a = spare0.a\n"
    )


def test_every_notation_is_read_from_standard_input():
    for text in (RC, TS, PS, TS + RC):
        result = run("-", given=text)
        assert result.exit_code == 0, result.output
        assert result.stdout.startswith(" and ".join(parse_program(text).notations))


def test_any_program_can_be_printed_as_text():
    printed = run("-", "--rc", given=PS).stdout
    assert parse_program(printed).combiners == parse_program(PS).combiners
    assert parse_program(printed).texture_shader == parse_program(PS).texture_shader


def test_bound_textures_may_be_said():
    text = "ps.1.1\ntex t0\nmov r0, t0\n"
    assert "TEXTURE_CUBE_MAP(s0, t0, r0)" in run("-", "--target", "0=TEXTURE_CUBE_MAP", given=text).stdout


@pytest.mark.parametrize(
    ("arguments", "given", "words"),
    [
        (["-"], "ps.1.1\nmov r0, t9\n", "standard input, line 2, column 9: found 't9'"),
        (["-"], "", "the text ends where the header belongs"),
        (["no/such/file"], None, "cannot be read"),
        (["-", "--profile", "GEFORCE_256"], PS, "GeForce 256 has no texture shaders"),
        (
            ["-", "--profile", "GEFORCE_256"],
            "ps.1.1\n" + "mov r0, v0\n" * 3,
            "GeForce 256 has 2 general combiners",
        ),
        (["-", "--profile", "OPENGL_1_2"], RC, "no register combiners"),
        (["-", "--profile", "VOODOO"], RC, "There is no profile 'VOODOO'"),
        (["-", "--target", "0"], PS, "write --target 1=TEXTURE_CUBE_MAP"),
        (["-", "--target", "0=CUBE"], PS, "There is no texture target 'CUBE'"),
        (["-", "--target", "1=TEXTURE_3D"], PS, "texbem of a TEXTURE_3D"),
    ],
)
def test_what_cannot_be_done_is_one_sentence_and_status_2(arguments, given, words):
    result = run(*arguments, given=given)
    assert result.exit_code == 2
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith("fixedpipe: ") and words in line, line
