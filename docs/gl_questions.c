/* Asks a real graphics board nine questions, one polygon each, and prints nine numbers. MIT licence.
 *
 *     cc gl_questions.c -o gl_questions -lglut -lGL        (Debian: freeglut3-dev)
 *     ./gl_questions > answers.txt
 *     fixedpipe conformance --answers answers.txt          says which facts stand
 *
 * Eight questions need register combiners: any GeForce with a driver that has GL_NV_register_combiners. The ninth needs
 * border colours. What the board lacks is said instead of a number. docs/silicon.md explains the questions. */
#define GL_GLEXT_PROTOTYPES
#include <GL/freeglut.h>
#include <GL/glext.h>
#include <stdio.h>
#include <string.h>

static PFNGLCOMBINERINPUTNVPROC combiner_input;
static PFNGLCOMBINEROUTPUTNVPROC combiner_output;
static PFNGLFINALCOMBINERINPUTNVPROC final_input;
static PFNGLCOMBINERPARAMETERINVPROC combiner_integer;
static PFNGLCOMBINERPARAMETERFVNVPROC combiner_floats;

static const GLenum STAGES[2] = {GL_COMBINER0_NV, GL_COMBINER1_NV};
static const GLenum VARIABLES[7] = {GL_VARIABLE_A_NV, GL_VARIABLE_B_NV, GL_VARIABLE_C_NV, GL_VARIABLE_D_NV,
                                    GL_VARIABLE_E_NV, GL_VARIABLE_F_NV, GL_VARIABLE_G_NV};

static int has(const char *name) {
    const char *all = (const char *)glGetString(GL_EXTENSIONS), *at = all;
    size_t length = strlen(name);
    while (all != NULL && (at = strstr(at, name)) != NULL) {
        if ((at == all || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0)) return 1;
        at += length;
    }
    return 0;
}

/* An input of a general combiner's colours: variable 0 to 3 is A to D. */
static void in(int stage, int variable, GLenum source, GLenum mapping) {
    combiner_input(STAGES[stage], GL_RGB, VARIABLES[variable], source, mapping, GL_RGB);
}

/* One in an input. */
static void one(int stage, int variable) {
    in(stage, variable, GL_ZERO, GL_UNSIGNED_INVERT_NV);
}

/* Where a general combiner's A B and A B + C D go. */
static void out(int stage, GLenum product, GLenum sum, GLenum scale, GLenum bias) {
    combiner_output(STAGES[stage], GL_RGB, product, GL_DISCARD_NV, sum, scale, bias, GL_FALSE, GL_FALSE, GL_FALSE);
}

static void constants(int first, int second) {
    GLfloat colors[2][4];
    for (int k = 0; k < 4; k++) colors[0][k] = (GLfloat)first / 255.0f, colors[1][k] = (GLfloat)second / 255.0f;
    combiner_floats(GL_CONSTANT_COLOR0_NV, colors[0]);
    combiner_floats(GL_CONSTANT_COLOR1_NV, colors[1]);
}

/* Every input zero, so that the final combiner's two words are 0; then what the first general combiner leaves. */
static void begin(int stages) {
    combiner_integer(GL_NUM_GENERAL_COMBINERS_NV, stages);
    combiner_integer(GL_COLOR_SUM_CLAMP_NV, GL_FALSE);
    for (int k = 0; k < 7; k++) {
        final_input(VARIABLES[k], GL_ZERO, GL_UNSIGNED_IDENTITY_NV, VARIABLES[k] == GL_VARIABLE_G_NV ? GL_BLUE : GL_RGB);
    }
    for (int stage = 0; stage < 2; stage++) {
        for (int k = 0; k < 4; k++) {
            in(stage, k, GL_ZERO, GL_UNSIGNED_IDENTITY_NV);
            combiner_input(STAGES[stage], GL_ALPHA, VARIABLES[k], GL_ZERO, GL_UNSIGNED_IDENTITY_NV, GL_ALPHA);
        }
        combiner_output(STAGES[stage], GL_ALPHA, GL_DISCARD_NV, GL_DISCARD_NV, GL_DISCARD_NV, GL_NONE, GL_NONE, GL_FALSE,
                        GL_FALSE, GL_FALSE);
    }
}

static void show(int variable, GLenum source) {
    final_input(VARIABLES[variable], source, GL_UNSIGNED_IDENTITY_NV, GL_RGB);
}

