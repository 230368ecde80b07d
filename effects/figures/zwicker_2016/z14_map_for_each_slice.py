"""Z14: the viewer's frustum in three slices, a shadow map for each."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.avenue_maps import (
    NEAR_SHADOW,
    SUN,
    TINTED,
    WHOLE,
    agreements,
    nearest_rows,
    others,
    panels_of,
    reference,
    sliced_scene,
    truth,
    wrong,
)
from fixedpipe.effects.scenes import avenue
from fixedpipe.effects.shadows import frustum_slices
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit

CHECKED_SIZE = 256


def _tint_matches(picture, rays, slices, mixture):
    """The share of the ground's pixels away from slices' ends whose strongest colour is their slice's."""
    distances = frustum_slices.view_slices(rays.view, slices, mixture)
    modelview = np.array(rays.view.modelview)
    depth = -(rays.shown.points @ modelview[2, :3] + modelview[2, 3])
    plain = picture.copy()
    wanted = frustum_slices.slice_of(distances, depth)
    away = np.min([np.abs(depth - d) for d in distances[1:-1]], axis=0) > 0.02 * depth
    ground = (rays.shown.object == 0) & away
    # The ground's own colour is divided out.
    strongest = np.argmax(plain[ground] / np.array([0.84, 0.78, 0.62]), axis=-1)
    return float((strongest == wanted[ground]).mean())


def checks(figure, renderer):
    """What slices bring, and whether each pixel is of the slice that its depth says."""
    mixture = figure.values["mixture"]
    size, sun, panels = CHECKED_SIZE, figure.values["sun"], figure.values["panels"]
    shown = agreements(
        renderer.machine_window(figure, size, shading=SceneShading.MASK), size, panels, sun, mixture
    )
    compared = ((MapFit.BASIC, *panels[1][1:3], WHOLE), panels[1])
    picture = renderer.machine_window(figure, size, shading=SceneShading.MASK, panels=compared)
    found = agreements(picture, size, compared, sun, mixture)
    basic, sliced = (wrong(f, nearest_rows(size)) for f in found)
    tinted = renderer.machine_window(figure, size, panels=panels[:1])[:, :size]  # without a frame
    return (
        Check(
            "wrong pixels in the nearest fifth of the screen: basic over slices",
            basic / max(sliced, 1e-9),
            at_least=7.0,
            on=Answer.MACHINE,
            reason="the nearest slice is a fifth of the ground's length; measured 10",
        ),
        Check(
            "wrong pixels: basic over slices",
            wrong(found[0]) / wrong(found[1]),
            at_least=2.0,
            on=Answer.MACHINE,
            reason="three maps instead of one; measured 2.9",
        ),
        Check(
            "pixels that agree with rays, slices",
            found[1].agreeing,
            at_least=0.988,
            on=Answer.MACHINE,
            reason="of those that face the light; measured 0.992",
        ),
        Check(
            "ground that has its slice's tint",
            _tint_matches(tinted, truth(size, sun), panels[0][2], mixture),
            at_least=0.9995,
            on=Answer.MACHINE,
            reason="away from slices' ends; trees and columns on the outline's pixels are the rest",
        ),
        Check(
            "wrong pixels of the near shadow, magnified: basic over slices",
            wrong(shown[2]) / wrong(shown[3]),
            at_least=2.0,
            on=Answer.MACHINE,
            reason="as above, where only the ground, the stone and its shadow are seen; measured 3.7",
        ),
        others((*found, *shown)),
    )


FIGURE = Figure(
    id="Z14",
    title="A shadow map for each slice of the view",
    caption=(
        "A long ground with a shadow map for each of three slices of what the viewer sees, which end at "
        "distances in a constant ratio; the slices are tinted first. Third and fourth what the frame "
        "encloses, magnified, with one basic map and with as many texels for each slice."
    ),
    must_see=(
        "First red, green and blue slices, each ground pixel in one of them; second no seam where they meet. "
        "The stairs along the near shadow's edge are large in the third picture, small in the fourth."
    ),
    source="Zwicker2016",
    techniques=("Z14",),
    panels=("slices, tinted", "their shadows", "basic, magnified", "slices, magnified"),
    parameters={
        "panels": panels_of(
            (
                (MapFit.SLICES, 1.0, 3, TINTED),
                (MapFit.SLICES, 1.0, 3, WHOLE),
                (MapFit.BASIC, 1.0, 1, NEAR_SHADOW),
                (MapFit.SLICES, 1.0, 3, NEAR_SHADOW),
            )
        ),
        "background": word.BACKDROP(avenue.SKY),
        "mixture": word.of(
            word.Number(0.0, 1.0), 1.0, "Where slices end: 1 logarithmic, 0 all of one length."
        ),
        "sun": SUN,
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("depth textures and clip planes", sliced_scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)
