"""docs/gl_questions.c asks what the probes say, and its answers are read."""

import re
import shutil
import subprocess
from itertools import count
from pathlib import Path

import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.effects.conformance.answers import QUESTIONS, read_answers
from fixedpipe.effects.conformance.rules import RULES
from fixedpipe.pipeline.enums import CombinerBias, CombinerScale, ComponentUsage, Mapping, Register
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.state import (
    AlphaPortion,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    RegisterCombiners,
    RGBPortion,
)
from tests.conformance.test_other_renderers import pixels_of
from tests.layers import ROOT

SOURCE = ROOT / "docs" / "gl_questions.c"
needs_compiler = pytest.mark.skipif(
    not (shutil.which("cc") and Path("/usr/include/GL/freeglut.h").exists()),
    reason="there is no C compiler with freeglut's headers",
)
HEAD = "# gl_questions 1: NVIDIA Corporation, GeForce 256, 1.2\n"

# A board that has the extension and writes down what it is told. It answers with the bytes 7, 8, 9 ...
BOARD = r"""
#define GL_GLEXT_PROTOTYPES
#include <GL/freeglut.h>
#include <GL/glext.h>
#include <stdio.h>
#include <string.h>
static int answers = 7;
static void input(GLenum s, GLenum p, GLenum v, GLenum i, GLenum m, GLenum u) {
    fprintf(stderr, "in %x %x %x %x %x %x\n", s, p, v, i, m, u);
}
static void output(GLenum s, GLenum p, GLenum ab, GLenum cd, GLenum sum, GLenum scale, GLenum bias,
                   GLboolean x, GLboolean y, GLboolean z) {
    fprintf(stderr, "out %x %x %x %x %x %x %x %x\n", s, p, ab, cd, sum, scale, bias, x | y | z);
}
static void last(GLenum v, GLenum i, GLenum m, GLenum u) {
    fprintf(stderr, "final %x %x %x %x\n", v, i, m, u);
}
static void integer(GLenum n, GLint v) { fprintf(stderr, "set %x %x\n", n, v); }
static void floats(GLenum n, const GLfloat *v) {
    fprintf(stderr, "constant %x %x\n", n, (int)(255.0f * v[0] + 0.5f));
}
GLUTproc glutGetProcAddress(const char *name) {
    if (!strcmp(name, "glCombinerInputNV")) return (GLUTproc)input;
    if (!strcmp(name, "glCombinerOutputNV")) return (GLUTproc)output;
    if (!strcmp(name, "glFinalCombinerInputNV")) return (GLUTproc)last;
    if (!strcmp(name, "glCombinerParameteriNV")) return (GLUTproc)integer;
    return (GLUTproc)floats;
}
void glutInit(int *a, char **b) { (void)a, (void)b; }
void glutInitDisplayMode(unsigned m) { (void)m; }
void glutInitWindowSize(int w, int h) { (void)w, (void)h; }
int glutCreateWindow(const char *t) { (void)t; return 1; }
void glGetIntegerv(GLenum n, GLint *v) { (void)n; *v = 8; }
const GLubyte *glGetString(GLenum n) {
    return (const GLubyte *)(n == GL_EXTENSIONS ? "GL_X GL_NV_register_combiners GL_Y" : "a board");
}
void glColor3ub(GLubyte r, GLubyte g, GLubyte b) { fprintf(stderr, "draw %x %x %x\n", r, g, b); }
void glReadPixels(GLint x, GLint y, GLsizei w, GLsizei h, GLenum f, GLenum t, GLvoid *v) {
    (void)x, (void)y, (void)w, (void)h, (void)f, (void)t;
    memset(v, answers++, 4);
}
void glEnable(GLenum n) { (void)n; }
void glDisable(GLenum n) { (void)n; }
void glClear(GLbitfield n) { (void)n; }
void glTexCoord2f(GLfloat s, GLfloat t) { (void)s, (void)t; }
void glRectf(GLfloat a, GLfloat b, GLfloat c, GLfloat d) { (void)a, (void)b, (void)c, (void)d; }
void glPixelStorei(GLenum n, GLint v) { (void)n, (void)v; }
void glTexParameteri(GLenum t, GLenum n, GLint v) { (void)t, (void)n, (void)v; }
void glTexParameterfv(GLenum t, GLenum n, const GLfloat *v) { (void)t, (void)n, (void)v; }
void glTexEnvi(GLenum t, GLenum n, GLint v) { (void)t, (void)n, (void)v; }
void glTexImage2D(GLenum t, GLint l, GLint f, GLsizei w, GLsizei h, GLint b, GLenum g, GLenum y,
                  const GLvoid *p) {
    (void)t, (void)l, (void)f, (void)w, (void)h, (void)b, (void)g, (void)y, (void)p;
}
GLenum glGetError(void) { return GL_NO_ERROR; }
"""

