"""Material_alpha: where a lit colour's alpha comes from: the material, or one of the vertex's colours.

Source: src/tests/material_alpha_tests.cpp of nxdk_pgraph_tests. A name ends in the material's alpha, the hex
word of a float.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ColorSource, SecondaryColor
from fixedpipe.pipeline.state import (
    IDENTITY,
    ColorSources,
    Composite,
    Light,
    Lighting,
    Material,
    VertexState,
)

SUITE = "Material_alpha"

SOURCES = {
    "Mat": ColorSource.MATERIAL,
    "VDiffuse": ColorSource.PRIMARY,
    "VSpec": ColorSource.SECONDARY,
}
ALPHAS = (-1.0, 0.0, 0.05, 0.25, 0.5, 0.75, 1.0, 2.0)
COEFFICIENTS = (-0.965589, -3.148144, 3.182554, -0.932112, -3.097628, 3.165516)
COLORS = lit_scenes.colors(diffuse=(0xEE / 255, 0xBB / 255, 0xAA / 255))
SCENE_AMBIENT = lit_scenes.color((0.0, 0.014517, 0.0))

LEFT, RIGHT, TOP, BOTTOM = -WIDTH // 4, WIDTH // 4, -HEIGHT // 3, HEIGHT // 3
CORNERS = ("ul", "ur", "lr", "ul", "lr", "ll")  # two triangles
QUADS = (  # left, right, z, z of the normals, (diffuse, specular) of every corner
    (
        LEFT + 10,
        10,
        10.0,
        (-1.0, -1.0, -1.0, 1.0, 1.0, 1.0),
        {
            "ul": ((0.4, 0.1, 0.1, 0.25), (0.0, 1.0, 0.0, 0.5)),
            "ll": ((0.0, 1.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.1)),
            "lr": ((0.0, 0.0, 1.0, 1.0), (1.0, 1.0, 0.0, 0.5)),
            "ur": ((0.5, 0.5, 0.5, 1.0), (0.0, 1.0, 1.0, 0.75)),
        },
    ),
    (
        -10,
        RIGHT - 10,
        9.75,
        (1.0, 1.0, 1.0, 1.0, 1.0, 1.0),
        {
            "ul": ((1.0, 1.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.25)),
            "ll": ((0.5, 0.5, 0.5, 1.0), (0.3, 0.3, 1.0, 1.0)),
            "lr": ((1.0, 0.0, 0.0, 0.75), (0.95, 0.5, 0.8, 0.05)),
            "ur": ((0.0, 0.3, 0.8, 0.15), (0.9, 0.9, 0.4, 0.33)),
        },
    ),
)


def _mesh():
    positions, normals, diffuse, specular = [], [], [], []
    for left, right, z, up, colors in QUADS:
        at = {
            "ul": (left, TOP + 4),
            "ur": (right, TOP + 4),
            "lr": (right, BOTTOM - 10),
            "ll": (left, BOTTOM - 10),
        }
        positions += [(*at[corner], z) for corner in CORNERS]
        normals += [(0.0, 0.0, n) for n in up]
        diffuse += [colors[corner][0] for corner in CORNERS]
        specular += [colors[corner][1] for corner in CORNERS]
    return Mesh(
        scenes.single(positions),
        normals=scenes.single(normals),
        colors=scenes.single(diffuse),
        secondary_colors=scenes.single(specular),
    )


def _case(source, alpha):
    white = lit_scenes.WHITE
    lighting = Lighting(
        lights=(Light(position=(0.0, 0.0, 1.0, 0.0), half_vector=(0.0, 0.0, 0.0), **COLORS),),
        front=Material(white, (1.0, 1.0, 1.0, alpha), white, specular_coefficients=COEFFICIENTS),
        model_ambient=SCENE_AMBIENT,
        local_viewer=True,
        separate_specular_color=True,
        front_sources=ColorSources(diffuse=source),
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )
    state = replace(
        scenes.DEFAULT,
        vertex=VertexState(composite=COMPOSITE, lighting=lighting, secondary_color=SecondaryColor.OPAQUE),
        polygon=scenes.FRONT_FACES,
    )
    return Case(commands=(scenes.clear(0xFF303030), Draw(label="two quads", mesh=_mesh(), state=state)))


# Both matrices are the unit matrix, so device pixels come from the viewport's offset alone: the middle of the
# screen.
COMPOSITE = Composite(IDENTITY, (WIDTH / 2, HEIGHT / 2, 0.0))


CASES = {
    f"MatA_S{name}_A{np.float32(alpha).view(np.uint32):X}": partial(_case, source, alpha)
    for name, source in SOURCES.items()
    for alpha in ALPHAS
}
