"""A ball with ridges along its parallels, one flank red and one white: as geometry, as a bump map, as a BRDF.

Each ridge takes the same share of a meridian. Its field (``height_field.ridges``) stands in the local frame
of the ridge's middle: s to the north, t to the west, z outward. So one small field, its visibility and the
light's direction in that frame are enough.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cosine, cross, dot, normalize, sine, unit_vector
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import colors_of, factor_texels
from fixedpipe.effects.scattering import goniometer, height_field, visibility
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

# Texels of a ridge in the texture of light and where its BRDF is simulated, which shows the steps of shadows
# that end at texels on a whole belt; and rows of its field, which are all alike.
TEXELS, FINE_TEXELS, ROWS = 32, 64, 2
# Meridians over the half that is seen at which light is computed: a power of two.
MERIDIANS = 32
# Of a panel's half edge, the ball's mean radius.
EXTENT = 0.9
LUMINANCE = (0.299, 0.587, 0.114)

PARAMETERS = {
    "light": word.LIGHT((-0.28, 0.57, 0.77)),
    "red": word.COLOR((0.9, 0.45, 0.3), "The albedo of the flanks that look down."),
    "white": word.COLOR((0.95, 0.95, 0.95), "The albedo of the flanks that look up."),
    "angle": word.NUMBER(60.0, "How steep the flanks are.", "degrees", low=5.0, high=75.0),
    "ridges": word.of(word.Whole(4, 64, power=True), 32, "Ridges from pole to pole."),
    "bounces": word.of(word.Whole(1, 16), 4, "Reflections beyond the first where light is scattered."),
    "directions": word.of(word.Whole(20, 1000), 200, "Directions along which light is gathered."),
    "intensity": word.NUMBER(
        0.75, "The light's, 1 = a white surface that faces it is full.", low=0.0, high=4.0
    ),
}


@dataclass(frozen=True)
class Body:
    """The parameters of the pictures of one ball, as values that can be compared."""

    light: tuple[float, ...]
    red: tuple[float, ...]
    white: tuple[float, ...]
    angle: float
    ridges: int
    bounces: int
    directions: int
    intensity: float

    @property
    def relief(self):
        """The ridges' height in radii of the ball: half a period times the flanks' slope."""
        radians = math.radians(self.angle)
        return math.pi / self.ridges / 2.0 * float(sine(radians)) / float(cosine(radians))


@lru_cache(maxsize=8)
def _field(body, texels):
    field = height_field.ridges(texels, ROWS, body.angle, 1, body.red, body.white)
    return field, visibility.precompute(field, spiral(body.directions))


def frames(latitude, longitude):
    """Outward normal, north and west at places of the unit ball, angles [...]: three float64 [..., 3]."""
    sin_lat, cos_lat, sin_lon, cos_lon = sine(latitude), cosine(latitude), sine(longitude), cosine(longitude)
    normal = np.stack([cos_lat * sin_lon, sin_lat, cos_lat * cos_lon], axis=-1)
    north = np.stack([-sin_lat * sin_lon, cos_lat, -sin_lat * cos_lon], axis=-1)
    return normalize(normal), normalize(north), normalize(cross(normal, north))


def _local(vector, normal, north, west):
    """A direction of the world in frames [n, 3], and where it is above the horizon there: [n, 3], bool [n].
    What is not is the zenith's.
    """
    found = np.stack([dot(north, vector), dot(west, vector), dot(normal, vector)], axis=-1)
    above = found[:, 2] > 1e-3
    return normalize(np.where(above[:, None], found, (0.0, 0.0, 1.0))), above


def _lights(body, texels, frame, bounces):
    """What the field's texels send at places with these frames: float64 [n, ROWS, texels, 3]."""
    field, seen = _field(body, texels)
    light, above = _local(unit_vector(body.light, "The light's direction"), *frame)
    sent = goniometer.lights(field, seen, light, bounces)
    return sent * (body.intensity * above)[:, None, None, None]


