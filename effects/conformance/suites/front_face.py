"""Front_face: windings, culled faces, and vertices whose w is infinite or zero, filled and as outlines.

Source: src/tests/front_face_tests.cpp of nxdk_pgraph_tests. An unknown winding leaves the clockwise one that
was set before. The names with FM_ and LM_ are those of later captures; the earlier ones' program has no
triangles without area, and its vertices have no w (Measured: colours are linear on the screen).
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import Face, FrontFace, PolygonMode, PrimitiveType
from fixedpipe.pipeline.state import PolygonState

SUITE = "Front_face"

MODES = {"FM_": PolygonMode.FILL, "LM_": PolygonMode.LINE}
WINDINGS = {"CW": FrontFace.CW, "CCW": FrontFace.CCW, "0x00": FrontFace.CW, "0x63": FrontFace.CW}
FACES = {"F": Face.FRONT, "B": Face.BACK, "FaB": Face.FRONT_AND_BACK}

INFINITE = 2.0**64  # whose reciprocal is the chip's smallest, as an infinite w's is
LEFT, MIDDLE, RIGHT, TOP, BOTTOM, CENTER = 138.0, 320.0, 502.0, 44.0, 430.0, 237.0
RED, GREEN, BLUE, GREY = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.5, 0.5, 0.5)

# Columns x, y, w and colour: a counter-clockwise pair of triangles, a clockwise one, and two without area.
PAIRS = (
    *((LEFT, TOP, INFINITE, RED), (310.0, BOTTOM, 0.980578, BLUE), (310.0, TOP, 0.0, GREY)),
    *((LEFT, TOP, INFINITE, RED), (LEFT, BOTTOM, INFINITE, GREEN), (310.0, BOTTOM, INFINITE, BLUE)),
    *((330.0, TOP, 1.0, BLUE), (RIGHT, TOP, 1.0, GREEN), (RIGHT, BOTTOM, 1.0, RED)),
    *((330.0, TOP, 1.0, BLUE), (RIGHT, BOTTOM, 1.0, RED), (330.0, BOTTOM, 1.0, GREY)),
)
FLAT = (
    *((133.0, TOP, 1.0, RED), (133.0, CENTER, 1.0, BLUE), (133.0, BOTTOM, 1.0, GREEN)),
    *((507.0, TOP, 1.0, BLUE), (507.0, BOTTOM, 1.0, GREY), (507.0, CENTER, 1.0, RED)),
)


def _case(mode, winding, face):
    vertices = PAIRS if mode == "" else (*PAIRS[:6], *FLAT[:3], *PAIRS[6:], *FLAT[3:])
    positions = [(x, y, 10.0, w if mode else 1.0) for x, y, w, _ in vertices]
    mesh = scenes.window_mesh(
        positions, PrimitiveType.TRIANGLES, colors=np.array([color for *_, color in vertices])
    )
    drawn = MODES.get(mode, PolygonMode.FILL)
    polygon = PolygonState(cull_face=face, front_face=winding, front_mode=drawn, back_mode=drawn)
    state = replace(scenes.DEFAULT, polygon=polygon)
    return Case(commands=(scenes.clear(0xFF000000), Draw(label="faces", mesh=mesh, state=state)))


CASES = {
    f"FrontFace_{mode}{winding}_CF_{face}": partial(_case, mode, WINDINGS[winding], FACES[face])
    for mode, winding, face in product(("", *MODES), WINDINGS, FACES)
}
