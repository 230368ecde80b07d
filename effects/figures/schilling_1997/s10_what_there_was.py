"""S10: the moon on a lake by earlier methods, by roughness, and by a ray tracer with the same ellipses."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import bump_baselines
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing, Mirror
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared import lake as the
from fixedpipe.effects.geometry.views import Panel, panel_of, row_of_panels

DATA = figure_data(__file__, "S10")

PANELS = ("a cone by curvature", "bumps, then a BRDF", "roughness", "64 normals of the ellipse")


def _pictures(size, first, last, normals, lake):
    """The four panels: float64 [size, size, 3] each."""
    view, levels = the.camera(Panel(0, 0, size, size)), the.pyramids(lake, the.TEXELS)
    cubes, mirror = the.environment(lake, the.cube_edge(size)), Mirror(period=lake.period)
    yield the.answer(lake, view, Antialiasing.CONE)
    yield np.minimum(bump_baselines.switched(view, mirror, levels, cubes, first, last), 1.0)
    yield the.answer(lake, view, Antialiasing.ANISOTROPIC)
    traced = bump_baselines.traced(view, mirror, levels, cubes, normals, the.PROBES)
    yield np.minimum(traced, 1.0)


def scene(profile, size, *, first, last, normals, **parameters):
    """S10: computed in floats, and shown."""
    out = []
    pictures = _pictures(size, first, last, normals, the.Lake(**parameters))
    for panel, name, picture in zip(row_of_panels(4, size), PANELS, pictures, strict=True):
        out += the.shown(picture, panel, name, profile)
    return tuple(out)


def _truth(size, parameters):
    return the.truth(the.Lake(**parameters), the.camera(Panel(0, 0, size, size)))


def reference(size, **parameters):
    """256 samples a pixel, in every panel."""
    truth = _truth(size, {name: parameters[name] for name in the.PARAMETERS})[::-1]
    return np.tile(np.concatenate([truth, np.ones_like(truth[..., :1])], axis=-1), (1, 4, 1))


def checks(figure, renderer):
    """RMS over the lake, and the far water's mean."""
    size = figure.size // 2
    truth = _truth(size, {name: figure.values[name] for name in the.PARAMETERS})
    view = the.camera(Panel(0, 0, size, size))
    water, far = the.rows_of_water(view), the.far(view)
    for on in Answer:
        image = renderer.window(on, figure, size)
        panels = [panel_of(image, k) for k in range(4)]
        cone, switched, rough, traced = (root_mean_square((p - truth)[water]) for p in panels)
        yield DATA.check("roughness: RMS from 256 samples over the lake", rough, on)
        yield DATA.check("cone by curvature: RMS over that of roughness", cone / rough, on)
        yield DATA.check("bumps, then a BRDF: RMS over that of roughness", switched / rough, on)
        yield DATA.check("64 normals: RMS over that of roughness", traced / rough, on)
        mean = [abs(float(p[far].mean() / truth[far].mean()) - 1.0) for p in panels]
        yield DATA.check("64 normals: mean of the far water over the truth's, less one", mean[3], on)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "first": word.of(word.Number(0.0, 8.0), 1.0, "The level up to which bumps alone are seen."),
        "last": word.of(word.Number(0.0, 8.0), 4.0, "The level from which on the BRDF alone is seen."),
        "normals": word.of(word.Whole(1, 256), 64, "How many normals a pixel the ray tracer takes."),
        **the.PARAMETERS,
    },
    methods=(Method("computed, shown as a picture", scene, ("GEFORCE_256",)),),
    reference=reference,
    acceptance=checks,
)
