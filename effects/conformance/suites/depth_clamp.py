"""Depth_Clamp: two pillars in a floor, its depth limited, offset or compared with itself; depth is z or w.

Source: src/tests/depth_clamp_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.vertex_programs import perspective
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction, PrimitiveType
from fixedpipe.pipeline.state import DepthClamp, DepthTest, PolygonState, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Depth_Clamp"

OFFSETS = ("0.685", "0.822", "3.015", "3.216")
COORDINATES = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
PILLARS = [
    [(x, 2.0, z), (x + 1, 2.0, z), (x + 1, -6.5, z), (x, -6.5, z)] for x, z in ((-2.0, 2.0), (1.0, 10.0))
]
FLOOR = [(-10.0, -2.5, 20.0), (10.0, -2.5, 20.0), (10.0, -2.5, 0.0), (-10.0, -2.5, 0.0)]
# By whether depth is w: the floor's limits, its depth offset.
LIMITS = {False: (14988020.0, 15869663.0), True: (float(np.float32(9.01)), float(np.float32(16.49)))}
BIAS = {False: -500000.0, True: -5.0}
CHECKERED = replace(
    scenes.DEFAULT,
    vertex=scenes.xdk_vertex(),
    texture_units=(TextureUnit("checkerboard", scenes.NEAREST),),
    register_combiners=scenes.SHOWS_TEXTURE0,
    depth_test=DepthTest(ComparisonFunction.LESS),
    depth_clamp=DepthClamp(cull=True),
)


def _quad(points, state, program=False):
    given = {"primitive": PrimitiveType.QUADS, "texture_coordinates": (COORDINATES,)}
    if program:
        mesh = scenes.window_mesh(perspective(points, offset=scenes.XDK_OFFSET), **given)
        state = replace(state, vertex=scenes.PROGRAM_RESULTS)
    else:
        mesh = Mesh(scenes.single(points), **given)
    return Draw(label="a quad", mesh=mesh, state=state)


def _clamp_case(w_buffering, clamp, biased, full_range, program):
    state = replace(CHECKERED, w_buffering=w_buffering)
    low, high = (0.0, None) if full_range else LIMITS[w_buffering]
    floor = replace(
        state,
        depth_clamp=DepthClamp(low, high, cull=not clamp),
        polygon=PolygonState(offset_fill=biased, offset_units=BIAS[w_buffering]),
    )
    return (*(_quad(points, state, program) for points in PILLARS), _quad(FLOOR, floor, program))


def _equal_case(w_buffering, offset):
    scale, limit = (100.0, float(np.float32(255.99))) if w_buffering else (1.0, LIMITS[False][0])
    x, y, far, near = 10.0 * scale, -2.5 * scale, 200.0 * scale - offset, -20.0 + offset
    points = [(-x, y, far), (x, y, far), (x, y, near), (-x, y, near)]
    first = replace(CHECKERED, w_buffering=w_buffering, depth_clamp=DepthClamp(limit, cull=True))
    second = replace(
        first,
        texture_units=(),
        register_combiners=scenes.SHOWS_PRIMARY,
        depth_test=DepthTest(ComparisonFunction.EQUAL),
        depth_clamp=DepthClamp(limit),
    )
    red = Mesh(scenes.single(points), PrimitiveType.QUADS, colors=np.array([(1.0, 0.0, 0.0)] * 4))
    return _quad(points, first), Draw(label="the floor again, red", mesh=red, state=second)


def _case(draws, *given):
    checkers = texture_2d(scenes.checkerboard(0xFF00FFFF, 0xFF000000, 8))
    return Case(
        commands=(
            scenes.clear(0xFE251135),
            TexImage(label="checkerboard", texture="checkerboard", image=checkers),
            *draws(*given),
        ),
    )


CASES = {
    "depth_clamp_W{:d}_C{:d}_ZB{:d}_FR{:d}_VSH{:d}".format(*switches): partial(_case, _clamp_case, *switches)
    for switches in product((False, True), repeat=5)
} | {
    f"depth_equal{'_WBuf' if w_buffering else ''}_Ofs{offset}": (
        partial(_case, _equal_case, w_buffering, float(offset))
    )
    for w_buffering, offset in product((False, True), OFFSETS)
}
