"""F001-1: a puzzle, writing stretched so far that it does not read."""

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.seen_places import WITHIN, alike
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


def _written_by_pillow(size, stretch):
    """The page in Pillow's font: float64 [size, size, 3], bottom row first. Lines are in the middle, and
    spread evenly. Each has the rows of the font in which any letter has ink.
    """
    font = ImageFont.load_default_imagefont()
    whole = Image.new("L", (256, 16 * len(written.LINES)))
    for number, line in enumerate(written.LINES):
        ImageDraw.Draw(whole).text((0, 16 * number), line, 255, font)
    rows = np.asarray(whole).reshape(len(written.LINES), 16, 256) > 0
    (used,) = np.nonzero(rows.any(axis=(0, 2)))
    scale, page = size // 256, np.zeros((size, size), np.bool_)
    high = len(used) * stretch * scale
    gap = (size - high * len(rows)) // (len(rows) + 1)
    for number, line in enumerate(rows):
        wide = int(font.getlength(written.LINES[number]))
        ink = line[used, :wide].repeat(stretch * scale, axis=0).repeat(scale, axis=1)
        top, left = gap + number * (high + gap), (size - ink.shape[1]) // 2
        page[top : top + high, left : left + ink.shape[1]] = ink
    return np.where(page[::-1, :, None], written.INK, written.PAPER)


def checks(figure, renderer):
    """The page as Pillow writes it, and the stretch, found again in the picture."""
    size = figure.size
    page = _written_by_pillow(size, figure.values["stretch"])
    for on in Answer:
        image = renderer.window(on, figure, size)
        yield DATA.check(
            "pixels that show the page as Pillow writes it, a share",
            alike(image, page, WITHIN),
            on,
            at_least=0.5 + 0.5 * alike(np.broadcast_to(written.PAPER, page.shape), page, WITHIN),
        )
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
