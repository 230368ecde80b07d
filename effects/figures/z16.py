"""Z16: basic shadow maps, slices, light-space perspective, and the last two together."""

from effects import avenue
from effects.figures.avenue_maps import agreements, nearest_rows, others, panels_of_avenue, wrong
from effects.figures.figure import Check, Figure, Method

CHECKED_SIZE = 256


def scene(profile, size, *, shading="lit", panels, background, sun):
    """Z16: the avenue in all four ways to fit shadow maps."""
    return panels_of_avenue(profile, size, panels, shading, background, sun)


def checks(figure, renderer):
    """How many pixels are wrong in each way."""
    size, panels = CHECKED_SIZE, figure.parameters["panels"]
    picture = renderer.machine(figure, size, shading="mask")
    found = agreements(picture, size, panels, figure.parameters["sun"])
    near = [max(wrong(f, nearest_rows(size)), 1e-9) for f in found]
    ratios = (("slices", 1, 3.2, 4.8), ("LiSPSM", 2, 2.5, 3.5), ("both", 3, 4.8, 6.8))
    return (
        *(
            Check(
                f"wrong pixels in the nearest fifth of the screen: basic over {name}",
                near[0] / near[k],
                ">=",
                bound,
                "machine",
                f"measured {measured} at the first correct picture",
            )
            for name, k, bound, measured in ratios
        ),
        Check(
            "wrong pixels of both together over the least of the others",
            wrong(found[3]) / min(map(wrong, found[:3])),
            "<=",
            1.0,
            "machine",
            "measured 0.90: most of what slices leave is within a pixel of an edge",
        ),
        *(
            Check(
                f"pixels that agree with rays, {way}",
                f.agreeing,
                ">=",
                bound,
                "machine",
                "of those that face the light, with half as many texels as pixels along an edge; measured "
                f"{measured}",
            )
            for (way, *_), f, bound, measured in zip(
                panels, found, (0.93, 0.98, 0.97, 0.982), (0.948, 0.986, 0.978, 0.987), strict=True
            )
        ),
        others(found, 1e-3, 0.0008),
    )


FIGURE = Figure(
    id="Z16",
    title="Slices and light-space perspective together",
    caption=(
        "A long ground, its shadow maps of a half of the picture's edge in texels: one basic map, three "
        "slices, one light-space perspective map, and three slices in light-space perspective."
    ),
    must_see=(
        "The stairs along the edges of near shadows are largest in the first picture and gone, or nearly, in "
        "the last; no seams."
    ),
    source="Zwicker2016",
    techniques=("Z13", "Z14", "Z15", "Z16"),
    columns=4,
    parameters={
        "panels": (
            ("basic", 0.5, 1, False),
            ("slices", 0.5, 3, False),
            ("LiSPSM", 0.5, 1, False),
            ("slices and LiSPSM", 0.5, 3, False),
        ),
        "background": avenue.SKY,
        "sun": avenue.SUN,
    },
    methods=(Method("depth textures and clip planes", scene, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
)
