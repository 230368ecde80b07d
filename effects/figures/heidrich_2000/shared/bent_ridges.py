"""Ridges with two flanks of different colour, as a strip on a bent or stretched base.

The module computes their light, by stored visibility and by rays among the bent triangles, and their mesh. It
also measures each flank in a picture.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from fixedpipe.effects.acceptance.bent_caster import BentCaster
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.diagrams.drawing import project
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cosine, from_frame, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import curved_base, height_field, visibility
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.textures.images import texture_2d

# The strip's width across the ridges and half its length along them, in periods of a field that is not
# stretched.
_ACROSS, _ALONG = 3.0, 1.5
# How far the body's cut reaches below the valleys, in periods.
_BODY = 0.12
_BODY_COLOR = (0.20, 0.21, 0.24)
# Rays of the truth at every texel, and its texels for one of the figure's: shadows by rays end at texels.
_RAYS, FINER = 800, 4
# Parts of a texel that a light reaches or does not, and how many periods on a crest may hide it.
_PARTS, _CRESTS = 8, 1
# Inferred: points of one straight flank lie on a ray along it but for rounding, of about 2^-52.
_ON_THE_RAY = 2.0**-40


@dataclass(frozen=True)
class Ridges:
    """One ridge a period: from its crest a flank falls and faces +x, from the valley another climbs.

    texels  of a period
    left    albedo of the flank that faces -x, on the right of a valley
    right   albedo of the flank that faces +x, on the left of a valley
    climb   the period's share that the flank takes that faces -x
    height  from valley to crest, in periods
    """

    texels: int
    left: tuple[float, float, float] = (1.0, 1.0, 1.0)
    right: tuple[float, float, float] = (1.0, 1.0, 1.0)
    climb: float = 0.5
    height: float = 0.5

    @property
    def fallen(self) -> int:
        """Texels of the flank that faces +x, which are the first ones."""
        return self.texels - round(self.climb * self.texels)

    @property
    def lengths(self) -> tuple[float, float]:
        """Of the flanks that face -x and +x, in periods."""
        return math.hypot(self.climb, self.height), math.hypot(1.0 - self.climb, self.height)

    def field(self, finer=1):
        """The HeightField, with ``finer`` times the texels. Its heights are measured from their middle: a
        bend then makes a flank as much steeper below as flatter above.
        """
        return _field(self, finer)


@cache
def _field(ridges, finer):
    columns = finer * ridges.texels
    at, fall = (np.arange(columns) + 0.5) / columns, 1.0 - ridges.climb
    falls, h = at < fall, ridges.height
    heights = np.where(falls, (fall - at) / fall, (at - fall) / ridges.climb) * h
    slope = np.where(falls, h / fall, -h / ridges.climb)
    normals = normalize(np.stack([slope, 0.0 * slope, np.ones(columns)], axis=-1))
    albedo = np.where(falls[:, None], ridges.right, ridges.left)
    heights, normals, albedo = (
        np.tile(row[None], (2, *[1] * row.ndim)) for row in (heights - 0.5 * h, normals, albedo)
    )
    return height_field.height_field(heights, albedo, normals=normals)


def lamp(angle):
    """The direction to the light, ``angle`` degrees from the base's normal, towards +x."""
    return np.array([float(sine(math.radians(angle))), 0.0, float(cosine(math.radians(angle)))])


@cache
def lit_share(ridges, base, light):
    """The share of each texel that a distant light reaches: float64 [2, texels].

    The light is ``light`` degrees from the base's normal at each texel. A part of a texel is lit if no point
    of the bent profile, up to the crest after the next, rises above the way to the light.
    """
    heights = ridges.field(_PARTS).heights[0]
    n = len(heights)
    x = (np.arange((1 + _CRESTS) * n) + 0.5) / n - 0.5
    points = base.placed(np.stack([x, 0.0 * x, np.tile(heights, 1 + _CRESTS)], axis=-1))
    ways = from_frame(np.broadcast_to(lamp(light), (n, 3)), *base.frames(x[:n], 0.0 * x[:n]))
    out = np.empty(n)
    for k, way in enumerate(ways):
        beyond = points[k + 1 :] - points[k]
        out[k] = (way[0] * beyond[:, 2] - way[2] * beyond[:, 0] <= _ON_THE_RAY).all()
    return np.tile(out.reshape(-1, _PARTS).mean(axis=1), (2, 1))


@cache
def radiance(ridges, base, directions, light, count):
    """The light that the texels send with ``count`` reflections, by stored visibility: float64 [2, texels,
    3].
    """
    field = ridges.field()
    seen = visibility.precompute(field, spiral(directions))
    bent = curved_base.bend(field, seen, base)
    return curved_base.bounces(field, bent, lamp(light), count, lit_share(ridges, base, light))[-1]


@cache
def radiance_by_rays(ridges, base, light, count):
    """The same by rays among the bent triangles from crest to crest, with ``FINER`` times the texels: float64
    [2, n, 3].
    """
    field = ridges.field(FINER)
    caster = BentCaster(field, base, (0, 6))
    bent = caster.bent(spiral(_RAYS))
    return curved_base.bounces(field, bent, lamp(light), count, caster.lit(lamp(light)))[-1]


