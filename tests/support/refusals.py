"""What nvparse and Direct3D's validator refuse and the readers here accept, and the other way round.

Each row has a smallest program; tests/pipeline/notations/test_refusals.py reads it, and
docs/program-instructions.md prints it.
"""

from dataclasses import dataclass

# Where a fact about others stands. Not read: any validator's own source.
SOURCES = {
    "registers": "DirectX 8.1, Registers",
    "counting": "DirectX 8.1, Counting Instructions",
    "pairing": "DirectX 8.1, Instruction Pairing",
    "masks": "Win32, Destination Register Write Mask",
    "modifiers": "Win32, Source Register Modifiers",
    "selectors": "Win32, Source Register Swizzling",
    "instructions": "Win32, ps_1_1 to ps_1_4 Instructions",
    "texbem": "Win32, texbem - ps",
    "texkill": "Win32, texkill - ps",
    "texm3x3spec": "Win32, texm3x3spec - ps",
    "cmp": "Win32, cmp - ps",
    "dp4": "Win32, dp4 - ps",
    "lrp": "Win32, lrp - ps",
    "8.0": "DirectX 8.0, Instruction Pairing",
    "ps lexer": "nvparse, ps1.0_tokens.l",
    "ps grammar": "nvparse, ps1.0_grammar.y",
    "ps program": "nvparse, ps1.0_program.cpp",
    "rc lexer": "nvparse, rc1.0_tokens.l",
    "rc grammar": "nvparse, rc1.0_grammar.y",
    "rc general": "nvparse, rc1.0_general.cpp",
    "rc register": "nvparse, rc1.0_register.h",
    "rc combiners": "nvparse, rc1.0_combiners.cpp",
    "ts lexer": "nvparse, ts1.0_tokens.l",
    "ts list": "nvparse, ts1.0_inst_list.cpp",
    "ts inst": "nvparse, ts1.0_inst.cpp",
}


@dataclass(frozen=True)
class Difference:
    """``text``: the program, without the line that says its notation where that is ps.1.1. ``accepted``: by
    the readers here. ``proof``: words of the note, or of what the program becomes; of the refusal.
    """

    construct: str
    text: str
    accepted: bool
    proof: str
    why: str
    source: str

    @property
    def program(self) -> str:
        """The whole text."""
        has_header = "!!" in self.text or self.text.upper().startswith("PS")
        return f"{'' if has_header else 'ps.1.1'}\n{self.text}\n".lstrip("\n")


def _yes(construct, text, proof, why, source):
    return Difference(construct, text, True, proof, why, source)


def _no(construct, text, proof, why, source):
    return Difference(construct, text, False, proof, why, source)


_PUBLIC = "public programs do it, and the chip computes the result"
_NO_FIELD = "no state of these machines holds it"

