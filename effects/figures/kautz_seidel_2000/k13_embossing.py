"""K13: embossing on boards with one texture unit, with two, and with register combiners."""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping import emboss
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    Panel,
    orthographic_view,
    panel_of,
    row_of_panels,
)
from fixedpipe.effects.reflectance import brdfs

DATA = figure_data(__file__, "K13")

MAP_SIZE = 256


def heights(cells, depth):
    """The pebbles' heights, float64 [MAP_SIZE, MAP_SIZE], in units of the map's edge."""
    return height_fields.smooth(height_fields.pebbles(MAP_SIZE, MAP_SIZE, cells, 5), 2) * depth


def _field(square, cells, depth, height_field, height_scale):
    """The heights that are shown: pebbles, or a height field in their place."""
    if height_field is None:
        return heights(cells, depth)
    return height_field.fitted(MAP_SIZE, MAP_SIZE, height_scale, repeated=not square)


def make_scene(passes):
    """The scene drawn by one of ``emboss``'s functions."""

    def scene(profile, size, *, square, tilt, lights, diffuse, ambient, specular, background, **pebbles):
        """K13: a pebbled torus, or ``square``, in a panel for each light."""
        surface = (
            surfaces.plane()
            if square
            else surfaces.torus(48, 24).with_repeats(5, 2).rotated(rotation("x", tilt))
        )
        loading, height_map = emboss.load(_field(square, **pebbles), "height map of pebbles", profile)
        colors = {"color": diffuse, "ambient": ambient, "specular": specular}
        out = list(loading)
        for panel, light in zip(row_of_panels(len(lights), size), lights, strict=True):
            view = orthographic_view(panel, half_height=1.0 if square else 1.1)
            out.append(panel.clear(background))
            out += passes(surface, height_map, view, Light(light), profile, **colors)
        return tuple(out)

    return scene


_LIGHT = (-0.48, 0.36, 0.8)
# Of each method: what it multiplies the difference by; whether that is added to n.l, or to one and then
# multiplied; and, measured at the first correct picture, with at most a third of slack, the machine's
# correlations with (n.l)+ and between opposite lights, and its RMS error.
_BOARDS = {
    "one texture unit": (emboss.ONE_UNIT_GAIN, False, 0.55, -0.35, 0.0028),
    "texture environments": (emboss.TWO_UNITS_GAIN, False, 0.75, -0.60, 0.0028),
    "register combiners": (emboss.COMBINERS_GAIN, True, 0.88, -0.70, 0.0155),
}
# The square fills its panel with as many pixels as the map has texels.
_SQUARE = {
    "square": True,
    "lights": (_LIGHT, (0.48, -0.36, 0.8), (0.0, 0.0, 1.0)),
    "diffuse": (1.0, 1.0, 1.0),
    "ambient": (0.0, 0.0, 0.0),
    "specular": 0.0,
}


def _correlation(a, b):
    a, b = a - a.mean(), b - b.mean()
    return float((a * b).sum() / np.sqrt((a * a).sum() * (b * b).sum()))


def _second_reading(stored, shift_s, shift_t):
    """A repeated height map read ``shift_s`` and ``shift_t`` texels from its texel centres, filtered."""
    rows, columns = (np.arange(MAP_SIZE) + np.floor(shift).astype(int) for shift in (shift_t, shift_s))
    f, g = shift_s - np.floor(shift_s), shift_t - np.floor(shift_t)
    out = 0.0
    for dj, di, weight in (
        (0, 0, (1 - f) * (1 - g)),
        (0, 1, f * (1 - g)),
        (1, 0, (1 - f) * g),
        (1, 1, f * g),
    ):
        out = out + weight * stored[np.ix_((rows + dj) % MAP_SIZE, (columns + di) % MAP_SIZE)]
    return out


