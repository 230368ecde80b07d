"""Every figure, a module each: its scene, its checks, and the figure as data."""

from types import MappingProxyType

from effects.figures import f004_2, f004_3, f004_4, f004_5, f004_6, f004_7, k02, k11, k12, k14
from effects.figures.figure import DIFFERENCE_GAIN, VIEWS, Check, Figure, Method, Renderer, difference

__all__ = ["DIFFERENCE_GAIN", "FIGURES", "VIEWS", "Check", "Figure", "Method", "Renderer", "difference"]

_MODULES = (f004_2, f004_3, f004_4, f004_5, f004_6, f004_7, k02, k11, k12, k14)

# By id, in the catalogue's order.
FIGURES = MappingProxyType({module.FIGURE.id: module.FIGURE for module in _MODULES})