DIRECT3D_REFUSES = (
    _yes("a register that nothing wrote", "mov r0, r1", "read before anything", _PUBLIC, "registers"),
    _yes(
        "r0 without color or alpha at the end",
        "tex t0\nmov r0.rgb, t0",
        "r0's alpha is read",
        _PUBLIC,
        "registers",
    ),
    _yes(
        "a color register is written",
        "mov v0, v1\nmov r0, v0",
        "writes v0",
        "the chip can write all registers alike",
        "registers",
    ),
    _yes(
        "ps.1.1: three texture registers in an instruction",
        "tex t0\ntex t1\ntex t2\nmad r0, t0, t1, t2",
        "3 texture registers; ps.1.1 reads two",
        "a combiner reads any four registers",
        "registers",
    ),
    _yes(
        "ps.1.0: two texture registers",
        "ps.1.0\ntex t0\ntex t1\nmul r0, t0, t1",
        "ps.1.0 reads one",
        "a combiner reads any four registers",
        "registers",
    ),
    _yes(
        "ps.1.0: two color registers",
        "ps.1.0\nadd r0, v0, v1",
        "2 color registers",
        "a combiner reads any four registers",
        "registers",
    ),
    _yes(
        "three constants, one by its alpha alone",
        "mad r0.rgb, c0, c1.a, c2\n+mov r0.a, v0",
        "3 constant registers",
        "a combiner's constant can take color and alpha from different constants",
        "registers",
    ),
    _yes(
        "four constants in a pair",
        "mul r0.rgb, c0, c1\n+mul r0.a, c2, c3",
        "4 constant registers",
        "a combiner's constant can take color and alpha from different constants",
        "registers",
    ),
    _yes(
        "four texture registers in a pair",
        "tex t0\ntex t1\ntex t2\ntex t3\nmul r0.rgb, t0, t1\n+mul r0.a, t2, t3",
        "4 texture registers",
        "each portion reads any four registers",
        "registers",
    ),
    _yes(
        "ps.1.0: a pair that writes two registers",
        "ps.1.0\nmov r0.rgb, v0\n+mov r1.a, v0\nmov r0.a, r1",
        "writes two registers",
        "each portion has its own outputs",
        "pairing",
    ),
    _yes(
        "what texbem or texbeml read is read again",
        "tex t0\ntexbem t1, t0\nadd r0, t1, t0",
        "read again after texbem",
        "the register still holds the texel",
        "texbem",
    ),
    _yes(
        "a texture register is read before the text gives it",
        "texbem t1, t0\ntex t0\nmov r0, t1",
        "before the text gives it",
        "units work in the order of their numbers",
        "texbem",
    ),
    _yes(
        "cmp writes one of its sources",
        "ps.1.2\ntex t0\nmov r1, t0\ncmp r1, r1.a, t0, v0\nmov r0, r1",
        "writes one of its sources",
        "a combiner reads its inputs before it writes",
        "cmp",
    ),
    _yes(
        "a fourth cmp",
        "ps.1.2\ntex t0" + "\ncmp r0, t0.a, v0, v1" * 4,
        "a fourth cmp",
        "eight combiners are enough for four cmp",
        "cmp",
    ),
    _yes(
        "texbeml and eight arithmetic instructions",
        "tex t0\ntexbeml t1, t0" + "\nmov r0, t1" * 8,
        "texbeml takes one",
        "the texture unit scales, without a combiner",
        "counting",
    ),
    _yes(
        "ps.1.0: more than eight instructions besides tex",
        "ps.1.0\ntex t0\ntexm3x2pad t1, t0\ntexm3x2tex t2, t0" + "\nmov r0, t2" * 7,
        "ps.1.0 has 8 in all",
        "machines count texture units and combiners separately",
        "counting",
    ),
    _yes(
        "tex with a mask, which is the whole register",
        "tex t0.rgba\nmov r0, t0",
        "spare0 = tex0;",
        "the mask changes nothing",
        "masks",
    ),
    _yes(
        "texkill tests three coordinates",
        "texkill t0\nmov r0, v0",
        "tests three coordinates",
        "the chip's operation tests four",
        "texkill",
    ),
    _yes(
        "a texture register in a program without texture instructions",
        "mov r0, t0",
        "no texture instruction gives it, which Direct3D refuses (X5036)",
        "without texture shaders a unit samples its bound texture",
        "texm3x3spec",
    ),
    _yes(
        "a modifier of a constant, undefined there",
        "def c0, 0.5, 0.5, 0.5, 0.5\nmul r0, v0, c0_bx2",
        "expand(const0)",
        "the mapping works on every register",
        "modifiers",
    ),
    _yes("a source's .rgb", "mov r0.rgb, v0.rgb", "r0's alpha is read", "nvparse reads it too", "selectors"),
)

