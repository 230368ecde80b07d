"""Rules of combiner programs (NV_register_combiners), and the choice of a pass's program.

The rules say which inputs and outputs may be combined.
"""

from functools import wraps

from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, ComponentUsage, Mapping, MuxSelect, Register
from fixedpipe.pipeline.programs.texture_environment import environment_program
from fixedpipe.pipeline.state import CombinerInput, FinalCombiner, GeneralCombiner, RegisterCombiners

READ_ONLY_REGISTERS = frozenset(
    {Register.ZERO, Register.CONSTANT_COLOR0, Register.CONSTANT_COLOR1, Register.FOG}
)
# the number of programs whose derived data are kept
_MOST_KEPT = 1024


def kept_for_stages(find):
    """A cache of ``find(combiners, *more)``, for data that follow from the stages and ``more`` alone.

    ``more`` is hashable. The stages are the general and final combiners. ``dataclasses.replace`` keeps them
    where a constant colour changes, so such programs share an entry. The key is the identity, because equal
    combiners may differ in type. An entry holds the combiners, so that no other object gets their identity.
    """
    kept = {}

    def found(combiners, *more):
        key = id(combiners.general), id(combiners.final), *more
        entry = kept.get(key)
        if entry is None:
            if len(kept) >= _MOST_KEPT:
                kept.clear()
            entry = kept[key] = find(combiners, *more), combiners.general, combiners.final
        return entry[0]

    return wraps(find)(found)


PSEUDO_REGISTERS = frozenset({Register.E_TIMES_F, Register.SPARE0_PLUS_SECONDARY_COLOR})
_FINAL_MAPPINGS = frozenset({Mapping.UNSIGNED_IDENTITY, Mapping.UNSIGNED_INVERT})


def _general_input_problem(place, alpha_portion, given):
    if given.register is Register.DISCARD:
        return f"{place} reads DISCARD, which is an output only; read a register or ZERO."
    if given.register in PSEUDO_REGISTERS:
        return (
            f"{place} reads {given.register.name}, which exists only in the final combiner; use it there, "
            "or compute it here from its parts."
        )
    if alpha_portion and given.usage is ComponentUsage.RGB:
        return f"{place} takes RGB; an alpha portion takes ALPHA or BLUE. Choose one of the two."
    if not alpha_portion and given.usage is ComponentUsage.BLUE:
        return (
            f"{place} takes BLUE; an RGB portion takes RGB or ALPHA. Copy blue to a register's alpha in an "
            "earlier alpha portion, then take ALPHA."
        )
    if given.register is Register.FOG and given.usage is ComponentUsage.ALPHA:
        return (
            f"{place} takes the ALPHA of FOG; the fog factor is available only in the final combiner. Use "
            "it there."
        )
    return None


def _output_problem(place, register):
    if register in READ_ONLY_REGISTERS:
        return (
            f"{place} writes {register.name}, which is read only; write a color, texture or spare register."
        )
    if register in PSEUDO_REGISTERS:
        return (
            f"{place} writes {register.name}, which the final combiner computes; write SPARE0 or SPARE1 "
            "instead."
        )
    return None


def _general_problems(number, name, portion):
    path, alpha_portion = ("general", number, name), name == "alpha"
    place = f"General combiner {number}, {'alpha' if alpha_portion else 'RGB'} portion"
    for variable in "abcd":
        problem = _general_input_problem(
            f"{place}, variable {variable.upper()}", alpha_portion, getattr(portion, variable)
        )
        if problem:
            yield (*path, variable), problem
    written = {}
    for output, words in (
        ("ab_output", "AB output"),
        ("cd_output", "CD output"),
        ("sum_output", "sum output"),
    ):
        register = getattr(portion, output)
        if problem := _output_problem(f"{place}, {words},", register):
            yield (*path, output), problem
        if register in written:
            yield (
                (*path, output),
                f"{place}: the {written[register]} and the {words} both write {register.name}; outputs need "
                "different registers. Send one of them elsewhere, or to DISCARD.",
            )
        if register is not Register.DISCARD:
            written[register] = words
    if portion.bias is not CombinerBias.NONE and portion.scale in (
        CombinerScale.SCALE_BY_FOUR,
        CombinerScale.SCALE_BY_ONE_HALF,
    ):
        yield (
            (*path, "scale"),
            f"{place}: {portion.bias.name} with {portion.scale.name}; the bias goes with no scale or with "
            "SCALE_BY_TWO. Drop the bias, or scale in the next general combiner.",
        )


def _blue_to_alpha_problems(number, stage):
    """Outputs whose blue and the alpha portion would both write one register's alpha."""
    alpha = {stage.alpha.ab_output, stage.alpha.cd_output, stage.alpha.sum_output} - {Register.DISCARD}
    for name in ("ab", "cd"):
        register = getattr(stage.rgb, f"{name}_output")
        if getattr(stage.rgb, f"{name}_blue_to_alpha") and register in alpha:
            yield (
                ("general", number, "rgb", f"{name}_blue_to_alpha"),
                f"General combiner {number}: the {name.upper()} output's blue and the alpha portion both "
                f"write {register.name}'s alpha. Send one of them elsewhere.",
            )


