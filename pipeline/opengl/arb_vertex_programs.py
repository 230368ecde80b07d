"""The calls of ARB_vertex_program for a program's text, and for environment and local parameters."""

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.arb_program_text import assembled
from fixedpipe.pipeline.opengl.entry_points import entry, no_effect
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.vertex_program_objects import (
    check_target,
    give_text,
    register_parameters,
    set_environment,
)


@entry("ProgramString", compiled=False)
def program_string(gl, target, form, length, text):
    """Set the text of the bound program."""
    check_target(target)
    if form != tokens.PROGRAM_FORMAT_ASCII_ARB:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(form)} is no format of a program")
    give_text(gl, gl.values["vertex program"], length, text, assembled)


# A recorded program already has the answers of its driver.
no_effect(
    *("GetProgramivARB", "GetProgramStringARB"),
    *[f"GetProgram{kind}Parameter{suffix}v" for kind in ("Env", "Local") for suffix in "fd"],
    compiled=False,
)


def _set_locals(gl, first, rows):
    for number, row in enumerate(rows, first):
        gl.shared.local_parameters[gl.values["vertex program"], number] = row


register_parameters("ProgramEnvParameter", "", set_environment, "f")
register_parameters("ProgramLocalParameter", "", _set_locals, "f")