_TI = "an operation of the GeForce 4 Ti, which has no profile"
DIRECT3D_ACCEPTS = (
    _no(
        "ps.1.2: texreg2rgb",
        "ps.1.2\ntex t0\ntexreg2rgb t1, t0\nmov r0, t1",
        "GeForce 4 Ti",
        _TI,
        "instructions",
    ),
    _no("ps.1.2: texdp3", "ps.1.2\ntex t0\ntexdp3 t1, t0\nmov r0, t1", "GeForce 4 Ti", _TI, "instructions"),
    _no(
        "ps.1.2: texdp3tex",
        "ps.1.2\ntex t0\ntexdp3tex t1, t0\nmov r0, t1",
        "GeForce 4 Ti",
        _TI,
        "instructions",
    ),
    _no(
        "ps.1.2: texm3x3",
        "ps.1.2\ntex t0\ntexm3x3pad t1, t0\ntexm3x3pad t2, t0\ntexm3x3 t3, t0\nmov r0, t3",
        "GeForce 4 Ti",
        _TI,
        "instructions",
    ),
    _no(
        "ps.1.2: _bx2 of what texbem reads",
        "ps.1.2\ntex t0\ntexbem t1, t0_bx2\nmov r0, t1",
        "as it is",
        "an offset has no mapping; give the texture signed components",
        "modifiers",
    ),
    _no(
        "cmp by components",
        "ps.1.2\ncmp r0, v0, v0, v1",
        "by the components",
        "a combiner chooses all components by one alpha",
        "cmp",
    ),
    _no(
        "cmp while r0.a is still needed",
        "ps.1.2\nmov r0, v0\ncmp r1, v0.a, v0, v1\nadd r0, r0, r1",
        "still reads r0.a",
        "the mux compares SPARE0's alpha",
        "cmp",
    ),
    _no(
        "ps.1.2: nine slots, where cmp is counted once",
        "ps.1.2" + "\nmov r0, v0" * 7 + "\ncmp r0, v0.a, v0, v1",
        "more than the 8",
        "a cmp takes two combiners; CreatePixelShader counted one by mistake",
        "counting",
    ),
    _no(
        "dp4 into alpha or color alone",
        "ps.1.2\ndp4 r0.rgb, v0, v1",
        "part of its destination",
        "dp4 needs the other part for a product",
        "dp4",
    ),
    _no(
        "dp3 of color and of alpha as a pair",
        "dp3 r0.rgb, v0, v1\n+dp3 r0.a, v0, v1",
        "dp3 of alpha alone",
        "alpha portions have no dot product; write dp3 r0",
        "8.0",
    ),
    _no(
        "lrp by a mapped factor",
        "lrp r0, v0_bx2, v0, v1",
        "cannot compute one minus it",
        "no mapping gives one minus a mapped register",
        "lrp",
    ),
    _no(
        "lrp by a negated factor",
        "lrp r0, -v0, v0, v1",
        "cannot compute one minus it",
        "no mapping gives one minus a negated register",
        "lrp",
    ),
    _no(
        "a saturated register, negated, times a complement",
        "mov_sat r0, v0\nmul r0, -r0, 1-v0",
        "cannot negate",
        "neither factor has a mapping that negates",
        "modifiers",
    ),
    _no(
        "a modifier of a constant with negative components, undefined there",
        "def c0, -1, 0, 0, 1\nmov r0, c0_bx2",
        "with a modifier",
        "the mapping already gives the constant its sign",
        "modifiers",
    ),
    _no(
        "a pair whose alpha takes blue of a third constant",
        "mul r0.rgb, c0, c1\n+mul r0.a, c2.b, v0",
        "is the third",
        "a combiner has only two constant colors",
        "registers",
    ),
    _no("ps.1.4", "ps.1.4\ntexld r0, t0", "ps.1.4", _NO_FIELD, "instructions"),
)

NVPARSE_REFUSES = (
    _yes(
        "ps.1.2 and ps.1.3, nop, cmp, dp4",
        "ps.1.3\nnop\ndp4 r0, v0, v1",
        "spare0 = col0 . col1;",
        "Direct3D has them",
        "ps lexer",
    ),
    _yes(
        "texm3x2depth",
        "ps.1.3\ntex t0\ntexm3x2pad t1, t0\ntexm3x2depth t2, t0\nmov r0, t0",
        "dot_product_depth_replace_2of2",
        "NV_texture_shader has it",
        "ps lexer",
    ),
    _yes(
        "ps_1_1; capital letters", "PS_1_1\nMOV R0, V0", "spare0 = col0;", "Direct3D reads them", "ps lexer"
    ),
    _yes(
        "numbers with an exponent or f",
        "def c0, 1e-1, 0.5f, 0, 1\nmov r0, c0",
        "const0 = (0.1, 0.5, 0, 1);",
        "Direct3D reads them",
        "ps lexer",
    ),
    _yes("comments in /* */", "/* x */\nmov r0, v0", "spare0 = col0;", "Direct3D reads them", "ps lexer"),
    _yes(
        "a modifier and a selector",
        "mov r0, v0_bx2.a",
        "expand(col0.a)",
        "Direct3D has both at once",
        "ps lexer",
    ),
    _yes(
        ".z, .rgba, .xyzw, .aaaa",
        "mov r0.rgba, v0.aaaa",
        "spare0 = col0.a;",
        "Direct3D reads them",
        "ps lexer",
    ),
    _yes(
        "_sat before the scale",
        "mov_sat_x2 r0, v0",
        "scale_by_two",
        "the order of the two suffixes means nothing",
        "ps lexer",
    ),
    _yes(
        "several instructions on a line",
        "mov r0, v0 mul r0, r0, v1",
        "spare0 = spare0 * col1;",
        "nothing is ambiguous",
        "ps grammar",
    ),
    _yes(
        "no arithmetic instruction",
        "tex t0",
        "r0's alpha is read",
        "r0 has its value at the start",
        "ps grammar",
    ),
    _yes(
        "one constant three times",
        "mad r0, c0, c0, c0",
        "discard = const0 * const0; discard = const0;",
        "the constant takes one place only",
        "ps program",
    ),
)