# OpenGL's numbers (glext.h).
REGISTERS = {
    0: Register.ZERO,
    0x852A: Register.CONSTANT_COLOR0,
    0x852B: Register.CONSTANT_COLOR1,
    0x852C: Register.PRIMARY_COLOR,
    0x852E: Register.SPARE0,
    0x8530: Register.DISCARD,
}
MAPPINGS = {
    0x8536: Mapping.UNSIGNED_IDENTITY,
    0x8537: Mapping.UNSIGNED_INVERT,
    0x8538: Mapping.EXPAND_NORMAL,
    0x853A: Mapping.HALF_BIAS_NORMAL,
    0x853C: Mapping.SIGNED_IDENTITY,
    0x853D: Mapping.SIGNED_NEGATE,
}
SCALES = {0: CombinerScale.NONE, 0x853E: CombinerScale.SCALE_BY_TWO, 0x853F: CombinerScale.SCALE_BY_FOUR}
BIASES = {0: CombinerBias.NONE, 0x8541: CombinerBias.BIAS_BY_NEGATIVE_ONE_HALF}
USAGES = {0x1907: ComponentUsage.RGB, 0x1906: ComponentUsage.ALPHA, 0x1905: ComponentUsage.BLUE}
RGB, NUMBER = 0x1907, 0x854E


def programs_of(log):
    """(RegisterCombiners, primary colour) of every polygon that a log's calls draw."""
    inputs, outputs, final, constants, settings = {}, {}, {}, {}, {}
    for line in log.splitlines():
        kind, *words = line.split()
        numbers = [int(word, 16) for word in words]
        if kind == "in":
            stage, portion, variable, register, mapping, usage = numbers
            given = CombinerInput(REGISTERS[register], MAPPINGS[mapping], USAGES[usage])
            inputs[stage - 0x8550, portion, variable - 0x8523] = given
        elif kind == "out":
            stage, portion, ab, cd, total, scale, bias, flags = numbers
            assert flags == 0
            names = {"ab_output": ab, "cd_output": cd, "sum_output": total}
            outputs[stage - 0x8550, portion] = {name: REGISTERS[n] for name, n in names.items()}
            outputs[stage - 0x8550, portion] |= {"scale": SCALES[scale], "bias": BIASES[bias]}
        elif kind == "final":
            variable, register, mapping, usage = numbers
            final["abcdefg"[variable - 0x8523]] = CombinerInput(
                REGISTERS[register], MAPPINGS[mapping], USAGES[usage]
            )
        elif kind == "constant":
            constants[numbers[0] - 0x852A] = (numbers[1] / 255,) * 4
        elif kind == "set":
            settings[numbers[0]] = numbers[1]
        else:
            assert kind == "draw"
            if settings:
                general = []
                for stage in range(settings[NUMBER]):
                    four = [[inputs[stage, portion, k] for k in range(4)] for portion in (RGB, 0x1906)]
                    rgb = RGBPortion(*four[0], **outputs[stage, RGB])
                    general.append(GeneralCombiner(rgb, AlphaPortion(*four[1], **outputs[stage, 0x1906])))
                yield (
                    RegisterCombiners(
                        tuple(general),
                        FinalCombiner(**final),
                        constants[0],
                        constants[1],
                        color_sum_clamp=False,
                    ),
                    numbers[0],
                )


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """What the program prints and calls on a board that writes down what it is told."""
    folder = tmp_path_factory.mktemp("questions")
    (folder / "board.c").write_text(BOARD)
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror"]
    command = ["cc", *options, "-o", folder / "questions", SOURCE, folder / "board.c"]
    subprocess.run(command, check=True)
    return subprocess.run([folder / "questions"], capture_output=True, text=True, check=True)


