"""The translation of the Xbox's pixel shaders to texture shader stages and register combiners.

An instruction, or a pair, is one general combiner, whose fields its operands name:

    mov d, a           AB = a * 1                      add, sub     AB + CD = a * 1 + (+-b) * 1
    mul, dp3 d, a, b   AB = a * b, a . b               mad          AB + CD = a * b + c * 1
    cnd d, r0, a, b    mux: CD = a * 1, AB = b * 1     lrp          AB + CD = a * b + (1 - a) * c
    xmma, xmmc, xdm, xdd d0, d1, (d2,) a, b, c, d       AB, CD and their sum or mux, as they are named

``_x2``, ``_x4``, ``_d2``, ``_bias`` and ``_bx2`` are the output scale and bias, of every result. The chip's
blue to alpha copies a dot product to its destination's alpha, if it has one. Constants are the two registers
of each combiner, whole, in the order in which the instruction names them; xfc's are the program's. Without
xfc the final combiner gives r0, with fog.

Source: words that an assembler made, in public examples that have text and words. They show that a dp3 of
four components sets blue to alpha and one of .rgb does not, the order of constants, xfc's clamped sum, and
that ``.b`` is red, green and blue for colors and blue for alpha. Inferred: xdm's and xdd's dot products have
their alpha likewise, and the whole of a constant goes to a combiner, because a definition names one for each
of the two registers. Assumed: a program without xfc has fog, which Direct3D sets by its render states.
"""

from dataclasses import replace

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, Mapping, Meaning, Register
from fixedpipe.pipeline.notations.pixel_shader_combiners import (
    ALPHA,
    BLUE,
    CONSTANTS,
    MAPPINGS,
    NEGATED,
    R0,
    REGISTERS,
    RGB,
)
from fixedpipe.pipeline.notations.pixel_shader_notes import unwritten_note
from fixedpipe.pipeline.notations.pixel_shader_textures import WITHOUT_RESULT, ConstantPlace, texture_stages
from fixedpipe.pipeline.notations.pixel_shader_translation import PixelShader
from fixedpipe.pipeline.notations.program_sources import ProgramSources
from fixedpipe.pipeline.notations.register_combiner_words import UNUSED_ALPHA, UNUSED_RGB, UNUSED_STAGE
from fixedpipe.pipeline.notations.xbox_pixel_shaders import read
from fixedpipe.pipeline.programs.combiner_rules import combiner_problems
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)

_HALF = CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF
_OUTPUTS = {
    "": (CombinerScale.NONE, CombinerBias.NONE),
    "x2": (CombinerScale.SCALE_BY_TWO, CombinerBias.NONE),
    "x4": (CombinerScale.SCALE_BY_FOUR, CombinerBias.NONE),
    "d2": (CombinerScale.SCALE_BY_ONE_HALF, CombinerBias.NONE),
    "bias": (CombinerScale.NONE, _HALF),
    "bx2": (CombinerScale.SCALE_BY_TWO, _HALF),
}
_MAPPINGS = MAPPINGS | {("", "sat"): Mapping.UNSIGNED_IDENTITY, ("1-", "sat"): Mapping.UNSIGNED_INVERT}
_NAMED = {
    "zero": Register.ZERO,
    "fog": Register.FOG,
    "prod": Register.E_TIMES_F,
    "sum": Register.SPARE0_PLUS_SECONDARY_COLOR,
}
# The products of each instruction that are dot products; other instructions have none.
_DOTS = {"dp3": (True, False), "xdm": (True, False), "xdd": (True, True)}
_BLACK = (0.0, 0.0, 0.0, 0.0)


def parse(text, targets=None, constants=None, start=(1, 1), per_stage_constants=True):
    """The PixelShader of an ``xps.1.0`` or ``xps.1.1`` program.

    Parameters and errors are those of ``pixel_shader_translation.parse``.
    """
    listing = read(text, start)
    colors = {**(constants or {}), **listing.constants}
    stages, eyes = texture_stages(listing, targets or {}, colors)
    translation = _Translation(listing, colors, None if per_stage_constants else _shared(listing))
    combiners = translation.combiners()
    sources = translation.sources(len(stages or ()))
    for path, sentence in combiner_problems(combiners):
        token = listing.final.token if path[0] == "final" else translation.groups[path[1]][0].token
        raise token.error(sources.tell(sentence, (f"xps.{listing.version}",)))
    places = (*eyes, *translation.places)
    told = sorted(dict.fromkeys((*listing.notes, *translation.notes)))
    return PixelShader(
        listing.version,
        stages,
        combiners,
        places,
        tuple(f"line {line}: {sentence}" for line, sentence in told),
        sources,
        {place.constant: colors.get(place.constant, _BLACK) for place in places},
        frozenset(listing.constants),
    )


