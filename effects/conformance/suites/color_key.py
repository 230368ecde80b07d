"""Color_key: texels that equal a stage's key lose their alpha, all their components, or their fragment.

Source: src/tests/color_key_tests.cpp of nxdk_pgraph_tests. Measured: the key is compared with a texel's whole
word, in X formats without their unused bits. A stage that samples kills, even if its texel is not used.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.passes.combiners import ONE, TEXTURE0, program, shown
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ColorKeyOperation, PrimitiveType, TexelWord, TextureTarget
from fixedpipe.pipeline.state import ColorKey, TextureUnit
from fixedpipe.pipeline.textures.words import texture_of_words

SUITE = "Color_key"

STAGES, SIZE, HALF, DEPTH = ("FixedTex", "ProgTex"), 64, 0.75, 0.1
OPERATIONS = {
    "Alpha": ColorKeyOperation.ALPHA,
    "Color": ColorKeyOperation.RGBA,
    "AlphaColor": ColorKeyOperation.KILL,
}
MODES = ("Disabled", *OPERATIONS)
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
X_KEY = 0xCC00FF00
BACKGROUND = 0xFF00CC00


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


def _unit(texture, key, mode):
    """A texture unit, and its key, a word A8R8G8B8, where the mode has one."""
    unit = TextureUnit(texture, scenes.NEAREST)
    if mode == "Disabled":
        return unit
    return replace(unit, color_key=ColorKey(scenes.argb(key), OPERATIONS[mode]))


def _store(label, words, word=TexelWord.A8R8G8B8):
    image = texture_of_words(words, word, TextureTarget.TEXTURE_RECTANGLE)
    return TexImage(label=label, texture=label, image=image)


def _quad(units, ignores_alpha, place, programmed):
    """A Draw that shows texture 0, its alpha or one."""
    final = shown(TEXTURE0, alpha=ONE if ignores_alpha else TEXTURE0)
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.PROGRAM_RESULTS if programmed else scenes.xdk_vertex(depth_maximum=65535.0),
        texture_units=units,
        register_combiners=program(final),
    )
    return Draw(label=units[0].texture, mesh=_mesh(*place, programmed), state=state)


def _stores():
    return [scenes.clear(BACKGROUND), *(_store(f"texture {k}", texels(k)) for k in range(4))]


def _keyed(ignores, programmed, mode):
    commands = _stores()
    for k, (x, y) in enumerate(PLACES):
        for keys, right in ((COLOR_KEYS, 0.0), (ALPHA_KEYS, SECOND)):
            unit = _unit(f"texture {k}", keys[k], mode)
            commands.append(_quad((unit,), ignores, (x + right, y), programmed))
    return Case(commands=tuple(commands))


def _unsampled():
    one = _unit("texture 0", COLOR_KEYS[0], "AlphaColor")
    two = _unit("texture 1", COLOR_KEYS[1] | 0xFF000000, "AlphaColor")
    quads = _quad((one,), False, (-1.6, 0.0), True), _quad((one, two), False, (1.6, 0.0), True)
    return Case(commands=(*_stores(), *quads))


def _x_alpha():
    at = np.arange(SIZE) // (SIZE // 4)
    words = np.where((at[:, None] + at) % 2 == 1, X_KEY & 0xFFFFFF, X_KEY)
    unit = _unit("texture", X_KEY, "AlphaColor")
    store = _store("texture", words, TexelWord.X8R8G8B8)
    return Case(commands=(scenes.clear(0xFF999999), store, _quad((unit,), False, (0.0, 0.0), True)))


CASES = {
    **{
        f"{ignored}{stage}_{mode}": partial(_keyed, bool(ignored), stage == "ProgTex", mode)
        for ignored, stage, mode in product(("", "IgnAlphaCh_"), STAGES, MODES)
    },
    "UnsampledTex": _unsampled,
    "XAlphaFormat": _x_alpha,
}
