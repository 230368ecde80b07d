"""S21: the highlight of a plate that is brushed aslant, as printed, corrected, by the inverse, and by all its
bumps.
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import principal_axis, root_mean_square
from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import BLUE, INK
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.reflectance import rough_highlight_passes as passes
from fixedpipe.effects.reflectance import rough_highlights as shine
from fixedpipe.effects.reflectance.rough_highlights import Form

DATA = figure_data(__file__, "S21")

ALL = "all bumps"
PANELS = (*(form.value for form in Form), ALL)
# Bumps whose mean is the last panel, and the lobe that each has.
_BUMPS, _LOBE = 512, 0.05
_HEIGHT, _EDGE = 0.75, 0.96


@lru_cache(8)
def bumps(long, short, direction):
    """Offsets of a brushed plate's texels: float64 [_BUMPS, 2], with mean zero, and K with the lobe's.

    Sums of four hashed numbers are nearly normally distributed. Taking them at equal steps of their order
    leaves no gaps. Each offset's opposite is included.
    """
    half = _BUMPS // 2
    x = np.arange(256 * half)
    # A hashed number is evenly spread over one, of variance 1/12.
    one, other = (
        sum((height_fields.hashed(x, k, seed) + 0.5) / 65536.0 - 0.5 for k in range(4)) * np.sqrt(3.0)
        for seed in (5, 9)
    )
    one, other = np.sort(one)[128::256], other[:half]
    radians = np.radians(direction)
    c, s = float(cosine(radians)), float(sine(radians))
    offsets = np.stack([long * c * one - short * s * other, long * s * one + short * c * other], axis=-1)
    offsets = np.concatenate([offsets, -offsets])
    levels = rough.pyramid(offsets[None], (_LOBE * _LOBE, 0.0, _LOBE * _LOBE))
    return offsets, levels[-1].covariance[0, 0]


def _function(panel, offsets, k):
    """A panel's highlight as a function of d [..., 2]."""
    if panel != ALL:
        return lambda d: shine.brightness(shine.squared_cosine(d, k, Form(panel)))

    def mean(d):
        up = np.sqrt(1.0 - (d[..., 0] * d[..., 0] + d[..., 1] * d[..., 1]))
        half, total = np.concatenate([d, up[..., None]], axis=-1), 0.0
        lobe = np.array([_LOBE * _LOBE, 0.0, _LOBE * _LOBE])
        for offset in offsets:
            apart = shine.apart(half, np.eye(3), offset)
            total = total + shine.brightness(shine.squared_cosine(apart, lobe))
        # As bright at d = 0 as the others: what the figure compares is where light goes.
        factor = shine.energy(lobe) / shine.energy(k)
        return total * (factor / len(offsets))

    return mean


@lru_cache(8)
def _values(panel, texels, long, short, direction):
    """A panel's table before colours: float64 [texels, texels]."""
    return _function(panel, *bumps(long, short, direction))(passes.table_places(texels))


def _view(panel):
    return orthographic_view(panel)


def _ellipse(k):
    """K's ellipse of one deviation, on the plate: where h leans so far, seen from above."""
    long, short, axis = rough.principal(k)
    across = np.stack([-axis[..., 1], axis[..., 0]])
    slopes = drawing.arc((0.0, 0.0), 0.0, 360.0, long * axis, short * across, 96)
    # h leans half of what the lamp's ray does: tan of twice the angle, and the lamp's height.
    tangent = np.sqrt(slopes[:, 0] * slopes[:, 0] + slopes[:, 1] * slopes[:, 1])[:, None]
    return -2.0 * _HEIGHT / (1.0 - tangent * tangent) * slopes


def scene(profile, size, *, long, short, direction, color, background):
    """S21: the plate under a lamp, and K's ellipse over it."""
    texels, cells = max(32, min(256, size // 2)), max(8, min(48, size // 8))
    plate, light = plane(cells, cells, _EDGE, _EDGE), Light((0.0, 0.0, _HEIGHT), point=True)
    outline, out = _ellipse(bumps(long, short, direction)[1]), [drawing.load_font()]
    for name, panel in zip(PANELS, row_of_panels(4, size), strict=True):
        view = _view(panel)
        values = _values(name, texels, long, short, direction)
        out += [
            passes.load_table(values[..., None] * np.array(color), name, profile),
            panel.clear(background),
        ]
        out += passes.table_pass(plate, name, view, light)
        out.append(drawing.stroke("K's ellipse", view, outline, BLUE, width=1.4, dash=drawing.DASH))
        out.append(drawing.text(name, view, (-0.9, 0.86), INK, align=(-1, 0)))
    return tuple(out)


def _bright(values):
    """A table's part of more than half of its peak, as what ``principal_axis`` takes."""
    return np.where(values > 0.5 * values.max(), values, 0.0)


def _between(a, b):
    """The angle between two axes, degrees from 0 to 90."""
    return abs((a - b + 90.0) % 180.0 - 90.0)


def checks(figure, renderer):
    """Axes by second moments of tables and of the picture, against K's own; RMS from all bumps."""
    p = {name: figure.values[name] for name in ("long", "short", "direction")}
    k = bumps(**p)[1]
    *_, axis = rough.principal(k)
    right = np.degrees(np.arctan2(axis[1], axis[0]))
    *_, axis = rough.principal(shine.printed_covariance(k))
    expected = _between(np.degrees(np.arctan2(axis[1], axis[0])), right)
    size, black = figure.size, {"background": (0.0, 0.0, 0.0), "color": (1.0, 1.0, 1.0)}
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size, **black), 0.0, 1.0)
        images = {}
        for number, name in enumerate(PANELS):
            image = panel_of(window, number)
            # Neither the ellipse nor letters, which have colours.
            grey = image.max(axis=-1) - image.min(axis=-1) < 0.02
            images[name] = np.where(grey, image[..., 0], 0.0)
            images[name][int(0.88 * size) :] = 0.0
        turned = {n: _between(principal_axis(_bright(image))[0], right) for n, image in images.items()}
        yield DATA.check(
            "the printed highlight's axis, degrees from K's, off the angle of D^T D's",
            abs(turned[Form.PRINTED.value] - expected),
            on,
        )
        for name in PANELS[1:]:
            yield DATA.check("{name}: the highlight's axis, degrees from K's", turned[name], on, name=name)
    tables = {name: _values(name, 64, **p) for name in PANELS}
    error = {n: root_mean_square(tables[n] - tables[ALL]) for n in PANELS[:3]}
    yield DATA.check(
        "inverse: RMS from all bumps over the printed form's",
        error["inverse"] / error["printed"],
        Answer.IDEAL,
    )


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "long": word.of(word.Number(0.1, 0.6), 0.4, "The deviation of slopes across the scratches."),
        "short": word.of(word.Number(0.0, 0.6), 0.02, "That along them."),
        "direction": word.DEGREES(20.0, "The direction of the steep slopes, from the right."),
        "color": word.SPECULAR((1.0, 0.86, 0.62)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("a table of two numbers", scene, ("OPENGL_1_2", "TEXRAM", "GEFORCE_3", "NV2A")),),
    acceptance=checks,
)
