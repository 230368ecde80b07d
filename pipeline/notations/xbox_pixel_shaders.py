"""The Xbox's pixel shaders ``xps.1.0`` and ``xps.1.1`` as text.

``xbox_pixel_shader_translation`` translates them.

    xps.1.1
    def c0, 1, 0, 0, 0
    tex t0
    tex t1
    xmma discard, discard, r0, t0, c0, t1, 1-v0     ; t0 * c0 + t1 * (1 - v0)
    xfc fog.a, r0, fog.rgb, zero, zero, zero, r0.a  ; r0, with fog

White space, comments, case, ``def``, the order of a program and the ``+`` of pairs are those of ``ps.1.x``
(``pixel_shaders``). Its own instructions:

    xmma d0, d1, d2, a, b, c, d   d0 = a * b, d1 = c * d, d2 = a * b + c * d
    xmmc d0, d1, d2, a, b, c, d   d2 = c * d where the mux takes it, by r0's alpha, a * b elsewhere
    xdm d0, d1, a, b, c, d        d0 = a . b, d1 = c * d
    xdd d0, d1, a, b, c, d        d0 = a . b, d1 = c . d
    xfc a, b, c, d, e, f, g       the final combiner: rgb a * b + (1 - a) * c + d, alpha g; prod is e * f,
                                  sum is r0 + v1. Once, and last

``discard`` stands for an unwanted destination, ``zero`` and ``one`` (``0``, ``1``) for numbers, ``fog`` for
the fog's color and, as xfc's fog.a, its factor. Sources carry one of ``-`` and ``1-``, and one of ``_bias``,
``_bx2`` and ``_sat``; ``.a`` and ``.b`` are as in ``ps.1.x``. Results carry one of ``_x2``, ``_x4``, ``_d2``,
``_bias`` (minus one half) and ``_bx2`` (that, times two). They carry no ``_sat``, because the hardware has no
such field.

Source: the programs of public Xbox homebrew (XBMC's renderers and fonts, ShadeWorm) for xmma, xfc, discard,
zero, registers and modifiers; the listings of Cxbx-Reloaded and Dxbx for the order of operands, prod, sum and
the texture instructions; public tests that assemble texts by a title's own assembler and compare the words
with PS_COMBINERINPUTS and related macros, for the field of each operand. Inferred: this dialect has no cmp,
dp4 and ps.1.2 texture instructions, because no public program has them and the NV2A has no mode or field for
them. Assumed: texture instructions come before all others, as in every public program; xps.1.0 is read as
xps.1.1; .rgb chooses nothing for alpha, as in ps.1.x. An assembler's manual would settle these.
"""

import re
from typing import NamedTuple

from fixedpipe.pipeline.notations.pixel_shaders import (
    MASKS,
    REGISTER_COUNTS,
    SELECTORS,
    TEXTURE,
    Instruction,
    PixelShaderReader,
    too_many_combiners,
)
from fixedpipe.pipeline.notations.register_combiner_words import MAX_GENERAL_COMBINERS
from fixedpipe.pipeline.notations.tokens import Token

VERSIONS = ("1.0", "1.1")
# Assumed: the four bits by which a definition names the constant of a combiner reach sixteen.
CONSTANT_COUNT = 16
# {instruction: (number of destinations, number of sources)}.
ARITHMETIC = {
    "nop": (0, 0),
    "mov": (1, 1),
    "add": (1, 2),
    "sub": (1, 2),
    "mul": (1, 2),
    "dp3": (1, 2),
    "mad": (1, 3),
    "lrp": (1, 3),
    "cnd": (1, 3),
    "xmma": (3, 4),
    "xmmc": (3, 4),
    "xdm": (2, 4),
    "xdd": (2, 4),
    "xfc": (0, 7),
}
# The texture instructions of ps.1.x for which the NV2A has no mode, and its own. Source: PS_TEXTUREMODES.
_ABSENT = ("texreg2rgb", "texdp3", "texdp3tex", "texm3x3")
OWN_TEXTURE = ("texm3x3diff", "texbrdf")
TEXTURES = (*(name for name in TEXTURE if name not in _ABSENT), *OWN_TEXTURE)
MODIFIERS = ("x2", "x4", "d2", "bias", "bx2")
_NAMED = ("zero", "one", "fog", "prod", "sum")
_OPERAND = re.compile(r"(discard|zero|one|fog|prod|sum|[a-z][0-9]{1,2})((?:_[a-z0-9]+)*)(?:\.([a-z]+))?")


