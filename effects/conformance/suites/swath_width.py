"""Swath_width: lines, polygons, points and a texture on a surface of two samples a pixel, then on the window.

Source: src/tests/swath_width_tests.cpp of nxdk_pgraph_tests. The surface (CENTER_CORNER_2) is twice as wide
as the window, with two samples for each pixel; a linear filter between them takes their mean. Measured: the
swath's width changes nothing (SwathWidth00 and 02 differ in their texts alone), and both samples have the
colours and texels of the pixel's middle.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter, TextureTarget, WindowOrigin
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Swath_width"

SURFACE, SAMPLES = "samples", 2
BACKGROUND = (0x3322AAAA, 0x33AA22AA)
TOP = 65.0
# x, y and colour of the vertices.
SHAPES = (
    (
        PrimitiveType.LINE_LOOP,
        (
            (10, TOP, 0xCF0000FF),
            (100, TOP - 10, 0xFF00FFFF),
            (300, TOP, 0xFFFFFF00),
            (600, TOP + 10, 0xFFFFFFFF),
            (200, TOP + 30, 0x6FFFFFFF),
        ),
    ),
    *(
        (
            primitive,
            (
                (20, top, 0xCF0000FF),
                (120, top - 10, 0xFF00FFFF),
                (80, top + 10, 0xFFFFFF00),
                (280, top, 0xFFFFFFFF),
            ),
        )
        for primitive, top in ((PrimitiveType.TRIANGLE_STRIP, TOP + 50), (PrimitiveType.POINTS, TOP + 100))
    ),
    (
        PrimitiveType.POLYGON,
        (
            (20, TOP + 150, 0xCF0000FF),
            (120, TOP + 140, 0xFF00FFFF),
            (280, TOP + 162, 0xFFFFFFFF),
            (580, TOP + 195, 0xFFFF00FF),
            (80, TOP + 180, 0xFFFFFF00),
        ),
    ),
)
DIAMOND = 256 * 1.4  # pixels, its diagonals


def _surface():
    """Commands that draw the scene with two samples and make a texture of them."""
    state = replace(scenes.DEFAULT, polygon=scenes.FRONT_FACES)
    squares = [
        corner
        for x in range(0, WIDTH, 32)
        for y in range(0, HEIGHT, 64)
        if (x // 32 + y // 64) % 2 == 1
        for corner in scenes.rectangle(x, y, x + 32, y + 64)
    ]
    colors = np.array([scenes.argb(BACKGROUND[1])] * len(squares))
    draws = [
        scenes.clear(BACKGROUND[0]),
        Draw(
            label="background",
            mesh=scenes.window_mesh(squares, colors=colors),
            state=replace(state, blending=None),
        ),
    ]
    for primitive, vertices in SHAPES:
        positions = np.array([(x, y) for x, y, _ in vertices], float)
        colors = np.array([scenes.abgr(color) for *_, color in vertices])
        mesh = scenes.window_mesh(positions, primitive, colors=colors)
        draws.append(Draw(label=primitive.name, mesh=mesh, state=state))
    x, y, half = WIDTH / 2, HEIGHT / 2, DIAMOND / 2
    corners = [(x, y - half, 0.0), (x + half, y, 0.0), (x, y + half, 0.0), (x - half, y, 0.0)]
    draws.append(scenes.textured_quad("diamond", corners, "checkerboard", state))
    return (
        MakeCurrent(label=SURFACE, surface=SURFACE, width=WIDTH, height=HEIGHT, samples=SAMPLES),
        *draws,
        BindTexImage(
            label=SURFACE,
            texture=SURFACE,
            surface=SURFACE,
            target=TextureTarget.TEXTURE_RECTANGLE,
            origin=WindowOrigin.UPPER_LEFT,
        ),
        MakeCurrent(label="window"),
    )


def _case():
    small = scenes.checkerboard(0x33FFFFFF, 0xD0000000, 16)
    wide = SAMPLES * WIDTH
    texels = np.array([(0, 0), (wide, 0), (wide, HEIGHT), (0, HEIGHT)])
    sampler = replace(scenes.NEAREST, min_filter=TextureFilter.LINEAR, mag_filter=TextureFilter.LINEAR)
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit(SURFACE, sampler),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    window = scenes.window_mesh(scenes.rectangle(0, 0, WIDTH, HEIGHT), texture_coordinates=(texels,))
    return Case(
        commands=(
            TexImage(label="checkerboard", texture="checkerboard", image=texture_2d(small)),
            scenes.clear(0xFF222322),
            *_surface(),
            Draw(label="shown", mesh=window, state=state),
        )
    )


CASES = {f"SwathWidth{width}": _case for width in ("00", "01", "02", "03", "04", "0F")}
