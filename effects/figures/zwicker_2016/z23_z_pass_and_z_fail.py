"""Z23: the same shadows by z-pass and z-fail, and the counts in the stencil buffer."""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance import shadow_reference
from fixedpipe.effects.acceptance.agreement import compare, cosines, lit_mask, truth_of
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.counted_volumes import count_checks, expected_counts
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Scene, detail_of, lamp_around
from fixedpipe.effects.scenes.still_life import LAMP_POSITIONS, still_life, still_life_view
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.lit_scene import AMBIENT, LAMP_COLOR, SceneShading, lit_pass, unlit_pass

DATA = figure_data(__file__, "Z23")

# The grey of closed things, and the floor's, on which a box's top is seen.
_GREY = {True: 0.9, False: 0.6}


def _shown_counts(profile, objects, view, lamp, counts, colors):
    """The scene in grey, lit from the eye, times a colour for each count."""
    grey = Scene(
        tuple(replace(thing, color=(_GREY[thing.closed],) * 3, specular=0.0) for thing in objects.objects)
    )
    volumes = shadow_volumes.shadow_volumes(objects, lamp.homogeneous)
    return (
        *unlit_pass(grey, view),
        *counts(volumes, view, shadow_volumes.counting_operations(profile)),
        *lit_pass(grey, view, _from_the_eye(view), label="light from the eye"),
        *shadow_volumes.show_counts(view.panel, colors),
    )


def _from_the_eye(view):
    return Lamp(view.eye, (0.0, 0.0, 0.0), 0.1, 40.0)


def scene(profile, size, *, light, infinite, colors, background, shading):
    """Shadows by z-pass, its counts, z-fail's counts, shadows by z-fail."""
    objects = still_life(detail_of(size))
    lamp = lamp_around(objects, light, infinite=infinite)
    views = [still_life_view(panel) for panel in row_of_panels(4, size)]
    endless = shadow_volumes.infinite_view(views[2])
    clears = [
        replace(view.panel.clear(background), stencil=0, label="clear colour, depth and stencil")
        for view in views
    ]
    return (
        clears[0],
        *shadow_volumes.z_pass(objects, views[0], lamp, profile, shading),
        clears[1],
        *_shown_counts(profile, objects, views[1], lamp, shadow_volumes.z_pass_counts, colors),
        clears[2],
        *_shown_counts(profile, objects, endless, lamp, shadow_volumes.z_fail_counts, colors),
        clears[3],
        *shadow_volumes.z_fail(objects, views[3], lamp, profile, shading),
    )


def coloured_counts(picture, colors):
    """Which of ``colors`` the grey scene was multiplied by, by its green over its red: int64 [h, w]."""
    green = picture[..., 1] / np.maximum(picture[..., 0], 1e-6)
    of_colors = np.array([color[1] / color[0] for color in colors])
    return np.abs(green[..., None] - of_colors).argmin(axis=-1)


def _least_eye_light(picture, objects, truth):
    """Of the light from the eye that grey things send back, the least share that one of them shows.

    By red: the counts' colours leave it as it is up to two.
    """
    sent = LAMP_COLOR[0] * np.maximum(cosines(replace(truth, lamp=_from_the_eye(truth.view))), 0.0)
    shares = []
    for number, thing in enumerate(objects.objects):
        at = truth.shown.object == number
        if at.any():
            found = picture[..., 0][at] / _GREY[thing.closed] - AMBIENT[0]
            shares.append(float((found * sent[at]).sum() / (sent[at] ** 2).sum()))
    return min(shares)


def checks(figure, renderer):
    """Counts against rays, and one algorithm's picture against the other's."""
    size = 256
    objects = still_life(detail_of(size))
    lamp = lamp_around(objects, figure.values["light"], infinite=figure.values["infinite"])
    view = still_life_view(Panel(0, 0, size, size))
    reason = (
        "vertices snapped to sixteenths of a pixel move the edges of five objects and of their shadows; "
        "measured at the first correct picture, with at most a third of slack"
    )
    yield from count_checks(renderer, view, objects, lamp, 0.9978, reason)
    truth = truth_of(objects, view, lamp)
    expected = expected_counts(shadow_volumes.shadow_volumes(objects, lamp.homogeneous), truth)
    for on in Answer:
        picture = renderer.window(on, figure, size, shading=SceneShading.MASK)
        mask = lit_mask(picture)
        alike = mask[:, :size] == mask[:, 3 * size :]
        yield DATA.check("pixels that z-pass and z-fail draw alike", float(alike.mean()), on)
        for k, name in ((0, "z-pass"), (3, "z-fail")):
            yield DATA.check(
                "{name}: displayed pixels lit or not unlike the rays', not on an edge",
                compare(panel_of(mask, k), truth).other,
                on,
                name=name,
            )
        yield DATA.check(
            "counts: of the light from the eye, the least share that a thing shows",
            min(_least_eye_light(panel_of(picture, k), objects, truth) for k in (1, 2)),
            on,
        )
        for k, name in ((1, "z-pass"), (2, "z-fail")):
            shown = coloured_counts(picture[:, k * size : (k + 1) * size], figure.values["colors"])
            yield DATA.check(
                "{name}: pixels in the colour of the rays' count",
                float((shown == np.minimum(expected, 3))[truth.shown.something].mean()),
                on,
                name=name,
            )


def reference(size, *, light, infinite, background, shading, **_):
    """The first and the last panel's shadows by rays; counts have no reference."""
    objects, view = still_life(detail_of(size)), still_life_view(Panel(0, 0, size, size))
    shot = shadow_reference.Shot(
        objects, view, (lamp_around(objects, light, infinite=infinite),), background, shading
    )
    return shadow_reference.row(size, [shot, None, None, shot])


FIGURE = Figure(
    **DATA.words,
    parameters={
        "light": word.POSITION(LAMP_POSITIONS[0], "Where the light is, or from where it comes."),
        "infinite": word.FLAG(False, "Whether the light is infinitely far."),
        "colors": word.of(
            word.Several((word.COLOR_KIND,) * 4),
            ((1.0, 1.0, 1.0), (1.0, 0.82, 0.30), (1.0, 0.46, 0.16), (0.85, 0.12, 0.16)),
            "What the grey scene is multiplied by where a count is 0, 1, 2, and 3 or more.",
            word.FULL,
        ),
        "background": word.BACKDROP(BACKGROUND),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("stencil buffer", scene, ("OPENGL_1_2", "GEFORCE_256", "OCTANE", "INFINITE_REALITY")),),
    acceptance=checks,
    reference=reference,
)
