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


def _places(image):
    """What the picture shows of every zebra, at places of its own coordinates."""
    rows, columns = image.shape[:2]

    def pixels(s, t):
        column, row = np.floor(np.array(s) % 1.0 * columns), np.floor(np.array(t) * rows)
        return image[row.astype(np.int64), column.astype(np.int64)]

    under, above, upright = [], [], []
    for place, foot, size, looks in the.ZEBRAS:
        # A texel and a half below the hooves of the hind and the fore legs.
        legs = [place + looks * x * size / 3.4 for x in (-0.61, 0.63)]
        under.append(pixels(legs, foot - 1.5 / rows))
        above.append(pixels([place], foot + 0.12))
        x, y = np.arange(-0.55, 0.55, 0.05), the.HOOVES + np.arange(-0.2, 0.2, 0.05)
        body = pixels(*np.meshgrid(place + x * size / 3.4, foot + y * size / 1.7)).mean(axis=-1)
        along, up = (np.abs(np.diff(body, axis=axis)).mean() for axis in (1, 0))
        upright.append(along / max(up, 1.0 / 255.0))
    under, above = np.concatenate(under), np.concatenate(above)
    return {
        "zebras: share of hooves with grass below them": float((under[:, 2] < 0.6 * under[:, 1]).mean()),
        "zebras: share with sky above them": float((above[:, 2] > above[:, 0]).mean()),
        "zebras: changes along the body over those up and down it, the least": float(min(upright)),
    }


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
    for name, value in _places(image).items():
        yield DATA.check(name, value, Answer.MACHINE)
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
