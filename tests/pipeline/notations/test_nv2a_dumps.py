"""Dumps of the NV2A's registers as emulators, samples and games write them: the words, or a refusal."""

import random

import pytest

from fixedpipe.pipeline.notations.nv2a_dumps import COUNTS, METHODS, RegisterTextError, is_dump, read_dump
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from tests.support.text_errors import assert_says_where_and_what

ICW, OCW = "SET_COMBINER_COLOR_ICW", "SET_COMBINER_COLOR_OCW"
TRACE = "nv2a_pgraph_method 0: 0x97 -> "


CONTROL = ("SET_COMBINER_CONTROL", 0)


def words(text, **given):
    return read_dump(text, **given).words


# --------------------------------------------------------------------------------------------- forms

WORDS = {
    ("SET_COMBINER_CONTROL", 0): 0x11002,
    (ICW, 0): 0x08040000,
    (ICW, 1): 0x0C050000,
    (OCW, 0): 0xC0,
    (OCW, 1): 0xC0,
    ("SET_COMBINER_FACTOR0", 1): 0x1A7AD5DC,
    ("SET_SPECULAR_FOG_FACTOR", 1): 0xFF,
}
ADDRESSES = {name: address for name, address, _, _ in METHODS}
DIRECT3D = {name: word for name, _, _, word in METHODS}


def _bracket(name, k):
    return f"[{k}]" if COUNTS[name] > 1 else ""


def _state(name, k):
    """The render state of a word: D3DRS_PSCONSTANT0_1, D3DRS_PSRGBINPUTS1, D3DRS_PSCOMBINERCOUNT."""
    number = "" if COUNTS[name] == 1 else f"_{k}" if DIRECT3D[name].startswith("PSConstant") else str(k)
    return f"D3DRS_{DIRECT3D[name].upper()}{number}"


FORMS = {
    "xemu, offsets in bytes": lambda n, k, w: (
        f"{TRACE}0x{ADDRESSES[n] + 4 * k:04x} NV097_{n}{_bracket(n, 4 * k)} {w:#x}"
    ),
    "xemu, names and addresses": lambda n, k, w: (
        f"{TRACE}NV097_{n}{_bracket(n, k)}<{ADDRESSES[n] + 4 * k:#x}> ({w:#X} {{A: 1, B: 2}} <{w:#x}>)"
    ),
    "xemu, the class by name": lambda n, k, w: (
        f"nv2a: NV20_KELVIN_PRIMITIVE<0x97> -> NV097_{n}{_bracket(n, k)}<{ADDRESSES[n] + 4 * k:#X}> ({w} <1>)"
    ),
    "xqemu": lambda n, k, w: f"{TRACE}0x{ADDRESSES[n] + 4 * k:04x} ({w:#x})",
    "the address alone says which": lambda n, k, w: f"NV097_{n} ({ADDRESSES[n] + 4 * k:#x}) -> {w:#x}",
    "pbkit": lambda n, k, w: f"    p = pb_push1(p, NV097_{n} + {k} * 4, 0x{w:08x});",
    "pbkit, the sum done": lambda n, k, w: f"p=pb_push1_to(SUB,p,NV097_{n}+{4 * k:#x},{w}u);  // word {k}",
    "pbkit, over lines": lambda n, k, w: (
        f"pb_push1(p, NV097_{n} + {k} * 4,\n    ({w >> 16:#x} << 16)\n  | {w & 0xFFFF});"
    ),
    "a structure": lambda n, k, w: f"psd.{DIRECT3D[n]}{_bracket(n, k)} = {w:#x}UL; /* {n} = 7 */",
    "a structure, over lines": lambda n, k, w: f"  shader->{DIRECT3D[n]}{_bracket(n, k)} =\n    {w};",
    "render states": lambda n, k, w: f"device->SetRenderState( {_state(n, k)}, {w:#x} );",
    "render states over lines": lambda n, k, w: f"SetRenderState(\n  {_state(n, k)},\n  {w:#x} );",
    "an array of states": lambda n, k, w: f"g_D3DRenderState[X_{_state(n, k)}] = {w};",
    "numbered names": lambda n, k, w: f"NV097_{n}{f'_{k}' if COUNTS[n] > 1 else ''}: {w:#x}",
    "JSON": lambda n, k, w: f'  "NV097_{n}{_bracket(n, k)}": "{w:#x}",',
    "CSV": lambda n, k, w: f"151,{ADDRESSES[n] + 4 * k:#x},{w}",
}


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_a_form_gives_the_words(form):
    text = "\n".join(form(*method, word) for method, word in WORDS.items())
    assert words(text) == WORDS
    # And in any order, of any values, each for itself.
    chance = random.Random(0)
    for _ in range(20):
        given = {(n, k): chance.getrandbits(32) for n, _, count, _ in METHODS for k in range(count)}
        lines = [form(*method, word) for method, word in given.items()]
        chance.shuffle(lines)
        assert words("\r\n".join(lines).replace("\r", "")) == given


