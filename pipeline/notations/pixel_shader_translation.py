"""The translation of Direct3D 8's pixel shaders to texture shader stages and register combiners.

Texture register tN is texture unit N; r0 and r1 are SPARE0 and SPARE1, v0 and v1 the primary and the
secondary color, and an arithmetic instruction, or a pair, is one general combiner:

    mov d, a          AB = a * 1                         add, sub    AB + CD = a * 1 + (+-b) * 1
    mul d, a, b       AB = a * b                         mad         AB + CD = a * b + c * 1
    dp3 d, a, b       AB = a . b                         lrp         AB + CD = a * b + (1 - a) * c
    cnd d, r0.a, a, b  mux: CD = a * 1 where SPARE0's alpha is one half and more, AB = b * 1 elsewhere

``_x2``, ``_x4``, ``_d2`` are the output scales; ``_bx2``, ``_bias``, ``1-`` and ``-`` the mappings
EXPAND_NORMAL, HALF_BIAS_NORMAL, UNSIGNED_INVERT and the NEGATE ones. The final combiner gives r0, with fog.
Three things have no field of their own:

- ``_sat``: the register keeps [-1, 1]; who reads it maps by UNSIGNED_IDENTITY, which clamps negative values.
- The alpha of a ``dp3``: an alpha portion has no dot product. As red, green and blue are equal, who reads the
  alpha takes another component, and only where that is impossible (``cnd``, red, green and blue overwritten)
  is blue copied, by an alpha portion that is free or by one more general combiner, or, where there would be
  more than eight, by the chip's own blue to alpha.
- A negative constant: constants are in [0, 1], so the magnitude is stored and the reader negates; of red,
  green and blue of both signs what EXPAND_NORMAL maps to them is stored, which is even, and so off by up to
  1/255 (Inferred: there is no other signed reading of a constant; a GeForce 3's output would settle it).

``cmp`` and ``dp4`` take two general combiners each, as their cost in instruction slots says they did.

Where nvparse's translation differs from Direct3D's definition (``cnd`` with its two values exchanged, ``-r0``
as one minus, ``_sat`` dropped, a constant that is named twice taking two places) the definition is followed.

Source: NV_register_combiners, NV_texture_shader; the DirectX 8.1 reference; nvparse's ps1.0_program.cpp, as
distributed with OGRE 3D, for the correspondence.
"""

from dataclasses import dataclass, field, replace
from typing import NamedTuple

from fixedpipe.pipeline.enums import CombinerScale, ComponentUsage, Mapping, Register
from fixedpipe.pipeline.notations.pixel_shader_textures import WITHOUT_RESULT, ConstantPlace, texture_stages
from fixedpipe.pipeline.notations.pixel_shaders import grouped, half_read, halves_read, read
from fixedpipe.pipeline.notations.register_combiner_words import (
    MAX_GENERAL_COMBINERS,
    UNUSED_ALPHA,
    UNUSED_RGB,
    UNUSED_STAGE,
)
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
    TextureShaderStage,
)

_RGB, _ALPHA, _BLUE = ComponentUsage.RGB, ComponentUsage.ALPHA, ComponentUsage.BLUE

