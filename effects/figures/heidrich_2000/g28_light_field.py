"""G28: a light field of 32 x 32 pictures with scattered light, and a picture from between its eyes."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import arithmetic_check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared.stills import as_computed, cells, enlarged, mosaic, still
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels
from fixedpipe.effects.scattering import goniometer, light_field, made_fields, visibility
from fixedpipe.effects.scattering.directions import spiral

DATA = figure_data(__file__, "G28")

# Of the rows and columns of eyes those whose pictures are shown.
SHOWN = (0, 10, 21, 31)
PANELS = ("16 of 32 x 32 pictures", "from between four eyes", "the same by rays")
EYES, PIXELS, TEXELS = 32, 64, 64
# Of the square of eyes, in edges of the field: half its edge, and its height.
SPREAD, DISTANCE = 0.75, 1.0


@lru_cache(maxsize=2)
def _sent(light, depth, bounces, directions):
    field = made_fields.gravel(TEXELS, TEXELS, 4, depth)
    seen = visibility.precompute(field, spiral(directions))
    towards = goniometer.upper(np.array([light]), "The light's direction")
    return field, goniometer.lights(field, seen, towards, bounces)[0]


@lru_cache(maxsize=2)
def _light_field(pixels, *values):
    return light_field.simulated(*_sent(*values), EYES, pixels, spread=SPREAD, distance=DISTANCE)


def _shown(size, light, depth, bounces, directions, eye, intensity):
    """The pictures of 4 by 4 eyes, the one from between, and the same by rays: float64 [n, n, pixels, pixels,
    3] each.
    """
    values = light, depth, bounces, directions
    pixels = min(PIXELS, size)
    kept = _light_field(pixels, *values)
    field, sent = _sent(*values)
    some = kept.pictures[list(SHOWN)][:, list(SHOWN)]
    s, t = 0.5 + kept.spread * eye[0], 0.5 + kept.spread * eye[1]
    truth = sent.reshape(-1, 3)[light_field.seen_from(field, (s, t, kept.distance), pixels)]
    shown = some, kept.at(s, t)[None, None], truth[None, None]
    return tuple(np.clip(intensity * one, 0.0, 1.0) for one in shown)


def scene(profile, size, **values):
    """G28: all pictures, one from between them, and one by rays from the same place."""
    some, *single = _shown(size, **values)
    shown = mosaic(some, size), *(enlarged(one[0, 0], size) for one in single)
    out = []
    for panel, name, picture in zip(row_of_panels(3, size), PANELS, shown, strict=True):
        out += (panel.clear(BACKGROUND), *still(picture, panel, name, profile))
    return tuple(out)


def checks(figure, renderer):
    """The picture from between against rays, and against another eye's."""
    for on in Answer:
        shown = renderer.window(on, figure, figure.size)
        some, *single = _shown(figure.size, **figure.values)
        found = [as_computed(panel_of(shown, 0), some)]
        found += [
            seen_places.alike(panel_of(shown, k), seen_places.still(one[0, 0], figure.size), 2.0 / 255.0)
            for k, one in enumerate(single, 1)
        ]
        yield DATA.check(
            "pixels that are shown as they were computed, within 2/255, the least of the panels",
            min(found),
            on,
        )
    size = figure.size // 2
    window = renderer.window(Answer.IDEAL, figure, size)
    between, truth = (panel_of(window, k) for k in (1, 2))
    other = panel_of(renderer.window(Answer.IDEAL, figure, size, eye=(-0.9, 0.8)), 2)
    corners = cells(panel_of(window, 0), len(SHOWN))
    error = np.abs(between - truth).mean() / truth.mean()
    yield DATA.check(
        "a picture from between four eyes and rays differ, a share of the mean", float(error), Answer.IDEAL
    )
    yield DATA.check(
        "the difference by that of the picture of a far eye",
        float(np.abs(between - truth).mean() / np.abs(other - truth).mean()),
        Answer.IDEAL,
    )
    yield DATA.check(
        "pictures of the eyes at two ends of a row differ, a share of the mean",
        float(np.abs(corners[1, 0] - corners[1, 3]).mean() / corners[1].mean()),
        Answer.IDEAL,
    )
    yield DATA.check(
        "mean of the pictures from the left by that from the right",
        float(corners[:, 0].mean() / corners[:, 3].mean()),
        Answer.IDEAL,
    )
    yield arithmetic_check(figure, renderer, 0.01, "bytes of a texture")


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    size=512,
    parameters={
        "light": word.of(
            word.DIRECTION_KIND,
            (-0.7, 0.3, 0.65),
            "The direction to the light: right, up in the panel, out of it.",
        ),
        "depth": word.NUMBER(1.2, "How high the stones are, 1 = half balls.", low=0.05, high=2.0),
        "bounces": word.of(word.Whole(0, 16), 3, "Reflections beyond the first."),
        "directions": word.of(word.Whole(20, 1000), 100, "Directions along which light is gathered."),
        "eye": word.of(
            word.Several((word.Number(-1.0, 1.0),) * 2, what="two numbers from -1 to 1"),
            (0.45, -0.38),
            "Where the picture from between is seen from: right and up in the eyes' square.",
        ),
        "intensity": word.NUMBER(
            1.2, "The light's, 1 = a white surface that faces it is full.", high=8.0, low=0.0
        ),
    },
    methods=(Method("pictures by rays, shown as textures", scene, ("OPENGL_1_2", "GEFORCE_256")),),
    acceptance=checks,
)
