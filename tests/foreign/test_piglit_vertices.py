"""Lighting, generated coordinates, clipping, points, lines and offsets. Source: piglit, tests/spec/gl-1.0,
texgen.c, spot-light.c, user-clip-all-planes.c and edgeflag.c; tests/general, infinite-spot-light.c,
two-sided-lighting.c, two-sided-lighting-separate-specular.c, user-clip.c, linestipple.c, clipflat.c and
triangle-guardband-viewport.c; tests/spec/gl-1.2/rescale-normal.c; tests/spec/gl-1.4/polygon-offset.c;
tests/spec/arb_point_parameters/point-attenuation.c.
"""

import math
from itertools import pairwise, product

import numpy as np
import pytest

from fixedpipe.pipeline import (
    PROFILES,
    Blending,
    DepthTest,
    Mesh,
    ReadPixels,
    TexImage,
    TextureEnvironment,
    TextureUnit,
    VertexState,
    execute,
    texture_2d,
)
from fixedpipe.pipeline.enums import (
    BlendFactor,
    FrontFace,
    PolygonMode,
    PrimitiveType,
    ShadeModel,
    TexGenMode,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.state import (
    Light,
    Lighting,
    LineState,
    Material,
    PointParameters,
    PointState,
    PolygonState,
    TexGen,
    Viewport,
)
from tests.foreign.comparison import (
    MACHINES,
    Case,
    assert_drawn,
    assert_held,
    on_machines,
    pixels,
)
from tests.foreign.opengl import NEAREST, clear, draw, matrix, ortho, rectangle, rgb, upwards

BLACK, WHITE = (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)
RED, GREEN, BLUE = 0xFF0000, 0x00FF00, 0x0000FF
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)


# texgen.c: a sphere of 32 slices and 16 stacks, and a board whose quarters are green and blue.
def sphere(radius, slices, stacks):
    angles = np.arange(slices) / slices * 2 * math.pi
    heights = -np.cos(np.arange(stacks + 1) / stacks * math.pi)
    rings = [
        [math.sqrt(1 - z * z) * math.cos(a), math.sqrt(1 - z * z) * math.sin(a), z]
        for z in heights
        for a in angles
    ]
    at = np.arange((stacks + 1) * slices).reshape(-1, slices)
    here, right = at, np.roll(at, -1, 1)
    quads = np.stack([here[:-1], right[:-1], right[1:], here[1:]], -1).reshape(-1)
    directions = np.array(rings)
    return Mesh(directions * radius, PrimitiveType.QUADS, indices=quads, normals=directions)


BALL = sphere(9.9, 32, 16)
BOARD = np.zeros((256, 256, 3), np.uint8)
BOARD[:128, :128, 1] = BOARD[128:, 128:, 1] = 255
BOARD[:128, 128:, 2] = BOARD[128:, :128, 2] = 255
# By mode: how s and t are generated, and the colours at the upper left and upper right.
GENERATED = {
    TexGenMode.SPHERE_MAP: ((0.0,) * 4, (0.0,) * 4, BLUE, GREEN),
    TexGenMode.OBJECT_LINEAR: ((0.0, 0.05, 0.0, 1.5), (0.05, 0.0, 0.0, 1.0), GREEN, BLUE),
    TexGenMode.EYE_LINEAR: ((0.0, 0.05, 0.0, 1.0), (0.05, 0.0, 0.0, 1.0), BLUE, GREEN),
}


def generated(mode):
    s, t, left, right = GENERATED[mode]
    unit = TextureUnit(
        "board", NEAREST, gen=(TexGen(mode, s), TexGen(mode, t), TexGen(), TexGen()), environment=REPLACE
    )
    wanted = [
        (50 - x if flipped else x, 50 - y if turned else y, left if flipped != turned else right, 0)
        for x, y in ((13, 13), (4, 22), (22, 4), (20, 20), (20, 10), (10, 20))
        for flipped in (False, True)
        for turned in (False, True)
    ]
    frame = (
        clear(0, 0, 0, 0, depth=1.0),
        TexImage(label="board", texture="board", image=texture_2d(BOARD)),
        draw(BALL, vertex=VertexState(projection=ortho(-10, 10, -10, 10, -10, 10)), texture_units=(unit,)),
    )
    return Case(f"coordinates by {mode.name}", frame, pixels(upwards(wanted, 50)), (50, 50))


