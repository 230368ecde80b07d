"""Z16: basic shadow maps, slices, light-space perspective, and the last two together."""

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.avenue_maps import (
    NEAR_SHADOW,
    SUN,
    nearest_rows,
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

CHECKED_SIZE = 256


def checks(figure, renderer):
    """How many pixels are wrong in each way."""
    shown, found = shown_and_whole(figure, renderer, CHECKED_SIZE)
    near = [max(wrong(f, nearest_rows(CHECKED_SIZE)), 1e-9) for f in found]
    ratios = (("slices", 1, 3.2, 4.8), ("LiSPSM", 2, 2.5, 3.5), ("both", 3, 4.8, 6.8))
    return (
        *(
            Check(
                f"wrong pixels in the nearest fifth of the screen: basic over {name}",
                near[0] / near[k],
                at_least=bound,
                on=Answer.MACHINE,
                reason=f"measured {measured} at the first correct picture",
            )
            for name, k, bound, measured in ratios
        ),
        Check(
            "wrong pixels of both together over the least of the others",
            wrong(found[3]) / min(map(wrong, found[:3])),
            at_most=1.0,
            on=Answer.MACHINE,
            reason="measured 0.88: most of what slices leave is within a pixel of an edge",
        ),
        *(
            Check(
                f"pixels that agree with rays, {fit}",
                f.agreeing,
                at_least=bound,
                on=Answer.MACHINE,
                reason="of those that face the light, with half as many texels as pixels along an edge; "
                f"measured {measured}",
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
            Check(
                f"wrong pixels of the near shadow, magnified: basic over {name}",
                wrong(shown[0]) / wrong(shown[k]),
                at_least=bound,
                on=Answer.MACHINE,
                reason="as above, where only the ground, the stone and its shadow are seen; "
                f"measured {measured}",
            )
            for name, k, bound, measured in (
                ("slices", 1, 2.6, 3.8),
                ("LiSPSM", 2, 2.2, 3.3),
                ("both", 3, 3.7, 5.5),
            )
        ),
        others((*found, *shown), 8e-4, 0.0004),
    )


FIGURE = Figure(
    id="Z16",
    title="Slices and light-space perspective together",
    caption=(
        "A shadow before the viewer of F003-22's long ground, magnified: with one basic map, with three "
        "slices, with one map in light-space perspective, and with both. Every map has two texels for three "
        "pixels along the picture's edge. The polygon offset is counted in steps of the depth buffer: on the "
        "InfiniteReality, whose 23 bits have half as many as the others' 24, the same offset is twice as "
        "far, and corners of shadows are lost."
    ),
    must_see=(
        "The stairs along the shadow's edge are largest with the basic map, small with either, smallest with "
        "both together: wrong pixels are 3.8 times fewer with slices, 3.3 times with light space, 5.6 times "
        "with both."
    ),
    source="Zwicker2016",
    techniques=("Z13", "Z14", "Z15", "Z16"),
    panels=("basic", "three slices", "light space", "both"),
    parameters={
        "panels": panels_of(
            (
                (MapFit.BASIC, 0.67, 1, NEAR_SHADOW),
                (MapFit.SLICES, 0.67, 3, NEAR_SHADOW),
                (MapFit.LISPSM, 0.67, 1, NEAR_SHADOW),
                (MapFit.SLICES_AND_LISPSM, 0.67, 3, NEAR_SHADOW),
            )
        ),
        "background": word.BACKDROP(avenue.SKY),
        "sun": SUN,
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("depth textures and clip planes", scene, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
    reference=reference,
)
