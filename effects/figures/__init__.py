"""Every figure, a module each: its scene, its checks, and the figure as data."""

import importlib
import pkgutil
import re
from types import MappingProxyType

from fixedpipe.effects.figures.figure import (
    DIFFERENCE_GAIN,
    VIEWS,
    Check,
    Figure,
    Method,
    Renderer,
    difference,
)

__all__ = ["DIFFERENCE_GAIN", "FIGURES", "VIEWS", "Check", "Figure", "Method", "Renderer", "difference"]


def _figures():
    """The FIGURE of each module that is named by an id, f004_2 or k12, in the ids' order."""
    names = [m.name for m in pkgutil.iter_modules(__path__) if re.fullmatch(r"[a-z]\d+(_\d+)?", m.name)]
    names.sort(key=lambda name: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", name)])
    for name in names:
        yield importlib.import_module(f"{__name__}.{name}").FIGURE


# By id, in the catalogue's order.
FIGURES = MappingProxyType({figure.id: figure for figure in _figures()})