# spot-light.c and infinite-spot-light.c: ambient terms of spots alone.
def spot(color, position, **fields):
    return Light(ambient=(*color, 1.0), diffuse=BLACK, specular=BLACK, position=position, **fields)


def ambient_only(*lights, model):
    material = Material(ambient=WHITE, diffuse=BLACK)
    return Lighting(lights=lights, model_ambient=(*model, 1.0), front=material, back=material)


MIDDLE = (15.0, 15.0, 0.0, 1.0)
THREE_SPOTS = ambient_only(
    spot((1, 0, 0), MIDDLE, spot_direction=(-1.0, 0.0, 0.0), spot_cutoff=44.0, spot_exponent=1.0),
    spot((0, 1, 0), MIDDLE, spot_direction=(0.0, 1.0, 0.0), spot_cutoff=60.0, spot_exponent=0.0),
    spot((0, 0, 1), MIDDLE, spot_direction=(1.0, 0.0, 0.0), spot_cutoff=44.0, spot_exponent=5.0),
    model=(0.2, 0.2, 0.2),
)
DARK, BY_RED, BY_GREEN, BY_BLUE = 0x333333, 0xFF3333, 0x33FF33, 0x3333FF
SPOTTED = {
    **{(0, 15): BY_RED, (15, 0): DARK, (30, 15): BY_BLUE, (15, 30): BY_GREEN},
    **{(0, 0): DARK, (0, 30): BY_GREEN, (30, 0): DARK, (30, 30): BY_GREEN},
}
SPOTS = Case(
    "spots of three directions, exponents and cutoffs",
    (
        clear(*BLACK),
        draw(
            Mesh([[3 * x, 3 * y] for x in range(11) for y in range(11)], PrimitiveType.POINTS),
            vertex=VertexState(projection=ortho(0, 64, 0, 64), lighting=THREE_SPOTS),
            point=PointState(size=3.0),
        ),
    ),
    pixels(upwards([(*place, color, 3) for place, color in SPOTTED.items()], 64)),
    (64, 64),
)
ASLANT = spot(
    (1, 0, 0),
    (0.0, 0.0, -1.0, 0.0),
    spot_direction=(0.866025404, 0.0, 0.5),
    spot_exponent=1.0,
    spot_cutoff=89.0,
)
INFINITE = Case(
    "a spot at infinity",
    (
        clear(*BLACK),
        draw(rectangle(-1, -1, 2, 2), vertex=VertexState(lighting=ambient_only(ASLANT, model=(0, 0, 0)))),
    ),
    pixels([(4, 4, 0x800000, 3)]),
    (8, 8),
)

# rescale-normal.c
DIFFUSE = (0.01, 1.0, 0.0, 1.0)
MATTE = Material(ambient=BLACK, diffuse=WHITE)
RESCALED = Case(
    "normals rescaled by a hundred",
    (
        clear(0, 0, 0, 0),
        draw(
            rectangle(-0.01, -0.01, 0.02, 0.02, normals=[[0, 0, 1]] * 4),
            vertex=VertexState(
                modelview=matrix(np.diag([100, 100, 100, 1])),
                rescale_normal=True,
                lighting=Lighting(lights=(Light(diffuse=DIFFUSE),), front=MATTE, back=MATTE),
            ),
        ),
    ),
    pixels([(8, 8, rgb(DIFFUSE), 3)]),
    (16, 16),
)


# two-sided-lighting.c: a front and a back face, each wound either way.
def two_sided(model, separate):
    shine = (1.0, 0.0, 0.0, 0.0) if separate else BLACK
    front, back = [
        Material(ambient=color, diffuse=color, specular=shine)
        for color in ((0, 1.0, 0, 1.0), (0, 0, 1.0, 1.0))
    ]
    lighting = Lighting(
        lights=(Light(),), front=front, back=back, two_side=True, separate_specular_color=separate
    )
    vertex = VertexState(projection=ortho(-1.1, 1.1, -1.1, 1.1), lighting=lighting)
    # Of each quad: the lower left corner, whether its second is above, its normal, its winding.
    quads = (
        (-1, -1, False, 1, FrontFace.CCW),
        (0, -1, True, -1, FrontFace.CCW),
        (-1, 0, False, -1, FrontFace.CW),
        (0, 0, True, 1, FrontFace.CW),
    )
    frame = [clear(0.5, 0.5, 0.5, 0)]
    units = ()
    if separate:
        frame.append(TexImage(label="white", texture="white", image=texture_2d(np.ones((8, 8, 4)))))
        units = (TextureUnit("white", NEAREST),)
    for x, y, above, z, winding in quads:
        second, last = ([x, y + 1], [x + 1, y]) if above else ([x + 1, y], [x, y + 1])
        corners = [[x, y], second, [x + 1, y + 1], last]
        mesh = Mesh(corners, PrimitiveType.QUADS, normals=[[0, 0, z]] * 4)
        polygon = PolygonState(front_face=winding, shade_model=model)
        frame.append(draw(mesh, vertex=vertex, polygon=polygon, texture_units=units))
    ahead, behind = (0xFFFF00, 0xFF00FF) if separate else (GREEN, BLUE)
    wanted = [(16, 16, ahead, 3), (48, 16, behind, 3), (16, 48, behind, 3), (48, 48, ahead, 3)]
    name = f"two-sided lighting{', separate specular' * separate}, {model.name}"
    return Case(name, tuple(frame), pixels(upwards(wanted, 64)), (64, 64))


