"""The places of a sheet's panels: pictures, each a row of equal panels, on a page of a given size.

All lengths are millimetres; x grows to the right, y downwards, from the top left corner of their area.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

# Assumed: a row of four panels or more that would be smaller than this is broken, where that is worth it.
SMALL = 40.0
# Of the largest panel that any arrangement allows: as small they may be, where a figure has one, to make the
# sheet flatter.
FLATTER = 2 / 3
# Rows are broken where that makes panels so many times as large.
WORTH = 1.1


@dataclass(frozen=True)
class Area:
    """The area for the panels, and the sizes around them.

    width, height  of all pictures with their labels
    gutter         between panels of a picture
    gap            between pictures
    label          height of the text above a panel; 0: there is none
    heading        height of a picture's name. It stands above pictures that stand side by side, and otherwise
                   left of the picture, upright
    notes          heights of the text below each picture; 0: there is none
    ratio          of a panel's width to its height
    """

    width: float
    height: float
    gutter: float
    gap: float
    label: float
    heading: float
    notes: Sequence[float]
    ratio: float = 1.0


@dataclass(frozen=True)
class Arrangement:
    """How many pictures stand in a line, how many panels in a row, and a panel's height in millimetres and
    the ratio of its width to that.
    """

    pictures: int
    panels: int
    height: float
    ratio: float = 1.0

    @property
    def width(self) -> float:
        """Of a panel, in millimetres."""
        return self.height * self.ratio


@dataclass(frozen=True)
class Place:
    """Where a picture stands: ``left``, ``top`` and ``width`` of its panels with their labels, ``bottom``;
    ``panels``: the left top corner of each.
    """

    left: float
    top: float
    width: float
    bottom: float
    panels: tuple[tuple[float, float], ...]


def _lines(area, arrangement):
    """The notes' heights of the pictures of each line."""
    step = arrangement.pictures
    return [area.notes[i : i + step] for i in range(0, len(area.notes), step)]


def _labels(area, arrangement, rows, line):
    """Heights of the labels above each row of panels: where a picture stands alone in each line and its
    panels in one row, the first line's labels serve all.
    """
    if arrangement.pictures == 1 and rows == 1 and line:
        return [0.0]
    return [area.label] * rows


def _side(area, arrangement):
    """(left of the panels, above them) for a picture's name."""
    return (area.heading, 0.0) if arrangement.pictures == 1 else (0.0, area.heading)


def _fixed(area, columns, arrangement):
    """Width and height of all that is no panel."""
    p, c = arrangement.pictures, arrangement.panels
    rows = math.ceil(columns / c)
    left, above = _side(area, arrangement)
    width = left + p * (c - 1) * area.gutter + (p - 1) * area.gap
    lines = _lines(area, arrangement)
    height = (len(lines) - 1) * area.gap
    for number, notes in enumerate(lines):
        height += (
            above + sum(_labels(area, arrangement, rows, number)) + (rows - 1) * area.gutter + max(notes)
        )
    return width, height


def _largest(area, columns, pictures, panels):
    """An arrangement with the largest panels that fit."""
    trial = Arrangement(pictures, panels, 0.0, area.ratio)
    width, height = _fixed(area, columns, trial)
    rows = math.ceil(columns / panels) * math.ceil(len(area.notes) / pictures)
    wide = (area.width - width) / (pictures * panels * area.ratio)
    return replace(trial, height=min(wide, (area.height - height) / rows))


def height_of(area, columns, arrangement):
    """The height of all pictures with their labels."""
    rows = math.ceil(columns / arrangement.panels) * math.ceil(len(area.notes) / arrangement.pictures)
    return _fixed(area, columns, arrangement)[1] + rows * arrangement.height


def arrange(area, columns, small=SMALL):
    """The Arrangement of pictures of ``columns`` panels.

    The rows of panels stay whole unless a panel is lower than ``small`` mm. Among arrangements with lines of
    equal length, the one with the largest panels is taken. Pictures of one panel may stand side by side; then
    it is the flattest whose panels are nearly as large. If no arrangement fits, its height is zero or less.
    """
    count = len(area.notes)
    shares = [n for n in range(1, count + 1) if count % n == 0]
    found = [_largest(area, columns, pictures, columns) for pictures in shares]
    largest = max(a.height for a in found)
    if columns >= 4 and largest < small:
        broken = [_largest(area, columns, pictures, math.ceil(columns / 2)) for pictures in shares]
        if max(a.height for a in broken) > WORTH * largest:
            found = broken
            largest = max(a.height for a in found)
    enough = min(largest, FLATTER * largest) if columns == 1 else largest
    return min((a for a in found if a.height >= enough), key=lambda a: height_of(area, columns, a))


def place(area, columns, arrangement):
    """Where each picture stands: a Place each. An arrangement narrower than the area is centred."""
    c, across = arrangement.panels, arrangement.width
    rows = math.ceil(columns / c)
    left, above = _side(area, arrangement)
    width = c * across + (c - 1) * area.gutter
    total = left + arrangement.pictures * width + (arrangement.pictures - 1) * area.gap
    start = max(0.0, (area.width - total) / 2) + left
    places, y = [], 0.0
    for number, notes in enumerate(_lines(area, arrangement)):
        labels = _labels(area, arrangement, rows, number)
        tops, top = [], y + above
        for row, label in enumerate(labels):
            tops.append(top + label)
            top += label + arrangement.height + area.gutter * (row < rows - 1)
        for i in range(len(notes)):
            x = start + i * (width + area.gap)
            panels = tuple((x + (n % c) * (across + area.gutter), tops[n // c]) for n in range(columns))
            places.append(Place(x, y, width, top, panels))
        y = top + max(notes) + area.gap
    return tuple(places)
