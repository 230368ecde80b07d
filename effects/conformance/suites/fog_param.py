"""Fog_param: small squares of growing fog coordinates under many multipliers, and of growing biases.

Source: src/tests/fog_param_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import host_matrices, scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.effects.conformance.suites import fog
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import FogGeneration, FogMode, PrimitiveType
from fixedpipe.pipeline.state import Fog, FogRegisters

SUITE = "Fog_param"

# By name: the mode, whether it takes a magnitude, and the bias that leaves no fog.
MODES = {
    "lin": (FogMode.LINEAR, False, 2.0),
    "exp": (FogMode.EXP, False, 1.51),
    "exp2": (FogMode.EXP2, False, 1.5),
    "exp_abs": (FogMode.EXP, True, 1.5075),
    "exp2_abs": (FogMode.EXP2, True, 1.5),
    "lin_abs": (FogMode.LINEAR, True, 2.0),
}
MULTIPLIERS = (1.0, 2.0, -1.0, -2.0, 0.5, -0.5, -0.25, 0.25)
SIZE = 24.0
COORDINATES = (-1.4, 0.01)  # the first square's, and how much each further one has more
BIASES = (1.0, 0.005)


def _squares(left, top, spacing, first, step):
    """The upper left corner of every square, and a number that grows in single precision."""
    x, number = left, np.float32(first)
    while top < HEIGHT - SIZE:
        yield x, top, number
        x += SIZE + spacing
        if x >= WIDTH - (left + SIZE):
            x, top = left, top + SIZE + 1
        number = number + np.float32(step)


def _corners(left, top, depths):
    _, inverse = host_matrices.fixed_function()
    x, y, _ = np.transpose(scenes.rectangle(left, top, left + SIZE, top + SIZE))
    return host_matrices.unproject(inverse, x, y, depths)


def _draw(positions, coordinates, color, mode, bias, multiplier):
    fog_mode, absolute, _ = MODES[mode]
    registers = FogRegisters(
        float(np.float32(bias)), multiplier, FogGeneration.FOG_COORDINATE, absolute=absolute
    )
    state = replace(
        scenes.DEFAULT,
        vertex=host_matrices.xdk_vertex(),
        register_combiners=fog.combined(),
        fog=Fog(fog_mode, color=(1.0, 0.0, 0.0, 1.0), registers=registers),
    )
    colors = np.tile(color, (len(positions), 1))
    mesh = Mesh(positions, PrimitiveType.QUADS, colors=colors, fog_coordinates=coordinates)
    return Draw(label="squares", mesh=mesh, state=state)


def _case(mode, multiplier):
    if multiplier is None:
        draws = [
            _draw(_corners(left, top, (1.0,) * 4), [-1.0] * 4, (0.0, 0.5, 0.5, 1.0), mode, bias, 0.0)
            for left, top, bias in _squares(48.0, 46.0, 2.0, *BIASES)
        ]
    else:
        squares = list(_squares(60.0, 70.0, 1.0, *COORDINATES))
        positions = np.concatenate([_corners(left, top, (0.0, 1.0, 1.0, 0.0)) for left, top, _ in squares])
        coordinates = np.repeat([coordinate for *_, coordinate in squares], 4)
        draws = [_draw(positions, coordinates, (0.0, 0.0, 1.0, 1.0), mode, MODES[mode][2], multiplier)]
    return Case(commands=(scenes.clear(0xFF231F23), *draws))


CASES = {
    f"FogParam{multiplier:.2f}-{mode}": partial(_case, mode, multiplier)
    for mode in MODES
    for multiplier in MULTIPLIERS
} | {f"FogZeroBias-{mode}": partial(_case, mode, None) for mode in MODES}
