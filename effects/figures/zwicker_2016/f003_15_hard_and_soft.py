"""F003-15: hard and soft shadows, of a point light and of an area light (Z26)."""

import numpy as np

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.ray_caster import seen_fraction
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective, rotation
from fixedpipe.effects.geometry.views import BACKGROUND, View, row_of_panels
from fixedpipe.effects.scenes import objects_and_lamps
from fixedpipe.effects.scenes.still_life import floor_and_ground
from fixedpipe.effects.shadows.area_lights import POINTS, accumulated_lights, lamps_of
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.shadows.shadow_volumes import z_pass

DATA = figure_data(__file__, "F003-15")

# What is measured: an edge above the floor, along z, and the square around its penumbra, seen from above.
_EDGE_HEIGHT, _LIGHT_HEIGHT, _LIGHT_X = 1.0, 4.0, -3.0
_HALF_WIDTH = 0.5


def things(detail):
    """A pole, a ball and a ring on a floor: shadows from near and from far."""
    pole = surfaces.lathe(((0.0, 0.0), (0.13, 0.0), (0.13, 2.3), (0.0, 2.3)), detail // 2)
    floor, ground = floor_and_ground(12)
    ring = surfaces.torus(detail, detail // 2, 0.5, 0.14).rotated(rotation("x", 90.0))
    return objects_and_lamps.Scene(
        (
            floor,
            objects_and_lamps.Object("pole", pole.moved(-1.25, 0.0, 0.1), (0.34, 0.46, 0.62), 0.3),
            objects_and_lamps.Object(
                "ball",
                surfaces.sphere(detail, detail // 2).scaled(0.42).moved(0.3, 0.42, 0.95),
                (0.74, 0.24, 0.2),
                0.6,
            ),
            objects_and_lamps.Object(
                "ring", ring.rotated(rotation("y", -35.0)).moved(0.75, 0.64, -0.7), (0.8, 0.56, 0.2), 0.6
            ),
            ground,
        )
    )


def plate():
    """A plate above a floor; its upper right edge is at x = 0 and throws the shadow that is measured."""
    return objects_and_lamps.Scene(
        (
            objects_and_lamps.Object("floor", objects_and_lamps.floor(6.0, 2), (1.0, 1.0, 1.0), closed=False),
            objects_and_lamps.Object(
                "plate", surfaces.box(3.0, 0.25, 6.0).moved(-1.5, _EDGE_HEIGHT - 0.125, 0.0), (1.0, 1.0, 1.0)
            ),
        )
    )


def _shown(measured, panel, size):
    """Scene, view and lamp."""
    if not measured:
        eye = (0.4, 4.3, 7.4)
        projection = perspective(29.0, panel.width / panel.height, 3.0, 40.0)
        view = View(panel, look_at(eye, (0.1, 0.55, 0.0)), projection, eye, False)
        lamp = objects_and_lamps.Lamp((-3.0, 6.4, 3.2), (0.0, 0.5, 0.0), 1.0, 20.0)
        # A volume's terminator has the segments' corners: in a large panel they are to be small.
        return things(64 if size >= 200 else objects_and_lamps.detail_of(size)), view, lamp
    center = -_LIGHT_X * _EDGE_HEIGHT / (_LIGHT_HEIGHT - _EDGE_HEIGHT)
    above = objects_and_lamps.Lamp(
        (center, 3.0, 0.0), (center, 0.0, 0.0), 0.5, 4.0, infinite=True, half_width=_HALF_WIDTH
    )
    return (
        plate(),
        above.view(panel),
        objects_and_lamps.Lamp((_LIGHT_X, _LIGHT_HEIGHT, 0.0), (0.0, 0.0, 0.0), 1.0, 20.0),
    )


def _points(points, size):
    """Of the light: an eighth of them in a picture too small to show each point's shadow."""
    return points if size >= 128 else max(points // 8, 1)


def scene(profile, size, *, width, points, measured, shading, background):
    """A point light, then a square light ``width`` wide, as so many ``points``; ``measured``: of a plate."""
    hard, soft = row_of_panels(2, size)
    thing, view, lamp = _shown(measured, hard, size)
    _, soft_view, _ = _shown(measured, soft, size)
    return (
        hard.clear(background),
        *z_pass(thing, view, lamp, profile, shading),
        soft.clear(background),
        *accumulated_lights(thing, soft_view, lamps_of(lamp, width, _points(points, size)), profile, shading),
    )


def ramp_width(row, spacing):
    """Width of a linear edge from 0 to 1: from a tenth to nine tenths, over 0.8. ``spacing``: of pixels."""
    at = [np.interp(level, row, np.arange(len(row)) * spacing) for level in (0.1, 0.9)]
    return float((at[1] - at[0]) / 0.8)


def checks(figure, renderer):
    """The penumbra's width; both masks against rays."""
    width, size = figure.values["width"], 128
    expected = width * _EDGE_HEIGHT / (_LIGHT_HEIGHT - _EDGE_HEIGHT)
    for on in Answer:
        picture = renderer.window(on, figure, size, measured=True, shading=SceneShading.MASK)[..., 0]
        hard, soft = (picture[:, k * size : (k + 1) * size].mean(axis=0) for k in (0, 1))
        spacing = 2.0 * _HALF_WIDTH / size
        yield DATA.check(
            "penumbra's width over s d2 / d1 - 1", abs(ramp_width(soft, spacing) / expected - 1.0), on
        )
        yield DATA.check("point light's edge, pixels", ramp_width(hard, spacing) / spacing, on)
    yield from _against_rays(figure, renderer, size)


def _against_rays(figure, renderer, size):
    """How much of the light reaches each pixel, against rays to each of its points."""
    width, points = figure.values["width"], figure.values["points"]
    thing, view, lamp = _shown(False, row_of_panels(1, size)[0], size)
    truth = agreement.truth_of(thing, view, lamp)
    lamps = lamps_of(lamp, width, points)
    expected = seen_fraction(truth.caster, truth.shown, lamps)
    picture = renderer.machine_window(figure, size, shading=SceneShading.MASK)
    found = agreement.compare(agreement.lit_mask(picture[:, :size]), truth)
    inside = truth.shown.something & ~agreement.silhouettes(truth)
    between = inside & (expected > 0.0) & (expected < 1.0)
    off = np.abs(picture[:, size:, 0] - expected)[inside]
    return (
        *agreement.volume_checks({Answer.MACHINE: (found,)}, 0.99),
        DATA.check("share of the light - rays to its points, RMS", root_mean_square(off), Answer.MACHINE),
        DATA.check("pixels in penumbra, fraction", float(between.sum() / inside.sum()), Answer.MACHINE),
    )


# Of the square light in the reference, whose steps are not to be the picture's. Inferred: 1.6 codes each.
_REFERENCE_POINTS = 128


def reference(size, *, width, measured, shading, background, **_):
    """The shadows by rays: to the point light, and to the square one, however few points a picture takes."""
    panel = row_of_panels(1, size)[0]
    thing, view, lamp = _shown(measured, panel, size)
    lights = (lamp,), lamps_of(lamp, width, _REFERENCE_POINTS)
    return shadow_reference.row(
        size, [shadow_reference.Shot(thing, view, lamps, background, shading) for lamps in lights]
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "width": word.NUMBER(1.6, "The edge of the square light.", "world units", low=0.01, high=8.0),
        "points": word.of(
            word.Whole(1, 256, power=True),
            POINTS,
            "Points of the square light; panels below 128 pixels take an eighth.",
        ),
        "measured": word.internal(
            False, "It shows a plate whose penumbra checks measure, in the place of the scene."
        ),
        "shading": word.SHADING(SceneShading.LIT),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("shadow volumes", scene, ("OPENGL_1_2", "GEFORCE_256", "INFINITE_REALITY")),),
    acceptance=checks,
    reference=reference,
)
