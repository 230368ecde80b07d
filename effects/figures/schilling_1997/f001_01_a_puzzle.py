"""F001-1: a puzzle, writing stretched so far that it does not read."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.texture_filtering import stretched_writing as written

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
    """The stretch, found again in what is drawn."""
    size = figure.size
    for on in Answer:
        image = renderer.window(on, figure, size)
        yield Check("the stretch that is found by matching, off the figure's",
                    abs(written.found_stretch(np.asarray(image)) - figure.values["stretch"]), at_most=0,
                    on=on, reason="the catalogue's: whole numbers of the font's pixels")  # fmt: skip


FIGURE = Figure(
    id="F001-1",
    title="A puzzle",
    caption=(
        "Writing eight times as high as it should be hardly reads; for an eye that looks along the page it "
        "does (F001-2), or when the picture is tilted."
    ),
    must_see="Bars and slabs of ink in four rows, no words at a glance.",
    source="Schilling1997",
    techniques=("S01",),
    panels=("from above",),
    parameters={
        "stretch": word.of(word.Whole(1, 8), written.STRETCH, "How many times too high the letters are."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("mip-mapping", scene, MACHINES),),
    acceptance=checks,
)
