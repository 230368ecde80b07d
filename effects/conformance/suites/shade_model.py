"""Shade_model: flat and smooth shading of every polygon primitive, with either provoking vertex.

Source: src/tests/shade_model_tests.cpp of nxdk_pgraph_tests. Fixed: the fixed-function vertex stage, lit by
one infinite light; W_Fixed: the same with a growing w; Prog: a vertex program, unlit; ProgLM: the same as
outlines. ...Tex: a checkerboard instead of the colour.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import Face, FrontFace, PolygonMode, PrimitiveType, ProvokingVertex, ShadeModel
from fixedpipe.pipeline.state import Light, Lighting, Material, PolygonState, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Shade_model"

PREFIXES = ("Fixed", "FixedTex", "W_Fixed", "W_FixedTex", "Prog", "ProgTex", "ProgLM")
MODELS = {"Flat": ShadeModel.FLAT, "Smooth": ShadeModel.SMOOTH}
PROVOKING = {"First": ProvokingVertex.FIRST, "Last": ProvokingVertex.LAST}
LEFT, RIGHT, TOP, BOTTOM = -2.75, 2.75, 1.75, -1.75
DEPTH = 0.1

# x, y, s, t of every vertex.
SHAPES = {
    "Tri": (
        PrimitiveType.TRIANGLES,
        (
            *((LEFT, TOP, 0.0, 0.0), (0.0, TOP, 1.0, 0.0), (LEFT, 0.0, 0.0, 1.0)),
            *((RIGHT, TOP, 1.0, 0.0), (0.1, BOTTOM, 0.1, 1.0), (0.25, 0.0, 0.25, 0.5)),
            *((-0.4, BOTTOM, 0.5, 1.0), (-1.4, -1.4, 0.2, 0.5), (0.0, 0.0, 1.0, 0.0)),
        ),
    ),
    "TriStrip": (
        PrimitiveType.TRIANGLE_STRIP,
        (
            *((LEFT, 0.0, 0.0, 0.0), (-2.25, TOP, 0.0, 1.0), (-2.0, BOTTOM, 0.0, 0.0)),
            *((-1.3, 1.6, 1.15, 0.25), (0.0, -1.5, 1.3, 0.75), (0.4, 1.0, 1.7, 0.33)),
            *((1.4, -0.6, 0.7, 0.7), (RIGHT, TOP, 0.5, 0.5)),
        ),
    ),
    "TriFan": (
        PrimitiveType.TRIANGLE_FAN,
        (
            *((0.0, -0.75, 1.0, 1.0), (-2.25, BOTTOM, 0.0, 0.0), (-2.0, TOP, 0.0, 1.0)),
            *((-0.6, 0.65, 1.15, 0.25), (0.0, 1.5, 1.3, 0.75), (0.4, 1.0, 1.7, 0.33)),
            *((2.4, 0.6, 0.7, 0.7), (RIGHT, BOTTOM, 0.5, 0.5)),
        ),
    ),
    "Quad": (
        PrimitiveType.QUADS,
        (
            *((LEFT, TOP, 0.0, 0.0), (-0.4, TOP, 1.0, 0.0), (-0.4, BOTTOM, 1.0, 1.0)),
            *((LEFT, BOTTOM, 0.0, 1.0), (0.15, TOP, 0.0, 0.0), (RIGHT, TOP, 1.0, 0.0)),
            *((RIGHT, BOTTOM, 1.0, 1.0), (0.0, BOTTOM, 0.0, 1.0)),
        ),
    ),
    "QuadStrip": (
        PrimitiveType.QUAD_STRIP,
        (
            *((LEFT, BOTTOM, 0.33, 0.33), (LEFT, TOP, 1.0, 1.0), (0.0, -1.35, 0.7, 0.1)),
            *((0.0, 1.0, 0.0, 0.9), (RIGHT, BOTTOM, 0.33, 0.33), (RIGHT, TOP, 0.0, 0.7)),
        ),
    ),
    "Poly": (
        PrimitiveType.POLYGON,
        (
            *((LEFT, BOTTOM, 0.33, 0.33), (-1.4, 1.1, 0.7, 0.1), (-0.3, TOP, 0.1, 0.7)),
            *((2.0, 0.3, 0.0, 0.9), (RIGHT, -1.5, 0.7, 0.7)),
        ),
    ),
}
COLORS = (
    *(0xFFFF0000, 0xFF00FF00, 0xFF0000FF, 0xFFCCCCCC, 0xFFFF33CC, 0xFFFFCC33, 0xFFCCFF33),
    *(0xFF33FFCC, 0xFF33CCFF, 0xFFCC33FF, 0xFF991111, 0xFF119911, 0xFF111199, 0xFF666666),
)
NORMALS = (
    *((0.5773502691896258, -0.5773502691896258, 0.5773502691896258), (0.0, 0.0, 1.0)),
    *((0.4082482904638631, 0.4082482904638631, 0.8164965809277261), (-0.66667, 0.66667, 0.3333333)),
    *((0.3015, 0.3015, 0.9045), (0.4851, 0.4851, 0.7276), (0.6247, 0.6247, 0.4685), (0.2673, 0.5345, 0.8018)),
    *((0.6767, 0.6767, 0.29), (0.7317, 0.3049, 0.6097), (0.6172, 0.7715, 0.1543), (0.6527, 0.272, 0.7071)),
    *((0.7861, 0.3276, 0.5241), (0.6509, 0.6509, 0.3906)),
)

# One infinite light along the eye's z on a material that shows the light's own colours.
LIT = Lighting(
    lights=(Light(diffuse=(0.0, 1.0, 0.7, 1.0), specular=(0.0, 0.0, 0.0, 1.0)),),  # along z by default
    front=Material(ambient=(0.0, 0.0, 0.0, 1.0), diffuse=(1.0, 1.0, 1.0, 1.0)),
    model_ambient=(0.0, 0.0, 0.0, 1.0),
)
CHECKERBOARD = "checkerboard"


def _mesh(primitive, vertices, prefix):
    count = len(vertices)
    at = np.array(vertices)
    points = np.stack([at[:, 0], at[:, 1], np.full(count, DEPTH)], axis=1)
    arrays = {
        "colors": np.array([scenes.abgr(word) for word in COLORS[:count]]),
        "normals": scenes.single(NORMALS[:count]),
        "texture_coordinates": (scenes.single(at[:, 2:]),),
    }
    if prefix.startswith("Prog"):
        return scenes.window_mesh(vertex_programs.perspective(points), primitive, **arrays)
    w = np.ones(count)
    if prefix.startswith("W_"):  # the program adds up single-precision numbers
        w = np.add.accumulate(np.float32([0.5] + [0.05] * (count - 1)), dtype=np.float32)
    return Mesh(scenes.single(np.column_stack([points, w])), primitive, **arrays)


def _case(prefix, shape, model, provoking):
    programmed, textured = prefix.startswith("Prog"), prefix.endswith("Tex")
    outlined = PolygonMode.LINE if prefix == "ProgLM" else PolygonMode.FILL
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.PROGRAM_RESULTS if programmed else replace(scenes.xdk_vertex(), lighting=LIT),
        polygon=PolygonState(
            cull_face=Face.BACK,
            front_face=FrontFace.CW,
            shade_model=MODELS[model],
            provoking_vertex=PROVOKING[provoking],
            front_mode=outlined,
            back_mode=outlined,
        ),
    )
    commands = [scenes.clear(0xFF2C302E)]
    if textured:
        board = scenes.checkerboard(0xFFC0C020, 0xFF700000, 8, size=64)
        commands.append(TexImage(label=CHECKERBOARD, texture=CHECKERBOARD, image=texture_2d(board)))
        state = replace(
            state,
            texture_units=(TextureUnit(CHECKERBOARD, scenes.NEAREST),),
            register_combiners=scenes.SHOWS_TEXTURE0,
        )
    primitive, vertices = SHAPES[shape]
    mesh = _mesh(primitive, vertices, prefix)
    return Case(commands=(*commands, Draw(label=shape, mesh=mesh, state=state)))


CASES = {"_".join(parts): partial(_case, *parts) for parts in product(PREFIXES, SHAPES, MODELS, PROVOKING)}