_REGISTERS = {
    ("r", 0): Register.SPARE0,
    ("r", 1): Register.SPARE1,
    ("v", 0): Register.PRIMARY_COLOR,
    ("v", 1): Register.SECONDARY_COLOR,
    ("t", 0): Register.TEXTURE0,
    ("t", 1): Register.TEXTURE1,
    ("t", 2): Register.TEXTURE2,
    ("t", 3): Register.TEXTURE3,
}
_R0 = ("r", 0)
_CONSTANTS = (Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1)
_SCALES = {
    "": CombinerScale.NONE,
    "x2": CombinerScale.SCALE_BY_TWO,
    "x4": CombinerScale.SCALE_BY_FOUR,
    "d2": CombinerScale.SCALE_BY_ONE_HALF,
}
_MAPPINGS = {
    ("", ""): Mapping.SIGNED_IDENTITY,
    ("-", ""): Mapping.SIGNED_NEGATE,
    ("", "bx2"): Mapping.EXPAND_NORMAL,
    ("-", "bx2"): Mapping.EXPAND_NEGATE,
    ("", "bias"): Mapping.HALF_BIAS_NORMAL,
    ("-", "bias"): Mapping.HALF_BIAS_NEGATE,
    ("1-", ""): Mapping.UNSIGNED_INVERT,
}
_SIGNED = (Mapping.SIGNED_IDENTITY, Mapping.SIGNED_NEGATE)
_NEGATED = {
    Mapping.SIGNED_IDENTITY: Mapping.SIGNED_NEGATE,
    Mapping.EXPAND_NORMAL: Mapping.EXPAND_NEGATE,
    Mapping.HALF_BIAS_NORMAL: Mapping.HALF_BIAS_NEGATE,
}
_NEGATED |= {negated: mapping for mapping, negated in _NEGATED.items()}
_EXPANDED = {
    Mapping.SIGNED_IDENTITY: Mapping.EXPAND_NORMAL,
    Mapping.SIGNED_NEGATE: Mapping.EXPAND_NEGATE,
}


@dataclass(frozen=True)
class PixelShader:
    """A translated program. ``texture_shader`` is None where it has no texture instruction: units then sample
    what is bound to them. ``notes``: sentences on what Direct3D would refuse and the hardware does not.
    """

    version: str
    texture_shader: tuple[TextureShaderStage, ...] | None
    combiners: RegisterCombiners
    constants: tuple[ConstantPlace, ...]
    notes: tuple[str, ...] = ()


def parse(text, targets=None, constants=None, start=(1, 1)):
    """The PixelShader that a ``ps.1.0`` to ``ps.1.3`` program asks for.

    ``targets``: {unit: TextureTarget} of the textures that will be bound, as Direct3D and nvparse learn them
    from what is bound; where there is none, a 2D texture, or a cube map for texm3x3tex, texm3x3spec and
    texm3x3vspec. ``constants``: {number: color} of constants that the program does not define itself, black
    where there is none. ``start``: the line and column at which errors take the text to begin.

    Raises PixelShaderTextError with line and column, both from 1, where the text is no program, and where the
    state cannot hold it. ``fixedpipe.pipeline.validation`` checks how many combiners and units a machine has.
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
        raise translation.stages[MAX_GENERAL_COMBINERS].token.error(
            f"the {len(translation.stages)} general combiners that this program takes are more than the "
            f"{MAX_GENERAL_COMBINERS} of any machine, from here on. Split it into passes."
        )
    places = (*eyes, *translation.constant_places())
    notes = tuple(dict.fromkeys(translation.notes))
    return PixelShader(listing.version, stages, translation.combiners(), places, notes)


# -------------------------------------------------------------------------------- general combiners


@dataclass
class _Stage:
    """A general combiner in the making; ``places``: which constant registers hold which of the program's."""

    token: object
    colors: dict
    rgb: RGBPortion | None = None
    alpha: AlphaPortion | None = None
    places: dict = field(default_factory=dict)

    def build(self):
        own = {f"constant_color{place}": self.colors[number] for number, place in self.places.items()}
        return GeneralCombiner(rgb=self.rgb or UNUSED_RGB, alpha=self.alpha or UNUSED_ALPHA, **own)


class _Operand(NamedTuple):
    """An input, and whether it is still to be negated, for it has a mapping that cannot be."""

    input: CombinerInput
    negated: bool = False


@dataclass
class _Dot:
    """Where an alpha stays in blue: the general combiner of the dot product, and the one from which on the
    register's own alpha may be written.
    """

    stage: int
    free_from: int


def _one(half):
    return _Operand(CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, _RGB if half == "rgb" else _ALPHA))