MASKED = """p = pb_push1(p, NV097_SET_COMBINER_COLOR_ICW + 0 * 4,
    MASK(NV097_SET_COMBINER_COLOR_ICW_A_SOURCE, 0x8) | XGU_MASK(NV097_SET_COMBINER_COLOR_ICW_A_MAP, 0x6)
    | MASK(NV097_SET_COMBINER_COLOR_ICW_B_SOURCE, 0x4) | MASK(NV097_SET_COMBINER_COLOR_ICW_B_ALPHA, 1));
p = pb_push1(p, NV097_SET_COMBINER_COLOR_OCW + 0 * 4, MASK(NV097_SET_COMBINER_COLOR_OCW_AB_DST, 0xc)
    | MASK(NV097_SET_COMBINER_COLOR_OCW_OP, NV097_SET_COMBINER_COLOR_OCW_OP_SHIFTLEFTBY1));
pb_push1(p, NV097_SET_COMBINER_CONTROL,
    MASK(NV097_SET_COMBINER_CONTROL_FACTOR0, NV097_SET_COMBINER_CONTROL_FACTOR0_EACH_STAGE)
    | MASK(NV097_SET_COMBINER_CONTROL_ITERATION_COUNT, 2));
pb_push1(p, NV097_SET_SHADER_STAGE_PROGRAM,
    MASK(NV097_SET_SHADER_STAGE_PROGRAM_STAGE1, NV097_SET_SHADER_STAGE_PROGRAM_STAGE1_CUBE_MAP));
"""
SYMBOLIC = """
psd.PSCombinerCount = PS_COMBINERCOUNT(2, PS_COMBINERCOUNT_MUX_MSB | PS_COMBINERCOUNT_UNIQUE_C1);
psd.PSTextureModes = PS_TEXTUREMODES(PS_TEXTUREMODES_PROJECT2D, PS_TEXTUREMODES_CUBEMAP, 0,
    PS_TEXTUREMODES_DOT_ST);
psd.PSRGBInputs[0] = PS_COMBINERINPUTS(
    PS_REGISTER_T0 | PS_CHANNEL_RGB | PS_INPUTMAPPING_EXPAND_NORMAL,   // the map
    PS_REGISTER_C0 | PS_CHANNEL_ALPHA,
    PS_REGISTER_ONE, PS_REGISTER_NEGATIVE_ONE_HALF);
psd.PSRGBOutputs[0] = PS_COMBINEROUTPUTS(PS_REGISTER_R0, PS_REGISTER_DISCARD, PS_REGISTER_R1,
    PS_COMBINEROUTPUT_AB_DOT_PRODUCT | PS_COMBINEROUTPUT_SHIFTLEFT_1);
psd.PSDotMapping = PS_DOTMAPPING(0, PS_DOTMAPPING_MINUS1_TO_1_D3D, PS_DOTMAPPING_HILO_1,
    PS_DOTMAPPING_MINUS1_TO_1);
psd.PSInputTexture = PS_INPUTTEXTURE(0, 0, 1, 2);
psd.PSCompareMode = PS_COMPAREMODE(PS_COMPAREMODE_S_GE | PS_COMPAREMODE_Q_GE, 0, PS_COMPAREMODE_R_GE, 0);
psd.PSConstant0[1] = D3DCOLOR_RGBA(1, 2, 3, 4);
"""


