"""Depth formats: the words and the depths that a buffer or a texture of each holds."""

from typing import NamedTuple

from fixedpipe.pipeline.enums import DepthFormat
from fixedpipe.raster import codes as C
from fixedpipe.raster.float_depths import FLOAT_16, FLOAT_24, FloatDepth, farthest


class DepthWords(NamedTuple):
    """The words of a depth format.

    code      of ``raster/codes.py``, the kind
    largest   word, and ``farthest``: its depth
    form      how a float's word is made; None: it is fixed
    """

    code: int
    largest: int
    farthest: float
    form: FloatDepth | None = None


def _words(depth_format):
    form = {DepthFormat.FLOAT_16: FLOAT_16, DepthFormat.FLOAT_24: FLOAT_24}.get(depth_format)
    if form is not None:
        return DepthWords(form.code, form.largest, farthest(form), form)
    largest = 2**depth_format.bits - 1
    return DepthWords(C.DEPTH_FIXED, largest, float(largest))


DEPTH_WORDS = {depth_format: _words(depth_format) for depth_format in DepthFormat}
