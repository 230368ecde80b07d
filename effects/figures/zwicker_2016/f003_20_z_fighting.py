"""F003-20: a diagram of z-fighting on a slanted surface, and of the effect of a bias.

The surface and a plate above it are seen from the side; parallel light falls straight down. A texel of the
shadow map has one depth over its width. It is the nearest depth at the texel's middle, moved away by the bias
of PolygonOffset and rounded to the depth's bits. Farther points are in shadow.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, INK, RED, VIOLET, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F003-20")

# The map's plane, depth zero, and its ends; so many texels; depth one is at the bottom.
TOP, LEFT, RIGHT, TEXELS, BOTTOM = 0.72, -0.9, 0.9, 9, -0.92
WIDTH = (RIGHT - LEFT) / TEXELS
RANGE = TOP - BOTTOM
# A depth buffer of so few bits that its steps can be seen.
BITS = 5
UNIT = RANGE / (2**BITS - 1)
# The surface's height at x, and how far above it a plate hovers over these texels.
HEIGHT, SLOPE, GAP, PLATE = -0.05, -0.5, 0.24, (5, 7)
_SHADOW, _FILL = (0.30, 0.40, 0.72), (0.16, 0.165, 0.19)


def depth_of_surface(x):
    """The surface's depth below the map's plane."""
    return TOP - (HEIGHT + SLOPE * x)


def is_under_plate(x):
    """Whether the plate is between x on the surface and the light."""
    return (x > LEFT + PLATE[0] * WIDTH) & (x < LEFT + PLATE[1] * WIDTH)


def stored_depths(bias):
    """The shadow map: float64 [TEXELS], each depth at a texel's middle plus the bias, rounded to ``BITS``."""
    middles = LEFT + WIDTH * (np.arange(TEXELS) + 0.5)
    nearest = depth_of_surface(middles) - np.where(is_under_plate(middles), GAP, 0.0)
    return np.floor((nearest + bias) / UNIT + 0.5) * UNIT


def polygon_offset(factor, units):
    """OpenGL's bias: ``factor`` times the slope over a texel, ``units`` times a step of the depth."""
    return factor * abs(SLOPE) * WIDTH + units * UNIT


@dataclass(frozen=True)
class Part:
    """A part of the surface between two x that is all lit or all in shadow by the map, and whether it is."""

    start: float
    end: float
    lit: bool

    @property
    def wrong(self):
        """Whether the map is wrong there."""
        return self.lit == bool(is_under_plate(0.5 * (self.start + self.end)))


def parts(bias):
    """The whole surface under the map, from left to right, divided where its depth crosses a texel's."""
    out = []
    for k, stored in enumerate(stored_depths(bias)):
        start, end = LEFT + k * WIDTH, LEFT + (k + 1) * WIDTH
        # The depth grows by -SLOPE in each unit of x.
        crossing = float(start + (stored - depth_of_surface(start)) / -SLOPE)
        if start < crossing < end:
            out += [Part(start, crossing, True), Part(crossing, end, False)]
        else:
            out.append(Part(start, end, bool(depth_of_surface(0.5 * (start + end)) <= stored)))
    return tuple(out)


def shares(bias):
    """Which share of the surface that sees the light is in shadow by the map, and which share of the hidden
    surface is lit.
    """
    plate = (PLATE[1] - PLATE[0]) * WIDTH
    wrong = [part for part in parts(bias) if part.wrong]
    acne = sum(part.end - part.start for part in wrong if not part.lit) / (RIGHT - LEFT - plate)
    return acne, sum(part.end - part.start for part in wrong if part.lit) / plate


def _on_surface(x):
    return x, TOP - depth_of_surface(x)


def _panel(view, bias, title):
    ends = [_on_surface(-0.98), _on_surface(0.98)]
    ground = [(-0.98, -0.97), (0.98, -0.97), ends[1], ends[0]]
    out = [drawing.polygon("below the surface", view, ground, _FILL)]
    out.append(drawing.stroke("surface outside of the map", view, ends, FAINT, width=2.0))
    stored = stored_depths(bias)
    borders = LEFT + WIDTH * np.arange(TEXELS + 1)
    deepest = np.maximum(np.append(stored[:1], stored), np.append(stored, stored[-1:]))
    out.append(
        drawing.strokes(
            "borders of texels",
            view,
            [
                [(x, TOP), (x, TOP - max(d, depth_of_surface(x)))]
                for x, d in zip(borders, deepest, strict=True)
            ],
            FAINT,
            width=0.6,
            dash=(2.0, 4.0),
        )
    )
    for k, depth in enumerate(stored):
        grey = depth / RANGE
        x0, x1 = borders[k] + 0.008, borders[k + 1] - 0.008
        cell = [(x0, TOP), (x1, TOP), (x1, TOP + 0.08), (x0, TOP + 0.08)]
        out.append(drawing.polygon("texel", view, cell, (grey, grey, grey)))
    plate = [_on_surface(x) for x in (LEFT + PLATE[0] * WIDTH, LEFT + PLATE[1] * WIDTH)]
    plate = [(x, y + GAP) for x, y in plate]
    out.append(drawing.stroke("plate", view, plate, INK, width=3.0))
    kinds = (
        ("lit", YELLOW, False, True),
        ("in shadow", _SHADOW, False, False),
        ("wrong", RED, True, None),
    )
    divided = parts(bias)
    for name, color, wrong, lit in kinds:
        lines = [
            [_on_surface(part.start), _on_surface(part.end)]
            for part in divided
            if part.wrong == wrong and lit in (None, part.lit)
        ]
        if lines:
            out.append(drawing.strokes(f"surface, {name}", view, lines, color, width=3.4))
    steps = [[(borders[k], TOP - d), (borders[k + 1], TOP - d)] for k, d in enumerate(stored)]
    out.append(drawing.strokes("stored depths", view, steps, BLUE, width=1.6))
    if bias:
        k = 2
        x = 0.5 * (borders[k] + borders[k + 1])
        place = _on_surface(x)
        # From the surface at the texel's middle to where the bias moves it, before it is rounded.
        arrow = [place, (x, place[1] - bias)]
        out.append(drawing.arrow("the bias", view, arrow, VIOLET, head=6.0))
        label = (x, place[1] - bias)
        out.append(drawing.text("bias", view, label, VIOLET, align=(0, 1), offset=(-6.0, -5.0)))
    out.append(drawing.text("shadow map", view, (0.0, TOP + 0.08), INK, align=(0, -1), offset=(0.0, 3.0)))
    out.append(drawing.text(title, view, (-0.9, -0.94), INK, align=(-1, -1)))
    return tuple(out)


