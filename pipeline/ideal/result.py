"""The IdealResult of a frame, and real colours as bytes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fixedpipe.pipeline.framebuffers.pictures import Pictured, to_codes
from fixedpipe.pipeline.framebuffers.transfer import HistogramTable, MinmaxTable
from fixedpipe.pipeline.textures.images import Texture


@dataclass(frozen=True, eq=False, repr=False)
class IdealResult(Pictured):
    """The result of a frame on the ideal machine. Arrays of the framebuffer have their top row first.

    A notebook shows the picture; ``save`` writes it.

    color                 float64 [h, w, 4], 1.0 = full intensity, not clamped: additive passes may exceed 1
    depth                 float64 [h, w], window depth in [0, 1]
    stencil               uint8 [h, w]
    textures              name to Texture, bottom row first, each with its ``ideal`` levels
    pixels                name to array, from ReadPixels and GetTexImage, bottom row first: colours and depths
                          float64, stencil uint8
    histograms, minmaxes  as a Result's
    """

    color: NDArray[np.float64]
    depth: NDArray[np.float64]
    stencil: NDArray[np.uint8]
    textures: dict[str, Texture]
    pixels: dict[str, NDArray[Any]]
    histograms: dict[str, HistogramTable]
    minmaxes: dict[str, MinmaxTable]

    def image(self) -> NDArray[np.uint8]:
        """uint8 [h, w, 4], top row first: the colours clamped to [0, 1] and rounded to the nearest byte."""
        return to_bytes(self.color)

    def codes(self, bits: int = 8) -> NDArray[np.int32]:
        """The colours as a machine of ``bits`` bits a component stores them, int32 [h, w, 4], top row first.

        They are clamped to [0, 1] and rounded to the nearest code.
        """
        return to_codes(self.color, bits)

    def __repr__(self) -> str:
        """The frame's size, without its arrays."""
        height, width = self.color.shape[:2]
        return f"<the ideal, {width}x{height} pixels>"


def to_bytes(values: ArrayLike) -> NDArray[np.uint8]:
    """Reals as bytes: clamped to [0, 1], then the nearest of 0..255, halves up. Source: OpenGL 1.2.1."""
    return to_codes(values, 8).astype(np.uint8)
