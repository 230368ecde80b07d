"""Lighting. Source: WineHQ, wine, dlls/d3d9/tests/visual.c, lighting_test and test_specular_lighting;
dlls/d3d8/tests/visual.c, test_color_vertex.
"""

import math

import numpy as np
import pytest

from fixedpipe.pipeline import TexImage, TextureUnit, environment, texture_2d
from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import ColorMaterialParameter, ColorSource, SecondaryColor
from fixedpipe.pipeline.state import ColorMaterial, ColorSources, Light, Lighting, Material, Spot
from tests.foreign.comparison import (
    MACHINES,
    Case,
    assert_drawn,
    assert_held,
    everywhere,
    on_machines,
    pixels,
)
from tests.foreign.direct3d import POINT, QUAD, argb, clear, draw, fan, strip, texels, vertex_state

SIZE = 64, 48  # a tenth of the tests' windows
NOTHING = (0.0, 0.0, 0.0, 0.0)
DARK = Material(NOTHING, NOTHING, NOTHING, NOTHING)


def lit(size=SIZE, world=None, **fields):
    return vertex_state(size, world, lighting=Lighting(**({"model_ambient": NOTHING} | fields)))


# lighting_test: quads with and without normals and lighting, and no light.


def quarter(x, y, color, **arrays):
    return fan([[x, y, 0.1], [x, y + 1, 0.1], [x + 1, y + 1, 0.1], [x + 1, y, 0.1]], color, **arrays)


UP = [[1, 1, 1]] * 4
WITHOUT_LIGHTS = Case(
    "without lights what is lit is black",
    (
        clear(0xFFFFFFFF),
        draw(quarter(-1, -1, 0xFFFF0000), SIZE),
        draw(quarter(-1, 0, 0xFF00FF00), SIZE, vertex=lit(front=DARK)),
        draw(quarter(0, -1, 0xFF0000FF, normals=UP), SIZE),
        draw(quarter(0, 0, 0xFFFFFF00, normals=UP), SIZE, vertex=lit(front=DARK)),
    ),
    pixels([(16, 36, 0xFF0000, 0), (16, 12, 0, 0), (48, 36, 0x0000FF, 0), (48, 12, 0, 0)]),
    SIZE,
)

# lighting_test: one light along z, whose diffuse colour the vertices' blue multiplies, under a world matrix.
SUN = Light(ambient=NOTHING, diffuse=(1.0, 1.0, 1.0, 0.0), specular=NOTHING, position=(0.0, 0.0, 1.0, 0.0))
FACING = ([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]], [0, 0, -1])
TURNED = ([[-10, -11, 11], [-10, -9, 11], [-10, -9, 9], [-10, -11, 9]], [-1, 0, 0])
MOVED = ([[-11, -11, -10], [-11, -9, -10], [-9, -9, -10], [-9, -11, -10]], [0, 0, -1])
NOT_AFFINE = (
    "a normal under a matrix that is not affine is Direct3D's own rule; OpenGL 1.2.1, 2.10.3, is kept"
)
WORLDS = {
    "an identity": (np.eye(4), FACING, 0x0000FF),
    "a singular matrix": ([[1, 0, 1, 0], [0, 1, 0, 0], [1, 0, 1, 0], [0, 0, 0.5, 1]], FACING, 0x0000FF),
    "a turn": ([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [10, 10, 10, 1]], TURNED, 0x0000FF),
    "a matrix that is not affine": ([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -1], [10, 10, 10, 0]], MOVED, 0),
}


def under(name):
    world, (positions, normal), color = WORLDS[name]
    vertex = lit(
        world=world,
        lights=(SUN,),
        color_material=ColorMaterial(parameter=ColorMaterialParameter.DIFFUSE),
        front=Material(ambient=NOTHING),
        back=Material(ambient=NOTHING),
    )
    mesh = fan(positions, 0xFF0000FF, normals=[normal] * 4)
    frame = clear(0xFFFFFFFF), draw(mesh, SIZE, vertex=vertex)
    return Case(f"lit under {name}", frame, pixels([(32, 24, color, 0)]), SIZE)


