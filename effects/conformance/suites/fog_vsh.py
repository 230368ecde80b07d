"""Fog_vsh: the triangles of the suite Fog through a vertex program, whose fog coordinate is w.

Source: src/tests/fog_tests.cpp of nxdk_pgraph_tests (FogCustomShaderTests).
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import fog
from fixedpipe.effects.conformance.vertex_programs import perspective
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType

SUITE = "Fog_vsh"


def triangles(coordinates=None, **state):
    """The Draw of the four triangles with these fog coordinates, [12], or w."""
    window = perspective(np.array(fog.TRIANGLES).reshape(-1, 3))
    coordinates = window[:, 3] if coordinates is None else coordinates
    mesh = scenes.window_mesh(window, PrimitiveType.TRIANGLES, fog_coordinates=coordinates)
    return Draw(label="triangles", mesh=mesh, state=replace(scenes.DEFAULT, **state))


def _case(mode):
    draw = triangles(register_combiners=fog.combined(), fog=fog.fog_of(mode))
    return Case(commands=(scenes.clear(0xFF303030), draw), explanation=fog.explanation(mode))


CASES = {f"AFF-{mode}-planar": partial(_case, mode) for mode in fog.MODES}
