"""F001-1: a puzzle, writing stretched so far that it does not read."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.texture_filtering import stretched_writing as written

DATA = figure_data(__file__, "F001-1")

MACHINES = ("OPENGL_1_2", "TEXRAM", "GEFORCE_3", "NV2A")


def scene(profile, size, *, stretch, background):
    """F001-1: the page from above."""
    (panel,) = row_of_panels(1, size)
    view = written.from_above(panel)
    page = written.writing(written.page_edge(size), stretch=stretch)
    return (
        written.load(page, profile),
        panel.clear(background),
        written.page_pass("the page from above", view, written.sampler()),
    )


def checks(figure, renderer):
    """The stretch, found again in the picture."""
    size = figure.size
    for on in Answer:
        image = renderer.window(on, figure, size)
        yield DATA.check(
            "the stretch that is found by matching, off the figure's",
            abs(written.found_stretch(np.asarray(image)) - figure.values["stretch"]),
            on,
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "stretch": word.of(word.Whole(1, 8), written.STRETCH, "How many times too high the letters are."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("mip-mapping", scene, MACHINES),),
    acceptance=checks,
)
