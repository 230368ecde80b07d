"""Register combiners and texture shaders as the NV2A's own words, as in an emulator's dump.

    NV097_SET_COMBINER_CONTROL        = 0x00011101
    NV097_SET_COMBINER_COLOR_ICW[0]   = 0xc8c40000
    0x0aa0: 0x00000c00
    PSRGBOutputs[0] = 0x00000c00

A line has a method by its name or its address, and its value. Several values, separated by spaces and commas
alone, belong to consecutive methods. Direct3D's names of the same words (PSRGBInputs and others) are read
too. Lines without such a method are skipped, so that a dump of all state can be given. A missing word is
zero, except for the final combiner, which then gives SPARE0.

Source: the methods' addresses and fields as public headers of the NV2A's 3D class list them (nouveau's
NV20_TCL_PRIMITIVE_3D, nxdk's nv_regs.h); PS_COMBINERINPUTS and related macros of the Xbox's d3d8types.h.
"""

from fixedpipe.pipeline.enums import (
    CombinerBias,
    CombinerScale,
    ComponentUsage,
    CullMode,
    DotProductMapping,
    Mapping,
    MuxSelect,
    Register,
    TextureShaderOperation,
)
from fixedpipe.pipeline.notations.nv2a_dumps import COUNTS, RegisterTextError, read_dump
from fixedpipe.pipeline.notations.program_sources import ProgramSources
from fixedpipe.pipeline.notations.register_combiner_words import MAX_GENERAL_COMBINERS, constant_byte
from fixedpipe.pipeline.programs.combiner_rules import combiner_problems
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
    TextureShaderStage,
)

HEADER = "NV2A registers"
_PREFIX = "NV097_"
_STAGES = 4
_REGISTERS = {
    0x0: Register.ZERO,
    0x1: Register.CONSTANT_COLOR0,
    0x2: Register.CONSTANT_COLOR1,
    0x3: Register.FOG,
    0x4: Register.PRIMARY_COLOR,
    0x5: Register.SECONDARY_COLOR,
    0x8: Register.TEXTURE0,
    0x9: Register.TEXTURE1,
    0xA: Register.TEXTURE2,
    0xB: Register.TEXTURE3,
    0xC: Register.SPARE0,
    0xD: Register.SPARE1,
    0xE: Register.SPARE0_PLUS_SECONDARY_COLOR,
    0xF: Register.E_TIMES_F,
}
_CODES = {register: code for code, register in _REGISTERS.items()} | {Register.DISCARD: 0}
# In the order of the three bits' values.
_MAPPINGS = (
    Mapping.UNSIGNED_IDENTITY,
    Mapping.UNSIGNED_INVERT,
    Mapping.EXPAND_NORMAL,
    Mapping.EXPAND_NEGATE,
    Mapping.HALF_BIAS_NORMAL,
    Mapping.HALF_BIAS_NEGATE,
    Mapping.SIGNED_IDENTITY,
    Mapping.SIGNED_NEGATE,
)
_HALF = CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF
_OPERATIONS = {
    0: (CombinerScale.NONE, CombinerBias.NONE),
    1: (CombinerScale.NONE, _HALF),
    2: (CombinerScale.SCALE_BY_TWO, CombinerBias.NONE),
    3: (CombinerScale.SCALE_BY_TWO, _HALF),
    4: (CombinerScale.SCALE_BY_FOUR, CombinerBias.NONE),
    6: (CombinerScale.SCALE_BY_ONE_HALF, CombinerBias.NONE),
}
_OPERATION_CODES = {operation: code for code, operation in _OPERATIONS.items()}
# Bits of output words.
_MUX, _AB_DOT, _CD_DOT, _AB_BLUE, _CD_BLUE = 1 << 14, 1 << 13, 1 << 12, 1 << 19, 1 << 18
# Bits of SET_COMBINER_CONTROL, and of the second final word.
_MUX_MSB, _EACH_FACTOR0, _EACH_FACTOR1 = 1 << 8, 1 << 12, 1 << 16
_CLAMP, _INVERT_SECONDARY, _INVERT_SPARE0 = 1 << 7, 1 << 6, 1 << 5

