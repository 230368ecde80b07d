"""F001-13: the zebras of F001-12 without antialiasing, and with bumps that are averaged alone."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure
from fixedpipe.effects.figures.schilling_1997.shared import zebras as the

DATA = figure_data(__file__, "F001-13")

ROW = the.SUBJECT.row(
    {"without antialiasing": Antialiasing.NONE, "bumps averaged alone": Antialiasing.MIP},
    passes="texture shaders, one pass",
)


def _changes(image, full):
    """Mean change from row to row where both rows are plate."""
    return float(np.abs(image[1:] - image[:-1])[full[1:] & full[:-1]].mean())


def checks(figure, renderer):
    """The catalogue's: how many times F001-12's RMS."""
    size, plate = figure.size, the.Plate(**figure.values)
    view = the.SUBJECT.at_origin(size)
    truth, full = the.truth(plate, view), the.coverage(view) == 1.0
    filtered = the.answer(plate, view, Antialiasing.ANISOTROPIC)
    least = root_mean_square((filtered - truth)[full])
    for on in Answer:
        image = renderer.window(on, figure, size)
        error = root_mean_square((the.SUBJECT.panel(image, 0) - truth)[full])
        yield DATA.check(
            "without antialiasing: RMS from 256 samples over that with roughness", error / least, on
        )
        noise, sharp = (the.SUBJECT.panel(image, k) for k in (0, 1))
        yield DATA.check(
            "without antialiasing: changes up and down over those of 256 samples",
            _changes(noise, full) / _changes(truth, full),
            on,
        )
        yield DATA.check(
            "bumps averaged alone: stripes over those of 256 samples",
            the.stripes(sharp, view) / the.stripes(truth, view),
            on,
        )


FIGURE = Figure(**DATA.words, **ROW, size=the.SIZE, acceptance=checks)
