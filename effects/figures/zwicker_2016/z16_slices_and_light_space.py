"""Z16: basic shadow maps, slices, light-space perspective, and the last two together."""

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.avenue_maps import (
    BALL_SHADOW,
    machine_agreements,
    nearest_rows,
    others,
    parameters_of,
    reference,
    scene,
    shown_and_whole,
    wrong,
)
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit

DATA = figure_data(__file__, "Z16")

CHECKED_SIZE = 256
NAMES = "basic", "slices", "LiSPSM", "both"


def checks(figure, renderer):
    """How many pixels are wrong in each way."""
    shown, found = shown_and_whole(figure, renderer, CHECKED_SIZE)
    seen = dict(zip(NAMES, map(wrong, machine_agreements(figure, renderer, figure.size)), strict=True))
    near = [max(wrong(f, nearest_rows(CHECKED_SIZE)), 1e-9) for f in found]
    ratios = (("slices", 1, 3.2, 4.8), ("LiSPSM", 2, 2.5, 3.5), ("both", 3, 4.8, 6.8))
    return (
        *(
            DATA.check(
                "wrong pixels in the nearest fifth of the screen: basic over {name}",
                near[0] / near[k],
                Answer.MACHINE,
                at_least=bound,
                name=name,
                measured=measured,
            )
            for name, k, bound, measured in ratios
        ),
        DATA.check(
            "wrong pixels of both together over the least of the others",
            wrong(found[3]) / min(map(wrong, found[:3])),
            Answer.MACHINE,
        ),
        *(
            DATA.check(
                "pixels that agree with rays, {fit}",
                f.agreeing,
                Answer.MACHINE,
                at_least=bound,
                fit=fit,
                measured=measured,
            )
            for (fit, *_), f, bound, measured in zip(
                figure.values["panels"],
                found,
                (0.93, 0.98, 0.97, 0.982),
                (0.948, 0.986, 0.978, 0.987),
                strict=True,
            )
        ),
        *(
            DATA.check(
                "wrong pixels of the near shadow, magnified: basic over {name}",
                wrong(shown[0]) / wrong(shown[k]),
                Answer.MACHINE,
                at_least=bound,
                name=name,
                measured=measured,
            )
            for name, k, bound, measured in (
                ("slices", 1, 2.6, 3.8),
                ("LiSPSM", 2, 2.2, 3.3),
                ("both", 3, 3.7, 5.5),
            )
        ),
        *(
            DATA.check(
                "displayed panels, wrong pixels: {more} over {less}",
                seen[more] / seen[less],
                Answer.MACHINE,
                more=more,
                less=less,
            )
            for more, less in (
                ("basic", "LiSPSM"),
                ("LiSPSM", "both"),
                ("basic", "slices"),
                ("slices", "both"),
            )
        ),
        others((*found, *shown), 8e-4, 0.0004),
    )


FIGURE = Figure(
    **DATA.words,
    parameters=parameters_of(
        (
            (MapFit.BASIC, 0.67, 1, BALL_SHADOW),
            (MapFit.SLICES, 0.67, 3, BALL_SHADOW),
            (MapFit.LISPSM, 0.67, 1, BALL_SHADOW),
            (MapFit.SLICES_AND_LISPSM, 0.67, 3, BALL_SHADOW),
        ),
    ),
    methods=(Method("depth textures and clip planes", scene, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
    reference=reference,
)