def test_the_names_of_nxdk_and_of_direct3d_have_their_bits():
    assert words(MASKED) == {
        (ICW, 0): 0xC8140000,
        (OCW, 0): 0x000100C0,
        ("SET_COMBINER_CONTROL", 0): 0x1002,
        ("SET_SHADER_STAGE_PROGRAM", 0): 3 << 5,
    }
    assert words(SYMBOLIC) == {
        ("SET_COMBINER_CONTROL", 0): 0x10102,
        ("SET_SHADER_STAGE_PROGRAM", 0): 1 | 3 << 5 | 9 << 15,
        (ICW, 0): 0x48112080,
        (OCW, 0): 0x12DC0,
        ("SET_DOT_RGBMAPPING", 0): 0x341,
        ("SET_SHADER_OTHER_STAGE_INPUT", 0): 0x210000,
        ("SET_SHADER_CLIP_PLANE_MODE", 0): 0x409,
        ("SET_COMBINER_FACTOR0", 1): 0x04010203,
    }


@pytest.mark.parametrize(
    ("expression", "word"),
    [
        ("(4u << 24) | (1u << 21)", 0x04200000),
        ("((0xc)) << 4 | 1", 0xC1),
        ("( 0x5 )", 5),
        ("~0u & 0xFF | 1 << 8 ^ 3", 0x1FF & ~0x100 | (1 << 8 ^ 3)),
        ("2 + 3 * 4", 14),
        ("1 << 2 + 1", 8),
    ],
)
def test_an_expression_is_c_s(expression, word):
    assert words(f"pb_push1(p, NV097_SET_COMBINER_CONTROL, {expression});") == {CONTROL: word}
    assert words(f"SET_COMBINER_CONTROL = {expression}") == {CONTROL: word}


@pytest.mark.parametrize(
    "line",
    [
        "PSRGBInputs[0] = 5; PSRGBOutputs[1] = 0xc0;",
        f"p = pb_push1(p, NV097_{ICW}, 5); p = pb_push1(p, NV097_SET_LIGHT, 9); f(NV097_{OCW} + 4, 0xc0);",
        "psd = { .PSRGBInputs = { 0x5 }, .PSRGBOutputs[1] = 0xc0 };",
        f"[0x7f12] {TRACE}0x0ac0 NV097_{ICW}[0] 0x5\n[0x7f13] {TRACE}0x1e44 NV097_{OCW}[4] 0xc0",
        f"pc 0x80001234: 0x0ac0 NV097_{ICW}[0] 0x5; 0x1e44 NV097_{OCW}[4] 0xc0",
    ],
)
def test_every_statement_of_a_line_is_read(line):
    assert words(line) == {(ICW, 0): 5, (OCW, 1): 0xC0}


def test_an_array_is_given_whole():
    eight = {(ICW, k): k + 1 for k in range(8)}
    assert words("PSRGBInputs[8]   = 0x1 0x2 0x3 0x4 0x5 0x6 0x7 0x8\n") == eight
    assert words("DWORD PSRGBInputs[8] = {\n 1, 2, 3,\n 4, 5, 6, 7, 8,\n};\nx = 9;\n") == eight
    assert words("Push(NV097_SET_COMBINER_COLOR_ICW + 0x0C, 5, 6)\n") == {(ICW, 3): 5, (ICW, 4): 6}
    # The spelling of dumps that emulators once wrote.
    assert words("PSAphaInputs[8] = 1 2 3 4 5 6 7 8\n") == {
        ("SET_COMBINER_ALPHA_ICW", k): k + 1 for k in range(8)
    }


