"""F003-18: the final image with shadows, by a shadow map (Z10), and the two distances that it compares."""

import numpy as np

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.matrices import look_at, perspective
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View, row_of_panels
from fixedpipe.effects.scenes.still_life import (
    BETWEEN,
    LIT_POINT,
    SHADOWED_POINT,
    still_life_and_lamp,
    still_life_view,
)
from fixedpipe.effects.shadows.lit_scene import AMBIENT, SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import modulated_passes, store_map

DATA = figure_data(__file__, "F003-18")

# World units that the map is wide at the middle of the scene, rounded up; over its edge, a texel.
_MAP_WIDTH = 7.5
# What a line of the map's value is drawn beside that of the distance, world units.
_BESIDE = 0.13


def lamp_view(panel):
    """The still life and its first lamp, from farther than the final image."""
    eye = (4.2, 13.6, 14.2)
    return View(panel, look_at(eye, (-1.2, 3.45, 1.2)), perspective(33.0, 1.0, 3.0, 80.0), eye, False)


def distances(view, lamp):
    """The lamp, two points, and for each its distance from the light next to the map's value for it."""
    points, ends, position = (LIT_POINT, SHADOWED_POINT), (LIT_POINT, BETWEEN), np.array(lamp.position)
    across = np.array(view.modelview[0][:3]) * _BESIDE
    yellow = [np.stack([position, np.array(point)]) for point in points]
    red = [np.stack([position, np.array(end)]) - across for end in ends]
    return (
        drawing.strokes("distances from the light", view, yellow, drawing.YELLOW, width=1.6),
        drawing.strokes("values in the shadow map", view, red, drawing.RED, width=1.6),
        drawing.dots("the lamp", view, [position], drawing.YELLOW, radius=4.0),
        drawing.dots("where the map's values end", view, [line[1] for line in red], drawing.RED, radius=2.4),
        *marked_points(view),
        drawing.text("light", view, position, drawing.INK, align=(-1, 0), offset=(7.0, 1.0)),
    )


def marked_points(view):
    """The two points and what each is."""
    lit, dark = LIT_POINT, SHADOWED_POINT
    black = (0.05, 0.05, 0.06)
    return (
        drawing.dots("the two points", view, [lit, dark], drawing.YELLOW, radius=2.6),
        drawing.text("lit", view, lit, drawing.INK, align=(0, 1), offset=(0.0, -5.0), outline=black),
        drawing.text("in shadow", view, dark, drawing.INK, align=(0, 1), offset=(0.0, -5.0), outline=black),
    )


def make(profile, size, *, ratio, factor, units, filtered, shading, marks):
    """Z10, Z12, Z19, Z20, then the same from afar with the distances that are compared."""
    near, afar = row_of_panels(2, size)
    scene, light = still_life_and_lamp(size)
    out = [
        drawing.load_font(),
        *store_map(
            scene, light, "shadow map", map_edge(size, ratio), (2 * size, size), factor=factor, units=units
        ),
    ]
    for view in (still_life_view(near), lamp_view(afar)):
        out.append(view.panel.clear(BACKGROUND))
        out += modulated_passes(scene, view, light, "shadow map", profile, shading, filtered=filtered)
    if marks:
        out += (*marked_points(still_life_view(near)), *distances(lamp_view(afar), light))
    return tuple(out)


def reference(size, *, shading, marks, **_):
    """The still life's shadows by rays, under the same marks."""
    near, afar = row_of_panels(2, size)
    scene, light = still_life_and_lamp(size)
    views = still_life_view(near), lamp_view(afar)
    picture = shadow_reference.row(
        size, [shadow_reference.Shot(scene, view, (light,), shading=shading) for view in views]
    )
    if not marks:
        return picture
    drawn = (drawing.load_font(), *marked_points(views[0]), *distances(views[1], light))
    return shadow_reference.overlaid(picture, drawn)


_SIZE = 256


def _final(renderer, on, figure, **changes):
    """The final image without marks."""
    return renderer.window(on, figure, _SIZE, marks=False, **changes)[:, :_SIZE]


