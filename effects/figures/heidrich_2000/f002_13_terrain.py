"""F002-13: a terrain with the shadows of its bumps."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import terrain as land
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import cosine, dot, sine, unit_vector
from fixedpipe.effects.geometry.views import Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels, vector_texels
from fixedpipe.effects.scattering import ellipse_passes, ellipses, visibility
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F002-13")

_BLACK, _WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


def _cells(size):
    """Squares of the mesh along an edge: one for eight pixels, 8 to 64."""
    return max(8, min(64, size // 8))


def _texels(size):
    """Texels along an edge: a power of two from 32 to 256, one for two pixels."""
    edge = 32
    while 2 * edge <= min(size // 2, 256):
        edge *= 2
    return edge


def _land(size, p):
    """The Terrain of the figure's parameters."""
    own = p["height_field"], p["height_scale"]
    shape = p["relief"], p["lake"], p["seed"], p["directions"], p["smoothing"]
    return land.terrain(p["texels"] or _texels(size), *shape, *own, free_weight=p["free_weight"])


def _toward(sun):
    """The sun in the world, y up; the parameter's is of the ground: x to the right, y away, z up."""
    x, y, z = sun
    return Light((x, z, -y))


def _view(panel, p):
    return land.camera(panel, p["eye"], p["target"], p["field_of_view"])


def _colors(p):
    """Of the sun and of the ambient light."""
    return land.light_colors(p["sun"], p["light_low"], p["light"], p["ambient_low"], p["ambient"])


def _begin(view, p):
    """The commands that clear a panel and fill it with the sky."""
    low, high = p["sky_low"], p["sky"]
    mesh = surfaces.plane(1, 2).mesh(colors=np.array([low, low, low, low, high, high]))
    flat = orthographic_view(view.panel)
    return view.panel.clear(_BLACK), draw("sky", mesh, flat, None, depth_test=None)


def _scene(load, passes, profile, size, p):
    """Left bump mapping, right the same where the sun lies in the ellipses."""
    ground = _land(size, p)
    surface = land.mesh(ground.field, p["cells"] or _cells(size))
    colors = texture_2d(factor_texels(ground.colors, profile))
    out = [TexImage(label="load the ground's colours", texture="colours", image=colors)]
    out += load(ground, profile)
    color, ambient = _colors(p)
    for panel, shadows in zip(row_of_panels(2, size), (False, True), strict=True):
        view = _view(panel, p)
        settings = {"color": color, "ambient": ambient, "color_map": "colours", "shadows": shadows}
        out += _begin(view, p)
        out += passes(ground, surface, view, _toward(p["sun"]), profile, **settings)
    return tuple(out)


def _load_for_combiners(ground, profile):
    normals = texture_2d(vector_texels(ground.field.normals, profile))
    return (
        TexImage(label="load n", texture="normals", image=normals),
        *ellipse_passes.load(ground.forms, profile),
    )


def _with_combiners(ground, surface, view, light, profile, **settings):
    return ellipse_passes.combiner_passes(
        surface, ground.forms, view, light, profile, normal_map="normals", **settings
    )


def _with_the_imaging_subset(ground, surface, view, light, profile, **settings):
    return ellipse_passes.imaging_passes(
        surface, ground.forms, ground.field.normals, view, light, profile, **settings
    )


def combiner_scene(profile, size, **parameters):
    """G35 by register combiners."""
    return _scene(_load_for_combiners, _with_combiners, profile, size, parameters)


def imaging_scene(profile, size, **parameters):
    """The same by the imaging subset, one l for the whole terrain."""
    return _scene(lambda ground, profile: (), _with_the_imaging_subset, profile, size, parameters)


def _lit_by_rays(ground, sun):
    """(n.l)+ where rays reach the sun: float64 [rows, columns]."""
    vector = unit_vector(sun, "The sun's direction")
    lit = np.maximum(dot(ground.field.normals, vector), 0.0)
    return lit * visibility.free_view(ground.field, vector) if vector[2] > 0.0 else 0.0 * lit


def _shown(size, p, values):
    """Values of texels, RGB [rows, columns, 3] from 0 to 1, on the terrain, exact: RGB [size, size, 3],
    bottom row first.
    """
    (panel,) = row_of_panels(1, size)
    view, surface = _view(panel, p), land.mesh(_land(size, p).field, p["cells"] or _cells(size))
    units = (unit("values", environment=REPLACE),)
    commands = (
        TexImage(label="load values", texture="values", image=texture_2d(values)),
        *_begin(view, p),
        draw("show values", surface.mesh(), view, None, units, depth_test=FIRST_PASS),
    )
    return execute_ideal(commands, size, size).color[::-1, :, :3]