LIT_ALPHA = Case(
    "the alpha of what is lit is the material's",
    (
        clear(0),
        TexImage(label="a texel that is not read", texture="any", image=texture_2d(texels([[0x63636363]]))),
        draw(
            strip(colors=[argb(color) for color in (0x8000FF00, 0x80000000) * 2]),
            SIZE,
            vertex=lit(front=Material(ambient=NOTHING, diffuse=(0.0, 0.0, 0.0, 1.0))),
            texture_units=(
                TextureUnit("any", POINT, environment=environment(("REPLACE", "PRIMARY_COLOR.a"))),
            ),
        ),
    ),
    pixels([(32, 24, 0xFFFFFF, 0)]),
    SIZE,
)

# test_specular_lighting: a grid of five by five vertices; a white light and a white specular material.
ACROSS = 5
POINTS = [[x / 2 - 1, y / 2 - 1, 1.0] for y in range(ACROSS) for x in range(ACROSS)]
GRID = Mesh(
    POINTS,
    indices=[
        index
        for y in range(ACROSS - 1)
        for at in range(y * ACROSS, y * ACROSS + ACROSS - 1)
        for index in (at + 1, at, at + ACROSS, at + 1, at + ACROSS, at + ACROSS + 1)
    ],
    normals=[[0, 0, -1]] * ACROSS**2,
)
DIRECTIONAL = {"position": (0.0, 0.0, 1.0, 0.0)}
AT_THE_EYE = {
    "position": (0.0, 0.0, 0.0, 1.0),
    "constant_attenuation": 0.0,
    "quadratic_attenuation": 1.0,
}
NEAR = AT_THE_EYE | {"range": 1.2}
ASIDE = AT_THE_EYE | {"position": (-1.1, 0.0, -1.1, 1.0)}
# D3DLIGHT9's cone from Theta pi/12 to Phi pi/3 with Falloff 1, as a lighting unit's spot.
INNER, OUTER = math.cos(math.pi / 24), math.cos(math.pi / 6)
CONE = AT_THE_EYE | {
    "spot": Spot(axis=(0.0, 0.0, 1 / (INNER - OUTER), -OUTER / (INNER - OUTER)), coefficients=(0.0, 0.0, 1.0))
}
# By name: the light, whether the viewer is local, the material's power, grey at the corners, edges, middle.
SPECULAR = {
    "directional": (DIRECTIONAL, False, 30, 255, 255, 255),
    "directional, local viewer": (DIRECTIONAL, True, 30, 0x3C, 0x71, 255),
    "point": (AT_THE_EYE, False, 30, 0x28, 0x5A, 255),
    "point, local viewer": (AT_THE_EYE, True, 30, 0, 7, 255),
    "point of range 1.2": (NEAR, False, 30, 0, 0x5A, 255),
    "point at the side, power 0": (ASIDE, True, 0, 0, 0, 0),
    "directional, power 0": (DIRECTIONAL, False, 0, 255, 255, 255),
    "directional, local viewer, power 0": (DIRECTIONAL, True, 0, 255, 255, 255),
    "point, power 0": (AT_THE_EYE, False, 0, 0xAA, 0xCC, 255),
    "point, local viewer, power 0": (AT_THE_EYE, True, 0, 0xAA, 0xCC, 255),
    "point of range 1.2, power 0": (NEAR, False, 0, 0, 0xCC, 255),
    "spot": (CONE, False, 30, 0, 0x14, 255),
    "spot, local viewer": (CONE, True, 30, 0, 2, 255),
    "spot, power 0": (CONE, False, 0, 0, 0x2E, 255),
}


