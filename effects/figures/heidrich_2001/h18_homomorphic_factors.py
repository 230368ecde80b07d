"""H18: brushed copper by homomorphic factors, its passes one by one."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure
from fixedpipe.effects.figures.heidrich_2001.shared import factored_teapot as the
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, row_of_panels
from fixedpipe.effects.reflectance import factored_passes, homomorphic_factors
from fixedpipe.effects.reflectance.brdfs import BRDFS
from fixedpipe.effects.reflectance.factored_passes import Product
from fixedpipe.effects.reflectance.hemisphere_maps import AnalyticBRDF
from fixedpipe.effects.scenes.teapot import teapot

DATA = figure_data(__file__, "H18")

PANELS = ("p(l) q(h)", "p(v)", "their product under n.l")
# Pairs of directions by which factors are compared with the BRDF, whatever their texels are.
_COUNT = 4096


@dataclass(frozen=True)
class Metal:
    """Ward's highlight over a matt surface of its own colour: an object with ``at``."""

    diffuse: tuple[float, ...]
    specular: tuple[float, ...]
    alpha_x: float
    alpha_y: float

    def at(self, lights, views):
        """f_r of directions [n, 3] each: float64 [n, 3]."""
        widths = {"alpha_x": self.alpha_x, "alpha_y": self.alpha_y}
        highlight = AnalyticBRDF(BRDFS["ward_bounded"], widths).at(lights, views)
        return np.array(self.diffuse) / np.pi + np.array(self.specular) * highlight


@lru_cache(maxsize=8)
def factors(metal, map_size):
    """The HomomorphicFactors of a Metal."""
    return homomorphic_factors.factored(metal, map_size)


def turned(size, turn):
    """The teapot, tangents round its axis."""
    return teapot(the.detail(size)).rotated(rotation("y", turn))


def make_scene(board):
    """A Scene that draws the passes and the product by a Board's means."""

    def scene(profile, size, *, light, intensity, turn, map_size, **metal):
        found = factors(Metal(**metal), map_size)
        commands, loaded = factored_passes.load(found, "copper", profile, intensity=intensity, board=board)
        lookups = loaded.products[0].lookups
        parts = (Product(lookups[:2]),), (Product(lookups[2:]),), loaded.products
        surface, out = turned(size, turn), [*commands]
        for part, panel in zip(parts, row_of_panels(len(PANELS), size, the.ASPECT), strict=True):
            shown = loaded if part is loaded.products else replace(loaded, products=part, boost=1.0)
            lit = part is loaded.products
            out.append(panel.clear(BACKGROUND))
            out += factored_passes.passes(surface, shown, the.view_of(panel), Light(light), lit=lit)
        return tuple(out)

    return scene


def reference(size, *, light, intensity, turn, map_size, **metal):
    """The product's panel by the BRDF itself at the vertices; the passes have no reference."""
    del map_size
    panel = row_of_panels(len(PANELS), size, the.ASPECT)[-1]
    surface = turned(size, turn)
    towards, views, above = the.lit_and_seen(surface, the.view_of(panel), Light(light))
    colors = np.zeros(towards.shape)
    found = Metal(**metal).at(normalize(towards[above]), normalize(views[above]))
    colors[above] = np.pi * intensity * found * towards[above, 2:]
    picture = the.pictured(the.colored(surface, panel, colors), panel.x + panel.width, size)
    shown = np.zeros((*picture.shape[:2], 1))
    shown[:, panel.x :] = 1.0
    return np.concatenate([picture, shown], axis=-1)


def directions(first, second):
    """Unit vectors above the horizon by 24 degrees and more, in steps that are whole: float64 [n, 3]."""
    k = np.arange(_COUNT)
    z = 0.4 + 0.6 * ((k * first) % _COUNT + 0.5) / _COUNT
    angle = 2.0 * np.pi * (((k * second) % _COUNT + 0.5) / _COUNT)
    around = np.sqrt(1.0 - z * z)
    return normalize(np.stack([around * np.cos(angle), around * np.sin(angle), z], axis=-1))


