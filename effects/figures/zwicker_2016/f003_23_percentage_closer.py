"""F003-23: a shadow's edge by one comparison, by 2x2 filtered ones (Z17) and by 8x8 (Z18)."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import agreement, each_thing, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, perspective_view, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import (
    Scene,
    detail_of,
    lamp_around,
)
from fixedpipe.effects.scenes.still_life import LAMP_POSITIONS, still_life
from fixedpipe.effects.shadows.lit_scene import AMBIENT, SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import accumulated_passes, modulated_passes, store_map

DATA = figure_data(__file__, "F003-23")

HARD, FILTERED, KERNEL = range(3)


def scene_of(size):
    """The still life's vase alone on its floor, and the lamp."""
    objects = {thing.name: thing for thing in still_life(detail_of(size)).objects}
    scene = Scene((objects["floor"], objects["vase"], objects["ground"]))
    return scene, lamp_around(scene, LAMP_POSITIONS[0])


def view_of(panel):
    """Close to the vase's shadow."""
    return perspective_view(panel, (1.6, 4.2, 4.6), (0.75, 0.35, -0.35), field_of_view=26.0, radius=4.0)


def make(profile, size, *, ratio, factors, kernel, shading):
    """The three side by side. ``factors``: PolygonOffset's for each; ``ratio``: the map's edge over size.

    The compared texel lies beside the place by up to half a texel, one texel, or half the kernel. The offset
    must grow with this distance.
    """
    panels, edge = row_of_panels(3, size), map_edge(size, ratio)
    scene, lamp = scene_of(size)
    out = []
    for k, (panel, factor) in enumerate(zip(panels, factors, strict=True)):
        view = view_of(panel)
        out += store_map(scene, lamp, "shadow map", edge, (3 * size, size), factor=factor)
        out.append(panel.clear(BACKGROUND))
        if k == KERNEL:
            out += accumulated_passes(scene, view, lamp, "shadow map", edge, profile, kernel, shading)
        else:
            out += modulated_passes(scene, view, lamp, "shadow map", profile, shading, filtered=k == FILTERED)
    return tuple(out)


_SIZE = 96
# A map whose kernel is narrower than the shadow, so that an edge has one side lit and one dark, and whose
# texels are smaller than pixels, so that it does not matter which of them an outline happens to cover.
_RATIO = 512 / _SIZE
# Right of it, in world coordinates, the shadow's edge is the vase's silhouette and no contact.
_FREE_OF_CONTACT = 0.9


def _edges(truth):
    """Floor pixels with the other answer beside them, left, right, above or below."""
    lit, ground = truth.lit, truth.shown.object == 0
    out = np.zeros_like(lit)
    for axis in (0, 1):
        first, second = (
            tuple(slice(*(cut if k == axis else (None,))) for k in (0, 1)) for cut in ((None, -1), (1, None))
        )
        change = (lit[first] != lit[second]) & ground[first] & ground[second]
        out[first] |= change
        out[second] |= change
    return out & (truth.shown.points[..., 0] > _FREE_OF_CONTACT)


def _away_from_edges(truth, pixels=3):
    """Floor that is lit, and floor in shadow free of contact, with nothing else so many pixels around."""
    ground = truth.shown.object == 0
    lit, dark = ground & truth.lit, ground & ~truth.lit
    out = []
    for area in (lit, dark & (truth.shown.points[..., 0] > _FREE_OF_CONTACT)):
        inner = area.copy()
        inner[:pixels], inner[-pixels:], inner[:, :pixels], inner[:, -pixels:] = False, False, False, False
        for dy in range(-pixels, pixels + 1):
            for dx in range(-pixels, pixels + 1):
                inner &= np.roll(area, (dy, dx), (0, 1))
        out.append(inner)
    return out


def _reach(values, truth, edge, texels):
    """How far from a shadow's true edge the floor is neither lit nor dark, in texels of a map of ``texels``:
    the greatest of the least 99 in 100 pixels.
    """
    matrix = np.array(truth.lamp.texture_matrix)
    s, t, _, q = (truth.shown.points @ row[:3] + row[3] for row in matrix)
    places = np.stack([s / q, t / q], axis=-1) * texels
    between = (values > 0.01) & (values < 0.99) & (truth.shown.object == 0)
    between &= truth.shown.points[..., 0] > _FREE_OF_CONTACT + 0.1
    if not between.any():
        return 0.0
    apart = np.linalg.norm(places[between][:, None] - places[edge][None], axis=-1)
    return float(np.percentile(apart.min(axis=1), 99.0))


