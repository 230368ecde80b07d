"""F001-12 to F001-15: a flat plate whose bumps are ripples and letters, and the zebras that it mirrors.

Source: Schilling 1997, figures 12 to 15 (other zebras, other bumps; the catalogue's sizes).
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.environment_maps import environments, rough_mirror_passes, rough_mirrors
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing, Mirror
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.schilling_1997.shared.antialiased_panels import Subject, draws
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.samples import rays, sample_places
from fixedpipe.effects.geometry.surfaces import Surface, plane
from fixedpipe.effects.geometry.vectors import TRIGONOMETRY_STEP
from fixedpipe.effects.geometry.views import orthographic_view, perspective_view
from fixedpipe.effects.passes.combiners import PRIMARY, final, program
from fixedpipe.effects.passes.draws import draw, show
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.texture_filtering.stretched_writing import letters
from fixedpipe.pipeline.commands import Mesh

# Source: the catalogue, F001-14 and F001-15.
TEXELS, ROWS = 256, 256
WORD = "ZEBRA"
# Middles of ripples and how many there are to a period; how high letters stand beside a ripple's 0.05.
RIPPLES = (((0.25, 0.80), 26.0), ((0.77, 0.17), 34.0), ((0.10, 0.30), 21.0), ((0.60, 0.60), 30.0))
LETTERS = 0.08
# The row of texels that the word stands on.
BASELINE = 86
ASPECT, SIZE = (2, 1), 384
# The eye looks down by 17 degrees. It sees two zebras whole, which stand 7 to 25 degrees above the horizon.
EYE, CENTER, FIELD = (0.0, 1.05, 3.1), (0.0, 0.09, -0.1), 25.5
# The plate's edges in x and z, and how long a period of its bumps is. It reaches from 5 to 41 degrees below
# the horizon.
PLATE, PERIOD = (-3.6, 3.6, -8.0, 1.9), 0.3
LOW, HIGH = np.array((0.10, 0.16, 0.34)), np.array((0.86, 0.52, 0.30))

_SKY, _HAZE, _HILLS = np.array((0.30, 0.47, 0.76)), np.array((0.62, 0.70, 0.80)), np.array((0.34, 0.40, 0.50))
_GRASS, _NEAR = np.array((0.66, 0.56, 0.24)), np.array((0.36, 0.34, 0.14))
_WHITE, _BLACK = np.array((0.95, 0.94, 0.90)), np.array((0.08, 0.07, 0.08))
# Zebras: where they stand, s and t; how large, and which way they look. All stand on the grass.
ZEBRAS = (
    *((0.460, 0.540, 0.065, 1), (0.540, 0.540, 0.065, -1), (0.625, 0.552, 0.050, 1)),
    *((0.700, 0.538, 0.060, -1), (0.780, 0.555, 0.048, 1), (0.860, 0.535, 0.065, -1)),
    *((0.945, 0.552, 0.050, 1), (0.020, 0.538, 0.060, -1), (0.100, 0.555, 0.048, 1)),
    *((0.180, 0.535, 0.065, 1), (0.270, 0.552, 0.050, -1), (0.345, 0.538, 0.060, 1)),
)
# How far a zebra's hooves lie below its middle, in its own coordinates.
HOOVES = 1.25


def _ellipse(x, y, place, size, lean=0.0):
    """Where (x, y) lies in an ellipse; ``lean``: how much x grows with y."""
    u, v = (x - place[0] - lean * (y - place[1])) / size[0], (y - place[1]) / size[1]
    return u * u + v * v <= 1.0


def _stripes(phase):
    """Whether a phase is in the dark part of its period."""
    return phase - np.floor(phase) < 0.46


def _zebra(x, y):
    """(where a zebra is, where it is dark) in its own coordinates: body from -1 to 1, looking along x."""
    body = _ellipse(x, y, (0.0, 0.0), (0.95, 0.42))
    neck = _ellipse(x, y, (0.98, 0.52), (0.26, 0.52), 0.55)
    head = _ellipse(x, y, (1.42, 0.92), (0.36, 0.17), -0.6)
    ear = _ellipse(x, y, (1.20, 1.16), (0.07, 0.16), 0.2)
    legs = np.zeros(x.shape, bool)
    for place in (-0.72, -0.50, 0.52, 0.74):
        legs = legs | ((np.abs(x - place) <= 0.085) & (y < -0.15) & (y > -HOOVES))
    tail = _ellipse(x, y, (-1.04, -0.18), (0.06, 0.46), 0.25)
    dark = _stripes(np.where(body, 2.7 * x + 0.9 * y * y * np.sign(x), 3.0 * (y + 0.5 * x)))
    dark = np.where(legs & ~body, _stripes(6.0 * y), dark)
    muzzle = _ellipse(x, y, (1.66, 0.80), (0.13, 0.12))
    hooves = legs & (y < -1.14)
    return body | neck | head | ear | legs | tail, dark | muzzle | hooves | tail


def plain(s, t):
    """The zebras' plain by longitude and latitude, both from 0 to 1: RGB float64 [..., 3]. No function but
    floor: the same bits everywhere.
    """
    up = (t - 0.5)[..., None]
    one, two, three = (np.abs(2.0 * (count * s % 1.0) - 1.0)[..., None] for count in (3.0, 5.0, 13.0))
    colors = _HAZE + np.clip(2.4 * up, 0.0, 1.0) * (_SKY - _HAZE)
    colors = np.where(up < 0.085 + 0.02 * two + 0.012 * three, _HILLS, colors)
    # The grass is a long slope, with darker patches.
    patches = np.abs(2.0 * ((7.0 * s[..., None] + 23.0 * up + 0.4 * two) % 1.0) - 1.0)
    grass = (_GRASS + np.clip(0.3 - 3.0 * up, 0.0, 1.0) * (_NEAR - _GRASS)) * (0.93 + 0.07 * _smooth(patches))
    colors = np.where(up < 0.072 + 0.012 * one, grass, colors)
    for place, foot, size, looks in ZEBRAS:
        x = ((s - place + 0.5) % 1.0 - 0.5) * 2.0 / size * looks
        there, dark = _zebra(x * 1.7, (t - foot) / size * 1.7 - HOOVES)
        colors = np.where(there[..., None], np.where(dark[..., None], _BLACK, _WHITE), colors)
    return colors


@lru_cache(2)
def panorama(rows=ROWS):
    """The zebras as a map of longitude and latitude, sixteen samples a texel: float64 [rows, 2 rows, 3]."""
    s, t = np.meshgrid((np.arange(8 * rows) + 0.5) / (8 * rows), (np.arange(4 * rows) + 0.5) / (4 * rows))
    colors = plain(s, t)
    for _ in range(2):
        colors = (colors[0::2] + colors[1::2]) * 0.5
        colors = (colors[:, 0::2] + colors[:, 1::2]) * 0.5
    return colors


def _turns(y, x):
    turns = np.arctan2(y, x) / (2.0 * np.pi)
    return np.floor(turns / TRIGONOMETRY_STEP + 0.5) * TRIGONOMETRY_STEP


def seen(toward):
    """The panorama along directions [..., 3], bilinearly: RGB. -z is its middle."""
    x, y, z = np.moveaxis(toward, -1, 0)
    s, t = 0.5 + _turns(x, -z), 0.5 + 2.0 * _turns(y, np.sqrt(x * x + z * z))
    image = panorama()
    rows, columns = image.shape[:2]
    at_s, at_t = s * columns - 0.5, np.clip(t * rows - 0.5, 0.0, rows - 1.0)
    left, low = np.floor(at_s), np.minimum(np.floor(at_t), rows - 2.0)
    u, v = (at_s - left)[..., None], (at_t - low)[..., None]
    x0, y0 = left.astype(np.int64) % columns, low.astype(np.int64)
    x1, y1 = (x0 + 1) % columns, y0 + 1
    lower = image[y0, x0] * (1.0 - u) + image[y0, x1] * u
    return lower * (1.0 - v) + (image[y1, x0] * (1.0 - u) + image[y1, x1] * u) * v


@lru_cache(4)
def cubes(edge):
    """The zebras as a cube map and its mip-maps: a tuple of float64 [6, n, n, 3]."""
    return rough_mirrors.cube_pyramid(np.array(environments.faces(edge, seen)))


@lru_cache(2)
def relief():
    """Heights of F001-14, from 0 to 1: ripples about four places, and a word standing out of them."""
    s, t = height_fields.texel_centers(TEXELS, TEXELS)
    out = np.zeros((TEXELS, TEXELS))
    for place, count in RIPPLES:
        u, v = ((c - p + 0.5) % 1.0 - 0.5 for c, p in zip((s, t), place, strict=True))
        far = np.sqrt(u * u + v * v)
        wave, fade = np.abs(2.0 * (count * far % 1.0) - 1.0), np.clip(1.0 - 2.0 * far, 0.0, 1.0)
        # Smooth waves of triangles, which fade so that periods join.
        out += 1.3 / count * _smooth(wave) * _smooth(fade)
    ink = letters((WORD,))[0].astype(np.float64).repeat(12, axis=0).repeat(7, axis=1)
    raised, left = np.zeros((TEXELS, TEXELS)), (TEXELS - ink.shape[1]) // 2
    raised[BASELINE : BASELINE + ink.shape[0], left : left + ink.shape[1]] = ink
    return out + LETTERS * height_fields.smooth(raised, 12)


def _smooth(x):
    return x * x * (3.0 - 2.0 * x)


@dataclass(frozen=True)
class Plate:
    """The plate by PARAMETERS' names, which caches what is needed repeatedly."""

    slope: float
    strength: float
    period: float
    height_field: object = None
    height_scale: float = 0.0