class _Constants:
    """The two constant registers of a combiner; ``whose`` names a general or the final combiner in words."""

    def __init__(self, whose):
        self.whose, self.numbers = whose, []

    def register(self, source):
        """The register that holds a source's constant."""
        if source.number not in self.numbers:
            if len(self.numbers) == len(CONSTANTS):
                raise source.token.error(
                    f"c{source.number} is the third constant of {self.whose}, which holds two; move one to a "
                    "register with mov first."
                )
            self.numbers.append(source.number)
        return CONSTANTS[self.numbers.index(source.number)]

    def colors(self, colors):
        """{field: color in [0, 1]} of the state with the registers."""
        return {
            f"constant_color{place}": tuple(max(0.0, min(1.0, c)) for c in colors.get(number, _BLACK))
            for place, number in enumerate(self.numbers)
        }


def _shared(listing):
    """The _Constants of a program whose combiners share two."""
    instructions = [*listing.arithmetic, *([listing.final] if listing.final else [])]
    reads = [source for instruction in instructions for source in instruction.sources if source.name == "c"]
    numbers = list(dict.fromkeys(source.number for source in reads))
    if len(numbers) > len(CONSTANTS):
        third = next(source for source in reads if source.number == numbers[len(CONSTANTS)])
        raise third.token.error(
            f"c{third.number} is the third of {len(numbers)} constants that the program reads "
            f"({', '.join(f'c{number}' for number in numbers)}), and the machine's combiners share two. Read "
            "fewer, or choose a machine with per-stage constants."
        )
    return _Constants("the program")