# user-clip-all-planes.c: six planes cut a rectangle to a polygon, and blue is added: all is teal or black.
def teal_or_black(image):
    wrong = int((image[..., 1] != image[..., 2]).sum())
    teal = int((image[..., 2] > 0).sum())
    return [f"{wrong} pixels are neither, {teal} teal"] if wrong or not teal else []


HALVED = np.diag([0.5, 1.0, 1.0, 1.0])
SIXTHS = np.arange(6) / 6 * 2 * math.pi
# Planes are in eye coordinates; the test gives them in object coordinates.
PLANES = np.stack([-np.cos(SIXTHS), -np.sin(SIXTHS), 0 * SIXTHS, 0 * SIXTHS + 0.5], -1) @ np.linalg.inv(
    HALVED
)
HEXAGON = (
    np.stack([np.cos(SIXTHS + math.pi / 6), np.sin(SIXTHS + math.pi / 6)], -1) * 0.5 / math.cos(math.pi / 6)
)
SIX_PLANES = Case(
    "six user clip planes cut as the polygon is drawn",
    (
        clear(*BLACK),
        draw(
            rectangle(-2, -1, 4, 2, color=(0, 1, 0, 1)),
            vertex=VertexState(modelview=matrix(HALVED), clip_planes=matrix(PLANES)),
        ),
        draw(
            Mesh(HEXAGON, PrimitiveType.POLYGON, colors=[(0, 0, 1, 1)] * 6),
            vertex=VertexState(modelview=matrix(HALVED)),
            blending=Blending(BlendFactor.ONE, BlendFactor.ONE),
        ),
    ),
    teal_or_black,
    (160, 160),
)
BEYOND = Case(
    "a user clip plane beyond the window's edge",
    (
        clear(0.5, 0.5, 0.5, 1),
        draw(
            Mesh([[-1, 1, 0], [2, 0, 1], [-1, -1, 0]], colors=[(0, 1, 0), (1, 0, 0), (0, 1, 0)]),
            vertex=VertexState(clip_planes=((0.0, 0.0, -1.0, 0.5),)),
        ),
    ),
    pixels(upwards([(30, 16, 0x808080, 3)], 32)),
    (32, 32),
)
OUTLINE = PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE)
EDGES = Case(
    "edge flags",
    (
        clear(0, 0, 0, 0),
        draw(
            Mesh(
                [[1.5, 1.5], [5.5, 1.5], [5.5, 5.5], [1.5, 5.5]],
                PrimitiveType.POLYGON,
                colors=[(0, 1, 0, 0)] * 4,
                edge_flags=[True, False, True, False],
            ),
            vertex=VertexState(projection=ortho(0, 16, 0, 16)),
            polygon=OUTLINE,
        ),
    ),
    pixels(upwards([(3, 1, GREEN, 3), (3, 5, GREEN, 3), (1, 3, 0, 3), (5, 3, 0, 3)], 16)),
    (16, 16),
)

# triangle-guardband-viewport.c: what reaches beyond the viewport is not drawn there.
GUARD_BAND = Case(
    "a quad that reaches beyond the viewport",
    (
        clear(*BLACK),
        draw(rectangle(-1, -1, 4, 4), vertex=VertexState(viewport=Viewport(0, 0, 8, 16))),
    ),
    pixels([(4, 8, 0xFFFFFF, 0), (7, 8, 0xFFFFFF, 0), (8, 8, 0, 0), (10, 8, 0, 0)]),
    (16, 16),
)

