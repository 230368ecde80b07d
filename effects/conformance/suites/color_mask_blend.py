"""Color_mask_blend: quads blended by the destination's alpha, which the color mask protects.

Source: src/tests/color_mask_blend_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import BlendFactor
from fixedpipe.pipeline.state import Blending, ColorMask

SUITE = "Color_mask_blend"

BACKDROPS = (  # colour 0xAABBGGRR and box
    (0xCCFFFFFF, (20, 120, 320, 360)),
    (0xFF000000, (180, 130, 310, 350)),
    (0x227799FF, (330, 130, 470, 350)),
)
CORNERS = (  # upper left, upper right, lower right, lower left; alpha shrinks from quad to quad
    (1.0, 0.0, 0.0, 0.5),
    (0.5, 0.5, 0.5, 1.0),
    (0.0, 0.0, 1.0, 0.9),
    (0.0, 1.0, 0.0, 0.75),
)


def _case():
    commands = [scenes.clear(0x30222222)]
    for word, (left, top, right, bottom) in BACKDROPS:
        corners = scenes.rectangle(left, top, right, bottom, 20.0)
        commands.append(scenes.quad("backdrop", corners, scenes.abgr(word)))
    positions, colors = [], []
    for k in range(4):
        left = 71 + 142 * k
        positions += scenes.rectangle(left, 180, left + 71, 300, 10.0 - 0.5 * k)
        colors += [(r, g, b, a * 0.75**k) for r, g, b, a in CORNERS]
    state = replace(
        scenes.DEFAULT,
        blending=Blending(BlendFactor.DST_ALPHA, BlendFactor.ZERO),
        color_mask=ColorMask(alpha=False),
    )
    mesh = scenes.window_mesh(positions, colors=scenes.single(colors))
    return Case(commands=(*commands, Draw(label="quads", mesh=mesh, state=state)))


CASES = {"C00010101_O32774_S772_D0": _case}  # RGB written, FUNC_ADD, DST_ALPHA, ZERO
