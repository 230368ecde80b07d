"""G36: bumps from a low eye: displaced, as a coarse mesh with a bump map, as a bump map redistributed by the
angle of view, and as a bump map alone.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.vectors import cosine, dot, sine
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, NEAREST, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import curved_base, height_field, masking, visibility
from fixedpipe.effects.scattering.curved_base import Base
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import WrapMode
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "G36")

_NEAR, _FAR = np.array((0.90, 0.88, 0.82)), np.array((0.85, 0.13, 0.08))
_LIGHT = (0.35, 0.0, 0.94)
# The eye looks along +y, so far away that its direction hardly varies.
_DISTANCE, _FIELD_OF_VIEW = 24.0, 1.24
# Bumps along an edge are four: two of a field, twice.
_FIELDS = 2
# Panels smaller than this have fewer texels, so that the specification draws them in a minute.
_SMALL, _FEW_TEXELS = 100, 32
# Between a texel that is shown and one that is not there is nothing.
_TEXELS = replace(NEAREST, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.REPEAT)


def eye_direction(angle):
    """Towards the eye, ``angle`` degrees above the plane: float64 [3]."""
    return np.array((0.0, -float(cosine(math.radians(angle))), float(sine(math.radians(angle)))))


@cache
def bumps(texels, height):
    """Eggs' beds: red where the bumps face away from the eye, white where they face it."""
    field = height_field.bumps(texels // _FIELDS, texels // _FIELDS, 1.0, height)
    field = height_field.height_field(
        np.tile(field.heights / _FIELDS, (_FIELDS, _FIELDS)),
        normals=np.tile(field.normals, (_FIELDS, _FIELDS, 1)),
    )
    away = np.clip(0.5 + 2.0 * field.normals[..., 1], 0.0, 1.0)[..., None]
    return field.with_albedo((1.0 - away) * _NEAR + away * _FAR)


@cache
def shaded(texels, height):
    """The texels' light, shadowed: float64 [rows, columns, 3]."""
    field, light = bumps(texels, height), height_field.check_light(_LIGHT)
    lit = np.maximum(dot(field.normals, light), 0.0) * visibility.free_view(field, light)
    return field.albedo * (0.25 + 0.85 * lit[..., None])


def meshes(texels, height, cells):
    """The displaced texels, the displaced cells, and the mean plane: three Surfaces on a unit square."""
    field = bumps(texels, height)
    small = masking.coarse(field, cells)
    flat = height_field.height_field(np.full(small.heights.shape, float(small.heights.mean())))
    return tuple(
        curved_base.bent_surface(part, Base(), (0, part.columns), (0, part.rows), (0.5, 0.5))
        for part in (field, small, flat)
    )


def halves_of(panel):
    """The upper and the lower half of a Panel."""
    half = panel.height // 2
    return tuple(Panel(panel.x, panel.y + y, panel.width, half) for y in (panel.height - half, 0))


def camera(panel, angle):
    """From ``angle`` degrees above the plane."""
    return perspective_view(panel, tuple(_DISTANCE * eye_direction(angle)), (0.0, 0.0, 0.01), _FIELD_OF_VIEW)


def _parts(size, texels, height, cells, angle):
    """Mesh and texture of each half of a panel, the upper one first."""
    if size < _SMALL:
        texels, cells = min(texels, _FEW_TEXELS), min(cells, _FEW_TEXELS // 2)
    full, small, flat = meshes(texels, height, cells)
    light = shaded(texels, height)
    shown = masking.redistributed(bumps(texels, height), eye_direction(angle))
    return (full, light), (small, light), (flat, light.reshape(-1, 3)[shown]), (flat, light)


def make(profile, size, *, texels, height, cells, angle):
    """The host shades the texels; the machine draws them on each mesh."""
    out, columns = [], row_of_panels(2, size)
    halves = [half for panel in columns for half in halves_of(panel)]
    parts = _parts(size, texels, height, cells, angle)
    out += [panel.clear(BACKGROUND) for panel in columns]
    for number, (panel, (surface, light)) in enumerate(zip(halves, parts, strict=True), 1):
        view, name = camera(panel, angle), f"light {number}"
        units = (unit(name, _TEXELS, environment=REPLACE),)
        out += [
            TexImage(label=f"load {name}", texture=name, image=texture_2d(factor_texels(light, profile))),
            draw("the bumps", surface.mesh(), view, None, units, depth_test=FIRST_PASS),
        ]
    return tuple(out)


def redness(colors):
    """How much of the visible surface faces away from the eye, 0 to 1: from colours [n, 3], by green over
    red.
    """
    ratio = colors[:, 1] / np.maximum(colors[:, 0], 1e-9)
    near, far = _NEAR[1] / _NEAR[0], _FAR[1] / _FAR[0]
    return float(np.clip((near - ratio) / (near - far), 0.0, 1.0).mean())


def by_rays(size, angle, surface, light):
    """Which pixels of a half show a Surface, by rays, and its texture's colours there: bool [n, m], bottom
    row first, and float64 [k, 3].
    """
    seen = seen_places.surface(surface, camera(halves_of(Panel(0, 0, size, size))[1], angle))
    return seen.where, seen_places.nearest(light, seen)


def _halves(window):
    """The four halves of a window's panels in the order of ``_parts``: views of it, bottom row first."""
    half = window.shape[0] // 2
    return [panel_of(window, k)[rows] for k in range(2) for rows in (slice(half, None), slice(half))]


def _outline(picture):
    """By how many pixels a half's upper outline goes up and down over its middle."""
    covered = np.abs(picture - np.array(BACKGROUND)).max(axis=-1) > 0.02
    width = covered.shape[1]
    rows = len(covered) - np.argmax(covered[::-1, width // 5 : -(width // 5)], axis=0)
    return float(rows.max() - rows.min())


def checks(figure, renderer):
    """The panels' pixels; how much of the far sides each half shows; outlines."""
    values, size = figure.values, figure.size
    true = [by_rays(size, values["angle"], *part) for part in _parts(size, **values)]
    panels = {
        k: (
            np.concatenate([true[2 * k + 1][0], true[2 * k][0]]),
            np.concatenate([true[2 * k + 1][1], true[2 * k][1]]),
        )
        for k in range(2)
    }
    for on, share in seen_places.shares_alike(figure, renderer, panels):
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
        )
    truth = redness(true[0][1])
    for on in Answer:
        halves = _halves(renderer.window(on, figure, size))
        full, small, moved, flat = (
            redness(half[np.abs(half - np.array(BACKGROUND)).max(axis=-1) > 0.02]) for half in halves
        )
        yield DATA.check("displaced texels: share of far sides beside rays'", abs(full - truth), on)
        yield DATA.check(
            "bump map alone: share of far sides over that of the displaced texels", flat / full, on
        )
        yield DATA.check(
            "coarse mesh with the bump map: part of that excess which is left",
            (small - full) / (flat - full),
            on,
        )
        yield DATA.check(
            "bump map redistributed: difference from the displaced texels, of that excess",
            abs(moved - full) / (flat - full),
            on,
        )
        for name, half in zip(("displaced texels", "coarse mesh"), halves[:2], strict=True):
            yield DATA.check("{name}: pixels by which the outline is wavy", _outline(half), on, name=name)
        yield DATA.check(
            "bump map redistributed: pixels by which the outline is no straight line", _outline(halves[2]), on
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "texels": word.of(word.Whole(32, 128, power=True), 128, "The edge of the field.", "texels"),
        "height": word.NUMBER(0.14, "The bumps' height, of the field's edge.", low=0.01, high=0.3),
        "cells": word.of(word.Whole(4, 32, power=True), 32, "The coarse mesh's cells along an edge."),
        "angle": word.NUMBER(24.0, "The eye's height above the plane.", "degrees", low=10.0, high=80.0),
    },
    methods=(Method("a texture that is computed on the host", make, ("GEFORCE_256", "OPENGL_1_2")),),
    acceptance=checks,
)