@pytest.mark.parametrize(
    "line",
    [
        "// PSRGBInputs[0] = 5;",
        "/* PSRGBInputs[0] = 5;\n PSRGBInputs[1] = 6; */",
        "#define NV097_SET_COMBINER_COLOR_ICW 0x00000AC0",
        "; NV097_SET_COMBINER_COLOR_ICW = 5",
        "memset(psd.PSRGBInputs, 0, sizeof(psd.PSRGBInputs));",
        "ZeroMemory(psd.PSRGBInputs, sizeof(psd.PSRGBInputs));",
        "nv2a_pgraph_method 5: 0x44 -> 0x0ac0 (0x5)",
        "nv2a_pgraph_method 2: 0x9f -> NV09F_SET_OPERATION<0xac0> (0x5)",
        "NV097_NO_OPERATION 0x0ac0 0x5",
        "D3DRS_ZENABLE = 0x0ac0 0x5",
        "surface @ 0x00aa0000 0x0ac0 0x5",
    ],
)
def test_what_says_nothing_is_passed_over(line):
    assert words(f"SET_COMBINER_CONTROL = 1\n{line}\nSET_COMBINER_FACTOR0[0] = 2\n") == {
        ("SET_COMBINER_CONTROL", 0): 1,
        ("SET_COMBINER_FACTOR0", 0): 2,
    }


# ------------------------------------------------------------------------------------------- refusals

A_NAME = "a name that has no value here"


@pytest.mark.parametrize(
    ("text", "line", "column", "said"),
    [
        ("psd.PSRGBInputs[0] = PS_COMBINERINPUTS(rPSInput[0], 0, 0, 0);", 1, 40, ["'rPSInput'", A_NAME]),
        ("psd.PSRGBInputs[0] = PS_COMBINERINPUTS(n > 1 ? 0x29 : 0x20, 0, 0, 0);", 1, 40, ["'n'"]),
        ("psd.PSRGBInputs[0] = PS_COMBINERINPUTS(1, 2, 3);", 1, 22, ["of 3 values, which takes 4"]),
        ("psd.PSRGBInputs[0] = my_inputs(1, 2);", 1, 22, ["'my_inputs', a function that is not known"]),
        ("psd.PSRGBInputs[0] |= 5;", 1, 20, ["'|'"]),
        ("psd.PSRGBInputs[0] += 5;", 1, 20, ["'+'"]),
        ("psd.PSRGBInputs[i] = 5;", 1, 17, ["index 'i'"]),
        ("psd.PSRGBInputs[0] = 5 / 2;", 1, 24, ["'/'"]),
        (f"p = pb_push1(p, NV097_{ICW} + stage * 4, 5);", 1, 48, ["followed by + and 'stage'"]),
        (f"p = pb_push1(p, 4 * 1 + NV097_{ICW}, 5);", 1, 24, ["follows +"]),
        ("SET_COMBINER_CONTROL ~ 0x5", 1, 22, ["has no value"]),
        (f"{ICW}[{'9' * 400}] = 0x0", 1, 425, ["words 0 to 7"]),
        (f"p = pb_push1(p, NV097_{ICW} + 2, 5);", 1, 47, ["no offset of a word"]),
        (f"*p++ = PB_METHOD_INC(0, NV097_{ICW}, 1);\n*p++ = 0x08040000;", 1, 53, ["PB_METHOD_INC takes"]),
        (f"pb_push_to(SUBCH_3D, p++, NV097_{ICW}, 8);\n *(p++) = 0x0;", 1, 55, ["pb_push_to takes a number"]),
        (f"BEGIN_NV04(push, NV20_3D(NV097_{ICW}), 8);", 1, 54, ["BEGIN_NV04 takes"]),
        (f"emit(NV097_{ICW}, 2);\n  *(p++) = 0x0;", 1, 34, ["this line takes a number"]),
        ("memset(psd.PSRGBInputs, 0xff, 32);", 1, 23, ["memset takes a number"]),
        (f"{TRACE}0x0264 NV097_{ICW}[4] 0x5", 1, 38, ["follows the address of SET_COMBINER_ALPHA_ICW"]),
        (f"{TRACE}0x0ac4 NV097_{ICW}[2] 0x5", 1, 67, ["index 2 beside the address of word 1"]),
        (f"{ICW}[2]<0xac4> 0x5", 1, 24, ["index 2 beside the address of word 1"]),
        (f"{ICW}[0]<0x1e40> 0x5", 1, 29, [f"followed by the address of {OCW}"]),
        (f"{ICW}[0] 5\n{ICW}[4] 6", 2, 24, ["offsets in bytes"]),
        (f"{ICW} 0x00000ac0", 1, 24, ["has its address and no value"]),
        ("SET_COMBINER_CONTROL 00011002", 1, 22, ["whose base is not clear"]),
        ("SET_COMBINER_CONTROL 18140000h", 1, 22, ["'18140000h'"]),
        ("SET_COMBINER_CONTROL c8c40000", 1, 22, ["'c8c40000'"]),
        ("SET_COMBINER_CONTROL value 5", 1, 22, ["'value'"]),
        ("SET_COMBINER_CONTROL = -1", 1, 24, ["'-'"]),
        ("SET_COMBINER_CONTROL = 1.0", 1, 24, ["'1.0'"]),
        ("SET_COMBINER_CONTROL = 1 << 40", 1, 24, ["no word of 32 bits"]),
        ("if (method >= NV097_SET_COMBINER_CONTROL && x == 5)", 1, 42, ["'&'"]),
        ("R[NV097_SET_COMBINER_CONTROL / 4] & 0xFF", 1, 30, ["'/'"]),
        ("PSRGBInputs[0] =\n0x1e60: 0x101", 1, 15, ["has no value"]),
    ],
)
def test_what_is_no_value_is_refused_where_it_stands(text, line, column, said):
    assert_says_where_and_what(RegisterTextError, parse_program, text, line, column, said)


