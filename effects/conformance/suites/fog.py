"""Fog: four white triangles at growing distances in every fog mode, through the fixed-function stage.

Source: src/tests/fog_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ComponentUsage, FogMode, PrimitiveType, Register
from fixedpipe.pipeline.state import CombinerInput, DepthClamp, Fog, FogRegisters

SUITE = "Fog"

START, END, DENSITY = 1.0, 200.0, 0.025
LN_256, SQRT_LN_256 = 5.5452, 2.3548  # as the programs have them
MODES = {
    "linear": (FogMode.LINEAR, False),
    "exp": (FogMode.EXP, False),
    "exp2": (FogMode.EXP2, False),
    "exp_abs": (FogMode.EXP, True),
    "exp2_abs": (FogMode.EXP2, True),
    "linear_abs": (FogMode.LINEAR, True),
}
TRIANGLES = (
    ((-1.5, -1.5, 0.0), (-2.5, 0.6, 0.0), (-0.5, 0.6, 0.0)),
    ((0.0, -1.5, 5.0), (-1.0, 0.75, 10.0), (2.0, 0.75, 20.0)),
    ((5.0, -2.0, 30.0), (3.0, 2.0, 40.0), (12.0, 2.0, 70.0)),
    ((20.0, -10.0, 50.0), (12.0, 10.0, 125.0), (80.0, 10.0, 200.0)),
)

_FACTOR = CombinerInput(Register.FOG, usage=ComponentUsage.ALPHA)
_PRIMARY = CombinerInput(Register.PRIMARY_COLOR)


ON_A_STEP = (
    "one pixel within 4e-4 of a step of the fog factor: in how many bits the chip iterates it is not known"
)


def explanation(mode):
    """Why pixels may differ: LINEAR fog is not rounded for each vertex, so its steps may touch a pixel."""
    return ON_A_STEP if mode.startswith("linear") else ""


def bias_and_multiplier(mode, start=START, end=END):
    """SET_FOG_PARAMS as the programs compute them, in single precision."""
    single = np.float32
    if mode == FogMode.LINEAR:
        multiplier = single(-1.0) / (single(end) - single(start))
        return float(single(1.0) - single(end) * multiplier), float(multiplier)
    divisor = single(2.0) * single(LN_256 if mode == FogMode.EXP else SQRT_LN_256)
    return 1.5, float(-single(DENSITY) / divisor)


def fog_of(name, **registers):
    """The fog of a mode by name, with a colour of reddish purple."""
    mode, absolute = MODES[name]
    bias, multiplier = bias_and_multiplier(mode)
    found = FogRegisters(bias, multiplier, absolute=absolute, **registers)
    return Fog(mode, color=scenes.argb(0xFF30207F), registers=found)


def combined(b=_PRIMARY, c=_FACTOR, alpha=_PRIMARY):
    """Combiners whose result is the fog factor times b plus its complement times c."""
    final = replace(
        scenes.SHOWS_PRIMARY.final,
        a=_FACTOR,
        b=b,
        c=replace(c, usage=ComponentUsage.RGB),
        d=CombinerInput(),
        g=replace(alpha, usage=ComponentUsage.ALPHA),
    )
    return replace(scenes.SHOWS_PRIMARY, final=final)


def _case(mode):
    mesh = Mesh(np.array(TRIANGLES).reshape(-1, 3), PrimitiveType.TRIANGLES)
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.xdk_vertex(near=START, far=END),
        register_combiners=combined(),
        fog=fog_of(mode),
        depth_clamp=DepthClamp(cull=True),
    )
    commands = (scenes.clear(0xFF303030), Draw(label="triangles", mesh=mesh, state=state))
    return Case(commands=commands, explanation=explanation(mode))


CASES = {f"AFF-{mode}-planar": partial(_case, mode) for mode in MODES}
