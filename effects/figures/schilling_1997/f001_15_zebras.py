"""F001-15: the environment of F001-12, zebras all round."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared import zebras as the
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F001-15")

MACHINES = ("OPENGL_1_2", "GEFORCE_256")
ASPECT = (2, 1)


def scene(profile, size):
    """F001-15: the panorama as a picture."""
    (panel,) = row_of_panels(1, size, ASPECT)
    view = orthographic_view(panel)
    image = texture_2d(factor_texels(the.panorama(), profile))
    read = unit("zebras", EDGE, environment=REPLACE)
    return (
        TexImage(label="load the panorama", texture="zebras", image=image),
        panel.clear((0.0, 0.0, 0.0)),
        draw("the panorama", plane(1, 1, 2.0).mesh(), view, None, (read,), depth_test=FIRST_PASS),
    )


def checks(figure, renderer):
    """The picture, and that the cube map which the plate mirrors is the same."""
    size = the.ROWS
    image = np.asarray(renderer.window(Answer.MACHINE, figure, size))
    yield DATA.check(
        "the picture - the panorama, RMS",
        float(np.sqrt(((image - the.panorama()) ** 2).mean())),
        Answer.MACHINE,
        at_most=0.5 / 255.0,
    )
    t, s = np.meshgrid(np.pi * (np.arange(32) / 32.0 + 1.0 / 64.0 - 0.5), 2.0 * np.pi * np.arange(64) / 64.0)
    toward = np.stack([np.cos(t) * np.sin(s), np.sin(t), -np.cos(t) * np.cos(s)], axis=-1)
    found = cube_maps.look_up(the.cubes(256)[0], toward)
    column = ((0.5 + s / (2.0 * np.pi)) % 1.0 * 2 * the.ROWS).astype(np.int64)
    row = ((0.5 + t / np.pi) * the.ROWS).astype(np.int64)
    apart = np.abs(found - the.panorama()[row, column]).max(axis=-1)
    yield DATA.check(
        "directions whose colours in the cube map are the panorama's within a tenth",
        float((apart <= 0.1).mean()),
        Answer.IDEAL,
    )


FIGURE = Figure(
    **DATA.words,
    aspect=ASPECT,
    parameters={},
    methods=(Method("texture", scene, MACHINES),),
    acceptance=checks,
)
