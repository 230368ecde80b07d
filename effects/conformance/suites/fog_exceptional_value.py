"""Fog_exceptional_value: fog coordinates that are infinite, no numbers, huge and tiny, through the fog unit.

Source: src/tests/fog_exceptional_value_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import host_matrices, scenes, vertex_programs
from fixedpipe.effects.conformance.case import WIDTH, Case
from fixedpipe.effects.conformance.suites import fog, fog_gen
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.state import Fog, FogRegisters
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

SUITE = "Fog_exceptional_value"

# A program writes the value, or its reciprocal.
PROGRAMS = {
    prefix: vertex_program(
        f"{vertex_programs.PROJECTS} {vertex_programs.COPIES_COLORS} {instruction} o[FOGC], c[120];"
    )
    for prefix, instruction in (("", "MOV"), ("RCP-", "RCP"))
}
# Bit patterns: 0, 1, 10, 100, 1000, -1.24, -10.75; and with both signs infinity, a quiet and a signalling
# NaN, the largest, the least normal, the largest and the least denormal number.
VALUES = (
    *(0x00000000, 0x3F800000, 0x41200000, 0x42C80000, 0x447A0000, 0xBF9EB852, 0xC12C0000),
    *(0x7F800000, 0xFF800000, 0x7FC00000, 0xFFC00000, 0x7F800001, 0xFF800001, 0x7F7FFFFF, 0xFF7FFFFF),
    *(0x00800000, 0x80800000, 0x007FFFFF, 0x807FFFFF, 0x00000001, 0x80000001),
)
PARAMETERS = {"INF-": np.inf, "NaN-": np.nan}  # one value, with every bias and multiplier below
BIASES = (-1.0, 1.0, 1.5, 1000.0)
MULTIPLIERS = (-1 / (200 - 1), -0.025 / (2 * fog.LN_256), -0.025 / (2 * fog.SQRT_LN_256), 1.0, 0.0, -1000.0)
GENERATIONS = {name: g for name, g in fog_gen.GENERATIONS.items() if name != "radial"}

SIZE, TOP, LEFT, SPACING, ROW = 64.0, 70.0, 48.0, 88.0, 102.0
COLORS = ((0.25, 0.5, 0.5, 1.0), (0.25, 0.25, 0.75, 1.0), (0.25, 0.0, 1.0, 1.0), (0.25, 0.75, 0.25, 1.0))
DEPTHS = (0.0, 2.0, 2.0, 0.0)


def _places():
    left, top = LEFT, TOP
    while True:
        yield left, top
        left += SPACING
        if left >= WIDTH - (LEFT + SIZE):
            left, top = LEFT, top + ROW


def _square(place, value, program, state):
    """A Draw of a square at a place, whose fog coordinate is made of ``value``."""
    left, top = place
    x, y, _ = np.transpose(scenes.rectangle(left, top, left + SIZE, top + SIZE))
    _, inverse = host_matrices.programmed()
    constants = {**host_matrices.perspective_constants(), 120: (value, 0.0, 0.0, 0.0)}
    results = program.run({"OPOS": host_matrices.unproject(inverse, x, y, DEPTHS), "COL0": COLORS}, constants)
    return Draw(label="square", mesh=vertex_programs.results_mesh(results), state=state)


def _case(prefix, mode, generation):
    fog_mode, absolute = fog.MODES[mode]

    def state(bias, multiplier):
        registers = FogRegisters(float(bias), float(multiplier), GENERATIONS[generation], absolute=absolute)
        found = Fog(fog_mode, color=scenes.argb(0xDDFF0000), registers=registers)
        return replace(scenes.DEFAULT, register_combiners=fog.combined(), fog=found)

    if prefix in PARAMETERS:
        squares = [(PARAMETERS[prefix], bias, multiplier) for bias in BIASES for multiplier in MULTIPLIERS]
    else:
        line = fog.bias_and_multiplier(fog_mode)
        squares = [(value, *line) for value in scenes.from_patterns(VALUES)]
    program = PROGRAMS.get(prefix, PROGRAMS[""])
    draws = [
        _square(place, value, program, state(bias, multiplier))
        for place, (value, bias, multiplier) in zip(_places(), squares, strict=False)
    ]
    return Case(commands=(scenes.clear(0xFF232623), *draws))


CASES = {
    f"{prefix}FogExc-{mode}-{generation}": partial(_case, prefix, mode, generation)
    for prefix, generation, mode in product((*PROGRAMS, *PARAMETERS), GENERATIONS, fog.MODES)
}
