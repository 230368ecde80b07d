"""Vertex_shader_independence_tests: two instructions at a time do not disturb each other.

Source: src/tests/vertex_shader_independence_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.passes.combiners import SECONDARY, SPARE0, program, shown, stage, total
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

SUITE = "Vertex_shader_independence_tests"

# R0.x is an operand of one and the result of the other; then R12, which reads what was written to o[HPOS].
PAIRED = vertex_program("""
    MOV o[HPOS], v[OPOS]; MOV R0, c[96]; MOV R1, c[97]; MOV R8, c[98];
    DP3 R0.x, R8.wyz, R8.wyz + RSQ R1.z, R0.x;
    MOV o[COL0], R1;
""")
CONSTANTS = {96: (1.0, 0.0, 0.0, 0.0), 97: (0.5, 0.5, 0.0, 1.0), 98: (0.0, 0.0, 0.0, 8.0)}
TWICE = vertex_program("""
    MOV o[HPOS], v[COL0]; SGE o[HPOS].w, R0.w, R0.w;
    ADD o[HPOS].xyz, R12, v[COL1] + ADD R0.xyz, R12, v[COL1];
    MOV o[COL0], R0;
    RCP o[HPOS].x, v[COL0].x; RCP o[HPOS].x, R12.x + RCP R1.x, R12.x;
    MOV o[COL1], R1.x; MOV o[HPOS], v[OPOS];
""")
COPY = vertex_program("MOV o[HPOS], v[OPOS]; MOV o[COL0], v[COL0]; MOV o[COL1], v[COL1];")
SHOWS_SECONDARY = program(stage(total(SECONDARY, to=SPARE0)), shown(SPARE0))

SQUARE = (128.0, 60.0, 512.0, 420.0)
LEFT, TOP, HALF = 192.0, 128.0, 128.0
RED, GREEN = (0.5, 0.0, 0.0, 1.0), (0.0, 0.5, 0.0, 1.0)


def _quad(program, box, color, secondary, constants=None, shows=scenes.SHOWS_PRIMARY_OPAQUE):
    inputs = {"OPOS": np.array(scenes.rectangle(*box)), "COL0": color, "COL1": secondary}
    mesh = vertex_programs.results_mesh(program.run(inputs, constants))
    return Draw(label="quad", mesh=mesh, state=replace(scenes.DEFAULT, register_combiners=shows))


def _paired():
    quad = _quad(PAIRED, SQUARE, (1.0,) * 4, (1.0,) * 4, CONSTANTS)
    return Case(commands=(scenes.clear(0xFE333333), quad))


def _several():
    middle, right, center, bottom = LEFT + HALF, LEFT + 2 * HALF, TOP + HALF, TOP + 2 * HALF
    return Case(
        commands=(
            scenes.clear(0xFE333333),
            _quad(COPY, (LEFT, TOP, middle, bottom), (0.5, 0.5, 0.0, 1.0), GREEN),
            _quad(TWICE, (middle, TOP, right, center), RED, GREEN),
            _quad(COPY, (LEFT, center, middle, bottom), (0.5, 0.5, 0.5, 1.0), GREEN),
            _quad(TWICE, (middle, center, right, bottom), RED, GREEN, shows=SHOWS_SECONDARY),
        )
    )


CASES = {"MAC_ILU_Independence": _paired, "Multioutput": _several}
