"""Fog. Source: WineHQ, wine, dlls/d3d8/tests/visual.c, fog_with_shader_test (colours collected on a GeForce
7600 GS), fog_test, test_fog_interpolation, test_negative_fixedfunction_fog, test_table_fog_zw and
fog_special_test.

Direct3D's table fog by depth and its fog factor in the specular colour's alpha are both fog coordinates here.
A factor is linear fog from 1 to 0.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline import Fog, parse_program
from fixedpipe.pipeline.enums import FogCoordinateSource, FogMode, ShadeModel
from fixedpipe.pipeline.state import PolygonState, VertexState
from tests.foreign.comparison import Case, assert_drawn, assert_held, on_machines, pixels
from tests.foreign.direct3d import argb, clear, draw, fan, strip, transformed, vertex_state

GREEN = (0.0, 1.0, 0.0, 1.0)
OWN = FogCoordinateSource.FOG_COORDINATE
EYE_Z = Fog(FogMode.LINEAR, start=0.0, end=1.0, color=GREEN)
DEPTH = replace(EYE_Z, coordinate_source=OWN)
FACTOR = replace(DEPTH, start=1.0, end=0.0)
SIZE = 64, 48

# fog_with_shader_test: eleven depths from 0.001 to 0.999, with and without a pixel shader.
PIXEL_SHADER = parse_program("ps.1.1\nmov r0, v0").combiners
RANGE = replace(EYE_Z, start=0.1, end=0.9)
FALLING = {
    "linear by fog coordinate": (
        replace(RANGE, coordinate_source=OWN),
        lambda z: z,
        "ff0000 ff0000 df2000 bf4000 9f6000 7f8000 5fa000 40bf00 20df00 00ff00 00ff00",
    ),
    "linear by eye z": (
        RANGE,
        None,
        "ff0000 ff0000 df2000 bf4000 9f6000 7f8000 5fa000 40bf00 20df00 00ff00 00ff00",
    ),
    "EXP": (
        Fog(FogMode.EXP, density=1.0, color=GREEN, coordinate_source=OWN),
        lambda z: z,
        "ff0000 e71800 d12e00 bd4200 ab5400 9b6400 8d7200 7f8000 738c00 689700 5ea100",
    ),
    "EXP2": (
        Fog(FogMode.EXP2, density=1.0, color=GREEN, coordinate_source=OWN),
        lambda z: z,
        "fd0200 f50200 f50a00 e91600 d92600 c73800 b24d00 9c6300 867900 728d00 5ea100",
    ),
    "a vertex shader's oFog": (
        FACTOR,
        lambda z: (z - 0.9) * -1.25,
        "ff0000 fe0100 de2100 bf4000 9f6000 7f8000 5fa000 3fc000 1fe000 00ff00 00ff00",
    ),
}


def falling(name, number, program):
    fog, coordinate, colors = FALLING[name]
    z = 0.001 + number / 10.02
    corners = [[-1, -1, z], [-1, 1, z], [1, -1, z], [1, 1, z]]
    mesh = strip(corners, 0xFFFF0000, fog_coordinates=coordinate and [coordinate(z)] * 4)
    frame = clear(0xFFFF00FF, 1.0), draw(mesh, SIZE, fog=fog, register_combiners=program)
    wanted = pixels([(12, 24, int(colors.split()[number], 16), 13)])
    return Case(f"{name}, z {z:.3f}{', ps.1.1' if program else ''}", frame, wanted, SIZE)


# fog_test: quarters of the window, of one depth each.
def quarter(x, y, z, color, coordinate=None):
    corners = [[x, y, z], [x, y + 1, z], [x + 1, y + 1, z], [x + 1, y, z]]
    return fan(corners, color, fog_coordinates=None if coordinate is None else [coordinate] * 4)


def moved(**by):
    """Matrices that add to z."""
    return {name: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, z, 1]] for name, z in by.items()}


RED, YELLOW = 0xFFFF0000, 0xFFFFFF00
QUARTERS = (
    Case(
        "a factor, eye z, and both as depths",
        (
            clear(0xFFFF00FF),
            draw(quarter(-1, -1, 0.1, RED, 1.0), SIZE, fog=FACTOR),
            draw(quarter(-1, 0, 1.0, RED), SIZE, fog=EYE_Z),
            draw(quarter(0, 0, 1.0, YELLOW, 1.0), SIZE, fog=FACTOR),
            draw(quarter(0, -1, 1.0, YELLOW, 1.0), SIZE, fog=DEPTH),
        ),
        pixels([(16, 36, 0xFF0000, 1), (16, 12, 0x00FF00, 1), (48, 12, 0xFFFF00, 1), (48, 36, 0x00FF00, 1)]),
        SIZE,
    ),
    Case(
        "the world matrix moves what eye z fogs",
        (
            clear(0xFFFF00FF),
            draw(quarter(-1, -1, 0.5, RED), SIZE, vertex=vertex_state(SIZE, **moved(world=-0.5)), fog=EYE_Z),
            draw(quarter(-1, 0, 1.5, RED), SIZE, vertex=vertex_state(SIZE, **moved(world=-0.5)), fog=EYE_Z),
        ),
        pixels([(16, 36, 0xFF0000, 4), (16, 12, 0x00FF00, 1)]),
        SIZE,
    ),
    Case(
        "table fog takes the depth and not eye z",
        (
            clear(0xFFFF00FF),
            *[
                draw(
                    quarter(-1, y, z, RED, z),
                    SIZE,
                    vertex=vertex_state(SIZE, **moved(world=1, projection=-1)),
                    fog=DEPTH,
                )
                for y, z in ((-1, 0.1), (0, 1.0))
            ],
        ),
        pixels([(16, 36, 0xE51900, 4), (16, 12, 0x00FF00, 1)]),
        SIZE,
    ),
)

# test_fog_interpolation: z from 0 at the left to 1 at the right. The window keeps its width, and is low.
WIDE = 640, 4
SLOPE = [[-1, -1, 0], [-1, 1, 0], [1, -1, 1], [1, 1, 1]]
EXP5 = Fog(FogMode.EXP, density=5.0, color=GREEN)
SLOPES = {
    "a factor": (FACTOR, [1, 1, 0, 0], [0x0000FF, 0x007F80, 0x00FD02]),
    "EXP of the depth": (replace(EXP5, coordinate_source=OWN), [0, 0, 1, 1], [0x0000FF, 0x00EA15, 0x00FD02]),
    "EXP of eye z": (EXP5, None, [0x0000FF, 0x00EA15, 0x00FD02]),
}


def sloped(name, model):
    fog, coordinates, colors = SLOPES[name]
    mesh = strip(SLOPE, 0x000000FF, fog_coordinates=coordinates)
    frame = clear(0x00808080), draw(mesh, WIDE, polygon=PolygonState(shade_model=model), fog=fog)
    wanted = pixels([(x, 2, color, 2) for x, color in zip((0, 320, 639), colors, strict=True)])
    return Case(f"{name} is interpolated, {model.name}", frame, wanted, WIDE)


# test_negative_fixedfunction_fog: eye z, or the depth, is -0.5.
FLAT_Z = vertex_state(SIZE, projection=np.diag([1, 1, 0, 1]))
BEHIND = [[x, y, -0.5] for x in (-1, 1) for y in (-1, 1)]
IN_FRONT = [[x, y, 0] for x in (-1, 1) for y in (-1, 1)]
NEGATIVE = {
    "linear from 0 to 1": (EYE_Z, 0x808000),
    "linear from -1 to 0": (replace(EYE_Z, start=-1.0, end=0.0), 0x00FF00),
    "EXP": (Fog(FogMode.EXP, density=1.0, color=GREEN), 0x9B6400),
}


def behind(name):
    fog, color = NEGATIVE[name]
    frame = clear(0xFF), draw(strip(BEHIND, RED), SIZE, vertex=FLAT_Z, fog=fog)
    return Case(f"eye z -0.5, {name}", frame, pixels([(32, 24, color, 2)]), SIZE)


def negative_depth(start, end, colors):
    fog = replace(DEPTH, start=start, end=end)
    frame = clear(0xFF), draw(strip(IN_FRONT, RED, fog_coordinates=[-0.5] * 4), SIZE, fog=fog)
    return Case(f"depth -0.5, from {start} to {end}", frame, pixels([(32, 24, colors, 2)]), SIZE)


# test_table_fog_zw: whatever w is, the depth fogs.
def by_depth(z, rhw, color):
    corners = transformed([(x, y, z, rhw) for y in (0, 48) for x in (0, 64)], SIZE)
    mesh = strip(corners, RED, fog_coordinates=[z] * 4)
    frame = clear(0xFF), draw(mesh, SIZE, vertex=VertexState(), fog=DEPTH)
    return Case(f"depth {z}, rhw {rhw}", frame, pixels([(32, 24, color, 2)]), SIZE)


# fog_special_test: the range of linear fog is empty.
def empty_range(name, source, coordinates):
    fog = Fog(FogMode.LINEAR, start=0.5, end=0.5, color=argb(RED), coordinate_source=source)
    frame = clear(0xFF), draw(strip(SLOPE, 0xFF00FF00, fog_coordinates=coordinates), WIDE, fog=fog)
    wanted = pixels([(310, 2, 0x00FF00, 1), (330, 2, 0xFF0000, 1)])
    return Case(f"{name} from 0.5 to 0.5", frame, wanted, WIDE)


CASES = (
    *[
        falling(name, number, program)
        for name in FALLING
        for program in (None, PIXEL_SHADER)
        for number in range(11)
    ],
    *QUARTERS,
    *[sloped(name, model) for name in SLOPES for model in ShadeModel],
    *map(behind, NEGATIVE),
    negative_depth(0.0, 1.0, (0xFF0000, 0x808000)),
    negative_depth(-1.0, 0.0, (0x808000, 0xFF0000, 0x00FF00)),
    by_depth(0.7, 0.3, 0x4CB200),
    by_depth(0.7, 3.0, 0x4CB200),
    by_depth(0.3, 1.0, 0xB24C00),
    empty_range("the depth", OWN, [0, 0, 1, 1]),
    empty_range("eye z", FogCoordinateSource.FRAGMENT_DEPTH, None),
)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES, {}))
def test_fog_is_what_wine_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=555)
