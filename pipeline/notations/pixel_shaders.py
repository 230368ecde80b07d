"""Direct3D 8's pixel shaders ``ps.1.0`` to ``ps.1.3`` as texture shader stages and register combiners.

    ps.1.1
    def c0, 0.2, 0.2, 0.2, 1    ; ambient
    tex t0                      ; base
    tex t1                      ; normal map
    dp3_sat r0, t1_bx2, v0_bx2
    mad r0.rgb, r0, t0, c0
    + mov r0.a, t0

A program has the version, any ``def``, texture instructions and arithmetic ones, in this order. White space,
line ends included, separates words. Comments run from ``;`` or ``//`` to the end of the line, or between
``/*`` and ``*/``. Case does not matter. This module reads; ``pixel_shader_translation`` translates.

Sources carry at most one of ``-`` and ``1-`` before the register, ``_bias`` or ``_bx2`` after it, and one of
``.a`` (``.w``, ``.aaaa``) and ``.b`` (``.z``, ``.bbbb``) last; ``.rgb``, ``.rgba`` and the like are accepted
and choose nothing. Destinations carry ``.rgb``, ``.a`` or nothing. Instructions carry ``_x2``, ``_x4`` or
``_d2``, and ``_sat``. An instruction after ``+`` is evaluated together with the one before it, which writes
the other half.

Source: the DirectX 8.1 reference of pixel shaders 1.0 to 1.3; the tokens that nvparse's ps1.0 parser takes,
as distributed with OGRE 3D.
"""

import re
from typing import NamedTuple

from fixedpipe.pipeline.notations.register_combiner_words import MAX_GENERAL_COMBINERS
from fixedpipe.pipeline.notations.tokens import ProgramTextError, Reader, Token, scan

_MOST_NOTES = 100
REGISTER_COUNTS = {"r": 2, "c": 8, "t": 4, "v": 2}
VERSIONS = ("1.0", "1.1", "1.2", "1.3")

# {instruction: (number of sources, first version)}.
ARITHMETIC = {
    "nop": (0, "1.0"),
    "mov": (1, "1.0"),
    "add": (2, "1.0"),
    "sub": (2, "1.0"),
    "mul": (2, "1.0"),
    "dp3": (2, "1.0"),
    "mad": (3, "1.0"),
    "lrp": (3, "1.0"),
    "cnd": (3, "1.0"),
    "dp4": (2, "1.2"),
    "cmp": (3, "1.2"),
}
TEXTURE = {
    "tex": (0, "1.0"),
    "texcoord": (0, "1.0"),
    "texkill": (0, "1.0"),
    "texbem": (1, "1.0"),
    "texbeml": (1, "1.0"),
    "texreg2ar": (1, "1.0"),
    "texreg2gb": (1, "1.0"),
    "texm3x2pad": (1, "1.0"),
    "texm3x2tex": (1, "1.0"),
    "texm3x3pad": (1, "1.0"),
    "texm3x3tex": (1, "1.0"),
    "texm3x3spec": (2, "1.0"),
    "texm3x3vspec": (1, "1.0"),
    "texreg2rgb": (1, "1.2"),
    "texdp3": (1, "1.2"),
    "texdp3tex": (1, "1.2"),
    "texm3x3": (1, "1.2"),
    "texm3x2depth": (1, "1.3"),
}
OVER_TWO_COMBINERS = ("cmp", "dp4")
# Instructions of later versions, for their error.
_LATER = ("phase", "texcrd", "texld", "texdepth", "bem")

MASKS = {"": ("rgb", "a"), "rgba": ("rgb", "a"), "xyzw": ("rgb", "a")}
MASKS |= {"rgb": ("rgb",), "xyz": ("rgb",), "a": ("a",), "w": ("a",)}
SELECTORS = {"": None, "rgba": None, "xyzw": None, "rgb": None, "xyz": None}
SELECTORS |= {written: {"w": "a", "z": "b"}.get(c, c) for c in "awbz" for written in (c, 3 * c, 4 * c)}


class PixelShaderTextError(ProgramTextError):
    """A text that is no ``ps.1.0`` to ``ps.1.3`` or ``xps.1.x`` program, or exceeds register combiners."""


