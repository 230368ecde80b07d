"""Texture_CPU_Update: a texture that the processor changes between two draws.

Source: src/tests/texture_cpu_update_tests.cpp of nxdk_pgraph_tests.
"""

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

SUITE = "Texture_CPU_Update"

SIZE = 256
COLORS = {"red": (0x66, 0, 0, 0xFF), "green": (0, 0x66, 0, 0xFF)}


def _case():
    commands, whole = [scenes.clear(0xFE202020)], scenes.rectangle(0, 0, WIDTH, HEIGHT)
    for label, color in COLORS.items():
        image = texture_2d(np.full((SIZE, SIZE, 4), color, np.uint8))
        commands += [
            TexImage(label=label, texture="texture", image=image),
            scenes.textured_quad(label, whole, "texture"),
        ]
    return Case(commands=tuple(commands))


CASES = {"RGBA": _case}
