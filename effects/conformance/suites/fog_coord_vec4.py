"""Fog_coord_vec4: the component of o[FOGC] that is the fog coordinate, for several ways to write it.

Measured: an instruction stores the first component that its write mask enables, in the order x, y, z, w. Of
several instructions the last one counts. Without a write, the previous value stays (40 captures). Source:
src/tests/fog_tests.cpp of nxdk_pgraph_tests (FogVec4CoordTests).
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import fog, fog_vsh
from fixedpipe.pipeline.enums import FogMode, Register
from fixedpipe.pipeline.state import CombinerInput, Fog, FogRegisters

SUITE = "Fog_coord_vec4"

# By write masks, one instruction after the other: the values of x, y, z, w that the program is given.
VALUES = {
    "W": ((0, 0.25, 0, 0), (0.5, 0.5, 0, 0), (1, 0, 0, 0.5), (0.3, 0.3, 0.3, 1)),
    "W_X": ((0.25, 0, 0, 0.5), (0.65, 0, 0, 0)),
    "W_Y": ((1, 0, 1, 0.75), (0, 0.75, 0.75, 0.25)),
    "W_Z_Y_X": ((0.25, 0.5, 0.75, 1), (1, 0.75, 0.5, 0.25)),
    "X": ((0, 0, 0, 0), (0.9, 0, 0, 0)),
    "X_Y_Z_W": ((1, 0.25, 0.75, 0.5), (0, 0.33, 0.66, 0.9)),
    "Y": ((0, 0, 0, 0), (0, 0.1, 0, 0), (0, 0.6, 0, 0)),
    "Z": ((0, 0, 0, 0), (0, 0, 0.2, 0), (0, 0, 0.8, 0)),
    "XW": ((0.25, 0, 0, 0.5), (0.65, 0, 0, 0)),
    "XY": ((0.25, 0.5, 0, 0), (0.65, 0.75, 0, 0)),
    "XYZ": ((0.25, 0.5, 0.75, 0), (0.65, 0.75, 0.33, 0)),
    "XYZW": ((0.25, 0.5, 0.75, 1), (0.65, 0.75, 0.33, 0)),
    "XZ": ((0.25, 0, 0.75, 0), (0.65, 0, 0.33, 0)),
    "XZW": ((0.25, 0, 0.75, 1), (0.65, 0, 0.33, 0)),
    "YW": ((0, 0.5, 0, 1), (0, 0.75, 0, 0)),
    "YZ": ((0, 0.5, 0.75, 0), (0, 0.75, 0.33, 0)),
    "YZW": ((0, 0.5, 0.75, 1), (0, 0.75, 0.33, 0)),
    "ZW": ((0, 0, 0.75, 1), (0, 0, 0.33, 0)),
}
GREEN = (0.0, 1.0, 0.0, 0.0)
FOG = Fog(
    FogMode.LINEAR, color=GREEN, registers=FogRegisters(bias=1.0, multiplier=1.0)
)  # the coordinate itself


def _frame(background, coordinate, b, constant=(0.0, 0.0, 0.0, 0.0)):
    combiners = fog.combined(b=CombinerInput(b), c=CombinerInput(Register.PRIMARY_COLOR))
    combiners = replace(combiners, constant_color0=constant)
    draw = fog_vsh.triangles(scenes.single(np.full(12, coordinate)), register_combiners=combiners, fog=FOG)
    return Case(commands=(scenes.clear(background), draw))


def _written(masks, values):
    return _frame(0xFF303030, values["XYZW".index(masks.split("_")[-1][0])], Register.FOG)


CASES = {
    f"{masks}-" + "_".join(f"{v:.2f}" for v in values): partial(_written, masks, values)
    for masks, given in VALUES.items()
    for values in given
} | {
    # The program before wrote (0.25, 0.95, 0.5, 0.75).
    "CoordNotSet": partial(
        _frame, 0xFF341010, 0.25, Register.CONSTANT_COLOR0, (127 / 255, 0.0, 191 / 255, 1.0)
    ),
}
