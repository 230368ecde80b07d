"""``fixedpipe combiners``: lines, constants, clamps, JSON, the table, refusals in the text's own words."""

import json

import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.pipeline import parse_program
from fixedpipe.pipeline.profiles import NV2A
from tests.reference import combine, pixel_shader
from tests.support.pixel_shaders import CHIP

SHADER = """ps.1.1
def c0, 0, -1, 1, 1
tex t0
tex t1
lrp r0.rgb, t0.a, c0, c1
+ mul r0.a, t0, v0
dp3_sat r1, t1_bx2, v0_bx2
mad_x2 r0, r0, r1, -t1
"""
COMBINERS = """!!RC1.0
const0 = (0.5, 0.25, 0, 1);
{
  rgb { spare0 = tex0 . col0; }
}
{ alpha { discard = tex0; discard = -one; spare1 = sum(); } }
out.rgb = spare0;
"""


def run(*arguments, given=None):
    return CliRunner().invoke(main, ["combiners", *map(str, arguments)], input=given)


def lines_of(*arguments, given):
    result = run("-", *arguments, given=given)
    assert result.exit_code == 0, result.output
    return result.stdout.splitlines()


def test_equations_name_their_lines_and_constants_what_they_are():
    lines = lines_of("--constant", "1=0.2,0.4,0.6,0.8", given=SHADER)
    assert "  stage 1 (line 4: tex): tex1 = TEXTURE_2D(s1/q1, t1/q1)" in lines
    assert (
        "  GC0: const0 = c0 (0, -1, 1, 1), stored (0.502, 0.001961, 1.002, 1), bytes 128 1 255 255" in lines
    )
    assert "  GC0: const1 = c1, set by the application (0.2, 0.4, 0.6, 0.8), bytes 51 102 153 204" in lines
    assert any(line.startswith("  GC0.rgb (line 5: lrp + mul): spare0 = sat(tex0.a) *") for line in lines)
    assert "  GC1.rgb (line 7: dp3): spare1 = expand(tex1) . expand(col0), clamped to [-1, 1]" in lines
    assert any("(line 8: mad): spare0 = 2 * (spare0 * sat(spare1) - tex1), clamped" in line for line in lines)
    assert "  GC0.alpha (line 5: lrp + mul): spare0.a = tex0.a * col0.a" in lines  # no clamp can bite


def test_combiners_name_their_lines_and_what_they_leave_unset():
    lines = lines_of(given=COMBINERS)
    assert lines[0] == "!!RC1.0: 2 general combiners"
    assert "  const0 = (0.5, 0.25, 0, 1), bytes 128 64 0 255" in lines
    assert "  GC0.rgb (lines 3 to 5): spare0 = tex0 . col0, clamped to [-1, 1]" in lines
    assert "  GC1.alpha (line 6): spare1.a = tex0.a - 1" in lines
    assert "  final.alpha (line 7): out.a = 0, which the program leaves unset" in lines


def test_one_minus_a_value_reads_as_a_subtraction_and_blue_to_alpha_as_one_step():
    text = "ps.1.1\ntex t0\nsub r0, t0, 1-v0\n"
    assert any("spare0 = tex0 - (1 - col0)" in line for line in lines_of(given=text))
    slots = "ps.1.1\ntex t0\n" + "mov r1, t0\n" * 6 + "dp3 r0, t0_bx2, v0_bx2\ncnd r0, r0.a, t0, v0\n"
    lines = [line for line in lines_of(given=slots) if line.startswith("  GC6")]
    assert lines == [
        "  GC6.rgb (line 9: dp3): spare0 = expand(tex0) . expand(col0), clamped to [-1, 1], and spare0.a = "
        "its "
        "blue"
    ]


def test_what_a_program_takes_of_a_machine_is_said():
    first = lines_of("--profile", "NV2A", given=SHADER)[0]
    assert first == (
        "ps.1.1, on NV2A: 3 of 8 general combiners, at most 2 of 2 constants in one, 2 of 4 texture units"
    )


XBOX = "xps.1.1\ntex t0\nxmma discard, discard, r0, t0, c9, v0, c3\nxfc prod, r0, c3, zero, fog.a, v1, r0.a\n"


