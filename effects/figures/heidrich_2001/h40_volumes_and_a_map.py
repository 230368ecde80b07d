"""H40: shadow volumes next to a shadow map of the same scene."""

from fixedpipe.effects.acceptance import shadow_reference
from fixedpipe.effects.acceptance.agreement import compare, lit_mask, truth_of
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.ray_caster import to_light
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.matrices import look_at, perspective
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import detail_of, lamp_around
from fixedpipe.effects.scenes.still_life import still_life, still_life_view
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import modulated_passes, store_map
from fixedpipe.effects.shadows.shadow_volumes import z_fail

DATA = figure_data(__file__, "H40")

_MAP = "shadow map"
# What the map's bias hides, in texels: shadows of what is nearer may be missing (as F003-18's).
CONTACT_TEXELS = 20.0


def close_view(panel, eye, center, field_of_view):
    """A camera that looks closely at the edge of a shadow."""
    projection = perspective(field_of_view, 1.0, 4.0, 16.0)
    return View(panel, look_at(eye, center), projection, tuple(map(float, eye)), False)


def scene(profile, size, *, light, close, ratio, factor, units, background, shading):
    """By shadow volumes, all and from near; by a shadow map, all and from near."""
    objects, panels = still_life(detail_of(size)), row_of_panels(4, size)
    lamp, edge = lamp_around(objects, light), map_edge(size, ratio)
    views = [
        still_life_view(panel) if k % 2 == 0 else close_view(panel, *close) for k, panel in enumerate(panels)
    ]
    out = [*store_map(objects, lamp, _MAP, edge, (4 * size, size), factor=factor, units=units)]
    for view in views[:2]:
        out += (view.panel.clear(background), *z_fail(objects, view, lamp, profile, shading))
    for view in views[2:]:
        out += (
            view.panel.clear(background),
            *modulated_passes(objects, view, lamp, _MAP, profile, shading, filtered=False),
        )
    return tuple(out)


def towards_light(truth, least=0.15):
    """Which pixels show surfaces that face the light, with a cosine above ``least``: bool [h, w]. Elsewhere a
    map's bias decides, and no light is missed.
    """
    directions, _ = to_light(truth.shown.points, truth.lamp)
    return truth.shown.something & (dot(truth.shown.normals, normalize(directions)) > least)


_MEASURED = "; measured at the first correct picture, with at most a third of slack"
# Pixels of each picture that agree with rays by shadow volumes, and by both algorithms with each other.
_PLACES = (("all of the scene", 0.9986, 0.9928), ("from near", 0.9994, 0.984))


def checks(figure, renderer):
    """Both against rays and against each other, all of the scene and the edge of one shadow."""
    size, p = 256, figure.values
    objects, panel = still_life(detail_of(size)), Panel(0, 0, size, size)
    lamp, edge = lamp_around(objects, p["light"]), map_edge(size, p["ratio"])
    views = still_life_view(panel), close_view(panel, *p["close"])
    truths = [truth_of(objects, view, lamp) for view in views]
    faced = [towards_light(truth) for truth in truths]

    def panels(on, **changes):
        mask = lit_mask(renderer.window(on, figure, size, shading=SceneShading.MASK, **changes))
        return [mask[:, k * size : (k + 1) * size] for k in range(4)]

    def unlike(masks, k):
        return float((masks[k] != masks[2 + k])[faced[k]].mean())

    for on in Answer:
        masks = panels(on)
        for k, (place, least, alike) in enumerate(_PLACES):
            volumes = compare(masks[k], truths[k], where=faced[k])
            mapped = compare(
                masks[2 + k], truths[k], map_edge=edge, contact=CONTACT_TEXELS / edge, where=faced[k]
            )
            name = f"shadow volumes: pixels that agree with rays, {place}"
            reason = "vertices snapped to sixteenths of a pixel" + _MEASURED
            yield Check(name, volumes.agreeing, at_least=least, on=on, reason=reason)
            yield DATA.check(
                "shadow volumes: pixels unlike the rays', not on an edge, {place}",
                volumes.other,
                on,
                place=place,
            )
            yield DATA.check(
                "shadow map: part of pixels unlike the rays' for no understood reason, {place}",
                mapped.other / mapped.compared,
                on,
                place=place,
            )
            name = f"pixels that both draw alike, {place}"
            reason = f"edges within texels of a map of {edge} by {edge}" + _MEASURED
            yield Check(name, 1.0 - unlike(masks, k), at_least=alike, on=on, reason=reason)
            if k == 1:
                yield DATA.check(
                    "shadow map's pixels unlike the rays', over the volumes', from near",
                    (1.0 - mapped.agreeing) / max(1.0 - volumes.agreeing, 1e-9),
                    on,
                )
    finer = panels(Answer.MACHINE, ratio=4.0 * p["ratio"])
    yield DATA.check(
        ("pixels that both draw unlike from near, with four times the map's edge, over those before"),
        unlike(finer, 1) / max(unlike(masks, 1), 1e-9),
        Answer.MACHINE,
    )


def reference(size, *, light, close, background, shading, **_):
    """Both views' shadows by rays, twice."""
    objects, panel = still_life(detail_of(size)), Panel(0, 0, size, size)
    views = still_life_view(panel), close_view(panel, *close)
    shots = [
        shadow_reference.Shot(objects, view, (lamp_around(objects, light),), background, shading)
        for view in views
    ]
    return shadow_reference.row(size, shots * 2)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "light": word.POSITION((-5.4, 8.4, 3.1), "Where the light is."),
        "close": word.of(
            word.Several((word.POSITION_KIND, word.POSITION_KIND, word.Number(1.0, 90.0))),
            ((0.6, 4.9, 8.4), (1.02, 0.6, -0.8), 7.5),
            "The camera of the panels from near: its place, what it looks at, its field of view in degrees.",
        ),
        "ratio": word.RATIO(1.4),
        "factor": word.FACTOR(2.0),
        "units": word.UNITS(4.0),
        "background": word.BACKDROP(BACKGROUND),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("stencil buffer and depth texture", scene, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
    reference=reference,
)
