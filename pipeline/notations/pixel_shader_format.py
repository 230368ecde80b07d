"""Writes programs of any notation as Direct3D 8's pixel shaders.

The text is read back before it is returned. A program that was a pixel shader must give the very same state
and constants; another program must give an equal state (``equal_programs``). Other programs are refused. A
program that gives SPARE0 without fog is written as one with fog, with a comment: with fog disabled both are
the same.

The version is ps.1.1, or the first later one with the instructions. ps.1.0 has the instructions of ps.1.1,
and Direct3D 9 dropped it.
"""

from dataclasses import replace
from itertools import product as combinations

from fixedpipe.pipeline.enums import ComponentUsage, Mapping, MuxSelect, Register
from fixedpipe.pipeline.notations.equal_programs import (
    constant_color,
    plain_combiners,
    plain_stages,
)
from fixedpipe.pipeline.notations.pixel_shader_groups import Writer, alpha_is_read, dot_products
from fixedpipe.pipeline.notations.pixel_shader_notes import most_read
from fixedpipe.pipeline.notations.pixel_shader_operands import Constant, Operands
from fixedpipe.pipeline.notations.pixel_shader_texture_format import texture_instructions
from fixedpipe.pipeline.notations.pixel_shader_translation import PixelShader, parse
from fixedpipe.pipeline.notations.pixel_shaders import (
    ARITHMETIC,
    REGISTER_COUNTS,
    TEXTURE,
    VERSIONS,
    PixelShaderTextError,
)
from fixedpipe.pipeline.notations.programs import Program
from fixedpipe.pipeline.state import CombinerInput, FinalCombiner

_FIRST_VERSION = "1.1"
_OTHERWISE = "Write it as !!RC1.0 (--rc), or as words of the NV2A's registers (--nv2a)."
_WITHOUT_FOG = "without fog: r0 is shown as it is; a pixel shader's r0 is shown with fog, where it is enabled"
_ZERO = CombinerInput()
_FINAL = FinalCombiner(b=CombinerInput(Register.SPARE0), d=_ZERO, e=_ZERO, f=_ZERO)


def format_pixel_shader(program: Program) -> str:
    """The pixel shader that reads back as ``program``.

    A program that was a pixel shader reads back with the same texture shader stages, combiners and constants.
    Another program reads back with equal ones (``equal_programs``).

    A reader needs more than the text: the targets of units, and the constants that the application sets. They
    stand in comments above it, as options of ``fixedpipe combiners``. Raises ValueError with a sentence where
    ps.1.0 to ps.1.3 cannot express the program.
    """
    combiners = program.combiners
    if combiners is None:
        raise ValueError(
            "The program has texture shaders alone, and a pixel shader has combiners as well; write it as "
            "!!TS1.0 (--ts), or give it combiners."
        )
    comments = []
    if _is_without_fog(combiners.final):
        final = replace(combiners.final, a=_FINAL.a, b=_FINAL.b, c=_FINAL.c, d=_FINAL.d)
        combiners = replace(combiners, final=final)
        program = replace(program, combiners=combiners)
        comments = [_WITHOUT_FOG]
    _refuse_other_final_combiners(combiners)
    muxes = (portion.mux_sum for stage in combiners.general for portion in (stage.rgb, stage.alpha))
    if combiners.mux_select is not MuxSelect.MSB and any(muxes):
        raise ValueError(
            "The program's muxes choose by the lowest bit of SPARE0's alpha (mux_select LSB); cnd and cmp of "
            f"ps.1.0 to ps.1.3 choose by the highest. {_OTHERWISE}"
        )
    problem = None
    for whole in _choices(combiners):
        try:
            return "".join(f"; {comment}\n" for comment in comments) + _written(program, whole)
        except ValueError as error:
            problem = problem or error
    raise problem


def _is_without_fog(final):
    """Whether the final combiner gives SPARE0's unchanged color, by its D, or by its B or C alone."""
    spare0, one = CombinerInput(Register.SPARE0), replace(_ZERO, mapping=Mapping.UNSIGNED_INVERT)
    a, b, c, d = final.a, final.b, final.c, final.d
    return (a, b, c, d) == (_ZERO, _ZERO, _ZERO, spare0) or (
        d == _ZERO and ((a == one and b == spare0) or (a == _ZERO and c == spare0))
    )


