"""F003-25: shadow volumes: silhouette edges, the sides that they are extruded to, and the shadows."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import shadow_reference
from fixedpipe.effects.acceptance.agreement import cosines, silhouettes
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared import lit_rings
from fixedpipe.effects.figures.zwicker_2016.shared.counted_volumes import (
    count_checks,
    known_counts,
    lamp_without_frustum,
)
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective, product, rotation
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Object, Scene, detail_of, floor
from fixedpipe.effects.scenes.still_life import still_life
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.lit_scene import lit_pass, unlit_pass

DATA = figure_data(__file__, "F003-25")

_HIDDEN = (0.98, 0.30, 0.26)
# How far a ray is drawn before it meets the silhouette: from inside the picture on, world units.
_RAY = 1.15
_RAYS = (0.97, 0.90, 0.70)
_FLOOR = (0.62, 0.60, 0.56)


def solids(detail, light):
    """A cube that stands on a floor and a torus that floats above it."""
    cube = surfaces.box(1.15, 1.15, 1.15).rotated(rotation("y", 31.0)).moved(-0.85, 0.575, 0.1)
    around, across = (detail, detail // 4 * 2) if detail < 24 else (3 * detail, detail * 2 // 5 * 2)
    ring = lit_rings.ring(
        around,
        across,
        0.62,
        0.2,
        turns=(rotation("x", 34.0), rotation("y", -20.0)),
        place=(0.75, 1.2, 0.0),
        light=light,
    )
    return Scene(
        (
            Object("floor", floor(9.5, 4 if detail < 16 else 24), _FLOOR, closed=False),
            Object("cube", cube, (0.34, 0.50, 0.62), 0.1),
            Object("torus", ring, (0.80, 0.42, 0.20), 0.5),
        )
    )


def camera(panel):
    """The figure's camera on a panel."""
    eye = (0.6, 5.4, 6.6)
    return View(panel, look_at(eye, (0.43, 0.66, 0.15)), perspective(33.0, 1.0, 4.5, 20.0), eye, False)


def scene(profile, size, *, light, volume_color, volume_alpha, background):
    """Silhouettes, volumes, shadows, from left to right."""
    left, middle, right = (camera(panel) for panel in row_of_panels(3, size))
    objects, lamp = solids(detail_of(size), light), lamp_without_frustum(light)
    volumes = shadow_volumes.shadow_volumes(objects, lamp.homogeneous)
    loops = [
        volume.positions[loop][:, :3]
        for volume in volumes
        for loop in shadow_volumes.silhouette_loops(volume)
    ]
    # The rays that pass each object farthest to the left and to the right.
    outlines = [volume.positions[volume.silhouette[:, 0], :3] for volume in volumes]
    ends = [outline[pick(outline[:, 0])] for outline in outlines for pick in (np.argmin, np.argmax)]
    ways = [end - np.array(light) for end in ends]
    rays = [
        np.stack([end - _RAY / np.sqrt(dot(way, way)) * way, end])
        for way, end in zip(ways, ends, strict=True)
    ]
    endless = shadow_volumes.infinite_view(middle)
    return (
        left.panel.clear(background),
        *unlit_pass(objects, left),
        *lit_pass(objects, left, lamp, label="all of the light"),
        drawing.strokes(
            "rays of the light along the silhouettes",
            left,
            rays,
            _RAYS,
            width=1.1,
            dash=drawing.DASH,
            depth_test=drawing.VISIBLE,
        ),
        drawing.strokes("silhouette edges, hidden ones too", left, loops, _HIDDEN, width=1.4),
        drawing.strokes(
            "silhouette edges that are seen",
            left,
            loops,
            drawing.YELLOW,
            width=1.6,
            depth_test=drawing.VISIBLE,
        ),
        middle.panel.clear(background),
        *unlit_pass(objects, endless),
        *lit_pass(objects, endless, lamp, label="all of the light"),
        shadow_volumes.show_volumes(
            "extruded silhouette edges", volumes, endless, volume_color, volume_alpha
        ),
        right.panel.clear(background),
        *shadow_volumes.z_fail(objects, right, lamp, profile),
    )


def odd_vertices(volumes):
    """How many vertices have an odd number of silhouette edges."""
    return sum(int((np.bincount(volume.silhouette.ravel()) % 2).sum()) for volume in volumes)


