"""Texture coordinates, projection, volumes, levels, Y'CbCr words and point sprites. Source: WineHQ, wine,
dlls/d3d9/tests/visual.c, projected_textures_test, texture_transform_flags_test, maxmip_test and
yuv_color_test; dlls/d3d8/tests/visual.c, test_pointsize.
"""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline import TexImage, TextureEnvironment, TextureUnit, texture_2d, texture_3d
from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import (
    InternalFormat,
    PrimitiveType,
    TexelWord,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
)
from fixedpipe.pipeline.state import PointState
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.textures.words import texture_of_words
from tests.foreign.comparison import Case, assert_drawn, assert_held, on_machines, pixels
from tests.foreign.direct3d import POINT, POINT_CLAMPED, clear, draw, matrix, strip, texels, vertex_state

FULL, SIZE = (640, 480), (64, 48)
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
CORNERS = [[0, 0], [0, 1], [1, 0], [1, 1]]


def rows(**given):
    """A texture matrix of D3D's rows: r1 to r4, zeros where nothing is given; a column is an output."""
    return matrix(np.array([given.get(f"r{row}", [0] * 4) for row in (1, 2, 3, 4)]).T)


# projected_textures_test: one white texel of four by four, seen through coordinates of 0 to 4, 4 and 6.
DOT = np.zeros((4, 4, 1), np.uint8)
DOT[1, 1] = 255
DOT_LOAD = TexImage(label="a white texel", texture="dot", image=texture_2d(DOT, InternalFormat.LUMINANCE8))
IDENTITY = matrix(np.eye(4))
BY_THIRD = (*IDENTITY[:3], (0.0, 0.0, 1.0, 0.0))
UNDIVIDED = (*IDENTITY[:3], (0.0, 0.0, 0.0, 1 / 6))
# By name: the texture matrix, the quarter's lower left corner, and the texel's left, top, right and bottom.
PROJECTED = {
    "by q": (IDENTITY, (-1, -1), (120, 300, 240, 390)),
    "by q, top left": (IDENTITY, (-1, 0), (120, 60, 240, 150)),
    "by the third coordinate": (BY_THIRD, (0, -1), (400, 360, 480, 420)),
    "by the third coordinate, top left": (BY_THIRD, (-1, 0), (80, 120, 160, 180)),
    "not at all": (UNDIVIDED, (0, 0), (340, 210, 360, 225)),
}


def projected(name):
    by, (x, y), (left, top, right, bottom) = PROJECTED[name]
    quarter = [[x, y, 0.1], [x, y + 1, 0.1], [x + 1, y, 0.1], [x + 1, y + 1, 0.1]]
    mesh = strip(quarter, texture_coordinates=([[4 * s, 4 * t, 4, 6] for s, t in CORNERS],))
    unit = TextureUnit("dot", POINT_CLAMPED, matrix=by, environment=REPLACE)
    wanted = [
        (across, down, 0xFFFFFF * (left < across < right and top < down < bottom), 0)
        for across in (left - 1, left + 1, right - 1, right + 1)
        for down in (top - 1, top + 1, bottom - 1, bottom + 1)
    ]
    frame = clear(0xFF203040), DOT_LOAD, draw(mesh, FULL, texture_units=(unit,))
    return Case(f"projected {name}", frame, pixels(wanted), FULL)