_OP = TextureShaderOperation
_MODES = (
    _OP.NONE,
    _OP.TEXTURE_2D,
    _OP.TEXTURE_3D,
    _OP.TEXTURE_CUBE_MAP,
    _OP.PASS_THROUGH,
    _OP.CULL_FRAGMENT,
    _OP.OFFSET_TEXTURE_2D,
    _OP.OFFSET_TEXTURE_2D_SCALE,
    _OP.BRDF_TEXTURE_3D,
    _OP.DOT_PRODUCT_TEXTURE_2D,
    _OP.DOT_PRODUCT_DEPTH_REPLACE,
    _OP.DOT_PRODUCT_DIFFUSE_CUBE_MAP,
    _OP.DOT_PRODUCT_REFLECT_CUBE_MAP,
    _OP.DOT_PRODUCT_TEXTURE_3D,
    _OP.DOT_PRODUCT_TEXTURE_CUBE_MAP,
    _OP.DEPENDENT_AR_TEXTURE_2D,
    _OP.DEPENDENT_GB_TEXTURE_2D,
    _OP.DOT_PRODUCT,
    _OP.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
)
# This mode and the later ones read an earlier unit's texel.
_FIRST_READING = _MODES.index(_OP.OFFSET_TEXTURE_2D)
# A mode's word has no other target; whether a texture is 1D or a rectangle is its own property.
_MODE_OF = {operation: mode for mode, operation in enumerate(_MODES)} | {
    _OP.TEXTURE_1D: 1,
    _OP.TEXTURE_RECTANGLE: 1,
    _OP.OFFSET_TEXTURE_RECTANGLE: 6,
    _OP.OFFSET_TEXTURE_RECTANGLE_SCALE: 7,
    _OP.DOT_PRODUCT_TEXTURE_RECTANGLE: 9,
}


def parse(text, start=(1, 1), draw=None):
    """(texture shader stages or None, RegisterCombiners or None, ProgramSources, notes) of a dump.

    ``draw`` is the number, from 1, of a draw in a dump with several; None is the last. Raises
    RegisterTextError with line and column, both from 1.
    """
    dump = read_dump(text, start, draw)
    words, lines = dump.words, dump.lines
    if not words:
        raise RegisterTextError(
            "no line names a register of the combiners; write NV097_SET_COMBINER_CONTROL = 0x1 for instance.",
            *start,
        )
    reader = _Reader(words, lines)
    combiners = reader.combiners()
    stages = reader.stages() if ("SET_SHADER_STAGE_PROGRAM", 0) in words else None
    for path, sentence in combiner_problems(combiners) if combiners is not None else ():
        where = lines.get(_word_of(path), start[0])
        raise RegisterTextError(sentence, where, 1)
    return stages, combiners, reader.sources(combiners, stages), (*dump.notes, *reader.notes)


def _word_of(path):
    if path[0] == "final":
        return ("SET_COMBINER_SPECULAR_FOG_CW0" if path[1] in "abcd" else "SET_COMBINER_SPECULAR_FOG_CW1"), 0
    _, number, portion, field = path
    half = "COLOR" if portion == "rgb" else "ALPHA"
    return f"SET_COMBINER_{half}_{'ICW' if field in 'abcd' else 'OCW'}", number