def test_an_xbox_program_is_told_with_its_lines_and_constants():
    lines = lines_of("--profile", "NV2A", "--constant", "9=0.2,0.4,0.6,0.8", given=XBOX)
    assert lines[0].startswith("xps.1.1, on NV2A: 1 of 8 general combiners, at most 2 of 2 constants in one")
    assert any("GC0: const0 = c9, set by the application (0.2, 0.4, 0.6, 0.8)" in line for line in lines)
    assert any("  const0 = c3, set by the application" in line for line in lines)
    assert any("GC0.rgb (line 3: xmma): spare0 = tex0 * const0 + col0 * const1" in line for line in lines)
    assert any("final.rgb (line 4: xfc)" in line for line in lines)
    words = lines_of("--nv2a", given=XBOX)
    assert "NV097_SET_COMBINER_COLOR_ICW[0] = 0xc8c1c4c2" in words
    assert lines_of("--rc", given=XBOX)[0] == "!!TS1.0"
    bounds = lines_of("--profile", "NV2A", "--bounds", given=XBOX)
    assert any(line.startswith("final combiner") for line in bounds)
    assert any("final_product" in line for line in lines_of("--profile", "NV2A", "--table", given=XBOX))


def test_a_machine_without_constants_of_each_combiner_holds_two_in_all():
    shader = "ps.1.1\ndef c0, 0.2, 0.4, 0.6, 1\nmul r0, v0, c0\nmad r0, r0, c5, c0\n"
    lines = lines_of("--profile", "GEFORCE_256", given=shader)
    assert lines[0] == "ps.1.1, on GeForce 256: 2 of 2 general combiners, 2 of 2 constants in all"
    assert "  const0 = c0 (0.2, 0.4, 0.6, 1), bytes 51 102 153 255" in lines
    assert "  const1 = c5, set by the application (0, 0, 0, 0), bytes 0 0 0 0" in lines


def test_json_has_the_state_the_lines_and_the_constants(tmp_path):
    path = tmp_path / "program.json"
    assert run("-", "--json", path, given=SHADER).exit_code == 0
    found = json.loads(path.read_text())
    assert found["notations"] == ["ps.1.1"]
    assert found["texture_shader"][0]["operation"] == "TEXTURE_2D"
    assert found["combiners"]["general"][0]["rgb"]["a"] == {
        "register": "TEXTURE0",
        "mapping": "UNSIGNED_IDENTITY",
        "usage": "ALPHA",
        "meaning": "SATURATED",
    }
    assert found["sources"]["general"] == ["line 5: lrp + mul", "line 7: dp3", "line 8: mad"]
    assert found["constants"][0]["color"] == [0, -1, 1, 1]
    assert [c["set_by_the_application"] for c in found["constants"]] == [False, True]


def test_the_table_ends_at_what_direct3d_defines():
    inputs = {"t0": (200, 10, 20, 128), "t1": (90, 200, 128, 7), "v0": (30, 40, 250, 60)}
    options = [f"--input={name}={','.join(map(str, color))}" for name, color in inputs.items()]
    shader = SHADER.replace("c1\n", "v0\n")
    lines = lines_of("--profile", "NV2A", "--table", *options, given=shader)
    expected = pixel_shader.evaluate(
        shader, (inputs["t0"], inputs["t1"], [0] * 4, [0] * 4), inputs["v0"], [0] * 4, CHIP
    )
    (color,) = [line for line in lines if line.startswith("    = color")]
    assert [int(code) for code in color.split()[2:6]] == expected
    assert any(line.startswith("    general combiner 0, RGB portion: spare0 = sat(tex0.a)") for line in lines)
    registers = combine.initial_registers(inputs["v0"], [0] * 4, (inputs["t0"], inputs["t1"]), [0, 0, 0, 255])
    assert combine.combine(parse_program(shader).combiners, registers, combine.machine_of(NV2A)) == expected


