"""H32: a parabolic map filtered by the imaging subset's convolution, next to one filtered beforehand."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import (
    bumped_reflections,
    convolved_maps,
    environments,
    prefilter,
    reflections,
)
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import IMAGING_MACHINES, Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import reflecting
from fixedpipe.effects.geometry import cube_maps, parabolic_maps
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels

DATA = figure_data(__file__, "H32")

PANELS = "mirror", "separable filter", "general filter", "filtered beforehand"


def _white(toward):
    return np.full((*np.shape(toward)[:-1], 3), 0.5)


_ENVIRONMENTS = {"room": environments.room, "white": _white}


def _names(panel):
    return f"{panel}, first disc", f"{panel}, second disc"


def beforehand(texels, exponent, room):
    """The discs that ``prefilter`` makes: float64 [2, texels, texels, 3]."""
    cube = prefilter.phong(environments.faces(2 * texels, room), exponent)
    reach = parabolic_maps.margin(texels, convolved_maps.MARGIN)
    return cube_maps.look_up(cube, parabolic_maps.directions(texels, reach))


def scene(profile, size, *, eye, environment, texels, exponent, photograph):
    """H32: a ball in a ring; the map unfiltered, filtered by both kinds of kernel, and filtered
    beforehand.
    """
    surface, panels = reflecting.ball_in_ring(size), row_of_panels(4, size)
    room = photograph.panorama if photograph else _ENVIRONMENTS[environment]
    texels = min(reflecting.texels(size), texels)
    margin = convolved_maps.MARGIN
    load, _ = bumped_reflections.picture_backdrop(
        reflecting.camera(panels[0], eye), reflecting.texels(size), profile, room
    )
    kernels = (
        convolved_maps.separable_filter(exponent, texels),
        convolved_maps.general_filter(exponent, texels),
    )
    out = [
        load,
        *convolved_maps.load(_names(PANELS[0]), environments.discs(texels, room, margin), profile),
        *convolved_maps.load(_names(PANELS[3]), beforehand(texels, exponent, room), profile),
    ]
    for name, kernel in zip(PANELS[1:3], kernels, strict=True):
        out += convolved_maps.filtered_copies(_names(PANELS[0]), _names(name), texels, kernel)
    for panel, name in zip(panels, PANELS, strict=True):
        view = reflecting.camera(panel, eye)
        _, backdrop = bumped_reflections.picture_backdrop(view, reflecting.texels(size), profile, room)
        out += (
            panel.clear(BACKGROUND),
            backdrop,
            *reflections.parabolic_passes(surface, view, _names(name), texels, margin=margin),
        )
    return tuple(out)


# How many pixels of a panel are compared with sums over all texels.
_SOME = 96


def _displayed_checks(figure, renderer):
    """Some pixels of what mirrors, and of the room behind, by the room itself and sums over its texels."""
    size, values = figure.size, figure.values
    view = reflecting.camera(row_of_panels(4, size)[0], values["eye"])
    surface = reflecting.ball_in_ring(size)
    toward, known = reflecting.reflections_by_rays(surface, view)
    back, behind = reflecting.backdrop_by_rays(surface, view)
    some, places = reflecting.some_of(known, _SOME), reflecting.some_of(behind, 16 * _SOME)
    texels = cube_maps.directions(64).reshape(-1, 3)
    angles = np.broadcast_to(cube_maps.solid_angles(64), (6, 64, 64)).reshape(-1, 1)
    light = np.concatenate([environments.room(texels) * angles, angles], axis=-1)
    toward = toward.reshape(-1, 3)[some]
    sharp, blurred = environments.room(toward), reflecting.lobes(toward, texels, light, values["exponent"])
    room = environments.room(back.reshape(-1, 3)[places])
    flat, flat_room = (np.broadcast_to(colors.mean(axis=0), colors.shape) for colors in (sharp, room))
    for on in Answer:
        window, shares = np.clip(renderer.window(on, figure, size), 0.0, 1.0), []
        for k in range(4):
            panel = panel_of(window, k).reshape(-1, 3)
            # Maps of 64 texels blur the room themselves, so nothing tells the mirror from the lobe.
            of = (blurred, flat, sharp) if k else (sharp, flat)
            shares.append(least_share(panel[some], *of))
            shares.append(least_share(panel[places], room, flat_room))
        yield DATA.check(
            "of what maps, filters and the room behind change, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """The four panels against each other."""
    yield from _displayed_checks(figure, renderer)
    size = 128
    view = reflecting.camera(row_of_panels(4, size)[0], figure.values["eye"])
    _, known = reflecting.reflections_by_rays(reflecting.ball_in_ring(size), view)
    for on in (Answer.IDEAL, Answer.MACHINE):
        image = renderer.window(on, figure, size)
        mirror, separable, general, before = (panel_of(image, k)[known] for k in range(4))
        yield DATA.check("separable against general filter, RMS", root_mean_square(separable - general), on)
        yield DATA.check(
            "convolution against what was filtered beforehand, RMS", root_mean_square(separable - before), on
        )
        yield DATA.check(
            "mirror against what was filtered beforehand, RMS", root_mean_square(mirror - before), on
        )
        white = renderer.window(on, figure, size, environment="white")
        yield DATA.check(
            "largest change of a constant map by the kernels",
            max(
                float(np.abs(panel_of(white, k)[known] - panel_of(white, 0)[known]).max()) for k in (1, 2, 3)
            ),
            on,
            at_most={Answer.IDEAL: 1e-9, Answer.MACHINE: 1.0 / 255.0}[on],
        )
    texels = figure.values["texels"]
    true = _convolved(environments.discs(texels, margin=convolved_maps.MARGIN)[0], texels, figure)
    reach = parabolic_maps.margin(texels, convolved_maps.MARGIN)
    before = beforehand(texels, figure.values["exponent"], environments.room)[0]
    radius = np.hypot(*np.meshgrid(*(2.0 * (np.arange(texels) + 0.5) / texels - 1.0,) * 2)) / reach
    yield DATA.check(
        "the same of the maps' texels, a kernel summed by hand, RMS in the disc",
        root_mean_square((true - before)[radius < 1.0]),
        Answer.IDEAL,
    )


def _convolved(disc, texels, figure):
    """A disc's middle by a sum over shifted copies, its border as it is."""
    kernel = convolved_maps.general_filter(figure.values["exponent"], texels)
    half = convolved_maps.KERNEL // 2
    out = np.zeros_like(disc)
    for y, row in enumerate(kernel.rows):
        for x, (weight, *_) in enumerate(row):
            out += weight * np.roll(disc, (half - y, half - x), axis=(0, 1))
    return out


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "eye": word.POSITION((0.0, 0.35, 2.9), "The eye."),
        "environment": word.of(
            word.Choice({name: name for name in _ENVIRONMENTS}), "room", "What is around: a room, or grey."
        ),
        "texels": word.of(
            word.Whole(16, 64, power=True), 64, "The edge of a disc's map, at most a panel's.", "texels"
        ),
        "exponent": word.of(word.Number(20.0, 4096.0), 100.0, "The exponent of the lobe."),
        "photograph": own_maps.PANORAMA,
    },
    methods=(Method("convolution of the imaging subset", scene, IMAGING_MACHINES),),
    acceptance=checks,
)