def _choices(combiners):
    """The sets of dot products that may be a dp3 of all four components, the likeliest first."""
    numbers = list(dot_products(combiners.general))
    likely = [not alpha_is_read(combiners, number) for number in numbers]
    for others in combinations((False, True), repeat=len(numbers)):
        chosen = zip(numbers, likely, others, strict=True)
        yield frozenset(number for number, guess, other in chosen if guess is not other)


def _refuse_other_final_combiners(combiners):
    final, usages = combiners.final, (ComponentUsage.ALPHA, ComponentUsage.BLUE)
    for variable in "abcd":
        given, wanted = getattr(final, variable), getattr(_FINAL, variable)
        zero = given.register is Register.ZERO and given.mapping is Mapping.UNSIGNED_IDENTITY
        if given != wanted and not (zero and wanted == _ZERO):
            raise ValueError(
                f"The final combiner's {variable.upper()} is the {_in_words(given)}, where ps.1.0 to ps.1.3 "
                f"have the {_in_words(wanted)}: they give SPARE0, with fog. {_OTHERWISE}"
            )
    wanted = [CombinerInput(Register.SPARE0, usage=usage) for usage in usages]
    if final.g not in wanted:
        raise ValueError(
            f"The final combiner's G is the {_in_words(final.g)}, where ps.1.0 to ps.1.3 give the alpha of "
            f"SPARE0. {_OTHERWISE}"
        )


def _in_words(given):
    part = {ComponentUsage.ALPHA: "alpha", ComponentUsage.BLUE: "blue"}.get(given.usage, "color")
    mapped = "" if given.mapping is Mapping.UNSIGNED_IDENTITY else f", by {given.mapping.name}"
    return f"{part} of {given.register.name}{mapped}"


# ----------------------------------------------------------------------------------------------- the text


def _was_pixel_shader(program):
    return program.notations[0].startswith("ps.")


def _written(program, whole):
    """The text, after it was read back. ``whole`` is that of a Writer."""
    combiners, stages = program.combiners, program.texture_shader
    texture, places, shared = texture_instructions(stages), None, False
    if _was_pixel_shader(program):
        shared = any(place.stage is None for place in program.constants)
        places = {
            (number, place.register, half): place.constant
            for place in program.constants
            for half in ("rgb", "a")
            if place.components in ("rgba", half)
            for number in ([place.stage] if place.stage is not None else range(len(combiners.general)))
        }
    groups = Writer(combiners, Operands(stages, places, program.colors), whole).groups()
    if places is None:
        names, definitions = _allocated(combiners, groups, texture.eyes)
        given = {}
    else:
        names = {}
        for unit in texture.eyes:
            if (unit, None, "rgb") not in places:
                raise ValueError(
                    f"Texture shader stage {unit} has an eye, and the program has no constant for it; say "
                    "which it is (Program.constants)."
                )
            names[Constant(unit, None)] = f"c{places[unit, None, 'rgb']}"
        definitions = {n: color for n, color in program.colors.items() if n in program.defined}
        given = {n: color for n, color in program.colors.items() if n not in program.defined and any(color)}
    lines = [f"; {comment}" for comment in texture.comments]
    lines += [f"; --target {unit}={target.name}" for unit, target in texture.targets.items()]
    lines += [f"; --constant {n}={','.join(map(_number, color))}" for n, color in sorted(given.items())]
    lines.append(f"ps.{_version(texture.names, groups)}")
    lines += [f"def c{n}, {', '.join(map(_number, color))}" for n, color in sorted(definitions.items())]
    eyes = [names.get(Constant(unit, None), "") for unit in range(REGISTER_COUNTS["t"])]
    lines += [line.format(*eyes) for line in texture.lines]
    for group in groups:
        lines += [f"{'+ ' if k else ''}{written.text(names)}" for k, written in enumerate(group.written)]
    text = "\n".join(lines) + "\n"
    try:
        shader = parse(text, texture.targets, given, per_stage_constants=not shared)
    except PixelShaderTextError as error:
        raise ValueError(f"Written as a pixel shader, the program is refused, at {error}") from error
    _check(program, shader)
    return text


