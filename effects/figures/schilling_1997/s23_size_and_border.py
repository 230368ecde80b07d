"""S23: what sizes a highlight and what shapes its border: roughness, the exponent, or a table."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.surfaces import sphere
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.reflectance import rough_highlight_passes as passes
from fixedpipe.effects.reflectance import rough_highlights as shine

DATA = figure_data(__file__, "S23")

EXPONENTS = (2, 4, 8)
PANELS = (*(f"m = {exponent}" for exponent in EXPONENTS), "a table")
# Four balls in a panel: where, and how large. Their roughness grows row by row.
_PLACES, _RADIUS = ((-0.5, 0.5), (0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)), 0.44
# The table: all light within a', none beyond it but for a rim between. Cosines squared.
_RIM = 0.45, 0.55


def border(squared):
    """The table's function of cos^2 a': a disc with a short rim."""
    x = np.clip((np.asarray(squared, np.float64) - _RIM[0]) / (_RIM[1] - _RIM[0]), 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _highlight(panel, d, deviation):
    """A panel's highlight at d [..., 2]: float64 [...]."""
    squared = shine.squared_cosine_isotropic(d, deviation)
    if panel == PANELS[-1]:
        return shine.looked_up(shine.table(border), squared)
    return shine.brightness(squared, EXPONENTS[PANELS.index(panel)])


def _colors(panel, texels, deviation, base, specular):
    """A ball's colours over d: what it has without a lamp, darker to its rim, and the highlight."""
    d = passes.table_places(texels)
    facing = np.sqrt(1.0 - (d[..., 0] * d[..., 0] + d[..., 1] * d[..., 1]))[..., None]
    return np.asarray(base) * facing + _highlight(panel, d, deviation)[..., None] * np.asarray(specular)


def scene(profile, size, *, roughness, light, base, specular, background):
    """S23: four balls in each panel, rougher ones below."""
    cells, texels = max(12, min(64, size // 8)), max(64, min(256, size // 2))
    out, lamp = [], Light(light)
    for name, panel in zip(PANELS, row_of_panels(4, size), strict=True):
        view = orthographic_view(panel)
        out.append(panel.clear(background))
        for deviation, (x, y) in zip(roughness, _PLACES, strict=True):
            label = f"{name}, I_1 = {deviation:g}"
            ball = sphere(2 * cells, cells).scaled(_RADIUS).moved(x, y, 0.0)
            out.append(passes.load_table(_colors(name, texels, deviation, base, specular), label, profile))
            out += passes.table_pass(ball, label, view, lamp)
    return tuple(out)


def _angles(size, half, place):
    """The angle a at a panel's pixels on a ball, degrees, and where they are: float64, bool [size, size]."""
    edge = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    x, y = np.meshgrid((edge - place[0]) / _RADIUS, (edge - place[1]) / _RADIUS)
    on = x * x + y * y < 0.9
    normals = np.stack([x, y, np.sqrt(np.where(on, 1.0 - x * x - y * y, 0.0))], axis=-1)
    return np.degrees(np.arccos(np.clip(dot(normals, half), -1.0, 1.0))), on


def checks(figure, renderer):
    """Where half of each highlight is left, against its formula; and where the table's ends."""
    size, p = figure.size, figure.values
    half = normalize(normalize(np.array(p["light"])) + np.array([0.0, 0.0, 1.0]))
    plain = {"base": (0.0, 0.0, 0.0), "specular": (1.0, 1.0, 1.0), "background": (0.0, 0.0, 0.0)}
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size, **plain), 0.0, 1.0)
        worst, rim = 0.0, 0.0
        for number, name in enumerate(PANELS):
            image = panel_of(window, number)[..., 0]
            for deviation, place in zip(p["roughness"], _PLACES, strict=True):
                angle, ball = _angles(size, half, place)
                square = 0.5 if name == PANELS[-1] else 0.5 ** (2.0 / EXPONENTS[number])
                expected = np.degrees(np.arctan(deviation * np.sqrt(1.0 / square - 1.0)))
                bright = ball & (image >= 0.5)
                # A disc on the ball: where as many pixels within the angle are dark as beyond it bright.
                within = np.sort(angle[ball])[min(int(bright.sum()), int(ball.sum()) - 1)]
                worst = max(worst, abs(float(within) - float(expected)))
                if name == PANELS[-1]:
                    least = np.degrees(np.arctan(deviation * np.sqrt(1.0 / _RIM[0] - 1.0)))
                    rim = max(rim, float(image[ball & (angle > least + 2.0)].max(initial=0.0)))
        yield DATA.check(
            "where half of a highlight is left, off tan a = I_1 sqrt(2^(2/m) - 1), degrees", worst, on
        )
        yield DATA.check("the table: light two degrees beyond its rim", rim, on)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "roughness": word.of(
            word.Several((word.Number(0.02, 2.0),) * 4, what="four numbers from 0.02 to 2"),
            (0.06, 0.15, 0.3, 0.6),
            "I_1 of the four balls, in units of slope.",
        ),
        "light": word.LIGHT((-0.5, 0.6, 1.0)),
        "base": word.AMBIENT((0.34, 0.09, 0.08)),
        "specular": word.SPECULAR((0.66, 0.85, 0.8)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("a table of two numbers", scene, ("OPENGL_1_2", "TEXRAM", "GEFORCE_3", "NV2A")),),
    acceptance=checks,
)
