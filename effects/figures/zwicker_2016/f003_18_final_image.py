"""F003-18: the final image with shadows, by a shadow map (Z10)."""

import numpy as np

from fixedpipe.effects.acceptance import agreement
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels
from fixedpipe.effects.scenes.still_life import still_life_and_lamp, still_life_view
from fixedpipe.effects.shadows.lit_scene import AMBIENT, SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import modulated_passes, store_map

# World units that the map is wide at the middle of the scene, rounded up from 6.7; over its edge, a texel.
_MAP_WIDTH = 7.0


def make(profile, size, *, ratio, factor, units, filtered, shading):
    """Z10, Z12, Z19, Z20 on one panel."""
    (panel,) = row_of_panels(1, size)
    scene, light = still_life_and_lamp(size)
    view = still_life_view(panel)
    stored = store_map(
        scene, light, "shadow map", map_edge(size, ratio), (size, size), factor=factor, units=units
    )
    return (
        *stored,
        panel.clear(BACKGROUND),
        *modulated_passes(scene, view, light, "shadow map", profile, shading, filtered=filtered),
    )


_SIZE = 256


def checks(figure, renderer):
    """Lit and shadowed pixels against rays, with a large and a small map."""
    (panel,) = row_of_panels(1, _SIZE)
    scene, light = still_life_and_lamp(_SIZE)
    truth = agreement.truth_of(scene, still_life_view(panel), light)
    floor = truth.shown.object == 0
    for edge, on, bound, reason in (
        (1024, Answer.MACHINE, 0.995, "the catalogue's acceptance, of receivers' pixels: the floor's"),
        (256, Answer.MACHINE, 0.98, "the catalogue's acceptance, of receivers' pixels: the floor's"),
        (1024, Answer.IDEAL, 0.995, "what sampling alone leaves"),
    ):
        picture = renderer.window(on, figure, _SIZE, shading=SceneShading.MASK, ratio=edge / _SIZE)
        mask = agreement.lit_mask(picture)
        told = {"map_edge": edge, "contact": _MAP_WIDTH / edge}
        on_floor = agreement.compare(mask, truth, where=floor, **told)
        everywhere = agreement.compare(mask, truth, **told)
        name = f"map of {edge} by {edge}"
        yield Check(
            f"{name}: floor that agrees with rays", on_floor.agreeing, at_least=bound, on=on, reason=reason
        )
        yield Check(
            f"{name}: pixels of no understood kind, of all",
            everywhere.other / everywhere.compared,
            at_most=0.001,
            on=on,
            reason="measured: none; what differs lies at an edge, at an outline, or where light grazes, "
            "within a texel of it",
        )
    inner = floor & ~truth.lit & ~agreement.silhouettes(truth)
    for axis in (0, 1):
        for by in (-3, 3):
            inner &= np.roll(~truth.lit, by, axis)
    for on in Answer:
        seen = renderer.window(on, figure, _SIZE)[inner]
        ambient = np.array(AMBIENT[:3]) * np.array(scene.objects[0].color)
        near = np.abs(seen - ambient).max(axis=-1) <= (1e-9 if on is Answer.IDEAL else 1.5 / 255.0)
        yield Check(
            "shadows on the floor that are the ambient light, of all well inside", float(near.mean()),
            at_least=0.98, on=on, reason="E003.9: what the comparison multiplies is the light alone; a strip "
            "is lit where things stand, as wide as the offset",
        )  # fmt: skip
    (lit, dark) = (np.float64(truth.lit[floor].mean()), np.float64((~truth.lit[floor]).mean()))
    yield Check(
        "floor in the shade, of all",
        float(min(lit, dark)),
        at_least=0.1,
        on=Answer.IDEAL,
        reason="rays: there is light and shade to tell apart, so that no picture of one kind passes",
    )


FIGURE = Figure(
    id="F003-18",
    title="Final image with shadows",
    caption=(
        "A still life on a floor, its shadows by a shadow map: every pixel's distance from the light is "
        "compared with what the light sees in that direction."
    ),
    must_see=(
        "Every object throws one shadow away from the light at the upper left, joined to it where they "
        "touch; the vase's falls on the floor and up the box; the ring shades itself; no speckle "
        "on lit surfaces; shadows are dark, not black."
    ),
    source="Zwicker2016",
    techniques=("Z10", "Z12", "Z19", "Z20", "Z30"),
    parameters={
        "ratio": word.RATIO(2),
        "factor": word.FACTOR(2.2),
        "units": word.UNITS(4.0),
        "filtered": word.FLAG(True, "Whether the results of the comparison are filtered."),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("depth texture times the light", make, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
)
