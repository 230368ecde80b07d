"""Pictures under readable names, as ``figures --png`` writes them: as drawn, or finished for print.

A picture is finished in three steps. Squares of pixels become one (supersampling); an inset enlarges a
rectangle; white gutters part the panels.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports.files import write_whole
from fixedpipe.pipeline.framebuffers.pictures import png

# Times that a figure can be drawn larger, and a rectangle be enlarged.
MOST_TIMES, MOST_ZOOM = 8, 32
# Widest gutter, pixels.
MOST_GUTTER = 200
_FRAME = 2  # pixels of an inset's frame, and of its place's


@dataclass(frozen=True)
class Inset:
    """A rectangle that is shown enlarged in a corner of its panel: ``x``, ``y`` of its left top corner,
    ``width``, ``height``, pixels of the picture, and by how much it is enlarged: ``zoom``.
    """

    x: int
    y: int
    width: int
    height: int
    zoom: int

    @classmethod
    def parse(cls, text):
        """An Inset from "x,y,w,h,zoom". Raises Refusal for other words."""
        parts = [part.strip() for part in text.split(",")]
        if len(parts) != 5 or not all(part.isdigit() and len(part) < 7 for part in parts):
            raise Refusal(f"--inset is {text!r}; give x,y,w,h,zoom in whole pixels, as 300,200,40,30,4.")
        found = cls(*map(int, parts))
        if not (found.width and found.height and 2 <= found.zoom <= MOST_ZOOM):
            raise Refusal(f"--inset is {text!r}; give a width and a height, and a zoom of 2 to {MOST_ZOOM}.")
        return found

    def check(self, what, width, height, columns):
        """Raise Refusal if a picture of ``width`` x ``height`` pixels in ``columns`` panels lacks room."""
        across = width // columns
        is_inside = self.y + self.height <= height and self.x + self.width <= width
        if not is_inside or self.x // across != (self.x + self.width - 1) // across:
            raise Refusal(
                f"The inset {self.x},{self.y},{self.width},{self.height} is not in one panel of {what}, "
                f"whose {columns} panels have {across}x{height} pixels each."
            )
        if self.width * self.zoom > 0.7 * across or self.height * self.zoom > 0.7 * height:
            raise Refusal(
                f"The inset of {what} would be {self.width * self.zoom}x{self.height * self.zoom} pixels; "
                f"its panel has {across}x{height}. Give a smaller rectangle or zoom."
            )


@dataclass(frozen=True)
class Plates:
    """A folder for pictures under readable names, and how they are finished.

    folder       a Path
    supersample  the picture was drawn so many times as large; each square of pixels becomes their mean
    gutter       pixels of white between panels
    inset        an Inset, or None
    """

    folder: Path
    supersample: int = 1
    gutter: int = 0
    inset: Inset | None = None

    def write(self, name, image, columns):
        """Write a picture, uint8 or uint16 [h, w, 3 or 4] in ``columns`` panels, as PNG. Raises Refusal when
        it cannot be written.
        """
        write_whole(self.folder / name, png(self.finished(image, columns)))

    def finished(self, image, columns):
        """The picture to be written: of the image's type, [h, w, 3], or the image itself."""
        if self == Plates(self.folder):
            return image
        picture = _filtered(image[..., :3], self.supersample)
        if self.inset:
            picture = _with_inset(picture, self.inset, picture.shape[1] // columns)
        return _parted(picture, columns, self.gutter)


def _filtered(image, times):
    """The mean of each square of ``times`` x ``times`` pixels, rounded to nearest, halves up."""
    if times == 1:
        return image.copy()
    height, width = (length // times for length in image.shape[:2])
    squares = image[: height * times, : width * times].reshape(height, times, width, times, 3)
    sums = squares.sum(axis=(1, 3), dtype=np.int64)
    return ((2 * sums + times * times) // (2 * times * times)).astype(image.dtype)


def _with_inset(picture, inset, across):
    """The picture with the inset in that corner of its panel that is farthest from the rectangle."""
    full = np.iinfo(picture.dtype).max
    rows, columns = slice(inset.y, inset.y + inset.height), slice(inset.x, inset.x + inset.width)
    large = picture[rows, columns].repeat(inset.zoom, 0).repeat(inset.zoom, 1)
    begin = inset.x // across * across
    is_left = inset.x + inset.width / 2 < begin + across / 2
    is_above = inset.y + inset.height / 2 < picture.shape[0] / 2
    left = begin + across - large.shape[1] - 2 * _FRAME if is_left else begin + 2 * _FRAME
    top = picture.shape[0] - large.shape[0] - 2 * _FRAME if is_above else 2 * _FRAME
    _framed(picture, inset.y, inset.x, inset.height, inset.width, full)
    _framed(picture, top, left, large.shape[0], large.shape[1], full)
    picture[top : top + large.shape[0], left : left + large.shape[1]] = large
    return picture


def _framed(picture, top, left, height, width, full):
    """Draw a white frame around a rectangle, outside of it, as far as the picture reaches."""
    low = max(0, top - _FRAME), max(0, left - _FRAME)
    inside = picture[top : top + height, left : left + width].copy()
    picture[low[0] : top + height + _FRAME, low[1] : left + width + _FRAME] = full
    picture[top : top + height, left : left + width] = inside


def _parted(picture, columns, gutter):
    """The panels of a picture with so many white columns between them."""
    if columns == 1 or not gutter:
        return picture
    panels = np.split(picture, columns, axis=1)
    white = np.full((picture.shape[0], gutter, 3), np.iinfo(picture.dtype).max, picture.dtype)
    return np.concatenate([part for panel in panels for part in (white, panel)][1:], axis=1)