class Source(NamedTuple):
    """A source.

    - ``letter``, ``number``: its register.
    - ``sign``: "", "-" or "1-".
    - ``modifier``: "", "bias" or "bx2".
    - ``selector``: None, "a" or "b".
    """

    letter: str
    number: int
    sign: str
    modifier: str
    selector: str | None
    token: Token

    @property
    def register(self):
        """(letter, number)."""
        return self.letter, self.number


class Instruction(NamedTuple):
    """An instruction.

    - ``scale``: "", "x2", "x4" or "d2".
    - ``mask``: the halves that are written, "rgb" and "a".
    - ``paired``: whether it follows a ``+``.
    """

    name: str
    scale: str
    saturate: bool
    destination: tuple[str, int] | None
    mask: tuple[str, ...]
    sources: tuple[Source, ...]
    paired: bool
    token: Token

    @property
    def unit(self):
        """The number of its destination; for a texture instruction the texture unit."""
        return self.destination[1]


class Listing(NamedTuple):
    """A program as written.

    - ``constants``: {number: color} of its ``def``.
    - ``texture``, ``arithmetic``: its instructions.
    - ``end``: the token at its end.
    - ``notes``: (line, sentence) on what Direct3D would refuse and this project accepts.
    """

    version: str
    constants: dict
    texture: tuple[Instruction, ...]
    arithmetic: tuple[Instruction, ...]
    end: Token
    notes: tuple[tuple[int, str], ...] = ()


_TOKEN = re.compile(
    r"""(?P<space> \s+ | //[^\n]* | ;[^\n]* | /\*.*?\*/ )
      | (?P<header> [px]?[pv]s[._][0-9x]+[._][0-9x]+ )
      | (?P<number> (?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+)(?:e[+-]?[0-9]+)?f?(?![a-z0-9_.]) )
      | (?P<name> (?a: [a-z_][a-z0-9_]*(?:\.[a-z]+)? ) )
      | (?P<directive> \#[^\n]* )
      | (?P<mark> [,+-] )""",
    re.VERBOSE | re.DOTALL | re.IGNORECASE,
)
_OPERAND = re.compile(r"([a-z])([0-9])((?:_[a-z0-9]+)*)(?:\.([a-z]+))?")


def _tokens(text, start):
    for token in scan(text, _TOKEN, PixelShaderTextError, start):
        if token.kind == "directive":
            raise token.error(
                f"{token.found}, a preprocessor directive; give the text that the preprocessor writes."
            )
        yield token


