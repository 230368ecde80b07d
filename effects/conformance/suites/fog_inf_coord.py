"""Fog_inf_coord: the triangles of the suite Fog with an infinite fog coordinate (1/0 in a vertex program).

Source: src/tests/fog_tests.cpp of nxdk_pgraph_tests (FogInfiniteFogCoordinateTests).
"""

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import fog, fog_vsh

SUITE = "Fog_inf_coord"


def names():
    """Every case of the suite."""
    return fog.names()


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in names():
        return None
    draw = fog_vsh.triangles(
        np.full(12, np.inf), register_combiners=fog.combined(), fog=fog.fog_of(fog.mode_of(name))
    )
    return Case(commands=(scenes.clear(0xFF303030), draw))
