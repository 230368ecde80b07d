"""F001-10 and F001-11's lake: waves that tile to the horizon, a moon over them, and measures of the picture.

Assumed: 80 waves, a lower one being shorter. Assumed: a moon more than twice as bright as a pixel can be, as
in a photograph of a night, so that its light is still visible where waves spread it. In a cube map of bytes
the moon is one. Maps that are filtered for a roughness are filtered before.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.environment_maps import (
    bumped_reflections,
    environments,
    rough_mirror_passes,
    rough_mirrors,
)
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing, Mirror
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.schilling_1997.shared.antialiased_panels import Subject, draws
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.surfaces import Surface, plane
from fixedpipe.effects.geometry.vectors import cosine, dot, normalize, of_40_bits, sine
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view
from fixedpipe.effects.passes.draws import show
from fixedpipe.effects.passes.encoding import factor_texels

ASPECT = (4, 3)
# Source: catalogue, F001-10: 640 x 480 pixels, waves of 256 texels squared, a moon of 2 degrees.
HEIGHT, TEXELS, MOON = 480, 256, 2.0
WAVES, LARGEST_NUMBER = 80, 15
FIELD_OF_VIEW, DROP = 40.0, 0.06
# How far the water reaches, in heights of the eye: a third of a pixel below the horizon.
REACH = 2048.0
# Probes at most of the waves and of the environment, for the filtered answers.
PROBES = 16
# Of the waves' level on machines, whose footprints are as wide as they are long.
# Measured: at 480 rows the RMS of F001-10's passes is 0.0221 without it, 0.0209 with it.
BIAS = -1.0
_MOONLIGHT = np.array((1.0, 0.97, 0.85))
_ZENITH, _HAZE = (np.array(c) for c in ((0.03, 0.05, 0.12), (0.10, 0.12, 0.16)))
# Light from below, which waves that are seen from behind mirror: other water's, the sky once more, darker.
_DEEP = 0.5

PARAMETERS = {
    "slope": word.of(word.Number(0.0, 0.5), 0.05, "The deviation of the waves' slopes in one direction."),
    "period": word.of(
        word.Number(0.05, 16.0), 0.375, "How long the square of waves is.", "heights of the eye"
    ),
    "moon": word.of(word.Number(2.0, 30.0), 5.0, "How high the moon stands.", "degrees"),
    "brightness": word.of(word.Number(0.0, 64.0), 2.5, "How bright the moon is.", "what a pixel shows"),
    "time": word.of(
        word.Number(-1000.0, 1000.0), 0.0, "When: at 1 the waves are as at 0.", "of all waves' common period"
    ),
    "height_field": own_maps.height_field("the waves"),
    "height_scale": own_maps.HEIGHT_SCALE(0.02),
}


@dataclass(frozen=True)
class Lake:
    """A lake by PARAMETERS' names, which caches what is needed repeatedly."""

    slope: float
    period: float
    moon: float
    brightness: float
    time: float = 0.0
    height_field: object = None
    height_scale: float = 0.0


def _numbers(seed, count, low, high):
    """Whole numbers from ``low`` up to ``high``, without it, the same everywhere."""
    place = np.arange(count)
    return low + height_fields.hashed(place, place + 7, seed) % (high - low)


def waves(edge, time):
    """Heights of the lake's waves, which tile: float64 [edge, edge].

    A wave of k periods has the height k^(-3/2) times a number from 0 to 1; its frequency goes as the root of
    k, as in deep water, rounded so that all are back at time 1.
    """
    s, t = height_fields.texel_centers(edge, edge)
    along_s, along_t = (_numbers(seed, WAVES, -LARGEST_NUMBER, LARGEST_NUMBER + 1) for seed in (11, 12))
    phase, size = (_numbers(seed, WAVES, 0, 1024) / 1024.0 for seed in (13, 14))
    out = np.zeros((edge, edge))
    for number in range(WAVES):
        a, b = float(along_s[number]), float(along_t[number])
        k = math.sqrt(a * a + b * b)
        if not k:
            continue
        turns = (a * s + b * t) + (phase[number] - math.floor(math.sqrt(k) + 0.5) * time)
        turns = turns - np.floor(turns)
        out += size[number] / (k * math.sqrt(k)) * cosine(2.0 * math.pi * turns)
    return out


