"""F000-13: a bump map without and with the light that its cells throw at each other: a comb of wax."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.scattering_ways import MACHINES, WAYS, largest_power, setup_of
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, NEAREST, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.scattering import dependent_tests, height_field, light_transport
from fixedpipe.effects.scattering.dependent_tests import DIRECT, RESULT, Accumulation
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.made_fields import honeycomb
from fixedpipe.effects.scattering.visibility import free_view, precompute
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F000-13")

# Offsets are signed bytes, and textures' edges powers of two.
VALUES = {"offset textures, bumps lit at vertices": {"texels": 64}}
WITHOUT = "direct light"
_BLACK = (0.0, 0.0, 0.0)
# Directions of the reference: four times the figure's, whose noise is half.
_REFERENCE_DIRECTIONS = 400


@lru_cache(maxsize=8)
def _comb(texels, cells, depth, directions):
    field = honeycomb(texels, texels, cells, cells, depth)
    return field, precompute(field, spiral(directions))


def _field(size, p, directions=None):
    """The field, half a panel's edge at most so that small pictures are cheap, and its visibility."""
    edge = largest_power(size // 2, p["texels"])
    return _comb(edge, p["cells"], p["depth"], p["directions"] if directions is None else directions)


def _square(label, panel, texture, sampler=REPEATED):
    """The bump map: a flat square whose light is a texture."""
    units = (unit(texture, sampler, environment=REPLACE),)
    view = orthographic_view(panel)
    return draw(label, surfaces.plane().mesh(), view, None, units, depth_test=FIRST_PASS)


def scene_by(way):
    """The scene by a machine's PathPasses."""

    def scene(profile, size, **p):
        field, visibility = _field(size, p)
        setup, panels = setup_of(profile, field, visibility), row_of_panels(2, size)
        numbers = light_transport.sequences(p["directions"], 1, p["directions"])
        share = dependent_tests.share_of(setup)
        return (
            *dependent_tests.paths_drawn(
                way, setup, numbers, p["light"], accumulation=p["accumulation"], exposure=p["exposure"]
            ),
            dependent_tests.textured("direct light alone", setup.work, DIRECT, share, weight=p["exposure"]),
            dependent_tests.copy_of(setup, setup.work, WITHOUT),
            *(panel.clear(_BLACK) for panel in panels),
            _square("the comb without indirect light", panels[0], WITHOUT, p["sampler"]),
            _square("the comb with it", panels[1], RESULT, p["sampler"]),
        )

    return scene


def _lights(size, p, directions):
    """Direct light, and that with one scattering along so many directions, in float64."""
    field, visibility = _field(size, p, directions)
    towards, up = height_field.check_light(p["light"]), (0.0, 0.0, 1.0)
    numbers = light_transport.sequences(directions, 1, directions)
    direct = light_transport.chain(field, visibility, [], towards, up, lit=free_view(field, towards))
    return direct, light_transport.scattered(field, visibility, numbers, towards)


def reference(size, **p):
    """The light of many more directions in float64: RGBA, top row first."""
    drawn = []
    for panel, name, values in zip(
        row_of_panels(2, size), ("direct", "scattered"), _lights(size, p, _REFERENCE_DIRECTIONS), strict=True
    ):
        image = texture_2d(p["exposure"] * values)
        drawn += (
            TexImage(label=f"load the {name} light", texture=name, image=image),
            _square(name, panel, name),
        )
    out = np.ones((size, 2 * size, 4))
    out[..., :3] = execute_ideal(tuple(drawn), 2 * size, size).color[..., :3]
    return out


# ---------------------------------------------------------------------------------------------- checks


def checks(figure, renderer):
    """The sum against the same paths in float64, and where it makes the comb brighter and warmer."""
    p = figure.values_of(renderer.method)
    edge = p["texels"]
    field, _ = _field(2 * edge, p)
    expected = [p["exposure"] * light for light in _lights(2 * edge, p, p["directions"])]
    more = _lights(2 * edge, p, _REFERENCE_DIRECTIONS)[1] * p["exposure"]
    yield DATA.check(
        "RMS of the light of a hundred directions from that of four hundred",
        root_mean_square(expected[1] - more),
        Answer.IDEAL,
    )
    high = (field.heights - field.heights.min()) / np.ptp(field.heights)
    for on in Answer:
        # A texel for each pixel.
        window = renderer.window(on, figure, 2 * edge, sampler=NEAREST)[::2, ::2]
        plain, scattered = (panel_of(window, k) for k in range(2))
        for name, found, light in zip(("direct", "scattered"), (plain, scattered), expected, strict=True):
            light = np.clip(light, 0.0, 1.0)
            yield DATA.check(
                "RMS of the {name} light - the same in float64",
                root_mean_square(np.clip(found, 0.0, 1.0) - light),
                on,
                name=name,
            )
        dark = (high < 0.25) & (plain.max(axis=-1) < 0.02)
        tops = high > 0.9
        gain = scattered - plain
        yield DATA.check(
            "what the shadowed floors of the cells gain, mean of red", float(gain[dark][:, 0].mean()), on
        )
        yield DATA.check(
            "what the walls' tops gain, over that",
            float(gain[tops][:, 0].mean() / gain[dark][:, 0].mean()),
            on,
        )
        floors = high < 0.25
        warmth = [
            float(light[floors][:, 0].sum() / light[floors][:, 2].sum()) for light in (plain, scattered)
        ]
        yield DATA.check(
            "red over blue in the cells with indirect light, over that without", warmth[1] / warmth[0], on
        )


FIGURE = Figure(
    **DATA.words,
    size=512,
    parameters={
        "texels": word.of(word.Whole(4, 128, power=True), 128, "The bump map's edge, at most.", "texels"),
        "cells": word.of(word.Whole(2, 8, even=True), 4, "Cells along an edge."),
        "depth": word.NUMBER(0.5, "How deep the cells are, of a cell's width.", low=0.0, high=1.5),
        "directions": word.of(word.Whole(4, 400), 100, "Directions over the sphere, a path for each."),
        "light": word.LIGHT((-0.62, 0.4, 1.0)),
        "accumulation": word.of(
            word.of_enum(*Accumulation), Accumulation.ACCUMULATION_BUFFER, "Where the paths are summed."
        ),
        "exposure": word.NUMBER(0.85, "What all light is multiplied by.", low=0.1, high=1.0),
        "sampler": word.internal(REPEATED, "Checks compare texels, which filters mix."),
    },
    methods=tuple(
        Method(name, scene_by(way), MACHINES[name], VALUES.get(name, {})) for name, way in WAYS.items()
    ),
    acceptance=checks,
    reference=reference,
)