# linestipple.c: lines along rows and columns; the pattern starts again at each line of LINES alone.
TYPE = PrimitiveType
STIPPLED = {
    "whole": (TYPE.LINES, [(0, 0), (24, 0)], 1, 0xFFFF),
    "aaaa": (TYPE.LINES, [(0, 0), (24, 0)], 1, 0xAAAA),
    "aaaa by two": (TYPE.LINES, [(0, 0), (24, 0)], 2, 0xAAAA),
    "started again": (TYPE.LINES, [(0, 2), (24, 2), (0, 4), (24, 4)], 1, 0x00FF),
    "along a strip": (TYPE.LINE_STRIP, [(0, 6), (24, 6), (24, 30)], 1, 0x00FF),
    "around a loop": (TYPE.LINE_LOOP, [(26, 0), (31, 0), (31, 5), (26, 5)], 1, 0x0F0F),
    "along a strip by three": (TYPE.LINE_STRIP, [(0, 6), (24, 6), (24, 30)], 3, 0x5555),
}


def stippled(name):
    primitive, vertices, factor, pattern = STIPPLED[name]
    ends = [*vertices, vertices[0]] if primitive == TYPE.LINE_LOOP else vertices
    lines = list(pairwise(ends))[:: 2 if primitive == TYPE.LINES else 1]
    wanted, count = [], 0
    for (x, y), end in lines:
        if primitive == TYPE.LINES:
            count = 0
        step = np.sign(np.subtract(end, (x, y))).tolist()
        while (x, y) != end:
            wanted.append((x + 10, y + 10, 0xFFFFFF * (pattern >> (count // factor & 15) & 1), 3))
            x, y, count = x + step[0], y + step[1], count + 1
    mesh = Mesh([[x + 10.5, y + 10.5] for x, y in vertices], primitive)
    vertex = VertexState(projection=ortho(0, 64, 0, 64))
    frame = clear(0, 0, 0, 0), draw(mesh, vertex=vertex, line=LineState(stipple=(factor, pattern)))
    return Case(f"line stipple, {name}", frame, pixels(upwards(wanted, 64)), (64, 64))


# clipflat.c: the provoking vertices of each primitive are green, the others red, and it is clipped.
A, B, C, D = [0, 0], [1, 0], [1, 1], [0, 1]
FLAT = {
    TYPE.TRIANGLES: ([A, B, C, A, C, D], (2, 5)),
    TYPE.TRIANGLE_STRIP: ([A, B, D, C], (2, 3)),
    TYPE.TRIANGLE_FAN: ([A, B, C, D], (2, 3)),
    TYPE.QUADS: ([A, B, C, D], (3,)),
    TYPE.QUAD_STRIP: ([A, B, D, C], (3,)),
    TYPE.POLYGON: ([A, B, C, D], (0,)),
}
MOVES = [(x, y) for x in (-1.5, -0.5, 0.5) for y in (-1.5, -0.5, 0.5)]


def flat(primitive, x, y):
    vertices, provoking = FLAT[primitive]
    colors = [(0, 1, 0, 1) if number in provoking else (1, 0, 0, 1) for number in range(len(vertices))]
    mesh = Mesh(np.add(vertices, (x, y)), primitive, colors=colors)
    seen = [min(max(place + 0.5, -0.95), 0.95) for place in (x, y)]
    wanted = upwards([(*[(place + 1) * 20 for place in seen], GREEN, 3)], 40)
    frame = clear(0, 0, 0, 0), draw(mesh, polygon=PolygonState(shade_model=ShadeModel.FLAT))
    return Case(f"flat {primitive.name} at {x}, {y}", frame, pixels(wanted), (40, 40))


# point-attenuation.c: sizes of points at z from -6 to 6, measured in a window's rows. EXT_point_parameters'
# distance is from the eye, and piglit's |z| stands for it; both are allowed.
SIZES = ((1.0, 1.0, 1.0), (1.0, 21.0, 9.0), (1.0, 21.0, 17.0), (11.0, 21.0, 17.0), (11.0, 11.0, 9.0))


def attenuated(constant, linear, quadratic, smallest, largest, size):
    if largest == smallest:
        parameters = PointParameters(minimum=smallest)
    else:
        reach = largest - smallest
        by = (reach / size) ** 2
        parameters = PointParameters(
            (constant * by, linear * by, quadratic * by), -smallest / reach, reach, smallest
        )
    mesh = Mesh([[0, z, z] for z in range(-6, 7)], PrimitiveType.POINTS)
    point = draw(
        mesh,
        vertex=VertexState(projection=ortho(-10, 10, -10, 10, -10, 10)),
        point=PointState(size=size, parameters=parameters),
    )

    def expected(image):
        found = []
        for z in range(-6, 7):
            y = 502 - int((z + 10) / 20 * 503)
            wide = max(int((image[y + row, :, 0] > 0).sum()) for row in (-1, 0, 1))
            sizes = [
                min(max(size / math.sqrt(constant + linear * d + quadratic * d * d), smallest), largest)
                for d in (abs(z), abs(z) * math.sqrt(2))
            ]
            if min(abs(wide - wanted) for wanted in sizes) > 1.05:
                found.append(f"at z {z} a point is {wide} wide and not {sizes}")
        return found

    name = f"points by {constant}, {linear}, {quadratic}, {size} in {smallest} to {largest}"
    return Case(name, (clear(0, 0, 0, 0), point), expected, (32, 503))


CASES = (
    *map(generated, GENERATED),
    SPOTS,
    INFINITE,
    RESCALED,
    *[two_sided(model, separate) for model in ShadeModel for separate in (False, True)],
    SIX_PLANES,
    BEYOND,
    EDGES,
    GUARD_BAND,
    *map(stippled, STIPPLED),
    *[flat(primitive, x, y) for primitive in FLAT for x, y in MOVES],
    *[
        attenuated(*factors, *sizes)
        for factors in product((1.0, 0.01), (1.0, 0.0, 0.1), (0.0, 0.1, 100.0))
        for sizes in SIZES
    ],
)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES))
def test_vertices_are_what_piglit_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=542)


# polygon-offset.c: the depth of a turned square moves by its slope, within what OpenGL allows of a slope.
PERSPECTIVE = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, -2], [0, 0, -1, 0]])
SIDE = 400


