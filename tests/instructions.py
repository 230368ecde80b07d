"""docs/program-instructions.md, made of readers and profiles: ``python -m tests.instructions``."""

import textwrap
from pathlib import Path

from fixedpipe.pipeline.description.equations import shader_stage_equation
from fixedpipe.pipeline.enums import TextureTarget
from fixedpipe.pipeline.notations.pixel_shaders import TEXTURE
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.validation.validate import validate_program
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.documents import WIDTH, table
from tests.support.instructions import COMBINERS, DEFINITIONS, GROUPS, numbers_of, pixel_shader
from tests.support.refusals import REFUSALS, SOURCES
from tests.support.texture_operations import BYTE, DOT, MAPPED, OPERATIONS

PAGE = Path(__file__).parents[1] / "docs" / "program-instructions.md"
SHADERS = {name: p for name, p in PROFILES.items() if p.texture_shaders.texture_shader_operations}

_HEAD = """\
# What each instruction becomes, and where it rounds

After this page you know which combiners an instruction becomes, what they compute on each machine, and which
reader refuses a program. `make instructions` makes the page, and a test fails where it is stale.

The column of general combiners has what `fixedpipe combiners --rc` prints for the row's program. The column
of a machine has "yes" if the machine accepts the program, otherwise "-". The page [Programs as
text](combiner-notations.md) explains the notations, and [Numbers](numbers.md) has every rule with its
evidence.

Tests compare every formula, as it is written here, with every machine that has the construct.
`tests/pipeline/notations/test_instructions.py` takes all pairs of bytes on the NV2A, and 68 by 68 of them on
the others. `tests/pipeline/notations/test_texture_operations.py` tests texture shaders.

"""
_WORDS = """\
A general combiner computes the products AB and CD, and their sum. In the tables below, the first statement of
a combiner gives A and B, the second gives C and D, and `sum()` is AB + CD. A register alone is multiplied by
one, and discard stores nothing. Formulas compute whole numbers in units of 1/one, each component by itself.
They have these names:

| name | what it is |
| --- | --- |
| a, b | the texels of t0 and t1 (tex0, tex1) |
| c, d | the primary color (v0, col0) and the secondary color |
| x | a register of either sign |
| `dot(a, b)` | the sum of the three products of red, green and blue |
| `alpha(a)`, `blue(a)` | the alpha or the blue of a, in every component |
| `//` | a quotient, cut to the whole number below |
| rn | a quotient by one, rounded to nearest; one is odd, so no quotient is half way |
| halved | half of a number; halves are rounded up, also below 0 |
| signed | what EXPAND_NORMAL makes of the stored red, green or blue; alpha is its magnitude with its sign |
| written | the byte that is written to the frame |

The functions, on machines and in the ideal:

"""
_TEXTURES = """\
The bound texture's target chooses the operation. Without `--target`, the reader takes the first of an
instruction's rows, which is a cube map for texm3x3tex and its kin. A table [below](#operations-of-ts10) has
what the operations compute. Machines without combiners run no pixel shader.

"""
_SHADERS = """\
Formulas of texture shaders have these names:

| name | what it is |
| --- | --- |
| s, t, r, q | the last stage's coordinates |
| R, G, B, A | the bytes of the texel that it reads |
| `signed(v)` | a byte as two's complement |
| dots, qs | the dot products of the group's stages, in order, and the stages' q |
| `{dot}` | a dot product; x, y, z are the texel's red, green and blue, mapped by the table below |
| a1 to a4, scale, bias, eye | the program's numbers |
| units | the greatest depth; 1 on the NV2A (coordinates in depth units) and in the ideal (depths of 0 to 1) |

Lookups and their filters round as section 7 of [numbers.md](numbers.md) says. Before a lookup, a texture
shader rounds in these four functions alone:

| function | how it rounds on machines |
| --- | --- |
| `byte` | to a byte, by the table below |
| `sum` | cuts each term at the last bit of the largest term, which has 24 bits |
| `dot` | cuts products and their sum, as N12.7 says |
| `quotient` | multiplies by a reciprocal (N12.9) |

On machines a depth is cut to a whole number. It ends the fragment below 0, above the greatest depth, and
where the divisor is 0. If a group gives two texels, its second stage looks up at dots.

"""
_WHO = """\
What Direct3D's validator does is from its public documentation. What nvparse does is from its source, as
distributed with OGRE 3D. The project's readers read every program when this page was made. Programs without a
header begin with `ps.1.1`.

"""
_ROUNDING = {True: "once, of the sum of the products", False: "of every product"}


