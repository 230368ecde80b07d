"""ARB_vertex_program: what a program makes of vertices is drawn; what it reads, what it writes, errors."""

import re

import numpy as np
import pytest

from fixedpipe.pipeline.opengl import Context
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.opengl.arb_program_text import assembled
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, OPENGL_1_2
from tests.pipeline.opengl.drawn import counted
from tests.pipeline.opengl.test_vertex_program_draws import (
    COLORS,
    CORNERS,
    SIZE,
    assert_as_the_fixed_functions,
    colored,
    picture,
    triangle,
    viewed,
)

VERTEX = T.VERTEX_PROGRAM_ARB
BLUISH = (51, 102, 153)
COLOR = (0.2, 0.4, 0.6, 1.0)
POSITION = "".join(
    f"DP4 result.position.{c}, state.matrix.mvp.row[{n}], vertex.position;" for n, c in enumerate("xyzw")
)
PLAIN = f"""!!ARBvp1.0  # a comment; with a semicolon
{POSITION}
MOV result.color, vertex.color;
MOV result.texcoord[0], vertex.texcoord;
END"""


def load(gl, text, name=5):
    gl.BindProgramARB(VERTEX, name)
    gl.ProgramStringARB(VERTEX, T.PROGRAM_FORMAT_ASCII_ARB, len(text), text.encode())
    gl.Enable(VERTEX)


def of_color(statements, *calls):
    """The colour that a program's statements write to result.color, as bytes."""
    gl = Context(GEFORCE_256, *SIZE)
    for call, *arguments in calls:
        getattr(gl, call)(*arguments)
    load(gl, f"!!ARBvp1.0 {statements} MOV result.position, vertex.position; END")
    assert counted(gl, "error") == []
    return colored(gl)


@pytest.mark.parametrize("profile", [OPENGL_1_2, GEFORCE_256, GEFORCE_3], ids=lambda profile: profile.name)
def test_a_program_that_does_as_the_fixed_functions_draws_the_same(profile):
    assert_as_the_fixed_functions(profile, lambda gl: load(gl, PLAIN))


@pytest.mark.parametrize("profile", [OPENGL_1_2, GEFORCE_256, GEFORCE_3], ids=lambda profile: profile.name)
def test_a_program_that_keeps_the_position_covers_the_fixed_functions_pixels_bit_for_bit(profile):
    fixed = viewed(profile)
    triangle(fixed)
    gl = viewed(profile)
    load(gl, "!!ARBvp1.0 OPTION ARB_position_invariant; MOV result.color, vertex.color; END")
    triangle(gl)
    np.testing.assert_array_equal(picture(gl), picture(fixed))
    load(gl, PLAIN, 6)  # another program computes it again
    assert gl.state().vertex.projection != fixed.state().vertex.projection


def test_attributes_by_number_are_the_conventional_ones():
    gl = viewed()
    load(gl, PLAIN.replace("vertex.color", "vertex.attrib[3]").replace("vertex.position", "vertex.attrib[0]"))
    triangle(gl)
    other = viewed()
    load(other, PLAIN)
    other.EnableVertexAttribArrayARB(0)
    other.EnableVertexAttribArrayARB(3)
    other.VertexAttribPointerARB(0, 3, T.FLOAT, False, 0, np.array(CORNERS, np.float32))
    other.VertexAttribPointerARB(3, 3, T.FLOAT, False, 0, np.array(COLORS, np.float32))
    other.DrawArrays(T.TRIANGLES, 0, 3)
    np.testing.assert_array_equal(picture(gl), picture(other))


