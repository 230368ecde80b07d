"""Lighting_accumulation: a plane under two to five equal lights, or one of each kind.

Source: src/tests/lighting_accumulation_tests.cpp of nxdk_pgraph_tests.
"""

from functools import partial

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.enums import SecondaryColor
from fixedpipe.pipeline.state import Lighting, Material

SUITE = "Lighting_accumulation"

DIRECTION, POSITION, RANGE = (0.0, 0.0, 1.0), (0.0, 0.0, -2.0), 3.0
ATTENUATION = (1.0, 0.0, 0.0)
COLORS = lit_scenes.colors((0.0, 0.1, 0.0), (0.2, 0.0, 0.0), (0.0, 0.0, 0.2))
LIGHTS = {
    "Directional": lit_scenes.directional(DIRECTION, **COLORS),
    "Point": lit_scenes.point(POSITION, RANGE, ATTENUATION, **COLORS),
    "Spot": lit_scenes.spotlight(
        POSITION, DIRECTION, RANGE, (45.0, 10.0), ATTENUATION, (0.0, -0.494592, 1.494592), **COLORS
    ),
}
VERTEX_DIFFUSE, VERTEX_SPECULAR = (0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 0.25)


def _case(lights, inputs):
    white = lit_scenes.WHITE
    lighting = Lighting(
        lights=lights,
        front=Material(white, white, white, specular_coefficients=lit_scenes.COEFFICIENTS["Pow2_0"]),
        model_ambient=lit_scenes.BLACK,
        separate_specular_color=True,
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )
    state = lit_scenes.state(lighting, secondary_color=SecondaryColor.FROM_VERTEX)
    draws = lit_scenes.model_draws(inputs, (lit_scenes.GRID,), VERTEX_DIFFUSE, VERTEX_SPECULAR, state)
    background = scenes.background(0xFF202020, 0xFF909090, 24)
    return Case(commands=(scenes.clear(0xFF232623), *background, *draws))


CASES = {
    f"{kind}-{count}": partial(_case, (light,) * count)
    for kind, light in LIGHTS.items()
    for count in (2, 4, 5)
} | {"All": partial(_case, tuple(LIGHTS.values()))}
