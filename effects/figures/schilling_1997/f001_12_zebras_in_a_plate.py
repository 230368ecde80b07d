"""F001-12: zebras mirrored by a flat, bumped plate, filtered by roughness."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared import zebras as the
from fixedpipe.effects.geometry.views import row_of_panels

DATA = figure_data(__file__, "F001-12")

PANELS = ("with roughness", "256 samples a pixel")
SOFTWARE, PASSES = "computed, shown as a picture", "texture shaders, a pass for each roughness"


def software(profile, size, **parameters):
    """F001-12 computed in floats, and shown."""
    plate, view = the.Plate(**parameters), the.at_origin(size)
    pictures = the.answer(plate, view, Antialiasing.ANISOTROPIC), the.truth(plate, view)
    out = []
    for panel, name, picture in zip(row_of_panels(2, size, the.ASPECT), PANELS, pictures, strict=True):
        out += the.shown(picture, panel, name, profile)
    return tuple(out)


def by_passes(profile, size, **parameters):
    """F001-12 by texture shaders; what it is compared with is computed."""
    plate = the.Plate(**parameters)
    first, second = row_of_panels(2, size, the.ASPECT)
    loading, stored = the.load(plate, size, profile)
    truth = the.truth(plate, the.at_origin(size))
    return (
        *loading,
        *the.drawn(plate, first, stored, Antialiasing.ANISOTROPIC),
        *the.shown(truth, second, PANELS[1], profile),
    )


def reference(size, **parameters):
    """256 samples a pixel, in both panels."""
    truth = the.truth(the.Plate(**parameters), the.at_origin(size))[::-1]
    return np.tile(np.concatenate([truth, np.ones_like(truth[..., :1])], axis=-1), (1, 2, 1))


# Of each method the largest RMS.
_BOUNDS = {
    SOFTWARE: (0.04, "the catalogue's bound"),
    PASSES: (0.065, "five cube maps, one probe of the bumps, no curvature. Measured: 0.059"),
}


def checks(figure, renderer):
    """The catalogue's: RMS from 256 samples a pixel."""
    size, plate = figure.size, the.Plate(**figure.values)
    view = the.at_origin(size)
    truth, full = the.truth(plate, view), the.coverage(view) == 1.0
    bound, reason = _BOUNDS[renderer.method.name]
    for on in Answer:
        image = renderer.window(on, figure, size)
        error = root_mean_square((the.panel(image, 0) - truth)[full])
        yield Check(
            "with roughness: RMS from 256 samples over the plate", error, at_most=bound, on=on, reason=reason
        )
    yield from _at_full_strength(figure)


def _at_full_strength(figure):
    """The same bounds for the bumps of F001-14 as they are, in floats."""
    plate, view = the.Plate(**{**figure.values, "strength": 1.0}), the.at_origin(figure.size // 2)
    truth, full = the.truth(plate, view), the.coverage(view) == 1.0
    plain, rough = (
        root_mean_square((the.answer(plate, view, way) - truth)[full])
        for way in (Antialiasing.NONE, Antialiasing.ANISOTROPIC)
    )
    yield DATA.check("bumps not flattened: RMS from 256 samples", rough, Answer.IDEAL)
    yield DATA.check("bumps not flattened: RMS without antialiasing over it", plain / rough, Answer.IDEAL)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    aspect=the.ASPECT,
    parameters=the.PARAMETERS,
    methods=(
        Method(SOFTWARE, software, ("GEFORCE_256",)),
        Method(PASSES, by_passes, ("GEFORCE_3", "NV2A")),
    ),
    reference=reference,
    acceptance=checks,
)
