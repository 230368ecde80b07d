"""F003-13: umbra and penumbra of an area light, drawn."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import INK, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.area_light import (
    BAR,
    FLOOR,
    LIGHT,
    OCCLUDER,
    Light,
    dimension,
    drawn_edges,
    floor_bar,
    guide,
    rays,
    regions,
    things,
)
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F003-13")


def scene(profile, size, *, extent, half_width, background):
    """A light ``extent`` wide over an occluder, and the umbra and penumbra on the floor."""
    (panel,) = row_of_panels(1, size)
    view, light = drawing.sheet(panel), Light("area light", extent=extent)
    _, _, inner_right, outer_right = light.edges(half_width)
    below, side = FLOOR - BAR - 0.04, -0.86
    return (
        panel.clear(background),
        drawing.load_font(),
        *regions(view, light, half_width),
        rays(view, light, half_width),
        *floor_bar(view, light, half_width),
        *things(view, light, half_width),
        guide(view, [(side, LIGHT), (-0.5 * extent, LIGHT)]),
        guide(view, [(side, OCCLUDER), (-half_width, OCCLUDER)]),
        *dimension("d1", view, [(side, LIGHT), (side, OCCLUDER)], (-1, 0), (4.0, 0.0)),
        *dimension("d2", view, [(side, OCCLUDER), (side, FLOOR)], (1, 0), (-3.0, 0.0)),
        *dimension(
            "s", view, [(-0.5 * extent, LIGHT + 0.09), (0.5 * extent, LIGHT + 0.09)], (0, -1), (0.0, 2.0)
        ),
        *dimension(
            "penumbra:\ns d2/d1", view, [(inner_right, below), (outer_right, below)], (0, 1), (0.0, -2.0)
        ),
        drawing.text("area light", view, (0.5 * extent, LIGHT), YELLOW, align=(-1, -1), offset=(6.0, -2.0)),
        drawing.text("occluder", view, (half_width, OCCLUDER), INK, align=(-1, -1), offset=(4.0, 1.0)),
        drawing.text("umbra", view, (0.0, 0.5 * (OCCLUDER + FLOOR)), INK),
    )


def checks(figure, renderer):
    """The penumbra's width by similar triangles, by the visible part of the light, and in the picture."""
    half_width, extent = figure.values["half_width"], figure.values["extent"]
    light = Light("area light", extent=extent)
    outer_left, inner_left, inner_right, outer_right = light.edges(half_width)
    expected = extent * (OCCLUDER - FLOOR) / (LIGHT - OCCLUDER)
    beside = 1e-3
    whole = light.visible(np.array([outer_left - beside, outer_right + beside]), half_width)
    none = light.visible(np.array([inner_left + beside, inner_right - beside]), half_width)
    half = light.visible(0.5 * (inner_right + outer_right), half_width)
    yield DATA.check(
        "penumbra's width - s d2/d1, in either penumbra",
        max(abs(inner_left - outer_left - expected), abs(outer_right - inner_right - expected)),
        Answer.IDEAL,
    )
    yield DATA.check("least part of the light seen outside", float(whole.min()), Answer.IDEAL)
    yield DATA.check("largest part of it seen in the umbra", float(none.max()), Answer.IDEAL)
    yield DATA.check("part of it seen in the penumbra's middle - 1/2", abs(float(half) - 0.5), Answer.IDEAL)
    size = figure.size // 2
    for on in Answer:
        drawn = drawn_edges(renderer.window(on, figure, size))
        yield DATA.check(
            "drawn ends of the penumbras - computed ones, in pixels",
            float(np.abs(drawn - light.edges(half_width)).max()) * 0.5 * size,
            on,
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "extent": word.NUMBER(0.34, "The width of the light.", "half edges of a panel", low=0.01, high=1.0),
        "half_width": word.NUMBER(
            0.30, "Half the width of the occluder.", "half edges of a panel", low=0.01, high=0.5
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
