"""Z13: one shadow map with a half, twice and eight times as many texels along an edge as the picture."""

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.avenue_maps import (
    NEAR_SHADOW,
    SUN,
    WHOLE,
    others,
    panels_of,
    reference,
    scene,
    shown_and_whole,
    wrong,
)
from fixedpipe.effects.scenes import avenue
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.shadows.parted_shadow_maps import MapFit

CHECKED_SIZE = 128


def checks(figure, renderer):
    """How many pixels are wrong at each resolution."""
    shown, found = shown_and_whole(figure, renderer, CHECKED_SIZE)
    coarse, middle, fine = map(wrong, found)
    return (
        Check(
            "wrong pixels: 1/2 texel a pixel over 2",
            coarse / middle,
            at_least=2.8,
            on=Answer.MACHINE,
            reason="bands along shadows' edges a quarter as wide; "
            "measured 3.7, as the finer map's are near a pixel",
        ),
        Check(
            "wrong pixels: 2 texels a pixel over 8",
            middle / fine,
            at_least=1.4,
            on=Answer.MACHINE,
            reason="what is left is within a pixel of an edge; measured 1.8",
        ),
        Check(
            "pixels that agree with rays, 1/2 texel a pixel",
            found[0].agreeing,
            at_least=0.90,
            on=Answer.MACHINE,
            reason="of those that face the light; measured "
            "0.918, the rest nearly all within texels of an edge",
        ),
        Check(
            "pixels that agree with rays, 8 texels a pixel",
            found[2].agreeing,
            at_least=0.985,
            on=Answer.MACHINE,
            reason="of those that face the light; measured 0.988",
        ),
        Check(
            "wrong pixels of the near shadow, magnified: 1/2 texel a pixel over 8",
            wrong(shown[0]) / max(wrong(shown[2]), 1e-9),
            at_least=6.5,
            on=Answer.MACHINE,
            reason="sixteen times as many texels along an edge, of which the finest leaves a pixel's width; "
            "measured 9.4",
        ),
        others((*found, *shown)),
    )


FIGURE = Figure(
    id="Z13",
    title="The resolution of a shadow map",
    caption=(
        "A long ground with a basic shadow map, and what the frame encloses magnified, with maps of 256, "
        "1024 and 4096 texels along their edges, for pictures of 512 pixels. The largest is drawn in pieces, "
        "as the window holds no more."
    ),
    must_see=(
        "The near shadow's edge has stairs larger than the ball that throws it in the second picture, a "
        "quarter as large in the third, and is round at last."
    ),
    source="Zwicker2016",
    techniques=("Z13", "Z30"),
    panels=("basic map", "256 texels", "1024 texels", "4096 texels"),
    parameters={
        "panels": panels_of(
            (
                (MapFit.BASIC, 0.5, 1, WHOLE),
                (MapFit.BASIC, 0.5, 1, NEAR_SHADOW),
                (MapFit.BASIC, 2.0, 1, NEAR_SHADOW),
                (MapFit.BASIC, 8.0, 1, NEAR_SHADOW),
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