def _in_float(board, values, seen, field, light, shines=(1.0, 1.0)):
    """The torus's pixels under a light in float64, with a height map ``field``: [n, 3].

    ``shines``: how much of the highlight's two readings there is, the surface's own and the moved one. Where
    one draw has both, it is the first number.
    """
    gain, added = _BOARDS[board][:2]
    normals, toward = seen.frames[:, 2], seen_places.unit(np.array(light))
    half = seen_places.unit(toward + np.array([0.0, 0.0, 1.0]))
    relief = max(float(field.max()), 1e-12)

    own = seen_places.looked_up(field, seen)[:, None] / relief

    def away(vector):
        """The reading away from a vector: float64 [n, 1]."""
        by = relief / gain * (seen.frames[:, :2] @ vector)
        moved = replace(seen, s=seen.s - by[:, 0], t=seen.t - by[:, 1])
        return seen_places.looked_up(field, moved)[:, None] / relief

    color, ambient, strength = (np.array(values[name]) for name in ("diffuse", "ambient", "specular"))
    cosine, shine = ((normals @ vector)[:, None] for vector in (toward, half))
    if added:
        lit = np.maximum(cosine + gain * (away(toward) - own), 0.0)
        x = (0.5 + 0.5 * strength**0.25) * (shine + gain * (away(half) - own))
        bright = np.maximum(2.0 * x - 1.0, 0.0) ** 4 * np.clip(4.0 * lit, 0.0, 1.0)
        return np.clip(lit * color + ambient + shines[0] * bright, 0.0, 1.0)
    bright = strength * np.maximum(shine, 0.0) ** 16 * (cosine > 0.0)
    lit = (np.maximum(cosine, 0.0) * color + ambient) * (1.0 + gain * (away(toward) - own))
    if gain == emboss.ONE_UNIT_GAIN:
        bright = bright * (shines[0] * (1.0 - own) + shines[1] * away(half))
    else:
        bright = bright * shines[0] * (0.5 + away(half) - own)
    return np.clip(lit + bright, 0.0, 1.0)


