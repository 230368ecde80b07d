"""Color_key: texels that equal a stage's key lose their alpha, all their components, or their fragment.

Source: src/tests/color_key_tests.cpp of nxdk_pgraph_tests. Measured: the key is compared with a texel's
whole word, in X formats without their unused bits; a stage that samples kills, whether or not its texel is
used.

OpenGL has no keys: here a texture is defined with what the key leaves of its texels, and an alpha test ends
a killed texel's fragment, whose alpha is the only one that is 0.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.passes.combiners import (
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    alpha_of,
    program,
    shown,
    stage,
    total,
)
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction, PrimitiveType, TexelWord, TextureTarget
from fixedpipe.pipeline.state import AlphaTest, TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Color_key"

STAGES, SIZE, HALF, DEPTH = ("FixedTex", "ProgTex"), 64, 0.75, 0.1
MODES = ("Disabled", "Alpha", "Color", "AlphaColor")
COLOR_KEYS = (0xF00000FF, 0xF1FF00FF, 0xF2800080, 0xF3FF0000)
ALPHA_KEYS = (0xF4707071, 0xF5707072, 0xF6707073, 0xF7707074)
LIGHT, DARK = 0xFDCCCCCC, 0xFE999999
PLACES = (
    (-2.6, 1.25),
    (1.0, 1.25),
    (-2.6, -1.25),
    (1.0, -1.25),
)  # of each stage's first quad; its second lies
SECOND = 1.6  # to the right of it
UNSAMPLED, X_ALPHA = "UnsampledTex", "XAlphaFormat"
BACKGROUND = 0xFF00CC00


def names():
    """Every case of the suite."""
    keyed = [f"{ignored}{s}_{mode}" for ignored in ("", "IgnAlphaCh_") for s in STAGES for mode in MODES]
    return [*keyed, UNSAMPLED, X_ALPHA]


def _squares(first, second, cell):
    """Words of a quarter of a texture."""
    at = np.arange(SIZE // 2) // cell
    return np.where((at[:, None] + at) % 2 == 1, second, first)


def texels(k):
    """Words A8R8G8B8 of stage k's texture: key and alpha key between greys above, near misses below."""
    color, alpha = COLOR_KEYS[k], ALPHA_KEYS[k]
    other = COLOR_KEYS[1 if k == 0 else 0] & 0xFFFFFF
    plain = color & 0xFFFFFF
    above = _squares(LIGHT, color, 8), _squares(DARK, alpha, 4)
    below = (
        _squares(plain | (alpha & 0xFF000000), plain | 0xFF000000, 8),
        _squares(other | (color & 0xFF000000), other | (alpha & 0xFF000000), 8),
    )
    return np.vstack([np.hstack(above), np.hstack(below)])


def _mesh(x, y, programmed):
    corners = [(x - HALF, y + HALF), (x + HALF, y + HALF), (x + HALF, y - HALF), (x - HALF, y - HALF)]
    points = np.array([(*corner, DEPTH) for corner in corners])
    coordinates = {"texture_coordinates": (scenes.UNIT_SQUARE * SIZE,)}
    if not programmed:
        return Mesh(scenes.single(points), PrimitiveType.QUADS, **coordinates)
    positions = vertex_programs.perspective(points, depth_maximum=65535.0)
    return scenes.window_mesh(positions, **coordinates)


def _quad(label, words, matches, mode, ignores_alpha, place, programmed):
    """Commands that draw a texture as its key leaves it; ``matches``: bool, the texels that equal it."""
    left, kills = words.copy(), mode == "AlphaColor"
    if mode == "Color":
        left[matches] = 0
    elif mode != "Disabled":
        left[matches] &= 0xFFFFFF
    alive = np.where(matches & kills, 0, 0xFF000000)
    images = {
        label: texture_of_words(part, TexelWord.A8R8G8B8, TextureTarget.TEXTURE_RECTANGLE)
        for label, part in ((label, left), (f"{label} alive", alive))
    }
    alpha = TEXTURE1 if ignores_alpha else TEXTURE0
    general = stage(total(TEXTURE0, to=SPARE0), alpha=total(alpha_of(alpha), to=SPARE0))
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.PROGRAM_RESULTS if programmed else scenes.xdk_vertex(depth_maximum=65535.0),
        texture_units=tuple(TextureUnit(texture, scenes.NEAREST) for texture in images),
        register_combiners=program(general, shown(SPARE0, alpha=SPARE0)),
        alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.0) if kills else None,
    )
    if not ignores_alpha:
        state = replace(state, texture_units=state.texture_units[:1])
    return [
        *(TexImage(label=texture, texture=texture, image=image) for texture, image in images.items()),
        Draw(label=label, mesh=_mesh(*place, programmed), state=state),
    ]


def case(name, inputs):
    """The case of that name, or None."""
    del inputs
    if name not in names():
        return None
    if name == X_ALPHA:
        # Every texel's colour is the key's: all fragments end.
        return Case(commands=(scenes.clear(0xFF999999),))
    commands = [scenes.clear(BACKGROUND)]
    if name == UNSAMPLED:
        words, second = texels(0), texels(1)
        first = words == COLOR_KEYS[0]
        either = first | (second == (COLOR_KEYS[1] | 0xFF000000))
        commands += _quad("one", words, first, "AlphaColor", False, (-1.6, 0.0), True)
        commands += _quad("two", words, either, "AlphaColor", False, (1.6, 0.0), True)
        return Case(commands=tuple(commands))
    ignores, programmed, mode = name.startswith("Ign"), "ProgTex" in name, name.split("_")[-1]
    for k, (x, y) in enumerate(PLACES):
        for keys, right in ((COLOR_KEYS, 0.0), (ALPHA_KEYS, SECOND)):
            words, label = texels(k), f"stage {k} {keys[k]:X}"
            place = x + right, y
            commands += _quad(label, words, words == keys[k], mode, ignores, place, programmed)
    return Case(commands=tuple(commands))