class _Reader:
    def __init__(self, words, lines):
        self.words, self.lines, self.notes = words, lines, []

    def word(self, name, index=0):
        return self.words.get((name, index), 0)

    def error(self, name, index, sentence):
        return RegisterTextError(sentence, self.lines.get((name, index), 1), 1)

    def combiners(self):
        if not any(name.startswith("SET_COMBINER") for name, _ in self.words):
            return None
        control = self.word("SET_COMBINER_CONTROL")
        count = control & 0xFF
        if ("SET_COMBINER_CONTROL", 0) not in self.words:
            count = 1 + max((k for (name, k) in self.words if name.endswith(("ICW", "OCW"))), default=0)
            control |= _EACH_FACTOR0 | _EACH_FACTOR1 | _MUX_MSB
            self.notes.append(
                f"SET_COMBINER_CONTROL is not given: {count} general combiners are taken, with constants of "
                "each."
            )
        if not 1 <= count <= MAX_GENERAL_COMBINERS:
            raise self.error(
                "SET_COMBINER_CONTROL",
                0,
                f"SET_COMBINER_CONTROL asks for {count} general combiners; the NV2A has 1 to "
                f"{MAX_GENERAL_COMBINERS}. Its lowest byte is their number.",
            )
        finals = [self.color("SET_SPECULAR_FOG_FACTOR", k) for k in (0, 1)]
        final, flags = self.final()
        return RegisterCombiners(
            general=tuple(self.general(k, control, finals) for k in range(count)),
            final=final,
            constant_color0=finals[0],
            constant_color1=finals[1],
            color_sum_clamp=bool(flags & _CLAMP),
            mux_select=MuxSelect.MSB if control & _MUX_MSB else MuxSelect.LSB,
            invert_spare0=bool(flags & _INVERT_SPARE0),
            invert_secondary_color=bool(flags & _INVERT_SECONDARY),
        )

    def color(self, name, index):
        """0xAARRGGBB as a color."""
        word = self.word(name, index)
        return tuple((word >> shift & 0xFF) / 255 for shift in (16, 8, 0, 24))

    def general(self, k, control, finals):
        own = {}
        for number, each in enumerate((_EACH_FACTOR0, _EACH_FACTOR1)):
            color = self.color(f"SET_COMBINER_FACTOR{number}", k if control & each else 0)
            if color != finals[number]:
                own[f"constant_color{number}"] = color
        return GeneralCombiner(rgb=self.portion("COLOR", k), alpha=self.portion("ALPHA", k), **own)

    def portion(self, half, k):
        inputs, outputs = (f"SET_COMBINER_{half}_{kind}" for kind in ("ICW", "OCW"))
        read, word = self.word(inputs, k), self.word(outputs, k)
        plain = ComponentUsage.RGB if half == "COLOR" else ComponentUsage.BLUE
        a, b, c, d = (self.variable(inputs, k, read >> shift, plain) for shift in (24, 16, 8, 0))
        operation = word >> 15 & 7
        if operation not in _OPERATIONS:
            raise self.error(
                outputs, k, f"{outputs}[{k}] has the operation {operation}, which no combiner has."
            )
        scale, bias = _OPERATIONS[operation]
        flags = {}
        if half == "COLOR":
            flags = {
                "ab_dot_product": bool(word & _AB_DOT),
                "cd_dot_product": bool(word & _CD_DOT),
                "ab_blue_to_alpha": bool(word & _AB_BLUE),
                "cd_blue_to_alpha": bool(word & _CD_BLUE),
            }
        return (RGBPortion if half == "COLOR" else AlphaPortion)(
            a=a,
            b=b,
            c=c,
            d=d,
            cd_output=self.output(outputs, k, word),
            ab_output=self.output(outputs, k, word >> 4),
            sum_output=self.output(outputs, k, word >> 8),
            mux_sum=bool(word & _MUX),
            scale=scale,
            bias=bias,
            **flags,
        )

    def register(self, name, k, code):
        if code not in _REGISTERS:
            raise self.error(name, k, f"{name}[{k}] names register {code}, which the NV2A does not have.")
        return _REGISTERS[code]

    def output(self, name, k, code):
        return self.register(name, k, code & 0xF) if code & 0xF else Register.DISCARD

    def variable(self, name, k, byte, plain):
        usage = ComponentUsage.ALPHA if byte & 0x10 else plain
        return CombinerInput(self.register(name, k, byte & 0xF), _MAPPINGS[byte >> 5 & 7], usage)

    def final(self):
        """The final combiner, and the flags of its second word."""
        names = "SET_COMBINER_SPECULAR_FOG_CW0", "SET_COMBINER_SPECULAR_FOG_CW1"
        if not any((name, 0) in self.words for name in names):
            self.notes.append("the final combiner's words are not given: it is taken to give SPARE0.")
            spare0, alpha = (
                CombinerInput(Register.SPARE0, usage=u) for u in (ComponentUsage.RGB, ComponentUsage.ALPHA)
            )
            zero = CombinerInput()
            return FinalCombiner(zero, zero, zero, spare0, zero, zero, alpha), _CLAMP
        if not any(self.words.get((name, 0), 0) for name in names):
            # Inferred: words of 0 are inputs of 0. Public readers of dumps differ.
            self.notes.append(
                "both words of the final combiner are 0: it draws black, alpha 0. Other readers of dumps "
                "draw SPARE0; no capture tells."
            )
        first, second = map(self.word, names)
        read = [self.variable(names[0], 0, first >> shift, ComponentUsage.RGB) for shift in (24, 16, 8, 0)]
        read += [self.variable(names[1], 0, second >> shift, ComponentUsage.RGB) for shift in (24, 16)]
        g = self.variable(names[1], 0, second >> 8, ComponentUsage.BLUE)
        return FinalCombiner(*read, g), second & 0xFF

    def stages(self):
        modes, compare = self.word("SET_SHADER_STAGE_PROGRAM"), self.word("SET_SHADER_CLIP_PLANE_MODE")
        inputs, mappings = self.word("SET_SHADER_OTHER_STAGE_INPUT"), self.word("SET_DOT_RGBMAPPING")
        stages: list[TextureShaderStage] = []
        for unit in range(_STAGES):
            mode = modes >> 5 * unit & 0x1F
            if mode >= len(_MODES):
                raise self.error(
                    "SET_SHADER_STAGE_PROGRAM",
                    0,
                    f"texture unit {unit} has mode {mode}; the NV2A's are 0 to {len(_MODES) - 1}.",
                )
            given = {}
            if _MODES[mode] is _OP.CULL_FRAGMENT:
                bits = compare >> 4 * unit & 0xF
                given["cull_modes"] = tuple(
                    CullMode.LESS if bits >> k & 1 else CullMode.GEQUAL for k in range(4)
                )
            if unit and mode >= _FIRST_READING:
                given["previous_texture_input"] = (
                    inputs >> (8 + 4 * unit) & (1 if unit == 2 else 3) if unit > 1 else 0
                )
                mapping = mappings >> 4 * (unit - 1) & 7
                if mapping not in set(map(int, DotProductMapping)):
                    raise self.error(
                        "SET_DOT_RGBMAPPING",
                        0,
                        f"texture unit {unit} maps by {mapping}, which no profile has.",
                    )
                given["dot_product_mapping"] = DotProductMapping(mapping)
            if _MODES[mode] in (_OP.OFFSET_TEXTURE_2D, _OP.OFFSET_TEXTURE_2D_SCALE):
                self.notes.append(
                    f"texture unit {unit}'s matrix, scale and offset are the texture's registers: identity "
                    "here."
                )
            stages.append(TextureShaderStage(_MODES[mode], **given))
        while stages and stages[-1].operation is _OP.NONE:
            stages.pop()
        return tuple(stages) or None

    def sources(self, combiners, stages):
        def said(*words):
            found = sorted({self.lines[word] for word in words if word in self.lines})
            return f"line{'s' if len(found) > 1 else ''} {', '.join(map(str, found))}" if found else ""

        kinds = [f"SET_COMBINER_{half}_{kind}" for half in ("COLOR", "ALPHA") for kind in ("ICW", "OCW")]
        general = [
            said(*((kind, k) for kind in kinds)) for k in range(len(combiners.general) if combiners else 0)
        ]
        final = said(*((f"SET_COMBINER_SPECULAR_FOG_CW{k}", 0) for k in (0, 1)))
        units = [said(("SET_SHADER_STAGE_PROGRAM", 0))] * len(stages or ())
        return ProgramSources(tuple(units), tuple(general), final)