def test_a_number_of_hex_digits_alone_is_taken_as_written():
    assert words("SET_COMBINER_CONTROL (65793)\nSET_DOT_RGBMAPPING <0x5>\n") == {
        ("SET_COMBINER_CONTROL", 0): 65793,
        ("SET_DOT_RGBMAPPING", 0): 5,
    }


# ---------------------------------------------------------------------------------------------- draws

TWO = f"""{TRACE}NV097_SET_COMBINER_CONTROL<0x1e60> (0x1)
{TRACE}NV097_SET_BEGIN_END<0x17fc> (0x5 {{TRIANGLES}})
{TRACE}NV097_SET_BEGIN_END<0x17fc> (0x0 {{END}})
{TRACE}0x1e60 (0x2)
{TRACE}0x17fc (0x6)
{TRACE}0x17fc (0x0)
"""


def test_draws_are_told_apart():
    assert words(TWO, draw=1) == {CONTROL: 1} and words(TWO, draw=2) == words(TWO) == {CONTROL: 2}
    assert read_dump(TWO).notes == [
        "the text has 2 draws (SET_BEGIN_END): the words before draw 2 are taken; give the number of another "
        "to have its words."
    ]
    assert read_dump(TWO, draw=1).lines == {CONTROL: 1} and read_dump(TWO).lines == {CONTROL: 4}
    for draw in (0, 3, -1):
        with pytest.raises(RegisterTextError, match=f"has draws 1 to 2; draw {draw} is asked for"):
            read_dump(TWO, draw=draw)
    with pytest.raises(RegisterTextError, match="has no draw"):
        read_dump("SET_COMBINER_CONTROL 1\n", draw=1)
    assert len(parse_program(TWO, draw=1).combiners.general) == 1


