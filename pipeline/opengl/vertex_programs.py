"""Refuses programs and shaders: those for fragments, and those that are newer than the machines here.

Vertex programs are carried out (vertex_program_draws.py, arb_vertex_programs.py).

A call that makes or sets such a program is refused. So is a draw while such a program is in use.
"""

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry, register
from fixedpipe.pipeline.opengl.outcomes import Refused
from fixedpipe.pipeline.opengl.values import declare, section

# GetIntegerv(CURRENT_PROGRAM), and ATI_fragment_shader's capability.
CURRENT_PROGRAM, _FRAGMENT_SHADER_ATI = 0x8B8D, 0x8920

_FRAGMENTS = "fragment programs are not drawn here"
_STATE_PROGRAMS = "vertex state programs are not carried out here"
_SHADERS = "OpenGL's shaders came after the machines here"
_ATI = "no machine here has ATI_fragment_shader"

for _token in (
    tokens.VERTEX_PROGRAM_ARB,
    tokens.VERTEX_PROGRAM_TWO_SIDE_NV,
    tokens.VERTEX_PROGRAM_POINT_SIZE_NV,
    tokens.FRAGMENT_PROGRAM_ARB,
    _FRAGMENT_SHADER_ATI,
):
    capability(_token)
# The shader program in use; 0: none.
declare("program", 0)


@section(
    "programs",
    "program",
    ("enabled", tokens.FRAGMENT_PROGRAM_ARB),
    ("enabled", _FRAGMENT_SHADER_ATI),
)
def _programs(gl, program, fragment, ati):
    """None. Raises Refused while such a program is in use."""
    if program:
        raise Refused(_SHADERS)
    if fragment:
        raise Refused(_FRAGMENTS)
    if ati:
        raise Refused(_ATI)


def _refused(sentence):
    def refuse(gl, *arguments):
        raise Refused(sentence)

    return refuse


@entry("UseProgram", "UseProgramObject")
def use_program(gl, program):
    """Set the shader program that later draws use. These draws are refused."""
    gl.values.set("program", int(program or 0))


def _register_refused():
    shaders = (
        *("CreateShader", "CreateShaderObject", "CreateProgram", "CreateProgramObject", "ShaderSource"),
        *("CompileShader", "AttachShader", "AttachObject", "LinkProgram", "ValidateProgram"),
        *("DeleteShader", "DeleteProgram", "DeleteObject", "DetachShader", "DetachObject"),
        *("BindAttribLocation", "GetUniformLocation", "GetAttribLocation", "BindFragDataLocation"),
        *("GetShaderiv", "GetProgramiv", "GetShaderInfoLog", "GetProgramInfoLog", "GetInfoLog"),
        *("GetObjectParameteriv", "GetAttachedShaders", "GetActiveUniform", "GetShaderSource"),
    )
    uniforms = [f"Uniform{n}{t}{v}" for n in "1234" for t in ("f", "i", "ui") for v in ("", "v")]
    matrices = [f"UniformMatrix{n}fv" for n in ("2", "3", "4", "2x3", "3x2", "2x4", "4x2", "3x4", "4x3")]
    ati = (
        *("GenFragmentShaders", "BindFragmentShader", "DeleteFragmentShader", "BeginFragmentShader"),
        *("EndFragmentShader", "PassTexCoord", "SampleMap", "SetFragmentShaderConstant"),
        *(f"{kind}FragmentOp{n}" for kind in ("Color", "Alpha") for n in "123"),
    )
    for names, sentence in (
        (("ExecuteProgram",), _STATE_PROGRAMS),
        ((*shaders, *uniforms, *matrices), _SHADERS),
        (ati, _ATI),
    ):
        for name in names:
            register(name, _refused(sentence), compiled=False)


_register_refused()
