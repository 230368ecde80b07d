"""F001-11: the lake without antialiasing, beside the one that roughness filters."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared import lake as the
from fixedpipe.effects.geometry.views import row_of_panels

DATA = figure_data(__file__, "F001-11")

PANELS = ("without antialiasing", "with roughness")
_WAYS = (Antialiasing.NONE, Antialiasing.ANISOTROPIC)
SOFTWARE, PASSES = "computed, shown as a picture", "texture shaders, a pass for each roughness"
# Times at which the waves are looked at, and the panels' height then.
_TIMES, _SMALL = tuple(k * 0.137 for k in range(6)), 96


def software(profile, size, **parameters):
    """F001-11 computed in floats, and shown."""
    lake, out = the.Lake(**parameters), []
    for panel, name, way in zip(row_of_panels(2, size, the.ASPECT), PANELS, _WAYS, strict=True):
        out += the.shown(the.answer(lake, the.at_origin(size), way), panel, name, profile)
    return tuple(out)


def by_passes(profile, size, **parameters):
    """F001-11 by texture shaders."""
    lake = the.Lake(**parameters)
    loading, stored = the.load(lake, size, profile)
    out = [*loading]
    for panel, way in zip(row_of_panels(2, size, the.ASPECT), _WAYS, strict=True):
        out += the.drawn(lake, panel, stored, way)
    return tuple(out)


def reference(size, **parameters):
    """256 samples a pixel, in both panels."""
    return the.with_panels(the.truth(the.Lake(**parameters), the.at_origin(size)), 2)


# Of each method: by how much the RMS is larger without antialiasing.
_TIMES_LARGER = {
    SOFTWARE: (3.0, "the catalogue's bound"),
    PASSES: (2.0, "the passes' own RMS is larger: five cube maps, no curvature of the pixel's own"),
}


def checks(figure, renderer):
    """The catalogue's: RMS and fine changes; and how much the far water changes from time to time."""
    size, lake = figure.size, the.Lake(**figure.values)
    view, small = the.at_origin(size), the.at_origin(_SMALL)
    truth, water = the.truth(lake, view), the.rows_of_water(view)
    least, reason = _TIMES_LARGER[renderer.method.name]
    for on in Answer:
        plain, rough = (the.panel(renderer.window(on, figure, size), k) for k in (0, 1))
        error = [root_mean_square((image - truth)[water]) for image in (plain, rough)]
        yield Check("RMS from 256 samples over the lake, over that with roughness", error[0] / error[1],
                    at_least=least, on=on, reason=reason)  # fmt: skip
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
        varied = [float(the.panel(moved, k)[the.far(small)].mean()) for k in (0, 1)]
        yield DATA.check(
            "the far water's variance over time, over that with roughness",
            varied[0] / max(varied[1], 1e-12),
            on,
        )


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