# -------------------------------------------------------------------------------------------------- writing


def format_registers(combiners: RegisterCombiners | None, stages=None) -> str:
    """The words of register combiners and texture shader stages, a method on each line, for ``parse``.

    Colors become bytes. Raises ValueError with a sentence for states that the NV2A's words cannot express.
    """
    words = {}
    if combiners is not None:
        for _, sentence in combiner_problems(combiners):
            raise ValueError(sentence)
        words |= _combiner_words(combiners)
    if stages:
        words |= _stage_words(stages)
    return "".join(
        f"{_PREFIX}{name}{f'[{k}]' if COUNTS[name] > 1 else ''} = 0x{word:08x}\n"
        for (name, k), word in words.items()
    )


def _combiner_words(combiners):
    if not 1 <= len(combiners.general) <= MAX_GENERAL_COMBINERS:
        raise ValueError(
            f"The NV2A has 1 to {MAX_GENERAL_COMBINERS} general combiners; there are "
            f"{len(combiners.general)}."
        )
    control = len(combiners.general) | _EACH_FACTOR0 | _EACH_FACTOR1
    control |= _MUX_MSB if combiners.mux_select is MuxSelect.MSB else 0
    words = {("SET_COMBINER_CONTROL", 0): control}
    colors = combiners.constant_color0, combiners.constant_color1
    for k, stage in enumerate(combiners.general):
        if stage.lookup is not None or stage.rgb.function or stage.alpha.function:
            raise ValueError(
                f"General combiner {k} has a function or a lookup, which the NV2A's words cannot express."
            )
        for half, portion in (("COLOR", stage.rgb), ("ALPHA", stage.alpha)):
            words[f"SET_COMBINER_{half}_ICW", k] = _input_word(portion.a, portion.b, portion.c, portion.d)
            words[f"SET_COMBINER_{half}_OCW", k] = _output_word(portion)
        for number, own in enumerate((stage.constant_color0, stage.constant_color1)):
            words[f"SET_COMBINER_FACTOR{number}", k] = _color_word(colors[number] if own is None else own)
    final = combiners.final
    words["SET_COMBINER_SPECULAR_FOG_CW0", 0] = _input_word(final.a, final.b, final.c, final.d)
    words["SET_COMBINER_SPECULAR_FOG_CW1", 0] = (
        _input_word(final.e, final.f, final.g, CombinerInput())
        | (_CLAMP if combiners.color_sum_clamp else 0)
        | (_INVERT_SECONDARY if combiners.invert_secondary_color else 0)
        | (_INVERT_SPARE0 if combiners.invert_spare0 else 0)
    )
    for k, color in enumerate(colors):
        words["SET_SPECULAR_FOG_FACTOR", k] = _color_word(color)
    return words