def biases(right, too_much):
    """The three biases, from left to right: none, the right one and one that is too large."""
    return 0.0, polygon_offset(*right), polygon_offset(*too_much)


def scene(profile, size, *, right, too_much, background):
    """The surface without a bias, and with PolygonOffset's (factor, units) ``right`` and ``too_much``."""
    out = [drawing.load_font()]
    titles = ("no bias", "correct bias", "too much bias")
    for panel, bias, title in zip(row_of_panels(3, size), biases(right, too_much), titles, strict=True):
        out += [panel.clear(background), *_panel(drawing.sheet(panel), bias, title)]
    return tuple(out)


def _misjudged(bias):
    """At how many points of the surface, 40 under each texel, ``parts`` is not what the comparison says."""
    x = LEFT + WIDTH * (np.arange(40 * TEXELS) + 0.5) / 40.0
    lit = depth_of_surface(x) <= np.repeat(stored_depths(bias), 40)
    found = [next(part.lit for part in parts(bias) if part.start <= at <= part.end) for at in x.tolist()]
    return int((lit != np.array(found)).sum())


def _marks(size, settings):
    """The stored depths, the map's texels, the plates and the biases, for ``drawn_check``."""
    out = []
    for k, (panel, bias) in enumerate(zip(row_of_panels(3, size), settings, strict=True)):
        view, plate = drawing.sheet(panel), LEFT + 0.5 * (PLATE[0] + PLATE[1]) * WIDTH
        for i, depth in enumerate(stored_depths(bias)):
            x, grey = LEFT + (i + 0.25) * WIDTH, depth / RANGE
            out += [(k, view, (x, TOP - depth), BLUE), (k, view, (x, TOP + 0.04), (grey, grey, grey))]
        out.append((k, view, (plate, _on_surface(plate)[1] + GAP), INK))
        if bias:
            x = LEFT + 2.5 * WIDTH
            out.append((k, view, (x, _on_surface(x)[1] - 0.7 * bias), VIOLET))
    return out


def checks(figure, renderer):
    """The map's errors with each bias, and that the picture shows them at the computed places."""
    p = figure.values
    none, right, too_much = biases(p["right"], p["too_much"])
    least = polygon_offset(0.5, 0.5)
    yield DATA.check("no bias: share of the lit surface in shadow", shares(none)[0], Answer.IDEAL)
    yield DATA.check("no bias: share of the plate's shadow that is lit", shares(none)[1], Answer.IDEAL)
    yield DATA.check("correct bias: share of the lit surface in shadow", shares(right)[0], Answer.IDEAL)
    yield DATA.check("correct bias: share of the plate's shadow that is lit", shares(right)[1], Answer.IDEAL)
    yield DATA.check("correct bias over the least that suffices for any surface", right / least, Answer.IDEAL)
    yield DATA.check(
        "half of the correct bias: share of the lit surface in shadow", shares(0.5 * right)[0], Answer.IDEAL
    )
    yield DATA.check(
        "too much bias: share of the plate's shadow that is lit", shares(too_much)[1], Answer.IDEAL
    )
    misjudged = sum(_misjudged(bias) for bias in (none, right, too_much))
    yield DATA.check(
        "points in a part that is not what the map's texel says of them", float(misjudged), Answer.IDEAL
    )
    size = figure.size // 2
    for on in Answer:
        image, right_pixels, count = renderer.window(on, figure, size), 0, 0
        for k, bias in enumerate((none, right, too_much)):
            for part in parts(bias):
                if part.end - part.start < 0.3 * WIDTH:
                    continue
                # Away from the part's middle, where the steps cross the surface and the bias begins.
                x = part.start + 0.3 * (part.end - part.start)
                j, i = (int((v + 1.0) * 0.5 * size) for v in reversed(_on_surface(x)))
                wanted = RED if part.wrong else YELLOW if part.lit else _SHADOW
                right_pixels += np.abs(image[j, i + k * size] - np.array(wanted)).max() < 0.01
                count += 1
        yield DATA.check(
            "share of the surface's parts drawn in the colour of what the map says", right_pixels / count, on
        )
    yield from drawn_check(figure, renderer, _marks(size, (none, right, too_much)))


# Larger ones move the surface out of the diagram.
_OFFSET_KIND = word.Several(
    (word.Number(0.0, 2.0), word.Number(0.0, 4.0)), what="a factor from 0 to 2 and units from 0 to 4"
)

FIGURE = Figure(
    **DATA.words,
    parameters={
        "right": word.of(
            _OFFSET_KIND, (0.5, 1.0), "The polygon offset of the second panel, factor and units."
        ),
        "too_much": word.of(
            _OFFSET_KIND, (2.0, 4.0), "The polygon offset of the third panel, factor and units."
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
