"""F003-3: a displacement map as a height field, its central differences, and their error."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import normal_maps
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, GREEN, INK, RED, VIOLET, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.state import PassState

DATA = figure_data(__file__, "F003-3")

# The drawn displacement map: samples along both edges, and the one whose normal is derived (column, row).
SAMPLES, CHOSEN = 8, (3, 5)
# Samples along both edges whose errors are compared; each is half as far apart as the one before.
FINER = (16, 32, 64, 128, 256)
TURN = 2.0 * math.pi


def displacement(u, v, sin=sine, cos=cosine):
    """The height d(u, v), periodic in the unit square."""
    return 0.10 * sin(TURN * u) * cos(TURN * v) + 0.035 * sin(2.0 * TURN * u + 1.0)


def slopes(u, v, sin=sine, cos=cosine):
    """Its derivatives (d_u, d_v)."""
    return (
        TURN * (0.10 * cos(TURN * u) * cos(TURN * v) + 0.07 * cos(2.0 * TURN * u + 1.0)),
        -TURN * 0.10 * sin(TURN * u) * sin(TURN * v),
    )


def _grid(samples):
    place = np.arange(samples) / samples
    return np.meshgrid(place, place)


def largest_errors():
    """The largest error of central differences on each of ``FINER``'s grids: float64 [5]."""
    out = []
    for samples in FINER:
        u, v = _grid(samples)
        found = normal_maps.differences(displacement(u, v, np.sin, np.cos), 1.0 / samples, 1.0 / samples)
        true = slopes(u, v, np.sin, np.cos)
        out.append(max(float(np.abs(a - b).max()) for a, b in zip(found, true, strict=True)))
    return np.array(out)


# ------------------------------------------------------------------------------------ the three panels


def _views(size):
    plot, cut, errors = row_of_panels(3, size)
    return (
        perspective_view(plot, (1.35, 1.25, 2.3), center=(0.5, -0.02, 0.46), field_of_view=36.0, radius=2.0),
        drawing.sheet(cut, half_height=0.42, center=(0.48, 0.0)),
        drawing.sheet(errors, half_height=6.7, center=(-12.7, -8.2)),
    )


def _point(u, v, height):
    """The scene's point over (u, v): heights go up, v away from the viewer."""
    return np.stack([u, height, 1.0 - np.asarray(v)], axis=-1)


def _chosen():
    """(u, v), the five samples' heights (here, after and before along u, after and before along v), and n."""
    i, j = CHOSEN
    u, v = i / SAMPLES, j / SAMPLES
    heights = displacement(*_grid(SAMPLES))
    found = normal_maps.height_first_normals(heights, 1.0 / SAMPLES, 1.0 / SAMPLES)[j, i]
    around = heights[j, i], heights[j, i + 1], heights[j, i - 1], heights[j + 1, i], heights[j - 1, i]
    return u, v, around, found


def _normals_tip(length):
    """The foot and the tip of the normal in the scene: components are height, u, v."""
    u, v, around, n = _chosen()
    foot = _point(u, v, around[0])
    return foot, foot + length * np.array([n[1], n[0], -n[2]])


def _facets(view, corners, colors):
    """Quads of corners [4 n, 3], each of its own colour, in their order."""
    mesh = Mesh(corners, PrimitiveType.QUADS, colors=colors)
    state = PassState(vertex=view.vertex)
    return Draw(label="the displacement map", mesh=mesh, state=state)


