"""G36: bumps from a low eye: displaced, as a coarse mesh with a bump map, as a bump map redistributed by the
angle of view, and as a bump map alone.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
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
_DISTANCE, _FIELD_OF_VIEW = 24.0, 2.65
_PANELS = 4
# Between a texel that is shown and one that is not there is nothing.
_TEXELS = replace(NEAREST, wrap_s=WrapMode.REPEAT, wrap_t=WrapMode.REPEAT)


def eye_direction(angle):
    """Towards the eye, ``angle`` degrees above the plane: float64 [3]."""
    return np.array((0.0, -float(cosine(math.radians(angle))), float(sine(math.radians(angle)))))


@cache
def bumps(texels, height):
    """Eggs' beds: red where the bumps face away from the eye, white where they face it."""
    field = height_field.bumps(texels, texels, 1.0, height)
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


def camera(panel, angle):
    """From ``angle`` degrees above the plane."""
    return perspective_view(panel, tuple(_DISTANCE * eye_direction(angle)), (0.03, 0.0, 0.0), _FIELD_OF_VIEW)


def _parts(texels, height, cells, angle):
    """Mesh and texture of each panel."""
    full, small, flat = meshes(texels, height, cells)
    light = shaded(texels, height)
    shown = masking.redistributed(bumps(texels, height), eye_direction(angle))
    return (full, light), (small, light), (flat, light.reshape(-1, 3)[shown]), (flat, light)


def make(profile, size, *, texels, height, cells, angle):
    """The host shades the texels; the machine draws them on each mesh."""
    out = []
    for number, (panel, (surface, light)) in enumerate(
        zip(row_of_panels(_PANELS, size), _parts(texels, height, cells, angle), strict=True), 1
    ):
        view, name = camera(panel, angle), f"light {number}"
        units = (unit(name, _TEXELS, environment=REPLACE),)
        out += [
            panel.clear(BACKGROUND),
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


def by_rays(texels, height, cells, angle, size):
    """The colours that rays among the displaced texels' triangles see: float64 [n, 3]."""
    (surface, light), *_ = _parts(texels, height, cells, angle)
    (panel,) = row_of_panels(1, size)
    caster = RayCaster(surface.positions[surface.triangles])
    hits = caster.nearest(*primary_rays(camera(panel, angle)), 1.0)
    hit = hits.triangle >= 0
    corners = surface.texture_coordinates[surface.triangles[hits.triangle[hit]]]
    at = (
        np.floor((corners * hits.barycentrics[hit][..., None]).sum(axis=1) * texels).astype(np.int64) % texels
    )
    return light[at[:, 1], at[:, 0]]


def _checks_by_pixels(figure, renderer):
    """What each displayed panel shows, by the texels that rays meet on its mesh."""
    size, values, true = figure.size, figure.values, []
    for surface, light in _parts(**values):
        seen = seen_places.surface(surface, camera(Panel(0, 0, size, size), values["angle"]))
        true.append((seen.where, seen_places.nearest(light, seen)))
    for on, share in seen_places.shares_alike(figure, renderer, dict(enumerate(true))):
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
        )


def checks(figure, renderer):
    """What panels show by pixels; how much of the far sides each panel shows."""
    yield from _checks_by_pixels(figure, renderer)
    values, size = figure.values, 256
    truth = redness(by_rays(size=size, **values))
    for on in Answer:
        image = renderer.window(on, figure, size)
        found = []
        for number in range(_PANELS):
            pixels = panel_of(image, number).reshape(-1, 3)
            found.append(redness(pixels[np.abs(pixels - np.array(BACKGROUND)).max(axis=-1) > 0.02]))
        full, small, moved, flat = found
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


FIGURE = Figure(
    **DATA.words,
    parameters={
        "texels": word.of(word.Whole(32, 128, power=True), 64, "The edge of the field.", "texels"),
        "height": word.NUMBER(0.14, "The bumps' height, of the field's edge.", low=0.01, high=0.3),
        "cells": word.of(
            word.Whole(4, 32, power=True), masking.CELLS, "The coarse mesh's cells along an edge."
        ),
        "angle": word.NUMBER(24.0, "The eye's height above the plane.", "degrees", low=10.0, high=80.0),
    },
    methods=(Method("a texture that is computed on the host", make, ("GEFORCE_256", "OPENGL_1_2")),),
    acceptance=checks,
)
