"""The translation of Direct3D 8's pixel shaders to texture shader stages and register combiners.

Texture register tN is texture unit N; r0 and r1 are SPARE0 and SPARE1, v0 and v1 the primary and the
secondary color. An arithmetic instruction, or a pair, is one general combiner:

    mov d, a          AB = a * 1                         add, sub    AB + CD = a * 1 + (+-b) * 1
    mul d, a, b       AB = a * b                         mad         AB + CD = a * b + c * 1
    dp3 d, a, b       AB = a . b                         lrp         AB + CD = a * b + (1 - a) * c
    cnd d, r0.a, a, b  mux: CD = a * 1 where SPARE0's alpha is one half and more, AB = b * 1 elsewhere

``_x2``, ``_x4``, ``_d2`` are the output scales; ``_bx2``, ``_bias``, ``1-`` and ``-`` the mappings
EXPAND_NORMAL, HALF_BIAS_NORMAL, UNSIGNED_INVERT and the NEGATE ones. The final combiner gives r0, with fog.
Three things have no field of their own:

- ``_sat``: the register keeps [-1, 1]. Its readers map by UNSIGNED_IDENTITY, which clamps negative values.
  Their meaning is a saturated value, which the ideal uses.
- The alpha of a ``dp3``: an alpha portion has no dot product. Red, green and blue are equal, so a reader of
  the alpha takes another component. Only where that is impossible (``cnd``, red, green and blue overwritten)
  is blue copied: by a free alpha portion, or by one more general combiner. Where there would be more than
  eight, the chip's own blue to alpha copies it.
- A negative constant: constants are in [0, 1], so the magnitude is stored and the reader negates. For red,
  green and blue of both signs, from -128/255 to 127/255, the numbers that HALF_BIAS_NORMAL maps to them are
  stored. For others it is those that EXPAND_NORMAL maps to them; these are even, so they are off by up to
  1/255. Where they are off, ``mov`` and ``mul`` read both constant registers: one has the positive
  components, the other the negative ones, and the result is exact. Other instructions get a note (Inferred:
  there is no other signed reading of a constant; a GeForce 3's output would settle which of them its driver
  chose).

``cmp`` and ``dp4`` take two general combiners each, as their cost in instruction slots suggests.

Where nvparse's translation differs from Direct3D's definition, the definition counts. The differences: it
exchanges ``cnd``'s two values, reads ``-r0`` as one minus, drops ``_sat``, and gives a constant that is named
twice two places.

Source: NV_register_combiners, NV_texture_shader; the DirectX 8.1 reference; nvparse's ps1.0_program.cpp, as
distributed with OGRE 3D, for the correspondence.
"""

from dataclasses import dataclass, field, replace

from fixedpipe.pipeline.enums import Mapping, Meaning, Register
from fixedpipe.pipeline.notations.pixel_shader_combiners import (
    ALPHA,
    BLUE,
    CONSTANTS,
    MAPPINGS,
    NEGATED,
    ONE_OR_MINUS_ONE,
    R0,
    READINGS,
    REGISTERS,
    RGB,
    SCALES,
    SIGNED,
    Dot,
    Operand,
    Part,
    Stage,
    compared,
    constant_colors,
    copy_of_blue,
    of_both_signs,
    one_operand,
    product,
    reading,
    share_constants,
    stored,
    sum_of_products,
    worst_step,
)
from fixedpipe.pipeline.notations.pixel_shader_notes import unwritten_note, validator_notes
from fixedpipe.pipeline.notations.pixel_shader_textures import WITHOUT_RESULT, ConstantPlace, texture_stages
from fixedpipe.pipeline.notations.pixel_shaders import (
    OVER_TWO_COMBINERS,
    grouped,
    half_read,
    halves_read,
    read,
    too_many_combiners,
)
from fixedpipe.pipeline.notations.program_sources import ProgramSources
from fixedpipe.pipeline.notations.register_combiner_words import (
    MAPPINGS_OF_ONE,
    MAX_GENERAL_COMBINERS,
    UNUSED_STAGE,
)
from fixedpipe.pipeline.state import (
    AlphaPortion,
    Color,
    CombinerInput,
    FinalCombiner,
    RegisterCombiners,
    RGBPortion,
    TextureShaderStage,
)


