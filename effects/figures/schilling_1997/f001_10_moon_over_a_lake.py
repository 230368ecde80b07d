"""F001-10: the moon over a lake, its waves filtered without roughness and with it."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared import lake as the
from fixedpipe.effects.geometry.views import row_of_panels

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
        yield Check("with roughness: RMS from 256 samples over the lake", error, at_most=largest, on=on,
                    reason=reason)  # fmt: skip
        yield Check("with roughness: mean of the far water over the truth's, less one",
                    abs(float(rough[far].mean() / truth[far].mean()) - 1.0), at_most=mean, on=on,
                    reason=reason)  # fmt: skip
        length, width = the.column(rough, view)
        yield Check("with roughness: the column's length over its width", length / width, at_least=4.0,
                    on=on, reason="the catalogue's bound")  # fmt: skip
        yield Check("without roughness: RMS over that with it",
                    root_mean_square((averaged - truth)[water]) / error, at_least=2.0, on=on,
                    reason="the mean of far waves is a calm")  # fmt: skip
        yield Check("without roughness: light where a calm shows the moon", float(averaged[place].mean()),
                    at_least=0.7, on=on, reason="far waves' mean normal is straight up")  # fmt: skip
        yield Check("with roughness: light there", float(rough[place].mean()), at_most=0.5, on=on,
                    reason="it is spread over the column")  # fmt: skip


FIGURE = Figure(
    id="F001-10",
    title="Moon over a lake",
    caption=(
        "Waves of a bump map that tiles to the horizon mirror the night. Left the bump map is mip-mapped and "
        "nothing else: far waves' mean normal is straight up, and the lake shows the moon as a calm does. "
        "In the middle each texel keeps the deviation of the waves that it has lost, which spreads what is "
        "mirrored: far more up and down than across, as the lake is seen so flat. Right 256 samples a pixel."
    ),
    must_see=(
        "Left the moon's disc in the water. In the middle and right a column of glitter, narrow to the "
        "horizon, waves apart near by and even far away."
    ),
    source="Schilling1997",
    techniques=("S28", "S08", "S16", "S17", "S18", "S19", "S24", "S25", "S29"),
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
