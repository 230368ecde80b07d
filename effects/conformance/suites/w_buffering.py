"""W_buffering: slopes, lines and slivers whose depth is z or w, in every depth format, with depth offsets.

The colour captures also have lines from a column of printed depths to the pixels that have them.
Source: src/tests/wbuf_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, SHOWS, WIDTH, Case, Shows
from fixedpipe.effects.conformance.host_matrices import default_view, look_at
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction, DepthFormat, PrimitiveType, WrapMode
from fixedpipe.pipeline.state import DepthClamp, DepthTest, PolygonState, Scissor, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "W_buffering"
OPEN = "the last bits of a slope's weights; in Riddick of w's, which are large"

FORMATS = {  # the name's part: format, what the program takes for its farthest depth
    "16D": (DepthFormat.FIXED_16, 65535.0),
    "16F": (DepthFormat.FLOAT_16, 65535.0),
    "24D": (DepthFormat.FIXED_24, 16777215.0),
    "24F": (DepthFormat.FLOAT_24, 16777215.0),
}
BIAS, SLOPE = 16.0, {"Z": 16.0, "W": 65536.0}
LEFT, TOP = 150, 0  # where the window clip begins, but for two primitives
COORDINATES = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])

FAR, NEAR = (16809768.0, 325.8057861328125), (16572698.0, 58.379993438720703)  # z and w
ROOF = COORDINATES[[3, 2, 1, 0]]
DOWN = [(159, 32 * k) for k in range(15)]  # pixels whose depths are printed
ACROSS = [(159 + 34 * k, 5) for k in range(15)]
FLOOR = [
    (53.1875, -34.3125, *FAR),
    (586.75, -34.3125, *FAR),
    (1808.6875, 453.0, *NEAR),
    (-1168.6875, 453.0, *NEAR),
]
WALL = [
    (637.3125, -26.8125, *FAR),
    (637.3125, 506.75, *FAR),
    (150.0, 1728.6875, *NEAR),
    (150.0, -1248.6875, *NEAR),
]
LARGE = 16777046.0


def _roof(y, near, far):
    return [
        (-1168.6875, y, *near),
        (1808.6875, y, *near),
        (586.75, 487.3125, *far),
        (53.1875, 487.3125, *far),
    ]


def _slivers(upright):
    """24 triangles, each a pixel further, and a pixel of each."""
    points, pixels = [], []
    for k in range(24):
        x, y = (160 + k, 20 * k) if upright else (160 + 20 * k, k)
        ends = (x + 200.0, y + 0.5) if upright else (x + 0.5, y + 200.0)
        other = (x + 0.5, y + 10.5) if upright else (x + 10.5, y + 0.5)
        first, second = ((*ends, 58.0, 58.0), (*other, 325.0, 325.0))
        points += [(x + 0.5, y + 0.5, 325.0, 325.0), *((first, second) if upright else (second, first))]
        pixels.append((x, y))
    return PrimitiveType.TRIANGLES, points, np.tile(COORDINATES[:3], (24, 1)), pixels


QUADS, LINE_STRIP = PrimitiveType.QUADS, PrimitiveType.LINE_STRIP
PRIMITIVES = {  # type, positions, texture coordinates, pixels whose depths are printed
    "FloorQuad": (QUADS, FLOOR, COORDINATES, DOWN),
    "RoofQuad": (QUADS, _roof(0.0, NEAR, FAR), ROOF, DOWN),
    "WallQuad": (QUADS, WALL, COORDINATES, ACROSS),
    "LargeZ": (
        QUADS,
        [(x, y, LARGE + (y > 0), LARGE + (y > 0)) for x, y, _ in scenes.rectangle(0.0, 0.0, 640.0, 480.0)],
        COORDINATES,
        DOWN,
    ),
    "LineStrip": (
        LINE_STRIP,
        [
            (321.0, 0.5, 16777210.0, NEAR[1]),
            (159.5, 0.5, 16777210.0, FAR[1]),
            (159.5, 448.5, NEAR[0], NEAR[1]),
            (321.0, 448.5, NEAR[0], FAR[1]),
        ],
        COORDINATES,
        [
            *((x, 0) for x in (320, 267, 214)),
            *((159, 56 * k) for k in range(9)),
            *((x, 448) for x in (214, 267, 320)),
        ],
    ),
    "TriH": _slivers(False),
    "TriV": _slivers(True),
    "Riddick": (
        PrimitiveType.TRIANGLES,
        [
            (-12630.8125, 21456.1875, 2889041.5, 2026.6815185546875),
            (270.4375, 266.5, 16736755.0, 668074.8125),
            (317.25, 262.375, 16739467.0, 714052.1875),
        ],
        COORDINATES[:3],
        [(316, 262), (270, 266), (184, 479), (150, 463)],
    ),
    "Trunc0": (QUADS, _roof(-1 / 16 + 0.001, (0.0, NEAR[1]), (500000.0, FAR[1])), ROOF, DOWN),
    "TruncNeg": (QUADS, _roof(-1 / 16, (0.0, NEAR[1]), (500000.0, FAR[1])), ROOF, DOWN),
    "ClipF": (QUADS, FLOOR, COORDINATES, DOWN),
    "ClipW": (QUADS, WALL, COORDINATES, ACROSS),
}


def _cases():
    """Name and (z or w, format, depth bias, slope, primitive, vertex program, clip left, clip top)."""

    def named(kind, depth, bias, slope, primitive, program=True, left=LEFT, top=TOP):
        clip = "" if (left, top) == (LEFT, TOP) else f"-{left:03d}-{top:03d}"
        name = f"{kind}Buf{depth}_{primitive}{clip}_V{program:d}_ZB{bias:d}_ZS{slope:d}"
        return name, (kind, depth, bias, slope, primitive, program, left, top)

    switches = (False, True)
    everywhere = ("FloorQuad", "RoofQuad", "WallQuad", "LargeZ", "LineStrip", "TriH", "TriV")
    for kind, depth, bias, slope in product("ZW", FORMATS, switches, switches):
        yield from (named(kind, depth, bias, slope, primitive) for primitive in everywhere)
        yield named(kind, depth, bias, slope, "FloorQuad", program=False)
    yield named("W", "24D", False, False, "Riddick")
    yield from (named("Z", "24D", False, False, primitive) for primitive in ("Trunc0", "TruncNeg"))
    for k in (0, 3, 6):
        yield named("W", "24D", False, True, "ClipF", top=DOWN[k + 1][1])
        yield named("W", "24D", False, True, "ClipW", left=ACROSS[k][0])


def _fixed_function(farthest):
    """The view from 50 above the floor, a little downwards, as vertex state, and the floor."""
    points = [
        (-15000.0, 0.0, 30000.0),
        (15000.0, 0.0, 30000.0),
        (15000.0, 0.0, -10.0),
        (-15000.0, 0.0, -10.0),
    ]
    view = default_view(farthest, look_at((0.0, 50.0, -7.0), (0.0, 47.0, 0.0)))
    return view.vertex_state(), Mesh(points, QUADS, texture_coordinates=(COORDINATES * 100.0,))


def _lines(pixels, depth_format, left, top):
    """Yellow lines from each printed depth to its pixel and half a step on; red ones where a clip is."""
    x0, points = 122 if abs(depth_format) == 24 else 102, []
    for k, (x, y) in enumerate(pixels[:15]):
        y0 = 32 + 25 * k
        reach = 0.5 / max(abs(x - x0), abs(y - y0))
        points += [(x0 + 0.5, y0 + 0.5), (x + 0.5 + reach * (x - x0), y + 0.5 + reach * (y - y0))]
    state = replace(scenes.DEFAULT, vertex=scenes.PROGRAM_RESULTS)
    colors = np.array([(1.0, 1.0, 0.0)] * len(points))
    mesh = scenes.window_mesh(points, PrimitiveType.LINES, colors=colors)
    yield Draw(label="lines to pixels", mesh=mesh, state=state)
    for clipped, corners in (
        (top != TOP, scenes.rectangle(left, top, WIDTH, top + 1)),
        (left != LEFT, scenes.rectangle(left, top, left + 1, HEIGHT)),
    ):
        if clipped:
            yield scenes.quad("where the clip begins", corners, (1.0, 0.0, 0.0, 1.0))


def _case(kind, depth, bias, slope, primitive, program, left, top, shows):
    depth_format, farthest = FORMATS[depth]
    primitive_type, positions, coordinates, pixels = PRIMITIVES[primitive]
    vertex = scenes.PROGRAM_RESULTS
    mesh = scenes.window_mesh(positions, primitive_type, texture_coordinates=(coordinates,))
    if not program:
        vertex, mesh = _fixed_function(farthest)
    repeat = replace(scenes.NEAREST, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.REPEAT)
    state = replace(
        scenes.DEFAULT,
        vertex=vertex,
        texture_units=(TextureUnit("checkerboard", repeat),),
        register_combiners=scenes.SHOWS_TEXTURE0,
        scissor=Scissor(left, 0, WIDTH - left, HEIGHT - top),
        depth_test=DepthTest(ComparisonFunction.LEQUAL),
        depth_clamp=DepthClamp(maximum=16777215.0 * 16.0),
        w_buffering=kind == "W",
        polygon=PolygonState(
            offset_fill=bias or slope,
            offset_units=BIAS if bias else 0.0,
            offset_factor=SLOPE[kind] if slope else 0.0,
        ),
    )
    checkers = texture_2d(scenes.checkerboard(0xFF00FFFF, 0xFF000000, 8))
    commands = (
        scenes.clear(0xFF251135),
        TexImage(label="checkerboard", texture="checkerboard", image=checkers),
        Draw(label="the primitive", mesh=mesh, state=state),
    )
    if shows == Shows.ZETA:
        return Case(commands=commands, depth_bits=depth_format, shows=Shows.ZETA)
    commands += tuple(_lines(pixels, depth_format, left, top))
    return Case(commands=commands, depth_bits=depth_format)


CASES = {
    name + zeta: partial(_case, *given, shows) for name, given in _cases() for zeta, shows in SHOWS.items()
}