NVPARSE_ACCEPTS = (
    _no(
        "more than eight combiners",
        "mov r0, v0\n" * 9,
        "more than the 8",
        "no machine has more; nvparse leaves it to the driver",
        "ps program",
    ),
    _no(
        "more sources than an instruction has",
        "mov r0, v0, v1",
        "','",
        "nvparse ignores the last ones",
        "ps grammar",
    ),
    _no(
        "a constant as destination",
        "mov c0, v0",
        "destination of mov",
        "nvparse asks the driver to write a constant",
        "ps lexer",
    ),
    _no(
        "a sign or a mapping at a destination",
        "mov r0_bx2, v0",
        "destination of mov",
        "nvparse discards the result",
        "ps lexer",
    ),
    _no("1- and a mapping", "mov r0, 1-v0_bx2", "complements and maps", "nvparse drops the 1-", "ps program"),
    _no(
        "cnd by another register",
        "mov r1, v0\ncnd r0, r1.a, v0, v1",
        "which is r0.a",
        "nvparse uses r0.a instead",
        "ps program",
    ),
    _no(
        "blue for a color",
        "mov r0, v0.b",
        "only alpha takes .b",
        "nvparse takes red, green, blue",
        "ps program",
    ),
    _no(
        "dp3 into alpha alone",
        "dp3 r0.a, v0, v1",
        "dp3 of alpha alone",
        "nvparse sets no combiner",
        "ps program",
    ),
    _no(
        "a register's second texture instruction",
        "tex t0\ntex t0\nmov r0, t0",
        "a second time",
        "nvparse gives it to the next unit",
        "ps program",
    ),
    _no(
        "rows of a matrix without the others",
        "tex t0\ntexm3x2pad t1, t0\nmov r0, t0",
        "texm3x2tex",
        "NV_texture_shader calls such stages inconsistent",
        "ps program",
    ),
    _no(
        "a source that no unit before gives",
        "texreg2ar t1, t0\nmov r0, t1",
        "(NONE)",
        "nvparse prints a line and continues",
        "ps program",
    ),
    _no(
        "a result of texkill or of a pad",
        "texkill t0\nmov r0, t0",
        "gives no color",
        "these operations have no result",
        "ps program",
    ),
    _no(
        "lrp by a mapped or negated factor",
        "lrp r0, v0_bias, v0, v1",
        "cannot compute one minus it",
        "nvparse drops the mapping",
        "ps program",
    ),
)

_RGB = "!!RC1.0\n{{ rgb {{ {} }} }}\nout.rgb = spare0;"
NVPARSE_NOTATIONS = (
    _yes(
        "sum() or mux() after a dot product",
        _RGB.format("discard = tex0 . tex1; discard = tex0; spare0 = sum();"),
        "tex0 . tex1",
        "NV_register_combiners allows it since version 1.6",
        "rc grammar",
    ),
    _yes(
        "one.a, one.rgb, one.b",
        _RGB.format("spare0 = tex0 * one.a;"),
        "unsigned_invert(zero.a)",
        "nvparse makes an invalid register of these",
        "rc register",
    ),
    _yes(
        "white space or comments before the header",
        "  // x\n!!RC1.0\nout.rgb = tex0;",
        "out.rgb = tex0;",
        "nothing is ambiguous",
        "rc combiners",
    ),
    _yes(
        "a comment at the end without a line's end",
        "!!RC1.0\nout.rgb = tex0; // end",
        "out.rgb = tex0;",
        "nvparse reads on beyond the text",
        "rc lexer",
    ),
    _yes(
        "!!TS1.0 and !!RC1.0 in one text",
        "!!TS1.0\ntexture_2d();\n!!RC1.0\nout.rgb = tex0;",
        "texture_2d();",
        "the Cg compiler wrote it; callers cut it in two",
        "ts lexer",
    ),
    _no(
        "an output's other component, .a of rgb, .b of alpha",
        _RGB.format("spare0.a = tex0;"),
        "writes .rgb only",
        "nvparse ignores the component, which the author meant",
        "rc general",
    ),
    _no(
        "more than eight general combiners",
        "!!RC1.0" + "\n{ rgb { spare0 = tex0; } }" * 9 + "\nout.rgb = spare0;",
        "after 8",
        "nvparse prints an error, and takes the first eight",
        "rc general",
    ),
    _no(
        "a word that belongs to no statement",
        "!!RC1.0\nfoo\nout.rgb = tex0;",
        "found 'foo'",
        "nvparse prints an error, and skips the word",
        "rc lexer",
    ),
    _no(
        "the first stage of a group at the end",
        "!!TS1.0\ntexture_2d();\ndot_product_2d_1of2(tex0);",
        "without dot_product_2d_2of2",
        "NV_texture_shader calls such stages inconsistent",
        "ts list",
    ),
)


