"""F003-22: one shadow map of a long ground, basic and in light-space perspective."""

from effects import avenue
from effects.figures.avenue_maps import (
    agreements,
    mean_footprints,
    nearest_rows,
    others,
    panels_of_avenue,
    parts_of_panel,
    truth,
    wrong,
)
from effects.figures.figure import Check, Figure, Method

CHECKED_SIZE = 256


def scene(profile, size, *, shading="lit", panels, background, sun):
    """F003-22: the avenue with a basic map and with LiSPSM."""
    return panels_of_avenue(profile, size, panels, shading, background, sun)


def checks(figure, renderer):
    """Texels on the screen, computed from the matrices, and the machine's shadows against rays."""
    size, sun, panels = CHECKED_SIZE, figure.parameters["sun"], figure.parameters["panels"]
    rays = truth(size, sun)
    (near, far), (near_warped, far_warped) = (
        mean_footprints(*parts_of_panel(panel, size, sun, rays.view), rays) for panel in panels
    )
    found = agreements(renderer.machine(figure, size, shading="mask"), size, panels, sun)
    basic, warped = (wrong(f, nearest_rows(size)) for f in found)
    return (
        Check(
            "texels on the nearest fifth of the screen: basic over LiSPSM",
            near / near_warped,
            ">=",
            3.0,
            "ideal",
            "the catalogue's: the mean side, on the ground, of a square as large as a texel",
        ),
        Check(
            "texels at the ground's far end: LiSPSM over basic",
            far_warped / far,
            "<=",
            4.0,
            "ideal",
            "the catalogue's: what is near takes the texels of what is far, and not too many",
        ),
        Check(
            "wrong pixels in the nearest fifth of the screen: basic over LiSPSM",
            basic / max(warped, 1e-9),
            ">=",
            2.5,
            "machine",
            "they lie along shadows' edges, in bands as wide as a texel; measured 4.6",
        ),
        Check(
            "pixels that agree with rays, basic",
            found[0].agreeing,
            ">=",
            0.97,
            "machine",
            "of those that face the light; measured 0.979, the rest nearly all within texels of an edge",
        ),
        Check(
            "pixels that agree with rays, LiSPSM",
            found[1].agreeing,
            ">=",
            0.98,
            "machine",
            "as before; measured 0.989",
        ),
        others(found),
    )


FIGURE = Figure(
    id="F003-22",
    title="A basic and a light-space perspective shadow map",
    caption=(
        "A long ground in the evening sun. Left a shadow map that covers the scene evenly, right one of as "
        "many texels whose matrix has a second perspective, towards the viewer."
    ),
    must_see=(
        "Stairs along the edges of near shadows, left; right they are a third as large. The shadows fall in "
        "the same places, those at the far gate too."
    ),
    source="Zwicker2016",
    techniques=("Z15", "Z30"),
    columns=2,
    parameters={
        "panels": (("basic", 1.0, 1, False), ("LiSPSM", 1.0, 1, False)),
        "background": avenue.SKY,
        "sun": avenue.SUN,
    },
    methods=(Method("depth textures", scene, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
)