def _number(value):
    """The shortest digits that read back as the same float."""
    return repr(float(value)).removesuffix(".0")


def _version(textures, groups):
    """The first version that has the instructions, and reads as many texture registers in one."""
    since = [TEXTURE[name][1] for name in textures]
    for written in (written for group in groups for written in group.written):
        since.append(ARITHMETIC[written.instruction.name][1])
        ports = {source.name for source in written.sources if str(source.name).startswith("t")}
        since.append(next(v for v in VERSIONS if most_read(v, "t") >= len(ports)))
    return max(_FIRST_VERSION, *since) if since else _FIRST_VERSION


def _allocated(combiners, groups, eyes):
    """{Constant: name} and {number: color} of the constants that groups, and eyes of stages, read."""
    needed = {Constant(unit, None): {"rgb": eye} for unit, eye in eyes.items()}
    for group in groups:
        for written in group.written:
            for source, half in _halves_of_sources(written):
                if not isinstance(source.name, Constant):
                    continue
                color = (0.0,) * 4
                if source.name.register is not Register.ZERO:
                    color = constant_color(combiners, source.name.stage, source.name.register)
                needed.setdefault(source.name, {})[half] = color[3:] if half == "a" else color[:3]
    slots, names = [], {}
    for constant, halves in needed.items():
        fitting = (s for s in slots if all(s.get(half, value) == value for half, value in halves.items()))
        slot = next(fitting, None)
        if slot is None:
            slot = {}
            slots.append(slot)
        slot.update(halves)
        names[constant] = f"c{slots.index(slot)}"
    if len(slots) > REGISTER_COUNTS["c"]:
        raise ValueError(
            f"The program reads {len(slots)} different constants; a pixel shader has {REGISTER_COUNTS['c']}, "
            f"c0 to c7. Split it into passes. {_OTHERWISE}"
        )
    colors = ((*slot.get("rgb", (0.0,) * 3), *slot.get("a", (0.0,))) for slot in slots)
    return names, dict(enumerate(colors))


def _halves_of_sources(written):
    """(source, the half of it that is read) for each source of a written instruction."""
    for half in ("rgb", "a") if written.mask == "" else (written.mask,):
        for source in written.sources:
            yield source, "a" if source.selector == "a" or (half == "a" and not source.selector) else "rgb"


# ----------------------------------------------------------------------------------------- what is read back


def _check(program, shader: PixelShader):
    """Refuse a text that does not read back as the program."""
    if _was_pixel_shader(program):
        same = (
            shader.combiners == program.combiners
            and shader.texture_shader == program.texture_shader
            and shader.constants == program.constants
            and shader.colors == program.colors
            and shader.defined == program.defined & set(program.colors)
        )
    else:
        stages = program.texture_shader
        same = plain_stages(shader.texture_shader) == plain_stages(stages) and plain_combiners(
            shader.combiners, stages
        ) == plain_combiners(program.combiners, stages)
    if not same:
        raise ValueError(
            f"{_first_difference(program, shader)} would change if it were written as a pixel shader and "
            f"read back; ps.1.0 to ps.1.3 cannot express it. {_OTHERWISE}"
        )


def _first_difference(program, shader):
    """The first part that reads back differently, in words."""
    stages = program.texture_shader
    for what, count, find in (
        ("Texture shader stage", len(stages or ()), lambda given: plain_stages(given.texture_shader)),
        (
            "General combiner",
            len(program.combiners.general),
            lambda given: plain_combiners(given.combiners, stages)[0],
        ),
    ):
        found, wanted = find(shader), find(program)
        if len(found) == len(wanted) == count:
            for number, pair in enumerate(zip(found, wanted, strict=True)):
                if pair[0] != pair[1]:
                    return f"{what} {number}"
    return "The program"