@pytest.mark.parametrize(
    ("statement", "color"),
    [
        ("MOV result.color, {1, 0, 0.2};", (255, 0, 51)),
        ("MOV result.color, 0.4;", (102, 102, 102)),
        ("PARAM a = {0.2, 0.4, 0.6, 1}; MOV result.color, a.zyxw;", (153, 102, 51)),
        ("PARAM a = {0.2, 0.4, 0.6, 1}; MOV result.color, a.y;", (102, 102, 102)),
        ("PARAM a = {0.2, 0.4, 0.6, 1}; MOV result.color, -a; MAD result.color.xz, a, 2, -a;", (51, 0, 153)),
        ("PARAM a = {0.2, 0.4, 0.6, 1}; SUB result.color, 1, a;", (204, 153, 102)),
        ("PARAM a = {-0.2, 0.4, -0.6, 1}; ABS result.color, a;", BLUISH),
        ("PARAM a = {-0.2, 0.4, -0.6, 1}; ABS result.color, -a;", BLUISH),
        ("PARAM a = {-0.8, 1.4, 3.6, 1}; FRC result.color, a;", BLUISH),
        ("PARAM a = {-0.8, 1.4, 3.6, 1}; TEMP t; FLR t, a; MUL result.color, t, {-0.2, 0.4, 0.2};", BLUISH),
        ("TEMP t; MOV t, {-0.8, 1.4, 3.6, 1}; FLR t, t; MUL result.color, t, {-0.2, 0.4, 0.2};", BLUISH),
        ("TEMP t; EX2 t, {-1}.x; MUL result.color, t, {0.4, 0.8, 2};", (51, 102, 255)),
        ("TEMP t; LG2 t, 4; MUL result.color, t, {0.1, 0.2, 0.3};", BLUISH),
        ("TEMP t; POW t, 0.5, 2; MUL result.color, t.w, {0.8, 1.6, 2.4};", BLUISH),
        ("XPD result.color, {0, 0.2, 1}, {1, 0, 0};", (0, 255, 0)),
        ("TEMP t; MOV t, {0.2, 1, 0}; XPD t, t, {0, 0, 0.6}; MOV result.color, t;", (153, 0, 0)),
        ("XPD result.color, {1, 0, 0}, {0, 0.8, 0};", (0, 0, 204)),
        ("PARAM a = {0.2, 0.4, 0.6, 1}; SWZ result.color, a, 1, 0, -z, w; ADD result.color.z, a.z, 0;",
         (255, 0, 153)),
        ("PARAM a = {-0.2, 0.4, 0.6, 1}; SWZ result.color, a, -x, y, 1, w;", (51, 102, 255)),
        ("DPH result.color, {1, 1, 1, 9}, {0.1, 0.1, 0.1, 0.1};", (102, 102, 102)),
        ("PARAM a[] = {{0.2, 0, 0}, {0, 0.4, 0}, {0, 0, 0.6}}; ADDRESS n; ARL n.x, 1.5; "
         "ADD result.color, a[n.x], a[n.x + 1];", (0, 102, 153)),
        ("PARAM a[2] = {program.env[3..4]}; ADD result.color, a[0], a[1];", (51, 102, 0)),
        ("MOV result.color, program.local[7];", (153, 51, 255)),
        ("ATTRIB c = vertex.color; OUTPUT o = result.color; ALIAS p = o; MOV p, c.wyxw;", (255, 102, 51)),
        ("MOV result.color.front.primary, vertex.color;", BLUISH),
        ("RCP result.color, 5;", (51, 51, 51)),
        ("RSQ result.color, {-25}.x;", (51, 51, 51)),
        ("SGE result.color, {1, 2, 3}, 2;", (0, 255, 255)),
        ("DST result.color, {0, 0.4, 0.6}, {0, 1, 9, 0.5};", (255, 102, 153)),
    ],
)  # fmt: skip
def test_what_instructions_make(statement, color):
    calls = (
        ("Color3f", 0.2, 0.4, 0.6),
        ("ProgramEnvParameter4fARB", VERTEX, 3, 0.2, 0.0, 0.0, 1.0),
        ("ProgramEnvParameter4dvARB", VERTEX, 4, [0.0, 0.4, 0.0, 1.0]),
        ("BindProgramARB", VERTEX, 5),
        ("ProgramLocalParameter4fvARB", VERTEX, 7, [0.6, 0.2, 1.0, 1.0]),
    )
    assert of_color(statement, *calls) == list(color)