@pytest.mark.parametrize(
    ("arguments", "given", "words"),
    [
        (["--profile", "GEFORCE_256"], "ps.1.1\n" + "mov r0, v0\n" * 3, "too many is line 4: mov."),
        (["--profile", "GEFORCE_256"], COMBINERS.replace("tex0 .", "tex3 ."), "(lines 3 to 5) names tex3"),
        (
            ["--profile", "GEFORCE_256"],
            "ps.1.1\nmul r0, v0, c0\nmad r0, r0, c1, c2\n",
            "line 3, column 1: the color of c2 is the third of 3 constants that the program reads",
        ),
        (["--constant", "16=1,1,1,1"], SHADER, "write --constant 1=0.5,0.5,0.5,1"),
        (["--constant", "9=1,1,1,1"], SHADER, "the program reads no c9"),
        (["--constant", "1=1,1,1"], SHADER, "write --constant 1=0.5,0.5,0.5,1"),
        (["--constant", "1=inf,1,1,1"], SHADER, "write --constant 1=0.5,0.5,0.5,1"),
        (["--constant", "1=1,1,1,1", "--constant", "1=0,0,0,0"], SHADER, "c1 twice"),
        (["--constant", "5=1,1,1,1"], SHADER, "the program reads no c5"),
        (["--constant", "1=1,1,1,1"], COMBINERS, "a pixel shader alone does not"),
        (["--table"], SHADER, "--table is of a machine's numbers; give --profile"),
        (["--input", "t0=1"], SHADER, "--input gives --table its values; give --table too."),
        (["--table", "--profile", "NV2A", "--input", "t9=1"], SHADER, "write --input t0=255,128,0,255"),
        (["--table", "--profile", "NV2A", "--input", "t0=256"], SHADER, "whole numbers from 0 to 255"),
        (["--table", "--profile", "NV2A", "--input", "t0=1", "--input", "t0=2"], SHADER, "t0 twice"),
        (["--table", "--profile", "NV2A"], "!!TS1.0\ntexture_2d();\n", "texture shaders alone"),
        (
            ["--json", "x.json", "--bounds", "--profile", "NV2A"],
            SHADER,
            "--json writes only what the program sets",
        ),
        (
            ["--table", "--profile", "GEFORCE_256", "--input", "t3=1"],
            COMBINERS,
            "GeForce 256 has 2 texture units",
        ),
        ([], "#define X t0\nps.1.1\nmov r0, X\n", "found '#define', a preprocessor directive"),
    ],
)
def test_what_cannot_be_done_is_said_in_the_text_s_own_words(arguments, given, words):
    result = run("-", *arguments, given=given)
    assert result.exit_code == 2, result.output
    assert words in result.stderr, result.stderr
    assert "Traceback" not in result.output


# ----------------------------------------------------------------------------------------------- dumps

TWO_DRAWS = """0x97 -> NV097_SET_COMBINER_CONTROL<0x1e60> (0x1)
0x97 -> NV097_SET_BEGIN_END<0x17fc> (0x5)
0x97 -> NV097_SET_COMBINER_CONTROL<0x1e60> (0x2)
0x97 -> NV097_SET_BEGIN_END<0x17fc> (0x5)
"""


def test_a_trace_of_several_draws_says_so_and_has_each():
    assert (
        "note: the text has 2 draws (SET_BEGIN_END): the words before draw 2 are taken; give the number of"
        in (run("-", given=TWO_DRAWS).stdout)
    )
    assert run("-", "--draw", 1, given=TWO_DRAWS).stdout.startswith("NV2A registers: 1 general combiner\n")
    assert run("-", given=TWO_DRAWS).stdout.startswith("NV2A registers: 2 general combiners\n")
    # What is printed as another notation has no notes, so they stand beside it.
    assert "has 2 draws" in run("-", "--rc", given=TWO_DRAWS).stderr
    assert "has draws 1 to 2; draw 3 is asked for" in run("-", "--draw", 3, given=TWO_DRAWS).stderr
    assert "--draw would be ignored" in run("-", "--draw", 1, given=SHADER).stderr


@pytest.mark.parametrize(
    "data",
    [
        SHADER.encode("utf-16"),
        b"\xfe\xff" + SHADER.encode("utf-16-be"),
        SHADER.encode() + b"\0",
        SHADER.replace("\n", "\r\n").encode() + b"\x1a",
        b"// Gr\xfc\xdfe\n" + SHADER.encode(),
    ],
    ids=["UTF-16", "UTF-16, big end first", "a string of C", "of DOS", "Latin-1 in a comment"],
)
def test_a_text_is_read_as_it_was_saved(data):
    plain = run("-", given=SHADER).stdout
    result = run("-", given=data)
    assert result.exit_code == 0, result.output
    assert [line.split(":")[-1] for line in result.stdout.splitlines()] == [
        line.split(":")[-1] for line in plain.splitlines()
    ]


def test_utf_16_without_its_mark_is_named():
    for encoding in ("utf-16-le", "utf-16-be"):
        result = run("-", given=SHADER.encode(encoding))
        assert result.exit_code == 2 and "the text is in UTF-16" in result.stderr
