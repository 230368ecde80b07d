"""Lighting_control: five models under a directional and a point light, through every combination of separate
specular colour, local viewer, the secondary colour's alpha and whether there is a secondary colour.

Source: src/tests/lighting_control_tests.cpp of nxdk_pgraph_tests. FF: the fixed-function stage; VS: a vertex
program that lights by itself (src/shaders/fixed_function_approximation_shader.vsh).
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes, vertex_programs
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import PrimitiveType, SecondaryColor
from fixedpipe.pipeline.state import Lighting, Material
from fixedpipe.pipeline.vertices.transform_tables import lit_power

SUITE = "Lighting_control"

SEPARATE_SPECULAR, LOCAL_EYE, ALPHA = 0x000001, 0x010000, 0x020000
SCENE_AMBIENT = lit_scenes.color((0.031373, 0.031373, 0.031373))
MATERIAL_ALPHA = 0.4
SHININESS = 10.5
VERTEX_DIFFUSE, VERTEX_SPECULAR = (0.0, 0.0, 0.0, 0.75), (0.0, 0.4, 0.0, 0.25)
COLORS = lit_scenes.colors((0.0, 0.0, 0.05), (0.25, 0.0, 0.0), (0.0, 0.2, 0.4))


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


def _program_results(model):
    """What the program writes: it lights by the directional light and both lights' ambient colour. It adds
    three-component constants, whose last one also makes the alpha.
    """
    normal = vertex_programs.normalized([scenes.single(c) for c in model.normals.T])
    towards = vertex_programs.normalized([np.float64(c) for c in (-1.0, 0.0, -1.0)])
    ambient, diffuse, specular = (COLORS[name][:3] for name in ("ambient", "diffuse", "specular"))
    facing = np.maximum(vertex_programs.dp3(normal, towards), 0.0)
    viewed = [*towards[:2], vertex_programs.add(towards[2], np.float64(-1.0))]
    half = vertex_programs.normalized(viewed)
    shine = lit_power(vertex_programs.dp3(normal, half), SHININESS)
    primary, secondary = [], []
    for c in range(3):
        lit = vertex_programs.mul(np.float64(diffuse[c]), facing)
        lit = vertex_programs.add(lit, np.float64(SCENE_AMBIENT[c]))
        primary.append(vertex_programs.add(lit, np.float64(scenes.single(2 * ambient[c]))))
        secondary.append(vertex_programs.mul(np.float64(specular[c]), shine))
    count = len(model.positions)
    return scenes.window_mesh(
        vertex_programs.perspective(model.positions),
        PrimitiveType.TRIANGLES,
        colors=np.stack([*primary, primary[2]], axis=1),
        secondary_colors=np.stack([*secondary, np.full(count, VERTEX_SPECULAR[3])], axis=1),
    )


def _case(control, program, specular, inputs):
    secondary = SecondaryColor.DISABLED
    if specular:
        secondary = SecondaryColor.FROM_VERTEX if control & ALPHA else SecondaryColor.OPAQUE
    vertex = scenes.PROGRAM_RESULTS if program else replace(lit_scenes.view(), lighting=lighting(control))
    state = replace(
        scenes.DEFAULT,
        vertex=replace(vertex, secondary_color=secondary),
        register_combiners=lit_scenes.sum_of_colors(),
        polygon=scenes.FRONT_FACES,
    )
    draws = []
    for model_name in lit_scenes.MODELS:
        model = lit_scenes.model(inputs, model_name)
        mesh = _program_results(model) if program else model.mesh(VERTEX_DIFFUSE, VERTEX_SPECULAR)
        draws.append(Draw(label=model_name, mesh=mesh, state=state))
    corners = lit_scenes.program_background() if program else None
    background = scenes.background(0xFF202020, 0xFF000000, 24, corners=corners)
    return Case(
        commands=(scenes.clear(0xFF232623), *background, *draws),
        explanation="" if program else "a single pixel between vertices whose colours are the chip's",
    )


CASES = {
    f"{stage}_0x{alpha + eye + separate:06X}{specular}{'' if stage == 'FF' else '_LightOff'}": (
        partial(_case, alpha + eye + separate, stage == "VS", not specular)
    )
    for specular, alpha, eye, separate, stage in product(
        ("", "NoSpec"), (0, ALPHA), (0, LOCAL_EYE), (0, SEPARATE_SPECULAR), ("FF", "VS")
    )
}
