"""A historical program in words: equations with their source lines, constants, and its size."""

from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

from fixedpipe.pipeline.description.equations import combiner_lines, shader_stage_equation
from fixedpipe.pipeline.description.words import format_value
from fixedpipe.pipeline.enums import Register
from fixedpipe.pipeline.messages import count
from fixedpipe.pipeline.notations.programs import Program
from fixedpipe.pipeline.notations.register_combiner_words import BLACK, constant_byte

_FIELDS = {Register.CONSTANT_COLOR0: "constant_color0", Register.CONSTANT_COLOR1: "constant_color1"}


def program_text(program: Program, clamped=()) -> str:
    """The program as equations, a line each. ``clamped`` is that of ``combiner_lines``."""
    sources, lines = program.sources, []
    if program.texture_shader is not None:
        lines.append("TEXTURE_SHADER enabled")
        for unit, stage in enumerate(program.texture_shader):
            title = f"stage {unit}{_title(sources.texture_shader, unit)}"
            lines.append(f"  {title}: {shader_stage_equation(unit, stage)}")
    combiners = program.combiners
    if combiners is not None:
        titles = [_title(sources.general, number) for number in range(len(combiners.general))]
        titles.append(f" ({sources.final})" if sources.final else "")
        found = combiner_lines(combiners, titles, _constants(program), clamped)
        for output in sources.unset:
            found = [_unset(line, output) for line in found]
        lines += found
    return "".join(f"{line}\n" for line in lines)


def usage(program: Program, most_combiners: int | None = None, most_units: int | None = None) -> str:
    """A line with the general combiners, constants and texture units that the program uses.

    ``most_combiners`` and ``most_units`` are the machine's numbers, if given.
    """
    taken = []
    if program.combiners is not None:
        taken.append(_of(len(program.combiners.general), most_combiners, "general combiner"))
        own = max(map(len, _places(program).values()), default=0)
        if own:
            taken.append(f"at most {own} of 2 constants in one")
        elif shared := {place.register for place in program.constants if place.stage is None}:
            taken.append(f"{len(shared)} of 2 constants in all")
    if program.texture_shader is not None:
        taken.append(_of(len(program.texture_shader), most_units, "texture unit"))
    return ", ".join(taken)


def program_json(program: Program) -> dict[str, Any]:
    """The program as JSON's dictionaries, lists, strings and numbers.

    It has states by the names of their fields, enumerations by their names, the equations, and the rest of
    the text's facts.
    """
    return {
        "notations": list(program.notations),
        "usage": usage(program),
        "texture_shader": _plain(program.texture_shader),
        "combiners": _plain(program.combiners),
        "targets": _plain(program.targets),
        "constants": [
            {
                "constant": place.constant,
                "stage": place.stage,
                "register": _plain(place.register),
                "components": place.components,
                "color": list(program.colors[place.constant]),
                "set_by_the_application": place.constant not in program.defined,
            }
            for place in program.constants
        ],
        "sources": _plain(program.sources),
        "equations": program_text(program).splitlines(),
        "notes": list(program.notes),
    }


def _plain(value):
    """A state as a JSON value."""
    for kind, written in _PLAIN:
        if isinstance(value, kind):
            return written(value)
    if is_dataclass(value):
        return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}
    return value


_PLAIN = ((Enum, lambda value: value.name), (tuple, lambda value: [_plain(each) for each in value]))


def _short(color):
    return f"({', '.join(f'{component:.4g}' for component in color)})"


def _of(number, most, what):
    return f"{number} of {count(most, what)}" if most else count(number, what)


def _title(sources, number):
    return f" ({sources[number]})" if number < len(sources) and sources[number] else ""


def _unset(line, output):
    return f"{line}, which the program leaves unset" if f": {output} = " in line else line


def _places(program):
    """{number of a general combiner: the fields of its own constants}."""
    return {
        number: [name for name in _FIELDS.values() if getattr(stage, name) is not None]
        for number, stage in enumerate(program.combiners.general)
    }


def _constants(program):
    """The colors in words: the program's constant, as written, as stored if that differs, and in bytes."""
    combiners, words = program.combiners, {}
    for owner, number in [(combiners, None), *((s, n) for n, s in enumerate(combiners.general))]:
        for name in _FIELDS.values():
            stored = getattr(owner, name)
            if stored is not None:
                names = [
                    p
                    for p in program.constants
                    if p.register and (p.stage, _FIELDS[p.register]) == (number, name)
                ]
                # The program's own constants exist without being set; they are black.
                if names or number is not None or stored != BLACK:
                    words[number, name] = _color(program, names, stored)
    return words


def _color(program, places, stored):
    bytes_ = f"bytes {' '.join(str(constant_byte(component)) for component in stored)}"
    if not places:
        return f"{format_value(stored)}, {bytes_}"
    said = []
    for place in places:
        name = f"c{place.constant}" + ("" if place.components == "rgba" else f".{place.components}")
        by = "" if place.constant in program.defined else ", set by the application"
        said.append(f"{name}{by} {format_value(program.colors[place.constant])}")
    same = len(places) == 1 and program.colors[places[0].constant] == stored
    return f"{' and '.join(said)}, {'' if same else f'stored {_short(stored)}, '}{bytes_}"
