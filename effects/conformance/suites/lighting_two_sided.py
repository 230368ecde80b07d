"""Lighting_Two_Sided: front and back faces with two-sided lighting (above) and without (below).

Source: src/tests/lighting_two_sided_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import FrontFace, PrimitiveType, SecondaryColor
from fixedpipe.pipeline.state import DepthTest, Light, Lighting, Material, PolygonState

SUITE = "Lighting_Two_Sided"

DEPTH = -1.0
QUADS = {  # two sides, z of the normals, corners
    "front, two sides": (True, 1.0, ((-1.5, 0.1), (-1.25, 1.5), (-0.35, 1.5), (-0.25, 0.1))),
    "back, two sides": (True, -1.0, ((0.25, 0.1), (1.25, 0.1), (1.35, 1.5), (0.1, 1.5))),
    "front, one side": (False, 1.0, ((-1.5, -1.5), (-1.25, -0.1), (-0.35, -0.1), (-0.25, -1.5))),
    "back, one side": (False, -1.0, ((0.25, -1.5), (1.25, -1.5), (1.35, -0.1), (0.1, -0.1))),
}
NO_HIGHLIGHT = (0.0,) * 6  # the program sets no coefficients; the half vector of length 0 leaves no highlight


def _light():
    return Light(
        **lit_scenes.colors(diffuse=(1.0, 0.0, 0.25), specular=(0.0, 1.0, 0.0)),
        position=(0.0, 0.0, 1.0, 0.0),
        half_vector=(0.0, 0.0, 0.0),
        back_ambient=lit_scenes.color((0.0, 0.0, 0.25)),
        back_diffuse=lit_scenes.color((0.0, 0.75, 0.35)),
        back_specular=lit_scenes.color((0.66, 0.0, 0.66)),
    )


def _case():
    white = lit_scenes.WHITE
    front = Material(white, white, white, specular_coefficients=NO_HIGHLIGHT)
    lighting = Lighting(
        lights=(_light(),),
        front=front,
        back=replace(front, diffuse=(1.0, 1.0, 1.0, 0.5)),
        model_ambient=lit_scenes.color((0.031373, 0.031373, 0.031373)),
        back_model_ambient=lit_scenes.BLACK,
        separate_specular_color=True,
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )
    draws = []
    for label, (two_side, normal, corners) in QUADS.items():
        vertex = replace(
            lit_scenes.view(),
            lighting=replace(lighting, two_side=two_side),
            secondary_color=SecondaryColor.DISABLED,
        )
        state = replace(
            scenes.DEFAULT,
            vertex=vertex,
            polygon=PolygonState(front_face=FrontFace.CW),
            depth_test=DepthTest(),
        )
        mesh = Mesh(
            scenes.single([(x, y, DEPTH) for x, y in corners]),
            PrimitiveType.QUADS,
            normals=np.tile((0.0, 0.0, normal), (4, 1)),
        )
        draws.append(Draw(label=label, mesh=mesh, state=state))
    return Case(commands=(scenes.clear(0xFF424243), *draws))


CASES = {"TwoSidedLighting": _case}