def _sides_over(tinted, plain, color, alpha):
    """How many sides of one colour, each covering ``alpha``, lie over pixels: float64 [h, w]."""
    left, whole = (np.abs(np.array(color) - picture).sum(axis=-1) for picture in (tinted, plain))
    return np.log(np.maximum(left, 1e-3) / np.maximum(whole, 1e-3)) / np.log(1.0 - alpha)


@lru_cache(2)
def _known(size, light):
    """``known_counts`` of the figure on a panel of ``size``: rays through thousands of sides, seconds."""
    view = camera(Panel(0, 0, size, size))
    return known_counts(solids(detail_of(size), light), view, lamp_without_frustum(light))


def panel_checks(figure, renderer, truth, counts, volumes):
    """The figure's own panels on the machine: silhouettes, sides and shadows, each where rays have them."""
    size, p = truth.view.panel.width, figure.values
    left, middle, right = np.split(renderer.machine_window(figure, size), 3, axis=1)
    _, plain, _ = np.split(renderer.machine_window(figure, size, volume_alpha=0.0), 3, axis=1)
    inner = truth.shown.something & ~silhouettes(truth)
    sides = _sides_over(middle, plain, p["volume_color"], p["volume_alpha"])
    number = np.round(sides)
    matching = (number >= counts) & ((number - counts) % 2 == 0)
    faced = inner & (cosines(truth) > 0.1)
    darkened = np.abs(right - plain).max(axis=-1) > 1.5 / 255.0
    middles = np.concatenate([v.positions[v.silhouette, :3].mean(axis=1) for v in volumes])
    x, y, w = (
        np.array(row[:3]) @ middles.T + row[3]
        for row in (product(truth.view.projection, truth.view.modelview)[k] for k in (0, 1, 3))
    )
    column, row = ((0.5 + 0.5 * c / w) * size for c in (x, y))
    at = left[row.astype(int), column.astype(int)]
    drawn = np.min([np.abs(at - c).max(axis=-1) for c in (_HIDDEN, drawing.YELLOW)], axis=0) < 1.5 / 255.0
    return (
        DATA.check("silhouette edges whose middle has a line's colour", float(drawn.mean()), Answer.MACHINE),
        DATA.check(
            "pixels with as many sides of volumes over them as entering and leaving takes",
            float(matching[inner].mean()),
            Answer.MACHINE,
        ),
        DATA.check(
            "pixels that face the light and are darker than without shadows where rays say so",
            float((darkened == (counts > 0))[faced].mean()),
            Answer.MACHINE,
        ),
    )


def checks(figure, renderer):
    """Closed loops, closed volumes, counts, and the pixels of the panels."""
    size = 384
    light = figure.values["light"]
    for name, objects in (("cube and torus", solids(40, light)), ("the still life", still_life(40))):
        for lamp in (lamp_without_frustum(light), lamp_without_frustum(light, infinite=True)):
            volumes = shadow_volumes.shadow_volumes(objects, lamp.homogeneous)
            kind = "a light at infinity" if lamp.infinite else "a point light"
            yield DATA.check(
                "vertices of {name} with an odd number of silhouette edges, {kind}",
                odd_vertices(volumes),
                Answer.IDEAL,
                name=name,
                kind=kind,
            )
    known, objects, lamp = _known(size, light), solids(detail_of(size), light), lamp_without_frustum(light)
    reason = "the catalogue's; vertices snapped to sixteenths of a pixel move edges"
    yield from count_checks(renderer, camera(Panel(0, 0, size, size)), objects, lamp, 0.999, reason, known)
    volumes = shadow_volumes.shadow_volumes(objects, lamp.homogeneous)
    yield from panel_checks(figure, renderer, *known, volumes)


def reference(size, *, light, background, **_):
    """The third panel's shadows by rays; the others have no reference."""
    objects, view = solids(detail_of(size), light), camera(Panel(0, 0, size, size))
    shot = shadow_reference.Shot(objects, view, (lamp_without_frustum(light),), background)
    return shadow_reference.row(size, [None, None, shot])


FIGURE = Figure(
    **DATA.words,
    parameters={
        "light": word.POSITION((-1.9, 5.9, -1.8), "Where the light is."),
        "volume_color": word.COLOR((0.99, 0.80, 0.30), "The colour of the volumes' sides."),
        "volume_alpha": word.SHARE(0.2, "How much each side of a volume covers."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("stencil buffer", scene, ("OPENGL_1_2", "GEFORCE_256", "OCTANE", "INFINITE_REALITY")),),
    acceptance=checks,
    reference=reference,
)
