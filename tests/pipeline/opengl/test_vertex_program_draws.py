"""NV_vertex_program: what a program makes of vertices is drawn; parameters, matrices, attributes, errors."""

import numpy as np
import pytest

from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import Context
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.opengl.matrices import top
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, OPENGL_1_2
from tests.pipeline.opengl.drawn import counted

CORNERS = ((-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (0.0, 1.0, 0.5))
COLORS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.2, 0.4, 1.0))
POSITION = "".join(f"DP4 o[HPOS].{c}, c[{n}], v[OPOS];" for n, c in enumerate("xyzw"))
PLAIN = f"!!VP1.0 # a comment\n {POSITION} MOV o[COL0], v[COL0]; MOV o[TEX0], v[TEX0]; END"
SIZE = (48, 40)


def load(gl, text, name=5):
    gl.LoadProgramNV(T.VERTEX_PROGRAM_NV, name, len(text), text.encode())
    gl.BindProgramNV(T.VERTEX_PROGRAM_NV, name)
    gl.Enable(T.VERTEX_PROGRAM_NV)


def viewed(profile=GEFORCE_256):
    gl = Context(profile, *SIZE)
    gl.MatrixMode(T.PROJECTION)
    gl.Frustum(-1.0, 1.0, -1.0, 1.0, 1.0, 10.0)
    gl.MatrixMode(T.MODELVIEW)
    gl.Translatef(0.1, 0.0, -1.5)
    gl.Rotatef(30.0, 0.2, 1.0, 0.0)
    return gl


def triangle(gl):
    gl.Begin(T.TRIANGLES)
    for color, corner in zip(COLORS, CORNERS, strict=True):
        gl.Color3f(*color)
        gl.Vertex3f(*corner)
    gl.End()


def picture(gl):
    return Machine(gl.profile, *SIZE).run(gl.take_commands()).image()


def assert_as_the_fixed_functions(profile, load_program):
    """A program that does what the fixed functions do draws their picture, but for roundings."""
    fixed = viewed(profile)
    triangle(fixed)
    gl = viewed(profile)
    load_program(gl)
    triangle(gl)
    ours, theirs = picture(gl).astype(int), picture(fixed).astype(int)
    assert (theirs[..., :3].any(axis=-1)).any()
    # The interpreter has 24 bits where the machine has more: a colour may round to its neighbour.
    assert np.abs(ours - theirs).max() <= 1
    assert counted(gl, "lit here") == [("glEnd: its vertices go through a vertex program", 1)]


def load_plain(gl):
    load(gl, PLAIN)
    gl.TrackMatrixNV(T.VERTEX_PROGRAM_NV, 0, T.MODELVIEW_PROJECTION_NV, T.IDENTITY_NV)


def test_program_matrices_are_stacks_of_their_own():
    gl = viewed()
    load(gl, PLAIN)
    position = top(gl, "modelview")
    gl.MatrixMode(T.MATRIX0_NV + 3)
    gl.MultMatrixf([column for row in zip(*top(gl, "projection"), strict=True) for column in row])
    gl.PushMatrix()
    gl.MultMatrixf([column for row in zip(*position, strict=True) for column in row])
    gl.TrackMatrixNV(T.VERTEX_PROGRAM_NV, 0, T.MATRIX0_NV + 3, T.IDENTITY_NV)
    triangle(gl)
    ours = picture(gl)
    other = viewed()
    load_plain(other)
    triangle(other)
    assert ours[..., :3].any() and (ours == picture(other)).all()
    gl.PopMatrix()
    assert top(gl, ("program matrix", 3)) == top(gl, "projection") and top(gl, "modelview") == position


def load_invariant(gl):
    text = "!!VP1.1 OPTION NV_position_invariant; MOV o[COL0], v[COL0]; MOV o[TEX0], v[TEX0]; END"
    load(gl, text)