def checks(figure, renderer):
    """Levels of light on the floor, and how much of it there is at the true edge."""
    kernel = figure.values["kernel"]
    scene, lamp = scene_of(_SIZE)
    truth = agreement.truth_of(scene, view_of(Panel(0, 0, _SIZE, _SIZE)), lamp)
    edge, ground = _edges(truth), truth.shown.object == 0
    light, umbra = _away_from_edges(truth)
    for on in Answer:
        picture = renderer.window(on, figure, _SIZE, shading=SceneShading.MASK, ratio=_RATIO)[..., 0]
        hard, filtered, wide = (picture[:, k * _SIZE : (k + 1) * _SIZE] for k in range(3))
        levels = [len(np.unique(np.round(part[ground], 6))) for part in (hard, filtered, wide)]
        steps = np.abs(wide[ground] * kernel**2 - np.round(wide[ground] * kernel**2)) / kernel**2
        yield DATA.check("levels of one comparison", levels[HARD], on)
        yield DATA.check("levels of one comparison, at least", levels[HARD], on)
        yield DATA.check("levels of 2x2 filtered comparisons", levels[FILTERED], on)
        yield DATA.check(
            "{kernel}x{kernel} comparisons: distance from a multiple of 1/{n}, largest",
            float(steps.max()),
            on,
            at_most=1e-9 if on is Answer.IDEAL else 2.0 / 255.0,
            kernel=kernel,
            n=kernel**2,
        )
        yield DATA.check(
            "levels of {kernel}x{kernel} comparisons",
            len(np.unique(np.round(wide[ground] * kernel**2))),
            on,
            at_most=kernel**2 + 1,
            kernel=kernel,
        )
        yield DATA.check(
            "levels of {kernel}x{kernel} comparisons, at least",
            len(np.unique(np.round(wide[ground] * kernel**2))),
            on,
            at_least=kernel**2 // 2,
            kernel=kernel,
        )
        for name, part in (("1", hard), ("2x2", filtered), (f"{kernel}x{kernel}", wide)):
            yield DATA.check(
                "{name}: light on the floor away from shadows, mean", float(part[light].mean()), on, name=name
            )
        reach = _reach(wide, truth, edge, map_edge(_SIZE, _RATIO))
        yield DATA.check(
            "{kernel}x{kernel}: how far the soft edge reaches on either side, texels",
            reach,
            on,
            at_most=0.5 * kernel + 1.5,
            kernel=kernel,
        )
        yield DATA.check(
            "{kernel}x{kernel}: how far the soft edge reaches, at least",
            reach,
            on,
            at_least=0.4 * kernel,
            kernel=kernel,
        )
        for name, part in (("2x2", filtered), (f"{kernel}x{kernel}", wide)):
            yield DATA.check(
                "{name} at the true edge: mean's distance from one half",
                abs(float(part[edge].mean()) - 0.5),
                on,
                name=name,
            )
    picture = renderer.machine_window(figure, _SIZE, ratio=_RATIO)
    ambient = np.array(AMBIENT[:3]) * np.array(scene.objects[0].color)
    dark = [picture[:, k * _SIZE : (k + 1) * _SIZE][umbra] for k in range(3)]
    yield DATA.check(
        "umbra on the floor less the ambient light, largest",
        float(np.abs(np.array(dark) - ambient).max()),
        Answer.MACHINE,
        at_most=1.5 / 255.0,
    )
    things = _things(figure.size)
    yield from each_thing.checks(DATA, figure, renderer, dict.fromkeys((HARD, FILTERED, KERNEL), things))


@lru_cache(1)
def _things(size):
    """What each thing changes, the same in every panel: ``each_thing.changes_of``."""
    scene, lamp = scene_of(size)
    return each_thing.changes_of(shadow_reference.Shot(scene, view_of(Panel(0, 0, size, size)), (lamp,)))


def reference(size, *, shading, **_):
    """The shadow by rays, the same in every panel: a point light's has a sharp edge."""
    scene, lamp = scene_of(size)
    shot = shadow_reference.Shot(scene, view_of(Panel(0, 0, size, size)), (lamp,), shading=shading)
    return shadow_reference.row(size, [shot] * 3)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "ratio": word.RATIO(0.7),
        "factors": word.of(
            word.Several((word.FACTOR.kind,) * 3),
            (2.0, 3.0, 9.0),
            "The factor of the polygon offset of each panel.",
        ),
        "kernel": word.of(word.Whole(1, 16), 8, "Comparisons along an edge of the third panel's kernel."),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("four comparisons in a pass", make, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)
