"""F001-3: rays that bumps reflect which are not filtered go anywhere."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared.bumpy_line import (
    heights,
    mean_slopes,
    mirrored,
    slopes,
    turned,
    waves,
)
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F001-3")

PANELS = ("one sample a pixel", "filtered over the pixel")
PIXELS = 8
PIXEL = 2.0 / PIXELS
DOWN, UP = (0.0, -1.0), (0.0, 1.0)
# Waves of several pixels, which filtering keeps, and some that go up and down within one.
LONG = waves(2, 9.0 * PIXEL, 5.0 * PIXEL, 0.07, 4)
FINE = waves(5, 0.72 * PIXEL, 0.4 * PIXEL, 0.36, 9)
BASE, TOP, RAY = -0.62, 0.86, 0.62
_BELOW = -0.86


def _both(function, x, *more):
    return function(LONG, x, *more) + function(FINE, x, *more)


def places(shift):
    """Where the pixels look, ``shift`` pixels off their middles: float64 [PIXELS]."""
    return PIXEL * (np.arange(PIXELS) + 0.5 + shift) - 1.0


def seen_slopes(shift, filtered):
    """The slope that each pixel sees: float64 [PIXELS]."""
    x = places(shift)
    return _both(mean_slopes, x, PIXEL) if filtered else _both(slopes, x)


def line(x, filtered):
    """The surface that pixels see, bumps or what filtering leaves of them: float64 [..., 2]."""
    high = _both(heights, x)
    if filtered:
        # The mean over a pixel, by 64 places.
        high = sum(_both(heights, x + PIXEL * ((k + 0.5) / 64.0 - 0.5)) for k in range(64)) / 64.0
    return np.stack([x, BASE + high], axis=-1)


def rays(shift, filtered):
    """Feet and tips of the mirrored rays: float64 [PIXELS, 2] each."""
    feet = line(places(shift), filtered)
    return feet, feet + RAY * mirrored(DOWN, seen_slopes(shift, filtered))


def _view(panel):
    return drawing.sheet(panel, 1.06)


def _panel(view, shift, filtered):
    x = np.linspace(-1.0, 1.0, 385)
    borders = -1.0 + PIXEL * np.arange(PIXELS + 1)
    feet, tips = rays(shift, filtered)
    out = [
        drawing.strokes("the pixels' borders", view, [((b, TOP), (b, TOP + 0.08)) for b in borders], INK),
        drawing.stroke("the row of pixels", view, ((-1.0, TOP), (1.0, TOP)), INK),
    ]
    outline = line(x, filtered)
    body = [
        np.array([outline[k], outline[k + 4], (x[k + 4], _BELOW), (x[k], _BELOW)])
        for k in range(0, len(x) - 1, 4)
    ]
    out += [
        drawing.polygons("the surface", view, body, (0.13, 0.15, 0.20)),
        *([drawing.stroke("the bumps", view, line(x, False), FAINT)] if filtered else []),
        drawing.stroke("its outline", view, outline, INK, width=2.0),
        drawing.strokes(
            "rays from the pixels", view, [((f[0], TOP), f) for f in feet], BLUE, dash=drawing.DASH
        ),
    ]
    color = GREEN if filtered else YELLOW
    out += [
        drawing.arrow("a mirrored ray", view, ends, color, width=2.2)
        for ends in np.stack([feet, tips], axis=1)
    ]
    return out


def scene(profile, size, *, shift, background):
    """F001-3: a row of pixels over bumps, and over what filtering leaves of them."""
    out = []
    for number, panel in enumerate(row_of_panels(2, size)):
        out += [panel.clear(background), *_panel(_view(panel), shift, bool(number))]
    return tuple(out)


def _clear(feet, tips):
    """Rays whose middles are in the panel and that no other ray comes near there: a list of numbers."""
    out = []
    for k, middle in enumerate(0.5 * (feet + tips)):
        along = tips - feet
        share = ((middle - feet) * along).sum(axis=1) / (along * along).sum(axis=1)
        off = middle - (feet + np.clip(share, 0.0, 1.0)[:, None] * along)
        near = np.sqrt((off * off).sum(axis=1)) < 0.06
        if near.sum() == 1 and abs(middle[0]) < 0.98:
            out.append(k)
    return out


def checks(figure, renderer):
    """By how much rays turn as the samples move by a pixel; means of slopes in a second way; marks."""
    shifts = (np.arange(16) + 0.5) / 16.0 - 0.5
    spread = []
    for filtered in (False, True):
        turns = np.stack([turned(mirrored(DOWN, seen_slopes(s, filtered)), UP) for s in shifts])
        spread.append(float(turns.var(axis=0).mean()))
    yield DATA.check(
        "variance of directions under shifts below a pixel, over filtered rays",
        spread[0] / spread[1],
        Answer.IDEAL,
    )
    yield DATA.check("its root without filtering, degrees", float(np.sqrt(spread[0])), Answer.IDEAL)
    fine = (np.arange(512) + 0.5) / 512.0 - 0.5
    sampled = np.stack([seen_slopes(s, False) for s in fine]).mean(axis=0)
    yield DATA.check(
        "mean slope of a pixel by its ends - by 512 samples, largest",
        float(np.abs(sampled - seen_slopes(0.0, True)).max()),
        Answer.IDEAL,
    )
    marks = []
    for number, panel in enumerate(row_of_panels(2, figure.size // 2)):
        view = _view(panel)
        feet, tips = rays(figure.values["shift"], bool(number))
        marks += [
            (number, view, 0.5 * (feet[k] + tips[k]), (YELLOW, GREEN)[number]) for k in _clear(feet, tips)
        ]
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "shift": word.of(word.Number(-0.5, 0.5), 0.0, "How far the samples are off the middles.", "pixels"),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