@dataclass(frozen=True)
class PixelShader:
    """A translated program.

    - ``texture_shader``: None without texture instructions; each unit then samples its bound texture.
    - ``notes``: sentences on what Direct3D would refuse and the hardware does not.
    - ``sources``, ``colors``, ``defined``: as in a Program.
    """

    version: str
    texture_shader: tuple[TextureShaderStage, ...] | None
    combiners: RegisterCombiners
    constants: tuple[ConstantPlace, ...]
    notes: tuple[str, ...] = ()
    sources: ProgramSources = field(default_factory=ProgramSources, compare=False)
    colors: dict[int, Color] = field(default_factory=dict)
    defined: frozenset[int] = frozenset()


def parse(text, targets=None, constants=None, start=(1, 1), per_stage_constants=True):
    """The PixelShader of a ``ps.1.0`` to ``ps.1.3`` program.

    - ``targets``: {unit: TextureTarget} of the bound textures, from which Direct3D and nvparse learn them.
      Default: a 2D texture, or a cube map for texm3x3tex, texm3x3spec and texm3x3vspec.
    - ``constants``: {number: color} of constants that the program does not define itself; black by default.
    - ``start``: the line and column of the text's beginning, for errors.
    - ``per_stage_constants``: whether each general combiner has two constants; otherwise the program has two.

    Raises PixelShaderTextError with line and column, both from 1, where the text is no program, and where the
    state cannot hold it. ``fixedpipe.pipeline.validation`` checks a machine's numbers of combiners and units.
    """
    listing = read(text, start)
    colors = {**(constants or {}), **listing.constants}
    stages, eyes = texture_stages(listing, targets or {}, colors)
    for blue_to_alpha in (False, True):
        translation = _Translation(listing, colors, blue_to_alpha)
        translation.run()
        if len(translation.stages) <= MAX_GENERAL_COMBINERS:
            break
    else:
        raise too_many_combiners(translation.stages[MAX_GENERAL_COMBINERS].token)
    if not per_stage_constants:
        translation.share_constants()
    places = (*eyes, *translation.constant_places())
    told = sorted(dict.fromkeys((*listing.notes, *validator_notes(listing), *translation.notes)))
    notes = tuple(f"line {line}: {sentence}" for line, sentence in told)
    return PixelShader(
        listing.version,
        stages,
        translation.combiners(),
        places,
        notes,
        translation.sources(len(stages or ())),
        {number: translation.color(number) for number in sorted({place.constant for place in places})},
        frozenset(listing.constants),
    )


# -------------------------------------------------------------------------------- general combiners


