"""W_param: clip coordinates w that are zero, infinite, tiny, huge or negative; the clamped reciprocal RCC.

Source: src/tests/w_param_tests.cpp of nxdk_pgraph_tests, and VertexBuffer of PBKitPlusPlus. By the latter
w_gaps makes separate triangles of a strip: they have the strip's order of corners. Their w is not sent, so
it is 1.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.through_infinity import near_part, outlines
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import BlendFactor, PolygonMode, PrimitiveType, TextureTarget
from fixedpipe.pipeline.state import Blending, DepthClamp, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.vertices.chip_floats import transform_matrix
from fixedpipe.pipeline.vertices.projection import composite_coordinates
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

SUITE = "W_param"

LEAST, MOST = np.float32(5.421011e-20), np.float32(1.8446744e19)  # about what RCC clamps to
INFINITE = 2.0**65  # beyond what the chip tells from infinity
# By name, the factor that the last corner's w is multiplied with and the first one's divided by.
FACTORS = {
    **{"0.00": 0.0, "0.25": 0.25, "0.50": 0.5, "1.00": 1.0, "2.00": 2.0, "4.00": 4.0, "inf": np.inf},
    **{"-inf": -np.inf, "-4.00": -4.0, "-2.00": -2.0, "-1.00": -1.0, "-0.50": -0.5, "-0.25": -0.25},
    "-0.00": -0.0,
} | {
    name: -LEAST * (np.float32(steps) * LEAST)
    for name, steps in (
        *(("-3.08e-33", 1048576), ("-0.96e-34", 32768), ("-1.50e-36", 512), ("-7.52e-37", 256)),
        *(("-3.76e-37", 128), ("-1.88e-37", 64)),
    )
}
SHAPES = ("_bitri", "_quad")
RECIPROCAL = vertex_program("""
    RCC R0.x, v[OPOS].z; MUL o[HPOS].xy, v[OPOS], R0.x; MOV o[HPOS].z, R0.x; MOV o[HPOS].w, v[OPOS].w;
    MOV o[COL0], v[COL0];
""")
ADDED = Blending(BlendFactor.ONE, BlendFactor.ONE)
BACKGROUND, SIZE = 0xFE251135, 256
LEFT, TOP, RIGHT, BOTTOM = 160.0, 70.0, 480.0, 390.0
HALF = 80.0  # of the fixed functions' square, pixels
PERSPECTIVE = "_tex_persp"
STRIP_LEFT, STRIP_TOP, STRIP_RIGHT, STRIP_BOTTOM = 128.0, 80.0, 512.0, 400.0
STRIP_MIDDLE = 320.0
EDGE = 1.75  # of a square in the XDK's view


def _ends(factor):
    """The first corner's w (or z) and the last one's, in single precision."""
    with np.errstate(divide="ignore", over="ignore"):
        return np.float32(LEAST / np.float32(factor)), np.float32(MOST * np.float32(factor))


def _reciprocals(factor):
    first, last = _ends(factor)
    sign = np.where(np.signbit([first, last]), -1.0, 1.0)
    near, far = float(LEAST), float(MOST)
    corners = [
        (sign[0] * np.float32(LEFT * near), sign[0] * np.float32(TOP * near), first, 1.0),
        (RIGHT * near, TOP * near, near, 1.0),
        (LEFT * near, BOTTOM * near, near, 1.0),
        (sign[1] * np.float32(RIGHT * far), sign[1] * np.float32(BOTTOM * far), last, 1.0),
        (LEFT * far, BOTTOM * far, far, 1.0),
        (RIGHT * far, TOP * far, far, 1.0),
    ]
    red, yellow, cyan, green = (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 1.0), (0.0, 1.0, 0.0)
    colors = np.array([(*c, 1.0) for c in (red, yellow, cyan, green, cyan, yellow)])
    results = RECIPROCAL.run({"OPOS": np.array(corners), "COL0": colors})
    rows = np.concatenate([results["HPOS"], results["COL0"]], axis=1)
    mesh = near_part(rows, "colors", SPLIT["_bitri"])
    yield scenes.clear(BACKGROUND)
    state = replace(scenes.DEFAULT, blending=ADDED, depth_clamp=DepthClamp())
    yield Draw(label="triangles", mesh=mesh, state=state)


def _texture(first, second):
    image = replace(texture_2d(scenes.checkerboard(first, second, 8)), target=TextureTarget.TEXTURE_RECTANGLE)
    return TexImage(label="checkerboard", texture="checkerboard", image=image)


SPLIT = {"_quad": ((0, 1, 2), (0, 2, 3)), "_bitri": ((0, 1, 2), (3, 4, 5))}  # corners of each triangle
TEXELS = {
    "_quad": ((0, 0), (1, 0), (1, 1), (0, 1)),
    "_bitri": ((0, 0), (1, 0), (0, 1), (1, 1), (0, 1), (1, 0)),
}


def _textured(shape, positions):
    """The square through infinity, as a vertex program's results."""
    rows = np.concatenate(
        [np.array(positions, np.float64), SIZE * np.array(TEXELS[shape], np.float64)], axis=1
    )
    return Draw(
        label="square",
        mesh=near_part(rows, "texture_coordinates", SPLIT[shape]),
        state=replace(
            scenes.DEFAULT,
            register_combiners=scenes.SHOWS_TEXTURE0,
            texture_units=(TextureUnit("checkerboard", scenes.NEAREST),),
            blending=ADDED,
            depth_clamp=DepthClamp(),
        ),
    )


