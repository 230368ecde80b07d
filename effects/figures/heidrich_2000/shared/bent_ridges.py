"""Ridges with two flanks of different colour, as a strip on a bent or stretched base.

The module has their light by stored visibility and by rays among the bent triangles, their mesh, and measures
of each flank in a picture.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.effects.acceptance.bent_caster import BentCaster
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.diagrams.drawing import project
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import curved_base, height_field, visibility
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.textures.images import texture_2d

# How far the strip reaches to either side of the valley in the middle, across the ridges in whole halves of
# periods and along them, in periods of a field that is not stretched.
_ACROSS, _ALONG = 1.5, 1.0
# How far the body's cut reaches below the valleys, in periods.
_BODY = 0.25
_BODY_COLOR = (0.20, 0.21, 0.24)
FLANKS = 45.0
# Rays of the truth at every texel, and its texels for one of the figure's: shadows by rays end at texels.
_RAYS, FINER = 800, 4


def ridges(texels, left, right):
    """One ridge a period, its heights measured from their middle: a bend then makes a flank as much steeper
    below as flatter above. ``left``, ``right``: albedo of the flanks that face -x and +x.
    """
    field = height_field.ridges(texels, 2, FLANKS, 1, left, right)
    return replace(field, heights=field.heights - 0.5 * (field.heights.min() + field.heights.max()))


def lamp(angle):
    """The direction to the light, ``angle`` degrees from the base's normal, towards +x."""
    return np.array([float(sine(math.radians(angle))), 0.0, float(cosine(math.radians(angle)))])


@cache
def radiance(base, texels, directions, light, count, left, right):
    """What the texels send with ``count`` reflections, by visibility that is kept: float64 [2, texels, 3]."""
    field = ridges(texels, left, right)
    seen = visibility.precompute(field, spiral(directions))
    bent = curved_base.bend(field, seen, base)
    return curved_base.bounces(field, bent, lamp(light), count)[-1]


@cache
def radiance_by_rays(base, texels, light, count, left, right):
    """The same by rays among the bent triangles, with ``FINER`` times the texels: float64 [2, n, 3]."""
    field = ridges(FINER * texels, left, right)
    caster = BentCaster(field, base, (2, 6))
    bent = caster.bent(spiral(_RAYS))
    return curved_base.bounces(field, bent, lamp(light), count, caster.lit(lamp(light)))[-1]


def strip(base, texels):
    """The mesh of the ridges, and of the cut below its near edge: two Surfaces."""
    field = ridges(texels, 1.0, 1.0)
    half = round(2.0 * _ACROSS / base.stretch[0]) * texels // 2
    rows = round(2 * _ALONG)
    top = curved_base.bent_surface(field, base, (-half, half - 1), (-rows, rows - 1), (0.0, 0.0))
    edge = top.positions[: 2 * half]
    x = (np.arange(-half, half) + 0.5) / texels
    y = np.full_like(x, edge[0, 1] / base.stretch[1])
    floor = base.placed(np.stack([x, y, np.full_like(x, field.heights.min() - _BODY)], axis=-1))
    k = np.arange(2 * half - 1)
    quads = np.stack([k, k + 1, k + 1 + 2 * half, k, k + 1 + 2 * half, k + 2 * half], axis=-1)
    flat = np.zeros((4 * half, 3))
    cut = Surface(
        np.concatenate([floor, edge]), flat, flat, flat, np.zeros((4 * half, 2)), quads.reshape(-1, 3)
    )
    return top, cut


def camera(panel):
    """Along the ridges from above."""
    return perspective_view(panel, (0.0, -6.2, 5.0), (0.0, -0.12, 0.02), 25.5, 4.0)


def commands(profile, size, bases, lights):
    """A panel for each base: its light [2, texels, 3] is a texture on the ridges that the machine draws."""
    out = []
    for number, (panel, base, lit) in enumerate(
        zip(row_of_panels(len(bases), size), bases, lights, strict=True), 1
    ):
        view, name = camera(panel), f"light {number}"
        top, cut = strip(base, lit.shape[1])
        body = Mesh(
            positions=cut.positions,
            indices=cut.triangles.ravel(),
            colors=np.tile(np.array(_BODY_COLOR), (len(cut.positions), 1)),
        )
        image = texture_2d(factor_texels(np.minimum(lit, 1.0), profile))
        units = (unit(name, REPEATED, environment=REPLACE),)
        out += [
            panel.clear(BACKGROUND),
            TexImage(label=f"load {name}", texture=name, image=image),
            draw(f"ridges, {name}", top.mesh(), view, None, units, depth_test=FIRST_PASS),
            draw("the cut below them", body, view, None, depth_test=FIRST_PASS),
        ]
    return tuple(out)


def picture_by_rays(size, bases, texels, lights):
    """The same row of panels by rays: RGBA float64 [size, panels * size, 4], top row first.

    texels  as the mesh has them; ``lights`` may have more
    """
    out = np.ones((size, len(bases) * size, 4))
    for panel, base, lit in zip(row_of_panels(len(bases), size), bases, lights, strict=True):
        parts = strip(base, texels)
        corners = [part.positions[part.triangles] for part in parts]
        caster = RayCaster(
            np.concatenate(corners), np.repeat((0, 1), [len(triangles) for triangles in corners])
        )
        hits = caster.nearest(*primary_rays(camera(panel)), 1.0)
        at = np.concatenate([part.texture_coordinates[part.triangles] for part in parts])[hits.triangle]
        at = (at[..., 0] * hits.barycentrics).sum(axis=-1) * lit.shape[1] - 0.5
        first = np.floor(at).astype(np.int64)
        share = (at - first)[:, None]
        color = (1.0 - share) * lit[0, first % lit.shape[1]] + share * lit[0, (first + 1) % lit.shape[1]]
        color[caster.objects[hits.triangle] == 1] = _BODY_COLOR
        color[hits.triangle < 0] = BACKGROUND
        out[::-1, panel.x : panel.x + size, :3] = np.minimum(color, 1.0).reshape(size, size, 3)
    return out


def flank_means(image, bases, texels, left=True):
    """The mean colour of the middle valley's flank that faces -x, or +x, in a window of each panel: list of
    float64 [3]. Texels are read at their centres, but for those at the flank's ends, whose colour the filter
    mixes with the other flank's.
    """
    out = []
    for number, (panel, base) in enumerate(
        zip(row_of_panels(len(bases), image.shape[0]), bases, strict=True)
    ):
        field = ridges(texels, 1.0, 1.0)
        at = np.arange(1, texels // 2 - 1) if left else np.arange(texels // 2 + 1, texels - 1)
        x = (at + 0.5) / texels - (0.0 if left else 1.0)
        points = base.placed(np.stack([x, 0.0 * x, field.heights[0, at]], axis=-1))
        places = np.floor(project(camera(panel), points)[:, :2]).astype(int)
        out.append(panel_of(image, number)[places[:, 1], places[:, 0]].mean(axis=0))
    return out


@computed_once
def lit_by_rays(base, texels, light):
    """Which texels the light reaches, by rays, with ``FINER`` times the texels."""
    return BentCaster(ridges(FINER * texels, 1.0, 1.0), base, (2, 6)).lit(light)


@computed_once
def lit_by_kept(base, texels, directions, light):
    """How much of the light reaches each texel, by visibility that is kept."""
    field = ridges(texels, 1.0, 1.0)
    bent = curved_base.bend(field, visibility.precompute(field, spiral(directions)), base)
    return curved_base.free_share(field, bent, light)
