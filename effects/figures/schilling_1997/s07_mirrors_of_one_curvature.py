"""S07: an environment in upright pipes, with levels of detail set by hand and with an anisotropic filter."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import cylinder_mirrors
from fixedpipe.effects.environment_maps.cylinder_mirrors import (
    Pipe,
    changes,
    end_passes,
    pipe_passes,
    sampler,
    shelves,
)
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import Panel, panel_of, perspective_view, row_of_panels

DATA = figure_data(__file__, "S07")

PANELS = ("the machine's level", "level 0 by hand", "a level between, by hand", "anisotropic")
# Levels that are set by hand in checks.
LEVELS = np.arange(13) / 2.0

# Three pipes, and the left half of one that is near: their lower ends lie below the picture.
PIPES = (
    Pipe(-0.66, -0.30, 0.20, 0.62, -2.0),
    Pipe(-0.22, -0.05, 0.14, 0.36, -2.0),
    Pipe(0.12, -0.40, 0.11, 0.78, -2.0),
    Pipe(0.70, 0.85, 0.40, 0.42, -2.0),
)
EYE, CENTER, FIELD = (0.0, 0.75, 2.4), (0.0, 0.05, 0.0), 42.0
# Assumed: how much darker polished metal looks edge-on, which makes pipes look round.
SHADE = 0.75


def _view(panel):
    return perspective_view(panel, EYE, CENTER, field_of_view=FIELD)


def rows(size):
    """The panorama's rows: half of a panel's pixels, a power of two, so that footprints are as long in texels
    at any size.
    """
    return max(8, 1 << (size // 2).bit_length() - 1)


def _scene(profile, size, level, along, background):
    """Four panels of pipes; ``along``: the sampler of the last."""
    reads = (sampler(), sampler(lod=0.0), sampler(lod=level), along)
    out = [cylinder_mirrors.load(shelves(rows(size)), profile)]
    slices = max(12, min(96, size // 4))
    for panel, read in zip(row_of_panels(4, size), reads, strict=True):
        out.append(panel.clear(background))
        out += pipe_passes(PIPES, _view(panel), read, slices, max(2, size // 32), SHADE)
        out += end_passes(PIPES, _view(panel), slices)
    return tuple(out)


def anisotropic_scene(profile, size, *, level, most, background):
    """S07 with a chip's anisotropic filter."""
    return _scene(profile, size, level, sampler(max_anisotropy=float(most)), background)


def probes_scene(profile, size, *, level, most, background):
    """S07 with footprint assembly."""
    return _scene(profile, size, level, sampler(max_probes=most), background)


def _found(size):
    """The pipes by 256 rays a pixel, as ``cylinder_mirrors.supersampled`` has them."""
    view = _view(Panel(0, 0, size, size))
    return cylinder_mirrors.supersampled(view, PIPES, shelves(rows(size)), shade=SHADE)


def _truth(size):
    """The pipes alone and where what mirrors fills a pixel: float64 [size, size, 3], bool."""
    found = _found(size)
    return found[..., :3], (found[..., 3] == 1.0) & (found[..., 4] == 0.0)


def reference(size, *, level, most, background):
    """256 rays a pixel, in every panel, which know no level."""
    del level, most
    found = _found(size)
    share = found[..., 3:4]
    picture = np.concatenate(
        [share * found[..., :3] + (1.0 - share) * background, np.ones_like(share)], axis=-1
    )
    return np.tile(picture[::-1], (1, 4, 1))


def checks(figure, renderer):
    """RMS from 256 samples a pixel: one level for all against the anisotropic filter."""
    size = figure.size
    truth, full = _truth(size)
    for on in Answer:
        image = renderer.window(on, figure, size)
        error = {n: root_mean_square((panel_of(image, k) - truth)[full]) for k, n in enumerate(PANELS)}
        by_hand = min(
            root_mean_square(
                (panel_of(renderer.window(on, figure, size, level=float(level)), 2) - truth)[full]
            )
            for level in (LEVELS if on is Answer.MACHINE else LEVELS[:4])
        )
        yield DATA.check(
            "anisotropic: RMS from 256 samples over the best single level's",
            error[PANELS[3]] / by_hand,
            on,
            at_most=1.0 / 3.0,
        )
        yield DATA.check(
            "anisotropic: RMS from 256 samples over that of the machine's own level",
            error[PANELS[3]] / error[PANELS[0]],
            on,
        )
        own, sharp, between = (changes(panel_of(image, k), full) / changes(truth, full) for k in range(3))
        yield DATA.check("the machine's level: changes along the axis over the truth's", float(own[0]), on)
        yield DATA.check(
            "the machine's level: changes along the axis over a level between's", own[0] / between[0], on
        )
        yield DATA.check("level 0: changes round the pipes over the truth's", float(sharp[1]), on)
        yield DATA.check("a level between: changes along the axis over level 0's", between[0] / sharp[0], on)
        yield DATA.check("a level between: changes round the pipes over level 0's", between[1] / sharp[1], on)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "level": word.of(word.Number(0.0, 6.0), 1.5, "The level of the third panel."),
        "most": word.of(
            word.Whole(1, 8, power=True),
            8,
            "The most probes, or how much longer than wide a footprint may be.",
        ),
        "background": word.BACKDROP((0.72, 0.74, 0.77)),
    },
    methods=(
        Method("anisotropic filter", anisotropic_scene, ("GEFORCE_3", "NV2A")),
        Method("footprint assembly", probes_scene, ("TEXRAM",)),
    ),
    reference=reference,
    acceptance=checks,
)
