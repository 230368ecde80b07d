"""Specular_back: the secondary colour of back faces under every light control, and their coefficients.

Source: src/tests/specular_back_tests.cpp of nxdk_pgraph_tests. As Specular, with two-sided lighting; front
faces are culled, and all faces are turned to show their back.
"""

from dataclasses import replace
from functools import partial

from fixedpipe.effects.conformance import control_flags, host_matrices, lit_scenes, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.passes.combiners import SECONDARY
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import Face, FrontFace, SecondaryColor
from fixedpipe.pipeline.state import Lighting, Material, PolygonState

SUITE = "Specular_back"

CLEAR_FLAGS, CLEAR_PARAMETERS, DARK, BLACK, LIGHT = 0xFE323232, 0xFE313131, 0xFF202020, 0xFF000000, 0xFF909090
WHITE = lit_scenes.WHITE
ALONG = (1.0, 0.0, 1.0)
POLYGON = PolygonState(cull_face=Face.FRONT, front_face=FrontFace.CCW)
BACK_COLORS = ((0.05, 0.05, 0.0), (0.7, 0.0, 0.0), (0.0, 0.75, 0.0))  # ambient, diffuse, specular
POINT_BACK_COLORS = ((0.05, 0.05, 0.0), (0.9, 0.0, 0.0), (0.0, 0.9, 0.0))

CORNERS = control_flags.Corners(
    primary=((0.0, 1.0, 0.5, 1.0),) * 4,
    secondary=((0.0, 0.0, 1.0, 0.33),) * 4,
    normals=tuple(
        lit_scenes.unit(n)
        for n in ((-0.1, 0.05, 0.85), (0.1, 0.05, 0.85), (0.1, -0.05, 0.85), (-0.1, -0.05, 0.85))
    ),
    back_primary=((0.5, 0.0, 0.0, 1.0), (0.75, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 1.0), (0.25, 0.0, 0.0, 1.0)),
    back_secondary=((1.0, 0.0, 0.0, 0.15), (1.0, 0.0, 0.0, 0.75), (0.0, 1.0, 0.0, 1.0), (0.0, 1.0, 0.0, 0.2)),
)


def _unproject(x, y):
    """The world position at z = 1, by a perspective vertex program's matrices."""
    _, inverse = host_matrices.programmed()
    return host_matrices.unproject(inverse, x, y, 1.0)[0]


UNPROJECT = {"FF": partial(lit_scenes.unproject, z=1.0), "VS": _unproject}
# Fitted to rows 1 to 3 of the capture ControlFlags_VS; row 0 is black. What moves the place between rows is
# not known, so of each row's 16 vertices one number is not predicted.
FIRST_PLACES = (0, 4, 5, 5)


def _back(ambient, diffuse, specular):
    colors = (lit_scenes.color(c) for c in (ambient, diffuse, specular))
    return dict(zip(("back_ambient", "back_diffuse", "back_specular"), colors, strict=True))


def _lighting(coefficients, lights, ambient, **given):
    """Coefficients for the back; the front's are zero, so that using them would show."""
    front = Material(WHITE, (1.0, 1.0, 1.0, 0.15), WHITE, specular_coefficients=(0.0,) * 6)
    return Lighting(
        lights=lights,
        front=front,
        back=replace(front, diffuse=(1.0, 1.0, 1.0, 0.75), specular_coefficients=coefficients),
        model_ambient=lit_scenes.color((ambient,) * 3),
        back_model_ambient=lit_scenes.BLACK,
        two_side=True,
        viewer_direction=lit_scenes.EYE_DIRECTION,
        **given,
    )


def _control_flags(name):
    front = lit_scenes.colors((0.0, 0.0, 0.1), (0.0, 0.0, 0.2), (0.0, 0.0, 0.7))
    light = lit_scenes.directional(ALONG, **front, **_back(*BACK_COLORS))
    lighting = _lighting(lit_scenes.COEFFICIENTS["Pow16_0"], (light,), 0.031373)
    draws = control_flags.draws(name, CORNERS, lighting, UNPROJECT, FIRST_PLACES, POLYGON)
    corners = lit_scenes.program_background() if name.endswith("VS") else None
    background = scenes.background(LIGHT, DARK, 14, corners=corners)
    return Case(
        commands=(scenes.clear(CLEAR_FLAGS), *background, *draws),
    )


# Pow2, Pow16 and Pow24 are exact with the same lights and meshes.
_POW4 = "one step of a lit color at a few vertices' pixels; which bit of the chip's power it is, is open"


def _parameters(name, inputs):
    coefficients = lit_scenes.COEFFICIENTS[name]
    front = lit_scenes.colors(*((0.0, 0.0, 1.0),) * 3)
    lights = (
        lit_scenes.directional(ALONG, **front, **_back(*BACK_COLORS)),
        lit_scenes.point((1.5, 1.0, -2.5), 4.0, (0.025, 0.15, 0.02), **front, **_back(*POINT_BACK_COLORS)),
    )
    lighting = _lighting(coefficients, lights, 0.1, separate_specular_color=True)
    combiners = scenes.shows(SECONDARY)
    state = lit_scenes.state(lighting, combiners, polygon=POLYGON, secondary_color=SecondaryColor.OPAQUE)
    draws = []
    for mesh_name in lit_scenes.MODELS:
        model = lit_scenes.model(inputs, mesh_name)
        mirrored = replace(model, normals=model.normals * (1.0, 1.0, -1.0))
        mesh = mirrored.mesh((1.0, 0.0, 1.0, 0.75), (1.0, 0.0, 1.0, 0.15))
        draws.append(Draw(label=mesh_name, mesh=mesh, state=state))
    return Case(
        commands=(scenes.clear(CLEAR_PARAMETERS), *scenes.background(DARK, BLACK, 20), *draws),
        explanation=_POW4 if name == "Pow4_0" else "",
    )


CASES = {
    **{name: partial(_control_flags, name) for name in control_flags.NAMES},
    **{f"SpecParams_FF_{name}": partial(_parameters, name) for name in lit_scenes.COEFFICIENTS},
}
