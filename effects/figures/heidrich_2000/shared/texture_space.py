"""What figures of machines' passes share: a small field, its panels, and pictures of its textures."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scattering import (
    dependent_tests,
    height_field,
)
from fixedpipe.effects.scattering.visibility import precompute

TEXELS = word.of(word.Whole(4, 64, power=True), 64, "The height field's edge, at most.", "texels")
DOMES = word.of(word.Whole(1, 8), 3, "Domes along an edge.")
HEIGHT = word.NUMBER(0.8, "The domes' height, over half balls'.", low=0.0, high=2.0)


def smooth_domes(texels, count, height, albedo):
    """Domes whose rims are smoothed: an upright rim has no texels of its own."""
    heights = height_field.domes(texels, texels, count, height=height).heights
    return height_field.height_field(height_fields.smooth(heights, texels // 32), albedo)


@lru_cache(maxsize=16)
def domes_and_visibility(texels, count, height, albedo, directions):
    """Smooth domes and what they see along directions, a tuple of vectors."""
    field = smooth_domes(texels, count, height, albedo)
    return field, precompute(field, np.array(directions))


def letters(panel, names, places):
    """Labels over pictures, each with its place on a sheet of the panel, at its left upper corner."""
    view = drawing.sheet(panel)
    white, black = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
    return tuple(
        drawing.text(name, view, place, white, align=(-1, 1), offset=(3.0, -2.0), outline=black)
        for name, place in zip(names, places, strict=True)
    )


def squares(panel, places, textures):
    """Textures on squares (x, y, edge) of a panel in shares of its height, from its lower left corner."""
    out = []
    for (x, y, edge), name in zip(places, textures, strict=True):
        pixels = max(1, round(edge * panel.height))
        part = Panel(panel.x + round(x * panel.height), panel.y + round(y * panel.height), pixels, pixels)
        out.append(dependent_tests.textured(f"show {name}", part, name))
    return tuple(out)