class _Translation:
    """The arithmetic instructions of one program, in order."""

    def __init__(self, listing, colors, blue_to_alpha):
        self.listing, self.blue_to_alpha = listing, blue_to_alpha
        self.colors = colors
        self.groups = grouped(listing.arithmetic)
        self.stages, self.notes = [], []
        self.held = {number: self.color(number) for number in range(8)}  # black is stored unchanged
        self.held |= {number: stored(color) for number, color in colors.items()}
        self.places, self.stored = ({}, {}), {}  # for constants that all general combiners share
        self.dots = {}  # registers whose alpha is in blue
        self.equal = set()  # registers whose four components are equal
        self.saturated = set()  # (register, half) that readers must clamp
        self.written = {(("v", n), half) for n in (0, 1) for half in ("rgb", "a")}
        self.texture = {i.unit: i.name for i in listing.texture}
        # (register, half) that are 1.  Source: texcoord, whose fourth component is 1.
        self.ones = {(("t", unit), "a") for unit, name in self.texture.items() if name == "texcoord"}
        for unit in range(4):
            if not self.texture or self.texture.get(unit, WITHOUT_RESULT[0]) not in WITHOUT_RESULT:
                self.written |= {(("t", unit), half) for half in ("rgb", "a")}

    def run(self):
        for number, group in enumerate(self.groups):
            if len(self.stages) > MAX_GENERAL_COMBINERS:
                return
            if group[0].name in OVER_TWO_COMBINERS:
                self.over_two_combiners(number, group[0])
            else:
                self.over_one_combiner(number, group)
        for half in ("rgb", "a"):
            if (R0, half) not in self.written:
                self.notes.append(unwritten_note(self.listing.end.line, R0, half))

    def combiners(self):
        zero = CombinerInput()
        usage = BLUE if R0 in self.dots else ALPHA
        final = FinalCombiner(
            b=CombinerInput(Register.SPARE0),
            d=zero,
            e=zero,
            f=zero,
            g=CombinerInput(Register.SPARE0, usage=usage),
        )
        general = tuple(stage.build() for stage in self.stages)
        return RegisterCombiners(
            general=general or (UNUSED_STAGE,), final=final, **constant_colors(self.places, self.stored)
        )

    def sources(self, units):
        """The ProgramSources; ``units`` is the number of texture shader stages."""
        lines = {i.unit: f"line {i.token.line}: {i.name}" for i in self.listing.texture}
        general = tuple(stage.says for stage in self.stages) or ("",)
        return ProgramSources(tuple(lines.get(unit, "") for unit in range(units)), general, "r0, with fog")

    def constant_places(self):
        return tuple(
            ConstantPlace(constant, number, CONSTANTS[place], half if shared else "rgba")
            for number, places in [(None, self.places), *((n, s.places) for n, s in enumerate(self.stages))]
            for place, halves in enumerate(places)
            for numbers in [{half: _number(key) for half, key in halves.items()}]
            for shared in [len(set(numbers.values())) > 1]
            for half, constant in numbers.items()
            if shared or half == next(iter(numbers))
        )

    def share_constants(self):
        """Move the constants of all general combiners to the program's own two."""
        for stage in self.stages:
            self.stored |= stage.colors
        self.places = share_constants(self.stages)

    def new_stage(self, token, what):
        return Stage(token, f"line {token.line}: {what}", dict(self.held))

    def color(self, number):
        return self.colors.get(number, (0.0, 0.0, 0.0, 0.0))

    # ------------------------------------------------------------------------------- one combiner

    def over_one_combiner(self, number, group):
        halves = {}
        for instruction in group:
            if instruction.name == "dp3" and "rgb" not in instruction.mask:
                raise instruction.token.error(
                    "dp3 of alpha alone; dot products are computed of red, green and blue. Write r0 or "
                    "r0.rgb, and take its alpha."
                )
            for half in instruction.mask:
                if half in halves:
                    raise instruction.token.error(
                        f"{instruction.name} writes the {'color' if half == 'rgb' else 'alpha'} that the "
                        "instruction before the '+' writes too; give one of them .rgb and the other .a."
                    )
                halves[half] = instruction
        for instruction in group:
            if instruction.name == "cnd":
                self.check_condition(instruction)
                self.alpha_of_its_own(R0, instruction.token)
        endangered = self.endangered(number, group)
        if "a" in halves:
            for register in endangered:
                self.alpha_of_its_own(register, group[0].token)
        stage = self.new_stage(group[0].token, " + ".join(instruction.name for instruction in group))
        stage.divides = _colors_of_constants(halves) == 1
        for half, instruction in halves.items():
            if half == "rgb":
                stage.rgb = self.portion(stage, half, instruction)
            elif instruction.name != "dp3":
                stage.alpha = self.portion(stage, half, instruction)
        if endangered and "a" not in halves:
            stage.alpha = copy_of_blue(endangered[0])
        self.stages.append(stage)
        for half, instruction in halves.items():
            self.note(half, instruction)
        for instruction in group:
            if instruction.name == "dp3" and "a" in instruction.mask:
                self.equal.add(instruction.destination)
                self.dots[instruction.destination] = Dot(len(self.stages) - 1, len(self.stages))

    def check_condition(self, instruction):
        source = instruction.sources[0]
        if source.register != R0 or source.selector != "a" or source.sign or source.modifier:
            raise source.token.error(
                f"{source.token.text} as the condition of cnd, which is r0.a; write r0.a, and compute it "
                "before."
            )
        self.check_written(source, "a")

    def note(self, half, instruction):
        register = instruction.destination
        self.written.add((register, half))
        self.ones.discard((register, half))
        self.equal.discard(register)
        self.dots.pop(register, None)
        if instruction.saturate:
            self.saturated.add((register, half))
        else:
            self.saturated.discard((register, half))

    def portion(self, stage, half, instruction):
        name, sources = instruction.name, instruction.sources
        one = one_operand(half)

        def operand(source, **changes):
            return self.operand(stage, half, source._replace(**changes))

        cd, dot, mux, summed = None, False, False, True
        divided = next((s for s in sources if stage.divides and self.is_divided(half, s)), None)
        if divided and name in ("mov", "mul"):
            first, second = self.parts(stage, half, divided)
            rest = [one if name == "mov" else operand(s) for s in sources if s is not divided] or [one]
            ab, cd = [first, *rest], [second, *rest]
            if divided is not sources[0]:
                ab, cd = ab[::-1], cd[::-1]
        elif name == "mov":
            ab, summed = (operand(sources[0]), one), False
        elif name in ("mul", "dp3"):
            ab, summed, dot = (operand(sources[0]), operand(sources[1])), False, name == "dp3"
        elif name == "mad":
            ab, cd = (operand(sources[0]), operand(sources[1])), (operand(sources[2]), one)
        elif name in ("add", "sub"):
            ab, cd = (operand(sources[0]), one), (operand(sources[1]), one)
            if name == "sub":
                cd = (cd[0]._replace(negated=not cd[0].negated), one)
        elif name == "lrp":
            ab, cd = self.interpolated(stage, half, sources)
        else:
            cd, ab, mux = (operand(sources[1]), one), (operand(sources[2]), one), True
        a, b = product(instruction, *ab)
        c, d = product(instruction, *cd) if cd else (CombinerInput(usage=one.input.usage),) * 2
        output = REGISTERS[instruction.destination]
        given = {"ab_dot_product": dot} if half == "rgb" else {}
        return (RGBPortion if half == "rgb" else AlphaPortion)(
            a=a,
            b=b,
            c=c,
            d=d,
            ab_output=Register.DISCARD if summed else output,
            sum_output=output if summed else Register.DISCARD,
            scale=SCALES[instruction.scale],
            mux_sum=mux,
            **given,
        )

    def interpolated(self, stage, half, sources):
        """The two products of lrp: by src0 and by one minus src0, both in [0, 1]."""
        first = sources[0]
        if first.modifier or first.sign == "-":
            raise first.token.error(
                f"lrp by {first.sign}{first.token.text}; the hardware cannot compute one minus it. lrp takes "
                "a register or 1- of one. Compute the factor with mov first."
            )
        inputs = []
        for sign in ("", "1-"):
            operand = self.operand(stage, half, first._replace(sign=sign), unsigned=True)
            inputs.append(operand)
        if first.sign == "1-":
            inputs.reverse()
        second, third = (self.operand(stage, half, source) for source in sources[1:])
        return (inputs[0], second), (inputs[1], third)

    # ------------------------------------------------------------------------------ two combiners

    def over_two_combiners(self, number, instruction):
        group = self.groups[number]
        if len(group) > 1:
            raise group[1].token.error(
                f"{instruction.name} with a '+'; it takes both halves of two general combiners. Remove the "
                "'+'."
            )
        if instruction.name == "dp4":
            self.four_component_dot_product(instruction)
        else:
            self.comparison(number, instruction)

    def four_component_dot_product(self, instruction):
        """The dot product of three components and the product of the fourth, then their sum."""
        if instruction.mask != ("rgb", "a"):
            raise instruction.token.error(
                "dp4 writes a part of its destination and needs the other part for a product; write the "
                "whole register."
            )
        target = REGISTERS[instruction.destination]
        plain = instruction._replace(scale="", name="dp3")
        first = self.new_stage(instruction.token, "dp4, its products")
        first.rgb = self.portion(first, "rgb", plain)
        first.alpha = self.portion(first, "a", plain._replace(name="mul"))
        second = self.new_stage(instruction.token, "dp4, their sum")
        second.rgb, second.alpha = sum_of_products(target, SCALES[instruction.scale])
        self.stages += [first, second]
        for half in instruction.mask:
            self.note(half, instruction)
        self.equal.add(instruction.destination)

    def comparison(self, number, instruction):
        """Compute (src0 + 1) / 2 in SPARE0's alpha, which is one half or more where src0 is not negative."""
        tested = instruction.sources[0]
        scalar = tested.selector is not None or instruction.mask == ("a",) or tested.register in self.equal
        if not scalar:
            raise tested.token.error(
                f"cmp by the components of {tested.token.text}; register combiners choose by one alpha, "
                "for all components. Compare .a, or what a dp3 or dp4 gave."
            )
        for register in self.endangered(number, self.groups[number]):
            self.alpha_of_its_own(register, instruction.token)
        reads = halves_read(instruction._replace(sources=instruction.sources[1:]))
        own = instruction.destination == R0 and "a" in instruction.mask
        if R0 not in self.dots and ((R0, "a") in reads or (not own and self.needed(number, R0, "a"))):
            raise instruction.token.error(
                "cmp needs the alpha of r0, where register combiners compare, and the program still reads "
                "r0.a; move that to r1.a before."
            )
        first = self.new_stage(instruction.token, "cmp, what is compared")
        first.alpha = compared(*product(instruction, self.operand(first, "a", tested), one_operand("a")))
        self.stages.append(first)
        if R0 in self.dots:
            self.dots[R0].free_from = len(self.stages)
        else:
            self.saturated.discard((R0, "a"))
        second = self.new_stage(instruction.token, "cmp, what is chosen")
        for half in instruction.mask:
            portion = self.portion(second, half, instruction)
            setattr(second, "rgb" if half == "rgb" else "alpha", portion)
        self.stages.append(second)
        for half in instruction.mask:
            self.note(half, instruction)

    # ------------------------------------------------------------------------- alphas of dot products

    def needed(self, number, register, half):
        """Whether anything after group ``number`` reads this half of a register before it is written."""
        for group in self.groups[number + 1 :]:
            if any((register, half) in halves_read(instruction) for instruction in group):
                return True
            if any(i.destination == register and half in i.mask for i in group):
                return False
        return register == R0

    def endangered(self, number, group):
        """The registers whose alpha is in a blue that the group overwrites, and is still needed."""
        whole = {i.destination for i in group if "a" in i.mask}
        return [
            register
            for register in dict.fromkeys(i.destination for i in group)
            if register in self.dots and register not in whole and self.needed(number, register, "a")
        ]

    def alpha_of_its_own(self, register, token):
        """Copy an alpha that is in blue to the register's alpha."""
        if register not in self.dots:
            return
        dot = self.dots.pop(register)
        if self.blue_to_alpha and dot.free_from == dot.stage + 1:
            stage = self.stages[dot.stage]
            stage.rgb = replace(stage.rgb, ab_blue_to_alpha=True)
            return
        for stage in self.stages[dot.free_from :]:
            if stage.alpha is None:
                stage.alpha = copy_of_blue(register)
                return
        stage = self.new_stage(token, f"the alpha of {''.join(map(str, register))} for it, from blue")
        stage.alpha = copy_of_blue(register)
        self.stages.append(stage)

    # ------------------------------------------------------------------------------------- operands

    def check_written(self, source, component):
        if source.letter == "c" or (source.register, component) in self.written:
            return
        if source.letter == "r":
            self.notes.append(unwritten_note(source.token.line, source.register, component))
            return
        name, given = f"t{source.number}", self.texture.get(source.number)
        reason = f"{given} gives no color" if given else "no texture instruction gives it"
        raise source.token.error(f"{name} is read, but {reason}; write tex {name} first.")

    def operand(self, stage, half, source, unsigned=False):
        """A source as a combiner's input; ``unsigned`` clamps it to [0, 1]."""
        if source.selector == "b" and half == "rgb":
            raise source.token.error(
                f"{source.token.text} for red, green and blue; only alpha takes .b. Write the destination "
                ".a, or take .a."
            )
        component = half_read(half, source)
        self.check_written(source, component)
        usage = ALPHA if component == "a" else (BLUE if half == "a" else RGB)
        mapping = MAPPINGS[source.sign, source.modifier]
        if source.letter == "c":
            return self.constant(stage, source, usage, mapping, unsigned)
        if (source.register, component) in self.ones:
            one = one_operand(half).input
            if mapping in ONE_OR_MINUS_ONE:
                return Operand(one, mapping in (Mapping.SIGNED_NEGATE, Mapping.EXPAND_NEGATE))
            return Operand(replace(one, mapping=MAPPINGS_OF_ONE[mapping]))
        if component == "a" and source.register in self.dots:
            usage = BLUE if half == "a" else RGB
        negated = False
        saturated = unsigned or (source.register, component) in self.saturated
        if mapping in SIGNED and saturated:
            negated, mapping = mapping is Mapping.SIGNED_NEGATE, Mapping.UNSIGNED_IDENTITY
        meaning = Meaning.SATURATED if saturated else Meaning.PLAIN
        return Operand(CombinerInput(REGISTERS[source.register], mapping, usage, meaning), negated)

    def is_divided(self, half, source):
        """Whether a source is a color of both signs that one input cannot read as exactly as bytes can."""
        if source.letter != "c" or source.modifier or source.sign == "1-" or half_read(half, source) == "a":
            return False
        color = self.color(source.number)
        return of_both_signs(color[:3]) and worst_step(color) is not None

    def parts(self, stage, half, source):
        """Two inputs whose sum is exactly a color of both signs, with a constant each."""
        inputs, usage = [], RGB if half == "rgb" else BLUE
        for negative in (False, True):
            part = Part(source.number, negative)
            stage.colors[part] = part.stored(self.color(source.number))
            mapping = Mapping.SIGNED_NEGATE if negative is (source.sign == "") else Mapping.SIGNED_IDENTITY
            inputs.append(Operand(CombinerInput(CONSTANTS[stage.place(part, "rgb")], mapping, usage)))
        return inputs

    def constant(self, stage, source, usage, mapping, unsigned):
        color = self.color(source.number)
        read_values = color[3:] if usage is ALPHA else color[:3]
        meaning = Meaning.PLAIN
        if any(value < 0 for value in read_values):
            if mapping not in SIGNED or unsigned:
                raise source.token.error(
                    f"c{source.number} is {color}; a combiner's constants are in [0, 1], so a negative one "
                    "cannot be read with a modifier. Change the constant instead."
                )
            if of_both_signs(read_values):
                mapping, meaning = READINGS[reading(color)][mapping], Meaning.SIGNED_CONSTANT
                self.note_step(source)
            else:
                mapping = NEGATED[mapping]
        place = stage.place(source.number, "a" if usage is ALPHA else "rgb")
        if place is None:
            raise source.token.error(
                f"the {'alpha' if usage is ALPHA else 'color'} of c{source.number} is the third constant "
                "that one general combiner reads, and it has two; move one to a register with mov first."
            )
        if unsigned and mapping in SIGNED:
            mapping = Mapping.UNSIGNED_IDENTITY
        return Operand(CombinerInput(CONSTANTS[place], mapping, usage, meaning))

    def note_step(self, source):
        worst = worst_step(self.color(source.number))
        if worst is not None:
            component, step = worst
            value = self.color(source.number)[component]
            sentence = (
                f"c{source.number}'s {('red', 'green', 'blue')[component]}, {value:.4g}, is read as "
                f"{step}/255: red, green and blue of both signs have even steps in one input; mov the "
                "constant to a register first, which is exact."
            )
            self.notes.append((source.token.line, sentence))


def _number(key):
    """The number of the constant in a half of a place, or of the constant that it is a Part of."""
    return key.number if isinstance(key, Part) else key


def _colors_of_constants(halves):
    """The number of inputs of a combiner's portions, {half: instruction}, that are colors of constants."""
    return sum(
        source.letter == "c" and half_read(half, source) == "rgb"
        for half, instruction in halves.items()
        for source in instruction.sources
    )
