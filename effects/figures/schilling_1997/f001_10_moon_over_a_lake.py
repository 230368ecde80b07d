"""F001-10: the moon over a lake, its waves filtered without roughness and with it."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure
from fixedpipe.effects.figures.schilling_1997.shared import lake as the
from fixedpipe.effects.figures.schilling_1997.shared.antialiased_panels import PASSES, SOFTWARE

DATA = figure_data(__file__, "F001-10")

ROW = the.SUBJECT.row(
    {
        "waves averaged alone": Antialiasing.MIP,
        "with roughness": Antialiasing.ANISOTROPIC,
        "256 samples a pixel": None,
    }
)
# Of each method: the largest RMS, and how far the far water's mean may be from the truth's.
_BOUNDS = {
    SOFTWARE: (0.03, 0.05, "the catalogue's bound"),
    PASSES: (0.03, 0.10, "the catalogue's RMS; five cube maps, and no curvature of the pixel's own"),
}


def checks(figure, renderer):
    """The catalogue's checks: RMS, the far water's mean, the column's shape; and the same without
    roughness.
    """
    size, lake = figure.size, the.Lake(**figure.values)
    view = the.SUBJECT.at_origin(size)
    truth, water, far = the.truth(lake, view), the.rows_of_water(view), the.far(view)
    largest, mean, reason = _BOUNDS[renderer.method.name]
    row, column = the.mirrored_moon(view, lake.moon)
    place = np.s_[row - 2 : row + 3, column - 2 : column + 3]
    for on in Answer:
        image = renderer.window(on, figure, size)
        averaged, rough = (the.SUBJECT.panel(image, k) for k in (0, 1))
        error = root_mean_square((rough - truth)[water])
        yield Check(
            "with roughness: RMS from 256 samples over the lake", error, at_most=largest, on=on, reason=reason
        )
        off = abs(float(rough[far].mean() / truth[far].mean()) - 1.0)
        name = "with roughness: mean of the far water over the truth's, less one"
        yield Check(name, off, at_most=mean, on=on, reason=reason)
        length, width = the.column(rough, view)
        yield DATA.check("with roughness: the column's length over its width", length / width, on)
        yield DATA.check(
            "without roughness: RMS over that with it",
            # A picture without any error is far better, too.
            root_mean_square((averaged - truth)[water]) / max(error, 1.0e-9),
            on,
        )
        yield DATA.check(
            "without roughness: light where a calm shows the moon", float(averaged[place].mean()), on
        )
        yield DATA.check("with roughness: light there", float(rough[place].mean()), on)


FIGURE = Figure(**DATA.words, **ROW, size=the.HEIGHT, acceptance=checks)
