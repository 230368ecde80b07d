"""Programs written as pixel shaders: what is written, that it reads back, and what is refused."""

import re
from dataclasses import replace

import pytest
from click.testing import CliRunner
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from fixedpipe.effects.cli import main
from fixedpipe.pipeline.enums import (
    CombinerFunction,
    CullMode,
    DotProductMapping,
    Mapping,
    Register,
    TextureTarget,
)
from fixedpipe.pipeline.enums import TextureShaderOperation as Op
from fixedpipe.pipeline.notations.pixel_shader_format import format_pixel_shader
from fixedpipe.pipeline.notations.pixel_shaders import ARITHMETIC, PixelShaderTextError
from fixedpipe.pipeline.notations.programs import Program, parse_program
from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import TextureShaderStage
from tests.reference import combine
from tests.support.combiner_strategies import general_combiners
from tests.support.program_strategies import pixel_shaders, texture_shaders

HEAD = "ps.1.3\ndef c0, 0.25, 0.5, 0.75, 1\ndef c1, -0.25, -0.5, -1, 0.5\ntex t0\ntex t1\n"
FOG = "out.rgb = lerp(fog.a, spare0, fog);\nout.a = spare0;\n"


def told(text):
    """The options of ``fixedpipe combiners`` in the comments above a text, as parse_program takes them."""
    targets = {int(u): TextureTarget[name] for u, name in re.findall(r"; --target (\d)=(\w+)", text)}
    colors = re.findall(r"; --constant (\d)=(\S+)", text)
    return targets, {int(n): tuple(map(float, color.split(","))) for n, color in colors}


def check_same(text, targets=None, constants=None):
    """A pixel shader is written as one that is the same, and is written as itself."""
    program = parse_program(text, targets, constants)
    written = format_pixel_shader(program)
    read = parse_program(written, *told(written))
    assert (read.combiners, read.texture_shader) == (program.combiners, program.texture_shader)
    assert (read.constants, read.colors, read.targets) == (program.constants, program.colors, program.targets)
    assert format_pixel_shader(read) == written
    return written


# ------------------------------------------------------------------------------- pixel shaders, as themselves

_OPERANDS = {1: "t0", 2: "t0, v0_bx2", 3: "t0, v0_bx2, t1"}
_NAMES = [name for name in ARITHMETIC if name not in ("nop", "cnd", "cmp")]


@pytest.mark.parametrize("sat", ["", "_sat"])
@pytest.mark.parametrize("scale", ["", "_x2", "_x4", "_d2"])
@pytest.mark.parametrize("name", _NAMES)
def test_every_instruction_with_every_modifier(name, scale, sat):
    operands = _OPERANDS[ARITHMETIC[name][0]]
    written = check_same(HEAD + f"{name}{scale}{sat} r1, {operands}\nadd r0, r1, t1_bias\n")
    assert f"{name}{scale}{sat} r1, {operands}\nadd r0, r1, t1_bias\n" in written


_SOURCES = (
    "t0",
    "-t0",
    "1-t0",
    "t0_bx2",
    "-t0_bx2",
    "t0_bias",
    "-t0_bias",
    "c0",
    "-c0",
    "1-c0",
    "c1",
    "-c1",
    "c2",
)


@pytest.mark.parametrize("selector", ["", ".a"])
@pytest.mark.parametrize("source", _SOURCES)
@pytest.mark.parametrize("use", ["mov r0, X", "mad_d2 r0, v0, X, v1", "sub r0, v0, X", "dp3 r0, X, v0"])
def test_every_source(use, source, selector):
    mixed = HEAD.replace("tex t0", "def c2, -0.3, 0.6, 1, -0.5\ntex t0")
    check_same(mixed + use.replace("X", source + selector) + "\n")