# texture_transform_flags_test: a ramp of v in red and u in green, and a volume whose colour is u, v, w.
RAMP = np.zeros((256, 256, 3), np.uint8)
RAMP[..., 0], RAMP[..., 1] = np.arange(256)[:, None], np.arange(256)
STEPS = np.arange(32) / 31
VOLUME = np.stack(np.meshgrid(STEPS, STEPS, STEPS, indexing="ij")[::-1], -1)
LOADS = {
    "ramp": TexImage(label="ramp", texture="ramp", image=texture_2d(RAMP)),
    "volume": TexImage(label="volume", texture="volume", image=texture_3d(VOLUME)),
}
LAST_ONLY = rows(r4=[0, 0, 0, 1])
# By name: the texture, a vertex's coordinates, the matrix, the colour, the tolerance.
TRANSFORMED = {
    "no matrix": ("ramp", [1, 1], IDENTITY, 0xFFFF00, 1),
    "zeros": ("ramp", [1, 1], LAST_ONLY, 0x000000, 1),
    "zeros, other coordinates": ("ramp", [0.5, 1], LAST_ONLY, 0x000000, 1),
    "the third becomes u": ("ramp", [0.5, 0.5, 1, 0], rows(r3=[1, 0, 0, 1], r4=[0, 1, 0, 0]), 0x00FF00, 1),
    "the third becomes v": ("ramp", [0.8, 0.2, 1, 0], rows(r3=[0, 1, 0, 1]), 0xFF0000, 1),
    "v and w change places": (
        "volume",
        [1, 1, 1],
        rows(r1=[1, 0, 0, 0], r2=[0, 0, 1, 0], r3=[0, 1, 0, 0], r4=[0, 0, 0, 1]),
        0xFFFFFF,
        0,
    ),
    "w becomes 0": (
        "volume",
        [1, 1, 1],
        rows(r1=[1, 0, 0, 0], r3=[0, 1, 0, 0], r4=[0, 0, 0, 1]),
        0xFFFF00,
        0,
    ),
    "w alone": ("volume", [0, 0, 1], IDENTITY, 0x0000FF, 0),
    "the fourth becomes v": ("volume", [1, 1, 1, 1], rows(r4=[0, 1, 0, 1]), 0x00FF00, 0),
    "three zeros": ("volume", [0, 0, 0], IDENTITY, 0x000000, 0),
}


def transformed_coordinates(name):
    texture, vertex, by, color, tolerance = TRANSFORMED[name]
    unit = TextureUnit(texture, POINT_CLAMPED, matrix=by, environment=REPLACE)
    mesh = strip(texture_coordinates=([vertex] * 4,))
    frame = clear(0xFF0000FF), LOADS[texture], draw(mesh, SIZE, texture_units=(unit,))
    return Case(f"{texture}, {name}", frame, pixels([(32, 24, color, tolerance)]), SIZE)


# maxmip_test: levels of 128, 64 and 32 texels, red, green and blue, of which the first may be left out.
LEVELS = tuple(
    np.full((1, side, side, 4), color, np.uint8)
    for side, color in ((128, (255, 0, 0, 255)), (64, (0, 255, 0, 255)), (32, (0, 0, 255, 255)))
)
LEVELS_LOAD = TexImage(
    label="three levels",
    texture="levels",
    image=Texture(TextureTarget.TEXTURE_2D, InternalFormat.RGBA8, LEVELS),
)
QUARTER = strip([[-1, -1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 0]], texture_coordinates=(CORNERS,))


def first_level(number, min_filter):
    sampler = replace(POINT, min_filter=min_filter, min_lod=float(number), max_level=2)
    colors = 0xFF0000, 0x00FF00, 0x0000FF, 0x0000FF
    color = colors[0] if min_filter == TextureFilter.NEAREST else colors[number]
    unit = TextureUnit("levels", sampler, environment=REPLACE)
    frame = clear(0xFFFFFFFF), LEVELS_LOAD, draw(QUARTER, FULL, texture_units=(unit,))
    return Case(f"{min_filter.name} from level {number}", frame, pixels([(160, 360, color, 0)]), FULL)