def specular(name):
    light, local, power, *greys = SPECULAR[name]
    material = Material(NOTHING, NOTHING, (1.0, 1.0, 1.0, 1.0), NOTHING, float(power))
    vertex = lit(
        (640, 480),
        lights=(Light(ambient=NOTHING, diffuse=NOTHING, specular=(1.0, 1.0, 1.0, 0.0), **light),),
        local_viewer=local,
        separate_specular_color=True,
        front=material,
        back=material,
    )
    # By how many of x and y are in the middle.
    wanted = [
        (x, y, greys[(x == 320) + (y == 240)] * 0x010101, 1) for y in (120, 240, 360) for x in (160, 320, 480)
    ]
    return Case(
        f"specular, {name}", (clear(0xFF00FF00), draw(GRID, SIZE, vertex=vertex)), pixels(wanted), (640, 480)
    )


# test_color_vertex: vertices' diffuse and specular colour, COLORVERTEX, the sources of ambient and emissive
# colour, and the picture. Half of blue is ambient and a quarter emitted, where the material says.
MATERIAL, FIRST, SECOND = ColorSource.MATERIAL, ColorSource.PRIMARY, ColorSource.SECONDARY
RED, GREEN = 0xFFFF0000, 0xFF00FF00
COLOR_VERTEX = (
    (RED, GREEN, False, FIRST, SECOND, 0x0000C0),
    (RED, GREEN, True, FIRST, SECOND, 0xFFFF00),
    (RED, GREEN, True, MATERIAL, SECOND, 0x00FF80),
    (RED, GREEN, True, FIRST, MATERIAL, 0xFF0040),
    (RED, GREEN, True, FIRST, FIRST, 0xFF0000),
    (RED, GREEN, True, SECOND, SECOND, 0x00FF00),
    (None, RED, True, FIRST, SECOND, 0xFF0080),
    (None, RED, True, FIRST, MATERIAL, 0x0000C0),
    (None, RED, True, MATERIAL, SECOND, 0xFF0080),
    (RED, None, True, FIRST, SECOND, 0xFF0040),
    (RED, None, True, FIRST, MATERIAL, 0xFF0040),
    (RED, None, True, SECOND, MATERIAL, 0x0000C0),
    (None, None, True, FIRST, SECOND, 0x0000C0),
)


def color_vertex(number):
    first, second, enabled, *sources, color = COLOR_VERTEX[number]
    given = {FIRST: first, SECOND: second}
    # Direct3D takes the material's colour where the vertices have none.
    ambient, emission = [
        source if enabled and given.get(source) is not None else MATERIAL for source in sources
    ]
    emitted = (0.0, 0.0, 0.25, 0.0) if emission == MATERIAL else (1.0, 1.0, 1.0, 0.0)
    material = Material((0.0, 0.0, 0.5, 0.0), NOTHING, NOTHING, emitted)
    from_vertices = ColorSources(emission=emission, ambient=ambient)
    lighting = Lighting(
        model_ambient=(1.0, 1.0, 1.0, 1.0),
        front=material,
        back=material,
        front_sources=from_vertices,
        back_sources=from_vertices,
    )
    colors, secondary_colors = [None if c is None else [argb(c)] * len(QUAD) for c in (first, second)]
    mesh = strip(colors=colors, secondary_colors=secondary_colors)
    vertex = vertex_state(SIZE, lighting=lighting, secondary_color=SecondaryColor.DISABLED)
    frame = clear(0x77777777), draw(mesh, SIZE, vertex=vertex)
    return Case(f"sources of colours, case {number}", frame, pixels([(32, 24, color, 1)]), SIZE)


CASES = (
    WITHOUT_LIGHTS,
    *map(under, WORLDS),
    LIT_ALPHA,
    *map(specular, SPECULAR),
    *map(color_vertex, range(len(COLOR_VERTEX))),
)
DISAGREEMENTS = everywhere(NOT_AFFINE, ["lit under a matrix that is not affine"], MACHINES)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES, DISAGREEMENTS))
def test_lighting_is_what_wine_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=129)