def test_what_was_given_again_or_behind_the_last_draw_is_said():
    assert read_dump("SET_COMBINER_CONTROL 1\nSET_COMBINER_CONTROL 2\n").notes == [
        "1 register is given more than once, with other values: the last stays."
    ]
    assert read_dump("SET_COMBINER_CONTROL 1\nSET_COMBINER_CONTROL 1\n").notes == []
    late = read_dump(TWO + "SET_COMBINER_CONTROL 3\n")
    assert late.words == {CONTROL: 2} and late.notes[1:] == ["words behind the last draw are left out."]
    begins = "pb_push1(p, NV097_SET_BEGIN_END, NV097_SET_BEGIN_END_OP_TRIANGLES);\n"
    ends = begins.replace("TRIANGLES", "END")
    same = read_dump("SET_COMBINER_CONTROL 1\n" + (begins + ends) * 2)
    assert same.notes == ["the text has 2 draws (SET_BEGIN_END): all have the same words."]
    # Words that all come behind the one draw are what there is.
    assert words(begins + ends + "SET_COMBINER_CONTROL 3\n") == {CONTROL: 3}


# --------------------------------------------------------------------------------------------- hostile


@pytest.mark.parametrize(
    "text",
    [
        "/*" * 250_000 + "\nSET_COMBINER_CONTROL 5",
        "/**/" * 120_000 + "\nSET_COMBINER_CONTROL 5",
        "SET_COMBINER_CONTROL = " + "1|" * 200_000 + "1",
        "SET_COMBINER_CONTROL = " + "1+(" * 100_000,
        "SET_COMBINER_CONTROL" + " " * 500_000,
        "SET_COMBINER_COLOR_ICW " * 20_000,
        "f(" * 200_000 + "SET_COMBINER_CONTROL, 5",
        "SET_COMBINER_CONTROL 1\nSET_BEGIN_END 5\nSET_COMBINER_CONTROL 2\nSET_BEGIN_END 5\n" * 6000,
        "SET_COMBINER_CONTROL = MASK(" * 15_000,
        "f(SET_COMBINER_CONTROL, 5); " * 25_000,
    ],
    ids=range(10),
)
def test_a_long_text_is_read_or_refused(text):
    """Measured: up to 2 s on two cores of Zen 4; what grows with the square of its length takes minutes."""
    try:
        parse_program(text)
    except ProgramTextError as error:
        assert len(str(error)) < 500


def test_a_glob_in_a_path_is_no_comment():
    assert words("reads /home/*/x\nSET_COMBINER_CONTROL 5\n") == {CONTROL: 5}


SEEDS = ("\n".join(form(*m, w) for m, w in WORDS.items()) for form in FORMS.values())
SEEDS = (*SEEDS, MASKED, SYMBOLIC, TWO)


def spoiled(text, chance):
    """A text of which some characters were taken out, exchanged, doubled, or put elsewhere."""
    out = list(text)
    for _ in range(chance.randint(1, 6)):
        at, how = chance.randrange(len(out)), chance.randrange(4)
        if how == 0:
            del out[at : at + chance.randint(1, 12)]
        elif how == 1:
            out[at] = chance.choice("0x9af()[]{}<>=,;|+*-/\n\t \"'\0~^&")
        elif how == 2:
            out[at:at] = out[at : at + chance.randint(1, 30)]
        else:
            to = chance.randrange(len(out))
            out[to:to] = out[at : at + 20]
        out = out or ["x"]
    return "".join(out)


def read_spoiled(count, seed):
    chance = random.Random(seed)
    read = 0
    for _ in range(count):
        text = spoiled(chance.choice(SEEDS), chance)
        try:
            parse_program(text)
            read += 1
        except ProgramTextError as error:
            assert str(error).endswith(".") and len(str(error)) < 600
    return read


def test_a_spoiled_dump_is_read_or_refused():
    assert read_spoiled(400, 0) > 20


@pytest.mark.slow
def test_ten_thousand_spoiled_dumps_are_read_or_refused():
    assert read_spoiled(10_000, 1) > 500


def test_a_text_that_names_no_method_is_no_dump():
    assert not is_dump("SET_BEGIN_END 5\nSET_VIEWPORT_OFFSET 0x1e60\n// PSRGBInputs[0] = 5\n")
    assert is_dump("x: PSRGBInputs[0] = 5")
