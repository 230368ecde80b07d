"""Lighting_spotlight: a spotlight at the viewer on a plane and a cylinder: falloff (Fo), cones (PT, degrees
of the outer and the inner one) and attenuation (At).

Source: src/tests/lighting_spotlight_tests.cpp of nxdk_pgraph_tests.
"""

from functools import partial

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.state import Lighting, Material

SUITE = "Lighting_spotlight"

FALLOFFS = (
    (0.0, -0.494592, 1.494592),
    (0.0, 1.0, 0.0),
    (-0.000244, 0.500122, 0.499634),
    (-0.170208, -0.855843, 1.685635),
    (-0.706496, -2.507095, 2.800600),
    (-0.932112, -3.097628, 3.165516),
    (-0.986137, -3.165117, 3.178980),
    (-0.993286, -2.953324, 2.960038),
    (-0.996561, -3.084043, 3.087482),
    (0.0, 0.0, 0.0),
)
CONES = ((25.0, 5.0), (25.0, 0.0), (10.0, 25.0), (10.0, 10.0), (0.0, 0.0), (-10.0, -10.0))
ATTENUATIONS = (
    (0.0, 0.0, 0.0),
    (0.5, 0.0, 0.0),
    (1.0, 0.0, 0.0),
    (2.0, 0.0, 0.0),
    (10.0, 0.0, 0.0),
    (0.05, 0.25, 0.0),
    (0.05, 0.0, 0.25),
    (0.05, 0.05, 0.05),
)
FALLOFF, CONE, ATTENUATION = FALLOFFS[3], (30.0, 10.0), (1.0, 0.0, 0.0)
RANGE = 15.0
MODELS = (lit_scenes.GRID, "cylinder")
VERTEX_DIFFUSE, VERTEX_SPECULAR = (1.0, 0.0, 1.0, 1.0), (0.0, 0.4, 0.0, 0.25)
COLORS = lit_scenes.colors(diffuse=(1.0, 0.0, 0.0), specular=(0.0, 0.0, 0.5))

# What each case's name stands for: cone, attenuation, falloff.


def _case(inputs, cone=CONE, attenuation=ATTENUATION, falloff=FALLOFF):
    light = lit_scenes.spotlight(
        (0.0, 0.0, -7.0), (0.0, 0.0, 1.0), RANGE, cone, attenuation, falloff, **COLORS
    )
    white = lit_scenes.WHITE
    lighting = Lighting(
        lights=(light,),
        front=Material(white, (1.0, 1.0, 1.0, 0.4), white, specular_coefficients=lit_scenes.MECH_ASSAULT),
        model_ambient=lit_scenes.color((0.01, 0.01, 0.01)),
        local_viewer=True,
        separate_specular_color=True,
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )
    draws = lit_scenes.model_draws(
        inputs, MODELS, VERTEX_DIFFUSE, VERTEX_SPECULAR, lit_scenes.state(lighting)
    )
    return Case(commands=(scenes.clear(0xFF232623), *scenes.background(0xFF111111, 0xFF000000, 16), *draws))


CASES = {
    **{f"FoFixed_{a:f}_{b:f}_{c:f}": partial(_case, falloff=(a, b, c)) for a, b, c in FALLOFFS},
    **{f"PTFixed_{phi:f}_{theta:f}": partial(_case, cone=(phi, theta)) for phi, theta in CONES},
    **{f"AtFixed_{a:f}_{b:f}_{c:f}": partial(_case, attenuation=(a, b, c)) for a, b, c in ATTENUATIONS},
}
