"""Lighting_normals: a triangle without normals after one whose last vertex has one: the last normal stays.

Source: src/tests/lighting_normal_tests.cpp of nxdk_pgraph_tests. The suffix names how the vertices were sent,
which changes nothing but their order.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import SecondaryColor
from fixedpipe.pipeline.state import Light, Lighting, Material

SUITE = "Lighting_normals"

NORMALS = {  # None: no normal was ever sent, and the suite's own (0, 0, 0) stays
    "NoNormal": None,
    "Nz_100": (0.0, 0.0, 1.0),
    "Nz_-100": (0.0, 0.0, -1.0),
    "Nz_0": (1.0, 0.0, 0.0),
    "Nz_70": (0.7071067811865475, 0.0, 0.7071067811865475),
    "Nz_31": (0.9486832980505138, 0.0, 0.31622776601683794),
    "Nz_97": (0.24253562503633297, 0.0, 0.9701425001453319),
}
SENT = ("", "-inlinebuf", "-inlinearrays", "-inlineelements")
LEFT, RIGHT, TOP, BOTTOM = -2.75, 2.75, 1.75, -1.75
COLORS = lit_scenes.colors(diffuse=(0.0, 1.0, 0.7))
COEFFICIENTS = (-0.706496, -2.507095, 2.8006, -0.500825, -1.940022, 2.439197)


def _triangle(left, right, z, normals, order=(0, 1, 2)):
    corners = [(left, TOP, z), (right, TOP, z), ((left + right) / 2, BOTTOM, z)]
    return Mesh(
        scenes.single([corners[i] for i in order]), normals=scenes.single([normals[i] for i in order])
    )


def _case(normal, elements):
    light = Light(position=(0.0, 0.0, 1.0, 0.0), half_vector=(0.0, 0.0, 0.0), **COLORS)
    lighting = Lighting(
        lights=(light,),
        front=Material(
            diffuse=lit_scenes.WHITE, specular=lit_scenes.WHITE, specular_coefficients=COEFFICIENTS
        ),
        model_ambient=lit_scenes.BLACK,
        separate_specular_color=True,
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )
    state = lit_scenes.state(lighting, scenes.SHOWS_PRIMARY)
    commands = [scenes.clear(0xFF303030)]
    zero = (0.0, 0.0, 0.0)
    if normal is not None:
        mesh = _triangle(LEFT, 0.0, 3.0, (zero, zero, normal))
        commands.append(Draw(label="leaves its last normal", mesh=mesh, state=state))
    order = (2, 0, 1) if elements else (0, 1, 2)
    mesh = _triangle(0.0, RIGHT, 1.0, np.tile(zero if normal is None else normal, (3, 1)), order)
    local = replace(lighting, local_viewer=True)
    vertex = replace(state.vertex, lighting=local, secondary_color=SecondaryColor.OPAQUE)
    commands.append(Draw(label="without normals", mesh=mesh, state=replace(state, vertex=vertex)))
    return Case(commands=tuple(commands))


CASES = {
    name + sent: partial(_case, normal, sent == "-inlineelements")
    for sent in SENT
    for name, normal in NORMALS.items()
}