class PixelShaderReader(Reader):
    """Reads ps.1.0 to ps.1.3, and the parts that their dialects share.

    - ``constant_names``: the constant registers, as a pattern and in words.
    - ``least``: the least value of a constant.
    """

    constant_names = re.compile(r"c([0-7])"), "c0 to c7"
    least = -1

    def __init__(self, text, start):
        super().__init__(_tokens(text, start))
        self.notes = []

    def note(self, token, sentence):
        """Note a sentence on a line, once."""
        if (token.line, sentence) not in self.notes and len(self.notes) < _MOST_NOTES:
            self.notes.append((token.line, sentence))

    def word(self):
        """The next token, and its text in lower case."""
        token = self.take()
        return token, token.text.lower()

    # ----------------------------------------------------------------------------------- program

    def listing(self):
        """The Listing of the whole text."""
        version = self.version()
        constants, texture, arithmetic, combiners = {}, [], [], 0
        previous = None  # the name of the arithmetic instruction before, also of nop
        while self.next.kind != "end":
            paired = self.next.text == "+"
            plus = self.take() if paired else None
            token, name = self.word()
            base = name.split("_")[0].split(".")[0]
            if base in ("def", *TEXTURE) and paired:
                raise plus.error(f"a '+' before {base}; only arithmetic instructions are paired. Remove it.")
            if base == "def":
                if name != "def":
                    raise token.error(f"{token.found}; def carries no modifier. Write def.")
                if texture or arithmetic:
                    raise token.error("def after an instruction; constants come first. Move it up.")
                self.constant(constants)
            elif base in TEXTURE:
                if arithmetic:
                    raise token.error(
                        f"{name} after an arithmetic instruction; texture instructions come first. Move it "
                        "up."
                    )
                texture.append(self.texture(token, name, version))
                if len(texture) > REGISTER_COUNTS["t"] or texture[-1].unit in [i.unit for i in texture[:-1]]:
                    raise token.error(
                        f"{base} gives t{texture[-1].unit} a second time; each texture register has one "
                        "instruction. Give this one another register."
                    )
            elif base in ARITHMETIC:
                instruction = self.arithmetic(token, name, version, paired)
                if "nop" in (instruction.name, previous) and paired:
                    raise plus.error(
                        "a '+' beside nop; a pair is one instruction of colors and one of alpha. Remove "
                        "the '+'."
                    )
                previous = instruction.name
                if instruction.name == "nop":
                    continue
                if paired and (not arithmetic or arithmetic[-1].paired):
                    raise token.error(
                        f"{name} after a '+' that "
                        f"{'would pair a third' if arithmetic else 'has nothing before it'}; two "
                        "instructions "
                        "make a pair. Remove the '+'."
                    )
                arithmetic.append(instruction)
                combiners += 0 if paired else 2 if instruction.name in OVER_TWO_COMBINERS else 1
                if combiners > MAX_GENERAL_COMBINERS:
                    raise too_many_combiners(token)
            else:
                raise token.error(self.unknown(token, base))
        return Listing(version, constants, tuple(texture), tuple(arithmetic), self.next, tuple(self.notes))

    @staticmethod
    def unknown(token, base):
        """The sentence on a word that is no instruction."""
        if base in _LATER:
            return (
                f"{base} belongs to ps.1.4, whose programs register combiners cannot hold; write the "
                "program for ps.1.1 to ps.1.3."
            )
        return (
            f"{token.found} where an instruction belongs; there are def, {', '.join(TEXTURE)}, "
            f"{', '.join(ARITHMETIC)}."
        )

    def version(self):
        """The version of the header, "1.1" for instance."""
        token, text = self.word()
        version = ".".join(re.split(r"[._]", text)[1:])
        if token.kind != "header":
            raise token.error(f"{token.found} where the version belongs; begin the program with ps.1.1.")
        if text[:2] != "ps" or version not in VERSIONS:
            raise token.error(
                f"{token.found}, which texture shaders and register combiners do not run; they run ps.1.0, "
                "ps.1.1, ps.1.2 and ps.1.3. Write the program for one of these."
            )
        return version

    def check_version(self, token, name, since, version):
        """Refuse an instruction of a later version."""
        if version < since:
            raise token.error(f"{name} in ps.{version}; it came with ps.{since}. Begin with ps.{since}.")

    def comma(self, name):
        """Take the comma between operands of ``name``."""
        if self.next.text != ",":
            raise self.next.error(f"{self.next.found} where ',' belongs, in {name}; write ',' there.")
        self.take()

    def constant(self, constants):
        """Read a def into ``constants``."""
        token, text = self.word()
        names, words = self.constant_names
        match = names.fullmatch(text)
        if match is None:
            raise token.error(f"{token.found} where the register of def belongs; it is {words}.")
        number, color = int(match[1]), []
        if number in constants:
            self.note(token, f"c{number} is defined again, and this definition stays.")
        for _ in range(4):
            self.comma("def")
            sign = self.take().text if self.next.text in ("+", "-") else ""
            value = self.take()
            if value.kind != "number":
                raise value.error(
                    f"{value.found} where a number belongs; def c0, 1, 0.5, 0, 1 has four of them."
                )
            color.append(value.number(sign))
            if not self.least <= color[-1] <= 1:
                self.note(
                    token,
                    f"c{number} is beyond [{self.least}, 1], where a machine's constants end: it is clamped.",
                )
        constants[number] = tuple(color)

    # ------------------------------------------------------------------------------ instructions

    def texture(self, token, name, version):
        """The texture Instruction whose name was just taken."""
        if name not in TEXTURE:
            raise token.error(
                f"{token.found}, which has a modifier; texture instructions have none. Write "
                f"{name.split('_')[0]}."
            )
        count, since = TEXTURE[name]
        self.check_version(token, name, since, version)
        place, text = self.word()
        match = re.fullmatch(r"t([0-3])(?:\.(?:rgba|xyzw))?", text)
        if match is None:
            raise place.error(
                f"{place.found} where the destination of {name} belongs; it is t0, t1, t2 or t3."
            )
        sources = []
        for _ in range(count):
            self.comma(name)
            sources.append(self.source(name))
        return Instruction(name, "", False, ("t", int(match[1])), MASKS[""], tuple(sources), False, token)

    def arithmetic(self, token, text, version, paired):
        """The arithmetic Instruction whose name was just taken."""
        name, *modifiers = text.split("_")
        count, since = ARITHMETIC.get(name, (None, None))
        if count is None:
            raise token.error(self.unknown(token, name))
        self.check_version(token, name, since, version)
        scales = [m for m in modifiers if m in ("x2", "x4", "d2")]
        others = [m for m in modifiers if m not in ("x2", "x4", "d2", "sat")]
        if others or len(scales) > 1 or modifiers.count("sat") > 1 or (name == "nop" and modifiers):
            raise token.error(
                f"{token.found}; {name} carries "
                f"{'no modifier' if name == 'nop' else 'one of _x2, _x4 and _d2, and _sat'}."
            )
        if name == "nop":
            return Instruction(name, "", False, None, (), (), paired, token)
        destination, mask = self.destination(name)
        sources = []
        for _ in range(count):
            self.comma(name)
            sources.append(self.source(name))
        scale = scales[0] if scales else ""
        return Instruction(name, scale, "sat" in modifiers, destination, mask, tuple(sources), paired, token)

    def destination(self, name):
        """Register and mask of the next destination."""
        token, text = self.word()
        match = _OPERAND.fullmatch(text)
        if match is None or match[3] or match[1] not in "rtv" or int(match[2]) >= REGISTER_COUNTS[match[1]]:
            raise token.error(
                f"{token.found} where the destination of {name} belongs; it is r0, r1 or t0 to t3, as a "
                "whole, .rgb or .a."
            )
        if (match[4] or "") not in MASKS:
            raise token.error(
                f"{token.found}; an instruction writes the whole register, .rgb or .a, because the hardware "
                "computes colors and alpha apart. Write one of these."
            )
        return (match[1], int(match[2])), MASKS[match[4] or ""]

    def source(self, name):
        """The next Source."""
        sign = ""
        first = self.next
        if first.text == "-":
            self.take()
            sign = "-"
        elif first.kind == "number":
            self.take()
            if first.number() != 1.0 or self.next.text != "-":
                raise first.error(
                    f"{first.found} where a source of {name} belongs; numbers come from def c0, ..., and "
                    "1-r0 is one minus a register."
                )
            self.take()
            sign = "1-"
        token, text = self.word()
        match = _OPERAND.fullmatch(text)
        if match is None or int(match[2]) >= REGISTER_COUNTS.get(match[1], 0):
            raise token.error(
                f"{token.found} where a source of {name} belongs; registers are r0, r1, c0 to c7, t0 to "
                "t3, v0 and v1."
            )
        modifier, selector = match[3].removeprefix("_"), match[4] or ""
        if modifier not in ("", "bias", "bx2"):
            raise token.error(f"{token.found}; a source carries _bias or _bx2, or neither.")
        if selector not in SELECTORS:
            raise token.error(
                f"{token.found}; a source takes .a or .b alone, or everything. Write one of these."
            )
        if sign == "1-" and modifier:
            raise token.error(
                f"1-{token.text} complements and maps; only one of the two is possible. Map first."
            )
        return Source(match[1], int(match[2]), sign, modifier, SELECTORS[selector], token)


def read(text, start=(1, 1)):
    """The Listing of a program. ``start``: the line and column of the text's beginning, for errors.

    Raises PixelShaderTextError with line and column, both from 1.
    """
    return PixelShaderReader(text, start).listing()


def too_many_combiners(token):
    """The error for a ninth general combiner."""
    return token.error(
        f"from here on the program takes more than the {MAX_GENERAL_COMBINERS} general combiners of any "
        "machine. Split it into passes."
    )


def half_read(half, source):
    """The half of a register that a source reads."""
    return "a" if source.selector == "a" or (half == "a" and source.selector is None) else "rgb"


def halves_read(instruction):
    """The halves of registers that an instruction reads, as (register, "rgb" or "a")."""
    if instruction.name == "dp3":
        halves = ("rgb",)
    elif instruction.name == "dp4":
        halves = ("rgb", "a")
    else:
        halves = instruction.mask
    return {(s.register, half_read(half, s)) for s in instruction.sources for half in halves}


def grouped(instructions):
    """Arithmetic instructions as tuples: a single one, or a pair joined by '+'."""
    groups = []
    for instruction in instructions:
        if instruction.paired:
            groups[-1] = (*groups[-1], instruction)
        else:
            groups.append((instruction,))
    return groups