def strip(ridges, base):
    """The mesh of the ridges, and of the cut below its near edge: two Surfaces. A valley is in its middle."""
    field, texels = ridges.field(), ridges.texels
    periods, rows = round(_ACROSS / base.stretch[0]), round(2 * _ALONG)
    # From crest to crest, or from valley to valley where the valleys are even in number.
    first = -(periods // 2) * texels + (0 if periods % 2 else ridges.fallen)
    middle = ridges.fallen / texels
    top = curved_base.bent_surface(
        field, base, (first, first + periods * texels - 1), (-rows, rows - 1), (middle, 0.0)
    )
    n = periods * texels
    edge = top.positions[:n]
    x = (first + np.arange(n) + 0.5) / texels - middle
    y = np.full_like(x, edge[0, 1] / base.stretch[1])
    floor = base.placed(np.stack([x, y, np.full_like(x, field.heights.min() - _BODY)], axis=-1))
    k = np.arange(n - 1)
    quads = np.stack([k, k + 1, k + 1 + n, k, k + 1 + n, k + n], axis=-1)
    flat = np.zeros((2 * n, 3))
    cut = Surface(np.concatenate([floor, edge]), flat, flat, flat, np.zeros((2 * n, 2)), quads.reshape(-1, 3))
    return top, cut


def along(panel):
    """A View along the ridges from above."""
    return perspective_view(panel, (0.0, -5.0, 6.4), (0.0, -0.08, 0.02), 24.0, 4.0)


def aside(panel):
    """A View along the ridges from above, from the side to which the flanks on the right of valleys look."""
    return perspective_view(panel, (-2.3, -4.5, 5.9), (-0.13, -0.07, 0.0), 26.5, 4.0)


def cut_draw(cut, view):
    """The Draw of the cut below a ``strip``."""
    colors = np.tile(np.array(_BODY_COLOR), (len(cut.positions), 1))
    body = Mesh(positions=cut.positions, indices=cut.triangles.ravel(), colors=colors)
    return draw("the cut below them", body, view, None, depth_test=FIRST_PASS)


def commands(profile, size, ridges, bases, lights, camera=along):
    """A panel for each base: its light [2, texels, 3] is a texture on the ridges that the machine draws.
    ``camera`` makes a panel's View.
    """
    out = []
    for number, (panel, base, lit) in enumerate(
        zip(row_of_panels(len(bases), size), bases, lights, strict=True), 1
    ):
        view, name = camera(panel), f"light {number}"
        top, cut = strip(ridges, base)
        image = texture_2d(factor_texels(np.minimum(lit, 1.0), profile))
        units = (unit(name, REPEATED, environment=REPLACE),)
        out += [
            panel.clear(BACKGROUND),
            TexImage(label=f"load {name}", texture=name, image=image),
            draw(f"ridges, {name}", top.mesh(), view, None, units, depth_test=FIRST_PASS),
            cut_draw(cut, view),
        ]
    return tuple(out)


def picture_by_rays(size, ridges, bases, lights, camera=along, nearest=False):
    """The same row of panels by rays: RGBA float64 [size, panels * size, 4], top row first.
    ``lights`` may have more texels than the mesh; ``nearest``: they are not filtered.
    """
    out = np.ones((size, len(bases) * size, 4))
    for panel, base, lit in zip(row_of_panels(len(bases), size), bases, lights, strict=True):
        parts = strip(ridges, base)
        corners = [part.positions[part.triangles] for part in parts]
        caster = RayCaster(
            np.concatenate(corners), np.repeat((0, 1), [len(triangles) for triangles in corners])
        )
        hits = caster.nearest(*primary_rays(camera(panel)), 1.0)
        at = np.concatenate([part.texture_coordinates[part.triangles] for part in parts])[hits.triangle]
        at = (at[..., 0] * hits.barycentrics).sum(axis=-1) * lit.shape[1] - 0.5
        first = np.floor(at).astype(np.int64)
        share = np.floor(at - first + 0.5)[:, None] if nearest else (at - first)[:, None]
        color = (1.0 - share) * lit[0, first % lit.shape[1]] + share * lit[0, (first + 1) % lit.shape[1]]
        color[caster.objects[hits.triangle] == 1] = _BODY_COLOR
        color[hits.triangle < 0] = BACKGROUND
        out[::-1, panel.x : panel.x + size, :3] = np.minimum(color, 1.0).reshape(size, size, 3)
    return out


def flank_colors(image, ridges, bases, left=True, camera=along):
    """The colours of the middle valley's flank that faces -x, or +x, in a window of each panel, from the
    valley upwards: list of float64 [n, 3]. Texels are read at their centres. Those at the flank's ends are
    left out, because the filter mixes their colour with the other flank's.
    """
    out, field, fallen = [], ridges.field(), ridges.fallen
    at = np.arange(fallen + 1, ridges.texels - 1) if left else np.arange(fallen - 2, 0, -1)
    x = (at + 0.5 - fallen) / ridges.texels
    for number, (panel, base) in enumerate(
        zip(row_of_panels(len(bases), image.shape[0]), bases, strict=True)
    ):
        points = base.placed(np.stack([x, 0.0 * x, field.heights[0, at]], axis=-1))
        places = np.floor(project(camera(panel), points)[:, :2]).astype(int)
        out.append(panel_of(image, number)[places[:, 1], places[:, 0]])
    return out


def flank_means(image, ridges, bases, left=True, camera=along):
    """The mean colour of each panel's ``flank_colors``: list of float64 [3]."""
    return [colors.mean(axis=0) for colors in flank_colors(image, ridges, bases, left, camera)]


@cache
def lit_by_rays(ridges, base, light):
    """Which texels the light reaches, by rays from crest to crest, with ``FINER`` times the texels: float64
    [2, n], 0 or 1.
    """
    return BentCaster(ridges.field(FINER), base, (0, 6)).lit(lamp(light))