def _programmed(shape, factor):
    first, last = (np.clip(w, -INFINITE, INFINITE) for w in _ends(factor))
    ends = ((LEFT, TOP), (RIGHT, BOTTOM))  # the other way round where w is negative
    upper = (*ends[int(np.signbit(first))], 0.0, first)
    lower = (*ends[1 - int(np.signbit(last))], 0.0, last)
    if shape == "_quad":
        corners = [upper, (RIGHT, TOP, 0.0, 1.0), lower, (LEFT, BOTTOM, 0.0, 1.0)]
    else:
        near, far = float(LEAST), float(MOST)
        corners = [
            *(upper, (RIGHT, TOP, 0.0, near), (LEFT, BOTTOM, 0.0, near)),
            *(lower, (LEFT, BOTTOM, 0.0, far), (RIGHT, TOP, 0.0, far)),
        ]
    yield scenes.clear(BACKGROUND)
    yield _texture(0xFF00C0C0, 0xFFC00000)
    yield _textured(shape, corners)


def _fixed(shape, factor):
    """The same through the fixed functions, whose viewport moves the origin to the screen's middle.

    Measured: their sums leave no zero its sign (ff_w_zero_inf__quad_w-inf, whose first corner has w = -0).
    """
    first, last = (np.clip(w, -INFINITE, INFINITE) if w != 0 else 0.0 for w in _ends(factor))
    near, far = float(LEAST), float(MOST)
    upper = (-HALF * near, -HALF * near, 0.0, first)
    lower = (HALF * far, HALF * far, 0.0, last)
    right, left = (HALF, -HALF, 0.0, 1.0), (-HALF, HALF, 0.0, 1.0)
    corners = [upper, right, lower, left] if shape == "_quad" else [upper, right, left, lower, left, right]
    columns = scenes.single(corners).T
    columns[3] = np.copysign(np.clip(np.abs(columns[3]), 2.0**-64, 2.0**64), columns[3])
    x, y, z, _ = composite_coordinates(columns, (WIDTH / 2, HEIGHT / 2, 0.0), HEIGHT)
    yield scenes.clear(BACKGROUND)
    yield _texture(0xFF00FFFF, 0xFFFF0000)
    yield _textured(shape, np.stack([x, HEIGHT - y, z, columns[3]], axis=1))


