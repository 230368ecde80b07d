"""Texture_palette: one texture of indices, drawn with palettes that change between the draws.

Source: src/tests/texture_palette_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import TexelWord, TextureTarget
from fixedpipe.pipeline.state import TextureUnit
from fixedpipe.pipeline.textures.words import paletted_texture, texture_of_words

SUITE = "Texture_palette"

SIZE, COLORS, QUAD = 128, 256, 96
SPACING = (WIDTH - 4 * QUAD) // 5
MASKS = (0xFFFFFFFF, 0xFF00FFFF, 0xFFFF00FF, 0xFFFFFF00)
BAR_WIDTH, BAR_HEIGHT, BAR_SPACING = 256, 32, 4
ROW_SPACING = 8
FIXED = COLORS // 4  # the first entries, which never change


def indices(scale=1):
    """Rings about the middle: falling with the square of the distance, times ``scale``."""
    at = np.arange(SIZE, dtype=np.float32) - np.float32(SIZE / 2)
    distance = at * at + (at * at)[:, None]
    share = np.float32(1) - distance / np.float32(2 * (SIZE / 2) ** 2)
    return (np.float32(COLORS - 1) * share).astype(np.int64) * scale & 0xFF


def palette(mask=0xFFFFFFFF):
    """Words A8R8G8B8: red rises, green falls, blue rises four times."""
    i = np.arange(COLORS)
    return ((0xFF << 24) | (i << 16) | ((255 - i) << 8) | (i * 4 & 0xFF)) & mask


def _rolled(words):
    return np.append(words[:FIXED], np.roll(words[FIXED:], -31))


def _shifted(words):
    rgb = words[FIXED:] & 0xFFFFFF
    return np.append(words[:FIXED], 0xFF000000 | ((rgb << 8 | rgb >> 16) & 0xFFFFFF))


def _draws(rows, texels):
    """A quad for every palette of every row; ``rows``: (top, palettes)."""
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit("rings", scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    st = (np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),)
    for top, palettes in rows:
        for column, words in enumerate(palettes):
            left = SPACING + column * (QUAD + SPACING)
            corners = scenes.unprojected_rectangle(left, top, left + QUAD, top + QUAD)
            yield TexImage(label="palette", texture="rings", image=paletted_texture(texels, words))
            yield Draw(label="rings", mesh=scenes.window_mesh(corners, texture_coordinates=st), state=state)


def _bars(palettes):
    """The palettes themselves, as rows of a texture, one below the other."""
    words = np.concatenate(palettes)[None].repeat(4, 0)
    image = texture_of_words(words, TexelWord.A8R8G8B8, TextureTarget.TEXTURE_RECTANGLE)
    yield TexImage(label="palettes", texture="palettes", image=image)
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit("palettes", scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    left = (WIDTH - BAR_WIDTH) / 2
    for row in range(4):
        top = HEIGHT - (4 - row) * (BAR_HEIGHT + BAR_SPACING) + BAR_SPACING
        u = row * COLORS
        st = np.array([(u, 0.0), (u + COLORS, 0.0), (u + COLORS, 1.0), (u, 1.0)])
        corners = scenes.unprojected_rectangle(left, top, left + BAR_WIDTH, top + BAR_HEIGHT)
        mesh = scenes.window_mesh(corners, texture_coordinates=(st,))
        yield Draw(label="a palette", mesh=mesh, state=state)


def _swapped():
    first = [palette(mask) for mask in MASKS]
    second = first[::-1]
    top = 80
    draws = _draws(((top, first), (top + QUAD + ROW_SPACING, second)), indices())
    return Case(commands=(scenes.clear(0xFF333333), *draws, *_bars([second[-1], *first[1:]])))


def _high_palettes():
    palettes = [palette()]
    for change in (_rolled, _shifted, _shifted):
        palettes.append(change(palettes[-1]))
    draws = _draws(((HEIGHT // 2 - QUAD // 2, palettes),), indices(5))
    return Case(commands=(scenes.clear(0xFF333333), *draws))


CASES = {"PaletteSwapping": _swapped, "XemuHighPaletteBug": _high_palettes}
