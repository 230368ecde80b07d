"""F001-10: the moon over a lake, its waves filtered without roughness and with it."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared import lake as the
from fixedpipe.effects.geometry.views import row_of_panels

DATA = figure_data(__file__, "F001-10")

PANELS = ("waves averaged alone", "with roughness", "256 samples a pixel")
_WAYS = (Antialiasing.MIP, Antialiasing.ANISOTROPIC)
SOFTWARE, PASSES = "computed, shown as a picture", "texture shaders, a pass for each roughness"


def software(profile, size, **parameters):
    """F001-10 computed in floats, and shown."""
    lake, out = the.Lake(**parameters), []
    for panel, name, way in zip(row_of_panels(3, size, the.ASPECT), PANELS, (*_WAYS, None), strict=True):
        view = the.at_origin(size)
        picture = the.truth(lake, view) if way is None else the.answer(lake, view, way)
        out += the.shown(picture, panel, name, profile)
    return tuple(out)


def by_passes(profile, size, **parameters):
    """F001-10 by texture shaders; what it is compared with is computed."""
    lake = the.Lake(**parameters)
    panels = row_of_panels(3, size, the.ASPECT)
    loading, stored = the.load(lake, size, profile)
    out = [*loading]
    for panel, way in zip(panels, _WAYS, strict=False):
        out += the.drawn(lake, panel, stored, way)
    return (*out, *the.shown(the.truth(lake, the.at_origin(size)), panels[2], PANELS[2], profile))


def reference(size, **parameters):
    """256 samples a pixel, in every panel."""
    return the.with_panels(the.truth(the.Lake(**parameters), the.at_origin(size)), 3)


# Of each method: the largest RMS, and how far the far water's mean may be from the truth's.
_BOUNDS = {
    SOFTWARE: (0.03, 0.05, "the catalogue's bound"),
    PASSES: (0.03, 0.10, "the catalogue's RMS; five cube maps, and no curvature of the pixel's own"),
}


def checks(figure, renderer):
    """The catalogue's: RMS, the far water's mean, the column's shape; and what no roughness makes of it."""
    size, lake = figure.size, the.Lake(**figure.values)
    view = the.at_origin(size)
    truth, water, far = the.truth(lake, view), the.rows_of_water(view), the.far(view)
    largest, mean, reason = _BOUNDS[renderer.method.name]
    row, column = the.mirrored_moon(view, lake.moon)
    place = np.s_[row - 2 : row + 3, column - 2 : column + 3]
    for on in Answer:
        image = renderer.window(on, figure, size)
        averaged, rough = (the.panel(image, k) for k in (0, 1))
        error = root_mean_square((rough - truth)[water])
        yield Check(
            "with roughness: RMS from 256 samples over the lake", error, at_most=largest, on=on, reason=reason
        )
        yield Check("with roughness: mean of the far water over the truth's, less one",
                    abs(float(rough[far].mean() / truth[far].mean()) - 1.0), at_most=mean, on=on,
                    reason=reason)  # fmt: skip
        length, width = the.column(rough, view)
        yield DATA.check("with roughness: the column's length over its width", length / width, on)
        yield DATA.check(
            "without roughness: RMS over that with it",
            root_mean_square((averaged - truth)[water]) / error,
            on,
        )
        yield DATA.check(
            "without roughness: light where a calm shows the moon", float(averaged[place].mean()), on
        )
        yield DATA.check("with roughness: light there", float(rough[place].mean()), on)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    size=the.HEIGHT,
    aspect=the.ASPECT,
    parameters=the.PARAMETERS,
    methods=(
        Method(SOFTWARE, software, ("GEFORCE_256",)),
        Method(PASSES, by_passes, ("GEFORCE_3", "NV2A")),
    ),
    reference=reference,
    acceptance=checks,
)