def _cell(text):
    return f"`{text}`" if text else ""


def _wrapped(text):
    return textwrap.fill(text, WIDTH, break_on_hyphens=False, break_long_words=False)


def _body(text):
    """A program's text in a cell."""
    return "<br>".join(_cell(line) for line in text.splitlines())


def _fits(program, profile):
    try:
        validate_program(program.texture_shader, program.combiners, profile)
    except UnsupportedState:
        return False
    return True


def _marks(program, profiles):
    return ["yes" if _fits(program, p) else "-" for p in profiles.values()]


def _marks_of(text):
    """Of a program with constants, where they stand on each machine."""
    of_each = (
        parse_program(text, per_stage_constants=p.combiners.per_stage_constants) for p in COMBINERS.values()
    )
    return [_marks(program, {"": p})[0] for program, p in zip(of_each, COMBINERS.values(), strict=True)]


def _definitions():
    rows = [(f"`{name}({argument})`", *map(_cell, texts)) for name, (argument, *texts) in DEFINITIONS.items()]
    return table(("", "machines", "ideal"), rows) + "\n"


def _of_machines():
    """What the machines with combiners have, and their numbers."""
    rows = []
    for name, p in COMBINERS.items():
        numbers, arithmetic = numbers_of(p), p.arithmetic
        ends = ("none", "none") if numbers.exact else (str(numbers.low), str(numbers.high))
        order = "before bias and scale" if arithmetic.round_before_scale else "after the scale"
        joint = arithmetic.product_rounding.name == "JOINT"
        rounding = "none" if numbers.exact else f"{_ROUNDING[joint]}, {order}"
        rows.append(
            (
                f"`{name}`",
                str(p.combiners.max_general_combiners),
                "each combiner's" if p.combiners.per_stage_constants else "two in all",
                str(p.textures.max_texture_units),
                "yes" if p.combiners.blue_to_alpha else "-",
                str(numbers.one),
                f"{numbers.half:g}",
                str(numbers.expand),
                *ends,
                rounding,
            )
        )
    head = (
        *("machine", "general combiners", "constants", "texture units", "blue to alpha"),
        *("one", "half", "expand", "low", "high", "rounds"),
    )
    return table(head, rows)


def _combiners(program, last):
    """The general combiners of a program as --rc prints them, or its last: the color's portion of each, and
    the alpha's where it is another.
    """
    stages = []
    for line in map(str.strip, format_program(program.combiners).splitlines()):
        if line == "{":
            stages.append({})
        elif line in ("rgb {", "alpha {"):
            portion = stages[-1].setdefault(line.removesuffix(" {"), [])
        elif stages and line != "}" and not line.startswith(("const", "out")):
            portion.append(line)
    cells = []
    for stage in stages[-1:] if last else stages:
        color, alpha = (" ".join(stage.get(name, ())) for name in ("rgb", "alpha"))
        cells += [_cell(color)] if color else []
        cells += [f"alpha: {_cell(alpha)}"] if alpha and alpha != color else []
    return "<br>".join(cells)


def _formulas(key):
    """The table of one Group."""
    group, rows = GROUPS[key], []
    translated = group.program is pixel_shader  # !!RC1.0 says the combiners itself
    for row in group.rows:
        program = parse_program(group.program(row))
        combiners = (_combiners(program, key == "sources"),) if translated else ()
        cells = (_cell(row.construct), _body(row.text), *combiners, _cell(row.formula))
        rows.append((*cells, *_marks_of(group.program(row))))
    combiners = ("general combiners",) if translated else ()
    head = ("construct", "program", *combiners, "result", *(f"`{name}`" for name in COMBINERS))
    return f"## {group.title}\n\n{_wrapped(group.note)}\n\n{table(head, rows)}\n"


_BEFORE = {
    "texm3x2tex": "texm3x2pad t1, t0\n",
    "texm3x2depth": "texm3x2pad t1, t0\n",
    "texm3x3tex": "texm3x3pad t1, t0\ntexm3x3pad t2, t0\n",
    "texm3x3spec": "texm3x3pad t1, t0\ntexm3x3pad t2, t0\n",
    "texm3x3vspec": "texm3x3pad t1, t0\ntexm3x3pad t2, t0\n",
    "texm3x3": "texm3x3pad t1, t0\ntexm3x3pad t2, t0\n",
}
_AFTER = {"texm3x2pad": "texm3x2tex t2, t0\n", "texm3x3pad": "texm3x3pad t2, t0\ntexm3x3tex t3, t0\n"}


