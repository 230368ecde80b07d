"""Assembles the text of an ARB_vertex_program to instructions of the NV20's transform unit.

Instructions that the unit lacks are made from those that it has, as in a driver. SUB is made from ADD, FLR
and FRC from EXP, POW from LOG, MUL and EXP, and XPD from MUL and MAD. Source: ARB_vertex_program;
NV_vertex_program1_1. Assumed: these are the instructions that NVIDIA's driver chose; a dump of the unit's
instructions would settle it.
"""

import re
from dataclasses import dataclass, replace

from fixedpipe.pipeline.opengl import arb_program_state
from fixedpipe.pipeline.opengl.arb_program_state import Row
from fixedpipe.pipeline.opengl.vertex_program_objects import PARAMETERS
from fixedpipe.pipeline.vertices.vertex_programs import (
    CONSTANTS,
    INPUTS,
    TEMPORARIES,
    Instruction,
    Operand,
    VertexProgram,
)

# Source: ARB_vertex_program, the minimum of each that a context has.
_MOST_TEMPORARIES, _MOST_INSTRUCTIONS = 12, 128
_HEADER = re.compile(r"\s*!!ARBvp1\.0(?=\s)(.*?)\bEND\s*\Z", re.DOTALL)
_NAME = re.compile(r"[A-Za-z_$][A-Za-z0-9_$]*")
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_SCALAR = re.compile(_NUMBER)
_VECTOR = re.compile(rf"\{{({_NUMBER}(?:,{_NUMBER}){{0,3}})\}}")
_PARAMETER = re.compile(r"program\.(env|local)\[(\d+)(?:\.\.(\d+))?\]")
_INDEXED = re.compile(
    r"(?P<name>[A-Za-z_$][\w$]*)\[(?:(?P<number>\d+)|(?P<address>[A-Za-z_$][\w$]*)\.x(?P<offset>[+-]\d+)?)\]"
)
_SWIZZLE = re.compile(r"\.([xyzw]|[xyzw]{4})$")
_MASK = re.compile(r"\.(x?y?z?w?)$")
_SWZ = re.compile(r"([+-]?)([01xyzw])")

_ATTRIBUTES = {
    "position": 0, "weight": 1, "weight[0]": 1, "normal": 2, "color": 3, "color.primary": 3,
    "color.secondary": 4, "fogcoord": 5, "texcoord": 8,
    **{f"texcoord[{n}]": 8 + n for n in range(4)}, **{f"attrib[{n}]": n for n in range(12)},
}  # fmt: skip
_RESULTS = {
    "position": "HPOS", "fogcoord": "FOGC", "pointsize": "PSIZ",
    **{f"color{face}": "COL0" for face in ("", ".primary", ".front", ".front.primary")},
    **{f"color{face}": "COL1" for face in (".secondary", ".front.secondary")},
    **{f"color{face}": "BFC0" for face in (".back", ".back.primary")},
    "color.back.secondary": "BFC1", "texcoord": "TEX0", **{f"texcoord[{n}]": f"TEX{n}" for n in range(4)},
}  # fmt: skip
# By name: the number of operands, and whether each is one component.
_SAME = {
    **dict.fromkeys(("MOV", "LIT", "ABS", "FLR", "FRC"), (1, False)),
    **dict.fromkeys(
        ("MUL", "ADD", "SUB", "DP3", "DP4", "DPH", "DST", "MIN", "MAX", "SLT", "SGE", "XPD"), (2, False)
    ),
    "MAD": (3, False),
    **dict.fromkeys(("RCP", "RSQ", "EXP", "LOG", "EX2", "LG2"), (1, True)),
    "POW": (2, True),
}
_X, _Y, _Z, _ALL = (0,) * 4, (1,) * 4, (2,) * 4, (0, 1, 2, 3)
# The unit's instruction, and the component of its result that is precise.
_PRECISE = {"EX2": ("EXP", _Z), "LG2": ("LOG", _Z)}


@dataclass(frozen=True)
class ArbProgram:
    """An assembled program.

    - ``program``: its instructions.
    - ``rows``: the rows that are its constants, in order.
    - ``keeps_position``: whether the fixed functions compute the position.
    """

    program: VertexProgram
    rows: tuple[Row, ...]
    keeps_position: bool


