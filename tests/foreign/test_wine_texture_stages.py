"""Texture stages as texture environments and as register combiners, and pixel shaders' constants. Source:
WineHQ, wine, dlls/d3d9/tests/visual.c, texop_test and constant_clamp_ps_test; dlls/d3d8/tests/visual.c,
test_texture_blending, test_texcoordindex and test_color_clamping.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline import (
    Draw,
    PassState,
    TexImage,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
    VertexState,
    environment,
    parse_program,
    texture_2d,
)
from fixedpipe.pipeline.enums import TextureEnvironmentMode, TextureShaderOperation, VertexStage
from fixedpipe.pipeline.state import IDENTITY, SignedComponents
from tests.foreign.comparison import Case, assert_drawn, assert_held, everywhere, on_machines, pixels
from tests.foreign.direct3d import POINT, argb, clear, draw, strip, texels

SIZE = 64, 48
KEEP = ("REPLACE", "PREVIOUS")
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
NONE = TextureEnvironment(TextureEnvironmentMode.NONE)
CORNERS = [[0, 0], [0, 1], [1, 0], [1, 1]]


def image(name, rows):
    return TexImage(label=f"texture {name}", texture=name, image=texture_2d(texels(rows)))


def middle(color, tolerance, alpha=False):
    return pixels([(32, 24, color, tolerance)], alpha)


# texop_test: D3DTA_TEXTURE is 9900ff00, D3DTA_TFACTOR dd333333, D3DTA_DIFFUSE 55ff0000, the third argument.
# By operation: the picture, the environment (of COMBINE4: four arguments), its scale, and a combiner.
OPERATIONS = {
    "SELECTARG1": (0x00FF00, "REPLACE, TEXTURE", 1, "spare0 = tex0;"),
    "SELECTARG2": (0x333333, "REPLACE, CONSTANT", 1, "spare0 = const0;"),
    "MODULATE": (0x003300, "MODULATE, TEXTURE, CONSTANT", 1, "spare0 = tex0 * const0;"),
    "MODULATE2X": (0x006600, "MODULATE, TEXTURE, CONSTANT", 2, "spare0 = tex0 * const0; scale_by_two();"),
    "MODULATE4X": (0x00CC00, "MODULATE, TEXTURE, CONSTANT", 4, "spare0 = tex0 * const0; scale_by_four();"),
    "ADD": (0x33FF33, "ADD, TEXTURE, CONSTANT", 1, "discard = tex0; discard = const0; spare0 = sum();"),
    "ADDSIGNED": (
        0x00B200,
        "ADD_SIGNED, TEXTURE, CONSTANT",
        1,
        "discard = tex0; discard = const0; spare0 = sum(); bias_by_negative_one_half();",
    ),
    "ADDSIGNED2X": (
        0x00FF00,
        "ADD_SIGNED, TEXTURE, CONSTANT",
        2,
        "discard = tex0; discard = const0; spare0 = sum(); bias_by_negative_one_half_scale_by_two();",
    ),
    "SUBTRACT": (
        0x00CC00,
        "SUBTRACT, TEXTURE, CONSTANT",
        1,
        "discard = tex0; discard = -const0; spare0 = sum();",
    ),
    "ADDSMOOTH": (
        0x33FF33,
        "ADD, TEXTURE, 1, CONSTANT, 1 - TEXTURE",
        1,
        "discard = tex0; discard = const0 * unsigned_invert(tex0); spare0 = sum();",
    ),
    "BLENDDIFFUSEALPHA": (
        0x227722,
        "INTERPOLATE, TEXTURE, CONSTANT, PRIMARY_COLOR.a",
        1,
        "discard = tex0 * col0.a; discard = const0 * unsigned_invert(col0.a); spare0 = sum();",
    ),
    "BLENDTEXTUREALPHA": (
        0x14AD14,
        "INTERPOLATE, TEXTURE, CONSTANT, TEXTURE.a",
        1,
        "discard = tex0 * tex0.a; discard = const0 * unsigned_invert(tex0.a); spare0 = sum();",
    ),
    "BLENDFACTORALPHA": (
        0x07E407,
        "INTERPOLATE, TEXTURE, CONSTANT, CONSTANT.a",
        1,
        "discard = tex0 * const0.a; discard = const0 * unsigned_invert(const0.a); spare0 = sum();",
    ),
    "BLENDTEXTUREALPHAPM": (
        0x14FF14,
        "ADD, TEXTURE, 1, CONSTANT, 1 - TEXTURE.a",
        1,
        "discard = tex0; discard = const0 * unsigned_invert(tex0.a); spare0 = sum();",
    ),
    "BLENDCURRENTALPHA": (
        0x227722,
        "INTERPOLATE, TEXTURE, CONSTANT, PREVIOUS.a",
        1,
        "discard = tex0 * col0.a; discard = const0 * unsigned_invert(col0.a); spare0 = sum();",
    ),
    "MODULATEALPHA_ADDCOLOR": (
        0x1FFF1F,
        "ADD, TEXTURE, 1, TEXTURE.a, CONSTANT",
        1,
        "discard = tex0; discard = tex0.a * const0; spare0 = sum();",
    ),
    "MODULATECOLOR_ADDALPHA": (
        0x99CC99,
        "ADD, TEXTURE, CONSTANT, TEXTURE.a, 1",
        1,
        "discard = tex0 * const0; discard = tex0.a; spare0 = sum();",
    ),
    "MODULATEINVALPHA_ADDCOLOR": (
        0x14FF14,
        "ADD, TEXTURE, 1, 1 - TEXTURE.a, CONSTANT",
        1,
        "discard = tex0; discard = unsigned_invert(tex0.a) * const0; spare0 = sum();",
    ),
    "MODULATEINVCOLOR_ADDALPHA": (
        0xCC99CC,
        "ADD, 1 - TEXTURE, CONSTANT, TEXTURE.a, 1",
        1,
        "discard = unsigned_invert(tex0) * const0; discard = tex0.a; spare0 = sum();",
    ),
    "DOTPRODUCT3": (0x999999, "DOT3_RGB, TEXTURE, CONSTANT", 1, "spare0 = expand(tex0) . expand(const0);"),
    "MULTIPLYADD": (
        0xFF3300,
        "ADD, TEXTURE, CONSTANT, PRIMARY_COLOR, 1",
        1,
        "discard = tex0 * const0; discard = col0; spare0 = sum();",
    ),
    "LERP": (
        0x003333,
        "INTERPOLATE, TEXTURE, CONSTANT, PRIMARY_COLOR",
        1,
        "discard = tex0 * col0; discard = const0 * unsigned_invert(col0); spare0 = sum();",
    ),
}
TEXEL = image("t", [[0x9900FF00]])
FACTOR = argb(0xDD333333)
OPERANDS = strip(color=0x55FF0000, texture_coordinates=([[-1, -1], [-1, 1], [1, -1], [1, 1]],))


def operation_of_environment(name):
    color, words, scale, _ = OPERATIONS[name]
    rgb = words.split(", ")
    alpha = ("ADD", "PRIMARY_COLOR", "1", "ZERO", "ZERO") if len(rgb) == 5 else KEEP
    unit = TextureUnit("t", POINT, environment=environment(rgb, alpha, color=FACTOR, rgb_scale=float(scale)))
    frame = clear(0), TEXEL, draw(OPERANDS, SIZE, texture_units=(unit,))
    return Case(f"{name} by an environment", frame, middle(color, 3), SIZE)


def operation_of_combiners(name):
    color, _, _, words = OPERATIONS[name]
    program = parse_program(
        f"!!RC1.0\nconst0 = {FACTOR};\n{{ rgb {{ {words} }} }}\nout.rgb = spare0;\nout.a = col0.a;"
    )
    units = (TextureUnit("t", POINT),)
    frame = clear(0), TEXEL, draw(OPERANDS, SIZE, texture_units=units, register_combiners=program.combiners)
    return Case(f"{name} by combiners", frame, middle(color, 3), SIZE)


# test_texture_blending: vertices of 80ffff02, a bump map of (0, -1), a red texel whose alpha is 0.
COLORED = strip(color=0x80FFFF02)
SIGNED = replace(POINT, signed_components=SignedComponents(green=True, blue=True))
BUMP = TexImage(label="bump map", texture="b", image=texture_2d(np.array([[[255, 255, 0, 255]]], np.uint8)))
RED = image("r", [[0x00FF0000]])
BUMPED = (
    TextureShaderStage(TextureShaderOperation.TEXTURE_2D),
    TextureShaderStage(
        TextureShaderOperation.OFFSET_TEXTURE_2D, 0, offset_texture_matrix=(1.0, 1.0, 0.0, 0.0)
    ),
)
UNWRITTEN = parse_program(
    "!!RC1.0\n{ rgb { spare0 = spare1; } alpha { spare0 = spare1; } }\nout.rgb = spare0;\nout.a = spare0.a;"
).combiners


def blended(name, color, *load, **state):
    frame = clear(0xFF00FF00), *load, draw(COLORED, SIZE, **state)
    return Case(name, frame, middle(color, 1, alpha=True), SIZE)


def bumped(name, color, rgb):
    units = (
        TextureUnit("b", SIGNED, environment=NONE),
        TextureUnit("r", POINT, environment=environment(rgb, KEEP)),
    )
    return blended(name, color, BUMP, RED, texture_units=units, texture_shader=BUMPED)


BLENDED = (
    blended("no stage", 0x80FFFF02),
    blended(
        "a stage that selects the colour",
        0x80FFFF02,
        RED,
        texture_units=(TextureUnit("r", POINT, environment=environment(KEEP, KEEP)),),
    ),
    bumped("a bump map, then modulate", 0x80FF0000, ("MODULATE", "TEXTURE", "PREVIOUS")),
    bumped("a bump map, then the colour squared", 0x80FFFF00, ("MODULATE", "PREVIOUS", "PREVIOUS")),
    blended("D3DTA_TEMP that nothing wrote is 0", 0, register_combiners=UNWRITTEN),
)

# test_texcoordindex: units take coordinate sets of any number, and matrices.
SETS = ([[0, 1], [0, 0], [1, 1], [1, 0]], CORNERS, [[1, 1], [1, 0], [0, 1], [0, 0]])
FIRST_TEXTURE = image("first", [[0xFF000000, 0xFF00FF00], [0xFF0000FF, 0xFF00FFFF]])
SECOND_TEXTURE = image("second", [[0xFF000000, 0xFF0000FF], [0xFFFF0000, 0xFFFF00FF]])
KEEPS_U = (IDENTITY[0], (0.0,) * 4, (0.0,) * 4, IDENTITY[3])
INDICES = {
    "sets 1 and 0": (0, IDENTITY, (0x0000FF, 0x00FFFF, 0xFF0000, 0xFFFFFF)),
    "sets 1 and 0, whose matrix keeps u": (0, KEEPS_U, (0x0000FF, 0x00FFFF, 0, 0x00FFFF)),
    "sets 1 and 2": (2, IDENTITY, (0x0000FF, 0x00FFFF, 0xFF00FF, 0xFFFF00)),
}


def index(name):
    number, by, colors = INDICES[name]
    added = environment(("ADD", "TEXTURE", "PREVIOUS"))
    units = (
        TextureUnit("first", POINT, coordinates=1, environment=REPLACE),
        TextureUnit("second", POINT, coordinates=number, matrix=by, environment=added),
    )
    mesh = strip([[x, y, 0] for x in (-1, 1) for y in (-1, 1)], texture_coordinates=SETS)
    frame = clear(0xFFFFFF00), FIRST_TEXTURE, SECOND_TEXTURE, draw(mesh, SIZE, texture_units=units)
    at = (16, 12), (48, 12), (16, 36), (48, 36)
    wanted = pixels([(*place, color, 2) for place, color in zip(at, colors, strict=True)])
    return Case(name, frame, wanted, SIZE)


# test_color_clamping: a sum of two colours, times a quarter, where the colours are 1 or a vertex shader's 2.
SUM = parse_program("ps.1.1\ndef c0, .25, .25, .25, .25\nadd r0, v0, v1\nmul r0, r0, c0").combiners
PROGRAM = VertexState(stage=VertexStage.PROGRAM_RESULTS)
WINDOW = [[0, 0, 0, 1], [64, 0, 0, 1], [0, 48, 0, 1], [64, 48, 0, 1]]
TWO = [[2.0] * 4] * 4
DOUBLED = (
    TextureUnit("t", POINT, environment=environment(("ADD", "PRIMARY_COLOR", "PRIMARY_COLOR"))),
    TextureUnit(
        "t", POINT, environment=environment(("MODULATE", "CONSTANT", "PREVIOUS"), color=argb(0xFF404040))
    ),
)


def from_vertex_shader(**state):
    mesh = strip(WINDOW, colors=TWO, secondary_colors=TWO)
    return Draw(label="draw", mesh=mesh, state=PassState(vertex=PROGRAM, **state))


CLAMPED = (
    Case(
        "a vertex shader's 2 ends at 1, or at 2 in newer chips, before a pixel shader",
        (clear(0xFF00FF00), from_vertex_shader(register_combiners=SUM)),
        middle((0x7F7F7F, 0x404040), 1),
        SIZE,
    ),
    Case(
        "colours that nothing gives are 1 and 0",
        (clear(0xFF00FF00), draw(strip(), SIZE, register_combiners=SUM)),
        middle(0x404040, 1),
        SIZE,
    ),
    Case(
        "a vertex shader's 2 ends at 1 before stages",
        (clear(0xFF00FF00), TEXEL, from_vertex_shader(texture_units=DOUBLED)),
        middle(0x404040, 1),
        SIZE,
    ),
)

# constant_clamp_ps_test: constants of a pixel shader end at -1 and 1.
ABOVE_ONE = {1: (1.25, -0.5, -1.5, 1.0), 2: (-0.5, 1.25, 2.0, 1.0)}
DEFINED = "def c1, 1.25, -0.5, -1.5, 1\ndef c2, -0.5, 1.25, 2, 1\n"


def constants(name, version, defined, given):
    program = parse_program(f"ps.{version}\n{defined}mov r1, c1\nadd r0, r1, c2", constants=given).combiners
    return Case(
        name, (clear(0xFF00FFFF), draw(strip(), SIZE, register_combiners=program)), middle(0x808000, 1), SIZE
    )


CONSTANTS = (
    *[constants(f"constants of ps.{v}", v, "", ABOVE_ONE) for v in ("1.1", "1.2", "1.3")],
    constants("constants that ps.1.1 defines", "1.1", DEFINED, None),
)

CASES = (
    *map(operation_of_environment, OPERATIONS),
    *map(operation_of_combiners, OPERATIONS),
    *BLENDED,
    *map(index, INDICES),
    *CLAMPED,
    *CONSTANTS,
)
DISAGREEMENTS = everywhere(
    "open: a constant of mixed sign is read by EXPAND_NORMAL, which makes 254/255 of its 1",
    [case.name for case in CONSTANTS],
    ("GEFORCE_3", "NV2A"),
)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES, DISAGREEMENTS))
def test_stages_are_what_wine_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=265)