# In the form in which they are written.
SHADERS = {
    "a pair": "mul r0.rgb, t0, v0\n+ mad_x2 r0.a, t1, 1-v1, c0\n",
    "alpha before color, by its constants": "mul r0.a, t0, c1\n+ mul r0.rgb, t0, c0\n",
    "blue": "mov r0.rgb, t0\n+ mul r0.a, t0.b, t1\n",
    "lrp": "lrp r0, v0.a, t0, t1\nlrp r1, 1-v1, t0, r0\nmov r0, r1\n",
    "cnd": "mov r0, t0\ncnd_x2 r0, r0.a, t1, v0\n",
    "cnd of a pair": "mov r0, t0\ncnd r1.rgb, r0.a, t1, -v0\n+ mul r1.a, t0, t1\nmov r0, r1\n",
    "cmp": "cmp r0, t0_bx2.a, t1, 1-v0\n",
    "cmp of color alone": "cmp r1.rgb, -t0.a, t1, v0\nmov r0.rgb, r1\n+ mov r0.a, t0\n",
    "dp4": "dp4_x2_sat r1, t0_bx2, v0_bx2\nmul r0, r1, t1\n",
    "a dot product and its alpha": "dp3_sat r0, t0_bx2, v0_bx2\nmul r0, r0, t1\n",
    "a dot product of color alone": "dp3 r0.rgb, t0_bx2, v0_bx2\n+ mov r0.a, t1\n",
    "saturated and negated": "mov_sat r1, t0\nmul r0, r1, -t1\nadd r0, r0, -r1\n",
    "one minus, subtracted": "sub r0, t0, 1-v0\n",
    "constants of both signs": "mul r0, t0, c0\nadd r0, r0, c1\n",
}


@pytest.mark.parametrize("lines", SHADERS.values(), ids=SHADERS)
def test_a_shader_is_written_as_it_is(lines):
    version = "ps.1.2" if "cmp" in lines or "dp4" in lines else "ps.1.1"
    constants = [f"def c{n}, {c}\n" for n, c in ((0, "0.25, -0.5, 0.75, 1"), (1, "-1, 0, 0, 0.1"))]
    text = f"{version}\n{''.join(constants[n] for n in (0, 1) if f'c{n}' in lines)}tex t0\ntex t1\n{lines}"
    assert format_pixel_shader(parse_program(text)) == text.replace("add r0, r0, -r1", "sub r0, r0, r1")


TEXTURES = (
    "texcoord t0\ntexkill t1\n",
    "tex t0\ntexbem t1, t0\ntexbeml t2, t0\n",
    "tex t0\ntexreg2ar t1, t0\ntexreg2gb t3, t1\n",
    "tex t0\ntexm3x2pad t1, t0_bx2\ntexm3x2tex t2, t0_bx2\n",
    "tex t0\ntexm3x2pad t1, t0\ntexm3x2depth t2, t0_bx2\n",
    "tex t0\ntexm3x3pad t1, t0_bx2\ntexm3x3pad t2, t0_bx2\ntexm3x3tex t3, t0_bx2\n",
    "tex t0\ntexm3x3pad t1, t0_bx2\ntexm3x3pad t2, t0\ntexm3x3spec t3, t0_bx2, c3\n",
    "tex t0\ntexm3x3pad t1, t0_bx2\ntexm3x3pad t2, t0_bx2\ntexm3x3vspec t3, t0_bx2\n",
)


@pytest.mark.parametrize("lines", TEXTURES)
def test_every_texture_instruction_is_written_as_it_is(lines):
    eye = "def c3, 0.5, -1, 2, 0\n" if "c3" in lines else ""
    text = f"ps.{'1.3' if 'depth' in lines else '1.1'}\n{eye}{lines}mov r0, t0\n"
    assert check_same(text) == text


@pytest.mark.parametrize(
    "line",
    ["mad r0, t0_bx2, -t0.a, 1-t0.a", "mul r0, t0, t1", "lrp r0, t0.a, t1, 1-t0", "add r0, t1, t0_bias",
     "dp3 r0, 1-t1, -t0.a", "dp4 r0, -t0, t1", "cmp r0, t1.a, t0, -t0", "cmp r0.a, t0, v0, 1-t0"],
)  # fmt: skip
def test_the_alpha_of_texcoord_is_written_where_it_is_one(line):
    check_same(f"ps.1.3\ntexcoord t0\ntex t1\nmov r0, v0\n{line}\nadd r0, r0, t0\n")


