"""The Xbox's pixel shaders xps.1.x: what they compute on the combiners they become, and their errors."""

import random
import re
from dataclasses import replace

import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.enums import DotProductMapping, Meaning, Register
from fixedpipe.pipeline.enums import TextureShaderOperation as Op
from fixedpipe.pipeline.notations import nv2a_registers
from fixedpipe.pipeline.notations.pixel_shader_textures import ConstantPlace
from fixedpipe.pipeline.notations.pixel_shaders import PixelShaderTextError
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from fixedpipe.pipeline.notations.xbox_pixel_shader_translation import parse
from fixedpipe.pipeline.notations.xbox_pixel_shaders import ARITHMETIC, MODIFIERS
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.validation.validate import validate_program
from tests.reference import combine, xbox_pixel_shader
from tests.support.program_strategies import mutated, xbox_pixel_shaders
from tests.support.text_errors import assert_says_where_and_what

HEAD = "xps.1.1\ndef c0, 0.25, 0.5, 0.75, 1\ndef c1, 1, 0, 0.1, 0.5\ntex t0\ntex t1\nmov r0, t0\nmov r1, v1\n"
XFC = "xfc zero, zero, zero, r0, zero, zero, r0.a\n"


def check(text, count=12, seed=1):
    """The combiners of a text give the definition's bytes."""
    shader = parse(text)
    validate_program(shader.texture_shader, shader.combiners, NV2A)
    numbers = random.Random(seed)
    for k in range(count):
        values = (0, 127, 128, 255) if k % 2 else range(256)
        t0, t1, v0, v1, fog = ([numbers.choice(values) for _ in range(4)] for _ in range(5))
        if "xfc" not in text:
            fog = [0, 0, 0, 255]
        textures = t0, t1, [0] * 4, [0] * 4
        registers = combine.initial_registers(v0, v1, textures, fog)
        found = combine.combine(shader.combiners, registers, combine.machine_of(NV2A))
        expected = xbox_pixel_shader.evaluate(text, textures, v0, v1, fog)
        assert found == expected, (text, t0, t1, v0, v1, fog)
    return shader


# ------------------------------------------------------------------------------------------ what is computed

_SOURCES = ("t0", "v0_bx2", "t1", "c0")
_DESTINATIONS = {1: "r1", 2: "r1, t1", 3: "r1, t1, v0"}


@pytest.mark.parametrize("modifier", ["", *(f"_{m}" for m in MODIFIERS)])
@pytest.mark.parametrize("name", [name for name in ARITHMETIC if name not in ("nop", "xfc")])
def test_every_instruction_with_every_modifier(name, modifier):
    of_destinations, of_sources = ARITHMETIC[name]
    sources = ["r0.a" if name == "cnd" else "t0", *_SOURCES[1:]][:of_sources]
    line = f"{name}{modifier} {_DESTINATIONS[of_destinations]}, {', '.join(sources)}\n"
    for register in ("r1", "t1", "v0")[:of_destinations]:
        check(HEAD + line + f"mov r0, {register}\n" + XFC)
        check(HEAD + line + f"mov r0, -{register}\n" + XFC)


@pytest.mark.parametrize("selector", ["", ".a", ".rgb", ".b"])
@pytest.mark.parametrize(
    "mapped", ["R", "-R", "1-R", "R_bx2", "-R_bx2", "R_bias", "-R_bias", "R_sat", "1-R_sat"]
)
@pytest.mark.parametrize("register", ["r1", "t0", "v0", "c0"])
def test_every_source_modifier_and_selector(register, mapped, selector):
    # -r0 of half a range, so that results of either sign show.
    source = mapped.replace("R", register) + selector
    check(HEAD + f"sub r1, t0, v0\nxmma discard, discard, r0, {source}, t1, t0, c0\n" + XFC, 6)


@pytest.mark.parametrize("number", ["zero", "one", "0", "1", "1-zero", "1-one", "-zero_bias", "zero_bx2"])
def test_numbers(number):
    check(HEAD + f"xmma r1, discard, r0, t0, {number}, {number}, v0\n" + XFC)


def test_masks_and_pairs_read_before_they_write():
    pair = "xmma_x2 r0.rgb, r1.rgb, discard, r0.a, r1, t0, v0\n"
    pair += "+ xmma_d2 v0.a, discard, r0.a, r0.b, r1, t0, t1.b\n"
    check(HEAD + pair + "mad r0, r0, v0.a, r1\n" + XFC)


