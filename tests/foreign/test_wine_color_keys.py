"""Color keys of textures. Source: WineHQ, wine, dlls/ddraw/tests/ddraw7.c, test_ck_rgba and test_ck_default.

An ATI r200 compares no alpha, which Wine's test calls broken; here alpha takes part, as on other boards.
"""

import numpy as np
import pytest

from fixedpipe.pipeline import Blending, DepthTest, TexImage, TextureEnvironment, TextureUnit, texture_2d
from fixedpipe.pipeline.enums import BlendFactor, ComparisonFunction, InternalFormat, TextureEnvironmentMode
from fixedpipe.pipeline.state import ColorKey, VertexState
from tests.foreign.comparison import Case, assert_drawn, assert_held, on_machines, pixels
from tests.foreign.direct3d import POINT, argb, clear, draw, strip, texels, transformed

SIZE = (64, 48)
MACHINES = ("GEFORCE_256", "G400", "GEFORCE_3", "NV2A", "IDEAL")
REPLACE = TextureEnvironment(TextureEnvironmentMode.REPLACE)
BLEND = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)
DEPTH = DepthTest(ComparisonFunction.LEQUAL)
CORNERS = [[0, 0], [0, 1], [1, 0], [1, 1]]


def filled(color, z, key, name, internal_format=InternalFormat.RGBA8, **state):
    """A texture of one colour over the whole window, at a depth."""
    image = texture_2d(texels(np.full((4, 4), color)), internal_format)
    load = TexImage(label=name, texture=name, image=image)
    width, height = SIZE
    corners = [(x, y, z, 1.0) for x, y in ((0, height), (0, 0), (width, height), (width, 0))]
    mesh = strip(transformed(corners, SIZE), 0xFFFFFFFF, texture_coordinates=(CORNERS,))
    given = None if key is None else ColorKey(argb(key))
    unit = TextureUnit(name, POINT, environment=REPLACE, color_key=given)
    return load, draw(mesh, SIZE, vertex=VertexState(), texture_units=(unit,), **state)


# test_ck_rgba: the first texture's colour, whether it has a key, and whether it is blended; the middle after
# it, and after a second texture behind what the first has written. A key ends fragments: it leaves no depth.
KEY, BLUE = 0xFF00FF00, 0xFF0000FF
RGBA = (
    (0xFF00FF00, True, True, 0xFF0000, 0x0000FF),
    (0xFF00FF00, True, False, 0xFF0000, 0x0000FF),
    (0xFF00FF00, False, True, 0x00FF00, 0x00FF00),
    (0xFF00FF00, False, False, 0x00FF00, 0x00FF00),
    (0x7F00FF00, True, True, 0x807F00, 0x807F00),
    (0x7F00FF00, True, False, 0x00FF00, 0x00FF00),
    (0x7F00FF00, False, True, 0x807F00, 0x807F00),
    (0x7F00FF00, False, False, 0x00FF00, 0x00FF00),
)


def rgba(number, both):
    color, keyed, blended, first, second = RGBA[number]
    given = {"depth_test": DEPTH, "blending": BLEND if blended else None}
    key = KEY if keyed else None
    frame = (clear(0xFFFF0000, 1.0), *filled(color, 0.25, key, "first", **given))
    if both:
        frame += filled(BLUE, 0.75, key, "second", **given)
    expected = pixels([(SIZE[0] // 2, SIZE[1] // 2, second if both else first, 1)])
    return Case(f"rgba {number}, {'both' if both else 'first'}", frame, expected, SIZE, MACHINES)


def default(keyed):
    """test_ck_default: a texture X8R8G8B8, whose key has no alpha."""
    drawn = filled(0x0000FF, 0.0, 0x0000FF if keyed else None, "surface", InternalFormat.RGB8)
    expected = pixels([(SIZE[0] // 2, SIZE[1] // 2, 0x00FF00 if keyed else 0x0000FF, 1)])
    return Case(f"default, {keyed}", (clear(0xFF00FF00), *drawn), expected, SIZE, MACHINES)


CASES = (
    *[rgba(number, both) for number in range(len(RGBA)) for both in (False, True)],
    *map(default, (False, True)),
)


@pytest.mark.parametrize(("case", "machine"), on_machines(CASES))
def test_color_keys_are_what_wine_expects(case, machine):
    assert_drawn(case, machine)


def test_every_case_is_drawn_everywhere():
    assert_held(CASES, refused=0)