def _plot(view):
    """The height field as shaded facets with the samples round the chosen one."""
    fine = 2 * SAMPLES
    place = np.arange(fine + 1) / fine
    u, v = np.meshgrid(place, place)
    points = _point(u, v, displacement(u, v))
    d_u, d_v = slopes(u, v)
    lit = normalize(np.stack([-d_u, np.ones_like(d_u), d_v], axis=-1))
    shade = np.maximum((lit * normalize(np.array([-0.6, 0.55, 0.2]))).sum(axis=-1), 0.0)
    out = []
    for row in range(fine - 1, -1, -1):  # from far to near
        for k in range(fine):
            corners = [(row + 1, k), (row, k), (row, k + 1), (row + 1, k + 1)]
            out.append(([points[c] for c in corners], [float(shade[c]) for c in corners]))
    quads = np.array([corners for corners, _ in out])
    shades = np.array([s for _, s in out]).reshape(-1, 1)
    colors = np.array((0.10, 0.13, 0.20)) + np.array((0.30, 0.42, 0.62)) * shades
    facets = _facets(view, quads.reshape(-1, 3), colors)
    step = 1.0 / SAMPLES
    u, v, (here, right, left, far, near), _ = _chosen()
    along_u = np.array([_point(u - step, v, left), _point(u, v, here), _point(u + step, v, right)])
    along_v = np.array([_point(u, v - step, near), _point(u, v, here), _point(u, v + step, far)])
    lines = [
        np.stack([_point(t, s, displacement(t, s)) for t in np.arange(33) / 32.0]) for s in (0.0, v, 1.0)
    ]
    lines += [
        np.stack([_point(s, t, displacement(s, t)) for t in np.arange(33) / 32.0]) for s in (0.0, u, 1.0)
    ]
    foot, tip = _normals_tip(0.34)
    return [
        facets,
        drawing.strokes("d along u and v", view, lines, FAINT, width=0.8),
        drawing.arrow("difference along u", view, along_u[[0, 2]], RED, width=2.0),
        drawing.arrow("difference along v", view, along_v[[0, 2]], GREEN, width=2.0),
        drawing.arrow("n", view, (foot, tip), YELLOW, width=2.0),
        drawing.dots("samples", view, np.concatenate([along_u[[0, 2]], along_v[[0, 2]]]), INK, radius=2.0),
        drawing.text("n", view, tip, YELLOW, align=(0, -1), offset=(0.0, 4.0)),
        drawing.arrow("u axis", view, [_point(s, -0.07, -0.15) for s in (0.1, 0.8)], RED),
        drawing.text("u", view, _point(0.8, -0.07, -0.15), RED, align=(0, 1), offset=(0.0, -5.0)),
        drawing.arrow("v axis", view, [_point(1.1, t, -0.1) for t in (0.1, 0.7)], GREEN),
        drawing.text("v", view, _point(1.1, 0.7, -0.1), GREEN, align=(-1, 0), offset=(5.0, 0.0)),
        drawing.text("d(u, v)", drawing.sheet(view.panel), (0.0, 0.92), INK),
    ]


def _cut(view):
    """The cut through the chosen sample along u: samples, chord, the chord moved to the sample, normal."""
    step = 1.0 / SAMPLES
    u, v, (here, right, left, _, _), _ = _chosen()
    drawn = np.array([(t, displacement(t, v)) for t in 0.12 + 0.76 * np.arange(97) / 96.0])
    samples = np.array([(k * step, displacement(k * step, v)) for k in range(1, SAMPLES)])
    chord = np.array([(u - step, left), (u + step, right)])
    slope = (right - left) / (2.0 * step)
    foot = np.array([u, here])
    reach = 0.24 / math.sqrt(1.0 + slope * slope)
    tip = foot + reach * np.array([-slope, 1.0])
    tangent = np.array([foot - 0.17 * np.array([1.0, slope]), foot + 0.17 * np.array([1.0, slope])])
    base = -0.19
    feet = [np.array([sample, (sample[0], base)]) for sample in samples]
    return [
        drawing.strokes("where samples are", view, feet, FAINT, width=0.8),
        drawing.stroke("the u axis", view, ((0.1, base), (0.9, base)), FAINT),
        drawing.stroke("d(u, v)", view, drawn, BLUE, width=1.8),
        drawing.stroke("the chord", view, chord, RED, width=1.8),
        drawing.stroke("the same slope here", view, tangent, RED, dash=drawing.DASH),
        drawing.arrow("the normal", view, (foot, tip), YELLOW, width=2.0),
        drawing.dots("samples", view, samples, INK, radius=2.5),
        drawing.text("u-du", view, (u - step, base), INK, align=(0, 1), offset=(0.0, -5.0)),
        drawing.text("u", view, (u, base), INK, align=(0, 1), offset=(0.0, -5.0)),
        drawing.text("u+du", view, (u + step, base), INK, align=(0, 1), offset=(0.0, -5.0)),
        drawing.text("n = (1, -d_u)", view, tip, YELLOW, align=(0, -1), offset=(0.0, 5.0)),
        drawing.text("d_u = (d(u+du) - d(u-du)) / 2 du", view, (0.5, -0.29), RED),
        drawing.text("central differences", drawing.sheet(view.panel), (0.0, 0.92), INK),
    ]


def _plotted():
    """Where the errors are plotted: twice the log2 of the grids' steps, so that slope two is a diagonal, and
    that of the errors, float64 [5, 2].
    """
    errors = np.floor(np.log2(largest_errors()) * 2.0**16 + 0.5) / 2.0**16
    steps = [-2.0 * (samples.bit_length() - 1) for samples in FINER]
    return np.stack([steps, errors], axis=-1)