def _displayed_checks(figure, renderer):
    """The displayed tori beside those of other pebbles, other lights and other highlights."""
    size, values, board = figure.size, figure.values, renderer.method.name
    torus = surfaces.torus(48, 24).with_repeats(5, 2).rotated(rotation("x", values["tilt"]))
    seen = seen_places.surface(torus, orthographic_view(Panel(0, 0, size, size), half_height=1.1))
    facing = seen.frames[:, 2, 2] > 0.3
    where = seen.where.copy()
    where[where] = facing
    seen = seen_places.Seen(where, seen.s[facing], seen.t[facing], seen.frames[facing])
    field = heights(values["cells"], values["depth"])
    fields = field, 0.0 * field, field[::-1]
    right, flat, turned = (
        [_in_float(board, values, seen, one, light) for light in values["lights"]] for one in fields
    )
    dull = [
        [_in_float(board, values, seen, field, light, shines) for shines in ((0.0, 1.0), (1.0, 0.0))]
        for light in values["lights"]
    ]
    for on in Answer:
        window, shares = np.clip(renderer.window(on, figure, size), 0.0, 1.0), []
        for k, whole in enumerate(right):
            others = flat[k], turned[k], *right[:k], *right[k + 1 :], *dull[k]
            # Where one draw has both readings, the second change is none.
            others = [one for one in others if np.abs(one - whole).max() > 0.0]
            shares.append(least_share(panel_of(window, k)[where], whole, *others))
        yield DATA.check(
            "of what pebbles and the light change, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """The term that is added to the smooth surface's light, against the height's derivative along the
    light.
    """
    yield from _displayed_checks(figure, renderer)
    gain, added, like, unlike, rounding = _BOARDS[renderer.method.name]

    def panels(on, **changes):
        image = renderer.window(on, figure, MAP_SIZE, **_SQUARE, **changes)[..., 0]
        return (image[:, k * MAP_SIZE : (k + 1) * MAP_SIZE] for k in range(3))

    def embossed(image):
        """What the bumps add to n.l, or to one where n.l multiplies it."""
        return image - _LIGHT[2] if added else image / _LIGHT[2] - 1.0

    low = 0.04
    field = heights(figure.values["cells"], low)
    relief, (slope_s, slope_t) = field.max(), height_fields.slopes(field)
    lit, opposite, above = panels(Answer.IDEAL, depth=low)
    texels = relief / gain * MAP_SIZE
    moved = _second_reading(field / relief, -texels * _LIGHT[0], -texels * _LIGHT[1])
    difference = gain * (moved - field / relief)
    derivative = -(slope_s * _LIGHT[0] + slope_t * _LIGHT[1])
    first_order = root_mean_square(embossed(lit) - derivative) / root_mean_square(derivative)
    reflected = brdfs.lambert(height_fields.frames(slope_s, slope_t)[0], np.array(_LIGHT))
    yield DATA.check(
        "embossed term - difference of two filtered heights, largest",
        float(np.abs(embossed(lit) - difference).max()),
        Answer.IDEAL,
    )
    yield DATA.check(
        "RMS of the embossed term - derivative along the light, over the derivative's",
        first_order,
        Answer.IDEAL,
    )
    yield DATA.check("correlation with (n.l)+ on low bumps", _correlation(lit, reflected), Answer.IDEAL)
    yield DATA.check(
        "correlation under opposite lights",
        _correlation(embossed(lit), embossed(opposite)),
        Answer.IDEAL,
        at_most=-0.8,
    )
    yield DATA.check("contrast under a light right above", float(above.max() - above.min()), Answer.IDEAL)
    yield DATA.check(
        "least light under a light right above", float(above.min()), Answer.IDEAL, at_least=1.0 - 1e-9
    )
    lit, opposite, above = panels(Answer.MACHINE)
    field = heights(figure.values["cells"], figure.values["depth"])
    slope_s, slope_t = height_fields.slopes(field)
    apart = field.max() / gain * MAP_SIZE * np.sqrt(1.0 - _LIGHT[2] * _LIGHT[2])
    reflected = brdfs.lambert(height_fields.frames(slope_s, slope_t)[0], np.array(_LIGHT))
    yield DATA.check(
        "correlation with (n.l)+", _correlation(lit, reflected), Answer.MACHINE, at_least=like, apart=apart
    )
    yield DATA.check(
        "correlation under opposite lights",
        _correlation(embossed(lit), embossed(opposite)),
        Answer.MACHINE,
        at_most=unlike,
    )
    yield DATA.check("contrast under a light right above", float(above.max() - above.min()), Answer.MACHINE)
    yield DATA.check(
        "least light under a light right above", float(above.min()), Answer.MACHINE, at_least=254.0 / 255.0
    )
    yield DATA.check(
        "RMS of machine - ideal",
        root_mean_square(
            renderer.machine_window(figure, 128) - np.clip(renderer.ideal_window(figure, 128), 0.0, 1.0)
        ),
        Answer.MACHINE,
        at_most=rounding,
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "square": word.FLAG(
            False, "Whether a square is drawn that fills the panel, in the place of a torus."
        ),
        "cells": word.EVEN(
            6, "Pebbles along an edge of the height map, which comes five times around the torus."
        ),
        "depth": word.SLOPE(0.35, "The pebbles' height over half balls.", low=0.01),
        "tilt": word.DEGREES(90.0, "How far the torus's axis leans towards the viewer."),
        "lights": word.of(
            word.Several((word.DIRECTION_KIND,) * 3),
            ((-0.75, 0.5, 0.55), (0.75, 0.5, 0.55), (0.0, 0.0, 1.0)),
            "The direction towards the light of each panel, of any length.",
        ),
        "diffuse": word.DIFFUSE((0.50, 0.36, 0.24)),
        "ambient": word.AMBIENT((0.05, 0.04, 0.04)),
        "specular": word.SHARE(0.3, "The strength of the highlights, which are white.", word.FULL),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the pebbles"),
        "height_scale": own_maps.HEIGHT_SCALE(0.05, low=0.001),
    },
    methods=(
        Method("one texture unit", make_scene(emboss.one_unit_passes), ("OPENGL_1_2",)),
        Method("texture environments", make_scene(emboss.two_unit_passes), ("MULTITEXTURE",)),
        Method("register combiners", make_scene(emboss.combiner_passes), ("GEFORCE_256",)),
    ),
    acceptance=checks,
)
