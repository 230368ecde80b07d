"""S24: lights on rippled water on the machine that the paper proposes, by level and by probes."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import rough_mirrors
from fixedpipe.effects.environment_maps import roughness_board_passes as board
from fixedpipe.effects.environment_maps.environments import faces
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.schilling_1997.shared.antialiased_panels import with_panels
from fixedpipe.effects.geometry.height_fields import hashed
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Panel, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.texture_filtering.stretched_writing import strip_of

DATA = figure_data(__file__, "S24")

PANELS = ("bumps averaged alone", "by level", "8 probes", "256 samples a pixel")
MIRROR = rough_mirrors.Mirror(period=0.3)
AHEAD = board.Ahead(axis=(0.0, 0.3, -1.0), reach=2.0)
BUMP_SCALE, ROUGH_SCALE, TEXELS = 0.5, 0.25, 64
# Lamps: where they are, the cosine of their radius, their colours.
_LAMPS = (
    ((0.0, 0.36, -1.0), 0.9976, (1.0, 0.95, 0.8)),
    ((-0.42, 0.16, -1.0), 0.9994, (1.0, 0.45, 0.2)),
    ((0.40, 0.20, -1.0), 0.9994, (0.3, 0.8, 0.5)),
    ((0.62, 0.13, -1.0), 0.9996, (0.4, 0.6, 1.0)),
    ((-0.66, 0.22, -1.0), 0.9995, (0.9, 0.8, 0.4)),
)


def evening(toward):
    """A moon and four lamps in a dusk that is darker above: RGB float64 [..., 3] from 0 to 1."""
    along = normalize(toward)
    up = np.clip(along[..., 1:2], 0.0, 1.0)
    colors = np.array((0.20, 0.16, 0.24)) + np.array((0.02, 0.06, 0.16)) * up
    for place, cosine, color in _LAMPS:
        there = dot(along, normalize(np.array(place))) > cosine
        colors = np.where(there[..., None], color, colors)
    return colors


@lru_cache(4)
def pyramids(slope, height_field, height_scale):
    """Ripples of no direction: a tuple of Level."""
    if height_field is not None:
        return rough.from_heights(height_field.fitted(TEXELS, TEXELS, height_scale, repeated=True))
    count = np.arange(TEXELS * TEXELS * 2)
    even = hashed(count, count // 11, 4) / 32768.0 - 1.0
    return rough.pyramid(slope * np.sqrt(3.0) * even.reshape(TEXELS, TEXELS, 2))


def _view(panel):
    return perspective_view(panel, (0.0, 1.0, 0.0), (0.0, 0.66, -1.0), 30.0, 100.0)


def _mesh(view, size):
    """The water: rays that it mirrors lead ahead."""
    fine = 1 if size < 64 else 4
    u = np.linspace(-40.0, 40.0, 16 * fine + 1)
    v = np.concatenate([np.linspace(0.5, 8.0, 4 * fine + 1), np.linspace(9.0, 60.0, 4 * fine + 2)])
    return board.plane_mesh(view, MIRROR, u, v, AHEAD, BUMP_SCALE)


@lru_cache(4)
def truth(size, slope, height_field, height_scale):
    """256 samples a pixel: float64 [size, size, 3]."""
    offsets = pyramids(slope, height_field, height_scale)[0].offsets
    cube = np.array(faces(256 if size > 64 else 64, evening))
    return rough_mirrors.supersampled(_view(Panel(0, 0, size, size)), MIRROR, offsets, cube)


def scene(profile, size, *, slope, height_field, height_scale):
    """S24: three ways in one pass each, and the truth."""
    levels = pyramids(slope, height_field, height_scale)
    edge = 256 if size > 64 else 64
    out = [*board.load(levels, evening(AHEAD.directions(edge, edge)), BUMP_SCALE, ROUGH_SCALE)]
    *panels, last = row_of_panels(4, size)
    for panel, choices in zip(panels, ({"filtered": False}, {"probes": 1}, {"probes": 8}), strict=True):
        view = _view(panel)
        out.append(panel.clear((0.0, 0.0, 0.0)))
        out.append(board.reflection(_mesh(view, size), view, BUMP_SCALE, ROUGH_SCALE, **choices))
    picture = truth(size, slope, height_field, height_scale)
    return (*out, last.clear((0.0, 0.0, 0.0)), *strip_of(picture, last, profile))


def reference(size, *, slope, height_field, height_scale):
    """256 samples a pixel, in every panel."""
    return with_panels(truth(size, slope, height_field, height_scale), 4)


def checks(figure, renderer):
    """RMS from 256 samples a pixel, and the mean."""
    size = figure.size // 2
    found = truth(size, **figure.values)
    for on in Answer:
        image = renderer.window(on, figure, size)
        plain, level, probes = (root_mean_square(panel_of(image, k) - found) for k in range(3))
        yield DATA.check("8 probes: RMS from 256 samples", probes, on)
        yield DATA.check("by level: RMS over that of 8 probes", level / probes, on)
        yield DATA.check("bumps averaged alone: RMS over that of 8 probes", plain / probes, on)
        mean = abs(float(panel_of(image, 2).mean() / found.mean()) - 1.0)
        yield DATA.check("8 probes: mean light over the truth's, less one", mean, on)


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "slope": word.of(word.Number(0.0, 0.25), 0.07, "The deviation of the ripples' slopes."),
        "height_field": own_maps.height_field("the ripples"),
        "height_scale": own_maps.HEIGHT_SCALE(0.02),
    },
    methods=(Method("lookups filtered by roughness", scene, ("SCHILLING",)),),
    reference=reference,
    acceptance=checks,
)