def test_targets_and_constants_of_the_application_are_told_above():
    text = "ps.1.1\ntex t0\ntexm3x3pad t1, t0\ntexm3x3pad t2, t0\ntexm3x3tex t3, t0\nmul r0, t3, c4\n"
    targets = {0: TextureTarget.TEXTURE_CUBE_MAP, 3: TextureTarget.TEXTURE_3D}
    written = check_same(text, targets, {4: (0.1, -0.2, 1e-7, 1.0)})
    above = "; --target 0=TEXTURE_CUBE_MAP\n; --target 3=TEXTURE_3D\n; --constant 4=0.1,-0.2,1e-07,1\n"
    assert written == above + text
    assert check_same(text) == text  # of 2D textures, cube maps and black


@pytest.mark.parametrize("value", [0.1, 1e-7, 1 / 3, -(2.0**-30), -1.0, 3.0e22, 255 / 510])
def test_constants_keep_every_bit(value):
    check_same(f"ps.1.1\ndef c5, {value!r}, {value!r}, 0.5, {value!r}\nmul r0, v0, c5\n")


def test_the_version_is_the_first_that_has_the_instructions():
    def version(lines):
        return check_same("ps.1.3\ntex t0\ntex t1\ntex t2\n" + lines)[:6]

    assert version("mad r0, t0, t1, v0\n") == "ps.1.1"
    assert version("mad r0, t0, t1, t2\n") == "ps.1.2"
    assert version("cmp r0, t0.a, t1, v0\n") == "ps.1.2"
    assert check_same("ps.1.0\nmov r0, v0\n") == "ps.1.1\nmov r0, v0\n"


def test_notes_stay_but_for_their_lines():
    text = "ps.1.1\n\n; x\ntexcoord t0\ntexkill t1\n\nadd r0, r0, t0\nmov v0, t0\n"
    program = parse_program(text)
    written = parse_program(format_pixel_shader(program))

    def sentences(notes):
        return [re.sub(r"line \d+: ", "", note) for note in notes]

    assert sentences(program.notes) == sentences(written.notes) and len(program.notes) == 5


def test_a_dot_product_whose_alpha_the_chip_copies_is_written():
    text = HEAD + "mov r1, t0\n" * 6 + "dp3_sat r0, t0_bx2, v0_bx2\ncnd r0, r0.a, t0, t1\n"
    assert parse_program(text).combiners.general[6].rgb.ab_blue_to_alpha
    assert "dp3_sat r0, t0_bx2, v0_bx2\n" in check_same(text).replace("dp3 r0", "dp3_sat r0")


def with_coordinates(text):
    return text.replace("tex t1", "texcoord t1")


def test_blue_that_is_read_after_it_was_copied_to_alpha_is_read_as_blue():
    # "mov r0.rgb" replaces the color, so the dot product is copied to r0's alpha before.
    check_same("ps.1.3\ndp3_sat r0, v0, v1\nmov r0.rgb, r0\n+ mov r1.a, 1-r0.b\n")


@settings(max_examples=150)
@given(st.one_of(pixel_shaders(), pixel_shaders().map(with_coordinates)))
def test_random_shaders_read_back_as_the_very_same_state(text):
    check_random(text)


@pytest.mark.slow
@settings(max_examples=1000)
@given(st.one_of(pixel_shaders(most=9), pixel_shaders(most=9).map(with_coordinates)))
def test_many_random_shaders_read_back_as_the_very_same_state(text):
    check_random(text)


