"""The check of diagrams: their marks are where the geometry has them."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.geometry.views import panel_of


def drawn_check(figure, renderer, places):
    """The Checks that a diagram's marks are at the places of the geometry, on the ideal and on the machine.

    ``places``: (panel's number, its view at half the figure's size, point, colour) for each mark. The
    measured number is the largest distance of a pixel there from its colour.
    """
    size = figure.size // 2
    for on in Answer:
        image, apart = renderer.window(on, figure, size), 0.0
        for number, view, point, color in places:
            x, y = (int(c) for c in np.floor(drawing.project(view, point)[:2]))
            apart = max(apart, float(np.abs(panel_of(image, number)[y, x] - np.array(color)).max()))
        yield Check(
            f"colours of {len(places)} marks at the computed places, largest difference",
            apart,
            at_most=0.5 / 255.0 + 1e-9 if on is Answer.IDEAL else 1.0 / 255.0,
            on=on,
            reason="a mark covers the pixel's middle",
        )