@lru_cache(maxsize=8)
def radiance_map(body, bounces):
    """The light that the ball's texels send, float64 [MERIDIANS, ridges * TEXELS, 3]: rows from west to east
    over the half that is seen, columns from the south pole to the north pole.
    """
    latitude = math.pi * ((np.arange(body.ridges) + 0.5) / body.ridges - 0.5)
    longitude = math.pi * ((np.arange(MERIDIANS) + 0.5) / MERIDIANS - 0.5)
    frame = frames(*(axis.ravel() for axis in np.meshgrid(latitude, longitude)))
    sent = _lights(body, TEXELS, frame, bounces)[:, 0]
    return np.ascontiguousarray(sent.reshape(MERIDIANS, body.ridges * TEXELS, 3))


def _half_ball(latitude, radius, place, pieces):
    """The half of the ball that is seen, of belts between latitudes [belts, 2] at radii [belts, 2] whose
    texture coordinate s is ``place`` [belts, 2].
    """
    longitude = math.pi * (np.arange(pieces + 1) / pieces - 0.5)
    belts = len(latitude)
    corners = (belts, 2, pieces + 1)
    lat = np.broadcast_to(latitude[..., None], corners).ravel()
    normal, north, west = frames(lat, np.broadcast_to(longitude, corners).ravel())
    t = np.broadcast_to(np.arange(pieces + 1) / pieces, corners).ravel()
    s = np.broadcast_to(place[..., None], corners).ravel()
    positions = normal * np.broadcast_to(radius[..., None], corners).ravel()[:, None]
    first = (np.arange(belts) * 2 * (pieces + 1))[:, None] + np.arange(pieces)
    a, b, c, d = first, first + 1, first + pieces + 2, first + pieces + 1
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return Surface(positions, normal, -west, north, np.stack([s, t], axis=-1), triangles)