@pytest.mark.parametrize(
    ("binding", "calls", "color"),
    [
        ("material.diffuse", [("Materialfv", T.FRONT, T.DIFFUSE, COLOR)], BLUISH),
        ("material.back.emission", [("Materialfv", T.BACK, T.EMISSION, COLOR)], BLUISH),
        ("material.shininess", [("Materialf", T.FRONT, T.SHININESS, 1.0)], (255, 0, 0)),
        ("light[1].specular", [("Lightfv", T.LIGHT0 + 1, T.SPECULAR, COLOR)], BLUISH),
        ("light[0].position", [("Translatef", 0.2, 0.4, 0.0),
                               ("Lightfv", T.LIGHT0, T.POSITION, (0.0, 0.0, 0.6, 1.0))], BLUISH),
        ("light[0].half", [("Lightfv", T.LIGHT0, T.POSITION, (1.0, 0.0, 0.0, 0.0))], (180, 0, 180)),
        ("light[0].attenuation", [("Lightf", T.LIGHT0, T.LINEAR_ATTENUATION, 0.4)], (255, 102, 0)),
        ("light[0].spot.direction", [("Lightfv", T.LIGHT0, T.SPOT_DIRECTION, (0.2, 0.4, 0.6))], BLUISH),
        ("lightmodel.ambient", [("LightModelfv", T.LIGHT_MODEL_AMBIENT, COLOR)], BLUISH),
        ("lightmodel.scenecolor", [("LightModelfv", T.LIGHT_MODEL_AMBIENT, (1.0, 1.0, 0.0, 1.0)),
                                   ("Materialfv", T.FRONT, T.EMISSION, (0.0, 0.0, 0.6, 1.0))], (51, 51, 153)),
        ("lightprod[0].diffuse", [("Lightfv", T.LIGHT0, T.DIFFUSE, (0.5, 1.0, 0.0, 1.0))], (102, 204, 0)),
        ("texgen[0].object.s", [("TexGenfv", T.S, T.OBJECT_PLANE, COLOR)], BLUISH),
        ("texgen.eye.q", [("TexGenfv", T.Q, T.EYE_PLANE, COLOR)], BLUISH),
        ("fog.color", [("Fogfv", T.FOG_COLOR, COLOR)], BLUISH),
        ("fog.params", [("Fogf", T.FOG_START, 0.4), ("Fogf", T.FOG_END, 0.6)], (255, 102, 153)),
        ("clip[2].plane", [("ClipPlane", T.CLIP_PLANE0 + 2, (0.2, 0.4, 0.6, 0.0))], BLUISH),
        ("point.attenuation", [("PointParameterfv", T.POINT_DISTANCE_ATTENUATION, (0.2, 0.4, 0.6))], BLUISH),
        ("matrix.projection.row[1]", [], (0, 255, 0)),
        ("matrix.modelview.transpose.row[3]", [("Translatef", 0.2, 0.4, 0.6)], BLUISH),
        ("matrix.modelview.inverse.row[0]", [("Scalef", 2.0, 1.0, 1.0)], (128, 0, 0)),
        ("matrix.texture[1].invtrans.row[0]", [("ActiveTexture", T.TEXTURE0 + 1), ("MatrixMode", T.TEXTURE),
                                               ("Scalef", 5.0, 1.0, 1.0)], (51, 0, 0)),
    ],
)  # fmt: skip
def test_what_of_the_state_a_program_reads(binding, calls, color):
    assert of_color(f"MOV result.color, state.{binding};", *calls) == list(color)


def test_a_parameter_that_is_set_later_is_read_by_later_draws():
    gl = Context(GEFORCE_256, *SIZE)
    load(gl, "!!ARBvp1.0 MOV result.position, vertex.position; MOV result.color, program.local[0]; END")
    gl.ProgramLocalParameter4fARB(VERTEX, 0, 1.0, 0.0, 0.0, 1.0)
    assert colored(gl) == [255, 0, 0]
    gl.ProgramLocalParameter4fARB(VERTEX, 0, 0.0, 1.0, 0.0, 1.0)
    assert colored(gl) == [0, 255, 0]
    gl.DeleteProgramsARB(1, [5])
    gl.Rectf(-1.0, -1.0, 1.0, 1.0)
    assert "no text" in counted(gl, "refused")[0][0]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("!!VP1.0 END", "does not begin with !!ARBvp1.0"),
        ("!!ARBvp1.0 MOV result.color, vertex.color END", "no semicolon"),
        ("!!ARBvp1.0 MOV result.colour, vertex.color; END", "cannot be written"),
        ("!!ARBvp1.0 MOV result.color, vertex.colour; END", "cannot be read"),
        ("!!ARBvp1.0 MOV result.color, result.position; END", "cannot be read"),
        ("!!ARBvp1.0 MOV vertex.color, vertex.color; END", "cannot be written"),
        ("!!ARBvp1.0 MOVE result.color, vertex.color; END", "is no instruction"),
        ("!!ARBvp1.0 ADD result.color, vertex.color; END", "ADD takes 2"),
        ("!!ARBvp1.0 RCP result.color, vertex.color; END", "one component"),
        ("!!ARBvp1.0 TEMP a; TEMP a; END", "declared twice"),
        ("!!ARBvp1.0 TEMP a,b,c,d,e,f,g,h,i,j,k,l,m; END", "more than 12 temporaries"),
        ("!!ARBvp1.0 PARAM a = state.matrix.mvp; END", "has 4 rows"),
        ("!!ARBvp1.0 PARAM a[3] = {state.matrix.mvp}; END", "given 4 rows"),
        ("!!ARBvp1.0 PARAM a[] = {program.env[95..96]}; END", "not within 0 to 95"),
        ("!!ARBvp1.0 PARAM a = state.light[8].diffuse; END", "8 is not below 8"),
        ("!!ARBvp1.0 PARAM a = state.matrix.program[8].row[0]; END", "no such matrix"),
        ("!!ARBvp1.0 PARAM a = state.matrix.palette[0].row[0]; END", "not read here"),
        ("!!ARBvp1.0 PARAM a[] = {1, 2}; MOV result.color, a[2]; END", "beyond the array's 2 rows"),
        ("!!ARBvp1.0 PARAM a[] = {1, 2}; MOV result.color, a[b.x]; END", "b is no address register"),
        ("!!ARBvp1.0 OPTION NV_vertex_program2; END", "option NV_vertex_program2 is not known"),
        ("!!ARBvp1.0 OPTION ARB_position_invariant; MOV result.position, vertex.position; END", "forbids"),
        ("!!ARBvp1.0 SWZ result.color, vertex.color, x, y, z; END", "four of 0, 1"),
        ("!!ARBvp1.0 ALIAS a = b; END", "not declared"),
        ("!!ARBvp1.0 " + "MOV result.color, vertex.color; " * 129 + "END", "129 instructions; 128"),
        ("!!ARBvp1.0 PARAM a[] = {program.env[0..95], program.local[0..95]}; MOV result.color, {9}; END",
         "193 constants"),
    ],
)  # fmt: skip
def test_what_is_no_program_is_said(text, sentence):
    with pytest.raises(ValueError, match=re.escape(sentence)):
        assembled(text)
    gl = Context(GEFORCE_256, *SIZE)
    load(gl, text)
    assert counted(gl, "error")[0][0].endswith(gl_sentence(text))
    gl.Rectf(-1.0, -1.0, 1.0, 1.0)
    assert "no text" in counted(gl, "refused")[0][0]