class Destination(NamedTuple):
    """A destination: ``register`` is letter and number, None for discard; ``mask`` has the written halves."""

    register: tuple[str, int] | None
    mask: tuple[str, ...]


class Operand(NamedTuple):
    """A source; one is 1-zero.

    - ``name``: a register's letter, or "zero", "fog", "prod", "sum".
    - ``number``: the register's, 0 for a name without one.
    - ``sign``: "", "-" or "1-".
    - ``modifier``: "", "bias", "bx2" or "sat".
    - ``selector``: None, "a" or "b".
    """

    name: str
    number: int
    sign: str
    modifier: str
    selector: str | None
    token: Token


class XboxInstruction(NamedTuple):
    """An instruction: ``modifier`` is one of MODIFIERS or ""; ``paired`` says that it follows a ``+``."""

    name: str
    modifier: str
    destinations: tuple[Destination, ...]
    sources: tuple[Operand, ...]
    paired: bool
    token: Token

    @property
    def halves(self):
        """The halves, "rgb" and "a", that it computes: of its kept destinations, or of all without any."""
        kept = [d for d in self.destinations if d.register is not None] or self.destinations
        return tuple(half for half in ("rgb", "a") if any(half in d.mask for d in kept))


class XboxListing(NamedTuple):
    """A program as written, like ``pixel_shaders.Listing``; ``final`` is the xfc, or None."""

    version: str
    constants: dict
    texture: tuple[Instruction, ...]
    arithmetic: tuple[XboxInstruction, ...]
    final: XboxInstruction | None
    end: Token
    notes: tuple[tuple[int, str], ...]


