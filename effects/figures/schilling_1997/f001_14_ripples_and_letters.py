"""F001-14: the heights whose slopes are the bumps of F001-12."""

import numpy as np
from PIL import ImageFont

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared import zebras as the
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F001-14")

MACHINES = ("OPENGL_1_2", "GEFORCE_256")


def _heights():
    """From 0 to 1: float64 [256, 256]."""
    found = the.relief()
    low, high = float(found.min()), float(found.max())
    return (found - low) / (high - low)


def scene(profile, size, *, slope):
    """F001-14: the heights as a picture, high is light."""
    del slope
    (panel,) = row_of_panels(1, size)
    view, heights = orthographic_view(panel), _heights()
    image = texture_2d(factor_texels(np.repeat(heights[..., None], 3, axis=-1), profile))
    read = unit("heights", EDGE, environment=REPLACE)
    return (
        TexImage(label="load the heights", texture="heights", image=image),
        panel.clear((0.0, 0.0, 0.0)),
        draw("the heights", plane().mesh(), view, None, (read,), depth_test=FIRST_PASS),
    )


def _word_in(image):
    """How much the middle of a picture [256, 256], bottom row first, is like the word: a correlation.

    The letters are Pillow's own, a pixel of theirs 7 wide and 12 high, as the heights' are.
    """
    mask = ImageFont.load_default_imagefont().getmask(the.WORD)
    ink = np.array(mask).reshape(mask.size[::-1])[::-1] > 0
    ink = ink.repeat(12, axis=0).repeat(7, axis=1).astype(np.float64)
    (low, left), (high, wide) = ((256 - edge) // 2 for edge in ink.shape), ink.shape
    box = image[low : low + high, left : left + wide]
    a, b = box - box.mean(), ink - ink.mean()
    return float((a * b).sum() / np.sqrt((a * a).sum() * (b * b).sum()))


def checks(figure, renderer):
    """The deviation of slopes, and the picture."""
    plate = the.Plate(figure.values["slope"], 1.0, 1.0)
    slopes = the.slopes(plate)
    deviation = float(np.sqrt((slopes * slopes).mean()))
    for bound, name in (({"at_least": 0.2}, "at least"), ({"at_most": 0.5}, "at most")):
        name = f"deviation of the bump map's slopes, {name}"
        yield Check(name, deviation, on=Answer.IDEAL, reason="the catalogue's", **bound)
    heights = _heights()
    size = 256
    image = np.asarray(renderer.window(Answer.MACHINE, figure, size))[..., 0]
    yield DATA.check(
        "the word in the picture's middle: correlation with the font's own letters",
        _word_in(image),
        Answer.MACHINE,
    )
    yield DATA.check(
        "the picture - the heights, RMS",
        float(np.sqrt(((image - heights) ** 2).mean())),
        Answer.MACHINE,
        at_most=0.5 / 255.0,
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "slope": word.of(word.Number(0.01, 1.0), 0.3, "The deviation of the bump map's slopes."),
    },
    methods=(Method("texture", scene, MACHINES),),
    acceptance=checks,
)