def _group(name, first=""):
    """A group's three instructions. ``first``: more arguments of the first."""
    parts = [f"{name}_{k + 1}of3(tex0{'' if k else first});" for k in range(3)]
    return "\n".join(["!!TS1.0", "texture_2d();", *parts])


OTHERWISE = (
    _yes(
        "texture instructions out of order",
        "tex t1\ntex t0\ntexreg2ar t2, t1\nmov r0, t2",
        "dependent_ar(tex1)",
        "nvparse numbers units by their order in the text; here tN is unit N",
        "ps program",
    ),
    _yes(
        "cnd",
        "mov r0, v0\ncnd r0, r0.a, t0, t1",
        "discard = tex1; discard = tex0; spare0 = mux();",
        "nvparse exchanges the two values",
        "ps program",
    ),
    _yes("-r0", "mov r0, -v0", "spare0 = -col0;", "nvparse computes 1 - r0", "ps program"),
    _yes(
        "_sat", "mov_sat r0, v0\nmul r0, r0, v1", "unsigned(spare0) * col1", "nvparse drops it", "ps program"
    ),
    _yes(
        "sub",
        "sub r0, v0, v1",
        "discard = -col1;",
        "nvparse multiplies by ZERO through EXPAND_NORMAL, -256/255",
        "ps program",
    ),
    _yes(
        "lrp by 1-",
        "lrp r0, 1-v0, v0, v1",
        "discard = unsigned_invert(col0) * col0; discard = unsigned(col0) * col1;",
        "nvparse drops the 1-",
        "ps program",
    ),
    _yes(
        "the eye of texm3x3spec",
        "def c1, 0, 0, 1, 0\ntex t0\ntexm3x3pad t1, t0\ntexm3x3pad t2, t0\n"
        "texm3x3spec t3, t0, c1\nmov r0, t3",
        "const_eye_1of3(tex0, 0, 0, 1)",
        "nvparse takes only a c0 that def gives, and otherwise sets no eye",
        "ps program",
    ),
    _yes(
        "dot_product_3d_3of3",
        _group("dot_product_3d"),
        "DOT_PRODUCT_TEXTURE_3D",
        "nvparse sets a 2D access",
        "ts inst",
    ),
    _yes(
        "the eye of ..._const_eye_1of3",
        _group("dot_product_reflect_cube_map_const_eye", ", 1, 2, 3"),
        "const_eye_1of3(tex0, 1, 2, 3)",
        "nvparse sets the third stage's zeros instead",
        "ts inst",
    ),
    _yes(
        "a constant that the text does not set",
        "!!RC1.0\nout.rgb = const0;",
        "out.rgb = const0;",
        "here the constant is 0; nvparse leaves an earlier program's value",
        "rc combiners",
    ),
)

# (title, what the columns say, rows)
REFUSALS = (
    (
        "Refused by Direct3D's validator, accepted here",
        "A note names the line where the program would be refused.",
        DIRECT3D_REFUSES,
    ),
    ("Accepted by Direct3D's validator, refused here", "", DIRECT3D_ACCEPTS),
    ("ps.1.x: refused by nvparse, accepted here", "nvparse reads ps.1.0 and ps.1.1.", NVPARSE_REFUSES),
    (
        "ps.1.x: accepted by nvparse, refused here",
        "nvparse checks little; the third column says what it makes of the program.",
        NVPARSE_ACCEPTS,
    ),
    (
        "!!RC1.0 and !!TS1.0: nvparse and here",
        "nvparse refuses what is accepted here, and accepts what is refused here.",
        NVPARSE_NOTATIONS,
    ),
    (
        "Accepted by both, with another meaning",
        "Both accept it. Here it means what its own notation, or Direct3D, says.",
        OTHERWISE,
    ),
)