def highlight(panel):
    """Width and height, pixels, of where a panel is brighter than half of its brightest."""
    bright = panel.max(axis=-1)
    rows, columns = np.nonzero(bright > 0.5 * bright.max())
    return np.std(columns), np.std(rows)


def contrast(panel, bright, covered):
    """A panel's mean light on ``bright`` pixels over that on others that are ``covered``."""
    light = panel.max(axis=-1)
    return float(light[bright].mean() / max(light[covered & ~bright].mean(), 1.0e-9))


def _factor_checks(panels, by_vertices, covered, on):
    """That the first panel has the BRDF's highlight, and the second has not."""
    light = np.clip(by_vertices, 0.0, 1.0).max(axis=-1)
    bright = covered & (light > 0.5 * light.max())
    half = float(np.sqrt(contrast(by_vertices, bright, covered)))
    for name, panel, bound in zip(PANELS, panels, ("at_least", "at_most"), strict=False):
        yield DATA.check(
            "{name}: light where the BRDF's highlight is, over that around it",
            contrast(panel, bright, covered),
            on,
            name=name,
            **{bound: half},
        )


def checks(figure, renderer):
    """The product against the BRDF, its passes against each other, and the highlight's shape."""
    size, values = figure.size // 4, figure.values
    metal = Metal(*(values[name] for name in ("diffuse", "specular", "alpha_x", "alpha_y")))
    by_vertices = np.split(figure.reference_picture(size, renderer.method)[::-1, :, :3], 3, axis=1)[-1]
    covered = the.covered(by_vertices)
    for on in Answer:
        first, second, product = np.split(np.clip(renderer.window(on, figure, size), 0.0, 1.0), 3, axis=1)
        yield DATA.check(
            "RMS of the product - the BRDF at the vertices",
            root_mean_square((product - np.clip(by_vertices, 0.0, 1.0))[covered]),
            on,
        )
        yield DATA.check(
            "pixels of the teapot where a factor is black, a share",
            float(((first.max(axis=-1) == 0.0) | (second.max(axis=-1) == 0.0))[covered].mean()),
            on,
        )
        yield from _factor_checks((first, second), by_vertices, covered, on)
        drawn = float(the.covered(second)[covered].mean())
        yield DATA.check("pixels of the teapot that p(v) is drawn on, a share", drawn, on)
        across, along = highlight(product)
        true_across, true_along = highlight(by_vertices)
        yield DATA.check(
            "the highlight's elongation over the BRDF's own",
            (along / across) / (true_along / true_across),
            on,
        )
    lights, views = directions(1, 1597), directions(2531, 987)
    true = metal.at(lights, views) * lights[:, 2:]
    fitted = factors(metal, values["map_size"])
    found = fitted.at(lights, views) * lights[:, 2:]
    yield DATA.check(
        "RMS of p(l) q(h) p(v) - f_r, times n.l, over f_r's",
        root_mean_square(found - true) / root_mean_square(true),
        Answer.IDEAL,
    )
    yield DATA.check(
        "median of the ratio's logarithm, either way",
        float(np.median(np.abs(np.log(found / true)))),
        Answer.IDEAL,
    )
    yield DATA.check(
        "largest change where light and view change places, a share",
        float(np.abs(fitted.at(views, lights) / fitted.at(lights, views) - 1.0).max()),
        Answer.IDEAL,
    )


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    aspect=the.ASPECT,
    parameters={
        "diffuse": word.DIFFUSE((0.30, 0.13, 0.07)),
        "specular": word.SPECULAR((0.80, 0.50, 0.34)),
        "alpha_x": word.ALPHA_X(0.18),
        "alpha_y": word.ALPHA_Y(0.5),
        "map_size": the.MAP_SIZE,
        "turn": word.DEGREES(-25.0, "How far the teapot is turned."),
        "light": word.LIGHT((0.25, 0.5, 1.0)),
        "intensity": the.intensity(0.55),
    },
    methods=the.methods(
        make_scene,
        (
            "cube maps, two passes on two units",
            "cube maps, one pass on four units",
            "parabolic maps, two passes on two units",
            "parabolic maps, three passes on one unit",
        ),
        ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY"),
    ),
    acceptance=checks,
    reference=reference,
)