@lru_cache(maxsize=4)
def pyramids(lake, edge):
    """Both pyramids of the waves on a map of ``edge`` texels: a tuple of Level."""
    if lake.height_field is not None:
        s, t = lake.height_field.slopes(edge, lake.height_scale, repeated=True)
        return rough.pyramid(np.stack([-s, -t], axis=-1))
    levels = rough.from_heights(waves(edge, lake.time))
    a, _, c = levels[-1].covariance[0, 0].tolist()
    deviation = math.sqrt(0.5 * (a + c))
    return rough.pyramid(levels[0].offsets * (lake.slope / deviation))


@lru_cache(maxsize=8)
def _night(moon, brightness):
    """The environment as a function of directions, for ``environments.faces``."""
    up, away = (float(f(math.radians(moon))) for f in (sine, cosine))
    toward_moon = np.array([0.0, up, -away])
    half = float(sine(math.radians(0.5 * MOON)))

    def night(toward):
        along = normalize(toward)
        height = along[..., 1:2]
        thin = 1.0 / (1.0 + 4.0 * np.abs(height))
        sky = _ZENITH + _HAZE * (thin * thin)
        sky = np.where(height < 0.0, _DEEP * sky, sky)
        off = along - toward_moon
        return np.where((dot(off, off) < half * half)[..., None], brightness * _MOONLIGHT, sky)

    return night


def cube_edge(height):
    """Texels of the environment for a panel so many pixels high."""
    return 512 if height > 128 else 128


@lru_cache(maxsize=4)
def _environment(size, moon, brightness):
    return rough_mirrors.cube_pyramid(np.array(environments.faces(size, _night(moon, brightness))))


def environment(lake, size):
    """The night as a cube map and its mip-maps: a tuple of float64 [6, n, n, 3], n = ``size`` first."""
    return _environment(size, lake.moon, lake.brightness)


def camera(panel):
    """An eye at height one, that looks over the lake along -z and a little down."""
    return perspective_view(
        panel, (0.0, 1.0, 0.0), (0.0, 1.0 - DROP, -1.0), FIELD_OF_VIEW, radius=2.0 * REACH
    )


def _tangent(radians):
    return float(of_40_bits(math.tan(radians)))


def water(view, period):
    """The lake as a mesh for a machine: strips from below the picture's edge to the horizon."""
    rows = 32
    nearest = 0.5 / _tangent(math.radians(0.5 * FIELD_OF_VIEW) + DROP)
    growth = float(of_40_bits(math.exp(math.log(REACH / nearest) / rows)))
    half = 1.25 * view.panel.width / view.panel.height * _tangent(math.radians(0.5 * FIELD_OF_VIEW))
    distance = [nearest]
    for _ in range(rows):
        # Rounded to a sixteenth of itself or so: powers differ in their last bit between processors.
        distance.append(math.floor(distance[-1] * growth * 1024.0 + 0.5) / 1024.0)
    z = np.repeat(np.array(distance), 2)
    x = np.floor(z * half * 1024.0 + 0.5) / 1024.0 * np.tile([-1.0, 1.0], rows + 1)
    ones, zeros = np.ones(len(x)), np.zeros(len(x))
    corner = 2 * np.arange(rows)[:, None] + np.array([0, 1, 3, 0, 3, 2])
    return Surface(
        positions=np.stack([x, zeros, -z], axis=-1),
        normals=np.stack([zeros, ones, zeros], axis=-1),
        tangents=np.stack([ones, zeros, zeros], axis=-1),
        binormals=np.stack([zeros, zeros, -ones], axis=-1),
        texture_coordinates=np.stack([x, z], axis=-1) / period,
        triangles=corner.reshape(-1, 3),
    )


@lru_cache(maxsize=8)
def truth(lake, view):
    """256 samples a pixel, as a screen shows them, one at most: float64 [height, width, 3]."""
    levels, cube = pyramids(lake, TEXELS), environment(lake, cube_edge(view.panel.height))[0]
    out = rough_mirrors.supersampled(view, Mirror(period=lake.period), levels[0].offsets, cube)
    return np.minimum(out, 1.0)


