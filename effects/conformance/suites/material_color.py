"""Material_color: a quad, half of it turned away from the light; the program multiplies its colours as a
driver does.

A name lists colours in this order: the ambient colour of the scene, the material and the light; the
material's diffuse, specular and emissive colour; the light's diffuse and specular colour. Source:
src/tests/material_color_tests.cpp of nxdk_pgraph_tests.
"""

from functools import partial

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites.material_color_source import COEFFICIENTS
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import SecondaryColor
from fixedpipe.pipeline.state import Light, Lighting, Material

SUITE = "Material_color"

COLORS = {
    **{"R": (1.0, 0.0, 0.0), "r": (0.5, 0.0, 0.0), "G": (0.0, 1.0, 0.0), "g": (0.0, 0.5, 0.0)},
    **{"B": (0.0, 0.0, 1.0), "b": (0.0, 0.0, 0.5)},
    **{"0": (0.0,) * 3, "1": (1.0,) * 3, "3": (0.33,) * 3},
}
LEFT, TOP, RIGHT, BOTTOM = -2.75, 1.75, 2.75, -1.75  # of the quad, in the world
CORNERS = [(LEFT, TOP), (RIGHT, TOP), (RIGHT, BOTTOM), (LEFT, TOP), (RIGHT, BOTTOM), (LEFT, BOTTOM)]


def _case(letters):
    scene, own_ambient, ambient, own_diffuse, own_specular, emission, diffuse, specular = (
        scenes.single(COLORS[letter]) for letter in letters
    )
    colors = lit_scenes.colors(scene * ambient, own_diffuse * diffuse, own_specular * specular)
    light = Light(position=(0.0, 0.0, 1.0, 0.0), half_vector=(0.0, 0.0, 0.0), **colors)
    white = lit_scenes.WHITE
    lighting = Lighting(
        lights=(light,),
        front=Material(white, white, white, specular_coefficients=COEFFICIENTS),
        model_ambient=lit_scenes.color(scenes.single(scene * own_ambient) + emission),
        local_viewer=True,
        separate_specular_color=True,
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )
    normals = np.repeat([(0.0, 0.0, -1.0), (0.0, 0.0, 1.0)], 3, axis=0)
    mesh = Mesh(scenes.single([(x, y, 0.0) for x, y in CORNERS]), normals=normals)
    state = lit_scenes.state(lighting, secondary_color=SecondaryColor.OPAQUE)
    return Case(commands=(scenes.clear(0xFF303030), Draw(label="a quad", mesh=mesh, state=state)))


_LETTERS = ("001_RG0_11", "011_rG0_B1", "011_rBg_11", "301_rG0_11", "310_rG0_11", "311_rG0_11")
CASES = {name: partial(_case, name.replace("_", "")) for name in _LETTERS}