def check_random(text):
    try:
        program = parse_program(text)
    except PixelShaderTextError:
        reject()
    check_same(text)
    try:
        combiners = parse_program(format_program(program.combiners))
    except ValueError:
        return  # blue to alpha, for which !!RC1.0 has no word
    try:
        assert format_pixel_shader(combiners)
    except ValueError as error:
        # A product of lrp's that was zero is nothing in combiners, and its factor is clamped by no lrp; a
        # product with a constant of both signs is a sum of two.
        sentences = "is read clamped", "it clamps", "a sum of two products of two factors"
        assert any(sentence in str(error) for sentence in sentences)


# ------------------------------------------------------------------------------------ other programs


def written(lines, before=""):
    return format_pixel_shader(parse_program(f"{before}!!RC1.0\n{lines}{FOG}"))


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("{ rgb { spare0 = tex0 * col0; } }", "mul r0.rgb, t0, v0\n"),
        ("{ rgb { spare0 = unsigned(col0) * tex0; } }", "mul r0.rgb, v0, t0\n"),
        ("{ rgb { discard = tex0; discard = tex1 * col0; spare0 = sum(); } }", "mad r0.rgb, t1, v0, t0\n"),
        (
            "{ rgb { discard = tex1 * unsigned(tex0); discard = unsigned_invert(tex0) * col0; "
            "spare0 = sum(); } }",
            "lrp r0.rgb, t0, t1, v0\n",
        ),
        (
            "{ rgb { spare1 = tex0; } } { rgb { spare0 = unsigned(spare1) * col0; } }",
            "mov_sat r1.rgb, t0\nmul r0.rgb, r1, v0\n",
        ),
        (
            "{ rgb { spare1 = tex0; } } { rgb { discard = tex1; } } { rgb { spare0 = spare1; } }",
            "mov r1.rgb, t0\nmov r0.rgb, r1\n",
        ),
        (
            "{ const0 = (0.5, 0.25, 0, 1); rgb { spare0 = tex0 * const0; } "
            "alpha { spare0 = tex0 * const0; } }",
            "def c0, 0.5, 0.25, 0, 1\nmul r0, t0, c0\n",
        ),
        ("{ rgb { spare0 = -one * tex0; } }", "def c0, 0, 0, 0, 0\nmul r0.rgb, c0_bx2, t0\n"),
        ("{ rgb { spare0 = tex0 * -one; } }", "def c0, 0, 0, 0, 0\nmul r0.rgb, t0, c0_bx2\n"),
        (
            "{ const0 = (2, -1, 0, 1); rgb { spare0 = expand(const0) * tex0; } }",
            "def c0, 1, 0, 0, 0\nmul r0.rgb, c0_bx2, t0\n",
        ),
    ],
)
def test_combiners_become_instructions(lines, expected):
    assert written(lines) == f"ps.1.1\n{expected}"


def test_texture_shaders_and_what_the_application_sets_of_them():
    stages = "!!TS1.0\ntexture_2d();\noffset_2d_scale(tex0, 0.5, 0, 0, 0.25, 2, 0.125);\ntexture_3d();\n"
    assert written("{ rgb { spare0 = tex2 * tex1; } }", stages) == (
        "; t1, texture stage state of the application's: BUMPENVMAT00 0.5, BUMPENVMAT01 0, BUMPENVMAT10 0, "
        "BUMPENVMAT11 0.25, BUMPENVLSCALE 2, BUMPENVLOFFSET 0.125\n"
        "; --target 2=TEXTURE_3D\nps.1.1\ntex t0\ntexbeml t1, t0\ntex t2\nmul r0.rgb, t2, t1\n"
    )


def test_the_nv2a_s_registers_become_instructions():
    words = (
        "SET_COMBINER_CONTROL = 0x101\nSET_COMBINER_COLOR_ICW = 0xc8c40000\nSET_COMBINER_COLOR_OCW = 0xc0\n"
    )
    words += "SET_COMBINER_SPECULAR_FOG_CW0 = 0x130c0300\nSET_COMBINER_SPECULAR_FOG_CW1 = 0x1c80\n"
    assert format_pixel_shader(parse_program(words)) == "ps.1.1\nmul r0.rgb, t0, v0\n"