def _final_input_problem(variable, given):
    place = f"Final combiner, variable {variable.upper()},"
    if given.register is Register.DISCARD:
        return f"{place} reads DISCARD, which is an output only; read a register or ZERO."
    if given.mapping not in _FINAL_MAPPINGS:
        return (
            f"{place} is mapped by {given.mapping.name}; the final combiner has UNSIGNED_IDENTITY and "
            "UNSIGNED_INVERT. Map it in a general combiner."
        )
    if given.register in PSEUDO_REGISTERS:
        if variable in "efg":
            return (
                f"{place} reads {given.register.name}; E, F and G read registers only. Move it to B, C or D."
            )
        if variable == "a" and given.register is Register.SPARE0_PLUS_SECONDARY_COLOR:
            return f"{place} reads SPARE0_PLUS_SECONDARY_COLOR, which B, C and D take; move it there."
        if given.usage is not ComponentUsage.RGB:
            return f"{place} takes {given.usage.name} of {given.register.name}, which has RGB only; take RGB."
    if variable == "g" and given.usage is ComponentUsage.RGB:
        return f"{place} takes RGB; the alpha output takes ALPHA or BLUE. Choose one of the two."
    if variable != "g" and given.usage is ComponentUsage.BLUE:
        return f"{place} takes BLUE, which only G may; take RGB or ALPHA."
    return None


@kept_for_stages
def combiner_problems(combiners):
    """The problems of ``combiners`` on every machine with register combiners, apart from their number.

    A tuple of (path, sentence). A path leads to the wrong part: ("general", stage, "rgb" or "alpha", field)
    or ("final", variable). Fields must have the types that ``fixedpipe.pipeline.state`` says. Source:
    NV_register_combiners, Errors.
    """
    problems = []
    for number, stage in enumerate(combiners.general):
        problems += _general_problems(number, "rgb", stage.rgb)
        problems += _general_problems(number, "alpha", stage.alpha)
        problems += _blue_to_alpha_problems(number, stage)
    for variable in "abcdefg":
        if problem := _final_input_problem(variable, getattr(combiners.final, variable)):
            problems.append((("final", variable), problem))
    return tuple(problems)


def nv2a_flag(combiners):
    """The first of the NV2A's own flags that the combiners set, in words, or None."""
    if combiners.mux_select is not MuxSelect.MSB:
        return "mux selection by the lowest bit (mux_select)"
    if combiners.invert_spare0 or combiners.invert_secondary_color:
        return "inverted terms of the color sum (invert_spare0, invert_secondary_color)"
    return None


def blue_to_alpha_stage(combiners):
    """The number of the first general combiner with an output of blue to alpha, or None."""
    for number, stage in enumerate(combiners.general):
        if stage.rgb.ab_blue_to_alpha or stage.rgb.cd_blue_to_alpha:
            return number
    return None


TEXTURE_REGISTERS = (Register.TEXTURE0, Register.TEXTURE1, Register.TEXTURE2, Register.TEXTURE3)


@kept_for_stages
def registers_named(combiners):
    """Every register that an input or output names: a tuple of (place, register), each once."""
    return tuple(dict.fromkeys(_named(combiners)))


def _named(combiners):
    for number, stage in enumerate(combiners.general):
        for portion in (stage.rgb, stage.alpha):
            for register in (
                *(getattr(portion, variable).register for variable in "abcd"),
                portion.ab_output,
                portion.cd_output,
                portion.sum_output,
            ):
                yield f"General combiner {number}", register
    for variable in "abcdefg":
        yield "The final combiner", getattr(combiners.final, variable).register


@kept_for_stages
def textures_read(combiners):
    """The texture units whose texels the combiners read: a tuple of (place, unit number), each unit once.

    A texture register holds no texel after an earlier stage has written the same components.
    """
    return tuple(_texels(combiners))


def _texels(combiners):
    written, found = set(), set()

    def of(place, reads):
        for given in reads:
            part = "alpha" if given.usage is ComponentUsage.ALPHA else "rgb"
            if given.register in TEXTURE_REGISTERS and (given.register, part) not in written:
                number = TEXTURE_REGISTERS.index(given.register)
                if number not in found:
                    found.add(number)
                    yield place, number

    for number, stage in enumerate(combiners.general):
        outputs = set()
        for part, portion in (("rgb", stage.rgb), ("alpha", stage.alpha)):
            kept = {portion.ab_output, portion.cd_output, portion.sum_output} - {Register.DISCARD}
            if kept:
                yield from of(f"General combiner {number}", (getattr(portion, v) for v in "abcd"))
            outputs |= {(register, part) for register in kept}
        for half in ("ab", "cd"):
            if getattr(stage.rgb, f"{half}_blue_to_alpha"):
                outputs.add((getattr(stage.rgb, f"{half}_output"), "alpha"))
        written |= outputs
    yield from of("The final combiner", (getattr(combiners.final, v) for v in "abcdefg"))


# ---------------------------------------------------------------------------------- the program of a pass

# The programs that stand for disabled register combiners: the fragment's colour with color sum and fog.
_PRIMARY = CombinerInput(Register.PRIMARY_COLOR)
_PLAIN = FinalCombiner(b=_PRIMARY, g=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.ALPHA))
WITH_FOG = RegisterCombiners(general=(), final=_PLAIN)
WITH_COLOR_SUM = RegisterCombiners(general=(GeneralCombiner(),))  # the initial state of the extension


def has_color_sum(state):
    """Whether a pass without register combiners adds the secondary colour."""
    lighting = state.vertex.lighting
    return state.color_sum or (lighting is not None and lighting.separate_specular_color)


def combiner_program(state, profile, textures):
    """The combiner program of a pass, or None where the fragment is its primary colour.

    ``textures`` maps names to Textures, whose formats the texture environments use.
    """
    if state.register_combiners is not None:
        return state.register_combiners
    program = environment_program(state, textures, profile, has_color_sum(state))
    if program is not None:
        return program
    if has_color_sum(state):
        return WITH_COLOR_SUM
    return WITH_FOG if state.fog is not None else None