class _Translation:
    """The arithmetic instructions of one program, in order."""

    def __init__(self, listing, colors, blue_to_alpha):
        self.listing, self.blue_to_alpha = listing, blue_to_alpha
        self.colors = colors
        self.groups = grouped(listing.arithmetic)
        self.stages, self.notes = [], []
        self.dots = {}  # registers whose alpha is in blue
        self.equal = set()  # registers whose four components are equal
        self.saturated = set()  # (register, half) that readers have to clamp
        self.written = {(("v", n), half) for n in (0, 1) for half in ("rgb", "a")}
        self.texture = {i.destination[1]: i.name for i in listing.texture}
        for unit in range(4):
            if not self.texture or self.texture.get(unit, WITHOUT_RESULT[0]) not in WITHOUT_RESULT:
                self.written |= {(("t", unit), half) for half in ("rgb", "a")}

    def run(self):
        for number, group in enumerate(self.groups):
            if group[0].name in ("cmp", "dp4"):
                self.over_two_combiners(number, group[0])
            else:
                self.over_one_combiner(number, group)
        for half in ("rgb", "a"):
            if (_R0, half) not in self.written:
                self.unwritten(self.listing.end, _R0, half)

    def unwritten(self, token, register, half):
        name, what = "".join(map(str, register)), "alpha" if half == "a" else "color"
        value = "texture 0's alpha" if (register, half) == (_R0, "a") else "zero"
        self.notes.append(
            f"line {token.line}: {name}'s {what} is read before anything is written to it, which Direct3D "
            f"refuses; the register begins as {value}."
        )

    def combiners(self):
        zero = CombinerInput()
        usage = _BLUE if _R0 in self.dots else _ALPHA
        final = FinalCombiner(
            b=CombinerInput(Register.SPARE0),
            d=zero,
            e=zero,
            f=zero,
            g=CombinerInput(Register.SPARE0, usage=usage),
        )
        general = tuple(stage.build() for stage in self.stages)
        return RegisterCombiners(general=general or (UNUSED_STAGE,), final=final)

    def constant_places(self):
        return tuple(
            ConstantPlace(constant, number, _CONSTANTS[place])
            for number, stage in enumerate(self.stages)
            for constant, place in stage.places.items()
        )

    def new_stage(self, token):
        return _Stage(token, {number: _stored(self.color(number)) for number in range(8)})

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
                self.alpha_of_its_own(_R0, instruction.token)
        endangered = self.endangered(number, group)
        if "a" in halves:
            for register in endangered:
                self.alpha_of_its_own(register, group[0].token)
        stage = self.new_stage(group[0].token)
        for half, instruction in halves.items():
            if half == "rgb":
                stage.rgb = self.portion(stage, half, instruction)
            elif instruction.name != "dp3":
                stage.alpha = self.portion(stage, half, instruction)
        if endangered and "a" not in halves:
            stage.alpha = _copy_of_blue(endangered[0])
        self.stages.append(stage)
        for half, instruction in halves.items():
            self.note(half, instruction)
        for instruction in group:
            if instruction.name == "dp3" and "a" in instruction.mask:
                self.equal.add(instruction.destination)
                self.dots[instruction.destination] = _Dot(len(self.stages) - 1, len(self.stages))

    def check_condition(self, instruction):
        source = instruction.sources[0]
        if source.register != _R0 or source.selector != "a" or source.sign or source.modifier:
            raise source.token.error(
                f"{source.token.text} as the condition of cnd, which is r0.a; write r0.a, and compute it "
                "before."
            )
        self.check_written(source, "a")

    def note(self, half, instruction):
        register = instruction.destination
        self.written.add((register, half))
        self.equal.discard(register)
        self.dots.pop(register, None)
        if instruction.saturate:
            self.saturated.add((register, half))
        else:
            self.saturated.discard((register, half))

    def portion(self, stage, half, instruction):
        name, sources = instruction.name, instruction.sources
        one = _one(half)

        def operand(source, **changes):
            return self.operand(stage, half, source._replace(**changes))

        cd, dot, mux, summed = None, False, False, True
        if name == "mov":
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
        a, b = _product(instruction, *ab)
        c, d = _product(instruction, *cd) if cd else (CombinerInput(usage=one.input.usage),) * 2
        output = _REGISTERS[instruction.destination]
        given = {"ab_dot_product": dot} if half == "rgb" else {}
        return (RGBPortion if half == "rgb" else AlphaPortion)(
            a=a,
            b=b,
            c=c,
            d=d,
            ab_output=Register.DISCARD if summed else output,
            sum_output=output if summed else Register.DISCARD,
            scale=_SCALES[instruction.scale],
            mux_sum=mux,
            **given,
        )

    def interpolated(self, stage, half, sources):
        """The two products of lrp: src0 and one minus src0, both in [0, 1]."""
        first = sources[0]
        if first.modifier or first.sign == "-":
            raise first.token.error(
                f"lrp by {first.sign}{first.token.text}, of which the hardware has no complement; lrp "
                "takes a register or 1- of one. Compute the factor with mov first."
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
                "dp4 of a part of its destination, whose other part has to hold a product meanwhile; "
                "write the whole register."
            )
        target = _REGISTERS[instruction.destination]
        plain = instruction._replace(scale="", name="dp3")
        first = self.new_stage(instruction.token)
        first.rgb = self.portion(first, "rgb", plain)
        first.alpha = self.portion(first, "a", plain._replace(name="mul"))
        second = self.new_stage(instruction.token)
        halves = {"rgb": (RGBPortion, _RGB, _RGB), "alpha": (AlphaPortion, _ALPHA, _BLUE)}
        for name, (kind, usage, dot) in halves.items():
            one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, usage)
            portion = kind(
                a=CombinerInput(target, Mapping.SIGNED_IDENTITY, dot),
                b=one,
                c=CombinerInput(target, Mapping.SIGNED_IDENTITY, _ALPHA),
                d=one,
                sum_output=target,
                scale=_SCALES[instruction.scale],
            )
            setattr(second, name, portion)
        self.stages += [first, second]
        for half in instruction.mask:
            self.note(half, instruction)
        self.equal.add(instruction.destination)

    def comparison(self, number, instruction):
        """SPARE0's alpha becomes (src0 + 1) / 2, which is one half and more where src0 is not negative."""
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
        own = instruction.destination == _R0 and "a" in instruction.mask
        if _R0 not in self.dots and ((_R0, "a") in reads or (not own and self.needed(number, _R0, "a"))):
            raise instruction.token.error(
                "cmp needs the alpha of r0, where register combiners compare, and the program still reads "
                "r0.a; move that to r1.a before."
            )
        first = self.new_stage(instruction.token)
        one = _one("a")
        a, b = _product(instruction, self.operand(first, "a", tested), one)
        first.alpha = AlphaPortion(
            a=a,
            b=b,
            c=one.input,
            d=one.input,
            sum_output=Register.SPARE0,
            scale=CombinerScale.SCALE_BY_ONE_HALF,
        )
        self.stages.append(first)
        if _R0 in self.dots:
            self.dots[_R0].free_from = len(self.stages)
        else:
            self.saturated.discard((_R0, "a"))
        second = self.new_stage(instruction.token)
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
        return register == _R0

    def endangered(self, number, group):
        """The registers whose alpha is in a blue that the group overwrites, and is still needed."""
        whole = {i.destination for i in group if "a" in i.mask}
        return [
            register
            for register in dict.fromkeys(i.destination for i in group)
            if register in self.dots and register not in whole and self.needed(number, register, "a")
        ]

    def alpha_of_its_own(self, register, token):
        """Bring an alpha that is in blue into the register's alpha."""
        if register not in self.dots:
            return
        dot = self.dots.pop(register)
        if self.blue_to_alpha and dot.free_from == dot.stage + 1:
            stage = self.stages[dot.stage]
            stage.rgb = replace(stage.rgb, ab_blue_to_alpha=True)
            return
        for stage in self.stages[dot.free_from :]:
            if stage.alpha is None:
                stage.alpha = _copy_of_blue(register)
                return
        stage = self.new_stage(token)
        stage.alpha = _copy_of_blue(register)
        self.stages.append(stage)

    # ------------------------------------------------------------------------------------- operands

    def check_written(self, source, component):
        if source.letter == "c" or (source.register, component) in self.written:
            return
        if source.letter == "r":
            self.unwritten(source.token, source.register, component)
            return
        name, given = f"t{source.number}", self.texture.get(source.number)
        reason = f"{given} gives no color" if given else "no texture instruction gives it"
        raise source.token.error(f"{name} is read, but {reason}; write tex {name} first.")

    def operand(self, stage, half, source, unsigned=False):
        """A source as a combiner's input; ``unsigned``: clamped to [0, 1]."""
        if source.selector == "b" and half == "rgb":
            raise source.token.error(
                f"{source.token.text} for red, green and blue; only alpha takes .b. Write the destination "
                ".a, or take .a."
            )
        component = half_read(half, source)
        self.check_written(source, component)
        usage = _ALPHA if component == "a" else (_BLUE if half == "a" else _RGB)
        mapping = _MAPPINGS[source.sign, source.modifier]
        if source.letter == "c":
            return self.constant(stage, source, usage, mapping, unsigned)
        if component == "a" and source.register in self.dots:
            usage = _BLUE if half == "a" else _RGB
        negated = False
        if mapping in _SIGNED and (unsigned or (source.register, component) in self.saturated):
            negated, mapping = mapping is Mapping.SIGNED_NEGATE, Mapping.UNSIGNED_IDENTITY
        return _Operand(CombinerInput(_REGISTERS[source.register], mapping, usage), negated)

    def constant(self, stage, source, usage, mapping, unsigned):
        color = self.color(source.number)
        read_values = color[3:] if usage is _ALPHA else color[:3]
        if any(value < 0 for value in read_values):
            if mapping not in _SIGNED or unsigned:
                raise source.token.error(
                    f"c{source.number} is {color}; a combiner's constants are in [0, 1], and what stands "
                    "for a negative one has to be read without a modifier. Change the constant instead."
                )
            mapping = (_EXPANDED if max(read_values) > 0 else _NEGATED)[mapping]
        if source.number not in stage.places:
            if len(stage.places) == 2:
                raise source.token.error(
                    f"c{source.number} is the third constant of one general combiner, which has two; move "
                    "one to a register with mov first."
                )
            stage.places[source.number] = len(stage.places)
        if unsigned and mapping in _SIGNED:
            mapping = Mapping.UNSIGNED_IDENTITY
        return _Operand(CombinerInput(_CONSTANTS[stage.places[source.number]], mapping, usage))