DIFFUSE = "dot_product_cube_map_and_reflect_cube_map_eye_from_qs"
_TS = "!!TS1.0\ntexture_2d();\n"
TWO = "discard = tex0 * tex1; discard = col0 * col1;"


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("{ rgb { spare0 = tex0; spare1 = tex1; } }", ["combiner 0, color: it writes 2 registers", "--rc"]),
        (
            f"{{ rgb {{ spare0 = tex0; }} }} {{ alpha {{ {TWO} spare0 = sum(); }} }}",
            ["combiner 1, alpha: it has a sum"],
        ),
        (f"{{ rgb {{ {TWO} spare0 = mux(); }} }}", ["a mux of products, where cnd"]),
        ("{ rgb { discard = tex0 . tex1; discard = col0; spare0 = sum(); } }", ["mux of a dot product"]),
        ("{ rgb { spare0 = tex0; bias_by_negative_one_half(); } }", ["BIAS_BY_NEGATIVE_ONE_HALF"]),
        ("{ rgb { spare0 = fog * tex0; } }", ["it reads FOG"]),
        ("{ rgb { spare0 = unsigned(tex0) * col0; } }", ["it clamps TEXTURE0 (UNSIGNED_IDENTITY)", "_sat"]),
        (
            "{ rgb { spare1 = tex0; } } { rgb { discard = spare1; discard = unsigned(spare1); "
            "spare0 = sum(); } }",
            ["combiner 0, color: what it writes to r1 is read clamped", "and as it is"],
        ),
        (
            "{ const0 = (1, 0, 0, 0); const1 = (0, 1, 0, 0); rgb { discard = -one * const0; "
            "discard = const1; spare0 = sum(); } }",
            ["the third constant that one general combiner reads"],
        ),
    ],
)
def test_what_ps_cannot_say_is_refused_in_a_sentence(lines, words):
    with pytest.raises(ValueError) as caught:
        written(lines)
    assert all(word in str(caught.value) for word in words), str(caught.value)
    assert str(caught.value).endswith(".")


@pytest.mark.parametrize(
    ("stages", "lines", "words"),
    [
        (_TS + "pass_through();\n", "spare0 = tex1.a;", ["reads the alpha of TEXTURE1, q, which texcoord"]),
        (_TS + "nop();\n", "spare0 = tex1;", ["TEXTURE1, which no texture shader stage gives"]),
        (
            _TS + "cull_fragment(LESS_THAN_ZERO, GEQUAL_TO_ZERO, GEQUAL_TO_ZERO, GEQUAL_TO_ZERO);\n",
            "spare0 = tex0;",
            ["stage 1 is CULL_FRAGMENT with the modes LESS"],
        ),
        (
            _TS + "".join(f"{DIFFUSE}_{k}of3(tex0);\n" for k in (1, 2, 3)),
            "spare0 = tex3;",
            ["DOT_PRODUCT", "DIFFUSE"],
        ),
    ],
)
def test_stages_that_ps_has_no_instruction_for_are_refused(stages, lines, words):
    with pytest.raises(ValueError) as caught:
        written(f"{{ rgb {{ {lines} }} }}", stages)
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize(
    ("final", "words"),
    [
        ("out.rgb = spare1; out.a = spare0;", "A is the color of ZERO, where ps.1.0"),
        ("out.rgb = lerp(fog, spare0, fog); out.a = spare0;", "A is the color of FOG"),
        ("out.rgb = lerp(fog.a, color_sum, fog); out.a = spare0;", "B is the color of SPARE0_PLUS_SECONDARY"),
        ("out.rgb = lerp(fog.a, spare0, fog) + tex0; out.a = spare0;", "D is the color of TEXTURE0"),
        (
            "out.rgb = lerp(fog.a, spare0, fog); out.a = unsigned_invert(tex0);",
            "G is the alpha of TEXTURE0, by",
        ),
    ],
)
def test_another_final_combiner_is_refused(final, words):
    with pytest.raises(ValueError, match=words):
        format_pixel_shader(parse_program(f"!!RC1.0\n{final}"))