def checks(figure, renderer):
    """Lit and shadowed pixels against rays, with a large and a small map; the two distances."""
    (panel,) = row_of_panels(1, _SIZE)
    scene, light = still_life_and_lamp(_SIZE)
    truth = agreement.truth_of(scene, still_life_view(panel), light)
    # The floor among the things; most of the ground about it has no shadow near.
    floor = truth.shown.object == 0
    for edge, on, bound, reason in (
        (1024, Answer.MACHINE, 0.995, "the catalogue's acceptance, of receivers' pixels: the floor's"),
        (256, Answer.MACHINE, 0.98, "the catalogue's acceptance, of receivers' pixels: the floor's"),
        (1024, Answer.IDEAL, 0.995, "what sampling alone leaves"),
    ):
        mask = agreement.lit_mask(_final(renderer, on, figure, shading=SceneShading.MASK, ratio=edge / _SIZE))
        told = {"map_edge": edge, "contact": _MAP_WIDTH / edge}
        on_floor = agreement.compare(mask, truth, where=floor, **told)
        everywhere = agreement.compare(mask, truth, **told)
        name = f"map of {edge} by {edge}"
        yield Check(
            f"{name}: floor that agrees with rays", on_floor.agreeing, at_least=bound, on=on, reason=reason
        )
        yield DATA.check(
            "{name}: pixels of no understood kind, of all",
            everywhere.other / everywhere.compared,
            on,
            name=name,
        )
    inner = floor & ~truth.lit & ~agreement.silhouettes(truth)
    for axis in (0, 1):
        for by in (-3, 3):
            inner &= np.roll(~truth.lit, by, axis)
    for on in Answer:
        seen = _final(renderer, on, figure)[inner]
        ambient = np.array(AMBIENT[:3]) * np.array(scene.objects[0].color)
        near = np.abs(seen - ambient).max(axis=-1) <= (1e-9 if on is Answer.IDEAL else 1.5 / 255.0)
        yield DATA.check(
            "shadows on the floor that are the ambient light, of all well inside", float(near.mean()), on
        )
    shaded = np.float64((~truth.lit[floor]).mean())
    yield DATA.check("floor in the shade, of all", float(min(shaded, 1.0 - shaded)), Answer.IDEAL)
    yield from _distance_checks(figure, renderer, truth)


def _distance_checks(figure, renderer, truth):
    """The map's values at the two points, and that their lines are drawn as long as they are."""
    position, lines = np.array(truth.lamp.position), []
    for name, point, end in (("lit", LIT_POINT, LIT_POINT), ("shadowed", SHADOWED_POINT, BETWEEN)):
        way = np.array(point) - position
        share = float(truth.caster.nearest(position[None], way[None]).distance[0])
        off = position + share * way - np.array(end)
        yield DATA.check(
            ("{name} point: end of the map's value from what a ray of the light meets first, world units"),
            float(np.sqrt((off * off).sum())),
            Answer.IDEAL,
            name=name,
        )
        lines.append((way, share))
    view = lamp_view(Panel(0, 0, 2 * _SIZE, 2 * _SIZE))
    picture = renderer.machine_window(figure, 2 * _SIZE)[:, 2 * _SIZE :]
    beside, drawn = np.array(view.modelview[0][:3]) * _BESIDE, []
    for way, share in lines:
        for part in np.arange(0.3, 0.95, 0.05):
            for color, moved, length in ((drawing.YELLOW, 0.0, 1.0), (drawing.RED, -beside, share)):
                x, y, _ = drawing.project(view, position + part * length * way + moved)
                drawn.append(np.abs(picture[int(y), int(x)] - np.array(color)).max() < 2.0 / 255.0)
    yield DATA.check(
        "places along the four lines that have their colour", float(np.mean(drawn)), Answer.MACHINE
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "ratio": word.RATIO(2),
        "factor": word.FACTOR(2.2),
        "units": word.UNITS(4.0),
        "filtered": word.FLAG(True, "Whether the results of the comparison are filtered."),
        "shading": word.SHADING(SceneShading.LIT),
        "marks": word.FLAG(True, "Whether the two points and their distances are drawn."),
    },
    methods=(Method("depth texture times the light", make, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
    reference=reference,
)
