"""A program in any of nvparse's notations, as texture shader stages and register combiners.

The header names the notation: ``!!TS1.0``, ``!!RC1.0``, both one after the other (as the Cg compiler's
profile fp20 writes them), ``ps.1.0`` to ``ps.1.3``, or the Xbox's ``xps.1.0`` and ``xps.1.1``. A text without
a header may be a dump of the NV2A's registers.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.notations import (
    nv2a_registers,
    pixel_shader_translation,
    register_combiners,
    texture_shaders,
    xbox_pixel_shader_translation,
)
from fixedpipe.pipeline.notations.nv2a_dumps import is_dump
from fixedpipe.pipeline.notations.pixel_shader_textures import ConstantPlace
from fixedpipe.pipeline.notations.program_sources import ProgramSources
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from fixedpipe.pipeline.programs.texture_shader_rules import texture_target
from fixedpipe.pipeline.state import Color, RegisterCombiners, TextureShaderStage

# Assumed: more than any program with its comments; reading this many takes seconds.
MOST_CHARACTERS = 1_000_000
# The text that may precede a header: white space, and the comments of either notation.
_SKIPPED = re.compile(r"(?: \s+ | //[^\n]* | /\*.*?\*/ | \#[^\n]* | ;[^\n]* )*+", re.VERBOSE | re.DOTALL)
# The end mark of a C string, and of a CP/M file, where nothing follows.
_END_MARKS = re.compile(r"[\0\x1a]+\s*\Z")
# Preprocessor directives, which look like comments.
_DIRECTIVE = re.compile(
    r"^[ \t]*(#(?:define|include|undef|ifdef|ifndef|if|else|elif|endif|pragma)\b)", re.MULTILINE
)
_HEADER = re.compile(r"!!(?:TS|RC)1\.0|[a-z]{2,3}[._][0-9]+[._][0-9x]+", re.IGNORECASE)
_SECOND_HEADER = re.compile(r"^[ \t]*!!(?:TS|RC)1\.0", re.MULTILINE)


@dataclass(frozen=True)
class Program:
    """The contents of a program's text, as states for a PassState. ``parse_program`` makes it.

    - ``notations``: the headers, in order.
    - ``texture_shader``: None if the text has none; each unit then samples its bound texture.
    - ``combiners``: None if the text has only texture shaders.
    - ``targets``: the target of the texture that each unit's stage reads, or None.
    - ``constants``: the places of a pixel shader's constant registers.
    - ``colors``: {number: color} of these constants, from the text or from the application.
    - ``defined``: the numbers of the constants that the text defines.
    - ``notes``: sentences on what a stricter reader would refuse.
    - ``sources``: the lines of each part.
    """

    notations: tuple[str, ...]
    texture_shader: tuple[TextureShaderStage, ...] | None
    combiners: RegisterCombiners | None
    targets: tuple[TextureTarget | None, ...] = ()
    constants: tuple[ConstantPlace, ...] = ()
    notes: tuple[str, ...] = ()
    sources: ProgramSources = field(default_factory=ProgramSources, compare=False)
    colors: Mapping[int, Color] = field(default_factory=dict)
    defined: frozenset[int] = frozenset()

    def tell(self, sentence: str) -> str:
        """A sentence about the state in the program's own words, with the lines that it concerns."""
        return self.sources.tell(sentence, self.notations)


def _place(text, at):
    line_start = text.rfind("\n", 0, at) + 1
    return text.count("\n", 0, at) + 1, at - line_start + 1


def parse_program(
    text: str,
    targets: Mapping[int, TextureTarget] | None = None,
    constants: Mapping[int, Color] | None = None,
    per_stage_constants: bool = True,
    draw: int | None = None,
) -> Program:
    """Read a text. Returns its Program.

    - ``targets``: {unit: TextureTarget} of the bound textures, for a pixel shader.
    - ``constants``: {number: color} that the application sets, for a pixel shader.
    - ``per_stage_constants``: whether a pixel shader's general combiners have two constants each
      (NV_register_combiners2), as the machine's profile says. Otherwise all of them share the program's two,
      and more are refused.
    - ``draw``: the number, from 1, of a draw in a dump of registers with several; None is the last. Other
      notations ignore it.

    Raises ProgramTextError with line and column, both from 1.
    """
    if len(text) > MOST_CHARACTERS:
        raise ProgramTextError(
            f"the text has {len(text)} characters; programs of the time have thousands, and at most "
            f"{MOST_CHARACTERS} are read. Give the program alone.",
            1,
            1,
        )
    text = _END_MARKS.sub("", text)
    at = _SKIPPED.match(text).end()  # type: ignore[union-attr]  # it matches the empty string
    directive = _DIRECTIVE.search(text, 0, at)
    if directive is not None:
        raise ProgramTextError(
            f"found {directive[1]!r}, a preprocessor directive; give the text that the preprocessor writes.",
            *_place(text, directive.start(1)),
        )
    header = _HEADER.match(text, at)
    if header is None and is_dump(text):
        stages, combiners, sources, notes = nv2a_registers.parse(text, draw=draw)
        program = _program((nv2a_registers.HEADER,), stages, combiners)
        return replace(program, sources=sources, notes=notes)
    if header is None and re.match(r"[^\0]?\0[^\0]", text[at:]):
        raise ProgramTextError(
            "the text is in UTF-16, or another encoding of several bytes; save it as UTF-8.",
            *_place(text, at),
        )
    if header is None:
        found = text[at : at + 20].split("\n")[0].strip()
        raise ProgramTextError(
            f"{f'found {found!r}' if found else 'the text ends'} where the header belongs; begin the "
            "program with !!RC1.0, !!TS1.0, ps.1.1 or xps.1.1, or give words of the NV2A's registers.",
            *_place(text, at),
        )
    if not header.group().startswith("!!"):
        # Comments of the other notations before the version are no comments of this one.
        xbox = header.group().lower().startswith("xps")
        translation = xbox_pixel_shader_translation if xbox else pixel_shader_translation
        shader = translation.parse(text[at:], targets, constants, _place(text, at), per_stage_constants)
        notation = f"{'xps' if xbox else 'ps'}.{shader.version}"
        program = _program((notation,), shader.texture_shader, shader.combiners)
        return replace(
            program,
            constants=shader.constants,
            notes=shader.notes,
            sources=shader.sources,
            colors=shader.colors,
            defined=shader.defined,
        )
    second = _SECOND_HEADER.search(text, header.end())
    parts = [text[at:]] if second is None else [text[at : second.start()], text[second.start() :]]
    starts = [_place(text, at)] if second is None else [_place(text, at), _place(text, second.start())]
    programs = {}
    for part, start in zip(parts, starts, strict=True):
        name = part.strip()[:7].upper()
        if name in programs:
            raise ProgramTextError(
                f"a second {name}; a program has one of each notation. Split the text.", *start
            )
        module = register_combiners if name == "!!RC1.0" else texture_shaders
        programs[name] = module.parse_with_sources(part, start)
    nothing = None, ProgramSources()
    stages, of_stages = programs.get("!!TS1.0", nothing)
    combiners, sources = programs.get("!!RC1.0", nothing)
    program = _program(tuple(programs), stages, combiners)
    return replace(program, sources=replace(sources, texture_shader=of_stages.texture_shader))


def _program(notations, stages, combiners):
    targets = tuple(texture_target(stage.operation) for stage in stages or ())
    return Program(notations, stages, combiners, targets)