@pytest.mark.parametrize("profile", [OPENGL_1_2, GEFORCE_256, GEFORCE_3], ids=lambda profile: profile.name)
@pytest.mark.parametrize("load_program", [load_plain, load_invariant])
def test_a_program_that_does_as_the_fixed_functions_draws_the_same(profile, load_program):
    assert_as_the_fixed_functions(profile, load_program)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("!!VP1.1 OPTION NV_position_invariant; MOV o[HPOS], v[OPOS]; END", "forbids to write o[HPOS]"),
        ("!!VP1.0 OPTION NV_position_invariant; MOV o[COL0], v[COL0]; END", "is no instruction"),
        ("!!VP1.0 SUB o[COL0], v[COL0], v[COL0]; END", "is no instruction"),
    ],
)
def test_what_version_1_0_lacks_and_the_option_forbids(text, sentence):
    gl = viewed()
    load(gl, text)
    ((said, _),) = counted(gl, "error")
    assert sentence in said


@pytest.mark.parametrize(
    ("statements", "color"),
    [
        ("SUB o[COL0], c[0], v[COL1];", [153, 51, 0]),
        ("SUB o[COL0], c[0], -v[COL1];", [255, 255, 255]),
        ("ABS o[COL0], -v[COL1];", [51, 102, 153]),
    ],
)
def test_instructions_of_version_1_1(statements, color):
    gl = Context(GEFORCE_256, *SIZE)
    load(gl, f"!!VP1.1 # SUB; ABS\n MOV o[HPOS], v[OPOS]; {statements} END")
    gl.ProgramParameter4fNV(T.VERTEX_PROGRAM_NV, 0, 0.8, 0.6, 0.6, 1.0)
    gl.VertexAttrib3fNV(4, 0.2, 0.4, 0.6)
    assert colored(gl) == color


def test_a_programs_secondary_colour_is_added_where_lighting_is_enabled_too():
    gl = Context(GEFORCE_256, *SIZE)
    load(gl, "!!VP1.0 MOV o[HPOS], v[OPOS]; MOV o[COL0], c[0]; MOV o[COL1], v[COL1]; END")
    gl.VertexAttrib3fNV(4, 0.2, 0.4, 0.6)
    gl.Enable(T.LIGHTING)
    gl.Enable(T.COLOR_SUM)
    assert colored(gl) == [51, 102, 153]


def test_edge_flags_go_past_programs():
    made = []
    for programmed in (False, True):
        gl = Context(GEFORCE_256, *SIZE)
        if programmed:
            load(gl, "!!VP1.0 MOV o[HPOS], v[OPOS]; MOV o[COL0], v[COL0]; END")
        gl.PolygonMode(T.FRONT_AND_BACK, T.LINE)
        gl.Begin(T.TRIANGLES)
        for flag, corner in zip((True, False, True), CORNERS, strict=True):
            gl.EdgeFlag(flag)
            gl.Vertex3f(0.9 * corner[0], 0.9 * corner[1], 0.0)
        gl.End()
        made.append(picture(gl))
    assert made[0][..., :3].any() and (made[0] == made[1]).all()


def test_arrays_lists_and_immediate_mode_draw_the_same():
    made = []
    for way in ("immediate", "arrays", "attributes", "list"):
        gl = viewed()
        load(gl, PLAIN)
        gl.TrackMatrixNV(T.VERTEX_PROGRAM_NV, 0, T.MODELVIEW_PROJECTION_NV, T.IDENTITY_NV)
        if way == "arrays":
            gl.EnableClientState(T.VERTEX_ARRAY)
            gl.EnableClientState(T.COLOR_ARRAY)
            gl.VertexPointer(3, T.FLOAT, 0, np.array(CORNERS, np.float32))
            gl.ColorPointer(3, T.FLOAT, 0, np.array(COLORS, np.float32))
            gl.DrawArrays(T.TRIANGLES, 0, 3)
        elif way == "attributes":
            for number, values in ((0, CORNERS), (3, COLORS)):
                gl.EnableClientState(T.VERTEX_ATTRIB_ARRAY0_NV + number)
                gl.VertexAttribPointerNV(number, 3, T.FLOAT, 0, np.array(values, np.float32))
            gl.DrawArrays(T.TRIANGLES, 0, 3)
        elif way == "list":
            gl.NewList(1, T.COMPILE)
            triangle(gl)
            gl.EndList()
            gl.CallList(1)
        else:
            triangle(gl)
        made.append(picture(gl))
    assert made[0][..., :3].any()
    assert all((made[0] == other).all() for other in made[1:])


