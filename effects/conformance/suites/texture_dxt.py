"""Texture_DXT: S3TC pictures, alone and with mipmaps on squares of many sizes.

Source: src/tests/texture_format_dxt_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from fixedpipe.effects.conformance import dds, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TextureFilter
from fixedpipe.pipeline.state import TextureUnit

SUITE = "Texture_DXT"

SQUARE = ((192, 112, 256),)  # left, top, edge
SQUARES = (
    *((5, 80, 256), (270, 80, 128), (410, 80, 64), (480, 80, 32), (520, 80, 16)),
    *((270, 220, 8), (280, 220, 4), (290, 220, 2), (300, 220, 1)),
)


def _case(file, inputs, mipmaps=False):
    texture = dds.read_texture(inputs.path(file), mipmaps)
    sampler = scenes.NEAREST
    if mipmaps:
        last = len(texture.levels) - 1
        sampler = replace(sampler, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR, max_level=last)
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit(file, sampler),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    st = (np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),)
    commands = [scenes.clear(0xFE101010), TexImage(label=file, texture=file, image=texture)]
    for left, top, edge in SQUARES if mipmaps else SQUARE:
        corners = scenes.rectangle(left, top, left + edge, top + edge)
        mesh = scenes.window_mesh(corners, texture_coordinates=st)
        commands.append(Draw(label=f"{edge} pixels wide", mesh=mesh, state=state))
    return Case(commands=tuple(commands))


CASES = {
    **{
        f"DXT{n}_{picture}_dxt{n}": partial(_case, f"{picture}_dxt{n}.dds")
        for picture in ("plasma_alpha", "plasma")
        for n in (1, 3, 5)
    },
    **{
        f"MIPDXT{n}_{picture}_dxt{n}": partial(_case, f"{picture}_dxt{n}.dds", mipmaps=True)
        for picture in ("plasma_alpha", "plasma", "64x256_bands")
        for n in (1, 3, 5)
    },
}