def reference(size, **parameters):
    """The right panel with shadows by rays."""
    ground = _land(size, parameters)
    color, ambient = _colors(parameters)
    light = np.array(ambient) + _lit_by_rays(ground, parameters["sun"])[..., None] * np.array(color)
    out = np.zeros((size, 2 * size, 4))
    out[:, size:, :3] = np.clip(_shown(size, parameters, ground.colors * light)[::-1], 0.0, 1.0)
    out[:, size:, 3] = 1.0
    return out


def _sun(elevation, azimuth):
    """A direction: degrees above the horizon, and from the right towards the far side."""
    up, around = math.radians(elevation), math.radians(azimuth)
    level = float(cosine(up))
    return level * float(cosine(around)), level * float(sine(around)), float(sine(up))


# Of the checks: degrees above the horizon, and round it from the right.
_ELEVATIONS, _AZIMUTHS = (15.0, 30.0, 45.0, 60.0), (20.0, 110.0, 200.0, 290.0)
_MASK = {
    **{"light": _WHITE, "light_low": _WHITE, "ambient": _BLACK, "ambient_low": _BLACK},
    **{"sky": _BLACK, "sky_low": _BLACK, "texels": 128},
}
# (n.l)+ from which bytes tell light from none. Where it is zero nothing is lit by either.
_TOLD = 0.08


def _against_rays(picture, size, p, sun, colors):
    """What bits say of a mask's panel: the share of the terrain's pixels that are lit as rays have it, and of
    those in shadow by rays, though they face the sun, the share that is found.
    """
    ground, vector = _land(size, p), unit_vector(sun, "The sun's direction")
    facing = np.maximum(dot(ground.field.normals, vector), 0.0)
    shown = _shown(size, p, np.stack([_lit_by_rays(ground, sun), facing, np.ones(facing.shape)], axis=-1))
    free, told = shown[..., 0] > 0.5 * shown[..., 1], shown[..., 1] > _TOLD
    turned = (shown[..., 2] > 0.5) & (shown[..., 1] <= 0.0)
    lit = picture > 0.5 * colors * shown[..., 1]
    right = (lit == free)[told].sum() + turned.sum()
    hidden = told & ~free
    return float(right / (told | turned).sum()), float((~lit & hidden).sum()), float(hidden.sum())


# What bytes of normals and of light may move a pixel, and what is left of its light in a shadow at most.
_OFF, _DARKER = 8.0 / 255.0, 0.75


def _displayed(figure, renderer, on):
    """What must be seen, in the picture that is displayed."""
    size, p = figure.size, figure.values_of(renderer.method)
    ground, sun = _land(size, p), unit_vector(p["sun"], "The sun's direction")
    color, ambient = _colors(p)
    facing = np.maximum(dot(ground.field.normals, sun), 0.0)
    light = np.array(ambient) + facing[..., None] * np.array(color)
    bumps = np.clip(_shown(size, p, ground.colors * light), 0.0, 1.0)
    values = np.stack([_lit_by_rays(ground, sun), facing, np.ones(facing.shape)], axis=-1)
    reached, facing, there = np.moveaxis(_shown(size, {**p, "sky": _BLACK, "sky_low": _BLACK}, values), -1, 0)
    there, told = there > 0.5, facing > _TOLD
    lit, hidden = told & (reached > 0.9 * facing), told & (reached < 0.1 * facing)
    left, right = (panel_of(np.clip(renderer.window(on, figure, size), 0.0, 1.0), k) for k in range(2))
    right_on_the_left = np.abs(left - bumps).max(axis=-1) <= _OFF
    yield DATA.check(
        "left: the terrain's pixels that are as bump mapping in float has them, within 8/255",
        float(right_on_the_left[there].mean()),
        on,
    )
    yield DATA.check("left: the sky's pixels, the same", float(right_on_the_left[~there].mean()), on)
    yield DATA.check(
        "left: the same of what mountains hide though it faces the sun",
        float(right_on_the_left[hidden].mean()),
        on,
    )
    dark = right.mean(axis=-1) < _DARKER * left.mean(axis=-1)
    yield DATA.check(
        "right: of what mountains hide, what is darker than on the left by a quarter",
        float(dark[hidden].mean()),
        on,
    )
    yield DATA.check(
        "right: of what is darker so, what mountains hide", float(hidden[dark & (lit | hidden)].mean()), on
    )


