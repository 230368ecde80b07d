"""The pixel shader sources that become given inputs of register combiners.

An input may have several wordings. An instruction of both halves of its destination needs a wording that its
color and its alpha share.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

from fixedpipe.pipeline.enums import Mapping, Register
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.notations.equal_programs import CONSTANTS, half_of, never_negative
from fixedpipe.pipeline.notations.pixel_shader_combiners import (
    ALPHA,
    MAPPINGS,
    NEGATED,
    READINGS,
    REGISTERS,
    RGB,
    of_both_signs,
)
from fixedpipe.pipeline.notations.program_sources import PIXEL_SHADER_NAMES
from fixedpipe.pipeline.notations.register_combiner_words import MAPPINGS_OF_ONE

_WORDS = {mapping: words for words, mapping in MAPPINGS.items()} | {Mapping.UNSIGNED_IDENTITY: ("", "")}
_UNREAD = {read: mapping for readings in READINGS.values() for mapping, read in readings.items()}
_TEXTURES = {register: number for (letter, number), register in REGISTERS.items() if letter == "t"}
_WITHOUT_COLOR = (
    Operation.NONE,
    Operation.CULL_FRAGMENT,
    Operation.DOT_PRODUCT,
    Operation.DOT_PRODUCT_DEPTH_REPLACE,
)


class UnsayableError(ValueError):
    """A part that ps.1.x cannot express; the message continues a sentence that names the place."""


class Constant(NamedTuple):
    """A constant whose number is chosen later.

    ``register`` is that of a general combiner, or Register.ZERO for a constant that is zero in all of them.
    None stands for the eye of a texture shader stage.
    """

    stage: int
    register: Register | None


class Said(NamedTuple):
    """The wording of a source: ``name`` is a register's, or a Constant; ``selector`` is "", "a" or "b"."""

    sign: str
    name: str | Constant
    modifier: str
    selector: str

    def text(self, names):
        """The words of the source; ``names`` is {Constant: name}."""
        modifier = f"_{self.modifier}" if self.modifier else ""
        selector = f".{self.selector}" if self.selector else ""
        return f"{self.sign}{names.get(self.name, self.name)}{modifier}{selector}"

    def negated(self):
        """The source with a minus, or without the one that it has."""
        return self._replace(sign="" if self.sign == "-" else "-")


@dataclass
class Operands:
    """The known contents of registers while the Writer goes through a program.

    - ``constants``: {(stage, register, half): number} of a pixel shader; None: any number may be chosen.
    - ``colors``: {number: color}.
    - ``in_blue``: registers whose alpha ps.1.x takes from blue, after a dp3 of all four components.
    - ``ones``: texture registers whose alpha is 1.
    - ``written``: (register, half) that general combiners have written.
    """

    stages: tuple | None
    constants: dict | None
    colors: dict
    in_blue: set = field(default_factory=set)
    written: set = field(default_factory=set)

    def __post_init__(self):
        operations = [stage.operation for stage in self.stages or ()]
        self.ones = {
            register
            for register, unit in _TEXTURES.items()
            if unit < len(operations) and operations[unit] is Operation.PASS_THROUGH
        }
        self.positive = never_negative(self.stages)
        self.missing = set()
        if any(operation is not Operation.NONE for operation in operations):
            self.missing = {
                register
                for register, unit in _TEXTURES.items()
                if unit >= len(operations) or operations[unit] in _WITHOUT_COLOR
            }

    @property
    def exact(self):
        """Whether the program was a pixel shader, which must read back as the very same state."""
        return self.constants is not None

    def are_parts(self, number, first, second):
        """Whether two inputs are the positive and the negative components of one constant's color."""
        both = first.register, second.register
        if not self.exact or set(both) != set(CONSTANTS) or half_of(first.usage) == "a":
            return False
        (found, other) = (self.constants.get((number, register, "rgb")) for register in both)
        return found is not None and found == other and of_both_signs(self.colors[found][:3])

    def write(self, register, half):
        """Note that a general combiner writes a half of a register."""
        self.written.add((register, half))
        self.positive.discard((register, half))
        self.in_blue.discard(register)
        if half == "a":
            self.ones.discard(register)

    def sources(self, number, half, given):
        """The wordings of an input of general combiner ``number``, the best first; empty: there is none.

        Raises UnsayableError for a register that cannot be read at all.
        """
        register = given.register
        if register is Register.ZERO:
            return (*self._ones(half, given.mapping), *self._zeros(number, half, given))
        if register in CONSTANTS:
            return self._constant(number, half, given)
        component = half_of(given.usage)
        if register not in PIXEL_SHADER_NAMES:
            raise UnsayableError(f"it reads {register.name}")
        if register in self.missing and (register, component) not in self.written:
            raise UnsayableError(f"it reads {register.name}, which no texture shader stage gives a color")
        if register in self.ones and component == "a":
            raise UnsayableError(f"it reads the alpha of {register.name}, q, which texcoord makes 1")
        words, selectors = _WORDS[given.mapping], self._selectors(half, given.usage, register)
        return tuple(Said(words[0], PIXEL_SHADER_NAMES[register], words[1], s) for s in selectors)

    def _selectors(self, half, usage, register=None):
        blue = register in self.in_blue
        if half == "rgb":
            return ("a",) if usage is ALPHA else ("", "a") if blue else ("",)
        if usage is ALPHA:
            return ("", "a")
        return ("", "a", "b") if blue else ("b",)

    def _constant(self, number, half, given):
        mapping, component = given.mapping, half_of(given.usage)
        name = Constant(number, given.register)
        if self.exact:
            constant = self.constants.get((number, given.register, component))
            if constant is None:
                raise UnsayableError(f"it reads {given.register.name}, and no constant register went there")
            name, color = f"c{constant}", self.colors[constant]
            values = color[3:] if component == "a" else color[:3]
            if min(values) < 0:
                mapping = (_UNREAD if of_both_signs(values) else NEGATED).get(mapping, mapping)
        sign, modifier = _WORDS[mapping]
        return tuple(Said(sign, name, modifier, s) for s in self._selectors(half, given.usage))

    def _ones(self, half, mapping):
        """Wordings of ZERO as modifiers of an alpha that is 1."""
        words = [w for w, m in MAPPINGS.items() if MAPPINGS_OF_ONE[m] is mapping]
        names = [PIXEL_SHADER_NAMES[register] for register in sorted(self.ones)]
        selectors = self._selectors(half, ALPHA)
        ways = [(name, *w) for name in names for w in words]
        return tuple(Said(sign, name, modifier, s) for name, sign, modifier in ways for s in selectors)

    def _zeros(self, number, half, given):
        """Wordings of ZERO as a constant of zeros, where the program does not fix the constants."""
        if self.exact:
            return ()
        sign, modifier = _WORDS[given.mapping]
        selectors = self._selectors(half, RGB if half == "rgb" else ALPHA)
        return tuple(Said(sign, Constant(-1, Register.ZERO), modifier, s) for s in selectors)