def colored(gl):
    """The colour in the middle of a rectangle of the whole window."""
    gl.Rectf(-1.0, -1.0, 1.0, 1.0)
    return picture(gl)[SIZE[1] // 2, SIZE[0] // 2, :3].tolist()


def of_color(source, *, parameters=()):
    gl = Context(GEFORCE_256, *SIZE)
    load(gl, f"!!VP1.0 MOV o[HPOS], v[OPOS]; MOV o[COL0], {source}; END")
    for call, *arguments in parameters:
        getattr(gl, call)(*arguments)
    return colored(gl)


@pytest.mark.parametrize(
    ("source", "parameters", "color"),
    [
        ("c[7]", [("ProgramParameter4fNV", T.VERTEX_PROGRAM_NV, 7, 1.0, 0.0, 0.2, 1.0)], [255, 0, 51]),
        ("c[7].wzyx", [("ProgramParameter4dvNV", T.VERTEX_PROGRAM_NV, 7, [1, 0, 0.2, 0.4])], [102, 51, 0]),
        (
            "c[9]",
            [("ProgramParameters4fvNV", T.VERTEX_PROGRAM_NV, 8, 2, [9.0] * 4 + [0.6, 0.2, 1.0, 0.0])],
            [153, 51, 255],
        ),
        ("v[COL1]", [("VertexAttrib3fNV", 4, 0.2, 0.4, 0.6)], [51, 102, 153]),
        ("v[6]", [("VertexAttrib4ubNV", 6, 255, 51, 0, 255)], [255, 51, 0]),
        ("v[9]", [("VertexAttribs3fvNV", 8, 2, [9.0, 9.0, 9.0, 0.4, 0.2, 0.0])], [102, 51, 0]),
        ("v[TEX1]", [("MultiTexCoord3f", T.TEXTURE1, 0.2, 0.4, 0.6)], [51, 102, 153]),
        ("v[NRML]", [("VertexAttrib3sNV", 2, 1, 0, 1)], [255, 0, 255]),
        ("c[1]", [("TrackMatrixNV", T.VERTEX_PROGRAM_NV, 0, T.MODELVIEW, T.TRANSPOSE_NV)], [0, 255, 0]),
        ("c[0]", [("LoadMatrixf", [2.0, *[0.0] * 4, 1.0, *[0.0] * 4, 1.0, *[0.0] * 4, 1.0]),
                  ("TrackMatrixNV", T.VERTEX_PROGRAM_NV, 0, T.MODELVIEW, T.INVERSE_NV)], [128, 0, 0]),
    ],
)  # fmt: skip
def test_what_a_program_reads(source, parameters, color):
    assert of_color(source, parameters=parameters) == color


def test_fog_and_texture_coordinates_are_the_programs():
    gl = Context(GEFORCE_256, *SIZE)
    gl.Enable(T.FOG)
    gl.Fogi(T.FOG_MODE, T.LINEAR)
    gl.Fogfv(T.FOG_COLOR, (1.0, 0.0, 0.0, 1.0))
    gl.ProgramParameter4fNV(T.VERTEX_PROGRAM_NV, 0, 1.0, 0.0, 1.0, 1.0)
    load(gl, "!!VP1.0 MOV o[HPOS], v[OPOS]; MOV o[COL0], v[COL0]; MOV o[FOGC].x, c[0].x; END")
    assert colored(gl) == [255, 0, 0]  # the end of fog
    gl.Disable(T.FOG)
    gl.MatrixMode(T.TEXTURE)
    gl.Translatef(0.5, 0.0, 0.0)  # no program asks for it
    gl.Enable(T.TEXTURE_GEN_S)
    gl.Enable(T.TEXTURE_2D)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.NEAREST)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MAG_FILTER, T.NEAREST)
    gl.PixelStorei(T.UNPACK_ALIGNMENT, 1)
    gl.TexImage2D(T.TEXTURE_2D, 0, T.RGB, 2, 1, 0, T.RGB, T.UNSIGNED_BYTE, bytes([0, 255, 0, 0, 0, 255]))
    gl.ProgramParameter4fNV(T.VERTEX_PROGRAM_NV, 1, 0.25, 0.5, 0.0, 1.0)
    load(gl, "!!VP1.0 MOV o[HPOS], v[OPOS]; MOV o[COL0], v[COL0]; MOV o[TEX0], c[1]; END", 6)
    assert colored(gl) == [0, 255, 0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("MOV o[HPOS], v[OPOS];", "!!VP1.0"),
        ("!!VP1.0 JMP o[HPOS], v[OPOS]; END", "no instruction"),
        ("!!VP1.0 MOV o[HPOS], v[15]; END", "attribute 15"),
        ("!!VP1.0 MOV o[TEX4], v[OPOS]; END", "cannot be written"),
    ],
)
def test_a_text_that_is_no_program_is_an_error_and_its_draws_are_refused(text, words):
    gl = viewed()
    load(gl, text)
    ((sentence, _),) = counted(gl, "error")
    assert sentence.startswith("glLoadProgramNV: GL_INVALID_OPERATION, ") and words in sentence
    triangle(gl)
    ((sentence, _),) = counted(gl, "refused")
    assert "the bound program has no text" in sentence and not gl.take_commands()
    gl.Disable(T.VERTEX_PROGRAM_NV)
    triangle(gl)
    assert len(gl.take_commands()) == 1


