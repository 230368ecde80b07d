"""Z13: one shadow map with a half, twice and eight times as many texels along an edge as the picture."""

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.avenue_maps import (
    NEAR_SHADOW,
    WHOLE,
    others,
    parameters_of,
    reference,
    scene,
    shown_and_whole,
    things_checks,
    wrong,
)
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit

DATA = figure_data(__file__, "Z13")

CHECKED_SIZE = 128


def checks(figure, renderer):
    """How many pixels are wrong at each resolution."""
    shown, found = shown_and_whole(figure, renderer, CHECKED_SIZE)
    coarse, middle, fine = map(wrong, found)
    return (
        DATA.check("wrong pixels: 1/2 texel a pixel over 2", coarse / middle, Answer.MACHINE),
        DATA.check("wrong pixels: 2 texels a pixel over 8", middle / fine, Answer.MACHINE),
        DATA.check("pixels that agree with rays, 1/2 texel a pixel", found[0].agreeing, Answer.MACHINE),
        DATA.check("pixels that agree with rays, 8 texels a pixel", found[2].agreeing, Answer.MACHINE),
        DATA.check(
            "wrong pixels of the near shadow, magnified: 1/2 texel a pixel over 8",
            wrong(shown[0]) / max(wrong(shown[2]), 1e-9),
            Answer.MACHINE,
        ),
        others((*found, *shown)),
        *things_checks(DATA, figure, renderer),
    )


FIGURE = Figure(
    **DATA.words,
    parameters=parameters_of(
        (
            (MapFit.BASIC, 0.5, 1, WHOLE),
            (MapFit.BASIC, 0.5, 1, NEAR_SHADOW),
            (MapFit.BASIC, 2.0, 1, NEAR_SHADOW),
            (MapFit.BASIC, 8.0, 1, NEAR_SHADOW),
        ),
    ),
    methods=(Method("depth textures", scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)
