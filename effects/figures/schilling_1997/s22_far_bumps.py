"""S22: a rippled plane to the horizon under a lamp: bumps as a mip-map, with I_1, with D, and in truth."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Panel,
    panel_of,
    perspective_view,
    row_of_panels,
)
from fixedpipe.effects.passes.draws import show
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.texture_filtering import highlight_pyramids, sampled_highlights
from fixedpipe.effects.texture_filtering.highlight_pyramids import Roughness
from fixedpipe.effects.texture_filtering.sampled_highlights import Ground

DATA = figure_data(__file__, "S22")

PANELS = (*(kind.value for kind in Roughness), "256 samples a pixel")
_EYE, _FAR, _NEAR, _HALF_WIDTH = 1.0, 40.0, 1.2, 0.6
_LOOK, _FIELD = (0.0, -0.3, -1.0), 40.0
# Of what checks measure: little is clamped.
_GAIN = 2


def _view(panel):
    center = (_LOOK[0], _EYE + _LOOK[1], _LOOK[2])
    return perspective_view(panel, (0.0, _EYE, 0.0), center, _FIELD, radius=2.0 * _FAR)


def _ground(p):
    return Ground(_EYE, _FAR, p["period"], sampled_highlights.lamp(p["elevation"]), p["lobe"])


@lru_cache(4)
def bumps(across, along):
    """Offsets of level 0: float64 [256, 256, 2]."""
    return sampled_highlights.ripples(256, 32, across, along)


def truth(size, p):
    """256 samples a pixel: highlights and the plane's share, float64 [size, size, 2]."""
    return sampled_highlights.supersampled(_view(Panel(0, 0, size, size)), _ground(p), bumps(*p["bumps"]))


def _colored(found, gain, color, base, background):
    """What ``truth`` found in colours: float64 [size, size, 3]."""
    light, share = found[..., :1], found[..., 1:]
    lit = np.minimum(gain * light, 1.0) * np.asarray(color) + np.asarray(base) * share
    return np.clip(lit + (1.0 - share) * np.asarray(background), 0.0, 1.0)


def scene_by(divide):
    """The scene on machines whose combiners divide, or on those without."""

    def scene(profile, size, *, gain, color, base, background, **p):
        ground, panels, out = _ground(p), row_of_panels(4, size), []
        surface = ground.surface(max(8, size // 16), max(8, size // 8), _NEAR, _HALF_WIDTH)
        slopes = ground.half_slopes(surface.positions)
        most, levels = float(np.abs(slopes).max()), sampled_highlights.pyramid(bumps(*p["bumps"]), ground)
        for kind, panel in zip(Roughness, panels, strict=False):
            out.append(panel.clear(background))
            if divide:
                load, names = highlight_pyramids.load_quotient(levels, kind, most, profile)
                drawn = highlight_pyramids.quotient_pass(
                    surface, slopes, names, _view(panel), profile, (color, base), gain
                )
            else:
                load, names = highlight_pyramids.load_rows(levels, kind, most, profile)
                drawn = highlight_pyramids.rows_pass(
                    surface, slopes, names, _view(panel), (color, base), gain
                )
            out += [*load, *drawn]
        picture = factor_texels(_colored(truth(size, p), gain, color, base, background), profile)
        return (*out, panels[3].clear(background), *show(picture, panels[3], PANELS[3], plane()))

    return scene


def reference(size, *, gain, color, base, background, **p):
    """256 samples a pixel, in every panel."""
    picture = _colored(truth(size, p), gain, color, base, background)
    picture = np.concatenate([picture, np.ones((size, size, 1))], axis=-1)[::-1]
    return np.tile(picture, (1, 4, 1))


def _width(image, rows):
    """How far a highlight reaches to either side over some rows: a deviation in pixels. float."""
    columns = image[rows].sum(axis=0)
    x = np.arange(len(columns)) + 0.5
    middle = (columns * x).sum() / columns.sum()
    return float(np.sqrt((columns * (x - middle) ** 2).sum() / columns.sum()))


def checks(figure, renderer):
    """RMS from 256 samples a pixel, how much light there is, and how wide it is where bumps are lost."""
    size, p = figure.size, dict(figure.values)
    wanted = truth(size, p)
    plain = {"color": (1.0, 1.0, 1.0), "base": (0.0, 0.0, 0.0), "background": (0.0, 0.0, 0.0), "gain": _GAIN}
    right, full = np.minimum(_GAIN * wanted[..., 0], 1.0), wanted[..., 1] == 1.0
    # The third of the plane's rows that is farthest away.
    met = np.nonzero(full.all(axis=1))[0]
    far = met[2 * len(met) // 3 :]
    none, isotropic, anisotropic = PANELS[:3]
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size, **plain), 0.0, 1.0)
        images = {name: panel_of(window, k)[..., 0] for k, name in enumerate(PANELS)}
        error = {name: root_mean_square((images[name] - right)[full]) for name in PANELS[:3]}
        light = {name: float(images[name][full].mean() / right[full].mean()) for name in PANELS[:3]}
        width = {name: _width(images[name], far) / _width(right, far) for name in PANELS[:3]}
        yield DATA.check("mip-mapped bumps: light over that of 256 samples", light[none], on)
        yield DATA.check("mip-mapped bumps: width of the far highlight over the truth's", width[none], on)
        for name in (isotropic, anisotropic):
            yield DATA.check(
                "{name}: RMS from 256 samples over that of mip-mapped bumps",
                error[name] / error[none],
                on,
                name=name,
            )
            yield DATA.check(
                "{name}: light over that of 256 samples, off one", abs(light[name] - 1.0), on, name=name
            )
        yield DATA.check(
            "with D: width of the far highlight over the truth's, off one", abs(width[anisotropic] - 1.0), on
        )
        yield DATA.check(
            "with I_1: width of the far highlight over that with D", width[isotropic] / width[anisotropic], on
        )


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "bumps": word.of(
            word.Several((word.Number(0.0, 0.8),) * 2, what="two numbers from 0 to 0.8"),
            (0.12, 0.24),
            "The deviations of the ripples' slopes, to the right and away.",
        ),
        "period": word.of(word.Number(0.1, 8.0), 0.4, "How long the bump map is.", "world units"),
        "lobe": word.of(word.Number(0.05, 0.5), 0.1, "The deviation of slopes without ripples."),
        "elevation": word.of(word.Number(5.0, 80.0), 13.0, "How high the lamp is.", "degrees"),
        "gain": word.of(word.Whole(1, 4, power=True), 4, "How many times as bright highlights are drawn."),
        "color": word.SPECULAR((1.0, 0.9, 0.7)),
        "base": word.AMBIENT((0.03, 0.05, 0.08)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("D^-1 by dot products and a table", scene_by(False), ("GEFORCE_3", "NV2A")),
        Method("K and a divide at every fragment", scene_by(True), ("FUTURE",)),
    ),
    reference=reference,
    acceptance=checks,
)