def gl_sentence(text):
    try:
        assembled(text)
    except ValueError as error:
        return str(error)
    return None


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (("ProgramEnvParameter4fARB", VERTEX, 96, 0.0, 0.0, 0.0, 0.0), "error"),
        (("ProgramLocalParameter4fARB", VERTEX, -1, 0.0, 0.0, 0.0, 0.0), "error"),
        (("BindProgramARB", T.TEXTURE_2D, 1), "error"),
        (("DeleteProgramsARB", -1, [1]), "error"),
        (("ProgramStringARB", VERTEX, 0, 4, b"text"), "error"),
        (("ProgramStringARB", VERTEX, T.PROGRAM_FORMAT_ASCII_ARB, -4, b"text"), "error"),
        (("BindProgramARB", T.FRAGMENT_PROGRAM_ARB, 1), "refused"),
        (("ProgramStringARB", T.FRAGMENT_PROGRAM_ARB, T.PROGRAM_FORMAT_ASCII_ARB, 4, b"text"), "refused"),
        (("ProgramLocalParameter4fARB", T.FRAGMENT_PROGRAM_ARB, 0, 0.0, 0.0, 0.0, 0.0), "refused"),
    ],
)
def test_calls_that_are_ignored_or_refused(call, kind):
    gl = Context(GEFORCE_256, *SIZE)
    getattr(gl, call[0])(*call[1:])
    assert len(counted(gl, kind)) == 1


def test_a_matrix_without_inverse_is_refused_where_a_program_reads_it():
    gl = Context(GEFORCE_256, *SIZE)
    gl.Scalef(0.0, 1.0, 1.0)
    load(gl, "!!ARBvp1.0 MOV result.position, state.matrix.modelview.inverse.row[0]; END")
    gl.Rectf(-1.0, -1.0, 1.0, 1.0)
    assert "inverse" in counted(gl, "refused")[0][0]


def test_an_array_of_integers_has_the_fractions_of_its_conventional_one_or_is_refused():
    gl = Context(GEFORCE_256, *SIZE)
    gl.VertexAttribPointerARB(3, 4, T.UNSIGNED_BYTE, True, 0, bytes(12))
    gl.VertexAttribPointerARB(0, 2, T.SHORT, False, 0, bytes(12))
    assert counted(gl, "refused") == []
    gl.VertexAttribPointerARB(3, 4, T.UNSIGNED_BYTE, False, 0, bytes(12))
    gl.VertexAttribPointerARB(0, 2, T.SHORT, True, 0, bytes(12))
    assert len(counted(gl, "refused")) == 2
    gl.EnableVertexAttribArrayARB(3)
    gl.DisableVertexAttribArrayARB(3)
    assert not gl.IsEnabled(T.COLOR_ARRAY)


def test_programs_are_forgotten_and_found():
    gl = Context(GEFORCE_256, *SIZE)
    gl.GetProgramivARB(VERTEX, T.PROGRAM_FORMAT_ARB, None)
    assert counted(gl, "refused") == []
    load(gl, PLAIN)
    assert gl.IsProgramARB(5)
    gl.DeleteProgramsARB(1, [5])
    assert not gl.IsProgramARB(5)