def checks(figure, renderer):
    """What must be seen, shadows against rays for suns from 15 degrees on, and the passes."""
    for on in Answer:
        yield from _displayed(figure, renderer, on)
    size, p = 128, {**figure.values_of(renderer.method), **_MASK}
    colors = _shown(size, p, _land(size, p).colors).max(axis=-1)
    for on in Answer:
        found = {}
        for elevation in _ELEVATIONS:
            for azimuth in _AZIMUTHS:
                sun = _sun(elevation, azimuth)
                window = renderer.window(on, figure, size, **{**_MASK, "sun": sun})
                picture = panel_of(window, 1).max(axis=-1)
                found[elevation, azimuth] = _against_rays(picture, size, p, sun, colors)
        shares = [share for share, _, _ in found.values()]
        yield DATA.check(
            "pixels that are lit as rays have it, mean of 16 suns from 15 to 60 degrees",
            sum(shares) / len(shares),
            on,
        )
        yield DATA.check(
            "the same, of the four suns 15 degrees high alone",
            sum(found[15.0, azimuth][0] for azimuth in _AZIMUTHS) / len(_AZIMUTHS),
            on,
        )
        yield DATA.check(
            "pixels in shadow by rays that are found, of all of these",
            sum(dark for _, dark, _ in found.values()) / sum(every for _, _, every in found.values()),
            on,
        )
    drawn = [c.label for c in figure.commands(renderer.profile, 32, renderer.method) if isinstance(c, Draw)]
    last = len(drawn) - 1 - drawn[::-1].index("sky")
    imaging = renderer.method.scene is imaging_scene
    yield DATA.check(
        "draws of the terrain after those that ambient light takes",
        len(drawn) - 1 - last - (2 if imaging else 1),
        Answer.MACHINE,
        at_most=4 if imaging else 2,
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "sun": word.of(
            word.DIRECTION_KIND,
            (0.45, 0.78, 0.44),
            "The direction towards the sun: x to the right, y away from the viewer, z up.",
        ),
        "texels": word.FITTED_TEXELS(None, "The edge of the bump map and of the ellipses' textures."),
        "cells": word.of(
            word.Maybe(word.Whole(4, 128), "as many as fit the panel"),
            None,
            "Squares of the mesh along an edge.",
        ),
        "relief": word.NUMBER(
            0.2,
            "How far the highest point stands above the lowest.",
            "edges of the terrain",
            low=0.0,
            high=1.0,
        ),
        "lake": word.SHARE(0.13, "Where the lake's water stands, from the lowest point to the highest."),
        "seed": word.SEED(4, "Which mountains there are."),
        "directions": word.of(
            word.Whole(8, 1000), 200, "Directions over the whole sphere along which rays are cast."
        ),
        "smoothing": word.of(
            word.Whole(0, 8), 1, "How often the ellipses' forms are filtered before they are stored."
        ),
        "free_weight": word.NUMBER(
            3.5,
            "As how many directions in shadow a free one counts where ellipses are fitted; the paper's is 1.",
            low=1.0,
            high=ellipses.LARGEST_FREE_WEIGHT,
        ),
        "eye": word.POSITION((0.1, 0.56, 1.2), "Where the camera is; the terrain's half edge is 1, y is up."),
        "target": word.POSITION((-0.02, 0.06, -0.2), "What it looks at."),
        "field_of_view": word.DEGREES(38.0, "Of the camera, from bottom to top.", low=5.0, high=120.0),
        "light": word.DIFFUSE((0.88, 0.84, 0.77), "The sun's colour from 45 degrees on."),
        "light_low": word.DIFFUSE((1.0, 0.70, 0.42), "The sun's colour on the horizon."),
        "ambient": word.AMBIENT((0.20, 0.24, 0.33), "The colour of the sky's light by day."),
        "ambient_low": word.AMBIENT((0.16, 0.18, 0.29), "The colour of the sky's light with a low sun."),
        "sky": word.BACKDROP((0.30, 0.48, 0.76), "The sky's colour at the panel's upper edge."),
        "sky_low": word.BACKDROP((0.98, 0.80, 0.60), "The sky's colour in the panel's middle and below."),
        "height_field": own_maps.height_field("the mountains"),
        "height_scale": own_maps.HEIGHT_SCALE(0.16),
    },
    methods=(
        Method("register combiners", combiner_scene, ("GEFORCE_256", "GEFORCE_3", "NV2A")),
        Method("imaging subset", imaging_scene, ("OCTANE", "OPENGL_1_2_IMAGING")),
    ),
    acceptance=checks,
    reference=reference,
)
