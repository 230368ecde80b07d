"""F000-4's and H18's teapot: where it is seen from, the boards that draw it by factors, and its vertices."""

import numpy as np

from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Method
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view
from fixedpipe.effects.passes.draws import FIRST_PASS, draw
from fixedpipe.effects.reflectance.factored_passes import Board, Means, Storage
from fixedpipe.pipeline.ideal.evaluate import execute_ideal

ASPECT = (5, 4)
# Where the camera is, of a teapot that reaches one from its axis.
EYE, FIELD_OF_VIEW = (0.0, 1.5, 4.2), 21.0
MAP_SIZE = word.of(word.Whole(8, 32, power=True), 32, "The edge of the factors' maps.", "texels")


def intensity(default):
    """The light's intensity as a figure's parameter."""
    return word.NUMBER(default, "The light's, 1 = a white surface that faces it is full.", low=0.01, high=4.0)


def methods(scene_by, names, accumulating):
    """A Method for each kind of board, by its name in ``names``.

    scene_by      (Board) -> a Scene
    accumulating  which machines draw by parabolic maps, one unit and the accumulation buffer
    """
    boards = (
        (Board(Means.COMBINERS, Storage.CUBE, 2, True), ("GEFORCE_256",)),
        (Board(Means.COMBINERS, Storage.CUBE, 4, True), ("GEFORCE_3", "NV2A", "FUTURE")),
        (Board(Means.BLENDING, Storage.PARABOLIC, 2, False), ("MULTITEXTURE", "G400", "TEXRAM")),
        (Board(Means.ACCUMULATION, Storage.PARABOLIC, 1, False), accumulating),
    )
    return tuple(
        Method(name, scene_by(board), machines) for name, (board, machines) in zip(names, boards, strict=True)
    )


def detail(size):
    """Parts of a patch's edge on a panel of ``size`` pixels."""
    return 2 if size < 64 else 8


def view_of(panel):
    """The camera of a panel."""
    return perspective_view(panel, EYE, field_of_view=FIELD_OF_VIEW)


def lit_and_seen(surface, view, light):
    """Of the vertices: vectors to the light and to the viewer in their frames, float64 [n, 3], and which have
    both above their horizon.
    """
    towards = surface.to_local(light.light_vectors(surface.positions))
    views = surface.to_local(view.view_vectors(surface.positions))
    return towards, views, (towards[:, 2] > 1e-3) & (views[:, 2] > 1e-3)


def colored(surface, panel, colors, view=None):
    """Commands that draw colours of the vertices, held at one; ``view``: None, ``view_of``'s."""
    mesh = surface.mesh(colors=np.clip(colors, 0.0, 1.0))
    shown = draw("the BRDF at the vertices", mesh, view or view_of(panel), None, depth_test=FIRST_PASS)
    return (panel.clear(BACKGROUND), shown)


def pictured(commands, width, height):
    """The ideal's picture: RGB float64 [height, width, 3], top row first."""
    return execute_ideal(tuple(commands), width, height).color[..., :3]


def covered(picture):
    """Where there is no background: bool."""
    return np.abs(picture - np.array(BACKGROUND)).max(axis=-1) > 0.02
