"""F004-1: the paper's method as it works conceptually, run as an effect."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, Panel, orthographic_view, row_of_panels
from fixedpipe.effects.passes import pixel_texture_copies
from fixedpipe.effects.passes.draws import EDGE
from fixedpipe.effects.reflectance import dependent_lookups, lookup_framework

DATA = figure_data(__file__, "F004-1")

EYE = np.array([0.0, 0.0, 1.0])
# The panels: textures, parameters, and these stages.
STAGES = ("F(s, t)", "G(u, v)", lookup_framework.RESULT)
# What the tiles are lettered with: textures, parameters, stages.
LETTERS = ("a", "n, v/8", "F(s, t)", "G(u, v)", "-s", "t", "u", "v/8", "F", "G", "F G")


@lru_cache(maxsize=2)
def _textures(map_size, bumps, height, cells):
    return lookup_framework.woven_domes(map_size, bumps=bumps, height=height, cells=cells)


def _quarters(panel):
    """Four panels: upper left and right, lower left and right."""
    w, h = panel.width // 2, panel.height // 2
    if not (w and h):
        raise ValueError("Four textures share a panel of F004-1; give it 2 pixels an edge or more.")
    return tuple(Panel(panel.x + i * w, panel.y + j * h, w, h) for j in (1, 0) for i in (0, 1))


def _letters(panels, inset, extent):
    """The tiles' names in their upper left corners."""
    out = [drawing.load_font()]
    tiles = [(panel, k, inset) for panel in panels[:2] for k in range(4)]
    tiles += [(panel, None, extent) for panel in panels[2:]]
    for name, (panel, quarter, half) in zip(LETTERS, tiles, strict=True):
        x, y, scale = (0.0, 0.0, 1.0) if quarter is None else (quarter % 2 - 0.5, 0.5 - quarter // 2, 0.5)
        corner = (x - scale * half, y + scale * half)
        out.append(
            drawing.text(
                name, drawing.sheet(panel), corner, (1.0, 1.0, 1.0),
                align=(-1, 1), offset=(3.0, -2.0), outline=(0.0, 0.0, 0.0),
            )
        )  # fmt: skip
    return out


def _scene(
    profile, size, passes, *, map_size, bumps, height, cells, light, extent, inset, letters, background
):
    """``passes``: (surface, textures, view, light, profile, stage) -> commands that show a stage in grey."""
    panels = row_of_panels(2 + len(STAGES), size)
    textures = _textures(map_size, bumps, height, cells)
    toward, square, small = (
        Light(light),
        surfaces.plane(1, 1, extent, extent),
        surfaces.plane(1, 1, inset, inset),
    )
    out = [panel.clear(background) for panel in panels]
    out += [*lookup_framework.load_textures(textures, profile), *lookup_framework.load_tables(profile)]
    for quarter, name in zip(_quarters(panels[0]), ("a", "n", "F", "G"), strict=True):
        view = orthographic_view(quarter)
        label = f"show the texture {name}"
        out.append(
            pixel_texture_copies.polygon(
                label, small, view, name, first=True, mask=pixel_texture_copies.RGB, sampler=EDGE
            )
        )
    for quarter, stage in zip(_quarters(panels[1]), lookup_framework.STAGES[:4], strict=True):
        out += passes(small, textures, orthographic_view(quarter), toward, profile, stage)
    for panel, stage in zip(panels[2:], STAGES, strict=True):
        out += passes(square, textures, orthographic_view(panel), toward, profile, stage)
    return (*out, *(_letters(panels, inset, extent) if letters else ()))


def pixel_textures_scene(profile, size, **parameters):
    """F004-1 by the color matrix and pixel textures."""

    def passes(surface, textures, view, light, profile, stage):
        return lookup_framework.by_pixel_textures(
            surface, textures, view, light, profile, stage=stage, sampler=EDGE
        )

    return _scene(profile, size, passes, **parameters)


def host_scene(profile, size, **parameters):
    """F004-1 by register combiners, and the host in the place of dependent lookups."""

    def passes(surface, _, view, light, profile, stage):
        return lookup_framework.by_host(surface, view, light, profile, stage=stage, sampler=EDGE)

    return _scene(profile, size, passes, **parameters)


def texture_shaders_scene(profile, size, **parameters):
    """F004-1 by register combiners, and texture shaders that look up what these left on the screen."""

    def passes(surface, _, view, light, profile, stage):
        return (
            dependent_lookups.load_screen(view.panel),
            *dependent_lookups.figure_1_passes(surface, view, light, profile, stage=stage, sampler=EDGE),
        )

    return _scene(profile, size, passes, **parameters)


# Rows of pixels under a tile's upper edge that its name takes.
_NAME = 20


def _tile_in_float(number, textures, toward_light, seen):
    """What tile ``number`` of LETTERS must show at the pixels: float64 [n] or [n, 3]."""
    s, t = seen.s, seen.t
    if number < 2:
        vectors = (textures.directions, textures.normals)[number]
        return 0.5 + 0.5 * seen_places.looked_up(vectors, seen)
    if number < 4:
        return np.exp(-s / np.maximum(t, 1e-30)) if number == 2 else s ** (4.0 * t)
    along, normals = (
        seen_places.looked_up(vectors, seen) for vectors in (textures.directions, textures.normals)
    )
    minus_s, u = (np.maximum(vectors @ toward_light, 0.0) for vectors in (along, normals))
    t, eighth = normals @ EYE, seen_places.looked_up(textures.eighths, seen)
    f, g = np.exp(-minus_s / t), u ** (4.0 * eighth)
    return (minus_s, t, u, eighth, f, g, f * g)[number - 4]


def _tiles_check(figure, renderer, on, textures, toward_light):
    """Each tile of the displayed picture, below its name, against what it must show."""
    size, inset, extent = figure.size, figure.values["inset"], figure.values["extent"]
    window, half, worst = renderer.window(on, figure, size), size // 2, 0.0
    corners = [(x + i * half, j * half, half) for x in (0, size) for j in (1, 0) for i in (0, 1)]
    corners += [(k * size, 0, size) for k in (2, 3, 4)]
    for number, (x, y, edge) in enumerate(corners):
        seen = seen_places.square(edge, inset if edge == half else extent)
        rows = np.nonzero(seen.where)[0]
        # F's own table falls from one to zero within its lowest texels: the catalogue has it from 1/16 on.
        kept = (rows <= rows.max() - _NAME) & ((number != 2) | (seen.t >= 1.0 / 16.0))
        shown = window[y : y + edge, x : x + edge][seen.where]
        true = _tile_in_float(number, textures, toward_light, seen)
        error = shown - (true if true.ndim == 2 else true[:, None])
        worst = max(worst, root_mean_square(error[kept]))
    return DATA.check(
        "largest RMS of a tile, below its name, from what it must show", worst, on, at_most=1.0 / 64.0
    )


def checks(figure, renderer):
    """The tiles and their names; the result against float evaluation at the texels, its factors against it,
    and the tables alone.
    """
    p = figure.values
    size = p["map_size"]
    textures = _textures(size, p["bumps"], p["height"], p["cells"])
    toward_light = unit_vector(p["light"], "The light")
    expected = textures.evaluated(toward_light, EYE)
    for on in Answer:
        yield _tiles_check(figure, renderer, on, textures, toward_light)
        # The square fills the panel: a texel for each pixel, so that no filter of materials takes part.
        colors = renderer.window(on, figure, size, extent=1.0, letters=False)
        picture, half = colors[..., 0], size // 2
        shown = [colors[j : j + half, i : i + half] for j in (0, half) for i in range(0, 2 * size, half)]
        f, g, result = (picture[:, k * size : (k + 1) * size] for k in range(2, 5))
        yield DATA.check(
            "RMS of the dependent tables' result - direct evaluation in float",
            root_mean_square(result - expected),
            on,
            at_most=1.0 / 128.0,
        )
        yield DATA.check(
            "largest difference of the result from F(s, t) G(u, v), as drawn",
            float(np.abs(result - f * g).max()),
            on,
            at_most=1.01 / 255.0,
        )
        yield DATA.check(
            "smallest standard deviation of a texture's or parameter's small square",
            min(float(q.std(axis=(0, 1)).max()) for q in shown),
            on,
        )
    for name, function, table, edge in (
        ("F, t >= 1/16", lookup_framework.exponential, lookup_framework.exponential_table, 1.0 / 16.0),
        ("G", lookup_framework.root_of_power, lookup_framework.power_table, 0.0),
    ):
        error = _table_error(function, table(renderer.profile), edge)
        yield DATA.check(
            "RMS over the domain of the table of {name}, 256 x 256 and LINEAR",
            root_mean_square(error),
            Answer.MACHINE,
            at_most=1.0 / 128.0,
            name=name,
        )


def _table_error(function, table, edge):
    """A table's filtered texels minus its function, over [0, 1] x [edge, 1]."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, 1021), np.linspace(edge, 1.0, 1021))
    texels = table.levels[0][0, ..., 0] / (2.0**table.bits - 1.0)
    x, y = (np.clip(c * 256 - 0.5, 0.0, 255.0) for c in (s, t))
    i, j = (np.minimum(np.floor(c).astype(np.int64), 254) for c in (x, y))
    a, b = x - i, y - j
    low = texels[j, i] * (1.0 - a) + texels[j, i + 1] * a
    high = texels[j + 1, i] * (1.0 - a) + texels[j + 1, i + 1] * a
    return low * (1.0 - b) + high * b - function(s, t)


FIGURE = Figure(
    **DATA.words,
    size=384,
    parameters={
        "map_size": word.TEXELS(256),
        "bumps": word.COUNT(4, "Domes along an edge of the square."),
        "height": word.NUMBER(1.5, "The domes' slopes over those of domes of 45 degrees.", low=0.0, high=2.0),
        "cells": word.COUNT(16, "Cells of the weave along an edge of the square."),
        "light": word.LIGHT((0.55, 0.35, 0.75)),
        "extent": word.EXTENT(0.94),
        "inset": word.EXTENT(0.88, "The half edge of the small squares, of which four share a panel."),
        "letters": word.FLAG(True, "Whether the tiles' names stand on them."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("pixel textures", pixel_textures_scene, ("OCTANE",)),
        Method("register combiners, lookups by the host", host_scene, ("GEFORCE_256",)),
        Method("texture shaders", texture_shaders_scene, ("GEFORCE_3", "NV2A", "FUTURE")),
    ),
    acceptance=checks,
)
