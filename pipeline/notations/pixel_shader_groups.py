"""The groups of arithmetic pixel shader instructions that become given general combiners.

A group is one instruction, a pair joined by '+', or a cmp or dp4, which become two general combiners.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from fixedpipe.pipeline.enums import Mapping, Meaning, Register
from fixedpipe.pipeline.notations.equal_programs import CONSTANTS, half_of, outputs
from fixedpipe.pipeline.notations.pixel_shader_combiners import (
    BLUE,
    REGISTERS,
    SCALES,
    SIGNED,
    Part,
    Stage,
    compared,
    copy_of_blue,
    of_both_signs,
    sum_of_products,
)
from fixedpipe.pipeline.notations.pixel_shader_operands import Operands, Said, UnsayableError
from fixedpipe.pipeline.notations.pixel_shader_portions import Instruction, instructions, said_times
from fixedpipe.pipeline.notations.register_combiner_words import UNUSED_RGB

_NAMES = {register: "".join(map(str, name)) for name, register in REGISTERS.items()}
_SUFFIXES = {scale: f"_{word}" if word else "" for word, scale in SCALES.items()}
_COPIES = {copy_of_blue(name): register for name, register in REGISTERS.items()}
_IN_WORDS = {"rgb": "color", "a": "alpha"}


@dataclass
class Written:
    """An instruction that is written.

    - ``mask``: "rgb", "a", or "" for both.
    - ``sources``: one wording of each.
    - ``clamped``: how its result is read: {True} clamped to [0, 1], {False} unclamped, both, or neither where
      no reader can tell.
    """

    instruction: Instruction
    mask: str
    sources: tuple[Said, ...]
    clamped: set[bool] = field(default_factory=set)

    def text(self, names):
        """The words of the instruction; ``names`` is {Constant: name}."""
        saturate = "_sat" if True in self.clamped else ""
        mask = f".{self.mask}" if self.mask else ""
        given = self.instruction
        operands = [f"{_NAMES[given.destination]}{mask}", *(source.text(names) for source in self.sources)]
        return f"{given.name}{_SUFFIXES[given.scale]}{saturate} {', '.join(operands)}"


@dataclass
class Group:
    """The origin of general combiner ``number``, and of the next where a group takes two.

    - ``choices``: {half: instructions that may be written}.
    - ``together``: whether it must be one instruction.
    - ``reads``: (half, input, whether the instruction itself clamps it).
    """

    number: int
    choices: dict[str, list[Instruction]]
    together: bool = False
    reads: list = field(default_factory=list)
    written: list[Written] = field(default_factory=list)


def dot_products(general) -> Iterator[int]:
    """The numbers of the general combiners that a dp3 of all four components may have become."""
    for number, stage in enumerate(general):
        alphas = outputs(stage.alpha)
        copied = _COPIES.get(stage.alpha)
        dot = stage.rgb.ab_dot_product and [name for name, _ in outputs(stage.rgb)] == ["ab"]
        if dot and (not alphas or (copied is not None and copied is not stage.rgb.ab_output)):
            yield number


def alpha_is_read(combiners, number) -> bool:
    """Whether the alpha of the register that general combiner ``number`` colors is read before a write."""
    register = combiners.general[number].rgb.ab_output
    for stage in combiners.general[number + 1 :]:
        for portion in (stage.rgb, stage.alpha):
            read = (portion.a, portion.b, portion.c, portion.d) if outputs(portion) else ()
            if any(i.register is register and half_of(i.usage) == "a" for i in read):
                return True
            if portion.mux_sum and outputs(portion) and register is Register.SPARE0:
                return True
        if any(written is register for _, written in outputs(stage.alpha)):
            return False
    return register is Register.SPARE0 and combiners.final.g.usage is not BLUE


class Writer:
    """Writes the arithmetic instructions of register combiners.

    ``whole`` has the numbers of the dot products that count as a dp3 of all four components.
    """

    def __init__(self, combiners, operands: Operands, whole: frozenset[int]):
        self.combiners, self.operands, self.whole = combiners, operands, whole
        self.last = {}  # {(register, half): the Written that wrote it}

    def groups(self) -> list[Group]:
        """The groups, written. Raises ValueError with a sentence for a combiner without one."""
        groups, number = [], 0
        while number < len(self.combiners.general):
            group, taken = self._group(number)
            number += taken
            if group.choices:
                self._write(group)
                groups.append(group)
        for group in groups:
            self._settle(group)
        return groups

    # --------------------------------------------------------------------------------------- one group

    def _group(self, number):
        """The Group that begins at a general combiner, and the number of combiners that it takes."""
        for find in (self._four_components, self._comparison):
            group = find(number)
            if group is not None:
                return group, 2
        stage = self.combiners.general[number]
        group = Group(number, {})
        for half, portion in (("rgb", stage.rgb), ("a", stage.alpha)):
            if not self.operands.exact and getattr(portion, "ab_blue_to_alpha", False):
                raise _unsayable(number, half, "its blue goes to alpha as well")
            if half == "a" and self._copies(portion):
                self.operands.in_blue.discard(_COPIES[portion])  # from now on its alpha holds the dot product
            elif outputs(portion):
                group.choices[half] = self._instructions(number, half, portion)
        return group, 1

    def _copies(self, portion):
        """Whether an alpha portion is the copy of blue that a dp3 implies."""
        return _COPIES.get(portion) in self.operands.in_blue

    def _instructions(self, number, half, portion):
        try:
            return instructions(self.operands, number, half, portion)
        except UnsayableError as error:
            raise _unsayable(number, half, error) from error

    def _four_components(self, number):
        stages = self.combiners.general[number : number + 2]
        if len(stages) < 2:
            return None
        first, second = stages
        register = first.rgb.ab_output
        if (second.rgb, second.alpha) != sum_of_products(register, second.rgb.scale):
            return None
        if outputs(first.rgb) != outputs(first.alpha) or outputs(first.rgb) != (("ab", register),):
            return None
        dot, product = ({i.name: i for i in self._instructions(number, *half)} for half in _halves(first))
        if "dp3" not in dot or "mul" not in product or {first.rgb.scale, first.alpha.scale} != {SCALES[""]}:
            return None
        given = dot["dp3"]._replace(name="dp4", scale=second.rgb.scale)
        common = {"rgb": [given], "a": [product["mul"]._replace(name="dp4", scale=given.scale)]}
        return Group(number, common, True) if _in_common(*common.values()) else None

    def _comparison(self, number):
        stages = self.combiners.general[number : number + 2]
        if len(stages) < 2 or stages[0].rgb != UNUSED_RGB:
            return None
        first, second = stages
        if first.alpha != compared(first.alpha.a, first.alpha.b):
            return None
        portions = [(half, p) for half, p in _halves(second) if outputs(p) and not self._copies(p)]
        if not portions or not all(p.mux_sum for _, p in portions):
            return None
        try:
            tested = said_times(self.operands, number, "a", first.alpha.a, first.alpha.b)
        except UnsayableError as error:
            raise _unsayable(number, "a", error) from error
        tested = tuple(source for source in tested if source.selector)
        choices = {
            half: [
                i._replace(name="cmp", sources=(tested, *i.sources[1:]))
                for i in self._instructions(number + 1, half, portion)
            ]
            for half, portion in portions
        }
        if not tested or (len(choices) == 2 and not _in_common(*choices.values())):
            return None
        if self._copies(second.alpha):
            self.operands.in_blue.discard(_COPIES[second.alpha])
        return Group(number, choices, True, [("a", first.alpha.a, False)])

    # ------------------------------------------------------------------------- what is read and written

    def _write(self, group):
        """Choose the instructions to write, and note what they read of earlier results."""
        number, choices = group.number, group.choices
        common = _in_common(choices["rgb"], choices["a"]) if len(choices) == 2 else None
        if common is None:
            halves = self._in_order(number, {half: found[0] for half, found in choices.items()})
            group.written = [Written(i, half, tuple(s[0] for s in i.sources)) for half, i in halves.items()]
        else:
            first, second, sources = common
            halves = {"rgb": first, "a": second}
            group.written = [Written(halves[half], half, sources) for half in halves]
        whole = number in self.whole
        for half, instruction in halves.items():
            group.reads += [(half, *read) for read in instruction.reads]
        for half, given, by_itself in group.reads:
            if not by_itself:
                self._note(number, half, given)
        for written in group.written:
            register = written.instruction.destination
            for half in ("rgb", "a") if whole and written.mask == "rgb" else (written.mask,):
                self.last[register, half] = written
        for written in group.written:
            self.operands.write(written.instruction.destination, written.mask)
            if whole and written.mask == "rgb":
                self.operands.write(written.instruction.destination, "a")
        for written in group.written:
            if whole and written.mask == "rgb":
                self.operands.in_blue.add(written.instruction.destination)
            elif written.instruction.name == "cnd":
                self.operands.in_blue.discard(Register.SPARE0)

    def _note(self, number, half, given):
        """Note whether an input reads an earlier result clamped to [0, 1]."""
        place = given.register, half_of(given.usage)
        written = self.last.get(place)
        if written is None:
            clamped = given.mapping is Mapping.UNSIGNED_IDENTITY and given.register in _NAMES
            if clamped and place not in self.operands.positive and not self.operands.exact:
                raise _unsayable(
                    number,
                    half,
                    f"it clamps {given.register.name} (UNSIGNED_IDENTITY), which no combiner wrote and which "
                    "may be negative, where _sat clamps what an instruction writes",
                )
            return
        if self.operands.exact:
            written.clamped.add(given.meaning is Meaning.SATURATED)
        elif given.mapping is Mapping.UNSIGNED_IDENTITY:
            written.clamped.add(True)
        elif given.mapping in SIGNED:
            written.clamped.add(False)

    def _in_order(self, number, halves):
        """Halves in the order in which their constants take the registers that they have."""
        if not self.operands.exact or len(halves) < 2:
            return halves
        for order in (("rgb", "a"), ("a", "rgb")):
            stage = Stage(None, "", {})
            reads = [given for half in order for given, _ in halves[half].reads]
            if all(self._placed(stage, number, given) for given in reads if given.register in CONSTANTS):
                return {half: halves[half] for half in order}
        return halves

    def _placed(self, stage, number, given):
        half = half_of(given.usage)
        constant = self.operands.constants[number, given.register, half]
        if half == "rgb" and given.mapping in SIGNED and of_both_signs(self.operands.colors[constant][:3]):
            constant = Part(constant, given.mapping is Mapping.SIGNED_NEGATE)
        place = stage.place(constant, half)
        return place is not None and CONSTANTS[place] is given.register

    def _settle(self, group):
        """Join two equal halves into one instruction, and refuse what one _sat cannot express."""
        for written in group.written:
            if len(written.clamped) == 2:
                name = _NAMES[written.instruction.destination]
                raise _unsayable(
                    group.number,
                    written.mask,
                    f"what it writes to {name} is read clamped to [0, 1] (UNSIGNED_IDENTITY) and as it is, "
                    "where _sat clamps it for all readers",
                )
        if group.number in self.whole:
            for written in group.written:
                written.mask = "" if written.mask == "rgb" else written.mask
        if len(group.written) < 2:
            return
        first, second = group.written
        clamped = first.clamped | second.clamped
        alike = first.sources == second.sources and _alike(first.instruction, second.instruction)
        if alike and len(clamped) < 2:
            group.written = [Written(first.instruction, "", first.sources, clamped)]
            return
        if group.together:
            raise _unsayable(
                group.number,
                "rgb",
                f"{first.instruction.name} writes a color that is read clamped to [0, 1] and an alpha that "
                "is not, or the other way around",
            )


def _halves(stage):
    return ("rgb", stage.rgb), ("a", stage.alpha)


def _alike(first, second):
    return (first.name, first.scale, first.destination) == (second.name, second.scale, second.destination)


def _in_common(firsts, seconds):
    """An instruction of each list that are equal, and the common wording of their sources; or None."""
    for first in firsts:
        for second in seconds:
            if not _alike(first, second):
                continue
            ways = [
                next((way for way in first_ways if way in second_ways), None)
                for first_ways, second_ways in zip(first.sources, second.sources, strict=True)
            ]
            if None not in ways:
                return first, second, tuple(ways)
    return None


def _unsayable(number, half, what):
    return ValueError(
        f"General combiner {number}, {_IN_WORDS[half]}: {what}; ps.1.0 to ps.1.3 cannot say it. Write it as "
        "!!RC1.0 (--rc), or as words of the NV2A's registers (--nv2a)."
    )
