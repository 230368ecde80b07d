"""Lighting_control: five models under a directional and a point light, through every combination of separate
specular colour, local viewer, the secondary colour's alpha and whether there is a secondary colour.

Source: src/tests/lighting_control_tests.cpp of nxdk_pgraph_tests. FF: the fixed-function stage; VS: a vertex
program that lights by itself (src/shaders/fixed_function_approximation_shader.vsh).
"""

from dataclasses import replace
from itertools import product

from effects.conformance import lit_scenes, scenes
from effects.conformance.case import Case
from pipeline.commands import Draw
from pipeline.enums import Face, FrontFace, SecondaryColor
from pipeline.state import Lighting, Material, PolygonState

SUITE = "Lighting_control"

SEPARATE_SPECULAR, LOCAL_EYE, ALPHA = 0x000001, 0x010000, 0x020000
SCENE_AMBIENT = lit_scenes.color((0.031373, 0.031373, 0.031373))
MATERIAL_ALPHA = 0.4
VERTEX_DIFFUSE, VERTEX_SPECULAR = (0.0, 0.0, 0.0, 0.75), (0.0, 0.4, 0.0, 0.25)
COLORS = lit_scenes.colors((0.0, 0.0, 0.05), (0.25, 0.0, 0.0), (0.0, 0.2, 0.4))


def names():
    """Every case of the suite."""
    flags = product(("", "NoSpec"), (0, ALPHA), (0, LOCAL_EYE), (0, SEPARATE_SPECULAR))
    return [
        f"{stage}_0x{alpha + eye + separate:06X}{specular}{'' if stage == 'FF' else '_LightOff'}"
        for specular, alpha, eye, separate in flags
        for stage in ("FF", "VS")
    ]


def _lights():
    along = lit_scenes.unit((1.0, 0.0, 1.0))
    point = lit_scenes.point((1.5, 1.0, -2.5), 4.0, (0.025, 0.15, 0.02), **COLORS)
    return lit_scenes.directional(along, **COLORS), point


def lighting(control):
    """Lighting as LIGHT_CONTROL asks for it."""
    return Lighting(
        lights=_lights(),
        front=Material(
            lit_scenes.WHITE,
            (1.0, 1.0, 1.0, MATERIAL_ALPHA),
            lit_scenes.WHITE,
            specular_coefficients=lit_scenes.MECH_ASSAULT,
        ),
        model_ambient=SCENE_AMBIENT,
        local_viewer=bool(control & LOCAL_EYE),
        separate_specular_color=bool(control & SEPARATE_SPECULAR),
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )


def case(name, inputs):
    """The case of that name, or None."""
    if name not in names():
        return None
    control = int(name[3:11], 16)
    if "NoSpec" in name:
        secondary = SecondaryColor.DISABLED
    else:
        secondary = SecondaryColor.FROM_VERTEX if control & ALPHA else SecondaryColor.OPAQUE
    state = replace(
        scenes.DEFAULT,
        vertex=replace(lit_scenes.view(), lighting=lighting(control), secondary_color=secondary),
        register_combiners=lit_scenes.sum_of_colors(),
        polygon=PolygonState(cull_face=Face.BACK, front_face=FrontFace.CW),
    )
    draws = [
        Draw(
            label=model,
            mesh=lit_scenes.model(inputs, model).mesh(VERTEX_DIFFUSE, VERTEX_SPECULAR),
            state=state,
        )
        for model in lit_scenes.MODELS
    ]
    return Case(
        commands=(scenes.clear(0xFF232623), *scenes.background(0xFF202020, 0xFF000000, 24), *draws),
    )
