"""Texture_border: a small texture under every wrap mode, on panels of three by three tiles; textures with
borders.

A texture with border texels (2D_BorderTex_SZ, 3D, cube maps) lies in memory as a texture of twice the size,
at least 16 texels along an edge. Its first texel is four from the corner. Here it has its texels and the four
on either side; coordinates reach no others. Source: src/tests/texture_border_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import host_matrices, scenes, vertex_programs
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.conformance.suites import texture_cubemap
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TexelWord, TextureFilter, TextureTarget, WrapMode
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Texture_border"
OPEN = "ties between texels of the border"

SIZE, CELL = 32, 2
COLORS = (0xFFFF0000, 0x66FF0000, 0xFF00FF00, 0x6600FF00, 0xFF4444FF, 0x664444FF, 0xFFFFFFFF, 0x66FFFFFF)
LEFT, RIGHT, TOP, BOTTOM, SPACING, DEPTH = -2.75, 2.75, 1.75, -1.75, 0.1, 1.0
PANEL = (RIGHT - LEFT - 2 * SPACING) / 3, (TOP - BOTTOM - SPACING) / 2
TOPS = (TOP + PANEL[1] / 4 + SPACING, -2 * SPACING)  # of the panels' two rows

# A cube's faces, four corners each: +x, -x, +y, -y, +z, -z.
_POINTS = (
    *((-1, -1, -1), (-1, -1, 1), (1, -1, 1), (1, -1, -1)),
    *((-1, 1, -1), (-1, 1, 1), (1, 1, 1), (1, 1, -1)),
)
_FACES = (3, 7, 6, 2, 1, 5, 4, 0, 4, 5, 6, 7, 1, 0, 3, 2, 2, 6, 5, 1, 0, 4, 7, 3)
CUBE = np.array([_POINTS[k] for k in _FACES], np.float64)
BORDERING = replace(
    scenes.NEAREST,
    wrap_s=WrapMode.CLAMP_TO_BORDER,
    wrap_t=WrapMode.CLAMP_TO_BORDER,
    wrap_r=WrapMode.CLAMP_TO_BORDER,
)
MINIFIED = replace(BORDERING, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR, max_level=0)

MODES = {
    "2D": (
        (0, WrapMode.REPEAT, None),
        (1, WrapMode.MIRRORED_REPEAT, None),
        (2, WrapMode.CLAMP_TO_EDGE, None),
        (3, WrapMode.CLAMP_TO_BORDER, 0xF0FF00FF),
        (5, WrapMode.CLAMP, 0xF0FF00FF),
    ),
    "xemu#1034": (
        (0, WrapMode.REPEAT, None),
        (1, WrapMode.MIRRORED_REPEAT, None),
        (2, WrapMode.CLAMP_TO_EDGE, None),
        (3, WrapMode.CLAMP_TO_BORDER, 0xF0559FFF),
        (4, WrapMode.CLAMP_TO_BORDER, 0xF0FF5533),
        (5, WrapMode.CLAMP, 0xF0FF5533),
    ),
}


BORDER = 4  # texels around
SIZES = ((1, 1), (2, 2), (4, 4), (8, 8), (16, 16), (32, 32), (16, 1), (8, 2), (4, 8))
AT_THE_THRESHOLD = "blocks whose lambda is within 14/256 of 0, or that lie over an edge of the cube"
WORDS = (0xFF0000FF, 0x660000FF, 0xFF00FF00, 0x6600FF00, 0xFFFF4444, 0x66FF4444, 0xFFFFFFFF, 0x66FFFFFF)
MASKS = (0xFFFF0000, 0xFF00FF00, 0xFF0000FF, 0xFFFF00FF, 0xFFFFFF00, 0xFF00FFFF)
LAYERS = 4
DEPTHS = (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 2.75)  # of LAYERS
EDGE, GAP, COLUMNS = 64, 32, 6  # of the quads, pixels


def _squares(first, second, width, height, cell):
    """Words of a checkerboard."""
    odd = (np.arange(height)[:, None] // cell + np.arange(width) // cell) % 2 == 1
    return np.where(odd, second, first)


def _bordered(inside):
    """Words of a texture and its border."""
    height, width = inside.shape
    out = _squares(0xFFCCCCCC, 0xFF444444, width + 2 * BORDER, height + 2 * BORDER, 2)
    out[BORDER : BORDER + height, BORDER : BORDER + width] = inside
    return out


def _texture(words, target=TextureTarget.TEXTURE_2D):
    """A texture of words A8R8G8B8 that has a border."""
    return replace(texture_of_words(words, TexelWord.A8R8G8B8, target), border=BORDER)


def _colors(width, height):
    """Words of squares whose colours change along the diagonals."""
    at = np.arange(height)[:, None] // CELL + np.arange(width) // CELL
    return np.array(WORDS)[at % len(WORDS)]


def _bright(mask, width, height):
    """Words of a checkerboard of single texels in a mask's components."""
    return _squares(0xFFFFFFFF & mask, 0xFF777777 & mask, width, height, 1)


