"""Attrib_carryover: a shape with an attribute, then one without it, which shows the attribute as its colour.

Measured: an attribute that a draw does not give has the value of the last vertex drawn before, by any command
(49 captures). Source: src/tests/attribute_carryover_tests.cpp and its vertex program, of nxdk_pgraph_tests.
"""

from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

SUITE = "Attrib_carryover"

# c[96].x is the number of the attribute that is shown, compared with (0, 1, 2, 3), (4, 5, 6, 7) and
# (8, 9, 10, 11); the one that is equal has the factor one.
PROGRAM = vertex_program("""
    MOV R0.x, c[96];
    SGE R1, c[99], R0.x;  SGE R2, R0.x, c[99];  MUL R8, R1, R2;
    SGE R1, c[100], R0.x; SGE R2, R0.x, c[100]; MUL R9, R1, R2;
    SGE R1, c[101], R0.x; SGE R2, R0.x, c[101]; MUL R10, R1, R2;
    MOV R4.xy, v[WGHT].x; MOV R4.zw, c[97]; MUL R3, R4, R8.x;
    MOV R4, v[NRML]; MOV R4.w, c[97]; MAD R3, R4, R8.y, R3;
    MAD R3, v[COL0], R8.z, R3; MAD R3, v[COL1], R8.w, R3;
    MOV R4.xy, v[FOGC].x; MOV R4.zw, c[97]; MAD R3, R4, R9.x, R3;
    MOV R4.xy, v[PSIZ].x; MOV R4.zw, c[97]; MAD R3, R4, R9.y, R3;
    MAD R3, v[BFC0], R9.z, R3; MAD R3, v[BFC1], R9.w, R3;
    MAD R3, v[TEX0], R10.x, R3; MAD R3, v[TEX1], R10.y, R3;
    MAD R3, v[TEX2], R10.z, R3; MAD R3, v[TEX3], R10.w, R3;
    MOV o[HPOS], v[OPOS]; MOV o[COL0], R3;
""")
CONSTANTS = {97: (1.0,) * 4, 99: (0.0, 1.0, 2.0, 3.0), 100: (4.0, 5.0, 6.0, 7.0), 101: (8.0, 9.0, 10.0, 11.0)}
DIFFUSE, POINT_SIZE = 2, 5

# By name in the cases: the attribute's number, its input, and how many components a vertex gives.
ATTRIBUTES = {
    **{"w": (0, "WGHT", 1), "n": (1, "NRML", 3), "d": (DIFFUSE, "COL0", 4), "s": (3, "COL1", 4)},
    **{"fc": (4, "FOGC", 1), "ps": (POINT_SIZE, "PSIZ", 1), "bd": (6, "BFC0", 4), "bs": (7, "BFC1", 4)},
    **{"t0": (8, "TEX0", 2), "t1": (9, "TEX1", 2), "t2": (10, "TEX2", 2), "t3": (11, "TEX3", 2)},
}
# How the vertices are sent: arrays, one by one, in the command stream, by index. And the last vertex's value.
VALUES = {
    "da": (0.05, 0.0, 1.0, 1.0),
    "ib": (0.75, 0.0, 0.0, 1.0),
    "ia": (0.5, 0.0, 0.0, 1.0),
    "ie": (0.25, 0.0, 0.6, 1.0),
}
INDICES = {"L": (1, 0), "T": (2, 0, 1)}  # of "ie"
LEFT, TOP, MIDDLE, RIGHT, BOTTOM = WIDTH / 5, HEIGHT / 6, WIDTH / 2, WIDTH * 4 / 5, HEIGHT * 5 / 6
GREEN, MAGENTA, WHITE = (0.0, 1.0, 0.0, 1.0), (1.0, 0.0, 1.0, 1.0), (1.0, 1.0, 1.0, 1.0)
GREENISH = {"WGHT": (0.66,), "FOGC": (0.5,), "PSIZ": (0.7,)}  # of the vertex that is green elsewhere


def _positions(shape):
    """Of the first and the second shape."""
    if shape == "L":
        return [[(LEFT, y, 3.0), (RIGHT, y, 3.0)] for y in (TOP, BOTTOM)]
    return [
        [(x0, TOP, 3.0), (x1, TOP, 3.0), (x0 + (x1 - x0) / 2, BOTTOM, 3.0)]
        for x0, x1 in ((LEFT, MIDDLE), (MIDDLE, RIGHT))
    ]


def _given(shape, name, size, value):
    """An attribute of every vertex of the first shape, as many components as it has."""
    green = GREENISH.get(name, GREEN)
    rows = [green, value] if shape == "L" else [WHITE, green, value]
    return np.array([row[:size] for row in rows])


def _draw(shape, how, positions, number, inputs):
    indices = INDICES[shape] if how == "ie" else None
    results = PROGRAM.run({"OPOS": np.array(positions)} | inputs, CONSTANTS | {96: (number, 0.0, 0.0, 0.0)})
    primitive = PrimitiveType.LINES if shape == "L" else PrimitiveType.TRIANGLES
    mesh = vertex_programs.results_mesh(results, primitive, indices=indices)
    return Draw(label="shape", mesh=mesh, state=scenes.DEFAULT)


def _case(shape, attribute, how):
    number, register, size = ATTRIBUTES[attribute]
    first, second = _positions(shape)
    tested = _given(shape, register, size, VALUES[how])
    colors = tested if number == DIFFUSE else _given(shape, "COL0", 4, MAGENTA)
    carried = tested[INDICES[shape][-1] if how == "ie" else -1]
    if number == POINT_SIZE and how == "ib":  # whose command sets the size alone, so that v[PSIZ] stays:
        carried = VALUES["ia"][:1]  # the case drawn before it left this one
    return Case(
        commands=(
            scenes.clear(0xFF444444),
            _draw(shape, how, first, DIFFUSE, {"COL0": colors}),
            _draw(shape, how, second, number, {register: tuple(carried)}),
        )
    )


CASES = {
    f"{shape}-{attribute}{'_'.join(f'{v:.1f}' for v in np.array(VALUES[how], np.float32).tolist())}-{how}": (
        partial(_case, shape, attribute, how)
    )
    for shape in INDICES
    for attribute in ATTRIBUTES
    for how in VALUES
}
