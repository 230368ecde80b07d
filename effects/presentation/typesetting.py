"""The width of a line of text, and line breaks, by matplotlib's own fonts: the same on every computer."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from fixedpipe.effects.presentation.styles import MILLIMETRES, POINTS, Face
from fixedpipe.effects.refusal import Refusal


def drawing_library():
    """matplotlib, imported when a sheet is made. Raises Refusal if it is not installed."""
    try:
        import matplotlib
    except ImportError as error:
        raise Refusal(
            "Sheets are composed by matplotlib, which is not installed: pip install 'fixedpipe[plots]'."
        ) from error
    return matplotlib


@dataclass(frozen=True)
class Font:
    """A typeface in a size of points."""

    face: Face
    points: float
    bold: bool = False

    def properties(self):
        """As matplotlib takes it."""
        return _properties(self)

    def width(self, text):
        """Of a line of text, mm."""
        return _width(self, text)


@cache
def _properties(font):
    matplotlib = drawing_library()
    from matplotlib.font_manager import FontProperties

    name = font.face.bold if font.bold else font.face.regular
    return FontProperties(
        family=list(font.face.families),
        weight="bold" if font.bold else "normal",
        size=font.points,
        fname=Path(matplotlib.get_data_path(), "fonts", "ttf", name),
    )


@cache
def _width(font, text):
    drawing_library()
    from matplotlib.textpath import text_to_path

    width, _, _ = text_to_path.get_text_width_height_descent(text, font.properties(), ismath=False)
    return width * MILLIMETRES / POINTS


def broken(text, font, width):
    """A text as lines no wider than ``width`` mm, where its words allow it; an empty text has none."""
    lines: list[str] = []
    for word in text.split(" ") if text else ():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and font.width(longer) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines
