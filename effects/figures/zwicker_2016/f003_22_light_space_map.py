"""F003-22: one shadow map of a long ground, basic and in light-space perspective."""

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.avenue_maps import (
    NEAR_SHADOW,
    WHOLE,
    edge_of,
    machine_agreements,
    mean_footprints,
    nearest_rows,
    others,
    parameters_of,
    parts_for,
    reference,
    scene,
    truth,
    wrong,
)
from fixedpipe.effects.scenes import avenue
from fixedpipe.effects.scenes.objects_and_lamps import detail_of
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit

DATA = figure_data(__file__, "F003-22")

CHECKED_SIZE = 256


def checks(figure, renderer):
    """Texels on the screen, computed from the matrices, and the machine's shadows against rays."""
    size, sun, panels = CHECKED_SIZE, figure.values["sun"], figure.values["panels"]
    rays, things = truth(size, sun), avenue.avenue(detail_of(size))
    (near, far), (near_warped, far_warped) = (
        mean_footprints(
            parts_for(fit, ratio, slices, size, things, sun)[0].camera, edge_of(size, ratio), rays
        )
        for fit, ratio, slices, _ in panels[:2]
    )
    found = machine_agreements(figure, renderer, size)
    basic, warped = (wrong(f, nearest_rows(size)) for f in found[:2])
    return (
        DATA.check(
            "texels on the nearest fifth of the screen: basic over LiSPSM", near / near_warped, Answer.IDEAL
        ),
        DATA.check("texels at the ground's far end: LiSPSM over basic", far_warped / far, Answer.IDEAL),
        DATA.check(
            "wrong pixels in the nearest fifth of the screen: basic over LiSPSM",
            basic / max(warped, 1e-9),
            Answer.MACHINE,
        ),
        DATA.check("pixels that agree with rays, basic", found[0].agreeing, Answer.MACHINE),
        DATA.check("pixels that agree with rays, LiSPSM", found[1].agreeing, Answer.MACHINE),
        DATA.check(
            "wrong pixels of the near shadow, magnified: basic over LiSPSM",
            wrong(found[2]) / wrong(found[3]),
            Answer.MACHINE,
        ),
        others(found),
    )


FIGURE = Figure(
    **DATA.words,
    parameters=parameters_of(
        (
            (MapFit.BASIC, 1.0, 1, WHOLE),
            (MapFit.LISPSM, 1.0, 1, WHOLE),
            (MapFit.BASIC, 1.0, 1, NEAR_SHADOW),
            (MapFit.LISPSM, 1.0, 1, NEAR_SHADOW),
        ),
    ),
    methods=(Method("depth textures", scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)