def _input_word(*variables):
    word = 0
    for given in variables:
        alpha = 0x10 if given.usage is ComponentUsage.ALPHA else 0
        word = word << 8 | _MAPPINGS.index(given.mapping) << 5 | alpha | _CODES[given.register]
    return word


def _output_word(portion):
    word = _CODES[portion.cd_output] | _CODES[portion.ab_output] << 4 | _CODES[portion.sum_output] << 8
    word |= _OPERATION_CODES[portion.scale, portion.bias] << 15 | (_MUX if portion.mux_sum else 0)
    for name, bit in (
        ("ab_dot_product", _AB_DOT),
        ("cd_dot_product", _CD_DOT),
        ("ab_blue_to_alpha", _AB_BLUE),
        ("cd_blue_to_alpha", _CD_BLUE),
    ):
        word |= bit if getattr(portion, name, False) else 0
    return word


def _color_word(color):
    red, green, blue, alpha = map(constant_byte, color)
    return alpha << 24 | red << 16 | green << 8 | blue


def _stage_words(stages):
    modes = compare = inputs = mappings = 0
    for unit, stage in enumerate(stages):
        if stage.operation not in _MODE_OF or stage.roughness is not None:
            raise ValueError(
                f"Texture shader stage {unit} ({stage.operation.name}) is none that the NV2A's words can "
                "express."
            )
        mode = _MODE_OF[stage.operation]
        modes |= mode << 5 * unit
        if stage.operation is _OP.CULL_FRAGMENT:
            bits = sum((mode is CullMode.LESS) << k for k, mode in enumerate(stage.cull_modes))
            compare |= bits << 4 * unit
        if unit and mode >= _FIRST_READING:
            if (unit == 1 and stage.previous_texture_input) or stage.previous_texture_input >= unit:
                raise ValueError(
                    f"Texture shader stage {unit} reads unit {stage.previous_texture_input}; it reads an "
                    "earlier one."
                )
            inputs |= stage.previous_texture_input << (8 + 4 * unit) if unit > 1 else 0
            mappings |= stage.dot_product_mapping << 4 * (unit - 1)
    return {
        ("SET_SHADER_STAGE_PROGRAM", 0): modes,
        ("SET_SHADER_CLIP_PLANE_MODE", 0): compare,
        ("SET_SHADER_OTHER_STAGE_INPUT", 0): inputs,
        ("SET_DOT_RGBMAPPING", 0): mappings,
    }
