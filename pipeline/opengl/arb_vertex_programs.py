"""ARB_vertex_program's calls: program objects, their texts, and environment and local parameters.

Fragment programs have the same calls with another target, and are refused by name.
"""

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.arb_program_text import ENVIRONMENT, LOCALS, ArbProgram, assembled
from fixedpipe.pipeline.opengl.current import filled
from fixedpipe.pipeline.opengl.entry_points import entry, no_effect, register
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare

_LONGEST = 1 << 16  # characters of a program. Assumed: 128 instructions take a tenth

declare("position kept", False)


def _vertex(target):
    """Raise GLError or Refused for another target than VERTEX_PROGRAM."""
    if target == tokens.FRAGMENT_PROGRAM_ARB:
        raise Refused("fragment programs are not drawn here")
    if target != tokens.VERTEX_PROGRAM_ARB:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is no kind of program")


def _choose(gl, name):
    """Make a program the bound one; its text decides who computes the position."""
    program = gl.shared.programs.get(name)
    gl.values.set("vertex program", name)
    gl.values.set("position kept", isinstance(program, ArbProgram) and program.keeps_position)


@entry("BindProgram")
def bind_program(gl, target, name):
    """Choose the vertex program that draws use."""
    _vertex(target)
    _choose(gl, int(name))


@entry("ProgramString", compiled=False)
def program_string(gl, target, form, length, text):
    """Give the bound program its text."""
    _vertex(target)
    if form != tokens.PROGRAM_FORMAT_ASCII_ARB:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(form)} is no format of a program")
    if not 0 <= length <= _LONGEST:
        raise GLError(tokens.INVALID_VALUE, f"a program of {length} characters")
    name = gl.values["vertex program"]
    given = text.decode("latin-1") if isinstance(text, bytes) else str(text)
    try:
        gl.shared.programs[name] = assembled(given[:length])
    except ValueError as error:
        gl.shared.programs.pop(name, None)
        raise GLError(tokens.INVALID_OPERATION, str(error)) from None
    finally:
        _choose(gl, name)


@entry("GenPrograms", compiled=False)
def gen_programs(gl, count, names=None):
    """Names of programs; in a trace those that the driver gave. They need not be entered."""


@entry("DeletePrograms", compiled=False)
def delete_programs(gl, count, names):
    """Forget programs with their local parameters."""
    for name in names[:count]:
        gl.shared.programs.pop(name, None)
        for key in [key for key in gl.shared.local_parameters if key[0] == name]:
            del gl.shared.local_parameters[key]
        if gl.values["vertex program"] == name:
            _choose(gl, 0)


@entry("IsProgram", compiled=False)
def is_program(gl, name):
    """Whether a program has a text."""
    return name in gl.shared.programs


# A recorded program has its driver's answers.
no_effect(
    *("GetProgramivARB", "GetProgramStringARB"),
    *[f"GetProgram{kind}Parameter{suffix}v" for kind in ("Env", "Local") for suffix in "fd"],
    compiled=False,
)


def _set_environment(gl, first, rows):
    before = gl.values["program parameters"]
    gl.values.set("program parameters", (*before[:first], *rows, *before[first + len(rows) :]))


def _set_locals(gl, first, rows):
    for number, row in enumerate(rows, first):
        gl.shared.local_parameters[gl.values["vertex program"], number] = row


def _register_parameters():
    for kind, limit, store in (("Env", ENVIRONMENT, _set_environment), ("Local", LOCALS, _set_locals)):

        def set_rows(gl, target, first, rows, limit=limit, store=store):
            _vertex(target)
            if not 0 <= first <= first + len(rows) <= limit:
                raise GLError(
                    tokens.INVALID_VALUE, f"parameters {first} to {first + len(rows) - 1} of {limit}"
                )
            store(gl, first, rows)

        def one(gl, target, index, *components, set_rows=set_rows):
            set_rows(gl, target, index, [filled(components)])

        def vector(gl, target, index, components, set_rows=set_rows):
            set_rows(gl, target, index, [filled(components[:4])])

        def several(gl, target, first, count, numbers, set_rows=set_rows):
            set_rows(gl, target, first, [filled(numbers[4 * n : 4 * n + 4]) for n in range(count)])

        for suffix in "fd":
            register(f"Program{kind}Parameter4{suffix}", one)
            register(f"Program{kind}Parameter4{suffix}v", vector)
        register(f"Program{kind}Parameters4fv", several)


_register_parameters()
