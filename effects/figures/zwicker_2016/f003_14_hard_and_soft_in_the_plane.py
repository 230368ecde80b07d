"""F003-14: hard shadows of point and directional lights, the soft one of an area light, drawn."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import INK
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.area_light import (
    BAR,
    FLOOR,
    LIGHT,
    OCCLUDER,
    Light,
    drawn_edges,
    floor_bar,
    rays,
    regions,
    things,
)
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "F003-14")


def lights(extent, slope):
    """The three lights, from left to right."""
    return (
        Light("point light"),
        Light("directional light", x=slope, infinite=True),
        Light("area light", extent=extent),
    )


def scene(profile, size, *, extent, slope, half_width, background):
    """One occluder under a point light, a directional one and one ``extent`` wide."""
    out = [drawing.load_font()]
    for panel, light in zip(row_of_panels(3, size), lights(extent, slope), strict=True):
        view, edges = drawing.sheet(panel), light.edges(half_width)
        soft = edges[0] < edges[1]
        out += [
            panel.clear(background),
            *regions(view, light, half_width),
            rays(view, light, half_width),
            *floor_bar(view, light, half_width),
            *things(view, light, half_width),
            drawing.text(
                f"{light.name}:\n{'soft' if soft else 'hard'} shadow",
                view,
                (0.0, FLOOR - BAR),
                INK,
                align=(0, 1),
                offset=(0.0, -4.0),
            ),
        ]
    return tuple(out)


def checks(figure, renderer):
    """How far each light's shadow takes from dark to light, by geometry and in the picture."""
    p = figure.values
    half_width, expected = p["half_width"], p["extent"] * (OCCLUDER - FLOOR) / (LIGHT - OCCLUDER)
    size = figure.size // 2
    for k, light in enumerate(lights(p["extent"], p["slope"])):
        edges = np.array(light.edges(half_width))
        wanted = expected if light.extent else 0.0
        yield DATA.check(
            "{name}: penumbra's width - expected",
            float(np.abs([edges[1] - edges[0] - wanted, edges[3] - edges[2] - wanted]).max()),
            Answer.IDEAL,
            name=light.name,
        )
        beside = 1e-3 * np.array([-1.0, -1.0, 1.0, 1.0])
        outside = light.visible((edges + beside)[[0, 3]], half_width)
        inside = light.visible((edges - beside)[[1, 2]], half_width)
        yield DATA.check(
            "{name}: least part seen outside - largest in the umbra",
            float(outside.min() - inside.max()),
            Answer.IDEAL,
            name=light.name,
        )
        for on in Answer:
            panel = renderer.window(on, figure, size)[:, k * size : (k + 1) * size]
            drawn = drawn_edges(panel, 0.5 * float(edges[1] + edges[2]))
            yield DATA.check(
                "{name}: drawn ends of the penumbras - computed ones, in pixels",
                float(np.abs(drawn - edges).max()) * 0.5 * size,
                on,
                name=light.name,
            )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "extent": word.NUMBER(
            0.34, "The width of the area light.", "half edges of a panel", low=0.0, high=1.0
        ),
        "slope": word.NUMBER(
            0.35,
            "How far the directional light's rays run aside for each unit that they fall.",
            low=-1.0,
            high=1.0,
        ),
        "half_width": word.NUMBER(
            0.30, "Half the width of the occluder.", "half edges of a panel", low=0.01, high=0.5
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