@lru_cache(4)
def slopes(plate):
    """Offsets of F001-14, their deviation in one direction ``slope``: float64 [TEXELS, TEXELS, 2]."""
    if plate.height_field is not None:
        return rough.from_heights(
            plate.height_field.fitted(TEXELS, TEXELS, plate.height_scale, repeated=True)
        )[0].offsets
    levels = rough.from_heights(relief())
    a, _, c = levels[-1].covariance[0, 0].tolist()
    return levels[0].offsets * (plate.slope / math.sqrt(0.5 * (a + c)))


@lru_cache(4)
def pyramids(plate):
    """Both pyramids of the plate's bumps, which are F001-14's, scaled: a tuple of Level."""
    return rough.pyramid(plate.strength * slopes(plate))


def camera(panel):
    """An eye above the plate."""
    return perspective_view(panel, EYE, CENTER, FIELD, radius=9.0)


def cube_edge(size):
    """Texels of the environment for panels of ``size`` pixels."""
    return 256 if size > 64 else 64


def at(view):
    """Where the pixels of a view look, in turns: azimuth from -z to the right, and how far below the horizon,
    float64 [height, width] each. A flat plate mirrors the places that are as far above the horizon.
    """
    x, y = np.meshgrid(np.arange(view.panel.width) + 0.5, np.arange(view.panel.height) + 0.5)
    to = rays(view)[0] + x[..., None] * rays(view)[1] + y[..., None] * rays(view)[2]
    level = np.hypot(to[..., 0], to[..., 2])
    return np.arctan2(to[..., 0], -to[..., 2]) / (2.0 * np.pi), np.arctan2(-to[..., 1], level) / (2.0 * np.pi)


