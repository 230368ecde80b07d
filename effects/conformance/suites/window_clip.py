"""Window_clip: a quad through two window clip rectangles, inclusive or exclusive, on the window and off it.

Source: src/tests/window_clip_tests.cpp of nxdk_pgraph_tests. Rectangles include their right column and lowest
row. Setting the first rectangle sets all eight; so a rectangle set before it ("s" names) is lost.
"""

from dataclasses import replace
from functools import partial
from itertools import product

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case
from fixedpipe.pipeline.commands import BindTexImage, MakeCurrent
from fixedpipe.pipeline.enums import WindowOrigin
from fixedpipe.pipeline.state import Scissor, WindowClip

SUITE = "Window_clip"

SIZE = 256  # pixels: the quad's, and the texture's that it is drawn to
# x, y, width and height of the two rectangles, in device pixels.
FIRST = (
    *((0, 0, 0, 0), (0, 0, SIZE, SIZE), (8, 16, 0xF00, 0xF00), (0, 0, SIZE - 1, SIZE - 1)),
    *((1, 1, SIZE - 2, SIZE - 2), (1, 1, SIZE - 3, SIZE - 3), (0, 0, SIZE // 2, SIZE // 2), (0, 0, 1, 1)),
    *((SIZE - 1, SIZE - 1, 1, 1), (SIZE, SIZE, 1, 1), (96, 96, 64, 64)),
)
SECOND = ((0, 0, 0, 0), (16, 16, 8, 8))
SWAPPED = ((60, 60, 64, 64), (0, 0, 64, 64))
TEXTURE = "texture"


def _name(off_screen, swapped, exclusive, first, second):
    text = ["x{}y{}_w{}h{}".format(*rectangle) for rectangle in (first, second)]
    return f"{'r' * off_screen}{'s' * swapped}{'IE'[exclusive]}_{text[0]}-{text[1]}"


def _clip(height, exclusive, rectangles):
    """Device rectangles, both edges inclusive, in window coordinates."""
    boxes = tuple(Scissor(x, height - 1 - y - h, w + 1, h + 1) for x, y, w, h in rectangles)
    return WindowClip(boxes, exclusive)


def _case(off_screen, swapped, exclusive, first, second):
    height = SIZE if off_screen else HEIGHT
    state = replace(scenes.DEFAULT, polygon=scenes.FRONT_FACES)
    clip = _clip(height, exclusive, (first,) if swapped else (first, second))
    box = scenes.rectangle(0, 0, SIZE, SIZE)
    quads = (
        scenes.quad("unclipped", box, scenes.abgr(0xFF887733), state, height),
        scenes.quad("clipped", box, scenes.abgr(0xFF3377FF), replace(state, window_clip=clip), height),
    )
    if not off_screen:
        return Case(commands=(scenes.clear(0xFE111213), *quads))
    left, top = (WIDTH - SIZE) / 2, (HEIGHT - SIZE) / 2
    corners = scenes.rectangle(left, top, left + SIZE, top + SIZE)
    return Case(
        commands=(
            MakeCurrent(label="off the screen", surface=TEXTURE, width=SIZE, height=SIZE),
            *quads,
            MakeCurrent(label="window"),
            scenes.clear(0xFE332233),
            BindTexImage(
                label="as a texture", texture=TEXTURE, surface=TEXTURE, origin=WindowOrigin.UPPER_LEFT
            ),
            scenes.textured_quad("shown", corners, TEXTURE, state),
        )
    )


CASES = {
    _name(*given): partial(_case, *given)
    for off_screen, exclusive in product((False, True), repeat=2)
    for given in (
        *((off_screen, False, exclusive, first, second) for first, second in product(FIRST, SECOND)),
        (off_screen, True, exclusive, *SWAPPED),
    )
}