@pytest.mark.parametrize(
    "line", ["dp3 r1.rgb", "dp3 r1", "xdm r1.rgb, discard", "xdd t0.rgb, r1", "xdm r1, t0.rgb"]
)
def test_a_dot_product_has_alpha_where_its_destination_has(line):
    sources = "t0_bx2, v0_bx2" + ("" if line.startswith("dp3") else ", t1, v0")
    shader = check(HEAD + f"{line}, {sources}\nmov r0, r1\n" + XFC)
    rgb = shader.combiners.general[2].rgb
    copied = rgb.ab_blue_to_alpha, rgb.cd_blue_to_alpha
    assert copied == ((line == "dp3 r1" or "xdm r1," in line), "r1" in line.split(",")[-1] and "xdd" in line)


@pytest.mark.parametrize(
    "lines",
    [
        "xmma discard, discard, r0, t0, c0, v0, c1\n",
        "mad r0, c1_bias, t0, -c0\n",
        "mul r0.rgb, c1, t0\n+ mad r0.a, c0, t0, c1\n",
        "sub r0, 0, c1.a\nmad r0, r0, c2, c0\n",
    ],
)
def test_two_constants_in_one_combiner(lines):
    check(HEAD.replace("tex t0", "def c2, 0.6, 0.1, 0.9, 0.2\ntex t0") + lines + XFC)


def test_a_dot_product_and_an_alpha_of_another_register_are_a_pair():
    check(HEAD + "dp3 r1, t0_bx2, v0_bx2\n+ mul r0.a, t0, v0\nmul r0.rgb, r1.a, t1\n" + XFC)


@pytest.mark.parametrize(
    "operands",
    [
        "fog.a, r0, fog.rgb, zero, zero, zero, r0.a",
        "prod, fog.rgb, sum, zero, 1 - fog.a, c1, r0.a",
        "v0.a, 1-v0, 1-prod, v1.rgb, t0, c0.a, 1-r1.b",
        "1-sum, t0, zero, c0, c1, r1, t0",
        "sum, t0, 0, 1-fog, one, r1_sat, 1",
    ],
)
def test_the_final_combiner(operands):
    shader = check(HEAD + f"sub r1, t0, v0\nxfc {operands}\n", 60)
    assert shader.combiners.color_sum_clamp


def test_without_a_final_combiner_r0_is_shown_with_fog():
    shader = check(HEAD + "xmma r0, discard, discard, t0, v0, zero, zero\n")
    assert shader.combiners.final.a.register is Register.FOG
    assert shader.sources.final == "r0, with fog"


@given(xbox_pixel_shaders(), st.integers(0, 2**32))
@settings(max_examples=300, deadline=None)
def test_random_programs_compute_what_is_defined(text, seed):
    try:
        parse(text)
    except PixelShaderTextError as error:
        assert re.search(r"third constant|cannot negate|both write|general combiners of any", str(error)), (
            error
        )
        reject()
    check(text, 4, seed)


# ------------------------------------------------------------------------------------------- words and states


def test_the_words_are_those_that_an_assembler_makes():
    # Source: words of D3DPIXELSHADERDEF beside their text, in a public example: a sum of two products, the
    # alpha of a dot product, no alpha at all; 1-zero is 0x20.
    text = "xps.1.1\ntex t0\ntex t2\ndp3 r0, c0, t0\nxmma discard, discard, r0, t2, c0, r0, 1-Zero\n" + XFC
    words = nv2a_registers.format_registers(parse(text).combiners)
    for word in (
        "COLOR_ICW[0] = 0xc1c80000",
        "COLOR_OCW[0] = 0x000820c0",
        "COLOR_ICW[1] = 0xcac1cc20",
        "ALPHA_ICW[1] = 0xdad1dc30",
        "ALPHA_OCW[1] = 0x00000c00",
        "FOG_CW0 = 0x0000000c",
        "FOG_CW1 = 0x00001c80",
        "COMBINER_CONTROL = 0x00011102",
    ):
        assert word in words, words


def _plain(combiners):
    """Combiners as words hold them: what a program means by an input is none of the machine's, an unused
    constant is the program's, and a constant is bytes.
    """
    general = []
    for stage in combiners.general:
        portions = {
            name: replace(p, **{v: replace(getattr(p, v), meaning=Meaning.PLAIN) for v in "abcd"})
            for name, p in (("rgb", stage.rgb), ("alpha", stage.alpha))
        }
        # A combiner without constants of its own reads the program's.
        colors = {
            n: _bytes(getattr(stage, n) or getattr(combiners, n))
            for n in ("constant_color0", "constant_color1")
        }
        general.append(replace(stage, **portions, **colors))
    return replace(
        combiners,
        general=tuple(general),
        **{n: _bytes(getattr(combiners, n)) for n in ("constant_color0", "constant_color1")},
    )