def stripes(image, view):
    """How much a panel of the plate changes from stripe to stripe on the bodies of the two middle zebras: the
    deviation of columns' mean brightness, of full.
    """
    right, down = at(view)
    bright, found = image.mean(axis=-1), []
    for place, foot, size, _ in ZEBRAS[:2]:
        body = 0.5 * (foot - 0.5 + HOOVES * size / 1.7)
        inside = (np.abs(right - (place - 0.5)) < 0.3 * size / 1.7) & (np.abs(down - body) < 0.1 * size / 1.7)
        count = inside.sum(axis=0)
        columns = (bright * inside).sum(axis=0)[count > 0] / count[count > 0]
        found.append(float(columns.std()))
    return min(found)


def coverage(view, side=4):
    """How much of each pixel is plate: float64 [height, width]."""
    ray, places = rays(view), sample_places(side)
    x, y = np.meshgrid(np.arange(view.panel.width), np.arange(view.panel.height))
    left, right, back, front = PLATE
    out = np.zeros(x.shape)
    for number in range(side * side):
        i, j = number % side, number // side
        at = places[(y * side + j) & 255, (x * side + i) & 255]
        wx, wy = x + (i + at[..., 0]) / side, y + (j + at[..., 1]) / side
        to = (ray[0] + wx[..., None] * ray[1]) + wy[..., None] * ray[2]
        along = -view.eye[1] / np.where(to[..., 1] < 0.0, to[..., 1], -1.0)
        px, pz = view.eye[0] + along * to[..., 0], view.eye[2] + along * to[..., 2]
        out += (to[..., 1] < 0.0) & (px >= left) & (px <= right) & (pz >= back) & (pz <= front)
    return out / (side * side)


def ramp(view):
    """The background: a ramp of colours from below to above, float64 [height, width, 3]."""
    t = ((np.arange(view.panel.height) + 0.5) / view.panel.height)[:, None, None]
    return np.broadcast_to(LOW + t * (HIGH - LOW), (view.panel.height, view.panel.width, 3))


def behind(view, picture):
    """A picture of the plate with the ramp where there is none."""
    share = coverage(view)[..., None]
    return share * picture + (1.0 - share) * ramp(view)


