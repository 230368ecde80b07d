"""G27: pictures of a wall of bricks from several sides and lights, their windows' means, and its BRDF."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import arithmetic_check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared.stills import as_computed, cells, mosaic, still
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels
from fixedpipe.effects.scattering import btf, made_fields, visibility
from fixedpipe.effects.scattering.directions import spiral

DATA = figure_data(__file__, "G27")

PANELS = ("pictures kept (BTF)", "BRDFs of windows", "one BRDF")
# Lights down a panel, views across it; degrees from the zenith, to the right and to the left.
TILTS = (-60.0, -20.0, 20.0, 60.0)
TEXELS = 64


def directions():
    """The lights and the views: float64 [4, 3], tilted from left to right."""
    angle = np.radians(np.array(TILTS))
    return normalize(np.stack([sine(angle), 0.25 + 0.0 * angle, cosine(angle)], axis=-1))


@lru_cache(maxsize=4)
def simulated(depth, bounces, count):
    """The BTF of a wall of bricks whose joints are so deep."""
    field = made_fields.bricks(TEXELS, TEXELS, depth)
    seen = visibility.precompute(field, spiral(count))
    return btf.simulated(field, seen, directions(), directions(), size=TEXELS, bounces=bounces)


def _shown(depth, bounces, directions, windows, intensity):
    """Each panel's pictures, lights by views: three float64 [4, 4, n, n, 3]."""
    kept = simulated(depth, bounces, directions)
    n, m = kept.pictures.shape[:2]
    pictures = np.stack([np.stack([kept.radiance(i, j) for j in range(m)]) for i in range(n)])
    facing = np.pi * kept.irradiance[:, None, None, None, None]
    shown = (pictures, kept.windows(windows) * facing, kept.windows(1) * facing)
    return tuple(np.clip(intensity * light, 0.0, 1.0) for light in shown)


def scene(profile, size, **values):
    """G27: three mosaics of lights and views."""
    out = []
    for panel, name, light in zip(row_of_panels(3, size), PANELS, _shown(**values), strict=True):
        picture = mosaic(light, size)
        out += (panel.clear(BACKGROUND), *still(picture, panel, name, profile))
    return tuple(out)


def checks(figure, renderer):
    """Means stay and contrast goes, picture by picture."""
    for on in Answer:
        shown = renderer.window(on, figure, figure.size)
        yield DATA.check(
            "pixels that are shown as they were computed, within 2/255, the least of the panels",
            min(as_computed(panel_of(shown, k), one) for k, one in enumerate(_shown(**figure.values))),
            on,
        )
    size, n = figure.size // 2, len(TILTS)
    window = renderer.window(Answer.IDEAL, figure, size)
    parts = [cells(panel_of(window, k), n) for k in range(3)]
    means = [part.mean(axis=(2, 3)) for part in parts]
    for k, name in ((0, "the pictures"), (1, "the windows")):
        yield DATA.check(
            "the means of {name} differ from the BRDF by a share of",
            float(np.abs(means[k] / means[2] - 1.0).max()),
            Answer.IDEAL,
            name=name,
        )
    spread = [part.reshape(n * n, -1, 3).std(axis=1).mean() for part in parts]
    yield DATA.check(
        "contrast of windows by that of the pictures", float(spread[1] / spread[0]), Answer.IDEAL
    )
    yield DATA.check(
        "contrast of windows by that of the pictures, at least", float(spread[1] / spread[0]), Answer.IDEAL
    )
    yield DATA.check("contrast within one BRDF", float(spread[2]), Answer.IDEAL)
    # Light from a side is sent back to it: the far side sees the shadows.
    towards, away = means[2][0, 0].mean(), means[2][0, 3].mean()
    yield DATA.check("seen from the light's side by seen from the other", float(towards / away), Answer.IDEAL)
    yield arithmetic_check(figure, renderer, 0.01, "bytes of a texture")


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    size=512,
    parameters={
        "depth": word.NUMBER(0.05, "The joints' depth.", "edges of the wall", low=0.001, high=0.5),
        "bounces": word.of(word.Whole(0, 16), 2, "Reflections beyond the first."),
        "directions": word.of(word.Whole(20, 1000), 100, "Directions along which light is gathered."),
        "windows": word.of(word.Whole(1, TEXELS, power=True), 4, "Windows along an edge of the wall."),
        "intensity": word.NUMBER(
            1.5, "The light's, 1 = a white surface that faces it is full.", high=8.0, low=0.0
        ),
    },
    methods=(Method("pictures by rays, shown as textures", scene, ("OPENGL_1_2", "GEFORCE_256")),),
    acceptance=checks,
)