def _places(count, top):
    """Left and top edges of quads in rows."""
    return [(GAP + k % COLUMNS * (EDGE + GAP), top + k // COLUMNS * (EDGE + GAP)) for k in range(count)]


def _rows(count):
    """(top edge, whether coordinates reach over the border) of both groups of quads."""
    rows = -(-count // COLUMNS)
    return (240 - ((EDGE + GAP) * rows - GAP), False), (240 + GAP, True)


def _square(size, around):
    """Coordinates of a quad, from edge to edge, or from border to border."""
    beside = np.array([BORDER / edge if around else 0.0 for edge in size], np.float32)
    return scenes.UNIT_SQUARE * (1 + 2 * beside) - beside


def _quad(label, place, texture, coordinates, sampler):
    left, top = place
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit(texture, sampler),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    corners = scenes.rectangle(left, top, left + EDGE, top + EDGE, 1.0)
    return Draw(
        label=label, mesh=scenes.window_mesh(corners, texture_coordinates=(coordinates,)), state=state
    )


def _bordered_2d():
    """Textures of every size, without their borders and with them."""
    commands = [scenes.clear(0xFE181818)]
    for top, around in _rows(len(SIZES)):
        for size, place in zip(SIZES, _places(len(SIZES), top), strict=True):
            label = "{}x{}".format(*size)
            image = _texture(_bordered(_colors(*size)))
            commands += [
                TexImage(label=label, texture=label, image=image),
                _quad(label, place, label, _square(size, around), MINIFIED),
            ]
    return Case(commands=tuple(commands))


def _bordered_3d(size):
    """A volume at several depths, without its border and with it."""
    plain = _squares(0xFFCCCCCC, 0xFF444444, *(edge + 2 * BORDER for edge in size), 2)
    layers = [plain] * (LAYERS + 2 * BORDER)
    for k in range(LAYERS):
        layers[BORDER + k] = _bordered(_bright(MASKS[k], *size))
    image = _texture(np.stack(layers), TextureTarget.TEXTURE_3D)
    commands = [scenes.clear(0xFE181818), TexImage(label="volume", texture="volume", image=image)]
    for top, around in _rows(len(DEPTHS)):
        for depth, place in zip(DEPTHS, _places(len(DEPTHS), top), strict=True):
            str_ = np.column_stack([_square(size, around), np.full(4, np.float32(depth / LAYERS))])
            commands.append(_quad(f"{depth}", place, "volume", str_, BORDERING))
    return Case(commands=tuple(commands))


def _bordered_cube(size):
    """Four cubes: directions of their corners, and of corners moved to the border's edge."""
    faces = np.stack([_bordered(_bright(mask, size, size)) for mask in MASKS])
    image = _texture(faces, TextureTarget.TEXTURE_CUBE_MAP)
    commands = [scenes.clear(0xFE121212), TexImage(label="cube", texture="cube", image=image)]
    state = replace(
        scenes.DEFAULT,
        polygon=scenes.FRONT_FACES,
        texture_units=(TextureUnit("cube", MINIFIED),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    least = -BORDER / np.float32(size)
    for y, around in ((1.5, False), (-1.5, True)):
        for x, angle in texture_cubemap.CUBES:
            model = texture_cubemap.model_matrix(x, angle)
            model[3, 1] = y
            points = host_matrices.times(np.column_stack([CUBE, np.ones(len(CUBE))]), model)
            directions = CUBE.copy()
            if around:
                directions[:, :2] = np.where(directions[:, :2] <= 0, least, 1 - least)
            positions = vertex_programs.perspective(points[:, :3], depth_maximum=65535.0)
            mesh = scenes.window_mesh(positions, texture_coordinates=(directions,))
            commands.append(Draw(label="cube", mesh=mesh, state=state))
    return Case(commands=tuple(commands), explanation=AT_THE_THRESHOLD)


def colored_checkerboard():
    """Words A8R8G8B8: squares whose colours change along the diagonals."""
    at = np.arange(SIZE) // CELL
    return np.array(COLORS)[(at[:, None] + at) % len(COLORS)]


def _tiles(panel, bordered=False):
    """Nine tiles of two triangles; (s, t) from (-1, -1) to (2, 2), or to the edges of a border."""
    left, top = LEFT + panel % 3 * (PANEL[0] + SPACING), TOPS[panel // 3]
    width, height = PANEL[0] / 3, PANEL[1] / 3
    positions, coordinates = [], []
    for row in range(3):
        for column in range(3):
            for s, t in scenes.TWO_TRIANGLES:
                positions.append((left + (column + s) * width, top - (row + t) * height, DEPTH))
                coordinates.append((column - 1 + s, row - 1 + t))
    if bordered:
        beside = BORDER / SIZE
        coordinates = np.clip(coordinates, -beside, 1 + beside)
    return scenes.textured_triangles(positions, coordinates)


def _wrapped(panels, bordered):
    image = texture_of_words(colored_checkerboard(), TexelWord.A8R8G8B8)
    commands = [scenes.clear(0xFE202020), TexImage(label="texture", texture="texture", image=image)]
    for panel, mode, border in panels:
        sampler = replace(
            scenes.NEAREST,
            min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR,
            max_level=0,
            wrap_s=mode,
            wrap_t=mode,
            border_color=scenes.argb(border or 0),
        )
        state = replace(
            scenes.DEFAULT,
            vertex=scenes.xdk_vertex(),
            texture_units=(TextureUnit("texture", sampler),),
            register_combiners=scenes.SHOWS_TEXTURE0,
        )
        commands.append(Draw(label=mode.name, mesh=_tiles(panel), state=state))
    if bordered:
        # The fifth panel's texture has a border, which its coordinates reach over instead of repeating.
        image = _texture(_bordered(_colors(SIZE, SIZE)))
        commands += [
            TexImage(label="bordered", texture="bordered", image=image),
            Draw(
                label="bordered",
                mesh=_tiles(4, bordered=True),
                state=replace(state, texture_units=(TextureUnit("bordered", MINIFIED),)),
            ),
        ]
        return Case(commands=tuple(commands), explanation="a row of ties between texels of the border")
    return Case(commands=tuple(commands))


CASES = {
    **{name: partial(_wrapped, panels, name == "2D") for name, panels in MODES.items()},
    "2D_BorderTex_SZ": _bordered_2d,
    **{f"3D_BorderTex_SZ_{w}x{h}": partial(_bordered_3d, (w, h)) for w, h in SIZES},
    **{f"Cube_BorderTex_SZ_{w}x{h}": partial(_bordered_cube, w) for w, h in SIZES if w == h},
}
