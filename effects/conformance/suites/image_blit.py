"""Image_blit: the 2D engine's copies of a picture, plain, mixed by a constant and clipped, next to drawn
quads.

Source: src/tests/image_blit_tests.cpp of nxdk_pgraph_tests. Measured: BLEND_AND mixes as blending by a
constant alpha does. The alpha is the byte beta >> 23, or 0 if beta's sign bit is set. X8R8G8B8 writes an
alpha of 255, Z8R8G8B8 of 0. Not included: BlitBeyondWidth, whose picture is the order of a tile's bytes in
memory.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import scenes, surface_memory
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent, TexImage
from fixedpipe.pipeline.enums import BlendFactor, ColorFormat, TexelWord, TextureTarget, WindowOrigin
from fixedpipe.pipeline.state import Blending, ColorMask, Scissor, TextureUnit

SUITE = "Image_blit"

BETAS = {
    "XRGB": (
        *(0x80000000, 0x8FFFFFFF, 0x00000000, 0x007FFFFF, 0x00800000, 0x03300000, 0x00D00000, 0x44400000),
        *(0x444FFFFF, 0x66800000, 0x7F800000, 0x7FFFFFFF),
    ),
    "ZRGB": (
        *(0x007FFFFF, 0x00800000, 0x00D00000, 0x03300000),
        *(0x44400000, 0x444FFFFF, 0x66800000, 0x7F800000),
    ),
}
ALPHAS = {"XRGB": 1.0, "ZRGB": 0.0, "ARGB": None}  # that a copy leaves; None: the picture's
CLIPS = (
    *((0, 0, 640, 480), (320, 240, 64, 40), (320, 240, 640, 480), (300, 200, 16, 24), (320, 240, 0, 0)),
    *((320, 240, 1, 1), (320, 240, 0, 10)),
)
CORNERS = {"TL": (0, 0), "TR": (1, 0), "BL": (0, 1), "BR": (1, 1)}  # of the drawn quad: right, below
PLACES = ("Outside", "Inside")
SOURCE, SIZE, PLACE = (8, 8), (128, 128), (256, 176)
PICTURE = "picture"
QUAD_COLORS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.75, 0.65, 0.55))


def _blit(texture, source, size, place, beta=None, alpha=None, clip=(0, 0, WIDTH, HEIGHT), height=HEIGHT):
    """Draws that copy a rectangle of a rectangle texture, its first row on top: mixed by ``beta``, a
    register's word (None: copied), and leaving ``alpha`` (None: the texture's). ``height``: of what is drawn
    to.
    """
    (u, v), (w, h), (x, y) = source, size, place
    left, top, across, down = clip
    across, down = min(across, WIDTH - left), min(down, height - top)
    if not (across and down):
        return []
    blending = None
    if beta is not None:
        factor = (0 if beta >> 31 else beta >> 23) / 255.0
        both = BlendFactor.CONSTANT_ALPHA, BlendFactor.ONE_MINUS_CONSTANT_ALPHA
        blending = Blending(*both, color=(0.0, 0.0, 0.0, factor))
    box = Scissor(left, height - top - down, across, down)
    corners = scenes.rectangle(x, y, x + w, y + h)
    state = replace(scenes.DEFAULT, scissor=box, blending=None)
    texels = np.array([(u, v), (u + w, v), (u + w, v + h), (u, v + h)])
    copied = replace(
        state,
        blending=blending,
        color_mask=ColorMask(alpha=alpha is None),
        texture_units=(TextureUnit(texture, scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    mesh = scenes.window_mesh(corners, height=height, texture_coordinates=(texels,))
    draws = [Draw(label="blit", mesh=mesh, state=copied)]
    if alpha is not None:
        only = replace(state, color_mask=ColorMask(False, False, False, True))
        draws.append(scenes.quad("alpha", corners, (0.0, 0.0, 0.0, alpha), only, height))
    return draws


def _quad(left, top, size, clip=None, height=HEIGHT):
    """A quad of four colours, half a pixel further, as the XDK's view has it. ``clip``: of the surface."""
    corners = scenes.unprojected_rectangle(left, top, left + size, top + size)
    mesh = scenes.window_mesh(corners, height=height, colors=scenes.single(QUAD_COLORS))
    return Draw(label="quad", mesh=mesh, state=replace(scenes.DEFAULT, scissor=clip))


def _overlap(corner, outside):
    """A quad, and one pixel of the picture at its corner or beside it."""
    right, below = corner
    x = 64 + 127 + outside if right else 64 - outside
    clip = Scissor(64, HEIGHT - 64 - 128, WIDTH - 64, 128)
    pixel = _blit(PICTURE, (0, 0), (1, 1), (x, 64 + 127 * below))
    return [_quad(64, 64, 128, clip), *pixel, _quad(320, 240, 4)]


def _dirty():
    return [_quad(16, 64, 128), *_blit(PICTURE, (0, 0), (256, 256), (0, 0)), _quad(320, 240, 4)]


def _blit_render_blit():
    """Two mixed copies and a quad between them on a surface, and a copy of that."""
    size = 256
    return [
        MakeCurrent(label="target", surface="target", width=size, height=size),
        *_blit(PICTURE, (0, 0), SIZE, (0, 0), 0x444FFFFF, 1.0, (0, 0, size, size), size),
        _quad(64, 64, 128, Scissor(64, 64, 128, 128), size),
        *_blit(PICTURE, (0, 0), SIZE, (128, 128), 0x66800000, 1.0, (0, 0, size, size), size),
        BindTexImage(
            label="target",
            texture="target",
            surface="target",
            target=TextureTarget.TEXTURE_RECTANGLE,
            origin=WindowOrigin.UPPER_LEFT,
        ),
        MakeCurrent(label="window"),
        *_blit("target", (0, 0), (size, size), ((WIDTH - size) // 2, 72 + (HEIGHT - 72 - size) // 2)),
    ]


def _case(background, draws, *given, inputs):
    rgba = inputs.picture("TestImage.png")
    memory = surface_memory.memory_of(surface_memory.words_of(rgba, ColorFormat.A8R8G8B8))
    picture = surface_memory.image_of(memory, TexelWord.A8R8G8B8, *rgba.shape[1::-1])
    return Case(
        commands=(
            scenes.clear(background),
            TexImage(label=PICTURE, texture=PICTURE, image=picture),
            *draws(*given),
        )
    )


_PLAIN = partial(_blit, PICTURE, SOURCE, SIZE, PLACE)
CASES = {  # every case of the suite but one
    **{
        f"ImgBlt_BLENDAND_{words}_B{beta:08X}": partial(_case, 0xF0440011, _PLAIN, beta, ALPHAS[words])
        for words, betas in BETAS.items()
        for beta in betas
    },
    **{
        f"ImgBlt_SRCCOPY_{words}_B00000000": partial(_case, 0xF0440011, _PLAIN, None, alpha)
        for words, alpha in ALPHAS.items()
    },
    **{
        "ImgBlt_Clip_{}_{}_{}_{}".format(*clip): partial(_case, 0xF0440011, _PLAIN, None, None, clip)
        for clip in CLIPS
    },
    **{
        f"Overlap_{name}_{place}": partial(_case, 0xFF111111, _overlap, corner, place == "Outside")
        for name, corner in CORNERS.items()
        for place in PLACES
    },
    "DirtyOverlappedDestSurf": partial(_case, 0xFF111111, _dirty),
    "BlitRenderBlit": partial(_case, 0xFF112233, _blit_render_blit),
    "OverlapFIFO": partial(_case, 0xF0450015, partial(_blit, PICTURE, (0, 0), SIZE, PLACE)),
}