@needs_compiler
def test_the_program_asks_every_question_once_and_prints_the_pixels(asked):
    board, answers = read_answers(asked.stdout, "it")
    assert board == "a board, a board, a board"
    assert [a.name for a in answers] == list(QUESTIONS)
    assert [a.byte for a in answers] == [byte for byte, _ in zip(count(7), QUESTIONS, strict=False)]


def inputs_of(combiners):
    """Registers and mappings of the colours' first inputs, where they are not zero."""
    first = [stage.rgb.a for stage in combiners.general]
    return [(a.register, a.mapping) if a.register != Register.ZERO else None for a in first]


@needs_compiler
def test_the_program_s_polygons_are_the_probes(asked):
    found = list(programs_of(asked.stderr))[: len(QUESTIONS) - 1]
    assert len(found) == 8
    for (name, question), (combiners, primary) in zip(QUESTIONS.items(), found, strict=False):
        assert primary == RULES[name].probe.primary
        assert pixels_of(combiners, primary, GEFORCE_256) == [question.byte] * 3, name
        rival = RULES[name].changed
        if rival is not None:
            assert pixels_of(combiners, primary, rival) == [question.rivals[0]] * 3, name
        if name not in ("final-lerp", "final-words-zero"):
            own = parse_program(RULES[name].probe.text).combiners
            assert inputs_of(own) == inputs_of(combiners), name


def answered(text, *options):
    return CliRunner().invoke(main, ["conformance", "--answers", "-", *options], input=text)


def test_the_answers_say_which_facts_stand(tmp_path):
    out = tmp_path / "answers.json"
    said = answered(
        HEAD
        + "expand-half 145\nclamp-low 4\nhalf-bias 91\nfinal-lerp not asked: it is tired\nborder-color 102\n",
        "--json",
        str(out),
    )
    assert said.exit_code == 0, said.output
    lines = said.stdout.splitlines()
    assert lines[0] == "NVIDIA Corporation, GeForce 256, 1.2"
    assert re.fullmatch(r"expand-half +145 +otherwise: 127.5: .*; as it stands: 128: .*", lines[1])
    assert re.fullmatch(r"clamp-low +4 +stands: -256", lines[2])
    assert re.fullmatch(r"half-bias +91 +neither: 88 as it stands, 90 or 92 otherwise", lines[3])
    assert lines[4].endswith("not asked: it is tired") and "as it is given" in lines[5]
    assert lines[6] == "4 of 5 questions were asked: 1 as it stands, 2 otherwise, 1 neither."
    assert '"verdict": "neither"' in out.read_text()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no output of gl_questions"),
        ("expand-half 144\n", "no output of gl_questions"),
        (HEAD.replace(" 1:", " 2:") + "expand-half 144\n", "reads format 1"),
        (HEAD, "has no answers"),
        (HEAD + "expand-half 256\n", "line 2, is no answer"),
        (HEAD + "expand-half\n", "line 2, is no answer"),
        (HEAD + "expand-haf 1\n", "Did you mean expand-half?"),
        (HEAD + "expand-half 1\n\nexpand-half 2\n", "twice"),
        (HEAD + "x" * 200_000, "no output of gl_questions"),
    ],
)
def test_what_is_no_output_ends_in_a_sentence(text, said):
    refused = answered(text)
    assert refused.exit_code == 2 and said in refused.stderr, refused.output


def test_answers_are_read_alone(tmp_path):
    assert "leave FOLDER out" in answered(HEAD, str(tmp_path)).stderr
    refused = answered(HEAD + "clamp-low 4\n", "--explain")
    assert refused.exit_code == 2 and "leave --explain out" in refused.stderr