@pytest.mark.parametrize(
    "final", ["spare0", "lerp(unsigned_invert(zero), spare0, zero)", "lerp(zero, zero, spare0)"]
)
def test_a_final_combiner_without_fog_is_written_with_fog_and_a_comment_says_so(final):
    lines = "{ rgb { spare0 = tex0 * col0; } alpha { spare0 = tex0; } }"
    plain = parse_program(f"!!RC1.0 {lines} out.rgb = {final}; out.a = spare0;")
    text = format_pixel_shader(plain)
    assert text.startswith("; without fog: ")
    assert text.partition("\n")[2] == format_pixel_shader(parse_program(f"!!RC1.0 {lines} {FOG}"))
    assert parse_program(text).combiners.general == parse_program(f"!!RC1.0 {lines} {FOG}").combiners.general


def test_state_that_no_text_has_is_refused():
    program = parse_program(f"!!RC1.0 {{ rgb {{ spare0 = tex0 . col0; }} }} {FOG}")
    stage = program.combiners.general[0]

    def refused(words, stages=None, **rgb):
        general = (replace(stage, rgb=replace(stage.rgb, **rgb)),)
        given = replace(program, texture_shader=stages, combiners=replace(program.combiners, general=general))
        with pytest.raises(ValueError, match=words):
            format_pixel_shader(given)

    refused("its blue goes to alpha", ab_blue_to_alpha=True)
    refused("it computes", function=next(f for f in CombinerFunction if f is not CombinerFunction.NONE))
    tex = TextureShaderStage(Op.TEXTURE_2D)
    refused("filtered by roughness", (replace(tex, roughness=0),))
    odd = TextureShaderStage(Op.DOT_PRODUCT, dot_product_mapping=DotProductMapping.SIGNED_ODD)
    refused("mapped by SIGNED_ODD", (tex, odd, replace(odd, operation=Op.DOT_PRODUCT_TEXTURE_2D)))
    refused("BRDF_TEXTURE_3D; ps", (tex, tex, TextureShaderStage(Op.BRDF_TEXTURE_3D)))
    culling = TextureShaderStage(Op.CULL_FRAGMENT, cull_modes=(CullMode.LESS,) * 4)
    refused("with the modes LESS", (tex, culling))
    refused("no last row", (tex, TextureShaderStage(Op.DOT_PRODUCT)))


def test_too_many_constants_are_counted():
    stages = "".join(
        f"{{ const0 = (0, 0, 0.{n}, 1); const1 = (0, 0.{n}, 0, 1); rgb {{ spare0 = const0 * const1; }} }}\n"
        for n in range(1, 6)
    )
    with pytest.raises(ValueError, match="reads 10 different constants; a pixel shader has 8"):
        written(stages)


def test_a_pixel_shader_with_another_state_is_refused():
    program = parse_program("ps.1.1\nmul r0, v0, v1\n")
    stage = program.combiners.general[0]
    for read, words in (
        (replace(stage.rgb.a, mapping=Mapping.UNSIGNED_IDENTITY), "would change if it were written"),
        (replace(stage.rgb.a, register=Register.CONSTANT_COLOR0), "no constant register went there"),
    ):
        general = (replace(stage, rgb=replace(stage.rgb, a=read)),)
        with pytest.raises(ValueError, match=words):
            format_pixel_shader(replace(program, combiners=replace(program.combiners, general=general)))


# --------------------------------------------------------- what is written computes the same, or is refused

SWAPS = st.tuples(st.booleans(), st.booleans(), st.booleans())
NUMBERS = st.tuples(*[st.integers(-255, 255)] * 4)
COLORS = st.tuples(*[st.integers(0, 255)] * 4)