def _error_plot(view):
    """The error over the samples' distance, both logarithmic, and a line of slope two."""
    places = _plotted()
    ratios = np.exp2(places[:-1, 1] - places[1:, 1])
    corner = places[-1] - (1.0, 1.4)
    right, top = (corner + np.array(step) for step in ((10.0, 0.0), (0.0, 10.6)))
    diagonal = np.array([places[-1] - 0.8, places[-1] + 9.0])
    out = [
        drawing.arrow("log du", view, (corner, right), FAINT),
        drawing.arrow("log error", view, (corner, top), FAINT),
        drawing.stroke("slope 2", view, diagonal, VIOLET, dash=drawing.DASH),
        drawing.stroke("largest errors", view, places, YELLOW, width=1.5),
        drawing.dots("errors", view, places, YELLOW),
        drawing.text("slope 2", view, places[1], VIOLET, align=(1, -1), offset=(-8.0, 4.0)),
    ]
    for k, ratio in enumerate(ratios):
        middle = 0.5 * (places[k] + places[k + 1])
        out.append(drawing.text(f"÷ {ratio:.2f}", view, middle, INK, align=(-1, 1), offset=(6.0, 0.0)))
    meant = "error's fall\nper halving"
    out.append(drawing.text(meant, view, right, INK, align=(1, -1), offset=(0.0, 26.0)))
    for samples, place in zip(FINER, places, strict=True):
        mark = (place[0], corner[1])
        out.append(drawing.text(f"1/{samples}", view, mark, FAINT, align=(0, 1), offset=(0.0, -5.0)))
    for power in range(-12, -3, 2):
        mark = (corner[0], float(power))
        out.append(drawing.stroke("tick", view, (mark, (mark[0] - 0.25, mark[1])), FAINT))
        out.append(drawing.text(f"2^{power}", view, mark, FAINT, align=(1, 0), offset=(-5.0, 0.0)))
    title = drawing.text("largest error of d_u, d_v", drawing.sheet(view.panel), (0.0, 0.92), INK)
    return [*out, drawing.text("du", view, right, FAINT, align=(1, -1), offset=(0.0, 6.0)), title]


def scene(profile, size, *, background):
    """F003-3: the plot, the cut and the errors, all of the same displacement map."""
    out = [drawing.load_font()]
    for view, content in zip(_views(size), (_plot, _cut, _error_plot), strict=True):
        out += (view.panel.clear(background), *content(view))
    return tuple(out)


def _dashes_check(figure, renderer):
    """How much of the line through the sample with the chord's slope is red, beside the sample's dot."""
    u, _, (here, right, left, _, _), _ = _chosen()
    slope, size = (right - left) * SAMPLES / 2.0, figure.size
    along = np.concatenate([np.linspace(-0.16, -0.05, 45), np.linspace(0.05, 0.16, 45)])
    places = np.stack([u + along, here + slope * along], axis=-1)
    columns, rows = np.floor(drawing.project(_views(size)[1], places)[:, :2]).astype(int).T
    for on in Answer:
        picture = panel_of(renderer.window(on, figure, size), 1)
        red = np.abs(picture - np.array(RED)).max(axis=-1) <= 1.0 / 255.0
        found = [red[y - 1 : y + 2, x - 1 : x + 2].any() for x, y in zip(columns, rows, strict=True)]
        yield DATA.check(
            "places on the line through the sample with the chord's slope that are red",
            float(np.mean(found)),
            on,
        )


def checks(figure, renderer):
    """How the error falls, and that the drawn normals and errors are the computed ones."""
    errors = largest_errors()
    ratios = errors[:-1] / errors[1:]
    plot, cut, graph = _views(figure.size // 2)
    foot, tip = _normals_tip(0.34)
    u, v, _, n = _chosen()
    marks = [(0, plot, 0.5 * (foot + tip), YELLOW)]
    # Along the differences a fifth from their starts, and on the cut half of the normal, by its components.
    step, (_, right, left, far, near) = 1.0 / SAMPLES, _chosen()[2]
    differences = (
        (_point(u - step, v, left), _point(u + step, v, right), RED),
        (_point(u, v - step, near), _point(u, v + step, far), GREEN),
    )
    marks += [(0, plot, start + 0.2 * (end - start), color) for start, end, color in differences]
    across = np.array([n[1], n[0]]) / math.hypot(n[1], n[0])
    marks.append((1, cut, np.array([u, displacement(u, v)]) + 0.12 * across, YELLOW))
    lean = max(abs(float(((tip - foot) * (end - start)).sum())) for start, end, _ in differences)
    marks += [(1, cut, (u + k / SAMPLES, displacement(u + k / SAMPLES, v)), INK) for k in (-1, 1)]
    marks += [(2, graph, place, YELLOW) for place in _plotted()]
    analytic = np.array([1.0, *(-float(s) for s in slopes(u, v))])
    return (
        DATA.check(
            "error ratio when du halves, largest - 4", float(np.abs(ratios - 4.0).max()), Answer.IDEAL
        ),
        DATA.check("error ratio on the finest grids - 4", abs(float(ratios[-1]) - 4.0), Answer.IDEAL),
        DATA.check(
            "the drawn normal's cosine to the analytic one",
            float((n * normalize(analytic)).sum()),
            Answer.IDEAL,
        ),
        DATA.check("the drawn normal times the drawn differences, largest", lean, Answer.IDEAL),
        *drawn_check(figure, renderer, marks),
        *_dashes_check(figure, renderer),
    )


FIGURE = Figure(
    **DATA.words,
    size=512,
    parameters={
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