def assembled(text: str) -> ArbProgram:
    """The program of a text. Raises ValueError for a wrong text; its message says what is wrong."""
    lines = "\n".join(line.partition("#")[0] for line in text.splitlines())
    found = _HEADER.match(lines)
    if found is None:
        raise ValueError("it does not begin with !!ARBvp1.0 and end with END")
    assembler = _Assembler()
    statements = [" ".join(statement.split()) for statement in found[1].split(";")]
    if statements.pop():
        raise ValueError("its last statement has no semicolon")
    for statement in statements:
        assembler.read(statement)
    return assembler.made()


class _Assembler:
    def __init__(self):
        # The meaning of each name: ("v", number), ("c", first, count), ("R", number), ("A",) or ("o", name).
        self.names = {}
        self.rows, self.places = [], {}
        self.groups, self.temporaries, self.scratches, self.instructions = [], 0, 0, 0
        self.keeps_position = False

    def made(self):
        if len(self.rows) > CONSTANTS:
            raise ValueError(f"it reads {len(self.rows)} constants; the transform unit has {CONSTANTS}")
        if self.instructions > _MOST_INSTRUCTIONS:
            raise ValueError(f"it has {self.instructions} instructions; {_MOST_INSTRUCTIONS} are allowed")
        return ArbProgram(VertexProgram(tuple(self.groups)), tuple(self.rows), self.keeps_position)

    def read(self, statement):
        word, _, rest = statement.partition(" ")
        rest = rest.replace(" ", "")
        declare = {
            "OPTION": self._option,
            "ATTRIB": self._attribute,
            "PARAM": self._parameter,
            "TEMP": self._temporary,
            "ADDRESS": self._address,
            "OUTPUT": self._output,
            "ALIAS": self._alias,
        }.get(word)
        if declare:
            declare(rest)
        else:
            self.instructions += 1
            self._instruction(word, rest, statement)

    # -------------------------------------------------------------------------------------- declarations

    def _option(self, name):
        if name != "ARB_position_invariant":
            raise ValueError(f"the option {name} is not known here")
        self.keeps_position = True

    def _declare(self, name, what):
        if not _NAME.fullmatch(name):
            raise ValueError(f"{name!r} is no name")
        if name in self.names:
            raise ValueError(f"{name} is declared twice")
        self.names[name] = what

    def _attribute(self, text):
        name, _, binding = text.partition("=")
        self._declare(name, self._register(binding))
        if self.names[name][0] != "v":
            raise ValueError(f"{binding!r} is no vertex attribute")

    def _output(self, text):
        name, _, binding = text.partition("=")
        self._declare(name, self._result(binding))

    def _alias(self, text):
        name, _, other = text.partition("=")
        if other not in self.names:
            raise ValueError(f"{other!r} is not declared")
        self._declare(name, self.names[other])

    def _address(self, text):
        for name in text.split(","):
            self._declare(name, ("A",))

    def _temporary(self, text):
        for name in text.split(","):
            self._declare(name, ("R", self._new_temporary()))
            if self.temporaries > _MOST_TEMPORARIES:
                raise ValueError(f"it has more than {_MOST_TEMPORARIES} temporaries")

    def _new_temporary(self):
        self.temporaries += 1
        return TEMPORARIES + self.temporaries  # one more, because R12 reads the position

    def _parameter(self, text):
        name, _, binding = text.partition("=")
        array = re.fullmatch(r"([^\[]+)\[(\d*)\]", name)
        if array is None:
            rows = self._rows(binding)
            if len(rows) != 1:
                raise ValueError(f"{binding!r} has {len(rows)} rows; {name} takes one")
            self._declare(name, ("c", self._place(rows[0]), 1))
            return
        if not (binding.startswith("{") and binding.endswith("}")):
            raise ValueError(f"{name!r} takes a list in braces")
        rows = [row for part in _parts(binding[1:-1]) for row in self._rows(part)]
        if array[2] and int(array[2]) != len(rows):
            raise ValueError(f"{name} is given {len(rows)} rows")
        first = len(self.rows)  # the rows of an array follow each other
        self.rows += rows
        self._declare(array[1], ("c", first, len(rows)))

    def _rows(self, binding):
        if _SCALAR.fullmatch(binding):
            return [("literal", *(float(binding),) * 4)]
        if vector := _VECTOR.fullmatch(binding):
            given = [float(number) for number in vector[1].split(",")]
            return [("literal", *given, *(0.0, 0.0, 0.0, 1.0)[len(given) :])]
        if parameter := _PARAMETER.fullmatch(binding):
            kind, first = parameter[1], int(parameter[2])
            last = int(parameter[3] or first)
            if not first <= last < PARAMETERS:
                raise ValueError(f"{binding!r} is not within 0 to {PARAMETERS - 1}")
            return [(kind, number) for number in range(first, last + 1)]
        if binding.startswith("state."):
            return arb_program_state.rows(binding.removeprefix("state."))
        raise ValueError(f"{binding!r} is no parameter")

    def _place(self, row):
        """The number of the constant that holds a row."""
        if row not in self.places:
            self.places[row] = len(self.rows)
            self.rows.append(row)
        return self.places[row]

    # ------------------------------------------------------------------------------------------ operands

    def _register(self, text):
        """The meaning of a text without swizzle, in the form of ``names``; None if it has none."""
        if text in self.names:
            return self.names[text]
        if text.startswith("vertex."):
            number = _ATTRIBUTES.get(text.removeprefix("vertex."))
            # In the interpreter's order, point size and back colours come before texture coordinates.
            return None if number is None else ("v", number if number < 8 else number - 8 + INPUTS["TEX0"])
        if text.startswith(("program.", "state.", "{")) or _SCALAR.fullmatch(text):
            rows = self._rows(text)
            if len(rows) != 1:
                raise ValueError(f"{text!r} has {len(rows)} rows where one is read")
            return "c", self._place(rows[0]), 1
        return None

    def _result(self, text):
        if text in self.names:
            found = self.names[text]
        else:
            found = (
                ("o", _RESULTS.get(text.removeprefix("result.")))
                if text.startswith("result.")
                else ("", None)
            )
        if found[0] not in ("o", "R") or found[1] is None:
            raise ValueError(f"{text!r} cannot be written")
        if self.keeps_position and found == ("o", "HPOS"):
            raise ValueError("the option ARB_position_invariant forbids to write the position")
        return found

    def _operand(self, text, *, scalar=False, plain=False):
        """An Operand. ``scalar``: it must name one component. ``plain``: it has no sign and no swizzle."""
        sign = text[:1] if text[:1] in ("+", "-") and not plain else ""
        body = text[len(sign) :]
        swizzle = None
        if not plain and (chosen := _SWIZZLE.search(body)) and not _SCALAR.fullmatch(body):
            swizzle, body = chosen[1], body[: chosen.start()]
        file, number, relative = self._read_register(body, text)
        if scalar and (swizzle is None or len(swizzle) != 1) and not _SCALAR.fullmatch(body):
            raise ValueError(f"{text!r}: one component is read here; say which")
        letters = (swizzle or "xyzw").ljust(4, (swizzle or "w")[-1])
        return Operand(file, number, tuple("xyzw".index(letter) for letter in letters), sign == "-", relative)

    def _read_register(self, body, text):
        if indexed := _INDEXED.fullmatch(body):
            found = self.names.get(indexed["name"])
            if found is not None and found[0] == "c":
                if indexed["number"] is not None:
                    if int(indexed["number"]) >= found[2]:
                        raise ValueError(f"{body!r} is beyond the array's {found[2]} rows")
                    return "c", found[1] + int(indexed["number"]), False
                if self.names.get(indexed["address"]) != ("A",):
                    raise ValueError(f"{indexed['address']} is no address register")
                return "c", found[1] + int(indexed["offset"] or 0), True
        found = self._register(body)
        if found is None or found[0] not in ("v", "c", "R"):
            raise ValueError(f"{text!r} cannot be read")
        return found[0], found[1], False

    # -------------------------------------------------------------------------------------- instructions

    def _instruction(self, name, rest, statement):
        target, *operands = _parts(rest)
        if name == "ARL":
            if not target.endswith(".x") or self.names.get(target[:-2]) != ("A",) or len(operands) != 1:
                raise ValueError(f"{statement!r}: ARL writes the x of an address register")
            self._emit("ARL", ("A", 0), (0,), self._operand(operands[0], scalar=True))
            return
        mask = _ALL
        chosen = _MASK.search(target)
        if chosen and chosen[1] and target not in self.names:
            mask, target = tuple("xyzw".index(letter) for letter in chosen[1]), target[: chosen.start()]
        to = self._result(target)
        if name == "SWZ":
            self._extended_swizzle(to, mask, operands, statement)
            return
        if name not in _SAME:
            raise ValueError(f"{name!r} in {statement!r} is no instruction")
        count, scalar = _SAME[name]
        if len(operands) != count:
            raise ValueError(f"{statement!r} has {len(operands)} operands; {name} takes {count}")
        self._lower(name, to, mask, [self._operand(operand, scalar=scalar) for operand in operands])

    def _emit(self, name, to, mask, *operands):
        self.groups.append((Instruction(name, to[0], to[1], mask, operands),))

    def _scratch(self):
        """A temporary for the assembler, and the operand that reads it."""
        self.scratches += 1
        number = TEMPORARIES + _MOST_TEMPORARIES + self.scratches
        return ("R", number), Operand("R", number, _ALL, False, False)

    def _lower(self, name, to, mask, operands):
        if name == "SUB":
            self._emit("ADD", to, mask, operands[0], _negative(operands[1]))
        elif name == "ABS":
            size = replace(operands[0], negated=False)
            self._emit("MAX", to, mask, size, _negative(size))
        elif name in ("FLR", "FRC"):
            self._fraction(name, to, mask, operands[0])
        elif name in _PRECISE:
            own, component = _PRECISE[name]
            scratch, read = self._scratch()
            self._emit(own, scratch, _ALL, operands[0])
            self._emit("MOV", to, mask, replace(read, swizzle=component))
        elif name == "POW":
            scratch, read = self._scratch()
            self._emit("LOG", scratch, _ALL, operands[0])
            self._emit("MUL", scratch, _ALL, replace(read, swizzle=_Z), operands[1])
            self._emit("EXP", scratch, _ALL, replace(read, swizzle=_X))
            self._emit("MOV", to, mask, replace(read, swizzle=_Z))
        elif name == "XPD":
            a, b = operands
            scratch, read = self._scratch()
            self._emit("MUL", scratch, _ALL, _turned(a, (2, 0, 1, 3)), _turned(b, (1, 2, 0, 3)))
            around = _turned(a, (1, 2, 0, 3)), _turned(b, (2, 0, 1, 3)), _negative(read)
            self._emit("MAD", to, tuple(c for c in mask if c < 3), *around)
        else:
            self._emit(name, to, mask, *operands)

    def _fraction(self, name, to, mask, operand):
        scratch, read = self._scratch()
        parts, fractions = self._scratch()
        for component in mask:
            self._emit("EXP", scratch, _ALL, _turned(operand, (component,) * 4))
            self._emit("MOV", parts, (component,), replace(read, swizzle=_Y))
        if name == "FRC":
            self._emit("MOV", to, mask, fractions)
        else:
            self._emit("ADD", to, mask, operand, _negative(fractions))

    def _extended_swizzle(self, to, mask, operands, statement):
        if len(operands) != 5 or not all(map(_SWZ.fullmatch, operands[1:])):
            raise ValueError(f"{statement!r}: SWZ takes a register and four of 0, 1, x, y, z, w with signs")
        source = self._operand(operands[0], plain=True)
        chosen = [_SWZ.fullmatch(operand).groups() for operand in operands[1:]]
        signs = [-1.0 if sign == "-" else 1.0 for sign, _ in chosen]
        factors = [sign * (letter in "xyzw") for sign, (_, letter) in zip(signs, chosen, strict=True)]
        terms = [sign * (letter == "1") for sign, (_, letter) in zip(signs, chosen, strict=True)]
        swizzle = tuple("xyzw".find(letter) % 4 for _, letter in chosen)
        rows = [("literal", *map(float, row)) for row in (factors, terms)]
        factor, term = (Operand("c", self._place(row), _ALL, False, False) for row in rows)
        self._emit("MAD", to, mask, _turned(source, swizzle), factor, term)


def _parts(text):
    """The parts of a list, split at commas outside braces."""
    return re.split(r",(?![^{]*\})", text)


def _negative(operand):
    return replace(operand, negated=not operand.negated)


def _turned(operand, components):
    """An operand with its components in another order."""
    return replace(operand, swizzle=tuple(operand.swizzle[component] for component in components))