# yuv_color_test: words, and what is drawn of their first and their second texel.
WORDS = {
    TexelWord.UYVY: (
        *((0x00000000, 0x008700, 0x008700), (0xFF000000, 0x008700, 0x4BFF1C)),
        *((0x00FF0000, 0xB30000, 0xB30000), (0x0000FF00, 0x4BFF1C, 0x008700)),
        *((0x000000FF, 0x0030E1, 0x0030E1), (0xFFFF0000, 0xB30000, 0xFFD01C)),
        *((0xFF00FF00, 0x4BFF1C, 0x4BFF1C), (0xFF0000FF, 0x0030E1, 0x4BFFFF)),
        *((0x00FFFF00, 0xFFD01C, 0xB30000), (0x00FF00FF, 0xB300E1, 0xB300E1)),
        *((0x0000FFFF, 0x4BFFFF, 0x1030E1), (0xFFFFFF00, 0xFFD01C, 0xFFD01C)),
        *((0xFFFF00FF, 0xB300E1, 0xFF79FF), (0xFFFFFFFF, 0xFF79FF, 0xFF79FF)),
        *((0x4CFF4C54, 0xFF0000, 0xFF0000), (0x00800080, 0x000000, 0x000000)),
        *((0xFF80FF80, 0xFFFFFF, 0xFFFFFF), (0x1C6B1CFF, 0x0000FD, 0x0000FD)),
    ),
    TexelWord.YUY2: (
        *((0x00000000, 0x008700, 0x008700), (0xFF000000, 0xB30000, 0xB30000)),
        *((0x00FF0000, 0x008700, 0x4BFF1C), (0x0000FF00, 0x0030E1, 0x0030E1)),
        *((0x000000FF, 0x4BFF1C, 0x008700), (0xFFFF0000, 0xB30000, 0xFFD01C)),
        *((0xFF00FF00, 0xB300E1, 0xB300E1), (0xFF0000FF, 0xFFD01C, 0xB30000)),
        *((0x00FFFF00, 0x0030E1, 0x4BFFFF), (0x00FF00FF, 0x4BFF1C, 0x4BFF1C)),
        *((0x0000FFFF, 0x4BFFFF, 0x0030E1), (0xFFFFFF00, 0xB300E1, 0xFF79FF)),
        *((0xFFFF00FF, 0xFFD01C, 0xFFD01C), (0xFFFFFFFF, 0xFF79FF, 0xFF79FF)),
        *((0x4CFF4C54, 0x0B8B00, 0xB6FFA3), (0x00800080, 0x00FF00, 0x00FF00)),
        *((0xFF80FF80, 0xFF00FF, 0xFF00FF), (0x1C6B1CFF, 0x6DFF45, 0x00D500)),
    ),
}


def video(kind, word, left, right):
    image = texture_of_words(np.array([[word & 0xFFFF, word >> 16]]), kind)
    mesh = strip(texture_coordinates=(CORNERS,))
    unit = TextureUnit("video", POINT, environment=REPLACE)
    load = TexImage(label="two texels", texture="video", image=image)
    frame = clear(0), load, draw(mesh, SIZE, texture_units=(unit,))
    wanted = pixels([(1, 24, left, 18), (62, 24, right, 18)])
    return Case(f"{kind.name} {word:08x}", frame, wanted, SIZE)


# test_pointsize: sprites of 32 pixels around (64, 64), which stage 3 draws.
SPRITES = {
    "its own colours": ([[0x00FF0000] * 2, [0, 0]], (0xFF0000, 0, 0, 0xFF0000)),
    "columns": ([[0, 0x0000FF00]] * 2, (0, 0, 0x00FF00, 0x00FF00)),
}
TO_PIXELS = [[2 / 640, 0, 0, 0], [0, -2 / 480, 0, 0], [0, 0, 1, 0], [-1, 1, 0, 1]]


def sprite(name):
    words, colors = SPRITES[name]
    units = (None, None, None, TextureUnit("sprite", POINT, coord_replace=True, environment=REPLACE))
    point = draw(
        Mesh([[64, 64, 0.1]], PrimitiveType.POINTS),
        FULL,
        vertex=vertex_state(FULL, projection=TO_PIXELS),
        point=PointState(size=32.0, sprite=True),
        texture_units=units,
    )
    load = TexImage(label="sprite", texture="sprite", image=texture_2d(texels(words)))
    at = (60, 60), (60, 68), (68, 68), (68, 60)
    wanted = pixels([(*place, color, 0) for place, color in zip(at, colors, strict=True)])
    return Case(f"sprite of {name}", (clear(0xFF0000FF), load, point), wanted, FULL)


CASES = (
    *map(projected, PROJECTED),
    *map(transformed_coordinates, TRANSFORMED),
    *[
        first_level(number, min_filter)
        for number in range(4)
        for min_filter in (
            TextureFilter.NEAREST,
            TextureFilter.NEAREST_MIPMAP_NEAREST,
            TextureFilter.NEAREST_MIPMAP_LINEAR,
        )
    ],
    *[video(kind, *row) for kind, words in WORDS.items() for row in words],
    *map(sprite, SPRITES),
)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES, {}))
def test_textures_are_what_wine_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_somewhere():
    assert_held(CASES, refused=279)
