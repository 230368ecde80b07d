"""F001-12: zebras mirrored by a flat, bumped plate, filtered by roughness."""

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure
from fixedpipe.effects.figures.schilling_1997.shared import zebras as the

DATA = figure_data(__file__, "F001-12")

ROW = the.SUBJECT.row({"with roughness": Antialiasing.ANISOTROPIC, "256 samples a pixel": None})


def checks(figure, renderer):
    """The catalogue's: RMS from 256 samples a pixel. And how much of the stripes is left."""
    size, plate = figure.size, the.Plate(**figure.values)
    view = the.SUBJECT.at_origin(size)
    truth, full = the.truth(plate, view), the.coverage(view) == 1.0
    for on in Answer:
        image = renderer.window(on, figure, size)
        error = root_mean_square((the.SUBJECT.panel(image, 0) - truth)[full])
        yield DATA.check("with roughness: RMS from 256 samples over the plate", error, on)
        left, right = (the.stripes(the.SUBJECT.panel(image, k), view) for k in (0, 1))
        yield DATA.check("256 samples: deviation from stripe to stripe", right, on)
        yield DATA.check("stripes with roughness over those of 256 samples", left / right, on)
    yield from _at_full_strength(figure)


def _at_full_strength(figure):
    """The same bounds for the bumps of F001-14 as they are, in floats."""
    plate, view = the.Plate(**{**figure.values, "strength": 1.0}), the.SUBJECT.at_origin(figure.size // 2)
    truth, full = the.truth(plate, view), the.coverage(view) == 1.0
    plain, rough = (
        root_mean_square((the.answer(plate, view, way) - truth)[full])
        for way in (Antialiasing.NONE, Antialiasing.ANISOTROPIC)
    )
    yield DATA.check("bumps not flattened: RMS from 256 samples", rough, Answer.IDEAL)
    yield DATA.check("bumps not flattened: RMS without antialiasing over it", plain / rough, Answer.IDEAL)


FIGURE = Figure(**DATA.words, **ROW, size=the.SIZE, acceptance=checks)
