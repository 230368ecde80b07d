"""Z14: the viewer's frustum in three slices, a shadow map for each."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.avenue_maps import (
    NEAR_SHADOW,
    TINTED,
    WHOLE,
    machine_agreements,
    nearest_rows,
    others,
    parameters_of,
    reference,
    sliced_scene,
    things_checks,
    truth,
    wrong,
)
from fixedpipe.effects.shadows import frustum_slices
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit

DATA = figure_data(__file__, "Z14")

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
    size, panels, mixture = CHECKED_SIZE, figure.values["panels"], figure.values["mixture"]
    shown = machine_agreements(figure, renderer, size)
    compared = ((MapFit.BASIC, *panels[1][1:3], WHOLE), panels[1])
    found = machine_agreements(figure, renderer, size, compared)
    basic, sliced = (wrong(f, nearest_rows(size)) for f in found)
    tinted = renderer.machine_window(figure, size, panels=panels[:1])[:, :size]  # without a frame
    return (
        DATA.check(
            "wrong pixels in the nearest fifth of the screen: basic over slices",
            basic / max(sliced, 1e-9),
            Answer.MACHINE,
        ),
        DATA.check("wrong pixels: basic over slices", wrong(found[0]) / wrong(found[1]), Answer.MACHINE),
        DATA.check("pixels that agree with rays, slices", found[1].agreeing, Answer.MACHINE),
        DATA.check(
            "ground that has its slice's tint",
            _tint_matches(tinted, truth(size, figure.values["sun"]), panels[0][2], mixture),
            Answer.MACHINE,
        ),
        DATA.check(
            "wrong pixels of the near shadow, magnified: basic over slices",
            wrong(shown[2]) / wrong(shown[3]),
            Answer.MACHINE,
        ),
        others((*found, *shown)),
        *things_checks(DATA, figure, renderer),
    )


FIGURE = Figure(
    **DATA.words,
    parameters=parameters_of(
        (
            (MapFit.SLICES, 1.0, 3, TINTED),
            (MapFit.SLICES, 1.0, 3, WHOLE),
            (MapFit.BASIC, 1.0, 1, NEAR_SHADOW),
            (MapFit.SLICES, 1.0, 3, NEAR_SHADOW),
        ),
        mixture=word.of(word.Number(0.0, 1.0), 1.0, "Where slices end: 1 logarithmic, 0 all of one length."),
    ),
    methods=(Method("depth textures and clip planes", sliced_scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)
