"""TextureWrapMode: squares across the texture's seam, with cylinder wrapping and without.

Source: src/tests/texture_wrap_mode_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes, texture_memory
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import WrapMode
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "TextureWrapMode"

SIZE, SQUARE = 256, 128
COLUMNS, ROWS = (96, 416), (96, 240)  # left without and with wrapping; top of the wide and the narrow squares
WIDTHS = (1.0, 0.2)  # of the squares, in s and t, about the seam at one


def _case():
    image = texture_2d(texture_memory.radial_gradient(SIZE, SIZE))
    commands = [scenes.clear(0xFF000000), TexImage(label="gradient", texture="gradient", image=image)]
    sampler = replace(scenes.NEAREST, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.MIRRORED_REPEAT)
    for top, width in zip(ROWS, WIDTHS, strict=True):
        first = scenes.single(1.0 - width / 2)
        last = scenes.single(first + scenes.single(width))
        st = np.array([(first, first), (last, first), (last, last), (first, last)])
        for left, wrapped in zip(COLUMNS, (False, True), strict=True):
            unit = TextureUnit("gradient", sampler, cylinder_wrap=(wrapped, wrapped, False, False))
            state = replace(scenes.DEFAULT, texture_units=(unit,), register_combiners=scenes.SHOWS_TEXTURE0)
            corners = scenes.unprojected_rectangle(left, top, left + SQUARE, top + SQUARE)
            mesh = scenes.window_mesh(corners, texture_coordinates=(st,))
            commands.append(Draw(label=f"{width:g} about the seam", mesh=mesh, state=state))
    return Case(commands=tuple(commands))


CASES = {"CylinderWrapping": _case}