class _Translation:
    """The instructions of one program, in order.

    ``shared`` are the _Constants of all combiners; None: each has its own.
    """

    def __init__(self, listing, colors, shared):
        self.listing, self.colors, self.shared = listing, colors, shared
        self.groups, self.notes, self.places, self.general = [], [], [], []
        for instruction in listing.arithmetic:
            if instruction.paired:
                self.groups[-1] = (*self.groups[-1], instruction)
            else:
                self.groups.append((instruction,))
        self.texture = {i.unit: i.name for i in listing.texture}
        self.written = {(("v", n), half) for n in (0, 1) for half in ("rgb", "a")}
        for unit, name in self.texture.items():
            if name not in WITHOUT_RESULT:
                self.written |= {(("t", unit), half) for half in ("rgb", "a")}
        for number, group in enumerate(self.groups):
            self.general.append(self.combiner(number, group))

    def combiners(self):
        """The RegisterCombiners."""
        general, xfc = tuple(self.general) or (UNUSED_STAGE,), self.listing.final
        if xfc is None:
            for half in ("rgb", "a"):
                self.check_written(self.listing.end, R0, half)
            final = FinalCombiner(
                b=CombinerInput(Register.SPARE0),
                d=CombinerInput(),
                e=CombinerInput(),
                f=CombinerInput(),
                g=CombinerInput(Register.SPARE0, usage=ALPHA),
            )
            own = self.shared or _Constants("the program")
            self.keep(own, None)
            return RegisterCombiners(general=general, final=final, **own.colors(self.colors))
        own = self.shared or _Constants("the final combiner")
        inputs = {
            variable: self.input(own, "a" if variable == "g" else "rgb", source, final=True)
            for variable, source in zip("abcdefg", xfc.sources, strict=True)
        }
        if any(source.name == "sum" for source in xfc.sources):
            self.check_written(xfc.token, R0, "rgb")
        no_c = (inputs["c"].register, inputs["c"].mapping) == (Register.ZERO, Mapping.UNSIGNED_IDENTITY)
        if inputs["a"].register is Register.SPARE0_PLUS_SECONDARY_COLOR and no_c:
            # A times B is B times A, and of these two only B of the register combiners takes the sum.
            inputs["a"], inputs["b"] = inputs["b"], inputs["a"]
        self.keep(own, None)
        return RegisterCombiners(
            general=general, final=FinalCombiner(**inputs), color_sum_clamp=True, **own.colors(self.colors)
        )

    def sources(self, units):
        """The ProgramSources; ``units`` is the number of texture shader stages."""
        lines = {i.unit: f"line {i.token.line}: {i.name}" for i in self.listing.texture}
        general = tuple(
            f"line {group[0].token.line}: {' + '.join(i.name for i in group)}" for group in self.groups
        )
        xfc = self.listing.final
        final = "r0, with fog" if xfc is None else f"line {xfc.token.line}: xfc"
        return ProgramSources(tuple(lines.get(unit, "") for unit in range(units)), general or ("",), final)

    def keep(self, constants, stage):
        """Note the places of constants: general combiner ``stage``; None: the program's own registers."""
        self.places += [
            ConstantPlace(number, stage, CONSTANTS[place]) for place, number in enumerate(constants.numbers)
        ]

    # ------------------------------------------------------------------------------- one combiner

    def combiner(self, number, group):
        taken = {}
        for instruction in group:
            for half in _halves(instruction):
                if half in taken:
                    raise instruction.token.error(
                        f"{instruction.name} computes {'colors' if half == 'rgb' else 'alpha'}, and so does "
                        "the instruction before the '+'; give one of them .rgb and the other .a."
                    )
                taken[half] = instruction
        own = self.shared or _Constants("one general combiner")
        # The order of the text decides which registers constants take.
        portions = {
            half: self.portion(own, half, instruction)
            for instruction in group
            for half in _halves(instruction)
        }
        for instruction in group:
            self.written |= {(d.register, half) for d in instruction.destinations for half in d.mask}
        colors = {}
        if own is not self.shared:
            self.keep(own, number)
            colors = own.colors(self.colors)
        return GeneralCombiner(
            rgb=portions.get("rgb", UNUSED_RGB), alpha=portions.get("a", UNUSED_ALPHA), **colors
        )

    def portion(self, own, half, instruction):
        """A portion: the instruction's result for red, green and blue, or for alpha."""
        name, dots = instruction.name, _DOTS.get(instruction.name, (False, False))
        usage = RGB if half == "rgb" else ALPHA
        zero, one = CombinerInput(usage=usage), CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, usage)

        def read_(source, **changes):
            return self.input(own, half, source, **changes)

        if name == "lrp":
            variables = self.interpolated(own, half, instruction.sources)
        elif name == "cnd":
            self.check_condition(instruction.sources[0])
            chosen, other = (read_(source) for source in instruction.sources[1:])
            variables = (other, one, chosen, one)
        else:
            given = [read_(source) for source in instruction.sources]
            if name == "sub":
                given[1] = self.negated(given[1], instruction.sources[1])
            if name in ("mov", "add", "sub"):
                given.insert(1, one)
            if name in ("mad", "add", "sub"):
                given.append(one)
            variables = (*given, *(zero,) * (4 - len(given)))
        outputs = self.outputs(instruction, half, dots)
        if half == "a":
            # An alpha portion computes no dot products.
            dropped = "ab" * dots[0] + "cd" * dots[1]
            variables = tuple(zero if v in dropped else i for v, i in zip("abcd", variables, strict=True))
        scale, bias = _OUTPUTS[instruction.modifier]
        shared = dict(zip("abcd", variables, strict=True)) | outputs | {"scale": scale, "bias": bias}
        shared["mux_sum"] = name in ("cnd", "xmmc")
        if half == "a":
            return AlphaPortion(**shared)
        for product, dot, destination in zip(("ab", "cd"), dots, instruction.destinations, strict=False):
            shared[f"{product}_dot_product"] = dot
            shared[f"{product}_blue_to_alpha"] = (
                dot and "a" in destination.mask and destination.register is not None
            )
        return RGBPortion(**shared)

    @staticmethod
    def outputs(instruction, half, dots):
        """{field: register} of a portion's three outputs."""
        names = ("ab_output", "cd_output", "sum_output")
        to = [
            REGISTERS[d.register] if d.register is not None and half in d.mask else Register.DISCARD
            for d in instruction.destinations
        ]
        if instruction.name in ("mad", "add", "sub", "lrp", "cnd"):
            to = [Register.DISCARD, Register.DISCARD, *to]
        to += [Register.DISCARD] * (3 - len(to))
        if half == "a":
            to[:2] = [
                Register.DISCARD if dot else register for dot, register in zip(dots, to[:2], strict=True)
            ]
        return dict(zip(names, to, strict=True))

    @staticmethod
    def check_condition(source):
        if (source.name, source.number) != R0 or source.selector == "b" or source.sign or source.modifier:
            raise source.token.error(
                f"{source.token.text} as the condition of cnd, which is r0.a; write r0.a, and compute it "
                "before."
            )

    @staticmethod
    def negated(given, source):
        mapping = NEGATED.get(given.mapping)
        if given.register is Register.ZERO and given.mapping is Mapping.UNSIGNED_IDENTITY:
            return given
        if mapping is None:
            raise source.token.error(
                f"sub of {source.sign}{source.token.text}, which the hardware cannot negate; move it to a "
                "register with mov first."
            )
        return replace(given, mapping=mapping)

    def interpolated(self, own, half, sources):
        """A, B, C, D of lrp: A is its factor, C is one minus the factor, both in [0, 1]."""
        first = sources[0]
        if first.modifier in ("bias", "bx2") or first.sign == "-":
            raise first.token.error(
                f"lrp by {first.sign}{first.token.text}; the hardware cannot compute one minus it. lrp takes "
                "a register or 1- of one. Compute the factor with mov first."
            )
        factor, complement = (
            self.input(own, half, first._replace(sign=sign, modifier="sat"))
            for sign in (("1-", "") if first.sign else ("", "1-"))
        )
        second, third = (self.input(own, half, source) for source in sources[1:])
        return factor, second, complement, third

    # ------------------------------------------------------------------------------------- operands

    def input(self, own, half, source, final=False):
        """A source as a combiner's variable.

        - ``own``: the constants of its combiner.
        - ``final``: whether it belongs to xfc, which clamps its variables to [0, 1].
        """
        component = "a" if source.selector == "a" or (half == "a" and source.selector is None) else "rgb"
        if source.selector == "b" and half == "rgb":
            name = source.token.text
            self.notes.append(
                (
                    source.token.line,
                    f"{name} is blue for alpha alone; of colors it takes red, green and blue as they are.",
                )
            )
        usage = ALPHA if component == "a" else BLUE if half == "a" else RGB
        mapping = _MAPPINGS[source.sign, source.modifier]
        if source.name == "c":
            register = own.register(source)
        elif source.name in _NAMED:
            register = _NAMED[source.name]
        else:
            register = REGISTERS[source.name, source.number]
            self.check_written(source.token, (source.name, source.number), component)
        if mapping is Mapping.SIGNED_IDENTITY and (final or register is Register.ZERO):
            mapping = Mapping.UNSIGNED_IDENTITY
        if register is Register.ZERO:
            usage = ALPHA if half == "a" else RGB
        saturated = source.modifier == "sat" and not final and register is not Register.ZERO
        meaning = Meaning.SATURATED if saturated else Meaning.PLAIN
        return CombinerInput(register, mapping, usage, meaning)

    def check_written(self, token, register, component):
        """Note or refuse a register that is read before it is written. ``register``: letter and number."""
        if (register, component) in self.written:
            return
        letter, number = register
        if letter == "r":
            self.notes.append(unwritten_note(token.line, register, component))
            return
        given = self.texture.get(number)
        reason = f"{given} gives no color" if given else "no texture instruction gives it"
        raise token.error(f"t{number} is read, but {reason}; write tex t{number} first.")


def _halves(instruction):
    """The portions that an instruction takes, in the order in which its text names colors and alpha."""
    dots = _DOTS.get(instruction.name)
    if dots is None:
        return instruction.halves
    product = [] if all(dots) or instruction.name == "dp3" else [instruction.destinations[1]]
    dotted = [d for d in instruction.destinations if d not in product]
    for destination in dotted:
        if destination.mask == ("a",):
            raise instruction.token.error(
                f"{instruction.name} of alpha alone; dot products are computed of red, green and blue. Write "
                "the whole register or .rgb."
            )
    kept = any("a" in d.mask and d.register is not None for d in product)
    return ("rgb", "a") if kept else ("rgb",)
