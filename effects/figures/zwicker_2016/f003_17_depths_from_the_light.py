"""F003-17: the depth image seen from the light."""

import numpy as np

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.matrices import transform
from fixedpipe.effects.geometry.views import row_of_panels
from fixedpipe.effects.scenes.still_life import still_life_and_lamp
from fixedpipe.effects.shadows.lit_scene import depth_pass
from fixedpipe.effects.shadows.shadow_maps import show_depths

DEPTHS = "depths from the light"


def make(profile, size):
    """The first pass as it fills the depth buffer, and the depth buffer as grey."""
    (panel,) = row_of_panels(1, size)
    scene, light = still_life_and_lamp(size)
    return (
        panel.clear((0.0, 0.0, 0.0)),
        *depth_pass(scene, light.view(panel)),
        *show_depths(panel, DEPTHS, profile),
    )


_SIZE = 256


def checks(figure, renderer):
    """The depths read, and the picture made of them, against rays from the light."""
    scene, light = still_life_and_lamp(_SIZE)
    (panel,) = row_of_panels(1, _SIZE)
    shown = ray_caster.visible(ray_caster.scene_caster(scene), light.view(panel))
    commands = figure.commands(renderer.profile, _SIZE, renderer.method)
    depths = renderer.execute(commands, renderer.profile, _SIZE, _SIZE).pixels[DEPTHS]
    depths = depths / (2.0**renderer.profile.widest_depth - 1.0)
    hit = depths < 1.0
    # What the light's frustum was fitted to.
    window = [
        0.5 + 0.5 * z / w
        for *_, z, w in (
            transform(light.projection, transform(light.modelview, (*corner, 1.0)))
            for corner in scene.corners().tolist()
        )
    ]
    clip = [
        transform(light.projection, transform(light.modelview, (*p, 1.0)))
        for thing in scene.objects
        for p in thing.surface.positions.tolist()
    ]
    widest = max(max(abs(x), abs(y)) / w for x, y, _, w in clip)
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
    yield Check(
        "corners of the scene's box: least depth",
        min(window),
        at_least=0.0,
        on=Answer.IDEAL,
        reason="the frustum encloses the scene (Z30)",
    )
    yield Check(
        "corners of the scene's box: greatest depth",
        max(window),
        at_most=1.0,
        on=Answer.IDEAL,
        reason="as before",
    )
    yield Check(
        "corners of the scene's box: least depth, close to the near plane",
        min(window),
        at_most=0.08,
        on=Answer.IDEAL,
        reason="and hardly more than the scene: two hundredths of its extent on either side",
    )
    for on in (Answer.MACHINE, Answer.IDEAL):
        grey = renderer.window(on, figure, _SIZE)[..., 0]
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
    caption="The still life's depths as the light sees it: near is dark, far is light, nothing is white.",
    must_see=(
        "The still life from the upper left in shades of grey, without any lighting: the floor's near "
        "corner and the ring darkest, objects darker than the floor behind them, the floor lighter away from "
        "the light, white where nothing is."
    ),
    source="Zwicker2016",
    techniques=("Z10", "Z30"),
    methods=(Method("depths read and drawn", make, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
)
