"""F003-10: why shadows are important, cues on the scene's lighting: where is the light? (Z29, Z10, Z23)."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import agreement, each_thing, ray_caster, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, row_of_panels
from fixedpipe.effects.scenes import objects_and_lamps, still_life
from fixedpipe.effects.shadows import shadow_maps, shadow_volumes
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge

DATA = figure_data(__file__, "F003-10")

# World units along the light that the polygon offset hides, largest: measured, where a lamp grazes most.
_BIAS = 0.05
# Turns of the lamp about the scene, in degrees, among which the one that fits the shadows best is looked for.
_TURNS = tuple(range(-60, 61, 10))


def _lamps(scene, positions):
    return [objects_and_lamps.lamp_around(scene, position) for position in positions]


def plan(panel, scene, position):
    """The scene, the lamp and the camera from above, in the upper right corner of a panel: the lamp is beside
    or above the picture.
    """
    edge = panel.height // 4
    inset = Panel(panel.x + panel.width - edge - edge // 8, panel.height - edge - edge // 8, edge, edge)
    # x to the right, z towards the viewer down.
    sheet = drawing.sheet(inset, 6.9, (0.0, -3.9))
    eye, dark = still_life.still_life_view(panel).eye, (0.10, 0.10, 0.12)
    middles = {thing.name: thing.surface.positions.mean(axis=0) for thing in scene.objects if thing.closed}
    lamp, middle = (position[0], -position[2]), (0.0, 0.0)
    out = [
        inset.clear(dark, "clear the plan"),
        drawing.polygon(
            "floor", sheet, [(-2.6, -2.6), (2.6, -2.6), (2.6, 2.6), (-2.6, 2.6)], (0.24, 0.24, 0.26)
        ),
        drawing.stroke("from the lamp", sheet, [lamp, middle], drawing.YELLOW, width=4.0),
    ]
    for thing in scene.objects:
        if thing.closed:
            x, _, z = middles[thing.name]
            out.append(drawing.dots(thing.name, sheet, (x, -z), thing.color, radius=15.0))
    # The camera: its position, and the two sides of what it sees.
    x, z = eye[0], -eye[2]
    sides = [[(x, z), (x + side * 1.4, z + 2.8)] for side in (-1.0, 1.0)]
    return (
        *out,
        drawing.dots("the lamp", sheet, lamp, drawing.YELLOW, radius=18.0),
        drawing.strokes("the camera", sheet, sides, drawing.INK, width=6.0),
    )


def map_scene(profile, size, *, positions, texels, factor, shading, background, plans):
    """The still life with its own shadow map for each of the lamp's ``positions``.

    ``texels``: texels of a map's edge for each pixel of a panel's edge, at most; ``factor``: the polygon
    offset's.
    """
    scene = still_life.still_life(objects_and_lamps.detail_of(size))
    panels = row_of_panels(len(positions), size)
    lamps = _lamps(scene, positions)
    out, window = [], (len(panels) * size, size)
    for k, lamp in enumerate(lamps):
        name, edge = f"shadow map {k}", map_edge(size, texels)
        out += shadow_maps.store_map(scene, lamp, name, edge, window, factor=factor)
    for k, (panel, lamp) in enumerate(zip(panels, lamps, strict=True)):
        view = still_life.still_life_view(panel)
        out += (
            panel.clear(background),
            *shadow_maps.modulated_passes(scene, view, lamp, f"shadow map {k}", profile, shading),
        )
        if plans:
            out += plan(panel, scene, positions[k])
    return tuple(out)


def volume_scene(profile, size, *, positions, shading, background, plans):
    """The same with shadow volumes."""
    scene = still_life.still_life(objects_and_lamps.detail_of(size))
    out = []
    for panel, lamp in zip(row_of_panels(len(positions), size), _lamps(scene, positions), strict=True):
        view = still_life.still_life_view(panel)
        out += (
            panel.clear(background),
            *shadow_volumes.z_pass(scene, view, lamp, profile, shading),
        )
        if plans:
            out += plan(panel, scene, lamp.position)
    return tuple(out)


def best_turn(mask, truth):
    """By how many degrees a lamp would have to be turned about the scene to throw the shadows of a mask."""
    (x, y, z), (cx, _, cz) = truth.lamp.position, truth.lamp.target

    def agreeing(turn):
        dx, _, dz = rotate(rotation("y", turn), np.array([x - cx, 0.0, z - cz]))
        turned = replace(truth.lamp, position=(cx + dx, y, cz + dz))
        return (ray_caster.lit(truth.caster, truth.shown, turned) == mask)[truth.shown.something].mean()

    return max(_TURNS, key=agreeing)


def _compared(figure, renderer, on, size):
    """Of each panel its mask, on the machine or the ideal, the truth, and their Agreement."""
    positions = figure.values["positions"]
    scene = still_life.still_life(objects_and_lamps.detail_of(size))
    view = still_life.still_life_view(row_of_panels(1, size)[0])
    texels = figure.values_of(renderer.method).get("texels")
    understood = {"map_edge": map_edge(size, texels), "contact": _BIAS, "grazing": 0.1} if texels else {}
    mask = agreement.lit_mask(renderer.window(on, figure, size, shading=SceneShading.MASK, plans=False))
    for k, lamp in enumerate(_lamps(scene, positions)):
        part, truth = mask[:, k * size : (k + 1) * size], agreement.truth_of(scene, view, lamp)
        yield part, truth, agreement.compare(part, truth, **understood)


@lru_cache(1)
def _things(size, positions):
    """What each thing changes, by panels: ``each_thing.changes_of``."""
    scene = still_life.still_life(objects_and_lamps.detail_of(size))
    view = still_life.still_life_view(row_of_panels(1, size)[0])
    return {
        number: each_thing.changes_of(shadow_reference.Shot(scene, view, (lamp,)))
        for number, lamp in enumerate(_lamps(scene, positions))
    }


def checks(figure, renderer):
    """The masks against rays, and where the lamp is, read off the shadows."""
    machine = list(_compared(figure, renderer, Answer.MACHINE, figure.size // 2))
    # The ideal takes a second for four times the pixels.
    ideal = list(_compared(figure, renderer, Answer.IDEAL, figure.size // 4))
    found = {Answer.MACHINE: [a for _, _, a in machine]}
    coarse = {Answer.IDEAL: [a for _, _, a in ideal]}
    turns = [best_turn(mask, truth) for mask, truth, _ in machine]
    if "texels" in renderer.method.parameters:
        agreeing = (*agreement.map_checks(coarse, 0.97), *agreement.map_checks(found))
    else:
        agreeing = (*agreement.volume_checks(coarse, 0.996), *agreement.volume_checks(found, 0.998))
    return (
        *agreeing,
        DATA.check(
            "lamp turned so that its shadows fit best - lamp, largest, degrees",
            max(map(abs, turns)),
            Answer.MACHINE,
            which=_TURNS[0],
            which_2=_TURNS[-1],
        ),
        *each_thing.checks(DATA, figure, renderer, _things(figure.size, figure.values["positions"])),
    )


def reference(size, *, positions, shading, background, plans, **_):
    """The three panels with their shadows by rays, under the same plans."""
    scene, panels = (
        still_life.still_life(objects_and_lamps.detail_of(size)),
        row_of_panels(len(positions), size),
    )
    picture = shadow_reference.row(
        size,
        [
            shadow_reference.Shot(scene, still_life.still_life_view(panel), (lamp,), background, shading)
            for panel, lamp in zip(panels, _lamps(scene, positions), strict=True)
        ],
    )
    if not plans:
        return picture
    drawn = [
        c for panel, position in zip(panels, positions, strict=True) for c in plan(panel, scene, position)
    ]
    return shadow_reference.overlaid(picture, drawn)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "positions": word.of(
            word.Several((word.POSITION_KIND,) * len(still_life.LAMP_POSITIONS)),
            still_life.LAMP_POSITIONS,
            "Where the lamp is in each panel.",
            "world coordinates",
        ),
        "shading": word.SHADING(SceneShading.LIT),
        "background": word.BACKDROP(BACKGROUND),
        "plans": word.FLAG(True, "Whether a plan shows where the lamp is."),
    },
    methods=(
        Method(
            "shadow maps",
            map_scene,
            ("GEFORCE_3", "INFINITE_REALITY"),
            parameters={"texels": word.RATIO(4), "factor": word.FACTOR(2.0)},
        ),
        Method("shadow volumes", volume_scene, ("OPENGL_1_2",)),
    ),
    acceptance=checks,
    reference=reference,
)
