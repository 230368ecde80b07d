"""F003-11: why shadows are important, contact points and depth: where is the box? (Z29, Z23)."""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, orthographic, rotate, rotation, transform
from fixedpipe.effects.geometry.vectors import unit_vector
from fixedpipe.effects.geometry.views import View, row_of_panels
from fixedpipe.effects.scenes import objects_and_lamps
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.lit_scene import SceneShading, lit_pass, unlit_pass

DATA = figure_data(__file__, "F003-11")

# To the viewer, who is far away, and to the light, which is so too.
_EYE = tuple(unit_vector((0.0, 0.52, 0.86), "The direction to the viewer").tolist())
_LIGHT = (-0.55, 1.5, 0.8)
_EDGE, _TURN = 1.0, 22.0
_HALF_HEIGHT = 1.25
_CENTER = (0.18, 0.56, 0.2)
# The floor's half width, of twelve tiles, three to a panel, so that tiles are halved where it ends; and how
# far it goes behind the box: seen in parallel rays it has no horizon of its own.
_FLOOR, _FLOOR_DEPTH = 5.0, 2.5
_WALL = (0.30, 0.34, 0.40)
_TILES = {"light tiles": (0.66, 0.63, 0.58), "dark tiles": (0.52, 0.50, 0.47)}


def camera(panel):
    """A parallel view from above: an object that moves towards the viewer stays in its place in the
    picture.
    """
    eye = tuple(c + 6.0 * e for c, e in zip(_CENTER, _EYE, strict=True))
    edge = _HALF_HEIGHT
    return View(panel, look_at(eye, _CENTER), orthographic(-edge, edge, -edge, edge, 1.0, 12.0), _EYE, True)


def place(height):
    """A box's centre, ``height`` above the floor, on one line to the viewer for all heights."""
    along = height / _EYE[1]
    return along * _EYE[0], 0.5 * _EDGE + height, along * _EYE[2]


