"""F003-17: the depth image seen from the light."""

import numpy as np

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.matrices import transform
from fixedpipe.effects.geometry.views import row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Scene
from fixedpipe.effects.scenes.still_life import BETWEEN, LIT_POINT, still_life_and_lamp
from fixedpipe.effects.shadows.lit_scene import depth_pass
from fixedpipe.effects.shadows.shadow_maps import show_depths

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
        yield Check(
            f"{name} depth against the scene's, of rays",
            abs(float(machine) - float(rays)),
            at_most=0.004,
            on=Answer.MACHINE,
            reason="a pixel's centre beside the nearest and the farthest point; depths of triangles "
            "snapped to sixteenths of a pixel",
        )
    yield Check(
        "vertices seen from the light: greatest distance from the middle",
        widest,
        at_most=1.0,
        on=Answer.IDEAL,
        reason="the frustum encloses what throws shadows (Z30)",
    )
    yield Check(
        "the same, at least",
        widest,
        at_least=0.95,
        on=Answer.IDEAL,
        reason="and hardly more, so that no texels are lost",
    )
    for name, value, least, most in (
        ("least", min(window), 0.0, 0.1),
        ("greatest", max(window), 0.85, 0.95),
    ):
        yield Check(
            f"vertices seen from the light: {name} depth",
            value,
            at_least=least,
            on=Answer.IDEAL,
            reason="the planes hold what throws shadows (Z30), and leave white to what is not there",
        )
        yield Check(
            f"vertices seen from the light: {name} depth, at most",
            value,
            at_most=most,
            on=Answer.IDEAL,
            reason="and are close to it, so that near is dark and far is light",
        )
    for on in (Answer.MACHINE, Answer.IDEAL):
        grey = renderer.window(on, figure, _SIZE, marks=False)[..., 0]
        alike = np.abs(grey - shown.depth) <= (0.75 * step if on is Answer.MACHINE else 0.001)
        yield Check(
            "pixels whose grey is the depth that a ray finds",
            float(alike.mean()),
            at_least=0.99,
            on=on,
            reason="silhouettes alone may differ; a byte's rounding on the machine",
        )


FIGURE = Figure(
    id="F003-17",
    title="Depth image seen from the light",
    caption=(
        "The still life's depths as the light sees it: near is dark, far is light; white: nothing there that "
        "throws a shadow. Red, where the map is read for the two points of the final image, F003-18: their "
        "red lines, seen along them."
    ),
    must_see=(
        "The still life from the upper left in shades of grey, without any lighting: the column's top, the "
        "floor's near corner and the ring darkest, objects darker than the floor behind them, the floor "
        "lighter away from the light and yet not white. One red point lies on the floor, the other on the "
        "ball."
    ),
    source="Zwicker2016",
    techniques=("Z10", "Z30"),
    parameters={
        "marks": word.internal(True, "It marks where the map is read, over the greys that checks measure.")
    },
    methods=(Method("depths read and drawn", make, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
)
