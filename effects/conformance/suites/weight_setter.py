"""Weight_setter: squares whose colour is the vertex weight, set by one, two, three or four numbers.

Source: src/tests/weight_setter_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program

SUITE = "Weight_setter"

PROGRAM = vertex_program("MOV o[HPOS], v[OPOS]; MOV o[COL0], v[WGHT];")
WEIGHTS = ((0.25, 0.5, 1.0, 0.75), (0.5, 0.25, 0.75), (0.75, 0.5), (0.25,))
LEFT, TOP, WIDTH, HEIGHT, SPACING = 146.0, 96.0, 100.0, 24.0, 50.0  # pixels


def _case():
    draws = []
    for number, weight in enumerate(WEIGHTS):
        top = TOP + number * SPACING
        for left, shows in ((LEFT, scenes.SHOWS_PRIMARY), (2 * LEFT, scenes.SHOWS_PRIMARY_OPAQUE)):
            corners = np.array(scenes.rectangle(left, top, left + WIDTH, top + HEIGHT))
            mesh = vertex_programs.results_mesh(PROGRAM.run({"OPOS": corners, "WGHT": weight}))
            state = replace(scenes.DEFAULT, register_combiners=shows)
            draws.append(Draw(label="square", mesh=mesh, state=state))
    return Case(commands=(scenes.clear(0xFF202020), *draws))


CASES = {"WeightSetter": _case}
