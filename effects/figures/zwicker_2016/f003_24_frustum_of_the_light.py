"""F003-24: the final image, the scene from the light, its depth map, and the frustum that T maps to a box."""

import numpy as np

from fixedpipe.effects.acceptance import agreement, ray_caster, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.matrices import look_at, perspective, transform
from fixedpipe.effects.geometry.vectors import cross, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Scene
from fixedpipe.effects.scenes.still_life import still_life_and_lamp, still_life_view
from fixedpipe.effects.shadows.lit_scene import SceneShading, depth_pass, map_edge
from fixedpipe.effects.shadows.shadow_maps import modulated_passes, show_depths, store_map

DATA = figure_data(__file__, "F003-24")

# What a depth of one is drawn as: a white panel would outshine the others.
WHITE = 0.7
# Of the frustum's edges below the ground and behind things.
_HIDDEN = (0.74, 0.62, 0.26)
# Edges of a box whose corners are numbered by their coordinates' bits: z is the lowest.
_EDGES = tuple((a, a | bit) for bit in (1, 2, 4) for a in range(8) if not a & bit)


def frustum_corners(lamp):
    """The corners of a perspective lamp's frustum in world coordinates, float64 [8, 3].

    They are computed from the lamp's place and direction, not from its matrices. Bits 4, 2 and 1 of a
    corner's number mean left or right, bottom or top, near or far.
    """
    position = np.array(lamp.position)
    forward = normalize(np.array(lamp.target) - position)
    side = normalize(cross(forward, np.array([0.0, 1.0, 0.0])))
    above = cross(side, forward)
    tangent = np.tan(np.radians(lamp.field_of_view) / 2)
    return np.array(
        [
            position + depth * (forward + x * tangent * side + y * tangent * above)
            for x in (-1, 1)
            for y in (-1, 1)
            for depth in (lamp.near, lamp.far)
        ]
    )


def outside_view(panel):
    """Scene and lamp from the side."""
    eye = (6.5, 15.0, 16.5)
    return View(panel, look_at(eye, (-0.7, 1.0, 0.9)), perspective(41.0, 1.0, 3.0, 80.0), eye, False)


def frustum(panel, lamp):
    """The frustum's edges and the lamp, with their names, over the scene from outside."""
    view, corners = outside_view(panel), np.round(frustum_corners(lamp), 6)
    rays = [np.stack([np.array(lamp.position), corners[k]]) for k in (0, 2, 4, 6)]
    box = [corners[[a, b]] for a, b in _EDGES]
    return (
        drawing.strokes("rays from the lamp", view, rays, drawing.FAINT, dash=drawing.DASH),
        drawing.strokes("the light's frustum, what is hidden", view, box, _HIDDEN, dash=drawing.DASH),
        drawing.strokes(
            "the light's frustum", view, box, drawing.YELLOW, width=1.6, depth_test=drawing.VISIBLE
        ),
        drawing.dots("the lamp", view, [lamp.position], drawing.YELLOW, radius=4.0),
        drawing.text("lamp", view, lamp.position, drawing.INK, align=(-1, 0), offset=(8.0, 0.0)),
        drawing.text("near", view, corners[2], drawing.INK, align=(-1, -1), offset=(4.0, 3.0)),
        drawing.text("far", view, corners[5], drawing.INK, align=(-1, 0), offset=(9.0, 2.0)),
    )


def make(profile, size, *, ratio, factor, units, shading):
    """The four side by side."""
    final, from_light, depths, outside = row_of_panels(4, size)
    scene, light = still_life_and_lamp(size)
    passes = {"profile": profile, "shading": shading, "filtered": True}
    out = [
        drawing.load_font(),
        *store_map(
            scene, light, "shadow map", map_edge(size, ratio), (4 * size, size), factor=factor, units=units
        ),
    ]
    for panel, view in (
        (final, still_life_view(final)),
        (from_light, light.view(from_light)),
        (outside, outside_view(outside)),
    ):
        out.append(panel.clear(BACKGROUND))
        out += modulated_passes(scene, view, light, "shadow map", **passes)
    out += (
        *frustum(outside, light),
        depths.clear((0.0, 0.0, 0.0)),
        *depth_pass(scene, light.view(depths)),
        *show_depths(depths, "depths from the light", profile, WHITE),
    )
    return tuple(out)


_SIZE = 128


def _drawn_edges(picture, lamp):
    """How many of the frustum's edges have a line's colour, seen or hidden, along them in the picture from
    outside: at two fifths of the places, as dashes leave gaps.
    """
    size = len(picture)
    view, corners = outside_view(Panel(0, 0, size, size)), frustum_corners(lamp)
    count, colors = 0, np.array([drawing.YELLOW, _HIDDEN])
    for a, b in _EDGES:
        places = [corners[a] + part * (corners[b] - corners[a]) for part in np.arange(0.05, 0.96, 0.05)]
        found = 0
        for x, y, _ in drawing.project(view, places):
            around = picture[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2, None]
            found += (np.abs(around - colors).max(axis=-1) < 2.0 / 255.0).any()
        count += found >= 0.4 * len(places)
    return count


def checks(figure, renderer):
    """T on the frustum's corners, shadows in the image and none from the light, and the depths."""
    scene, light = still_life_and_lamp(_SIZE)
    errors = []
    for number, corner in enumerate(frustum_corners(light).tolist()):
        *strp, q = transform(light.texture_matrix, (*corner, 1.0))
        errors += (abs(v / q - (number >> bit & 1)) for v, bit in zip(strp, (2, 1, 0), strict=True))
    yield DATA.check("T maps the frustum's corners to a cube's, largest error", max(errors), Answer.IDEAL)
    outside = renderer.machine_window(figure, 2 * _SIZE)[:, 6 * _SIZE :]
    yield DATA.check(
        "edges of the frustum that are drawn where it is", _drawn_edges(outside, light), Answer.MACHINE
    )
    panel = Panel(0, 0, _SIZE, _SIZE)
    edge = map_edge(_SIZE, figure.values["ratio"])
    truth = agreement.truth_of(scene, still_life_view(panel), light)
    of_map = ray_caster.scene_caster(Scene(scene.throwing))
    seen = ray_caster.visible(of_map, light.view(panel))
    for on in Answer:
        picture = renderer.window(on, figure, _SIZE, shading=SceneShading.MASK)
        final, from_light, depths = (picture[:, k * _SIZE : (k + 1) * _SIZE] for k in range(3))
        found = agreement.compare(
            agreement.lit_mask(final),
            truth,
            map_edge=edge,
            where=truth.shown.object == 0,
        )
        grey = np.abs(depths[..., 0] - WHITE * seen.depth) <= 0.75 / 255.0
        yield DATA.check("final image: floor that agrees with rays", found.agreeing, on)
        yield DATA.check(
            "from the light: what is lit, of all that is seen",
            float(agreement.lit_mask(from_light)[seen.something].mean()),
            on,
        )
        yield DATA.check("depth map: pixels whose grey is the depth that a ray finds", float(grey.mean()), on)


def reference(size, *, shading, **_):
    """The final image's shadows by rays; the other panels have no reference."""
    scene, light = still_life_and_lamp(size)
    view = still_life_view(Panel(0, 0, size, size))
    shot = shadow_reference.Shot(scene, view, (light,), shading=shading)
    return shadow_reference.row(size, [shot, None, None, None])


FIGURE = Figure(
    **DATA.words,
    parameters={
        "ratio": word.RATIO(2),
        "factor": word.FACTOR(2.2),
        "units": word.UNITS(4.0),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("depth texture times the light", make, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")),),
    acceptance=checks,
    reference=reference,
)
