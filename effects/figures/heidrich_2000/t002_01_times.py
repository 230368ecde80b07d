"""T002-1: table 1 of the paper as bars: its seconds and ours, and their ratios."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import missing_texts
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, INK, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels

DATA = figure_data(__file__, "T002-1")

STEPS = ("S_i", "ellipses", "software", "hardware")
# Seconds of (the paper's machine, ours), by height field and step. Source: Heidrich, Daubert, Kautz, Seidel
# 2000, table 1. Measured: `python -m bench scattering`, two cores of an AMD EPYC (family 26) with other work
# on them, 2026-11-23; "hardware" is the GeForce 256 as it is emulated; the paper does not say which it had.
SECONDS = {
    "triangles, 32 x 32": ((27.0, 0.0056), (32.0, 0.0016), (10.0, 0.0123), (0.48, 0.0368)),
    "bricks, 128 x 128": ((1029.0, 0.0542), (194.0, 0.0324), (12.0, 0.0796), (2.10, 0.2913)),
    "bumps, 32 x 32": ((109.0, 0.0044), (65.0, 0.0032), (8.0, 0.0106), (0.48, 0.0424)),
}
# Of the scale: a millisecond to some thousand seconds, as powers of ten, and where they stand on the sheet.
_LEAST, _MOST = -3, 4
_BOTTOM, _TOP = -0.44, 0.86
_WIDTH = 0.15
_COLORS, _GRID = (BLUE, YELLOW), (0.2, 0.21, 0.23)


def height_of(seconds):
    """Where a bar of so many seconds ends, on a scale of powers of ten."""
    # To a thousandth: logarithms differ in their last bit between processors.
    power = round(math.log10(seconds), 3)
    return _BOTTOM + (power - _LEAST) / (_MOST - _LEAST) * (_TOP - _BOTTOM)


def seconds_at(height):
    """The seconds that a bar of this height stands for."""
    return 10.0 ** (_LEAST + (height - _BOTTOM) / (_TOP - _BOTTOM) * (_MOST - _LEAST))


def middle_of(step, whose):
    """Where a bar stands: the middle of its width. ``whose``: 0 the paper's, 1 ours."""
    return -0.69 + 0.46 * step + (whose - 0.5) * _WIDTH * 1.1


def in_words(seconds):
    """1029 s, 2.1 s, 41 ms."""
    if seconds >= 1.0:
        return f"{seconds:.4g} s"
    return f"{1e3 * seconds:.2g} ms" if seconds < 0.1 else f"{1e3 * seconds:.0f} ms"


def _bars(view, times):
    out = []
    for whose, color in enumerate(_COLORS):
        outlines = []
        for step, pair in enumerate(times):
            x, top = middle_of(step, whose), height_of(pair[whose])
            left, right = x - _WIDTH / 2.0, x + _WIDTH / 2.0
            outlines.append(np.array([(left, _BOTTOM), (right, _BOTTOM), (right, top), (left, top)]))
        out.append(drawing.polygons("ours" if whose else "the paper's", view, outlines, color))
    for step, pair in enumerate(times):
        below = (middle_of(step, 0.5), _BOTTOM)
        ratio = f"x {pair[0] / pair[1]:.0f}"
        rows = ((STEPS[step], INK), *zip(map(in_words, pair), _COLORS, strict=True), (ratio, FAINT))
        for row, (words, color) in enumerate(rows):
            out.append(drawing.text(words, view, below, color, align=(0, 1), offset=(0.0, -7.0 - 15.0 * row)))
    return out


def _panel(view, times, background):
    lines = []
    for power in range(_LEAST, _MOST):
        y = height_of(10.0**power)
        lines.append(np.array([(-0.97, y), (0.97, y)]))
    return (
        view.panel.clear(background),
        drawing.strokes("powers of ten", view, lines, _GRID, width=0.8),
        *_bars(view, times),
        drawing.text("the paper's", view, (-0.95, 0.93), BLUE, align=(-1, 0)),
        drawing.text("ours", view, (-0.25, 0.93), YELLOW, align=(-1, 0)),
    )


def scene(profile, size, *, background):
    """A panel for each height field."""
    out = [drawing.load_font()]
    for panel, times in zip(row_of_panels(len(SECONDS), size), SECONDS.values(), strict=True):
        out += _panel(drawing.sheet(panel), times, background)
    return tuple(out)


def checks(figure, renderer):
    """The relations among the paper's own numbers, and ours read back from the drawn bars."""
    ratios = [times[2][0] / times[3][0] for times in SECONDS.values()]
    yield DATA.check(
        "software over hardware in the paper's table, the least of three", min(ratios), Answer.IDEAL
    )
    seen, ellipses = SECONDS["bricks, 128 x 128"][:2]
    yield DATA.check("S_i over ellipses for bricks in the paper's table", seen[0] / ellipses[0], Answer.IDEAL)
    for on in Answer:
        picture, worst = renderer.window(on, figure, figure.size), 0.0
        for number, times in enumerate(SECONDS.values()):
            panel = panel_of(picture, number)
            for step, pair in enumerate(times):
                for whose, color in enumerate(_COLORS):
                    column = int((middle_of(step, whose) + 1.0) / 2.0 * figure.size)
                    # The bar from its foot up to the first pixel of another colour.
                    foot = int((_BOTTOM + 1.0) / 2.0 * figure.size) + 1
                    bar = np.abs(panel[foot:, column] - np.array(color)).max(axis=-1) < 0.02
                    top = (foot + int(np.argmin(bar))) / figure.size * 2.0 - 1.0
                    worst = max(worst, abs(math.log10(seconds_at(top) / pair[whose])))
        pixel = 2.0 / figure.size / (_TOP - _BOTTOM) * (_MOST - _LEAST)
        yield DATA.check(
            "powers of ten between a bar as it is drawn and its seconds, at most",
            worst,
            on,
            at_most=1.1 * pixel,
        )
    yield from _sheet_checks(figure, renderer)


def _sheet_checks(figure, renderer):
    """The texts of the table, and the lines of the scale left of the bars."""
    texts = ["the paper's", "ours"] * len(SECONDS)
    for times in SECONDS.values():
        for step, pair in zip(STEPS, times, strict=True):
            texts += [step, *map(in_words, pair), f"x {pair[0] / pair[1]:.0f}"]
    yield DATA.check(
        "texts of the table that are not written", missing_texts(figure, renderer, texts), Answer.MACHINE
    )
    size, powers = figure.size, np.arange(_MOST - _LEAST)
    heights = _BOTTOM + powers / (_MOST - _LEAST) * (_TOP - _BOTTOM)
    rows, column = ((heights + 1.0) / 2.0 * size).astype(int), int((1.0 - 0.93) / 2.0 * size)
    for on in Answer:
        picture = renderer.window(on, figure, size)
        apart = max(
            float(np.abs(panel_of(picture, k)[rows, column] - np.array(_GRID)).max())
            for k in range(len(SECONDS))
        )
        yield DATA.check("colours of the powers of ten at their heights, largest difference", apart, on)


FIGURE = Figure(
    **DATA.words,
    panels=tuple(SECONDS),
    parameters={"background": word.BACKDROP(BACKGROUND)},
    methods=(Method("bars", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
