"""F003-22: one shadow map of a long ground, basic and in light-space perspective."""

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.avenue_maps import (
    NEAR_SHADOW,
    SUN,
    WHOLE,
    agreements,
    edge_of,
    mean_footprints,
    nearest_rows,
    others,
    panels_of,
    parts_for,
    reference,
    scene,
    truth,
    wrong,
)
from fixedpipe.effects.scenes import avenue
from fixedpipe.effects.scenes.objects_and_lamps import detail_of
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit

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
    found = agreements(renderer.machine_window(figure, size, shading=SceneShading.MASK), size, panels, sun)
    basic, warped = (wrong(f, nearest_rows(size)) for f in found[:2])
    return (
        Check(
            "texels on the nearest fifth of the screen: basic over LiSPSM",
            near / near_warped,
            at_least=3.0,
            on=Answer.IDEAL,
            reason="the catalogue's: the mean side, on the ground, of a square as large as a texel",
        ),
        Check(
            "texels at the ground's far end: LiSPSM over basic",
            far_warped / far,
            at_most=4.0,
            on=Answer.IDEAL,
            reason="the catalogue's: what is near takes the texels of what is far, and not too many",
        ),
        Check(
            "wrong pixels in the nearest fifth of the screen: basic over LiSPSM",
            basic / max(warped, 1e-9),
            at_least=2.5,
            on=Answer.MACHINE,
            reason="they lie along shadows' edges, in bands as wide as a texel; measured 4.6",
        ),
        Check(
            "pixels that agree with rays, basic",
            found[0].agreeing,
            at_least=0.97,
            on=Answer.MACHINE,
            reason="of those that face the light; measured "
            "0.979, the rest nearly all within texels of an edge",
        ),
        Check(
            "pixels that agree with rays, LiSPSM",
            found[1].agreeing,
            at_least=0.98,
            on=Answer.MACHINE,
            reason="as before; measured 0.989",
        ),
        Check(
            "wrong pixels of the near shadow, magnified: basic over LiSPSM",
            wrong(found[2]) / wrong(found[3]),
            at_least=2.0,
            on=Answer.MACHINE,
            reason="as above, where only the ground, the stone and its shadow are seen; measured 2.2",
        ),
        others(found),
    )


FIGURE = Figure(
    id="F003-22",
    title="A basic and a light-space perspective shadow map",
    caption=(
        "A long ground in the evening sun. First a shadow map that covers the scene evenly, then one of as "
        "many texels whose matrix has a second perspective, towards the viewer. Third and fourth of the "
        "same two what the frame encloses, magnified."
    ),
    must_see=(
        "Stairs along the near shadow's edge in the third picture; in the fourth they are a third as large. "
        "In the first two the shadows fall in the same places, those at the far gate too."
    ),
    source="Zwicker2016",
    techniques=("Z15", "Z30"),
    panels=("basic map", "light-space map", "basic, magnified", "light-space, magnified"),
    parameters={
        "panels": panels_of(
            (
                (MapFit.BASIC, 1.0, 1, WHOLE),
                (MapFit.LISPSM, 1.0, 1, WHOLE),
                (MapFit.BASIC, 1.0, 1, NEAR_SHADOW),
                (MapFit.LISPSM, 1.0, 1, NEAR_SHADOW),
            )
        ),
        "background": word.BACKDROP(avenue.SKY),
        "sun": SUN,
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("depth textures", scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)
