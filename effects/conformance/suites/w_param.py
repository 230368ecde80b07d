"""W_param: clip coordinates w that are zero, infinite, tiny, huge or negative; the clamped reciprocal RCC.

Source: src/tests/w_param_tests.cpp of nxdk_pgraph_tests. Not drawn are its strips whose lines go through
infinity (w_neg_strip, w_gaps) and the fixed functions' w of zero with a texture (ff_w_zero__*).
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.through_infinity import near_part
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import BlendFactor, PrimitiveType, TextureTarget
from fixedpipe.pipeline.state import Blending, DepthClamp, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.vertices.projection import composite_coordinates
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

SUITE = "W_param"
OPEN = "edges of primitives that pass through infinity"

LEAST, MOST = np.float32(5.421011e-20), np.float32(1.8446744e19)  # about what RCC clamps to
INFINITE = 2.0**65  # beyond what the chip tells from infinity
# By name, the factor that the last corner's w is multiplied with and the first one's divided by.
FACTORS = {
    "0.00": 0.0, "0.25": 0.25, "0.50": 0.5, "1.00": 1.0, "2.00": 2.0, "4.00": 4.0, "inf": np.inf,
    "-inf": -np.inf, "-4.00": -4.0, "-2.00": -2.0, "-1.00": -1.0, "-0.50": -0.5, "-0.25": -0.25,
    "-0.00": -0.0,
} | {
    name: -LEAST * (np.float32(steps) * LEAST)
    for name, steps in (
        ("-3.08e-33", 1048576), ("-0.96e-34", 32768), ("-1.50e-36", 512), ("-7.52e-37", 256),
        ("-3.76e-37", 128), ("-1.88e-37", 64),
    )
}  # fmt: skip
SHAPES = ("_bitri", "_quad")
RECIPROCAL = vertex_program("""
    RCC R0.x, v[OPOS].z; MUL o[HPOS].xy, v[OPOS], R0.x; MOV o[HPOS].z, R0.x; MOV o[HPOS].w, v[OPOS].w;
    MOV o[COL0], v[COL0];
""")
ADDED = Blending(BlendFactor.ONE, BlendFactor.ONE)
BACKGROUND, SIZE = 0xFE251135, 256
LEFT, TOP, RIGHT, BOTTOM = 160.0, 70.0, 480.0, 390.0
HALF = 80.0  # of the fixed functions' square, pixels


def names():
    """Every case of the suite."""
    return [
        *(f"rcc_w_zero_inf__z{factor}" for factor in FACTORS),
        *(
            f"{stage}_w_zero_inf_{shape}_w{factor}"
            for stage in ("prog", "ff")
            for shape in SHAPES
            for factor in FACTORS
        ),
        *("w_pos_strip", "w_pos_strip_tex_persp"),
    ]


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
    """The same through the fixed functions, whose viewport moves the origin to the screen's middle."""
    first, last = (np.clip(w, -INFINITE, INFINITE) for w in _ends(factor))
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


def _strip(perspective):
    """A strip whose w goes from zero and infinity to 10."""
    left, middle, right, top, bottom = 128.0, 320.0, 512.0, 80.0, 400.0
    vertices = (
        (left, bottom, 0.0, (0.75, 0.75, 0.75)), (left, top, INFINITE, (0.0, 1.0, 0.0)),
        (middle, bottom, 0.1, (1.0, 0.0, 0.0)), (middle, top, 0.5, (0.0, 0.0, 1.0)),
        (right, bottom, 1.5, (0.0, 0.5, 0.75)), (right, top, 10.5, (0.7, 0.9, 0.2)),
    )  # fmt: skip
    mesh = scenes.window_mesh(
        [(x, y, 0.0, w) for x, y, w, _ in vertices],
        PrimitiveType.TRIANGLE_STRIP,
        colors=np.array([(*color, 1.0) for *_, color in vertices]),
    )
    yield scenes.clear(0xFF000000)
    yield Draw(label="strip", mesh=mesh, state=replace(scenes.DEFAULT, perspective_correction=perspective))


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name.startswith("rcc") and name in names():
        return Case(commands=tuple(_reciprocals(FACTORS[name.rpartition("z")[2]])))
    if name.startswith("w_pos_strip") and name in names():
        return Case(commands=tuple(_strip(name.endswith("persp"))))
    for stage, commands in (("prog", _programmed), ("ff", _fixed)):
        for shape in SHAPES:
            prefix = f"{stage}_w_zero_inf_{shape}_w"
            factor = FACTORS.get(name.removeprefix(prefix)) if name.startswith(prefix) else None
            if factor is not None:
                return Case(commands=tuple(commands(shape, factor)))
    return None