POSITIVE = (
    (STRIP_LEFT, STRIP_BOTTOM, 0.0, (0.75, 0.75, 0.75)),
    (STRIP_LEFT, STRIP_TOP, INFINITE, (0.0, 1.0, 0.0)),
    (STRIP_MIDDLE, STRIP_BOTTOM, 0.1, (1.0, 0.0, 0.0)),
    (STRIP_MIDDLE, STRIP_TOP, 0.5, (0.0, 0.0, 1.0)),
    (STRIP_RIGHT, STRIP_BOTTOM, 1.5, (0.0, 0.5, 0.75)),
    (STRIP_RIGHT, STRIP_TOP, 10.5, (0.7, 0.9, 0.2)),
)
NEGATIVE = (
    (STRIP_LEFT, STRIP_BOTTOM, 1.0, (0.75, 0.75, 0.75)),
    (STRIP_LEFT, STRIP_TOP, 1.0, (1.0, 1.0, 1.0)),
    (STRIP_MIDDLE, STRIP_BOTTOM, 1.0, (0.5, 0.5, 0.5)),
    (STRIP_MIDDLE, STRIP_TOP, 1.0, (0.0, 1.0, 0.0)),
    (STRIP_MIDDLE, STRIP_TOP, -0.1, (1.0, 0.0, 0.0)),
    (STRIP_RIGHT, STRIP_BOTTOM, 1.0, (0.0, 0.5, 0.5)),
)
# Of w_gaps: a visible quad's last colour, and w of the two corners before the next one.
VISIBLE = ((0, 1, 1), (0.75, 0.75, 0.1), (0, 1, 0), (0, 0, 1), (0, 0.5, 1), (0.5, 0.5, 0.5), (0.3, 1, 0.3))
GAPS = ((0.0, 0.0), (0.9, 0.0), (10.9, 0.0), (-0.9, 0.0), (-10.9, 10.0), (INFINITE, INFINITE))
SHIFT = (-6.0, 166.0)  # pixels: of the separate triangles


def _gaps():
    """The vertices of w_gaps' strip: quads of an infinite w, and between them corners of any."""
    middle, step = STRIP_TOP + (STRIP_BOTTOM - STRIP_TOP) / 2 - 4, np.float32(STRIP_RIGHT - STRIP_LEFT) / 14
    x, vertices = np.float32(STRIP_LEFT), []
    for i, color in enumerate(VISIBLE):
        for grey, last in ((0.75, (1.0, 1.0, 1.0)), (0.5, color)):
            vertices += [(float(x), middle, INFINITE, (grey,) * 3), (float(x), STRIP_TOP, INFINITE, last)]
            x = np.float32(x + step) if grey == 0.75 else x
        if i < len(GAPS):
            vertices.append((float(x), STRIP_TOP, GAPS[i][0], (1.0, 0.0, 0.0)))
            x = np.float32(x + step)
            vertices.append((float(x), middle, GAPS[i][1], (0.5, 0.0, 0.0)))
    return vertices


def _triangles(vertices):
    """A strip's triangles, apart."""
    order = [(i, i + 1, i + 2) if i % 2 == 0 else (i + 1, i, i + 2) for i in range(len(vertices) - 2)]
    return [vertices[i] for triangle in order for i in triangle]