@lru_cache(8)
def truth(plate, view):
    """256 samples a pixel: float64 [height, width, 3]."""
    cube = cubes(cube_edge(view.panel.height))[0]
    mirror = Mirror(period=plate.period)
    return behind(view, rough_mirrors.supersampled(view, mirror, pyramids(plate)[0].offsets, cube))


@lru_cache(16)
def answer(plate, view, antialiasing):
    """The plate antialiased in one way: float64 [height, width, 3]."""
    probes = 8 if antialiasing is Antialiasing.ANISOTROPIC else 1
    mirror, cube = Mirror(period=plate.period), cubes(cube_edge(view.panel.height))
    return behind(
        view, rough_mirrors.picture(view, mirror, pyramids(plate), cube, antialiasing, probes=probes)
    )


# ------------------------------------------------------------------------------------------------- two ways


def shown(picture, panel, name, profile):
    """Commands that show a picture on a panel."""
    return (panel.clear((0.0, 0.0, 0.0)), *show(factor_texels(picture, profile), panel, name, plane()))


def _backdrop(view):
    """The ramp behind the plate, by colours of vertices."""
    half_width = view.panel.width / view.panel.height
    seen_flat = orthographic_view(view.panel)
    colors = np.array([LOW, LOW, HIGH, HIGH])
    corners = np.array([(-half_width, -1.0), (half_width, -1.0), (half_width, 1.0), (-half_width, 1.0)])
    mesh = Mesh(
        positions=np.concatenate([corners, np.zeros((4, 1))], axis=1),
        indices=np.array([0, 1, 2, 0, 2, 3]),
        colors=colors,
    )
    return draw("a ramp of colours", mesh, seen_flat, program(final(PRIMARY)), (), depth_test=None)


def _mesh(period, cells):
    """The plate as a mesh for a machine."""
    left, right, back, front = PLATE
    s, t = (a.ravel() for a in np.meshgrid(*(np.arange(cells + 1) / cells,) * 2))
    x, z = left + s * (right - left), front + t * (back - front)
    ones, zeros = np.ones(len(x)), np.zeros(len(x))
    column, row = (a.ravel() for a in np.meshgrid(np.arange(cells), np.arange(cells)))
    corner = (row * (cells + 1) + column)[:, None] + np.array([0, 1, cells + 2, 0, cells + 2, cells + 1])
    return Surface(
        positions=np.stack([x, zeros, z], axis=-1),
        normals=np.stack([zeros, ones, zeros], axis=-1),
        tangents=np.stack([ones, zeros, zeros], axis=-1),
        binormals=np.stack([zeros, zeros, -ones], axis=-1),
        texture_coordinates=np.stack([x, -z], axis=-1) / period,
        triangles=corner.reshape(-1, 3),
    )


@lru_cache(2)
def _rough_cubes(edge, roughness):
    frame = Mirror().frame
    return tuple(
        rough_mirror_passes.rough_cube(cubes(edge), frame, deviation, edge)
        for deviation in rough_mirror_passes.deviations(roughness)[1:]
    )


def load(plate, height, profile):
    """The commands that load bumps and cube maps for texture shaders, and their Stored."""
    levels = rough_mirror_passes.with_curvature(pyramids(plate))
    names = ("zebras", *(f"zebras, roughness {k}" for k in range(1, rough_mirror_passes.ROUGHNESSES)))
    stored = rough_mirror_passes.Stored("bumps", names, *rough_mirror_passes.largest(levels))
    edge = cube_edge(height)
    maps = (cubes(edge)[0], *_rough_cubes(edge, stored.roughness))
    return (
        *rough_mirror_passes.load_cubes(maps, stored, profile),
        rough_mirror_passes.load_bumps(levels, stored, profile),
    ), stored


def drawn(plate, panel, stored, antialiasing):
    """Commands that draw ramp and plate on a panel by texture shaders."""
    view = camera(panel)
    surface = _mesh(plate.period, 4 if panel.height < 128 else 16)
    reflected = draws(surface, stored, view, antialiasing)
    return (panel.clear((0.0, 0.0, 0.0)), _backdrop(view), *reflected)


PARAMETERS = {
    "slope": word.of(word.Number(0.01, 1.0), 0.3, "The deviation of the bump map's slopes in one direction."),
    "strength": word.of(word.Number(0.0, 2.0), 1.0 / 60.0, "What the plate's slopes are of the map's."),
    "period": word.of(word.Number(0.05, 4.0), PERIOD, "How long the square of bumps is.", "world units"),
    "height_field": own_maps.height_field("ripples and letters"),
    "height_scale": own_maps.HEIGHT_SCALE(0.05),
}

SUBJECT = Subject(Plate, PARAMETERS, ASPECT, camera, truth, answer, shown, load, drawn)
