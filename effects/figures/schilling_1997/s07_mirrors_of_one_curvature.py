"""S07: an environment in upright pipes, with levels of detail set by hand and with an anisotropic filter."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import cylinder_mirrors
from fixedpipe.effects.environment_maps.cylinder_mirrors import (
    EYE,
    FIELD,
    PIPES,
    changes,
    pipe_passes,
    sampler,
    shelves,
)
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, perspective_view, row_of_panels

DATA = figure_data(__file__, "S07")

PANELS = ("the machine's level", "level 0 by hand", "a level between, by hand", "anisotropic")
# Levels that are set by hand in checks.
LEVELS = np.arange(13) / 2.0


def _view(panel):
    return perspective_view(panel, EYE, field_of_view=FIELD)


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
        out += pipe_passes(PIPES, _view(panel), read, slices, max(2, size // 32))
    return tuple(out)


def anisotropic_scene(profile, size, *, level, most, background):
    """S07 with a chip's anisotropic filter."""
    return _scene(profile, size, level, sampler(max_anisotropy=float(most)), background)


def probes_scene(profile, size, *, level, most, background):
    """S07 with footprint assembly."""
    return _scene(profile, size, level, sampler(max_probes=most), background)


def _truth(size):
    """The pipes alone and where they fill a pixel: float64 [size, size, 3], bool."""
    found = cylinder_mirrors.supersampled(_view(Panel(0, 0, size, size)), PIPES, shelves(rows(size)))
    return found[..., :3], found[..., 3] == 1.0


def reference(size, *, level, most, background):
    """256 rays a pixel, in every panel, which know no level."""
    del level, most
    found = cylinder_mirrors.supersampled(_view(Panel(0, 0, size, size)), PIPES, shelves(rows(size)))
    share = found[..., 3:]
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
        along, round_ = (changes(panel_of(image, k), full) / changes(truth, full) for k in (0, 1))
        yield DATA.check("the machine's level: changes along the axis over the truth's", float(along[0]), on)
        yield DATA.check("level 0: changes round the pipes over the truth's", float(round_[1]), on)


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
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("anisotropic filter", anisotropic_scene, ("GEFORCE_3", "NV2A")),
        Method("footprint assembly", probes_scene, ("TEXRAM",)),
    ),
    reference=reference,
    acceptance=checks,
)
