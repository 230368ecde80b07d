"""H35: one shadow map for a walk through a scene, and one for every frame where the light moves."""

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.matrices import look_at, perspective
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import detail_of, lamp_around
from fixedpipe.effects.scenes.still_life import LAMP_POSITIONS, still_life
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import scene_passes, stencil_passes, store_map

DATA = figure_data(__file__, "H35")

# What the eye sees from where: the first two are one walk under one light.
EYES = ((-3.6, 6.0, 9.2), (3.0, 6.0, 9.4), (0.4, 6.0, 9.8), (0.4, 6.0, 9.8))
LAMPS = (0, 0, 1, 2)


def view_of(panel, eye):
    """The still life from a place of the walk."""
    projection = perspective(33.0, panel.width / panel.height, 3.0, 40.0)
    return View(panel, look_at(eye, (0.25, 0.9, 0.0)), projection, eye, False)


def frames(
    profile, scene, panels, lamps, eyes, edge, window, shading=SceneShading.LIT, *, factor, always=False
):
    """A frame for each panel: a new map only where the lamp is another than before (or ``always``)."""
    out, stored = [], None
    for panel, lamp, eye in zip(panels, lamps, eyes, strict=True):
        if always or lamp != stored:
            out += store_map(scene, lamp, "shadow map", edge, window, factor=factor)
            stored = lamp
        out.append(panel.clear(BACKGROUND))
        out += stencil_passes(scene, view_of(panel, eye), lamp, "shadow map", profile, shading)
    return tuple(out)


def make(profile, size, *, ratio, factor, shading, always):
    """Four frames side by side; two of them share a map."""
    panels, scene = row_of_panels(4, size), still_life(detail_of(size))
    lamps = [lamp_around(scene, LAMP_POSITIONS[k]) for k in LAMPS]
    edge, window = map_edge(size, ratio), (4 * size, size)
    return frames(profile, scene, panels, lamps, EYES, edge, window, shading, factor=factor, always=always)


_SIZE = 128


def checks(figure, renderer):
    """Every frame against rays, and how often the scene is drawn in a frame (E000.8)."""
    scene = still_life(detail_of(_SIZE))
    edge = map_edge(_SIZE, figure.values["ratio"])
    picture = renderer.machine_window(figure, _SIZE, shading=SceneShading.MASK)
    for k, (lamp, eye) in enumerate(zip(LAMPS, EYES, strict=True)):
        light = lamp_around(scene, LAMP_POSITIONS[lamp])
        truth = agreement.truth_of(scene, view_of(Panel(0, 0, _SIZE, _SIZE), eye), light)
        ground = truth.shown.object == 0
        mask = agreement.lit_mask(picture[:, k * _SIZE : (k + 1) * _SIZE])
        found = agreement.compare(mask, truth, map_edge=edge, where=ground)
        yield DATA.check("frame {n}: floor that agrees with rays", found.agreeing, Answer.MACHINE, n=k + 1)
        yield DATA.check("frame {n}: floor of no understood kind", found.other, Answer.MACHINE, n=k + 1)
    # A map that the window holds, so that it is drawn once.
    once, always = (
        scene_passes(figure.commands(renderer.profile, _SIZE, renderer.method, ratio=1, always=a), scene)
        for a in (False, True)
    )
    for name, drawn, expected in (
        ("four frames, three lights: times the scene is drawn", once, 3 * 4 + 3),
        ("the same with a map for every frame", always, 4 * 4),
    ):
        yield DATA.check(
            "{name}, off {expected}", abs(drawn - expected), Answer.MACHINE, name=name, expected=expected
        )
    with_all = renderer.machine_window(figure, _SIZE, always=True)
    different = (with_all != renderer.machine_window(figure, _SIZE)).sum()
    yield DATA.check("values that a map for every frame changes", int(different), Answer.MACHINE)


def reference(size, *, shading, **_):
    """Every frame's shadows by rays."""
    scene, shots = still_life(detail_of(size)), []
    for lamp, eye in zip(LAMPS, EYES, strict=True):
        light, view = lamp_around(scene, LAMP_POSITIONS[lamp]), view_of(Panel(0, 0, size, size), eye)
        shots.append(shadow_reference.Shot(scene, view, (light,), shading=shading))
    return shadow_reference.row(size, shots)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "ratio": word.RATIO(2),
        "factor": word.FACTOR(2.6),
        "shading": word.SHADING(SceneShading.LIT),
        "always": word.FLAG(
            False, "Whether a map is stored for every panel, where the lamp stands as before too."
        ),
    },
    methods=(Method("alpha test of the comparison", make, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)