def _stored(color):
    """What a combiner's constant, in [0, 1], holds of a color in [-1, 1].

    Magnitudes, for readers that negate; where red, green and blue differ in sign, what EXPAND_NORMAL maps to
    them, in steps of 2/255.
    """
    color = [max(-1.0, min(1.0, value)) for value in color]
    magnitudes = tuple(abs(value) for value in color)
    if min(color[:3]) < 0 < max(color[:3]):
        return (*(min((value + 256 / 255) / 2, 1.0) for value in color[:3]), magnitudes[3])
    return magnitudes


def _copy_of_blue(register):
    given = _REGISTERS[register]
    return AlphaPortion(
        a=CombinerInput(given, Mapping.SIGNED_IDENTITY, _BLUE),
        ab_output=given,
        b=CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, _ALPHA),
        sum_output=Register.DISCARD,
    )


def _product(instruction, first, second):
    """The two inputs of a product, with the sign that either still owes."""
    a, b = first.input, second.input
    if first.negated == second.negated:
        return a, b
    if a.mapping in _NEGATED:
        return replace(a, mapping=_NEGATED[a.mapping]), b
    if b.mapping in _NEGATED:
        return a, replace(b, mapping=_NEGATED[b.mapping])
    if (b.register, b.mapping) == (Register.ZERO, Mapping.UNSIGNED_INVERT):
        # Minus one; where EXPAND_NORMAL takes 128 as one half, it is -256/255.
        return a, replace(b, mapping=Mapping.EXPAND_NORMAL)
    raise instruction.token.error(
        f"{instruction.name} of factors that the hardware cannot negate (1-, or what _sat wrote); negate "
        "one of them with mov first."
    )
