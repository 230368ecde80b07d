"""Program objects of NV_vertex_program and ARB_vertex_program: names, texts and numeric parameters.

Both extensions have the same objects and the same environment parameters (NV_vertex_program1_1). Fragment
programs use ARB's calls with another target. They are refused with a sentence that names them.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.current import filled
from fixedpipe.pipeline.opengl.entry_points import entry, register
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare

# Source: NV_vertex_program's 96 program parameters; ARB_vertex_program requires the same number of each kind.
PARAMETERS = 96
_LONGEST = 1 << 16  # the most characters of a program. Assumed: 128 instructions take a tenth of this

declare("vertex program", 0)
# Whether the fixed functions compute the position while the bound program is used.
declare("position kept", False)
declare("program parameters", ((0.0, 0.0, 0.0, 0.0),) * PARAMETERS)


def check_target(target: int) -> None:
    """Raise GLError or Refused for any target except VERTEX_PROGRAM."""
    if target == tokens.FRAGMENT_PROGRAM_ARB:
        raise Refused("fragment programs are not drawn here")
    if target != tokens.VERTEX_PROGRAM_ARB:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(target)} is no kind of program")


def give_text(gl: Any, name: int, length: int, text: Any, assembled: Callable[[str], Any]) -> None:
    """Set the text of a program: the first ``length`` characters of bytes or of a string.

    Raises GLError if the length is out of range, or if ``assembled`` raises ValueError for the text.
    """
    if not 0 <= length <= _LONGEST:
        raise GLError(tokens.INVALID_VALUE, f"a program of {length} characters")
    given = text.decode("latin-1") if isinstance(text, bytes) else str(text)
    try:
        gl.shared.programs[name] = assembled(given[:length])
    except ValueError as error:
        gl.shared.programs.pop(name, None)
        raise GLError(tokens.INVALID_OPERATION, str(error)) from None
    finally:
        _choose(gl, gl.values["vertex program"])


def _choose(gl, name):
    program = gl.shared.programs.get(name)
    gl.values.set("vertex program", name)
    gl.values.set("position kept", getattr(program, "keeps_position", False))


@entry("BindProgram")
def bind_program(gl, target, name):
    """Choose the vertex program that draws use."""
    check_target(target)
    _choose(gl, int(name))


@entry("GenPrograms", compiled=False)
def gen_programs(gl, count, names=None):
    """Do nothing. In a trace the driver has chosen the names, and they are not stored here."""


@entry("DeletePrograms", compiled=False)
def delete_programs(gl, count, names):
    """Delete programs and their local parameters."""
    if count < 0:
        raise GLError(tokens.INVALID_VALUE, f"{count} programs")
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


def set_environment(gl: Any, first: int, rows: Sequence[tuple[float, ...]]) -> None:
    """Set environment parameters, which all programs read."""
    before = gl.values["program parameters"]
    gl.values.set("program parameters", (*before[:first], *rows, *before[first + len(rows) :]))


def register_parameters(
    name: str, vendor: str, store: Callable[[Any, int, Sequence[tuple[float, ...]]], None], several: str
) -> None:
    """Register the calls that set parameters: ``name`` with 4f, 4fv, 4d and 4dv, and s4fv or s4dv.

    ``vendor``: the suffix of their names. ``several``: "f" or "fd", the types of calls that set several.
    """

    def set_rows(gl, target, first, rows):
        check_target(target)
        last = first + len(rows) - 1
        if not 0 <= first <= last + 1 <= PARAMETERS:
            raise GLError(tokens.INVALID_VALUE, f"parameters {first} to {last} of {PARAMETERS}")
        store(gl, first, rows)

    def one(gl, target, index, *components):
        set_rows(gl, target, index, [filled(components)])

    def vector(gl, target, index, components):
        set_rows(gl, target, index, [filled(components[:4])])

    def rows_of(gl, target, first, count, numbers):
        numbers = np.frombuffer(numbers, np.float32) if isinstance(numbers, bytes) else numbers
        set_rows(gl, target, first, [filled(numbers[4 * n : 4 * n + 4]) for n in range(count)])

    for suffix in "fd":
        register(f"{name}4{suffix}{vendor}", one)
        register(f"{name}4{suffix}v{vendor}", vector)
    for suffix in several:
        register(f"{name}s4{suffix}v{vendor}", rows_of)