class _Reader(PixelShaderReader):
    constant_names = re.compile(r"c([0-9]|1[0-5])"), f"c0 to c{CONSTANT_COUNT - 1}"
    # Source: Direct3D holds a definition's constants as D3DCOLOR, bytes without a sign.
    least = 0

    def listing(self):
        version = self.version()
        constants, texture, arithmetic, final = {}, [], [], None
        while self.next.kind != "end":
            plus = self.take() if self.next.text == "+" else None
            token, name = self.word()
            base = name.split("_")[0].split(".")[0]
            if final is not None:
                raise token.error(f"{token.found} after xfc, which ends a program; move it before xfc.")
            if plus and (base not in ARITHMETIC or base in ("nop", "xfc")):
                raise plus.error(
                    f"a '+' before {name[:40]}; only instructions of general combiners are paired. Remove it."
                )
            if base == "def":
                if texture or arithmetic:
                    raise token.error("def after an instruction; constants come first. Move it up.")
                self.constant(constants)
            elif base in TEXTURES:
                texture.append(self.texture_of(token, name, texture, arithmetic))
            elif base in ARITHMETIC:
                instruction = self.instruction(token, name, plus is not None)
                if base == "xfc":
                    final = instruction
                elif base != "nop":
                    self.check_pair(instruction, arithmetic)
                    arithmetic.append(instruction)
                    if sum(not i.paired for i in arithmetic) > MAX_GENERAL_COMBINERS:
                        raise too_many_combiners(token)
            else:
                raise token.error(self.unknown_here(token, base))
        told = tuple(self.notes)
        return XboxListing(version, constants, tuple(texture), tuple(arithmetic), final, self.next, told)

    @staticmethod
    def check_pair(instruction, arithmetic):
        if instruction.paired and (not arithmetic or arithmetic[-1].paired):
            raise instruction.token.error(
                f"{instruction.name} after a '+' that "
                f"{'would pair a third' if arithmetic else 'has nothing before it'}; two instructions make a "
                "pair. Remove the '+'."
            )

    @staticmethod
    def unknown_here(token, base):
        if base in ("cmp", "dp4", *_ABSENT):
            return (
                f"{base} in xps.1.1, which has none, as the NV2A has no field for it; compare with cnd or "
                "xmmc, and sum up with dp3, xdm or xdd."
            )
        return (
            f"{token.found} where an instruction belongs; there are def, {', '.join(TEXTURES)}, "
            f"{', '.join(ARITHMETIC)}."
        )

    def version(self):
        token, text = self.word()
        version = ".".join(re.split(r"[._]", text)[1:])
        if token.kind != "header" or text[:3] != "xps" or version not in VERSIONS:
            raise token.error(f"{token.found} where the version belongs; begin with xps.1.1 or xps.1.0.")
        return version

    def texture_of(self, token, name, before, arithmetic):
        if arithmetic:
            raise token.error(
                f"{name[:40]} after an arithmetic instruction; texture instructions come first. Move it up."
            )
        if name in OWN_TEXTURE:
            instruction = self.own_texture(token, name)
        else:
            instruction = self.texture(token, name, "1.3")
        if any(instruction.unit == other.unit for other in before):
            raise token.error(
                f"{name} gives t{instruction.unit} a second time; each texture register has one instruction. "
                "Give this one another register."
            )
        return instruction

    def own_texture(self, token, name):
        """texm3x3diff t2, t0, or texbrdf t3.

        Cxbx-Reloaded's listings write a source of texbrdf and other texts do not. The mode reads the two
        units before in either case.
        """
        place, text = self.word()
        if not re.fullmatch(r"t[0-3]", text):
            raise place.error(f"{place.found} where the destination of {name} belongs; it is t0 to t3.")
        sources = ()
        if name == "texm3x3diff" or self.next.text == ",":
            self.comma(name)
            sources = (self.source(name),)
        if name == "texbrdf":
            sources = ()
        return Instruction(name, "", False, ("t", int(text[1])), MASKS[""], sources, False, token)

    # ------------------------------------------------------------------------------ instructions

    def instruction(self, token, text, paired):
        name, *modifiers = text.split("_")
        if name not in ARITHMETIC:
            raise token.error(self.unknown_here(token, text))
        if modifiers == ["sat"]:
            raise token.error(
                f"{token.found}; the Xbox's results are not saturated. Read the register as r0_sat, which "
                "is, instead."
            )
        if (
            len(modifiers) > 1
            or any(m not in MODIFIERS for m in modifiers)
            or (name in ("nop", "xfc") and modifiers)
        ):
            carries = "no modifier" if name in ("nop", "xfc") else "one of _x2, _x4, _d2, _bias and _bx2"
            raise token.error(f"{token.found}; {name} carries {carries}.")
        of_destinations, of_sources = ARITHMETIC[name]
        found = []
        for k in range(of_destinations + of_sources):
            if k:
                self.comma(f"{name}, which has {of_destinations + of_sources} operands")
            found.append(
                self.destination_of(name) if k < of_destinations else self.operand(name, k - of_destinations)
            )
        return XboxInstruction(
            name,
            modifiers[0] if modifiers else "",
            tuple(found[:of_destinations]),
            tuple(found[of_destinations:]),
            paired,
            token,
        )

    def destination_of(self, name):
        token, text = self.word()
        match = _OPERAND.fullmatch(text)
        letter, number = (match[1][0], match[1][1:]) if match else ("", "")
        discarded = match is not None and match[1] == "discard"
        if not discarded and (letter not in tuple("rtv") or not _within(letter, number)):
            raise token.error(
                f"{token.found} where a destination of {name} belongs; it is r0, r1, t0 to t3, v0, v1 or "
                "discard, as a whole, .rgb or .a."
            )
        if match[2]:
            raise token.error(f"{token.found}; a destination carries .rgb, .a or nothing.")
        mask = MASKS.get(match[3] or "")
        if mask is None:
            raise token.error(
                f"{token.found}; an instruction writes the whole register, .rgb or .a, because the hardware "
                "computes colors and alpha apart. Write one of these."
            )
        return Destination(None if discarded else (letter, int(number)), mask)

    def operand(self, name, place):
        """A source. ``place`` is its number in the instruction, from 0, because xfc's sources differ."""
        sign, first = "", self.next
        if first.text == "-":
            self.take()
            sign = "-"
        elif first.kind == "number":
            self.take()
            if self.next.text == "-" and first.number() == 1.0:
                self.take()
                sign = "1-"
            elif first.number() in (0.0, 1.0):
                # Cxbx-Reloaded's listings write zero and its complement so.
                return Operand("zero", 0, "1-" if first.number() else "", "", None, first)
            else:
                raise first.error(
                    f"{first.found} where a source of {name} belongs; the numbers there are 0 and 1, others "
                    "come from def c0, ..., and 1-r0 is one minus a register."
                )
        token, text = self.word()
        match = _OPERAND.fullmatch(text)
        known = match is not None and (
            match[1] in _NAMED or (match[1] != "discard" and _within(match[1][0], match[1][1:]))
        )
        if not known:
            raise token.error(
                f"{token.found} where a source of {name} belongs; there are r0, r1, c0 to "
                f"c{CONSTANT_COUNT - 1}, t0 to t3, v0, v1, zero, one and fog, and prod and sum in xfc."
            )
        given = self.modified(token, match, sign)
        if name == "xfc":
            self.check_final(given, place)
        elif given.name in ("prod", "sum"):
            raise token.error(f"{token.found} in {name}; prod and sum are the final combiner's. Use xfc.")
        return given

    def modified(self, token, match, sign):
        modifier, selector = match[2].removeprefix("_"), match[3] or ""
        if modifier not in ("", "bias", "bx2", "sat"):
            raise token.error(f"{token.found}; a source carries one of _bias, _bx2 and _sat, or none.")
        if selector not in SELECTORS:
            raise token.error(
                f"{token.found}; a source takes .a or .b alone, or everything. Write one of these."
            )
        if sign == "1-" and modifier in ("bias", "bx2"):
            raise token.error(
                f"1-{token.text} complements and maps; only one of the two is possible. Map first."
            )
        if sign == "-" and modifier == "sat":
            raise token.error(
                f"-{token.text} saturates and negates; only one of the two is possible. Saturate first."
            )
        name, number = (match[1], 0) if match[1] in _NAMED else (match[1][0], int(match[1][1:]))
        if name == "one":
            # Zero's complement is a mapping of a register, which holds one mapping.
            if modifier in ("bias", "bx2") or sign == "-":
                raise token.error(
                    f"{sign}{token.text} maps one, which is itself a mapping of zero; write a constant."
                )
            name, sign = "zero", "" if sign else "1-"
        return Operand(name, number, sign, modifier, SELECTORS[selector], token)

    @staticmethod
    def check_final(given, place):
        """Refuse a source that xfc's input cannot be. ``place``: 0 to 6, A to G."""
        variable = "abcdefg"[place].upper()
        if given.sign == "-" or given.modifier in ("bias", "bx2"):
            raise given.token.error(
                f"{given.sign}{given.token.text} as {variable} of xfc, whose inputs are in [0, 1]; they are "
                "registers and 1- of one. Map it in an instruction before."
            )
        if place > 3 and given.name in ("prod", "sum"):
            raise given.token.error(
                f"{given.token.text} as {variable} of xfc, which is a register; prod and sum stand in A to D."
            )


def _within(letter, number):
    """Whether a register of that number exists. ``number`` has its digits, or "" where they are none."""
    counts = {**REGISTER_COUNTS, "c": CONSTANT_COUNT}
    return number.isdecimal() and str(int(number)) == number and int(number) < counts.get(letter, 0)


def read(text, start=(1, 1)):
    """The XboxListing of a program. ``start``: the line and column of the text's beginning, for errors.

    Raises PixelShaderTextError with line and column, both from 1.
    """
    return _Reader(text, start).listing()