def texture_program(name):
    """(a smallest program of a texture instruction of ps.1.x, its unit)."""
    count, since = TEXTURE[name]
    before = _BEFORE.get(name, "")
    unit = 0 if count == 0 else before.count("\n") + 1
    operands = ", ".join([f"t{unit}", *("t0", "c0")[:count]])
    first = "" if unit == 0 else "tex t0\n"
    return f"ps.{since}\n{first}{before}{name} {operands}\n{_AFTER.get(name, '')}mov r0, v0\n", unit


def _texture_instructions():
    rows = []
    for name, (_, since) in TEXTURE.items():
        text, unit = texture_program(name)
        operations = {}
        for target in TextureTarget:
            try:
                program = parse_program(text, {unit: target})
            except ProgramTextError as error:
                refused = str(error).partition(": ")[2]
                continue
            operations.setdefault(program.texture_shader[unit].operation.name, []).append(
                (target.name, program)
            )
        if not operations:
            rows.append((_cell(name), since, f"refused: {refused}", "", *("-" for _ in SHADERS)))
        for operation, given in operations.items():
            targets = "any" if len(given) == len(TextureTarget) else ", ".join(target for target, _ in given)
            program = given[0][1]
            stages_alone = [
                "yes" if _fits_shaders(program, p) else "-" for p in SHADERS.values()
            ]  # whatever has no combiners runs no pixel shader
            rows.append((_cell(name), since, f"`{operation}`", targets, *stages_alone))
    head = ("instruction", "since", "operation", "of a texture", *(f"`{name}`" for name in SHADERS))
    return table(head, rows)


def _fits_shaders(program, profile):
    return bool(profile.combiners.max_general_combiners) and _fits(program, profile)


def _operations():
    rows = []
    for operation in OPERATIONS:
        program = parse_program(f"!!TS1.0\n{operation.text}\n")
        unit = len(program.texture_shader) - 1
        stage = program.texture_shader[unit]
        what, formula = operation.given
        parts = [f"looks up at {_cell(operation.made)}"] if operation.made else []
        if what:
            parts.append(f"{what}: {_cell(formula)}")
        if not parts:
            parts = [_cell(shader_stage_equation(unit, stage))]
        rows.append(
            (_cell(operation.words), f"`{stage.operation.name}`", "; ".join(parts), *_marks(program, SHADERS))
        )
    head = ("instruction", "operation", "what its last stage computes", *(f"`{name}`" for name in SHADERS))
    return table(head, rows)


def _mappings():
    rows = [(_cell(word), *map(_cell, texts)) for word, texts in MAPPED.items()]
    rows.append((_cell("byte(v)"), *map(_cell, BYTE)))
    return table(("", "machines", "ideal"), rows)


def _outcome(row):
    """What the readers here do with a Difference's program."""
    try:
        notes = parse_program(row.program).notes
    except ProgramTextError:
        return "refused"
    return "accepted, with a note" if any(row.proof in note for note in notes) else "accepted"


def _refusals():
    parts = []
    for title, note, rows in REFUSALS:
        cells = [
            (row.construct, _outcome(row), row.why, _body(row.text), SOURCES[row.source]) for row in rows
        ]
        head = ("construct", "here", "why", "program", "source of what they do")
        parts.append(f"### {title}\n\n{_wrapped(note)}{chr(10) * 2 if note else ''}{table(head, cells)}\n")
    return "".join(parts)


def page():
    """The whole page as text."""
    return "".join(
        [
            _HEAD,
            "## Machines, and their numbers\n\n",
            _of_machines(),
            "\n",
            _WORDS,
            _definitions(),
            *(_formulas(key) for key in ("instructions", "modifiers", "sources", "constants")),
            "## Texture instructions of ps.1.x\n\n",
            _TEXTURES,
            _texture_instructions(),
            "\n",
            *(_formulas(key) for key in ("products", "mappings", "scales", "final")),
            "## Operations of !!TS1.0\n\n",
            _SHADERS.format(dot=DOT),
            _mappings(),
            "\n",
            _operations(),
            "\n## Who refuses what\n\n",
            _WHO,
            _refusals().rstrip("\n") + "\n",
        ]
    )


if __name__ == "__main__":
    PAGE.write_text(page())