@pytest.mark.parametrize(
    ("call", "arguments", "kind"),
    [
        ("ProgramParameter4fNV", (T.VERTEX_PROGRAM_NV, 96, 0.0, 0.0, 0.0, 0.0), "error"),
        ("ProgramParameter4fvNV", (T.TEXTURE_2D, 0, [0.0] * 4), "error"),
        ("TrackMatrixNV", (T.VERTEX_PROGRAM_NV, 2, T.MODELVIEW, T.IDENTITY_NV), "error"),
        ("TrackMatrixNV", (T.VERTEX_PROGRAM_NV, 0, T.MATRIX0_NV + 8, T.IDENTITY_NV), "refused"),
        ("VertexAttrib3fNV", (1, 0.2, 0.4, 0.6), "refused"),
        ("VertexAttrib2fNV", (5, 0.2, 0.4), "refused"),
        ("VertexAttrib1fNV", (16, 0.0), "error"),
        ("VertexAttribPointerNV", (17, 4, T.FLOAT, 0, None), "error"),
        ("VertexAttribPointerNV", (6, 4, T.FLOAT, 0, None), "refused"),
        ("VertexAttribPointerNV", (2, 4, T.FLOAT, 0, None), "refused"),
        ("LoadProgramNV", (T.VERTEX_STATE_PROGRAM_NV, 1, 3, b"END"), "refused"),
        ("LoadProgramNV", (T.VERTEX_PROGRAM_NV, 1, -3, b"END"), "error"),
    ],
)
def test_wrong_calls(call, arguments, kind):
    gl = viewed()
    getattr(gl, call)(*arguments)
    assert [count for _, count in counted(gl, kind)] == [1]


@pytest.mark.parametrize("capability", [T.VERTEX_PROGRAM_TWO_SIDE_NV, T.VERTEX_PROGRAM_POINT_SIZE_NV])
def test_what_is_not_drawn_is_refused_by_name(capability):
    gl = viewed()
    load(gl, PLAIN)
    gl.Enable(capability)
    triangle(gl)
    ((sentence, _),) = counted(gl, "refused")
    assert T.name_of(capability) in sentence


def test_programs_are_deleted():
    gl = viewed()
    load(gl, PLAIN)
    assert gl.IsProgramNV(5)
    gl.DeleteProgramsNV(1, [5])
    assert not gl.IsProgramNV(5) and gl.values["vertex program"] == 0


def test_distance_changes_no_size_of_a_programs_points():
    gl = Context(GEFORCE_3, *SIZE)
    gl.PointSize(8.0)
    gl.PointParameterfv(T.POINT_DISTANCE_ATTENUATION, [0.0, 0.0, 4.0])
    assert gl.state().point.parameters is not None
    load(gl, "!!VP1.0 MOV o[HPOS], v[OPOS]; MOV o[COL0], v[COL0]; END")
    gl.Begin(T.POINTS)
    gl.Vertex3f(0.0, 0.0, 0.0)
    gl.End()
    assert np.count_nonzero(picture(gl)[..., :3].any(axis=-1)) == 64
