"""H16: lines of force, plain and illuminated by Banks's table."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.curves import lines_of_force
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.reflectance import banks_texture_matrix as banks
from fixedpipe.effects.reflectance import illuminated_lines

DATA = figure_data(__file__, "H16")

# Point charges: x, y, z, charge. The lines stay within a ball of radius one.
CHARGES = ((-0.44, -0.2, 0.12, 1.0), (0.44, 0.2, -0.12, -1.0))
BALL, HALF_HEIGHT = 1.0, 1.03
# Those of eight bits, whose lines the executable specification draws.
MACHINES = (
    *("OPENGL_1_2", "OPENGL_1_2_IMAGING", "MULTITEXTURE", "GEFORCE_256", "GEFORCE_3"),
    *("NV2A", "OCTANE", "G400", "TEXRAM"),
)
_VIEWER = np.array([0.0, 0.0, 1.0])


def _curves(size, lines, turn):
    """The lines, fewer and of longer pieces where panels are small."""
    count = min(lines, max(12, lines * size // 512))
    step = 0.02 * max(1.0, 256.0 / size)
    return lines_of_force(CHARGES, count, step=min(step, 0.08), radius=BALL).rotated(rotation("y", turn))


def _colors(curves, turn, positive, negative):
    """From one colour at the positive charges to the other at the negative ones, by how near either is."""
    turned = rotation("y", -turn)
    places = np.stack([dot(curves.positions, row) for row in turned], axis=-1)
    nearness = []
    for sign in (1.0, -1.0):
        total = np.zeros(len(places))
        for *place, charge in CHARGES:
            if sign * charge > 0.0:
                away = places - np.array(place)
                total = total + sign * charge / np.sqrt(dot(away, away))
        nearness.append(total)
    share = (nearness[0] / (nearness[0] + nearness[1]))[:, None]
    return share * np.array(positive) + (1.0 - share) * np.array(negative)


def scene(
    profile, size, *, light, exponent, diffuse, specular, positive, negative, lines, width, turn, background
):
    """The lines' colours alone, and times the table."""
    panels = row_of_panels(2, size)
    curves = _curves(size, lines, turn)
    colors = _colors(curves, turn, positive, negative)
    views = [orthographic_view(panel, HALF_HEIGHT) for panel in panels]
    return (
        *(panel.clear(background) for panel in panels),
        banks.load_threads("threads", profile, diffuse=diffuse, specular=specular, exponent=exponent),
        illuminated_lines.line_pass(curves, views[0], color=colors, width=width),
        illuminated_lines.line_pass(
            curves, views[1], light=Light(light), texture="threads", color=colors, width=width
        ),
    )


def _light_of(tangents, light, diffuse, specular, exponent):
    """Banks's light of threads by vectors: the normal nearest to the light, and the cone of mirrored light,
    float64 [n].
    """
    toward = unit_vector(light, "The light's direction")
    across_l = toward - dot(tangents, toward)[:, None] * tangents
    across_v = _VIEWER - dot(tangents, _VIEWER)[:, None] * tangents
    sines = np.sqrt(dot(across_l, across_l)), np.sqrt(dot(across_v, across_v))
    cosine = sines[0] * sines[1] - dot(toward - across_l, _VIEWER - across_v)
    return diffuse * sines[0] + specular * np.maximum(0.0, cosine) ** exponent


def _seen(curves, colors, size, width):
    """Points of the lines that nothing hides, one for a pixel: (row, column, tangent, colour) of each.

    Points that lie ``width`` and a pixel to either side of a nearer one are left out.
    """
    ends = curves.segments
    share = ((np.arange(4) + 0.5) / 4.0)[None, :, None]
    both = [
        (values[ends[:, :1]] * (1.0 - share) + values[ends[:, 1:]] * share).reshape(-1, 3)
        for values in (curves.positions, curves.tangents, colors)
    ]
    # Column and row of the pixel that has the point.
    x, y = (np.floor((both[0][:, k] / HALF_HEIGHT + 1.0) * (0.5 * size)).astype(int) for k in (0, 1))
    order = np.argsort(both[0][:, 2])
    nearest = np.full((size, size), -1)
    nearest[y[order], x[order]] = order
    depth = np.where(nearest >= 0, both[0][nearest, 2], -np.inf)
    reach, front = int(width) + 1, depth.copy()
    for axis in (0, 1):
        front = np.max([np.roll(front, step, axis) for step in range(-reach, reach + 1)], axis=0)
    kept = (nearest >= 0) & (front <= depth + 0.02)
    row, column = np.nonzero(kept)
    point = nearest[row, column]
    return row, column, both[1][point], both[2][point]


_SIZE = 384


def checks(figure, renderer):
    """Pixels of the nearest lines against the model, by the lines' own points."""
    values = figure.values_of(renderer.method)
    curves = _curves(_SIZE, values["lines"], values["turn"])
    colors = _colors(curves, values["turn"], values["positive"], values["negative"])
    row, column, tangents, colors = _seen(curves, colors, _SIZE, values["width"])
    model = {name: values[name] for name in ("light", "diffuse", "specular", "exponent")}
    # Of the chord between two vertices; the unit vector of it, for what is interpolated is shorter.
    lit = _light_of(tangents / np.sqrt(dot(tangents, tangents))[:, None], **model)
    for on, bound, reason in (
        (Answer.IDEAL, 0.012, "linear filtering of the table, and a pixel is drawn at its centre"),
        (Answer.MACHINE, 0.015, "the same, and bytes of the table, of the colour and of their product"),
    ):
        image = renderer.window(on, figure, _SIZE)
        for k, name, expected in ((0, "colour alone", colors), (1, "illuminated", lit[:, None] * colors)):
            error = np.abs(image[row, column + k * _SIZE] - expected).max(axis=-1)
            yield Check(
                f"{name}: error on pixels of the nearest lines, the largest of 9 in 10",
                float(np.quantile(error, 0.9)),
                at_most=bound,
                on=on,
                reason=reason,
            )
        value = image[row, column + _SIZE].max(axis=-1) / image[row, column].max(axis=-1)
        yield DATA.check(
            "brightest over darkest light of these pixels, 95 of 100 between",
            float(np.quantile(value, 0.975) / np.quantile(value, 0.025)),
            on,
        )
    yield DATA.check("pixels that those errors are of, over the panel's", len(row) / _SIZE**2, Answer.IDEAL)


FIGURE = Figure(
    **DATA.words,
    size=768,
    parameters={
        "light": word.LIGHT((-0.3, 0.75, 0.6)),
        "exponent": word.NUMBER(
            24.0, "The exponent 1/r: the larger, the narrower the highlights.", low=1.0, high=128.0
        ),
        "diffuse": word.SHARE(0.4, "The share of light that is scattered, k_d."),
        "specular": word.SHARE(0.6, "The highlights' strength, k_s."),
        "positive": word.COLOR((1.0, 0.72, 0.36), "The lines' colour at positive charges."),
        "negative": word.COLOR((0.45, 0.72, 1.0), "The lines' colour at negative charges."),
        "lines": word.of(word.Whole(12, 2000), 520, "How many lines there are in panels of 512 pixels."),
        "width": word.of(word.Number(1.0, 16.0), 2.0, "The lines' width.", "pixels"),
        "turn": word.DEGREES(0.0, "How far the charges are turned about the upright axis."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("lines and the texture matrix", scene, MACHINES),),
    acceptance=checks,
)
