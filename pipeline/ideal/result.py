"""The IdealResult of a frame, and real colours as bytes."""

from dataclasses import dataclass

import numpy as np

from fixedpipe.pipeline.framebuffers.transfer import HistogramTable, MinmaxTable
from fixedpipe.pipeline.textures.images import Texture


@dataclass(frozen=True, eq=False)
class IdealResult:
    """What a frame leaves behind on the ideal machine. Arrays of the framebuffer have their top row first.

    color     float64 [h, w, 4], 1.0 = full intensity, not clamped: additive passes may exceed 1
    depth     float64 [h, w], window depth in [0, 1]
    stencil   uint8 [h, w]
    textures  name to Texture, every one with its ``ideal`` levels
    pixels    name to array, of ReadPixels, bottom row first: colours, depths float64; stencil uint8
    histograms, minmaxes  as a Result's
    """

    color: np.ndarray
    depth: np.ndarray
    stencil: np.ndarray
    textures: dict[str, Texture]
    pixels: dict[str, np.ndarray]
    histograms: dict[str, HistogramTable]
    minmaxes: dict[str, MinmaxTable]

    def image(self):
        """uint8 [h, w, 4]: the colours clamped to [0, 1] and rounded to the nearest byte."""
        return to_bytes(self.color)


def to_bytes(values):
    """Reals to bytes: clamped to [0, 1], then the nearest of 0..255 (halves up), as OpenGL 1.2.1 converts."""
    return np.floor(np.clip(values, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