@st.composite
def respelled(draw, portion):
    """A portion with factors and products in another order, and some inputs clamped."""
    ab, cd, products = draw(SWAPS)
    first, second = (portion.a, portion.b), (portion.c, portion.d)
    if products and not portion.mux_sum and portion.sum_output is not Register.DISCARD:
        first, second = second, first
    (a, b), (c, d) = first[:: -1 if ab else 1], second[:: -1 if cd else 1]
    if draw(st.integers(0, 3)) == 0 and a.mapping is Mapping.SIGNED_IDENTITY:
        a = replace(a, mapping=Mapping.UNSIGNED_IDENTITY)
    return replace(portion, a=a, b=b, c=c, d=d)


@st.composite
def combiner_programs(draw):
    """Register combiners that came from pixel shaders, spelled otherwise; a few with a random one."""
    try:
        combiners = parse_program(draw(pixel_shaders())).combiners
        combiners = parse_program(format_program(combiners)).combiners
    except ValueError:
        reject()
    general = [
        replace(stage, rgb=draw(respelled(stage.rgb)), alpha=draw(respelled(stage.alpha)))
        for stage in combiners.general
    ]
    if draw(st.integers(0, 3)) == 0:
        general[draw(st.integers(0, len(general) - 1))] = draw(general_combiners(2, True))
    return Program(("!!RC1.0",), None, replace(combiners, general=tuple(general)))


def check_equal(program, seen):
    try:
        text = format_pixel_shader(program)
    except ValueError as error:
        assert (str(error).endswith(".") and " ps.1." in str(error)) or "pixel shader" in str(error)
        return False
    read = parse_program(text).combiners
    for t0, t1, v0, v1 in seen:
        found, expected = (
            combine.combine(
                c, combine.initial_registers(v0, v1, (t0, t1), [3, 5, 7, 200]), combine.machine_of(NV2A)
            )
            for c in (read, program.combiners)
        )
        assert found == expected, text
    return True


SEEN = st.lists(st.tuples(NUMBERS, NUMBERS, COLORS, COLORS), min_size=3, max_size=3)


@settings(max_examples=150)
@given(combiner_programs(), SEEN)
def test_random_combiners_are_refused_or_compute_the_same(program, seen):
    check_equal(program, seen)


@pytest.mark.slow
@settings(max_examples=1000)
@given(combiner_programs(), SEEN)
def test_many_random_combiners_are_refused_or_compute_the_same(program, seen):
    check_equal(program, seen)


@settings(max_examples=100)
@given(texture_shaders())
def test_random_texture_shaders_are_refused_or_read_back(text):
    try:
        found = format_pixel_shader(parse_program(f"{text}!!RC1.0 {{ rgb {{ spare0 = col0; }} }} {FOG}"))
    except ValueError as error:
        assert "Texture shader stage" in str(error)
        return
    read = parse_program(found, *told(found)).texture_shader
    assert [s.operation for s in read] == [s.operation for s in parse_program(text).texture_shader][
        : len(read)
    ]


# --------------------------------------------------------------------------------------- command line


def run(*arguments, given):
    return CliRunner().invoke(main, ["combiners", "-", *arguments], input=given)


def test_the_command_prints_a_pixel_shader():
    text = "ps.1.1\ntex t0\nmul r0, t0, c3\n"
    result = run("--ps", "--constant", "3=0.5,0,0,1", "--target", "0=TEXTURE_3D", given=text)
    assert result.output == f"; --target 0=TEXTURE_3D\n; --constant 3=0.5,0,0,1\n{text}"
    assert run("--ps", given=f"!!RC1.0 {{ rgb {{ spare0 = tex0 * col0; }} }} {FOG}").exit_code == 0


def test_the_command_refuses_in_the_program_s_own_words():
    result = run("--ps", given=f"!!RC1.0\n{{ rgb {{ spare0 = tex0; spare1 = tex1; }} }}\n{FOG}")
    assert result.exit_code == 2 and result.stdout == ""
    assert result.stderr.startswith("fixedpipe: General combiner 0 (line 2), color: it writes 2 registers (")
    assert "AB to spare0" in result.stderr