/* The question's program; returns the primary colour's bytes. */
static int program(int question) {
    const GLenum S = GL_SPARE0_NV, P = GL_PRIMARY_COLOR_NV, C = GL_CONSTANT_COLOR0_NV, D = GL_DISCARD_NV;
    const GLenum SIGNED = GL_SIGNED_IDENTITY_NV, NEGATE = GL_SIGNED_NEGATE_NV, FOUR = GL_SCALE_BY_FOUR_NV;
    begin(question == 3 || question == 5 ? 2 : 1);
    constants(question == 3 ? 255 : 1, 2);
    if (question < 6) show(3, S);
    switch (question) {
    case 0: in(0, 0, P, GL_EXPAND_NORMAL_NV), one(0, 1), out(0, S, D, GL_NONE, GL_NONE); return 200;
    case 1:
        in(0, 0, C, SIGNED), in(0, 1, P, SIGNED), in(0, 2, C, SIGNED), in(0, 3, P, SIGNED);
        out(0, D, S, GL_NONE, GL_NONE);
        return 100;
    case 2: in(0, 0, C, SIGNED), in(0, 1, P, SIGNED), out(0, S, D, FOUR, GL_NONE); return 100;
    case 3:
        out(0, S, D, GL_SCALE_BY_TWO_NV, GL_BIAS_BY_NEGATIVE_ONE_HALF_NV);
        in(1, 0, S, SIGNED), in(1, 1, C, NEGATE), in(1, 2, C, SIGNED), in(1, 3, C, NEGATE);
        out(1, D, S, FOUR, GL_NONE);
        return 0;
    case 4: in(0, 0, P, GL_HALF_BIAS_NORMAL_NV), one(0, 1), out(0, S, D, FOUR, GL_NONE); return 150;
    case 5:
        in(0, 0, C, SIGNED), in(0, 1, P, NEGATE), out(0, S, D, GL_NONE, GL_NONE);
        in(1, 0, S, NEGATE), one(1, 1), out(1, S, D, FOUR, GL_NONE);
        return 200;
    case 6: show(0, P), show(1, C), show(2, GL_CONSTANT_COLOR1_NV), out(0, D, S, GL_NONE, GL_NONE); return 100;
    default: in(0, 0, P, SIGNED), one(0, 1), out(0, S, D, GL_NONE, GL_NONE); return 100;
    }
}

static const char *NAMES[9] = {"expand-half", "product-rounding",  "round-before-scale", "clamp-low",   "half-bias",
                               "negative-products", "final-lerp", "final-words-zero", "border-color"};

/* Draws a polygon over the window; returns the green byte of a pixel in it. */
static int drawn(int primary) {
    GLubyte pixel[4] = {0, 0, 0, 0};
    glClear(GL_COLOR_BUFFER_BIT);
    glColor3ub((GLubyte)primary, (GLubyte)primary, (GLubyte)primary);
    glTexCoord2f(2.0f, 2.0f); /* beyond the texture: the border, everywhere */
    glRectf(-1.0f, -1.0f, 1.0f, 1.0f);
    glReadPixels(8, 8, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
    return pixel[1];
}

/* Whether a texture of luminance shows the green of its border's colour, or the red, as OpenGL says. */
static void border(void) {
    static const GLubyte texels[4] = {0, 0, 0, 0};
    static const GLfloat color[4] = {51.0f / 255.0f, 102.0f / 255.0f, 153.0f / 255.0f, 1.0f};
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_LUMINANCE8, 2, 2, 0, GL_LUMINANCE, GL_UNSIGNED_BYTE, texels);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, color);
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
    glEnable(GL_TEXTURE_2D);
}

int main(int argc, char **argv) {
    GLint bits = 0;
    glutInit(&argc, argv);
    glutInitDisplayMode(GLUT_RGBA | GLUT_DOUBLE);
    glutInitWindowSize(64, 64);
    glutCreateWindow("gl_questions");
    printf("# gl_questions 1: %s, %s, %s\n", glGetString(GL_VENDOR), glGetString(GL_RENDERER), glGetString(GL_VERSION));
    glGetIntegerv(GL_GREEN_BITS, &bits);
    if (bits != 8) {
        fprintf(stderr, "gl_questions: the window has %d bits of green; choose a display of 24 or 32 bits.\n", (int)bits);
        return 2;
    }
    glDisable(GL_DITHER);
    combiner_input = (PFNGLCOMBINERINPUTNVPROC)glutGetProcAddress("glCombinerInputNV");
    combiner_output = (PFNGLCOMBINEROUTPUTNVPROC)glutGetProcAddress("glCombinerOutputNV");
    final_input = (PFNGLFINALCOMBINERINPUTNVPROC)glutGetProcAddress("glFinalCombinerInputNV");
    combiner_integer = (PFNGLCOMBINERPARAMETERINVPROC)glutGetProcAddress("glCombinerParameteriNV");
    combiner_floats = (PFNGLCOMBINERPARAMETERFVNVPROC)glutGetProcAddress("glCombinerParameterfvNV");
    int asks = has("GL_NV_register_combiners") && combiner_input && combiner_output && final_input && combiner_integer;
    for (int question = 0; question < 8; question++) {
        if (!asks || !combiner_floats) {
            printf("%s not asked: the board has no GL_NV_register_combiners\n", NAMES[question]);
            continue;
        }
        int primary = program(question);
        glEnable(GL_REGISTER_COMBINERS_NV);
        printf("%s %d\n", NAMES[question], drawn(primary));
        glDisable(GL_REGISTER_COMBINERS_NV);
    }
    while (glGetError() != GL_NO_ERROR) continue;
    border();
    if (glGetError() == GL_NO_ERROR) printf("%s %d\n", NAMES[8], drawn(0));
    else printf("%s not asked: the board has no GL_CLAMP_TO_BORDER\n", NAMES[8]);
    return 0;
}