def _bytes(color):
    return tuple(int(255 * c + 0.5) for c in color)


@given(xbox_pixel_shaders())
@settings(max_examples=60, deadline=None)
def test_a_program_comes_back_from_the_registers_words(text):
    try:
        shader = parse(text)
    except PixelShaderTextError:
        reject()
    words = nv2a_registers.format_registers(shader.combiners, shader.texture_shader)
    again = parse_program(words)
    assert _plain(again.combiners) == _plain(shader.combiners)
    assert nv2a_registers.format_registers(again.combiners, again.texture_shader) == words


def test_texture_instructions():
    text = "xps.1.1\ntex t0\ntexm3x3pad t1, t0_bx2\ntexm3x3diff t2, t0_bx2\n"
    text += "texm3x3vspec t3, t0_bx2\nmad r0, t2, v0, t3\n"
    stages = parse(text).texture_shader
    assert [stage.operation for stage in stages] == [
        Op.TEXTURE_2D, Op.DOT_PRODUCT, Op.DOT_PRODUCT_DIFFUSE_CUBE_MAP, Op.DOT_PRODUCT_REFLECT_CUBE_MAP
    ]  # fmt: skip
    assert {stage.dot_product_mapping for stage in stages[1:]} == {DotProductMapping.EXPAND_NORMAL}
    for line in ("texbrdf t2", "texbrdf t2, t0"):
        stages = parse(f"xps.1.0\ntex t0\ntex t1\n{line}\nmov r0, t2\n").texture_shader
        assert stages[2].operation is Op.BRDF_TEXTURE_3D


def test_where_constants_went_and_what_lines_say():
    program = parse_program(
        "xps.1.1\ndef c9, 0, 1, 0.5, 2\ntex t0\nxmma discard, discard, r0, t0, c9, v0, c3\n"
        "mul r1.rgb, r0, c3\n+ mov r1.a, c9\nxfc c12, r0, r1, zero, zero, zero, c3.a\n",
        constants={3: (0.5, 0.25, 0, 1)},
    )
    c0, c1 = Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1
    assert program.constants == (
        ConstantPlace(9, 0, c0), ConstantPlace(3, 0, c1), ConstantPlace(3, 1, c0), ConstantPlace(9, 1, c1),
        ConstantPlace(12, None, c0), ConstantPlace(3, None, c1),
    )  # fmt: skip
    assert program.notations == ("xps.1.1",) and program.defined == {9}
    assert program.colors[3] == (0.5, 0.25, 0, 1)
    assert program.combiners.constant_color1 == (0.5, 0.25, 0, 1)
    assert program.combiners.general[0].constant_color0 == (0, 1, 0.5, 1)
    assert program.sources.general == ("line 4: xmma", "line 5: mul + mov")
    assert program.sources.final == "line 7: xfc" and program.sources.texture_shader == ("line 3: tex",)
    assert program.notes == ("line 2: c9 is beyond [0, 1], where a machine's constants end: it is clamped.",)
    assert "r0" in program.tell("General combiner 0 reads SPARE0.") and "line 4" in program.tell(
        "General combiner 0"
    )


# ---------------------------------------------------------------------------------------------------- errors