def box_at(height):
    """A floor of tiles, every other of each colour, and the box ``height`` above it."""
    floor = objects_and_lamps.floor(_FLOOR, 12).moved(_CENTER[0], 0.0, _FLOOR - _FLOOR_DEPTH)
    odd = np.add(*np.divmod(np.arange(len(floor.triangles)) // 2, 12)) % 2
    tiles = [
        objects_and_lamps.Object(
            name, replace(floor, triangles=floor.triangles[odd == k]), color, closed=False
        )
        for k, (name, color) in enumerate(_TILES.items())
    ]
    box = surfaces.box(_EDGE, _EDGE, _EDGE).rotated(rotation("y", _TURN)).moved(*place(height))
    return objects_and_lamps.Scene((*tiles, objects_and_lamps.Object("box", box, (0.82, 0.36, 0.18))))


def lamp():
    """Parallel light from the upper left, in front of the box."""
    return objects_and_lamps.Lamp(_LIGHT, (0.0, 0.0, 0.0), -9.0, 9.0, infinite=True, half_width=9.0)


def scene(profile, size, *, heights, shading, background):
    """A panel without shadows, then one with shadow volumes for each of ``heights``."""
    panels = row_of_panels(len(heights) + 1, size)
    thing, view = box_at(heights[0]), camera(panels[0])
    out = [
        panels[0].clear(background),
        *unlit_pass(thing, view, shading),
        *lit_pass(thing, view, lamp(), shading, label="light, whatever is in its way"),
    ]
    for panel, height in zip(panels[1:], heights, strict=True):
        out += (
            panel.clear(background),
            *shadow_volumes.z_pass(box_at(height), camera(panel), lamp(), profile, shading),
        )
    return tuple(out)


def _window(view, point):
    """Window coordinates of a world point in a view."""
    x, y, _, w = transform(view.projection, transform(view.modelview, (*point, 1.0)))
    return (0.5 + 0.5 * x / w) * view.panel.width, (0.5 + 0.5 * y / w) * view.panel.height


def front_edge(height):
    """The ends of the box's lower front edge, in world coordinates."""
    half = 0.5 * _EDGE
    ends = np.array([[-half, -half, half], [half, -half, half]])
    return rotate(rotation("y", _TURN), ends) + np.array(place(height))


def expected_gap(height, size, column):
    """How far below the box's lower front edge its shadow begins, in pixels, in a column of the picture."""
    view = camera(row_of_panels(1, size)[0])
    direction = np.array(_LIGHT) / _LIGHT[1]
    edge = front_edge(height)
    thrown = edge - edge[:, 1:2] * direction
    rows = []
    for ends in (edge, thrown):
        (x0, y0), (x1, y1) = (_window(view, p) for p in ends)
        rows.append(y0 + (column + 0.5 - x0) / (x1 - x0) * (y1 - y0))
    return rows[0] - rows[1]


def gap(mask, shown, column):
    """The same, counted: pixels of floor in shadow in the column, between lit floor and the box."""
    box = shown.object[:, column] == len(_TILES)
    below = np.arange(len(box)) < np.nonzero(box)[0][0]
    return int((below & ~mask[:, column]).sum())


def checks(figure, renderer):
    """Masks against rays; the box's picture is always the same; the gap is linear in the height."""
    heights, size = figure.values["heights"], figure.size // 2
    panels = [slice(k * size, (k + 1) * size) for k in range(len(heights) + 1)]
    view = camera(row_of_panels(1, size)[0])
    truths = [agreement.truth_of(box_at(height), view, lamp()) for height in heights]
    masks = {
        on: agreement.lit_mask(renderer.window(on, figure, size, shading=SceneShading.MASK)) for on in Answer
    }
    found = {
        on: [agreement.compare(mask[:, p], t) for p, t in zip(panels[1:], truths, strict=True)]
        for on, mask in masks.items()
    }
    picture = renderer.machine_window(figure, size)
    box = [(t.shown.object == len(_TILES)) & ~agreement.silhouettes(t) for t in truths]
    changed = [
        (picture[:, p] != picture[:, panels[0]]).any(axis=-1) & b
        for p, b in zip(panels[1:], box, strict=True)
    ]
    column = int(np.mean([_window(view, point)[0] for point in front_edge(0.0)]))
    gaps = [
        gap(masks[Answer.MACHINE][:, p], t.shown, column) for p, t in zip(panels[1:], truths, strict=True)
    ]
    expected = [expected_gap(height, size, column) for height in heights]
    fit = np.polyfit(heights, gaps, 1)
    towards = agreement.cosines(truths[0]) > 0.0
    return (
        *agreement.volume_checks(found),
        *(
            DATA.check(
                "without shadows: part of what faces the light that is lit",
                float(mask[:, panels[0]][towards & truths[0].shown.something].mean()),
                on,
            )
            for on, mask in masks.items()
        ),
        DATA.check("pixels of the box that differ between the panels", int(np.sum(changed)), Answer.MACHINE),
        DATA.check("gap below the box on the floor, pixels", gaps[0], Answer.MACHINE),
        DATA.check(
            "gap - expected, largest, pixels",
            max(abs(g - e) for g, e in zip(gaps, expected, strict=True)),
            Answer.MACHINE,
        ),
        DATA.check(
            "gap - line through the heights, largest, pixels",
            float(np.abs(np.polyval(fit, heights) - gaps).max()),
            Answer.MACHINE,
        ),
        DATA.check(
            "pixels of gap per edge of height",
            float(fit[0]),
            Answer.MACHINE,
            at_least=0.95 * expected[-1] / heights[-1],
        ),
    )


def reference(size, *, heights, shading, background):
    """The shadows by rays; the first panel without any."""
    view = camera(row_of_panels(1, size)[0])
    shots = [
        shadow_reference.Shot(box_at(height), view, (lamp(),), background, shading, shadows=number > 0)
        for number, height in enumerate((heights[0], *heights))
    ]
    return shadow_reference.row(size, shots)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "heights": word.of(
            word.Several((word.Number(0.0, 4.0),) * 3),
            (0.0, 0.4, 0.8),
            "How high above the floor the box is in the panels after the first.",
            "edges of the box",
        ),
        "shading": word.SHADING(SceneShading.LIT),
        "background": word.BACKDROP(_WALL),
    },
    methods=(Method("shadow volumes", scene, ("OPENGL_1_2", "GEFORCE_256")),),
    acceptance=checks,
    reference=reference,
)
