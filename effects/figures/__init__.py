"""Every figure, a module each, in its paper's folder: its scene, its checks, and the figure as data."""

import re
import sys

from fixedpipe.effects.collection import Collection
from fixedpipe.effects.figures.figure import Figure, Method, Renderer
from fixedpipe.effects.figures.rendering import Difference, Rendering, difference

__all__ = ["FIGURES", "Difference", "Figure", "Method", "Renderer", "Rendering", "difference"]


def identify(name):
    """F004-2 of f004_02_rings, T002-1 of t002_01_times, K12 of k12_normalization_cube_map."""
    if of_paper := re.fullmatch(r"([ft]\d{3})_(\d\d)_\w+", name):
        return f"{of_paper[1].upper()}-{int(of_paper[2])}"
    technique = re.fullmatch(r"([a-z]\d\d)_\w+", name)
    return technique and technique[1].upper()


# How a figure's module is named.
FORM = "f004_02_rings for F004-2, or k14_dot_product_bumps for K14: two digits, then words"
# Modules of this folder that are no figures.
BESIDE = ("costs", "displayed_checks", "figure", "own_maps", "parameters", "rendering", "scattering_ways")
# By id, in the catalogue's order.
FIGURES: Collection[Figure] = Collection(sys.modules[__name__], "FIGURE", identify, FORM, beside=BESIDE)
