"""Programs and shaders are refused by name, and so are draws with them; other draws are not."""

import pytest

from fixedpipe.pipeline.opengl import tokens as t
from tests.pipeline.opengl.drawn import context, counted


def draw(gl):
    gl.Begin(t.TRIANGLES)
    for corner in ((-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)):
        gl.Vertex2f(*corner)
    gl.End()
    return len(gl.take_commands())


@pytest.mark.parametrize(
    ("name", "arguments", "word"),
    [
        ("glProgramStringARB", (t.FRAGMENT_PROGRAM_ARB, 0x8875, 3, b"END"), "programs"),
        ("glProgramLocalParameter4fvARB", (t.FRAGMENT_PROGRAM_ARB, 0, [0.0] * 4), "programs"),
        ("glCreateShader", (0x8B31,), "shaders"),
        ("glCreateShaderObjectARB", (0x8B31,), "shaders"),
        ("glUniform3fv", (0, 1, [0.0] * 3), "shaders"),
        ("glBeginFragmentShaderATI", (), "ATI_fragment_shader"),
    ],
)
def test_a_call_is_refused_by_its_name(name, arguments, word):
    gl = context()
    gl.call(name, arguments)
    ((sentence, count),) = counted(gl, "refused")
    assert sentence.startswith(name + ": ")
    assert word in sentence
    assert count == 1
    assert draw(gl) == 1


@pytest.mark.parametrize("capability", [t.VERTEX_PROGRAM_ARB, t.FRAGMENT_PROGRAM_ARB, 0x8920])
def test_a_draw_with_a_program_is_refused_and_the_next_one_is_not(capability):
    gl = context()
    gl.Enable(capability)
    assert draw(gl) == 0
    gl.Disable(capability)
    assert draw(gl) == 1
    assert [count for _, count in counted(gl, "refused")] == [1]


def test_a_draw_with_a_shader_is_refused_until_it_is_left():
    gl = context()
    gl.UseProgram(3)
    assert gl.GetIntegerv(0x8B8D) == 3
    assert draw(gl) == 0
    gl.UseProgramObjectARB(0)
    assert draw(gl) == 1
