"""A ring, a sphere and a thin board on the floor.

The board's shadow begins at its foot, and shows a gap if a shadow map's bias is too large.
"""

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective, rotation
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.scenes.objects_and_lamps import Object, Scene, detail_of, lamp_around
from fixedpipe.effects.scenes.still_life import still_life

LAMP_POSITION = (-6.2, 7.0, 3.2)
# The board: turned about y, so thin that its shadow begins at its foot on either side.
BOARD_TURN, BOARD_PLACE, BOARD_WIDTH, BOARD_HEIGHT, BOARD_THICKNESS = 62.0, (-0.2, -0.55), 1.9, 1.15, 0.03


def ring_and_board(size):
    """A ring and a thin board on the floor, and a lamp."""
    objects = {thing.name: thing for thing in still_life(detail_of(size)).objects}
    x, z = BOARD_PLACE
    board = surfaces.box(BOARD_WIDTH, BOARD_HEIGHT, BOARD_THICKNESS).rotated(rotation("y", BOARD_TURN))
    scene = Scene(
        (
            objects["floor"],
            objects["ring"],
            Object("board", board.moved(x, 0.5 * BOARD_HEIGHT, z), (0.34, 0.52, 0.34), 0.1),
            objects["sphere"],
            objects["ground"],
        )
    )
    return scene, lamp_around(scene, LAMP_POSITION)


def board_view(panel):
    """A view of the objects' feet, and of their shadows."""
    eye = (0.8, 3.9, 6.6)
    projection = perspective(44.0, panel.width / panel.height, 2.5, 40.0)
    return View(panel, look_at(eye, (0.26, 0.35, 0.0)), projection, eye, False)
