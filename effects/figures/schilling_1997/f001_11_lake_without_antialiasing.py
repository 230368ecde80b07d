"""F001-11: the lake without antialiasing, next to the one that roughness filters."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure
from fixedpipe.effects.figures.schilling_1997.shared import lake as the
from fixedpipe.effects.figures.schilling_1997.shared.antialiased_panels import PASSES, SOFTWARE

DATA = figure_data(__file__, "F001-11")

ROW = the.SUBJECT.row({"without antialiasing": Antialiasing.NONE, "with roughness": Antialiasing.ANISOTROPIC})
# Times at which the waves are looked at, and the panels' height then.
_TIMES, _SMALL = tuple(k * 0.137 for k in range(6)), 96
# Of each method: by how much the RMS is larger without antialiasing.
_TIMES_LARGER = {
    SOFTWARE: (3.0, "the catalogue's bound"),
    PASSES: (2.0, "the passes' own RMS is larger: five cube maps, no curvature of the pixel's own"),
}


def checks(figure, renderer):
    """The catalogue's checks: RMS and fine changes; and how much the far water changes over time."""
    size, lake = figure.size, the.Lake(**figure.values)
    view, small = the.SUBJECT.at_origin(size), the.SUBJECT.at_origin(_SMALL)
    truth, water = the.truth(lake, view), the.rows_of_water(view)
    least, reason = _TIMES_LARGER[renderer.method.name]
    for on in Answer:
        plain, rough = (the.SUBJECT.panel(renderer.window(on, figure, size), k) for k in (0, 1))
        error = [root_mean_square((image - truth)[water]) for image in (plain, rough)]
        name = "RMS from 256 samples over the lake, over that with roughness"
        yield Check(name, error[0] / error[1], at_least=least, on=on, reason=reason)
        yield DATA.check(
            "energy above half of Nyquist's frequency, over that with roughness",
            the.fine_energy(plain, view) / the.fine_energy(rough, view),
            on,
        )
        yield DATA.check(
            "the same over the truth's", the.fine_energy(plain, view) / the.fine_energy(truth, view), on
        )
        frames = np.stack([renderer.window(on, figure, _SMALL, time=time) for time in _TIMES])
        moved = frames.var(axis=0)
        varied = [float(the.SUBJECT.panel(moved, k)[the.far(small)].mean()) for k in (0, 1)]
        yield DATA.check(
            "the far water's variance over time, over that with roughness",
            varied[0] / max(varied[1], 1e-12),
            on,
        )


FIGURE = Figure(**DATA.words, **ROW, size=the.HEIGHT, acceptance=checks)
