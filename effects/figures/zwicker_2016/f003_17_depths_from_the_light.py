"""F003-17: the depth image seen from the light."""

import numpy as np

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.matrices import transform
from fixedpipe.effects.geometry.views import row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Scene
from fixedpipe.effects.scenes.still_life import BETWEEN, LIT_POINT, still_life_and_lamp
from fixedpipe.effects.shadows.lit_scene import depth_pass
from fixedpipe.effects.shadows.shadow_maps import show_depths

DATA = figure_data(__file__, "F003-17")

DEPTHS = "depths from the light"


# A red that is seen on greys of any depth.
_RED = (0.90, 0.10, 0.08)


def make(profile, size, *, marks):
    """The first pass as it fills the depth buffer, and the depth buffer as grey."""
    (panel,) = row_of_panels(1, size)
    scene, light = still_life_and_lamp(size)
    view = light.view(panel)
    out = (
        drawing.load_font(),
        panel.clear((0.0, 0.0, 0.0)),
        *depth_pass(scene, view),
        *show_depths(panel, DEPTHS, profile),
    )
    if not marks:
        return out
    white = (1.0, 1.0, 1.0)
    return (
        *out,
        drawing.dots("where the map is read", view, [LIT_POINT, BETWEEN], _RED, radius=3.0),
        drawing.text(
            "read for the\nlit point", view, LIT_POINT, _RED, align=(0, 1), offset=(0.0, -5.0), outline=white
        ),
        drawing.text(
            "read for the\npoint in shadow",
            view,
            BETWEEN,
            _RED,
            align=(0, -1),
            offset=(0.0, 12.0),
            outline=white,
        ),
    )


_SIZE = 256


def checks(figure, renderer):
    """The depths read, and the picture made of them, against rays from the light."""
    scene, light = still_life_and_lamp(_SIZE)
    (panel,) = row_of_panels(1, _SIZE)
    shown = ray_caster.visible(ray_caster.scene_caster(Scene(scene.throwing)), light.view(panel))
    commands = figure.commands(renderer.profile, _SIZE, renderer.method, marks=False)
    depths = renderer.execute(commands, renderer.profile, _SIZE, _SIZE).pixels[DEPTHS]
    depths = depths / (2.0**renderer.profile.widest_depth - 1.0)
    hit = depths < 1.0
    clip = [
        transform(light.projection, transform(light.modelview, (*p, 1.0)))
        for thing in scene.throwing
        for p in thing.surface.positions.tolist()
    ]
    widest = max(max(abs(x), abs(y)) / w for x, y, _, w in clip)
    window = [0.5 + 0.5 * z / w for *_, z, w in clip]
    step = 1.0 / 255.0
    for name, machine, rays in (
        ("least", depths[hit].min(), shown.depth[shown.something].min()),
        ("greatest", depths[hit].max(), shown.depth[shown.something].max()),
    ):
        yield DATA.check(
            "{name} depth against the scene's, of rays",
            abs(float(machine) - float(rays)),
            Answer.MACHINE,
            name=name,
        )
    yield DATA.check("vertices seen from the light: greatest distance from the middle", widest, Answer.IDEAL)
    yield DATA.check("the same, at least", widest, Answer.IDEAL)
    for name, value, least, most in (
        ("least", min(window), 0.0, 0.1),
        ("greatest", max(window), 0.85, 0.95),
    ):
        yield DATA.check(
            "vertices seen from the light: {name} depth", value, Answer.IDEAL, at_least=least, name=name
        )
        yield DATA.check(
            "vertices seen from the light: {name} depth, at most",
            value,
            Answer.IDEAL,
            at_most=most,
            name=name,
        )
    yield from _points_check(figure, renderer, scene, light)
    for on in (Answer.MACHINE, Answer.IDEAL):
        grey = renderer.window(on, figure, _SIZE, marks=False)[..., 0]
        alike = np.abs(grey - shown.depth) <= (0.75 * step if on is Answer.MACHINE else 0.001)
        yield DATA.check("pixels whose grey is the depth that a ray finds", float(alike.mean()), on)


def _points_check(figure, renderer, scene, light):
    """That the two points are red, and lie where the light meets the floor and the ball first."""
    things, size = Scene(scene.throwing), figure.size
    position = np.array(light.position)
    ways = np.array([LIT_POINT, BETWEEN]) - position
    hits = ray_caster.scene_caster(things).nearest(np.stack([position, position]), ways)
    met = [things.objects[ray_caster.scene_caster(things).objects[k]].name for k in hits.triangle]
    view = light.view(row_of_panels(1, size)[0])
    for on in Answer:
        picture, right = renderer.window(on, figure, size), 0
        for name, wanted, point in zip(met, ("floor", "sphere"), (LIT_POINT, BETWEEN), strict=True):
            x, y = (int(c) for c in np.floor(drawing.project(view, point)[:2]))
            red = float(np.abs(picture[y, x] - np.array(_RED)).max()) <= 1.0 / 255.0
            right += red and name == wanted
        yield DATA.check("red points where the light meets the floor and the ball first, of two", right, on)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "marks": word.internal(True, "It marks where the map is read, over the greys that checks measure.")
    },
    methods=(Method("depths read and drawn", make, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
)