_ERRORS = [
    ("xps.1.2\nmov r0, v0", 1, 1, ["xps.1.1"]),
    ("xps.1.1\nmov_sat r0, v0", 2, 1, ["not saturated", "r0_sat"]),
    ("xps.1.1\nmov_x2_bias r0, v0", 2, 1, ["_bx2"]),
    ("xps.1.1\nxfc_x2 zero, zero, zero, r0, zero, zero, r0.a", 2, 1, ["no modifier"]),
    ("xps.1.1\ncmp r0, v0, v1, c0", 2, 1, ["cmp", "xmmc"]),
    ("xps.1.1\ntexreg2rgb t1, t0", 2, 1, ["texreg2rgb"]),
    ("xps.1.1\nxmma r0, r1, discard, v0, v1, zero", 2, 35, ["','", "7 operands"]),
    ("xps.1.1\nxmma r0, r0, discard, v0, v1, v0, v1", 2, 1, ["r0", "different registers", "line 2: xmma"]),
    ("xps.1.1\nxdd r0, c0, v0, v1, v0, v1", 2, 9, ["c0", "discard"]),
    ("xps.1.1\nxdd r0, r1.a, v0, v1, v0, v1", 2, 1, ["alpha alone"]),
    ("xps.1.1\nmov r0.g, v0", 2, 5, [".rgb or .a"]),
    ("xps.1.1\nmov r0_x2, v0", 2, 5, ["destination"]),
    ("xps.1.1\nmov r0, r2", 2, 9, ["zero"]),
    ("xps.1.1\nmov r0, c16", 2, 9, ["c15"]),
    ("xps.1.1\nmov r0, discard", 2, 9, ["source"]),
    ("xps.1.1\nmov r0, 0.5", 2, 9, ["0 and 1"]),
    ("xps.1.1\nmov r0, sum", 2, 9, ["xfc"]),
    ("xps.1.1\nmov r0, v0_x2", 2, 9, ["_sat"]),
    ("xps.1.1\nmov r0, v0.g", 2, 9, [".a or .b"]),
    ("xps.1.1\nmov r0, 1-v0_bx2", 2, 11, ["complements and maps"]),
    ("xps.1.1\nmov r0, -v0_sat", 2, 10, ["saturates and negates"]),
    ("xps.1.1\nmov r0, -one", 2, 10, ["write a constant"]),
    ("xps.1.1\nmov r0, t0", 2, 9, ["write tex t0 first"]),
    ("xps.1.1\nmov r0, fog", 2, 1, ["fog factor"]),
    ("xps.1.1\nmad r0, c0, c1, c2", 2, 17, ["third constant"]),
    ("xps.1.1\nsub r0, v0, 1-v1", 2, 15, ["cannot negate"]),
    ("xps.1.1\nlrp r0, v0_bx2, v1, v0", 2, 9, ["cannot compute one minus it"]),
    ("xps.1.1\ncnd r0, r1.a, v1, v0", 2, 9, ["r0.a"]),
    ("xps.1.1\ndp3 r0.a, v0, v1", 2, 1, ["alpha alone"]),
    ("xps.1.1\nmov r0, v0\n+ mov r1.a, v1", 3, 3, ["alpha", "'+'"]),
    ("xps.1.1\n+ mov r0, v0", 2, 3, ["nothing before it"]),
    ("xps.1.1\nmov r0.rgb, v0\n+ mov r0.a, v1\n+ mov r1.a, v1", 4, 3, ["third"]),
    ("xps.1.1\nmov r0, v0\n+ xfc r0, r0, r0, r0, r0, r0, r0", 3, 1, ["Remove it"]),
    ("xps.1.1\ndp3 r0, v0, v1\n+ mov r0.a, v1", 2, 1, ["alpha", "both write"]),
    ("xps.1.1\nmov r0, v0\nxfc zero, zero, zero, -r0, zero, zero, r0.a", 3, 24, ["D of xfc"]),
    ("xps.1.1\nmov r0, v0\nxfc zero, zero, zero, r0, prod, zero, r0.a", 3, 27, ["E of xfc"]),
    ("xps.1.1\nmov r0, v0\nxfc sum, v0, v1, r0, zero, zero, r0.a", 3, 1, ["B, C and D"]),
    ("xps.1.1\nxfc zero, zero, zero, v0, zero, zero, v0\nmov r0, v0", 3, 1, ["after xfc"]),
    ("xps.1.1\nmov r0, v0\ntex t0", 3, 1, ["come first"]),
    ("xps.1.1\ntex t0\ntex t0", 3, 1, ["second time"]),
    ("xps.1.1\ntexbrdf r0", 2, 9, ["t0 to t3"]),
    ("xps.1.1\ntex t0\ndef c0, 0, 0, 0, 0", 3, 1, ["Move it up"]),
    ("xps.1.1\n" + "mov r0, v0\n" * 9, 10, 1, ["8 general combiners"]),
    ("xps.1.1\nxyz r0", 2, 1, ["xmma"]),
]


@pytest.mark.parametrize(("text", "line", "column", "words"), _ERRORS)
def test_errors_say_where_and_what(text, line, column, words):
    assert_says_where_and_what(PixelShaderTextError, parse, text, line, column, words)


@given(mutated(xbox_pixel_shaders()))
@settings(max_examples=150, deadline=None)
def test_spoiled_programs_raise_their_own_error_or_nothing(text):
    try:
        parse_program(text)
    except ProgramTextError as error:
        assert str(error).endswith("."), error


@pytest.mark.parametrize(
    "text", ["mov r{}, v0", "mov r0, t{}", "mov r0, {}", "mov_{} r0, v0", "def c{}, 0, 0, 0, 0", "xfc {}"]
)
def test_long_numbers_are_sentences(text):
    with pytest.raises(ProgramTextError) as caught:
        parse_program("xps.1.1\n" + text.format("9" * 10_000))
    assert len(str(caught.value)) < 1000