def _strip(vertices, perspective, primitive=PrimitiveType.TRIANGLE_STRIP, outlined=False):
    """A strip, or separate triangles, whose w may be anything; with white outlines where ``outlined``."""
    state = replace(scenes.DEFAULT, perspective_correction=perspective, polygon=scenes.FRONT_FACES)
    positions = [(x, y, 0.0, w) for x, y, w, _ in vertices]
    colors = np.array([(*color, 1.0) for *_, color in vertices])
    yield Draw(label="filled", mesh=scenes.window_mesh(positions, primitive, colors=colors), state=state)
    if not outlined:
        return
    line = replace(state.polygon, front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)
    mesh = scenes.window_mesh(positions, primitive)
    yield Draw(label="outlines", mesh=mesh, state=replace(state, polygon=line))
    corners = [(x, y, w) for x, y, w, _ in vertices]
    if primitive == PrimitiveType.TRIANGLE_STRIP:
        corners = _triangles(corners)
    edges = [(i + a, i + b) for i in range(0, len(corners), 3) for a, b in ((1, 2), (2, 0), (0, 1))]
    ends = outlines(corners, edges)
    if ends:
        mesh = scenes.window_mesh(ends, PrimitiveType.LINES)
        yield Draw(label="outlines through infinity", mesh=mesh, state=state)


def _strips(drawn, perspective):
    yield scenes.clear(0xFF000000)
    if drawn != "w_gaps":
        vertices, negative = (NEGATIVE, True) if drawn == "w_neg_strip" else (POSITIVE, False)
        yield from _strip(vertices, perspective, outlined=negative)
        return
    vertices = _gaps()
    yield from _strip(vertices, perspective, outlined=True)
    (right, down), apart = SHIFT, _triangles(vertices)
    moved = [(float(np.float32(x) + np.float32(right)), y + down, 1.0, color) for x, y, _, color in apart]
    yield from _strip(moved, perspective, PrimitiveType.TRIANGLES, outlined=True)


def _zero(shape, perspective):
    """A square in the XDK's view, one corner of which has w = 0 and lies at infinity."""
    upper, right = (-EDGE, EDGE, 0.0, 0.0), (EDGE, EDGE, 0.0, 1.0)
    lower, left = (EDGE, -EDGE, 0.0, 1.0), (-EDGE, -EDGE, 0.0, 1.0)
    corners = [upper, right, lower, left] if shape == "_quad" else [upper, right, left, lower, left, right]
    composite = scenes.xdk_vertex().composite
    columns = transform_matrix(composite.matrix, scenes.single(corners).T)
    columns[3] = np.maximum(columns[3], 2.0**-64)
    x, y, z, _ = composite_coordinates(columns, composite.offset, HEIGHT)
    w = columns[3] if perspective else np.ones(len(corners))
    yield scenes.clear(BACKGROUND)
    yield _texture(0xFF00FFFF, 0xFF000000)
    drawn = _textured(shape, np.stack([x, HEIGHT - y, z, w], axis=1))
    polygon = replace(drawn.state, perspective_correction=perspective, polygon=scenes.FRONT_FACES)
    yield replace(drawn, state=replace(polygon, blending=scenes.BLENDED, depth_clamp=None))


# Measured: two lines of the upper row lead over quads of the lower one, which is filled later (w_gaps).
OUTLINES = "when the chip draws an outline that leads through infinity is open"


def _strip_case(drawn, perspective):
    explanation = OUTLINES if drawn == "w_gaps" and not perspective else ""
    return Case(commands=tuple(_strips(drawn, perspective)), explanation=explanation)


CASES = {
    **{
        f"rcc_w_zero_inf__z{name}": partial(Case.of, _reciprocals, factor) for name, factor in FACTORS.items()
    },
    **{
        f"{stage}_w_zero_inf_{shape}_w{name}": partial(Case.of, commands, shape, factor)
        for stage, commands in (("prog", _programmed), ("ff", _fixed))
        for shape in SHAPES
        for name, factor in FACTORS.items()
    },
    **{
        f"{strip}{suffix}": partial(_strip_case, strip, bool(suffix))
        for strip in ("w_gaps", "w_pos_strip", "w_neg_strip")
        for suffix in ("", PERSPECTIVE)
    },
    **{
        f"ff_w_zero_{shape}{suffix}": partial(Case.of, _zero, shape, bool(suffix))
        for shape in ("_quad", "_bitri")
        for suffix in ("", PERSPECTIVE)
    },
}
