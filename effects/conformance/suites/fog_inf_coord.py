"""Fog_inf_coord: the triangles of the suite Fog with an infinite fog coordinate (1/0 in a vertex program).

Source: src/tests/fog_tests.cpp of nxdk_pgraph_tests (FogInfiniteFogCoordinateTests).
"""

from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import fog, fog_vsh

SUITE = "Fog_inf_coord"


def _case(mode):
    draw = fog_vsh.triangles(np.full(12, np.inf), register_combiners=fog.combined(), fog=fog.fog_of(mode))
    return Case(commands=(scenes.clear(0xFF303030), draw))


CASES = {f"AFF-{mode}-planar": partial(_case, mode) for mode in fog.MODES}
