"""F001-13: the zebras of F001-12 without antialiasing, and with bumps that are averaged alone."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared import zebras as the
from fixedpipe.effects.geometry.views import row_of_panels

DATA = figure_data(__file__, "F001-13")

PANELS = ("without antialiasing", "bumps averaged alone")
_WAYS = (Antialiasing.NONE, Antialiasing.MIP)


def software(profile, size, **parameters):
    """F001-13 computed in floats, and shown."""
    plate, view, out = the.Plate(**parameters), the.at_origin(size), []
    for panel, name, way in zip(row_of_panels(2, size, the.ASPECT), PANELS, _WAYS, strict=True):
        out += the.shown(the.answer(plate, view, way), panel, name, profile)
    return tuple(out)


def by_passes(profile, size, **parameters):
    """F001-13 by texture shaders."""
    plate = the.Plate(**parameters)
    loading, stored = the.load(plate, size, profile)
    out = [*loading]
    for panel, way in zip(row_of_panels(2, size, the.ASPECT), _WAYS, strict=True):
        out += the.drawn(plate, panel, stored, way)
    return tuple(out)


def reference(size, **parameters):
    """256 samples a pixel, in both panels."""
    truth = the.truth(the.Plate(**parameters), the.at_origin(size))[::-1]
    return np.tile(np.concatenate([truth, np.ones_like(truth[..., :1])], axis=-1), (1, 2, 1))


def checks(figure, renderer):
    """The catalogue's: how many times F001-12's RMS."""
    size, plate = figure.size, the.Plate(**figure.values)
    view = the.at_origin(size)
    truth, full = the.truth(plate, view), the.coverage(view) == 1.0
    filtered = the.answer(plate, view, Antialiasing.ANISOTROPIC)
    least = root_mean_square((filtered - truth)[full])
    for on in Answer:
        image = renderer.window(on, figure, size)
        error = root_mean_square((the.panel(image, 0) - truth)[full])
        yield DATA.check(
            "without antialiasing: RMS from 256 samples over that with roughness", error / least, on
        )


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    aspect=the.ASPECT,
    parameters=the.PARAMETERS,
    methods=(
        Method("computed, shown as a picture", software, ("GEFORCE_256",)),
        Method("texture shaders, one pass", by_passes, ("GEFORCE_3", "NV2A")),
    ),
    reference=reference,
    acceptance=checks,
)