def turned(angle, axis):
    """A turn about an axis, two and a half before the eye."""
    axis = np.array(axis) / np.linalg.norm(axis)
    x, y, z = axis
    sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    result = np.eye(4)
    result[:3, :3] = cosine * np.eye(3) + sine * cross + (1 - cosine) * np.outer(axis, axis)
    result[2, 3] = -2.5
    return result


def depths(machine, modelview, factor):
    vertex = VertexState(modelview=matrix(modelview), projection=matrix(PERSPECTIVE))
    polygon = PolygonState(offset_fill=factor != 0, offset_factor=float(factor))
    frame = (
        clear(0, 0, 0, 0, depth=1.0),
        draw(rectangle(-1, -1, 2, 2), vertex=vertex, depth_test=DepthTest(), polygon=polygon),
        ReadPixels(label="depths", name="z", format="DEPTH_COMPONENT"),
    )
    return execute(frame, PROFILES[machine], SIDE, SIDE, depth_bits=24).pixels["z"] / (2**24 - 1)


@pytest.mark.parametrize("machine", [m for m in MACHINES if m not in ("IDEAL", "INFINITE_REALITY")])
@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)])
def test_an_offset_by_slope_is_within_what_opengl_allows(machine, axis):
    for angle in (0, 30, 45, 60, 80):
        modelview = turned(angle, axis)

        def pixel(x, y, modelview=modelview):
            clip = PERSPECTIVE @ modelview @ (x, y, 0, 1)
            return [int(place) for place in (clip[:2] / clip[3] + 1) * (SIDE / 2)]

        plain = depths(machine, modelview, 0)
        (x0, y0), (x1, y1), (x2, y2) = [pixel(*place) for place in ((-0.9, -0.9), (0.9, -0.9), (0.9, 0.9))]
        edges = np.array([[x1 - x0, y1 - y0], [x2 - x0, y2 - y0]])
        by_x, by_y = np.linalg.solve(edges, [plain[y1, x1] - plain[y0, x0], plain[y2, x2] - plain[y0, x0]])
        least, most = 0.9 * max(abs(by_x), abs(by_y)), 1.1 * math.hypot(by_x, by_y) + 2 / 2**24
        x, y = pixel(0, 0)
        for factor in (1, 2):
            moved = max(plain[y, x] - depths(machine, modelview, -factor)[y, x], 0)
            assert factor * least <= moved <= factor * most, (angle, factor)