def segments(size):
    """How many pieces a parallel's half has on a panel of ``size`` pixels."""
    return int(min(max(size // 8, 8), 48))


def _radii(body, share):
    """Of the valleys and the crests, where so much of the relief is there: the mean is EXTENT."""
    half = 0.5 * share * body.relief
    return np.array([1.0 - half, 1.0 + half]) * EXTENT


def _corners(body, pieces):
    """Latitudes of the smooth ball's parallels, pole to pole, and longitudes of its meridians."""
    belts = 2 * body.ridges
    return (math.pi * (np.arange(count + 1) / count - 0.5) for count in (belts, pieces))


def displaced(body, size, share=1.0):
    """The ball as geometry: two belts for each ridge, one up to the crest and one down, with ``share`` of the
    ridges' height; a share of zero is the smooth ball.
    """
    belts = 2 * body.ridges
    place = np.stack([np.arange(belts), np.arange(1, belts + 1)], axis=-1) / belts
    radii = _radii(body, share)
    radius = np.tile([radii, radii[::-1]], (body.ridges, 1))
    return _half_ball(math.pi * (place - 0.5), radius, place, segments(size))


def smooth(body, size):
    """The ball without its ridges, of as many belts."""
    return displaced(body, size, 0.0)


def load(body, bounces, name, profile):
    """The command that loads the light of the ball's texels as a texture."""
    texels = factor_texels(radiance_map(body, bounces), profile)
    return TexImage(label=f"load the light of the texels, {name}", texture=name, image=texture_2d(texels))


@lru_cache(maxsize=8)
def _mean_map(body, eye):
    """What ``radiance_map`` has, by the BRDF: its mean as seen from ``eye``, linear between ridges."""
    latitude = math.pi * ((np.arange(body.ridges) + 0.5) / body.ridges - 0.5)
    longitude = math.pi * ((np.arange(MERIDIANS) + 0.5) / MERIDIANS - 0.5)
    frame = frames(*(axis.ravel() for axis in np.meshgrid(latitude, longitude)))
    found = _seen_radiance(body, frame, body.bounces, eye).reshape(MERIDIANS, body.ridges, 3)
    place = np.clip((np.arange(body.ridges * TEXELS) + 0.5) / TEXELS - 0.5, 0.0, body.ridges - 1.0)
    low = np.minimum(np.floor(place).astype(np.int64), body.ridges - 2)
    share = (place - low)[:, None]
    return found[:, low] * (1.0 - share) + found[:, low + 1] * share


def load_level(body, view, share, name, profile):
    """``load`` of light that is scattered, ``share`` of it by the BRDF, the rest the texels'."""
    texels = factor_texels(level(body, share, view.eye), profile)
    return TexImage(label=f"load {name}", texture=name, image=texture_2d(texels))


def textured(label, surface, view, name):
    """Geometry or the smooth ball with the light of the texels as its texture."""
    return draw(
        label, surface.mesh(), view, None, (unit(name, EDGE, environment=REPLACE),), depth_test=FIRST_PASS
    )


def by_rays(body, size, share, light):
    """Which of a panel's pixels show the ball with ``share`` of its ridges' height, by rays: bool [size,
    size]; and the texture of ``light`` there: [n, 3].
    """
    seen = seen_places.surface(displaced(body, size, share), orthographic_view(Panel(0, 0, size, size)))
    return seen.where, seen_places.looked_up(light, seen)


def level(body, share, eye):
    """The light that is scattered, ``share`` of it by the BRDF, the rest the texels': float64 [rows, columns,
    3].
    """
    light = radiance_map(body, body.bounces)
    return light * (1.0 - share) + _mean_map(body, eye) * share if share > 0.0 else light


def _seen_radiance(body, frame, bounces, eye, texels=FINE_TEXELS):
    """f_r(l, v) pi times the light's cosine and intensity at places with these frames: float64 [n, 3]."""
    view, above = _local(np.array(eye), *frame)
    sent = _lights(body, texels, frame, bounces)
    # Places that are seen edge-on have no view of their own, and cover nothing.
    shares = goniometer.shares_in_texture_space(_field(body, texels)[0], view) * above[:, None, None]
    return goniometer.pair_means(shares, sent)


@lru_cache(maxsize=8)
def _vertex_radiance(body, size, bounces, eye, texels):
    latitude, longitude = _corners(body, segments(size))
    frame = frames(*(axis.ravel() for axis in np.meshgrid(latitude, longitude, indexing="ij")))
    found = _seen_radiance(body, frame, bounces, eye, texels).reshape(len(latitude), len(longitude), 3)
    # As ``smooth`` has its vertices: every belt has both of its parallels.
    return np.stack([found[:-1], found[1:]], axis=1).reshape(-1, 3)


def reflected(label, body, bounces, surface, view, profile, size, texels=FINE_TEXELS):
    """The smooth ball by the simulated BRDF, f_r(l, v) cosine pi at every vertex in its own frame; ``texels``
    of a ridge where the BRDF is simulated.
    """
    radiance = _vertex_radiance(body, size, bounces, view.eye, texels)
    colors = colors_of(factor_texels(radiance, profile))
    return draw(label, surface.mesh(colors=colors), view, None, depth_test=FIRST_PASS)


def regions(size, half_height):
    """Pixels of a panel, bool [size, size] each: above and below, where the paper's text compares colours,
    and the whole ball but its rim.
    """
    edge = ((np.arange(size) + 0.5) / size * 2.0 - 1.0) * half_height / EXTENT
    x, y = np.meshgrid(edge, edge)
    middle = np.abs(x) < 0.35
    return middle & (y > 0.4) & (y < 0.8), middle & (y > -0.2) & (y < 0.15), x * x + y * y < 0.9


def region_mean(panel, region):
    """Mean RGB of a panel [size, size, 3] over a region."""
    return panel[region].mean(axis=0)


def luminance(color):
    """Of RGB [3]."""
    return sum(weight * float(c) for weight, c in zip(LUMINANCE, color, strict=True))