@lru_cache(maxsize=16)
def answer(lake, view, antialiasing):
    """The lake antialiased in one way, as a screen shows it: float64 [height, width, 3]."""
    levels = pyramids(lake, TEXELS)
    cubes = environment(lake, cube_edge(view.panel.height))
    probes = PROBES if antialiasing is Antialiasing.ANISOTROPIC else 1
    mirror = Mirror(period=lake.period)
    return np.minimum(
        rough_mirrors.picture(view, mirror, levels, cubes, antialiasing, probes=probes, most=PROBES), 1.0
    )


# ----------------------------------------------------------------------------------------------- two ways


def shown(picture, panel, name, profile):
    """Commands that show a picture on a panel."""
    return (panel.clear(BACKGROUND), *show(factor_texels(picture, profile), panel, name, plane()))


@lru_cache(maxsize=4)
def _rough_cubes(moon, brightness, edge, roughness):
    cubes = _environment(edge, moon, brightness)
    frame = Mirror().frame
    return tuple(
        rough_mirror_passes.rough_cube(cubes, frame, deviation, edge // 4)
        for deviation in rough_mirror_passes.deviations(roughness)[1:]
    )


def load(lake, height, profile):
    """The commands that load waves and cube maps for texture shaders, and their Stored."""
    levels = rough_mirror_passes.with_curvature(pyramids(lake, TEXELS))
    names = (bumped_reflections.CUBE_MAP, *(f"night, roughness {k}" for k in range(1, 5)))
    stored = rough_mirror_passes.Stored("waves", names, *rough_mirror_passes.largest(levels))
    edge = cube_edge(height)
    smooth = np.minimum(environment(lake, edge)[0], 1.0)
    cubes = (smooth, *_rough_cubes(lake.moon, lake.brightness, edge, stored.roughness))
    return (
        *rough_mirror_passes.load_cubes(cubes, stored, profile),
        rough_mirror_passes.load_bumps(levels, stored, profile),
    ), stored


def drawn(lake, panel, stored, antialiasing):
    """Commands that draw night and lake on a panel by texture shaders."""
    view = camera(panel)
    surface = water(view, lake.period)
    reflected = draws(surface, stored, view, antialiasing, BIAS)
    return (panel.clear(BACKGROUND), *bumped_reflections.backdrop(view), *reflected)


SUBJECT = Subject(Lake, PARAMETERS, ASPECT, camera, truth, answer, shown, load, drawn)

# ------------------------------------------------------------------------------------- what is measured


def _rises(view, places):
    """By how much rays through the picture's middle rise for a step ahead, at ``places`` in pixels from
    below.
    """
    up = (2.0 * places / view.panel.height - 1.0) * math.tan(math.radians(0.5 * FIELD_OF_VIEW))
    return (up - DROP) / (1.0 + DROP * up)


def rows_of_water(view):
    """Rows of the picture that are water from edge to edge, as a slice: the first below, the last far."""
    return slice(0, int((_rises(view, np.arange(view.panel.height) + 1.0) < 0.0).sum()))


def far(view):
    """The farther sixth of these rows, as a slice."""
    last = rows_of_water(view).stop
    return slice(last - max(1, last // 6), last)


def fine_energy(picture, view):
    """The energy of changes along rows of water above half of Nyquist's frequency."""
    gray = picture[rows_of_water(view)].mean(axis=-1)
    spectrum = np.abs(np.fft.rfft(gray, axis=1))
    return float((spectrum[:, gray.shape[1] // 4 :] ** 2).sum())


def column(picture, view):
    """(length, width) of the column of glitter in pixels: rows and columns whose light above the row's median
    sums to at least half of the largest such sum.
    """
    gray = picture[rows_of_water(view)].mean(axis=-1)
    lighter = np.maximum(gray - np.median(gray, axis=1, keepdims=True), 0.0)
    return tuple(int((sums > 0.5 * sums.max()).sum()) for sums in (lighter.sum(axis=1), lighter.sum(axis=0)))


def mirrored_moon(view, moon):
    """(row, column) of the pixel where calm water shows the moon's middle, the moon ``moon`` degrees high."""
    rises = _rises(view, np.arange(view.panel.height) + 0.5)
    return int(np.abs(rises + math.tan(math.radians(moon))).argmin()), view.panel.width // 2
