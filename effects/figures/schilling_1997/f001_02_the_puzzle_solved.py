"""F001-2: the puzzle at a flat angle, with one probe a pixel and with up to eight."""

from itertools import pairwise

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, row_of_panels
from fixedpipe.effects.passes.draws import EDGE
from fixedpipe.effects.texture_filtering import stretched_writing as written
from fixedpipe.effects.texture_filtering.footprint_assembly import probes

DATA = figure_data(__file__, "F001-2")

MOST = (1, 2, 4, 8)
# Strips of a panel from above: level 0 alone, one for each of MOST, and one of 256 samples a pixel.
STRIPS = len(MOST) + 2
# By how many degrees the eye moves from picture to picture where what shimmers is measured, and how often:
# an eighth of a pixel at the page's edge.
MOVES, PICTURES = 0.03, 8
PAGES = {"writing": written.writing, "stripes": written.stripes}


def _views(size, angle):
    (panel,) = row_of_panels(1, size)
    high = size // STRIPS
    strips = (Panel(panel.x, panel.y + size - (k + 1) * high, size, high) for k in range(STRIPS))
    return panel, [written.flat_view(strip, angle) for strip in strips]


def _scene(profile, size, samplers, angle, page, background):
    """Strips of the page, and the truth below them."""
    panel, views = _views(size, angle)
    image = PAGES[page](written.page_edge(size))
    out = [written.load(image, profile), panel.clear(background)]
    out.append(written.page_pass("level 0 alone", views[0], EDGE))
    for view, (most, read) in zip(views[1:-1], samplers, strict=True):
        out.append(written.page_pass(f"up to {most} probes a pixel", view, read))
    truth = written.supersampled(views[-1], image, background)
    return (*out, *written.strip_of(truth, views[-1].panel, profile))


def probes_scene(profile, size, *, angle, page, background):
    """F001-2 by footprint assembly."""
    samplers = [(most, written.sampler(max_probes=most)) for most in MOST]
    return _scene(profile, size, samplers, angle, page, background)


def exact_scene(profile, size, *, angle, page, background):
    """F001-2 by footprint assembly with as many probes as cover a footprint."""
    samplers = [(most, written.sampler(max_probes=most, exact_probes=most > 1)) for most in MOST]
    return _scene(profile, size, samplers, angle, page, background)


def anisotropic_scene(profile, size, *, angle, page, background):
    """F001-2 by a chip's anisotropic filter."""
    samplers = [(most, written.sampler(max_anisotropy=float(most))) for most in MOST]
    return _scene(profile, size, samplers, angle, page, background)


def _strip(image, view):
    """A strip of a window's picture, bottom row first."""
    p = view.panel
    return np.asarray(image)[p.y : p.y + p.height, p.x : p.x + p.width]


def checks(figure, renderer):
    """Correlation with 256 samples, contrast across the short axis, probes a pixel."""
    size, angle = figure.size, figure.values["angle"]
    _, views = _views(size, angle)
    for on in Answer:
        image, lined = (renderer.window(on, figure, size, page=page) for page in PAGES)
        background = figure.values["background"]
        truth = written.supersampled(views[0], written.writing(written.page_edge(size)), background)
        page = written.supersampled(views[0], np.ones((2, 2, 3)), (0.0, 0.0, 0.0))[..., 0] == 1.0
        letters = written.within_letters(truth)[page]
        alike = [
            written.correlation(written.within_letters(_strip(image, view))[page], letters)
            for view in views[1:-1]
        ]
        yield DATA.check("eight probes: correlation with 256 samples, within letters", alike[-1], on)
        yield DATA.check("one probe: correlation with 256 samples, within letters", alike[0], on)
        yield DATA.check(
            "correlation with 256 samples: the least gain by twice as many probes",
            min(after - before for before, after in pairwise(alike)),
            on,
        )
        lines = written.supersampled(views[0], written.stripes(written.page_edge(size)), background)
        contrast = [_contrast(_strip(lined, view)) / _contrast(lines) for view in views[1:-1]]
        yield DATA.check(
            "eight probes: contrast across the short axis, over that of 256 samples", contrast[-1], on
        )
        yield DATA.check(
            "one probe: contrast across the short axis, over that of 256 samples", contrast[0], on
        )
        yield DATA.check(
            "256 samples: pixels of the last strip that show them within 8/255",
            seen_places.alike(_strip(image, views[-1]), truth, seen_places.WITHIN),
            on,
        )
    yield from _shimmer(figure, renderer, page)
    footprints, exact = written.footprints(views[0], written.page_edge(size)), renderer.method is _EXACT
    counts = probes(*footprints, MOST[-1], exact=exact, diagonals=False).count
    for bound, name in (({"at_least": 4.0}, "at least"), ({"at_most": 8.0}, "at most")):
        name = f"probes a pixel, mean, {name}; so many times mip-mapping's texels"
        reason = "the catalogue's: 4 to 8"
        yield Check(name, float(counts.mean()), on=Answer.IDEAL, reason=reason, **bound)


def _shimmer(figure, renderer, page):
    """How much pixels of the page change in time while the eye moves by less than a pixel a picture, beside
    how much they should. What a picture is off by would not tell: a blur is off by what moves behind it.
    """
    size, strips, truths = figure.size, [], []
    writing = written.writing(written.page_edge(size))
    for number in range(PICTURES):
        angle = figure.values["angle"] + MOVES * number
        image = renderer.window(Answer.MACHINE, figure, size, angle=angle)
        views = _views(size, angle)[1]
        truths.append(written.supersampled(views[0], writing, figure.values["background"])[page])
        strips.append([_strip(image, view)[page] for view in views[:-1]])
    should = np.array(truths).var(axis=0).mean()
    level_0, one, *_, eight = np.array(strips).var(axis=0).mean(axis=(1, 2)) / should
    yield DATA.check(
        "level 0 alone: variance in time over that of 256 samples", float(level_0), Answer.MACHINE
    )
    yield DATA.check("one probe: variance in time over that of 256 samples", float(one), Answer.MACHINE)
    yield DATA.check(
        "eight probes: variance in time, off that of 256 samples by", abs(float(eight) - 1.0), Answer.MACHINE
    )


def _contrast(strip):
    """The deviation of a strip's middle rows across the lines."""
    rows = strip[len(strip) * 2 // 5 : len(strip) * 3 // 5, strip.shape[1] // 4 : strip.shape[1] * 3 // 4]
    return float((rows - rows.mean(axis=1, keepdims=True)).std())


_EXACT = Method("footprint assembly, any number", exact_scene, ("SCHILLING",))

FIGURE = Figure(
    **DATA.words,
    parameters={
        "angle": word.of(word.Number(3.0, 60.0), 8.0, "How high above the page the eye is.", "degrees"),
        "page": word.of(word.Choice({n: n for n in PAGES}), "writing", "What is on the page."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("footprint assembly", probes_scene, ("TEXRAM",)),
        _EXACT,
        Method("anisotropic filter", anisotropic_scene, ("GEFORCE_3", "NV2A")),
    ),
    acceptance=checks,
)
