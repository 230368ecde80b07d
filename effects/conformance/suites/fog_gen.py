"""Fog_gen: small squares whose fog coordinate comes from every source, in every fog mode.

Source: src/tests/fog_gen_tests.cpp of nxdk_pgraph_tests.
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

SUITE = "Fog_gen"
OPEN = "the last bits of the distance from the eye"

GENERATIONS = {
    "spec_alpha": FogGeneration.SECONDARY_ALPHA,
    "radial": FogGeneration.RADIAL,
    "planar": FogGeneration.PLANAR,
    "abs_planar": FogGeneration.ABSOLUTE_PLANAR,
    "fog_x": FogGeneration.FOG_COORDINATE,
}
START, END = 0.0, 200.0
PLANE = (0.0, 0.0, 2.0, 0.0)
SPECULAR_ALPHA = (0.0, 1.0, 0.75, 0.25)  # upper left, upper right, lower right, lower left
SIZE, SPACING, LEFT, TOP = 22.0, 24.0, 48.0, 70.0


def _squares():
    """Every square's left and top edge, depth on the left, and fog coordinate, in single precision."""
    left, top, z, coordinate = LEFT, TOP, -6.0, np.float32(50.0)
    while top < HEIGHT - SIZE:
        yield left, top, z, float(coordinate)
        left += SPACING
        if left >= WIDTH - (LEFT + SIZE):
            left, top = LEFT, top + SPACING
        z, coordinate = z + 0.5, coordinate - np.float32(0.2)


def _corners():
    """Device x, y and world depth of every square's corners, in order: upper left, upper right, lower right,
    lower left.
    """
    for left, top, z, _ in _squares():
        yield left, top, z
        yield left + SIZE, top, z + 1
        yield left + SIZE, top + SIZE, z + 1
        yield left, top + SIZE, z


def _radius_left_behind(world):
    """The distance from the eye of the last vertex of the cases before, all through the fixed functions.

    Measured: RADIAL fog of a vertex program is the same at every vertex, between 204.5 and 222 (3 captures);
    Inferred: the unit that measures distances keeps the last one it was given.
    """
    x, y, z = world.astype(np.float64)
    return float(np.sqrt(x * x + y * y + (z + scenes.XDK_EYE) ** 2))


def _mesh(programmed, generation):
    corners = np.array(list(_corners()))
    coordinates = np.repeat([coordinate for *_, coordinate in _squares()], 4)
    _, inverse = host_matrices.fixed_function()
    world = host_matrices.unproject(inverse, *corners.T)
    if programmed and generation == FogGeneration.RADIAL:
        coordinates = np.full(len(corners), _radius_left_behind(world[-1]))
    secondary = np.zeros((len(corners), 4))
    secondary[:, 3] = np.tile(SPECULAR_ALPHA, len(corners) // 4)
    arrays = {
        "colors": np.tile((0.0, 0.0, 1.0, 1.0), (len(corners), 1)),
        "secondary_colors": secondary,
        "fog_coordinates": coordinates,
    }
    if programmed:
        corners = np.concatenate(
            [corners[:, :2], np.zeros((len(corners), 1)), corners[:, 2:] + scenes.XDK_EYE], 1
        )
        return scenes.window_mesh(corners, **arrays)
    return Mesh(world, PrimitiveType.QUADS, **arrays)


def _registers(mode, absolute, generation, programmed):
    if programmed or generation != FogGeneration.SECONDARY_ALPHA:
        bias, multiplier = fog.bias_and_multiplier(mode, START, END)
    else:
        bias, multiplier = {
            FogMode.LINEAR: (0.0, 2.0),
            FogMode.EXP: (0.5, 1 / 16),
            FogMode.EXP2: (0.5, float(np.sqrt(np.float32(1 / 32)))),
        }[mode]
    return FogRegisters(bias, multiplier, generation, PLANE, absolute)


def _case(programmed, mode, absolute, generation):
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.PROGRAM_RESULTS if programmed else host_matrices.xdk_vertex(),
        register_combiners=fog.combined(),
        fog=Fog(
            mode,
            color=scenes.argb(0xDDFF0000),
            registers=_registers(mode, absolute, generation, programmed),
        ),
    )
    draw = Draw(label="squares", mesh=_mesh(programmed, generation), state=state)
    return Case(commands=(scenes.clear(0xFF232623), draw))


CASES = {
    f"FogGen_{stage}-{mode}-{name}": partial(_case, stage == "VS", *fog.MODES[mode], generation)
    for stage in ("VS", "FF")
    for name, generation in GENERATIONS.items()
    for mode in fog.MODES
}
