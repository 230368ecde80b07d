"""F001-4: filtering makes a bump map smooth, and its roughness stores how rough the lost bumps were."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, INK, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F001-4")

LEVELS, TEXELS, EDGE = 5, 32, 256
# A profile's left end and its length; a normal's length.
_LEFT, _LONG, _NORMAL = -0.72, 1.62, 0.17


def white(seed, slope):
    """White bumps: offsets of deviation ``slope``, each texel's its own: float64 [EDGE, EDGE, 2]."""
    x, y = np.meshgrid(np.arange(EDGE), np.arange(EDGE))
    even = np.stack([hashed(x, y, seed + k) / 65536.0 - 0.5 for k in (0, 1)], axis=-1)
    return even * (slope * math.sqrt(12.0))


def profile_of(levels, number):
    """A level's row as a profile: x and height of its corners, float64 [k, 2], in texels of level 0."""
    count = TEXELS >> number
    slopes = -levels[number].offsets[(EDGE >> number) // 2, :count, 0]
    heights = np.concatenate([[0.0], np.cumsum(slopes - slopes.mean())]) * 2.0**number
    return np.stack([np.arange(count + 1) * 2.0**number, heights], axis=-1)


def _rows():
    """The middle of each level's drawing, from above."""
    return 0.70 - 0.36 * np.arange(LEVELS)


def _on_panel(points, number):
    scale = _LONG / TEXELS
    return np.stack([_LEFT + scale * points[:, 0], _rows()[number] + scale * points[:, 1]], axis=-1)


def _normals(levels, number):
    """Where normals stand on a level, their angle from upright and the roughness's half angle, radians."""
    points, count = _on_panel(profile_of(levels, number), number), TEXELS >> number
    step = max(1, count // 8)
    for k in range(step // 2, count, step):
        slope = (points[k + 1, 1] - points[k, 1]) / (points[k + 1, 0] - points[k, 0])
        covariance = levels[number].covariance[(EDGE >> number) // 2, k]
        yield 0.5 * (points[k] + points[k + 1]), -math.atan(slope), math.atan(math.sqrt(covariance[0]))


def scene(profile, size, *, seed, slope, background):
    """F001-4: profiles of five levels, their normals, and the wedge for the roughness of each."""
    (panel,) = row_of_panels(1, size)
    view, levels = drawing.sheet(panel), rough.pyramid(white(seed, slope))
    out = [drawing.load_font(), panel.clear(background)]
    for number in range(LEVELS):
        wedges, arrows = [], []
        for place, lean, half in _normals(levels, number):
            ends = [math.degrees(math.pi / 2.0 - lean + turn) for turn in (-half, half)]
            rim = drawing.arc(place, *ends, u=(_NORMAL, 0.0), v=(0.0, _NORMAL), segments=8)
            wedges.append(np.concatenate([place[None], rim]))
            arrows.append(np.array([place, rim[len(rim) // 2]]))
        # Level 0 has lost nothing: its wedges have no width.
        if number:
            out.append(drawing.polygons(f"roughness of level {number}", view, wedges, YELLOW, alpha=0.45))
        out.append(drawing.strokes(f"normals of level {number}", view, arrows, BLUE, width=1.2))
        points = _on_panel(profile_of(levels, number), number)
        out.append(drawing.stroke(f"profile of level {number}", view, points, INK, width=2.2))
        out.append(drawing.text(str(number), view, (-0.9, _rows()[number]), INK, align=(0, 0)))
    return tuple(out)


def checks(figure, renderer):
    """Variances from level to level, and that profiles lie at the computed places."""
    levels = rough.pyramid(white(figure.values["seed"], figure.values["slope"]))
    variances = [level.offsets.reshape(-1, 2).var(axis=0) for level in levels]
    off = max(float(np.abs(variances[k + 1] / variances[k] * 4.0 - 1.0).max()) for k in range(3))
    yield DATA.check(
        "variance of slopes over four times the next level's, off one, three levels", off, Answer.IDEAL
    )
    kept = [
        float(level.covariance[..., 0].mean() + level.covariance[..., 2].mean() + v.sum())
        for level, v in zip(levels, variances, strict=True)
    ]
    yield DATA.check(
        "mean trace of K + variance of f, largest change over all levels", max(kept) - min(kept), Answer.IDEAL
    )
    view, marks = drawing.sheet(row_of_panels(1, figure.size // 2)[0]), []
    for number in range(LEVELS):
        points = _on_panel(profile_of(levels, number), number)
        marks.append((0, view, 0.5 * (points[0] + points[1]) - (0.0, 0.004), INK))
    yield from drawn_check(figure, renderer, marks)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "seed": word.SEED(3, "Which bumps."),
        "slope": word.of(word.Number(0.0, 2.0), 0.5, "The deviation of their slopes."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
