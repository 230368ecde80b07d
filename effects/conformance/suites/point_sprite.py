"""Point_sprite: textured points, of one size and shrunk to a pixel, with and without alpha test; and polygons
drawn as points.

Source: src/tests/point_sprite_tests.cpp of nxdk_pgraph_tests, texture_generator.cpp of pbkitplusplus.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    ComponentUsage,
    Face,
    FrontFace,
    PolygonMode,
    PrimitiveType,
    Register,
)
from fixedpipe.pipeline.state import (
    AlphaPortion,
    AlphaTest,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    PointParameters,
    PointState,
    PolygonState,
    RegisterCombiners,
    RGBPortion,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Point_sprite"

TEXTURE = "sprite"
UNITS = (None, None, None, TextureUnit(TEXTURE, scenes.NEAREST, coord_replace=True))
SHOWS_TEXTURE3 = scenes.shows(Register.TEXTURE3)
ORIGIN = (np.zeros((1, 2)),)  # a point's own texture coordinates, which sprites replace
LARGEST = 63.875  # pixels: what the register makes of 64
NEAR = -6.0  # world z of points at the near plane, where the program's points of screen depth 1 lie


def quarters(size):
    """uint8 [size, size, 4]: four quarters of ramps; alpha from 0 in the corners to 255 in the middle."""
    half = size // 2
    at = np.arange(size)
    ramp = ((at % half).astype(np.float32) * np.float32(255) / np.float32(half)).astype(np.int64)
    across, down = np.meshgrid(ramp, ramp)
    square = (at.astype(np.float32) - np.float32(half)) ** 2
    distance = (square[None] + square[:, None]) / np.float32(2 * half * half)
    alpha = (np.float32(255) * (np.float32(1) - distance)).astype(np.int64)
    return np.stack([255 - down, across, down, alpha], axis=-1).astype(np.uint8)


def _alpha_test():
    white = np.ones((1, 4))
    sprite = PointState(size=LARGEST, sprite=True)
    tiny = PointParameters(
        (0.0, 0.0, 2.7125650614578944e-09),
        -2.0000399672426283e-05,
        0.9999799728393555,
        1.9999999494757503e-05,
    )
    draws = []
    for y, test in ((96.0, None), (192.0, AlphaTest(ComparisonFunction.GREATER, 0x7F / 255))):
        x = 180.0
        for point in (sprite, replace(sprite, parameters=tiny)):
            for combiners in (SHOWS_TEXTURE3, scenes.SHOWS_PRIMARY):
                state = replace(
                    scenes.DEFAULT,
                    vertex=scenes.xdk_vertex(near=0.5),
                    point=point,
                    texture_units=UNITS,
                    register_combiners=combiners,
                    alpha_test=test,
                )
                at = scenes.single([scenes.unprojected(x, y, NEAR)])
                mesh = Mesh(at, PrimitiveType.POINTS, colors=white, texture_coordinates=ORIGIN)
                draws.append(Draw(label="sprite", mesh=mesh, state=state))
                x += 96.0
    return Case(
        commands=(
            scenes.clear(0xFF333333),
            TexImage(label=TEXTURE, texture=TEXTURE, image=texture_2d(quarters(64))),
            *draws,
        )
    )


def _alpha(register):
    return CombinerInput(register, usage=ComponentUsage.ALPHA)


# Texture alpha times colour alpha, then the colour.
MASK = RegisterCombiners(
    general=(
        GeneralCombiner(
            rgb=RGBPortion(sum_output=Register.DISCARD),
            alpha=AlphaPortion(a=_alpha(Register.PRIMARY_COLOR), b=_alpha(Register.TEXTURE3)),
        ),
        GeneralCombiner(alpha=AlphaPortion(sum_output=Register.DISCARD)),
    ),
    final=FinalCombiner(
        a=CombinerInput(), b=CombinerInput(), c=CombinerInput(), d=CombinerInput(Register.SPARE0)
    ),
)


def _alpha_mask(stage):
    x, y = np.meshgrid(np.arange(32), np.arange(32))
    texels = np.zeros((32, 32, 4), np.uint8)
    texels[..., 3] = (x * 8) ^ (y * 8)
    state = replace(scenes.DEFAULT, texture_units=UNITS, register_combiners=MASK)
    black = np.array([(0.0, 0.0, 0.0, 1.0)])
    tests = (None, *(AlphaTest(ComparisonFunction.GREATER, reference / 255) for reference in (1, 128)))
    shrunk = PointParameters((0.0204081628, 0.0, 0.0), 0.0, 64.0, 0.0)
    draws = []
    for row, size in ((150.0, 32.0), (250.0, 40.0), (350.0, 48.0)):
        for column, test in zip((130.0, 250.0, 370.0), tests, strict=True):
            at = scenes.single([scenes.unprojected(column, row, 1.0)])
            if stage == "VS":
                mesh = scenes.window_mesh(
                    vertex_programs.perspective(at),
                    PrimitiveType.POINTS,
                    colors=black,
                    point_sizes=[size],
                    texture_coordinates=ORIGIN,
                )
                drawn = replace(state, point=PointState(sprite=True, program_size=True))
            else:
                mesh = Mesh(at, PrimitiveType.POINTS, colors=black, texture_coordinates=ORIGIN)
                point = PointState(size=size, sprite=True, parameters=shrunk)
                drawn = replace(state, vertex=scenes.xdk_vertex(), point=point)
            draws.append(Draw(label="sprite", mesh=mesh, state=replace(drawn, alpha_test=test)))
        offset = 0.0 if stage == "VS" else scenes.XDK_OFFSET
        left, top = 490.0 - size / 2 + offset, row - size / 2 + offset
        corners = scenes.window_mesh(
            scenes.rectangle(left, top, left + size, top + size),
            colors=black.repeat(4, axis=0),
            texture_coordinates=(scenes.UNIT_SQUARE,),
        )
        draws.append(Draw(label="quad", mesh=corners, state=replace(state, alpha_test=tests[1])))
    return Case(
        commands=(
            scenes.clear(0xFFAACCCC),
            TexImage(label=TEXTURE, texture=TEXTURE, image=texture_2d(texels)),
            *draws,
        )
    )


# What the polygon mode draws as points: x, y, s and t of the vertices.
ZIGZAG = ((0.0, 20.0, 0.0, 1.0), (20.0, 0.0, 0.0, 0.0), (40.0, 20.0, 1.0, 1.0), (60.0, 0.0, 1.0, 0.0))
SHAPES = (
    (
        PrimitiveType.LINES,
        ((0.0, 0.0, 0.0, 0.0), (20.0, 10.0, 1.0, 1.0), (40.0, 10.0, 0.0, 0.5), (60.0, 10.0, 1.0, 0.5)),
    ),
    (PrimitiveType.LINE_STRIP, ZIGZAG),
    (PrimitiveType.LINE_LOOP, ZIGZAG),
    (PrimitiveType.TRIANGLES, ZIGZAG),
    (PrimitiveType.TRIANGLE_STRIP, ZIGZAG),
    (
        PrimitiveType.TRIANGLE_FAN,
        ((30.0, 20.0, 0.5, 1.0), (0.0, 0.0, 0.0, 0.0), (30.0, 0.0, 0.5, 0.0), (60.0, 0.0, 1.0, 0.0)),
    ),
    (
        PrimitiveType.QUADS,
        ((0.0, 0.0, 0.0, 0.0), (40.0, 0.0, 1.0, 0.0), (40.0, 20.0, 1.0, 1.0), (0.0, 20.0, 0.0, 1.0)),
    ),
    (
        PrimitiveType.QUAD_STRIP,
        (
            (0.0, 20.0, 0.0, 1.0),
            (0.0, 0.0, 0.0, 0.0),
            (30.0, 20.0, 0.5, 1.0),
            (30.0, 0.0, 0.5, 0.0),
            (60.0, 20.0, 1.0, 1.0),
            (60.0, 0.0, 1.0, 0.0),
        ),
    ),
)


def _polygon_mode():
    texels = np.zeros((8, 8, 4), np.uint8)
    texels[:4, :4], texels[:4, 4:] = (255, 0, 0, 255), (0, 255, 0, 255)
    texels[4:, :4], texels[4:, 4:] = (0x66, 0, 0x66, 255), (0x66, 0x66, 0, 255)
    point = PolygonMode.POINT
    draws = []
    for x, sprite in ((200.0, False), (400.0, True)):
        state = replace(
            scenes.DEFAULT,
            polygon=PolygonState(
                cull_face=Face.BACK, front_face=FrontFace.CW, front_mode=point, back_mode=point
            ),
            point=PointState(size=8.0, sprite=sprite),
            texture_units=UNITS,
            register_combiners=SHOWS_TEXTURE3,
        )
        for i, (primitive, vertices) in enumerate(SHAPES):
            corner = np.array([x + (40.0 if i % 2 else -40.0), 25.0 + (2 + 2 * i) * 25.0])
            at = np.array(vertices)
            mesh = scenes.window_mesh(
                at[:, :2] + corner + scenes.XDK_OFFSET, primitive, texture_coordinates=(at[:, 2:],)
            )
            draws.append(Draw(label=primitive.name, mesh=mesh, state=state))
    return Case(
        commands=(
            scenes.clear(0xFF333333),
            TexImage(label=TEXTURE, texture=TEXTURE, image=texture_2d(texels)),
            *draws,
        )
    )


CASES = {
    "AlphaTest": _alpha_test,
    "AlphaMask_FF": partial(_alpha_mask, "FF"),
    "AlphaMask_VS": partial(_alpha_mask, "VS"),
    "PolygonMode_Point": _polygon_mode,
}
